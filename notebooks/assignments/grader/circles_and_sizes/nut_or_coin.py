"""A nut or a coin: named by whether the spread explains what a circle leaves over.

In:  the student's ``nut_or_coin``.
Out: marks.

>>> NUT_OR_COIN.mark(named)
4.0
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

import primkit as pk
from primkit.checks.answer import Case

from ..parts import INF, TURN, Fault, shown, task

Floats = NDArray[np.float64]

CASES = 40  # random ones, in each part

PHASES = 12  # turns of a hexagon that are tried, within a sixth of a full turn
PLAINLY = 1.1  # the wrong outline must miss the points by so much more than the right one
BENT = 0.0403  # a regular hexagon of reach 1 misses its best circle by this much, root mean square
COIN_WAVES, NUT_WAVES = 4.0, 8.0  # spreads over the root of the points' number: noise makes 1.4, at times 4
NAMES = ("nut", "coin")
SIZES = (0.02, 0.06)  # m, from the middle to the corners
LARGE_COIN = 0.45  # noise of the first coin
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


def off_hexagon(points: Floats) -> float:
    """Return the root mean square distance of points from their best regular hexagon, metres: over all turns of it."""
    turn = TURN / 6 * np.arange(PHASES)[:, None] / PHASES  # (turn, point)
    middle = np.tile((points.min(axis=0) + points.max(axis=0)) / 2, (PHASES, 1))
    for _ in range(4):  # each point to the side that it faces, then the hexagon to the points
        x, y = (points - middle[:, None]).transpose(2, 0, 1)
        side = turn + TURN / 6 * np.round((np.arctan2(y, x) - turn) * 6 / TURN)
        lines = np.stack([np.cos(side), np.sin(side), np.ones_like(side)], axis=-1)
        along = (lines[..., :2] * points).sum(axis=-1)
        across = lines.swapaxes(1, 2)
        fit = (np.linalg.pinv(across @ lines, hermitian=True) @ across @ along[..., None])[..., 0]
        middle = fit[:, :2]
    off = (lines @ fit[..., None])[..., 0] - along
    return float(np.sqrt((off**2).mean(axis=1)).min())


def clear(points: Floats, spread: float, nut: bool) -> bool:
    """Tell whether the spread names it, six waves around the circle too, and the better fit, by a tenth or more."""
    circle = off_circle(points)
    if nut == (circle <= np.sqrt(EXPLAINED) * spread):
        return False
    waves = off_in_waves(points) * np.sqrt(len(points)) / spread
    if waves < NUT_WAVES if nut else waves > COIN_WAVES:
        return False
    hexagon = off_hexagon(points)
    return circle > PLAINLY * hexagon if nut else hexagon > PLAINLY * circle


def off_in_waves(points: Floats) -> float:
    """Return how high six waves around the best circle are that the points lie on, metres."""
    circle = pk.fit_circle(points)
    if circle is None:
        return INF
    x, y = (points - circle.center).T
    turn = 6 * np.arctan2(y, x)
    waves = np.column_stack([np.cos(turn), np.sin(turn), np.ones_like(turn)])
    return float(np.hypot(*np.linalg.lstsq(waves, np.hypot(x, y), rcond=None)[0][:2]))


def clear_ones(
    rng: np.random.Generator, noise: tuple[Any, Any], share: tuple[float, float]
) -> Iterator[tuple[Any, ...]]:
    """Yield clear nuts and coins by turns, with noise for each of the two, of which a share is seen.

    The first nut misses its circle by less than the first coin does, in millimetres: no fixed limit parts them.
    """
    n = 0
    while n < CASES:
        reach = SIZES[n] if n < 2 else rng.uniform(*SIZES)
        some = (noise[0][0], max(noise[1][1], LARGE_COIN))[n] if n < 2 else rng.uniform(*noise[n % 2])
        points, spread = seen(rng, n % 2 == 0, reach, some, rng.uniform(*share))
        if clear(points, spread, n % 2 == 0):
            n += 1
            yield points, spread


def seen(rng: np.random.Generator, nut: bool, reach: float, noise: float, share: float) -> tuple[Floats, float]:
    """Return points on a share of an outline and their spread; ``noise`` counts in what a nut misses its circle by."""
    n = 150
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
    yield from clear_ones(rng, ((0.1, 0.3), (0.1, 0.3)), (1.0, 1.0))


def much_noise(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield nuts with noise, and coins with noise up to twice what a nut would miss its circle by."""
    yield from clear_ones(rng, ((0.4, 0.6), (0.4, 2.0)), (1.0, 1.0))


def half_seen(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield nuts and coins of which about half is seen."""
    yield from clear_ones(rng, ((0.2, 0.4), (0.2, 0.4)), (0.5, 0.65))


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
            "Neither of the two names came back: return exactly 'nut' or 'coin', in small letters.",
            when=lambda cases: all(case.got is not None and str(case.got) not in NAMES for case in cases),
            name="neither nut nor coin",
        ),
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
            when=lambda cases: all(case.got in NAMES and case.got != case.expected for case in cases),
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
