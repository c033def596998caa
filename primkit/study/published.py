"""Published: the paper's figures, and the tables that put ours beside them.

In:  the rows of a study.
Out: Tables 1 and 2 (automatic movement) and 3 and 4 (manual movement), as far as the rows fill them.

>>> one, two = PUBLISHED["automatic"]["circle"], PUBLISHED["automatic"]["2 shapes"]
>>> one.score.weighted, one.time, two.score.weighted, two.time
(1.0, 10.03, 0.83, 10.37)

Source: "Mapping of Primitives in Mobile Robotics Using Computer Vision", Tables 1 to 4.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import astuple, dataclass, fields, replace
from pathlib import Path

import numpy as np

from ..formats import StrPath, write_atomically
from ..shapes import PRIMITIVES
from ..table import Table, as_csv
from .estimate import Estimate, means_of
from .paper_table import Line, paper_table
from .row import Movement, Row, Score

AVERAGE = "average"


@dataclass(frozen=True)
class Figures:
    """One line of a published table: scores, seconds (robot and computing together), and the number of maps."""

    score: Score
    time: float
    n: int


def _figures(n: int, time: float, *scores: float) -> Figures:
    return Figures(Score(*scores), time, n)


# total, shape type, centre position, shape measurements
PUBLISHED: Mapping[Movement, Mapping[str, Figures]] = {
    "automatic": {
        "circle": _figures(1, 10.03, 1.0, 1.0, 1.0, 1.0),  # Table 1
        "triangle": _figures(1, 9.43, 0.85, 1.0, 0.50, 1.0),
        "rectangle": _figures(1, 9.48, 0.85, 1.0, 1.0, 0.50),
        "pentagon": _figures(1, 9.70, 0.70, 1.0, 1.0, 0.0),
        AVERAGE: _figures(4, 9.66, 0.85, 1.0, 0.875, 0.63),
        "2 shapes": _figures(10, 10.37, 0.83, 1.0, 0.85, 0.57),  # Table 2
        "3 shapes": _figures(10, 10.70, 0.83, 1.0, 0.87, 0.57),
        "4 shapes": _figures(10, 12.03, 0.87, 1.0, 0.92, 0.67),
    },
    "manual": {
        "circle": _figures(1, 13.50, 1.0, 1.0, 1.0, 1.0),  # Table 3
        "triangle": _figures(1, 12.77, 0.55, 1.0, 0.5, 0.0),
        "rectangle": _figures(1, 14.18, 0.85, 1.0, 1.0, 0.50),
        "pentagon": _figures(1, 13.45, 0.70, 1.0, 1.0, 0.0),
        AVERAGE: _figures(4, 13.48, 0.77, 1.0, 0.875, 0.38),
        "2 shapes": _figures(10, 28.34, 0.72, 1.0, 0.70, 0.38),  # Table 4
        "3 shapes": _figures(10, 39.25, 0.67, 0.86, 0.68, 0.40),
        "4 shapes": _figures(10, 58.25, 0.80, 1.0, 0.83, 0.50),
    },
}


def tables(rows: Iterable[Row], *, driven: str = "") -> tuple[Table, ...]:
    """Return the paper's tables with our means beside the published figures.

    Parameters
    ----------
    rows : iterable of Row
        Of ``run_study``: any maps, settings and movements.
    driven : str
        Who drove, or how: a sentence that is added to the notes of Tables 3 and 4.

    Returns
    -------
    tuple of Table
        Tables 1 and 2 for rows with automatic movement, 3 and 4 for manual: those that the rows have maps for.

    Raises
    ------
    ValueError
        If the rows were scored with different tolerances.

    Examples
    --------
    >>> tables([])
    ()
    """
    rows = list(rows)
    tolerances = sorted({row.tolerance for row in rows})
    if len(tolerances) > 1:
        raise ValueError(
            f"the rows of a table must share one tolerance, got {', '.join(f'{t:g}' for t in tolerances)} m"
        )
    made = []
    for first, movement in ((1, "automatic"), (3, "manual")):
        moved = [row for row in rows if row.movement == movement]
        one = [row for row in moved if row.n_shapes == 1]
        several = [row for row in moved if row.n_shapes != 1]
        by_kind = {kind: [row for row in one if row.kinds == (kind,)] for kind in PRIMITIVES}
        counts = sorted({row.n_shapes for row in several})
        by_count = {f"{n} shapes": [row for row in several if row.n_shapes == n] for n in counts}
        made.append(_table(f"Table {first}. One shape, {movement} movement", one, by_kind | {AVERAGE: one}))
        made.append(_table(f"Table {first + 1}. Several shapes, {movement} movement", several, by_count))
    drives = [replace(table, notes=(*table.notes, driven)) if driven else table for table in made[2:]]
    return tuple(table for table in (*made[:2], *drives) if table.lines)


def rows_as_csv(rows: Iterable[Row]) -> str:
    """Return the rows of a study as CSV, one line each: scores from 0 to 1, errors in metres, times in seconds.

    Of the errors, each line holds the largest of a centre's coordinates and of the dimensions.
    """
    names = [f"{protocol}_{part.name}" for protocol in ("fair", "paper") for part in fields(Score)]
    header = ("map", "settings", "movement", "kinds", "n_shapes", "told", "n_found", *names)
    errors = ("largest_center_error_m", "largest_dimension_error_m", "robot_time_s", "computing_time_s")
    lines = []
    for row in rows:
        what = (row.map, row.settings, row.movement, " ".join(row.kinds), row.n_shapes, row.told, row.n_found)
        largest = [max(map(abs, errors), default=None) for errors in (row.center_errors, row.dimension_errors)]
        lines.append((*what, *astuple(row.fair), *astuple(row.paper), *largest, row.robot_time, row.computing_time))
    return as_csv(header + errors, lines)


def write_tables(folder: StrPath, made: Iterable[Table], rows: Iterable[Row]) -> list[str]:
    """Write each table and all rows as CSV into a folder, and return the files' names."""
    files = {table.file: table.csv() for table in made}
    files["rows.csv"] = rows_as_csv(rows)
    for name, text in files.items():
        write_atomically(Path(folder) / name, text)
    return list(files)


def _table(title: str, rows: Sequence[Row], groups: Mapping[str, Sequence[Row]]) -> Table:
    """Return one table: for each group of maps the published figures, then each method under each protocol."""
    lines = [line for maps, chosen in groups.items() if chosen for line in _lines(maps, chosen)]
    return paper_table(title, lines, _notes(title, rows, lines))


def _lines(maps: str, rows: Sequence[Row]) -> list[Line]:
    figures = PUBLISHED[rows[0].movement].get(maps)
    lines = []
    if figures is not None:
        means = tuple(map(Estimate, astuple(figures.score)))
        lines.append(Line(maps, "published", "", figures.n, means, time=figures.time))
    for method in dict.fromkeys(row.settings for row in rows):
        lines += _means(maps, method, [row for row in rows if row.settings == method])
    return lines


def _means(maps: str, method: str, rows: Sequence[Row]) -> list[Line]:
    """Return a method's means under the published protocol and under the fair one."""
    means = means_of([[*astuple(row.paper), *astuple(row.fair)] for row in rows])
    robot = float(np.mean([row.robot_time for row in rows]))
    computing = float(np.mean([row.computing_time for row in rows]))
    times = (robot, computing, robot + computing)
    ways = (("as published", means[:4]), (_within(rows[0]), means[4:]))
    return [Line(maps, method, scoring, len(rows), own, *times) for scoring, own in ways]


def _notes(title: str, rows: Sequence[Row], lines: Sequence[Line]) -> tuple[str, ...]:
    """Return what a reader must know to read the table."""
    if not rows:
        return ()
    counts = []
    for method in dict.fromkeys(row.settings for row in rows):
        theirs = [row for row in rows if row.settings == method]
        told = ", being told it" if all(row.told for row in theirs) else ""
        counts.append(f"{method} on {sum(row.count_right for row in theirs)} of {len(theirs)} maps{told}")
    notes = [
        "total = 0.4 shape (type) + 0.3 centre (position) + 0.3 dimensions (shape measurements).",
        f"published: the paper's {title.split('.')[0]}, on maps of its own.",
        "as published: scored like the paper, rounded to 1 cm, and whatever is too small counts as right.",
        f"{_within(rows[0])}: right when at most that far off, either way, unrounded.",
        "time: robot (scans x period) + computing; the published time is both together.",
        f"Right number of shapes: {'; '.join(counts)}.",
    ]
    several = [line for line in lines if line.means[0].low is not None]
    if several:
        notes.append("In brackets: 95 % interval of the mean over the maps (bootstrap).")
    if any(line.means[0].value == 1 for line in several):
        notes.append("Where all n maps score 1, up to about 3/n of all such maps may still score less (rule of three).")
    return tuple(notes)


def _within(row: Row) -> str:
    return f"within {1000 * row.tolerance:g} mm"
