"""Problem set 4, maps and scores: a compass that is off, a score by overlap, the cost of a map, an honest choice.

In:  the student's ``compass_bias``, ``overlap_score``, ``map_cost`` and ``honest_score``.
Out: marks.

>>> MAP_COST.mark(least_cost)
4.0
"""

# ruff: noqa: ARG005 (a wrong way may leave out what it is given)

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

import primkit as pk
from primkit.checks.judges import number

from .parts import INF, TURN, Fault, shown, task

Floats = NDArray[np.float64]
Shapes = Sequence[Any]

CASES = 40  # random ones, in each part of a quick task


# --- a compass that is off ---------------------------------------------------------------------------------


BIASES: dict[bytes, float] = {}  # the truth about the scans that are made below, by their poses


def true_bias(scans: pk.Scans) -> float:
    """Return the angle by which all headings are too large, radians: not estimated, but known."""
    return BIASES[scans.poses.tobytes()]


def judge_bias(got: Any, expected: Any, _args: tuple[Any, ...]) -> str | None:
    """Judge an angle, within half a degree."""
    if not isinstance(got, (float, int, np.floating)) or isinstance(got, bool):
        return f"got {shown(got)}, expected an angle in radians"
    off = float(np.degrees(got - expected))
    return (
        None if abs(off) <= 0.5 else f"got {np.degrees(got):.1f} degrees, expected {np.degrees(expected):.1f} degrees"
    )


def biased(rng: np.random.Generator, bias: float, lidar: pk.Lidar, turn: float) -> pk.Scans:
    """Return scans of a board from 30 poses, headings within ``turn`` of 0, all of them read too large by a bias."""
    seed = int(rng.integers(1 << 30))
    world = pk.random_world(3, style="free", rng=seed)
    poses = rng.permutation(pk.teleport_poses(world))[:30]
    poses[:, 2] = rng.uniform(-turn, turn, len(poses))
    seen = pk.scan(world, poses, lidar, rng=seed)
    poses = seen.poses + np.array([0.0, 0.0, bias])
    BIASES[poses.tobytes()] = bias
    return pk.Scans(poses, seen.angles, seen.ranges, seen.inside)


EXACT = pk.Lidar(beams=60, range_max=0.4)
POOR = pk.Lidar(beams=60, range_max=0.4, noise_std=0.002, dropout=0.2)


def some_bias(rng: np.random.Generator) -> float:
    """Return a bias of 1 to 10 degrees to either side."""
    return float(rng.choice([-1, 1]) * np.radians(rng.uniform(1, 10)))


def exact_scans(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield exact scans, headings about the same."""
    for _ in range(5):
        yield (biased(rng, some_bias(rng), EXACT, 0.1),)


def poor_scans(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield scans with noise and dropouts, and any headings."""
    for _ in range(5):
        yield (biased(rng, some_bias(rng), POOR, np.pi),)


def right_compass(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield scans with a right compass, and with one that is off by less than a degree."""
    for bias in (0.0, 0.8, -0.8):
        yield (biased(rng, float(np.radians(bias)), EXACT, np.pi),)


COMPASS_BIAS = task(
    "compass_bias",
    true_bias,
    judge_bias,
    (
        ("exact scans, headings alike", 1, exact_scans),
        ("noise, dropouts and any headings", 2, poor_scans),
        ("a compass that is right, or nearly", 1, right_compass),
    ),
    (
        Fault(
            "The right angle with the wrong sign: it is what the compass adds, and what you take away again.",
            when=lambda cases: all(judge_bias(-number_of(case.got), case.expected, ()) is None for case in cases),
            name="sign turned round",
        ),
        Fault(
            "That is in degrees.",
            when=lambda cases: all(
                judge_bias(np.radians(number_of(case.got)), case.expected, ()) is None for case in cases
            ),
            name="degrees for radians",
        ),
        Fault(
            "Always 0: is the map really sharpest as it is?",
            when=lambda cases: all(number_of(case.got) == 0 for case in cases),
            name="no bias",
        ),
        Fault(
            "Near, but not within half a degree: look again around your best angle, in finer steps.",
            when=lambda cases: all(abs(number_of(case.got) - case.expected) < np.radians(2.5) for case in cases),
            name="steps too coarse",
        ),
    ),
)


def number_of(value: Any) -> float:
    """Return a number; nan for anything else."""
    return float(value) if isinstance(value, (float, int, np.floating)) else float("nan")


# --- a score by overlap ------------------------------------------------------------------------------------


def overlaps(found: Shapes, true: Shapes) -> Floats:
    """Return intersection over union of each found and each true shape, shape (F, T)."""
    ours, theirs = [shape.to_shapely() for shape in found], [shape.to_shapely() for shape in true]
    return np.array([[a.intersection(b).area / a.union(b).area for b in theirs] for a in ours]).reshape(
        len(found), len(true)
    )


def best_overlap(found: Shapes, true: Shapes) -> float:
    """Return the largest sum of overlaps of one-to-one pairs, over the larger of the two numbers of shapes."""
    most = max(len(found), len(true))
    return paired(overlaps(found, true)) / most if most else 1.0


def paired(table: Floats) -> float:
    """Return the largest sum of one-to-one pairs."""
    return float(table[linear_sum_assignment(-table)].sum())


def overlap_like(share: Any = None, total: Any = paired, over: Any = max, nothing: float = 1.0) -> Any:
    """Return a wrong way: another share for a pair, another sum, or over another number."""

    def score(found: Shapes, true: Shapes) -> float:
        if share is None:
            table = overlaps(found, true)
        else:
            pairs = [[share(a.to_shapely(), b.to_shapely()) for b in true] for a in found]
            table = np.array(pairs).reshape(len(found), len(true))
        most = over(len(found), len(true))
        return total(table) / most if most else nothing

    return score


def greedy(table: Floats) -> float:
    """Take the best pair, then the best of what is left."""
    table, total = table.copy(), 0.0
    while table.size and table.max() > 0:
        i, j = np.unravel_index(np.argmax(table), table.shape)
        total += table[i, j]
        table[i], table[:, j] = 0.0, 0.0
    return float(total)


def best_of_each(table: Floats) -> float:
    """Give each true shape its best found one, taken or not."""
    return float(table.max(axis=0).sum()) if table.size else 0.0


def judge_share(got: Any, expected: Any, _args: tuple[Any, ...]) -> str | None:
    """Judge a score within 0.005: circles may be polygons with many corners."""
    return number("", 0.005)(got, expected, ())


def random_shape(rng: np.random.Generator, place: Floats) -> Any:
    """Return a shape of about 10 cm at a place."""
    if rng.random() < 0.4:
        return pk.Circle(place, rng.uniform(0.05, 0.1))
    corners = int(rng.integers(3, 6))
    turns = rng.uniform(0, TURN) + TURN * (np.arange(corners) + rng.uniform(-0.2, 0.2, corners)) / corners
    return pk.Polygon(place + rng.uniform(0.06, 0.12) * np.column_stack([np.cos(turns), np.sin(turns)]))


SQUARE = pk.Polygon([(0.0, 0.0), (0.2, 0.0), (0.2, 0.2), (0.0, 0.2)])
HALF = pk.Polygon([(0.0, 0.0), (0.1, 0.0), (0.1, 0.2), (0.0, 0.2)])


def one_pair(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield one found and one true shape."""
    yield [HALF], [SQUARE]
    yield [pk.Circle((0.5, 0.5), 0.1)], [SQUARE]  # apart
    for _ in range(25):
        yield [random_shape(rng, rng.uniform(-0.08, 0.08, 2))], [random_shape(rng, np.zeros(2))]


def crowds(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield crowded boards, as many found as true, on which it matters who is paired with whom."""
    n = 0
    while n < 8:
        true = [pk.Circle((x, 0.0), 0.1) for x in (0.0, 0.11, 0.22)]
        found = [pk.Circle((x + rng.uniform(-0.06, 0.06), 0.0), rng.uniform(0.08, 0.1)) for x in (-0.08, 0.05, 0.16)]
        table = overlaps(found, true)
        if paired(table) > greedy(table) + 0.05:
            n += 1
            yield [found[k] for k in rng.permutation(3)], true


def missed_and_extra(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield boards with a shape too few, and with one too many, far from the others."""
    yield [SQUARE], [SQUARE, pk.Circle((0.6, 0.6), 0.1)]
    yield [SQUARE, pk.Circle((0.6, 0.6), 0.1)], [SQUARE]
    places = np.array([(-0.3, -0.3), (0.3, 0.3), (-0.3, 0.3), (0.3, -0.3)])
    for n in range(10):
        some = [random_shape(rng, place) for place in places]
        seen = [random_shape(rng, place + rng.uniform(-0.03, 0.03, 2)) for place in places]
        yield (seen[:3], some) if n % 2 else (seen, some[:3])


def empty_boards(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield boards with nothing on them, and findings without anything."""
    yield [], []
    yield [], [SQUARE]
    yield [SQUARE, HALF], []


OVERLAP_SCORE = task(
    "overlap_score",
    best_overlap,
    judge_share,
    (
        ("one pair of shapes", 1, one_pair),
        ("crowded boards", 1, crowds),
        ("a shape missed, and one too many", 1, missed_and_extra),
        ("nothing found, or nothing there", 1, empty_boards),
    ),
    (
        Fault(
            "The area that both cover is counted twice below the fraction bar: the union holds it once.",
            like=overlap_like(lambda a, b: a.intersection(b).area / (a.area + b.area)),
            name="overlap counted twice",
        ),
        Fault(
            "Below the fraction bar stands the union: a huge found shape covers every true one.",
            like=overlap_like(lambda a, b: a.intersection(b).area / b.area),
            name="share of the true shape",
        ),
        Fault(
            "Below the fraction bar stands the union: a tiny found shape lies wholly in the true one.",
            like=overlap_like(lambda a, b: a.intersection(b).area / a.area),
            name="share of the found shape",
        ),
        Fault(
            "A found shape stands for one true shape at most.",
            like=overlap_like(total=best_of_each),
            name="not one-to-one",
        ),
        Fault(
            "Best pair first leaves the others what is left: the best sum may need another first pair.",
            like=overlap_like(total=greedy),
            name="greedy pairs",
        ),
        Fault(
            "False alarms cost nothing here: who reports shapes everywhere scores well.",
            like=overlap_like(over=lambda found, true: true),
            name="false alarms are free",
        ),
        Fault(
            "Missed shapes cost nothing here: who reports only what is certain scores well.",
            like=overlap_like(over=lambda found, true: found),
            name="misses are free",
        ),
        Fault(
            "On an empty board it is right to find nothing.",
            like=overlap_like(nothing=0.0),
            name="nothing right on an empty board",
        ),
    ),
)


# --- the cost of a map -------------------------------------------------------------------------------------


def least_cost(found: Floats, true: Floats, miss: float, alarm: float) -> float:
    """Return the least sum of distances, with ``miss`` for each missed and ``alarm`` for each extra shape, metres."""
    gain = np.minimum(apart(found, true) - miss - alarm, 0.0)  # what a pair saves, beside a miss and an alarm
    return float(len(true) * miss + len(found) * alarm + gain[linear_sum_assignment(gain)].sum())


def apart(found: Floats, true: Floats) -> Floats:
    """Return the distances, shape (F, T), metres."""
    return np.hypot(*(found.reshape(-1, 1, 2) - true.reshape(1, -1, 2)).transpose(2, 0, 1))


def changed_places(found: Floats, true: Floats, miss: float, alarm: float) -> float:
    """Take one weight for the other."""
    return least_cost(found, true, alarm, miss)


def all_paired(found: Floats, true: Floats, miss: float, alarm: float) -> float:
    """Pair as many as there are, however far apart."""
    table = apart(found, true)
    extra = len(found) - len(true)
    return float(table[linear_sum_assignment(table)].sum() + alarm * max(extra, 0) + miss * max(-extra, 0))


def nearest_each(found: Floats, true: Floats, miss: float, alarm: float) -> float:
    """Give each true shape its nearest found one, taken or not."""
    table = apart(found, true)
    near = table.min(axis=0, initial=INF) < miss + alarm
    used = set(table.argmin(axis=0)[near].tolist()) if near.any() else set()
    return float(table.min(axis=0, initial=INF)[near].sum() + miss * (~near).sum() + alarm * (len(found) - len(used)))


def greedy_cost(found: Floats, true: Floats, miss: float, alarm: float) -> float:
    """Take the nearest pair, then the nearest of what is left."""
    table = apart(found, true)
    left, right, cost = len(found), len(true), 0.0
    while table.size and table.min() < miss + alarm:
        i, j = np.unravel_index(np.argmin(table), table.shape)
        cost, left, right = cost + table[i, j], left - 1, right - 1
        table[i], table[:, j] = INF, INF
    return float(cost + left * alarm + right * miss)


def gated(found: Floats, true: Floats, miss: float, alarm: float) -> float:
    """Break a pair up when it costs more than a miss alone."""
    cheap = np.minimum(apart(found, true), INF)
    gain = np.where(cheap <= miss, cheap - miss - alarm, 0.0)
    return float(len(true) * miss + len(found) * alarm + gain[linear_sum_assignment(gain)].sum())


def free_alarms(found: Floats, true: Floats, miss: float, alarm: float) -> float:
    """Forget the false alarms in the sum."""
    gain = np.minimum(apart(found, true) - miss - alarm, 0.0)
    rows, columns = linear_sum_assignment(gain)
    pairs = int((gain[rows, columns] < 0).sum())
    return least_cost(found, true, miss, alarm) - alarm * (len(found) - pairs)


def near_each_other(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield as many found as true centres; each is near its own, and it matters who is paired with whom."""
    yield np.array([[0.03, 0.04]]), np.array([[0.0, 0.0]]), 0.2, 0.1
    n = 0
    while n < CASES:
        true = np.column_stack([np.arange(4) * 0.1, np.zeros(4)])
        found = rng.permutation(true + np.array([0.05, 0.0]) + rng.uniform(-0.04, 0.04, (4, 2)))
        args = (found, true, 0.5, 0.4)
        if abs(greedy_cost(*args) - least_cost(*args)) > 0.01:
            n += 1
            yield args


def better_apart(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield as many found as true centres; some are so far apart that a miss and a false alarm cost less."""
    yield np.array([[0.5, 0.0], [0.0, 0.1]]), np.array([[-0.5, 0.0], [0.0, 0.0]]), 0.2, 0.2
    for _ in range(CASES):
        yield rng.uniform(-0.5, 0.5, (4, 2)), rng.uniform(-0.5, 0.5, (4, 2)), 0.15, 0.15


def unlike_weights(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield different numbers of centres, with one weight several times the other."""
    yield np.array([[0.0, 0.1]]), np.array([[0.0, 0.0], [0.4, 0.4]]), 0.3, 0.05
    for _ in range(CASES):
        count = rng.permutation([2, 4])
        weights = rng.permutation([0.3, 0.1]).tolist()
        yield rng.uniform(-0.4, 0.4, (count[0], 2)), rng.uniform(-0.4, 0.4, (count[1], 2)), *weights


def nobody(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield no centres on one side, or on both."""
    none, two = np.zeros((0, 2)), rng.uniform(-0.4, 0.4, (2, 2))
    yield none, two, 0.2, 0.1
    yield two, none, 0.2, 0.1
    yield none, none, 0.2, 0.1


MAP_COST = task(
    "map_cost",
    least_cost,
    number("m"),
    (
        ("as many found as true, near each other", 1, near_each_other),
        ("pairs that cost more than a miss and a false alarm", 1, better_apart),
        ("different numbers, and unlike weights", 1, unlike_weights),
        ("nothing found, or nothing there", 1, nobody),
    ),
    (
        Fault(
            "The weights have changed places: a miss is a true shape that nobody found.",
            like=changed_places,
            name="weights changed places",
        ),
        Fault(
            "Some pairs are so far apart that leaving both alone costs less.",
            like=all_paired,
            name="everyone is paired",
        ),
        Fault(
            "One found shape serves several true ones, or none is left for them: pairs are one-to-one.",
            like=nearest_each,
            name="not one-to-one",
        ),
        Fault(
            "Nearest pair first leaves the others what is left: the least sum may need another first pair.",
            like=greedy_cost,
            name="greedy pairs",
        ),
        Fault(
            "A pair that is broken up costs a miss and a false alarm, not one of them.",
            like=gated,
            name="broken up too early",
        ),
        Fault("False alarms cost nothing here.", like=free_alarms, name="false alarms are free"),
    ),
)


# --- an honest choice --------------------------------------------------------------------------------------


def held_out(scores: Floats, folds: NDArray[np.int64]) -> float:
    """Return the mean score over all maps, each scored by the setting that was best on the other folds."""
    scores = np.nan_to_num(scores)
    return float(np.mean([scores[chosen(scores, folds != fold), k] for k, fold in enumerate(folds)]))


def chosen(scores: Floats, maps: NDArray[np.bool_]) -> int:
    """Return the first of the settings that are best on some maps."""
    return int(np.argmax(scores[:, maps].mean(axis=1)))


def honest_like(choose: Any = None, clean: Any = np.nan_to_num, mean: Any = None) -> Any:
    """Return a wrong way: another choice for a fold, another treatment of crashes, another mean."""
    choose = choose or (lambda scores, train: int(np.argmax(scores[:, train].mean(axis=1))))

    def score(scores: Floats, folds: NDArray[np.int64]) -> float:
        table = clean(scores)
        own = np.array([table[choose(table, folds != fold), k] for k, fold in enumerate(folds)])
        return float(own.mean() if mean is None else mean(own, folds))

    return score


def without_crashes(scores: Floats, folds: NDArray[np.int64]) -> float:
    """Leave crashed maps out of all means."""
    own = [scores[int(np.argmax(np.nanmean(scores[:, folds != fold], axis=1))), k] for k, fold in enumerate(folds)]
    return float(np.nanmean(own))


def last_of_ties(scores: Floats, train: NDArray[np.bool_]) -> int:
    """Return the last of the best."""
    means = scores[:, train].mean(axis=1)
    return int(np.flatnonzero(means == means.max())[-1])


def mean_of_folds(own: Floats, folds: NDArray[np.int64]) -> float:
    """Return the mean of the folds' means."""
    return float(np.mean([own[folds == fold].mean() for fold in np.unique(folds)]))


def studies(rng: np.random.Generator, sizes: Sequence[int], *, crash: float = 0.0, steps: int = 0) -> Any:
    """Yield tables of scores whose settings are about equally good; in steps there are ties."""
    for _ in range(CASES):
        folds = rng.permutation(np.repeat(np.arange(len(sizes)) + 1, sizes))
        scores = rng.uniform(0.3, 1.0, (int(rng.integers(3, 6)), len(folds)))
        if steps:
            scores = rng.integers(2, steps + 1, scores.shape) / steps
        yield np.where(rng.random(scores.shape) < crash, np.nan, scores), folds


def equal_folds(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield folds of the same size."""
    yield np.array([[1.0, 0.5], [0.75, 0.75]]), np.array([0, 1])
    yield from studies(rng, (3, 3, 3))


def unequal_folds(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield folds of different sizes."""
    yield from studies(rng, (1, 2, 6))


def crashes(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield tables with crashed maps."""
    yield from studies(rng, (3, 3, 3), crash=0.15)


def ties(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield tables in which two settings are often equally good; all sums are exact."""
    yield from studies(rng, (2, 2, 2), steps=4)


HONEST_SCORE = task(
    "honest_score",
    held_out,
    number(""),
    (
        ("folds of the same size", 1, equal_folds),
        ("folds of different sizes", 1, unequal_folds),
        ("maps on which a setting crashed", 1, crashes),
        ("settings that are equally good", 1, ties),
    ),
    (
        Fault(
            "The setting was chosen on the very maps that it is scored on: that flatters.",
            like=honest_like(lambda scores, train: int(np.argmax(scores[:, ~train].mean(axis=1)))),
            name="chosen on the test maps",
        ),
        Fault(
            "The setting was chosen on all maps, those that it is scored on among them: that flatters.",
            like=honest_like(lambda scores, train: int(np.argmax(scores.mean(axis=1)))),
            name="chosen on all maps",
        ),
        Fault(
            "Each map has its own best setting here: nobody knows that before the map is scored.",
            like=lambda scores, folds: float(np.nan_to_num(scores).max(axis=0).mean()),
            name="best of each map",
        ),
        Fault(
            "Each map counts alike, in a large fold as in a small one.",
            like=honest_like(mean=mean_of_folds),
            name="mean of the folds' means",
        ),
        Fault(
            "A map on which a setting crashes counts as 0; left out, crashing would pay.",
            like=without_crashes,
            name="crashes left out",
        ),
        Fault(
            "Of settings that are equally good, the first counts.",
            like=honest_like(last_of_ties),
            name="last of ties",
        ),
        Fault(
            "nan comes back: a crash counts as 0.",
            when=lambda cases: any(isinstance(case.got, float) and np.isnan(case.got) for case in cases),
            name="nan spreads",
        ),
    ),
)
