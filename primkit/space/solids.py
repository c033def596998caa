"""Solids: spheres, cylinders and boxes, and how a beam meets them.

In:  numbers in metres; beams: where they start and unit vectors along them, world frame, z up.
Out: frozen solids; for each beam the range at which it meets the surface, inf where it never does.

>>> ball = Sphere((2, 0, 0), 0.5)
>>> hit(ball, (0, 0, 0), [(1, 0, 0), (0, 1, 0)]).tolist()
[1.5, inf]

Every solid is a product of balls: a sphere is a ball of all three axes of its frame, a cylinder a disc of two of them
times an interval of the third, a box three intervals. A point lies within it when it lies within each of its parts. So
what an estimator needs of a solid is written once, for all kinds, part by part:

    chord      where a beam enters and leaves it; ``hit`` is the first of both in front of the beam's start
    distance   how far a point lies outside of the part that it is most outside of; below zero, inside
    speeds     the outward normal n at a point x, and how fast x moves along it when a number q grows: n . dx/dq
    moved      the solid after a step of its numbers

so a range t along a beam d changes by dt/dq = (n . dx/dq) / (n . d). The numbers, in the solid's own frame (its axes
are the rows of ``frame``): turns about axes (a cylinder two, a box three, radians); a ball's or disc's shift along each
of its axes, and its radius; the low ends of the intervals, and their high ends; metres.
"""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import ArrayLike

from ..arguments import ROUNDING, Floats, as_floats, as_point, as_points, as_positive

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


@dataclass(frozen=True, eq=False, repr=False)
class Solid:
    """A sphere, cylinder or box: a ball of the first axes of its frame, times an interval of each other one.

    Its centre, shape (3,), its frame, the axes as rows, shape (3, 3), and half its extents along them, shape (3,),
    metres.
    """

    center: Floats
    frame: Floats
    half: Floats
    kind: ClassVar[SolidKind]
    given: ClassVar[tuple[str, ...]]  # what it is made of, by name
    called: ClassVar[tuple[str, ...]]  # its sizes: the radius of the ball, the lengths of the intervals
    ball: ClassVar[int]  # axes of the ball
    turns: ClassVar[int]  # numbers that turn it
    first_end: ClassVar[int]  # of its numbers: the ends of the intervals are the last
    numbers: ClassVar[int]

    @property
    def sizes(self) -> dict[str, float]:
        """The radius; radius and height; or length, width and height along the rows of ``frame``; metres."""
        each = np.append(self.half[: self.ball > 0], 2 * self.half[self.ball :])
        return dict(zip(self.called, each.tolist(), strict=True))

    @property
    def slopes(self) -> dict[str, Floats]:
        """How each size grows with each number, shape (numbers,)."""
        e = np.eye(self.numbers)
        low, high = np.split(e[self.first_end :], 2)
        radius = e[self.first_end - (self.ball > 0) : self.first_end]
        return dict(zip(self.called, np.vstack([radius, high - low]), strict=True))

    @property
    def radii(self) -> Floats:
        """The radius of the ball, and half of each interval, metres."""
        return self.half[max(0, self.ball - 1) :]

    @property
    def around(self) -> float:
        """The radius of a ball around its centre that holds it, metres."""
        return float(np.linalg.norm(self.radii))

    def reach(self, direction: Floats) -> float:
        """Return how far it goes from its centre along a unit vector, metres."""
        return float(self._lengths((self.frame @ direction * self.half)[:, None]).sum())

    def chord(self, origins: ArrayLike, directions: ArrayLike) -> Chord:
        """Return the ranges at which beams enter and leave, metres; a beam that passes by leaves first, or is NaN."""
        o = self.frame @ np.atleast_2d(np.asarray(origins, dtype=float) - self.center).T
        d, m, r = self.frame @ np.asarray(directions, dtype=float).T, self.ball, self.half[0]
        enters, leaves = np.full((2, d.shape[1]), [[-np.inf], [np.inf]])
        with np.errstate(divide="ignore", invalid="ignore"):
            if m:
                across = (d[:m] ** 2).sum(axis=0)
                along = -(o[:m] * d[:m]).sum(axis=0) / across
                to_rim = np.sqrt((r**2 - ((o[:m] + along * d[:m]) ** 2).sum(axis=0)) / across)
                straight = (across == 0) & ((o[:m] ** 2).sum(axis=0) <= r**2)  # along the axis, within
                enters, leaves = np.where(straight, enters, along - to_rim), np.where(straight, leaves, along + to_rim)
            for ok, dk, half in zip(o[m:], d[m:], self.half[m:], strict=True):
                # Along a bound itself, 0 / 0 is NaN, and stands for always.
                to_low, to_high = (-half - ok) / dk, (half - ok) / dk
                enters = np.maximum(enters, np.fmax(np.minimum(to_low, to_high), -np.inf))
                leaves = np.minimum(leaves, np.fmin(np.maximum(to_low, to_high), np.inf))
        return enters, leaves

    def distance(self, points: Floats) -> Floats:
        """Return how far points lie outside the part that they are most outside of, shape (N,), metres."""
        return self._outside(self.frame @ (points - self.center).T).max(axis=0)

    def speeds(self, points: Floats) -> tuple[Floats, Floats]:
        """Return the normals, shape (N, 3), and the speeds of the numbers, shape (N, numbers)."""
        x, m = self.frame @ (points - self.center).T, self.ball
        outside = self._outside(x)
        own = np.arange(len(outside))[:, None] == outside.argmax(axis=0)  # the part whose surface is met
        n = np.sign(x)
        n[m:] *= own[m > 0 :]
        if m:
            n[:m] = x[:m] * (own[0] / np.maximum(self._lengths(x)[0], TINY))
        turns = (x[[1, 2, 0]] * n[[2, 0, 1]] - x[[2, 0, 1]] * n[[1, 2, 0]])[: self.turns]
        ball = np.vstack([n[:m], own[: m > 0]])
        return n.T @ self.frame, np.vstack([turns, ball, np.minimum(n[m:], 0), np.maximum(n[m:], 0)]).T

    def moved(self, step: Floats) -> Solid:
        """Return the solid after a step of its numbers, shape (numbers,)."""
        m, half, by = self.ball, self.half.copy(), np.zeros(3)
        low, high = step[self.first_end :].reshape(2, -1)
        half[:m] += step[self.first_end - 1]
        half[m:] += (high - low) / 2
        shift = np.append(step[self.turns : self.turns + m], (low + high) / 2)
        by[: self.turns] = step[: self.turns]
        frame = turn(by) @ self.frame if self.turns else self.frame
        return altered(self, center=self.center + shift @ self.frame, frame=frame, half=half)

    def _lengths(self, x: Floats) -> Floats:
        """Return how long vectors in its frame, shape (3, N), are in the ball's axes, and in each interval's."""
        m = self.ball
        return np.vstack([np.sqrt((x[:m] ** 2).sum(axis=0)), np.abs(x[m:])]) if m else np.abs(x)

    def _outside(self, x: Floats) -> Floats:
        """Return how far points in its frame, shape (3, N), lie outside of each part."""
        return self._lengths(x) - self.radii[:, None]

    def __repr__(self) -> str:
        made = ", ".join(f"{name}={np.round(getattr(self, name), 3).tolist()}" for name in self.given)
        return f"{type(self).__name__}({made})"


class Sphere(Solid):
    """A ball: its centre, shape (3,), and its radius, metres."""

    kind, given, called = "sphere", ("center", "radius"), ("radius",)
    ball, turns, first_end, numbers = 3, 0, 4, 4

    def __init__(self, center: ArrayLike, radius: float) -> None:
        super().__init__(as_point(center, "center", 3), np.eye(3), np.full(3, as_positive(radius, "radius")))

    @property
    def radius(self) -> float:
        """Its radius, metres."""
        return float(self.half[0])


class Cylinder(Solid):
    """A cylinder with both its caps: the middle of its axis, the axis (either way), radius and height, metres."""

    kind, given, called = "cylinder", ("center", "axis", "radius", "height"), ("radius", "height")
    ball, turns, first_end, numbers = 2, 2, 5, 7

    def __init__(self, center: ArrayLike, axis: ArrayLike, radius: float, height: float) -> None:
        radius, height = as_positive(radius, "radius"), as_positive(height, "height")
        half = np.array([radius, radius, height / 2])
        super().__init__(as_point(center, "center", 3), frame_of(as_direction(axis, "axis")), half)

    @property
    def axis(self) -> Floats:
        """The unit vector along its axis, shape (3,)."""
        return self.frame[2]

    @property
    def radius(self) -> float:
        """Its radius, metres."""
        return float(self.half[0])

    @property
    def height(self) -> float:
        """From cap to cap, metres."""
        return float(2 * self.half[2])


class Box(Solid):
    """A box: its centre, its three axes as the rows of ``frame``, and its size along each, metres."""

    kind, given, called = "box", ("center", "frame", "size"), ("length", "width", "height")
    ball, turns, first_end, numbers = 0, 3, 3, 9

    def __init__(self, center: ArrayLike, frame: ArrayLike, size: ArrayLike) -> None:
        rows = as_floats(frame, "frame", "(3, 3)")
        if rows.shape != (3, 3) or not np.abs(rows @ rows.T - np.eye(3)).max() <= UNIT:
            raise ValueError(f"frame must be three unit vectors at right angles, got {rows.tolist()}")
        sides = [as_positive(side, "size") for side in as_point(size, "size", 3).tolist()]
        super().__init__(as_point(center, "center", 3), rows, np.array(sides) / 2)

    @property
    def size(self) -> Floats:
        """Its extents along the rows of ``frame``, shape (3,), metres."""
        return 2 * self.half


def altered(solid: Solid, **numbers: Floats) -> Solid:
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


def frame_of(axis: Floats) -> Floats:
    """Return a frame, its rows unit vectors, whose third row is this axis.

    >>> frame_of(np.array([0.0, 0.0, 1.0])).tolist() == [[0, 1, 0], [-1, 0, 0], [0, 0, 1]]
    True
    """
    x, y, z = axis
    u = np.array([0.0, z, -y] if abs(x) < 0.6 else [-z, 0.0, x])
    u /= np.sqrt(u @ u)
    return np.array([u, np.cross(axis, u), axis])


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
    return vector if abs(length - 1) < ROUNDING else vector / length  # so that what was written is read back
