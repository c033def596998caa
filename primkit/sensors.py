"""Sensors: what a LiDAR can see, and two that stand in classrooms.

In:  the figures of a sensor, lengths in metres, angles in radians.
Out: a ``Lidar``: the simulator scans with it, and the readers of recordings place their beams by it.

>>> RPLIDAR_A1.beams, LDS_01.range_max
(360, 3.5)

Source: field names follow the LaserScan message of ROS; see each sensor for its figures.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from .arguments import ROUNDING, Floats, as_count, as_positive, as_share, check_type, doubt, limit, short
from .raycast.fan import TURN
from .rendered import FIELD, LEAST_BEAMS, rendered_bearings

MOST_BEAMS = 1_000_000
ALL_ROUND = (TURN, 0.0, False, False)  # the sweep of most sensors here
FARTHEST_HIT, TWICE_ROUND = 1000.0, 2 * TURN  # m and rad: no scanner reaches a kilometre, or goes round twice


@dataclass(frozen=True)
class Lidar:
    """A LiDAR that sweeps once: the paper's, unless told otherwise. Raises ValueError if an argument is out of range.

    Parameters
    ----------
    beams : int
        Evenly spread over the field of view; beam 0 looks along ``angle_min``, the others follow counter-clockwise.
    range_min, range_max : float
        Nearest and farthest distance that is measured, in metres. A nearer outline still blocks the beam.
    noise_std : float
        Standard deviation of the error of each range, in metres.
    period : float, seconds that one scan takes
    dropout, spurious : float
        Shares from 0 to 1: of the hits, that are lost; of all beams, that return a random range, whatever is there.
    model : {"exact", "webots"}
        ``"exact"``: each beam meets the outline where geometry says. ``"webots"``: as the simulator of the paper's
        authors renders it, wrong by 1.7 mm (root mean square) along an outline, see ``rendered``; its beams spread over
        6.28 rad, the first one looks back, and no range equals ``range_max``.
    fov : float
        Field of view in radians, the full turn by default. The next four are for ``"exact"`` alone, as it is.
    angle_min : float
        Bearing of the first beam from the robot's heading, in radians.
    clockwise : bool
        Whether the beams follow clockwise.
    both_ends : bool
        Whether the field of view ends on a beam, as it begins; else one step before. Of a full turn, the last beam then
        looks where the first one does.
    range_step : float
        What ranges are rounded to, in metres; 0: to nothing. The rounding comes last, and keeps the sensor's limits.

    Examples
    --------
    >>> Lidar().angles[:3].round(4).tolist()
    [0.0, 0.0628, 0.1257]
    >>> Lidar(beams=3, fov=np.pi, angle_min=-np.pi / 2, both_ends=True).angles.round(4).tolist()
    [-1.5708, 0.0, 1.5708]
    >>> Lidar(model="webots").angles[:3].round(4).tolist()
    [-3.1086, -3.0458, -2.983]
    """

    beams: int = 100
    range_min: float = 0.05
    range_max: float = 0.3
    noise_std: float = 0.0
    period: float = 0.1
    dropout: float = 0.0
    spurious: float = 0.0
    model: Literal["exact", "webots"] = "exact"
    fov: float = 2 * np.pi
    angle_min: float = 0.0
    clockwise: bool = False
    both_ends: bool = False
    range_step: float = 0.0

    def __post_init__(self) -> None:
        limit(as_count(self.beams, "beams"), MOST_BEAMS, "beams must be at most {}")
        for name in ("range_min", "noise_std", "range_max", "period", "range_step", "fov"):
            as_positive(getattr(self, name), name, zero=name in ("range_min", "noise_std", "range_step"))
        for name in ("dropout", "spurious"):
            as_share(getattr(self, name), name)
        if self.range_min >= self.range_max:
            raise ValueError(f"range_min must be below range_max, got {self.range_min:g} and {self.range_max:g}")
        for name, least in (("noise_std", self.range_max), ("range_max", FARTHEST_HIT)):
            if getattr(self, name) > least:
                doubt(f"{name} is {getattr(self, name):g} m: is it in millimetres?", depth=2)
        if self.model not in ("exact", "webots"):
            raise ValueError(f'model must be "exact" or "webots", got {short(self.model)}')
        for name in ("clockwise", "both_ends"):
            check_type(getattr(self, name), (bool, np.bool_), f"{name} must be True or False")
        first: Any = self.angle_min
        if isinstance(first, bool) or not (isinstance(first, (int, float)) and abs(first) <= TURN):
            raise ValueError(f"angle_min must be a bearing within a turn, in radians, got {short(first)}")
        if self.fov > TURN + ROUNDING:
            raise ValueError(f"fov must be at most a turn, 2 pi, got {self.fov:g}: is it in degrees?")
        if self.both_ends and self.beams < 2:
            raise ValueError("both_ends must have at least 2 beams, got 1")
        if self.model == "webots" and self.sweep != ALL_ROUND:
            raise ValueError(f'model "webots" has a sweep of its own, got {short(self.sweep)}')
        if self.model == "webots" and self.beams < LEAST_BEAMS:
            raise ValueError(f'model "webots" must have at least {LEAST_BEAMS} beams, got {self.beams}')

    def scaled(self, k: float) -> Lidar:
        """Return the sensor with lengths k times as large."""
        lengths = ("range_min", "range_max", "noise_std", "range_step")
        return replace(self, **{name: k * getattr(self, name) for name in lengths})

    @property
    def angle_increment(self) -> float:
        """Angle from one beam to the next, in radians; negative if they follow clockwise."""
        way = -1 if self.clockwise else 1
        return way * (self.fov if self.model == "exact" else FIELD) / (self.beams - self.both_ends)

    @property
    def angles(self) -> Floats:
        """Bearing of each beam from the robot's heading, shape (B,), radians, within a turn, in the order of time."""
        if self.model == "webots":
            return rendered_bearings(self.beams)
        return self.angle_min + np.arange(self.beams, dtype=float) * self.angle_increment

    @property
    def sweep(self) -> tuple[float, float, bool, bool]:
        """How the beams follow each other: field of view and first bearing [rad], clockwise, a beam at both ends."""
        return self.fov, self.angle_min, self.clockwise, self.both_ends


def as_lidar(lidar: Lidar | None, scale: float = 1.0, *, around: bool = False) -> Lidar:
    """Return the sensor, for None the paper's on a board of this scale; or refuse what is none, or not all ``around``.

    >>> as_lidar(Lidar(fov=np.pi), around=True)
    Traceback (most recent call last):
        ...
    ValueError: lidar must see all round here, counter-clockwise from the heading on, got another sweep
    """
    check_type(lidar, (Lidar, type(None)), "lidar must be a Lidar, such as Lidar()")
    lidar = Lidar().scaled(scale) if lidar is None else lidar
    if around and lidar.sweep != ALL_ROUND:
        raise ValueError("lidar must see all round here, counter-clockwise from the heading on, got another sweep")
    return lidar


# Each figure with its source; what no source was found for is marked so, and stands as in an ideal sensor.
RPLIDAR_A1 = Lidar(
    beams=360,  # Slamtec, data sheet of the A1M8 (2016): 360 samples at 5.5 turns a second, 1 degree
    range_min=0.15,  # the same: 0.15 - 12 m, white objects
    range_max=12.0,
    period=1 / 5.5,  # s, the same
    clockwise=True,  # as Slamtec's driver rplidar_ros tells, which turns the angles round
    range_step=0.00025,  # the same: distances come in quarters of a millimetre
    noise_std=0.0,  # NOT FOUND: the data sheet tells only a resolution, below 1 % of the distance
)
LDS_01 = Lidar(
    beams=360,  # Robotis, e-Manual of the TurtleBot3, LDS-01: 1 degree over 360
    range_min=0.12,  # the same: 120 - 3,500 mm
    range_max=3.5,
    period=0.2,  # s, the same: 300 turns a minute
    range_step=0.001,  # Robotis, hls_lfcd_lds_driver: whole millimetres; by default in counter-clockwise order
    noise_std=0.01,  # turtlebot3_description, seen in copies; the e-Manual: +-10 mm below 0.5 m, +-3.5 % beyond
)
