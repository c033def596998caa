"""Lesson 07: which found shape stands for which true one, which errors are right, and the three parts of the score."""

# ruff: noqa: ARG001, ARG005 (a wrong answer may leave out what it is given)

import itertools
import math

import numpy as np
from scipy.optimize import linear_sum_assignment
from scipy.spatial.distance import cdist


def by_permutations(found, true, gate):
    """Every way to give true shapes to found ones, from the most pairs down."""
    for n in range(min(len(found), len(true)), 0, -1):
        ways = [
            (sum(math.dist(found[f], true[t]) for f, t in zip(chosen, given, strict=True)), chosen, given)
            for chosen in itertools.combinations(range(len(found)), n)
            for given in itertools.permutations(range(len(true)), n)
            if all(math.dist(found[f], true[t]) <= gate for f, t in zip(chosen, given, strict=True))
        ]
        if ways:
            _, chosen, given = min(ways)
            return list(zip(chosen, given, strict=True))
    return []


def by_recursion(found, true, gate, free=None):
    """The first found shape gets each of the true ones in turn, or none; the rest is the same task."""
    free = frozenset(range(len(true))) if free is None else free

    def best(f, free):
        if f == len(found):
            return 0, 0.0, ()
        ways = [best(f + 1, free)]
        for t in free:
            apart = math.dist(found[f], true[t])
            if apart <= gate:
                left, total, pairs = best(f + 1, free - {t})
                ways.append((left - 1, total + apart, ((f, t), *pairs)))
        return min(ways)

    return {*best(0, free)[2]}  # a set: the order does not count


def by_assignment(found, true, gate):
    cost = cdist(found, true)
    cost[cost > gate] = 1000.0
    return np.array(
        [(f, t) for f, t in zip(*linear_sum_assignment(cost), strict=True) if cost[f, t] <= gate], dtype=int
    )


def least_squares(found, true, gate):
    cost = cdist(found, true) ** 2
    cost[cost > gate**2] = 1000.0
    return [(f, t) for f, t in zip(*linear_sum_assignment(cost), strict=True) if cost[f, t] <= gate**2]


def more_found_than_true(found, true, gate):
    """The lesson's own words, ``itertools.permutations``, where they give nothing: more was found than there is."""
    best, least = None, math.inf
    for chosen in itertools.permutations(range(len(true)), len(found)):
        total = sum(math.dist(found[f], true[t]) for f, t in enumerate(chosen))
        if total < least:
            best, least = chosen, total
    return [(f, best[f]) for f in range(len(found)) if math.dist(found[f], true[best[f]]) <= gate]


def pairs_turned(found, true, gate):
    return [(t, f) for f, t in by_permutations(found, true, gate)]


def no_gate(found, true, gate):
    return by_permutations(found, true, 100.0)


def gate_last(found, true, gate):
    return [(f, t) for f, t in no_gate(found, true, gate) if math.dist(found[f], true[t]) <= gate]


def nearest_true(found, true, gate):
    pairs = []
    for f, place in enumerate(found):
        if len(true):
            t = min(range(len(true)), key=lambda t: math.dist(place, true[t]))
            pairs += [(f, t)] if math.dist(place, true[t]) <= gate else []
    return pairs


def nearest_found(found, true, gate):
    return [(f, t) for t, f in nearest_true(true, found, gate)]


def first_come(found, true, gate):
    free, pairs = set(range(len(true))), []
    for f, place in enumerate(found):
        near = [t for t in free if math.dist(place, true[t]) <= gate]
        if near:
            t = min(near, key=lambda t: math.dist(place, true[t]))
            free.remove(t)
            pairs.append((f, t))
    return pairs


def first_come_true(found, true, gate):
    return [(f, t) for t, f in first_come(true, found, gate)]


def closest_first(found, true, gate):
    apart, pairs = cdist(found, true), []
    while apart.size and apart.min() <= gate:
        f, t = np.unravel_index(apart.argmin(), apart.shape)
        pairs.append((f, t))
        apart[f], apart[:, t] = np.inf, np.inf
    return pairs


def side_errors(found, true):
    """The best of all turns, by the sum of absolute errors."""
    ours, theirs = list(found.dimensions), list(true.dimensions)
    turns = [ours[n:] + ours[:n] for n in range(len(ours))] if len(ours) > 2 else [ours]
    return min(
        ([a - b for a, b in zip(turn, theirs, strict=True)] for turn in turns),
        key=lambda errors: sum(map(abs, errors)),
    )


def marks(
    found,
    true,
    pairs,
    tolerance,
    *,
    sided=abs,
    sides=side_errors,
    missed=True,
    alarms=True,
    per=1.0,
    paired=0,
    kind_first=False,
    any_kind=False,
    kind=lambda shape: shape.kind,
):
    """Give each value of the truth a mark, one after the other, by looking up its partner."""
    partner = {t: found[f] for f, t in pairs}
    shape, center, dimension = [0.0] * (len(found) - len(pairs) + paired * len(pairs) if alarms else 0), [], []
    for t, truth in enumerate(true):
        mine = partner.get(t)
        if mine is None and not missed:
            continue
        shape.append(mine is not None and kind(mine) == kind(truth))
        same = mine is not None and mine.kind == truth.kind
        there = same if kind_first else mine is not None
        center += [there and sided(mine.centroid[i] - truth.centroid[i]) <= tolerance for i in (0, 1)]
        errors = sides(mine, truth) if same or (any_kind and mine is not None) else [np.inf] * len(truth.dimensions)
        dimension += [sided(e) <= tolerance for e in errors]
    return [per * sum(part) / len(part) if part else 0.0 for part in (shape, center, dimension)]


def wrong(**fault):
    return lambda found, true, pairs, tolerance: marks(found, true, pairs, tolerance, **fault)


def in_list_order(found, true):
    return np.subtract(found.dimensions, true.dimensions)


def across_kinds(found, true):
    """Zip a list of sides with a single radius: neither says a word."""
    if len(found.dimensions) == len(true.dimensions):
        return side_errors(found, true)
    errors = [a - b for a, b in zip(found.dimensions, true.dimensions, strict=False)]
    return errors + [np.inf] * (len(true.dimensions) - len(errors))


def by_distance(found, true, pairs, tolerance):
    partner = {t: found[f] for f, t in pairs}
    away = [math.dist(partner[t].centroid, s.centroid) for t, s in enumerate(true) if t in partner]
    shape, _, dimension = marks(found, true, pairs, tolerance)
    return shape, sum(d <= tolerance for d in away) / len(true), dimension


def counted(found, true, pairs, tolerance):
    return 3 * (len(pairs) / len(true),)


def by_matches(found, true, pairs, tolerance):
    return 3 * (sum(found[f].kind == true[t].kind for f, t in pairs) / len(pairs),)


def in_one(found, true, pairs, tolerance):
    a_s, a_c, a_d = marks(found, true, pairs, tolerance)
    return 0.4 * a_s + 0.3 * a_c + 0.3 * a_d


ANSWERS = {
    "match_shapes": {
        "right": {"permutations": by_permutations, "recursion": by_recursion, "assignment": by_assignment},
        "wrong": {
            "turned": (pairs_turned, "not the other way round"),
            "no gate": (no_gate, "beyond the gate too"),
            "gate last": (gate_last, "The gate comes too late"),
            "nearest true": (nearest_true, "used or not"),
            "nearest found": (nearest_found, "used or not"),
            "first come": (first_come, "First come, first served"),
            "first come, true": (first_come_true, "First come, first served"),
            "closest first": (closest_first, "The closest pair first is greedy too"),
            "from one": (
                lambda found, true, gate: [(f + 1, t + 1) for f, t in by_permutations(found, true, gate)],
                "counted from 0",
            ),
            "nothing": (lambda found, true, gate: None, "is there a return?"),
            "not even one": (lambda found, true, gate: [], "got 0 pairs, 2 are possible"),
            "least squares": (least_squares, "m in all; "),
            "gate not reached": (
                lambda found, true, gate: by_assignment(found, true, gate - 1e-9),
                "got 0",
            ),
        },
        "error": {
            "more found than true": (more_found_than_true, "'NoneType' object is not subscriptable"),
            "an empty list": (
                lambda found, true, gate: [(int(cdist(found, true)[:, t].argmin()), t) for t in range(len(true))],
                "raised ValueError",
            ),
        },
    },
    "right": {
        "right": {"within": lambda errors, tolerance: np.abs(errors) <= tolerance},
        "wrong": {
            "no absolute value": (lambda errors, tolerance: errors <= tolerance, "is there an absolute value?"),
            "strict": (lambda errors, tolerance: np.abs(errors) < tolerance, "< or <= ?"),
            "the wrong ones": (lambda errors, tolerance: np.abs(errors) > tolerance, "Those are the wrong ones"),
            "how many": (lambda errors, tolerance: int((np.abs(errors) <= tolerance).sum()), "for each of the"),
            "all or none": (lambda errors, tolerance: bool(np.all(np.abs(errors) <= tolerance)), "for each of the"),
            "nothing": (lambda errors, tolerance: None, "is there a return?"),
        },
        "error": {"a number alone": (lambda errors, tolerance: [abs(errors[0]) <= tolerance], "raised IndexError")},
    },
    "parts": {
        "right": {"marks": marks},
        "wrong": {
            "no absolute value": (wrong(sided=float), "is there an absolute value?"),
            "no false alarms": (wrong(alarms=False), "False alarms cost nothing"),
            "no misses": (wrong(missed=False), "Missed shapes cost nothing"),
            "neither": (wrong(missed=False, alarms=False), "Neither misses nor false alarms"),
            "in one": (in_one, "expected shape (3,)"),
            "turned round": (lambda *args: marks(*args)[::-1], "expected"),
            "list order": (wrong(sides=in_list_order), "in the order of the lists"),
            "distance": (by_distance, "x and y of a centre count separately"),
            "per cent": (wrong(per=100.0), "in per cent"),
            "all found": (wrong(paired=1), "F counts false alarms alone"),
            "across kinds": (wrong(any_kind=True, sides=across_kinds), "compared across kinds"),
            "kind first": (wrong(kind_first=True), "they count for every pair"),
            "counted": (counted, "For example parts("),
            "of a type": (
                wrong(kind=type),
                "For example parts(found=[rectangle at (0, 0)], true=[triangle at (0, 0)]",
            ),
            "a circle or none": (
                wrong(kind=lambda shape: shape.kind == "circle"),
                "For example parts(found=[rectangle at (0, 0)], true=[triangle at (0, 0)]",
            ),
            "below the tolerance": (
                lambda found, true, pairs, tolerance: marks(found, true, pairs, tolerance - 1e-9),
                "tolerance=0.125): got",
            ),
            "nothing": (lambda found, true, pairs, tolerance: None, "is there a return?"),
        },
        "error": {"nothing found": (by_matches, "raised ZeroDivisionError")},
    },
}
