"""Checking: whether all is there that a course needs, and how each fault is mended.

In:  a course folder.
Out: a ``Finding`` for each thing that was looked at: fine, or what is wrong and what to do.
"""

from __future__ import annotations

import ast
import os
import re
import sqlite3
import sys
import sysconfig
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from ..installed import PIP, PROJECT, Finding, kernel, pins_in, python, version_of
from ..table import count
from .confining import UNPROTECTED, confined_by
from .course import CAREFUL, COPIED_FOLDERS, SETTINGS, STUDENTS, Course
from .grading.judging import hidden_tests_of
from .handed_in import misplaced, strangers
from .notebooks import marked, read_notebook, text_of
from .students import SAVE_AS, read_students

ENVIRONMENT = PROJECT / "notebooks" / "teacher" / "environment.txt"  # in a clone
REQUIRED_PACKAGES = ("nbgrader", "jupyterlab", "ipykernel", "nbconvert", "psutil")
MARK = re.compile(r"^([\w.]+)\.mark\(", re.MULTILINE)  # of a task, in a hidden test


def check(course: Course, environment: Path = ENVIRONMENT) -> list[Finding]:
    """Look at everything that a course needs; elsewhere, only at what is installed."""
    installed = [python(), *_packages(environment), *_commands(), kernel(), _walls()]
    if not (course.root / "nbgrader_config.py").is_file():
        found = f"{course.root} is none: it has no nbgrader_config.py"
        mend = "go into the course folder, or make one by `primkit teach new-course DIR`; one that has lost this file"
        return [*installed, Finding("course folder", found, f"{mend} gets that of a new one")]
    looked_at = *_folder(course), *_sources(course), *_points(course), *_settings(course), *_secrets(course)
    return [*installed, *looked_at, *_gradebook(course)]


def _packages(environment: Path) -> Iterator[Finding]:
    """Compare what is installed with what environment.txt says, or only look whether it is there."""
    if environment.is_file():
        pins = pins_in(environment)
        mend = f"{PIP} install -r {environment}"
    else:
        pins = dict.fromkeys(REQUIRED_PACKAGES, "")  # by their own names: "primkit" is somebody else's on PyPI
        mend = f"{PIP} install {' '.join(pins)}"
    wrong = 0
    for name, wanted in pins.items():
        found = version_of(name) or "missing"
        if found == "missing" or (wanted and found != wanted):
            wrong += 1
            yield Finding(name, f"{found}, needs {wanted}" if wanted else found, mend)
    if not wrong:
        found = f"all {len(pins)} as in {environment.name}" if environment.is_file() else "all there"
        yield Finding("packages", found, fine=True)


def _commands() -> Iterator[Finding]:
    """Look for alembic: nbgrader calls it by its name to make a gradebook."""
    scripts = Path(sysconfig.get_path("scripts"))
    found = next((scripts / name for name in ("alembic", "alembic.exe") if (scripts / name).exists()), None)
    mend = f"{PIP} install --force-reinstall alembic"
    yield Finding("alembic", str(found or f"not in {scripts}"), mend, bool(found))


def _walls() -> Finding:
    """Look what stands between a student's code and the teacher's files while it runs."""
    words = (
        "Debian and Ubuntu: sudo apt install bubblewrap; what else helps stands in the pack's page untrusted_code.md"
    )
    walls = confined_by()
    found = f"behind the walls of {walls}" if walls else UNPROTECTED
    return Finding("submissions run", found, words, bool(walls) or not sys.platform.startswith("linux"))


def _folder(course: Course) -> Iterator[Finding]:
    careful = CAREFUL in (course.root / "nbgrader_config.py").read_text(encoding="utf-8")
    mend = f"put {CAREFUL} into c.Autograde.autograde_preprocessors, as in a new course"
    found = "ours" if careful else "runs submissions without limits"
    yield Finding("nbgrader_config.py", found, mend, careful)
    try:
        with tempfile.TemporaryFile(dir=course.root):
            pass
        yield Finding("course folder", f"{course.root} can be written", fine=True)
    except OSError as error:
        yield Finding("course folder", f"{course.root}: {error.strerror}", "give yourself the right to write there")


def _sources(course: Course) -> Iterator[Finding]:
    for name in COPIED_FOLDERS:
        there = (course.root / name).is_dir()
        mend = f"copy notebooks/assignments/{name} of the project's folder into {course.root}"
        yield Finding(f"{name}/", "there" if there else "missing", mend, there)
    if (course.root / "source").is_dir():
        sets = course.sets()
        yield Finding("problem sets", ", ".join(sets) or "none", "copy them into source/", bool(sets))
        for fault in misplaced(course):
            told, _, mend = fault.says.partition(": ")
            yield Finding(fault.cell, told, mend)


def _points(course: Course) -> Iterator[Finding]:
    """Compare the points of hidden cells with those that their tests give."""
    if not all((course.root / name).is_dir() for name in COPIED_FOLDERS):
        return
    with hidden_tests_of(course.root):
        found = list(_points_of(course))
    for place, cell, gives in found:
        if gives != cell:
            told = f"the cell has {cell} points, its hidden tests give {gives}"
            yield Finding(place, told, "let the parts in grader/ sum up to the cell's points, or change the cell's")
    if all(gives == cell for _, cell, gives in found):
        yield Finding("points", f"{len(found)} hidden tests give what their cells say", fine=True)


def _points_of(course: Course) -> Iterator[tuple[str, float, float | str]]:
    """Yield for each hidden test its place, its cell's points and those that it gives, or an error instead."""
    for path in sorted((course.root / "source").glob("*/*.ipynb")):
        for mark, cell in marked(read_notebook(path)):
            about, source = cell["metadata"]["nbgrader"], text_of(cell)
            task = MARK.search(source)
            if about.get("grade") and about.get("points") and task:  # one of 0 points was dropped
                gives: float | str
                try:
                    scope: dict[str, Any] = {}
                    tree = ast.parse(source)
                    tree.body = [each for each in tree.body if isinstance(each, (ast.Import, ast.ImportFrom))]
                    exec(compile(tree, mark, "exec"), scope)
                    gives = float(eval(task[1], scope).points)
                except Exception as error:
                    gives = f"{type(error).__name__}: {error}"
                yield f"source/{path.parent.name}, {mark}", about.get("points"), gives


def _settings(course: Course) -> Iterator[Finding]:
    """Read due dates and the late rule."""
    from .late import Late

    try:
        late = Late.of(course.root)
    except ValueError as error:
        yield Finding(SETTINGS, str(error).removeprefix(f"{SETTINGS}: "), "write it as in a new course's file")
        return
    for name in sorted({*late.due, *(name for name, _ in late.later)} - {*course.sets()}):
        yield Finding(SETTINGS, f"there is no problem set {name}", "write its folder's name in source/")
    yield Finding(SETTINGS, count(len(late.due), "due date"), fine=True)


def _secrets(course: Course) -> Iterator[Finding]:
    for what, look in (("salt.txt", course.salt), ("students.csv", course.students)):
        try:
            found = look()
        except ValueError as error:
            told, _, mend = str(error).removeprefix(f"{what}: ").partition(": ")
            yield Finding(what, told, mend or "see the first line of a new course's file")
            continue
        number = count(len(found), "student" if isinstance(found, list) else "character")
        number += " yet: fill it in before you collect" * (not found)
        students, encoding = read_students(course.root / STUDENTS) if isinstance(found, list) else ([], "")
        # A list in cp1252 could be in another such alphabet.
        odd = next((each.name for each in students if encoding == "cp1252" and not each.name.isascii()), "")
        number += f"; is one of them called {odd}? If not: {SAVE_AS}" if odd else ""
        yield Finding(what, number, fine=True)
        for name in course.sets() if what == "students.csv" else ():
            for fault in strangers(course, name):
                told, _, mend = fault.says.partition("? ")
                yield Finding(f"submitted/{fault.student}/{name}", told, mend)
    salt = course.root / "salt.txt"
    if os.name == "posix" and salt.is_file() and salt.stat().st_mode & 0o077:
        yield Finding("salt.txt", "others on this computer can read it", f"chmod 600 {salt}")


def _gradebook(course: Course) -> Iterator[Finding]:
    path = course.root / "gradebook.db"
    if not path.exists():
        yield Finding("gradebook.db", "not yet there: the first release makes it", fine=True)
        return
    try:
        with sqlite3.connect(f"file:{path.as_posix()}?mode=ro", uri=True) as base:
            tables = {row[0] for row in base.execute("select name from sqlite_master where type = 'table'")}
            sound = base.execute("pragma quick_check").fetchone()[0]
    except sqlite3.Error as error:
        yield Finding("gradebook.db", str(error), "put a copy from before back, or move it away and grade again")
        return
    if sound != "ok" or not {"assignment", "student", "grade"} <= tables:
        mend = "put a copy from before back, or move it away, release and grade again: submitted/ holds all it needs"
        yield Finding("gradebook.db", sound if sound != "ok" else "is no gradebook", mend)
    else:
        yield Finding("gradebook.db", "sound", fine=True)
