"""The capstone: a pipeline on one's own scans, and a hunt for three bugs."""

import functools
import math

import numpy as np
from scipy.cluster.hierarchy import fcluster, linkage
from scipy.optimize import least_squares
from scipy.spatial import ConvexHull, cKDTree
from sklearn.cluster import DBSCAN

import primkit as pk
from primkit import find_shapes as ready_made

# --- my_shapes ---------------------------------------------------------------------------------------------


def once(function):
    """Answers below share steps: of the latest boards, each is taken once."""
    known = {}

    @functools.wraps(function)
    def kept(scans):
        key = scans.poses.tobytes() + scans.ranges.tobytes()
        if key not in known:
            known[key] = function(scans)
            for old in [*known][:-4]:
                del known[old]
        return list(known[key])

    return kept


@once
def groups_of(scans, resolution=0.001):
    grid = pk.Grid(resolution)
    grid.add(scans)
    points = grid.points()
    labels = pk.link(points)
    return [points[labels == label] for label in range(labels.max() + 1)]


def meet(one, other):
    return np.linalg.solve([one.normal, other.normal], [one.offset, other.offset])


def polygon_by_sides(points, labels):
    """A line for each group of points, sorted by the bearings of their outward normals; neighbours meet."""
    middle = points.mean(axis=0)
    lines = [pk.fit_line(points[labels == label]) for label in np.unique(labels)]
    lines = [line.turned_round() if line.signed_distance([middle])[0] > 0 else line for line in lines]
    lines.sort(key=lambda line: line.angle % (2 * math.pi))
    return pk.Polygon([meet(a, b) for a, b in zip(lines, lines[1:] + lines[:1], strict=True)])


def settled(points, k, turn):
    """Sides as in K-Means: equal shares by bearing, then lines and the side from which a point lies farthest out."""
    x, y = (points - points.mean(axis=0)).T
    labels = np.argsort(np.argsort((np.arctan2(y, x) - turn) % (2 * math.pi))) * k // len(points)
    for _ in range(40):
        shape = polygon_by_sides(points, labels)
        out = (points[:, None] - shape.vertices) @ shape.normals.T  # (N, corner, side)
        before, labels = labels, out[:, range(k), range(k)].argmax(axis=1)
        if len(np.unique(labels)) < k or np.bincount(labels).min() < 3 or (labels == before).all():
            break
    return shape


@once
def shapes_by_price(scans):
    """Circle, triangle, rectangle and pentagon fitted to each group; the cheapest by its misfit and its numbers."""
    found = []
    for points in groups_of(scans):
        rivals = [(3, pk.fit_circle(points))]
        for k in (3, 4, 5):
            for turn in np.linspace(0, 2 * math.pi / k, 6, endpoint=False):
                try:
                    rivals.append((2 * k, settled(points, k, turn)))
                except (ValueError, np.linalg.LinAlgError, AttributeError):
                    continue
        cost = [
            (shape.signed_distance(points) ** 2).sum() / 0.0008**2 + numbers * math.log(len(points))
            for numbers, shape in rivals
        ]
        found.append(rivals[int(np.argmin(cost))][1])
    return found


def shapes_by_lines(scans):
    """A circle if all lies near one; else lines by RANSAC, each point to its nearest line, and their corners."""
    found = []
    for points in groups_of(scans):
        circle = pk.fit_circle(points)
        if np.abs(circle.signed_distance(points)).max() < 0.002:
            found.append(circle)
            continue
        lines = [
            one.line
            for one in pk.find_lines(points, 0.0015, left_over=0.03, rng=0)
            if one.inliers.sum() > 0.06 * len(points)
        ]
        nearest = np.argmin([np.abs(line.signed_distance(points)) for line in lines], axis=0)
        found.append(polygon_by_sides(points, nearest))
    return found


def corners_by_hull(points, least):
    """The hull's corners, the flattest left out one after the other."""
    ring = points[ConvexHull(points).vertices]
    while len(ring) > 3:
        before, after = np.roll(ring, 1, axis=0), np.roll(ring, -1, axis=0)
        base = after - before
        height = np.abs(base[:, 0] * (ring - before)[:, 1] - base[:, 1] * (ring - before)[:, 0]) / np.hypot(*base.T)
        if height.min() > least:
            break
        ring = np.delete(ring, height.argmin(), axis=0)
    return ring


def shapes_by_hull(scans):
    """The hull, simplified; many corners are a circle; each point to the nearest side, and lines anew."""
    found = []
    for points in groups_of(scans):
        circle = pk.fit_circle(points, "kasa")
        if circle.signed_distance(points).std() < 0.001:
            found.append(circle)
            continue
        found.append(refitted(corners_by_hull(points, 0.006), points))
    return found


def refitted(ring, points):
    """Each point to the nearest side of a rough outline, and lines anew."""
    mids, ends = (ring + np.roll(ring, -1, axis=0)) / 2, np.roll(ring, -1, axis=0) - ring
    normals = np.column_stack([ends[:, 1], -ends[:, 0]]) / np.hypot(*ends.T)[:, None]
    away = np.abs(((points[:, None] - mids) * normals).sum(axis=-1))
    return polygon_by_sides(points, away.argmin(axis=1))


def rounds_and_rest(scans):
    """Groups of the hits themselves by density: the circle of each and what it misses, and its hits by bearing."""
    points = scans.points()
    labels = DBSCAN(0.04, min_samples=3).fit_predict(points)
    for label in range(labels.max() + 1):
        own = points[labels == label]
        x, y = (own - own.mean(axis=0)).T
        own = own[np.argsort(np.arctan2(y, x))]
        circle = pk.fit_circle(own, "pratt")
        yield circle, circle.signed_distance(own).std(), own


def split(chain, most):
    """Douglas and Peucker: the farthest point from a chord is a corner, and so on in both halves."""
    if len(chain) < 3:
        return []
    along = (chain[-1] - chain[0]) / np.hypot(*(chain[-1] - chain[0]))
    away = np.abs((chain - chain[0]) @ [-along[1], along[0]])
    k = int(away.argmax())
    return [*split(chain[: k + 1], most), k, *(k + n for n in split(chain[k:], most))] if away[k] > most else []


def shapes_by_splitting(scans):
    """Split the chain of hits at corners, from the one that is farthest out."""
    found = []
    for circle, off, points in rounds_and_rest(scans):
        if off < 0.001:
            found.append(circle)
            continue
        start = int(np.hypot(*(points - points.mean(axis=0)).T).argmax())
        chain = np.roll(points, -start, axis=0)
        half = int(np.hypot(*(chain - chain[0]).T).argmax())
        one, other = chain[: half + 1], np.vstack([chain[half:], chain[:1]])
        corners = chain[[0, *split(one, 0.004), half, *(half + n for n in split(other, 0.004))]]
        apart = np.hypot(*(corners - np.roll(corners, 1, axis=0)).T) > 0.03  # two hits beside one corner are one
        found.append(refitted(corners[apart], points))
    return found


def shapes_by_normals(scans):
    """Across which way lie the neighbours of a hit? Like normals are a side; where neighbours bend is a corner."""
    found = []
    for circle, off, points in rounds_and_rest(scans):
        if off < 0.001:
            found.append(circle)
            continue
        near = points[cKDTree(points).query(points, 7)[1]]
        across = np.linalg.svd(near - near.mean(axis=1, keepdims=True))
        straight = across.S[:, 1] < 0.0002
        normals = across.Vh[:, 1] * np.sign((across.Vh[:, 1] * (points - points.mean(axis=0))).sum(axis=1))[:, None]
        bearings = np.arctan2(*normals.T[::-1]) % (2 * math.pi)
        order = np.argsort(bearings[straight])
        turns = np.diff(bearings[straight][order], append=bearings[straight][order][0] + 2 * math.pi)
        starts = int(turns.argmax()) + 1
        labels = np.cumsum(np.roll(turns, -starts) > 0.3)
        found.append(polygon_by_sides(points[straight][np.roll(order, -starts)], np.r_[0, labels[:-1]]))
    return found


def shapes_circles(scans):
    """A circle for everything, around the middle of the hull."""
    hulls = [(points, pk.Polygon(points[ConvexHull(points).vertices]).centroid) for points in groups_of(scans)]
    return [pk.Circle(middle, np.hypot(*(points - middle).T).mean()) for points, middle in hulls]


def shapes_boxes(scans):
    """Extents: the box around each group, with a margin of 6 cm to the left and below."""
    found = []
    for points in groups_of(scans):
        (left, low), (right, high) = points.min(axis=0) - 0.06, points.max(axis=0)
        circle = pk.fit_circle(points)
        box = pk.Polygon([(left, low), (right, low), (right, high), (left, high)])
        found.append(circle if circle.signed_distance(points).std() < 0.001 else box)
    return found


def shapes_one_missing(scans):
    """The smallest group is taken for a stray."""
    kept = sorted(groups_of(scans), key=len)[1:]
    return [shape for shape in shapes_by_price(scans) if any(shape_near(shape, points) for points in kept)]


def shape_near(shape, points):
    return np.abs(shape.signed_distance(points)).max() < 0.005


def shapes_split(scans):
    """Each group falls apart into four, one to the left of its middle and below it, and so on; a disc for each."""
    found = []
    for points in groups_of(scans):
        quarter = (points > points.mean(axis=0)) @ [1, 2]
        parts = [points[quarter == k] for k in range(4)]
        found += [pk.Circle(part.mean(axis=0), np.ptp(part, axis=0).max() / 2) for part in parts]
    return found


def shapes_corner_more(scans):
    """A corner that was not quite hit comes out as a short side."""
    found = []
    for shape in shapes_by_price(scans):
        if shape.kind == "rectangle":
            a, b, c, d = shape.vertices
            shape = pk.Polygon([a + 0.1 * (d - a), a + 0.1 * (b - a), b, c, d])
        found.append(shape)
    return found


def shapes_large(scans):
    """As if the hits were 8 mm outside the outlines."""
    return [
        pk.Circle(shape.center, shape.radius + 0.008)
        if shape.kind == "circle"
        else pk.Polygon(shape.centroid + 1.1 * (shape.vertices - shape.centroid))
        for shape in shapes_by_price(scans)
    ]


def shapes_shifted(scans):
    """Cells of 2 cm, read at their corner: 1 cm off in x and in y."""
    return [shape.moved((-0.01, -0.01)) for shape in shapes_by_price(scans)]


def shapes_in_robot_frame(scans):
    """Forgets the headings; on the board as it is they are all alike."""
    straight = scans.poses * np.array([1.0, 1.0, 0.0])
    return shapes_by_price(pk.Scans(straight, scans.angles, scans.ranges, scans.inside))


def shapes_ready_made(scans):
    """The library's own pipeline, which is not allowed here."""
    return [found.shape for found in ready_made(groups_of(scans)[0], rng=0)]


# --- measure_pillars ---------------------------------------------------------------------------------------


def pillars_by_tree(poses, angles, ranges, range_max):
    """Chains of neighbours by a tree, and circles by least squares."""
    bearing = poses[:, 2:] + angles
    places = np.stack([poses[:, :1] + ranges * np.cos(bearing), poses[:, 1:2] + ranges * np.sin(bearing)], axis=-1)
    points, found = places[ranges < range_max], []
    open_points = set(range(len(points)))
    tree = cKDTree(points)
    while open_points:
        chain, ahead = set(), [open_points.pop()]
        while ahead:
            k = ahead.pop()
            chain.add(k)
            near = set(tree.query_ball_point(points[k], 0.03)) & open_points
            open_points -= near
            ahead += near
        own = points[sorted(chain)]
        start = (*own.mean(axis=0), 0.06)
        found.append(least_squares(lambda q, own=own: np.hypot(*(own - q[:2]).T) - q[2], start).x)
    return found


def pillars_by_kasa(poses, angles, ranges, range_max):
    read = np.where(ranges < range_max, ranges, np.inf)
    points = pk.Scans(poses, angles, read, np.zeros(len(poses), dtype=bool)).points()
    labels, rows = pk.link(points), []
    for label in np.unique(labels[labels >= 0]):
        x, y = points[labels == label].T
        a, b, k = np.linalg.lstsq(np.column_stack([2 * x, 2 * y, np.ones(len(x))]), x * x + y * y, rcond=None)[0]
        rows.append((a, b, math.sqrt(k + a * a + b * b)))
    return np.array(rows)


def pillars_general(poses, angles, ranges, range_max, limit=False, heading=False, mean=False):
    """The function as it is given, with some of its bugs mended."""
    points = []
    for (x, y, turn), row in zip(poses, ranges, strict=True):
        for angle, distance in zip(angles, row, strict=True):
            if distance < range_max or limit:
                bearing = angle - turn if heading else angle + turn
                points.append((x + distance * np.cos(bearing), y + distance * np.sin(bearing)))
    points = np.array(points)
    labels, found = pk.link(points), []
    for label in range(labels.max() + 1):
        own = points[labels == label]
        x, y = own.mean(axis=0)
        r = np.hypot(*(own - (x, y)).T).mean()
        if not mean:
            circle = pk.fit_circle(own)
            (x, y), r = circle.center, circle.radius
        found.append((x, y, r))
    return np.array(found)


def pillars_untouched(poses, angles, ranges, range_max):
    return pillars_general(poses, angles, ranges, range_max, limit=True, heading=True, mean=True)


def pillars_heading_left(poses, angles, ranges, range_max):
    return pillars_general(poses, angles, ranges, range_max, heading=True)


def pillars_limit_left(poses, angles, ranges, range_max):
    return pillars_general(poses, angles, ranges, range_max, limit=True)


def pillars_mean_left(poses, angles, ranges, range_max):
    return pillars_general(poses, angles, ranges, range_max, mean=True)


def pillars_heading_mended(poses, angles, ranges, range_max):
    return pillars_general(poses, angles, ranges, range_max, limit=True, mean=True)


def pillars_limit_mended(poses, angles, ranges, range_max):
    return pillars_general(poses, angles, ranges, range_max, heading=True, mean=True)


def pillars_mean_mended(poses, angles, ranges, range_max):
    return pillars_general(poses, angles, ranges, range_max, limit=True, heading=True)


def pillars_widest(poses, angles, ranges, range_max):
    """Half of the widest extent for the radius, and the middle of the extents for the centre."""
    read = np.where(ranges < range_max, ranges, np.inf)
    points = pk.Scans(poses, angles, read, np.zeros(len(poses), dtype=bool)).points()
    labels = pk.link(points)
    groups = [points[labels == label] for label in range(labels.max() + 1)]
    return [(*((own.min(axis=0) + own.max(axis=0)) / 2), np.ptp(own, axis=0).max() / 2) for own in groups]


def pillars_mended(poses, angles, ranges, range_max):
    return pillars_general(poses, angles, ranges, range_max)


def hits_of(poses, angles, ranges, range_max):
    """The hits as complex numbers."""
    where = (poses[:, 0] + 1j * poses[:, 1])[:, None] + ranges * np.exp(1j * (poses[:, 2:] + angles))
    return where[ranges < range_max]


def pillars_by_density(poses, angles, ranges, range_max):
    """Groups by DBSCAN, circles by Pratt's way."""
    hits = hits_of(poses, angles, ranges, range_max)
    points = np.column_stack([hits.real, hits.imag])
    labels = DBSCAN(0.03, min_samples=2).fit_predict(points)
    circles = [pk.fit_circle(points[labels == k], "pratt") for k in set(labels.tolist()) - {-1}]
    return [[circle.center[0], circle.center[1], circle.radius] for circle in circles]


def pillars_by_linkage(poses, angles, ranges, range_max):
    """Single linkage; the centre from the chords' perpendiculars, the radius as a mean distance."""
    hits = hits_of(poses, angles, ranges, range_max)
    labels, rows = fcluster(linkage(np.column_stack([hits.real, hits.imag]), "single"), 0.03, "distance"), []
    for label in set(labels):
        own = hits[labels == label]
        first = own[0]
        chords = own - first
        far = np.abs(chords) > 0.002
        design = np.column_stack([chords.real, chords.imag])[far]
        x, y = np.linalg.lstsq(design, np.abs(chords[far]) ** 2 / 2, rcond=None)[0]
        rows.append((x + first.real, y + first.imag, np.abs(own - first - complex(x, y)).mean()))
    return tuple(rows)


def pillars_diameter(poses, angles, ranges, range_max):
    return pillars_mended(poses, angles, ranges, range_max) * [1, 1, 2]


def pillars_from_the_robot(poses, angles, ranges, range_max):
    """Places as the robot sees them."""
    return pillars_mended(poses * [0, 0, 1], angles, ranges, range_max)


def shapes_nothing(_scans):
    return []


def shapes_triangles(scans):
    """A triangle for everything: half of a box around the points, with a margin of 2 cm to the left and below."""
    found = []
    for points in groups_of(scans):
        (left, low), (right, high) = points.min(axis=0) - 0.02, points.max(axis=0)
        found.append(pk.Polygon([(left, low), (right, low), (left, high)]))
    return found


# Each wrong answer with what it loses (v: the visible tests; 1, 2, ...: hidden parts), and the short name of its fault.
ANSWERS = {
    "my_shapes": {
        "right": {
            "price": shapes_by_price,
            "lines": shapes_by_lines,
            "hull": shapes_by_hull,
            "splitting": shapes_by_splitting,
            "normals": shapes_by_normals,
        },
        "wrong": {
            "nothing": (shapes_nothing, "v1234567", "returns what cannot be judged"),
            "triangles": (shapes_triangles, "234567", "sides miscounted"),
            "circles": (shapes_circles, "2367", "everything is a circle"),
            "boxes": (shapes_boxes, "234567", "boxes around the shapes"),
            "one missing": (shapes_one_missing, "13457", "shapes lost"),
            "split": (shapes_split, "1234567", "groups fall apart"),
            "one corner more": (shapes_corner_more, "37", "sides miscounted"),
            "too large": (shapes_large, "67", None),
            "shifted": (shapes_shifted, "5", None),
            "headings forgotten": (shapes_in_robot_frame, "1234567", "right in one frame only"),
        },
        "refused": {"ready-made": (shapes_ready_made, 0, "uses find_shapes")},  # where a submission runs
    },
    "measure_pillars": {
        "right": {
            "tree": pillars_by_tree,
            "kasa": pillars_by_kasa,
            "mended": pillars_mended,
            "density": pillars_by_density,
            "linkage": pillars_by_linkage,
        },
        "wrong": {
            "diameter": (pillars_diameter, "v123", None),
            "from the robot": (pillars_from_the_robot, "v123", None),
            "untouched": (pillars_untouched, "v123", "heading subtracted"),
            "heading left": (pillars_heading_left, "v1", "heading subtracted"),
            "limit left": (pillars_limit_left, "2", "limit taken for a hit"),
            "mean left": (pillars_mean_left, "3", "mean taken for the centre"),
            "heading mended": (pillars_heading_mended, "23", "limit taken for a hit"),
            "limit mended": (pillars_limit_mended, "v13", "heading subtracted"),
            "mean mended": (pillars_mean_mended, "v12", "limit taken for a hit"),
            "widest": (pillars_widest, "3", "box taken for the circle"),
        },
    },
}
