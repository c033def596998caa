"""Measuring: every kind at every rotation, noise, strays, unseen stretches; walls are no shapes."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import primkit as pk
from primkit.measure import measure_shape
from primkit.robust.candidates import candidates
from primkit.robust.scatter import LEAST_SPREAD, spread_of

KINDS = ("circle", "triangle", "rectangle", "pentagon")


def shape_of(seed, kind):
    return pk.random_world(1, style="free", kinds=[kind], rng=seed).shapes[0]


def assert_same(found, true, tolerance):
    report = pk.evaluate([found], pk.World([true]), tolerance)
    assert report.weighted_accuracy == 1.0, str(report)


@pytest.mark.parametrize("kind", KINDS)
@settings(max_examples=12)
@given(seed=st.integers(0, 10_000))
def test_an_exact_outline_gives_the_exact_shape(kind, seed):
    true = shape_of(seed, kind)
    found = measure_shape(true.outline(250), 0.0, rng=0)
    assert_same(found.shape, true, 1e-4)
    assert found.margin > 10
    assert found.rms < 1e-4
    assert min(found.seen) == 1.0


@pytest.mark.parametrize("kind", KINDS)
def test_noise_and_strays(kind):
    for seed in range(15):
        true, rng = shape_of(seed, kind), np.random.default_rng(seed)
        points = true.outline(250) + rng.normal(0, 0.002, (250, 2))
        strays = true.centroid + rng.uniform(-0.12, 0.12, (6, 2))
        found = measure_shape(np.vstack([points, strays]), 0.002, rng=0)
        assert_same(found.shape, true, 0.005)


@settings(max_examples=25)
@given(st.integers(0, 10_000), st.floats(-3, 3), st.floats(-5, 5), st.floats(-5, 5))
def test_turning_and_shifting_the_points_turns_and_shifts_the_shape(seed, angle, dx, dy):
    """A whole rigid motion of the points moves the result with them."""
    true = shape_of(seed, KINDS[seed % 4])
    points = true.outline(200) + np.random.default_rng(seed).normal(0, 0.0005, (200, 2))
    c, s = np.cos(angle), np.sin(angle)
    turn = np.array([[c, s], [-s, c]])
    here = measure_shape(points, 0.0005, rng=0)
    there = measure_shape(points @ turn + [dx, dy], 0.0005, rng=0)
    assert here.kind == there.kind
    np.testing.assert_allclose(here.shape.centroid @ turn + [dx, dy], there.shape.centroid, atol=3e-5)
    np.testing.assert_allclose(sorted(here.shape.dimensions), sorted(there.shape.dimensions), atol=2e-4)


def test_a_rectangle_with_an_unseen_side_is_closed_by_the_hull():
    true = pk.Polygon([(-0.1, -0.04), (0.1, -0.04), (0.1, 0.04), (-0.1, 0.04)])
    points = true.outline(300)
    found = measure_shape(points[points[:, 0] < 0.0995], 0.0, rng=0)
    assert_same(found.shape, true, 0.0025)  # the last points seen lie up to 2 mm before the corners
    assert sum(share < 0.5 for share in found.seen) == 1


def test_a_pentagon_with_an_unseen_side_is_still_a_pentagon():
    angles = np.radians([90, 162, 234, 306, 378])
    true = pk.Polygon(0.08 * np.column_stack([np.cos(angles), np.sin(angles)]))
    points = true.outline(400)
    unseen = points[:, 1] < true.vertices[:, 1].min() + 0.001
    found = measure_shape(points[~unseen], 0.0, rng=0)
    assert found.kind == "pentagon"
    assert_same(found.shape, true, 0.003)


NO_SHAPE = {
    "no points": [],
    "seven points": pk.Circle((0, 0), 0.05).outline(7),
    "a straight wall": [(x / 200, 0.1) for x in range(60)],
    "all points equal": [(0.1, 0.1)] * 20,
    "a noisy wall": np.column_stack([np.linspace(0, 0.3, 80), np.random.default_rng(0).normal(0, 0.001, 80)]),
}


@pytest.mark.parametrize("points", NO_SHAPE.values(), ids=NO_SHAPE)
def test_no_shape(points):
    assert measure_shape(points, 0.001, rng=0) is None


FAILURES = {
    "points that are not finite": (([(0, np.nan)] * 9, 0.001), "points must be finite, got (0.0, nan) in row 0"),
    "points of a wrong shape": (([1, 2, 3], 0.001), "points must have shape (N, 2), got shape (3,)"),
    "a negative spread": (([(0, 0)], -1), "spread must be a finite number >= 0, got -1"),
}


@pytest.mark.parametrize(("arguments", "message"), FAILURES.values(), ids=FAILURES)
def test_failure(arguments, message):
    with pytest.raises(ValueError) as error:  # noqa: PT011 - the whole message is compared below
        measure_shape(*arguments)
    assert str(error.value) == message


def test_candidates_are_ranked_and_name_every_kind():
    ranked = candidates(shape_of(1, "pentagon").outline(200), LEAST_SPREAD)
    assert [c.cost for c in ranked] == sorted(c.cost for c in ranked)
    assert {c.kind for c in ranked} >= {"wall", "pentagon"}
    assert ranked[0].kind == "pentagon"


def test_the_margin_is_small_where_the_points_cannot_say():
    """A small pentagon under much noise looks like a circle: the margin says that the choice is unsure."""
    true = pk.Polygon(0.04 * np.column_stack([np.cos(a := np.arange(5) * 0.4 * np.pi), np.sin(a)]))
    rng = np.random.default_rng(5)
    unsure = measure_shape(true.outline(80) + rng.normal(0, 0.006, (80, 2)), 0.006, rng=0)
    sure = measure_shape(true.outline(80) + rng.normal(0, 0.0005, (80, 2)), 0.0005, rng=0)
    assert unsure.margin < 20 < sure.margin


@pytest.mark.parametrize("std", [0.0005, 0.001, 0.002, 0.004])
def test_spread_is_estimated_from_neighbours(std):
    rng = np.random.default_rng(0)
    points = pk.Circle((0, 0), 0.08).outline(300)
    points = points * (1 + rng.normal(0, std, 300) / 0.08)[:, None]
    assert spread_of(points) == pytest.approx(std, rel=0.25)


def test_spread_has_the_cells_as_its_floor():
    assert spread_of(pk.Circle((0, 0), 0.08).outline(300)) == LEAST_SPREAD
    assert spread_of([(0, 0)]) == LEAST_SPREAD


def test_more_sides_lie_closer_but_do_not_win():
    """On noisy triangles a fit with more sides has the smaller residuals; its price decides against it."""
    triangle = pk.Polygon([(-0.1, -0.06), (0.1, -0.06), (0.0, 0.1)])
    for seed in range(10):
        points = triangle.outline(200) + np.random.default_rng(seed).normal(0, 0.003, (200, 2))
        assert measure_shape(points, 0.003, rng=0).kind == "triangle"
