"""Lesson 01: where a beam meets a wall, and where a circle."""

# ruff: noqa: ARG005 (a wrong answer may leave out what it is given)

import math

import numpy as np
import shapely

INF = float("inf")
FAR = 10.0  # m: farther than anything in the cases


def segment_by_solving(origin, direction, a, b):
    matrix = np.column_stack([direction, a - b])
    if abs(np.linalg.det(matrix)) < 1e-12:
        return INF
    t, s = np.linalg.solve(matrix, a - origin)
    return t if t >= 0 and 0 <= s <= 1 else INF


def segment_by_turning(origin, direction, a, b):
    """Turn the world so that the beam runs along x: the wall is hit where it crosses y = 0."""
    turn = np.array([direction, [-direction[1], direction[0]]])
    (ax, ay), (bx, by) = turn @ (a - origin), turn @ (b - origin)
    if ay == by or ay * by > 0:
        return math.inf
    x = ax + (bx - ax) * ay / (ay - by)
    return x if x >= 0 else math.inf


def segment_by_geos(origin, direction, a, b):
    met = shapely.LineString([origin, origin + FAR * direction]).intersection(shapely.LineString([a, b]))
    return INF if met.is_empty else np.array(shapely.distance(met, shapely.Point(origin)))


def segment_behind(origin, direction, a, b):
    matrix = np.column_stack([direction, a - b])
    if abs(np.linalg.det(matrix)) < 1e-12:
        return INF
    t, s = np.linalg.solve(matrix, a - origin)
    return t if 0 <= s <= 1 else INF


def segment_endless(origin, direction, a, b):
    matrix = np.column_stack([direction, a - b])
    if abs(np.linalg.det(matrix)) < 1e-12:
        return INF
    t = np.linalg.solve(matrix, a - origin)[0]
    return t if t >= 0 else INF


def segment_share(origin, direction, a, b):
    matrix = np.column_stack([direction, a - b])
    if abs(np.linalg.det(matrix)) < 1e-12:
        return INF
    t, s = np.linalg.solve(matrix, a - origin)
    return s if t >= 0 and 0 <= s <= 1 else INF


def segment_between_ends(origin, direction, a, b):
    """Nothing at a wall's ends: a beam at a corner slips through."""
    matrix = np.column_stack([direction, a - b])
    if abs(np.linalg.det(matrix)) < 1e-12:
        return INF
    t, s = np.linalg.solve(matrix, a - origin)
    return t if t >= 0 and 0 < s < 1 else INF


def segment_none(origin, direction, a, b):
    t = segment_by_turning(origin, direction, a, b)
    return None if t == INF else t


def segment_parallel(origin, direction, a, b):
    side = b - a
    t, s = np.linalg.solve(np.column_stack([direction, -side]), a - origin)
    return t if t >= 0 and 0 <= s <= 1 else INF


def segment_with(choose):
    def hit(origin, direction, a, b):
        matrix = np.column_stack([direction, a - b])
        if abs(np.linalg.det(matrix)) < 1e-12:
            return INF
        return choose(*np.linalg.solve(matrix, a - origin))

    return hit


def segment_in_place(origin, direction, a, b):
    a -= origin
    b -= origin
    return segment_by_turning(np.zeros(2), direction, a, b)


def segment_by_steps(origin, direction, a, b):
    """March in steps of a millimetre until the wall is nearer than that."""
    t = np.arange(0, 1.5, 0.001)
    places = origin + t[:, None] * direction
    near = shapely.distance(shapely.points(places), shapely.LineString([a, b])) < 0.0006
    return float(t[np.argmax(near)]) if near.any() else INF


def circle_by_formula(origin, direction, center, radius):
    b = 2 * float((origin - center) @ direction)
    c = float((origin - center) @ (origin - center)) - radius**2
    roots = [r.real for r in np.roots([1.0, b, c]) if abs(r.imag) < 1e-12 and r.real >= 0]
    return min(roots, default=INF)


def circle_by_angles(origin, direction, center, radius):
    """The law of sines, in the triangle robot, centre, hit."""
    away = math.dist(origin, center)
    angle = math.atan2(*(center - origin)[::-1]) - math.atan2(*direction[::-1])
    sine = away * math.sin(angle) / radius
    if abs(sine) > 1:
        return math.inf
    along = away * math.cos(angle)
    half = radius * math.sqrt(1 - sine**2)
    return min((t for t in (along - half, along + half) if t >= 0), default=math.inf)


def circle_with(choose):
    def hit(origin, direction, center, radius):
        to_center = center - origin
        along = to_center @ direction
        under = radius**2 - to_center @ to_center + along**2
        return INF if under < 0 else choose(along - math.sqrt(under), along + math.sqrt(under), along)

    return hit


def circle_nan(origin, direction, center, radius):
    to_center = center - origin
    along = to_center @ direction
    near, far = (along + sign * np.sqrt(radius**2 - to_center @ to_center + along**2) for sign in (-1, 1))
    return float(near) if near >= 0 else float(far) if not far < 0 else INF


def circle_not_squared(origin, direction, center, radius):
    along = (center - origin) @ direction
    under = radius**2 - math.dist(origin, center) + along**2
    roots = [along - math.sqrt(under), along + math.sqrt(under)] if under >= 0 else []
    return min((t for t in roots if t >= 0), default=INF)


def circle_none(origin, direction, center, radius):
    t = circle_by_formula(origin, direction, center, radius)
    return None if t == INF else t


def circle_math_sqrt(origin, direction, center, radius):
    to_center = center - origin
    along = to_center @ direction
    return along - math.sqrt(radius**2 - to_center @ to_center + along**2)


ANSWERS = {
    "ray_segment": {
        "right": {"solving": segment_by_solving, "turning": segment_by_turning, "geos": segment_by_geos},
        "wrong": {
            "behind": (segment_behind, "Walls behind the robot"),
            "between the ends": (segment_between_ends, "0 < s < 1"),
            "endless": (segment_endless, "beyond its ends"),
            "share": (segment_share, "That is s, the place along the wall"),
            "point": (lambda origin, direction, a, b: (a + b) / 2, "Two numbers came back"),
            "both": (segment_with(lambda t, s: (t, s)), "Two numbers came back"),
            "always": (segment_with(lambda t, s: t), "Neither t nor s is looked at"),
            "sign of t": (segment_with(lambda t, s: -t if t <= 0 <= s <= 1 else INF), "an order"),
            "sign of s": (segment_with(lambda t, s: t if t >= 0 and -1 <= s <= 0 else INF), "a comparison"),
            "none": (segment_none, "must return float('inf'), not None"),
            "in place": (segment_in_place, "changes what it is given"),
            "by steps": (segment_by_steps, "For example ray_segment("),
            "a text": (lambda origin, direction, a, b: "0.2 m", "got '0.2 m', expected a number"),
            "nothing": (lambda origin, direction, a, b: None, "is there a return?"),
        },
        "error": {
            "parallel": (segment_parallel, "raised LinAlgError: Singular matrix"),
            "no such name": (lambda origin, direction, a, b: orgin, "NameError: name 'orgin' is not defined"),  # noqa: F821 (a slip of the pen, on purpose)
            "too few arguments": (lambda origin, direction: 0.0, "TypeError"),
        },
    },
    "ray_circle": {
        "right": {"formula": circle_by_formula, "angles": circle_by_angles},
        "wrong": {
            "far": (circle_with(lambda near, far, along: far if far >= 0 else INF), "far side of the circle"),
            "behind": (circle_with(lambda near, far, along: near), "Circles behind the robot"),
            "near alone": (circle_with(lambda near, far, along: near if near >= 0 else INF), "From inside a circle"),
            "inside": (circle_with(lambda near, far, along: near if far >= 0 else INF), "From inside a circle"),
            "centre": (
                circle_with(lambda near, far, along: along if far >= 0 else INF),
                "half a chord earlier",
            ),
            "both roots": (lambda origin, direction, center, radius: (0.2, 0.4), "Two numbers came back"),
            "not squared": (circle_not_squared, "the square of the length of w"),
            "from the centre": (
                lambda origin, direction, center, radius: circle_by_formula(center, direction, origin, radius),
                "w is turned round",
            ),
            "nan": (circle_nan, "under the root below zero"),
            "none": (circle_none, "must return float('inf'), not None"),
        },
        "error": {"a root of less than nothing": (circle_math_sqrt, "ray_circle(origin=(0, 0.2), direction=(1, 0)")},
    },
}
