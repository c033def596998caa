"""Timing: what a task costs as it grows, for several tools.

In:  for each tool the sizes and what each costs.
Out: one picture, both ways on a logarithmic scale: a straight line that rises is a power of the size.

>>> ax = plot_bench({"ours": ([4, 400], [1.0, 1.5]), "theirs": ([4, 400], [2.0, 200.0])})
>>> ax.get_title(loc="left"), ax.get_xscale(), ax.get_yscale()
('ours: 1 µs for 4 shapes, 1.5 µs for 400', 'log', 'log')
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, NullFormatter

from primkit.palette import BLACK, BLUE, GREEN, GREY, INK, ORANGE, PALE, PURPLE, SKY, VERMILION
from primkit.plots.look import as_axes, letters, marks, set_title
from primkit.plots.story import ShownFigure

Curve = tuple[Sequence[float], Sequence[float]]

# A tool has a colour, a marker and a dash of its own: none is told by colour alone.
TOOLS = (
    (BLUE, "o", "-"),
    (VERMILION, "s", "--"),
    (GREEN, "^", "-."),
    (PURPLE, "D", ":"),
    (ORANGE, "v", "--"),
    (BLACK, "P", "-."),
    (SKY, "X", ":"),
)


def plot_bench(curves: Mapping[str, Curve], ax: Axes | None = None) -> Axes:
    """Draw the cost of a scan against the number of shapes, one line for each tool.

    Parameters
    ----------
    curves : mapping of str to (sizes, costs)
        For each tool the numbers of shapes and the microseconds per scan; the first tool's are in the title.
    ax : Axes, optional
        Where to draw; a new figure by default.

    Returns
    -------
    Axes
        Both scales are logarithmic.

    Raises
    ------
    ValueError
        If there is no curve, or a size or cost is not above zero.

    Examples
    --------
    >>> plot_bench({})
    Traceback (most recent call last):
        ...
    ValueError: curves must hold at least one tool with sizes and costs above zero
    """
    if not curves or not all(len(sizes) and min([*sizes, *costs]) > 0 for sizes, costs in curves.values()):
        raise ValueError("curves must hold at least one tool with sizes and costs above zero")
    ax = as_axes(ax)
    for number, (tool, (sizes, costs)) in enumerate(curves.items()):
        color, marker, dash = TOOLS[number % len(TOOLS)]
        ax.plot(sizes, costs, dash, marker=marker, color=color, label=tool, lw=marks(ax, 2), ms=marks(ax, 7))
    ax.set(xscale="log", yscale="log")
    for axis, name in ((ax.xaxis, "shapes on the board"), (ax.yaxis, "µs per scan")):
        axis.set_label_text(name, fontsize=letters(ax, 10))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:,g}"))
        axis.set_minor_formatter(NullFormatter())
    ax.grid(color=PALE, linewidth=0.6)
    ax.spines[["top", "right"]].set_visible(False)
    ax.tick_params(color=GREY, labelsize=letters(ax, 9))
    # Beside the axes: there is no corner that the lines leave free for sure.
    legend = ax.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False, handlelength=3.2, labelcolor=INK)
    for text in legend.get_texts():
        text.set_fontsize(letters(ax, 8.5))
    (name, (sizes, costs)), *_ = curves.items()
    set_title(ax, f"{name}: {costs[0]:.2g} µs for {sizes[0]:,} shapes, {costs[-1]:.2g} µs for {sizes[-1]:,}")
    return ax


def bench_figure(curves: Mapping[str, Curve]) -> Figure:
    """Return the picture in a figure of its own, made without pyplot.

    >>> bench_figure({"ours": ([4], [1.0])}).axes[0].get_xlabel()
    'shapes on the board'
    """
    figure = ShownFigure(figsize=(7.2, 4.8), layout="constrained")
    plot_bench(curves, figure.add_subplot())
    return figure
