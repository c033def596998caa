"""Oracle: what the truth tells of a drive: whose each point is, what was seen, and the best fit to the same points.

In:  a ``World``, the ``Scans`` of it, and the sensor that made them.
Out: the grid's points with the (shape, side) that each was hit on, and from both the fitted shapes; the share of each
outline that was seen.

>>> from primkit.lidar import scan
>>> from primkit.robot import teleport_poses
>>> world = World([Circle((0.1, 0.0), 0.06)])
>>> points, owners = told_points(world, scan(world, teleport_poses(world)))
>>> oracle_fit(world, points, owners)[0].centroid.round(3).tolist()
[0.1, 0.0]

The fit is by least squares, told the kinds, and shares no code with the finding. Its limit: it has no shape where a
side has fewer than two points, though a method may guess it rightly.

Sources: total least squares by the smallest eigenvector of the scatter, Pearson (1901), "On lines and planes of closest
fit"; the circle's geometric fit by least squares, as in Chernov (2010), "Circular and Linear Regression".
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from ..arguments import Floats, Ints
from ..grid import Grid
from ..lidar import Lidar, Scans, as_lidar
from ..raycast import cast_rays
from ..seen import share_seen
from ..shapes import Circle, Polygon, Shape
from ..world import World

NOBODY = -1  # the owner of a point that comes from nowhere
NOISE_LIMIT = 6.0  # a reading farther than this from the true range, in standard deviations, is no noise
TURN_LEFT = np.array([[0, -1], [1, 0]])  # by a quarter
EXACT = 1e-9  # m: without noise a reading differs by rounding at most


@dataclass(frozen=True)
class Oracle:
    """Stands where a method's ``Settings`` stand: an experiment with it is measured by the oracle."""

    method: Literal["oracle"] = "oracle"


ORACLE = Oracle()


def told_points(
    world: World, scans: Scans, lidar: Lidar | None = None, resolution: float = 0.001
) -> tuple[Floats, Ints]:
    """Return the grid's points, and the side of the shape that each was hit on.

    Parameters
    ----------
    world : World
        The truth.
    scans : Scans
        What the LiDAR saw of it.
    lidar : Lidar, optional
        The sensor that made the scans; the paper's by default.
    resolution : float
        Side of the grid's cells in metres.

    Returns
    -------
    points : array, shape (N, 2)
        Centres of the occupied cells, metres; the same, in the same order, as ``Grid.points()``.
    owners : array of int, shape (N, 2)
        (shape, side), counted from 0; a circle has side 0 only. (-1, -1) for a point that comes from nowhere.

    Notes
    -----
    The true hit of a beam tells the side; noise moves the point along the beam. A cell that was hit from several
    sides belongs to the first. A rendered LiDAR has no true hit: its points belong to the side they are nearest to.
    """
    lidar = as_lidar(lidar, world.scale)
    grid = Grid(resolution)
    cells, first = np.unique(grid.to_cells(scans.points()), axis=0, return_index=True)
    if lidar.model == "webots":
        return grid.to_points(cells), hit_sides(world, scans.points())[first]
    exact = _exact_ranges(world, scans, lidar)
    seen, true = scans.ranges[scans.hits], exact[scans.hits]
    real = np.isfinite(true)
    real[real] = np.abs(seen[real] - true[real]) <= NOISE_LIMIT * lidar.noise_std + EXACT
    owners = np.full((len(seen), 2), NOBODY)
    hits = replace(scans, ranges=np.where(scans.hits, exact, np.inf)).points()
    owners[np.isfinite(true)] = hit_sides(world, hits)
    owners[~real] = NOBODY
    return grid.to_points(cells), owners[first]


def _exact_ranges(world: World, scans: Scans, lidar: Lidar) -> Floats:
    """Return what a sensor without faults measures from the same poses, shape (P, B), metres; ``inf``: nothing."""
    exact = cast_rays(world, scans.poses, scans.angles, lidar.range_max)
    exact[exact < lidar.range_min] = np.inf
    return exact


def exact_hits(world: World, scans: Scans, lidar: Lidar) -> tuple[Floats, Ints]:
    """Return the hits, shape (N, 2), that a sensor without faults would have had, and the (shape, side) of each."""
    hits = replace(scans, ranges=_exact_ranges(world, scans, lidar)).points()
    return hits, hit_sides(world, hits)


def shares_seen(world: World, scans: Scans, lidar: Lidar) -> tuple[float, ...]:
    """Return for each shape of a world the share of its outline that was seen, by the exact hits on it.

    Examples
    --------
    >>> from primkit.lidar import scan
    >>> world = World([Circle((0.2, 0.0), 0.05), Circle((-0.4, 0.0), 0.05)])
    >>> [round(share, 1) for share in shares_seen(world, scan(world, [(0, 0, 0)]), Lidar())]
    [0.4, 0.0]
    """
    hits, owners = exact_hits(world, scans, lidar)
    own = ((shape, hits[owners[:, 0] == number]) for number, shape in enumerate(world.shapes))
    return tuple(share_seen(shape, points, world.cell) for shape, points in own)


def hit_sides(world: World, hits: Floats) -> Ints:
    """Return (shape, side) of points that lie exactly on outlines, shape (N, 2) -> (N, 2)."""
    nearest, owners = np.full(len(hits), np.inf), np.full((len(hits), 2), NOBODY)
    for number, shape in enumerate(world.shapes):
        gaps = _gaps(shape, hits)
        side, gap = gaps.argmin(axis=1), gaps.min(axis=1)
        nearer = gap < nearest
        nearest[nearer] = gap[nearer]
        owners[nearer, 0], owners[nearer, 1] = number, side[nearer]
    return owners


def _gaps(shape: Shape, points: Floats) -> Floats:
    """Return the distance of each point from each side, shape (N, K), metres; a circle is one side."""
    if isinstance(shape, Circle):
        return np.abs(shape.signed_distance(points))[:, None]
    offset = points[:, None] - shape.vertices
    along = np.clip((offset * shape.edges).sum(axis=-1) / shape.sides**2, 0, 1)
    return np.linalg.norm(offset - along[..., None] * shape.edges, axis=-1)


def oracle_fit(world: World, points: Floats, owners: Ints) -> list[Shape | None]:
    """Return the shape that fits each true one's points best, in the order of the true ones.

    Parameters
    ----------
    world : World
        The truth: the number of sides is taken from it.
    points, owners : array, shape (N, 2)
        Of ``told_points``.

    Returns
    -------
    list of Circle, Polygon and None
        None where a side has fewer than two points, or a circle fewer than three; and where the sides' lines do
        not meet in a simple outline.

    Examples
    --------
    >>> oracle_fit(World([Circle((0, 0), 0.1)]), np.empty((0, 2)), np.empty((0, 2), dtype=int))
    [None]
    """
    fits: list[Shape | None] = []
    for number, shape in enumerate(world.shapes):
        own = owners[:, 0] == number
        if isinstance(shape, Circle):
            fits.append(_fit_circle(points[own]))
        else:
            sides = [points[own & (owners[:, 1] == side)] for side in range(len(shape.vertices))]
            fits.append(_fit_polygon(sides, right_angles=shape.kind == "rectangle"))
    return fits


def _fit_circle(points: Floats) -> Circle | None:
    from scipy.optimize import least_squares

    if len(points) < 3:
        return None
    middle = points.mean(axis=0)
    start = [*middle, np.hypot(*(points - middle).T).mean()]
    fit = least_squares(lambda p: np.hypot(points[:, 0] - p[0], points[:, 1] - p[1]) - p[2], start, xtol=1e-14)
    return Circle(fit.x[:2], abs(float(fit.x[2])))


def _fit_polygon(sides: list[Floats], *, right_angles: bool) -> Polygon | None:
    """Fit a line ``n . p = d`` to the points of each side, and take the corners where neighbours meet.

    n is the eigenvector of the least eigenvalue of a side's scatter; of a rectangle, whose n_k is n_0 turned by k
    quarters, of the sum of all four scatters turned back.
    """
    if min(map(len, sides)) < 2:
        return None
    middles = np.array([side.mean(axis=0) for side in sides])
    scatters = np.array([(side - middle).T @ (side - middle) for side, middle in zip(sides, middles, strict=True)])
    if right_angles:
        turns = np.array([np.linalg.matrix_power(TURN_LEFT, k) for k in range(4)])
        together = (turns.transpose(0, 2, 1) @ scatters @ turns).sum(axis=0)
        normals = turns @ np.linalg.eigh(together)[1][:, 0]
    else:
        normals = np.linalg.eigh(scatters)[1][:, :, 0]
    offsets = (normals * middles).sum(axis=1)
    pairs = np.stack([np.roll(normals, 1, axis=0), normals], axis=1)  # (K, 2, 2): each side with the one before it
    try:
        return Polygon(np.linalg.solve(pairs, np.column_stack([np.roll(offsets, 1), offsets])[..., None])[..., 0])
    except (np.linalg.LinAlgError, ValueError):
        return None
