"""Sensors as they are: any sweep, both ends, rounded ranges. The plain caster is the oracle: it takes any order."""

import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import primkit as pk
from primkit.driving.moving_grid import MovingGrid
from primkit.raycast import cast_plainly
from primkit.sensors import ALL_ROUND
from tests.filing import refusal

POSES = [(0.0, 0.0, 0.3), (0.1, -0.2, -2.0)]


@settings(max_examples=60, deadline=None)
@given(
    seed=st.integers(0, 10**6),
    beams=st.integers(2, 60),
    fov=st.one_of(st.just(2 * np.pi), st.floats(0.01, 2 * np.pi)),
    angle_min=st.floats(-2 * np.pi, 2 * np.pi),
    clockwise=st.booleans(),
    both_ends=st.booleans(),
)
def test_any_sweep_sees_what_the_plain_caster_sees(seed, beams, fov, angle_min, clockwise, both_ends):
    world = pk.random_world(3, rng=seed)
    lidar = pk.Lidar(beams, 0.01, 0.9, fov=fov, angle_min=angle_min, clockwise=clockwise, both_ends=both_ends)
    seen = pk.scan(world, POSES, lidar)
    expected = cast_plainly(world, POSES, lidar.angles, 0.9)
    nudged = [cast_plainly(world, POSES, lidar.angles + nudge, 0.9) for nudge in (-1e-9, 1e-9)]
    same = np.isclose(seen.ranges, expected, rtol=0, atol=1e-9) | (seen.ranges == expected)
    on_edge = ~np.isclose(*nudged, rtol=0, atol=1e-6) & (nudged[0] != nudged[1])  # rounding decides
    assert (same | on_edge | (expected < 0.01)).all()


@pytest.mark.parametrize(
    ("told", "degrees"),
    [
        ({"beams": 4}, [0, 90, 180, 270]),
        ({"beams": 4, "clockwise": True}, [0, -90, -180, -270]),
        ({"beams": 5, "both_ends": True, "angle_min": -np.pi}, [-180, -90, 0, 90, 180]),
        ({"beams": 3, "both_ends": True, "angle_min": np.pi / 2, "fov": np.pi, "clockwise": True}, [90, 0, -90]),
        ({"beams": 2, "fov": np.pi, "angle_min": -np.pi / 2}, [-90, 0]),
    ],
    ids=str,
)
def test_the_beams_of_a_sweep(told, degrees):
    np.testing.assert_allclose(np.degrees(pk.Lidar(**told).angles), degrees, atol=1e-12)


def test_the_last_beam_of_a_closed_turn_looks_where_the_first_does():
    seen = pk.scan(pk.random_world(4, rng=7), POSES, pk.Lidar(101, range_max=1.0, both_ends=True))
    np.testing.assert_array_equal(seen.ranges[:, 0], seen.ranges[:, -1])
    plain = pk.scan(pk.random_world(4, rng=7), POSES, pk.Lidar(100, range_max=1.0))
    np.testing.assert_array_equal(seen.ranges[:, :-1], plain.ranges)


def test_ranges_are_rounded_last_and_keep_the_limits():
    world, noisy = pk.World([pk.Circle((0.2, 0.0), 0.05)], walls=True), pk.Lidar(range_max=0.507, noise_std=0.004)
    stepped = dataclasses.replace(noisy, range_step=0.01)
    fine, coarse = (pk.scan(world, POSES[:1], lidar, rng=3).ranges for lidar in (noisy, stepped))
    hit = np.isfinite(fine)
    np.testing.assert_array_equal(hit, np.isfinite(coarse))
    assert np.abs(coarse[hit] - fine[hit]).max() <= 0.005 + 1e-12
    assert coarse[hit].max() == 0.507  # the next step would lie beyond
    assert set(np.round(coarse[hit & (coarse < 0.507)] / 0.01, 9) % 1) == {0.0}


def test_the_defaults_are_the_papers_to_the_bit():
    lidar = pk.Lidar()
    assert lidar.sweep == ALL_ROUND
    np.testing.assert_array_equal(lidar.angles, np.arange(100.0) * (2 * np.pi / 100))


@pytest.mark.parametrize(
    ("told", "sentence"),
    [
        ({"fov": 180}, "fov must be at most a turn, 2 pi, got 180: is it in degrees?"),
        ({"fov": 0}, "fov must be a finite number > 0, got 0"),
        ({"angle_min": 90}, "angle_min must be a bearing within a turn, in radians, got 90"),
        ({"angle_min": "0"}, "angle_min must be a bearing within a turn, in radians, got '0'"),
        ({"clockwise": 1}, "clockwise must be True or False, got int"),
        ({"beams": 1, "both_ends": True}, "both_ends must have at least 2 beams, got 1"),
        ({"range_step": -0.1}, "range_step must be a finite number >= 0, got -0.1"),
        ({"model": "webots", "clockwise": True}, 'model "webots" has a sweep of its own, got (6.28'),
    ],
    ids=str,
)
def test_a_sweep_that_is_none_is_refused(told, sentence):
    assert refusal(pk.Lidar, **told).startswith(sentence)


@pytest.mark.parametrize("use", [lambda lidar: MovingGrid(lidar=lidar), lambda lidar: pk.explore(pk.World(), lidar)])
def test_who_counts_on_looking_all_round_says_so(use):
    for lidar in (pk.Lidar(fov=3.0), pk.RPLIDAR_A1):
        assert refusal(use, lidar).startswith("lidar must see all round here")


def test_a_drive_keeps_its_sensor(tmp_path):
    """The head of a drive with a plain sensor is what it always was; older ones, without the later fields, are read."""
    for lidar in (pk.LDS_01, pk.Lidar(), pk.Lidar(fov=3.0, angle_min=-1.5, both_ends=True, range_step=0.01)):
        seen = pk.scan(pk.World(), POSES, lidar)
        pk.save_drive(pk.formats.Drive(seen, [(0, 0), (1, 1)], lidar), tmp_path / "a.jsonl")
        assert pk.load_drive(tmp_path / "a.jsonl").lidar == lidar
    pk.save_drive(pk.formats.Drive(pk.scan(pk.World(), POSES), [(0, 0), (1, 1)]), tmp_path / "a.jsonl")
    assert b'"spurious":0.0,"model":"exact"}}\n' in (tmp_path / "a.jsonl").read_bytes()
