"""Mapping while driving: the shapes are those of find_shapes on the same grid, for less work."""

from dataclasses import replace

import numpy as np
import pytest

import primkit as pk
from primkit import pipeline
from primkit.pipeline import find_again

from .helpers import exactly


def same(a, b):
    return [d.shape for d in a] == [d.shape for d in b]


def nearly_the_same(a, b, tolerance=0.0001):
    """The same shapes, within a tenth of a millimetre."""
    return [d.kind for d in a] == [d.kind for d in b] and all(
        np.abs(np.subtract(one.shape.dimensions, other.shape.dimensions)).max() <= tolerance
        and np.abs(one.shape.centroid - other.shape.centroid).max() <= tolerance
        for one, other in zip(a, b, strict=True)
        if all(one.measured) and all(other.measured)
    )


def waypoint_scans(world, **sensor):
    return pk.scan(world, pk.teleport_poses(world), pk.Lidar(**sensor), rng=0)


def points_of(world, **sensor):
    grid = pk.Grid()
    grid.add(waypoint_scans(world, **sensor))
    return grid.points()


@pytest.fixture
def measured(monkeypatch):
    """A list that grows by one for each group that is measured from scratch."""
    measured, real = [], pipeline.explained
    monkeypatch.setattr(pipeline, "explained", lambda *a, **k: measured.append(1) or real(*a, **k))
    return measured


@pytest.mark.parametrize("noise_std", [0.0, 0.002])
def test_the_shapes_are_those_of_find_shapes_for_half_the_work(measured, noise_std):
    """While driving, each scan changes one or two groups: few of these are measured from scratch."""
    scans = waypoint_scans(pk.random_world(4, rng=8), noise_std=noise_std)
    settings = replace(pk.ROBUST, noise_std=noise_std)  # else the spread is taken over from the look before
    mapper, by_mapper, afresh = pk.Mapper(settings=settings, rng=0), 0, 0
    mapper.add(scans[:40])
    for number in range(40, len(scans), 2):
        mapper.add(scans[number : number + 2])
        measured.clear()
        fresh = pk.find_shapes(mapper.grid, settings=settings, rng=0)
        afresh += len(measured)
        measured.clear()
        found = mapper.found
        by_mapper += len(measured)
        assert nearly_the_same(fresh, found)
    assert by_mapper < afresh / 2
    measured.clear()
    assert mapper.found is found
    assert same(mapper.look(mapper.grid), found)
    assert measured == []
    assert len(mapper._warm) < 30


@pytest.mark.parametrize(
    "how",
    [
        {},
        {"settings": replace(pk.ROBUST, second_opinion=False)},
        {"settings": pk.PAPER, "n_shapes": 3},
        {"n_shapes": 2},
        {"kinds": ["circle", "rectangle"]},
        {"steps": pk.Steps(segment=lambda points, _: (points[:, 0] > 0).astype(int))},
    ],
    ids=["robust", "own settings", "paper", "number", "kinds", "steps"],
)
def test_a_first_look_is_find_shapes_to_the_last_bit(how):
    mapper = pk.Mapper(rng=3, **how)
    mapper.add(waypoint_scans(pk.random_world(3, rng=9)))
    found, again = mapper.found, pk.find_shapes(mapper.grid, rng=3, **how)
    assert len(found) > 0
    assert same(found, again)
    assert len(found.strays) == len(again.strays)


def test_what_is_new_in_the_grid_is_found_whoever_put_it_there():
    world = pk.random_world(2, rng=4)
    mapper = pk.Mapper(grid=(grid := pk.MovingGrid()), rng=0)
    mapper.add(pk.scan(world, pk.teleport_poses(world)))
    assert mapper.grid is grid
    assert len(mapper.found) == 2
    grid.give_up(np.ones(len(grid), dtype=bool))
    assert mapper.found == []


def test_with_fewer_points_than_shapes_all_are_strays():
    mapper = pk.Mapper(n_shapes=4, settings=pk.PAPER, rng=0)
    mapper.add([(0.1, 0.1), (0.2, 0.1)])
    assert mapper.found == []
    np.testing.assert_array_equal(mapper.found.strays, mapper.grid.points())


def test_a_coarse_grid_is_a_large_board():
    world = pk.World([pk.Circle((2.0, 0.0), 0.6)], size=10)
    mapper = pk.Mapper(0.01, rng=0)
    mapper.add(pk.scan(world, pk.teleport_poses(world), pk.Lidar(range_min=0.5, range_max=3.0)))
    (found,) = mapper.found
    assert found.shape.radius == pytest.approx(0.6, abs=0.005)
    assert repr(mapper) == f"Mapper: {len(mapper.grid):,} occupied cells of 10 mm"


FAILURES = {
    "both": (
        {"resolution": 0.01, "grid": pk.Grid()},
        "resolution must not be given with a grid, which knows its own, got 0.01",
    ),
    "a number for a grid": ({"grid": 0.01}, "grid must be a Grid or a MovingGrid, got float"),
    "no length": ({"resolution": 0}, "resolution must be a finite number > 0, got 0"),
    "settings": ({"settings": "fast"}, "settings must be ROBUST, PAPER or Settings of your own, got str"),
    "steps": ({"steps": 3}, "steps must be Steps, such as Steps(fit_circle=mine), got int"),
    "kinds": ({"kinds": ["oval"]}, "kinds must be some of circle, triangle, rectangle, pentagon, polygon, got 'oval'"),
    "number": ({"n_shapes": -1}, "n_shapes must be a whole number >= 0, got -1"),
    "seed": ({"rng": "x"}, "rng must be a whole number >= 0 or a numpy Generator, got 'x'"),
}


@pytest.mark.parametrize(("arguments", "sentence"), FAILURES.values(), ids=FAILURES)
def test_mapper_failure(arguments, sentence):
    with pytest.raises(ValueError, match=exactly(sentence)):
        pk.Mapper(**arguments)


# --- Warm starts --------------------------------------------------------------------------------------------


def test_a_few_points_may_make_it_another_shape():
    """Three sides of a rectangle are seen first; what is on the fourth is not fitted to what was believed before."""
    square = pk.Polygon([(-0.06, -0.05), (0.06, -0.05), (0.06, 0.05), (-0.06, 0.05)])
    outline, warm = square.outline(400), {}
    order = outline[np.argsort(outline[:, 1], kind="stable")]
    for n in range(150, 401, 10):
        found = find_again(order[:n], warm, rng=0)
    assert nearly_the_same(found, pk.find_shapes(order, rng=0))
    assert [d.kind for d in found] == ["rectangle"]
    assert np.abs(np.subtract(found[0].shape.dimensions, (0.12, 0.1))).max() < 0.0005


def test_the_spread_is_kept_until_the_fits_say_otherwise():
    """The estimate from neighbours is low under noise: a second look does not start from it again."""
    points, warm = points_of(pk.random_world(4, rng=8), noise_std=0.008), {}
    first = find_again(points, warm, rng=0)
    assert len({group.spread for group in warm.values()}) == 2
    again = find_again(points, warm, rng=0)
    assert len({group.spread for group in warm.values()}) == 1
    assert nearly_the_same(first, again)
    quiet = points_of(pk.random_world(4, rng=8))
    assert nearly_the_same(find_again(quiet, warm, rng=0), pk.find_shapes(quiet, rng=0))
    assert max(group.spread for group in list(warm.values())[-1:]) < pipeline.spread_across(0.001)


def test_settings_do_not_mix():
    points, warm = points_of(pk.random_world(3, rng=9), noise_std=0.004), {}
    for settings in (pk.ROBUST, replace(pk.ROBUST, soft=False), pk.ROBUST):
        fresh = pk.find_shapes(points, settings=settings, rng=0)
        assert same(fresh, find_again(points, warm, settings=settings, rng=0))
