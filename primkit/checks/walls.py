"""Walls: points on and about walls, at every bearing, that lesson 04's functions are tried on.

In:  a random generator.
Out: the arguments of one call after the other; plain ones first, because a message shows them.

>>> p, q = next(pairs(np.random.default_rng(0)))
>>> p.tolist(), q.tolist()
([0.0, 0.1], [0.2, 0.1])
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..arguments import Floats
from .cases import RANDOM_CASES, Args, random_cases
from .judges import CLOSE

RANSAC_CASES = 24  # each is a few hundred trials of the student's own loop


def pairs(rng: np.random.Generator) -> Iterator[Args]:
    """Yield a level, an upright and a slanted pair and a doubled point, then random ones with some of each."""
    yield np.array([0.0, 0.1]), np.array([0.2, 0.1])
    yield np.array([0.3, 0.0]), np.array([0.3, 0.2])  # upright
    yield np.array([-0.3, 0.2]), np.array([-0.3, -0.1])  # downwards, left of the origin
    yield np.array([0.1, 0.0]), np.array([0.0, 0.1])
    yield np.array([0.2, 0.1]), np.array([0.2, 0.1])  # the same point twice

    def draw(n: int) -> Args | None:
        p, q = rng.uniform(-0.5, 0.5, (2, 2))
        if n % 10 == 0:
            q[0] = p[0]
        if np.hypot(*(q - p)) <= 0.01:
            return None
        return (p, p.copy()) if n % 15 == 14 else (p, q)

    yield from random_cases(draw)


def bands(rng: np.random.Generator) -> Iterator[Args]:
    """Yield points on both boundaries of a band and on a line without noise, then random ones off the boundary."""
    yield np.array([(0.25, 0.0), (0.375, 0.1), (0.125, -0.2), (0.5, 0.0), (0.0, 0.3)]), (0.0, 0.25), 0.125
    yield np.array([(0.25, 0.0), (0.25, 0.4), (0.251, 0.1)]), (0.0, 0.25), 0.0
    for _ in range(RANDOM_CASES):
        angle, offset = float(rng.uniform(-np.pi, np.pi)), float(rng.uniform(-0.4, 0.4))
        threshold = float(rng.uniform(0.001, 0.02))
        points = _wall(rng, angle, offset, 30, threshold) + rng.uniform(-1, 1, (30, 1)) * threshold
        distance = np.abs(points @ (np.cos(angle), np.sin(angle)) - offset)
        yield points[np.abs(distance - threshold) > CLOSE], (angle, offset), threshold


def clouds(rng: np.random.Generator) -> Iterator[Args]:
    """Yield points exactly on level, upright and slanted lines and too few for one, then noisy walls."""
    steps = np.linspace(-0.1, 0.1, 11)
    yield (np.column_stack([steps, np.full(11, 0.2)]),)
    yield (np.column_stack([np.full(11, 0.3), steps]),)  # upright
    yield (np.column_stack([steps, 0.5 * steps + 0.1]),)
    yield (np.array([(0.25, 0.0), (0.0, 0.25)]),)  # two fix a line
    yield (np.full((4, 2), 0.25),)  # the same point four times
    yield (np.array([(0.1, 0.2)]),)
    for _ in range(RANDOM_CASES):
        angle, offset = float(rng.uniform(-np.pi, np.pi)), float(rng.uniform(-0.4, 0.4))
        yield (_wall(rng, angle, offset, int(rng.integers(8, 60)), 0.004),)


def scenes(rng: np.random.Generator) -> Iterator[Args]:
    """Yield points without noise, then a noisy wall among clutter each, and what fixes no line."""
    level = np.column_stack([np.linspace(-0.2, 0.2, 12), np.full(12, 0.1)])
    yield np.vstack([level, [(0.0, 0.3), (0.1, -0.2), (-0.1, 0.25)]]), 0.002, 100, np.random.default_rng(1)
    yield np.array([(0.1, 0.1)]), 0.002, 10, np.random.default_rng(2)
    yield np.full((3, 2), 0.1), 0.002, 10, np.random.default_rng(3)
    for seed in range(RANSAC_CASES):
        angle, offset = float(rng.uniform(-np.pi, np.pi)), float(rng.uniform(-0.2, 0.2))
        noise = float(rng.uniform(0.001, 0.002))
        wall = _wall(rng, angle, offset, 50, noise)
        clutter = rng.uniform(-0.5, 0.5, (25, 2))
        points = np.vstack([wall, wall[:5], clutter])  # some points twice: a sample of these fixes no line
        yield points[rng.permutation(len(points))], 3 * noise, 150, np.random.default_rng(seed)


def _wall(rng: np.random.Generator, angle: float, offset: float, n: int, noise: float) -> Floats:
    """Return n points along 0.3 m of a line, with noise across it."""
    normal = np.array([np.cos(angle), np.sin(angle)])
    along = np.array([-normal[1], normal[0]])
    places = np.linspace(-0.15, 0.15, n) + rng.uniform(-0.1, 0.1)
    noisy: Floats = places[:, None] * along + (offset + rng.normal(0, noise, n))[:, None] * normal
    return noisy
