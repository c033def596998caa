"""Rendered: a LiDAR as a simulator draws it, with a camera's pictures in the place of rays.

Webots, the paper's simulator, renders a LiDAR: four cameras look along the quarter turns, and a beam reads the depth of
the nearest texel of their pictures, though it passes beside the middle of it. The same, with exact geometry:

    beam i at the bearing a, its camera along b    a = (i + 1/2) 6.28 / beams - 6.28 / 2, b the nearest quarter turn
    its texel, of n = ceil(2 / tan(6.28 / beams))  k = floor(n (1 - tan(a - b)) / 2)
    bearing of the texel's middle                  m = b + arctan(1 - 2 (k + 1/2) / n)
    depth there, and the range that is read        z = t cos(m - b), r = z / cos(a - b)

t is the way along m to the nearest side that faces the robot: back faces are not drawn, so that from inside a shape
the others are seen. A circle is drawn as a cylinder with 36 faces. Neither z nor r is told below the sensor's least
range, nor from its greatest on. The error, of millimetres, is always the same, and neighbours err alike. ``ROBUST``
finds in the residuals only what a scan's points share: from a grid, 95 % intervals hold 95 % of the centres, and 89 %
of the dimensions; from points alone, whose deviations are wider, more than 99 %.

In:  a ``World``; poses, shape (P, 3): x [m], y [m], heading [rad]; the beams' bearings, shape (B,); limits in metres.
Out: ranges, shape (P, B), metres; ``inf`` where there is none.

>>> from primkit.shapes import Circle
>>> board, here = World([Circle((0.2, 0.0), 0.05)]), np.zeros((1, 3))
>>> ranges, _ = render(board, here, rendered_bearings(100), 0.3, 0.05)
>>> ranges[0, 50:54].round(4).tolist()  # exact: 0.1503, 0.1528, 0.1585, 0.1707
[0.1505, 0.1529, 0.1584, 0.1699]

Source: the sources of Webots (cyberbotics/webots), though not of the very release; the paper's Figure 3 agrees to 3 mm.
"""

from __future__ import annotations

import numpy as np

from .arguments import Bools, Floats
from .robot import inside_shape
from .shapes import Circle
from .world import World

FIELD = 6.28  # rad: the published field of view, a little less than a full turn
QUARTER_TURN = np.pi / 2  # rad, from camera to camera
FACES = 36  # of a cylinder
LEAST_BEAMS = 8  # fewer would leave a camera without a texel
ON_SIDE = 1e-9  # a ray so close to a corner, in lengths of the side, meets one of its two sides


def rendered_bearings(beams: int) -> Floats:
    """Return the bearing of each beam from the heading, shape (B,), radians, increasing.

    >>> rendered_bearings(100)[[0, 49, 50, 99]].round(4).tolist()
    [-3.1086, -0.0314, 0.0314, 3.1086]
    """
    bearings: Floats = (np.arange(beams, dtype=float) + 0.5) * (FIELD / beams) - FIELD / 2
    return bearings


def render(world: World, poses: Floats, angles: Floats, range_max: float, range_min: float) -> tuple[Floats, Bools]:
    """Return what a rendered LiDAR reads, shape (P, B), metres, and which poses lie in a shape, shape (P,)."""
    camera = np.rint(angles / QUARTER_TURN)
    off = angles - camera * QUARTER_TURN  # a - b
    n = int(np.ceil(2 / np.tan(FIELD / len(angles))))
    texel = np.clip(np.floor(n * (1 - np.tan(off)) / 2), 0, n - 1)
    middle = np.arctan(1 - 2 * (texel + 0.5) / n)  # m - b
    starts, ways = _sides(world)
    ranges = np.empty((len(poses), len(angles)))
    for row, (x, y, heading) in enumerate(poses):
        turned = heading + camera * QUARTER_TURN + middle
        rays = np.column_stack([np.cos(turned), np.sin(turned)])
        depth = _within(_first_front(starts - (x, y), ways, rays) * np.cos(middle), range_min, range_max)
        ranges[row] = _within(depth / np.cos(off), range_min, range_max)
    return ranges, inside_shape(world, poses)


def _sides(world: World) -> tuple[Floats, Floats]:
    """Return where the sides that are drawn begin, and the ways to their ends, shape (K, 2) each, metres."""
    rings = [shape.outline(FACES) if isinstance(shape, Circle) else shape.vertices for shape in world.shapes]
    ways = [np.concatenate([ring[1:], ring[:1]]) - ring for ring in rings]
    walls = world.walls[:, ::-1]  # they face inwards
    return np.vstack([*rings, walls[:, 0]]), np.vstack([*ways, walls[:, 1] - walls[:, 0]])


def _first_front(starts: Floats, ways: Floats, rays: Floats) -> Floats:
    """Return how far it is along unit rays from the origin to the first side that faces it, shape (B,), metres."""
    side = _cross(starts, ways)  # s x w, below zero where the origin lies to the right of a side: outside
    facing: Bools = side < 0
    starts, ways, side = starts[facing], ways[facing], side[facing]
    # The point t r of the ray is the point s + u w of the side: t = (s x w) / (r x w), u = (s x r) / (r x w).
    turn = _cross(rays[:, None], ways)
    with np.errstate(divide="ignore", invalid="ignore"):
        t, u = side / turn, _cross(starts, rays[:, None]) / turn
    hit = (turn < 0) & (u >= -ON_SIDE) & (u <= 1 + ON_SIDE)
    return np.where(hit, t, np.inf).min(axis=1, initial=np.inf)


def _cross(a: Floats, b: Floats) -> Floats:
    product: Floats = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    return product


def _within(distance: Floats, low: float, high: float) -> Floats:
    return np.where((distance >= low) & (distance < high), distance, np.inf)
