"""Driving: the robot on its own, and a world that changes.

``explore`` needs no way-points: the robot keeps a map of what it has seen to be free, and drives to where the next scan
shows most for its time. ``scripted``, ``keyed`` and ``wander`` make drives for boards that nobody drove on;
``moving_grid`` follows things that move.
"""

from .explore import Exploration, explore

__all__ = ["Exploration", "explore"]
