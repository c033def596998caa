"""Paper: the published way from lines to a measured shape, exactly as it is described.

The number of lines names the shape, and extents and means of the points measure it. It stands here as it was
published, with its faults: it supposes sides parallel to the axes and outlines seen all around.

In:  points of one cluster, shape (N, 2), metres, and the number of lines that RANSAC found in them.
Out: a ``Circle`` or ``Polygon``, or ``None`` when the lines name no shape.

>>> rectangle = [(0, 0), (0.2, 0), (0.2, 0.1), (0, 0.1)]
>>> measure_as_published(np.array(rectangle), 4).dimensions
(0.2, 0.1)

Source: "Mapping of Primitives in Mobile Robotics Using Computer Vision", section 3.2, "Shape Detection" and
"Shape Measurement", with the details of its published code.
"""

from __future__ import annotations

import numpy as np

from .arguments import Floats, as_points
from .circles import find_circle
from .shapes import Circle, Kind, Polygon, Shape
from .world import PENTAGON


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
    threshold: float = 0.005,
    trials: int = 1000,
    rng: int | np.random.Generator | None = None,
) -> Shape | None:
    """Return the shape that the published method reports for the points of one cluster.

    Parameters
    ----------
    points : array, shape (N, 2)
        Metres.
    n_lines : int
        How many lines RANSAC needed to explain nine tenths of the points.
    threshold, trials : float, int
        Of the RANSAC for circles, as in the PyRANSAC library: the best circle through three points.
    rng : int or numpy.random.Generator, optional
        Seed or generator.

    Returns
    -------
    Circle, Polygon or None
        None for fewer than three lines, or when the points have no extent.

    Raises
    ------
    ValueError
        If points are not finite (N, 2).
    """
    points, kind = as_points(points), kind_by_lines(n_lines)
    if len(points) == 0:
        return None
    low, high = points.min(axis=0), points.max(axis=0)
    width, height = high - low
    if kind is None or min(width, height) <= 0:
        return None
    if kind == "circle":
        return find_circle(points, threshold, trials=trials, refit=False, rng=rng)
    if kind == "rectangle":
        return Polygon([low, (high[0], low[1]), high, (low[0], high[1])])
    if kind == "triangle":
        return _around(points, np.array([(-width / 2, 0), (width / 2, 0), (0, height)]))
    return _around(points, PENTAGON * (width / np.ptp(PENTAGON[:, 0])))


def _around(points: Floats, corners: Floats) -> Polygon:
    """Return the polygon, moved so that its centroid is the mean of the points."""
    shape = Polygon(corners)
    return shape.moved(points.mean(axis=0) - shape.centroid)


def published_values(shape: Shape, *, truth: bool) -> tuple[Floats, tuple[float, ...]]:
    """Return the centre, shape (2,), and the dimensions that the published scoring compares, in metres.

    Two of them differ between truth and result, and so cost the method points: the truth's triangle has its
    "centre" in the middle of its base, while the result is the mean of the points; the truth's pentagon has its
    radius as dimension, while the result is the distance between its two extreme points.

    >>> triangle = Polygon([(0, 0), (0.2, 0), (0.1, 0.1)])
    >>> published_values(triangle, truth=True)[0].round(3).tolist()
    [0.1, 0.0]
    """
    if isinstance(shape, Circle):
        return shape.center, (shape.radius,)
    low, high = shape.vertices.min(axis=0), shape.vertices.max(axis=0)
    width, height = (high - low).tolist()
    if shape.kind == "rectangle":
        return (low + high) / 2, (width, height)
    if shape.kind == "triangle":
        return (np.array([(low[0] + high[0]) / 2, low[1]]) if truth else shape.centroid), (width,)
    return shape.centroid, (shape.reach if truth else width,)
