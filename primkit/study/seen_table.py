"""Seen table: how right the shapes of a drive are, by how much of their outline it saw.

In:  the rows of a study with manual movement.
Out: a ``Table``: for each method, the shapes that were seen on at least 60 % of their outline, and the others.

>>> print(str(seen_table([])).splitlines()[0])
Shapes by how much of their outline was seen, manual movement

Tables 3 and 4 count shapes that a drive left out as wrong; here each shape stands for itself, by what was seen of it.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import astuple
from itertools import groupby

import numpy as np

from ..table import Table, count
from .estimate import Estimate, ratio_of
from .paper_table import Line
from .row import Row

ENOUGH_SEEN = 0.6  # share of an outline
SEEN_HEADER = ("", "total", "shape", "centre", "dimensions")
SEEN_COLUMNS = ("map", "method", "kind", "found_as", "seen", "weighted", "shape", "center", "dimension")


def seen_table(rows: Iterable[Row]) -> Table:
    """Return how right the shapes are that a drive saw at least 60 % of, and how right the others.

    Its lines are ``Line``; its CSV has one line for each shape and method, shares and scores from 0 to 1.

    Parameters
    ----------
    rows : iterable of Row
        Of ``run_study``; only those with manual movement count.

    Examples
    --------
    >>> seen_table([]).lines
    ()
    """
    rows = [row for row in rows if row.movement == "manual"]
    by_method = [[row for row in rows if row.settings == name] for name in dict.fromkeys(row.settings for row in rows)]
    groups = ((f"seen on {100 * ENOUGH_SEEN:g} % or more", True), ("seen on less", False))
    lines = [line for group, enough in groups for own in by_method if (line := _line(group, own, enough))]
    cells: list[tuple[str, ...]] = []
    for heading, alike in groupby(lines, key=lambda line: line.maps):
        cells += [(heading,), *(line.cells()[:-1] for line in alike)]  # without the time
    shapes = [
        (row.map, row.settings, kind, found, seen, *astuple(score))
        for row in rows
        for kind, found, seen, score in zip(row.kinds, row.found_as, row.seen, row.scores_by_shape(), strict=True)
    ]
    title = "Shapes by how much of their outline was seen, manual movement"
    numbers = [SEEN_COLUMNS, *shapes]
    return Table(SEEN_HEADER, cells, title, _notes(rows, lines), lines=tuple(lines), numbers=numbers, file="seen.csv")


def _line(group: str, rows: Sequence[Row], enough: bool) -> Line | None:
    """Return one method's means over the shapes that were seen enough, or over the others; None without any."""
    chosen = [
        [score for score, seen in zip(row.scores_by_shape(), row.seen, strict=True) if (seen >= ENOUGH_SEEN) == enough]
        for row in rows
    ]
    sums = np.array([[len(scores), sum(score.weighted for score in scores)] for scores in chosen if scores])
    if len(sums) == 0:
        return None
    _, *parts = np.mean([astuple(score) for scores in chosen for score in scores], axis=0).tolist()
    n_shapes, n_all, n_maps = int(sums[:, 0].sum()), sum(row.n_shapes for row in rows), len(sums)
    return Line(
        maps=f"{group}: {n_shapes} of {n_all} shapes, on {count(n_maps, 'map')}",
        method=rows[0].settings,
        scoring=f"within {1000 * rows[0].tolerance:g} mm",
        n=n_maps,
        means=(ratio_of(sums[:, 1], sums[:, 0]), *map(Estimate, parts)),
    )


def _notes(rows: Sequence[Row], lines: Sequence[Line]) -> tuple[str, ...]:
    if not rows:
        return ()
    false = {row.settings: 0 for row in rows}
    for row in rows:
        false[row.settings] += row.n_false
    notes = [
        "seen: a stretch of outline with a hit within 12 mm, as a sensor without faults has them.",
        "Each shape counts alike: total = 0.4 shape + 0.3 centre + 0.3 dimensions, and 0 for one that was missed. What "
        "was found where there is nothing belongs to no shape and counts in Tables 3 and 4 alone: "
        f"{', '.join(f'{method} {n}' for method, n in false.items())}.",
    ]
    if any(line.means[0].low is not None for line in lines):
        notes.append("In brackets: 95 % interval of the mean over the maps (bootstrap).")
    if any(line.means[0].value == 1 and line.n > 1 for line in lines):
        notes.append("Where all shapes on n maps score 1, up to about 3/n of all such maps may still score less.")
    return tuple(notes)
