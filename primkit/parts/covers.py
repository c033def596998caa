"""Covers: the fewest parts that explain an outline.

A part claims the places of the outline that lie on it. Sets of one, two, three, ... parts are compared by
the length that they leave unclaimed, the best are fitted to the points, and what remains is compared by evidence::

    cost  +  sum over the parts of (PART_PRICE + numbers x ln N)  +  NOT_SEEN x length in sight that no point is near

In:  proposals, places along the outline, and the points on it.
Out: ``Explanation``s, the best first.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..arguments import Floats
from .families import CORNERS_OF, Part
from .fitting import Sample, cost_of, fitted

MOST_PARTS = 4
PAIRS_KEPT, SETS_FITTED = 400, 20
PART_PRICE = 25.0  # beside its numbers: fewest parts win
NOT_SEEN = 2000.0  # per metre
SIGHT, IN_SIGHT = 0.015, 0.004  # m: a place so far outside all other parts has a point so near
ALIKE, CORNER_LEFT = 4, 0.004  # sets of the same kinds; share of the outline that a corner is worth
UNCLAIMED_MORE = 0.06  # share of the outline by which a set may claim less than the best of its size


@dataclass(frozen=True, eq=False)
class Explanation:
    """Parts that explain points, and what that costs."""

    parts: list[Part]
    cost: float

    @property
    def evidence(self) -> float:
        """The cost without what parts cost beside their numbers: that fewest parts win is a wish, and no evidence."""
        return self.cost - PART_PRICE * len(self.parts)

    @property
    def kinds(self) -> tuple[str, ...]:
        """The kinds of the parts, in the order of the alphabet."""
        return tuple(sorted(part.kind for part in self.parts))


def explanations(pool: Sequence[Part], places: Sample, sample: Sample, near: float) -> list[Explanation]:
    """Return the explanations by one to four parts of the pool, the best first; none if the pool is empty."""
    if not pool:
        return []
    distance = places.own(pool, np.array([part.outside(places.points) for part in pool]))
    claims = (np.abs(distance) <= near).astype(float)
    keep = _different(pool, claims)
    pool, claims = [pool[i] for i in keep], claims[keep]
    sets: list[tuple[int, ...]] = [(i,) for i in range(len(pool))]
    found, best = list[Explanation](), np.inf
    for size in range(1, MOST_PARTS + 1):
        if size > 1:
            sets = _extended(sets, claims)
        left = np.array([(claims[list(some)].max(axis=0) == 0).mean() for some in sets])
        order = np.argsort(left, kind="stable")
        sets = [sets[i] for i in order[:PAIRS_KEPT]]
        good = _varied(pool, sets, left[order])
        here = [_explained([pool[i] for i in some], sample) for some in good]
        found += here
        now = min((e.cost for e in here), default=np.inf)
        if now > best:
            break
        best = min(best, now)
    return sorted(found, key=lambda e: e.cost)


def _different(pool: Sequence[Part], claims: Floats) -> list[int]:
    """Return which proposals differ: of two of a kind with the same claims and extent, the first."""
    kept: list[int] = []
    extent = [np.concatenate([ring.mean(axis=0), np.ptp(ring, axis=0)]) for ring in (p.shape.outline(60) for p in pool)]
    for i, part in enumerate(pool):
        same = (
            (pool[j].kind, pool[j].color) == (part.kind, part.color)
            and np.abs(claims[i] - claims[j]).mean() < 0.01
            and np.abs(extent[i] - extent[j]).max() < 0.006
            for j in kept
        )
        if claims[i].any() and not any(same):
            kept.append(i)
    return kept


def _varied(pool: Sequence[Part], sets: Sequence[tuple[int, ...]], left: Floats) -> list[tuple[int, ...]]:
    """Return the sets to fit: those that leave least, of fewest corners first, and not too many of the same kinds."""
    corners = np.array([sum(CORNERS_OF[pool[i].kind] for i in some) for some in sets])
    chosen, of_kinds = [], Counter[tuple[str, ...]]()
    for k in np.argsort(left[: len(sets)] + CORNER_LEFT * corners, kind="stable"):
        kinds = tuple(sorted(pool[i].kind for i in sets[k]))
        if left[k] <= left[0] + UNCLAIMED_MORE and of_kinds[kinds] < ALIKE:
            of_kinds[kinds] += 1
            chosen.append(sets[k])
    return chosen[:SETS_FITTED]


def _extended(sets: Sequence[tuple[int, ...]], claims: Floats) -> list[tuple[int, ...]]:
    """Return the sets of one part more that leave least unclaimed."""
    left = np.array([claims[list(some)].max(axis=0) == 0 for some in sets], dtype=float)
    remain = left.sum(axis=1)[:, None] - left @ claims.T
    order = np.argsort(remain, axis=None, kind="stable")
    longer: dict[tuple[int, ...], None] = {}
    for flat in order:
        some, one = divmod(int(flat), len(claims))
        if one not in sets[some]:
            longer[tuple(sorted((*sets[some], one)))] = None
        if len(longer) >= PAIRS_KEPT:
            break
    return list(longer)


def _explained(parts: Sequence[Part], sample: Sample) -> Explanation:
    """Return parts fitted to the points, and what they cost."""
    parts = fitted(parts, sample)
    return Explanation(parts, full_cost(parts, sample))


def full_cost(parts: Sequence[Part], sample: Sample) -> float:
    """Return the cost of parts with their price, and that of what should have been seen."""
    price = sum(len(part.x) * np.log(len(sample.points)) + PART_PRICE for part in parts)
    return cost_of(parts, sample) + float(price) + NOT_SEEN * unseen(parts, sample.points)


def outline_of(parts: Sequence[Part], step: float = 0.003, in_sight: float = 0.0) -> Floats:
    """Return places of each part, a step or less apart, that lie ``in_sight`` outside the others, shape (M, 2)."""
    found = []
    for i, part in enumerate(parts):
        ring = part.shape.outline(max(8, int(part.shape.perimeter / step)))
        others = [other for j, other in enumerate(parts) if j != i]
        found.append(ring if not others else ring[np.min([o.outside(ring) for o in others], axis=0) >= in_sight])
    return np.concatenate(found)


def unseen(parts: Sequence[Part], points: Floats) -> float:
    """Return the length of the union's outline that no point is near, metres."""
    from scipy.spatial import cKDTree

    ring = outline_of(parts, in_sight=IN_SIGHT)
    return 0.003 * int((cKDTree(points).query(ring)[0] > SIGHT).sum()) if len(ring) else 0.0
