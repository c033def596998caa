"""Scans: what the LiDAR saw, as compressed NumPy arrays, each under the name of its field; and recordings of robots.

In:  ``Scans`` of P poses and B beams; or a file that another program wrote.
Out: an ``.npz`` file with the arrays ``poses`` (P, 3), ``angles`` (B,), ``ranges`` (P, B) and ``inside`` (P,):
     metres, radians, world frame; inf for no hit. Or ``Scans``.

>>> import tempfile
>>> from primkit.lidar import scan
>>> from primkit.world import World
>>> with tempfile.TemporaryDirectory() as folder:
...     save_scans(scan(World(), [(0, 0, 0)]), f"{folder}/drive.npz")
...     load_scans(f"{folder}/drive.npz").ranges.shape
(1, 100)

A file by a stranger is only ever data: nothing in it is run, and it cannot unpack to more than the limit.
"""

from __future__ import annotations

import io
import math
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arguments import check_type, limit
from ..lidar import SCAN_SHAPES, Lidar, Scans, as_lidar, check_scan_type
from .bags import read_bag
from .bearings_csv import read_bearings
from .carmen import read_carmen
from .files import StrPath, as_path, bounded_read, naming, open_archive, unpacked, write_atomically
from .recordings import as_scans

SCAN_ENDINGS, READ_ENDINGS = (".npz",), (".npz", ".log", ".log.gz", ".bag", ".db3", ".mcap", ".csv")
# Two hours of driving, ten scans of 100 beams a second; holds for the archive, and for the floats that it becomes.
SCANS_LIMIT = 64 * 2**20
HEADS = 4096  # bytes beside the numbers, that say what they are


def save_scans(scans: Scans, path: StrPath) -> None:
    """Write scans as compressed NumPy arrays, to a file ending in ``.npz``.

    A file that is there already is replaced. Raises ValueError for another ending, or scans larger than ``load_scans``
    reads; OSError if the file cannot be written: the old one then stays as it was.
    """
    path = as_path(path, SCAN_ENDINGS, "a file of scans")
    with naming(path.name):
        check_type(scans, Scans, "must be Scans")
        arrays = {field: getattr(scans, field) for field in SCAN_SHAPES}
        _check_room(arrays)
        buffer = io.BytesIO()
        np.savez_compressed(buffer, **arrays)
        limit(buffer.tell(), SCANS_LIMIT, "must be at most {} bytes")
    write_atomically(path, buffer.getvalue())


def load_scans(
    path: StrPath,
    *,
    topic: str | Sequence[str] = (),
    units: Sequence[str] = (),
    lidar: Lidar | None = None,
) -> Scans:
    r"""Read scans: our own, or what a robot recorded.

    ==============================  =======================================================================
    ending                          what is read
    ==============================  =======================================================================
    ``.npz``                        what ``save_scans`` wrote; other arrays in it are passed over
    ``.log``, ``.log.gz``           a log of CARMEN: FLASER or ROBOTLASER1, with their poses
    ``.bag``, ``.db3``, ``.mcap``   a bag of ROS 1 or 2: LaserScan, posed by Odometry and fixed transforms; a
                                    folder with such files is one, too. Needs rosbags
    ``.csv``                        a table of angles and distances: one scan from (0, 0, 0)
    ==============================  =======================================================================

    All but our own go through one table of rules, see ``as_ranges``: what is no good reading is no hit. Without poses,
    each scan is taken from (0, 0, 0).

    Parameters
    ----------
    path : str or path
    topic : str, or sequence of str
        Which topics of a bag to read, or which message of a log, where there are several lasers or odometries.
    units : sequence of str
        Of a table whose header tells none: ``"deg"`` or ``"rad"``, and ``"mm"``, ``"cm"`` or ``"m"``.
    lidar : Lidar, optional
        The sensor, where it is known better than the file tells it: its limits; in a log, the angles of FLASER; in a
        table, whether these grow clockwise.

    Raises
    ------
    ValueError
        If the file is not what its ending says, or its parts do not fit together, or it holds no scan.
    OSError
        If there is no such file (``FileNotFoundError``), or it cannot be read.

    Warns (``LikelyWrong``) of scans that are left out because no odometry is near in time.

    Examples
    --------
    An RPLIDAR's table: angles clockwise, 0 for no hit.

    >>> import pathlib, tempfile
    >>> from primkit.sensors import RPLIDAR_A1
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder, "scan.csv")
    ...     _ = path.write_text("angle_deg,distance_mm,quality\n0,1000,15\n90,2000,15\n180,0,0\n")
    ...     load_scans(path, lidar=RPLIDAR_A1).points().round(3).tolist()
    [[1.0, 0.0], [0.0, -2.0]]

    A scan from no pose at all is a scan too:

    >>> import tempfile
    >>> from primkit.lidar import scan
    >>> from primkit.world import World
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     save_scans(scan(World(), []), f"{folder}/none.npz")
    ...     load_scans(f"{folder}/none.npz").ranges.shape
    (0, 100)
    """
    path = as_path(path, READ_ENDINGS, "a file of scans", folder=True)
    topics = (topic,) if isinstance(topic, str) else tuple(topic)
    lidar = None if lidar is None else as_lidar(lidar)
    match path.suffix.lower():
        case ".npz":
            data = bounded_read(path, SCANS_LIMIT)
            with naming(path.name):
                return Scans(**_arrays_in(data))
        case ".csv":
            sweeps = read_bearings(path, units, lidar)
        case ".log" | ".gz":
            sweeps = read_carmen(path, topics, lidar)
        case _:
            sweeps = read_bag(path, topics)
    with naming(path.name):
        return as_scans(sweeps, lidar)


def _check_room(arrays: dict[str, NDArray[Any]]) -> None:
    limit(sum(8 * array.size for array in arrays.values()), SCANS_LIMIT, "must unpack to at most {} bytes")


def _arrays_in(data: bytes) -> dict[str, NDArray[Any]]:
    """Return the arrays of scans in an .npz archive's bytes; nothing in it is ever run."""
    arrays: dict[str, NDArray[Any]] = {}
    with _refusing_damage():
        archive = open_archive(data)
    for field in SCAN_SHAPES:
        if f"{field}.npy" not in archive.namelist():
            raise ValueError(f"must hold the arrays {', '.join(SCAN_SHAPES)}, got none called {field}")
    told = sum(archive.getinfo(f"{field}.npy").file_size for field in SCAN_SHAPES)
    limit(told, SCANS_LIMIT + HEADS, "must unpack to at most {} bytes")
    for field in SCAN_SHAPES:
        with _refusing_damage():
            arrays[field] = _array_of(unpacked(archive, f"{field}.npy", SCANS_LIMIT + HEADS))
        check_scan_type(field, arrays[field].dtype)
        _check_room(arrays)  # what takes a byte here takes eight as a float
    return arrays


def _array_of(data: bytes) -> NDArray[Any]:
    """Return the array in an .npy file's bytes, without a copy: what its head says makes no room by itself."""
    member = io.BytesIO(data)
    version = np.lib.format.read_magic(member)
    head = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
    with warnings.catch_warnings(action="ignore"):  # of heads by old versions of NumPy, which are read all the same
        shape, by_columns, dtype = head(member)
    values = np.frombuffer(data, dtype, offset=member.tell())[: max(0, math.prod(shape))]
    return values.reshape(shape, order="F" if by_columns else "C")


@contextmanager
def _refusing_damage() -> Iterator[None]:
    # A damaged archive fails in dozens of ways, from zlib to NumPy's headers: all mean that it cannot be read.
    try:
        yield
    except Exception:
        raise ValueError("must be an .npz archive of plain arrays, got one that cannot be read") from None
