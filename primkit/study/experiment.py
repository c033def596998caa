"""Experiment: one map, one method, one row of a study, with everything that the row depends on in one place.

In:  an ``Experiment``: the map, the settings, the sensor, the seed.
Out: a ``Row``: the scores under both protocols, the errors in metres, the times in seconds.

>>> from primkit.pipeline import ROBUST
>>> from primkit.world import random_world
>>> row = perform(Experiment("mine", random_world(2, rng=0), "ROBUST", ROBUST))
>>> row.map, row.n_found, row.fair.weighted, row.robot_time
('mine', 2, 1.0, 7.7)

What counts as time. Computing time is filling the grid and finding the shapes; simulating the scans stands for the
robot, and scoring is no part of mapping. Robot time is the number of scans times the LiDAR's period. It is stated
apart and counts all 77 way-points, those inside a shape too, because the paper's robot scans at all of them but the
first; on its own sensor, the rendered one, it is put where that robot was, ``robot.published_poses``, 76 times.

Source: the paper's section 3.3, "Results".
"""

from __future__ import annotations

import hashlib
import json
import sys
from dataclasses import asdict, dataclass
from functools import cache
from importlib.metadata import version
from pathlib import Path
from time import perf_counter
from typing import Literal

import numpy as np

from ..arguments import Floats
from ..evaluation import evaluate
from ..found import Found
from ..grid import Grid
from ..lidar import Lidar, Scans, scan
from ..measure import detection
from ..pipeline import Settings, find_shapes
from ..report import Report
from ..robot import published_poses, teleport_poses, waypoints
from ..shapes import Circle, Kind
from ..world import World
from .oracle import Oracle, oracle_fit, shares_seen, told_points
from .row import Row, Score

# Another version of these may draw or compute other numbers.
NUMERIC_LIBRARIES = ("numpy", "scipy", "scikit-learn", "shapely")


@dataclass(frozen=True, eq=False)
class Experiment:
    """All that one row depends on.

    Parameters
    ----------
    map : str
        The map's name.
    world : World
        The map.
    name : str
        The method's name.
    settings : Settings or Oracle
        The method. The published one is told the number of shapes when it groups by K-Means, the others find
        it; the oracle is told everything.
    lidar : Lidar
        The sensor.
    tolerance : float, optional
        Of the fair protocol, in metres; as ``evaluate`` has it when not given.
    seed : int
        The study's seed.
    drive : array, shape (P, 3), optional
        The poses to scan from; the way-points when not given.
    """

    map: str
    world: World
    name: str
    settings: Settings | Oracle
    lidar: Lidar = Lidar()  # noqa: RUF009 - frozen, so that sharing it is safe
    tolerance: float | None = None
    seed: int = 0
    drive: Floats | None = None

    def key(self) -> str:
        """Return all that the row depends on as JSON, the program included: equal when the row is."""
        known = {
            "program": program(),
            "map": self.map,
            "world": _hash(_as_text(self.world)),
            "drive": None if self.drive is None else _hash(json.dumps(self.drive.tolist())),
            "name": self.name,
            "settings": asdict(self.settings),
            "lidar": asdict(self.lidar),
            "tolerance": self.tolerance,
            "seed": self.seed,
        }
        return json.dumps(known, sort_keys=True)

    def rngs(self) -> list[np.random.Generator]:
        """Return generators for scanning and finding: the same for all methods, others for each map."""
        own = int(_hash(self.map + _as_text(self.world)), 16)
        return np.random.default_rng([self.seed, own]).spawn(2)


@dataclass(frozen=True, eq=False)
class Run:
    """What an experiment saw and found.

    Parameters
    ----------
    scans : Scans
        What the LiDAR saw.
    points : array, shape (N, 2)
        The grid's points, metres.
    told : int or None
        How many shapes the method was told that there are.
    found : Found
        What it found.
    robot_time, computing_time : float
        Seconds; see the module's notes.
    """

    scans: Scans
    points: Floats
    told: int | None
    found: Found
    robot_time: float
    computing_time: float


def perform(experiment: Experiment) -> Row:
    """Scan, find, score: one row.

    Examples
    --------
    >>> from primkit.pipeline import ROBUST
    >>> perform(Experiment("nothing", World(), "ROBUST", ROBUST)).count_right
    True
    """
    try:
        run_ = run(experiment)
    except Exception as error:
        error.add_note(f"on the map {experiment.map!r} with the settings {experiment.name!r}")
        raise
    fair = evaluate(run_.found, experiment.world, experiment.tolerance)
    paper = evaluate(run_.found, experiment.world, protocol="paper")
    return Row(
        map=experiment.map,
        settings=experiment.name,
        kinds=tuple(shape.kind for shape in experiment.world.shapes),
        movement="automatic" if experiment.drive is None else "manual",
        tolerance=fair.tolerance,
        told=run_.told is not None,
        n_found=len(run_.found),
        fair=_score(fair),
        paper=_score(paper),
        center_errors=tuple(e for m in fair.matches for e in m.center_error.tolist()),
        dimension_errors=tuple(
            e for m in fair.matches if m.kind_right for e in m.dimension_error or (np.inf,) * len(m.dimension_right)
        ),
        robot_time=run_.robot_time,
        computing_time=run_.computing_time,
        found_as=_found_as(fair, experiment.world),
        sensor=experiment.lidar.model,
        crashed=paper.crashed,
        seen=() if experiment.drive is None else shares_seen(experiment.world, run_.scans, experiment.lidar),
        dimension_counts=tuple(len(shape.dimensions) for shape in experiment.world.shapes),
    )


def run(experiment: Experiment) -> Run:
    """Scan and find, and measure the time.

    Notes
    -----
    Linear algebra runs on one thread meanwhile. Several would add in another order, and the last bit would depend on
    the number of workers; the tables are small, so that nothing is lost by it.
    """
    from threadpoolctl import threadpool_limits

    world, drive = experiment.world, experiment.drive
    scan_rng, find_rng = experiment.rngs()
    rendered = experiment.lidar.model == "webots"
    if drive is not None:
        poses = drive
    else:
        poses = published_poses(world.size) if rendered else teleport_poses(world)
    scans = scan(world, poses, experiment.lidar, rng=scan_rng)
    with threadpool_limits(1):
        _warm_up(experiment.settings.method)
        begun = perf_counter()
        points, told, found = _find(experiment, scans, find_rng)
        computing_time = perf_counter() - begun
    stops = waypoints(world.size) if drive is None and not rendered else poses
    robot_time = len(stops) * experiment.lidar.period
    return Run(scans, points, told, found, robot_time, computing_time)


def _find(experiment: Experiment, scans: Scans, rng: np.random.Generator) -> tuple[Floats, int | None, Found]:
    """Return the grid's points, the number of shapes that was told, and what the method found."""
    world, settings = experiment.world, experiment.settings
    if isinstance(settings, Oracle):
        points, owners = told_points(world, scans, experiment.lidar, world.cell)
        fits = enumerate(oracle_fit(world, points, owners))
        found = Found(detection(fit, points[owners[:, 0] == i], np.inf) for i, fit in fits if fit is not None)
        return points, len(world.shapes), found
    grid = Grid(world.cell)
    grid.add(scans)
    points = grid.points()
    # More shapes than points cannot be asked for, and a faulty sensor may see nearly nothing.
    is_told = settings.method == "published" and settings.grouping == "kmeans"
    told = min(len(world.shapes), len(points)) if is_told else None
    return points, told, find_shapes(grid, told, settings=settings, rng=rng)


def _found_as(report: Report, world: World) -> tuple[Kind | None, ...]:
    kinds = {id(match.true): match.found.kind for match in report.matches}
    return tuple(kinds.get(id(shape)) for shape in world.shapes)


def _score(report: Report) -> Score:
    return Score(report.weighted_accuracy, report.shape_accuracy, report.center_accuracy, report.dimension_accuracy)


@cache
def _warm_up(method: Literal["joint", "published", "oracle"]) -> None:
    """Find a circle, so that a process's first time is not that of loading the libraries."""
    if method == "oracle":
        return
    quick = Settings(method=method, line_trials=1, circle_trials=1)
    find_shapes(Circle((0, 0), 0.06).outline(60), 1, settings=quick, rng=0)


@cache
def program() -> str:
    """Return what identifies the program: its version, a hash of its text (students change it), its libraries."""
    text = b"".join(path.read_bytes() for path in sorted(Path(__file__).parents[1].rglob("*.py")))
    # The package itself is loaded before any of its modules; importing it from here would turn the story round.
    package = sys.modules[__name__.partition(".")[0]]
    own = f"primkit {package.__version__} {hashlib.sha256(text).hexdigest()[:16]}"
    return ", ".join([own, *(f"{library} {version(library)}" for library in NUMERIC_LIBRARIES)])


def _as_text(world: World) -> str:
    """Return everything that a world is made of, to the last bit."""
    numbers = [[*s.center, s.radius] if isinstance(s, Circle) else s.vertices.ravel() for s in world.shapes]
    shapes = ([s.kind, *map(float, n)] for s, n in zip(world.shapes, numbers, strict=True))
    return json.dumps([world.size, *shapes, *["walls"] * world.walled])


def _hash(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()[:16]
