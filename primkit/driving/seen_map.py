"""Seen map: the robot's own map of the board, in squares of a centimetre: what is free, what is a wall, what is unseen.

In:  scans, one after the other; shapes that were found so far.
Out: ``SeenMap``: ``.free``, ``.seen``, ``.wall``, each of shape (N, N), square (i, j) at the i-th x and the j-th y.

>>> from primkit.lidar import scan
>>> from primkit.world import World
>>> board = SeenMap(1.0)
>>> board.add(scan(World(), [(0, 0, 0)]), range_min=0.05, range_max=0.3)
>>> int(board.free.sum()), int(board.seen.sum())  # a first look, into the open: nobody knows what stands very near
(2828, 44)

Up to its hit a beam's way is free. A beam that returns nothing saw no outline between the sensor's least and greatest
distance; but an outline nearer than the least blocks it as well. So it counts only where the ring around the robot,
from its body to the least distance, is known to be free. The first look cannot know that: what it takes for free is
driven through (a contact stops the robot), but not yet seen.

Whatever the scale of the board, the map is one of the paper's: its squares are a hundredth of a metre times the scale,
and so are the lengths in it and in what is planned on it. What comes in is in metres.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..arguments import Bools, Floats
from ..found import Found
from ..lidar import Scans
from ..robot import BODY
from ..seen import is_seen
from ..shapes import Polygon, Shape
from ..world import scale_of
from .moving_grid import BEFORE_A_HIT

SQUARE = 0.01  # m: side of a square of the map
JOINED = 0.04  # m: hits of neighbouring beams this near to each other lie on one outline
EXPLAINED = 0.01  # m: what lies in a shape that was found, or this near to it, is no place where another could hide
# A shape with sides of 4 cm and corners of 30 degrees, the smallest there is, has 7 square centimetres.
LEAST_PLACE = 4  # squares: in fewer that hang together, none can hide
OUTLINE_STEP = 0.004  # m: outlines are looked at in steps of this length


class SeenMap:
    """What one robot knows of its board; it knows where the board, ``size`` metres wide, ends."""

    def __init__(self, size: float) -> None:
        self.scale = scale_of(size)
        self.size = size / self.scale
        n = max(1, int(np.ceil(self.size / SQUARE - 1e-9)))
        lines = (np.arange(n) + 0.5) * SQUARE - self.size / 2
        self.centers = np.stack(np.meshgrid(lines, lines, indexing="ij"), axis=-1)  # (N, N, 2), metres
        self.free = np.zeros((n, n), dtype=bool)  # may be driven through
        self.seen = np.zeros((n, n), dtype=bool)  # surely holds nothing
        self._hits = np.zeros((n, n), dtype=np.int64)
        self._passes = np.zeros((n, n), dtype=np.int64)
        self._bumps = np.zeros((n, n), dtype=bool)

    @property
    def wall(self) -> Bools:
        """Squares that hold a piece of outline; a hit that many beams passed through since was a stray one."""
        walls: Bools = self._bumps | (2 * self._hits > self._passes)
        return walls

    def index(self, points: Floats) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return the squares that points lie in, two arrays of shape (...); beyond the edge, the last ones."""
        cells = np.floor((points + self.size / 2) / SQUARE).astype(np.intp).clip(0, len(self.free) - 1)
        return cells[..., 0], cells[..., 1]

    def add(self, scans: Scans, range_min: float, range_max: float) -> None:
        """Learn from scans, one after the other; the sensor's limits are in metres."""
        scans = scans.scaled(1 / self.scale)
        for i in range(len(scans)):
            self._learn(scans[i : i + 1], range_min / self.scale, range_max / self.scale)

    def _learn(self, one: Scans, range_min: float, range_max: float) -> None:
        pose, ranges, hit = one.poses[0], one.ranges[0], one.hits[0]
        likely_free = np.where(hit, ranges - BEFORE_A_HIT, range_max)
        surely_free = np.where(hit | self._ring_is_free(one, range_min), likely_free, 0.0)
        likely, surely = self._reached(pose, likely_free), self._reached(pose, surely_free)
        around = np.hypot(*np.moveaxis(self.centers - pose[:2], -1, 0))
        self.seen |= surely | (around <= BODY)  # nothing is where the robot is
        self.free |= likely | (around <= BODY)
        self._passes += surely.astype(np.int64)
        np.add.at(self._hits, self.index(join_hits(one)), 1)
        self.free &= ~self.wall

    def _ring_is_free(self, one: Scans, range_min: float) -> Bools:
        """Tell for each beam whether its way from the body to the sensor's least distance is known to be free."""
        steps = np.arange(BODY, range_min + SQUARE / 2, SQUARE / 2)
        bearings = one.poses[0, 2] + one.angles
        ways = one.poses[0, :2] + steps[:, None, None] * np.stack([np.cos(bearings), np.sin(bearings)], axis=-1)
        clear: Bools = np.all(self.free[self.index(ways)], axis=0)
        return clear

    def _reached(self, pose: Floats, reach: Floats) -> Bools:
        """Tell which squares' centres are nearer than the shorter of the two beams that they lie between."""
        x, y = np.moveaxis(self.centers - pose[:2], -1, 0)
        beam = np.mod(np.arctan2(y, x) - pose[2], 2 * np.pi) / (2 * np.pi / len(reach))
        low = beam.astype(np.int64) % len(reach)
        near: Bools = np.hypot(x, y) < np.minimum(reach[low], np.roll(reach, -1)[low])
        return near

    def bump(self, place: Floats) -> None:
        """Mark a place, shape (2,), metres, where the body touched something."""
        self._bumps[self.index(place)] = True
        self.free &= ~self._bumps

    def covered(self, outlines: list[tuple[Shape, Floats]], reach: float) -> Bools:
        """Tell which squares' centres lie in an outline or at most ``reach`` metres outside."""
        inside = np.zeros(self.free.shape, dtype=bool)
        for shape, _ in outlines:
            inside |= shape.signed_distance(self.centers.reshape(-1, 2)).reshape(inside.shape) <= reach
        return inside

    def hiding_places(self, explained: Bools) -> Bools:
        """Tell which squares belong to unseen places large enough for a shape, those that are explained left out."""
        from scipy.ndimage import label

        unseen = ~(self.seen | self.wall | explained)
        places, _ = label(unseen, structure=np.ones((3, 3)))
        large: Bools = (np.bincount(places.ravel()) >= LEAST_PLACE)[places] & unseen
        return large


def join_hits(one: Scans) -> Floats:
    """Return a scan's hits and, between neighbouring hits on one outline, points half a square apart, shape (N, 2)."""
    bearings, ranges = one.poses[0, 2] + one.angles, np.where(one.hits[0], one.ranges[0], np.nan)
    hits = one.poses[0, :2] + ranges[:, None] * np.column_stack([np.cos(bearings), np.sin(bearings)])
    gaps = np.roll(hits, -1, axis=0) - hits
    on_one = np.hypot(*gaps.T) <= JOINED  # false where there is no hit
    steps = np.arange(0, 1, SQUARE / 2 / JOINED)[:, None, None]
    between = (hits[on_one] + steps * gaps[on_one]).reshape(-1, 2)
    return np.vstack([hits[one.hits[0]], between])


def outlines_in(found: Found, scale: float = 1.0) -> list[tuple[Shape, Floats]]:
    """Return the outline and the points, shape (N, 2), of each shape, and of each thing that is of no kind.

    They are those that a map of this scale has.
    """
    things = [(one.shape, one.points) for one in found]
    things += [(Polygon(other.outline), other.points) for other in found.others]
    return [(outline.scaled(1 / scale), points / scale) for outline, points in things]


def open_outlines(outlines: list[tuple[Shape, Floats]]) -> Floats:
    """Return the places on outlines that are still open: more than 12 mm from each of their own points.

    Shape (N, 2), metres. Points that lie near an outline, but not on it, close nothing: the shape may be another.
    """
    open_ = [np.empty((0, 2))]
    for shape, points in outlines:
        places = shape.outline(max(8, int(shape.perimeter / OUTLINE_STEP)))
        open_.append(places[~is_seen(places, points)])
    return np.vstack(open_)
