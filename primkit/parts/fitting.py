"""Fitting: all parts of a composite together, to all of its points.

The outline of a union is where the least of the parts' signed distances is zero::

    r(p) = min over the parts of  outside_part(p)

A point belongs to the part of the least r. By weighted least squares (Gauss and Newton, damped), all numbers of all
parts at once; the weights are those of ``robust.scatter``.

In:  parts, and a ``Sample`` of points.
Out: parts again, and what they cost: -2 ln of how likely they make the points.

>>> from primkit.shapes import Circle
>>> rough = [Part("circle", np.array([0.01, 0.0, 0.05]))]
>>> (fitted(rough, Sample(Circle((0, 0), 0.06).outline(100), 0.0004))[0].x.round(6) + 0.0).tolist()
[0.0, 0.0, 0.06]
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ..arguments import Floats, Ints
from ..robust.scatter import CELL, scatter
from .families import Part

STEPS = 12
WORTH_A_STEP = 0.1  # of the cost
OUTWARDS = (0.004, 0.008, 0.016, 0.03, 0.06)  # m by which a side is pushed out, by each that is free
FREE_COST = 3.0  # what is no more costs nothing
DAMPING, MOST_DAMPING = 1e-3, 1e3  # of the mean information of a number
LEAST_PULL, PULLED = 0.02, 0.01  # what lies off pulls a little; m, if it is as near as this
STRAY = 0.02  # of points that come from nowhere, spread evenly over STRAY_WIDTH metres across the outline
STRAY_WIDTH = 0.2
NOWHERE_ACROSS = STRAY / STRAY_WIDTH / (1 - STRAY)  # their density, as one of the others


@dataclass(frozen=True, eq=False)
class Sample:
    """Points on an outline, shape (N, 2), metres; how far they spread from it, metres; and the colour of each, or None.

    Colours are numbers, shape (N,), -1 for unknown. A point belongs to no part of another colour. ``beside``, shape
    (N,), metres: how far the points lie outside of other parts, which are known and stay. ``room``: what no corner of a
    hidden side leaves, a shapely polygon.
    """

    points: Floats
    spread: float
    colors: Ints | None = None
    beside: Floats | float = np.inf
    room: Any = None

    @cached_property
    def tree(self) -> Any:
        """The points in a tree, to find the nearest."""
        from scipy.spatial import cKDTree

        return cKDTree(self.points)

    @property
    def known_colors(self) -> list[int]:
        """The numbers of the colours of parts: -1 alone where none is known."""
        return [-1] if self.colors is None else np.unique(self.colors[self.colors >= 0]).tolist() or [-1]

    def outside(self, parts: Sequence[Part]) -> Floats:
        """Return how far the points lie outside of each part, shape (P, N), metres; of other colours: far."""
        distances = np.array([part.outside(self.points) for part in parts])
        if self.colors is None:
            return distances
        of_parts = np.array([part.color for part in parts]).reshape(-1, *[1] * (distances.ndim - 1))
        other = (of_parts != self.colors) & (of_parts >= 0) & (self.colors >= 0)
        return np.where(other, STRAY_WIDTH, distances)


def outside_union(parts: Sequence[Part], points: Floats) -> Floats:
    """Return how far points lie outside the union, shape (N,), metres; inside, how deep in the deepest part."""
    return np.min([part.outside(points) for part in parts], axis=0)


def cost_of(parts: Sequence[Part], sample: Sample) -> float:
    """Return -2 ln of the likelihood of the points, in units of a point right on the outline."""
    return float(cost_at(sample.outside(parts).min(axis=0), sample))


def cost_of_each(parts: Part, sample: Sample) -> Floats:
    """Return the cost of each of many parts of one kind, alone, shape (M,)."""
    return cost_at(sample.outside([parts])[0], sample)


def cost_at(distance: Floats, sample: Sample) -> Floats:
    """Return the cost of the points at these distances from the outline, shape (..., N) -> (...)."""
    on_it = scatter(np.zeros(1), sample.spread)[0]
    density = scatter(np.minimum(distance, sample.beside), sample.spread)[0]
    return -2 * np.log((NOWHERE_ACROSS + density) / on_it).sum(axis=-1)


def fitted(parts: Sequence[Part], sample: Sample, steps: int = STEPS) -> list[Part]:
    """Return the parts with the numbers that explain the points best, near those that they have."""
    best, damping, ends = list(parts), DAMPING, np.cumsum([len(part.x) for part in parts])
    distances = sample.outside(best)
    cost, fresh = float(cost_at(distances.min(axis=0), sample)), True
    for _ in range(steps):
        if fresh:
            information, slope = np.zeros((ends[-1], ends[-1])), np.zeros(ends[-1])
            owner, weight = distances.argmin(axis=0), _weights(distances.min(axis=0), sample)
            for i, (part, last) in enumerate(zip(best, ends, strict=True)):
                own = np.flatnonzero((owner == i) & (weight > 0))
                some = slice(last - len(part.x), last)
                slopes = part.distance_slopes(sample.points[own])
                weighted = slopes.T * weight[own]
                information[some, some], slope[some] = weighted @ slopes, weighted @ distances[i, own]
        step = _step(information, slope, np.array(damping))
        tried = [part.with_numbers(part.x + d) for part, d in zip(best, np.split(step, ends[:-1]), strict=True)]
        moved = sample.outside(tried)
        new = float(cost_at(moved.min(axis=0), sample)) if all(part.sound for part in tried) else np.inf
        fresh = bool(new < cost)
        if fresh:
            settled = cost - new < WORTH_A_STEP
            best, distances, cost, damping = tried, moved, new, damping / 3
            if settled:
                break
        elif (damping := damping * 10) > MOST_DAMPING:
            break
    return best


def fitted_each(parts: Part, sample: Sample, steps: int) -> Part:
    """Return many parts of one kind, numbers of shape (M, n), each fitted for itself.

    ``sample.beside`` may differ from part to part, shape (M, N).
    """
    damping = np.full(len(parts.x), DAMPING)
    distance = sample.outside([parts])[0]
    cost = cost_at(distance, sample)
    for _ in range(steps):
        slopes = parts.distance_slopes(sample.points)
        weighted = np.swapaxes(slopes * _weights(distance, sample)[..., None], 1, 2)
        step = _step(weighted @ slopes, (weighted @ distance[..., None])[..., 0], damping)
        tried = parts.with_numbers(parts.x + step)
        moved = sample.outside([tried])[0]
        new = np.where(tried.sound, cost_at(moved, sample), np.inf)
        better = new < cost
        parts = parts.with_numbers(np.where(better[:, None], tried.x, parts.x))
        distance, cost = np.where(better[:, None], moved, distance), np.where(better, new, cost)
        damping = np.where(better, damping / 3, damping * 10)
    return parts


def deepened(parts: Part, sample: Sample, by: Sequence[float] = OUTWARDS[1:]) -> Part:
    """Return many parts of one kind with each side pushed out as far as that is free; as ``fitted_each``.

    Where a side is hidden, the points tell only that it is deep enough: so it comes to lie deep in other parts.
    """
    import shapely

    if parts.kind == "circle":
        return parts
    colors = np.full(len(sample.points), -1) if sample.colors is None else sample.colors
    strangers = sample.points[(colors >= 0) & (colors != parts.color) & (parts.color >= 0)]
    most, on_it = cost_of_each(parts, sample) + FREE_COST, (parts.outside(strangers) < CELL).sum(axis=1)
    for way in np.moveaxis(parts.pushes, 1, 0):
        for step in by:
            tried = parts.with_numbers(parts.x + step * way)
            inside = (
                shapely.contains_xy(sample.room, *np.moveaxis(tried.corners, -1, 0)).all(axis=1)
                if sample.room
                else True
            )
            free = tried.sound & inside & (cost_of_each(tried, sample) <= most)
            free &= (tried.outside(strangers) < CELL).sum(axis=1) <= on_it  # a part has one colour
            parts = parts.with_numbers(np.where(free[:, None], tried.x, parts.x))
    return parts


def _weights(distance: Floats, sample: Sample) -> Floats:
    """Return how much points at these distances tell about the outline, of the shape of the distances, 1/m^2."""
    density, told = scatter(distance, sample.spread)
    weight = told * density / (NOWHERE_ACROSS + density)
    weight = np.maximum(weight, LEAST_PULL * (np.abs(distance) < PULLED)) / sample.spread**2
    return np.where(distance < sample.beside, weight, 0.0)


def _step(information: Floats, slope: Floats, damping: Floats) -> Floats:
    """Return the damped step against the slope, shape (..., n)."""
    diagonal = np.diagonal(information, axis1=-2, axis2=-1)
    ridge = damping[..., None] * (1 + np.maximum(diagonal, diagonal.mean(axis=-1, keepdims=True)))
    return np.linalg.solve(information + ridge[..., None] * np.eye(slope.shape[-1]), -slope[..., None])[..., 0]
