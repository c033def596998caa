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
from .scatter import CELL_STD, LEAST_SPREAD, SIGMAS, shared_rounding

# A bendable outline has so many numbers more, if there are points for them, and at least so many to tell anything.
BENDS, LEAST_BENDS = 24, 6
BEND_COST = 36.0  # so set that 10 are left where A is 3.8 standard deviations above its mean
CORNER_BAND_SPREADS = 2.0  # from the second side: nearer points may be of either, and pull at both
SHARP = np.radians(75)  # a corner that turns so far is no bend


def lack_of_fit(points: Floats, figure: Circle | Outlines, spread: float, *, square: bool = False) -> float:
    """Return how much more a figure would cost if it could bend; below zero, it had better."""
    n_numbers = 3 if isinstance(figure, Circle) else 5 if square else 2 * figure.angles.shape[1]
    stiff = BEND_COST - bending(residuals_along(points, figure, spread), n_numbers, spread)
    if isinstance(figure, Circle) or figure.kind != "polygon":
        return stiff
    return min(stiff, sharpness(points, figure, spread))


def residuals_along(points: Floats, figure: Circle | Outlines, spread: float) -> Floats:
    """Return how far the points on a figure lie outside it, in their order along it, metres."""
    if isinstance(figure, Circle):
        place, distance = np.arctan2(*(points - figure.center).T), figure.signed_distance(points)
        on_it = np.abs(distance) <= SIGMAS * spread
    else:
        place, distance, second = figure.places(points)
        on_it = (np.abs(distance) <= SIGMAS * spread) & (second > CORNER_BAND_SPREADS * spread)
    return distance[on_it][np.argsort(place[on_it], kind="stable")]


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

    Around each shallow corner, out to the middle of the shorter of its two sides, the points' heights y over the line
    that bisects it are fitted once as a + b x + c |x|, a corner, and once as a + b x + c x^2, a bend, both with three
    numbers. What bends everywhere, such as an ellipse, can be cut into straight pieces, but has no corners.
    """
    corners, lengths = figure.corners()[0], np.subtract(*figure.spans()[::-1])[0]
    turns, gains = np.roll(figure.turns()[0], 1), []
    for i, (corner, angle, turn) in enumerate(zip(corners, figure.angles[0], turns, strict=True)):
        middle, reach = angle - turn / 2, min(lengths[i - 1], lengths[i]) / 2 * np.cos(turn / 2)
        y, x = ((points - corner) @ [(np.cos(middle), -np.sin(middle)), (np.sin(middle), np.cos(middle))]).T
        near = (np.abs(x) <= reach) & (np.abs(y + np.abs(x) * np.tan(turn / 2)) <= SIGMAS * spread / np.cos(turn / 2))
        gains.append(_corner_gain(x[near], y[near]) / spread**2 if np.abs(turn) < SHARP else np.inf)
    return float(np.min(np.array(gains) + np.roll(gains, 1)))


def _corner_gain(x: Floats, y: Floats) -> float:
    """Return by how much squared heights are less about a corner at x = 0 than about a bend."""
    if len(x) < 4:
        return 0.0
    misfit = []
    for shape in (x**2, np.abs(x)):
        design = np.column_stack([np.ones_like(x), x, shape])
        misfit.append(((y - design @ np.linalg.lstsq(design, y, rcond=None)[0]) ** 2).sum())
    return float(misfit[0] - misfit[1])
