"""Composite: a thing made of basic shapes that touch or overlap.

A LiDAR sees the outline of the union, and nothing of what lies inside: so in a world a composite is that outline.

In:  ``Circle``s and ``Polygon``s, metres, world frame, that hang together.
Out: ``Composite``: its ``parts``, and the ``union`` as one ``Polygon``.

>>> from primkit.world import World
>>> stadium = Composite([Polygon([(0, 0), (0.2, 0), (0.2, 0.1), (0, 0.1)]), Circle((0.2, 0.05), 0.05)])
>>> len(World([stadium.union]).shapes), stadium
(1, Composite of circle and rectangle)
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..arguments import Floats, short
from ..shapes import Circle, Polygon, Shape

ARC_CORNERS = 64  # of a quarter of a circle: its outline is off by 1/13,000 of the radius
WELD = 2e-6  # m: closes the slits that rounding leaves between sides that lie on each other


@dataclass(frozen=True, eq=False)
class Composite:
    """Basic shapes that hang together: ``parts``, in any order.

    Raises ValueError if something other than a Circle or a Polygon is among the parts, or their union is not one piece,
    or has a hole.

    >>> Composite([Circle((0, 0), 0.1), Circle((0.5, 0), 0.1)])
    Traceback (most recent call last):
    ...
    ValueError: the parts of a composite must hang together without a hole, got 2 pieces and 0 holes
    """

    parts: tuple[Shape, ...]

    def __init__(self, parts: Iterable[Shape]) -> None:
        try:
            object.__setattr__(self, "parts", tuple(parts))
        except TypeError:
            raise ValueError(f"a composite's parts must be a list of shapes, got {short(parts)}") from None
        for part in self.parts:
            if not isinstance(part, (Circle, Polygon)):
                raise ValueError(f"a composite's parts must be Circle or Polygon, got {type(part).__name__}")
        _ = self.union

    @cached_property
    def union(self) -> Polygon:
        """The outline of all parts together, arcs by 64 corners a quarter: what a LiDAR sees."""
        import shapely

        solid = [part.to_shapely(ARC_CORNERS) if isinstance(part, Circle) else part.to_shapely() for part in self.parts]
        union = shapely.union_all(solid).buffer(WELD, join_style="mitre").buffer(-WELD, join_style="mitre")
        pieces = shapely.get_parts(union)
        holes = int(shapely.get_num_interior_rings(pieces).sum())
        if len(pieces) != 1 or holes:
            got = f"got {len(pieces)} pieces and {holes} holes"
            raise ValueError(f"the parts of a composite must hang together without a hole, {got}")
        return Polygon(_without_straight(shapely.get_coordinates(union.exterior)[:-1]))

    @property
    def kinds(self) -> tuple[str, ...]:
        """The kinds of the parts, in the order of the alphabet."""
        return tuple(sorted(part.kind for part in self.parts))

    def __repr__(self) -> str:
        *first, last = self.kinds
        return f"Composite of {', '.join(first)} and {last}" if first else f"Composite of {last}"


def _without_straight(corners: Floats) -> Floats:
    """Return the corners without those that bend the outline by next to nothing: rounding leaves some."""
    before, after = np.roll(corners, 1, axis=0) - corners, np.roll(corners, -1, axis=0) - corners
    cross = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    return corners[np.abs(cross) > 1e-4 * np.hypot(*before.T) * np.hypot(*after.T)]
