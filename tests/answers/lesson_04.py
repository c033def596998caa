"""Lesson 04: the line through two points, its inliers, the best fit of many points, and the loop around them."""

# ruff: noqa: ARG001, ARG005 (a wrong answer may leave out what it is given)

import math
from itertools import combinations

import numpy as np
from scipy.optimize import minimize_scalar

from primkit import Line
from primkit.checks.edges import best_of, fit_best, near, through


def through_by_meeting_both(p, q):
    """The normal is what is square to q - p: the null space of a matrix with one row."""
    if np.array_equal(p, q):
        return None
    normal = np.linalg.svd((q - p)[None])[2][1]
    return math.atan2(normal[1], normal[0]), float(normal @ q)


def through_as_complex_numbers(p, q):
    """A quarter turn is a multiplication by 1j."""
    p, q = complex(*p), complex(*q)
    if p == q:
        return None
    normal = 1j * (q - p) / abs(q - p)
    return Line(math.atan2(normal.imag, normal.real), (p * normal.conjugate()).real)


def through_by_slope(p, q):
    """y = a x + b, turned into normal form; NumPy divides by zero without an error."""
    a = (q[1] - p[1]) / (q[0] - p[0])
    b = p[1] - a * p[0]
    return math.atan2(1, -a), b / math.hypot(a, 1)


def through_with_none(p, q):
    a = (q[1] - p[1]) / (q[0] - p[0])
    return None if np.array_equal(p, q) else (math.atan2(1, -a), (p[1] - a * p[0]) / math.hypot(a, 1))


def through_whatever(p, q):
    angle = math.atan2(-(q[0] - p[0]), q[1] - p[1])
    return angle, p[0] * math.cos(angle) + p[1] * math.sin(angle)


def through_along(p, q):
    angle = math.atan2(q[1] - p[1], q[0] - p[0])
    return None if np.array_equal(p, q) else (angle, p[0] * math.cos(angle) + p[1] * math.sin(angle))


def through_unsigned(p, q):
    line = through(p, q)
    return line and (line[0], abs(line[1]))


def through_long_normal(p, q):
    normal = np.array([-(q - p)[1], (q - p)[0]])
    return None if not normal.any() else (math.atan2(normal[1], normal[0]), normal @ p)


def through_degrees(p, q):
    line = through(p, q)
    return line and (math.degrees(line[0]), line[1])


def offset_first(p, q):
    """The offset before the angle, of the opposite normal."""
    line = through(p, q)
    return line and (-line[1], line[0] + math.pi)


def through_floats(p, q):
    a = float(q[1] - p[1]) / float(q[0] - p[0])
    return math.atan2(1, -a), float(p[1] - a * p[0]) / math.hypot(a, 1)


def inliers_by_turning(points, line, threshold):
    """Turn the world so that the normal is the x axis."""
    angle, offset = line
    turned = (points[:, 0] + 1j * points[:, 1]) * np.exp(-1j * angle)
    return (turned.real >= offset - threshold - 1e-12) & (turned.real <= offset + threshold + 1e-12)


def inliers_one_by_one(points, line, threshold):
    angle, offset = line
    return [abs(x * math.cos(angle) + y * math.sin(angle) - offset) <= threshold for x, y in points]


def inliers_strict(points, line, threshold):
    angle, offset = line
    return np.abs(points @ (np.cos(angle), np.sin(angle)) - offset) < threshold


def inliers_one_sided(points, line, threshold):
    angle, offset = line
    return points @ (np.cos(angle), np.sin(angle)) - offset <= threshold


def inliers_without_offset(points, line, threshold):
    return np.abs(points @ (np.cos(line[0]), np.sin(line[0]))) <= threshold


def inliers_swapped(points, line, threshold):
    angle, offset = line
    return np.abs(points @ (np.sin(angle), np.cos(angle)) - offset) <= threshold


def fit_by_search(points):
    """Look for the bearing across which the points scatter least: no algebra at all."""
    if len(np.unique(points, axis=0)) < 2:
        return None
    center = points.mean(axis=0)

    def scatter(angle):
        return float((((points - center) @ (math.cos(angle), math.sin(angle))) ** 2).sum())

    start = min(np.linspace(0, math.pi, 64), key=scatter)
    low, high = start - 0.06, start + 0.06
    angle = minimize_scalar(scatter, bounds=(low, high), method="bounded", options={"xatol": 1e-12}).x
    for _ in range(3):  # Newton: the search alone stops at the root of the rounding
        x, y = (points - center).T
        slope = (y @ y - x @ x) * math.sin(2 * angle) + 2 * (x @ y) * math.cos(2 * angle)
        bend = 2 * (y @ y - x @ x) * math.cos(2 * angle) - 4 * (x @ y) * math.sin(2 * angle)
        angle -= slope / bend
    return angle, float(center @ (math.cos(angle), math.sin(angle)))


def fit_by_covariance(points):
    if len(points) < 2 or not np.ptp(points, axis=0).any():
        return None
    normal = np.linalg.eigh(np.cov(points.T))[1][:, 0]
    return math.atan2(normal[1], normal[0]), float(normal @ points.mean(axis=0))


def fit_by_slope(points):
    x, y = (points - points.mean(axis=0)).T
    a = (x @ y) / (x @ x)
    return math.atan2(1, -a), float(points.mean(axis=0) @ (-a, 1)) / math.hypot(a, 1)


def fit_by_svd(row, centre=True, column=False):
    def fit(points):
        if len(np.unique(points, axis=0)) < 2:
            return None
        directions = np.linalg.svd(points - points.mean(axis=0) * centre)[2]
        normal = directions[:, row] if column else directions[row]
        return math.atan2(normal[1], normal[0]), float(normal @ points.mean(axis=0))

    return fit


def fit_always(points):
    normal = np.linalg.svd(points - points.mean(axis=0))[2][1]
    return math.atan2(normal[1], normal[0]), float(normal @ points.mean(axis=0))


def fit_through_the_ends(points):
    return through(points[0], points[-1]) if len(points) > 1 else None


def all_pairs(points, threshold, trials, rng):
    """No chance at all: try every pair of points."""
    lines = [line for p, q in combinations(points, 2) if (line := through(p, q))]
    if not lines:
        return None
    inliers = max((near(points, line, threshold) for line in lines), key=np.count_nonzero)
    line = fit_best(points[inliers])
    return line, near(points, line, threshold)


def loop(points, threshold, trials, rng, keep="best", refit=True, anew=True):
    """The lesson's loop, with its usual faults to choose from."""
    kept = None
    for _ in range(trials if len(points) > 1 else 0):
        i, j = rng.choice(len(points), 2, replace=False)
        line = through(points[i], points[j])
        if line is None:
            continue
        inliers = near(points, line, threshold)
        if kept is None or keep == "last" or (keep == "best" and inliers.sum() > kept[1].sum()):
            kept = line, inliers
    if kept is None or not refit:
        return kept
    line = fit_best(points[kept[1]])
    return line, near(points, line, threshold) if anew else kept[1]


def with_faults(**faults):
    return lambda points, threshold, trials, rng: loop(points, threshold, trials, rng, **faults)


def fixed_point(points, threshold, trials, rng):
    found = loop(points, threshold, trials, rng, refit=False)
    if found is None:
        return None
    line, inliers = found
    for _ in range(20):
        line = Line(*fit_best(points[inliers]))
        inliers = near(points, line, threshold)
    return [line, inliers.tolist()]


def never_none(points, threshold, trials, rng):
    found = loop(points, threshold, trials, rng)
    return found or ((0.0, 0.0), np.zeros(len(points), dtype=bool))


def doubled_points(points, threshold, trials, rng):
    for _ in range(trials):
        i, j = rng.choice(len(points), 2)
        angle, _offset = through(points[i], points[j])
    return angle


ANSWERS = {
    "line_through": {
        "right": {"null space": through_by_meeting_both, "complex numbers": through_as_complex_numbers},
        "wrong": {
            "never none": (through_whatever, "Twice the same point fixes no line"),
            "slope": (through_by_slope, "Upright lines come out wrong"),
            "slope, with none": (through_with_none, "Upright lines come out wrong"),
            "along": (through_along, "its normal is a quarter turn away"),
            "unsigned": (through_unsigned, "The offset has a sign"),
            "long normal": (through_long_normal, "The normal must have length 1"),
            "degrees": (through_degrees, "degrees and radians"),
            "other side": (
                lambda p, q: (line := through(p, q)) and (line[0], -line[1]),
                "a sign",
            ),
            "x before y": (lambda p, q: (line := through(p, q)) and (math.pi / 2 - line[0], line[1]), "takes y first"),
            "offset first": (offset_first, "the angle comes first"),
            "nothing": (lambda p, q: None, "got None, expected (-1.571, -0.1) (is there a return?)"),
        },
        "error": {"floats": (through_floats, "raised ZeroDivisionError")},
    },
    "inliers_of": {
        "right": {"turning": inliers_by_turning, "one by one": inliers_one_by_one},
        "wrong": {
            "strict": (inliers_strict, "< or <= ?"),
            "one-sided": (inliers_one_sided, "far away on one side"),
            "without offset": (inliers_without_offset, "Is the offset subtracted?"),
            "swapped": (inliers_swapped, "an order"),
            "outside": (lambda p, line, t: ~near(p, line, t), "a comparison"),
            "how many": (lambda p, line, t: near(p, line, t).sum(), "That is how many they are"),
            "which numbers": (lambda p, line, t: np.flatnonzero(near(p, line, t)), "the numbers of the inliers"),
            "nonzero": (lambda p, line, t: np.nonzero(near(p, line, t)), "the numbers of the inliers"),
            "nothing": (lambda p, line, t: None, "is there a return?"),
        },
        "error": {"a tuple's angle": (lambda points, line, threshold: line.angle, "raised AttributeError")},
    },
    "fit_line": {
        "right": {"search": fit_by_search, "covariance": fit_by_covariance},
        "wrong": {
            "along y": (fit_by_slope, "it measures along y"),
            "direction": (fit_by_svd(0), "the normal is across"),
            "not centred": (fit_by_svd(1, centre=False), "Is the mean subtracted"),
            "column": (fit_by_svd(1, column=True), "not its columns"),
            "always": (fit_always, "Fewer than two different points"),
            "ends": (fit_through_the_ends, "in "),
            "three": (lambda points: None if len(points) < 3 else fit_best(points), "got None, expected"),
        },
        "error": {"no points": (lambda points: through(points[0], points[1]), "raised IndexError")},
    },
    "ransac_line": {
        "right": {"library": best_of, "all pairs": all_pairs, "one refit": loop, "fixed point": fixed_point},
        "wrong": {
            "first": (with_faults(keep="first"), "is the best trial kept"),
            "last": (with_faults(keep="last"), "is the best trial kept"),
            "no refit": (with_faults(refit=False), "fit it to all its inliers"),
            "inliers of the sample": (with_faults(anew=False), "take them anew after the refit"),
            "never none": (never_none, "Where no two points differ"),
            "nothing": (lambda p, t, n, rng: None, "is there a return?"),
            "line alone": (lambda p, t, n, rng: fit_best(p), "expected a line (angle, offset) and True or False"),
            "all points": (
                lambda p, t, n, rng: fit_best(p) and (fit_best(p), near(p, fit_best(p), t)),
                "is the best trial kept",
            ),
        },
        "error": {"a doubled point": (doubled_points, "raised TypeError")},
    },
}
