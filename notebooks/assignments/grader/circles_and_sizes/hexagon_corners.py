"""A hexagon from six lines: its corners, counter-clockwise.

In:  the student's ``hexagon_corners``.
Out: marks.

>>> HEXAGON_CORNERS.mark(corners_of)
4.0
"""

# ruff: noqa: ARG005 (a wrong way may leave out what it is given)

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..parts import TURN, Fault, shown, task

Floats = NDArray[np.float64]

CASES = 40  # random ones, in each part


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
