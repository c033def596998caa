"""Pieces: the outline of a composite, cut into straight pieces.

The points are put in their order along the outline, and in that order cut into straight pieces, both as for an outline
of any shape (``robust.free``). An arc becomes several pieces; a camera's colours cut once more.

In:  points of one composite, shape (N, 2), metres, around the origin, and how far points spread from outlines.
Out: ``Piece``s, counter-clockwise, each from one junction to the next; ``None`` where the points do not close.

>>> from primkit.shapes import Polygon
>>> house = Polygon([(0, 0), (0.2, 0), (0.2, 0.1), (0.1, 0.2), (0, 0.1)])
>>> sorted(round(piece.length, 2) for piece in pieces_of(house.outline(300), 0.0004))
[0.1, 0.1, 0.14, 0.14, 0.2]
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from ..arguments import Floats, Ints
from ..robust.free import best_cut, round_order

PIECE_PRICE = 18.0  # of two numbers and a cut: each about ln N, and some caution
MOST_CUTS = 400  # cuts lie between two of so many places along the outline
NEIGHBOURS_ASKED = 3  # points that tell the colour of a place


@dataclass(frozen=True, eq=False)
class Piece:
    """A straight piece of an outline.

    Parameters
    ----------
    begin, end : array, shape (2,)
        Its ends, metres; the inside of the outline is on the left.
    points : array, shape (M, 2)
        The points on it, metres.
    color : int
        The number of the colour of its points; -1 for unknown.
    """

    begin: Floats
    end: Floats
    points: Floats
    color: int = -1

    @property
    def normal(self) -> Floats:
        """Unit normal, outwards, shape (2,)."""
        along = (self.end - self.begin) / self.length
        return np.array([along[1], -along[0]])

    @property
    def length(self) -> float:
        """From begin to end, metres."""
        return float(np.hypot(*(self.end - self.begin)))


def pieces_of(points: Floats, spread: float, colors: Ints | None = None) -> list[Piece] | None:
    """Return the pieces of the outline that points lie on, shape (N, 2), metres; None where they do not close.

    With ``colors``, shape (N,), the pieces are cut where the colour changes.
    """
    ordered = round_order(points, spread)
    if ordered is None:
        return None
    first = int((ordered**2).sum(axis=1).argmax())  # the farthest point is a corner
    for _ in range(2):  # once more, from a cut on the other side
        ordered = np.roll(ordered, -first, axis=0)
        cuts, _ = best_cut(ordered, spread, PIECE_PRICE, MOST_CUTS)
        if len(cuts) < 3:
            return None
        first = int(cuts[len(cuts) // 2])
    stretches = np.split(ordered, cuts[1:])
    ends = np.array([_ends(stretch) for stretch in stretches])
    junctions = (ends[:, 0] + np.roll(ends[:, 1], 1, axis=0)) / 2
    after = np.roll(junctions, -1, axis=0)
    pieces = [Piece(*three) for three in zip(junctions, after, stretches, strict=True)]
    return pieces if colors is None else _cut_at_colors(pieces, points, colors)


def room_in(pieces: Sequence[Piece], more: float) -> Any:
    """Return the area that pieces enclose, and so many metres around it, as a shapely polygon."""
    import shapely

    room = shapely.make_valid(shapely.Polygon([piece.begin for piece in pieces])).buffer(more)
    shapely.prepare(room)
    return room


def _ends(stretch: Floats) -> Floats:
    """Return where the line through points in their order begins and ends, shape (2, 2)."""
    middle = stretch.mean(axis=0)
    along = np.linalg.svd(stretch - middle, full_matrices=False)[2][0]
    return middle + np.outer((stretch[[0, -1]] - middle) @ along, along)


def _cut_at_colors(pieces: list[Piece], points: Floats, colors: Ints) -> list[Piece]:
    """Return the pieces cut where the colour of the nearest points changes."""
    from scipy.spatial import cKDTree

    known = colors >= 0
    if not known.any():
        return pieces
    tree, found = cKDTree(points[known]), []
    for piece in pieces:
        share = np.linspace(0, 1, 1 + max(1, int(np.ceil(piece.length / 0.001))))[:, None]
        places = piece.begin + share * (piece.end - piece.begin)
        near = colors[known][tree.query(places, min(NEIGHBOURS_ASKED, int(known.sum())))[1]]
        of_places = np.array([np.bincount(row).argmax() for row in near.reshape(len(places), -1)])
        cuts = [0, *(np.flatnonzero(np.diff(of_places)) + 1).tolist(), len(places)]
        nearest = cKDTree(places).query(piece.points)[1]
        for first, last in pairwise(cuts):
            mine = piece.points[(nearest >= first) & (nearest < last)]
            if len(mine) >= 3:
                found.append(Piece(places[first], places[min(last, len(places) - 1)], mine, int(of_places[first])))
    return found
