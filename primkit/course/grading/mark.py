"""Mark: the points of a task, part by part, as text, as HTML, and as data for the report on a class.

In:  for each part its points and its check's answer.
Out: a ``Mark``. A notebook shows the table; the data lie beside it under a type of their own, ``MIME``.

>>> from primkit.checks import Answer
>>> mark = Mark("half", (Row("halves lengths", 2, Answer("right", "all 2 cases.")),))
>>> mark
half: 2 of 2 points
✓ 2 of 2  halves lengths
>>> mark.data()["parts"][0]["verdict"]
'right'
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from html import escape
from typing import Any

from ...checks.answer import VERDICT_COLORS, VERDICT_SIGNS, Answer

PLAIN = str.maketrans("✓✗○", "+x-")  # many a Windows console cannot print the signs
MIME = "application/vnd.primkit.mark+json"


@dataclass(frozen=True)
class Row:
    """One part: what it asks for, its points, what the check said, and what was seen beside and costs nothing."""

    says: str
    of: float
    answer: Answer
    remarks: tuple[str, ...] = ()

    @property
    def points(self) -> float:
        """All or none."""
        return float(self.of) if self.answer.right else 0.0

    @property
    def off(self) -> str:
        """What is off; empty when nothing is."""
        return "" if self.answer.right else self.answer.says

    @property
    def told(self) -> str:
        """What is off, and the remarks."""
        remark = f"(It {' and '.join(self.remarks)}: that costs nothing here.)" if self.remarks else ""
        return "\n".join(filter(None, [self.off, remark]))


@dataclass(frozen=True)
class Mark:
    """The points of a task."""

    task: str
    rows: tuple[Row, ...]

    @property
    def points(self) -> float:
        """What was reached."""
        return float(sum(row.points for row in self.rows))

    @property
    def of(self) -> float:
        """What could be reached."""
        return float(sum(row.of for row in self.rows))

    def data(self) -> dict[str, Any]:
        """Return all of it as plain values, as the report on a class reads it."""
        return {
            "task": self.task,
            "points": self.points,
            "of": self.of,
            "parts": [
                {
                    "says": row.says,
                    "points": row.points,
                    "of": float(row.of),
                    "verdict": row.answer.verdict,
                    "fault": row.answer.fault,
                    "off": row.off,
                    "remarks": list(row.remarks),
                }
                for row in self.rows
            ],
        }

    @property
    def common(self) -> str:
        """What is off in every part alike, to be said once; empty otherwise."""
        said = {row.told for row in self.rows}
        return said.pop() if len(said) == 1 and len(self.rows) > 1 else ""

    @property
    def _headline(self) -> str:
        return f"{self.task}: {self.points:g} of {self.of:g} points"

    def __repr__(self) -> str:
        lines = [self._headline, *self.common.splitlines()]
        for row in self.rows:
            told = [] if self.common else row.told.splitlines()
            off = "".join(f"\n    {line}" for line in told[1:])
            first = f": {told[0]}" if told else ""
            lines.append(f"{VERDICT_SIGNS[row.answer.verdict]} {row.points:g} of {row.of:g}  {row.says}{first}{off}")
        return "\n".join(lines)

    def __str__(self) -> str:
        return repr(self).translate(PLAIN)

    def _repr_html_(self) -> str:
        head = "".join(
            f'<th scope="col" style="{CELL_STYLE}">{word}</th>' for word in ("points", "part", "what is off")
        )
        once = f'<br><span style="font-weight:normal">{_lines(self.common)}</span>' if self.common else ""
        return (
            f'<table style="border-collapse:collapse;line-height:1.5"><caption style="{CELL_STYLE};font-weight:bold;'
            f'color:inherit">{escape(self._headline)}{once}</caption><thead><tr>{head}</tr></thead>'
            f"<tbody>{''.join(_html_row(row, told=bool(self.common)) for row in self.rows)}</tbody></table>"
        )

    def _repr_mimebundle_(self, **_wanted: Any) -> dict[str, Any]:
        return {"text/plain": repr(self), "text/html": self._repr_html_(), MIME: self.data()}


def _lines(text: str) -> str:
    return escape(text).replace("\n", "<br>")


CELL_STYLE = "text-align:left;vertical-align:top;padding:2px 12px 2px 0"


def _html_row(row: Row, *, told: bool = False) -> str:
    """Return a part's row; what is off is left out when it is told above the table."""
    verdict = row.answer.verdict
    points = f"{VERDICT_SIGNS[verdict]} {row.points:g} of {row.of:g}".replace(" ", "&nbsp;")
    sign = f'<b style="color:{VERDICT_COLORS[verdict]}">{points}</b>'
    off = "" if row.answer.right else f"<i>{verdict}</i>"
    if row.told and not told:
        off += f"{': ' if off else ''}{_lines(row.told)}"
    return "<tr>" + "".join(f'<td style="{CELL_STYLE}">{cell}</td>' for cell in (sign, escape(row.says), off)) + "</tr>"


SHOWN: ContextVar[list[Mark] | None] = ContextVar("SHOWN", default=None)  # where the judge looks for marks


@contextmanager
def shown_marks() -> Iterator[list[Mark]]:
    """Keep marks that are shown from now on, in the place of showing them."""
    marks: list[Mark] = []
    before = SHOWN.set(marks)
    try:
        yield marks
    finally:
        SHOWN.reset(before)


def show(mark: Mark) -> None:
    """Show a table in the notebook that runs this, if one does."""
    from IPython import get_ipython
    from IPython.display import display

    if (marks := SHOWN.get()) is not None:
        marks.append(mark)
    elif get_ipython() is not None:
        display(mark)  # type: ignore[no-untyped-call]  # IPython gives it no types
