"""Releasing: the students' version of a problem set, without solutions, and their personal maps.

In:  ``source/<problem set>/`` and the list of students.
Out: ``release/<problem set>/``, made by nbgrader and searched for leaks; for a problem set about a personal map also
     ``personal/<student>/my_scans.npz``, which holds neither the student's id nor the salt nor the truth.

All is made beside, and takes the old one's place in the end: when it fails, release and gradebook are as they were. In
mid-term the same command brings in a new student, a corrected task or other points, and says what has changed.
"""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from ..formats import save_scans
from ..table import as_csv
from .course import SCANS, STUDENTS, Course
from .leaks import find_leaks, secrets_of
from .notebooks import marked, read_notebook, text_of
from .personal import personal_scans, personal_world
from .running import Done, nbgrader
from .students import STUDENT_COLUMNS


def release(course: Course, name: str, *, say: Callable[[str], None]) -> None:
    """Make the students' version of a problem set, and their personal maps if it has any.

    Raises ValueError if nbgrader refuses the problem set, a solution is found in what it made, or a task is gone whose
    answers were handed in; then nothing has changed.
    """
    students = course.roster()
    say(f"nbgrader makes release/{name}: this takes some seconds")
    folder = course.root / ".primkit"
    folder.mkdir(exist_ok=True)
    release = course.root / "release" / name
    with tempfile.TemporaryDirectory(dir=folder, ignore_cleanup_errors=True) as scratch, _gradebook_kept(course):
        if students:
            table = Path(scratch, STUDENTS)  # as nbgrader reads it
            rows = [[getattr(student, column) for column in STUDENT_COLUMNS] for student in students]
            table.write_text(as_csv(STUDENT_COLUMNS, rows), encoding="utf-8")
            _check(nbgrader(course, "db", "student", "import", str(table)), "the list of students was refused")
        beside = f"--CourseDirectory.release_directory={Path(scratch, 'release').as_posix()}"
        made = Path(scratch, "release", name)
        _check(nbgrader(course, "generate_assignment", name, "--force", beside), f"nbgrader could not release {name}")
        if leaks := find_leaks([made], secrets_of(course.root)):
            told = "; ".join(str(leak) for leak in leaks[:3])
            raise ValueError(f"do not hand out {name}, release/{name} stays as it was: {told}")
        changes = list(_changes(release, made))
        release.parent.mkdir(exist_ok=True)
        if release.exists():
            release.rename(Path(scratch, "before"))
        made.rename(release)
    say(f"release/{name} is ready: no solution was found in it")
    for change in changes:
        say(change)
    if course.personal(name):
        say(_make_maps(course, [student.id for student in students]))


@contextmanager
def _gradebook_kept(course: Course) -> Iterator[None]:
    """Put the gradebook back as it was if what follows fails."""
    book = course.root / "gradebook.db"
    before = book.with_name("gradebook.db.before")
    if book.is_file():
        shutil.copyfile(book, before)
    try:
        yield
    except BaseException:
        if before.is_file():
            before.replace(book)
        else:
            book.unlink(missing_ok=True)
        raise
    before.unlink(missing_ok=True)


def _changes(before: Path, now: Path) -> Iterator[str]:
    """Yield what is different from an earlier release, for those who have that one."""
    for path in sorted(before.glob("*.ipynb")) if before.is_dir() else ():
        old, new = (dict(marked(read_notebook(where / path.name))) for where in (before, now))
        if gone := sorted(old.keys() - new.keys()):
            yield f"Gone   {', '.join(gone)}: answers in them count no more"
        if more := sorted(new.keys() - old.keys()):
            yield f"New    {', '.join(more)}: put into older notebooks when they are graded, without an answer"
        same = sorted(old.keys() & new.keys())
        points = [mark for mark in same if _points(old[mark]) != _points(new[mark])]
        if told := ", ".join(f"{mark} {_points(old[mark])} -> {_points(new[mark])}" for mark in points):
            yield f"Points {told}: `primkit teach grade {now.name} --again` gives them to all"
        if texts := [mark for mark in same if text_of(old[mark]) != text_of(new[mark])]:
            yield f"Texts  {', '.join(texts)}: hand it out again; answers to the old one are graded as before"


def _points(cell: dict[str, dict[str, dict[str, float]]]) -> str:
    return f"{cell['metadata']['nbgrader'].get('points') or 0:g}"


def _make_maps(course: Course, students: list[str]) -> str:
    """Write everybody's scans, and say so; those that are there already are the same again."""
    salt = course.salt()
    for student in students:
        folder = course.root / "personal" / student
        folder.mkdir(parents=True, exist_ok=True)
        save_scans(personal_scans(personal_world(student, salt=salt)), folder / SCANS)
    if students:
        return f"personal/<student>/{SCANS}: {len(students)} of them; each student gets their own, beside the notebook"
    return f"{STUDENTS} is empty: fill it in and release again, and everybody gets a map of their own"


def _check(done: Done, sentence: str) -> None:
    if done.code != 0:
        raise ValueError(f"{sentence}: {done.reason}")
