"""Evidence: what speaks for a shape, and what against it.

A pentagon can follow noise further than a circle or a square: it has more numbers to adjust. So a shape is
charged for every number that had to be fitted, for the length over which it spreads its points, and for what was not
seen of it. What remains is the evidence, and it decides.

In:  the points of one cluster, shape (N, 2), metres, a figure fitted to them, and how far points spread from outlines.
Out: a ``Candidate``: the figure with its cost; the smallest cost wins.

>>> ring = Circle((0, 0), 0.05).outline(60)
>>> judged(ring, Circle((0, 0), 0.05), 0.0005).cost < judged(ring, Circle((0, 0), 0.051), 0.0005).cost
True

Source: MacKay (1992), "Bayesian interpolation". The evidence is a relative of the BIC of Schwarz (1978), "Estimating
the dimension of a model", which leaves out how much was known beforehand.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Literal

import numpy as np

from ..arguments import Floats
from ..lines import Line
from ..seen import REACH, seen_shares, shares_along
from ..shapes import Circle, Kind, Shape
from .outlines import Outlines
from .refine import shares
from .scatter import OUTLINE_LENGTH, SIGMAS, depth_of, shares_smooth

# What is supposed before the points are looked at. Each number of a shape is known to about a centimetre. An outline
# is seen nearly all around: each metre that was not seen is as unlikely as one in e^40. And an outline that is none of
# the board's kinds is one in e^4, if it was seen all around, and else one in e^10.
PRIOR_WIDTH = 0.01
UNSEEN_COST = 80.0
NAMELESS_COST, NAMELESS_PART_COST = 8.0, 20.0
# No beam gets inside: the cost of each point there beyond those that lie outside, which are strays; more are not seen
# through a mouth.
INSIDE_COST, MOST_INSIDE = 10.0, 5
# So much ahead is very strong evidence (Kass and Raftery, 1995); so large a share of points or of a side is nearly all.
CERTAIN, NEARLY_ALL = 10.0, 0.9


Figure = Circle | Outlines | Line
Way = tuple[int, bool]  # number of a figure's sides, 0 of a circle and 1 of a wall; and whether at right angles


@dataclass(frozen=True, eq=False)
class Candidate:
    """One explanation of a cluster."""

    figure: Figure
    square: bool
    cost: float  # -2 times the logarithm of the evidence; smaller is better
    length: float  # how much of the outline was seen
    n_on: float  # how many of the points lie on it; doubtful ones count in part
    seen: tuple[float, ...] = ()  # the share of each side, or of the whole circle, with points near it; () of a wall
    nameless: float = 0.0  # what of the cost is owed to its being none of the board's kinds

    @cached_property
    def shape(self) -> Shape | None:
        """The figure as a shape; None for a bare wall."""
        if isinstance(self.figure, Outlines):
            return self.figure.polygon()
        return self.figure if isinstance(self.figure, Circle) else None

    @property
    def kind(self) -> Kind | Literal["wall"]:
        """The shape's kind, or ``"wall"``."""
        if isinstance(self.figure, Outlines):
            return self.figure.kind
        return "circle" if isinstance(self.figure, Circle) else "wall"

    def moved(self, offset: Floats) -> Candidate:
        """Return the candidate, shifted by ``offset``, shape (2,), metres."""
        return replace(self, figure=self.figure.moved(offset))


def judged(points: Floats, figure: Figure, spread: float, *, square: bool = False) -> Candidate:
    """Return a figure that was fitted to a cluster's points with its cost; of a bare wall, the back was not seen."""
    distance = figure.signed_distance(points)
    near = np.abs(distance) <= SIGMAS * spread
    if isinstance(figure, Outlines):
        share, _, (log_likelihood,) = shares(points, figure, spread)
    else:
        share, _, log_likelihood = shares_smooth(distance, spread)
    n_on = float(share.sum())
    if isinstance(figure, Line):
        length = float(np.ptp(points[near] @ figure.direction)) if near.any() else 0.0
        cost = price((1, False), len(points), spread) - 2 * log_likelihood + _length_cost(n_on, length)
        return Candidate(figure, False, cost + UNSEEN_COST * length, length, n_on)
    if isinstance(figure, Circle):
        way, lengths, seen = (0, False), np.array([figure.perimeter]), seen_shares(figure, points[near])
    else:
        begin, end = figure.spans()
        way, lengths = (figure.angles.shape[1], square), (end - begin)[0]
        along, across = figure.along(points) - begin[:, None], figure.distances(points)
        seen = shares_along(along[0, near].T, across[0, near].T, lengths)
    length = float(lengths @ np.array(seen))
    cost = price(way, len(points), spread) - 2 * float(log_likelihood) + _length_cost(n_on, length)
    n_inside, n_outside = (np.count_nonzero(side * distance > depth_of(spread)) for side in (-1, 1))
    inside = int(np.clip(n_inside - n_outside, 0, MOST_INSIDE))  # without as many as are strays outside
    cost += UNSEEN_COST * float(lengths.sum() - length) + INSIDE_COST * inside
    named = isinstance(figure, Circle) or square or (figure.kind != "polygon" and len(lengths) != 4)
    nameless = 0.0 if named else NAMELESS_COST if min(seen) >= NEARLY_ALL else NAMELESS_PART_COST
    return Candidate(figure, square, cost + nameless, length, n_on, seen, nameless)


@lru_cache
def _variances(way: Way) -> Floats:
    """Return how uncertain N even points leave each fitted number, as a variance in units of spread^2 / N.

    A circle has a centre and a radius; a wall an offset, an angle (as a length, at its ends) and two ends; each of k
    sides an offset and an angle by a kth of the points; at right angles four have one angle.
    """
    k, square = way
    if k <= 1:
        return np.array([[2.0, 2.0, 1.0], [1.0, 3.0, 1.0, 1.0]][k])
    return np.array([4.0, 4.0, 4.0, 4.0, 3.0]) if square else np.tile([1.0 * k, 3.0 * k], k)


def price(way: Way, n_points: int, spread: float) -> float:
    """Return what the fitted numbers cost: each the logarithm of how far the points narrow it down.

    The sum of ln(1 + N w^2 / (v s^2)) over the numbers, with N points, the spread s, the width w of what was known of
    each number beforehand, ``PRIOR_WIDTH``, and the variance v of each in units of s^2 / N. Together with -2 times the
    logarithm of the likelihood that is Laplace's approximation of the evidence (MacKay, 1992).
    """
    return float(np.log1p(n_points * PRIOR_WIDTH**2 / (_variances(way) * spread**2)).sum())


def joint_cost(candidates: Sequence[Candidate]) -> float:
    """Return the cost of explaining several clusters by a candidate each, all seen equally densely.

    Two halves of an outline have half the length each, but no denser points than the whole: what counts is the
    length of all.
    """
    n_on, length = sum(c.n_on for c in candidates), sum(c.length for c in candidates)
    together = _length_cost(n_on, length) - sum(_length_cost(c.n_on, c.length) for c in candidates)
    return sum(c.cost for c in candidates) + together


def _length_cost(n_on: float, length: float) -> float:
    """Return what is added for n points spread evenly over ``length`` metres, and not over ``OUTLINE_LENGTH``."""
    return float(2 * n_on * np.log(max(length, REACH) / OUTLINE_LENGTH))
