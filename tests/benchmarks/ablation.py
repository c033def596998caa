"""Ablation: what each step from the first edition's reading of the paper to the published experiment changes.

Where the text is silent, the first edition guessed: exact rays; a point at 5 cells lies on a line; cells are read at
their centres; all points of a cluster measure it; a circle takes points within 5 mm; K-Means is the best of ten starts;
width is compared with width; a wrong kind costs its dimensions. Each was put right, one on top of the other.

In:  seeds.
Out: for each step the weighted accuracy, as the mean of the four groups of maps, and in how many of 34 runs a kind
     is wrong.

>>> [step.name for step in STEPS][:2]
['first edition, exact rays', '+ the rendered sensor']

Source: the published code's particulars, see ``paper`` and ``evaluation``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from primkit.arguments import Floats
from primkit.circles import find_circle
from primkit.evaluation import PAPER_TOLERANCE, evaluate
from primkit.formats import published_suite
from primkit.grid import Grid
from primkit.lidar import scan
from primkit.lines import find_lines
from primkit.paper import kind_by_lines, measure_as_published, published_values
from primkit.pipeline import PAPER, find_shapes
from primkit.random_shapes import PENTAGON
from primkit.report import CENTER_WEIGHT, DIMENSION_WEIGHT, PAPER_DIGITS, SHAPE_WEIGHT
from primkit.robot import published_poses, teleport_poses
from primkit.segmentation import kmeans
from primkit.shapes import Circle, Polygon, Shape
from primkit.study.repeat import THEIRS
from primkit.table import Table
from primkit.world import World

FIRST_REACH = 0.005  # m: of lines and circles in the first edition
STRICT = FIRST_REACH - 1e-9  # what lies at 5 cells is out, what is nearer is in

Find = Callable[[Floats, int, np.random.Generator], list[Shape]]
Score = Callable[[Sequence[Shape], World], float | None]  # the weighted accuracy; None for a run that crashed


@dataclass(frozen=True)
class Step:
    """One step: how points are made, how shapes are found in them, and how these are scored."""

    name: str
    rendered: bool
    find: Find
    score: Score


def ablation(seeds: Iterable[int], steps: Sequence[Step] | None = None) -> Table:
    """Return the table of what each step does, over some seeds."""
    rows, numbers = [], [("step", "weighted", "wrong_kinds_of_34")]
    for step in STEPS if steps is None else steps:
        weighted, wrong = np.mean([_of_one_seed(step, seed) for seed in seeds], axis=0).tolist()
        rows.append((step.name, f"{weighted:.3f}", f"{wrong:.1f}"))
        numbers.append((step.name, weighted, wrong))
    title = "What each step does to the weighted accuracy"
    notes = ["weighted: mean of the four groups of maps, one on top of the other.", "Wrong kinds: runs of 34."]
    return Table(("", "weighted", "wrong kinds"), rows, title, notes, numbers=numbers, file="ablation.csv")


def _of_one_seed(step: Step, seed: int) -> tuple[float, int]:
    """Return the mean of the four groups' means over the runs that survive, and how many runs name a kind wrongly."""
    by_count: dict[int, list[float]] = {}
    wrong = 0
    for number, world in enumerate(published_suite().values()):
        n = len(world.shapes)
        found = step.find(_points(world, step.rendered), n, np.random.default_rng([seed, number]))
        wrong += sorted(shape.kind for shape in found) != sorted(shape.kind for shape in world.shapes)
        weighted = step.score(found, world)
        by_count.setdefault(n, []).extend([] if weighted is None else [weighted])
    return float(np.mean([np.mean(group) for group in by_count.values()])), wrong


def _points(world: World, rendered: bool) -> Floats:
    grid = Grid()
    grid.add(scan(world, published_poses(), THEIRS) if rendered else scan(world, teleport_poses(world)))
    return grid.points()


# --- how shapes are found -----------------------------------------------------------------------------------


def _first_found(points: Floats, n: int, rng: np.random.Generator, reach: float = FIRST_REACH) -> list[Shape]:
    """Find shapes as the first edition did."""
    labels = kmeans(points, n, rng=rng)
    shapes = []
    for cluster in (points[labels == label] for label in range(n)):
        n_lines = len(find_lines(cluster, reach, trials=10_000, refit=False, rng=rng))
        shapes.append(_first_measured(cluster, n_lines, rng))
    return [shape for shape in shapes if shape is not None]


def _first_measured(points: Floats, n_lines: int, rng: np.random.Generator) -> Shape | None:
    """Measure all points of a cluster; a pentagon is as wide as they are, a circle takes those within 5 mm."""
    kind = kind_by_lines(n_lines)
    if kind == "circle":
        return find_circle(points, FIRST_REACH, refit=False, rng=rng)
    if kind != "pentagon":
        return measure_as_published(points, n_lines)
    shape = Polygon(PENTAGON * float(np.ptp(points[:, 0]) / np.ptp(PENTAGON[:, 0])))
    return shape.moved(points.mean(axis=0) - shape.centroid)


def _strictly_found(points: Floats, n: int, rng: np.random.Generator) -> list[Shape]:
    return _first_found(points, n, rng, STRICT)


def _exactly_found(points: Floats, n: int, rng: np.random.Generator) -> list[Shape]:
    return [one.shape for one in find_shapes(points, n, settings=PAPER, rng=rng)]


# --- how they are scored ------------------------------------------------------------------------------------


def _first_score(found: Sequence[Shape], world: World) -> float:
    """Score as the first edition did: one-sided and rounded, width against width; a wrong kind costs its dimensions."""
    return _scored(found, world, _first_values)


def _swapped_score(found: Sequence[Shape], world: World) -> float:
    """Compare what the published scoring compares; a wrong kind costs its dimensions."""
    return _scored(found, world, lambda shape, truth: published_values(shape, truth=truth))


def _crashing_score(found: Sequence[Shape], world: World) -> float | None:
    report = evaluate(found, world, protocol="paper")
    return None if report.crashed else report.weighted_accuracy


def _first_values(shape: Shape, truth: bool) -> dict[str, float]:
    """Return what the first edition compared."""
    if isinstance(shape, Polygon) and shape.kind == "rectangle":
        return published_values(shape, truth=True)
    if isinstance(shape, Circle) or shape.kind == "triangle":
        return published_values(shape, truth=truth)
    x, y = shape.centroid.tolist()
    return {"x": x, "y": y, "width": shape.reach if truth else float(np.ptp(shape.vertices[:, 0]))}


def _scored(found: Sequence[Shape], world: World, values: Callable[[Shape, bool], dict[str, float]]) -> float:
    """Return the weighted accuracy of pairs in the order of kind and x; what was not found is wrong."""
    ours = sorted(found, key=lambda shape: (shape.kind, values(shape, False)["x"]))
    theirs = sorted(world.shapes, key=lambda shape: (shape.kind, values(shape, True)["x"]))
    kinds: list[bool] = []
    centers: list[bool] = []
    sizes: list[bool] = []
    for true, mine in zip(theirs, [*ours, *[None] * len(theirs)], strict=False):
        told = {} if mine is None else values(mine, False)
        alike = mine is not None and mine.kind == true.kind
        kinds.append(alike)
        for name, value in values(true, True).items():
            right = name in told and round(told[name], PAPER_DIGITS) - round(value, PAPER_DIGITS) < PAPER_TOLERANCE
            (centers if name in "xy" else sizes).append(right and (alike or name in "xy"))
    return float(SHAPE_WEIGHT * np.mean(kinds) + CENTER_WEIGHT * np.mean(centers) + DIMENSION_WEIGHT * np.mean(sizes))


STEPS = (
    Step("first edition, exact rays", False, _first_found, _first_score),
    Step("+ the rendered sensor", True, _first_found, _first_score),
    Step('+ strictly "< 5 cells"', True, _strictly_found, _first_score),
    Step("+ corner, inliers only, circle, ties, one start", True, _exactly_found, _first_score),
    Step("+ width and height swapped, the pentagon's way", True, _exactly_found, _swapped_score),
    Step("+ wrong kinds crash, not counted", True, _exactly_found, _crashing_score),
)
