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
                    sweeps.append(_flaser(words, lidar) if laser == "FLASER" else _robotlaser(words))
        return sweeps


def _unzipped(data: bytes) -> bytes:
    try:
        with gzip.GzipFile(fileobj=io.BytesIO(data)) as stream:
            data = stream.read(RECORDING_LIMIT + 1)
    except Exception:  # zlib's, gzip's and the system's
        raise ValueError("must be a log packed by gzip, got one that cannot be unpacked") from None
    limit(len(data), RECORDING_LIMIT, "must unpack to at most {} bytes")
    return data


def _flaser(words: list[bytes], lidar: Lidar | None) -> Sweep:
    ranges, rest = _counted(words, 1)
    n = len(ranges)
    if lidar is None:
        lidar = Lidar(n, range_max=SICK_MAX, fov=np.pi, angle_min=-np.pi / 2, both_ends=n % 2 == 1 and n > 1)
    if lidar.beams != n:
        raise ValueError(f"must have the lidar's {lidar.beams} ranges, got {n}")
    return Sweep(_pose(rest), lidar.angles, ranges, 0.0, lidar.range_max)


def _robotlaser(words: list[bytes]) -> Sweep:
    start, _, step, range_max = _numbers(words[2:6], 4)
    ranges, rest = _counted(words, 8)
    intensities = _count(rest)
    return Sweep(_pose(rest[1 + intensities :]), start + step * np.arange(len(ranges)), ranges, 0.0, range_max)


def _counted(words: list[bytes], place: int) -> tuple[Floats, list[bytes]]:
    """Return the n numbers behind the word that tells n, and the words behind them."""
    n = _count(words[place:])
    if n == 0:
        raise ValueError("must have at least one range, got none")
    return _numbers(words[place + 1 : place + 1 + n], n), words[place + 1 + n :]


def _count(words: list[bytes]) -> int:
    if not words or not words[0].isdigit() or len(words[0]) > 7:
        raise ValueError(f"must tell how many numbers follow, got {short(words[0] if words else None)}")
    return int(words[0])


def _pose(words: list[bytes]) -> tuple[float, float, float]:
    x, y, heading = _numbers(words[:3], 3).tolist()
    return x, y, heading


def _numbers(words: list[bytes], n: int) -> Floats:
    try:
        numbers = np.array([float(word) for word in words])
    except ValueError:
        raise ValueError(f"must hold {n} numbers, got {short(b' '.join(words[:4]))}") from None
    if len(numbers) != n:
        raise ValueError(f"must hold {n} numbers, got {len(numbers)}")
    return numbers
