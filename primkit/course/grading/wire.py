"""Wire: plain values from one process to another, each with its length before it.

In:  a socket.
Out: what the other side said; ``None`` once it is gone.
"""

from __future__ import annotations

import socket
import struct
import time
from collections.abc import Callable
from typing import Any

from .plain_values import pack, unpack

ENDED = "has ended"
LENGTH = struct.Struct(">I")
MOST_BYTES = 2**20  # of what a student's process says at once
LISTENS_SECONDS = 30.0  # until the other side has read what it is told
PAUSE = 0.05  # s between two looks at the clock while nothing is said
FAMILY = getattr(socket, "AF_UNIX", socket.AF_INET)  # Windows' Python has no sockets in files


class HungUpError(Exception):
    """The other side has ended, or says what nobody can read."""


def say(line: socket.socket, *values: Any) -> None:
    """Send values."""
    content = pack(list(values))
    line.settimeout(LISTENS_SECONDS)
    try:
        line.sendall(LENGTH.pack(len(content)) + content)
    except OSError:
        raise HungUpError(ENDED) from None


def hear(line: socket.socket, most: int | None = MOST_BYTES, watch: Callable[[], None] | None = None) -> list[Any]:
    """Return the values that the other side says; ``watch`` is called while it is silent, and may raise.

    Raises HungUpError if it has ended, says more than ``most`` bytes, or no plain values.
    """
    (length,) = LENGTH.unpack(_bytes(line, LENGTH.size, watch))
    if most is not None and length > most:
        raise HungUpError(f"says {length} bytes at once")
    try:
        values = unpack(_bytes(line, length, watch))
    except ValueError as error:
        raise HungUpError(str(error)) from None
    if not isinstance(values, list) or not values:
        raise HungUpError("says nothing that is known")
    return values


def _bytes(line: socket.socket, count: int, watch: Callable[[], None] | None) -> bytes:
    line.settimeout(PAUSE if watch else None)
    parts: list[bytes] = []
    last = time.monotonic()
    while count:
        try:
            part = line.recv(min(count, MOST_BYTES))
        except TimeoutError:
            part = None
        except OSError:
            raise HungUpError(ENDED) from None
        if watch and time.monotonic() - last > PAUSE:  # also while it dribbles
            watch()
            last = time.monotonic()
        if part is None:
            continue
        if not part:
            raise HungUpError(ENDED)
        parts.append(part)
        count -= len(part)
    line.settimeout(None)
    return b"".join(parts)
