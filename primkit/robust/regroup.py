"""Regroup: the second opinion on which points belong together.

Linking neighbours splits an outline where a stretch of it was not seen, and joins shapes that stand too close.
Once shapes are measured this can be judged: two groups become one when one shape explains them better than
two, and one becomes two when two shapes do.

In:  groups of points, and how far points spread from outlines.
Out: groups again, each with its explanations.

>>> from primkit.shapes import Circle
>>> ring = Circle((0, 0), 0.06).outline(100)
>>> halves = [explained(ring[:45], 0.0004), explained(ring[50:95], 0.0004)]
>>> groups, margins = regrouped(halves, 0.0004)
>>> len(groups), groups[0].shape.kind
(1, 'circle')

Source: splitting and merging by what explains the points better, as X-Means does: Pelleg and Moore (2000), "X-means:
extending K-means with efficient estimation of the number of clusters".
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from itertools import combinations, permutations

import numpy as np
from numpy.typing import NDArray

from ..arguments import Floats
from ..lines import fit_line
from ..segmentation import LEAST_GROUP, LINK, kmeans, link
from ..shapes import turns_of
from .candidates import MOST_POINTS
from .choice import Choice, explained
from .evidence import INSIDE_COST, MOST_INSIDE, NEARLY_ALL, joint_cost
from .outlines import Outlines
from .scatter import NOWHERE, SIGMAS, depth_of

Explain = Callable[[Floats], Choice]

# At most so many points are explained, and each try counts as so many more: about two seconds' work.
MOST_WORK, WORK_OF_A_TRY = 100_000, 250

MOST_ACROSS = 0.45  # m: the paper's largest rectangle is 0.424 m from corner to corner; wider pieces are of two shapes
FINER_LINKS = (1.0, 1.5, 2.0, 3.0, 4.0, 6.0)  # a group is cut where it falls apart first, linked so much more finely
MOST_JOINTS = 3  # ways to cut an outline between two corners
JOINT_COST = 40.0  # two shapes seldom stand so close that nothing is seen between them


@dataclass(frozen=True)
class _Tried:
    """What was tried: how groups would split, what pairs would merge into, and by how much a group won."""

    halves: dict[Choice, tuple[Choice, ...]] = field(default_factory=dict)
    unions: dict[tuple[Choice, Choice], Choice] = field(default_factory=dict)
    won_by: dict[Choice, float] = field(default_factory=dict)


@dataclass
class Opinion:
    """Explains points, and knows how much work that was, points and some more for each try: it is bounded."""

    explain: Explain
    work: int = 0

    def __call__(self, points: Floats) -> Choice:
        """Explain points, shape (N, 2), metres."""
        self.work += len(points) + WORK_OF_A_TRY
        return self.explain(points)

    @property
    def bounded(self) -> bool:
        """Whether the bound was reached."""
        return self.work > MOST_WORK


def cost_of(groups: Sequence[Choice]) -> float:
    """Return the cost of the groups' best explanations together; points too few for any come from nowhere."""
    strays = sum(len(g.points) for g in groups if not g.ranked)
    return joint_cost([g.ranked[0] for g in groups if g.ranked]) - 2 * strays * float(np.log(NOWHERE))


def regrouped(
    groups: Sequence[Choice],
    spread: float,
    n_shapes: int | None = None,
    *,
    explain: Opinion | None = None,
    lone: Floats | None = None,
) -> tuple[list[Choice], list[float]]:
    """Split and merge the groups that segmentation left, as long as that explains the points better, within a bound.

    Points that were linked to none are ``lone``, shape (N, 2), metres.

    Returns
    -------
    groups : list of Choice
        ``n_shapes`` where that is known, as far as the points allow; else as many as explain the points best.
    margins : list of float
        For each group, how much better it explains the points than the best grouping in which it is split or
        merged with a neighbour: twice the logarithm of the Bayes factor; infinite when none was in question.
    """
    explain, tried = explain or Opinion(partial(explained, spread=spread)), _Tried()
    groups = list(groups) if lone is None else _with_what_is_inside(list(groups), lone, explain, tried)
    if n_shapes is None or len(groups) < n_shapes:
        groups = _split_all(groups, spread, n_shapes, explain, tried)
    if n_shapes is None or len(groups) > n_shapes:
        groups = _merge_all(groups, spread, n_shapes, explain, tried)
    return groups, [_margin(g, groups, tried) for g in groups]


def _with_what_is_inside(groups: list[Choice], lone: Floats, explain: Opinion, tried: _Tried) -> list[Choice]:
    """Join open groups with the lone points and other groups inside their hulls, where that explains all better.

    Of a notch few points are seen, and these are not linked to the others.
    """
    import shapely

    for group in groups:
        across = np.hypot(*np.ptp(group.points, axis=0))
        if group not in groups or group.closed or across > MOST_ACROSS or not group.ranked or explain.bounded:
            continue
        inside = [g for g in groups if g is not group and shapely.contains_xy(group.hull, *g.points.T).all()]
        strays = lone[shapely.contains_xy(group.hull, *lone.T)]
        if inside or len(strays):
            whole = explain(np.vstack([strays, *(g.points for g in [group, *inside])]))
            of_strays = INSIDE_COST * min(len(strays), MOST_INSIDE) - 2 * len(strays) * float(np.log(NOWHERE))
            gain = cost_of([whole]) - cost_of([group, *inside]) - of_strays
            if gain < 0 and 2 * np.count_nonzero(whole.on_it[: len(strays)]) >= len(strays):
                groups = [whole if g is group else g for g in groups if g not in inside]
                tried.won_by[whole] = -gain
    return groups


def _margin(group: Choice, groups: list[Choice], tried: _Tried) -> float:
    """Return how much worse the best other grouping of a group's points is; infinite when none was tried."""
    others = [tried.won_by.get(group, float("inf")), _gain(tried.halves.get(group, ()), group)]
    for (a, b), union in tried.unions.items():
        if group in (a, b) and a in groups and b in groups:
            others.append(cost_of([union]) - cost_of([a, b]))
    whole = group
    while (before := next((g for g, parts in tried.halves.items() if whole in parts), None)) is not None:
        whole = before
    pieces = [whole]
    for piece in pieces:
        pieces += () if piece in groups else tried.halves.get(piece, ())
    if any(piece in groups and piece is not group and not piece.certain for piece in pieces):
        others.append(0.0)  # where one piece of what was together is in doubt, so are the cuts
    return min(others)


def _split_all(
    groups: list[Choice], spread: float, n_shapes: int | None, explain: Opinion, tried: _Tried
) -> list[Choice]:
    """Split the group that gains most by it, again and again."""
    limit = 0.0 if n_shapes is None else np.inf
    while n_shapes is None or len(groups) < n_shapes:
        for g in groups:
            if g not in tried.halves:
                tried.halves[g] = () if explain.bounded else _halves(g, spread, n_shapes, explain)
        best = min(groups, key=lambda g: _gain(tried.halves[g], g), default=None)
        if best is None or not _gain(tried.halves[best], best) < limit:
            break
        parts, at = tried.halves[best], groups.index(best)
        groups = [*groups[:at], *parts, *groups[at + 1 :]]
        tried.won_by.update(dict.fromkeys(parts, -_gain(parts, best)))
    return groups


def _gain(parts: tuple[Choice, ...], group: Choice) -> float:
    """Return by how much the parts cost more than the whole, a joint that no beam met included; infinite without."""
    if not parts:
        return float("inf")
    whole = group.fit > 0 and not group.inside.any()
    return cost_of(parts) - cost_of([group]) + JOINT_COST * whole


def _halves(group: Choice, spread: float, n_shapes: int | None, explain: Opinion) -> tuple[Choice, ...]:
    """Return a group as two; nothing when it is too small or too large, or well explained as it is."""
    if not group.ranked or not 2 * LEAST_GROUP <= len(group.points) <= MOST_POINTS:
        return ()
    figure = group.ranked[0].figure
    plain = not group.inside.any() and (not isinstance(figure, Outlines) or figure.convex)
    share = group.ranked[0].n_on / len(group.points) if group.shape is None else group.on_it.mean()
    if n_shapes is None and plain and share >= NEARLY_ALL:  # no wall is two of anything either
        return ()
    ways = [parts for side in _sides(group, spread) if (parts := _parts(group.points, side, explain))]
    best, before = min(ways, key=_cost_apart, default=()), tuple[Choice, ...]()
    # Each point to the shape that it is nearer to; where two run along each other, what lies on both is of either.
    two = np.hypot(*np.ptp(group.points, axis=0)) <= 2 * MOST_ACROSS  # and no room
    while best != before and all(part.shape is not None for part in best) and not explain.bounded:
        far, near = (np.abs(part.shape.signed_distance(group.points)) for part in best if part.shape is not None)
        nearer, on_both = near < far, two & (np.maximum(near, far) <= SIGMAS * spread)
        sides = [nearer | on_both, nearer & ~on_both] if on_both.any() else [nearer]
        ways = [parts for side in sides if (parts := _parts(group.points, side, explain))]
        before, best = best, min([best, *ways], key=_cost_apart)
    return best


def _cost_apart(parts: tuple[Choice, ...]) -> float:
    """Return what two parts cost, and the points of each that lie on the other or inside it: no beam gets there."""
    both = [(a.points, b.shape, b.spread) for a, b in permutations(parts, 2) if b.shape is not None]
    amiss = sum(np.count_nonzero(shape.signed_distance(points) <= SIGMAS * spread) for points, shape, spread in both)
    return cost_of(parts) + INSIDE_COST * min(amiss, MOST_INSIDE)


def _parts(points: Floats, side: NDArray[np.bool_], explain: Explain) -> tuple[Choice, ...]:
    """Return the points on either side, explained; nothing where they are too few."""
    if not LEAST_GROUP <= np.count_nonzero(side) <= len(side) - LEAST_GROUP:
        return ()
    return explain(points[~side]), explain(points[side])


def _sides(group: Choice, spread: float) -> list[NDArray[np.bool_]]:
    """Return ways to cut a group in two: which points lie on one side, shape (N,).

    Where neighbours are farther apart than elsewhere; along the points inside it, which were seen through the mouth
    between two shapes; and by K-Means.
    """
    points, figure = group.points, group.ranked[0].figure
    ways = []
    if isinstance(figure, Outlines) and not figure.convex:
        place = figure.places(points)[0]
        ways += [(first < place) & (place <= last) for first, last in _joints(figure)]
    ways = ways or [kmeans(points, 2, rng=0) > 0]
    if (mouth := fit_line(points[group.inside])) is not None:
        beyond, reach = mouth.signed_distance(points), SIGMAS * spread
        ways += [beyond > reach, beyond > -reach]  # what lies on it is a side of the one or of the other
    for finer in FINER_LINKS:
        labels = link(points, LINK / finer)
        if labels.max() > 0:
            ways.append(labels == np.bincount(labels[labels >= 0]).argmax())
            break
    return ways


def _joints(outline: Outlines) -> list[tuple[float, float]]:
    """Return where two convex shapes would meet that make this outline: between which two places along it the one lies.

    One of them at least is a corner that bends inwards, and cut there, the outline leaves the least of such corners.
    """
    places, left = np.cumsum(np.append(0.0, np.subtract(*outline.spans()[::-1])[0])), {}
    for i, j, parts in outline.halves():
        left[places[i], places[j]] = sum(-np.minimum(turns_of(part), 0.0).sum() for part in parts)
    return sorted(left, key=lambda ends: left[ends])[:MOST_JOINTS]


def _merge_all(
    groups: list[Choice], spread: float, n_shapes: int | None, explain: Opinion, tried: _Tried
) -> list[Choice]:
    """Merge the two groups that gain most by it, again and again."""
    asked = set[tuple[Choice, Choice]]()
    while len(groups) > (n_shapes or 1):
        best, best_gain = None, 0.0 if n_shapes is None else np.inf
        for a, b in combinations(groups, 2):
            if (a, b) not in asked and not explain.bounded and (n_shapes is not None or _may_be_one(a, b, spread)):
                tried.unions[a, b] = explain(np.vstack([a.points, b.points]))
            asked.add((a, b))
            one = tried.unions.get((a, b))
            gain = cost_of([one]) - cost_of([a, b]) if one is not None and one.ranked else np.inf
            if one is not None and gain < best_gain:
                best, best_gain = (a, b, one), gain
        if best is None:
            break
        a, b, one = best
        groups = [one if g is a else g for g in groups if g is not b]
        tried.won_by[one] = -best_gain
    return groups


def _may_be_one(a: Choice, b: Choice, spread: float) -> bool:
    """Tell quickly whether two groups can be pieces of one convex outline.

    One of them must be open, and the points of both must lie along the hull of both.
    """
    if (a.closed and b.closed) or len(a.points) + len(b.points) > MOST_POINTS:
        return False
    import shapely

    hull = shapely.get_coordinates(shapely.geometrycollections([a.hull, b.hull]).convex_hull)
    if np.hypot(*np.moveaxis(hull[:, None] - hull, 2, 0)).max() > MOST_ACROSS:
        return False
    edges = np.diff(hull, axis=0)  # clockwise: outwards is to the left
    outwards = np.column_stack([-edges[:, 1], edges[:, 0]]) / np.hypot(*edges.T)[:, None]
    depth = -(np.vstack([a.points, b.points]) @ outwards.T - (hull[:-1] * outwards).sum(axis=1)).max(axis=1)
    return bool(np.mean(depth <= 2 * depth_of(spread)) >= NEARLY_ALL)  # the hull runs along the outermost points
