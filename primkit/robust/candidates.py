"""Explain: every shape that could have caused a cluster's points, and how well each explains them.

Circle or polygon, and how many sides? Each candidate is fitted as well as it can be, and the evidence ranks them.

In:  points of one cluster, shape (N, 2), metres, and how far points spread from outlines.
Out: ``Candidate`` explanations, the best first.

>>> ranked = candidates(Circle((0, 0), 0.05).outline(60), spread=0.0005, rng=0)
>>> ranked[0].kind, ranked[0].cost < ranked[1].cost
('circle', True)
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from ..arguments import Floats, as_rng
from ..circles import find_circle, nearer_circle
from ..lines import Line
from ..seen import REACH
from ..shapes import KINDS, Circle
from .evidence import Candidate, judged, judged_wall
from .free import free_outline
from .guess import guess_outlines, guess_rectangles, line_guesses, one_side_more, ransac_lines
from .lack_of_fit import lack_of_fit
from .outlines import Outlines, joined
from .refine import refine_hard, refine_soft, truncated_cost
from .scatter import GHOSTS, NOWHERE, OUTLINE_LENGTH, SIGMAS, scatter

LEAST_POINTS = 8  # fewer fix nothing: a pentagon alone has ten numbers
MOST_RADIUS = 0.25  # m: a larger circle than a quarter of the board is a wall
LEAST_ARC = np.radians(60)  # a shorter arc fits a wide range of circles
CANDIDATE_CIRCLE_TRIALS = 100  # with four fifths of the points on the circle, one sample in two is clean
CIRCLE_ROUNDS = 10  # after three or four, hardly a point changes its weight
SETTLED_MOVE = 1e-7  # m: what moves by less has settled; the next round moves it by a small part of that
ENOUGH_POINTS = 200  # more do not make a first fit much better, and cost time
STARTS_KEPT = 5  # of the guesses, those closest to the points are refined
WIDER = 0.005  # m: guesses are judged with a longer reach than fits, because they still lie beside the points
# m: beyond this spread a short side drowns in its neighbours' points when each is given to one side alone
BLURRED = 0.002
# A candidate that is this much worse (in cost) before the last polish is not going to win by it.
CONTENDER = 100.0
FITS, NEARLY_ALL = 10.0, 0.9  # lack of fit down to which a shape fits; share of the points, and of each side


def candidates(
    points: Floats,
    spread: float,
    *,
    soft: bool = True,
    rng: int | np.random.Generator | None = None,
    kinds: Sequence[str] = KINDS,
) -> list[Candidate]:
    """Return every explanation of a cluster's points, the best first.

    Parameters
    ----------
    points : array, shape (N, 2)
        Metres.
    spread : float
        Standard deviation of the points from the outline, metres.
    soft : bool
        Share points between sides in the last polish, as ``refine.refine_soft`` does.
    rng : int or numpy.random.Generator, optional
        Seed or generator.
    kinds : sequence of str
        The kinds that can be there.

    Returns
    -------
    list of Candidate
        A wall, a circle, and polygons of three to five sides, as far as each can be fitted, and where the best of
        them does not fit, the best outline of any straight pieces; empty for fewer than eight different points. Those
        that come near the best are fitted to the last digit.
    """
    if len(np.unique(points, axis=0)) < LEAST_POINTS:
        return []
    middle = points.mean(axis=0)
    local = points - middle  # digits are not lost far from the origin
    possible = ("wall", *kinds)
    rough = [c for c in _rough(local, spread, as_rng(rng)) if c.kind in possible]
    waiting = sorted(rough, key=lambda c: c.cost)
    done: list[Candidate] = []
    while waiting and waiting[0].cost <= min((c.cost for c in done), default=np.inf) + CONTENDER:
        polished = _polished(local, waiting.pop(0), spread, soft)
        done += [] if polished is None else [polished]
    ranked = sorted(done + waiting, key=lambda c: c.cost)
    if ranked and not _fits(local, ranked[0], spread):
        ranked = sorted([*ranked, *_free(local, spread)], key=lambda c: c.cost)
    return [moved(c, middle) for c in ranked if c.kind in possible]


def explained_again(
    points: Floats, before: Sequence[Candidate], spread: float, *, soft: bool = True
) -> list[Candidate]:
    """Return the best explanation and its best rival, fitted anew from what they were with fewer points.

    Parameters
    ----------
    points : array, shape (N, 2)
        Metres: those that were explained before, and a few more.
    before : sequence of Candidate
        What ``candidates`` returned for them.
    spread : float
        As for ``candidates``; so is the next.
    soft : bool
        Share points between sides.
    """
    shapes = [c for c in before if c.figure is not None]
    kept = shapes[:1] + [c for c in shapes if c.kind != shapes[0].kind][:1]
    middle = points.mean(axis=0)
    local, again = points - middle, list[Candidate]()
    for old in (moved(c, -middle) for c in kept):
        anew = judged(local, old.figure, spread, square=old.square) if again and old.figure is not None else None
        if anew is None or anew.cost < again[0].cost + CONTENDER:  # as in ``candidates``: no polish for far rivals
            anew = _polished(local, old, spread, soft)
        again += [] if anew is None else [anew]
    return [moved(c, middle) for c in sorted(again, key=lambda c: c.cost)]


def _rough(points: Floats, spread: float, rng: np.random.Generator) -> list[Candidate]:
    """Return the explanations that RANSAC and a few rounds of giving points back lead to, in any order.

    The fits are made on some of the points, where there are many; all of them judge.
    """
    some_rng, circle_rng, line_rng = rng.spawn(3)
    some, reach = points[some_rng.permutation(len(points))[:ENOUGH_POINTS]], SIGMAS * spread
    circle = find_circle(some, reach, trials=CANDIDATE_CIRCLE_TRIALS, rng=circle_rng)
    lines = ransac_lines(some, reach, rng=line_rng)
    found = [judged_wall(points, line, _length_along(points, line, reach), spread) for line in lines[:1]]
    if circle is not None and circle.radius <= MOST_RADIUS:
        found.append(judged(points, circle, spread))
    return found + [judged(points, o, spread, square=square) for o, square in _polygons(some, lines, spread)]


def free_candidate(points: Floats, spread: float) -> list[Candidate]:
    """Return the outline of any straight pieces, judged; nothing where the points do not close."""
    middle = points.mean(axis=0)
    return [moved(c, middle) for c in _free(points - middle, spread)]


def _fits(points: Floats, best: Candidate, spread: float) -> bool:
    """Tell whether nearly all points lie on the best explanation, all around, and without any order in their misses."""
    if best.figure is None or min(best.seen) < NEARLY_ALL or best.n_on < NEARLY_ALL * len(points):
        return False
    return lack_of_fit(points, best.figure, spread, square=best.square) >= FITS


def _free(points: Floats, spread: float) -> Iterator[Candidate]:
    """Yield the outline of any straight pieces."""
    outline = free_outline(points, spread)
    if outline is not None:
        yield judged(points, outline, spread)


def _polygons(points: Floats, lines: list[Line], spread: float) -> Iterator[tuple[Outlines, bool]]:
    """Yield the best outline of three, four and five sides, and the best with right angles, with whether it is that."""
    reach = SIGMAS * spread
    sides = line_guesses(points, lines, reach)
    fewer: Outlines | None = None  # the best with a side less
    for k in (3, 4, 5):
        guess = guess_outlines(points, sides, k, reach)
        if fewer is not None:
            guess = joined(guess, one_side_more(points, fewer))
        if k == 4:
            upright = refined(points, guess_rectangles(points, sides, guess), spread, square=True)
            if upright is not None:
                yield upright, True
        fewer = refined(points, guess, spread, square=False)
        if fewer is not None:
            yield fewer, False


def refined(points: Floats, guess: Outlines, spread: float, *, square: bool) -> Outlines | None:
    """Refine the guesses that lie closest to the points, and return the best one; None without a sound one."""
    reach = SIGMAS * spread
    near = guess[np.argsort(truncated_cost(points, guess, reach + WIDER), kind="stable")]
    fits = refine_hard(points, near[:STARTS_KEPT], reach, square=square)
    fits = fits[fits.sound()]
    if len(fits):
        best = int(np.argmin(truncated_cost(points, fits, reach)))
        return fits[best : best + 1]
    sound = near[near.sound()]
    if spread < BLURRED or len(sound) == 0:
        return None
    return refine_soft(points, sound[:1], spread, square=square)


def _polished(points: Floats, rough: Candidate, spread: float, soft: bool) -> Candidate | None:
    """Fit a candidate to the last digit; None for a circle that is none."""
    if rough.figure is None:
        return rough
    done = polished(points, rough.figure, spread, soft=soft, square=rough.square)
    return rough if done is None and isinstance(rough.figure, Outlines) else done


def polished(
    points: Floats, figure: Circle | Outlines, spread: float, *, soft: bool = True, square: bool = False
) -> Candidate | None:
    """Return a figure near its solution, fitted to the last digit and judged; None where that leads nowhere."""
    if isinstance(figure, Circle):
        circle = _polished_circle(points, figure, spread)
        return None if circle is None else _unless_short(judged(points, circle, spread), circle)
    if not figure.sound()[0]:
        return judged(points, figure, spread)  # a free outline is as good as it gets
    if soft:
        fit = refine_soft(points, figure, spread, square=square)
    else:
        fit = refine_hard(points, figure, SIGMAS * spread, square=square)
    return judged(points, fit, spread, square=square) if fit.sound()[0] else None


def _length_along(points: Floats, line: Line, reach: float) -> float:
    """Return over what length a line's points lie, metres."""
    near = points[np.abs(line.signed_distance(points)) <= reach]
    return float(np.ptp(near @ line.direction)) if len(near) else 0.0


def _unless_short(candidate: Candidate, circle: Circle) -> Candidate | None:
    """Return the candidate, or None when too short an arc of its circle was seen to tell the radius."""
    ends = 2 * REACH if candidate.length < circle.perimeter * (1 - 1e-9) else 0.0  # an arc looks longer by this
    return candidate if (candidate.length - ends) / circle.radius >= LEAST_ARC else None


def _polished_circle(points: Floats, circle: Circle, spread: float) -> Circle | None:
    """Return the geometric fit in which points from nowhere do not count; None when it grows beyond a board."""
    for _ in range(CIRCLE_ROUNDS):
        across, told = scatter(circle.signed_distance(points), spread)
        density = (1 - GHOSTS) * across / OUTLINE_LENGTH
        fitted = nearer_circle(circle, points, told * density / (density + NOWHERE))
        if fitted is None or fitted.radius > MOST_RADIUS:
            return None
        change = max(abs(fitted.radius - circle.radius), *np.abs(fitted.center - circle.center).tolist())
        circle = fitted
        if change <= SETTLED_MOVE:
            break
    return circle


def moved(candidate: Candidate, offset: Floats) -> Candidate:
    """Return the candidate, shifted by ``offset``, shape (2,), metres."""
    figure = candidate.figure
    if isinstance(figure, (Circle, Outlines)):
        figure = figure.moved(offset)
    return replace(candidate, figure=figure)
