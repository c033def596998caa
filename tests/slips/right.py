"""A right answer to each task of the lessons, written plainly, as the lesson teaches it."""

import itertools

import numpy as np

import primkit as pk


def ray_segment(origin, direction, a, b):
    side = b - a
    to_a = a - origin
    cross = direction[0] * side[1] - direction[1] * side[0]
    if abs(cross) < 1e-12:
        return float("inf")
    t = (to_a[0] * side[1] - to_a[1] * side[0]) / cross
    s = (to_a[0] * direction[1] - to_a[1] * direction[0]) / cross
    if t >= 0 and 0 <= s <= 1:
        return t
    return float("inf")


def ray_circle(origin, direction, center, radius):
    w = center - origin
    along = np.dot(w, direction)
    under_root = radius**2 - (np.dot(w, w) - along**2)
    if under_root < 0:
        return float("inf")
    near = along - np.sqrt(under_root)
    far = along + np.sqrt(under_root)
    if near >= 0:
        return near
    if far >= 0:
        return far
    return float("inf")


def to_cells(points, resolution):
    i = np.floor(points[:, 0] / resolution)
    j = np.floor(points[:, 1] / resolution)
    return np.stack([i, j], axis=1).astype(int)


def occupy(cells, pose, angles, ranges, resolution):
    new = set(cells)
    x, y, heading = pose
    for angle, r in zip(angles, ranges, strict=True):
        if r < np.inf:
            hit_x = x + r * np.cos(heading + angle)
            hit_y = y + r * np.sin(heading + angle)
            i = int(np.floor(hit_x / resolution))
            j = int(np.floor(hit_y / resolution))
            new.add((i, j))
    return new


def assign_points(points, centers):
    difference = points[:, None, :] - centers[None, :, :]
    distance = np.sqrt(np.sum(difference**2, axis=2))
    return np.argmin(distance, axis=1)


def update_centers(points, labels, centers):
    new = centers.copy()
    for k in range(len(centers)):
        own = points[labels == k]
        if len(own) > 0:
            new[k] = own.mean(axis=0)
    return new


def silhouette(points, labels):
    scores = []
    for i in range(len(points)):
        distance = np.hypot(points[:, 0] - points[i, 0], points[:, 1] - points[i, 1])
        own = labels == labels[i]
        if np.sum(own) == 1:
            scores.append(0.0)
            continue
        a = np.sum(distance[own]) / (np.sum(own) - 1)
        b = min(np.mean(distance[labels == k]) for k in np.unique(labels) if k != labels[i])
        scores.append((b - a) / max(a, b))
    return np.mean(scores)


def line_through(p, q):
    dx = q[0] - p[0]
    dy = q[1] - p[1]
    if dx == 0 and dy == 0:
        return None
    angle = np.arctan2(dy, dx) + np.pi / 2
    offset = p[0] * np.cos(angle) + p[1] * np.sin(angle)
    return angle, offset


def inliers_of(points, line, threshold):
    angle, offset = line
    distance = points[:, 0] * np.cos(angle) + points[:, 1] * np.sin(angle) - offset
    return np.abs(distance) <= threshold


def fit_line(points):
    if len(np.unique(points, axis=0)) < 2:
        return None
    middle = points.mean(axis=0)
    directions = np.linalg.svd(points - middle)[2]
    normal = directions[1]
    angle = np.arctan2(normal[1], normal[0])
    return angle, normal @ middle


def ransac_line(points, threshold, trials, rng):
    best, most = None, 0
    if len(points) < 2:
        return None
    for _ in range(trials):
        i, j = rng.choice(len(points), 2, replace=False)
        along = points[j] - points[i]
        length = np.hypot(along[0], along[1])
        if length == 0:
            continue
        normal = np.array([-along[1], along[0]]) / length
        inside = np.abs((points - points[i]) @ normal) <= threshold
        if np.sum(inside) > most:
            best, most = inside, np.sum(inside)
    if best is None:
        return None
    line = pk.fit_line(points[best])
    n = np.array([np.cos(line.angle), np.sin(line.angle)])
    return (line.angle, line.offset), np.abs(points @ n - line.offset) <= threshold


def fit_circle(points):
    if len(points) < 3:
        return None
    A = np.column_stack([2 * points[:, 0], 2 * points[:, 1], np.ones(len(points))])
    if np.linalg.matrix_rank(A) < 3:
        return None
    a, b, k = np.linalg.lstsq(A, np.sum(points**2, axis=1), rcond=None)[0]
    return a, b, np.sqrt(k + a**2 + b**2)


def circle_rms(points, center, radius):
    dx = points[:, 0] - center[0]
    dy = points[:, 1] - center[1]
    residuals = np.sqrt(dx**2 + dy**2) - radius
    return np.sqrt(np.mean(residuals**2))


def meet(a, b):
    bend = np.sin(b[0] - a[0])
    if abs(bend) < 1e-9:
        return None
    x = (a[1] * np.sin(b[0]) - b[1] * np.sin(a[0])) / bend
    y = (b[1] * np.cos(a[0]) - a[1] * np.cos(b[0])) / bend
    return np.array([x, y])


def sides_and_centroid(corners):
    sides = []
    area = x_sum = y_sum = 0.0
    for i in range(len(corners)):
        x0, y0 = corners[i]
        x1, y1 = corners[(i + 1) % len(corners)]
        sides.append(np.hypot(x1 - x0, y1 - y0))
        cross = x0 * y1 - x1 * y0
        area += cross / 2
        x_sum += (x0 + x1) * cross
        y_sum += (y0 + y1) * cross
    return np.array(sides), np.array([x_sum, y_sum]) / (6 * area)


def fair_choice(squares, numbers, n_points, spread):
    costs = squares / spread**2 + numbers * np.log(n_points)
    order = np.argsort(costs)
    if len(costs) < 2:
        return 0, float("inf")
    return order[0], costs[order[1]] - costs[order[0]]


def match_shapes(found, true, gate):
    best, best_cost = [], (0, 0.0)
    few, many = (found, true) if len(found) <= len(true) else (true, found)
    for chosen in itertools.permutations(range(len(many)), len(few)):
        pairs, total = [], 0.0
        for i, j in enumerate(chosen):
            apart = np.hypot(few[i][0] - many[j][0], few[i][1] - many[j][1])
            if apart <= gate:
                pairs.append((i, j) if few is found else (j, i))
                total += apart
        if (-len(pairs), total) < best_cost:
            best, best_cost = pairs, (-len(pairs), total)
    return best


def right(errors, tolerance):
    marks = []
    for i in range(len(errors)):
        marks.append(abs(errors[i]) <= tolerance)
    return np.array(marks, dtype=bool)


def parts(found, true, pairs, tolerance):
    n_shape = n_center = n_dimension = 0
    for f, t in pairs:
        mine, truth = found[f], true[t]
        for axis in (0, 1):
            if abs(mine.centroid[axis] - truth.centroid[axis]) <= tolerance:
                n_center += 1
        if mine.kind != truth.kind:
            continue
        n_shape += 1
        best = None
        for shift in range(len(truth.dimensions)):
            errors = np.abs(np.roll(mine.dimensions, shift) - truth.dimensions)
            if best is None or np.sum(errors) < np.sum(best):
                best = errors
        n_dimension += np.sum(best <= tolerance)
    alarms = len(found) - len(pairs)
    total = sum(len(shape.dimensions) for shape in true)
    return n_shape / (len(true) + alarms), n_center / (2 * len(true)), n_dimension / total


def drive_step(pose, left, right, seconds):
    x, y, heading = pose
    v = pk.robot.WHEEL * (left + right) / 2
    w = pk.robot.WHEEL * (right - left) / pk.robot.AXLE
    if abs(w) < 1e-9:
        return x + v * seconds * np.cos(heading), y + v * seconds * np.sin(heading), heading
    radius = v / w
    after = heading + w * seconds
    x = x + radius * (np.sin(after) - np.sin(heading))
    y = y - radius * (np.cos(after) - np.cos(heading))
    return x, y, after


def share_seen(outline, points, reach):
    seen = 0
    for x, y in outline:
        if len(points) > 0:
            distance = np.hypot(points[:, 0] - x, points[:, 1] - y)
            if np.min(distance) <= reach:
                seen += 1
    return seen / len(outline)


def clean_ranges(ranges, range_min, range_max):
    clean = np.full(len(ranges), np.inf)
    for k in range(len(ranges)):
        if ranges[k] > 0 and range_min <= ranges[k] < range_max:
            clean[k] = ranges[k]
    return clean


def wall_residuals(pose, hits, normals, offsets):
    x, y, heading = pose
    place_x = x + np.cos(heading) * hits[:, 0] - np.sin(heading) * hits[:, 1]
    place_y = y + np.sin(heading) * hits[:, 0] + np.cos(heading) * hits[:, 1]
    return normals[:, 0] * place_x + normals[:, 1] * place_y - offsets


def newton_step(guess, hits, normals, offsets):
    x, y, heading = guess
    arm_x = np.cos(heading) * hits[:, 0] - np.sin(heading) * hits[:, 1]
    arm_y = np.sin(heading) * hits[:, 0] + np.cos(heading) * hits[:, 1]
    off = normals[:, 0] * (x + arm_x) + normals[:, 1] * (y + arm_y) - offsets
    turn = normals[:, 1] * arm_x - normals[:, 0] * arm_y
    jacobian = np.stack([normals[:, 0], normals[:, 1], turn], axis=1)
    step = np.linalg.lstsq(jacobian, off, rcond=None)[0]
    return guess - step


def plane_through(points):
    a, b, c = points
    normal = np.cross(b - a, c - a)
    length = np.linalg.norm(normal)
    if length == 0:
        return None
    normal = normal / length
    return normal, np.dot(normal, a)


def sphere_through(points):
    matrix = np.ones((len(points), 4))
    matrix[:, :3] = 2 * points
    squares = np.sum(points**2, axis=1)
    solution = np.linalg.lstsq(matrix, squares, rcond=None)[0]
    center = solution[:3]
    return center, np.sqrt(solution[3] + np.sum(center**2))


def nearest_to(points, seed, k):
    difference = points - points[seed]
    distance = np.sqrt(np.sum(difference**2, axis=1))
    return np.argsort(distance)[: k + 1]


def fewest_parts(claims):
    for size in range(1, len(claims) + 1):
        found = []
        for some in itertools.combinations(range(len(claims)), size):
            if np.all(np.any(claims[list(some)], axis=0)):
                found.append(some)
        if len(found) > 0:
            return found
    return []


def camera_columns(bearings, field_of_view, width):
    share = np.tan(bearings) / np.tan(field_of_view / 2)
    place = (1 - share) / 2 * width
    inside = np.abs(bearings) < field_of_view / 2
    return np.where(inside, np.floor(place), -1).astype(int)
