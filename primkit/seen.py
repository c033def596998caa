"""Seen: which part of an outline has points near it.

A place q on an outline counts as seen when some point p lies within reach of it:

    min |q - p| <= reach, 12 cells

In:  places on outlines, shape (..., 2), or a shape; points, shape (N, 2), metres, and the side of their cells.
Out: for each place whether it was seen; for a shape the share of each of its sides.

>>> places = np.array([(0.0, 0.0), (0.011, 0.0), (0.013, 0.0)])
>>> is_seen(places, np.array([(0.0, 0.0)])).tolist()
[True, True, False]

Not here: which points are a shape's own; the caller chooses them.
"""

from __future__ import annotations

import numpy as np

from .arguments import Bools, Floats
from .shapes import Circle, Shape

REACH = 0.012  # m on cells of 1 mm: about four times as far as neighbours on an outline lie apart
PLACES_PER_SIDE = 50  # a side is looked at in so many places, a circle in four times as many


def is_seen(places: Floats, points: Floats, resolution: float = 0.001) -> Bools:
    """Tell which places, shape (..., 2), have one of the points within reach; shape (...)."""
    from scipy.spatial import cKDTree

    if len(points) == 0:
        return np.zeros(places.shape[:-1], dtype=bool)
    reach = REACH * (1000 * resolution)
    tree = cKDTree(points, compact_nodes=False, balanced_tree=False)  # quicker to build; it is asked once
    near: Bools = tree.query(places, distance_upper_bound=np.nextafter(reach, np.inf))[0] <= reach
    return near


def seen_shares(shape: Shape, points: Floats) -> tuple[float, ...]:
    """Return the share of each side, or of the whole circle, that was seen.

    >>> from primkit.shapes import Polygon
    >>> square = Polygon([(0, 0), (0.1, 0), (0.1, 0.1), (0, 0.1)])
    >>> [round(share, 1) for share in seen_shares(square, np.array([(0.0, 0.05), (0.05, 0.0)]))]
    [0.2, 0.0, 0.0, 0.2]
    """
    if isinstance(shape, Circle):
        return shares_of(shape.outline(4 * PLACES_PER_SIDE)[None], points)
    return shares_of(places_between(shape.vertices, shape.vertices + shape.edges), points)


def share_seen(shape: Shape, points: Floats, resolution: float = 0.001) -> float:
    """Return the share of a whole outline that was seen, 0 to 1."""
    return float(is_seen(shape.outline(400), points, resolution).mean())


def places_between(begin: Floats, end: Floats) -> Floats:
    """Return places along K sides, shape (K, 2) each for their ends -> (K, PLACES_PER_SIDE, 2)."""
    steps = (np.arange(PLACES_PER_SIDE) + 0.5)[:, None] / PLACES_PER_SIDE
    return begin[:, None] + steps * (end - begin)[:, None]


def shares_of(places: Floats, points: Floats) -> tuple[float, ...]:
    """Return of each row of places, shape (K, M, 2), the share that was seen."""
    return tuple((np.count_nonzero(is_seen(places, points), axis=1) / places.shape[1]).tolist())
