"""The scripted driver: drives as a robot can, touches nothing, sees most of it, and does so again and again."""

from functools import cache

import numpy as np
import pytest

import primkit as pk
from primkit.formats import save_route, scripted_drives
from primkit.robot import AXLE, FASTEST, WHEEL, advance, clearance
from primkit.study import drives_on, scripted_route, shares_seen
from tests.filing import refusal
from tests.shipped_data import DATA, make_drive

SUITE, DRIVES = pk.paper_suite(), scripted_drives()


@cache
def poses_of(name):
    return DRIVES[name].poses(SUITE[name])


@pytest.mark.parametrize("name", SUITE)
def test_the_bundled_drives_are_what_their_seeds_give(name, tmp_path):
    save_route(make_drive(name), tmp_path / "made.json")
    assert (tmp_path / "made.json").read_bytes() == (DATA / "drives" / f"{name}.json").read_bytes()


@pytest.mark.parametrize("name", SUITE)
def test_a_bundled_drive_is_driven(name):
    """No teleport, nothing touched, and the same each time."""
    world, poses = SUITE[name], poses_of(name)
    pose = poses[0]
    for held, there in zip(DRIVES[name].wheels, poses[1:], strict=True):
        pose, stopped = advance(world, pose, held)
        assert (pose == there).all()
        assert not stopped
    assert clearance(world, poses[:, :2]).min() > 0
    steps = np.hypot(*np.diff(poses[:, :2], axis=0).T)
    assert steps.max() <= WHEEL * FASTEST * 0.1 + 1e-12
    assert np.abs(np.diff(poses[:, 2])).max() <= 2 * WHEEL * FASTEST / AXLE * 0.1 + 1e-12
    assert np.median(steps) >= 0.005  # it drives, most of the time


def test_the_drives_take_about_as_long_as_the_recorded_ones():
    """Robot time alone against time on the wall: within a factor of two."""
    recorded = pk.study.PUBLISHED["manual"]
    for n in "1234":
        mean = np.mean([row.time for name, row in recorded.items() if name.startswith(n)])
        times = [0.1 * (len(route) + 1) for name, route in DRIVES.items() if name.startswith(n)]
        assert 0.5 <= np.mean(times) / mean <= 2


def test_the_same_seed_drives_the_same_way_and_another_one_another():
    world = pk.random_world(3, style="free", rng=5)
    one, same, other = (scripted_route(world, rng=rng) for rng in (1, np.random.default_rng(1), 2))
    assert one.wheels.tobytes() == same.wheels.tobytes()
    assert one.wheels.tobytes() != other.wheels.tobytes()


@pytest.mark.parametrize("seed", range(3))
def test_free_boards_are_driven_too(seed):
    world = pk.random_world(5, style="free", rng=seed)
    poses = scripted_route(world, rng=seed).poses(world)
    assert len(poses) > 100
    assert clearance(world, poses[:, :2]).min() > 0


def test_other_maps_are_driven_on_too_and_each_for_itself():
    """A map of the suite under its name has the bundled drive; any other one that of its name and the seed."""
    own, other = pk.random_world(2, rng=3), pk.random_world(1, rng=4)
    drives = drives_on({"1-circle": SUITE["1-circle"], "own": own, "1-pentagon": other}, seed=5)
    assert (drives["1-circle"] == poses_of("1-circle")).all()
    assert (drives["own"] == drives_on({"own": own}, seed=5)["own"]).all()
    assert not np.array_equal(drives["own"], drives_on({"own": own}, seed=6)["own"])
    assert not np.array_equal(drives["own"], drives_on({"mine": own}, seed=5)["mine"])
    assert clearance(other, drives["1-pentagon"][:, :2]).min() > 0


def test_a_shape_that_cannot_be_reached_is_left_alone():
    wall = pk.Polygon([(0.1, -0.49), (0.12, -0.49), (0.12, 0.49), (0.1, 0.49)])
    world = pk.World([wall, pk.Circle((0.3, 0), 0.05)])
    poses = scripted_route(world, rng=1).poses(world)
    assert poses[:, 0].max() < 0.1  # beyond the wall it does not get
    assert len(poses) > 20


def test_some_shapes_are_seen_in_part_and_most_whole():
    shares = []
    for name, world in SUITE.items():
        shares += shares_seen(world, pk.scan(world, poses_of(name)), pk.Lidar())
    assert len(shares) == 94
    assert np.mean(np.array(shares) > 0.99) > 0.5
    assert 5 <= np.sum(np.array(shares) < 0.9) <= 47


def test_failure():
    assert refusal(scripted_route, []) == "world must be a World, got list"
    full = pk.World([pk.Polygon([(-0.45, -0.45), (0.45, -0.45), (0.45, 0.45), (-0.45, 0.45)])])
    assert refusal(scripted_route, full) == "the board must have room for the robot, got none between its shapes"
