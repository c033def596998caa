"""The drives with four keys: the bundled ones are what the rule gives, and each is driven as the paper's robot is."""

import numpy as np
import pytest

import primkit as pk
from primkit.driving.keyed import KEYED_START, KEYS, keyed_poses, press_keys, published_drives
from primkit.formats import bundled_keys, recorded_rows
from tests.shipped_data import make_keys

SUITE = pk.published_suite()


@pytest.fixture(scope="module")
def drives():
    """The poses of all bundled drives, by name; worked out once."""
    return published_drives()


@pytest.mark.parametrize("name", SUITE)
def test_the_bundled_keys_are_what_the_rule_gives(name):
    assert bundled_keys()[name] == make_keys(name)


@pytest.mark.parametrize("name", SUITE)
def test_a_drive_goes_straight_or_turns_on_the_spot(name, drives):
    poses = drives[name]
    assert poses[0].tolist() == KEYED_START.tolist()
    way, turn = np.hypot(*np.diff(poses[:, :2], axis=0).T), np.diff(poses[:, 2])
    straight = np.array([key in "WS" for key in bundled_keys()[name]])
    assert way[straight] == pytest.approx(0.0128740, abs=1e-7)  # 0.129 m/s
    assert np.abs(turn[~straight]) == pytest.approx(0.328788, abs=1e-6)  # wheels at -+4.17 rad/s
    assert way[~straight] == pytest.approx(0)
    assert turn[straight] == pytest.approx(0)
    assert np.abs(poses[:, :2]).max() < 0.5 - 0.037  # on the board


def test_the_drives_take_about_as_long_as_the_recorded_ones(drives):
    """Theirs is time on the wall, with that of pictures that stood open: so 0.6 to 1.1 of it, by number of shapes."""
    recorded = {row["map"]: float(row["seconds"]) for row in recorded_rows() if row["movement"] == "manual"}
    for n in "1234":
        names = [name for name in SUITE if name.startswith(n)]
        ours = np.mean([0.1 * len(drives[name]) for name in names])
        assert 0.6 < ours / np.mean([recorded[name] for name in names]) < 1.1


def test_the_four_keys():
    assert keyed_poses("WS")[2] == pytest.approx(KEYED_START)
    assert keyed_poses("AD")[2] == pytest.approx(KEYED_START)
    assert sorted(KEYS) == ["A", "D", "S", "W"]


def test_nothing_to_see_presses_nothing():
    assert press_keys(pk.World(), rng=0) == ""
    assert len(keyed_poses("")) == 1
