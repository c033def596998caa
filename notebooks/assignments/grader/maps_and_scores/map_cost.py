"""The cost of a map: distances of pairs, misses and false alarms, each with its weight.

In:  the student's ``map_cost``.
Out: marks.

>>> MAP_COST.mark(least_cost)
4.0
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from primkit.checks.judges import number

from ..parts import EDGE, INF, Fault, task

Floats = NDArray[np.float64]

CASES = 40  # random ones, in each part


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


def plain_pairs(draw: Callable[[], tuple[Any, ...]]) -> Iterator[tuple[Any, ...]]:
    """Yield drawn boards on which the nearest pair first is right: whom to pair is another part's question."""
    n = 0
    while n < CASES:
        args = draw()
        if abs(greedy_cost(*args) - least_cost(*args)) < EDGE:
            n += 1
            yield args


def better_apart(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield as many found as true centres; some are so far apart that a miss and a false alarm cost less."""
    yield np.array([[0.5, 0.0], [0.0, 0.1]]), np.array([[-0.5, 0.0], [0.0, 0.0]]), 0.2, 0.2
    yield from plain_pairs(lambda: (rng.uniform(-0.5, 0.5, (4, 2)), rng.uniform(-0.5, 0.5, (4, 2)), 0.15, 0.15))


def unlike_weights(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield different numbers of centres, with one weight several times the other."""
    yield np.array([[0.0, 0.1]]), np.array([[0.0, 0.0], [0.4, 0.4]]), 0.3, 0.05

    def draw() -> tuple[Any, ...]:
        count, weights = rng.permutation([2, 4]), rng.permutation([0.3, 0.1]).tolist()
        return rng.uniform(-0.4, 0.4, (count[0], 2)), rng.uniform(-0.4, 0.4, (count[1], 2)), *weights

    yield from plain_pairs(draw)


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
