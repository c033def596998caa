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


def is_seen(places: Floats, points: Floats, resolution: float = 0.001) -> Bools:
    """Tell which places, shape (..., 2), have one of the points within reach; shape (...)."""
    from scipy.spatial import cKDTree

    if len(points) == 0:
        return np.zeros(places.shape[:-1], dtype=bool)
    reach = REACH * (1000 * resolution)
    tree = cKDTree(points, compact_nodes=False, balanced_tree=False)  # quicker to build; it is asked once
    near: Bools = tree.query(places, distance_upper_bound=np.nextafter(reach, np.inf))[0] <= reach
    return near


def share_seen(shape: Shape, points: Floats, resolution: float = 0.001) -> float:
    """Return the share of a whole outline that was seen, 0 to 1."""
    return float(is_seen(shape.outline(400), points, resolution).mean())


def seen_shares(shape: Shape, points: Floats) -> tuple[float, ...]:
    """Return the share of each side, or of the whole circle, that was seen, on cells of 1 mm.

    >>> from primkit.shapes import Polygon
    >>> square = Polygon([(0, 0), (0.1, 0), (0.1, 0.1), (0, 0.1)])
    >>> [round(share, 2) for share in seen_shares(square, np.array([(0.0, 0.05), (0.05, 0.0)]))]
    [0.24, 0.0, 0.0, 0.24]
    """
    if not isinstance(shape, Circle):
        return shares_of_sides(shape.vertices, shape.vertices + shape.edges, points)
    offset, once = points - shape.center, 2 * np.pi
    away, bearing = np.hypot(*offset.T), np.arctan2(offset[:, 1], offset[:, 0])
    twice = 2 * shape.radius * np.maximum(away, np.finfo(float).tiny)
    half = np.arccos(np.clip((shape.radius**2 + away**2 - REACH**2) / twice, -1.0, 1.0))
    middles, halves = np.concatenate([bearing, bearing + once, bearing + 2 * once]), np.tile(half, 3)
    return _shares_covered((middles - halves)[None], (middles + halves)[None], np.array([once]))


def shares_of_sides(begin: Floats, end: Floats, points: Floats) -> tuple[float, ...]:
    """Return of each of K straight sides, shape (K, 2) each for their ends, the share that was seen."""
    lengths = np.hypot(*(end - begin).T)
    x, y = ((end - begin) / lengths[:, None]).T
    along, across = np.array([[x, y], [-y, x]]).swapaxes(1, 2) @ points.T  # (K, N) each
    first, off = x * begin[:, 0] + y * begin[:, 1], x * begin[:, 1] - y * begin[:, 0]
    return shares_along(along - first[:, None], across - off[:, None], lengths)


def shares_along(along: Floats, across: Floats, lengths: Floats) -> tuple[float, ...]:
    """Return the share of each side, of lengths (K,), that was seen by points so far along and beside it, (K, N)."""
    half = np.sqrt(np.maximum(REACH**2 - across**2, 0.0))
    return _shares_covered(along - half, along + half, lengths)


def _shares_covered(begin: Floats, end: Floats, lengths: Floats) -> tuple[float, ...]:
    """Return what share of each length, shape (K,), lies in none of the gaps between intervals, shape (K, N) each."""
    whole = lengths[:, None]
    begin, end = (np.hstack([each.clip(0.0, whole), 0 * whole, whole]) for each in (begin, end))
    row, order = np.arange(len(whole))[:, None], np.argsort(begin, axis=1)
    gaps = np.maximum(begin[row, order][:, 1:] - np.maximum.accumulate(end[row, order][:, :-1], axis=1), 0.0)
    return tuple(np.round(1 - gaps.sum(axis=1) / lengths, 9).tolist())  # a whole one is 1, whatever the rounding
