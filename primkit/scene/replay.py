"""Replay: a drive that was recorded, played like a film in the scene's own picture.

In:  a ``Drive``, as ``load_drive`` returns it.
Out: ``Replay``, a widget with a button and a slider; all is sent at once, so that it plays without Python behind it.

>>> from primkit.lidar import scan
>>> from primkit.shapes import Circle
>>> world = World([Circle((0.3, 0.0), 0.05)])
>>> player = replay(Drive(scan(world, [(0, 0, 0), (0.01, 0, 0)]), [(0, 0), (5, 5)]))
>>> player
Replay: 2 scans in 0.1 s, no shapes found
>>> player.close()

The shapes are those that would have been found on the way: they are looked for each time that the map has grown by a
fifth, and once more in the end.
"""

from __future__ import annotations

import anywidget
import numpy as np
from numpy.typing import NDArray

from ..arguments import Ints, check_type
from ..driving.mapper import Mapper, unmended
from ..evaluation import evaluate
from ..formats import Drive
from ..grid import Grid
from ..lidar import Lidar
from ..measure import CELL
from ..steps import Steps
from ..table import count
from ..world import World, scale_of
from .finder import Look
from .given_back import made_before
from .page import Message, board_and_look, count_found, page, tell_ranges, truth_in

GROWTH = 1.2  # so many times the cells are worth another look
MOST_RANGE = 32_767  # tenths of a millimetre: ranges go to the page as whole numbers of 16 bits


def replay(drive: Drive, world: World | None = None, *, steps: Steps | None = None, rng: int = 0) -> Replay:
    """Show a drive as a film: play, pause, and a slider for the time.

    Raises ValueError if the drive has no scans, or an argument is of another type.

    Parameters
    ----------
    drive : Drive
        What was driven and seen.
    world : World, optional
        The truth: then the score is shown, and a button that shows the outlines.
    steps : Steps, optional
        Functions of your own: the film shows what they would have found. A segmentation of your own is not mended.
    rng : int
        Seed for the search.

    Returns
    -------
    Replay
        A widget, shown when it is the last value of a cell. ``plot_drive`` draws the same as a strip of frames.

    Examples
    --------
    >>> replay([])
    Traceback (most recent call last):
        ...
    ValueError: drive must be a Drive, such as load_drive(path), got list
    """
    check_type(drive, Drive, "drive must be a Drive, such as load_drive(path)")
    if world is not None:
        check_type(world, World, "world must be a World")
    check_type(rng, int, "rng must be a seed, a whole number")
    if len(drive) == 0:
        raise ValueError("a drive must have scans to be played, got none")
    scale = scale_of(drive.lidar.range_max / Lidar.range_max) if world is None else world.scale
    return Replay(drive, world, Film(drive, steps, rng, scale))


class Film:
    """What is new with each scan of a ``Drive``; ``rng`` is the seed for the search, ``scale`` that of the board."""

    def __init__(self, drive: Drive, steps: Steps | None = None, rng: int = 0, scale: float = 1.0) -> None:
        grid, scans, self.scale = Grid(CELL * scale), drive.scans, scale
        cells, first = np.unique(grid.to_cells(scans.points()), axis=0, return_index=True)
        scan_of = np.nonzero(scans.hits)[0][first]
        order = np.argsort(scan_of, kind="stable")
        self.cells: Ints = cells[order]  # in the order in which they were seen, shape (M, 2)
        self.known: Ints = np.searchsorted(scan_of[order], np.arange(len(drive)), side="right")  # after each scan
        self.looks = self._looked_at(drive, Mapper(grid.resolution, settings=unmended(steps), steps=steps, rng=rng))

    def _looked_at(self, drive: Drive, mapper: Mapper) -> list[Look]:
        """Return the shapes on the way, whenever the map has grown enough, and in the end."""
        looks, n_looked_at = [], 0
        for number in range(len(drive)):
            mapper.add(drive.scans[number : number + 1])
            n = len(mapper.grid)
            if n > n_looked_at and (n >= GROWTH * n_looked_at or number == len(drive) - 1):
                looks.append(Look.at(mapper.found, number + 1))
                n_looked_at = n
        return looks


class Replay(anywidget.AnyWidget):
    """The player of one ``Drive``; ``replay`` makes it."""

    _esm = page("board.js", "replay.js")
    _css = page("scene.css")

    def __init__(self, drive: Drive, world: World | None, film: Film) -> None:
        super().__init__()
        self.drive, self.world, self.film = drive, world, film
        for one in made_before(self):
            one.close()
        self.on_msg(lambda _, asked, __: self.answer(asked))

    def __repr__(self) -> str:
        n, found = len(self.drive), len(self.film.looks[-1].found) if self.film.looks else 0
        seconds = (n - 1) * self.drive.period
        return f"Replay: {count(n, 'scan')} in {seconds:.1f} s, {count(found, 'shape')} found"

    def answer(self, asked: Message) -> None:
        """Send the whole film to a page that says hello."""
        if asked == {"do": "hello"}:
            self.send(self.told(), [self._ranges().tobytes(), self.film.cells.astype("<i4").tobytes()])

    def told(self) -> Message:
        """Return all but the ranges and the cells, which go to the page as numbers of two and of four bytes."""
        drive, scale = self.drive, self.film.scale
        size = scale if self.world is None else self.world.size
        looks = [{"scan": look.n_scans - 1, "score": self._score(look)} | look.drawn for look in self.film.looks]
        return board_and_look(size, drive.lidar, scale) | {
            "poses": np.round(drive.poses, 6).tolist(),
            "beams": drive.lidar.beams,
            "period": drive.period,
            "known": self.film.known.tolist(),
            "looks": looks,
            "truths": truth_in(self.world),
        }

    def _score(self, look: Look) -> str:
        if self.world is None:
            return count_found(look.found)
        return f"{count_found(look.found)} · score {evaluate(look.found, self.world).weighted_accuracy:.2f}"

    def _ranges(self) -> NDArray[np.int16]:
        """Return ranges in tenths of a millimetre, shape (P, B), -1 where nothing was hit."""
        return np.minimum(tell_ranges(self.drive.scans.ranges, self.film.scale), MOST_RANGE).astype("<i2")
