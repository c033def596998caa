"""Look: the board, and what all pictures share.

In:  the axes, and what is to be drawn on them.
Out: artists on these axes; sizes of letters that suit their width.

>>> import matplotlib.figure
>>> ax = matplotlib.figure.Figure().subplots()
>>> set_title(ax, "Four shapes")
>>> ax.get_title(loc="left")
'Four shapes'
"""

from __future__ import annotations

import re
import textwrap
from collections.abc import Callable, Iterable, Sequence
from functools import partial
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.colors import is_color_like, to_rgba
from matplotlib.legend import Legend
from matplotlib.patches import Circle as CirclePatch
from matplotlib.patches import Patch, Rectangle
from matplotlib.patches import Polygon as PolygonPatch
from matplotlib.ticker import FuncFormatter, MaxNLocator
from matplotlib.typing import ColorType

from ..arguments import Floats, check_type, short

# Notebooks that were released before take their colours from here.
from ..palette import BLACK, BLUE, GREY, INK, KIND_COLORS, KIND_MARKERS, ORANGE, PALE, VERMILION  # noqa: F401
from ..robot import BODY
from ..shapes import Circle, Shape

UNITS = (("m", 1, 0.25), ("cm", 100, 0.025), ("mm", 1000, 0.0))  # on boards of so many metres and more
BOARD_MARGIN = 0.03  # of the board's size, left free around it
LEGEND_BAND = 0.06  # of the board's size, left free above it for a legend
FULL_WIDTH = 3.5  # inches: in narrower axes all letters are smaller
LEAST_LETTERS = 5.0  # points
FIGURE_LETTERS = 9.0  # points: in figures of a fixed size
LEAST_COLUMNS = 10  # letters: a title is not broken into shorter lines
LEGEND_LETTERS = (8.5, 7.5, 6.5)  # points: the largest of which the legend is no wider than the axes
LEGEND_WIDTH = 2.6  # inches: narrower axes have no room for a legend

ROBOT_SIGN: dict[str, Any] = {"marker": "o", "markerfacecolor": "white", "markeredgecolor": INK, "markersize": 7}

FIGURE_SIZE = (5.2, 5.2)  # inches: small, so that letters can still be read at 390 pixels, a phone's width


def as_axes(ax: Axes | None) -> Axes:
    """Return the axes, or those of a new pyplot figure."""
    if ax is not None:
        check_type(ax, Axes, "ax must be of type Axes")
        return ax
    import matplotlib.pyplot as plt  # not at the top: pyplot keeps a list of figures, and only this needs it

    return plt.subplots(figsize=FIGURE_SIZE, layout="constrained")[1]


def draw_board(
    ax: Axes,
    size: float,
    points: Floats | None = None,
    *,
    legend: bool = False,
    walls: bool = False,
    faint: bool = False,
) -> Floats:
    """Draw the board's edge, or its walls; set limits that hold it, the points, and a band above for a legend.

    Walls are ``faint`` under those that were found. Axes are in m, on a small board in cm or mm.

    Returns the lower left and the upper right corner of what holds the board and the points, shape (2, 2), metres.
    """
    half = size / 2
    edge: dict[str, Any] = {"edgecolor": PALE if walls and faint else INK, "linewidth": 4 if walls else 1}
    ax.add_patch(Rectangle((-half, -half), size, size, facecolor="white", zorder=0.5, **edge))
    inside = np.vstack([[(-half, -half), (half, half)], np.empty((0, 2)) if points is None else points])
    room = np.array([inside.min(axis=0), inside.max(axis=0)])
    (left, low), (right, high) = room + np.array([[-BOARD_MARGIN], [BOARD_MARGIN]]) * size
    ax.set(xlim=(left, right), ylim=(low, high + legend * LEGEND_BAND * (right - left)), aspect="equal")
    unit, times = next((unit, times) for unit, times, least in UNITS if size >= least)
    for axis, name in ((ax.xaxis, "x"), (ax.yaxis, "y")):
        axis.set_label_text(f"{name} [{unit}]", fontsize=letters(ax, 10))
        axis.set_major_locator(MaxNLocator(5))
        if times > 1:
            axis.set_major_formatter(FuncFormatter(partial(_tick_in, times)))
    ax.spines[:].set_visible(False)
    ax.tick_params(color=GREY, labelsize=letters(ax, 9))
    return room


def _tick_in(times: int, value: float, _: int | None = None) -> str:
    """Return a tick's text; ``value`` in metres, its unit goes so many ``times`` into one."""
    return f"{round(times * value, 6) + 0.0:g}".replace("-", "\u2212")  # as matplotlib's own minus


def width_of(ax: Axes) -> float:
    """Return the width of the axes in inches."""
    assert ax.figure is not None  # axes that were removed cannot be drawn on
    ax.apply_aspect()
    return ax.get_window_extent().width / ax.figure.dpi


def marks(ax: Axes, size: float) -> float:
    """Return the size of markers and lines in points: ``size`` where there is room, less in narrow axes."""
    return size * min(1.0, width_of(ax) / FULL_WIDTH)


def letters(ax: Axes, size: float) -> float:
    """Return the size of letters in points, as ``marks``, but never too small to be read."""
    return max(marks(ax, size), LEAST_LETTERS)


def check_look(title: str | None, color: ColorType | None = None) -> None:
    """Refuse a title that is no text, and a colour that is none of matplotlib's."""
    if title is not None:
        check_type(title, str, "title must be a text")
    if color is not None and not is_color_like(color):
        raise ValueError(f'color must be a colour, such as "tab:blue" or "#0072B2", got {short(color)}')


def set_title(ax: Axes, text: str, own: str | None = None) -> None:
    """Set the title, the user's own if there is one, on as many lines as the width of the axes asks for."""
    text = text if own is None else own
    title = ax.set_title("", loc="left", size=max(letters(ax, 11), 8), weight="bold")
    together = re.sub(r"(\d) (\w)", "\\1\u00a0\\2", text)  # a number and its noun stay on one line
    for columns in range(max(len(text), LEAST_COLUMNS), LEAST_COLUMNS - 1, -1):
        title.set_text(textwrap.fill(together, columns).replace("\u00a0", " "))
        if title.get_window_extent().width <= ax.get_window_extent().width:
            break


class _AtEachSize(Artist):
    """Draws nothing: acts before the axes' other artists are drawn, when the width of the axes has changed."""

    def __init__(self, act: Callable[[], None]) -> None:
        super().__init__()
        self.act, self.width = act, -1.0
        self.set(zorder=-100, in_layout=False)

    def draw(self, renderer: object) -> None:
        assert isinstance(self.axes, Axes)
        width = round(width_of(self.axes), 3)
        if width != self.width:
            self.act()
        self.width = width


def at_each_size(ax: Axes, act: Callable[[], None]) -> None:
    """Act when the axes are drawn, and again when their size has changed: layouts settle late."""
    ax.add_artist(_AtEachSize(act))


def draw_legend(ax: Axes, handles: Sequence[Artist]) -> None:
    """Explain the lines in the band above the board, where the axes are wide enough for it."""
    spacing = {"handlelength": 1.6, "handletextpad": 0.5, "columnspacing": 1.2, "borderaxespad": 0.0}
    legend = ax.legend(
        handles=handles, loc="upper center", ncols=len(handles), frameon=False, fontsize=LEGEND_LETTERS[0], **spacing
    )
    legend.set_in_layout(False)
    at_each_size(ax, partial(_fit_legend, ax, legend))


def _fit_legend(ax: Axes, legend: Legend) -> None:
    if legend is not ax.get_legend():  # taken away since
        return
    legend.set_visible(width_of(ax) >= LEGEND_WIDTH)
    for size in LEGEND_LETTERS:
        for text in legend.get_texts():
            text.set_fontsize(letters(ax, size))
        if legend.get_window_extent().width <= ax.get_window_extent().width:
            break


def patch(shape: Shape, **look: Any) -> Patch:
    """Return the matplotlib patch of a shape."""
    if isinstance(shape, Circle):
        return CirclePatch((shape.center[0], shape.center[1]), shape.radius, **look)
    return PolygonPatch(shape.vertices, closed=True, **look)


def outlines(shapes: Iterable[Shape]) -> Floats:
    """Return the corners of all shapes, and points all round their circles, shape (N, 2), metres."""
    return np.vstack([np.empty((0, 2)), *(s.outline(40) if isinstance(s, Circle) else s.vertices for s in shapes)])


def draw_areas(ax: Axes, shapes: Iterable[Shape], own: ColorType | None = None, **look: Any) -> None:
    """Fill shapes with their kinds' colours or the user's own, lightly unless ``look`` says otherwise."""
    for shape in shapes:
        color = KIND_COLORS[shape.kind] if own is None else own
        usual = {"facecolor": to_rgba(color, 0.2), "edgecolor": color, "linewidth": 0, "zorder": 1}
        ax.add_patch(patch(shape, **(usual | look)))


def draw_robot(ax: Axes, pose: Floats, width: float = 1.0, scale: float = 1.0) -> None:
    """Draw the robot's body, with a line from its middle to where it heads; ``width`` in points."""
    (x, y, heading), body = pose.tolist(), BODY * scale
    ax.add_patch(CirclePatch((x, y), body, facecolor="white", edgecolor=INK, linewidth=width, zorder=2.8))
    nose = body * np.array([np.cos(heading), np.sin(heading)])
    ax.plot([x, x + nose[0]], [y, y + nose[1]], color=INK, linewidth=1.6 * width, solid_capstyle="butt", zorder=5)


def draw_center(ax: Axes, shape: Shape, own: ColorType | None = None) -> None:
    """Mark a shape's centre with its kind's sign."""
    color, marker = KIND_COLORS[shape.kind] if own is None else own, KIND_MARKERS[shape.kind]
    ax.plot(*shape.centroid, marker, color=color, markersize=marks(ax, 6), markeredgewidth=0, zorder=4)
