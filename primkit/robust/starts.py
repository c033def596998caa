"""Pieces: an outline that was seen all around, cut into straight pieces in the best of all ways.

Points around a middle have an order: their bearings. In that order each side is one stretch, and a polygon is a choice
of cuts between stretches. All choices are compared, none is drawn at random: the sums of squares of all stretches come
from running sums, and the best k of them from the best k - 1, which is dynamic programming.

In:  points of one closed outline, shape (N, 2), metres, around the origin.
Out: a ``Cut`` for each number of sides: the outline, and how well the pieces fit.

>>> from primkit.shapes import Polygon
>>> ring = Polygon([(-0.1, -0.1), (0.1, -0.1), (0.1, 0.1), (-0.1, 0.1)]).outline(80)
>>> best = best_cuts(ring)
>>> [k for k in best if best[k].squares < 1e-12], best[4].outline.polygon().kind
([4, 5], 'rectangle')

Source: Bellman (1961), "On the approximation of curves by line segments using dynamic programming".
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..arguments import Floats
from .outlines import QUARTERS, Outlines, from_angle_order

KNOTS = 60  # cuts lie between two of so many places along the outline, a centimetre apart or less
FEWEST, MOST = 3, 5  # sides
LEAST_STRETCH = 0.01  # m: two thirds of the shortest side; the rest of it may not have been seen


@dataclass(frozen=True, eq=False)
class Cut:
    """The best way to cut the points into pieces.

    Parameters
    ----------
    moments : array, shape (6, K)
        Sums of 1, x, y, xx, yy and xy over the points of each piece.
    squares : float
        Sum of the squared distances of the points from their piece's line, square metres; points near the cuts are
        supposed to be as close as the others. The pieces need not meet in corners, nor bend: an outline with so many
        sides hardly comes closer to the points.
    """

    moments: Floats
    squares: float

    @cached_property
    def outline(self) -> Outlines:
        """The pieces' best lines, one row, their normals away from the origin; not always ``sound``."""
        xx, yy, xy = scatter_sums(self.moments)
        angles = 0.5 * np.arctan2(2 * xy, xx - yy) + np.pi / 2  # across the direction of most scatter
        offsets = (np.cos(angles) * self.moments[1] + np.sin(angles) * self.moments[2]) / self.moments[0]
        return from_angle_order(np.where(offsets < 0, angles + np.pi, angles)[None], np.abs(offsets)[None])

    @property
    def upright(self) -> Outlines:
        """Four pieces' lines with right angles, as the first of them lies."""
        outline = self.outline
        return Outlines(outline.angles[:, :1] + QUARTERS, outline.offsets)


def best_cuts(points: Floats) -> dict[int, Cut]:
    """Return the best cut for three, four and five sides, as far as there is one.

    Parameters
    ----------
    points : array, shape (N, 2)
        Metres, around the origin.

    Notes
    -----
    The first cut lies near the point that is farthest from the origin: of a polygon, that is a corner. Where exactly
    between two knots a cut lies, is left open, and the points there belong to no piece: so none is on a wrong one.
    """
    points = _from_farthest(points)
    n_knots = min(KNOTS, len(points))
    knots = np.arange(n_knots + 1) * len(points) // n_knots
    moments = moments_between(points, knots)
    squares = np.where(long_enough(points, knots), squares_of(moments), np.inf)
    best, last_cuts, cuts = squares[0], [], {}  # best[j]: the least squares of so many pieces that end at knot j
    for k in range(2, MOST + 1):
        longer = best[:, None] + squares
        last_cuts.append(longer.argmin(axis=0))
        best = longer.min(axis=0)
        if k >= FEWEST and np.isfinite(best[-1]):
            ends = _traced(last_cuts)
            pieces = moments[:, ends[:-1], ends[1:]]
            cuts[k] = Cut(pieces, float(best[-1]) * len(points) / float(pieces[0].sum()))
    return cuts


def _from_farthest(points: Floats) -> Floats:
    """Return the points in the order of their bearings, beginning where they are farthest; a lone stray is not."""
    points = points[np.argsort(np.arctan2(points[:, 1], points[:, 0]), kind="stable")]
    far = (points**2).sum(axis=1)
    ring = np.concatenate([far[-1:], far, far[:1]])
    with_both_neighbours = np.minimum(far, np.minimum(ring[:-2], ring[2:]))
    first = int(with_both_neighbours.argmax())
    return np.concatenate([points[first:], points[:first]])


def moments_between(points: Floats, knots: NDArray[np.intp]) -> Floats:
    """Return the sums of 1, x, y, xx, yy and xy over the points of each piece, shape (6, M, M).

    A piece from one cut to another begins a knot after the first, and ends a knot before the second.
    """
    x, y = points.T
    sums = np.zeros((6, len(points) + 1))
    np.cumsum([np.ones_like(x), x, y, x * x, y * y, x * y], axis=1, out=sums[:, 1:])
    sums = sums[:, knots]
    return sums[:, None, :-1] - sums[:, 1:, None]


def long_enough(points: Floats, knots: NDArray[np.intp], least: float = LEAST_STRETCH) -> NDArray[np.bool_]:
    """Tell which pieces can be as long as a side must be: from the knot before them to the one after, shape (M, M)."""
    x, y = points[knots % len(points)].T
    chord = (x[1:] - x[:-1, None]) ** 2 + (y[1:] - y[:-1, None]) ** 2
    return chord >= least**2


def scatter_sums(moments: Floats) -> tuple[Floats, Floats, Floats]:
    """Return the scatter sums xx, yy and xy about the mean of each piece."""
    n, x, y, xx, yy, xy = moments
    n = np.maximum(n, 1.0)
    mean_x, mean_y = x / n, y / n
    return xx - x * mean_x, yy - y * mean_y, xy - x * mean_y


def squares_of(moments: Floats) -> Floats:
    """Return the sum of squared distances from the best line of each piece; infinite where there is none."""
    xx, yy, xy = scatter_sums(moments)
    across = (xx + yy - np.sqrt((xx - yy) ** 2 + 4 * xy**2)) / 2  # the smaller eigenvalue of the scatter matrix
    return np.where(moments[0] >= 2, np.maximum(across, 0.0), np.inf)


def _traced(last_cuts: list[NDArray[np.intp]]) -> list[int]:
    """Return where the pieces are cut, from the first cut to the last."""
    ends = [len(last_cuts[0]) - 1]
    for cut in reversed(last_cuts):
        ends.append(int(cut[ends[-1]]))
    return [*ends, 0][::-1]
