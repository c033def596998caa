"""Overview: what a class did in a problem set, task by task and part by part.

In:  the gradebook, and the marks that the hidden tests left in the autograded notebooks.
Out: an ``Overview``: for each task and part the mean, the share of right answers and the usual wrong ones; and one line
     for each thing that went wrong.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from textwrap import shorten
from typing import Any

from .course import Course
from .grade import Journal
from .grading.mark import MIME
from .handed_in import Fault, strangers

UNNAMED = "wrong in another way"
VISIBLE_LETTERS = 60  # letters of a visible test's own words


@dataclass
class Line:
    """How the class did in one task or part."""

    task: str
    part: str  # empty for a whole task
    of: float
    points: list[float] = field(default_factory=list)
    wrong: Counter[str] = field(default_factory=Counter)
    open: int = 0  # answers that a person has still to mark

    @property
    def mean(self) -> float:
        """Mean points of all who handed in."""
        return sum(self.points) / len(self.points) if self.points else 0.0

    @property
    def right(self) -> float:
        """Share of those who have all points."""
        return sum(points >= self.of for points in self.points) / len(self.points) if self.points else 0.0


@dataclass(frozen=True)
class Overview:
    """A class and a problem set."""

    name: str
    handed_in: int
    graded: int
    of: float
    scores: dict[str, float]
    lines: tuple[Line, ...]
    faults: tuple[Fault, ...]  # of files and cells: what a teacher should look at
    wrong: tuple[tuple[str, str, str, str, str], ...]  # student, task, part, name, what is off

    @property
    def mean(self) -> float:
        """Mean score of those who were graded."""
        return sum(self.scores.values()) / len(self.scores) if self.scores else 0.0

    def parts(self) -> list[Line]:
        """Return the lines that no other line is made of."""
        whole = {line.task for line in self.lines if line.part}
        return [line for line in self.lines if line.part or line.task not in whole]


def overview(course: Course, name: str) -> Overview:
    """Read what a class did in a problem set.

    Raises ValueError if nothing has been graded yet.
    """
    from nbgrader.api import Gradebook, MissingEntry

    journal = Journal(course, name)
    students = sorted(student for student, entry in journal.entries.items() if entry["graded"])
    if not students:
        raise ValueError(f"nothing of {name} has been graded yet: run `primkit teach grade {name}` first")
    lines: dict[tuple[str, str], Line] = {}
    scores: dict[str, float] = {}
    wrong: list[tuple[str, str, str, str, str]] = []
    cells = {student: _read_cells(course, name, student) for student in students}
    tasks = {cell: mark for marked in cells.values() for cell, (mark, _) in marked.items() if mark}
    with Gradebook(f"sqlite:///{(course.root / 'gradebook.db').as_posix()}") as book:
        of = float(book.find_assignment(name).max_score)
        for student in students:
            try:
                submission = book.find_submission(name, student)
            except MissingEntry:
                continue
            scores[student] = float(submission.score)
            for grade in (grade for notebook in submission.notebooks for grade in notebook.grades):
                mark, error = cells[student].get(grade.cell.name, (None, None))
                like = tasks.get(grade.cell.name)
                called = like["task"] if like else grade.cell.name
                line = lines.setdefault((grade.cell.name, ""), Line(called, "", grade.max_score))
                line.points.append(float(grade.score))
                line.open += bool(grade.needs_manual_grade)
                if like:
                    wrong += _add_parts(lines, grade.cell.name, student, mark, like, error)
                elif error and grade.score < grade.max_score:
                    called, says = _name_error(grade.cell.name, *error)
                    line.wrong[called] += 1
                    wrong.append((student, grade.cell.name, "", called, says))
    faults = (*strangers(course, name), *journal.faults())
    handed_in = len(course.submitted(name))
    return Overview(name, handed_in, len(scores), of, scores, tuple(lines.values()), faults, tuple(wrong))


def _add_parts(
    lines: dict[tuple[str, str], Line], cell: str, student: str, mark: Any, like: Any, error: tuple[str, str] | None
) -> Iterator[tuple[str, str, str, str, str]]:
    """Add the parts of one hidden test, and yield those that are not right."""
    for part in (mark or like)["parts"]:
        line = lines.setdefault((cell, part["says"]), Line(like["task"], part["says"], part["of"]))
        if mark is None:  # the cell failed before its points came out
            name, says = error or (UNNAMED, "")
            points = 0.0
        else:
            points = float(part["points"])
            name = part["fault"] or ("not attempted" if part["verdict"] == "not attempted" else UNNAMED)
            says = part["off"]
        line.points.append(points)
        if points < part["of"]:
            line.wrong[name] += 1
            yield student, like["task"], part["says"], name, says


def _read_cells(course: Course, name: str, student: str) -> dict[str, tuple[Any, tuple[str, str] | None]]:
    """Return for each graded code cell the mark that it shows, or its error."""
    found: dict[str, tuple[Any, tuple[str, str] | None]] = {}
    for notebook in course.notebooks(name):
        path = course.root / "autograded" / student / name / f"{notebook}.ipynb"
        for cell in json.loads(path.read_text(encoding="utf-8"))["cells"] if path.is_file() else ():
            about = cell["metadata"].get("nbgrader", {})
            if about.get("grade") and cell["cell_type"] == "code":
                found[about["grade_id"]] = _read_outputs(cell["outputs"])
    return found


def _name_error(cell: str, name: str, says: str) -> tuple[str, str]:
    """Return a name and words for the error of a visible test, as a teacher would say them.

    >>> _name_error("half-visible", "AssertionError", "got 2, expected 1")
    ('got 2, expected 1', 'got 2, expected 1')
    >>> _name_error("half-visible", "NameError", "name 'half' is not defined")
    ('no such function', "name 'half' is not defined")
    """
    if name in ("KeyboardInterrupt", "CellTimeoutError"):
        return "out of time", says
    if name == "NameError" and f"'{cell.removesuffix('-visible')}'" in says:
        return "no such function", says
    words = " ".join(says.split())
    return (shorten(words, VISIBLE_LETTERS, placeholder=" ...") if name == "AssertionError" and words else name), says


def _read_outputs(outputs: Sequence[Any]) -> tuple[Any, tuple[str, str] | None]:
    """Return the mark among a cell's outputs; or the name and words of its error."""
    errors = [output for output in outputs if output["output_type"] == "error"]
    marks = [output["data"][MIME] for output in outputs if MIME in output.get("data", {})]
    if errors:
        name = "not attempted" if errors[0]["ename"] == "NotImplementedError" else errors[0]["ename"]
        return None, (name, errors[0]["evalue"])
    if any(output["output_type"] == "stream" and output["name"] == "stderr" for output in outputs):
        return None, ("writes to stderr", "nbgrader takes this as a failed test")
    return (marks[-1] if marks else None), None
