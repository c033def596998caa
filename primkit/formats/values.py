"""Values: what a JSON text by a stranger holds, checked before it is used.

In:  JSON in bytes; an object, the name of a list in it, and how many numbers there must be.
Out: these numbers; or one sentence that states the rule and the value.

>>> numbers_in(parsed(b'{"ranges": [0.1, null]}'), "ranges", 2, least=0)
[0.1, inf]
"""

from __future__ import annotations

import json
import sys
from math import inf
from typing import Any

from ..arguments import limit, short
from .files import TEXT_LIMIT

LARGEST = sys.float_info.max


def parsed(data: bytes) -> Any:
    """Return what JSON says, or refuse what is none.

    >>> parsed(b"{")
    Traceback (most recent call last):
        ...
    ValueError: must be valid JSON, got b'{'
    """
    limit(len(data), TEXT_LIMIT, "must be at most {} bytes")
    try:
        return json.loads(data)
    except (ValueError, RecursionError, MemoryError):  # no JSON, no UTF-8, a number of thousands of digits, too deep
        raise ValueError(f"must be valid JSON, got {short(data[:40])}") from None


def check_format(told: Any, name: str, version: int, told_by: str, got: Any) -> None:
    """Refuse what does not say that it is of this format and version."""
    noun = name.removeprefix("primkit ")
    if not isinstance(told, dict) or told.get("format") != name:
        raise ValueError(f'must be a {noun}, {told_by} "format": "{name}", got {short(got)}')
    if told.get("version") != version:
        raise ValueError(f"must be a {noun} of version {version}, got version {short(told.get('version'))}")


def numbers_in(told: dict[str, Any], name: str, n: int, least: float = -inf) -> list[float]:
    """Return n finite numbers; where there is a least one, null stands for infinity.

    >>> numbers_in({"pose": [1, 2]}, "pose", 3)
    Traceback (most recent call last):
        ...
    ValueError: pose must be 3 finite numbers, got 2 of them
    """
    nothing = least > -inf
    rule = f"{name} must be {n} finite numbers" + (f" >= {least:g}, or null for no hit" if nothing else "")
    values = told.get(name)
    if not isinstance(values, list) or len(values) != n:
        raise ValueError(f"{rule}, got {f'{len(values)} of them' if isinstance(values, list) else short(values)}")
    for value in values:
        number = isinstance(value, (int, float)) and not isinstance(value, bool)
        # Compared, not converted: a whole number may have hundreds of digits.
        if not ((number and max(least, -LARGEST) <= value <= LARGEST) or (value is None and nothing)):
            raise ValueError(f"{rule}, got {short(value)}")
    return [inf if value is None else float(value) for value in values]
