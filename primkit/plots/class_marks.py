"""Teaching: how a class did in a problem set, part by part.

In:  for each part its task, its words, the share of right answers, and the most frequent wrong one with its count.
Out: a matplotlib ``Figure``: a bar for each part, the usual wrong answer beside it.

>>> plot_class("ps1", 4, [("half", "lengths", 0.75, ("twice for half", 1))]).axes[0].get_xlabel()
'share of right answers [%]'
"""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..palette import BLUE, GREY, INK, PALE
from ..table import count
from .look import FIGURE_LETTERS
from .story import ShownFigure, freeze, plain

Part = tuple[str, str, float, tuple[str, int]]
Row = tuple[str, float | None, tuple[str, int]]  # a heading has no share

CLASS_WIDTH, CLASS_HEAD, BAR_HEIGHT = 9.0, 1.3, 0.3  # inches
WORD_BOX = {"facecolor": "white", "edgecolor": "none", "pad": 1.0}  # behind words, for the grid not to cross them
TITLE_LETTERS = 84  # letters in a line of the title
FAULT_LETTERS = 46  # letters of a wrong answer's name


def plot_class(name: str, students: int, parts: Sequence[Part]) -> Figure:
    """Return the picture of a class and a problem set.

    Raises ValueError if there is no part.

    Parameters
    ----------
    name : str
        The problem set.
    students : int
        How many were graded.
    parts : sequence of (task, part, share right, (usual wrong answer, count))
        In the order of the problem set; shares from 0 to 1.
    """
    if not parts:
        raise ValueError("parts must hold at least one part of a problem set")
    rows = list(_rows(parts))
    with plain():
        figure = ShownFigure(figsize=(CLASS_WIDTH, CLASS_HEAD + BAR_HEIGHT * len(rows)), layout="constrained")
        title = textwrap.fill(_words(_finding(name, students, parts)), TITLE_LETTERS)
        figure.suptitle(title, x=0.01, ha="left", size=FIGURE_LETTERS + 2.5, weight="bold")
        _draw_bars(figure.add_subplot(), rows)
        freeze(figure)
    return figure


def _rows(parts: Sequence[Part]) -> Iterator[Row]:
    """Yield a heading for each task, and its parts; ``half-visible`` and ``half`` are one task."""
    last = ""
    for task, part, right, usual in parts:
        head, _, rest = task.partition("-")
        if head != last:
            last = head
            yield (head, None, ("", 0)) if part or rest else (head, right, usual)
        if part or rest:
            yield f"{part or rest}  ", right, usual


def _draw_bars(ax: Axes, rows: Sequence[Row]) -> None:
    """Draw a bar for each part, and beside it the usual wrong answer."""
    for row, (_, right, (fault, times)) in enumerate(rows):
        if right is None:
            continue
        ax.barh(row, 100 * right, height=0.66, color=BLUE)
        told = f"{100 * right:.0f} %" + (f"   {times} x {_short(fault)}" if times else "")
        place = (100 * right, row)
        ax.annotate(
            _words(told),
            place,
            (5, 0),
            textcoords="offset points",
            va="center",
            fontsize=FIGURE_LETTERS,
            color=INK,
            bbox=WORD_BOX,
        )
    ax.set_yticks(range(len(rows)), [_words(name) for name, _, _ in rows], fontsize=FIGURE_LETTERS)
    for label, (_, right, _) in zip(ax.get_yticklabels(), rows, strict=True):
        label.set_fontweight("bold" if right is None else "normal")
    ax.set(xlim=(0, 200), ylim=(len(rows) - 0.4, -0.6))  # the right half is for words
    ax.set_xticks([0, 25, 50, 75, 100])
    ax.set_xlabel("share of right answers [%]", fontsize=FIGURE_LETTERS + 1, x=0.25)
    ax.grid(axis="x", color=PALE, linewidth=0.6)
    ax.set_axisbelow(True)
    ax.spines[["top", "right", "bottom"]].set_visible(False)
    ax.tick_params(color=GREY, labelsize=FIGURE_LETTERS)
    ax.tick_params(axis="y", length=0)


def _short(fault: str) -> str:
    return textwrap.shorten(fault, FAULT_LETTERS, placeholder=" ...")


def _words(text: str) -> str:
    """Return a text in which a dollar is a dollar, and begins no formula."""
    return text.replace("$", r"\$")


def _finding(name: str, students: int, parts: Sequence[Part]) -> str:
    """Return the title: the hardest part, and what went wrong in it."""
    asked = [row for row in parts if row[1]] or parts  # parts of hidden tests, where there are any
    task, part, right, (fault, times) = min(asked, key=lambda row: row[2])
    if right == 1:
        return f"{name}: all of {count(students, 'student')} have all of it right"
    hardest = f"{name}: hardest is {task}{f', {part}' if part else ''}: {100 * right:.0f} % right"
    return f"{hardest}; most often: {_short(fault)}" if times else hardest
