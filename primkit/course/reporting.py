"""Reporting: the overview of a class as text, as tables for a spreadsheet, and as a figure.

In:  an ``Overview``.
Out: lines for the screen; ``overview.csv`` (tasks and parts), ``wrong.csv`` (each wrong answer), ``faults.csv`` (what a
     teacher should look at), ``grades.csv`` (nbgrader's own export) and ``overview.png``.
"""

from __future__ import annotations

import csv
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

from ..formats.files import write_atomically
from ..plots.class_marks import plot_class
from ..plots.story import save_figure
from ..table import Table, as_csv
from .course import Course
from .grade import Journal
from .handed_in import listed_students
from .handing_back import state, unmarked_answers
from .overview import Line, Overview, overview
from .running import nbgrader

USUAL_FAULTS = 3  # wrong answers that are told for each part
OVERVIEW_HEADER = (
    *("task", "part", "of", "students", "mean", "share_right", "to_mark_by_hand"),
    *(f"{what}_{k}" for k in range(1, USUAL_FAULTS + 1) for what in ("wrong", "count")),
)


def report(course: Course, name: str) -> Iterator[str]:
    """Write the reports on a problem set, and yield what is said about it."""
    seen = overview(course, name)
    folder = course.reports(name)
    tables = {
        "overview.csv": (OVERVIEW_HEADER, _overview_rows(seen)),
        "wrong.csv": (("student", "task", "part", "name", "what"), seen.wrong),
        "faults.csv": (("student", "cell", "name", "what"), (fault.data().values() for fault in seen.faults)),
    }
    for file, (header, rows) in tables.items():
        write_atomically(folder / file, _csv(header, rows))
    parts = seen.parts()
    figure = plot_class(
        name,
        seen.graded,
        [(line.task, line.part, line.right, (_usual_faults(line) or [("", 0)])[0]) for line in parts if not line.open],
    )
    save_figure(figure, folder / "overview.png")
    exported = nbgrader(course, "export", f"--to={folder / 'grades.csv'}")
    if exported.code == 0:
        _add_states(course, folder / "grades.csv")
    yield from _tell(seen)
    yield ""
    yield f"Wrote  {', '.join([*tables, 'overview.png'])} in {folder}"
    yield (
        f"Wrote  {folder / 'grades.csv'}: nbgrader's export; its last column tells the zeros apart"
        if exported.code == 0
        else f"nbgrader's export failed: {exported.reason}"
    )


def _add_states(course: Course, path: Path) -> None:
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
    write_atomically(path, _csv([*head, "state"], rows))


def _usual_faults(line: Line) -> list[tuple[str, int]]:
    """Return the most frequent wrong answers, the most frequent first; of as frequent ones, Python's errors last."""
    return sorted(line.wrong.items(), key=lambda item: (-item[1], item[0][:1].isupper(), item[0]))[:USUAL_FAULTS]


def _tell(seen: Overview) -> Iterator[str]:
    title = f"{seen.name}: {seen.handed_in} handed in, {seen.graded} graded; mean {seen.mean:.1f} of {seen.of:g} points"
    rows = []
    for line in (line for line in seen.lines if not line.part):
        rows.append(_row(line.task, line))
        rows += [_row(f"  {part.part}", part) for part in seen.lines if part.part and part.task == line.task]
    yield str(Table(("task, part", "mean", "right", "usual wrong answers"), rows, title))
    if seen.faults:
        yield ""
        yield f"To look at ({len(seen.faults)}):"
        yield from (f"  {fault.student}  {fault.cell}  {fault.name}: {fault.says}" for fault in seen.faults)


def _row(name: str, line: Line) -> tuple[str, ...]:
    usual = "; ".join(f"{count} x {fault}" for fault, count in _usual_faults(line)) if line.part or line.wrong else ""
    if line.open:
        usual = f"{line.open} to be marked by hand" + (f"; {usual}" if usual else "")
    return name, f"{line.mean:.2f} of {line.of:g}", f"{100 * line.right:.0f} %", usual


def _overview_rows(seen: Overview) -> Iterator[Sequence[Any]]:
    for line in seen.lines:
        usual = [entry for pair in _usual_faults(line) for entry in pair]
        numbers = (line.of, len(line.points), round(line.mean, 4), round(line.right, 4), line.open)
        yield line.task, line.part, *numbers, *usual, *[""] * (2 * USUAL_FAULTS - len(usual))


def _csv(header: Sequence[str], rows: Iterable[Iterable[Any]]) -> bytes:
    return as_csv(header, ([_escape_formula(cell) for cell in row] for row in rows)).encode()


def _escape_formula(cell: Any) -> Any:
    """Return a cell that no spreadsheet takes for a formula: students choose some of these words.

    >>> _escape_formula("=1+1"), _escape_formula("-"), _escape_formula(-0.5)
    ("'=1+1", '-', -0.5)
    """
    return f"'{cell}" if isinstance(cell, str) and len(cell) > 1 and cell[0] in "=+-@\t\r" else cell
