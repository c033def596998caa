"""Beside the shapes: walls, things of no kind and strays in a report; what is certain; lengths follow the scale."""

import numpy as np
import pytest

import primkit as pk
from primkit.evaluation import GATE, TOLERANCE
from primkit.found import Found, resolution_of
from primkit.measure import CELL, Detection, Other, Wall
from tests.test_account import seen_on
from tests.test_scale import board
from tests.test_unknown import CURVED

SQUARE = pk.Polygon([(-0.2, -0.2), (0, -0.2), (0, 0), (-0.2, 0)])
ROOM = pk.World([SQUARE], walls=True)
NO_POINTS = np.empty((0, 2))


def wall(start, end):
    return Wall(np.array(start), np.array(end), NO_POINTS, 0.0003)


def told(found, world):
    return str(pk.evaluate(found, world).rest)


WALLS = {
    # what was found: right, the nearest of the board's walls, off [m], along the square
    "whole": (wall((-0.5, -0.5), (0.5, -0.5)), True, 0, 0.0, False),
    "a piece": (wall((0.1, -0.5), (0.3, -0.5)), True, 0, 0.0, False),
    "the other way round": (wall((0.5, 0.3), (0.5, -0.2)), True, 1, 0.0, False),
    "at the tolerance": (wall((-0.5, -0.495), (0.5, -0.495)), True, 0, 0.005, False),
    "beside it": (wall((-0.5, -0.494), (0.5, -0.494)), False, 0, 0.006, False),
    "turned": (wall((-0.5, -0.5), (0.5, -0.493)), False, 0, 0.007, False),
    "too long": (wall((-0.5, -0.5), (0.507, -0.5)), False, 0, 0.007, False),
    "a side of the square": (wall((-0.2, -0.2), (0.0, -0.201)), False, 0, 0.3, True),
    "across the square": (wall((-0.1, -0.2), (-0.1, 0.0)), False, 3, 0.4, False),
    "a diagonal of the square": (wall((-0.2, -0.2), (0.0, 0.0)), False, 0, 0.5, False),
}


@pytest.mark.parametrize(("found", "right", "true", "off", "side"), WALLS.values(), ids=WALLS)
def test_a_wall_lies_along_one_that_is_there(found, right, true, off, side):
    (match,) = pk.evaluate(Found(walls=[found]), ROOM).rest.walls
    assert (match.right, match.side_of is SQUARE) == (right, side)
    assert match.off == pytest.approx(off, abs=1e-9)
    if off < 0.3:
        assert match.true == true


SENTENCES = {
    "nothing": (Found(), pk.World(), ""),
    "shapes alone": (Found(), pk.World([SQUARE]), ""),
    "walls missed": (Found(), ROOM, "Beside the shapes: no walls, 4 of the board's 4 missed."),
    "one of each": (
        Found(walls=[WALLS["whole"][0], WALLS["a side of the square"][0], WALLS["turned"][0]]),
        ROOM,
        "Beside the shapes: 3 walls, 1 right, 1 along a shape, 1 wrong, 3 of the board's 4 missed.",
    ),
    "all right": (
        Found(walls=[wall(*ends) for ends in ROOM.walls]),
        ROOM,
        "Beside the shapes: 4 walls, all right.",
    ),
    "a wall on a board without": (
        Found(walls=[WALLS["whole"][0]]),
        pk.World(),
        "Beside the shapes: 1 wall, 0 right, 1 wrong.",
    ),
    "strays": (
        Found(strays=np.array([(0.4, 0.4), (-0.1, 0.001), (0.3, -0.4)])),
        pk.World([SQUARE]),
        "Beside the shapes: 3 strays, 1 of them on an outline.",
    ),
    "a stray on a wall": (
        Found(strays=np.array([(0.4, -0.499)])),
        pk.World(walls=True),
        "Beside the shapes: no walls, 4 of the board's 4 missed; 1 stray, on an outline.",
    ),
    "strays on nothing": (
        Found(strays=np.array([(0.4, 0.4), (0.3, 0.3)])),
        pk.World(),
        "Beside the shapes: 2 strays, none of them on an outline.",
    ),
    "strays on outlines alone": (
        Found(strays=SQUARE.outline(8)),
        pk.World([SQUARE]),
        "Beside the shapes: 8 strays, all of them on an outline.",
    ),
    "things": (
        Found(others=[Other(SQUARE.outline(60), SQUARE.vertices), Other(np.full((9, 2), 0.4), SQUARE.vertices)]),
        pk.World([SQUARE]),
        "Beside the shapes: 2 things of no kind, in truth a rectangle and nothing that is there.",
    ),
}


@pytest.mark.parametrize(("found", "world", "sentence"), SENTENCES.values(), ids=SENTENCES)
def test_the_rest_in_a_sentence(found, world, sentence):
    report = pk.evaluate(found, world)
    assert str(report.rest) == sentence
    assert sentence in repr(report)
    assert repr(report).count("\n") == 3 + len(world.shapes) + bool(sentence)
    assert sentence in report._repr_html_().replace("&#x27;", "'")


def test_walls_things_and_strays_leave_the_scores_as_they_are():
    shapes = [Detection(SQUARE, SQUARE.outline(60), 0.0)]
    rest = {"walls": [WALLS["turned"][0]], "others": [Other(NO_POINTS, NO_POINTS)], "strays": np.full((3, 2), 0.4)}
    bare, full = pk.evaluate(shapes, pk.World([SQUARE])), pk.evaluate(Found(shapes, **rest), pk.World([SQUARE]))
    assert bare.scores() == full.scores()
    assert full.false_alarms == ()


def test_a_walled_board_is_told_whole():
    ellipse = pk.Polygon(CURVED["ellipse 2"]).moved((0.25, 0.2), 0.4)
    world = pk.World([pk.Circle((-0.25, 0.2), 0.08), ellipse], walls=True)
    report = pk.evaluate(pk.find_shapes(seen_on(world, spurious=0.01), rng=0), world)
    assert [m.right for m in report.rest.walls] == [True] * 4
    assert [shape for _, shape in report.rest.things] == [ellipse] == list(report.missed)
    assert [row[1] for row in report.rows()] == ["circle", "of no kind"]
    assert report.rest.n_strays > 10
    assert report.rest.n_lost < 5


class Said:
    """How certain a shape is said to be."""

    margin = 0.0

    def __init__(self, certain):
        self.certain = certain


def said(shape, certain):
    return Detection(shape, shape.outline(60), 0.0, choice=None if certain is None else Said(certain))


def test_what_is_not_certain_is_told_beside_the_verdict():
    near, far = SQUARE.moved((0.001, 0)), pk.Circle((0.3, 0.3), 0.05)
    world = pk.World([SQUARE])
    for certain, doubt in ((True, ""), (False, ", not certain"), (None, "")):
        report = pk.evaluate([said(near, certain), said(far, certain)], world)
        assert [row[-1] for row in report.rows()] == ["right" + doubt, "false alarm" + doubt]
        assert report.uncertain == ((near, far) if doubt else ())
        assert report.certain_and_wrong == ((far,) if certain else ())
    coin = pk.Circle(SQUARE.centroid, 0.1)
    assert pk.evaluate([said(coin, True)], world).certain_and_wrong == (coin,)
    assert pk.evaluate([said(coin, False)], world).certain_and_wrong == ()


# --- lengths that are not given --------------------------------------------------------------------------------------

SCALES = {
    # board [m], cells [m]: times 5 mm and 10 cm
    "the usual": (1.0, 0.001, 1),
    "coarse cells": (1.0, 0.005, 1),
    "fine cells": (1.0, 0.0005, 1),
    "a large board": (10.0, 0.001, 1),
    "a small board": (0.4, 0.001, 1),
    "ten times as large": (10.0, 0.01, 10),
    "a room": (8.0, 0.01, 8),
    "a hall on coarse cells": (20.0, 0.005, 5),
    "a tenth": (0.1, 0.0001, 0.1),
}


@pytest.mark.parametrize(("size", "cell", "scale"), SCALES.values(), ids=SCALES)
def test_tolerance_and_gate_follow_board_and_cells_together(size, cell, scale):
    true, world = pk.Circle((0, 0), 0.04), pk.World([pk.Circle((0, 0), 0.04)], size)
    for off, pairs in ((scale * GATE * 0.999, 1), (scale * GATE * 1.001, 0)):
        far = [Detection(pk.Circle((off, 0), 0.04), true.outline(60), 0.0)]
        report = pk.evaluate(Found(far, resolution=cell), world)
        assert len(report.matches) == pairs
        assert report.tolerance == pytest.approx(scale * TOLERANCE)
        assert report.scores().endswith(f"(within {5 * scale:g} mm)")
    assert pk.evaluate(Found(far, resolution=cell), world, 0.002, gate=0.03).tolerance == 0.002


@pytest.mark.parametrize("k", [0.1, 10])
def test_a_board_of_another_size_needs_no_further_setting(k):
    world, grid = board(3, 0.0, k)
    found = pk.find_shapes(grid, rng=0)
    assert found.resolution == found[:1].resolution == resolution_of(list(found)) == pytest.approx(k * CELL)
    for report in (pk.evaluate(found, world), pk.evaluate(list(found), world)):
        assert report.weighted_accuracy == 1.0
        assert report.tolerance == pytest.approx(k * TOLERANCE)


def test_the_cells_of_what_was_not_measured_here_are_of_1_mm():
    assert resolution_of([]) == resolution_of([SQUARE]) == resolution_of(Found()) == CELL
