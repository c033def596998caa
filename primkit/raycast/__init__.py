"""Raycast: the exact distance along each beam to the first outline it meets.

In:  a ``World``, poses, shape (P, 3): x [m], y [m], heading [rad], and the beams' bearings, shape (B,).
Out: distances, shape (P, B), metres; infinity where a beam meets nothing.

>>> import numpy as np
>>> from primkit.shapes import Circle
>>> from primkit.world import World
>>> cast_rays(World([Circle((1, 0), 0.25)], size=3), [(0, 0, 0)], [0.0, np.pi / 2]).tolist()
[[0.75, inf]]

The same twice. ``plain.py`` asks every beam about every side, as one would write it first: slow, easy to trust, and
the oracle of the other. ``fast.py`` turns the question round and asks every side which beams it stops; the work
grows with what is seen (``near.py``, ``fan.py``), and every hit is exact.
"""

from .fast import cast, cast_rays
from .plain import cast_plainly

__all__ = ["cast_rays", "cast_plainly", "cast"]
