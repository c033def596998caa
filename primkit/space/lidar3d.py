"""Lidar3d: a LiDAR of many layers, and the clouds that it makes, the misses in them.

In:  a scene and the places that the sensor stands at, shape (P, 3), metres.
Out: a ``Cloud``: for each place, layer and azimuth a range; ``inf`` where nothing came back.

>>> from primkit.space.solids import Sphere
>>> cloud = scan(Scene([Sphere((2, 0, 0.5), 0.5)]), [(0, 0, 0.5)], Lidar3d(layers=3, azimuths=90, noise_std=0))
>>> cloud.ranges.shape, cloud.ranges[0, 1, 0].item(), int(cloud.hits.sum())
((1, 3, 90), 1.5, 97)

A beam that came back says where something is. One that did not says where nothing is, as far as the sensor reaches:
that is why a cloud is more than its points.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from ..arguments import (
    Bools,
    Floats,
    Ints,
    as_count,
    as_floats,
    as_points,
    as_positive,
    as_rng,
    as_share,
    check_type,
    limit,
)
from .scenes import Scene

MOST_BEAMS_OF_ALL = 20_000_000  # in a cloud: 160 MB of ranges
NEAREST_SPURIOUS = 0.2  # m: a random range lies between this and what is there


@dataclass(frozen=True)
class Lidar3d:
    """A LiDAR that turns, with several layers of beams. Raises ValueError if an argument is out of range.

    Parameters
    ----------
    layers, azimuths : int
        Beams one above the other, evenly over ``fov``; and steps of the full turn, from the x axis to the y axis.
    fov : float
        Angle between the lowest and the highest layer, radians, half of it below the horizon.
    range_max, noise_std : float
        Farthest range that is measured, and standard deviation of its error, metres.
    spurious : float
        Share of the returns that come from nowhere, somewhere before what is there.

    Examples
    --------
    >>> Lidar3d(layers=3, fov=0.4).elevations.round(3).tolist()
    [-0.2, 0.0, 0.2]
    """

    layers: int = 16
    azimuths: int = 900
    fov: float = np.pi / 6
    range_max: float = 12.0
    noise_std: float = 0.005
    spurious: float = 0.0

    def __post_init__(self) -> None:
        as_count(self.layers, "layers")
        as_count(self.azimuths, "azimuths")
        if not as_positive(self.fov, "fov", zero=True) < np.pi:
            raise ValueError(f"fov must be less than pi, got {self.fov:g}; is it in degrees?")
        as_positive(self.range_max, "range_max")
        as_positive(self.noise_std, "noise_std", zero=True)
        as_share(self.spurious, "spurious")

    @property
    def elevations(self) -> Floats:
        """The angle of each layer above the horizon, shape (layers,), radians."""
        return np.linspace(-self.fov / 2, self.fov / 2, self.layers)


@dataclass(frozen=True, eq=False)
class Cloud:
    """What a LiDAR of many layers saw. Raises ValueError if shapes do not agree or a value is out of range.

    Parameters
    ----------
    origins : array_like, shape (P, 3): where the sensor stood, upright, metres, world frame
    elevations : array_like, shape (L,): angle of each layer above the horizon, radians
    ranges : array_like, shape (P, L, A)
        Metres, ``inf`` where nothing came back; the azimuths go evenly round, from the x axis to the y axis.
    """

    origins: Floats
    elevations: Floats
    ranges: Floats

    def __init__(self, origins: ArrayLike, elevations: ArrayLike, ranges: ArrayLike) -> None:
        origins, elevations = as_points(origins, "origins", 3), as_floats(elevations, "elevations", "(L,)")
        ranges = as_floats(ranges, "ranges", "(P, L, A)")
        if ranges.ndim != 3 or ranges.shape[:2] != (len(origins), *elevations.shape):
            got = f"{ranges.shape} for {len(origins)} origins and elevations of shape {elevations.shape}"
            raise ValueError(f"ranges must have shape (P, L, A), got {got}")
        if (bad := ranges[~(ranges > 0)]).size:
            raise ValueError(f"ranges must be > 0, or inf for no return, got {bad[0]:g}")
        if (bad := elevations[~(np.abs(elevations) <= np.pi / 2)]).size:
            raise ValueError(f"elevations must be at most pi / 2, got {bad[0]:g}; are they in degrees?")
        vars(self).update(origins=origins, elevations=elevations, ranges=ranges)

    @property
    def hits(self) -> Bools:
        """Which beams came back, shape (P, L, A)."""
        return self.ranges < np.inf

    @cached_property
    def turn(self) -> Floats:
        """The unit vector along each beam of a full turn, shape (L A, 3), world frame."""
        return turn_of(self.elevations, self.ranges.shape[2])

    def beams(self, number: Ints) -> tuple[Floats, Floats, Floats]:
        """Return origins, directions and ranges of beams, by their numbers in ``ranges`` laid flat, shape (N,)."""
        pose, beam = np.divmod(number, len(self.turn))
        return self.origins[pose], self.turn[beam], self.ranges.ravel()[number]

    def points(self, number: Ints | None = None) -> Floats:
        """Return where beams came back from, shape (N, 3), metres: all that did, in order, or some by number."""
        origins, directions, ranges = self.beams(np.flatnonzero(self.hits) if number is None else number)
        return origins + ranges[:, None] * directions

    def __repr__(self) -> str:
        places, layers, azimuths = self.ranges.shape
        return f"Cloud: {int(self.hits.sum())} returns of {places} x {layers} x {azimuths} beams"


def turn_of(elevations: Floats, azimuths: int) -> Floats:
    """Return the unit vector of each layer and azimuth, shape (L A, 3), layer by layer."""
    e, a = elevations[:, None], 2 * np.pi * np.arange(azimuths) / azimuths
    return np.stack([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e) + 0 * a], axis=2).reshape(-1, 3)


def scan(
    scene: Scene, origins: ArrayLike, lidar: Lidar3d | None = None, *, rng: int | np.random.Generator | None = None
) -> Cloud:
    """Return what a LiDAR sees of a scene from some places; errors lie along the beam.

    Raises ValueError if origins are not finite (P, 3), or there are too many beams.

    Parameters
    ----------
    scene : Scene
    origins : array_like, shape (P, 3), metres
    lidar : Lidar3d
    rng : seed or numpy.random.Generator, optional
    """
    check_type(scene, Scene, "scene must be a Scene")
    origins, lidar, rng = as_points(origins, "origins", 3), lidar or Lidar3d(), as_rng(rng)
    turn = turn_of(lidar.elevations, lidar.azimuths)
    limit(len(origins) * len(turn), MOST_BEAMS_OF_ALL, "a cloud must have at most {} beams")
    t = np.array([scene.hit(origin, turn)[0] for origin in origins]).reshape(len(origins), len(turn))
    seen = t <= lidar.range_max
    r = np.where(seen, np.maximum(t + rng.normal(0, lidar.noise_std, t.shape), np.finfo(float).tiny), np.inf)
    false = seen & (rng.random(t.shape) < lidar.spurious)
    near = np.minimum(NEAREST_SPURIOUS, t[false])
    r[false] = rng.uniform(near, t[false])
    return Cloud(origins, lidar.elevations, r.reshape(len(origins), lidar.layers, lidar.azimuths))
