"""Personal: a board of one's own for every student, from a name and a secret.

Beside the story. Each board has a circle, a triangle, a rectangle and a pentagon, one in each quadrant, and all boards
are equally hard by the way they are made: sizes from a narrow band, corners that can be told, at least 15 cm from shape
to shape and 12 cm to the board's edge. Only who knows the salt can make a student's board; the scans that the student
gets hold neither the name nor the salt.

In:  a student's id and a salt that only the teacher knows.
Out: a ``World``; the same for the same two, on every computer.

>>> world = personal_world("ada", salt="0123456789abcdef")
>>> sorted(shape.kind for shape in world.shapes)
['circle', 'pentagon', 'rectangle', 'triangle']
>>> personal_scans(world).ranges.shape[1]
100

The seed is HMAC-SHA256 of the id under the salt: from many boards, neither the salt nor another's board can be found.
While a submission is judged, ``personal_truth`` is its student's board; the process that runs the student's code gets
neither id nor salt. Elsewhere it is that of the demonstration.

Source: RFC 2104, "HMAC: Keyed-Hashing for Message Authentication".
"""

from __future__ import annotations

import hashlib
import hmac
import unicodedata
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any

import numpy as np

from ..arguments import short
from ..lidar import Lidar, Scans, scan
from ..robot import teleport_poses
from ..shapes import Circle, Polygon, Shape
from ..world import QUADRANT_CENTER, QUADRANTS, World
from . import DEMONSTRATION

SALT_LETTERS = 16  # at least: too many salts to be tried out
PURPOSE = b"primkit personal world 1:"  # the same salt for something else gives other numbers

JITTER = 0.05  # m, each way, around the quadrant's middle
# Of the circle that the corners lie on, in m. The middle lies at most 0.275 m out, so that corners stay within 0.375 m.
CORNER_REACH = (0.085, 0.100)
RADIUS = (0.06, 0.09)
WIDTH, HEIGHT = (0.12, 0.16), (0.08, 0.11)  # m: half a diagonal is at most 0.098 m, and no rectangle is a square
# How far a corner may be moved along that circle. Corners then have 40 to 80 degrees in a triangle, and 84 to 132 in a
# pentagon; sides are at least 10 cm and 6 cm long.
CORNER_SHIFT = {3: np.radians(20), 5: np.radians(12)}


def personal_world(student_id: str, *, salt: str) -> World:
    """Return the board of one student.

    Raises ValueError if the id is no text or empty, or the salt is too short.

    Parameters
    ----------
    student_id : str
        Any name that stands for one student, as in the list of students.
    salt : str
        A secret of the teacher's, at least 16 characters; another salt makes other boards.

    Returns
    -------
    World
        Four shapes, one of each kind, on a board of 1 m x 1 m; no two students' are alike, and all equally hard.

    Examples
    --------
    >>> salt = "not this one, please"
    >>> personal_world("ada", salt=salt) == personal_world("ada", salt=salt)
    True
    >>> personal_world("ada", salt=salt) == personal_world("bob", salt=salt)
    False
    """
    _check(student_id, salt)
    key, name = (unicodedata.normalize("NFC", text).encode("utf-8") for text in (salt, student_id))
    digest = hmac.new(key, PURPOSE + name, hashlib.sha256).digest()
    return _board(np.random.default_rng(int.from_bytes(digest, "big")))


def _check(student_id: Any, salt: Any) -> None:
    if not isinstance(student_id, str) or not student_id.strip():
        raise ValueError(f"student_id must be a text that is not empty, got {short(student_id)}")
    if not isinstance(salt, str) or len(salt) < SALT_LETTERS:
        got = f"{len(salt)}" if isinstance(salt, str) else type(salt).__name__  # never the salt itself
        raise ValueError(f"salt must be a text of at least {SALT_LETTERS} characters, got {got}")


def personal_scans(world: World) -> Scans:
    """Return what a robot sees of a board from all way-points, without noise: what a student gets of it."""
    return scan(world, teleport_poses(world), Lidar(), rng=0)


def _board(rng: np.random.Generator) -> World:
    """Return a board with one shape of each kind, each near the middle of a quadrant, turned by any angle."""
    middles = rng.permutation(QUADRANTS) * QUADRANT_CENTER + rng.uniform(-JITTER, JITTER, (4, 2))
    width, height = rng.uniform(*WIDTH), rng.uniform(*HEIGHT)
    corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * (width / 2, height / 2)
    rectangle = Polygon(corners).moved(offset=middles[1], angle=rng.uniform(0, 2 * np.pi))
    shapes: tuple[Shape, ...] = (
        Circle(middles[0], rng.uniform(*RADIUS)),
        rectangle,
        _on_a_circle(3, middles[2], rng),
        _on_a_circle(5, middles[3], rng),
    )
    return World(shapes)


def _on_a_circle(n: int, middle: np.ndarray, rng: np.random.Generator) -> Polygon:
    """Return an irregular polygon whose n corners lie on a circle around ``middle``."""
    turn = rng.uniform(0, 2 * np.pi)
    bearings = turn + 2 * np.pi * np.arange(n) / n + rng.uniform(-CORNER_SHIFT[n], CORNER_SHIFT[n], n)
    return Polygon(middle + rng.uniform(*CORNER_REACH) * np.column_stack([np.cos(bearings), np.sin(bearings)]))


TRUTH: ContextVar[World | None] = ContextVar("TRUTH", default=None)


@contextmanager
def board_of(world: World | None) -> Iterator[None]:
    """Let this be the board that is marked, from now on.

    >>> with board_of(World()):
    ...     len(personal_truth().shapes)
    0
    """
    before = TRUTH.set(world)
    try:
        yield
    finally:
        TRUTH.reset(before)


def personal_truth() -> World:
    """Return the board that the student's scans show."""
    student_id, salt = DEMONSTRATION
    world = TRUTH.get()
    return personal_world(student_id, salt=salt) if world is None else world
