"""Scoring: which found shape stands for which true one, what is right, and its shares; the checks of lesson 07.

In:  the student's ``match_shapes(found, true, gate)``, ``right(errors, tolerance)`` and
     ``parts(found, true, pairs, tolerance)``.
Out: answers. Pairs may come in any order; where two pairings are equally short, either is right.

>>> match_shapes(lambda found, true, gate: ...)
○ not attempted: match_shapes still returns `...`.
>>> match_shapes.reference(np.array([[0.06, 0.0], [0.01, 0.0]]), np.zeros((1, 2)), 0.1)
[(1, 0)]
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from functools import partial
from typing import Any

import numpy as np

from ..arguments import ROUNDING, Bools, Floats
from ..evaluation import match
from ..shapes import Circle, Polygon, Shape
from ..world import random_world
from .answer import Check, Fault
from .cases import UNDECIDED, Args, around, random_cases
from .judges import CLOSE, array, marks, no_return, shown

Pairs = list[tuple[int, int]]

SCORING_CASES = 120  # of each check: they take longer than other lessons'
GATE, TOLERANCE = 0.1, 0.005  # m
OPEN_GATE = 10.0  # m: lets everything through
RIGHT_CASES = 60


# --- one-to-one pairs -------------------------------------------------------------------------------------------


def best_pairs(found: Floats, true: Floats, gate: float) -> Pairs:
    """Return pairs (index found, index true): as many as the gate allows, then with the least total distance.

    ``found`` and ``true`` are centres, shape (F, 2) and (T, 2), metres.
    """
    ours, theirs = ([Circle(center, 1.0) for center in centers] for centers in (found, true))
    return match(ours, theirs, gate)


def _distances(found: Floats, true: Floats) -> Floats:
    offset = found.reshape(-1, 1, 2) - true.reshape(1, -1, 2)
    return np.hypot(offset[..., 0], offset[..., 1])


def _match_cases(rng: np.random.Generator) -> Iterator[Args]:
    """Yield plain situations, then crowded random ones."""
    a, b, c = (0.0, 0.0), (0.2, 0.0), (0.0, 0.2)
    yield np.array([b, a]), np.array([a, b]), GATE  # in another order
    yield np.array([(0.03, 0.0), (0.1, 0.0)]), np.array([(0.0, 0.0), (0.05, 0.0)]), GATE  # the first may not choose
    yield np.array([(0.01, 0.0), (0.0, 0.02)]), np.array([a, b]), GATE  # two for the same
    yield np.array([a, b, c]), np.array([a]), GATE
    yield np.array([(0.3, 0.0)]), np.array([a]), GATE
    yield np.array([(0.125, 0.0)]), np.array([a]), 0.125  # exactly as far as the gate
    yield np.array([a, (-0.04, 0.03)]), np.array([a, (0.05, 0.0)]), GATE  # other pairs have the least squares
    yield np.empty((0, 2)), np.array([a, b]), GATE
    yield np.array([a, b]), np.empty((0, 2)), GATE

    def draw(_n: int) -> Args | None:
        true = rng.uniform(-0.12, 0.12, (rng.integers(1, 5), 2))
        found = np.vstack([true + rng.normal(0, 0.04, true.shape), rng.uniform(-0.2, 0.2, (2, 2))])
        found = rng.permutation(found)[: rng.integers(1, 6)]
        gate = float(rng.choice([0.05, GATE]))
        return (found, true, gate) if np.abs(_distances(found, true) - gate).min() > UNDECIDED else None

    yield from random_cases(draw, SCORING_CASES)


def _judge_pairs(got: Any, expected: Any, args: Args) -> str | None:
    """Judge a pairing by what it is for: one-to-one, within the gate, as many as possible, least in all."""
    pairs = _as_pairs(got)
    if pairs is None:
        return f"got {shown(got)}, expected a list of pairs (index found, index true){no_return(got)}"
    if sorted(pairs) == sorted(expected):
        return None
    found, true, gate = args
    for place, name, n in ((0, "found", len(found)), (1, "true", len(true))):
        used = [pair[place] for pair in pairs]
        if any(not 0 <= index < n for index in used):
            return f"got {shown(pairs)}, but there are {n} {name} shapes, counted from 0"
        if len(set(used)) < len(used):
            return f"got {shown(pairs)}: a {name} shape stands in two pairs"
    apart = [float(_distances(found, true)[pair]) for pair in pairs]
    if max(apart, default=0.0) > gate:
        return f"got {shown(pairs)}: a pair is {shown(max(apart))} m apart, and the gate is {shown(gate)} m"
    if len(pairs) != len(expected):
        return f"got {len(pairs)} pairs, {len(expected)} are possible"
    least = sum(float(_distances(found, true)[pair]) for pair in expected)
    if sum(apart) <= least + CLOSE:
        return None
    return f"got {shown(pairs)}, {shown(sum(apart))} m in all; {shown(expected)} is {shown(least)} m"


def _as_pairs(got: Any) -> Pairs | None:
    """Return pairs of whole numbers; None for anything else."""
    if isinstance(got, (str, dict)) or not isinstance(got, Iterable):
        return None
    try:
        pairs = [tuple(pair) for pair in got]
    except TypeError:
        return None
    whole = all(len(pair) == 2 and all(isinstance(i, (int, np.integer)) for i in pair) for pair in pairs)
    return [(int(pair[0]), int(pair[1])) for pair in pairs] if whole else None


def _nearest(found: Floats, true: Floats, gate: float, *, of: str) -> Pairs:
    """Pair each found shape with its nearest true one, or each true one with its nearest found one, used or not."""
    apart = _distances(found, true)
    best = apart.min(axis=1 if of == "found" else 0, keepdims=True, initial=np.inf)
    return [(int(f), int(t)) for f, t in np.argwhere((apart == best) & (apart <= gate))]


def _greedy(found: Floats, true: Floats, gate: float, *, order: str) -> Pairs:
    """Make pairs one after the other: in the order of a list, or always the closest that is left."""
    apart = _distances(found, true)

    def rank(pair: tuple[int, int]) -> tuple[float, float]:
        first = {"found": pair[0], "true": pair[1], "closest": 0}[order]
        return first, float(apart[pair])

    pairs: Pairs = []
    for f, t in sorted(((f, t) for f, t in np.ndindex(*apart.shape) if apart[f, t] <= gate), key=rank):
        if all(f != a and t != b for a, b in pairs):
            pairs.append((f, t))
    return pairs


match_shapes = Check(
    "match_shapes",
    best_pairs,
    _match_cases,
    _judge_pairs,
    (
        Fault(
            "Each pair should be (index found, index true), not the other way round.",
            like=lambda *args: [(t, f) for f, t in best_pairs(*args)],
        ),
        Fault("Pairs are made beyond the gate too.", like=lambda f, t, _gate: best_pairs(f, t, OPEN_GATE)),
        Fault(
            "The gate comes too late: a pair that it forbids has taken shapes that others could use.",
            like=lambda f, t, gate: [pair for pair in best_pairs(f, t, OPEN_GATE) if _distances(f, t)[pair] <= gate],
        ),
        Fault(
            "Each takes its nearest, used or not: is a shape free once it stands in a pair?",
            like=(partial(_nearest, of="found"), partial(_nearest, of="true")),
        ),
        Fault(
            "First come, first served: the order of a list must not decide who gets which.",
            like=(partial(_greedy, order="found"), partial(_greedy, order="true")),
        ),
        Fault(
            "The closest pair first is greedy too: it can leave others far apart, or without a partner.",
            like=partial(_greedy, order="closest"),
        ),
    ),
)


# --- what is right ----------------------------------------------------------------------------------------------


def within(errors: Floats, tolerance: float) -> Bools:
    """Return which errors are at most the tolerance, on either side; both in metres."""
    return np.abs(errors) <= tolerance


def _right_cases(rng: np.random.Generator) -> Iterator[Args]:
    """Yield errors on both sides, on the edge, and none at all, then random ones."""
    yield np.array([0.004, -0.004, 0.02, -0.02]), TOLERANCE
    yield np.array([0.125, -0.125, 0.25]), 0.125  # on the edge is right
    yield np.empty(0), TOLERANCE

    def draw(_n: int) -> Args | None:
        errors, tolerance = rng.normal(0, TOLERANCE, int(rng.integers(1, 9))), float(rng.choice([0.001, TOLERANCE]))
        return (errors, tolerance) if np.abs(np.abs(errors) - tolerance).min() > UNDECIDED else None

    yield from random_cases(draw, RIGHT_CASES)


right = Check(
    "right",
    within,
    _right_cases,
    marks("errors", "right"),
    (
        Fault(
            "Values that are far too small count as right: is there an absolute value?",
            like=lambda errors, tolerance: errors <= tolerance,
        ),
        Fault("Exactly the tolerance is still right: < or <= ?", like=lambda errors, limit: np.abs(errors) < limit),
        Fault("Those are the wrong ones.", like=lambda errors, tolerance: ~within(errors, tolerance)),
    ),
)


# --- the three parts of the score -------------------------------------------------------------------------------

Parts = tuple[float, float, float]


def shares(
    found: Sequence[Shape],
    true: Sequence[Shape],
    pairs: Pairs,
    tolerance: float,
    *,
    absolute: bool = True,
    shift: bool = True,
    misses: bool = True,
    alarms: bool = True,
    together: bool = False,
    all_found: bool = False,
    sides_of_any: bool = False,
    kind_first: bool = False,
    per: float = 1.0,
) -> Parts:
    """Return shape, centre and dimension accuracy, 0 to 1, of found shapes with their pairs (index found, index true).

    ``tolerance`` in metres; ``true`` holds one shape at least. Each option that is not at its default is a usual fault.
    """

    def count(errors: Iterable[float]) -> int:
        return sum((abs(e) if absolute else e) <= tolerance + ROUNDING for e in errors)

    matched = [(found[f], true[t]) for f, t in pairs]
    counted = true if misses else [t for _, t in matched]
    false_alarms = (len(found) - (0 if all_found else len(pairs))) if alarms else 0
    same_kind = [(f, t) for f, t in matched if f.kind == t.kind]
    center = [f.centroid - t.centroid for f, t in (same_kind if kind_first else matched)]
    n_center = sum(float(np.hypot(*e)) <= tolerance for e in center) if together else sum(map(count, center))
    sized = matched if sides_of_any else same_kind
    n_dimension = sum(count(_dimension_errors(f, t, shift=shift)) for f, t in sized)
    ways = (
        (len(same_kind), len(counted) + false_alarms),
        (n_center, len(counted) * (1 if together else 2)),
        (n_dimension, sum(len(t.dimensions) for t in counted)),
    )
    a_s, a_c, a_d = (per * n / total if total else 0.0 for n, total in ways)
    return a_s, a_c, a_d


def _dimension_errors(found: Shape, true: Shape, *, shift: bool = True) -> list[float]:
    """Return found - true, metres; of three sides and more under the best cyclic shift."""
    ours, theirs = np.array(found.dimensions), np.array(true.dimensions)
    if len(ours) != len(theirs):  # only a faulty way compares across kinds
        return [a - b for a, b in zip(ours.tolist(), theirs.tolist(), strict=False)]
    shifts = range(len(theirs)) if shift and len(theirs) >= 3 else [0]
    return min(((np.roll(ours, n) - theirs) for n in shifts), key=lambda e: float(np.abs(e).sum())).tolist()


def _parts_cases(rng: np.random.Generator) -> Iterator[Args]:
    """Yield circles that are right, large, small, missed or too many, then random boards with errors of all sorts."""
    a, b = Circle((0.0, 0.0), 0.06), Circle((0.2, 0.0), 0.08)
    yield [a, b], [a, b], [(0, 0), (1, 1)], TOLERANCE
    yield [Circle((-0.02, 0.001), 0.04)], [a], [(0, 0)], TOLERANCE  # too small
    yield [a], [a, b], [(0, 0)], TOLERANCE  # one missed
    yield [b, a], [a], [(1, 0)], TOLERANCE  # one false alarm
    yield [], [a, b], [], TOLERANCE
    square = Polygon([(-0.03, -0.03), (0.03, -0.03), (0.03, 0.03), (-0.03, 0.03)])
    yield [a], [square], [(0, 0)], TOLERANCE  # of the wrong kind, with a radius as long as the sides
    triangle = Polygon([(-0.03, -0.03), (0.03, -0.03), (0.0, 0.06)])
    yield [square], [triangle], [(0, 0)], TOLERANCE  # both are polygons, and not of the same kind
    yield [Circle((0.125, 0.0), 0.25)], [Circle((0.0, 0.0), 0.375)], [(0, 0)], 0.125  # off by exactly the tolerance

    def draw(_n: int) -> Args | None:
        true = list(random_world(int(rng.integers(1, 5)), rng=rng).shapes)
        found = [_near(shape, rng) for shape in true if rng.random() < 0.85]
        found = [found[i] for i in rng.permutation(len(found))]
        if rng.random() < 0.5:
            found.insert(int(rng.integers(len(found) + 1)), Circle(rng.uniform(0.4, 0.5, 2), 0.05))
        pairs = match(found, true, GATE)
        tolerance = float(rng.choice([0.001, TOLERANCE]))
        return (found, true, pairs, tolerance) if _is_clear(found, true, pairs, tolerance) else None

    yield from random_cases(draw, SCORING_CASES)


def _near(shape: Shape, rng: np.random.Generator) -> Shape:
    """Return a shape as it could be found: moved, larger or smaller, from another corner on, or of another kind."""
    offset, larger = rng.normal(0, 0.004, 2), float(rng.normal(1, 0.04))
    other = rng.random() < 0.15
    if isinstance(shape, Circle):
        bearings = 2 * np.pi * np.arange(3) / 3
        if other:
            return Polygon(around(shape.center + offset, shape.radius, bearings))
        return Circle(shape.center + offset, larger * shape.radius)
    corners = np.roll(shape.vertices - shape.centroid, int(rng.integers(len(shape.vertices))), axis=0)
    if other:
        few = len(corners) == 3 or rng.random() < 0.5
        return Circle(shape.centroid + offset, 0.05) if few else Polygon(shape.centroid + offset + corners[1:])
    return Polygon(shape.centroid + offset + larger * corners)


def _is_clear(found: Sequence[Shape], true: Sequence[Shape], pairs: Pairs, tolerance: float) -> bool:
    """Tell whether no value lies on the edge between right and wrong."""
    errors: list[float] = []
    for f, t in ((found[f], true[t]) for f, t in pairs):
        errors += [*(f.centroid - t.centroid), *(_dimension_errors(f, t) if f.kind == t.kind else ())]
    return all(abs(abs(e) - tolerance) > UNDECIDED for e in errors)


parts = Check(
    "parts",
    shares,
    _parts_cases,
    array(),
    (
        Fault(
            "Values that are far too small count as right: is there an absolute value?",
            like=partial(shares, absolute=False),
        ),
        Fault("False alarms cost nothing: each is one more wrong shape.", like=partial(shares, alarms=False)),
        Fault(
            "Missed shapes cost nothing: divide by what is in the truth, not by what was matched.",
            like=partial(shares, misses=False),
        ),
        Fault(
            "Neither misses nor false alarms cost anything: finding less must not score more.",
            like=partial(shares, misses=False, alarms=False),
        ),
        Fault(
            "Sides are compared in the order of the lists: the first corner of one may be another's second.",
            like=partial(shares, shift=False),
        ),
        Fault("x and y of a centre count separately.", like=partial(shares, together=True)),
        Fault(
            "F counts false alarms alone: found shapes that stand in no pair.",
            like=partial(shares, all_found=True),
        ),
        Fault(
            "Sides and radii are compared across kinds: dimensions count only where the kind is right.",
            like=partial(shares, sides_of_any=True),
        ),
        Fault(
            "Centres are compared only where the kind is right: they count for every pair.",
            like=partial(shares, kind_first=True),
        ),
        Fault("That is in per cent: a share goes from 0 to 1.", like=partial(shares, per=100.0)),
    ),
)
