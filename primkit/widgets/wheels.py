"""Wheels: the arc that two wheels make, beside the same way in straight pieces. The slider of lesson 08.

>>> wheels()
Slider: left, right, seconds, pieces
>>> from primkit.widgets.svg import what_it_says
>>> what_it_says(wheels().draw(left=3.0, right=3.0, seconds=2.0, pieces=1))
'Both wheels at 3 rad/s for 2 s: straight on for 123 mm; 1 straight piece ends 0 mm off.'
"""

from __future__ import annotations

import numpy as np

from ..arguments import Floats
from ..palette import BLUE, GREY, INK, ORANGE, PALE, VERMILION
from ..robot import AXLE, WHEEL, moved
from ..table import count
from .drawing import Frame, board_frame, idea_frame, picture
from .slider import Explorer, Picture, Slider, explore

BOARD_SIDE = 1.0  # m: side of the board
START_POSE = np.array([0.0, -0.1, np.pi / 2])  # x [m], y [m], heading [rad]
ARC_PLACES = 100  # places that an arc is drawn through
STRAIGHT_RADIUS = 10.0  # m: a larger circle is straight as far as one sees


def wheels() -> Explorer:
    """Return the slider of lesson 08: two speeds, a time, and how many straight pieces stand for the arc."""
    return explore(
        draw_wheels,
        Slider("left", -6.0, 6.0, 0.5, start=3.0, unit="rad/s"),
        Slider("right", -6.0, 6.0, 0.5, start=5.0, unit="rad/s"),
        Slider("seconds", 0.5, 3.5, 0.5, start=3.0, unit="s"),
        Slider("pieces", 1, 12, 1, start=3),
        settings={
            "straight on": {"left": 4.0, "right": 4.0},
            "an arc": {"left": 3.0, "right": 5.0},
            "on the spot": {"left": -2.0, "right": 2.0},
            "one wheel stands": {"left": 0.0, "right": 5.0},
            "one piece": {"left": 3.5, "right": 4.5, "pieces": 1},
            "backwards": {"left": -5.0, "right": -3.0, "pieces": 12},
        },
        diagram=draw_diagram,
    )


def draw_wheels(left: float, right: float, seconds: float, pieces: int) -> str:
    """Draw the arc, the circle that it is a part of, and the way in straight pieces: speeds in rad/s."""
    speeds, frame = (left, right), board_frame(BOARD_SIDE)
    arc = np.array([moved(START_POSE, speeds, time) for time in np.linspace(0, seconds, ARC_PLACES)])
    straight = in_pieces(START_POSE, left, right, seconds, pieces)
    off = 1000 * float(np.hypot(*(straight[-1] - arc[-1])[:2]))
    turn, radius = WHEEL * (right - left) / AXLE * seconds, turning_radius(left, right)
    return picture(
        frame,
        _circle(frame, radius),
        frame.polyline(arc[:, :2], BLUE, 3),
        frame.polyline(straight[:, :2], VERMILION, 2, "6 4"),
        frame.points(straight[:, :2], VERMILION, "square", 5),
        frame.robot(START_POSE, GREY),
        frame.robot(arc[-1], INK),
        legend=[("arc", BLUE, "line"), ("straight pieces", VERMILION, "square"), ("turning centre", ORANGE, "cross")],
        title=_title(left, right, turn),
        says=f"{_how(left, right)} for {seconds:g} s: {_where(left, right, radius, turn, seconds)}; "
        f"{count(pieces, 'straight piece')} end{'s' * (pieces == 1)} {off:.0f} mm off.",
    )


def in_pieces(pose: Floats, left: float, right: float, seconds: float, pieces: int) -> Floats:
    """Return the poses of a robot that goes straight and then turns, again and again, shape (pieces + 1, 3)."""
    way, turn = WHEEL * (left + right) / 2 * seconds / pieces, WHEEL * (right - left) / AXLE * seconds / pieces
    headings = pose[2] + turn * np.arange(pieces)
    steps = way * np.column_stack([np.cos(headings), np.sin(headings)])
    places = np.vstack([pose[:2], pose[:2] + np.cumsum(steps, axis=0)])
    return np.column_stack([places, np.append(headings, pose[2] + turn * pieces)])


def turning_radius(left: float, right: float) -> float:
    """Return how far the middle of the turning circle is to the left of the robot, metres; infinite when straight."""
    return float(np.inf) if left == right else AXLE * (left + right) / (2 * (right - left))


def _circle(frame: Frame, radius: float) -> str:
    """Return the circle that the arc is a part of, and its middle if that is on the board."""
    if abs(radius) > STRAIGHT_RADIUS:
        return ""
    x, y, heading = START_POSE.tolist()
    middle = np.array([x - radius * np.sin(heading), y + radius * np.cos(heading)])
    ring = middle + abs(radius) * np.column_stack([f(np.linspace(0, 2 * np.pi, ARC_PLACES)) for f in (np.cos, np.sin)])
    seen = np.abs(ring).max(axis=1) <= BOARD_SIDE / 2
    starts = seen[:-1] & seen[1:]
    cross = frame.points([middle], ORANGE, "cross", 10) if abs(radius) <= BOARD_SIDE / 2 else ""
    return frame.segments(ring[:-1][starts], ring[1:][starts], PALE, 1) + cross


def _title(left: float, right: float, turn: float) -> str:
    """Say what kind of motion it is."""
    if left == right:
        return "Equal speeds: straight on" if left else "Standing still"
    degrees = f"{abs(np.degrees(turn)):.0f} degrees {'left' if turn > 0 else 'right'}"
    return f"Opposite speeds: on the spot, {degrees}" if left == -right else f"It turns {degrees}"


def _how(left: float, right: float) -> str:
    return f"Both wheels at {left:g} rad/s" if left == right else f"Left {left:g}, right {right:g} rad/s"


def _where(left: float, right: float, radius: float, turn: float, seconds: float) -> str:
    """Say how far the robot goes, and around what."""
    if left == right:
        return f"straight on for {1000 * WHEEL * left * seconds:.0f} mm"
    return f"it turns by {np.degrees(turn):.0f} degrees on a circle of radius {1000 * abs(radius):.0f} mm"


def draw_diagram() -> Picture:
    """Return the drawing behind the lesson's formula: the arc, its chord, and the heading midway."""
    frame = idea_frame((-0.02, 0.24), (-0.02, 0.17), 603)
    pose, radius, turn = np.array([0.2, 0.0, np.pi / 2]), 0.16, np.radians(65)
    middle = pose[:2] - [radius, 0.0]
    angles = np.linspace(0, turn, 60)
    arc = middle + radius * np.column_stack([np.cos(angles), np.sin(angles)])
    end, half = arc[-1], turn / 2
    onwards, halfway = pose[:2] + np.array([0.0, 0.08]), middle + np.array([radius / 2, 0.0])
    small = middle + 0.035 * np.column_stack([np.cos(angles), np.sin(angles)])
    svg = picture(
        frame,
        frame.segments([middle, middle], [pose[:2], end], GREY, 1.5, "5 4"),
        frame.polyline(small, ORANGE, 2),
        frame.polyline(arc, BLUE, 4),
        frame.segments([pose[:2]], [end], VERMILION, 2.5, "7 4"),
        frame.arrow(pose[:2], onwards, INK, 1.5),
        frame.points([middle], ORANGE, "cross", 12),
        frame.robot(pose, GREY, 14),
        frame.robot([*end, pose[2] + turn], INK, 14),
        frame.text(middle, "turning centre", anchor="middle", shift=(30, 24), size=14),
        frame.text(middle + 0.042 * np.array([np.cos(half), np.sin(half)]), "w t", ORANGE, shift=(2, 2), size=16),
        frame.text(halfway, "v / w", GREY, "middle", (12, 20), 16),
        frame.text(arc[46], "arc: v t", BLUE, shift=(10, -6), size=16),
        frame.text(0.5 * (pose[:2] + end), "chord", VERMILION, "end", (-10, 8), 16),
        frame.text(onwards, "old heading", INK, "middle", (24, -8), 14),
        title="The chord points midway between both headings",
        says="The robot goes an arc of length v t around the turning centre, v / w away, and turns by w t. The chord "
        "from start to end is turned by half of that against the old heading.",
    )
    return Picture(svg, "Diagram: an arc and its chord")
