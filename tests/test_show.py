"""How the nouns print and show: a few lines of text, and a table or a small picture in a notebook."""

import copy
import inspect
import pickle
import re
import subprocess
import sys
from xml.etree import ElementTree

import numpy as np
import pytest

import primkit as pk
from primkit.found import MOST_ROWS, Found
from primkit.show import census, in_mm, thumbnail
from primkit.table import Table
from tests.helpers import svg_in, words_in

WORLD = pk.World([pk.Circle((0.1, 0.1), 0.05), pk.Polygon([(-0.3, -0.2), (-0.1, -0.2), (-0.1, -0.1), (-0.3, -0.1)])])
POSES = pk.teleport_poses(WORLD)
SCANS = pk.scan(WORLD, POSES)
GRID = pk.Grid()
GRID.add(SCANS)
MOVING = pk.MovingGrid()
MOVING.add(SCANS)
FOUND = pk.find_shapes(GRID.points(), rng=0)
TOUR = pk.explore(WORLD, rng=0, most_scans=4)

TEXTS = {
    "world": (WORLD, "World: 1 m x 1 m, 2 shapes: 1 circle, 1 rectangle"),
    "walled": (pk.World(size=2.5, walls=True), "World: 2.5 m x 2.5 m with walls, no shapes"),
    "scans": (SCANS, f"Scans: {len(SCANS)} scans of 100 beams, {SCANS.hits.sum()} hits"),
    "no scans": (pk.scan(WORLD, []), "Scans: no scans of 100 beams, no hits"),
    "grid": (GRID, f"Grid: {len(GRID)} occupied cells of 1 mm"),
    "moving grid": (MOVING, f"MovingGrid: {len(MOVING)} occupied cells of 1 mm after {len(SCANS)} scans"),
    "drive": (
        pk.Drive(SCANS, np.zeros((len(SCANS), 2))),
        f"Drive: {0.1 * len(SCANS):.1f} s, {len(SCANS)} scans of 100 beams, {SCANS.hits.sum()} hits",
    ),
    "exploration": (
        TOUR,
        f"Exploration: {len(TOUR.found)} shapes from 4 scans in {TOUR.robot_time:.1f} s; out of scans",
    ),
    "detection": (
        FOUND[1],
        f"Detection: circle at (100.0, 100.0) mm, radius 50.0 mm; {len(FOUND[1].points)} points, rms 0.30 mm",
    ),
    "nothing found": (pk.find_shapes([]), "no shapes found"),
    "robust": (pk.Settings(), "ROBUST"),
    "paper": (pk.PAPER, "PAPER"),
    "own": (pk.Settings(noise_std=0.002, soft=False), "Settings(soft=False, noise_std=0.002)"),
}
SHOWN = {name: noun for name, (noun, _) in TEXTS.items() if name != "detection"}
SHOWN |= {"found": FOUND, "report": pk.evaluate(FOUND, WORLD)}


@pytest.mark.parametrize(("noun", "text"), TEXTS.values(), ids=TEXTS)
def test_a_noun_prints_in_a_line(noun, text):
    assert repr(noun) == str(noun) == text


@pytest.mark.parametrize("noun", SHOWN.values(), ids=SHOWN)
def test_a_noun_shows_in_a_notebook_and_fits_a_screen(noun):
    root = ElementTree.fromstring(f"<div>{noun._repr_html_()}</div>")
    assert {"img", "table", "p"} & {element.tag.split("}")[-1] for element in root.iter()}
    assert all(len(line) <= 120 for line in repr(noun).splitlines())
    assert repr(noun).count("\n") <= 25


def test_what_was_found_prints_as_a_table():
    head, names, dashes, *rows = repr(FOUND).splitlines()
    assert head == "2 shapes found"
    assert names.split("  ")[-3:] == ["points", "rms [mm]", "certain"]
    assert set(dashes) == {"-", " "}
    assert [row.split()[:2] for row in rows] == [["0", "rectangle"], ["1", "circle"]]
    assert "-199.5, -149.5" in rows[0]
    assert "200.0 x 100.0" in rows[0]
    assert [row.split()[-1] for row in rows] == ["yes", "yes"]


def test_a_long_list_is_cut_and_says_so():
    many = Found(FOUND * 20)
    assert repr(many).splitlines()[-1] == f"And {40 - MOST_ROWS} more."
    assert len(repr(many).splitlines()) == MOST_ROWS + 4


def test_what_was_not_measured_stands_in_brackets():
    (half,) = pk.find_shapes(pk.Polygon([(0, 0), (0.2, 0), (0.2, 0.1), (0, 0.1)]).outline(300)[:200], rng=0)
    assert not all(half.measured)
    assert "(" in repr(half).partition("mm, ")[2]
    assert repr(Found([half])).splitlines()[-1] == "In brackets: supposed, not measured."


def test_what_was_found_is_a_list():
    assert isinstance(FOUND, list)
    assert [*FOUND] == FOUND == FOUND[:]
    assert len(FOUND) == 2
    assert FOUND[-1] is FOUND[1]
    assert FOUND[:] is not FOUND
    assert type(FOUND[::-1]) is type(copy.copy(FOUND)) is type(pickle.loads(pickle.dumps(FOUND))) is Found
    assert pickle.loads(pickle.dumps(FOUND))[0].shape == FOUND[0].shape
    assert type(pk.find_shapes(GRID.points(), 2, settings=pk.Settings(line_trials=200), rng=0)) is Found


@pytest.mark.parametrize(
    ("shape", "measured", "texts"),
    [
        (pk.Circle((0, -0.1), 0.05), (), ("0.0, -100.0", "radius 50.0")),
        (pk.Circle((0, 0), 0.05), (False,), ("0.0, 0.0", "radius (50.0)")),
        (pk.Polygon([(0, 0), (0.03, 0), (0, 0.04)]), (True, False, True), ("10.0, 13.3", "sides 30.0, (50.0), 40.0")),
    ],
    ids=["circle", "supposed", "triangle"],
)
def test_a_shape_in_millimetres(shape, measured, texts):
    assert in_mm(shape, measured) == texts


def test_of_many_sides_some_are_told():
    turns = np.arange(8) * np.pi / 4
    octagon = pk.Polygon(0.1 * np.column_stack([np.cos(turns), np.sin(turns)]))
    assert in_mm(octagon)[1] == f"sides {', '.join(['76.5'] * 6)}, ... (8 sides)"


def test_a_census_is_in_the_order_of_the_kinds():
    assert census(WORLD.shapes[::-1]) == census(WORLD.shapes) == "2 shapes: 1 circle, 1 rectangle"


def test_a_thumbnail_escapes_its_text():
    html = thumbnail("<script>&")
    assert "<script>" not in html
    assert ElementTree.fromstring(html).findtext("p") == "<script>&"
    assert words_in(html) == ["<script>&"]


def test_a_column_without_a_name_has_no_header_that_is_read_aloud():
    head = re.search("<thead>.*</thead>", Table(("", "a"), [("b", "1")])._repr_html_())[0]
    assert re.findall(r"<(\w+)[^>]*>([^<]*)</\1>", head) == [("td", ""), ("th", "a")]


def test_a_thumbnail_is_upright_and_holds_all():
    svg = svg_in(thumbnail("a", dots=[(0, 0), (0, 1), (0.00001, 1)], places=[(1, 1)], way=[(0, 0), (1, 0)]))
    assert 'd="M6 274h0M6 6h0"' in svg  # y upwards; two dots in one pixel are one
    assert 'd="M274 6h0"' in svg
    assert 'points="6,274 274,274"' in svg


def test_a_huge_world_shows_its_first_shapes(monkeypatch):
    monkeypatch.setattr("primkit.world.MOST_DRAWN", 20)
    html = pk.World([pk.Circle((0.04 * k - 0.4, 0), 0.01) for k in range(21)])._repr_html_()
    assert svg_in(html).count("<polygon") == 1 + 20
    assert "the first 20 are drawn" in html


def test_the_story_shows_itself_without_matplotlib():
    code = (
        "import sys, primkit as pk; world = pk.random_world(2, rng=0); world._repr_html_(); "
        "pk.scan(world, (0, 0, 0))._repr_html_(); pk.Grid()._repr_html_(); print('matplotlib' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout == "False\n"


def test_help_has_a_signature_that_can_be_read():
    told = str(inspect.signature(pk.find_shapes))
    assert "settings: 'Settings' = ROBUST," in told
    assert len(told) < 300
