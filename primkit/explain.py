"""Explain: every shape that could have caused a cluster's points, and how well each explains them.

Circle or polygon, and how many sides? Each candidate is fitted as well as it can be. One with more sides always lies
closer to the points; so each is also charged for every number that had to be fitted, and for what was not seen.

In:  points of one cluster, shape (N, 2), metres, and how far points spread from outlines.
Out: ``Candidate`` explanations, the best first.

>>> ranked = candidates(Circle((0, 0), 0.05).outline(60), spread=0.0005, rng=0)
>>> ranked[0].kind, ranked[0].cost < ranked[1].cost
('circle', True)

Source: the criterion is the evidence, MacKay (1992), "Bayesian interpolation". It is a relative of the BIC of Schwarz
(1978), "Estimating the dimension of a model", which leaves out how much was known beforehand.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from .arguments import as_rng
from .circles import find_circle, fit_circle
from .guess import guess_outlines, guess_rectangles, line_guesses
from .lines import find_lines
from .outlines import Outlines
from .refine import GHOST_AREA, GHOSTS, OUTLINE_LENGTH, refine_hard, refine_soft, shares, truncated_cost
from .shapes import KINDS, Circle, Polygon, Shape

Floats = NDArray[np.float64]

SIGMAS = 3.0  # a point within three standard deviations may belong to a shape
LEAST_POINTS = 8  # fewer fix nothing: a pentagon alone has ten numbers
MOST_RADIUS = 0.25  # m: a larger circle than a quarter of the board is a wall
LEAST_ARC = np.radians(60)  # a shorter arc fits a wide range of circles
GAP = 0.012  # m: a stretch of outline within this of a point counts as seen

STEPS_PER_SIDE = 50  # a side is looked at in so many places, a circle in four times as many

CIRCLE_TRIALS = 100  # with four fifths of the points on the circle, one sample in two is clean
CIRCLE_ROUNDS = 4  # after two, hardly a point changes its weight
WALL_TRIALS = 100  # a wall has nearly all points on it, or it is none
STARTS_KEPT = 5  # of the guesses, those closest to the points are refined
WIDER = 0.005  # m: guesses are judged with a longer reach than fits, because they still lie beside the points
# What is supposed before the points are looked at. Each number of a shape is known to about a centimetre. An outline
# is seen nearly all around: each metre that was not seen is as unlikely as one in e^40. And four sides without right
# angles are none of the board's shapes: one in e^10.
PRIOR_WIDTH = 0.01
UNSEEN_COST = 80.0
CROOKED_COST = 20.0
# A candidate that is this much worse (in cost) before the last polish is not going to win by it.
CONTENDER = 100.0


@dataclass(frozen=True, eq=False)
class Candidate:
    """One explanation of a cluster.

    Parameters
    ----------
    figure : Circle, Outlines (one row) or None
        What the points would lie on; None for a bare wall.
    square : bool
        Whether an outline of four sides keeps right angles.
    cost : float
        -2 times the logarithm of the evidence; smaller is better. See ``_cost``.
    """

    figure: Circle | Outlines | None
    square: bool
    cost: float

    @cached_property
    def shape(self) -> Shape | None:
        """The figure as a shape; None for a bare wall."""
        return self.figure.polygon() if isinstance(self.figure, Outlines) else self.figure

    @property
    def kind(self) -> str:
        """The shape's kind, or ``"wall"``."""
        if isinstance(self.figure, Outlines):
            return KINDS[self.figure.angles.shape[1] - 2]
        return "wall" if self.figure is None else "circle"


def seen_shares(shape: Shape, points: Floats, gap: float = GAP) -> tuple[float, ...]:
    """Return the share of each side, or of the whole circle, that lies within ``gap`` metres of a point.

    Examples
    --------
    >>> from primkit.shapes import Polygon
    >>> square = Polygon([(0, 0), (0.1, 0), (0.1, 0.1), (0, 0.1)])
    >>> [round(share, 1) for share in seen_shares(square, np.array([(0.0, 0.05), (0.05, 0.0)]))]
    [0.2, 0.0, 0.0, 0.2]
    """
    from scipy.spatial import cKDTree

    if isinstance(shape, Circle):
        stretches = [shape.outline(4 * STEPS_PER_SIDE)]
    else:
        steps = (np.arange(STEPS_PER_SIDE) + 0.5)[:, None] / STEPS_PER_SIDE
        stretches = [corner + steps * edge for corner, edge in zip(shape.vertices, shape.edges, strict=True)]
    if len(points) == 0:
        return (0.0,) * len(stretches)
    nearest, _ = cKDTree(points).query(np.vstack(stretches))
    return tuple((nearest.reshape(len(stretches), -1) <= gap).mean(axis=1).tolist())


def candidates(
    points: Floats, spread: float, *, soft: bool = True, rng: int | np.random.Generator | None = None
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

    Returns
    -------
    list of Candidate
        A wall, a circle, and polygons of three to five sides, as far as each can be fitted; empty for fewer
        than eight different points. Those that come near the best are fitted to the last digit; the others'
        costs are a lower bound, in which what was not seen has no price.
    """
    if len(np.unique(points, axis=0)) < LEAST_POINTS:
        return []
    middle = points.mean(axis=0)
    local = points - middle  # digits are not lost far from the origin
    waiting = sorted(_rough(local, spread, as_rng(rng)), key=lambda c: c.cost)
    done: list[Candidate] = []
    while waiting and waiting[0].cost <= min((c.cost for c in done), default=np.inf) + CONTENDER:
        polished = _polished(local, waiting.pop(0), spread, soft)
        done += [] if polished is None else [polished]
    return [_moved(c, middle) for c in sorted(done + waiting, key=lambda c: c.cost)]


def _rough(points: Floats, spread: float, rng: np.random.Generator) -> list[Candidate]:
    """Return the explanations that RANSAC and a few rounds of giving points back lead to, in any order."""
    circle_rng, line_rng, wall_rng = rng.spawn(3)
    reach = SIGMAS * spread
    found = _walls(points, spread, wall_rng)
    circle = find_circle(points, reach, trials=CIRCLE_TRIALS, rng=circle_rng)
    if circle is not None and circle.radius <= MOST_RADIUS:
        found.append(_judged(points, circle, False, spread))
    sides = line_guesses(points, reach, rng=line_rng)
    for k in (3, 4, 5):
        guess = guess_outlines(points, sides, k, reach)
        starts = [(guess, False)]
        if k == 4:
            starts.append((guess_rectangles(points, sides, guess), True))
        for start, square in starts:
            order = np.argsort(truncated_cost(points, start, reach + WIDER), kind="stable")
            refined = refine_hard(points, start[order[:STARTS_KEPT]], reach, square=square)
            refined = refined[refined.sound()]
            if len(refined):
                best = int(np.argmin(truncated_cost(points, refined, reach)))
                found.append(_judged(points, refined[best : best + 1], square, spread))
    return found


def _walls(points: Floats, spread: float, rng: np.random.Generator) -> list[Candidate]:
    """Explain the points by one straight wall: its line and its two ends; its back was not seen."""
    found = []
    for best in find_lines(points, SIGMAS * spread, most=1, trials=WALL_TRIALS, rng=rng):
        length = float(np.ptp(points[best.inliers] @ best.line.direction))
        fit = _log_likelihood(best.line.signed_distance(points), spread)
        found.append(Candidate(None, False, _cost(fit, 4, len(points), spread) + UNSEEN_COST * length))
    return found


def _polished(points: Floats, rough: Candidate, spread: float, soft: bool) -> Candidate | None:
    """Fit a candidate to the last digit, and price what was not seen of its outline; None for a circle that is none."""
    figure = rough.figure
    if isinstance(figure, Outlines) and soft:
        figure = refine_soft(points, figure, spread, square=rough.square)
    elif isinstance(figure, Circle):
        figure = _polished_circle(points, figure, spread)
        if figure is None:
            return None
    if figure is None:
        return rough
    shape = figure.polygon() if isinstance(figure, Outlines) else figure
    seen = seen_shares(shape, points[np.abs(shape.signed_distance(points)) <= SIGMAS * spread])
    lengths = shape.sides if isinstance(shape, Polygon) else np.array([shape.perimeter])
    if isinstance(shape, Circle) and seen[0] < 1 and 2 * np.pi * seen[0] - 2 * GAP / shape.radius < LEAST_ARC:
        return None
    judged = _judged(points, figure, rough.square, spread)
    return replace(judged, cost=judged.cost + UNSEEN_COST * float(lengths @ (1 - np.array(seen))))


def _polished_circle(points: Floats, circle: Circle, spread: float) -> Circle | None:
    """Return the geometric fit in which points from nowhere do not count; None when it grows beyond a board."""
    for _ in range(CIRCLE_ROUNDS):
        density = _density(circle.signed_distance(points), spread)
        fitted = fit_circle(points, weights=density / (density + GHOSTS / GHOST_AREA))
        if fitted is None or fitted.radius > MOST_RADIUS:
            return None
        circle = fitted
    return circle


def _judged(points: Floats, figure: Circle | Outlines, square: bool, spread: float) -> Candidate:
    """Return a figure with its cost, unseen stretches unpriced."""
    if isinstance(figure, Circle):
        fit = _log_likelihood(figure.signed_distance(points), spread)
        return Candidate(figure, False, _cost(fit, 3, len(points), spread))
    fit, k = float(shares(points, figure, spread)[1][0]), figure.angles.shape[1]
    cost = _cost(fit, 5 if square else 2 * k, len(points), spread)
    return Candidate(figure, square, cost + (CROOKED_COST if k == 4 and not square else 0.0))


def _cost(log_likelihood: float, n_params: int, n_points: int, spread: float) -> float:
    """Return -2 times the logarithm of the evidence (Laplace's approximation; MacKay, 1992).

    cost = -2 ln L + q ln(N / (2 pi) (1 + w^2 / s^2)) for q fitted numbers, N points, the spread s and the
    width w of what was known of each number beforehand, ``PRIOR_WIDTH``. A number costs the logarithm of how
    far the points narrow it down, from w to s / sqrt(N); the 1 keeps the price up where s is larger than w.
    """
    narrowed = n_points / (2 * np.pi) * (1 + (PRIOR_WIDTH / spread) ** 2)
    return float(-2 * log_likelihood + n_params * np.log(narrowed))


def _log_likelihood(distance: Floats, spread: float) -> float:
    """Return how likely the points are at these distances from a smooth outline, as in ``refine.shares``."""
    return float(np.log(_density(distance, spread) + GHOSTS / GHOST_AREA).sum())


def _density(distance: Floats, spread: float) -> Floats:
    """Return the density of points that come from an outline, shape (N,), per square metre."""
    across = np.exp(-0.5 * (distance / spread) ** 2) / (np.sqrt(2 * np.pi) * spread)
    return (1 - GHOSTS) * across / OUTLINE_LENGTH


def _moved(candidate: Candidate, offset: Floats) -> Candidate:
    """Return the candidate, shifted back to where its points are."""
    figure = candidate.figure
    if isinstance(figure, (Circle, Outlines)):
        figure = figure.moved(offset)
    return Candidate(figure, candidate.square, candidate.cost)
