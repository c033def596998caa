"""Poses that slip: what is placed anew, how sure that is, and what is said where it cannot be told."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

import primkit as pk
from primkit.driving.align import landmarks_in
from primkit.driving.pose_graph import Hits, Landmarks, State, hit_rows, solve, step_rows, variances
from primkit.robot import chained, increments

CIRCLES = (pk.Circle((0.0, 0.0), 0.1), pk.Circle((0.4, 0.1), 0.05))


def orbit(n=100, radius=0.25, laps=2.0):
    """Poses on a circle around the origin, looking ahead."""
    turns = np.linspace(0, 2 * np.pi * laps, n)
    return np.column_stack([radius * np.cos(turns), radius * np.sin(turns), turns + np.pi / 2])


def driven(world, true, *, slip=0.03, turn=2.0, noise=0.002, reach=1.0, seed=0):
    """Scans from true poses, with the poses that the odometry tells."""
    scans = pk.scan(world, true, pk.Lidar(range_max=reach, noise_std=noise), rng=seed)
    return replace(scans, poses=pk.odometry(true, slip=slip, turn=turn, rng=seed))


def rms(poses, true):
    return float(np.sqrt(((poses - true)[:, :2] ** 2).sum(axis=1).mean()))


@pytest.fixture(scope="module")
def board():
    seen_on_three_sides = pk.Polygon([(0.13, -0.03), (0.19, -0.03), (0.19, 0.03), (0.13, 0.03)])
    return pk.World([*CIRCLES, seen_on_three_sides], walls=True)


@pytest.fixture(scope="module")
def told(board):
    return driven(board, orbit())


@pytest.fixture(scope="module")
def aligned(told):
    return pk.align(told)


# --- what comes out ---------------------------------------------------------------------------------------------


def test_a_drive_is_straightened(told, aligned):
    assert rms(aligned.scans.poses, orbit()) < 0.1 * rms(told.poses, orbit())
    assert np.array_equal(aligned.scans.ranges, told.ranges)
    assert aligned.open == ()


def test_the_truth_lies_within_the_stated_covariance(aligned):
    off = (aligned.scans.poses - orbit())[1:]
    inside = np.einsum("pi,pij,pj->p", off, np.linalg.inv(aligned.covariance[1:]), off) < 7.815
    assert 0.8 < inside.mean() <= 1
    assert not aligned.covariance[0].any()


def test_the_noise_of_the_ranges_and_the_slip_are_found(aligned):
    assert aligned.noise_std == pytest.approx(0.002, rel=0.15)
    assert 0.005 < aligned.slip < 0.04  # its lasting half is told apart
    assert 0.3 < aligned.turn < 3


def test_a_drive_with_odometry_gives_the_map(board, told, aligned):
    right = []
    for scans in (told, aligned.scans):
        grid = pk.Grid()
        grid.add(scans)
        report = pk.evaluate(pk.find_shapes(grid, rng=0), board)
        right.append(sum(match.all_right for match in report.matches))
    assert right == [0, 3]


def test_no_scan_and_one_are_left_where_they_are(board):
    assert pk.align(pk.scan(board, [])).scans.poses.shape == (0, 3)
    assert "no scans on no landmarks, known to 0.0 mm" in repr(pk.align(pk.scan(board, [])))
    scans = pk.scan(board, (0.25, 0.0, 1.0), rng=0)
    assert np.array_equal(pk.align(scans).scans.poses, scans.poses)


@pytest.mark.parametrize("noise", [0.0, 0.005])
def test_without_slip_poses_stay(board, noise):
    true = driven(board, orbit(), slip=0.0, turn=0.0, noise=noise)
    assert rms(pk.align(true).scans.poses, true.poses) < 0.0002 + 0.1 * noise


# --- invariances ------------------------------------------------------------------------------------------------


@settings(max_examples=3, deadline=None, phases=[Phase.generate])  # a smaller turn tells no more
@given(x=st.floats(-5, 5), y=st.floats(-5, 5), turn=st.floats(-3, 3))
def test_a_turned_and_shifted_gauge_turns_and_shifts_all(told, aligned, x, y, turn):
    c, s = np.cos(turn), np.sin(turn)
    rotation = np.array([(c, s, 0), (-s, c, 0), (0, 0, 1)])
    other = pk.align(replace(told, poses=told.poses @ rotation + [x, y, turn]))
    assert np.allclose(other.scans.poses, aligned.scans.poses @ rotation + [x, y, turn], atol=1e-6)
    assert np.allclose(other.covariance, rotation.T @ aligned.covariance @ rotation, atol=1e-9)


@pytest.mark.parametrize("scale", [0.1, 10.0])
def test_a_board_ten_times_as_large_is_the_same_board(told, aligned, scale):
    large = replace(told, poses=told.poses * [scale, scale, 1], ranges=told.ranges * scale)
    other = pk.align(large)
    assert np.allclose(other.scans.poses / [scale, scale, 1], aligned.scans.poses, atol=1e-6)
    assert other.noise_std / scale == pytest.approx(aligned.noise_std, rel=1e-4)


@pytest.fixture
def problem():
    """A state beside its best, hits on two lines and two circles, and the odometry's steps."""
    rng = np.random.default_rng(3)
    poses = orbit(12, laps=0.5)
    marks = Landmarks(
        np.array([(0.3, 0.5), (2.0, -0.4)]),
        np.array([(0.0, 0.0, 0.1), (0.4, 0.1, 0.05)]),
        np.zeros((2, 2, 2)),
        np.zeros(2, dtype=bool),
    )
    hits = Hits(rng.integers(0, 12, 80), rng.uniform(0, 6, 80), rng.uniform(0.1, 0.4, 80), rng.integers(0, 4, 80))
    steps = increments(poses) * 1.05 + rng.normal(0, 0.001, (11, 3))
    return State(poses, np.array([0.02, 0.1]), marks, np.array([0.005, 0.03, 0.03, 0.02]) ** 2), hits, steps


@pytest.mark.parametrize("which", ["hits", "steps"])
def test_the_jacobian_is_that_of_finite_differences(problem, which):
    state, hits, steps = problem
    state = replace(state, variance=np.append(0.0, state.variance[1:]))  # a hit's weight turns with its beam

    def residuals(moved):
        return hit_rows(moved, hits) if which == "hits" else step_rows(moved, steps)

    rows = residuals(state)[1].toarray()
    for k in range(len(state.numbers)):
        step = np.zeros(len(state.numbers))
        step[k] = 1e-6
        ahead, behind = residuals(state.moved(step))[0], residuals(state.moved(-step))[0]
        assert np.allclose(rows[:, k], (ahead - behind) / 2e-6, atol=1e-5 * np.abs(rows).max()), k


def test_what_nothing_contradicts_is_not_thereby_known(problem):
    state, hits, steps = problem
    state = solve(state, hits[:0], steps)
    told = variances(state, hits[:0], steps)[0]
    assert np.allclose(told, state.variance, rtol=0.3)  # the trace is by a few random vectors


def test_landmarks_may_come_in_any_order(problem):
    state, hits, steps = problem
    marks = state.landmarks
    other = replace(state, landmarks=Landmarks(marks.lines[::-1], marks.circles[::-1], marks.ends, marks.one_sided))
    on = hits[hits.reach < 0.3]
    poses = solve(state, on, steps).poses
    swapped = solve(other, replace(on, landmark=np.array([1, 0, 3, 2])[on.landmark]), steps).poses
    assert np.allclose(swapped, poses, atol=1e-6)


# --- what cannot be told ----------------------------------------------------------------------------------------

OPEN = {
    "nothing": (pk.World(), "no shape and no wall was found"),
    "one circle": (pk.World([CIRCLES[0]]), "only one circle was found: where around it"),
    "another circle, seen by some": (pk.World([CIRCLES[0], CIRCLES[1]]), ""),
}


@pytest.mark.parametrize(("world", "words"), OPEN.values(), ids=OPEN)
def test_what_is_not_observable_is_said(world, words):
    said = pk.align(driven(world, orbit(60), reach=0.5), resolution=0.001).open
    assert said[0].startswith(words) if words else not said


@pytest.mark.parametrize(("noise", "seed"), [(0.002, 0), (0.005, 5)])
def test_where_one_circle_is_all_there_is_the_odometry_holds_what_it_leaves_open(noise, seed):
    true = orbit(60)
    told = driven(pk.World(CIRCLES[:1]), true, reach=0.5, noise=noise, seed=seed)
    aligned = pk.align(told, resolution=0.001)
    off = (aligned.scans.poses - true)[1:]
    assert rms(aligned.scans.poses, true) < 0.7 * rms(told.poses, true)
    assert (np.einsum("pi,pij,pj->p", off, np.linalg.inv(aligned.covariance[1:]), off) < 7.815).mean() > 0.8


def test_between_two_parallel_walls_the_way_along_them_is_open():
    walls = pk.World([pk.Polygon([(-2, y), (2, y), (2, y + 0.1), (-2, y + 0.1)]) for y in (-0.3, 0.2)], size=5)
    true = np.column_stack([np.linspace(-1, 1, 80), np.zeros(80), np.zeros(80)])
    aligned = pk.align(driven(walls, true, reach=0.8), resolution=0.001)
    assert aligned.open[0].startswith("only parallel walls")
    assert aligned.std[-1, 0] > 10 * aligned.std[-1, 1]


@pytest.mark.parametrize("seed", [401, 419])
def test_noise_as_a_fifth_of_its_radius_gives_a_lone_circle_no_corners_to_turn_by(seed):
    world = pk.World([pk.Circle((0.02, 0.01), 0.05)])
    told = driven(world, orbit(), noise=0.01, reach=0.3, seed=seed)
    aligned = pk.align(told)
    assert rms(aligned.scans.poses, orbit()) < rms(told.poses, orbit())
    assert aligned.open[0].startswith("only one circle was found")


def test_a_room_that_slips_have_bent_has_landmarks_still():
    """As a whole it is a thing of no kind: its straight pieces are what there is."""
    bearing = np.arange(720) * np.pi / 360
    ranges = 0.5 / np.maximum(np.abs(np.cos(bearing)), np.abs(np.sin(bearing))) + 0.02 * np.cos(8 * bearing)
    bent = pk.Scans([(0, 0, 0)], bearing, [ranges], [False])
    assert pk.find_shapes(bent.points(), rng=0).others
    ends = landmarks_in(bent).ends
    assert np.hypot(*(ends[:, 1] - ends[:, 0]).T).sum() > 3.5


def test_scans_that_saw_nothing_are_counted(told):
    ranges = told.ranges.copy()
    ranges[40:50] = np.inf
    assert "10 of 100 scans saw no landmark" in pk.align(replace(told, ranges=ranges)).open[-1]


@pytest.mark.parametrize(
    ("scans", "resolution", "sentence"),
    [
        ([], None, r"scans must be Scans, as in align\(scan\(world, poses\)\), got list"),
        (pk.scan(pk.World(), (0, 0, 0)), 0.0, "resolution must be a finite number > 0, got 0"),
    ],
)
def test_what_cannot_be_aligned_is_refused(scans, resolution, sentence):
    with pytest.raises(ValueError, match=sentence):
        pk.align(scans, resolution=resolution)


# --- odometry ---------------------------------------------------------------------------------------------------


def test_over_a_metre_odometry_is_off_by_what_is_said():
    way = np.column_stack([np.linspace(0, 1, 51), np.zeros(51), np.zeros(51)])
    ends = np.array([pk.odometry(way, slip=0.03, turn=1.5, rng=seed)[-1] for seed in range(2000)])
    assert ends[:, 0].std() == pytest.approx(0.03, rel=0.07)
    assert np.degrees(ends[:, 2].std()) == pytest.approx(1.5, rel=0.07)


def test_half_of_the_error_lasts():
    way = np.column_stack([np.linspace(0, 4, 81), np.zeros(81), np.zeros(81)])
    ends = np.array([pk.odometry(way, slip=0.0, turn=1.0, rng=seed)[-1] for seed in range(2000)])
    assert np.degrees(ends[:, 2].std()) == pytest.approx(np.sqrt(0.5 * 4**2 + 0.5 * 4), rel=0.07)


def test_wheels_that_do_not_slip_tell_the_truth():
    assert np.allclose(pk.odometry(orbit(), slip=0.0, turn=0.0), orbit(), atol=1e-12)
    assert np.allclose(chained(orbit()[:1], increments(orbit())), orbit(), atol=1e-12)
    assert pk.odometry(np.empty((0, 3))).shape == (0, 3)


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ({"slip": 3}, "slip must be a share from 0 to 1, got 3"),
        ({"turn": -1}, "turn must be a finite number >= 0, got -1"),
    ],
)
def test_an_odometry_that_cannot_be_is_refused(arguments, sentence):
    with pytest.raises(ValueError, match=sentence):
        pk.odometry(orbit(), **arguments)
