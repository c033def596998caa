"""Problem set 3, circles and measuring: a pipe of known radius, a hexagon from six lines, its name, a radius's error.

In:  the student's ``pipe_center``, ``hexagon_corners``, ``nut_or_coin`` and ``radius_std``.
Out: marks.

>>> HEXAGON_CORNERS.mark(corners_of)
4.0
"""

# ruff: noqa: ARG005 (a wrong way may leave out what it is given)

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

import primkit as pk
from primkit.checks.answer import Case

from .parts import INF, TURN, Fault, numbers, shown, task

Floats = NDArray[np.float64]

CASES = 40  # random ones, in each part


# --- a pipe of known radius --------------------------------------------------------------------------------


def known_radius(points: Floats, radius: float) -> Floats | None:
    """Return the centre with the least squared gaps to a circle of this radius, on the far side of the points."""
    if len(np.unique(points, axis=0)) < 2:
        return None
    return np.round(gauss_newton(points, radius, beyond(points, radius)), 12) + 0.0  # 0 instead of 1e-18


def beyond(points: Floats, radius: float) -> Floats:
    """Return a first guess: a radius farther out than the points."""
    middle = points.mean(axis=0)
    return middle * (1 + radius / np.hypot(*middle))


def gauss_newton(points: Floats, radius: float, center: Floats) -> Floats:
    """Return the centre that a guess leads to."""
    for _ in range(100):
        away = points - center
        distance = np.hypot(*away.T)
        step = np.linalg.lstsq(-away / distance[:, None], radius - distance, rcond=None)[0]
        length = np.hypot(*step)
        center = center + step * min(1.0, radius / 2 / max(length, 1e-15))
        if length < 1e-12:
            break
    return center


def judge_center(got: Any, expected: Any, _args: tuple[Any, ...]) -> str | None:
    """Judge a centre, within half a millimetre."""
    if expected is None or got is None:
        return None if got is expected else f"got {shown(got)}, expected {shown(expected)}"
    place = numbers(got, 2)
    if place is None or not np.isfinite(place).all():
        return f"got {shown(got)}, expected the centre: two numbers in metres"
    off = float(np.hypot(*(np.array(place) - expected)))
    return None if off <= 0.0005 else f"the centre is off by {1000 * off:.2g} mm"


def pipe(rng: np.random.Generator, degrees: tuple[float, float], noise: float) -> tuple[Floats, float]:
    """Return hits on the near side of a pipe, a stretch of it that need not be the nearest, and its radius."""
    radius, away, bearing = rng.uniform(0.04, 0.12), rng.uniform(0.2, 0.5), rng.uniform(0, TURN)
    arc = np.radians(rng.uniform(*degrees))
    seen = np.arccos(radius / (away + radius))  # half of what is in view, from the centre
    first = rng.uniform(-seen, max(-seen, seen - arc))
    turns = bearing + np.pi + np.linspace(first, min(first + arc, seen), int(rng.integers(15, 50)))
    out = radius + noise * rng.standard_normal(len(turns))
    center = (away + radius) * np.array([np.cos(bearing), np.sin(bearing)])
    return center + out[:, None] * np.column_stack([np.cos(turns), np.sin(turns)]), float(radius)


def exact_arcs(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield exact arcs."""
    yield np.array([(0.2, 0.0), (0.3, 0.1), (0.3, -0.1)]), 0.1
    for _ in range(CASES):
        yield pipe(rng, (25, 120), 0.0)


def noisy_arcs(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield short noisy arcs."""
    for _ in range(CASES):
        yield pipe(rng, (25, 60), 0.001)


def few_hits(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield two points, which is enough, and fewer, which is not."""
    yield np.array([(0.3, -0.06), (0.3, 0.06)]), 0.1
    yield np.array([(0.3, 0.1)]), 0.1
    yield np.array([(0.3, 0.1)] * 3), 0.1
    yield np.zeros((0, 2)), 0.1
    for _ in range(10):
        points, radius = pipe(rng, (40, 120), 0.0)
        yield points[[0, -1]], radius


def with_fit(method: str) -> Any:
    """Fit centre and radius, and return the centre."""

    def center(points: Floats, _radius: float) -> Any:
        circle = pk.fit_circle(points, method)
        return None if circle is None else circle.center

    return center


def nearer_center(points: Floats, radius: float) -> Any:
    """Return the centre on the robot's side."""
    middle = points.mean(axis=0)
    if len(np.unique(points, axis=0)) < 2:
        return None
    return gauss_newton(points, radius, middle * (1 - radius / np.hypot(*middle)))


def behind_mean(points: Floats, radius: float) -> Any:
    """Go on from the mean of the points by a radius, away from the robot."""
    return beyond(points, radius) if len(np.unique(points, axis=0)) > 1 else None


def behind_nearest(points: Floats, radius: float) -> Any:
    """Go on from the nearest hit by a radius."""
    if len(np.unique(points, axis=0)) < 2:
        return None
    nearest = points[np.argmin(np.hypot(*points.T))]
    return nearest * (1 + radius / np.hypot(*nearest))


PIPE_CENTER = task(
    "pipe_center",
    known_radius,
    judge_center,
    (
        ("exact arcs", 1, exact_arcs),
        ("short, noisy arcs", 2, noisy_arcs),
        ("two hits, and too few", 1, few_hits),
    ),
    (
        Fault(
            "Three numbers came back: the centre alone is asked for.",
            when=lambda cases: all(numbers(case.got, 3) is not None for case in cases if case.expected is not None),
            name="a whole circle",
        ),
        Fault(
            "On short arcs a fit of centre and radius is unsure of both. You know the radius: do you use it?",
            like=with_fit("geometric"),
            name="radius not used",
        ),
        Fault(
            "On short arcs a fit of centre and radius is unsure of both. You know the radius: do you use it?",
            like=with_fit("kasa"),
            name="radius not used",
        ),
        Fault(
            "Two circles of this radius pass close to the points. On which side of its near wall does a pipe go on?",
            like=nearer_center,
            name="centre on the robot's side",
        ),
        Fault(
            "The mean of points on an arc does not lie on the arc, nor in the middle of the pipe's near side.",
            like=behind_mean,
            name="a radius beyond the mean",
        ),
        Fault(
            "The nearest hit is only one of many, and need not be the pipe's nearest place.",
            like=behind_nearest,
            name="a radius beyond the nearest hit",
        ),
        Fault(
            "Fewer than two different points fix no centre: that is None.",
            when=lambda cases: all(case.expected is None and case.got is not None for case in cases if case.off),
            name="a centre from one point",
        ),
    ),
)


# --- a hexagon from six lines ------------------------------------------------------------------------------


def corners_of(lines: Floats, inside: Floats) -> Floats:
    """Return the corners of the convex hexagon around a place, shape (6, 2), metres, counter-clockwise."""
    return in_order(outwards(lines, inside))


def outwards(lines: Floats, inside: Floats) -> Floats:
    """Return the lines with their normals pointing away from a place."""
    ahead = np.cos(lines[:, 0]) * inside[0] + np.sin(lines[:, 0]) * inside[1] - lines[:, 1]  # below zero: points away
    return np.where((ahead > 0)[:, None], np.column_stack([lines[:, 0] + np.pi, -lines[:, 1]]), lines)


def in_order(lines: Floats) -> Floats:
    """Return where neighbours meet, lines sorted by the bearings of their normals."""
    return chain(lines[np.argsort(lines[:, 0] % TURN)])


def chain(lines: Floats) -> Floats:
    """Return where each line meets the next."""
    (a, d), (b, e) = lines.T, np.roll(lines, -1, axis=0).T
    with np.errstate(all="ignore"):
        x = (d * np.sin(b) - e * np.sin(a)) / np.sin(b - a)
        y = (e * np.cos(a) - d * np.cos(b)) / np.sin(b - a)
    return np.column_stack([x, y])


def judge_corners(got: Any, expected: Any, _args: tuple[Any, ...]) -> str | None:
    """Judge corners in their order around the outline, from any of them on."""
    try:
        corners = np.asarray(got, dtype=float)
    except (TypeError, ValueError):
        return f"got {shown(got)}, expected an array of shape (6, 2)"
    if corners.shape != (6, 2) or got is None:
        return f"got an array of shape {corners.shape}, expected shape (6, 2)"
    if not np.isfinite(corners).all():
        return "got corners that are not finite"
    if turned_to(corners, expected):
        return None
    if turned_to(corners[::-1], expected):
        return "the corners are right, but go round clockwise"
    apart = np.hypot(*(corners[:, None] - expected).transpose(2, 0, 1))
    near = int((apart.min(axis=0) <= 1e-6).sum())
    return "the corners are right, but not in their order" if near == 6 else f"got {near} of the 6 corners"


def turned_to(corners: Floats, expected: Floats) -> bool:
    """Tell whether two rings are the same, whichever corner comes first."""
    return any(np.allclose(np.roll(corners, shift, axis=0), expected, rtol=0, atol=1e-6) for shift in range(6))


def hexagons(rng: np.random.Generator, *, around: bool, shuffled: bool, turned: bool) -> Iterator[tuple[Any, ...]]:
    """Yield the lines of convex hexagons, and a place inside; around the origin, or away from it."""
    n = 0
    while n < CASES:
        angles = TURN * (np.arange(6) + rng.uniform(-0.3, 0.3, 6)) / 6 % TURN
        lines = np.column_stack([angles, rng.uniform(0.08, 0.1, 6)])
        lines = lines[np.argsort(lines[:, 0])]
        corners = chain(lines)
        sides = np.hypot(*(np.roll(corners, -1, axis=0) - corners).T)
        if not convex(corners) or sides.min() < 0.01:
            continue
        n += 1
        middle = np.zeros(2) if around else rng.uniform(0.2, 0.4) * bearing(rng.uniform(0, TURN))
        lines[:, 1] += np.cos(lines[:, 0]) * middle[0] + np.sin(lines[:, 0]) * middle[1]
        if turned:
            flip = rng.random(6) < 0.5
            lines = np.where(flip[:, None], np.column_stack([lines[:, 0] + np.pi, -lines[:, 1]]), lines)
        yield (rng.permutation(lines) if shuffled else lines), middle + rng.uniform(-0.02, 0.02, 2)


def convex(corners: Floats) -> bool:
    """Tell whether a ring goes round counter-clockwise without a dent."""
    side = np.roll(corners, -1, axis=0) - corners
    after = np.roll(side, -1, axis=0)
    return bool((side[:, 0] * after[:, 1] - side[:, 1] * after[:, 0] > 1e-6).all())


def bearing(turn: float) -> Floats:
    """Return the arrow of length 1 at a bearing."""
    return np.array([np.cos(turn), np.sin(turn)])


def sorted_lines(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield lines in order, normals outwards, around the origin."""
    yield np.column_stack([np.radians(np.arange(0, 360, 60)), np.full(6, 0.1)]), np.zeros(2)
    yield from hexagons(rng, around=True, shuffled=False, turned=False)


def shuffled_lines(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield lines in any order."""
    yield np.column_stack([np.radians([0, 120, 60, 180, 240, 300]), np.full(6, 0.1)]), np.zeros(2)
    yield from hexagons(rng, around=True, shuffled=True, turned=False)


def turned_lines(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield lines in any order, of which some normals point inwards."""
    yield from hexagons(rng, around=True, shuffled=True, turned=True)


def lines_elsewhere(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield lines of hexagons that the origin does not lie in."""
    yield from hexagons(rng, around=False, shuffled=True, turned=True)


HEXAGON_CORNERS = task(
    "hexagon_corners",
    corners_of,
    judge_corners,
    (
        ("lines in order, normals outwards", 1, sorted_lines),
        ("lines in any order", 1, shuffled_lines),
        ("normals that point inwards", 1, turned_lines),
        ("hexagons away from the origin", 1, lines_elsewhere),
    ),
    (
        Fault(
            "The corners are right, but go round clockwise.",
            like=lambda lines, inside: corners_of(lines, inside)[::-1],
            name="clockwise for counter-clockwise",
        ),
        Fault(
            "Each line meets its neighbour in the list, which need not be its neighbour around the hexagon.",
            like=lambda lines, inside: chain(outwards(lines, inside)),
            name="lines in the order given",
        ),
        Fault(
            "Each line meets its neighbour in the list, which need not be its neighbour around the hexagon.",
            like=lambda lines, inside: chain(lines),
            name="lines in the order given",
        ),
        Fault(
            "The same line has two normals. Before you sort by them: do all of them point outwards?",
            like=lambda lines, inside: in_order(lines),
            name="normals not turned outwards",
        ),
        Fault(
            "Outwards means away from a place inside the hexagon; the origin need not be one.",
            like=lambda lines, inside: in_order(outwards(lines, np.zeros(2))),
            name="origin for the place inside",
        ),
        Fault(
            "Right, but clockwise: do the normals that you sort by point inwards?",
            when=lambda cases: all(
                case.off == "the corners are right, but go round clockwise" for case in cases if case.off
            ),
            name="clockwise for counter-clockwise",
        ),
        Fault(
            "These are the right corners in a wrong order: go round the hexagon, not from left to right.",
            when=lambda cases: all(
                case.off == "the corners are right, but not in their order" for case in cases if case.off
            ),
            name="corners not in order",
        ),
    ),
)


# --- a nut or a coin ---------------------------------------------------------------------------------------

BENT = 0.0403  # a regular hexagon of reach 1 misses its best circle by this much, root mean square
EXPLAINED = 1.7  # mean square over spread square: a coin's is 1, that of the nuts here 2.5 and more


def named(points: Floats, spread: float) -> str:
    """Return "coin" where the spread explains how far the points lie from their best circle, else "nut"."""
    return "coin" if off_circle(points) <= np.sqrt(EXPLAINED) * spread else "nut"


def off_circle(points: Floats) -> float:
    """Return the root mean square distance of points from their best circle, metres."""
    circle = pk.fit_circle(points)
    return INF if circle is None else float(np.sqrt(np.mean(circle.signed_distance(points) ** 2)))


def off_mean(points: Floats) -> float:
    """Return the spread of the points' distances from their mean, metres."""
    return float(np.hypot(*(points - points.mean(axis=0)).T).std())


def judge_name(got: Any, expected: Any, _args: tuple[Any, ...]) -> str | None:
    """Judge a name."""
    return None if isinstance(got, str) and got == expected else f"got {shown(got)}, expected {shown(expected)}"


def seen(rng: np.random.Generator, nut: bool, noise: float, share: float) -> tuple[Floats, float]:
    """Return points on a share of an outline and their spread; ``noise`` counts in what a nut misses its circle by."""
    reach, n = rng.uniform(0.02, 0.06), 150
    place = 6 * ((np.arange(n) + 0.5) / n * share + rng.random())  # in sixths of the outline
    turn, corner = rng.uniform(0, TURN), np.floor(place)
    if nut:
        ends = [np.column_stack([np.cos(a), np.sin(a)]) for a in (TURN * (corner + k) / 6 + turn for k in (0, 1))]
        outline = reach * (ends[0] + (place - corner)[:, None] * (ends[1] - ends[0]))
    else:
        outline = reach * np.column_stack([np.cos(TURN * place / 6 + turn), np.sin(TURN * place / 6 + turn)])
    spread = noise * BENT * reach
    out = outline / np.hypot(*outline.T)[:, None]
    return outline + spread * rng.standard_normal((n, 1)) * out + rng.uniform(-0.3, 0.3, 2), spread


def little_noise(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield nuts and coins of all sizes, with little noise."""
    for n in range(CASES):
        yield seen(rng, n % 2 == 0, rng.uniform(0.1, 0.3), 1.0)


def much_noise(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield nuts with noise, and coins with noise up to twice what a nut would miss its circle by."""
    for n in range(CASES):
        yield seen(rng, n % 2 == 0, rng.uniform(0.4, 0.6) if n % 2 == 0 else rng.uniform(0.4, 2.0), 1.0)


def half_seen(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield nuts and coins of which about half is seen."""
    for n in range(CASES):
        yield seen(rng, n % 2 == 0, rng.uniform(0.2, 0.4), rng.uniform(0.5, 0.65))


def parted_by(measure: Callable[[Case], float]) -> Callable[[list[Case]], bool]:
    """Tell whether a fixed limit of this measure explains all names."""

    def when(cases: list[Case]) -> bool:
        nuts = [measure(case) for case in cases if case.got == "nut"]
        coins = [measure(case) for case in cases if case.got == "coin"]
        return bool(nuts and coins) and len(nuts) + len(coins) == len(cases) and min(nuts) > max(coins)

    return when


def off_by_radius(case: Case) -> float:
    """Return how far the points lie from their best circle, over its radius."""
    circle = pk.fit_circle(case.args[0])
    return INF if circle is None else off_circle(case.args[0]) / circle.radius


NUT_OR_COIN = task(
    "nut_or_coin",
    named,
    judge_name,
    (
        ("all sizes, little noise", 1, little_noise),
        ("much noise", 2, much_noise),
        ("half of the outline seen", 1, half_seen),
    ),
    (
        Fault(
            "The mean of the points is the middle only when all of the outline is seen.",
            like=lambda points, spread: "coin" if off_mean(points) <= np.sqrt(EXPLAINED) * spread else "nut",
            name="mean taken for the centre",
        ),
        Fault(
            "Everything has the same name.",
            when=lambda cases: len({str(case.got) for case in cases}) == 1,
            name="one name for all",
        ),
        Fault(
            "The names are the wrong way round.",
            when=lambda cases: all(case.got in ("nut", "coin") and case.got != case.expected for case in cases),
            name="names changed places",
        ),
        Fault(
            "A limit in millimetres: a small nut misses its circle by little, a noisy coin by much. What tells why?",
            when=parted_by(lambda case: off_circle(case.args[0])),
            name="a fixed limit",
        ),
        Fault(
            "A limit in shares of the radius: noise does not grow with the radius. What do you know about it?",
            when=parted_by(off_by_radius),
            name="a limit by size alone",
        ),
    ),
)


# --- how sure is a radius ----------------------------------------------------------------------------------


def spread_of_radius(bearings: Floats, noise: float) -> float:
    """Return the standard deviation of a fitted radius, metres; inf where the bearings fix no circle."""
    return float(np.sqrt(covariance(bearings, noise)[2, 2])) if fixes_circle(bearings) else INF


def slopes(bearings: Floats) -> Floats:
    """Return how each gap grows when centre x, centre y and radius do, shape (N, 3); but for the sign."""
    return np.column_stack([np.cos(bearings), np.sin(bearings), np.ones_like(bearings)])


def covariance(bearings: Floats, noise: float) -> Floats:
    """Return the covariance of centre and radius, shape (3, 3), square metres."""
    J = slopes(bearings)
    return noise**2 * np.linalg.inv(J.T @ J)


def fixes_circle(bearings: Floats) -> bool:
    """Tell whether the points fix centre and radius."""
    return len(bearings) > 2 and np.linalg.matrix_rank(slopes(bearings), tol=1e-9) == 3


def judge_std(got: Any, expected: Any, _args: tuple[Any, ...]) -> str | None:
    """Judge a standard deviation within a tenth, so that a simulation will do as well."""
    value = numbers([got], 1) if isinstance(got, (float, int, np.floating)) else None
    if value is None:
        return f"got {shown(got)}, expected a number such as {shown(expected)} m"
    if value[0] == expected or abs(value[0] - expected) <= 0.1 * expected < INF:
        return None
    return f"got {shown(1000 * value[0])} mm, expected {shown(1000 * expected)} mm"


def arc(rng: np.random.Generator, degrees: tuple[float, float]) -> tuple[Floats, float]:
    """Return evenly spread bearings and a noise."""
    turn = np.radians(rng.uniform(*degrees))
    n = int(rng.integers(20, 120))
    return rng.uniform(0, TURN) + turn * (np.arange(n) + 0.5) / n, float(rng.choice([0.001, 0.002, 0.005]))


def full_circles(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield points all around."""
    yield TURN * np.arange(100) / 100, 0.002
    for _ in range(CASES // 2):
        yield arc(rng, (360, 360))


def short_arcs(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield arcs from 30 to 200 degrees."""
    yield np.radians(np.arange(-30, 31)), 0.002
    for _ in range(CASES // 2):
        yield arc(rng, (30, 200))


def too_few(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield bearings that fix no circle, and three that just do."""
    yield np.array([0.0, 1.0]), 0.001
    yield np.array([0.5, 0.5, 0.5, 2.0]), 0.001
    yield np.zeros(0), 0.001
    yield np.array([0.0, 2.0, 4.0]), 0.001


RADIUS_STD = task(
    "radius_std",
    spread_of_radius,
    judge_std,
    (
        ("points all around", 1, full_circles),
        ("short arcs", 2, short_arcs),
        ("too few bearings, and just enough", 1, too_few),
    ),
    (
        Fault(
            "Right where the centre is known. On a short arc, moving the centre looks like changing the radius.",
            like=lambda bearings, noise: noise / np.sqrt(len(bearings)) if fixes_circle(bearings) else INF,
            name="centre taken for known",
        ),
        Fault(
            "That is the variance: which power of a length is asked for?",
            like=lambda bearings, noise: spread_of_radius(bearings, noise) ** 2,
            name="variance for standard deviation",
        ),
        Fault(
            "That is the spread of one point. Many points together know the radius better.",
            like=lambda bearings, noise: noise if fixes_circle(bearings) else INF,
            name="spread of one point",
        ),
        Fault(
            "That is the spread of the centre: which row of the matrix belongs to the radius?",
            like=lambda bearings, noise: (
                float(np.sqrt(covariance(bearings, noise)[0, 0])) if fixes_circle(bearings) else INF
            ),
            name="centre for radius",
        ),
        Fault(
            "Where too few bearings fix no circle, nothing is known about the radius: that is inf.",
            when=lambda cases: all(case.expected == INF for case in cases if case.off),
            name="sure of what is not fixed",
        ),
    ),
)
