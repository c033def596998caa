"""Effort: how much each benchmark does, in full or just enough to see that it runs.

>>> QUICK.poses < FULL.poses
True
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Effort:
    """How much is measured.

    Parameters
    ----------
    rounds : int
        How often each time is taken.
    maps : int
        How many of the suite's ten 4-shape maps.
    poses : int
        Scans in one call of primkit's and numba's.
    slow_poses : int
        Scans of tools that take hundreds of microseconds for each, and scans one by one.
    sizes : tuple of int
        Numbers of shapes, multiples of four.
    many : int
        Scans for the peak of memory.
    trials : int
        Samples of each RANSAC.
    clusters : int
        How many clusters of each kind are fitted.
    steps : int
        Steps of the drive on each map.
    worlds : int
        Maps of the study.
    starts : int
        Fresh processes for each import.
    """

    rounds: int
    maps: int
    poses: int
    slow_poses: int
    sizes: tuple[int, ...]
    many: int
    trials: int
    clusters: int
    steps: int
    worlds: int
    starts: int


FULL = Effort(
    rounds=7,
    maps=10,
    poses=10_000,
    slow_poses=200,
    sizes=(4, 40, 400, 4000, 10_000),
    many=1_000_000,
    trials=1000,
    clusters=10,
    steps=50,
    worlds=1000,
    starts=15,
)
QUICK = Effort(
    rounds=2,
    maps=2,
    poses=500,
    slow_poses=10,
    sizes=(4, 40, 400),
    many=20_000,
    trials=50,
    clusters=2,
    steps=4,
    worlds=4,
    starts=2,
)
