"""Finder: look for shapes beside the drive, so that the robot never waits for them.

In:  a ``Mapper``, again and again, while its map grows.
Out: ``Look``: the shapes of the last look that is done, and how many scans it knew.

>>> from primkit.driving.mapper import Mapper
>>> from primkit.shapes import Circle
>>> finder, mapper = Finder(AtOnce()), Mapper(rng=0)
>>> mapper.add(Circle((0.1, 0.0), 0.06).outline(150))
>>> finder.look(mapper, n_scans=7)
>>> look = finder.news()
>>> [one.kind for one in look.found], look.n_scans, finder.news()
(['circle'], 7, None)

There is one look at a time; another that is asked for meanwhile is not begun, and the next takes the points that are
newest then. ``Beside()`` looks in a thread that ends with the look; ``AtOnce()`` in the caller's, so that the same
drive gives the same shapes on any computer. ``thin_out`` bounds the cells of a look, and so its time and memory.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor, Future
from copy import copy
from dataclasses import dataclass
from threading import Thread
from typing import ParamSpec, TypeVar

import numpy as np

from ..arguments import Bools, Ints
from ..driving.mapper import Mapper
from ..found import Found
from ..grid import Grid
from .page import Message, describe

P = ParamSpec("P")
T = TypeVar("T")

MOST_CELLS = 6000  # cells: a look at so many takes a quarter of a second; only noise makes more
SHARE_STEP = 0.8  # times the share, where it is still too large: seldom, as each new share makes all fits anew
HASH_FACTORS = (0x9E3779B97F4A7C15, 0xC2B2AE3D27D4EB4F)  # odd and large, so that neighbours have nothing in common


class AtOnce(Executor):
    """An executor that does what it is given before it returns."""

    def submit(self, fn: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> Future[T]:
        """Do it, and return what came of it."""
        done: Future[T] = Future()
        _do(done, fn, *args, **kwargs)
        return done


class Beside(Executor):
    """An executor with a thread for each thing to do, and none when there is nothing; without threads, it does it now.

    What never ends keeps nobody from leaving: its thread ends with the program.
    """

    threads = True  # until it turns out that there are none

    def submit(self, fn: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> Future[T]:
        """Begin it, and return what will come of it."""
        done: Future[T] = Future()
        try:
            Thread(target=_do, args=(done, fn, *args), kwargs=kwargs, name="primkit-finder", daemon=True).start()
        except RuntimeError:  # a browser's Python cannot start one
            self.threads = False
            _do(done, fn, *args, **kwargs)
        return done


def _do(done: Future[T], fn: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> None:
    """Do it, and tell the future what came of it."""
    try:
        done.set_result(fn(*args, **kwargs))
    except Exception as error:  # it is for who asks for the result, as with any executor
        done.set_exception(error)


@dataclass(frozen=True, eq=False)
class Look:
    """The shapes that were found, from left to right; how many scans the points were made of; and how all is drawn.

    ``own_score``: what somebody's own score says of them; None without one.
    """

    found: Found
    n_scans: int
    drawn: Message
    own_score: float | None = None

    @classmethod
    def at(cls, found: Found, n_scans: int, judge: Callable[[Found], float] | None = None) -> Look:
        """Return the look; what it takes to draw it is worked out here, where the robot does not wait for it."""
        return cls(found, n_scans, describe(found), judge and judge(found))


def thin_out(cells: Ints, most: int = MOST_CELLS) -> Bools:
    """Tell which cells are looked at when there are too many: a share of them, by a hash of each, shape (N,).

    A cell is chosen whatever else there is: while the share stays the same, the chosen cells of a map that grows only
    grow, and the last look is a warm start for the next.

    >>> cells = np.stack(np.meshgrid(np.arange(100), np.arange(100)), axis=-1).reshape(-1, 2)
    >>> [int(thin_out(cells[:n], 4000).sum()) for n in (4000, 10_000)]
    [4000, 3269]
    """
    mixed = cells.astype(np.uint64) @ np.array(HASH_FACTORS, dtype=np.uint64)
    mixed ^= mixed >> np.uint64(29)
    lot = ((mixed * np.uint64(HASH_FACTORS[0])) >> np.uint64(40)) / 2.0**24  # 0 to 1, evenly
    share, chosen = 1.0, np.ones(len(cells), dtype=bool)
    while np.count_nonzero(chosen) > most:
        share *= SHARE_STEP
        chosen = lot < share
    return chosen


class Finder:
    """Looks for shapes in maps that grow, one look at a time.

    Parameters
    ----------
    executor : Executor
        Who does the work: ``AtOnce()``, ``Beside()``, or any other of ``concurrent.futures`` within this process.
    """

    def __init__(self, executor: Executor) -> None:
        self._executor = executor
        self._under_way: Future[Look] | None = None

    def forget(self) -> None:
        """Drop a look that is still under way."""
        self._under_way = None

    @property
    def busy(self) -> bool:
        """Whether a look is under way, or its shapes have not been fetched yet."""
        return self._under_way is not None

    @property
    def in_the_way(self) -> bool:
        """Whether looks make the robot wait, because there are no threads to do them beside the drive."""
        return isinstance(self._executor, Beside) and not self._executor.threads

    def look(
        self,
        mapper: Mapper,
        n_scans: int,
        most: int = MOST_CELLS,
        judge: Callable[[Found], float] | None = None,
    ) -> None:
        """Begin to look at a map as it is now, or at so many of its cells; while another look lasts, do nothing."""
        if self._under_way is None:
            grid = copy(mapper.grid)
            if len(grid) > most:
                which = thin_out(grid.cells, most)
                grid = Grid.of(grid.cells[which], grid.last_seen[which], grid.resolution)
            self._under_way = self._executor.submit(lambda: Look.at(mapper.look(grid), n_scans, judge))

    def news(self, *, wait: bool = False) -> Look | None:
        """Return the look that was begun, once it is done (``wait`` for that), and once only; None without news.

        Raises
        ------
        Exception
            Whatever ended the look, if it could not be finished.
        """
        look = self._under_way
        if look is None or not (wait or look.done()):
            return None
        self._under_way = None
        return look.result()

    def submit(self, work: Callable[[], T]) -> Future[T]:
        """Have other work done beside the drive."""
        return self._executor.submit(work)

    def close(self) -> None:
        """Drop a look that is under way; those that are asked for later are done at once."""
        self._executor = AtOnce()
        self.forget()
