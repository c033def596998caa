"""One scan, cut at its widest gaps: a ring of points falls apart into groups.

In:  the student's ``cut_scan``.
Out: marks.

>>> CUT_SCAN.mark(cut_at_gaps)
4.0
"""

# ruff: noqa: ARG005 (a wrong way may leave out what it is given)

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.cluster.hierarchy import fcluster, linkage

from primkit.checks.judges import groups

from ..parts import EDGE, TURN, Fault, task

Floats = NDArray[np.float64]

CASES = 60  # random ones, in each part


def cut_at_gaps(points: Floats, k: int) -> NDArray[np.int64]:
    """Return labels, shape (N,): the closed ring of points falls apart at its k widest gaps."""
    gaps = np.hypot(*(points - np.roll(points, 1, axis=0)).T)  # from the one before; before 0 comes the last
    return cut_before(np.argsort(gaps)[len(gaps) - k :], len(points))


def cut_before(cuts: Any, n: int) -> NDArray[np.int64]:
    """Return labels of a ring of n points that is cut before each of these."""
    begins = np.zeros(n, dtype=int)
    begins[cuts] = 1
    labels = np.cumsum(begins)
    return np.where(labels == 0, labels[-1], labels)  # before the first cut: still the last group


def open_chain(points: Floats, k: int) -> NDArray[np.int64]:
    """Cut the chain from the first to the last point, which are not taken for neighbours."""
    gaps = np.hypot(*np.diff(points, axis=0).T)
    begins = np.zeros(len(points), dtype=int)
    begins[np.argsort(gaps)[len(gaps) - (k - 1) :] + 1] = 1
    return np.cumsum(begins)


def one_too_many(points: Floats, k: int) -> NDArray[np.int64]:
    """Cut the open chain k times, which makes k + 1 groups."""
    return open_chain(points, k + 1)


def by(measure: Any) -> Any:
    """Return a wrong way with another gap: between bearings, or between ranges."""

    def cut(points: Floats, k: int) -> NDArray[np.int64]:
        gaps = np.abs(measure(points, np.roll(points, 1, axis=0)))
        return cut_before(np.argsort(gaps)[len(gaps) - k :], len(points))

    return cut


def by_linkage(points: Floats, k: int) -> NDArray[np.int64]:
    """Join what is nearest, whether neighbours in the ring or not, until k groups are left."""
    if len(points) == 1:
        return np.zeros(1, dtype=int)
    labels: NDArray[np.int64] = fcluster(linkage(points, "single"), k, "maxclust")
    return labels


def in_bearing(a: Floats, b: Floats) -> Floats:
    """Return how far apart two points are in bearing, seen from the robot."""
    return np.angle(np.exp(1j * (np.arctan2(*a.T[::-1]) - np.arctan2(*b.T[::-1]))))


def in_range(a: Floats, b: Floats) -> Floats:
    """Return how far apart two points are in range."""
    return np.hypot(*a.T) - np.hypot(*b.T)


def ring(rng: np.random.Generator, k: int, begin: Any) -> tuple[Floats, int]:
    """Return points on k things around the robot, from the bearing ``begin(thing's edges)`` on, and k."""
    edges = (np.arange(k) + rng.uniform(0.05, 0.2, k)) * TURN / k
    widths = rng.uniform(0.3, 0.6, k) * TURN / k
    bearings = np.concatenate(
        [
            a + w * np.linspace(0, 1, max(3, int(w / rng.uniform(0.02, 0.06))))
            for a, w in zip(edges, widths, strict=True)
        ]
    )
    own = np.searchsorted(edges, bearings, side="right") - 1
    ranges = rng.uniform(0.12, 0.3, k)[own] + rng.uniform(-0.002, 0.002, len(bearings))
    order = np.argsort((bearings - begin(edges, widths)) % TURN)
    points = ranges[:, None] * np.column_stack([np.cos(bearings), np.sin(bearings)])
    return points[order], k


def clear(points: Floats, k: int) -> bool:
    """Tell whether no two gaps are so alike that rounding decides which one is cut."""
    gaps = np.sort(np.hypot(*(points - np.roll(points, 1, axis=0)).T))
    return k == len(gaps) or bool(gaps[-k] - gaps[-k - 1] > EDGE)


FIVE = np.array([(0.2, 0.0), (0.2, 0.01), (0.2, 0.02), (-0.2, 0.1), (-0.2, 0.09)])


def from_a_gap(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield scans whose first beam falls between two things."""
    yield FIVE, 2
    for _ in range(CASES):
        yield ring(rng, int(rng.integers(2, 6)), lambda edges, widths: edges[0] - 0.01)


def from_a_thing(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield scans whose first beam falls on the middle of a thing."""
    yield np.roll(FIVE, 1, axis=0), 2
    for _ in range(CASES):
        yield ring(rng, int(rng.integers(2, 6)), lambda edges, widths: edges[0] + 0.5 * widths[0])


def one_before_another(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield a near thing before a far one: neighbours in bearing, not in space; the near one has lost a few hits."""
    for n in range(CASES):
        near = np.linspace(0.0, 0.8, 30)
        near = near[(near < 0.3) | (near > 0.3 + rng.uniform(0.15, 0.3))] if n else near
        far = np.linspace(0.83, 1.6, 25)
        bearings = rng.uniform(0, TURN) + np.concatenate([near, far])
        ranges = np.concatenate([np.full(len(near), rng.uniform(0.06, 0.1)), np.full(len(far), rng.uniform(0.25, 0.3))])
        yield ranges[:, None] * np.column_stack([np.cos(bearings), np.sin(bearings)]), 2
        if n % 3 == 0:
            yield pole_before_wall(rng)


def pole_before_wall(rng: np.random.Generator) -> tuple[Floats, int]:
    """Return a pole before a wall, and behind the robot a thing of two parts: four groups, for the pole cuts the wall.

    The wall's two halves are nearer to each other than the parts of that thing; but they are no neighbours.
    """
    shadow, gap = rng.uniform(0.1, 0.13), rng.uniform(0.2, 0.25)
    far, near, back = rng.uniform(0.26, 0.3), rng.uniform(0.08, 0.12), rng.uniform(0.24, 0.28)
    pieces = (
        (far, np.delete(np.arange(-0.7, -shadow / 2, 0.03), 7)),  # a lost hit: the widest gap in bearing but three
        (near, np.arange(-shadow / 2 + 0.01, shadow / 2, 0.03)),
        (far, np.arange(shadow / 2 + 0.01, 0.7, 0.03)),
        (back, np.arange(np.pi - 0.5, np.pi - gap / 2, 0.03)),
        (back, np.arange(np.pi + gap / 2, np.pi + 0.5, 0.03)),
    )
    bearings = rng.uniform(0, TURN) + np.concatenate([turns for _, turns in pieces])
    ranges = np.concatenate([np.full(len(turns), away) for away, turns in pieces])
    points = ranges[:, None] * np.column_stack([np.cos(bearings), np.sin(bearings)])
    return points, 4


def one_or_all(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield scans that make one group, and scans of which every point is a group."""
    yield np.array([[0.2, 0.1]]), 1
    yield FIVE, 1
    yield FIVE, 5
    for n in range(20):
        points, _ = ring(rng, 3, lambda edges, widths: edges[0] + 0.5 * widths[0])
        yield points, (1 if n % 2 else len(points))


CUT_SCAN = task(
    "cut_scan",
    cut_at_gaps,
    groups(),
    (
        ("scans that begin in a gap", 1, from_a_gap),
        ("scans that begin on a thing", 1, from_a_thing),
        ("a near thing before a far one", 1, one_before_another),
        ("one group, and every point alone", 1, one_or_all),
    ),
    (
        Fault(
            "The last beam is the first one's neighbour: a scan is a ring. Is the gap between them looked at?",
            like=open_chain,
            name="ring not closed",
        ),
        Fault(
            "There is one group too many: how many pieces does a chain make that is cut k times? And a ring?",
            like=one_too_many,
            name="one cut too many",
        ),
        Fault(
            "Groups are stretches of the ring: what is near, but comes later in the scan, belongs to another one.",
            like=by_linkage,
            name="joined by nearness",
        ),
        Fault(
            "Neighbours in bearing may be far apart in space: how far is it from one point to the next?",
            like=by(in_bearing),
            name="gap in bearing",
        ),
        Fault(
            "Two things at the same range may be far apart in space: how far is it from one point to the next?",
            like=by(in_range),
            name="gap in range",
        ),
        Fault(
            "Those are the narrowest gaps.",
            like=lambda points, k: cut_before(
                np.argsort(np.hypot(*(points - np.roll(points, 1, axis=0)).T))[:k], len(points)
            ),
            name="narrowest gaps",
        ),
    ),
)
