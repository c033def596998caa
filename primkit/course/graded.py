"""Graded: what has been graded of a problem set, and what went wrong, in a file that is written after every student.

In:  how it went with one submission.
Out: ``reports/<problem set>/graded.json``, whole at any time: a run that is killed goes on from there.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any

from ..arguments import short
from ..formats.files import bounded_read, naming, write_atomically
from ..formats.values import parsed
from .course import Course
from .handed_in import Fault

FAULT_FIELDS = {field.name for field in fields(Fault)}


@dataclass(frozen=True)
class Graded:
    """How it went with one submission: in one of three words, in a line, and for the journal."""

    student: str
    verdict: str
    line: str
    hash: str = ""
    faults: Sequence[Fault] = ()


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

    def write(self, done: Graded) -> None:
        """Write down what came out for a student."""
        if done.verdict == "unchanged":
            return
        faults = [asdict(fault) for fault in done.faults]
        self.entries[done.student] = {"hash": done.hash, "graded": done.verdict == "graded", "faults": faults}
        write_atomically(self.path, json.dumps(self.entries, indent=1, sort_keys=True))

    def faults(self) -> list[Fault]:
        """Return all that went wrong, student by student."""
        return [Fault(**fault) for _, entry in sorted(self.entries.items()) for fault in entry["faults"]]
