"""Paper: the published method, read from top to bottom, and the values that the published scoring compares.

Line after line is taken out of a cluster, the number of lines names the shape, and extents and means measure it. The
numbers are those of the published code, with its particulars:

* a cell is read at its corner, and all lengths are counted in cells of the grid;
* K-Means starts once;
* a point lies on a line when it is nearer than 5 cells, not at 5 themselves; of at most 10,000 lines through two
  points that with the most points is taken, of equals that with the least sum of squared distances; it is not fitted
  again. These are scikit-image's rules; so its end is taken, too: after log(e) / log(1 - w^2) lines, with w the share
  of the points on the best and e = 2^-52. (Inferred: with 10,000 each, two recorded rows fewer come back.)
* the search ends when at most a tenth of the cluster is left; what is left measures nothing;
* a circle goes through three of the points, the one of 1,000 that has most of them within 0.05 cells.

It supposes sides parallel to the axes, and outlines that were seen all around.

In:  points of one cluster, shape (N, 2), metres: the centres of their cells.
Out: a ``Circle`` or ``Polygon``, or ``None`` when the lines name no shape.

>>> ring = Polygon([(0, 0), (0.2, 0), (0.2, 0.1), (0, 0.1)]).outline(600)
>>> shape_as_published(ring + 0.0005, rng=0)
Polygon([(0, 0), (0.2, 0), (0.2, 0.1), (0, 0.1)])

Source: Vaz, Costa and Campiao (2024), "Mapping of Primitives in Mobile Robotics Using Computer Vision", section 3.2,
with the details of its published code.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .arguments import Bools, Floats, Labels, as_count, as_points, as_rng
from .circles import find_circle
from .lines import Line
from .random_shapes import PENTAGON
from .ransac import draw_samples
from .shapes import Circle, Kind, Polygon, Shape

ON_LINE = 5.0  # cells
ON_CIRCLE = 0.05  # cells
LEFT_OVER = 0.1  # share of a cluster
LINE_TRIALS, CIRCLE_TRIALS = 10_000, 1000
BLOCK = 500  # lines that are worked on at a time
# A pentagon's one dimension is the way from its lowest to its leftmost point, though the truth has its radius: 1.148.
LOWEST_TO_LEFTMOST = float(np.hypot(*(PENTAGON[0] - PENTAGON[4])))
# A true pentagon of radius 1 is so high; its middle lies one radius above its lowest corner.
PENTAGON_HEIGHT = float(np.ptp(PENTAGON[:, 1]))


def one_start_kmeans(points: Floats, k: int, rng: np.random.Generator) -> Labels:
    """Return labels of k groups as K-Means finds them from one start, shape (N,): the best of one, not of ten."""
    from sklearn.cluster import KMeans

    labels: Labels = KMeans(k, n_init=1, random_state=int(rng.integers(2**31))).fit_predict(points)
    return labels


def shape_as_published(
    points: Floats,
    *,
    line_trials: int = LINE_TRIALS,
    circle_trials: int = CIRCLE_TRIALS,
    fit_line: Callable[[Floats], Line | None] | None = None,
    resolution: float = 0.001,
    rng: int | np.random.Generator | None = None,
) -> Shape | None:
    """Return the shape that the published method reports for one cluster.

    Parameters
    ----------
    points : array, shape (N, 2)
        Centres of the cluster's cells, metres.
    line_trials, circle_trials : int
        Samples for each line, and for a circle.
    fit_line : callable, optional
        A fit of your own: each line is fitted with it to its points, and takes the points near the new line, unless
        they are fewer.
    resolution : float
        Side of a cell in metres.
    rng : int or numpy.random.Generator, optional
        Seed or generator.

    Returns
    -------
    Circle, Polygon or None
        None for fewer than three lines, or when the points on them have no extent.

    Raises
    ------
    ValueError
        If points are not finite (N, 2), or there is not at least one trial.
    """
    rng, trials = as_rng(rng), as_count(line_trials, "line_trials")
    points = as_points(points)
    cells = (points / resolution - 0.5).round(6)  # whole numbers again: 5 cells off is not nearer than 5
    left, n_lines = np.arange(len(cells)), 0
    while len(left) >= 2 and len(left) > LEFT_OVER * len(cells):
        near = _on_best_line(cells[left], trials, rng)
        if fit_line is not None:
            near = _on_own_line(points[left], near, fit_line(points[left[near]]), resolution)
        if not near.any():
            break
        left, n_lines = left[~near], n_lines + 1
    corners = np.delete(cells, left, axis=0) * resolution
    return measure_as_published(corners, n_lines, trials=circle_trials, resolution=resolution, rng=rng)


def _on_best_line(cells: Floats, trials: int, rng: np.random.Generator) -> Bools:
    """Return which points lie on the line that most of them lie on, shape (N,); none where all points are one."""
    pairs = draw_samples(len(cells), 2, trials, rng)
    start, way = cells[pairs[:, 0]], cells[pairs[:, 1]] - cells[pairs[:, 0]]
    length = np.hypot(*way.T)
    length[length == 0] = np.nan  # two equal points make no line, and nothing lies on it

    def off(some: slice | Labels) -> Floats:
        """Return the distance of each point from some of the lines, shape (T, N), cells."""
        (x, y), (dx, dy) = start[some].T[..., None], way[some].T[..., None]
        distance: Floats = np.abs(dx * (cells[:, 1] - y) - dy * (cells[:, 0] - x)) / length[some][:, None]
        return distance

    count = np.empty(0, dtype=np.int64)
    for first in range(0, trials, BLOCK):
        block = slice(first, first + BLOCK)
        count = np.append(count, np.count_nonzero(off(block) < ON_LINE, axis=1))
        enough = np.arange(1, len(count) + 1) >= _enough_trials(np.maximum.accumulate(count) / len(cells))
        if enough.any():
            count = count[: int(enough.argmax()) + 1]
            break
    tied = np.flatnonzero(count == count.max())
    best = tied[(off(tied) ** 2).sum(axis=1).argmin()]
    return off(slice(best, best + 1))[0] < ON_LINE


def _enough_trials(share: Floats) -> Floats:
    """Return after how many samples no better line is to be expected, if such a share of the points lies on the best.

    >>> _enough_trials(np.array([0.1, 0.5, 1.0])).round(1).tolist()
    [3586.3, 125.3, 0.0]
    """
    with np.errstate(divide="ignore"):
        return np.log(np.finfo(float).eps) / np.log1p(-(share**2))


def _on_own_line(points: Floats, near: Bools, line: Line | None, resolution: float) -> Bools:
    """Return which points lie on a student's line through the points of the best one; as before where it has fewer."""
    if line is None:
        return near
    own = np.abs(line.signed_distance(points)) < ON_LINE * resolution
    return own if np.count_nonzero(own) >= np.count_nonzero(near) else near


def kind_by_lines(n_lines: int) -> Kind | None:
    """Return the kind that a number of lines stands for; None for fewer than three.

    >>> [kind_by_lines(n) for n in (2, 3, 4, 5, 6)]
    [None, 'triangle', 'rectangle', 'pentagon', 'circle']
    """
    if n_lines < 3:
        return None
    by_count: dict[int, Kind] = {3: "triangle", 4: "rectangle", 5: "pentagon"}
    return by_count.get(n_lines, "circle")


def measure_as_published(
    points: Floats,
    n_lines: int,
    *,
    trials: int = CIRCLE_TRIALS,
    resolution: float = 0.001,
    rng: int | np.random.Generator | None = None,
) -> Shape | None:
    """Return the shape that so many lines name, with the extents and the mean of the points on them.

    Parameters
    ----------
    points : array, shape (N, 2)
        Corners of the cells on the lines, metres.
    n_lines : int
        How many lines explain nine tenths of the cluster.
    trials : int
        Samples for a circle.
    resolution : float
        Side of a cell in metres: a circle has a point when it is within a twentieth of that.
    rng : int or numpy.random.Generator, optional
        Seed or generator.

    Returns
    -------
    Circle, Polygon or None
        A triangle has its centroid in the points' mean and their extents for base and height. So has a pentagon its
        centroid, and is so large that from its lowest to its leftmost corner it is as far as between such points.

    Raises
    ------
    ValueError
        If points are not finite (N, 2).

    Examples
    --------
    >>> measure_as_published(np.array([(0, 0), (0.2, 0), (0.2, 0.1), (0, 0.1)]), 4).dimensions
    (0.2, 0.1)
    """
    points, kind = as_points(points), kind_by_lines(n_lines)
    if kind is None or len(points) == 0 or np.ptp(points, axis=0).min() <= 0:
        return None
    low, high, middle = points.min(axis=0), points.max(axis=0), points.mean(axis=0)
    width, height = high - low
    if kind == "circle":
        return find_circle(points, ON_CIRCLE * resolution, trials=trials, refit=False, rng=rng)
    if kind == "rectangle":
        return Polygon([low, (high[0], low[1]), high, (low[0], high[1])])
    if kind == "triangle":
        return _around(middle, np.array([(-width / 2, 0), (width / 2, 0), (0, height)]))
    apart = float(np.hypot(*(points[points[:, 1].argmin()] - points[points[:, 0].argmin()])))
    return _around(middle, PENTAGON * (apart / LOWEST_TO_LEFTMOST)) if apart else None


def _around(center: Floats, corners: Floats) -> Polygon:
    """Return the polygon, moved so that its centroid is where it is wanted."""
    shape = Polygon(corners)
    return shape.moved(center - shape.centroid)


def published_values(shape: Shape, *, truth: bool) -> dict[str, float]:
    """Return the numbers that the published scoring compares, by its names for them, metres.

    Truth and result do not mean the same by them. A triangle's centre is the middle of its base in the truth, and the
    mean of its points in the result; a pentagon's ``"width"`` is its radius, and the way from its lowest to its
    leftmost point; and the result has a rectangle's width and height swapped, because cells are (y, x).

    >>> triangle = Polygon([(0, 0), (0.2, 0), (0.1, 0.1)])
    >>> [round(published_values(triangle, truth=truth)["y"], 3) for truth in (True, False)]
    [0.0, 0.033]
    >>> published_values(Polygon([(0, 0), (0.2, 0), (0.2, 0.1), (0, 0.1)]), truth=False)["height"]
    0.2
    """
    if isinstance(shape, Circle):
        return {"x": float(shape.center[0]), "y": float(shape.center[1]), "radius": shape.radius}
    corners, low, high = shape.vertices, shape.vertices.min(axis=0), shape.vertices.max(axis=0)
    (width, height), (x, y) = high - low, shape.centroid
    sizes = {"base": width}
    if shape.kind == "rectangle":
        (x, y), sizes = (low + high) / 2, {"width": width if truth else height, "height": height if truth else width}
    elif shape.kind == "triangle" and truth:
        x, y = (low[0] + high[0]) / 2, low[1]
    elif shape.kind == "pentagon" and truth:
        sizes = {"width": height / PENTAGON_HEIGHT}
        x, y = corners[corners[:, 1].argmin()] + (0, sizes["width"])
    elif shape.kind == "pentagon":
        sizes = {"width": np.hypot(*(corners[corners[:, 1].argmin()] - corners[corners[:, 0].argmin()]))}
    return {name: float(value) for name, value in {"x": x, "y": y, **sizes}.items()}
