"""Composites: two parts, how far they reach into each other, and the colours of a camera. Lesson 12's slider, and maps.

>>> composites()
Slider: made of, joint, camera
>>> from primkit.widgets.drawing import what_it_says
>>> what_it_says(composites().draw(made="two boxes", joint=5.0))
'Two boxes, the joint 5 cm aside: the hits lie 0.2 mm from the outline (root mean square), and 85 % bear the colour of \
their part.'
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache

import numpy as np

from ..arguments import Floats, Ints
from ..lidar import Lidar, Scans, scan
from ..palette import BLUE, GREY, INK, ORANGE, VERMILION
from ..parts import Apart, Camera, colors_of, look
from ..shapes import Circle, Polygon, Shape
from ..world import World
from .drawing import Frame, idea_frame, picture, side_by_side, square_frame
from .slider import Choice, Explorer, Picture, Slider, explore

PAINT = ((0.9, 0.35, 0.1), (0.1, 0.35, 0.9))  # of the first part and of the second
PART_COLORS, UNKNOWN_COLOR = (VERMILION, BLUE), GREY
MADE_OF = ("two boxes", "an L", "a house")
AROUND = np.arange(12) * np.pi / 6  # rad: from here the robot looks at the middle
AWAY = 0.33  # m
LEGEND = (
    *(("hits seen in orange", VERMILION, "dot"), ("seen in blue", BLUE, "dot"), ("colour not seen", GREY, "dot")),
    *(("first part", VERMILION, "line"), ("second part", BLUE, "dashed")),
)


def composites() -> Explorer:
    """Return the slider of lesson 12: where two parts meet, and by how much the camera is turned."""
    return explore(
        draw_composites,
        Choice("made", MADE_OF, start="two boxes", label="made of"),
        Slider("joint", -8.0, 8.0, 1.0, start=0.0, unit="cm"),
        Slider("turned", -12.0, 12.0, 1.0, start=0.0, unit="degrees", label="camera"),
        settings={
            "two boxes": {},
            "the joint aside": {"joint": 5.0},
            "an L, reaching in": {"made": "an L", "joint": -6.0},
            "an L, not reaching": {"made": "an L", "joint": 3.0},
            "a house, its roof pushed in": {"made": "a house", "joint": -2.0},
            "camera turned": {"turned": 8.0},
        },
        diagram=draw_diagram,
    )


def _box(x0: float, x1: float, y0: float, y1: float) -> Polygon:
    return Polygon([(x0, y0), (x1, y0), (x1, y1), (x0, y1)])


def parts_of(made: str, joint: float = 0.0) -> list[Shape]:
    """Return the two parts, with their joint so many centimetres aside of where it is."""
    aside = joint / 100
    if made == "two boxes":
        return [_box(-0.12, aside, -0.05, 0.05), _box(aside, 0.12, -0.05, 0.05)]
    if made == "an L":
        return [_box(-0.1, 0.1, -0.1, 0.0), _box(-0.1, -0.03, aside, 0.12)]
    return [_box(-0.1, 0.1, -0.1, 0.0), Polygon([(-0.1, aside), (0.1, aside), (0.0, aside + 0.1)])]


@cache
def seen(made: str) -> Scans:
    """Return what a LiDAR hits all around, with noise."""
    poses = np.column_stack([AWAY * np.cos(AROUND), AWAY * np.sin(AROUND), AROUND + np.pi])
    return scan(World(parts_of(made)), poses, Lidar(beams=180, range_max=0.5, noise_std=0.0003), rng=0)


@cache
def hit_colors(made: str, turned: float = 0.0) -> Ints:
    """Return the part whose colour each hit bears as a camera sees it that is turned, in degrees; -1 for unknown."""
    views = look(World(parts_of(made)), seen(made).poses, Camera(turned=np.radians(turned)), colors=PAINT)
    _, hues = views.colors()
    known = np.array([np.arctan2(np.sqrt(3) * (g - b), 2 * r - g - b) % (2 * np.pi) for r, g, b in PAINT])
    part = np.abs((hues[:, None] - known + np.pi) % (2 * np.pi) - np.pi).argmin(axis=1)
    of_hits = colors_of(seen(made), views)
    return np.where(of_hits >= 0, part[of_hits], -1)


def draw_composites(made: str, joint: float, turned: float) -> str:
    """Draw hits in the colours that a camera sees, and two parts with their joint aside, in cm."""
    points, colors, parts = seen(made).points(), hit_colors(made, turned), parts_of(made, joint)
    away = np.array([part.signed_distance(points) for part in parts])
    rms = 1000 * float(np.sqrt(np.mean(away.min(axis=0) ** 2)))
    right = colors == np.abs(away).argmin(axis=0)
    share = 100 * float(right[colors >= 0].mean())
    frame = square_frame((0.0, 0.0), 0.32)
    return picture(
        frame,
        *_dots(frame, points, colors),
        frame.shape(parts[0], PART_COLORS[0], 2.5, fill=0.08),
        frame.shape(parts[1], PART_COLORS[1], 2.5, "7 4", fill=0.08),
        title=f"Off the outline {rms:.1f} mm; of their part's colour {share:.0f} %",
        says=f"{made[0].upper()}{made[1:]}, the joint {joint:g} cm aside: the hits lie {rms:.1f} mm from the outline "
        f"(root mean square), and {share:.0f} % bear the colour of their part.",
        legend=LEGEND,
    )


def _dots(frame: Frame, points: Floats, colors: Ints) -> list[str]:
    """Draw points in the colours of parts, the unknown ones below."""
    shades = (UNKNOWN_COLOR, *PART_COLORS)
    return [frame.points(points[colors == k - 1], shade, size=4) for k, shade in enumerate(shades)]


def show_apart(found: Mapping[str, tuple[Floats, Apart | None]]) -> Picture:
    """Return outlines taken apart, side by side, a caption each: points on an outline, shape (N, 2), and its parts."""
    drawn = []
    for places, apart in found.values():
        low, high = places.min(axis=0), places.max(axis=0)
        frame = square_frame(tuple(((low + high) / 2).tolist()), 1.35 * float((high - low).max()))
        parts = apart.parts if apart else ()
        says = f"{apart!r}." if apart else "taken apart into nothing."
        title = " + ".join(part.kind for part in parts) or "nothing"
        drawn.append(
            picture(
                frame,
                frame.points(places, GREY, size=3),
                *(frame.shape(part, width=2.5, fill=0.15) for part in parts),
                title=title,
                says=says,
                legend=(("points", GREY, "dot"),),
            )
        )
    return Picture(side_by_side(drawn, list(found)), f"Taken apart: {', '.join(found)}")


def draw_diagram() -> Picture:
    """Return the drawing behind the lesson's formula: two parts, a point, and how far it lies outside of either."""
    box, circle = _box(-0.12, 0.04, -0.05, 0.05), Circle((0.06, 0.0), 0.05)
    point = np.array([0.02, 0.11])
    to_box, to_circle = (
        np.array([0.02, 0.05]),
        circle.center + 0.05 * (point - circle.center) / np.hypot(*(point - circle.center)),
    )
    frame = idea_frame((-0.16, 0.16), (-0.09, 0.16), 555)
    svg = picture(
        frame,
        frame.shape(box, VERMILION, 2.5, fill=0.1),
        frame.shape(circle, BLUE, 2.5, "7 4", fill=0.1),
        frame.segments([point], [to_box], VERMILION, 2),
        frame.segments([point], [to_circle], BLUE, 2, "5 4"),
        frame.points([point], INK, size=9),
        frame.text(point, "p", INK, shift=(8, -6), size=16),
        frame.text((0.02, 0.08), "r₁", VERMILION, "end", (-6, 4), 16),
        frame.text((point + to_circle) / 2, "r₂", BLUE, shift=(8, 4), size=16),
        frame.text((-0.04, 0.0), "part 1", VERMILION, "middle", size=15),
        frame.text((0.075, 0.0), "part 2", BLUE, "middle", (0, 4), 15),
        frame.text((-0.15, 0.135), "r = min(r₁, r₂)", ORANGE, size=16),
        title="The union's outline is where the lesser distance is 0",
        says="A point p lies r1 outside of the first part and r2 outside of the second. It is outside of their union "
        "by the lesser of both; what one part hides of the other is seen by nobody.",
    )
    return Picture(svg, "Diagram: two parts, and a point outside of both")
