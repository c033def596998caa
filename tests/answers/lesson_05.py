"""Lesson 05: which circle points lie on, and how near they are to it."""

# ruff: noqa: ARG005 (a wrong answer may leave out what it is given)

import math

import numpy as np
from scipy.optimize import least_squares

import primkit as pk


def solved(points):
    """Return a, b, k of Kasa's equation and the rank of its matrix."""
    design = np.column_stack([2 * points, np.ones(len(points))])
    (a, b, k), _, rank, _ = np.linalg.lstsq(design, (points**2).sum(axis=1), rcond=None)
    return a, b, k, rank


def fit_by_moments(points):
    """Kasa's normal equations about the mean, by Cramer's rule: no matrix at all."""
    n = len(points)
    mx, my = sum(x for x, _ in points) / n, sum(y for _, y in points) / n
    uv = [(x - mx, y - my) for x, y in points]
    suu, svv, suv = (sum(f(u, v) for u, v in uv) for f in (lambda u, v: u * u, lambda u, v: v * v, lambda u, v: u * v))
    det = suu * svv - suv**2
    if det <= 1e-12 * (suu + svv) ** 2:
        return None
    p = sum(u * (u * u + v * v) for u, v in uv) / 2
    q = sum(v * (u * u + v * v) for u, v in uv) / 2
    a, b = (p * svv - q * suv) / det, (q * suu - p * suv) / det
    return mx + a, my + b, math.sqrt(a * a + b * b + (suu + svv) / n)


def on_a_line(points):
    spread = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    return spread[-1] <= 1e-9 * spread[0]


def fit_by_optimiser(points):
    """The least squared distances, by an optimiser that knows nothing of circles."""
    if len(points) < 3 or on_a_line(points):
        return None
    x, y, r = fit_by_moments(points)
    return tuple(
        least_squares(lambda v: np.hypot(points[:, 0] - v[0], points[:, 1] - v[1]) - v[2], (x, y, r), xtol=1e-14).x
    )


def fit_by(method):
    def fit(points):
        circle = pk.fit_circle(points, method)
        return None if circle is None else (*circle.center, circle.radius)

    return fit


def fit_with(last_step):
    """Kasa's fit with a last step of its own, and the right answer where the points fix no circle."""

    def fit(points):
        a, b, k, rank = solved(points)
        return last_step(a, b, k) if rank == 3 else None

    return fit


def fit_without_half(points):
    """The matrix with x and y in the place of 2 x and 2 y; the radius from what came out."""
    a, b, k = np.linalg.lstsq(np.column_stack([points, np.ones(len(points))]), (points**2).sum(axis=1), rcond=None)[0]
    return a, b, np.sqrt(np.maximum(k + a * a + b * b, 0))


def fit_without_half_but_its_radius(points):
    a, b, r = fit_without_half(points)
    return a, b, np.sqrt(max(r * r - 0.75 * (a * a + b * b), 0))


def fit_by_mean(points):
    center = points.mean(axis=0)
    return (*center, np.hypot(*(points - center).T).mean())


def fit_box(points):
    low, high = points.min(axis=0), points.max(axis=0)
    return (*((low + high) / 2), (high - low).mean() / 2)


def fit_three(points):
    return fit_by("kasa")(points[:3])


def fit_any(points):
    a, b, k, _ = solved(points)
    return a, b, math.sqrt(max(k + a * a + b * b, 0.0))


def fit_in_place(points):
    points -= points.mean(axis=0)
    return fit_any(points)


def fit_by_solve(points):
    design = np.column_stack([2 * points, np.ones(len(points))])
    a, b, k = np.linalg.solve(design, (points**2).sum(axis=1))
    return a, b, math.sqrt(k + a * a + b * b)


def rms_by_loop(points, center, radius):
    total = 0.0
    for x, y in points:
        total += (math.dist((x, y), center) - radius) ** 2
    return math.sqrt(total / len(points))


def rms_by_shapes(points, center, radius):
    return np.linalg.norm(pk.Circle(center, radius).signed_distance(points)) / math.sqrt(len(points))


def residuals(points, center, radius):
    return np.linalg.norm(points - center, axis=1) - radius


def rms_with(number):
    return lambda points, center, radius: number(residuals(points, center, radius))


CANCEL = "Residuals outside and inside cancel each other"

ANSWERS = {
    "fit_circle": {
        "right": {
            "moments": fit_by_moments,
            "the least distances": fit_by_optimiser,
            "taubin": fit_by("taubin"),
            "pratt": fit_by("pratt"),
            "geometric": fit_by("geometric"),
        },
        "wrong": {
            "no circle": (fit_any, "Where the points fix none, return None"),
            "no circle on a line": (
                lambda points: fit_any(points) if len(points) > 2 else None,
                "Where the points fix none, return None",
            ),
            "mean": (fit_by_mean, "only when they lie all around it"),
            "root of k": (fit_with(lambda a, b, k: (a, b, np.sqrt(k))), "it is not r² yet"),
            "squared": (fit_with(lambda a, b, k: (a, b, k + a * a + b * b)), "is a root missing?"),
            "without half": (fit_without_half, "twice as far out"),
            "without half but its radius": (fit_without_half_but_its_radius, "twice as far out"),
            "three": (fit_three, "all points should have a say"),
            "box": (fit_box, "For example fit_circle("),
            "in place": (fit_in_place, "changes what it is given"),
            "minus": (fit_with(lambda a, b, k: (-a, -b, np.sqrt(k + a * a + b * b))), "the centre is off by"),
            "a Circle": (lambda points: pk.fit_circle(points), "expected three numbers"),
            "in two parts": (lambda points: ((0.0, 0.0), 0.1), "expected three numbers"),
            "never": (lambda points: None, "expected (0, 0, 0.1) (is there a return?)."),
        },
        "error": {"as many unknowns as points": (fit_by_solve, "must be square")},
    },
    "circle_rms": {
        "right": {"loop": rms_by_loop, "shapes": rms_by_shapes},
        "wrong": {
            "mean": (rms_with(np.mean), CANCEL),
            "size of the mean": (rms_with(lambda e: abs(e.mean())), CANCEL),
            "no root": (rms_with(lambda e: np.mean(e**2)), "is a root missing?"),
            "sum": (rms_with(lambda e: np.sqrt((e**2).sum())), "mean, not sum"),
            "standard deviation": (rms_with(np.std), "takes the residuals' mean off"),
            "mean distance": (rms_with(lambda e: np.abs(e).mean()), "RMS squares them first"),
            "to the centre": (lambda points, center, radius: rms_by_loop(points, center, 0), "subtract the radius"),
            "rings": (
                lambda points, center, radius: np.sqrt(
                    np.mean((((points - center) ** 2).sum(axis=1) - radius**2) ** 2)
                ),
                "compare the lengths",
            ),
            "one for each": (rms_with(np.abs), "expected a number such as"),
        },
        "error": {"no such name": (lambda points, center, radius: radious, "NameError")},  # noqa: F821
    },
}
