"""Free: the best outline of straight pieces, whatever they make: an L, a star, a hexagon.

The points of an outline have an order, even where bearings do not tell it: along a path from neighbour to neighbour. In
that order the outline is cut into straight pieces so that

    sum of squared distances / spread^2  +  PIECE_COSTS x number of pieces

is the least of all ways, by dynamic programming; then all sides are fitted together. It is the rival of every shape
with a name: what a free outline explains better is none of them.

In:  points of one cluster, shape (N, 2), metres, around the origin, and how far points spread from outlines.
Out: ``Outlines``, one row with as many sides as it takes; or ``None`` where the points are no closed outline.

>>> from primkit.shapes import Polygon
>>> ell = Polygon([(-0.1, -0.1), (0.1, -0.1), (0.1, -0.02), (-0.02, -0.02), (-0.02, 0.1), (-0.1, 0.1)])
>>> free_outline(ell.outline(300), 0.0004).polygon().kind
'polygon'
>>> free_outline(ell.outline(300)[:200], 0.0004) is None
True

Sources: Bellman (1961), "On the approximation of curves by line segments using dynamic programming"; the number of
pieces as Jackson et al. (2005), "An algorithm for optimal partitioning of data on an interval"; the path is the longest
one in the minimum spanning tree, Kruskal (1956).
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..arguments import Floats
from .cuts import KNOTS, in_company, long_enough, moments_between, scatter_sums, squares_of
from .evidence import Candidate, judged
from .outlines import LEAST_SIDE, Outlines
from .refine import refine_soft
from .scatter import CELL, FAR_CELLS, FAR_SPREADS, SIGMAS

if TYPE_CHECKING:
    from scipy.sparse import csr_array

BEAD_CELLS, BEAD_SPREADS = 3.0, 4.0  # neighbours this near are one bead of the path: then noise makes no detours
MOST_BEADS = 300  # more are made larger: the tree's work goes with their number squared
AT_AN_END = 0.2  # of the path: there a stray may be its end, and is left out where that closes the path
CLOSED_GAP, WIDEST_GAP = 0.04, 0.06  # m: nearer ends close an outline; and at most, with lone points or without
PIECE_COSTS = 20.0, 40.0, 80.0, 160.0  # about a side's two numbers (``evidence.price``); where they do not close, more
FLAT_TURN = np.radians(35)  # where a piece turns by less, or is shorter than two least sides, there may be none
ENOUGH_TO_CUT = 600  # points; of more, the least misfit is worth a piece
CUT_LOOKS = 2  # strays lead cuts astray: once more without them


def free_candidate(points: Floats, spread: float) -> list[Candidate]:
    """Return the outline of any straight pieces, judged; nothing where the points, shape (N, 2), do not close."""
    middle = points.mean(axis=0)
    outline = free_outline(points - middle, spread)
    return [] if outline is None else [judged(points - middle, outline, spread).moved(middle)]


def free_outline(points: Floats, spread: float) -> Outlines | None:
    """Return the best outline of straight pieces around the points; None where they do not close."""
    kept, found = points, None
    for _ in range(CUT_LOOKS):
        ordered = round_order(kept, spread)
        starts = () if ordered is None else _outlines(ordered[:: -(-len(ordered) // ENOUGH_TO_CUT)], spread)
        start = next((o for o in starts if o.closes()[0]), None)
        if start is None:
            break
        found = _pruned(points, refine_soft(points, start, spread, sound=Outlines.closes), spread)
        distance = np.abs(found.signed_distance(points))
        if (distance <= SIGMAS * spread).mean() >= 0.98:
            break
        kept = points[distance <= FAR_SPREADS * spread + FAR_CELLS * CELL]
    return found


def _pruned(points: Floats, outline: Outlines, spread: float) -> Outlines:
    """Return the outline without those of its sides that are not worth their price."""
    cost = judged(points, outline, spread).cost
    while outline.angles.shape[1] > 3:
        begin, end = outline.spans()
        turn = np.abs(outline.turns()[0])
        doubtful = ((end - begin)[0] < 2 * LEAST_SIDE) | (turn < FLAT_TURN) | (np.roll(turn, 1) < FLAT_TURN)
        for side in np.flatnonzero(doubtful):
            fewer = Outlines(np.delete(outline.angles, side, axis=1), np.delete(outline.offsets, side, axis=1))
            if fewer.closes()[0]:
                fewer = refine_soft(points, fewer, spread, sound=Outlines.closes)
                if (without := judged(points, fewer, spread).cost) < cost:
                    outline, cost = fewer, without
                    break
        else:
            break
    return outline


def round_order(points: Floats, spread: float) -> Floats | None:
    """Return the points in their order around an outline, counter-clockwise and without strays; None if it is open.

    Lone points may be strays, or of a side that few beams met: they are left out where the path closes without them.
    """
    near, size = in_company(points, spread), _bead_size(spread)
    gap, path = _closed(path_through(points[near], spread))
    if gap > CLOSED_GAP + size and not near.all():
        gap, path = min((gap, path), _closed(path_through(points, spread)), key=lambda way: way[0])
    if path is None or gap > WIDEST_GAP + size:
        return None
    place, distance = _along(points, path)
    close = distance <= size + SIGMAS * spread
    ordered = points[close][np.argsort(place[close], kind="stable")]
    x, y = ordered.T
    return ordered if (x * np.roll(y, -1)).sum() > (np.roll(x, -1) * y).sum() else ordered[::-1]


def _closed(path: Floats | None) -> tuple[float, Floats | None]:
    """Return how near two places at the ends of a path come, metres, and the path between them."""
    if path is None:
        return np.inf, None
    n = max(1, int(AT_AN_END * len(path)))
    gaps = np.hypot(*np.moveaxis(path[:n, None] - path[None, -n:], 2, 0))
    first, last = np.unravel_index(int(gaps.argmin()), gaps.shape)
    return float(gaps[first, last]), path[first : len(path) - n + int(last) + 1]


def path_through(points: Floats, spread: float) -> Floats | None:
    """Return the longest path from neighbour to neighbour, shape (M, 2), metres; None for fewer than four beads."""
    from scipy.sparse.csgraph import dijkstra

    size = _bead_size(spread)
    beads = _beads(points, size)
    while len(beads) > MOST_BEADS:
        size *= len(beads) / MOST_BEADS
        beads = _beads(points, size)
    if len(beads) < 4:
        return None
    tree = _shortest_tree(beads, CLOSED_GAP)
    if tree.nnz < len(beads) - 1:  # some are farther from all others
        tree = _shortest_tree(beads, np.inf)
    end = int(np.argmax(dijkstra(tree, directed=False, indices=0)))
    far, before = dijkstra(tree, directed=False, indices=end, return_predecessors=True)
    path = [int(np.argmax(far))]
    while path[-1] != end:
        path.append(int(before[path[-1]]))
    return beads[path]


def _shortest_tree(beads: Floats, reach: float) -> csr_array:
    """Return the shortest tree of links between beads, none longer than ``reach`` metres."""
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import minimum_spanning_tree
    from scipy.spatial import cKDTree

    one, other = cKDTree(beads).query_pairs(reach, output_type="ndarray").T
    apart = np.hypot(*(beads[one] - beads[other]).T)
    return minimum_spanning_tree(csr_array((apart, (one, other)), shape=(len(beads), len(beads))))


def _bead_size(spread: float) -> float:
    """Return the side of the squares that beads come from, metres."""
    return max(BEAD_CELLS * CELL, BEAD_SPREADS * spread)


def _beads(points: Floats, size: float) -> Floats:
    """Return the means of the points in squares of this size, shape (M, 2)."""
    i, j = np.floor((points - points.min(axis=0, initial=np.inf)) / size).astype(np.int64).T
    _, square, n = np.unique(i * (j.max(initial=0) + 1) + j, return_inverse=True, return_counts=True)
    square = square.astype(np.intp, copy=False)
    return np.column_stack([np.bincount(square, axis, len(n)) / n for axis in points.T])


def _along(points: Floats, path: Floats) -> tuple[Floats, Floats]:
    """Return where each point lies along a closed path, and how far from it, shape (N,) each, metres."""
    (edge_x, edge_y), (x, y) = (np.roll(path, -1, axis=0) - path).T, np.moveaxis(points[:, None] - path, 2, 0)
    squared = np.maximum(edge_x**2 + edge_y**2, np.finfo(float).tiny)
    share = np.clip((x * edge_x + y * edge_y) / squared, 0.0, 1.0)
    x, y = x - share * edge_x, y - share * edge_y
    nearest, row = (x**2 + y**2).argmin(axis=1), np.arange(len(points))
    lengths = np.sqrt(squared)
    place = np.concatenate([[0.0], np.cumsum(lengths)])[nearest] + share[row, nearest] * lengths[nearest]
    return place, np.hypot(x[row, nearest], y[row, nearest])


def _outlines(points: Floats, spread: float) -> Iterator[Outlines]:
    """Yield outlines through points in order, of fewer and fewer pieces."""
    points = np.roll(points, -int((points**2).sum(axis=1).argmax()), axis=0)  # the farthest point is a corner
    for price in PIECE_COSTS:
        cuts, _ = best_cut(points, spread, price)
        if len(cuts) < 3:
            return
        points = np.roll(points, -int(cuts[len(cuts) // 2]), axis=0)  # once more, from a cut on the other side
        cuts, pieces = best_cut(points, spread, price)
        if len(cuts) >= 3:
            yield _joined_lines(points, cuts, pieces)


def best_cut(points: Floats, spread: float, price: float, n_knots: int = 2 * KNOTS) -> tuple[NDArray[np.intp], Floats]:
    """Return at which points the best pieces begin, shape (K,), and their sums, shape (6, K)."""
    step = np.hypot(*(points - np.roll(points, 1, axis=0)).T)
    place = np.append(0.0, np.cumsum(step / step.sum() + 1 / len(points)))  # few points tell of a long side, too
    knots = np.unique(np.searchsorted(place, np.linspace(0.0, place[-1], n_knots + 1)).clip(0, len(points)))
    moments = moments_between(points, knots)
    cost = np.where(long_enough(points, knots), squares_of(moments), np.inf) / spread**2 + price
    best, begin = np.append(0.0, np.full(len(cost), np.inf)), [0]  # best[j]: the least cost up to knot j
    for end in range(1, len(best)):
        all_ways = best[:end] + cost[:end, end - 1]
        begin.append(int(all_ways.argmin()))
        best[end] = all_ways[begin[-1]]
    if not np.isfinite(best[-1]):
        return np.empty(0, dtype=np.intp), moments[:, :0, 0]
    ends = [len(cost)]
    while ends[-1] > 0:
        ends.append(begin[ends[-1]])
    at = np.array(ends[::-1])
    return knots[at[:-1]], moments[:, at[:-1], at[1:] - 1]


def _joined_lines(points: Floats, cuts: NDArray[np.intp], pieces: Floats) -> Outlines:
    """Return the pieces' best lines as one outline, each with the outside on its right."""
    _, x, y, *_ = pieces
    xx, yy, xy = scatter_sums(pieces)
    along = 0.5 * np.arctan2(2 * xy, xx - yy)
    chord = points[np.append(cuts[1:], 0) - 1] - points[cuts]
    backwards = np.cos(along) * chord[:, 0] + np.sin(along) * chord[:, 1] < 0
    angles = along + np.where(backwards, np.pi / 2, -np.pi / 2)
    return Outlines(angles[None], ((np.cos(angles) * x + np.sin(angles) * y) / pieces[0])[None])
