"""Ground: the plane that everything stands on, what stands on it, and how far ranges err.

In:  a ``Cloud``.
Out: ``Ground``: the plane, the noise of the ranges, which returns are its own; and groups of the others.

>>> from primkit.space.lidar3d import scan
>>> from primkit.space.scenes import Scene
>>> from primkit.space.solids import Sphere
>>> cloud = scan(Scene([Sphere((2, 0, 0.4), 0.4), Sphere((0, 2, 0.4), 0.4)]), [(0, 0, 0.6)], rng=0)
>>> ground = find_ground(cloud, rng=0)
>>> ground.plane.normal.round(3)[2].item(), round(ground.noise_std, 3)
(1.0, 0.005)
>>> len(groups(cloud, ground))
2

The ground is seen at a slant, so what is close to it across may be far along the beam: like all in this wing, a return
is judged along its beam.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arguments import Bools, Floats, Ints, as_rng
from ..ransac import run_ransac
from ..segmentation import components
from .consensus import PLANE
from .lidar3d import Cloud
from .solids import Plane

GROUND_SAMPLE, GROUND_EVERY, GROUND_TRIALS, GROUND_ROUNDS = 12_000, 8, 100, 4  # returns; every so many for the trials
GROUND_REACH, LEVEL_ENOUGH, LEAST_GROUND = 0.03, 0.9, 50  # m; cosine of the slope; returns
ON_GROUND = 5.0  # standard deviations along the beam
USUAL_NOISE, LEAST_RANGE_NOISE = 0.01, 1e-4  # m: until the ground tells; so that nothing is divided by zero
NEAR_BESIDE, BEAMS_BESIDE = 0.1, 2  # m, beams: a return is no stray when one of so many to each side hit as near to it
LINK_CELL, APART = 0.03, 0.15  # m: returns are put into cells, and cells so far apart are linked
LEAST_RETURNS = 20  # of a group


@dataclass(frozen=True, eq=False)
class Ground:
    """The ground: its plane, normal up, the noise of ranges, metres, and its returns, shape (P, L, A)."""

    plane: Plane | None
    noise_std: float
    returns: Bools


def find_ground(cloud: Cloud, *, rng: int | np.random.Generator | None = None) -> Ground:
    """Return the plane that most returns lie on, fitted along the beam, and the noise of the ranges that it tells.

    Where no level plane has ``LEAST_GROUND`` returns there is none, and the noise is supposed to be 10 mm.
    """
    every = -(-int(cloud.hits.sum()) // GROUND_SAMPLE) or 1
    number = np.flatnonzero(cloud.hits)[::every]
    (origins, directions, ranges), points = cloud.beams(number), cloud.points(number)
    nothing = Ground(None, USUAL_NOISE, np.zeros(cloud.ranges.shape, dtype=bool))
    found = run_ransac(points[::GROUND_EVERY], PLANE, GROUND_REACH, trials=GROUND_TRIALS, rng=as_rng(rng))
    if found is None or abs(found.params[2]) < LEVEL_ENOUGH:
        return nothing
    plane, noise = Plane(found.params[:3], found.params[3]), USUAL_NOISE
    for _ in range(GROUND_ROUNDS):
        off = ranges - plane.hit(origins, directions)
        own = np.abs(off) <= ON_GROUND * noise
        if np.count_nonzero(own) < LEAST_GROUND:
            return nothing
        noise = max(LEAST_RANGE_NOISE, 1.4826 * float(np.median(np.abs(off[own]))))  # of a normal distribution
        x, y, z = points[own].T
        weights = 1 / (directions[own] @ plane.normal)  # a point off by 1 across is off by so much along its beam
        terms = np.column_stack([np.ones_like(x), x, y]) * weights[:, None]
        a, b, c = np.linalg.lstsq(terms, z * weights)[0]  # z = a + b x + c y
        plane = Plane((-b, -c, 1), a / np.sqrt(1 + b * b + c * c))
    to_ground = np.array([plane.hit(origin, cloud.turn) for origin in cloud.origins]).reshape(cloud.ranges.shape)
    with np.errstate(invalid="ignore"):
        return Ground(plane, noise, cloud.hits & (np.abs(cloud.ranges - to_ground) <= ON_GROUND * noise))


def groups(cloud: Cloud, ground: Ground) -> list[Ints]:
    """Return groups of returns that are not the ground's: the numbers of their beams, in ``ranges`` laid flat.

    Strays, which no beam beside them bears out, are left out; and groups of fewer than ``LEAST_RETURNS``.
    """
    return taken_apart(cloud, np.flatnonzero(in_company(cloud, ~ground.returns)), APART)


def taken_apart(cloud: Cloud, members: Ints, apart: float) -> list[Ints]:
    """Return the parts of some returns, by the numbers of their beams, that lie so far apart, metres."""
    label = linked(cloud.points(members), apart)
    parts = [members[label == k] for k in range(label.max(initial=-1) + 1)]
    return [part for part in parts if len(part) >= LEAST_RETURNS]


def in_company(cloud: Cloud, standing: Bools) -> Bools:
    """Tell which of the returns have one beside them in their layer that is near, shape (P, L, A)."""
    r = np.where(cloud.hits & standing, cloud.ranges, np.inf)
    turn = 2 * np.pi / r.shape[2]
    fine = np.zeros(r.shape, dtype=bool)
    for k in range(1, BEAMS_BESIDE + 1):
        other = np.roll(r, -k, axis=2)
        with np.errstate(invalid="ignore"):
            near = (r - other) ** 2 + r * other * (k * turn * np.cos(cloud.elevations)[:, None]) ** 2 <= NEAR_BESIDE**2
        fine |= near | np.roll(near, k, axis=2)
    return fine


def linked(points: Floats, apart: float) -> Ints:
    """Return the number of each point's group, shape (N,): cells with points, linked within ``apart`` metres."""
    from scipy.spatial import cKDTree

    if len(points) == 0:
        return np.empty(0, dtype=np.intp)
    ijk = np.floor((points - points.min(axis=0)) / LINK_CELL).astype(np.int64)
    _, columns, heights = ijk.max(axis=0) + 1
    cells, cell = np.unique((ijk[:, 0] * columns + ijk[:, 1]) * heights + ijk[:, 2], return_inverse=True)
    cell = cell.astype(np.intp, copy=False)  # on 32 bits, no count has 64
    n = np.bincount(cell)
    middle = np.column_stack([np.bincount(cell, x) for x in points.T]) / n[:, None]
    pairs = cKDTree(middle).query_pairs(apart, output_type="ndarray").T
    return components(len(cells), pairs)[cell]
