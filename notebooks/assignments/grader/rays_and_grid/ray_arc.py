"""A beam and a curved wall: where it meets the part of a circle that is built.

In:  the student's ``ray_arc``.
Out: marks.

>>> RAY_ARC.mark(hit_arc)
4.0
"""

# ruff: noqa: ARG005 (a wrong way may leave out what it is given)

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from primkit.checks.judges import number

from ..parts import EDGE, INF, TURN, Fault, task

Floats = NDArray[np.float64]

CASES = 60  # random ones, in each part


def roots(origin: Floats, direction: Floats, center: Floats, radius: float) -> tuple[float, float] | None:
    """Return where the beam's line goes into the full circle and out again, metres along it; None beside it."""
    to_center = center - origin
    along = float(to_center @ direction)
    under_root = radius**2 - (to_center @ to_center - along**2)
    return None if under_root < 0 else (along - float(np.sqrt(under_root)), along + float(np.sqrt(under_root)))


def bearing_of(origin: Floats, direction: Floats, center: Floats, t: float) -> float:
    """Return the bearing of the place t metres along the beam, seen from the centre, radians in (-pi, pi]."""
    x, y = origin + t * direction - center
    return float(np.arctan2(y, x))


def hit_arc(origin: Floats, direction: Floats, center: Floats, radius: float, start: float, sweep: float) -> float:
    """Return the distance along the beam to the curved wall, metres; inf without a hit ahead."""
    for t in roots(origin, direction, center, radius) or ():
        if t >= 0 and (bearing_of(origin, direction, center, t) - start) % TURN <= sweep:
            return t
    return INF


def arc_like(which: Any = (0, 1), ahead: Any = lambda t: t >= 0, on_wall: Any = None) -> Any:
    """Return a wrong way: other roots, another rule for what is ahead, or for what is on the wall."""

    def hit(origin: Floats, direction: Floats, center: Floats, radius: float, start: float, sweep: float) -> float:
        both = roots(origin, direction, center, radius)
        for t in [both[k] for k in which] if both else []:
            bearing = bearing_of(origin, direction, center, t)
            met = (bearing - start) % TURN <= sweep if on_wall is None else on_wall(bearing, start, sweep)
            if ahead(t) and met:
                return t
        return INF

    return hit


def bearing_from_robot(
    origin: Floats, direction: Floats, center: Floats, radius: float, start: float, sweep: float
) -> float:
    """Compare the beam's own bearing with the arc's."""
    bearing = float(np.arctan2(direction[1], direction[0]))
    return next(
        (t for t in roots(origin, direction, center, radius) or () if t >= 0 and (bearing - start) % TURN <= sweep), INF
    )


def arcs(
    rng: np.random.Generator, wanted: Any, *, start: tuple[float, float], sweep: tuple[float, float], ahead: bool = True
) -> Any:
    """Yield random beams and walls as wanted: ``wanted(inside, t of both roots, whether each is on the wall)``."""
    n = 0
    while n < CASES:
        center, radius = rng.uniform(-0.3, 0.3, 2), float(rng.uniform(0.05, 0.25))
        first, turn = float(rng.uniform(*start)), float(rng.uniform(*sweep))
        origin = center + rng.uniform(0.2, 3.0) * radius * unit(rng.uniform(0, TURN))
        aim = center + rng.uniform(0.0, 1.3) * radius * unit(rng.uniform(0, TURN)) - origin
        direction = (1 if ahead else -1) * aim / np.hypot(*aim)
        inside = bool(np.hypot(*(origin - center)) < radius)
        both = roots(origin, direction, center, radius)
        turns = [(bearing_of(origin, direction, center, t) - first) % TURN for t in both or ()]
        near_end = any(min(abs(b - turn), b, TURN - b) < EDGE for b in turns)
        aside = abs(float(direction[0] * (center - origin)[1] - direction[1] * (center - origin)[0]))
        if near_end or abs(aside - radius) < EDGE or (both and min(map(abs, both)) < EDGE):
            continue
        if wanted(inside, both, [b <= turn for b in turns]):
            n += 1
            yield origin, direction, center, radius, first, turn


def unit(bearing: float) -> Floats:
    """Return the arrow of length 1 at a bearing."""
    return np.array([np.cos(bearing), np.sin(bearing)])


UPPER = {"start": (0.0, 1.0), "sweep": (0.5, 2.1)}  # walls whose bearings stay within 0 and pi
DOWN, UP, WALL = np.array([0.0, -1.0]), np.array([0.0, 1.0]), (np.array([0.3, 0.0]), 0.1, 0.0, np.pi)


def near_side(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield beams from outside that meet the wall's near side, or pass the whole circle by."""
    yield np.array([0.3, 0.5]), DOWN, *WALL
    yield np.array([0.5, 0.5]), DOWN, *WALL  # beside
    yield np.array([0.0, 0.05]), np.array([1.0, 0.0]), *WALL  # the far side is built, too
    wanted = lambda inside, both, on: not inside and (not both or (both[0] > 0 and on[0]))  # noqa: E731
    yield from arcs(rng, wanted, **UPPER)


def opening(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield beams from outside that come in through the opening."""
    yield np.array([0.3, -0.5]), UP, *WALL
    yield np.array([0.5, -0.01]), np.array([-1.0, 0.0]), *WALL  # in through the opening, and out again
    wanted = lambda inside, both, on: both and not inside and both[0] > 0 and not on[0]  # noqa: E731
    yield from arcs(rng, wanted, **UPPER)


def over_the_end(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield walls that go on beyond the bearing at which bearings begin anew."""
    yield np.array([0.6, 0.0]), np.array([-1.0, 0.0]), np.array([0.3, 0.0]), 0.1, 1.5 * np.pi, np.pi
    yield np.zeros(2), np.array([1.0, 0.0]), np.array([0.3, 0.0]), 0.1, 0.75 * np.pi, 0.5 * np.pi
    wanted = lambda inside, both, on: both and not inside and both[0] > 0 and (on[0] or not on[1])  # noqa: E731
    for begin in (2.0, 5.0):
        yield from arcs(rng, wanted, start=(begin, begin + 1), sweep=(1.5, 4.0))


def inside_or_behind(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield beams from within the circle, and beams that look away from it."""
    yield np.array([0.3, 0.05]), UP, *WALL
    yield np.array([0.3, 0.5]), UP, *WALL  # behind
    yield from arcs(rng, lambda inside, both, on: inside and both and any(on), **UPPER)
    yield from arcs(rng, lambda inside, both, on: both and not inside and both[1] < 0 and any(on), **UPPER, ahead=False)


GOING_ROUND = "Bearings begin anew after a full turn, a wall does not. How far is it from start to hit, going round?"

RAY_ARC = task(
    "ray_arc",
    hit_arc,
    number("m"),
    (
        ("meets the near side of the wall", 1, near_side),
        ("comes in through the opening", 1, opening),
        ("walls that go on beyond bearing 0 or pi", 1, over_the_end),
        ("from inside, and with the wall behind", 1, inside_or_behind),
    ),
    (
        Fault(
            "Every hit is right. A beam that meets nothing must return float('inf'), not None.",
            when=lambda cases: (
                all((case.got is None) == (case.expected == INF) for case in cases)
                and not any(case.off for case in cases if case.expected != INF)
            ),
            name="None for no hit",
        ),
        Fault(
            "The distance is right but for its sign: one ahead is never negative.",
            like=lambda *args: hit_arc(*args) if hit_arc(*args) == INF else -hit_arc(*args),
            name="sign turned round",
        ),
        Fault(
            "The circle has two roots. When the first one falls into the opening, where does the beam go on to?",
            like=arc_like((0,)),
            name="near root alone",
        ),
        Fault(
            "That is the whole circle: is the hit on the part of it that is built?",
            like=arc_like(on_wall=lambda *_: True),
            name="whole circle for arc",
        ),
        Fault(
            "That is the far side where the near one is met first.", like=arc_like((1, 0)), name="far root before near"
        ),
        Fault(
            "Walls behind the robot are hit too: is t >= 0 asked for?",
            like=arc_like(ahead=lambda t: True),
            name="hits behind the robot",
        ),
        Fault(
            "The wall goes counter-clockwise from its start: here it goes the other way.",
            like=arc_like(on_wall=lambda b, start, sweep: (start - b) % TURN <= sweep),
            name="clockwise for counter-clockwise",
        ),
        Fault(
            GOING_ROUND,
            like=arc_like(on_wall=lambda b, start, sweep: start <= b <= start + sweep),
            name="bearing not wrapped",
        ),
        Fault(
            GOING_ROUND,
            like=arc_like(on_wall=lambda b, start, sweep: start <= b % TURN <= start + sweep),
            name="bearing not wrapped",
        ),
        Fault(
            "The second number is how far the wall goes on, not where it ends.",
            like=arc_like(on_wall=lambda b, start, sweep: (b - start) % TURN <= (sweep - start) % TURN),
            name="sweep taken for the end",
        ),
        Fault(
            "The bearing of a hit counts from the circle's centre, not from the robot.",
            like=bearing_from_robot,
            name="bearing from the robot",
        ),
    ),
)
