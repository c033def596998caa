"""Random shapes: what is drawn on a random board.

In:  a kind or sort, a centre, shape (2,), metres, and a random generator.
Out: a Circle or Polygon.

>>> free_shape("rectangle", np.zeros(2), np.random.default_rng(0)).kind
'rectangle'

Source: the paper's sizes are those of its published code.
"""

from __future__ import annotations

from typing import Literal

import numpy as np

from .arguments import Floats
from .shapes import Circle, Kind, Polygon, Shape, turns_of

PENTAGON = np.array([(0, -1), (0.9, -0.3), (0.5, 0.8), (-0.5, 0.8), (-0.91, -0.3)])
LEAST_CORNER, LEAST_FREE_SIDE = np.radians(30), 0.04  # rad (and to 180 degrees) and m: corners and sides can be told

# What stands on a board in the style "any", beside the four kinds: polygons of 4, 6, 10, 6, 8, 8 and 4 corners.
Sort = Literal["quadrilateral", "hexagon", "star", "L", "T", "U", "arrow"]
SORTS: tuple[Sort, ...] = ("quadrilateral", "hexagon", "star", "L", "T", "U", "arrow")
CORNERS = {"triangle": 3, "quadrilateral": 4, "pentagon": 5, "hexagon": 6}  # of convex irregular shapes


def paper_shape(kind: Kind | Sort, center: np.ndarray, rng: np.random.Generator) -> Shape:
    """Return a random shape with the sizes of the paper's maps, sides parallel to the axes.

    ``center``, shape (2,), metres: for a triangle the middle of its base, for the others that of the shape.
    """
    if kind == "circle":
        return Circle(center, rng.uniform(0.05, 0.10))
    if kind == "rectangle":
        width, height = rng.uniform(0.10, 0.30, 2)
        return Polygon(center + np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * (width / 2, height / 2))
    if kind == "triangle":
        base = rng.uniform(0.10, 0.30)
        return Polygon(center + np.array([(-base / 2, 0), (base / 2, 0), (0, 0.10)]))
    return Polygon(center + rng.uniform(0.05, 0.10) * PENTAGON)


def free_shape(kind: Kind | Sort, center: np.ndarray, rng: np.random.Generator) -> Shape:
    """Return a random shape, turned by any angle; convex polygons are irregular, with corners that can be told.

    ``center``, shape (2,), metres: the centre of the circle that the corners are drawn on or near; of a star, an L, T,
    U or arrow head the centroid.
    """
    turn = rng.uniform(0, 2 * np.pi)
    if kind == "circle":
        return Circle(center, rng.uniform(0.04, 0.10))
    if kind == "rectangle":
        width, height = rng.uniform(0.06, 0.30, 2)
        corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * (width / 2, height / 2)
        return Polygon(corners + center).moved(angle=turn)
    if kind not in CORNERS:
        shape = Polygon(_corners_of(kind, rng))
        return shape.moved(center - shape.centroid, turn)
    n = CORNERS[kind]
    while True:  # every fourth triangle and every eighth pentagon has corners that can all be told apart
        bearings = turn + np.sort(rng.uniform(0, 2 * np.pi, n))
        radii = rng.uniform(0.06, 0.15) * rng.uniform(0.7, 1.0, n)
        corners = center + radii[:, None] * np.column_stack([np.cos(bearings), np.sin(bearings)])
        if _well_formed(corners):
            return Polygon(corners)


def _corners_of(sort: str, rng: np.random.Generator) -> Floats:
    """Return the corners of an upright star, L, T, U or arrow head, 16 to 26 cm wide and high, arms of 4 to 6 cm."""
    (w, h), t = rng.uniform(0.16, 0.26, 2), rng.uniform(0.04, 0.06)
    if sort == "star":
        bearings = np.arange(10) * np.pi / 5
        radii = np.tile([w / 2, rng.uniform(0.4, 0.6) * w / 2], 5)
        return radii[:, None] * np.column_stack([np.cos(bearings), np.sin(bearings)])
    left, right, top = (w - t) / 2, (w + t) / 2, h - t
    return np.array(
        {
            "L": [(0, 0), (w, 0), (w, t), (t, t), (t, h), (0, h)],
            "T": [(left, 0), (right, 0), (right, top), (w, top), (w, h), (0, h), (0, top), (left, top)],
            "U": [(0, 0), (w, 0), (w, h), (w - t, h), (w - t, t), (t, t), (t, h), (0, h)],
            "arrow": [(0, 0), (w / 2, t), (w, 0), (w / 2, h)],
        }[sort]
    )


def _well_formed(corners: np.ndarray) -> bool:
    """Tell whether counter-clockwise corners are convex, with sides and angles that can be told apart."""
    turns, sides = turns_of(corners), np.hypot(*(np.roll(corners, -1, axis=0) - corners).T)
    clear = (turns >= LEAST_CORNER) & (turns <= np.pi - LEAST_CORNER)
    return bool(clear.all()) and bool((sides >= LEAST_FREE_SIDE).all())
