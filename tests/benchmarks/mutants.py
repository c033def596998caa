"""Damaged files: every reader gets mutants of a file that it can read, and refuses them in a sentence.

    python -m tests.benchmarks.mutants [N [NAME ...]]

N mutants over all readers, or those of the files that are named, such as a.log and a.bag; in one process, each from a
seed of its own. It prints for each reader how many were read and how many refused, the longest time that one took, and
by how much the process has grown; and every mutant that breaks a rule: an exception that is not documented, a sentence
of several lines or without the file's name, or more than two seconds of processor time. A file of a megabyte of the
densest text of each format is read by itself.
"""

import io
import json
import random
import sys
import tempfile
import time
import zipfile
from contextlib import suppress
from importlib.util import find_spec
from pathlib import Path
from types import SimpleNamespace

import numpy as np

import primkit as pk
from primkit import formats
from primkit.course.course import STUDENTS, Course
from primkit.course.graded import _entries_in
from primkit.course.handed_in import _not_a_notebook
from primkit.study import run_study
from primkit.study.journal import open_journal
from tests.recorded import BAGS, driven_bag, table, write_log

SECONDS = 2.0  # of processor time, for one file
PARTS = (
    *(b"null", b"true", b"NaN", b"Infinity", b"-", b"1e999", b"-1e-999", b"0", b"1e160", b'""', b'"x"', b"[", b"]"),
    *(
        b"{",
        b"}",
        b"[]",
        b"{}",
        b",",
        b":",
        b"\\",
        b"\n",
        b"\r",
        b"\x00",
        b"\xff\xfe",
        b"\xef\xbb\xbf",
        b"\xed\xa0\x80",
    ),
    *(
        b"9" * 400,
        b"9" * 5000,
        b"[" * 2000,
        b'{"":' * 2000,
        b'{"":0},' * 500,
        b" " * 3000,
        b"PK\x01\x02",
        b"PK\x05\x06",
    ),
)
SDF = (
    "<?xml version='1.0'?><sdf version='1.8'><world name='w'><model name='m'><pose>1 0 0 0 0 0.5</pose><link name='l'>"
    "<collision name='a'><geometry><box><size>2 1 0.5</size></box></geometry></collision><collision name='b'><pose>"
    "0 2 0 0 0 0</pose><geometry><cylinder><radius>0.3</radius><length>1</length></cylinder></geometry></collision>"
    "</link></model><include><uri>model://sun</uri></include></world></sdf>"
)
VALUES = (None, True, False, 0, -1, 1e308, 10**400, "", "x", [], {}, [[]], [None], {"type": "Point"}, "\ud800", 5, 0.5)


# --- what is read -------------------------------------------------------------------------------------------


def seeds(folder):
    """Return for each reader a name of its file, a file that it reads, and the reader."""
    world = pk.World([pk.Circle((-0.2, 0), 0.05), pk.Polygon([(0, 0), (0.2, 0), (0, 0.1)])])
    seen = pk.scan(world, [(0, 0, 0), (0.05, -0.1, 0)], pk.Lidar(beams=12))
    route = formats.Route((0, 0, 0), [(1, 2), (3, 4)])
    formats.save_world(world, folder / "a.geojson", properties=[{"rms": 0.1}, {}])
    formats.save_scans(seen, folder / "a.npz")
    formats.save_drive(formats.Drive(seen, [(0, 0), (1, 1)], pk.Lidar(beams=12)), folder / "a.jsonl")
    formats.save_route(route, folder / "a.json")
    board = pk.World([pk.Circle((0, 0), 0.06)])
    formats.save_world(world, folder / "a.wbt")
    (folder / "a.sdf").write_text(SDF)
    run_study({"one": board}, {"ROBUST": pk.ROBUST}, folder=folder, jobs=1, progress=False)
    (folder / STUDENTS).write_text("id,first_name,last_name,email\nada,Ada,L,ada@x.org\nbob,Bob,,\n")
    cell = {"cell_type": "code", "source": "1", "outputs": [], "metadata": {"nbgrader": {"grade_id": "a"}}}
    (folder / "a.ipynb").write_text(json.dumps({"cells": [cell, {**cell, "metadata": {}}], "metadata": {}}))
    formats_of_robots = _recordings(folder, seen)
    fault = {"student": "ada", "cell": "-", "name": "bad", "says": "so"}
    (folder / "graded.json").write_text(json.dumps({"ada": {"hash": "0", "graded": True, "faults": [fault]}}))

    def route_driven(path):
        route = formats.load_route(path)
        with suppress(ValueError):  # it may lead off the board
            route.poses(pk.World())
        return route

    def journal(path):
        with open_journal(path.parent) as (rows, _):
            return rows

    readers = {
        "a.geojson": formats.load_world,
        "a.npz": formats.load_scans,
        "a.jsonl": formats.load_drive,
        "a.json": route_driven,
        "journal.jsonl": journal,
        STUDENTS: lambda path: Course(path.parent).students(),
        "a.ipynb": _not_a_notebook,
        "graded.json": _entries_in,
    }
    readers |= {"a.wbt": formats.load_world, "a.sdf": formats.load_world}
    readers |= dict.fromkeys(formats_of_robots, formats.load_scans)
    return {name: ((folder / name).read_bytes(), read) for name, read in readers.items()}


def _recordings(folder, seen):
    """Write recordings of robots into the folder, and return their names; bags only where rosbags is installed."""
    ranges = np.where(seen.hits, seen.ranges, 81.91)
    write_log(folder / "a.log", seen.poses, ranges, digits=3)
    write_log(folder / "b.log.gz", seen.poses, ranges, digits=3, laser="ROBOTLASER1", start=0.0, step=0.5)
    (folder / "a.csv").write_text(table(seen.angles, ranges[0]))
    if find_spec("rosbags") is None:
        return ["a.log", "b.log.gz", "a.csv"]
    for kind in BAGS:
        path = folder / f"written_{kind}"
        path.mkdir()
        bag = driven_bag(path, kind, seen, pk.Lidar(beams=12), mounted=(0.1, 0.0, 0.0))
        (bag if bag.is_file() else next(bag.glob(f"*.{kind}"))).replace(folder / f"a.{kind}")
    return ["a.log", "b.log.gz", "a.csv", *(f"a.{kind}" for kind in BAGS)]


# --- how it is damaged --------------------------------------------------------------------------------------


def mutant(name, data, others, draw):
    """Return a damaged copy: bytes changed anywhere, or another value in the place of one that the format has."""
    structured = {"npz": _other_array, "json": _other_value, "geojson": _other_value, "ipynb": _other_value}
    change = structured.get(name.rsplit(".", 1)[-1])
    if change and draw.random() < 0.4:
        return change(data, draw)
    if name.endswith(".jsonl") and draw.random() < 0.4:
        lines = data.splitlines()
        chosen = draw.randrange(len(lines))
        lines[chosen] = _other_value(lines[chosen], draw)
        return b"\n".join(lines) + b"\n"
    data = bytearray(data)
    for _ in range(draw.choice((1, 1, 1, 2, 5, 20))):
        place = draw.randrange(len(data) + 1)
        end = min(len(data), place + draw.choice((1, 1, 4, 30, 300)))
        match draw.randrange(6):
            case 0 if place < len(data):
                data[place] ^= 1 << draw.randrange(8)
            case 1:
                data[place:end] = b""
            case 2:
                data[place:place] = data[place:end]
            case 3:
                data[place:end] = draw.choice(PARTS)
            case 4:
                data[place:place] = draw.choice(PARTS)
            case 5:
                other = draw.choice(others)
                start = draw.randrange(len(other))
                data[place:end] = other[start : start + end - place]
    return bytes(data[: draw.randrange(len(data) + 1)] if draw.random() < 0.1 else data)


def _other_value(data, draw):
    """Replace one value of a JSON text, or drop it, or double it."""
    document = json.loads(data)
    places = []

    def walk(node):
        for key in node if isinstance(node, dict) else range(len(node)):
            places.append((node, key))
            if isinstance(node[key], (dict, list)):
                walk(node[key])

    walk(document)
    for node, key in draw.sample(places, min(len(places), draw.choice((1, 1, 2)))):
        match draw.randrange(4):
            case 0 if isinstance(node, dict):
                node.pop(key, None)
            case 1 if isinstance(node, list) and key < len(node):
                node[key:key] = [node[key]] * draw.choice((1, 1000))
            case _ if isinstance(node, dict) or key < len(node):
                node[key] = draw.choice(VALUES)
    return json.dumps(document).replace("\\ud800", draw.choice(("\\ud800", "x"))).encode()


def _other_array(data, draw):
    """Replace one array of an archive by one of another type or shape, or of another number of bytes than it says."""
    with np.load(io.BytesIO(data)) as arrays:
        arrays = dict(arrays)
    field = draw.choice(list(arrays))
    dtype = draw.choice(
        ("f8", "f4", "f2", "i1", "u8", "?", "c16", "M8[s]", "m8[ns]", "U3", "S2", "V3", ">f8", "O", "g")
    )
    shape = draw.choice(((), (0,), (2,), (2, 3), (12,), (2, 12), (12, 2), (10**4,), (2, 0), (1, 2, 3)))
    head = f"{{'descr': '{np.dtype(dtype).str}', 'fortran_order': {draw.random() < 0.3}, 'shape': {shape}}}"
    if draw.random() < 0.3:
        impossible = ("(10**12,)", "(1000000000000, 3)", "(-1,)", "(2.0,)", "None", "((2,),)")
        head = head.replace(str(shape), draw.choice(impossible))
    head = head.encode().ljust(117) + b"\n"
    version = draw.choice((b"\x01\x00", b"\x01\x00", b"\x02\x00", b"\x03\x00", b"\x09\x00"))
    body = bytes(draw.choice((0, 1, 16, 48, 192, 80_000)))
    buffer = io.BytesIO()
    packing = draw.choice((zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED, zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA))
    with zipfile.ZipFile(buffer, "w", packing) as archive:
        for name, array in arrays.items():
            member = io.BytesIO()
            np.lib.format.write_array(member, array)
            length = len(head).to_bytes(2 if version[0] == 1 else 4, "little")
            other = b"\x93NUMPY" + version + length + head + body
            archive.writestr(f"{name}.npy", other if name == field else member.getvalue())
    return buffer.getvalue()


# --- what must hold -----------------------------------------------------------------------------------------


def tried(name, read, path):
    """Return whether a file was read, the seconds that it took, and what rule was broken, if any."""
    start, broken = time.process_time(), ""
    try:
        outcome = read(path)
        fine = outcome is None if name.endswith(".ipynb") else True
        if isinstance(outcome, str) and "\n" in outcome:
            broken = f"several lines: {outcome!r}"
    except ValueError as error:
        fine, said = False, str(error)
        if "\n" in said or len(said) > 400 or not said.startswith(name) or type(error) is not ValueError:
            broken = f"{type(error).__name__}: {said!r}"
    except Exception as error:  # whatever it is, it is what we look for
        fine, broken = False, f"{type(error).__name__}: {error}"
    seconds = time.process_time() - start
    return fine, seconds, broken or (f"{seconds:.1f} s" if seconds > SECONDS else "")


def run(n, folder, seed=0, names=()):
    """Try n mutants, the readers in turn; return what came out for each reader."""
    readers = seeds(folder)
    everything = [data for data, _ in readers.values()]
    readers = {name: reader for name, reader in readers.items() if name in (names or readers)}
    out = {name: SimpleNamespace(read=0, refused=0, longest=0.0, broken=[]) for name in readers}
    for number in range(n):
        name = list(readers)[number % len(readers)]
        data, read = readers[name]
        content = mutant(name, data, everything, random.Random(f"{seed}-{number}"))
        (folder / name).write_bytes(content)
        fine, seconds, broken = tried(name, read, folder / name)
        mine = out[name]
        mine.read, mine.refused = mine.read + fine, mine.refused + (not fine)
        mine.longest = max(mine.longest, seconds)
        if broken:
            mine.broken.append((number, broken))
    return out


def main(n=100_000, *names):
    import resource
    import warnings

    warnings.simplefilter("ignore", pk.arguments.LikelyWrong)
    with tempfile.TemporaryDirectory() as once, tempfile.TemporaryDirectory() as folder:
        run(80, Path(once))  # everything is loaded, and the process has its size
        before, start = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss, time.process_time()
        out = run(int(n), Path(folder), names=names)
        grown = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before
    seconds = time.process_time() - start
    print(f"{n} mutants in {seconds:.0f} s of processor time; the process grew by {grown / 1024:.0f} MB")
    for name, each in out.items():
        print(f"{name:15} read {each.read:6}, refused {each.refused:6}, longest {1000 * each.longest:5.0f} ms")
        for number, what in each.broken[:20]:
            print(f"    mutant {number}: {what[:200]}")
    return sum(len(each.broken) for each in out.values())


if __name__ == "__main__":
    sys.exit(min(1, main(*sys.argv[1:])))
