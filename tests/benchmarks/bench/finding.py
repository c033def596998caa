"""Finding: shapes, and single lines and circles, beside the libraries that one would take instead.

In:  an ``Effort`` and a seed.
Out: a ``Result`` each.

All get the same points: the grid's of the suite's 4-shape maps after one round over the way-points, and for lines and
circles those of one shape of such a map. Scores are ``evaluate``'s, fair: within 5 mm, too large or too small.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from primkit.circles import find_circle, fit_circle
from primkit.evaluation import evaluate
from primkit.grid import Grid
from primkit.lidar import scan
from primkit.lines import find_lines
from primkit.measure import Detection
from primkit.pipeline import PAPER, find_shapes
from primkit.robot import teleport_poses
from primkit.shapes import Circle, Shape
from primkit.world import World

from .clock import Spread, in_turns
from .effort import Effort
from .machine import version_of
from .others import (
    THRESHOLD,
    Counting,
    chain,
    fit_least_squares,
    fit_marquardt,
    fit_skimage,
    fit_taubin,
    ransac_circle_pyransac,
    ransac_circle_skimage,
    ransac_line_skimage,
)
from .results import Fact, Result, Row
from .scanning import four_shape_maps

Floats = NDArray[np.float64]
Found = Sequence[Detection | Shape]
T = TypeVar("T")

OURS = "primkit"
CHAIN = "scikit-learn, scikit-image, pyransac3d"
SKIMAGE = "scikit-image"
SAME_METHOD = "primkit, the paper's method"
MILLI, MICRO = 1e3, 1e6
TIGHT = 0.001  # m: beside the usual 5 mm


def points_of(world: World) -> Floats:
    """Return the grid's points after one round over the way-points, shape (N, 2)."""
    grid = Grid()
    grid.add(scan(world, teleport_poses(world)))
    return grid.points()


# The same fit by others; scikit-image's circle is Kasa's in all but name.
FITS: dict[str, dict[str, Callable[[Floats], Circle | None]]] = {
    "Kasa": {OURS: partial(fit_circle, method="kasa"), SKIMAGE: fit_skimage},
    "Taubin": {OURS: partial(fit_circle, method="taubin"), "circle-fit": fit_taubin},
    "geometric": {OURS: fit_circle, "circle-fit: lm": fit_marquardt, "circle-fit: standardLSQ": fit_least_squares},
}

# --- all shapes of a map ------------------------------------------------------------------------------------


def bench_shapes(effort: Effort, seed: int) -> Result:
    """Time finding all shapes beside the paper's chain of libraries, and score both."""
    paper = replace(PAPER, line_trials=effort.trials, circle_trials=effort.trials)
    taken: list[dict[str, Floats]] = []
    scores: list[dict[str, tuple[float, ...]]] = []
    counts = []
    for world in four_shape_maps(effort.maps).values():
        points, n = points_of(world), len(world.shapes)
        tools: dict[str, Callable[[], Found]] = {
            OURS: partial(find_shapes, points, rng=seed),
            SAME_METHOD: partial(find_shapes, points, n, settings=paper, rng=seed),
        }
        if version_of(SKIMAGE) and version_of("pyransac3d"):
            tools[CHAIN] = partial(chain, points, n, effort.trials, seed)
        scores.append({tool: _scores(find(), world) for tool, find in tools.items()})
        taken.append(in_turns(tools, effort.rounds))
        counts.append(len(points))
    case = f"{len(taken)} maps, {min(counts):,} to {max(counts):,} points"
    names = ("right within 5 mm", "within 1 mm", "kinds right")
    rows = []
    for tool in (OURS, SAME_METHOD, CHAIN):
        if tool not in taken[0]:
            rows.append(Row(case, tool))
            continue
        cost = Spread.of([MILLI * np.median(on[tool]) for on in taken])
        ratio = Spread.of([np.median(on[tool] / on[OURS]) for on in taken])
        means = (f"{value:.3f}" for value in np.mean([on[tool] for on in scores], axis=0))
        facts = dict(zip(names, means, strict=True))
        rows.append(Row(case, tool, cost, None if tool == OURS else ratio, facts=facts))
    return Result(
        "shapes",
        "Finding all shapes of a map with 4, from the same points",
        "ms per map",
        "times primkit's",
        tuple(rows),
        (
            f"Medians over the maps, with the least and the greatest map; {effort.rounds} rounds in turns on each. "
            f"{effort.trials:,} samples for each line and circle of the paper's method. One thread.",
            "primkit finds the number of shapes; the two others are told. scikit-image stops when a better line is all "
            "but impossible; primkit, the paper's method, draws all samples. Scores are means over the maps of the "
            "weighted accuracy, and of the shape accuracy.",
        ),
    )


def _scores(found: Found, world: World) -> tuple[float, ...]:
    """Return the weighted accuracy within 5 mm and within 1 mm, and the share of right kinds."""
    usual = evaluate(found, world)
    return usual.weighted_accuracy, evaluate(found, world, TIGHT).weighted_accuracy, usual.shape_accuracy


# --- one line, one circle -----------------------------------------------------------------------------------


def bench_kernels(effort: Effort, seed: int) -> Result:
    """Time one line and one circle beside scikit-image, pyransac3d and circle-fit."""
    polygons, circles = clusters()
    polygons, circles = polygons[: effort.clusters], circles[: effort.clusters]
    rows = _line_rows([points for _, points in polygons], effort, seed)
    rows += _ransac_circle_rows(circles, effort, seed)
    sets = [points for _, points in circles]
    for way, fits in FITS.items():
        facts = _radius_facts(fits, circles)
        rows += _kernel_rows(f"circle through all points, {way}", fits, sets, effort.rounds, facts)
    sizes = [len(points) for _, points in (*polygons, *circles)]
    return Result(
        "kernels",
        f"One line, one circle: {len(polygons)} polygons, {len(circles)} circles, {min(sizes)} to {max(sizes)} points",
        "us per fit",
        "times primkit's",
        tuple(rows),
        (
            f"Medians over the clusters, with the least and the greatest; {effort.rounds} rounds in turns on each. "
            "All but pyransac3d fit the best line or circle once more to its inliers.",
            '"inliers": points within 5 mm of the line, mean. "radius off": mean of the radius\' absolute error. '
            '"samples": median of how many were drawn; scikit-image stops when a better one is all but impossible, and '
            "at once where all points agree. circle-fit's lm takes no step from Taubin's circle: the first is below "
            "its least.",
        ),
    )


def clusters() -> tuple[list[tuple[Shape, Floats]], list[tuple[Circle, Floats]]]:
    """Return the polygons and the circles of the suite's 4-shape maps, each with the points that are nearest to it."""
    polygons: list[tuple[Shape, Floats]] = []
    circles: list[tuple[Circle, Floats]] = []
    for world in four_shape_maps().values():
        points = points_of(world)
        nearest = np.abs([shape.signed_distance(points) for shape in world.shapes]).argmin(axis=0)
        for index, shape in enumerate(world.shapes):
            own = points[nearest == index]
            if isinstance(shape, Circle):
                circles.append((shape, own))
            else:
                polygons.append((shape, own))
    return polygons, circles


def _line_rows(sets: Sequence[Floats], effort: Effort, seed: int) -> list[Row]:
    """Return the rows of one line by RANSAC."""

    def ours(points: Floats) -> NDArray[np.bool_]:
        return find_lines(points, THRESHOLD, most=1, trials=effort.trials, rng=seed)[0].inliers

    def theirs(points: Floats) -> NDArray[np.bool_]:
        return ransac_line_skimage(points, effort.trials, seed)

    tools = {OURS: ours, SKIMAGE: theirs}
    facts: dict[str, dict[str, Fact]] = {
        tool: {"inliers": f"{np.mean([np.sum(find(points)) for points in sets]):.0f}"}
        for tool, find in _present(tools).items()
    }
    samples = _samples(tools, sets, effort.trials, partial(ransac_line_skimage, trials=effort.trials), seed)
    return _kernel_rows(f"one line by RANSAC, {effort.trials:,} samples", tools, sets, effort.rounds, facts, samples)


def _ransac_circle_rows(circles: Sequence[tuple[Circle, Floats]], effort: Effort, seed: int) -> list[Row]:
    """Return the rows of one circle by RANSAC."""
    tools: dict[str, Callable[[Floats], Circle | None]] = {
        OURS: lambda points: find_circle(points, THRESHOLD, trials=effort.trials, rng=seed),
        SKIMAGE: lambda points: ransac_circle_skimage(points, effort.trials, seed),
        "pyransac3d": lambda points: ransac_circle_pyransac(points, effort.trials, seed),
    }
    sets = [points for _, points in circles]
    samples = _samples(tools, sets, effort.trials, partial(ransac_circle_skimage, trials=effort.trials), seed)
    case = f"one circle by RANSAC, {effort.trials:,} samples"
    return _kernel_rows(case, tools, sets, effort.rounds, _radius_facts(tools, circles), samples)


def _samples(
    tools: Iterable[str], sets: Sequence[Floats], trials: int, skimage: Callable[..., object], seed: int
) -> dict[str, Floats]:
    """Return how many samples each tool draws for each set of points: all, but scikit-image stops when it is sure."""
    drawn = {tool: np.full(len(sets), float(trials)) for tool in tools}
    if version_of(SKIMAGE):
        generators = [Counting.seeded(seed) for _ in sets]
        for points, generator in zip(sets, generators, strict=True):
            skimage(points, rng=generator)
        drawn[SKIMAGE] = np.array([generator.n_calls - 1.0 for generator in generators])  # it draws one ahead
    return drawn


def _radius_facts(
    tools: Mapping[str, Callable[[Floats], Circle | None]], circles: Sequence[tuple[Circle, Floats]]
) -> dict[str, dict[str, Fact]]:
    """Return how far off each tool's radii are."""
    facts: dict[str, dict[str, Fact]] = {}
    for tool, fit in _present(tools).items():
        found = [(fit(points), truth.radius) for truth, points in circles]
        off = [np.inf if circle is None else abs(circle.radius - radius) for circle, radius in found]
        facts[tool] = {"radius off [mm]": float(MILLI * np.mean(off))}
    return facts


def _present(tools: Mapping[str, Callable[[Floats], T]]) -> dict[str, Callable[[Floats], T]]:
    """Return the tools that are installed: each is called by its package, and perhaps by what of it is used."""
    return {tool: call for tool, call in tools.items() if tool == OURS or version_of(tool.split(":")[0])}


def _kernel_rows(
    case: str,
    tools: Mapping[str, Callable[[Floats], object]],
    sets: Sequence[Floats],
    rounds: int,
    facts: Mapping[str, Mapping[str, Fact]],
    samples: Mapping[str, Floats] | None = None,
) -> list[Row]:
    """Return a row for each tool: medians over the sets of points; with samples, how many, and what one costs."""
    there = _present(tools)
    taken = [in_turns({tool: partial(call, points) for tool, call in there.items()}, rounds) for points in sets]
    rows = []
    for tool in tools:
        if tool not in there:
            rows.append(Row(case, tool))
            continue
        costs = MICRO * np.array([np.median(on[tool]) for on in taken])
        ratio = Spread.of([np.median(on[tool] / on[OURS]) for on in taken])
        more: dict[str, Fact] = {}
        if samples is not None:
            each = float(np.median(costs / samples[tool]))
            more = {"samples": float(np.median(samples[tool])), "us per sample": each}
        rows.append(Row(case, tool, Spread.of(costs), None if tool == OURS else ratio, facts={**facts[tool], **more}))
    return rows
