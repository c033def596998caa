"""Judges: is a result right, whatever the algorithm? They look at the geometry, with a tolerance.

In:  a result, what is expected, and the arguments it was asked for with.
Out: None when it is right; else what is off, in a few words.

>>> number("m")(0.25, 0.25 + 1e-12, ())
>>> number("m")(0.5, 0.25, ())
'got 0.5 m, expected 0.25 m'
>>> groups()([1, 1, 0], [0, 0, 1], ())
>>> points_in_any_order()([(1, 0), (0, 0)], [(0, 0), (1, 0)], ())
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..shapes import Circle, Polygon

Judge = Callable[[Any, Any, tuple[Any, ...]], "str | None"]

CLOSE = 1e-9  # metres or none: far above rounding, far below any real difference


def number(unit: str = "", tolerance: float = CLOSE) -> Judge:
    """Judge one number; infinite is right only where infinite is expected."""
    behind = f" {unit}" if unit else ""

    def judge(got: Any, expected: Any, _args: tuple[Any, ...]) -> str | None:
        value = _floats(got)
        if value is None or value.shape != ():
            return f"got {shown(got)}, expected a number such as {shown(expected)}{behind}{no_return(got)}"
        if _close(value, np.asarray(expected, dtype=float), tolerance):
            return None
        mine, theirs = told_apart(float(value), expected)
        return f"got {mine}{behind}, expected {theirs}{behind}"

    return judge


def array(unit: str = "", tolerance: float = CLOSE) -> Judge:
    """Judge an array of numbers: its shape, then its values."""
    behind = f" {unit}" if unit else ""

    def judge(got: Any, expected: Any, _args: tuple[Any, ...]) -> str | None:
        values, wanted = _floats(got), np.asarray(expected, dtype=float)
        if values is None:
            return f"got {shown(got)}, expected numbers in an array of shape {wanted.shape}{no_return(got)}"
        if values.shape != wanted.shape:
            return f"got an array of shape {values.shape}, expected shape {wanted.shape}"
        if _close(values, wanted, tolerance):
            return None
        with np.errstate(invalid="ignore"):  # inf - inf: both right
            error = np.abs(values - wanted)
        worst = np.unravel_index(
            np.argmax(np.where(values == wanted, 0.0, np.nan_to_num(error, nan=np.inf))), values.shape
        )
        place = f" at {list(map(int, worst))}" if worst else ""
        mine, theirs = told_apart(float(values[worst]), float(wanted[worst]))
        return f"got {mine}{behind}{place}, expected {theirs}{behind}"

    return judge


def groups() -> Judge:
    """Judge labels: the same points together, whatever the numbers; a negative label is a stray."""

    def judge(got: Any, expected: Any, _args: tuple[Any, ...]) -> str | None:
        labels, wanted = _floats(got), np.asarray(expected)
        if labels is None or labels.shape != wanted.shape:
            found = shown(got) if labels is None else f"an array of shape {labels.shape}"
            return f"got {found}, expected one label for each of the {len(wanted)} points{no_return(got)}"
        if not np.array_equal(labels < 0, wanted < 0):
            return f"got {int((labels < 0).sum())} strays, expected {int((wanted < 0).sum())}"
        pairs = {(a, b) for a, b in zip(labels.tolist(), wanted.tolist(), strict=True) if b >= 0}
        n, m = len({a for a, _ in pairs}), len({b for _, b in pairs})
        if len(pairs) == n == m:
            return None
        if n != m:
            return f"got {n} groups, expected {m}"
        return f"the number of groups is right ({m}), but not every point is with its own"

    return judge


def marks(of: str, called: str) -> Judge:
    """Judge True or False for each of some ``of``, which are ``called`` something where it is True."""

    def judge(got: Any, expected: Any, _args: tuple[Any, ...]) -> str | None:
        mine = as_marks(got, len(expected))
        if mine is None:
            return f"got {shown(got)}, expected True or False for each of the {len(expected)} {of}{no_return(got)}"
        extra, missing = int((mine & ~expected).sum()), int((~mine & expected).sum())
        return f"{extra} {of} too many are {called}, and {missing} too few" if extra or missing else None

    return judge


def points_in_any_order(unit: str = "m", tolerance: float = 1e-6) -> Judge:
    """Judge points, shape (K, 2), such as corners, in any order."""

    def judge(got: Any, expected: Any, _args: tuple[Any, ...]) -> str | None:
        from scipy.optimize import linear_sum_assignment

        points, wanted = _floats(got), np.asarray(expected, dtype=float)
        if points is None or points.ndim != 2 or points.shape[1] != 2:
            return f"got {shown(got)}, expected points in an array of shape {wanted.shape}{no_return(got)}"
        if len(points) != len(wanted):
            return f"got {len(points)} points, expected {len(wanted)}"
        if not np.isfinite(points).all():
            return f"got {shown(points)}, expected finite numbers"
        apart = np.linalg.norm(points[:, None] - wanted, axis=2)
        mine, theirs = linear_sum_assignment(apart)
        worst = int(np.argmax(apart[mine, theirs]))
        if apart[mine[worst], theirs[worst]] <= tolerance:
            return None
        pair = shown(points[mine[worst]]), shown(wanted[theirs[worst]])
        far = f", {shown(float(apart[mine[worst], theirs[worst]]))} {unit} away" * (pair[0] == pair[1])
        return f"got {pair[0]} {unit}, expected {pair[1]} {unit}{far}"

    return judge


def circle(tolerance: float = 1e-6) -> Judge:
    """Judge a circle: a ``Circle``, (x, y, radius) or ((x, y), radius), each within ``tolerance`` metres."""

    def judge(got: Any, expected: Any, _args: tuple[Any, ...]) -> str | None:
        mine, (x, y, r) = as_circle(got), as_circle(expected) or (0.0, 0.0, 0.0)
        if expected is None or got is None:
            return None if got is expected else f"got {shown(got)}, expected {shown(expected)}{no_return(got)}"
        if mine is None:
            return f"got {shown(got)}, expected a circle: its x, y and radius in metres"
        if not np.isfinite(mine).all():
            return f"got {shown(mine)}, expected finite numbers"
        if abs(mine[2] - r) > tolerance:
            share = 100 * (mine[2] - r) / r
            return f"got a radius of {shown(mine[2])} m, expected {shown(r)} m ({share:+.3g} %)"
        off = float(np.hypot(mine[0] - x, mine[1] - y))
        return None if off <= tolerance else f"the centre is off by {shown(1000 * off)} mm"

    return judge


def line(tolerance: float = 1e-6) -> Judge:
    """Judge a line: a ``Line`` or (angle, offset) of ``n . p = d``; the opposite normal is the same line."""

    def judge(got: Any, expected: Any, _args: tuple[Any, ...]) -> str | None:
        mine, wanted = as_line(got), as_line(expected)
        if wanted is None or got is None:
            return None if got is expected else f"got {shown(got)}, expected {shown(expected)}{no_return(got)}"
        if mine is None:
            return f"got {shown(got)}, expected a line: the angle of its normal and its offset"
        turn = float(np.remainder(mine[0] - wanted[0] + np.pi / 2, np.pi) - np.pi / 2)  # of undirected normals
        if not abs(turn) <= tolerance:
            return f"the line is turned by {shown(float(np.degrees(turn)))} degrees"
        same_way = np.cos(mine[0] - wanted[0]) > 0
        off = abs((mine[1] if same_way else -mine[1]) - wanted[1])
        return None if off <= tolerance else f"the line has the right direction, but is off by {shown(1000 * off)} mm"

    return judge


def pose(tolerance: float = CLOSE) -> Judge:
    """Judge a pose: x and y in metres, and a heading up to whole turns."""
    as_array = array()

    def judge(got: Any, expected: Any, args: tuple[Any, ...]) -> str | None:
        values = _floats(got)
        if values is None or values.shape != (3,) or not np.isfinite(values).all():
            return as_array(got, expected, args)
        values = values - [0.0, 0.0, 2 * np.pi * np.round((values[2] - expected[2]) / (2 * np.pi))]
        worst = int(np.argmax(np.abs(values - expected)))
        if abs(values[worst] - expected[worst]) <= tolerance:
            return None
        mine, wanted = told_apart(float(values[worst]), float(expected[worst]))
        name, unit = (("x", "m"), ("y", "m"), ("heading", "rad"))[worst]
        return f"{name}: got {mine} {unit}, expected {wanted} {unit}"

    return judge


def as_marks(value: Any, n: int) -> NDArray[np.bool_] | None:
    """Return a result as n times True or False; None for what is something else."""
    try:
        found = np.asarray(value)
    except ValueError:
        return None
    return found.astype(bool) if found.shape == (n,) and (found.dtype == bool or n == 0) else None


def as_circle(value: Any) -> tuple[float, float, float] | None:
    """Return (x, y, radius) of anything that is a circle; None for what is none."""
    if isinstance(value, Circle):
        return (*value.center.tolist(), value.radius)
    if is_pair(value):  # ((x, y), radius)
        center = _floats(value[0])
        value = (*center, value[1]) if center is not None and center.shape == (2,) else None
    numbers = _floats(value)
    return None if numbers is None or numbers.shape != (3,) else tuple(numbers.tolist())


def as_line(value: Any) -> tuple[float, float] | None:
    """Return (angle, offset) of anything that is a line; None for what is none."""
    if hasattr(value, "angle") and hasattr(value, "offset"):
        return float(value.angle), float(value.offset)
    numbers = _floats(value)
    return None if numbers is None or numbers.shape != (2,) else tuple(numbers.tolist())


def is_pair(value: Any) -> bool:
    """Tell whether a result is two things."""
    return isinstance(value, (tuple, list)) and len(value) == 2


def same(a: Any, b: Any) -> bool:
    """Tell whether two arguments are the same to the last bit; generators and the like are taken to be."""
    if isinstance(a, np.ndarray) and isinstance(b, np.ndarray):
        return np.array_equal(a, b, equal_nan=a.dtype.kind == "f")
    if isinstance(a, (tuple, list)) and isinstance(b, (tuple, list)):
        return len(a) == len(b) and all(map(same, a, b))
    if isinstance(a, (int, float, str, set)):
        return bool(a == b)
    if hasattr(a, "__dict__"):  # what was worked out meanwhile is no change
        return all(same(value, vars(b)[name]) for name, value in vars(a).items() if name in vars(b))
    return True


def shown(value: Any) -> str:
    """Return a value as a student would write it, with four digits, and cut to a line.

    >>> shown(np.array([0.1, 1 / 3])), shown(np.pi), shown(np.arange(100))
    ('(0.1, 0.3333)', '3.142', 'array of shape (100,)')
    >>> shown({(3, 3), (2, 0)}), shown(set())
    ('{(2, 0), (3, 3)}', 'set()')
    """
    if isinstance(value, np.ndarray) and value.size > 12:
        return f"array of shape {value.shape}"
    if isinstance(value, np.ndarray):
        return shown(value.tolist()) if value.ndim != 1 else shown(tuple(value.tolist()))
    if isinstance(value, (tuple, list)):
        inner = ", ".join(map(shown, value))
        text = f"[{inner}]" if isinstance(value, list) else f"({inner})"
    elif isinstance(value, (set, frozenset)):
        text = f"{{{', '.join(sorted(map(shown, value)))}}}" if value else "set()"
    elif isinstance(value, (float, np.floating)):
        return f"{float(value) + 0.0:.4g}"  # -0.0 as the 0 that it means
    elif isinstance(value, (int, np.integer)) or value is None:
        return str(value)
    elif isinstance(value, Polygon):
        text = f"{value.kind} at {shown(np.round(value.centroid, 9))}"
    else:
        text = repr(value) if isinstance(value, (str, Circle)) else f"a {type(value).__name__}"
    return text if len(text) <= 90 else text[:87] + "..."


def told_apart(got: float, expected: float) -> tuple[str, str]:
    """Return two numbers with four digits, or with as many as it takes to see that they differ.

    >>> told_apart(0.5, 0.25), told_apart(0.27080, 0.27084)
    (('0.5', '0.25'), ('0.2708', '0.27084'))
    """
    pair = shown(got), shown(expected)
    for digits in range(5, 18):
        if pair[0] != pair[1]:
            break
        pair = f"{got:.{digits}g}", f"{expected:.{digits}g}"
    return pair


def _floats(value: Any) -> NDArray[np.float64] | None:
    """Return a value as floats; None for what is no number or array of numbers."""
    try:
        found = np.asarray(value)
    except (TypeError, ValueError):
        return None
    return found.astype(float) if found.dtype.kind in "iuf" else None


def _close(a: NDArray[np.float64], b: NDArray[np.float64], tolerance: float) -> bool:
    return bool(np.allclose(a, b, rtol=0.0, atol=tolerance, equal_nan=True))  # only a faulty way expects nan


def no_return(got: Any) -> str:
    """Return the usual reason for None."""
    return " (is there a return?)" if got is None else ""
