"""Scanning: what a scan costs, beside other tools and on ever larger boards.

In:  an ``Effort`` and a seed.
Out: a ``Result``; for the sizes also the curves of a figure.

The work is the same for all: from poses to 100 ranges each, with the same limits, on the suite's 4-shape maps. Every
tool's ranges are compared with primkit's in the same run: "equal" is the share of beams that agree within a
nanometre. GEOS and ir-sim have polygons of 64 sides for circles, and so differ where a beam meets a circle.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from primkit.formats import paper_suite
from primkit.lidar import Lidar, scan
from primkit.robot import inside_shape
from primkit.world import World

from .casters import GEOS, Cast, Loop, geos_caster, numba_caster
from .clock import Spread, in_turns, seconds
from .effort import Effort
from .loops import LOOPS
from .machine import version_of
from .others import IRSIM, compiled, irsim_caster
from .results import Fact, Result, Row

Floats = NDArray[np.float64]
Curve = tuple[Sequence[float], Sequence[float]]  # sizes and what each costs

OURS = "primkit"
SHAPES = 4  # on each of the maps
EQUAL = 1e-9  # m
MICRO = 1e6  # microseconds in a second
# Brute force on large boards, at most so many (pose, shape) pairs in a call: about a second's work.
BRUTE_PAIRS = 400_000
# ir-sim keeps an object for each shape, a millisecond to make: with more the scene takes longer than all else.
IRSIM_MOST = 4000

AGREEMENT = "equal"
POLYGONS = "GEOS and ir-sim take polygons of 64 sides for circles: their ranges differ where a beam meets a circle."


def four_shape_maps(n: int = 10) -> dict[str, World]:
    """Return the first n of the suite's ten maps with four shapes."""
    four = {name: world for name, world in paper_suite().items() if len(world.shapes) == SHAPES}
    return dict(list(four.items())[:n])


def poses_outside(world: World, n: int, rng: np.random.Generator) -> Floats:
    """Return n random poses on the board that lie in no shape, shape (n, 3)."""
    found = np.empty((0, 3))
    while len(found) < n:
        spot = rng.uniform(-world.size / 2, world.size / 2, (n, 2))
        poses = np.column_stack([spot, rng.uniform(-np.pi, np.pi, n)])
        found = np.vstack([found, poses[~inside_shape(world, poses)]])
    return found[:n]


def primkit_caster(world: World, lidar: Lidar) -> Cast:
    """Return primkit's scan as a caster."""
    return lambda poses: scan(world, poses, lidar).ranges


def share_equal(ours: Floats, theirs: Floats) -> float:
    """Return the share of beams that agree, misses included.

    >>> share_equal(np.array([[1.0, np.inf]]), np.array([[1.0 + 1e-12, 2.0]]))
    0.5
    """
    return float(np.isclose(ours, theirs, rtol=0, atol=EQUAL).mean())


# --- beside other tools -------------------------------------------------------------------------------------


def bench_scan(effort: Effort, seed: int) -> Result:
    """Time many scans in one call, and scans one by one, beside the others."""
    rng, loops = np.random.default_rng(seed), _loops()
    together: list[dict[str, tuple[Floats, float]]] = []
    alone: list[dict[str, tuple[Floats, float]]] = []
    lidar = Lidar()
    for world in four_shape_maps(effort.maps).values():
        poses = poses_outside(world, effort.poses, rng)
        few = poses[: effort.slow_poses]
        casters = _casters(world, lidar, loops)
        work = {tool: few if tool in (IRSIM, GEOS) else poses for tool in casters}
        together.append(_per_scan(casters, work, effort.rounds))
        one_by_one = {tool: _one_by_one(casters[tool]) for tool in (OURS, IRSIM) if tool in casters}
        alone.append(_per_scan(one_by_one, dict.fromkeys(one_by_one, few), effort.rounds))
    tools = [OURS, *LOOPS, GEOS, IRSIM]
    rows = [
        *_rows(f"{effort.poses:,} poses in one call", tools, together),
        *_rows("one pose at a time", [OURS, IRSIM], alone),
    ]
    return Result(
        "scan",
        f"Scanning: 100 beams on {len(together)} maps with 4 shapes, poses outside the shapes",
        "us per scan",
        "times primkit's",
        tuple(rows),
        (
            "Medians over the maps, with the least and the greatest map; each map's figure is a median of "
            f"{effort.rounds} rounds in turns, ratios taken within each round. One thread.",
            f"{GEOS} and {IRSIM} scan the first {effort.slow_poses} of the poses. {POLYGONS}",
            f'"{AGREEMENT}": share of beams that agree with primkit\'s within 1 nm, the least of the maps.',
        ),
    )


def _loops() -> dict[str, Loop]:
    """Return the brute-force loops, compiled; none without numba."""
    return {name: compiled(name) for name in LOOPS} if version_of("numba") else {}


def _casters(world: World, lidar: Lidar, loops: Mapping[str, Loop]) -> dict[str, Cast]:
    """Return the tools that are there, ready for this world."""
    casters = {OURS: primkit_caster(world, lidar)}
    casters |= {name: numba_caster(world, lidar, loop) for name, loop in loops.items()}
    casters[GEOS] = geos_caster(world, lidar)
    if version_of(IRSIM) and len(world.shapes) <= IRSIM_MOST:
        casters[IRSIM] = irsim_caster(world, lidar)
    return casters


def _one_by_one(cast: Cast) -> Cast:
    """Return a caster that is asked for one pose at a time."""

    def cast_each(poses: Floats) -> Floats:
        return np.concatenate([cast(pose[None]) for pose in poses])

    return cast_each


def _per_scan(casters: Mapping[str, Cast], work: Mapping[str, Floats], rounds: int) -> dict[str, tuple[Floats, float]]:
    """Return for each tool the microseconds per scan in each round, and its agreement with primkit."""
    truth = casters[OURS](work[OURS])
    equal = {tool: share_equal(truth[: len(work[tool])], cast(work[tool])) for tool, cast in casters.items()}
    taken = in_turns({tool: _call(cast, work[tool]) for tool, cast in casters.items()}, rounds)
    return {tool: (MICRO * each / len(work[tool]), equal[tool]) for tool, each in taken.items()}


def _call(cast: Cast, poses: Floats) -> Callable[[], Floats]:
    return lambda: cast(poses)


def _rows(case: str, tools: Sequence[str], maps: Sequence[Mapping[str, tuple[Floats, float]]]) -> list[Row]:
    """Return a row for each tool from its times on each map."""
    rows = []
    for tool in tools:
        if tool not in maps[0]:
            rows.append(Row(case, tool))
            continue
        cost = Spread.of([np.median(on[tool][0]) for on in maps])
        ratio = Spread.of([np.median(on[tool][0] / on[OURS][0]) for on in maps])
        equal = {} if tool == OURS else {AGREEMENT: f"{min(on[tool][1] for on in maps):.4f}"}
        rows.append(Row(case, tool, cost, None if tool == OURS else ratio, facts=equal))
    return rows


# --- on larger boards ---------------------------------------------------------------------------------------


def tiled(n: int, maps: Sequence[World]) -> World:
    """Return a board with n shapes at the paper's density: the maps side by side, over and over.

    >>> from primkit.shapes import Circle
    >>> four = World([Circle((x, 0), 0.05) for x in (-0.3, -0.1, 0.1, 0.3)])
    >>> large = tiled(12, [four])
    >>> large.size, len(large.shapes)
    (2.0, 12)
    """
    shapes = [shape.moved(spot) for k, spot in enumerate(_tiles(n)) for shape in maps[k % len(maps)].shapes]
    return World(shapes, float(np.ceil(np.sqrt(n / SHAPES))))


def _tiles(n: int) -> Floats:
    """Return the middle of each 1 m x 1 m tile, row by row, shape (n / 4, 2)."""
    index = np.arange(n // SHAPES, dtype=float)
    columns = int(np.ceil(np.sqrt(len(index))))
    middles: Floats = np.column_stack([index % columns, index // columns]) - (columns - 1) / 2
    return middles


def poses_on_tiles(world: World, maps: Sequence[World], per_map: int, rng: np.random.Generator) -> Floats:
    """Return poses outside the shapes of a tiled board, as many on each of the maps, in random order."""
    tiles = _tiles(len(world.shapes))
    poses = np.vstack([poses_outside(one, per_map, rng) for one in maps])
    which = np.repeat(np.arange(len(maps)), per_map)
    turns = (len(tiles) - 1 - which) // len(maps) + 1  # how often this map was laid
    poses[:, :2] += tiles[which + len(maps) * rng.integers(0, turns)]
    return rng.permutation(poses)


def bench_sizes(effort: Effort, seed: int) -> tuple[Result, dict[str, Curve]]:
    """Time scans on boards with more and more shapes at the same density."""
    rng, lidar, loops = np.random.default_rng(seed), Lidar(), _loops()
    maps = list(four_shape_maps(effort.maps).values())
    boards = {size: _Board(size, maps, effort, lidar, loops, rng) for size in effort.sizes}
    tools = {(size, tool): call for size, board in boards.items() for tool, call in board.calls.items()}
    taken = in_turns({f"{size} {tool}": call for (size, tool), call in tools.items()}, effort.rounds)
    costs = {(size, tool): MICRO * taken[f"{size} {tool}"] / boards[size].n_scans[tool] for size, tool in tools}
    names = [OURS, *LOOPS, GEOS, IRSIM]
    rows = [row for tool in names for row in _size_rows(tool, boards, costs)]
    curves: dict[str, Curve] = {}
    for tool in names:
        sizes = [size for size in boards if (size, tool) in costs]
        curves[tool] = sizes, [float(np.median(costs[size, tool])) for size in sizes]
    first, last = effort.sizes[0], effort.sizes[-1]
    result = Result(
        "sizes",
        f"Larger boards: scans among {first} to {last:,} shapes, 4 on each square metre",
        "us per scan",
        f"times {first} shapes'",
        tuple(rows),
        (
            f"Medians of {effort.rounds} rounds in turns over all sizes and tools, with the least and the greatest.",
            f"The boards are the suite's maps side by side; {first} shapes: each map alone. "
            f"At most {effort.poses:,} poses in a call, fewer for the slower tools.",
            '"hits" is what a scan sees: beams that meet something. "first call" is a scan of one pose on a new world: '
            "it builds what the following calls reuse.",
        ),
    )
    return result, {tool: curve for tool, curve in curves.items() if curve[0]}


class _Board:
    """One size: for each tool a call that scans, and how many scans that makes."""

    def __init__(
        self,
        size: int,
        maps: Sequence[World],
        effort: Effort,
        lidar: Lidar,
        loops: Mapping[str, Loop],
        rng: np.random.Generator,
    ) -> None:
        per_map = max(1, effort.poses // len(maps))
        alone = size == SHAPES  # a single tile: each of the maps in turn, with as many poses in a call
        worlds = list(maps) if alone else [tiled(size, maps)]
        new = World([shape.moved((EQUAL, 0.0)) for shape in worlds[0].shapes], worlds[0].size)  # one it has not seen
        self.first_call = seconds(lambda: scan(new, (0, 0, 0), lidar))
        n_maps = min(len(maps), size // SHAPES)
        scenes = [
            (world, poses_outside(world, effort.poses, rng))
            if alone
            else (world, poses_on_tiles(world, maps[:n_maps], per_map, rng))
            for world in worlds
        ]
        self.hits = float(np.mean([scan(world, poses, lidar).hits.sum(axis=1).mean() for world, poses in scenes]))
        limits = dict.fromkeys([OURS], effort.poses)
        limits |= dict.fromkeys(LOOPS, max(1, min(effort.poses, BRUTE_PAIRS // size)))
        limits |= dict.fromkeys([GEOS, IRSIM], effort.slow_poses)
        self.calls: dict[str, Callable[[], object]] = {}
        self.n_scans: dict[str, int] = {}
        ready = [(_casters(world, lidar, loops), poses) for world, poses in scenes]
        self.equal: dict[str, float] = {}
        for tool in ready[0][0]:
            work = [(casters[tool], poses[: limits[tool]]) for casters, poses in ready]
            self.calls[tool] = _calls(work)
            self.n_scans[tool] = sum(len(poses) for _, poses in work)
            checked = [(c[OURS](poses[: effort.slow_poses]), c[tool](poses[: effort.slow_poses])) for c, poses in ready]
            self.equal[tool] = min(share_equal(ours, theirs) for ours, theirs in checked)


def _calls(work: Sequence[tuple[Cast, Floats]]) -> Callable[[], object]:
    return lambda: [cast(poses) for cast, poses in work]


def _size_rows(tool: str, boards: Mapping[int, _Board], costs: Mapping[tuple[int, str], Floats]) -> list[Row]:
    rows, smallest = [], min(boards)
    for size, board in boards.items():
        cost = costs.get((size, tool))
        if cost is None:
            continue
        ratio = None if size == smallest else Spread.of(cost / costs[smallest, tool])
        facts: dict[str, Fact] = {AGREEMENT: f"{board.equal[tool]:.4f}"}
        if tool == OURS:
            facts = {"hits": board.hits, "first call [ms]": 1000 * board.first_call}
        rows.append(Row(tool, f"{size:,} shapes", Spread.of(cost), ratio, size, facts))
    return rows or [Row(tool, "every size")]
