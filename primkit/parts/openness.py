"""Openness: what an outline leaves open about the parts that it is the union of.

A union hides what lies inside. Two questions, for each part of an explanation:

1. *Sizes.* Can a size change by SIZE_STEP while no place of the outline moves by more than SAME? Of all changes dx of
   the part's numbers that change the size so much, the one that moves the shown places least is a linear programme::

       least t  with  -t <= J dx <= t,  D dx = +-SIZE_STEP

   J: how the shown places move with the numbers, D: how the size does. The change is then made, and the outlines are
   compared. What points alone leave open is told by rivals of the same kinds (``apart.py``).
2. *Kinds.* A stretch of a part's hull that lies inside the union, LEAST_FREE_SIDE long or longer, may hide a corner:
   in the style "free" a part with fewer than five corners may then be a pentagon. A part that shows two neighbouring
   sides alone could be a triangle. Which other kinds explain the points as well is a matter of evidence (``apart.py``).

In:  the ``Part``s of an explanation.
Out: for each part, which of its sizes are open; and how much of its hull hides a stretch.

>>> tall = Part("rectangle", np.array([0.0, 0.0, 0.0, 0.1, 0.3]))
>>> wide = Part("rectangle", np.array([0.1, -0.1, 0.0, 0.2, 0.1]))  # its left end lies somewhere inside the tall one
>>> open_sizes([tall, wide], 0).tolist(), open_sizes([tall, wide], 1).tolist()
([False, False], [True, False])
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..arguments import Bools, Floats
from ..random_shapes import LEAST_FREE_SIDE
from ..shapes import Kind
from .families import Part
from .fitting import OUTWARDS, Sample, deepened, fitted, outside_union
from .search import outline_of

SIZE_STEP, SAME = 0.006, 0.001  # m: sizes that differ by more are different, outlines that differ by less are the same
MOST_CHANGE = 0.05  # m and rad: numbers change by no more
SMALL = 1e-3  # what a change of the numbers costs beside one of the outline: the smallest change is taken
SAME_AS_SEEN = 0.0012  # m: with what the linear programme leaves out
STEPS_AGAIN = 5  # of fitting
STICKS_OUT = 0.005  # m
INSIDE = 0.003  # m from the outline: that deep, a stretch of hull is hidden


def open_sizes(parts: Sequence[Part], i: int) -> Bools:
    """Return which sizes of part i can change while the outline of the union does not, shape (S,).

    Of a triangle the corners are taken to be free: that two of its sides are alike is no measurement.
    """
    from scipy.optimize import linprog

    parts = [*parts[:i], parts[i].freed(), *parts[i + 1 :]]
    part, others = parts[i], [*parts[:i], *parts[i + 1 :]]
    shown = shown_places(part, others)
    n = len(part.x)
    J, D = part.distance_slopes(shown), size_slopes(part)
    none, one = np.zeros((len(J), n)), -np.ones((len(J), 1))
    eye, zero = np.eye(n), np.zeros((n, 1))
    limits = np.block([[J, none, one], [-J, none, one], [eye, -eye, zero], [-eye, -eye, zero]])
    price = np.concatenate([np.zeros(n), np.full(n, SMALL), [1.0]])
    bounds = [(-MOST_CHANGE, MOST_CHANGE)] * n + [(0, None)] * (n + 1)
    is_open = np.zeros(len(D), dtype=bool)
    for k, slope in enumerate(D):
        for step in (SIZE_STEP, -SIZE_STEP):
            equal = np.concatenate([slope, np.zeros(n + 1)])[None]
            best = linprog(price, limits, np.zeros(len(limits)), equal, [step], bounds)
            if best.status == 0 and best.x[-1] <= SAME:
                changed = part.with_numbers(part.x + best.x[:n])
                is_open[k] |= changed.sound and (_apart(parts, [*others, changed]) <= SAME_AS_SEEN)
    return is_open


def shown_places(part: Part, others: Sequence[Part], step: float = 0.002, beyond: float = SAME / 2) -> Floats:
    """Return places of a part's outline that lie so far beyond the others, off its corners, shape (M, 2), metres.

    A stretch that nowhere lies STICKS_OUT outside is none that shows: noise lets hidden corners stick out.
    """
    ring = part.shape.outline(max(12, int(part.shape.perimeter / step)))
    shown = np.ones(len(ring), dtype=bool)
    if others:
        out = outside_union(others, ring)
        shown = out > beyond
        stretch = np.cumsum(np.diff(shown, prepend=shown[0]))
        stretch[stretch == stretch[-1]] = 0 if shown[0] == shown[-1] else stretch[-1]
        farthest = np.full(stretch.max() + 1, -np.inf)
        np.maximum.at(farthest, stretch, out)
        shown &= farthest[stretch] > STICKS_OUT
    if part.kind != "circle":
        shown &= np.hypot(*(ring[:, None] - part.corners).transpose(2, 0, 1)).min(axis=1) > SAME / 2
    return ring[shown]


def size_slopes(part: Part) -> Floats:
    """Return the derivatives of a part's sizes by its numbers, shape (S, n)."""
    if part.kind == "circle":
        return np.array([[0.0, 0.0, 1.0]])
    along = np.roll(part.corners, -1, axis=0) - part.corners
    along /= np.hypot(*along.T)[:, None]
    slopes = np.einsum("kc,kcn->kn", along, np.roll(part.slopes, -1, axis=0) - part.slopes)
    return slopes[:2] if part.kind == "rectangle" else slopes


def sizes_differ(part: Part, other: Part) -> Bools:
    """Return which sizes of a part, by their rank, are not those of another of its kind, shape (S,)."""

    def sizes(of: Part) -> Floats:
        sides = np.hypot(*(np.roll(of.corners, -1, axis=0) - of.corners).T)
        return np.abs(of.x[2:]) if of.kind == "circle" else sides[:2] if of.kind == "rectangle" else sides

    mine, theirs = sizes(part), sizes(other)
    differ = np.zeros(len(mine), dtype=bool)
    differ[np.argsort(mine)] = np.abs(np.sort(mine) - np.sort(theirs)) > SIZE_STEP
    return differ


def _apart(parts: Sequence[Part], changed: Sequence[Part]) -> float:
    """Return the greatest distance of the outline of either union, slits closed, from the other's, metres."""
    import shapely

    unions = [shapely.union_all([part.shape.to_shapely() for part in some]) for some in (parts, changed)]
    one, other = shapely.boundary(
        shapely.buffer(shapely.buffer(unions, INSIDE, join_style="mitre"), -INSIDE, join_style="mitre")
    )
    return float(shapely.hausdorff_distance(one, other, densify=0.02))


def all_deepened(parts: Sequence[Part], sample: Sample) -> list[Part]:
    """Return the parts with hidden sides deep in the others."""
    deep = list(parts)
    for i, part in enumerate(parts):
        if others := [*deep[:i], *deep[i + 1 :]]:
            known = replace(sample, beside=sample.outside(others).min(axis=0))
            deep[i] = part.with_numbers(deepened(part.with_numbers(part.x[None]), known, OUTWARDS[::-1]).x[0])
    return fitted(deep, sample, STEPS_AGAIN)


def drawn_in(parts: Sequence[Part], i: int, beyond: float = SAME / 2) -> Part:
    """Return part i with each hidden side drawn in to what the part shows: so far it must reach, at least."""
    part = found = parts[i]
    shown = shown_places(part, [*parts[:i], *parts[i + 1 :]], step=0.001, beyond=beyond)
    if part.kind != "circle" and len(shown) > 2:
        normals, offsets = part.lines
        for gap, way in zip(offsets - (shown @ normals.T).max(axis=0), part.pushes, strict=True):
            tried = part.with_numbers(found.x - gap * way)
            if gap > INSIDE and tried.sound and np.abs(tried.outside(shown) - part.outside(shown)).max() < SAME / 2:
                found = tried
    return found


def kinds_as_shown(parts: Sequence[Part], i: int) -> set[Kind]:
    """Return the other kinds that could show what part i shows: triangles, and pentagons with a corner inside."""
    import shapely
    from scipy.spatial import cKDTree

    part, others, found = parts[i], [*parts[:i], *parts[i + 1 :]], set[Kind]()
    shown = shown_places(part, others)
    if part.kind in ("rectangle", "pentagon"):
        normals, offsets = part.lines
        sides = np.unique((normals @ shown.T - offsets[:, None]).argmax(axis=0))
        if len(sides) <= 1 or (len(sides) == 2 and np.ptp(sides) in (1, len(offsets) - 1)):
            found.add("triangle")
    if part.style == "free" and part.kind in ("rectangle", "triangle") and others and len(shown) >= 3:
        ring = shapely.get_coordinates(shapely.MultiPoint(shown).convex_hull.exterior.segmentize(0.001))
        hidden = cKDTree(outline_of(parts, 0.001, SAME)).query(ring)[0] > INSIDE
        if 0.001 * int(hidden.sum()) > LEAST_FREE_SIDE:
            found.add("pentagon")
    return found
