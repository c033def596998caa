"""Glance: one simple shape that explains all points, so well that no other kind could.

Most outlines are seen all around, and leave no doubt. Then it is a waste to fit every kind and let the evidence decide:
from how well points lie on the best circle, and on the best three, four or five straight pieces, follows about the
least that each kind can cost. The simplest kind whose bound is small is fitted. If what it really costs is less than
the bounds of all others, it has won, and they need not be fitted: this is "branch and bound". A rival with more sides,
for which pieces say little, is fitted where its bound does not exclude it. Else ``explain`` looks for all.

The bounds are no theorem: they suppose that an outline is farthest from its middle near a corner. So a shape must be
well ahead of them; ``tests/test_glance.py`` holds what a glance says against thorough fitting.

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

from ..arguments import Floats
from ..circles import fit_circle
from ..shapes import Circle
from .candidates import BLURRED, CONTENDER, moved, polished, refined
from .evidence import NAMELESS_COST, OF_CIRCLE, OF_FREE_SIDES, OF_SQUARE, Candidate, judged, price
from .guess import one_side_more
from .lack_of_fit import lack_of_fit
from .outlines import Outlines, joined
from .refine import refine_hard
from .scatter import SIGMAS
from .starts import Cut, best_cuts

ENOUGH = 60  # points; fewer leave too much room for doubt
ALL_AROUND = 0.9  # share of each side that must have been seen
NEARLY_ALL_POINTS = 0.98  # share of the points that must lie on the shape, once strays are left out
MOST_OF_ALL = 0.9  # share of the points that must be left then
LOOKS = 3  # so many times strays are left out
STRAY = 20.0  # cost of a point that comes from nowhere, and not from the outline, at most
# Pieces that are free to be anywhere come closer than sides that meet in corners: a simple shape is fitted first even
# if its bound is so many times the least.
ROUGHLY = 2.0
FAR = 10.0  # no circle needs to be fitted if its bound is even so many times the least
OWN_POINTS = 8  # of each side: a side with fewer could as well be a few strays
CERTAIN = 10.0  # by so much a shape must be ahead: very strong evidence (Kass and Raftery, 1995)
# A triangle fills at most half of a rectangle. So their outlines part by 0.27 of the triangle's incircle's radius (root
# mean square, the least over all triangles and rectangles; found numerically); half of that allows for uneven points.
APART = 0.135
# Five straight pieces miss a circle by 0.059 of its radius (chords over a fifth of it each); half of that, likewise.
BENT = 0.03
ASTRAY = 10.0  # spreads; a triangle that misses the points by more in the mean does not explain them, few strays or not


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
        The one that ``explain.candidates`` ranks first, to a few hundredths of a millimetre. None if points are few
        or blurred, many are strays, a stretch was not seen, or another kind could explain the points as well.
    """
    if len(points) < ENOUGH or spread > BLURRED:
        return None
    middle = points.mean(axis=0)
    local = points - middle  # digits are not lost far from the origin
    fit = _first_fit(local, spread)
    if fit is None:
        return None
    best = polished(local, fit.figure, spread, soft=soft, square=fit.way.square)
    if best is None or best.figure is None or min(best.seen) < ALL_AROUND:
        return None
    if lack_of_fit(local, best.figure, spread, square=best.square) < CERTAIN:
        return None  # none of the kinds may do
    if any(_comes_near(local, rival, best, spread, soft) for rival in fit.rivals):
        return None
    return moved(best, middle)


def at_another_glance(points: Floats, before: Candidate, spread: float, *, soft: bool = True) -> Candidate | None:
    """Return what was told at a glance, fitted anew to a few points more; None where it should be looked at anew.

    What was beyond doubt stays so while nearly all points lie on it.

    Parameters
    ----------
    points : array, shape (N, 2)
        Metres: those that ``at_a_glance`` saw, and a few more.
    before : Candidate
        What it returned for them.
    spread, soft
        As for ``at_a_glance``.
    """
    middle = points.mean(axis=0)
    local, figure = points - middle, moved(before, -middle).figure
    best = None if figure is None else polished(local, figure, spread, soft=soft, square=before.square)
    if best is None or best.figure is None or min(best.seen) < ALL_AROUND:
        return None
    on_it = np.abs(_distances(local, best.figure, spread)[0]) <= SIGMAS * spread
    return moved(best, middle) if on_it.mean() >= NEARLY_ALL_POINTS else None


@dataclass(frozen=True, eq=False)
class _Way:
    """One way to explain the points: a first guess, its fitted numbers, and the least that it can cost.

    The guess is None for a circle that was not fitted, because straight pieces come too close for that.
    """

    guess: Circle | Cut | None
    square: bool
    fitted: Floats
    least: float


@dataclass(frozen=True, eq=False)
class _Fit:
    """A way with its figure, and those with more sides that may come near it."""

    way: _Way
    figure: Circle | Outlines
    rivals: list[_Way]


def _first_fit(points: Floats, spread: float) -> _Fit | None:
    """Return the simplest way whose bound is small, fitted; None where it does not explain the points beyond doubt.

    Strays lead the cuts astray: where the fit leaves points out, all is done once more without them.
    """
    kept = points
    for _ in range(LOOKS):
        cuts = best_cuts(kept)
        if len(cuts) < 3:
            return None
        ways = _ways(kept, cuts, spread)
        first, figure = _simplest(kept, ways, spread)
        if figure is None:
            return None
        distance, own = _distances(kept, figure, spread)
        on_it = np.abs(distance) <= SIGMAS * spread
        if on_it.mean() >= NEARLY_ALL_POINTS:
            break
        kept = kept[on_it]
        if len(kept) < max(ENOUGH, MOST_OF_ALL * len(points)):
            return None
    else:
        return None
    cost = _cost(float((distance**2).sum()), first.fitted, len(kept), spread)
    enough = cost + CERTAIN + STRAY * (len(points) - len(kept))  # a rival may explain what this one leaves out
    rivals = [way for way in ways if way is not first and way.least < enough]
    n_numbers = np.inf if isinstance(figure, Circle) else len(first.fitted)
    simpler = any(len(rival.fitted) <= n_numbers for rival in rivals)
    return None if simpler or own < OWN_POINTS else _Fit(first, figure, rivals)


def _ways(points: Floats, cuts: dict[int, Cut], spread: float) -> list[_Way]:
    """Return all ways to explain the points, the simplest first, each with the least that it can cost."""
    n = len(points)
    upright_squares = max(cuts[4].squares, n * _apart(cuts[3], n, spread) ** 2)
    least = {k: _cost(cuts[k].squares, OF_FREE_SIDES[k], n, spread) for k in cuts}
    straight = [
        _Way(cuts[4], True, OF_SQUARE, _cost(upright_squares, OF_SQUARE, n, spread)),
        _Way(cuts[3], False, OF_FREE_SIDES[3], least[3]),
        _Way(cuts[4], False, OF_FREE_SIDES[4], least[4] + NAMELESS_COST),
        _Way(cuts[5], False, OF_FREE_SIDES[5], least[5]),
    ]
    return [_round(points, cuts[5], min(way.least for way in straight), spread), *straight]


def _round(points: Floats, five: Cut, least: float, spread: float) -> _Way:
    """Return the circle's way, fitted where the best five pieces and the least cost of straight ways leave it room."""
    n, circle = len(points), None
    radius = float(np.sqrt((points**2).sum() / n))
    squares = n * max(0.0, BENT * radius - float(np.sqrt(five.squares / n))) ** 2
    if _cost(squares, OF_CIRCLE, n, spread) <= FAR * least:
        circle = fit_circle(points, "taubin")
        squares = np.inf if circle is None else float((circle.signed_distance(points) ** 2).sum())
    return _Way(circle, False, OF_CIRCLE, _cost(squares, OF_CIRCLE, n, spread))


def _cost(squares: float, fitted: Floats, n_points: int, spread: float) -> float:
    """Return what a fit costs whose points lie so far from it, up to what all fits to these points share."""
    return squares / spread**2 + price(fitted, n_points, spread)


def _apart(triangle: Cut, n_points: int, spread: float) -> float:
    """Return by how much any rectangle must miss points on this triangle, as a root mean square, metres.

    That is asked only where the triangle explains the points: else others are nearer than it is.
    """
    missed = float(np.sqrt(triangle.squares / n_points))
    if missed > ASTRAY * spread or not triangle.outline.sound()[0]:
        return 0.0
    outline = triangle.outline
    begin, end = outline.spans()
    incircle = float(np.average(outline.offsets, weights=end - begin))  # twice the area over the perimeter
    return max(0.0, APART * incircle - missed)


def _fitted(points: Floats, way: _Way, spread: float) -> Circle | Outlines | None:
    """Return a way's figure, near enough for a last polish; None where there is none."""
    if not isinstance(way.guess, Cut):
        return way.guess  # Taubin's circle is as good as that
    figure = way.guess.outline  # the best line of each piece
    if way.square or not figure.sound()[0]:
        figure = refine_hard(points, way.guess.upright if way.square else figure, SIGMAS * spread, square=way.square)
    return figure if figure.sound()[0] else None


def _simplest(points: Floats, ways: list[_Way], spread: float) -> tuple[_Way, Circle | Outlines | None]:
    """Return the simplest way whose bound is small and that can be fitted, and its figure; None where there is none."""
    least = min(way.least for way in ways)
    first = next(way for way in ways if way.least <= ROUGHLY * least)
    figure = _fitted(points, first, spread)
    if figure is not None or len(ways) == 1:
        return first, figure
    return _simplest(points, [way for way in ways if way is not first], spread)


def _distances(points: Floats, figure: Circle | Outlines, spread: float) -> tuple[Floats, int]:
    """Return each point's distance from the figure, and how many points lie on that side which has the fewest."""
    if isinstance(figure, Circle):
        return figure.signed_distance(points), len(points)
    r = figure.distances(points)[0]
    distance = r.max(axis=1)
    own = np.bincount(r.argmax(axis=1)[np.abs(distance) <= SIGMAS * spread].astype(np.intp), minlength=r.shape[1])
    return distance, int(own.min())


def _comes_near(points: Floats, rival: _Way, best: Candidate, spread: float, soft: bool) -> bool:
    """Tell whether a rival with more sides costs hardly more than the best, when it is fitted.

    Pieces need not bend, so that their bound says little about a side too many. ``explain`` fits it in the same way.
    """
    assert isinstance(rival.guess, Cut)
    assert isinstance(best.figure, Outlines)
    guess = rival.guess.outline
    if guess.angles.shape[1] == best.figure.angles.shape[1] + 1:
        guess = joined(guess, one_side_more(points, best.figure))
    figure = refined(points, guess, spread, square=False)
    if figure is None:
        return False
    cost = judged(points, figure, spread).cost
    if best.cost + CERTAIN < cost < best.cost + CONTENDER:
        finest = polished(points, figure, spread, soft=soft)
        cost = cost if finest is None else finest.cost
    return cost < best.cost + CERTAIN
