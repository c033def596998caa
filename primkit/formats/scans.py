"""Scans: what the LiDAR saw, as compressed NumPy arrays, each under the name of its field.

In:  ``Scans`` of P poses and B beams.
Out: an ``.npz`` file with the arrays ``poses`` (P, 3), ``angles`` (B,), ``ranges`` (P, B) and ``inside`` (P,):
     metres, radians, world frame; inf for no hit.

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
import warnings
import zipfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..lidar import Scans
from .files import StrPath, as_path, check_size, naming, read_whole, write_atomically

SCAN_ENDINGS = (".npz",)
# Two hours of driving, ten scans of 100 beams a second; holds for the archive and for what it unpacks to.
SCANS_LIMIT = 64 * 2**20
SCAN_SHAPES = {"poses": "(P, 3)", "angles": "(B,)", "ranges": "(P, B)", "inside": "(P,)"}


def save_scans(scans: Scans, path: StrPath) -> None:
    """Write scans as compressed NumPy arrays.

    Parameters
    ----------
    scans : Scans
        What the LiDAR saw, from way-points or along a drive.
    path : str or path
        The file, ending in ``.npz``; one that is there already is replaced.

    Raises
    ------
    ValueError
        If the ending is another one, the arrays do not fit together, or they are larger than ``load_scans``
        reads.
    OSError
        If the file cannot be written; the old one then stays as it was.

    Examples
    --------
    >>> import tempfile
    >>> from primkit.lidar import scan
    >>> from primkit.world import random_world
    >>> seen = scan(random_world(4, rng=7), [(0, 0, 0)])
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     save_scans(seen, f"{folder}/drive.npz")
    ...     bool((load_scans(f"{folder}/drive.npz").ranges == seen.ranges).all())
    True
    """
    path = as_path(path, SCAN_ENDINGS, "a file of scans")
    with naming(path.name):
        if not isinstance(scans, Scans):
            raise ValueError(f"must be Scans, got {type(scans).__name__}")
        checked = _as_scans({field: np.asarray(getattr(scans, field)) for field in SCAN_SHAPES})
        buffer = io.BytesIO()
        np.savez_compressed(buffer, **vars(checked))
        with zipfile.ZipFile(buffer) as archive:
            unpacked = sum(member.file_size for member in archive.infolist())
        data = buffer.getvalue()
        check_size(max(unpacked, len(data)), SCANS_LIMIT)
    write_atomically(path, data)


def load_scans(path: StrPath) -> Scans:
    """Read scans from compressed NumPy arrays.

    Parameters
    ----------
    path : str or path
        The file, ending in ``.npz``; arrays beside those of scans are passed over.

    Raises
    ------
    ValueError
        If the file is not such an archive, or the arrays do not fit together.
    OSError
        If there is no such file (``FileNotFoundError``), or it cannot be read.

    Examples
    --------
    A scan from no pose at all is a scan too:

    >>> import tempfile
    >>> from primkit.lidar import scan
    >>> from primkit.world import World
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     save_scans(scan(World(), []), f"{folder}/none.npz")
    ...     load_scans(f"{folder}/none.npz").ranges.shape
    (0, 100)
    """
    path = as_path(path, SCAN_ENDINGS, "a file of scans")
    data = read_whole(path, SCANS_LIMIT)
    with naming(path.name):
        return _as_scans(_unpacked(data))


def _unpacked(data: bytes) -> dict[str, NDArray[Any]]:
    """Return the arrays of scans in an .npz archive's bytes; nothing in it is ever run."""
    with _refusing_damage():
        archive = zipfile.ZipFile(io.BytesIO(data))
    with archive:
        for field in SCAN_SHAPES:
            if f"{field}.npy" not in archive.namelist():
                raise ValueError(f"must hold the arrays {', '.join(SCAN_SHAPES)}, got none called {field}")
        members = {field: archive.getinfo(f"{field}.npy") for field in SCAN_SHAPES}
        check_size(sum(member.file_size for member in members.values()), SCANS_LIMIT)  # small can unpack to huge
        with _refusing_damage():
            return {field: _array_of(archive.read(member)) for field, member in members.items()}


def _array_of(data: bytes) -> NDArray[Any]:
    """Return the array in an .npy file's bytes."""
    with warnings.catch_warnings(action="ignore"):  # of headers by old versions of NumPy, which are read all the same
        array: NDArray[Any] = np.lib.format.read_array(io.BytesIO(data), allow_pickle=False)
    return array


@contextmanager
def _refusing_damage() -> Iterator[None]:
    # A damaged archive fails in dozens of ways, from zlib to NumPy's headers: all mean that it cannot be read.
    try:
        yield
    except Exception:
        raise ValueError("must be an .npz archive of plain arrays, got one that cannot be read") from None


def _as_scans(arrays: Mapping[str, NDArray[Any]]) -> Scans:
    """Return scans of arrays that fit together, or say in one sentence what is wrong."""
    _check_types(arrays)
    _check_shapes(arrays)
    with np.errstate(over="ignore"):  # what is too large for a float becomes inf
        poses, angles, ranges = (arrays[field].astype(float) for field in ("poses", "angles", "ranges"))
    for field, values, right, rule in (
        ("poses", poses, np.isfinite(poses), "finite"),
        ("angles", angles, np.isfinite(angles), "finite"),
        ("ranges", ranges, ranges >= 0, ">= 0, or inf for no hit"),
    ):
        if not right.all():
            raise ValueError(f"{field} must be {rule}, got {values[~right][0]:g}")
    return Scans(poses, angles, ranges, arrays["inside"])


def _check_types(arrays: Mapping[str, NDArray[Any]]) -> None:
    for field, array in arrays.items():
        kinds, rule = ("b", "true and false") if field == "inside" else ("fiu", "numbers")
        if array.dtype.kind not in kinds:
            raise ValueError(f"{field} must hold {rule}, got the type {array.dtype}")


def _check_shapes(arrays: Mapping[str, NDArray[Any]]) -> None:
    shapes = [arrays[field].shape for field in SCAN_SHAPES]
    ranges = arrays["ranges"].shape  # (P, B): the others follow from it
    if len(ranges) != 2 or shapes != [(ranges[0], 3), ranges[1:], ranges, ranges[:1]]:
        rule = ", ".join(f"{field} {shape}" for field, shape in SCAN_SHAPES.items())
        raise ValueError(f"shapes must be {rule}, got {', '.join(map(str, shapes))}")
