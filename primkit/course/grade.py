"""Grade: every submission of a problem set on its own, unattended.

nbgrader's ``autograde`` runs once for each student, in a process of its own with a time limit, so that nothing that one
submission does can cost another one. What was graded already and has not changed since is passed over.

In:  ``submitted/<student>/<problem set>/``.
Out: the gradebook, ``autograded/`` and ``feedback/``; ``reports/<problem set>/graded.json`` with all that went wrong,
     and a log for each student.
"""

from __future__ import annotations

import json
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any

from ..arguments import short
from ..formats.files import bounded_read, naming, write_atomically
from ..formats.values import parsed
from .course import SANITIZE_STEPS, Course
from .handed_in import Fault, file_faults, strangers, tree_hash
from .handing_back import hand_back, unmarked_answers
from .moved import refuse_old_names
from .running import nbgrader

FAULT_FIELDS = {field.name for field in fields(Fault)}
SUBMISSION_SECONDS = 1800.0  # for one submission: far more than its cells' own limits come to


def grade(
    course: Course, name: str, *, again: bool = False, only: Sequence[str] = (), say: Callable[[str], None]
) -> list[Fault]:
    """Grade all submissions of a problem set, and return what went wrong, one fault for each thing.

    Raises ValueError if nothing was handed in or released, or the course names what has moved.

    Parameters
    ----------
    course, name : Course, str
        The course, and a problem set of it that was released: the gradebook knows it from there.
    again : bool
        Whether to grade submissions again that have not changed.
    only : sequence of str
        These students alone; everybody when empty.
    say : callable
        Is called with a line for each student, and with those of the summary.
    """
    students = _students_to_grade(course, name, only)
    say(f"nbgrader runs {len(students)} submission{'s' * (len(students) != 1)}, each for some seconds")
    folders = [course.root / "submitted" / student / name for student in course.submitted(name)]
    before, start = tree_hash(*folders), time.monotonic()
    journal, counts = Journal(course, name), Counter[str]()
    for number, student in enumerate(students, 1):
        verdict, line = _grade_one(course, name, student, journal, again)
        counts[verdict] += 1
        say(f"{number:4d} of {len(students)}  {student}: {line}")
    if counts["graded"]:
        made = nbgrader(course, "generate_feedback", name, "--force", log=course.reports(name) / "log" / "feedback.txt")
        say("feedback/ is ready" if made.code == 0 else f"feedback/ is not complete: {made.reason}")
    open_cells = unmarked_answers(course, name)
    hand_back(course, name, journal.entries if counts["graded"] else journal.failed(), open_cells)
    told = ", ".join(f"{counts[words]} {words}" for words in ("graded", "unchanged", "not graded") if counts[words])
    say(f"{len(students)} submission{'s' * (len(students) != 1)} in {time.monotonic() - start:.0f} s: {told}")
    same = tree_hash(*folders) == before
    say(f"submitted/ is {'as it was' if same else 'CHANGED: the journal tells whose run it was'}")
    if number := sum(map(len, open_cells.values())):
        answers = "answer waits" if number == 1 else "answers wait"
        say(
            f"{number} written {answers} to be marked by hand: in formgrader, a page of `jupyter lab`; then "
            f"`nbgrader generate_feedback {name} --force`"
        )
    return [*strangers(course, name), *journal.faults()]


def _students_to_grade(course: Course, name: str, only: Sequence[str]) -> list[str]:
    """Return who is graded, or say in one sentence why nobody can be."""
    everybody = course.submitted(name)
    if unknown := sorted(set(only) - set(everybody)):
        raise ValueError(f"nothing was handed in for {name} by {', '.join(unknown)}")
    if not everybody:
        raise ValueError(f"nothing was handed in: put notebooks into submitted/<student>/{name}/ in {course.root}")
    if not (course.root / "release" / name).is_dir():
        raise ValueError(f"{name} was not released: run `primkit teach release {name}` first, for nbgrader needs it")
    refuse_old_names(course, name)
    return list(only) or everybody


def _grade_one(course: Course, name: str, student: str, journal: Journal, again: bool) -> tuple[str, str]:
    """Grade one submission; return how it went, in one of three words and in a line."""
    folder = course.root / "submitted" / student / name
    before = tree_hash(folder, course.root / "source" / name, course.root / "grader")
    if not again and journal.knows(student, before):
        return "unchanged", "graded before, and not changed since"
    faults, start = file_faults(course, name, student), time.monotonic()
    if not faults:
        steps = f"--Autograde.sanitize_preprocessors={SANITIZE_STEPS}"  # also in a course that was made without
        words = ("autograde", name, f"--student={student}", "--force", steps)
        done = nbgrader(course, *words, log=course.reports(name) / "log" / f"{student}.txt", seconds=SUBMISSION_SECONDS)
        if done.code != 0:
            faults.append(Fault(student, "-", "not graded", f"nbgrader could not grade it: {done.reason}"))
    graded = not faults
    if graded:
        faults += list(_read_faults(course, name, student))
    if tree_hash(folder, course.root / "source" / name, course.root / "grader") != before:
        says = "while it ran, files in submitted/, source/ or grader/ changed"
        faults.append(Fault(student, "-", "changed files", says))
    journal.write(student, before, graded, faults)
    told = "; ".join(f"{fault.cell}: {fault.says}" for fault in faults)
    if not graded:
        return "not graded", told
    return "graded", "; ".join(filter(None, [f"graded in {time.monotonic() - start:.0f} s", told]))


def _read_faults(course: Course, name: str, student: str) -> Iterator[Fault]:
    """Yield what happened while the cells ran."""
    for notebook in course.notebooks(name):
        path = course.root / "autograded" / student / name / f"{notebook}.ipynb"
        noted: Any = json.loads(path.read_text(encoding="utf-8"))["metadata"].get("primkit", {})
        for fault in noted.get("faults", ()):
            yield Fault(student, fault["cell"], fault["name"], fault["says"])


def _entries_in(path: Path) -> dict[str, Any]:
    """Return what a journal holds, or say in one sentence that it is none."""
    with naming(path.name):
        told = parsed(bounded_read(path))
        for entry in told.values() if isinstance(told, dict) else [told]:
            if not isinstance(entry, dict) or {*entry} != {"hash", "graded", "faults"}:
                rule = "must hold the hash, the verdict and the faults of each student"
                raise ValueError(f"{rule}, got {short(entry)}: put it away, and grade again")
            faults = entry["faults"] if isinstance(entry["faults"], list) else [entry["faults"]]
            if any(not isinstance(fault, dict) or {*fault} != FAULT_FIELDS for fault in faults):
                raise ValueError(f"must hold faults with {', '.join(sorted(FAULT_FIELDS))}, got {short(faults)}")
        return dict(told)


class Journal:
    """What has been graded, in a file that is written after every student."""

    def __init__(self, course: Course, name: str) -> None:
        self.path: Path = course.reports(name) / "graded.json"
        self.entries: dict[str, Any] = {}
        if self.path.is_file():
            self.entries = _entries_in(self.path)

    def knows(self, student: str, hashed: str) -> bool:
        """Tell whether these very files were graded."""
        entry = self.entries.get(student, {})
        return bool(entry.get("hash") == hashed and entry.get("graded"))

    def write(self, student: str, hashed: str, graded: bool, faults: Sequence[Fault]) -> None:
        """Write down what came out for a student."""
        told = [fault.data() for fault in faults]
        self.entries[student] = {"hash": hashed, "graded": graded, "faults": told}
        write_atomically(self.path, json.dumps(self.entries, indent=1, sort_keys=True))

    def failed(self) -> dict[str, Any]:
        """Return the entries of those that could not be graded."""
        return {student: entry for student, entry in self.entries.items() if not entry["graded"]}

    def faults(self) -> list[Fault]:
        """Return all that went wrong, student by student."""
        return [Fault(**fault) for _, entry in sorted(self.entries.items()) for fault in entry["faults"]]
