"""Composites: the fewest parts that explain an outline, and the column that a camera sees a hit in; lesson 12's checks.

In:  the student's ``fewest_parts(claims)`` and ``camera_columns(bearings, field_of_view, width)``.
Out: answers. Sets of parts are right in any order, and so are the parts in them.

>>> fewest_parts(lambda claims: ...)
○ not attempted: fewest_parts still returns `...`.
>>> fewest_parts.reference(np.array([[True, True, False], [False, True, True], [False, False, True]]))
[(0, 1), (0, 2)]
>>> camera_columns.reference(np.radians([27.9, 0.5, -0.5, -27.9, 40.0, 180.0]), np.radians(56), 52).tolist()
[0, 25, 26, 51, -1, -1]
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import combinations
from typing import Any

import numpy as np

from ..arguments import Bools, Floats, Ints
from . import judges
from .answer import Check, Fault, off_only_where
from .cases import UNDECIDED, Args, random_cases

Sets = list[tuple[int, ...]]

MOST_CLAIMED = 7  # parts of a case: a plain search through all sets of them takes no time


# --- the fewest parts ---------------------------------------------------------------------------------------------


def covers(claims: Bools, size: int) -> Sets:
    """Return the sets of so many parts that claim every place."""
    return [some for some in combinations(range(len(claims)), size) if claims[list(some)].any(axis=0).all()]


def fewest(claims: Bools) -> Sets:
    """Return all sets of as few parts as it takes to claim every place; none if some place lies on no part."""
    for size in range(1, len(claims) + 1):
        if found := covers(claims, size):
            return found
    return []


def _outlines(rng: np.random.Generator) -> Iterator[Args]:
    """Yield one part, two ways, an overlap, a greedy trap, three parts, a place on no part; then any."""
    yield (np.array([[True, True, True]]),)
    yield (np.array([[True, True, False], [False, False, True], [False, True, True]]),)
    yield (np.array([[True, True, True, False], [False, True, True, True]]),)  # both claim what lies between
    yield (np.array([[1, 1, 1, 1, 0, 0], [1, 1, 0, 0, 1, 0], [0, 0, 1, 1, 0, 1]], dtype=bool),)
    yield (np.eye(3, dtype=bool),)
    yield (np.array([[True, False, False], [False, True, False]]),)
    yield from random_cases(lambda n: (_arcs_of_a_ring(rng, 3 + n % (MOST_CLAIMED - 2)),))


def _arcs_of_a_ring(rng: np.random.Generator, parts: int) -> Bools:
    """Return what parts claim that each lie on one stretch of an outline, shape (parts, 12)."""
    begin, length = rng.integers(0, 12, parts), rng.integers(2, 9, parts)
    claims: Bools = (np.arange(12) - begin[:, None]) % 12 < length[:, None]
    return claims


def _sets(value: Any) -> set[frozenset[int]] | None:
    """Return a result as a set of sets of numbers; None for what is none."""
    try:
        return {frozenset(int(one) for one in some) for some in value} if not isinstance(value, (str, dict)) else None
    except (TypeError, ValueError, OverflowError):
        return None


def _same_sets(got: Any, expected: Any, _args: Args) -> str | None:
    """Judge sets of numbers, in any order."""
    mine, wanted = _sets(got), _sets(expected)
    if mine is None:
        return f"got {judges.shown(got)}, expected a list such as {judges.shown(expected)}{judges.no_return(got)}"
    if mine == wanted:
        return None
    return f"got {judges.shown(got)}, expected {judges.shown(expected)}"


def _greedy(claims: Bools) -> Sets:
    """Return the one set to which always the part is added that claims most of what is left."""
    left, some = np.ones(claims.shape[1], dtype=bool), list[int]()
    while left.any() and (claims & left).any():
        some.append(int((claims & left).sum(axis=1).argmax()))
        left &= ~claims[some[-1]]
    return [] if left.any() else [tuple(some)]


def _sizes_up_to(claims: Bools, most: int) -> Sets:
    return [some for size in range(1, most + 1) for some in covers(claims, size)]


fewest_parts = Check(
    "fewest_parts",
    fewest,
    _outlines,
    _same_sets,
    (
        Fault(
            "All is right but this: where a place lies on no part, no set explains the outline: return an empty list.",
            when=off_only_where(lambda case: not case.args[0].any(axis=0).all()),
            name="no part for a place",
        ),
        Fault(
            "That is one set of the fewest. Others explain the outline as well: return all of them.",
            like=(lambda claims: fewest(claims)[:1], lambda claims: fewest(claims)[-1:]),
            name="one of several",
        ),
        Fault(
            "Larger sets are among yours: whoever adds a part explains no less. Stop at the first size that does.",
            like=lambda claims: _sizes_up_to(claims, len(claims)),
            name="larger sets too",
        ),
        Fault(
            "The part that claims most is taken first. It need not be in the smallest set: try all sets of a size.",
            like=_greedy,
            name="greedy",
        ),
        Fault(
            "Each place lies on exactly one part of yours. Parts may overlap: on one part at least.",
            like=lambda claims: next(
                (
                    found
                    for size in range(1, len(claims) + 1)
                    if (found := [s for s in covers(claims, size) if (claims[list(s)].sum(axis=0) == 1).all()])
                ),
                [],
            ),
            name="exactly one part",
        ),
        Fault(
            "Pairs are tried, and no more: an outline may take three parts.",
            like=lambda claims: fewest(claims) if len(next(iter(fewest(claims)), ())) <= 2 else [],
            name="pairs alone",
        ),
    ),
)


# --- which column a hit is seen in --------------------------------------------------------------------------------


def columns(bearings: Floats, field_of_view: float, width: int) -> Ints:
    """Return the column of each bearing, 0 on the left, shape (N,); -1 outside of the view."""
    return _binned(bearings, np.tan(bearings) / np.tan(field_of_view / 2), field_of_view, width)


def _binned(bearings: Floats, share: Floats, field_of_view: float, width: int, off: int = -1) -> Ints:
    """Return columns for shares of half the view, 1 on its left edge and -1 on its right."""
    column = np.floor((1 - share) / 2 * width)
    return np.where(np.abs(bearings) < field_of_view / 2, column, off).astype(int)


def _any_bearings(rng: np.random.Generator) -> Iterator[Args]:
    """Yield hits ahead, left, right, outside and behind; then many, for any camera."""
    e_puck = np.radians(56), 52
    for degrees in ((0.5, -0.5), (20.0, 27.0), (-20.0, -27.0), (60.0, -40.0), (180.0, -170.0)):
        yield np.radians(degrees), *e_puck
    yield np.radians([25.0, 12.0, -3.0, -26.0]), *e_puck
    yield from random_cases(lambda _: _seen_by_any(rng))


def _seen_by_any(rng: np.random.Generator) -> Args | None:
    view, width = float(rng.uniform(0.5, 2.2)), int(rng.integers(4, 80))
    bearings = np.append(rng.uniform(-view, view, 12), rng.uniform(-np.pi, np.pi, 4))
    place = (1 - np.tan(bearings) / np.tan(view / 2)) / 2 * width
    undecided = np.abs(place - np.round(place)) < UNDECIDED
    return (
        None if undecided.any() or (np.abs(np.abs(bearings) - view / 2) < UNDECIDED).any() else (bearings, view, width)
    )


def _shares(share: Callable[[Floats, float], Floats]) -> Callable[..., Ints]:
    """Return faulty columns: the right ones for another place on the sensor."""
    return lambda bearings, view, width: _binned(bearings, share(bearings, view), view, width)


def _all_in_view(bearings: Floats, field_of_view: float, width: int) -> Ints:
    place = (1 - np.tan(bearings) / np.tan(field_of_view / 2)) / 2 * width
    return np.clip(np.floor(place), 0, width - 1).astype(int)


def _by_place_alone(bearings: Floats, field_of_view: float, width: int) -> Ints:
    column = np.floor((1 - np.tan(bearings) / np.tan(field_of_view / 2)) / 2 * width)
    return np.where((column >= 0) & (column < width), column, -1).astype(int)


camera_columns = Check(
    "camera_columns",
    columns,
    _any_bearings,
    judges.array(),
    (
        Fault(
            "Hits behind the robot get a column: the tangent takes behind for ahead. Ask for the bearing first.",
            like=_by_place_alone,
            name="behind is ahead",
        ),
        Fault(
            "The columns are spread evenly over angles. The sensor is flat: spread them over tangents.",
            like=_shares(lambda bearings, view: bearings / (view / 2)),
            name="evenly over angles",
        ),
        Fault(
            "Left and right are exchanged: column 0 is on the left, where bearings are positive.",
            like=_shares(lambda bearings, view: -np.tan(bearings) / np.tan(view / 2)),
            name="mirrored",
        ),
        Fault(
            "The tangent of the whole field of view is taken: from the middle to an edge it is half of it.",
            like=_shares(lambda bearings, view: np.tan(bearings) / np.tan(view)),
            name="the whole view",
        ),
        Fault(
            "What lies outside of the view gets the column at its edge. The camera does not see it: -1.",
            like=_all_in_view,
            name="edges for outside",
        ),
        Fault(
            "The place is rounded: column 0 reaches from 0 to 1, so that a place of 0.7 is in it.",
            like=lambda bearings, view, width: _binned(
                bearings, np.tan(bearings) / np.tan(view / 2) - 1 / width, view, width
            ),
            name="rounded",
        ),
    ),
)
