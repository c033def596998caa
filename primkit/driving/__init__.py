"""Explorer: the robot finds its own way, to see all of the board with few scans.

Beside the story: automatic movement without way-points. The robot keeps a map of its own, of what it has seen to be
free, and asks it where the next scan would show most for the time that it takes to get there.

In:  a ``World`` to look at and to drive in, a ``Lidar``.
Out: ``Exploration``: where the robot scanned, what it saw and found, how it drove, and why it stopped.

>>> from primkit.world import random_world
>>> tour = explore(random_world(4, rng=7), rng=0)
>>> [one.kind for one in tour.found], tour.why
(['pentagon', 'rectangle', 'pentagon', 'rectangle'], 'all is seen')
>>> tour.n_scans < 77 / 2
True

The rooms, each of which imports only those before it:

=============  ==========================================================
``seen.py``    the robot's own map: free, wall, unseen
``ways.py``    the shortest way through what is free, and the wheels for it
``views.py``   what a scan from each place would show
``search.py``  look, think, drive, until nothing is left to see
=============  ==========================================================

Sources: Yamauchi (1997), "A frontier-based approach for autonomous exploration"; Connolly (1985), "The determination of
next best views".
"""

from .explore import Exploration, explore

__all__ = ["Exploration", "explore"]
