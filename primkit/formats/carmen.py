"""Carmen: logs of the CARMEN toolkit, in which the classic recordings of the field lie.

In:  a ``.log`` or ``.log.gz`` file: one message a line; FLASER and ROBOTLASER1 are scans with their poses.
Out: sweeps.

    FLASER n r1 ... rn x y heading ...      half a turn from -90 degrees on; the last beam at 90 if n is odd
    ROBOTLASER1 type start fov step max accuracy mode n r1 ... rn m i1 ... im x y heading ...

Ranges are in metres, angles in radians; the pose is the laser's, as corrected by whoever wrote the log. A last line
without its end is passed over: it may be half of one.

Source: the log file format of CARMEN's logger, and its source for what follows the n ranges.
"""

from __future__ import annotations

import gzip
import io
from pathlib import Path

import numpy as np

from ..arguments import Floats, limit, short
from ..lidar import Lidar
from .files import bounded_read, lines_of, naming
from .recordings import RECORDING_LIMIT, Sweep, check_topics, the_one

SICK_MAX = 81.83  # m: from here on, the scanners of these logs tell errors in the place of distances
LASERS = ("FLASER", "ROBOTLASER1")


def read_carmen(path: Path, topics: tuple[str, ...], lidar: Lidar | None) -> list[Sweep]:
    """Return the sweeps of the one laser in a log, or of the one that is told; a ``lidar`` knows FLASER's angles."""
    data = bounded_read(path, RECORDING_LIMIT)
    with naming(path.name):
        if path.suffix.lower() == ".gz":
            data = _unzipped(data)
        lines = [(number, line.split()) for number, line in enumerate(lines_of(data), start=1)]
        found = {words[0].decode("ascii", "replace") for _, words in lines if words}
        check_topics(topics, found & set(LASERS))
        laser = the_one(found & set(LASERS), topics, "laser")
        sweeps = []
        for number, words in lines:
            if words and words[0].decode("ascii", "replace") == laser:
                with naming(f"line {number}"):
                    sweeps.append(_sweep(words, lidar, at=1 if laser == "FLASER" else 8))
        return sweeps


def _unzipped(data: bytes) -> bytes:
    try:
        with gzip.GzipFile(fileobj=io.BytesIO(data)) as stream:
            data = stream.read(RECORDING_LIMIT + 1)
    except Exception:  # zlib's, gzip's and the system's
        raise ValueError("must be a log packed by gzip, got one that cannot be unpacked") from None
    limit(len(data), RECORDING_LIMIT, "must unpack to at most {} bytes")
    return data


def _sweep(words: list[bytes], lidar: Lidar | None, at: int) -> Sweep:
    """Return the sweep in a line whose number n of ranges is the word ``at``."""
    n = _count(words, at)
    if n == 0:
        raise ValueError("must have at least one range, got none")
    ranges, behind = _numbers(words[at + 1 : at + 1 + n], n), at + 1 + n
    if at > 1:  # ROBOTLASER1
        start, _, step, range_max = _numbers(words[2:6], 4)
        angles, behind = start + step * np.arange(n), behind + 1 + _count(words, behind)
    else:
        lidar = lidar or Lidar(n, 0.0, SICK_MAX, fov=np.pi, angle_min=-np.pi / 2, both_ends=n % 2 == 1 and n > 1)
        if lidar.beams != n:
            raise ValueError(f"must have the lidar's {lidar.beams} ranges, got {n}")
        angles, range_max = lidar.angles, lidar.range_max
    x, y, heading = _numbers(words[behind : behind + 3], 3).tolist()
    return Sweep((x, y, heading), angles, ranges, 0.0, range_max)


def _count(words: list[bytes], at: int) -> int:
    word = words[at] if at < len(words) else None
    if word is None or not word.isdigit() or len(word) > 7:
        raise ValueError(f"must tell how many numbers follow, got {short(word)}")
    return int(word)


def _numbers(words: list[bytes], n: int) -> Floats:
    try:
        numbers = np.array([float(word) for word in words])
    except ValueError:
        raise ValueError(f"must hold {n} numbers, got {short(b' '.join(words[:4]))}") from None
    if len(numbers) != n:
        raise ValueError(f"must hold {n} numbers, got {len(numbers)}")
    return numbers
