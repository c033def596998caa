"""The command line: what it prints and writes, and how it refuses: one sentence, exit code 2, never a traceback."""

import errno
import json
import os
import re
import signal
import subprocess
import sys
import time
import tomllib
from pathlib import Path

import pytest

import primkit.study
from primkit.__main__ import main
from primkit.commands.words import exit_code
from primkit.formats import load_found, load_world, save_world
from primkit.shapes import Circle, Polygon
from primkit.study import JOURNAL, repeat
from primkit.world import World, random_world

ROOT = Path(__file__).resolve().parent.parent
posix = pytest.mark.skipif(os.name != "posix", reason="signals and closed pipes work differently on Windows")


def command(*words, warnings="error"):
    return [sys.executable, "-W", warnings, "-m", "primkit", *map(str, words)]


def fresh(*words, **more):
    """What a new process prints and returns; it runs at the top of the repository."""
    return subprocess.run(command(*words), capture_output=True, cwd=ROOT, check=False, timeout=120, **more)


@pytest.fixture(autouse=True)
def here(tmp_path, monkeypatch):
    """Every test works in a folder of its own."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def maps(here):
    """Two small maps in a folder."""
    (here / "maps").mkdir()
    save_world(World([Circle((0.1, 0.0), 0.06)]), here / "maps" / "one.geojson")
    save_world(random_world(2, rng=3), here / "maps" / "two.json")
    (here / "maps" / "notes.txt").write_text("no map")
    return here / "maps"


# --- help and version ---------------------------------------------------------------------------------------

HELP = {
    "": [
        "usage: primkit [-h] [--version] COMMAND ...",
        "map       simulate a board, map it, and compare with the truth",
        "study     repeat the paper's Tables 1 to 4, or map many boards of yours",
        "make-map  write a random board to a GeoJSON file",
        "primkit make-map --shapes 6 --style free --out room.geojson",
    ],
    "map": [
        "usage: primkit map [-h] [--shapes N] [--seed S] [--style paper|free|any]",
        "number of shapes on a board of 1 m x 1 m (default: 4)",
        "seed of all that is random, a whole number (default: 7)",
        "paper: upright, at most 4 shapes; free: at any angle; any: other polygons too (default: paper)",
        "a board of your own, GeoJSON (default: a random one)",
        "the method: ours, or as published (default: robust)",
        "standard deviation of the ranges in mm (default: 0)",
        "share of beams with a random range, 0 to 1 (default: 0)",
        "folder for map.png, found.geojson and truth.geojson (default: out)",
        "primkit map --settings paper           the published method",
    ],
    "study": [
        "GeoJSON files, or folders of them (default: the paper's 34 maps)",
        "on way-points, along scripted drives, or both (default: automatic)",
        "the method: ours, as published, or both (default: both)",
        "number of processes (default: one on each core)",
        "dask cluster that does the work (default: this machine)",
        "forget the journal of earlier runs",
        "Once stopped, a study continues when the same command is given again",
    ],
    "make-map": [
        "least distance between two shapes in mm (default: 50)",
        "circle, triangle, rectangle or pentagon, for each shape; in the style any also polygon, star, L ... "
        "(default: drawn)",
        "the file; one that is there is replaced (default: map.geojson)",
    ],
    "lessons": ["usage: primkit lessons [-h] DIR", "A lesson that is there already stays as it is."],
    "doctor": ["It changes nothing, and asks nobody on the network."],
    "teach": [
        "usage: primkit teach [-h] COMMAND ...",
        "new-course  make a course folder for nbgrader",
        "primkit teach release ps1              release/ps1: for your students",
        "The course folder is nbgrader's own: all its commands work in it as well",
    ],
    "teach new-course": ["a new folder, or an empty one", "(default: those of the project)"],
    "teach grade": [
        "the problem set, a folder in source/",
        "the course folder (default: the folder you are in)",
        "only this one; may be repeated",
        "Grading runs the code that students hand in. It runs in a process of its own",
        'every report says "unprotected"',
        "docker run --rm --network none --memory 6g",
    ],
    "teach leaks": ["notebooks, wheels, folders (default: release)"],
}


@pytest.mark.parametrize(("name", "phrases"), HELP.items(), ids=lambda value: value if isinstance(value, str) else "")
def test_help(name, phrases, capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    assert main([*name.split(), "--help"]) == 0
    out, err = capsys.readouterr()
    told = " ".join(out.split())
    assert [phrase for phrase in phrases if " ".join(phrase.split()) not in told] == []
    assert err == ""
    assert out.isascii()
    assert max(map(len, out.splitlines())) <= 88


def test_no_command_shows_the_help(capsys):
    assert main([]) == 0
    assert capsys.readouterr().out.startswith("usage: primkit [-h] [--version] COMMAND ...")


def test_version(capsys):
    assert main(["--version"]) == 0
    assert capsys.readouterr().out == f"primkit {primkit.__version__}\n"


def test_help_loads_nothing_heavy():
    code = (
        "import sys; from primkit.__main__ import main; main(['map', '--help'])\n"
        "print([name for name in ('numpy', 'scipy', 'sklearn', 'matplotlib', 'joblib') if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=ROOT, check=True)
    assert done.stdout.splitlines()[-1] == "[]"


def test_a_board_is_drawn_without_scipy_and_matplotlib(tmp_path):
    code = (
        f"import sys; from primkit.__main__ import main; main(['make-map', '--out', {str(tmp_path / 'a.json')!r}])\n"
        "print([name for name in ('scipy', 'sklearn', 'matplotlib', 'joblib') if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=ROOT, check=True)
    assert done.stdout.splitlines()[-1] == "[]"


# --- lessons ------------------------------------------------------------------------------------------------


@pytest.mark.usefixtures("here")
def test_what_comes_next_can_be_pasted_from_a_folder_with_a_space(capsys):
    assert main(["lessons", "my lessons"]) == 0
    assert capsys.readouterr().out.endswith(f'Next   jupyter lab "{Path("my lessons", "00_start_here.ipynb")}"\n')
    assert main(["make-map", "--out", "my map.geojson"]) == 0
    assert capsys.readouterr().out.endswith('Next   primkit map --map "my map.geojson"\n')


def test_a_package_that_is_not_installed_is_named(capsys):
    """Such as nbgrader, which students' environments do not have."""
    assert exit_code(lambda: __import__("no_such_package")) == 2
    told = capsys.readouterr().err
    assert told.startswith("primkit: no_such_package is not installed: run primkit doctor; ")
    assert told.endswith('-m pip install "primkit-lab[teach]"\n')
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["optional-dependencies"]
    assert {"teach", "cluster", "ros"} <= set(extras)  # what install_line is asked for
    with pytest.raises(ModuleNotFoundError, match=r"primkit\.nowhere"):  # ours: an error in the kit itself
        exit_code(lambda: __import__("primkit.nowhere"))


def test_lessons_are_written_and_nobody_s_work_is_lost(here, capsys):
    (here / "mine").mkdir()
    (here / "mine" / "00_start_here.ipynb").write_text("what a student wrote")
    assert main(["lessons", "mine"]) == 0
    lessons = sorted(path.name for path in (ROOT / "notebooks").glob("*.ipynb"))
    out = capsys.readouterr().out
    assert out.startswith(
        f"Wrote  {len(lessons) - 1} lessons into mine; 1 there already, which stay\nNext   jupyter lab "
    )
    assert sorted(path.name for path in (here / "mine").iterdir()) == [*lessons, "recordings"]
    read = [path.name for path in (ROOT / "notebooks" / "recordings").iterdir()]
    assert {path.name for path in (here / "mine" / "recordings").iterdir()} == set(read) > {"arena.log.gz"}
    assert (here / "mine" / "00_start_here.ipynb").read_text() == "what a student wrote"


# --- map ----------------------------------------------------------------------------------------------------


def test_map_as_a_newcomer_sees_it(here, capsys):
    assert main(["map", "--shapes", "2", "--seed", "3"]) == 0
    out, err = capsys.readouterr()
    board, robot, lidar, found, times, *rest = out.splitlines()
    assert board == "Board  2 shapes: pentagon, circle; 1 m x 1 m (random: seed 3, paper style)"
    assert re.fullmatch(r"Robot  77 way-points, \d+ skipped inside a shape(: (\(-?0\.\d\d, -?0\.\d\d\) )+m)?", robot)
    assert re.fullmatch(r"LiDAR  \d+ hits on \d+ cells of 1 mm; range noise 0 mm", lidar)
    assert found == "Found  2 shapes with the settings ROBUST"
    assert re.fullmatch(r"Time   robot 7\.7 s \(all way-points x 0\.1 s\), computing \d+\.\d\d s", times)
    assert rest[0] == ""
    assert rest[1].startswith("true shape  found as")
    assert "weighted accuracy 1.000 = 0.4 x shape 1.000 + 0.3 x centre 1.000" in out
    wrote = ", ".join(str(Path("out", name)) for name in ("map.png", "found.geojson", "truth.geojson"))
    reads = "in Python, primkit.load_found and load_world read the two maps."
    assert rest[-2:] == [f"Wrote  {wrote}", f"Next   open {Path('out', 'map.png')} to see it all; {reads}"]
    assert err == ""
    assert sorted(path.name for path in (here / "out").iterdir()) == ["found.geojson", "map.png", "truth.geojson"]


def test_map_files_can_be_read_back():
    assert main(["map", "--shapes", "2", "--seed", "3", "--noise", "1", "--out", "a/b"]) == 0
    assert load_world("a/b/truth.geojson") == random_world(2, rng=3)
    found = load_world("a/b/found.geojson")
    assert sorted(shape.kind for shape in found.shapes) == ["circle", "pentagon"]
    again = load_found("a/b/found.geojson")
    assert [one.shape for one in again] == list(found.shapes)
    assert all(one.certain for one in again)
    features = json.loads(Path("a/b/found.geojson").read_bytes())["features"]
    assert [feature["properties"]["kind"] for feature in features[2:]] == ["strays"] * bool(len(again.strays))
    for feature in features[:2]:
        known = feature["properties"]
        assert 0 < known["rms"] < 0.003
        assert known["n_points"] > 50
        assert known["margin"] > 10
        assert len(known["seen"]) == (1 if known["kind"] == "circle" else 5)
    assert Path("a/b/map.png").read_bytes().startswith(b"\x89PNG")


def test_map_of_a_walled_board_tells_all_there_is(capsys):
    save_world(World([Circle((-0.2, 0.1), 0.08)], walls=True), "room.geojson")
    assert main(["map", "--map", "room.geojson", "--spurious", "0.01"]) == 0
    out = capsys.readouterr().out
    assert re.search(r"\nFound  1 shape, 4 walls, \d+ strays with the settings ROBUST\n", out)
    assert re.search(r"\nBeside the shapes: 4 walls, all right; \d+ strays, (none|\d+) of them on an outline\.\n", out)
    again = load_found("out/found.geojson")
    assert len(again.walls) == 4
    assert load_world("out/found.geojson").shapes == tuple(one.shape for one in again)


@pytest.mark.usefixtures("maps")
def test_map_of_a_file_with_the_published_method(capsys):
    assert main(["map", "--map", "maps/two.json", "--settings", "paper", "--out", "out"]) == 0
    out = capsys.readouterr().out
    assert "1 m x 1 m (maps/two.json)" in out.replace("\\", "/")
    assert "with the settings PAPER, being told that there are 2\n" in out
    assert load_world("out/truth.geojson") == load_world("maps/two.json")


@pytest.mark.filterwarnings("ignore::primkit.arguments.LikelyWrong")
@pytest.mark.parametrize("words", [["--shapes", "0"], ["--map", "wall.geojson"]], ids=["empty board", "out of sight"])
def test_map_where_nothing_is_to_be_found(words, capsys):
    far = Polygon([(0.9, 0.9), (1.0, 0.9), (1.0, 1.0)])
    save_world(World([far]), "wall.geojson")
    assert main(["map", *words]) == 0
    assert "Found  no shapes" in capsys.readouterr().out
    assert load_world("out/found.geojson").shapes == ()


def test_map_with_a_bad_sensor(capsys):
    assert main(["map", "--shapes", "1", "--noise", "3.5", "--spurious", "0.02", "--settings", "paper"]) == 0
    assert "range noise 3.5 mm" in capsys.readouterr().out


def test_two_fresh_processes_write_the_same_bytes(tmp_path):
    words = ("map", "--shapes", "4", "--noise", "2", "--spurious", "0.01", "--out")
    done = [fresh(*words, tmp_path / name) for name in ("a", "b")]
    assert [(d.returncode, d.stderr) for d in done] == [(0, b"")] * 2
    for name in ("map.png", "found.geojson", "truth.geojson"):
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes(), name
    told = [re.sub(rb"computing [\d.]+ s", b"", d.stdout.split(b"\nWrote")[0]) for d in done]
    assert told[0] == told[1]


def test_a_map_that_cannot_be_written_leaves_the_old_one(monkeypatch, capsys):
    assert main(["map", "--shapes", "1"]) == 0
    before = {path.name: path.read_bytes() for path in Path("out").iterdir()}
    capsys.readouterr()

    def full(*_, **__):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    assert main(["map", "--shapes", "1", "--seed", "8"]) == 2
    assert capsys.readouterr().err == "primkit: map.png: cannot be written: No space left on device\n"
    assert {path.name: path.read_bytes() for path in Path("out").iterdir()} == before


# --- study --------------------------------------------------------------------------------------------------


@pytest.mark.usefixtures("maps")
def test_study_prints_tables_and_writes_them(capsys):
    assert main(["study", "--maps", "maps", "--jobs", "1"]) == 0
    out, err = capsys.readouterr()
    assert "Table 1. One shape, automatic movement\n" in out
    assert "\n2 shapes, 1 map\n PAPER as published " in out
    assert "\n ROBUST within 5 mm   1.000 " in out
    assert "Maps   2 with PAPER and ROBUST; 0 of 4 results were in the journal already\n" in out
    names = ["table-1.csv", "table-2.csv", "rows.csv", JOURNAL]
    assert f"Wrote  {', '.join(str(Path('out', name)) for name in names)}\n" in out
    assert sorted(path.name for path in Path("out").iterdir()) == sorted(names)
    lines = Path("out/rows.csv").read_text(encoding="utf-8").splitlines()
    assert [line.split(",")[:2] for line in lines[1:]] == [
        ["one", "PAPER"],
        ["one", "ROBUST"],
        ["two", "PAPER"],
        ["two", "ROBUST"],
    ]
    assert (out.isascii(), err) == (True, "")


def test_study_repeats_the_paper(capsys, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    suite = repeat.published_suite()
    monkeypatch.setattr(repeat, "published_suite", lambda: {"1_quadrado": suite["1_quadrado"]})
    assert main(["study", "--rows", "--movement", "both", "--settings", "paper", "--jobs", "1"]) == 0
    out, _ = capsys.readouterr()
    assert (
        "\nrectangle, 1 map\n recorded           0.850  1.000  1.000   0.500       9.48\n PAPER repeated     0.850"
        in out
    )
    assert "1_quadrado, automatic  0.85 1.00 1.00 0.50  0.85 1.00 1.00 0.50  the same" in out
    assert "The same as recorded in all four numbers: 1 of 1 rows." in out
    assert "four keys" in out
    assert sorted(path.name for path in Path("out").iterdir()) == [
        *("journal.jsonl", "row-by-row.csv", "rows.csv", "seen.csv", "table-1.csv", "table-3.csv")
    ]


@pytest.mark.usefixtures("maps")
def test_study_continues_or_starts_anew(capsys):
    words = ["study", "--maps", "maps", "--jobs", "1", "--settings"]
    told = []
    for more in (["robust"], ["both"], ["robust", "--fresh"]):
        assert main([*words, *more]) == 0
        told.append(capsys.readouterr().out.split("Maps   ")[1].splitlines()[0])
    assert told == [
        "2 with ROBUST; 0 of 2 results were in the journal already",
        "2 with PAPER and ROBUST; 2 of 4 results were in the journal already",
        "2 with ROBUST; 0 of 2 results were in the journal already",
    ]
    assert len(Path("out", JOURNAL).read_bytes().splitlines()) == 2


@pytest.mark.usefixtures("maps")
def test_study_takes_files_too(capsys):
    assert main(["study", "--maps", "maps/two.json", "maps/one.geojson", "--settings", "robust", "--jobs", "1"]) == 0
    assert "Maps   2 with ROBUST" in capsys.readouterr().out


@pytest.mark.usefixtures("maps")
def test_study_drives(capsys):
    words = ["study", "--maps", "maps", "--settings", "robust", "--jobs", "1", "--movement"]
    assert main([*words, "manual"]) == 0
    out, err = capsys.readouterr()
    assert [line[:7] for line in out.splitlines() if line.startswith("Table")] == ["Table 3", "Table 4"]
    assert "\nOurs are scripted drives: " in out
    assert re.search(r"\nseen on 60 % or more: 3 of 3 shapes, on 2 maps\n ROBUST within 5 mm  [01]\.\d{3} ", out)
    names = ["table-3.csv", "table-4.csv", "rows.csv", "seen.csv", JOURNAL]
    assert f"Wrote  {', '.join(str(Path('out', name)) for name in names)}\n" in out
    assert len(Path("out/seen.csv").read_text(encoding="utf-8").splitlines()) == 4
    assert (out.isascii(), err) == (True, "")
    assert main([*words, "both"]) == 0
    out, _ = capsys.readouterr()
    assert [line[6:7] for line in out.splitlines() if line.startswith("Table")] == list("1234")
    assert "Maps   2 with ROBUST; 2 of 4 results were in the journal already\n" in out


def test_two_fresh_studies_agree_in_all_but_time(maps, tmp_path):
    files = {}
    for jobs in (1, 2):
        done = fresh("study", "--maps", maps, "--settings", "robust", "--jobs", jobs, "--out", tmp_path / str(jobs))
        assert (done.returncode, done.stderr) == (0, b"")
        lines = (tmp_path / str(jobs) / "rows.csv").read_bytes().splitlines()
        files[jobs] = [line.rsplit(b",", 1)[0] for line in lines]  # the last column is the measured time
    assert files[1] == files[2]


@posix
def test_study_stopped_by_ctrl_c_continues(tmp_path):
    words = command("study", "--out", tmp_path, "--jobs", "2")
    here = signal.signal(signal.SIGINT, signal.default_int_handler)  # who ignores it has deaf children
    process = subprocess.Popen(words, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, start_new_session=True)
    signal.signal(signal.SIGINT, here)
    journal = tmp_path / JOURNAL
    for _ in range(3000):
        # A few rows: both workers have started, and know what to do when they are stopped.
        if process.poll() is not None or (journal.exists() and journal.read_bytes().count(b"\n") >= 6):
            break
        time.sleep(0.01)
    os.killpg(process.pid, signal.SIGINT)  # as a terminal does: the workers get it as well
    out, err = process.communicate(timeout=60)
    stopped = f"primkit: stopped; the same command continues, with what {journal} holds\n"
    assert (process.returncode, err.decode(), out) == (130, stopped, b"")
    assert journal.read_bytes().endswith(b"\n")


# --- make-map -----------------------------------------------------------------------------------------------


def test_make_map(capsys):
    assert main(["make-map", "--shapes", "3", "--seed", "11", "--out", "a.geojson"]) == 0
    assert load_world("a.geojson") == random_world(3, rng=11)
    assert capsys.readouterr().out == (
        f"Board  3 shapes: {', '.join(s.kind for s in random_world(3, rng=11).shapes)}"
        " (random: seed 11, paper style, gap 50 mm)\nWrote  a.geojson\nNext   primkit map --map a.geojson\n"
    )


@pytest.mark.parametrize(
    ("words", "world"),
    [
        ([], {"n": 4, "rng": 7}),
        (["--kinds", "circle", "pentagon"], {"n": 2, "kinds": ("circle", "pentagon"), "rng": 7}),
        (["--shapes", "6", "--style", "free", "--gap", "30"], {"n": 6, "style": "free", "gap": 0.03, "rng": 7}),
        (["--shapes", "0"], {"n": 0, "rng": 7}),
        (
            ["--style", "any", "--walls", "--kinds", "L"],
            {"n": 1, "style": "any", "kinds": ["L"], "walls": True, "rng": 7},
        ),
    ],
    ids=["defaults", "kinds tell the number", "free", "empty", "any, with walls"],
)
def test_make_map_draws_what_random_world_draws(words, world):
    assert main(["make-map", *words]) == 0
    assert load_world("map.geojson") == random_world(**world)


# --- refusals -----------------------------------------------------------------------------------------------


def test_a_map_with_walls_says_what_they_cost(capsys):
    save_world(World([Circle((0.1, 0), 0.05)], walls=True), "b.geojson")
    assert main(["map", "--map", "b.geojson"]) == 0
    assert "Robot  77 way-points, 24 skipped inside a shape or beside a wall\n" in capsys.readouterr().out


SEE = {name: f" (see primkit {name} --help)" for name in ("map", "study", "make-map")}
REFUSED = {
    "shapes in words": (
        "map --shapes four",
        f"primkit map: argument --shapes: must be a whole number >= 0, got 'four'{SEE['map']}",
    ),
    "negative shapes": (
        "map --shapes -1",
        f"primkit map: argument --shapes: must be a whole number >= 0, got '-1'{SEE['map']}",
    ),
    "too many shapes": (
        "map --shapes 5",
        "primkit: the paper's style has room for at most 4 shapes, got 5; use --style free for more",
    ),
    "fractional seed": (
        "map --seed 0.5",
        f"primkit map: argument --seed: must be a whole number >= 0, got '0.5'{SEE['map']}",
    ),
    "style": (
        "map --style wild",
        f"primkit map: argument --style: must be paper or free or any, got 'wild'{SEE['map']}",
    ),
    "settings": (
        "map --settings both",
        f"primkit map: argument --settings: must be robust or paper, got 'both'{SEE['map']}",
    ),
    "noise": (
        "map --noise -1",
        f"primkit map: argument --noise: must be a number of millimetres >= 0, got '-1'{SEE['map']}",
    ),
    "noise, not a number": (
        "map --noise nan",
        f"primkit map: argument --noise: must be a number of millimetres >= 0, got 'nan'{SEE['map']}",
    ),
    "noise, infinite": (
        "map --noise inf",
        f"primkit map: argument --noise: must be a number of millimetres >= 0, got 'inf'{SEE['map']}",
    ),
    "share": (
        "map --spurious 1.5",
        f"primkit map: argument --spurious: must be a share from 0 to 1, got '1.5'{SEE['map']}",
    ),
    "file and number": (
        "map --map maps/one.geojson --shapes 2 --style free",
        "primkit: a board is either a file or random: leave out --map or --shapes and --style",
    ),
    "no such file": ("map --map nowhere.geojson", "primkit: nowhere.geojson: there is no such file in {here}"),
    "no map": (
        "map --map maps/notes.txt",
        "primkit: notes.txt: the name of a map must end in .geojson or .json or .wbt or .sdf or .world, got .txt",
    ),
    "damaged map": (
        "map --map bad.geojson",
        "primkit: bad.geojson: must be GeoJSON, got an empty file",
    ),
    "out is a file": (
        "map --out maps/notes.txt",
        "primkit: {notes} must be a folder, got a file or a folder below a file",
    ),
    "study's out is a file": (
        "study --maps maps --out maps/notes.txt",
        "primkit: {notes} must be a folder, got a file or a folder below a file",
    ),
    "no jobs": (
        "study --jobs 0",
        f"primkit study: argument --jobs: must be a whole number >= 1 and at most 1,000, got '0'{SEE['study']}",
    ),
    "a folder without maps": ("study --maps empty", "primkit: empty: must hold maps (.geojson or .json), got none"),
    "no such folder": (
        "study --maps nowhere",
        "primkit: nowhere: there is no such folder in {here}",
    ),
    "two maps of one name": (
        "study --maps maps maps/one.geojson",
        "primkit: maps must have different names, got 3 files with 2 names",
    ),
    "a journal of something else": (
        "study --maps maps --out other",
        "primkit: journal.jsonl, line 1: must be a row of a study, got b'text\\n'",
    ),
    "kinds": (
        "make-map --kinds circle star",
        "primkit: a kind must be one of circle, triangle, rectangle, pentagon, got 'star'",
    ),
    "kinds and number": (
        "make-map --shapes 3 --kinds circle",
        "primkit: kinds must name one kind for each of the 3 shapes, got 1",
    ),
    "no room": (
        "make-map --gap 900",
        "primkit: no room found for 4 shapes with a gap of 0.9 m on a board of 1 m: "
        "ask for fewer shapes, a smaller gap or a larger board",
    ),
    "out without a name": (
        ["map", "--out", ""],
        f"primkit map: argument --out: must be the name of a file or folder, got ''{SEE['map']}",
    ),
    "study's out without a name": (
        ["study", "--out", " "],
        f"primkit study: argument --out: must be the name of a file or folder, got ' '{SEE['study']}",
    ),
    "map without a name": (
        ["map", "--map", ""],
        f"primkit map: argument --map: must be the name of a file or folder, got ''{SEE['map']}",
    ),
    "misspelt command": ("stduy", "primkit: there is no command 'stduy'; did you mean 'study'? (see primkit --help)"),
    "no command": ("fly", "primkit: there is no command 'fly' (see primkit --help)"),
    "misspelt option": (
        "map --shape 3",
        f"primkit map: there is no option '--shape'; did you mean '--shapes'?{SEE['map']}",
    ),
    "misspelt option with its value": (
        "make-map --stile=free",
        f"primkit make-map: there is no option '--stile'; did you mean '--style'?{SEE['make-map']}",
    ),
    "no option": ("map --colour red", f"primkit map: there is no option '--colour'{SEE['map']}"),
    "misspelt option before the command": (
        "--versoin",
        "primkit: there is no option '--versoin'; did you mean '--version'? (see primkit --help)",
    ),
    "one word too many": ("map 4", f"primkit map: there is no place for '4'{SEE['map']}"),
    "a scheduler's address": (
        "study --maps maps --scheduler localhost",
        "primkit: a scheduler's address must look like tcp://192.168.0.2:8786, got 'localhost'",
    ),
    "a scheduler and a number of processes": (
        "study --maps maps --scheduler tcp://127.0.0.1:8786 --jobs 2",
        "primkit: a cluster works with all of its workers: leave out --jobs or --scheduler",
    ),
    "map's ending": (
        "make-map --out map.png",
        "primkit: map.png: the name of a map must end in .geojson or .json or .wbt, got .png",
    ),
    "lessons into a file": (
        "lessons bad.geojson",
        "primkit: bad.geojson must be a folder, got a file or a folder below a file",
    ),
    "map's folder": ("make-map --out no/map.geojson", "primkit: map.geojson: there is no folder {no}"),
}


@pytest.mark.parametrize(("words", "sentence"), REFUSED.values(), ids=REFUSED)
@pytest.mark.usefixtures("maps")
def test_one_sentence_and_exit_code_2(here, words, sentence, capsys):
    (here / "bad.geojson").write_text("")
    (here / "empty").mkdir()
    (here / "other").mkdir()
    (here / "other" / JOURNAL).write_bytes(b"text\n")
    assert main(words.split() if isinstance(words, str) else words) == 2
    out, err = capsys.readouterr()
    assert err == sentence.format(here=here, notes=Path("maps/notes.txt"), no=here / "no") + "\n"
    assert "Traceback" not in out


@pytest.mark.parametrize("words", ["study --maps", "map --shapes", "accuracy --sweeps --maps 3"], ids=str)
def test_words_that_argparse_refuses_are_one_line_too(words, capsys):
    assert main(words.split()) == 2
    out, err = capsys.readouterr()
    assert re.fullmatch(r"primkit (\w+): .* \(see primkit \1 --help\)\n", err)
    assert out == ""


@pytest.mark.parametrize("words", [["map"], ["study"]], ids=["map", "study"])
def test_a_folder_without_permission(words, monkeypatch, capsys):
    def forbidden(*_, **__):
        raise PermissionError(errno.EACCES, "Permission denied")

    monkeypatch.setattr(Path, "mkdir", forbidden)
    assert main([*words, "--out", "locked"]) == 2
    assert capsys.readouterr().err == "primkit: locked: the folder cannot be made: Permission denied\n"


@pytest.mark.usefixtures("maps")
def test_a_journal_without_permission(capsys):
    Path("out", JOURNAL).mkdir(parents=True)  # no file can be opened there, not even by root
    assert main(["study", "--maps", "maps", "--jobs", "1"]) == 2
    err = capsys.readouterr().err
    assert err.startswith(f"primkit: {Path('out', JOURNAL)}: ")
    assert err.count("\n") == 1


@pytest.mark.usefixtures("maps")
def test_an_error_in_a_study_names_the_map(monkeypatch, capsys):
    def broken(*_, **__):
        raise ValueError("the points must be round")

    monkeypatch.setattr(primkit.study.experiment, "find_shapes", broken)
    primkit.study.experiment._warm_up.cache_clear()
    assert main(["study", "--maps", "maps", "--jobs", "1"]) == 2
    told = "primkit: the points must be round (on the map 'one' with the settings 'PAPER')\n"
    assert capsys.readouterr().err == told


def test_ctrl_c_is_130_and_a_sentence(monkeypatch, capsys):
    def stop(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr(primkit.study, "run", stop)
    assert main(["map"]) == 130
    assert capsys.readouterr().err == "primkit: stopped by Ctrl-C\n"


# --- consoles -----------------------------------------------------------------------------------------------


def test_a_console_that_lacks_a_sign_gets_it_spelled_out(tmp_path):
    save_world(World(), tmp_path / "地図.geojson")
    environment = os.environ | {"PYTHONIOENCODING": "cp1252", "PYTHONUTF8": "0"}
    done = fresh("map", "--map", tmp_path / "地図.geojson", "--out", tmp_path / "out", env=environment)
    assert (done.returncode, done.stderr) == (0, b"")
    assert b"\\u5730\\u56f3.geojson" in done.stdout
    missing = fresh("map", "--map", tmp_path / "図.geojson", env=environment)
    assert missing.returncode == 2
    assert missing.stderr.startswith(b"primkit: \\u56f3.geojson: there is no such file in")


@posix
@pytest.mark.parametrize("words", [["--help"], ["map", "--shapes", "0"]], ids=["help", "map"])
def test_a_reader_that_has_gone_is_no_error(tmp_path, words):
    read, write = os.pipe()
    os.close(read)
    more = ["--out", tmp_path] if "map" in words else []
    done = subprocess.run(
        command(*words, *more), stdout=write, stderr=subprocess.PIPE, cwd=ROOT, check=False, timeout=60
    )
    os.close(write)
    assert (done.returncode, done.stderr) == (0, b"")
