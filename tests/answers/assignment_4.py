"""Problem set 4: a compass that is off, a score by overlap, the cost of a map, an honest choice."""

# ruff: noqa: ARG001 (a wrong answer may leave out what it is given)

import math
import statistics
from functools import cache
from itertools import combinations, permutations

import numpy as np
from scipy.optimize import linear_sum_assignment, linprog, minimize_scalar
from scipy.spatial import cKDTree

INF = float("inf")


# --- compass_bias ------------------------------------------------------------------------------------------


def hits_with(scans, bias):
    pose, beam = np.nonzero(np.isfinite(scans.ranges))
    bearing = scans.poses[pose, 2] - bias + scans.angles[beam]
    reach = scans.ranges[pose, beam][:, None]
    return scans.poses[pose, :2] + reach * np.column_stack([np.cos(bearing), np.sin(bearing)]), pose


def bias_by_cells(scans):
    """The fewest occupied cells of 4 mm, averaged over neighbouring angles."""
    angles = np.radians(np.arange(-12, 12.01, 0.1))
    counts = [len(np.unique(np.floor(hits_with(scans, angle)[0] / 0.004), axis=0)) for angle in angles]
    smooth = np.convolve(counts, np.ones(7) / 7, mode="valid")
    return float(angles[3:-3][np.argmin(smooth)])


def bias_by_other_scans(scans, apart=-1.0):
    """The least distance from hits to hits of other scans, first coarsely, then finely."""
    turned = np.abs(np.exp(1j * scans.poses[:, 2, None]) - np.exp(1j * scans.poses[:, 2])) > apart
    np.fill_diagonal(turned, False)

    def gap(bias):
        hits, pose = hits_with(scans, bias)
        near, who = cKDTree(hits).query(hits, 8)
        other = np.where(turned[pose[who], pose[:, None]], near, np.inf).min(axis=1)
        return np.minimum(other, 0.05).mean()

    best, step = 0.0, math.radians(1)
    around = best + step * np.arange(-11, 12)
    best = around[np.argmin([gap(bias) for bias in around])]
    around = best + step / 10 * np.arange(-10, 11)
    return float(around[np.argmin([gap(bias) for bias in around])])


def bias_other_sign(scans):
    return -bias_by_other_scans(scans)


def bias_in_degrees(scans):
    return math.degrees(bias_by_other_scans(scans))


def bias_none(scans):
    return 0.0


def bias_coarse(scans):
    """Steps of four degrees, and no second look."""
    angles = np.radians(np.arange(-10, 10.01, 4))
    counts = [len(np.unique(np.floor(hits_with(scans, angle)[0] / 0.004), axis=0)) for angle in angles]
    return float(angles[np.argmin(counts)])


def bias_only_left(scans):
    """Looks for headings that are too large, not for those that are too small."""
    angles = np.radians(np.arange(0, 12, 0.1))
    counts = [len(np.unique(np.floor(hits_with(scans, angle)[0] / 0.004), axis=0)) for angle in angles]
    return float(angles[np.argmin(counts)])


def bias_by_large_cells(scans):
    """Cells as large as the shapes."""
    angles = np.radians(np.arange(-12, 12.01, 0.1))
    counts = [len(np.unique(np.floor(hits_with(scans, angle)[0] / 0.25), axis=0)) for angle in angles]
    return float(angles[np.argmin(counts)])


def bias_by_turned_scans(scans):
    """Compares scans only where the robot has turned in between."""
    return bias_by_other_scans(scans, apart=0.5)


def bias_at_least_one_degree(scans):
    """Takes for granted that the compass is off."""
    angles = np.radians(np.concatenate([np.arange(-11, -1.5, 0.1), np.arange(1.5, 11, 0.1)]))
    maps = [hits_with(scans, angle)[0] for angle in angles]
    return float(angles[np.argmin([cKDTree(hits).query(hits, 6)[0].mean() for hits in maps])])


# --- overlap_score -----------------------------------------------------------------------------------------


def cut(polygon, other):
    """Sutherland and Hodgman: a convex ring, cut by each side of another one."""
    ring = list(polygon)
    for a, b in zip(other, np.roll(other, -1, axis=0), strict=True):
        left = [(b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) for p in ring]
        kept = []
        for k, p in enumerate(ring):
            q, here, there = ring[(k + 1) % len(ring)], left[k], left[(k + 1) % len(ring)]
            if here >= 0:
                kept.append(p)
            if here * there < 0:
                kept.append(p + (q - p) * here / (here - there))
        ring = kept
    return ring


def area(ring):
    if len(ring) < 3:
        return 0.0
    x, y = np.array(ring).T
    return 0.5 * abs(float((x * np.roll(y, -1) - y * np.roll(x, -1)).sum()))


def ring_of(shape):
    return shape.outline(100) if shape.kind == "circle" else shape.vertices


def shared_by_cutting(a, b):
    both = area(cut(ring_of(a), ring_of(b)))
    return both / (area(ring_of(a)) + area(ring_of(b)) - both)


def shared_by_counting(a, b):
    """Both shapes on a fine grid of places around them."""
    if math.dist(a.centroid, b.centroid) > a.reach + b.reach:
        return 0.0
    reach = np.array([a.reach, b.reach])
    low = np.minimum(a.centroid - reach[0], b.centroid - reach[1])
    high = np.maximum(a.centroid + reach[0], b.centroid + reach[1])
    steps = (np.arange(260) + 0.5) / 260
    places = np.stack(np.meshgrid(*(low + (high - low) * steps[:, None]).T), axis=-1).reshape(-1, 2)
    in_a, in_b = a.signed_distance(places) <= 0, b.signed_distance(places) <= 0
    return (in_a & in_b).sum() / (in_a | in_b).sum()


def table_of(share, found, true):
    return np.array([[share(a, b) for b in true] for a in found]).reshape(len(found), len(true))


def overlap_by_trying(found, true):
    """All ways to pair the fewer with the more."""
    if not found or not true:
        return float(not found and not true)
    few, many = sorted((found, true), key=len)
    table = table_of(shared_by_cutting, few, many)
    best = max(sum(table[i, j] for i, j in enumerate(way)) for way in permutations(range(len(many)), len(few)))
    return best / len(many)


def overlap_by_counting(found, true):
    most = max(len(found), len(true))
    table = table_of(shared_by_counting, found, true)
    return table[linear_sum_assignment(table, maximize=True)].sum() / most if most else 1.0


def with_shapely(rule):
    return lambda a, b: rule(a.to_shapely(), b.to_shapely())


def iou(a, b):
    return a.intersection(b).area / a.union(b).area


def best_sum(table):
    return table[linear_sum_assignment(table, maximize=True)].sum()


def overlap_twice(found, true):
    table = table_of(with_shapely(lambda a, b: a.intersection(b).area / (a.area + b.area)), found, true)
    return best_sum(table) / max(len(found), len(true)) if found or true else 1.0


def overlap_of_true(found, true):
    table = table_of(with_shapely(lambda a, b: a.intersection(b).area / b.area), found, true)
    return best_sum(table) / max(len(found), len(true)) if found or true else 1.0


def overlap_of_found(found, true):
    table = table_of(with_shapely(lambda a, b: a.intersection(b).area / a.area), found, true)
    return best_sum(table) / max(len(found), len(true)) if found or true else 1.0


def overlap_nearest(found, true):
    table = table_of(with_shapely(iou), found, true)
    return sum(table.max(axis=0, initial=0.0)) / max(len(found), len(true)) if found or true else 1.0


def overlap_greedy(found, true):
    table, total = table_of(with_shapely(iou), found, true), 0.0
    for _ in range(min(table.shape)):
        i, j = divmod(int(table.argmax()), table.shape[1])
        total += table[i, j]
        table = np.delete(np.delete(table, i, axis=0), j, axis=1)
    return total / max(len(found), len(true)) if found or true else 1.0


def overlap_free_alarms(found, true):
    return best_sum(table_of(with_shapely(iou), found, true)) / len(true) if true else 1.0


def overlap_free_misses(found, true):
    return best_sum(table_of(with_shapely(iou), found, true)) / len(found) if found else 1.0


def overlap_empty(found, true):
    most = max(len(found), len(true))
    return best_sum(table_of(with_shapely(iou), found, true)) / most if most else 0.0


def overlap_divides(found, true):
    return best_sum(table_of(with_shapely(iou), list(found), list(true))).item() / max(len(found), len(true))


# --- map_cost ----------------------------------------------------------------------------------------------


def cost_by_trying(found, true, miss, alarm):
    """One found shape after the other: a false alarm, or paired with one that is still free."""

    @cache
    def least(k, free):
        if k == len(found):
            return miss * len(free)
        alone = alarm + least(k + 1, free)
        return min([alone, *(math.dist(found[k], true[j]) + least(k + 1, free - {j}) for j in free)])

    return least(0, frozenset(range(len(true))))


def cost_by_table(found, true, miss, alarm):
    """A table with a stand-in for everyone: a miss for each true shape, an alarm for each found one."""
    F, T = len(found), len(true)
    table = np.full((F + T, T + F), 1e9)
    for i in range(F):
        for j in range(T):
            table[i, j] = math.dist(found[i], true[j])
        table[i, T + i] = alarm
    for j in range(T):
        table[F + j, j] = miss
    table[F:, T:] = 0.0
    rows, columns = linear_sum_assignment(table)
    return float(table[rows, columns].sum())


def distances(found, true):
    return np.linalg.norm(found[:, None] - true[None], axis=2)


def cost_swapped(found, true, miss, alarm):
    return cost_by_table(found, true, alarm, miss)


def cost_forced(found, true, miss, alarm):
    table = distances(found, true)
    rows, columns = linear_sum_assignment(table)
    return table[rows, columns].sum() + miss * (len(true) - len(rows)) + alarm * (len(found) - len(rows))


def cost_nearest(found, true, miss, alarm):
    cost, used = 0.0, set()
    for place in true:
        away = [math.dist(place, other) for other in found]
        if away and min(away) < miss + alarm:
            cost += min(away)
            used.add(away.index(min(away)))
        else:
            cost += miss
    return cost + alarm * (len(found) - len(used))


def cost_greedy(found, true, miss, alarm):
    pairs = sorted((math.dist(p, q), i, j) for i, p in enumerate(found) for j, q in enumerate(true))
    cost, ours, theirs = 0.0, set(range(len(found))), set(range(len(true)))
    for away, i, j in pairs:
        if away < miss + alarm and i in ours and j in theirs:
            cost += away
            ours.remove(i)
            theirs.remove(j)
    return cost + alarm * len(ours) + miss * len(theirs)


def cost_early(found, true, miss, alarm):
    table = distances(found, true)
    gain = np.where(table > miss, 0.0, table - miss - alarm)
    return miss * len(true) + alarm * len(found) + gain[linear_sum_assignment(gain)].sum()


def cost_free_alarms(found, true, miss, alarm):
    table = distances(found, true) - miss - alarm
    gain = np.minimum(table, 0.0)
    rows, columns = linear_sum_assignment(gain)
    paired = (gain[rows, columns] < 0).sum()
    return gain[rows, columns].sum() + miss * len(true) + alarm * paired


def cost_unshaped(found, true, miss, alarm):
    """Falls over an empty side."""
    away = [min(math.dist(p, q) for q in true) for p in found]
    return cost_by_table(found, true, miss, alarm) if min(away) >= 0 else 0.0


# --- honest_score ------------------------------------------------------------------------------------------


def honest_by_loop(scores, folds):
    total = 0.0
    table = [[0.0 if math.isnan(value) else float(value) for value in row] for row in scores]
    for fold in set(folds.tolist()):
        best, most = None, -1.0
        for row in table:
            train = [value for value, own in zip(row, folds, strict=True) if own != fold]
            mean = sum(train) / len(train)
            if mean > most + 1e-12:
                best, most = row, mean
        total += sum(value for value, own in zip(best, folds, strict=True) if own == fold)
    return total / len(folds)


def honest_by_matrices(scores, folds):
    """What all maps add up to, without what a fold adds up to."""
    table = np.where(np.isnan(scores), 0.0, scores)
    names, index = np.unique(folds, return_inverse=True)
    member = np.eye(len(names))[index]
    train = table.sum(axis=1, keepdims=True) - table @ member
    best = np.argmax(np.round(train, 12), axis=0)
    return table[best[index], np.arange(len(folds))].mean()


def honest_general(scores, folds, choose, clean=True):
    table = np.nan_to_num(scores) if clean else scores
    own = np.empty(len(folds))
    for fold in np.unique(folds):
        test = folds == fold
        own[test] = table[choose(table, test)][test]
    return own


def best_row(table):
    return int(np.argmax(table.mean(axis=1)))


def honest_on_test(scores, folds):
    return honest_general(scores, folds, lambda table, test: best_row(table[:, test])).mean()


def honest_on_all(scores, folds):
    return np.nan_to_num(scores).mean(axis=1).max()


def honest_each_map(scores, folds):
    return np.nanmax(scores, axis=0).mean()


def honest_folds_means(scores, folds):
    own = honest_general(scores, folds, lambda table, test: best_row(table[:, ~test]))
    return np.mean([own[folds == fold].mean() for fold in np.unique(folds)])


def honest_left_out(scores, folds):
    own = honest_general(
        scores, folds, lambda table, test: int(np.argmax(np.nanmean(table[:, ~test], axis=1))), clean=False
    )
    return np.nanmean(own)


def honest_last(scores, folds):
    return honest_general(scores, folds, lambda table, test: len(table) - 1 - best_row(table[::-1][:, ~test])).mean()


def honest_nan(scores, folds):
    return float(honest_general(scores, folds, lambda table, test: best_row(table[:, ~test]), clean=False).mean())


# --- other right ways, and other wrong ones --------------------------------------------------------------------


def blur_of(scans, bias, k=6):
    hits = hits_with(scans, bias)[0]
    return cKDTree(hits).query(hits, k)[0][:, 1:].mean()


def bias_by_golden_section(scans):
    """The mean distance to the next five hits, coarsely, then by golden sections."""
    start = min(np.radians(np.arange(-11, 12)), key=lambda bias: blur_of(scans, bias))
    bracket = (start - math.radians(1), start, start + math.radians(1))
    fine = minimize_scalar(lambda bias: blur_of(scans, bias), bracket=bracket, options={"xtol": 1e-3}).x
    around = fine + np.radians(np.arange(-1, 1.01, 0.1))
    return float(min(around, key=lambda bias: blur_of(scans, bias)))


def bias_by_crowds(scans):
    """How many hits lie within 4 mm of each other: the most in the sharpest map, a mean over neighbouring angles."""
    angles = np.radians(np.arange(-11.5, 11.55, 0.1))
    pairs = [
        cKDTree(hits_with(scans, angle)[0]).count_neighbors(cKDTree(hits_with(scans, angle)[0]), 0.004)
        for angle in angles
    ]
    smooth = np.convolve(pairs, np.ones(5) / 5, mode="valid")
    return float(angles[2:-2][smooth.argmax()])


def bias_by_bands(scans):
    """All angles at once, every tenth of a degree, distances to the eight nearest hits; smoothed."""
    angles = np.radians(np.arange(-11, 11.05, 0.1))
    costs = np.convolve([blur_of(scans, angle, 8) for angle in angles], np.ones(5) / 5, mode="valid")
    return angles[2:-2][costs.argmin()].item()


def bias_first_heading(scans):
    """As if the robot had set out at a heading of 0."""
    return float(scans.poses[0, 2])


def bias_twice(scans):
    return 2 * bias_by_other_scans(scans) or math.radians(2)


def bias_unsigned(scans):
    """How much, and not which way."""
    return abs(bias_by_other_scans(scans))


def overlap_by_choice(found, true):
    """One found shape after the other: left alone, or with one that is free."""
    ours, theirs = [[shape.to_shapely() for shape in some] for some in (found, true)]

    @cache
    def most(k, free):
        if k == len(ours):
            return 0.0
        return max([most(k + 1, free), *(iou(ours[k], theirs[j]) + most(k + 1, free - {j}) for j in free)])

    largest = max(len(ours), len(theirs))
    return most(0, frozenset(range(len(theirs)))) / largest if largest else 1.0


def overlap_by_areas(found, true):
    """|a| + |b| - |a and b| below the fraction bar; the table made square with noughts."""
    n = max(len(found), len(true))
    if n == 0:
        return 1
    table = np.zeros((n, n))
    for i, a in enumerate(found):
        for j, b in enumerate(true):
            both = a.to_shapely().intersection(b.to_shapely()).area
            table[i, j] = both / (a.to_shapely().area + b.to_shapely().area - both)
    return sum(table[pair] for pair in zip(*linear_sum_assignment(1 - table), strict=True)) / n


def overlap_by_graph(found, true):
    """All orders of the square table."""
    n = max(len(found), len(true))
    pairs = {(i, j): iou(a.to_shapely(), b.to_shapely()) for i, a in enumerate(found) for j, b in enumerate(true)}
    ways = (sum(pairs.get((i, j), 0.0) for i, j in enumerate(way)) for way in permutations(range(n)))
    return max(ways) / n if n else 1.0


def overlap_mean_of_pairs(found, true):
    """Over the pairs alone."""
    pairs = min(len(found), len(true))
    return best_sum(table_of(with_shapely(iou), found, true)) / pairs if pairs else float(not found and not true)


def cost_by_bits(found, true, miss, alarm):
    """The least cost for each set of true shapes that are taken."""
    best = {0: 0.0}
    for place in found:
        after = {}
        for taken, cost in best.items():
            ways = [(taken, alarm)]
            ways += [(taken | 1 << j, math.dist(place, true[j])) for j in range(len(true)) if not taken >> j & 1]
            for now, more in ways:
                after[now] = min(after.get(now, INF), cost + more)
        best = after
    return min(cost + miss * (len(true) - taken.bit_count()) for taken, cost in best.items())


def cost_by_linear_program(found, true, miss, alarm):
    """What pairs save, under the rule that nobody stands in two."""
    F, T = len(found), len(true)
    alone = miss * T + alarm * F
    if not F or not T:
        return alone
    rules = np.vstack([np.kron(np.eye(F), np.ones(T)), np.kron(np.ones(F), np.eye(T))])
    saved = distances(found, true).ravel() - miss - alarm
    return alone + linprog(saved, A_ub=rules, b_ub=np.ones(F + T), bounds=(0, 1)).fun


def cost_by_subsets(found, true, miss, alarm):
    """Each number of pairs, each choice of those who are paired, each order."""
    F, T = len(found), len(true)
    costs = [F * alarm + T * miss]
    for n in range(1, min(F, T) + 1):
        alone = (F - n) * alarm + (T - n) * miss
        for ours in combinations(range(F), n):
            for theirs in permutations(range(T), n):
                costs.append(alone + sum(math.dist(found[i], true[j]) for i, j in zip(ours, theirs, strict=True)))
    return min(costs)


def cost_squared(found, true, miss, alarm):
    gain = np.minimum(distances(found, true) ** 2 - miss - alarm, 0.0)
    return miss * len(true) + alarm * len(found) + gain[linear_sum_assignment(gain)].sum()


def cost_alone(found, true, miss, alarm):
    """Nobody is paired."""
    return miss * len(true) + alarm * len(found)


def cost_free_misses(found, true, miss, alarm):
    gain = np.minimum(distances(found, true) - miss - alarm, 0.0)
    rows, columns = linear_sum_assignment(gain)
    return gain[rows, columns].sum() + alarm * len(found) + miss * (gain[rows, columns] < 0).sum()


def honest_by_statistics(scores, folds):
    """Plain lists and the standard library's exact mean."""
    rows = [[0.0 if value != value else float(value) for value in row] for row in scores]

    def own(k):
        others = [m for m, fold in enumerate(folds) if fold != folds[k]]
        return max(rows, key=lambda row: round(statistics.fmean(row[m] for m in others), 12))[k]

    return statistics.fmean(own(k) for k in range(len(folds)))


def honest_by_weights(scores, folds):
    """Means as a product with weights."""
    table = np.where(np.isfinite(scores), scores, 0.0)
    others = (np.asarray(folds)[:, None] != folds).astype(float)
    means = table @ (others / others.sum(axis=0))
    first = (means > means.max(axis=0) - 1e-12).argmax(axis=0)
    return float(np.take_along_axis(table, first[None], axis=0).mean())


def honest_by_frames(scores, folds):
    """Fold by fold, what was learnt kept in a dictionary."""
    clean = np.array(scores, dtype=float)
    clean[np.isnan(clean)] = 0
    choice = {
        f: int(np.argmax(np.delete(clean, np.flatnonzero(folds == f), axis=1).sum(axis=1).round(12))) for f in folds
    }
    return sum(clean[choice[f], k] for k, f in enumerate(folds)) / len(folds)


def honest_by_median(scores, folds):
    return honest_general(scores, folds, lambda table, test: int(np.argmax(np.median(table[:, ~test], axis=1)))).mean()


def honest_first(scores, folds):
    """No choice at all."""
    return np.nan_to_num(scores)[0].mean()


def honest_worst(scores, folds):
    return honest_general(scores, folds, lambda table, test: int(np.argmin(table[:, ~test].mean(axis=1)))).mean()


# Each wrong answer with what it loses (v: the visible tests; 1, 2, ...: hidden parts), and the short name of its fault.
ANSWERS = {
    "compass_bias": {
        "right": {
            "golden section": bias_by_golden_section,
            "crowds": bias_by_crowds,
            "bands": bias_by_bands,
            "cells": bias_by_cells,
            "other scans": bias_by_other_scans,
        },
        "wrong": {
            "first heading": (bias_first_heading, "123", None),
            "twice": (bias_twice, "v123", None),
            "unsigned": (bias_unsigned, "v123", None),
            "other sign": (bias_other_sign, "v123", "sign turned round"),
            "degrees": (bias_in_degrees, "v123", "degrees for radians"),
            "none": (bias_none, "v123", "no bias"),
            "coarse": (bias_coarse, "v123", "steps too coarse"),
            "only left": (bias_only_left, "v123", None),
            "large cells": (bias_by_large_cells, "v123", None),
            "turned scans": (bias_by_turned_scans, "v1", None),
            "at least one": (bias_at_least_one_degree, "3", "steps too coarse"),
        },
    },
    "overlap_score": {
        "right": {
            "choice": overlap_by_choice,
            "areas": overlap_by_areas,
            "all orders": overlap_by_graph,
            "trying": overlap_by_trying,
            "counting": overlap_by_counting,
        },
        "wrong": {
            "mean of pairs": (overlap_mean_of_pairs, "v3", None),
            "twice": (overlap_twice, "v123", "overlap counted twice"),
            "of the true": (overlap_of_true, "v123", "share of the true shape"),
            "of the found": (overlap_of_found, "v123", "share of the found shape"),
            "nearest": (overlap_nearest, "2", "not one-to-one"),
            "greedy": (overlap_greedy, "2", "greedy pairs"),
            "free alarms": (overlap_free_alarms, "34", "false alarms are free"),
            "free misses": (overlap_free_misses, "v34", "misses are free"),
            "empty": (overlap_empty, "4", "nothing right on an empty board"),
            "divides by none": (overlap_divides, "4", "raises ZeroDivisionError"),
        },
    },
    "map_cost": {
        "right": {
            "bits": cost_by_bits,
            "linear program": cost_by_linear_program,
            "subsets": cost_by_subsets,
            "trying": cost_by_trying,
            "table": cost_by_table,
        },
        "wrong": {
            "squared": (cost_squared, "v123", None),
            "alone": (cost_alone, "v123", None),
            "free misses": (cost_free_misses, "v234", None),
            "swapped": (cost_swapped, "v34", "weights changed places"),
            "forced": (cost_forced, "v23", "everyone is paired"),
            "nearest": (cost_nearest, "123", "not one-to-one"),
            "greedy": (cost_greedy, "1", "greedy pairs"),
            "early": (cost_early, "23", "broken up too early"),
            "free alarms": (cost_free_alarms, "v234", "false alarms are free"),
            "empty side": (cost_unshaped, "4", "raises ValueError"),
        },
    },
    "honest_score": {
        "right": {
            "statistics": honest_by_statistics,
            "weights": honest_by_weights,
            "dictionary": honest_by_frames,
            "loop": honest_by_loop,
            "matrices": honest_by_matrices,
        },
        "wrong": {
            "median": (honest_by_median, "1234", None),
            "first": (honest_first, "v1234", None),
            "worst": (honest_worst, "v1234", None),
            "on the test maps": (honest_on_test, "v1234", "chosen on the test maps"),
            "on all maps": (honest_on_all, "v1234", "chosen on all maps"),
            "each map": (honest_each_map, "v1234", "best of each map"),
            "folds' means": (honest_folds_means, "v2", "mean of the folds' means"),
            "left out": (honest_left_out, "3", "crashes left out"),
            "last": (honest_last, "4", "last of ties"),
            "nan": (honest_nan, "3", "nan spreads"),
        },
    },
}
