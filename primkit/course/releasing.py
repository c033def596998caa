"""Releasing: the students' version of a problem set, without solutions, and their personal maps.

In:  ``source/<problem set>/`` and the list of students.
Out: ``release/<problem set>/``, made by nbgrader and searched for leaks; for a problem set about a personal map also
     ``personal/<student>/my_scans.npz``, which holds neither the student's id nor the salt nor the truth.
"""

from __future__ import annotations

from collections.abc import Callable

from ..formats import save_scans
from .course import SCANS, STUDENTS, Course
from .leaks import find_leaks, secrets_of
from .moved import refuse_old_names
from .personal import personal_scans, personal_world
from .running import Done, nbgrader


def release(course: Course, name: str, *, say: Callable[[str], None]) -> None:
    """Make the students' version of a problem set, and their personal maps if it has any.

    Raises ValueError if the course names what has moved, nbgrader refuses the problem set, or a solution is found in
    what it made.
    """
    refuse_old_names(course, name, released=False)
    students = course.students()
    say(f"nbgrader makes release/{name}: this takes some seconds")
    if students:
        _check(nbgrader(course, "db", "student", "import", STUDENTS), "the list of students was refused")
    _check(nbgrader(course, "generate_assignment", name, "--force"), f"nbgrader could not release {name}")
    made = course.root / "release" / name
    if leaks := find_leaks([made], secrets_of(course.root)):
        told = "; ".join(str(leak) for leak in leaks[:3])
        raise ValueError(f"do not hand out release/{name}: {told}")
    say(f"release/{name} is ready: no solution was found in it")
    if not course.personal(name):
        return
    salt = course.salt()
    for student in students:
        folder = course.root / "personal" / student
        folder.mkdir(parents=True, exist_ok=True)
        save_scans(personal_scans(personal_world(student, salt=salt)), folder / SCANS)
    say(
        f"personal/<student>/{SCANS}: {len(students)} of them; each student gets their own, beside the notebook"
        if students
        else f"{STUDENTS} is empty: fill it in and release again, and everybody gets a map of their own"
    )


def _check(done: Done, sentence: str) -> None:
    if done.code != 0:
        raise ValueError(f"{sentence}: {done.reason}")
