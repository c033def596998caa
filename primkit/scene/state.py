"""State: the robot under somebody's hand, and what it knows so far; the scene without its picture.

In:  a ``World``, and the speeds of the wheels for each tenth of a second.
Out: a ``DriveState``: pose, last scan, cells, shapes found so far, score, time.

>>> from primkit.shapes import Circle
>>> from primkit.scene.keys import wheels_for
>>> state = DriveState(World([Circle((0.3, 0.0), 0.05)]))
>>> step = state.step(wheels_for(["forward"]))
>>> state.pose.round(4).tolist(), len(step.new_cells)
([0.0129, 0.0, 0.0], 2)
>>> state.undo()
>>> state.pose.tolist(), state.n_scans
([0.0, 0.0, 0.0], 1)

A step turns the wheels for a period of the sensor, scans once, and adds the hits to the grid. A look for shapes begins

    when the cells that are new or gone since the last look  >=  1 % of the grid,

or any at all, once the robot stands or sees nothing new. In a script it is done before the step is (``AtOnce``), in the
scene beside the drive. A step takes no longer at the end of a drive: scans are not kept; a journal keeps them.
"""

from __future__ import annotations

from concurrent.futures import Executor
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arguments import Ints, check_type
from ..driving.mapper import Mapper, unmended
from ..driving.moving_grid import MovingGrid
from ..driving.seen_map import EXPLAINED, SeenMap, outlines_in
from ..evaluation import evaluate
from ..formats import DriveJournal, record_drive
from ..found import Found
from ..grid import Grid
from ..lidar import Lidar, Scans, as_lidar, scan
from ..robot import advance, start_pose
from ..steps import Steps
from ..table import Table
from ..world import World
from .finder import MOST_CELLS, AtOnce, Finder, Look
from .keys import STANDING_WHEELS
from .moved_shape import find_left_within, move_one_shape
from .own_steps import OwnSteps
from .runs import Run, automatic_runs, compare_runs

NEWS_SHARE = 0.01  # when this share of the cells has come or gone since the last look, it is time for another
KEY_STRIDE = 1 << 31  # cells: farther apart than any two on a board


@dataclass(frozen=True, eq=False)
class Step:
    """What one step changed: cells that are new, (M, 2), and given up, (K, 2), where things may move.

    ``stopped``: something was in the robot's way. ``mapped``: a look for shapes was done; else they are as before.
    """

    new_cells: Ints
    gone_cells: Ints
    stopped: bool
    mapped: bool


class DriveState:
    """A robot that is driven by hand, and its map.

    Raises ValueError if an argument is of another type, or the robot has no room on the board.

    Parameters
    ----------
    world, lidar, journal, moving, steps, rng
        As for ``drive_scene``. The journal is made with the first step, and another one after ``undo``.
    executor : Executor, optional
        Who looks for shapes: ``AtOnce()`` by default, ``Beside()`` in a thread of its own.
    """

    def __init__(
        self,
        world: World,
        lidar: Lidar | None = None,
        *,
        journal: str | Path | None = None,
        moving: bool = False,
        steps: Steps | None = None,
        rng: int = 0,
        executor: Executor | None = None,
    ) -> None:
        check_type(world, World, "world must be a World, as in drive_scene(world)")
        self.lidar, self.seed, self.moving = as_lidar(lidar, world.scale), rng, moving
        check_type(moving, bool, "moving must be True or False")
        self.steps = steps
        self.own = OwnSteps(Steps() if steps is None else steps)
        check_type(rng, int, "rng must be a seed, a whole number")
        self.journal = None if journal is None else Path(journal)
        if self.journal is not None and self.journal.suffix != ".jsonl":
            raise ValueError(f"journal must be a file name that ends in .jsonl, got {self.journal.name}")
        self._start_world = world
        self._written: DriveJournal | None = None
        self.finder = Finder(AtOnce() if executor is None else executor)
        self.undo()
        if steps is None:
            self.finish()

    def undo(self) -> None:
        """Go back to the start and forget all that was seen; what was written to a journal stays."""
        self._end_journal()
        self.trouble = ""  # why the journal could not be written, in one sentence
        self.world, self.pose, self.n_scans, self.stopped = self._start_world, start_pose(self._start_world), 0, False
        cell = self.world.cell
        self._map_anew(MovingGrid(cell, self.lidar) if self.moving else Grid(cell))
        self._cells = self.grid.cells  # as they were told last
        self.last = Look.at(Found(), 0)  # the last look that was done
        self._scored = (self.last, self.world, 0.0)
        self.seen_map = SeenMap(self.world.size)
        self._rng, self._hand = np.random.default_rng(self.seed), np.random.default_rng([self.seed, 1])
        self._n_news = 0  # cells that have come or gone since the last look began
        self._rests = True  # stands, or sees nothing new
        self._scan()
        if self.steps is None:  # somebody's own may be slow, or wrong: first there is something to drive
            self.map()

    def _map_anew(self, grid: Grid | MovingGrid) -> None:
        """Go on with a grid, and forget all fits so far."""
        self.finder.forget()
        self._mapper = Mapper(grid=grid, settings=unmended(self.steps), steps=self.own.steps, rng=self.seed)

    @property
    def grid(self) -> Grid | MovingGrid:
        """All cells that were hit; where things may move, those that still stand."""
        return self._mapper.grid

    @property
    def found(self) -> Found:
        """The shapes found so far, and what else the points are."""
        return self.last.found

    @property
    def n_scans_found(self) -> int:
        """How many scans the shapes were found in."""
        return self.last.n_scans

    def step(self, wheels: ArrayLike = STANDING_WHEELS) -> Step:
        """Turn the wheels for a period, scan, and map: ``move`` and ``map`` together.

        Raises ValueError if the wheels are too fast; all then stays as it was.

        Parameters
        ----------
        wheels : array_like, shape (2,)
            Speeds of the left and the right wheel, radians per second, as ``wheels_for`` gives them.
        """
        new, gone = self.move(wheels)
        return Step(new, gone, self.stopped, self.map())

    def move(self, wheels: ArrayLike = STANDING_WHEELS) -> tuple[Ints, Ints]:
        """Turn the wheels for a period and scan; return the cells that are new and that are gone, shapes (M, 2)."""
        self.pose, self.stopped = advance(self.world, self.pose, wheels, self.lidar.period)
        before = self.scan
        new, gone = self._scan()
        self._rests = len(new) == 0 or not np.any(wheels)
        self._write(before, wheels)
        return new, gone

    def map(self) -> bool:
        """Fetch the shapes of a look that is done, and begin another when it is time; tell whether one was done.

        Whatever ended a look that could not be finished is raised.
        """
        done = self._fetch()
        enough = 0 < self._n_news >= (0 if self._rests else NEWS_SHARE * len(self.grid))
        if enough and not self.finder.busy:
            self._begin_look()
            done = self._fetch() or done
        return done

    def _begin_look(self, most: int = MOST_CELLS) -> None:
        """Have the map looked at, or so many of its cells."""
        self._n_news = 0
        if not self.finder.busy:
            self.own.begin()
        judge = self.own.steps.score and partial(self.own.steps.judged, world=self.world)
        self.finder.look(self._mapper, self.n_scans, most, judge)

    def _fetch(self, wait: bool = False) -> bool:
        news = self.finder.news(wait=wait)
        if news is not None:
            self.last = news
            if isinstance(self.grid, MovingGrid):
                self.grid.give_up(find_left_within(self.grid, self.found))  # the next scan tells what is gone
        return news is not None

    def finish(self) -> None:
        """Look at all that was seen, afresh, and wait for it: ``found`` is then what ``find_shapes`` makes of the map.

        Whatever ended a look that could not be finished is raised.
        """
        looked_at = -1
        while looked_at != len(self.grid):  # what the shapes rule out is given up, and leaves another map
            looked_at = len(self.grid)
            self._map_anew(self.grid)
            self._begin_look(most=looked_at)
            self._fetch(wait=True)

    @property
    def looks(self) -> bool:
        """Whether a look is under way, or due as soon as the robot rests."""
        return self.finder.busy or (self._rests and self._n_news > 0)

    def _scan(self) -> tuple[Ints, Ints]:
        """Scan from where the robot is, and return the cells that are new, and that are gone, shapes (M, 2)."""
        self.scan: Scans = scan(self.world, self.pose, self.lidar, rng=self._rng)
        self.n_scans += 1
        self.seen_map.add(self.scan, self.lidar.range_min, self.lidar.range_max)
        before = self._cells
        self._mapper.add(self.scan)
        self._cells = now = self.grid.cells
        new, gone = _only_in(now, before), _only_in(before, now)
        self._n_news += len(new) + len(gone)
        return new, gone

    def move_something(self) -> bool:
        """Move one shape to another place, unseen by the robot, as ``rearrange``; tell whether there was room."""
        after = move_one_shape(self.world, self.pose, self._hand)
        if after is not None:
            self.rearrange(after)
        return after is not None

    def rearrange(self, world: World) -> None:
        """Put things where they are in another world, of the same size; the robot stays where it is.

        Raises ValueError if the map is one of things that stand still, the board is of another size, or the robot would
        stand in a shape.
        """
        if not self.moving:
            raise ValueError("things must be allowed to move, as in drive_scene(world, moving=True)")
        check_type(world, World, "world must be a World")
        if world.size != self.world.size:
            raise ValueError(f"the board must stay {self.world.size:g} m wide, got {world.size:g} m")
        advance(world, self.pose, STANDING_WHEELS, 0)  # refuses a place in a shape
        self.world = world

    @property
    def time(self) -> float:
        """How long the robot has been driving, seconds: a period for each step."""
        return (self.n_scans - 1) * self.lidar.period

    @property
    def score(self) -> float:
        """Weighted accuracy of what was found so far, 0 to 1."""
        if self._scored[:2] != (self.last, self.world):  # each is compared with itself: looks have no other equality
            self._scored = (self.last, self.world, evaluate(self.found, self.world).weighted_accuracy)
        return self._scored[2]

    def unseen(self) -> NDArray[np.bool_]:
        """Return which squares of a centimetre may still hide a shape, shape (N, N), as ``SeenMap`` numbers them."""
        explained = self.seen_map.covered(outlines_in(self.found, self.world.scale), EXPLAINED)
        return self.seen_map.hiding_places(explained)

    def compare(self) -> Table:
        """Return this drive beside the way-points and ``explore`` on the same board, which takes some seconds."""
        self.finish()
        return compare_runs((self.by_hand(), *automatic_runs(self.world, self.lidar, self.seed, self.steps)))

    def by_hand(self) -> Run:
        """Return what came of this drive so far."""
        name, note = "by hand", "it scans while it drives"
        return Run(name, self.n_scans, self.time, len(self.found), self.score, note, self.pose[None, :2])

    def _write(self, before: Scans, wheels: ArrayLike) -> None:
        """Write the last scan to the journal, and the one before any step when there is none yet."""
        if self.journal is None or self.trouble:
            return
        try:
            if self._written is None:
                self._written = _opened(self.journal, self.lidar)
                self._written.add(before, STANDING_WHEELS)
            self._written.add(self.scan, wheels)
        except (OSError, ValueError) as error:  # a full disk ends the record, not the drive
            self.trouble = str(error)
            self._end_journal()

    @property
    def record(self) -> Path | None:
        """The file that this drive is being written to; None before the first step, or without a journal."""
        return None if self._written is None else self._written.path

    def close(self) -> None:
        """Close the journal, if one is open, and let go of who looks for shapes."""
        self._end_journal()
        self.finder.close()

    def _end_journal(self) -> None:
        """Close the journal, if one is open; the next step after this begins another."""
        if self._written is not None:
            self._written.close()
        self._written = None


def _only_in(cells: Ints, others: Ints) -> Ints:
    """Return the cells that are not among the others, shape (M, 2); in both no cell stands twice."""
    one, other = (each[:, 0] * KEY_STRIDE + each[:, 1] for each in (cells, others))
    return cells[np.isin(one, other, assume_unique=True, invert=True)]


def _opened(path: Path, lidar: Lidar) -> DriveJournal:
    """Open a journal in a file of its own: the first of drive.jsonl, drive-2.jsonl, ... that is free."""
    number, free = 1, path
    while True:
        try:
            return record_drive(free, lidar)
        except FileExistsError:
            number += 1
            free = path.with_stem(f"{path.stem}-{number}")
