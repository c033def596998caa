"""A pipe of known radius: its centre, from hits on its near side.

In:  the student's ``pipe_center``.
Out: marks.

>>> PIPE_CENTER.mark(known_radius)
4.0
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

import primkit as pk

from ..parts import TURN, Fault, numbers, shown, task

Floats = NDArray[np.float64]

CASES = 40  # random ones, in each part
EVEN = 0.25  # radii that one of two hits may be farther away than the other


def known_radius(points: Floats, radius: float) -> Floats | None:
    """Return the centre with the least squared gaps to a circle of this radius, on the far side of the points."""
    if len(np.unique(points, axis=0)) < 2:
        return None
    return np.round(gauss_newton(points, radius, beyond(points, radius)), 12) + 0.0  # 0 instead of 1e-18


def beyond(points: Floats, radius: float) -> Floats:
    """Return a first guess: a radius farther out than the points."""
    middle = points.mean(axis=0)
    return middle * (1 + radius / np.hypot(*middle))


def gauss_newton(points: Floats, radius: float, center: Floats) -> Floats:
    """Return the centre that a guess leads to."""
    for _ in range(100):
        away = points - center
        distance = np.hypot(*away.T)
        step = np.linalg.lstsq(-away / distance[:, None], radius - distance, rcond=None)[0]
        length = np.hypot(*step)
        center = center + step * min(1.0, radius / 2 / max(length, 1e-15))
        if length < 1e-12:
            break
    return center


def judge_center(got: Any, expected: Any, _args: tuple[Any, ...]) -> str | None:
    """Judge a centre, within half a millimetre."""
    if expected is None or got is None:
        return None if got is expected else f"got {shown(got)}, expected {shown(expected)}"
    place = numbers(got, 2)
    if place is None or not np.isfinite(place).all():
        return f"got {shown(got)}, expected the centre: two numbers in metres"
    off = float(np.hypot(*(np.array(place) - expected)))
    return None if off <= 0.0005 else f"the centre is off by {1000 * off:.2g} mm"


def pipe(rng: np.random.Generator, degrees: tuple[float, float], noise: float) -> tuple[Floats, float]:
    """Return hits on the near side of a pipe, a stretch of it that need not be the nearest, and its radius."""
    radius, away, bearing = rng.uniform(0.04, 0.12), rng.uniform(0.2, 0.5), rng.uniform(0, TURN)
    arc = np.radians(rng.uniform(*degrees))
    seen = np.arccos(radius / (away + radius))  # half of what is in view, from the centre
    first = rng.uniform(-seen, max(-seen, seen - arc))
    turns = bearing + np.pi + np.linspace(first, min(first + arc, seen), int(rng.integers(15, 50)))
    out = radius + noise * rng.standard_normal(len(turns))
    center = (away + radius) * np.array([np.cos(bearing), np.sin(bearing)])
    return center + out[:, None] * np.column_stack([np.cos(turns), np.sin(turns)]), float(radius)


def exact_arcs(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield exact arcs."""
    yield np.array([(0.2, 0.0), (0.3, 0.1), (0.3, -0.1)]), 0.1
    for _ in range(CASES):
        yield pipe(rng, (25, 120), 0.0)


def noisy_arcs(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield short noisy arcs."""
    for _ in range(CASES):
        yield pipe(rng, (25, 60), 0.001)


def few_hits(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield two points, which is enough, and fewer, which is not.

    The two lie about as far from the robot: only then is the far one of both circles plainly the pipe.
    """
    yield np.array([(0.3, -0.06), (0.3, 0.06)]), 0.1
    yield np.array([(0.3, 0.1)]), 0.1
    yield np.array([(0.3, 0.1)] * 3), 0.1
    yield np.zeros((0, 2)), 0.1
    n = 0
    while n < 10:
        points, radius = pipe(rng, (80, 120), 0.0)
        if abs(np.subtract(*np.hypot(*points[[0, -1]].T))) < EVEN * radius:
            n += 1
            yield points[[0, -1]], radius


def with_fit(method: str) -> Any:
    """Fit centre and radius, and return the centre."""

    def center(points: Floats, _radius: float) -> Any:
        circle = pk.fit_circle(points, method)
        return None if circle is None else circle.center

    return center


def nearer_center(points: Floats, radius: float) -> Any:
    """Return the centre on the robot's side."""
    middle = points.mean(axis=0)
    if len(np.unique(points, axis=0)) < 2:
        return None
    return gauss_newton(points, radius, middle * (1 - radius / np.hypot(*middle)))


def behind_mean(points: Floats, radius: float) -> Any:
    """Go on from the mean of the points by a radius, away from the robot."""
    return beyond(points, radius) if len(np.unique(points, axis=0)) > 1 else None


def behind_nearest(points: Floats, radius: float) -> Any:
    """Go on from the nearest hit by a radius."""
    if len(np.unique(points, axis=0)) < 2:
        return None
    nearest = points[np.argmin(np.hypot(*points.T))]
    return nearest * (1 + radius / np.hypot(*nearest))


PIPE_CENTER = task(
    "pipe_center",
    known_radius,
    judge_center,
    (
        ("exact arcs", 1, exact_arcs),
        ("short, noisy arcs", 2, noisy_arcs),
        ("two hits, and too few", 1, few_hits),
    ),
    (
        Fault(
            "Three numbers came back: the centre alone is asked for.",
            when=lambda cases: all(numbers(case.got, 3) is not None for case in cases if case.expected is not None),
            name="a whole circle",
        ),
        Fault(
            "On short arcs a fit of centre and radius is unsure of both. You know the radius: do you use it?",
            like=with_fit("geometric"),
            name="radius not used",
        ),
        Fault(
            "On short arcs a fit of centre and radius is unsure of both. You know the radius: do you use it?",
            like=with_fit("kasa"),
            name="radius not used",
        ),
        Fault(
            "Two circles of this radius pass close to the points. On which side of its near wall does a pipe go on?",
            like=nearer_center,
            name="centre on the robot's side",
        ),
        Fault(
            "The mean of points on an arc does not lie on the arc, nor in the middle of the pipe's near side.",
            like=behind_mean,
            name="a radius beyond the mean",
        ),
        Fault(
            "The nearest hit is only one of many, and need not be the pipe's nearest place.",
            like=behind_nearest,
            name="a radius beyond the nearest hit",
        ),
        Fault(
            "Fewer than two different points fix no centre: that is None.",
            when=lambda cases: all(case.expected is None and case.got is not None for case in cases if case.off),
            name="a centre from one point",
        ),
    ),
)
