"""Cells: from metres to a cell, and from a scan to the set of occupied cells; the checks of lesson 02.

In:  the student's ``to_cells(points, resolution)`` and ``occupy(cells, pose, angles, ranges, resolution)``.
Out: answers. The first returns whole numbers, shape (N, 2); the second the set of occupied cells, pairs (i, j).

>>> to_cells(lambda points, resolution: ...)
○ not attempted: to_cells still returns `...`.
>>> sorted(occupy.reference({(0, 0)}, np.array([0.0, 0.0, 0.0]), np.zeros(1), np.array([0.25]), 0.1))
[(0, 0), (2, 0)]
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arguments import Floats
from ..grid import Grid
from .answer import Case, Check, Fault, off_only_where
from .cases import UNDECIDED, Args, around, random_cases
from .judges import array, no_return, shown

Cells = set[tuple[int, int]]

FARTHEST_CELL = 1 << 40  # farther out than anything that was seen


# --- metres to cells ---------------------------------------------------------------------------------------


def cells_of(points: Floats, resolution: float) -> NDArray[np.int64]:
    """Return the cell of each point, shape (N, 2): half-open cells of ``resolution`` metres, (0, 0) from the origin."""
    return Grid(resolution).to_cells(points)


def _point_cases(rng: np.random.Generator) -> Iterator[Args]:
    """Yield points on all sides of the origin, on borders that floats hold exactly, then random ones."""
    yield np.array([[0.025, 0.018]]), 0.01
    yield np.array([[-0.025, 0.018], [-0.004, -0.004]]), 0.01
    yield np.array([[0.5, 0.25], [-0.25, 0.0]]), 0.25  # on borders: half-open

    def draw(_n: int) -> Args | None:
        resolution = float(rng.choice([0.001, 0.005, 0.02, 0.1, 0.3]))
        points = rng.uniform(-0.5, 0.5, (int(rng.integers(1, 6)), 2))
        return (points, resolution) if _clear(points, resolution) else None

    yield from random_cases(draw)


def _clear(points: Floats, resolution: float) -> bool:
    """Tell whether no point is so near a border that rounding decides."""
    place = points / resolution
    return bool((np.abs(place - np.round(place)) > UNDECIDED).all())


def _by(change: Any) -> Any:
    """Return a wrong way to cells that works on points / resolution."""
    return lambda points, resolution: change(points / resolution)


to_cells = Check(
    "to_cells",
    cells_of,
    _point_cases,
    array(),
    (
        Fault("Below zero the cells are one too high: int() cuts towards zero, floor goes down.", like=_by(np.trunc)),
        Fault("That is the nearest border, not the cell that the point lies in.", like=_by(np.round)),
        Fault(
            "Only points exactly on a border are wrong: a cell holds its lower border, and not its upper one.",
            like=_by(lambda place: np.ceil(place) - 1),
        ),
        Fault("Those are places counted in cells: which whole number names the cell?", like=_by(lambda place: place)),
        Fault(
            "That is the cell's corner in metres: the number of the cell is asked for.",
            like=lambda points, resolution: np.floor(points / resolution) * resolution,
        ),
        Fault(
            "That is the cell's centre in metres: the number of the cell is asked for.",
            like=lambda points, resolution: (np.floor(points / resolution) + 0.5) * resolution,
        ),
        Fault(
            "That is the cell's centre counted in cells: without the half it is the cell's number.",
            like=_by(lambda place: np.floor(place) + 0.5),
        ),
        Fault("x and y have changed places: i counts along x.", like=_by(lambda place: np.floor(place)[:, ::-1])),
        Fault(
            "How many cells fit into that many metres? Divide by their size.",
            like=lambda points, size: np.floor(points * size),
        ),
    ),
)


# --- a scan into the set -----------------------------------------------------------------------------------


def with_scan(cells: Cells, pose: Floats, angles: Floats, ranges: Floats, resolution: float) -> Cells:
    """Return the occupied cells with those that a scan's hits fall into; a range of inf is no hit."""
    return cells | _as_set(cells_of(_hits(pose, angles, ranges), resolution))


def _hits(pose: Floats, angles: Floats, ranges: Floats) -> Floats:
    """Return where the beams hit, shape (H, 2), metres."""
    hit = np.isfinite(ranges)
    return around(pose[:2], ranges[hit], pose[2] + angles[hit])


def _as_set(cells: NDArray[np.int64]) -> Cells:
    return {(i, j) for i, j in cells.tolist()}


def _scan_cases(rng: np.random.Generator) -> Iterator[Args]:
    """Yield one hit, a turned robot, a scan without hits, two hits in one cell, then random scans."""
    yield set(), np.array([0.005, 0.005, 0.0]), np.array([0.0]), np.array([0.1]), 0.01
    yield {(3, 3)}, np.array([0.105, 0.005, np.pi / 2]), np.array([0.0]), np.array([0.2]), 0.01
    yield {(3, 3)}, np.array([0.005, 0.005, 0.0]), np.array([0.0, 0.5]), np.array([np.inf, np.inf]), 0.01
    yield set(), np.array([-0.1, -0.1, 0.3]), np.array([0.0, 0.01, 3.0]), np.array([0.22, 0.22, np.inf]), 0.1

    def draw(_n: int) -> Args | None:
        pose = np.array([*rng.uniform(-0.5, 0.5, 2), rng.uniform(0, 2 * np.pi)])
        angles = 2 * np.pi * np.arange(int(rng.integers(4, 13))) / 12
        ranges = np.where(rng.random(len(angles)) < 0.3, np.inf, rng.uniform(0.05, 0.3, len(angles)))
        resolution = float(rng.choice([0.005, 0.02, 0.1]))
        hits = _hits(pose, angles, ranges)
        if not _clear(hits, resolution):
            return None
        before = _as_set(rng.integers(-9, 9, (3, 2))) | set(list(_as_set(cells_of(hits, resolution)))[:1])
        return before, pose, angles, ranges, resolution

    yield from random_cases(draw)


def _judge_cells(got: Any, expected: Any, _args: Args) -> str | None:
    """Judge a set of pairs."""
    if not isinstance(got, (set, frozenset)):
        return f"got {shown(got)}, expected a set of pairs (i, j){no_return(got)}"
    if got == expected:
        return None
    missing, extra = (min(map(shown, some), default="") for some in (expected - got, got - expected))
    off = (missing and f"the cell {missing} is missing", extra and f"{extra} should not be there")
    return "; ".join(filter(None, off))


def _scan_with(hits: Any) -> Any:
    """Return the update with another way from ranges to hits."""

    def update(cells: Cells, pose: Floats, angles: Floats, ranges: Floats, resolution: float) -> Cells:
        hit = np.isfinite(ranges)
        return cells | _as_set(cells_of(hits(pose, angles[hit], ranges[hit]), resolution))

    return update


def _cut(cells: Cells, pose: Floats, angles: Floats, ranges: Floats, resolution: float) -> Cells:
    return cells | _as_set(np.trunc(_hits(pose, angles, ranges) / resolution).astype(int))


def _holds_misses(case: Case) -> bool:
    """Tell whether the only cells too many are those of beams that met nothing, infinitely far out."""
    return isinstance(case.got, set) and case.expected <= case.got and all(map(_no_place, case.got - case.expected))


def _no_place(cell: Any) -> bool:
    """Tell whether a cell is what becomes of infinity: a huge number, or none."""
    values = np.asarray(cell)
    return values.dtype.kind in "iuf" and bool((~(np.abs(values.astype(float)) < FARTHEST_CELL)).any())


occupy = Check(
    "occupy",
    with_scan,
    _scan_cases,
    _judge_cells,
    (
        Fault(
            "A beam that met nothing reads inf and occupies no cell: leave it out first.",
            when=off_only_where(_holds_misses),
        ),
        Fault(
            "Where are the cells of the scans before? A map keeps what it knows.",
            like=lambda _cells, *scan: with_scan(set(), *scan),
        ),
        Fault(
            "A turned robot goes wrong: angles count from its heading, pose[2].",
            like=_scan_with(lambda pose, angles, ranges: around(pose[:2], ranges, angles)),
        ),
        Fault(
            "Those are places seen from the robot: add where it stands.",
            like=_scan_with(lambda pose, angles, ranges: around(np.zeros(2), ranges, pose[2] + angles)),
        ),
        Fault(
            "x and y have changed places: x goes with the cosine.",
            like=_scan_with(lambda pose, angles, ranges: around(pose[:2], ranges, np.pi / 2 - pose[2] - angles)),
        ),
        Fault(
            "Angles are turned into degrees: sine and cosine take radians, and these are radians already.",
            like=_scan_with(lambda pose, angles, ranges: around(pose[:2], ranges, np.degrees(pose[2] + angles))),
        ),
        Fault("Cells below zero are wrong: int() cuts towards zero.", like=_cut),
        Fault(
            "A list keeps the same cell many times; a set keeps it once.",
            when=lambda cases: all(isinstance(case.got, list) for case in cases),
        ),
    ),
)
