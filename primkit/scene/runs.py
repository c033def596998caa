"""Runs: the same board by hand, from the way-points, and explored: scans, time, and how right.

In:  a ``World`` and a ``Lidar``.
Out: ``Run``, one for each way to move; together a ``Comparison``, which prints as a table.

>>> from primkit.shapes import Circle
>>> world = World([Circle((0.2, 0.1), 0.06)])
>>> Comparison((from_waypoints(world, Lidar(), 0), by_exploring(world, Lidar(), 0)))
             scans  robot time  found  score
way-points      76       7.7 s      1   1.00 (the robot is set down at each; the ways between are not counted)
explore         15      59.0 s      1   1.00 (it drives, stands still, and scans)
"""

from __future__ import annotations

from dataclasses import dataclass
from html import escape

from ..arguments import Floats
from ..driving import explore
from ..evaluation import evaluate
from ..grid import Grid
from ..lidar import Lidar, scan
from ..pipeline import find_shapes
from ..robot import teleport_poses, waypoints
from ..world import World

HEADER = ("", "scans", "robot time", "found", "score")


@dataclass(frozen=True, eq=False)
class Run:
    """What came of one way to move.

    Parameters
    ----------
    name : str
        ``"by hand"``, ``"way-points"`` or ``"explore"``.
    n_scans : int
        How many scans were taken.
    robot_time : float
        Seconds that the robot took, computing left out.
    n_found : int
        How many shapes were found.
    score : float
        Their weighted accuracy, 0 to 1.
    note : str
        What the time is made of.
    way : array, shape (N, 2)
        Where it scanned, metres.
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
        return (self.name, f"{self.n_scans:,}", f"{self.robot_time:.1f} s", f"{self.n_found}", f"{self.score:.2f}")


@dataclass(frozen=True, eq=False)
class Comparison:
    """Runs on the same board, one below the other; prints as text, shows as HTML in a notebook."""

    runs: tuple[Run, ...]

    def texts(self) -> list[tuple[str, ...]]:
        """Return the table as texts: the names of the columns, then a line for each run, what its time is the last."""
        return [(*HEADER, ""), *((*run.cells(), run.note) for run in self.runs)]

    def __repr__(self) -> str:
        rows = [(*run.cells(), f"({run.note})") for run in self.runs]
        return "\n".join(
            f"{name:10}  {scans:>6}  {time:>10}  {found:>5}  {score:>5} {note}".rstrip()
            for name, scans, time, found, score, note in [(*HEADER, ""), *rows]
        )

    def _repr_html_(self) -> str:
        head = "".join(f"<th>{escape(word)}</th>" for word in HEADER)
        rows = ("".join(f"<td>{escape(text)}</td>" for text in (*run.cells(), run.note)) for run in self.runs)
        return f"<table><tr>{head}<th></th></tr>{''.join(f'<tr>{row}</tr>' for row in rows)}</table>"


def from_waypoints(world: World, lidar: Lidar, rng: int) -> Run:
    """Scan from the paper's way-points, all of whose periods count, and find what is there."""
    poses = teleport_poses(world)
    grid = Grid()
    grid.add(scan(world, poses, lidar, rng=rng))
    found = find_shapes(grid.points(), rng=rng)
    note = "the robot is set down at each; the ways between are not counted"
    time, score = len(waypoints(world.size)) * lidar.period, evaluate(found, world).weighted_accuracy
    return Run("way-points", len(poses), time, len(found), score, note, poses[:, :2])


def by_exploring(world: World, lidar: Lidar, rng: int) -> Run:
    """Let the robot find its own way, and find what is there."""
    tour = explore(world, lidar, rng=rng)
    score, places = evaluate(list(tour.found), world).weighted_accuracy, tour.poses[:, :2]
    note = "it drives, stands still, and scans"
    return Run("explore", tour.n_scans, tour.robot_time, len(tour.found), score, note, places)
