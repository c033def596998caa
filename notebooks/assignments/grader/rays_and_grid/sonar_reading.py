"""A sonar with a wide cone: the nearest echo in it, within the sensor's limits.

In:  the student's ``sonar_reading``.
Out: marks.

>>> SONAR_READING.mark(nearest_echo)
4.0
"""

# ruff: noqa: ARG005 (a wrong way may leave out what it is given)

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from primkit.checks.judges import number

from ..parts import EDGE, INF, TURN, Fault, task

Floats = NDArray[np.float64]

CASES = 60  # random ones, in each part


def nearest_echo(ranges: Floats, angles: Floats, axis: float, cone: float, range_min: float, range_max: float) -> float:
    """Return the nearest range in the cone that lies within the sensor's limits, metres; inf without one."""
    heard = (aside(angles, axis) <= cone / 2) & (ranges >= range_min) & (ranges <= range_max)
    return float(ranges[heard].min(initial=INF))


def aside(angles: Floats, axis: float) -> Floats:
    """Return how far each bearing is from the axis, radians from 0 to pi."""
    return np.abs((angles - axis + np.pi) % TURN - np.pi)


def sonar_like(in_cone: Any = lambda angles, axis, cone: aside(angles, axis) <= cone / 2, read: Any = None) -> Any:
    """Return a wrong way: another cone, or another reading of the ranges in it."""

    def reading(ranges: Floats, angles: Floats, axis: float, cone: float, range_min: float, range_max: float) -> float:
        mine = ranges[in_cone(angles, axis, cone)]
        if read is not None:
            return float(read(mine, range_min, range_max))
        return float(mine[(mine >= range_min) & (mine <= range_max)].min(initial=INF))

    return reading


def nearest_or_none(mine: Floats, low: float, high: float) -> float:
    """Take the nearest first, and drop it when it is out of the limits."""
    nearest = np.nanmin(mine, initial=INF)
    return nearest if low <= nearest <= high else INF


def cut_to_limits(mine: Floats, low: float, high: float) -> float:
    """Take the nearest first, and cut it to the limits."""
    nearest = np.nanmin(mine, initial=INF)
    return float(np.clip(nearest, low, high)) if nearest < INF else INF


def mean_echo(mine: Floats, low: float, high: float) -> float:
    """Return the mean of what is within the limits."""
    kept = mine[(mine >= low) & (mine <= high)]
    return kept.mean() if len(kept) else INF


def fans(rng: np.random.Generator, axes: tuple[float, float], fill: Any) -> Iterator[tuple[Any, ...]]:
    """Yield fans of ranges and cones; ``fill(rng, in the cone)`` gives the ranges, the limits are 0.05 and 0.3 m."""
    n = 0
    while n < CASES:
        beams = int(rng.integers(24, 72))
        angles = TURN * np.arange(beams) / beams
        axis, cone = float(rng.uniform(*axes)) % TURN, float(rng.uniform(0.3, 1.2))
        if np.abs(aside(angles, axis) - cone / 2).min() > EDGE:
            n += 1
            yield fill(rng, aside(angles, axis) <= cone / 2), angles, axis, cone, 0.05, 0.3


def within_limits(rng: np.random.Generator, cone: Any) -> Floats:
    """Return ranges within the limits, as a rule nearer outside the cone."""
    return np.where(cone, rng.uniform(0.15, 0.3, len(cone)), rng.uniform(0.06, 0.3, len(cone)))


def with_near_and_far(rng: np.random.Generator, cone: Any) -> Floats:
    """Return ranges of which many in the cone are too near or too far."""
    ranges = np.where(rng.random(len(cone)) < 0.4, rng.uniform(0.01, 0.049, len(cone)), within_limits(rng, cone))
    return np.where(rng.random(len(cone)) < 0.4, rng.uniform(0.31, 0.9, len(cone)), ranges)


def with_losses(rng: np.random.Generator, cone: Any) -> Floats:
    """Return ranges of which many are lost (nan) or meet nothing (inf); now and then all in the cone."""
    lost = rng.random(len(cone)) < rng.choice([0.3, 1.0])
    return np.where(lost & cone, rng.choice([np.nan, INF], len(cone)), within_limits(rng, cone))


FOUR = np.array([0.0, 0.5, 1.0, 1.5]) * np.pi


def plain_cones(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield cones that do not hold bearing 0."""
    yield np.array([0.1, 0.2, 0.15, 0.12]), FOUR, np.pi / 2, 1.0, 0.05, 0.3
    yield from fans(rng, (1.3, 5.0), within_limits)


def cones_ahead(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield cones that look along bearing 0, from both sides of it."""
    yield np.array([0.25, 0.1, 0.1, 0.2]), FOUR, 0.1, 3.6, 0.05, 0.3
    yield from fans(rng, (-0.14, 0.14), within_limits)


def near_and_far(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield cones with things that are too near, and too far."""
    yield np.array([0.1, 0.02, 0.25, 0.6]), FOUR, np.pi, 4.0, 0.05, 0.3
    yield from fans(rng, (1.3, 5.0), with_near_and_far)


def lost_and_empty(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield cones with lost echoes, with nothing in range, or without a beam."""
    yield np.array([0.1, np.nan, 0.25, INF]), FOUR, np.pi, 4.0, 0.05, 0.3
    yield np.array([0.1, 0.1, 0.1, 0.1]), FOUR, np.pi / 4, 0.2, 0.05, 0.3  # between two beams
    yield from fans(rng, (1.3, 5.0), with_losses)


SONAR_READING = task(
    "sonar_reading",
    nearest_echo,
    number("m"),
    (
        ("the nearest echo in the cone", 1, plain_cones),
        ("cones that look across bearing 0", 1, cones_ahead),
        ("echoes that are too near or too far", 1, near_and_far),
        ("lost echoes and empty cones", 1, lost_and_empty),
    ),
    (
        Fault(
            "That is the least echo from all around. Which of these bearings lie in the cone?",
            like=sonar_like(lambda angles, axis, cone: np.ones(len(angles), dtype=bool)),
            name="cone left out",
        ),
        Fault(
            "The cone's width counts from edge to edge: how far is it from the axis to one edge?",
            like=sonar_like(lambda angles, axis, cone: aside(angles, axis) <= cone),
            name="whole cone to each side",
        ),
        Fault(
            "A bearing just below a full turn is near bearing 0: the plain difference does not know that.",
            like=sonar_like(lambda angles, axis, cone: np.abs(angles - axis) <= cone / 2),
            name="bearing not wrapped",
        ),
        Fault(
            "Something too near is not heard at all, and so cannot hide what is heard behind it.",
            like=sonar_like(read=nearest_or_none),
            name="too near hides the rest",
        ),
        Fault(
            "An echo outside the limits is not heard; cutting it to a limit reports a thing that is not there.",
            like=sonar_like(read=cut_to_limits),
            name="cut to the limits",
        ),
        Fault(
            "Things nearer than range_min are reported: the sonar is still deaf then.",
            like=sonar_like(read=lambda mine, low, high: mine[mine <= high].min(initial=INF)),
            name="no range_min",
        ),
        Fault(
            "Things beyond range_max are reported.",
            like=sonar_like(read=lambda mine, low, high: mine[mine >= low].min(initial=INF)),
            name="no range_max",
        ),
        Fault("The sonar reports the first echo, not the mean of all.", like=sonar_like(read=mean_echo), name="mean"),
        Fault(
            "Some readings are nan: a lost echo is no echo. (nan is neither below nor above any number.)",
            when=lambda cases: any(isinstance(case.got, float) and np.isnan(case.got) for case in cases),
            name="nan spreads",
        ),
    ),
)
