"""Movement: where an exploration led, and what became of a shape that was moved.

In:  a ``World`` with an ``Exploration`` of it; or a world before and after, with the points of a grid.
Out: the axes, with a title that states what there is to see.

>>> from primkit.world import World
>>> plot_change(World(), World(), []).get_title(loc="left")
'0 of 0 points are ghosts'
"""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from numpy.typing import ArrayLike

from ..arguments import as_points
from ..driving import Exploration
from ..world import World
from .look import GREY, INK, ORANGE, as_axes, check_type, draw_areas, draw_board, draw_legend, marks, patch, set_title

GHOST_GAP = 0.004  # m: a point farther than this from every outline belongs to nothing that is there


def plot_tour(world: World, tour: Exploration, ax: Axes | None = None) -> Axes:
    """Draw where the robot drove, where it scanned, and what it saw.

    Parameters
    ----------
    world : World
        The truth.
    tour : Exploration
        What ``explore`` returned.
    ax : Axes, optional
        Where to draw.
    """
    check_type("world", world, World)
    check_type("tour", tour, Exploration)
    ax = as_axes(ax)
    points = tour.scans.points()
    draw_board(ax, world.size, points, legend=True, walls=world.walled)
    draw_areas(ax, world.shapes)
    ax.plot(*points.T, "o", color=INK, markersize=marks(ax, 2), markeredgewidth=0, zorder=3)
    (way,) = ax.plot(*tour.path[:, :2].T, color=GREY, linewidth=marks(ax, 1.2), label="way", zorder=2)
    look: dict[str, Any] = {
        "marker": "o",
        "linestyle": "none",
        "color": ORANGE,
        "markeredgecolor": INK,
        "markersize": marks(ax, 6),
    }
    (stops,) = ax.plot(*tour.poses[:, :2].T, label="scan", zorder=4, **look)
    (start,) = ax.plot(*tour.path[:1, :2].T, label="start", zorder=5, **(look | {"marker": "D", "color": "white"}))
    draw_legend(ax, [way, stops, start])
    set_title(ax, f"{tour.n_scans} scans in {tour.robot_time:.0f} s: {tour.why}")
    return ax


def plot_change(before: World, after: World, points: ArrayLike, ax: Axes | None = None) -> Axes:
    """Draw the points of a grid over a world in which something was moved; ghosts stand out.

    Parameters
    ----------
    before, after : World
        The truth as it was (dashed) and as it is (filled).
    points : array_like, shape (N, 2)
        The grid's points, metres; those more than 4 mm from every outline that is there now are ghosts.
    ax : Axes, optional
        Where to draw.
    """
    check_type("before", before, World)
    check_type("after", after, World)
    points, ax = as_points(points), as_axes(ax)
    off = np.full(len(points), np.inf)
    for shape in after.shapes:
        off = np.minimum(off, np.abs(shape.signed_distance(points)))
    ghost = off > GHOST_GAP
    draw_board(ax, after.size, points, legend=True, walls=after.walled)
    draw_areas(ax, after.shapes)
    dashed: dict[str, Any] = {"fill": False, "edgecolor": GREY, "linestyle": "--", "linewidth": marks(ax, 1.2)}
    for shape in before.shapes:
        if shape not in after.shapes:
            ax.add_patch(patch(shape, **dashed))
    ax.plot(*points[~ghost].T, "o", color=INK, markersize=marks(ax, 2.4), markeredgewidth=0, zorder=3)
    ax.plot(*points[ghost].T, "x", color=ORANGE, markersize=marks(ax, 4), zorder=4)
    was = Line2D([], [], color=GREY, linestyle="--", label="where it was")
    here = Line2D([], [], color=INK, marker="o", markersize=3, linestyle="none", label="point")
    draw_legend(ax, [was, here, Line2D([], [], color=ORANGE, marker="x", linestyle="none", label="ghost")])
    set_title(ax, f"{ghost.sum()} of {len(points)} points are ghosts")
    return ax
