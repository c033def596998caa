"""Lesson 02: from metres to a cell, and from a scan to the set of occupied cells."""

# ruff: noqa: ARG005 (a wrong answer may leave out what it is given)

import cmath
import math

import numpy as np


def cells_by_floor_division(points, resolution):
    return (points // resolution).astype(int)


def cells_one_by_one(points, resolution):
    return [(math.floor(x / resolution), math.floor(y / resolution)) for x, y in points]


def cells_by_search(points, resolution):
    """Write all borders of the board down, and look up between which two a point lies."""
    many = math.ceil(1 / resolution)
    borders = resolution * np.arange(-many, many + 1)
    return np.searchsorted(borders, points, side="right") - 1 - many


def cells_mended(points, resolution):
    """Cut towards zero, and go one down where that was up."""
    cut = (points / resolution).astype(int)
    return cut - (cut > points / resolution)


def hits(pose, angles, ranges):
    return [
        (pose[0] + r * math.cos(pose[2] + a), pose[1] + r * math.sin(pose[2] + a))
        for a, r in zip(angles, ranges, strict=True)
        if r < math.inf
    ]


def pairs(points, resolution):
    return {(math.floor(x / resolution), math.floor(y / resolution)) for x, y in points}


def occupy_by_complex_numbers(cells, pose, angles, ranges, resolution):
    found = set(cells)
    for angle, reach in zip(angles, ranges, strict=True):
        if math.isfinite(reach):
            place = complex(pose[0], pose[1]) + cmath.rect(reach, pose[2] + angle)
            found.add((int(place.real // resolution), int(place.imag // resolution)))
    return found


def occupy_by_turning(cells, pose, angles, ranges, resolution):
    """In the robot's frame first; then turned and moved into the world's, with numpy's numbers in the set."""
    x, y, heading = pose
    hit = ranges < 1e3
    local = np.stack([ranges[hit] * np.cos(angles[hit]), ranges[hit] * np.sin(angles[hit])])
    turn = np.array([[np.cos(heading), -np.sin(heading)], [np.sin(heading), np.cos(heading)]])
    return cells.union(map(tuple, np.floor((turn @ local + [[x], [y]]).T / resolution)))


def occupy_in_place(cells, pose, angles, ranges, resolution):
    cells |= pairs(hits(pose, angles, ranges), resolution)
    return cells


def occupy_with_misses(cells, pose, angles, ranges, resolution):
    bearing = pose[2] + angles
    places = pose[:2] + ranges[:, None] * np.column_stack([np.cos(bearing), np.sin(bearing)])
    return cells | {tuple(cell) for cell in np.floor(places / resolution).astype(int).tolist()}


def occupy_with_infinity(cells, pose, angles, ranges, resolution):
    bearing = pose[2] + angles
    places = pose[:2] + ranges[:, None] * np.column_stack([np.cos(bearing), np.sin(bearing)])
    return cells | {tuple(cell) for cell in np.floor(places / resolution).tolist()}


def occupy_without_return(cells, pose, angles, ranges, resolution):
    cells |= pairs(hits(pose, angles, ranges), resolution)


def occupy_one_by_one(cells, pose, angles, ranges, resolution):
    cells = set(cells)
    for a, r in zip(angles, ranges, strict=True):
        cells.add((math.floor((pose[0] + r * math.cos(pose[2] + a)) / resolution), 0))
    return cells


def with_pose(change):
    def occupy(cells, pose, angles, ranges, resolution):
        return cells | pairs(hits(change(*pose), angles, ranges), resolution)

    return occupy


def occupy_with_sine(cells, pose, angles, ranges, resolution):
    x, y, heading = pose
    return cells | {
        (
            math.floor((x + r * math.sin(heading + a)) / resolution),
            math.floor((y + r * math.cos(heading + a)) / resolution),
        )
        for a, r in zip(angles, ranges, strict=True)
        if r < math.inf
    }


def occupy_cut(cells, pose, angles, ranges, resolution):
    return cells | {(int(x / resolution), int(y / resolution)) for x, y in hits(pose, angles, ranges)}


ANSWERS = {
    "to_cells": {
        "right": {
            "floor division": cells_by_floor_division,
            "one by one": cells_one_by_one,
            "search": cells_by_search,
            "mended": cells_mended,
        },
        "wrong": {
            "cut": (lambda points, resolution: (points / resolution).astype(int), "int() cuts towards zero"),
            "rounded": (lambda points, resolution: np.rint(points / resolution), "nearest border"),
            "one more": (lambda points, resolution: points // resolution + 1, "off by one"),
            "upper border": (lambda points, resolution: np.ceil(points / resolution) - 1, "lower border"),
            "places": (lambda points, resolution: points / resolution, "which whole number"),
            "corner": (lambda points, resolution: points // resolution * resolution, "corner in metres"),
            "centre": (
                lambda points, resolution: (points // resolution + 0.5) * resolution,
                "centre in metres",
            ),
            "half further": (lambda points, resolution: points // resolution + 0.5, "centre counted in cells"),
            "y first": (lambda points, resolution: (points // resolution)[:, [1, 0]], "i counts along x"),
            "times": (lambda points, resolution: np.floor(points * resolution), "Divide by their size"),
            "flat": (lambda points, resolution: (points // resolution).ravel(), "expected shape (1, 2)"),
            "in place": (
                lambda points, resolution: np.floor(np.divide(points, resolution, out=points)),
                "changes what",
            ),
            "nothing": (lambda points, resolution: None, "is there a return?"),
        },
        "error": {"int of an array": (lambda points, resolution: int(points / resolution), "TypeError")},
    },
    "occupy": {
        "right": {
            "complex numbers": occupy_by_complex_numbers,
            "turning": occupy_by_turning,
        },
        "wrong": {
            "in place": (occupy_in_place, "changes what it is given: work on a copy"),
            "misses": (occupy_with_misses, "reads inf and occupies no cell"),
            "infinity": (occupy_with_infinity, "reads inf and occupies no cell"),
            "only new": (
                lambda cells, pose, angles, ranges, resolution: pairs(hits(pose, angles, ranges), resolution),
                "A map keeps what it knows",
            ),
            "no heading": (with_pose(lambda x, y, heading: (x, y, 0.0)), "angles count from its heading"),
            "no position": (with_pose(lambda x, y, heading: (0.0, 0.0, heading)), "add where it stands"),
            "other heading": (with_pose(lambda x, y, heading: (x, y, -heading)), "a sign"),
            "other bearing": (
                lambda cells, pose, angles, *rest: occupy_by_turning(cells, pose, -angles, *rest),
                "a sign",
            ),
            "degrees": (
                lambda cells, pose, angles, *rest: occupy_by_turning(
                    cells, np.array([*pose[:2], math.degrees(pose[2])]), np.degrees(angles), *rest
                ),
                "these are radians already",
            ),
            "sine for x": (occupy_with_sine, "x goes with the cosine"),
            "cut": (occupy_cut, "int() cuts towards zero"),
            "a list": (
                lambda cells, *scan: [*cells, *pairs(hits(*scan[:3]), scan[3])],
                "a set keeps it once",
            ),
            "nothing": (occupy_without_return, "is there a return?"),
            "unchanged": (lambda cells, *scan: cells, "(10, 0) is missing"),
            "one too many": (
                lambda cells, *scan: cells | pairs(hits(*scan[:3]), scan[3]) | {(99, 99)},
                "(99, 99) should not be there",
            ),
        },
        "error": {"floor of infinity": (occupy_one_by_one, "OverflowError")},
    },
}
