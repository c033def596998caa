"""Same seed, same bits: every public function that takes ``rng``, in two fresh processes."""

import inspect
import subprocess
import sys

import pytest

import primkit as pk

PROGRAM = """
import hashlib, numpy as np, primkit as pk

def bits(value):
    if isinstance(value, np.ndarray):
        return value.tobytes()
    if isinstance(value, pk.Scans):
        return value.ranges.tobytes() + value.poses.tobytes()
    if isinstance(value, pk.Detection):
        numbers = [value.rms, value.margin, value.count_margin, *value.seen, *value.center_std, *value.dimension_std]
        return bits(value.shape) + value.points.tobytes() + np.float64(numbers).tobytes()
    if isinstance(value, pk.Circle):
        return value.center.tobytes() + np.float64(value.radius).tobytes()
    if isinstance(value, pk.Polygon):
        return value.vertices.tobytes()
    if isinstance(value, pk.World):
        return b"".join(map(bits, value.shapes))
    if isinstance(value, (list, tuple)):
        return b"".join(map(bits, value))
    if hasattr(value, "params"):
        return value.params.tobytes() + value.inliers.tobytes()
    if hasattr(value, "line"):
        return np.float64([value.line.angle, value.line.offset]).tobytes() + value.inliers.tobytes()
    if hasattr(value, "rows"):
        return bits([*value.rows])
    return repr(value).encode()

from primkit.lines import LINE
world = pk.random_world(3, rng=1)
noisy = pk.Lidar(noise_std=0.002, dropout=0.05, spurious=0.02)
scans = pk.scan(world, pk.teleport_poses(world), noisy, rng=2)
grid = pk.Grid()
grid.add(scans)
points = grid.points()
few = pk.Settings(grouping="kmeans", method="published", line_trials=300)
tour, route = pk.explore(world, noisy, rng=10, most_scans=6), pk.scripted_route(world, rng=11)
scene = pk.drive_scene(world, noisy, rng=12).state
for _ in range(20):
    scene.step((6.0, 5.0))
scene.finish()  # what the thread beside the drive has found by now is a matter of time
mapper = pk.Mapper(rng=14)
for half in (scans[:20], scans[20:]):
    mapper.add(half)
film = pk.replay(pk.Drive(scans, np.zeros((len(scans.poses), 2))), rng=13).film
results = {
    "random_world": [world, pk.random_world(5, style="free", rng=3)],
    "scan": scans,
    "scan_blocks": list(pk.scan_blocks(world, scans.poses, noisy, size=30, rng=2)),
    "look": pk.look(world, scans.poses, rng=16).pixels,
    "segment": pk.segment(points, rng=4),
    "kmeans": pk.kmeans(points, 3, rng=4),
    "count_by_silhouette": pk.count_by_silhouette(points, rng=4),
    "run_ransac": pk.run_ransac(points, LINE, 0.005, rng=5),
    "find_lines": pk.find_lines(points, 0.005, rng=6),
    "find_circle": pk.find_circle(points, 0.005, rng=7),
    "draw_samples": pk.draw_samples(40, 3, 20, np.random.default_rng(8)),
    "measure_as_published": pk.measure_as_published(points[pk.link(points) == 0], 4, rng=8),
    "measure_shape": pk.measure_shape(points[pk.link(points) == 0], 0.002, rng=8),
    "explore": [tour.poses, tour.scans, tour.found, tour.wheels],
    "scripted_route": [route.start, route.wheels],
    "drive_scene": [scene.grid.points(), scene.found],
    "replay": [film.cells, *(look.found for look in film.looks)],
    "Mapper": mapper.found,
    "odometry": pk.odometry(scans.poses, rng=15),
    "find_shapes": [pk.find_shapes(points, rng=9), pk.find_shapes(points, 3, settings=few, rng=9)],
}
for name, value in results.items():
    print(name, hashlib.sha256(bits(value)).hexdigest())
"""


@pytest.fixture(scope="module")
def runs():
    """What two fresh processes print; hash randomisation is on, as it is for every user."""
    return [
        subprocess.run([sys.executable, "-c", PROGRAM], capture_output=True, text=True, check=True).stdout
        for _ in range(2)
    ]


def test_two_processes_agree_to_the_last_bit(runs):
    assert runs[0] == runs[1]


def test_every_public_function_with_an_rng_is_among_them(runs):
    random = {name for name in pk.__all__ if callable(f := getattr(pk, name)) and "rng" in _parameters(f)}
    covered = {line.split()[0] for line in runs[0].splitlines()}
    assert random - covered <= {"run_study"}, "run_study has its own test in test_study.py"


def _parameters(function):
    try:
        return inspect.signature(function).parameters
    except ValueError:
        return {}


def test_another_seed_gives_other_bits():
    assert pk.random_world(3, rng=1) != pk.random_world(3, rng=2)
