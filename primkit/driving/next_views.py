"""Next views: what a scan would show, from each square that the robot can reach.

In:  what each square is worth to be seen and where beams end, both (N, N); the ``Ways`` from where the robot stands.
Out: ``next_view``: the square to scan from next, or ``None`` when no reachable one would show anything new.

A beam through the map goes on through what is free or unseen, and ends at a wall or a shape: what it meets on its way
is what a scan would show. The best view has the greatest

    gain / (time + SCAN_TIME),   gain: worth of all squares that the beams meet; time: of the way there [s].

Source: Connolly (1985), "The determination of next best views"; the weighing of gain and way follows
Gonzalez-Banos and Latombe (2002), "Navigation strategies for exploring indoor environments".
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..arguments import Bools, Floats
from ..lidar import Lidar
from .seen_map import SQUARE
from .ways import DRIVE_SPEED, Ways

VIEW_SPACING = 4  # squares from one view to the next, both ways
BEAM_STRIDE = 2  # every second beam is followed: it tells nearly as much
SCAN_TIME = 1.5  # s that a scan costs beside its way: few large gains, not many small ones
HALF_DIAGONAL = SQUARE / np.sqrt(2)  # m
LEAST_GAIN = 0.5  # squares: a view that shows less shows nothing


@dataclass(frozen=True)
class View:
    """A square to scan from, and what the scan is expected to show, in unseen squares."""

    square: tuple[int, int]  # its row and column
    gain: float


def next_view(worth: Floats, opaque: Bools, ways: Ways, lidar: Lidar, been: Bools) -> View | None:
    """Return the reachable view that shows most for its time; None when no new one shows anything.

    ``worth``: of each square to be seen; ``opaque``: where beams end; ``been``: scanned from already; all (N, N). The
    robot does not scan where an outline may stand nearer than the sensor's least distance: it would go unnoticed, and
    so would what is behind.
    """
    lattice = np.zeros(ways.fits.shape, dtype=bool)
    lattice[VIEW_SPACING // 2 :: VIEW_SPACING, VIEW_SPACING // 2 :: VIEW_SPACING] = True
    squares = np.argwhere(lattice & np.isfinite(ways.length) & (ways.room >= lidar.range_min + HALF_DIAGONAL) & ~been)
    if len(squares) == 0:
        return None
    gains = _shown(squares, worth, opaque, lidar)[0].sum(axis=(1, 2))
    times = ways.length[squares[:, 0], squares[:, 1]] / DRIVE_SPEED
    best = int(np.argmax(gains / (times + SCAN_TIME)))
    if gains[best] < LEAST_GAIN:
        return None
    return View((int(squares[best, 0]), int(squares[best, 1])), float(gains[best]))


def shown_from(square: tuple[int, int], worth: Floats, opaque: Bools, lidar: Lidar) -> Bools:
    """Tell which squares of any worth the beams from one square would show, shape (N, N)."""
    shown, numbers, rim = _shown(np.array([square]), worth, opaque, lidar)
    squares = np.zeros((len(worth) + 2 * rim, len(worth) + 2 * rim), dtype=bool)
    squares.flat[numbers[shown > 0]] = True
    return squares[rim:-rim, rim:-rim]


def _shown(
    squares: NDArray[np.int64], worth: Floats, opaque: Bools, lidar: Lidar
) -> tuple[Floats, NDArray[np.int64], int]:
    """Follow beams from squares, shape (M, 2), over the map with a rim around it: beams may leave the board.

    Returns the worth of what each beam meets at each step, times the area between it and its neighbour there, in
    squares, shape (M, B, R); which square that is, by its number on the map with its rim; and the rim, in squares.
    """
    across = max(1.5 * len(worth) * SQUARE, lidar.range_min + SQUARE)  # beyond the board there is nothing to see
    steps = np.arange(lidar.range_min, min(lidar.range_max, across), SQUARE) + SQUARE / 2
    bearings = lidar.angles[::BEAM_STRIDE]
    i, j = np.rint(np.stack([np.cos(bearings), np.sin(bearings)])[:, :, None] * steps / SQUARE).astype(np.int64)
    rim = int(steps[-1] / SQUARE) + 1
    width = len(worth) + 2 * rim
    start = (squares[:, 0] + rim) * width + squares[:, 1] + rim
    numbers = start[:, None, None] + (i * width + j)
    stops = np.pad(opaque, rim).ravel()[numbers]
    reached = np.ones_like(stops)  # a beam shows the wall that it ends at
    np.logical_not(np.logical_or.accumulate(stops[:, :, :-1], axis=2), out=reached[:, :, 1:])
    area = np.minimum(BEAM_STRIDE * steps * lidar.angle_increment / SQUARE, 1.0)
    return np.pad(worth, rim).ravel()[numbers] * reached * area, numbers, rim
