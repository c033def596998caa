"""Found: the shapes that were found, as a list that prints in a few lines.

In:  detections, as ``find_shapes`` makes them.
Out: a list of them; at the end of a notebook's cell it shows as a table.

>>> from primkit.measure import Detection
>>> from primkit.shapes import Circle
>>> ring = Circle((0.1, -0.02), 0.06)
>>> Found([Detection(ring, ring.outline(90), 0.0003)])
1 shape found
   kind    centre x, y [mm]  dimensions [mm]  points  rms [mm]
-  ------  ----------------  ---------------  ------  --------
0  circle  100.0, -20.0      radius 60.0      90      0.30
>>> Found()
no shapes found
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import SupportsIndex, overload

import numpy as np

from .arguments import Floats
from .measure import Detection, Other, Wall
from .show import in_mm
from .table import Table, count

MOST_ROWS = 20  # so many shapes are told one by one
SUPPOSED = "In brackets: supposed, not measured."


class Found(list[Detection]):
    """A list of detections, from left to right, and what else the points are: the sum of all is all points.

    ``walls`` are straight pieces, ``others`` things that are none of the kinds, ``strays``, shape (N, 2), metres, the
    points that lie on nothing.

    >>> Found([]) == [], Found([])[:1]
    (True, no shapes found)
    """

    def __init__(
        self,
        shapes: Iterable[Detection] = (),
        walls: Iterable[Wall] = (),
        others: Iterable[Other] = (),
        strays: Floats | None = None,
    ) -> None:
        super().__init__(shapes)
        self.walls, self.others = tuple(walls), tuple(others)
        self.strays = np.empty((0, 2)) if strays is None else strays

    def table(self) -> Table:
        """Return what was found as a table, a row for each shape."""
        rows = [(str(k), *_cells(one)) for k, one in enumerate(self[:MOST_ROWS])]
        notes = [SUPPOSED] if any("(" in row[3] for row in rows) else []
        notes += [f"And {len(self) - MOST_ROWS} more."] if len(self) > MOST_ROWS else []
        return Table(FOUND_HEADER, rows, self._title(), notes)

    def _title(self) -> str:
        """Return in words what the points are."""
        rest = [count(len(self.walls), "wall")] if self.walls else []
        rest += [f"{count(len(self.others), 'thing')} of no kind"] if self.others else []
        rest += [count(len(self.strays), "stray")] if len(self.strays) else []
        return f"{count(len(self), 'shape')} found{'; ' * bool(rest)}{', '.join(rest)}"

    def __repr__(self) -> str:
        table = self.table()
        return str(table).replace("\n\n", "\n") if self else table.title

    def _repr_html_(self) -> str:
        return self.table()._repr_html_() if self else f"<p>{self!r}</p>"

    @overload
    def __getitem__(self, which: SupportsIndex) -> Detection: ...
    @overload
    def __getitem__(self, which: slice) -> Found: ...
    def __getitem__(self, which: SupportsIndex | slice) -> Detection | Found:
        if isinstance(which, slice):
            return Found(super().__getitem__(which))
        return super().__getitem__(which)


FOUND_HEADER = ("", "kind", "centre x, y [mm]", "dimensions [mm]", "points", "rms [mm]")


def _cells(one: Detection) -> tuple[str, ...]:
    centre, dimensions = in_mm(one.shape, one.measured)
    return one.kind, centre, dimensions, f"{len(one.points):,}", f"{1000 * one.rms:.2f}"
