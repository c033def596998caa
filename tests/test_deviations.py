"""Standard deviations: right on average over many draws, and infinite for what was never seen."""

from dataclasses import replace

import numpy as np
import pytest

import primkit as pk
from primkit.measure import measure_shape
from primkit.robust import deviations
from primkit.robust.deviations import certainty, sides_seen
from primkit.robust.scatter import CELL_STD, LEAST_SPREAD, MEAN_ACROSS, spread_across
from tests.benchmarks.open_world.boards import rng_of, seen_on
from tests.test_outlines import outline_of

TRIANGLE = pk.Polygon([(-0.08, -0.05), (0.08, -0.05), (0.0, 0.09)])
RECTANGLE = pk.Polygon([(-0.1, -0.04), (0.1, -0.04), (0.1, 0.04), (-0.1, 0.04)]).moved(angle=0.4)
ANGLES = np.radians([80, 152, 224, 296, 368])
PENTAGON = pk.Polygon(0.08 * np.column_stack([np.cos(ANGLES), np.sin(ANGLES)]))
SHAPES = {"circle": pk.Circle((0.1, 0.2), 0.07), "triangle": TRIANGLE, "rectangle": RECTANGLE, "pentagon": PENTAGON}


@pytest.mark.parametrize("kind", SHAPES)
@pytest.mark.parametrize("noise", [0.001, 0.003])
def test_the_stated_deviation_is_the_real_one(kind, noise):
    """Over 60 draws of the noise, errors divided by their stated deviation have a deviation of one."""
    true, errors = SHAPES[kind], []
    for draw in range(60):
        rng = np.random.default_rng([draw, 7])
        points = true.outline(220) + rng.normal(0, noise, (220, 2))
        found = measure_shape(points, noise, rng=0)
        if found.kind != kind:
            continue
        match = pk.evaluate([found], pk.World([true])).matches[0]
        center = match.center_error / found.center_std
        dimensions = np.array(found.shape.dimensions) if kind in ("circle", "rectangle") else None
        errors.append(center)
        if dimensions is not None:
            errors.append((dimensions - true.dimensions) / found.dimension_std)
    z = np.concatenate(errors)
    assert 0.85 < z.std() < 1.2
    assert 0.91 <= np.mean(np.abs(z) < 1.96) <= 0.99


def test_a_circles_deviation_has_a_closed_form():
    """All around, radius: std / sqrt(N); centre: std sqrt(2 / N)."""
    circle, rng = pk.Circle((0, 0), 0.1), np.random.default_rng(0)
    points = circle.outline(1000) * (1 + rng.normal(0, 0.002, 1000) / 0.1)[:, None]
    sure = certainty(circle, points, 0.002, noise_std=0.002 / MEAN_ACROSS**0.5)
    assert sure.dimension_std[0] == pytest.approx(0.002 / np.sqrt(1000), rel=0.1)
    assert sure.center_std == pytest.approx([0.002 * np.sqrt(2 / 1000)] * 2, rel=0.1)


def test_the_errors_of_cells_even_out_where_all_of_them_are_hit():
    """Errors over stated deviations, of circles on all the cells that they cross: counted as random they were 0.66."""
    rng, errors = np.random.default_rng(5), []
    for _ in range(150):
        ring, grid = pk.Circle(rng.uniform(-0.01, 0.01, 2), rng.uniform(0.05, 0.07)), pk.Grid()
        grid.add(ring.outline(5000))
        fit = pk.fit_circle(grid.points())
        sure = certainty(fit, grid.points(), LEAST_SPREAD)
        errors += [*((fit.center - ring.center) / sure.center_std), (fit.radius - ring.radius) / sure.dimension_std[0]]
    assert 0.73 < np.std(errors) < 1.0


def test_a_side_along_the_cells_stays_unsure_however_many_points_there_are():
    """A wall at x = 0.1234 m falls into the same cells from end to end: the cell's deviation remains."""
    upright = pk.Polygon([(-0.1, -0.05), (0.1, -0.05), (0.1, 0.05), (-0.1, 0.05)])
    for polygon, least, most in ((upright, 0.8, 1.6), (upright.moved(angle=0.5), 0.0, 0.35)):
        sure = certainty(outline_of(polygon), polygon.outline(2000), 0.0004, square=True)
        assert least * CELL_STD <= min(sure.dimension_std)
        assert max(sure.dimension_std) <= most * CELL_STD


def test_dimensions_that_hang_on_an_unseen_side_are_not_measured():
    points = RECTANGLE.outline(400)
    side = RECTANGLE.vertices[:2]
    along = (side[1] - side[0]) / np.linalg.norm(side[1] - side[0])
    away = np.abs((points - side[0]) @ [-along[1], along[0]]) > 0.003
    found = measure_shape(points[away], 0.0, rng=0)
    assert found.kind == "rectangle"
    assert found.measured == (True, False)  # the unseen side is a long one: the width is seen, the height is not
    assert found.center_std == (float("inf"),) * 2


def test_every_dimension_is_measured_when_all_was_seen():
    for shape in SHAPES.values():
        assert all(measure_shape(shape.outline(250), 0.0, rng=0).measured)


def test_every_dimension_has_a_deviation_whatever_was_seen():
    """Also four sides without right angles, which have two dimensions as a rectangle has."""
    kite = pk.Polygon([(0, 0), (0.2, 0.03), (0.22, 0.2), (0.05, 0.14)])
    for shape in (*SHAPES.values(), kite):
        points = shape.outline(250)
        for share in (1.0, 0.8, 0.6):
            found = measure_shape(points[: int(share * 250)], 0.0, rng=0)
            if found is not None:
                assert len(found.dimension_std) == len(found.measured) == len(found.shape.dimensions)


def test_a_line_over_a_hidden_side_is_not_seen():
    """It touches the last points of both neighbours, which lie near its corners."""
    outline, points = outline_of(PENTAGON), PENTAGON.outline(300)
    hidden = np.abs(outline.distances(points)[0, :, 2]) < 0.0015
    kept = points[~hidden]
    assert sides_seen(outline, points, 0.0004).all()
    assert sides_seen(outline, kept, 0.0004).tolist() == [True, True, False, True, True]


def test_a_wall_that_noise_widens_into_a_strip_has_no_sides_of_its_own():
    """Points of one straight piece lie on both long sides of a strip along it; their distance was not measured."""
    strip, rng = pk.Polygon([(0, 0), (0.28, 0), (0.28, 0.006), (0, 0.006)]), np.random.default_rng(0)
    wall = np.column_stack([rng.uniform(0, 0.28, 900), rng.normal(0.003, 0.005, 900)])
    assert not sides_seen(outline_of(strip), wall, 0.003).any()
    assert sides_seen(outline_of(strip), strip.outline(900), LEAST_SPREAD).sum() == 2  # without noise, they are seen


def test_the_published_method_states_no_deviation():
    found = pk.find_shapes(
        TRIANGLE.outline(200), 1, settings=pk.Settings(grouping="kmeans", method="published", line_trials=200), rng=0
    )
    assert all(d.dimension_std == () for d in found)


def test_the_neighbours_of_a_hidden_side_are_not_measured_either():
    """Nobody saw where they end."""
    points = PENTAGON.outline(400)
    outline = outline_of(PENTAGON)
    found = measure_shape(points[np.abs(outline.distances(points)[0, :, 2]) > 0.0015], 0.0, rng=0)
    assert found.kind == "pentagon"
    assert sorted(found.measured) == [False, False, False, True, True]
    unseen = int(np.argmin(found.seen))
    assert not any(found.measured[(unseen + step) % 5] for step in (-1, 0, 1))


def test_a_short_piece_of_a_side_or_a_circle_measures_nothing():
    """A third of a side may as well be a piece of something else; so may a third of a circle."""
    points, outline = PENTAGON.outline(400), outline_of(PENTAGON)
    begin, end = outline.spans()
    on_it = np.abs(outline.distances(points)[0, :, 2]) < 1e-9
    place = (outline.along(points)[0, :, 2] - begin[0, 2]) / (end - begin)[0, 2]
    for share, enough in ((0.35, False), (0.7, True)):
        kept = points[~on_it | (place < share)]
        assert sides_seen(outline, kept, 0.0004).tolist() == [True, True, enough, True, True]
    circle, ring = pk.Circle((0, 0), 0.1), pk.Circle((0, 0), 0.1).outline(300)
    for share, enough in ((0.3, False), (0.5, True)):
        sure = certainty(circle, ring[: int(300 * share)], 0.0004)
        assert np.isfinite(sure.dimension_std[0]) == enough


def test_arcs_under_noise_have_honest_deviations():
    """Circles that robots on one side see with 5 mm noise: 95 % of the radii lie within 1.96 deviations."""
    z = []
    for seed in range(100):
        rng = np.random.default_rng([17, seed])
        true, bearing = pk.Circle((0, 0), rng.uniform(0.05, 0.1)), rng.uniform(-0.5, 0.5, 30)
        away = true.radius + rng.uniform(0.06, 0.2, 30)
        poses = np.column_stack([away * np.cos(bearing), away * np.sin(bearing), rng.uniform(0, 6, 30)])
        grid = pk.Grid()
        grid.add(pk.scan(pk.World([true]), poses, pk.Lidar(noise_std=0.005), rng=rng))
        found = measure_shape(grid.points(), spread_across(0.005), rng=0)
        if found is not None and found.kind == "circle" and found.measured[0]:
            z.append((found.shape.radius - true.radius) / found.dimension_std[0])
    assert len(z) > 50
    assert 0.88 <= np.mean(np.abs(z) < 1.96) <= 1.0
    assert abs(np.mean(z)) < 0.4


def errors_over_deviations(n, *, cell=0.001, noise=0.0, slip=0.0, bare=False):
    """Return the errors of centres and dimensions over their deviations, of a turned shape on each of n boards."""
    z = []
    for seed in range(n):
        rng = np.random.default_rng([23, seed])
        world = pk.random_world(1, style="free", rng=rng)
        scans, grid = pk.scan(world, pk.teleport_poses(world), pk.Lidar(noise_std=noise), rng=rng), pk.Grid(cell)
        slips = np.column_stack([rng.normal(0, slip, (len(scans), 2)), np.zeros(len(scans))])
        grid.add(replace(scans, poses=scans.poses + slips))
        found = pk.find_shapes(grid.points() if bare else grid, resolution=cell if bare else None, rng=0)
        for match in pk.evaluate(found, world).matches:
            if match.kind_right:
                one = next(one for one in found if one.shape is match.found)
                z += [*match.center_error / one.center_std, *np.divide(match.dimension_error, one.dimension_std)]
    return np.array(z)


SEEN = {
    "cells of 2 mm": {"cell": 0.002},
    "noise of 5 mm": {"noise": 0.005},
    "a slip of 1 mm": {"slip": 0.001},
    "a slip of 1 mm, and noise": {"slip": 0.001, "noise": 0.002},
}


@pytest.mark.parametrize("how", SEEN.values(), ids=SEEN)
def test_errors_are_as_large_as_stated(how):
    """On 40 boards; on a thousand: ``python -m tests.benchmarks.calibration``."""
    z = errors_over_deviations(40, **how)
    assert 0.75 < z.std() < 1.2
    assert 0.9 <= np.mean(np.abs(z) < 1.96) <= 0.99


def test_e16_points_alone_do_not_hide_that_poses_slipped():
    """Nobody knows which of them slipped together: that they may have, is stated."""
    z = errors_over_deviations(40, slip=0.002, bare=True)
    assert np.mean(np.abs(z) < 1.96) >= 0.9


def test_points_alone_are_as_sure_as_a_grid_when_the_noise_is_told():
    world = pk.random_world(1, style="free", kinds=("rectangle",), rng=3)
    grid = pk.Grid()
    grid.add(pk.scan(world, pk.teleport_poses(world), pk.Lidar(noise_std=0.003), rng=0))
    told = pk.Settings(noise_std=0.003)
    by_grid, alone, and_told = (
        np.array(pk.find_shapes(seen, settings=how, rng=0)[0].dimension_std)
        for seen, how in ((grid, pk.ROBUST), (grid.points(), pk.ROBUST), (grid.points(), told))
    )
    np.testing.assert_allclose(and_told, by_grid, rtol=0.2)
    assert (alone > 1.3 * and_told).all()


def test_a_number_that_can_slip_to_one_side_is_as_uncertain_as_the_likelihood_says(monkeypatch):
    """Of a triangle with a sharp corner two sides are 4.1 and 3.4 of the deviations to first order too short."""
    rng = rng_of(31, 69)
    world = pk.random_world(4, style="free", rng=rng)
    grid = seen_on(world, rng, noise_std=0.002)

    def farthest_off():
        found = pk.find_shapes(grid, rng=0)
        off = [
            np.abs(np.sort(found[f].shape.dimensions) - np.sort(world.shapes[t].dimensions))
            / np.take(found[f].dimension_std, np.argsort(found[f].shape.dimensions))
            for f, t in pk.match(found, world.shapes)
        ]
        return max(map(np.max, off))

    wider = farthest_off()
    monkeypatch.setattr(deviations, "LEAST_RISE", 0.0)
    assert wider < 3 < 4 < farthest_off()
