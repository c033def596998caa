"""Driving: scan, add to the grid, find the shapes, ten times a second, while the map grows.

In:  an ``Effort`` and a seed.
Out: a ``Result``: what a step takes when the grid holds about 2,000 points, part by part.

The robot goes up and down lanes at its full speed and scans all the way; where a lane meets a shape it goes on behind
it. Only steps with 1,800 to 2,200 points in the grid are timed: on a map that does not fill so far, the last ones.
"""

from __future__ import annotations

from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from primkit.driving.mapper import Mapper
from primkit.grid import Grid
from primkit.lidar import Lidar, Scans, scan
from primkit.pipeline import find_shapes
from primkit.world import World

from .clock import Spread, no_collection, seconds
from .effort import Effort
from .results import Result, Row
from .scanning import four_shape_maps

Floats = NDArray[np.float64]

SPEED = 0.0205 * 6.28  # m/s: the e-puck's wheel radius times its fastest turn
LANES = 0.10  # m from lane to lane
BODY = 0.037  # m: the e-puck's radius
FEWEST, MOST = 1800, 2200  # points in the grid
NOISES = (0.0, 0.002)  # m
PARTS = ("scan", "grid.add", "find_shapes", "Mapper.found")
STEP = "a whole step"
LIVE = "a whole step with a Mapper"


def drive(world: World, lidar: Lidar) -> Floats:
    """Return the poses of a drive along lanes, one for each scan, shape (P, 3).

    >>> drive(World(), Lidar())[:2].round(3).tolist()
    [[-0.45, -0.5, 1.571], [-0.45, -0.487, 1.571]]
    """
    half, step = world.size / 2, SPEED * lidar.period
    along = np.arange(-half, half + step / 2, step)
    lanes = np.arange(-half + LANES / 2, half, LANES)
    upwards = np.arange(len(lanes)) % 2 == 0
    poses = np.vstack(
        [
            np.column_stack([np.full(len(along), x), along if up else along[::-1], np.full(len(along), np.pi / 2)])
            for x, up in zip(lanes, upwards, strict=True)
        ]
    )
    poses[np.repeat(~upwards, len(along)), 2] *= -1
    clear = np.min([np.full(len(poses), np.inf), *(s.signed_distance(poses[:, :2]) for s in world.shapes)], axis=0)
    return poses[clear > BODY]


def bench_live(effort: Effort, seed: int) -> Result:
    """Time the steps of drives over the suite's 4-shape maps."""
    rows: list[Row] = []
    for noise in NOISES:
        lidar = Lidar(noise_std=noise)
        steps = [_timed(world, lidar, effort.steps, seed) for world in four_shape_maps(effort.maps).values()]
        points = np.concatenate([n for n, _ in steps])
        parts = 1000 * np.vstack([taken for _, taken in steps])  # ms
        case = f"range noise {1000 * noise:g} mm, {points.min():,} to {points.max():,} points, {len(points)} steps"
        whole = parts[:, 0] + parts[:, 1]
        named = dict(zip(PARTS, parts.T, strict=True))
        for part, taken in (named | {STEP: whole + parts[:, 2], LIVE: whole + parts[:, 3]}).items():
            facts = {"p95": float(np.percentile(taken, 95))}
            ratio = Spread.of([(whole + parts[:, 2]).sum() / taken.sum()]) if part == LIVE else None
            rows.append(Row(case, part, Spread.of(taken), ratio, facts=facts))
    return Result(
        "live",
        f"While driving: a step every {1000 * Lidar().period:g} ms",
        "ms",
        "times as fast as with find_shapes",
        tuple(rows),
        (
            f"Medians (p50) over the steps, with the least and the greatest; p95 is the 95th percentile. {len(steps)} "
            "maps.",
            "A Mapper measures only the groups that the scan has changed; both find the same.",
        ),
    )


def _timed(world: World, lidar: Lidar, most: int, seed: int) -> tuple[NDArray[np.int64], Floats]:
    """Return the points in the grid and the seconds of each part at the timed steps, shapes (N,) and (N, 4)."""
    poses = drive(world, lidar)
    before = scan(world, poses, lidar, rng=seed)
    first, last = _steps_to_time(before, most)
    mapper, noise = Mapper(rng=seed), np.random.default_rng(seed)
    mapper.add(before[:first])
    mapper.look(mapper.grid)
    counts: list[int] = []
    rows: list[tuple[float, ...]] = []
    with no_collection():
        for step in range(first, last):
            begun = perf_counter()
            scans = scan(world, poses[step], lidar, rng=noise)
            scanned = perf_counter()
            mapper.add(scans)
            added = perf_counter()
            rows.append((scanned - begun, added - scanned, *_find_both(mapper, seed, swap=step % 2 == 1)))
            counts.append(len(mapper.grid))
    return np.array(counts), np.array(rows)


def _steps_to_time(scans: Scans, most: int) -> tuple[int, int]:
    """Return the first step to be timed, and the one after the last: at most so many."""
    cells, step = Grid().to_cells(scans.points()), np.nonzero(scans.hits)[0]
    seen_first = step[np.unique(cells, axis=0, return_index=True)[1]]
    counts = np.cumsum(np.bincount(seen_first, minlength=len(scans)))  # points in the grid after each step
    first, end = int(np.searchsorted(counts, FEWEST)), int(np.searchsorted(counts, MOST, side="right"))
    last = min(end, first + most)
    return (first, last) if last > first else (max(0, len(scans) - most), len(scans))


def _find_both(mapper: Mapper, seed: int, *, swap: bool) -> tuple[float, float]:
    """Return the seconds of find_shapes and of the mapper; one goes first in one step, the other in the next."""

    def afresh() -> object:
        return find_shapes(mapper.grid.points(), rng=seed)

    def by_mapper() -> object:
        return mapper.found

    if swap:
        taken = seconds(by_mapper)
        return seconds(afresh), taken
    return seconds(afresh), seconds(by_mapper)
