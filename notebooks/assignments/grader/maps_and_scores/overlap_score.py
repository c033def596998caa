"""A score by overlap: intersection over union of one-to-one pairs.

In:  the student's ``overlap_score``.
Out: marks.

>>> OVERLAP_SCORE.mark(best_overlap)
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

from ..parts import TURN, Fault, task

Floats = NDArray[np.float64]
Shapes = Sequence[Any]


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
