"""Scenes: solids over a ground, the truth that a LiDAR of many layers looks at.

In:  solids; or how many there are to be, and a seed.
Out: a ``Scene``: solids that do not touch, over the plane z = 0.

>>> scene = random_scene(4, rng=7)
>>> len(scene.solids), all(solid.center[2] - solid.reach(UP) > -1e-12 for solid in scene.solids)
(4, True)
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from ..arguments import Floats, Ints, as_count, as_positive, as_rng, check_type, limit
from .solids import Box, Cylinder, Plane, Solid, Sphere, altered, hit, turn

UP = np.array([0.0, 0.0, 1.0])
GROUND, NOTHING = -1, -2  # what a beam meets that meets no solid
RADII, SLIM_RADII, HEIGHTS, SIDES = (0.12, 0.45), (0.08, 0.35), (0.4, 1.3), (0.2, 0.9)  # m
TILTS, LIFTS = (0.17, 1.4), (0.1, 0.5)  # rad from upright; m above the ground
TILTED_SHARE, LIFTED_SHARE = 0.5, 0.3
MOST_TRIES = 2_000  # places tried for a solid


@dataclass(frozen=True)
class Scene:
    """Solids over the ground z = 0. Raises ValueError if something else is among them."""

    solids: tuple[Solid, ...] = ()

    def __init__(self, solids: Iterable[Solid] = ()) -> None:
        vars(self).update(solids=tuple(solids))
        for solid in self.solids:
            check_type(solid, (Sphere, Cylinder, Box), "solids must be Sphere, Cylinder or Box")

    def hit(self, origin: Floats, directions: Floats) -> tuple[Floats, Ints]:
        """Return the ranges at which beams from one place meet something, metres (inf: nothing), and what it is.

        Beams are unit vectors, shape (N, 3). What they meet is the number of the solid, ``GROUND`` or ``NOTHING``.
        Only the beams that pass within a solid's ball around its middle are asked whether they meet it.
        """
        t = Plane(UP, 0).hit(origin, directions)
        what = np.where(np.isfinite(t), GROUND, NOTHING)
        for k, solid in enumerate(self.solids):
            near = np.flatnonzero(within(solid.center, solid.around, origin, directions))
            ti = hit(solid, origin, directions[near])
            first = ti < t[near]
            t[near[first]], what[near[first]] = ti[first], k
        return t, what


def within(center: Floats, reach: float, origin: Floats, directions: Floats) -> np.ndarray:
    """Tell which beams from one place pass within ``reach`` metres of a point, shape (N,)."""
    to = center - origin
    away = float(to @ to) - reach**2
    if away <= 0:
        return np.ones(len(directions), dtype=bool)
    return directions @ to >= np.sqrt(away) * (1 - 1e-9)  # inside the cone that touches the ball


def random_scene(
    n_solids: int = 4, *, half: float = 2.2, gap: float = 0.15, rng: int | np.random.Generator | None = None
) -> Scene:
    """Return a scene of solids of random kind, size and place that do not touch.

    Raises ValueError if an argument is out of range, or the scene is too small for so many.

    Parameters
    ----------
    n_solids : int
    half : float
        Middles lie within so many metres of the z axis, along x and along y.
    gap : float
        Seen from above, so many metres are free between the balls around two solids.
    rng : seed or numpy.random.Generator, optional
    """
    n_solids, half = as_count(n_solids, "n_solids", 0), as_positive(half, "half")
    gap, rng = as_positive(gap, "gap", zero=True), as_rng(rng)
    solids = list[Solid]()
    tries = 0
    while len(solids) < n_solids:
        limit(tries := tries + 1, MOST_TRIES, "a scene must have room: tried {} places", "are there too many solids?")
        new = _random_solid(rng, rng.uniform(-half, half, 2))
        if all(np.hypot(*(new.center - s.center)[:2]) > new.around + s.around + gap for s in solids):
            solids.append(new)
    return Scene(solids)


def _random_solid(rng: np.random.Generator, place: Floats) -> Solid:
    """Return a solid that stands on the ground at this place, or hangs above it."""
    kind = rng.choice(["sphere", "cylinder", "box"], p=[0.25, 0.5, 0.25])
    lifted, middle = rng.random() < LIFTED_SHARE, np.array([*place, 0.0])
    way = rng.uniform(0, 2 * np.pi)
    solid: Solid
    if kind == "sphere":
        solid = Sphere(middle, rng.uniform(*RADII))
    elif kind == "cylinder":
        tilt = rng.uniform(*TILTS) if rng.random() < TILTED_SHARE else 0.0
        axis = np.sin(tilt) * np.cos(way), np.sin(tilt) * np.sin(way), np.cos(tilt)
        solid = Cylinder(middle, axis, rng.uniform(*SLIM_RADII), rng.uniform(*HEIGHTS))
    else:
        frame = turn(way * UP)
        if lifted and rng.random() < TILTED_SHARE:
            frame = turn(np.array([rng.uniform(*TILTS), 0.0, 0.0])) @ frame
        solid = Box(middle, frame, rng.uniform(*SIDES, 3))
    up = (rng.uniform(*LIFTS) if lifted else 0.0) - (solid.center[2] - solid.reach(UP))
    return altered(solid, center=solid.center + up * UP)
