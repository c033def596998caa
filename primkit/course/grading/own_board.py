"""Own board: the one behind the scans that a student got, for the hidden tests of the last problem set.

In:  while a submission is graded, the environment variable ``PRIMKIT_TRUTH``: a map that ``primkit teach grade`` has
     made from the student's id and the salt. The kernel, which runs the student's code, gets neither of the two.
Out: a ``World``. Without the variable, that of the demonstration: its scans lie beside the teacher's own notebook.

>>> sorted(shape.kind for shape in personal_truth().shapes)
['circle', 'pentagon', 'rectangle', 'triangle']
"""

from __future__ import annotations

import os

from ...formats import load_world
from ...world import World
from .. import DEMONSTRATION
from ..personal import personal_world

TRUTH_VARIABLE = "PRIMKIT_TRUTH"


def personal_truth() -> World:
    """Return the board that the student's scans show."""
    path = os.environ.get(TRUTH_VARIABLE)
    if path:
        return load_world(path)
    student_id, salt = DEMONSTRATION
    return personal_world(student_id, salt=salt)
