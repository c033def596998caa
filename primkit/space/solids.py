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

from copy import copy
from dataclasses import dataclass
from typing import ClassVar, Literal, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from ..arguments import Floats, as_floats, as_point, as_points, as_positive

SolidKind = Literal["sphere", "cylinder", "box"]
Chord = tuple[Floats, Floats]  # the ranges at which beams enter and leave, shape (N,) each

UNIT = 1e-6  # directions that are longer or shorter than 1 by more are a mistake
TINY = np.finfo(float).tiny  # so that nothing is divided by zero


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
        along = (o * d).sum(axis=0)
        with np.errstate(invalid="ignore"):
            half = np.sqrt(self.radius**2 - ((o - along * d) ** 2).sum(axis=0))
        return -along - half, -along + half

    def distance(self, points: Floats) -> Floats:
        """Return how far points lie outside, shape (N,), metres."""
        return np.linalg.norm(points - self.center, axis=1) - self.radius

    def speeds(self, points: Floats) -> tuple[Floats, Floats]:
        """Return the normals, shape (N, 3), and the speeds of the numbers, shape (N, 4)."""
        x = points - self.center
        normals = x / np.maximum(np.linalg.norm(x, axis=1), TINY)[:, None]
        return normals, np.column_stack([normals, np.ones(len(normals))])

    def moved(self, step: Floats) -> Sphere:
        """Return the sphere after a step of its numbers, shape (4,)."""
        return altered(self, center=self.center + step[:3], radius=self.radius + step[3])


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
        across = d[0] ** 2 + d[1] ** 2
        with np.errstate(divide="ignore", invalid="ignore"):
            along = -(o[0] * d[0] + o[1] * d[1]) / across
            half = np.sqrt(self.radius**2 - (o[0] * d[1] - o[1] * d[0]) ** 2 / across) / np.sqrt(across)
        straight = (across == 0) & (o[0] ** 2 + o[1] ** 2 <= self.radius**2)  # along the axis, within
        enters, leaves = np.where(straight, -np.inf, along - half), np.where(straight, np.inf, along + half)
        low, high = between(o[2], d[2], -self.height / 2, self.height / 2)
        return np.maximum(enters, low), np.minimum(leaves, high)

    def distance(self, points: Floats) -> Floats:
        """Return how far points lie outside the part that they are most outside of, shape (N,), metres."""
        return self._outside(self.frame @ (points - self.center).T).max(axis=0)

    def _outside(self, x: Floats) -> Floats:
        """Return how far points in its frame, shape (3, N), lie outside its side, its low and its high end."""
        return np.array([np.hypot(x[0], x[1]) - self.radius, -x[2] - self.height / 2, x[2] - self.height / 2])

    def speeds(self, points: Floats) -> tuple[Floats, Floats]:
        """Return the normals, shape (N, 3), and the speeds of the numbers, shape (N, 7)."""
        x = self.frame @ (points - self.center).T
        side, low, high = np.arange(3)[:, None] == self._outside(x).argmax(axis=0)
        n = np.array([*x[:2] * (side / np.maximum(np.hypot(x[0], x[1]), TINY)), high * 1.0 - low])
        tilts = n[:2] * x[2] - n[2] * x[:2]
        return n.T @ self.frame, np.vstack([n[:2], tilts, side, -1.0 * low, high]).T

    def moved(self, step: Floats) -> Cylinder:
        """Return the cylinder after a step of its numbers, shape (7,)."""
        u, v, w = self.frame
        center = self.center + step[0] * u + step[1] * v + (step[5] + step[6]) / 2 * w
        axis = w + step[2] * u + step[3] * v
        axis /= np.sqrt(axis @ axis)
        height = self.height + step[6] - step[5]
        return altered(
            self, center=center, axis=axis, frame=frame_of(axis), radius=self.radius + step[4], height=height
        )


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
        low, high = between(o, d, -self.half[:, None], self.half[:, None])
        return low.max(axis=0), high.min(axis=0)

    def distance(self, points: Floats) -> Floats:
        """Return how far points lie outside the face that they are most outside of, shape (N,), metres."""
        return (np.abs(self.frame @ (points - self.center).T) - self.half[:, None]).max(axis=0)

    def speeds(self, points: Floats) -> tuple[Floats, Floats]:
        """Return the normals, shape (N, 3), and the speeds of the numbers, shape (N, 9)."""
        x = self.frame @ (points - self.center).T
        n = np.sign(x) * (np.arange(3)[:, None] == (np.abs(x) - self.half[:, None]).argmax(axis=0))
        turns = x[[1, 2, 0]] * n[[2, 0, 1]] - x[[2, 0, 1]] * n[[1, 2, 0]]
        return n.T @ self.frame, np.vstack([turns, np.minimum(n, 0), np.maximum(n, 0)]).T

    def moved(self, step: Floats) -> Box:
        """Return the box after a step of its numbers, shape (9,)."""
        low, high = step[3:6], step[6:9]
        center = self.center + (low + high) / 2 @ self.frame
        return altered(self, center=center, frame=turn(step[:3]) @ self.frame, size=self.size + high - low)


Solid = Sphere | Cylinder | Box
S = TypeVar("S", bound=Solid)


def altered(solid: S, **numbers: Floats | float) -> S:
    """Return the solid with other numbers. They are not checked: who takes a step sees how far it leads."""
    other = copy(solid)
    vars(other).update(numbers)
    return other


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
    # Along a bound itself, 0 / 0 is NaN, and stands for always.
    return np.fmax(np.minimum(to_low, to_high), -np.inf), np.fmin(np.maximum(to_low, to_high), np.inf)


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
    x, y, z = by / max(angle, TINY)
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
    """Return beams in the solid's own frame, an axis a row: shape (3, N), or (3, 1) of a single origin, and (3, N)."""
    o = np.atleast_2d(np.asarray(origins, dtype=float) - solid.center)
    return solid.frame @ o.T, solid.frame @ np.asarray(directions, dtype=float).T
