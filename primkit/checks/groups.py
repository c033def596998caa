"""Groups: the two steps of K-Means, and how clearly groups are apart; the checks of lesson 03.

In:  the student's ``assign_points(points, centers)``, ``update_centers(points, labels, centers)`` and
     ``silhouette(points, labels)``.
Out: answers. A group without points keeps its centre; a point alone in its group has the silhouette 0.

>>> assign_points(lambda points, centers: ...)
○ not attempted: assign_points still returns `...`.
>>> points = np.array([[0.0, 0.0], [0.0, 0.1], [0.4, 0.0]])
>>> assign_points.reference(points, points[[0, 2]]).tolist()
[0, 0, 1]
>>> update_centers.reference(points, np.array([0, 0, 1]), np.zeros((3, 2))).tolist()
[[0.0, 0.05], [0.4, 0.0], [0.0, 0.0]]
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from ..arguments import Bools, Floats, Labels
from .answer import Case, Check, Fault
from .cases import RANDOM_CASES, UNDECIDED, Args, random_cases
from .judges import array, no_return, number, shown


def nearest_centers(points: Floats, centers: Floats) -> Labels:
    """Return the number of each point's nearest centre, shape (N,)."""
    return np.argmin(_distances(points, centers), axis=1)


def mean_of_each(points: Floats, labels: Labels, centers: Floats) -> Floats:
    """Return the mean of each group's points, shape (k, 2), metres; the old centre where a group has none."""
    return _each(lambda own: own.mean(axis=0))(points, labels, centers)


def mean_silhouette(points: Floats, labels: Labels) -> float:
    """Return the mean silhouette of all points, from -1 to 1: Rousseeuw (1987).

    (b - a) / max(a, b),  a: mean distance to the others of the own group, b: to the points of the next one, metres.
    """
    return _mean_of(*_own_and_next(points, labels))


def _mean_of(a: Floats, b: Floats, alone: Bools) -> float:
    return float(np.where(alone, 0.0, _score(a, b)).mean())


def _score(a: Floats, b: Floats) -> Floats:
    scores: Floats = (b - a) / np.maximum(a, b)
    return scores


def _distances(points: Floats, others: Floats) -> Floats:
    """Return the distance of each point to each of the others, shape (N, M), metres."""
    return np.linalg.norm(points[:, None] - others, axis=2)


def _each(middle: Callable[[Floats], Any], empty: Callable[[Floats], Any] = lambda center: center) -> Any:
    """Return an update step with another middle than the mean, or another answer for an empty group."""

    def update(points: Floats, labels: Labels, centers: Floats) -> Floats:
        groups = [points[labels == j] for j in range(len(centers))]
        return np.array([middle(own) if len(own) else empty(c) for own, c in zip(groups, centers, strict=True)])

    return update


def _own_and_next(points: Floats, labels: Labels, itself: int = 1) -> tuple[Floats, Floats, Bools]:
    """Return each point's mean distance to its own group and to the next one, and whether it is alone.

    ``itself`` is how many points of the own group, the point itself, are not counted in the mean.
    """
    names, inverse = np.unique(labels, return_inverse=True)
    apart = _distances(points, points)
    sums = np.column_stack([apart[:, labels == name].sum(axis=1) for name in names])
    sizes, rows = np.bincount(inverse.astype(np.intp)), np.arange(len(points))
    own = sums[rows, inverse] / np.maximum(sizes[inverse] - itself, 1)
    others = sums / sizes
    others[rows, inverse] = np.inf
    return own, others.min(axis=1), sizes[inverse] == 1


def _assign_cases(rng: np.random.Generator) -> Iterator[Args]:
    """Yield plain points and centres, then random ones without ties."""
    row = np.array([[0.0, 0.0], [0.1, 0.0], [0.3, 0.0], [0.4, 0.1]])
    yield row, np.array([[0.0, 0.0], [0.4, 0.0]])
    yield row, np.array([[0.4, 0.0], [0.0, 0.0]])
    yield row, np.array([[0.2, 0.3], [0.22, -0.1], [0.5, 0.0]])
    yield row, np.array([[0.2, 0.0]])
    yield row[:1], np.array([[0.3, 0.3], [0.1, 0.0]])

    def draw(_n: int) -> Args | None:
        points = rng.uniform(-0.5, 0.5, (rng.integers(1, 30), 2))
        centers = rng.uniform(-0.5, 0.5, (rng.integers(1, 7), 2))
        two = np.sort(_distances(points, centers), axis=1)[:, :2]
        return (points, centers) if len(centers) == 1 or np.diff(two, axis=1).min() > UNDECIDED else None

    yield from random_cases(draw)


def _update_cases(rng: np.random.Generator) -> Iterator[Args]:
    """Yield groups of one and more points, groups with none, then random ones, a third of them with an empty group."""
    row = np.array([[0.0, 0.0], [0.1, 0.0], [0.35, 0.1], [0.4, 0.0], [0.45, 0.2]])
    start = np.array([[0.1, 0.1], [0.3, 0.0]])
    yield row, np.array([0, 0, 1, 1, 1]), start
    yield row, np.array([1, 0, 1, 1, 1]), start
    yield row, np.array([0, 0, 0, 0, 0]), start[:1]
    yield row, np.array([0, 0, 2, 2, 2]), np.array([[0.1, 0.1], [0.3, 0.3], [0.4, 0.0]])  # group 1 is empty
    yield row, np.array([0, 0, 1, 1, 1]), np.array([[0.1, 0.1], [0.4, 0.0], [-0.3, 0.3]])  # the last one is
    for n in range(RANDOM_CASES):
        points = rng.uniform(-0.5, 0.5, (rng.integers(6, 30), 2))
        k = int(rng.integers(1, 7))
        labels = np.concatenate([np.arange(k), rng.integers(0, k, len(points) - k)])
        if n % 3 == 0 and k > 1:
            labels[labels == rng.integers(k)] = -1
            labels[labels == -1] = labels.max()
        yield points, rng.permutation(labels), rng.uniform(-0.5, 0.5, (k, 2))


def _silhouette_cases(rng: np.random.Generator) -> Iterator[Args]:
    """Yield two groups far apart, the wrong pairs, a third group, a lone point; then random ones."""
    pairs = np.array([[0.0, 0.0], [0.0, 0.1], [0.4, 0.0], [0.4, 0.1]])
    yield pairs, np.array([0, 0, 1, 1])
    yield pairs, np.array([0, 1, 0, 1])
    yield np.vstack([pairs, [[0.9, 0.0], [0.9, 0.1]]]), np.array([0, 0, 1, 1, 2, 2])
    yield np.vstack([pairs, [[0.1, 0.4]]]), np.array([0, 0, 1, 1, 2])  # the last point is alone
    for n in range(RANDOM_CASES):
        k = int(rng.integers(2, 6))
        sizes = rng.integers(2, 8, k)
        if n % 4 == 0:
            sizes[rng.integers(k)] = 1
        labels = np.repeat(np.arange(k, dtype=np.intp), sizes.astype(np.intp))
        points = rng.uniform(-0.4, 0.4, (k, 2))[labels] + rng.normal(0.0, rng.choice([0.02, 0.2]), (len(labels), 2))
        order = rng.permutation(len(labels))
        yield points[order], labels[order]


def _labels(got: Any, expected: Any, args: Args) -> str | None:
    """Judge the numbers of centres: one whole number for each point."""
    wanted, k = np.asarray(expected), len(args[1])
    kind = f"expected {len(wanted)} whole numbers from 0 to {k - 1}, one for each point"
    try:
        labels = np.asarray(got)
    except ValueError:  # rows of different lengths
        return f"got {shown(got)}, {kind}"
    if labels.dtype.kind == "f" and labels.shape == wanted.shape and (labels == np.round(labels)).all():
        return f"got {shown(got)} as floats such as {float(labels[0])}, {kind}: only integers can number centres"
    if labels.dtype.kind not in "iu" or labels.shape == ():
        return f"got {shown(got)}, {kind}{no_return(got)}"
    if labels.shape != wanted.shape:
        return f"got an array of shape {labels.shape}, {kind}"
    if np.array_equal(labels, wanted):
        return None
    worst = int(np.argmax(labels != wanted))
    return f"point {worst} got the number {labels[worst]}, expected {wanted[worst]}"


def _has_shape(shape_of: Callable[[Case], tuple[int, ...]]) -> Callable[[list[Case]], bool]:
    """Return a fault's look at the cases: whether all results have the shape that it tells."""

    def when(cases: list[Case]) -> bool:
        try:
            return all(np.shape(case.got) == shape_of(case) for case in cases)
        except ValueError:  # rows of different lengths
            return False

    return when


def _nearest_along(axis: int) -> Any:
    """Return the assignment that compares one coordinate only."""
    return lambda points, centers: np.argmin(np.abs(points[:, [axis]] - centers[:, axis]), axis=1)


def _empty(case: Case) -> Bools:
    """Return which groups have no points, shape (k,)."""
    _, labels, centers = case.args
    return ~np.isin(np.arange(len(centers)), labels)


def _all_others(points: Floats, labels: Labels) -> float:
    """Return the silhouette with b as the mean distance to the points of all other groups together."""
    a, _, alone = _own_and_next(points, labels)
    apart, other = _distances(points, points), labels[:, None] != labels
    return _mean_of(a, (apart * other).sum(axis=1) / other.sum(axis=1), alone)


def _nearest_point(points: Floats, labels: Labels) -> float:
    """Return the silhouette with b as the distance to the nearest point of another group."""
    a, _, alone = _own_and_next(points, labels)
    return _mean_of(a, np.where(labels[:, None] != labels, _distances(points, points), np.inf).min(axis=1), alone)


def _lone_left_out(points: Floats, labels: Labels) -> float:
    """Return the mean silhouette of the points that are not alone in their group."""
    a, b, alone = _own_and_next(points, labels)
    return float(_score(a, b)[~alone].mean())


def _with(score: Callable[[Floats, Floats], Any], itself: int = 1, lone: float = 0.0) -> Any:
    """Return a silhouette with another formula, the point itself counted, or another value for lone points."""

    def silhouette(points: Floats, labels: Labels) -> float:
        a, b, alone = _own_and_next(points, labels, itself)
        return float(np.where(alone, lone, score(a, b)).mean())

    return silhouette


def _to_centers(points: Floats, labels: Labels) -> float:
    """Return the silhouette with distances to the groups' centres instead of to their points."""
    names, inverse = np.unique(labels, return_inverse=True)
    apart = _distances(points, np.array([points[labels == name].mean(axis=0) for name in names]))
    rows = np.arange(len(points))
    a = apart[rows, inverse].copy()
    apart[rows, inverse] = np.inf
    return _mean_of(a, apart.min(axis=1), np.bincount(inverse.astype(np.intp))[inverse] == 1)


assign_points = Check(
    "assign_points",
    nearest_centers,
    _assign_cases,
    _labels,
    (
        Fault(
            "That distance is |dx| + |dy|, the way along streets: Pythagoras is shorter.",
            like=lambda p, c: np.argmin(np.abs(p[:, None] - c).sum(axis=2), axis=1),
        ),
        Fault("Only x is compared: a distance has x and y in it.", like=_nearest_along(0)),
        Fault("Only y is compared: a distance has x and y in it.", like=_nearest_along(1)),
        Fault(
            "Those are the distances themselves: which centre has the least one?",
            when=_has_shape(lambda case: (len(case.args[0]), len(case.args[1]))),
        ),
        Fault(
            "Those are the least distances: the number of the centre is asked for.",
            like=lambda p, c: _distances(p, c).min(axis=1),
            judge=array("m"),
        ),
        Fault(
            "That is one number for all points: along which axis is the least sought?",
            when=lambda cases: all(isinstance(case.got, (int, np.integer)) for case in cases),
        ),
        Fault(
            "That is the nearest point of each centre: along which axis is the least sought?",
            when=_has_shape(lambda case: (len(case.args[1]),)),
        ),
    ),
)

update_centers = Check(
    "update_centers",
    mean_of_each,
    _update_cases,
    array("m"),
    (
        Fault(
            "A group without points has no mean (0 / 0): its centre stays where it was.",
            like=_each(lambda own: own.mean(axis=0), lambda center: center * np.nan),
        ),
        Fault(
            "A group without points is left out: its centre stays, so that there are always k rows.",
            when=_has_shape(lambda case: (int((~_empty(case)).sum()), 2)),
        ),
        Fault(
            "A group without points is sent to (0, 0): its centre stays where it was.",
            like=_each(lambda own: own.mean(axis=0), np.zeros_like),
        ),
        Fault(
            "x and y are averaged together: a mean of positions goes along the points, axis=0.",
            when=_has_shape(lambda case: (len(case.args[2]),)),
        ),
        Fault("That is the sum: divide it by the number of points in it.", like=_each(lambda own: own.sum(axis=0))),
        Fault("That is the median; K-Means takes the mean.", like=_each(lambda own: np.median(own, axis=0))),
        Fault(
            "That is the middle between the outermost points; the mean counts every point.",
            like=_each(lambda own: (own.min(axis=0) + own.max(axis=0)) / 2),
        ),
    ),
)

silhouette = Check(
    "silhouette",
    mean_silhouette,
    _silhouette_cases,
    number(),
    (
        Fault("A point alone in its group divides 0 by 0: its silhouette is 0.", like=_with(_score, lone=np.nan)),
        Fault("A point alone in its group counts as 1; by definition it counts as 0.", like=_with(_score, lone=1.0)),
        Fault(
            "a counts the point itself, at distance 0: the mean goes over the others.",
            like=(_with(_score, 0), _with(_score, 0, 1.0)),
        ),
        Fault("b is a mean over all points of a group, not the distance to the nearest point.", like=_nearest_point),
        Fault("Points alone in their group count too, as 0: the mean goes over all points.", like=_lone_left_out),
        Fault("b is the mean distance to the nearest other group, not to all other points.", like=_all_others),
        Fault("The difference b - a is not yet divided by the larger of the two.", like=_with(lambda a, b: b - a)),
        Fault("Distances go to the points of a group here, not to its centre.", like=_to_centers),
        Fault(
            "That is one silhouette for each point: their mean is asked for.",
            when=_has_shape(lambda case: (len(case.args[0]),)),
        ),
    ),
)
