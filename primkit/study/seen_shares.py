"""Seen: how much of each shape's outline a drive has seen.

In:  a ``World``, the ``Scans`` of it, and the sensor that made them.
Out: for each shape a share from 0 to 1.

>>> from primkit.lidar import scan
>>> from primkit.shapes import Circle
>>> world = World([Circle((0.2, 0.0), 0.05), Circle((-0.4, 0.0), 0.05)])
>>> [round(share, 1) for share in shares_seen(world, scan(world, [(0, 0, 0)]), Lidar())]
[0.4, 0.0]

The truth decides, not the method: what counts are the hits that a sensor without faults would have had.
"""

from __future__ import annotations

from ..arguments import Floats
from ..lidar import Lidar, Scans
from ..seen import is_seen
from ..shapes import Shape
from ..world import World
from .oracle import exact_ranges, hit_sides


def shares_seen(world: World, scans: Scans, lidar: Lidar) -> tuple[float, ...]:
    """Return for each shape of a world the share of its outline that was seen."""
    exact = exact_ranges(world, scans, lidar)
    hits = Scans(scans.poses, scans.angles, exact, scans.inside).points()
    owners = hit_sides(world, hits)[:, 0]
    return tuple(share_seen(shape, hits[owners == number]) for number, shape in enumerate(world.shapes))


def share_seen(shape: Shape, hits: Floats) -> float:
    """Return the share of a shape's outline that lies within 12 mm of its hits.

    >>> from primkit.shapes import Circle
    >>> share_seen(Circle((0, 0), 0.05), np.empty((0, 2)))
    0.0
    """
    return float(is_seen(shape.outline(400), hits).mean())
