"""LiDAR: what the robot sees from where it stands.

Fourth step of the story. A hundred beams leave the robot at even bearings; each returns the distance to the
first outline it meets, or infinity.

In:  a ``World`` and poses, shape (P, 3): x [m], y [m], heading [rad], world frame.
Out: ``Scans``: ``.ranges``, shape (P, B), metres; ``.points()``, the hits, shape (N, 2), metres, world frame.

>>> from primkit.shapes import Circle
>>> from primkit.world import World
>>> seen = scan(World([Circle((0.2, 0.0), 0.05)]), [(0.0, 0.0, 0.0)])
>>> seen.ranges.shape, round(float(seen.ranges[0, 0]), 3), len(seen.points())
((1, 100), 0.15, 9)

Source: the sensor is that of the paper's section 3.1; field names follow the LaserScan message of ROS.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from .arguments import (
    FARTHEST,
    ROUNDING,
    Bools,
    Floats,
    as_count,
    as_floats,
    as_poses,
    check_type,
    doubt,
)
from .faults import Faults
from .raycast import cast
from .raycast.fan import TURN
from .rendered import render
from .sensors import ALL_ROUND, FARTHEST_HIT, TWICE_ROUND
from .sensors import Lidar as Lidar
from .sensors import as_lidar as as_lidar
from .show import thumbnail
from .table import count
from .world import World

SCANS_AT_ONCE = 10_000  # scans that are worked on at a time: 8 MB of ranges
SCAN_SHAPES = {"poses": "(P, 3)", "angles": "(B,)", "ranges": "(P, B)", "inside": "(P,)"}
DEGREES = 5.0  # no robot turns by 90 radians to the digit


@dataclass(frozen=True, eq=False)
class Scans:
    """What the LiDAR saw from each pose.

    Raises ValueError if an array is none of these, a pose or an angle is not finite, or a range is NaN or below zero.
    Warns (``LikelyWrong``) if headings or angles look like degrees, or ranges like millimetres.

    Parameters
    ----------
    poses : array, shape (P, 3): x [m], y [m], heading [rad], world frame
    angles : array, shape (B,): bearing of each beam from the heading, radians
    ranges : array, shape (P, B)
        Measured distances in metres; ``inf`` or 0 where a beam met nothing. ``as_ranges`` makes them of what a
        sensor's driver writes.
    inside : array of bool, shape (P,)
        Poses that lie in a shape: they see nothing, but for a rendered LiDAR, which sees the others.

    Examples
    --------
    >>> scans = scan(World(), [(0.0, 0.0, 0.0)])
    >>> len(scans), scans.points().shape
    (1, (0, 2))
    """

    poses: Floats
    angles: Floats
    ranges: Floats
    inside: Bools

    def __post_init__(self) -> None:
        arrays = {field: _as_array(field, getattr(self, field)) for field in SCAN_SHAPES}
        poses, angles, ranges, _ = arrays.values()
        shapes = [array.shape for array in arrays.values()]
        if ranges.ndim != 2 or shapes != [(len(ranges), 3), ranges.shape[1:], ranges.shape, ranges.shape[:1]]:
            rule = ", ".join(f"{field} {shape}" for field, shape in SCAN_SHAPES.items())
            raise ValueError(f"shapes must be {rule}, got {', '.join(map(str, shapes))}")
        for field, values, right, rule in (
            ("poses", poses, np.abs(poses) <= FARTHEST, "finite"),
            ("angles", angles, np.abs(angles) <= FARTHEST, "finite"),
            ("ranges", ranges, ranges >= 0, ">= 0, or inf for no hit"),
        ):
            if not right.all():
                raise ValueError(f"{field} must be {rule}, got {values[~right][0]:g}")
        vars(self).update(arrays)
        _doubt_headings(poses, depth=3)
        if (largest := np.abs(angles).max(initial=0.0)) > TWICE_ROUND:
            doubt(f"angles reach {largest:g} rad: are they in degrees?", depth=2)
        if (largest := ranges.max(initial=0.0, where=self.hits)) > FARTHEST_HIT:
            doubt(f"ranges reach {largest:g} m: are they in millimetres?", depth=2)

    @property
    def hits(self) -> Bools:
        """Which beams met something, shape (P, B): those that read more than 0, and not infinity."""
        return np.logical_and(self.ranges > 0, self.ranges < np.inf)

    def points(self) -> Floats:
        """Return where the beams hit, shape (N, 2), metres, world frame; pose by pose, beam by beam."""
        pose, beam = np.nonzero(self.hits)
        bearing, reach = self.poses[pose, 2] + self.angles[beam], self.ranges[pose, beam]
        return self.poses[pose, :2] + reach[:, None] * np.column_stack([np.cos(bearing), np.sin(bearing)])

    def scaled(self, k: float) -> Scans:
        """Return the scans of a board k times as large, from places k times as far from its centre."""
        return _checked_before(self.poses * (k, k, 1.0), self.angles, self.ranges * k, self.inside)

    def __len__(self) -> int:
        return len(self.poses)

    def __repr__(self) -> str:
        seen = f"{count(len(self), 'scan')} of {count(len(self.angles), 'beam')}"
        return f"Scans: {seen}, {count(int(self.hits.sum()), 'hit')}"

    def _repr_html_(self) -> str:
        return thumbnail(repr(self), dots=self.points(), places=self.poses[:, :2])

    def __getitem__(self, which: slice | Sequence[int] | NDArray[np.integer]) -> Scans:
        """Return some of the scans: ``scans[5:6]`` is the sixth alone."""
        if isinstance(which, (int, np.integer)):
            which = [int(which)]
        return _checked_before(self.poses[which], self.angles, self.ranges[which], self.inside[which])


def as_ranges(ranges: ArrayLike, range_max: float = np.inf, range_min: float = 0.0) -> Floats:
    """Return what a sensor's driver writes as ranges, of the same shape: ``inf`` for all that is no hit.

    The rules, for every reader:

    ==============================  ======  ===================================================
    reading                         is      because
    ==============================  ======  ===================================================
    0, below 0, NaN, inf, -inf      no hit  so drivers tell that nothing, or no good, came back
    below ``range_min``             no hit  LaserScan: to be discarded
    ``range_min`` itself            a hit   the limit is included
    ``range_max`` itself, and more  no hit  so drivers tell that nothing came back
    ==============================  ======  ===================================================

    >>> as_ranges([0.2, 0.0, float("nan"), -1.0, 81.83, 81.82, 0.1], range_max=81.83, range_min=0.2).tolist()
    [0.2, inf, inf, inf, inf, 81.82, inf]
    """
    values = _as_array("ranges", ranges)
    return np.where((values > 0) & (values >= range_min) & (values < range_max), values, np.inf)


def check_scan_type(field: str, dtype: DTypeLike) -> None:
    """Refuse a type that does not hold what a field of scans holds."""
    kinds, rule = ("b", "true and false") if field == "inside" else ("fiu", "numbers")
    if np.dtype(dtype).kind not in kinds:
        raise ValueError(f"{field} must hold {rule}, got the type {dtype}")


def _as_array(field: str, values: ArrayLike) -> NDArray[Any]:
    """Return the values of a field of scans as an array of its own type."""
    if field == "inside":
        check_scan_type(field, np.asarray(values).dtype)
        return np.array(values, dtype=bool)
    with np.errstate(over="ignore"):  # what is too large for a float becomes inf
        return as_floats(values, field, SCAN_SHAPES[field])


def _doubt_headings(poses: Floats, depth: int) -> None:
    """Tell of headings that look like degrees: large, and whole multiples of five."""
    large = poses[:, 2][np.abs(poses[:, 2]) > TWICE_ROUND / 2]
    if large.size and (large % DEGREES == 0).any():
        doubt(f"a heading is {large[large % DEGREES == 0][0]:g} rad: is it in degrees?", depth)


def _checked_before(poses: Floats, angles: Floats, ranges: Floats, inside: Bools) -> Scans:
    """Return scans of arrays that fit together: checking them takes as long as a scan of one pose."""
    scans = object.__new__(Scans)
    vars(scans).update(poses=poses, angles=angles, ranges=ranges, inside=inside)
    return scans


def scan(
    world: World, poses: ArrayLike, lidar: Lidar | None = None, *, rng: int | np.random.Generator | None = None
) -> Scans:
    """Scan the world once from each pose. Raises ValueError if the poses are not finite or not of shape (P, 3).

    A beam without a hit in range reads ``inf``. Noise is added first and the reading is then clipped to the sensor's
    limits. A pose inside a shape sees nothing, and ``Scans.inside`` says so.

    Parameters
    ----------
    world : World
    poses : array_like, shape (P, 3)
        x [m], y [m], heading [rad], world frame; one pose alone may have shape (3,).
    lidar : Lidar, optional
        The paper's, of the board's scale, when not given.
    rng : seed or numpy.random.Generator, optional
        For noise, dropouts and spurious returns.

    Examples
    --------
    A shape nearer than ``range_min`` hides what is behind it:

    >>> from primkit.shapes import Circle
    >>> near, far = Circle((0.05, 0.0), 0.03), Circle((0.2, 0.0), 0.03)
    >>> float(scan(World([near, far]), [(0, 0, 0)]).ranges[0, 0])
    inf
    """
    check_type(world, World, "world must be a World, as in scan(world, poses)")
    poses = as_poses(poses)
    _doubt_headings(poses, depth=2)
    return next(_scanned(world, poses, lidar, rng, max(1, len(poses))))


def scan_blocks(
    world: World,
    poses: ArrayLike,
    lidar: Lidar | None = None,
    *,
    size: int = SCANS_AT_ONCE,
    rng: int | np.random.Generator | None = None,
) -> Iterator[Scans]:
    """Scan the world once from each pose, and hand out the scans in blocks of ``size``; the last one may have fewer.

    For more scans than memory holds: the ranges of a million take 800 MB, a block of ten thousand 8 MB. Each block is
    computed when it is asked for; together they are what ``scan`` returns for the other arguments, to the last bit,
    noise included. There is at least one, empty when there are no poses. Raises ValueError as ``scan``, or if the size
    is not a whole number of at least 1; at once, not at the first block.

    >>> [len(scans) for scans in scan_blocks(World(), np.zeros((5, 3)), size=2)]
    [2, 2, 1]
    """
    check_type(world, World, "world must be a World, as in scan_blocks(world, poses)")
    return _scanned(world, as_poses(poses), lidar, rng, as_count(size, "size"))


def _scanned(
    world: World, poses: Floats, lidar: Lidar | None, rng: int | np.random.Generator | None, size: int
) -> Iterator[Scans]:
    """Check the other arguments and return the blocks."""
    lidar = as_lidar(lidar, world.scale)
    faults = Faults(lidar, len(poses), min(size, SCANS_AT_ONCE), rng)
    starts = range(0, max(1, len(poses)), size)
    return (_block(world, poses[start : start + size], lidar, faults) for start in starts)


def _block(world: World, poses: Floats, lidar: Lidar, faults: Faults) -> Scans:
    angles, plain = lidar.angles, lidar.sweep == ALL_ROUND
    look: Callable[..., tuple[Floats, Bools]] = render if lidar.model == "webots" else cast if plain else _cast_in_turn
    ranges, inside = look(world, poses, angles, lidar.range_max, lidar.range_min)
    for start in range(0, len(poses), SCANS_AT_ONCE):
        faults.disturb(ranges[start : start + SCANS_AT_ONCE])
    if lidar.model == "exact":
        ranges[inside] = np.inf
    return _checked_before(poses, angles, ranges, inside)


def _cast_in_turn(world: World, poses: Floats, angles: Floats, *limits: float) -> tuple[Floats, Bools]:
    """Cast beams in the order of a sweep: the caster wants them counter-clockwise, and each bearing once."""
    way = slice(None, None, -1 if angles[-1] < angles[0] else 1)
    closed = abs(angles[-1] - angles[0]) > TURN - ROUNDING
    ranges, inside = cast(world, poses, angles[: len(angles) - closed][way].copy(), *limits)
    ranges = ranges[:, way]
    return np.column_stack([ranges, ranges[:, :1]]) if closed else ranges.copy(), inside
