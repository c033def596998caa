"""Steady: what stands still in many scans, without what moved through them.

In:  ``Scans``, such as a robot recorded among people.
Out: the same ``Scans``, where hits on what moved read ``inf``.

A grid keeps every hit for ever: who walks past leaves a trail of points, and a trail may look like a thing. So each
cell is asked of all scans, whatever their order:

    a scan hits it         if a hit falls into it
    a scan sees through    if a beam passes within half a cell of its centre, and hits more than MARGIN cells behind
    it is steady           if at least as many scans hit it as see through it

A beam without a hit tells nothing here: glass and black things swallow beams. Not here: what changes while the robot
drives, and is to be forgotten at once (``moving_grid``).
"""

from __future__ import annotations

import numpy as np

from ..arguments import Floats, Ints, check_type
from ..grid import ON_BORDER, Grid, as_keys
from ..lidar import Scans

MARGIN = 10  # cells: along a wall that is seen at a sharp angle, neighbouring beams are so far apart


def steady(scans: Scans, resolution: float = 0.001) -> Scans:
    """Return scans without the hits on what moved; cells have a side of ``resolution`` metres.

    Raises ValueError if these are no scans, or the resolution is not above zero.

    Examples
    --------
    Something stood in front of a wall in one scan of three:

    >>> angles, ranges = np.zeros(1), np.array([[1.0], [0.5], [1.0]])
    >>> scans = Scans(np.zeros((3, 3)), angles, ranges, np.zeros(3, dtype=bool))
    >>> steady(scans, 0.01).ranges.ravel().tolist()
    [1.0, inf, 1.0]
    """
    check_type(scans, Scans, "scans must be Scans")
    frame = Grid(resolution)
    scan, beam = np.nonzero(scans.hits)
    keys, cell = np.unique(as_keys(frame.to_cells(scans.points())), return_inverse=True)
    frame.add(scans)
    hits = np.bincount(np.unique(cell * len(scans) + scan) // max(1, len(scans)), minlength=len(keys))
    moved = (hits < _seen_through(frame.points(), scans, resolution))[cell]
    ranges = scans.ranges.copy()
    ranges[scan[moved], beam[moved]] = np.inf
    return Scans(scans.poses, scans.angles, ranges, scans.inside)


def _seen_through(centers: Floats, scans: Scans, resolution: float) -> Ints:
    """Return how many scans see through each cell, (N,), given its centre, (N, 2), metres."""
    turn = 2 * np.pi
    order = np.argsort(np.mod(scans.angles, turn))
    bearings = np.mod(scans.angles, turn)[order]
    bearings = np.concatenate([bearings[-1:] - turn, bearings, bearings[:1] + turn])
    order = np.concatenate([order[-1:], order, order[:1]])
    through = np.zeros(len(centers), dtype=np.intp)
    for (x, y, heading), ranges in zip(scans.poses, scans.ranges, strict=True):
        dx, dy = centers[:, 0] - x, centers[:, 1] - y
        away, bearing = np.hypot(dx, dy), np.mod(np.arctan2(dy, dx) - heading, turn)
        after = np.clip(np.searchsorted(bearings, bearing), 1, len(bearings) - 1)
        nearest = after - (bearing - bearings[after - 1] < bearings[after] - bearing)
        across = away * np.abs(np.sin(bearing - bearings[nearest]))
        reach = ranges[order[nearest]]
        beside = across <= (0.5 + ON_BORDER) * resolution
        through += beside & (reach > away + MARGIN * resolution) & (reach < np.inf)
    return through
