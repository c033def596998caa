"""The strip of a drive: each frame shows what was seen by then, and what of it is new."""

import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.colors import same_color

import primkit as pk
from primkit.formats import Drive
from primkit.grid import Grid
from primkit.lidar import scan
from primkit.plots import plot_drive
from primkit.plots.ways_driven import SEEN_BEFORE, SEEN_NEW
from tests.helpers import exactly

WORLD = pk.random_world(2, rng=3)
WHEELS = [(0.0, 0.0), *[(6.0, 6.28)] * 40]
DRIVE = Drive(scan(WORLD, pk.drive(WORLD, WHEELS[1:])), WHEELS)


def points_in(ax, look):
    """What is drawn as points of that colour, as cells."""
    (dots,) = (line for line in ax.lines if line.get_marker() == "o" and same_color(line.get_color(), look["color"]))
    return {tuple(cell) for cell in Grid().to_cells(np.column_stack(dots.get_data())).tolist()}


@pytest.mark.parametrize("n_frames", [1, 2, 4, 5, 6])
def test_the_map_grows_from_frame_to_frame(n_frames):
    figure = plot_drive(WORLD, DRIVE, n_frames)
    assert len(figure.axes) == n_frames
    known = set()
    for k, ax in enumerate(figure.axes, start=1):
        end = round(k * len(DRIVE) / n_frames)
        grid = Grid()
        grid.add(DRIVE.scans[:end])
        cells = {tuple(cell) for cell in grid.to_cells(grid.points()).tolist()}
        assert points_in(ax, SEEN_BEFORE) == known
        assert points_in(ax, SEEN_NEW) == cells - known
        assert ax.get_title(loc="left").replace("\n", " ") == f"{end / 10:.1f} s: {len(cells):,} points"
        way = next(line for line in ax.lines if len(line.get_xdata()) == end)
        assert (np.column_stack(way.get_data()) == DRIVE.poses[:end, :2]).all()
        known = cells
    assert figure.get_suptitle() == f"The map grows: {len(known):,} points after 4.1 s"
    assert plt.get_fignums() == []


def test_the_frames_have_units_at_the_edge_of_the_figure():
    axes = plot_drive(WORLD, DRIVE, 5).axes
    assert [ax.get_ylabel() for ax in axes] == ["y [m]", "", "", "y [m]", ""]
    assert [ax.get_xlabel() for ax in axes] == ["", "", "x [m]", "x [m]", "x [m]"]


def test_there_are_no_more_frames_than_scans():
    assert len(plot_drive(WORLD, Drive(DRIVE.scans[:3], WHEELS[:3]), 6).axes) == 3


def test_a_journal_gives_the_same_picture(tmp_path):
    pk.save_drive(DRIVE, tmp_path / "a.jsonl")
    again = pk.load_drive(tmp_path / "a.jsonl")
    assert pk.plot_drive(WORLD, again)._repr_png_() == plot_drive(WORLD, DRIVE)._repr_png_()


FAILURES = {
    "no world": (lambda: plot_drive([], DRIVE), "world must be of type World, got list"),
    "no drive": (lambda: plot_drive(WORLD, DRIVE.scans), "drive must be of type Drive, got Scans"),
    "no frames": (lambda: plot_drive(WORLD, DRIVE, 0), "n_frames must be a whole number >= 1, got 0"),
    "no scans": (
        lambda: plot_drive(WORLD, Drive(DRIVE.scans[:0], [])),
        "a drive must have scans to be drawn, got none",
    ),
}


@pytest.mark.parametrize(("call", "sentence"), FAILURES.values(), ids=FAILURES)
def test_failure(call, sentence):
    with pytest.raises(ValueError, match=exactly(sentence)):
        call()
