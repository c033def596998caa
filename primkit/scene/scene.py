"""Scene: drive the robot with the keys W A S D or the arrow keys, and watch its map grow.

In:  a ``World`` that the robot does not know, and a ``Lidar``.
Out: ``Scene``, a widget for JupyterLab and Voila; its ``state`` is a ``DriveState``.

>>> from primkit.shapes import Circle
>>> scene = drive_scene(World([Circle((0.3, 0.0), 0.05)]))
>>> scene
Scene: 0.0 s driven, 1 scan, no shapes found
>>> scene.close()

The page (``scene.js``, ``board.js``) has the clock: while a key is held it asks for a step ten times a second, one at a
time, and the kernel answers each with what is new; a slow computer drives slowly instead of lagging behind. Shapes are
looked for beside that, in a thread; outlines that are some scans old are said to be. Only what the robot has measured
is drawn, unless the truth is switched on; the score knows the truth.
"""

from __future__ import annotations

import time
from concurrent.futures import Executor, Future
from functools import partial
from pathlib import Path

import anywidget
import numpy as np

from ..found import Found
from ..lidar import Lidar
from ..steps import Steps
from ..table import count
from ..world import World
from .finder import Beside, Look
from .given_back import made_before
from .keys import wheels_for
from .own_steps import StepError
from .page import Message, board_and_look, count_found, page, tell_ranges, tenths, truth_in
from .runs import Run, automatic_runs, compare_runs
from .state import DriveState

FRESH_SCANS = 5  # scans: outlines that know all scans but so many are as good as new
LOOKING_SHARE = 0.2  # of the time, at most, goes to looks while somebody drives where there is no thread for them


def drive_scene(
    world: World,
    lidar: Lidar | None = None,
    *,
    journal: str | Path | None = None,
    moving: bool = False,
    steps: Steps | None = None,
    rng: int = 0,
    executor: Executor | None = None,
) -> Scene:
    """Show a board on which the robot is driven by hand: W A S D, the arrow keys, or the buttons.

    Raises ValueError if an argument is of another type, or the robot has no room on the board.

    Parameters
    ----------
    world : World
        What stands on the board; the robot does not know it.
    lidar : Lidar, optional
        The sensor, with its noise; the paper's by default.
    journal : str or path, optional
        A file ending in ``.jsonl`` that each scan is written to as it happens; ``load_drive`` reads it. A file that
        is there already stays as it is: the next free of ``drive.jsonl``, ``drive-2.jsonl``, ... is taken.
    moving : bool
        Whether things may be moved meanwhile, by a button more; the map then gives up what later scans contradict.
    steps : Steps, optional
        Functions of your own in the place of the library's: what the robot sees is then what they make of its points,
        while you drive. A segmentation of your own is not mended. Whatever they do, the robot follows the keys; what
        is slow, raises or returns nonsense is told in the scene.
    rng : int
        Seed for the sensor's noise, for the search, and for what is moved where.
    executor : Executor, optional
        Who looks for shapes while the robot drives; a thread of its own by default.

    Returns
    -------
    Scene
        A widget, shown when it is the last value of a cell. Its ``state`` has all that the robot knows: ``pose``,
        ``grid``, ``found``, ``score``, ``time``; ``state.finish()`` waits until the shapes are up to date.

    Examples
    --------
    >>> drive_scene(World(), journal="drive.txt")
    Traceback (most recent call last):
        ...
    ValueError: journal must be a file name that ends in .jsonl, got drive.txt
    """
    executor = Beside() if executor is None else executor
    return Scene(DriveState(world, lidar, journal=journal, moving=moving, steps=steps, rng=rng, executor=executor))


class Scene(anywidget.AnyWidget):
    """The scene of one ``DriveState``; ``drive_scene`` makes it.

    Parameters
    ----------
    state : DriveState
        The robot and what it knows.
    """

    _esm = page("board.js", "hand.js", "scene.js")
    _css = page("scene.css")

    def __init__(self, state: DriveState) -> None:
        super().__init__()
        self.state = state
        self.paused = self.shows_unseen = self.shows_truth = False
        self._shown = state.last  # the look that the page has
        self._failed = ""  # why the last look could not be finished
        self._look_from = 0.0  # s, by the clock: no look before, where looks block the way
        self._automatic: Future[tuple[Run, Run]] | None = None  # under way, or done
        self._compared: Message | None = None
        for one in made_before(self):
            one.close()
        self.on_msg(lambda _, asked, __: self.answer(asked))

    def __repr__(self) -> str:
        scans, found = count(self.state.n_scans, "scan"), count(len(self.state.found), "shape")
        return f"Scene: {self.state.time:.1f} s driven, {scans}, {found} found"

    def answer(self, asked: Message) -> None:
        """Do what the page asks for, and send it what has changed.

        Parameters
        ----------
        asked : dict
            ``{"do": "step", "held": ["forward", "left"]}``; or ``do`` is ``"news"`` (of what goes on beside the
            drive), ``"hello"`` (a page that has just been opened, and needs all), ``"undo"``, ``"pause"``,
            ``"unseen"``, ``"truth"``, ``"move"`` or ``"automatic"``.
        """
        match asked:
            case {"do": "step", "held": list(held)}:
                if not self.paused:
                    self._send_step(held)
                else:
                    self.send({"say": "Paused: the robot stands still until you go on.", "done": True})
            case {"do": "news"}:
                self.send(self._news() | {"done": True})
            case {"do": "hello"}:
                self._send_all()
            case {"do": "undo"}:
                self.state.undo()
                self._automatic = self._compared = None
                self._send_all("Back at the start: all is forgotten.")
            case {"do": "pause"}:
                self.paused = not self.paused
                self.send({"paused": self.paused, "say": "Paused." if self.paused else "Going on."})
            case {"do": "unseen"}:
                self.shows_unseen = not self.shows_unseen
                self._send_unseen()
            case {"do": "truth"}:
                self.shows_truth = not self.shows_truth
                self.send(self._truth())
            case {"do": "move"}:
                self._move_something()
            case {"do": "automatic"}:
                self._compare()

    def _send_step(self, held: list[str]) -> None:
        """Make a step; the page gets the picture before anything is said of shapes."""
        state = self.state
        new, gone = state.move(wheels_for(held))
        message = self._now() | {"cells": new.tolist(), "gone": gone.tolist()}
        if state.stopped:
            message["say"] = "Something is in the way: the robot only turns."
        self.send(message)
        self.send(self._news(held=bool(held)) | {"done": True})
        if self.shows_unseen:
            self._send_unseen()

    def _news(self, held: bool = False) -> Message:
        """Return what has come of the work beside the drive, and whether there is more to come."""
        return self._mapped(held) | self._comparison() | {"busy": self._busy}

    @property
    def _busy(self) -> bool:
        """Whether there is more to come, even if nobody drives."""
        return self.state.looks or (self._automatic is not None and self._compared is None)

    def _mapped(self, held: bool) -> Message:
        """Fetch shapes, begin to look for them if it is time to; return what is new about them."""
        begun = time.monotonic()
        if held and self.state.finder.in_the_way and begun < self._look_from:
            return {"trouble": self._trouble()}
        try:
            if self.state.map():
                self._failed = ""
        except Exception as error:  # whatever it is: who drives must hear of it, and can drive on
            self._failed = (
                str(error) if isinstance(error, StepError | ValueError) else f"{type(error).__name__}: {error}"
            )
        self._look_from = begun + (time.monotonic() - begun) / LOOKING_SHARE
        before, self._shown = self._shown, self.state.last
        if self._shown is before:
            return {"trouble": self._trouble()}
        return self._shown.drawn | {
            "score": self._score(),
            "trouble": self._trouble(),
            "say": _news_of(before, self._shown),
        }

    def _trouble(self) -> str:
        """Return in one sentence what is the matter with somebody's own steps; nothing if all is well."""
        own = self.state.own
        what = self._failed or own.nonsense(self.state.found) or own.slow
        return f"{what}; the drive goes on." if what else ""

    def _score(self) -> str:
        state = self.state
        driven = f"{state.time:.1f} s · {count(state.n_scans, 'scan')}"
        age = state.n_scans - state.n_scans_found
        old = f" · shapes {age * state.lidar.period:.1f} s old" if age > FRESH_SCANS and state.looks else ""
        own = "" if state.last.own_score is None else f", yours {state.last.own_score:.2f}"
        return f"{driven} · {count_found(state.found)} · score {state.score:.2f}{own}{old}"

    def _now(self) -> Message:
        """Return what every step changes: pose, ranges, time, score."""
        state = self.state
        record = state.trouble or (f"recording {state.record.name}" if state.record else "")
        pose = [round(float(value), 6) for value in state.pose]
        ranges = tell_ranges(state.scan.ranges[0], state.world.scale).tolist()
        return {"pose": pose, "ranges": ranges, "scans": state.n_scans, "score": self._score(), "record": record}

    def _send_all(self, say: str = "") -> None:
        """Send all that there is: to a page that knows nothing, or shall forget what it knows."""
        state = self.state
        self._shown = state.last
        same = board_and_look(state.world.size, state.lidar, state.world.scale) | {"moving": state.moving}
        all_ = self._shown.drawn | {"cells": state.grid.cells.tolist(), "automatic": self._compared}
        self.send(self._now() | same | all_ | self._truth() | {"paused": self.paused, "say": say, "busy": self._busy})
        self._send_unseen()

    def _send_unseen(self) -> None:
        """Send which squares of the board were not yet seen, a bit each, or none when that is switched off."""
        if not self.shows_unseen:
            self.send({"unseen": 0})
            return
        unseen = self.state.unseen()
        self.send({"unseen": len(unseen)}, [np.packbits(unseen).tobytes()])

    def _truth(self) -> Message:
        return {"truth": truth_in(self.state.world if self.shows_truth else None), "truthful": self.shows_truth}

    def _move_something(self) -> None:
        """Move a shape; what the robot has seen of it stays until it looks again."""
        moved = self.state.move_something()
        self._automatic = self._compared = None  # that was another board
        say = "Somebody has moved a shape. Go and look." if moved else "There is no room to move anything."
        self.send(self._truth() | {"say": say, "automatic": None, "score": self._score()})

    def _compare(self) -> None:
        """Begin to drive by itself on this board, beside the drive by hand; or say again what came of it."""
        state = self.state
        if self._automatic is None:
            work = partial(automatic_runs, state.world, state.lidar, state.seed, state.steps and state.own.steps)
            self._automatic = state.finder.submit(work)
            self.send({"say": "The robot drives by itself now: way-points, then explore."})
        self.send(self._news())

    def _comparison(self) -> Message:
        """Return the runs beside each other, once the automatic ones are done."""
        if self._automatic is None or not self._automatic.done():
            return {}
        try:
            automatic = self._automatic.result()
        except Exception as error:
            self._automatic = None
            return {"say": f"The robot cannot drive by itself here: {type(error).__name__}: {error}"}
        places = {run.name: tenths(run.way, self.state.world.scale) for run in automatic}
        table = compare_runs((self.state.by_hand(), *automatic))
        say = {} if self._compared else {"say": "The robot has driven by itself, too: see the table."}
        self._compared = {"table": [table.header, *table.rows], "places": places}
        return {"automatic": self._compared} | say

    def close(self) -> None:
        """Take the scene from the page, close the journal, and end the work beside the drive."""
        self.state.close()
        super().close()


def _news_of(before: Look, now: Look) -> str:
    """Say in one sentence what is new about the shapes; nothing when only their measures have changed."""
    names, known = (_names_of(look.found) for look in (now, before))
    if names == known:
        return ""
    return f"Found so far: {names}." if names else "No shape is found any more."


def _names_of(found: Found) -> str:
    """Return the kinds of what is certain, and how many are not: "circle, pentagon, and 2 that are not certain"."""
    names = [one.kind for one in found if one.certain]
    open_ = len(found) - len(names)
    rest = [f"{'and ' * bool(names)}{open_} that {'is' if open_ == 1 else 'are'} not certain"] if open_ else []
    return ", ".join(names + rest)
