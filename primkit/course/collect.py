"""Collect: what students handed in, from the downloads of an LMS, an exchange or e-mails, to where grading finds it.

In:  zips, folders, notebooks and e-mails, as often as they come; the list of students; the cells of the problem set.
Out: ``submitted/<student>/<problem set>/``, the latest of each student; every version in
     ``collected/<problem set>/<student>/``; ``collected/<problem set>/collected.json`` with where each came from.

A submission is what lies under the name of one student: a folder, an archive, or files whose names begin alike. Its
notebook is found by the cells it holds, whatever its name; files beside that go with it. Nothing in it is run.
"""

from __future__ import annotations

import tempfile
from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from pathlib import Path

from nbgrader.utils import parse_utc

from .archives import Found, Refused, unpack
from .course import COPIED_FOLDERS, STUDENTS, Course
from .late import Late
from .lms import Sender, sender_of, worksheet_times
from .notebooks import Cells, cells_of, slim
from .students import Student, called, meant_by
from .versions import TIMESTAMP, Book, Version

MOST_BESIDE = 32 * 2**20  # bytes of the files beside a notebook, all together
MOST_FILES = 200  # of them
COURSE_FOLDERS = (
    *COPIED_FOLDERS,
    *("release", "personal", "collected", "submitted", "autograded", "feedback", "handed_back", "paper", "reports"),
)
REMEDY = "mend the list, or put it into a folder with the id as its name"
PACKING_SECONDS = 3600  # the times in an LMS's archive that lie within are when it was made


@dataclass(frozen=True)
class Collected:
    """What a student has handed in, all versions, the latest last; and whether the latest is new."""

    student: Student
    versions: Sequence[Version]
    new: bool


def collect(course: Course, name: str, paths: Iterable[Path]) -> tuple[list[Collected], list[Refused]]:
    """Place what lies in these files and folders; return who has handed in until now, and what could not be placed.

    Raises ValueError if a path is not there or the course's own, or the list of students is empty or cannot be read.
    """
    students = course.roster()
    if not students:
        raise ValueError(f"{STUDENTS} in {course.root} is empty: fill it in, for who handed in is found by it")
    paths = list(paths)
    own = [course.root / folder for folder in COURSE_FOLDERS]
    for path in map(Path.resolve, paths):
        if course.root.is_relative_to(path) or any(map(path.is_relative_to, own)):
            raise ValueError(f"{path} is the course's own, with what was graded in it: give the download")
    book = Book(course, name)
    unplaced: list[Refused] = []
    sheets: dict[str, datetime] = {}
    with tempfile.TemporaryDirectory(prefix="primkit-", ignore_cleanup_errors=True) as scratch:
        submissions: dict[tuple[str, ...], list[_File]] = defaultdict(list)
        for found in unpack(paths, Path(scratch)):
            if isinstance(found, Found) and len(found.parts) == 1 and (sheet := worksheet_times(found.path)):
                sheets |= sheet  # given by the teacher, and in no archive
                continue
            file = found if isinstance(found, Refused) else _whose(found, students)
            if isinstance(file, _File):
                submissions[file.key].append(file)
            else:
                unplaced.append(file)
        known, clock = cells_of(course), _Clock(submissions.values(), sheets)
        for files in submissions.values():
            unplaced += _keep(book, files, known, clock)
    people = {student.id: student for student in students}
    done = [
        Collected(people.get(student, Student(student)), versions, book.hand_over(student))
        for student, versions in sorted(book.versions.items())
    ]
    return done, unplaced


# --- whose a file is ----------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _File:
    """A file of a student: its names below the one that means the student, and who sent it."""

    student: str
    key: tuple[str, ...]
    below: tuple[str, ...]
    found: Found
    sender: Sender | None


def _whose(found: Found, students: Sequence[Student]) -> _File | Refused:
    """Return a file with its student: the outermost name that means somebody decides, whatever lies within.

    Only where it does no more than mention a student, as a download may by chance, no other name may contradict it.
    """
    parts = found.parts
    claims: list[tuple[int, list[Student], Sender | None]] = []
    if found.mail:
        meant = [each for each in students if each.email.casefold() == found.mail.casefold()]
        claims = [(0, meant or called(found.mail.partition("@")[0], students), None)]
    for place, part in enumerate(() if found.mail else parts):
        sender = sender_of(part)
        meant = meant_by(part, students) if sender is None else _by_sender(sender, students)
        if meant or sender:
            claims.append((place, meant, sender))
    if not claims:
        return Refused(found.place, f"names nobody in the list of students: {REMEDY}")
    place, meant, sender = claims[0]
    if not sender and not called(parts[place], students) and (parts[-1].lower().endswith(".ipynb") or claims[-1][2]):
        meant = meant + [each for _, others, _ in claims[1:] for each in others if each not in meant]
    if len(meant) != 1:
        by = f"{sender.lms.title()}'s name {sender.name!r}" if sender else repr(parts[place])
        by = f"the address {found.mail}" if found.mail else by
        who = f"may mean {' or '.join(each.id for each in meant)}" if meant else "is nobody's in the list of students"
        return Refused(found.place, f"{by} {who}: {REMEDY}")
    again = sender.number or sender.when if sender else ""
    below = ((sender.rest,) if sender and sender.rest else ()) + parts[place + 1 :]
    outer = parts[:1] if found.mail else parts[:place]
    return _File(meant[0].id, (*outer, meant[0].id, again), below or parts[-1:], found, sender)


def _by_sender(sender: Sender, students: Sequence[Student]) -> list[Student]:
    """Return whom an LMS's name means; Canvas has its own numbers, Moodle may put a group in front of a name."""
    names = [sender.name]
    while sender.lms == "moodle" and "-" in names[-1]:
        names.append(names[-1].partition("-")[2])
    by_number = [each for each in students if sender.lms == "canvas" and each.lms_user_id == sender.number]
    return by_number or next((meant for each in names if (meant := called(each, students))), [])


# --- what it holds ------------------------------------------------------------------------------------------


def _keep(book: Book, files: Sequence[_File], known: Cells, clock: _Clock) -> Iterator[Refused]:
    """Keep a submission as a version of its student's, and yield what of it has no place."""
    candidates = []
    for file in files:
        if file.found.parts[-1].lower().endswith(".ipynb"):
            read = slim(file.found.path, known)
            if read.set and read.set != book.name:
                if not (file.sender and file.sender.lms == "exchange"):  # which holds all sets
                    says = f"is {read.set}: `primkit teach collect {read.set}` places it"
                    yield Refused(file.found.place, says)
            else:
                candidates.append((read, file))
    books = list(known.marks[book.name])
    wanted = {read.notebook for read, _ in candidates if read.notebook} or ({*books} if len(books) == 1 else set())
    if not candidates:
        if not any(file.found.parts[-1].lower().endswith(".ipynb") for file in files):
            yield Refused(files[0].found.place, f"holds no notebook ({files[0].student})")
        return
    contents: dict[str, bytes] = {}
    notes: list[str] = []
    chosen = []
    for notebook in sorted(wanted):
        fitting = [(read, file) for read, file in candidates if read.notebook in (notebook, "")]
        read, file = max(
            fitting,
            key=lambda pair: (
                bool(pair[0].notebook),
                round(pair[1].found.when / 60),
                pair[1].sender.attachment.zfill(20) if pair[1].sender else "",
                pair[0].answered,
                pair[1].below[-1] == f"{notebook}.ipynb",
            ),
        )
        contents[f"{notebook}.ipynb"] = read.content
        chosen.append(file)
        notes += read.notes
        if len(fitting) > 1:
            others = ", ".join(sorted(other.below[-1] for _, other in fitting if other is not file))
            notes.append(f"{file.below[-1]} of {len(fitting)} notebooks, not {others}")
    beside, more = _beside(chosen[0], files)
    main = chosen[0]
    when, packed = (told.isoformat(timespec="seconds") if told else "" for told in clock.times(files, chosen))
    sender = {} if main.sender is None else {what: str(told) for what, told in asdict(main.sender).items() if told}
    version = Version(main.student, when, packed, main.found.place, main.below[-1], sender, [*notes, *more])
    book.add(version, {**beside, **contents})


class _Clock:
    """Tells when a submission came. Canvas and many a Moodle write into an archive only when that was made."""

    def __init__(self, submissions: Iterable[Sequence[_File]], sheets: dict[str, datetime]) -> None:
        self.sheets, times = sheets, defaultdict[str, list[float]](list)
        for file in (file for files in submissions for file in files if file.sender):
            times[file.found.parts[0]].append(file.found.when)
        self.own = {archive for archive, found in times.items() if max(found) - min(found) > PACKING_SECONDS}

    def times(self, files: Sequence[_File], chosen: Sequence[_File]) -> tuple[datetime | None, datetime | None]:
        """Return when files were handed in, as an LMS, an e-mail or they themselves say; and what they say."""
        latest = max(file.found.when for file in chosen)
        packed = datetime.fromtimestamp(latest, UTC) if latest else None
        sender = files[0].sender
        if sender is not None:
            if sender.when:
                return parse_utc(sender.when).replace(tzinfo=UTC), packed
            if sender.lms == "moodle" and sender.number in self.sheets:
                return self.sheets[sender.number], packed
            if sender.lms == "canvas" or files[0].found.parts[0] not in self.own:
                return None, packed
        return packed, packed


def _beside(notebook: _File, files: Sequence[_File]) -> tuple[dict[str, bytes], list[str]]:
    """Return the files that lie beside a notebook or below that, and a note on those that are left out."""
    beside: dict[str, bytes] = {}
    left_out, taken, folder = 0, 0, notebook.below[:-1]
    for file in files:
        parts = file.below[len(folder) :]
        if file.below[: len(folder)] != folder or parts[-1] == TIMESTAMP or parts[-1].lower().endswith(".ipynb"):
            continue
        taken, path = taken + file.found.path.stat().st_size, "/".join(parts)
        clash = any(part.lower().endswith(".ipynb") for part in parts) or any(
            each.startswith(f"{path}/") or path.startswith(f"{each}/") for each in beside
        )
        if clash or taken > MOST_BESIDE or len(beside) >= MOST_FILES or not all(map(_is_plain, parts)):
            left_out += 1
        else:
            beside[path] = file.found.path.read_bytes()
    return beside, [f"{left_out} files beside it left out: too many, too large, or no names for files"] * bool(left_out)


def _is_plain(part: str) -> bool:  # every system can have a file of this name
    return part.isprintable() and part == part.strip(" .") and len(part) < 100 and not set(part) & set('\\/:*?"<>|')


# --- what is said about it ----------------------------------------------------------------------------------


def table_of(course: Course, name: str, collected: Sequence[Collected]) -> list[tuple[str, ...]]:
    """Return a row for each student in the list: who, what, when, and what is to be known about it."""
    late, have = Late.of(course.root), {each.student.id: each for each in collected}
    rows: list[tuple[str, ...]] = []
    for student in sorted({*course.roster(), *(each.student for each in collected)}, key=lambda each: each.id):
        done = have.get(student.id)
        if done is None:
            rows.append((student.id, "-", "", "nothing handed in"))
            continue
        version = done.versions[-1]
        when = datetime.fromisoformat(version.when) if version.when else None
        over = late.by(name, student.id, when) if when else None
        notes = [f"{_hours(over.total_seconds())} late"] if over else []
        if version.sender.get("late") and not over:
            notes.append("late, says the LMS")
        notes += version.notes
        notes += [f"{len(done.versions) - 1} earlier kept"] * (len(done.versions) > 1)
        packed = f"packed {datetime.fromisoformat(version.packed).astimezone():%Y-%m-%d}" if version.packed else "-"
        told = f"{when.astimezone():%Y-%m-%d %H:%M}" if when else packed
        rows.append((student.id, version.notebook, told, "; ".join(["new"] * done.new + notes)))
    return rows


def _hours(seconds: float) -> str:
    """Return a time in words.

    >>> _hours(2000), _hours(180000)
    ('33 min', '2 d 2 h')
    """
    hours, days = seconds / 3600, int(seconds // 86400)
    if hours < 1:
        return f"{seconds / 60:.0f} min"
    return f"{days} d {int(hours % 24)} h" if days else f"{hours:.0f} h"
