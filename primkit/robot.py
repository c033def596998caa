"""Robot: where the e-puck stands when it scans.

Third step of the story. Automatic movement: the robot is set down on way-points that cover the board and scans once
at each; a way-point inside a shape, or too near to a wall for its body, is skipped. Manual movement: its two wheels
turn as the user says, and it stops where it would touch something.

In:  a ``World``, and for a drive the speeds of the wheels.
Out: poses, shape (P, 3): x [m], y [m], heading [rad, counter-clockwise from the x axis], world frame.

>>> from primkit.world import World
>>> teleport_poses(World()).shape
(77, 3)
>>> drive(World(), [(6.28, 6.28)] * 10)[-1].round(4).tolist()  # both wheels at full speed, for a second
[0.1287, 0.0, 0.0]

Two wheels at speeds l and r [rad/s], of radius R, at a distance A from each other, make the robot move at
v = R (l + r) / 2 and turn at w = R (r - l) / A. While they are held, it goes along an arc: in the time t it turns by
w t, and comes v t sin(w t / 2) / (w t / 2) far, in the direction midway between the old heading and the new one.

All lengths here are those of the paper's board, and follow the scale of another, ``World.scale``.

Source: the paper's section 3.2, "Robot Movement", with the numbers of its published code.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .arguments import (
    Bools,
    Floats,
    as_point,
    as_points,
    as_poses,
    as_positive,
    as_rng,
    as_share,
    check_type,
    limit,
    short,
)
from .world import World, scale_of

STEP_X = 0.15  # m between way-points along x
STEP_Y = 0.10  # m between way-points along y
STOP_X = 0.10  # the last column stands this far [m] inside the board's right edge

WHEEL = 0.0205  # m: radius of a wheel
AXLE = 0.052  # m from wheel to wheel
FASTEST = 6.28  # rad/s: a wheel's greatest speed
BODY = 0.037  # m: radius of the body, a disc around the middle of the axle
PUBLISHED_HEADING = np.radians(0.15)  # in all of the paper's runs
PERIOD = 0.1  # s: wheels keep their speeds from one scan to the next
CLEAR = 0.0001  # m: so long are the steps in which a way is looked at, and so far the body keeps from everything
# What grows with time, and would fill the memory.
MOST_PLACES, MOST_STEPS = 1_000_000, 20_000_000  # on one way, and on a drive of two kilometres


def waypoints(size: float = 1.0) -> Floats:
    """Return the paper's way-points for a board of ``size`` metres, shape (P, 3).

    x runs from ``-size/2`` in steps of 0.15 m up to ``size/2 - 0.1`` m, y from ``-size/2`` to ``size/2``
    in steps of 0.10 m, column by column; the heading is 0. A board of 1 m has 7 x 11 = 77 of them, and so has one of
    10 m: all follows the board's scale.

    >>> waypoints()[[0, 1, -1]].round(3).tolist()
    [[-0.5, -0.5, 0.0], [-0.5, -0.4, 0.0], [0.4, 0.5, 0.0]]
    """
    scale = scale_of(as_positive(size, "size"))
    half = size / scale / 2
    columns = np.arange(np.floor((2 * half - STOP_X) / STEP_X + 1e-9) + 1)  # 1e-9: 0.9 / 0.15 is 6, not 5.99
    rows = np.arange(np.floor(2 * half / STEP_Y + 1e-9) + 1)
    x, y = np.meshgrid(-half + STEP_X * columns, -half + STEP_Y * rows, indexing="ij")
    return np.column_stack([scale * x.ravel(), scale * y.ravel(), np.zeros(x.size)])


def published_poses(size: float = 1.0) -> Floats:
    """Return where the paper's robot scans when it is set down, shape (P, 3): all way-points but the first.

    It scans at those inside a shape, too, and its heading is 0.15 degrees.

    >>> published_poses().shape
    (76, 3)
    """
    poses = waypoints(size)[1:]
    poses[:, 2] = PUBLISHED_HEADING
    return poses


def inside_shape(world: World, poses: Floats) -> Bools:
    """Tell for each pose whether its position lies in a shape or on an outline, shape (P,)."""
    inside = np.zeros(len(poses), dtype=bool)
    for shape in world.shapes:
        inside |= shape.signed_distance(poses[:, :2]) <= 0
    return inside


def teleport_poses(world: World) -> Floats:
    """Return the way-points that the robot can be set down on, shape (P, 3).

    Left out are those inside a shape, and those nearer to a wall than the robot's radius: ``skipped_waypoints``.

    >>> from primkit.shapes import Circle
    >>> world = World([Circle((0.1, 0.0), 0.05)])
    >>> len(teleport_poses(world)), skipped_waypoints(world).round(3).tolist()
    (76, [[0.1, 0.0, 0.0]])
    """
    return _on_board(world)[0]


def skipped_waypoints(world: World) -> Floats:
    """Return the way-points inside a shape or too near to a wall, shape (Q, 3); the robot is not set down there."""
    return _on_board(world)[1]


def _on_board(world: World) -> tuple[Floats, Floats]:
    """Return the way-points with room for the robot, and the others."""
    check_type(world, World, "world must be a World")
    poses = waypoints(world.size)
    barred = inside_shape(world, poses)
    if world.walled:
        barred |= world.size / 2 - np.abs(poses[:, :2]).max(axis=1) < BODY * world.scale
    return poses[~barred], poses[barred]


def moved(poses: ArrayLike, wheels: ArrayLike, time: float | Floats, scale: float = 1.0) -> Floats:
    """Return where robots are after their wheels have turned for a while, with nothing in the way, shape as ``poses``.

    ``wheels``, shape (..., 2): speeds of the left and the right wheel, rad/s; ``time``, shape (...), seconds;
    ``scale``: how many times as large as the paper's the robots are.

    Wheels at equal and opposite speeds turn it on the spot:

    >>> moved((0, 0, 0), (-1, 1), 2.0).round(4).tolist()
    [0.0, 0.0, 1.5769]
    """
    pose, (left, right) = np.asarray(poses, dtype=float), np.moveaxis(np.asarray(wheels, dtype=float), -1, 0)
    turn = WHEEL * (right - left) / AXLE * time
    speed = scale * WHEEL * (right + left) / 2
    way = speed * time * np.sinc(turn / (2 * np.pi))  # numpy's sinc(x) is sin(pi x) / (pi x)
    bearing = pose[..., 2] + turn / 2
    step = np.stack(np.broadcast_arrays(way * np.cos(bearing), way * np.sin(bearing), turn), axis=-1)
    return pose + step


def clearance(world: World, places: Floats) -> Floats:
    """Return how far the robot's body, at places, shape (N, 2), is from the nearest shape or edge, shape (N,), metres.

    Below zero it would be in a shape or beyond the edge of the board.
    """
    free: Floats = world.size / 2 - np.abs(places).max(axis=1)
    for shape in world.shapes:
        free = np.minimum(free, shape.signed_distance(places))
    return free - BODY * world.scale


def advance(world: World, pose: ArrayLike, wheels: ArrayLike, time: float = PERIOD) -> tuple[Floats, bool]:
    """Return the robot's pose after its wheels have turned for a while, and whether something stopped it.

    It stops where its body would touch a shape or leave the board, at most a fifth of a millimetre before; its wheels
    then slip, and it only turns. Raises ValueError if an argument is out of its range, or the body is not clear to
    begin with.

    ``pose``, shape (3,), and ``wheels``, shape (2,), as in a drive; ``time`` in seconds.

    >>> from primkit.shapes import Circle
    >>> pose, stopped = advance(World([Circle((0.1, 0.0), 0.05)]), (0, 0, 0), (6.28, 6.28), time=1.0)
    >>> round(float(pose[0]), 3), stopped
    (0.013, True)
    """
    check_type(world, World, "world must be a World")
    here, speeds, clear = _as_pose(pose), not_too_fast(as_point(wheels, "wheels")), CLEAR * world.scale
    seconds = as_positive(time, "time", zero=True)
    way = WHEEL * float(np.abs(speeds.sum())) / 2 * seconds
    limit(way / CLEAR, MOST_PLACES, "a way must take at most {} steps of 0.1 mm", "is the time in seconds?")
    times = np.linspace(0, seconds, 2 + int(way / CLEAR))
    poses = moved(here, speeds, times, world.scale)
    free = clearance(world, poses[:, :2]) - clear
    if free[0] < -clear:
        x, y = here[:2]
        raise ValueError(f"the robot must stand clear of shapes and on the board, got ({x:g}, {y:g}) m")
    blocked = np.flatnonzero((free[1:] < 0) & (free[1:] < free[:-1]))  # who stands too close may drive away
    if way == 0 or len(blocked) == 0:
        return poses[-1], False
    return np.array([*poses[blocked[0], :2], poses[-1, 2]]), True


def drive(world: World, wheels: ArrayLike, start: ArrayLike | None = None, *, period: float = PERIOD) -> Floats:
    """Return the poses of a drive, shape (T + 1, 3): the start, and one after each pair of wheel speeds.

    Raises ValueError if an argument is out of its range, or the body is not clear at the start.

    Parameters
    ----------
    world : World
    wheels : array_like, shape (T, 2)
        Speeds of the left and the right wheel, rad/s, at most 6.28 either way; each pair is held for a period.
    start : array_like, shape (3,), optional
        x [m], y [m], heading [rad]; the free place nearest to the board's centre when not given.
    period : float, seconds between two scans

    Examples
    --------
    >>> drive(World(), [(3, 6), (6, 3)], start=(0.1, 0.2, 0)).round(4).tolist()
    [[0.1, 0.2, 0.0], [0.1092, 0.2005, 0.1183], [0.1184, 0.2011, 0.0]]
    """
    check_type(world, World, "world must be a World")
    poses = [start_pose(world) if start is None else _as_pose(start)]
    speeds_of_all = not_too_fast(as_points(wheels, "wheels"))
    check_way(speeds_of_all, as_positive(period, "period"))
    for speeds in speeds_of_all:
        poses.append(advance(world, poses[-1], speeds, period)[0])
    return np.array(poses)


def odometry(
    poses: ArrayLike, *, slip: float = 0.03, turn: float = 1.0, rng: int | np.random.Generator | None = None
) -> Floats:
    """Return the poses that a robot believes to have, which counts its wheels' turns, shape (P, 3).

    The first one is right. From there on the wheels slip: over a way of one metre, the way that is told is off by
    ``slip`` metres (standard deviation), and the heading by ``turn`` degrees. One half of either variance lasts for the
    whole drive, as of wheels that are not quite as large as they should be; the other half is drawn for each step.

    Raises ValueError if poses are not finite (P, 3), slip is not a share, or turn is negative.

    >>> way = [(x, 0, 0) for x in range(4)]
    >>> odometry(way, slip=0.03, turn=0, rng=0)[:, 0].round(3).tolist()
    [0.0, 1.016, 2.008, 3.038]
    """
    true, rng = as_poses(poses), as_rng(rng)
    if len(true) == 0:
        return true
    slip, turn = as_share(slip, "slip"), np.radians(as_positive(turn, "turn", zero=True))
    steps = increments(true)
    way = np.hypot(*steps[:, :2].T)
    lasting, new = rng.normal(size=2), rng.normal(size=(len(steps), 2))
    off = np.sqrt(0.5) * (way[:, None] * lasting + np.sqrt(way)[:, None] * new)
    along = np.divide(steps[:, :2], way[:, None], out=np.zeros((len(steps), 2)), where=way[:, None] > 0)
    steps[:, :2] += slip * off[:, :1] * along
    steps[:, 2] += turn * off[:, 1]
    return chained(true[:1], steps)


def increments(poses: Floats) -> Floats:
    """Return the steps from each pose to the next, as seen from it: forward, to the left [m], turn [rad], (P - 1, 3).

    >>> increments(np.array([(0, 0, np.pi / 2), (0, 2, np.pi)])).round(3).tolist()
    [[2.0, 0.0, 1.571]]
    """
    (x, y, turn), heading = np.diff(poses, axis=0).T, poses[:-1, 2]
    c, s = np.cos(heading), np.sin(heading)
    return np.column_stack([c * x + s * y, c * y - s * x, turn])


def chained(start: Floats, steps: Floats) -> Floats:
    """Return the poses to which steps lead, one after the other, shape (P, 3): the inverse of ``increments``."""
    heading = start[:, 2] + np.concatenate([[0.0], np.cumsum(steps[:, 2])])
    c, s = np.cos(heading[:-1]), np.sin(heading[:-1])
    x, y = steps[:, 0], steps[:, 1]
    ways = np.column_stack([c * x - s * y, s * x + c * y])
    return np.column_stack([np.concatenate([start[:, :2], start[:, :2] + np.cumsum(ways, axis=0)]), heading])


def start_pose(world: World) -> Floats:
    """Return the free place nearest to the board's centre, on a grid of a centimetre, heading 0, shape (3,).

    Raises ValueError if the body has no room anywhere.

    >>> start_pose(World()).tolist()
    [0.0, 0.0, 0.0]
    """
    half, whole = 0.0, world.size / world.scale / 2
    while half < whole:  # around the centre first: a large board has more places than are ever looked at
        half = min(max(0.5, 2 * half), whole)
        lines = np.arange(-np.floor(100 * half), np.floor(100 * half) + 1) / 100
        places = np.stack(np.meshgrid(lines, lines, indexing="ij"), axis=-1).reshape(-1, 2)
        places = places[clearance(world, world.scale * places) >= CLEAR * world.scale]
        away = np.hypot(*places.T).round(9)
        if len(places) and (away.min() <= half or half == whole):
            x, y = world.scale * places[np.lexsort((places[:, 1], places[:, 0], away))[0]]
            return np.array([x, y, 0.0])
    raise ValueError("the board must have room for the robot, got none between its shapes")


def _as_pose(pose: ArrayLike) -> Floats:
    """Return one pose, shape (3,), or say in one sentence what is wrong."""
    poses = as_poses(pose)
    if len(poses) != 1:
        raise ValueError(f"a pose must be three finite numbers (x, y, heading), got {short(pose)}")
    return poses[0]


def check_way(wheels: Floats, period: float) -> None:
    """Refuse a drive that would take too long to follow in steps of a tenth of a millimetre."""
    steps = WHEEL / 2 / CLEAR * period * float(np.abs(wheels.sum(axis=1)).sum())
    limit(steps, MOST_STEPS, "a drive must take at most {} steps of 0.1 mm", "is the period in seconds?")


def not_too_fast(wheels: Floats) -> Floats:
    """Return wheel speeds, or refuse the fastest in one sentence."""
    fastest = np.abs(wheels).max(initial=0.0)
    if fastest > FASTEST:
        raise ValueError(f"wheels must turn at {FASTEST:g} rad/s at most, got {fastest:g}")
    return wheels
