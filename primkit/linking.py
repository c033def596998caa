"""Linking: neighbours, and neighbours of neighbours, found cell by cell.

A point hands on its group when so many points lie within reach; points that do so, and lie within reach of each other,
are one group. This is DBSCAN. Where points lie dense, pairs of neighbours are many, and nearly all say the same. So
points are put into square cells, three to the reach: whoever is in the same cell, or in the next, lies within reach.
Only where that is not enough, at the edges of groups, distances are looked at.

In:  different places, shape (N, 2), metres, and how many points lie at each.
Out: a label for each place, shape (N,); -1 for strays.

>>> row = np.array([(x / 100, 0.0) for x in range(10)])
>>> linked(np.vstack([row, [(0.5, 0.5)]]), np.ones(11, dtype=int), 0.022, 4).tolist()
[0, 0, 0, 0, 0, 0, 0, 0, 0, 0, -1]

Source: Ester, Kriegel, Sander and Xu (1996); cells for it, Gunawan (2013), "A faster algorithm for DBSCAN".
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Labels = NDArray[np.int64]

CELLS_IN_REACH = 3.0  # the farthest corners of two neighbouring cells are 2 sqrt(2) cells apart
# From the middle of a cell to the middle of the next, also over a corner; and of another that has a point within reach.
NEXT, WITHIN = 1.5, 4.3


def linked(places: Floats, n_at: Labels, reach: float, neighbours: int) -> Labels:
    """Return the group of each place; -1 for strays.

    Parameters
    ----------
    places : array, shape (N, 2)
        Metres, in order: a place on the edge of two groups goes to the one that begins first.
    n_at : array of int, shape (N,)
        How many points lie there.
    reach : float
        Two places this close or closer are neighbours, metres.
    neighbours : int
        A place hands on its group when so many points, its own included, lie within reach.
    """
    from scipy.spatial import cKDTree

    cells, cell = _cells(places, reach / CELLS_IN_REACH)
    tree, cell_tree = cKDTree(places), cKDTree(cells)
    following = cell_tree.query_pairs(NEXT, output_type="ndarray").T
    surely_near = _with_neighbours(np.bincount(cell, n_at), following)
    handing_on = surely_near[cell] >= neighbours
    rest = np.flatnonzero(~handing_on)
    around = tree.query_ball_point(places[rest], reach)
    handing_on[rest] = [n_at[near].sum() >= neighbours for near in around]

    alive = np.bincount(cell, handing_on) > 0  # cells with a place that hands on
    group = _components(len(cells), following[:, alive[following].all(axis=0)])
    apart = cell_tree.query_pairs(WITHIN, output_type="ndarray").T
    apart = apart[:, alive[apart].all(axis=0) & (group[apart[0]] != group[apart[1]])]
    if apart.size:  # two groups may come within reach: only distances tell
        edge = np.flatnonzero(handing_on & np.isin(cell, apart))
        pairs = edge[cKDTree(places[edge]).query_pairs(reach, output_type="ndarray").T]
        group = _components(len(cells), group[cell[pairs]])[group]

    labels = np.full(len(places), -1, dtype=np.int64)
    labels[handing_on] = _in_order(group[cell[handing_on]])
    for i, near in zip(rest, around, strict=True):  # the others take part in the first group within reach
        if not handing_on[i]:
            labels[i] = min((labels[j] for j in near if handing_on[j]), default=-1)
    return labels


def _cells(places: Floats, side: float) -> tuple[Floats, Labels]:
    """Return the cells with places in them, shape (M, 2), in cells, and the number of each place's cell, shape (N,)."""
    ij = np.floor(places / side)
    row, column = (np.unique(axis, return_inverse=True)[1] for axis in ij.T)  # numbers below N: no pair overflows
    _, first, cell = np.unique(row * len(places) + column, return_index=True, return_inverse=True)
    return ij[first], cell


def _with_neighbours(count: NDArray[Any], pairs: NDArray[np.intp]) -> NDArray[Any]:
    """Return for each cell its own count and those of the cells that it makes pairs with, shape (M,)."""
    a, b = pairs
    return count + np.bincount(a, count[b], len(count)) + np.bincount(b, count[a], len(count))


def _components(n: int, pairs: NDArray[np.intp]) -> Labels:
    """Return which of n things hang together by pairs, shape (2, P): a number for each, shape (n,).

    Each has the number of one that it hangs together with, its own at first. The smaller number of a pair goes to the
    one whose number the other has, and so to all that have it. Numbers only fall, until no pair is left in two minds.
    """
    number = np.arange(n)
    a, b = pairs
    while (number[a] != number[b]).any():
        smaller = np.minimum(number[a], number[b])
        np.minimum.at(number, np.concatenate([number[a], number[b]]), np.concatenate([smaller, smaller]))
        number = number[number][number]  # twice: long rows get through in few rounds
    return number


def _in_order(groups: Labels) -> Labels:
    """Return groups numbered 0, 1, 2, ... in the order in which they begin."""
    _, begins, which = np.unique(groups, return_index=True, return_inverse=True)
    return np.argsort(np.argsort(begins))[which]
