"""Ways: each task of the lessons solved in still other ways, so that ten different ones are known of each.

Loops and none, plain Python and NumPy, other libraries, other orders, other coordinates, recursion, search, algebra.
With those in ``lesson_NN.py``, the reference, and the plain way of ``tests/slips/right.py`` they make ten.
"""

import bisect
import cmath
import heapq
import itertools
import math
from collections import Counter, defaultdict
from functools import reduce

import numpy as np
import numpy.linalg as linalg_np
from scipy import ndimage, optimize, spatial
from scipy.linalg import lstsq as linalg_lstsq
from scipy.linalg import null_space
from shapely import LineString, MultiPoint, Point, Polygon
from sklearn import metrics
from sklearn.decomposition import PCA
from sklearn.linear_model import LinearRegression
from sklearn.metrics import pairwise_distances
from sklearn.neighbors import KDTree, KNeighborsClassifier, NearestNeighbors

from primkit.checks.edges import fit_best, near, through
from primkit.checks.scoring import best_pairs
from primkit.robot import AXLE, WHEEL

INF = math.inf


def complexly(points):
    """Return points as complex numbers."""
    return np.asarray(points) @ (1, 1j)


# --- 01: rays ---------------------------------------------------------------------------------------------------


def segment_in_plain_python(origin, direction, a, b):
    (x, y), (u, v), (ax, ay), (bx, by) = (map(float, pair) for pair in (origin, direction, a, b))
    bottom = u * (by - ay) - v * (bx - ax)
    if bottom == 0:
        return INF
    t = ((ax - x) * (by - ay) - (ay - y) * (bx - ax)) / bottom
    s = ((ax - x) * v - (ay - y) * u) / bottom
    return t if t >= 0 and s >= 0 and s <= 1 else INF


def segment_by_complex_numbers(origin, direction, a, b):
    """Turned so that the beam runs along the real axis: where does the wall cross it?"""
    turn = complex(*direction).conjugate()
    a, b = ((complex(*end) - complex(*origin)) * turn for end in (a, b))
    if a.imag == b.imag or a.imag * b.imag > 0:
        return INF
    t = a.real + (b.real - a.real) * a.imag / (a.imag - b.imag)
    return t if t >= 0 else INF


def segment_by_least_squares(origin, direction, a, b):
    matrix = np.column_stack([direction, a - b])
    (t, s), _, rank, _ = np.linalg.lstsq(matrix, a - origin, rcond=None)
    return t if rank == 2 and t >= 0 and -1e-12 <= s <= 1 + 1e-12 else INF


def segment_by_determinants(origin, direction, a, b):
    det = np.linalg.det([direction, b - a])
    if abs(det) < 1e-14:
        return np.inf
    t, s = (np.linalg.det([a - origin, other]) / det for other in (b - a, direction))
    return float(np.where((t >= 0) & (s >= -1e-12) & (s <= 1 + 1e-12), t, np.inf))


def segment_by_homogeneous_lines(origin, direction, a, b):
    """Two lines in the projective plane meet where their cross product is."""
    beam = np.cross([*origin, 1], [*(origin + direction), 1])
    x, y, w = np.cross(beam, np.cross([*a, 1], [*b, 1]))
    if abs(w) < 1e-15:
        return INF
    place = np.array([x, y]) / w
    t, s = (place - origin) @ direction, (place - a) @ (b - a) / ((b - a) @ (b - a))
    return t if t >= 0 and -1e-12 <= s <= 1 + 1e-12 else INF


def circle_by_roots(origin, direction, center, radius):
    """|q + t u - c|^2 = r^2 as a polynomial in t."""
    w = origin - center
    roots = np.roots([direction @ direction, 2 * w @ direction, w @ w - radius**2])
    ahead = [root.real for root in roots if root.imag == 0 and root.real >= 0]
    return min(ahead, default=INF)


def circle_in_plain_python(origin, direction, center, radius):
    wx, wy = center[0] - origin[0], center[1] - origin[1]
    along, across = wx * direction[0] + wy * direction[1], wx * direction[1] - wy * direction[0]
    if abs(across) > radius:
        return INF
    half = math.sqrt(radius * radius - across * across)
    for t in (along - half, along + half):
        if t >= 0:
            return t
    return INF


def circle_by_complex_numbers(origin, direction, center, radius):
    w = (complex(*center) - complex(*origin)) * complex(*direction).conjugate()
    half = cmath.sqrt(radius**2 - w.imag**2)
    return INF if half.imag else min((t for t in (w.real - half.real, w.real + half.real) if t >= 0), default=INF)


def circle_vectorised(origin, direction, center, radius):
    along = np.dot(center - origin, direction)
    foot = np.hypot(*(origin + along * direction - center))
    t = along + np.array([-1, 1]) * np.sqrt(np.maximum(radius**2 - foot**2, 0))
    return np.min(t, where=(t >= 0) & (foot <= radius), initial=np.inf)


def circle_in_its_own_units(origin, direction, center, radius):
    """A unit circle around the origin, and the product of both roots."""
    q = (origin - center) / radius
    half, product = -q @ direction, q @ q - 1
    if half * half < product:
        return INF
    far = half + np.sign(half) * math.sqrt(half * half - product) if half else math.sqrt(-product)
    roots = sorted((far, product / far))
    return radius * next((t for t in roots if t >= 0), INF)


def circle_by_search(origin, direction, center, radius):
    """Down to the nearest place, and where the sign changes on the way."""

    def outside(t):
        return math.hypot(*(origin + t * direction - center)) - radius

    foot = max(0.0, float((center - origin) @ direction))
    if outside(foot) > 0:
        return INF
    ends = (0.0, foot) if outside(0.0) > 0 else (foot, foot + 2 * radius + math.dist(origin, center))
    return optimize.brentq(outside, *ends, xtol=1e-14)


# --- 02: cells --------------------------------------------------------------------------------------------------


def cells_by_divmod(points, resolution):
    return np.array([[divmod(value, resolution)[0] for value in point] for point in points.tolist()], int).reshape(
        -1, 2
    )


def cells_by_remainder(points, resolution):
    return np.rint((points - np.mod(points, resolution)) / resolution).astype(int)


def cells_by_counting_borders(points, resolution):
    low = int(np.min(points, initial=0) / resolution) - 2
    high = int(np.max(points, initial=0) / resolution) + 2
    return np.digitize(points, np.arange(low, high + 1) * resolution) + low - 1


def cells_upwards(points, resolution):
    return -np.ceil(-points / resolution).astype(np.int64)


def hit_places(pose, angles, ranges):
    for angle, r in zip(angles, ranges, strict=True):
        if math.isfinite(r):
            yield pose[0] + r * math.cos(pose[2] + angle), pose[1] + r * math.sin(pose[2] + angle)


def occupy_by_loop(cells, pose, angles, ranges, resolution):
    found = set(cells)
    for x, y in hit_places(pose, angles, ranges):
        found.add((math.floor(x / resolution), math.floor(y / resolution)))
    return found


def occupy_by_recursion(cells, pose, angles, ranges, resolution):
    return reduce(
        lambda found, p: found | {tuple(math.floor(v / resolution) for v in p)}, hit_places(pose, angles, ranges), cells
    )


def occupy_by_counting(cells, pose, angles, ranges, resolution):
    places = ((int(x // resolution), int(y // resolution)) for x, y in hit_places(pose, angles, ranges))
    return set(Counter(itertools.chain(cells, places)))


def occupy_vectorised(cells, pose, angles, ranges, resolution):
    hit = np.isfinite(ranges)
    turn = pose[2] + angles[hit]
    p = pose[:2] + ranges[hit, None] * np.stack([np.cos(turn), np.sin(turn)], axis=1)
    return cells.union(map(tuple, np.floor(p / resolution).astype(int).tolist()))


def occupy_backwards(cells, pose, angles, ranges, resolution):
    return occupy_vectorised(frozenset(cells), pose, angles[::-1], ranges[::-1], resolution)


def occupy_by_matrix(cells, pose, angles, ranges, resolution):
    c, s = math.cos(pose[2]), math.sin(pose[2])
    r, angle = np.compress(ranges < np.inf, [ranges, angles], axis=1)
    local = np.array([r * np.cos(angle), r * np.sin(angle)])
    i, j = np.floor_divide(np.array([[c, -s], [s, c]]) @ local + np.reshape(pose[:2], (2, 1)), resolution)
    return {*cells, *zip(i.astype(int).tolist(), j.astype(int).tolist(), strict=True)}


# --- 03: groups -------------------------------------------------------------------------------------------------


def update_by_loop(points, labels, centers):
    new = centers.tolist()
    for j in range(len(new)):
        mine = [point for point, label in zip(points.tolist(), labels, strict=True) if label == j]
        if mine:
            new[j] = [math.fsum(column) / len(mine) for column in zip(*mine, strict=True)]
    return new


def update_by_mask(points, labels, centers):
    new = np.array(centers, dtype=float)
    for j in np.unique(labels):
        new[j] = np.mean(points, axis=0, where=(np.asarray(labels) == j)[:, None])
    return new


def update_by_ndimage(points, labels, centers):
    some = np.unique(labels)
    new = centers + 0.0
    new[some] = np.column_stack([ndimage.mean(column, labels, some) for column in points.T])
    return new


def update_by_adding_at(points, labels, centers):
    sums, n = np.zeros_like(centers), np.zeros(len(centers))
    np.add.at(sums, labels, points)
    np.add.at(n, labels, 1)
    return np.where(n[:, None] > 0, sums / np.maximum(n, 1)[:, None], centers)


def update_one_after_the_other(points, labels, centers):
    """A running mean."""
    new, n = centers.copy(), np.zeros(len(centers))
    for point, label in zip(points[::-1], labels[::-1], strict=True):
        n[label] += 1
        new[label] = point if n[label] == 1 else new[label] + (point - new[label]) / n[label]
    return new


def update_by_sorting(points, labels, centers):
    order = np.argsort(labels, kind="stable")
    some, first = np.unique(labels[order], return_index=True)
    new = centers.copy()
    for j, mine in zip(some, np.split(points[order], first[1:]), strict=True):
        new[j] = mine.mean(axis=0)
    return new


def silhouette_from(apart):
    """Return the silhouette by sums of distances to each group."""

    def silhouette(points, labels):
        names, own = np.unique(labels, return_inverse=True)
        member = np.eye(len(names))[own]
        n, sums = member.sum(axis=0), apart(points) @ member
        a = sums[np.arange(len(own)), own] / np.maximum(n[own] - 1, 1)
        b = np.where(member > 0, np.inf, sums / n).min(axis=1)
        scores = np.where(n[own] > 1, (b - a) / np.maximum(np.maximum(a, b), 1e-300), 0.0)
        return scores.mean()

    return silhouette


def silhouette_by_groups(points, labels):
    groups = defaultdict(list)
    for point, label in zip(points.tolist(), np.asarray(labels).tolist(), strict=True):
        groups[label].append(point)
    scores = []
    for label, mine in groups.items():
        for i, p in enumerate(mine):
            others = mine[:i] + mine[i + 1 :]
            a = math.fsum(math.dist(p, q) for q in others) / (len(others) or 1)
            b = min(math.fsum(math.dist(p, q) for q in g) / len(g) for k, g in groups.items() if k != label)
            scores.append((b - a) / max(a, b) if others else 0)
    return math.fsum(scores) / len(scores)


# --- 04: lines --------------------------------------------------------------------------------------------------


def through_in_plain_python(p, q):
    dx, dy = float(q[0] - p[0]), float(q[1] - p[1])
    if dx == dy == 0:
        return None
    return math.atan2(dx, -dy), (p[1] * dx - p[0] * dy) / math.hypot(dx, dy)


def through_by_the_other_normal(p, q):
    if not np.any(q - p):
        return None
    n = np.array([1, -1]) * (q - p)[::-1] / np.linalg.norm(q - p)
    return [np.arctan2(n[1], n[0]), n @ (p + q) / 2]


def through_by_homogeneous_points(p, q):
    a, b, c = np.cross([*p, 1], [*q, 1])
    size = np.hypot(a, b)
    return None if size == 0 else (np.arctan2(b, a), -c / size)


def through_by_a_null_space(p, q):
    if np.array_equal(p, q):
        return None
    scale = 1 / np.abs(q - p).max()
    (x, y) = null_space(scale * (q - p)[None])[:, 0]
    return math.atan2(y, x), x * p[0] + y * p[1]


def through_by_turning(p, q):
    """The normal is the direction, a quarter further."""
    if (p == q).all():
        return None
    angle = cmath.phase(complex(*(q - p))) + math.pi / 2
    return angle, (complex(*q) * cmath.exp(-1j * angle)).real


def through_by_bearings(p, q):
    """As an array, from the farther point back."""
    if math.dist(p, q) == 0:
        return None
    angle = math.atan2(p[1] - q[1], p[0] - q[0]) - math.pi / 2
    return np.array([angle, math.cos(angle) * p[0] + math.sin(angle) * p[1]])


EDGE = 1e-12  # what rounding can cost a point on the boundary


def near_by_shapely(points, line, threshold):
    """A wall so long that its ends are far away."""
    angle, offset = line
    n = np.array([math.cos(angle), math.sin(angle)])
    ends = offset * n + np.outer((-50, 50), (-n[1], n[0]))
    return np.array([LineString(ends).distance(Point(p)) <= threshold + EDGE for p in points], dtype=bool)


def near_by_complex_numbers(points, line, threshold):
    return np.abs((complexly(points) * cmath.exp(-1j * line[0])).real - line[1]) <= threshold + EDGE


def near_by_feet(points, line, threshold):
    """How far is each point from its foot on the line?"""
    n = np.array([np.cos(line[0]), np.sin(line[0])])
    feet = points - np.outer(points @ n - line[1], n)
    return np.linalg.norm(points - feet, axis=1) <= threshold + EDGE


def near_by_sets(points, line, threshold):
    """All but those that lie farther out, on the one side or on the other."""
    signed = points[:, 0] * math.cos(line[0]) + points[:, 1] * math.sin(line[0]) - line[1]
    far = {*np.flatnonzero(signed > threshold + EDGE), *np.flatnonzero(signed < -threshold - EDGE)}
    return [i not in far for i in range(len(points))]


def near_by_squares(points, line, threshold):
    signed = np.einsum("ij,j->i", points, [np.cos(line[0]), np.sin(line[0])]) - line[1]
    return signed**2 <= (threshold + EDGE) ** 2


def near_by_sorting(points, line, threshold):
    signed = points @ np.array([np.cos(line[0]), np.sin(line[0])])
    order = np.argsort(signed)
    values = signed[order].tolist()
    low = bisect.bisect_left(values, line[1] - threshold - EDGE)
    high = bisect.bisect_right(values, line[1] + threshold + EDGE)
    mask = np.zeros(len(points), dtype=bool)
    mask[order[low:high]] = True
    return mask


def fit_if_there_are_two(fit):
    """Return a fit that is asked only where two points differ."""
    return lambda points: fit(points) if len(np.unique(points, axis=0)) > 1 else None


def by_normal(points, normal):
    return math.atan2(normal[1], normal[0]), float(np.mean(points, axis=0) @ normal)


def fit_by_double_angle(points):
    """Half the bearing of the mean of the squares."""
    z = complexly(points - points.mean(axis=0))
    angle = cmath.phase((z**2).sum()) / 2 + math.pi / 2
    return by_normal(points, (math.cos(angle), math.sin(angle)))


def fit_by_moments(points):
    (a, b), (_, c) = np.cov(points, rowvar=False, bias=True)
    angle = math.atan2(2 * b, a - c) / 2
    return by_normal(points, (-math.sin(angle), math.cos(angle)))


def fit_by_power_iteration(points):
    x = points - points.mean(axis=0)
    matrix = x.T @ x / np.trace(x.T @ x)
    for _ in range(200):
        matrix = matrix @ matrix
        matrix /= np.trace(matrix)
    u = matrix[:, np.argmax(np.diag(matrix))]
    return by_normal(points, np.array([-u[1], u[0]]) / np.linalg.norm(u))


def fit_by_least_squares(points):
    """A search from the principal component on."""
    x, y = PCA(2).fit(points).components_[1]

    def off(line):
        return points @ (math.cos(line[0]), math.sin(line[0])) - line[1]

    start = math.atan2(y, x) + 0.01, float(points.mean(axis=0) @ (x, y))
    return tuple(optimize.least_squares(off, start, xtol=1e-15, ftol=1e-15, gtol=1e-15).x)


FIT_LINES = {
    "double angle": fit_by_double_angle,
    "moments": fit_by_moments,
    "power iteration": fit_by_power_iteration,
    "principal components": lambda points: by_normal(points, PCA(2).fit(points).components_[1]),
    "least squares": fit_by_least_squares,
    "least right singular vector": lambda points: by_normal(
        points, np.linalg.svd((points - points.mean(0)).T)[0][:, 1]
    ),
}


def keep(draws, rank=np.count_nonzero):
    """Return a RANSAC with its own way to draw pairs and to rank masks; the best is refitted, with its inliers anew."""

    def ransac(points, threshold, trials, rng):
        pairs = draws(len(points), trials, rng) if len(points) > 1 else []
        lines = [line for i, j in pairs if (line := through(points[i], points[j]))]
        masks = [near(points, line, threshold) for line in lines]
        if not masks:
            return None
        line = fit_best(points[max(masks, key=rank)])
        for _ in range(9):
            line = fit_best(points[near(points, line, threshold)])
        return line, near(points, line, threshold)

    return ransac


# --- 05: circles ------------------------------------------------------------------------------------------------


def kasa(solve):
    """Return Kasa's fit with its own way to solve the equations, centred first."""

    def fit(points):
        if len(points) < 3:
            return None
        middle = points.mean(axis=0)
        p = points - middle
        if np.linalg.matrix_rank(np.column_stack([p / max(np.abs(p).max(), 1e-12), np.ones(len(p))]), tol=1e-9) < 3:
            return None
        a, b, k = solve(np.column_stack([2 * p, np.ones(len(p))]), (p**2).sum(axis=1))
        return middle[0] + a, middle[1] + b, math.sqrt(k + a * a + b * b)

    return fit


RMS = {
    "statistics": lambda p, c, r: math.sqrt(math.fsum((math.dist(q, c) - r) ** 2 for q in p) / len(p)),
    "norm": lambda p, c, r: np.linalg.norm(np.linalg.norm(p - c, axis=1) - r) / np.sqrt(len(p)),
    "complex numbers": lambda p, c, r: np.sqrt(np.mean((np.abs(complexly(p - c)) - r) ** 2)),
    "mean and variance": lambda p, c, r: math.hypot(*((f := np.hypot(*(p - c).T) - r).mean(), f.std())),
    "sklearn": lambda p, c, r: metrics.mean_squared_error(np.full(len(p), r), np.hypot(*(p - c).T)) ** 0.5,
    "cdist": lambda p, c, r: np.sqrt(np.square(spatial.distance.cdist(p, [c]) - r).mean()),
}


# --- 06: names --------------------------------------------------------------------------------------------------


def meet_if_not_parallel(meet):
    return lambda a, b: None if abs(math.sin(b[0] - a[0])) < 1e-9 else meet(a, b)


def normals(a, b):
    return np.array([[math.cos(a[0]), math.sin(a[0])], [math.cos(b[0]), math.sin(b[0])]])


def meet_by_shapely(a, b):
    """Of two walls so long that their ends are far away; the place is then mended by one step of Newton."""
    walls = [
        LineString(d * n + np.outer((-1e3, 1e3), (-n[1], n[0])))
        for n, d in zip(normals(a, b), (a[1], b[1]), strict=True)
    ]
    crossing = walls[0].intersection(walls[1])
    place = np.zeros(2) if crossing.is_empty else np.array([crossing.x, crossing.y])
    return place + np.linalg.solve(normals(a, b), (a[1], b[1]) - normals(a, b) @ place)


def meet_by_complex_numbers(a, b):
    """z exp(-i angle) has the offset as its real part, for both."""
    turn = cmath.exp(1j * (b[0] - a[0]))
    aside = (a[1] * turn.real - b[1]) / -turn.imag
    z = complex(a[1], aside) * cmath.exp(1j * a[0])
    return np.array([z.real, z.imag])


MEETS = {
    "lstsq": lambda a, b: np.linalg.lstsq(normals(a, b), (a[1], b[1]), rcond=None)[0],
    "inverse": lambda a, b: np.linalg.inv(normals(a, b)) @ (a[1], b[1]),
    "shapely": meet_by_shapely,
    "complex numbers": meet_by_complex_numbers,
    "determinants": lambda a, b: [
        np.linalg.det(np.where(np.arange(2) == k, [[a[1]], [b[1]]], normals(a, b))) / np.linalg.det(normals(a, b))
        for k in (0, 1)
    ],
}


def area_and_moments(corners):
    for (x, y), (u, v) in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        yield x * v - u * y, (x + u) / 3, (y + v) / 3


def measured_by_a_fan(corners):
    """Triangles from the first corner."""
    a, b, c = corners[0], corners[1:-1], corners[2:]
    areas = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    sides = np.linalg.norm(np.diff(np.vstack([corners, corners[:1]]), axis=0), axis=1)
    return sides, areas @ (a + b + c) / 3 / areas.sum()


def measured_by_complex_numbers(corners):
    z = complexly(corners)
    after = np.append(z[1:], z[0])
    w = (z.conj() * after).imag
    c = (w * (z + after)).sum() / (3 * w.sum())
    return abs(after - z), (c.real, c.imag)


def measured_by_loop(corners):
    weights, xs, ys = zip(*area_and_moments(corners), strict=True)
    total = math.fsum(weights)
    middle = [math.fsum(w * v for w, v in zip(weights, values, strict=True)) / total for values in (xs, ys)]
    return [math.dist(corners[i - 1], corners[i]) for i in [*range(1, len(corners)), 0]], middle


def measured_backwards(corners):
    sides, middle = measured_by_a_fan(corners[::-1])
    return np.roll(sides[::-1], -1), middle


def measured_by_rings(corners):
    ring = Polygon(corners)
    edges = zip(ring.exterior.coords, ring.exterior.coords[1:], strict=False)
    return [LineString(edge).length for edge in edges], np.ravel(ring.centroid.coords)


def measured_by_strips(corners):
    """Green's theorem: areas under the sides."""
    x, y = (corners - corners[0]).T
    u, v = np.roll(x, -1), np.roll(y, -1)
    area = ((u - x) * (y + v)).sum() / 2
    cy = ((u - x) * (y * y + y * v + v * v)).sum() / 6 / area
    cx = -((v - y) * (x * x + x * u + u * u)).sum() / 6 / area
    return np.hypot(u - x, v - y), corners[0] + (cx, cy)


def costs(squares, numbers, n_points, spread):
    return [s / spread**2 + m * math.log(n_points) for s, m in zip(squares, numbers, strict=True)]


def chosen_by(best_two):
    """Return a choice with its own way to find the least and the next."""

    def choice(squares, numbers, n_points, spread):
        cost = costs(squares, numbers, n_points, spread)
        if len(cost) == 1:
            return 0, INF
        (least, first), (following, _) = best_two(cost)
        return int(first), float(following - least)

    return choice


def two_by_removal(cost):
    first = cost.index(min(cost))
    left = [value for i, value in enumerate(cost) if i != first]
    return (cost[first], first), (min(left), None)


def two_in_one_go(cost):
    pairs = [(INF, -1), (INF, -1)]
    for pair in zip(cost, itertools.count()):
        pairs = sorted([*pairs, pair])[:2]
    return pairs


def two_by_partition(cost):
    order = np.argpartition(cost, 1)
    return (cost[order[0]], order[0]), (cost[order[1]], order[1])


# --- 07: scores -------------------------------------------------------------------------------------------------


def paired_by(solve):
    """Return a matching that another kind of program solves: of the weights, so much for a pair less its distance."""

    def matched(found, true, gate):
        if not len(found) or not len(true):
            return []
        apart = pairwise_distances(found, true)
        worth = np.where(apart <= gate, 100.0 - apart, 0.0)
        return [(f, t) for f, t in solve(worth) if apart[f, t] <= gate]

    return matched


def by_linear_program(worth):
    n, m = worth.shape
    once = np.vstack([np.kron(np.eye(n), np.ones(m)), np.kron(np.ones(n), np.eye(m))])
    x = optimize.linprog(-worth.ravel(), A_ub=once, b_ub=np.ones(n + m), method="highs-ds").x
    return [divmod(int(k), m) for k in np.flatnonzero(x > 0.5)]


def by_subsets(worth):
    """Over the subsets of columns that are taken, row after row."""
    best = {0: (0.0, [])}
    for f, row in enumerate(worth):
        for taken, (value, pairs) in list(best.items()):
            for t, w in enumerate(row):
                key = taken | 1 << t
                if w > 0 and not taken >> t & 1 and value + w > best.get(key, (-1.0,))[0]:
                    best[key] = value + w, [*pairs, (f, t)]
    return max(best.values())[1]


def by_padding(worth):
    size = max(worth.shape)
    square = np.zeros((size, size))
    square[: worth.shape[0], : worth.shape[1]] = worth
    rows, columns = optimize.linear_sum_assignment(square, maximize=True)
    return [(f, t) for f, t in zip(rows, columns, strict=True) if f < worth.shape[0] and t < worth.shape[1]]


def by_permutations_of_all(worth):
    n, m = worth.shape
    if n > m:
        return [(f, t) for t, f in by_permutations_of_all(worth.T)]
    best = max(itertools.permutations(range(m), n), key=lambda p: sum(worth[f, t] for f, t in enumerate(p)))
    return list(enumerate(best))


def parts_by(count):
    """Return the three parts, with one's own way to count what is right."""

    def parts(found, true, pairs, tolerance):
        matched = [(found[f], true[t]) for f, t in pairs]
        alike = [(f, t) for f, t in matched if f.kind == t.kind]
        places = [e for f, t in matched for e in f.centroid - t.centroid]
        sizes = [e for f, t in alike for e in best_turn(f.dimensions, t.dimensions)]
        total = sum(len(shape.dimensions) for shape in true)
        return (
            len(alike) / (len(true) + len(found) - len(pairs)),
            count(places, tolerance) / (2 * len(true)),
            count(sizes, tolerance) / total,
        )

    return parts


def best_turn(ours, theirs):
    turns = [np.roll(ours, n) - theirs for n in range(len(ours))] if len(ours) > 2 else [np.subtract(ours, theirs)]
    return turns[int(np.argmin([np.abs(turn).sum() for turn in turns]))]


COUNTS = {
    "sum": lambda errors, limit: sum(abs(e) <= limit for e in errors),
    "numpy": lambda errors, limit: np.count_nonzero(np.abs(np.array(errors)) <= limit),
    "squares": lambda errors, limit: len([e for e in errors if e * e <= limit * limit]),
    "both sides": lambda errors, limit: len(list(filter(lambda e: -limit <= e <= limit, errors))),
    "sorting": lambda errors, limit: bisect.bisect_right(sorted(map(abs, errors)), limit),
    "histogram": lambda errors, limit: int(np.histogram(errors, bins=[-limit, limit])[0][0]),
    "clip": lambda errors, limit: int(np.sum(np.clip(errors, -limit, limit) == np.array(errors))),
}


# --- 08: driving ------------------------------------------------------------------------------------------------


def speeds(left, right):
    return WHEEL * (left + right) / 2, WHEEL * (right - left) / AXLE


def drive_by_complex_numbers(pose, left, right, seconds):
    (v, w), (x, y, heading) = speeds(left, right), pose
    turn = w * seconds
    way = v * seconds * ((cmath.exp(1j * turn) - 1) / (1j * turn) if turn else 1)
    z = complex(x, y) + way * cmath.exp(1j * heading)
    return z.real, z.imag, heading + turn


def drive_by_matrix(pose, left, right, seconds):
    """The exponential of a twist."""
    from scipy.linalg import expm

    (v, w), (x, y, heading) = speeds(left, right), pose
    c, s = math.cos(heading), math.sin(heading)
    after = np.array([[c, -s, x], [s, c, y], [0, 0, 1]]) @ expm(seconds * np.array([[0, -w, v], [w, 0, 0], [0, 0, 0]]))
    return after[0, 2], after[1, 2], heading + w * seconds


def drive_by_sinc(pose, left, right, seconds):
    v, w = speeds(left, right)
    half = w * seconds / 2
    chord = v * seconds * np.sinc(half / np.pi)
    return np.add(pose, (chord * np.cos(pose[2] + half), chord * np.sin(pose[2] + half), 2 * half))


def drive_by_halves(pose, left, right, seconds):
    """Ten times half of the way: chords that are nearly arcs, mended by Richardson's rule."""

    def midpoints(n):
        (v, w), (x, y, heading) = speeds(left, right), pose
        middle = heading + w * seconds * (np.arange(n) + 0.5) / n
        return np.array([x + v * seconds * np.cos(middle).mean(), y + v * seconds * np.sin(middle).mean()])

    rows = [midpoints(2**k) for k in range(1, 8)]
    for order in range(1, len(rows)):
        rows = [b + (b - a) / (4**order - 1) for a, b in itertools.pairwise(rows)]
    return (*rows[0], pose[2] + speeds(left, right)[1] * seconds)


def drive_by_quadrature(pose, left, right, seconds):
    (v, w), heading = speeds(left, right), pose[2]
    nodes, weights = np.polynomial.legendre.leggauss(40)
    at = heading + w * seconds * (nodes + 1) / 2
    way = v * seconds / 2
    return [pose[0] + way * weights @ np.cos(at), pose[1] + way * weights @ np.sin(at), heading + w * seconds]


def seen_if_any(share):
    return lambda outline, points, reach: share(outline, points, reach + EDGE) if len(points) else 0.0


SEEN = {
    "sklearn": lambda o, p, r: np.mean(NearestNeighbors(n_neighbors=1).fit(p).kneighbors(o)[0] <= r),
    "balls": lambda o, p, r: np.mean(KDTree(p).query_radius(o, r, count_only=True) > 0),
    "a cloud": lambda o, p, r: sum(MultiPoint(p).distance(Point(place)) <= r for place in o) / len(o),
    "any": lambda o, p, r: sum(any(math.dist(a, b) <= r for b in p) for a in o.tolist()) / len(o),
    "squares": lambda o, p, r: (((o[:, None] - p[None]) ** 2).sum(axis=2).min(axis=1) <= r * r).mean(),
}

# --- 10: poses --------------------------------------------------------------------------------------------------


def cleaned_by_mask(ranges, low, high):
    masked = np.ma.masked_invalid(ranges)
    return np.ma.masked_where((masked <= 0) | (masked < low) | (masked >= high), masked).filled(INF)


def cleaned_by_copying(ranges, low, high):
    clean = np.full(ranges.shape, INF)
    np.copyto(clean, ranges, where=(ranges > 0) & (low <= ranges) & (ranges < high))
    return clean


def turning_matrix(angle):
    c, s = math.cos(angle), math.sin(angle)
    return np.array([(c, -s), (s, c)])


def off_in_plain_python(pose, hits, normals, offsets):
    (x, y, heading), found = pose, []
    for (u, v), (n, m), d in zip(hits, normals, offsets, strict=True):
        there = x + u * math.cos(heading) - v * math.sin(heading), y + u * math.sin(heading) + v * math.cos(heading)
        found.append(n * there[0] + m * there[1] - d)
    return found


def off_by_homogeneous(pose, hits, normals, offsets):
    moved = np.block([[turning_matrix(pose[2]), np.reshape(pose[:2], (2, 1))], [np.zeros((1, 2)), 1.0]])
    places, lines = np.column_stack([hits, np.ones(len(hits))]) @ moved.T, np.column_stack([normals, -offsets])
    return np.einsum("nk,nk->n", places, lines)


def off_by_turned_walls(pose, hits, normals, offsets):
    """As the robot sees it: walls are turned and moved, not hits."""
    return np.sum(normals @ turning_matrix(pose[2]) * hits, axis=1) - (offsets - normals @ pose[:2])


def off_by_bearings(pose, hits, normals, offsets):
    bearing = np.arctan2(hits[:, 1], hits[:, 0]) + pose[2] - np.arctan2(normals[:, 1], normals[:, 0])
    return np.hypot(*hits.T) * np.cos(bearing) + normals @ pose[:2] - offsets


def off_by_cross_product(pose, hits, normals, offsets):
    beyond = complexly(hits) * np.exp(1j * pose[2]) + complex(*pose[:2]) - offsets * complexly(normals)
    return -(np.conj(1j * complexly(normals)) * beyond).imag


def off_by_tensor(pose, hits, normals, offsets):
    return np.einsum("nj,jk,nk->n", normals, turning_matrix(pose[2]), hits) + normals.dot(pose[:2]) - offsets


def bends(guess, hits, normals):
    arms = hits @ turning_matrix(guess[2]).T
    return np.column_stack([normals, np.cross(np.pad(arms, ((0, 0), (0, 1))), np.pad(normals, ((0, 0), (0, 1))))[:, 2]])


def stepped_by(solve):
    """Return the step that some solver of least squares finds; without hits none."""

    def step(guess, hits, normals, offsets):
        off = off_by_tensor(guess, hits, normals, offsets)
        return guess - solve(bends(guess, hits, normals), off) if len(hits) else guess

    return step


def by_singular_values(jacobian, off):
    left, sizes, right = np.linalg.svd(jacobian, full_matrices=False)
    kept = sizes > 1e-9 * sizes[0]
    return (off @ left[:, kept] / sizes[kept]) @ right[kept]


def by_eigenvectors(jacobian, off):
    sizes, ways = np.linalg.eigh(jacobian.T @ jacobian)
    kept = sizes > 1e-12 * sizes[-1]
    return ways[:, kept] @ (ways[:, kept].T @ jacobian.T @ off / sizes[kept])


def step_as_the_robot_sees_it(guess, hits, normals, offsets):
    turn = turning_matrix(guess[2])
    seen = normals @ turn
    jacobian = np.column_stack([seen, seen[:, 1] * hits[:, 0] - seen[:, 0] * hits[:, 1]])
    x, y, angle = np.linalg.lstsq(jacobian, -off_by_turned_walls(guess, hits, normals, offsets), rcond=None)[0]
    return np.array([*(guess[:2] + turn @ (x, y)), guess[2] + angle])


def step_by_complex_numbers(guess, hits, normals, offsets):
    """The Jacobian from residuals at poses that are off by an imaginary hair."""
    columns = []
    for way in 1e-20j * np.eye(3):
        x, y, heading = guess + way
        c, s = np.cos(heading), np.sin(heading)
        places = np.column_stack([x + hits @ (c, -s), y + hits @ (s, c)])
        columns.append(((normals * places).sum(axis=1) - offsets).imag / 1e-20)
    return guess - np.linalg.pinv(np.transpose(columns)) @ off_by_tensor(guess, hits, normals, offsets)


# --- 11: layers -------------------------------------------------------------------------------------------------


def plane_from(normal_of):
    """A plane by a normal of any length, of the ways from the first point to the others."""

    def through(points):
        n = np.asarray(normal_of(points[1] - points[0], points[2] - points[0]))
        length = math.sqrt(n @ n)
        return (n / length, points[0] @ n / length) if length > 1e-9 else None

    return through


def plane_by_null_space(points):
    free = null_space(np.column_stack([points, -np.ones(3)]), rcond=1e-9)
    return (
        None
        if free.shape[1] > 1
        else (free[:3, 0] / np.hypot.reduce(free[:3, 0]), free[3, 0] / linalg_np.norm(free[:3]))
    )


def plane_by_eigenvectors(points):
    middle = points.sum(axis=0) / 3
    sizes, axes = linalg_np.eigh((points - middle).T @ (points - middle))
    return (axes[:, 0], middle @ axes[:, 0]) if sizes[1] > 1e-12 * sizes[2] else None


def normal_by_gram_schmidt(u, v):
    u = u / linalg_np.norm(u)
    v = v - (v @ u) * u
    return np.cross(u, v)


def normal_by_qr(u, v):
    q, r = linalg_np.qr(np.column_stack([u, v]), mode="complete")
    return q[:, 2] * (abs(r[1, 1]) > 1e-9)


def normal_by_minors(u, v):
    return [(-1) ** k * linalg_np.det(np.delete([u, v], k, axis=1)) for k in range(3)]


def normal_by_skew_matrix(u, v):
    return np.array([(0, -u[2], u[1]), (u[2], 0, -u[0]), (-u[1], u[0], 0)]) @ v


def sphere_from(solve):
    """An algebraic sphere, by a way to solve the equations of least squares."""

    def through(points):
        matrix = np.hstack([2 * points, np.ones((len(points), 1))])
        *c, s = solve(matrix, np.einsum("ij,ij->i", points, points))
        return tuple(map(float, c)), math.sqrt(s + sum(x * x for x in c))

    return through


def by_cramer(m, right):
    a, b = m.T @ m, m.T @ right
    return [linalg_np.det(np.column_stack([a[:, :k], b, a[:, k + 1 :]])) / linalg_np.det(a) for k in range(4)]


def nearest_one_by_one(points, seed, k):
    far, found = np.sum((points - points[seed]) ** 2, axis=1), []
    for _ in range(k + 1):
        found.append(int(np.argmin(far)))
        far[found[-1]] = INF
    return found


def nearest_within_the_kth(points, seed, k):
    far = spatial.distance.cdist(points[[seed]], points)[0]
    return np.flatnonzero(far <= np.sort(far)[k])


def nearest_by_a_heap(points, seed, k):
    return heapq.nsmallest(k + 1, range(len(points)), lambda i: math.dist(points[i], points[seed]))


def nearest_by_ranks(points, seed, k):
    place = np.argsort(np.argsort(pairwise_distances(points)[seed]))
    return [i for i, rank in enumerate(place) if rank <= k]


# --- 12: composites -----------------------------------------------------------------------------------------------


def fewest_by_integers(claims):
    """A part as the bits of a whole number."""
    full, bits = 2 ** claims.shape[1] - 1, [int("".join(map(str, row.astype(int))), 2) for row in claims]
    good = [s for s in range(1, 2 ** len(bits)) if reduce(lambda a, b: a | b, on(bits, s)) == full]
    least = min((s.bit_count() for s in good), default=0)
    return [list(on(range(len(bits)), s)) for s in good if s.bit_count() == least]


def on(values, mask):
    return [value for k, value in enumerate(values) if mask >> k & 1]


def fewest_by_growing(claims):
    """Sets grow by a part each, all of them at once."""
    layer = {frozenset()}
    while layer:
        if done := [s for s in layer if claims[sorted(s)].any(axis=0).all()]:
            return done
        layer = {s | {i} for s in layer for i in range(len(claims)) if i not in s}
    return []


def fewest_by_branching(claims):
    """Some part of each set claims the first place that is left."""

    def branch(some, left, most):
        if not left.any():
            return [some]
        if len(some) == most:
            return []
        first = left.argmax()
        return [s for i in np.flatnonzero(claims[:, first]) for s in branch(some | {int(i)}, left & ~claims[i], most)]

    all_of_it = np.ones(claims.shape[1], dtype=bool)
    tries = (set(map(frozenset, branch(frozenset(), all_of_it, most))) for most in range(1, len(claims) + 1))
    return next(filter(None, tries), set())


def fewest_by_taking_away(claims):
    """From all parts downwards, as long as something can be left out."""
    layer, last = {frozenset(range(len(claims)))}, set()
    while layer := {s for s in layer if s and claims[sorted(s)].any(axis=0).all()}:
        last, layer = layer, {s - {i} for s in layer for i in s}
    return [tuple(sorted(s)) for s in last]


def fewest_by_products(claims):
    """Of the parts that do not claim a place, none may be all of a set: a product of sums is 0 nowhere."""
    for size in range(1, len(claims) + 1):
        sets = np.array(list(itertools.combinations(range(len(claims)), size)))
        if (good := sets[claims[sets].sum(axis=1).prod(axis=1) > 0]).size:
            return good.tolist()
    return ()


def fewest_by_integer_program(claims):
    """How many: an integer program. Which: all sets of that size."""
    n = len(claims)
    least = optimize.milp(
        np.ones(n),
        constraints=optimize.LinearConstraint(claims.T.astype(float), 1, INF),
        integrality=np.ones(n),
        bounds=optimize.Bounds(0, 1),
    )
    if not least.success:
        return []
    return [
        s for s in itertools.combinations(range(n), round(least.fun)) if np.logical_or.reduce(claims[list(s)]).all()
    ]


def columns_in_plain_python(bearings, field_of_view, width):
    half = math.tan(field_of_view / 2)
    return [
        int((1 - math.tan(b) / half) / 2 * width) if -field_of_view / 2 < b < field_of_view / 2 else -1
        for b in bearings.tolist()
    ]


def columns_by_rays(bearings, field_of_view, width):
    """Where the beam meets the sensor's plane, one ahead."""
    x, y = np.cos(bearings), np.sin(bearings)
    half = np.tan(field_of_view / 2)
    ahead = (x > 0) & (np.abs(y) < half * x) if field_of_view < np.pi else x == x
    return np.where(ahead, (half - y / np.where(ahead, x, 1.0)) // (2 * half / width), -1)


def columns_by_homogeneous(bearings, field_of_view, width):
    focal = width / (2 * np.tan(field_of_view / 2))
    camera = np.array([[-focal, width / 2], [0.0, 1.0]])
    u, w = camera @ [np.sin(bearings), np.cos(bearings)]
    place = np.divide(u, w, out=np.full(len(bearings), -1.0), where=w > 0)
    return np.where((place >= 0) & (place < width), np.floor(place), -1).astype(int)


def columns_by_digitize(bearings, field_of_view, width):
    edges = np.arctan(np.linspace(1, -1, width + 1) * np.tan(field_of_view / 2))
    column = np.digitize(bearings, edges) - 1
    column[(column < 0) | (column >= width)] = -1
    return column


def columns_by_counting_edges(bearings, field_of_view, width):
    edges = np.arctan(np.linspace(1, -1, width + 1) * np.tan(field_of_view / 2))
    passed = (bearings[:, None] < edges).sum(axis=1)
    return np.where(passed <= width, passed - 1, -1)


def columns_by_complex_numbers(bearings, field_of_view, width):
    beam = np.exp(1j * bearings)
    half = np.exp(0.5j * field_of_view)
    place = width / 2 * (1 - (beam.imag / beam.real) * (half.real / half.imag))
    return np.where(beam.real > half.real, np.floor(place), -1)


WAYS = {
    "ray_segment": {
        "plain": segment_in_plain_python,
        "complex": segment_by_complex_numbers,
        "least squares": segment_by_least_squares,
        "determinants": segment_by_determinants,
        "homogeneous": segment_by_homogeneous_lines,
    },
    "ray_circle": {
        "roots": circle_by_roots,
        "plain": circle_in_plain_python,
        "complex": circle_by_complex_numbers,
        "vectorised": circle_vectorised,
        "own units": circle_in_its_own_units,
        "search": circle_by_search,
    },
    "to_cells": {
        "divmod": cells_by_divmod,
        "remainder": cells_by_remainder,
        "borders": cells_by_counting_borders,
        "upwards": cells_upwards,
    },
    "occupy": {
        "loop": occupy_by_loop,
        "recursion": occupy_by_recursion,
        "counting": occupy_by_counting,
        "vectorised": occupy_vectorised,
        "backwards": occupy_backwards,
        "matrix": occupy_by_matrix,
    },
    "assign_points": {
        "cdist": lambda points, centers: spatial.distance.cdist(points, centers).argmin(axis=1),
        "product": lambda points, centers: ((centers**2).sum(axis=1) - 2 * points @ centers.T).argmin(axis=1),
        "neighbours": lambda points, centers: KNeighborsClassifier(1).fit(centers, range(len(centers))).predict(points),
        "sorting": lambda points, centers: [
            min(range(len(centers)), key=lambda j: math.dist(p, centers[j])) for p in points
        ],
    },
    "update_centers": {
        "loop": update_by_loop,
        "mask": update_by_mask,
        "ndimage": update_by_ndimage,
        "adding": update_by_adding_at,
        "running": update_one_after_the_other,
        "sorting": update_by_sorting,
    },
    "silhouette": {
        "cdist": silhouette_from(lambda p: spatial.distance.cdist(p, p)),
        "pdist": silhouette_from(lambda p: spatial.distance.squareform(spatial.distance.pdist(p))),
        "complex": silhouette_from(lambda p: np.abs(np.subtract.outer(complexly(p), complexly(p)))),
        "norm": silhouette_from(lambda p: np.linalg.norm(p[:, None] - p, axis=2)),
        "samples": lambda points, labels: metrics.silhouette_samples(points, labels).mean(),
        "groups": silhouette_by_groups,
    },
    "line_through": {
        "plain": through_in_plain_python,
        "other normal": through_by_the_other_normal,
        "homogeneous": through_by_homogeneous_points,
        "null space": through_by_a_null_space,
        "turning": through_by_turning,
        "bearings": through_by_bearings,
    },
    "inliers_of": {
        "shapely": near_by_shapely,
        "complex": near_by_complex_numbers,
        "feet": near_by_feet,
        "sets": near_by_sets,
        "squares": near_by_squares,
        "sorting": near_by_sorting,
    },
    "fit_line": {name: fit_if_there_are_two(fit) for name, fit in FIT_LINES.items()},
    "ransac_line": {
        "neighbours in a shuffle": keep(
            lambda n, trials, rng: [p for _ in range(trials // n + 2) for p in itertools.pairwise(rng.permutation(n))]
        ),
        "indices": keep(lambda n, trials, rng: rng.integers(n, size=(trials, 2)).tolist()),
        "all at once": keep(lambda n, trials, rng: rng.permuted(np.tile(np.arange(n), (trials, 1)), axis=1)[:, :2]),
        "plain": keep(lambda n, trials, rng: [rng.permutation(n)[:2] for _ in range(trials)], rank=sum),
    },
    "fit_circle": {
        "normal equations": kasa(lambda m, right: np.linalg.solve(m.T @ m, m.T @ right)),
        "QR": kasa(lambda m, right: np.linalg.solve(np.linalg.qr(m)[1], np.linalg.qr(m)[0].T @ right)),
        "regression": kasa(lambda m, right: LinearRegression(fit_intercept=False).fit(m, right).coef_),
    },
    "circle_rms": RMS,
    "meet": {name: meet_if_not_parallel(meet) for name, meet in MEETS.items()},
    "sides_and_centroid": {
        "fan": measured_by_a_fan,
        "complex": measured_by_complex_numbers,
        "loop": measured_by_loop,
        "backwards": measured_backwards,
        "rings": measured_by_rings,
        "strips": measured_by_strips,
    },
    "fair_choice": {
        "removal": chosen_by(two_by_removal),
        "one go": chosen_by(two_in_one_go),
        "partition": chosen_by(two_by_partition),
        "sorted": chosen_by(lambda cost: sorted(zip(cost, range(len(cost)), strict=True))[:2]),
        "argsort": chosen_by(lambda cost: [(cost[i], i) for i in np.argsort(cost, kind="stable")[:2]]),
        "from the end": chosen_by(lambda cost: sorted(((c, i) for i, c in enumerate(cost)), reverse=True)[:-3:-1]),
    },
    "match_shapes": {
        "linear program": paired_by(by_linear_program),
        "subsets": paired_by(by_subsets),
        "padding": paired_by(by_padding),
        "permutations": paired_by(by_permutations_of_all),
        "backwards": lambda found, true, gate: [(f, t) for t, f in best_pairs(true, found, gate)][::-1],
    },
    "right": {
        "loop": lambda errors, limit: [bool(abs(e) <= limit) for e in errors],
        "both sides": lambda errors, limit: (errors >= -limit) & (errors <= limit),
        "squares": lambda errors, limit: errors**2 <= limit**2,
        "not too far": lambda errors, limit: ~(np.fabs(errors) > limit),
        "clip": lambda errors, limit: np.clip(errors, -limit, limit) == errors,
        "larger": lambda errors, limit: np.maximum(errors, -errors) <= limit,
        "logical": lambda errors, limit: np.logical_and(-limit <= errors, errors <= limit),
    },
    "parts": {name: parts_by(count) for name, count in COUNTS.items()},
    "drive_step": {
        "complex": drive_by_complex_numbers,
        "matrix": drive_by_matrix,
        "sinc": drive_by_sinc,
        "halves": drive_by_halves,
        "quadrature": drive_by_quadrature,
    },
    "share_seen": {name: seen_if_any(share) for name, share in SEEN.items()},
    "clean_ranges": {
        "mask": cleaned_by_mask,
        "copying": cleaned_by_copying,
        "select": lambda r, low, high: np.select([r <= 0, r < low, r >= high, r != r], [INF] * 4, r),
        "bins": lambda r, low, high: np.where(np.digitize(r, [max(low, np.nextafter(0, 1)), high]) == 1, r, INF),
        "iterator": lambda r, low, high: np.fromiter((x if 0 < x >= low and x < high else INF for x in r), float),
    },
    "wall_residuals": {
        "plain": off_in_plain_python,
        "homogeneous": off_by_homogeneous,
        "turned walls": off_by_turned_walls,
        "bearings": off_by_bearings,
        "cross product": off_by_cross_product,
        "tensor": off_by_tensor,
    },
    "newton_step": {
        "scipy": stepped_by(lambda jacobian, off: linalg_lstsq(jacobian, off)[0]),
        "singular values": stepped_by(by_singular_values),
        "eigenvectors": stepped_by(by_eigenvectors),
        "as the robot sees it": step_as_the_robot_sees_it,
        "complex numbers": step_by_complex_numbers,
    },
    "plane_through": {
        "null space": plane_by_null_space,
        "eigenvectors": plane_by_eigenvectors,
        "Gram and Schmidt": plane_from(normal_by_gram_schmidt),
        "QR": plane_from(normal_by_qr),
        "minors": plane_from(normal_by_minors),
        "skew matrix": plane_from(normal_by_skew_matrix),
    },
    "sphere_through": {
        "normal equations": sphere_from(lambda m, right: linalg_np.solve(m.T @ m, m.T @ right)),
        "QR": sphere_from(lambda m, right: linalg_np.solve(linalg_np.qr(m)[1], linalg_np.qr(m)[0].T @ right)),
        "pseudo-inverse": sphere_from(lambda m, right: linalg_np.pinv(m) @ right),
        "regression": sphere_from(lambda m, right: LinearRegression(fit_intercept=False).fit(m, right).coef_),
        "scipy": sphere_from(lambda m, right: linalg_lstsq(m, right)[0]),
        "Cramer": sphere_from(by_cramer),
    },
    "nearest_to": {
        "one by one": nearest_one_by_one,
        "within the k-th": nearest_within_the_kth,
        "tree": lambda points, seed, k: spatial.cKDTree(points).query(points[seed], list(range(1, k + 2)))[1],
        "heap": nearest_by_a_heap,
        "neighbours": lambda p, seed, k: NearestNeighbors(n_neighbors=k + 1).fit(p).kneighbors(p[[seed]])[1][0],
        "ranks": nearest_by_ranks,
    },
    "fewest_parts": {
        "integers": fewest_by_integers,
        "growing": fewest_by_growing,
        "branching": fewest_by_branching,
        "taking away": fewest_by_taking_away,
        "products": fewest_by_products,
        "integer program": fewest_by_integer_program,
    },
    "camera_columns": {
        "plain": columns_in_plain_python,
        "rays": columns_by_rays,
        "homogeneous": columns_by_homogeneous,
        "digitize": columns_by_digitize,
        "counting edges": columns_by_counting_edges,
        "complex": columns_by_complex_numbers,
    },
}
