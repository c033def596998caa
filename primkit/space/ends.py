"""Ends: where a cylinder's caps and a box's faces are, as the beams that hit and those that missed tell.

In:  a solid near its solution, ``Beams``, and the ground.
Out: for each end its mean and variance, and the interval that it lies in.

A beam that just hit says that the solid goes so far, one that just missed that it goes no farther: the likelihood of an
end is a stair, and flat between. So it is summed up, not climbed: mean, variance and quantiles over one end at a time,
the others held. An end that may as well lie on the ground lies on it: nothing hovers a hand's breadth above.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arguments import Floats
from .along_beam import ON_IT, Beams, missed, returned
from .solids import Plane, Solid, first_of

FAR_OUT, MOST_LESS = 100.0, 0.95  # m: so far out an end is what is nearest; share of a size that may be taken away
FARTHEST_END = 0.6  # m from where it is supposed
FACES_GROUND, NEARLY_LEVEL = 0.05, 0.9998  # cosines of an end's slope: it faces the ground at all, it is level
FINEST_END, LOOK_STEPS = 1e-4, 16  # m; steps to each side, each longer by the same factor
FINE_STEPS, ZOOMS, SMALL_STEP = 33, 2, 1e-6  # the last: rad or m, of a difference
UNLIKELY = 9.0  # in log likelihood below the best: out of question
SHARE_OUTSIDE = 0.02  # of the probability, of the interval that is told


@dataclass(frozen=True, eq=False)
class End:
    """By how much a solid should grow at one end: mean, standard deviation, and the interval that holds it, metres.

    ``slope``, shape (numbers,), is by how much it grows there, where the beams that tell of it pass, as each number
    does: a turn moves an end far from the middle as well. ``unbounded``: no beam ends the interval. ``below``: how far
    it lies below the ground, which all numbers together must mend.
    """

    growth: float
    std: float
    between: tuple[float, float]
    slope: Floats
    unbounded: bool = False
    below: float = 0.0


def growths(solid: Solid) -> dict[int, Floats]:
    """Return by how much its numbers change, shape (numbers,), when a solid grows by a metre at each end."""
    low, high = np.split(np.eye(solid.numbers)[solid.first_end :], 2)
    return dict(enumerate([*-low, *high], solid.first_end))


def grown(solid: Solid, ends: dict[int, End] | None = None, known: float = 0.0) -> Solid:
    """Return the solid ``FARTHEST_END`` longer at each end, or at those that are known worse than ``known``, metres."""
    steps = [step for k, step in growths(solid).items() if ends is None or ends[k].std > known]
    return solid.moved(FARTHEST_END * np.sum([np.zeros(solid.numbers), *steps], axis=0))


def end_of(solid: Solid, k: int, beams: Beams, ground: Plane | None) -> End:
    """Return where the end with number k is, all others as they are.

    A solid is what all else leaves of a beam, from ``first`` to ``last``, cut off by the plane of this end. A return of
    the group tells by its range, step by step; a miss speaks against every growth that would have met it.
    """
    j = solid.ball + (k - solid.first_end) % (3 - solid.ball)  # the axis that the end lies across
    slope = growths(solid)[k]
    normal = slope[k] * solid.frame[j]
    gap = np.inf if ground is None else to_ground(solid, normal, ground)
    least, most = -2 * solid.half[j] * MOST_LESS, min(FARTHEST_END, max(gap, 0.0))
    first, last = solid.moved(FARTHEST_END * slope).chord(beams.origins, beams.directions)
    first = np.maximum(first, 0)
    last = np.minimum(last, np.where(beams.own, np.inf, beams.ranges - ON_IT * beams.noise_std))
    met = np.flatnonzero(first < last)
    first, last, o, d = first[met], last[met], beams.origins[met], beams.directions[met]
    away, start = d @ normal, (o - solid.center) @ normal - solid.half[j]
    lowest = np.where(away < 0, last, first)  # the range at which the end, as it grows, comes to cut a beam
    growth = start + away * lowest  # and how far it has grown then
    told = np.argsort(growth)
    told = told[slice(*np.searchsorted(growth[told], (least, most)))]
    lost = growth[told[~beams.own[met[told]]]]
    own = np.flatnonzero(beams.own[met] & (growth < most))

    def ranges(steps: Floats) -> Floats:
        a, enters, leaves = away[own], first[own], last[own]
        with np.errstate(divide="ignore", invalid="ignore"):
            cut = (steps[:, None] - start[own]) / a
        leaves = np.where(a > 0, np.minimum(leaves, cut), leaves)
        return first_of(np.where(a < 0, np.maximum(enters, cut), enters), leaves)

    def log_likelihoods(steps: Floats) -> Floats:
        by_returns = returned(beams.ranges[met[own]] - ranges(steps), beams.noise_std).sum(axis=1)
        return np.asarray(by_returns + missed(beams.noise_std) * np.searchsorted(lost, steps))

    look = FINEST_END * (FARTHEST_END / FINEST_END) ** (np.arange(LOOK_STEPS) / (LOOK_STEPS - 1))
    steps = np.unique(np.clip(np.concatenate([-look, [0.0], look]), least, most))
    for _ in range(ZOOMS):
        own = own[np.not_equal(*ranges(steps[[0, -1]]))]  # the others say the same of all these steps
        value = log_likelihoods(steps)
        likely = np.flatnonzero(value > value.max() - UNLIKELY)
        steps = np.linspace(steps[max(likely[0] - 1, 0)], steps[min(likely[-1] + 1, len(steps) - 1)], FINE_STEPS)
    value = log_likelihoods(steps)
    p = np.exp(value - value.max())
    inside = steps[p > np.exp(-UNLIKELY)].tolist()
    if gap < FARTHEST_END and inside[-1] == most and ground is not None:
        down = -float(normal @ ground.normal)
        slope, below = (slope, -gap) if down > NEARLY_LEVEL else (lowest_point(solid, -ground.normal), -gap * down)
        return End(most, 0.0, (inside[0], most), slope, below=max(below, 0.0))
    p /= p.sum()
    mean = float(p @ steps)
    std = float(np.sqrt(p @ (steps - mean) ** 2 + (steps[1] - steps[0]) ** 2 / 12))
    low, high = np.interp([SHARE_OUTSIDE / 2, 1 - SHARE_OUTSIDE / 2], np.cumsum(p), steps).tolist()
    if len(told):  # the beams next to the end tell of it where they pass
        next_to_it = np.searchsorted(growth[told], mean)
        beside = told[max(next_to_it - 1, 0) : next_to_it + 1]
        there = (o[beside] + lowest[beside, None] * d[beside]).mean(axis=0)
        slope = solid.speeds((there + FAR_OUT * normal)[None])[1][0]
    return End(mean, std, (low, high), slope, unbounded=most == FARTHEST_END == inside[-1])


def to_ground(solid: Solid, normal: Floats, ground: Plane) -> float:
    """Return by how much an end must grow until the solid touches the ground, metres; inf when it never does.

    An end that is level, or nearly, lies on the ground with its middle: its slope may be an error.
    """
    down = -float(normal @ ground.normal)
    if down <= FACES_GROUND:
        return np.inf
    reach = float(np.abs(solid.frame @ normal) @ solid.half) if down > NEARLY_LEVEL else solid.reach(ground.normal)
    return (float(ground.signed_distance(solid.center[None])[0]) - reach) / down


def lowest_point(solid: Solid, down: Floats) -> Floats:
    """Return by how much the point of a solid that lies farthest down goes down as each number grows."""

    def depth(step: Floats) -> float:
        moved = solid.moved(step)
        return float(moved.center @ down) + moved.reach(down)

    return np.array([(depth(step) - depth(-step)) / (2 * SMALL_STEP) for step in SMALL_STEP * np.eye(solid.numbers)])
