r"""Table: whatever the kit tells in rows, as text, as HTML and as CSV; and a number with its noun.

In:  the names of the columns, and rows of texts; a row of a single text is the heading of those below it.
Out: a ``Table``: ``print`` it, end a notebook's cell with it, or write its ``csv()``.

>>> print(Table(("", "total"), [("2 maps",), ("ROBUST", "1.000")], notes=("total: from 0 to 1.",)))
         total
-------  -----
2 maps
 ROBUST  1.000
<BLANKLINE>
total: from 0 to 1.
>>> as_csv(["a", "b"], [(0.1 + 0.2, None)])
'a,b\n0.3,\n'

Not here: what the rows say; the nouns that show as a table (``Report`` and others) have a method ``table()``.
"""

from __future__ import annotations

import csv
import io
import re
import textwrap
import unicodedata
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from html import escape
from itertools import pairwise
from typing import Any

NOTE_WIDTH = 80  # letters in a line of a plain terminal
NUMBER = re.compile(r"[-+]?\d+(\.\d+)?")
CSV_DIGITS = 6  # after the point: far more than 34 maps can tell, and the same on every machine


@dataclass(frozen=True, repr=False)
class Table:
    """Rows of texts in columns, with a title above and notes below.

    Parameters
    ----------
    header : sequence of str, the names of two or more columns
    rows : sequence of tuple of str
        One text for each column; a row of one text heads the rows below it.
    title : str
    notes : sequence of str, one thought each
    folds : sequence of int
        At these columns text goes on below, with the first column once more: for tables too wide for a terminal.
    lines : sequence
        What the rows tell: objects with all their numbers.
    numbers : sequence of sequences
        What ``csv()`` writes: the names of its columns, then its rows.
    name, file : str
        What programs call it, and its CSV in a study's folder.
    """

    header: Sequence[str]
    rows: Sequence[tuple[str, ...]]
    title: str = ""
    notes: Sequence[str] = ()
    folds: Sequence[int] = ()
    lines: Sequence[Any] = ()
    numbers: Sequence[Sequence[Any]] = ()
    name: str = ""
    file: str = ""

    def csv(self) -> str:
        """Return the numbers as CSV."""
        return as_csv(self.numbers[0], self.numbers[1:])

    def __repr__(self) -> str:
        blocks = [self._block(range(*ends)) for ends in pairwise((1, *self.folds, len(self.header)))]
        notes = "\n".join(line for note in self.notes for line in textwrap.wrap(note, NOTE_WIDTH))
        return "\n\n".join(part for part in (self.title, *blocks, notes) if part)

    def _block(self, columns: Iterable[int]) -> str:
        """Return the first column and these as text; rows below a heading stand a space farther in."""
        inset = " " * any(len(row) == 1 for row in self.rows)
        chosen = [0, *columns]
        header = tuple(self.header[k] for k in chosen)
        rows = [row if len(row) == 1 else (inset + row[0], *(row[k] for k in chosen[1:])) for row in self.rows]
        widths = [max(map(len, texts)) for texts in zip(header, *(row for row in rows if len(row) > 1), strict=True)]
        lines = [header, ["-" * width for width in widths], *rows]
        return "\n".join("  ".join(map(str.ljust, texts, widths)).rstrip() for texts in lines)

    def _repr_html_(self) -> str:
        head = "".join(_cell("th", text, "bold", scope="col") if text else "<td></td>" for text in self.header)
        body = ""
        for first, *rest in self.rows:
            if rest:
                cells = _cell("th", first, scope="row") + "".join(_cell("td", text) for text in rest)
            else:
                cells = _cell("th", first, "bold", scope="rowgroup", colspan=len(self.header))
            body += f"<tr>{cells}</tr>"
        title = f'<caption style="text-align:left;font-weight:bold">{escape(self.title)}</caption>' * bool(self.title)
        notes = "".join(f'<p style="max-width:50em">{escape(note)}</p>' for note in self.notes)
        return f"<div><table>{title}<thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>{notes}</div>"


def _cell(tag: str, text: str, weight: str = "normal", **attributes: object) -> str:
    told = "".join(f' {name}="{value}"' for name, value in attributes.items())
    return f'<{tag}{told} style="text-align:left;font-weight:{weight}">{escape(text)}</{tag}>'


def count(n: int, noun: str) -> str:
    """Return a number with its noun.

    >>> count(0, "shape"), count(1, "shape"), count(1234, "point")
    ('no shapes', '1 shape', '1,234 points')
    """
    return f"{n:,} {noun}" if n == 1 else f"{n:,} {noun}s" if n else f"no {noun}s"


def as_csv(header: Sequence[str], rows: Iterable[Sequence[Any]]) -> str:
    """Return rows as CSV: numbers with at most six digits after the point, nothing for None, no formulas."""
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\n")
    writer.writerow(header)
    writer.writerows([_cell_of(value) for value in row] for row in rows)
    return buffer.getvalue()


def _cell_of(value: Any) -> Any:
    r"""Return a value that no spreadsheet takes for a formula: names of maps are anybody's, words of answers too.

    >>> [_cell_of(value) for value in ("=1+1", "\n=1+1", "\uff1d1+1", "-", "-0.5", -0.12345678)]
    ["'=1+1", "'\n=1+1", "'＝1+1", '-', '-0.5', -0.123457]
    """
    if isinstance(value, float):
        return round(value, CSV_DIGITS)
    begins = unicodedata.normalize("NFKC", value).lstrip() if isinstance(value, str) else ""
    formula = len(begins) > 1 and begins[0] in "=+-@" and not NUMBER.fullmatch(begins)
    return f"'{value}" if formula else value
