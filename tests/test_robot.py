"""Automatic movement: the 77 way-points, and which of them lie in a shape."""

from fractions import Fraction

import numpy as np
import pytest
import shapely

from primkit.lidar import scan
from primkit.robot import BODY, inside_shape, skipped_waypoints, teleport_poses, waypoints
from primkit.shapes import Circle, Polygon
from primkit.world import World, random_world
from tests.helpers import exactly

NAN, INF = float("nan"), float("inf")


def paper_waypoints(size):
    """x from -size/2 in steps of 0.15 m to 0.1 m before the right edge; for each, y in steps of 0.1 m: in fractions."""
    size = Fraction(str(size))
    columns = (size - Fraction("0.1")) // Fraction("0.15") + 1
    rows = size // Fraction("0.1") + 1
    xs = [-size / 2 + i * Fraction("0.15") for i in range(max(0, columns))]
    ys = [-size / 2 + j * Fraction("0.1") for j in range(rows)]
    return np.array([(float(x), float(y), 0.0) for x in xs for y in ys]).reshape(-1, 3)


def test_the_papers_77_waypoints():
    poses = waypoints()
    assert poses.shape == (77, 3)
    xs, ys = poses.reshape(7, 11, 3)[:, 0, 0], poses.reshape(7, 11, 3)[0, :, 1]
    np.testing.assert_allclose(xs, [-0.5, -0.35, -0.2, -0.05, 0.1, 0.25, 0.4], atol=1e-15)
    np.testing.assert_allclose(ys, [-0.5, -0.4, -0.3, -0.2, -0.1, 0, 0.1, 0.2, 0.3, 0.4, 0.5], atol=1e-15)
    assert (poses[:, 2] == 0).all()


@pytest.mark.parametrize("size", [f"{cm / 100:g}" for cm in [*range(11, 120), 200, 205, 310, 999]])
def test_waypoints_of_boards_of_any_size(size):
    """The last row and column are neither lost nor doubled by rounding: 0.9 / 0.15 is 6."""
    np.testing.assert_allclose(waypoints(float(size)), paper_waypoints(size), atol=1e-12)


def test_a_board_of_eleven_centimetres_has_one_column_and_one_of_ten_as_many_as_one_of_a_metre():
    np.testing.assert_allclose(waypoints(0.11), [(-0.055, -0.055, 0), (-0.055, 0.045, 0)], atol=1e-15)
    np.testing.assert_allclose(waypoints(0.1), waypoints() * (0.1, 0.1, 1), atol=1e-15)


SIZE_FAILURES = {
    "zero": (0, "size must be a finite number > 0, got 0"),
    "negative": (-1, "size must be a finite number > 0, got -1"),
    "NaN": (NAN, "size must be a finite number > 0, got nan"),
    "infinite": (INF, "size must be a finite number > 0, got inf"),
    "None": (None, "size must be a finite number > 0, got None"),
    "text": ("1", "size must be a finite number > 0, got '1'"),
    "a truth value": (True, "size must be a finite number > 0, got True"),
}


@pytest.mark.parametrize(("size", "sentence"), SIZE_FAILURES.values(), ids=SIZE_FAILURES)
def test_waypoints_failure(size, sentence):
    with pytest.raises(ValueError, match=exactly(sentence)):
        waypoints(size)


SKIPPED = {  # shapes, way-points inside
    "empty board": ([], []),
    "a shape between the way-points": ([Circle((0.025, 0.05), 0.04)], []),
    "circle about one": ([Circle((0.1, 0.0), 0.05)], [(0.1, 0)]),
    "circle about two": ([Circle((0.1, 0.05), 0.06)], [(0.1, 0), (0.1, 0.1)]),
    "circle about a corner of the board": ([Circle((-0.5, -0.5), 0.05)], [(-0.5, -0.5)]),
    "rectangle about four": (
        [Polygon([(-0.21, 0.19), (-0.04, 0.19), (-0.04, 0.31), (-0.21, 0.31)])],
        [(-0.2, 0.2), (-0.2, 0.3), (-0.05, 0.2), (-0.05, 0.3)],
    ),
    "triangle: its bounding box holds two, it holds one": (
        [Polygon([(0.2, -0.32), (0.45, -0.32), (0.2, -0.27)])],
        [(0.25, -0.3)],
    ),
    "a corner on a way-point": ([Polygon([(-0.5, -0.5), (-0.45, -0.5), (-0.45, -0.45)])], [(-0.5, -0.5)]),
    "a side through a way-point": (
        [Polygon([(-0.5, -0.53), (-0.45, -0.53), (-0.45, -0.47), (-0.5, -0.47)])],
        [(-0.5, -0.5)],
    ),
    "an outline through a way-point": ([Circle((-0.5, -0.5625), 0.0625)], [(-0.5, -0.5)]),
    "two shapes": ([Circle((0.4, 0.5), 0.01), Circle((0.25, 0.5), 0.01)], [(0.25, 0.5), (0.4, 0.5)]),
    "shapes that overlap count once": ([Circle((0.1, 0), 0.05), Circle((0.1, 0), 0.04)], [(0.1, 0)]),
}


@pytest.mark.filterwarnings("ignore::primkit.arguments.LikelyWrong")
@pytest.mark.parametrize(("shapes", "inside"), SKIPPED.values(), ids=SKIPPED)
def test_waypoints_inside_shapes_are_skipped(shapes, inside):
    world = World(shapes)
    skipped = skipped_waypoints(world)
    np.testing.assert_allclose(skipped[:, :2], np.reshape(inside, (-1, 2)), atol=1e-12)
    assert len(teleport_poses(world)) == 77 - len(inside)


@pytest.mark.parametrize("style", ["paper", "free"])
def test_teleport_poses_against_shapely(style):
    for seed in range(100):
        world = random_world(4, style=style, rng=seed)
        poses, skipped = teleport_poses(world), skipped_waypoints(world)
        assert sorted(map(tuple, np.vstack([poses, skipped]))) == sorted(map(tuple, waypoints()))
        assert [tuple(p) for p in waypoints() if tuple(p) in set(map(tuple, poses))] == [tuple(p) for p in poses]
        bodies = [s.to_shapely(quad_segs=512) if isinstance(s, Circle) else s.to_shapely() for s in world.shapes]
        places = shapely.points(waypoints()[:, :2])
        covered = np.any([shapely.covers(body, places) for body in bodies], axis=0)
        np.testing.assert_array_equal(waypoints()[covered], skipped)


@pytest.mark.parametrize("size", [0.5, 1.0, 2.0, 3.7])
def test_waypoints_keep_the_body_away_from_walls(size):
    """0.037 m, the body's radius; without walls the robot may stand on the board's edge."""
    walled = World([Circle((0.1, 0.0), 0.05)], size, walls=True)
    poses, skipped = teleport_poses(walled), skipped_waypoints(walled)
    assert np.abs(poses[:, :2]).max() <= size / 2 - 0.037
    beside = size / 2 - np.abs(skipped[:, :2]).max(axis=1)
    assert ((beside < 0.037) | (np.hypot(*(skipped[:, :2] - (0.1, 0)).T) <= 0.05)).all()
    assert sorted(map(tuple, np.vstack([poses, skipped]))) == sorted(map(tuple, waypoints(size)))
    assert not scan(walled, poses).inside.any()
    assert len(skipped_waypoints(World(size=size))) == 0


def test_on_the_papers_board_walls_cost_the_rows_and_the_column_at_the_edge():
    """Of 7 x 11 way-points 6 x 9 are left: x = -0.5 and y = +-0.5 lie on the edge; the last column is 0.1 m inside."""
    assert len(teleport_poses(World(walls=True))) == 6 * 9


def test_the_board_of_the_world_counts():
    assert len(teleport_poses(World(size=2.0))) == len(paper_waypoints("2.0"))


@pytest.mark.filterwarnings("ignore::primkit.arguments.LikelyWrong")
def test_inside_shape_by_hand():
    world = World([Circle((0, 0), 0.5), Polygon([(1, 0), (2, 0), (2, 1), (1, 1)])])
    poses = np.array([(0, 0, 1), (0.5, 0, 2), (0.51, 0, 3), (1.5, 0.5, 4), (1, 1, 5), (1, 0.5, 6), (2.5, 0.5, 7)])
    assert inside_shape(world, poses).tolist() == [True, True, False, True, True, True, False]
    assert inside_shape(world, np.empty((0, 3))).tolist() == []


def test_a_row_of_waypoints_nearer_to_a_wall_than_the_body_is_skipped():
    """On a board of 0.93 m the last row is 3 cm from the wall, nearer than the body's 3.7 cm."""
    free, walled = (teleport_poses(World(size=0.93, walls=walls)) for walls in (False, True))
    assert (0.465 - np.abs(free[:, :2]).max(axis=1) < BODY).any()
    assert (0.465 - np.abs(walled[:, :2]).max(axis=1) >= BODY).all()
    assert len(walled) + len(skipped_waypoints(World(size=0.93, walls=True))) == len(free)
