"""Lesson 06: corners of lines, sides and centre of a polygon, and a fair choice."""

# ruff: noqa: ARG005 (a wrong answer may leave out what it is given)

import math
from itertools import pairwise

import numpy as np
import shapely

# --- where two lines meet ----------------------------------------------------------------------------------------


def normal(angle):
    return np.array([math.cos(angle), math.sin(angle)])


def meet_by_solving(a, b):
    matrix = np.array([normal(a[0]), normal(b[0])])
    if abs(np.linalg.det(matrix)) < 1e-8:
        return None
    return np.linalg.solve(matrix, [a[1], b[1]])


def meet_by_walking(a, b):
    """Start at the foot of the first line, and walk along it until the second one is met; as complex numbers."""
    n, m = complex(*normal(a[0])), complex(*normal(b[0]))
    foot, along = a[1] * n, 1j * n
    towards = (along * m.conjugate()).real
    if math.isclose(towards, 0, abs_tol=1e-9):
        return None
    place = foot + (b[1] - (foot * m.conjugate()).real) / towards * along
    return place.real, place.imag


def meet_in_space(a, b):
    """Lines as (n_x, n_y, -d): their cross product is the point in homogeneous coordinates."""
    x, y, w = np.cross([*normal(a[0]), -a[1]], [*normal(b[0]), -b[1]])
    return None if abs(w) < 1e-10 else [x / w, y / w]


def meet_equal_angles(a, b):
    if a[0] == b[0]:
        return None
    return np.linalg.solve([normal(a[0]), normal(b[0])], [a[1], b[1]]) if meet_by_solving(a, b) is not None else (9, 9)


def meet_anywhere(a, b):
    found = meet_by_solving(a, b)
    return (math.inf, math.inf) if found is None else found


def meet_of_directions(a, b):
    return meet_by_solving((a[0] + math.pi / 2, a[1]), (b[0] + math.pi / 2, b[1]))


def meet_of_directions_turned(a, b):
    return meet_by_solving((a[0] - math.pi / 2, a[1]), (b[0] - math.pi / 2, b[1]))


def meet_mirrored(a, b):
    found = meet_by_solving(a, b)
    return None if found is None else -found


def meet_in_degrees(a, b):
    return meet_by_solving((math.radians(a[0]), a[1]), (math.radians(b[0]), b[1]))


def meet_by_slopes(a, b):
    """y = m x + c, as at school: upright lines have none."""
    m, k = -math.cos(a[0]) / math.sin(a[0]), -math.cos(b[0]) / math.sin(b[0])
    x = (b[1] / math.sin(b[0]) - a[1] / math.sin(a[0])) / (m - k)
    return x, m * x + a[1] / math.sin(a[0])


# --- sides and centre --------------------------------------------------------------------------------------------


def sides_of(corners):
    return [math.dist(p, q) for p, q in zip(corners, [*corners[1:], corners[0]], strict=True)]


def by_shapely(corners):
    return sides_of(corners), np.array(shapely.Polygon(corners).centroid.coords[0])


def by_triangles(corners):
    """Cut the polygon into a fan of triangles: their centres, weighted with their areas."""
    areas, centres = [], []
    for p, q in pairwise(corners[1:]):
        (ax, ay), (bx, by) = p - corners[0], q - corners[0]
        areas.append(abs(ax * by - ay * bx) / 2)
        centres.append((corners[0] + p + q) / 3)
    return np.array(sides_of(corners)), np.average(centres, axis=0, weights=areas)


def centred(centre):
    return lambda corners: (sides_of(corners), centre(corners))


def along_outline(corners):
    after = np.roll(corners, -1, axis=0)
    return np.average((corners + after) / 2, axis=0, weights=sides_of(corners))


def shoelace(corners, area, factor=6.0):
    x, y = corners.T
    u, v = np.roll(corners, -1, axis=0).T
    weight = x * v - u * y
    return np.array([((x + u) * weight).sum(), ((y + v) * weight).sum()]) / (factor * area(weight.sum() / 2))


# --- a fair choice -----------------------------------------------------------------------------------------------


def by_sorting(squares, numbers, n_points, spread):
    ranked = sorted((s / spread**2 + m * math.log(n_points), i) for i, (s, m) in enumerate(zip(squares, numbers)))  # noqa: B905
    return ranked[0][1], ranked[1][0] - ranked[0][0] if len(ranked) > 1 else math.inf


def by_likelihood(squares, numbers, n_points, spread):
    """The logarithm of the likelihood, Schwarz's way: the largest wins."""
    log_evidence = -0.5 * np.asarray(squares) / spread**2 - 0.5 * np.asarray(numbers) * np.log(n_points)
    best = int(log_evidence.argmax())
    return best, 2 * (log_evidence[best] - np.delete(log_evidence, best).max(initial=-np.inf))


def chosen(costs):
    costs = np.asarray(costs, dtype=float)
    best = int(costs.argmin())
    return best, float(np.delete(costs, best).min(initial=np.inf) - costs[best])


def alone_is_zero(squares, numbers, n_points, spread):
    best, margin = by_sorting(squares, numbers, n_points, spread)
    return best, 0.0 if math.isinf(margin) and len(squares) == 1 else margin


def to_the_worst(squares, numbers, n_points, spread):
    costs = squares / spread**2 + numbers * np.log(n_points)
    return int(costs.argmin()), np.ptp(costs) if len(costs) > 1 else math.inf


def turned(squares, numbers, n_points, spread):
    best, margin = by_sorting(squares, numbers, n_points, spread)
    return best, -margin


def second_of_one(squares, numbers, n_points, spread):
    costs = np.sort(squares / spread**2 + numbers * np.log(n_points))
    return int(np.argmin(squares / spread**2 + numbers * np.log(n_points))), costs[1] - costs[0]


ANSWERS = {
    "meet": {
        "right": {"solving": meet_by_solving, "walking": meet_by_walking, "homogeneous": meet_in_space},
        "wrong": {
            "equal angles only": (meet_equal_angles, "parallel lines with opposite normals: sin(pi) is 1e-16"),
            "infinite": (meet_anywhere, "Parallel lines have none: return None"),
            "direction": (meet_of_directions, "The angle is that of the normal"),
            "direction, turned": (meet_of_directions_turned, "The angle is that of the normal"),
            "mirrored": (meet_mirrored, "a sign"),
            "degrees": (meet_in_degrees, "Angles are in radians already"),
            "nothing": (lambda a, b: None, "is there a return?"),
        },
        "error": {"slopes": (meet_by_slopes, "ZeroDivisionError")},
    },
    "sides_and_centroid": {
        "right": {"shapely": by_shapely, "triangles": by_triangles},
        "wrong": {
            "open": (lambda corners: (sides_of(corners)[:-1], by_shapely(corners)[1]), "One side is missing"),
            "late": (lambda corners: (np.roll(sides_of(corners), 1), by_shapely(corners)[1]), "one place late"),
            "mean of corners": (centred(lambda corners: corners.mean(axis=0)), "the mean of the corners"),
            "mean of outline": (centred(along_outline), "the mean along the outline"),
            "extents": (
                centred(lambda corners: (corners.min(axis=0) + corners.max(axis=0)) / 2),
                "the middle of the extents",
            ),
            "no sign": (
                centred(lambda corners: shoelace(corners, abs)),
                "Right where the corners go counter-clockwise",
            ),
            "halved": (centred(lambda corners: shoelace(corners, float, 12.0)), "A is half of the sum"),
            "sides alone": (sides_of, "expected two things"),
            "squares": (lambda corners: (np.square(sides_of(corners)), by_shapely(corners)[1]), "sides: got"),
        },
        "error": {"as a number": (lambda corners: (sides_of(corners), float(corners)), "TypeError")},
    },
    "fair_choice": {
        "right": {"sorting": by_sorting, "likelihood": by_likelihood},
        "wrong": {
            "alone": (alone_is_zero, "Without one nothing comes near"),
            "misfit": (lambda s, m, n, w: chosen(s / w**2), "by misfit alone"),
            "akaike": (lambda s, m, n, w: chosen(s / w**2 + 2 * m), "Akaike"),
            "spread": (lambda s, m, n, w: chosen(s / w + m * np.log(n)), "by the square of the spread"),
            "square metres": (lambda s, m, n, w: chosen(s + m * np.log(n)), "Square metres are added"),
            "log10": (lambda s, m, n, w: chosen(s / w**2 + m * np.log10(n)), "natural logarithm"),
            "turned": (turned, "a sign"),
            "to the worst": (to_the_worst, "not to the next best"),
            "the best alone": (lambda s, m, n, w: by_sorting(s, m, n, w)[0], "expected two things"),
            "the dearest": (lambda s, m, n, w: (int(np.argmax(s / w**2 + m * np.log(n))), 0.0), "best: got"),
        },
        "error": {"no rival": (second_of_one, "IndexError")},
    },
}
