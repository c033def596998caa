"""Ordinary: what was right before is right, and certain; and a larger board is the same board.

The boards of ``lost`` are those of ``primkit accuracy`` with the same seed, and so are the shares.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

import primkit as pk
from primkit.found import Found
from primkit.seen import seen_shares
from primkit.shapes import Shape
from primkit.study.accuracy.partial import run_partial
from primkit.study.accuracy.sweeps import Condition, experiments
from primkit.study.experiment import run

from .boards import rng_of, seen_on
from .figures import Figure, mean, number, share, share_of_things
from .judging import FEW, same_name, sure_and_wrong

MM = 0.001
# Weighted accuracy within 5 mm that must not be lost, by the noise in mm: the low end of the interval that there was
# before the estimator knew of an open world (500 maps, seed 0), 0.998 where all was right, and at 10 mm 0.01 less.
BEFORE = {
    "suite": {0: 0.998, 1: 0.998, 2: 0.998, 5: 0.9954, 10: 0.9424 - 0.01},
    "free": {0: 0.998, 1: 0.998, 2: 0.998, 5: 0.9867, 10: 0.9236 - 0.01},
}
CERTAIN = {0: 0.99, 2: 0.98, 5: 0.93}  # share of ordinary shapes, by the noise in mm
CERTAIN_POLYGONS, LARGE = 0.9, 0.08  # share; m from end to end
WHOLE = 0.9  # share of each side that has a point near it, where the whole outline was seen


def lost(n: int, seed: int) -> Iterator[Figure]:
    """Nothing lost: suite and free maps against noise, spurious returns, narrow gaps, partial views."""
    for board, least in BEFORE.items():
        for mm in least:
            yield from weighted(f"{board} maps, {mm} mm", Condition(board, noise_std=mm * MM), n, seed, least[mm])
    yield from weighted("free maps, 2 % spurious", Condition(spurious=0.02), n, seed, BEFORE["free"][0])
    yield from weighted("free maps, gaps of 3 cm", Condition(gap=0.03), n, seed, BEFORE["free"][0])
    for line in run_partial(n, noises=(0.0, 0.002, 0.005), seed=seed, jobs=1, progress=False).lines:
        name = f"partial views, {line.noise_std / MM:g} mm"
        for what, value, k in (
            ("right kind", line.kind, line.n_shapes),
            ("right kind, all sides seen", line.whole, line.n_whole),
            ("measured and right", line.strict, line.n_measured),
        ):
            if value is not None:
                yield Figure(f"{name}: {what}", value, k)
        yield number(f"{name}: hidden, but claimed", line.n_claimed, line.n_hidden, at_most=0)


def weighted(name: str, condition: Condition, n: int, seed: int, least: float | None = None) -> Iterator[Figure]:
    """Yield the mean weighted accuracy, and which kinds were lost if any were."""
    right: dict[str, list[float]] = {}
    kinds: Counter[str] = Counter()
    for experiment in experiments(condition, {"ROBUST": pk.ROBUST}, n, seed):
        report = pk.evaluate(run(experiment).found, experiment.world)
        right.setdefault(experiment.map, []).append(report.weighted_accuracy)
        kinds.update(f"{pair.true.kind} as {pair.found.kind}" for pair in report.matches if not pair.kind_right)
        kinds.update(f"{shape.kind} missed" for shape in report.missed)
        kinds.update(f"{shape.kind} from nothing" for shape in report.false_alarms)
    means = {board: float(np.mean(scores)) for board, scores in right.items()}
    losses = ", ".join(f"{count} {kind}" for kind, count in kinds.most_common())
    yield replace(mean(name, means, at_least=least), note=losses)


def certain(n: int, seed: int) -> Iterator[Figure]:
    """Certainty is not bought by silence: ordinary shapes, other polygons, and what is left over."""
    for mm, least in CERTAIN.items():
        sure, wrong = {}, {}
        for k in range(n):
            rng = rng_of(seed, k)
            world = pk.random_world(1 + k % 6, style="free", rng=rng)
            found = pk.find_shapes(seen_on(world, rng, noise_std=mm * MM), rng=0)
            sure[f"{k}"] = (sum(one.certain for one in named(found, world.shapes)), len(world.shapes))
            wrong[f"{k}"] = bool(sure_and_wrong(found, world.shapes))
        yield share_of_things(f"ordinary shapes, {mm} mm: certain of their kind", sure, at_least=least)
        yield share(f"    boards with something sure and wrong, {mm} mm", wrong, at_most=FEW)
    for mm in CERTAIN:
        sure = {}
        for k in range(n):
            rng = rng_of(seed, 100_000 + k)
            world = pk.random_world(1 + k % 2, style="any", kinds=["polygon"] * (1 + k % 2), rng=rng)
            grid = seen_on(world, rng, noise_std=mm * MM)
            whole = [shape for shape in world.shapes if seen_whole(shape, grid) and 2 * shape.reach >= LARGE]
            ours = named(pk.find_shapes(grid, rng=0), whole)
            sure[f"{k}"] = (sum(one.certain for one in ours), len(whole))
        least = CERTAIN_POLYGONS if mm <= 2 else None
        yield share_of_things(f"other polygons, wholly seen, {mm} mm: certain of their corners", sure, at_least=least)
    yield from leftovers(n, seed)


def leftovers(n: int, seed: int) -> Iterator[Figure]:
    """On free maps without noise nothing is left."""
    others, strays = {}, {}
    for k in range(n):
        grid = seen_on(pk.random_world(1 + k % 6, style="free", rng=rng_of(seed, k)))
        found = pk.find_shapes(grid, rng=0)
        others[f"{k}"] = found.others == ()
        strays[f"{k}"] = (len(found.strays), len(grid))
    yield share("free maps without noise: `others` is empty", others, at_least=1.0)
    yield share_of_things("free maps without noise: strays among the points", strays, at_most=0.005)


def named(found: Found, shapes: list[Shape] | tuple[Shape, ...]) -> list[pk.Detection]:
    """Return those that stand for one of these shapes and have its kind and its number of corners."""
    pairs = pk.match(found, shapes)
    return [found[f] for f, t in pairs if same_name(found[f].shape, shapes[t])]


def seen_whole(shape: Shape, grid: pk.Grid) -> bool:
    return min(seen_shares(shape, grid.points())) >= WHOLE


# --- scale -------------------------------------------------------------------------------------------------------

SCALES = (0.01, 0.1, 0.3, 3.0, 10.0, 100.0)
SAME, SAME_CELL = 1e-9, 0.5  # relative; cells


def scale(n: int, seed: int) -> Iterator[Figure]:
    """Every length follows the cell: points enlarged, and boards scanned anew."""
    same, apart, anew, cells = {}, 0.0, {}, {}
    for k in range(n):
        _, grid = board([seed, k], 0.002 * (k % 2))
        here = pk.find_shapes(grid, rng=0)
        for factor in SCALES:
            there = pk.find_shapes(grid.points() * factor, resolution=0.001 * factor, rng=0)
            off = apart_by(there, here, factor)
            apart, same[f"{k} x {factor:g}"] = max(apart, off), off <= SAME
        factor = SCALES[k % len(SCALES)]
        _, grid = board([seed, k], 0.002 * (k % 2), factor)
        there = pk.find_shapes(grid, rng=0)
        off = apart_by(there, here, factor) / 0.001
        anew[f"{k} x {factor:g}"], cells[f"{k} x {factor:g}"] = np.isfinite(off), off <= SAME_CELL
    yield share(f"points enlarged 0.01 to 100 times: the same shapes to {SAME:g}", same, at_least=1.0)
    yield number("    the farthest apart of all, on a board of a metre [nm]", 1e9 * apart, len(same))
    yield share("boards scanned anew: the same kinds and counts", anew, at_least=1.0)
    yield share(f"boards scanned anew: within {SAME_CELL:g} of a cell", cells, at_least=1.0)


def board(seed: object, noise: float, k: float = 1.0) -> tuple[pk.World, pk.Grid]:
    """Return a free board, the robot's sensor and the cells, all enlarged k times."""
    world = pk.random_world(4, style="free", rng=seed)
    scans = pk.scan(world, pk.teleport_poses(world), pk.Lidar(noise_std=noise), rng=seed)
    large = pk.World([scaled(shape, k) for shape in world.shapes], world.size * k)
    grid = pk.Grid(0.001 * k)
    grid.add(scans.points() * k)
    return large, grid


def scaled(shape: Shape, k: float) -> Shape:
    return pk.Circle(shape.center * k, shape.radius * k) if shape.kind == "circle" else pk.Polygon(shape.vertices * k)


def apart_by(there: Found, here: Found, k: float) -> float:
    """Return how far corners differ once they are as large as before, metres; infinite for other kinds or counts."""
    before = [scaled(one.shape, k) for one in here]
    pairs = pk.match(there, before, gate=k)
    if not len(there) == len(here) == len(pairs) or not all(same_name(there[f].shape, before[t]) for f, t in pairs):
        return np.inf
    return max((farthest(there[f].shape, before[t]) / k for f, t in pairs), default=0.0)


def farthest(found: Shape, true: Shape) -> float:
    """Return how far any corner lies from the nearest one of the other, metres; of circles any place on them."""
    ours, theirs = (s.outline(8) if isinstance(s, pk.Circle) else s.vertices for s in (found, true))
    return max(float(np.hypot(*(theirs - corner).T).min()) for corner in ours)
