"""Exploration: nobody's truth is looked at, nothing is touched or jumped over, and half the scans suffice."""

from itertools import pairwise

import numpy as np
import pytest
from matplotlib.figure import Figure

import primkit as pk
from primkit.driving.explore import Exploration
from primkit.driving.next_views import VIEW_SPACING, next_view, shown_from
from primkit.driving.seen_map import LEAST_PLACE, SQUARE, SeenMap, join_hits, open_outlines
from primkit.driving.ways import LEAST_ROOM, forward, turning, ways_from, wheels_along
from primkit.lidar import Scans
from primkit.plots import plot_tour
from primkit.robot import BODY, FASTEST, PERIOD, advance, clearance, drive, moved

from .helpers import exactly

BOX = [(-0.2, 0), (0.2, 0), (0, -0.2), (0, 0.2)]  # four walls around the middle that nothing can be driven through


def boxed_in():
    sides = [((0.02, 0.2), (x, y)) if x else ((0.17, 0.02), (x, y)) for x, y in BOX]
    corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
    return pk.World([pk.Polygon(corners * half + center) for half, center in sides])


@pytest.fixture(scope="module")
def tours():
    """A dozen random boards, and how the robot explored them."""
    worlds = [pk.random_world(4, rng=seed) for seed in range(12)]
    return [(world, pk.explore(world, rng=seed)) for seed, world in enumerate(worlds)]


# --- What it is worth ---------------------------------------------------------------------------------------


def test_half_the_scans_of_the_waypoints_are_enough(tours):
    explored, waypoints = [], []
    for seed, (world, tour) in enumerate(tours):
        grid = pk.Grid()
        grid.add(pk.scan(world, pk.teleport_poses(world)))
        found = pk.find_shapes(grid.points(), rng=seed)
        explored.append(pk.evaluate(tour.found, world).weighted_accuracy)
        waypoints.append(pk.evaluate(found, world).weighted_accuracy)
    assert np.mean(explored) >= np.mean(waypoints) - 1e-12 > 0.99
    assert np.median([tour.n_scans for _, tour in tours]) <= 25
    assert max(tour.n_scans for _, tour in tours) <= 38


def test_it_ends_when_all_is_seen(tours):
    for world, tour in tours:
        assert tour.why == "all is seen"
        for one in tour.found:
            assert min(one.seen) > 0.9
        assert len(tour.found) == len(world.shapes)


@pytest.mark.parametrize("seed", range(5))
def test_shapes_in_any_rotation_are_found(seed):
    world = pk.random_world(4, style="free", gap=0.12, rng=seed)
    tour = pk.explore(world, rng=seed)
    assert pk.evaluate(tour.found, world).weighted_accuracy == 1.0
    assert tour.n_scans <= 38


def test_it_bears_a_sensor_with_faults():
    lidar = pk.Lidar(noise_std=0.002, dropout=0.05, spurious=0.005)
    scores = []
    for seed in range(5):
        world = pk.random_world(3, rng=seed)
        tour = pk.explore(world, lidar, rng=seed)
        scores.append(pk.evaluate(tour.found, world).weighted_accuracy)
    assert np.mean(scores) >= 0.97


# --- What it must not do ------------------------------------------------------------------------------------


def test_the_robot_drives_and_never_jumps(tours):
    """Its wheels, given to ``drive``, lead along the very same path, to the last bit."""
    for world, tour in tours:
        assert np.abs(tour.wheels).max() <= FASTEST
        assert drive(world, tour.wheels, tour.path[0]).tobytes() == tour.path.tobytes()
        on_path = {pose.tobytes() for pose in tour.path}
        assert all(pose.tobytes() in on_path for pose in tour.poses)


def test_the_body_touches_nothing(tours):
    """Also between two periods, and without the help of a contact: the way is free as planned."""
    for world, tour in tours:
        for share in (0.25, 0.5, 0.75, 1.0):
            between = moved(tour.path[:-1], tour.wheels, PERIOD * share)
            assert clearance(world, between[:, :2]).min() > 0
        np.testing.assert_allclose(between, tour.path[1:], atol=1e-12)


def test_the_time_is_that_of_all_periods_and_all_scans(tours):
    for _, tour in tours:
        assert tour.robot_time == pytest.approx(PERIOD * len(tour.wheels) + 0.1 * tour.n_scans)
        assert len(tour.path) == len(tour.wheels) + 1


def test_scans_are_what_the_sensor_sees_there(tours):
    world, tour = tours[0]
    assert tour.scans.ranges.tobytes() == pk.scan(world, tour.poses).ranges.tobytes()


@pytest.mark.parametrize("seed", range(2))
def test_what_was_not_seen_yet_changes_nothing(seed):
    """On two boards that differ in one shape, the robot does the same until a beam meets that shape."""
    world = pk.random_world(4, rng=seed)
    for left_out in (0, 3):
        less = pk.World([s for i, s in enumerate(world.shapes) if i != left_out])
        a, b = pk.explore(world, start=(0, 0, 0), rng=0), pk.explore(less, start=(0, 0, 0), rng=0)
        n = min(a.n_scans, b.n_scans)
        same = (a.scans.ranges[:n] == b.scans.ranges[:n]).all(axis=1)
        first = n if same.all() else int(np.argmin(same))
        assert first >= 1 or not same[0]
        assert a.poses[: first + 1].tobytes() == b.poses[: first + 1].tobytes()


@pytest.mark.parametrize("lidar", [None, pk.Lidar(noise_std=0.002)], ids=["exact", "noise"])
def test_a_seed_fixes_all(lidar):
    world = pk.random_world(4, rng=3)
    a, b = (pk.explore(world, lidar, rng=5) for _ in range(2))
    assert a.wheels.tobytes() == b.wheels.tobytes()
    assert a.scans.ranges.tobytes() == b.scans.ranges.tobytes()
    assert [one.shape for one in a.found] == [one.shape for one in b.found]


# --- Hard places --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(6))
def test_a_start_at_a_wall(seed):
    """The robot begins so near to a shape that its sensor cannot see it."""
    world, rng = pk.random_world(4, rng=100 + seed), np.random.default_rng(seed)
    outline = world.shapes[seed % 4].outline(360)
    away = outline - world.shapes[seed % 4].centroid
    places = outline + (BODY + 0.002) * away / np.hypot(*away.T)[:, None]
    free = clearance(world, places)
    near = places[(free > 0.0005) & (free < 0.004)]
    start = (*near[rng.integers(len(near))], rng.uniform(0, 7))
    tour = pk.explore(world, start=start, rng=0)
    assert pk.evaluate(tour.found, world).weighted_accuracy == 1.0
    assert drive(world, tour.wheels, start).tobytes() == tour.path.tobytes()


def test_an_empty_board():
    tour = pk.explore(pk.World(), rng=0)
    assert (tour.found, tour.why) == ([], "all is seen")
    assert tour.n_scans < 20


def test_a_large_board():
    tour = pk.explore(pk.World([pk.Circle((0.5, -0.4), 0.08)], size=1.6), rng=0)
    assert (len(tour.found), tour.why) == (1, "all is seen")


def test_walled_in():
    tour = pk.explore(boxed_in(), rng=0)
    assert tour.why == "the rest cannot be seen"
    assert np.abs(tour.path[:, :2]).max() < 0.2
    assert tour.n_scans < 30


def test_a_board_with_walls():
    """Its walls are no shapes, nothing behind them is looked for, and all shapes before them are found."""
    for seed in range(3):
        world = pk.random_world(3, walls=True, rng=seed)
        tour = pk.explore(world, rng=seed)
        assert tour.why != "out of scans"  # a side that stands too near to a wall may not be seen from anywhere
        assert pk.evaluate(tour.found, world).weighted_accuracy == 1.0
        assert len(tour.found.walls) >= 4
        assert np.abs(tour.path[:, :2]).max() <= world.size / 2 - BODY


def test_a_thing_of_no_kind_is_gone_around_like_any_other():
    """An ellipse has no name; once its outline is closed there is nothing in it to be looked for."""
    bearings = np.linspace(0, 2 * np.pi, 60, endpoint=False)
    ellipse = pk.Polygon(np.column_stack([0.2 + 0.12 * np.cos(bearings), 0.15 + 0.06 * np.sin(bearings)]))
    tour = pk.explore(pk.World([ellipse, pk.Circle((-0.2, -0.1), 0.07)]), rng=0)
    (other,) = tour.found.others
    assert [one.kind for one in tour.found] == ["circle"]
    assert tour.why == "all is seen"
    assert len(open_outlines([(ellipse, other.points)])) == 0


def test_one_s_own_steps_are_the_robot_s_eyes():
    """Whoever sees one thing in all there is sees one; a right step of one's own sees what the library sees."""
    world = pk.random_world(2, kinds=["circle", "circle"], rng=3)
    one = pk.explore(world, steps=pk.Steps(segment=lambda points, _: np.zeros(len(points), dtype=int)), rng=0)
    own = pk.explore(world, steps=pk.Steps(segment=lambda points, _: pk.link(points), fit_circle=pk.fit_circle), rng=0)
    assert len(one.found) + len(one.found.others) <= 1
    assert pk.evaluate(own.found, world).weighted_accuracy == 1.0
    with pytest.raises(ValueError, match="steps must be Steps"):
        pk.explore(world, steps=3)


def test_out_of_scans(tours):
    world, whole = tours[0]
    tour = pk.explore(world, rng=0, most_scans=5)
    assert (tour.n_scans, tour.why) == (5, "out of scans")
    assert tour.poses.tobytes() == whole.poses[:5].tobytes()
    assert repr(tour).startswith(f"Exploration: {len(tour.found)} shapes from 5 scans in ")
    assert isinstance(tour, Exploration)


FAILURES = {
    "a list of shapes": (([],), {}, "world must be a World, as in explore(world), got list"),
    "a number for a lidar": ((pk.World(), 100), {}, "lidar must be a Lidar, such as Lidar(), got int"),
    "no scans": ((pk.World(),), {"most_scans": 0}, "most_scans must be a whole number >= 1, got 0"),
    "a start off the board": (
        (pk.World(),),
        {"start": (0.6, 0, 0)},
        "the robot must stand clear of shapes and on the board, got (0.6, 0) m",
    ),
    "a seed that is none": (
        (pk.World(),),
        {"rng": "x"},
        "rng must be a whole number >= 0 or a numpy Generator, got 'x'",
    ),
}


@pytest.mark.parametrize(("args", "more", "sentence"), FAILURES.values(), ids=FAILURES)
def test_explore_failure(args, more, sentence):
    with pytest.raises(ValueError, match=exactly(sentence)):
        pk.explore(*args, **more)


# --- The robot's own map ------------------------------------------------------------------------------------


def seen_from(world, *poses):
    board = SeenMap(world.size)
    board.add(pk.scan(world, list(poses)), 0.05, 0.3)
    return board


@pytest.mark.parametrize("seed", range(10))
def test_what_is_surely_free_holds_nothing(seed):
    """No square that counts as seen has its centre in a shape, but for corners that poke between two beams."""
    world, rng = pk.random_world(4, rng=seed), np.random.default_rng(seed)
    spots = rng.uniform(-0.46, 0.46, (300, 2))
    spots = spots[clearance(world, spots) > 0.05 - BODY + 0.001][:30]
    board = seen_from(world, *np.column_stack([spots, rng.uniform(0, 7, len(spots))]))
    in_shape = board.covered([(shape, None) for shape in world.shapes], -0.004)
    assert (board.seen & in_shape).sum() <= 2
    assert board.seen.sum() > 5000


def test_a_first_look_trusts_no_silence():
    """A wall nearer than the sensor's least distance is silent, and so is the open board."""
    world = pk.World([pk.Circle((0.1, 0), 0.055)])
    board = seen_from(world, (0, 0, 0))
    behind = board.index(np.array([0.2, 0.0]))
    assert not board.seen[behind]
    assert board.seen[board.index(np.array([0.0, 0.0]))]


def test_a_wall_is_no_way():
    world = pk.World([pk.Polygon([(0.1, -0.2), (0.14, -0.2), (0.14, 0.2), (0.1, 0.2)])])
    board = seen_from(world, (0, 0, 0), (0, 0.1, 0), (0, -0.1, 0))
    ways = ways_from(board, np.zeros(2))
    across = board.index(np.array([0.09, 0.0]))
    assert not ways.fits[across]
    assert np.isinf(ways.length[board.index(np.array([0.25, 0.0]))])


def test_stray_hits_are_seen_through_and_forgotten():
    board, nothing, walls = SeenMap(1.0), np.full((1, 100), np.inf), []
    stray = np.where(np.arange(100) == 25, 0.2, nothing)
    for ranges in (stray, nothing, nothing, nothing):
        board.add(Scans(np.zeros((1, 3)), pk.Lidar().angles, ranges, np.array([False])), 0.05, 0.3)
        walls.append(int(board.wall.sum()))
    assert walls[0] == 1
    assert walls[-1] == 0


def test_places_too_small_for_a_shape_are_none():
    board = SeenMap(1.0)
    board.seen[:] = True
    board.seen[10, 10 : 10 + LEAST_PLACE - 1] = False
    board.seen[50, 50 : 50 + LEAST_PLACE] = False
    places = board.hiding_places(np.zeros_like(board.seen))
    assert np.argwhere(places)[:, 0].tolist() == [50] * LEAST_PLACE


def test_open_outlines_are_those_without_points():
    square = pk.Polygon([(0, 0), (0.1, 0), (0.1, 0.1), (0, 0.1)])
    points = np.array([(x, 0.0) for x in np.arange(0, 0.101, 0.005)])
    left = open_outlines([(square, points)])
    assert left[:, 1].min() > 0.011
    assert open_outlines([(square, square.outline(100))]).shape == (0, 2)
    assert open_outlines([]).shape == (0, 2)


def test_hits_of_one_outline_are_joined():
    one = pk.scan(pk.World([pk.Circle((0.25, 0), 0.1)]), [(0, 0, 0)])
    near = np.sort(np.hypot(*np.diff(join_hits(one)[np.argsort(join_hits(one)[:, 1])], axis=0).T))
    assert near.max() <= SQUARE


# --- Ways and views -----------------------------------------------------------------------------------------


def free_board(size=1.0):
    board = SeenMap(size)
    board.free[:] = True
    return board


def test_ways_lead_round_what_is_not_free():
    board = free_board()
    board.free[50:52, 20:80] = False
    ways = ways_from(board, np.array([-0.105, 0.005]))
    goal = (60, 50)
    way = ways.to(goal)
    np.testing.assert_allclose(way[-1], board.centers[goal])
    corners = np.vstack([[-0.105, 0.005], way])
    shares = np.linspace(0, 1, 200)[:, None]
    along = np.vstack([a + shares * (b - a) for a, b in pairwise(corners)])
    walls = board.centers[~board.free]
    assert np.hypot(*(along[:, None] - walls).transpose(2, 0, 1)).min() >= BODY + SQUARE / np.sqrt(2)
    length = np.hypot(*np.diff(corners, axis=0).T).sum()
    assert 2 * np.hypot(0.1, 0.3) < length <= ways.length[goal] + 1e-9
    assert len(way) <= 6


def test_ways_across_the_open_are_straight():
    board = free_board()
    way = ways_from(board, board.centers[20, 20]).to((70, 43))
    np.testing.assert_allclose(way, [board.centers[70, 43]])
    assert ways_from(board, board.centers[20, 20]).to((20, 20)).shape == (0, 2)


def test_who_stands_in_a_narrow_place_can_leave_it():
    board = free_board()
    board.free[46, 50] = False  # 4 cm beside the robot: less than there must be
    ways = ways_from(board, board.centers[50, 50])
    assert ways.room[50, 50] < LEAST_ROOM
    assert np.isfinite(ways.length[70, 50])
    assert not ways.fits[48, 50]


@pytest.mark.parametrize("seed", range(5))
def test_wheels_lead_to_the_end_of_the_way(seed):
    rng = np.random.default_rng(seed)
    pose, way = rng.uniform(-0.4, 0.4, 3), rng.uniform(-0.4, 0.4, (4, 2))
    for speeds in wheels_along(pose, way):
        pose, stopped = advance(pk.World(), pose, speeds)
        assert not stopped
    np.testing.assert_allclose(pose[:2], way[-1], atol=1e-9)
    assert wheels_along(pose, way[:0]).shape == turning(0.0).shape == forward(0.0).shape == (0, 2)


def test_a_view_shows_what_beams_meet():
    board = free_board()
    worth, opaque = np.zeros(board.free.shape), np.zeros(board.free.shape, dtype=bool)
    worth[70:72, 40:60] = 1.0
    opaque[60, 48:53] = True  # a wall before the middle of it
    shown = shown_from((50, 50), worth, opaque, pk.Lidar())
    assert not shown[70:72, 48:53].any()
    assert shown[70:72, 40:44].any()
    assert shown[70:72, 56:60].any()
    assert not shown[worth == 0].any()
    assert not shown_from((20, 50), worth, opaque, pk.Lidar()).any()  # out of reach


def test_the_next_view_is_the_nearest_that_shows_enough():
    board, been = free_board(), np.zeros((100, 100), dtype=bool)
    worth, opaque = np.zeros(board.free.shape), np.zeros(board.free.shape, dtype=bool)
    ways = ways_from(board, board.centers[50, 50])
    assert next_view(worth, opaque, ways, pk.Lidar(), been) is None
    worth[95:100, 50] = 10.0
    view = next_view(worth, opaque, ways, pk.Lidar(), been)
    assert view.gain > 0
    assert 60 < view.square[0] < 95
    been[:] = True
    assert next_view(worth, opaque, ways, pk.Lidar(), been) is None
    been[:] = False
    board.free[view.square[0] + 5, :] = False  # now nearer than the sensor's least distance
    there = next_view(worth, opaque, ways_from(board, board.centers[50, 50]), pk.Lidar(), been)
    assert there.square[0] <= view.square[0] - VIEW_SPACING or there.square[0] > view.square[0] + 5


def test_the_picture_shows_the_way_and_the_scans(tours):
    world, tour = tours[0]
    ax = plot_tour(world, tour, Figure().subplots())
    assert ax.get_title(loc="left").replace("\n", " ") == f"{tour.n_scans} scans in {tour.robot_time:.0f} s: {tour.why}"
    lines = {line.get_label(): line.get_xydata() for line in ax.get_lines()}
    np.testing.assert_array_equal(lines["way"], tour.path[:, :2])
    np.testing.assert_array_equal(lines["scan"], tour.poses[:, :2])
    with pytest.raises(ValueError, match=exactly("tour must be of type Exploration, got int")):
        plot_tour(world, 3)


def test_a_square_is_a_wall_while_no_more_than_twice_as_many_beams_went_through_as_hit_it():
    board = SeenMap(0.05)
    board._hits[0, :3], board._passes[0, :3] = 2, (3, 4, 5)
    assert board.wall[0, :3].tolist() == [True, False, False]
