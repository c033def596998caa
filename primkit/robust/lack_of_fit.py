"""Lack of fit: whether the best of the shapes fits at all, or the thing is none of them.

A bounded family of shapes always has a best member. Whether that one fits, is asked of the points' residuals r: where
they are noise, they have no order along it. In B = p + ``BENDS`` blocks of n points, where p numbers were fitted,

    A = sum over blocks of (sum r)^2 / (n s^2 + n^2 rounding^2)

is ``BENDS`` in the mean, with the root of twice that as its deviation; s is what residuals scatter about their blocks'
means, so that it does not matter what spread was supposed, and rounding is what cells may do to a whole block alike.

In:  the points of one cluster, shape (N, 2), metres, a figure fitted to them, and how far points spread from outlines.
Out: by how much the figure is ahead of one that may bend, on the scale of ``Candidate.cost``.

>>> from primkit.shapes import Circle
>>> ring = Circle((0, 0), 0.05).outline(200)
>>> lack_of_fit(ring, Circle((0, 0), 0.05), 0.0004) > 10
True
>>> lack_of_fit(ring * (1.0, 0.93), Circle((0, 0), 0.0482), 0.0004) > 10  # an ellipse
False

Source: Fisher (1922), "The goodness of fit of regression formulae, and the distribution of regression coefficients".
"""

from __future__ import annotations

import numpy as np

from ..arguments import Floats
from ..shapes import Circle
from .outlines import Outlines
from .scatter import CELL, CELL_STD, FAR_CELLS, FAR_SPREADS, LEAST_SPREAD, SIGMAS, depth_of, shared_rounding

# A bendable outline has so many numbers more, if there are points for them, and at least so many to tell anything.
BENDS, LEAST_BENDS = 24, 6
BEND_COST = 36.0  # so set that 10 are left where A is 3.8 standard deviations above its mean
CORNER_BAND_SPREADS = 2.0  # from the second side: nearer points may be of either, and pull at both
SHARP = np.radians(75)  # a corner that turns so far is no bend


def lack_of_fit(points: Floats, figure: Circle | Outlines, spread: float, *, square: bool = False) -> float:
    """Return how much more a figure would cost if it could bend; below zero, it had better."""
    n_numbers = 3 if isinstance(figure, Circle) else 5 if square else 2 * figure.angles.shape[1]
    residuals = residuals_along(points, figure, spread)
    stiff = BEND_COST - bending(residuals[np.abs(residuals) <= SIGMAS * spread], n_numbers, spread)
    if isinstance(figure, Circle) or figure.kind != "polygon":
        return stiff
    return min(stiff, sharpness(points, figure, spread))


def lacks_corner(points: Floats, figure: Circle | Outlines, spread: float) -> bool:
    """Tell whether two neighbours lie beside a figure: no strays, but a corner that it does not have."""
    beside = np.abs(residuals_along(points, figure, spread)) > depth_of(spread)
    return bool((beside & np.roll(beside, 1)).any())


def residuals_along(points: Floats, figure: Circle | Outlines, spread: float) -> Floats:
    """Return how far the points on a figure, or beside it, lie outside it, in their order along it, metres."""
    if isinstance(figure, Circle):
        place, distance = np.arctan2(*(points - figure.center).T), figure.signed_distance(points)
        told = np.ones(len(points), dtype=bool)
    else:
        place, distance, second = figure.places(points)
        told = second > CORNER_BAND_SPREADS * spread
    told &= np.abs(distance) <= FAR_SPREADS * spread + FAR_CELLS * CELL
    return distance[told][np.argsort(place[told], kind="stable")]


def bending(residuals: Floats, n_numbers: int, spread: float) -> float:
    """Return A - its mean: by how much bends would come closer to the points; ``BEND_COST`` for too few points."""
    bends = min(BENDS, len(residuals) // 2 - n_numbers)
    if bends < LEAST_BENDS:
        return BEND_COST
    n_blocks = n_numbers + bends
    block = np.arange(len(residuals)) * n_blocks // len(residuals)
    block = block.astype(np.intp, copy=False)
    sums, n = np.bincount(block, residuals), np.bincount(block)
    within = ((residuals**2).sum() - (sums**2 / n).sum()) / (len(residuals) - n_blocks)
    variance = n * max(within, LEAST_SPREAD**2) + n**2 * shared_rounding(spread) * CELL_STD**2
    return float((sums**2 / variance).sum() - bends)


def sharpness(points: Floats, figure: Outlines, spread: float) -> float:
    """Return how much more it costs to round off the two neighbouring corners that are least sharp.

    What bends everywhere, such as an ellipse, can be cut into straight pieces, but has no corners. So three sides with
    two shallow corners are compared with a curve that cuts off both. When the sides have turned and moved as is best, r
    remains of the points' heights over them, and e of the curve's; it costs (|e - r|^2 - |r|^2) / spread^2 more. At the
    distance u from a corner that turns by t the curve lies sin(t / 2) (a - u)^2 / (2 a) inside, a parabola, where a is
    half of the shorter of the corner's two sides.
    """
    place, height, _ = figure.places(points)
    lengths, turns, gains = np.subtract(*figure.spans()[::-1])[0], np.roll(figure.turns()[0], 1), [np.inf]
    first, on_it = np.cumsum(lengths) - lengths, np.abs(height) <= SIGMAS * spread
    side = np.searchsorted(first, place, side="right") - 1
    for i in range(len(turns)):
        corners = [i, (i + 1) % len(turns)]
        if np.abs(turns[corners]).max() >= SHARP:
            continue
        nth = (side - i + 1) % len(turns)  # the three sides are 0, 1 and 2
        near = on_it & (nth <= 2)
        own, u, nth = side[near], (place - first[side])[near], nth[near]
        design = np.hstack([np.eye(3)[nth], np.eye(3)[nth] * u[:, None]])
        inside = np.zeros_like(u)
        for at, corner in enumerate(corners):
            away = np.where(nth == at, lengths[own] - u, np.where(nth == at + 1, u, np.inf))
            leaves = np.minimum(lengths[corner], lengths[corner - 1]) / 2
            inside += np.sin(turns[corner] / 2) * np.maximum(leaves - away, 0.0) ** 2 / (2 * leaves)
        heights = np.column_stack([height[near], -inside])
        r, e = (heights - design @ np.linalg.lstsq(design, heights, rcond=None)[0]).T
        gains.append(float(e @ e - 2 * r @ e) / spread**2)
    return min(gains)
