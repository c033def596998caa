"""Edges: RANSAC looks for a side, trial by trial, while you move its threshold. The slider of lesson 04.

>>> edges()
Slider: trial, threshold, noise, seed
>>> from primkit.widgets.svg import what_it_says
>>> what_it_says(edges().draw(trial=1))
'Trial 1 draws two points and finds 10 inliers of 435; the best so far is trial 1 with 10.'
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import cache

import numpy as np
from numpy.typing import ArrayLike

from ..arguments import Floats
from ..grid import Grid
from ..lidar import Lidar, scan
from ..lines import LINE, Line
from ..palette import BLUE, CLUSTER_COLORS, GREY, INK, ORANGE, SKY, VERMILION
from ..ransac import draw_samples
from ..robot import teleport_poses
from ..shapes import Polygon
from ..table import count
from ..world import World
from .drawing import Frame, idea_frame, picture, square_frame
from .slider import Explorer, Picture, Slider, explore

RECTANGLE = Polygon([(-0.13, -0.09), (0.13, -0.09), (0.13, 0.09), (-0.13, 0.09)]).moved((0.02, 0.01), 0.3)
MOST_TRIALS_SHOWN = 60
LINE_SIGNS = ("dot", "cross", "diamond", "triangle", "square", "triangle down", "ring")  # of the lines' points, in turn
TRIAL_LEGEND = (
    *(("this trial", VERMILION, "dashed"), ("its two points", VERMILION, "square")),
    ("best so far", BLUE, "line"),
)
LINE_REACH = 1.0  # m: half the length of a line that is drawn across the whole picture


def edges() -> Explorer:
    """Return the slider of lesson 04: the trials of RANSAC one after the other, and the threshold's band."""
    return explore(
        draw_edges,
        Slider("trial", 1, MOST_TRIALS_SHOWN, 1, start=10),
        Slider("threshold", 0.5, 20.0, 0.5, start=3.0, unit="mm"),
        Slider("noise", 0.0, 6.0, 1.0, start=1.0, unit="mm"),
        Slider("seed", 0, 9, 1, start=0),
        settings={
            "one trial": {"trial": 1},
            "ten trials": {},
            "sixty trials": {"trial": 60},
            "a pair too close": {"trial": 14, "seed": 2},
            "band thinner than the noise": {"trial": 60, "threshold": 1.0, "noise": 4.0},
            "band too wide": {"trial": 60, "threshold": 20.0},
        },
        diagram=draw_diagram,
    )


@cache
def seen_points(noise: float, seed: int) -> Floats:
    """Return the points of one rectangle, seen from all around with noise in mm, shape (N, 2), metres."""
    world = World([RECTANGLE])
    grid = Grid()
    grid.add(scan(world, teleport_poses(world), Lidar(noise_std=noise / 1000), rng=seed))
    return grid.points()


def draw_edges(trial: int, threshold: float, noise: float, seed: int) -> str:
    """Draw one trial and the best up to it: threshold and noise in mm."""
    points, reach = seen_points(noise, seed), threshold / 1000
    samples = draw_samples(len(points), 2, MOST_TRIALS_SHOWN, np.random.default_rng(seed))[:trial]
    lines = LINE.from_samples(points[samples])
    near = LINE.residuals(lines, points) <= reach
    counts = np.count_nonzero(near, axis=1)
    best, now = int(np.argmax(counts)), trial - 1
    x, y = RECTANGLE.centroid.tolist()
    frame = square_frame((x, y), 0.38)
    return picture(
        frame,
        _band(frame, Line(*lines[now]), reach, ORANGE),
        _band(frame, Line(*lines[best]), reach, SKY),
        frame.points(points[~near[best]], GREY, size=2.6),
        frame.points(points[near[best]], BLUE, size=4.5),
        _across(frame, Line(*lines[best]), BLUE, 2),
        _across(frame, Line(*lines[now]), VERMILION, 2, "7 4"),
        frame.points(points[samples[now]], VERMILION, "square", 11),
        title=f"After {count(trial, 'trial')}: {counts[best]} of {len(points)} points agree",
        says=f"Trial {trial} draws two points and finds {counts[now]} inliers of {len(points)}; "
        f"the best so far is trial {best + 1} with {counts[best]}.",
        legend=TRIAL_LEGEND,
    )


def show_lines(
    points: Floats,
    found: Iterable[tuple[Line, ArrayLike]],
    title: str,
    says: str,
    *,
    truth: Polygon | None = None,
    center: ArrayLike | None = None,
    size: float = 0.36,
) -> Picture:
    """Return a picture of lines, each with its points; points of no line are grey.

    ``found`` holds a line and a mask over the points, or their indices, for each; ``truth`` is drawn dashed;
    ``center`` and ``size`` in metres choose a piece of the board, all around the points when not given.
    """
    middle = points.mean(axis=0) if center is None else np.asarray(center)
    frame = square_frame((float(middle[0]), float(middle[1])), size)
    small = size > 0.2  # points on the whole shape; larger ones where a piece is magnified
    parts = [frame.points(points, GREY, size=3 if small else 6)]
    for k, (line, which) in enumerate(found):
        color, own = CLUSTER_COLORS[k % len(CLUSTER_COLORS)], points[np.asarray(which)]
        parts.append(frame.points(own, color, LINE_SIGNS[k % len(LINE_SIGNS)], 4.5 if small else 8))
        parts.append(_along(frame, line, own, color))
    outline = "" if truth is None else frame.shape(truth, INK, 1.2, "6 4", fill=0)
    return Picture(picture(frame, *parts, outline, title=title, says=says), title)


def draw_diagram() -> Picture:
    """Return the drawing behind the lesson's formula: a line n . p = d, its band, and a point's distance."""
    line, t = Line(np.radians(55), 0.2), 0.045
    n, u = line.normal, line.direction
    foot, p = line.offset * n, line.offset * n - 0.16 * u + 0.09 * n
    inliers = foot + np.outer([-0.27, -0.21, 0.05, 0.11, 0.17], u) + np.outer([0.02, -0.03, 0.015, -0.02, 0.03], n)
    on_line, turn = foot + 0.16 * u, np.linspace(0, line.angle, 30)
    frame = idea_frame((-0.14, 0.41), (-0.05, 0.35), 525)
    svg = picture(
        frame,
        _band(frame, line, t, SKY),
        _across(frame, line, BLUE, 3),
        frame.segments([on_line], [on_line + t * n], INK, 2),
        frame.segments([(0, 0)], [(0.11, 0)], GREY, 1.5, "5 4"),
        frame.polyline(0.05 * np.column_stack([np.cos(turn), np.sin(turn)]), INK, 1.5),
        frame.segments([(0, 0)], [foot], INK, 1.5, "5 4"),
        frame.arrow((0, 0), 0.1 * n, VERMILION, 5),
        frame.segments([p], [p - 0.09 * n], ORANGE, 3),
        frame.points([(0, 0)], INK, "square", 8),
        frame.points(inliers, BLUE, size=8),
        frame.points([p], ORANGE, "ring", 13),
        frame.text((0, 0), "origin", GREY, "end", (-8, 16), 14),
        frame.text((0.05, 0.015), "θ", INK, shift=(6, 0), size=16),
        frame.text((0.11, 0), "parallel to x", GREY, shift=(5, 5), size=13),
        frame.text(on_line + 0.5 * t * n, "t", INK, shift=(7, 6), size=16),
        frame.text(0.06 * n, "n (drawn short)", VERMILION, shift=(14, 6), size=14),
        frame.text(0.17 * n, "d", INK, shift=(-20, 0), size=16),
        frame.text(p, "p", INK, shift=(10, -8), size=16),
        frame.text(p - 0.045 * n, "|n · p - d|", INK, shift=(12, 8), size=15),
        frame.text((0.12, 0.25), "the band: at most t away", BLUE, size=14),
        title="A line is a direction across it, and an offset",
        says="A line with its normal n at the bearing θ and its offset d from the origin; five points lie in the band "
        "of t to each side, and p does not.",
    )
    return Picture(svg, "Diagram: a line in normal form, and its band")


def _across(frame: Frame, line: Line, color: str, width: float, dash: str = "") -> str:
    """Draw a line from edge to edge."""
    foot, along = line.offset * line.normal, LINE_REACH * line.direction
    return frame.segments([foot - along], [foot + along], color, width, dash)


def _along(frame: Frame, line: Line, own: Floats, color: str) -> str:
    """Draw a line as far as its points reach."""
    if len(own) == 0:
        return ""
    places = own @ line.direction
    ends = line.offset * line.normal + np.outer([places.min(), places.max()], line.direction)
    return frame.segments(ends[:1], ends[1:], color, 2)


def _band(frame: Frame, line: Line, reach: float, color: str) -> str:
    """Draw what is within ``reach`` metres of a line."""
    along, aside = LINE_REACH * line.direction, reach * line.normal
    foot = line.offset * line.normal
    corners: Sequence[Floats] = (foot - along - aside, foot + along - aside, foot + along + aside, foot - along + aside)
    return frame.area(np.array(corners), color, 0.25)
