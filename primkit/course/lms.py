"""LMS: the names that Moodle, Canvas and nbgrader's exchange give to what is handed in, and what they take back.

In:  the name of a file or folder in a download; marks, and pages of feedback.
Out: a ``Sender``, who is meant by it; tables and archives that the LMS takes back under the same names.

>>> sender_of("Anna Müller_4711_assignsubmission_file")
Sender(lms='moodle', name='Anna Müller', number='4711', attachment='', rest='', late=False, when='')
>>> sender_of("mülleranna_LATE_17_2302_ps1-2.ipynb").rest
'ps1.ipynb'

Sources: Moodle's pages "Assignment submissions" and "Offline grading worksheet", and its importers of feedback and of
grades: a name is ``full name_participant_type_plugin``, with or without a last underscore, before version 3.1 and
without folders followed by the file's own name; a worksheet needs Identifier, Grade and Last modified (grade). Canvas's
pages "How do I download all student submissions?" and "How do I import grades in the Gradebook?": a name is
``lastfirst_LATE_user_attachment_file``, without capitals, spaces and signs, where -1, -2 are handed in again; a table
needs Student, ID and Section, and Points Possible may be its second row. nbgrader: ``user+set+time+code``.
"""

from __future__ import annotations

import io
import re
import zipfile
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from dateutil.parser import parse  # type: ignore[import-untyped]  # it has none

from ..table import as_csv
from .students import read_table

NAMES = {
    "moodle": re.compile(
        r"(?P<name>.+?)_(?P<number>\d+)_(?P<type>assign(?:submission|feedback)_[a-z]+)(?:_(?P<rest>.*))?"
    ),
    "canvas": re.compile(r"(?P<name>[^A-Z]+?)_(?:(?P<late>LATE)_)?(?P<number>\d+)_(?P<attachment>\d+)_(?P<rest>.+)"),
    "exchange": re.compile(r"(?P<name>[^+]+)\+[^+]+\+(?P<when>\d{4}-\d\d-\d\d [\d:.]+ \w+)(?:\+.*)?"),
}
HANDED_IN_AGAIN = re.compile(r"-\d+(?=\.\w+$)")  # Canvas's mark, before the ending
MOODLE_HEADER = ("Identifier", "Full name", "Grade", "Maximum Grade", "Last modified (grade)", "Feedback comments")
FIRST_DAY = (1980, 1, 1, 0, 0, 0)  # of an archive's members, so that the same feedback is the same file


@dataclass(frozen=True)
class Sender:
    """Who handed in, as an LMS names it: its own number, and what is left of the file's name."""

    lms: str
    name: str
    number: str = ""
    attachment: str = ""
    rest: str = ""
    late: bool = False
    when: str = ""


def sender_of(name: str) -> Sender | None:
    """Return whom a name in a download means, or None if no LMS has made it."""
    for lms, pattern in NAMES.items():
        if match := pattern.fullmatch(name):
            told = match.groupdict()
            rest = HANDED_IN_AGAIN.sub("", told.get("rest") or "") if lms == "canvas" else told.get("rest") or ""
            number, attachment, when = (told.get(what) or "" for what in ("number", "attachment", "when"))
            return Sender(lms, told["name"], number, attachment, rest, bool(told.get("late")), when)
    return None


def worksheet_times(path: Path) -> dict[str, datetime]:
    """Return when each participant handed in, by a grading worksheet of Moodle's; nothing of any other file.

    Its archives say in many editions only when they were made. Times are by this computer's clock.
    """
    with path.open("rb") as file:
        if b"Identifier" not in file.read(100):
            return {}
    times = {}
    for _, row in read_table(path)[1]:
        with suppress(ValueError, OverflowError):  # a dash, or a language that is not English
            when = parse(row.get("last modified (submission)", ""))
            times[row["identifier"].removeprefix("Participant ")] = when.astimezone(UTC)
    return times


@dataclass(frozen=True)
class Back:
    """What one student gets back: who it is for the LMS, the points, and the pages, file -> content."""

    name: str
    sender: Mapping[str, str]  # of the submission that counts: lms, name, number, attachment
    points: float | None
    comment: str
    pages: Mapping[str, bytes]


def moodle_files(backs: Iterable[Back], of: float) -> dict[str, bytes]:
    """Return a grading worksheet and a zip of feedback files, as Moodle takes them."""
    backs = list(backs)
    rows = [
        (f"Participant {back.sender['number']}", back.name, _points(back), f"{of:g}", "-", back.comment)
        for back in backs
    ]
    pages = {
        f"{back.sender['name']}_{back.sender['number']}_assignsubmission_file/{file}": page
        for back in backs
        for file, page in back.pages.items()
    }
    return {"moodle_grades.csv": as_csv(MOODLE_HEADER, rows).encode(), "moodle_feedback.zip": _archive(pages)}


def canvas_files(backs: Iterable[Back], of: float, title: str) -> dict[str, bytes]:
    """Return a table of grades and a zip of feedback files, as Canvas takes them."""
    backs = list(backs)
    rows = [("    Points Possible", "", "", f"{of:g}")]
    rows += [(back.name, back.sender["number"], "", _points(back)) for back in backs]
    pages = {
        f"{back.sender['name']}_{back.sender['number']}_{back.sender['attachment']}_{file}": page
        for back in backs
        for file, page in back.pages.items()
    }
    table = as_csv(("Student", "ID", "Section", title), rows)
    return {"canvas_grades.csv": table.encode(), "canvas_feedback.zip": _archive(pages)}


def _points(back: Back) -> str:
    return "" if back.points is None else f"{round(back.points, 2):g}"


def _archive(files: Mapping[str, bytes]) -> bytes:
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            archive.writestr(zipfile.ZipInfo(name, FIRST_DAY), content, zipfile.ZIP_DEFLATED)
    return packed.getvalue()
