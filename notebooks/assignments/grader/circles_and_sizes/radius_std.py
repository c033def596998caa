"""How sure is a radius: its standard deviation, from the bearings of the points and their noise.

In:  the student's ``radius_std``.
Out: marks.

>>> RADIUS_STD.mark(spread_of_radius)
4.0
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..parts import INF, TURN, Fault, numbers, shown, task

Floats = NDArray[np.float64]

CASES = 40  # random ones, in each part


def spread_of_radius(bearings: Floats, noise: float) -> float:
    """Return the standard deviation of a fitted radius, metres; inf where the bearings fix no circle."""
    return float(np.sqrt(covariance(bearings, noise)[2, 2])) if fixes_circle(bearings) else INF


def slopes(bearings: Floats) -> Floats:
    """Return how each gap grows when centre x, centre y and radius do, shape (N, 3); but for the sign."""
    return np.column_stack([np.cos(bearings), np.sin(bearings), np.ones_like(bearings)])


def covariance(bearings: Floats, noise: float) -> Floats:
    """Return the covariance of centre and radius, shape (3, 3), square metres."""
    J = slopes(bearings)
    return noise**2 * np.linalg.inv(J.T @ J)


def fixes_circle(bearings: Floats) -> bool:
    """Tell whether the points fix centre and radius."""
    return len(bearings) > 2 and np.linalg.matrix_rank(slopes(bearings), tol=1e-9) == 3


def judge_std(got: Any, expected: Any, _args: tuple[Any, ...]) -> str | None:
    """Judge a standard deviation within a tenth, so that a simulation will do as well."""
    value = numbers([got], 1) if isinstance(got, (float, int, np.floating)) else None
    if value is None:
        return f"got {shown(got)}, expected a number such as {shown(expected)} m"
    if value[0] == expected or abs(value[0] - expected) <= 0.1 * expected < INF:
        return None
    return f"got {shown(1000 * value[0])} mm, expected {shown(1000 * expected)} mm"


def arc(rng: np.random.Generator, degrees: tuple[float, float]) -> tuple[Floats, float]:
    """Return evenly spread bearings and a noise."""
    turn = np.radians(rng.uniform(*degrees))
    n = int(rng.integers(20, 120))
    return rng.uniform(0, TURN) + turn * (np.arange(n) + 0.5) / n, float(rng.choice([0.001, 0.002, 0.005]))


def full_circles(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield points all around."""
    yield TURN * np.arange(100) / 100, 0.002
    for _ in range(CASES // 2):
        yield arc(rng, (360, 360))


def short_arcs(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield arcs from 30 to 200 degrees."""
    yield np.radians(np.arange(-30, 31)), 0.002
    for _ in range(CASES // 2):
        yield arc(rng, (30, 200))


def too_few(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield bearings that fix no circle, and three that just do."""
    yield np.array([0.0, 1.0]), 0.001
    yield np.array([0.5, 0.5, 0.5, 2.0]), 0.001
    yield np.zeros(0), 0.001
    yield np.array([0.0, 2.0, 4.0]), 0.001


RADIUS_STD = task(
    "radius_std",
    spread_of_radius,
    judge_std,
    (
        ("points all around", 1, full_circles),
        ("short arcs", 2, short_arcs),
        ("too few bearings, and just enough", 1, too_few),
    ),
    (
        Fault(
            "Right where the centre is known. On a short arc, moving the centre looks like changing the radius.",
            like=lambda bearings, noise: noise / np.sqrt(len(bearings)) if fixes_circle(bearings) else INF,
            name="centre taken for known",
        ),
        Fault(
            "That is the variance: which power of a length is asked for?",
            like=lambda bearings, noise: spread_of_radius(bearings, noise) ** 2,
            name="variance for standard deviation",
        ),
        Fault(
            "That is the spread of one point. Many points together know the radius better.",
            like=lambda bearings, noise: noise if fixes_circle(bearings) else INF,
            name="spread of one point",
        ),
        Fault(
            "That is the spread of the centre: which row of the matrix belongs to the radius?",
            like=lambda bearings, noise: (
                float(np.sqrt(covariance(bearings, noise)[0, 0])) if fixes_circle(bearings) else INF
            ),
            name="centre for radius",
        ),
        Fault(
            "Where too few bearings fix no circle, nothing is known about the radius: that is inf.",
            when=lambda cases: all(case.expected == INF for case in cases if case.off),
            name="sure of what is not fixed",
        ),
    ),
)
