"""Scale: every length of the method follows the cell: a larger board is the same board, and so is one far away."""

import numpy as np
import pytest

import primkit as pk
from primkit.measure import measure_shape
from primkit.segmentation import count_by_silhouette
from tests.benchmarks.open_world.account import UTM
from tests.benchmarks.open_world.ordinary import SAME, apart_by, board
from tests.helpers import exactly


def numbers(one):
    corners = one.shape.center if one.kind == "circle" else one.shape.vertices
    return [*np.ravel(corners), *one.shape.dimensions, one.rms, *one.center_std, *one.dimension_std]


@pytest.mark.parametrize(("settings", "k"), [(pk.PAPER, 10), *((pk.ROBUST, k) for k in (0.01, 0.1, 0.3, 3, 10, 100))])
def test_the_same_points_enlarged_are_the_same_shapes(settings, k):
    for seed in range(1 if settings is pk.PAPER else 3):
        _, grid = board(seed, 0.002 * (seed % 2))
        told = 4 if settings is pk.PAPER else None
        here = pk.find_shapes(grid.points(), told, settings=settings, rng=0)
        there = pk.find_shapes(grid.points() * k, told, settings=settings, resolution=0.001 * k, rng=0)
        assert len(here) >= 3
        assert apart_by(there, here, k) <= SAME
        for new, old in zip(there, here, strict=True):
            np.testing.assert_allclose(numbers(new), np.array(numbers(old)) * k, rtol=1e-7, atol=1e-9 * k)
            assert len(new.points) == len(old.points)
            assert new.margin == pytest.approx(old.margin, rel=1e-6, nan_ok=True)


@pytest.mark.parametrize("k", [0.1, 10])
def test_noise_that_is_told_is_enlarged_too(k):
    _, grid = board(1, 0.002)
    here = pk.find_shapes(grid.points(), settings=pk.Settings(noise_std=0.002), rng=0)
    how = pk.Settings(noise_std=0.002 * k)
    there = pk.find_shapes(grid.points() * k, settings=how, resolution=0.001 * k, rng=0)
    assert len(here) >= 3
    for new, old in zip(there, here, strict=True):
        np.testing.assert_allclose(numbers(new), np.array(numbers(old)) * k, rtol=1e-7, atol=1e-9 * k)


@pytest.mark.parametrize("k", [0.01, 3, 8, 100])
def test_a_grid_knows_its_own_cells(k):
    for seed in range(3):
        large, grid = board(seed, 0.0, k)
        assert pk.evaluate(pk.find_shapes(grid, rng=0), large, 0.005 * k, gate=0.1 * k).weighted_accuracy == 1.0


def test_a_board_far_away_is_the_same_board():
    """In UTM coordinates, half a million metres east and five million north, digits are not lost."""
    for seed in range(3):
        _, grid = board(seed, 0.001 * (seed % 2))
        here, there = pk.find_shapes(grid, rng=0), pk.find_shapes(grid.points() + UTM, rng=0)
        assert [one.kind for one in there] == [one.kind for one in here]
        for new, old in zip(there, here, strict=True):
            np.testing.assert_allclose(new.shape.outline(7), old.shape.moved(UTM).outline(7), rtol=0, atol=2e-6)


def test_the_silhouette_counts_far_away_as_here():
    """Squared distances are differences of squares in scikit-learn: far away, 4 groups for 3."""
    rng = np.random.default_rng(9)
    points = np.vstack([rng.uniform(-0.4, 0.4, 2) + rng.normal(0, 0.03, (12, 2)) for _ in range(4)])
    assert [count_by_silhouette(points + far, 6, rng=0) for far in (0.0, UTM)] == [3, 3]


def test_own_fits_are_given_metres_and_return_metres():
    square = pk.Polygon([(9, 9), (11, 9), (11, 11), (9, 11)])
    points = np.vstack([square.outline(800), pk.Circle((12, 10), 0.5).outline(300)])
    given = []

    def line(points):
        given.append(points)
        return pk.fit_line(points)

    def circle(points):
        given.append(points)
        return pk.fit_circle(points)

    steps = pk.Steps(fit_line=line, fit_circle=circle)
    found = pk.find_shapes(points, resolution=0.01, steps=steps, rng=0)
    assert [d.kind for d in found] == ["rectangle", "circle"]
    np.testing.assert_allclose(found[0].shape.centroid, (10, 10), atol=1e-3)
    assert found[1].shape.radius == pytest.approx(0.5, abs=1e-6)
    assert min(p.min() for p in given) > 8.9


def test_one_shape_is_measured_on_any_cells():
    ring = pk.Circle((100, 200), 30).outline(400)
    found = measure_shape(ring, 0.0, resolution=0.5, rng=0)
    assert found.shape.radius == pytest.approx(30, abs=1e-6)
    assert max(found.center_std) < 0.1


@pytest.mark.parametrize("bad", [0, -1, float("nan")])
def test_a_resolution_is_above_zero(bad):
    with pytest.raises(ValueError, match="resolution must be a finite number > 0"):
        pk.find_shapes([(0, 0)], resolution=bad)


def test_a_grid_is_not_told_its_cells():
    message = "resolution must not be given with a grid, which knows its own, got 0.001"
    with pytest.raises(ValueError, match=exactly(message)):
        pk.find_shapes(pk.Grid(), resolution=0.001)
