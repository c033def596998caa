"""Scripted: drives that nobody drove; from shape to shape and around each, as unevenly as by hand.

In:  a ``World`` that the driver looks at from above, as somebody beside the board does, and a seed.
Out: a ``Route``: where the robot starts, and the speeds of its wheels.

>>> from primkit.shapes import Circle
>>> world = World([Circle((0.2, 0.1), 0.06)])
>>> route = scripted_route(world, rng=0)
>>> poses = route.poses(world)
>>> bool(world.shapes[0].signed_distance(poses[:, :2]).min() > 0.037), bool(len(poses) > 60)
(True, True)

The driver takes the nearest shape that is left, goes around it at a distance that sways, sometimes leaves a part of it
out, and does not get to where the robot has no room. Five times a second it sets the wheels for a place a little ahead
on the way, with an error that lasts. It knows neither scans nor map: whether everything was seen, it cannot tell.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from zlib import crc32

import numpy as np
from numpy.typing import NDArray

from ..arguments import Floats, as_count, as_rng, check_type
from ..formats import Route, paper_suite, scripted_drives
from ..robot import AXLE, FASTEST, PERIOD, WHEEL, advance, clearance, moved, start_pose
from ..shapes import Shape
from ..world import World
from .ways import tighten, trace

# The plan.
RING_DISTANCE = (0.09, 0.13)  # m from an outline to the robot's middle; the LiDAR measures from 0.05 to 0.3 m
RING_SWAY = 0.015  # m: how far the distance sways either way
RING_PLACES = 60  # around a shape
LEFT_OUT_RATE = 0.4  # of the shapes: a part is left out
LEFT_OUT_SHARE = (0.3, 0.9)  # of the way around the shape: how large that part is
LONGEST_RAY = 0.6  # m from a shape's centre: places of the ring are searched along rays
WAY_CLEARANCE = 0.012  # m from the body to everything, along the planned way
WAY_GRID = 0.01  # m between the places that a way between two shapes may lead over
WAY_STEP = 0.005  # m between the places of a way or a ray that are looked at
# The steering.
WHEEL_SPEED = (4.8, 5.8)  # rad/s, of both wheels, straight on
LOOK_AHEAD = 0.05  # m along the way, to the place that is steered for
TURN_GAIN = 3.0  # 1/s: turn for each radian off
PERIODS_HELD = 2  # from one look to the next
STEERING_STD = 0.25  # rad
STEERING_MEMORY = 0.8  # share of the steering's error that is left at the next look
LEAST_CLEARANCE = 0.005  # m: nearer to anything the robot turns on the spot
MOST_PERIODS = 20_000  # half an hour: a drive that is not over by then never is


def scripted_route(world: World, *, rng: int | np.random.Generator | None = None) -> Route:
    """Return a drive around all shapes as a script steers it, from the free place nearest to the board's centre.

    Speeds are in steps of 0.01 rad/s; the robot touches nothing. Raises ValueError if it has no room on the board.

    Where there is nothing to see, it stays where it is:

    >>> len(scripted_route(World(), rng=0))
    0
    """
    check_type(world, World, "world must be a World")
    generator = as_rng(rng)
    scale, small = world.scale, world.scaled(1 / world.scale)
    start = start_pose(small)
    wheels = _steer(small, start, tour(small, start[:2], generator), generator)
    return Route(start * (scale, scale, 1.0), wheels)


def drives_on(worlds: Mapping[str, World], *, seed: int = 0) -> dict[str, Floats]:
    """Return the poses of a scripted drive on each map, by name, for ``run_study(worlds, drives=...)``.

    Maps of the suite have their bundled drives. The seed is that of all other drives; none depends on the others.

    >>> {name: poses.shape for name, poses in drives_on({"empty": World()}).items()}
    {'empty': (1, 3)}
    """
    suite, bundled, seed = paper_suite(), scripted_drives(), as_count(seed, "seed", least=0)
    poses = {}
    for name, world in worlds.items():
        rng = np.random.default_rng([seed, crc32(name.encode())])
        route = bundled[name] if suite.get(name) == world else scripted_route(world, rng=rng)
        poses[name] = route.poses(world)
    return poses


# --- the plan -----------------------------------------------------------------------------------------------


def tour(world: World, start: Floats, rng: np.random.Generator) -> Floats:
    """Return the places that lead around one shape after the other, the nearest first, shape (N, 2)."""
    board = _Board.of(world)
    rings = [_ring(world, shape, rng) for shape in world.shapes]
    way = [start]
    while rings:
        gaps = [np.nan_to_num(np.hypot(*(ring - way[-1]).T), nan=np.inf) for ring in rings]
        nearest = int(np.argmin([gap.min() for gap in gaps]))
        for place in _order_ring(rings.pop(nearest), gaps[nearest], rng):
            way += board.way(way[-1], place)
    return _subdivide(np.array(way), WAY_STEP)


def _ring(world: World, shape: Shape, rng: np.random.Generator) -> Floats:
    """Return places around a shape, shape (RING_PLACES, 2); NaN where there is no room, or a part is left out."""
    turns = np.linspace(0, 2 * np.pi, RING_PLACES, endpoint=False)
    phases, waves = rng.uniform(0, 2 * np.pi, 2), np.array([2, 3])
    sway = np.sin(np.outer(turns, waves) + phases).mean(axis=1)
    wanted = rng.uniform(*RING_DISTANCE) + RING_SWAY * sway
    reach = np.arange(0, LONGEST_RAY, WAY_STEP)
    rays = shape.centroid + reach[:, None] * np.column_stack([np.cos(turns), np.sin(turns)])[:, None]  # (K, R, 2)
    away = shape.signed_distance(rays.reshape(-1, 2)).reshape(rays.shape[:2])
    free = clearance(world, rays.reshape(-1, 2)).reshape(away.shape) >= WAY_CLEARANCE
    suits = free & (away <= wanted[:, None])
    outermost = len(reach) - 1 - suits[:, ::-1].argmax(axis=1)
    ring: Floats = np.where(suits.any(axis=1)[:, None], rays[np.arange(RING_PLACES), outermost], np.nan)
    if rng.random() < LEFT_OUT_RATE:
        first, part = rng.integers(RING_PLACES), rng.uniform(*LEFT_OUT_SHARE)
        ring[(first + np.arange(int(part * RING_PLACES))) % RING_PLACES] = np.nan
    return ring


def _order_ring(ring: Floats, gaps: Floats, rng: np.random.Generator) -> Floats:
    """Return the places of a ring in the order of driving, shape (N, 2).

    All around from the nearest one, one way or the other; where a part is missing, from the nearer end to the other.
    """
    here = np.isfinite(gaps)
    if not here.any():
        return np.empty((0, 2))
    if here.all():
        first = int(np.argmin(gaps))
        order = (first + np.arange(len(ring) + 1)) % len(ring)
        return ring[order if rng.random() < 0.5 else order[::-1]]
    first = _after_longest_gap(here)
    order = (first + np.arange(len(ring))) % len(ring)
    order = order[here[order]]
    return ring[order if gaps[order[0]] <= gaps[order[-1]] else order[::-1]]


def _after_longest_gap(here: NDArray[np.bool_]) -> int:
    """Return the first place behind the longest run of missing ones.

    >>> _after_longest_gap(np.array([True, False, True, False, False, True]))
    5
    """
    present = np.flatnonzero(here)
    return int(present[np.diff(present, prepend=present[-1] - len(here)).argmax()])


@dataclass(frozen=True, eq=False)
class _Board:
    """The free places of a board on a grid, and how far it is from each to its neighbours."""

    world: World
    places: Floats  # (N, 2)
    steps: object  # (N, N), sparse

    @classmethod
    def of(cls, world: World) -> _Board:
        from scipy.sparse import coo_array
        from scipy.spatial import cKDTree

        half = np.floor(world.size / 2 / WAY_GRID)
        lines = np.arange(-half, half + 1) * WAY_GRID
        places = np.stack(np.meshgrid(lines, lines, indexing="ij"), axis=-1).reshape(-1, 2)
        places = places[clearance(world, places) >= WAY_CLEARANCE]
        pairs = cKDTree(places).query_pairs(1.5 * WAY_GRID, output_type="ndarray")
        lengths = np.hypot(*(places[pairs[:, 0]] - places[pairs[:, 1]]).T)
        steps = coo_array((lengths, pairs.T.astype(np.int32)), shape=(len(places), len(places))).tocsr()
        return cls(world, places, steps)

    def way(self, start: Floats, end: Floats) -> list[Floats]:
        """Return the places after the start that lead to the end; none where no way leads there."""
        from scipy.sparse.csgraph import dijkstra

        if self.sees(start, end):
            return [end]
        first, last = (int(np.hypot(*(self.places - place).T).argmin()) for place in (start, end))
        _, before = dijkstra(self.steps, directed=False, indices=first, return_predecessors=True)
        nodes = trace(before, last)
        return list(tighten(np.array([start, *self.places[nodes], end]), self.sees)) if nodes[0] == first else []

    def sees(self, start: Floats, end: Floats) -> bool:
        """Tell whether the straight way between two places is free."""
        places = _subdivide(np.array([start, end]), WAY_STEP)
        return bool((clearance(self.world, places) >= WAY_CLEARANCE - WAY_STEP / 2).all())


def _subdivide(way: Floats, step: float) -> Floats:
    """Return places along a way, at most a step apart, its own ones among them, shape (N, 2)."""
    parts = [
        a + (b - a) * np.linspace(0, 1, 1 + int(np.ceil(np.hypot(*(b - a)) / step)))[1:, None] for a, b in pairwise(way)
    ]
    return np.vstack([way[:1], *parts])


# --- the steering -------------------------------------------------------------------------------------------


def _steer(world: World, start: Floats, way: Floats, rng: np.random.Generator) -> Floats:
    """Return the wheel speeds that bring the robot along a way, shape (T, 2)."""
    pose, here, slip = start, 0, 0.0
    wheels: list[tuple[float, float]] = []
    ahead = round(LOOK_AHEAD / WAY_STEP)
    speed = WHEEL * rng.uniform(*WHEEL_SPEED)
    while here < len(way) - 1 and len(wheels) < MOST_PERIODS:
        here = progress(way, here, pose, ahead)
        aim = way[min(here + ahead, len(way) - 1)]
        slip = STEERING_MEMORY * slip + np.sqrt(1 - STEERING_MEMORY**2) * rng.normal(0, STEERING_STD)
        held = _choose_wheels(world, pose, aim, speed, slip)
        for _ in range(PERIODS_HELD):
            pose, _ = advance(world, pose, held, PERIOD)
            wheels.append(held)
    return np.array(wheels).reshape(-1, 2)


def progress(way: Floats, here: int, pose: Floats, ahead: int) -> int:
    """Return which place of the way the robot is at; it looks a little ahead only, so that no loop is cut short."""
    window = way[here : here + ahead + 1]
    return here + int(np.hypot(*(window - pose[:2]).T).argmin())


def _choose_wheels(world: World, pose: Floats, aim: Floats, speed: float, slip: float) -> tuple[float, float]:
    """Return the wheel speeds towards a place: slower the more it must turn, on the spot where it would touch."""
    x, y, heading = pose
    off = float(np.arctan2(aim[1] - y, aim[0] - x) - heading + slip)
    off = (off + np.pi) % (2 * np.pi) - np.pi
    room = min(LEAST_CLEARANCE, float(clearance(world, pose[None, :2])[0]))
    for share in (1.0, 0.5, 0.25):
        wheels = _wheels(share * speed * max(0.0, np.cos(off)), TURN_GAIN * off)
        there = moved(pose, wheels, PERIODS_HELD * PERIOD * np.array([0.5, 1.0]))
        if clearance(world, there[:, :2]).min() >= room:
            return wheels
    return _wheels(0.0, TURN_GAIN * off)


def _wheels(speed: float, turn: float) -> tuple[float, float]:
    """Return the wheel speeds for a speed [m/s] and a turn [rad/s], rad/s, as far as the motors can."""
    half = turn * AXLE / 2
    left, right = (speed - half) / WHEEL, (speed + half) / WHEEL
    most = max(1.0, abs(left) / FASTEST, abs(right) / FASTEST)
    return round(left / most, 2), round(right / most, 2)
