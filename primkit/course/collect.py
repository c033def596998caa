"""Collect: what students handed in, from the downloads of an LMS, an exchange or e-mails, to where grading finds it.

In:  zips, folders, notebooks and e-mails, as often as they come; the list of students; the cells of the problem set.
Out: ``submitted/<student>/<problem set>/``, the latest of each student; every version in
     ``collected/<problem set>/<student>/``; ``collected/<problem set>/collected.json`` with where each came from.

A submission is what lies under the name of one student: a folder, an archive, or files whose names begin alike. Its
notebook is found by the cells it holds, whatever its name; files beside that go with it. Nothing in it is run.
"""

from __future__ import annotations

import hashlib
import json
import shutil
import tempfile
from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, field
from datetime import UTC, datetime
from pathlib import Path

from ..arguments import short
from ..formats.files import bounded_read, naming, write_atomically
from ..formats.values import parsed
from .archives import Found, Refused, unpack
from .course import Course
from .handed_in import tree_hash
from .late import NBGRADER_TIME, Late
from .lms import Sender, sender_of
from .notebooks import Cells, cells_of, slim
from .students import Student, called, meant_by

MOST_BESIDE = 32 * 2**20  # bytes of the files beside a notebook, all together
MOST_FILES = 200  # of them
REMEDY = "put it into a folder with the id as its name"
TIMESTAMP = "timestamp.txt"  # nbgrader's own: beside a notebook, the time it came


@dataclass
class Version:
    """One submission of one student: when it came, from where, and what is to be known about it."""

    student: str
    when: str  # by ISO 8601, in UTC; empty if nothing tells
    source: str
    notebook: str  # the name it came with
    folder: str  # in collected/
    hash: str
    sender: dict[str, str] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)

    @property
    def order(self) -> tuple[str, str]:
        """The latest is the greatest; of the same time, Canvas's later attachment."""
        return self.when, self.sender.get("attachment", "").zfill(20)


@dataclass(frozen=True)
class Unplaced:
    """A file that could not be placed, and why."""

    place: str
    says: str


@dataclass(frozen=True)
class Collected:
    """What a student has handed in, all versions, the latest last; and whether the latest is new."""

    student: Student
    versions: Sequence[Version]
    new: bool


def collect(course: Course, name: str, paths: Iterable[Path]) -> tuple[list[Collected], list[Unplaced]]:
    """Place what lies in these files and folders; return who has handed in until now, and what could not be placed.

    Raises ValueError if a path is not there, or the list of students is empty or cannot be read.
    """
    students = course.roster()
    if not students:
        raise ValueError(f"the list of students is empty: fill it in, for they are found by it ({course.root})")
    book = _Book(course, name)
    unplaced: list[Unplaced] = []
    with tempfile.TemporaryDirectory(prefix="primkit-", ignore_cleanup_errors=True) as scratch:
        submissions: dict[tuple[str, ...], list[_File]] = defaultdict(list)
        for found in unpack(paths, Path(scratch)):
            file = found if isinstance(found, Refused) else _whose(found, students)
            if isinstance(file, _File):
                submissions[file.key].append(file)
            else:
                unplaced.append(Unplaced(file.place, file.says))
        known = cells_of(course)
        for files in submissions.values():
            unplaced += _keep(book, files, known)
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


def _whose(found: Found, students: Sequence[Student]) -> _File | Unplaced:
    """Return a file with its student: the outermost name that means somebody decides, whatever lies within.

    Only where it does no more than mention a student, as a download may by chance, no other name may contradict it.
    """
    parts = found.parts
    if found.mail:
        meant = [each for each in students if each.email.casefold() == found.mail.casefold()]
        meant = meant or called(found.mail.partition("@")[0], students)
        return _decided(found, meant, parts[:1], parts[1:], None, f"the address {found.mail}")
    claims: list[tuple[int, list[Student], Sender | None]] = []
    for place, part in enumerate(parts):
        sender = sender_of(part)
        meant = meant_by(part, students) if sender is None else _by_sender(sender, students)
        if meant or sender:
            claims.append((place, meant, sender))
    if not claims:
        return Unplaced(found.place, f"names nobody in the list of students: {REMEDY}")
    place, meant, sender = claims[0]
    below = ((sender.rest,) if sender and sender.rest else ()) + parts[place + 1 :]
    if not sender and not called(parts[place], students) and (parts[-1].endswith(".ipynb") or claims[-1][2]):
        meant = meant + [each for _, others, _ in claims[1:] for each in others if each not in meant]
    by = f"{sender.lms.title()}'s name {sender.name!r}" if sender else repr(parts[place])
    return _decided(found, meant, parts[:place], below, sender, by)


def _by_sender(sender: Sender, students: Sequence[Student]) -> list[Student]:
    """Return whom an LMS's name means; Canvas has its own numbers, Moodle may put a group in front of a name."""
    names = [sender.name]
    while sender.lms == "moodle" and "-" in names[-1]:
        names.append(names[-1].partition("-")[2])
    by_number = [each for each in students if sender.lms == "canvas" and each.lms_user_id == sender.number]
    return by_number or next((meant for each in names if (meant := called(each, students))), [])


def _decided(
    found: Found,
    meant: Sequence[Student],
    outer: tuple[str, ...],
    below: tuple[str, ...],
    sender: Sender | None,
    by: str,
) -> _File | Unplaced:
    if len(meant) != 1:
        who = f"may mean {' or '.join(each.id for each in meant)}" if meant else "is nobody's in the list of students"
        return Unplaced(found.place, f"{by} {who}: {REMEDY}")
    student, again = meant[0].id, sender.number or sender.when if sender else ""
    return _File(student, (*outer, student, again), below or found.parts[-1:], found, sender)


# --- what it holds ------------------------------------------------------------------------------------------


def _keep(book: _Book, files: Sequence[_File], known: Cells) -> Iterator[Unplaced]:
    """Keep a submission as a version of its student's, and yield what of it has no place."""
    candidates = []
    for file in files:
        if file.found.parts[-1].lower().endswith(".ipynb"):
            read = slim(file.found.path, known)
            if read.set and read.set != book.name:
                says = f"is {read.set}: `primkit teach collect {read.set}` places it"
                yield Unplaced(file.found.place, says)
            else:
                candidates.append((read, file))
    wanted = {read.notebook for read, _ in candidates if read.notebook} or {known.only(book.name)}
    if not candidates:
        if not any(file.found.parts[-1].lower().endswith(".ipynb") for file in files):
            yield Unplaced(files[0].found.place, f"holds no notebook ({files[0].student})")
        return
    contents: dict[str, bytes] = {}
    notes: list[str] = []
    chosen = []
    for notebook in sorted(filter(None, wanted)):
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
    when = _when(files, chosen)
    book.add(chosen[0], when, contents, beside, [*notes, *more])


def _when(files: Sequence[_File], chosen: Sequence[_File]) -> datetime | None:
    """Return when a submission came: as the exchange says, else by its files."""
    for file in files:
        told = file.sender.when if file.sender else ""
        if not told and file.found.parts[-1] == TIMESTAMP:
            told = file.found.path.read_bytes()[:100].decode("ascii", "replace").strip()
        if told:
            from nbgrader.utils import parse_utc

            with suppress(ValueError, OverflowError):
                return parse_utc(told).replace(tzinfo=UTC)
    latest = max(file.found.when for file in chosen)
    return datetime.fromtimestamp(latest, UTC) if latest else None


def _beside(notebook: _File, files: Sequence[_File]) -> tuple[dict[str, bytes], list[str]]:
    """Return the files that lie beside a notebook or below that, and a note on those that are left out."""
    beside: dict[str, bytes] = {}
    left_out, taken, folder = 0, 0, notebook.below[:-1]
    for file in files:
        parts = file.below[len(folder) :]
        if file.below[: len(folder)] != folder or parts[-1] == TIMESTAMP or parts[-1].lower().endswith(".ipynb"):
            continue
        taken += file.found.path.stat().st_size
        if taken > MOST_BESIDE or len(beside) >= MOST_FILES or not all(map(_plain, parts)):
            left_out += 1
        else:
            beside["/".join(parts)] = file.found.path.read_bytes()
    return beside, [f"{left_out} files beside it left out: too many, too large, or no names for files"] * bool(left_out)


def _plain(part: str) -> bool:
    """Tell whether every system can have a file of this name."""
    return part.isprintable() and part == part.strip(" .") and len(part) < 100 and not set(part) & set('\\/:*?"<>|')


# --- what is kept -------------------------------------------------------------------------------------------

FIELDS = {*Version.__dataclass_fields__}


class _Book:
    """What was collected of a problem set, in a file and folders; written whole after each change."""

    def __init__(self, course: Course, name: str) -> None:
        self.course, self.name = course, name
        self.root = course.root / "collected" / name
        self.versions = versions_of(course, name)

    def add(
        self, file: _File, when: datetime | None, contents: dict[str, bytes], beside: dict[str, bytes], notes: list[str]
    ) -> None:
        """Keep a version, unless it is here already."""
        digest = hashlib.sha256()
        for path, content in sorted({**beside, **contents}.items()):
            digest.update(f"{path}\0{len(content)}\0".encode() + content)
        code, told = digest.hexdigest(), when.isoformat(timespec="seconds") if when else ""
        sender = {} if file.sender is None else {k: str(v) for k, v in asdict(file.sender).items() if v}
        have = self.versions.setdefault(file.student, [])
        same = next((version for version in reversed(have) if version.hash == code), None)
        # A copy of what counts is no later submission; what was handed in again after another one is.
        if same is not None and (same is have[-1] or told <= have[-1].when):
            if sender and not same.sender:
                same.sender = sender
                self.write()
            return
        stamp = when.strftime("%Y%m%d-%H%M%S") if when else "unknown"
        folder = f"{file.student}/{stamp}-{code[:8]}"
        for path, content in {**beside, **contents}.items():
            target = self.root / folder / path
            target.parent.mkdir(parents=True, exist_ok=True)
            write_atomically(target, content)
        if when:
            write_atomically(self.root / folder / TIMESTAMP, when.strftime(NBGRADER_TIME))
        have.append(Version(file.student, told, file.found.place, file.below[-1], folder, code, sender, notes))
        have.sort(key=lambda version: version.order)
        self.write()

    def write(self) -> None:
        """Write down what is kept."""
        told = [asdict(version) for _, versions in sorted(self.versions.items()) for version in versions]
        self.root.mkdir(parents=True, exist_ok=True)
        write_atomically(self.root / "collected.json", json.dumps(told, indent=1, ensure_ascii=False))

    def hand_over(self, student: str) -> bool:
        """Put a student's latest version where grading finds it; return whether it was not there."""
        latest, place = (
            self.root / self.versions[student][-1].folder,
            self.course.root / "submitted" / student / self.name,
        )
        if place.is_dir():
            if tree_hash(place) == tree_hash(latest):
                return False
            self._adopt(student, place)
            latest = self.root / self.versions[student][-1].folder
            if tree_hash(place) == tree_hash(latest):
                return False
        new = place.with_name(f".{self.name}.new")
        shutil.rmtree(new, ignore_errors=True)
        shutil.copytree(latest, new)
        if place.is_dir():
            old = place.with_name(f".{self.name}.old")
            shutil.rmtree(old, ignore_errors=True)
            place.rename(old)
            new.rename(place)
            shutil.rmtree(old)
        else:
            new.rename(place)
        return True

    def _adopt(self, student: str, place: Path) -> None:
        """Keep what was put into submitted/ by hand as one more version, of the time when it was written."""
        code = tree_hash(place)
        if any(tree_hash(self.root / version.folder) == code for version in self.versions[student]):
            return
        written = max((path.stat().st_mtime for path in place.rglob("*") if path.is_file()), default=0.0)
        when = datetime.fromtimestamp(written, UTC)
        folder = f"{student}/{when:%Y%m%d-%H%M%S}-{code[:8]}"
        shutil.copytree(place, self.root / folder, dirs_exist_ok=True)
        told = when.isoformat(timespec="seconds")
        self.versions[student].append(Version(student, told, "submitted/", "by hand", folder, code))
        self.versions[student].sort(key=lambda version: version.order)
        self.write()


def versions_of(course: Course, name: str) -> dict[str, list[Version]]:
    """Return what was collected of a problem set, student by student, the latest last."""
    path = course.root / "collected" / name / "collected.json"
    versions: dict[str, list[Version]] = {}
    if path.is_file():
        with naming(f"collected/{name}/{path.name}"):
            for told in parsed(bounded_read(path)):
                if not isinstance(told, dict) or {*told} != FIELDS:
                    raise ValueError(f"must hold what was collected, got {short(told)}: put it away, and collect again")
                versions.setdefault(told["student"], []).append(Version(**told))
    return versions


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
        notes += ["no time is known"] * (when is None) + version.notes
        notes += [f"{len(done.versions) - 1} earlier kept"] * (len(done.versions) > 1)
        told = f"{when.astimezone():%Y-%m-%d %H:%M}" if when else "-"
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
