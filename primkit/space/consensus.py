"""Consensus in space: planes, spheres and cylinders for the one loop of ``ransac``, with samples drawn in two ways.

In:  points, shape (N, 3), metres.
Out: ``Model``s for ``run_ransac``; what it returns are the parameters that this table names, metres.

========  =====================================  ==============
model     parameters                             points fix it
========  =====================================  ==============
PLANE     normal (3), offset: normal . p         3
SPHERE    centre (3), radius                     4
CYLINDER  a point of the axis (3), axis (3),     7
          radius; it goes on at both ends
========  =====================================  ==============

Plain, all points of a sample are random. With inlier share w, m of them are clean in w^m of the trials. Toth and Hajder
(2019) draw **one** random point and choose the others by a rule: ``with_nearest`` takes its k nearest, so w replaces
w^m; but a patch that is small against the noise says little about what it lies on.

>>> from primkit.ransac import run_ransac
>>> rng = np.random.default_rng(0)
>>> ball = rng.normal(size=(300, 3))
>>> ball *= 0.5 / np.linalg.norm(ball, axis=1)[:, None]
>>> points = np.vstack([ball, rng.uniform(-1, 1, (100, 3))])
>>> [run_ransac(points, model, 0.01, trials=20, rng=1).params.round(3)[3].item()
...  for model in (SPHERE, with_nearest(points, SPHERE, 30))]
[0.5, 0.5]

Sources: Toth and Hajder (2019), "Robust fitting of geometric primitives on LiDAR data", of which only the abstract was
at hand: that the others are the k nearest is how the first author's later code for spheres has it; nearest points for
planes and cylinders are our reading. The algebraic sphere: Taubin (1991), "Estimation of planar curves, surfaces, and
nonplanar space curves"; bending: Hamann (1993), "Curvature approximation for triangulated surfaces".
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from ..arguments import Floats, as_count, as_points
from ..ransac import Model

FLATTEST = 1e-9  # of the points' spread: what is flatter, or narrower, fixes nothing


def with_nearest(points: ArrayLike, model: Model, k: int) -> Model:
    """Return the model with samples of one random point and the k points nearest to it (Toth and Hajder, 2019).

    Raises ValueError if points are not finite (N, 3), or k is too small to fix the model.

    Parameters
    ----------
    points : array_like, shape (N, 3), metres
        Those that ``run_ransac`` is given: where the nearest are looked for.
    model : Model
        ``PLANE``, ``SPHERE`` or ``CYLINDER``; its closed-form fit goes through all points of a sample.
    k : int
    """
    from scipy.spatial import cKDTree

    points, k = as_points(points, d=3), as_count(k, "k", model.sample_size - 1)
    tree = cKDTree(points)

    def from_seeds(seeds: Floats) -> Floats:
        near = tree.query(seeds[:, 0], min(k + 1, len(points)))[1]
        return model.from_samples(points[near])

    return replace(model, sample_size=1, from_samples=from_seeds)


def planes_through(samples: Floats) -> Floats:
    """Return the plane of least squares through each sample, (T, m, 3) -> (T, 4); NaN where points lie in a row."""
    middle = samples.mean(axis=1)
    spread, axes = np.linalg.eigh(_products(samples - middle[:, None]))
    normals = np.where((spread[:, 1] > FLATTEST**2 * spread[:, 2])[:, None], axes[:, :, 0], np.nan)
    return np.column_stack([normals, (normals * middle).sum(axis=1)])


def spheres_through(samples: Floats) -> Floats:
    """Return Taubin's sphere through each sample, (T, m, 3) -> (T, 4); NaN where points lie in a plane.

    With x from the points' middle and s the mean of ``|x|^2``: the least sum of ``(A (|x|^2 - s) + b . x)^2`` of all
    with ``4 A^2 s + |b|^2 = 1``. With A = 1 instead (Coope's) a small patch is taken for a far too small sphere.
    """
    middle = samples.mean(axis=1)
    x = samples - middle[:, None]
    squares = (x**2).sum(axis=2, keepdims=True)
    s = squares.mean(axis=1)
    scale = 2 * np.sqrt(np.maximum(s, np.finfo(float).tiny))[:, None]
    terms = np.concatenate([(squares - s[:, None]) / scale, x], axis=2)
    values, vectors = np.linalg.eigh(_products(terms))
    a, b = vectors[:, :1, 0], vectors[:, 1:, 0]
    sound = (np.abs(a) > FLATTEST) & (values[:, 1:2] > FLATTEST**2 * values[:, 3:])
    c = -b * np.sqrt(s) / np.where(sound, a, np.nan)
    return np.column_stack([middle + c, np.sqrt(s + (c**2).sum(axis=1, keepdims=True))])


def cylinders_through(samples: Floats) -> Floats:
    """Return a cylinder through each sample, (T, m, 3) -> (T, 7); NaN where points fix none.

    Over its plane a patch is bent: ``z = a (p^2 + z^2) / 2 + b p q + c (q^2 + z^2) / 2 + d p + e q + f`` by least
    squares. The axis is the way along which it is bent least: right for a patch, not for a tube that is seen all round.
    Across it, an algebraic circle goes through the points.
    """
    x = samples - samples.mean(axis=1, keepdims=True)
    axes = np.linalg.eigh(_products(x))[1]
    z, p, q = np.moveaxis(x @ axes, 2, 0)
    terms = np.stack([(p * p + z * z) / 2, p * q, (q * q + z * z) / 2, p, q, np.ones_like(p)], axis=2)
    scale = np.maximum(np.linalg.norm(terms, axis=1, keepdims=True), np.finfo(float).tiny)
    terms /= scale
    known = _products(terms) + FLATTEST * np.eye(6)  # so that points in a row have an axis, and no cylinder
    bent = np.linalg.solve(known, np.swapaxes(terms, 1, 2) @ z[:, :, None])[:, :, 0] / scale[:, 0]
    values, ways = np.linalg.eigh(bent[:, [0, 1, 1, 2]].reshape(-1, 2, 2))
    least = np.abs(values).argmin(axis=1)[:, None, None]
    return cylinders_along(samples, (axes[:, :, 1:] @ np.take_along_axis(ways, least, axis=2))[:, :, 0])


def cylinders_along(samples: Floats, axes: Floats) -> Floats:
    """Return the cylinder of least squares along each axis, (T, m, 3) points and (T, 3) -> (T, 7)."""
    middle = samples.mean(axis=1)
    x = samples - middle[:, None]
    x = x - (x @ axes[:, :, None]) * axes[:, None]  # across the axis
    squares = (x**2).sum(axis=2)
    # Along the axis nothing is known: it is given a weight of its own, and the centre stays at the points' middle.
    normal = 2 * _products(x) + axes[:, :, None] * axes[:, None] * squares.sum(axis=1)[:, None, None]
    c = _solve(normal, (x * (squares - squares.mean(axis=1, keepdims=True))[:, :, None]).sum(axis=1))
    return np.column_stack([middle + c, axes, np.sqrt(squares.mean(axis=1) + (c**2).sum(axis=1))])


def _products(x: Floats) -> Floats:
    return np.swapaxes(x, 1, 2) @ x


def _solve(a: Floats, b: Floats) -> Floats:
    """Solve T systems, (T, 3, 3) and (T, 3); a row of NaN where one has no single solution."""
    values = np.linalg.eigvalsh(a)
    sound = values[:, 0] > FLATTEST * values[:, -1]
    a = np.where(sound[:, None, None], a, np.eye(3))
    return np.where(sound[:, None], np.linalg.solve(a, b[:, :, None])[:, :, 0], np.nan)


def _from_planes(params: Floats, points: Floats) -> Floats:
    return np.abs(params[:, :3] @ points.T - params[:, 3:])


def _from_spheres(params: Floats, points: Floats) -> Floats:
    return np.abs(np.sqrt(np.maximum(_squares(params[:, :3], points), 0.0)) - params[:, 3:])


def _from_cylinders(params: Floats, points: Floats) -> Floats:
    c, w = params[:, :3], params[:, 3:6]
    along = w @ points.T - (c * w).sum(axis=1, keepdims=True)
    return np.abs(np.sqrt(np.maximum(_squares(c, points) - along**2, 0.0)) - params[:, 6:])


def _squares(c: Floats, points: Floats) -> Floats:
    return (points**2).sum(axis=1) - 2 * c @ points.T + (c**2).sum(axis=1, keepdims=True)


PLANE = Model(3, planes_through, _from_planes, lambda points: planes_through(points[None])[0], 3)
SPHERE = Model(4, spheres_through, _from_spheres, lambda points: spheres_through(points[None])[0], 3)
CYLINDER = Model(7, cylinders_through, _from_cylinders, lambda points: cylinders_through(points[None])[0], 3)
