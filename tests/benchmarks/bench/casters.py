"""Casters: other ways to turn poses into ranges, with what the classroom has; ``others.py`` has ir-sim's.

In:  a ``World`` and a ``Lidar``.
Out: ``Cast``: a function from poses, shape (P, 3), to ranges, shape (P, B), infinity where a beam meets nothing
     within the limits. All that depends on the world alone is done before: what is timed is the scanning.

* the loops of ``loops.py``, compiled by numba or not, on one thread. Circles are exact.
* shapely (GEOS): a tree of the outlines, the beams that meet them, where, and how far off that is. GEOS has no
  circles: they are polygons of 64 sides, as in ir-sim.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from primkit.lidar import Lidar
from primkit.shapes import Circle, Polygon
from primkit.world import World

Floats = NDArray[np.float64]
Cast = Callable[[Floats], Floats]
Loop = Callable[..., None]  # one of those in loops.py

GEOS = "shapely (GEOS)"
QUADRANT = 16  # sides of a polygon for a quarter of a circle: what shapely and ir-sim take by default


def numba_caster(world: World, lidar: Lidar, loop: Loop) -> Cast:
    """Return brute force over the world's sides and circles."""
    polygons = [s for s in world.shapes if isinstance(s, Polygon)]
    circles = [(*s.center, s.radius) for s in world.shapes if isinstance(s, Circle)]
    around = np.array(circles, dtype=float).reshape(-1, 3)
    sides = np.vstack([np.empty((0, 4)), *(np.column_stack([p.vertices, p.edges]) for p in polygons)])
    cos, sin = np.cos(lidar.angles), np.sin(lidar.angles)

    def cast(poses: Floats) -> Floats:
        out = np.empty((len(poses), lidar.beams))
        loop(poses, cos, sin, sides, around, lidar.range_min, lidar.range_max, out)
        return out

    return cast


def geos_caster(world: World, lidar: Lidar) -> Cast:
    """Return a caster by shapely's tree, intersection and distance."""
    import shapely

    circles = [s for s in world.shapes if isinstance(s, Circle)]
    centers = np.array([c.center for c in circles]).reshape(-1, 2)
    discs = shapely.buffer(shapely.points(centers), [c.radius for c in circles], quad_segs=QUADRANT)
    areas = [*discs, *(s.to_shapely() for s in world.shapes if isinstance(s, Polygon))]
    outlines = shapely.get_exterior_ring(areas)
    tree = shapely.STRtree(outlines)

    def cast(poses: Floats) -> Floats:
        bearing = poses[:, 2:] + lidar.angles
        away = lidar.range_max * np.stack([np.cos(bearing), np.sin(bearing)], axis=-1)
        start = np.broadcast_to(poses[:, None, :2], away.shape)
        beams = shapely.linestrings(np.stack([start, start + away], axis=2).reshape(-1, 2, 2))
        beam, outline = tree.query(beams, predicate="intersects")
        from_here = shapely.points(start.reshape(-1, 2)[beam])
        distance = shapely.distance(from_here, shapely.intersection(beams[beam], outlines[outline]))
        ranges = np.full(len(beams), np.inf)
        np.minimum.at(ranges, beam, distance)
        ranges[ranges < lidar.range_min] = np.inf
        return ranges.reshape(away.shape[:2])

    return cast
