"""Rays: where a beam meets a wall, and where a circle; the checks of lesson 01.

In:  the student's ``ray_segment(origin, direction, a, b)`` and ``ray_circle(origin, direction, center, radius)``.
Out: answers. Both return the distance in metres to the nearest hit ahead, and ``inf`` where there is none.

>>> ray_segment(lambda origin, direction, a, b: ...)
○ not attempted: ray_segment still returns `...`.
>>> float(ray_circle.reference(np.zeros(2), np.array([1.0, 0.0]), np.array([1.0, 0.0]), 0.25))
0.75
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from ..arguments import Floats
from .answer import Check, Fault, off_only_where
from .cases import UNDECIDED, Args, random_cases
from .judges import is_pair, number, shown

INF = float("inf")


def hit_segment(origin: Floats, direction: Floats, a: Floats, b: Floats) -> float:
    """Return the distance along the beam to the side from a to b, metres; inf without a hit ahead.

    ``direction`` has length 1. Solves ``origin + t direction = a + s (b - a)``.
    """
    t, s = _crossing(origin, direction, a, b)
    return t if t >= 0 and 0 <= s <= 1 else INF


def hit_circle(origin: Floats, direction: Floats, center: Floats, radius: float) -> float:
    """Return the distance along the beam to the circle, metres; inf without a hit ahead.

    ``direction`` has length 1. From inside, the beam meets the circle on its way out.
    """
    return next((t for t in _roots(origin, direction, center, radius) if t >= 0), INF)


def _crossing(origin: Floats, direction: Floats, a: Floats, b: Floats) -> tuple[float, float]:
    """Return t and s of the point where beam and side meet; inf where they have the same direction."""
    side, to_a = b - a, a - origin
    cross = _cross(direction, side)
    return (float(_cross(to_a, side) / cross), float(_cross(to_a, direction) / cross)) if cross else (INF, INF)


def _roots(origin: Floats, direction: Floats, center: Floats, radius: float, power: int = 2) -> tuple[float, ...]:
    """Return the nearer and the farther t at which the line of the beam meets the circle; () where it does not."""
    to_center = center - origin
    along = float(to_center @ direction)
    under_root = radius**2 - (float(np.hypot(*to_center)) ** power - along**2)
    return () if under_root < 0 else (along - float(np.sqrt(under_root)), along + float(np.sqrt(under_root)))


def _cross(u: Floats, v: Floats) -> Any:
    return u[0] * v[1] - u[1] * v[0]


def _segment_cases(rng: np.random.Generator) -> Iterator[Args]:
    """Yield plain walls ahead, behind and beside, then random ones."""
    east, wall = np.array([1.0, 0.0]), (np.array([0.2, -0.1]), np.array([0.2, 0.1]))
    yield np.zeros(2), east, *wall
    yield np.zeros(2), -east, *wall  # behind
    yield np.array([0.0, 0.3]), east, *wall  # beside
    yield np.zeros(2), east, np.array([0.1, 0.1]), np.array([0.3, 0.1])  # parallel
    yield np.array([0.1, 0.0]), np.array([0.6, 0.8]), np.array([0.0, 0.2]), np.array([0.5, 0.2])
    for y in (0.25, -0.25):  # at a wall's end: it belongs to the wall, or beams would slip through at corners
        yield np.zeros(2), east, np.array([0.25, 0.0]), np.array([0.25, y])
        yield np.zeros(2), east, np.array([0.25, y]), np.array([0.25, 0.0])

    def draw(n: int) -> Args | None:
        origin, a, b = rng.uniform(-0.5, 0.5, (3, 2))
        aim = (a + rng.uniform(-0.3, 1.3) * (b - a)) - origin
        direction = (aim if n % 4 else -aim) / np.hypot(*aim)
        _, s = _crossing(origin, direction, a, b)
        clear = min(abs(s), abs(1 - s)) > UNDECIDED and abs(_cross(direction, b - a)) > 1e-3
        return (origin, direction, a, b) if clear and np.hypot(*aim) > UNDECIDED else None

    yield from random_cases(draw)


def _circle_cases(rng: np.random.Generator) -> Iterator[Args]:
    """Yield a circle ahead, behind, beside and around, then random ones."""
    east, center = np.array([1.0, 0.0]), np.array([0.3, 0.0])
    yield np.zeros(2), east, center, 0.1
    yield np.zeros(2), -east, center, 0.1  # behind
    yield np.array([0.0, 0.2]), east, center, 0.1  # beside
    yield np.array([0.25, 0.0]), east, center, 0.1  # from inside
    yield np.zeros(2), np.array([0.6, 0.8]), np.array([0.18, 0.24]), 0.05

    def draw(n: int) -> Args | None:
        origin, center = rng.uniform(-0.5, 0.5, (2, 2))
        radius, to_center = float(rng.uniform(0.03, 0.25)), center - origin
        across = np.array([-to_center[1], to_center[0]]) / np.hypot(*to_center)
        aim = to_center + rng.uniform(-1.3, 1.3) * radius * across
        direction = (aim if n % 4 else -aim) / np.hypot(*aim)
        edges = abs(_cross(direction, to_center)) - radius, np.hypot(*to_center) - radius
        return (origin, direction, center, radius) if np.abs(edges).min() > UNDECIDED else None

    yield from random_cases(draw)


def _segment(change: Callable[[float, float], float]) -> Callable[..., float]:
    """Return a faulty hit of a wall, from t and s on."""
    return lambda *args: change(*_crossing(*args))


def _on_side(t: float, s: float) -> float:
    return t if 0 <= s <= 1 else INF


def _ahead(t: float) -> float:
    return t if t >= 0 else INF


def _circle(change: Callable[[float, float], float], power: int = 2) -> Callable[..., float]:
    """Return a faulty hit of a circle, from its two roots on; ``power`` 1: |w| under the root, and not its square."""

    def hit(origin: Floats, direction: Floats, center: Floats, radius: float) -> float:
        roots = _roots(origin, direction, center, radius, power)
        return change(*roots) if roots else INF

    return hit


def _first(near: float, far: float) -> float:
    return near if near >= 0 else _ahead(far)


_NONE = Fault(
    "Every hit is right. A beam that meets nothing must return float('inf'), not None.",
    when=off_only_where(lambda case: case.got is None and case.expected == INF),
)
_TWO = off_only_where(lambda case: is_pair(case.got) or getattr(case.got, "shape", ()) == (2,))

ray_segment = Check(
    "ray_segment",
    hit_segment,
    _segment_cases,
    number("m"),
    (
        _NONE,
        Fault("Two numbers came back: only t, the distance along the beam, is asked for.", when=_TWO),
        Fault("When is there no hit? Neither t nor s is looked at yet.", like=_segment(lambda t, _s: t)),
        Fault("Walls behind the robot are hit too: is t >= 0 asked for?", like=_segment(_on_side)),
        Fault("The wall is hit beyond its ends: is 0 <= s <= 1 asked for?", like=_segment(lambda t, _s: _ahead(t))),
        Fault(
            "That is s, the place along the wall, and not t, the distance along the beam.",
            like=_segment(lambda t, s: s if _on_side(_ahead(t), s) < INF else INF),
        ),
    ),
)

ray_circle = Check(
    "ray_circle",
    hit_circle,
    _circle_cases,
    number("m"),
    (
        _NONE,
        Fault("Two numbers came back: only the distance to the first hit is asked for.", when=_TWO),
        Fault(
            "Some misses come back as nan: is the number under the root below zero?",
            when=lambda cases: any(shown(case.got) == "nan" for case in cases if case.expected == INF),
        ),
        Fault(
            "w is turned round: it goes from the robot to the centre, c minus origin.",
            like=lambda origin, direction, center, radius: hit_circle(center, direction, origin, radius),
        ),
        Fault("Under the root stands the square of the length of w: is it squared?", like=_circle(_first, power=1)),
        Fault(
            "That is the far side of the circle: of the two roots, which one is met first?",
            like=_circle(lambda _near, far: _ahead(far)),
        ),
        Fault("Circles behind the robot are hit too: is t >= 0 asked for?", like=_circle(lambda near, _far: near)),
        Fault(
            "From inside a circle the first root is negative and the second one counts.",
            like=(_circle(lambda near, _far: _ahead(near)), _circle(lambda near, far: near if far >= 0 else INF)),
        ),
        Fault(
            "That is the distance to the point nearest the centre: the outline comes half a chord earlier.",
            like=_circle(lambda near, far: (near + far) / 2 if far >= 0 else INF),
        ),
    ),
)
