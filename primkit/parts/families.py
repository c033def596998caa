"""Families: the basic shapes as a few numbers, and how their outlines move when the numbers change.

=========  =====================================  ====================
kind       numbers of the style "paper"           of the style "free"
=========  =====================================  ====================
circle     centre, radius                         the same
rectangle  centre, turn, two sides                the same
triangle   middle of the base, turn, base and     its three corners
           height: two sides are alike
pentagon   centre, turn, radius: it is regular    its five corners
=========  =====================================  ====================

In:  a kind, a style and numbers, shape (n,): metres and radians.
Out: corners, shape (K, 2), metres, counter-clockwise; signed distances of points, and their derivatives.

>>> square = Part("rectangle", np.array([0.1, 0.0, 0.0, 0.2, 0.2]))
>>> square.corners.tolist()
[[0.0, -0.1], [0.2, -0.1], [0.2, 0.1], [0.0, 0.1]]
>>> distance, slope = square.distance(np.array([[0.25, 0.0]]))
>>> distance.round(6).tolist(), (slope.round(6) + 0.0).tolist()  # farther right or wider: nearer to the point
([0.05], [[-1.0, 0.0, 0.0, -0.5, 0.0]])
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from ..arguments import Floats
from ..shapes import Circle, Kind, Polygon, Shape

Style = Literal["paper", "free"]
STEP = 1e-6  # m and rad: of the derivatives of corners
FIFTHS = np.arange(5) * (2 * np.pi / 5)
LEAST_BEND_OF_PART, LEAST_SIDE_OF_PART = np.radians(8), 0.012  # rad and m
CORNERS_OF: dict[str, int] = {"circle": 0, "triangle": 3, "rectangle": 4, "pentagon": 5}


@dataclass(frozen=True, eq=False)
class Part:
    """A shape of a kind and a style, by its numbers.

    Parameters
    ----------
    kind : {"circle", "triangle", "rectangle", "pentagon"}
    x : array, shape (n,)
        Its numbers, metres and radians: see the module's table.
    style : {"paper", "free"}
    color : int
        The number of its colour; -1 for unknown.
    """

    kind: Kind
    x: Floats
    style: Style = "paper"
    color: int = -1

    def with_numbers(self, x: Floats) -> Part:
        """Return the part with other numbers."""
        return Part(self.kind, x, self.style, self.color)

    @cached_property
    def corners(self) -> Floats:
        """Corners, shape (K, 2), metres, counter-clockwise; none of a circle."""
        x = self.x
        if self.kind == "circle":
            return np.empty((0, 2))
        if self.kind == "rectangle":
            at = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * (x[3:] / 2)
        elif self.style == "free":
            return x.reshape(-1, 2)
        elif self.kind == "triangle":
            at = np.array([(-x[3] / 2, 0.0), (x[3] / 2, 0.0), (0.0, x[4])])
        else:
            at = x[3] * np.column_stack([np.cos(FIFTHS), np.sin(FIFTHS)])
        c, s = np.cos(x[2]), np.sin(x[2])
        return x[:2] + at @ np.array([[c, s], [-s, c]])

    @cached_property
    def slopes(self) -> Floats:
        """Derivatives of the corners, shape (K, 2, n)."""
        if self.style == "free" and self.kind in ("triangle", "pentagon"):
            return np.eye(len(self.x)).reshape(-1, 2, len(self.x))
        steps = STEP * np.eye(len(self.x))
        ends = [(self.with_numbers(self.x + s).corners, self.with_numbers(self.x - s).corners) for s in steps]
        return np.stack([(a - b) / (2 * STEP) for a, b in ends], axis=-1)

    @property
    def normals(self) -> Floats:
        """Unit normals of the sides, outwards, shape (K, 2)."""
        along = np.roll(self.corners, -1, axis=0) - self.corners
        along /= np.maximum(np.hypot(*along.T), 1e-12)[:, None]
        return np.column_stack([along[:, 1], -along[:, 0]])

    @property
    def sound(self) -> bool:
        """Whether it is a shape at all: convex, none of its sides and corners too small to be told."""
        if self.kind == "circle":
            return bool(0.005 < self.x[2] < 10)
        along = np.roll(self.corners, -1, axis=0) - self.corners
        before = np.roll(along, 1, axis=0)
        turn = np.arctan2(before[:, 0] * along[:, 1] - before[:, 1] * along[:, 0], (before * along).sum(axis=1))
        convex = (turn > LEAST_BEND_OF_PART).all() and abs(turn.sum() - 2 * np.pi) < 1e-6
        return bool(convex and (np.hypot(*along.T) > LEAST_SIDE_OF_PART).all())

    @property
    def shape(self) -> Shape:
        """The shape, metres."""
        return Circle(self.x[:2], abs(self.x[2])) if self.kind == "circle" else Polygon(self.corners)

    def freed(self) -> Part:
        """Return the part; a triangle by its corners, in the style "free"."""
        return Part("triangle", self.corners.ravel(), "free", self.color) if self.kind == "triangle" else self

    def outside(self, points: Floats) -> Floats:
        """Return how far each point lies outside the line of the side that it is farthest outside of, shape (N,)."""
        if self.kind == "circle":
            return np.hypot(*(points - self.x[:2]).T) - self.x[2]
        normals = self.normals
        return (points @ normals.T - (normals * self.corners).sum(axis=1)).max(axis=1)

    def distance(self, points: Floats) -> tuple[Floats, Floats]:
        """Return ``outside``, shape (N,), and its derivatives by the numbers, shape (N, n)."""
        if self.kind == "circle":
            away = points - self.x[:2]
            length = np.maximum(np.hypot(*away.T), 1e-12)
            return length - self.x[2], np.column_stack([-away / length[:, None], -np.ones(len(points))])
        normals, corners, slopes = self.normals, self.corners, self.slopes
        out = points @ normals.T - (normals * corners).sum(axis=1)
        side, row = out.argmax(axis=1), np.arange(len(points))
        after = (side + 1) % len(corners)
        along = corners[after] - corners[side]
        share = ((points - corners[side]) * along).sum(axis=1) / np.maximum((along**2).sum(axis=1), 1e-12)
        n, share = normals[side], np.clip(share, 0.0, 1.0)
        at = np.einsum("pc,pcn->pn", n, slopes[side]) * (1 - share)[:, None]
        return out[row, side], -(at + np.einsum("pc,pcn->pn", n, slopes[after]) * share[:, None])
