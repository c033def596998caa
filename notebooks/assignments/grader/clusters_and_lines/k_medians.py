"""K-Medians: K-Means with city-block distances and medians, which strays cannot pull.

In:  the student's ``k_medians``.
Out: marks.

>>> K_MEDIANS.mark(settled)
4.0
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from primkit.checks.judges import array

from ..parts import EDGE, Fault, task

Floats = NDArray[np.float64]


def settled(points: Floats, centers: Floats) -> Floats:
    """Return the centres, shape (k, 2), once assigning by city-block distance and moving to medians change nothing."""
    return medians_like()(points, centers)


def by_streets(offset: Floats) -> Floats:
    """Return city-block lengths."""
    return np.abs(offset).sum(axis=-1)


def straight(offset: Floats) -> Floats:
    """Return lengths as the crow flies."""
    return np.hypot(offset[..., 0], offset[..., 1])


def medians_like(
    away: Any = by_streets, middle: Any = lambda group: np.median(group, axis=0), rounds: int = 1000
) -> Callable[[Floats, Floats], Floats]:
    """Return the algorithm, or a wrong way with one of its steps done in another way."""

    def settle(points: Floats, centers: Floats) -> Floats:
        ends = centers.astype(float)
        for _ in range(rounds):
            before = ends.copy()
            nearest = away(points[:, None] - before).argmin(axis=1)
            for k in set(nearest.tolist()):  # a centre that no point comes to is not among them
                ends[k] = middle(points[nearest == k])
            if (ends == before).all():
                break
        return ends

    return settle


def low_middle(group: Floats) -> Floats:
    """Return the lower one of the two middle values, for an even number of points."""
    return np.sort(group, axis=0)[(len(group) - 1) // 2]


def nearest_to_median(group: Floats) -> Floats:
    """Return the point of the group with the least city-block distance to all others."""
    return group[np.abs(group[:, None] - group).sum(axis=(1, 2)).argmin()]


def blobs(rng: np.random.Generator, k: int) -> tuple[Floats, Floats]:
    """Return points around k places with a few strays far away, and first centres."""
    places = rng.uniform(-0.4, 0.4, (k, 2))
    points = [place + rng.normal(0, 0.06, (int(rng.integers(5, 14)), 2)) for place in places]
    strays = rng.uniform(0.8, 1.6, (int(rng.integers(1, 3)), 2)) * rng.choice([-1, 1], 2)
    points = rng.permutation(np.vstack([*points, strays]))
    return points, points[rng.choice(len(points), k, replace=False)] + rng.uniform(-0.01, 0.01, (k, 2))


def without_ties(points: Floats, centers: Floats) -> bool:
    """Tell whether on the way no point is as near to a second centre, up to rounding, and no centre is left alone."""
    for _ in range(1000):
        away = np.sort(np.abs(points[:, None] - centers).sum(axis=-1), axis=1)
        alone = len(np.unique(np.abs(points[:, None] - centers).sum(axis=-1).argmin(axis=1))) < len(centers)
        if alone or (len(centers) > 1 and (away[:, 1] - away[:, 0]).min() < EDGE):
            return False
        before, centers = centers, medians_like(rounds=1)(points, centers)
        if np.array_equal(before, centers):
            return True
    return False


def one_group(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield one group, with odd and even numbers of points."""
    yield np.array([[0.0, 0.0], [0.1, 0.3], [0.9, 0.2]]), np.array([[0.5, 0.5]])
    yield np.array([[0.0, 0.0], [0.1, 0.3], [0.2, 0.4], [0.9, 0.2]]), np.array([[0.5, 0.5]])
    for _ in range(20):
        yield blobs(rng, 1)


def several_groups(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield several groups, which need several rounds, and in which the kind of distance matters."""
    by_euclid = medians_like(straight)
    n = 0
    while n < 30:
        points, centers = blobs(rng, int(rng.integers(2, 5)))
        if without_ties(points, centers) and (
            n % 3 or not np.allclose(by_euclid(points, centers), settled(points, centers))
        ):
            n += 1
            yield points, centers


def lonely_center(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield groups and a centre so far away that no point comes to it."""
    yield np.array([[0.0, 0.0], [0.1, 0.3], [0.9, 0.2]]), np.array([[0.5, 0.5], [9.0, 9.0]])
    for _ in range(20):
        points, centers = blobs(rng, 1)
        yield points, np.vstack([centers, [[5.0, -5.0]]])


K_MEDIANS = task(
    "k_medians",
    settled,
    array("m", 1e-6),
    (
        ("one group: where is its median?", 1, one_group),
        ("several groups, until nothing moves", 2, several_groups),
        ("a centre that no point comes to", 1, lonely_center),
    ),
    (
        Fault(
            "The mean follows a stray however far it goes: the median is asked for, of x and of y apart.",
            like=medians_like(middle=lambda group: group.mean(axis=0)),
            name="mean for median",
        ),
        Fault(
            "That is K-Means, with means and straight distances: both steps are others here.",
            like=medians_like(
                lambda offset: np.hypot(offset[..., 0], offset[..., 1]), lambda group: group.mean(axis=0)
            ),
            name="K-Means for K-Medians",
        ),
        Fault(
            "Distances go along the streets, not as the crow flies: add what x and what y differ by.",
            like=medians_like(straight),
            name="straight distance",
        ),
        Fault(
            "The centres are still on their way after one round: repeat until none moves.",
            like=medians_like(rounds=1),
            name="one round",
        ),
        Fault(
            "For an even number of values the median lies half-way between the two middle ones.",
            like=medians_like(middle=low_middle),
            name="one of two middle values",
        ),
        Fault(
            "The median of x and that of y need not come from the same point.",
            like=medians_like(middle=nearest_to_median),
            name="a point for the median",
        ),
        Fault(
            "No points have no median: what does the rule say about such a centre?",
            when=lambda cases: any(
                np.isnan(np.asarray(case.got, dtype=float)).any() for case in cases if is_table(case.got)
            ),
            name="nan for a lonely centre",
        ),
        Fault(
            "A centre without points is lost: it stays where it was.",
            when=lambda cases: all(is_table(c.got) and len(c.got) < len(c.expected) for c in cases if c.off),
            name="lonely centre lost",
        ),
    ),
)


def is_table(value: Any) -> bool:
    """Tell whether something is a table of numbers with two columns."""
    try:
        return np.asarray(value, dtype=float).ndim == 2
    except (TypeError, ValueError):
        return False
