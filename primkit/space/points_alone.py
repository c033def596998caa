"""Points alone: a sphere or a cylinder through points of which nobody knows the beams.

In:  points, shape (N, 3), metres, and how far they err.
Out: a ``Sphere``, or a ``Cylinder`` as long as its points; ``None`` when no sample fixes one.

1. Leave out points that few others are near: an outlier on the side that nobody saw has a long lever.
2. RANSAC with one random point and its nearest, as ``consensus`` has it.
3. The solid of maximum likelihood near that.

>>> rng = np.random.default_rng(0)
>>> angle = rng.uniform(0, np.pi / 2, 500)
>>> quarter = np.column_stack([np.cos(angle), np.sin(angle), rng.uniform(0, 2, 500)]) + rng.normal(0, 0.002, (500, 3))
>>> round(solid_through(quarter, CYLINDER, 0.002, rng=0).radius, 2)
1.0
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ..arguments import Bools, Floats, as_points, as_positive, as_rng
from ..ransac import Model, run_ransac
from .along_beam import ROUNDS, belongs
from .consensus import CYLINDER, SPHERE, with_nearest
from .solids import Cylinder, Solid, Sphere
from .starts import drawn, nearer

CROWD, SPARSE = 8, 1.8  # nearest points; times as far as usual
PATCH, PATCH_TRIALS, AGREES = 0.2, 40, 3.0  # share of the points in a sample; samples; standard deviations
LONG = 4.0  # times the points' extent: as long as a cylinder is being fitted, they lie on no end


def solid_through(
    points: ArrayLike, model: Model, noise_std: float, *, rng: int | np.random.Generator | None = None
) -> Solid | None:
    """Return the solid that most points lie on.

    Raises ValueError if points are not finite (N, 3), the noise is not above 0, or the model is another.

    Parameters
    ----------
    points : array_like, shape (N, 3), metres
    model : Model, ``SPHERE`` or ``CYLINDER``
    noise_std : float, standard deviation of the points across the surface, metres
    rng : seed or numpy.random.Generator, optional
    """
    if model not in (SPHERE, CYLINDER):
        raise ValueError("model must be SPHERE or CYLINDER")
    points, noise_std = as_points(points, d=3), as_positive(noise_std, "noise_std")
    points = points[in_a_crowd(points)]
    nearest = with_nearest(points, model, max(model.sample_size, round(PATCH * len(points))))
    found = run_ransac(points, nearest, AGREES * noise_std, trials=PATCH_TRIALS, refit=False, rng=as_rng(rng))
    if found is None:
        return None
    place, r = found.params[:3], float(found.params[-1])
    endless = LONG * float(np.linalg.norm(np.ptp(points, axis=0)))
    start = Sphere(place, r) if model is SPHERE else Cylinder(place, found.params[3:6], r, endless)
    solid = drawn(start, points, noise_std)
    for _ in range(ROUNDS):
        solid = nearer(solid, points, belongs(solid.distance(points), noise_std), noise_std)
    if model is SPHERE:
        return solid
    along = (points[np.abs(solid.distance(points)) <= AGREES * noise_std] - solid.center) @ solid.frame[2]
    low, high = along.min(), along.max()
    return Cylinder(solid.center + (low + high) / 2 * solid.frame[2], solid.frame[2], solid.half[0], high - low)


def in_a_crowd(points: Floats) -> Bools:
    """Tell which points have others near, shape (N,): the ``CROWD``-th nearest is not far beyond what is usual."""
    from scipy.spatial import cKDTree

    if len(points) <= CROWD:
        return np.ones(len(points), dtype=bool)
    far = cKDTree(points).query(points, CROWD + 1)[0][:, -1]
    return np.asarray(far <= SPARSE * np.median(far))
