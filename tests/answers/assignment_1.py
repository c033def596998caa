"""Problem set 1: a curved wall, a sonar with a wide cone, a grid that counts."""

# ruff: noqa: ARG001, ARG005 (a wrong answer may leave out what it is given)

import cmath
import math
from collections import Counter

import numpy as np

INF = float("inf")
TURN = 2 * math.pi


# --- ray_arc -----------------------------------------------------------------------------------------------


def arc_by_formula(origin, direction, center, radius, start, sweep):
    """The quadratic equation, and the hit's angle from the middle of the wall."""
    b, c = 2 * (origin - center) @ direction, (origin - center) @ (origin - center) - radius**2
    if b * b < 4 * c:
        return INF
    middle = np.array([math.cos(start + sweep / 2), math.sin(start + sweep / 2)])
    hits = [(-b + sign * math.sqrt(b * b - 4 * c)) / 2 for sign in (-1, 1)]
    hits = [t for t in hits if t >= 0 and (origin + t * direction - center) @ middle >= radius * math.cos(sweep / 2)]
    return min(hits, default=INF)


def arc_by_complex_numbers(origin, direction, center, radius, start, sweep):
    """Turn the world so that the beam runs along the real axis."""
    turn = complex(*direction).conjugate()
    place = (complex(*center) - complex(*origin)) * turn
    if abs(place.imag) > radius:
        return INF
    half = math.sqrt(radius**2 - place.imag**2)
    for t in (place.real - half, place.real + half):
        out = (t - place) * turn.conjugate() * cmath.exp(-1j * start)
        if t >= 0 and cmath.phase(out) % TURN <= sweep:
            return t
    return INF


def arc_by_bisection(origin, direction, center, radius, start, sweep):
    """The full circle's crossings by bisection between the foot of the perpendicular and far out on each side."""
    along = float((center - origin) @ direction)
    foot = origin + along * direction
    if math.dist(foot, center) > radius:
        return INF
    found = []
    for sign in (-1, 1):
        low, high = 0.0, 2 * radius
        for _ in range(200):
            middle = (low + high) / 2
            low, high = (
                (middle, high) if math.dist(foot + sign * middle * direction, center) < radius else (low, middle)
            )
        t = along + sign * low
        x, y = origin + t * direction - center
        if t >= 0 and (math.atan2(y, x) - start) % TURN <= sweep:
            found.append(t)
    return min(found, default=INF)


def arc_general(origin, direction, center, radius, start, sweep, signs=(-1, 1), ahead=True, on=None):
    to_center = center - origin
    along = to_center @ direction
    under = radius**2 - to_center @ to_center + along**2
    if under < 0:
        return INF
    for sign in signs:
        t = along + sign * math.sqrt(under)
        x, y = origin + t * direction - center
        bearing = math.atan2(y, x)
        met = (bearing - start) % TURN <= sweep if on is None else on(bearing, start, sweep)
        if met and (t >= 0 or not ahead):
            return float(t)
    return INF


def arc_from_the_wall(origin, direction, center, radius, start, sweep):
    """Measures from the wall to the robot."""
    t = arc_by_formula(origin, direction, center, radius, start, sweep)
    return t if t == INF else -t


def arc_near(origin, direction, center, radius, start, sweep):
    return arc_general(origin, direction, center, radius, start, sweep, signs=(-1,))


def arc_whole(origin, direction, center, radius, start, sweep):
    return arc_general(origin, direction, center, radius, start, sweep, on=lambda bearing, start, sweep: True)


def arc_far_first(origin, direction, center, radius, start, sweep):
    return arc_general(origin, direction, center, radius, start, sweep, signs=(1, -1))


def arc_behind(origin, direction, center, radius, start, sweep):
    return arc_general(origin, direction, center, radius, start, sweep, ahead=False)


def arc_clockwise(origin, direction, center, radius, start, sweep):
    return arc_general(
        origin, direction, center, radius, start, sweep, on=lambda b, start, sweep: (start - b) % TURN <= sweep
    )


def arc_not_wrapped(origin, direction, center, radius, start, sweep):
    return arc_general(
        origin, direction, center, radius, start, sweep, on=lambda b, start, sweep: start <= b <= start + sweep
    )


def arc_wrapped_once(origin, direction, center, radius, start, sweep):
    return arc_general(
        origin, direction, center, radius, start, sweep, on=lambda b, start, sweep: start <= b % TURN <= start + sweep
    )


def arc_to_the_end(origin, direction, center, radius, start, sweep):
    return arc_general(
        origin,
        direction,
        center,
        radius,
        start,
        sweep,
        on=lambda b, start, end: (b - start) % TURN <= (end - start) % TURN,
    )


def arc_from_robot(origin, direction, center, radius, start, sweep):
    bearing = math.atan2(direction[1], direction[0])
    if (bearing - start) % TURN > sweep:
        return INF
    return arc_whole(origin, direction, center, radius, start, sweep)


def arc_none(origin, direction, center, radius, start, sweep):
    t = arc_by_formula(origin, direction, center, radius, start, sweep)
    return None if t == INF else t


def arc_raises(origin, direction, center, radius, start, sweep):
    to_center = center - origin
    along = to_center @ direction
    t = along - math.sqrt(radius**2 - to_center @ to_center + along**2)  # less than nothing under the root
    return arc_by_formula(origin, direction, center, radius, start, sweep) if t == t else INF


# --- sonar_reading -----------------------------------------------------------------------------------------


def sonar_by_loop(ranges, angles, axis, cone, range_min, range_max):
    best = math.inf
    for distance, angle in zip(ranges, angles, strict=True):
        away = (angle - axis) % TURN
        if min(away, TURN - away) <= cone / 2 and range_min <= distance <= range_max:
            best = min(best, distance)
    return best


def sonar_by_cosine(ranges, angles, axis, cone, range_min, range_max):
    """How far an arrow lies from the axis, from the product of the two; echoes in the order of their distance."""
    near = np.cos(angles - axis) >= np.cos(min(cone / 2, np.pi))
    heard = np.sort(ranges[near & np.isfinite(ranges)])
    heard = heard[np.searchsorted(heard, range_min) :]
    return float(heard[0]) if len(heard) and heard[0] <= range_max else INF


def sonar_general(ranges, angles, axis, cone, read, half=0.5, wrapped=True):
    away = np.abs(angles - axis)
    if wrapped:
        away = np.minimum(away % TURN, -away % TURN)
    mine = ranges[away <= half * cone]
    return float(read(mine))


def least(values):
    return min(values.tolist(), default=INF)


def sonar_twice_as_wide(ranges, angles, axis, cone, range_min, range_max):
    return sonar_general(ranges, angles, axis, cone, lambda r: least(r[(r >= range_min) & (r <= range_max)]), half=1.0)


def sonar_all_around(ranges, angles, axis, cone, range_min, range_max):
    return min((r for r in ranges if range_min <= r <= range_max), default=INF)


def sonar_not_wrapped(ranges, angles, axis, cone, range_min, range_max):
    return sonar_general(
        ranges, angles, axis, cone, lambda r: least(r[(r >= range_min) & (r <= range_max)]), wrapped=False
    )


def sonar_hidden(ranges, angles, axis, cone, range_min, range_max):
    nearest = sonar_general(ranges, angles, axis, cone, lambda r: least(r[~np.isnan(r)]))
    return nearest if range_min <= nearest <= range_max else INF


def sonar_cut(ranges, angles, axis, cone, range_min, range_max):
    nearest = sonar_general(ranges, angles, axis, cone, lambda r: least(r[~np.isnan(r)]))
    return nearest if nearest == INF else min(max(nearest, range_min), range_max)


def sonar_no_min(ranges, angles, axis, cone, range_min, range_max):
    return sonar_general(ranges, angles, axis, cone, lambda r: least(r[r <= range_max]))


def sonar_no_max(ranges, angles, axis, cone, range_min, range_max):
    return sonar_general(ranges, angles, axis, cone, lambda r: least(r[r >= range_min]))


def sonar_mean(ranges, angles, axis, cone, range_min, range_max):
    def mean(r):
        r = r[(r >= range_min) & (r <= range_max)]
        return r.mean() if len(r) else INF

    return sonar_general(ranges, angles, axis, cone, mean)


def sonar_nan(ranges, angles, axis, cone, range_min, range_max):
    """Drops what is out of the limits, and keeps what is no number."""
    return sonar_general(
        ranges, angles, axis, cone, lambda r: np.min(r[~((r < range_min) | (r > range_max))], initial=INF)
    )


def sonar_argmin(ranges, angles, axis, cone, range_min, range_max):
    """Fails on a cone that holds nothing."""
    return sonar_general(ranges, angles, axis, cone, lambda r: np.min(r[(r >= range_min) & (r <= range_max)]))


# --- busy_cells --------------------------------------------------------------------------------------------


def busy_by_counter(points, corner, resolution, shape, least):
    count = Counter()
    for x, y in points.tolist():
        i, j = math.floor((x - corner[0]) / resolution), math.floor((y - corner[1]) / resolution)
        if 0 <= i < shape[0] and 0 <= j < shape[1]:
            count[i, j] += 1
    return [
        (corner[0] + (i + 0.5) * resolution, corner[1] + (j + 0.5) * resolution)
        for (i, j), hits in count.items()
        if hits >= least
    ]


def busy_by_table(points, corner, resolution, shape, least):
    """A table with a frame of one cell around the board, which takes what lies beside it."""
    cells = np.clip(np.floor((points - corner) / resolution).astype(int), -1, shape) + 1
    table = np.bincount(cells[:, 0] * (shape[1] + 2) + cells[:, 1], minlength=(shape[0] + 2) * (shape[1] + 2))
    table = table.reshape(shape[0] + 2, shape[1] + 2)[1:-1, 1:-1]
    return corner + resolution / 2 + resolution * np.argwhere(table >= least)


def busy_general(points, corner, resolution, shape, least, cut=np.floor, start=None, on=True):
    cells = cut((points - (corner if start is None else start)) / resolution)
    if on:
        cells = cells[(cells >= 0).all(axis=1) & (cells < np.array(shape)).all(axis=1)]
    count = Counter(map(tuple, cells.tolist()))
    return np.array([cell for cell, hits in count.items() if hits >= least]).reshape(-1, 2)


def busy_corner(points, corner, resolution, shape, least):
    return corner + resolution * busy_general(points, corner, resolution, shape, least)


def busy_origin(points, corner, resolution, shape, least):
    cells = busy_general(points, corner, resolution, shape, least, start=np.zeros(2))
    return corner + resolution * (cells + 0.5)


def busy_from_corner(points, corner, resolution, shape, least):
    return resolution * (busy_general(points, corner, resolution, shape, least) + 0.5)


def busy_numbers(points, corner, resolution, shape, least):
    return busy_general(points, corner, resolution, shape, least)


def busy_more_than(points, corner, resolution, shape, least):
    return corner + resolution * (busy_general(points, corner, resolution, shape, least + 1) + 0.5)


def busy_any(points, corner, resolution, shape, least):
    return corner + resolution * (busy_general(points, corner, resolution, shape, 1) + 0.5)


def busy_beside(points, corner, resolution, shape, least):
    return corner + resolution * (busy_general(points, corner, resolution, shape, least, on=False) + 0.5)


def busy_table(points, corner, resolution, shape, least):
    """Counts in a table, without a look at who is beside it."""
    table = np.zeros(shape, dtype=int)
    cells = np.floor((points - corner) / resolution).astype(int)
    np.add.at(table, (cells[:, 0], cells[:, 1]), 1)
    return corner + resolution * (np.argwhere(table >= least) + 0.5)


def busy_half_checked(points, corner, resolution, shape, least):
    table = np.zeros(shape, dtype=int)
    cells = np.floor((points - corner) / resolution).astype(int)
    cells = cells[(cells < np.array(shape)).all(axis=1)]
    np.add.at(table, (cells[:, 0], cells[:, 1]), 1)
    return corner + resolution * (np.argwhere(table >= least) + 0.5)


def busy_clipped(points, corner, resolution, shape, least):
    table = np.zeros(shape, dtype=int)
    i, j = np.clip(np.floor((points - corner) / resolution), 0, np.array(shape) - 1).astype(int).T
    np.add.at(table, (i, j), 1)
    return corner + resolution * (np.argwhere(table >= least) + 0.5)


def busy_int(points, corner, resolution, shape, least):
    return corner + resolution * (busy_general(points, corner, resolution, shape, least, cut=np.trunc) + 0.5)


def busy_round(points, corner, resolution, shape, least):
    return corner + resolution * (busy_general(points, corner, resolution, shape, least, cut=np.round) + 0.5)


def busy_upper(points, corner, resolution, shape, least):
    cells = busy_general(points, corner, resolution, shape, least, cut=lambda place: np.ceil(place) - 1)
    return corner + resolution * (cells + 0.5)


def busy_histogram(points, corner, resolution, shape, least):
    """NumPy's histogram counts its far border to its last cell."""
    edges = [corner[axis] + resolution * np.arange(shape[axis] + 1) for axis in (0, 1)]
    hits = np.histogram2d(*points.T, bins=edges)[0]
    return corner + resolution * (np.argwhere(hits >= least) + 0.5)


def busy_swapped(points, corner, resolution, shape, least):
    return corner + resolution * (busy_general(points, corner, resolution, shape[::-1], least) + 0.5)


def busy_in_place(points, corner, resolution, shape, least):
    points -= corner
    return busy_by_counter(points + corner, corner, resolution, shape, least)


def busy_by_boxes(points, corner, resolution, shape, least):
    """Every cell of a small board as a half-open box; the large one of the example by its busy part alone."""
    centers = busy_general(points, corner, resolution, shape, least) + 0.5
    return [tuple(center) for center in corner + resolution * centers]


# --- other right ways, and other wrong ones --------------------------------------------------------------------


def arc_by_roots(origin, direction, center, radius, start, sweep):
    """The roots of a polynomial; a hit as a complex number, turned back by the start."""
    w = origin - center
    roots = np.roots([1.0, 2 * w @ direction, w @ w - radius**2])
    real = sorted(t.real for t in roots if abs(t.imag) < 1e-12)
    out = [complex(*(w + t * direction)) * cmath.exp(-1j * (start + sweep / 2)) for t in real]
    return next((t for t, z in zip(real, out, strict=True) if t >= 0 and abs(cmath.phase(z)) <= sweep / 2), INF)


def arc_by_bearings(origin, direction, center, radius, start, sweep):
    """Both hits by their bearings from the centre, to either side of the foot of the perpendicular."""
    nx, ny = -direction[1], direction[0]
    aside = (origin[0] - center[0]) * nx + (origin[1] - center[1]) * ny
    if abs(aside) > radius:
        return INF
    best, foot, half = INF, math.atan2(ny, nx), math.acos(aside / radius)
    for bearing in (foot - half, foot + half):
        x = center[0] + radius * math.cos(bearing) - origin[0]
        y = center[1] + radius * math.sin(bearing) - origin[1]
        t = x * direction[0] + y * direction[1]
        if 0 <= t < best and (bearing - start) % TURN <= sweep:
            best = t
    return best


def sonar_in_order(ranges, angles, axis, cone, range_min, range_max):
    """From the nearest surface outwards, until one is heard."""
    for k in np.argsort(ranges):
        turned = math.remainder(angles[k] - axis, TURN)
        if range_min <= ranges[k] <= range_max and abs(turned) <= cone / 2:
            return float(ranges[k])
    return INF


def sonar_by_complex(ranges, angles, axis, cone, range_min, range_max):
    off = np.abs(np.angle(np.exp(1j * (np.asarray(angles) - axis))))
    read = np.where((off <= cone / 2) & np.isfinite(ranges), ranges, INF)
    return float(np.where((read < range_min) | (read > range_max), INF, read).min())


def sonar_masked(ranges, angles, axis, cone, range_min, range_max):
    """A masked array, turned so that the axis lies at half a turn."""
    off = (angles - axis + 3 * np.pi) % TURN - np.pi
    deaf = np.isnan(ranges) | (ranges < range_min) | (ranges > range_max) | (abs(off) > cone / 2)
    return float(np.ma.min(np.ma.array(ranges, mask=deaf)).item() or 0.0) if not deaf.all() else INF


def busy_by_codes(points, corner, resolution, shape, least):
    """One number for each cell, sorted; equal ones stand together."""
    i, j = ((points[:, axis] - corner[axis]) // resolution for axis in (0, 1))
    inside = (i >= 0) & (i < shape[0]) & (j >= 0) & (j < shape[1])
    codes = np.sort(i[inside] * shape[1] + j[inside])
    starts = np.flatnonzero(np.diff(codes, prepend=-1))
    codes = codes[starts[np.diff(np.append(starts, len(codes))) >= least]] if len(codes) else codes
    return np.column_stack([codes // shape[1] + 0.5, codes % shape[1] + 0.5]) * resolution + corner


# Each wrong answer with what it loses (v: the visible tests; 1, 2, ...: hidden parts), and the short name of its fault.
ANSWERS = {
    "ray_arc": {
        "right": {
            "roots": arc_by_roots,
            "bearings": arc_by_bearings,
            "formula": arc_by_formula,
            "complex numbers": arc_by_complex_numbers,
            "bisection": arc_by_bisection,
        },
        "wrong": {
            "sign": (arc_from_the_wall, "v1234", "sign turned round"),
            "near root": (arc_near, "v24", "near root alone"),
            "whole circle": (arc_whole, "v234", "whole circle for arc"),
            "far root first": (arc_far_first, "13", "far root before near"),
            "behind": (arc_behind, "4", "hits behind the robot"),
            "clockwise": (arc_clockwise, "v1234", "clockwise for counter-clockwise"),
            "not wrapped": (arc_not_wrapped, "3", "bearing not wrapped"),
            "wrapped once": (arc_wrapped_once, "3", "bearing not wrapped"),
            "sweep as end": (arc_to_the_end, "1234", "sweep taken for the end"),
            "from the robot": (arc_from_robot, "v1234", "bearing from the robot"),
            "none for a miss": (arc_none, "v1234", "None for no hit"),
            "root below zero": (arc_raises, "v1", "raises ValueError"),
        },
    },
    "sonar_reading": {
        "right": {
            "in order": sonar_in_order,
            "complex numbers": sonar_by_complex,
            "masked": sonar_masked,
            "loop": sonar_by_loop,
            "cosine": sonar_by_cosine,
        },
        "wrong": {
            "all around": (sonar_all_around, "v1234", "cone left out"),
            "twice as wide": (sonar_twice_as_wide, "v1234", "whole cone to each side"),
            "not wrapped": (sonar_not_wrapped, "2", "bearing not wrapped"),
            "too near hides": (sonar_hidden, "v3", "too near hides the rest"),
            "cut": (sonar_cut, "v3", "cut to the limits"),
            "no range_min": (sonar_no_min, "v3", "no range_min"),
            "no range_max": (sonar_no_max, "3", "no range_max"),
            "mean": (sonar_mean, "v1234", "mean"),
            "nan": (sonar_nan, "4", "nan spreads"),
            "empty cone": (sonar_argmin, "34", "raises ValueError"),
        },
    },
    "busy_cells": {
        "right": {
            "codes": busy_by_codes,
            "in place": busy_in_place,
            "counter": busy_by_counter,
            "table": busy_by_table,
            "boxes": busy_by_boxes,
        },
        "wrong": {
            "corner": (busy_corner, "v1234", "corner for centre"),
            "origin": (busy_origin, "v1234", "world origin for corner"),
            "from the corner": (busy_from_corner, "v1234", "places seen from the corner"),
            "numbers": (busy_numbers, "v1234", "cell numbers for metres"),
            "more than": (busy_more_than, "v1234", "more than, for at least"),
            "any": (busy_any, "v2", "no threshold"),
            "beside": (busy_beside, "34", "cells beside the board"),
            "table": (busy_table, "34", "raises IndexError"),
            "half checked": (busy_half_checked, "3", "negative index"),
            "clipped": (busy_clipped, "34", "pushed onto the board"),
            "int": (busy_int, "3", "int for floor"),
            "round": (busy_round, "v123", "round for floor"),
            "upper border": (busy_upper, "4", "upper border for lower"),
            "histogram": (busy_histogram, "4", "board's far border kept"),
            "x and y": (busy_swapped, "1234", "x and y changed places"),
        },
    },
}
