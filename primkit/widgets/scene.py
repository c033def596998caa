"""Scene: drive the robot with the keys W A S D or the arrow keys, and watch its map grow.

In:  a ``World`` that the robot does not know, and a ``Lidar``.
Out: ``Scene``, a widget for JupyterLab and Voila; its ``state`` is a ``DriveState``.

>>> from primkit.shapes import Circle
>>> scene = drive_scene(World([Circle((0.3, 0.0), 0.05)]))
>>> scene
Scene: 0.0 s driven, 1 scan, 0 shapes found
>>> scene.close()

The page (``scene.js``, ``board.js``) has the clock: while a key is held it asks for a step ten times a second, one at a
time, and the kernel answers each with what is new. So nothing runs on when nobody drives, and a slow computer drives
slowly instead of lagging behind. Without noise a look for shapes takes some hundredths of a second; with much of it,
2 mm say, it takes longer than a step, and the robot waits for it. Nothing is drawn that the robot has not measured,
unless the truth is switched on; the score knows the truth, too.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import anywidget
import numpy as np
from numpy.typing import NDArray

from ..evidence import GAP
from ..explorer.seen import OUTLINE_STEP
from ..lidar import Lidar
from ..measure import Detection
from ..plots.look import GREY, INK, KIND_COLORS, KIND_INKS, ORANGE, PALE, SKY
from ..robot import BODY, teleport_poses
from ..shapes import Circle, Shape
from ..world import World
from .driving import DriveState, wheels_for

Floats = NDArray[np.float64]
Message = dict[str, Any]

BOARD, PAGE, STYLE = (
    Path(__file__).with_name(name).read_text(encoding="utf-8") for name in ("board.js", "scene.js", "scene.css")
)
COLORS = {"ink": INK, "grey": GREY, "pale": PALE, "beam": SKY, "hit": ORANGE}
FAR = 1e-4  # m: lengths go to the page in tenths of a millimetre


def drive_scene(world: World, lidar: Lidar | None = None, *, journal: str | Path | None = None, rng: int = 0) -> Scene:
    """Show a board on which the robot is driven by hand: W A S D, the arrow keys, or the buttons.

    Parameters
    ----------
    world : World
        What stands on the board; the robot does not know it.
    lidar : Lidar, optional
        The sensor, with its noise; the paper's by default.
    journal : str or path, optional
        A file ending in ``.jsonl`` that each scan is written to as it happens; ``load_drive`` reads it. A file that
        is there already stays as it is: the next free of ``drive.jsonl``, ``drive-2.jsonl``, ... is taken.
    rng : int
        Seed for the sensor's noise and for the search.

    Returns
    -------
    Scene
        A widget, shown when it is the last value of a cell. Its ``state`` has all that the robot knows: ``pose``,
        ``grid``, ``found``, ``score``, ``time``.

    Raises
    ------
    ValueError
        If an argument is of another type, or the robot has no room on the board.

    Examples
    --------
    >>> drive_scene(World(), journal="drive.txt")
    Traceback (most recent call last):
        ...
    ValueError: journal must be a file name that ends in .jsonl, got drive.txt
    """
    return Scene(DriveState(world, lidar, journal=journal, rng=rng))


class Scene(anywidget.AnyWidget):
    """The scene of one ``DriveState``; ``drive_scene`` makes it.

    Parameters
    ----------
    state : DriveState
        The robot and what it knows.
    """

    _esm = f"{BOARD}\n{PAGE}"
    _css = STYLE

    def __init__(self, state: DriveState) -> None:
        super().__init__()
        self.state = state
        self.paused = self.shows_unseen = self.shows_truth = False
        self._shown: list[Message] = []  # the shapes as the page has them
        self._compared: Message | None = None
        self.on_msg(lambda _, asked, __: self.answer(asked))

    def __repr__(self) -> str:
        scans, found = self.state.n_scans, len(self.state.found)
        driven = f"{self.state.time:.1f} s driven, {scans} scan{'s' * (scans != 1)}"
        return f"Scene: {driven}, {found} shape{'s' * (found != 1)} found"

    def answer(self, asked: Message) -> None:
        """Do what the page asks for, and send it what has changed.

        Parameters
        ----------
        asked : dict
            ``{"do": "step", "held": ["forward", "left"]}``; or ``do`` is ``"hello"`` (a page that has just been
            opened, and needs all), ``"undo"``, ``"pause"``, ``"unseen"``, ``"truth"`` or ``"automatic"``.
        """
        match asked:
            case {"do": "step", "held": list(held)}:
                if not self.paused:
                    self._send_step(held)
                else:
                    self.send({"say": "Paused: the robot stands still until you go on.", "done": True})
            case {"do": "hello"}:
                self._send_all()
            case {"do": "undo"}:
                self.state.undo()
                self._compared = None
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
            case {"do": "automatic"}:
                self._send_comparison()

    def _send_step(self, held: list[str]) -> None:
        """Make a step; the page gets the picture before shapes are looked for, and the shapes when they are there."""
        state = self.state
        new = state.move(wheels_for(held))
        message = self._now() | {"cells": new.tolist()}
        if state.stopped:
            message["say"] = "Something is in the way: the robot only turns."
        self.send(message)
        self.send(self._mapped() | {"done": True})
        if self.shows_unseen:
            self._send_unseen()

    def _mapped(self) -> Message:
        """Look for shapes, if it is time to; return what is new about them."""
        if not self.state.map():
            return {}
        before, self._shown = self._shown, [drawn(one) for one in self.state.found]
        if self._shown == before:
            return {}
        return {"shapes": self._shown, "score": self._score(), "say": _news(before, self._shown)}

    def _score(self) -> str:
        state = self.state
        driven = f"{state.time:.1f} s · {state.n_scans:,} scan{'s' * (state.n_scans != 1)}"
        return f"{driven} · {len(state.found)} found · score {state.score:.2f}"

    def _now(self) -> Message:
        """Return what every step changes: pose, ranges, time, score."""
        state = self.state
        ranges = [round(r / FAR) if np.isfinite(r) else -1 for r in state.scan.ranges[0].tolist()]
        record = state.trouble or (f"recording {state.record.name}" if state.record else "")
        pose = [round(float(value), 5) for value in state.pose]
        return {"pose": pose, "ranges": ranges, "scans": state.n_scans, "score": self._score(), "record": record}

    def _send_all(self, say: str = "") -> None:
        """Send all that there is: to a page that knows nothing, or shall forget what it knows."""
        state = self.state
        self._shown = [drawn(one) for one in state.found]
        board = {"size": state.world.size, "body": BODY, "reach": state.lidar.range_max, "cell": state.grid.resolution}
        look = {"colors": COLORS, "kinds": KIND_COLORS, "inks": KIND_INKS}
        all_ = {"board": board, "look": look, "cells": state.grid.cells.tolist(), "shapes": self._shown}
        compared = {"automatic": self._compared}
        self.send(self._now() | all_ | self._truth() | compared | {"paused": self.paused, "say": say})
        self._send_unseen()

    def _send_unseen(self) -> None:
        """Send which squares of the board were not yet seen, a bit each, or none when that is switched off."""
        if not self.shows_unseen:
            self.send({"unseen": 0})
            return
        unseen = self.state.unseen()
        self.send({"unseen": len(unseen)}, [np.packbits(unseen).tobytes()])

    def _truth(self) -> Message:
        shown = self.state.world.shapes if self.shows_truth else ()
        return {"truth": [_tenths(_ring(shape)) for shape in shown], "truthful": self.shows_truth}

    def _send_comparison(self) -> None:
        """Send what the paper's way-points find on this board, and where they are."""
        if self._compared is None:
            run = self.state.automatic()
            found = f"{run.n_found} shape{'s' * (run.n_found != 1)}"
            words = f"Automatic: {run.n_scans} way-points, {found} found, score {run.score:.2f}"
            self._compared = {"words": words, "places": _tenths(teleport_poses(self.state.world)[:, :2])}
        self.send({"automatic": self._compared})

    def close(self) -> None:
        """Take the scene from the page, and close the journal."""
        self.state.close()
        super().close()


def drawn(one: Detection) -> Message:
    """Return how a shape is drawn: its outline in stretches that were seen, or are only supposed, and its name.

    Examples
    --------
    Half of a circle was seen; the last stretch closes on the first:

    >>> circle = Circle((0, 0), 0.1)
    >>> told = drawn(Detection(circle, circle.outline(200)[:101], 0.0, dimension_std=(0.001,)))
    >>> told["name"], [seen for seen, _ in told["stretches"]]
    ('circle, radius 100 mm', [True, False, True])
    """
    ring = _ring(one.shape)
    seen = _seen(ring, one.points)
    stretches, start = [], 0
    for end in range(1, len(ring)):
        if end == len(ring) - 1 or seen[end] != seen[start]:
            stretches.append([bool(seen[start]), _tenths(ring[start : end + 1])])
            start = end
    (place,) = _tenths(one.shape.centroid[None])
    return {"kind": one.kind, "name": _name(one), "place": place, "stretches": stretches}


def _ring(shape: Shape) -> Floats:
    """Return points along the outline, the corners among them, the first one again as the last, shape (N, 2)."""
    if isinstance(shape, Circle):
        ring = shape.outline(max(24, int(shape.perimeter / OUTLINE_STEP)))
    else:
        ring = np.vstack(
            [
                corner + np.linspace(0, 1, max(2, int(side / OUTLINE_STEP)), endpoint=False)[:, None] * edge
                for corner, edge, side in zip(shape.vertices, shape.edges, shape.sides, strict=True)
            ]
        )
    return np.vstack([ring, ring[:1]])


def _seen(places: Floats, points: Floats) -> NDArray[np.bool_]:
    """Tell which places on an outline have a point of their own near them, shape (N,)."""
    from scipy.spatial import cKDTree

    near: NDArray[np.bool_] = cKDTree(points).query(places)[0] <= GAP
    return near


def _name(one: Detection) -> str:
    """Return kind and dimensions in millimetres; a question mark for what was not measured."""
    lengths = [f"{1000 * d:.0f}" if known else "?" for d, known in zip(one.shape.dimensions, one.measured, strict=True)]
    if isinstance(one.shape, Circle):
        return f"circle, radius {lengths[0]} mm"
    if one.kind == "rectangle":
        return f"rectangle, {' x '.join(lengths)} mm"
    return f"{one.kind}, sides {', '.join(lengths)} mm"


def _tenths(points: Floats) -> list[list[int]]:
    """Return points in tenths of a millimetre: short to send, and finer than a screen."""
    told: list[list[int]] = np.rint(points / FAR).astype(int).tolist()
    return told


def _news(before: list[Message], now: list[Message]) -> str:
    """Say in one sentence what is new about the shapes; nothing when only their measures have changed."""
    if [one["kind"] for one in before] == [one["kind"] for one in now]:
        return ""
    if not now:
        return "No shape is found any more."
    return f"Found so far: {', '.join(one['kind'] for one in now)}."
