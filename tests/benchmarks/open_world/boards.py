"""Boards: what is drawn for a line, and the cells that are seen of it.

>>> world, thing, usual = beside(pk.Polygon([(0, 0), (0.1, 0), (0.05, 0.05)]), np.random.default_rng(0))
>>> len(world.shapes), world.least_gap() >= GAP
(2, True)
>>> len(seen_on(world)) > 100
True
"""

from __future__ import annotations

import numpy as np

import primkit as pk
from primkit.random_shapes import free_shape
from primkit.shapes import PRIMITIVES, Polygon, Shape
from primkit.world import EDGE_MARGIN, gap_between

Floats = np.ndarray
Rng = np.random.Generator
OPEN_WORLD = 16_180_339  # every draw starts from it and the seed: nothing in primkit is tuned on them
GAP = 0.05  # m between things that are not meant to be near
LIMIT = 0.5 - EDGE_MARGIN  # m: so far from the middle an outline may reach


def rng_of(seed: int, number: int) -> Rng:
    """Return the generator of one board."""
    return np.random.default_rng([OPEN_WORLD, seed, number])


def seen_on(
    world: pk.World, rng: int | Rng = 0, *, poses: Floats | None = None, resolution: float = 0.001, **lidar: float
) -> pk.Grid:
    """Return the cells that the scans from the way-points occupy, or from these poses."""
    grid = pk.Grid(resolution)
    grid.add(pk.scan(world, pk.teleport_poses(world) if poses is None else poses, pk.Lidar(**lidar), rng=rng))
    return grid


def extent(shape: Shape) -> float:
    """Return how far from the middle of the board a shape reaches along x or y."""
    return float(np.abs(shape.outline(400)).max())


def placed(shape: Shape, rng: Rng) -> Shape:
    """Return the shape anywhere on the board where way-points lie on every side of it."""
    while True:
        there = shape.moved(rng.uniform(-LIMIT, LIMIT, 2) - shape.centroid)
        if extent(there) <= LIMIT:
            return there


def usual_shape(rng: Rng) -> Shape:
    """Return one of the four kinds, of any proportions and turn."""
    return free_shape(PRIMITIVES[rng.integers(len(PRIMITIVES))], np.zeros(2), rng)


def beside(thing: Shape, rng: Rng) -> tuple[pk.World, Shape, Shape]:
    """Return a board with this thing and one of the four kinds, and both of them."""
    while True:
        there, usual = placed(thing, rng), placed(usual_shape(rng), rng)
        if gap_between(there, usual) >= GAP:
            return pk.World([there, usual]), there, usual


# --- two that stand close ------------------------------------------------------------------------------------------


def two_flush(gap: float, rng: Rng) -> pk.World:
    """Return two polygons with a side each that run beside each other, so far apart, over half of the shorter or more.

    Both are convex: nothing else of them comes as near.
    """
    while True:
        one, other = (free_shape(kind, np.zeros(2), rng) for kind in rng.choice(PRIMITIVES[1:], 2))
        i, j = (int(rng.integers(len(shape.vertices))) for shape in (one, other))
        outwards = one.normals[i]
        turn = np.arctan2(*-outwards[::-1]) - np.arctan2(*other.normals[j][::-1])
        other = other.moved(angle=turn)
        along = one.edges[i] / one.sides[i]
        slip = rng.uniform(-0.5, 0.5) * max(one.sides[i], other.sides[j])
        middle, facing = one.vertices[i] + one.edges[i] / 2, other.vertices[j] + other.edges[j] / 2
        other = other.moved(middle + slip * along + gap * outwards - facing)
        if (world := _both_placed(one, other, rng)) is not None:
            return world


def two_turned(gap: float, rng: Rng) -> pk.World:
    """Return two of the four kinds at any turn, so far apart."""
    while True:
        one, other = usual_shape(rng), usual_shape(rng)
        bearing = rng.uniform(0, 2 * np.pi)
        way = np.array([np.cos(bearing), np.sin(bearing)])
        low, high = 0.0, 1.0  # m from middle to middle
        for _ in range(50):  # bisection
            half = (low + high) / 2
            low, high = (low, half) if gap_between(one, other.moved(half * way)) >= gap else (half, high)
        if (world := _both_placed(one, other.moved(high * way), rng)) is not None:
            return world


def _both_placed(one: Shape, other: Shape, rng: Rng) -> pk.World | None:
    """Return two shapes together anywhere on the board; None where they are too large for it."""
    outlines = np.vstack([shape.outline(400) for shape in (one, other)])
    room = LIMIT - np.ptp(outlines, axis=0) / 2
    if room.min() < 0:
        return None
    shift = rng.uniform(-room, room) - (outlines.min(axis=0) + outlines.max(axis=0)) / 2
    return pk.World([shape.moved(shift) for shape in (one, other)])


# --- rooms ---------------------------------------------------------------------------------------------------------

ROOM = 8.0  # m
ROOM_CELL, ROOM_NOISE = 0.01, 0.01  # m
ROOM_LIDAR = {"beams": 360, "range_min": 0.1, "range_max": 12.0, "noise_std": ROOM_NOISE}
FREE = 0.6  # m between pillars, walls and places to stand


def room(rng: Rng) -> tuple[pk.World, list[Shape], Floats, Floats]:
    """Return an L-shaped room with three pillars: the board, the pillars, the corners of the L, the robot's poses.

    The board's walls are the room's, but for one corner that a block fills.
    """
    half, (x, y) = ROOM / 2, rng.uniform(-1, 1, 2)
    block = Polygon([(x, y), (half, y), (half, half), (x, half)])
    corners = np.array([(-half, -half), (half, -half), (half, y), (x, y), (x, half), (-half, half)])
    inside, pillars = Polygon(corners), list[Shape]()
    while len(pillars) < 3:
        pillar = _pillar(rng)
        clear = -inside.signed_distance(pillar.outline(100)).max()
        if clear >= FREE and all(gap_between(pillar, other) >= FREE for other in pillars):
            pillars.append(pillar)
    places = np.stack(np.meshgrid(*2 * [np.arange(-half + 0.5, half)]), axis=-1).reshape(-1, 2)
    free = -inside.signed_distance(places) >= FREE / 2
    for pillar in pillars:
        free &= pillar.signed_distance(places) >= FREE / 2
    poses = np.column_stack([places[free], rng.uniform(-np.pi, np.pi, free.sum())])
    return pk.World([block, *pillars], ROOM, walls=True), pillars, corners, poses


def _pillar(rng: Rng) -> Shape:
    center = rng.uniform(-ROOM / 2, ROOM / 2, 2)
    if rng.random() < 0.5:
        return pk.Circle(center, rng.uniform(0.2, 0.4))
    width, height = rng.uniform(0.4, 0.9, 2) / 2
    box = Polygon([(-width, -height), (width, -height), (width, height), (-width, height)])
    return box.moved(center, rng.uniform(0, np.pi))
