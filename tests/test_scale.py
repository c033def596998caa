"""Scale: every length of the method follows the cell: a larger board is the same board, and so is one far away."""

import numpy as np
import pytest

import primkit as pk
from primkit.arguments import LikelyWrong
from primkit.driving.wander import wander
from primkit.measure import measure_shape
from primkit.plots import plot_drive
from primkit.scene import DriveState, replay
from primkit.scene.keys import wheels_for
from primkit.scene.page import describe
from primkit.segmentation import count_by_silhouette
from tests.benchmarks.open_world.account import UTM
from tests.benchmarks.open_world.ordinary import SAME, apart_by, board
from tests.helpers import exactly


def numbers(one):
    corners = one.shape.center if one.kind == "circle" else one.shape.vertices
    return [*np.ravel(corners), *one.shape.dimensions, one.rms, *one.center_std, *one.dimension_std]


@pytest.mark.parametrize(("settings", "k"), [(pk.PAPER, 10), *((pk.ROBUST, k) for k in (0.01, 0.1, 0.3, 3, 10, 100))])
def test_the_same_points_enlarged_are_the_same_shapes(settings, k):
    for seed in range(1 if settings is pk.PAPER else 3):
        _, grid = board(seed, 0.002 * (seed % 2))
        told = 4 if settings is pk.PAPER else None
        here = pk.find_shapes(grid.points(), told, settings=settings, rng=0)
        there = pk.find_shapes(grid.points() * k, told, settings=settings, resolution=0.001 * k, rng=0)
        assert len(here) >= 3
        assert apart_by(there, here, k) <= SAME
        for new, old in zip(there, here, strict=True):
            np.testing.assert_allclose(numbers(new), np.array(numbers(old)) * k, rtol=1e-7, atol=1e-9 * k)
            assert len(new.points) == len(old.points)
            assert new.margin == pytest.approx(old.margin, rel=1e-6, nan_ok=True)


@pytest.mark.parametrize("k", [0.1, 10])
def test_noise_that_is_told_is_enlarged_too(k):
    _, grid = board(1, 0.002)
    here = pk.find_shapes(grid.points(), settings=pk.Settings(noise_std=0.002), rng=0)
    how = pk.Settings(noise_std=0.002 * k)
    there = pk.find_shapes(grid.points() * k, settings=how, resolution=0.001 * k, rng=0)
    assert len(here) >= 3
    for new, old in zip(there, here, strict=True):
        np.testing.assert_allclose(numbers(new), np.array(numbers(old)) * k, rtol=1e-7, atol=1e-9 * k)


@pytest.mark.parametrize("k", [0.01, 3, 8, 100])
def test_a_grid_knows_its_own_cells(k):
    for seed in range(3):
        large, grid = board(seed, 0.0, k)
        assert pk.evaluate(pk.find_shapes(grid, rng=0), large, 0.005 * k, gate=0.1 * k).weighted_accuracy == 1.0


def test_a_board_far_away_is_the_same_board():
    """In UTM coordinates, half a million metres east and five million north, digits are not lost."""
    for seed in range(3):
        _, grid = board(seed, 0.001 * (seed % 2))
        here, there = pk.find_shapes(grid, rng=0), pk.find_shapes(grid.points() + UTM, rng=0)
        assert [one.kind for one in there] == [one.kind for one in here]
        for new, old in zip(there, here, strict=True):
            np.testing.assert_allclose(new.shape.outline(7), old.shape.moved(UTM).outline(7), rtol=0, atol=2e-6)


def test_the_silhouette_counts_far_away_as_here():
    """Squared distances are differences of squares in scikit-learn: far away, 4 groups for 3."""
    rng = np.random.default_rng(9)
    points = np.vstack([rng.uniform(-0.4, 0.4, 2) + rng.normal(0, 0.03, (12, 2)) for _ in range(4)])
    assert [count_by_silhouette(points + far, 6, rng=0) for far in (0.0, UTM)] == [3, 3]


def test_own_fits_are_given_metres_and_return_metres():
    square = pk.Polygon([(9, 9), (11, 9), (11, 11), (9, 11)])
    points = np.vstack([square.outline(800), pk.Circle((12, 10), 0.5).outline(300)])
    given = []

    def line(points):
        given.append(points)
        return pk.fit_line(points)

    def circle(points):
        given.append(points)
        return pk.fit_circle(points)

    steps = pk.Steps(fit_line=line, fit_circle=circle)
    found = pk.find_shapes(points, resolution=0.01, steps=steps, rng=0)
    assert [d.kind for d in found] == ["rectangle", "circle"]
    np.testing.assert_allclose(found[0].shape.centroid, (10, 10), atol=1e-3)
    assert found[1].shape.radius == pytest.approx(0.5, abs=1e-6)
    assert min(p.min() for p in given) > 8.9


def test_one_shape_is_measured_on_any_cells():
    ring = pk.Circle((100, 200), 30).outline(400)
    found = measure_shape(ring, 0.0, resolution=0.5, rng=0)
    assert found.shape.radius == pytest.approx(30, abs=1e-6)
    assert max(found.center_std) < 0.1


@pytest.mark.parametrize("bad", [0, -1, float("nan")])
def test_a_resolution_is_above_zero(bad):
    with pytest.raises(ValueError, match="resolution must be a finite number > 0"):
        pk.find_shapes([(0, 0)], resolution=bad)


def test_a_grid_is_not_told_its_cells():
    message = "resolution must not be given with a grid, which knows its own, got 0.001"
    with pytest.raises(ValueError, match=exactly(message)):
        pk.find_shapes(pk.Grid(), resolution=0.001)


# --- the whole board, with nothing more to set ------------------------------------------------------------------

POWERS = (0.1, 100.0)


@pytest.mark.parametrize(("style", "walls"), [("paper", False), ("free", True), ("any", False)])
@pytest.mark.parametrize("k", POWERS)
def test_a_board_k_times_as_large_is_drawn_scanned_found_and_scored_alike(k, style, walls):
    here, there = (pk.random_world(3, style=style, walls=walls, size=size, rng=5) for size in (1.0, k))
    assert there == here.scaled(k)
    poses, places = pk.teleport_poses(here), pk.teleport_poses(there)
    np.testing.assert_allclose(places, poses * (k, k, 1), rtol=1e-12)
    found, reports = [], []
    for world in (here, there):
        grid = pk.Grid(world.cell)
        grid.add(pk.scan(world, pk.teleport_poses(world), rng=0))
        found.append(pk.find_shapes(grid, rng=0))
        reports.append(pk.evaluate(found[-1], world))
    assert [one.kind for one in found[1]] == [one.kind for one in found[0]]
    assert len(found[1].walls) == len(found[0].walls) == 4 * walls
    assert reports[1].weighted_accuracy == reports[0].weighted_accuracy == 1.0
    assert reports[1].tolerance == pytest.approx(0.005 * k)


@pytest.mark.parametrize("k", POWERS)
def test_a_board_k_times_as_large_is_explored_alike(k):
    """To the metre the ways are not the same: where a beam ends on the border of two squares, rounding decides."""
    here, there = (pk.random_world(3, size=size, rng=7) for size in (1.0, k))
    tour, large = (pk.explore(world, rng=0) for world in (here, there))
    assert large.why == tour.why == "all is seen"
    assert abs(large.n_scans - tour.n_scans) <= 2
    assert large.robot_time == pytest.approx(tour.robot_time, rel=0.2)
    assert pk.evaluate(large.found, there).weighted_accuracy == pk.evaluate(tour.found, here).weighted_accuracy == 1.0


@pytest.mark.parametrize("k", POWERS)
@pytest.mark.parametrize("moving", [False, True])
def test_a_board_k_times_as_large_is_driven_alike(k, moving):
    worlds = [pk.World([pk.Circle((0.2, 0.0), 0.05)]).scaled(size) for size in (1.0, k)]
    states = [DriveState(world, moving=moving) for world in worlds]
    for state in states:
        for keys in [["forward"]] * 5 + [["left"]] * 8 + [["forward", "left"]] * 6:
            state.step(wheels_for(keys))
        assert not moving or state.move_something()
    here, there = states
    np.testing.assert_allclose(there.pose, here.pose * (k, k, 1), rtol=1e-9, atol=1e-12 * k)
    assert abs(len(there.grid) - len(here.grid)) <= 3  # rounding at cells' edges
    assert np.mean(there.unseen() == here.unseen()) > 0.999
    np.testing.assert_allclose(there.world.shapes[0].center, k * here.world.shapes[0].center, rtol=1e-9)
    assert describe(there.found)["shapes"][0]["kind"] == describe(here.found)["shapes"][0]["kind"]
    ways = [np.array(describe(state.found)["shapes"][0]["place"]) for state in states]
    assert np.abs(ways[0] - ways[1]).max() <= 20  # tenths of a millimetre on the paper's scale


@pytest.mark.parametrize("k", POWERS)
def test_a_drive_on_a_board_k_times_as_large_is_shown_alike(k):
    here, there = pk.World([pk.Circle((0.2, 0.0), 0.05)]), pk.World([pk.Circle((0.2, 0.0), 0.05)]).scaled(k)
    told = []
    for world in (here, there):
        route = pk.scripted_route(world, rng=0)
        poses = route.poses(world)[:40]
        lidar = pk.Lidar().scaled(world.scale)
        drive = pk.Drive(pk.scan(world, poses, lidar), np.vstack([(0.0, 0.0), route.wheels[:39]]), lidar)
        shown, blind = replay(drive, world), replay(drive)
        told.append((poses, shown.told(), blind.told(), plot_drive(world, drive, 2)))
        shown.close()
        blind.close()
    (poses, film, blind, strip), (places, large, unknown, wide) = told
    np.testing.assert_allclose(places, poses * (k, k, 1), rtol=1e-6, atol=1e-9 * k)
    assert large["board"]["unit"] == unknown["board"]["unit"] == pytest.approx(k * film["board"]["unit"])
    assert large["board"]["body"] == pytest.approx(k * film["board"]["body"])
    assert unknown["board"]["size"] == pytest.approx(k * blind["board"]["size"])
    assert [look["scan"] for look in large["looks"]] == [look["scan"] for look in film["looks"]]
    assert large["truths"] == film["truths"]
    assert [ax.get_title(loc="left") for ax in wide.axes] == [ax.get_title(loc="left") for ax in strip.axes]
    np.testing.assert_allclose(wander(there, 30, rng=1), wander(here, 30, rng=1) * (k, k, 1), rtol=1e-9)


def test_a_study_of_boards_of_ten_metres_needs_nothing_more():
    rows = pk.run_study([pk.random_world(2, size=10, rng=1)], {"ROBUST": pk.ROBUST}, jobs=1)
    assert (rows[0].fair.weighted, rows[0].tolerance) == (1.0, pytest.approx(0.05))


def test_a_board_of_a_kilometre_is_doubted():
    with pytest.warns(LikelyWrong, match="a board is 1000 m wide: is it in millimetres?"):
        pk.World(size=1000)
