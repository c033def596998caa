"""Proposals: parts laid around stretches of an outline, and fitted.

In a composite each part shows on some stretches of the outline, and hides the rest of itself inside the others. Around
the points of a stretch are laid, by the bearings of the sides of their hull,

1. the circle that fits them best;
2. on each side the smallest rectangle and regular pentagon that hold them;
3. on each two sides the isosceles triangles that hold them; in the style "free", on three a triangle, on five a
   pentagon, on four pentagons with an unseen corner.

Each is fitted for itself: to points near it, while none may lie inside; points far outside belong to other parts.

In:  stretches, the ``Sample`` of all points, and a style.
Out: ``Part``s.

>>> from primkit.shapes import Polygon
>>> ring = Polygon([(0, 0), (0.2, 0), (0.2, 0.1), (0, 0.1)]).outline(100)
>>> parts = laid([Stretch(ring, np.full(100, 0.01))], Sample(ring, 0.0004), "paper")
>>> {(part.kind, *np.sort(part.x[3:]).round(3).tolist()) for part in parts}
{('rectangle', 0.1, 0.2)}
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from ..arguments import Floats
from ..circles import fit_circle
from ..shapes import Kind
from .families import FIFTHS, Part, Style
from .fitting import Sample, cost_of_each, deepened, fitted_each
from .pieces import Piece

QUARTERS_ROUND = np.arange(4) * (np.pi / 2)
LONGEST_RUN, BENT_BACK = 6, 0.003  # pieces; m by which one may lie outside of another's line
SIDES_OF_HULL, MOST_HULL_SIDES = 0.0025, 7  # m by which a corner of a hull stands out; of its sides, the longest count
LEAST_BASE_ANGLE, MOST_BASE_ANGLE = np.radians((20, 78))  # at a triangle's base
FEW_SIDES, UNSEEN_TURNS = 4, np.radians((35, 80, 125, 170, 215, 260, 305))  # so many, and then these beside them
LEAST_TURN_OF_PART = 0.1  # rad by which a side is turned against the one before
CORNER_OUT = 0.2  # of a side's distance from the middle: where an unseen corner is laid
LEAST_LAID_AROUND = 8  # points
NEAR_START, LEAST_NEAR_START = 0.01, 0.6  # m; the share of its stretch that a start is so near to
STARTS_FITTED = 3  # of a kind around a stretch, that are fitted
SPREADS, STEPS_AT = (0.004, 0.0), 4  # m: spreads to fit with, first a rough one; steps at each


@dataclass(frozen=True, eq=False)
class Stretch:
    """Points to lay parts around, shape (M, 2), metres; how far all points lie outside of other parts; a colour."""

    points: Floats
    beside: Floats
    color: int = -1


def runs(pieces: Sequence[Piece]) -> Iterator[Floats]:
    """Yield the points of each run of neighbouring pieces that bends to the left."""
    n = len(pieces)
    for i in range(n):
        for length in range(1, min(LONGEST_RUN, n) + 1):
            run = [pieces[(i + k) % n] for k in range(length)]
            ends = np.array([p for piece in run for p in (piece.begin, piece.end)])
            if max(((ends - piece.begin) @ piece.normal).max() for piece in run) > BENT_BACK:
                break
            yield np.concatenate([np.vstack([piece.begin, piece.points, piece.end]) for piece in run])


def laid(stretches: Iterable[Stretch], sample: Sample, style: Style) -> list[Part]:
    """Return the best parts of each kind around each stretch, fitted."""
    batches: dict[tuple[Kind, int], list[tuple[Floats, Floats]]] = {}
    rough = max(SPREADS[0], sample.spread)
    for stretch in stretches:
        known = replace(sample, spread=rough, beside=stretch.beside)
        for kind, x in starts_around(stretch.points, style):
            parts = Part(kind, x, style, stretch.color)
            near = (np.abs(parts.outside(stretch.points)) <= NEAR_START).mean(axis=1) >= LEAST_NEAR_START
            parts = parts.with_numbers(x[near & parts.sound])
            best = np.argsort(cost_of_each(parts, known), kind="stable")[:STARTS_FITTED]
            batches.setdefault((kind, stretch.color), []).extend((one, stretch.beside) for one in parts.x[best])
    found = []
    for (kind, color), batch in batches.items():
        if batch:
            x, beside = (np.array(some) for some in zip(*batch, strict=True))
            parts = Part(kind, x, style, color)
            for spread in SPREADS:
                known = replace(sample, spread=max(spread, sample.spread), beside=beside)
                parts = deepened(fitted_each(parts, known, STEPS_AT), known)
            found += [parts.with_numbers(one) for one in parts.x]
    return found


def starts_around(points: Floats, style: Style) -> Iterator[tuple[Kind, Floats]]:
    """Yield kinds, and numbers of parts that points lie on or inside of, shape (S, n)."""
    import shapely

    if (circle := fit_circle(points, method="taubin")) is not None:
        yield "circle", np.append(circle.center, circle.radius)[None]
    hull = shapely.MultiPoint(points).convex_hull.simplify(SIDES_OF_HULL)
    if hull.geom_type != "Polygon":
        return
    ring = shapely.get_coordinates(shapely.geometry.polygon.orient(hull).exterior)
    along = np.diff(ring, axis=0)
    longest = np.sort(np.argsort(-np.hypot(*along.T), kind="stable")[:MOST_HULL_SIDES])
    bearings = (np.arctan2(along[:, 1], along[:, 0]) - np.pi / 2)[longest]  # of the sides' outward normals

    def touching(bearings: Floats) -> tuple[Floats, Floats]:
        """Return the lines of these normals that touch the hull: normals, shape (..., 2), and offsets, (...)."""
        normals = np.stack([np.cos(bearings), np.sin(bearings)], axis=-1)
        return normals, (normals @ ring.T).max(axis=-1)

    normals, ends = touching(bearings[:, None] + QUARTERS_ROUND)
    center = ((ends[:, :2] - ends[:, 2:])[..., None] / 2 * normals[:, :2]).sum(axis=1)
    yield "rectangle", np.column_stack([center, bearings, ends[:, :2] + ends[:, 2:]])
    if style == "paper":
        yield "pentagon", _regular_pentagons(bearings, touching(bearings[:, None] + FIFTHS)[1])
        yield "triangle", _isosceles(bearings, touching)
        return
    if len(bearings) <= FEW_SIDES:  # an unseen side may have any bearing
        bearings = np.sort(np.append(bearings, bearings[0] + UNSEEN_TURNS))
    pentagons = []
    for n in (3, 4, 5):
        some = np.array(list(combinations(bearings, n))).reshape(-1, n)
        corners = _meetings(*touching(some))
        if n == 3:
            yield "triangle", corners.reshape(len(corners), 6)
        elif n == 5:
            pentagons.append(corners)
        else:
            for i in range(4):
                middle = (corners[:, i - 1] + corners[:, i]) / 2
                pentagons.append(np.insert(corners, i, middle + CORNER_OUT * (middle - corners.mean(axis=1)), axis=1))
    yield "pentagon", np.concatenate([corners.reshape(len(corners), 10) for corners in pentagons])


def _regular_pentagons(bearings: Floats, ends: Floats) -> Floats:
    """Return those with a side of this bearing that touch three of five lines, offsets of shape (S, 5): (10 S, 4)."""
    three = np.array(list(combinations(range(5), 3)))
    # Of the centre, turned back, and the inner radius:
    lines = np.stack([np.cos(FIFTHS), np.sin(FIFTHS), np.ones(5)], axis=1)
    x, y, inner = np.moveaxis((np.linalg.inv(lines[three]) @ ends[:, three, None])[..., 0], 2, 0)
    turn = np.broadcast_to(bearings[:, None], x.shape)
    c, s = np.cos(turn), np.sin(turn)
    found = [c * x - s * y, s * x + c * y, turn + np.pi / 5, inner / np.cos(np.pi / 5)]
    return np.stack(found, axis=-1).reshape(-1, 4)


def _isosceles(bearings: Floats, touching: Callable[[Floats], tuple[Floats, Floats]]) -> Floats:
    """Return the triangles with two sides alike that have lines of two of these normals as sides, shape (S, 5)."""
    a, b = (some.ravel() for some in np.meshgrid(bearings, bearings))
    turn = (b - a) % (2 * np.pi)  # from one normal to the next
    base = np.concatenate([a, b, a + turn / 2 + np.pi])
    at_base = np.concatenate([np.pi - turn, np.pi - turn, turn / 2])
    ok = (np.tile(turn, 3) < np.pi) & (at_base > LEAST_BASE_ANGLE) & (at_base < MOST_BASE_ANGLE)
    base, at_base = base[ok], at_base[ok]
    normals, ends = touching(base[:, None] + np.array([0, 1, -1]) * (np.pi - at_base)[:, None])
    right, left = ((ends[:, i] + np.cos(at_base) * ends[:, 0]) / np.sin(at_base) for i in (1, 2))
    width, normal = right + left, normals[:, 0]
    middle = ends[:, :1] * normal + (right - left)[:, None] / 2 * np.stack([-normal[:, 1], normal[:, 0]], axis=1)
    return np.column_stack([middle, base + np.pi / 2, width, width / 2 * np.tan(at_base)])


def _meetings(normals: Floats, ends: Floats) -> Floats:
    """Return where lines meet, each with the one before, shape (S, K, 2), of those that close."""
    before, before_ends = np.roll(normals, 1, axis=1), np.roll(ends, 1, axis=1)
    sine = before[..., 0] * normals[..., 1] - before[..., 1] * normals[..., 0]
    ok = (sine > LEAST_TURN_OF_PART).all(axis=1)
    x = before_ends * normals[..., 1] - ends * before[..., 1]
    y = ends * before[..., 0] - before_ends * normals[..., 0]
    return np.stack([x, y], axis=-1)[ok] / sine[ok][..., None]
