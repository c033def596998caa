"""Lesson 12: the fewest parts that explain an outline, and the column of a camera that a hit is seen in."""

# ruff: noqa: ARG005 (a wrong answer may leave out what it is given)

import itertools
import math

import numpy as np


def by_sets(claims):
    """Sets of places, and sets of them."""
    parts = [set(np.flatnonzero(row).tolist()) for row in claims]
    places = set(range(claims.shape[1]))
    for size in range(1, len(parts) + 1):
        found = [
            s for s in itertools.combinations(range(len(parts)), size) if set().union(*(parts[i] for i in s)) == places
        ]
        if found:
            return found
    return []


def by_all_masks(claims):
    """All masks of parts at once, as a matrix."""
    masks = np.array(list(itertools.product([False, True], repeat=len(claims))))
    good = masks[(masks @ claims.astype(int) > 0).all(axis=1)]
    sizes = good.sum(axis=1)
    return [set(np.flatnonzero(mask).tolist()) for mask in good[sizes == sizes.min()]] if len(good) else []


def sets_where(keep):
    """All sets of parts, shortest first, that a rule keeps."""
    return lambda claims: [
        s
        for size in range(1, len(claims) + 1)
        for s in itertools.combinations(range(len(claims)), size)
        if keep(claims[list(s)])
    ]


def every(claims):
    return sets_where(lambda rows: rows.any(axis=0).all())(claims)


def largest_first(claims):
    left, some = set(range(claims.shape[1])), []
    while left:
        best = max(range(len(claims)), key=lambda i: len(left & set(np.flatnonzero(claims[i]).tolist())))
        taken = left & set(np.flatnonzero(claims[best]).tolist())
        if not taken:
            return []
        some.append(best)
        left -= taken
    return [some]


def shortest(sets):
    return [s for s in sets if len(s) == len(sets[0])]


def exactly_one(claims):
    return shortest(sets_where(lambda rows: (rows.sum(axis=0) == 1).all())(claims))


def pairs(claims):
    return [s for s in shortest(every(claims)) if len(s) <= 2]


def everything_where_none(claims):
    return by_sets(claims) or [tuple(range(len(claims)))]


def by_focal_length(bearings, field_of_view, width):
    """The focal length in pixels."""
    focal = width / 2 / math.tan(field_of_view / 2)
    place = width / 2 - focal * np.tan(bearings)
    return np.where(np.abs(bearings) < field_of_view / 2, np.floor(place), -1)


def by_edges(bearings, field_of_view, width):
    """Between which edges each bearing lies."""
    edges = np.arctan(np.tan(field_of_view / 2) * np.linspace(-1, 1, width + 1))
    column = width - np.searchsorted(edges, bearings)
    return [int(c) if 0 <= c < width else -1 for c in column]


def place(bearings, field_of_view):
    return np.tan(bearings) / np.tan(field_of_view / 2)


def columns_at(share, rounded=np.floor):
    def columns(bearings, view, width):
        column = rounded((1 - share(bearings, view)) / 2 * width)
        return np.where(np.abs(bearings) < view / 2, column, -1)

    return columns


def edge_for_outside(bearings, view, width):
    return np.clip(np.floor((1 - place(bearings, view)) / 2 * width), 0, width - 1)


def ahead_or_behind(bearings, view, width):
    column = np.floor((1 - place(bearings, view)) / 2 * width)
    return np.where((column < 0) | (column >= width), -1, column)


ANSWERS = {
    "fewest_parts": {
        "right": {"sets": by_sets, "masks": by_all_masks},
        "wrong": {
            "all where none does": (everything_where_none, "return an empty list"),
            "one": (lambda claims: by_sets(claims)[:1], "return all of them"),
            "every size": (every, "Larger sets are among yours"),
            "largest first": (largest_first, "The part that claims most is taken first"),
            "exactly one": (exactly_one, "Parts may overlap"),
            "pairs": (pairs, "an outline may take three parts"),
        },
        "error": {
            "first of nothing": (
                lambda claims: [s for s in every(claims) if len(s) == len(every(claims)[0])] or every(claims)[0],
                "list index out of range",
            ),
        },
    },
    "camera_columns": {
        "right": {"focal length": by_focal_length, "edges": by_edges},
        "wrong": {
            "behind": (ahead_or_behind, "the tangent takes behind for ahead"),
            "angles": (columns_at(lambda bearings, view: 2 * bearings / view), "spread evenly over angles"),
            "mirrored": (columns_at(lambda bearings, view: -place(bearings, view)), "Left and right are exchanged"),
            "whole view": (
                columns_at(lambda bearings, view: np.tan(bearings) / np.tan(view)),
                "The tangent of the whole field of view",
            ),
            "edges": (edge_for_outside, "The camera does not see it: -1"),
            "rounded": (
                lambda bearings, view, width: columns_at(
                    lambda b, v: place(b, v) - 1 / width,
                )(bearings, view, width),
                "The place is rounded",
            ),
        },
        "error": {
            "one at a time": (
                lambda bearings, view, width: -1 if abs(bearings) > view / 2 else int(place(bearings, view)),
                "truth value of an array",
            ),
        },
    },
}
