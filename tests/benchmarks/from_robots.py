"""From robots: what is found in recordings of robots and in worlds of other simulators, which are not in the project.

    python -m tests.benchmarks.from_robots log FILE [N [KIND ...]]    every N-th scan of a log, and all merged
    python -m tests.benchmarks.from_robots still FILE TOPIC [MM]    60 scans at a time of a robot that stands still
    python -m tests.benchmarks.from_robots worlds FILE ...    worlds, scanned with the RPLIDAR A1 and the LDS-01

``log``: cells of 1 cm; the kinds that can be there, all by default. A pillar is a circle of at least two scans or of
the map of all, fitted anew to all hits within 5 cm of it (soft L1); each certain sighting is compared with it. Times
are processor time.

``still``: cells of 1 cm, or so many millimetres, cleaned by ``steady``. A certain shape is there in a scan if half of
its points have a hit within 3 cm, and missing if fewer have one though the beams reach its place.

``worlds``: scanned from a grid of 7 x 7 poses over what stands there and a fifth more, without those at which a
robot would touch something. Cells as ``primkit map --scans`` takes them. A shape is right if it is of the
true kind and no point of either outline lies farther than 1 cm from the other one; what is certain is false if a point
of its outline lies farther than 1 cm from everything that is there.
"""

import argparse
import time
import warnings
from pathlib import Path

import numpy as np
from scipy.optimize import least_squares
from scipy.spatial import KDTree

import primkit as pk
from primkit.arguments import LikelyWrong
from primkit.commands.recording import _cell
from primkit.robot import BODY

CELL = 0.01  # m, of recordings
NEAR_RING, SOFT = 0.05, 0.01  # m: hits of a pillar; from where on they count less
CLOSE = 0.01  # m: a shape that is right
SENSORS = {"RPLIDAR A1": pk.RPLIDAR_A1, "LDS-01": pk.LDS_01}


def found_in(scans, cell=CELL, kinds=None):
    """Return what is found in the map of scans, and the processor time of it."""
    grid = pk.Grid(cell)
    grid.add(scans)
    start = time.process_time()
    found = pk.find_shapes(grid, kinds=kinds, rng=0)
    return found, time.process_time() - start


# --- a log --------------------------------------------------------------------------------------------------


def log(path, every=1, *kinds):
    """Print how well a log's single scans and the map of all of them tell its pillars."""
    every, kinds, scans = int(every), kinds or None, pk.load_scans(path)
    sightings, odd, times = [], [], []
    for k in range(0, len(scans), every):
        found, seconds = found_in(scans[k : k + 1], CELL, kinds)
        times.append(1000 * seconds)
        sightings += [(k, one) for one in found if one.kind == "circle" and one.certain]
        odd += [(k, one) for one in found if one.kind != "circle" and one.certain]
    merged, merged_time = found_in(scans, CELL, kinds)
    cleaned, cleaned_time = found_in(pk.steady(scans, CELL), CELL, kinds)
    print(f"{len(times)} scans: median {np.median(times):.0f} ms, 90 % below {np.quantile(times, 0.9):.0f} ms")
    print(f"certain in single scans: {len(sightings)} circles, {len(odd)} others {[(k, one.kind) for k, one in odd]}")
    for words, found, seconds in (("as it is", merged, merged_time), ("steady", cleaned, cleaned_time)):
        certain = [f"{one.kind} at {np.round(one.shape.centroid, 2).tolist()}" for one in found if one.certain]
        told = f"{len(found.walls)} walls, {len(found.others)} others; certain: {', '.join(certain) or 'nothing'}"
        print(f"all scans, {words}: {seconds:.1f} s; {len(found)} shapes, {told}")
    circles = [one for one in cleaned if one.kind == "circle"]
    for x, y, radius in pillars(scans.points(), [*(one for _, one in sightings), *circles]):
        offs = [one for _, one in sightings if np.hypot(*(one.shape.center - (x, y))) < radius]
        median = np.median([one.shape.radius for one in offs] or [np.nan])
        stds = [(one.shape.radius - radius) / one.dimension_std[0] for one in offs]
        of_all = [one.shape.radius for one in circles if np.hypot(*(one.shape.center - (x, y))) < radius]
        print(
            f"pillar ({x:.3f}, {y:.3f}) r {radius:.4f}: {len(offs)} certain sightings, off by"
            f" {np.round(stds, 1).tolist()} stds, median r {median:.4f};"
            f" in the map of all {np.round(of_all, 4).tolist()}"
        )


def pillars(hits, circles):
    """Return x, y and radius of each pillar among circles, fitted to all hits around it, shape (K, 3)."""
    fitted = []
    for one in circles:
        around = hits[np.abs(np.hypot(*(hits - one.shape.center).T) - one.shape.radius) < NEAR_RING]

        def off(p, places=around):
            return np.hypot(*(places - p[:2]).T) - p[2]

        best = least_squares(off, [*one.shape.center, one.shape.radius], loss="soft_l1", f_scale=SOFT).x
        if all(np.hypot(*(best - other)[:2]) > NEAR_RING for other in fitted):
            fitted.append(best)
    return np.array(fitted).reshape(-1, 3)


# --- standing still -----------------------------------------------------------------------------------------


def still(path, topic, side="10"):
    """Print which certain shapes of 60 scans at a time are missing from half of the scans that see their place."""
    scans, cell = pk.load_scans(path, topic=topic), float(side) / 1000
    for start in range(0, len(scans) - 59, 60):
        part = scans[start : start + 60]
        found, seconds = found_in(pk.steady(part, cell), cell)
        told = []
        for one in (one for one in found if one.certain):
            shares = np.array([_there(one.points, scan) for scan in (part[k : k + 1] for k in range(60))])
            there, missing = (shares >= 0.5).sum(), (shares < 0.5).sum()
            told.append(f"{one.kind} in {there} of {there + missing} scans{'' if there > missing else ': A TRAIL'}")
        print(
            f"scans {start}-{start + 60}: {seconds:.1f} s, {len(found)} shapes, certain: {told or 'none'}", flush=True
        )


def _there(points, scan):
    """Return the share of points that have a hit within 3 cm, of those whose place the beams reach."""
    (x, y, heading), hits = scan.poses[0], scan.points()
    away, bearing = np.hypot(*(points - (x, y)).T), np.arctan2(points[:, 1] - y, points[:, 0] - x) - heading
    nearest = np.abs((bearing[:, None] - scan.angles + np.pi) % (2 * np.pi) - np.pi).argmin(axis=1)
    reached = scan.ranges[0, nearest] > away - 0.03
    if not reached.any() or not len(hits):
        return np.nan
    return (KDTree(hits).query(points[reached])[0] < 0.03).mean()


# --- worlds -------------------------------------------------------------------------------------------------


def worlds(paths):
    """Print for each world and sensor what is right, missing, and certain though it is not there."""
    for path in paths:
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            world = pk.load_world(path)
        print(f"{Path(path).name}: {world}", *[str(one.message) for one in said], sep="; ")
        for name, lidar in SENSORS.items():
            poses = grid_of_poses(world)
            scans = pk.scan(world, poses, lidar, rng=0)
            cell = _cell(scans)
            found, seconds = found_in(scans, cell)
            right = [_is_right(shape, found) for shape in world.shapes]
            ends = [one.shape.outline() for one in found if one.certain] + [
                np.linspace(wall.start, wall.end, 200) for wall in found.walls
            ]
            false = [off for off in (_away(outline, world).max() for outline in ends) if off > CLOSE]
            print(
                f"  {name}: {len(poses)} poses, {scans.hits.sum()} hits, cells of {1000 * cell:g} mm, {seconds:.1f} s;"
                f" right {sum(right)} of {len(right)}; walls {len(found.walls)};"
                f" certain {sum(one.certain for one in found)}; certain or wall, and not there: {len(false)}"
            )
            for shape, good in zip(world.shapes, right, strict=True):
                if not good:
                    print(f"    not right: {shape}")
            print("    " + str(found).replace("\n", "\n    "), flush=True)


def grid_of_poses(world):
    """Return the poses of the grid at which there is room for a robot, shape (P, 3)."""
    corners = np.concatenate([shape.outline() for shape in world.shapes])
    reach = world.size / 2 if world.walled else 1.2 * np.abs(corners).max()
    x, y = np.meshgrid(*[np.linspace(-reach, reach, 9)[1:-1]] * 2)
    places = np.column_stack([x.ravel(), y.ravel()])
    free = np.min([shape.signed_distance(places) for shape in world.shapes], axis=0)
    if world.walled:
        free = np.minimum(free, world.size / 2 - np.abs(places).max(axis=1))
    return np.column_stack([places, np.zeros(len(places))])[free > BODY]


def _away(points, world):
    """Return how far points lie from the nearest outline or wall of a world, shape (N,)."""
    away = [np.abs(shape.signed_distance(points)) for shape in world.shapes]
    away += [np.abs(world.size / 2 - np.abs(points).max(axis=1))] if world.walled else []
    return np.min(away, axis=0)


def _is_right(shape, found):
    """Tell whether a true shape was found: of its kind, and neither outline farther than 1 cm from the other."""
    return any(
        one.kind == shape.kind
        and np.abs(one.shape.signed_distance(shape.outline())).max() < CLOSE
        and np.abs(shape.signed_distance(one.shape.outline())).max() < CLOSE
        for one in found
    )


def main():
    """Run what is asked for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=["log", "still", "worlds"])
    parser.add_argument("paths", nargs="+", metavar="FILE")
    told = parser.parse_args()
    warnings.simplefilter("ignore", LikelyWrong)
    if told.what == "worlds":
        worlds(told.paths)
    elif told.what == "still":
        still(*told.paths)
    else:
        log(*told.paths)


if __name__ == "__main__":
    main()
