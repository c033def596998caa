"""A compass that is off: the angle that makes the map sharpest.

In:  the student's ``compass_bias``.
Out: marks.

>>> COMPASS_BIAS.mark(true_bias)
4.0
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

import primkit as pk

from ..parts import Fault, shown, task

Floats = NDArray[np.float64]

FARTHEST, STEP, ENOUGH = 21.0, 0.25, 0.5  # degrees: turns of a map that are looked at, and what is wrong enough
PLAINLY = 1.01  # a wrong map must be so much less sharp
BIASES: dict[bytes, float] = {}  # the truth about the scans that are made below, by their poses


def true_bias(scans: pk.Scans) -> float:
    """Return the angle by which all headings are too large, radians: not estimated, but known."""
    return BIASES[scans.poses.tobytes()]


def judge_bias(got: Any, expected: Any, _args: tuple[Any, ...]) -> str | None:
    """Judge an angle, within half a degree."""
    if not isinstance(got, (float, int, np.floating)) or isinstance(got, bool):
        return f"got {shown(got)}, expected an angle in radians"
    off = float(np.degrees(got - expected))
    return (
        None
        if abs(off) <= ENOUGH
        else f"got {np.degrees(got):.1f} degrees, expected {np.degrees(expected):.1f} degrees"
    )


def biased(rng: np.random.Generator, bias: float, lidar: pk.Lidar, turn: float) -> pk.Scans:
    """Return scans of a board from 30 poses, headings within ``turn`` of 0, all of them read too large by a bias.

    The right map is the sharpest by two measures, and plainly: no right way is misled by the luck of a board.
    """
    while True:
        seed = int(rng.integers(1 << 30))
        world = pk.random_world(3, style="free", rng=seed)
        poses = rng.permutation(pk.teleport_poses(world))[:30]
        poses[:, 2] = rng.uniform(-turn, turn, len(poses))
        seen = pk.scan(world, poses, lidar, rng=seed)
        turns = np.radians(np.arange(-FARTHEST, FARTHEST + STEP / 2, STEP))
        maps = [turned(seen, angle).points() for angle in turns]
        right, wrong = np.abs(turns) <= np.radians(STEP), np.abs(turns) >= np.radians(ENOUGH)
        if all(blur[wrong].min() > PLAINLY * blur[right].min() for blur in (occupied(maps), gaps(maps))):
            poses = seen.poses + np.array([0.0, 0.0, bias])
            BIASES[poses.tobytes()] = bias
            return turned(seen, bias)


def turned(scans: pk.Scans, bias: float) -> pk.Scans:
    """Return scans whose headings are larger by a bias, radians."""
    return pk.Scans(scans.poses + np.array([0.0, 0.0, bias]), scans.angles, scans.ranges, scans.inside)


def occupied(maps: list[Floats]) -> Floats:
    """Return how many cells of 4 mm each map occupies, a mean over neighbouring turns."""
    counts = [len(np.unique(np.floor(points / 0.004) @ (1, 1j))) for points in maps]
    return np.convolve(np.pad(counts, 1, mode="edge"), np.ones(3) / 3, mode="valid")


def gaps(maps: list[Floats]) -> Floats:
    """Return how far it is from a hit of each map to its five nearest others, metres."""
    return np.array([cKDTree(points).query(points, 6)[0].mean() for points in maps])


EXACT = pk.Lidar(beams=60, range_max=0.4)
POOR = pk.Lidar(beams=60, range_max=0.4, noise_std=0.002, dropout=0.2)


def some_biases(rng: np.random.Generator) -> Iterator[float]:
    """Yield five biases of 2 to 10 degrees, to either side by turns."""
    side = rng.choice([-1, 1])
    for n in range(5):
        yield float(side * (-1) ** n * np.radians(rng.uniform(2, 10)))


def exact_scans(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield exact scans, headings about the same."""
    for bias in some_biases(rng):
        yield (biased(rng, bias, EXACT, 0.1),)


def poor_scans(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield scans with noise and dropouts, and any headings."""
    for bias in some_biases(rng):
        yield (biased(rng, bias, POOR, np.pi),)


def right_compass(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield scans with a right compass, and with one that is off by less than a degree."""
    for bias in (0.0, 0.8, -0.8):
        yield (biased(rng, float(np.radians(bias)), EXACT, np.pi),)


COMPASS_BIAS = task(
    "compass_bias",
    true_bias,
    judge_bias,
    (
        ("exact scans, headings alike", 1, exact_scans),
        ("noise, dropouts and any headings", 2, poor_scans),
        ("a compass that is right, or nearly", 1, right_compass),
    ),
    (
        Fault(
            "The right angle with the wrong sign: it is what the compass adds, and what you take away again.",
            when=lambda cases: all(judge_bias(-number_of(case.got), case.expected, ()) is None for case in cases),
            name="sign turned round",
        ),
        Fault(
            "That is in degrees.",
            when=lambda cases: all(
                judge_bias(np.radians(number_of(case.got)), case.expected, ()) is None for case in cases
            ),
            name="degrees for radians",
        ),
        Fault(
            "Always 0: is the map really sharpest as it is?",
            when=lambda cases: all(number_of(case.got) == 0 for case in cases),
            name="no bias",
        ),
        Fault(
            "Near, but not within half a degree: look again around your best angle, in finer steps.",
            when=lambda cases: all(abs(number_of(case.got) - case.expected) < np.radians(2.5) for case in cases),
            name="steps too coarse",
        ),
    ),
)


def number_of(value: Any) -> float:
    """Return a number; nan for anything else."""
    return float(value) if isinstance(value, (float, int, np.floating)) else float("nan")
