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

import numpy as np

from ..arguments import Floats, Ints
from ..robust.scatter import scatter
from .families import Part

STEPS = 12
DAMPING = 1e-3  # of the mean information of a number
STRAY = 0.02  # of points that come from nowhere, spread evenly over STRAY_WIDTH metres across the outline
STRAY_WIDTH = 0.2


@dataclass(frozen=True, eq=False)
class Sample:
    """Points on an outline, shape (N, 2), metres; how far they spread from it, metres; and the colour of each, or None.

    Colours are numbers, shape (N,), -1 for unknown. A point belongs to no part of another colour.
    """

    points: Floats
    spread: float
    colors: Ints | None = None

    def own(self, parts: Sequence[Part], distances: Floats) -> Floats:
        """Return distances of the points from the parts, shape (P, N), with those from parts of other colours far."""
        if self.colors is None:
            return distances
        of_parts = np.array([part.color for part in parts])[:, None]
        return np.where((of_parts != self.colors) & (of_parts >= 0) & (self.colors >= 0), STRAY_WIDTH, distances)


def outside_union(parts: Sequence[Part], points: Floats) -> Floats:
    """Return how far points lie outside the union, shape (N,), metres; inside, how deep in the deepest part."""
    return np.min([part.outside(points) for part in parts], axis=0)


def cost_of(parts: Sequence[Part], sample: Sample) -> float:
    """Return -2 ln of the likelihood of the points, in units of a point right on the outline."""
    distance = sample.own(parts, np.array([part.outside(sample.points) for part in parts])).min(axis=0)
    density = scatter(distance, sample.spread)[0]
    best = scatter(np.zeros(1), sample.spread)[0][0]
    return float(-2 * np.log((STRAY / STRAY_WIDTH + (1 - STRAY) * density) / best).sum())


def fitted(parts: Sequence[Part], sample: Sample, steps: int = STEPS) -> list[Part]:
    """Return the parts with the numbers that explain the points best, near those that they have."""
    best, cost, damping = list(parts), cost_of(parts, sample), DAMPING
    for _ in range(steps):
        information, slope = _normal_equations(best, sample)
        ridge = damping * np.maximum(np.diag(information), information.diagonal().mean())
        step = np.linalg.solve(information + np.diag(ridge), -slope)
        at = np.split(step, np.cumsum([len(part.x) for part in best])[:-1])
        tried = [part.with_numbers(part.x + d) for part, d in zip(best, at, strict=True)]
        new = cost_of(tried, sample) if all(part.sound for part in tried) else np.inf
        if new < cost:
            settled = cost - new < 1e-3
            best, cost, damping = tried, new, damping / 3
            if settled:
                break
        else:
            damping *= 10
            if damping > 1e3:
                break
    return best


def _normal_equations(parts: Sequence[Part], sample: Sample) -> tuple[Floats, Floats]:
    """Return J' W J and J' W r of all numbers, shape (n, n) and (n,)."""
    points, spread = sample.points, sample.spread
    both = [part.distance(points) for part in parts]
    r = sample.own(parts, np.array([distance for distance, _ in both]))
    owner, row = r.argmin(axis=0), np.arange(len(points))
    slopes = np.concatenate([np.where((owner == i)[:, None], slope, 0.0) for i, (_, slope) in enumerate(both)], axis=1)
    least = r[owner, row]
    density, told = scatter(least, spread)
    weight = told * (1 - STRAY) * density / (STRAY / STRAY_WIDTH + (1 - STRAY) * density) / spread**2
    weight = np.maximum(weight, 0.02 / spread**2 * (np.abs(least) < 0.01))  # what lies off pulls, a little
    weighted = slopes * weight[:, None]
    return weighted.T @ slopes, weighted.T @ least
