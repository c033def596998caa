"""The proofs for an open world run, and what is wrong is against them; their figures are those of the long runs."""

from types import SimpleNamespace

import numpy as np
import pytest

import primkit as pk
from tests.benchmarks.open_world import speed, stopwatch
from tests.benchmarks.open_world.__main__ import LINES
from tests.benchmarks.open_world.account import SETS
from tests.benchmarks.open_world.boards import rng_of, two_flush, two_turned
from tests.benchmarks.open_world.figures import mean, number, share, share_of_things
from tests.benchmarks.open_world.judging import accounted, agrees, in_order, own_of, sure_and_wrong
from tests.benchmarks.open_world.things import CORNERED, SORTS, thing

SQUARE = pk.Polygon([(0, 0), (0.1, 0), (0.1, 0.1), (0, 0.1)])
HEXAGON = thing("regular hexagon", 0)


@pytest.mark.parametrize("line", ["certain", "scale", "unknown", "strays", "planks"])
def test_a_line_has_figures(line):
    measure, _ = LINES[line]
    assert all(np.isnan(figure.value.value) or figure.n > 0 for figure in measure(1, 5))


def test_a_line_gives_the_same_figures_for_a_seed():
    measure, _ = LINES["planks"]
    figures = [str(figure) for figure in measure(3, 5)]
    assert figures == [str(figure) for figure in measure(3, 5)]
    assert figures != [str(figure) for figure in measure(3, 6)]


def test_walls_and_rooms_are_measured():
    figures = {figure.what: figure for figure in LINES["walls"][0](2, 0)}
    assert figures["rooms: walls within 2 cm from end to end"].n == 6
    assert figures["walled boards, 0 mm: shapes right"].n == 3


def test_figures_say_whether_the_goal_was_reached_and_what_is_against_it():
    told = {"a": True, "b": False}
    for figure, against in (
        (share("right", told, at_least=0.9), "b"),
        (share("wrong", told, at_most=0.1), "a"),
        (share_of_things("right", {"a": (2, 2), "b": (1, 3)}, at_least=0.9), "b"),
        (share_of_things("wrong", {"a": (2, 2), "b": (0, 3)}, at_most=0.1), "a"),
        (mean("score", {"a": 1.0, "b": 0.5}, at_least=0.97), "b"),
        (mean("phantoms", {"a": 1, "b": 0}, at_most=0.02), "a"),
        (number("lines", 12, 1, at_most=10), None),
    ):
        assert not figure.reached
        assert "MISSED" in str(figure)
        assert figure.against == (() if against is None else (against,))
    assert share("right", told, at_least=0.5).reached
    assert share("no goal", told).against == ()


def test_all_right_is_an_interval_too():
    assert str(mean("all", {"a": 1.0, "b": 1.0}).value) == "1.000 (0.342-1.000)"


def said(shape, std=0.0003, certain=True):
    """A finding that says so."""
    n = len(shape.dimensions)
    return SimpleNamespace(
        shape=shape,
        kind=shape.kind,
        certain=certain,
        center_std=(std, std),
        dimension_std=(std,) * n,
        points=shape.outline(100),
    )


WIDER = pk.Polygon([(0, 0), (0.108, 0), (0.108, 0.1), (0, 0.1)])
SAID = {
    "the truth": (said(SQUARE), SQUARE, True),
    "from another corner on": (said(pk.Polygon(np.roll(HEXAGON.vertices, 2, axis=0))), HEXAGON, True),
    "another kind": (said(pk.Circle((0.05, 0.05), 0.055)), SQUARE, False),
    "another number of corners": (said(thing("octagon", 0)), HEXAGON, False),
    "8 mm too wide": (said(WIDER), SQUARE, False),
    "8 mm too wide, and knows it": (said(WIDER, 0.0025), SQUARE, True),
    "its width is not measured": (said(WIDER, np.inf), SQUARE, True),
    "beside it": (said(SQUARE.moved((0.01, 0))), SQUARE, False),
}


@pytest.mark.parametrize(("one", "truth", "right"), SAID.values(), ids=SAID)
def test_what_is_sure_and_wrong(one, truth, right):
    assert agrees(one, truth) == right
    assert sure_and_wrong([one], [truth]) == ([] if right else [one])
    assert sure_and_wrong([one], [HEXAGON, truth]) == ([] if right else [one])
    assert sure_and_wrong([said(one.shape, certain=False)], [truth]) == []


def test_a_finding_belongs_to_the_shape_that_its_points_lie_on():
    ring = pk.Circle((0.3, 0), 0.05)
    found = [said(SQUARE), said(ring)]
    assert own_of(found, SQUARE, [ring]) == found[:1]
    assert own_of(found, ring, [SQUARE]) == found[1:]


@pytest.mark.parametrize("sort", SORTS)
def test_things_are_none_of_the_four_kinds_and_their_corners_can_be_told(sort):
    for seed in range(20):
        one = thing(sort, seed)
        assert one.kind == "polygon"
        assert 0.05 < one.reach < 0.22
        assert min(one.sides) >= 0.03 or sort not in CORNERED
    assert thing(sort, 0) != thing(sort, 1)


@pytest.mark.parametrize("gap", [0.002, 0.02])
def test_two_shapes_stand_as_far_apart_as_told(gap):
    for k in range(10):
        assert two_turned(gap, rng_of(0, k)).least_gap() == pytest.approx(gap, abs=1e-9)
        one, other = (world := two_flush(gap, rng_of(0, k))).shapes
        assert world.least_gap() == pytest.approx(gap, abs=1e-9)
        assert (one.normals @ other.normals.T).min() == pytest.approx(-1)


def test_the_way_of_the_points_is_counted():
    figures = {figure.what.strip(): figure.value.value for figure in LINES["simple"][0](1, 0)}
    assert figures["functions that the points come to"] >= figures["in how many files"] > 1
    assert figures["names that the points have in these functions"] >= figures["functions that the points come to"]
    assert figures["lines of robust"] > 500


def test_the_stopwatch_times_a_map_and_a_scan():
    assert 0 < stopwatch.milliseconds(lambda: sum(range(10_000))) < 100
    assert 0 < stopwatch.alone(0)[0] < 100
    assert 0 < speed.percentile_of(np.arange(101.0)).low <= 95 <= speed.percentile_of(np.arange(101.0)).high


@pytest.mark.parametrize("sort", SETS)
def test_every_point_is_in_the_account(sort):
    for k in range(2):
        points = SETS[sort](rng_of(1, k))
        np.testing.assert_array_equal(in_order(accounted(pk.find_shapes(points, rng=0))), in_order(points))
