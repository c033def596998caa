"""Driving: the robot on its own, and a world that changes.

``explore`` needs no way-points: the robot keeps a map of what it has seen to be free, and drives to where the next scan
shows most for its time. ``scripted`` and ``wander`` make drives for boards that nobody drove on; ``moving_grid``
follows things that move.

In:  a ``World`` to look at and to drive in, a ``Lidar``.
Out: ``Exploration``: where the robot scanned, what it saw and found, how it drove, and why it stopped.

>>> from primkit.world import random_world
>>> tour = explore(random_world(4, rng=7), rng=0)
>>> [one.kind for one in tour.found], tour.why
(['pentagon', 'rectangle', 'pentagon', 'rectangle'], 'all is seen')
>>> tour.n_scans < 77 / 2  # of the way-points that the paper's robot is put on
True
"""

from .explore import Exploration, explore

__all__ = ["Exploration", "explore"]
