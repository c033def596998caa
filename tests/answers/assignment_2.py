"""Problem set 2: one scan cut at its widest gaps, K-Medians, a wall in fog, a corridor of two parallel walls."""

# ruff: noqa: ARG001 (a wrong answer may leave out what it is given)

import math
import statistics
from itertools import combinations

import numpy as np
from scipy.cluster.hierarchy import fcluster, linkage
from scipy.sparse import coo_array
from scipy.spatial import ConvexHull, cKDTree
from scipy.spatial.distance import cdist
from sklearn.cluster import AgglomerativeClustering

import primkit as pk

TURN = 2 * math.pi


# --- cut_scan ----------------------------------------------------------------------------------------------


def cut_by_joining(points, k):
    """Join neighbours in the order of their gaps until k groups are left."""
    n = len(points)
    owner = list(range(n))

    def head(i):
        while owner[i] != i:
            i = owner[i]
        return i

    gaps = sorted((math.dist(points[i], points[(i + 1) % n]), i) for i in range(n))
    for _, i in gaps[: n - k]:
        owner[head(i)] = head((i + 1) % n)
    return [head(i) for i in range(n)]


def cut_by_threshold(points, k):
    """The k-th widest gap is the least one that separates."""
    ahead = np.linalg.norm(np.roll(points, -1, axis=0) - points, axis=1)
    separates = ahead >= np.sort(ahead)[-k]
    labels = np.roll(np.cumsum(separates), 1)
    labels[0] = 0
    return labels % k


def cut_turned(points, k):
    """Turn the ring so that it begins in the widest gap; then it is a chain."""
    gaps = np.linalg.norm(points - np.roll(points, 1, axis=0), axis=1)
    first = int(gaps.argmax())
    inner = np.delete(np.roll(gaps, -first), 0)
    cuts = np.sort(np.argsort(inner)[::-1][: k - 1]) + 1
    return np.roll(np.searchsorted(cuts, np.arange(len(points)), side="right"), first)


def cut_by_walking(points, k):
    """Plain Python: walk round the ring, and begin a new group at each of the widest steps."""
    steps = [math.dist(points[i - 1], points[i]) for i in range(len(points))]
    begins = sorted(range(len(points)), key=lambda i: -steps[i])[:k]
    label, labels = 0, [0] * len(points)
    for i in range(len(points)):
        place = (min(begins) + i) % len(points)
        label += place in begins
        labels[place] = label
    return labels


def cut_by_ring_linkage(points, k):
    """Single linkage along the ring alone: only neighbours may be joined."""
    n = len(points)
    if n <= 2 or k == n:
        return np.arange(n) % k
    ring = coo_array((np.ones(n), (np.arange(n), (np.arange(n) + 1) % n)), shape=(n, n))
    model = AgglomerativeClustering(k, linkage="single", connectivity=ring + ring.T)
    return model.fit_predict(points)


def cut_by_nearness(points, k):
    """Single linkage among all points: what is near may be no neighbour in the scan."""
    if len(points) == 1:
        return np.zeros(1)
    return fcluster(linkage(points, "single"), k, "maxclust")


def cut_ring(gaps, k):
    begins = np.zeros(len(gaps), dtype=int)
    begins[np.argsort(gaps)[len(gaps) - k :]] = 1
    return np.cumsum(begins) % k


def cut_open(points, k):
    gaps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    cuts = np.sort(np.argsort(gaps)[::-1][: k - 1])
    return np.searchsorted(cuts, np.arange(len(points)), side="left")


def cut_once_more(points, k):
    gaps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    cuts = np.sort(np.argsort(gaps)[::-1][:k])
    return np.searchsorted(cuts, np.arange(len(points)), side="left")


def cut_in_bearing(points, k):
    bearing = np.unwrap(np.arctan2(points[:, 1], points[:, 0]))
    gaps = np.diff(bearing, prepend=bearing[-1] - TURN)
    return cut_ring(np.abs((gaps + np.pi) % TURN - np.pi), k)


def cut_in_range(points, k):
    away = np.linalg.norm(points, axis=1)
    return cut_ring(np.abs(away - np.roll(away, 1)), k)


def cut_narrowest(points, k):
    return cut_ring(-np.linalg.norm(points - np.roll(points, 1, axis=0), axis=1), k)


def cut_by_linking(points, k):
    """A fixed reach, and k unused."""
    return pk.link(points, 0.05)


# --- k_medians ---------------------------------------------------------------------------------------------


def medians_by_loops(points, centers):
    """Plain Python, with the median of the standard library."""
    centers = [tuple(center) for center in centers.tolist()]
    while True:
        groups = [[] for _ in centers]
        for x, y in points.tolist():
            away = [abs(x - a) + abs(y - b) for a, b in centers]
            groups[away.index(min(away))].append((x, y))
        moved = [
            tuple(statistics.median(values) for values in zip(*group, strict=True)) if group else center
            for group, center in zip(groups, centers, strict=True)
        ]
        if moved == centers:
            return centers
        centers = moved


def medians_by_labels(points, centers):
    """Stops when no label changes; distances by SciPy."""
    centers, labels = centers.copy(), None
    while True:
        mine = cdist(points, centers, "cityblock").argmin(axis=1)
        if labels is not None and (mine == labels).all():
            return centers
        labels = mine
        for k in np.unique(labels):
            centers[k] = np.quantile(points[labels == k], 0.5, axis=0)


def medians_general(points, centers, metric="cityblock", middle=np.median, rounds=100):
    for _ in range(rounds):
        labels = cdist(points, centers, metric).argmin(axis=1)
        groups = [points[labels == k] for k in range(len(centers))]
        pairs, before = zip(groups, centers, strict=True), centers
        centers = np.array([middle(group, axis=0) if len(group) else center for group, center in pairs])
        if (centers == before).all():
            break
    return centers


def medians_means(points, centers):
    return medians_general(points, centers, middle=np.mean)


def medians_k_means(points, centers):
    return medians_general(points, centers, metric="euclidean", middle=np.mean)


def medians_euclid(points, centers):
    return medians_general(points, centers, metric="euclidean")


def medians_once(points, centers):
    return medians_general(points, centers, rounds=1)


def medians_low(points, centers):
    return medians_general(points, centers, middle=lambda group, axis: np.sort(group, axis=axis)[(len(group) - 1) // 2])


def medians_point(points, centers):
    return medians_general(
        points, centers, middle=lambda group, axis: group[cdist(group, group, "cityblock").sum(axis=axis).argmin()]
    )


def medians_nan(points, centers):
    """The median of no points is none."""
    found = medians_by_loops(points, centers)
    labels = cdist(points, found, "cityblock").argmin(axis=1)
    return np.array([np.median(points[labels == k], axis=0) for k in range(len(found))])


def medians_lost(points, centers):
    """Keeps only centres that have points."""
    found = np.array(medians_by_loops(points, centers))
    return found[np.unique(cdist(points, found, "cityblock").argmin(axis=1))]


# --- wall_in_fog -------------------------------------------------------------------------------------------


def fog_by_ransac(points, threshold, rng):
    """Random pairs; a line counts when nothing lies behind it, seen from the robot."""
    best, most = None, 0
    for _ in range(1500 if len(points) > 1 else 0):
        p, q = points[rng.choice(len(points), 2, replace=False)]
        if (p == q).all():
            continue
        angle = math.atan2(q[0] - p[0], p[1] - q[1])
        offset = math.cos(angle) * p[0] + math.sin(angle) * p[1]
        if offset < 0:
            angle, offset = angle + math.pi, -offset
        out = points @ (math.cos(angle), math.sin(angle)) - offset
        count = int((abs(out) <= threshold).sum())
        if count > most and out.max() <= threshold:
            best, most = abs(out) <= threshold, count
    if best is None:
        return None
    line = pk.fit_line(points[best])
    return line.angle, line.offset


def fog_by_bearings(points, threshold, rng):
    """For each bearing the farthest hit carries the line; the fullest band wins, first coarsely, then finely."""
    if len(np.unique(points, axis=0)) < 2:
        return None
    angles = np.linspace(0, TURN, 3000, endpoint=False)
    along = points @ np.array([np.cos(angles), np.sin(angles)])
    farthest = along.max(axis=0)
    counts = (along >= farthest - threshold).sum(axis=0) * (farthest >= 0)
    line = pk.fit_line(points[along[:, counts.argmax()] >= farthest[counts.argmax()] - threshold])
    for _ in range(5):
        line = pk.fit_line(points[np.abs(line.signed_distance(points)) <= threshold])
    return line.angle, line.offset


def fog_ransac_plain(points, threshold, rng):
    """Most inliers, and no question about what lies behind."""
    if len(np.unique(points, axis=0)) < 2:
        return None
    best = max(pk.find_lines(points, threshold, rng=0), key=lambda found: found.inliers.sum())
    return best.line.angle, best.line.offset


def fog_least_squares(points, threshold, rng):
    line = pk.fit_line(points)
    return None if line is None else (line.angle, line.offset)


def fog_nearest(points, threshold, rng):
    """Seen from the wrong side: nothing lies in front of the line."""
    if len(np.unique(points, axis=0)) < 2:
        return None
    angles = np.linspace(0, TURN, 720, endpoint=False)
    along = points @ np.array([np.cos(angles), np.sin(angles)])
    nearest = along.min(axis=0)
    counts = np.where(nearest > 0, (along <= nearest + threshold).sum(axis=0), 0)
    k = int(counts.argmax())
    return float(angles[k]), float(nearest[k])


def fog_two_farthest(points, threshold, rng):
    """The line through the two hits that are farthest away."""
    if len(np.unique(points, axis=0)) < 2:
        return None
    line = pk.fit_line(points[np.argsort(np.linalg.norm(points, axis=1))[-2:]])
    return line.angle, line.offset


def fog_never_none(points, threshold, rng):
    if len(points) == 0:
        return 0.0, 0.0
    return fog_by_ransac(points, threshold, rng) or (0.0, float(points[0, 0]))


def fog_farthest_pair(points, threshold, rng):
    """Through the two hits that are farthest from the robot."""
    p, q = points[np.argsort(np.linalg.norm(points, axis=1))[-2:]]
    angle = math.atan2(q[0] - p[0], p[1] - q[1])
    return angle, math.cos(angle) * p[0] + math.sin(angle) * p[1]


# --- corridor ----------------------------------------------------------------------------------------------


def corridor_by_formula(left, right):
    """The bearing for which the pooled scatter across is least, in one formula."""
    x, y = np.concatenate([left - left.mean(axis=0), right - right.mean(axis=0)]).T
    bearing = 0.5 * math.atan2(2 * (x * y).sum(), (x * x).sum() - (y * y).sum())
    normal = np.array([-math.sin(bearing), math.cos(bearing)])
    return bearing, abs(normal @ left.mean(axis=0) - normal @ right.mean(axis=0))


def corridor_by_search(left, right):
    """The bearing by golden sections, after a coarse search; offsets are means."""
    from scipy.optimize import minimize_scalar

    def squares(bearing):
        normal = np.array([-math.sin(bearing), math.cos(bearing)])
        return sum(((wall @ normal - (wall @ normal).mean()) ** 2).sum() for wall in (left, right))

    start = min(np.linspace(0, math.pi, 180, endpoint=False), key=squares)
    bearing = minimize_scalar(squares, bracket=(start - 0.02, start, start + 0.02), tol=1e-13).x
    normal = np.array([-math.sin(bearing), math.cos(bearing)])
    return bearing + math.pi, abs((left @ normal).mean() - (right @ normal).mean())


def corridor_by_eigenvectors(left, right):
    """The pooled covariance, with the number of points as weight."""
    pooled = sum(len(wall) * np.cov(wall.T, bias=True) for wall in (left, right) if len(wall) > 1)
    normal = np.linalg.eigh(pooled)[1][:, 0]
    return math.atan2(normal[0], -normal[1]), abs(normal @ (left.mean(axis=0) - right.mean(axis=0)))


def bearing_of(points):
    along = np.linalg.svd(points - points.mean(axis=0))[2][0]
    return math.atan2(along[1], along[0])


def with_width(bearing, left, right):
    normal = np.array([-math.sin(bearing), math.cos(bearing)])
    return bearing, abs(normal @ (left.mean(axis=0) - right.mean(axis=0)))


def corridor_mean(left, right):
    x, y = (np.array([math.cos(2 * b), math.sin(2 * b)]) for b in (bearing_of(left), bearing_of(right)))
    return with_width(math.atan2(*(x + y)[::-1]) / 2, left, right)


def corridor_plain_mean(left, right):
    slopes = [math.atan(math.tan(bearing_of(wall))) for wall in (left, right)]
    return with_width(sum(slopes) / 2, left, right)


def corridor_together(left, right):
    return with_width(bearing_of(np.vstack([left, right])), left, right)


def corridor_means(left, right):
    return corridor_by_formula(left, right)[0], math.dist(left.mean(axis=0), right.mean(axis=0))


def corridor_across(left, right):
    bearing, width = corridor_by_formula(left, right)
    return bearing + math.pi / 2, width


def corridor_in_y(left, right):
    x, y = np.concatenate([left - left.mean(axis=0), right - right.mean(axis=0)]).T
    return with_width(math.atan2((x * y).sum(), (x * x).sum()), left, right)


def corridor_longer(left, right):
    return with_width(bearing_of(left if len(left) >= len(right) else right), left, right)


def corridor_half(left, right):
    bearing, width = corridor_by_formula(left, right)
    return bearing, width / 2


def corridor_degrees(left, right):
    bearing, width = corridor_by_formula(left, right)
    return math.degrees(bearing), width


# --- other right ways, and other wrong ones --------------------------------------------------------------------


def cut_after(points, k):
    """A group ends one point late."""
    return np.roll(cut_turned(points, k), 1)


def cut_along_x(points, k):
    """Gaps along x alone."""
    return cut_ring(np.abs(points[:, 0] - np.roll(points[:, 0], 1)), k)


def cut_in_equal_parts(points, k):
    return np.arange(len(points)) * k // len(points)


def medians_by_tree(points, centers):
    """Nearest centres from a tree of city blocks; the middle of sorted values."""
    while True:
        nearest = cKDTree(centers).query(points, p=1)[1]
        moved = centers.copy()
        for k in set(nearest):
            own = np.sort(points[nearest == k], axis=0)
            moved[k] = (own[(len(own) - 1) // 2] + own[len(own) // 2]) / 2
        if np.allclose(moved, centers, rtol=0, atol=1e-12):
            return moved
        centers = moved


def medians_by_recursion(points, centers):
    near = [min(range(len(centers)), key=lambda k, p=p: abs(p - centers[k]).sum()) for p in points]
    moved = np.array(
        [
            np.median([p for p, own in zip(points, near, strict=True) if own == k], axis=0) if k in near else center
            for k, center in enumerate(centers)
        ]
    )
    return moved if (moved == centers).all() else medians_by_recursion(points, moved)


def medians_by_columns(points, centers):
    """x and y apart, in place of a copy."""
    ends, (x, y) = np.array(centers, dtype=float), np.asarray(points).T
    before = None
    while before is None or (ends != before).any():
        before = ends.copy()
        away = np.abs(np.subtract.outer(x, ends[:, 0])) + np.abs(np.subtract.outer(y, ends[:, 1]))
        member = away.argmin(axis=1)[:, None] == np.arange(len(ends))
        for k in np.flatnonzero(member.any(axis=0)):
            ends[k] = np.percentile(x[member[:, k]], 50), np.percentile(y[member[:, k]], 50)
    return ends


def medians_chebyshev(points, centers):
    return medians_general(points, centers, metric="chebyshev")


def medians_of_extents(points, centers):
    return medians_general(points, centers, middle=lambda group, axis: (group.min(axis) + group.max(axis)) / 2)


def fog_by_all_pairs(points, threshold, rng):
    """Plain Python over all pairs, refitted."""
    best, most = None, 0
    for (ax, ay), (bx, by) in combinations(map(tuple, points), 2):
        length = math.hypot(bx - ax, by - ay)
        if length == 0:
            continue
        n = np.array([ay - by, bx - ax]) / length
        d = n @ (ax, ay)
        n, d = (n, d) if d >= 0 else (-n, -d)
        out = points @ n - d
        if out.max() <= threshold and (count := int((out >= -threshold).sum())) > most:
            best, most = out >= -threshold, count
    line = None if best is None else pk.fit_line(points[best])
    return None if line is None else (line.angle, line.offset)


def fog_by_library(points, threshold, rng):
    """Lines one after the other from the library; a line with something behind it is taken away, and so on."""
    left = np.asarray(points)
    while len(np.unique(left, axis=0)) > 1:
        found = pk.find_lines(left, threshold, left_over=0.0, trials=3000, rng=rng)
        for one in sorted(found, key=lambda one: -one.inliers.sum()):
            line = one.line if one.line.offset >= 0 else one.line.turned_round()
            if line.signed_distance(points).max() <= 2 * threshold:
                return line.angle, line.offset
        left = left[:0]
    return None


def fog_by_hull(points, threshold, rng):
    """The side of the convex hull with most hits along it: nothing lies behind a hull."""
    if len(np.unique(points, axis=0)) < 2:
        return None
    ring = points[ConvexHull(points).vertices] if len(points) > 2 else points
    best = np.zeros(len(points), dtype=bool)
    for p, q in combinations(ring, 2):
        n = np.array([p[1] - q[1], q[0] - p[0]]) / math.dist(p, q)
        out = (points - p) @ n * (1 if p @ n >= 0 else -1)
        for move in np.linspace(0, max(out.max(), 0), 3):
            near = np.abs(out - move) <= threshold
            if (out <= move + threshold).all() and near.sum() > best.sum():
                best = near
    line = pk.fit_line(points[best])
    for _ in range(3):
        line = pk.fit_line(points[np.abs(line.signed_distance(points)) <= threshold])
    return line.angle, line.offset


def fog_farthest_third(points, threshold, rng):
    """Least squares over the farthest third of all hits."""
    if len(np.unique(points, axis=0)) < 2:
        return None
    return fog_least_squares(points[np.argsort(np.linalg.norm(points, axis=1))[-max(len(points) // 3, 2) :]], 0, 0)


def fog_in_degrees(points, threshold, rng):
    line = fog_by_bearings(points, threshold, rng)
    return line and (math.degrees(line[0]), line[1])


def fog_turned_pair(points, threshold, rng):
    line = fog_by_bearings(points, threshold, rng)
    return line and line[::-1]


def fog_along(points, threshold, rng):
    """The bearing of the wall instead of its normal's."""
    line = fog_by_bearings(points, threshold, rng)
    return line and (line[0] + math.pi / 2, line[1])


def corridor_by_regression(left, right):
    """Turn the walls level, fit one slope for both, turn by it, and again."""
    bearing = bearing_of(left if len(left) > 1 else right)
    for _ in range(60):
        c, s = math.cos(bearing), math.sin(bearing)
        x, y = np.concatenate([(wall - wall.mean(axis=0)) @ [[c, -s], [s, c]] for wall in (left, right)]).T
        bearing += 0.5 * math.atan2(2 * (x @ y), x @ x - y @ y)
    return with_width(bearing, left, right)


def corridor_by_svd(left, right):
    """One design matrix for both walls, a column of ones for each; reduced by the ones, then the least direction."""
    ones = np.zeros((len(left) + len(right), 2))
    ones[: len(left), 0], ones[len(left) :, 1] = 1, 1
    both = np.vstack([left, right])
    normal = np.linalg.svd(both - ones @ np.linalg.lstsq(ones, both, rcond=None)[0])[2][-1]
    d, e = np.linalg.lstsq(ones, both @ normal, rcond=None)[0]
    return math.atan2(normal[1], normal[0]) - math.pi / 2, abs(d - e)


def corridor_turned_pair(left, right):
    return corridor_by_formula(left, right)[::-1]


# Each wrong answer with what it loses (v: the visible tests; 1, 2, ...: hidden parts), and the short name of its fault.
ANSWERS = {
    "cut_scan": {
        "right": {
            "joining": cut_by_joining,
            "threshold": cut_by_threshold,
            "turned": cut_turned,
            "walking": cut_by_walking,
            "ring linkage": cut_by_ring_linkage,
        },
        "wrong": {
            "one point late": (cut_after, "v123", None),
            "along x": (cut_along_x, "123", None),
            "equal parts": (cut_in_equal_parts, "v123", None),
            "open chain": (cut_open, "v2", "ring not closed"),
            "one cut too many": (cut_once_more, "v1234", "one cut too many"),
            "in bearing": (cut_in_bearing, "3", "gap in bearing"),
            "in range": (cut_in_range, "12", "gap in range"),
            "narrowest": (cut_narrowest, "v123", "narrowest gaps"),
            "linking": (cut_by_linking, "v1234", None),
            "nearness": (cut_by_nearness, "3", "joined by nearness"),
        },
    },
    "k_medians": {
        "right": {
            "tree": medians_by_tree,
            "recursion": medians_by_recursion,
            "columns": medians_by_columns,
            "loops": medians_by_loops,
            "labels": medians_by_labels,
        },
        "wrong": {
            "chebyshev": (medians_chebyshev, "2", None),
            "extents": (medians_of_extents, "v123", None),
            "means": (medians_means, "v123", "mean for median"),
            "k-means": (medians_k_means, "v123", "K-Means for K-Medians"),
            "euclid": (medians_euclid, "2", "straight distance"),
            "once": (medians_once, "2", "one round"),
            "low": (medians_low, "v123", "one of two middle values"),
            "point": (medians_point, "v123", "a point for the median"),
            "nan": (medians_nan, "3", "nan for a lonely centre"),
            "lost": (medians_lost, "3", "lonely centre lost"),
        },
    },
    "wall_in_fog": {
        "right": {
            "all pairs": fog_by_all_pairs,
            "library": fog_by_library,
            "hull": fog_by_hull,
            "random pairs": fog_by_ransac,
            "bearings": fog_by_bearings,
        },
        "wrong": {
            "farthest third": (fog_farthest_third, "12", "hits behind the wall"),
            "degrees": (fog_in_degrees, "v123", None),
            "offset first": (fog_turned_pair, "v123", None),
            "along": (fog_along, "v123", None),
            "most inliers": (fog_ransac_plain, "v2", "hits behind the wall"),
            "least squares": (fog_least_squares, "v12", "least squares over all"),
            "wrong side": (fog_nearest, "v12", "hits behind the wall"),
            "never none": (fog_never_none, "v3", "a line from one point"),
            "two farthest hits": (fog_two_farthest, "12", "line through the farthest hits"),
            "farthest pair": (fog_farthest_pair, "v123", "line through the farthest hits"),
        },
    },
    "corridor": {
        "right": {
            "regression": corridor_by_regression,
            "one matrix": corridor_by_svd,
            "formula": corridor_by_formula,
            "search": corridor_by_search,
            "eigenvectors": corridor_by_eigenvectors,
        },
        "wrong": {
            "width first": (corridor_turned_pair, "v123", None),
            "mean of two": (corridor_mean, "3", "mean of two bearings"),
            "plain mean": (corridor_plain_mean, "3", "mean of two bearings"),
            "together": (corridor_together, "v23", "one line for both"),
            "distance of means": (corridor_means, "v23", "distance of the means"),
            "across": (corridor_across, "v123", "across for along"),
            "in y": (corridor_in_y, "v3", "errors in y"),
            "longer alone": (corridor_longer, "3", "longer wall alone"),
            "half the width": (corridor_half, "v123", "half the width"),
            "degrees": (corridor_degrees, "v123", None),
        },
    },
}
