"""Results: what the benchmarks found, as text and CSV.

In:  ``Row``: one tool at one task: what it costs, and how many times the reference's cost that is.
Out: ``Result``: ``print`` it, or write its ``csv_rows``.

>>> rows = (Row("one scan", "ours", Spread(2, 1, 3)), Row("one scan", "theirs", Spread(8, 7, 9), Spread(4, 3, 7)))
>>> print(Result("scan", "Scanning", "us", "times ours", rows))
Scanning
<BLANKLINE>
         us (from-to)  times ours (from-to)
-------  ------------  --------------------
one scan
 ours    2 (1-3)
 theirs  8 (7-9)       4 (3-7)
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from itertools import groupby

from primkit.table import Table, as_csv

from .clock import Spread

Fact = float | str

CSV_HEADER = (
    *("bench", "case", "tool", "size", "unit", "cost", "cost_low", "cost_high"),
    *("ratio_to", "ratio", "ratio_low", "ratio_high", "facts"),
)
ABSENT = "absent"


@dataclass(frozen=True)
class Row:
    """One tool at one task.

    Parameters
    ----------
    case : str
        The task; neighbours with the same make a group.
    tool : str
        Who does it.
    cost : Spread, optional
        What it takes, in the result's unit; None for a tool that is not installed.
    ratio : Spread, optional
        Its cost in terms of the reference's, from paired measurements.
    size : int, optional
        How large the task is, where that is varied.
    facts : dict
        What else is known: accuracy, agreement. Each is a column.
    """

    case: str
    tool: str
    cost: Spread | None = None
    ratio: Spread | None = None
    size: int | None = None
    facts: Mapping[str, Fact] = field(default_factory=dict)


@dataclass(frozen=True)
class Result:
    """The rows of one benchmark.

    Parameters
    ----------
    name : str
        Its name on the command line.
    title : str
        What it shows.
    unit : str
        Of the costs.
    ratio_to : str
        What the ratios say.
    rows : tuple of Row
        Neighbours with the same case make a group.
    notes : tuple of str
        What a reader must know, one thought each.
    """

    name: str
    title: str
    unit: str
    ratio_to: str
    rows: tuple[Row, ...]
    notes: tuple[str, ...] = ()

    def table(self) -> Table:
        """Return the rows as texts, task by task."""
        facts = list(dict.fromkeys(name for row in self.rows for name in row.facts))
        paired = [f"{self.ratio_to} (from-to)"] if any(row.ratio for row in self.rows) else []
        rows: list[tuple[str, ...]] = []
        for case, group in groupby(self.rows, key=lambda row: row.case):
            rows += [(case,), *(_cells(row, facts, paired=bool(paired)) for row in group)]
        return Table(("", f"{self.unit} (from-to)", *paired, *facts), rows, self.title, self.notes)

    def __str__(self) -> str:
        return str(self.table())

    def csv_rows(self) -> list[tuple[object, ...]]:
        """Return one line for each row: the columns of ``CSV_HEADER``."""
        return [
            (
                *(self.name, row.case, row.tool, row.size, self.unit, *_ends(row.cost)),
                *(self.ratio_to, *_ends(row.ratio)),
                "; ".join(f"{name}={_short(value)}" for name, value in row.facts.items()),
            )
            for row in self.rows
        ]


def results_as_csv(results: Iterable[Result]) -> str:
    """Return all rows of all results as CSV."""
    return as_csv(CSV_HEADER, [row for result in results for row in result.csv_rows()])


def _cells(row: Row, facts: Iterable[str], *, paired: bool) -> tuple[str, ...]:
    told = (_short(row.facts[name]) if name in row.facts else "" for name in facts)
    cost = ABSENT if row.cost is None else _spread(row.cost)
    ratio = ["" if row.ratio is None else _spread(row.ratio)] * paired
    return (row.tool, cost, *ratio, *told)


def _spread(spread: Spread) -> str:
    median, low, high = (_short(value) for value in (spread.median, spread.low, spread.high))
    return median if low == high else f"{median} ({low}-{high})"


def _short(value: Fact) -> str:
    """Return a value with three digits that count, and none of the powers of ten that "%g" writes.

    >>> [_short(x) for x in (0.01234, 1.5, 24560.0, 0.99996, "text")]
    ['0.0123', '1.5', '24600', '1', 'text']
    """
    if isinstance(value, str):
        return value
    text = f"{float(f'{value:.3g}'):.6f}"
    return text.rstrip("0").rstrip(".")


def _ends(spread: Spread | None) -> tuple[float | None, ...]:
    return (None, None, None) if spread is None else (spread.median, spread.low, spread.high)
