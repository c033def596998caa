"""Rays: what the beams of a LiDAR meet, while you move its beams, noise, range and place. The slider of lesson 01.

>>> rays()
Slider: beams, noise, range, x, y, heading
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..lidar import Lidar, scan
from ..palette import BLUE, GREY, INK, ORANGE, PALE, VERMILION
from ..shapes import Circle, Polygon
from ..world import World
from .drawing import board_frame, idea_frame, picture
from .slider import Explorer, Picture, Slider, explore

RAYS_BOARD = World(
    [
        Circle((-0.22, 0.2), 0.09),
        Polygon([(0.1, -0.28), (0.34, -0.2), (0.3, -0.08), (0.06, -0.16)]),
        Polygon([(0.12, 0.12), (0.34, 0.2), (0.16, 0.36)]),
        Polygon([(-0.3, -0.32), (-0.2, -0.34), (-0.13, -0.26), (-0.2, -0.18), (-0.3, -0.22)]),
    ]
)


def rays() -> Explorer:
    """Return the slider of lesson 01: beams, noise, range and pose of a LiDAR among four shapes."""
    return explore(
        draw_rays,
        Slider("beams", 8, 360, 4, start=100),
        Slider("noise", 0.0, 20.0, 0.5, start=0.0, unit="mm"),
        Slider("reach", 0.1, 1.0, 0.05, start=0.3, unit="m", label="range"),
        Slider("x", -0.45, 0.45, 0.01, start=0.0, unit="m"),
        Slider("y", -0.45, 0.45, 0.01, start=0.0, unit="m"),
        Slider("heading", 0, 355, 5, start=0, unit="degrees"),
        settings={
            "as it starts": {},
            "few beams": {"beams": 24, "reach": 0.5},
            "noisy": {"noise": 10.0, "reach": 0.5},
            "far sight": {"reach": 1.0, "beams": 360},
            "along a wall": {"x": 0.42, "y": -0.03, "reach": 0.5, "beams": 360},
            "inside a shape": {"x": 0.2, "y": -0.18, "reach": 0.5},
        },
        diagram=draw_diagram,
    )


def draw_rays(beams: int, noise: float, reach: float, x: float, y: float, heading: float) -> str:
    """Draw one scan of the board: noise in mm, range and position in m, heading in degrees; seed 0."""
    pose = np.array([x, y, np.radians(heading)])
    scans = scan(RAYS_BOARD, pose, Lidar(beams=beams, noise_std=noise / 1000, range_max=reach), rng=0)
    hits, bearings = scans.hits[0], pose[2] + scans.angles
    ends = pose[:2] + np.minimum(scans.ranges[0], reach)[:, None] * np.column_stack(
        [np.cos(bearings), np.sin(bearings)]
    )
    starts = np.broadcast_to(pose[:2], ends.shape)
    frame, n = board_frame(RAYS_BOARD.size), int(hits.sum())
    inside = bool(scans.inside[0])
    return picture(
        frame,
        *(frame.shape(shape, width=1) for shape in RAYS_BOARD.shapes),
        "" if inside else frame.segments(starts[~hits], ends[~hits], PALE, 0.7),
        frame.segments(starts[hits], ends[hits], ORANGE, 0.9),
        frame.points(ends[hits], VERMILION, size=4.5),
        frame.robot(pose),
        title="Inside a shape it sees nothing" if inside else f"{n} of {beams} beams hit something",
        legend=[("hit", VERMILION, "dot"), ("its beam", ORANGE, "line"), ("no hit", PALE, "line")],
        says=_says(beams, n, scans.ranges[0][hits], reach, noise, inside),
    )


def _says(beams: int, n: int, ranges: NDArray[np.float64], reach: float, noise: float, inside: bool) -> str:
    """Say in a sentence what the scan shows."""
    if inside:
        return f"The robot stands inside a shape: all {beams} beams read inf."
    near = f"; the nearest hit is {100 * ranges.min():.1f} cm away" if n else ""
    return f"{n} of {beams} beams meet an outline within {reach:g} m, with noise of {noise:g} mm{near}."


def draw_diagram() -> Picture:
    """Return the drawing behind the lesson's formula: where the beam q + t u meets the wall a + s (b - a)."""
    q, u, a, b = np.array([[0.05, 0.05], [0.8, 0.6], [0.19, 0.33], [0.44, 0.08]])
    t, s = np.linalg.solve(np.column_stack([u, a - b]), a - q)  # q + t u = a + s (b - a)
    hit = q + t * u
    frame = idea_frame((0.0, 0.55), (0.0, 0.4), 525)
    svg = picture(
        frame,
        frame.segments([q], [q + 0.6 * u], PALE, 1.5, "5 4"),
        frame.segments([a], [b], INK, 4),
        frame.segments([a], [a + s * (b - a)], BLUE, 4),
        frame.segments([q], [hit], ORANGE, 3),
        frame.arrow(q, q + 0.1 * u, VERMILION, 5),
        frame.points([hit], VERMILION, "ring", 14),
        frame.points([a, b], INK, "square", 8),
        frame.robot([*q, np.arctan2(u[1], u[0])]),
        frame.text(q, "q", shift=(-4, 24), size=16),
        frame.text(q + 0.1 * u, "u (length 1, drawn short)", VERMILION, shift=(6, 14), size=14),
        frame.text(q + 0.21 * u, "t u", INK, "end", (-8, -6), 16),
        frame.text(a, "a", shift=(-20, -2), size=16),
        frame.text(b, "b", shift=(10, 14), size=16),
        frame.text(a + 0.6 * s * (b - a), "s (b - a)", BLUE, shift=(8, -10), size=16),
        frame.text(hit, "hit", GREY, shift=(14, 2), size=14),
        title="Two ways to the same point",
        says=f"From q the beam goes {t:.2g} m along u; from a it is {s:.2g} of the way to b: both end at the hit.",
    )
    return Picture(svg, "Diagram: a beam meets a wall")
