"""Table: means over maps with their intervals, as text, HTML and CSV.

In:  lines, each the means of one method on one group of maps.
Out: a ``Table``: ``print`` it, end a notebook's cell with it, or write its ``csv()``.

>>> perfect = Score(1.0, 1.0, 1.0, 1.0)
>>> print(Table("Ours", (Line("2 shapes", "ROBUST", "within 5 mm", 1, perfect, robot_time=7.7, computing_time=0.1),)))
Ours
<BLANKLINE>
                     total  shape  centre  dimensions  time [s]
-------------------  -----  -----  ------  ----------  ----------
2 shapes, 1 map
 ROBUST within 5 mm  1.000  1.000  1.000   1.000       7.7 + 0.10
"""

from __future__ import annotations

import csv
import io
import textwrap
from collections.abc import Iterable, Sequence
from dataclasses import astuple, dataclass, fields
from html import escape
from itertools import groupby
from typing import Any

from .row import Score

HEADER = ("", "total", "shape", "centre", "dimensions", "time [s]")
WIDTH = 80  # of a plain terminal
DIGITS = 6  # in CSV: far more than 34 maps can tell, and the same on every machine

Groups = Sequence[tuple[str, Sequence[tuple[str, ...]]]]  # headings, each with its rows of cells


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


@dataclass(frozen=True)
class Table:
    """Lines in groups of maps, with a title above and notes below.

    Parameters
    ----------
    title : str
        What the table shows.
    lines : tuple of Line
        Neighbours with the same ``maps`` make a group.
    notes : tuple of str
        What a reader must know, one thought each.
    """

    title: str
    lines: tuple[Line, ...]
    notes: tuple[str, ...] = ()

    def groups(self) -> list[tuple[str, list[Line]]]:
        """Return each group's heading with its lines."""
        grouped = [(maps, list(lines)) for maps, lines in groupby(self.lines, key=lambda line: line.maps)]
        return [(f"{maps}, {_maps(lines)}", lines) for maps, lines in grouped]

    def __str__(self) -> str:
        block = as_block(HEADER, [(heading, _all_cells(lines)) for heading, lines in self.groups()])
        return "\n".join([self.title, "", *block, *wrapped(self.notes)])

    def _repr_html_(self) -> str:
        groups = [(heading, _all_cells(lines)) for heading, lines in self.groups()]
        return as_html(self.title, HEADER, groups, self.notes)

    def csv(self) -> str:
        """Return the lines with all their numbers as CSV; scores from 0 to 1, times in seconds."""
        names = [name for part in fields(Score) for name in (part.name, f"{part.name}_low", f"{part.name}_high")]
        header = ("maps", "n", "method", "scoring", *names, "robot_time_s", "computing_time_s", "time_s")
        rows = []
        for line in self.lines:
            ends = [(None,) * 4 if end is None else astuple(end) for end in (line.low, line.high)]
            scores = [number for triple in zip(astuple(line.mean), *ends, strict=True) for number in triple]
            times = (line.robot_time, line.computing_time, line.time)
            rows.append((line.maps, line.n, line.method, line.scoring, *scores, *times))
        return as_csv(header, rows)


def as_block(header: Sequence[str], groups: Groups) -> list[str]:
    """Return lines of text with the columns aligned: a heading, below it the group's rows, a space farther in.

    >>> as_block(("", "total"), [("2 maps", [("ROBUST", "1.000")])])
    ['         total', '-------  -----', '2 maps', ' ROBUST  1.000']
    """
    body = [(heading, [(f" {first}", *rest) for first, *rest in rows]) for heading, rows in groups]
    every = [header, *(cells for _, rows in body for cells in rows)]
    widths = [max(len(cells[i]) for cells in every) for i in range(len(header))]
    text = [_aligned(header, widths), "  ".join("-" * width for width in widths)]
    for heading, rows in body:
        text += [heading, *(_aligned(cells, widths) for cells in rows)]
    return text


def wrapped(notes: Sequence[str]) -> list[str]:
    """Return notes as lines that fit a terminal, below an empty one."""
    lines = [line for note in notes for line in textwrap.wrap(note, WIDTH)]
    return ["", *lines] if lines else []


def as_html(title: str, header: Sequence[str], groups: Groups, notes: Sequence[str]) -> str:
    """Return a table with its notes as HTML, for a notebook."""
    body = []
    for heading, rows in groups:
        body.append([_cell("th", heading, scope="rowgroup", colspan=len(header))])
        body += [
            [_cell("th", first, "normal", scope="row"), *(_cell("td", text, "normal") for text in rest)]
            for first, *rest in rows
        ]
    head = "".join(_cell("th", text, scope="col") for text in header)
    filled = "".join(f"<tr>{''.join(cells)}</tr>" for cells in body)
    caption = f'<caption style="text-align:left;font-weight:bold">{escape(title)}</caption>'
    below = "".join(f'<p style="max-width:50em">{escape(note)}</p>' for note in notes)
    return f"<table>{caption}<thead><tr>{head}</tr></thead><tbody>{filled}</tbody></table>{below}"


def as_csv(header: Sequence[str], rows: Iterable[Sequence[Any]]) -> str:
    r"""Return rows as CSV: numbers with at most six digits after the point, nothing for None.

    >>> as_csv(["a", "b"], [(0.1 + 0.2, None)])
    'a,b\n0.3,\n'
    """
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\n")
    writer.writerow(header)
    writer.writerows([round(v, DIGITS) if isinstance(v, float) else v for v in row] for row in rows)
    return buffer.getvalue()


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


def _all_cells(lines: Iterable[Line]) -> list[tuple[str, ...]]:
    return [line.cells() for line in lines]


def _aligned(cells: Sequence[str], widths: Sequence[int]) -> str:
    return "  ".join(cell.ljust(width) for cell, width in zip(cells, widths, strict=True)).rstrip()


def _cell(tag: str, text: str, weight: str = "bold", **attributes: object) -> str:
    told = "".join(f' {name}="{value}"' for name, value in attributes.items())
    return f'<{tag}{told} style="text-align:left;font-weight:{weight}">{escape(text)}</{tag}>'
