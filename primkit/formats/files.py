"""Files: read within a limit, written whole or not at all, refused in one sentence that begins with the name.

In:  a path, and bytes or text to write.
Out: a file with this content, or the bytes of one.

>>> import tempfile
>>> with tempfile.TemporaryDirectory() as folder:
...     path = as_path(f"{folder}/table.csv", (".csv",), "a table")
...     write_atomically(path, "kind,rms")
...     read_whole(path, limit=1000)
b'kind,rms'
"""

from __future__ import annotations

import os
import secrets
import shutil
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from errno import EACCES, EINVAL, EISDIR
from pathlib import Path

StrPath = str | os.PathLike[str]


def write_atomically(path: StrPath, data: bytes | str) -> None:
    """Write a file whole or not at all: whoever reads it meanwhile sees all of the old or all of the new.

    Parameters
    ----------
    path : str or path
        The file; one that is there already is replaced and keeps its permissions. A link is followed.
    data : bytes or str
        The content; text becomes UTF-8, its line ends stay as they are.

    Raises
    ------
    OSError
        If it cannot be written (``FileNotFoundError``: the folder is missing). The old file then stays as it
        was, and nothing is left beside it.

    Notes
    -----
    The content goes to a temporary file in the same folder, on the same disc, down to the disc itself; then
    one step that the system does not divide puts it in the old file's place.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_atomically(f"{folder}/table.csv", "kind,rms")
    ...     [file.name for file in Path(folder).iterdir()]
    ['table.csv']
    """
    data = data.encode() if isinstance(data, str) else data
    with _plainly(Path(path), "written", "there is no folder"):
        target = Path(os.path.realpath(path))
        _check_ordinary(target)
        if target.exists() and not os.access(target, os.W_OK):
            raise OSError(EACCES, "it is write-protected")
        # Opened plainly, so that the system gives the permissions of any new file (mkstemp would keep the
        # user's group from reading it).
        temporary = target.with_name(f".primkit-{secrets.token_hex(8)}.tmp")
        try:
            with temporary.open("xb") as file:
                with suppress(OSError):  # no old file, or a disc that knows no permissions
                    shutil.copymode(target, temporary)
                file.write(data)
                file.flush()
                os.fsync(file.fileno())
            temporary.replace(target)
        except BaseException:  # an interrupt from the keyboard too
            temporary.unlink(missing_ok=True)
            raise


def read_whole(path: Path, limit: int) -> bytes:
    """Return a file's bytes; its size is looked at first, so that none can fill the memory."""
    with _plainly(path, "read", "there is no such file in"):
        size = path.stat().st_size
        _check_ordinary(path)
        with naming(path.name):
            check_size(size, limit)
        with path.open("rb") as file:
            return file.read(limit)


def as_path(path: StrPath, endings: Sequence[str], what: str) -> Path:
    """Return the path, or refuse an ending that says it is something else.

    >>> as_path("map.txt", (".geojson", ".json"), "a map")
    Traceback (most recent call last):
    ValueError: map.txt: the name of a map must end in .geojson or .json, got .txt
    """
    path = Path(path)
    if path.suffix.lower() not in endings:
        rule, got = " or ".join(endings), path.suffix or "no ending"
        raise ValueError(f"{path.name or path}: the name of {what} must end in {rule}, got {got}")
    return path


def check_size(size: int, limit: int) -> None:
    """Refuse more bytes than the limit."""
    if size > limit:
        raise ValueError(f"must be at most {limit:,} bytes, got {size:,}")


@contextmanager
def naming(where: str) -> Iterator[None]:
    """Begin the sentence of a ValueError with where it happened.

    >>> with naming("map.geojson"):
    ...     check_size(1200, limit=1000)
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
