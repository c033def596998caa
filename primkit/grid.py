"""Grid: the points that all scans have seen, on cells of one millimetre.

Fifth step of the story. Scans of the same wall from many poses fall into the same cells: each place counts once.

In:  ``Scans`` (any number of times), or (N, 2) points in metres.
Out: ``grid.points()``: the centres of the occupied cells, shape (N, 2), metres, world frame.

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
    >>> len(grid), grid.points().shape
    (0, (0, 2))
    """

    def __init__(self, resolution: float = 0.001) -> None:
        self.resolution = as_positive(resolution, "resolution")
        self._keys = np.empty(0, dtype=np.int64)  # sorted, each occupied cell once

    def add(self, seen: Scans | ArrayLike) -> None:
        """Occupy the cells that the hits of scans (or plain points, shape (N, 2), metres) fall into.

        Raises ValueError if a point is not finite or lies too far out for the grid; the grid then stays as it was.
        """
        points = seen.points() if isinstance(seen, Scans) else as_points(seen)
        keys = as_keys(self.to_cells(points))
        with ADDING:
            self._keys = np.union1d(self._keys, keys)

    @property
    def cells(self) -> Ints:
        """Indices of the occupied cells, shape (N, 2), sorted: the order of adding leaves no trace."""
        return as_cells(self._keys)

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
        return len(self._keys)

    def __repr__(self) -> str:
        return f"Grid: {count(len(self), 'occupied cell')} of {1000 * self.resolution:g} mm"

    def _repr_html_(self) -> str:
        return thumbnail(repr(self), dots=self.points())


def as_keys(cells: Ints) -> Ints:
    """Return each cell, shape (N, 2), as one whole number that sorts like its two indices, shape (N,)."""
    return (cells[:, 0] + HALF) * (2 * HALF) + (cells[:, 1] + HALF)


def as_cells(keys: Ints) -> Ints:
    """Return the cells, shape (N, 2), that keys stand for, shape (N,).

    >>> as_cells(as_keys(np.array([(-3, 5)]))).tolist()
    [[-3, 5]]
    """
    return np.column_stack(np.divmod(keys, 2 * HALF)) - HALF
