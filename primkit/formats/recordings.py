"""Recordings: what a sensor's driver wrote down, sweep by sweep, brought to ``Scans`` by one table of rules.

In:  ``Sweep``s, as ``carmen``, ``bags`` and ``bearings_csv`` read them; what the user knows better than the file.
Out: ``Scans``: whatever is no hit by the rules of ``lidar.as_ranges`` reads ``inf``.

>>> sweep = Sweep((0.0, 0.0, 0.0), np.array([0.0, 0.1]), np.array([0.5, 8.0]), 0.1, 8.0)
>>> as_scans([sweep]).ranges.tolist()
[[0.5, inf]]
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from ..arguments import Floats, limit, short
from ..lidar import Lidar, Scans, as_ranges

RECORDING_LIMIT = 256 * 2**20  # bytes: of a file, of what it unpacks to, and of the ranges in it


@dataclass(frozen=True)
class Sweep:
    """One sweep: its pose x, y [m], heading [rad]; angles [rad] and ranges [m], shape (B,); limits of these, metres."""

    pose: tuple[float, float, float]
    angles: Floats
    ranges: Floats
    range_min: float = 0.0
    range_max: float = np.inf


def as_scans(sweeps: Sequence[Sweep], lidar: Lidar | None = None) -> Scans:
    """Return sweeps as scans; a lidar that is told knows the limits of ranges better than the file.

    Some drivers turn unevenly, and no two sweeps have the same angles. Scans have one row of angles: that of all
    different sweeps, one behind the other, and a sweep is silent where another one's angles stand.
    """
    if not sweeps:
        raise ValueError("must hold at least one scan, got none")
    fans: dict[bytes, Floats] = {sweep.angles.tobytes(): sweep.angles for sweep in sweeps}
    begins = dict(zip(fans, np.cumsum([0, *map(len, fans.values())]).tolist(), strict=False))
    angles = np.concatenate([*fans.values()])
    limit(8 * len(angles) * len(sweeps), RECORDING_LIMIT, "must unpack to at most {} bytes")
    ranges = np.full((len(sweeps), len(angles)), np.inf)
    for row, sweep in zip(ranges, sweeps, strict=True):
        low, high = (sweep.range_min, sweep.range_max) if lidar is None else (lidar.range_min, lidar.range_max)
        begin = begins[sweep.angles.tobytes()]
        row[begin : begin + len(sweep.angles)] = as_ranges(sweep.ranges, high, low)
    poses = np.array([sweep.pose for sweep in sweeps], dtype=float)
    return Scans(poses, angles, ranges, np.zeros(len(sweeps), dtype=bool))


def check_topics(told: Iterable[str], known: Iterable[str]) -> None:
    """Refuse a topic that the file does not hold: another one would be read in its place."""
    if strange := sorted(set(told) - set(known)):
        got = short(", ".join(sorted(known)) or "none").strip("'")
        raise ValueError(f"must hold the topic {short(strange[0])}, got {got}")


def the_one(names: Iterable[str], told: Sequence[str], what: str) -> str | None:
    """Return which of several sources to read: the only one, or the one that is told; None where there is none.

    >>> the_one(["/scan"], [], "topic of laser scans"), the_one(["/front", "/rear"], ["/rear"], "")
    ('/scan', '/rear')
    >>> the_one(["/front", "/rear"], [], "topic of laser scans")
    Traceback (most recent call last):
        ...
    ValueError: must be read by one topic of laser scans at a time, got /front, /rear: tell which one as topic
    """
    names = sorted(set(names))
    chosen = [name for name in names if name in told] or names
    if len(chosen) > 1:
        got = short(", ".join(chosen)).strip("'")
        raise ValueError(f"must be read by one {what} at a time, got {got}: tell which one as topic")
    return chosen[0] if chosen else None
