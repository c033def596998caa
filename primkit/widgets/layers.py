"""Layers: a ball, a post or a leaning post, cut by one level layer of beams, by two, by ten. The slider of lesson 11.

>>> layers()
Slider: what, layers, turned
>>> from primkit.widgets.drawing import what_it_says
>>> what_it_says(layers().draw(what="a post", layers=2)).partition(": ")[2]
'22.4 and 22.4 cm. The radius stays: a post.'
"""

from __future__ import annotations

from functools import cache

import numpy as np

from ..arguments import Floats
from ..circles import fit_circle
from ..palette import BLUE, GREY, INK, ORANGE, VERMILION
from ..space import Cylinder, Lidar3d, Scene, Sphere, scan
from ..space.solids import Solid
from ..table import count
from .drawing import Frame, idea_frame, picture
from .slider import Choice, Explorer, Picture, Slider, explore

BALL_RADIUS, FIRST_HEIGHT, LAYER_STEP, LAYERS = 0.3, 0.1, 0.05, 10  # m; the ball lies on the ground
SLICE_RADIUS = float(np.sqrt(BALL_RADIUS**2 - (FIRST_HEIGHT - BALL_RADIUS) ** 2))  # of the ball, at the first layer
THINGS: dict[str, Solid] = {
    "a ball": Sphere((0, 0, BALL_RADIUS), BALL_RADIUS),
    "a post": Cylinder((0, 0, 0.3), (0, 0, 1), SLICE_RADIUS, 0.6),
    "a leaning post": Cylinder((0, 0, 0.35), (0.35, 0, 1), SLICE_RADIUS, 0.9),
}
STANDS = [(1.5 * np.cos(a), 1.5 * np.sin(a)) for a in (0.3, 2.4, 4.5)]  # m: where the LiDAR's mast stands
LOOKING_DOWN, SAME_RADIUS = 0.35, 0.01  # rad; m: radii that differ by more are not the same
FULL_TURN = np.linspace(0, 2 * np.pi, 49)
LAYER_LEGEND = (("hits", BLUE, "dot"), ("circle of a layer", GREY, "line"), ("of the highest", VERMILION, "line"))


def layers() -> Explorer:
    """Return the slider of lesson 11: what stands there, how many layers see it, and from where the cloud is seen."""
    return explore(
        draw_layers,
        Choice("what", tuple(THINGS), start="a ball"),
        Slider("layers", 1, LAYERS, 1, start=1),
        Slider("turned", -180, 165, 15, start=30, unit="degrees"),
        settings={
            "a ball, one layer": {},
            "a post, one layer": {"what": "a post"},
            "a ball, two layers": {"layers": 2},
            "a post, two layers": {"what": "a post", "layers": 2},
            "a ball, ten layers": {"layers": 10},
            "a leaning post, from its side": {"what": "a leaning post", "layers": 10, "turned": -90},
        },
        diagram=draw_slices,
    )


@cache
def _slices(what: str) -> list[tuple[Floats, Floats, float]]:
    """Return of each layer its hits, shape (N, 3), and the middle and radius of their circle, metres."""
    found = []
    for height in FIRST_HEIGHT + LAYER_STEP * np.arange(LAYERS):
        level = Lidar3d(layers=1, azimuths=360, fov=0, range_max=3)
        points = scan(Scene([THINGS[what]]), [(*stand, height) for stand in STANDS], level, rng=0).points()
        circle = fit_circle(points[:, :2])
        assert circle is not None, "each layer meets it"
        found.append((points, np.append(circle.center, height), circle.radius))
    return found


def draw_layers(what: str, layers: int, turned: float) -> str:
    """Draw what some layers hit, and the circle through each, seen from a bearing in degrees."""
    a, seen = np.radians(turned), _slices(what)[:layers]
    right = np.array([-np.sin(a), np.cos(a), 0])
    up = np.array([-np.sin(LOOKING_DOWN) * np.cos(a), -np.sin(LOOKING_DOWN) * np.sin(a), np.cos(LOOKING_DOWN)])
    flat = np.array([right, up]).T
    ring = np.column_stack([np.cos(FULL_TURN), np.sin(FULL_TURN), 0 * FULL_TURN])
    frame = Frame((-0.55, 0.55), (-0.2, 0.9), "across [m]", "up, as seen [m]", width=425, height=425)
    circles = [(middle + radius * ring) @ flat for _, middle, radius in seen]
    radii = [f"{100 * radius:.1f}" for *_, radius in seen]
    told = " and ".join([", ".join(radii[:-1]), radii[-1]] if layers > 1 else radii)
    least, most = min(radius for *_, radius in seen), max(radius for *_, radius in seen)
    away = 100 * float(np.linalg.norm((seen[-1][1] - seen[0][1])[:2]))
    if layers == 1:
        finding = "Ball or post? One circle does not tell."
    elif most - least > SAME_RADIUS:
        finding = "The radius changes: no post."
    else:
        finding = (
            "The radius stays: a post." if away < 1 else f"It stays, and its middle walks {away:.0f} cm: it leans."
        )
    return picture(
        frame,
        *(frame.polyline(line, GREY, 1) for line in circles[:-1]),
        *(frame.points(points @ flat, BLUE, size=2.6) for points, *_ in seen),
        frame.polyline(circles[-1], VERMILION, 2),
        title=f"{count(layers, 'layer')}: the highest circle's radius is {radii[-1]} cm",
        says=f"The circles of {what}, from the lowest layer upwards, have radii of: {told} cm. {finding}",
        legend=LAYER_LEGEND,
    )


def draw_slices() -> Picture:
    """Return the drawing behind the lesson's formula: a ball and a post, cut at two heights, from the side."""
    frame = idea_frame((-0.4, 1.0), (-0.08, 0.72), 600)
    ball, post, heights = np.array([0.0, BALL_RADIUS]), 0.7, (FIRST_HEIGHT, 0.2)
    rims = [float(np.sqrt(BALL_RADIUS**2 - (h - BALL_RADIUS) ** 2)) for h in heights]
    lows = [(0.0, h) for h in heights] + [(post, h) for h in heights]
    ends = [(rim, h) for rim, h in zip(rims, heights, strict=True)] + [(post + SLICE_RADIUS, h) for h in heights]
    corners = [(post + sign * SLICE_RADIUS, z) for sign, z in ((-1, 0), (-1, 0.6), (1, 0.6), (1, 0))]
    svg = picture(
        frame,
        frame.segments([(-0.4, 0)], [(1, 0)], INK, 2),
        frame.circle(ball, BALL_RADIUS, BLUE),
        frame.polyline([*corners, corners[0]], BLUE),
        frame.segments([(-0.4, h) for h in heights], [(1.0, h) for h in heights], GREY, 1, "5 4"),
        frame.segments(lows, ends, VERMILION, 4),
        frame.segments([ball], [ends[0]], ORANGE, 2),
        frame.segments([ball], [lows[0]], INK, 1.5),
        frame.points([ball], INK, size=7),
        frame.text(ball + 0.25 * (ends[0] - ball), "R", ORANGE, shift=(8, 0), size=16),
        frame.text((0, 0.2), "h - c", INK, "end", (-6, -8), 15),
        frame.text((0, BALL_RADIUS), "c", INK, "end", (-8, 0), 15),
        frame.text((0.1, heights[0]), "r", VERMILION, shift=(0, 18), size=16),
        frame.text((post + 0.1, heights[0]), "r", VERMILION, shift=(0, 18), size=16),
        title="At one height both have the same circle; a second height tells",
        says="From the side: a ball and a post, cut at two heights. At the lower one both circles have the same radius "
        "r. In the ball, R, r and the height h - c above its middle are the sides of a right triangle, so r "
        "changes with the height; in the post it stays.",
    )
    return Picture(svg, "Diagram: a ball and a post, cut at two heights")
