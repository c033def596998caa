"""Cuts: points in their order along an outline, cut into straight pieces in the best of all ways.

Points around a middle have an order: their bearings. In that order each side is one stretch, and a polygon is a choice
of cuts between stretches. All choices are compared, none is drawn at random: the sums of squares of all stretches come
from running sums, and the best k of them from the best k - 1, which is dynamic programming. Where neighbours lie far
apart, a stretch of the outline was not seen: a chord spans it.

In:  points of one cluster, shape (N, 2), metres, around the origin.
Out: a ``Cut`` for each number of pieces: the pieces' lines, and how well they fit; and the chords.

>>> from primkit.shapes import Polygon
>>> ring = Polygon([(-0.1, -0.1), (0.1, -0.1), (0.1, 0.1), (-0.1, 0.1)]).outline(80)
>>> best = best_cuts(ring)
>>> [k for k in best if best[k].squares < 1e-12], outlines_with(best, (), 4).polygon().kind
([4, 5], 'rectangle')

Source: Bellman (1961), "On the approximation of curves by line segments using dynamic programming".
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..arguments import Floats
from ..seen import REACH
from .outlines import LEAST_STRETCH, QUARTERS, Outlines, from_angle_order, joined
from .scatter import GHOSTS

KNOTS = 60  # cuts lie between two of so many places along the outline, a centimetre apart or less
MOST_PIECES = 5
MOST_CHORDS = 2
COMPANY, LEAST_COMPANY = 0.009, 3  # m: a point with fewer others as near is a stray

Line = tuple[float, float]  # bearing of the normal, and offset


@dataclass(frozen=True, eq=False)
class Cut:
    """The best way to cut the points into k pieces.

    Points near the cuts are supposed to be as close as the others. The pieces need not meet in corners, nor bend: an
    outline with so many sides hardly comes closer to the points.
    """

    moments: Floats  # (6, K), sums of 1, x, y, xx, yy and xy over the points of each piece
    squares: float  # sum of the squared distances of the points from their piece's line
    share: float  # of the points that belong to a piece

    @property
    def right_angled(self) -> float:
        """What ``squares`` is where each piece runs along the best of all bearings, or across it, square metres."""
        xx, yy, xy = scatter_sums(self.moments)
        longest = np.argmax(xx + yy)
        alike = (xx - yy) * (xx - yy)[longest] + 4 * xy * xy[longest] >= 0  # twice the angles are within a right one
        sign = np.where(alike, 1.0, -1.0)
        across = (xx + yy).sum() / 2 - np.hypot((sign * (xx - yy)).sum() / 2, (sign * xy).sum())
        return max(float(across), 0.0) / self.share

    @cached_property
    def lines(self) -> list[Line]:
        """The pieces' best lines, their normals away from the origin."""
        xx, yy, xy = scatter_sums(self.moments)
        angles = 0.5 * np.arctan2(2 * xy, xx - yy) + np.pi / 2  # across the direction of most scatter
        offsets = (np.cos(angles) * self.moments[1] + np.sin(angles) * self.moments[2]) / self.moments[0]
        return [_outward(a, d) for a, d in zip(angles.tolist(), offsets.tolist(), strict=True)]


def in_company(points: Floats, spread: float) -> NDArray[np.bool_]:
    """Tell which points have others near them, as on an outline, and are no strays, shape (N,)."""
    from scipy.spatial import cKDTree

    if len(points) <= LEAST_COMPANY:
        return np.ones(len(points), dtype=bool)
    near: NDArray[np.bool_] = cKDTree(points).query(points, LEAST_COMPANY + 1)[0][:, -1] <= COMPANY + spread
    return near  # itself is the first


def chords(ordered: Floats, unseen: float = REACH) -> list[Line]:
    """Return the lines over the widest gaps between neighbours, those wider than ``unseen``, metres.

    Where the next point lies on nearly the same bearing, noise alone parts them: across it a gap is half as wide as
    ``REACH``, or wider.
    """
    (x, y), (next_x, next_y) = ordered.T, np.concatenate([ordered[1:], ordered[:1]]).T
    beside = np.abs(x * next_y - y * next_x) > REACH / 2 * np.hypot(x, y)
    gap = _gaps(ordered) * beside
    widest = [i for i in np.argsort(-gap, kind="stable")[:MOST_CHORDS].tolist() if gap[i] > unseen]
    ends = [(ordered[i], ordered[(i + 1) % len(ordered)]) for i in widest]
    angles = [float(np.arctan2(p[0] - q[0], q[1] - p[1])) for p, q in ends]
    return [_outward(a, float(p @ (np.cos(a), np.sin(a)))) for a, (p, _) in zip(angles, ends, strict=True)]


def _gaps(ordered: Floats) -> Floats:
    """Return how far each point is from the next, shape (N,), metres."""
    return np.hypot(*(np.concatenate([ordered[1:], ordered[:1]]) - ordered).T)


def _outward(angle: float, offset: float) -> Line:
    """Return a line whose normal leads away from the origin."""
    return (angle, offset) if offset >= 0 else (angle + np.pi, -offset)


def best_cuts(ordered: Floats, unseen: float = REACH) -> dict[int, Cut]:
    """Return the best cut of points in order, shape (N, 2), metres, into one to five pieces, as far as there is one.

    The first cut is where no side runs through: where the points are farthest, of a polygon that is a corner; or behind
    a gap wider than ``unseen``, metres. Where exactly between two knots another cut lies, is left open, and the points
    there belong to no piece: so none is on a wrong one.
    """
    far, gap = (ordered**2).sum(axis=1), _gaps(ordered)
    ring = np.concatenate([far[-1:], far, far[:1]])
    cuts = _cuts_from(ordered, int(np.minimum(far, np.minimum(ring[:-2], ring[2:])).argmax()))  # a lone stray is none
    if gap.max() > unseen:
        for k, cut in _cuts_from(ordered, int(gap.argmax()) + 1).items():
            cuts[k] = min(cut, cuts.get(k, cut), key=lambda one: one.squares)
    return cuts


def _cuts_from(ordered: Floats, first: int) -> dict[int, Cut]:
    """Return the best cuts of which the first is there."""
    ordered = np.concatenate([ordered[first:], ordered[:first]])
    n_knots = min(KNOTS, len(ordered))
    knots = np.arange(n_knots + 1) * len(ordered) // n_knots
    moments = moments_between(ordered, knots)
    squares = np.where(long_enough(ordered, knots), squares_of(moments), np.inf)
    best, last_cuts, cuts = squares[0], list[NDArray[np.intp]](), dict[int, Cut]()
    backwards = np.ascontiguousarray(squares.T)
    for k in range(1, MOST_PIECES + 1):  # best[j]: the least squares of k pieces that end at knot j
        if k > 1:
            longer = best + backwards
            last_cuts.append(longer.argmin(axis=1))
            best = longer.min(axis=1)
        if np.isfinite(best[-1]):
            ends = _traced(last_cuts) if last_cuts else [0, n_knots - 1]
            pieces = moments[:, ends[:-1], ends[1:]]
            share = float(pieces[0].sum()) / len(ordered)
            cuts[k] = Cut(pieces, float(best[-1]) / share, share)
    return cuts


def outlines_with(cuts: dict[int, Cut], spans: list[Line] | tuple[()], k: int) -> Outlines | None:
    """Return outlines of k sides: k pieces; or k - 1 and the widest chord; or k - 2 and two."""
    rows = [cuts[k - n].lines + list(spans[:n]) for n in range(len(spans) + 1) if k - n in cuts and k - n > 0]
    return from_angle_order(*np.moveaxis(np.array(rows), 2, 0)) if rows else None


def frames(points: Floats, outlines: Outlines) -> Outlines:
    """Return rectangles around the points along the bearings of all sides; and drawn in, by the share of strays."""
    angles = outlines.angles.reshape(-1, 1) + QUARTERS
    heights = points @ np.stack([np.cos(angles), np.sin(angles)], axis=1)  # (M, N, 4)
    drawn_in, last = len(points) - 1 - int(GHOSTS * len(points)), len(points) - 1
    heights = np.partition(heights, (drawn_in, last), axis=1)
    return joined(Outlines(angles, heights[:, last]), Outlines(angles, heights[:, drawn_in]))


def moments_between(points: Floats, knots: NDArray[np.intp]) -> Floats:
    """Return the sums of 1, x, y, xx, yy and xy over the points of each piece, shape (6, M, M).

    A piece from one cut to another begins a knot after the first, and ends a knot before the second.
    """
    sums = np.zeros((6, len(points) + 1))
    np.cumsum(features_of(points), axis=1, out=sums[:, 1:])
    sums = sums[:, knots]
    return sums[:, None, :-1] - sums[:, 1:, None]


def long_enough(points: Floats, knots: NDArray[np.intp]) -> NDArray[np.bool_]:
    """Tell which pieces can be as long as a side must be: from the knot before them to the one after, shape (M, M)."""
    x, y = points[np.minimum(knots, len(points) - 1)].T
    chord = (x[1:] - x[:-1, None]) ** 2 + (y[1:] - y[:-1, None]) ** 2
    return chord >= LEAST_STRETCH**2


def features_of(points: Floats) -> Floats:
    """Return 1, x, y, xx, yy and xy of each point, shape (6, N): what all sums over points are made of."""
    x, y = points.T
    return np.array([np.ones_like(x), x, y, x * x, y * y, x * y])


def scatter_sums(moments: Floats) -> tuple[Floats, Floats, Floats]:
    """Return the scatter sums xx, yy and xy about the mean of each piece."""
    n, x, y, xx, yy, xy = moments
    n = np.maximum(n, 1.0)
    mean_x, mean_y = x / n, y / n
    return xx - x * mean_x, yy - y * mean_y, xy - x * mean_y


def squares_of(moments: Floats) -> Floats:
    """Return the sum of squared distances from the best line of each piece; infinite where there is none."""
    xx, yy, xy = scatter_sums(moments)
    across = (xx + yy - np.sqrt((xx - yy) ** 2 + 4 * xy**2)) / 2  # the smaller eigenvalue of the scatter matrix
    return np.where(moments[0] >= 2, np.maximum(across, 0.0), np.inf)


def _traced(last_cuts: list[NDArray[np.intp]]) -> list[int]:
    """Return where the pieces are cut, from the first cut to the last."""
    ends = [len(last_cuts[0]) - 1]
    for cut in reversed(last_cuts):
        ends.append(int(cut[ends[-1]]))
    return [*ends, 0][::-1]
