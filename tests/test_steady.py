"""What stands still in many scans: a walker's trail goes, whatever else is there stays."""

import numpy as np
import pytest

import primkit as pk
from tests.filing import refusal

LIDAR = pk.Lidar(360, 0.05, 6.0, noise_std=0.005, range_step=0.001)
ROOM = [pk.Circle((1.0, 0.8), 0.2), pk.Polygon([(-1.2, -0.9), (-0.7, -0.9), (-0.7, -0.6), (-1.2, -0.6)])]


def scanned(n=30, walker=True, poses=((0.1, 0.0, 0.3),)):
    """Scans of a room from one place or from several in turn; a leg of 6 cm walks through it."""
    parts = []
    for k in range(n):
        leg = [pk.Circle((-1.0 + 2.0 * k / n, -0.3), 0.06)] if walker else []
        world = pk.World([*ROOM, *leg], size=4.0, walls=True)
        parts.append(pk.scan(world, poses[k % len(poses)], LIDAR, rng=k))
    fields = {name: np.concatenate([getattr(part, name) for part in parts]) for name in ("poses", "ranges", "inside")}
    return pk.Scans(angles=LIDAR.angles, **fields)


def near_leg(points):
    return int(((np.abs(points[:, 1] + 0.3) < 0.08) & (np.abs(points[:, 0]) < 1.1)).sum())


@pytest.mark.parametrize("poses", [((0.1, 0.0, 0.3),), ((0.1, 0.0, 0.3), (0.3, 0.4, -1.0), (-0.4, 0.5, 2.0))])
def test_a_walker_leaves_no_trail(poses):
    seen = scanned(poses=poses)
    still = pk.steady(seen, 0.005)
    assert near_leg(seen.points()) > 200
    assert near_leg(still.points()) < 0.06 * near_leg(seen.points())


@pytest.mark.parametrize("poses", [((0.1, 0.0, 0.3),), ((0.1, 0.0, 0.3), (0.3, 0.4, -1.0), (-0.4, 0.5, 2.0))])
def test_what_stands_still_stays(poses):
    seen = scanned(walker=False, poses=poses)
    assert pk.steady(seen, 0.005).hits.sum() >= 0.995 * seen.hits.sum()


def test_the_order_of_beams_and_scans_does_not_matter():
    seen = scanned(n=12)
    beams, rows = np.random.default_rng(1).permutation(360), np.random.default_rng(2).permutation(12)
    mixed = pk.Scans(seen.poses[rows], seen.angles[beams], seen.ranges[rows][:, beams], seen.inside[rows])
    one, other = (np.unique(pk.steady(scans, 0.005).points().round(9), axis=0) for scans in (seen, mixed))
    np.testing.assert_array_equal(one, other)


def test_nothing_and_one_scan_stay_as_they_are():
    seen = scanned(n=1)
    np.testing.assert_array_equal(pk.steady(seen).ranges, seen.ranges)
    assert len(pk.steady(pk.scan(pk.World(), []))) == 0


def test_what_is_no_scans_is_refused():
    assert refusal(pk.steady, [(0, 0)]) == "scans must be Scans, got list"
    assert refusal(pk.steady, scanned(n=1), 0) == "resolution must be a finite number > 0, got 0"
