"""The accuracy study: figures computed by hand, an oracle that is exact, the same table every time, honest views."""

import csv
import io
import xml.etree.ElementTree as ET
from dataclasses import astuple, replace

import matplotlib.pyplot as plt
import numpy as np
import pytest
from scipy.stats import binomtest

from primkit.__main__ import main
from primkit.driving.wander import CLEARANCE, PERIOD_WAY, TURN_CHOICES, WAY_MARGIN, wander
from primkit.evaluation import evaluate
from primkit.grid import Grid
from primkit.lidar import Lidar, scan
from primkit.measure import Detection
from primkit.pipeline import ROBUST
from primkit.plots import plot_accuracy, save_figure
from primkit.robot import teleport_poses
from primkit.robust.deviations import Certainty
from primkit.shapes import Circle, Polygon
from primkit.study import (
    ORACLE,
    REMEDIES,
    SWEEPS,
    UNTUNED,
    Experiment,
    Row,
    Score,
    accuracy_as_csv,
    accuracy_study,
    many,
    maps_in,
    oracle_fit,
    perform,
    run,
    run_accuracy,
    run_partial,
    run_study,
    told_points,
)
from primkit.study.accuracy.accuracy_table import accuracy_table, level_lines
from primkit.study.accuracy.drive_views import View, share_seen, unseen_sides, view_of
from primkit.study.accuracy.partial import partial_line, partial_table
from primkit.study.accuracy.sweeps import UNCHANGED, Condition, Level, experiments, n_runs
from primkit.study.estimate import Estimate, mean_of, pooled_share, ratio_of, share_of
from primkit.study.oracle import NOBODY
from primkit.world import World, random_world
from tests.helpers import exactly

TRIANGLE = Polygon([(-0.21, -0.11), (-0.01, -0.11), (-0.11, 0.09)])
RECTANGLE = Polygon([(0.11, 0.11), (0.31, 0.11), (0.31, 0.21), (0.11, 0.21)])
CIRCLE = Circle((0.21, -0.21), 0.07)
BOARD = World([TRIANGLE, RECTANGLE, CIRCLE])
ONLY_ROBUST = {"ROBUST": ROBUST}


def without_times(table):
    return [replace(line, time=None) for line in table.lines]


# --- the oracle ---------------------------------------------------------------------------------------------


def test_the_oracle_is_exact_on_exact_points():
    points, owners = [], []
    for number, shape in enumerate(BOARD.shapes):
        outline = shape.outline(300)
        if shape.kind == "circle":
            sides = np.zeros(300, dtype=int)
        else:
            gaps = np.abs(((outline[:, None] - shape.vertices) * shape.normals).sum(axis=-1))
            sides = gaps.argmin(axis=1)
        points.append(outline)
        owners.append(np.column_stack([np.full(300, number), sides]))
    fits = oracle_fit(BOARD, np.vstack(points), np.vstack(owners))
    assert [fit.kind for fit in fits] == [shape.kind for shape in BOARD.shapes]
    for fit, true in zip(fits, BOARD.shapes, strict=True):
        assert fit.centroid == pytest.approx(true.centroid, abs=1e-9)
        assert fit.dimensions == pytest.approx(true.dimensions, abs=1e-9)


@pytest.mark.parametrize("lidar", [Lidar(), Lidar(noise_std=0.002), Lidar(dropout=0.3)], ids=["plain", "noise", "loss"])
def test_points_belong_to_the_side_that_they_lie_on(lidar):
    scans = scan(BOARD, teleport_poses(BOARD), lidar, rng=1)
    grid = Grid()
    grid.add(scans)
    points, owners = told_points(BOARD, scans, lidar)
    assert np.array_equal(points, grid.points())
    assert (owners >= 0).all()
    reach = 0.0008 + 6 * lidar.noise_std  # half a cell's diagonal, and the noise
    for number, shape in enumerate(BOARD.shapes):
        own = owners[:, 0] == number
        assert np.abs(shape.signed_distance(points[own])).max() <= reach
        if shape.kind != "circle":
            corner, normal = shape.vertices[owners[own, 1]], shape.normals[owners[own, 1]]
            assert np.abs(((points[own] - corner) * normal).sum(axis=1)).max() <= reach


def test_strays_belong_to_nobody():
    lidar = Lidar(spurious=0.05)
    points, owners = told_points(BOARD, scan(BOARD, teleport_poses(BOARD), lidar, rng=1), lidar)
    far = np.min([np.abs(shape.signed_distance(points)) for shape in BOARD.shapes], axis=0) > 0.002
    assert far.sum() > 100
    assert (owners[far] == NOBODY).all()
    assert (owners[~far] != NOBODY).all(axis=1).mean() > 0.9


def test_the_oracle_leaves_out_what_it_cannot_fit():
    points, owners = told_points(BOARD, scan(BOARD, [(-0.2, -0.25, 0)]))  # sees one side of the triangle
    assert set(map(tuple, owners.tolist())) == {(0, 0)}
    assert oracle_fit(BOARD, points, owners) == [None, None, None]
    parallel = np.array([(0, 0), (1, 0), (0, 1), (1, 1), (0, 2), (1, 2)]) / 10
    sides = np.column_stack([np.zeros(6, dtype=int), [0, 0, 1, 1, 2, 2]])
    assert oracle_fit(World([TRIANGLE]), parallel, sides) == [None]


def test_the_oracle_keeps_a_rectangle_s_right_angles_in_noise():
    """Sides fitted one by one are off by more than 2 degrees here, and four such sides are no rectangle."""
    board = World([Polygon([(-0.1, -0.05), (0.1, -0.05), (0.1, 0.05), (-0.1, 0.05)]).moved((0.02, 0.01), 0.4)])
    for seed in range(5):
        lidar = Lidar(noise_std=0.01)
        fits = oracle_fit(board, *told_points(board, scan(board, teleport_poses(board), lidar, rng=seed), lidar))
        assert [fit.kind for fit in fits] == ["rectangle"]
        assert np.allclose(np.abs(fits[0].turns), np.pi / 2, rtol=0, atol=1e-12)


def test_the_oracle_takes_the_place_of_settings():
    trial = Experiment("board", BOARD, "oracle", ORACLE, Lidar(noise_std=0.001), seed=3)
    done, row = run(trial), perform(trial)
    scans = scan(BOARD, teleport_poses(BOARD), trial.lidar, rng=trial.rngs()[0])
    fits = oracle_fit(BOARD, *told_points(BOARD, scans, trial.lidar))
    assert [d.shape for d in done.found] == fits
    assert row.fair.weighted == evaluate(fits, BOARD).weighted_accuracy
    assert (row.told, row.n_found, row.found_as) == (True, 3, ("triangle", "rectangle", "circle"))
    rows = run_study({"board": BOARD}, {"ROBUST": ROBUST, "oracle": ORACLE}, jobs=1)
    assert [(r.settings, r.told) for r in rows] == [("ROBUST", False), ("oracle", True)]


def test_only_k_means_of_the_published_method_is_told():
    told = {name: run(Experiment("board", BOARD, name, s)).told for name, s in REMEDIES.items()}
    assert told == {"PAPER": 3, "+ linking": None, "+ joint fit": None, "+ soft shares": None, "ROBUST": None}


# --- rows ---------------------------------------------------------------------------------------------------

FAIR = Score(0.0, 0.5, 0.0, 0.0)
# Two shapes: the triangle was found as one, the circle was found as a rectangle.
ROW = Row(
    *("mine", "ROBUST", ("triangle", "circle"), "automatic", 0.005, False, 2, FAIR, FAIR),
    *((0.001, -0.002, 0.02, 0.0), (0.0005, -0.001, 0.003), 7.7, 0.1, ("triangle", "rectangle")),
)


def test_scores_at_another_tolerance():
    assert ROW.within(0.001) == Score(0.4 * 0.5 + 0.3 * 0.5 + 0.3 * 0.5, 0.5, 0.5, 0.5)
    assert ROW.within(0.005) == Score(0.4 * 0.5 + 0.3 * 0.75 + 0.3 * 0.75, 0.5, 0.75, 0.75)
    empty = replace(ROW, kinds=(), found_as=(), fair=Score(1, 1, 1, 1))
    assert empty.within(0.001) == empty.fair


@pytest.mark.parametrize("settings", [ROBUST, ORACLE], ids=["ROBUST", "oracle"])
def test_scores_at_a_row_s_own_tolerance_are_its_scores(settings):
    for number in range(3):
        world = random_world(4, style="free", rng=[5, number])
        row = perform(Experiment("mine", world, "", settings, Lidar(noise_std=0.008), tolerance=0.002, seed=number))
        assert row.within(0.002) == row.fair


def test_errors_go_to_the_shapes_that_they_are_of():
    assert ROW.errors_by_shape() == [((0.001, -0.002), (0.0005, -0.001, 0.003)), None]
    missed = replace(ROW, found_as=(None, "circle"), center_errors=(0.1, 0.2), dimension_errors=(0.3,))
    assert missed.errors_by_shape() == [None, ((0.1, 0.2), (0.3,))]


# --- estimates ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("k", "n"), [(0, 5), (3, 7), (497, 500), (20, 20)])
def test_wilson_agrees_with_scipy(k, n):
    theirs = binomtest(k, n).proportion_ci(method="wilson")
    assert astuple(share_of(k / n, n)) == pytest.approx((k / n, theirs.low, theirs.high), abs=1e-6)


def test_estimates_by_hand():
    assert mean_of([0.25]) == Estimate(0.25)
    assert mean_of([1.0, 1.0]) == Estimate(1.0, 1.0, 1.0)
    assert ratio_of([9.0, 27.0], [1.0, 3.0], root=True) == Estimate(3.0, 3.0, 3.0)
    assert ratio_of([1.0, 0.0], [2.0, 0.0]).value == 0.5  # a draw without the first map has no ratio
    assert pooled_share([1, 0], [3, 1]).value == 0.25
    assert pooled_share([0, 0], [3, 1]) == share_of(0.0, 2)
    assert pooled_share([], []) is None


# --- lines and tables ---------------------------------------------------------------------------------------


def rows_by_hand():
    """Two maps of one circle: ROBUST errs twice as much as the oracle, and misses the second circle."""
    base = Row("a", "ROBUST", ("circle",), "automatic", 0.005, False, 1, Score(1, 1, 1, 1), FAIR, (), (), 7.7, 0.1)
    oracle = replace(base, settings="oracle", told=True, found_as=("circle",), computing_time=9.0)
    return [
        replace(base, found_as=("circle",), center_errors=(0.002, 0.0), dimension_errors=(0.0006,)),
        replace(oracle, center_errors=(0.001, 0.0), dimension_errors=(-0.0003,)),
        replace(base, map="b", n_found=0, fair=Score(0, 0, 0, 0), found_as=(None,), computing_time=0.3),
        replace(oracle, map="b", center_errors=(0.5, 0.5), dimension_errors=(0.5,)),
    ]


def test_a_level_computed_by_hand():
    ours, oracle = level_lines(Level("easy", 3, UNCHANGED), rows_by_hand())
    assert (ours.level, ours.x, ours.method, ours.n_maps, ours.n_runs, ours.n_shapes) == ("easy", 3, "ROBUST", 2, 2, 1)
    assert ours.fine.value == (0.4 + 0.3 * 0.5 + 0.3) / 2
    assert ours.coarse.value == 0.5
    assert ours.count == share_of(0.5, 2)
    assert (ours.center_rms, ours.dimension_rms) == pytest.approx((0.002 / 2**0.5, 0.0006))
    assert (ours.center_ratio.value, ours.dimension_ratio.value) == pytest.approx((2.0, 2.0))
    assert ours.time == 0.2
    assert (oracle.method, oracle.count, oracle.center_ratio, oracle.time) == ("oracle", None, None, None)
    assert oracle.n_shapes == 2


def test_runs_on_one_map_are_one_draw():
    """Three runs on map a and one on map b: each map counts once."""
    first, second, *others = rows_by_hand()
    line = level_lines(Level("easy", 3, UNCHANGED), [first, second] * 3 + others)[0]
    assert (line.n_maps, line.n_runs, line.coarse.value) == (2, 4, 0.5)
    assert line.count == share_of(0.5, 2)


def test_without_common_shapes_there_is_no_error():
    rows = [replace(row, found_as=(None,), center_errors=(), dimension_errors=()) for row in rows_by_hand()]
    line = level_lines(Level("easy", 3, UNCHANGED), rows)[0]
    assert (line.n_shapes, line.center_ratio) == (0, None)
    assert np.isnan(line.center_rms)
    assert line.cells()[4:] == ("nan", "-", "nan", "-", "0.200")


def table_by_hand():
    return accuracy_table("noise", "By hand", level_lines(Level("easy", 3, UNCHANGED), rows_by_hand()), ("a",))


def test_a_table_by_hand():
    assert (
        str(table_by_hand())
        == """\
By hand

         within 1 mm          within 5 mm          right count
-------  -------------------  -------------------  -------------------
easy, 2 maps
 ROBUST  0.425 (0.000-0.850)  0.500 (0.000-1.000)  0.500 (0.095-0.905)
 oracle  0.700 (0.400-1.000)  0.700 (0.400-1.000)  told

         centre [mm]  x oracle          dimens. [mm]  x oracle          time [s]
-------  -----------  ----------------  ------------  ----------------  --------
easy, 2 maps
 ROBUST  1.414        2.00 (2.00-2.00)  0.600         2.00 (2.00-2.00)  0.200
 oracle  353.554      -                 353.553       -                 -

a"""
    )


def test_html_says_the_same():
    root = ET.fromstring(f"<div>{table_by_hand()._repr_html_()}</div>")
    told = list(root.itertext())
    assert told[0] == "By hand"
    assert "2.00 (2.00-2.00)" in told
    assert "0.425 (0.000-0.850)" in told


def test_csv_has_all_numbers():
    lines = list(csv.DictReader(io.StringIO(accuracy_as_csv([table_by_hand()]))))
    assert [line["method"] for line in lines] == ["ROBUST", "oracle"]
    names = ("sweep", "level", "x", "n_maps", "within_5_mm", "right_count", "center_ratio", "center_rms_mm")
    assert [lines[0][name] for name in names] == ["noise", "easy", "3", "2", "0.5", "0.5", "2.0", "1.414214"]
    assert (lines[1]["right_count"], lines[1]["center_ratio_low"]) == ("", "")


# --- sweeps -------------------------------------------------------------------------------------------------


def drawn(condition, n_maps=8, seed=0):
    return list(experiments(condition, {"oracle": ORACLE}, n_maps, seed))


def test_maps_are_drawn_from_the_stated_seed():
    rng = np.random.default_rng([UNTUNED, 5, 2]).spawn(2)[0]
    assert drawn(UNCHANGED, 3, seed=5)[2].world == random_world(3, style="free", gap=0.05, rng=rng)
    assert [len(e.world.shapes) for e in drawn(UNCHANGED)] == [1, 2, 3, 4, 5, 6, 1, 2]
    assert drawn(UNCHANGED, seed=1)[0].world != drawn(UNCHANGED)[0].world


def test_only_what_is_changed_changes():
    for sweep, name in (("noise", "noise_std"), ("spurious", "spurious")):
        levels = [drawn(level.condition) for level in SWEEPS[sweep].levels]
        assert all([e.world for e in level] == [e.world for e in levels[0]] for level in levels)
        assert len({getattr(level[0].lidar, name) for level in levels}) == len(levels)
    crowds = {level.name: drawn(level.condition, 2)[1].world for level in SWEEPS["shapes"].levels}
    assert [len(world.shapes) for world in crowds.values()] == [1, 2, 3, 4, 5, 6, 8, 10, 12]
    assert crowds["6 shapes"].least_gap() >= 0.05
    assert min(crowds[f"{n} shapes"].least_gap() for n in (8, 10, 12)) >= 0.03


def test_fewer_scans_are_some_of_the_more():
    ten, twenty, _, every = (drawn(level.condition, 2)[1] for level in SWEEPS["scans"].levels)
    assert (len(ten.drive), len(twenty.drive), every.drive) == (10, 20, None)
    assert set(map(tuple, ten.drive)) < set(map(tuple, twenty.drive))


def test_the_suite_is_scanned_again_only_with_noise():
    noisy = Condition("suite", noise_std=0.001)
    assert [n_runs(c, 100) for c in (Condition("suite"), noisy, UNCHANGED)] == [34, 102, 100]
    assert n_runs(noisy, 1) == 34
    runs = drawn(noisy, 68)
    assert len(runs) == 68
    assert runs[0].map == runs[34].map
    assert runs[0].seed != runs[34].seed


def test_sweeps_have_units_and_rising_levels():
    for name, sweep in SWEEPS.items():
        x = [level.x for level in sweep.levels]
        assert len(set(x)) == len(x)
        assert sweep.axis or sweep.remedies, name


# --- the whole study ----------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def gaps(tmp_path_factory):
    """What all ways of getting there must agree with, and its journal."""
    folder = tmp_path_factory.mktemp("gaps")
    return run_accuracy("gap", 4, settings=ONLY_ROBUST, folder=folder, jobs=1), folder


def test_levels_and_methods_come_in_order(gaps):
    assert [(line.level, line.method) for line in gaps[0].lines] == [
        ("gap 5 cm", "ROBUST"),
        ("gap 5 cm", "oracle"),
        ("gap 3 cm", "ROBUST"),
        ("gap 3 cm", "oracle"),
    ]
    assert all(line.coarse.value > 0.95 for line in gaps[0].lines)
    assert gaps[0].notes[-1] == "Maps and noise are drawn from 27182818 and 0; nothing was tuned on them."


def test_two_processes_give_the_same_table(gaps):
    again = run_accuracy("gap", 4, settings=ONLY_ROBUST, jobs=2)
    assert without_times(again) == without_times(gaps[0])
    assert without_times(run_accuracy("gap", 4, settings=ONLY_ROBUST, seed=1, jobs=1)) != without_times(gaps[0])


def test_a_study_continues_where_it_stopped(gaps, monkeypatch):
    def no_work(_):
        raise AssertionError("this row was finished before")

    monkeypatch.setattr(many, "perform", no_work)
    table, folder = gaps
    again = run_accuracy("gap", 4, settings=ONLY_ROBUST, folder=folder, jobs=1)
    assert without_times(again) == without_times(table)


def test_the_study_writes_what_it_yields(tmp_path):
    first, second, views = accuracy_study(["gap", "spurious", "partial"], 2, tmp_path, settings=ONLY_ROBUST, jobs=1)
    assert (first.name, second.name, views.file) == ("gap", "spurious", "partial.csv")
    assert len(first.notes) == 1 < len(second.notes)
    lines = (tmp_path / "accuracy.csv").read_text(encoding="utf-8").splitlines()
    assert [line.split(",")[0] for line in lines] == ["sweep"] + 4 * ["gap"] + 8 * ["spurious"]
    assert (tmp_path / "partial.csv").read_text(encoding="utf-8") == views.csv()


# --- partial views ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(4))
def test_a_drive_is_smooth_and_keeps_clear(seed):
    world = random_world(4, style="free", gap=0.1, rng=[7, seed])
    way = wander(world, 60, rng=seed)
    assert way.shape == (60, 3)
    assert np.array_equal(way, wander(world, 60, rng=seed))
    assert min(shape.signed_distance(way[:, :2]).min() for shape in world.shapes) >= CLEARANCE
    assert np.abs(way[:, :2]).max() <= 0.5 - WAY_MARGIN
    steps = np.hypot(*np.diff(way[:, :2], axis=0).T)
    assert np.all((np.abs(steps - PERIOD_WAY) < 1e-12) | (steps == 0))
    assert np.abs(np.diff(way[:, 2])).max() <= TURN_CHOICES[-1] + 1e-12


def test_how_much_was_seen_by_hand():
    lower = np.column_stack([np.linspace(-0.21, -0.01, 101), np.full(101, -0.11)])
    # The whole lower side of 0.2 m, and 12 mm of each of the two others of 0.2236 m.
    assert share_seen(TRIANGLE, lower) == pytest.approx((0.2 + 2 * 0.012) / TRIANGLE.perimeter, abs=0.02)
    assert share_seen(TRIANGLE, np.empty((0, 2))) == 0.0
    assert share_seen(CIRCLE, CIRCLE.outline(90)) == 1.0


def test_sides_seen_at_their_ends_only_were_not_seen():
    first, second = RECTANGLE.vertices[0], RECTANGLE.vertices[1]
    for share, unseen in ((0.05, True), (0.11, False), (0.5, False), (0.95, True)):
        hit = first + share * (second - first)
        assert unseen_sides(RECTANGLE, hit[None], np.array([0])).tolist() == [unseen, True, True, True]
    assert unseen_sides(CIRCLE, np.empty((0, 2)), np.empty(0, dtype=int)).tolist() == [True]


def found(shape, *std):
    return Detection(shape, np.empty((0, 2)), 0.0, sure=Certainty((), std))


NO, YES = False, True


def test_a_rectangle_s_width_and_height_are_paired_by_direction():
    """The true one lies 0.2 m wide; the found one is narrower than high, because a side was not seen."""
    narrow = Polygon([(0.23, 0.11), (0.311, 0.11), (0.311, 0.21), (0.23, 0.21)]).moved(angle=0.01)
    view = view_of(3, RECTANGLE, 0.5, np.array([NO, NO, NO, YES]), found(narrow, 0.001, float("inf")))
    assert view.errors == pytest.approx((0.0, 0.081 - 0.2))
    assert (view.hidden, view.measured) == ((False, True), (True, False))
    wide = view_of(3, RECTANGLE, 0.5, np.array([NO, NO, NO, YES]), found(RECTANGLE, 0.001, 0.001))
    assert (wide.errors, wide.hidden, wide.whole) == ((0.0, 0.0), (True, False), False)


def test_sides_are_paired_by_their_corners():
    turned = Polygon(np.roll(TRIANGLE.vertices, -1, axis=0) + 0.001)
    view = view_of(0, TRIANGLE, 0.7, np.zeros(3, dtype=bool), found(turned, 0.1, 0.1, 0.1))
    assert view.errors == pytest.approx((0, 0, 0), abs=1e-12)
    assert view.whole
    pentagon = Polygon(0.1 * np.column_stack([f(np.radians([80, 152, 224, 296, 368])) for f in (np.cos, np.sin)]))
    view = view_of(0, pentagon, 0.7, np.array([YES, NO, NO, NO, NO]), found(pentagon, *5 * [0.1]))
    assert view.hidden == (True, True, False, False, True)  # its own length, and those that it cuts off


def test_what_was_not_found_as_what_it_is_has_no_errors():
    unseen = np.zeros(3, dtype=bool)
    assert view_of(2, TRIANGLE, 0.7, unseen, None) == View(2, "triangle", None, 0.7, (), (), (), True)
    other = view_of(2, TRIANGLE, 0.7, unseen, found(CIRCLE, 0.01))
    assert other == View(2, "triangle", "circle", 0.7, (), (0.01,), (), True)
    assert (other.kind_right, other.measured) == (False, (True,))


def test_shares_over_views_by_hand():
    inf = float("inf")
    views = [
        # all three measured: right and covered, right and not covered, wrong and covered
        View(0, "triangle", "triangle", 0.8, (0.001, 0.004, 0.009), (0.001, 0.001, 0.005), (NO, NO, NO), YES),
        # one measured though hidden, one left out though visible
        View(1, "rectangle", "rectangle", 0.5, (0.0, 0.0), (0.001, inf), (YES, NO), NO),
        # another kind, with one dimension said to be measured
        View(1, "circle", "triangle", 0.5, (), (0.001, inf, inf), (), YES),
    ]
    line = partial_line(0.002, 3, views)
    assert (line.n_drives, line.n_shapes, line.n_whole) == (3, 3, 2)
    assert (line.n_visible, line.n_hidden, line.n_measured, line.n_claimed) == (4, 1, 4, 1)
    assert (line.kind.value, line.whole.value) == (2 / 3, 1 / 2)
    assert (line.found.value, line.claimed) == (3 / 4, share_of(1.0, 1))
    assert (line.right.value, line.strict.value, line.covered.value) == (3 / 4, 3 / 5, 3 / 4)
    nothing = partial_line(0.0, 2, [])
    assert (nothing.n_shapes, nothing.kind, nothing.right, nothing.covered) == (0, None, None, None)
    assert "0 mm  0  -" in str(partial_table([nothing]))


def test_partial_views_are_the_same_every_time():
    table = run_partial(6, noises=(0.0, 0.002), jobs=1)
    assert run_partial(6, noises=(0.0, 0.002), jobs=2) == table
    assert run_partial(6, noises=(0.002,), jobs=1).lines == table.lines[1:]
    assert table.lines[0].n_shapes == table.lines[1].n_shapes > 0  # the truth tells what was seen
    ET.fromstring(f"<div>{table._repr_html_()}</div>")
    assert len(table.csv().splitlines()) == 3


# --- the picture --------------------------------------------------------------------------------------------


def test_the_picture_has_a_panel_for_each_sweep_and_tolerance(tmp_path):
    before = plt.get_fignums()
    one, table = rows_by_hand(), table_by_hand()
    lines = [line for x in (3, 5) for line in level_lines(Level(f"{x}", x, UNCHANGED), one)]
    strange = replace(lines[0], method="mine")
    tables = [replace(table, name="spurious", title="Strays, b"), replace(table, lines=(*lines, strange))]
    figure = plot_accuracy(tables)
    assert [ax.get_title(loc="left") for ax in figure.axes] == ["By hand", "Strays", "", ""]
    assert [ax.get_ylabel() for ax in figure.axes[::2]] == [f"weighted accuracy\nwithin {mm} mm" for mm in (5, 1)]
    assert figure.axes[2].get_xlabel() == "range noise [mm]"
    assert figure.get_suptitle() == "Within 5 mm, ROBUST is at most 0.20 behind the oracle, mine up to 0.20\n"
    drawn_lines = {line.get_label(): line for line in figure.axes[0].lines}
    assert list(drawn_lines) == ["ROBUST", "oracle", "mine"]
    assert drawn_lines["ROBUST"].get_ydata().tolist() == [0.5, 0.5]
    looks = {(line.get_linestyle(), line.get_marker(), line.get_color()) for line in drawn_lines.values()}
    assert len(looks) == 3
    assert len(figure.axes[0].collections) == 2  # bands: not the oracle's
    save_figure(figure, tmp_path / "a.png")
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")
    assert plt.get_fignums() == before


# --- the command --------------------------------------------------------------------------------------------


def test_the_command_prints_and_writes(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    words = ["accuracy", "--sweeps", "spurious", "partial", "--maps", "2", "--jobs", "1", "--settings", "robust"]
    assert main(words) == 0
    out, err = capsys.readouterr()
    assert out.startswith("Spurious returns, free maps\n")
    assert "\n2 % spurious, 2 maps\n ROBUST" in out
    assert "Partial views: random drives that see 40 to 90 % of each outline\n" in out
    files = [str((tmp_path / "out" / name).relative_to(tmp_path)) for name in ("accuracy.csv", "partial.csv")]
    assert out.splitlines()[-1] == f"Wrote  {', '.join([*files, files[0].replace('.csv', '.png')])}"
    assert (out.isascii(), err) == (True, "")
    assert max(map(len, out.splitlines())) <= 90


# --- refusals -----------------------------------------------------------------------------------------------

NAMES = "suite, noise, shapes, scans, spurious, gap, remedies"
REFUSED = {
    "sweep": (lambda: run_accuracy("speed"), f"sweep must be one of {NAMES}, got 'speed'"),
    "maps": (lambda: run_accuracy("gap", 0), "n_maps must be a whole number >= 1, got 0"),
    "seed": (lambda: run_accuracy("gap", 1, seed=-1), "seed must be a whole number >= 0, got -1"),
    "jobs": (
        lambda: run_accuracy("gap", 1, jobs=0),
        "jobs must be a whole number >= 1, -1 for every core, or None, got 0",
    ),
    "oracle": (lambda: run_accuracy("gap", 1, settings={"oracle": ROBUST}), 'settings must not be called "oracle"'),
    "settings": (
        lambda: run_study([], {"mine": "oracle"}),
        "each of the settings must be Settings, got str",
    ),
    "drives": (lambda: run_partial(0), "n_drives must be a whole number >= 1, got 0"),
    "noises": (lambda: run_partial(1, noises=(-1,)), "each of the noises must be a finite number >= 0, got -1"),
    "studies": (
        lambda: list(accuracy_study(["gap", "all"])),
        f"each of the sweeps must be one of {NAMES}, partial, got 'all'",
    ),
    "poses": (lambda: wander(World(), 0, rng=0), "n_poses must be a whole number >= 1, got 0"),
    "clearance": (lambda: wander(World(), clearance=-1, rng=0), "clearance must be a finite number >= 0, got -1"),
    "no room to drive": (
        lambda: wander(World([Circle((0, 0), 0.45)]), clearance=0.3, rng=0),
        "clearance must leave room for a drive, got 0.3 m on a board of 1 m",
    ),
    "no picture": (
        lambda: plot_accuracy([replace(table_by_hand(), name="gap")]),
        "tables must hold one of the sweeps noise, shapes, scans, spurious; got gap",
    ),
    "no table": (lambda: plot_accuracy([3]), "each of the tables must be of type Table, got int"),
}


@pytest.mark.parametrize(("call", "sentence"), REFUSED.values(), ids=REFUSED)
def test_refusals(call, sentence):
    with pytest.raises(ValueError, match=exactly(sentence)):
        call()


def test_the_command_refuses_in_one_sentence(tmp_path, capsys):
    assert main(["accuracy", "--sweeps", "speed", "--out", str(tmp_path)]) == 2
    assert capsys.readouterr().err == f"primkit: each of the sweeps must be one of {NAMES}, partial, got 'speed'\n"


def test_maps_in_a_folder(tmp_path):
    with pytest.raises(ValueError, match=exactly(f"{tmp_path}: must hold maps (.geojson or .json), got none")):
        maps_in([tmp_path])
