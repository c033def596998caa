"""Glance: one simple shape that explains all points, so well that no other kind could.

Most outlines are seen all around, and leave no doubt. Then it is a waste to fit every kind and let the evidence decide:
from how well points could lie on *any* circle, and on any three, four or five straight pieces, follows the least that
each kind can cost. The simplest kind whose bound is small is fitted. If what it really costs is less than the bounds
of all others, it has won, and they need not be fitted: this is "branch and bound". Else ``explain`` looks for all.

In:  points of one cluster, shape (N, 2), metres, and how far points spread from outlines.
Out: a ``Candidate``; or ``None``, where a glance does not tell.

>>> from primkit.shapes import Circle
>>> ring = Circle((0.3, 0.1), 0.05).outline(100)
>>> at_a_glance(ring, 0.0005).kind
'circle'
>>> at_a_glance(ring[:70], 0.0005) is None
True

Source: Land and Doig (1960), "An automatic method of solving discrete programming problems".
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .circles import fit_circle
from .evidence import CROOKED_COST, OF_CIRCLE, OF_SIDE, OF_SQUARE, Candidate, price
from .explain import moved, polished
from .guess import QUARTERS
from .outlines import Outlines
from .pieces import Cut, best_cuts
from .refine import refine_hard
from .scatter import SIGMAS
from .shapes import Circle

Floats = NDArray[np.float64]

ENOUGH = 60  # points; fewer leave too much room for doubt
ALL_AROUND = 0.9  # share of each side that must have been seen
NEARLY_ALL = 0.98  # share of the points that must lie on the shape: strays are not weighed here
# The cuts lie at knots and not quite in the corners, which costs a simple shape up to so many times what it should: it
# is fitted first all the same.
ROUGHLY = 2.0
OWN_POINTS = 8  # of each side: a side with fewer could as well be a few strays
CERTAIN = 10.0  # by so much a shape must be ahead: very strong evidence (Kass and Raftery, 1995)
# A triangle fills at most half of a rectangle. So their outlines part by 0.27 of the triangle's incircle's radius (root
# mean square, the least over all triangles and rectangles; found numerically); half of that allows for uneven points.
APART = 0.135


def at_a_glance(points: Floats, spread: float, *, soft: bool = True) -> Candidate | None:
    """Return the explanation of a cluster's points if it is beyond doubt.

    Parameters
    ----------
    points : array, shape (N, 2)
        Metres, no point twice.
    spread : float
        Standard deviation of the points from the outline, metres.
    soft : bool
        Share points between sides in the last polish, as ``refine.refine_soft`` does.

    Returns
    -------
    Candidate or None
        The one that ``explain.candidates`` ranks first, to a few hundredths of a millimetre. None if points are few,
        some are strays, a stretch was not seen, or another kind could explain the points as well.
    """
    if len(points) < ENOUGH:
        return None
    middle = points.mean(axis=0)
    local = points - middle  # digits are not lost far from the origin
    circle, cuts = fit_circle(local, "taubin"), best_cuts(local)
    if circle is None or len(cuts) < 3:
        return None
    ways = _ways(local, circle, cuts, spread)
    least = min(way.least for way in ways)
    first = next(way for way in ways if way.least <= ROUGHLY * least)
    figure = _fitted(local, first, spread)
    if figure is None or not _beyond_doubt(local, figure, first, ways, spread):
        return None
    best = polished(local, figure, spread, soft=soft, square=first.square)
    return moved(best, middle) if best is not None and min(best.seen) >= ALL_AROUND else None


@dataclass(frozen=True, eq=False)
class _Way:
    """One way to explain the points: a first guess, its fitted numbers, and the least that it can cost."""

    guess: Circle | Outlines
    square: bool
    fitted: Floats
    least: float


def _ways(points: Floats, circle: Circle, cuts: dict[int, Cut], spread: float) -> list[_Way]:
    """Return all ways to explain the points, the simplest first, each with the least that it can cost."""
    n = len(points)
    upright = Outlines(cuts[4].outline.angles[:, :1] + QUARTERS, cuts[4].outline.offsets)
    upright_squares = max(cuts[4].squares, n * _apart(cuts[3], n) ** 2)
    free = {k: np.tile(OF_SIDE * k, k) for k in cuts}
    least = {k: _cost(cuts[k].squares, free[k], n, spread) for k in cuts}
    round_squares = float((circle.signed_distance(points) ** 2).sum())
    return [
        _Way(circle, False, OF_CIRCLE, _cost(round_squares, OF_CIRCLE, n, spread)),
        _Way(upright, True, OF_SQUARE, _cost(upright_squares, OF_SQUARE, n, spread)),
        _Way(cuts[3].outline, False, free[3], least[3]),
        _Way(cuts[4].outline, False, free[4], least[4] + CROOKED_COST),
        _Way(cuts[5].outline, False, free[5], least[5]),
    ]


def _cost(squares: float, fitted: Floats, n_points: int, spread: float) -> float:
    """Return what a fit costs whose points lie so far from it, up to what all fits to these points share."""
    return squares / spread**2 + price(fitted, n_points, spread)


def _apart(triangle: Cut, n_points: int) -> float:
    """Return by how much any rectangle must miss points on this triangle, as a root mean square, metres."""
    if not triangle.outline.sound()[0]:
        return 0.0
    polygon = triangle.outline.polygon()
    incircle = 2 * polygon.area / polygon.perimeter
    return max(0.0, APART * incircle - float(np.sqrt(triangle.squares / n_points)))


def _fitted(points: Floats, way: _Way, spread: float) -> Circle | Outlines | None:
    """Return the figure with the least squares near a way's guess; None where there is none."""
    if isinstance(way.guess, Circle):
        return way.guess  # Taubin's is as good as that
    figure = refine_hard(points, way.guess, SIGMAS * spread, square=way.square)
    return figure if figure.sound()[0] else None


def _beyond_doubt(points: Floats, figure: Circle | Outlines, first: _Way, ways: list[_Way], spread: float) -> bool:
    """Tell whether the figure explains nearly all points, and costs less than any other can."""
    if isinstance(figure, Circle):
        distance, owner, n_sides = figure.signed_distance(points), np.zeros(len(points), dtype=np.intp), 1
    else:
        r = figure.distances(points)[0]
        distance, owner, n_sides = r.max(axis=1), r.argmax(axis=1), r.shape[1]
    on_it = np.abs(distance) <= SIGMAS * spread
    if on_it.mean() < NEARLY_ALL or np.bincount(owner[on_it], minlength=n_sides).min() < OWN_POINTS:
        return False
    cost = _cost(float((distance**2).sum()), first.fitted, len(points), spread)
    return all(cost + CERTAIN <= other.least for other in ways if other is not first)
