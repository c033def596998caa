"""Raycast: the exact distance along each beam to the first outline it meets.

In:  a ``World``, poses, shape (P, 3): x [m], y [m], heading [rad], and the beams' bearings, shape (B,).
Out: distances, shape (P, B), metres; infinity where a beam meets nothing.

>>> from primkit.shapes import Circle
>>> cast_rays(World([Circle((1, 0), 0.25)]), [(0, 0, 0)], [0.0, np.pi / 2]).tolist()
[[0.75, inf]]

How it is fast. The plain way asks every beam about every side: poses x beams x sides. Here a side is asked once
per pose: the bearings of its two ends tell which beams lie between them, and only those are computed (a circle's
two tangents do the same). The work grows with what is seen, and every hit is exact.

Legend: a pair is one pose with one shape near enough to be seen from it. Positions are taken relative to the
robot and turned into its frame, so that a bearing is a beam's angle. u is a beam's direction, t the distance to
a hit. Beams keep 1/t, their closeness: the nearest hit is the largest, no hit is 0, and sides need no division.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .arguments import ROUNDING, as_poses, check_type
from .shapes import Circle, Polygon
from .world import World

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

# A beam this close [rad] beside a corner still hits it: otherwise rounding could let it slip between two sides.
CORNER_HIT = 1e-12
# Poses are cast in blocks of about this many pairs: a few MB, small enough for the cache.
PAIRS_PER_BLOCK = 8192
# From this many shapes on, a spatial index finds those in range faster than measuring the distance to all.
INDEX_FROM = 64


def cast_rays(world: World, poses: ArrayLike, angles: ArrayLike, range_max: float = np.inf) -> Floats:
    """Return the exact distance from each pose along each beam to the first outline.

    Parameters
    ----------
    world : World
        What stands on the board.
    poses : array_like, shape (P, 3)
        x [m], y [m], heading [rad], world frame.
    angles : array_like, shape (B,)
        Bearings from the heading in radians, increasing, within one turn.
    range_max : float
        Outlines farther off than this are not looked at, in metres.

    Returns
    -------
    array, shape (P, B)
        Metres; ``inf`` where a beam meets nothing, and everywhere from a pose inside a shape.

    Raises
    ------
    ValueError
        If poses are not (P, 3), angles do not increase within one turn, or range_max is not above zero.

    Examples
    --------
    >>> cast_rays(World(), [(0, 0, 0)], [0.0]).tolist()
    [[inf]]
    """
    check_type(world, World, "world must be a World, as in cast_rays(world, poses, angles)")
    angles = np.asarray(angles, dtype=float)
    steps = np.diff(angles) if angles.ndim == 1 and np.isfinite(angles).all() else np.array([-1.0])
    if not ((steps > 0).all() and steps.sum() < 2 * np.pi):
        raise ValueError("angles must be finite and increase within one turn of 2 pi")
    if not range_max > 0:
        raise ValueError(f"range_max must be a number > 0, got {range_max:g}")
    return cast(world, as_poses(poses), angles, range_max)[0]


def cast(
    world: World, poses: Floats, angles: Floats, range_max: float = np.inf, range_min: float = 0.0
) -> tuple[Floats, Bools]:
    """Return the exact distances, shape (P, B), and which poses lie in a shape, shape (P,).

    A beam whose nearest hit lies outside the limits, both included, reads ``inf``.
    """
    ranges = np.empty((len(poses), len(angles)))
    inside = np.zeros(len(poses), dtype=bool)
    scene, fan, reach = _scene(world), _Fan(angles), range_max + ROUNDING
    for block in _blocks(len(poses), len(world.shapes)):
        here, table = poses[block], ranges[block]
        table[...] = 0.0
        _cast_polygons(scene, here, fan, reach, table, inside[block])
        _cast_circles(scene, here, fan, reach, table, inside[block])
        table[inside[block]] = 0.0
        with np.errstate(divide="ignore"):
            np.divide(1.0, table, out=table)
        out = (table > reach) | (table < range_min - ROUNDING)
        np.clip(table, range_min, range_max, out=table)  # 1 / (1 / t) may pass a limit by the last bit
        table[out] = np.inf
    return ranges, inside


def _blocks(n_poses: int, n_shapes: int) -> Iterator[slice]:
    """Cut the poses into blocks that keep the tables of pairs small."""
    step = max(64, PAIRS_PER_BLOCK // max(4, min(n_shapes, INDEX_FROM)))
    return (slice(start, start + step) for start in range(0, n_poses, step))


class _Fan:
    """The beams of one scan: which of them lie in an interval of bearings, and their directions."""

    def __init__(self, angles: Floats) -> None:
        self.size = len(angles)
        self.start = float(angles[0]) if len(angles) else 0.0
        self.twice = np.concatenate([angles, angles + 2 * np.pi]) - self.start  # an interval may pass the seam
        self.cos, self.sin = np.tile(np.cos(angles), 2), np.tile(np.sin(angles), 2)

    def between(self, first: Floats, width: Floats) -> tuple[Ints, Ints]:
        """Return each (interval, beam) with the beam in the interval: two index arrays.

        K intervals of bearings begin at ``first`` and are ``width`` wide, shape (K,), radians, counter-clockwise.
        Beams are counted twice round: beam ``i + B`` is beam ``i`` past the seam.
        """
        begin = np.mod(first - self.start - CORNER_HIT, 2 * np.pi)
        low = np.searchsorted(self.twice, begin, side="left")
        high = np.searchsorted(self.twice, begin + (width + 2 * CORNER_HIT), side="right")
        count = high - low
        interval = np.repeat(np.arange(len(count)), count)
        earlier = np.cumsum(count) - count  # beams of all intervals before this one
        return interval, np.arange(len(interval)) + (low - earlier)[interval]

    def keep_nearest(self, table: Floats, pose: Ints, beam: Ints, closeness: Floats) -> None:
        """Enter hits into the table of closeness, shape (P, B), where they are nearer than what is there."""
        beam = np.where(beam >= self.size, beam - self.size, beam)
        np.maximum.at(table.reshape(-1), pose * self.size + beam, closeness)


class _Scene:
    """A world's shapes as arrays, and the index that finds those near a position."""

    def __init__(self, world: World) -> None:
        polygons = [s for s in world.shapes if isinstance(s, Polygon)]
        circles = [s for s in world.shapes if isinstance(s, Circle)]
        # Triangles and rectangles repeat their last corner: a side without length faces nobody.
        self.corners = np.array([np.pad(p.vertices, ((0, 5 - len(p.vertices)), (0, 0)), "edge") for p in polygons])
        self.corners = self.corners.reshape(-1, 5, 2)
        middle = (self.corners.min(axis=1) + self.corners.max(axis=1)) / 2
        reach = np.linalg.norm(self.corners - middle[:, None], axis=2).max(axis=1, initial=0.0)
        self.radii = np.array([c.radius for c in circles])
        self.polygons = _Near(middle, reach)
        self.circles = _Near(np.array([c.center for c in circles]).reshape(-1, 2), self.radii)


@lru_cache(maxsize=16)
def _scene(world: World) -> _Scene:
    """Return the world's arrays; kept, because a driving robot asks for them ten times a second."""
    return _Scene(world)


class _Near:
    """Finds the shapes that are near enough to be seen, by the circle around each."""

    def __init__(self, centers: Floats, reaches: Floats) -> None:
        import shapely

        self.centers, self.reaches = centers, reaches
        self.tree = shapely.STRtree(shapely.points(centers)) if len(centers) >= INDEX_FROM else None

    def pairs(self, positions: Floats, range_max: float) -> tuple[Ints, Ints]:
        """Return each (position, shape) with the shape in range: two index arrays."""
        import shapely

        if self.tree is not None and np.isfinite(range_max):
            farthest = range_max + float(self.reaches.max())
            found = self.tree.query(shapely.points(positions), predicate="dwithin", distance=farthest)
            return found[0], found[1]
        dx = positions[:, :1] - self.centers[:, 0]
        dy = positions[:, 1:] - self.centers[:, 1]
        pose, shape = np.nonzero(dx * dx + dy * dy <= (self.reaches + range_max) ** 2)
        return pose, shape


def _to_robot_frame(points: Floats, here: Floats) -> tuple[Floats, Floats]:
    """Return x and y of world points, shape (K, M, 2), as seen from K poses, shape (K, 3): (K, M) each."""
    x = points[..., 0] - here[:, :1]
    y = points[..., 1] - here[:, 1:2]
    c, s = np.cos(here[:, 2:]), np.sin(here[:, 2:])
    return c * x + s * y, c * y - s * x


def _cast_polygons(scene: _Scene, here: Floats, fan: _Fan, range_max: float, table: Floats, inside: Bools) -> None:
    """Enter the closeness of all polygons' hits into ``table``, and the poses that lie in one into ``inside``."""
    pose, shape = scene.polygons.pairs(here[:, :2], range_max)
    if len(pose) == 0:
        return
    x, y = _to_robot_frame(scene.corners[shape], here[pose])  # (K, 5) each
    next_x, next_y = np.roll(x, -1, axis=1), np.roll(y, -1, axis=1)
    cross = x * next_y - y * next_x  # twice the area robot-corner-corner: negative when the side faces us
    inside[pose[(cross >= 0).all(axis=1)]] = True

    # 1. The sides that face the robot and have their line in range; a and b are their ends.
    dx, dy = next_x - x, next_y - y
    facing = (cross < 0) & ((cross / range_max) ** 2 <= dx * dx + dy * dy)
    ax, ay, bx, by, dx, dy, area = (v[facing] for v in (x, y, next_x, next_y, dx, dy, cross))
    pose = pose[np.nonzero(facing)[0]]

    # 2. The beams between the two ends; b is met first, going counter-clockwise.
    width = np.arctan2(-area, ax * bx + ay * by)
    side, beam = fan.between(np.arctan2(by, bx), width)

    # 3. Where each beam crosses the line: t (u x d) = a x d = area, so 1/t = u x (d / area). A beam along the side
    #    has both at 0 up to rounding, and their quotient anywhere: the hit is held between the side's two ends,
    #    or below the farther one where the side's nearest point lies between them.
    a_square, b_square = ax * ax + ay * ay, bx * bx + by * by
    least = 1 / np.sqrt(np.maximum(a_square, b_square))
    abreast = (ax * dx + ay * dy < 0) & (bx * dx + by * dy > 0)
    most = np.where(abreast, np.inf, 1 / np.sqrt(np.minimum(a_square, b_square)))
    closeness = fan.cos[beam] * (dy / area)[side] - fan.sin[beam] * (dx / area)[side]
    fan.keep_nearest(table, pose[side], beam, np.clip(closeness, least[side], most[side]))


def _cast_circles(scene: _Scene, here: Floats, fan: _Fan, range_max: float, table: Floats, inside: Bools) -> None:
    """Enter the closeness of all circles' hits into ``table``, and the poses that lie in one into ``inside``."""
    pose, shape = scene.circles.pairs(here[:, :2], range_max)
    if len(pose) == 0:
        return
    x, y = (v[:, 0] for v in _to_robot_frame(scene.circles.centers[shape][:, None], here[pose]))
    r, distance = scene.radii[shape], np.hypot(x, y)
    outside = distance > r
    inside[pose[~outside]] = True
    pose, x, y, r, distance = pose[outside], x[outside], y[outside], r[outside], distance[outside]

    # 1. The beams between the two tangents.
    half = np.arcsin(r / distance)
    circle, beam = fan.between(np.arctan2(y, x) - half, 2 * half)

    # 2. |t u - c| = r, solved for the nearer t: with p = u . c and q = u x c, t = p - sqrt(r^2 - q^2). Its inverse
    #    is (p + sqrt(r^2 - q^2)) / (d^2 - r^2), which loses no digits when the two are close.
    cos, sin, cx, cy = fan.cos[beam], fan.sin[beam], x[circle], y[circle]
    along, aside = cos * cx + sin * cy, cos * cy - sin * cx
    depth = np.sqrt(np.maximum((r * r)[circle] - aside * aside, 0.0))
    power = (distance - r) * (distance + r)
    fan.keep_nearest(table, pose[circle], beam, (along + depth) * (1 / power)[circle])
