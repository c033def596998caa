"""Plain: every beam about every side, one after the other.

The ray caster as one would write it first. It is thousands of times slower than ``fast.py``, and its oracle: tests
hold the two against each other on random boards.

In:  a ``World``, poses, shape (P, 3): x [m], y [m], heading [rad], and the beams' bearings, shape (B,).
Out: distances, shape (P, B), metres; infinity where a beam meets nothing.

>>> cast_plainly(World([Circle((1, 0), 0.25)], size=3), [(0, 0, 0)], [0.0, np.pi / 2]).tolist()
[[0.75, inf]]

Legend: u is a beam's direction, of length 1; t the distance to a hit; a a side's first corner and d the way to its
second, c a circle's centre and r its radius, all as seen from the robot. ``u x d`` is the cross product
``ux dy - uy dx``.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import cos, inf, sin, sqrt

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..shapes import Circle, Shape
from ..world import World


def cast_plainly(world: World, poses: ArrayLike, angles: ArrayLike, range_max: float = inf) -> NDArray[np.float64]:
    """Return what ``cast_rays`` returns for the same arguments, up to rounding; angles may come in any order."""
    poses, angles = np.reshape(poses, (-1, 3)), np.asarray(angles, dtype=float)
    ranges = np.full((len(poses), len(angles)), inf)
    for i, (x, y, heading) in enumerate(poses.tolist()):
        beyond = len(world.walls) > 0 and max(abs(x), abs(y)) >= world.size / 2
        if beyond or any(shape.signed_distance([(x, y)])[0] <= 0 for shape in world.shapes):
            continue
        for j, angle in enumerate(angles.tolist()):
            ux, uy = cos(heading + angle), sin(heading + angle)
            wall = _to_sides(world.walls.tolist(), x, y, ux, uy)
            nearest = min([wall, *(_distance_along(shape, x, y, ux, uy) for shape in world.shapes)])
            ranges[i, j] = nearest if nearest <= range_max else inf
    return ranges


def _distance_along(shape: Shape, x: float, y: float, ux: float, uy: float) -> float:
    """Return the distance from a point outside a shape to its outline, along u; infinity when u misses it."""
    if isinstance(shape, Circle):
        return _to_circle(shape, x, y, ux, uy)
    corners = shape.vertices.tolist()
    return _to_sides(zip(corners, corners[1:] + corners[:1], strict=True), x, y, ux, uy)


def _to_sides(sides: Iterable[Sequence[Sequence[float]]], x: float, y: float, ux: float, uy: float) -> float:
    """Solve ``t u = a + s d`` for each side: crossed with d it gives t, crossed with u it gives s."""
    nearest = inf
    for (first_x, first_y), (last_x, last_y) in sides:
        ax, ay, dx, dy = first_x - x, first_y - y, last_x - first_x, last_y - first_y
        across = ux * dy - uy * dx
        if across != 0:  # else the beam runs beside the side
            t = (ax * dy - ay * dx) / across
            s = (ax * uy - ay * ux) / across
            if t >= 0 and 0 <= s <= 1:
                nearest = min(nearest, t)
    return nearest


def _to_circle(circle: Circle, x: float, y: float, ux: float, uy: float) -> float:
    """Solve ``|t u - c| = r`` for the nearer t: the way to abreast of the centre, less half a chord."""
    cx, cy = circle.center[0] - x, circle.center[1] - y
    along, aside = ux * cx + uy * cy, ux * cy - uy * cx
    if along < 0 or abs(aside) > circle.radius:
        return inf
    return float(along - sqrt(circle.radius**2 - aside**2))
