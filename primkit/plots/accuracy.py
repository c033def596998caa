"""Accuracy: how right the methods are against noise, number of shapes, number of scans and spurious returns.

In:  the tables of ``run_accuracy``.
Out: a matplotlib ``Figure``: a column for each sweep, a row for each tolerance, a line for each method.

>>> plot_accuracy([])
Traceback (most recent call last):
    ...
ValueError: tables must hold one of the sweeps noise, shapes, scans, spurious; got none
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..arguments import check_type
from ..palette import BLACK, BLUE, GREEN, GREY, INK, ORANGE, PALE, PURPLE, VERMILION
from ..study.accuracy.accuracy_table import COARSE, FINE, TRUTHS, AccuracyLine
from ..study.accuracy.sweeps import SWEEPS
from ..study.estimate import Estimate
from ..table import Table
from .look import FIGURE_LETTERS
from .story import ShownFigure, freeze, plain

PANELS = ("noise", "shapes", "scans", "spurious")  # a sweep of two levels needs no picture
TOLERANCES = (("coarse", COARSE), ("fine", FINE))
PANEL_WIDTH, PANEL_HEIGHT = 2.5, 2.0  # inches
ACCURACY_HEAD = 1.3  # inches: title, legend and caption
LEGEND_ROOM = 7.8  # inches: the title's and the legend's

# The oracle is a broad grey line behind the others, so that a method that reaches it stays visible on it.
METHOD_LOOKS: dict[str, dict[str, Any]] = {
    TRUTHS: {"color": GREY, "alpha": 0.4, "linestyle": "-", "linewidth": 5, "marker": "", "zorder": 2},
    "ROBUST": {"color": BLUE, "linestyle": "-", "marker": "o"},
    "PAPER": {"color": VERMILION, "linestyle": "--", "marker": "s"},
}
OTHER_LOOKS: tuple[dict[str, Any], ...] = (
    {"color": GREEN, "linestyle": "-.", "marker": "^"},
    {"color": PURPLE, "linestyle": ":", "marker": "D"},
    {"color": ORANGE, "linestyle": "--", "marker": "v"},
    {"color": BLACK, "linestyle": "-.", "marker": "P"},
)


def plot_accuracy(tables: Iterable[Table]) -> Figure:
    """Return one figure: weighted accuracy within 5 mm and 1 mm against what was changed, with 95 % bands.

    The figure is as ``plot_story``'s. Raises ValueError if none of these sweeps is there.

    Parameters
    ----------
    tables : iterable of Table
        Of ``run_accuracy``. Noise, number of shapes, number of scans and spurious returns are drawn, as far as
        they are there.
    """
    tables = list(tables)
    for table in tables:
        check_type(table, Table, "each of the tables must be of type Table")
    drawn = sorted((t for t in tables if t.name in PANELS), key=lambda t: PANELS.index(t.name))
    if not drawn:
        got = ", ".join(t.name for t in tables) or "none"
        raise ValueError(f"tables must hold one of the sweeps {', '.join(PANELS)}; got {got}")
    with plain():
        size = (max(LEGEND_ROOM, len(drawn) * PANEL_WIDTH), 2 * PANEL_HEIGHT + ACCURACY_HEAD)
        figure = ShownFigure(figsize=size, layout="constrained")
        axes = figure.subplots(2, len(drawn), sharey=True, sharex="col", squeeze=False)
        methods = list(dict.fromkeys(line.method for table in drawn for line in table.lines))
        for column, table in zip(axes.T, drawn, strict=True):
            for ax, (name, _) in zip(column, TOLERANCES, strict=True):
                _draw_panel(ax, table, name, methods)
            column[0].set_title(table.title.split(",")[0], size=FIGURE_LETTERS + 1, loc="left")
            column[-1].set_xlabel(SWEEPS[table.name].axis, size=FIGURE_LETTERS)
        for ax, (_, tolerance) in zip(axes[:, 0], TOLERANCES, strict=True):
            ax.set_ylabel(f"weighted accuracy\nwithin {1000 * tolerance:g} mm", size=FIGURE_LETTERS)
        _frame(figure, axes[0, 0], drawn, methods)
        freeze(figure)
    return figure


def _draw_panel(ax: Axes, table: Table, name: str, methods: Sequence[str]) -> None:
    """Draw one sweep at one tolerance: for each method its line, and the band that the interval sweeps."""
    for method in dict.fromkeys(line.method for line in table.lines):
        lines = [line for line in table.lines if line.method == method]
        x = np.array([line.x for line in lines])
        estimates: list[Estimate] = [getattr(line, name) for line in lines]
        low = [e.value if e.low is None else e.low for e in estimates]
        high = [e.value if e.high is None else e.high for e in estimates]
        look = _look(method, methods)
        if method != TRUTHS:
            ax.fill_between(x, low, high, color=look["color"], alpha=0.2, linewidth=0)
        ax.plot(x, [e.value for e in estimates], label=method, clip_on=False, **look)
    ax.set(ylim=(0, 1), yticks=np.linspace(0, 1, 6))
    ax.grid(axis="y", color=PALE, linewidth=0.5, zorder=0)
    ax.set_axisbelow(True)
    ax.set_xticks(sorted({line.x for line in table.lines}))
    ax.tick_params(color=GREY, labelsize=FIGURE_LETTERS - 1)
    ax.spines[["top", "right"]].set_visible(False)
    ax.spines[["left", "bottom"]].set_color(GREY)


def _look(method: str, methods: Sequence[str]) -> dict[str, Any]:
    """Return a method's colour, dash and marker; one that is not known here gets its own by its place."""
    strangers = [name for name in methods if name not in METHOD_LOOKS]
    look = METHOD_LOOKS[method] if method in METHOD_LOOKS else OTHER_LOOKS[strangers.index(method) % len(OTHER_LOOKS)]
    return {"linewidth": 1.6, "markersize": 4.5, "zorder": 3} | look


def _frame(figure: Figure, first: Axes, tables: Sequence[Table], methods: Sequence[str]) -> None:
    """Write the finding above, and below it what the lines and bands are."""
    # The empty line below the title is the legend's room.
    look: dict[str, Any] = {"size": FIGURE_LETTERS + 3, "weight": "bold", "color": INK, "linespacing": 1.8}
    figure.suptitle(f"{_finding(tables, methods)}\n", x=0.01, ha="left", **look)
    handles, names = first.get_legend_handles_labels()
    known = {"PAPER": "PAPER, as published (told the number of shapes)", TRUTHS: "oracle (told the side of each point)"}
    labels = [known.get(name, name) for name in names]
    legend = figure.legend(handles, labels, ncols=len(labels), frameon=False, fontsize=FIGURE_LETTERS, handlelength=2.5)
    below = 1 - 1.8 * (FIGURE_LETTERS + 3) / 72 / figure.get_figheight()
    legend.set(loc="upper left", in_layout=False)
    legend.set_bbox_to_anchor((0.0, below))
    counts = sorted({line.n_maps for table in tables for line in table.lines})
    n = f"{counts[0]}" if len(counts) == 1 else f"{counts[0]} to {counts[-1]}"
    text = f"{n} free maps (any rotation, irregular) for each mark. Bands: 95 % intervals over the maps (bootstrap)."
    figure.supxlabel(text, size=FIGURE_LETTERS - 1, x=0.01, ha="left", color=GREY)


def _finding(tables: Sequence[Table], methods: Sequence[str]) -> str:
    """Say how far each method stays behind the oracle within 5 mm, where it does so the most; the best method first."""
    worst = {name: max(gap for t in tables for gap in _behind(t.lines, name)) for name in methods if name != TRUTHS}
    ranked = sorted((gap, name) for name, gap in worst.items())
    if not ranked:
        return "What the oracle reaches"
    (gap, name), *rest = ranked
    first = f"{name} is at most {max(gap, 0.001):.{2 if gap >= 0.01 else 3}f} behind the oracle"
    return ", ".join([f"Within 5 mm, {first}", *(f"{other} up to {gap:.2f}" for gap, other in rest)])


def _behind(lines: Sequence[AccuracyLine], method: str) -> list[float]:
    truths = {line.level: line.coarse.value for line in lines if line.method == TRUTHS}
    return [truths[line.level] - line.coarse.value for line in lines if line.method == method]
