"""Arcs: the circle through many points, and how near it comes to them; the checks of lesson 05.

In:  the student's ``fit_circle(points)`` and ``circle_rms(points, center, radius)``.
Out: answers. The first returns (x, y, radius) in metres, or None for points that fix no circle; the second metres.

A fit is right when it is Kasa's, or at least as near to the points: Pratt's, Taubin's and the geometric one pass.

>>> fit_circle(lambda points: ...)
○ not attempted: fit_circle still returns `...`.
>>> circle_rms.reference(np.array([(0.3, 0.0), (0.0, 0.1)]), np.zeros(2), 0.2).round(3)
np.float64(0.1)
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from ..arguments import Floats
from ..circles import fit_circle as library_fit
from ..shapes import Circle
from . import judges
from .answer import Case, Check, Fault, off_only_where
from .cases import RANDOM_CASES, Args, around
from .judges import as_circle, is_pair, shown

XYR = tuple[float, float, float]

BINARY = 1024  # coordinates in 1/1024 m are exact in binary: points on a line are so to the last bit
AS_NEAR = 1e-6  # of the RMS: far above rounding


def kasa(points: Floats) -> XYR | None:
    """Return (x, y, radius) of Kasa's circle; None for points that fix none."""
    found = library_fit(points, "kasa")
    return None if found is None else (*np.round(found.center, 12).tolist(), found.radius)  # 0, not 1e-17


def rms(points: Floats, center: Floats, radius: float) -> Any:
    """Return the root of the mean of the squared radial residuals, metres."""
    return np.sqrt(np.mean(_residuals(points, center, radius) ** 2))


def _residuals(points: Floats, center: Floats, radius: float) -> Floats:
    """Return how far outside the circle each point lies, metres."""
    residuals: Floats = np.hypot(*(points - center).T) - radius
    return residuals


_same_circle = judges.circle()


def _as_good(got: Any, expected: Any, args: Args) -> str | None:
    """Judge a circle: the expected one, or one that lies as near to the points as Kasa's or Pratt's."""
    if isinstance(got, Circle) or is_pair(got):  # the lesson goes on with three
        return f"got {shown(got)}, expected three numbers: x, y and radius in metres"
    off = _same_circle(got, expected, args)
    mine, reference = as_circle(got), kasa(args[0])
    if off is None or mine is None or reference is None or not np.isfinite(mine).all():
        return off
    circles = [circle for circle in (mine, reference, as_circle(library_fit(args[0], "pratt"))) if circle]
    near, *others = (rms(args[0], np.array(each[:2]), each[2]) for each in circles)
    return None if near <= (1 + AS_NEAR) * max(others) else off


def _on_arc(rng: np.random.Generator, n: int, turn: float, noise: float) -> tuple[Floats, Floats, float]:
    """Return n points along a part of a random circle, with its centre and radius; noise in radii."""
    center, radius = rng.uniform(-0.4, 0.4, 2), float(rng.uniform(0.04, 0.2))
    bearings = rng.uniform(0, 2 * np.pi) + turn * (np.arange(n) + rng.uniform(0.2, 0.8, n)) / n
    reach = radius * (1 + noise * rng.standard_normal(n))
    return around(center, reach, bearings), center, radius


def _fit_cases(rng: np.random.Generator) -> Iterator[Args]:
    """Yield exact circles, points that fix none, then arcs with and without noise."""
    quarters = np.array([(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)])
    yield (0.1 * quarters,)
    yield (np.array([0.3, 0.2]) + 0.1 * quarters,)
    yield (np.array([0.3, 0.2]) + 0.1 * quarters[:3],)
    for n in range(RANDOM_CASES):
        if n % 20 == 10:  # on one line
            start, step = rng.integers(-200, 200, 2), np.array([3, -2]) * (n // 20 + 1)
            yield ((start + np.arange(3 + n % 5)[:, None] * step) / BINARY,)
        else:
            noise = 0.0 if n % 3 == 0 else float(rng.uniform(0.01, 0.05))
            yield (_on_arc(rng, int(rng.integers(8, 60)), float(rng.uniform(np.pi / 2, 2 * np.pi)), noise)[0],)
    yield (0.1 * quarters[:2],)  # too few


def _rms_cases(rng: np.random.Generator) -> Iterator[Args]:
    """Yield a point outside, one outside and one inside, all outside, then arcs beside a circle of another size."""
    yield np.array([(0.3, 0.4)]), np.zeros(2), 0.4
    yield np.array([(0.3, 0.0), (0.0, 0.1)]), np.zeros(2), 0.2
    yield np.array([(0.3, 0.0), (0.0, 0.3), (-0.3, 0.0)]), np.zeros(2), 0.2
    for _ in range(RANDOM_CASES):
        points, center, radius = _on_arc(rng, int(rng.integers(3, 40)), float(rng.uniform(1, 2 * np.pi)), 0.05)
        yield points, center + rng.uniform(-0.02, 0.02, 2), radius * float(rng.uniform(0.8, 1.2))


def _gives(wrong: Callable[[Floats], XYR | None]) -> Callable[[list[Case]], bool]:
    """Tell whether a faulty way gives the same circles; what comes for points that fix none is another fault."""

    def when(cases: list[Case]) -> bool:
        there = [case for case in cases if case.expected is not None]
        return all(_same_circle(case.got, wrong(case.args[0]), case.args) is None for case in there)

    return when


def _by_mean(points: Floats) -> XYR:
    center = points.mean(axis=0)
    return (*center.tolist(), float(np.hypot(*(points - center).T).mean()))


def _last_step(change: Callable[[float, float, float], XYR]) -> Callable[[Floats], XYR]:
    """Return Kasa's fit with a faulty last step, from the solution (a, b, k) on."""

    def fit(points: Floats) -> XYR:
        a, b, r = kasa(points) or (np.nan,) * 3
        return change(a, b, r * r - a * a - b * b)

    return fit


def _root_of_k(cases: list[Case]) -> bool:
    """Tell whether the radius is the root of k; nan where k is below zero."""
    for case in cases:
        if case.expected is not None:
            (a, b, r), mine = case.expected, as_circle(case.got)
            with np.errstate(invalid="ignore"):
                wanted = (a, b, np.sqrt(r * r - a * a - b * b))
            if mine is None or not np.allclose(mine, wanted, rtol=0.0, atol=1e-6, equal_nan=True):
                return False
    return True


_TWICE = "The centre is twice as far out as it is: the equation has 2 a x and 2 b y in it, not a x and b y."

fit_circle = Check(
    "fit_circle",
    kasa,
    _fit_cases,
    _as_good,
    (
        Fault(
            "Every circle is right. Where the points fix none, return None: see the rank.",
            when=off_only_where(lambda case: case.expected is None),
        ),
        Fault("The mean of the points is the centre only when they lie all around it.", when=_gives(_by_mean)),
        Fault("The last number of the solution is k, and k = r² - a² - b²: it is not r² yet.", when=_root_of_k),
        Fault(
            "The radius comes out squared: is a root missing?",
            when=_gives(_last_step(lambda a, b, k: (a, b, k + a * a + b * b))),
        ),
        Fault(
            _TWICE, when=_gives(_last_step(lambda a, b, k: (2 * a, 2 * b, max(k + 4 * a * a + 4 * b * b, 0) ** 0.5)))
        ),
        Fault(_TWICE, when=_gives(_last_step(lambda a, b, k: (2 * a, 2 * b, (k + a * a + b * b) ** 0.5)))),
        Fault(
            "That circle goes through the first three points: all points should have a say in it.",
            when=_gives(lambda points: kasa(points[:3])),
        ),
    ),
)


def _from_residuals(number: Callable[[Floats], Any]) -> Callable[[Floats, Floats, float], float]:
    """Return a faulty way that makes something else of the residuals."""
    return lambda *args: float(number(_residuals(*args)))


circle_rms = Check(
    "circle_rms",
    rms,
    _rms_cases,
    judges.number("m"),
    (
        Fault(
            "Residuals outside and inside cancel each other: square them first.",
            like=(_from_residuals(np.mean), _from_residuals(lambda e: abs(np.mean(e)))),
        ),
        Fault("That is in square metres: is a root missing?", like=_from_residuals(lambda e: np.mean(e**2))),
        Fault("More points make it larger: mean, not sum.", like=_from_residuals(lambda e: np.sqrt(np.sum(e**2)))),
        Fault(
            "Points that all lie 1 cm outside give 0: a standard deviation takes the residuals' mean off first.",
            like=_from_residuals(np.std),
        ),
        Fault(
            "That is the mean of the distances; RMS squares them first.", like=_from_residuals(lambda e: abs(e).mean())
        ),
        Fault("Those are distances to the centre: subtract the radius.", like=lambda p, c, _r: rms(p, c, 0.0)),
        Fault(
            "That compares squared lengths, as Kasa's fit does: compare the lengths.",
            like=lambda p, c, r: np.sqrt(np.mean((((p - c) ** 2).sum(axis=1) - r**2) ** 2)),
        ),
    ),
)
