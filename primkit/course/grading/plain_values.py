"""Plain values: all that crosses between the judge and the process that a student's code runs in.

Numbers, texts, arrays, lists and the like, and a few of the library's nouns; written as JSON, never as objects. What
comes out of ``unpack`` was made here, anew: nothing of the student's is called, compared or printed.

In:  a value.
Out: bytes, and from bytes the value; what is no plain value becomes a ``stranger``, an object with a name alone.

>>> unpack(pack([1.5, (2, None), np.array([[1, 2]])]))
[1.5, (2, None), array([[1, 2]])]
>>> type(unpack(pack(print))).__name__
'builtin_function_or_method'
>>> unpack(b'[["list", ' * 40)
Traceback (most recent call last):
    ...
ValueError: must be a plain value, got what is none: Expecting value: line 1 column 401 (char 400)
"""

from __future__ import annotations

import base64
import json
import re
from types import EllipsisType
from typing import Any

import numpy as np

from ...lidar import Scans
from ...lines import Line
from ...shapes import Circle, Polygon

DEPTH = 20  # how deep values may lie in each other
DIGITS = 400  # of a whole number
LONGEST_AXIS = 10**7  # along one axis of an array
MOST_KEYS = 10_000  # of a set or a dictionary: with chosen keys, each costs as much as all before it
NAME_LETTERS = 60
ARRAY_TYPE = re.compile(r"\|b1|[|<>=]?[iu][1248]|[<>=]?f[248]|[<>=]?c(8|16)|[<>=]?U\d{1,4}")
NOUNS: dict[str, tuple[type[Any], tuple[str, ...]]] = {
    "Circle": (Circle, ("center", "radius")),
    "Polygon": (Polygon, ("vertices",)),
    "Line": (Line, ("angle", "offset")),
    "Scans": (Scans, ("poses", "angles", "ranges", "inside")),
}
GROUPS: dict[str, type[Any]] = {"list": list, "tuple": tuple, "set": set, "frozenset": frozenset}


def pack(value: Any) -> bytes:
    """Return a value as bytes."""
    return json.dumps(_written(value, DEPTH), separators=(",", ":")).encode()


def unpack(data: bytes) -> Any:
    """Return the value in bytes that may come from anybody.

    Raises ValueError if they hold anything but a plain value within the limits.
    """
    try:
        return _read(json.loads(data, parse_int=_whole), DEPTH)
    except (ValueError, TypeError, RecursionError, OverflowError, LookupError) as error:
        raise ValueError(f"must be a plain value, got what is none: {error}") from None


def stranger(name: str) -> Any:
    """Return an object of which a name is known, and nothing else."""
    return type(readable(name)[:NAME_LETTERS] or "object", (), {})()


def readable(text: str) -> str:
    """Return a text with ``?`` for what cannot be printed: halves of letters, signs that turn a line round."""
    return "".join(letter if letter.isprintable() or letter in "\n\t" else "?" for letter in text)


def _written(value: Any, depth: int) -> Any:
    """Return a value as JSON knows it: a list is a name and what belongs to it."""
    if value is None or isinstance(value, bool):
        return value
    if isinstance(value, (str, float)):
        return str(value) if isinstance(value, str) else float(value)
    if isinstance(value, EllipsisType):
        return ["...", None]
    if isinstance(value, int):
        return int(value) if abs(value) < 10**DIGITS else ["stranger", f"{type(value).__name__} of too many digits"]
    if depth == 0:
        return ["stranger", f"{type(value).__name__} nested too deeply"]
    for name, (noun, fields) in NOUNS.items():
        if isinstance(value, noun):
            return [name, [_written(getattr(value, field), depth - 1) for field in fields]]
    if isinstance(value, np.random.Generator):
        bits = value.bit_generator
        return ["Generator", [type(bits).__name__, _written(bits.state, depth - 1)]]
    for name, kind in GROUPS.items():
        if isinstance(value, kind):
            return [name, [_written(part, depth - 1) for part in value]]
    if isinstance(value, dict):
        return ["dict", [[_written(key, depth - 1), _written(part, depth - 1)] for key, part in value.items()]]
    return _written_array(value)


def _written_array(value: Any) -> Any:
    """Return anything that numpy takes for an array of numbers or texts; a stranger for what it does not."""
    try:
        array = np.asarray(value)
    except Exception:
        array = np.asarray(None)
    if isinstance(value, np.generic) and array.dtype.kind in "biufU":
        return _written(value.item() if array.dtype.itemsize <= 8 or array.dtype.kind == "U" else float(value), 1)
    if array.dtype.kind in "fc" and not ARRAY_TYPE.fullmatch(array.dtype.str):  # of more than 64 bits
        array = array.astype(float if array.dtype.kind == "f" else complex)
    if not ARRAY_TYPE.fullmatch(array.dtype.str):
        return ["stranger", type(value).__name__]
    content = base64.b64encode(np.ascontiguousarray(array).tobytes()).decode()
    return ["array", [array.dtype.str, list(array.shape), content]]


def _whole(digits: str) -> int:
    if len(digits) > DIGITS + 1:
        raise ValueError(f"a whole number of {len(digits)} digits")
    return int(digits)


def _read(value: Any, depth: int) -> Any:
    """Return the value that JSON stands for."""
    if isinstance(value, str):
        return readable(value)
    if not isinstance(value, (list, dict)):
        return value
    if depth == 0 and value[0] != "stranger":
        raise ValueError("nested too deeply")
    name, content = value
    if name == "...":
        return ...
    if name == "stranger":
        return stranger(str(content))
    if name == "array":
        return _read_array(*content)
    if name in ("set", "frozenset", "dict") and len(content) > MOST_KEYS:
        raise ValueError(f"a {name} of {len(content)}")
    if name == "dict":
        return {_read(key, depth - 1): _read(part, depth - 1) for key, part in content}
    if name == "Generator":
        kinds = (np.random.PCG64, np.random.PCG64DXSM, np.random.Philox, np.random.SFC64)
        generator = np.random.Generator({kind.__name__: kind for kind in kinds}[content[0]](0))
        generator.bit_generator.state = _read(content[1], DEPTH)
        return generator
    parts = [_read(part, depth - 1) for part in content]
    if name in GROUPS:
        return GROUPS[name](parts)
    if name == "Line":
        return Line(*map(float, parts))
    return NOUNS[name][0](*parts)


def _read_array(kind: str, shape: list[int], content: str) -> Any:
    if not ARRAY_TYPE.fullmatch(kind) or len(shape) > DEPTH or not all(0 <= n <= LONGEST_AXIS for n in shape):
        raise ValueError("an array of no such kind")
    data = bytearray(base64.b64decode(content, validate=True))
    if kind == "|b1":
        return np.frombuffer(data, np.uint8).reshape(shape) != 0
    array = np.frombuffer(data, np.dtype(kind)).reshape(shape) if data else np.zeros(shape, np.dtype(kind))
    if array.dtype.kind == "U":
        data.decode("utf-32-be" if kind.startswith(">") else "utf-32-le")  # each is a letter, or this says so
    return array
