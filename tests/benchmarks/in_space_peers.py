"""In space, peers: how near spheres and cylinders are found by other tools, on the same clouds, in the same run.

python -m tests.benchmarks.in_space_peers 20    # scenes; open3d, cgal and pyransac3d must be installed

The others are given groups of returns, as open3d makes them: its ground plane is taken away, and the rest is clustered.
Two are told the kind: RANSAC with least squares after it, written here, and pyransac3d. CGAL's efficient RANSAC is not.
``find_solids`` is given the cloud alone.
"""

import re
import sys
import time

import numpy as np
from scipy.optimize import least_squares

from primkit import space
from tests.test_space import seen_scenes

NEAR_SOLID, MOST_TRIALS, STEEPEST_CROSS = 0.015, 500, 0.1  # m; samples; of two normals: what is less is no axis
OFF = {"radius": "mm", "across": "mm", "axis": "degrees"}


def groups_of(o3d, cloud):
    """Groups of points that stand on the ground, each with normals, by open3d."""
    points = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(cloud.points()))
    ground = points.segment_plane(0.02, 3, 1000)[1]
    points = points.select_by_index(ground, invert=True)
    points.estimate_normals(o3d.geometry.KDTreeSearchParamKNN(20))
    label = np.asarray(points.cluster_dbscan(0.15, 8))
    for k in range(label.max() + 1):
        if np.count_nonzero(label == k) >= 40:
            yield np.asarray(points.points)[label == k], np.asarray(points.normals)[label == k]


def told(kind, points, normals, rng):
    """RANSAC told the kind, and least squares that far points count less in: centre, axis, radius."""
    best, most = None, -1
    for _ in range(MOST_TRIALS):
        if kind == "sphere":
            p = points[rng.choice(len(points), 4, replace=False)]
            *c, s = np.linalg.lstsq(np.column_stack([2 * p, np.ones(4)]), (p**2).sum(axis=1))[0]
            x = np.array([*c, np.sqrt(max(s + np.dot(c, c), 0))])
        else:  # two points whose normals meet on the axis
            i, j = rng.choice(len(points), 2, replace=False)
            w = np.cross(normals[i], normals[j])
            if np.linalg.norm(w) < STEEPEST_CROSS:
                continue
            w /= np.linalg.norm(w)
            away = points[j] - points[i]
            a, b = np.linalg.lstsq(np.column_stack([normals[i], -normals[j]]), away - away @ w * w)[0]
            x = np.array([*(points[i] + a * normals[i]), *w, (abs(a) + abs(b)) / 2])
        if x[-1] < 1 and (n := np.count_nonzero(np.abs(off(x, points)) < NEAR_SOLID)) > most:
            best, most = x, n
    near = points[np.abs(off(best, points)) < 2 * NEAR_SOLID]
    x = least_squares(off, best, args=(near,), loss="soft_l1", f_scale=0.01).x
    return x[:3], x[3:-1], x[-1]


def off(x, points):
    """Distances from the surface of a sphere (centre, radius) or a cylinder (place, axis, radius) without ends."""
    away = points - x[:3]
    if len(x) == 7:
        w = x[3:6] / np.linalg.norm(x[3:6])
        away = away - (away @ w)[:, None] * w
    return np.linalg.norm(away, axis=1) - x[-1]


def by_pyransac3d(kind, points, *_):
    import pyransac3d

    found = (pyransac3d.Sphere if kind == "sphere" else pyransac3d.Cylinder)()
    found.fit(points, NEAR_SOLID, 1000)
    return np.ravel(found.center), np.ravel(found.axis) if kind == "cylinder" else np.empty(0), float(found.radius)


def by_cgal(kind, points, normals, *_):
    """CGAL's efficient RANSAC, untold: the shape with most points; None when that is of another kind."""
    from CGAL.CGAL_Kernel import Point_3, Vector_3
    from CGAL.CGAL_Point_set_3 import Point_set_3
    from CGAL.CGAL_Shape_detection import efficient_RANSAC

    cloud = Point_set_3()
    cloud.add_normal_map()
    normal_map, shape = cloud.normal_map(), cloud.add_int_map("shape")
    for p, n in zip(points.tolist(), normals.tolist(), strict=True):
        normal_map.set(cloud.insert(Point_3(*p)), Vector_3(*n))
    how = {"epsilon": NEAR_SOLID, "cluster_epsilon": 0.2, "normal_threshold": 0.8, "probability": 0.01}
    kinds = dict.fromkeys(("planes", "cylinders", "spheres"), True)
    shapes = efficient_RANSAC(cloud, shape, min_points=max(20, len(points) // 20), **kinds, **how)
    each = [str(one).removeprefix("Type: ").split(" ", 1) for one in shapes]
    numbers = {name: [float(n) for n in re.findall(r"-?\d[\d.]*(?:e[-+]?\d+)?", rest)] for name, rest in each[::-1]}
    most = {name: sum(int(re.findall(r"\d+$", rest)[0]) for n, rest in each if n == name) for name in numbers}
    if kind not in most or most[kind] < max(most.values()):
        return None
    x = numbers[kind]
    return np.array(x[:3]), np.array(x[3:-2]), x[-2]


def errors(true, found):
    """Errors of (centre, axis, radius): mm, and degrees of the axis."""
    center, axis, radius = found
    told = {"radius": 1e3 * abs(radius - true.radius)}
    if true.kind == "sphere":
        return told | {"across": 1e3 * np.linalg.norm(center - true.center)}
    away = true.frame[:2] @ (center - true.center + axis * ((true.center - center) @ axis) / (axis @ axis))
    turned = np.arccos(min(1, abs(axis @ true.axis) / np.linalg.norm(axis)))
    return told | {"across": 1e3 * np.linalg.norm(away), "axis": np.degrees(turned)}


def peers(n):
    import open3d as o3d

    tools = {"told, RANSAC and least squares": told, "pyransac3d, told": by_pyransac3d, "CGAL, untold": by_cgal}
    rows, spent, rng = {}, dict.fromkeys(["primkit, untold", *tools], 0.0), np.random.default_rng(0)
    o3d.utility.random.seed(0)
    for scene, cloud in seen_scenes(n, 60_000):
        began = time.process_time()
        found = space.find_solids(cloud, rng=0)
        spent["primkit, untold"] += time.process_time() - began
        for points, normals in groups_of(o3d, cloud):
            far = [np.median(np.abs(solid.distance(points))) for solid in scene.solids]
            true = scene.solids[int(np.argmin(far))]
            if true.kind == "box":
                continue
            ours = min(found, key=lambda f: np.linalg.norm(f.solid.center - true.center))
            got = {"primkit, untold": (ours.solid.center, ours.solid.frame[2], ours.solid.half[0])}
            got["primkit, untold"] = got["primkit, untold"] if ours.kind == true.kind else None
            for name, tool in tools.items():
                began = time.process_time()
                got[name] = tool(true.kind, points, normals, rng)
                spent[name] += time.process_time() - began
            for name, one in got.items():
                rows.setdefault((true.kind, name), []).append(one and errors(true, one))
    for (kind, name), each in sorted(rows.items()):
        right = [one for one in each if one]
        errors_of = {what: np.array([one[what] for one in right]) for what in right[0]}
        told_of = [f"{k} {np.median(e):.2f}, {np.quantile(e, 0.95):.2f} {OFF[k]}" for k, e in errors_of.items()]
        print(f"{kind:8s} {name:31s} kind right {len(right)} of {len(each)}; median, 95 % below:", "; ".join(told_of))
    print("ms a scene:", {name: round(1e3 * seconds / n) for name, seconds in spent.items()})


if __name__ == "__main__":
    peers(int(sys.argv[1]))
