"""Ways driven: how the map grows on a drive, where an exploration led, and what became of a shape that was moved.

In:  a ``World`` with a ``Drive`` or an ``Exploration`` of it; or a world before and after, with the points of a grid.
Out: ``plot_drive`` a matplotlib ``Figure``, a strip of frames; the others the axes.

>>> from primkit.lidar import scan
>>> from primkit.shapes import Circle
>>> world = World([Circle((0.2, 0), 0.05)])
>>> figure = plot_drive(world, Drive(scan(world, [(0, 0, 0), (0, 0.01, 0)]), [(0, 0), (6, 6)]), n_frames=2)
>>> [ax.get_title(loc="left") for ax in figure.axes]
['0.1 s: 9 points', '0.2 s: 13 points']
"""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import ArrayLike, NDArray

from ..arguments import Floats, Ints, as_count, as_points, as_positive, check_type
from ..driving import Exploration
from ..formats import Drive
from ..grid import Grid
from ..measure import CELL
from ..palette import BLUE, GREY, INK, ORANGE, PALE, VERMILION
from ..rest import distance_to_wall
from ..table import count
from ..world import World
from .look import (
    ROBOT_SIGN,
    as_axes,
    check_look,
    draw_areas,
    draw_board,
    draw_legend,
    draw_robot,
    marks,
    patch,
    set_title,
)
from .story import ShownFigure, freeze, plain

FRAMES_IN_A_ROW = 3
FRAME_SIDE = 2.5  # inches
STRIP_HEAD = 0.8  # inches: title and legend
DOTS: dict[str, Any] = {"marker": "o", "markeredgewidth": 0, "linestyle": "none"}
SEEN_BEFORE, SEEN_NEW = DOTS | {"color": INK, "markersize": 2.2}, DOTS | {"color": VERMILION, "markersize": 3.4}
WAY_LOOK: dict[str, Any] = {"color": BLUE, "linewidth": 1.0}
GHOST_CELLS = 4  # a point farther than this from every outline belongs to nothing that is there


def plot_drive(world: World, drive: Drive, n_frames: int = 6) -> Figure:
    """Return one figure with frames of a drive: the way so far, what was seen by then, and what of it is new.

    The figure is as ``plot_story``'s. Raises ValueError if the drive has no scans, or an argument is of another type.

    Parameters
    ----------
    world : World
        The truth, drawn pale: it is not known to the robot.
    drive : Drive
        What was driven and seen.
    n_frames : int
        How many frames, evenly spread over the scans; at most one for each scan.

    Notes
    -----
    Points are the grid's: cells of 1 mm, times the board's scale, that were hit, each counted when it was hit first.
    """
    check_type(world, World, "world must be of type World")
    check_type(drive, Drive, "drive must be of type Drive")
    n_frames = min(as_count(n_frames, "n_frames"), len(drive))
    if n_frames == 0:
        raise ValueError("a drive must have scans to be drawn, got none")
    ends = np.linspace(0, len(drive), n_frames + 1).round().astype(int)
    points, first = _first_seen(drive, world.cell)
    columns = 2 if n_frames == 4 else min(FRAMES_IN_A_ROW, n_frames)
    rows = -(-n_frames // columns)
    with plain():
        figure = ShownFigure(
            figsize=(max(columns * FRAME_SIDE, 4.0), rows * FRAME_SIDE + STRIP_HEAD), layout="constrained"
        )
        grid = figure.subplots(rows, columns, squeeze=False).ravel()
        for number, (ax, before, end) in enumerate(zip(grid, ends, ends[1:], strict=False)):
            _draw_frame(ax, world, drive.poses[:end], points[first < end], first[first < end] >= before)
            set_title(ax, f"{end * drive.period:.1f} s: {count(int((first < end).sum()), 'point')}")
            _keep_outer_labels(ax, left=number % columns == 0, below=number + columns >= n_frames)
        for ax in grid[n_frames:]:
            ax.remove()
        title = f"The map grows: {count(len(points), 'point')} after {len(drive) * drive.period:.1f} s"
        figure.suptitle(title, x=0.01, ha="left", size=11, weight="bold")
        ncols = 4 if columns == FRAMES_IN_A_ROW else 2
        figure.legend(handles=_legend(), loc="outside lower center", ncols=ncols, frameon=False, fontsize=8.5)
        freeze(figure)
    return figure


def plot_tour(world: World, tour: Exploration, ax: Axes | None = None, *, title: str | None = None) -> Axes:
    """Draw where the robot drove, where it scanned, and what it saw.

    Parameters
    ----------
    world : World
        The truth.
    tour : Exploration
        What ``explore`` returned.
    ax, title : optional
        As for ``plot_world``.
    """
    check_type(world, World, "world must be of type World")
    check_type(tour, Exploration, "tour must be of type Exploration")
    check_look(title)
    ax = as_axes(ax)
    points = tour.scans.points()
    draw_board(ax, world.size, points, legend=True, walls=world.walled)
    draw_areas(ax, world.shapes)
    ax.plot(*points.T, "o", color=INK, markersize=marks(ax, 2), markeredgewidth=0, zorder=3)
    (way,) = ax.plot(*tour.path[:, :2].T, color=GREY, linewidth=marks(ax, 1.2), label="way", zorder=2)
    look: dict[str, Any] = {"linestyle": "none", "markeredgecolor": INK, "markersize": marks(ax, 6)}
    (stops,) = ax.plot(*tour.poses[:, :2].T, label="scan", marker="o", color=ORANGE, zorder=4, **look)
    (start,) = ax.plot(*tour.path[:1, :2].T, label="start", marker="D", color="white", zorder=5, **look)
    draw_legend(ax, [way, stops, start])
    set_title(ax, f"{tour.n_scans} scans in {tour.robot_time:.0f} s: {tour.why}", title)
    return ax


def plot_change(
    before: World,
    after: World,
    points: ArrayLike,
    ax: Axes | None = None,
    *,
    resolution: float = CELL,
    title: str | None = None,
) -> Axes:
    """Draw the points of a grid over a world in which something was moved; ghosts stand out.

    Parameters
    ----------
    before, after : World
        The truth as it was (dashed) and as it is (filled).
    points : array_like, shape (N, 2)
        The grid's points, metres; those more than four cells from every outline and wall that is there now are ghosts.
    ax, title : optional
        As for ``plot_world``.
    resolution : float
        Side of the grid's cells, metres.
    """
    check_type(before, World, "before must be of type World")
    check_type(after, World, "after must be of type World")
    check_look(title)
    points, ax, gap = as_points(points), as_axes(ax), GHOST_CELLS * as_positive(resolution, "resolution")
    near = [np.abs(shape.signed_distance(points)) <= gap for shape in after.shapes]
    near += [distance_to_wall(points, wall) <= gap for wall in after.walls]
    ghost = ~np.any(near, axis=0) if near else np.ones(len(points), dtype=bool)
    draw_board(ax, after.size, points, legend=True, walls=after.walled)
    draw_areas(ax, after.shapes)
    dashed: dict[str, Any] = {"fill": False, "edgecolor": GREY, "linestyle": "--", "linewidth": marks(ax, 1.2)}
    gone = [shape for shape in before.shapes if shape not in after.shapes]
    for shape in gone:
        ax.add_patch(patch(shape, **dashed))
    ax.plot(*points[~ghost].T, "o", color=INK, markersize=marks(ax, 2.4), markeredgewidth=0, zorder=3)
    ax.plot(*points[ghost].T, "x", color=ORANGE, markersize=marks(ax, 4), zorder=4)
    known = [
        (len(gone) > 0, Line2D([], [], color=GREY, linestyle="--", label="where it was")),
        (not ghost.all(), Line2D([], [], color=INK, marker="o", markersize=3, linestyle="none", label="point")),
        (ghost.any(), Line2D([], [], color=ORANGE, marker="x", linestyle="none", label="ghost")),
    ]
    draw_legend(ax, [artist for there, artist in known if there])
    set_title(ax, f"{ghost.sum()} of {len(points)} points are ghosts", title)
    return ax


def _first_seen(drive: Drive, cell: float) -> tuple[Floats, Ints]:
    """Return the grid's points, shape (N, 2), and the number of the scan that hit each first, shape (N,)."""
    grid, scans = Grid(cell), drive.scans
    cells, first = np.unique(grid.to_cells(scans.points()), axis=0, return_index=True)
    return grid.to_points(cells), np.nonzero(scans.hits)[0][first]


def _draw_frame(ax: Axes, world: World, poses: Floats, points: Floats, new: NDArray[np.bool_]) -> None:
    """Draw the board, the shapes pale, the way, the points, and the robot at its end."""
    draw_board(ax, world.size, points, walls=world.walled)
    for shape in world.shapes:
        ax.add_patch(patch(shape, facecolor="#F2F2F2", edgecolor=PALE, linewidth=0.8, zorder=1))
    ax.plot(*poses[:, :2].T, zorder=2, **(WAY_LOOK | {"linewidth": marks(ax, 1.2)}))
    for look, those in ((SEEN_BEFORE, ~new), (SEEN_NEW, new)):
        ax.plot(*points[those].T, zorder=3, **(look | {"markersize": marks(ax, look["markersize"])}))
    draw_robot(ax, poses[-1], scale=world.scale)


def _keep_outer_labels(ax: Axes, *, left: bool, below: bool) -> None:
    """Leave the scales to the frames at the edge of the figure: all show the same board."""
    if not left:
        ax.set(ylabel="")
        ax.tick_params(labelleft=False)
    if not below:
        ax.set(xlabel="")
        ax.tick_params(labelbottom=False)


def _legend() -> list[Line2D]:
    return [
        Line2D([], [], label="seen before", **(SEEN_BEFORE | {"markersize": 4})),
        Line2D([], [], label="new in this frame", **(SEEN_NEW | {"markersize": 5})),
        Line2D([], [], label="way so far", **WAY_LOOK),
        Line2D([], [], label="robot", linestyle="none", **ROBOT_SIGN),
    ]
