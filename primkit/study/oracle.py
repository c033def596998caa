"""The oracle: a least-squares fit that is told which point belongs to which side of which shape.

No method can be expected to do better from the same points, so every accuracy figure is printed as a pair: ours
and the oracle's. It shares no code with the finding: sides by ``numpy.linalg.eigh``, circles by
``scipy.optimize.least_squares``.
"""

import numpy as np
from scipy.optimize import least_squares

import primkit as pk


def told(world, poses, lidar, rng, resolution=0.001):
    """Scan, and return the occupied cells' centres with the (shape, side) that each was hit on, and the grid.

    A beam's true hit tells the side; noise moves the point along the beam. Strays belong to (-1, -1).
    """
    exact = pk.cast_rays(world, poses, lidar.angles, lidar.range_max)
    scans = pk.scan(world, poses, lidar, rng=rng)
    grid = pk.Grid(resolution)
    grid.add(scans)
    true_hit = (exact >= lidar.range_min) & (exact <= lidar.range_max)
    at = pk.Scans(
        scans.poses,
        scans.angles,
        np.where(scans.hits & true_hit, exact, np.where(scans.hits, 0.0, np.inf)),
        scans.inside,
    )
    owners = _owners(world, at.points())
    real = (scans.hits & true_hit)[scans.hits]
    ghost = real & (np.abs(scans.ranges - np.where(true_hit, exact, 0.0))[scans.hits] > 6 * lidar.noise_std + 1e-9)
    owners[~real | ghost] = -1
    cells, first = np.unique(grid.to_cells(scans.points()), axis=0, return_index=True)
    return grid.to_points(cells), owners[first], grid


def _owners(world, points):
    """Return (shape, side) of each exact hit, shape (N, 2); the side of a circle is 0."""
    best = np.full(len(points), np.inf)
    owners = np.full((len(points), 2), -1)
    for i, shape in enumerate(world.shapes):
        if shape.kind == "circle":
            distance, side = np.abs(shape.signed_distance(points)), np.zeros(len(points), dtype=int)
        else:
            offset = points[:, None] - shape.vertices
            along = np.clip((offset * shape.edges).sum(-1) / shape.sides**2, 0, 1)
            gaps = np.linalg.norm(offset - along[..., None] * shape.edges, axis=-1)
            distance, side = gaps.min(axis=1), gaps.argmin(axis=1)
        nearer = distance < best
        best[nearer] = distance[nearer]
        owners[nearer] = np.column_stack([np.full(nearer.sum(), i), side[nearer]])
    return owners


def oracle_fit(world, points, owners):
    """Return the fitted shape for each true one, in order; None where a side has fewer than two points."""
    return [
        _circle(points[owners[:, 0] == i]) if shape.kind == "circle" else _polygon(shape, points, owners, i)
        for i, shape in enumerate(world.shapes)
    ]


def _circle(points):
    if len(points) < 3:
        return None
    middle = points.mean(axis=0)
    start = [*middle, np.hypot(*(points - middle).T).mean()]
    fit = least_squares(lambda p: np.hypot(points[:, 0] - p[0], points[:, 1] - p[1]) - p[2], start, xtol=1e-14)
    return pk.Circle(fit.x[:2], fit.x[2])


def _polygon(shape, points, owners, i):
    normals, offsets = [], []
    for side in range(len(shape.vertices)):
        own = points[(owners[:, 0] == i) & (owners[:, 1] == side)]
        if len(own) < 2:
            return None
        middle = own.mean(axis=0)
        _, axes = np.linalg.eigh(np.cov((own - middle).T))
        normals.append(axes[:, 0])
        offsets.append(axes[:, 0] @ middle)
    k = len(normals)
    try:
        corners = [
            np.linalg.solve(np.array([normals[j - 1], normals[j]]), [offsets[j - 1], offsets[j]]) for j in range(k)
        ]
        return pk.Polygon(corners)
    except (np.linalg.LinAlgError, ValueError):
        return None
