"""Accuracy table: how right the methods are, level by level of a sweep; the oracle beside them.

In:  the name of a sweep, a number of maps, a seed.
Out: a ``Table``: for each level and method the weighted accuracy, the count and the errors.

>>> from primkit.pipeline import ROBUST
>>> table = run_accuracy("gap", 2, settings={"ROBUST": ROBUST}, jobs=1)
>>> [(line.level, line.method, line.coarse.value) for line in table.lines[:2]]
[('gap 5 cm', 'ROBUST', 1.0), ('gap 5 cm', 'oracle', 1.0)]

Not here: what a method could do at best (``oracle.py``), and what is changed (``sweeps.py``).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from typing import Any

import numpy as np

from ...arguments import Floats, as_count, short
from ...formats import StrPath
from ...pipeline import Settings
from ...table import Table, as_csv, count
from ..estimate import Estimate, columns_of, in_columns, mean_of, ratio_of, share_of
from ..many import METHODS, checked_jobs, perform_all
from ..oracle import ORACLE, Oracle
from ..row import Row
from .sweeps import REMEDIES, SWEEPS, UNTUNED, Level, experiments, n_runs

FINE, COARSE = 0.001, 0.005  # m: the two tolerances
TRUTHS = "oracle"  # its name among the methods

ACCURACY_HEADER = (
    *("", "within 1 mm", "within 5 mm", "right count"),
    *("centre [mm]", "x oracle", "dimens. [mm]", "x oracle", "time [s]"),
)


@dataclass(frozen=True)
class AccuracyLine:
    """One method at one level.

    Parameters
    ----------
    level : str
        The level's name.
    x : float
        Its place on the axis.
    method : str
        Whose figures these are.
    n_maps, n_runs : int
        How many maps, and how many runs on them.
    fine, coarse : Estimate
        Weighted accuracy within 1 mm and within 5 mm, two-sided: the mean over the maps.
    count : Estimate, optional
        Share of the runs with the right number of shapes; None for a method that is told it.
    n_shapes : int
        How many shapes method and oracle both found as what they are; the errors are theirs.
    center_rms, dimension_rms : float
        Root mean square errors, metres.
    center_ratio, dimension_ratio : Estimate, optional
        The same divided by the oracle's; None for the oracle, and without such shapes.
    time : float, optional
        Median computing time of a map, seconds; None for the oracle.
    """

    level: str
    x: float
    method: str
    n_maps: int
    n_runs: int
    fine: Estimate
    coarse: Estimate
    count: Estimate | None
    n_shapes: int
    center_rms: float
    center_ratio: Estimate | None
    dimension_rms: float
    dimension_ratio: Estimate | None
    time: float | None

    def cells(self) -> tuple[str, ...]:
        """Return the line as texts: what share is right, how far off it is, and how long it takes."""
        cells = [self.method, str(self.fine), str(self.coarse), "told" if self.count is None else str(self.count)]
        for rms, ratio in ((self.center_rms, self.center_ratio), (self.dimension_rms, self.dimension_ratio)):
            cells += [f"{1000 * rms:.3f}", "-" if ratio is None else ratio.text(2 if ratio.value < 10 else 0)]
        return (*cells, "-" if self.time is None else f"{self.time:.3f}")


def run_accuracy(
    sweep: str = "noise",
    n_maps: int = 100,
    *,
    settings: Mapping[str, Settings] = METHODS,
    seed: int = 0,
    folder: StrPath | None = None,
    jobs: int | None = -1,
    progress: bool = True,
) -> Table:
    """Change one thing, and say how right each method is and how right the oracle.

    Parameters
    ----------
    sweep : str
        What is changed: a name in ``SWEEPS``.
    n_maps : int
        Maps for each level. The paper's suite always has its 34, scanned as often as comes near this number.
    settings : dict of str to Settings
        The methods by name; for ``"remedies"`` the remedies take their place.
    seed : int
        Other seeds draw other maps; the same seed gives the same table, times apart.
    folder, jobs, progress
        As for ``run_study``: where the journal is, how many processes, whether a bar is shown.

    Returns
    -------
    Table
        Its lines are ``AccuracyLine``, level by level; at each the methods, and the oracle last.

    Raises
    ------
    ValueError
        If an argument is out of its range, or the journal holds something else than rows.
    OSError
        If the journal cannot be written.

    Notes
    -----
    Methods and oracle get the same points. Errors are compared on those shapes that both found as what they are, with
    the centre within 10 cm.
    """
    if sweep not in SWEEPS:
        raise ValueError(f"sweep must be one of {', '.join(SWEEPS)}, got {short(sweep)}")
    n_maps, seed = as_count(n_maps, "n_maps"), as_count(seed, "seed", least=0)
    if TRUTHS in settings:
        raise ValueError(f'settings must not be called "{TRUTHS}"')
    chosen = SWEEPS[sweep]
    methods: dict[str, Settings | Oracle] = {**(REMEDIES if chosen.remedies else settings), TRUTHS: ORACLE}
    sizes = [len(methods) * n_runs(level.condition, n_maps) for level in chosen.levels]
    every = (e for level in chosen.levels for e in experiments(level.condition, methods, n_maps, seed))
    rows = perform_all(every, folder=folder, jobs=checked_jobs(jobs), total=sum(sizes), progress=progress)
    ends = np.cumsum(sizes)
    parts = [rows[end - size : end] for size, end in zip(sizes, ends, strict=True)]
    lines = [line for level, part in zip(chosen.levels, parts, strict=True) for line in level_lines(level, part)]
    return accuracy_table(sweep, chosen.title, lines, _notes(chosen.note, lines, seed))


def accuracy_table(name: str, title: str, lines: Sequence[AccuracyLine], notes: Sequence[str] = ()) -> Table:
    """Return the lines of the sweep with this name as a table.

    Its CSV holds scores from 0 to 1, errors in millimetres, times in seconds.
    """
    rows: list[tuple[str, ...]] = []
    for _, group in groupby(lines, key=lambda line: line.level):
        level = list(group)
        rows += [(_heading(level[0]),), *(line.cells() for line in level)]
    counts = ("level", "x", "method", "n_maps", "n_runs", "n_shapes")
    estimates = ("fine", "coarse", "count", "center_ratio", "dimension_ratio")
    columns = columns_of(("within_1_mm", "within_5_mm", "right_count", *estimates[3:]))
    numbers: list[Sequence[Any]] = [
        ("sweep", *counts, *columns, "center_rms_mm", "dimension_rms_mm", "computing_time_s")
    ]
    for line in lines:
        shares = in_columns(getattr(line, estimate) for estimate in estimates)
        rms = (1000 * line.center_rms, 1000 * line.dimension_rms)
        numbers.append((name, *(getattr(line, count) for count in counts), *shares, *rms, line.time))
    said = Table(ACCURACY_HEADER, rows, title, tuple(notes), folds=(4,))
    return replace(said, lines=tuple(lines), numbers=numbers, name=name, file="accuracy.csv")


def level_lines(level: Level, rows: Sequence[Row]) -> list[AccuracyLine]:
    """Return a line for each method; ``rows`` hold all methods' runs on the same maps, the oracle's among them."""
    by_method = {name: [r for r in rows if r.settings == name] for name in dict.fromkeys(r.settings for r in rows)}
    return [_line(level, own, by_method[TRUTHS]) for own in by_method.values()]


def _line(level: Level, rows: Sequence[Row], oracle: Sequence[Row]) -> AccuracyLine:
    method, told = rows[0].settings, all(row.told for row in rows)
    names = [row.map for row in rows]
    scores = np.array([[row.within(t).weighted for t in (FINE, COARSE)] + [row.count_right] for row in rows])
    means = _by_map(names, scores) / _by_map(names, np.ones((len(rows), 1)))
    sums = _by_map(names, np.array([_squares(*pair) for pair in zip(rows, oracle, strict=True)]))
    n_shapes, n_centers, n_dimensions = (int(n) for n in sums[:, :3].sum(axis=0))
    ours, theirs = sums[:, 3:5], sums[:, 5:7]
    return AccuracyLine(
        level=level.name,
        x=level.x,
        method=method,
        n_maps=len(means),
        n_runs=len(rows),
        fine=mean_of(means[:, 0]),
        coarse=mean_of(means[:, 1]),
        count=None if told else share_of(float(means[:, 2].mean()), len(means)),
        n_shapes=n_shapes,
        center_rms=_root_mean(ours[:, 0], n_centers),
        center_ratio=None if method == TRUTHS else _ratio(ours[:, 0], theirs[:, 0]),
        dimension_rms=_root_mean(ours[:, 1], n_dimensions),
        dimension_ratio=None if method == TRUTHS else _ratio(ours[:, 1], theirs[:, 1]),
        time=None if method == TRUTHS else float(np.median([row.computing_time for row in rows])),
    )


def _squares(ours: Row, oracle: Row) -> tuple[float, ...]:
    """Return how many shapes, coordinates and dimensions both have right in kind, and the sums of squared errors."""
    pairs = zip(ours.errors_by_shape(), oracle.errors_by_shape(), strict=True)
    both = [(own, true) for own, true in pairs if own is not None and true is not None]
    counts = [sum(len(own[part]) for own, _ in both) for part in (0, 1)]
    return (len(both), *counts, *(sum(e * e for pair in both for e in pair[who][k]) for who in (0, 1) for k in (0, 1)))


def _by_map(names: Sequence[str], values: Floats) -> Floats:
    """Return the sums over the runs on each map, shape (N, Q) -> (M, Q): maps are the independent draws."""
    _, which = np.unique(names, return_inverse=True)
    sums = np.zeros((which.max() + 1, values.shape[1]))
    np.add.at(sums, which, values)
    return sums


def _root_mean(squares: Floats, n: int) -> float:
    return float(np.sqrt(squares.sum() / n)) if n else float("nan")


def _ratio(ours: Floats, theirs: Floats) -> Estimate | None:
    return ratio_of(ours, theirs, root=True) if theirs.sum() > 0 else None


def _heading(line: AccuracyLine) -> str:
    repeats = f", {line.n_runs} runs" if line.n_runs != line.n_maps else ""
    return f"{line.level}, {count(line.n_maps, 'map')}{repeats}"


def _notes(note: str, lines: Sequence[AccuracyLine], seed: int) -> tuple[str, ...]:
    told = [m for m in dict.fromkeys(line.method for line in lines if line.count is None) if m != TRUTHS]
    return (
        note,
        "within: weighted accuracy, a value being right when at most that far off, either way.",
        "right count: share of runs that found as many shapes as there are"
        + (f"; {' and '.join(told)} is told the number." if told else "."),
        "centre, dimens.: root mean square errors of the shapes that the method and the oracle both found as what they "
        "are (centre within 10 cm). x oracle: divided by the oracle's on the same shapes.",
        "oracle: the least-squares fit that is told the kinds, and which point belongs to which side. It has no shape "
        "where a side was not seen: a method can be ahead of it.",
        "time: median computing time of a map.",
        "In brackets: 95 % interval over the maps (bootstrap; of the count Wilson's). Where all n maps score 1, up to "
        "about 3/n of all such maps may still score less.",
        f"Maps and noise are drawn from {UNTUNED} and {seed}; nothing was tuned on them.",
    )


def accuracy_as_csv(tables: Sequence[Table]) -> str:
    """Return the numbers of one or more sweeps as one CSV."""
    return as_csv(tables[0].numbers[0], [row for table in tables for row in table.numbers[1:]])
