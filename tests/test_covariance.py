"""Covariance: what is stated of fitted numbers is what they scatter by, whether points err alone or together."""

from dataclasses import replace

import numpy as np
import pytest

from primkit.robust.covariance import Linearised, covariance
from primkit.robust.scatter import CELL, CELL_STD, MEAN_ACROSS

N_SCANS, PER_SCAN, RADIUS = 30, 12, 0.08


def circle_seen_by_scans(rng, noise, slip, radius=RADIUS):
    """Return a circle's linear fit to points that err alone by ``noise`` and with their scan by ``slip``, and both."""
    scans = np.repeat(np.arange(1, N_SCANS + 1), PER_SCAN)
    bearing = np.repeat(rng.uniform(0, 2 * np.pi, N_SCANS), PER_SCAN) + rng.uniform(-1, 1, N_SCANS * PER_SCAN)
    normals = np.column_stack([np.cos(bearing), np.sin(bearing)])
    slopes = -np.column_stack([normals, np.ones(len(normals))])
    effect = -np.linalg.pinv(slopes)
    shifts = rng.normal(0, slip, (N_SCANS, 2))[scans - 1]
    errors = (normals * shifts).sum(axis=1) + rng.normal(0, noise, len(normals))
    numbers = effect @ errors
    r = errors + slopes @ numbers
    pieces = np.zeros(len(r), dtype=np.int64)
    fit = Linearised(effect, slopes, effect * r, r, normals, radius * normals, pieces, 2 * np.pi * radius)
    return fit, scans, numbers


@pytest.mark.parametrize(("noise", "slip"), [(0.003, 0.0), (0.001, 0.002), (0.003, 0.001)])
def test_the_numbers_scatter_as_stated(noise, slip):
    """Squared errors are as large as stated variances in the mean, which are a little more where few scans tell."""
    squares, variances = np.zeros(3), np.zeros(3)
    for draw in range(300):
        fit, scans, numbers = circle_seen_by_scans(np.random.default_rng([5, draw]), noise, slip)
        squares += numbers**2
        variances += np.diag(covariance(fit, scans))
    assert squares.sum() / variances.sum() == pytest.approx(0.97, abs=0.12)


def test_points_of_unknown_scans_may_share_what_they_scatter_beyond_what_is_told():
    fit, scans, _ = circle_seen_by_scans(np.random.default_rng(0), 0.003, 0.0)
    std = [
        np.sqrt(np.diag(covariance(fit, which, told)))
        for which, told in ((scans, 0.0), (0 * scans, 0.003 / MEAN_ACROSS**0.5), (0 * scans, 0.0))
    ]
    np.testing.assert_allclose(std[1], std[0], rtol=0.15)
    assert (std[2] > 1.5 * std[1]).all()


def test_where_no_point_tells_of_a_number_none_is_known():
    """Such as of a side that only a stray or two lie near: no warning leaves the library."""
    fit, scans, _ = circle_seen_by_scans(np.random.default_rng(0), 0.003, 0.0)
    told = np.array([[1.0], [1.0], [0.0]])
    assert np.isnan(covariance(replace(fit, effect=told * fit.effect, pulls=told * fit.pulls), scans)).all()


def wall(length, turn, n=40):
    """Return the linear fit of a straight wall, angle and offset, to points on cells; its angle's and offset's std."""
    t = np.linspace(-length / 2, length / 2, n)
    normal = np.array([np.cos(turn), np.sin(turn)])
    on_it = t[:, None] * (-normal[1], normal[0]) + 0.1234 * normal
    points = (np.floor(on_it / CELL) + 0.5) * CELL
    slopes = np.column_stack([points @ (-normal[1], normal[0]), -np.ones(n)])
    effect = -np.linalg.pinv(slopes)
    r = (np.eye(n) + slopes @ effect) @ (points @ normal - 0.1234)
    fit = Linearised(effect, slopes, effect * r, r, np.tile(normal, (n, 1)), points, np.zeros(n, dtype=int), length)
    return np.sqrt(np.diag(covariance(fit, np.zeros(n, dtype=np.int64))))


def test_cells_round_a_wall_along_them_alike_and_a_turned_one_at_random():
    assert wall(0.1, 0.0)[1] == pytest.approx(CELL_STD, rel=0.05)
    assert wall(0.1, 0.5)[1] < 0.2 * CELL_STD
    assert wall(0.1, 0.5, n=100)[1] < 0.55 * wall(0.1, 0.5)[1]  # nearly all cells that it crosses: below root 0.4


def test_a_slope_of_one_cell_from_end_to_end_is_still_unsure():
    """A wall that passes one cell from end to end: its angle hangs on where that one step is."""
    assert wall(0.1, 0.01)[0] > 3 * wall(0.1, 0.5)[0]
