"""Handing back: what the feedback lacks as nbgrader makes it, and the state of each submission in words.

In:  the gradebook, the journal of the grading, and ``feedback/``.
Out: the head of each page names its tests, and calls answers that nobody has marked yet so; a submission that could not
     be graded gets a page that says why. ``state`` says it for the table of grades, where all look like a 0.

``nbgrader generate_feedback``, once an answer is marked by hand, makes the pages anew.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterable, Mapping
from html import escape
from typing import Any

from .course import Course
from .handed_in import Fault

PAGE = """\
<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>{0}: not graded</title></head>
<body style="font-family:sans-serif;max-width:40em;margin:2em auto;line-height:1.5">
<h1>{0}: not graded</h1>
<p>What was handed in could not be graded. {1}</p>
<p>Nothing is lost: mend it, or ask your teacher, and hand it in again.</p>
</body></html>
"""


def unmarked_answers(course: Course, name: str) -> dict[str, list[str]]:
    """Return the answers that a person has still to mark: student -> names of cells."""
    from nbgrader.api import Gradebook, MissingEntry

    found: dict[str, list[str]] = defaultdict(list)
    if not (course.root / "gradebook.db").is_file():
        return found
    with Gradebook(f"sqlite:///{(course.root / 'gradebook.db').as_posix()}") as book:
        try:
            submissions = book.assignment_submissions(name)
        except MissingEntry:
            return found
        for submission in submissions:
            for grade in (grade for notebook in submission.notebooks for grade in notebook.grades):
                if grade.needs_manual_grade:
                    found[submission.student.id].append(grade.cell.name)
    return found


def hand_back(course: Course, name: str, entries: Mapping[str, Any], open_cells: Mapping[str, list[str]]) -> None:
    """Complete the feedback on a problem set; ``entries`` are the journal's."""
    for student, entry in entries.items():
        for notebook in course.notebooks(name):
            page = course.root / "feedback" / student / name / f"{notebook}.html"
            if not entry["graded"]:
                page.parent.mkdir(parents=True, exist_ok=True)
                says = " ".join(_as_sentence(Fault(**fault)) for fault in entry["faults"])
                page.write_text(PAGE.format(escape(notebook), escape(says)), encoding="utf-8")
            elif page.is_file():
                html = page.read_text(encoding="utf-8")
                html = re.sub(r'(<a href="#([\w.-]+)">)Test cell</a>', r"\1\2</a>", html)  # in the page's head
                if open_cells.get(student):
                    html = _say_unmarked(html, open_cells[student])
                page.write_text(html, encoding="utf-8")


def _as_sentence(fault: Fault) -> str:
    """Return a fault as a sentence for the student: with the file's name, where it does not say it itself."""
    if fault.cell == "-" or fault.cell in fault.says:
        return f"{fault.says[:1].upper()}{fault.says[1:]}."
    return f"{fault.cell} {fault.says}."


def _say_unmarked(html: str, cells: Iterable[str]) -> str:
    """Say of answers that they are not yet marked, at the head of a page and beside their points.

    >>> _say_unmarked('<a href="#trust">Written response</a> (Score: 0.0 / 4.0)', ["trust"])
    '<a href="#trust">Written response</a> (not yet marked, of 4.0)'
    """
    for cell in cells:
        link = rf'(<a href="#{re.escape(cell)}">[^<]*</a>) \(Score: [\d.]+ / ([\d.]+)\)'
        html = re.sub(link, r"\1 (not yet marked, of \2)", html)
        place = rf'(<a name="{re.escape(cell)}"></a>.{{0,300}}?)Score: [\d.]+ / ([\d.]+)'
        html = re.sub(place, r"\1Not yet marked, of \2", html, flags=re.DOTALL)
    told = f"Not yet marked: {', '.join(cells)}. The score does not count that yet."
    return re.sub(r"(<h4>[^<]*\(Score: [^<]*</h4>)", rf"\1<p><b>{escape(told)}</b></p>", html, count=1)


def state(entry: Mapping[str, Any] | None, *, handed_in: bool, open_cells: int, listed: bool) -> str:
    """Return how it stands with a submission, in a few words.

    >>> state({"graded": True}, handed_in=True, open_cells=1, listed=True)
    'graded; 1 to be marked by hand'
    >>> state(None, handed_in=False, open_cells=0, listed=True)
    'nothing handed in'
    """
    if entry is None:
        words = ["not yet graded" if handed_in else "nothing handed in"]
    else:
        words = ["graded" if entry["graded"] else "could not be graded"]
        words += [f"{open_cells} to be marked by hand"] * bool(entry["graded"] and open_cells)
    return "; ".join(words + ["not in students.csv"] * (not listed))
