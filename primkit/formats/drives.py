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
at once: who is killed in the middle of a drive loses nothing that was finished. No hit is ``null``.

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
from ..lidar import Lidar, Scans
from ..show import thumbnail
from .files import LINE_LIMIT, StrPath, append_whole, as_path, bounded_read, lines_of, naming, opened, write_atomically
from .values import numbers_in, parsed

DRIVE_ENDINGS = (".jsonl",)
# Most of an hour with ten scans of 100 beams a second if all of them hit something, several hours otherwise.
DRIVE_LIMIT = 64 * 2**20
DRIVE_FORMAT, DRIVE_VERSION = "primkit drive", 1


@dataclass(frozen=True, eq=False)
class Drive:
    """What was driven and what was seen on the way.

    Parameters
    ----------
    scans : Scans
        P scans, in their order, a period apart; ``scans.poses`` is where each was made.
    wheels : array_like, shape (P, 2)
        Speeds of the left and the right wheel that were held before each scan, radians per second; those before the
        first brought the robot to where the drive begins.
    lidar : Lidar, optional
        The sensor; the paper's by default.

    Raises
    ------
    ValueError
        If these do not fit together.

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
        check_type(self.lidar, Lidar, "lidar must be a Lidar, such as Lidar()")
        _check_scans(self.scans, self.lidar)
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
        """Write one scan down, and hand it to the system.

        Parameters
        ----------
        scans : Scans
            One scan.
        wheels : array_like, shape (2,)
            Speeds of the left and the right wheel that were held before it, radians per second.

        Raises
        ------
        ValueError
            If it is not one scan of the journal's sensor, the journal is closed, or there is no room left.
        OSError
            If it cannot be written; the journal then stays as it was.
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
    """Begin to write a drive down, scan by scan.

    Parameters
    ----------
    path : str or path
        The file, ending in ``.jsonl``.
    lidar : Lidar, optional
        The sensor; the paper's by default.
    replace : bool
        Begin anew where there is a file already. Without it such a file is refused: it may hold the only record of a
        drive that broke off.

    Returns
    -------
    DriveJournal
        Its ``add(scans, wheels)`` writes one scan; use it in a ``with`` statement, or ``close()`` it.

    Raises
    ------
    ValueError
        If the ending is another one.
    OSError
        If the file is there already (``FileExistsError``), or cannot be written.

    Examples
    --------
    >>> record_drive("drive.txt")
    Traceback (most recent call last):
        ...
    ValueError: drive.txt: the name of a drive must end in .jsonl, got .txt
    """
    lidar = Lidar() if lidar is None else lidar
    check_type(lidar, Lidar, "lidar must be a Lidar, such as Lidar()")
    return DriveJournal(path, lidar, replace=replace)


def save_drive(drive: Drive, path: StrPath) -> None:
    """Write a whole drive at once, as a journal holds it.

    Parameters
    ----------
    drive : Drive
        What was driven and seen.
    path : str or path
        The file, ending in ``.jsonl``; one that is there already is replaced.

    Raises
    ------
    ValueError
        If the ending is another one, or the drive is larger than ``load_drive`` reads.
    OSError
        If the file cannot be written; the old one then stays as it was.
    """
    path = as_path(path, DRIVE_ENDINGS, "a drive")
    with naming(path.name):
        check_type(drive, Drive, "must be a Drive")
        lines = (_line(drive.scans, number, speeds) for number, speeds in enumerate(drive.wheels))
        data = b"".join([_head(drive.lidar), *lines])
        limit(len(data), DRIVE_LIMIT, "must be at most {} bytes")
    write_atomically(path, data)


def load_drive(path: StrPath) -> Drive:
    """Read a drive, from a whole file or from the journal of one that broke off.

    Parameters
    ----------
    path : str or path
        The file, ending in ``.jsonl``. A last line without an end, as a killed process leaves it, is passed over; the
        file stays as it is.

    Raises
    ------
    ValueError
        If the file is no drive, one of another version, or a scan in it is damaged.
    OSError
        If there is no such file (``FileNotFoundError``), or it cannot be read.

    Examples
    --------
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
    return _json({"format": DRIVE_FORMAT, "version": DRIVE_VERSION, "lidar": asdict(lidar)})


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
    told = None
    with suppress(ValueError):
        told = parsed(line)
    if not isinstance(told, dict) or told.get("format") != DRIVE_FORMAT:
        raise ValueError(f'must be a drive, its first line with "format": "{DRIVE_FORMAT}", got {short(line[:40])}')
    if told.get("version") != DRIVE_VERSION:
        raise ValueError(f"must be a drive of version {DRIVE_VERSION}, got version {short(told.get('version'))}")
    lidar, names = told.get("lidar"), {field.name for field in fields(Lidar)}
    if not isinstance(lidar, dict) or set({"model": "exact"} | lidar) != names:  # older drives tell no model
        raise ValueError(f"lidar must have {', '.join(sorted(names))}, got {short(lidar)}")
    return Lidar(**lidar)


def _numbers_of(line: bytes, lidar: Lidar, number: int) -> Floats:
    """Return pose, wheels, inside (1 or 0) and ranges of a scan, one after the other, shape (6 + B,)."""
    with naming(f"line {number}"):
        told = parsed(line)
        check_type(told, dict, "must be a scan")
        check_type(told.get("inside"), bool, "inside must be true or false")
        pose, wheels = numbers_in(told, "pose", 3), numbers_in(told, "wheels", 2)
        return np.array([*pose, *wheels, told["inside"], *numbers_in(told, "ranges", lidar.beams, least=0.0)])
