"""The grid: which cell a point falls into, and where a cell's centre lies."""

import pickle
from copy import copy

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from primkit.grid import HALF, Grid
from primkit.lidar import Scans, scan
from primkit.robot import teleport_poses
from primkit.world import random_world
from tests.helpers import exactly

NAN, INF = float("nan"), float("inf")

RESOLUTIONS = [0.0001, 0.0005, 0.001, 0.002, 0.0025, 0.003, 0.005, 0.007, 0.01, 0.05, 0.1, 1.0, 1 / 3, 2.5]
resolutions = st.sampled_from(RESOLUTIONS)
metres = st.floats(-5, 5)
clouds = st.lists(st.tuples(metres, metres), max_size=40).map(lambda rows: np.array(rows).reshape(-1, 2))


def filled(points, resolution=0.001):
    grid = Grid(resolution)
    grid.add(points)
    return grid


# --- One point ----------------------------------------------------------------------------------------------

CELLS = {  # point [m], resolution [m], cell
    "(0.1, 0.1) m is cell (100, 100)": ((0.1, 0.1), 0.001, (100, 100)),
    "the origin opens cell (0, 0)": ((0.0, 0.0), 0.001, (0, 0)),
    "minus zero is zero": ((-0.0, -0.0), 0.001, (0, 0)),
    "rounding below zero is zero": ((-1e-17, 0.0), 0.001, (0, 0)),
    "inside a cell": ((0.1004, 0.1006), 0.001, (100, 100)),
    "half-open: the upper border is the next cell's": ((0.101, 0.1), 0.001, (101, 100)),
    "just below the upper border": ((0.1009999, 0.1009999), 0.001, (100, 100)),
    "0.043 / 0.001 is 42.99999999999999": ((0.043, 0.57), 0.001, (43, 570)),
    "0.3 / 0.1 is 2.9999999999999996": ((0.3, 0.7), 0.1, (3, 7)),
    "negative: down, not towards zero": ((-0.0001, -0.0011), 0.001, (-1, -2)),
    "negative on a border": ((-0.1, -0.29), 0.001, (-100, -290)),
    "negative just below a border": ((-0.1000001, -0.0009999), 0.001, (-101, -1)),
    "first is x, second is y": ((0.002, 0.007), 0.001, (2, 7)),
    "another resolution": ((0.1, 0.024), 0.005, (20, 4)),
    "cells of a metre": ((1.0, -1.5), 1.0, (1, -2)),
}


@pytest.mark.parametrize(("point", "resolution", "cell"), CELLS.values(), ids=CELLS)
def test_to_cells(point, resolution, cell):
    cells = Grid(resolution).to_cells([point])
    assert cells.tolist() == [list(cell)]
    assert cells.dtype == np.int64
    assert filled([point], resolution).cells.tolist() == [list(cell)]


CENTRES = {  # cell, resolution [m], centre [m]
    "a cell stands for its centre, not its corner": ((100, 100), 0.001, (0.1005, 0.1005)),
    "the cell at the origin": ((0, 0), 0.001, (0.0005, 0.0005)),
    "the cell below the origin": ((-1, -1), 0.001, (-0.0005, -0.0005)),
    "first is x, second is y": ((2, -7), 0.001, (0.0025, -0.0065)),
    "another resolution": ((3, -3), 0.02, (0.07, -0.05)),
}


@pytest.mark.parametrize(("cell", "resolution", "centre"), CENTRES.values(), ids=CENTRES)
def test_to_points(cell, resolution, centre):
    points = Grid(resolution).to_points([cell])
    np.testing.assert_allclose(points, [centre], rtol=1e-14)
    assert points.dtype == np.float64


@pytest.mark.parametrize("resolution", ["0.001", "0.0005", "0.002", "0.005", "0.01", "0.1"])
def test_every_border_written_in_decimals_opens_its_cell(resolution):
    """Whether the number is written (0.043), multiplied (43 * 0.001) or divided (43 / 1000)."""
    step = float(resolution)
    places = len(resolution.split(".")[1])
    k = np.arange(-3000, 3001)
    written = np.array([float(f"{i * step:.{places}f}") for i in k])
    for x in (written, k * step, k / (1 / step)):
        cells = Grid(step).to_cells(np.column_stack([x, x]))
        np.testing.assert_array_equal(cells, np.column_stack([k, k]))


def test_a_hair_below_a_border_is_the_cell_before():
    k = np.arange(-1000, 1001)
    for hair in (1e-6, 1e-8):  # in cells; only within 1e-9 of a cell is it rounding
        x = (k - hair) * 0.001
        np.testing.assert_array_equal(Grid().to_cells(np.column_stack([x, x])), np.column_stack([k - 1, k - 1]))


# --- Many points --------------------------------------------------------------------------------------------


@given(resolutions, st.lists(st.tuples(*[st.integers(-(10**6), 10**6)] * 2), min_size=1, max_size=50))
def test_round_trip_from_cells(resolution, cells):
    grid = Grid(resolution)
    assert grid.to_cells(grid.to_points(cells)).tolist() == [list(c) for c in cells]
    again = filled(grid.to_points(cells), resolution)
    assert again.cells.tolist() == sorted({c: list(c) for c in cells}.values())


@given(resolutions, clouds)
def test_a_point_lies_within_half_a_cell_of_its_centre(resolution, points):
    grid = Grid(resolution)
    centres = grid.to_points(grid.to_cells(points))
    assert centres.shape == points.shape
    assert (np.abs(centres - points) <= resolution * (0.5 + 1e-6)).all()


@given(resolutions, clouds)
def test_a_grid_holds_its_own_centres(resolution, points):
    grid = filled(points, resolution)
    assert filled(grid.points(), resolution).cells.tolist() == grid.cells.tolist()


@given(clouds, st.randoms(use_true_random=False))
def test_order_leaves_no_trace(points, random):
    shuffled = points.tolist()
    random.shuffle(shuffled)
    one, other = filled(points, 0.01), filled(shuffled, 0.01)
    assert one.cells.tolist() == other.cells.tolist()
    assert one.points().tobytes() == other.points().tobytes()


@given(clouds, clouds)
def test_adding_in_parts_is_adding_at_once(first, second):
    parts = filled(first, 0.01)
    parts.add(second)
    parts.add(first)
    assert parts.points().tobytes() == filled(np.vstack([first, second]), 0.01).points().tobytes()


@given(clouds)
def test_cells_are_sorted_and_each_is_there_once(points):
    grid = filled(points, 0.05)
    expected = sorted({(int(i), int(j)) for i, j in np.floor(points / 0.05 + 1e-9)})
    assert [tuple(c) for c in grid.cells.tolist()] == expected
    assert len(grid) == len(expected) == len(grid.points())
    np.testing.assert_allclose(grid.points(), (np.reshape(expected, (-1, 2)) + 0.5) * 0.05, rtol=1e-14)


def test_one_cell_counts_once():
    grid = filled([(0.1, 0.1), (0.1009, 0.1009), (0.1, 0.1)])
    grid.add([(0.1005, 0.1005)])
    assert grid.cells.tolist() == [[100, 100]]


# --- Scans --------------------------------------------------------------------------------------------------


def test_scan_by_scan_is_all_at_once():
    for seed in range(5):
        world = random_world(4, rng=seed)
        scans = scan(world, teleport_poses(world))
        whole, parts, points = filled(scans), Grid(), filled(scans.points())
        for i in np.random.default_rng(seed).permutation(len(scans)):
            parts.add(scans[i])
        assert len(whole) > 200
        assert whole.points().tobytes() == parts.points().tobytes() == points.points().tobytes()


def test_scans_without_hits_add_nothing():
    grid = filled([(0.1, 0.1)])
    grid.add(Scans(np.zeros((1, 3)), np.zeros(2), np.full((1, 2), INF), np.zeros(1, dtype=bool)))
    grid.add(Scans(np.zeros((0, 3)), np.zeros(2), np.zeros((0, 2)), np.zeros(0, dtype=bool)))
    grid.add([])
    assert grid.cells.tolist() == [[100, 100]]


def test_misses_are_not_points():
    ranges = np.array([[0.2, INF, 0.0]])
    grid = filled(Scans(np.zeros((1, 3)), np.array([0, 1.0, 2.0]), ranges, np.zeros(1, dtype=bool)))
    assert grid.cells.tolist() == [[200, 0]]


def test_an_empty_grid():
    grid = Grid()
    assert (len(grid), grid.cells.shape, grid.points().shape) == (0, (0, 2), (0, 2))
    assert grid.to_points([]).shape == grid.to_cells([]).shape == (0, 2)
    assert (grid.resolution, repr(grid)) == (0.001, "Grid: no occupied cells of 1 mm")
    assert repr(filled([(0, 0), (1, 1)], 0.25)) == "Grid: 2 occupied cells of 250 mm"


# --- What is refused ----------------------------------------------------------------------------------------


def test_the_outermost_cells_are_kept():
    last = HALF - 1
    cells = [[-last, -last], [-last, 0], [-last, last], [0, 0], [last, -last], [last, last]]
    grid = Grid()
    grid.add(grid.to_points(cells))
    assert grid.cells.tolist() == cells


ADD_FAILURES = {
    "NaN": ([(0, 0), (NAN, 0)], "points must be finite, got (nan, 0.0) in row 1"),
    "infinity": ([(0, -INF)], "points must be finite, got (0.0, -inf) in row 0"),
    "far out": ([(0, 0), (2e6, 0)], "points must lie within 1.07374e+06 m of the origin, got one 2e+06 m out"),
    "far out, below": ([(0, -2e6)], "points must lie within 1.07374e+06 m of the origin, got one 2e+06 m out"),
    "just too far": (
        [(HALF * 0.001, 0)],
        "points must lie within 1.07374e+06 m of the origin, got one 1.07374e+06 m out",
    ),
    "just too far, below": (
        [(0, -HALF * 0.001)],
        "points must lie within 1.07374e+06 m of the origin, got one 1.07374e+06 m out",
    ),
    "so far that the cell is infinite": (
        [(0, 1e308)],
        "points must be finite and at most 1e+50, got (0.0, 1e+308) in row 0",
    ),
    "one point without its row": ((0.1, 0.1), "points must have shape (N, 2), got shape (2,)"),
    "three numbers": ([(0.1, 0.1, 0)], "points must have shape (N, 2), got shape (1, 3)"),
    "text": ("ab", "points must be numbers in an array of shape (N, 2), got 'ab'"),
    "None": (None, "points must be numbers in an array of shape (N, 2), got None"),
}


@pytest.mark.parametrize(("points", "sentence"), ADD_FAILURES.values(), ids=ADD_FAILURES)
def test_add_failure_leaves_the_grid_as_it_was(points, sentence):
    grid = filled([(0.1, 0.1), (-0.2, 0.3)])
    before = grid.points().tobytes()
    with pytest.raises(ValueError, match=exactly(sentence)):
        grid.add(points)
    with pytest.raises(ValueError, match=exactly(sentence)):
        grid.to_cells(points)
    assert grid.points().tobytes() == before


def test_add_failure_on_scans_leaves_the_grid_as_it_was():
    grid = filled([(0.1, 0.1)])
    lost = Scans(np.array([(2e6, 0, 0)]), np.zeros(1), np.array([[0.2]]), np.zeros(1, dtype=bool))
    sentence = "points must lie within 1.07374e+06 m of the origin, got one 2e+06 m out"
    with pytest.raises(ValueError, match=exactly(sentence)):
        grid.add(lost)
    assert grid.cells.tolist() == [[100, 100]]


TO_POINTS_FAILURES = {
    "one cell without its row": ((100, 100), "cells must have shape (N, 2), got shape (2,)"),
    "three columns": (np.zeros((2, 3)), "cells must have shape (N, 2), got shape (2, 3)"),
    "NaN": ([(NAN, 1)], "cells must be finite, got (nan, 1.0) in row 0"),
    "text": ("a", "cells must be numbers in an array of shape (N, 2), got 'a'"),
}


@pytest.mark.parametrize(("cells", "sentence"), TO_POINTS_FAILURES.values(), ids=TO_POINTS_FAILURES)
def test_to_points_failure(cells, sentence):
    with pytest.raises(ValueError, match=exactly(sentence)):
        Grid().to_points(cells)


RESOLUTION_FAILURES = {
    "zero": (0, "resolution must be a finite number > 0, got 0"),
    "negative": (-0.001, "resolution must be a finite number > 0, got -0.001"),
    "NaN": (NAN, "resolution must be a finite number > 0, got nan"),
    "infinite": (INF, "resolution must be a finite number > 0, got inf"),
    "None": (None, "resolution must be a finite number > 0, got None"),
    "text": ("0.001", "resolution must be a finite number > 0, got '0.001'"),
    "a truth value": (True, "resolution must be a finite number > 0, got True"),
    "a point": ((1, 1), "resolution must be a finite number > 0, got (1, 1)"),
}


@pytest.mark.parametrize(("resolution", "sentence"), RESOLUTION_FAILURES.values(), ids=RESOLUTION_FAILURES)
def test_resolution_failure(resolution, sentence):
    with pytest.raises(ValueError, match=exactly(sentence)):
        Grid(resolution)


# --- Which scan hit a cell last -------------------------------------------------------------------------------


def test_last_seen_is_the_scan_that_hit_a_cell_last():
    world, poses = random_world(2, rng=4), [(0.0, 0.0, 0.0), (0.1, 0.0, 0.0), (0.0, 0.0, 0.0)]
    scans, grid = scan(world, poses), Grid()
    grid.add(scans[:2])
    grid.add([(0.9, 0.9)])
    grid.add(scans[2:])
    last = {tuple(cell): 0 for cell in grid.to_cells([(0.9, 0.9)]).tolist()}
    for number in range(3):
        last |= {tuple(cell): number + 1 for cell in grid.to_cells(scans[number : number + 1].points()).tolist()}
    assert grid.n_scans == 3
    assert dict(zip(map(tuple, grid.cells.tolist()), grid.last_seen.tolist(), strict=True)) == last
    assert 1 not in grid.last_seen.tolist()  # the third scan stands where the first stood


def test_last_seen_stays_with_a_copy_and_a_pickle():
    grid = Grid()
    grid.add(scan(random_world(2, rng=4), teleport_poses(random_world(2, rng=4))))
    for again in (copy(grid), pickle.loads(pickle.dumps(grid))):
        again.add([(0.9, 0.9)])
        assert len(again) == len(grid) + 1
        np.testing.assert_array_equal(again.last_seen[again.last_seen > 0], grid.last_seen)


def test_last_seen_is_a_copy():
    grid = filled([(0.1, 0.1)])
    grid.last_seen[:] = 5
    assert grid.last_seen.tolist() == [0]


def test_all_in_one_call_is_scan_after_scan():
    world = random_world(3, rng=8)
    scans, whole, one_by_one = scan(world, teleport_poses(world)), Grid(), Grid()
    whole.add(scans)
    for number in range(len(scans)):
        one_by_one.add(scans[number : number + 1])
    np.testing.assert_array_equal(whole.cells, one_by_one.cells)
    np.testing.assert_array_equal(whole.last_seen, one_by_one.last_seen)
