"""Handed in: whether there is a notebook that can be run, and whether it is still what was handed in.

In:  the folder of one submission.
Out: faults of the files, each in one sentence; and a hash of all that lies there.
"""

from __future__ import annotations

import hashlib
import json
import os
from dataclasses import dataclass
from pathlib import Path

from ..arguments import short
from .archives import readable_name
from .course import STUDENTS, Course
from .notebooks import marked
from .students import ID, ID_RULE

MOST_MEGABYTES = 16  # of a notebook: more is output that never ended


@dataclass(frozen=True)
class Fault:
    """One thing that went wrong: whose, where, its short name, and a sentence."""

    student: str
    cell: str
    name: str
    says: str


def file_faults(course: Course, name: str, student: str) -> list[Fault]:
    """Return why a submission cannot be run; nothing when it can."""
    folder = course.root / "submitted" / student / name
    if not ID.fullmatch(student):
        return [Fault(student, "-", "bad id", f"the folder's name must be made of {ID_RULE}")]
    faults = []
    for notebook in course.notebooks(name):
        path = folder / f"{notebook}.ipynb"
        if not path.is_file():
            others = ", ".join(sorted(other.name for other in folder.glob("*.ipynb"))) or "no notebook"
            faults.append((path.name, "missing", f"there is no {path.name}, found {others}"))
            continue
        if path.stat().st_size > MOST_MEGABYTES * 2**20:
            faults.append((path.name, "too large", f"has more than {MOST_MEGABYTES} MB: clear its outputs"))
        elif wrong := _not_a_notebook(path):
            faults.append((path.name, "not a notebook", wrong))
    return [Fault(student, where, short, says) for where, short, says in faults]


def listed_students(course: Course) -> list[str]:
    """Return the ids in the list of students; none while the list cannot be read, which ``check`` says."""
    try:
        return course.students()
    except ValueError:
        return []


def strangers(course: Course, name: str) -> list[Fault]:
    """Return a fault for each who handed in and is not in the list of students; none while the list is empty."""
    students = listed_students(course)
    unknown = [student for student in course.submitted(name) if students and student not in students]
    says = f"is not in {STUDENTS}: a typing error? rename the folder, or add a line and release again"
    return [Fault(student, "-", "not in the list", says) for student in unknown]


def misplaced(course: Course) -> list[Fault]:
    """Return a fault for each notebook in ``submitted/`` that no student and no problem set has."""
    sets, faults = course.sets(), []
    for path in sorted((course.root / "submitted").rglob("*.ipynb")):
        where = path.relative_to(course.root).parts
        hidden = any(part.startswith(".") for part in where)  # a copy of Jupyter's, or of a collection that was stopped
        if not hidden and (len(where) < 4 or where[2] not in sets):
            says = "lies where nothing is graded: put it into submitted/<student>/<problem set>/"
            faults.append(Fault("-", readable_name("/".join(where)), "misplaced", says))
    return faults


def _not_a_notebook(path: Path) -> str | None:
    """Return why a file is no notebook, or None."""
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
    except UnicodeDecodeError:
        return "is not text"
    except (ValueError, RecursionError) as error:
        return f"is not JSON: {short(str(error))[1:-1]}"
    if not isinstance(data, dict) or not isinstance(data.get("cells"), list):
        return "is JSON, but has no list of cells"
    if any(not isinstance(cell, dict) or not isinstance(cell.get("metadata", {}), dict) for cell in data["cells"]):
        return "is JSON, but has cells that are none"
    if not any(marked(data)):
        return "holds no cell of the problem set: was another notebook handed in, or its cells copied to a new one?"
    return None


def tree_hash(*folders: Path) -> str:
    """Return a hash of all files in folders: their names and what is in them."""
    digest = hashlib.sha256()
    for folder in folders:
        for path in sorted(folder.rglob("*")):
            if {"__pycache__", ".ipynb_checkpoints"} & set(path.parts):
                continue
            name = os.fsencode(path.relative_to(folder).as_posix())  # which need not be UTF-8
            digest.update(name + f"\0{path.is_file()}\0".encode())
            if path.is_file():
                digest.update(hashlib.sha256(path.read_bytes()).digest())
    return digest.hexdigest()
