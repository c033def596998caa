"""Scatter: how far points lie from the outline that they were seen on.

A LiDAR errs along its beam. Where the beam meets the outline squarely, all of that error leads away from it; where it
grazes, hardly any. An outline seen from all around is met at every angle, so that the scatter across it is no single
bell curve but a mixture of narrow and wide ones. The grid's cells add their own rounding.

In:  signed distances of points from outlines, metres, and how far points spread from outlines.
Out: how likely such distances are, and how much each of the points tells about the outline.

>>> density, weight = scatter(np.array([0.0, 0.01]), spread=0.005)
>>> bool(density[0] > density[1]), bool(weight[0] > 1 > weight[1])
(True, True)

A beam hits at the angle a with a likelihood that goes with cos a, so that u = sin a is even between -1 and 1, and the
share of the error that leads across is c = cos a = sqrt(1 - u^2). Three values of u, Gauss and Legendre's, give the
mixture its exact second and fourth moments: c^2 is 2/3 in the mean, c^4 is 8/15.

Source: the quadrature is in Abramowitz and Stegun (1964), "Handbook of Mathematical Functions", table 25.4.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ..arguments import Floats, as_points

CELL = 0.001  # m: side of the grid's cells, as in the paper; all that follows supposes points on such a grid
CELL_STD = CELL / 12**0.5  # m: a cell's centre lies evenly within half a cell of the point
# No sensor brings the spread [m] below this: a third more, because neighbours along a side err together.
LEAST_SPREAD = 1.33 * CELL_STD

SIGMAS = 3.0  # a point within three standard deviations may belong to a shape
FAR_SPREADS, FAR_CELLS = 9.0, 4.0  # a point farther than both together is a stray
GHOSTS = 0.02  # share of returns that come from nowhere
NOWHERE = GHOSTS / 0.05  # their density near a shape, over which so many square metres of them are spread
# Length [m] over which the others are spread. One length for all outlines: were it each outline's own, points seen on
# a half of a circle would speak for whatever shape closes that half on the shortest way.
OUTLINE_LENGTH = 0.5

DEEP_CELLS, DEEP_NOISE = 1.25, 5.0  # inside: farther than cells and noise, times its deviation, bring a point
NEIGHBOURS = 10  # enough for a line with its spread, few enough for a curve to be straight
ENOUGH_POINTS = 400  # of more, an even part tells the spread, or fits a first figure, nearly as well

ACROSS = 1 - (0.5 + np.array([-1.0, 0.0, 1.0]) * 0.15**0.5) ** 2  # c^2 at the quadrature's three u, and their shares
SHARES = np.array([5.0, 8.0, 5.0]) / 18
MEAN_ACROSS = 2 / 3
# The standard deviation of such a mixture, over its median distance from 0; of a single bell curve it is 1.4826.
STD_OF_MEDIAN = 1.651
BELL = 1.4826


def spread_across(noise_std: float) -> float:
    """Return how far points spread from outlines when ranges err by ``noise_std``, both metres.

    >>> round(spread_across(0.0) / CELL, 2), round(spread_across(0.01), 4)
    (0.38, 0.0082)
    """
    return float(np.hypot(MEAN_ACROSS**0.5 * noise_std, LEAST_SPREAD))


def noise_of(spread: float) -> float:
    """Return by how much ranges err when points spread so far from outlines, both metres: undoes ``spread_across``.

    >>> round(noise_of(spread_across(0.002)), 6), noise_of(0.0)
    (0.002, 0.0)
    """
    return float(np.sqrt(max(spread**2 - LEAST_SPREAD**2, 0.0) / MEAN_ACROSS))


def depth_of(spread: float) -> float:
    """Return how deep inside an outline cells and noise bring points at most, metres: no beam gets there.

    >>> round(depth_of(LEAST_SPREAD) / CELL, 2)
    1.25
    """
    return DEEP_CELLS * CELL + DEEP_NOISE * noise_of(spread)


def shared_rounding(spread: float) -> float:
    """Return to what share neighbours along a side are rounded alike by the cells: noise shakes them apart.

    >>> shared_rounding(LEAST_SPREAD), round(shared_rounding(spread_across(0.001)), 6)
    (1.0, 0.0)
    """
    return float(np.exp(-((2 * np.pi / CELL) ** 2) * max(spread**2 - LEAST_SPREAD**2, 0.0)))


def spread_from_median(median: float) -> float:
    """Return the spread of points whose median distance from their outlines this is, both metres.

    The median does not mind strays. What exceeds the cells' part, a bell curve, is the mixture's.
    """
    beyond = max(median**2 - (LEAST_SPREAD / BELL) ** 2, 0.0)
    return float(np.hypot(LEAST_SPREAD, STD_OF_MEDIAN * beyond**0.5))


def scatter(distance: Floats, spread: float) -> tuple[Floats, Floats]:
    """Return the density of points at these distances across an outline, per metre, and how much each tells about it.

    That is 1 / variance of the bell curve that the point belongs to, times ``spread^2``: 1 for all without noise; else
    more than 1 for a point near the outline, which was seen at a grazing angle, and less for one far off.
    """
    noise, squared = noise_of(spread), distance**2
    least = -700.0  # what underflows takes ten times as long
    if noise == 0:
        density = np.exp(np.maximum(-0.5 / spread**2 * squared, least)) / (np.sqrt(2 * np.pi) * spread)
        return density, np.ones_like(squared)
    variances = LEAST_SPREAD**2 + noise**2 * ACROSS
    both = list(zip((SHARES / np.sqrt(2 * np.pi * variances)).tolist(), variances.tolist(), strict=True))
    parts = [height * np.exp(np.maximum(-0.5 / v * squared, least)) for height, v in both]
    density = parts[0] + parts[1] + parts[2]
    return density, sum(part * (spread**2 / v) for part, (_, v) in zip(parts, both, strict=True)) / density


def shares_smooth(distance: Floats, spread: float) -> tuple[Floats, Floats, float]:
    """Return what ``refine.shares`` returns, for an outline without corners at these distances, shape (N,)."""
    across, told = scatter(distance, spread)
    density = (1 - GHOSTS) * across / OUTLINE_LENGTH
    total = density + NOWHERE
    return density / total, told, float(np.log(total).sum())


def spread_of(points: ArrayLike) -> float:
    """Return the standard deviation of points from the outlines that they lie on, before any is known, metres.

    Each point's neighbours lie on a piece of outline that is nearly straight: what they scatter across it is
    the spread, and the median over some hundred places does not mind corners and strays.

    Notes
    -----
    Too low when the spread is larger than the distance between neighbours: by a quarter to a third at 10 mm.

    Examples
    --------
    >>> spread_of([]) == LEAST_SPREAD
    True
    """
    from scipy.spatial import cKDTree

    points = as_points(points)
    if len(points) < NEIGHBOURS:
        return LEAST_SPREAD
    near = cKDTree(points).query(points[:: -(-len(points) // ENOUGH_POINTS)], NEIGHBOURS)[1]  # (M, NEIGHBOURS)
    x, y = points[:, 0][near], points[:, 1][near]
    x, y = x - x.mean(axis=1, keepdims=True), y - y.mean(axis=1, keepdims=True)
    xx, yy, xy = (x * x).sum(axis=1), (y * y).sum(axis=1), (x * y).sum(axis=1)
    across = (xx + yy - np.hypot(xx - yy, 2 * xy)) / 2  # the smaller eigenvalue of the scatter matrix
    variance = np.maximum(across, 0.0) / (NEIGHBOURS - 2)  # two numbers fix a line
    return max(LEAST_SPREAD, float(np.sqrt(np.median(variance))))
