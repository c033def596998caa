"""Touching: number and kinds of two shapes that touch, by the LiDAR alone, the camera alone, and both.

    python -m tests.benchmarks.touching [boards] [first seed]

Boards: two of the paper's kinds at any turn, in contact over 2 cm or more; hues 60 degrees apart or more; light +-30 %,
3 % pixel noise, ranges that err by up to 2 mm; from the paper's way-points, the camera towards what the LiDAR saw.

LiDAR alone: ``take_apart`` of the cells. Both: the same, with the colour of each cell. Camera alone: each colour is a
shape; against the floor its left and right end are tangents, and the shape is the polygon between them all.
"""

import colorsys
import sys
import warnings
from collections import Counter

import numpy as np
import shapely

import primkit as pk
from primkit.measure import measure_shape

WAYPOINTS = [(x, y) for x in -0.5 + 0.15 * np.arange(7) for y in -0.5 + 0.1 * np.arange(11)]
FIFTHS = np.arange(5) * 0.4 * np.pi
CONTACT = 0.02  # m


def random_shape(rng):
    """Return a circle, rectangle, isosceles triangle or regular pentagon about the origin, turned."""
    kind = rng.integers(4)
    if kind == 0:
        return pk.Circle((0, 0), rng.uniform(0.04, 0.09))
    if kind == 1:
        corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * rng.uniform(0.06, 0.22, 2) / 2
    elif kind == 2:
        base = rng.uniform(0.1, 0.24)
        corners = np.array([(-base / 2, 0), (base / 2, 0), (0, 0.1)])
    else:
        corners = rng.uniform(0.05, 0.1) * np.column_stack([np.cos(FIFTHS), np.sin(FIFTHS)])
    return pk.Polygon(corners).moved(angle=rng.uniform(0, 2 * np.pi))


def touching(rng):
    """Return two shapes that touch: side on side, or a circle a little inside of the other, in contact over 2 cm."""
    while True:
        a, b = random_shape(rng), random_shape(rng)
        if a.kind == b.kind == "circle":
            half = rng.uniform(0.5, 0.8) * CONTACT + 0.002
            apart = sum(np.sqrt(shape.radius**2 - half**2) for shape in (a, b))
            way = rng.uniform(0, 2 * np.pi)
            b = b.moved(apart * np.array([np.cos(way), np.sin(way)]))
        else:
            a, b = (b, a) if a.kind == "circle" else (a, b)
            side = rng.integers(len(a.vertices))
            start, along, normal = a.vertices[side], a.edges[side], a.normals[side]
            place = start + rng.uniform(0.2, 0.8) * along
            if b.kind == "circle":
                half = rng.uniform(0.5, 0.8) * CONTACT + 0.002
                b = b.moved(place + np.sqrt(b.radius**2 - half**2) * normal)
            else:
                other = rng.integers(len(b.vertices))
                b = b.moved(angle=np.arctan2(*(-normal)[::-1]) - np.arctan2(*b.normals[other][::-1]))
                b = b.moved(place - (b.vertices[other] + b.edges[other] / 2) + 1e-6 * normal)
        solid = [shape.to_shapely() for shape in (a, b)]
        both = shapely.union_all([s.buffer(1e-5) for s in solid])
        contact = solid[0].boundary.intersection(solid[1].buffer(2e-5)).length
        x0, y0, x1, y1 = both.bounds
        room = 0.38 - np.array([x1 - x0, y1 - y0]) / 2
        if contact >= CONTACT and both.geom_type == "Polygon" and not both.interiors and (room > 0).all():
            shift = rng.uniform(-room, room) - np.array([x0 + x1, y0 + y1]) / 2
            return [a.moved(shift), b.moved(shift)]


def seen(shapes, rng):
    """Return the cells that the LiDAR hits, the number of each one's colour, and the camera's views."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", pk.arguments.LikelyWrong)
        world = pk.World(shapes)
    places = np.array([p for p in WAYPOINTS if min(s.signed_distance([p])[0] for s in shapes) > 0.001])
    lidar = pk.Lidar(noise_std=rng.uniform(0, 0.002))
    middle = pk.scan(world, np.column_stack([places, np.zeros(len(places))])).points().mean(axis=0)
    poses = np.column_stack([places, np.arctan2(*(middle - places).T[::-1])])
    scans = pk.scan(world, poses, lidar, rng=rng)
    hue = rng.uniform()
    colors = [colorsys.hsv_to_rgb(h % 1, 0.9, 0.75) for h in (hue, hue + rng.uniform(1 / 6, 5 / 6))]
    views = pk.look(world, poses, pk.Camera(light=0.3, noise_std=0.03), colors=colors, rng=rng)
    cells, cell = np.unique(scans.points().round(3), axis=0, return_inverse=True)
    votes = np.zeros((len(cells), 3))
    np.add.at(votes, (cell.ravel(), pk.colors_of(scans, views)), 1)  # the last column counts the unknown
    colors = np.where(votes[:, :2].sum(axis=1) > 0, votes[:, :2].argmax(axis=1), -1)
    return cells, colors, views


def by_camera(views):
    """Return the shapes between the tangents of each colour, None where there is none."""
    numbers, hues = views.colors()
    edges, floor = views.camera.edges, np.isnan(views.hues)
    found = []
    for color in range(len(hues)):
        region = shapely.box(-0.6, -0.6, 0.6, 0.6)
        for pose, row, bare in zip(views.poses, numbers, floor, strict=True):
            mine = np.flatnonzero(row == color)
            if len(mine) == 0:
                continue
            for end, step, sign in ((mine[0], -1, 1), (mine[-1], 1, -1)):
                beyond = end + 2 * step
                if 0 <= beyond < len(row) and bare[beyond]:
                    at = pose[2] + edges[end + (step > 0)] + sign * 0.009  # half the mixed pixel beside
                    way, across = np.array([np.cos(at), np.sin(at)]), np.array([-np.sin(at), np.cos(at)])
                    ray = [pose[:2] - 2 * way, pose[:2] + 2 * way]
                    side = [ray[1] - 3 * sign * across, ray[0] - 3 * sign * across]
                    region = region.intersection(shapely.Polygon([*ray, *side]))
        if region.is_empty or region.geom_type != "Polygon":
            found.append(None)
            continue
        ring = region.exterior
        points = np.array([ring.interpolate(t).coords[0] for t in np.arange(0, ring.length, 0.003)])
        shape = measure_shape(points, 0.002) if len(points) > 20 else None
        found.append(shape and shape.kind)
    return found


def main(boards=200, first_seed=21_000):
    """Print how often number and kinds are right."""
    right, numbers = Counter(), Counter()
    for seed in range(first_seed, first_seed + boards):
        rng = np.random.default_rng(seed)
        shapes = touching(rng)
        cells, colors, views = seen(shapes, rng)
        kinds = sorted(shape.kind for shape in shapes)
        answers = {"camera": by_camera(views)}
        for name, known in (("LiDAR", None), ("both", colors)):
            apart = pk.take_apart(cells, colors=known)
            answers[name] = [] if apart is None else [part.kind for part in apart.parts]
        for name, answer in answers.items():
            numbers[name] += len(answer) == 2
            right[name] += sorted(map(str, answer)) == kinds
        print(
            seed, *kinds, *(f"{name}: {', '.join(map(str, answer))};" for name, answer in answers.items()), flush=True
        )
    for name in ("LiDAR", "camera", "both"):
        print(f"{name:7} number {numbers[name] / boards:.3f}, number and kinds {right[name] / boards:.3f} of {boards}")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
