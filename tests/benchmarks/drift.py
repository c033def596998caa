"""Drift: how well ``pk.align`` places the scans of drives whose odometry slips, beside an oracle.

    python -m tests.benchmarks.drift [N] [--seed S] [--long] [--no-maps]    N drives of seeds S, S + 1, ...

A drive: three to five shapes on a board of 1 m or 10 m, every second board with walls; the robot goes around all of
them, twice, and scans every 2 cm (20 cm): 180 beams that reach 0.3, 0.6 or 1.0 of the board's side. Slip 1-5 % of the
way, heading 0.5-2 degrees a metre, noise 0-10 mm (0-100 mm on the large board). The oracle is told on which side of
which shape each beam ended, and starts from the truth. Maps are made of at most 20,000 hits each, and compared within
5 mm (50 mm). ``--long``: scans every centimetre, up to 1,000. Nothing was tuned on seeds from 2000 on.
"""

import argparse
import time
import warnings
from dataclasses import dataclass, replace

import numpy as np

import primkit as pk
from primkit.arguments import LikelyWrong
from primkit.driving import pose_graph
from primkit.driving.scripted import tour
from primkit.robot import increments, start_pose
from primkit.shapes import Circle, Polygon
from primkit.study.estimate import share_of

SCAN_STEP = 0.02  # m along the way, on a board of 1 m
LAPS, MOST_SCANS = 2, 1000
IN_95 = 7.815  # chi-square of three
MOST_MAPPED = 20_000  # hits


@dataclass(frozen=True)
class Drive:
    """A drive: its world, what was seen from where the robot was, and the same from where it believes to have been."""

    world: pk.World
    lidar: pk.Lidar
    true: pk.Scans
    told: pk.Scans
    scale: float
    words: str


def drive_of(seed, long=False):
    """Return the drive of a seed."""
    rng = np.random.default_rng([seed, 18])
    scale, walls, style = float(rng.choice([1.0, 10.0])), bool(rng.integers(2)), str(rng.choice(["paper", "free"]))
    small = pk.random_world(int(rng.integers(3, 5 if style == "paper" else 6)), style=style, gap=0.1, rng=rng)
    places = scale * _laps(small, SCAN_STEP / 2 if long else SCAN_STEP, rng)[:MOST_SCANS]
    heading = np.unwrap(np.arctan2(*np.gradient(places, axis=0).T[::-1]))
    poses = np.column_stack([places, heading])
    world = pk.World([_scaled(shape, scale) for shape in small.shapes], scale, walls=walls)
    share, noise, slip, turn = rng.choice([0.3, 0.6, 1.0]), rng.uniform(0, 0.01), *rng.uniform([0.01, 0.5], [0.05, 2])
    lidar = pk.Lidar(beams=180, range_min=0.02 * scale, range_max=share * scale, noise_std=noise * scale)
    true = pk.scan(world, poses, lidar, rng=rng)
    told = replace(true, poses=pk.odometry(poses, slip=slip, turn=turn, rng=rng))
    words = f"{scale:2g} m {'walls' if walls else 'open ':5s} {style} reach {share:.1f} noise {1000 * noise:4.1f}"
    return Drive(world, lidar, true, told, scale, f"{words} slip {slip:.3f} turn {turn:.1f}")


def _laps(world, step, rng):
    """Return places on a way around all shapes, twice, with equal steps, shape (N, 2)."""
    way = start_pose(world)[None, :2]
    for _ in range(LAPS):
        way = np.concatenate([way, tour(world, way[-1], rng)])
    along = np.concatenate([[0], np.cumsum(np.hypot(*np.diff(way, axis=0).T))])
    at = np.arange(0, along[-1], step)
    return np.column_stack([np.interp(at, along, line) for line in way.T])


def _scaled(shape, scale):
    """Return a shape on a board that is so many times as large."""
    if isinstance(shape, Circle):
        return Circle(scale * shape.center, scale * shape.radius)
    return Polygon(scale * shape.vertices)


def oracle(drive):
    """Return the poses of least squares by who knows on what each beam ended, shape (P, 3)."""
    poses, ranges = drive.true.poses / [drive.scale, drive.scale, 1], drive.true.ranges / drive.scale
    bare = pk.scan(drive.world, drive.true.poses, replace(drive.lidar, noise_std=0.0))
    pose, beam = np.nonzero(drive.true.hits & bare.hits)
    bearing = poses[pose, 2] + bare.angles[beam]
    place = poses[pose, :2] + bare.ranges[pose, beam, None] / drive.scale * np.column_stack(
        [np.cos(bearing), np.sin(bearing)]
    )
    sides, circles = [], []
    for shape in drive.world.shapes:
        if isinstance(shape, Circle):
            circles.append((*shape.center / drive.scale, shape.radius / drive.scale))
        else:
            sides += [*np.stack([shape.vertices, np.roll(shape.vertices, -1, axis=0)], axis=1) / drive.scale]
    ends = np.array([*sides, *drive.world.walls / drive.scale]).reshape(-1, 2, 2)
    normal = (ends[:, 1] - ends[:, 0]) / np.hypot(*(ends[:, 1] - ends[:, 0]).T)[:, None] @ [(0, -1), (1, 0)]
    t = np.clip(np.einsum("lnk,lk->ln", place - ends[:, :1], ends[:, 1] - ends[:, 0]), 0, None)
    t = np.minimum(t / ((ends[:, 1] - ends[:, 0]) ** 2).sum(axis=1)[:, None], 1)[..., None]
    far = [np.linalg.norm(place - ends[:, :1] - t * (ends[:, 1:] - ends[:, :1]), axis=2)]
    far += [np.abs(np.hypot(*(place - c[:2]).T) - c[2])[None] for c in circles]
    marks = pose_graph.Landmarks(
        np.column_stack([np.arctan2(*normal.T[::-1]), np.einsum("lk,lk->l", normal, ends[:, 0])]),
        np.array(circles).reshape(-1, 3),
        ends,
        np.zeros(len(ends), dtype=bool),
    )
    hits = pose_graph.Hits(pose, bare.angles[beam], ranges[pose, beam], np.concatenate(far).argmin(axis=0))
    steps = increments(drive.told.poses) / [drive.scale, drive.scale, 1]
    state = pose_graph.State(poses, np.zeros(2), marks, np.array([0.005, 0.03, 0.03, np.radians(1)]) ** 2)
    for _ in range(3):
        state = pose_graph.solve(state, hits, steps)
        state = replace(state, variance=pose_graph.variances(state, hits, steps)[0])
    return state.poses * [drive.scale, drive.scale, 1]


def shapes_right(drive, scans):
    """Return how many of the true shapes are right in kind, place and size in the map that scans make."""
    points = scans.points()
    grid = pk.Grid(0.001 * drive.scale)
    grid.add(points[:: 1 + len(points) // MOST_MAPPED])
    report = pk.evaluate(pk.find_shapes(grid, rng=0), drive.world, tolerance=0.005 * drive.scale)
    return sum(match.all_right for match in report.matches)


def measure(seed, maps=True, long=False):
    """Return the figures of one drive and what it was, both as a row."""
    drive = drive_of(seed, long)
    start = time.process_time()
    aligned = pk.align(drive.told, resolution=0.001 * drive.scale)
    took = time.process_time() - start
    off = aligned.scans.poses - drive.true.poses
    off[:, 2] = (off[:, 2] + np.pi) % (2 * np.pi) - np.pi
    within = np.einsum("pi,pij,pj->p", off[1:], np.linalg.inv(aligned.covariance[1:]), off[1:]) <= IN_95
    best = oracle(drive)
    rms = [
        1000 / drive.scale * np.sqrt(((poses - drive.true.poses)[:, :2] ** 2).sum(axis=1).mean())
        for poses in (drive.told.poses, aligned.scans.poses, best)
    ]
    placed = (drive.true, replace(drive.true, poses=best), aligned.scans) if maps else ()
    maps = [shapes_right(drive, scans) for scans in placed] or [0, 0, 0]
    return [*rms, within.mean(), *maps, took, len(off)], drive.words


def main():
    """Measure drives and print a row for each, then what all of them tell."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("n", nargs="?", type=int, default=20)
    parser.add_argument("--seed", type=int, default=1000)
    parser.add_argument("--long", action="store_true", help="drives of 1,000 scans")
    parser.add_argument("--no-maps", action="store_true", help="poses only: several times faster")
    options = parser.parse_args()
    warnings.simplefilter("ignore", LikelyWrong)
    print("seed  before  after  oracle [mm]  within  shapes: true poses, oracle, aligned    s  scans  drive")
    rows = []
    for seed in range(options.seed, options.seed + options.n):
        row, words = measure(seed, not options.no_maps, options.long)
        rows.append(row)
        before, after, best, within, true, by_oracle, aligned, took, n = row
        print(
            f"{seed:4d} {before:7.1f} {after:6.2f} {best:6.2f} {within:13.2f} {true:19d} {by_oracle:7d} {aligned:7d}"
            f" {took:10.1f} {n:6d}  {words}",
            flush=True,
        )
    before, after, best, within, true, by_oracle, aligned, took, n = np.array(rows).T
    print(f"rms after / before: median {np.median(after / before):.3f}, worst {np.max(after / before):.2f}")
    print(f"rms after / oracle: median {np.median(after / best):.2f}, of sums {after.sum() / best.sum():.2f}")
    close = share_of(float(np.mean(after <= 1.3 * best)), len(rows))
    print(f"drives at most 1.3 times the oracle: {close.text()}")
    apart = 1.96 * within.std() / len(rows) ** 0.5  # poses of one drive err together
    print(f"poses within their 95 % covariance: {within.mean():.3f} +- {apart:.3f}")
    if true.sum():
        shares = aligned.sum() / true.sum(), by_oracle.sum() / true.sum()
        print(f"shapes right: {shares[0]:.3f} of what true poses give; the oracle's poses {shares[1]:.3f}")
    seconds = 1000 * took / n
    print(f"process time for 1,000 scans: median {np.median(seconds):.1f} s, longest {np.max(seconds):.1f} s")


if __name__ == "__main__":
    main()
