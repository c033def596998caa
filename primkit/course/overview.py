"""Overview: what a class did in a problem set, task by task and part by part.

In:  the gradebook, and the marks that the hidden tests left in the autograded notebooks.
Out: an ``Overview``: for each task and part the mean, the share of right answers, how well it parts the good from the
     weak, and the usual wrong answers; the kinds of them, those that fail alike, with what a teacher has written about
     each into ``kinds.csv``, in any spreadsheet; a line for each thing that went wrong.
"""

from __future__ import annotations

import hashlib
import re
from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from statistics import StatisticsError, correlation
from textwrap import shorten
from typing import Any

from ..formats.files import naming
from .course import Course
from .graded import Journal
from .grading.mark import MIME
from .handed_in import Fault, misplaced, strangers
from .notebooks import marked, read_notebook
from .students import read_table

KINDS_FILE = "kinds.csv"
KINDS_HEADER = ("kind", "task", "students", "what", "who", "comment")
WHO = 5  # students that are named for each kind
UNNAMED = "wrong in another way"
VISIBLE_LETTERS = 60  # letters of a visible test's own words


@dataclass
class Line:
    """How the class did in one task or part."""

    task: str
    part: str  # empty for a whole task
    of: float
    points: dict[str, float] = field(default_factory=dict)  # of each student
    wrong: Counter[str] = field(default_factory=Counter)
    open: int = 0  # answers that a person has still to mark
    seconds: list[float] = field(default_factory=list)  # of processor time that a student's functions took

    @property
    def mean(self) -> float:
        """Mean points of all who handed in."""
        return sum(self.points.values()) / len(self.points) if self.points else 0.0

    @property
    def right(self) -> float:
        """Share of those who have all points."""
        return sum(points >= self.of for points in self.points.values()) / len(self.points) if self.points else 0.0

    def parts_well(self, scores: dict[str, float]) -> float | None:
        """Return the correlation of these points with all the others: 0 tells nothing of a student, below 0 misleads.

        >>> Line("half", "", 2, {"a": 2, "b": 0, "c": 2}).parts_well({"a": 9, "b": 3, "c": 8})
        0.9707253433941511
        """
        mine = [(points, scores[student] - points) for student, points in self.points.items() if student in scores]
        try:
            return correlation(*zip(*mine, strict=True))
        except (StatisticsError, TypeError):  # fewer than two, or all alike
            return None


@dataclass(frozen=True)
class Wrong:
    """One answer that is not right: whose, in which task and part, by the name of the fault and in words."""

    student: str
    task: str
    part: str
    name: str
    says: str


@dataclass(frozen=True)
class Kind:
    """Wrong answers to a task that fail alike: in the same parts, with the same faults."""

    code: str  # of what they have in common: the same in every report
    task: str
    says: str
    students: tuple[str, ...]


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
    wrong: tuple[Wrong, ...]

    @property
    def mean(self) -> float:
        """Mean score of those who were graded."""
        return sum(self.scores.values()) / len(self.scores) if self.scores else 0.0

    def kinds(self) -> list[Kind]:
        """Return the kinds of wrong answers, the most frequent first; a stub that nobody touched is no answer."""
        groups: dict[tuple[str, str], list[str]] = defaultdict(list)
        failed: dict[tuple[str, str], list[Wrong]] = defaultdict(list)
        for wrong in self.wrong:
            failed[wrong.student, wrong.task].append(wrong)
        for (student, task), wrongs in failed.items():
            if any(wrong.name != "not attempted" for wrong in wrongs):
                told = [": ".join(filter(None, [w.part, _named(w)])) for w in wrongs]
                groups[task, "; ".join(told)].append(student)
        kinds = [
            Kind(hashlib.sha256(f"{task}\0{says}".encode()).hexdigest()[:8], task, says, tuple(sorted(students)))
            for (task, says), students in groups.items()
        ]
        return sorted(kinds, key=lambda kind: (-len(kind.students), kind.task, kind.says))

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
    wrong: list[Wrong] = []
    faults = [*misplaced(course), *strangers(course, name), *journal.faults()]
    cells = {student: _read_cells(course, name, student) for student in students}
    tasks = {cell: shown.mark for seen in cells.values() for cell, shown in seen.items() if shown.mark}
    with Gradebook(course.gradebook) as book:
        of = float(book.find_assignment(name).max_score)
        for student in students:
            try:
                submission = book.find_submission(name, student)
            except MissingEntry:
                faults.append(
                    Fault(student, "-", "missing set", f"the gradebook has no {name} of theirs: grade it again")
                )
                continue
            scores[student] = max(0.0, float(submission.score) - float(submission.late_submission_penalty or 0))
            if scores[student] > of:
                faults.append(Fault(student, "-", "above the maximum", f"{scores[student]:g} of {of:g} points"))
            for grade in (grade for notebook in submission.notebooks for grade in notebook.grades):
                shown = cells[student].get(grade.cell.name, Shown())
                like = tasks.get(grade.cell.name)
                called = like["task"] if like else grade.cell.name
                line = lines.setdefault((grade.cell.name, ""), Line(called, "", grade.max_score))
                line.points[student] = float(grade.score)
                line.open += bool(grade.needs_manual_grade)
                if shown.seconds is not None:
                    line.seconds.append(shown.seconds)
                if grade.score > grade.max_score:
                    says = f"{grade.score:g} of {grade.max_score:g} points"
                    faults.append(Fault(student, grade.cell.name, "above the maximum", says))
                if like:
                    wrong += _add_parts(lines, grade.cell.name, student, shown, like)
                elif shown.error and grade.score < grade.max_score:
                    called, says = _name_error(grade.cell.name, *shown.error)
                    line.wrong[called] += 1
                    wrong.append(Wrong(student, grade.cell.name, "", called, says))
    for (cell, part), line in lines.items():
        if not part and cell in tasks and (gives := tasks[cell].get("of")) != line.of:
            says = f"the cell has {line.of:g} points, its hidden tests {gives}: mend one, then release again"
            faults.append(Fault("-", cell, "differing points", says))
    return Overview(
        name, len(course.submitted(name)), len(scores), of, scores, tuple(lines.values()), tuple(faults), tuple(wrong)
    )


@dataclass(frozen=True)
class Shown:
    """What a graded cell shows: a mark, or an error's name and words; and how long the student's functions took."""

    mark: Any = None
    error: tuple[str, str] | None = None
    seconds: float | None = None


def _add_parts(lines: dict[tuple[str, str], Line], cell: str, student: str, shown: Shown, like: Any) -> Iterator[Wrong]:
    """Add the parts of one hidden test, and yield those that are not right."""
    for part in (shown.mark or like)["parts"]:
        line = lines.setdefault((cell, part["says"]), Line(like["task"], part["says"], part["of"]))
        if shown.mark is None:  # the cell failed before its points came out
            name, says = shown.error or (UNNAMED, "")
            points = 0.0
        else:
            points = float(part["points"])
            name = part["fault"] or ("not attempted" if part["verdict"] == "not attempted" else UNNAMED)
            says = part["off"]
        line.points[student] = points
        if points < part["of"]:
            line.wrong[name] += 1
            yield Wrong(student, like["task"], part["says"], name, says)


def _read_cells(course: Course, name: str, student: str) -> dict[str, Shown]:
    """Return what each graded code cell shows."""
    found: dict[str, Shown] = {}
    for notebook in course.notebooks(name):
        for mark, cell in marked(read_notebook(course.root / "autograded" / student / name / f"{notebook}.ipynb")):
            if cell["metadata"]["nbgrader"].get("grade") and cell["cell_type"] == "code":
                seconds = cell["metadata"].get("primkit", {}).get("seconds")
                found[mark] = _read_outputs(cell["outputs"], seconds)
    return found


def _named(wrong: Wrong) -> str:
    """Return the name of what is off, or what is off without the values of one student.

    >>> _named(Wrong("ada", "half", "", UNNAMED, "in 3 of 8 cases. For example half(x=3): got 0.5 m, expected 1.5 m."))
    'in some cases'
    """
    if wrong.name != UNNAMED:
        return wrong.name
    words = re.sub(r"in \d+ of \d+ cases", "in some cases", wrong.says)
    return re.sub(r"[-+]?\d[\d.e+-]*", "#", words.partition(". For example")[0].partition("\n")[0])


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


def _read_outputs(outputs: Sequence[Any], seconds: float | None) -> Shown:
    """Return the mark among a cell's outputs; or the name and words of its error."""
    errors = [output for output in outputs if output["output_type"] == "error"]
    marks = [output["data"][MIME] for output in outputs if _is_mark(output.get("data", {}).get(MIME))]
    if errors:
        name = "not attempted" if errors[0]["ename"] == "NotImplementedError" else errors[0]["ename"]
        return Shown(None, (name, errors[0]["evalue"]), seconds)
    if any(output["output_type"] == "stream" and output["name"] == "stderr" for output in outputs):
        return Shown(None, ("writes to stderr", "nbgrader takes this as a failed test"), seconds)
    return Shown(marks[-1] if marks else None, None, seconds)


def _is_mark(told: Any) -> bool:
    """Tell whether this is a mark: a submission may show anything in its place."""
    parts = told.get("parts") if isinstance(told, dict) else None
    names = {"says", "points", "of", "verdict", "fault", "off"}
    return isinstance(parts, list) and all(isinstance(part, dict) and names <= {*part} for part in parts)


# --- kinds of answers ----------------------------------------------------------------------------------------


def comments_of(course: Course, name: str) -> dict[str, str]:
    """Return what a teacher has written about the kinds of answers: a kind's code -> comment."""
    path = course.reports(name) / KINDS_FILE
    if not path.is_file():
        return {}
    with naming(KINDS_FILE):
        header, rows, _ = read_table(path)
        if missing := sorted({"kind", "comment"} - {*header}):
            raise ValueError(f"must have the columns kind and comment, lacks {', '.join(missing)}")
    return {row["kind"]: row["comment"] for _, row in rows if row.get("kind") and row.get("comment")}


def kinds_rows(course: Course, seen: Overview) -> Iterator[tuple[Any, ...]]:
    """Yield a row for each kind, with its comment; in the end those with a comment that nobody gives any more."""
    comments = comments_of(course, seen.name)
    for kind in seen.kinds():
        who = " ".join(kind.students[:WHO]) + " ..." * (len(kind.students) > WHO)
        yield kind.code, kind.task, len(kind.students), kind.says, who, comments.pop(kind.code, "")
    for code, comment in comments.items():
        yield code, "", 0, "nobody's answer any more", "", comment
