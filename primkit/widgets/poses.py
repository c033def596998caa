"""Poses: hits against walls, before and after steps of Gauss and Newton. The slider of lesson 10, and its maps.

>>> poses()
Slider: walls, aside, turned, steps
>>> from primkit.widgets.drawing import what_it_says
>>> what_it_says(poses().draw(steps=3)).split(": ")[1]
'after 3 steps the hits lie 5.2 mm from their walls (root mean square), and the robot 1.2 mm from where it is.'
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache

import numpy as np

from ..arguments import Floats
from ..driving.one_pose import off_walls, turned, wall_step
from ..driving.scan_matching import placed
from ..lidar import Lidar, Scans, scan
from ..palette import BLUE, GREY, INK, ORANGE, VERMILION
from ..table import count
from ..world import World
from .drawing import board_frame, idea_frame, picture, side_by_side, square_frame
from .slider import Choice, Explorer, Picture, Slider, explore

ROOM = World(walls=True)
TRUE_POSE = np.array([0.15, -0.1, 0.5])  # x [m], y [m], heading [rad]
NORMALS, OFFSETS = np.array([(0.0, -1.0), (1.0, 0.0), (0.0, 1.0), (-1.0, 0.0)]), np.full(4, 0.5)
WALLS = {"all four": [0, 1, 2, 3], "a corner": [0, 1], "two parallel": [0, 2]}
SIDEWAYS = np.array([0.8, 0.6])  # the way that a robot is aside
DRAWN_APART = 3.0  # px: points that are nearer to each other are drawn once
ROOM_LEGEND = (
    *(("hits, where the robot puts them", BLUE, "dot"), ("residuals", ORANGE, "line")),
    *(("believed", VERMILION, "triangle"), ("true", GREY, "triangle")),
)
MAP_LEGEND = (("hits", BLUE, "dot"), ("the way, as believed", ORANGE, "line"), ("truth", INK, "line"))


def poses() -> Explorer:
    """Return the slider of lesson 10: how far off a pose is, which walls are seen, and how many steps mend it."""
    return explore(
        draw_poses,
        Choice("walls", tuple(WALLS), start="all four"),
        Slider("aside", 0.0, 25.0, 1.0, start=10.0, unit="cm"),
        Slider("turn", -90.0, 90.0, 5.0, start=20.0, unit="degrees", label="turned"),
        Slider("steps", 0, 6, 1, start=0),
        settings={
            "believed": {},
            "one step": {"steps": 1},
            "three steps": {"steps": 3},
            "a corner": {"walls": "a corner", "steps": 6},
            "two parallel walls": {"walls": "two parallel", "steps": 6},
            "turned too far": {"turn": 65.0, "steps": 6},
        },
        diagram=draw_diagram,
    )


@cache
def _hits_on(walls: str) -> Floats:
    """Return what a robot at the true pose sees of some walls, with noise, as it sees it, shape (N, 2), metres."""
    seen = scan(ROOM, TRUE_POSE, Lidar(beams=72, range_max=2.0, noise_std=0.003), rng=0)
    nearest = np.abs(seen.points() @ NORMALS.T - OFFSETS).argmin(axis=1)
    hits: Floats = turned(seen.points() - TRUE_POSE[:2], -TRUE_POSE[2])
    return hits[np.isin(nearest, WALLS[walls])]


def draw_poses(walls: str, aside: float, turn: float, steps: int) -> str:
    """Draw a room, the hits as a robot puts them that is aside, in cm, and turned, in degrees, after some steps."""
    hits, seen = _hits_on(walls), np.array(WALLS[walls])
    pose = TRUE_POSE + np.append(aside / 100 * SIDEWAYS, np.radians(turn))
    for _ in range(steps):
        pose = wall_step(pose, hits, *_nearest(pose, hits, seen))
    normals, offsets = _nearest(pose, hits, seen)
    points, off = placed(hits, pose), off_walls(pose, hits, normals, offsets)
    rms, away = 1000 * np.sqrt(np.mean(off**2)), 1000 * float(np.hypot(*(pose - TRUE_POSE)[:2]))
    frame = board_frame(1.4)
    return picture(
        frame,
        frame.segments(ROOM.walls[:, 0], ROOM.walls[:, 1], GREY, 1, "4 4"),
        frame.segments(ROOM.walls[seen, 0], ROOM.walls[seen, 1], INK, 3),
        frame.segments(points, points - off[:, None] * normals, ORANGE, 1.5),
        frame.points(points, BLUE, size=4),
        frame.robot(TRUE_POSE, GREY, 12),
        frame.robot(pose, VERMILION, 9),
        title=f"{count(steps, 'step').capitalize()}: hits {rms:.1f} mm off, robot {away:.0f} mm",
        says=f"Seeing {walls} of the walls, {aside:g} cm aside and turned by {turn:g} degrees: after "
        f"{count(steps, 'step')} the hits lie {rms:.1f} mm from their walls (root mean square), and the robot "
        f"{away:.1f} mm from where it is.",
        legend=ROOM_LEGEND,
    )


def _nearest(pose: Floats, hits: Floats, seen: Floats) -> tuple[Floats, Floats]:
    """Return normal and offset of the wall that each hit lies nearest to, of those that are seen."""
    nearest = seen[np.abs(placed(hits, pose) @ NORMALS[seen].T - OFFSETS[seen]).argmin(axis=1)]
    return NORMALS[nearest], OFFSETS[nearest]


def show_maps(maps: Mapping[str, Scans], world: World, *, sizes: Sequence[float] = (1.4,)) -> Picture:
    """Return maps side by side, a caption each: what was hit, the way, and the true outlines.

    ``sizes``: sides of the pieces of the plane that are shown, metres; the last one holds for all further maps.
    """
    drawn = []
    for number, scans in enumerate(maps.values()):
        frame = square_frame((0.0, 0.0), sizes[min(number, len(sizes) - 1)])
        points = scans.points()
        _, first = np.unique(np.round(np.array(frame.at(points)) / DRAWN_APART), axis=0, return_index=True)
        outlines = [np.abs(shape.signed_distance(points)) for shape in world.shapes]
        far = 1000 * np.min([*outlines, np.abs(world.size / 2 - np.abs(points).max(axis=1))], axis=0)
        half, most = np.percentile(far, (50, 95))
        drawn.append(
            picture(
                frame,
                frame.points(points[first], BLUE, size=2.4),
                frame.segments(world.walls[:, 0], world.walls[:, 1], INK, 1),
                *(frame.shape(shape, INK, 1, fill=0) for shape in world.shapes),
                frame.polyline(scans.poses[:, :2], ORANGE, 2),
                title=f"Half within {half:.0f} mm, 95 % within {most:.0f} mm",
                says=f"half of the {len(points)} hits lie within {half:.0f} mm of a true outline, and 95 % within "
                f"{most:.0f} mm.",
                legend=MAP_LEGEND,
            )
        )
    return Picture(side_by_side(drawn, list(maps)), f"Maps: {', '.join(maps)}")


def draw_diagram() -> Picture:
    """Return the drawing behind the lesson's formula: a hit, its wall, its residual, and what a turn does to it."""
    pose, wall, bearing = np.array([0.0, 0.0]), 0.3, np.radians(32)
    arm = 0.27 * np.array([np.cos(bearing), np.sin(bearing)])
    across = 0.09 * np.array([-np.sin(bearing), np.cos(bearing)])
    frame = idea_frame((-0.06, 0.42), (-0.08, 0.28), 555)
    svg = picture(
        frame,
        frame.segments([(wall, -0.06)], [(wall, 0.27)], INK, 3),
        frame.arrow((wall, -0.03), (wall + 0.08, -0.03), VERMILION, 4),
        frame.segments([pose], [arm], GREY, 1.5, "5 4"),
        frame.segments([arm], [(wall, arm[1])], ORANGE, 3),
        frame.arrow(arm, arm + across, BLUE, 2.5),
        frame.points([arm], BLUE, size=9),
        frame.robot([*pose, 0.0], INK, 14),
        frame.text((wall, 0.25), "wall: n · p = d", INK, shift=(8, 0), size=15),
        frame.text((wall + 0.08, -0.03), "n", VERMILION, shift=(6, 5), size=16),
        frame.text(pose, "pose x, y, θ", INK, shift=(-8, 30), size=15),
        frame.text(0.5 * arm, "arm a", GREY, shift=(6, 18), size=15),
        frame.text(arm, "hit", BLUE, shift=(-2, 22), size=15),
        frame.text((0.5 * (arm[0] + wall), arm[1]), "r", ORANGE, shift=(-2, 22), size=16),
        frame.text(arm + across, "where a turn moves it", BLUE, "end", (-6, -8), 15),
        title="A hit is pulled along n; a turn moves it across its arm",
        says="A robot sees a hit at the end of its arm a. The residual r is how far the hit lies from its wall, along "
        "the wall's normal n. When the robot turns, the hit moves across the arm.",
    )
    return Picture(svg, "Diagram: a hit, its residual, and its arm")
