"""Choice: the explanation that was chosen for the points of a group, and how clear the choice was.

In:  the points of one group, shape (N, 2), metres, and their explanations, the best first.
Out: ``Choice``: the shape, the points that lie on it, its standard deviations, its margin over the next kind.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..arguments import Floats, Ints
from ..circles import straightened
from ..lines import Line
from ..seen import REACH, seen_shares
from ..shapes import KINDS, Circle, Shape
from .candidates import candidates, explained_again
from .deviations import Certainty, certainty, without_points
from .evidence import CERTAIN, NEARLY_ALL, Candidate
from .free import free_candidate
from .lack_of_fit import lack_of_fit, lacks_corner
from .outlines import LEAST_SIDE, Outlines
from .scatter import SIGMAS, depth_of, noise_of

if TYPE_CHECKING:
    from shapely.geometry.base import BaseGeometry

FEW_NEW = 0.1  # share of new points up to which a group is fitted anew from what it was
FEW_OFF = 0.02  # share of the points by which more may lie beside a group's shape then
SURE = 30.0  # margin up to which a few points more may change what a group is
MOST_SEEN = 0.75  # share of each side; behind more there may be something else
# Where only the four kinds can be there, nothing else begins as so long an arc, as seen from one pose.
ENOUGH_ARC = np.radians(135)


@dataclass(frozen=True, eq=False)
class Choice:
    """How a shape was chosen for the points of a cluster: it knows how clear the choice was."""

    points: Floats
    ranked: list[Candidate]  # the explanations that were fitted, the best first
    spread: float
    soft: bool = True
    thorough: bool = True  # whether all rivals were fitted, and not only those that came into question
    kinds: Sequence[str] = KINDS
    n_thorough: int = 0  # how many points there were when all explanations were looked for

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
    def inside(self) -> NDArray[np.bool_]:
        """Which points lie deep inside the chosen shape, shape (N,): no beam gets there, unless it is two."""
        return self.distance < -depth_of(self.spread)

    def certainty(self, points: Floats, scans: Ints | None, noise_std: float) -> Certainty:
        """Return how sure the numbers of the chosen shape are, by points on it and their scans; see ``deviations``."""
        best = self.ranked[0] if self.ranked else None
        if best is None or isinstance(best.figure, Line):
            return Certainty((), ())
        middle, figure = points.mean(axis=0), best.figure
        return certainty(
            figure.moved(-middle), points - middle, self.spread, square=best.square, scans=scans, noise_std=noise_std
        )

    @cached_property
    def hull(self) -> BaseGeometry:
        """The convex hull of the points."""
        import shapely

        return shapely.linestrings(self.points).convex_hull

    @cached_property
    def closed(self) -> bool:
        """Whether each side of the best explanation's outline was seen nearly from end to end."""
        if self.shape is None or min(self.ranked[0].seen) >= NEARLY_ALL:  # by those points alone that lie on it
            return self.shape is not None
        return min(seen_shares(self.shape, self.points)) >= NEARLY_ALL

    @property
    def lead(self) -> float:
        """How much more the best rival of another kind costs, of those that were fitted; infinite without one.

        That boards seldom have shapes without a name is held against them by half.
        """
        return self._ahead_of(self.ranked[1:])

    @cached_property
    def margin(self) -> float:
        """How much more the best rival costs: another kind, an outline of any straight pieces, or one that bends.

        Rivals that were not fitted are fitted when this is asked.
        """
        rivals = self.ranked[1:] if self.thorough else candidates(self.points, self.spread, soft=self.soft)
        margin = self._ahead_of([*rivals, *free_candidate(self.points, self.spread)])
        return margin if self.fit >= CERTAIN else min(margin, self.fit)

    def _ahead_of(self, rivals: Sequence[Candidate]) -> float:
        """Return how much more the best of the rivals costs that is of another kind, and can be there."""
        best, possible = self.ranked[0], ("wall", *self.kinds)
        others = [c.cost - c.nameless / 2 for c in rivals if c.kind != best.kind and c.kind in possible]
        return min(others, default=float("inf")) - best.cost

    @cached_property
    def fit(self) -> float:
        """How much more the outline costs when it may bend: see ``lack_of_fit``; infinite without a shape."""
        best = self.ranked[0] if self.ranked else None
        if best is None or isinstance(best.figure, Line):
            return float("inf")
        middle = self.points.mean(axis=0)
        return lack_of_fit(self.points - middle, best.figure.moved(-middle), self.spread, square=best.square)

    @property
    def certain(self) -> bool:
        """Whether what it is, is beyond doubt.

        It is ahead of all rivals, and of itself with bends; nearly all points lie on it, none deep inside, no two side
        by side without; nearly all of it was seen, each side by points of its own, or, where only the four kinds can be
        there, three eighths of a circle; it is so large that its kind can show, and it is not as well two shapes with
        names side by side.
        """
        best = self.ranked[0] if self.ranked else None
        if best is None or best.shape is None or isinstance(best.figure, Line):
            return False
        figure = best.figure
        large = best.shape.dimensions[-1] if isinstance(best.shape, Circle) else best.shape.sides.min()
        return bool(
            min(self.lead, self.fit) >= CERTAIN
            and self.on_it.mean() >= NEARLY_ALL
            and not self.inside.any()
            and not lacks_corner(self.points, figure, self.spread)
            and (min(best.seen) >= MOST_SEEN or self._round_enough(best))
            and not (isinstance(figure, Outlines) and without_points(figure, self.points, self.spread).any())
            and large >= LEAST_SIDE
            and not (isinstance(figure, Outlines) and figure.of_two)
            and self.margin >= CERTAIN  # the last, for it fits the rivals that were not
        )

    def _round_enough(self, best: Candidate) -> bool:
        """Tell whether a circle was seen over so much of it that none of the kinds that can be there begins alike."""
        return (
            isinstance(best.figure, Circle)
            and "polygon" not in self.kinds
            and best.length - 2 * REACH >= ENOUGH_ARC * best.figure.radius
        )


def explained(
    points: Floats,
    spread: float,
    *,
    soft: bool = True,
    thorough: bool = True,
    kinds: Sequence[str] = KINDS,
) -> Choice:
    """Return the points with all their explanations; or, if not to be thorough, with those that may win.

    Walls, and those of the kinds that can be there, are explanations.
    """
    ranked = candidates(points, spread, soft=soft, thorough=thorough, kinds=kinds)
    return Choice(points, ranked, spread, soft, thorough, kinds, len(points))


def grown(old: Choice, points: Floats, spread: float, *, soft: bool = True) -> Choice | None:
    """Return a choice for a group that has a few points more than it had, its explanation fitted anew from what it was.

    None where all explanations should be looked for: many points are new, others are gone, what the group is was in
    doubt, or it is so now.
    """
    if not old.ranked or old.lead < SURE or not 1 <= len(points) / old.n_thorough <= 1 + FEW_NEW:
        return None
    before, now = (np.ascontiguousarray(p).view(complex) for p in (old.points, points))  # a point is one number
    if not np.isin(before, now).all():
        return None
    ranked = explained_again(points, old.ranked, spread, soft=soft)
    anew = replace(old, points=points, ranked=ranked)
    if not ranked or ranked[0].kind != old.ranked[0].kind or anew.lead < SURE:
        return None
    return anew if anew.on_it.mean() >= old.on_it.mean() - FEW_OFF else None
