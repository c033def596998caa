"""Deviations: how sure each number of a shape is, and which numbers were measured at all.

In:  a fitted figure, the points that lie on it, how far they spread, and by which scan each was seen.
Out: ``Certainty``: standard deviations of the centre's coordinates and of the dimensions, metres; infinite for a
dimension that hangs on a side that was never seen, and for one that is known no better than before any was.

>>> from primkit.shapes import Circle
>>> ring = Circle((0, 0), 0.05).outline(100)
>>> sure = certainty(Circle((0, 0), 0.05), ring, 0.001, noise_std=0.001)
>>> [round(1000 * s, 2) for s in sure.dimension_std]
[0.02]

The fitted numbers q are those for which the points' equations add up to zero, as at the end of ``refine_soft``:

    sum over points g(p; q) = 0,    g = share_k told(r) r dr/dq    summed over the sides k

So a point that moves across by e moves them by A e, A = -(sum dg/dq)^-1 dg/de. Both slopes are differences: shares
between sides, which noise around a corner blurs, and far points that are held back, are then as they were in the fit.
What e is, ``covariance`` tells. To one side a number may slip farther than to first order; see ``_wider``.

Sources: Huber (1967), "The behavior of maximum likelihood estimates under nonstandard conditions".
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..arguments import Floats, Ints
from ..seen import seen_shares
from ..shapes import Circle
from .covariance import Linearised, covariance
from .evidence import PRIOR_WIDTH
from .outlines import Outlines
from .refine import LEAST_OF_SIDE, shares
from .scatter import SIGMAS, shares_smooth

# A side was seen when so many points lie on it, over such a length [m] and such a share of it, and not near a corner,
# where they may as well belong to the neighbour: a line over a hidden side touches the last points of both neighbours.
# What shows less may as well be a piece of something else; so may an arc of less than such a share of its circle.
LEAST_ON_SIDE = 4
LEAST_SEEN_STRETCH = 0.008
LEAST_SHARE = 0.4
LEAST_OF_CIRCLE = 0.45
CORNER_SPREADS = 4.0
LEAST_RISE = 0.6  # of what -2 ln L should rise by, ``SIGMAS`` deviations off
STEP = 1e-6  # rad and m, and spreads: the derivatives' step, far above rounding and far below any curvature


@dataclass(frozen=True)
class Certainty:
    """How sure a shape's numbers are, as standard deviations."""

    center_std: tuple[float, ...]  # of x and y of the centroid; infinite when a side was not seen
    dimension_std: tuple[float, ...]  # of each dimension; infinite when it was not measured


def certainty(
    figure: Circle | Outlines,
    points: Floats,
    spread: float,
    *,
    square: bool = False,
    scans: Ints | None = None,
    noise_std: float = 0.0,
) -> Certainty:
    """Return the standard deviations of centre and dimensions of a figure that was fitted to the points on it.

    ``noise_std`` is by how much ranges err on their own, as far as that is known, metres: what points of unknown scans
    scatter beyond may be shared by all points of a scan.
    """
    scans = np.zeros(len(points), dtype=np.int64) if scans is None else scans
    if isinstance(figure, Circle):
        x, y, radius = np.sqrt(np.diag(covariance(_of_circle(figure, points, spread), scans, noise_std))).tolist()
        enough = seen_shares(figure, points)[0] >= LEAST_OF_CIRCLE and radius <= PRIOR_WIDTH
        return Certainty((x, y), (radius if enough else float("inf"),))
    each = np.eye(2 * figure.angles.shape[1])  # K angles and K offsets; right angles have one angle for all
    fitted = np.column_stack([each[:, :4].sum(axis=1), each[:, 4:]]) if square else each
    spreads = fitted @ covariance(_of_sides(figure, points, spread, fitted), scans, noise_std) @ fitted.T
    seen = sides_seen(figure, points, spread)
    rectangle = figure.kind == "rectangle"
    center, dimension = _derivatives(figure, rectangle)
    measured = _measured(figure, seen, square, rectangle)
    shifts = np.vstack([center, dimension]) @ spreads
    std = np.sqrt((shifts * np.vstack([center, dimension])).sum(axis=1))
    std *= _wider(figure, points, spread, shifts / std[:, None])
    std = np.where(np.append(np.full(2, seen.all()), measured) & (std <= PRIOR_WIDTH), std, np.inf)
    return Certainty(tuple(std[:2].tolist()), tuple(std[2:].tolist()))


def _measured(figure: Outlines, seen: NDArray[np.bool_], square: bool, rectangle: bool) -> NDArray[np.bool_]:
    """Tell which dimensions hang on seen sides only, shape (D,)."""
    if square:  # width and height each hang on the two sides across
        return np.array([seen[1] and seen[3], seen[0] and seen[2]])[_by_width(figure)]
    if rectangle:  # without right angles that were imposed, both hang on all
        return np.full(2, seen.all())
    return np.roll(seen, 1) & seen & np.roll(seen, -1)  # a side ends where its neighbours' lines cross it


def own_points(figure: Outlines, points: Floats, spread: float, room: float = CORNER_SPREADS) -> NDArray[np.bool_]:
    """Tell which points, shape (N, 2), lie on which of the K sides and not near a corner of it, shape (N, K).

    Near is within so many spreads as there is ``room``.
    """
    r = figure.distances(points)[0]
    if figure.convex:
        of_no_other = np.count_nonzero(r < -room * spread, axis=1) >= r.shape[1] - 1  # inside all but the near one
        return (np.abs(r) <= SIGMAS * spread) & of_no_other[:, None]
    t, (begin, end) = figure.along(points)[0], figure.spans()
    return (np.abs(r) <= SIGMAS * spread) & (t > begin + room * spread) & (t < end - room * spread)


def without_points(figure: Outlines, points: Floats, spread: float) -> NDArray[np.bool_]:
    """Tell which sides have not two points of their own, shape (K,), of those long enough that some would be there.

    Where points are sparse, those of its neighbours lie near a hidden side, too.
    """
    begin, end = figure.spans()
    long = (end - begin)[0] >= (2 * SIGMAS + 1) * spread
    return np.asarray(long & (own_points(figure, points, spread, SIGMAS).sum(axis=0) < LEAST_OF_SIDE))


def sides_seen(figure: Outlines, points: Floats, spread: float) -> NDArray[np.bool_]:
    """Tell which sides of an outline have enough points of their own, away from their corners, shape (K,).

    Of a side whose very middle noise may bring to another, as in a thin strip, no point is its own.
    """
    own, t, (begin, end) = own_points(figure, points, spread), figure.along(points)[0], figure.spans()
    own &= own_points(figure, np.mean(figure.ends(), axis=0)[0], spread).diagonal()
    first, last = (
        np.where(own, t, np.inf).min(axis=0, initial=np.inf),
        np.where(own, t, -np.inf).max(axis=0, initial=-np.inf),
    )
    inner = np.maximum((end - begin)[0] - 2 * CORNER_SPREADS * spread, 0.0)
    return (own.sum(axis=0) >= LEAST_ON_SIDE) & (last - first >= np.maximum(LEAST_SEEN_STRETCH, LEAST_SHARE * inner))


def _of_circle(circle: Circle, points: Floats, spread: float) -> Linearised:
    """Return a circle's fit to first order; its numbers are x, y and radius."""

    def slopes(figure: Circle, at: Floats) -> Floats:
        outward = at - figure.center
        return -np.column_stack([outward / np.hypot(*outward.T)[:, None], np.ones(len(at))])

    def equations(step: Floats, at: Floats) -> Floats:
        figure = Circle(circle.center + step[:2], circle.radius + step[2])
        r = figure.signed_distance(at)
        share, told, _ = shares_smooth(r, spread)
        return (share * told * r)[:, None] * slopes(figure, at)

    b = slopes(circle, points)
    normals = -b[:, :2]
    quarters = np.rint(np.arctan2(*normals.T) / (np.pi / 2)).astype(np.int64) % 4
    effect, pulls = _effect(equations, points, normals, np.eye(3))
    return Linearised(effect, b, pulls, circle.signed_distance(points), normals, points, quarters, circle.perimeter)


def _of_sides(outline: Outlines, points: Floats, spread: float, fitted: Floats) -> Linearised:
    """Return an outline's fit to first order; ``fitted`` is how angles and offsets hang on the fitted numbers."""
    k = outline.angles.shape[1]

    def equations(step: Floats, at: Floats) -> Floats:
        figure = Outlines(outline.angles + step[:k], outline.offsets + step[k:])
        share, told, _ = shares(at, figure, spread)
        pull = (share * told * figure.distances(at))[0]
        return np.hstack([pull * figure.along(at)[0], -pull]) @ fitted

    row, own = np.arange(len(points)), shares(points, outline, spread)[0][0].argmax(axis=1)
    b = np.zeros((len(points), 2 * k))
    b[row, own], b[row, k + own] = outline.along(points)[0][row, own], -1.0
    normals = np.column_stack([np.cos(outline.angles[0]), np.sin(outline.angles[0])])[own]
    effect, pulls = _effect(equations, points, normals, fitted.T)
    begin, end = outline.spans()
    r = outline.distances(points)[0][row, own]
    return Linearised(effect, b @ fitted, pulls, r, normals, points, own, float((end - begin).sum()))


def _effect(
    equations: Callable[[Floats, Floats], Floats], points: Floats, normals: Floats, numbers: Floats
) -> tuple[Floats, Floats]:
    """Return the effect and the pulls of ``Linearised`` for the numbers with which the equations add up to zero."""
    still, step = np.zeros(numbers.shape[1]), STEP
    by_points = equations(still, points + step * normals) - equations(still, points - step * normals)
    by_numbers = [(equations(step * q, points) - equations(-step * q, points)).sum(axis=0) for q in numbers]
    inverse = np.linalg.pinv(np.array(by_numbers).T / (2 * step))
    return -inverse @ by_points.T / (2 * step), -inverse @ equations(still, points).T


def _derivatives(figure: Outlines, rectangle: bool) -> tuple[Floats, Floats]:
    """Return how centroid, shape (2, 2 K), and dimensions, shape (D, 2 K), change with angles and offsets."""
    k = figure.angles.shape[1]
    steps = STEP * np.vstack([np.eye(2 * k), -np.eye(2 * k)])
    moved = Outlines(figure.angles + steps[:, :k], figure.offsets + steps[:, k:])
    begin, end = moved.spans()
    sides = end - begin
    if rectangle:
        sides = ((sides[:, :2] + sides[:, 2:]) / 2)[:, _by_width(figure)]
    center = _centroids(moved.corners())
    there, back = slice(None, 2 * k), slice(2 * k, None)
    return (center[there] - center[back]).T / (2 * STEP), (sides[there] - sides[back]).T / (2 * STEP)


def _by_width(figure: Outlines) -> NDArray[np.intp]:
    """Return the order that puts a rectangle's longer side first, as ``Polygon.dimensions`` does."""
    begin, end = figure.spans()
    return np.argsort(-(end - begin)[0, :2], kind="stable")


def _centroids(corners: Floats) -> Floats:
    """Return the centres of area of polygons, shape (C, K, 2) -> (C, 2)."""
    first = corners[:, :1]
    x, y = np.moveaxis(corners - first, 2, 0)
    next_x, next_y = np.roll(x, -1, axis=1), np.roll(y, -1, axis=1)
    weight = x * next_y - next_x * y
    moments = [((v + w) * weight).sum(axis=1) for v, w in ((x, next_x), (y, next_y))]
    return first[:, 0] + np.column_stack(moments) / (3 * weight.sum(axis=1))[:, None]


def _wider(figure: Outlines, points: Floats, spread: float, shifts: Floats) -> Floats:
    """Return how many times wider deviations are than to first order, as the points' likelihood L tells, shape (D,).

    ``shifts``, shape (D, 2 K), is where a deviation of each number brings angles and offsets. ``SIGMAS`` deviations
    off, -2 ln L should have risen by ``SIGMAS^2``, or as far as it has to the other side where the cells' errors even
    out. It may rise more slowly: a shallow corner, next to which few points lie, can slip along. Where it rises by less
    than ``LEAST_RISE`` of that, the deviation is as wide as the rise says, as far as was looked.
    """
    steps, k = SIGMAS * np.vstack([np.zeros_like(shifts[:1]), shifts, -shifts]), figure.angles.shape[1]
    moved = Outlines(figure.angles + steps[:, :k], figure.offsets + steps[:, k:])
    share, _, log_likelihood = shares(points, moved, spread)
    begin, end = moved.spans()
    length = np.maximum((end - begin).sum(axis=1), spread)  # over which the points are spread, as in ``evidence``
    cost = 2 * share.sum(axis=(1, 2)) * np.log(length) - 2 * log_likelihood
    less, more = np.sort((cost[1:] - cost[0]).reshape(2, -1), axis=0)
    risen = less / np.clip(more, 1.0, SIGMAS**2)
    return np.where(risen < LEAST_RISE, np.maximum(risen, SIGMAS**-2) ** -0.5, 1.0)
