"""Drives: equal to the last bit, cut off anywhere, and refused in one sentence when they are none."""

import dataclasses
import json
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import primkit as pk
from primkit import formats
from primkit.formats import Drive, load_drive, record_drive, save_drive
from primkit.lidar import Lidar, Scans, scan
from tests.filing import refusal, written

ROOT = Path(__file__).resolve().parent.parent
WORLD = pk.random_world(4, rng=7)
WHEELS = [(0.0, 0.0), *[(5.0, 6.28), (6.28, 6.28)] * 20]


def a_drive(lidar=Lidar(), wheels=WHEELS, rng=0):  # noqa: B008 - frozen, so that sharing it is safe
    return Drive(scan(WORLD, pk.drive(WORLD, wheels[1:]), lidar, rng=rng), wheels, lidar)


def assert_same(now, was):
    """The same to the last bit: -0.0 is not 0.0 here."""
    for field in dataclasses.fields(Scans):
        a, b = getattr(now.scans, field.name), getattr(was.scans, field.name)
        assert (a.dtype, a.shape, a.tobytes()) == (b.dtype, b.shape, b.tobytes())
    assert now.wheels.tobytes() == was.wheels.tobytes()
    assert now.lidar == was.lidar


def recorded(drive, path):
    with record_drive(path, drive.lidar) as journal:
        for number, speeds in enumerate(drive.wheels):
            journal.add(drive.scans[number], speeds)
    return path


@settings(max_examples=20, deadline=None)
@given(
    seed=st.integers(0, 2**32),
    beams=st.integers(1, 200),
    wheels=st.lists(st.tuples(st.floats(-6.28, 6.28), st.floats(-6.28, 6.28)), min_size=1, max_size=20),
    noise=st.sampled_from([0.0, 0.003]),
)
def test_a_drive_comes_back_to_the_last_bit(tmp_path_factory, seed, beams, wheels, noise):
    folder = tmp_path_factory.mktemp("drives")
    drive = a_drive(Lidar(beams=beams, noise_std=noise, period=0.2, spurious=0.1), wheels, rng=seed)
    save_drive(drive, folder / "whole.jsonl")
    assert_same(load_drive(folder / "whole.jsonl"), drive)
    assert recorded(drive, folder / "journal.jsonl").read_bytes() == (folder / "whole.jsonl").read_bytes()


def test_the_wheels_lead_from_scan_to_scan(tmp_path):
    drive = load_drive(recorded(a_drive(), tmp_path / "a.jsonl"))
    assert (pk.drive(WORLD, drive.wheels[1:], drive.poses[0]) == drive.poses).all()
    assert (len(drive), drive.period) == (41, 0.1)


def test_a_scan_inside_a_shape_says_so(tmp_path):
    world = pk.World([pk.Circle((0, 0), 0.1)])
    drive = Drive(scan(world, [(0, 0, 0), (0.2, 0, 0)]), [(0, 0), (1, 1)])
    save_drive(drive, tmp_path / "a.jsonl")
    assert load_drive(tmp_path / "a.jsonl").scans.inside.tolist() == [True, False]


@pytest.mark.parametrize("cut", [1, 2, 50, 400])
def test_half_a_last_line_is_passed_over_and_left(tmp_path, cut):
    drive, path = a_drive(), tmp_path / "a.jsonl"
    save_drive(drive, path)
    short = path.read_bytes()[:-cut]
    path.write_bytes(short)
    back = load_drive(path)
    assert len(back) == len(drive) - 1
    assert (back.scans.ranges == drive.scans.ranges[:-1]).all()
    assert path.read_bytes() == short


DRIVING = """
import sys, time
import primkit as pk
from primkit.robot import advance, start_pose

world, rng, pose, wheels = pk.random_world(4, rng=7), 0, None, (0, 0)
with pk.record_drive(sys.argv[1]) as journal:
    pose = start_pose(world)
    for step in range(1_000_000):
        seen = pk.scan(world, pose)
        journal.add(seen, wheels)
        print(step + 1, flush=True)  # so many scans are finished
        wheels = (5, 6.28) if step % 40 < 30 else (6.28, -6.28)
        pose, _ = advance(world, pose, wheels)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="there is no SIGKILL")
@pytest.mark.parametrize("after", [1, 37])
def test_a_killed_drive_loses_at_most_the_last_scan(tmp_path, after):
    """The real thing: a process that drives and is killed, without a chance to close its file."""
    path = tmp_path / "killed.jsonl"
    command = [sys.executable, "-c", DRIVING, str(path)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, cwd=ROOT) as driving:
        for line in driving.stdout:
            if int(line) >= after:
                break
        driving.send_signal(signal.SIGKILL)
        told = [line for line in driving.stdout.read().splitlines(keepends=True) if line.endswith("\n")]
        driving.wait()
    assert driving.returncode == -signal.SIGKILL
    finished = int(told[-1]) if told else after
    back = load_drive(path)
    assert finished <= len(back) <= finished + 1  # killed between writing and telling: one more
    poses = pk.drive(WORLD, back.wheels[1:])
    assert (back.poses == poses).all()
    again, truth = pk.Grid(), pk.Grid()
    again.add(back.scans)
    truth.add(scan(WORLD, poses))
    assert (again.points() == truth.points()).all()


def test_a_drive_is_not_replaced_unless_told_so(tmp_path):
    path = recorded(a_drive(), tmp_path / "a.jsonl")
    before = path.read_bytes()
    sentence = "a.jsonl: is there already; load it, or record with replace=True"
    assert refusal(record_drive, path, error=FileExistsError) == sentence
    assert path.read_bytes() == before
    record_drive(path, replace=True).close()
    assert len(load_drive(path)) == 0


def test_where_no_file_can_be(tmp_path):
    there = tmp_path / "none"
    assert refusal(record_drive, there / "a.jsonl", error=FileNotFoundError) == f"a.jsonl: there is no folder {there}"
    (tmp_path / "a.jsonl").mkdir()
    assert "a.jsonl: " in refusal(record_drive, tmp_path / "a.jsonl", replace=True, error=IsADirectoryError)


def test_nothing_is_added_that_cannot_be_read_back(tmp_path, monkeypatch):
    drive = a_drive()
    journal = record_drive(tmp_path / "a.jsonl")
    scans = drive.scans
    assert refusal(journal.add, scans[:2], (0, 0)) == "a.jsonl: must be given one scan at a time, got 2"
    other = scan(WORLD, [(0, 0, 0)], Lidar(beams=7))
    sentence = "a.jsonl: scans must be the lidar's, with 100 beams, got 7 others"
    assert refusal(journal.add, other, (0, 0)) == sentence
    sentence = "a.jsonl: wheels must be two finite numbers (x, y), got (nan, 0)"
    assert refusal(journal.add, scans[0], (float("nan"), 0)) == sentence
    journal.add(scans[0], (0, 0))
    size = (tmp_path / "a.jsonl").stat().st_size
    monkeypatch.setattr(formats.drives, "DRIVE_LIMIT", size)
    assert refusal(journal.add, scans[1], (0, 0)).startswith(f"a.jsonl: must be at most {size:,} bytes, got ")
    journal.close()
    assert (
        refusal(journal.add, scans[1], (0, 0)) == "a.jsonl: must be open to add a scan, got a journal that was closed"
    )
    assert len(load_drive(tmp_path / "a.jsonl")) == 1
    assert refusal(save_drive, drive, tmp_path / "b.jsonl").startswith("b.jsonl: must be at most ")
    assert not (tmp_path / "b.jsonl").exists()


def test_a_file_that_is_too_large_is_not_read(tmp_path, monkeypatch):
    save_drive(a_drive(), tmp_path / "a.jsonl")
    monkeypatch.setattr(formats.drives, "DRIVE_LIMIT", 1000)
    assert refusal(load_drive, tmp_path / "a.jsonl").startswith("a.jsonl: must be at most 1,000 bytes, got ")


SEEN = scan(WORLD, [(0, 0, 0), (0.1, 0, 0)])
DRIVE_FAILURES = {
    "no scans": (([], []), "scans must be Scans, as scan(world, poses) returns them, got list"),
    "one wheel's speed": ((SEEN, [1, 2]), "wheels must have shape (N, 2), got shape (2,)"),
    "too few": ((SEEN, [(0, 0)]), "wheels must hold two speeds for each of the 2 scans, got 1"),
    "another sensor": (
        (SEEN, [(0, 0)] * 2, Lidar(beams=50)),
        "scans must be the lidar's, with 50 beams, got 100 others",
    ),
    "no sensor": ((SEEN, [(0, 0)] * 2, 0.1), "lidar must be a Lidar, such as Lidar(), got float"),
}


@pytest.mark.parametrize(("arguments", "sentence"), DRIVE_FAILURES.values(), ids=DRIVE_FAILURES)
def test_drive_failure(arguments, sentence):
    assert refusal(Drive, *arguments) == sentence


HEAD = {"format": "primkit drive", "version": 1, "lidar": dataclasses.asdict(Lidar(beams=3))}
LINE = {"pose": [0, 0, 0], "wheels": [1.5, 2], "ranges": [0.1, None, 0], "inside": False}
NONE = 'a.jsonl: must be a drive, its first line with "format": "primkit drive", got '
POSE = "a.jsonl: line 2: pose must be 3 finite numbers, got "
RANGES = "a.jsonl: line 2: ranges must be 3 finite numbers >= 0, or null for no hit, got "


def lines(*entries):
    return "".join(f"{entry if isinstance(entry, str) else json.dumps(entry)}\n" for entry in entries)


FILE_FAILURES = {
    "empty": (b"", NONE + "b''"),
    "half a first line": (lines(HEAD)[:-1], NONE + "b''"),
    "rubbish": (b"\xff\x00\n" * 100, NONE + "b'\\xff\\x00'"),
    "another program's": (lines({"type": "x"}), NONE + 'b\'{"type": "x"}\''),
    "a list": (lines([]), NONE + "b'[]'"),
    "deep": ("[" * 100_000 + "\n", NONE + "b'" + "[" * 40 + "'"),
    "another version": (lines(HEAD | {"version": 2}), "a.jsonl: must be a drive of version 1, got version 2"),
    "no version": (
        lines({k: v for k, v in HEAD.items() if k != "version"}),
        "a.jsonl: must be a drive of version 1, got version None",
    ),
    "no lidar": (
        lines(HEAD | {"lidar": None}),
        "a.jsonl: lidar must have beams, dropout, model, noise_std, period, range_max, range_min, spurious, got None",
    ),
    "a lidar without beams": (
        lines(HEAD | {"lidar": HEAD["lidar"] | {"beams": 0}}),
        "a.jsonl: beams must be a whole number >= 1, got 0",
    ),
    "a lidar that fills the memory": (
        lines(HEAD | {"lidar": HEAD["lidar"] | {"beams": 10**12}}),
        "a.jsonl: beams must be at most 1,000,000, got 1,000,000,000,000",
    ),
    "a line that is none": (lines(HEAD, "x"), "a.jsonl: line 2: must be valid JSON, got b'x'"),
    "half a line in the middle": (
        lines(HEAD, LINE, '{"pose": [0, 0', LINE),
        "a.jsonl: line 3: must be valid JSON, got b'{\"pose\": [0, 0'",
    ),
    "a line with a number": (lines(HEAD, 3), "a.jsonl: line 2: must be a scan, got int"),
    "no pose": (lines(HEAD, {k: v for k, v in LINE.items() if k != "pose"}), POSE + "None"),
    "a short pose": (lines(HEAD, LINE | {"pose": [0, 0]}), POSE + "2 of them"),
    "a pose with NaN": (lines(HEAD, LINE | {"pose": [0, 0, float("nan")]}), POSE + "nan"),
    "a pose with null": (lines(HEAD, LINE | {"pose": [0, 0, None]}), POSE + "None"),
    "a pose of text": (lines(HEAD, LINE | {"pose": ["0", 0, 0]}), POSE + "'0'"),
    "a pose of truths": (lines(HEAD, LINE | {"pose": [True, 0, 0]}), POSE + "True"),
    "a pose out of all numbers": (lines(HEAD, LINE | {"pose": [10**400, 0, 0]}), POSE + "1" + "0" * 56 + "..."),
    "wheels without end": (
        lines(HEAD, LINE | {"wheels": [0, float("inf")]}),
        "a.jsonl: line 2: wheels must be 2 finite numbers, got inf",
    ),
    "too many ranges": (lines(HEAD, LINE | {"ranges": [0.1] * 4}), RANGES + "4 of them"),
    "a range below zero": (lines(HEAD, LINE | {"ranges": [0.1, -0.1, 0.1]}), RANGES + "-0.1"),
    "a range with NaN": (lines(HEAD, LINE | {"ranges": [0.1, float("nan"), 0.1]}), RANGES + "nan"),
    "ranges of text": (lines(HEAD, LINE | {"ranges": "abc"}), RANGES + "'abc'"),
    "inside is a number": (lines(HEAD, LINE | {"inside": 1}), "a.jsonl: line 2: inside must be true or false, got int"),
}


@pytest.mark.parametrize(("content", "sentence"), FILE_FAILURES.values(), ids=FILE_FAILURES)
def test_a_file_that_is_no_drive_is_refused(tmp_path, content, sentence):
    assert refusal(load_drive, written(tmp_path, content, "a.jsonl")) == sentence


def test_whole_numbers_are_numbers(tmp_path):
    drive = load_drive(written(tmp_path, lines(HEAD, LINE), "a.jsonl"))
    assert (drive.poses.dtype, drive.scans.ranges.tolist()) == (np.dtype(float), [[0.1, np.inf, 0.0]])


def test_a_drive_with_another_name_is_refused(tmp_path):
    assert refusal(load_drive, tmp_path / "a.npz") == "a.npz: the name of a drive must end in .jsonl, got .npz"
    here = tmp_path.resolve()
    sentence = f"none.jsonl: there is no such file in {here}"
    assert refusal(load_drive, here / "none.jsonl", error=FileNotFoundError) == sentence
