"""Near: which shapes are near enough to be seen from where.

Each shape is taken for the circle around it. A few are measured one by one. Of many, a coarse grid of cells knows
those that can be seen from somewhere in each cell: one look-up, however many shapes there are.

In:  circles around the shapes, how far the sensor sees, and positions, (P,) x and (P,) y in metres.
Out: each (position, shape) with the shape in range: two index arrays, in any order.

>>> near = Near(np.array([0.0, 5.0]), np.array([0.0, 0.0]), np.array([0.1, 0.1]), reach=1.0)
>>> [index.tolist() for index in near.pairs(np.array([0.5, 4.5]), np.array([0.0, 0.0]))]
[[0, 1], [0, 1]]
"""

from __future__ import annotations

import numpy as np

from ..arguments import Floats, Ints

CELLS_FROM = 24  # shapes: from so many on, looking up a cell is faster than measuring the distance to all
# A cell is a third of the widest circle from which a shape is seen, but there are at most so many for each shape.
CELLS_PER_CIRCLE, CELLS_PER_SHAPE = 3, 16


class Near:
    """The shapes of a board, by the circle around each, shape (N,), metres; ``reach`` [m] may be infinite."""

    def __init__(self, x: Floats, y: Floats, radii: Floats, reach: float) -> None:
        self.x, self.y, self.far = x, y, radii + reach
        self.cells = Cells(x, y, self.far) if len(x) >= CELLS_FROM and np.isfinite(reach) else None
        self.most = len(x) if self.cells is None else self.cells.most  # candidates at one position

    def pairs(self, x: Floats, y: Floats) -> tuple[Ints, Ints]:
        """Return each (position, shape) with the shape in range."""
        if self.cells is None:
            dx, dy, far = x - self.x[:, None], y - self.y[:, None], self.far[:, None]
            shape, position = (dx * dx + dy * dy <= far * far).nonzero()
            return position, shape
        position, shape = self.cells.candidates(x, y)
        dx, dy, far = x.take(position) - self.x.take(shape), y.take(position) - self.y.take(shape), self.far.take(shape)
        close = (dx * dx + dy * dy <= far * far).nonzero()[0]
        return position.take(close), shape.take(close)


class Cells:
    """A grid of square cells; each knows the circles that reach into it, and perhaps a few more."""

    def __init__(self, x: Floats, y: Floats, far: Floats) -> None:
        self.left, self.low = float((x - far).min()), float((y - far).min())
        width, height = float((x + far).max()) - self.left, float((y + far).max()) - self.low
        self.edge = max(far.max() / CELLS_PER_CIRCLE, np.sqrt(width * height / (CELLS_PER_SHAPE * len(x))))
        self.columns, self.rows = int(width // self.edge) + 1, int(height // self.edge) + 1
        cell, shape = self._touched(x, y, far)
        self.shapes = shape[np.argsort(cell, kind="stable")]
        # One more cell, without shapes, stands for all that lies outside.
        self.count = np.bincount(cell.astype(np.intp, copy=False), minlength=self.columns * self.rows + 1)
        self.begin = np.cumsum(self.count) - self.count
        self.most = int(self.count.max())

    def _touched(self, x: Floats, y: Floats, far: Floats) -> tuple[Ints, Ints]:
        """Return each (cell, shape) whose circle reaches into the cell."""
        # 1. The cells of the square around each circle.
        first_i, last_i = self._index(x - far - self.left), self._index(x + far - self.left)
        first_j, last_j = self._index(y - far - self.low), self._index(y + far - self.low)
        n_rows = last_j - first_j + 1
        shape, k = runs(np.zeros_like(n_rows), (last_i - first_i + 1) * n_rows)
        i, j = first_i[shape] + k // n_rows[shape], first_j[shape] + k % n_rows[shape]
        # 2. Those of them that the circle touches: the cell's nearest point lies in it, or so close that rounding
        #    might have decided.
        half = self.edge / 2
        dx = np.maximum(np.abs(self.left + self.edge * i + half - x[shape]) - half, 0.0)
        dy = np.maximum(np.abs(self.low + self.edge * j + half - y[shape]) - half, 0.0)
        touched = np.hypot(dx, dy) <= far[shape] + 1e-6 * self.edge
        return (i * self.rows + j)[touched], shape[touched]

    def _index(self, offset: Floats) -> Ints:
        return np.floor(offset / self.edge).astype(np.intp)

    def candidates(self, x: Floats, y: Floats) -> tuple[Ints, Ints]:
        """Return each (position, shape) with the shape known to the position's cell."""
        i, j = self._index(x - self.left), self._index(y - self.low)
        on_grid = (i >= 0) & (i < self.columns) & (j >= 0) & (j < self.rows)
        cell = np.where(on_grid, i * self.rows + j, self.columns * self.rows)
        position, entry = runs(self.begin.take(cell), self.count.take(cell))
        return position, self.shapes.take(entry)


def runs(first: Ints, length: Ints) -> tuple[Ints, Ints]:
    """Return several runs of whole numbers one after the other: for each number its run, and the number.

    >>> [index.tolist() for index in runs(np.array([10, 7, 20]), np.array([2, 0, 3]))]
    [[0, 0, 2, 2, 2], [10, 11, 20, 21, 22]]
    """
    run = np.repeat(np.arange(len(length)), length.astype(np.intp, copy=False))  # on 32 bits, no count has 64
    before = length.cumsum() - length  # numbers in all runs before this one
    number = np.arange(len(run))
    number += (first - before).take(run)
    return run, number
