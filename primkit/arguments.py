"""Arguments: what a user hands in is checked here, once, and refused in one clear sentence.

In:  anything.
Out: arrays and numbers that the rest can rely on; or a ``ValueError`` that states the rule and the value it got.

>>> as_points([(1, 2), (3, float("nan"))])
Traceback (most recent call last):
    ...
ValueError: points must be finite, got (3.0, nan) in row 1
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

# The arrays that the whole library works on; shapes and units stand in the docstrings.
Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Labels = NDArray[np.int64]
Bools = NDArray[np.bool_]

# 0.305 - 0.3 is a little more than 0.005: a value this much [m] beyond a limit that is included lies on it.
ROUNDING = 1e-12


def as_points(points: ArrayLike | Iterable[Any], name: str = "points") -> Floats:
    """Return points as an (N, 2) array of finite floats, or say in one sentence what is wrong.

    Parameters
    ----------
    points : array_like, shape (N, 2)
        Positions in metres, world frame. An empty sequence gives shape (0, 2).
    name : str
        What the points are called in the error message.

    Raises
    ------
    ValueError
        If the shape is not (N, 2) or a value is NaN or infinite.

    Examples
    --------
    >>> as_points([(1, 2)])
    array([[1., 2.]])
    >>> as_points([]).shape
    (0, 2)
    """
    if hasattr(points, "points"):  # a Grid or Scans, handed in whole
        raise ValueError(f"{name} must be an (N, 2) array, got a {type(points).__name__}; did you mean its points()?")
    try:
        array = _as_floats(points)
    except (TypeError, ValueError, OverflowError):
        raise ValueError(f"{name} must be numbers in an array of shape (N, 2), got {short(points)}") from None
    if array.size == 0 and array.ndim <= 2:
        return np.empty((0, 2))
    if array.ndim != 2 or array.shape[1] != 2:
        raise ValueError(f"{name} must have shape (N, 2), got shape {array.shape}")
    return _all_finite(array, name)


def as_point(point: ArrayLike, name: str) -> Floats:
    """Return one point as an array of two finite floats, or say in one sentence what is wrong.

    >>> as_point((1, 2), "center")
    array([1., 2.])
    """
    try:
        points = as_points([point], name)
    except ValueError:
        points = np.empty((0, 2))
    if len(points) != 1:
        raise ValueError(f"{name} must be two finite numbers (x, y), got {short(point)}")
    return points[0]


def as_positive(value: Any, name: str, *, zero: bool = False) -> float:
    """Return a finite float above zero (or from zero up), or say in one sentence what is wrong.

    >>> as_positive(3, "radius")
    3.0
    """
    rule = "a finite number >= 0" if zero else "a finite number > 0"
    try:
        if isinstance(value, (str, bytes, bool, np.bool_)):
            raise TypeError  # float() would take "0.1" and True
        number = float(value)
    except (TypeError, ValueError, OverflowError):
        raise ValueError(f"{name} must be {rule}, got {short(value)}") from None
    if not np.isfinite(number) or number < 0 or (number == 0 and not zero):
        raise ValueError(f"{name} must be {rule}, got {number:g}")
    return number


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
    try:
        array = _as_floats(poses)
    except (TypeError, ValueError, OverflowError):
        raise ValueError("poses must be numbers in an array of shape (P, 3): x, y, heading") from None
    array = array.reshape(-1, 3) if array.size == 0 or array.shape == (3,) else array
    if array.ndim != 2 or array.shape[1] != 3:
        raise ValueError(f"poses must have shape (P, 3): x, y, heading; got shape {array.shape}")
    return _all_finite(array, "poses")


def _all_finite(array: NDArray[np.float64], name: str) -> Floats:
    """Return the array, or refuse it for its first row that is not finite."""
    finite = np.isfinite(array)
    if not finite.all():  # at once: row by row takes ten times as long
        row = int(np.argmin(finite.all(axis=1)))
        raise ValueError(f"{name} must be finite, got {tuple(array[row].tolist())} in row {row}")
    return array


def _as_floats(values: Any) -> Floats:
    """Return values as an array of floats; a TypeError, ValueError or OverflowError says that they are none."""
    array = np.asarray(values)
    if array.dtype.kind in "USc":
        raise TypeError  # numpy would read "1.5" as a number, and drop the imaginary part of a complex one
    return np.asarray(array, dtype=float)


def as_rng(rng: Any) -> np.random.Generator:
    """Return a random generator from a seed or a generator, or say in one sentence what is wrong.

    >>> as_rng(7).integers(100) == as_rng(7).integers(100)
    np.True_
    """
    try:
        return np.random.default_rng(rng)
    except (TypeError, ValueError):
        raise ValueError(f"rng must be a whole number >= 0 or a numpy Generator, got {short(rng)}") from None


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
    """Return a value as text, cut to the length of a line."""
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."
