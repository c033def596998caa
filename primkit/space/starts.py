"""Starts: for each kind, the solid from which ``refine`` begins.

In:  the points of a group, shape (N, 3), metres, and the noise of their ranges.
Out: a sphere, a cylinder, a box, as far as the points let one be fitted.

1. Sphere: RANSAC. Cylinder: algebraic circles across many axes. Box: turned about the normals of planes.
2. Each is drawn to the points, at right angles to its surface, while what counts as near shrinks.

>>> rng = np.random.default_rng(0)
>>> points = rng.uniform(-1, 1, (300, 3))
>>> points *= 0.3 / np.linalg.norm(points, axis=1)[:, None]
>>> [solid.kind for solid in starts(points, 0.001, rng=rng)][0], round(starts(points, 0.001, rng=rng)[0].radius, 3)
('sphere', 0.3)
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..arguments import Floats
from ..ransac import run_ransac
from .along_beam import SOFT, stepped
from .consensus import PLANE, SPHERE, cylinders_along
from .solids import Box, Cylinder, Solid, Sphere, frame_of, turn

ENOUGH, ROUNDS_EACH = 150, 2  # points for a start; rounds for each reach
REACHES = (0.06, 0.025, 0.01)  # m, and not below twice the noise: what is near, round by round
TRIALS, AXES, TURNS_TRIED = 60, 80, 20  # samples; directions all round; steps of a quarter turn
PLANES, LEAST_BESIDE, WIDEST = 2, 10, 5.0  # looked for; points beside one that may be an end; m, of a radius
MOST_PROMISING = 2  # are drawn to the points
QUARTER_TURNS = np.array([turn(np.array([0, 0, a])) for a in np.arange(TURNS_TRIED) * np.pi / 2 / TURNS_TRIED])
OUTERMOST = 2.0  # percent of the points at each end that a first size does not count


def starts(points: Floats, noise_std: float, *, rng: np.random.Generator) -> list[Solid]:
    """Return the best start of each kind, of ``ENOUGH`` points or fewer."""
    near = 3 * noise_std
    planes, rest = [(np.array([0.0, 0.0, 1.0]), points)], points  # normals, and the points beside each plane
    for _ in range(PLANES):
        plane = run_ransac(rest, PLANE, near, trials=TRIALS, rng=rng)
        if plane is None:
            break
        rest = rest[~plane.inliers]
        planes.append((plane.params[:3], points[PLANE.residuals(plane.params[None], points)[0] > near]))
    found = [_sphere(points, near, rng), _cylinder(points, planes, noise_std), _box(points, planes, noise_std)]
    return [solid for solid in found if solid is not None]


def drawn(solid: Solid, points: Floats, noise_std: float) -> Solid:
    """Return the solid drawn to the points: least squares across its surface, where far points count less and less."""
    for reach in REACHES:
        for _ in range(ROUNDS_EACH):
            w = 1 / (1 + (solid.distance(points) / max(reach, 2 * noise_std)) ** 2) ** 2
            solid = nearer(solid, points, w, noise_std)
    return solid


def nearer(solid: Solid, points: Floats, weights: Floats, noise_std: float) -> Solid:
    """Return the solid after one step of weighted least squares; itself when nothing would be left of it."""
    speeds = solid.speeds(points)[1]
    pulls = speeds.T * weights / noise_std**2
    step = np.linalg.solve(pulls @ speeds + SOFT * np.eye(solid.numbers), pulls @ solid.distance(points))
    return stepped(solid, np.asarray(step, dtype=float)) or solid


def misfit(solid: Solid, points: Floats, reach: float) -> float:
    """Return how badly points lie on a solid: the mean of min(distance, reach)^2, m^2."""
    return float((np.minimum(np.abs(solid.distance(points)), reach) ** 2).mean())


def _sphere(points: Floats, near: float, rng: np.random.Generator) -> Sphere | None:
    found = run_ransac(points, SPHERE, near, trials=TRIALS, score="truncated", rng=rng)
    if found is None or found.params[3] > WIDEST:
        return None
    return Sphere(found.params[:3], found.params[3])


def _cylinder(points: Floats, planes: list[tuple[Floats, Floats]], noise_std: float) -> Solid | None:
    """Return the cylinder that points lie nearest to: along many axes, and across each plane, which may be its end."""
    axes = directions_all_round(AXES)
    tubes = cylinders_along(np.broadcast_to(points, (len(axes), *points.shape)), axes)
    across = [cylinders_along(beside[None], n[None]) for n, beside in planes if len(beside) >= LEAST_BESIDE]
    tubes = np.vstack([tubes, *across])
    c, w, r = np.split(tubes[np.isfinite(tubes).all(axis=1) & (tubes[:, 6] < WIDEST)], [3, 6], axis=1)
    if len(c) == 0:
        return None
    offsets = points - c[:, None]
    along = (offsets * w[:, None]).sum(axis=2)
    low, high = np.percentile(along, [OUTERMOST, 100 - OUTERMOST], axis=1)[:, :, None]
    off = np.sqrt(np.maximum((offsets**2).sum(axis=2) - along**2, 0)) - r
    off = np.maximum(off, np.maximum(low - along, along - high))
    middle, height = c + (low + high) / 2 * w, np.maximum(high - low, noise_std)
    return _best(lambda k: Cylinder(middle[k], w[k], float(r[k, 0]), float(height[k, 0])), off, points, noise_std)


def _box(points: Floats, planes: list[tuple[Floats, Floats]], noise_std: float) -> Solid:
    """Return the box that points lie nearest to, of those that turn about the normals of planes."""
    frames = np.concatenate([QUARTER_TURNS @ frame_of(n) for n, _ in planes])
    upright_last = np.argsort(np.abs(frames[:, :, 2]), axis=1, kind="stable")  # so that height is what all call so
    frames = np.take_along_axis(frames, upright_last[:, :, None], axis=1)
    x = points @ np.swapaxes(frames, 1, 2)
    low, high = np.percentile(x, [OUTERMOST, 100 - OUTERMOST], axis=1)
    off = np.maximum(low[:, None] - x, x - high[:, None]).max(axis=2)
    size = np.maximum(high - low, noise_std)
    return _best(lambda k: Box((low[k] + high[k]) / 2 @ frames[k], frames[k], size[k]), off, points, noise_std)


def _best(begun: Callable[[int], Solid], off: Floats, points: Floats, noise_std: float) -> Solid:
    """Draw the most promising solids to the points, by how far these lie off each, (K, N); return the nearest."""
    promising = np.argsort((np.minimum(np.abs(off), REACHES[0]) ** 2).mean(axis=1))[:MOST_PROMISING].tolist()
    return min((drawn(begun(k), points, noise_std) for k in promising), key=lambda s: misfit(s, points, REACHES[-1]))


def directions_all_round(n: int) -> Floats:
    """Return n unit vectors spread evenly over a half sphere, shape (n, 3): a Fibonacci spiral."""
    k = np.arange(n)
    z, way = (k + 0.5) / n, np.pi * (3 - np.sqrt(5)) * k
    across = np.sqrt(1 - z * z)
    return np.column_stack([across * np.cos(way), across * np.sin(way), z])
