"""Explore: scan, choose the next view, drive there, until there is nothing left to see.

In:  a ``World`` to look at and to drive in, a ``Lidar``.
Out: ``Exploration``.

>>> from primkit.world import random_world
>>> tour = explore(random_world(4, rng=7), rng=0)
>>> [one.kind for one in tour.found], tour.why
(['pentagon', 'rectangle', 'pentagon', 'rectangle'], 'all is seen')
>>> tour.n_scans < 77 / 2  # of the way-points that the paper's robot is put on
True

Not here: what is free (``seen_map``), the shortest ways (``ways``), what a scan would show (``next_views``).

Source: Yamauchi (1997), "A frontier-based approach for autonomous exploration".
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from ..arguments import Bools, Floats, as_count, as_rng, check_type
from ..found import Found
from ..lidar import Lidar, Scans, as_lidar, scan
from ..robot import BODY, PERIOD, advance, start_pose
from ..show import thumbnail
from ..steps import Steps
from ..table import count
from ..world import World
from .mapper import Mapper, unmended
from .next_views import View, next_view, shown_from
from .seen_map import EXPLAINED, SQUARE, SeenMap, open_outlines, outlines_in
from .ways import Ways, forward, ways_from, wheels_along

Why = Literal["all is seen", "the rest cannot be seen", "out of scans"]

MOST_SCANS = 60
LITTLE_GAIN = 40.0  # squares: where the best view shows less, it is time to ask what the points so far are
OUTLINE_WORTH = 10.0  # squares of unseen board that a square of open outline is worth: it is little, and decides much
MOST_LOOKS = 2  # in vain at a square; then it is given up
BACK_OFF = 0.02  # m: from what the robot touched


@dataclass(frozen=True, eq=False)
class Exploration:
    """What became of an exploration.

    Parameters
    ----------
    poses : array, shape (P, 3)
        Where it scanned: x [m], y [m], heading [rad], world frame.
    scans : Scans, what it saw from there
    found : Found, the shapes from left to right, and what else the points are
    wheels : array, shape (T, 2)
        How it drove: speeds of the left and the right wheel, rad/s, each pair held for a period of 0.1 s.
    path : array, shape (T + 1, 3)
        Where that led: the start, and the pose after each period.
    robot_time : float
        Seconds: all driving, and the time that the scans took, for which it stands still.
    why : str
        Why it stopped. ``"all is seen"``: every outline is closed, and no unseen place is left in which a shape
        could hide. ``"the rest cannot be seen"``: some are left, but not from where the robot can get to.
        ``"out of scans"``: as many were taken as were allowed.
    """

    poses: Floats
    scans: Scans
    found: Found
    wheels: Floats
    path: Floats
    robot_time: float
    why: Why

    @property
    def n_scans(self) -> int:
        """How many scans were taken."""
        return len(self.poses)

    def __repr__(self) -> str:
        seen = f"{count(len(self.found), 'shape')} from {count(self.n_scans, 'scan')}"
        return f"Exploration: {seen} in {self.robot_time:.1f} s; {self.why}"

    def _repr_html_(self) -> str:
        return thumbnail(repr(self), dots=self.scans.points(), way=self.path[:, :2])


def explore(
    world: World,
    lidar: Lidar | None = None,
    *,
    start: ArrayLike | None = None,
    steps: Steps | None = None,
    rng: int | np.random.Generator | None = None,
    most_scans: int = MOST_SCANS,
) -> Exploration:
    """Let the robot find its own way over the board until it has seen all of it.

    It stands still to scan and drives without scanning, on ways through what it has seen to be free. The world is used
    for what the sensor measures and for what the body touches, for nothing else. Raises ValueError if an argument is
    out of its range, or the body is not clear at the start.

    Parameters
    ----------
    world : World
    lidar : Lidar, optional
        As for ``scan``.
    start : array_like, shape (3,), optional
        As for ``drive``.
    steps : Steps, optional
        Functions of your own: what they find, the robot goes to look at. A segmentation of your own is not mended.
    rng : seed or numpy.random.Generator, optional
        The same seed gives the same exploration, to the last bit.
    most_scans : int, after which it stops

    Examples
    --------
    >>> explore(World(), rng=0, most_scans=3)
    Exploration: no shapes from 3 scans in 4.2 s; out of scans
    """
    check_type(world, World, "world must be a World, as in explore(world)")
    lidar = as_lidar(lidar, world.scale, around=True)
    most_scans = as_count(most_scans, "most_scans")
    pose = advance(world, start_pose(world) if start is None else start, (0, 0), 0)[0]  # refused unless it is clear
    tour = _Tour(world, lidar, pose, steps, as_rng(rng))
    why: Why | None = None
    while why is None:
        tour.look()
        why = "out of scans" if len(tour.scans) == most_scans else tour.move_on()
    return tour.result(why)


class _Tour:
    """A robot on its way: what it knows, and what it did so far."""

    def __init__(self, world: World, lidar: Lidar, pose: Floats, steps: Steps | None, rng: np.random.Generator) -> None:
        self.world, self.lidar = world, lidar
        self.path: list[Floats] = [pose]
        self.wheels: list[Floats] = []
        self.scans: list[Scans] = []
        self.scan_rng, find_rng = rng.spawn(2)
        self.board = SeenMap(world.size)
        self.eye = lidar.scaled(1 / world.scale)  # the sensor on the map
        self.mapper = Mapper(world.cell, settings=unmended(steps), steps=steps, rng=find_rng)
        self.vain = np.zeros(self.board.free.shape, dtype=np.int64)  # how often each square was looked at in vain
        self.been = np.zeros(self.vain.shape, dtype=bool)  # squares that were scanned from
        self.found, self.outlines = Found(), outlines_in(Found())
        self.found_from = 0  # points that this was made of
        self.inside = self.explained = np.zeros(self.vain.shape, dtype=bool)

    @property
    def here(self) -> Floats:
        """Where the robot is on the map, shape (3,)."""
        here: Floats = self.path[-1] / (self.world.scale, self.world.scale, 1.0)
        return here

    def look(self) -> None:
        """Scan, and learn from it."""
        seen = scan(self.world, self.path[-1], self.lidar, rng=self.scan_rng)
        self.scans.append(seen)
        self.mapper.add(seen)
        self.board.add(seen, self.lidar.range_min, self.lidar.range_max)
        i, j = self.board.index(self.here[:2])
        self.been[i, j] = True
        if len(self.scans) > 1:  # what a beam should have shown, and did not
            self.vain += shown_from((int(i), int(j)), self.worth(), self.opaque(), self.eye)

    def move_on(self) -> Why | None:
        """Drive to the next view, or as far as something stops the robot; without a view, say why there is none."""
        ways = ways_from(self.board, self.here[:2])
        view = self.view(ways)
        if view is not None:
            self.drive(ways.to(view.square))
            return None
        return "the rest cannot be seen" if self.worth(give_up=False).any() else "all is seen"

    def view(self, ways: Ways) -> View | None:
        """Return the best next view; when the map alone has little to offer, in the light of what was found."""
        view = next_view(self.worth(), self.opaque(), ways, self.eye, self.been)
        if (view is None or view.gain < LITTLE_GAIN) and self.find():
            view = next_view(self.worth(), self.opaque(), ways, self.eye, self.been)
        return view

    def find(self) -> bool:
        """Ask what the points so far are; False when there are no new ones."""
        if len(self.mapper.grid) == self.found_from:
            return False
        self.found, self.found_from = self.mapper.found, len(self.mapper.grid)
        self.outlines = outlines_in(self.found, self.world.scale)
        self.inside = self.board.covered(self.outlines, 0.0)
        self.explained = self.board.covered(self.outlines, EXPLAINED)
        return True

    def worth(self, *, give_up: bool = True) -> Floats:
        """Return what each square is worth to be seen, shape (N, N)."""
        open_ = np.zeros(self.vain.shape, dtype=bool)
        open_[self.board.index(open_outlines(self.outlines))] = True
        worth = 1.0 * self.board.hiding_places(self.explained) + OUTLINE_WORTH * open_
        return worth * (self.vain < MOST_LOOKS) if give_up else worth

    def opaque(self) -> Bools:
        """Tell at which squares a beam ends, shape (N, N)."""
        return self.board.wall | self.inside

    def drive(self, way: Floats) -> None:
        """Drive along a way; on contact, remember where, and back off."""
        for speeds in wheels_along(self.here, way):
            if self.turn_wheels(speeds):
                x, y, heading = self.here
                ahead = BODY + SQUARE / 2
                self.board.bump(np.array([x + ahead * np.cos(heading), y + ahead * np.sin(heading)]))
                for back in -forward(BACK_OFF):
                    self.turn_wheels(back)
                break

    def turn_wheels(self, speeds: Floats) -> bool:
        """Hold wheel speeds for a period; tell whether something stopped the robot."""
        pose, stopped = advance(self.world, self.path[-1], speeds)
        self.path.append(pose)
        self.wheels.append(speeds)
        return stopped

    def result(self, why: Why) -> Exploration:
        """Return the exploration, with the shapes in all that was seen."""
        self.find()
        poses = np.vstack([one.poses for one in self.scans])
        ranges = np.vstack([one.ranges for one in self.scans])
        scans = Scans(poses, self.lidar.angles, ranges, np.zeros(len(poses), dtype=bool))
        wheels = np.array(self.wheels).reshape(-1, 2)
        time = PERIOD * len(wheels) + self.lidar.period * len(scans)
        return Exploration(poses, scans, self.found, wheels, np.array(self.path), time, why)
