"""Files: read within a limit, written whole or not at all, refused in one sentence that begins with the name.

In:  a path, and bytes or text to write.
Out: a file with this content, or the bytes of one.

>>> import tempfile
>>> with tempfile.TemporaryDirectory() as folder:
...     path = as_path(f"{folder}/table.csv", (".csv",), "a table")
...     write_atomically(path, "kind,rms")
...     bounded_read(path, most=1000)
b'kind,rms'

Whatever a file says of itself, reading it takes no more than a small multiple of its size: what is parsed as a whole
has at most ``TEXT_LIMIT`` bytes, what is parsed line by line at most ``LINE_LIMIT`` in a line, and an archive is
unpacked piece by piece.
"""

from __future__ import annotations

import io
import ntpath
import os
import re
import secrets
import shutil
import time
import zipfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from errno import EACCES, EINVAL, EISDIR
from pathlib import Path
from typing import Any, BinaryIO

from ..arguments import limit, short

StrPath = str | os.PathLike[str]

# Python's own reader of JSON takes up to 27 times the text.
TEXT_LIMIT, LINE_LIMIT = 16 * 2**20, 2 * 2**20
WINDOWS = os.name == "nt"
LEFTOVER = re.compile(r"\.primkit-[0-9a-f]{16}\.tmp")
OLD = 10.0  # s: a temporary file that nobody has written to for so long, and nobody holds, was left behind


def write_atomically(path: StrPath, data: bytes | str) -> None:
    """Write a file whole or not at all: whoever reads it meanwhile sees all of the old or all of the new.

    A file that is there already keeps its permissions; a link is followed. Text becomes UTF-8, its line ends stay as
    they are. The content goes to a temporary file in the same folder, down to the disc itself; then one step that the
    system does not divide puts it in the old file's place. Raises OSError if it cannot be written
    (``FileNotFoundError``: the folder is missing): the old file then stays as it was, and nothing is left beside it.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_atomically(f"{folder}/table.csv", "kind,rms")
    ...     [file.name for file in Path(folder).iterdir()]
    ['table.csv']
    """
    data = data.encode() if isinstance(data, str) else data
    path = Path(path)
    with _plainly(path, "written", "there is no folder"):
        target = Path(os.path.realpath(path))
        _check_ordinary(target)
        if target.exists() and not os.access(target, os.W_OK):
            raise OSError(EACCES, "it is write-protected")
        _sweep(target.parent)
        # Opened plainly, so that the system gives the permissions of any new file (mkstemp would keep the
        # user's group from reading it).
        temporary = target.with_name(f".primkit-{secrets.token_hex(8)}.tmp")
        try:
            with temporary.open("xb") as file:
                with suppress(OSError):  # a disc that knows no locks
                    _hold(file)
                with suppress(OSError):  # no old file, or a disc that knows no permissions
                    shutil.copymode(target, temporary)
                file.write(data)
                file.flush()
                os.fsync(file.fileno())
                if not WINDOWS:  # renamed while it is held: nobody can take it for a leftover
                    temporary.replace(target)
            if WINDOWS:  # which renames no open file, and removes none either
                temporary.replace(target)
        except BaseException:  # an interrupt from the keyboard too
            temporary.unlink(missing_ok=True)
            raise


def _sweep(folder: Path) -> None:
    """Remove the temporary files that killed processes have left behind."""
    with suppress(PermissionError), os.scandir(folder) as entries:  # a folder that may be written to, and not read
        for path in [Path(entry.path) for entry in entries if LEFTOVER.fullmatch(entry.name)]:
            with suppress(OSError):  # held by a process that lives, gone meanwhile, or another user's
                if time.time() - path.stat().st_mtime > OLD:
                    with path.open("rb") as file:
                        _hold(file)
                        if not WINDOWS:
                            path.unlink()
                    path.unlink(missing_ok=True)


def _hold(file: BinaryIO) -> None:
    """Mark a file as in use until it is closed, or its process ends; an OSError says that another one does."""
    try:
        import fcntl
    except ImportError:
        return  # Windows: no open file can be removed
    fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)


def append_whole(file: Any, data: bytes, path: Path) -> None:
    """Append to a file that was opened without a buffer, whole or not at all: what could not be written stays out."""
    with _plainly(path, "written", "there is no folder"):
        start = file.seek(0, os.SEEK_END)
        try:
            rest = memoryview(data)
            while rest:
                rest = rest[file.write(rest) :]
        except BaseException:
            file.truncate(start)
            raise


def opened(path: Path, mode: str) -> Any:
    """Open a file without a buffer, or say in one sentence that begins with its name why not."""
    with _plainly(path, "written", "there is no folder"):
        return path.open(mode, buffering=0)


def bounded_read(path: Path, most: int = TEXT_LIMIT) -> bytes:
    """Return a file's bytes, or refuse one that has more than so many; its size is looked at first."""
    size = size_of(path)
    with _plainly(path, "read", "there is no such file in"), naming(path.name):
        limit(size, most, "must be at most {} bytes")
        with path.open("rb") as file:
            data = file.read(size + 1)
            if len(data) > size:  # one that grows, or that has no size
                data += file.read(most - size)
        limit(len(data), most, "must be at most {} bytes")
        return data


def size_of(path: Path) -> int:
    """Return the size of an ordinary file in bytes, or say in one sentence why there is none."""
    with _plainly(path, "read", "there is no such file in"):
        size = path.stat().st_size
        _check_ordinary(path)
        return size


def lines_of(data: bytes) -> Iterator[bytes]:
    """Yield the lines that have an end, or refuse one that is too long to be parsed."""
    for number, line in enumerate(io.BytesIO(data), start=1):
        with naming(f"line {number}"):
            limit(len(line), LINE_LIMIT, "must be at most {} bytes")
        if line.endswith(b"\n"):  # behind the last end there is nothing, or half a line of a killed process
            yield line[:-1]


def open_archive(data: bytes) -> zipfile.ZipFile:
    """Return a zip archive of a few members, none of them packed so that it cannot be unpacked piece by piece."""
    limit(data.count(b"PK\x01\x02"), 1000, "must be an archive of at most {} members")
    archive = zipfile.ZipFile(io.BytesIO(data))
    for member in archive.infolist():
        if member.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
            raise ValueError(f"{short(member.filename)} must be stored or deflated, got another way of packing")
    return archive


def unpacked(archive: zipfile.ZipFile, member: str, most: int) -> bytes:
    """Return a member's bytes, or refuse one that unpacks to more than so many, whatever its directory says."""
    with archive.open(member) as stream:
        data = stream.read(most + 1)  # with a number, what is packed is unpacked piece by piece
    limit(len(data), most, "must unpack to at most {} bytes")
    return data


def as_path(path: Any, endings: Sequence[str], what: str, *, folder: bool = False) -> Path:
    """Return the path, or refuse an ending that says it is something else; that of a ``folder`` may be any.

    >>> as_path("map.txt", (".geojson", ".json"), "a map")
    Traceback (most recent call last):
    ValueError: map.txt: the name of a map must end in .geojson or .json, got .txt
    """
    name = os.fspath(path) if isinstance(path, (str, os.PathLike)) else None
    if not isinstance(name, str) or "\0" in name:
        raise ValueError(f"the name of {what} must be a text or a path, got {short(path)}")
    if WINDOWS and _has_stray_colon(name):
        raise ValueError(f"{name}: the name of {what} must have no colon, but for a drive as in C:\\maps")
    path = Path(path)
    ending = "".join(path.suffixes[-2:] if path.suffix.lower() == ".gz" else path.suffixes[-1:])
    if ending.lower() not in endings and not (folder and path.name and path.is_dir()):
        rule, got = " or ".join(endings), path.suffix or "no ending"
        raise ValueError(f"{path.name or path}: the name of {what} must end in {rule}, got {got}")
    return path


def _has_stray_colon(name: str) -> bool:
    r"""Tell whether Windows would take a part of the name for a drive, or for a second content of another file.

    >>> [_has_stray_colon(name) for name in (r"C:\maps\a.json", "C:/a.json", "a.json", "a:b.json", "C:/maps/a:b.json")]
    [False, False, False, True, True]
    """
    drive, rest = ntpath.splitdrive(name)
    return ":" in rest or (drive.endswith(":") and not rest.startswith(("/", "\\")))


@contextmanager
def naming(where: str) -> Iterator[None]:
    """Begin the sentence of a ValueError with where it happened.

    >>> with naming("map.geojson"):
    ...     limit(1200, 1000, "must be at most {} bytes")
    Traceback (most recent call last):
    ValueError: map.geojson: must be at most 1,000 bytes, got 1,200
    """
    try:
        yield
    except ValueError as error:
        raise ValueError(f"{where}: {error}") from None


@contextmanager
def _plainly(path: Path, doing: str, missing: str) -> Iterator[None]:
    """Say in one sentence that begins with the file's name why the system refused."""
    try:
        yield
    except FileExistsError:
        raise
    except FileNotFoundError:
        raise FileNotFoundError(f"{path.name}: {missing} {path.absolute().parent}") from None
    except OSError as error:
        raise type(error)(f"{path.name}: cannot be {doing}: {error.strerror or error}") from None


def _check_ordinary(path: Path) -> None:
    """Refuse what is there, but is no ordinary file."""
    if path.is_dir():
        raise OSError(EISDIR, "it is a folder")
    # A pipe would keep its reader waiting for ever; a file in the place of /dev/null would harm the system.
    if path.exists() and not path.is_file():
        raise OSError(EINVAL, "it is no ordinary file")
