"""Found: the shapes that were found, as a list that prints in a few lines.

In:  detections, as ``find_shapes`` makes them.
Out: a list of them; at the end of a notebook's cell it shows as a table.

>>> from primkit.measure import Detection
>>> from primkit.shapes import Circle
>>> ring = Circle((0.1, -0.02), 0.06)
>>> Found([Detection(ring, ring.outline(90), 0.0003)])
1 shape found
   kind    centre x, y [mm]  dimensions [mm]  points  rms [mm]  certain
-  ------  ----------------  ---------------  ------  --------  -------
0  circle  100.0, -20.0      radius 60.0      90      0.30      -
>>> Found()
no shapes found
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import SupportsIndex, overload

import numpy as np

from .arguments import Floats
from .measure import CELL, Detection, Other, Thing, Wall
from .show import in_mm, lengths_in_mm
from .table import Table, count

MOST_ROWS = 20  # so many shapes, walls and other things are told one by one
SUPPOSED = "In brackets: supposed, not measured."
BOUNDED = "Not all was tried: there is a bound to the work, and it was reached."


class Found(list[Detection]):
    """A list of detections, from left to right, and what else the points are: the sum of all is all points.

    ``walls`` are straight pieces, ``others`` things that are none of the kinds, ``strays``, shape (N, 2), metres, the
    points that lie on nothing; ``resolution`` is the side of the cells that all of them lie on, metres. ``bounded``
    tells whether there were so many points, or things in doubt, that not all was tried: there may be more to tell.

    >>> Found([]) == [], Found([])[:1]
    (True, no shapes found)
    """

    def __init__(
        self,
        shapes: Iterable[Detection] = (),
        walls: Iterable[Wall] = (),
        others: Iterable[Other] = (),
        strays: Floats | None = None,
        resolution: float = CELL,
        bounded: bool = False,
    ) -> None:
        super().__init__(shapes)
        self.walls, self.others = tuple(walls), tuple(others)
        self.strays = np.empty((0, 2)) if strays is None else strays
        self.resolution, self.bounded = resolution, bounded

    def table(self) -> Table:
        """Return what was found as a table: a row for each shape, with its index, each wall and each other thing."""
        told: list[tuple[str, Thing]] = [(str(k), one) for k, one in enumerate(self)]
        told += [("", wall) for wall in self.walls]
        told += [("", other) for other in self.others]
        rows = [(index, *_cells(one, self.resolution)) for index, one in told[:MOST_ROWS]]
        notes = [SUPPOSED] if any("(" in row[3] for row in rows) else []
        notes += [f"And {len(told) - MOST_ROWS} more."] if len(told) > MOST_ROWS else []
        notes += [BOUNDED] if self.bounded else []
        return Table(FOUND_HEADER, rows, self.title(), notes)

    def title(self) -> str:
        """Return in words what the points are.

        >>> Found(strays=np.zeros((3, 2))).title()
        'no shapes found; 3 strays'
        """
        rest = self.rest()
        return f"{count(len(self), 'shape')} found{'; ' * bool(rest)}{rest}"

    def rest(self) -> str:
        """Return in words what there is beside the shapes; nothing if all points lie on these."""
        rest = [count(len(self.walls), "wall")] if self.walls else []
        rest += [f"{count(len(self.others), 'thing')} of no kind"] if self.others else []
        return ", ".join(rest + ([count(len(self.strays), "stray")] if len(self.strays) else []))

    def __repr__(self) -> str:
        return str(self.table()).replace("\n\n", "\n") if self or self.bounded else self.title()

    def _repr_html_(self) -> str:
        return self.table()._repr_html_() if self or self.walls or self.others else f"<p>{self!r}</p>"

    @overload
    def __getitem__(self, which: SupportsIndex) -> Detection: ...
    @overload
    def __getitem__(self, which: slice) -> Found: ...
    def __getitem__(self, which: SupportsIndex | slice) -> Detection | Found:
        if isinstance(which, slice):
            return Found(super().__getitem__(which), resolution=self.resolution, bounded=self.bounded)
        return super().__getitem__(which)


def resolution_of(found: Iterable[object]) -> float:
    """Return the side of the cells that shapes were found on, metres; 1 mm where nothing tells it."""
    if isinstance(found, Found):
        return found.resolution
    return next((CELL * one.frame.unit for one in found if isinstance(one, Detection)), CELL)


FOUND_HEADER = ("", "kind", "centre x, y [mm]", "dimensions [mm]", "points", "rms [mm]", "certain")


def _cells(one: Thing, resolution: float) -> tuple[str, ...]:
    """Return a row's texts; lengths to a tenth of a cell."""
    n_points = f"{len(one.points):,}"
    if isinstance(one, Wall):
        (length,) = lengths_in_mm([one.length], resolution)
        centre = lengths_in_mm((one.start + one.end) / 2, resolution)
        return "wall", ", ".join(centre), f"length {length}", n_points, "-", "-"
    if isinstance(one, Other):
        (across,) = lengths_in_mm([float(np.hypot(*np.ptp(one.points, axis=0)))], resolution)
        centre = lengths_in_mm(one.points.mean(axis=0), resolution)
        return "of no kind", ", ".join(centre), f"about {across} across", n_points, "-", "-"
    at, dimensions = in_mm(one.shape, one.measured, resolution)
    asked = "-" if one.choice is None and np.isnan(one.told_margin) else "yes" if one.certain else "no"
    return one.kind, at, dimensions, n_points, f"{1000 * one.rms:.2f}", asked
