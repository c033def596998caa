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
from ..seen import REACH, seen_shares, shares_of_sides
from ..shapes import Circle, Kind, Shape
from .outlines import Outlines
from .refine import shares
from .scatter import GHOSTS, NOWHERE, OUTLINE_LENGTH, SIGMAS, depth_of, scatter

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

# How uncertain N even points leave each fitted number, as a variance in units of spread^2 / N: a circle's centre and
# radius; a side's offset and its angle (as a length, at the side's ends); a rectangle's four offsets and one angle; a
# wall's offset, angle and ends.
OF_CIRCLE = np.array([2.0, 2.0, 1.0])
OF_SIDE = np.array([1.0, 3.0])
OF_SQUARE = np.array([4.0, 4.0, 4.0, 4.0, 3.0])
OF_WALL = np.array([1.0, 3.0, 1.0, 1.0])


Figure = Circle | Outlines | Line


@dataclass(frozen=True, eq=False)
class Candidate:
    """One explanation of a cluster.

    Parameters
    ----------
    figure : Circle, Outlines (one row) or Line
        What the points would lie on; a line is that of a bare wall.
    square : bool
        Whether an outline of four sides keeps right angles.
    cost : float
        -2 times the logarithm of the evidence; smaller is better.
    length : float
        How much of the outline was seen, metres.
    n_on : float
        How many of the points lie on it; doubtful ones count in part.
    seen : tuple of float
        The share of each side (or of the whole circle) that has points near it; empty for a wall.
    nameless : float
        What of the cost is owed to its being none of the board's kinds.
    """

    figure: Figure
    square: bool
    cost: float
    length: float
    n_on: float
    seen: tuple[float, ...] = ()
    nameless: float = 0.0

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
    """Return a fitted figure with its cost; of a bare wall, the back was not seen.

    Parameters
    ----------
    points : array, shape (N, 2)
        Of the whole cluster, metres.
    figure : Circle, Outlines (one row) or Line
        The fit.
    spread : float
        Standard deviation of the points from the outline, metres.
    square : bool
        Whether four sides were fitted with right angles.
    """
    if isinstance(figure, Line):
        on_it, log_likelihood = _along_smooth(figure.signed_distance(points), spread)
        length = _length_along(points, figure, SIGMAS * spread)
        cost = _cost(log_likelihood, OF_WALL, len(points), spread) + _length_cost(on_it, length)
        return Candidate(figure, False, cost + UNSEEN_COST * length, length, on_it)
    distance = figure.signed_distance(points) if isinstance(figure, Circle) else figure.distance(points)[0]
    own = points[np.abs(distance) <= SIGMAS * spread]
    if isinstance(figure, Circle):
        lengths, fitted, seen = np.array([figure.perimeter]), OF_CIRCLE, seen_shares(figure, own)
        on_it, log_likelihood = _along_smooth(distance, spread)
    else:
        (corners,), (after,) = figure.ends()
        lengths, seen = np.hypot(*(after - corners).T), shares_of_sides(corners, after, own)
        fitted = OF_SQUARE if square else of_sides(len(corners))
        share, _, each = shares(points, figure, spread)
        on_it, log_likelihood = float(share.sum()), float(each[0])
    length = float(lengths @ np.array(seen))
    cost = _cost(log_likelihood, fitted, len(points), spread) + _length_cost(on_it, length)
    cost += UNSEEN_COST * float(lengths.sum() - length) + INSIDE_COST * _inside(distance, spread)
    named = isinstance(figure, Circle) or square or (figure.kind != "polygon" and len(lengths) != 4)
    nameless = 0.0 if named else NAMELESS_COST if min(seen) >= NEARLY_ALL else NAMELESS_PART_COST
    return Candidate(figure, square, cost + nameless, length, on_it, seen, nameless)


@lru_cache
def of_sides(k: int) -> Floats:
    """Return the variances of k sides that are fitted each for itself: a side has a kth of the points."""
    return np.tile(OF_SIDE * k, k)


def price(fitted: Floats, n_points: int, spread: float) -> float:
    """Return what the fitted numbers cost: each the logarithm of how far the points narrow it down.

    The sum of ln(1 + N w^2 / (v s^2)) over the numbers, with N points, the spread s, the width w of what was known of
    each number beforehand, ``PRIOR_WIDTH``, and the variance v of each in units of s^2 / N.
    """
    return float(np.log1p(n_points * PRIOR_WIDTH**2 / (fitted * spread**2)).sum())


def joint_cost(candidates: Sequence[Candidate]) -> float:
    """Return the cost of explaining several clusters by a candidate each, all seen equally densely.

    Two halves of an outline have half the length each, but no denser points than the whole: what counts is the
    length of all.
    """
    n_on, length = sum(c.n_on for c in candidates), sum(c.length for c in candidates)
    together = _length_cost(n_on, length) - sum(_length_cost(c.n_on, c.length) for c in candidates)
    return sum(c.cost for c in candidates) + together


def _inside(distance: Floats, spread: float) -> int:
    """Return how many points deep inside an outline count: not those that may be strays, as there are outside."""
    depth = depth_of(spread)
    n_inside, n_outside = np.count_nonzero(distance < -depth), np.count_nonzero(distance > depth)
    return int(np.clip(n_inside - n_outside, 0, MOST_INSIDE))


def _length_along(points: Floats, line: Line, reach: float) -> float:
    """Return over what length a line's points lie, metres."""
    near = points[np.abs(line.signed_distance(points)) <= reach]
    return float(np.ptp(near @ line.direction)) if len(near) else 0.0


def _along_smooth(distance: Floats, spread: float) -> tuple[float, float]:
    """Return how many points lie on an outline without corners, and the logarithm of how likely they all are.

    The model is that of ``refine.shares``.
    """
    on_it = (1 - GHOSTS) * scatter(distance, spread)[0] / OUTLINE_LENGTH
    total = on_it + NOWHERE
    return float((on_it / total).sum()), float(np.log(total).sum())


def _cost(log_likelihood: float, fitted: Floats, n_points: int, spread: float) -> float:
    """Return -2 times the logarithm of the evidence: -2 ln L + price (Laplace's approximation; MacKay, 1992)."""
    return -2 * log_likelihood + price(fitted, n_points, spread)


def _length_cost(n_on: float, length: float) -> float:
    """Return what is added for n points spread evenly over ``length`` metres, and not over ``OUTLINE_LENGTH``."""
    return float(2 * n_on * np.log(max(length, REACH) / OUTLINE_LENGTH))
