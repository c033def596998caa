"""Crowded: shapes that nearly touch, walls around them, rooms, strays, and planks."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

import primkit as pk
from primkit.measure import Wall
from primkit.shapes import Polygon
from primkit.study.oracle import oracle_fit, told_points

from .boards import ROOM_CELL, ROOM_LIDAR, placed, rng_of, room, seen_on, two_flush, two_turned
from .figures import Figure, mean, number, share, share_of_things
from .judging import FEW, agrees, n_right, sure_and_wrong

Floats = np.ndarray

# --- gaps --------------------------------------------------------------------------------------------------------

GAPS_MM = (2, 5, 10, 15, 20)
NEAR = {"flush": two_flush, "turned": two_turned}
BOTH_RIGHT = {(5, "flush"): 0.6, (5, "turned"): 0.9, **{(mm, how): 0.9 for mm in (10, 15, 20) for how in NEAR}}


def gaps(n: int, seed: int) -> Iterator[Figure]:
    """Two shapes 2 to 20 mm apart, half of them with parallel sides that face each other."""
    wrong: dict[str, bool] = {}
    right: dict[tuple[int, str], dict[str, bool]] = {(mm, how): {} for mm in GAPS_MM for how in NEAR}
    told: dict[tuple[int, str], dict[str, bool]] = {cell: {} for cell in right}
    for k in range(n):
        (mm, how), rng = list(right)[k % len(right)], rng_of(seed, k)
        world = NEAR[how](mm / 1000, rng)
        scans = pk.scan(world, pk.teleport_poses(world), rng=rng)
        points, owners = told_points(world, scans, pk.Lidar())
        found = pk.find_shapes(points, rng=0)
        right[mm, how][f"{k}"] = len(found) == 2 and n_right(found, world) == 2
        fits = [fit for fit in oracle_fit(world, points, owners) if fit is not None]
        told[mm, how][f"{k}"] = n_right(fits, world) == 2
        wrong[f"{k} ({mm} mm {how})"] = bool(sure_and_wrong(found, world.shapes))
    yield share("two shapes: boards with something certain and wrong", wrong, at_most=FEW)
    for (mm, how), both in right.items():
        yield share(f"both right, {mm} mm apart, {how}", both, at_least=BOTH_RIGHT.get((mm, how)))
        yield share("    by the fit that is told each point's side", told[mm, how])


# --- walls -------------------------------------------------------------------------------------------------------

ON_WALL, PARALLEL, AT_END = 0.002, np.radians(0.2), 0.005  # m, rad, m
IN_ROOM = 0.02  # m


def walls(n: int, seed: int) -> Iterator[Figure]:
    """Walls around the board; and L-shaped rooms of eight metres, three for every twenty boards."""
    for noise in (0.0, 0.002):
        right, phantoms, four, ends = {}, {}, {}, {}
        for k in range(n):
            rng = rng_of(seed, k)
            world = pk.random_world(1 + k % 4, style="free", walls=True, rng=rng)
            found = pk.find_shapes(seen_on(world, rng, noise_std=noise), rng=0)
            right[f"{k}"] = (n_right(found, world), len(world.shapes))
            phantoms[f"{k}"] = bool(sure_and_wrong(found, world.shapes))
            four[f"{k}"] = all(any(lies_along(wall, true) for wall in found.walls) for true in world.walls)
            ends[f"{k}"] = all(ends_true(wall, world.walls) for wall in found.walls)
        goal = (0.99, 0, 1.0) if noise == 0 else (None, None, None)
        name = f"walled boards, {1000 * noise:g} mm"
        yield share_of_things(f"{name}: shapes right", right, at_least=goal[0])
        yield share(f"{name}: something certain that is not there", phantoms, at_most=goal[1])
        yield share(f"{name}: four walls within 2 mm and 0.2 degrees", four, at_least=goal[2])
        yield share(f"{name}: each end said to be seen is a corner", ends, at_least=goal[2])
    yield from rooms(max(1, 3 * n // 20), seed)


def lies_along(wall: Wall, true: Floats) -> bool:
    """Tell whether a wall lies on a true one, at the middle of that, and beside it."""
    middle, way = true.mean(axis=0), true[1] - true[0]
    along = (wall.end - wall.start) / wall.length
    turn = abs(along[0] * way[1] - along[1] * way[0]) / np.hypot(*way)
    off = abs(along[0] * (middle - wall.start)[1] - along[1] * (middle - wall.start)[0])
    return bool(off <= ON_WALL and turn <= np.sin(PARALLEL))


def ends_true(wall: Wall, true: Floats) -> bool:
    """Tell whether each end that was seen is a corner of the board."""
    ends = zip((wall.start, wall.end), wall.ends_seen, strict=True)
    return all(np.hypot(*(true[:, 0] - end).T).min() <= AT_END for end, seen in ends if seen)


def rooms(n: int, seed: int) -> Iterator[Figure]:
    """L-shaped rooms with three pillars, turned any way, as a laser scanner of 360 beams sees them."""
    near, right, wrong, along = {}, {}, {}, {}
    for k in range(n):
        rng = rng_of(seed, 200_000 + k)
        world, pillars, corners, poses = room(rng)
        found = pk.find_shapes(seen_on(world, rng, poses=poses, resolution=ROOM_CELL, **ROOM_LIDAR), rng=0)
        truth = pk.World(pillars, world.size)
        pairs = pk.evaluate(found, truth, IN_ROOM, gate=0.3).matches
        near[f"{k}"] = (sum(np.hypot(*pair.center_error) <= IN_ROOM for pair in pairs), len(pillars))
        right[f"{k}"] = (n_right(found, truth, IN_ROOM, gate=0.3), len(pillars))
        wrong[f"{k}"] = any(one.certain and not any(near_pillar(one, p) for p in pillars) for one in found)
        sides = np.stack([corners, np.roll(corners, -1, axis=0)], axis=1)
        along[f"{k}"] = (sum(any(runs_on(wall, side) for wall in found.walls) for side in sides), len(sides))
    yield share_of_things("rooms: pillars' centres within 2 cm", near, at_least=1.0)
    yield share_of_things("    with kind and sizes within 2 cm", right)
    yield share("    something certain that is not there", wrong, at_most=0)
    yield share_of_things("rooms: walls within 2 cm from end to end", along, at_least=1.0)


def near_pillar(one: pk.Detection, pillar: pk.Circle | Polygon) -> bool:
    return one.kind == pillar.kind and bool(np.hypot(*(one.shape.centroid - pillar.centroid)) <= 5 * IN_ROOM)


def runs_on(wall: Wall, side: Floats) -> bool:
    """Tell whether both ends of a wall lie on a side of the room, and it covers more than half of it."""
    way, ends = side[1] - side[0], np.array([wall.start, wall.end])
    along = np.clip((ends - side[0]) @ way / (way @ way), 0.0, 1.0)
    off = np.hypot(*(side[0] + along[:, None] * way - ends).T)
    return bool(off.max() <= IN_ROOM and wall.length > np.hypot(*way) / 2)


# --- strays and planks -------------------------------------------------------------------------------------------

SPURIOUS = 0.2  # of all beams: two thirds of the cells are then strays


def strays(n: int, seed: int) -> Iterator[Figure]:
    """Random ranges on a fifth of all beams, on boards and on empty ones."""
    right, phantoms, wrong, sure, entries, rest = {}, {}, {}, {}, {}, {}
    for k in range(n):
        rng = rng_of(seed, k)
        world = pk.random_world(1 + k % 4, style="free", rng=rng)
        found = pk.find_shapes(seen_on(world, rng, spurious=SPURIOUS), rng=0)
        report = pk.evaluate(found, world)
        right[f"{k}"], phantoms[f"{k}"] = report.weighted_accuracy, len(report.false_alarms)
        wrong[f"{k}"] = bool(sure_and_wrong(found, world.shapes))
        nothing = pk.find_shapes(seen_on(pk.World(), rng, spurious=SPURIOUS), rng=0)
        sure[f"{k}"], entries[f"{k}"] = any(one.certain for one in nothing), len(nothing)
        rest[f"{k}"] = len(nothing.walls) + len(nothing.others)
    yield mean("20 % spurious: weighted accuracy", right, at_least=0.97)
    yield mean("20 % spurious: phantoms a board", phantoms, at_most=0.02)
    yield share("    boards with something certain and wrong", wrong, at_most=FEW)
    yield share("empty boards, 20 % spurious: a certain shape", sure, at_most=0)
    yield mean("empty boards, 20 % spurious: shapes a board", entries, at_most=0.05)
    yield mean("    walls and other things a board", rest)


def planks(n: int, seed: int) -> Iterator[Figure]:
    """Planks of 3 to 15 mm by 12 to 25 cm: a rectangle or a wall of the right length."""
    told, wrong, off = {}, {}, []
    for k in range(n):
        rng = rng_of(seed, k)
        length, thick = rng.uniform(0.12, 0.25), rng.uniform(0.003, 0.015)
        plank = Polygon([(0, 0), (length, 0), (length, thick), (0, thick)]).moved(angle=rng.uniform(0, 2 * np.pi))
        plank = placed(plank, rng)
        found = pk.find_shapes(seen_on(pk.World([plank]), rng), rng=0)
        lengths = [wall.length for wall in found.walls]
        lengths += [one.shape.dimensions[0] for one in found if one.kind == "rectangle"]
        nearest = min((abs(found_length - length) for found_length in lengths), default=np.inf)
        case = f"{k} ({1000 * thick:.0f} mm)"
        told[case], wrong[case] = nearest <= 0.005, any(one.certain and not agrees(one, plank) for one in found)
        off.append(nearest)
    yield share("planks: a rectangle or a wall, as long within 5 mm", told, at_least=0.95)
    yield share("    something certain and wrong", wrong, at_most=FEW)
    yield number("    half of them are as long within [mm]", 1000 * float(np.median(off)), n)
