"""Arguments: what a user hands in is checked here, once, and refused in one clear sentence.

In:  anything.
Out: arrays and numbers that the rest can rely on; or a ``ValueError`` that states the rule and the value it got.

>>> as_points([(1, 2), (3, float("nan"))])
Traceback (most recent call last):
    ...
ValueError: points must be finite, got (3.0, nan) in row 1
"""

from __future__ import annotations

import reprlib
import warnings
from collections.abc import Iterable
from contextlib import suppress
from numbers import Number
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

# The arrays that the whole library works on; shapes and units stand in the docstrings.
Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Labels = NDArray[np.intp]
Bools = NDArray[np.bool_]

# 0.305 - 0.3 is a little more than 0.005: a value this much [m] beyond a limit that is included lies on it.
ROUNDING = 1e-12
FARTHEST = 1e50  # a larger number is a mistake, and its sixth power would not fit into a float


class LikelyWrong(UserWarning):
    """Told of a value that is allowed, but is most likely in another unit, or in the wrong place."""


def as_points(points: ArrayLike | Iterable[Any], name: str = "points", d: int = 2) -> Floats:
    """Return points as an (N, d) array of finite floats, or say in one sentence what is wrong.

    Parameters
    ----------
    points : array_like, shape (N, d)
        Positions in metres, world frame. An empty sequence gives shape (0, d).
    name : str
        What the points are called in the error message.
    d : int
        How many coordinates a point has.

    Raises
    ------
    ValueError
        If the shape is not (N, d) or a value is NaN or infinite.

    Examples
    --------
    >>> as_points([(1, 2)])
    array([[1., 2.]])
    >>> as_points([]).shape
    (0, 2)
    """
    if hasattr(points, "points"):  # a Grid or Scans, handed in whole
        raise ValueError(f"{name} must be an (N, {d}) array, got a {type(points).__name__}; did you mean its points()?")
    array = as_floats(points, name, f"(N, {d})")
    if array.size == 0 and array.ndim <= 2:
        return np.empty((0, d))
    if array.ndim != 2 or array.shape[1] != d:
        raise ValueError(f"{name} must have shape (N, {d}), got shape {array.shape}")
    return _all_finite(array, name)


def as_point(point: ArrayLike, name: str, d: int = 2) -> Floats:
    """Return one point as an array of d finite floats, or say in one sentence what is wrong.

    >>> as_point((1, 2), "center")
    array([1., 2.])
    """
    try:
        points = as_points([point], name, d)
    except ValueError:
        points = np.empty((0, d))
    if len(points) != 1:
        rule = {2: "two finite numbers (x, y)", 3: "three finite numbers (x, y, z)"}[d]
        raise ValueError(f"{name} must be {rule}, got {short(point)}")
    return points[0]


def as_positive(value: Any, name: str, *, zero: bool = False) -> float:
    """Return a finite float above zero (or from zero up), or say in one sentence what is wrong.

    >>> as_positive(3, "radius")
    3.0
    """
    rule = "a finite number >= 0" if zero else "a finite number > 0"
    number = _as_number(value, name, rule)
    if not np.isfinite(number) or number < 0 or (number == 0 and not zero):
        raise ValueError(f"{name} must be {rule}, got {number:g}")
    if number > FARTHEST:
        raise ValueError(f"{name} must be {rule} and at most {FARTHEST:g}, got {number:g}")
    return number


def as_share(value: Any, name: str, rule: str = "a share from 0 to 1") -> float:
    """Return a float from 0 to 1, or say in one sentence what is wrong.

    >>> as_share("0.1", "left_over")
    Traceback (most recent call last):
        ...
    ValueError: left_over must be a share from 0 to 1, got '0.1'
    """
    number = _as_number(value, name, rule)
    if not 0 <= number <= 1:
        raise ValueError(f"{name} must be {rule}, got {number:g}")
    return number


def _as_number(value: Any, name: str, rule: str) -> float:
    try:
        if isinstance(value, (str, bytes, bool, np.bool_, np.timedelta64)) or value is np.ma.masked:
            raise TypeError  # float() would take "0.1", True, and a masked value with a warning
        if isinstance(value, np.ndarray) and (value.ndim or value.dtype.kind not in "fiu"):
            raise TypeError
        return float(value)
    except (TypeError, ValueError, OverflowError):
        raise ValueError(f"{name} must be {rule}, got {short(value)}") from None


def as_count(value: Any, name: str, least: int = 1) -> int:
    """Return a whole number of at least ``least``, or say in one sentence what is wrong.

    >>> as_count(np.int64(4), "n_shapes")
    4
    """
    whole = isinstance(value, (int, np.integer)) and not isinstance(value, bool)
    if not whole or value < least:
        raise ValueError(f"{name} must be a whole number >= {least}, got {short(value)}")
    return int(value)


def as_poses(poses: ArrayLike) -> Floats:
    """Return poses as a (P, 3) array of finite floats, or say in one sentence what is wrong.

    >>> as_poses((0, 0, 0)).shape
    (1, 3)
    """
    array = as_floats(poses, "poses", "(P, 3): x, y, heading")
    array = array.reshape(-1, 3) if array.size == 0 or array.shape == (3,) else array
    if array.ndim != 2 or array.shape[1] != 3:
        raise ValueError(f"poses must have shape (P, 3): x, y, heading; got shape {array.shape}")
    return _all_finite(array, "poses")


def _all_finite(array: Floats, name: str) -> Floats:
    """Return the array, or refuse it for its first row that is not finite, or too far out to be squared."""
    fine = np.abs(array) <= FARTHEST
    if not fine.all():  # at once: row by row takes ten times as long
        row = int(np.argmin(fine.all(axis=1)))
        rule = f"finite and at most {FARTHEST:g}" if np.isfinite(array[row]).all() else "finite"
        raise ValueError(f"{name} must be {rule}, got {tuple(array[row].tolist())} in row {row}")
    return array


def as_floats(values: Any, name: str, shape: str) -> Floats:
    """Return values as an array of floats, or say in one sentence that they are none; the caller checks the shape.

    >>> as_floats(np.ma.array([1.0, 2.0], mask=[False, True]), "ranges", "(N,)")
    Traceback (most recent call last):
        ...
    ValueError: ranges must have no masked values, got 1 of them: leave them out, as compressed() does
    """
    if type(values) is np.ndarray and values.dtype == np.float64:  # as nearly always from within
        return values
    parts = values if isinstance(values, (list, tuple)) else [values]
    if masked := sum(int(np.ma.getmaskarray(part).sum()) for part in parts if isinstance(part, np.ma.MaskedArray)):
        rule = f"{name} must have no masked values, got {masked} of them"
        raise ValueError(f"{rule}: leave them out, as compressed() does")
    with suppress(TypeError, ValueError, OverflowError, RecursionError):  # rows of different lengths, None, 10**400
        array = np.asarray(values)
        # numpy would read "1.5", True and a date as numbers, and drop what is imaginary.
        mixed = array.dtype.kind == "O" and all(isinstance(v, Number) and not isinstance(v, bool) for v in array.flat)
        if array.size == 0 or array.dtype.kind in "fiu" or mixed:
            return np.asarray(array, dtype=float)
    raise ValueError(f"{name} must be numbers in an array of shape {shape}, got {short(values)}")


def as_rng(rng: Any) -> np.random.Generator:
    """Return a random generator from a seed or a generator, or say in one sentence what is wrong.

    >>> as_rng(7).integers(100) == as_rng(7).integers(100)
    np.True_
    """
    try:
        if isinstance(rng, (bool, np.bool_, np.random.RandomState)):
            raise TypeError
        generator = np.random.default_rng(rng)
        if not hasattr(generator.bit_generator.seed_seq, "spawn"):  # each stage gets a generator of its own
            raise TypeError
    except (TypeError, ValueError, OverflowError):
        raise ValueError(f"rng must be a whole number >= 0 or a numpy Generator, got {short(rng)}") from None
    return generator


def limit(n: float, most: int, rule: str, cause: str = "") -> None:
    """Refuse work that would grow without limit before it begins, and name the likely cause.

    >>> limit(66_000_000, 1_000_000, "a board must have at most {} way-points", "is the map in millimetres?")
    Traceback (most recent call last):
        ...
    ValueError: a board must have at most 1,000,000 way-points, got 66,000,000; is the map in millimetres?
    """
    if not n <= most:
        got = f"{n:,.0f}" if n < 1e15 else short(n)
        raise ValueError(f"{rule.format(f'{most:,}')}, got {got}{'; ' if cause else ''}{cause}")


def doubt(sentence: str, depth: int) -> None:
    """Tell, as a warning, of a value that is most likely wrong; ``depth`` functions lie between here and the user."""
    warnings.warn(sentence, LikelyWrong, stacklevel=depth + 2)


def check_type(value: Any, kind: type | tuple[type, ...], rule: str) -> None:
    """Refuse a value of another type in one sentence: ``rule`` says what it must be.

    >>> check_type(3, str, "name must be a text")
    Traceback (most recent call last):
        ...
    ValueError: name must be a text, got int
    """
    if not isinstance(value, kind):
        raise ValueError(f"{rule}, got {type(value).__name__}")


def short(value: Any) -> str:
    """Return a value as text on one line, cut to its length, however large or deep the value is.

    >>> short(10**400) == short(10**300) == "1" + 56 * "0" + "..."
    True
    """
    try:
        text = _BRIEF.repr(value).replace("\n", " ")
    except (ValueError, RecursionError):  # Python writes no whole number of more than 4,300 digits
        text = f"{type(value).__name__} too long to show"
    return text if len(text) <= 60 else text[:57] + "..."


_BRIEF = reprlib.Repr()  # what is cut off is not even looked at
_BRIEF.maxlevel, _BRIEF.maxstring, _BRIEF.maxlong, _BRIEF.maxother = 8, 2000, 2000, 2000
_BRIEF.maxlist = _BRIEF.maxtuple = _BRIEF.maxdict = _BRIEF.maxset = 30
