"""Sweeps: one thing changed at a time.

In:  the name of a sweep, the number of maps, a seed.
Out: the experiments of each of its levels.

>>> [level.name for level in SWEEPS["gap"].levels]
['gap 5 cm', 'gap 3 cm']
>>> from primkit.study.oracle import ORACLE
>>> [e.map for e in experiments(UNCHANGED, {"oracle": ORACLE}, n_maps=3)]
['free-1', 'free-2', 'free-3']

All sweeps start from the same point: free maps (any rotation, irregular), one to six shapes in turn, gaps of 5 cm, the
sensor without faults, all 77 way-points. Maps, way-points and the sensor's draws stay the same from level to level, as
far as the level lets them: what differs is the one thing.

Every seed starts with ``UNTUNED``. Nothing in primkit was tuned on maps or noise drawn from it, and nothing may be.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ...formats import paper_suite
from ...lidar import Lidar
from ...pipeline import PAPER, ROBUST, Settings
from ...robot import waypoints
from ...table import count
from ...world import World, random_world
from ..experiment import Experiment
from ..oracle import Oracle

UNTUNED = 27_182_818
MOST_MIXED = 6  # shapes on a map, at most, where the number is not what is changed
CROWDED_GAP = 0.03  # m: gap between shapes on maps of more than six, which have no room for 5 cm

# Each remedy over the published method switched on in turn, and kept.
REMEDIES: Mapping[str, Settings] = {
    "PAPER": PAPER,
    "+ linking": replace(PAPER, grouping="link"),
    "+ joint fit": replace(ROBUST, soft=False, second_opinion=False),
    "+ soft shares": replace(ROBUST, second_opinion=False),
    "ROBUST": ROBUST,
}


@dataclass(frozen=True)
class Condition:
    """What is the same for all maps of a level.

    Parameters
    ----------
    board : {"free", "suite"}
        Random maps at any rotation, or the paper's 34.
    n_shapes : int, optional
        On each free map; one to six in turn when not given.
    gap : float
        Least distance between two outlines on a free map, metres.
    noise_std : float
        Of the ranges, metres.
    spurious : float
        Share of beams with a random range.
    n_scans : int, optional
        How many of the 77 way-points are scanned from, drawn at random; all when not given.
    """

    board: Literal["free", "suite"] = "free"
    n_shapes: int | None = None
    gap: float = 0.05
    noise_std: float = 0.0
    spurious: float = 0.0
    n_scans: int | None = None


@dataclass(frozen=True)
class Level:
    """One step of a sweep: its name, its place on the axis, and what maps and sensor are like."""

    name: str
    x: float
    condition: Condition


@dataclass(frozen=True)
class Sweep:
    """What is changed, in which steps.

    Parameters
    ----------
    title : str
        Of the table.
    axis : str
        Label of the axis, with its unit.
    levels : tuple of Level
        The steps.
    note : str
        What a reader must know.
    remedies : bool
        Compare ``REMEDIES`` instead of the usual methods.
    """

    title: str
    axis: str
    levels: tuple[Level, ...]
    note: str = ""
    remedies: bool = False


UNCHANGED = Condition()
HARD = Condition(gap=0.03, noise_std=0.002, spurious=0.02)
NOISES_MM = (0, 1, 2, 5, 10)  # mm
FREE_MAPS = "Free maps (any rotation, irregular), 1 to 6 shapes, gaps of 5 cm"


def _noisy(start: Condition) -> tuple[Level, ...]:
    return tuple(Level(f"noise {mm} mm", mm, replace(start, noise_std=mm / 1000)) for mm in NOISES_MM)


def _crowd(n: int) -> Level:
    gap = UNCHANGED.gap if n <= MOST_MIXED else CROWDED_GAP
    return Level(count(n, "shape"), n, replace(UNCHANGED, n_shapes=n, gap=gap))


SWEEPS: Mapping[str, Sweep] = {
    "suite": Sweep(
        "Range noise, the paper's suite",
        "standard deviation of the ranges [mm]",
        _noisy(Condition("suite")),
        "The paper's 34 maps; with noise each is scanned several times, and its runs are one draw of the bootstrap.",
    ),
    "noise": Sweep("Range noise, free maps", "range noise [mm]", _noisy(UNCHANGED), f"{FREE_MAPS}."),
    "shapes": Sweep(
        "Number of shapes, free maps",
        "shapes (gaps 5 cm; above 6: 3 cm)",
        tuple(_crowd(n) for n in (1, 2, 3, 4, 5, 6, 8, 10, 12)),
        "Free maps, no noise; gaps of 5 cm up to 6 shapes, of 3 cm with more: there is no room for wider ones.",
    ),
    "scans": Sweep(
        "Number of scans, free maps",
        "way-points scanned from",
        tuple(Level(f"{n} scans", n, replace(UNCHANGED, n_scans=n if n < 77 else None)) for n in (10, 20, 40, 77)),
        f"{FREE_MAPS}, no noise; random way-points out of the 77. With few, sides are not seen by anyone.",
    ),
    "spurious": Sweep(
        "Spurious returns, free maps",
        "spurious beams [%]",
        tuple(Level(f"{p} % spurious", p, replace(UNCHANGED, spurious=p / 100)) for p in (0, 1, 2, 5)),
        f"{FREE_MAPS}, no noise; a spurious beam returns a random range.",
    ),
    "gap": Sweep(
        "Gap between shapes, free maps",
        "gap [cm]",
        tuple(Level(f"gap {cm} cm", cm, replace(UNCHANGED, gap=cm / 100)) for cm in (5, 3)),
        "Free maps, 1 to 6 shapes, no noise.",
    ),
    "remedies": Sweep(
        "What each remedy buys",
        "",
        (Level("plain", 0, UNCHANGED), Level("hard", 1, HARD)),
        "Each method has all remedies of those above it; ROBUST adds the second opinion. "
        f"plain: {FREE_MAPS[0].lower()}{FREE_MAPS[1:]}, no noise. "
        "hard: gaps of 3 cm, 2 mm noise, 2 % spurious returns.",
        remedies=True,
    ),
}


def experiments(
    condition: Condition, methods: Mapping[str, Settings | Oracle], n_maps: int, seed: int = 0
) -> Iterator[Experiment]:
    """Yield what is to be done at one level: map by map, and on each method by method.

    The paper's suite is scanned as often as brings the number of runs near ``n_maps``; once without noise, because
    every scan of a map is then the same.
    """
    lidar = Lidar(noise_std=condition.noise_std, spurious=condition.spurious)
    suite = paper_suite() if condition.board == "suite" else None
    for repeat in range(1 if suite is None else n_runs(condition, n_maps) // len(suite)):
        own = int(np.random.default_rng([UNTUNED, seed, repeat]).integers(2**31))
        boards = _free(condition, n_maps, seed) if suite is None else ((n, world, None) for n, world in suite.items())
        for name, world, drive in boards:
            for method, settings in methods.items():
                yield Experiment(name, world, method, settings, lidar, seed=own, drive=drive)


def n_runs(condition: Condition, n_maps: int) -> int:
    """Return how many experiments there are for each method at one level."""
    if condition.board == "free":
        return n_maps
    same = condition.noise_std == 0 and condition.spurious == 0
    return len(paper_suite()) * (1 if same else max(1, round(n_maps / len(paper_suite()))))


def _free(condition: Condition, n_maps: int, seed: int) -> Iterator[tuple[str, World, NDArray[np.float64] | None]]:
    """Yield the name, the board, and the way-points to scan from (None: all) of each free map."""
    for number in range(n_maps):
        world_rng, drive_rng = np.random.default_rng([UNTUNED, seed, number]).spawn(2)
        n = condition.n_shapes or 1 + number % MOST_MIXED
        world, drive = roomy_world(n, condition.gap, world_rng), None
        if condition.n_scans is not None:
            every = waypoints(world.size)
            drive = every[np.sort(drive_rng.permutation(len(every))[: condition.n_scans])]
        yield f"free-{number + 1}", world, drive


def roomy_world(n: int, gap: float, rng: np.random.Generator) -> World:
    """Return a free map; draws go on until the shapes find room, which twelve do not always."""
    while True:
        try:
            return random_world(n, style="free", gap=gap, rng=rng)
        except ValueError:  # no room this time
            continue
