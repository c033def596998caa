"""Pieces: the outline of a composite, cut into straight pieces and arcs.

The points are put in their order along the outline (``robust.free``); in that order they are cut so that

    sum of squared distances / spread^2  +  LINE_PRICE or ARC_PRICE for each piece

is the least of all ways, by dynamic programming. Then each point goes to the nearest piece, and each piece is fitted
anew, until nothing moves.

In:  points of one composite, shape (N, 2), metres, around the origin, and how far points spread from outlines.
Out: ``Piece``s, counter-clockwise, each from one junction to the next; ``None`` where the points do not close.

>>> from primkit.parts.composite import Composite
>>> from primkit.shapes import Circle, Polygon
>>> stadium = Composite([Polygon([(0, 0), (0.2, 0), (0.2, 0.1), (0, 0.1)]), Circle((0.2, 0.05), 0.05)])
>>> sorted("arc" if piece.is_arc else "line" for piece in pieces_of(stadium.union.outline(300), 0.0004))
['arc', 'line', 'line', 'line']

Sources: Bellman (1961), "On the approximation of curves by line segments using dynamic programming"; arcs beside lines,
Rosin and West (1989); the circle of a stretch by Kasa (1976), to compare; by Taubin (1991), to keep.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import partial
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ..arguments import Floats, Ints
from ..circles import fit_circle
from ..lines import fit_line
from ..robust.cuts import in_company, moments_between, scatter_sums, squares_of
from ..robust.free import round_order

LINE_PRICE, ARC_PRICE = 18.0, 26.0  # of two numbers and a cut, of three and a cut: each about ln N, and some caution
MOST_CUTS = 400  # cuts lie between two of so many places along the outline
SHORTEST = 0.006  # m: no piece is shorter
LEAST_RADIUS, MOST_RADIUS = 0.02, 0.25  # m of an arc
LEAST_SWEEP = 0.7  # chord of an arc by its radius: a flatter one may be a line
RECUTS = 6
NEIGHBOURS_ASKED = 3  # points that tell the colour of a place
LONGEST_DETOUR = 0.04  # m by which a point may lengthen the way round
SAME_CIRCLE = 0.004  # m between two arcs' centres and radii: they are of one circle
NEAR_JUNCTION = 0.02  # m from where two pieces' points meet to where their lines do


@dataclass(frozen=True, eq=False)
class Piece:
    """A straight piece, or an arc, of an outline.

    Parameters
    ----------
    begin, end : array, shape (2,)
        Its ends, metres; the inside of the outline is on the left.
    points : array, shape (M, 2)
        The points on it, metres.
    center, radius : array, shape (2,), and float
        Of an arc, metres; the radius of a straight piece is 0.
    color : int
        The number of the colour of its points; -1 for unknown.
    """

    begin: Floats
    end: Floats
    points: Floats
    center: Floats = field(default_factory=partial(np.zeros, 2))
    radius: float = 0.0
    color: int = -1

    @property
    def is_arc(self) -> bool:
        """Whether it is an arc, and not straight."""
        return self.radius > 0

    @property
    def normal(self) -> Floats:
        """Unit normal of a straight piece, outwards, shape (2,)."""
        along = (self.end - self.begin) / np.hypot(*(self.end - self.begin))
        return np.array([along[1], -along[0]])

    @property
    def length(self) -> float:
        """From begin to end along the piece, metres."""
        if not self.is_arc:
            return float(np.hypot(*(self.end - self.begin)))
        return self.radius * self._sweep

    @property
    def _sweep(self) -> float:
        """The angle of an arc, radians."""
        first, last = (np.arctan2(*(p - self.center)[::-1]) for p in (self.begin, self.end))
        return float((last - first) % (2 * np.pi)) or 2 * np.pi

    def places(self, step: float = 0.002, inwards: float = 0.0) -> Floats:
        """Return places along the piece, a step or less apart, without its end, shape (K, 2); inside of it [m]."""
        share = np.arange(n := max(1, int(np.ceil(self.length / step))))[:, None] / n
        if not self.is_arc:
            return self.begin + share * (self.end - self.begin) - inwards * self.normal
        bearing = np.arctan2(*(self.begin - self.center)[::-1]) + share[:, 0] * self._sweep
        return self.center + (self.radius - inwards) * np.column_stack([np.cos(bearing), np.sin(bearing)])

    def off_curve(self, points: Floats) -> Floats:
        """Return how far each point is outside the piece's whole line or circle, shape (N,), metres."""
        if not self.is_arc:
            return (points - self.begin) @ self.normal
        return np.hypot(*(points - self.center).T) - self.radius


def pieces_of(points: Floats, spread: float, colors: Ints | None = None) -> list[Piece] | None:
    """Return the pieces of the outline that points lie on, shape (N, 2), metres; None where they do not close.

    With ``colors``, shape (N,), the pieces are cut where the colour changes.
    """
    ordered = _in_order(points, spread)
    if ordered is None:
        return None
    cuts: NDArray[np.intp] = np.array([int((ordered**2).sum(axis=1).argmax())])  # the farthest point is a corner
    for _ in range(2):  # once more, from a cut on the other side
        ordered = np.roll(ordered, -int(cuts[len(cuts) // 2]), axis=0)
        cuts, arcs = _best_cuts(ordered, spread)
    for _ in range(RECUTS):
        pieces = [_fitted(stretch, bool(arc)) for stretch, arc in zip(np.split(ordered, cuts[1:]), arcs, strict=True)]
        moved = [0, *(_better_cut(ordered, pieces[i - 1], pieces[i], cuts, i) for i in range(1, len(cuts)))]
        if moved == cuts.tolist() or np.diff([*moved, len(ordered)]).min() < 3:
            break
        cuts = np.array(moved)
    pieces = _joined(_merged(pieces))
    return pieces if colors is None else _cut_at_colors(pieces, points, colors)


def _in_order(points: Floats, spread: float) -> Floats | None:
    """Return the points in order around the outline; those in narrow corners too, which a path cuts off."""
    ring = round_order(points, spread)
    if ring is None:
        return None
    company = points[in_company(points, spread)]
    left = company[~(company[:, None] == ring).all(axis=2).any(axis=1)]
    while len(left):
        after = np.roll(ring, -1, axis=0)
        there, back = (np.hypot(*(left[:, None] - end).transpose(2, 0, 1)) for end in (ring, after))
        longer = there + back - np.hypot(*(after - ring).T)
        point, place = np.unravel_index(int(longer.argmin()), longer.shape)
        if longer[point, place] > LONGEST_DETOUR:
            break
        ring = np.insert(ring, place + 1, left[point], axis=0)
        left = np.delete(left, point, axis=0)
    return ring


def _best_cuts(ordered: Floats, spread: float) -> tuple[NDArray[np.intp], NDArray[np.bool_]]:
    """Return at which points the best pieces begin, shape (K,), and which of them are arcs."""
    n = min(MOST_CUTS, len(ordered))
    knots = np.arange(n + 1) * len(ordered) // n
    begin, end = ordered[knots[:-1]], ordered[np.append(knots[1:-1], 0)]
    chord = np.hypot(*np.moveaxis(end - begin[:, None], 2, 0))
    straight = np.where(chord >= SHORTEST, squares_of(moments_between(ordered, knots)), np.inf) / spread**2 + LINE_PRICE
    bent = _squares_of_arcs(ordered, knots, chord) / spread**2 + ARC_PRICE
    cost = np.minimum(straight, bent)
    best, before = np.append(0.0, np.full(n, np.inf)), np.zeros(n + 1, dtype=np.intp)  # best[j]: up to knot j
    for j in range(1, n + 1):
        ways = best[:j] + cost[:j, j - 1]
        before[j] = ways.argmin()
        best[j] = ways[before[j]]
    ends = [n]
    while ends[-1] > 0:
        ends.append(int(before[ends[-1]]))
    at = np.array(ends[::-1])
    return knots[at[:-1]], (bent < straight)[at[:-1], at[1:] - 1]


def _squares_of_arcs(ordered: Floats, knots: NDArray[np.intp], chord: Floats) -> Floats:
    """Return the sum of squared distances from Kasa's circle of each stretch; infinite where it is no outward arc."""
    x, y = ordered.T
    z = x * x + y * y
    moments = moments_between(ordered, knots)
    sums = np.zeros((4, len(x) + 1))
    np.cumsum([z, x * z, y * z, z * z], axis=1, out=sums[:, 1:])
    sums = sums[:, knots]
    sz, sxz, syz, szz = sums[:, None, :-1] - sums[:, 1:, None]
    n, sx, sy, *_ = moments
    many = np.maximum(n, 1.0)
    xx, yy, xy = scatter_sums(moments)
    xz, yz, zz = sxz - sx * sz / many, syz - sy * sz / many, szz - sz**2 / many
    with np.errstate(divide="ignore", invalid="ignore"):
        det = xx * yy - xy**2
        a, b = (xz * yy - yz * xy) / (2 * det), (yz * xx - xz * xy) / (2 * det)  # the centre
        squared = sz / many - 2 * (a * sx + b * sy) / many + a**2 + b**2  # of the radius
        squares = np.maximum(zz - 2 * (a * xz + b * yz), 0.0) / (4 * squared)
        radius = np.sqrt(squared)
        first, middle = ordered[knots[:-1]], ordered[(knots[:-1, None] + np.append(knots[1:-1], len(x))) // 2 % len(x)]
        left = (first[:, None, 0] - a) * (middle[..., 1] - b) - (first[:, None, 1] - b) * (middle[..., 0] - a) > 0
        sound = (n >= 6) & (radius >= LEAST_RADIUS) & (radius <= MOST_RADIUS) & left & (chord >= LEAST_SWEEP * radius)
    return np.where(sound, squares, np.inf)


def _fitted(points: Floats, arc: bool) -> Piece:
    """Return the line or circle through points in order, shape (M, 2); its ends are still rough."""
    if arc and (circle := fit_circle(points, method="taubin")) is not None:
        return Piece(points[0], points[-1], points, circle.center, circle.radius)
    line = fit_line(points)
    chord = points[-1] - points[0]
    if line is None:
        return Piece(points[0], points[-1], points)
    along = np.array([-line.normal[1], line.normal[0]])
    along *= np.sign(along @ chord) or 1.0
    middle = points.mean(axis=0)
    t = (points - middle) @ along
    return Piece(middle + t.min() * along, middle + t.max() * along, points)


def _better_cut(ordered: Floats, a: Piece, b: Piece, cuts: NDArray[np.intp], i: int) -> int:
    """Return where the points of piece b, the i-th, begin: half of a neighbour's points can change over, no more."""
    first, last = cuts[i] - len(a.points) // 2, cuts[i] + len(b.points) // 2
    some = ordered[first:last]
    left, right = (piece.off_curve(some) ** 2 for piece in (a, b))
    cost = np.append(0.0, np.cumsum(left)) + np.append(np.cumsum(right[::-1])[::-1], 0.0)
    return int(first + cost.argmin())


def _merged(pieces: list[Piece]) -> list[Piece]:
    """Return the pieces with neighbouring arcs of one circle as one arc."""
    i = 0
    while len(pieces) > 1 and i < len(pieces):
        a, b = pieces[i - 1], pieces[i]
        if a.is_arc and b.is_arc:
            apart = max(float(np.hypot(*(a.center - b.center))), abs(a.radius - b.radius))
            both = _fitted(np.concatenate([a.points, b.points]), arc=True)
            if apart <= SAME_CIRCLE:
                pieces[i - 1] = both
                del pieces[i]
                continue
        i += 1
    return pieces


def _joined(pieces: list[Piece]) -> list[Piece]:
    """Return the pieces, each from where it meets the one before to where it meets the one after, if that is near."""
    junctions = [_junction(pieces[i - 1], piece) for i, piece in enumerate(pieces)]
    return [
        replace(piece, begin=piece.begin if first is None else first, end=piece.end if last is None else last)
        for piece, first, last in zip(pieces, junctions, junctions[1:] + junctions[:1], strict=True)
    ]


def _junction(a: Piece, b: Piece) -> Floats | None:
    """Return where the lines or circles of two pieces meet, if that is near the points of both."""
    meeting = _meetings(a, b)
    far = np.maximum(np.hypot(*(meeting - a.end).T), np.hypot(*(meeting - b.begin).T))
    return meeting[far.argmin()] if len(far) and far.min() <= NEAR_JUNCTION else None


def _meetings(a: Piece, b: Piece) -> Floats:
    """Return where two lines, a line and a circle, or two circles meet, shape (0 to 2, 2), metres."""
    if a.is_arc and b.is_arc:
        across = b.center - a.center
        apart = max(float(np.hypot(*across)), 1e-9)
        normal, offset = across / apart, (a.radius**2 - b.radius**2 + b.center @ b.center - a.center @ a.center) / 2
        return _line_and_circle(normal, float(offset / apart), a)
    if a.is_arc:
        a, b = b, a
    normal = a.normal
    if b.is_arc:
        return _line_and_circle(normal, float(normal @ a.begin), b)
    sine = normal[0] * b.normal[1] - normal[1] * b.normal[0]
    if abs(sine) < 0.05:
        return np.empty((0, 2))
    return np.linalg.solve(np.array([normal, b.normal]), [normal @ a.begin, b.normal @ b.begin])[None]


def _line_and_circle(normal: Floats, offset: float, arc: Piece) -> Floats:
    """Return where the line normal . p = offset meets an arc's circle; its nearest place to the centre if it misses."""
    off = offset - normal @ arc.center
    half = np.sqrt(np.maximum(arc.radius**2 - off**2, 0.0))
    along = np.array([-normal[1], normal[0]])
    return arc.center + off * normal + np.array([[-half], [half]]) * along


def _cut_at_colors(pieces: list[Piece], points: Floats, colors: Ints) -> list[Piece]:
    """Return the pieces cut where the colour of the nearest points changes."""
    from scipy.spatial import cKDTree

    known = colors >= 0
    if not known.any():
        return pieces
    tree, found = cKDTree(points[known]), []
    for piece in pieces:
        places = np.vstack([piece.places(0.001), piece.end])
        of_places = _most_common(colors[known][tree.query(places, min(NEIGHBOURS_ASKED, int(known.sum())))[1]])
        cuts = [0, *(np.flatnonzero(np.diff(of_places)) + 1).tolist(), len(places)]
        nearest = cKDTree(places).query(piece.points)[1]
        for first, last in pairwise(cuts):
            mine = piece.points[(nearest >= first) & (nearest < last)]
            if len(mine) >= 3:
                begin, end = places[first], places[min(last, len(places) - 1)]
                found.append(replace(piece, begin=begin, end=end, points=mine, color=int(of_places[first])))
    return found


def _most_common(rows: Ints) -> Ints:
    """Return the most common number of each row, shape (R, K) -> (R,)."""
    rows = np.atleast_2d(rows.T).T.astype(np.intp, copy=False)
    return np.array([np.bincount(row).argmax() for row in rows])
