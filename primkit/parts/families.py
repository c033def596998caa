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

In:  a kind, a style and numbers, shape (n,), or of many shapes of the kind at once (M, n): metres and radians.
Out: corners, shape (..., K, 2), metres, counter-clockwise; signed distances of points, and their derivatives.

>>> square = Part("rectangle", np.array([0.1, 0.0, 0.0, 0.2, 0.2]))
>>> square.corners.tolist()
[[0.0, -0.1], [0.2, -0.1], [0.2, 0.1], [0.0, 0.1]]
>>> place = np.array([[0.25, 0.0]])
>>> square.outside(place).round(6).tolist(), (square.distance_slopes(place).round(6) + 0.0).tolist()  # to the right
([0.05], [[-1.0, 0.0, 0.0, -0.5, 0.0]])
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from ..arguments import Bools, Floats
from ..shapes import Circle, Kind, Polygon, Shape

Style = Literal["paper", "free"]
FIFTHS = np.arange(5) * (2 * np.pi / 5)
LEAST_BEND_OF_PART, MOST_BEND_OF_PART = np.radians((12, 155))  # at a corner: flatter it cannot be told, sharper hardly
LEAST_SIDE_OF_PART, MOST_RADIUS_OF_PART = 0.012, 0.3  # m
CORNERS_OF: dict[str, int] = {"circle": 0, "triangle": 3, "rectangle": 4, "pentagon": 5}
AFTER, BEFORE = ({k: np.roll(np.arange(k), by) for k in CORNERS_OF.values()} for by in (-1, 1))
# Corners of a part that is not turned: the sum of its sizes times these, shape (sizes, K, 2).
SIZED = {
    "rectangle": np.array([[(-0.5, 0), (0.5, 0), (0.5, 0), (-0.5, 0)], [(0, -0.5), (0, -0.5), (0, 0.5), (0, 0.5)]]),
    "triangle": np.array([[(-0.5, 0), (0.5, 0), (0, 0)], [(0, 0), (0, 0), (0, 1)]]),
    "pentagon": np.stack([np.cos(FIFTHS), np.sin(FIFTHS)], axis=1)[None],
}


@dataclass(frozen=True, eq=False)
class Part:
    """A shape of a kind and a style, by its numbers; or many of them at once.

    Parameters
    ----------
    kind : {"circle", "triangle", "rectangle", "pentagon"}
    x : array, shape (n,) or (M, n)
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

    def freed(self) -> Part:
        """Return the part; a triangle by its corners, in the style "free"."""
        return Part("triangle", self.corners.ravel(), "free", self.color) if self.kind == "triangle" else self

    @property
    def shape(self) -> Shape:
        """The shape, metres."""
        return Circle(self.x[:2], abs(self.x[2])) if self.kind == "circle" else Polygon(self.corners)

    @property
    def _by_corners(self) -> bool:
        """Whether its numbers are its corners."""
        return self.style == "free" and self.kind in ("triangle", "pentagon")

    def _turned(self) -> Floats:
        """Return what the corners' offsets are multiplied by, shape (..., 2, 2)."""
        c, s = np.cos(self.x[..., 2]), np.sin(self.x[..., 2])
        return np.stack([c, s, -s, c], axis=-1).reshape(*c.shape, 2, 2)

    @cached_property
    def corners(self) -> Floats:
        """Corners, shape (..., K, 2), metres, counter-clockwise; none of a circle."""
        x, lead = self.x, self.x.shape[:-1]
        if self.kind == "circle":
            return np.empty((*lead, 0, 2))
        if self._by_corners:
            return x.reshape(*lead, CORNERS_OF[self.kind], 2)
        return x[..., None, :2] + np.tensordot(x[..., 3:], SIZED[self.kind], axes=1) @ self._turned()

    @property
    def slopes(self) -> Floats:
        """Derivatives of the corners, shape (..., K, 2, n)."""
        n, k, lead = self.x.shape[-1], CORNERS_OF[self.kind], self.x.shape[:-1]
        if self._by_corners:
            return np.broadcast_to(np.eye(n).reshape(k, 2, n), (*lead, k, 2, n))
        found = np.zeros((*lead, k, 2, n))
        away = self.corners - self.x[..., None, :2]
        found[..., 0, 0] = found[..., 1, 1] = 1.0
        found[..., 0, 2], found[..., 1, 2] = -away[..., 1], away[..., 0]
        found[..., 3:] = np.moveaxis(SIZED[self.kind] @ self._turned()[..., None, :, :], -3, -1)
        return found

    @cached_property
    def lines(self) -> tuple[Floats, Floats]:
        """Unit normals of the sides, outwards, shape (..., K, 2), and where along them the sides lie, (..., K)."""
        corners = self.corners
        along = corners[..., AFTER[corners.shape[-2]], :] - corners
        length = np.maximum(np.hypot(along[..., 0], along[..., 1]), 1e-12)
        normals = np.stack([along[..., 1], -along[..., 0]], axis=-1) / length[..., None]
        return normals, (normals * corners).sum(axis=-1)

    @property
    def pushes(self) -> Floats:
        """Changes of the numbers that push one side outwards by a metre, and the others least, shape (..., K, n)."""
        if self.kind == "circle":
            return np.broadcast_to([0.0, 0.0, 1.0], (*self.x.shape[:-1], 1, 3))
        (normals, _), slopes, k = self.lines, self.slopes, CORNERS_OF[self.kind]
        ends = [(normals[..., None, :] @ some)[..., 0, :] for some in (slopes, slopes[..., AFTER[k], :, :])]
        inverse = np.linalg.pinv(np.concatenate(ends, axis=-2), rcond=1e-6)
        return np.swapaxes(inverse[..., :k] + inverse[..., k:], -1, -2)

    @property
    def on_other_bases(self) -> Floats:
        """Numbers of nearly the same triangle on its other two bases, shape (2, n); none of other shapes."""
        if self.kind != "triangle" or self.style != "paper":
            return np.empty((0, self.x.shape[-1]))
        begin, end, top = (np.array([np.roll(self.corners, -k, axis=0)[i] for k in (1, 2)]) for i in range(3))
        middle, base = (begin + end) / 2, end - begin
        return np.column_stack(
            [middle, np.arctan2(base[:, 1], base[:, 0]), np.hypot(*base.T), np.hypot(*(top - middle).T)]
        )

    @property
    def sound(self) -> Bools:
        """Whether it is a shape at all: convex, none of its sides and corners too small to be told."""
        if self.kind == "circle":
            return (self.x[..., 2] > 0.005) & (self.x[..., 2] < MOST_RADIUS_OF_PART)
        corners = self.corners
        along = corners[..., AFTER[corners.shape[-2]], :] - corners
        before = along[..., BEFORE[corners.shape[-2]], :]
        cross = before[..., 0] * along[..., 1] - before[..., 1] * along[..., 0]
        turn = np.arctan2(cross, (before * along).sum(axis=-1))
        bends = (turn > LEAST_BEND_OF_PART).all(axis=-1) & (turn < MOST_BEND_OF_PART).all(axis=-1)
        long = (np.hypot(along[..., 0], along[..., 1]) > LEAST_SIDE_OF_PART).all(axis=-1)
        return bends & long & (np.abs(turn.sum(axis=-1) - 2 * np.pi) < 1e-6)

    def outside(self, points: Floats) -> Floats:
        """Return how far points lie outside the line of the side that each is farthest outside of, shape (..., N)."""
        if self.kind == "circle":
            x, y, radius = np.moveaxis(self.x, -1, 0)[..., None]
            return np.hypot(points[:, 0] - x, points[:, 1] - y) - radius
        normals, offsets = self.lines
        return (normals @ points.T - offsets[..., None]).max(axis=-2)

    def distance_slopes(self, points: Floats) -> Floats:
        """Return the derivatives of ``outside`` by the numbers, shape (..., N, n)."""
        if self.kind == "circle":
            away = self.x[..., None, :2] - points
            length = np.maximum(np.hypot(away[..., 0], away[..., 1]), 1e-12)
            return np.concatenate([away / length[..., None], np.full((*length.shape, 1), -1.0)], axis=-1)
        (normals, offsets), corners, slopes = self.lines, self.corners, self.slopes
        after = AFTER[corners.shape[-2]]
        side = (normals @ points.T - offsets[..., None]).argmax(axis=-2)[..., None]
        along = corners[..., after, :] - corners
        along /= np.maximum((along**2).sum(axis=-1), 1e-12)[..., None]
        begin = np.take_along_axis((along * corners).sum(axis=-1)[..., None], side, axis=-2)
        share = np.clip((points * np.take_along_axis(along, side, axis=-2)).sum(axis=-1)[..., None] - begin, 0.0, 1.0)
        of_ends = [(normals[..., None, :] @ ends)[..., 0, :] for ends in (slopes, slopes[..., after, :, :])]
        first, last = (np.take_along_axis(ends, side, axis=-2) for ends in of_ends)
        return -first * (1 - share) - last * share
