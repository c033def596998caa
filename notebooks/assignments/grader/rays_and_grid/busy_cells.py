"""A grid that counts: the centres of the cells with enough hits.

In:  the student's ``busy_cells``.
Out: marks.

>>> BUSY_CELLS.mark(counted)
4.0
"""

# ruff: noqa: ARG005 (a wrong way may leave out what it is given)

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..parts import EDGE, Fault, places, task

Floats = NDArray[np.float64]

CASES = 60  # random ones, in each part


def counted(points: Floats, corner: Floats, resolution: float, shape: tuple[int, int], least: int) -> Floats:
    """Return the centres of the cells that hold enough points, shape (K, 2), metres, world frame."""
    cells = np.floor((points - corner) / resolution)
    on_board = ((cells >= 0) & (cells < shape)).all(axis=1)
    busy, hits = np.unique(cells[on_board], axis=0, return_counts=True)
    return corner + (busy[hits >= least] + 0.5) * resolution


def count_like(
    to_cells: Any = lambda points, corner, h: np.floor((points - corner) / h),
    keep: Any = lambda cells, shape: cells[((cells >= 0) & (cells < shape)).all(axis=1)],
    enough: Any = lambda hits, least: hits >= least,
    to_world: Any = lambda busy, corner, h: corner + (busy + 0.5) * h,
) -> Any:
    """Return a wrong way with one of the four steps done in another way."""

    def count(points: Floats, corner: Floats, resolution: float, shape: tuple[int, int], least: int) -> Floats:
        cells = keep(to_cells(points, corner, resolution), np.asarray(shape))
        busy, hits = np.unique(cells.reshape(-1, 2), axis=0, return_counts=True)
        return np.asarray(to_world(busy[enough(hits, least)], corner, resolution))

    return count


def closed_board(cells: Floats, shape: NDArray[np.int64]) -> Floats:
    """Count the first cell beyond the far borders to the last one on the board; right only for points on a border."""
    cells = np.where(cells == shape, shape - 1, cells)
    return cells[((cells >= 0) & (cells < shape)).all(axis=1)]


def boards(rng: np.random.Generator, least: Any, off: float) -> Iterator[tuple[Any, ...]]:
    """Yield points on boards whose corner lies anywhere, up to ``off`` board lengths beside it; not on borders."""
    n = 0
    while n < CASES:
        resolution = float(rng.choice([0.005, 0.02, 0.05]))
        shape = (int(rng.integers(3, 7)), int(rng.integers(7, 10)))
        corner = rng.uniform(-1, 1, 2)
        size = resolution * np.array(shape)
        points = corner + rng.uniform(-off, 1 + off, (int(rng.integers(5, 60)), 2)) * size
        place = (points - corner) / resolution
        if np.abs(place - np.round(place)).min() > EDGE:
            n += 1
            yield points, corner, resolution, shape, int(rng.integers(*least))


CORNER = np.array([-0.5, -0.5])


def on_the_board(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield points on the board; one in a cell is enough."""
    yield np.array([[-0.493, -0.488]]), CORNER, 0.005, (200, 200), 1
    yield from boards(rng, (1, 2), 0.0)


def enough_hits(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield points on the board; two to four in a cell are needed."""
    yield np.array([[-0.493, -0.488], [-0.494, -0.487], [0.1, 0.2]]), CORNER, 0.005, (200, 200), 2
    yield from boards(rng, (2, 5), 0.0)


def beside_the_board(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield points on the board and beside it, on all sides."""
    yield np.array([[-0.493, -0.488], [-0.501, 0.0], [0.0, 0.502]]), CORNER, 0.005, (200, 200), 1
    yield np.array([[-0.6, 0.0]]), CORNER, 0.005, (200, 200), 1
    yield from boards(rng, (1, 2), 0.4)


def on_borders(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield points on the borders of cells that floats hold exactly."""
    yield np.array([[-0.5, 0.25], [0.0, 0.0], [0.5, 0.0]]), CORNER, 0.25, (4, 4), 1
    corner, shape = np.array([0.125, -0.25]), (6, 9)
    for _ in range(CASES):
        steps = rng.integers(0, [shape[0] + 1, shape[1] + 1], (20, 2))  # up to the far borders
        yield corner + steps / 8, corner, 0.125, shape, 1


BUSY_CELLS = task(
    "busy_cells",
    counted,
    places(1e-6),
    (
        ("centres of cells, counted from the corner", 1, on_the_board),
        ("only cells with enough hits", 1, enough_hits),
        ("points beside the board", 1, beside_the_board),
        ("points on borders", 1, on_borders),
    ),
    (
        Fault(
            "Everything is half a cell too low and too far left: which place does a cell stand for?",
            like=count_like(to_world=lambda busy, corner, h: corner + busy * h),
            name="corner for centre",
        ),
        Fault(
            "Cell (0, 0) begins at the board's corner, not at the world's origin.",
            like=count_like(lambda points, corner, h: np.floor(points / h)),
            name="world origin for corner",
        ),
        Fault(
            "Those are places seen from the corner: the world frame is asked for.",
            like=count_like(to_world=lambda busy, corner, h: (busy + 0.5) * h),
            name="places seen from the corner",
        ),
        Fault(
            "Those are the numbers of cells: their centres in metres are asked for.",
            like=count_like(to_world=lambda busy, corner, h: busy),
            name="cell numbers for metres",
        ),
        Fault(
            "A cell with exactly `least` hits has enough of them.",
            like=count_like(enough=lambda hits, least: hits > least),
            name="more than, for at least",
        ),
        Fault(
            "Every cell that was hit is there: how often was it hit?",
            like=count_like(enough=lambda hits, least: hits > 0),
            name="no threshold",
        ),
        Fault(
            "Points beside the board have cells too: those are not on it.",
            like=count_like(keep=lambda cells, shape: cells),
            name="cells beside the board",
        ),
        Fault(
            "Points left of the board or below it turn up at the other end: a negative index counts from there.",
            like=count_like(keep=lambda cells, shape: cells[(cells < shape).all(axis=1)] % shape),
            name="negative index",
        ),
        Fault(
            "A point on the board's upper or right border lies on no cell: each cell leaves that border to the next.",
            like=count_like(keep=closed_board),
            name="board's far border kept",
        ),
        Fault(
            "Points beside the board are pushed onto its border: they are not on it.",
            like=count_like(keep=lambda cells, shape: np.clip(cells, 0, shape - 1)),
            name="pushed onto the board",
        ),
        Fault(
            "Points just below the corner fall into cell 0: int() cuts towards zero, floor goes down.",
            like=count_like(lambda points, corner, h: np.trunc((points - corner) / h)),
            name="int for floor",
        ),
        Fault(
            "That is the nearest border, not the cell that the point lies in.",
            like=count_like(lambda points, corner, h: np.round((points - corner) / h)),
            name="round for floor",
        ),
        Fault(
            "A cell holds its lower border, and not its upper one.",
            like=count_like(lambda points, corner, h: np.ceil((points - corner) / h) - 1),
            name="upper border for lower",
        ),
        Fault(
            "shape says how many cells there are along x first, then along y.",
            like=count_like(keep=lambda cells, shape: cells[((cells >= 0) & (cells < shape[::-1])).all(axis=1)]),
            name="x and y changed places",
        ),
    ),
)
