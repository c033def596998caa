"""Wander: random drives among the shapes, for boards without way-points.

In:  a ``World``, a number of scans, a seed.
Out: poses, shape (P, 3): x [m], y [m], heading [rad], world frame; from each to the next a period of the LiDAR passes.

>>> from primkit.shapes import Circle
>>> path = wander(World([Circle((0.1, 0.0), 0.06)]), 60, rng=0)
>>> path.shape, bool(Circle((0.1, 0.0), 0.06).signed_distance(path[:, :2]).min() >= CLEARANCE)
((60, 3), True)

The robot drives at full speed and turns as it likes, a little more or less from scan to scan; where that would bring it
too near to an outline or to the board's edge, it takes the turn nearest to its wish that leads clear.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..arguments import Floats, as_count, as_positive
from ..world import World

CLEARANCE = 0.04  # m: a little more than the robot's radius
WAY_MARGIN = 0.10  # m from the way to the board's edge: shapes are in the middle
PERIOD_WAY = 0.0128  # m: the e-puck's way in one period at full speed, 6.28 rad/s x 0.0205 m x 0.1 s
TURN_CHOICES = np.radians(np.arange(-24, 25, 3))  # from scan to scan; the e-puck can turn much more
TURN_MEMORY, TURN_STD = 0.8, np.radians(6)  # share of a turn that is kept in the next; deviation of what is added
CLEAR_STEPS = 12  # ahead
START_SPOTS = 1000  # tried


def wander(
    world: World, n_poses: int = 60, *, clearance: float | None = None, rng: int | np.random.Generator | None = None
) -> Floats:
    """Return the poses of a smooth random drive, ``clearance`` metres from all outlines or more, shape (n_poses, 3).

    Without a clearance it is 4 cm, times the board's scale. Raises ValueError if the number or the clearance is out of
    its range, or no spot on the board is that clear.

    >>> from primkit.shapes import Circle
    >>> wander(World([Circle((0, 0), 0.4)]), clearance=0.4, rng=0)
    Traceback (most recent call last):
        ...
    ValueError: clearance must leave room for a drive, got 0.4 m on a board of 1 m
    """
    rng = np.random.default_rng(rng)
    n_poses, scale = as_count(n_poses, "n_poses"), world.scale
    clearance = CLEARANCE if clearance is None else as_positive(clearance, "clearance", zero=True) / scale
    world = world.scaled(1 / scale)
    place, turn = _start(world, clearance, rng), 0.0
    if place is None:
        at = f"{scale * clearance:g} m on a board of {scale * world.size:g} m"
        raise ValueError(f"clearance must leave room for a drive, got {at}")
    heading = rng.uniform(0, 2 * np.pi)
    poses = [(*place, heading)]
    while len(poses) < n_poses:
        wish = TURN_MEMORY * turn + rng.normal(0, TURN_STD)
        turn, goes = _turn(world, place, heading, wish, clearance)
        heading += turn
        place = place + goes * PERIOD_WAY * np.array([np.cos(heading), np.sin(heading)])
        poses.append((*place, heading))
    return np.array(poses) * (scale, scale, 1.0)


def _start(world: World, clearance: float, rng: np.random.Generator) -> Floats | None:
    spots = rng.uniform(-0.5, 0.5, (START_SPOTS, 2)) * (world.size - 2 * WAY_MARGIN)
    free = np.flatnonzero(_clear(world, spots, clearance))
    return spots[free[0]] if len(free) else None


def _turn(world: World, place: Floats, heading: float, wish: float, clearance: float) -> tuple[float, bool]:
    """Return the turn nearest to the wish that leads clear, and whether the robot goes on; else it turns on the spot.

    A way is looked at as if the turn were kept up; where none is clear to its end, the longest clear one is taken.
    """
    bearings = heading + TURN_CHOICES[:, None] * np.arange(1, CLEAR_STEPS + 1)
    directions = np.stack([np.cos(bearings), np.sin(bearings)], axis=-1)  # (T, CLEAR_STEPS, 2)
    ways = place + PERIOD_WAY * np.cumsum(directions, axis=1)
    clear = _clear(world, ways.reshape(-1, 2), clearance).reshape(bearings.shape)
    length = np.where(clear.all(axis=1), CLEAR_STEPS, clear.argmin(axis=1))
    best = np.flatnonzero(length == length.max())
    chosen = best[np.abs(TURN_CHOICES[best] - wish).argmin()]
    return float(TURN_CHOICES[chosen]), bool(length[chosen] > 0)


def _clear(world: World, spots: Floats, clearance: float) -> NDArray[np.bool_]:
    """Tell which spots are well on the board and that far from every outline, shape (N,)."""
    clear: NDArray[np.bool_] = np.all(np.abs(spots) <= world.size / 2 - WAY_MARGIN, axis=1)
    for shape in world.shapes:
        clear &= shape.signed_distance(spots) >= clearance
    return clear
