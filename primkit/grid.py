"""Grid: the points that all scans have seen, on cells of one millimetre.

Fifth step of the story. Scans of the same wall from many poses fall into the same cells: each place counts once.
Each cell remembers by which scan it was hit last: where a pose is wrong, all points of its scan are wrong together.

In:  ``Scans`` (any number of times), or (N, 2) points in metres.
Out: ``grid.points()``: the centres of the occupied cells, shape (N, 2), metres, world frame; ``grid.last_seen``.

>>> grid = Grid(resolution=0.001)
>>> grid.add([(0.1, 0.1), (0.10049, 0.1)])
>>> grid.cells.tolist(), grid.points().tolist()
([[100, 100]], [[0.1005, 0.1005]])

The frame, once: cell ``(i, j)`` covers ``[i, i+1) x [j, j+1)`` cells' widths from the board's centre, and
stands for its own centre. Reading a cell at its corner would shift every shape by half a cell.

Source: the paper's section 3.2, "LiDAR Data Acquisition and Grid Representation".
"""

from __future__ import annotations

from threading import Lock

import numpy as np
from numpy.typing import ArrayLike

from .arguments import Floats, Ints, as_points, as_positive
from .lidar import Scans
from .show import thumbnail
from .table import count

ON_BORDER = 1e-9  # cells: so close below a border a point is on it; 0.043 / 0.001 is 42.99999999999999
HALF = 1 << 30  # cells are packed into one whole number, 31 bits each way: boards of 1 mm cells up to 2,000 km wide
ADDING = Lock()  # one for all grids, so that a grid can be copied: several threads may add at once


class Grid:
    """A set of occupied square cells with a side of ``resolution`` metres.

    Raises ValueError if the resolution is not a finite number above zero.

    >>> grid = Grid()
    >>> len(grid), grid.points().shape, grid.n_scans
    (0, (0, 2), 0)
    """

    def __init__(self, resolution: float = 0.001) -> None:
        self.resolution = as_positive(resolution, "resolution")
        self.n_scans = 0  # how many scans were added
        # Keys of the occupied cells, sorted, each once, and the scan that hit each last: one value, changed at once.
        self._occupied = np.empty(0, dtype=np.int64), np.empty(0, dtype=np.int64)

    @classmethod
    def of(cls, cells: Ints, last_seen: Ints, resolution: float) -> Grid:
        """Return a grid of cells, shape (N, 2), in the order of ``cells``, and the scan that hit each last.

        >>> Grid.of(np.array([(3, 5)]), np.array([2]), 0.001).last_seen.tolist()
        [2]
        """
        grid = cls(resolution)
        grid._occupied = as_keys(cells), last_seen
        return grid

    def add(self, seen: Scans | ArrayLike) -> None:
        """Occupy the cells that the hits of scans (or plain points, shape (N, 2), metres) fall into.

        Raises ValueError if a point is not finite or lies too far out for the grid; the grid then stays as it was.
        """
        points, scan, n_new = _hits_of(seen)
        hit, last = np.unique(as_keys(self.to_cells(points))[::-1], return_index=True)
        scan = scan[::-1][last]
        with ADDING:
            keys, scans = self._occupied
            scan = np.where(scan > 0, scan + self.n_scans, 0)
            at = np.searchsorted(keys, hit)
            known = keys.take(at, mode="clip") == hit if len(keys) else np.zeros(len(hit), dtype=bool)
            scans = scans.copy()
            scans[at[known]] = scan[known]
            self._occupied = np.insert(keys, at[~known], hit[~known]), np.insert(scans, at[~known], scan[~known])
            self.n_scans += n_new

    @property
    def cells(self) -> Ints:
        """Indices of the occupied cells, shape (N, 2), sorted: the order of adding leaves no trace."""
        return as_cells(self._occupied[0])

    @property
    def last_seen(self) -> Ints:
        """Number of the scan, from 1, that each cell was hit by last, shape (N,), in the order of ``cells``.

        0 for a cell that a plain point fell into.

        >>> grid = Grid()
        >>> grid.add([(0.1, 0.1)])
        >>> grid.last_seen.tolist()
        [0]
        """
        return self._occupied[1].copy()

    def points(self) -> Floats:
        """Return the centres of the occupied cells, shape (N, 2), metres, in the order of ``cells``."""
        return self.to_points(self.cells)

    def to_cells(self, points: ArrayLike) -> Ints:
        """Return the cell that each point lies in, shape (N, 2).

        >>> Grid(0.001).to_cells([(0.1, 0.1), (-0.0004, 0.043)]).tolist()
        [[100, 100], [-1, 43]]
        """
        with np.errstate(over="ignore"):  # infinitely many cells away is refused below
            cells = np.floor(as_points(points) / self.resolution + ON_BORDER)
        if len(cells) and np.abs(cells).max() >= HALF:
            reach, farthest = HALF * self.resolution, np.abs(as_points(points)).max()
            raise ValueError(f"points must lie within {reach:g} m of the origin, got one {farthest:g} m out")
        return cells.astype(np.int64)

    def to_points(self, cells: ArrayLike) -> Floats:
        """Return the centre of each cell, shape (N, 2), metres.

        >>> Grid(0.001).to_points([(100, 100)]).tolist()
        [[0.1005, 0.1005]]
        """
        return (as_points(cells, "cells") + 0.5) * self.resolution

    def __len__(self) -> int:
        return len(self._occupied[0])

    def __repr__(self) -> str:
        return f"Grid: {count(len(self), 'occupied cell')} of {1000 * self.resolution:g} mm"

    def _repr_html_(self) -> str:
        return thumbnail(repr(self), dots=self.points())


def _hits_of(seen: Scans | ArrayLike) -> tuple[Floats, Ints, int]:
    """Return points, the scan that saw each, from 1, or 0 for plain ones, and how many scans there are."""
    if isinstance(seen, Scans):
        return seen.points(), np.nonzero(seen.hits)[0] + 1, len(seen)
    points = as_points(seen)
    return points, np.zeros(len(points), dtype=np.int64), 0


def as_keys(cells: Ints) -> Ints:
    """Return each cell, shape (N, 2), as one whole number that sorts like its two indices, shape (N,)."""
    return (cells[:, 0] + HALF) * (2 * HALF) + (cells[:, 1] + HALF)


def as_cells(keys: Ints) -> Ints:
    """Return the cells, shape (N, 2), that keys stand for, shape (N,).

    >>> as_cells(as_keys(np.array([(-3, 5)]))).tolist()
    [[-3, 5]]
    """
    return np.column_stack(np.divmod(keys, 2 * HALF)) - HALF
