"""Search: the parts that explain an outline at the least cost.

The cost of an explanation, to be least::

    -2 ln likelihood  +  NOT_SEEN x length that no point is near
    +  sum over the parts of (PART_PRICE + CORNER_PRICE x corners + numbers x ln N)

1. Parts are laid around the runs of straight pieces that bend one way: the pool.
2. Of all sets of one to four parts of the pool, those that explain the points best are fitted, all parts together;
   the best two leave local optima: a side is laid elsewhere, a triangle on another base, and all is fitted again.
3. From the best explanations one or two parts are taken away, or none, and around what is then left parts are laid:
   they join the pool, and so do their own, which are fitted. Again from 2, until nothing becomes better.

In:  the outline's pieces, the ``Sample`` of points, and a style.
Out: ``Explanation``s, the best first; the others are rivals that were looked for.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import chain, combinations

import numpy as np

from ..arguments import Floats, Ints
from ..measure import CELL
from ..robust.cuts import in_company
from ..robust.scatter import SIGMAS
from ..segmentation import link
from .families import CORNERS_OF, Part, Style
from .fitting import Sample, cost_at, cost_of, fitted, outside_union
from .pieces import Piece
from .proposals import LEAST_LAID_AROUND, Stretch, laid, runs

MOST_PARTS = 4
SETS_KEPT, SETS_EXCHANGED = 60, 10  # of each size: to make larger ones of; that members are exchanged of
SETS_LOOKED_AT, SETS_FITTED, OF_THE_SAME_KINDS = 40, 16, 3  # of each size; of these are fitted; and so of one kind
SEARCH_ROUNDS, BASES = 4, 2  # of search; explanations that parts are swapped of
WORTH_A_MOVE = 10.0  # of a side: for less, what is hidden would come to explain noise
WORTH_A_ROUND = 2.0  # by how much the cost must have fallen for one more
MUCH_DEARER = 400.0  # than the best: such sets are not fitted
POINTS_TO_LAY = 160
ROUGHER, MOST_OF_A_POINT = 1.2, 16.0  # of spreads, and of the cost, where sets are compared roughly
ALIKE_SPREADS = 0.3  # by which parts of one kind differ: less is the same
PART_PRICE, CORNER_PRICE = 25.0, 2.0  # beside their numbers: fewest parts win, then fewest corners
NOT_SEEN = 2000.0  # per metre
ELSEWHERE = np.array([-0.06, -0.03, -0.016, -0.008, -0.004, 0.004, 0.008, 0.016, 0.03, 0.06])  # m, of a side
SIGHT, IN_SIGHT = 0.015, 0.004  # m: a place so far outside all other parts has a point so near


@dataclass(frozen=True, eq=False)
class Explanation:
    """Parts that explain points, and what that costs."""

    parts: list[Part]
    cost: float

    @property
    def kinds(self) -> tuple[str, ...]:
        """The kinds of the parts, in the order of the alphabet."""
        return tuple(sorted(part.kind for part in self.parts))


def explanations(pieces: Sequence[Piece], sample: Sample, style: Style) -> list[Explanation]:
    """Return the explanations by one to four parts, the best first; none if no part can be laid."""
    near = SIGMAS * sample.spread + CELL
    thin = _thinned(sample)
    far = np.full(len(thin.points), near)
    stretches = []
    for color in sample.known_colors:
        own = [piece for piece in pieces if piece.color in (-1, color)]
        stretches += [Stretch(points, far, color) for points in runs(own) if len(points) >= LEAST_LAID_AROUND]
    pool = laid(stretches, thin, style)
    found: dict[tuple[int, ...], Explanation] = {}
    best = np.inf
    for _ in range(SEARCH_ROUNDS):
        pool = _different(pool, thin, near, ALIKE_SPREADS * sample.spread)
        for some in _best_sets(pool, sample, thin):
            key = tuple(id(pool[i]) for i in some)
            if key not in found:
                found[key] = explained([pool[i] for i in some], sample)
        for e in _bests(found):
            better = improved(e, sample)
            found[tuple(map(id, better.parts))] = better
        bases = _bests(found)
        if not bases or bases[0].cost > best - WORTH_A_ROUND:
            break
        best = bases[0].cost
        left = [stretch for base in bases for stretch in _left(base.parts, sample, thin)]
        pool = [*(part for base in bases for part in base.parts), *laid(left, thin, style), *pool]
    return sorted(found.values(), key=lambda e: e.cost)


def _bests(found: dict[tuple[int, ...], Explanation]) -> list[Explanation]:
    """Return the best explanation, and the best of other kinds."""
    ranked = sorted(found.values(), key=lambda e: e.cost)
    return [*ranked[:1], *(e for e in ranked if e.kinds != ranked[0].kinds)][:BASES]


def _different(pool: Sequence[Part], sample: Sample, near: float, alike: float) -> list[Part]:
    """Return the parts of the pool without those that are as near to all points as one before."""
    rows = np.clip(sample.outside(pool), -near, near) if pool else np.empty((0, 0))
    touched = np.abs(rows) < near
    kept: dict[tuple[str, int], list[int]] = {}
    for i in np.flatnonzero(touched.sum(axis=1) >= LEAST_LAID_AROUND // 2).tolist():
        some = kept.setdefault((pool[i].kind, pool[i].color), [])
        both = touched[some] | touched[i]
        off = (np.abs(rows[some] - rows[i]) * both).sum(axis=1) / np.maximum(both.sum(axis=1), 1)
        if not (off < alike).any():
            some.append(i)
    return [pool[i] for i in sorted(chain.from_iterable(kept.values()))]


def _best_sets(pool: Sequence[Part], sample: Sample, thin: Sample) -> list[tuple[int, ...]]:
    """Return the sets of one to four parts, as numbers of the pool, that explain the points best as they are.

    Larger sets are made of the best smaller ones, compared roughly by fewer points; then by all of them.
    """
    if not pool:
        return []
    more = len(sample.points) / len(thin.points)
    rows, every = thin.outside(pool) / (ROUGHER * thin.spread), sample.outside(pool)
    prices = np.array([price_of([part], sample) for part in pool])

    def rough_cost(distance: Floats) -> Floats:
        return np.minimum(distance**2, MOST_OF_A_POINT).sum(axis=-1) * more

    def true_cost(sets: Ints) -> Floats:
        return cost_at(every[sets].min(axis=1), sample) + prices[sets].sum(axis=1)

    def with_one_more(sets: Ints) -> Ints:
        """Return the best sets that are one of these and a part more, shape (S, size + 1), the best first."""
        costs = np.array([rough_cost(np.minimum(rows[some].min(axis=0), rows)) for some in sets]) + prices
        costs += prices[sets].sum(axis=1)[:, None]
        np.put_along_axis(costs, sets, np.inf, axis=1)
        order = np.argpartition(costs, min(2 * SETS_KEPT, costs.size - 1), axis=None)[: 2 * SETS_KEPT]
        order = order[np.isfinite(costs.ravel()[order])]
        longer = np.unique(np.sort(np.column_stack([sets[order // len(pool)], order % len(pool)]), axis=1), axis=0)
        return longer[np.argsort(true_cost(longer), kind="stable")[:SETS_KEPT]]

    sets = np.arange(len(pool))[:, None]
    found = list(zip(true_cost(sets).tolist(), map(tuple, sets.tolist()), strict=True))
    for _ in range(1, min(MOST_PARTS, len(pool))):
        sets = with_one_more(sets)
        one_less = np.concatenate([np.delete(sets[:SETS_EXCHANGED], i, axis=1) for i in range(sets.shape[1])])
        sets = np.unique(np.concatenate([sets, with_one_more(np.unique(one_less, axis=0))]), axis=0)
        costs = true_cost(sets)
        best = np.argsort(costs, kind="stable")[:SETS_KEPT]
        sets, costs = sets[best], costs[best]
        found += zip(costs.tolist(), map(tuple, sets.tolist()), strict=True)
    seen = sorted(
        (cost + NOT_SEEN * unseen([pool[i] for i in some], sample), some)
        for cost, some in sorted(found)[:SETS_LOOKED_AT]
    )
    of_kinds, chosen = Counter[tuple[str, ...]](), list[tuple[int, ...]]()
    for cost, some in seen:
        kinds = tuple(sorted(pool[i].kind for i in some))
        if of_kinds[kinds] < OF_THE_SAME_KINDS and cost < seen[0][0] + MUCH_DEARER:
            of_kinds[kinds] += 1
            chosen.append(some)
    return chosen[:SETS_FITTED]


def _thinned(sample: Sample) -> Sample:
    """Return the sample with POINTS_TO_LAY points or fewer: enough to fit a part to."""
    step = -(-len(sample.points) // POINTS_TO_LAY)
    colors = None if sample.colors is None else sample.colors[::step]
    return replace(sample, points=sample.points[::step], colors=colors)


def _left(parts: Sequence[Part], sample: Sample, thin: Sample) -> Iterator[Stretch]:
    """Yield what is left to explain when none, one or two of the parts are taken away: all of it, and each stretch."""
    near = SIGMAS * sample.spread + CELL
    for n in range(min(2, len(parts)) + 1):
        for rest in combinations(parts, len(parts) - n):
            beside, thin_beside = (
                one.outside(rest).min(axis=0) if rest else np.full(len(one.points), np.inf) for one in (sample, thin)
            )
            left = beside > near
            for color in sample.known_colors:
                points = sample.points[left if sample.colors is None else left & np.isin(sample.colors, (-1, color))]
                if len(points) >= LEAST_LAID_AROUND:
                    group = link(points)
                    some = [points[in_company(points, sample.spread)]]
                    some += [points[group == g] for g in range(group.max() + 1) if group.max() > 0]
                    yield from (Stretch(p, thin_beside, color) for p in some if len(p) >= LEAST_LAID_AROUND)


def explained(parts: Sequence[Part], sample: Sample) -> Explanation:
    """Return parts fitted to the points, and what they cost."""
    parts = fitted(parts, sample)
    return Explanation(parts, full_cost(parts, sample))


def improved(best: Explanation, sample: Sample) -> Explanation:
    """Return the explanation, out of a local optimum: some side lies elsewhere, or a triangle on another base."""
    while True:
        distances, tried = sample.outside(best.parts), list[Explanation]()
        for i, part in enumerate(best.parts):
            beside = np.delete(distances, i, axis=0).min(axis=0, initial=np.inf)
            many = part.with_numbers((part.x + np.multiply.outer(ELSEWHERE, part.pushes)).reshape(-1, len(part.x)))
            cost = np.where(many.sound, cost_at(np.minimum(sample.outside([many])[0], beside), sample), np.inf)
            for x in [many.x[cost.argmin()], *part.on_other_bases]:
                if (one := part.with_numbers(x)).sound:
                    tried.append(explained([*best.parts[:i], one, *best.parts[i + 1 :]], sample))
        better = min(tried, key=lambda e: e.cost, default=best)
        if better.cost > best.cost - WORTH_A_MOVE:
            return best
        best = better


def price_of(parts: Sequence[Part], sample: Sample) -> float:
    """Return what parts cost, however well they explain the points."""
    numbers, corners = (sum(some) for some in zip(*((len(p.x), CORNERS_OF[p.kind]) for p in parts), strict=True))
    return float(len(parts) * PART_PRICE + numbers * np.log(len(sample.points)) + corners * CORNER_PRICE)


def full_cost(parts: Sequence[Part], sample: Sample) -> float:
    """Return the cost of parts with their price, and that of what should have been seen."""
    return cost_of(parts, sample) + price_of(parts, sample) + NOT_SEEN * unseen(parts, sample)


def outline_of(parts: Sequence[Part], step: float = 0.003, in_sight: float = 0.0) -> Floats:
    """Return places of each part, a step or less apart, that lie ``in_sight`` outside the others, shape (M, 2)."""
    found = []
    for i, part in enumerate(parts):
        ring = part.shape.outline(max(8, int(part.shape.perimeter / step)))
        others = [other for j, other in enumerate(parts) if j != i]
        found.append(ring if not others else ring[outside_union(others, ring) >= in_sight])
    return np.concatenate(found)


def unseen(parts: Sequence[Part], sample: Sample) -> float:
    """Return the length of the union's outline that no point is near, metres."""
    ring = outline_of(parts, in_sight=IN_SIGHT)
    return 0.003 * int((sample.tree.query(ring)[0] > SIGHT).sum()) if len(ring) else 0.0
