"""Killed writers: all writers are killed at random moments, two at once; and every format is cut off at every byte.

    python -m tests.benchmarks.killed_writers [N]

Two processes write into the same folder, over and over, until both are killed (SIGKILL). Then every file must be the
old one or the new one, whole, and after the next write there may be no leftovers. N times; Linux and macOS.
"""

import os
import random
import signal
import sys
import tempfile
import time
from contextlib import suppress
from pathlib import Path

import numpy as np

import primkit as pk
from primkit import formats
from primkit.course.course import Course
from primkit.course.graded import Graded, Journal, _entries_in

from .mutants import seeds

LIDAR = pk.Lidar(beams=300)
WORLDS = [pk.random_world(4, rng=seed) for seed in range(2)]
SEEN = [pk.scan(world, np.full((40, 3), (0, 0, seed)), LIDAR) for seed, world in enumerate(WORLDS)]


def write_all(folder, which):
    """Write every format once: the first content or the second."""
    world, seen, wheels = WORLDS[which], SEEN[which], np.full((40, 2), which + 1.0)
    formats.save_world(world, folder / "a.geojson")
    formats.save_scans(seen, folder / "a.npz")
    formats.save_drive(formats.Drive(seen, wheels, LIDAR), folder / "a.jsonl")
    formats.save_route(formats.Route((0, 0, which), wheels), folder / "a.json")
    Journal(Course(folder), "ps1").write(Graded(f"student-{which}", "graded", "", str(which)))
    with formats.record_drive(folder / f"own-{os.getpid()}.jsonl", LIDAR, replace=True) as journal:
        for number in range(5):
            journal.add(seen[number], wheels[number])


def whole(folder):
    """Return what is neither the first content nor the second, of the files in a folder."""
    wrong = []
    for name, read, expected in (
        ("a.geojson", formats.load_world, WORLDS),
        ("a.npz", lambda path: formats.load_scans(path).ranges.tobytes(), [s.ranges.tobytes() for s in SEEN]),
        ("a.jsonl", lambda path: formats.load_drive(path).scans.ranges.tobytes(), [s.ranges.tobytes() for s in SEEN]),
        ("a.json", lambda path: formats.load_route(path).start[2], [0, 1]),
        ("reports/ps1/graded.json", lambda path: set(_entries_in(path)) <= {"student-0", "student-1"}, [True]),
    ):
        if (path := folder / name).exists():
            try:
                if read(path) not in expected:
                    wrong.append(f"{name} is something else")
            except ValueError as error:
                wrong.append(str(error))
    for path in folder.glob("own-*.jsonl"):
        if path.stat().st_size > len(path.read_bytes().split(b"\n")[-1]):  # not killed within the first line
            drive = formats.load_drive(path)
            which = [np.array_equal(drive.scans.ranges, seen.ranges[: len(drive)]) for seen in SEEN]
            if not any(which):
                wrong.append(f"{path.name} is something else")
    return wrong


def leftovers(folder):
    return list(folder.rglob(".primkit-*"))


def killed(n):
    """Kill two writers n times; return what was wrong, and how many leftovers there were to sweep."""
    wrong, swept, draw = [], 0, random.Random(0)
    with tempfile.TemporaryDirectory() as here:
        folder = Path(here)
        write_all(folder, 0)
        for _ in range(n):
            writers = [_writer(folder, which) for which in (0, 1)]
            time.sleep(draw.uniform(0.0, 0.15))
            for writer in writers:
                os.kill(writer, signal.SIGKILL)
                os.waitpid(writer, 0)
            wrong += whole(folder)
            left = leftovers(folder)
            swept += len(left)
            for path in left:
                os.utime(path, (time.time() - 60,) * 2)  # as if a minute had passed
            for path in folder.glob("own-*.jsonl"):
                path.unlink()
            write_all(folder, 0)
            wrong += [f"{path.name} is left" for path in leftovers(folder)]
    return wrong, swept


def _writer(folder, which):
    child = os.fork()
    if child == 0:
        with suppress(BaseException):
            while True:
                write_all(folder, which)
        os._exit(1)  # a writer that fails ends early, and is told by its exit code
    return child


def cut_off(name, data, read, folder, step=1):
    """Cut a file off at every byte; return where what is read is not the old content without its end."""
    wrong, before = [], _numbers(read(_written(folder / name, data)))
    for length in range(0, len(data), step):
        try:
            now = _numbers(read(_written(folder / name, data[:length])))
        except ValueError as error:
            if not str(error).startswith(name):
                wrong.append(f"{name}, {length} bytes: {error}")
            continue
        if name == "a.wbt":  # nothing tells where it ends
            now, before = list(now.shapes), list(getattr(before, "shapes", before))
        if name == "a.csv":  # one scan: its beams
            now, before = now[0], before[0] if isinstance(before[0], list) else before
        if name.endswith(".ipynb"):  # its reader says what is wrong
            fine = now is not None or data[length:].isspace()
        elif name in ("a.geojson", "a.npz", "a.json", "graded.json", "a.sdf"):
            fine = now == before and data[length:].isspace()
        else:  # line by line: the old without its end
            fine = now == before[: len(now)] or name == "students.csv"
        if not fine:
            wrong.append(f"{name}, {length} bytes: {str(now)[:60]}")
    return wrong


def _written(path, data):
    path.write_bytes(data)
    return path


def _numbers(read):
    """Return what was read as something that can be compared, and cut."""
    if isinstance(read, formats.Drive):
        return [(*pose, *wheels) for pose, wheels in zip(read.poses.tolist(), read.wheels.tolist(), strict=True)]
    if isinstance(read, pk.lidar.Scans):
        return read.ranges.tolist()
    if isinstance(read, formats.Route):
        return read.wheels.tolist()
    return list(read.items()) if isinstance(read, dict) else read


def main(n):
    wrong, swept = killed(n)
    print(f"{n} times two writers were killed: {swept} leftovers swept, {len(wrong)} faults {wrong[:5]}")
    with tempfile.TemporaryDirectory() as here:
        readers = seeds(Path(here))
        for name, (data, read) in readers.items():
            found = cut_off(name, data, read, Path(here))
            wrong += found
            print(f"{name:15} cut off at each of {len(data)} bytes: {len(found)} faults {found[:3]}")
    return len(wrong)


if __name__ == "__main__":
    sys.exit(min(1, main(int(sys.argv[1]) if len(sys.argv) > 1 else 200)))
