"""Choice: the explanation that was chosen for the points of a group, and how clear the choice was.

In:  the points of one group, shape (N, 2), metres, and their explanations, the best first.
Out: ``Choice``: the shape, the points that lie on it, its standard deviations, its margin over the next kind.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..arguments import Floats
from ..circles import straightened
from ..shapes import Circle, Shape
from .candidates import candidates
from .deviations import Certainty, certainty
from .evidence import Candidate
from .scatter import SIGMAS, noise_of


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
    def shape(self) -> Shape | None:
        """The chosen shape, its circle freed from the pull of its spread; None for a bare wall or too few points."""
        best = self.ranked[0] if self.ranked else None
        if best is None or not isinstance(best.figure, Circle):
            return None if best is None else best.shape
        return straightened(best.figure, self.points[self.on_it], noise_of(self.spread), best.seen[0])

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
