"""Scatter: the mixture against the sensor itself, against quadrature, and against its own moments."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad
from scipy.stats import norm

import primkit as pk
from primkit.robust.scatter import LEAST_SPREAD, scatter, spread_across, spread_from_median
from primkit.study.oracle import told_points

SPREADS = st.floats(LEAST_SPREAD, 0.02)


@given(SPREADS)
def test_the_density_integrates_to_one_and_has_the_spread(spread):
    x = np.linspace(-12 * spread, 12 * spread, 20_001)
    density, _ = scatter(x, spread)
    assert np.trapezoid(density, x) == pytest.approx(1, abs=1e-6)
    assert np.sqrt(np.trapezoid(x**2 * density, x)) == pytest.approx(spread, rel=1e-6)


@given(SPREADS)
def test_the_weight_is_what_least_squares_needs(spread):
    """weight = -spread^2 d(ln density)/dx / x: weighted residuals sum to zero where the likelihood is largest."""
    x, step = np.linspace(-4 * spread, 4 * spread, 200), 1e-6 * spread
    slope = (np.log(scatter(x + step, spread)[0]) - np.log(scatter(x - step, spread)[0])) / (2 * step)
    np.testing.assert_allclose(scatter(x, spread)[1], -(spread**2) * slope / x, rtol=1e-5)


def test_three_bell_curves_stand_for_the_whole_law():
    """u = sin(angle) even between -1 and 1: the exact density is an integral, and close to the three."""
    for x in (0.0005, 0.003, 0.006, 0.01, 0.02):
        exact, _ = quad(lambda u, x=x: norm.pdf(x, scale=0.01 * np.sqrt(1 - u * u)), 0, 1)
        assert scatter(np.array([x]), spread_across(0.01))[0][0] == pytest.approx(exact, rel=0.12)


def test_the_sensor_scatters_points_as_the_law_says():
    """Points of real scans with 5 mm noise: standard deviation, median and tails."""
    distances = []
    for seed in range(12):
        world, lidar = pk.random_world(4, style="free", rng=seed), pk.Lidar(noise_std=0.005)
        points, owners = told_points(world, pk.scan(world, pk.teleport_poses(world), lidar, rng=seed), lidar)
        distances += [s.signed_distance(points[owners[:, 0] == i]) for i, s in enumerate(world.shapes)]
    d = np.abs(np.concatenate(distances))
    assert np.sqrt(np.mean(d**2)) == pytest.approx(spread_across(0.005), rel=0.05)
    assert spread_from_median(np.median(d)) == pytest.approx(spread_across(0.005), rel=0.05)
    assert np.mean(d**4) / np.mean(d**2) ** 2 == pytest.approx(3 * (8 / 15) / (2 / 3) ** 2, rel=0.1)  # a bell's is 3


def test_without_noise_only_the_cells_are_left():
    assert spread_across(0.0) == LEAST_SPREAD
    assert spread_from_median(0.0) == LEAST_SPREAD
    x = np.linspace(-0.002, 0.002, 9)
    density, weight = scatter(x, LEAST_SPREAD)
    np.testing.assert_allclose(density, norm.pdf(x, scale=LEAST_SPREAD), rtol=1e-12)
    assert weight.tolist() == [1.0] * 9


def test_points_beyond_any_bell_curve_weigh_a_finite_amount():
    density, weight = scatter(np.array([1.0]), 0.001)
    assert 0 < density[0] < 1e-300, "nothing is divided by zero"
    assert np.isfinite(weight[0])
