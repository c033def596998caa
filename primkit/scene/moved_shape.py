"""Moved shape: somebody puts a shape down somewhere else while the robot drives.

In:  a ``World``, and where the robot is.
Out: another ``World``, in which one shape stands elsewhere; or None where there is no room for that.

>>> from primkit.shapes import Circle
>>> before = World([Circle((0.2, 0.0), 0.05)])
>>> after = move_one_shape(before, np.zeros(3), np.random.default_rng(0))
>>> way = after.shapes[0].centroid - before.shapes[0].centroid
>>> bool(LEAST_MOVED <= np.hypot(*way) <= MOST_MOVED)
True
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from ..arguments import Bools, Floats
from ..driving.moving_grid import MovingGrid
from ..measure import CELL, Detection
from ..robot import CLEAR, clearance
from ..seen import share_seen
from ..shapes import Shape
from ..world import World, gap_between

LEAST_MOVED, MOST_MOVED = 0.08, 0.2  # m: how far a shape is moved
MOST_TURNED = 0.5  # rad: by how much it is turned at most, either way
SHAPE_GAP = 0.08  # m between shapes: the body is 7.4 cm wide
EDGE_GAP = 0.1  # m from the edge of the board: the sensor sees round a shape only from the board
MOVE_TRIES = 500
WITHIN_DEPTH = 0.012  # m: a cell so deep within a shape is not of its outline
MOSTLY_SEEN = 0.6  # of an outline: from this share on, it tells what lies within


def move_one_shape(world: World, pose: Floats, rng: np.random.Generator) -> World | None:
    """Return a board on which one shape stands 8 to 20 cm elsewhere, and turned; None where there is no room.

    Parameters
    ----------
    world : World
        The board before.
    pose : array, shape (3,)
        Where the robot is: nothing is put down on it, or so near that it would be stuck.
    rng : numpy.random.Generator
        Chooses the shape and its place.
    """
    if not world.shapes:
        return None
    small = world.scaled(1 / world.scale)
    for _ in range(MOVE_TRIES):
        chosen, bearing = int(rng.integers(len(world.shapes))), rng.uniform(0, 2 * np.pi)
        way = rng.uniform(LEAST_MOVED, MOST_MOVED) * np.array([np.cos(bearing), np.sin(bearing)])
        new = small.shapes[chosen].moved(way, rng.uniform(-MOST_TURNED, MOST_TURNED))
        rest = [shape for number, shape in enumerate(small.shapes) if number != chosen]
        if _has_room(new, rest, small.size, pose[:2] / world.scale):
            shapes = list(world.shapes)
            shapes[chosen] = new.scaled(world.scale)
            return World(shapes, size=world.size, walls=world.walled)
    return None


def _has_room(shape: Shape, rest: list[Shape], size: float, robot: Floats) -> bool:
    """Tell whether a shape keeps its distance to the others, to the edge, and to the robot."""
    if np.abs(shape.outline(100)).max() > size / 2 - EDGE_GAP:
        return False
    if any(gap_between(shape, one) < SHAPE_GAP for one in rest):
        return False
    return float(clearance(World([shape], size=size), robot[None])[0]) > 10 * CLEAR


def find_left_within(grid: MovingGrid, found: Iterable[Detection]) -> Bools:
    """Tell which cells of a map lie within a shape found later, shape (N,): no beam will ever contradict them.

    Only shapes of which ``MOSTLY_SEEN`` was seen count.
    """
    points, last, depth = grid.points(), grid.last_seen, WITHIN_DEPTH / CELL * grid.resolution
    left = np.zeros(len(points), dtype=bool)
    for one in found:
        apart = one.shape.signed_distance(points)
        own = np.abs(apart) <= depth
        if own.any() and share_seen(one.shape, one.points, grid.resolution) >= MOSTLY_SEEN:
            left |= (apart < -depth) & (last < np.median(last[own]))
    return left
