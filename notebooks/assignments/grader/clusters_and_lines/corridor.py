"""A corridor of two parallel walls: its bearing and its width.

In:  the student's ``corridor``.
Out: marks.

>>> CORRIDOR.mark(common_bearing)
4.0
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..parts import Fault, numbers, shown, task, turn_between

Floats = NDArray[np.float64]


def common_bearing(left: Floats, right: Floats) -> tuple[float, float]:
    """Return bearing along both walls and width: least squares of the distances across, one normal for both."""
    scatter = np.vstack([left - left.mean(axis=0), right - right.mean(axis=0)])
    x, y = np.linalg.svd(scatter, full_matrices=False)[2][0]
    return across(float(np.arctan2(y, x)), left, right)


def across(bearing: float, left: Floats, right: Floats) -> tuple[float, float]:
    """Return the bearing, and the distance of the walls' means square to it."""
    x, y = right.mean(axis=0) - left.mean(axis=0)
    return bearing, abs(float(-np.sin(bearing) * x + np.cos(bearing) * y))


def along(points: Floats) -> float:
    """Return the bearing along one wall."""
    return float(np.arctan2(*np.linalg.svd(points - points.mean(axis=0), full_matrices=False)[2][0][::-1]))


def mean_of_two(left: Floats, right: Floats) -> tuple[float, float]:
    """Fit each wall alone and take the mean bearing, with due regard to half turns."""
    doubled = np.exp(2j * along(left)) + np.exp(2j * along(right))
    return across(float(np.angle(doubled)) / 2, left, right)


def plain_mean_of_two(left: Floats, right: Floats) -> tuple[float, float]:
    """Fit each wall alone and add the two bearings, whichever way they point."""
    slopes = [np.arctan(np.tan(along(wall))) for wall in (left, right)]
    return across(float(np.mean(slopes)), left, right)


def with_slopes(left: Floats, right: Floats) -> tuple[float, float]:
    """Make the errors in y small: y = slope x + height, one slope."""
    x, y = np.vstack([left - left.mean(axis=0), right - right.mean(axis=0)]).T
    return across(float(np.arctan2((x * y).sum(), (x * x).sum())), left, right)


def one_line_for_both(left: Floats, right: Floats) -> tuple[float, float]:
    """Fit one line to all points."""
    return across(along(np.vstack([left, right])), left, right)


def between_means(left: Floats, right: Floats) -> tuple[float, float]:
    """Take the distance of the means for the width."""
    return common_bearing(left, right)[0], float(np.hypot(*(right.mean(axis=0) - left.mean(axis=0))))


def longer_alone(left: Floats, right: Floats) -> tuple[float, float]:
    """Fit the wall with more points alone."""
    return across(along(max(left, right, key=len)), left, right)


def judge_corridor(got: Any, expected: Any, _args: tuple[Any, ...]) -> str | None:
    """Judge bearing, up to half a turn, and width, within 1e-5."""
    pair = numbers(got, 2)
    if pair is None or not np.isfinite(pair).all():
        return f"got {shown(got)}, expected (bearing, width)"
    turned = turn_between(pair[0], expected[0], np.pi)
    if abs(turned) > 1e-5:
        return f"the bearing is off by {np.degrees(turned):.2g} degrees"
    off = pair[1] - expected[1]
    return None if abs(off) <= 1e-5 else f"the bearing is right, the width is off by {1000 * off:+.2g} mm"


def walls(rng: np.random.Generator, bearing: float, stretches: Any, counts: Any, noise: float) -> tuple[Floats, Floats]:
    """Return the points of two parallel walls, each from one place to another along it, with noise across."""
    u, n = np.array([np.cos(bearing), np.sin(bearing)]), np.array([-np.sin(bearing), np.cos(bearing)])
    middle, half = rng.uniform(-0.3, 0.3, 2), rng.uniform(0.1, 0.3)
    pair = []
    for side, (begin, end), count in zip((half, -half), stretches, counts, strict=True):
        out = side + noise * rng.standard_normal(count)
        pair.append(middle + np.multiply.outer(np.linspace(begin, end, count), u) + np.multiply.outer(out, n))
    return pair[0], pair[1]


BEARINGS = (0.0, 0.5, 1.2, 1.57, 2.0, np.pi - 0.01)  # exactly upright, rounding alone decides what a slope is


def opposite(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield exact walls of the same length that stand opposite each other, at all bearings."""
    yield np.array([(0.0, 0.3), (1.0, 0.3)]), np.array([(0.0, -0.1), (1.0, -0.1)])
    for bearing in (*BEARINGS, *rng.uniform(0, np.pi, 20)):
        yield walls(rng, bearing, [(-0.5, 0.5)] * 2, (20, 20), 0.0)


def displaced(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield exact walls of which different stretches are seen."""
    yield np.array([(0.0, 0.3), (1.0, 0.3)]), np.array([(2.0, -0.1), (3.0, -0.1)])
    for bearing in (*BEARINGS, *rng.uniform(0, np.pi, 20)):
        yield walls(rng, bearing, [(-0.5, 0.4), (0.6, 0.9)], (20, 7), 0.0)


def noisy_and_short(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield noisy walls, one of them short, and here and there a single point."""
    for n, bearing in enumerate(rng.uniform(0, np.pi, 30)):
        yield walls(rng, bearing, [(-0.5, 0.5), (-0.1, 0.05)], (80, 1 if n % 10 == 9 else 12), 0.004)


CORRIDOR = task(
    "corridor",
    common_bearing,
    judge_corridor,
    (
        ("exact walls, opposite each other", 1, opposite),
        ("exact walls, seen along different stretches", 1, displaced),
        ("noisy walls, one of them short or a single point", 2, noisy_and_short),
    ),
    (
        Fault(
            "The bearing is off by a quarter turn: along the walls is asked for, not across.",
            like=lambda left, right: (common_bearing(left, right)[0] + np.pi / 2, common_bearing(left, right)[1]),
            name="across for along",
        ),
        Fault(
            "The means of the two walls need not stand opposite each other: how far is it square to the walls?",
            like=between_means,
            name="distance of the means",
        ),
        Fault(
            "One line for all points lies between the walls, or slants from one to the other.",
            like=one_line_for_both,
            name="one line for both",
        ),
        Fault(
            "A short wall knows its bearing badly, and here it has as much to say as the long one.",
            like=mean_of_two,
            name="mean of two bearings",
        ),
        Fault(
            "The plain mean of two bearings fails where they begin anew: near 0 and near a half turn is the same wall.",
            like=plain_mean_of_two,
            name="mean of two bearings",
        ),
        Fault(
            "Errors in y are no distances: measure across the walls. (Try an upright corridor.)",
            like=with_slopes,
            name="errors in y",
        ),
        Fault(
            "The shorter wall knows something, too: both walls fix one bearing together.",
            like=longer_alone,
            name="longer wall alone",
        ),
        Fault(
            "Half the width came back: it goes from one wall to the other.",
            like=lambda left, right: (common_bearing(left, right)[0], common_bearing(left, right)[1] / 2),
            name="half the width",
        ),
    ),
)
