"""Studies: the same rows whatever the number of workers and however often killed; tables computed by hand."""

import csv
import inspect
import io
import json
import os
import subprocess
import sys
import time
import xml.etree.ElementTree as ET
from dataclasses import astuple, replace
from pathlib import Path

import joblib
import numpy as np
import pytest

from primkit import __version__
from primkit.evaluation import evaluate
from primkit.formats import paper_suite
from primkit.grid import Grid
from primkit.lidar import Lidar, scan
from primkit.measure import Detection
from primkit.pipeline import ROBUST, Settings
from primkit.robot import skipped_waypoints, teleport_poses
from primkit.shapes import Circle, Polygon
from primkit.study import (
    JOURNAL,
    METHODS,
    Estimate,
    Experiment,
    Line,
    Row,
    Score,
    estimate,
    experiment,
    make_folder,
    many,
    perform,
    rows_as_csv,
    run,
    run_study,
    tables,
)
from primkit.study.paper_table import paper_table
from primkit.world import World, random_world

ROOT = Path(__file__).resolve().parent.parent
QUICK = Settings(grouping="kmeans", method="published", line_trials=200, circle_trials=100)
BOTH = {"PAPER": QUICK, "ROBUST": ROBUST}
ONE = World([Circle((0.1, 0.0), 0.06)])  # two way-points lie in it
WORLDS = {"one": ONE, "two": random_world(2, rng=3)}
NOISY = Lidar(noise_std=0.002)


@pytest.fixture(scope="module")
def rows() -> list[Row]:
    """What all ways of getting there must agree with."""
    return run_study(WORLDS, BOTH, lidar=NOISY, jobs=1)


def refusal(function, *args, error=ValueError, **kwargs):
    """The exact sentence with which a call is refused."""
    with pytest.raises(error) as caught:
        function(*args, **kwargs)
    assert caught.type is error
    return str(caught.value)


# --- one row ------------------------------------------------------------------------------------------------


def test_a_row_holds_what_the_steps_by_hand_give():
    trial = Experiment("one", ONE, "ROBUST", ROBUST, NOISY, tolerance=0.003, seed=5)
    done = run(trial)
    grid = Grid()
    grid.add(scan(ONE, teleport_poses(ONE), NOISY, rng=trial.rngs()[0]))
    assert np.array_equal(done.points, grid.points())
    fair, paper = evaluate(done.found, ONE, 0.003), evaluate(done.found, ONE, protocol="paper")
    row = perform(trial)
    assert (row.map, row.settings, row.kinds, row.movement, row.tolerance) == (
        "one",
        "ROBUST",
        ("circle",),
        "automatic",
        0.003,
    )
    assert (row.n_shapes, row.n_found, row.count_right, row.told) == (1, 1, True, False)
    for score, report in ((row.fair, fair), (row.paper, paper)):
        assert score.weighted == report.weighted_accuracy
        assert (score.shape, score.center, score.dimension) == (
            report.shape_accuracy,
            report.center_accuracy,
            report.dimension_accuracy,
        )
    assert row.center_errors == tuple(fair.matches[0].center_error)
    assert row.dimension_errors == fair.matches[0].dimension_error
    assert 0 < row.computing_time < 60


def test_robot_time_counts_the_skipped_waypoints_too():
    assert len(skipped_waypoints(ONE)) == 1
    assert perform(Experiment("one", ONE, "ROBUST", ROBUST)).robot_time == 77 * 0.1
    assert perform(Experiment("one", ONE, "ROBUST", ROBUST, Lidar(period=0.5))).robot_time == 77 * 0.5


def test_only_the_published_method_is_told_the_number(rows):
    assert [(row.settings, row.told) for row in rows] == [("PAPER", True), ("ROBUST", False)] * 2
    assert [run(Experiment("two", WORLDS["two"], "", s)).told for s in (QUICK, ROBUST)] == [2, None]


def test_all_methods_get_the_same_scans():
    scans = [run(Experiment("two", WORLDS["two"], name, s, NOISY)).scans for name, s in BOTH.items()]
    assert np.array_equal(scans[0].ranges, scans[1].ranges)


def test_errors_of_missed_and_misnamed_shapes_are_left_out(monkeypatch):
    square = Polygon([(-0.3, -0.3), (-0.2, -0.3), (-0.2, -0.2), (-0.3, -0.2)])
    found = [Detection(Circle((-0.24, -0.25), 0.05), np.empty((0, 2)), 0.0)]
    monkeypatch.setattr(experiment, "find_shapes", lambda *_, **__: found)
    row = perform(Experiment("board", World([ONE.shapes[0], square]), "ROBUST", ROBUST))
    assert row.center_errors == pytest.approx((0.01, 0.0))
    assert row.dimension_errors == ()
    assert (row.n_found, row.count_right, row.fair.shape) == (1, False, 0.0)


@pytest.mark.parametrize("settings", BOTH.values(), ids=BOTH)
@pytest.mark.parametrize("lidar", [Lidar(dropout=1), Lidar(dropout=0.9999)], ids=["sees nothing", "sees a few points"])
def test_a_blind_sensor_finds_nothing_and_is_no_error(settings, lidar):
    assert perform(Experiment("two", WORLDS["two"], "", settings, lidar)).n_found == 0


def test_an_error_tells_on_which_map_it_happened(monkeypatch):
    def break_down(*_, **__):
        raise ValueError("broken")

    experiment._warm_up(ROBUST.method)
    monkeypatch.setattr(experiment, "find_shapes", break_down)
    with pytest.raises(ValueError, match="broken") as caught:
        run_study(WORLDS, {"ROBUST": ROBUST}, jobs=1)
    assert caught.value.__notes__ == ["on the map 'one' with the settings 'ROBUST'"]


# --- many rows ----------------------------------------------------------------------------------------------


def test_rows_come_map_by_map(rows):
    assert [(row.map, row.settings) for row in rows] == [
        ("one", "PAPER"),
        ("one", "ROBUST"),
        ("two", "PAPER"),
        ("two", "ROBUST"),
    ]


def test_two_processes_give_the_same_rows(rows):
    assert run_study(WORLDS, BOTH, lidar=NOISY, jobs=2) == rows


def test_another_backend_gives_the_same_rows(rows):
    with joblib.parallel_config(backend="threading", n_jobs=2):
        assert run_study(WORLDS, BOTH, lidar=NOISY, jobs=None) == rows


def test_a_map_s_row_does_not_depend_on_the_others(rows):
    backwards = run_study(dict(reversed(WORLDS.items())), {"ROBUST": ROBUST}, lidar=NOISY, jobs=1)
    assert backwards == [rows[3], rows[1]]


def test_the_seed_and_the_map_s_name_change_the_noise(rows):
    def errors(worlds, **more):
        return [row.center_errors for row in run_study(worlds, {"ROBUST": ROBUST}, lidar=NOISY, jobs=1, **more)]

    again, other, renamed = errors({"one": ONE}), errors({"one": ONE}, seed=1), errors({"1": ONE})
    assert again == [rows[1].center_errors]
    assert again != other
    assert again != renamed


def test_worlds_without_names_are_numbered_and_drawn_as_needed():
    drawn = []

    def endless():
        for seed in range(1000):
            drawn.append(seed)
            if seed == 3:
                raise ValueError("enough")
            yield ONE

    assert [row.map for row in run_study(iter([ONE, ONE]), {"ROBUST": ROBUST}, jobs=1)] == ["1", "2"]
    assert refusal(run_study, endless(), {"ROBUST": ROBUST}, jobs=1) == "enough"
    assert drawn == [0, 1, 2, 3]


@pytest.mark.parametrize("jobs", [1, 2])
def test_what_was_finished_before_a_failure_is_kept(tmp_path, jobs):
    def three():
        yield from WORLDS.values()
        raise ValueError("no third world")

    assert refusal(run_study, three(), BOTH, folder=tmp_path, jobs=jobs) == "no third world"
    assert len((tmp_path / JOURNAL).read_bytes().splitlines()) == 4


def test_a_drive_is_manual_movement():
    row = run_study(WORLDS, {"ROBUST": ROBUST}, drives={"one": [(-0.1, 0, 0)] * 5, "two": []}, jobs=1)[0]
    assert (row.movement, row.robot_time) == ("manual", 0.5)
    assert [table.title for table in tables([row])] == ["Table 3. One shape, manual movement"]


def test_the_paper_s_maps_are_the_default(monkeypatch):
    monkeypatch.setattr(many, "published_suite", lambda: {"mine": World()})
    assert [(row.map, row.settings, row.n_shapes) for row in run_study(jobs=1)] == [
        ("mine", "PAPER", 0),
        ("mine", "ROBUST", 0),
    ]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"worlds": [1]}, "each of the worlds must be World, got int"),
        ({"settings": {"mine": "robust"}}, "each of the settings must be Settings, got str"),
        ({"lidar": 0.3}, "lidar must be a Lidar, such as Lidar(), got float"),
        ({"tolerance": -1}, "tolerance must be a finite number >= 0, got -1"),
        ({"seed": 0.5}, "seed must be a whole number >= 0, got 0.5"),
        ({"jobs": 0}, "jobs must be a whole number >= 1, -1 for every core, or None, got 0"),
        ({"jobs": "all"}, "jobs must be a whole number >= 1, -1 for every core, or None, got 'all'"),
        ({"drives": {"one": []}}, "drives must hold one for each map, got none for 'two'"),
        ({"drives": {"one": [1, 2]}}, "poses must have shape (P, 3): x, y, heading; got shape (2,)"),
    ],
    ids=lambda value: next(iter(value)) if isinstance(value, dict) else "",
)
def test_run_study_failure(change, message):
    arguments = {"worlds": WORLDS, "settings": {"ROBUST": ROBUST}, "jobs": 1, **change}
    assert refusal(run_study, **arguments) == message


# --- the progress bar ---------------------------------------------------------------------------------------


class Terminal(io.StringIO):
    def isatty(self):
        return True


def test_the_bar_shows_on_a_terminal_only(monkeypatch, capsys):
    run_study({"one": ONE}, {"ROBUST": ROBUST}, jobs=1)
    assert capsys.readouterr() == ("", "")
    for progress in (True, False):
        monkeypatch.setattr(sys, "stderr", Terminal())
        run_study({"one": ONE}, {"ROBUST": ROBUST}, jobs=1, progress=progress)
        assert ("1/1" in sys.stderr.getvalue()) == progress


# --- the journal --------------------------------------------------------------------------------------------


def no_work(_):
    raise AssertionError("this row was finished before")


def test_finished_rows_are_not_computed_again(tmp_path, monkeypatch):
    first = run_study(WORLDS, BOTH, jobs=1, folder=tmp_path / "new" / "folder")
    text = (tmp_path / "new" / "folder" / JOURNAL).read_bytes()
    monkeypatch.setattr(many, "perform", no_work)
    again = run_study(WORLDS, BOTH, jobs=1, folder=tmp_path / "new" / "folder")
    assert [astuple(row) for row in again] == [astuple(row) for row in first]  # measured times too
    assert (tmp_path / "new" / "folder" / JOURNAL).read_bytes() == text


def test_a_line_of_the_journal_tells_what_it_is(tmp_path):
    run_study({"one": ONE}, {"ROBUST": ROBUST}, folder=tmp_path, jobs=1)
    line = json.loads((tmp_path / JOURNAL).read_bytes())
    assert line["experiment"]["program"].startswith(f"primkit {__version__} ")
    assert line["experiment"]["lidar"]["beams"] == 100
    assert (line["row"]["map"], line["row"]["kinds"]) == ("one", ["circle"])


CHANGES = {
    "tolerance": {"tolerance": 0.004},
    "seed": {"seed": 1},
    "sensor": {"lidar": Lidar(beams=90)},
    "settings": {"settings": {"ROBUST": Settings(noise_std=0.001)}},
    "method's name": {"settings": {"mine": ROBUST}},
    "map": {"worlds": {"one": World([Circle((0.1, 0.0), np.nextafter(0.06, 1))])}},
    "board": {"worlds": {"one": World(ONE.shapes, 1.05)}},
    "map's name": {"worlds": {"uno": ONE}},
    "drive": {"drives": {"one": teleport_poses(ONE)}},
}


@pytest.mark.parametrize("change", CHANGES.values(), ids=CHANGES)
def test_a_changed_study_is_not_mixed_in(tmp_path, change):
    base = {"worlds": {"one": ONE}, "settings": {"ROBUST": ROBUST}, "jobs": 1, "folder": tmp_path}
    run_study(**base)
    changed = run_study(**{**base, **change})
    assert len((tmp_path / JOURNAL).read_bytes().splitlines()) == 2
    assert run_study(**{**base, **change, "folder": None}) == changed
    run_study(**base)
    assert len((tmp_path / JOURNAL).read_bytes().splitlines()) == 2


def test_a_changed_program_is_not_mixed_in(tmp_path, monkeypatch):
    for program in ("primkit 0.1.0", "primkit 0.2.0"):
        monkeypatch.setattr(experiment, "program", lambda program=program: program)
        run_study({"one": ONE}, {"ROBUST": ROBUST}, jobs=1, folder=tmp_path)
    assert len((tmp_path / JOURNAL).read_bytes().splitlines()) == 2


@pytest.mark.parametrize("cut", [1, 2, 100, "all of the last line but one byte"])
def test_a_truncated_last_line_is_dropped(tmp_path, rows, cut):
    run_study(WORLDS, BOTH, lidar=NOISY, jobs=1, folder=tmp_path)
    whole = (tmp_path / JOURNAL).read_bytes()
    lines = whole.splitlines(keepends=True)
    cut = cut if isinstance(cut, int) else len(lines[-1]) - 1
    (tmp_path / JOURNAL).write_bytes(whole[:-cut])
    assert run_study(WORLDS, BOTH, lidar=NOISY, jobs=1, folder=tmp_path) == rows
    healed = (tmp_path / JOURNAL).read_bytes().splitlines(keepends=True)
    assert healed[:3] == lines[:3]
    assert [json.loads(line)["experiment"] for line in healed] == [json.loads(line)["experiment"] for line in lines]


@pytest.mark.parametrize(
    ("line", "shown"),
    [
        ("something else", "b'something else\\n'"),
        ("{}", "b'{}\\n'"),
        ("[1]", "b'[1]\\n'"),
        ('{"experiment": {}, "row": {"map": ""}}', """b'{"experiment": {}, "row": {"map": ""}}\\n'"""),
    ],
    ids=["text", "no row", "a list", "half a row"],
)
def test_a_journal_of_something_else_is_refused(tmp_path, line, shown):
    (tmp_path / JOURNAL).write_text(f"{line}\n", encoding="utf-8", newline="\n")
    expected = f"journal.jsonl, line 1: must be a row of a study, got {shown}"
    assert refusal(run_study, WORLDS, BOTH, jobs=1, folder=tmp_path) == expected
    assert (tmp_path / JOURNAL).read_text(encoding="utf-8") == f"{line}\n"


def test_a_folder_that_is_a_file_is_refused(tmp_path):
    (tmp_path / "file").write_text("mine")
    for folder in (tmp_path / "file", tmp_path / "file" / "below"):
        told = refusal(make_folder, folder, error=NotADirectoryError)
        assert told == f"{folder} must be a folder, got a file or a folder below a file"


KILLED = """
import sys
from primkit.lidar import Lidar
from primkit.pipeline import ROBUST
from primkit.study import run_study
from primkit.world import random_world

if __name__ == "__main__":
    endless = (random_world(1 + seed % 4, rng=seed) for seed in range(10_000))
    run_study(endless, {"ROBUST": ROBUST}, lidar=Lidar(noise_std=0.002), jobs=int(sys.argv[2]), folder=sys.argv[1])
"""


@pytest.mark.parametrize("jobs", [1, 2])
def test_a_killed_study_continues_and_leaves_nobody_behind(tmp_path, jobs):
    """The workers of a killed study once waited for five minutes for more work."""
    psutil = pytest.importorskip("psutil")
    (tmp_path / "endless.py").write_text(KILLED, encoding="utf-8")
    run_it = "import runpy, sys; del sys.argv[0]; runpy.run_path(sys.argv[0], run_name='__main__')"
    command = [sys.executable, "-W", "error", "-c", run_it, tmp_path / "endless.py", tmp_path, str(jobs)]
    journal = tmp_path / JOURNAL
    process = subprocess.Popen(command, cwd=ROOT)
    try:
        for _ in range(6000):
            if process.poll() is not None or (journal.exists() and journal.read_bytes().count(b"\n") >= 2):
                break
            time.sleep(0.005)
        assert process.poll() is None
        workers = psutil.Process(process.pid).children(recursive=True)
        assert len(workers) >= (0 if jobs == 1 else jobs)
    finally:
        process.kill()  # SIGKILL: no chance to tidy up
        process.wait()
    if sys.platform != "win32":
        assert psutil.wait_procs(workers, timeout=120)[1] == []  # far below the five minutes, on a busy machine too
    before = journal.read_bytes()
    before = before[: before.rfind(b"\n") + 1]
    assert before.count(b"\n") >= 2

    worlds = [random_world(1 + seed % 4, rng=seed) for seed in range(16)]
    resumed = run_study(worlds, {"ROBUST": ROBUST}, lidar=NOISY, jobs=2, folder=tmp_path)
    assert resumed == run_study(worlds, {"ROBUST": ROBUST}, lidar=NOISY, jobs=1)
    assert journal.read_bytes().startswith(before)


# --- tables -------------------------------------------------------------------------------------------------

PERFECT = Score(1.0, 1.0, 1.0, 1.0)
HALF = Score(0.5, 0.5, 0.5, 0.5)
NONE = Score(0.0, 0.0, 0.0, 0.0)
BASE = Row("", "ROBUST", ("circle",), "automatic", 0.005, False, 1, PERFECT, HALF, (0.001, -0.002), (), 7.7, 0.1)
TWO = replace(BASE, kinds=("circle", "pentagon"), n_found=2)


def test_a_table_computed_by_hand():
    made = tables(
        [
            replace(BASE, settings="PAPER", told=True, fair=NONE, n_found=0, computing_time=0.25),
            replace(BASE, fair=PERFECT, paper=Score(0.7, 1.0, 1.0, 0.0)),
            replace(BASE, kinds=("pentagon",), fair=HALF, paper=NONE, computing_time=0.3),
        ]
    )
    assert (
        "\n".join(map(str, made))
        == """\
Table 1. One shape, automatic movement

                      total                shape  centre  dimensions  time [s]
--------------------  -------------------  -----  ------  ----------  ----------
circle, 1 map
 PAPER as published   0.500                0.500  0.500   0.500       7.7 + 0.25
 PAPER within 5 mm    0.000                0.000  0.000   0.000       7.7 + 0.25
 ROBUST as published  0.700                1.000  1.000   0.000       7.7 + 0.10
 ROBUST within 5 mm   1.000                1.000  1.000   1.000       7.7 + 0.10
pentagon, 1 map
 ROBUST as published  0.000                0.000  0.000   0.000       7.7 + 0.30
 ROBUST within 5 mm   0.500                0.500  0.500   0.500       7.7 + 0.30
average, 2 maps
 PAPER as published   0.500                0.500  0.500   0.500       7.7 + 0.25
 PAPER within 5 mm    0.000                0.000  0.000   0.000       7.7 + 0.25
 ROBUST as published  0.350 (0.000-0.700)  0.500  0.500   0.000       7.7 + 0.20
 ROBUST within 5 mm   0.750 (0.500-1.000)  0.750  0.750   0.750       7.7 + 0.20

total = 0.4 shape (type) + 0.3 centre (position) + 0.3 dimensions (shape
measurements).
Scored as published: both rounded to 1 cm, whatever is too small counts as
right, a rectangle's width is compared with its height, and a wrong kind ends
the run. Runs that end are left out of the mean.
within 5 mm: on exact rays, right when at most that far off, either way,
unrounded.
time: robot (scans x period) + computing; a recorded time is on the wall,
pictures included.
Right number of shapes: PAPER on 0 of 1 maps, being told it; ROBUST on 2 of 2
maps.
In brackets: 95 % interval of the mean over the maps (bootstrap)."""
    )


def test_perfect_maps_call_for_the_rule_of_three():
    notes = tables([TWO] * 3)[0].notes
    assert (
        notes[-1] == "Where all n maps score 1, up to about 3/n of all such maps may still score less (rule of three)."
    )
    assert tables([TWO])[0].notes[-1].startswith("Right number of shapes: ROBUST on 1 of 1 maps")


TITLES = {
    "one shape": ([BASE], ["Table 1. One shape, automatic movement"]),
    "two shapes": ([TWO], ["Table 2. Several shapes, automatic movement"]),
    "both, in the paper's order": (
        [TWO, BASE],
        ["Table 1. One shape, automatic movement", "Table 2. Several shapes, automatic movement"],
    ),
    "driven": ([replace(TWO, movement="manual")], ["Table 4. Several shapes, manual movement"]),
    "nothing": ([], []),
}


@pytest.mark.parametrize(("rows", "titles"), TITLES.values(), ids=TITLES)
def test_which_tables_there_are(rows, titles):
    assert [table.title for table in tables(rows)] == titles


def test_numbers_of_shapes_that_the_paper_has_not():
    seven, none = replace(BASE, kinds=("circle",) * 7), replace(BASE, kinds=())
    table = tables([seven, none])[0]
    assert [(line.maps, line.method) for line in table.lines] == [
        ("0 shapes", "ROBUST as published"),
        ("0 shapes", "ROBUST"),
        ("7 shapes", "ROBUST as published"),
        ("7 shapes", "ROBUST"),
    ]
    assert "\n7 shapes, 1 map\n" in str(table)


def test_a_polygon_of_another_kind_has_its_line():
    star = replace(BASE, kinds=("polygon",), dimension_counts=(10,), dimension_errors=(0.001,) * 10)
    assert star.within(0.005) == PERFECT
    lines = tables([star, BASE])[0].lines
    assert list(dict.fromkeys(line.maps for line in lines)) == ["circle", "polygon", "average"]


def test_tables_failure():
    rows = [BASE, replace(BASE, tolerance=0.001)]
    assert refusal(tables, rows) == "the rows of a table must share one tolerance, got 0.001, 0.005 m"


def test_the_interval_agrees_with_scipy():
    from scipy.stats import bootstrap

    values = np.random.default_rng(1).uniform(0, 1, (40, 2)) ** 2
    seed = {"rng" if "rng" in inspect.signature(bootstrap).parameters else "random_state": 2}  # before scipy 1.15
    for column, mean in zip(values.T, estimate.means_of(values), strict=True):
        theirs = bootstrap((column,), np.mean, n_resamples=5000, method="percentile", **seed).confidence_interval
        assert (mean.low, mean.high) == pytest.approx(tuple(theirs), abs=0.01)


def test_the_interval_does_not_depend_on_the_blocks(monkeypatch):
    values = np.random.default_rng(1).uniform(0, 1, (7, 3))
    whole = [astuple(mean) for mean in estimate.means_of(values)]
    monkeypatch.setattr(estimate, "COUNTS_AT_ONCE", 7 * 300)
    assert np.allclose([astuple(mean) for mean in estimate.means_of(values)], whole, rtol=0, atol=1e-12)


def test_a_table_fits_a_plain_terminal(rows):
    several = [replace(row, kinds=("circle",) * n) for row in rows for n in (2, 3, 4)]
    assert max(len(line) for line in str(tables(several)[0]).splitlines()) <= 80


def test_a_table_s_html_says_the_same_as_its_text():
    line = Line("a < b", "A & B", "within 5 mm", 2, (Estimate(0.5, 0.0, 1.0),) * 4, 7.7, 0.25)
    table = paper_table("<One> & two", (line,), ("a & b",))
    root = ET.fromstring(f"<div>{table._repr_html_()}</div>")
    assert list(root.itertext()) == [
        *("<One> & two", "total", "shape", "centre", "dimensions", "time [s]", "a < b, 2 maps"),
        *("A & B within 5 mm", "0.500 (0.000-1.000)", "0.500", "0.500", "0.500", "7.7 + 0.25", "a & b"),
    ]
    assert [cell.get("scope") for cell in root.iter("th")] == ["col"] * 5 + ["rowgroup", "row"]


def test_a_table_s_csv_has_all_numbers():
    table = tables([TWO, replace(TWO, fair=NONE)])[0]
    lines = list(csv.DictReader(io.StringIO(table.csv())))
    assert [(line["method"], line["scoring"], line["n"]) for line in lines] == [
        ("ROBUST as published", "", "2"),
        ("ROBUST", "within 5 mm", "2"),
    ]
    assert [lines[1][name] for name in ("weighted", "weighted_low", "weighted_high")] == ["0.5", "0.0", "1.0"]
    assert [lines[1][name] for name in ("robot_time_s", "computing_time_s", "time_s")] == ["7.7", "0.1", "7.8"]


def test_rows_as_csv_byte_for_byte():
    row = replace(TWO, map="my map, old", dimension_errors=(1 / 3000, -0.0005))
    assert rows_as_csv([row, replace(BASE, center_errors=())]) == (
        "map,settings,movement,sensor,crashed,kinds,n_shapes,told,n_found,fair_weighted,fair_shape,fair_center,fair_dimension,"
        "paper_weighted,paper_shape,paper_center,paper_dimension,largest_center_error_m,largest_dimension_error_m,"
        "robot_time_s,computing_time_s\n"
        '"my map, old",ROBUST,automatic,exact,False,circle pentagon,2,False,2,'
        "1.0,1.0,1.0,1.0,0.5,0.5,0.5,0.5,0.002,0.0005,7.7,0.1\n"
        ",ROBUST,automatic,exact,False,circle,1,False,1,1.0,1.0,1.0,1.0,0.5,0.5,0.5,0.5,,,7.7,0.1\n"
    )


def test_the_default_methods_are_the_paper_s_and_ours():
    assert list(METHODS) == ["PAPER", "ROBUST"]
    assert METHODS["PAPER"].line_trials == 10_000


def test_robust_maps_the_bundled_boards_without_fault():
    suite = paper_suite()
    some = {name: suite[name] for name in ("1-circle", "2-01", "3-01", "4-01")}
    assert all(row.fair == PERFECT and row.count_right for row in run_study(some, {"ROBUST": ROBUST}, jobs=1))


MASKS = """
import signal
from primkit.study.many import in_parallel

def kept_out():
    return signal.pthread_sigmask(signal.SIG_BLOCK, ())

if __name__ == "__main__":
    print(*[mask == {signal.SIGINT} for mask in in_parallel(kept_out, [()] * 4, jobs=2, progress=False, unit="row")])
    print(kept_out() == set())
"""


@pytest.mark.skipif(os.name != "posix", reason="Windows has no signal masks")
def test_workers_do_not_hear_ctrl_c(tmp_path):
    script = tmp_path / "masks.py"
    script.write_text(MASKS)
    done = subprocess.run([sys.executable, script], capture_output=True, text=True, cwd=ROOT, timeout=60)
    assert done.stdout.split() == ["True"] * 5, done.stderr
