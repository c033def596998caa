"""Runs: the same board by hand, from the way-points, and explored: scans, time, and how right.

In:  a ``World`` and a ``Lidar``.
Out: ``Run``, one for each way to move; together a ``Table``.

>>> from primkit.shapes import Circle
>>> compare_runs(automatic_runs(World([Circle((0.2, 0.1), 0.06)]), Lidar(), rng=0))
            scans  robot time  found  score
----------  -----  ----------  -----  -----  ---------------------------------------------------------------
way-points  76     7.7 s       1      1.00   the robot is set down at each; the ways between are not counted
explore     15     59.0 s      1      1.00   it drives, stands still, and scans
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ..arguments import Floats
from ..driving import explore
from ..driving.mapper import Mapper, unmended
from ..evaluation import evaluate
from ..lidar import Lidar, scan
from ..robot import teleport_poses, waypoints
from ..steps import Steps
from ..table import Table
from ..world import World


@dataclass(frozen=True, eq=False)
class Run:
    """What came of one way to move: ``"by hand"``, ``"way-points"`` or ``"explore"``.

    Scans, seconds that the robot took (``note`` says what for), shapes found and their weighted accuracy, and the
    ``way``, shape (N, 2): where it scanned, metres.
    """

    name: str
    n_scans: int
    robot_time: float
    n_found: int
    score: float
    note: str
    way: Floats

    def cells(self) -> tuple[str, ...]:
        """Return the run as texts, one for each column of the table."""
        time, score = f"{self.robot_time:.1f} s", f"{self.score:.2f}"
        return self.name, f"{self.n_scans:,}", time, str(self.n_found), score, self.note


def compare_runs(runs: Sequence[Run]) -> Table:
    """Return runs on the same board as a table, one below the other."""
    return Table(("", "scans", "robot time", "found", "score", ""), [run.cells() for run in runs], lines=tuple(runs))


def automatic_runs(world: World, lidar: Lidar, rng: int, steps: Steps | None = None) -> tuple[Run, Run]:
    """Return what the two automatic movements find on a board."""
    return _scan_from_waypoints(world, lidar, rng, steps), _explore(world, lidar, rng, steps)


def _scan_from_waypoints(world: World, lidar: Lidar, rng: int, steps: Steps | None) -> Run:
    """Scan from the paper's way-points, all of whose periods count, and find what is there."""
    poses = teleport_poses(world)
    mapper = Mapper(world.cell, settings=unmended(steps), steps=steps, rng=rng)
    mapper.add(scan(world, poses, lidar, rng=rng))
    found = mapper.found
    note = "the robot is set down at each; the ways between are not counted"
    time, score = len(waypoints(world.size)) * lidar.period, evaluate(found, world).weighted_accuracy
    return Run("way-points", len(poses), time, len(found), score, note, poses[:, :2])


def _explore(world: World, lidar: Lidar, rng: int, steps: Steps | None) -> Run:
    """Let the robot find its own way, and find what is there."""
    tour = explore(world, lidar, steps=steps, rng=rng)
    score, places = evaluate(tour.found, world).weighted_accuracy, tour.poses[:, :2]
    note = "it drives, stands still, and scans"
    return Run("explore", tour.n_scans, tour.robot_time, len(tour.found), score, note, places)
