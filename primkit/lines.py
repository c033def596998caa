"""Lines: the sides of a polygon, found one after the other by RANSAC.

In:  points of one cluster, shape (N, 2), metres.
Out: ``Line`` objects and which points lie on each.

>>> points = [(x / 100, 0.0) for x in range(20)] + [(0.0, y / 100) for y in range(1, 15)]
>>> [(len(found.inliers.nonzero()[0])) for found in find_lines(points, threshold=0.001, rng=0)]
[20, 14]

A line is written in normal form, ``n . p = d``: every direction is alike, a vertical line is no exception,
and ``n . p - d`` is the signed distance of a point.

Sources: Fischler and Bolles (1981); total least squares after Pearson (1901), "On lines and planes of closest fit".
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .arguments import Floats, as_count, as_points, as_positive, as_rng, as_share
from .ransac import Model, run_ransac


@dataclass(frozen=True)
class Line:
    """A line ``n . p = d``: ``angle`` of the unit normal n, radians; ``offset`` d from the origin along n, metres.

    >>> vertical = Line(angle=0.0, offset=0.2)
    >>> vertical.signed_distance([(0.2, 5.0), (0.3, 0.0)]).round(3).tolist()
    [0.0, 0.1]
    """

    angle: float
    offset: float

    @property
    def normal(self) -> Floats:
        """Unit normal, shape (2,)."""
        return np.array([np.cos(self.angle), np.sin(self.angle)])

    @property
    def direction(self) -> Floats:
        """Unit vector along the line, shape (2,): the normal turned by a quarter to the left."""
        return np.array([-np.sin(self.angle), np.cos(self.angle)])

    def signed_distance(self, points: ArrayLike) -> Floats:
        """Return ``n . p - d`` of each point, shape (N,), metres."""
        return as_points(points) @ self.normal - self.offset

    def moved(self, offset: Floats) -> Line:
        """Return the line shifted by ``offset``, shape (2,), metres."""
        return Line(self.angle, self.offset + float(self.normal @ offset))

    def turned_round(self) -> Line:
        """Return the same line with the opposite normal."""
        return Line(float(np.arctan2(-np.sin(self.angle), -np.cos(self.angle))), -self.offset)


@dataclass(frozen=True, eq=False)
class FoundLine:
    """A line and the points on it: ``inliers`` is a mask over the cluster's points, shape (N,)."""

    line: Line
    inliers: NDArray[np.bool_]


def fit_line(points: ArrayLike) -> Line | None:
    """Return the line with the least squared distances to points, shape (N, 2), metres (total least squares).

    None when fewer than two of them are different. Raises ValueError if points are not finite (N, 2).

    >>> line = fit_line([(0, 1), (1, 1), (2, 1)])
    >>> round(abs(line.offset), 6), abs(line.normal).round(6).tolist()
    (1.0, [0.0, 1.0])
    >>> fit_line([(1, 1), (1, 1)]) is None
    True
    """
    params = _fit(as_points(points))
    return Line(*params.tolist()) if np.isfinite(params).all() else None


def find_lines(
    points: ArrayLike,
    threshold: float,
    *,
    left_over: float = 0.1,
    most: int = 20,
    trials: int = 1000,
    refit: bool = True,
    model: Model | None = None,
    rng: int | np.random.Generator | None = None,
) -> list[FoundLine]:
    """Return lines found one after the other, each on the points that the lines before it left.

    Greedy: the first line takes every point near it, those of its neighbours around a corner included. Raises
    ValueError if points are not finite (N, 2), or another argument is out of its range.

    Parameters
    ----------
    points, threshold, trials, refit, rng
        As for ``run_ransac``, for each line.
    left_over, most
        Stop when at most this share of the points is left, or after this many lines.
    model : Model, optional
        The line with a fit of your own; ``LINE`` by default.

    Examples
    --------
    >>> find_lines([], threshold=0.005)
    []
    """
    points, rng = as_points(points), as_rng(rng)
    threshold, most = as_positive(threshold, "threshold", zero=True), as_count(most, "most", least=0)
    left_over = as_share(left_over, "left_over", "between 0 and 1")
    left = np.ones(len(points), dtype=bool)
    found: list[FoundLine] = []
    while len(found) < most and np.count_nonzero(left) > left_over * len(points):
        rest = np.flatnonzero(left)
        consensus = run_ransac(points[rest], model or LINE, threshold, trials=trials, refit=refit, rng=rng)
        if consensus is None:
            break
        inliers = np.zeros(len(points), dtype=bool)
        inliers[rest[consensus.inliers]] = True
        found.append(FoundLine(Line(*consensus.params.tolist()), inliers))
        left &= ~inliers
    return found


# --- the line as RANSAC's model: parameters (angle, offset) -----------------------------------------------------


def _from_samples(samples: Floats) -> Floats:
    """Return the line through each pair of points, shape (T, 2, 2) -> (T, 2); NaN for a doubled point."""
    along = samples[:, 1] - samples[:, 0]
    angle = np.arctan2(-along[:, 0], along[:, 1])
    offset = (samples[:, 0] * np.column_stack([np.cos(angle), np.sin(angle)])).sum(axis=1)
    return np.where((along != 0).any(axis=1)[:, None], np.column_stack([angle, offset]), np.nan)


def _residuals(params: Floats, points: Floats) -> Floats:
    """Return the distances of N points from T lines, shape (T, N)."""
    angle, offset = params[:, :1], params[:, 1:]
    # Not as a matrix product: its last bits depend on how many lines are asked for at once.
    distance = np.cos(angle) * points[:, 0]
    distance += np.sin(angle) * points[:, 1]
    distance -= offset
    return np.abs(distance, out=distance)


def _fit(points: Floats) -> Floats:
    """Return the total least squares line, shape (2,); NaN when the points fix none."""
    if len(points) < 2 or (points == points[0]).all():  # the mean of equal points may be off by rounding
        return np.full(2, np.nan)
    center = points.mean(axis=0)
    x, y = (points - center).T
    # The direction of most scatter, in closed form: the larger eigenvector of the 2 x 2 scatter matrix.
    angle = 0.5 * np.arctan2(2 * (x @ y), x @ x - y @ y) + np.pi / 2
    return np.array([angle, np.cos(angle) * center[0] + np.sin(angle) * center[1]])


LINE = Model(sample_size=2, from_samples=_from_samples, residuals=_residuals, fit=_fit)
