"""``primkit map --scans``: ends as ``primkit map`` does, with a table, a picture and a map, but without a truth."""

import numpy as np
import pytest

import primkit as pk
from primkit.__main__ import main
from tests.recorded import table, write_log

RING = pk.World([pk.Circle((1.0, 0.5), 0.2)], size=6.0)
AROUND = [(1 + np.cos(a), 0.5 + np.sin(a), a + np.pi) for a in np.arange(8) * np.pi / 4]
HALF = pk.Lidar(180, 0.05, 20.0, fov=np.pi, angle_min=-np.pi / 2, range_step=0.001)


@pytest.fixture(autouse=True)
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_a_drive_becomes_a_table_a_picture_and_a_map(here, capsys):
    seen = pk.scan(RING, AROUND, HALF)
    write_log(here / "drive.log.gz", seen.poses, np.minimum(seen.ranges, 81.91))
    assert main(["map", "--scans", "drive.log.gz"]) == 0
    told = capsys.readouterr().out
    assert "Scans  8 scans in drive.log.gz\n" in told
    assert "cells of 1 mm\nFound  1 shape, 1 of them certain; nothing else\n" in told
    assert "0  circle  1000.0, 500.0" in told
    assert "Wrote  out/map.png, out/found.geojson\n" in told.replace("\\", "/")
    (found,) = pk.load_found("out/found.geojson")
    assert abs(found.shape.radius - 0.2) < 0.001
    assert (here / "out" / "map.png").read_bytes().startswith(b"\x89PNG")


def test_without_poses_the_first_scan_alone_is_mapped(here, capsys):
    seen = pk.scan(RING, AROUND[:1] * 3, HALF)
    write_log(here / "a.log", np.zeros((3, 3)), np.minimum(seen.ranges, 81.91))
    assert main(["map", "--scans", "a.log", "--cell", "2"]) == 0
    told = capsys.readouterr().out
    assert "3 scans in a.log, without poses: the first alone is mapped; --only A:B takes those of a robot" in told
    assert f"{seen[:1].hits.sum()} hits on " in told
    assert "cells of 2 mm" in told
    assert ", 0 of them certain;" in told  # seen from one side
    assert main(["map", "--scans", "a.log", "--only", "0:2"]) == 0
    assert "3 scans in a.log; 2 scans mapped" in capsys.readouterr().out


def test_a_table_takes_its_units_and_its_sensor_from_the_command_line(here, capsys):
    seen = pk.scan(RING, AROUND[:1], pk.Lidar(360, range_max=9.0))
    (here / "a.csv").write_text(table(seen.angles, np.where(seen.hits, seen.ranges, 0)[0], head="angle,distance"))
    assert main(["map", "--scans", "a.csv", "--units", "deg", "mm", "--lidar", "rplidar-a1"]) == 0
    assert f"{seen.hits.sum()} hits on " in capsys.readouterr().out


def test_nothing_to_see_is_a_map_too(here, capsys):
    write_log(here / "a.log", [(0, 0, 0)], [[81.91] * 4])
    assert main(["map", "--scans", "a.log"]) == 0
    assert "Found  no shapes, 0 of them certain; nothing else" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["--scans", "none.log"], "primkit: none.log: there is no such file in "),
        (["--scans", "a.txt"], "primkit: a.txt: the name of a file of scans must end in .npz or .log or "),
        (["--scans", "a.log", "--lidar", "sick"], "--lidar: must be rplidar-a1 or lds-01, got 'sick'"),
        (["--scans", "a.log", "--only", "5"], "--only: must be two whole numbers, as in 0:60, got '5'"),
    ],
)
def test_what_cannot_be_mapped_is_refused_in_a_sentence(capsys, words, sentence):
    assert main(["map", *words]) == 2
    assert sentence in capsys.readouterr().err


def test_a_cell_of_nothing_is_refused(here, capsys):
    write_log(here / "a.log", [(0, 0, 0)], [[1.0]])
    assert main(["map", "--scans", "a.log", "--cell", "0"]) == 2
    assert "must be a finite number > 0, got 0" in capsys.readouterr().err
