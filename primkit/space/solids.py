"""Solids: spheres, cylinders and boxes, and how a beam meets them.

In:  numbers in metres; beams: where they start and unit vectors along them, world frame, z up.
Out: frozen solids; for each beam the range at which it meets the surface, inf where it never does.

>>> ball = Sphere((2, 0, 0), 0.5)
>>> hit(ball, (0, 0, 0), [(1, 0, 0), (0, 1, 0)]).tolist()
[1.5, inf]

All that an estimator needs of a solid is four verbs:

    chord      where a beam enters and leaves it; ``hit`` is the first of both in front of the beam's start
    distance   how far a point lies outside, or, as a number below zero, inside of the part that is nearest to it
    speeds     the outward normal n at a point x, and how fast x moves along it when a number q grows: n . dx/dq
    moved      the solid after a step of its numbers

so a range t along a beam d changes by dt/dq = (n . dx/dq) / (n . d). The numbers, in the solid's own frame (its axes
are the rows of ``frame``): sphere x, y, z, radius; cylinder across (2), tilt (2), radius, low and high end; box turn
(3), three low faces, three high ones. Angles in radians, all others in metres.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import ArrayLike

from ..arguments import Floats, as_floats, as_point, as_points, as_positive

SolidKind = Literal["sphere", "cylinder", "box"]
Chord = tuple[Floats, Floats]  # the ranges at which beams enter and leave, shape (N,) each

UNIT = 1e-6  # directions that are longer or shorter than 1 by more are a mistake


@dataclass(frozen=True, eq=False)
class Plane:
    """All points p with ``normal . p = offset``: a unit vector, shape (3,), and metres."""

    normal: Floats
    offset: float

    def __init__(self, normal: ArrayLike, offset: float) -> None:
        vars(self).update(normal=as_direction(normal, "normal"), offset=float(offset))

    def signed_distance(self, points: ArrayLike) -> Floats:
        """Return how far points lie on the normal's side, shape (N,), metres."""
        return as_points(points, d=3) @ self.normal - self.offset

    def hit(self, origins: Floats, directions: Floats) -> Floats:
        """Return the ranges at which beams meet the plane, shape (N,), metres; inf where they never do."""
        with np.errstate(divide="ignore", invalid="ignore"):
            t = (self.offset - np.asarray(origins) @ self.normal) / (directions @ self.normal)
        return np.where(t > 0, t, np.inf)


@dataclass(frozen=True, eq=False)
class Sphere:
    """A ball: its centre, shape (3,), and its radius, metres."""

    center: Floats
    radius: float
    kind: ClassVar[SolidKind] = "sphere"
    numbers: ClassVar[int] = 4

    def __init__(self, center: ArrayLike, radius: float) -> None:
        vars(self).update(center=as_point(center, "center", 3), radius=as_positive(radius, "radius"))

    @property
    def frame(self) -> Floats:
        """The world's own axes, shape (3, 3)."""
        return np.eye(3)

    @property
    def half(self) -> Floats:
        """Half the extents in its own frame, shape (3,), metres."""
        return np.full(3, self.radius)

    def reach(self, direction: Floats) -> float:
        """Return how far it goes from its centre along a unit vector, metres."""
        return self.radius

    def chord(self, origins: ArrayLike, directions: ArrayLike) -> Chord:
        """Return the ranges at which beams enter and leave, metres; NaN where they pass by."""
        o, d = _local(self, origins, directions)
        along = (o * d).sum(axis=1)
        off = o - along[:, None] * d
        with np.errstate(invalid="ignore"):
            half = np.sqrt(self.radius**2 - (off**2).sum(axis=1))
        return -along - half, -along + half

    def distance(self, points: Floats) -> Floats:
        """Return how far points lie outside, shape (N,), metres."""
        return np.linalg.norm(points - self.center, axis=1) - self.radius

    def speeds(self, points: Floats) -> tuple[Floats, Floats]:
        """Return the normals, shape (N, 3), and the speeds of the numbers, shape (N, 4)."""
        normals = _unit(points - self.center)
        return normals, np.column_stack([normals, np.ones(len(normals))])

    def moved(self, step: Floats) -> Sphere:
        """Return the sphere after a step of its numbers, shape (4,)."""
        return Sphere(self.center + step[:3], self.radius + step[3])


@dataclass(frozen=True, eq=False)
class Cylinder:
    """A cylinder with both its caps: the middle of its axis, the axis (either way), radius and height, metres."""

    center: Floats
    axis: Floats
    radius: float
    height: float
    frame: Floats
    kind: ClassVar[SolidKind] = "cylinder"
    numbers: ClassVar[int] = 7

    def __init__(self, center: ArrayLike, axis: ArrayLike, radius: float, height: float) -> None:
        axis = as_direction(axis, "axis")
        vars(self).update(center=as_point(center, "center", 3), axis=axis, radius=as_positive(radius, "radius"))
        vars(self).update(height=as_positive(height, "height"), frame=frame_of(axis))

    @property
    def half(self) -> Floats:
        """Half the extents in its own frame, shape (3,), metres."""
        return np.array([self.radius, self.radius, self.height / 2])

    def reach(self, direction: Floats) -> float:
        """Return how far it goes from its middle along a unit vector, metres."""
        x, y, z = self.frame @ direction
        return float(self.height / 2 * abs(z) + self.radius * np.hypot(x, y))

    def chord(self, origins: ArrayLike, directions: ArrayLike) -> Chord:
        """Return the ranges at which beams enter and leave, metres; a beam that passes by leaves first, or is NaN."""
        o, d = _local(self, origins, directions)
        across = d[:, 0] ** 2 + d[:, 1] ** 2
        with np.errstate(divide="ignore", invalid="ignore"):
            along = -(o[:, 0] * d[:, 0] + o[:, 1] * d[:, 1]) / across
            lever = o[:, 0] * d[:, 1] - o[:, 1] * d[:, 0]
            half = np.sqrt(self.radius**2 - lever**2 / across) / np.sqrt(across)
        straight = (across == 0) & (o[:, 0] ** 2 + o[:, 1] ** 2 <= self.radius**2)  # along the axis, within
        enters, leaves = np.where(straight, -np.inf, along - half), np.where(straight, np.inf, along + half)
        low, high = between(o[:, 2], d[:, 2], -self.height / 2, self.height / 2)
        return np.maximum(enters, low), np.minimum(leaves, high)

    def distance(self, points: Floats) -> Floats:
        """Return how far points lie outside the part that they are most outside of, shape (N,), metres."""
        return self._outside((points - self.center) @ self.frame.T).max(axis=0)

    def _outside(self, x: Floats) -> Floats:
        """Return how far points in its frame lie outside its side, its low and its high end, shape (3, N)."""
        return np.array(
            [np.hypot(x[:, 0], x[:, 1]) - self.radius, -x[:, 2] - self.height / 2, x[:, 2] - self.height / 2]
        )

    def speeds(self, points: Floats) -> tuple[Floats, Floats]:
        """Return the normals, shape (N, 3), and the speeds of the numbers, shape (N, 7)."""
        x = (points - self.center) @ self.frame.T
        side, low, high = np.arange(3)[:, None] == self._outside(x).argmax(axis=0)
        n = _unit(x * [1, 1, 0]) * side[:, None]
        n[:, 2] = high * 1.0 - low
        tilts = n[:, :2] * x[:, 2:] - n[:, 2:] * x[:, :2]
        return n @ self.frame, np.column_stack([n[:, :2], tilts, side, -1.0 * low, high])

    def moved(self, step: Floats) -> Cylinder:
        """Return the cylinder after a step of its numbers, shape (7,)."""
        u, v, w = self.frame
        center = self.center + step[0] * u + step[1] * v + (step[5] + step[6]) / 2 * w
        return Cylinder(center, w + step[2] * u + step[3] * v, self.radius + step[4], self.height + step[6] - step[5])


@dataclass(frozen=True, eq=False)
class Box:
    """A box: its centre, its three axes as the rows of ``frame``, and its size along each, metres."""

    center: Floats
    frame: Floats
    size: Floats
    kind: ClassVar[SolidKind] = "box"
    numbers: ClassVar[int] = 9

    def __init__(self, center: ArrayLike, frame: ArrayLike, size: ArrayLike) -> None:
        sides = [as_positive(side, "size") for side in as_point(size, "size", 3).tolist()]
        vars(self).update(center=as_point(center, "center", 3), frame=_as_frame(frame), size=np.array(sides))

    @property
    def half(self) -> Floats:
        """Half the extents in its own frame, shape (3,), metres."""
        return self.size / 2

    def reach(self, direction: Floats) -> float:
        """Return how far it goes from its centre along a unit vector, metres."""
        return float(np.abs(self.frame @ direction) @ self.half)

    def chord(self, origins: ArrayLike, directions: ArrayLike) -> Chord:
        """Return the ranges at which beams enter and leave, metres; a beam that passes by leaves first."""
        o, d = _local(self, origins, directions)
        low, high = between(o, d, -self.half, self.half)
        return low.max(axis=1), high.min(axis=1)

    def distance(self, points: Floats) -> Floats:
        """Return how far points lie outside the face that they are most outside of, shape (N,), metres."""
        return (np.abs((points - self.center) @ self.frame.T) - self.half).max(axis=1)

    def speeds(self, points: Floats) -> tuple[Floats, Floats]:
        """Return the normals, shape (N, 3), and the speeds of the numbers, shape (N, 9)."""
        x = (points - self.center) @ self.frame.T
        axis = (np.abs(x) - self.half).argmax(axis=1)
        n = np.eye(3)[axis] * np.sign(x[np.arange(len(x)), axis])[:, None]
        return n @ self.frame, np.hstack([np.cross(x, n), np.minimum(n, 0), np.maximum(n, 0)])

    def moved(self, step: Floats) -> Box:
        """Return the box after a step of its numbers, shape (9,)."""
        low, high = step[3:6], step[6:9]
        turned = turn(step[:3]) @ self.frame
        return Box(self.center + (low + high) / 2 @ self.frame, turned, self.size + high - low)


Solid = Sphere | Cylinder | Box


def hit(solid: Solid, origins: ArrayLike, directions: ArrayLike) -> Floats:
    """Return the ranges at which beams meet a solid, shape (N,), metres; from inside, those at which they leave it.

    Origins, shape (3,) or (N, 3), metres, and directions, unit vectors, shape (N, 3); inf where a beam never meets it.
    """
    return first_of(*solid.chord(origins, directions))


def first_of(enters: Floats, leaves: Floats) -> Floats:
    """Return the first crossing in front of the start; inf where there is none."""
    with np.errstate(invalid="ignore"):
        return np.where((enters <= leaves) & (leaves > 0), np.where(enters > 0, enters, leaves), np.inf)


def between(o: Floats, d: Floats, low: Floats | float, high: Floats | float) -> Chord:
    """Return when o + t d comes to lie between two bounds, and when it ceases to."""
    with np.errstate(divide="ignore", invalid="ignore"):
        to_low, to_high = (low - o) / d, (high - o) / d
    always = (d == 0) & (low <= o) & (o <= high)  # also in a bound itself, where 0 / 0 tells nothing
    return (
        np.where(always, -np.inf, np.minimum(to_low, to_high)),
        np.where(always, np.inf, np.maximum(to_low, to_high)),
    )


def frame_of(axis: Floats) -> Floats:
    """Return a frame, its rows unit vectors, whose third row is this axis.

    >>> frame_of(np.array([0.0, 0.0, 1.0])).tolist() == [[0, 1, 0], [-1, 0, 0], [0, 0, 1]]
    True
    """
    x, y, z = axis
    u = np.array([0.0, z, -y] if abs(x) < 0.6 else [-z, 0.0, x])
    u /= np.sqrt(u @ u)
    (a, b, c) = u
    return np.array([u, [y * c - z * b, z * a - x * c, x * b - y * a], axis])


def turn(by: Floats) -> Floats:
    """Return what turns the rows of a frame by a small vector in that frame, shape (3,), radians (Rodrigues)."""
    angle = float(np.linalg.norm(by))
    x, y, z = by / max(angle, np.finfo(float).tiny)
    k = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return (np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k).T


def as_direction(direction: ArrayLike, name: str) -> Floats:
    """Return a unit vector along a direction, shape (3,), or say in one sentence that it is none.

    >>> as_direction((0, 0, 2), "axis").tolist()
    [0.0, 0.0, 1.0]
    >>> as_direction((0, 0, 0), "axis")
    Traceback (most recent call last):
        ...
    ValueError: axis must be longer than 0, got [0.0, 0.0, 0.0]
    """
    vector = as_point(direction, name, 3)
    length = float(np.linalg.norm(vector))
    if length == 0:
        raise ValueError(f"{name} must be longer than 0, got {vector.tolist()}")
    return vector / length


def _as_frame(frame: ArrayLike) -> Floats:
    rows = as_floats(frame, "frame", "(3, 3)")
    if rows.shape != (3, 3) or not np.abs(rows @ rows.T - np.eye(3)).max() <= UNIT:
        raise ValueError(f"frame must be three unit vectors at right angles, got {rows.tolist()}")
    return rows


def _local(solid: Solid, origins: ArrayLike, directions: ArrayLike) -> tuple[Floats, Floats]:
    """Return beams in the solid's own frame, each shape (N, 3)."""
    d = np.asarray(directions, dtype=float)
    o = np.asarray(origins, dtype=float) - solid.center
    d, o = (d, o) if solid.kind == "sphere" else (d @ solid.frame.T, o @ solid.frame.T)
    return np.broadcast_to(o, d.shape), d


def _unit(vectors: Floats) -> Floats:
    return vectors / np.maximum(np.sqrt((vectors**2).sum(axis=1)), np.finfo(float).tiny)[:, None]
