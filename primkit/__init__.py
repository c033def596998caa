"""primkit: a teaching kit for mobile-robot perception.

A robot with a LiDAR stands among circles, rectangles, triangles and pentagons; primkit simulates what it sees,
and finds, names and measures the shapes. The public names, in the order of the story:

>>> import primkit as pk
>>> world = pk.random_world(4, rng=7)              # a board with shapes: the truth
>>> lidar = pk.Lidar()                             # the sensor
>>> poses = pk.teleport_poses(world)               # where the robot stands
>>> scans = pk.scan(world, poses, lidar, rng=0)    # what it sees
>>> grid = pk.Grid(resolution=0.001)
>>> grid.add(scans)                                # all hits, on cells of 1 mm
>>> found = pk.find_shapes(grid.points(), rng=0)   # the shapes
>>> pk.evaluate(found, world).weighted_accuracy    # how right they are
1.0

Each name is loaded from its module on first use, so that ``import primkit`` is quick; ``__init__.pyi`` lists them all.
"""

import sys

import lazy_loader

__version__ = "0.1.0"

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

if "IPython" in sys.modules and (shell := sys.modules["IPython"].get_ipython()) is not None:
    from .notebook import show_figures_with_words

    show_figures_with_words(shell)
