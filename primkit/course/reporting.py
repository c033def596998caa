"""Reporting: the overview of a class as text, as tables for a spreadsheet, and as a figure.

In:  an ``Overview``.
Out: lines for the screen; ``overview.csv`` (tasks and parts), ``wrong.csv`` (each wrong answer), ``kinds.csv`` (those
     that fail alike, with a place for a comment), ``faults.csv`` (what a teacher should look at), ``grades.csv``
     (nbgrader's own export), ``class.csv`` (one row a student, all sets and their states) and ``overview.png``.
"""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterator, Sequence
from dataclasses import astuple
from statistics import median
from typing import Any

import numpy as np

from ..formats.files import write_atomically
from ..plots.class_marks import plot_class
from ..plots.story import save_figure
from ..table import Table, as_csv, count
from .course import Course
from .graded import Journal
from .handed_in import listed_students
from .handing_back import unmarked_answers
from .overview import KINDS_FILE, KINDS_HEADER, Line, Overview, kinds_rows, overview
from .running import nbgrader
from .students import Student

USUAL_FAULTS = 3  # wrong answers that are told for each part
CLOCK_SECONDS = 0.01  # a system tells no finer processor time
OVERVIEW_HEADER = (
    *("task", "part", "of", "students", "mean", "share_right", "parts_well", "seconds", "to_mark_by_hand"),
    *(f"{what}_{k}" for k in range(1, USUAL_FAULTS + 1) for what in ("wrong", "count")),
)


def report(course: Course, name: str) -> Iterator[str]:
    """Write the reports on a problem set, and yield what is said about it."""
    seen = overview(course, name)
    folder = course.reports(name)
    tables = {
        "overview.csv": (OVERVIEW_HEADER, _overview_rows(seen)),
        "wrong.csv": (("student", "task", "part", "name", "what"), (astuple(wrong) for wrong in seen.wrong)),
        KINDS_FILE: (KINDS_HEADER, list(kinds_rows(course, seen))),
        "faults.csv": (("student", "cell", "name", "what"), (astuple(fault) for fault in seen.faults)),
    }
    for file, (header, rows) in tables.items():
        write_atomically(folder / file, as_csv(header, rows))
    parts = seen.parts()
    figure = plot_class(
        name,
        seen.graded,
        [(line.task, line.part, line.right, (_usual_faults(line) or [("", 0)])[0]) for line in parts if not line.open],
    )
    save_figure(figure, folder / "overview.png")
    exported = nbgrader(course, "export", f"--to={folder / 'grades.csv'}")
    yield from _tell(seen)
    if exported.code == 0:
        with open(folder / "grades.csv", encoding="utf-8", newline="") as export:
            grades = list(csv.DictReader(export))
        write_atomically(folder / "class.csv", as_csv(*_by_student(course, grades)))
        graded, there = {row["assignment"] for row in grades}, course.sets()
        for each in sorted(set(there) - graded):
            if (course.root / "release" / each).is_dir():
                yield f"missing set: {each} is released, and not in the gradebook: release it again"
        for each in sorted(graded - set(there)):
            yield f"missing set: {each} is in the gradebook, and not in source/: class.csv counts its points"
    yield ""
    yield f"Wrote  {', '.join([*tables, 'overview.png'])} in {folder}"
    yield (
        f"Wrote  {folder / 'grades.csv'}: nbgrader's export; and class.csv, one row a student, "
        "which tells the zeros apart"
        if exported.code == 0
        else f"nbgrader's export failed: {exported.reason}"
    )


def _by_student(course: Course, grades: Sequence[dict[str, str]]) -> tuple[list[str], list[list[Any]]]:
    """Return nbgrader's export with one row a student: points and state of each set, and all points together.

    The state tells whether a 0 is for an answer, for none, or for a broken file.
    """
    told = {(row["student_id"], row["assignment"]): float(row["score"]) for row in grades}
    of = {row["assignment"]: row["max_score"] for row in sorted(grades, key=lambda row: row["assignment"])}
    people = {student.id: student for student in course.roster()}
    columns = {name: _states(course, name) for name in of}
    table: list[list[Any]] = []
    for student in sorted({student for student, _ in told} | {*people}):
        points = [told.get((student, name), 0.0) for name in of]
        person = people.get(student, Student(student))
        table.append([student, person.first_name, person.last_name, *points, sum(points)])
        table[-1] += [columns[name](student) for name in of]
    header = ["id", "first_name", "last_name", *(f"{name} (of {most})" for name, most in of.items()), "all", *of]
    return header, table


def _states(course: Course, name: str) -> Callable[[str], str]:
    """Return what tells how it stands with a student's submission of a set."""
    if name not in course.sets():
        return lambda _student: "not in source/"
    entries, handed_in = Journal(course, name).entries, course.submitted(name)
    open_cells, listed = unmarked_answers(course, name), listed_students(course)

    def state(student: str) -> str:
        if (entry := entries.get(student)) is None:
            words = ["not yet graded" if student in handed_in else "nothing handed in"]
        elif entry["graded"]:
            words = ["graded"] + [f"{len(cells)} to be marked by hand" for cells in [open_cells[student]] if cells]
        else:
            words = ["could not be graded"]
        return "; ".join(words + ["not in students.csv"] * bool(listed and student not in listed))

    return state


def _spread(scores: Sequence[float], of: float) -> str:
    """Return how scores spread: quartiles, and how many lie in each fifth of the points.

    >>> _spread([0, 7, 9, 15], 15)
    'quarters at 5.25, 8, 10.5; 1 in 0 to 3, 0 in 3 to 6, 1 in 6 to 9, 1 in 9 to 12, 1 in 12 to 15 points'
    """
    low, middle, high = np.percentile(list(scores), (25, 50, 75))
    edges = np.linspace(0, of or 1, 6)
    numbers, _ = np.histogram(np.clip(list(scores), 0, of), edges)
    bins = ", ".join(f"{n} in {a:g} to {b:g}" for n, a, b in zip(numbers, edges[:-1], edges[1:], strict=True))
    return f"quarters at {low:.3g}, {middle:.3g}, {high:.3g}; {bins} points"


def _usual_faults(line: Line) -> list[tuple[str, int]]:
    """Return the most frequent wrong answers, the most frequent first; of as frequent ones, Python's errors last."""
    return sorted(line.wrong.items(), key=lambda item: (-item[1], item[0][:1].isupper(), item[0]))[:USUAL_FAULTS]


def _tell(seen: Overview) -> Iterator[str]:
    title = f"{seen.name}: {seen.handed_in} handed in, {seen.graded} graded; mean {seen.mean:.1f} of {seen.of:g} points"
    rows = []
    for line in (line for line in seen.lines if not line.part):
        rows.append(_row(line.task, line, seen))
        rows += [_row(f"  {part.part}", part, seen) for part in seen.lines if part.part and part.task == line.task]
    yield str(Table(("task, part", "mean", "right", "parts well", "usual wrong answers"), rows, title))
    yield f"Scores: {_spread(list(seen.scores.values()), seen.of)}"
    if kinds := seen.kinds():
        alike = sum(len(kind.students) for kind in kinds)
        yield f"{count(alike, 'wrong answer')} of {count(len(kinds), 'kind')}: a comment on one, in {KINDS_FILE},"
        yield f"reaches all who gave such an answer by `primkit teach hand-back {seen.name}`"
    if seen.faults:
        yield ""
        yield f"To look at ({len(seen.faults)}):"
        yield from (f"  {fault.student}  {fault.cell}  {fault.name}: {fault.says}" for fault in seen.faults)


def _row(name: str, line: Line, seen: Overview) -> tuple[str, ...]:
    usual = "; ".join(f"{count} x {fault}" for fault, count in _usual_faults(line)) if line.part or line.wrong else ""
    if line.open:
        usual = f"{line.open} to be marked by hand" + (f"; {usual}" if usual else "")
    apart = line.parts_well(seen.scores)
    told = "" if apart is None else f"{apart:+.2f}"
    return name, f"{line.mean:.2f} of {line.of:g}", f"{100 * line.right:.0f} %", told, usual


def _overview_rows(seen: Overview) -> Iterator[Sequence[Any]]:
    for line in seen.lines:
        usual = [entry for pair in _usual_faults(line) for entry in pair]
        apart, took = line.parts_well(seen.scores), median(line.seconds) if line.seconds else None
        told = f"<{CLOCK_SECONDS:g}" if took is not None and took < CLOCK_SECONDS else took
        numbers = (line.of, len(line.points), round(line.mean, 4), round(line.right, 4), apart, told, line.open)
        yield line.task, line.part, *numbers, *usual, *[""] * (2 * USUAL_FAULTS - len(usual))
