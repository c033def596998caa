"""Driving: the robot under somebody's hand, and what it knows so far; the scene without its picture.

In:  a ``World``, and which of the four keys are held during each tenth of a second.
Out: a ``DriveState``: pose, last scan, cells, shapes found so far, score, time.

>>> from primkit.shapes import Circle
>>> state = DriveState(World([Circle((0.3, 0.0), 0.05)]))
>>> step = state.step(wheels_for(["forward"]))
>>> state.pose.round(4).tolist(), len(step.new_cells)
([0.0129, 0.0, 0.0], 2)
>>> state.undo()
>>> state.pose.tolist(), state.n_scans
([0.0, 0.0, 0.0], 1)

Each step turns the wheels for a period of the sensor, scans once, adds the hits to the grid, and looks for shapes when
the grid has grown by a hundredth since the last look; what is left over is looked at when the robot stands or sees
nothing new. What a step takes does not grow with the time: scans are not kept, and the grid is as large as the outlines
are long. Who wants the scans back writes a journal.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arguments import check_type
from ..evaluation import evaluate
from ..explorer.seen import EXPLAINED, SeenMap
from ..formats import DriveJournal, record_drive
from ..grid import Grid
from ..lidar import Lidar, Scans, scan
from ..measure import Detection
from ..pipeline import Memory, find_shapes
from ..robot import FASTEST, advance, start_pose, teleport_poses
from ..world import World

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

TURNING = 0.6  # of the greatest speed: by how much one wheel is faster than the other when turning
STANDING = (0.0, 0.0)  # rad/s: wheels that stand still
GROWN = 1.01  # so many times the cells are worth another look for shapes
HELD = {"forward": (1, 0), "back": (-1, 0), "left": (0, 1), "right": (0, -1)}  # onwards, counter-clockwise


def wheels_for(held: Iterable[str]) -> tuple[float, float]:
    """Return the speeds of the left and the right wheel while some keys are held, radians per second.

    Parameters
    ----------
    held : iterable of str
        Any of ``"forward"``, ``"back"``, ``"left"`` and ``"right"``; opposite ones cancel each other.

    Raises
    ------
    ValueError
        If there is another word among them.

    Examples
    --------
    The robot turns equally fast on the spot and on the way:

    >>> [round(speed, 3) for speed in (*wheels_for(["left"]), *wheels_for(["forward", "left"]))]
    [-1.884, 1.884, 2.512, 6.28]
    """
    words = set(held)
    if not words <= HELD.keys():
        raise ValueError(f"held must be among {', '.join(HELD)}, got {sorted(words - HELD.keys())[0]!r}")
    ahead, turn = (sum(HELD[word][i] for word in words) for i in (0, 1))
    middle = ahead * (1 - abs(turn) * TURNING / 2)  # so that the faster wheel is not too fast
    return FASTEST * (middle - turn * TURNING / 2), FASTEST * (middle + turn * TURNING / 2)


@dataclass(frozen=True, eq=False)
class Step:
    """What one step changed.

    Parameters
    ----------
    new_cells : array of int, shape (M, 2)
        Cells of the grid that were hit for the first time.
    stopped : bool
        Whether something was in the robot's way.
    mapped : bool
        Whether the shapes were looked for anew; else they are what they were.
    """

    new_cells: Ints
    stopped: bool
    mapped: bool


@dataclass(frozen=True)
class Comparison:
    """What the automatic movement finds on the same board: the number of its scans, of its shapes, its score."""

    n_scans: int
    n_found: int
    score: float


class DriveState:
    """A robot that is driven by hand, and its map.

    Parameters
    ----------
    world : World
        What stands on the board.
    lidar : Lidar, optional
        The sensor; the paper's by default. A step takes its period.
    journal : str or path, optional
        A file ending in ``.jsonl`` that each scan is written to as it happens; ``load_drive`` reads it. It is made
        with the first step. No file is ever replaced: where there is one already, and after ``undo``, the next
        free of ``drive.jsonl``, ``drive-2.jsonl``, ... is taken.
    rng : int
        Seed for the sensor's noise and for the search.

    Raises
    ------
    ValueError
        If an argument is of another type, or the robot has no room on the board.
    """

    def __init__(
        self, world: World, lidar: Lidar | None = None, *, journal: str | Path | None = None, rng: int = 0
    ) -> None:
        check_type(world, World, "world must be a World, as in drive_scene(world)")
        self.world, self.lidar, self.seed = world, Lidar() if lidar is None else lidar, rng
        check_type(self.lidar, Lidar, "lidar must be a Lidar, such as Lidar()")
        check_type(rng, int, "rng must be a seed, a whole number")
        self.journal = None if journal is None else Path(journal)
        if self.journal is not None and self.journal.suffix != ".jsonl":
            raise ValueError(f"journal must be a file name that ends in .jsonl, got {self.journal.name}")
        self._written: DriveJournal | None = None
        self.undo()

    def undo(self) -> None:
        """Go back to the start and forget all that was seen; what was written to a journal stays."""
        self.close()
        self.trouble = ""  # why the journal could not be written, in one sentence
        self.pose, self.n_scans, self.stopped = start_pose(self.world), 0, False
        self.grid, self.found = Grid(), list[Detection]()
        self.seen_map = SeenMap(self.world.size)
        self._rng = np.random.default_rng(self.seed)
        self._memory: Memory = {}
        self._cells: set[tuple[int, int]] = set()
        self._n_mapped = 0  # cells that the shapes were found among
        self._rests = True  # stands, or sees nothing new
        self._look()
        self.map()

    def step(self, wheels: ArrayLike = STANDING) -> Step:
        """Turn the wheels for a period, scan, and map: ``move`` and ``map`` together.

        Parameters
        ----------
        wheels : array_like, shape (2,)
            Speeds of the left and the right wheel, radians per second; see ``wheels_for``.

        Returns
        -------
        Step
            What has changed.

        Raises
        ------
        ValueError
            If the wheels are too fast; all then stays as it was.
        """
        new = self.move(wheels)
        return Step(new, self.stopped, self.map())

    def move(self, wheels: ArrayLike = STANDING) -> Ints:
        """Turn the wheels for a period and scan; return the cells that are new, shape (M, 2)."""
        self.pose, self.stopped = advance(self.world, self.pose, wheels, self.lidar.period)
        before = self.scan
        new = self._look()
        self._rests = len(new) == 0 or not np.any(wheels)
        self._write(before, wheels)
        return new

    def map(self) -> bool:
        """Look for shapes, if there is enough to look at; tell whether that was so."""
        n, before = len(self.grid), self._n_mapped
        if n == before or (n < GROWN * before and not self._rests):
            return False
        self.found = find_shapes(self.grid.points(), memory=self._memory, rng=self.seed)
        self._n_mapped = n
        return True

    def _look(self) -> Ints:
        """Scan from where the robot is, and return the cells that are new, shape (M, 2)."""
        self.scan: Scans = scan(self.world, self.pose, self.lidar, rng=self._rng)
        self.n_scans += 1
        self.seen_map.add(self.scan, self.lidar.range_min, self.lidar.range_max)
        hit = {(i, j) for i, j in self.grid.to_cells(self.scan.points()).tolist()} - self._cells
        if hit:
            self._cells |= hit
            self.grid.add(self.scan)
        return np.array(sorted(hit), dtype=np.int64).reshape(-1, 2)

    @property
    def time(self) -> float:
        """How long the robot has been driving, seconds: a period for each step."""
        return (self.n_scans - 1) * self.lidar.period

    @property
    def score(self) -> float:
        """Weighted accuracy of what was found so far, 0 to 1."""
        return evaluate(self.found, self.world).weighted_accuracy

    def unseen(self) -> NDArray[np.bool_]:
        """Return which squares of a centimetre may still hide a shape, shape (N, N), as ``SeenMap`` numbers them."""
        explained = self.seen_map.covered([one.shape for one in self.found], EXPLAINED)
        return self.seen_map.hiding_places(explained)

    def automatic(self) -> Comparison:
        """Scan the same board from the paper's way-points, with the same sensor, and return what comes out."""
        scans = scan(self.world, teleport_poses(self.world), self.lidar, rng=self.seed)
        grid = Grid()
        grid.add(scans)
        found = find_shapes(grid.points(), rng=self.seed)
        return Comparison(len(scans), len(found), evaluate(found, self.world).weighted_accuracy)

    def _write(self, before: Scans, wheels: ArrayLike) -> None:
        """Write the last scan to the journal, and the one before any step when there is none yet."""
        if self.journal is None or self.trouble:
            return
        try:
            if self._written is None:
                self._written = _opened(self.journal, self.lidar)
                self._written.add(before, STANDING)
            self._written.add(self.scan, wheels)
        except (OSError, ValueError) as error:  # a full disk ends the record, not the drive
            self.trouble = str(error)
            self.close()

    @property
    def record(self) -> Path | None:
        """The file that this drive is being written to; None before the first step, or without a journal."""
        return None if self._written is None else self._written.path

    def close(self) -> None:
        """Close the journal, if one is open; the next step after this begins another."""
        if self._written is not None:
            self._written.close()
        self._written = None


def _opened(path: Path, lidar: Lidar) -> DriveJournal:
    """Open a journal in a file of its own: the first of drive.jsonl, drive-2.jsonl, ... that is free."""
    number, free = 1, path
    while True:
        try:
            return record_drive(free, lidar)
        except FileExistsError:
            number += 1
            free = path.with_stem(f"{path.stem}-{number}")
