"""One of the paper's tables: means over maps with their intervals.

In:  lines, each the means of one method on one group of maps.
Out: a ``Table``: ``print`` it, end a notebook's cell with it, or write its ``csv()``.

>>> line = Line("2 shapes", "ROBUST", "within 5 mm", 1, (Estimate(1.0),) * 4, robot_time=7.7, computing_time=0.1)
>>> print(paper_table("Ours", [line]))
Ours
<BLANKLINE>
                     total  shape  centre  dimensions  time [s]
-------------------  -----  -----  ------  ----------  ----------
2 shapes, 1 map
 ROBUST within 5 mm  1.000  1.000  1.000   1.000       7.7 + 0.10
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from itertools import groupby

from ..table import Table, count
from .estimate import Estimate, columns_of, in_columns
from .row import Score

RECORDED = "recorded"
PAPER_HEADER = ("", "total", "shape", "centre", "dimensions", "time [s]")


@dataclass(frozen=True)
class Line:
    """The means of one method on one group of maps.

    Parameters
    ----------
    maps : str
        What the maps have in common, such as ``"2 shapes"``.
    method, scoring : str
        Whose figures these are, and how they are scored.
    n : int
        Number of maps.
    means : tuple of Estimate
        Over the maps, in the order of ``Score``; without intervals for a single map and for published figures.
    robot_time, computing_time : float, optional
        Means in seconds, apart where they are known apart.
    time : float, optional
        Both together, where only that is known.
    """

    maps: str
    method: str
    scoring: str
    n: int
    means: tuple[Estimate, ...]
    robot_time: float | None = None
    computing_time: float | None = None
    time: float | None = None

    def cells(self) -> tuple[str, ...]:
        """Return the line as texts, one for each column."""
        total, *parts = self.means
        time = "-" if self.time is None else f"{self.time:.2f}"
        if self.robot_time is not None and self.computing_time is not None:
            time = f"{self.robot_time:.1f} + {self.computing_time:.2f}"
        return (f"{self.method} {self.scoring}".strip(), str(total), *(f"{part.value:.3f}" for part in parts), time)


def paper_table(title: str, lines: Sequence[Line], notes: Sequence[str] = ()) -> Table:
    """Return lines as a table; neighbours with the same ``maps`` make a group.

    Its CSV has all numbers: scores from 0 to 1, times in seconds.
    """
    rows: list[tuple[str, ...]] = []
    for maps, group in groupby(lines, key=lambda line: line.maps):
        own = list(group)
        rows += [(f"{maps}, {_maps(own)}",), *(line.cells() for line in own)]
    names = columns_of(part.name for part in fields(Score))
    header = ("maps", "n", "method", "scoring", *names, "robot_time_s", "computing_time_s", "time_s")
    file = f"{title.split('.')[0].lower().replace(' ', '-')}.csv"
    numbers: list[Sequence[object]] = [header]
    for line in lines:
        times = (line.robot_time, line.computing_time, line.time)
        numbers.append((line.maps, line.n, line.method, line.scoring, *in_columns(line.means), *times))
    return Table(PAPER_HEADER, rows, title, tuple(notes), lines=tuple(lines), numbers=numbers, file=file)


def _maps(lines: Sequence[Line]) -> str:
    """Say how many maps a group's lines are about: the largest number, as some may have crashed.

    >>> one = (Estimate(1.0),) * 4
    >>> _maps([Line("2 shapes", "recorded", "", 10, one), Line("2 shapes", "ROBUST", "", 7, one)])
    '10 maps'
    """
    return count(max(line.n for line in lines), "map")
