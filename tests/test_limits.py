"""Whatever comes in: what is refused is refused in one sentence, what grows has a limit, what is likely wrong is told.

The numbers R1 to R18 are those of the faults that were once seen.
"""

import io
import json
import os
import re
import subprocess
import sys
import threading
import time
import tracemalloc
import warnings
import zipfile
from pathlib import Path
from queue import SimpleQueue

import numpy as np
import pytest

import primkit as pk
from primkit import formats
from primkit.__main__ import main
from primkit.arguments import LikelyWrong, as_points, as_positive, as_rng, short
from primkit.circles import fit_circle
from primkit.commands.words import exit_code
from primkit.formats import Route, files
from primkit.lidar import Scans, as_ranges
from primkit.lines import LINE, find_lines
from primkit.ransac import run_ransac, trials_needed
from primkit.robot import BODY, CLEAR, advance, drive, start_pose, waypoints
from tests.filing import a_scan, refusal, written

ROOT = Path(__file__).resolve().parent.parent
MB = 10**6
posix = pytest.mark.skipif(os.name != "posix", reason="Windows has no such limits or locks")
UNMARKED = pytest.mark.filterwarnings("ignore::primkit.arguments.LikelyWrong")


def taken(function, *args):
    """The most memory that a call takes, in bytes; the call may be refused."""
    tracemalloc.start()
    try:
        function(*args)
    except ValueError:
        pass
    finally:
        most = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
    return most


# --- R1, R10: a file takes a small multiple of its size ---------------------------------------------------------


def bomb(size, claimed):
    """A bzip2 archive whose directory says that its first member has few bytes, whatever it unpacks to."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_BZIP2) as archive:
        for field in formats.scans.SCAN_SHAPES:
            archive.writestr(f"{field}.npy", bytes(size if field == "poses" else 8))
    content = bytearray(buffer.getvalue())
    directory = content.index(b"PK\x01\x02")
    content[directory + 24 : directory + 28] = claimed.to_bytes(4, "little")
    return bytes(content)


def test_r1_an_archive_that_lies_about_its_size_is_refused_at_once(tmp_path):
    path = written(tmp_path, bomb(30 * MB, claimed=136), "a.npz")
    assert path.stat().st_size < 3000
    start = time.process_time()
    assert taken(formats.load_scans, path) < 3 * MB
    assert time.process_time() - start < 1
    assert "an .npz archive of plain arrays" in refusal(formats.load_scans, path)


def test_r1_small_numbers_are_counted_as_the_floats_they_become(tmp_path):
    buffer = io.BytesIO()
    arrays = {"poses": np.zeros((3000, 3)), "angles": np.zeros(3000), "inside": np.zeros(3000, bool)}
    np.savez_compressed(buffer, ranges=np.zeros((3000, 3000), np.int8), **arrays)
    path = written(tmp_path, buffer.getvalue(), "a.npz")
    assert refusal(formats.load_scans, path).startswith("a.npz: must unpack to at most 67,108,864 bytes, got 72,")
    assert taken(formats.load_scans, path) < 30 * MB


def test_r1_an_archive_of_thousands_of_members_is_refused(tmp_path):
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as archive:
        for number in range(1001):
            archive.writestr(str(number), b"")
    assert "cannot be read" in refusal(formats.load_scans, written(tmp_path, buffer.getvalue(), "a.npz"))


HEAD = {"format": "primkit drive", "version": 1}
DENSE = b'{"":0},'  # the text that Python's reader of JSON blows up most


@pytest.mark.parametrize("name", ["a.jsonl", "a.geojson", "a.json"])
def test_r10_dense_text_stays_below_a_multiple_of_its_size(tmp_path, name):
    size = 2 * files.LINE_LIMIT if name == "a.jsonl" else MB // 2
    content = b"[" + DENSE * (size // len(DENSE)) + b"0]\n"
    if name == "a.jsonl":
        lidar = {"beams": 2, "range_min": 0.05, "range_max": 0.3, "noise_std": 0.0, "period": 0.1}
        content = json.dumps({**HEAD, "lidar": {**lidar, "dropout": 0.0, "spurious": 0.0}}).encode() + b"\n" + content
    path = written(tmp_path, content, name)
    load = {"a.jsonl": formats.load_drive, "a.geojson": formats.load_world, "a.json": formats.load_route}[name]
    refused = refusal(load, path)
    assert refused.startswith(f"{name}: ")
    assert taken(load, path) < 30 * len(content) + 2 * MB
    if name == "a.jsonl":
        assert refused == f"a.jsonl: line 2: must be at most 2,097,152 bytes, got {len(content.splitlines()[1]) + 1:,}"
        assert taken(load, path) < 3 * len(content)  # it is not even parsed


@posix
def test_r1_a_file_without_a_size_is_read_no_further_than_the_limit():
    assert refusal(files.bounded_read, Path("/proc/self/maps"), 100) == "maps: must be at most 100 bytes, got 101"


# --- R2, R3: work that would grow without limit -----------------------------------------------------------------

WORK = {
    "period 1e6": (lambda: Route((0, 0, 0), [(6, 6)] * 10, 1e6), "a drive must take at most 20,000,000 steps"),
    "period 1e8": (lambda: drive(pk.World(), [(1, 1)], (0, 0, 0), period=1e8), "is the period in seconds?"),
    "period 1e308": (lambda: Route((0, 0, 0), [(6, 6)], 1e308), "period must be a finite number > 0 and at most"),
    "time 1e8": (lambda: advance(pk.World(), (0, 0, 0), (6, 6), 1e8), "is the time in seconds?"),
    "a board that is full": (lambda: start_pose(pk.World([pk.Circle((0, 0), 9)], 9.9)), "must have room for the robot"),
    "beams": (lambda: pk.Lidar(beams=10**400), "beams must be at most 1,000,000, got 1000"),
    "beams x poses": (
        lambda: pk.scan(pk.World(), np.zeros((2000, 3)), pk.Lidar(beams=10**6)),
        "a scan must have at most 100,000,000 ranges, got 2,000,000,000; scan_blocks takes a few at once",
    ),
    "trials": (lambda: run_ransac([(0, 0)] * 9, LINE, 0.1, trials=10**12), "see trials_needed"),
    "shapes": (lambda: pk.random_world(10**9, style="free"), "n must be at most 1,000, got 1,000,000,000"),
}


@pytest.mark.parametrize(("work", "sentence"), WORK.values(), ids=WORK)
def test_r2_r3_what_would_never_end_is_refused_at_once(work, sentence):
    start = time.process_time()
    refused = refusal(work)
    assert sentence in refused
    assert len(refused) < 160
    assert "\n" not in refused
    assert time.process_time() - start < 1


def test_a_large_board_has_as_many_places_as_one_of_the_paper_s_scale():
    assert len(waypoints(1e30)) == 77
    assert start_pose(pk.World(size=999)).tolist() == [0, 0, 0]
    blocked = pk.World([pk.Circle((0, 0), 0.7)], 9)  # farther out than the first places that are looked at
    steps = np.arange(-100, 101) / 100
    away = np.hypot(*np.meshgrid(steps, steps))
    assert np.hypot(*start_pose(blocked)[:2]) == pytest.approx(away[away >= 0.7 + BODY + CLEAR].min())


def test_memory_that_does_not_suffice_is_a_sentence(capsys):
    def run():
        raise MemoryError

    assert exit_code(run) == 2
    assert capsys.readouterr().err == (
        "primkit: there is not enough memory for this: is a map, a size or a number too large?\n"
    )


# --- R4: scans by hand ------------------------------------------------------------------------------------------

BY_HAND = {
    "NaN": (([(0, 0, 0)], [0.0], [[np.nan]], [False]), "ranges must be >= 0, or inf for no hit, got nan"),
    "-1": (([(0, 0, 0)], [0.0], [[-1.0]], [False]), "ranges must be >= 0, or inf for no hit, got -1"),
    "flat": (([(0, 0, 0)], [0.0], [0.1], [False]), "shapes must be poses (P, 3), angles (B,), ranges (P, B)"),
    "50 angles": (([(0, 0, 0)], np.zeros(50), np.ones((1, 100)), [False]), "got (1, 3), (50,), (1, 100), (1,)"),
    "ragged": (
        ([(0, 0, 0)], [0.0], [[1], [1, 2]], [False]),
        "numbers in an array of shape (P, B), got [[1], [1, 2]]",
    ),
    "text": (
        ([(0, 0, 0)], [0.0], [["0.1"]], [False]),
        "numbers in an array of shape (P, B), got [['0.1']]",
    ),
    "pose": (([(0, np.inf, 0)], [0.0], [[0.1]], [False]), "poses must be finite, got inf"),
    "masked": (
        ([(0, 0, 0)], [0.0], np.ma.masked_greater([[9.0]], 5), [False]),
        "ranges must have no masked values, got 1 of them",
    ),
}


@pytest.mark.parametrize(("arrays", "sentence"), BY_HAND.values(), ids=BY_HAND)
def test_r4_scans_by_hand_are_checked(arrays, sentence):
    assert sentence in refusal(Scans, *arrays)


def test_r4_lists_are_scans_and_zero_is_no_hit():
    scans = Scans([(0, 0, 0)], [0.0, 1.0, 2.0], [[0.2, 0, float("inf")]], [False])
    assert scans.points().tolist() == [[0.2, 0.0]]
    assert scans.hits.tolist() == [[True, False, False]]


def test_r4_a_drivers_words_for_nothing_have_one_meaning():
    assert as_ranges([[np.nan, 0, -1, np.inf, 0.3, 0.29]], 0.3).tolist() == [[np.inf] * 5 + [0.29]]


# --- R5, R8: arrays and numbers of other kinds --------------------------------------------------------------------

ODD = {
    "masked points": (lambda: fit_circle(np.ma.masked_greater([[0, 1], [1, 0], [9, 9]], 5)), "no masked values"),
    "masked poses": (lambda: pk.scan(pk.World(), np.ma.masked_greater([[0, 0, 9.0]], 5)), "no masked values"),
    "a masked row in a list": (lambda: as_points([np.ma.masked_greater([1, 9], 5)]), "got 1 of them"),
    "a masked number": (lambda: as_positive(np.ma.masked, "radius"), "radius must be a finite number > 0, got masked"),
    "RandomState": (lambda: as_rng(np.random.RandomState(0)), "rng must be a whole number >= 0 or a numpy Generator"),
    "rng True": (lambda: as_rng(True), "got True"),
    "a generator that gives no others": (
        lambda: pk.scan(pk.World(), [(0, 0, 0)], pk.Lidar(noise_std=0.001), rng=0.5),
        "rng must be a whole number >= 0 or a numpy Generator, got 0.5",
    ),
    "left_over": (lambda: find_lines([(0, 0)], 0.1, left_over="0.1"), "left_over must be between 0 and 1, got '0.1'"),
    "share": (lambda: trials_needed("0.5", 2), "inlier_share must be above 0 and at most 1, got '0.5'"),
    "confidence": (lambda: trials_needed(0.5, 2, "0.9"), "confidence must be between 0 and 1, got '0.9'"),
    "weights": (lambda: fit_circle([(0, 0), (1, 0), (0, 1)], weights="abc"), "weights must be numbers in an array"),
    "weights, dates": (
        lambda: fit_circle([(0, 0), (1, 0), (0, 1)], weights=np.zeros(3, "M8[s]")),
        "weights must be numbers in an array of shape (3,)",
    ),
    "1e160": (lambda: pk.find_shapes(np.full((9, 2), 1e160)), "points must be finite and at most 1e+50, got"),
    "bools": (lambda: as_points(np.ones((3, 2), bool)), "points must be numbers in an array of shape (N, 2)"),
    "dates": (lambda: as_points(np.zeros((3, 2), "M8[s]")), "points must be numbers in an array of shape (N, 2)"),
    "durations": (lambda: as_positive(np.timedelta64(3, "s"), "period"), "period must be a finite number > 0"),
    "texts as objects": (lambda: as_points(np.array([["1", 2]], object)), "points must be numbers in an array"),
    "no path": (lambda: formats.load_world(None), "the name of a map must be a text or a path, got None"),
    "a path with a zero byte": (lambda: formats.load_world("a\0.json"), "the name of a map must be a text or a path"),
    "a path of bytes": (lambda: formats.save_world(pk.World(), b"a.json"), "must be a text or a path, got b'a.json'"),
}


@pytest.mark.parametrize(("call", "sentence"), ODD.values(), ids=ODD)
def test_r5_r8_odd_arguments_get_one_sentence(call, sentence):
    assert sentence in refusal(call)


def test_a_masked_array_without_a_mask_and_exact_numbers_are_numbers():
    from decimal import Decimal
    from fractions import Fraction

    assert as_points(np.ma.array([[1.0, 2.0]])).tolist() == [[1, 2]]
    assert as_points([(Fraction(1, 2), Decimal("0.25"))]).tolist() == [[0.5, 0.25]]


# --- R6, R11: the command line ------------------------------------------------------------------------------------


@posix
def test_r6_without_a_stdout_the_command_does_its_work(tmp_path):
    line = f'"{sys.executable}" -m primkit make-map --seed 3 --out a.json >&-'
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run(line, shell=True, cwd=tmp_path, env=environment, stderr=subprocess.PIPE, check=False)
    assert (done.returncode, done.stderr) == (0, b"")
    assert len(formats.load_world(tmp_path / "a.json").shapes) == 4


@pytest.mark.filterwarnings("always::primkit.arguments.LikelyWrong")
def test_r3_a_map_in_millimetres_is_told_on_the_command_line(tmp_path, capsys):
    ring = [[100, 100], [200, 100], [100, 200], [100, 100]]
    shape = {"type": "Feature", "geometry": {"type": "Polygon", "coordinates": [ring]}}
    path = written(tmp_path, {"type": "FeatureCollection", "size": 1000, "features": [shape]}, "a.json")
    assert main(["map", "--map", str(path), "--out", str(tmp_path)]) == 0
    assert capsys.readouterr().err == "primkit: a board is 1000 m wide: is it in millimetres?\n"


@pytest.mark.filterwarnings("always::primkit.arguments.LikelyWrong")
def test_r7_what_is_likely_wrong_is_a_sentence_on_the_command_line(capsys):
    assert exit_code(lambda: pk.World([pk.Circle((200, 100), 20)]) and None) == 0
    told = "Circle(center=(200, 100), radius=20) lies off the board of 1 m: is it in millimetres?"
    assert capsys.readouterr().err == f"primkit: {told}\n"


LONG = {
    "digits": 10**400,
    "more": 10**5000,
    "text": "x" * 10**6,
    "rows": [[0] * 999] * 999,
    "array": np.zeros((99, 99)),
}


@pytest.mark.parametrize("name", LONG)
def test_r11_whatever_a_value_is_it_is_shown_on_a_line(name):
    assert len(short(LONG[name])) <= 60
    assert "\n" not in short(LONG[name])


def test_r11_what_is_nested_too_deeply_is_shown():
    deep = []
    for _ in range(10**5):
        deep = [deep]
    assert short(deep) == "[[[[[[[[[...]]]]]]]]]"
    while deep:  # taken apart from outside, for Python's own way to forget it goes as deep as it is
        deep = deep.pop()


# --- R7: what is likely wrong -------------------------------------------------------------------------------------

FLAT = pk.Polygon([(-2, -1), (2, -1), (2, 1), (-2, 1)])
LIKELY = {
    "tolerance": (lambda: pk.evaluate([], pk.World(), 5), "tolerance is 5 m on a board of 1 m: is it in millimetres?"),
    "gate": (lambda: pk.evaluate([], pk.World(), gate=100), "gate is 100 m on a board of 1 m: is it in millimetres?"),
    "noise": (lambda: pk.Lidar(noise_std=5), "noise_std is 5 m: is it in millimetres?"),
    "range": (lambda: pk.Lidar(range_max=8000), "range_max is 8000 m: is it in millimetres?"),
    "heading": (lambda: pk.scan(pk.World(), [(0, 0, 90)]), "a heading is 90 rad: is it in degrees?"),
    "heading by hand": (lambda: Scans([(0, 0, -45)], [0.0], [[1]], [False]), "a heading is -45 rad: is it in degrees?"),
    "angles": (lambda: Scans([(0, 0, 0)], [359.0], [[1]], [False]), "angles reach 359 rad: are they in degrees?"),
    "ranges": (lambda: Scans([(0, 0, 0)], [0.0], [[2500]], [False]), "ranges reach 2500 m: are they in millimetres?"),
    "off the board": (lambda: pk.World([pk.Circle((2, 0), 0.1)]), "lies off the board of 1 m"),
    "on each other": (lambda: pk.World([pk.Circle((0, 0), 0.1), pk.Circle((0.1, 0), 0.1)]), "lie on each other"),
    "twice": (lambda: pk.World([pk.Circle((0, 0), 0.1)] * 2), "lie on each other"),
    "across each other": (
        lambda: pk.World(
            [pk.Polygon([(-2, -1), (2, -1), (2, 1), (-2, 1)]), pk.Polygon([(-1, -2), (1, -2), (1, 2), (-1, 2)])], 9
        ),
        "lie on each other",
    ),
}


@pytest.mark.parametrize(("call", "sentence"), LIKELY.values(), ids=LIKELY)
def test_r7_what_is_likely_wrong_is_told_once_and_where_it_stands(call, sentence):
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        call()
    assert [each.category for each in told] == [LikelyWrong]
    assert sentence in str(told[0].message)
    assert told[0].filename == __file__  # the line of whoever calls, not one of the library's


FINE = {
    "many turns": lambda: pk.scan(pk.World(), [(0, 0, 12.345), (0, 0, 6 * np.pi)]),
    "touching": lambda: pk.World([pk.Circle((0, 0), 0.1), pk.Circle((0.2, 0), 0.1)]),
    "over the edge": lambda: pk.World([pk.Circle((0.5, 0), 0.1)]),
    "no tolerance at all": lambda: pk.evaluate([], pk.World(), 0),
    "a scanner for outdoors": lambda: pk.Lidar(range_max=300, noise_std=0.1),
    "a small board": lambda: pk.World([pk.Circle((0, 0), 0.0001)], 0.001),
}


@pytest.mark.parametrize("call", FINE.values(), ids=FINE)
def test_r7_what_is_fine_is_not_told(call):
    call()  # a warning is an error here


# --- R9: a grid in several threads --------------------------------------------------------------------------------


def test_r9_several_threads_lose_no_point():
    grid, blocks = pk.Grid(), np.random.default_rng(0).uniform(-0.5, 0.5, (8, 60, 50, 2))
    before = sys.getswitchinterval()
    sys.setswitchinterval(1e-6)
    try:
        threads = [threading.Thread(target=lambda own=own: [grid.add(points) for points in own]) for own in blocks]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
    finally:
        sys.setswitchinterval(before)
    alone = pk.Grid()
    alone.add(blocks.reshape(-1, 2))
    assert np.array_equal(grid.cells, alone.cells)


# --- R12, R13: writers --------------------------------------------------------------------------------------------


def leftover(folder, age):
    path = folder / ".primkit-0123456789abcdef.tmp"
    path.write_bytes(b"half")
    os.utime(path, (time.time() - age,) * 2)
    return path


def test_r12_what_a_killed_writer_left_is_swept_at_the_next_write(tmp_path):
    left = leftover(tmp_path, age=60)
    other = tmp_path / ".primkit-mine.tmp"
    other.write_text("not ours")
    formats.write_atomically(tmp_path / "a.txt", "new")
    assert sorted(path.name for path in tmp_path.iterdir()) == [other.name, "a.txt"]
    assert not left.exists()


def test_r12_what_is_new_stays(tmp_path):
    left = leftover(tmp_path, age=1)
    formats.write_atomically(tmp_path / "a.txt", "new")
    assert left.exists()


@posix
def test_r12_what_a_living_process_writes_stays_however_old_it_is(tmp_path):
    left = leftover(tmp_path, age=10**6)
    code = f"import fcntl, sys; f = open({str(left)!r}); fcntl.flock(f, 2); print(flush=True); sys.stdin.read()"
    with subprocess.Popen([sys.executable, "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE) as writer:
        writer.stdout.readline()
        formats.write_atomically(tmp_path / "a.txt", "new")
        assert left.exists()
        writer.kill()
    formats.write_atomically(tmp_path / "a.txt", "newer")
    assert not left.exists()


@posix
def test_r13_what_could_not_be_written_stays_out_and_the_file_is_named(tmp_path):
    import resource

    before, seen = resource.getrlimit(resource.RLIMIT_FSIZE), a_scan()
    with formats.record_drive(tmp_path / "a.jsonl") as journal:
        journal.add(seen[:1], (1, 1))
        resource.setrlimit(resource.RLIMIT_FSIZE, ((tmp_path / "a.jsonl").stat().st_size + 100, before[1]))
        try:
            assert refusal(journal.add, seen[1:], (2, 2), error=OSError) == "a.jsonl: cannot be written: File too large"
            assert refusal(formats.write_atomically, tmp_path / "b.txt", "x" * 10**5, error=OSError) == (
                "b.txt: cannot be written: File too large"
            )
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, before)
        journal.add(seen[1:], (3, 3))
    assert formats.load_drive(tmp_path / "a.jsonl").wheels.tolist() == [[1, 1], [3, 3]]
    assert [path.name for path in tmp_path.iterdir()] == ["a.jsonl"]


# --- R16: Windows, by shims ---------------------------------------------------------------------------------------


def test_r16_what_is_printed_can_be_printed_by_a_windows_console():
    from primkit.checks import Answer
    from primkit.course.grading.mark import Mark, Row

    for verdict in ("right", "wrong", "error", "not attempted"):
        answer = Answer(verdict, "so it is")
        assert str(answer).encode("cp1252").decode("cp1252") == f"{verdict}: so it is"
        str(Mark("half", (Row("halves", 2, answer),))).encode("cp1252")


@pytest.mark.parametrize("name", ["a:b.geojson", "C:/maps/a:b.geojson", "C:a.geojson"])
def test_r16_a_colon_is_refused_on_windows(monkeypatch, name):
    monkeypatch.setattr(files, "WINDOWS", True)
    expected = f"{name}: the name of a map must have no colon, but for a drive as in C:\\maps"
    assert refusal(formats.save_world, pk.World(), name) == expected


def test_r16_files_are_written_and_swept_as_windows_wants_it(tmp_path, monkeypatch):
    monkeypatch.setattr(files, "WINDOWS", True)
    monkeypatch.setitem(sys.modules, "fcntl", None)
    left = leftover(tmp_path, age=60)
    formats.write_atomically(tmp_path / "a.txt", "new")
    assert ((tmp_path / "a.txt").read_text(), left.exists()) == ("new", False)


@posix
def test_r16_what_outlives_nbgrader_does_not_keep_it_waiting(tmp_path, monkeypatch):
    from primkit.course import running
    from primkit.course.course import Course

    app = (
        "import subprocess\n"
        "class NbGraderApp:\n"
        "    def launch_instance(words):\n"
        "        print('said')\n"
        "        subprocess.Popen([sys.executable, '-c', 'import time; time.sleep(30)'])"
    )
    of_nbgrader = "from nbgrader.apps.nbgraderapp import NbGraderApp"
    assert of_nbgrader in running.NURSERY
    monkeypatch.setattr(running, "NURSERY", running.NURSERY.replace(of_nbgrader, app))
    monkeypatch.setattr(running, "IDLE", SimpleQueue())
    start = time.monotonic()
    done = running.nbgrader(Course(tmp_path), "autograde")
    assert (done.code, done.log.strip()) == (0, "said")
    assert time.monotonic() - start < 20


# --- R17: without playwright ----------------------------------------------------------------------------------------


def test_r17_without_playwright_the_browser_s_tests_are_skipped_with_a_word():
    code = (
        "import sys; sys.modules['playwright'] = None\n"
        "import pytest; sys.exit(pytest.main(['-p', 'no:cacheprovider', 'tests/test_grid.py', 'tests/browser',"
        " '-k', 'an_empty_grid or it_fits']))"
    )
    env = {name: value for name, value in os.environ.items() if name != "PRIMKIT_BROWSER"}
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, env=env, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert re.search(r"1 passed, [1-9]\d* skipped, \d+ deselected", done.stdout)
    assert "the lessons are tried in a browser: " in done.stdout
