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

import numpy as np

from ..arguments import Floats
from ..ransac import run_ransac
from .along_beam import ROUNDS, SOFT, belongs, stepped
from .consensus import PLANE, SPHERE, cylinders_along
from .solids import Box, Cylinder, Solid, Sphere, frame_of, turn

ENOUGH, ROUNDS_EACH = 150, 2  # points for a start; rounds for each reach
REACHES = (0.06, 0.025, 0.01)  # m, and not below twice the noise: what is near, round by round
TRIALS, AXES, TURNS_TRIED = 60, 80, 20  # samples; directions all round; steps of a quarter turn
PLANES, LEAST_BESIDE, WIDEST = 2, 10, 5.0  # looked for; points beside one that may be an end; m, of a radius
BEST_AXES, BEST_TURNS = 3, 2  # that are drawn to the points
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
            solid = _nearer(solid, points, w, noise_std)
    return solid


def settled(solid: Solid, points: Floats, noise_std: float) -> Solid:
    """Return the solid of maximum likelihood near this one, of points that err at right angles to its surface.

    For points whose beams nobody knows; where they are known, ``along_beam.refine`` knows more.

    Parameters
    ----------
    solid : Sphere, Cylinder or Box, such as a consensus of RANSAC
    points : array, shape (N, 3), metres
    noise_std : float, metres
    """
    solid = drawn(solid, points, noise_std)
    for _ in range(ROUNDS):
        solid = _nearer(solid, points, belongs(solid.distance(points), noise_std), noise_std)
    return solid


def _nearer(solid: Solid, points: Floats, weights: Floats, noise_std: float) -> Solid:
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
    tubes = tubes[np.isfinite(tubes).all(axis=1) & (np.nan_to_num(tubes[:, 6], nan=np.inf) < WIDEST)]
    if len(tubes) == 0:
        return None
    offsets = points - tubes[:, None, :3]
    along = (offsets * tubes[:, None, 3:6]).sum(axis=2)
    low, high = np.percentile(along, [OUTERMOST, 100 - OUTERMOST], axis=1)[:, :, None]
    off = np.sqrt(np.maximum((offsets**2).sum(axis=2) - along**2, 0)) - tubes[:, 6:]
    off = np.maximum(off, np.maximum(low - along, along - high))
    best = np.argsort((np.minimum(np.abs(off), REACHES[0]) ** 2).mean(axis=1))[:BEST_AXES]
    begun = []
    for tube, a, b in zip(tubes[best], low[best, 0], high[best, 0], strict=True):
        begin = Cylinder(tube[:3] + (a + b) / 2 * tube[3:6], tube[3:6], tube[6], max(b - a, noise_std))
        begun.append(drawn(begin, points, noise_std))
    return min(begun, key=lambda solid: misfit(solid, points, REACHES[-1]))


def _box(points: Floats, planes: list[tuple[Floats, Floats]], noise_std: float) -> Solid:
    """Return the box that points lie nearest to, of those that turn about the normals of planes."""
    normals = [n for n, _ in planes]
    frames = np.concatenate([QUARTER_TURNS @ frame_of(n) for n in normals])
    x = points @ np.swapaxes(frames, 1, 2)
    low, high = np.percentile(x, [OUTERMOST, 100 - OUTERMOST], axis=1)
    off = np.abs(np.maximum(low[:, None] - x, x - high[:, None]).max(axis=2))
    best = np.argsort((np.minimum(off, REACHES[0]) ** 2).mean(axis=1))[:BEST_TURNS]
    boxes = [Box((low[k] + high[k]) / 2 @ (f := frames[k]), f, np.maximum(high[k] - low[k], noise_std)) for k in best]
    begun = [drawn(box, points, noise_std) for box in boxes]
    return min(begun, key=lambda solid: misfit(solid, points, REACHES[-1]))


def directions_all_round(n: int) -> Floats:
    """Return n unit vectors spread evenly over a half sphere, shape (n, 3): a Fibonacci spiral."""
    k = np.arange(n)
    z, way = (k + 0.5) / n, np.pi * (3 - np.sqrt(5)) * k
    across = np.sqrt(1 - z * z)
    return np.column_stack([across * np.cos(way), across * np.sin(way), z])
