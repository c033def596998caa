"""Robot: where the e-puck stands when it scans.

Third step of the story: automatic movement. The robot is set down on way-points that cover the board and
scans once at each; a way-point inside a shape is skipped.

In:  a ``World``.
Out: poses, shape (P, 3): x [m], y [m], heading [rad, counter-clockwise from the x axis], world frame.

>>> from primkit.world import World
>>> teleport_poses(World()).shape
(77, 3)

Source: the paper's section 3.2, "Robot Movement", with the numbers of its published code.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .arguments import as_positive, check_type
from .world import World

STEP_X = 0.15  # m between way-points along x
STEP_Y = 0.10  # m between way-points along y
STOP_X = 0.10  # the last column stands this far [m] inside the board's right edge


def waypoints(size: float = 1.0) -> NDArray[np.float64]:
    """Return the paper's way-points for a board of ``size`` metres, shape (P, 3).

    x runs from ``-size/2`` in steps of 0.15 m up to ``size/2 - 0.1`` m, y from ``-size/2`` to ``size/2``
    in steps of 0.10 m, column by column; the heading is 0. A board of 1 m has 7 x 11 = 77 of them.

    Examples
    --------
    >>> waypoints()[[0, 1, -1]].round(3).tolist()
    [[-0.5, -0.5, 0.0], [-0.5, -0.4, 0.0], [0.4, 0.5, 0.0]]
    """
    half = as_positive(size, "size") / 2
    columns = np.arange(np.floor((2 * half - STOP_X) / STEP_X + 1e-9) + 1)  # 1e-9: 0.9 / 0.15 is 6, not 5.99
    rows = np.arange(np.floor(2 * half / STEP_Y + 1e-9) + 1)
    x, y = np.meshgrid(-half + STEP_X * columns, -half + STEP_Y * rows, indexing="ij")
    return np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])


def inside_shape(world: World, poses: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Tell for each pose whether its position lies in a shape or on an outline, shape (P,)."""
    inside = np.zeros(len(poses), dtype=bool)
    for shape in world.shapes:
        inside |= shape.signed_distance(poses[:, :2]) <= 0
    return inside


def teleport_poses(world: World) -> NDArray[np.float64]:
    """Return the way-points that the robot can be set down on, shape (P, 3).

    Those inside a shape are left out; ``skipped_waypoints`` returns them.

    Examples
    --------
    >>> from primkit.shapes import Circle
    >>> world = World([Circle((0.1, 0.0), 0.05)])
    >>> len(teleport_poses(world)), skipped_waypoints(world).round(3).tolist()
    (76, [[0.1, 0.0, 0.0]])
    """
    check_type(world, World, "world must be a World")
    poses = waypoints(world.size)
    return poses[~inside_shape(world, poses)]


def skipped_waypoints(world: World) -> NDArray[np.float64]:
    """Return the way-points that lie inside a shape, shape (Q, 3); the robot is not set down there."""
    check_type(world, World, "world must be a World")
    poses = waypoints(world.size)
    return poses[inside_shape(world, poses)]
