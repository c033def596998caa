"""Measure: from the points of one cluster to a shape with its corners, its centre and its dimensions.

The best of the candidate explanations is taken; a bare wall is no shape.

In:  points of one cluster, shape (N, 2), metres.
Out: ``Detection``: the shape, its points, how closely they lie to it, and how clear the choice was; or ``None``.

>>> from primkit.shapes import Circle
>>> found = measure_shape(Circle((0.1, 0.2), 0.05).outline(60), spread=0.0005, rng=0)
>>> found.shape, found.margin > 100
(Circle(center=(0.1, 0.2), radius=0.05), True)
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .arguments import as_points, as_positive
from .certainty import Certainty, certainty
from .circles import straightened
from .evidence import Candidate, seen_shares
from .explain import candidates
from .scatter import LEAST_SPREAD, SIGMAS, noise_of
from .shapes import Circle, Kind, Shape

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

Floats = NDArray[np.float64]

NEIGHBOURS = 10  # enough for a line with its spread, few enough for a curve to be straight
ENOUGH_PLACES = 250  # they tell whether there is any noise


@dataclass(frozen=True, eq=False)
class Choice:
    """How a shape was chosen for the points of a cluster: it knows how clear the choice was.

    Parameters
    ----------
    points : array, shape (N, 2)
        All points of the cluster, metres.
    ranked : list of Candidate
        The explanations that were fitted, the best first.
    spread : float
        Standard deviation of the points from the outline, metres.
    seed : int
        Seed for the RANSAC stages; None for another one each time.
    soft : bool
        Whether points were shared between sides.
    at_a_glance : bool
        Whether the best explanation was beyond doubt, and its rivals were not fitted.
    """

    points: Floats
    ranked: list[Candidate]
    spread: float
    seed: int | None = None
    soft: bool = True
    at_a_glance: bool = False

    @cached_property
    def distance(self) -> Floats:
        """Signed distances of the points from the chosen shape, shape (N,), metres; infinite without a shape."""
        shape = self.ranked[0].shape if self.ranked else None
        return np.full(len(self.points), np.inf) if shape is None else shape.signed_distance(self.points)

    @cached_property
    def on_it(self) -> NDArray[np.bool_]:
        """Which points lie on the chosen shape, shape (N,)."""
        return np.abs(self.distance) <= SIGMAS * self.spread

    @cached_property
    def sure(self) -> Certainty:
        """How sure the numbers of the chosen shape are; nothing without a shape."""
        best = self.ranked[0] if self.ranked else None
        if best is None or best.figure is None:
            return Certainty((), ())
        points = self.points[self.on_it]
        middle = points.mean(axis=0)
        return certainty(best.figure.moved(-middle), points - middle, self.spread, square=best.square)

    @cached_property
    def margin(self) -> float:
        """How much more the best of another kind costs; rivals that were not fitted are fitted when this is asked."""
        best, rivals = self.ranked[0], self.ranked[1:]
        if self.at_a_glance:
            rivals = candidates(self.points, self.spread, soft=self.soft, rng=self.seed)
        return next((other.cost for other in rivals if other.kind != best.kind), float("inf")) - best.cost


@dataclass(frozen=True, eq=False)
class Detection:
    """A shape that was found.

    Parameters
    ----------
    shape : Circle or Polygon
        The shape, metres, world frame.
    points : array, shape (N, 2)
        The points that lie on it, metres.
    rms : float
        Root mean square distance of those points from the outline, metres.
    count_margin : float
        How clear it is that this is one shape of its own: how much better that explains the points than the
        best grouping in which it is split, or merged with a neighbour, on the scale of ``margin``. Infinite when no
        other grouping came into question; NaN from ``PAPER``, which does not ask.
    seen : tuple of float
        The share of each side (or of the whole circle) that has points near it, 0 to 1.
    sure : Certainty or Choice, optional
        What tells how sure the shape's numbers are; None from ``PAPER``, which does not ask.
    choice : Choice, optional
        How the shape was chosen; None from ``PAPER``.
    """

    shape: Shape
    points: Floats
    rms: float
    count_margin: float = float("nan")
    seen: tuple[float, ...] = ()
    sure: Certainty | Choice | None = field(default=None, repr=False)
    choice: Choice | None = field(default=None, repr=False)

    @property
    def center_std(self) -> tuple[float, ...]:
        """Standard deviations of the centroid's x and y, metres; infinite when a side was never seen.

        Like the next, it supposes points on cells of 1 mm, is worked out when it is asked for, and is empty from
        ``PAPER``, which does not ask.
        """
        return self._certainty.center_std

    @property
    def dimension_std(self) -> tuple[float, ...]:
        """Standard deviation of each of ``shape.dimensions``, metres.

        Infinite for one that was not measured, because a side that it hangs on was never seen, or that is not even
        known to a centimetre.
        """
        return self._certainty.dimension_std

    @property
    def _certainty(self) -> Certainty:
        """How sure the numbers are; nothing where that is not asked."""
        sure = self.sure.sure if isinstance(self.sure, Choice) else self.sure
        return Certainty((), ()) if sure is None else sure

    @property
    def margin(self) -> float:
        """How much better this shape explains the points than the best of another kind.

        Twice the logarithm of the Bayes factor; above 10 is very strong (Kass and Raftery, 1995). Infinite without a
        rival; NaN from ``PAPER``, which does not ask. Where the shape was beyond doubt at a glance, its rivals are
        fitted now, when the margin is asked for: some 10 ms, once.
        """
        return float("nan") if self.choice is None else self.choice.margin

    @property
    def kind(self) -> Kind:
        """The shape's kind."""
        return self.shape.kind

    @property
    def measured(self) -> tuple[bool, ...]:
        """Which of the shape's dimensions were measured, and not only supposed."""
        return tuple(std < float("inf") for std in self.dimension_std)


def measure_shape(
    points: ArrayLike, spread: float, *, rng: int | np.random.Generator | None = None
) -> Detection | None:
    """Return the shape that explains the points of one cluster best.

    Parameters
    ----------
    points : array_like, shape (N, 2)
        Metres; a few may belong to nothing.
    spread : float
        Standard deviation of the points from the outline, metres; see ``spread_of``.
    rng : int or numpy.random.Generator, optional
        Seed or generator for the RANSAC stages.

    Returns
    -------
    Detection or None
        None when there are fewer than eight different points, or a bare wall explains them as well.

    Raises
    ------
    ValueError
        If points are not finite (N, 2), or the spread is negative.

    Examples
    --------
    A straight wall is no shape:

    >>> measure_shape([(x / 100, 0) for x in range(20)], spread=0.001, rng=0) is None
    True
    """
    points, spread = as_points(points), max(LEAST_SPREAD, as_positive(spread, "spread", zero=True))
    return as_detection(Choice(points, candidates(points, spread, rng=rng), spread))


def as_detection(choice: Choice) -> Detection | None:
    """Return the best candidate with those of the points that lie on it; None when it is no shape."""
    best = choice.ranked[0] if choice.ranked else None
    shape = None if best is None else best.shape
    if best is None or shape is None:
        return None
    points, rms = choice.points[choice.on_it], _rms(choice.distance[choice.on_it])
    if isinstance(shape, Circle):
        shape = straightened(shape, points, noise_of(choice.spread), best.seen[0])
    return Detection(shape, points, rms, seen=best.seen, sure=choice, choice=choice)


def spread_of(points: ArrayLike) -> float:
    """Return the standard deviation of points from the outlines that they lie on, before any is known, metres.

    Each point's neighbours lie on a piece of outline that is nearly straight: what they scatter across it is
    the spread, and the median over all points does not mind corners and strays. Where a look at some hundred places
    tells that there is no noise, that is enough.

    Notes
    -----
    Too low when the spread is larger than the distance between neighbours: by a quarter to a third at 10 mm.

    Examples
    --------
    >>> spread_of([]) == LEAST_SPREAD
    True
    """
    from scipy.spatial import cKDTree

    points = as_points(points)
    if len(points) < NEIGHBOURS:
        return LEAST_SPREAD
    tree, every = cKDTree(points), -(-len(points) // ENOUGH_PLACES)
    at_some_places = _spread_at(points[::every], points, tree)
    return at_some_places if every == 1 or at_some_places == LEAST_SPREAD else _spread_at(points, points, tree)


def _spread_at(places: Floats, points: Floats, tree: cKDTree) -> float:
    """Return the spread, judged by what the points next to some places scatter, shape (M, 2); a tree has them all."""
    near = tree.query(places, NEIGHBOURS)[1]  # (M, NEIGHBOURS)
    x, y = points[:, 0][near], points[:, 1][near]
    x, y = x - x.mean(axis=1, keepdims=True), y - y.mean(axis=1, keepdims=True)
    xx, yy, xy = (x * x).sum(axis=1), (y * y).sum(axis=1), (x * y).sum(axis=1)
    across = (xx + yy - np.hypot(xx - yy, 2 * xy)) / 2  # the smaller eigenvalue of the scatter matrix
    variance = np.maximum(across, 0.0) / (NEIGHBOURS - 2)  # two numbers fix a line
    return max(LEAST_SPREAD, float(np.sqrt(np.median(variance))))


def detection(shape: Shape, points: Floats, reach: float) -> Detection:
    """Return the shape with those of the points that lie within ``reach`` metres of its outline."""
    distance = shape.signed_distance(points)
    on_it = np.abs(distance) <= reach
    return Detection(shape, points[on_it], _rms(distance[on_it]), seen=seen_shares(shape, points[on_it]))


def _rms(distance: Floats) -> float:
    """Return the root mean square; NaN of nothing."""
    return float(np.sqrt(np.mean(distance**2))) if len(distance) else float("nan")
