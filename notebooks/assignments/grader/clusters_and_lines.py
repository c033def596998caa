"""Problem set 2, clusters and lines: one scan cut at its widest gaps, K-Medians, a wall in fog, two parallel walls.

In:  the student's ``cut_scan``, ``k_medians``, ``wall_in_fog`` and ``corridor``.
Out: marks.

>>> CUT_SCAN.mark(cut_at_gaps)
4.0
"""

# ruff: noqa: ARG005 (a wrong way may leave out what it is given)

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

import primkit as pk
from primkit.checks.judges import array, groups

from .parts import EDGE, TURN, Fault, numbers, shown, task, turn_between

Floats = NDArray[np.float64]

CASES = 60  # random ones, in each part of a quick task


# --- one scan, cut at its widest gaps ----------------------------------------------------------------------


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


# --- K-Medians ---------------------------------------------------------------------------------------------


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


# --- a wall in fog -----------------------------------------------------------------------------------------


def last_wall(points: Floats, threshold: float, rng: Any = None) -> tuple[float, float] | None:
    """Return the line with most inliers among those with no hit behind them, as (angle, offset); tries all pairs."""
    first, second = np.triu_indices(len(points), 1)
    step = points[second] - points[first]
    length = np.hypot(*step.T)
    first, step, length = first[length > 0], step[length > 0], length[length > 0]
    if not len(first):
        return None
    normals = np.column_stack([-step[:, 1], step[:, 0]]) / length[:, None]
    offsets = (normals * points[first]).sum(axis=1)
    turned = np.where(offsets < 0, -1.0, 1.0)  # away from the robot
    out = points @ (normals * turned[:, None]).T - offsets * turned  # (N, lines), above zero: behind
    inliers = (np.abs(out) <= threshold).sum(axis=0)
    best = int(np.argmax(np.where((out <= threshold).all(axis=0), inliers, 0)))
    line = pk.fit_line(points[np.abs(out[:, best]) <= threshold])
    return None if line is None else (line.angle, line.offset)


def judge_wall(got: Any, expected: Any, args: tuple[Any, ...]) -> str | None:
    """Judge a line, within 0.03 rad and, at the wall's middle, 3 mm; either normal will do."""
    if expected is None or got is None:
        return None if got is expected else f"got {shown(got)}, expected {shown(expected)}"
    pair = numbers(got, 2)
    if pair is None or not np.isfinite(pair).all():
        return f"got {shown(got)}, expected (angle, offset)"
    turned = turn_between(pair[0], expected[0], np.pi)
    if abs(turned) > 0.03:
        return f"the line is turned by {np.degrees(turned):.1f} degrees"
    wall, hits = pk.Line(*expected), args[0].mean(axis=0)
    before_them = (
        hits - wall.signed_distance([hits])[0] * wall.normal
    )  # the place on the wall that is nearest to the hits
    off = abs(float(pk.Line(*pair).signed_distance([before_them])[0]))
    return None if off <= 0.003 else f"the line has the right direction, but is off by {1000 * off:.1f} mm"


def foggy(rng: np.random.Generator, row: int) -> tuple[Floats, float, np.random.Generator]:
    """Return hits in fog before a wall, with ``row`` hits on a straight row before it, shuffled; threshold 3 mm."""
    bearing, away = rng.uniform(0, TURN), rng.uniform(0.3, 0.5)
    ahead, aside = np.array([np.cos(bearing), np.sin(bearing)]), np.array([-np.sin(bearing), np.cos(bearing)])

    def place(out: Any, side: Any) -> Floats:
        return np.multiply.outer(out, ahead) + np.multiply.outer(side, aside)

    wall = place(away + rng.uniform(-0.001, 0.001, 30), np.linspace(-0.4, 0.4, 30) + rng.uniform(-0.01, 0.01, 30))
    fog = place(rng.uniform(0.05, away - 0.02, 45), rng.uniform(-0.4, 0.4, 45))
    tilt = rng.uniform(-0.4, 0.4)
    side = rng.uniform(-0.3, 0.3, row)
    drops = place(0.6 * away + np.tan(tilt) * 0.25 * side + rng.uniform(-0.001, 0.001, row), side)
    return rng.permutation(np.vstack([wall, fog, drops])), 0.003, np.random.default_rng(1)


def in_fog(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield walls behind evenly spread fog."""
    for _ in range(6):
        yield foggy(rng, 0)


def behind_a_row(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield walls behind fog and a straight row of drops, on which there are more hits than on the wall."""
    for _ in range(6):
        yield foggy(rng, 50)


def few_points(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield too few points for a line, and just enough."""
    seed = np.random.default_rng(1)
    yield np.array([[0.3, 0.1]]), 0.003, seed
    yield np.array([[0.3, 0.1]] * 4), 0.003, seed
    yield np.zeros((0, 2)), 0.003, seed
    yield np.array([[0.3, -0.1], [0.3, 0.1]]), 0.003, seed


def hits_behind(cases: Any) -> bool:
    """Tell whether every wrong line has hits far behind it, seen from the robot."""
    wrong = [(numbers(case.got, 2), case.args) for case in cases if case.off]
    return all(line is not None and behind(line, *args[:2]) for line, args in wrong)


def behind(line: Any, points: Floats, threshold: float) -> bool:
    """Tell whether some points lie behind a line, by more than three thresholds."""
    out = pk.Line(*line).signed_distance(points) * (1 if line[1] >= 0 else -1)
    return bool((out > 3 * threshold).any())


def through_all(points: Floats, _threshold: float, _rng: Any) -> Any:
    """Fit all points at once."""
    line = pk.fit_line(points)
    return None if line is None else (line.angle, line.offset)


WALL_IN_FOG = task(
    "wall_in_fog",
    last_wall,
    judge_wall,
    (
        ("a wall behind fog", 1, in_fog),
        ("a straight row of drops in front, with more hits than the wall", 2, behind_a_row),
        ("too few points, and just enough", 1, few_points),
    ),
    (
        Fault(
            "Least squares over all hits finds the middle of the fog: not all hits belong to the wall.",
            like=through_all,
            name="least squares over all",
        ),
        Fault(
            "There are hits behind this line, and light does not come through a wall: most inliers are not enough.",
            when=hits_behind,
            name="hits behind the wall",
        ),
        Fault(
            "A line comes back where the hits fix none.",
            when=lambda cases: all(case.got is not None and case.expected is None for case in cases if case.off),
            name="a line from one point",
        ),
    ),
)


# --- a corridor of two parallel walls ----------------------------------------------------------------------


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


BEARINGS = (0.0, 0.5, 1.2, np.pi / 2, 2.0, np.pi - 0.01)


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
