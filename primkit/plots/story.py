"""Story: all steps in one figure, and the file it goes to.

In:  what every step handed on.
Out: a matplotlib ``Figure`` that leaves nothing behind; a PNG file.
"""

from __future__ import annotations

import io
from collections.abc import Iterable
from contextlib import AbstractContextManager
from pathlib import Path

import matplotlib.style
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from ..arguments import as_points, check_type
from ..formats import StrPath, write_atomically
from ..lidar import Scans
from ..measure import Detection
from ..report import Report
from ..shapes import Shape
from ..table import count
from ..world import World
from .findings import plot_found
from .look import set_title
from .pictures import plot_clusters, plot_points, plot_scan, plot_world

PICTURE_DPI = 200
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
    """Return one figure with the whole story: a scan, the points, the clusters, and the shapes with their errors.

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
    ['a) No scans', 'b) No points', 'c) No clusters', 'd) No shapes found']
    """
    points = as_points(points)
    check_type(scans, Scans, "scans must be of type Scans")
    check_type(report, Report, "report must be of type Report")
    with plain():
        figure = ShownFigure(figsize=(6.4, 5.0), layout="constrained")
        axes = figure.subplot_mosaic("ad;bd;cd", width_ratios=[1, 2.8])
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
        freeze(figure)
    return figure


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
