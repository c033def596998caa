"""Benchmarks: they take turns, say what they found, name absent peers, write what they print. No time is judged."""

import csv
import io
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import matplotlib
import matplotlib.pyplot as plt
import numpy as np
import pytest

import primkit as pk
from tests.benchmarks.__main__ import main
from tests.benchmarks.bench import casters, clock, command, driving, finding, machine, processes, scanning
from tests.benchmarks.bench.clock import Spread, in_turns
from tests.benchmarks.bench.effort import FULL, QUICK
from tests.benchmarks.bench.loops import LOOPS
from tests.benchmarks.bench.results import CSV_HEADER, Result, Row, results_as_csv
from tests.benchmarks.bench.timing import TOOLS, bench_figure, plot_bench
from tests.helpers import exactly

ROOT = Path(__file__).resolve().parent.parent
TINY = replace(
    QUICK, rounds=1, maps=1, poses=20, slow_poses=2, sizes=(4, 8), trials=5, clusters=1, steps=2, worlds=2, starts=1
)


@pytest.fixture(autouse=True)
def nothing_left_behind():
    """ir-sim, where it is installed, chooses another backend."""
    yield
    matplotlib.use("Agg")
    plt.close("all")


@pytest.fixture
def without_peers(monkeypatch):
    """As in the classroom, wherever the tests run."""
    for module in (scanning, finding, machine):
        monkeypatch.setattr(module, "version_of", lambda _: None)


# --- the clock and the table --------------------------------------------------------------------------------


def test_tools_take_turns_after_all_have_warmed_up():
    calls = []
    taken = in_turns({name: lambda name=name: calls.append(name) for name in "abc"}, rounds=8)
    assert calls[:3] == ["a", "b", "c"]
    rounds = ["".join(calls[i : i + 3]) for i in range(3, 27, 3)]
    assert ["".join(sorted(order)) for order in rounds] == ["abc"] * 8
    assert len(set(rounds)) > 2, "none should always come after the same"
    assert {name: each.shape for name, each in taken.items()} == dict.fromkeys("abc", (8,))


def test_the_collector_is_as_it_was_even_after_an_error():
    states = []

    def fail():
        states.append(clock.gc.isenabled())
        raise KeyError

    with pytest.raises(KeyError), clock.no_collection():
        fail()
    assert [*states, clock.gc.isenabled()] == [False, True]


RESULT = Result(
    "scan",
    "Scanning",
    "us",
    "times ours",
    (
        Row("one", "ours", Spread(1.2345, 1, 2), size=4, facts={"hits": 12.0}),
        Row("one", "theirs", Spread(12345, 12000, 13000), Spread(10000, 9000, 12000)),
        Row("two", "theirs"),
    ),
    ("First note.", "Second note."),
)
TABLE = """\
Scanning

         us (from-to)         times ours (from-to)  hits
-------  -------------------  --------------------  ----
one
 ours    1.23 (1-2)                                 12
 theirs  12300 (12000-13000)  10000 (9000-12000)
two
 theirs  absent

First note.
Second note."""


def test_a_result_as_a_table():
    assert str(RESULT) == TABLE


def test_a_table_without_ratios_has_no_column_for_them():
    alone = replace(RESULT, rows=RESULT.rows[:1], notes=())
    assert str(alone).splitlines()[2:] == [
        "       us (from-to)  hits",
        "-----  ------------  ----",
        "one",
        " ours  1.23 (1-2)    12",
    ]


def test_a_result_as_csv():
    header, *rows = csv.reader(io.StringIO(results_as_csv([RESULT])))
    assert tuple(header) == CSV_HEADER
    assert rows == [
        ["scan", "one", "ours", "4", "us", "1.2345", "1", "2", "times ours", "", "", "", "hits=12"],
        ["scan", "one", "theirs", "", "us", "12345", "12000", "13000", "times ours", "10000", "9000", "12000", ""],
        ["scan", "two", "theirs", "", "us", "", "", "", "times ours", "", "", "", ""],
    ]


def test_the_machine_is_described_without_names_and_paths(monkeypatch):
    monkeypatch.setattr(machine, "version_of", {"numba": "1.2"}.get)
    lines = machine.described("0.1").splitlines()
    assert [line.split()[0] for line in lines] == ["Machine", "Libraries", "Peers"]
    assert lines[2].endswith(
        'numba 1.2; absent: ir-sim, scikit-image, pyransac3d, circle-fit (pip install -e ".[peers]")'
    )
    assert machine.platform.node() not in "\n".join(lines)
    assert str(ROOT) not in "\n".join(lines)


# --- others' ways to scan ------------------------------------------------------------------------------------

LIDAR = pk.Lidar()
MAPS = scanning.four_shape_maps()
ANGULAR = [name for name, world in MAPS.items() if all(shape.kind != "circle" for shape in world.shapes)]


def assert_same_ranges(caster, name, n):
    poses = scanning.poses_outside(MAPS[name], n, np.random.default_rng(1))
    ours, theirs = scanning.primkit_caster(MAPS[name], LIDAR)(poses), caster(MAPS[name], LIDAR)(poses)
    assert np.isfinite(ours).any()
    np.testing.assert_allclose(theirs, ours, rtol=0, atol=scanning.EQUAL)


@pytest.mark.parametrize("loop", LOOPS)
@pytest.mark.parametrize("name", ["4-01", "4-03"], ids=["polygons", "circles"])
def test_brute_force_sees_what_primkit_sees_even_uncompiled(name, loop):
    with np.errstate(divide="ignore", invalid="ignore"):
        assert_same_ranges(lambda world, lidar: casters.numba_caster(world, lidar, LOOPS[loop]), name, n=5)


@pytest.mark.parametrize("name", ANGULAR)
def test_geos_sees_what_primkit_sees(name):
    assert_same_ranges(casters.geos_caster, name, n=40)


def test_a_polygon_for_a_circle_is_off_by_its_sagitta_straight_on():
    turn = np.pi / (4 * casters.QUADRANT)  # half-way between two of its corners
    pose = np.array([[0.25 * np.cos(turn), 0.25 * np.sin(turn), turn + np.pi]])
    world = pk.World([pk.Circle((0, 0), 0.1)])
    ours, theirs = (caster(world, LIDAR)(pose)[0, 0] for caster in (scanning.primkit_caster, casters.geos_caster))
    assert theirs - ours == pytest.approx(0.1 * (1 - np.cos(turn)))


@pytest.mark.parametrize(
    "caster",
    [casters.geos_caster, lambda world, lidar: casters.numba_caster(world, lidar, LOOPS["numba, plain loop"])],
    ids=["GEOS", "loop"],
)
def test_an_empty_board_shows_nothing(caster):
    assert np.isinf(caster(pk.World(), LIDAR)(np.zeros((2, 3)))).all()


def test_a_tiled_board_keeps_the_density():
    board = scanning.tiled(144, list(MAPS.values()))
    assert len(board.shapes) / board.size**2 == 4
    assert board.least_gap() > 0


# --- the benchmarks, as small as can be ---------------------------------------------------------------------


@pytest.mark.usefixtures("without_peers")
@pytest.mark.parametrize(
    ("bench", "absent"),
    [
        (scanning.bench_scan, 4),
        (finding.bench_shapes, 1),
        (finding.bench_kernels, 7),
        (driving.bench_live, 0),
    ],
    ids=["scan", "shapes", "kernels", "live"],
)
def test_runs_without_peers_and_names_them_as_absent(bench, absent):
    result = bench(TINY, 0)
    assert sum(row.cost is None for row in result.rows) == absent
    assert all(row.cost.low > 0 for row in result.rows if row.cost)
    assert str(result).count(" absent") == absent


@pytest.mark.usefixtures("without_peers")
def test_sizes_give_a_curve_for_each_tool_that_is_there():
    result, curves = scanning.bench_sizes(TINY, 0)
    assert list(curves) == ["primkit", "shapely (GEOS)"]
    assert all(sizes == [4, 8] and min(costs) > 0 for sizes, costs in curves.values())
    assert [row.size for row in result.rows if row.tool.endswith("shapes")] == [4, 8, 4, 8]
    assert sum(row.cost is None for row in result.rows) == 3


def test_poses_on_a_tiled_board_lie_outside_its_shapes_on_every_map():
    maps = list(scanning.four_shape_maps(3).values())
    board = scanning.tiled(28, maps)
    poses = scanning.poses_on_tiles(board, maps, 200, np.random.default_rng(0))
    assert poses.shape == (600, 3)
    assert not pk.scan(board, poses).inside.any()
    assert len(np.unique(np.round(poses[:, :2] - 0.0), axis=0)) == 7


def test_work_depends_on_the_seed_alone():
    world = next(iter(scanning.four_shape_maps(1).values()))
    same, again, other = (scanning.poses_outside(world, 50, np.random.default_rng(seed)) for seed in (1, 1, 2))
    assert np.array_equal(same, again)
    assert not np.array_equal(same, other)


def test_the_drive_keeps_clear_of_the_shapes_and_fills_the_grid():
    world = next(iter(scanning.four_shape_maps(1).values()))
    poses = driving.drive(world, pk.Lidar())
    assert min(shape.signed_distance(poses[:, :2]).min() for shape in world.shapes) > driving.BODY
    steps = np.hypot(*np.diff(poses[:, :2], axis=0).T)
    assert np.median(steps) == pytest.approx(driving.SPEED * 0.1)
    counts, taken = driving._timed(world, pk.Lidar(), 3, 0)
    assert taken.shape == (3, 4)
    assert ((counts >= driving.FEWEST) & (counts <= driving.MOST)).all()


def test_imports_are_compared_with_numpy_and_shapely():
    result = processes.bench_import(TINY, 0)
    assert [row.ratio is None for row in result.rows] == [True, False, False]


def test_memory_of_many_scans_counts_their_ranges():
    result = processes.bench_memory(replace(TINY, many=200_000), 0)
    in_blocks, at_once = result.rows
    if at_once.cost is None:
        pytest.skip("this system does not tell the peak of memory")
    assert at_once.cost.median - at_once.facts["before [MB]"] > 150  # 160 MB of ranges
    assert in_blocks.cost.median - in_blocks.facts["before [MB]"] < 0.5 * (
        at_once.cost.median - at_once.facts["before [MB]"]
    )


def test_study_finds_the_same_on_two_processes():
    one, two = processes.bench_study(TINY, 0).rows
    assert one.ratio is None
    assert two.facts["same rows"] == "yes"
    if "MB at the end" in one.facts:
        assert 50 < one.facts["MB after a tenth"] <= one.facts["MB at the end"]


# --- the command --------------------------------------------------------------------------------------------


@pytest.fixture
def tiny(monkeypatch):
    monkeypatch.setattr("tests.benchmarks.bench.effort.QUICK", TINY)


@pytest.mark.usefixtures("tiny", "without_peers")
def test_the_command_prints_tables_and_writes_them(tmp_path, capsys):
    assert main(["kernels", "sizes", "--quick", "--out", str(tmp_path / "bench")]) == 0
    out, err = capsys.readouterr()
    assert err == ""
    assert out.index("Machine") < out.index("One line, one circle") < out.index("Larger boards") < out.index("Wrote")
    rows = list(csv.DictReader(io.StringIO((tmp_path / "bench" / "bench.csv").read_text(encoding="utf-8"))))
    assert {row["bench"] for row in rows} == {"kernels", "sizes"}
    assert (tmp_path / "bench" / "bench.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.usefixtures("tiny", "without_peers")
def test_without_a_folder_nothing_is_written(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["kernels", "--quick"]) == 0
    assert "Wrote" not in capsys.readouterr().out
    assert list(tmp_path.iterdir()) == []


@pytest.mark.usefixtures("tiny", "without_peers")
def test_without_sizes_there_is_no_figure(tmp_path, capsys):
    assert main(["shapes", "scan", "shapes", "--quick", "--out", str(tmp_path)]) == 0
    assert capsys.readouterr().out.count("Finding all shapes") == 1
    assert [path.name for path in tmp_path.iterdir()] == ["bench.csv"]


@pytest.mark.parametrize("name", command.NAMES)
def test_every_name_has_a_benchmark_in_the_help(name):
    assert f"\n  {name} " in command.EXAMPLES


def test_all_are_run_when_none_is_named(monkeypatch):
    ran = []
    monkeypatch.setattr(command, "_run", lambda name, effort, _: ran.append((name, effort)) or (RESULT, {}))
    list(command.texts([], "0", quick=False, seed=0, out=None))
    assert ran == [(name, FULL) for name in command.NAMES]


def test_help_answers_at_once_and_fits_the_screen(capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    assert main(["--help"]) == 0
    out = capsys.readouterr().out
    assert out.isascii()
    assert max(map(len, out.splitlines())) <= 88
    code = (
        "import sys; from tests.benchmarks.__main__ import main; main(['--help'])\n"
        "print([name for name in ('numpy', 'scipy', 'sklearn', 'matplotlib', 'joblib') if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=ROOT, check=True)
    assert done.stdout.splitlines()[-1] == "[]"


NAMES = "scan, sizes, memory, shapes, kernels, live, import, study"


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        ("scans", f"argument NAME: must be one of {NAMES}, got 'scans'; did you mean 'scan'?"),
        ("--quik", "there is no option '--quik'; did you mean '--quick'?"),
        ("--seed -1", "argument --seed: must be a whole number >= 0, got '-1'"),
    ],
    ids=["name", "option", "seed"],
)
def test_refusals_are_one_sentence(words, sentence, capsys):
    assert main([*words.split()]) == 2
    assert capsys.readouterr().err == f"benchmarks: {sentence} (see benchmarks --help)\n"


# --- the figure ---------------------------------------------------------------------------------------------

CURVES = {f"tool {k}": ([4, 40, 400], [k + 1.0, 3.0 * (k + 1), 10.0 * (k + 1)]) for k in range(len(TOOLS))}


def test_each_tool_has_a_color_a_marker_and_a_place_in_the_legend():
    ax = plot_bench(CURVES)
    looks = [(line.get_color(), line.get_marker()) for line in ax.lines]
    assert len({color for color, _ in looks}) == len({marker for _, marker in looks}) == len(CURVES)
    assert [text.get_text() for text in ax.get_legend().get_texts()] == list(CURVES)


def test_the_figure_has_logarithmic_scales_and_says_what_was_found():
    (ax,) = bench_figure(CURVES).axes
    assert (ax.get_xscale(), ax.get_yscale()) == ("log", "log")
    assert ax.get_title(loc="left") == "tool 0: 1 µs for 4 shapes, 10 µs for 400"
    assert plt.get_fignums() == []


@pytest.mark.parametrize(
    "curves", [{}, {"a": ([], [])}, {"a": ([4], [0.0])}, {"a": ([0], [1.0])}], ids=["none", "empty", "cost", "size"]
)
def test_what_cannot_be_drawn_is_refused(curves):
    with pytest.raises(ValueError, match=exactly("curves must hold at least one tool with sizes and costs above zero")):
        plot_bench(curves)
