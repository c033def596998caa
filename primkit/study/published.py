"""Published: what the paper's authors recorded, and the tables that put ours beside it.

In:  the rows of a study.
Out: Tables 1 and 2 (automatic movement) and 3 and 4 (manual movement), as far as the rows fill them; and row by row,
     what was recorded beside what comes out when it is repeated.

>>> PUBLISHED["automatic"]["1_pentagon"]
Recorded(score=Score(weighted=0.7, shape=1.0, center=1.0, dimension=0.0), time=9.7)

Like stands beside like. *Recorded* are the authors' own rows. *Repeated* is their method on their sensor, scored their
way: runs that crash at a wrong kind have no row, and are left out of the mean as they were. Methods on exact rays are
scored fairly, which no recorded number is.

Source: Vaz, Costa and Campiao (2024), "Mapping of Primitives in Mobile Robotics Using Computer Vision", Tables 1 to 4,
and the 68 rows behind them, as they published them with their code.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import astuple, dataclass, fields, replace
from pathlib import Path

import numpy as np

from ..formats import StrPath, recorded_rows, write_atomically
from ..shapes import KINDS
from ..table import Table, as_csv
from .estimate import Estimate, means_of
from .paper_table import RECORDED, Line, paper_table
from .row import Movement, Row, Score

AVERAGE = "average"
SLIPS = {
    "Table 2": "Printed in the paper for 4 shapes: a centre of 0.92; its rows give 0.90.",
    "Table 4": "Printed in the paper for 3 shapes: 0.67, 0.86, 0.68, 0.40 and 39.25 s. That is the sum of nine rows "
    "divided by ten: 3_map_1 is left out.",
}


@dataclass(frozen=True)
class Recorded:
    """One recorded row: scores, to two decimals, and seconds on the wall (driving, computing, pictures)."""

    score: Score
    time: float


def _published() -> dict[Movement, dict[str, Recorded]]:
    kept: dict[Movement, dict[str, Recorded]] = {"automatic": {}, "manual": {}}
    for row in recorded_rows():
        numbers = (float(row[name]) for name in ("total", "shape_type", "center", "measurements"))
        movement: Movement = "manual" if row["movement"] == "manual" else "automatic"
        kept[movement][row["map"]] = Recorded(Score(*numbers), float(row["seconds"]))
    return kept


PUBLISHED: Mapping[Movement, Mapping[str, Recorded]] = _published()


def tables(rows: Iterable[Row], *, driven: str = "") -> tuple[Table, ...]:
    """Return the paper's tables: what was recorded, where the maps are the paper's, and our means.

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
        by_kind = {kind: [row for row in one if row.kinds == (kind,)] for kind in KINDS}
        counts = sorted({row.n_shapes for row in several})
        by_count = {f"{n} shapes": [row for row in several if row.n_shapes == n] for n in counts}
        made.append(_table(f"Table {first}. One shape, {movement} movement", one, by_kind | {AVERAGE: one}))
        made.append(_table(f"Table {first + 1}. Several shapes, {movement} movement", several, by_count))
    drives = [replace(table, notes=(*table.notes, driven)) if driven else table for table in made[2:]]
    return tuple(table for table in (*made[:2], *drives) if table.lines)


def row_table(rows: Iterable[Row]) -> Table:
    """Return what was recorded, row by row, beside what comes out when it is repeated.

    Parameters
    ----------
    rows : iterable of Row
        Of ``run_study``; only ``PAPER`` on the rendered sensor and on the paper's maps counts.
    """
    shown: list[tuple[str, ...]] = []
    numbers: list[tuple[object, ...]] = [
        ("movement", "map", "agrees", "crashed", *_names("recorded"), *_names("repeated"))
    ]
    for row in filter(_repeats, rows):
        theirs = PUBLISHED[row.movement][row.map].score
        verdict = "crashed" if row.crashed else "the same" if agrees(row) else ""
        shown.append((f"{row.map}, {row.movement}", _four(theirs), "-" if row.crashed else _four(row.paper), verdict))
        numbers.append((row.movement, row.map, agrees(row), row.crashed, *astuple(theirs), *astuple(row.paper)))
    notes = ["Total, shape, centre and dimensions, each to two decimals; the same: all four are."]
    title = "Row by row: recorded and repeated"
    return Table(("", "recorded", "repeated", ""), shown, title, notes, numbers=numbers, file="row-by-row.csv")


def agrees(row: Row) -> bool:
    """Tell whether all four numbers of a row are the recorded ones to two decimals."""
    return not row.crashed and _four(row.paper) == _four(PUBLISHED[row.movement][row.map].score)


def _repeats(row: Row) -> bool:
    return row.sensor == "webots" and row.settings == "PAPER" and row.map in PUBLISHED[row.movement]


def _four(score: Score) -> str:
    return " ".join(f"{number:.2f}" for number in astuple(score))


def _names(whose: str) -> list[str]:
    return [f"{whose}_{part.name}" for part in fields(Score)]


def rows_as_csv(rows: Iterable[Row]) -> str:
    """Return the rows of a study as CSV, one line each: scores from 0 to 1, errors in metres, times in seconds.

    Of the errors, each line holds the largest of a centre's coordinates and of the dimensions.
    """
    names = [f"{protocol}_{part.name}" for protocol in ("fair", "paper") for part in fields(Score)]
    header = ("map", "settings", "movement", "sensor", "crashed", "kinds", "n_shapes", "told", "n_found", *names)
    errors = ("largest_center_error_m", "largest_dimension_error_m", "robot_time_s", "computing_time_s")
    lines = []
    for row in rows:
        what = (row.map, row.settings, row.movement, row.sensor, row.crashed, " ".join(row.kinds), row.n_shapes)
        largest = [max(map(abs, errors), default=None) for errors in (row.center_errors, row.dimension_errors)]
        lines.append(
            (
                *what,
                row.told,
                row.n_found,
                *astuple(row.fair),
                *astuple(row.paper),
                *largest,
                row.robot_time,
                row.computing_time,
            )
        )
    return as_csv(header + errors, lines)


def write_tables(folder: StrPath, made: Iterable[Table], rows: Iterable[Row]) -> list[str]:
    """Write each table and all rows as CSV into a folder, and return the files' names."""
    files = {table.file: table.csv() for table in made}
    files["rows.csv"] = rows_as_csv(rows)
    for name, text in files.items():
        write_atomically(Path(folder) / name, text)
    return list(files)


def _table(title: str, rows: Sequence[Row], groups: Mapping[str, Sequence[Row]]) -> Table:
    """Return one table: for each group of maps what was recorded, then each method.

    Beside repeated rows a method on exact rays is scored fairly alone: as published, it would compare the sensors.
    """
    like = any(row.sensor == "webots" for row in rows)
    lines = [line for maps, chosen in groups.items() if chosen for line in _lines(maps, chosen, like)]
    return paper_table(title, lines, _notes(title, rows, lines))


def _lines(maps: str, rows: Sequence[Row], like: bool) -> list[Line]:
    """Return a group's lines: the recorded rows of its maps, and the means of each method on each sensor."""
    recorded = PUBLISHED[rows[0].movement]
    names = list(dict.fromkeys(row.map for row in rows))
    lines = []
    if all(name in recorded for name in names):
        mean = np.mean([(*astuple(recorded[name].score), recorded[name].time) for name in names], axis=0)
        means = tuple(map(Estimate, mean[:4].tolist()))
        lines.append(Line(maps, RECORDED, "", len(names), means, time=float(mean[4])))
    for method, sensor in dict.fromkeys((row.settings, row.sensor) for row in rows):
        own = [row for row in rows if (row.settings, row.sensor) == (method, sensor)]
        if sensor == "webots" or not like:
            lines += _as_published(maps, f"{method} repeated" if sensor == "webots" else f"{method} as published", own)
        if sensor == "exact" or not like:
            lines.append(_mean(maps, method, _within(own[0]), own, [row.fair for row in own]))
    return lines


def _as_published(maps: str, method: str, rows: Sequence[Row]) -> list[Line]:
    """Return the mean of the runs that survive the published scoring, and that with the others as zero."""
    alive = [row for row in rows if not row.crashed]
    survived = f"({len(alive)} of {len(rows)} survived)" if len(alive) < len(rows) else ""
    lines = [_mean(maps, method, survived, alive, [row.paper for row in alive])] if alive else []
    if len(alive) < len(rows):
        lines.append(_mean(maps, method, "crashes as 0", rows, [row.paper for row in rows]))
    return lines


def _mean(maps: str, method: str, scoring: str, rows: Sequence[Row], scores: Sequence[Score]) -> Line:
    """Return the mean of some rows' scores, with its interval over the maps."""
    robot, computing = np.mean([(row.robot_time, row.computing_time) for row in rows], axis=0).tolist()
    means = means_of([astuple(score) for score in scores])
    return Line(maps, method, scoring, len(rows), means, robot, computing, robot + computing)


def _notes(title: str, rows: Sequence[Row], lines: Sequence[Line]) -> tuple[str, ...]:
    """Return what a reader must know to read the table."""
    if not rows:
        return ()
    counts, shown = [], {line.method.split()[-1] for line in lines}
    for method, sensor in dict.fromkeys((row.settings, row.sensor) for row in rows):
        theirs = [row for row in rows if (row.settings, row.sensor) == (method, sensor)]
        told = ", being told it" if all(row.told for row in theirs) else ""
        where = " on the rendered sensor" if sensor == "webots" else ""
        counts.append(f"{method}{where} on {sum(row.count_right for row in theirs)} of {len(theirs)} maps{told}")
    notes = ["total = 0.4 shape (type) + 0.3 centre (position) + 0.3 dimensions (shape measurements)."]
    if RECORDED in shown:
        notes.append("recorded: the means of the authors' own rows, on the same maps.")
        notes += [SLIPS[table] for table in SLIPS if title.startswith(table)]
    if "repeated" in shown:
        notes.append("repeated: the published method on the rendered sensor, scored as published.")
        again = [row for row in rows if _repeats(row)]
        notes.append(f"The same as recorded in all four numbers: {sum(map(agrees, again))} of {len(again)} rows.")
    if shown & {"repeated", "published"}:
        notes.append(
            "Scored as published: both rounded to 1 cm, whatever is too small counts as right, a rectangle's width is "
            "compared with its height, and a wrong kind ends the run. Runs that end are left out of the mean."
        )
    if any(line.scoring == _within(rows[0]) for line in lines):
        notes.append(f"{_within(rows[0])}: on exact rays, right when at most that far off, either way, unrounded.")
    notes.append("time: robot (scans x period) + computing; a recorded time is on the wall, pictures included.")
    notes.append(f"Right number of shapes: {'; '.join(counts)}.")
    several = [line for line in lines if line.means[0].low is not None]
    if several:
        notes.append("In brackets: 95 % interval of the mean over the maps (bootstrap).")
    if any(line.means[0].value == 1 for line in several):
        notes.append("Where all n maps score 1, up to about 3/n of all such maps may still score less (rule of three).")
    return tuple(notes)


def _within(row: Row) -> str:
    return f"within {1000 * row.tolerance:g} mm"
