"""Proposals: every part that lies in an outline and shows on it.

A part of a union can hide some of its sides, never cross the outline: **no place of the outline lies inside it**. So

1. a circle is proposed for each arc;
2. from two straight pieces a rectangle, a regular pentagon and an isosceles triangle, in each way in which the pieces
   can be their sides; what is not fixed by the two grows until a place of the outline is in the way;
3. in the style "free", triangles and pentagons on pieces that together bend one way, closed by unseen sides.

In:  the ``Piece``s of an outline, how near is near, metres, and a style.
Out: ``Part``s.

>>> from primkit.parts.pieces import Piece
>>> corners = np.array([(0, 0), (0.2, 0), (0.2, 0.1), (0, 0.1)])
>>> sides = [Piece(a, b, np.array([a, b])) for a, b in zip(corners, np.roll(corners, -1, axis=0))]
>>> {part.kind for part in proposals(sides, 0.002)} >= {"rectangle"}
True
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import combinations

import numpy as np

from ..arguments import Floats
from .families import FIFTHS, Part, Style
from .pieces import Piece

QUARTER_TURN, FIFTH = np.pi / 2, 2 * np.pi / 5
OFF_ANGLE = 0.08  # rad by which two long pieces may miss an angle
SHORT_PIECE = 0.0025  # m: the ends of a piece may lie off by this, so that short ones tell their direction less well
LEAST_BASE_ANGLE, MOST_BASE_ANGLE = np.radians(18), np.radians(80)  # at a triangle's base
LARGEST_PART = 0.4  # m: no part is proposed larger
CORNER_PLACES, DEEP_IN_CORNER = 6, 0.01  # so many places, 2 mm apart, may lie inside, by so many metres
STAIRS = 6  # ways to let a rectangle's two free sides grow


def proposals(pieces: Sequence[Piece], near: float, style: Style = "paper", color: int = -1) -> list[Part]:
    """Return all parts that lie in the outline, to ``near`` metres, and have pieces of it on theirs.

    Of a colour, only pieces of this colour can be on them; those of others are in the way already where they touch.
    """
    own = [piece for piece in pieces if color < 0 or piece.color in (-1, color)]
    in_the_way = [piece.places(inwards=0.0 if piece in own else 2.5 * near) for piece in pieces]
    pieces, places = own, np.concatenate(in_the_way)
    straight = [piece for piece in pieces if not piece.is_arc and piece.length > 0.004]
    found = [Part("circle", np.append(piece.center, piece.radius), style) for piece in pieces if piece.is_arc]
    for a in straight:
        for b in straight:
            if a is not b:
                found += _rectangles(a, b, places, near, style)
                if style == "paper":
                    found += _pentagons(a, b, places, near)
                    found += _triangles(a, b, places, near)
    if style == "free":
        found += _free(straight, places, near)
    return [replace(part, color=color) for part in found if part.sound and _lies_in(part, places, near)]


def _lies_in(part: Part, places: Floats, near: float) -> bool:
    """Tell whether no place lies inside a part; but for a few in a corner where two pieces seem to meet."""
    deep = -np.partition(part.outside(places), (0, CORNER_PLACES))[[0, CORNER_PLACES]]
    return bool(deep[0] <= DEEP_IN_CORNER and deep[1] <= 1.5 * near)


def _normal_at(angle: float) -> Floats:
    return np.array([np.cos(angle), np.sin(angle)])


def _turn(a: Piece, b: Piece) -> float:
    """Return by which angle b's normal is turned against a's, radians in (-pi, pi]."""
    n, m = a.normal, b.normal
    return float(np.arctan2(n[0] * m[1] - n[1] * m[0], n @ m))


def _slack(a: Piece, b: Piece) -> float:
    """Return how far, in radians, two pieces may miss an angle."""
    return OFF_ANGLE + SHORT_PIECE / a.length + SHORT_PIECE / b.length


def _bearing(a: Piece, b: Piece, apart: float) -> float:
    """Return the bearing of a's normal, if b's is turned by ``apart`` against it: the longer piece tells more."""
    off = _turn(a, b) - apart
    off = (off + np.pi) % (2 * np.pi) - np.pi
    return float(np.arctan2(*a.normal[::-1]) + off * b.length**3 / (a.length**3 + b.length**3))


def _offset(piece: Piece, normal: Floats) -> float:
    """Return where a line of this normal through the middle of a piece lies."""
    return float(normal @ piece.points.mean(axis=0))


def _rectangles(a: Piece, b: Piece, places: Floats, near: float, style: Style) -> Iterator[Part]:
    """Yield rectangles of which a and b are neighbouring sides, or opposite ones."""
    turn = _turn(a, b)
    if abs(turn - QUARTER_TURN) < _slack(a, b):
        bearing = _bearing(a, b, QUARTER_TURN)
        n, m = _normal_at(bearing), _normal_at(bearing + QUARTER_TURN)
        da, db = _offset(a, n), _offset(b, m)
        deep, wide = da - places @ n, db - places @ m  # how far inside of either line
        for depth, width in _stairs(deep, wide, near):
            center = (da - depth / 2) * n + (db - width / 2) * m
            yield Part("rectangle", np.array([*center, bearing, depth, width]), style)
    elif abs(abs(turn) - np.pi) < _slack(a, b):
        bearing = _bearing(a, b, np.pi)
        n, m = _normal_at(bearing), _normal_at(bearing + QUARTER_TURN)
        da, db = _offset(a, n), -_offset(b, -n)
        if da - db < 0.01:
            return
        both = np.concatenate([a.points, b.points]) @ m
        within = (places @ n < da - near) & (places @ n > db + near)
        along, middle = (places @ m)[within], (both.min() + both.max()) / 2
        low = along[along < middle].max(initial=both.min() - LARGEST_PART)
        high = along[along >= middle].min(initial=both.max() + LARGEST_PART)
        center = (da + db) / 2 * n + (low + high) / 2 * m
        yield Part("rectangle", np.array([*center, bearing, da - db, high - low]), style)


def _stairs(deep: Floats, wide: Floats, near: float) -> Iterator[tuple[float, float]]:
    """Yield how deep and wide rectangles in a corner can grow: where the one has to stop depends on the other."""
    inside = (deep > near) & (wide > near)
    deep, wide = deep[inside], wide[inside]
    if len(deep) == 0:
        return
    order = np.argsort(deep)
    deep, least = deep[order], np.minimum.accumulate(wide[order])
    steps = np.flatnonzero(np.diff(least, prepend=np.inf) < 0)  # the corners of the staircase
    depths, widths = deep[steps], least[steps]
    most = np.argsort(np.diff(widths) - np.diff(depths), kind="stable")[:STAIRS]  # a slanted flight has many low steps
    yield from zip(depths[most + 1].tolist(), widths[most].tolist(), strict=True)


def _pentagons(a: Piece, b: Piece, places: Floats, near: float) -> Iterator[Part]:
    """Yield the largest regular pentagon of which a and b are two sides."""
    turn = _turn(a, b)
    for k in (1, 2):
        if abs(turn - k * FIFTH) >= _slack(a, b):
            continue
        bearing = _bearing(a, b, k * FIFTH)
        normals = np.stack([_normal_at(bearing + fifth) for fifth in FIFTHS])
        two = normals[[0, k]]
        ends = np.array([_offset(a, two[0]), _offset(b, two[1])])
        start, shift = np.linalg.solve(two, ends), np.linalg.solve(two, -np.ones(2))  # the centre is start + rho shift
        # a place is inside if  n . (q - start) - rho (n . shift + 1) < -near  for all five normals
        height, rate = (places - start) @ normals.T + near, normals @ shift + 1
        rho = np.arange(0.02, 0.15, 0.001)
        inside = (height[:, None] < rho[:, None] * rate).all(axis=2).any(axis=0)
        if (~inside).any():
            first = np.flatnonzero(~inside)
            best = rho[first[np.append(np.diff(first) > 1, True)][0]]  # the end of the first free stretch
            radius = best / np.cos(np.pi / 5)
            yield Part("pentagon", np.array([*(start + best * shift), bearing + np.pi / 5, radius]))


def _triangles(a: Piece, b: Piece, places: Floats, near: float) -> Iterator[Part]:
    """Yield the largest isosceles triangles of which a and b are two sides: base and leg, leg and base, both legs."""
    turn = _turn(a, b)
    if turn <= 0:
        return
    first = np.arctan2(*a.normal[::-1])
    for base, third in ((0, -turn), (1, 2 * turn), (2, (turn + 2 * np.pi) / 2)):
        angles = np.array([first, first + turn, first + third])
        normals = np.stack([np.cos(angles), np.sin(angles)], axis=1)
        at_base = np.pi - (turn if base < 2 else (2 * np.pi - turn) / 2)
        if not LEAST_BASE_ANGLE < at_base < MOST_BASE_ANGLE:
            continue
        ends = np.array([_offset(a, normals[0]), _offset(b, normals[1])])
        inside = (places @ normals[:2].T < ends - near).all(axis=1)
        if not inside.any():
            continue
        reach = (places[inside] @ normals[2]).min()
        yield _isosceles(normals, np.append(ends, reach), base)


def _isosceles(normals: Floats, ends: Floats, base: int) -> Part:
    """Return the triangle between three lines, of which one is the base."""
    legs = [i for i in range(3) if i != base]
    apex = np.linalg.solve(normals[legs], ends[legs])
    corners = [np.linalg.solve(normals[[base, leg]], ends[[base, leg]]) for leg in legs]
    bearing = np.arctan2(*normals[base][::-1]) + QUARTER_TURN  # the base runs a quarter turn on from its outward normal
    middle = (corners[0] + corners[1]) / 2
    width, height = np.hypot(*(corners[0] - corners[1])), ends[base] - normals[base] @ apex
    return Part("triangle", np.array([*middle, bearing, width, height]))


# --- the style "free" ------------------------------------------------------------------------------------------------


def _free(straight: Sequence[Piece], places: Floats, near: float) -> Iterator[Part]:
    """Yield triangles and pentagons on sets of pieces that bend one way and have the outline outside of them."""
    sides = _with_cuts(straight, near)
    fits = np.array([[_together((a, b), places, near) for b in sides] for a in sides])
    sets: list[tuple[int, ...]] = [(i,) for i in range(len(sides))]
    while sets:
        longer: list[tuple[int, ...]] = []
        for some in sets:
            chosen = [sides[i] for i in some]
            if len(some) >= 2 and _together(chosen, places, near):
                yield from _closed(chosen)
            elif len(some) >= 2:
                continue
            if len(some) < 5:
                longer += [(*some, j) for j in range(some[-1] + 1, len(sides)) if all(fits[i, j] for i in some)]
        sets = longer


def _with_cuts(straight: Sequence[Piece], near: float) -> list[Piece]:
    """Return the pieces, and the parts of those that the line of another one cuts: two parts may share a line."""
    sides = list(straight)
    for piece in straight:
        along = (piece.end - piece.begin) / piece.length
        cuts = []
        for other in straight:
            sine = other.normal @ along
            if other is not piece and abs(sine) > 0.2:
                t = other.normal @ (other.begin - piece.begin) / sine
                if 0.01 < t < piece.length - 0.01:
                    cuts.append(t)
        for t in cuts:
            middle = piece.begin + t * along
            for begin, end in ((piece.begin, middle), (middle, piece.end)):
                lies = (piece.points - begin) @ along
                some = piece.points[(lies >= -near) & (lies <= np.hypot(*(end - begin)) + near)]
                if len(some) >= 2:
                    sides.append(Piece(begin, end, some))
    return sides


def _together(sides: Sequence[Piece], places: Floats, near: float) -> bool:
    """Tell whether pieces can be sides of one convex part: each inside the others' lines, nothing inside their hull."""
    import shapely

    ends = np.array([p for side in sides for p in (side.begin, side.end)])
    for side in sides:
        if ((ends - side.begin) @ side.normal).max() > near:
            return False
    turns = [abs(_turn(a, b)) for a, b in combinations(sides, 2)]
    if min(turns, default=1.0) < 0.12:
        return False
    hull = shapely.MultiPoint(ends).convex_hull.buffer(-near)
    return not (hull.area > 0 and shapely.contains_xy(hull, places).any())


def _closed(sides: Sequence[Piece]) -> Iterator[Part]:
    """Yield a triangle, and pentagons, that have the pieces on their sides, and as many unseen sides as it takes."""
    sides = sorted(sides, key=lambda side: np.arctan2(*side.normal[::-1]))
    n = len(sides)
    meets = [_meet(sides[i], sides[(i + 1) % n]) for i in range(n)]
    gaps = [[sides[i].end, sides[(i + 1) % n].begin] for i in range(n)]

    def ring(opened: dict[int, list[Floats]]) -> Floats | None:
        corners = []
        for i in range(n):
            if i in opened:
                corners += opened[i]
            elif (corner := meets[i]) is None:
                return None
            else:
                corners.append(corner)
        return np.array(corners)

    ways: list[tuple[str, dict[int, list[Floats]]]] = []
    if n == 3:
        ways.append(("triangle", {}))
        ways += [("pentagon", {i: gaps[i], j: gaps[j]}) for i, j in combinations(range(3), 2)]
        middle = np.mean([p for side in sides for p in (side.begin, side.end)], axis=0)
        for i, (a, b) in enumerate(gaps):
            out = (a + b) / 2 + 0.15 * ((a + b) / 2 - middle)
            ways.append(("pentagon", {i: [a, out, b]}))
    elif n == 2:
        ways += [("triangle", {i: gaps[i]}) for i in range(2)]
    elif n == 4:
        ways += [("pentagon", {i: gaps[i]}) for i in range(4)]
    elif n == 5:
        ways.append(("pentagon", {}))
    for kind, opened in ways:
        corners = ring(opened)
        if corners is not None:
            yield Part(kind, corners.ravel(), "free")  # type: ignore[arg-type]


def _meet(a: Piece, b: Piece) -> Floats | None:
    """Return where two pieces' lines meet, if b bends to the left of a."""
    if _turn(a, b) < 0.1:
        return None
    corner = np.linalg.solve(np.array([a.normal, b.normal]), [a.normal @ a.begin, b.normal @ b.begin])
    return corner if np.hypot(*(corner - a.end)) < LARGEST_PART else None
