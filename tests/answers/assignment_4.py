"""Problem set 4: a compass that is off, a score by overlap, the cost of a map, an honest choice."""

# ruff: noqa: ARG001 (a wrong answer may leave out what it is given)

import math
from functools import cache
from itertools import permutations

import numpy as np
from scipy.optimize import linear_sum_assignment
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


def bias_by_other_scans(scans):
    """The least distance from hits to hits of other scans, first coarsely, then finely."""

    def gap(bias):
        hits, pose = hits_with(scans, bias)
        near, who = cKDTree(hits).query(hits, 8)
        other = np.where(pose[who] != pose[:, None], near, np.inf).min(axis=1)
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


def bias_by_fine_cells(scans):
    """Cells much smaller than the noise."""
    angles = np.radians(np.arange(-12, 12.01, 0.1))
    counts = [len(np.unique(np.floor(hits_with(scans, angle)[0] / 0.0005), axis=0)) for angle in angles]
    return float(angles[np.argmin(counts)])


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


# Each wrong answer with the points that it gets of the task's five, and the short name of its fault.
ANSWERS = {
    "compass_bias": {
        "right": {"cells": bias_by_cells, "other scans": bias_by_other_scans},
        "wrong": {
            "other sign": (bias_other_sign, 0, "sign turned round"),
            "degrees": (bias_in_degrees, 0, "degrees for radians"),
            "none": (bias_none, 0, "no bias"),
            "coarse": (bias_coarse, 0, "steps too coarse"),
            "only left": (bias_only_left, 0, None),
            "fine cells": (bias_by_fine_cells, 2, None),
            "at least one": (bias_at_least_one_degree, 4, "steps too coarse"),
        },
    },
    "overlap_score": {
        "right": {"trying": overlap_by_trying, "counting": overlap_by_counting},
        "wrong": {
            "twice": (overlap_twice, 1, "overlap counted twice"),
            "of the true": (overlap_of_true, 1, "share of the true shape"),
            "of the found": (overlap_of_found, 1, "share of the found shape"),
            "nearest": (overlap_nearest, 4, "not one-to-one"),
            "greedy": (overlap_greedy, 4, "greedy pairs"),
            "free alarms": (overlap_free_alarms, 3, "false alarms are free"),
            "free misses": (overlap_free_misses, 2, "misses are free"),
            "empty": (overlap_empty, 4, "nothing right on an empty board"),
            "divides by none": (overlap_divides, 4, "raises ZeroDivisionError"),
        },
    },
    "map_cost": {
        "right": {"trying": cost_by_trying, "table": cost_by_table},
        "wrong": {
            "swapped": (cost_swapped, 2, "weights changed places"),
            "forced": (cost_forced, 2, "everyone is paired"),
            "nearest": (cost_nearest, 2, "not one-to-one"),
            "greedy": (cost_greedy, 3, "greedy pairs"),
            "early": (cost_early, 3, "broken up too early"),
            "free alarms": (cost_free_alarms, 1, "false alarms are free"),
            "empty side": (cost_unshaped, 4, "raises ValueError"),
        },
    },
    "honest_score": {
        "right": {"loop": honest_by_loop, "matrices": honest_by_matrices},
        "wrong": {
            "on the test maps": (honest_on_test, 0, "chosen on the test maps"),
            "on all maps": (honest_on_all, 0, "chosen on all maps"),
            "each map": (honest_each_map, 0, "best of each map"),
            "folds' means": (honest_folds_means, 3, "mean of the folds' means"),
            "left out": (honest_left_out, 4, "crashes left out"),
            "last": (honest_last, 4, "last of ties"),
            "nan": (honest_nan, 4, "nan spreads"),
        },
    },
}
