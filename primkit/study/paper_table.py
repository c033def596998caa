"""One of the paper's tables: means over maps with their intervals.

In:  lines, each the means of one method on one group of maps.
Out: a ``Table``: ``print`` it, end a notebook's cell with it, or write its ``csv()``.

>>> perfect = Score(1.0, 1.0, 1.0, 1.0)
>>> line = Line("2 shapes", "ROBUST", "within 5 mm", 1, perfect, robot_time=7.7, computing_time=0.1)
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
from dataclasses import astuple, dataclass, fields
from itertools import groupby

from ..table import Table
from .estimate import columns_of
from .row import Score

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
    mean : Score
        Means over the maps.
    low, high : Score, optional
        Ends of the 95 % interval of each mean; None for a single map and for published figures.
    robot_time, computing_time : float, optional
        Means in seconds, apart where they are known apart.
    time : float, optional
        Both together, where only that is known.
    """

    maps: str
    method: str
    scoring: str
    n: int
    mean: Score
    low: Score | None = None
    high: Score | None = None
    robot_time: float | None = None
    computing_time: float | None = None
    time: float | None = None

    def cells(self) -> tuple[str, ...]:
        """Return the line as texts, one for each column."""
        total = f"{self.mean.weighted:.3f}"
        if self.low is not None and self.high is not None:
            total += f" ({self.low.weighted:.3f}-{self.high.weighted:.3f})"
        parts = (f"{part:.3f}" for part in (self.mean.shape, self.mean.center, self.mean.dimension))
        return (f"{self.method} {self.scoring}".strip(), total, *parts, self._time())

    def _time(self) -> str:
        if self.robot_time is None or self.computing_time is None:
            return "-" if self.time is None else f"{self.time:.2f}"
        return f"{self.robot_time:.1f} + {self.computing_time:.2f}"


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
    numbers = [header, *map(_numbers, lines)]
    return Table(PAPER_HEADER, rows, title, tuple(notes), lines=tuple(lines), numbers=numbers, file=file)


def _numbers(line: Line) -> tuple[object, ...]:
    ends = [(None,) * 4 if end is None else astuple(end) for end in (line.low, line.high)]
    scores = [number for triple in zip(astuple(line.mean), *ends, strict=True) for number in triple]
    return (line.maps, line.n, line.method, line.scoring, *scores, line.robot_time, line.computing_time, line.time)


def _maps(lines: Sequence[Line]) -> str:
    """Say how many maps a group's lines are about: one number where they agree.

    >>> one = Score(1.0, 1.0, 1.0, 1.0)
    >>> _maps([Line("2 shapes", "published", "", 10, one), Line("2 shapes", "ROBUST", "", 7, one)])
    '7 maps (published: 10)'
    """
    counts = {line.method: line.n for line in lines}
    ours = [
        f"{n} map{'s' * (n != 1)}" for n in dict.fromkeys(n for method, n in counts.items() if method != "published")
    ]
    theirs = counts.get("published")
    told = ", ".join(ours) or f"{theirs} maps"
    return told if theirs is None or set(counts.values()) == {theirs} else f"{told} (published: {theirs})"
