"""Pictures: the board, a scan, the points and the clusters.

In:  what one step of the story hands on, and the axes to draw on.
Out: these axes, with a title that states what there is to see.

>>> plot_points([(0, 0), (0.1, 0)]).get_title(loc="left")
'2 points on the grid'
"""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.lines import Line2D
from matplotlib.patches import Circle as CirclePatch
from matplotlib.typing import ColorType
from numpy.typing import ArrayLike, NDArray

from ..arguments import Floats, as_count, as_points, as_positive, check_type
from ..lidar import Lidar, Scans, as_lidar
from ..palette import CLUSTER_COLORS, CLUSTER_MARKERS, GREY, INK, KIND_INKS, ORANGE, PALE
from ..raycast import cast_rays
from ..shapes import Circle
from ..show import census
from ..table import count
from ..world import World
from .labels import write_labels
from .look import (
    ROBOT_SIGN,
    as_axes,
    check_look,
    draw_areas,
    draw_board,
    draw_center,
    draw_legend,
    draw_robot,
    letters,
    marks,
    outlines,
    set_title,
    width_of,
)

SIGNS_PER_CLUSTER = 6  # larger markers on each cluster, so that it can be told from the others without colour


def plot_world(
    world: World, ax: Axes | None = None, *, title: str | None = None, color: ColorType | None = None
) -> Axes:
    """Draw the board with its shapes, and the names of their kinds where there is room (the paper's Figure 1b, c).

    Parameters
    ----------
    world : World
        The truth.
    ax : Axes, optional
    title : str, optional
        What to say above it; what there is to see when not given, nothing when empty.
    color : color, optional
        Of all shapes; of each kind its own when not given.

    Examples
    --------
    >>> plot_world(World()).get_title(loc="left")
    'No shapes'
    """
    check_type(world, World, "world must be of type World")
    check_look(title, color)
    ax = as_axes(ax)
    room = draw_board(ax, world.size, outlines(world.shapes), walls=world.walled)
    draw_areas(ax, world.shapes, color, linewidth=1.5)
    for shape in world.shapes:
        draw_center(ax, shape, color)
    set_title(ax, census(world.shapes).capitalize(), title)
    write_labels(ax, [(shape.kind, shape, KIND_INKS[shape.kind]) for shape in world.shapes], (), room)
    return ax


# --- what the robot sees ------------------------------------------------------------------------------------


def plot_scan(
    world: World,
    scans: Scans,
    index: int = 0,
    ax: Axes | None = None,
    *,
    lidar: Lidar | None = None,
    title: str | None = None,
    color: ColorType | None = None,
) -> Axes:
    """Draw one scan: the robot, its LiDAR's range, and every beam (the paper's Figure 1a).

    Raises ValueError if there is no scan with that index, or an argument is of another type.

    Parameters
    ----------
    world : World
    scans : Scans
        What the LiDAR saw.
    index : int
        Which of the scans, from 0.
    lidar : Lidar, optional
        The sensor whose range is drawn; the paper's by default.
    ax, title : optional
        As for ``plot_world``.
    color : color, optional
        Of the beams that hit; orange when not given.

    Examples
    --------
    >>> from primkit.lidar import scan
    >>> world = World([Circle((0.2, 0), 0.05)])
    >>> plot_scan(world, scan(world, [(0, 0, 0)])).get_title(loc="left")
    'Scan 0: 9 of 100 beams hit'
    """
    sensor = Lidar() if lidar is None else lidar
    for name, value, kind in (("world", world, World), ("scans", scans, Scans), ("lidar", sensor, Lidar)):
        check_type(value, kind, f"{name} must be of type {kind.__name__}")
    lidar = as_lidar(lidar, world.scale)
    if as_count(index, "index", least=0) >= len(scans):
        raise ValueError(f"index must be below the number of scans, got {index} for {len(scans)}")
    check_look(title, color)
    ax, seen = as_axes(ax), scans[index : index + 1]
    draw_board(ax, world.size, Circle(seen.poses[0, :2], lidar.range_max).outline(4), legend=True, walls=world.walled)
    draw_areas(ax, world.shapes, linewidth=1.5)
    beams = _draw_beams(ax, world, seen, lidar, ORANGE if color is None else color)
    draw_legend(ax, [*beams, *_draw_range(ax, seen.poses[0], lidar, world.scale)])
    hits = f"{seen.hits.sum()} of {seen.hits.size} beams hit"
    set_title(ax, f"Scan {index}: {'inside a shape, it sees nothing' if seen.inside[0] else hits}", title)
    return ax


def _draw_beams(ax: Axes, world: World, seen: Scans, lidar: Lidar, color: ColorType) -> list[Artist]:
    """Draw the beams of one scan as far as they go; return what the legend shows."""
    start, bearings, hit = seen.poses[0, :2], seen.poses[0, 2] + seen.angles, seen.hits[0]
    turned = np.column_stack([np.broadcast_to(start, (len(bearings), 2)), bearings])
    free = cast_rays(world, turned, [0.0], lidar.range_max)[:, 0]  # an outline that is too near blocks without a hit
    reach = np.where(hit, seen.ranges[0], np.minimum(free, lidar.range_max))
    ends = start + reach[:, None] * np.column_stack([np.cos(bearings), np.sin(bearings)])
    beams = np.stack([turned[:, :2], ends], axis=1)
    ax.add_collection(LineCollection(beams[~hit], colors=PALE, linewidths=0.6, zorder=2), autolim=False)
    ax.add_collection(LineCollection(beams[hit], colors=[color], linewidths=0.9, zorder=3), autolim=False)
    ax.plot(*ends[hit].T, "o", color=INK, markersize=marks(ax, 3), markeredgewidth=0, zorder=4)
    dot = Line2D([], [], color=color, marker="o", markersize=3, markerfacecolor=INK, markeredgewidth=0, label="hit")
    return [dot, Line2D([], [], color=PALE, label="no hit")]


def _draw_range(ax: Axes, pose: Floats, lidar: Lidar, scale: float) -> list[Artist]:
    """Draw the robot, and the ring in which it can see; return what the legend shows."""
    rim: dict[str, Any] = {"color": GREY, "linestyle": "--", "linewidth": 0.9}
    for radius in (lidar.range_min, lidar.range_max):
        ax.add_patch(CirclePatch((pose[0], pose[1]), radius, fill=False, zorder=2.5, **rim))
    draw_robot(ax, pose, marks(ax, 1.2), scale)
    ring = f"range {lidar.range_min:g} to {lidar.range_max:g} m"
    return [Line2D([], [], label=ring, **rim), Line2D([], [], label="robot", linestyle="none", **ROBOT_SIGN)]


# --- points and clusters ------------------------------------------------------------------------------------


def plot_points(
    points: ArrayLike,
    ax: Axes | None = None,
    *,
    size: float = 1.0,
    title: str | None = None,
    color: ColorType | None = None,
) -> Axes:
    """Draw the grid's points (the paper's Figure 2a).

    Raises ValueError if points are not finite (N, 2), or the size is not above zero.

    Parameters
    ----------
    points : array_like, shape (N, 2), metres
    size : float
        Side of the board in metres.
    ax, title : optional
        As for ``plot_world``.
    color : color, optional
        Of the points; black when not given.

    Examples
    --------
    >>> plot_points([]).get_title(loc="left")
    'No points on the grid'
    """
    points, size = as_points(points), as_positive(size, "size")
    check_look(title, color)
    ax = as_axes(ax)
    draw_board(ax, size, points)
    ax.plot(*points.T, "o", color=INK if color is None else color, markersize=marks(ax, 2.4), markeredgewidth=0)
    set_title(ax, f"{count(len(points), 'point').capitalize()} on the grid", title)
    return ax


def plot_clusters(
    points: ArrayLike, labels: ArrayLike, ax: Axes | None = None, *, size: float = 1.0, title: str | None = None
) -> Axes:
    """Draw each cluster in its own colour, with its own marker and its number (the paper's Figure 2b).

    Raises ValueError if points are not finite (N, 2), labels are not a whole number for each of them, or the size is
    not above zero.

    Parameters
    ----------
    points : array_like, shape (N, 2), metres
    labels : array_like of int, shape (N,)
        Which cluster each point belongs to, from 0; -1 for strays, which become grey crosses.
    size : float
        Side of the board in metres.
    ax, title : optional
        As for ``plot_world``.

    Examples
    --------
    >>> plot_clusters([(0, 0), (0, 0.1), (0.4, 0)], [0, 0, -1]).get_title(loc="left")
    '1 cluster, 1 stray'
    """
    points, size = as_points(points), as_positive(size, "size")
    check_look(title)
    labels, ax = _as_labels(labels, len(points)), as_axes(ax)
    draw_board(ax, size, points)
    strays, numbers = points[labels < 0], np.unique(labels[labels >= 0]).tolist()
    ax.plot(*strays.T, "x", color=GREY, markersize=marks(ax, 5), markeredgewidth=1)
    for number in numbers:
        _draw_cluster(ax, points[labels == number], number)
    aside = f", {count(len(strays), 'stray')}" if len(strays) else ""
    set_title(ax, count(len(numbers), "cluster").capitalize() + aside, title)
    return ax


def _draw_cluster(ax: Axes, cluster: Floats, number: int) -> None:
    """Draw a cluster's points, a few larger signs spread around it, and its number in the middle."""
    color, marker = CLUSTER_COLORS[number % len(CLUSTER_COLORS)], CLUSTER_MARKERS[number % len(CLUSTER_MARKERS)]
    middle = cluster.mean(axis=0)
    around = cluster[np.argsort(np.arctan2(*(cluster - middle).T))]
    signs = around[:: -(-len(cluster) // SIGNS_PER_CLUSTER)]
    ax.plot(*cluster.T, "o", color=color, markersize=marks(ax, 3), markeredgewidth=0)
    sign = ax.plot(*signs.T, marker, color=color, markersize=marks(ax, 7))[0]
    sign.set(markeredgecolor="white", markeredgewidth=marks(ax, 0.5))
    size = letters(ax, 12)
    small = np.ptp(cluster, axis=0).min() * 72 * width_of(ax) < 1.5 * size * np.ptp(ax.get_xlim())
    spot, shift, side = ((middle[0], cluster[:, 1].max()), size / 2, "bottom") if small else (middle, 0, "center")
    text = ax.annotate(str(number), spot, (0, shift), textcoords="offset points", ha="center", va=side, zorder=6)
    text.set(fontsize=size, weight="bold", color=INK)


def _as_labels(labels: ArrayLike, n: int) -> NDArray[np.int64]:
    array = np.asarray(labels)
    if array.shape != (n,) or (n and array.dtype.kind not in "iu"):
        got = f"{array.dtype} of shape {array.shape}"
        raise ValueError(f"labels must be a whole number for each of the {n} points, got {got}")
    return array.astype(np.int64)
