"""Faults: what a sensor does to its ranges: noise, hits that are lost, hits on nothing, and rounding.

In:  a LiDAR and how many scans there will be; ranges, shape (P, B), metres, without faults.
Out: the same array, disturbed in place.

>>> from primkit.lidar import Lidar
>>> ranges = np.full((1, 4), 0.2)
>>> Faults(Lidar(beams=4, dropout=1.0), 1, 1, 0).disturb(ranges)
>>> ranges.tolist()
[[inf, inf, inf, inf]]
"""

from __future__ import annotations

from copy import deepcopy
from typing import Any

import numpy as np

from .arguments import Floats, as_rng


class Faults:
    """The sensor's faults, each with a stream of numbers of its own, for a few scans after the other."""

    def __init__(self, lidar: Any, n_scans: int, few: int, rng: int | np.random.Generator | None) -> None:
        self.lidar = lidar
        if rng is None and not (lidar.noise_std or lidar.dropout or lidar.spurious):
            return  # nothing is random: seeding takes longer than a scan
        self.noise, self.losses, self.ghosts = as_rng(rng).spawn(3)
        # Of the ghosts' stream, the first numbers say for each beam whether there is one, the rest where.
        self.places = self.ghosts
        if lidar.spurious > 0 and n_scans > few:
            self.places = deepcopy(self.ghosts)
            for start in range(0, n_scans, few):
                self.places.random((min(few, n_scans - start), lidar.beams))

    def disturb(self, ranges: Floats) -> None:
        """Add the faults to exact ranges, in place; they are those of the next scans."""
        lidar = self.lidar
        if lidar.noise_std > 0:
            noisy = ranges + self.noise.normal(0.0, lidar.noise_std, ranges.shape)
            hit = np.isfinite(ranges)
            ranges[hit] = np.clip(noisy[hit], lidar.range_min, lidar.range_max)
        if lidar.dropout > 0:
            ranges[self.losses.random(ranges.shape) < lidar.dropout] = np.inf
        if lidar.spurious > 0:
            ghost = self.ghosts.random(ranges.shape) < lidar.spurious
            ranges[ghost] = self.places.uniform(lidar.range_min, lidar.range_max, int(ghost.sum()))
        if lidar.range_step > 0:
            hit = np.isfinite(ranges)
            rounded = np.round(ranges[hit] / lidar.range_step) * lidar.range_step
            ranges[hit] = np.clip(rounded, lidar.range_min, lidar.range_max)
