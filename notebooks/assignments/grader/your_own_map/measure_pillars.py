"""A hunt for three bugs: pillars measured by robots that look in any direction.

In:  the student's ``measure_pillars``.
Out: marks.

>>> MEASURE_PILLARS.mark(pillars)
6.0
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

import primkit as pk

from ..parts import TURN, Fault, shown, task

Floats = NDArray[np.float64]


def pillars(poses: Floats, angles: Floats, ranges: Floats, range_max: float) -> Floats:
    """Return (x, y, radius) of each pillar, shape (K, 3), metres; a reading of range_max is no hit."""
    return with_bugs()(poses, angles, ranges, range_max)


def with_bugs(*bugs: str) -> Callable[..., Floats]:
    """Return the function with some of its bugs: "limit", "heading", "mean", "box"."""

    def measured_pillars(poses: Floats, angles: Floats, ranges: Floats, range_max: float) -> Floats:
        hit = ranges <= range_max if "limit" in bugs else ranges < range_max
        heading = -poses[:, 2:] if "heading" in bugs else poses[:, 2:]
        bearing = (heading + angles)[hit]
        places = np.repeat(poses[:, None, :2], len(angles), axis=1)[hit]
        points = places + ranges[hit][:, None] * np.column_stack([np.cos(bearing), np.sin(bearing)])
        labels = pk.link(points)
        return np.array([circle_of(points[labels == k], bugs) for k in range(labels.max(initial=-1) + 1)])

    return measured_pillars


def circle_of(points: Floats, bugs: tuple[str, ...]) -> tuple[float, float, float]:
    """Return x, y and radius of a circle through points, around their mean, or in the box around them."""
    if "box" in bugs:
        x, y = (points.min(axis=0) + points.max(axis=0)) / 2
        return float(x), float(y), float(np.ptp(points, axis=0).max() / 2)
    if "mean" in bugs:
        x, y = points.mean(axis=0)
        return float(x), float(y), float(np.hypot(*(points - (x, y)).T).mean())
    circle = pk.fit_circle(points)
    return (np.nan, np.nan, np.nan) if circle is None else (*circle.center.tolist(), circle.radius)


def judge_pillars(got: Any, expected: Any, _args: tuple[Any, ...]) -> str | None:
    """Judge circles in any order, within 2 mm."""
    try:
        rows = np.asarray(got, dtype=float)
    except (TypeError, ValueError):
        return f"got {shown(got)}, expected rows (x, y, radius)"
    if rows.ndim != 2 or rows.shape[1] != 3:
        return f"got {shown(got)}, expected rows (x, y, radius)"
    if len(rows) != len(expected):
        return f"got {len(rows)} pillar{'s' * (len(rows) != 1)}, expected {len(expected)}"
    for row in expected:
        mine = rows[np.argmin(np.hypot(*(rows[:, :2] - row[:2]).T))]
        off = 1000 * (mine - row)
        if not np.hypot(*off[:2]) <= 2:
            return f"the centre of a pillar is off by {np.hypot(*off[:2]):.0f} mm"
        if not abs(off[2]) <= 2:
            return f"the radius of a pillar is off by {off[2]:+.0f} mm"
    return None


def stands(rng: np.random.Generator) -> list[pk.Circle]:
    """Return one or two pillars, far apart."""
    places = np.array([(-0.25, 0.2), (0.25, -0.2)])[: int(rng.integers(1, 3))]
    return [pk.Circle(place + rng.uniform(-0.03, 0.03, 2), rng.uniform(0.05, 0.08)) for place in places]


def aimed(rng: np.random.Generator, views: int) -> tuple[list[pk.Circle], Floats]:
    """Return pillars, and poses evenly around each of them, 12 cm before its outline and looking at it."""
    some = stands(rng)
    turns = rng.uniform(0, TURN) + TURN * np.arange(views) / views
    rows = []
    for pillar in some:
        ring = pillar.center + (pillar.radius + 0.12) * np.column_stack([np.cos(turns), np.sin(turns)])
        rows.append(np.column_stack([ring, turns + np.pi]))
    return some, np.vstack(rows)


def readings(some: list[pk.Circle], poses: Floats, angles: Floats, range_max: float) -> tuple[Any, ...]:
    """Return the arguments of one call: what the sensor reads, its limit where nothing is hit."""
    ranges = pk.cast_rays(pk.World(some), poses, angles, range_max=range_max)
    return poses, angles, np.minimum(ranges, range_max), range_max


def turned_robots(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield robots that look at pillars from all sides; every beam hits."""
    for _ in range(8):
        some, poses = aimed(rng, 24)
        yield readings(some, poses, np.linspace(-0.2, 0.2, 11), 1.0)


def readings_at_the_limit(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield robots that all look along x, with beams all around; most beams hit nothing."""
    for _ in range(5):
        some, poses = aimed(rng, 36)
        yield readings(some, poses * [1.0, 1.0, 0.0], TURN * np.arange(120) / 120, 0.2)


def seen_from_one_side(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield robots that look along x at a pillar before them; every beam hits."""
    for _ in range(8):
        (pillar, *_) = stands(rng)
        side = np.linspace(-0.2, 0.2, 5) * pillar.radius
        x, y = pillar.center
        poses = np.column_stack([np.full(5, x - pillar.radius - 0.1), y + side, np.zeros(5)])
        yield readings([pillar], poses, np.linspace(-0.2, 0.2, 15), 1.0)


HINTS = {
    "heading": "A bug is left: draw the hits of one turned robot. Do bearings count from its heading?",
    "limit": "A bug is left: what does this sensor read where nothing is hit, and what becomes of it?",
    "mean": "A bug is left: where is the mean of points on one side of a circle?",
    "box": "A bug is left: where is the middle of a box around points on one side of a circle?",
}
NAMES = {
    "heading": "heading subtracted",
    "limit": "limit taken for a hit",
    "mean": "mean taken for the centre",
    "box": "box taken for the circle",
}
# The bug that shows, and those that are left; where only one of them shows, it is found alone.
LEFT = (
    *(("heading", "heading"), ("limit", "limit"), ("mean", "mean"), ("box", "box")),
    *(("heading", "heading", "mean"), ("limit", "limit", "mean"), ("limit", "limit", "heading", "mean")),
)

MEASURE_PILLARS = task(
    "measure_pillars",
    pillars,
    judge_pillars,
    (
        ("robots that look in any direction", 2, turned_robots),
        ("beams that hit nothing", 2, readings_at_the_limit),
        ("pillars seen from one side", 2, seen_from_one_side),
    ),
    tuple(Fault(HINTS[bug], like=with_bugs(*bugs), name=NAMES[bug]) for bug, *bugs in LEFT),
)
