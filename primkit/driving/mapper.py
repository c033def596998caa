"""Mapper: the map of a robot while it drives: scans in, shapes out.

In:  ``Scans``, in the order in which they were taken.
Out: ``mapper.found``, the shapes in all of them; ``mapper.grid``, their points.

>>> from primkit.lidar import scan
>>> from primkit.robot import teleport_poses
>>> from primkit.world import random_world
>>> world, mapper = random_world(4, rng=7), Mapper(rng=0)
>>> for pose in teleport_poses(world):
...     mapper.add(scan(world, pose))
>>> [one.kind for one in mapper.found]
['pentagon', 'rectangle', 'pentagon', 'rectangle']

The fits of the last look are the warm starts of the next: what a scan has not changed is not measured again, and what
has a few points more is fitted anew from what it was. To about a tenth of a millimetre the shapes are those that
``find_shapes`` makes of the same grid.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import ArrayLike

from ..arguments import Ints, as_count, as_rng, check_type, short
from ..found import Found
from ..grid import Grid
from ..lidar import Scans
from ..pipeline import ROBUST, Settings, WarmStarts, find_again
from ..shapes import Kind
from ..show import thumbnail
from ..steps import Steps
from ..table import count
from .moving_grid import MovingGrid


def unmended(steps: Steps | None) -> Settings:
    """Return the settings that show what steps do: a segmentation of one's own gets no second opinion that mends it.

    >>> unmended(None), unmended(Steps(segment=lambda points, n_shapes: points[:, 0] > 0))
    (ROBUST, Settings(second_opinion=False))
    """
    return replace(ROBUST, second_opinion=getattr(steps, "segment", None) is None)


class Mapper:
    """A grid that scans are added to, and the shapes in it, which are looked for when they are asked for.

    Parameters
    ----------
    resolution : float, optional
        Side of the grid's cells, metres; 1 mm when it is not given.
    grid : Grid or MovingGrid, optional
        The grid to add to, in the place of a new one; a ``MovingGrid`` gives up what has moved.
    n_shapes, settings, steps, kinds
        As for ``find_shapes``. While there are fewer points than shapes, all of them are strays.
    rng : int or numpy.random.Generator, optional
        Seed of every look, or what draws it.

    Raises
    ------
    ValueError
        If an argument is out of its range or of another type, or a resolution is given with a grid.

    Examples
    --------
    One scan sees half of a circle: what it is remains open until the robot has gone around it.

    >>> from primkit.lidar import scan
    >>> from primkit.shapes import Circle
    >>> from primkit.world import World
    >>> world, mapper = World([Circle((0.2, 0.0), 0.06)]), Mapper(rng=0)
    >>> for pose in [(0, 0, 0), (0.2, -0.15, 0), (0.4, 0, 0), (0.2, 0.15, 0)]:
    ...     mapper.add(scan(world, pose))
    ...     print(mapper.found[0].kind, mapper.found[0].certain)
    circle False
    circle False
    circle True
    circle True
    """

    def __init__(
        self,
        resolution: float | None = None,
        *,
        grid: Grid | MovingGrid | None = None,
        n_shapes: int | None = None,
        settings: Settings = ROBUST,
        steps: Steps | None = None,
        kinds: Sequence[Kind] | None = None,
        rng: int | np.random.Generator | None = None,
    ) -> None:
        if grid is None:
            grid = Grid() if resolution is None else Grid(resolution)
        elif resolution is not None:
            raise ValueError(f"resolution must not be given with a grid, which knows its own, got {short(resolution)}")
        check_type(grid, (Grid, MovingGrid), "grid must be a Grid or a MovingGrid")
        self.grid: Grid | MovingGrid = grid
        self.n_shapes = None if n_shapes is None else as_count(n_shapes, "n_shapes", least=0)
        generator = as_rng(rng)
        seed = rng if isinstance(rng, (int, np.integer)) else int(generator.integers(2**63))
        self._find: Callable[..., Found] = partial(find_again, settings=settings, steps=steps, kinds=kinds, rng=seed)
        self._warm: WarmStarts = {}
        self._found = self._find([], self._warm)  # refuses what find_shapes refuses, before anything is driven
        self._found_in = _told_by(Grid())

    def add(self, seen: Scans | ArrayLike) -> None:
        """Add scans to the grid, as ``grid.add`` does; nothing is looked for yet.

        Raises ValueError if the grid cannot take them; all then stays as it was.
        """
        self.grid.add(seen)

    @property
    def found(self) -> Found:
        """The shapes in the grid; looked for anew when it has changed."""
        told = _told_by(self.grid)
        if not np.array_equal(told, self._found_in):
            self._found, self._found_in = self.look(self.grid), told
        return self._found

    def look(self, grid: Grid | MovingGrid) -> Found:
        """Return the shapes in a copy of the grid: for a thread that looks while the robot drives on, one at a time."""
        if self.n_shapes is not None and len(grid) < self.n_shapes:
            return Found(strays=grid.points(), resolution=grid.resolution)
        return self._find(grid, self._warm, self.n_shapes)

    def __repr__(self) -> str:
        return f"Mapper: {count(len(self.grid), 'occupied cell')} of {1000 * self.grid.resolution:g} mm"

    def _repr_html_(self) -> str:
        return thumbnail(repr(self), dots=self.grid.points())


def _told_by(grid: Grid | MovingGrid) -> Ints:
    """Return all that shapes are made of: each cell, and the scan that saw it last, shape (N, 3)."""
    return np.column_stack([grid.cells, grid.last_seen])
