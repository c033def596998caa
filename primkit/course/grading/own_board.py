"""Own board: the one behind the scans that a student got, for the hidden tests of the last problem set.

In:  while a submission is judged, the board that the judge has made from the student's id and the salt. The process
     that runs the student's code gets neither of them.
Out: a ``World``. Elsewhere that of the demonstration: its scans lie beside the teacher's own notebook.

>>> sorted(shape.kind for shape in personal_truth().shapes)
['circle', 'pentagon', 'rectangle', 'triangle']
>>> with board_of(World()):
...     len(personal_truth().shapes)
0
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

from ...world import World
from .. import DEMONSTRATION
from ..personal import personal_world

TRUTH: ContextVar[World | None] = ContextVar("TRUTH", default=None)


@contextmanager
def board_of(world: World | None) -> Iterator[None]:
    """Let this be the board that is marked, from now on."""
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
