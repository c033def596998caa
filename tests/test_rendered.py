"""The rendered LiDAR: texels, faces and limits, against an oracle that asks GEOS about every ray of every camera."""

import numpy as np
import pytest
import shapely

from primkit.lidar import Lidar, scan
from primkit.rendered import render, rendered_bearings
from primkit.robot import inside_shape, waypoints
from primkit.shapes import Circle, Polygon
from primkit.world import World, random_world
from tests.helpers import exactly

INF = float("inf")
BEARINGS = rendered_bearings(100)
WEBOTS = Lidar(model="webots")


def rendered(world, poses, beams, nearest=0.05, farthest=0.3):
    return render(world, poses, rendered_bearings(beams), farthest, nearest)[0]


def box(left, low, right, high):
    return Polygon([(left, low), (right, low), (right, high), (left, high)])


def pictures(world, x, y, heading):
    """Return the depths in the four cameras' pictures from outside, shape (4, 32): the nearest prism or cylinder."""
    rings = [shapely.Polygon(s.outline(36) if isinstance(s, Circle) else s.vertices) for s in world.shapes]
    here, depths = shapely.Point(x, y), np.full((4, 32), INF)
    for camera in range(4):
        for texel in range(32):
            aside = 1 - (texel + 0.5) / 16  # at a depth of 1
            look = heading + camera * np.pi / 2
            way = np.array([np.cos(look) - aside * np.sin(look), np.sin(look) + aside * np.cos(look)])
            ray = shapely.LineString([(x, y), (x + way[0], y + way[1])])
            hits = [ring.intersection(ray) for ring in rings]
            away = [here.distance(hit) for hit in hits if not hit.is_empty]
            depths[camera, texel] = min(away, default=INF) / np.hypot(*way)
    return depths


@pytest.mark.parametrize("seed", range(3))
def test_it_reads_the_texels_that_geos_draws(seed):
    world = random_world(4, rng=seed)
    rng = np.random.default_rng(seed)
    poses = np.column_stack([rng.uniform(-0.5, 0.5, (12, 2)), rng.uniform(-4, 4, 12)])
    poses = poses[~inside_shape(world, poses)]
    angles = 6.28 / 2 - (np.arange(100)[::-1] + 0.5) * 6.28 / 100
    for pose, ranges in zip(poses, rendered(world, poses, 100), strict=True):
        depths = pictures(world, *pose)
        for angle, reading in zip(angles, ranges, strict=True):
            camera = round(angle / (np.pi / 2))
            off = angle - camera * np.pi / 2
            z = depths[camera % 4, min(31, max(0, int(32 * (1 - np.tan(off)) / 2)))]
            r = z / np.cos(off) if 0.05 <= z < 0.3 else INF
            assert reading == pytest.approx(r if 0.05 <= r < 0.3 else INF, abs=1e-9)


WALLS = {
    # a wall straight ahead, seen by the beam 0.0314 rad to the left: its texel's middle lies at 1 / 32 of the depth
    "at its own depth": (box(0.1, -0.2, 0.2, 0.2), 0.1 / np.cos(0.0314)),
    "too near": (box(0.0499, -0.2, 0.2, 0.2), INF),
    "at the least range": (box(0.05, -0.2, 0.2, 0.2), 0.05 / np.cos(0.0314)),
    "the depth is in range, the beam is not": (box(0.29999, -0.2, 0.4, 0.2), INF),
    "at the greatest range": (box(0.3, -0.2, 0.4, 0.2), INF),
    "behind the robot": (box(-0.2, -0.2, -0.1, 0.2), INF),
    "all around the robot: only back faces": (box(-0.2, -0.2, 0.2, 0.2), INF),
}


@pytest.mark.parametrize(("wall", "expected"), WALLS.values(), ids=WALLS)
def test_a_wall(wall, expected):
    assert rendered(World([wall]), np.zeros((1, 3)), 100)[0, 50] == pytest.approx(expected)


def test_what_is_too_near_hides_what_is_behind_it():
    near, far = box(0.03, -0.01, 0.04, 0.01), box(0.1, -0.2, 0.2, 0.2)
    assert rendered(World([near, far]), np.zeros((1, 3)), 100)[0, 50] == INF


def test_from_inside_a_shape_the_others_are_seen():
    inside, other = box(-0.1, -0.1, 0.1, 0.1), box(0.2, -0.2, 0.3, 0.2)
    scans = scan(World([inside, other]), [(0, 0, 0)], WEBOTS)
    assert scans.inside.tolist() == [True]
    assert scans.ranges[0, 50] == pytest.approx(0.2 / np.cos(0.0314))
    assert scan(World([inside, other]), [(0, 0, 0)]).hits.sum() == 0


def test_a_circle_is_a_cylinder_of_36_faces():
    """Straight ahead is one of its edges; five degrees on, its face lies deeper by r (1 - cos 5 degrees)."""
    circle = Circle((1, 0), 0.5)
    turned = [(1 - np.cos(a), -np.sin(a), a) for a in np.radians([0, 5])]
    seen = rendered(World([circle]), np.array(turned), 10_000, farthest=2)[:, 5000]
    assert seen == pytest.approx([0.5, 1 - 0.5 * np.cos(np.radians(5))], abs=1e-4)


def test_nothing_is_nothing():
    assert rendered(World(), np.zeros((2, 3)), 8).tolist() == [[INF] * 8] * 2
    assert rendered(random_world(2, rng=0), np.empty((0, 3)), 100).shape == (0, 100)


def test_the_walls_of_a_board_face_inwards():
    there, beyond = render(World(size=0.4, walls=True), np.array([(0, 0, 0), (0.3, 0, np.pi)]), BEARINGS, 0.3, 0.05)[0]
    assert there[50] == pytest.approx(0.2 / np.cos(0.0314))
    assert beyond[50] == INF


def test_noise_and_dropouts_come_on_top():
    world, poses = random_world(4, rng=1), waypoints()
    clean = scan(world, poses, WEBOTS).ranges
    noisy = scan(world, poses, Lidar(model="webots", noise_std=0.001), rng=0).ranges
    assert (np.isfinite(clean) == np.isfinite(noisy)).all()
    hit = np.isfinite(clean)
    assert 0.0008 < np.std(noisy[hit] - clean[hit]) < 0.0012
    assert not np.isfinite(scan(world, poses, Lidar(model="webots", dropout=1.0), rng=0).ranges).any()


FAILURES = {
    "unknown": ({"model": "real"}, 'model must be "exact" or "webots", got \'real\''),
    "a list": ({"model": []}, 'model must be "exact" or "webots", got []'),
    "seven beams": ({"model": "webots", "beams": 7}, 'model "webots" must have at least 8 beams, got 7'),
}


@pytest.mark.parametrize(("change", "sentence"), FAILURES.values(), ids=FAILURES)
def test_failure(change, sentence):
    with pytest.raises(ValueError, match=exactly(sentence)):
        Lidar(**change)
