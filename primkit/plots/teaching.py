"""Teaching: how a class did in a problem set, part by part.

In:  for each part its task, its words, the share of right answers, and the most frequent wrong one with its count.
Out: a matplotlib ``Figure``: a bar for each part, the usual wrong answer beside it.

>>> class_figure("ps1", 4, [("half", "lengths", 0.75, ("twice for half", 1))]).axes[0].get_xlabel()
'share of right answers [%]'
"""

from __future__ import annotations

import textwrap
from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from .look import BLUE, GREY, INK, PALE, count, set_title
from .story import Picture, freeze, plain

Part = tuple[str, str, float, tuple[str, int]]

WIDTH, HEAD, ROW = 9.0, 1.3, 0.42  # inches
LETTERS = 9.0
MOST = 46  # letters of a wrong answer's name


def class_figure(name: str, students: int, parts: Sequence[Part]) -> Figure:
    """Return the picture of a class and a problem set.

    Parameters
    ----------
    name : str
        The problem set.
    students : int
        How many were graded.
    parts : sequence of (task, part, share right, (usual wrong answer, count))
        In the order of the problem set; shares from 0 to 1.

    Raises
    ------
    ValueError
        If there is no part.
    """
    if not parts:
        raise ValueError("parts must hold at least one part of a problem set")
    with plain():
        figure = Picture(figsize=(WIDTH, HEAD + ROW * len(parts)), layout="constrained")
        _draw_bars(figure.add_subplot(), parts)
        set_title(figure.axes[0], _words(_finding(name, students, parts)))
        freeze(figure)
    return figure


def _draw_bars(ax: Axes, parts: Sequence[Part]) -> None:
    """Draw a bar for each part, and beside it the usual wrong answer."""
    rows = range(len(parts))
    ax.barh(rows, [100 * right for _, _, right, _ in parts], height=0.62, color=BLUE)
    for row, (_, _, right, (fault, times)) in enumerate(parts):
        told = f"{100 * right:.0f} %" + (f"   {times} x {_short(fault)}" if times else "")
        place = (100 * right, row)
        ax.annotate(_words(told), place, (5, 0), textcoords="offset points", va="center", fontsize=LETTERS, color=INK)
    names = [_words(f"{task}: {part}" if part else task) for task, part, _, _ in parts]
    ax.set_yticks(rows, names, fontsize=LETTERS)
    ax.set(xlim=(0, 200), ylim=(len(parts) - 0.4, -0.6))  # the right half is for words
    ax.set_xticks([0, 25, 50, 75, 100])
    ax.set_xlabel("share of right answers [%]", fontsize=LETTERS + 1, x=0.25)
    ax.grid(axis="x", color=PALE, linewidth=0.6)
    ax.set_axisbelow(True)
    ax.spines[["top", "right", "bottom"]].set_visible(False)
    ax.tick_params(color=GREY, labelsize=LETTERS)


def _short(fault: str) -> str:
    return textwrap.shorten(fault, MOST, placeholder=" ...")


def _words(text: str) -> str:
    """Return a text in which a dollar is a dollar, and begins no formula."""
    return text.replace("$", r"\$")


def _finding(name: str, students: int, parts: Sequence[Part]) -> str:
    """Return the title: the hardest part, and what went wrong in it."""
    task, part, right, (fault, times) = min(parts, key=lambda row: row[2])
    if right == 1:
        return f"{name}: all of {count(students, 'student')} have all of it right"
    hardest = f"{name}: hardest was {task}{f', {part}' if part else ''}: {100 * right:.0f} % right"
    return f"{hardest}; most often: {_short(fault)}" if times else hardest
