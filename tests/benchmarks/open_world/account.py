"""Account: every point lies on a shape, a wall, some other thing, or is a stray; and whatever comes in, it ends."""

from __future__ import annotations

import signal
import time
from collections.abc import Callable, Iterator

import numpy as np

import primkit as pk
from primkit.found import Found

from .boards import Rng, rng_of, seen_on
from .figures import Figure, number, share
from .judging import accounted, bits, in_order
from .things import SORTS, thing

Floats = np.ndarray
UTM = np.array([512_345.0, 5_412_345.0])  # m
MANY, SECONDS, GIVEN_UP = 100_000, 2.0, 20.0  # points; processor time that they may take, and after which we stop


def account(n: int, seed: int) -> Iterator[Figure]:
    """Point sets of every sort: the sum of all is the input; and 10^5 points of the worst sorts: a bound."""
    whole: dict[str, bool] = {}
    for k in range(n):
        name, rng = list(SETS)[k % len(SETS)], rng_of(seed, k)
        cell = 10.0 ** rng.integers(-5, 2)  # m
        points = SETS[name](rng) * (cell / 0.001)
        found = pk.find_shapes(points, resolution=cell, rng=0)
        whole[f"{k} ({name})"] = np.array_equal(in_order(accounted(found)), in_order(points))
    yield share("point sets with every point in the account", whole, at_least=1.0)
    yield from bound(seed)


def bound(seed: int) -> Iterator[Figure]:
    """Yield how long the worst sorts of 10^5 points take, and whether they come out the same twice."""
    taken, same = {}, {}
    for k, (name, make) in enumerate(CROWDS.items()):
        points = make(rng_of(seed, 300_000 + k))
        taken[name], first = seconds_for(points)
        yield number(f"    {len(points):,} points, {name}: processor time [s]", taken[name], 1)
        same[name] = first is not None and bits(pk.find_shapes(points, rng=0)) == bits(first)
    yield number(f"{MANY:,} points of every sort: the longest [s]", max(taken.values()), len(taken), at_most=SECONDS)
    yield share("    the same bits when asked again", same, at_least=1.0)


def seconds_for(points: Floats) -> tuple[float, Found | None]:
    """Return the processor time and what was found; infinite and nothing where it was given up."""

    def stop(*_: object) -> None:
        raise TimeoutError

    before = signal.signal(signal.SIGVTALRM, stop)
    signal.setitimer(signal.ITIMER_VIRTUAL, GIVEN_UP)
    begun = time.process_time()
    try:
        found = pk.find_shapes(points, rng=0)
        return time.process_time() - begun, found
    except TimeoutError:
        return np.inf, None
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0)
        signal.signal(signal.SIGVTALRM, before)


# --- what may come in, on cells of a millimetre ------------------------------------------------------------------


def strewn(rng: Rng, most: int = 300) -> Floats:
    """Return up to so many points anywhere."""
    return rng.uniform(-0.3, 0.3, (rng.integers(most + 1), 2))


def pieces(rng: Rng, n_pieces: int, n_each: int, reach: float = 0.4, noise: float = 0.001) -> Floats:
    """Return points on straight pieces that cross each other."""
    ends = rng.uniform(-reach, reach, (2, n_pieces, 1, 2))
    points = ends[0] + rng.random((n_pieces, n_each, 1)) * (ends[1] - ends[0])
    return (points + rng.normal(0, noise, points.shape)).reshape(-1, 2)


def arc(rng: Rng, n: int = 200) -> Floats:
    bearing, radius = rng.uniform(0, rng.uniform(0.2, 7), n), rng.uniform(0.003, 0.4)
    points = radius * np.column_stack([np.cos(bearing), np.sin(bearing)])
    return points + rng.normal(0, rng.uniform(0, 0.01), points.shape)


def outline(rng: Rng) -> Floats:
    """Return the outline of a thing of any sort, a part of it, with strays."""
    whole = thing(list(SORTS)[rng.integers(len(SORTS))], rng).outline(int(rng.integers(20, 400)))
    return np.vstack([whole[: rng.integers(1, len(whole) + 1)], strewn(rng, 40)])


def on_board(rng: Rng) -> Floats:
    world = pk.random_world(int(rng.integers(1, 5)), style="any", walls=bool(rng.integers(2)), rng=rng)
    faults = {"noise_std": rng.choice([0, 0.002, 0.01]), "spurious": rng.choice([0, 0.02, 0.2])}
    return seen_on(world, rng, **faults).points()


def lattice(rng: Rng, n: int = 20) -> Floats:
    steps = np.arange(n) * rng.choice([0.001, 0.005, 0.02])
    return np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)


SETS: dict[str, Callable[[Rng], Floats]] = {
    "few": lambda rng: strewn(rng, 12),
    "strewn": strewn,
    "at one place": lambda rng: rng.normal(0, 0.002, (rng.integers(1, 60), 2)),
    "straight pieces": lambda rng: pieces(rng, int(rng.integers(1, 6)), 60),
    "an arc": arc,
    "an outline": outline,
    "a board": on_board,
    "a lattice": lattice,
    "doubled points": lambda rng: np.repeat(outline(rng), rng.integers(2, 4), axis=0),
    "on one line": lambda rng: strewn(rng) * (1, 0),
    "far away": lambda rng: outline(rng) + UTM,
    "three heaps": lambda rng: (rng.uniform(-0.3, 0.3, (3, 1, 2)) + rng.normal(0, 0.02, (3, 40, 2))).reshape(-1, 2),
}

CROWDS: dict[str, Callable[[Rng], Floats]] = {
    "all over the board": lambda rng: rng.uniform(-0.5, 0.5, (MANY, 2)),
    "all over ten metres": lambda rng: rng.uniform(-5, 5, (MANY, 2)),
    "all over a hundred": lambda rng: rng.uniform(-50, 50, (MANY, 2)),
    "a heap": lambda rng: rng.normal(0, 0.05, (MANY, 2)),
    "a thick ring": lambda rng: rings(rng, 1, MANY, 0.2, 0.01),
    "300 rings": lambda rng: rings(rng, 300, MANY // 300, 0.06, 0.002),
    "four walls that cross": lambda rng: pieces(rng, 4, MANY // 4),
    "a hundred walls that cross": lambda rng: pieces(rng, 100, MANY // 100, reach=4.0),
    "a thousand walls that cross": lambda rng: pieces(rng, 1000, MANY // 1000, reach=20.0),
    "a lattice": lambda rng: lattice(rng, 316),
    "a spiral": lambda rng: spiral(rng, MANY),
    "one place": lambda _: np.zeros((MANY, 2)),
}


def rings(rng: Rng, n_rings: int, n_each: int, radius: float, noise: float) -> Floats:
    """Return points of noisy rings that stand anywhere, one in each twenty square decimetres."""
    bearing = rng.uniform(0, 2 * np.pi, (n_rings, n_each, 1))
    points = rng.uniform(-1, 1, (n_rings, 1, 2)) * 0.22 * n_rings**0.5
    points = points + radius * np.concatenate([np.cos(bearing), np.sin(bearing)], axis=-1)
    return (points + rng.normal(0, noise, points.shape)).reshape(-1, 2)


def spiral(rng: Rng, n: int) -> Floats:
    turn = np.sqrt(rng.random(n)) * 60 * np.pi
    return 0.0025 * turn[:, None] * np.column_stack([np.cos(turn), np.sin(turn)])
