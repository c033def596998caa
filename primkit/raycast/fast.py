"""Fast: every side about its beams.

In:  a ``World``, poses, shape (P, 3): x [m], y [m], heading [rad], and the beams' bearings, shape (B,).
Out: distances, shape (P, B), metres; infinity where a beam meets nothing.

The plain way asks every beam of every pose about every side, and nearly all answers are no. Turn the question round:
ask a side, once for each pose, which beams it stops. It answers with an interval of bearings; beams are evenly spread,
so that their numbers follow by a division (``fan.py``), and only they are computed.

A side, as seen by the robot R. F is the foot of the perpendicular on the side's line, at the distance h::

         left               s        F          right
      ----+-----------------+--------+------------+----     s grows to the left, s = 0 at F
                             .       |
                              t   phi|h
                               .     |
                                 .   |
                                   . R

    A point of the line at s is seen at the bearing phi = arctan(s / h), counted from F on, and is
    t = sqrt(h^2 + s^2) away. So:
    1. h and the s of both ends follow from a cross and a dot product. h > 0: the side faces the robot.
       A robot that no side of a convex polygon faces is inside; of another polygon, the crossings of a ray tell it.
       Sides that face away need no look: coming from outside, a beam enters a polygon before it leaves it.
    2. The part of the side in range ends at s = +-sqrt(range^2 - h^2) at the latest.
    3. The bearings of the two ends of that part say which beams hit it: no other beam is looked at.
    4. Each of these beams meets the line at s = h tan(phi). Along a side seen edge-on, h is 0 and tan(phi) infinite,
       up to rounding: s is held between the ends.

A circle of radius r with its centre at the distance d stops the beams between its two tangents, which are
sqrt(d^2 - r^2) long; or up to where the range ends, if that is less. Robot, centre and this last point in sight, at the
distance q, make a triangle: the beams lie within arccos((d^2 + q^2 - r^2) / (2 d q)) of the centre's bearing. At phi
from it, the near side of the circle is d cos(phi) less half a chord away, and a chord is 2 sqrt(r^2 - (d sin(phi))^2).

A wall is a polygon of one side: beyond it all is solid. Last, a beam keeps the nearest of its hits.

Legend: a pair is one pose with one shape near enough to be seen from it (``near.py``); "toward" is the bearing of F, or
of the circle's centre, from the robot's heading, and phi a beam's bearing from there.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from ..arguments import ROUNDING, Bools, Floats, Ints, as_poses, check_type, limit
from ..shapes import Circle, Polygon
from ..world import World
from .fan import CORNER_HIT, TURN, Fan
from .near import Near

Hits = tuple[Ints, Floats, Ints]  # where in the table of ranges, how far; and the poses that lie in a shape

# Poses are cast in blocks of at most so many pairs (of polygons with five sides) and beams: some MB, which stay in the
# cache, and which the system does not take back between two blocks.
PAIRS_PER_BLOCK, BEAMS_PER_BLOCK = 16_384, 200_000
MOST_RANGES = 100_000_000  # at once: 800 MB
# From a robot on a side, in line with it, rounding could turn a beam past the quarter turn, where the tangent changes
# its sign: it would hit the side's other end. So no beam of a side is nearer to the quarter turn than this [rad].
EDGE_ON = 2 * CORNER_HIT


def cast_rays(world: World, poses: ArrayLike, angles: ArrayLike, range_max: float = np.inf) -> Floats:
    """Return the exact distance from each pose along each beam to the first outline, shape (P, B), metres.

    ``inf`` where a beam meets nothing, and everywhere from a pose inside a shape. Raises ValueError if poses are not
    (P, 3), angles do not increase within one turn, or range_max is not above zero.

    Parameters
    ----------
    world : World
    poses : array_like, shape (P, 3): x [m], y [m], heading [rad], world frame
    angles : array_like, shape (B,): bearings from the heading in radians, increasing, within one turn
    range_max : float, metres: outlines farther off are not looked at

    Examples
    --------
    >>> cast_rays(World(), [(0, 0, 0)], [0.0]).tolist()
    [[inf]]
    """
    check_type(world, World, "world must be a World, as in cast_rays(world, poses, angles)")
    angles = np.asarray(angles, dtype=float)
    steps = np.diff(angles) if angles.ndim == 1 and np.isfinite(angles).all() else np.array([-1.0])
    if not ((steps > 0).all() and steps.sum() < TURN):
        raise ValueError("angles must be finite and increase within one turn of 2 pi")
    if not range_max > 0:
        raise ValueError(f"range_max must be a number > 0, got {range_max:g}")
    poses = as_poses(poses)
    return cast(world, poses, angles, range_max)[0] if len(angles) else np.empty((len(poses), 0))


def cast(
    world: World, poses: Floats, angles: Floats, range_max: float = np.inf, range_min: float = 0.0
) -> tuple[Floats, Bools]:
    """Return the exact distances, shape (P, B), and which poses lie in a shape, shape (P,); at least one beam.

    A beam whose nearest hit lies outside the limits, both included, reads ``inf``.
    """
    limit(
        len(poses) * len(angles), MOST_RANGES, "a scan must have at most {} ranges", "scan_blocks takes a few at once"
    )
    scene, fan = _scene(world, float(range_max) + ROUNDING), _fan(angles.tobytes())
    ranges, inside = np.empty((len(poses), fan.size)), np.zeros(len(poses), dtype=bool)
    step = max(1, min(PAIRS_PER_BLOCK // max(1, scene.most), BEAMS_PER_BLOCK // fan.size))
    for start in range(0, len(poses), step):
        block = slice(start, start + step)
        for within in _cast_block(scene, fan, poses[block], ranges[block], (range_min, range_max)):
            inside[start + within] = True
    ranges[inside] = np.inf
    return ranges, inside


def _cast_block(scene: _Scene, fan: Fan, poses: Floats, ranges: Floats, limits: tuple[float, float]) -> list[Ints]:
    """Fill in the ranges, shape (P, B), and return the poses that lie in a shape."""
    x, y, heading = poses.T.copy()
    heading -= TURN * np.floor(heading / TURN)  # many turns would cost digits
    pose, shape = scene.pairs(x, y)
    polygons, circles = (shape >= scene.n_circles).nonzero()[0], (shape < scene.n_circles).nonzero()[0]
    nearest, hidden, inside = ranges.reshape(-1), [], []
    nearest.fill(np.inf)
    for pair, hits_on in ((polygons, _hits_on_sides), (circles, _hits_on_circles)):
        if len(pair):
            place, t, within = hits_on(scene, fan, (x, y, heading), pose.take(pair), shape.take(pair))
            hidden.append(place.compress(t < limits[0] - ROUNDING))  # what is too near hides what is behind it
            np.minimum.at(nearest, place, np.minimum(np.maximum(t, limits[0], out=t), limits[1], out=t))
            inside.append(within)
    for place in hidden:
        nearest[place] = np.inf
    return inside


def _hits_on_sides(scene: _Scene, fan: Fan, here: tuple[Floats, ...], pose: Ints, shape: Ints) -> Hits:
    """Return all hits on K pairs' polygons, with S sides in all; the steps are those of the module's derivation."""
    (x, y, heading), polygon = here, shape - scene.n_circles
    # 1. The sides that face the robot: their right ends, and the ways d to their left ends, shape (S,).
    n_sides = scene.n_sides.take(polygon).astype(np.intp, copy=False)
    begin = n_sides.cumsum() - n_sides
    own, side = np.repeat(pose, n_sides), np.repeat(scene.first.take(polygon) - begin, n_sides)
    side += np.arange(len(side))
    right_x, right_y = scene.right_x.take(side) - x.take(own), scene.right_y.take(side) - y.take(own)
    dx, dy, length = scene.way_x.take(side), scene.way_y.take(side), scene.length.take(side)
    h = (right_x * dy - right_y * dx) / length
    within = np.maximum.reduceat(h, begin) <= 0
    if scene.any_dented:
        dented, left_y = scene.dented.take(polygon), scene.left_y.take(side) - y.take(own)
        along = right_x * dx + right_y * dy
        on_it = (h == 0) & (along <= 0) & (along + length * length >= 0)
        crossed = ((right_y > 0) != (left_y > 0)) & ((h > 0) == (dy > 0))  # by a ray from the robot along x
        odd = np.logical_xor.reduceat(crossed, begin) | np.logical_or.reduceat(on_it, begin)
        within = np.where(dented, odd, within)

    # 2. The part of each that is in range.
    seen = ((h > 0) & (h <= scene.reach)).nonzero()[0]
    right = ((right_x * dx + right_y * dy) / length).take(seen)
    own, side, h, length = own.take(seen), side.take(seen), h.take(seen), length.take(seen)
    half = np.sqrt(scene.reach * scene.reach - h * h)
    left, right = np.minimum(right + length, half), np.maximum(right, -half)

    # 3. The beams that hit it.
    toward, off = scene.inward.take(side) - heading.take(own), np.maximum(h, EDGE_ON * length)
    hit, beam = fan.between(toward + np.arctan2(right, off), toward + np.arctan2(left, off))

    # 4. Where, and how far that is.
    phi, h = fan.angles.take(beam) - toward.take(hit), h.take(hit)
    s = h * np.tan(phi)
    s = np.minimum(np.maximum(s, right.take(hit), out=s), left.take(hit), out=s)
    return (fan.size * own).take(hit) + beam, np.sqrt(h * h + s * s), pose.compress(within)


def _hits_on_circles(scene: _Scene, fan: Fan, here: tuple[Floats, ...], pose: Ints, shape: Ints) -> Hits:
    """Return all hits on K pairs' circles."""
    x, y, heading = here
    cx, cy, r = (v.take(shape) for v in (scene.center_x, scene.center_y, scene.radii))
    cx, cy = cx - x.take(pose), cy - y.take(pose)
    d = np.sqrt(cx * cx + cy * cy)
    within, outside = pose.compress(d <= r), (d > r).nonzero()[0]
    pose, cx, cy, r, d = (v.take(outside) for v in (pose, cx, cy, r, d))

    # 1. The beams between the two tangents, as far as they are in range.
    power = (d - r) * (d + r)  # the tangents' length, squared: d^2 - r^2 without loss
    q = np.minimum(np.sqrt(power), scene.reach)
    half = np.arccos(np.minimum((power + q * q) / (2 * d * q), 1.0))
    toward = np.arctan2(cy, cx) - heading.take(pose)
    hit, beam = fan.between(toward - half, toward + half)

    # 2. Where, and how far that is. With c for half a chord, along - c = (along^2 - c^2) / (along + c), and the
    #    quotient loses no digits when the two are close; along^2 - c^2 is the power.
    phi, d, r = fan.angles.take(beam) - toward.take(hit), d.take(hit), r.take(hit)
    along, aside = d * np.cos(phi), d * np.sin(phi)
    t = power.take(hit) / (along + np.sqrt(np.maximum(r * r - aside * aside, 0.0)))
    return (fan.size * pose).take(hit) + beam, t, within


class _Scene:
    """A world as arrays: its circles, the sides of its polygons and walls, and which of them are near."""

    def __init__(self, world: World, reach: float) -> None:
        polygons = [s for s in world.shapes if isinstance(s, Polygon)]
        circles = [s for s in world.shapes if isinstance(s, Circle)]
        self.reach, self.n_circles, self.walls, self.half = reach, len(circles), len(world.walls), world.size / 2
        # Corners are counter-clockwise: from outside, each side goes from its left end to its right end.
        rings = [p.vertices for p in polygons]
        left = np.vstack([np.empty((0, 2)), *rings, world.walls[:, 1]])
        right = np.vstack([np.empty((0, 2)), *(np.roll(ring, -1, axis=0) for ring in rings), world.walls[:, 0]])
        self.n_sides = np.array([*map(len, rings), *(1 for _ in world.walls)], dtype=np.int64)
        self.first = self.n_sides.cumsum() - self.n_sides
        self.right_x, self.right_y = right.T.copy()
        self.way_x, self.way_y = (left - right).T.copy()
        self.left_y = left[:, 1].copy()
        self.dented = np.array([*((p.turns < 0).any() for p in polygons), *(False for _ in world.walls)], dtype=bool)
        self.any_dented = bool(self.dented.any())
        self.length = np.sqrt(self.way_x**2 + self.way_y**2)
        self.inward = np.arctan2(-self.way_x, self.way_y)  # the bearing of F from any robot that the side faces
        self.radii = np.array([c.radius for c in circles])
        self.center_x, self.center_y = np.array([c.center for c in circles]).reshape(-1, 2).T.copy()
        middle = np.array([(ring.min(axis=0) + ring.max(axis=0)) / 2 for ring in rings]).reshape(-1, 2)
        around = [np.hypot(*(ring - m).T).max() for ring, m in zip(rings, middle, strict=True)]
        x, y = np.append(self.center_x, middle[:, 0]), np.append(self.center_y, middle[:, 1])
        self.near = Near(x, y, np.append(self.radii, around), reach)
        self.most = (self.near.most + self.walls) * max(5, self.n_sides.max(initial=0)) // 5

    def pairs(self, x: Floats, y: Floats) -> tuple[Ints, Ints]:
        """Return each (position, shape) with the shape in range; the walls count after the shapes."""
        position, shape = self.near.pairs(x, y)
        if not self.walls:
            return position, shape
        away = self.half + np.stack([y, -x, -y, x])
        wall, seer = (away <= self.reach).nonzero()
        return np.append(position, seer), np.append(shape, len(self.near.x) + wall)


@lru_cache(maxsize=16)
def _scene(world: World, reach: float) -> _Scene:
    """Return the world's arrays; kept, because a driving robot asks for them ten times a second."""
    return _Scene(world, reach)


@lru_cache(maxsize=16)
def _fan(angles: bytes) -> Fan:
    """Return the fan of beams with these angles; kept for the same reason."""
    return Fan(np.frombuffer(angles))
