"""Story: all steps in one figure, and the file it goes to.

In:  what every step handed on.
Out: a matplotlib ``Figure`` that leaves nothing behind; a PNG file.
"""

from __future__ import annotations

import io
from collections.abc import Iterable, Sequence
from contextlib import AbstractContextManager
from pathlib import Path

import matplotlib.style
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from numpy.typing import ArrayLike

from ..arguments import Floats, as_points, check_type
from ..formats import StrPath, write_atomically
from ..found import resolution_of
from ..lidar import Scans
from ..measure import Detection
from ..palette import GREY, INK, KIND_COLORS, PALE
from ..report import Match, Report
from ..shapes import Shape
from ..show import digits_of_mm
from ..table import count
from ..world import World
from .findings import plot_found
from .look import outlines, patch, set_title
from .pictures import plot_clusters, plot_points, plot_scan, plot_world

PICTURE_DPI = 200
LOUPE_CELLS = 20  # the loupe shows so many in a row
LAYOUT_ROUNDS = 2  # the layout comes nearer to its goal each time: after these, to a pixel or two


class ShownFigure(Figure):
    """A figure that a notebook shows, even one that has not used pyplot yet."""

    def _repr_png_(self) -> bytes:
        return _png(self)


def plain() -> AbstractContextManager[None]:
    """Return a context with matplotlib's own settings: the story looks the same, whatever the user's are."""
    return matplotlib.style.context("default")


def plot_story(
    world: World, scans: Scans, points: ArrayLike, labels: ArrayLike, found: Iterable[Detection | Shape], report: Report
) -> Figure:
    """Return one figure with the whole story: a scan, the points, the clusters, the shapes, and a loupe.

    The loupe shows the place at which a found outline is farthest from the true one, so large that cells are seen.

    It is made without pyplot: nothing stays open, no display is needed. A notebook shows it when it is a cell's last
    value; ``save_figure`` writes it to a file. Raises ValueError if points, labels or report do not fit.

    Parameters
    ----------
    world : World, the truth
    scans : Scans
        What the LiDAR saw; the scan with the most hits is drawn.
    points : array_like, shape (N, 2), metres
    labels : array_like of int, shape (N,)
        Which cluster each point belongs to, from 0; -1 for strays.
    found : iterable of Detection, Circle and Polygon
    report : Report
        The comparison of these shapes with the truth.

    Examples
    --------
    >>> from primkit.evaluation import evaluate
    >>> from primkit.lidar import scan
    >>> empty = World()
    >>> figure = plot_story(empty, scan(empty, []), [], [], [], evaluate([], empty))
    >>> sorted(ax.get_title(loc="left") for ax in figure.axes)
    ['a) No scans', 'b) No points', 'c) No clusters', 'd) No shapes found', 'e) Nothing to compare']
    """
    points = as_points(points)
    check_type(scans, Scans, "scans must be of type Scans")
    check_type(report, Report, "report must be of type Report")
    with plain():
        figure = ShownFigure(figsize=(6.4, 6.4), layout="constrained")
        axes = figure.subplot_mosaic("abc;dde", height_ratios=[1, 2])
        if len(scans):
            plot_scan(world, scans, int(scans.hits.sum(axis=1).argmax()), axes["a"])
        else:
            plot_world(world, axes["a"])
        plot_points(points, axes["b"], size=world.size)
        plot_clusters(points, labels, axes["c"], size=world.size)
        _as_step(axes["a"], "a) One scan" if len(scans) else "a) No scans")
        _as_step(axes["b"], f"b) {count(len(points), 'point').capitalize()}")
        _as_step(axes["c"], f"c) {axes['c'].get_title(loc='left')}")
        figure.supxlabel(report.scores().replace(" = ", "\n= "), size=8)
        plot_found(found, world, axes["d"], report)
        set_title(axes["d"], f"d) {axes['d'].get_title(loc='left')}")
        _draw_loupe(axes["e"], axes["d"], points, report.matches, resolution_of(found))
        freeze(figure)
    return figure


def _draw_loupe(ax: Axes, board: Axes, points: Floats, matches: Sequence[Match], cell: float) -> None:
    """Draw the place at which a found outline is farthest from the true one, and mark it on the board."""
    _as_step(ax, "e) Nothing to compare")
    ax.set(aspect="equal", anchor="N")
    rings = [outlines([match.true]) for match in matches]
    apart = [np.abs(match.found.signed_distance(ring)) for match, ring in zip(matches, rings, strict=True)]
    if not apart:
        return
    worst = np.concatenate(apart).argmax()
    off, place = np.concatenate(apart)[worst], np.vstack(rings)[worst]
    half = max(LOUPE_CELLS / 2 * cell, 2 * off)
    corner, side = place - half, 2 * half
    for near in points[np.abs(points - place).max(axis=1) < half + cell]:
        ax.add_patch(Rectangle(near - cell / 2, cell, cell, facecolor=PALE, edgecolor="white", linewidth=0.5))
    for match in matches:
        ax.add_patch(patch(match.true, fill=False, edgecolor=GREY, linewidth=4, alpha=0.5))
        ax.add_patch(patch(match.found, fill=False, edgecolor=KIND_COLORS[match.found.kind], linewidth=1.5))
    ax.set(xlim=(corner[0], corner[0] + side), ylim=(corner[1], corner[1] + side))
    ax.set_xlabel(f"grey line: the truth\nsquares: cells of {1000 * cell:g} mm", size=8, loc="left")
    set_title(ax, f"e) Farthest off: {1000 * off:.{digits_of_mm(cell)}f} mm")
    board.add_patch(Rectangle(corner, side, side, fill=False, edgecolor=INK, linewidth=1, zorder=9))


def plot_recording(points: ArrayLike, found: Iterable[Detection | Shape], size: float) -> Figure:
    """Return one figure with a map whose truth is not known: the points, shape (N, 2), metres, and what was found.

    >>> [ax.get_title(loc="left") for ax in plot_recording([(0, 0)], [], 1.0).axes]
    ['1 point on the grid', 'No shapes found']
    """
    with plain():
        figure = ShownFigure(figsize=(10, 5.0), layout="constrained")
        left, right = figure.subplots(1, 2)
        plot_points(points, left, size=size)
        plot_found(found, World(size=size), right)
        freeze(figure)
    return figure


def freeze(figure: Figure) -> None:
    """Lay the figure out once and for all: else each drawing moves things by a hair, and its bytes change."""
    engine = figure.get_layout_engine()
    assert engine is not None
    for _ in range(LAYOUT_ROUNDS):
        engine.execute(figure)
    figure.set_layout_engine("none")


def _as_step(ax: Axes, title: str) -> None:
    """Make a picture small: a short title, and the scales left to the large one, which shows the same board."""
    ax.set(xticks=[], yticks=[], xlabel="", ylabel="")
    set_title(ax, " ".join(title.split()))


def save_figure(figure: Figure, path: StrPath) -> None:
    """Write a figure as PNG, whole or not at all; the same picture gives the same bytes.

    Parameters
    ----------
    figure : Figure
        From ``plot_story``, or ``ax.figure`` of any plot.
    path : str or path
        The file, ending in ``.png``; one that is there already is replaced.

    Raises
    ------
    ValueError
        If the ending is another one.
    OSError
        If the file cannot be written; the old one then stays as it was.

    Examples
    --------
    >>> save_figure(Figure(), "map.geojson")
    Traceback (most recent call last):
        ...
    ValueError: map.geojson: the name of a picture must end in .png, got .geojson
    """
    path = Path(path)
    if path.suffix.lower() != ".png":
        raise ValueError(f"{path.name}: the name of a picture must end in .png, got {path.suffix or 'no ending'}")
    write_atomically(path, _png(figure))


def _png(figure: Figure) -> bytes:
    buffer = io.BytesIO()
    with plain():  # no metadata: a version would change the bytes
        figure.savefig(buffer, format="png", dpi=PICTURE_DPI, metadata={"Software": None})
    return buffer.getvalue()
