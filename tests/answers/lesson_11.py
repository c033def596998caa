"""Lesson 11: the plane through three points, the sphere through four, and the k nearest to one."""

# ruff: noqa: ARG005 (a wrong answer may leave out what it is given)

import math

import numpy as np
from scipy.optimize import least_squares


def plane_by_determinant(points):
    """The normal as three determinants, in plain Python."""
    (a, b, c), (d, e, f), (g, h, i) = (map(float, p) for p in points)
    n = (
        (e - b) * (i - c) - (f - c) * (h - b),
        (f - c) * (g - a) - (d - a) * (i - c),
        (d - a) * (h - b) - (e - b) * (g - a),
    )
    length = math.hypot(*n)
    return None if length == 0 else ([x / length for x in n], (n[0] * a + n[1] * b + n[2] * c) / length)


def plane_by_svd(points):
    middle = points.mean(axis=0)
    _, sizes, axes = np.linalg.svd(points - middle)
    return None if sizes[1] < 1e-9 * sizes[0] else (axes[2], axes[2] @ middle)


def plane_with(finish):
    """A plane by the cross product, and a last step of the points, the unit normal and its length before."""

    def through(points):
        normal = np.cross(points[1] - points[0], points[2] - points[0])
        length = np.linalg.norm(normal)
        return None if length == 0 else finish(points, normal / length, length)

    return through


def plane_along(way):
    """Something else for a normal, made one long."""

    def through(points):
        n = way(points)
        return (n / np.linalg.norm(n), n @ points[0] / np.linalg.norm(n))

    return through


def plane_of_a_row(points):
    normal = np.cross(points[1] - points[0], points[2] - points[0])
    n = normal / max(np.linalg.norm(normal), 1e-300)
    return n, n @ points[0]


def sphere_by_differences(points):
    """Each point less the first: |p|^2 - |q|^2 = 2 c . (p - q)."""
    rest = points - points.mean(axis=0)
    squares = (rest**2).sum(axis=1)
    c = np.linalg.lstsq(2 * rest, squares - squares.mean(), rcond=None)[0]
    return points.mean(axis=0) + c, math.sqrt(squares.mean() + c @ c)


def sphere_by_search(points):
    """The geometric one, which lies nearer to the points than the algebraic one."""
    start = sphere_by_differences(points)
    found = least_squares(lambda q: np.linalg.norm(points - q[:3], axis=1) - q[3], [*start[0], start[1]], xtol=1e-12)
    return found.x[:3], found.x[3]


def sphere_with(finish):
    return lambda points: finish(points, *sphere_by_differences(points))


def sphere_without_2(points):
    *c, s = np.linalg.lstsq(np.column_stack([points, np.ones(len(points))]), (points**2).sum(axis=1), rcond=None)[0]
    return np.array(c), float(np.sqrt(s + np.dot(c, c)))


def sphere_of_a_root(points):
    matrix = np.column_stack([2 * points, np.ones(len(points))])
    *c, s = np.linalg.lstsq(matrix, (points**2).sum(axis=1), rcond=None)[0]
    return np.array(c), float(np.sqrt(max(s, 0.0))) if s > 0 else float("nan")


def away(points, seed):
    return np.linalg.norm(points - points[seed], axis=1)


def first_of(key, more=1):
    return lambda points, seed, k: np.argsort(key(points, seed))[: k + more]


def nearest_by_partition(points, seed, k):
    return np.argpartition(((points - points[seed]) ** 2).sum(axis=1), k)[: k + 1]


def nearest_by_sorting(points, seed, k):
    pairs = sorted((float(np.dot(p - points[seed], p - points[seed])), i) for i, p in enumerate(points))
    return [i for _, i in pairs[: k + 1]]


def sphere_singular(points):
    matrix = np.column_stack([2 * points, np.ones(len(points))])
    *c, s = np.linalg.solve(matrix, (points**2).sum(axis=1))
    return np.array(c), np.sqrt(s + np.dot(c, c))


ANSWERS = {
    "plane_through": {
        "right": {"determinants": plane_by_determinant, "singular vectors": plane_by_svd},
        "wrong": {
            "no None": (plane_of_a_row, "Three points in a row fix none"),
            "not one long": (plane_with(lambda p, n, m: (m * n, m * n @ p[0])), "The normal is not one long"),
            "normal alone not": (plane_with(lambda p, n, m: (m * n, n @ p[0])), "The normal is not one long"),
            "offset not divided": (plane_with(lambda p, n, m: (n, m * n @ p[0])), "the offset is not divided"),
            "plus d": (plane_with(lambda p, n, m: (n, -n @ p[1])), "not n . p + d = 0"),
            "absolute": (plane_with(lambda p, n, m: (-n, abs(n @ p[2]))), "The absolute value is too much"),
            "no differences": (plane_along(lambda p: np.cross(p[0], p[1])), "The points themselves"),
            "a way within": (plane_along(lambda p: p[2] - p[0]), "That is a way within the plane"),
        },
        "error": {"no sum": (lambda points: (points[3], 0.0), "out of bounds")},
    },
    "sphere_through": {
        "right": {"differences": sphere_by_differences, "search": sphere_by_search},
        "wrong": {
            "2 left out": (sphere_without_2, "has 2 c . p in it"),
            "2 of the centre alone": (sphere_with(lambda _p, c, r: (2 * c, r)), "has 2 c . p in it"),
            "root of s": (sphere_of_a_root, "the root of the fourth unknown alone"),
            "squared": (sphere_with(lambda _p, c, r: (c, r * r)), "That is the radius squared"),
            "diameter": (sphere_with(lambda _p, c, r: (c, 2 * r)), "That is the diameter"),
            "middle": (
                lambda p: (p.mean(axis=0), np.linalg.norm(p - p.mean(axis=0), axis=1).mean()),
                "the middle of the points",
            ),
            "first four": (lambda p: sphere_by_differences(p[:4]), "all others left out"),
        },
        "error": {"four alone": (sphere_singular, "must be square")},
    },
    "nearest_to": {
        "right": {"partition": nearest_by_partition, "sorted": nearest_by_sorting},
        "wrong": {
            "no seed": (lambda p, s, k: first_of(away)(p, s, k)[1:], "The seed itself is left out"),
            "one too few": (first_of(away, more=0), "One too few"),
            "flat": (first_of(lambda p, s: np.hypot(*(p - p[s])[:, :2].T)), "Height is left out"),
            "origin": (first_of(lambda p, s: np.linalg.norm(p, axis=1)), "nearest to the origin"),
            "farthest": (first_of(lambda p, s: -away(p, s)), "Those are the farthest"),
            "along the axes": (first_of(lambda p, s: np.abs(p - p[s]).sum(axis=1)), "along the axes"),
            "signs": (first_of(lambda p, s: np.abs((p - p[s]).sum(axis=1))), "with their signs cancel"),
        },
        "error": {"pairs": (lambda p, s, k: np.linalg.norm(p - s, axis=2), "axis 2 is out of bounds")},
    },
}
