"""Reporting: the overview of a class as text, as tables for a spreadsheet, and as a figure.

In:  an ``Overview``.
Out: lines for the screen; ``overview.csv`` (tasks and parts), ``wrong.csv`` (each wrong answer), ``kinds.csv`` (those
     that fail alike, with a place for a comment), ``faults.csv`` (what a teacher should look at), ``grades.csv``
     (nbgrader's own export), ``class.csv`` (one row a student, with all sets) and ``overview.png``.
"""

from __future__ import annotations

import csv
from collections.abc import Iterator, Sequence
from dataclasses import astuple
from pathlib import Path
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
from .handing_back import state, unmarked_answers
from .kinds import KINDS_FILE, KINDS_HEADER, kinds_rows
from .overview import Line, Overview, overview
from .running import nbgrader

USUAL_FAULTS = 3  # wrong answers that are told for each part
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
        "faults.csv": (("student", "cell", "name", "what"), (tuple(fault.data().values()) for fault in seen.faults)),
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
        grades = _add_states(course, folder / "grades.csv")
        write_atomically(folder / "class.csv", as_csv(*_by_student(course, grades)))
        yield from _missing_sets(course, {row["assignment"] for row in grades})
    yield ""
    yield f"Wrote  {', '.join([*tables, 'overview.png'])} in {folder}"
    yield (
        f"Wrote  {folder / 'grades.csv'}: nbgrader's export; its last column tells the zeros apart; and class.csv, "
        "one row a student"
        if exported.code == 0
        else f"nbgrader's export failed: {exported.reason}"
    )


def _add_states(course: Course, path: Path) -> list[dict[str, str]]:
    """Add a last column to nbgrader's export: whether a 0 is for an answer, for none, or for a broken file."""
    with open(path, encoding="utf-8", newline="") as file:
        head, *rows = list(csv.reader(file))
    students = listed_students(course)
    sets = {name for name in course.sets() if (course.root / "release" / name).is_dir()}
    journals = {name: Journal(course, name).entries for name in sets}
    handed_in = {name: set(course.submitted(name)) for name in sets}
    open_cells = {name: unmarked_answers(course, name) for name in sets}
    where = head.index("assignment"), head.index("student_id")
    rows.sort(key=lambda row: [row[k] for k in where])  # nbgrader's own order changes from course to course
    for row in rows:
        name, student = (row[k] for k in where)
        if name in sets:
            row.append(
                state(
                    journals[name].get(student),
                    handed_in=student in handed_in[name],
                    open_cells=len(open_cells[name].get(student, ())),
                    listed=not students or student in students,
                )
            )
        else:
            row.append("not in source/")
    write_atomically(path, as_csv([*head, "state"], rows))
    return [dict(zip([*head, "state"], row, strict=True)) for row in rows]


def _by_student(course: Course, rows: Sequence[dict[str, str]]) -> tuple[list[str], list[list[Any]]]:
    """Return nbgrader's export with one row a student: points and state of each set, and all points together."""
    sets = sorted({row["assignment"] for row in rows})
    told = {(row["student_id"], row["assignment"]): row for row in rows}
    of = {row["assignment"]: row["max_score"] for row in rows}
    people = {student.id: student for student in course.roster()}
    header = ["id", "first_name", "last_name", *(f"{name} (of {of[name]})" for name in sets), "all", *sets]
    table: list[list[Any]] = []
    for student in sorted({row["student_id"] for row in rows} | {*people}):
        mine = [told.get((student, name)) for name in sets]
        points = [float(row["score"]) if row else 0.0 for row in mine]
        names = [people[student].first_name, people[student].last_name] if student in people else ["", ""]
        table.append([student, *names, *points, sum(points), *(row["state"] if row else "no set" for row in mine)])
    return header, table


def _missing_sets(course: Course, graded: set[str]) -> Iterator[str]:
    """Yield a line for each set that the gradebook has and the course not, or the other way round."""
    released = {name for name in course.sets() if (course.root / "release" / name).is_dir()}
    for name in sorted(released - graded):
        yield f"missing set: {name} is released, and not in the gradebook: release it again"
    for name in sorted(graded - {*course.sets()}):
        yield f"missing set: {name} is in the gradebook, and not in source/: class.csv counts its points"


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
        numbers = (line.of, len(line.points), round(line.mean, 4), round(line.right, 4), apart, took, line.open)
        yield line.task, line.part, *numbers, *usual, *[""] * (2 * USUAL_FAULTS - len(usual))
