"""Account: shapes, walls, other things and strays are all the points; a room is walls; strays make no shapes."""

import numpy as np
import pytest

import primkit as pk
from tests.benchmarks.open_world.boards import seen_on
from tests.benchmarks.open_world.judging import accounted, in_order
from tests.test_unknown import CURVED, seen


def clouds():
    rng = np.random.default_rng(0)
    board = pk.random_world(4, style="free", rng=1)
    return {
        "nothing": np.empty((0, 2)),
        "one point": [(0.1, 0.2)],
        "random points": rng.uniform(-0.3, 0.3, (400, 2)),
        "few random points": rng.uniform(-0.5, 0.5, (40, 2)),
        "a board": seen_on(board).points(),
        "a board with strays": seen_on(board, spurious=0.2).points(),
        "a board with noise": seen_on(board, noise_std=0.005).points(),
        "a walled board": seen_on(pk.World(board.shapes, walls=True)).points(),
        "equal points": np.repeat(pk.Circle((0, 0), 0.05).outline(60), 3, axis=0),
        "a cross of lines": np.vstack([(x, y) for t in np.linspace(-0.3, 0.3, 200) for x, y in [(t, 0.01), (0.01, t)]]),
        "an ellipse": pk.Polygon(CURVED["ellipse 2"]).outline(200),
        "far away": np.add(seen_on(board).points(), (512_345.0, 5_412_345.0)),
    }


@pytest.mark.parametrize("settings", [pk.ROBUST, pk.PAPER], ids=["robust", "paper"])
@pytest.mark.parametrize("points", clouds().values(), ids=clouds())
def test_the_sum_of_all_is_the_input(points, settings):
    points = np.asarray(points, dtype=float).reshape(-1, 2)
    told = min(len(points), 4) if settings is pk.PAPER else None
    found = pk.find_shapes(points, told, settings=settings, rng=0)
    np.testing.assert_array_equal(in_order(accounted(found)), in_order(points))


def test_points_at_one_place_share_their_fate():
    found = pk.find_shapes(clouds()["equal points"], rng=0)
    assert [len(one.points) for one in found] == [180]
    assert len(found.strays) == 0


def test_on_a_board_without_noise_nothing_is_left():
    for seed in range(4):
        grid = seen_on(pk.random_world(4, style="free", rng=seed))
        found = pk.find_shapes(grid, rng=0)
        assert len(found) == 4
        assert (found.walls, found.others) == ((), ())
        assert len(found.strays) <= 0.005 * len(grid)


@pytest.mark.parametrize("seed", range(3))
def test_the_walls_around_a_board_are_four_walls(seed):
    world = pk.World(pk.random_world(3, style="free", rng=seed).shapes, walls=True)
    found = pk.find_shapes(seen_on(world, seed), rng=0)
    assert pk.evaluate(found, world).weighted_accuracy == 1.0
    assert len(found.walls) == 4
    for wall in found.walls:
        middle, along = (wall.start + wall.end) / 2, (wall.end - wall.start) / wall.length
        assert np.abs(np.abs(middle).max() - 0.5) < 0.002
        assert np.degrees(np.arcsin(np.abs(along).min())) < 0.2
        assert wall.length == pytest.approx(1.0, abs=0.003)
        assert wall.ends_seen == (True, True)


def test_a_box_that_stands_close_to_a_wall_is_found_beside_it():
    """It is linked to the room, and none of its walls has its points: they were strays."""
    box = pk.Polygon([(0.35, 0.06), (0.495, 0.06), (0.495, 0.14), (0.35, 0.14)])
    poses = [(x, y, 0.0) for x in (-0.3, 0.0, 0.25) for y in (-0.3, 0.0, 0.3)]
    grid = pk.Grid()
    grid.add(pk.scan(pk.World([box], walls=True), poses, pk.Lidar(beams=360, range_max=2.0, noise_std=0.01), rng=0))
    found = pk.find_shapes(grid, rng=0)
    assert len(found.walls) == 4
    (one,) = found
    assert not one.certain
    assert np.hypot(*(one.shape.centroid - box.centroid)) < 0.03


def test_a_room_on_larger_cells_is_walls_and_the_pillars_in_it_are_found():
    """An L-shaped room of 8 m, cells of 1 cm, noise of 1 cm."""
    corners = np.array([(0, 0), (8, 0), (8, 4), (4, 4), (4, 8), (0, 8)])
    rng = np.random.default_rng(0)
    pillars = [
        pk.Circle((2, 2), 0.3),
        pk.Circle((6, 2), 0.25),
        pk.Polygon([(1.5, 5), (2.3, 5), (2.3, 5.6), (1.5, 5.6)]),
    ]
    points = np.vstack([pk.Polygon(corners).outline(3000), *(pillar.outline(220) for pillar in pillars)])
    grid = pk.Grid(0.01)
    grid.add(points + rng.normal(0, 0.01, points.shape))
    found = pk.find_shapes(grid, rng=0)
    assert sorted(one.kind for one in found) == ["circle", "circle", "rectangle"]
    for pillar in pillars:
        assert min(np.hypot(*(one.shape.centroid - pillar.centroid)) for one in found) < 0.02
    assert len(found.walls) == 6
    ends = np.array([end for wall in found.walls for end in (wall.start, wall.end)])
    assert all(np.hypot(*(ends - corner).T).min() < 0.02 for corner in corners)


def test_one_straight_piece_is_a_wall_and_where_it_ends_was_not_seen():
    line = np.column_stack([np.linspace(-0.1, 0.2, 100), np.full(100, 0.05)])
    found = pk.find_shapes(line, rng=0)
    (wall,) = found.walls
    assert found == []
    np.testing.assert_allclose([wall.start, wall.end], [(-0.1, 0.05), (0.2, 0.05)], atol=1e-9)
    assert wall.ends_seen == (False, False)
    assert repr(wall) == "Wall: (-100.0, 50.0) to (200.0, 50.0) mm; 100 points"


@pytest.mark.parametrize("corners", CURVED.values(), ids=CURVED)
def test_what_is_curved_and_no_circle_is_some_other_thing(corners):
    thing, grid = seen(corners, 7)
    found = pk.find_shapes(grid, rng=0)
    assert found == []
    (other,) = found.others
    assert len(other.points) == len(grid)
    assert np.abs(thing.signed_distance(other.outline)).max() < 0.004
    assert repr(found).endswith("1 thing of no kind")


def test_strays_on_a_fifth_of_all_beams_make_no_shapes():
    """Two thirds of the cells are then strays."""
    for seed in range(2):
        world = pk.random_world(3, style="free", rng=seed)
        assert pk.evaluate(pk.find_shapes(seen_on(world, seed, spurious=0.2), rng=0), world).weighted_accuracy >= 0.97
        found = pk.find_shapes(seen_on(pk.World([]), seed, spurious=0.2), rng=0)
        assert (found, found.walls, found.others) == ([], (), ())


def test_few_points_are_a_shape_where_there_are_no_strays():
    """A first look at a shape has some ten points."""
    corner = [(x / 100, 0.0) for x in range(12)] + [(0.0, y / 100) for y in range(1, 8)]
    assert len(pk.find_shapes(corner, rng=0)) == 1


# --- two things that stand close, and thin ones ------------------------------------------------------------------


def square(x):
    return pk.Polygon([(x, -0.05), (x + 0.1, -0.05), (x + 0.1, 0.05), (x, 0.05)])


@pytest.mark.parametrize("gap", [0.005, 0.02])
def test_two_circles_with_a_narrow_gap_are_two(gap):
    world = pk.World([pk.Circle((-0.07 - gap / 2, 0.013), 0.07), pk.Circle((0.05 + gap / 2, 0.013), 0.05)])
    found = pk.find_shapes(seen_on(world), rng=0)
    assert pk.evaluate(found, world).weighted_accuracy == 1.0


@pytest.mark.parametrize("gap", [0.015, 0.02])
def test_what_was_seen_in_the_mouth_between_two_shapes_parts_them(gap):
    world = pk.World([square(-0.1 - gap / 2), square(gap / 2)])
    assert pk.evaluate(pk.find_shapes(seen_on(world), rng=0), world).weighted_accuracy == 1.0


@pytest.mark.parametrize("gap", [0.005, 0.01])
def test_where_hardly_anything_was_seen_in_the_mouth_nothing_is_certain_that_is_wrong(gap):
    for x in (-0.013, 0.021):
        world = pk.World([square(x - 0.1 - gap / 2), square(x + gap / 2)])
        found = pk.find_shapes(seen_on(world), rng=0)
        assert pk.evaluate(found, world).weighted_accuracy == 1.0 or not any(one.certain for one in found)


def test_no_beam_gets_inside():
    """A few points deep inside a rectangle: it may be two things."""
    points = pk.Polygon([(-0.1, -0.05), (0.1, -0.05), (0.1, 0.05), (-0.1, 0.05)]).outline(300)
    (one,) = pk.find_shapes(points, rng=0)
    assert one.certain
    (one,) = pk.find_shapes(np.vstack([points, [(0.0, 0.045)]]), rng=0)
    assert not one.certain


@pytest.mark.parametrize("thick", [0.003, 0.006, 0.01, 0.015])
def test_a_plank_is_a_wall_or_a_rectangle(thick):
    plank = pk.Polygon([(-0.1, 0), (0.1, 0), (0.1, thick), (-0.1, thick)]).moved((0.03, 0.01), 0.4)
    found = pk.find_shapes(seen_on(pk.World([plank])), rng=0)
    (length,) = [wall.length for wall in found.walls] or [one.shape.dimensions[0] for one in found]
    assert length == pytest.approx(0.2, abs=0.005)


@pytest.mark.parametrize("n", [1000, 2000, 20_000])
def test_random_points_all_over_the_board_are_nothing_that_is_certain(n):
    points = np.random.default_rng(0).uniform(-0.5, 0.5, (n, 2))
    found = pk.find_shapes(points, rng=0)
    assert not any(one.certain for one in found)
    np.testing.assert_array_equal(in_order(accounted(found)), in_order(points))


@pytest.mark.parametrize(
    ("width", "height", "walls"), [(0.5, 0.05, 0), (0.8, 0.05, 0), (0.4, 0.3, 0), (0.8, 0.3, 4), (0.6, 0.6, 4)]
)
def test_a_room_is_large_and_has_room_to_stand_in(width, height, walls):
    """A long thin rectangle is a shape: nobody can have seen it from within."""
    box = pk.Polygon([(0, 0), (width, 0), (width, height), (0, height)])
    found = pk.find_shapes(box.moved((-0.3, 0.1), 0.3).outline(1500), rng=0)
    assert (len(found), len(found.walls)) == ((0, walls) if walls else (1, 0))


def test_the_work_is_bounded_and_the_result_says_so(monkeypatch):
    """However many points there are, so many are explained, the same ones each time."""
    from primkit.robust import candidates, regroup

    judged = []
    real = candidates.judged
    monkeypatch.setattr(
        candidates, "judged", lambda points, *a, **k: judged.append(len(points)) or real(points, *a, **k)
    )
    points = np.random.default_rng(0).uniform(-0.2, 0.2, (22_000, 2))
    found, again = (pk.find_shapes(points, rng=0) for _ in range(2))
    assert found.bounded
    assert max(judged) <= candidates.MOST_POINTS
    assert "Not all was tried: there is a bound to the work, and it was reached." in repr(found)
    np.testing.assert_array_equal(in_order(accounted(found)), in_order(points))
    assert [repr(one) for one in found] == [repr(one) for one in again]
    board = seen_on(pk.random_world(4, style="free", rng=1), spurious=0.2)
    assert not pk.find_shapes(board, rng=0).bounded
    monkeypatch.setattr(regroup, "MOST_WORK", 0)
    assert pk.find_shapes(board, rng=0).bounded


def test_two_shapes_linked_as_one_do_not_pass_for_noise():
    """One outline around both would miss the points by some centimetres, and then have them lie on it."""
    world = pk.World(
        [pk.Polygon([(-0.3, -0.1), (-0.1, -0.1), (-0.1, 0.02), (-0.3, 0.02)]), pk.Circle((0.0, 0.0), 0.09)]
    )
    assert world.least_gap() == pytest.approx(0.01)
    found = pk.find_shapes(seen_on(world), rng=0)
    assert pk.evaluate(found, world).weighted_accuracy == 1.0
    assert all(one.rms < 0.001 for one in found)


def test_strays_that_no_shape_goes_through_are_strays():
    rng = np.random.default_rng([777, 20])
    world = pk.random_world(1, style="free", rng=rng)
    grid = seen_on(world, rng, spurious=0.1)  # a group of it has a best shape that none of its points lie on
    assert [one.kind for one in pk.find_shapes(grid, rng=0)] == [shape.kind for shape in world.shapes]
