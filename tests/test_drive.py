"""Manual movement: arcs against the circle they lie on, and a body that nothing gets into."""

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

import primkit as pk
from primkit.robot import AXLE, BODY, CLEAR, FASTEST, WHEEL, advance, clearance, drive, moved, start_pose

WHEELS = st.floats(-FASTEST, FASTEST)
POSES = st.tuples(st.floats(-1, 1), st.floats(-1, 1), st.floats(-7, 7))


def around_the_centre_of_rotation(pose, wheels, time):
    """The arc by plane geometry: the robot turns around the point on its axle that stands still."""
    x, y, heading = pose
    left, right = wheels
    v, w = WHEEL * (left + right) / 2, WHEEL * (right - left) / AXLE
    if w == 0:
        return x + v * time * np.cos(heading), y + v * time * np.sin(heading), heading
    radius, turned = v / w, heading + w * time
    middle = x - radius * np.sin(heading), y + radius * np.cos(heading)
    return middle[0] + radius * np.sin(turned), middle[1] - radius * np.cos(turned), turned


@given(POSES, st.tuples(WHEELS, WHEELS), st.floats(0, 10))
def test_the_arc_is_exact(pose, wheels, time):
    if 0 < abs(wheels[0] - wheels[1]) < 1e-2:
        wheels = (wheels[0], wheels[0])  # the centre of rotation is too far off for its own arithmetic
    exact = around_the_centre_of_rotation(pose, wheels, time)
    np.testing.assert_allclose(moved(pose, wheels, time), exact, atol=1e-12)


@given(POSES, st.tuples(WHEELS, WHEELS), st.floats(0, 5), st.floats(0, 5))
def test_two_steps_lead_where_one_leads(pose, wheels, first, second):
    there = moved(moved(pose, wheels, first), wheels, second)
    np.testing.assert_allclose(there, moved(pose, wheels, first + second), atol=1e-12)
    back = moved(there, (-wheels[0], -wheels[1]), first + second)
    np.testing.assert_allclose(back, pose, atol=1e-12)


@given(POSES, WHEELS, st.floats(1e-9, 1e-3), st.floats(0, 5))
def test_nearly_straight_is_nearly_straight(pose, wheel, more, time):
    """No loss of digits where the arc becomes a line."""
    straight, bent = moved(pose, (wheel, wheel), time), moved(pose, (wheel, wheel + more), time)
    assert np.abs(straight - bent).max() <= 2 * WHEEL * more / AXLE * max(time, time**2) + 1e-12


def solid(world):
    return shapely.union_all([s.to_shapely() if isinstance(s, pk.Polygon) else disc(s) for s in world.shapes])


def disc(circle):
    """A polygon inside the circle: what keeps off the circle keeps off it as well."""
    angles = np.linspace(0, 2 * np.pi, 2001)[:-1]
    return shapely.Polygon(circle.center + circle.radius * np.column_stack([np.cos(angles), np.sin(angles)]))


COMMANDS = st.lists(st.tuples(WHEELS, WHEELS, st.integers(1, 200)), min_size=1, max_size=12)


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 1000), COMMANDS)
def test_no_drive_brings_the_body_into_a_shape_or_off_the_board(seed, commands):
    """Each of hypothesis' drives has up to 2,400 steps; the body is looked at on the way, too."""
    world = pk.random_world(1 + seed % 4, style="free" if seed % 2 else "paper", rng=seed)
    wheels = [(left, right) for left, right, times in commands for _ in range(times)]
    poses = drive(world, wheels)
    assert len(poses) == len(wheels) + 1
    ways = shapely.linestrings(np.stack([poses[:-1, :2], poses[1:, :2]], axis=1))
    bulge = WHEEL * FASTEST * 0.1 / 8 * (2 * WHEEL * FASTEST / AXLE * 0.1)  # an arc's height over its chord, at most
    assert shapely.distance(shapely.points(poses[:, :2]), solid(world)).min() >= BODY
    assert shapely.distance(ways, solid(world)).min() >= BODY - bulge
    assert np.abs(poses[:, :2]).max() <= world.size / 2 - BODY


def test_ten_thousand_random_steps():
    world, rng = pk.random_world(4, rng=3), np.random.default_rng(0)
    wheels = np.repeat(rng.uniform(-FASTEST, FASTEST, (500, 2)), 20, axis=0)
    poses = drive(world, wheels)
    assert len(poses) == 10_001
    assert clearance(world, poses[:, :2]).min() >= 0
    assert shapely.distance(shapely.points(poses[:, :2]), solid(world)).min() >= BODY


def test_it_stops_at_the_wall_and_not_before():
    world = pk.World([pk.Polygon([(0.1, -0.2), (0.2, -0.2), (0.2, 0.2), (0.1, 0.2)])])
    pose, stopped = advance(world, (0, 0, 0), (6.28, 6.28), 2.0)
    assert stopped
    assert 0 < 0.1 - BODY - pose[0] <= 2 * CLEAR
    assert pose[1:].tolist() == [0, 0]
    edge, stopped = advance(pk.World(), (0, 0, np.pi / 2), (6.28, 6.28), 10.0)
    assert stopped
    assert 0 < 0.5 - BODY - edge[1] <= 2 * CLEAR


def test_it_turns_where_it_was_stopped_and_drives_away():
    world = pk.World([pk.Circle((0.1, 0.0), 0.05)])
    touching, _ = advance(world, (0, 0, 0), (6, 6), 1.0)
    turned, stopped = advance(world, touching, (-3, 3), 1.0)
    assert not stopped
    assert turned[:2].tolist() == touching[:2].tolist()
    slipping, stopped = advance(world, touching, (3, 6), 0.1)
    assert stopped
    assert slipping[2] == pytest.approx(WHEEL * 3 / AXLE * 0.1)
    away, stopped = advance(world, touching, (-6, -6), 0.1)
    assert not stopped
    assert away[0] < touching[0] - 0.01


def test_a_drive_starts_where_there_is_room():
    assert start_pose(pk.World()).tolist() == [0, 0, 0]
    blocked = start_pose(pk.World([pk.Circle((0, 0), 0.1)]))
    assert 0.1 + BODY <= np.hypot(*blocked[:2]) <= 0.1 + BODY + 0.015
    with pytest.raises(ValueError, match="the board must have room for the robot, got none between its shapes"):
        start_pose(pk.World([pk.Polygon([(-0.45, -0.45), (0.45, -0.45), (0.45, 0.45), (-0.45, 0.45)])]))


FAILURES = {
    "a wheel too fast": (((0, 0, 0), (7, 0)), "wheels must turn at 6.28 rad/s at most, got 7"),
    "one wheel": (((0, 0, 0), (1,)), "wheels must be two finite numbers (x, y), got (1,)"),
    "wheels not finite": (((0, 0, 0), (1, np.nan)), "wheels must be two finite numbers (x, y), got (1, nan)"),
    "two poses": (
        ([(0, 0, 0)] * 2, (1, 1)),
        "a pose must be three finite numbers (x, y, heading), got [(0, 0, 0), (0, 0, 0)]",
    ),
    "a start in a shape": (
        ((0.1, 0, 0), (1, 1)),
        "the robot must stand clear of shapes and on the board, got (0.1, 0) m",
    ),
    "a start off the board": (
        ((0.6, 0, 0), (1, 1)),
        "the robot must stand clear of shapes and on the board, got (0.6, 0) m",
    ),
}


@pytest.mark.parametrize(("arguments", "message"), FAILURES.values(), ids=FAILURES)
def test_failure(arguments, message):
    with pytest.raises(ValueError) as error:  # noqa: PT011 - the whole message is compared below
        advance(pk.World([pk.Circle((0.1, 0.0), 0.05)]), *arguments)
    assert str(error.value) == message


def test_who_stands_too_close_may_drive_along():
    """Half of the clearance from the edge: on towards it is blocked, along it and away from it are not."""
    x = 0.5 - BODY - CLEAR / 2
    for heading, stopped in ((0.0, True), (np.pi / 2, False), (np.pi, False)):
        assert advance(pk.World(), (x, 0.0, heading), (6, 6))[1] is stopped
