"""Fan: the beams of one scan, and which of them lie between two bearings.

In:  the beams' angles from the heading, shape (B,), increasing within one turn; intervals of bearings.
Out: each (interval, beam) with the beam in the interval.

>>> fan = Fan(np.radians([0, 90, 180, 270]))
>>> [index.tolist() for index in fan.between(np.radians([80, -10]), np.radians([200, 10]))]
[[0, 0, 1], [1, 2, 0]]

Beams are counted on and on round the turn: the one after the last is the first again. An interval then is from one
number to another, even across the seam, where bearings jump by 2 pi.
"""

from __future__ import annotations

import numpy as np

from ..arguments import Floats, Ints
from .near import runs

TURN = 2 * np.pi
CORNER_HIT = 1e-12  # rad: so close beside a corner a beam hits it, or rounding could let it slip between two sides


class Fan:
    """The beams of one scan: ``angles`` from the heading, shape (B,), radians, increasing within one turn; B >= 1."""

    def __init__(self, angles: Floats) -> None:
        self.size = len(angles)
        self.angles = angles
        self.start, self.step = float(angles[0]), TURN / self.size
        self.offsets = angles - self.start
        # All of a LiDAR's beams are evenly spread over the turn: their numbers follow by a division.
        self.even = bool(np.abs(self.offsets - self.step * np.arange(self.size)).max() < CORNER_HIT / 10)
        self.round = np.tile(np.arange(self.size), 2)  # what beam a number below 2 B is

    def between(self, first: Floats, last: Floats) -> tuple[Ints, Ints]:
        """Return each (interval, beam) with the beam in the interval: two index arrays.

        Intervals go from ``first`` on to ``last``, (K,), rad, by less than a turn; empty where the last is below.
        """
        low = self._beams_before(first - CORNER_HIT)
        count = np.maximum(self._beams_before(last + CORNER_HIT) - low, 0)
        interval, number = runs(low - low // self.size * self.size, count)
        return interval, self.round.take(number)

    def _beams_before(self, bearing: Floats) -> Ints:
        """Return the number of the first beam at or after each bearing."""
        bearing = bearing - self.start
        if self.even:
            return np.ceil(bearing / self.step).astype(np.intp)
        turns = np.floor(bearing / TURN)
        return self.size * turns.astype(np.intp) + np.searchsorted(self.offsets, bearing - TURN * turns)
