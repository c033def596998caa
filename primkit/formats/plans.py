"""Plans: worlds of other simulators, cut at the height of the LiDAR.

In:  ``Solid``s in space, as ``webots`` and ``sdf`` read them, and what was passed over.
Out: a ``World``; it is said, as a ``LikelyWrong`` warning, what is not in it.

>>> way = np.eye(4)
>>> way[:3, 3] = 1.0, 0.0, 0.1
>>> plan([Solid("cylinder", (0.2, 0.2, 0.5), way)], Counter(), 0.1).shapes
(Circle(center=(1, 0), radius=0.2),)
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from ..arguments import Floats, doubt, short
from ..shapes import Circle, Polygon, Shape
from ..world import World

UPRIGHT = 1 - 1e-6  # cosine: what stands on the floor, up to the digits of a file
ROOM_AROUND = 1.2  # a board without a floor of its own is wider than what stands on it
MOST_SOLIDS, DEEPEST_NODE = 50_000, 60  # in a file; and how deep they are nested in it


@dataclass(frozen=True)
class Solid:
    """A solid of one piece, and the way from its own frame to the world's, shape (4, 4).

    ``size`` [m]: of a box along its x, y, z; of a cylinder radius, radius, length along z. A prism has a ``base``,
    shape (N, 2), and stands on z = size[0], up to size[2].
    """

    kind: Literal["box", "cylinder", "prism"]
    size: tuple[float, ...]
    way: Floats
    base: Floats | None = None


def plan(
    solids: Sequence[Solid], passed_over: Counter[str], height: float, board: tuple[float, bool] | None = None
) -> World:
    """Return what stands at a height [m] as a world; the ``board`` tells its size [m], and whether it has walls."""
    shapes = []
    for solid in solids:
        shape = _cut(solid, height)
        if isinstance(shape, str):
            passed_over[f"{solid.kind} {shape}"] += 1
        else:
            shapes.append(shape)
    if passed_over:
        told = ", ".join(f"{n} x {what}" for what, n in sorted(passed_over.items()))
        doubt(f"passed over, and not in the world: {told if len(told) < 300 else told[:297] + '...'}", 3)
    if board is not None:
        return World(shapes, board[0], walls=board[1])
    corners = [np.abs(s.center) + s.radius if isinstance(s, Circle) else np.abs(s.vertices).max(axis=0) for s in shapes]
    return World(shapes, 2 * ROOM_AROUND * float(np.max(corners, initial=0.0)) or 1.0)


def _cut(solid: Solid, height: float) -> Shape | str:
    """Return the outline at a height, or why there is none."""
    turn, place = solid.way[:3, :3], solid.way[:3, 3]
    up = int(np.argmax(np.abs(turn[2]))) if solid.kind == "box" else 2
    if not abs(turn[2, up]) > UPRIGHT:
        return "that is tilted"
    low, high = (solid.size[0], solid.size[2]) if solid.kind == "prism" else (-solid.size[up] / 2, solid.size[up] / 2)
    ends = sorted((place[2] + turn[2, up] * low, place[2] + turn[2, up] * high))
    if not ends[0] <= height <= ends[1]:
        return f"that is not at the height of {height:g} m"
    if solid.kind == "cylinder":
        return Circle(place[:2], solid.size[0])
    if solid.base is not None:
        return Polygon(solid.base @ turn[:2, :2].T + place[:2])
    a, b = (axis for axis in range(3) if axis != up)
    corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) / 2 * (solid.size[a], solid.size[b])
    return Polygon(corners @ turn[:2, [a, b]].T + place[:2])


def arena(width: float, depth: float, way: Floats, thickness: float, height: float) -> Iterator[Solid]:
    """Yield four walls around a floor that is no board of ours: not square, or not in the middle."""
    for x, y, size in (
        (width / 2 + thickness / 2, 0.0, (thickness, depth, height)),
        (0.0, depth / 2 + thickness / 2, (width + 2 * thickness, thickness, height)),
    ):
        for sign in (-1, 1):
            yield Solid("box", size, way @ moved((sign * x, sign * y, height / 2), np.eye(3)))


def moved(translation: Sequence[float], turn: Floats) -> Floats:
    """Return a way, shape (4, 4), of a place and a rotation, shape (3, 3)."""
    way = np.eye(4)
    way[:3, :3], way[:3, 3] = turn, translation
    return way


def turned(axis: Sequence[float], angle: float) -> Floats:
    """Return the rotation about an axis, shape (3, 3), by Rodrigues' formula: I + sin a [k] + (1 - cos a) [k]^2.

    >>> turned((0, 0, 2), np.pi / 2).round(9).tolist()
    [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
    """
    norm = float(np.linalg.norm(axis))
    if not norm > 0:
        return np.eye(3)
    x, y, z = np.asarray(axis, dtype=float) / norm
    across = np.array([(0, -z, y), (z, 0, -x), (-y, x, 0)])
    rotation: Floats = np.eye(3) + np.sin(angle) * across + (1 - np.cos(angle)) * across @ across
    return rotation


def numbers(words: Any, n: int, name: str) -> list[float]:
    """Return n finite numbers, or say what stands there."""
    try:
        values = [float(word) for word in words]
    except (TypeError, ValueError):
        values = []
    if len(values) != n or not np.isfinite(values).all() or np.abs(values).max(initial=0.0) > 1e9:
        raise ValueError(f"{name} must be {n} numbers, got {short(words)}")
    return values


def lengths(words: Any, n: int, name: str) -> list[float]:
    """Return n lengths above zero."""
    values = numbers(words, n, name)
    if not min(values) > 0:
        raise ValueError(f"{name} must be {n} numbers > 0, got {short(words)}")
    return values
