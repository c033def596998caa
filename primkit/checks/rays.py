"""Rays: where a beam meets a wall, and where a circle; the checks of lesson 01.

In:  the student's ``ray_segment(origin, direction, a, b)`` and ``ray_circle(origin, direction, center, radius)``.
Out: answers. Both return the distance in metres to the nearest hit ahead, and ``inf`` where there is none.

>>> ray_segment(lambda origin, direction, a, b: ...)
○ not attempted: ray_segment still returns `...`.
>>> float(ray_circle.reference(np.zeros(2), np.array([1.0, 0.0]), np.array([1.0, 0.0]), 0.25))
0.75
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from ..arguments import Floats
from .answer import Case, Check, Fault
from .judges import number

RANDOM_CASES = 200
EDGE = 1e-6  # m: cases in which rounding alone decides between hit and miss are left out
INF = float("inf")


def hit_segment(origin: Floats, direction: Floats, a: Floats, b: Floats) -> float:
    """Return the distance along the beam to the side from a to b, metres; inf without a hit ahead.

    ``direction`` has length 1. Solves ``origin + t direction = a + s (b - a)``.
    """
    side, to_a = b - a, a - origin
    cross = _cross(direction, side)
    if cross == 0:  # the beam runs along the side's direction: no single point
        return INF
    t, s = _cross(to_a, side) / cross, _cross(to_a, direction) / cross
    return float(t) if t >= 0 and 0 <= s <= 1 else INF


def hit_circle(origin: Floats, direction: Floats, center: Floats, radius: float) -> float:
    """Return the distance along the beam to the circle, metres; inf without a hit ahead.

    ``direction`` has length 1. From inside, the beam meets the circle on its way out.
    """
    to_center = center - origin
    along = float(to_center @ direction)
    under_root = radius**2 - (to_center @ to_center - along**2)
    if under_root < 0:
        return INF
    root = float(np.sqrt(under_root))
    return next((t for t in (along - root, along + root) if t >= 0), INF)


def _cross(u: Floats, v: Floats) -> Any:
    return u[0] * v[1] - u[1] * v[0]


def _segment_cases(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield plain walls ahead, behind and beside, then random ones."""
    east, wall = np.array([1.0, 0.0]), (np.array([0.2, -0.1]), np.array([0.2, 0.1]))
    yield np.zeros(2), east, *wall
    yield np.zeros(2), -east, *wall  # behind
    yield np.array([0.0, 0.3]), east, *wall  # beside
    yield np.zeros(2), east, np.array([0.1, 0.1]), np.array([0.3, 0.1])  # parallel
    yield np.array([0.1, 0.0]), np.array([0.6, 0.8]), np.array([0.0, 0.2]), np.array([0.5, 0.2])
    n = 0
    while n < RANDOM_CASES:
        origin, a, b = rng.uniform(-0.5, 0.5, (3, 2))
        aim = (a + rng.uniform(-0.3, 1.3) * (b - a)) - origin
        direction = (aim if n % 4 else -aim) / np.hypot(*aim)
        cross = _cross(direction, b - a)
        s = _cross(a - origin, direction) / cross
        if min(abs(s), abs(1 - s)) > EDGE and abs(cross) > 1e-3 and np.hypot(*aim) > EDGE:
            n += 1
            yield origin, direction, a, b


def _circle_cases(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield a circle ahead, behind, beside and around, then random ones."""
    east, center = np.array([1.0, 0.0]), np.array([0.3, 0.0])
    yield np.zeros(2), east, center, 0.1
    yield np.zeros(2), -east, center, 0.1  # behind
    yield np.array([0.0, 0.2]), east, center, 0.1  # beside
    yield np.array([0.25, 0.0]), east, center, 0.1  # from inside
    yield np.zeros(2), np.array([0.6, 0.8]), np.array([0.18, 0.24]), 0.05
    n = 0
    while n < RANDOM_CASES:
        origin, center = rng.uniform(-0.5, 0.5, (2, 2))
        radius = float(rng.uniform(0.03, 0.25))
        to_center = center - origin
        aim = to_center + rng.uniform(-1.3, 1.3) * radius * np.array([-to_center[1], to_center[0]]) / np.hypot(
            *to_center
        )
        direction = (aim if n % 4 else -aim) / np.hypot(*aim)
        aside = abs(_cross(direction, to_center))
        if abs(aside - radius) > EDGE and abs(np.hypot(*to_center) - radius) > EDGE:
            n += 1
            yield origin, direction, center, radius


def _without(*forgotten: str) -> Any:
    """Return the segment's hit with conditions forgotten."""

    def hit(origin: Floats, direction: Floats, a: Floats, b: Floats) -> float:
        side, to_a = b - a, a - origin
        cross = _cross(direction, side)
        if cross == 0:
            return INF
        t, s = _cross(to_a, side) / cross, _cross(to_a, direction) / cross
        return float(t) if ("t" in forgotten or t >= 0) and ("s" in forgotten or 0 <= s <= 1) else INF

    return hit


def _turned(sign_t: int, sign_s: int) -> Any:
    """Return the segment's hit with a sign turned round in t or in s."""

    def hit(origin: Floats, direction: Floats, a: Floats, b: Floats) -> float:
        side, to_a = b - a, a - origin
        cross = _cross(direction, side)
        if cross == 0:
            return INF
        t, s = sign_t * _cross(to_a, side) / cross, sign_s * _cross(to_a, direction) / cross
        return float(t) if t >= 0 and 0 <= s <= 1 else INF

    return hit


def _share_of_side(origin: Floats, direction: Floats, a: Floats, b: Floats) -> float:
    """Return s, how far along the side the hit lies, for t."""
    if hit_segment(origin, direction, a, b) == INF:
        return INF
    return float(_cross(a - origin, direction) / _cross(direction, b - a))


def _roots(which: str) -> Any:
    """Return the circle's hit with the wrong choice between its two roots."""

    def hit(origin: Floats, direction: Floats, center: Floats, radius: float) -> float:
        to_center = center - origin
        along = float(to_center @ direction)
        under_root = radius**2 - (to_center @ to_center - along**2)
        if under_root < 0:
            return INF
        near, far = along - float(np.sqrt(under_root)), along + float(np.sqrt(under_root))
        if which == "far":
            return far if far >= 0 else INF
        if which == "near alone":
            return near if near >= 0 else INF
        return near if which == "behind" else float(near if far >= 0 else INF)

    return hit


def _to_the_center(origin: Floats, direction: Floats, center: Floats, radius: float) -> float:
    """Return the distance to the foot of the perpendicular, instead of to the outline."""
    hit = hit_circle(origin, direction, center, radius)
    return hit if hit == INF else float((center - origin) @ direction)


def _from_the_center(origin: Floats, direction: Floats, center: Floats, radius: float) -> float:
    """Return the hit with w from the centre to the robot, instead of from the robot to the centre."""
    return hit_circle(center, direction, origin, radius)


def _not_squared(origin: Floats, direction: Floats, center: Floats, radius: float) -> float:
    """Return the circle's hit with the length of w under the root, instead of its square."""
    to_center = center - origin
    along = float(to_center @ direction)
    under_root = radius**2 - (float(np.hypot(*to_center)) - along**2)
    if under_root < 0:
        return INF
    root = float(np.sqrt(under_root))
    return next((t for t in (along - root, along + root) if t >= 0), INF)


def _two_numbers(cases: list[Case]) -> bool:
    """Tell whether two numbers came back, at least for the hits."""
    wrong = [case.got for case in cases if case.off]
    return all((isinstance(got, np.ndarray) and got.shape == (2,)) or _pair(got) for got in wrong)


def _pair(got: Any) -> bool:
    return isinstance(got, (tuple, list)) and len(got) == 2


def _none_for_a_miss(cases: list[Case]) -> bool:
    """Tell whether all misses, and nothing else, came back as None."""
    misses = [case for case in cases if case.expected == INF]
    return all(case.got is None for case in misses) and not any(case.off for case in cases if case.expected != INF)


def _nan_for_a_miss(cases: list[Case]) -> bool:
    """Tell whether misses came back as NaN."""
    return any(isinstance(case.got, float) and np.isnan(case.got) for case in cases if case.expected == INF)


_NONE = Fault(
    "Every hit is right. A beam that meets nothing must return float('inf'), not None.", when=_none_for_a_miss
)

ray_segment = Check(
    "ray_segment",
    hit_segment,
    _segment_cases,
    number("m"),
    (
        _NONE,
        Fault("Two numbers came back: only t, the distance along the beam, is asked for.", when=_two_numbers),
        Fault("When is there no hit? Neither t nor s is looked at yet.", like=_without("t", "s")),
        Fault("The sign of t is turned round: v x w and w x v have opposite signs.", like=_turned(-1, 1)),
        Fault("The sign of s is turned round: v x w and w x v have opposite signs.", like=_turned(1, -1)),
        Fault("Walls behind the robot are hit too: is t >= 0 asked for?", like=_without("t")),
        Fault("The wall is hit beyond its ends: is 0 <= s <= 1 asked for?", like=_without("s")),
        Fault("That is s, the place along the wall, and not t, the distance along the beam.", like=_share_of_side),
    ),
)

ray_circle = Check(
    "ray_circle",
    hit_circle,
    _circle_cases,
    number("m"),
    (
        _NONE,
        Fault("Two numbers came back: only the distance to the first hit is asked for.", when=_two_numbers),
        Fault("Some misses come back as nan: is the number under the root below zero?", when=_nan_for_a_miss),
        Fault("w is turned round: it goes from the robot to the centre, c minus origin.", like=_from_the_center),
        Fault("Under the root stands the square of the length of w: is it squared?", like=_not_squared),
        Fault("That is the far side of the circle: of the two roots, which one is met first?", like=_roots("far")),
        Fault("Circles behind the robot are hit too: is t >= 0 asked for?", like=_roots("behind")),
        Fault("From inside a circle the first root is negative and the second one counts.", like=_roots("near alone")),
        Fault("From inside a circle the first root is negative and the second one counts.", like=_roots("inside")),
        Fault(
            "That is the distance to the point nearest the centre: the outline comes half a chord earlier.",
            like=_to_the_center,
        ),
    ),
)
