"""Drives: what was driven and what was seen on the way, written down scan by scan.

In:  one scan after the other, each with the speeds that the wheels had before it.
Out: a ``Drive``, to the last bit; from a journal that was cut off, all scans but at most the last.

>>> import tempfile
>>> from primkit.lidar import scan
>>> from primkit.world import random_world
>>> world = random_world(2, rng=3)
>>> with tempfile.TemporaryDirectory() as folder:
...     with record_drive(f"{folder}/drive.jsonl") as journal:
...         journal.add(scan(world, [(0, 0, 0)]), (0, 0))
...         journal.add(scan(world, [(0.0123, 0, 0)]), (6, 6))
...     drive = load_drive(f"{folder}/drive.jsonl")
>>> len(drive), drive.wheels.tolist()
(2, [[0.0, 0.0], [6.0, 6.0]])

The first line of the file says what it is and which sensor saw it; each further line is one scan, handed to the system
at once. No hit is ``null``.

Source: the form is JSON Lines, jsonlines.org.
"""

from __future__ import annotations

import json
from contextlib import suppress
from dataclasses import asdict, dataclass, fields
from math import isfinite
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..arguments import Floats, as_point, as_points, check_type, limit, short
from ..lidar import Lidar, Scans, as_lidar
from ..show import thumbnail
from .files import LINE_LIMIT, StrPath, append_whole, as_path, bounded_read, lines_of, naming, opened, write_atomically
from .values import check_format, numbers_in, parsed

DRIVE_ENDINGS = (".jsonl",)
DRIVE_LIMIT = 64 * 2**20  # bytes: most of an hour with ten scans of 100 beams a second if all of them hit something
DRIVE_FORMAT, DRIVE_VERSION = "primkit drive", 1
# What older drives do not tell of their sensor: its model, and the rest, which is told only where it is another.
LATER = {field.name: field.default for field in fields(Lidar)[7:]}


@dataclass(frozen=True, eq=False)
class Drive:
    """What was driven and what was seen on the way. Raises ValueError if these do not fit together.

    Parameters
    ----------
    scans : Scans
        P scans, in their order, a period apart; ``scans.poses`` is where each was made.
    wheels : array_like, shape (P, 2)
        Speeds of the left and the right wheel that were held before each scan, radians per second; those before the
        first brought the robot to where the drive begins.
    lidar : Lidar, default Lidar()

    Examples
    --------
    >>> from primkit.lidar import scan
    >>> from primkit.world import World
    >>> Drive(scan(World(), [(0, 0, 0)]), [])
    Traceback (most recent call last):
        ...
    ValueError: wheels must hold two speeds for each of the 1 scans, got 0
    """

    scans: Scans
    wheels: Floats
    lidar: Lidar = Lidar()  # noqa: RUF009 - frozen, so that sharing it is safe

    def __post_init__(self) -> None:
        _check_scans(self.scans, as_lidar(self.lidar))
        wheels = as_points(self.wheels, "wheels")
        if len(wheels) != len(self.scans):
            raise ValueError(f"wheels must hold two speeds for each of the {len(self.scans)} scans, got {len(wheels)}")
        object.__setattr__(self, "wheels", wheels)

    @property
    def poses(self) -> Floats:
        """Where each scan was made, shape (P, 3): x [m], y [m], heading [rad], world frame."""
        return self.scans.poses

    @property
    def period(self) -> float:
        """Time from one scan to the next, seconds."""
        return self.lidar.period

    def __len__(self) -> int:
        return len(self.scans)

    def __repr__(self) -> str:
        return f"Drive: {len(self) * self.period:.1f} s, {str(self.scans).removeprefix('Scans: ')}"

    def _repr_html_(self) -> str:
        return thumbnail(repr(self), dots=self.scans.points(), way=self.poses[:, :2])


class DriveJournal:
    """A file that a drive is written to, scan by scan; ``record_drive`` opens it."""

    def __init__(self, path: StrPath, lidar: Lidar, *, replace: bool = False) -> None:
        self.path, self.lidar = as_path(path, DRIVE_ENDINGS, "a drive"), lidar
        head = _head(lidar)
        try:
            self._file = opened(self.path, "wb" if replace else "xb")
        except FileExistsError:
            rule = "is there already; load it, or record with replace=True"
            raise FileExistsError(f"{self.path.name}: {rule}") from None
        self._size = 0
        self._write(head)

    def add(self, scans: Scans, wheels: ArrayLike) -> None:
        """Write one scan down, with the wheel speeds held before it, shape (2,), rad/s, and hand it to the system.

        Raises ValueError if it is not one scan of the journal's sensor, the journal is closed, or there is no room
        left; OSError if it cannot be written. The journal then stays as it was.
        """
        with naming(self.path.name):
            if self._file.closed:
                raise ValueError("must be open to add a scan, got a journal that was closed")
            _check_scans(scans, self.lidar)
            if len(scans) != 1:
                raise ValueError(f"must be given one scan at a time, got {len(scans)}")
            self._write(_line(scans, 0, as_point(wheels, "wheels")))

    def close(self) -> None:
        """Close the file; what was written stays."""
        self._file.close()

    def _write(self, line: bytes) -> None:
        limit(self._size + len(line), DRIVE_LIMIT, "must be at most {} bytes")
        append_whole(self._file, line, self.path)
        self._size += len(line)

    def __enter__(self) -> DriveJournal:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()


def record_drive(path: StrPath, lidar: Lidar | None = None, *, replace: bool = False) -> DriveJournal:
    """Begin to write a drive down, scan by scan, in a file ending in ``.jsonl``.

    The journal's ``add(scans, wheels)`` writes one scan; use it in a ``with`` statement, or ``close()`` it. A file that
    is there already is refused (``FileExistsError``), for it may hold the only record of a drive that broke off; with
    ``replace=True`` it begins anew. Raises ValueError for another ending, OSError if the file cannot be written.

    >>> record_drive("drive.txt")
    Traceback (most recent call last):
        ...
    ValueError: drive.txt: the name of a drive must end in .jsonl, got .txt
    """
    return DriveJournal(path, as_lidar(lidar), replace=replace)


def save_drive(drive: Drive, path: StrPath) -> None:
    """Write a whole drive at once, as a journal holds it, to a file ending in ``.jsonl``.

    A file that is there already is replaced. Raises ValueError for another ending, or a drive larger than
    ``load_drive`` reads; OSError if the file cannot be written: the old one then stays as it was.
    """
    path = as_path(path, DRIVE_ENDINGS, "a drive")
    with naming(path.name):
        check_type(drive, Drive, "must be a Drive")
        lines = (_line(drive.scans, number, speeds) for number, speeds in enumerate(drive.wheels))
        data = b"".join([_head(drive.lidar), *lines])
        limit(len(data), DRIVE_LIMIT, "must be at most {} bytes")
    write_atomically(path, data)


def load_drive(path: StrPath) -> Drive:
    """Read a drive from a file ending in ``.jsonl``, a whole one or the journal of a drive that broke off.

    A last line without an end, as a killed process leaves it, is passed over; the file stays as it is. Raises
    ValueError if the file is no drive, one of another version, or a scan in it is damaged; OSError if there is no such
    file (``FileNotFoundError``), or it cannot be read.

    A drive on which nothing was scanned is a drive too:

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     record_drive(f"{folder}/drive.jsonl", Lidar(beams=50)).close()
    ...     load_drive(f"{folder}/drive.jsonl").scans.ranges.shape
    (0, 50)
    """
    path = as_path(path, DRIVE_ENDINGS, "a drive")
    data = bounded_read(path, DRIVE_LIMIT)
    with naming(path.name):
        lines = lines_of(data)
        lidar = _lidar_in(next(lines, b""))
        seen = [_numbers_of(line, lidar, number) for number, line in enumerate(lines, start=2)]
        table = np.array(seen).reshape(len(seen), 6 + lidar.beams)
        scans = Scans(table[:, :3], lidar.angles, table[:, 6:], table[:, 5] == 1)
        return Drive(scans, table[:, 3:5], lidar)


# From a drive to lines.


def _head(lidar: Lidar) -> bytes:
    """Return the first line of a drive's file."""
    told = {name: value for name, value in asdict(lidar).items() if name == "model" or value != LATER.get(name)}
    return _json({"format": DRIVE_FORMAT, "version": DRIVE_VERSION, "lidar": told})


def _line(scans: Scans, number: int, wheels: Floats) -> bytes:
    """Return one scan as a line."""
    ranges = [distance if isfinite(distance) else None for distance in scans.ranges[number].tolist()]
    pose, inside = scans.poses[number].tolist(), bool(scans.inside[number])
    line = _json({"pose": pose, "wheels": wheels.tolist(), "ranges": ranges, "inside": inside})
    limit(len(line), LINE_LIMIT, "a scan must take at most {} bytes")
    return line


def _json(value: Any) -> bytes:
    text = json.dumps(value, allow_nan=False, separators=(",", ":"), default=lambda number: number.item())
    return text.encode() + b"\n"


def _check_scans(scans: Scans, lidar: Lidar) -> None:
    """Refuse what is not scans of this sensor."""
    check_type(scans, Scans, "scans must be Scans, as scan(world, poses) returns them")
    if not np.array_equal(scans.angles, lidar.angles) or scans.ranges.shape != (len(scans), lidar.beams):
        raise ValueError(f"scans must be the lidar's, with {lidar.beams} beams, got {scans.ranges.shape[-1]} others")


# From lines to a drive.


def _lidar_in(line: bytes) -> Lidar:
    """Return the sensor that the first line tells, or refuse a file that is no drive."""
    told: Any = None
    with suppress(ValueError):
        told = parsed(line)
    check_format(told, DRIVE_FORMAT, DRIVE_VERSION, "its first line with", line[:40])
    lidar, names = told.get("lidar"), {field.name for field in fields(Lidar)}
    if not isinstance(lidar, dict) or set(LATER | lidar) != names:
        raise ValueError(f"lidar must have {', '.join(sorted({*names - set(LATER), 'model'}))}, got {short(lidar)}")
    return Lidar(**lidar)


def _numbers_of(line: bytes, lidar: Lidar, number: int) -> Floats:
    """Return pose, wheels, inside (1 or 0) and ranges of a scan, one after the other, shape (6 + B,)."""
    with naming(f"line {number}"):
        told = parsed(line)
        check_type(told, dict, "must be a scan")
        check_type(told.get("inside"), bool, "inside must be true or false")
        pose, wheels = numbers_in(told, "pose", 3), numbers_in(told, "wheels", 2)
        return np.array([*pose, *wheels, told["inside"], *numbers_in(told, "ranges", lidar.beams, least=0.0)])
