"""Segmentation: which points belong together.

In:  the grid's points, shape (N, 2), metres.
Out: a label for each point, shape (N,): 0, 1, 2, ... from left to right; -1 for a point that belongs to nothing.

>>> points = [(0.0, 0.0), (0.01, 0.0), (0.5, 0.0), (0.51, 0.0)]
>>> segment(points, 2, rng=0).tolist()
[0, 0, 1, 1]

K-Means is the method of the paper. It must be told the number of groups, and it draws its borders half-way
between their centres, which cuts a long thin shape beside a small one. Two remedies stand beside it, each
usable alone: ``count_by_silhouette`` finds the number, and ``link`` joins neighbours, whatever their form.

Sources: K-Means, Lloyd (1982), started after Arthur and Vassilvitskii (2007), "k-means++"; the silhouette,
Rousseeuw (1987); linking is DBSCAN, Ester, Kriegel, Sander and Xu (1996). The first two come from scikit-learn.
"""

from __future__ import annotations

import warnings
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .arguments import ROUNDING, Floats, Labels, as_count, as_points, as_positive, as_rng, short

Grouping = Literal["kmeans", "link"]

LINK_CELLS = 22  # neighbours on an outline lie a few cells apart, 20 where only distant poses saw it; shapes farther
LINK = 0.022  # m: the same on cells of 1 mm
LINK_NEIGHBOURS = 4  # a point joins others when so many, itself included, lie within a link: strays do not
LEAST_GROUP = 8  # a smaller group is a handful of strays
STARTS = 10  # K-Means depends on where it starts: the best of ten
MOST_SHAPES = 12
CELLS_IN_REACH = 3.0  # the farthest corners of two neighbouring cells are 2 sqrt(2) cells apart
# From the middle of a cell to the middle of the next, also over a corner; and of another that has a point within reach.
NEXT, WITHIN = 1.5, 4.3


def segment(
    points: ArrayLike,
    n_shapes: int | None = None,
    *,
    method: Grouping = "kmeans",
    resolution: float = 0.001,
    rng: int | np.random.Generator | None = None,
) -> Labels:
    """Return a label for each point: which group it belongs to, shape (N,).

    Raises ValueError if points are not finite (N, 2), more shapes are asked for than there are different points, or any
    number with linking.

    Parameters
    ----------
    points : array_like, shape (N, 2), metres
    n_shapes : int, optional
        Number of groups. When it is not given, K-Means takes the number with the best silhouette; linking
        needs no number and takes none.
    method : {"kmeans", "link"}
        How to group.
    resolution : float
        Side of the cells that the points lie on, metres: linking reaches over 22 of them.
    rng : seed or numpy.random.Generator, optional
        For K-Means' starts.

    Examples
    --------
    >>> segment([], rng=0).tolist()
    []
    """
    points = as_points(points)
    if method not in ("kmeans", "link"):
        raise ValueError(f'method must be "kmeans" or "link", got {short(method)}')
    if n_shapes is not None:
        check_count(n_shapes, points)
        if method == "link":
            raise ValueError(f'n_shapes must be None with method "link", which finds the number itself, got {n_shapes}')
    if len(points) == 0:
        return np.empty(0, dtype=np.intp)
    if method == "link":
        return link(points, LINK_CELLS * as_positive(resolution, "resolution"))
    rng = as_rng(rng)
    return kmeans(points, count_by_silhouette(points, rng=rng) if n_shapes is None else n_shapes, rng=rng)


def check_count(n_shapes: int, points: Floats, name: str = "n_shapes") -> None:
    """Refuse to look for more shapes than there are different points."""
    different = len(np.unique(points, axis=0))
    if as_count(n_shapes, name, least=0) > different:
        raise ValueError(f"{name} must be at most the number of different points, got {n_shapes} for {different}")


def kmeans(points: ArrayLike, k: int, *, rng: int | np.random.Generator | None = None) -> Labels:
    """Return labels that make the k groups as compact as possible, shape (N,).

    Raises ValueError if k is below one or larger than the number of different points.

    Points closer than rounding can tell (a hundred-millionth of the extent) may be left in one group, though k asked
    for two.

    >>> kmeans([(0, 0), (0, 1), (9, 9)], 2, rng=0).tolist()
    [0, 0, 1]
    """
    from sklearn.cluster import KMeans
    from sklearn.exceptions import ConvergenceWarning

    points = as_points(points)
    check_count(as_count(k, "k"), points, "k")
    seed = int(as_rng(rng).integers(2**31))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ConvergenceWarning)  # fewer groups than k: see the notes
        labels = KMeans(k, n_init=STARTS, random_state=seed).fit_predict(points)
    return _left_to_right(points, labels)


def count_by_silhouette(
    points: ArrayLike, most: int = MOST_SHAPES, *, rng: int | np.random.Generator | None = None
) -> int:
    """Return the number of groups, 1 to ``most``, whose K-Means groups are the most clearly apart.

    The silhouette compares each point's distance to its own group with that to the next one: near 1 is clearly apart, 0
    is on the border. It is not defined for one group; one is taken when two or more stay below 0.5, which Rousseeuw
    reads as no clear structure.

    >>> count_by_silhouette([(0, 0), (0, 1), (1, 0), (9, 9), (9, 8), (8, 9)], rng=0)
    2
    >>> count_by_silhouette([(0, 0)], rng=0)
    1
    """
    from sklearn.metrics import silhouette_score

    points, rng = as_points(points), as_rng(rng)
    points = points - points.min(axis=0, initial=np.inf)  # digits are not lost far from the origin
    different = len(np.unique(points, axis=0))
    best, best_score = min(1, different), 0.5
    for k in range(2, min(as_count(most, "most"), different - 1) + 1):
        labels = kmeans(points, k, rng=rng)
        score = silhouette_score(points, labels) if labels.max() > 0 else 0.0
        if score > best_score:
            best, best_score = k, score
    return best


def link(points: ArrayLike, reach: float = LINK, neighbours: int = LINK_NEIGHBOURS) -> Labels:
    """Return labels that join neighbours, and neighbours of neighbours, shape (N,); -1 for strays.

    Two points, shape (N, 2), metres, are neighbours when at most ``reach`` metres apart; one hands on its group when so
    many ``neighbours``, itself included, lie within reach. That finds groups of any form and needs no number, but
    splits an outline at an unseen stretch wider than ``reach``, and joins two shapes that come closer than that. Groups
    of fewer than eight points are strays.

    >>> row = [(x / 100, 0.0) for x in range(10)]
    >>> link(row + [(0.5, 0.5)]).tolist()
    [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, -1]
    """
    points = as_points(points)
    if len(points) == 0:
        return np.empty(0, dtype=np.intp)
    reach, neighbours = as_positive(reach, "reach"), as_count(neighbours, "neighbours")
    order = np.lexsort((points[:, 1], points[:, 0]))  # a lone point between two groups goes to the first one met
    ordered = points[order]
    first = np.append(True, (np.diff(ordered, axis=0) != 0).any(axis=1))  # of the points at one and the same place
    place = np.cumsum(first, dtype=np.intp) - 1
    labels = np.empty(len(points), dtype=np.intp)
    labels[order] = _linked(ordered[first], np.bincount(place), reach + ROUNDING, neighbours)[place]
    sizes = np.bincount(labels + 1)  # strays, of label -1, stand first
    strays = (labels < 0) | (sizes[labels + 1] < LEAST_GROUP)
    return _left_to_right(points, np.where(strays, -1, labels))


def _left_to_right(points: Floats, labels: NDArray[np.integer]) -> Labels:
    """Return the same groups numbered by the x (then y) of their means, so that numbers mean the same in any order."""
    groups = np.unique(labels[labels >= 0])
    means = np.array([points[labels == g].mean(axis=0) for g in groups]).reshape(-1, 2)
    means = means.round(9)  # to a nanometre: one above the other stays so, whatever the order of summing
    numbered = np.full(len(labels), -1, dtype=np.intp)
    for number, g in enumerate(np.lexsort((means[:, 1], means[:, 0]))):
        numbered[labels == groups[g]] = number
    return numbered


def _linked(places: Floats, n_at: Labels, reach: float, neighbours: int) -> Labels:
    """Return the group of each place, shape (N,); -1 for strays: DBSCAN, cell by cell (Gunawan, 2013).

    ``places``, shape (N, 2), metres, are in order: one on the edge of two groups goes to the one that begins first.
    ``n_at``, shape (N,), points lie at each. Cells are three to the reach, so whoever is in the same cell, or in the
    next, lies within reach; distances are looked at where that is not enough, at the edges of groups.
    """
    from scipy.spatial import cKDTree

    cells, cell = _cells(places, reach / CELLS_IN_REACH)
    tree, cell_tree = cKDTree(places), cKDTree(cells)
    following = cell_tree.query_pairs(NEXT, output_type="ndarray").T.astype(np.intp, copy=False)
    n_in, (a, b) = np.bincount(cell, n_at), following
    surely_near = n_in + np.bincount(a, n_in[b], len(cells)) + np.bincount(b, n_in[a], len(cells))
    handing_on = surely_near[cell] >= neighbours
    rest = np.flatnonzero(~handing_on)
    around = tree.query_ball_point(places[rest], reach)
    handing_on[rest] = [n_at[near].sum() >= neighbours for near in around]

    alive = np.bincount(cell, handing_on) > 0  # cells with a place that hands on
    group = components(len(cells), following[:, alive[following].all(axis=0)])
    apart = cell_tree.query_pairs(WITHIN, output_type="ndarray").T
    apart = apart[:, alive[apart].all(axis=0) & (group[apart[0]] != group[apart[1]])]
    if apart.size:  # two groups may come within reach: only distances tell
        meet = _meet(places[handing_on], cell[handing_on], apart, reach)
        group = components(len(cells), group[apart[:, meet]])[group]

    labels = np.full(len(places), -1, dtype=np.intp)
    _, begins, which = np.unique(group[cell[handing_on]], return_index=True, return_inverse=True)
    labels[handing_on] = np.argsort(np.argsort(begins))[which]  # numbered in the order in which groups begin
    for i, near in zip(rest, around, strict=True):  # the others take part in the first group within reach
        if not handing_on[i]:
            labels[i] = min((labels[j] for j in near if handing_on[j]), default=-1)
    return labels


def _meet(places: Floats, cell: Labels, pairs: NDArray[np.intp], reach: float) -> NDArray[np.bool_]:
    """Tell which pairs of cells, shape (2, P), have a place each, shape (N, 2), that lie within reach, shape (P,).

    Cell by cell, for of crowds that run beside each other all pairs of places are too many.
    """
    from scipy.spatial import cKDTree

    order = np.argsort(cell, kind="stable")
    numbers, begins = np.unique(cell[order], return_index=True)
    low, high = (extreme.reduceat(places[order], begins) for extreme in (np.minimum, np.maximum))
    a, b = pairs = np.searchsorted(numbers, pairs)
    gaps, inside = (low[a] - high[b], low[b] - high[a]), np.split(places[order], begins[1:])
    meet = np.hypot(*np.maximum(*gaps).clip(0.0).T) <= reach  # the least that boxes around both allow
    doubt = meet & (np.hypot(*np.minimum(*gaps).T) > reach)  # and the most
    meet[doubt] = [cKDTree(inside[i]).query(inside[j])[0].min() <= reach for i, j in pairs[:, doubt].T]
    return meet


def _cells(places: Floats, side: float) -> tuple[Floats, Labels]:
    """Return the cells with places in them, shape (M, 2), in cells, and the number of each place's cell, shape (N,)."""
    ij = np.floor(places / side)
    row, column = (np.unique(axis, return_inverse=True)[1] for axis in ij.T)  # numbers below N: no pair overflows
    _, first, cell = np.unique(row * len(places) + column, return_index=True, return_inverse=True)
    return ij[first], cell.astype(np.intp, copy=False)


def components(n: int, pairs: NDArray[np.intp]) -> Labels:
    """Return the connected components of n things by pairs, shape (2, P): for each the number of one in its own.

    The smaller number of a pair goes to the one whose number the other has, and so to all that have it. Numbers only
    fall, until both of each pair have the same.
    """
    number = np.arange(n)
    a, b = pairs
    while (number[a] != number[b]).any():
        smaller = np.minimum(number[a], number[b])
        np.minimum.at(number, np.concatenate([number[a], number[b]]), np.concatenate([smaller, smaller]))
        number = number[number][number]  # twice: long rows get through in few rounds
    return number
