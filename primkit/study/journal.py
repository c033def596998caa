"""Journal: rows written down one by one, so that a killed study continues.

In:  rows as they are finished, each with its experiment's key.
Out: the rows that an earlier run finished, by key.

A line of the file is one row and all that it depends on, as JSON. Rows of several studies may stand side by side: each
is found by its key alone.

Source: the form is JSON Lines, jsonlines.org.
"""

from __future__ import annotations

import io
import json
import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any, BinaryIO

from ..arguments import limit
from ..formats.files import LINE_LIMIT, StrPath, append_whole, opened
from ..formats.values import parsed
from .row import Row, Score

JOURNAL = "journal.jsonl"


def make_folder(folder: StrPath) -> Path:
    """Return a folder's path, making it where it is not there yet.

    Raises
    ------
    OSError
        If that is not possible; one sentence says why.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as here:
    ...     make_folder(f"{here}/results/today").name
    'today'
    """
    path = Path(folder)
    try:
        path.mkdir(parents=True, exist_ok=True)
    except (FileExistsError, NotADirectoryError):
        raise NotADirectoryError(f"{path} must be a folder, got a file or a folder below a file") from None
    except OSError as error:
        raise type(error)(f"{path}: the folder cannot be made: {error.strerror or error}") from None
    return path


@contextmanager
def open_journal(folder: StrPath | None) -> Iterator[tuple[dict[str, Row], BinaryIO | None]]:
    """Open the journal in a folder: the rows that it holds, by key, and the file to append to."""
    if folder is None:
        yield {}, None
        return
    with opened(make_folder(folder) / JOURNAL, "a+b") as file:
        file.seek(0)
        yield rows_in(file), file


def rows_in(file: BinaryIO) -> dict[str, Row]:
    """Return a journal's rows by key; a last line without an end, left by a killed process, is cut off."""
    data, rows = file.read(), {}
    file.truncate(whole := data.rfind(b"\n") + 1)
    for number, line in enumerate(io.BytesIO(data[:whole]), start=1):
        try:
            limit(len(line), LINE_LIMIT, "must be at most {} bytes")
            entry = parsed(line)
            rows[json.dumps(entry["experiment"], sort_keys=True)] = _as_row(entry["row"])
        except (ValueError, TypeError, KeyError, AttributeError, RecursionError):
            raise ValueError(f"{JOURNAL}, line {number}: must be a row of a study, got {line[:40]!r}") from None
    file.seek(0, os.SEEK_END)
    return rows


def n_rows(path: Path) -> int:
    """Return how many rows the journal with this path holds; 0 when it is not there."""
    return path.read_bytes().count(b"\n") if path.exists() else 0


def append(file: BinaryIO | None, row: Row, key: str) -> None:
    """Write one row, and hand it to the system: a killed process loses nothing of it."""
    if file is not None:
        line = json.dumps({"experiment": json.loads(key), "row": asdict(row)})
        append_whole(file, line.encode() + b"\n", Path(JOURNAL))


def _as_row(told: dict[str, Any]) -> Row:
    """Return a row from what JSON makes of it."""
    later = ("found_as", "seen", "dimension_counts")  # rows of earlier versions do not say it
    lists = {name: tuple(told.get(name, ())) for name in later}
    lists |= {name: tuple(told[name]) for name in ("kinds", "center_errors", "dimension_errors")}
    return replace(Row(**{**told, **lists}), fair=Score(**told["fair"]), paper=Score(**told["paper"]))
