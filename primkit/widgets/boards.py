"""Boards: a random board for each seed, as the robot sees it. The slider of lesson 00.

>>> boards()
Slider: seed, shapes, noise, show
"""

from __future__ import annotations

from collections import Counter

import numpy as np

from ..grid import Grid
from ..lidar import Lidar, scan
from ..palette import INK
from ..robot import teleport_poses
from ..table import count
from ..world import random_world
from .drawing import board_frame, picture
from .slider import Choice, Explorer, Slider, explore

SHOW_POINTS, SHOW_BOTH, SHOW_TRUTH = "the robot's points", "both", "the truth"


def boards() -> Explorer:
    """Return the slider of lesson 00: the board's seed, how many shapes, the LiDAR's noise, and what is shown."""
    return explore(
        draw_board,
        Slider("seed", 0, 200, 1, start=7),
        Slider("shapes", 1, 4, 1, start=4),
        Slider("noise", 0.0, 20.0, 0.5, start=0.0, unit="mm"),
        Choice("show", (SHOW_POINTS, SHOW_BOTH, SHOW_TRUTH), start=SHOW_POINTS),
        settings={
            "this lesson's board": {"show": SHOW_BOTH},
            "another board": {"seed": 8, "show": SHOW_BOTH},
            "noise of 5 mm": {"noise": 5.0, "show": SHOW_BOTH},
        },
    )


def draw_board(seed: int, shapes: int, noise: float, show: str) -> str:
    """Draw the board with this seed and the cells that the robot's scans hit; noise in mm."""
    world = random_world(shapes, rng=seed)
    grid = Grid(resolution=0.001)
    grid.add(scan(world, teleport_poses(world), Lidar(noise_std=noise / 1000), rng=seed))
    points, frame = grid.points(), board_frame(world.size)
    kinds = Counter(shape.kind for shape in world.shapes)
    names = " and ".join(count(n, kind) for kind, n in sorted(kinds.items()))
    seen = f"{count(len(points), 'occupied cell')} with noise of {noise:g} mm"
    says = {SHOW_POINTS: seen, SHOW_TRUTH: names, SHOW_BOTH: f"{names}; {seen}"}
    return picture(
        frame,
        *(frame.shape(shape, width=1) for shape in world.shapes if show != SHOW_POINTS),
        frame.points(points if show != SHOW_TRUTH else np.empty((0, 2)), INK, size=2),
        title=f"Seed {seed}: {count(len(world.shapes), 'shape')}, {count(len(points), 'occupied cell')}",
        says=f"The board with seed {seed}: {says[show]}.",
    )
