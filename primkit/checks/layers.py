"""Layers: the plane through three points, the sphere through four, the k nearest to one; the checks of lesson 11.

In:  the student's ``plane_through(points)``, ``sphere_through(points)`` and ``nearest_to(points, seed, k)``.
Out: answers. The first returns (normal, offset), or None for points in a row; the second (center, radius); the third
     indices in any order. The opposite normal is the same plane, and a sphere that lies nearer to the points is right.

>>> nearest_to(lambda points, seed, k: ...)
○ not attempted: nearest_to still returns `...`.
>>> plane_through.reference(np.array([(1.0, 0, 2), (0, 1, 2), (0, 0, 2)]))
(array([0., 0., 1.]), 2.0)
>>> center, radius = sphere_through.reference(np.vstack([np.eye(3), [(-1, 0, 0)]]))
>>> np.abs(center).round(9).tolist(), round(radius, 9)
([0.0, 0.0, 0.0], 1.0)
>>> nearest_to.reference(np.array([(0.0, 0, 0), (9, 0, 0), (1, 0, 0)]), 2, 1).tolist()
[2, 0]
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from ..arguments import Floats, Ints
from . import judges
from .answer import Check, Fault, off_only_where
from .cases import Args, random_cases
from .judges import is_pair, shown

CLOSE_IN_SPACE = 1e-6  # m, or of a unit vector
NEARER = 1e-6  # of the RMS: far above rounding
TOO_FLAT = 20.0  # times as long as wide: what is flatter hardly fixes a plane, or a sphere

PAIRS = ((0, 1), (0, 2), (1, 2))
Pair = tuple[Floats, float]  # (normal, offset) or (center, radius)


def _pair(got: Any) -> Pair | None:
    """Return a result as three numbers and one more; None for what is something else."""
    if not is_pair(got):
        return None
    try:
        vector, number = np.asarray(got[0], dtype=float), np.asarray(got[1], dtype=float)
    except (TypeError, ValueError):
        return None
    return (vector, float(number)) if vector.shape == (3,) and number.shape == () else None


# --- the plane through three points -------------------------------------------------------------------------------


def plane(three: Floats) -> Pair | None:
    """Return the unit normal and the offset of the plane through three points; None when they lie in a row."""
    a, b, c = three
    normal = np.cross(b - a, c - a)
    length = float(np.linalg.norm(normal))
    return None if length == 0 else (normal / length, float(normal @ a) / length)


def _same_plane(got: Any, expected: Pair | None, _args: Args) -> str | None:
    """Judge a plane by its normal and its offset; both may have the opposite sign."""
    if got is None or expected is None:
        return None if got is expected else f"got {shown(got)}, expected {shown(expected)}{judges.no_return(got)}"
    mine = _pair(got)
    if mine is None:
        return f"got {shown(got)}, expected a pair: the normal, three numbers, and the offset"
    (normal, offset), (n, d) = mine, expected
    length = float(np.linalg.norm(normal))
    if not abs(length - 1) <= CLOSE_IN_SPACE:
        return f"got a normal of length {shown(length)}, expected 1"
    sign = 1 if normal @ n > 0 else -1
    if not np.abs(sign * normal - n).max() <= CLOSE_IN_SPACE:
        return f"got the normal {shown(normal)}, expected {shown(n)}"
    if abs(sign * offset - d) <= CLOSE_IN_SPACE:
        return None
    mine_d, true_d = judges.told_apart(sign * offset, d)
    return f"the normal is right; got the offset {mine_d} m, expected {true_d} m"


def _triples(rng: np.random.Generator) -> Iterator[Args]:
    """Yield planes along the axes, one at a slant, points in a row, then any three points."""
    yield (np.array([(0.0, 0, 0), (1, 0, 0), (0, 1, 0)]),)
    yield (np.array([(1.0, 0, 2), (0, 1, 2), (3, 0, 2)]),)
    yield (np.array([(4.0, 0, 0), (4, 1, 0), (4, 0, 2)]),)
    yield (np.eye(3),)
    yield (np.array([(0.0, 0, 0), (1, 2, 3), (2, 4, 6)]),)  # in a row

    def draw(n: int) -> Args | None:
        if n % 20 == 10:  # whole numbers are exact: in a row to the last bit
            return (rng.integers(-9, 9, 3) + np.outer([0, 1, 3], rng.permutation([1.0, -2.0, 4.0])),)
        points = rng.uniform(-2, 2, (3, 3))
        return (points,) if np.linalg.cond(points[1:] - points[0]) < TOO_FLAT else None

    yield from random_cases(draw)


def _as_wrong(got: Any, wrong: Any, args: Args) -> str | None:
    """Judge by a faulty plane, its normal either way; where points lie in a row, whatever came."""
    mine, other = _pair(got), _pair(wrong)
    if plane(args[0]) is None:
        return None
    if mine is None or other is None:
        return "no plane"
    numbers, faulty = np.append(*mine), np.append(*other)
    same = any(np.allclose(numbers, sign * faulty, equal_nan=True) for sign in (1, -1))
    return None if same else "another plane"


def _faulty_plane(says: str, name: str, *ways: Callable[[Floats, Floats, float], Any]) -> Fault:
    """Return a fault of faulty last steps: of the points, the unit normal, and how long the normal was before."""

    def like(way: Callable[[Floats, Floats, float], Any]) -> Callable[[Floats], Any]:
        def through(three: Floats) -> Any:
            normal = np.cross(three[1] - three[0], three[2] - three[0])
            length = max(float(np.linalg.norm(normal)), np.finfo(float).tiny)
            return way(three, normal / length, length)

        return through

    return Fault(says, like=tuple(map(like, ways)), judge=_as_wrong, name=name)


def _instead(normal: Floats, p: Floats) -> Pair:
    """Return a plane with something else for its normal, made one long."""
    normal = normal / np.linalg.norm(normal)
    return normal, float(normal @ p[0])


plane_through = Check(
    "plane_through",
    plane,
    _triples,
    _same_plane,
    (
        Fault(
            "Every plane is right. Three points in a row fix none: their normal has no length. Return None.",
            when=off_only_where(lambda case: case.expected is None),
            name="points in a row",
        ),
        _faulty_plane(
            "The normal is not one long: divide it by its length, or n . p is no distance.",
            "normal not one long",
            lambda p, n, length: (length * n, length * n @ p[0]),
            lambda p, n, length: (length * n, n @ p[0]),
        ),
        _faulty_plane(
            "The normal is one long, but the offset is not divided by the length.",
            "offset not divided",
            lambda p, n, length: (n, length * n @ p[0]),
        ),
        _faulty_plane(
            "The offset has the wrong sign: here a plane is n . p = d, not n . p + d = 0.",
            "n . p + d = 0",
            lambda p, n, _length: (n, -n @ p[0]),
        ),
        _faulty_plane(
            "The absolute value is too much: with this normal the plane may lie on the other side of the origin.",
            "no sign",
            lambda p, n, _length: (n, abs(n @ p[0])),
            lambda p, n, _length: (-n, abs(n @ p[0])),
        ),
        _faulty_plane(
            "The points themselves are multiplied: take two ways within the plane, from one point to the others.",
            "no differences",
            *(lambda p, *_, i=i, j=j: _instead(np.cross(p[i], p[j]), p) for i, j in PAIRS),
        ),
        _faulty_plane(
            "That is a way within the plane: the normal is at right angles to two such ways, their cross product.",
            "a way within",
            *(lambda p, *_, i=i, j=j: _instead(p[j] - p[i], p) for i, j in PAIRS),
        ),
    ),
)


# --- the sphere through four points, or near to more --------------------------------------------------------------


def sphere(points: Floats) -> Pair:
    """Return the centre and the radius of the sphere of least squares: |p|^2 = 2 c . p + (r^2 - |c|^2) is linear."""
    middle = points.mean(axis=0)
    x = points - middle
    *c, s = np.linalg.lstsq(np.column_stack([2 * x, np.ones(len(x))]), (x**2).sum(axis=1), rcond=None)[0]
    return middle + c, float(np.sqrt(s + np.dot(c, c)))


def rms_of(points: Floats, center: Floats, radius: float) -> float:
    """Return the root of the mean of the squared distances from a sphere, metres."""
    return float(np.sqrt(np.mean((np.linalg.norm(points - center, axis=1) - radius) ** 2)))


def _as_near(got: Any, expected: Pair, args: Args) -> str | None:
    """Judge a sphere: the expected one, or one that lies as near to the points."""
    mine, (center, radius) = _pair(got), expected
    if mine is None:
        return f"got {shown(got)}, expected a pair: the centre, three numbers, and the radius{judges.no_return(got)}"
    if not np.isfinite([*mine[0], mine[1]]).all():
        return f"got {shown(mine)}, expected finite numbers"
    if rms_of(args[0], *mine) <= (1 + NEARER) * rms_of(args[0], center, radius) + CLOSE_IN_SPACE / 10:
        return None
    if abs(mine[1] - radius) > CLOSE_IN_SPACE:
        return f"got a radius of {shown(mine[1])} m, expected {shown(radius)} m ({100 * (mine[1] / radius - 1):+.3g} %)"
    off = 1000 * float(np.linalg.norm(mine[0] - center))
    return None if off <= 1000 * CLOSE_IN_SPACE else f"the radius is right, but the centre is off by {shown(off)} mm"


def _balls(rng: np.random.Generator) -> Iterator[Args]:
    """Yield a ball about the origin, one elsewhere, then four points of any, and more points of one, with noise."""
    ends = np.vstack([np.eye(3), -np.eye(3)])
    yield (0.5 * ends[[0, 1, 2, 3]],)
    yield (0.5 * ends,)
    yield (np.array([1.0, 2, 3]) + 0.5 * ends[[0, 1, 2, 5]],)

    def draw(n: int) -> Args | None:
        ways = rng.normal(size=(4 if n % 2 else int(rng.integers(5, 30)), 3))
        ways /= np.linalg.norm(ways, axis=1)[:, None]
        radius = float(rng.uniform(0.1, 0.5))
        points = rng.uniform(-2, 2, 3) + radius * (1 + (n % 4 == 2) * rng.normal(0, 0.02, (len(ways), 1))) * ways
        return (points,) if np.linalg.cond(points - points.mean(axis=0)) < TOO_FLAT else None

    yield from random_cases(draw)


def _by_numbers(got: Any, wrong: Any, _args: Args) -> str | None:
    """Judge by a faulty sphere's four numbers alone: what lies nearer to the points is no excuse."""
    mine = _pair(got)
    same = mine and np.allclose(np.append(*mine), np.append(*wrong), atol=CLOSE_IN_SPACE, equal_nan=True)
    return None if same else "another sphere"


def _faulty_sphere(says: str, name: str, *ways: Callable[[Floats, Floats, float], Pair]) -> Fault:
    """Return a fault of faulty last steps: of the points, the centre and the radius."""
    like = tuple(lambda points, way=way: way(points, *sphere(points)) for way in ways)
    return Fault(says, like=like, judge=_by_numbers, name=name)


sphere_through = Check(
    "sphere_through",
    sphere,
    _balls,
    _as_near,
    (
        _faulty_sphere(
            "The centre is twice as far out as it is: the equation has 2 c . p in it, not c . p.",
            "2 left out",
            lambda _p, c, r: (2 * c, r),
            lambda _p, c, r: (2 * c, float(np.sqrt(r * r + 3 * c @ c))),
        ),
        _faulty_sphere(
            "The radius is the root of the fourth unknown alone: that is r^2 - |c|^2.",
            "root of s",
            lambda _p, c, r: (c, float(np.sqrt(r * r - c @ c))),
        ),
        _faulty_sphere("That is the radius squared: take the root.", "no root", lambda _p, c, r: (c, r * r)),
        _faulty_sphere("That is the diameter.", "diameter", lambda _p, c, r: (c, 2 * r)),
        _faulty_sphere(
            "That is the middle of the points: where one side alone is seen, it lies beside the centre.",
            "middle of the points",
            lambda p, *_: (p.mean(axis=0), float(np.linalg.norm(p - p.mean(axis=0), axis=1).mean())),
        ),
        _faulty_sphere(
            "The first four points are used, and all others left out: let np.linalg.lstsq take them all.",
            "four of many",
            lambda p, *_: sphere(p[:4]),
        ),
    ),
)


# --- one point and the k nearest to it ----------------------------------------------------------------------------


def nearest(points: Floats, seed: int, k: int) -> Ints:
    """Return the indices of a seed and of the k points nearest to it, shape (k + 1,)."""
    return np.argsort(_away(points, seed), kind="stable")[: k + 1]


def _away(points: Floats, seed: int) -> Floats:
    return np.asarray(np.linalg.norm(points - points[seed], axis=1))


def _chosen(got: Any, expected: Ints, args: Args) -> str | None:
    """Judge indices, in any order."""
    try:
        mine = np.asarray(got)
    except ValueError:
        mine = np.empty((0, 0))
    if mine.ndim != 1 or mine.dtype.kind not in "iu":
        return f"got {shown(got)}, expected the {len(expected)} indices of points{judges.no_return(got)}"
    if len(mine) != len(expected):
        return f"got {len(mine)} indices, expected {len(expected)}: the seed and its {args[2]} nearest"
    missing = set(expected.tolist()) - set(mine.tolist())
    return f"{len(missing)} of the {len(expected)} nearest are missing" if missing else None


def _crowds(rng: np.random.Generator) -> Iterator[Args]:
    """Yield points in a row, points above each other, then any."""
    yield np.array([(0.0, 0, 0), (1, 0, 0), (3, 0, 0), (7, 0, 0)]), 0, 1
    yield np.array([(0.0, 0, 0), (1, 0, 0), (3, 0, 0), (7, 0, 0)]), 2, 2
    yield np.array([(0.0, 0, 0), (0, 0, 5), (1, 0, 0), (2, 2, 0)]), 0, 2
    for _ in random_cases(lambda n: (n,)):
        n = int(rng.integers(8, 40))
        yield rng.uniform(-1, 1, (n, 3)), int(rng.integers(n)), int(rng.integers(1, 6))


def _sorted_by(says: str, name: str, key: Callable[[Floats, int], Floats]) -> Fault:
    """Return the fault of taking the first k + 1 in another order."""
    return Fault(says, like=lambda points, seed, k: np.argsort(key(points, seed), kind="stable")[: k + 1], name=name)


nearest_to = Check(
    "nearest_to",
    nearest,
    _crowds,
    _chosen,
    (
        Fault(
            "The seed itself is left out: it is one of the sample, with its k nearest.",
            like=lambda points, seed, k: nearest(points, seed, k)[1:],
            name="without the seed",
        ),
        Fault(
            "One too few: the nearest of all is the seed itself, so take k + 1.",
            like=lambda points, seed, k: nearest(points, seed, k)[:k],
            name="one too few",
        ),
        _sorted_by(
            "Height is left out: the distance has three coordinates now.",
            "in the plane",
            lambda p, seed: _away(p * [1, 1, 0], seed),
        ),
        _sorted_by(
            "Those are nearest to the origin: measure from the seed.",
            "from the origin",
            lambda p, _seed: np.linalg.norm(p, axis=1),
        ),
        _sorted_by("Those are the farthest: sort the other way.", "farthest", lambda p, seed: -_away(p, seed)),
        _sorted_by(
            "Differences are added up along the axes, which is farther round the corner: square, add, take the root.",
            "along the axes",
            lambda p, seed: np.abs(p - p[seed]).sum(axis=1),
        ),
        _sorted_by(
            "Differences with their signs cancel: square them first.",
            "signs cancel",
            lambda p, seed: np.abs((p - p[seed]).sum(axis=1)),
        ),
    ),
)
