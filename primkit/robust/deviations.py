"""Certainty: how sure each number of a shape is, and which numbers were measured at all.

In:  a fitted figure, the points that lie on it, and how far they spread.
Out: ``Certainty``: standard deviations of the centre's coordinates and of the dimensions, metres; infinite for a
dimension that hangs on a side that was never seen, and for one that is not even known to a centimetre.

>>> from primkit.shapes import Circle
>>> ring = Circle((0, 0), 0.05).outline(100)
>>> sure = certainty(Circle((0, 0), 0.05), ring, 0.001)
>>> [round(1000 * s, 2) for s in sure.dimension_std]
[0.03]

Two things make a side uncertain. Noise is drawn anew for every point and averages out: ``spread / sqrt(N)``. The
grid's cells do not where a side runs along them: a wall at x = 0.1234 m falls into the cells at 0.1235 m from one
end to the other, and no number of points tells. A turned side crosses many cells, and the error averages out too;
without noise even faster than is stated here, so that the deviations are then an upper bound.

Sources: propagation of errors through the least-squares fit, as in any text on it; for unequal scatter White (1980), "A
heteroskedasticity-consistent covariance matrix estimator"; for points of doubtful side Louis (1982), "Finding the
observed information matrix when using the EM algorithm".
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..arguments import Floats
from ..seen import seen_shares
from ..shapes import Circle
from .outlines import Outlines
from .refine import shares
from .scatter import CELL, CELL_STD, SIGMAS

# A side was seen when so many points lie on it, over such a length [m] and such a share of it, and not near a corner,
# where they may as well belong to the neighbour: a line over a hidden side touches the last points of both neighbours.
# What shows less may as well be a piece of something else; so may an arc of less than such a share of its circle.
LEAST_ON_SIDE = 4
LEAST_SEEN_STRETCH = 0.008
LEAST_SHARE = 0.4
LEAST_OF_CIRCLE = 0.45
CORNER_SPREADS = 4.0
MOST_STD = 0.01  # m: what is not even known to a centimetre was not measured, but supposed
STEP = 1e-6  # rad and m: the derivatives' step, far above rounding and far below any curvature


@dataclass(frozen=True)
class Certainty:
    """How sure a shape's numbers are.

    Parameters
    ----------
    center_std : tuple of float
        Standard deviations of x and y of the centroid, metres; infinite when a side was not seen.
    dimension_std : tuple of float
        Standard deviation of each dimension, metres; infinite when it was not measured.
    """

    center_std: tuple[float, ...]
    dimension_std: tuple[float, ...]


def certainty(figure: Circle | Outlines, points: Floats, spread: float, *, square: bool = False) -> Certainty:
    """Return the standard deviations of a fitted figure's centre and dimensions.

    Parameters
    ----------
    figure : Circle or Outlines (one row)
        The fit.
    points : array, shape (N, 2)
        The points on it, metres.
    spread : float
        Standard deviation of the points from the outline, metres.
    square : bool
        Whether the outline was fitted with right angles.
    """
    if isinstance(figure, Circle):
        return _of_circle(figure, points)
    seen = sides_seen(figure, points, spread)
    covariance = _of_sides(figure, points, spread, square)
    rectangle = figure.kind == "rectangle"
    center, dimension = _derivatives(figure, rectangle)
    measured = _measured(figure, seen, square, rectangle)
    return Certainty(_std(center, covariance, np.full(2, seen.all())), _std(dimension, covariance, measured))


def _measured(figure: Outlines, seen: NDArray[np.bool_], square: bool, rectangle: bool) -> NDArray[np.bool_]:
    """Tell which dimensions hang on seen sides only, shape (D,)."""
    if square:  # width and height each hang on the two sides across
        return np.array([seen[1] and seen[3], seen[0] and seen[2]])[_by_width(figure)]
    if rectangle:  # without right angles that were imposed, both hang on all
        return np.full(2, seen.all())
    return np.roll(seen, 1) & seen & np.roll(seen, -1)  # a side ends where its neighbours' lines cross it


def sides_seen(figure: Outlines, points: Floats, spread: float) -> NDArray[np.bool_]:
    """Tell which sides of an outline have points of their own, away from their corners, shape (K,)."""
    r = figure.distances(points)[0]
    t = figure.along(points)[0]
    begin, end = figure.spans()
    room = CORNER_SPREADS * spread
    if figure.convex:
        of_no_other = np.count_nonzero(r < -room, axis=1) >= r.shape[1] - 1  # inside all sides but one, the near one
        own = (np.abs(r) <= SIGMAS * spread) & of_no_other[:, None]
    else:
        own = (np.abs(r) <= SIGMAS * spread) & (t > begin + room) & (t < end - room)
    first, last = (
        np.where(own, t, np.inf).min(axis=0, initial=np.inf),
        np.where(own, t, -np.inf).max(axis=0, initial=-np.inf),
    )
    inner = np.maximum((end - begin)[0] - 2 * CORNER_SPREADS * spread, 0.0)
    return (own.sum(axis=0) >= LEAST_ON_SIDE) & (last - first >= np.maximum(LEAST_SEEN_STRETCH, LEAST_SHARE * inner))


def _of_circle(circle: Circle, points: Floats) -> Certainty:
    """Propagate the residuals through the geometric fit: (J'J)^-1 J' diag(r^2) J (J'J)^-1, J their slopes.

    Each residual stands for its own variance (White, 1980), because points at the ends of an arc scatter less across
    it than those in its middle: there the beams graze.
    """
    bearing = np.arctan2(*(points - circle.center).T[::-1])
    slopes = np.column_stack([np.cos(bearing), np.sin(bearing), np.ones(len(points))])
    spare = len(points) / max(len(points) - 3, 1)
    variance = np.maximum(circle.signed_distance(points) ** 2 * spare, CELL_STD**2)
    inverse = np.linalg.pinv(slopes.T @ slopes)
    covariance = inverse @ (slopes.T * variance) @ slopes @ inverse
    x, y, radius = np.sqrt(np.diag(covariance)).tolist()
    enough = seen_shares(circle, points)[0] >= LEAST_OF_CIRCLE and radius <= MOST_STD
    return Certainty((x, y), (radius if enough else float("inf"),))


def _of_sides(figure: Outlines, points: Floats, spread: float, square: bool) -> Floats:
    """Return the covariance of the K angles and K offsets, shape (2 K, 2 K)."""
    r, t = figure.distances(points)[0], figure.along(points)[0]
    share = shares(points, figure, spread)[0][0]  # (N, K)
    n_params = 5 if square else 2 * r.shape[1]
    variance = max((share * r**2).sum() / max(share.sum() - n_params, 1.0), CELL_STD**2)
    # A point that may be of either of two sides tells less about both (Louis, 1982).
    told = np.maximum(share - share * (1 - share) * r**2 / variance, 0.0)
    mass = np.maximum(told.sum(axis=0), 1.0)
    middle = (told * t).sum(axis=0) / mass
    lever = np.maximum((told * (t - middle) ** 2).sum(axis=0), 1e-12)
    noise = variance - CELL_STD**2
    stretch = np.sqrt(12 * lever / mass)  # the length that even points with this lever would cover
    cells = _cell_variance(figure.angles[0], stretch, mass, noise)
    offset_variance = noise / mass + cells
    angle_variance = noise / lever + cells * mass / lever
    k = len(mass)
    if square:
        angle_covariance = np.full((k, k), 1 / (1 / angle_variance).sum())
    else:
        angle_covariance = np.diag(angle_variance)
    # An offset is that of the points' middle, plus the angle's error times the lever from the origin's foot.
    to_offset = np.diag(middle) @ angle_covariance
    return np.block(
        [[angle_covariance, to_offset.T], [to_offset, np.diag(offset_variance) + to_offset @ np.diag(middle)]]
    )


def _cell_variance(angles: Floats, lengths: Floats, mass: Floats, noise: float) -> Floats:
    """Return the variance of each side's offset that comes from the cells, shape (K,).

    Along a side the error in x repeats itself whenever x has moved on by a cell, and y likewise: so many
    errors are averaged, not one for each point. Noise (its variance, square metres) of more than half a cell
    shakes them apart.
    """
    normal = np.column_stack([np.cos(angles), np.sin(angles)])
    moved = np.abs(normal[:, ::-1]) * lengths[:, None] / CELL  # cells passed in x and in y
    together = ((normal * CELL_STD) ** 2 / np.clip(moved, 1.0, mass[:, None])).sum(axis=1)
    shaken = np.exp(-((2 * np.pi / CELL) ** 2) * noise)
    return shaken * together + (1 - shaken) * CELL_STD**2 / mass


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


def _std(slopes: Floats, covariance: Floats, measured: NDArray[np.bool_]) -> tuple[float, ...]:
    """Return sqrt(diag(J C J')), infinite where it was not measured."""
    std = np.sqrt(np.einsum("ij,jk,ik->i", slopes, covariance, slopes))
    return tuple(np.where(measured & (std <= MOST_STD), std, np.inf).tolist())
