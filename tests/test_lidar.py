"""What the LiDAR sees, against two oracles that share no formula with the ray caster.

GEOS: a beam is a line, a polygon is a ring, and shapely intersects them. A circle would only be a polygon to shapely,
so it is asked for what is exact: how far the beam passes the centre, and where; Pythagoras closes the triangle.
Brute force: a plain loop over poses, beams and sides. The library's own plain form, ``cast_plainly``, is held against
the same.

A beam on a knife's edge (through a corner, along a side, touching a circle) is decided by rounding: hit or miss, this
side or that. There, the ray caster must agree with GEOS at the same bearing or at one moved by 1e-9 rad; or, where the
outline runs steeply between those, name a point of an outline between them. ``check_against_geos`` holds this rule.
"""

import dataclasses
import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from primkit import lidar as lidar_module
from primkit.grid import Grid
from primkit.lidar import Lidar, Scans, scan, scan_blocks
from primkit.random_shapes import SORTS, free_shape
from primkit.raycast import cast_plainly, cast_rays
from primkit.raycast.fan import CORNER_HIT, Fan
from primkit.raycast.fast import BEAMS_PER_BLOCK, PAIRS_PER_BLOCK
from primkit.raycast.near import CELLS_FROM, Near
from primkit.robot import inside_shape, teleport_poses
from primkit.shapes import PRIMITIVES, Circle, Polygon
from primkit.world import World, random_world
from tests.helpers import exactly
from tests.test_shapes import anything

# Rays do not care for the board: many of these worlds lie off it, or their shapes on each other.
# The oldest shapely that we allow warns where GEOS divides by zero on its way to the right answer.
pytestmark = pytest.mark.filterwarnings(
    "ignore::primkit.arguments.LikelyWrong", "ignore:divide by zero encountered in inters:RuntimeWarning"
)

NAN, INF = float("nan"), float("inf")

EXACT = 1e-9  # m: how far the ray caster may be off
KNIFE_EDGE = 1e-9  # rad: how far a beam is moved where rounding decides
TANGENT = 1e-8  # m: how far GEOS itself may be off where a beam touches a circle: the square root of rounding
ANGLES = Lidar().angles
ORIGIN = [(0.0, 0.0, 0.0)]

seeds = st.integers(0, 10**6)


def box(left, low, right, high):
    return Polygon([(left, low), (right, low), (right, high), (left, high)])


def same(one, other, tolerance=EXACT):
    """Where two tables of ranges agree: both the same distance, or both nothing."""
    one, other = np.asarray(one), np.asarray(other)
    with np.errstate(invalid="ignore"):
        return (one == other) | (np.abs(one - other) <= tolerance)


# --- Oracles ------------------------------------------------------------------------------------------------


def geos(world, poses, angles, length=8.0):
    """Ranges, shape (P, B), and which poses lie in a shape, shape (P,), by shapely."""
    poses, angles = np.reshape(poses, (-1, 3)), np.asarray(angles, dtype=float)
    bearings = poses[:, 2:] + angles
    start = np.broadcast_to(poses[:, None, :2], (*bearings.shape, 2))
    end = start + length * np.stack([np.cos(bearings), np.sin(bearings)], axis=-1)
    beams = shapely.linestrings(np.stack([start, end], axis=-2))
    places = shapely.points(poses[:, :2])
    ranges, inside = np.full(bearings.shape, INF), np.zeros(len(poses), dtype=bool)
    for shape in world.shapes:
        if isinstance(shape, Circle):
            center = shapely.Point(shape.center)
            inside |= shapely.distance(center, places) <= shape.radius
            aside = shapely.distance(center, beams)
            along = shapely.line_locate_point(beams, center)
            depth = np.sqrt(np.maximum(shape.radius**2 - aside**2, 0))
            hit = np.where(aside <= shape.radius, along - depth, INF)
        else:
            body = shapely.Polygon(shape.vertices)
            shapely.prepare(body)
            inside |= shapely.covers(body, places)
            row, beam = np.nonzero(shapely.intersects(body, beams))
            crossing = shapely.intersection(beams[row, beam], body.exterior)
            hit = np.full(bearings.shape, INF)
            distance = shapely.distance(places[row], crossing)
            hit[row, beam] = np.where(np.isnan(distance), INF, distance)
        ranges = np.minimum(ranges, hit)
    if len(world.walls):
        board = shapely.box(*(2 * [-world.size / 2] + 2 * [world.size / 2]))
        inside |= ~shapely.contains(board, places)
        ways_out = shapely.intersection(beams, board.exterior)
        ranges = np.fmin(ranges, shapely.distance(places[:, None], ways_out))
    ranges[inside] = INF
    return ranges, inside


def brute_force(world, pose, bearing):
    """The range of one beam: each side and circle in turn, by Cramer's rule and the quadratic formula."""
    px, py = pose[:2]
    ux, uy = math.cos(pose[2] + bearing), math.sin(pose[2] + bearing)
    nearest = INF
    if len(world.walls):
        room = [world.size / 2 - p * math.copysign(1, u) for p, u in ((px, ux), (py, uy))]
        if min(room) <= 0 or max(abs(px), abs(py)) >= world.size / 2:
            return INF
        nearest = min(free / abs(u) for free, u in zip(room, (ux, uy), strict=True) if u)
    for shape in world.shapes:
        if isinstance(shape, Circle):
            cx, cy = shape.center[0] - px, shape.center[1] - py
            if math.hypot(cx, cy) <= shape.radius:
                return INF
            half_b = ux * cx + uy * cy
            discriminant = half_b**2 - (cx**2 + cy**2 - shape.radius**2)
            if discriminant >= 0 and half_b > 0:
                nearest = min(nearest, half_b - math.sqrt(discriminant))
            continue
        corners = [(x - px, y - py) for x, y in shape.vertices.tolist()]
        sides = list(zip(corners, corners[1:] + corners[:1], strict=True))
        turned_by = sum(math.atan2(ax * by - ay * bx, ax * bx + ay * by) for (ax, ay), (bx, by) in sides)
        if turned_by > math.pi:  # the outline winds round the robot
            return INF
        for (ax, ay), (bx, by) in sides:
            dx, dy = bx - ax, by - ay
            determinant = ux * dy - uy * dx
            if determinant == 0:
                continue
            t = (ax * dy - ay * dx) / determinant
            s = (ax * uy - ay * ux) / determinant
            if t > 0 and 0 <= s <= 1:
                nearest = min(nearest, t)
    return nearest


def check_against_geos(world, poses, angles, ranges, length=8.0):
    """Assert the rule of this module's first lines; return how many beams were on a knife's edge."""
    poses = np.reshape(poses, (-1, 3))
    expected, inside = geos(world, poses, angles, length)
    doubtful = np.argwhere(~same(ranges, expected))
    for row, beam in doubtful:
        assert not inside[row], f"a pose inside a shape sees something: {poses[row]}"
        pose, angle, value = poses[row], angles[beam], ranges[row, beam]
        around = [geos(world, pose, [angle + turn], length)[0][0, 0] for turn in (-KNIFE_EDGE, 0.0, KNIFE_EDGE)]
        between = min(around) - TANGENT <= value <= max(around) + TANGENT
        steep = between and on_an_outline(world, pose, angle, value)
        assert same(value, around).any() or steep, f"{value} at {pose}, {angle} in {world.shapes}: GEOS has {around}"
    return len(doubtful)


def on_an_outline(world, pose, angle, value):
    if not np.isfinite(value):
        return False
    point = shapely.Point(pose[:2] + value * np.array([np.cos(pose[2] + angle), np.sin(pose[2] + angle)]))
    gaps = [
        abs(point.distance(shapely.Point(s.center)) - s.radius)
        if isinstance(s, Circle)
        else point.distance(shapely.LinearRing(s.vertices))
        for s in world.shapes
    ]
    gaps += [point.distance(shapely.LineString(wall)) for wall in world.walls]
    return min(gaps) <= EXACT


# --- Scenes -------------------------------------------------------------------------------------------------


def crowd(n, rng):
    """n shapes anywhere: they touch, overlap and hide each other."""
    centers = rng.uniform(-0.4, 0.4, (n, 2))
    return World([free_shape(PRIMITIVES[rng.integers(4)], center, rng) for center in centers])


def odd_crowd(n, rng, **board):
    """n polygons of all sorts anywhere, most of them not convex: they overlap, hide each other and hold the robot."""
    centers = rng.uniform(-0.4, 0.4, (n, 2))
    return World([free_shape(SORTS[rng.integers(len(SORTS))], center, rng) for center in centers], **board)


def row_of_neighbours(rng):
    """Shapes that touch exactly: side by side, corner to corner, circle to side."""
    shapes = [
        box(-0.25, 0, -0.125, 0.125),
        box(-0.125, 0, 0, 0.25),
        box(0, -0.125, 0.125, 0),
        Circle((0.1875, -0.0625), 0.0625),
        Circle((0.0625, 0.0625), 0.0625),
    ]
    return moved_world(World(shapes), rng.uniform(-0.1, 0.1, 2), rng.choice([0, rng.uniform(0, 7)]))


def random_poses(n, rng):
    return np.column_stack([rng.uniform(-0.6, 0.6, (n, 2)), rng.uniform(-10, 10, n)])


@pytest.fixture(scope="module")
def scenes():
    """88 worlds with 20 poses each, headings beyond one turn among them: 1,760 pairs, 176,000 beams."""
    rng = np.random.default_rng(20)
    worlds = [random_world(n, rng=seed) for n in (1, 2, 3, 4) for seed in range(5)]
    worlds += [random_world(n, style="free", gap=0.01, rng=n) for n in (1, 2, 3, 4, 5, 6, 7, 8) for _ in range(2)]
    worlds += [crowd(n, rng) for n in (2, 5, 8, 12) for _ in range(4)]
    worlds += [row_of_neighbours(rng) for _ in range(12)]
    worlds += [odd_crowd(n, rng) for n in (1, 2, 4, 8) for _ in range(6)]
    return [(world, random_poses(20, rng)) for world in worlds]


@pytest.fixture(scope="module")
def walled_scenes():
    """8 boards with walls and polygons of all sorts, 20 poses each, some of them outside."""
    rng = np.random.default_rng(21)
    worlds = [odd_crowd(n, rng, size=size, walls=True) for n in (0, 1, 3, 6) for size in (0.7, 1.0)]
    return [(world, random_poses(20, rng)) for world in worlds]


def turned(points, angle):
    c, s = math.cos(angle), math.sin(angle)
    return np.array([(c * x - s * y, s * x + c * y) for x, y in np.reshape(points, (-1, 2)).tolist()])


def moved_world(world, offset, angle):
    """All shapes turned about the origin by ``angle``, then shifted."""
    return World(
        [
            Circle(turned(s.center, angle)[0] + offset, s.radius)
            if isinstance(s, Circle)
            else Polygon(turned(s.vertices, angle) + offset)
            for s in world.shapes
        ],
        world.size,
    )


def moved_poses(poses, offset, angle):
    poses = np.reshape(poses, (-1, 3))
    return np.column_stack([turned(poses[:, :2], angle) + offset, poses[:, 2] + angle])


# --- The ray caster by hand ---------------------------------------------------------------------------------

QUARTERS = [0.0, math.pi / 2, math.pi, 3 * math.pi / 2]
BY_HAND = {  # shapes, pose, ranges ahead, left, behind, right
    "nothing there": ([], (0, 0, 0), [INF] * 4),
    "circle ahead": ([Circle((1, 0), 0.25)], (0, 0, 0), [0.75, INF, INF, INF]),
    "circle behind": ([Circle((1, 0), 0.25)], (2, 0, 0), [INF, INF, 0.75, INF]),
    "circle on the left": ([Circle((0, 2), 0.5)], (0, 0, 0), [INF, 1.5, INF, INF]),
    "circle off the beam, 3-4-5": ([Circle((2, 0.3), 0.5)], (0, 0, 0), [1.6, INF, INF, INF]),
    "heading left, circle ahead": ([Circle((0, 2), 0.5)], (0, 0, math.pi / 2), [1.5, INF, INF, INF]),
    "heading right by a turn and a quarter": ([Circle((0, 2), 0.5)], (0, 0, -5 * math.pi / 2), [INF, INF, 1.5, INF]),
    "box ahead": ([box(1, -1, 2, 1)], (0, 0, 0), [1, INF, INF, INF]),
    "box on the right": ([box(-1, -3, 1, -2)], (0.5, 0, 0), [INF, INF, INF, 2]),
    "a wall on each side": (
        [box(1, -1, 2, 1), box(-1, 2, 1, 3), box(-4, -1, -3, 1), box(-1, -5, 1, -4)],
        *((0, 0, 0), [1, 2, 3, 4]),
    ),
    "the nearer of two": ([box(2, -1, 3, 1), Circle((1, 0), 0.25)], (0, 0, 0), [0.75, INF, INF, INF]),
    "the nearer of two, the other first": ([Circle((1, 0), 0.25), box(2, -1, 3, 1)], (0, 0, 0), [0.75, INF, INF, INF]),
    "a slanted side, above and behind": ([Polygon([(1, -1), (4, 2), (1, 2)])], (3, 0, 0), [INF, 1, 1, INF]),
    "a triangle's tip": ([Polygon([(1, 0), (2, -1), (2, 1)])], (0, 0, 0), [1, INF, INF, INF]),
    "between two shapes": ([Circle((1, 0.5), 0.25), Circle((1, -0.5), 0.25)], (0, 0, 0), [INF] * 4),
}


@pytest.mark.parametrize(("shapes", "pose", "ranges"), BY_HAND.values(), ids=BY_HAND)
def test_cast_rays_by_hand(shapes, pose, ranges):
    cast = cast_rays(World(shapes), [pose], QUARTERS)
    assert cast.shape == (1, 4)
    assert same(cast[0], ranges, 1e-12).all()


def test_no_poses_and_no_beams():
    world = World([Circle((1, 0), 0.25), box(1, 1, 2, 2)])
    assert cast_rays(world, [], ANGLES).shape == (0, 100)
    assert cast_rays(world, ORIGIN, []).shape == (1, 0)


WRONG_ANGLES = "angles must be finite and increase within one turn of 2 pi"
CAST_FAILURES = {
    "angles fall": ([0, 2, 1], INF, WRONG_ANGLES),
    "an angle twice": ([0, 1, 1], INF, WRONG_ANGLES),
    "a full turn: the first beam twice": ([0, 2 * math.pi], INF, WRONG_ANGLES),
    "more than a turn": ([-4, 4], INF, WRONG_ANGLES),
    "NaN": ([0, NAN], INF, WRONG_ANGLES),
    "infinity twice": ([INF, INF], INF, WRONG_ANGLES),
    "one number": (0.5, INF, WRONG_ANGLES),
    "a table": ([[0, 1]], INF, WRONG_ANGLES),
    "range zero": ([0], 0, "range_max must be a number > 0, got 0"),
    "range negative": ([0], -0.3, "range_max must be a number > 0, got -0.3"),
    "range NaN": ([0], NAN, "range_max must be a number > 0, got nan"),
}


@pytest.mark.parametrize(("angles", "range_max", "sentence"), CAST_FAILURES.values(), ids=CAST_FAILURES)
def test_cast_rays_failure(angles, range_max, sentence):
    with pytest.raises(ValueError, match=exactly(sentence)):
        cast_rays(World([Circle((1, 0), 0.25)]), ORIGIN, angles, range_max)


POSES_FAILURES = {
    "without a heading": ([(0, 0)], "poses must have shape (P, 3): x, y, heading; got shape (1, 2)"),
    "None": (None, "poses must be numbers in an array of shape (P, 3): x, y, heading, got None"),
    "NaN": ([(0, 0, NAN)], "poses must be finite, got (0.0, 0.0, nan) in row 0"),
    "text": ("here", "poses must be numbers in an array of shape (P, 3): x, y, heading, got 'here'"),
}


@pytest.mark.parametrize(("poses", "sentence"), POSES_FAILURES.values(), ids=POSES_FAILURES)
def test_poses_failure(poses, sentence):
    with pytest.raises(ValueError, match=exactly(sentence)):
        cast_rays(World(), poses, ANGLES)
    with pytest.raises(ValueError, match=exactly(sentence)):
        scan(World(), poses)


# --- The ray caster against the oracles ---------------------------------------------------------------------


def test_against_geos(scenes, walled_scenes):
    pairs = hits = doubtful = 0
    for world, poses in [*scenes, *walled_scenes]:
        ranges = cast_rays(world, poses, ANGLES)
        doubtful += check_against_geos(world, poses, ANGLES, ranges)
        pairs += len(poses)
        hits += np.isfinite(ranges).sum()
    assert pairs >= 1900
    assert hits > 40_000
    assert doubtful <= 3, "a random beam is hardly ever on a knife's edge"


def test_poses_inside_against_geos(scenes, walled_scenes):
    """A pose in a shape sees nothing, and Scans.inside says so."""
    n_inside = 0
    for world, poses in [*scenes, *walled_scenes]:
        scans = scan(world, poses, Lidar(range_min=0, range_max=3))
        inside = geos(world, poses, [0.0])[1]
        np.testing.assert_array_equal(scans.inside, inside)
        beyond = (np.abs(poses[:, :2]) >= world.size / 2).any(axis=1) & world.walled
        np.testing.assert_array_equal(scans.inside, inside_shape(world, poses) | beyond)
        assert np.isinf(scans.ranges[inside]).all()
        n_inside += inside.sum()
    assert n_inside > 50


def test_against_brute_force(scenes, walled_scenes):
    checked = 0
    for world, poses in [*scenes[::2], *walled_scenes[::2]]:
        ranges = cast_rays(world, poses[:6], ANGLES[::7])
        for pose, row in zip(poses, ranges, strict=False):
            for angle, value in zip(ANGLES[::7], row, strict=True):
                assert same(value, brute_force(world, pose, angle))
                checked += 1
    assert checked > 2500


def test_the_plain_form_sees_what_the_fast_form_sees(scenes, walled_scenes):
    hits = 0
    for world, poses in [*scenes, *walled_scenes]:
        plain, fast = cast_plainly(world, poses[:8], ANGLES[::9]), cast_rays(world, poses[:8], ANGLES[::9], 0.8)
        assert same(np.where(plain < 0.8, plain, np.inf), fast).all()
        hits += np.isfinite(fast).sum()
    assert hits > 800


def test_the_plain_form_by_hand():
    for shapes, pose, ranges in BY_HAND.values():
        assert same(cast_plainly(World(shapes), [pose], QUARTERS)[0], ranges, 1e-12).all()


def test_any_bearings_against_geos(scenes):
    """Angles need not be even, start at 0, be positive, or fill the turn."""
    rng = np.random.default_rng(21)
    for world, poses in scenes[::3]:
        angles = rng.uniform(-20, 20) + np.sort(rng.uniform(0, rng.uniform(0.1, 6.28), 40))
        check_against_geos(world, poses[:5], angles, cast_rays(world, poses[:5], angles))


@pytest.mark.parametrize("start", [-20.0, -2 * math.pi, -1e-17, 1e-17, 3.0, 2 * math.pi, 100.0])
def test_where_the_fan_starts_does_not_matter(start, scenes):
    for world, poses in scenes[::8]:
        ranges = cast_rays(world, poses, start + ANGLES)
        assert same(ranges, cast_rays(world, poses + np.array([0, 0, start]), ANGLES)).all()


@pytest.mark.parametrize("beams", [1, 2, 3, 4, 5, 7, 12, 50, 101, 360])
def test_any_number_of_beams(beams, scenes):
    lidar = Lidar(beams=beams, range_min=0, range_max=3)
    for world, poses in scenes[::8]:
        scans = scan(world, poses[:8], lidar)
        assert scans.ranges.shape == (8, beams)
        check_against_geos(world, poses[:8], scans.angles, scans.ranges)


@pytest.mark.parametrize("turns", [1, -1, 100_000])
def test_a_heading_of_many_turns(turns, scenes):
    for world, poses in scenes[::16]:
        turned_on = poses + np.array([0, 0, 2 * math.pi * turns])
        assert same(cast_rays(world, turned_on, ANGLES), cast_rays(world, poses, ANGLES)).all()


def test_no_beam_slips_through_a_corner_after_many_turns():
    """A heading of a million rad is known to 1e-10 rad only: both sides of the corner must round it alike."""
    rng = np.random.default_rng(34)
    for _ in range(100):
        tip = free_shape("rectangle", rng.uniform(-0.3, 0.3, 2), rng)
        corner = tip.vertices[0]
        pose = np.array([*(corner + 0.5 * (corner - tip.centroid)), rng.uniform(-1e6, 1e6)])
        angles = aimed_at([corner], pose) + np.linspace(-1e-9, 1e-9, 400)
        assert np.isfinite(cast_rays(World([tip]), pose, angles)).all()


FANS = {
    "even": ANGLES,
    "one beam": [0.3],
    "uneven": np.sort(np.random.default_rng(1).uniform(-7, -1, 40)),
    "two": [0, 3],
}


@pytest.mark.parametrize("angles", FANS.values(), ids=FANS)
def test_beams_between_two_bearings(angles):
    """Against the definition: some multiple of the turn brings the beam between the two."""
    angles, rng = np.asarray(angles, dtype=float), np.random.default_rng(31)
    first = rng.uniform(-30, 30, 300)
    width = np.concatenate([rng.uniform(0, 6.2, 200), rng.uniform(0, 0.05, 80), np.zeros(10), rng.uniform(-3, 0, 10)])
    interval, beam = Fan(angles).between(first, first + width)
    expected = ((angles - first[:, None]) % (2 * math.pi) <= width[:, None]).nonzero()
    assert sorted(zip(interval.tolist(), beam.tolist(), strict=True)) == list(
        zip(*map(np.ndarray.tolist, expected), strict=True)
    )


# --- Knife's edges ------------------------------------------------------------------------------------------

WALL = box(0.5, -0.25, 0.75, 0.25)
GRAZING = {  # shapes about a beam from the origin along the x axis; what the beam may read; to how many metres
    "along a side, shape on the left": ([box(0.125, 0, 0.375, 0.25)], [0.125, INF], 1e-9),
    "along a side, shape on the right": ([box(0.125, -0.25, 0.375, 0)], [0.125, INF], 1e-9),
    "along a long side, from nearby": ([box(0.0625, 0, 2, 0.25)], [0.0625, INF], 1e-9),
    "along a side, a wall behind": ([box(0.125, 0, 0.375, 0.25), WALL], [0.125, 0.5], 1e-9),
    "along the side of a triangle": ([Polygon([(0.125, 0), (0.375, 0), (0.3, 0.25)])], [0.125, INF], 1e-9),
    "along the side that two boxes share": ([box(0.125, 0, 0.375, 0.25), box(0.125, -0.25, 0.375, 0)], [0.125], 1e-9),
    "along the sides of two boxes, the farther first": (
        [box(0.375, 0, 0.5, 0.25), box(0.125, -0.25, 0.25, 0)],
        *([0.125, 0.375, INF], 1e-9),
    ),
    "at a tip": ([Polygon([(0.125, 0), (0.375, -0.25), (0.375, 0.25)])], [0.125], 1e-9),
    "at a tip, beside a side seen steeply": ([Polygon([(0.125, 0), (0.375, 1e-3), (0.25, 0.25)])], [0.125, INF], 1e-9),
    "past a corner": ([Polygon([(0.25, 0), (0.375, 0.25), (0.125, 0.25)])], [0.25, INF], 1e-9),
    "past a corner, a wall behind": ([Polygon([(0.25, 0), (0.375, 0.25), (0.125, 0.25)]), WALL], [0.25, 0.5], 1e-9),
    "past two corners": (
        [Polygon([(0.125, 0), (0.1875, 0.25), (0.0625, 0.25)]), Polygon([(0.25, 0), (0.1875, -0.25), (0.3125, -0.25)])],
        *([0.125, 0.25, INF], 1e-9),
    ),
    "between boxes that touch at a corner": (
        [box(0.125, 0, 0.25, 0.25), box(0.25, -0.25, 0.375, 0)],
        *([0.125, 0.25], 1e-9),
    ),
    "through opposite corners": ([Polygon([(0.25, 0), (0.375, -0.125), (0.5, 0), (0.375, 0.125)])], [0.25], 1e-9),
    # At a tangent the range changes with the square root of the bearing: 1e-12 rad are 0.4 micrometres.
    "touching a circle on the left": ([Circle((0.25, 0.125), 0.125)], [0.25, INF], 1e-6),
    "touching a circle on the right": ([Circle((0.25, -0.125), 0.125)], [0.25, INF], 1e-6),
    "touching a large circle": ([Circle((0.25, 2), 2)], [0.25, INF], 4e-6),
    "touching a circle, a wall behind": ([Circle((0.25, 0.125), 0.125), WALL], [0.25, 0.5], 1e-6),
    "between circles that touch": ([Circle((0.25, 0.125), 0.125), Circle((0.25, -0.125), 0.125)], [0.25], 1e-6),
    "between a circle and a box that touch": ([Circle((0.25, 0.125), 0.125), box(0.25, -0.25, 0.375, 0)], [0.25], 1e-6),
    "between a circle and a tip that touch": (
        [Circle((0.25, 0.125), 0.125), Polygon([(0.25, 0), (0.125, -0.25), (0.375, -0.25)])],
        *([0.25], 1e-6),
    ),
}  # fmt: skip


@pytest.mark.parametrize(("shapes", "allowed", "tolerance"), GRAZING.values(), ids=GRAZING)
def test_grazing_beams(shapes, allowed, tolerance):
    """A beam along a side once read a distance up to 10 cm in front of the shape: 0 / 0, up to rounding.

    From any direction, with any heading: rounding falls out differently each time.
    """
    rng = np.random.default_rng(22)
    motions = [(np.zeros(2), 0.0, 0.0), (np.zeros(2), math.pi / 2, 0.0), (np.zeros(2), math.pi, math.pi)]
    motions += [(rng.uniform(-0.3, 0.3, 2), rng.uniform(0, 7), rng.uniform(-7, 7)) for _ in range(300)]
    for i, (offset, angle, heading) in enumerate(motions):
        world = moved_world(World(shapes), offset, angle)
        pose = np.array([*offset, heading])
        ranges = cast_rays(world, pose, [angle - heading])
        assert same(ranges[0, 0], allowed, tolerance).any(), (ranges[0, 0], allowed)
        if i < 40:
            check_against_geos(world, pose, [angle - heading], ranges)


def test_a_beam_along_an_axis_aligned_side_hits_its_nearer_end():
    """Here nothing is rounded, and a beam that meets a corner hits it."""
    square = World([box(0.25, -0.125, 0.5, 0.125)])
    assert cast_rays(square, (0, 0.125, 0), [0.0]).tolist() == [[0.25]]
    assert cast_rays(square, (0, -0.125, 0), [0.0]).tolist() == [[0.25]]
    assert cast_rays(square, (1, 0.125, 0), [0.0, math.pi]).tolist() == [[INF, 0.5]]
    assert cast_rays(square, (0.25, 1, 0), [3 * math.pi / 2]).tolist() == [[0.875]]


def test_a_beam_just_past_a_side_seen_edge_on_reads_no_farther_than_its_end():
    """A beam this close beside a corner still hits it; where it crosses the side's line may be far beyond."""
    height = 1e-11
    world = World([Polygon([(0.25, height), (0.125, 0), (0.1875, -0.25)])])
    past = np.linspace(-0.99, 0.99, 199) * CORNER_HIT
    ranges = cast_rays(world, ORIGIN, height / 0.25 + past)[0]
    assert (ranges[past <= -1e-15] <= 0.25).all()
    assert ((ranges[past > 0] == 0.25) | np.isinf(ranges[past > 0])).all()


def aimed_at(points, pose):
    """Bearings of points from a pose, as increasing angles from its heading."""
    offset = np.asarray(points) - pose[:2]
    return np.unique((np.arctan2(offset[:, 1], offset[:, 0]) - pose[2]) % (2 * np.pi))


def test_beams_aimed_at_every_corner_against_geos(scenes):
    aimed = 0
    for world, poses in scenes[::2]:
        corners = [s.vertices for s in world.shapes if isinstance(s, Polygon)]
        for pose in poses[:4] if corners else []:
            angles = aimed_at(np.vstack(corners), pose)
            check_against_geos(world, pose, angles, cast_rays(world, pose, angles))
            aimed += len(angles)
    assert aimed > 1000


@pytest.mark.parametrize("kind", ["triangle", "rectangle", "pentagon"])
def test_a_beam_aimed_at_a_visible_corner_hits_it(kind):
    """Also at the two corners where the outline turns away: the beam must not slip past."""
    rng = np.random.default_rng(23)
    for _ in range(100):
        shape = free_shape(kind, rng.uniform(-0.2, 0.2, 2), rng)
        pose = random_poses(1, rng)[0] * (2, 2, 1)
        if shape.signed_distance([pose[:2]])[0] < 1e-3:
            continue
        faces_us = ((pose[:2] - shape.vertices) * shape.normals).sum(axis=1) > 0
        for corner in shape.vertices[faces_us | np.roll(faces_us, 1)]:
            read = cast_rays(World([shape]), pose, aimed_at([corner], pose))[0, 0]
            assert read == pytest.approx(math.dist(corner, pose[:2]), abs=EXACT)


def test_beams_aimed_at_the_tangents_of_circles():
    rng = np.random.default_rng(24)
    for _ in range(300):
        circle = Circle(rng.uniform(-0.3, 0.3, 2), rng.uniform(0.02, 0.15))
        pose = random_poses(1, rng)[0]
        distance = math.dist(circle.center, pose[:2])
        if distance <= circle.radius * 1.001:
            continue
        middle = np.arctan2(*(circle.center - pose[:2])[::-1]) - pose[2]
        half = math.asin(circle.radius / distance)
        for side in (-half, half):
            expected = math.sqrt(distance**2 - circle.radius**2)
            assert cast_rays(World([circle]), pose, [middle + side]) == pytest.approx(expected, abs=2e-6)
            # Well beside the tangent there is no doubt: 1e-9 rad are a hundred times what rounding needs.
            assert np.isinf(cast_rays(World([circle]), pose, [middle + side * (1 + 1e-8)])).all()
            assert np.isfinite(cast_rays(World([circle]), pose, [middle + side * (1 - 1e-8)])).all()
    assert CORNER_HIT < KNIFE_EDGE / 100


# --- Poses in and on shapes ---------------------------------------------------------------------------------

SOLIDS = {
    "circle": Circle((0.1, 0.05), 0.08),
    "triangle": Polygon([(0, 0), (0.2, 0), (0.05, 0.15)]),
    "rectangle": box(-0.1, -0.05, 0.1, 0.05).moved(angle=0.3),
    "pentagon": Polygon([(0, -0.1), (0.09, -0.03), (0.05, 0.08), (-0.05, 0.08), (-0.091, -0.03)]),
    "dart": Polygon([(0.1, -0.1), (0.2, 0.1), (0.1, 0.02), (0, 0.1)]),
    "star": Polygon(
        [(r * math.cos(0.2 * math.pi * i), r * math.sin(0.2 * math.pi * i)) for i, r in enumerate(5 * (0.1, 0.05))]
    ),
}


@pytest.mark.parametrize("shape", SOLIDS.values(), ids=SOLIDS)
@pytest.mark.parametrize("lidar", [Lidar(range_min=0), Lidar(noise_std=0.1, spurious=1)], ids=["exact", "disturbed"])
def test_a_pose_inside_sees_nothing_and_says_so(shape, lidar):
    """Neither its own shape nor others around it, nor ghosts."""
    world = World([Circle((0.4, 0), 0.1), shape, box(-0.5, -0.1, -0.3, 0.1)])
    deep = shape.centroid + 0.999999 * (shape.outline(50) - shape.centroid)
    poses = np.column_stack([np.vstack([shape.centroid, deep]), np.linspace(-7, 7, 51)])
    scans = scan(world, poses, lidar, rng=0)
    assert scans.inside.all()
    assert np.isinf(scans.ranges).all()
    assert scans.points().shape == (0, 2)
    just_outside = shape.centroid + 1.000001 * (shape.outline(50) - shape.centroid)
    assert not scan(world, np.column_stack([just_outside, np.zeros(50)]), lidar, rng=0).inside.any()


@pytest.mark.parametrize("kind", ["circle", "triangle", "rectangle", "pentagon"])
def test_a_pose_on_an_outline(kind):
    """Rounding decides whether it is inside, and sees nothing, or outside: then it reads 0 towards the shape and
    sees the others freely."""
    shape, others = SOLIDS[kind], World([Circle((0.45, 0), 0.1), box(-0.5, -0.1, -0.3, 0.1)])
    places = shape.outline(41)
    for place, heading in zip(places, np.linspace(-7, 7, 41), strict=True):
        pose = np.array([*place, heading])
        ranges = cast_rays(World([shape, *others.shapes]), pose, ANGLES)[0]
        if np.isinf(ranges).all() and scan(World([shape]), pose).inside[0]:
            continue
        if shape.kind == "circle":
            outward = place - shape.center
        else:
            outward = shape.normals[np.argmax(((place - shape.vertices) * shape.normals).sum(axis=1))]
        leaving = (np.cos(heading + ANGLES) * outward[0] + np.sin(heading + ANGLES) * outward[1]) / np.hypot(*outward)
        assert (ranges[leaving < -1e-3] < 1e-9).all()
        free = leaving > 1e-3
        assert same(ranges[free], cast_rays(others, pose, ANGLES)[0, free]).all()


@pytest.mark.parametrize("off", [0.0, 1e-18, 3e-17, 1e-16, 1e-15, 1e-13, 1e-12, 1e-9])
def test_a_robot_on_a_side_sees_no_phantom_beyond_it(off):
    """Whichever way a side runs, a beam along it ends on the outline or nowhere."""
    rng = np.random.default_rng(8)
    upright = box(0.1, -0.21, 0.3, -0.09)
    for shape in [
        upright,
        *(free_shape(kind, rng.uniform(-0.3, 0.3, 2), rng) for kind in ("triangle", "pentagon", *SORTS)),
    ]:
        for corner, edge, normal in zip(shape.vertices, shape.edges, shape.normals, strict=True):
            along = np.arctan2(edge[1], edge[0])
            places = corner + rng.uniform(size=(50, 1)) * edge + off * normal
            poses = np.column_stack([places, along + rng.choice([0, np.pi, np.pi / 2, rng.uniform(-7, 7)], 50)])
            ranges = cast_rays(World([shape]), poses, ANGLES)
            pose, beam = np.isfinite(ranges).nonzero()
            bearing, far = poses[pose, 2] + ANGLES[beam], ranges[pose, beam]
            ends = places[pose] + far[:, None] * np.column_stack([np.cos(bearing), np.sin(bearing)])
            assert np.abs(shape.signed_distance(ends)).max(initial=0.0) < 1e-9


def test_a_pose_exactly_on_a_side_or_an_outline_is_inside():
    world = World([box(0.25, -0.125, 0.5, 0.125), Circle((-0.5, 0), 0.25)])
    poses = [(0.25, 0, 0), (0.375, 0.125, 0), (0.5, -0.0625, 0), (-0.25, 0, 0), (-0.5, 0.25, 0)]
    scans = scan(world, poses, Lidar(range_min=0))
    assert scans.inside.all()
    assert np.isinf(scans.ranges).all()
    np.testing.assert_array_equal(inside_shape(world, scans.poses), True)


@pytest.mark.parametrize("kind", ["triangle", "rectangle", "pentagon", *SORTS])
def test_a_pose_exactly_at_a_corner_is_inside(kind):
    """With any heading: a corner's distance to itself is 0, turned or not."""
    rng = np.random.default_rng(25)
    for _ in range(50):
        shape = free_shape(kind, rng.uniform(-0.3, 0.3, 2), rng)
        poses = np.column_stack([shape.vertices, rng.uniform(-7, 7, len(shape.vertices))])
        scans = scan(World([shape, Circle((0.6, 0.6), 0.1)]), poses, Lidar(range_min=0, range_max=2))
        assert scans.inside.all()
        assert np.isinf(scans.ranges).all()


# --- The seam -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("beams", [1, 2, 3, 7, 100, 101, 360])
@pytest.mark.parametrize("shape", [Circle((0.2, 0), 0.05), box(0.15, -0.05, 0.25, 0.05)], ids=["circle", "box"])
def test_a_shape_straight_ahead_lies_across_the_seam(shape, beams):
    """Beam i and beam B - i are mirror images, and none is missing on either side of 0 = 2 pi."""
    ranges = scan(World([shape]), ORIGIN, Lidar(beams=beams)).ranges[0]
    assert ranges[0] == pytest.approx(0.15)
    assert same(ranges[1:], ranges[1:][::-1]).all()
    half = math.asin(0.05 / 0.2) if shape.kind == "circle" else math.atan2(0.05, 0.15)
    assert np.isfinite(ranges).sum() == 1 + 2 * math.floor(half / (2 * math.pi / beams))


@pytest.mark.parametrize("beams", [1, 2, 3, 5, 6, 7, 10, 49, 99, 100, 360, 997, 4096])
def test_no_beam_is_doubled(beams):
    lidar = Lidar(beams=beams)
    np.testing.assert_array_equal(lidar.angles, np.arange(beams) * lidar.angle_increment)
    assert lidar.angle_increment == 2 * math.pi / beams
    assert lidar.angles[0] == 0
    assert lidar.angles[-1] == pytest.approx(2 * math.pi - lidar.angle_increment)
    assert len(lidar.angles) == beams


def test_a_circle_all_around_the_turn():
    """One circle, moved round the robot in small steps, is seen by the same number of beams, give or take one."""
    for distance, radius in ((0.2, 0.05), (0.1, 0.0999)):
        centers = [turned((distance, 0), bearing)[0] for bearing in np.linspace(0, 2 * np.pi, 777)]
        seen = [np.isfinite(cast_rays(World([Circle(c, radius)]), ORIGIN, ANGLES)).sum() for c in centers]
        expected = 2 * math.asin(radius / distance) / (2 * math.pi / 100)
        assert set(seen) == {math.floor(expected), math.ceil(expected)}


# --- Invariances --------------------------------------------------------------------------------------------


def test_turning_the_robot_by_whole_beams_rolls_the_ranges(scenes):
    for world, poses in scenes[::4]:
        ranges = cast_rays(world, poses, ANGLES)
        for k in (1, 2, 50, 99, 100, -3, 250):
            rolled = cast_rays(world, poses + np.array([0, 0, k * Lidar().angle_increment]), ANGLES)
            assert same(rolled, np.roll(ranges, -k, axis=1)).all()


@settings(max_examples=40)
@given(seeds, st.tuples(st.floats(-3, 3), st.floats(-3, 3)), st.floats(-7, 7))
def test_moving_world_and_robot_together_changes_nothing(seed, offset, angle):
    rng = np.random.default_rng(seed)
    world, poses = crowd(4, rng), random_poses(10, rng)
    before = cast_rays(world, poses, ANGLES)
    after = cast_rays(moved_world(world, offset, angle), moved_poses(poses, offset, angle), ANGLES)
    assert same(before, after).all()


@settings(max_examples=40)
@given(seeds)
def test_mirrored_world_gives_mirrored_ranges(seed):
    rng = np.random.default_rng(seed)
    world, poses = crowd(5, rng), random_poses(10, rng)
    mirrored = World(
        Circle(s.center * (1, -1), s.radius) if isinstance(s, Circle) else Polygon(s.vertices * (1, -1))
        for s in world.shapes
    )
    ranges = cast_rays(mirrored, poses * (1, -1, -1), ANGLES)
    assert same(ranges, np.roll(cast_rays(world, poses, ANGLES)[:, ::-1], 1, axis=1)).all()


@settings(max_examples=40)
@given(seeds, st.floats(0.01, 100))
def test_a_world_twice_as_large_gives_ranges_twice_as_long(seed, scale):
    rng = np.random.default_rng(seed)
    world, poses = crowd(5, rng), random_poses(10, rng)
    scaled = World(
        Circle(s.center * scale, s.radius * scale) if isinstance(s, Circle) else Polygon(s.vertices * scale)
        for s in world.shapes
    )
    ranges = cast_rays(scaled, poses * (scale, scale, 1), ANGLES)
    assert same(ranges / scale, cast_rays(world, poses, ANGLES)).all()


def test_order_of_shapes_and_corners_leaves_no_trace(scenes):
    for world, poses in scenes[::4]:
        ranges = cast_rays(world, poses, ANGLES)
        np.testing.assert_array_equal(cast_rays(World(world.shapes[::-1]), poses, ANGLES), ranges)
        rolled = [s if isinstance(s, Circle) else Polygon(np.roll(s.vertices, 1, axis=0)) for s in world.shapes]
        assert same(cast_rays(World(rolled), poses, ANGLES), ranges, 1e-12).all()


def test_a_world_is_the_nearest_of_its_shapes(scenes):
    for world, poses in scenes[::4]:
        alone = [cast_rays(World([s]), poses, ANGLES) for s in world.shapes]
        outside = ~inside_shape(world, poses)
        np.testing.assert_array_equal(cast_rays(world, poses, ANGLES)[outside], np.min(alone, axis=0)[outside])


def test_the_same_world_again_and_another_in_between(scenes):
    """Worlds that were seen before are remembered: more of them than are kept, and twice."""
    first = [cast_rays(world, poses, ANGLES) for world, poses in scenes]
    for (world, poses), ranges in zip(scenes, first, strict=True):
        np.testing.assert_array_equal(cast_rays(World(world.shapes, world.size), poses, ANGLES), ranges)


# --- Many shapes, many poses --------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def large_world():
    """288 shapes on 6 m x 6 m, each kind often enough for the spatial index."""
    rng = np.random.default_rng(26)
    grid = np.stack(np.meshgrid(np.arange(12), np.arange(12)), axis=-1).reshape(-1, 2) * 0.5 - 2.75
    centers = np.vstack([grid, grid + 0.2])
    kinds = ["circle", "triangle", "rectangle", "pentagon"] * 72
    world = World([free_shape(k, c, rng) for k, c in zip(kinds, centers, strict=True)], 6.0)
    assert sum(s.kind == "circle" for s in world.shapes) >= CELLS_FROM
    return world


@pytest.mark.parametrize("range_max", [0.3, 1.0, INF])
def test_a_large_world_equals_its_parts(large_world, range_max):
    """Parts of 48 shapes are searched without the spatial index."""
    poses = random_poses(150, np.random.default_rng(27)) * (5, 5, 1)
    shapes = large_world.shapes
    parts = [World(shapes[i : i + 48]) for i in range(0, len(shapes), 48)]
    expected = np.min([cast_rays(part, poses, ANGLES, range_max) for part in parts], axis=0)
    expected[inside_shape(large_world, poses)] = INF
    ranges = cast_rays(large_world, poses, ANGLES, range_max)
    np.testing.assert_array_equal(ranges, expected)
    assert np.isfinite(ranges).mean() > 0.1


def test_a_large_world_against_geos(large_world):
    poses = random_poses(12, np.random.default_rng(28)) * (5, 5, 1)
    angles = ANGLES[::4]
    expected, inside = geos(large_world, poses, angles, length=0.6)
    expected[expected > 0.5] = INF
    assert same(cast_rays(large_world, poses, angles, 0.5), expected).all()
    np.testing.assert_array_equal(scan(large_world, poses).inside, inside)


@pytest.mark.parametrize("reach", [0.01, 0.5, 3.0, 1e3])
@pytest.mark.parametrize("n", [1, CELLS_FROM - 1, CELLS_FROM, 300])
def test_what_is_near_against_all_distances(n, reach):
    """Positions among the shapes, far outside, and exactly where the cells meet; shapes of very different sizes."""
    rng = np.random.default_rng(32)
    x, y, radii = rng.uniform(-3, 3, n), rng.uniform(-1, 1, n), rng.choice([1e-3, 0.1, 0.6], n)
    near = Near(x, y, radii, reach)
    assert (near.cells is None) == (n < CELLS_FROM)
    places = rng.uniform(-5, 5, (400, 2))
    if near.cells is not None:
        corners = np.stack(np.meshgrid(np.arange(-2, near.cells.columns + 2), np.arange(-2, near.cells.rows + 2)), -1)
        places = np.vstack(
            [places, (near.cells.left, near.cells.low) + near.cells.edge * corners.reshape(-1, 2)[:3000]]
        )
    position, shape = near.pairs(places[:, 0], places[:, 1])
    squares = (places[:, :1] - x) ** 2 + (places[:, 1:] - y) ** 2
    expected = (squares <= (radii + reach) ** 2).nonzero()
    assert sorted(zip(position.tolist(), shape.tolist(), strict=True)) == list(
        zip(*map(np.ndarray.tolist, expected), strict=True)
    )
    assert np.bincount(position, minlength=1).max() <= near.most


def test_cells_hold_few_shapes_and_are_few():
    """A look-up costs the same on any board: cells know a few shapes each, and there are at most so many cells."""
    rng = np.random.default_rng(33)
    for n in (1000, 16_000):
        side = math.sqrt(n) / 2  # 4 shapes on a square metre
        near = Near(rng.uniform(0, side, n), rng.uniform(0, side, n), np.full(n, 0.1), 0.3)
        assert near.cells.count.mean() < 5
        assert near.cells.columns * near.cells.rows <= 17 * n
    far_apart = Near(np.append(np.zeros(50), 1e6), np.append(np.arange(50.0), 1e6), np.full(51, 0.1), 0.3)
    assert far_apart.cells.columns * far_apart.cells.rows <= 17 * 51


@pytest.mark.parametrize("n_shapes", [1, 6])
def test_many_poses_equal_one_by_one(n_shapes):
    """9,000 poses make several blocks; the poses beside the borders of blocks are cast alone as well."""
    world = random_world(n_shapes, style="free", gap=0.01, rng=1)
    poses = random_poses(9000, np.random.default_rng(29))
    ranges = cast_rays(world, poses, ANGLES)
    block = min(PAIRS_PER_BLOCK // n_shapes, BEAMS_PER_BLOCK // len(ANGLES))
    assert block < len(poses) / 2
    alone = [*range(0, 9000, 29), *(i for b in range(block, 9000, block) for i in (b - 1, b, b + 1)), 8999]
    for i in alone:
        np.testing.assert_array_equal(cast_rays(world, poses[i], ANGLES)[0], ranges[i])
    parts = [cast_rays(world, poses[i : i + 700], ANGLES) for i in range(0, 9000, 700)]
    np.testing.assert_array_equal(np.vstack(parts), ranges)
    np.testing.assert_array_equal(scan(world, poses).inside, inside_shape(world, poses))


def test_range_max_only_leaves_out_what_is_farther(scenes):
    for world, poses in scenes[::2]:
        ranges = cast_rays(world, poses, ANGLES)
        for range_max in (0.05, 0.3, 0.7):
            expected = np.where(ranges <= range_max, ranges, INF)
            np.testing.assert_array_equal(cast_rays(world, poses, ANGLES, range_max), expected)


# --- Lidar --------------------------------------------------------------------------------------------------


def test_the_papers_sensor():
    lidar = Lidar()
    assert (lidar.beams, lidar.range_min, lidar.range_max, lidar.period) == (100, 0.05, 0.3, 0.1)
    assert (lidar.noise_std, lidar.dropout, lidar.spurious) == (0, 0, 0)


def test_a_lidar_cannot_be_changed():
    with pytest.raises(dataclasses.FrozenInstanceError):
        Lidar().beams = 3


LIDAR_FAILURES = {
    "no beams": ({"beams": 0}, "beams must be a whole number >= 1, got 0"),
    "negative beams": ({"beams": -1}, "beams must be a whole number >= 1, got -1"),
    "half a beam": ({"beams": 2.5}, "beams must be a whole number >= 1, got 2.5"),
    "beams a float": ({"beams": 100.0}, "beams must be a whole number >= 1, got 100.0"),
    "beams None": ({"beams": None}, "beams must be a whole number >= 1, got None"),
    "beams a truth value": ({"beams": True}, "beams must be a whole number >= 1, got True"),
    "range_min negative": ({"range_min": -0.1}, "range_min must be a finite number >= 0, got -0.1"),
    "range_min NaN": ({"range_min": NAN}, "range_min must be a finite number >= 0, got nan"),
    "range_min is text": ({"range_min": "0.05"}, "range_min must be a finite number >= 0, got '0.05'"),
    "range_max zero": ({"range_max": 0}, "range_max must be a finite number > 0, got 0"),
    "range_max infinite": ({"range_max": INF}, "range_max must be a finite number > 0, got inf"),
    "range_max None": ({"range_max": None}, "range_max must be a finite number > 0, got None"),
    "limits equal": ({"range_min": 0.3}, "range_min must be below range_max, got 0.3 and 0.3"),
    "limits crossed": ({"range_min": 0.2, "range_max": 0.1}, "range_min must be below range_max, got 0.2 and 0.1"),
    "noise negative": ({"noise_std": -0.001}, "noise_std must be a finite number >= 0, got -0.001"),
    "noise infinite": ({"noise_std": INF}, "noise_std must be a finite number >= 0, got inf"),
    "period zero": ({"period": 0}, "period must be a finite number > 0, got 0"),
    "period NaN": ({"period": NAN}, "period must be a finite number > 0, got nan"),
    "dropout negative": ({"dropout": -0.1}, "dropout must be a share from 0 to 1, got -0.1"),
    "dropout in percent": ({"dropout": 5}, "dropout must be a share from 0 to 1, got 5"),
    "spurious NaN": ({"spurious": NAN}, "spurious must be a share from 0 to 1, got nan"),
    "spurious above one": ({"spurious": 1.001}, "spurious must be a share from 0 to 1, got 1.001"),
    "spurious a truth value": ({"spurious": True}, "spurious must be a share from 0 to 1, got True"),
}


@pytest.mark.parametrize(("arguments", "sentence"), LIDAR_FAILURES.values(), ids=LIDAR_FAILURES)
def test_lidar_failure(arguments, sentence):
    with pytest.raises(ValueError, match=exactly(sentence)):
        Lidar(**arguments)


def test_lidar_at_its_limits():
    lidar = Lidar(beams=1, range_min=0, noise_std=0, dropout=1, spurious=1)
    assert (lidar.range_min, lidar.dropout, lidar.spurious) == (0, 1, 1)


# --- Scans: limits ------------------------------------------------------------------------------------------


def test_scan_is_the_exact_range_within_the_limits(scenes):
    lidar = Lidar()
    for world, poses in scenes:
        scans = scan(world, poses, lidar)
        exact = cast_rays(world, poses, lidar.angles)
        in_range = (exact >= lidar.range_min) & (exact <= lidar.range_max)
        np.testing.assert_array_equal(scans.ranges, np.where(in_range, exact, INF))
        np.testing.assert_array_equal(scans.poses, poses)
        np.testing.assert_array_equal(scans.angles, lidar.angles)


def test_the_papers_sensor_is_used_unless_told_otherwise():
    world, poses = random_world(3, rng=0), random_poses(20, np.random.default_rng(0))
    np.testing.assert_array_equal(scan(world, poses).ranges, scan(world, poses, Lidar()).ranges)


WALLS = {
    "side": lambda d: box(d, -1, d + 1, 1),
    "tip": lambda d: Polygon([(d, 0), (d + 1, -1), (d + 1, 1)]),
    "circle": lambda d: Circle((d + 0.25, 0), 0.25),
}
# Tenths and thirds are rounded when they are written, and 1 / (1 / 49) is not 49.
DISTANCES = [k / 4096 for k in range(1, 4096, 13)] + [k / 100 for k in range(1, 100)] + [k / 49 for k in range(1, 100)]


@pytest.mark.parametrize("wall", WALLS.values(), ids=WALLS)
def test_both_limits_are_in_range(wall):
    """A hit at exactly range_max was once lost in one case of twelve: the range was rounded to one bit more."""
    for d in DISTANCES:
        world = World([wall(d)])
        at_max = scan(world, ORIGIN, Lidar(beams=1, range_min=0, range_max=d)).ranges[0, 0]
        at_min = scan(world, ORIGIN, Lidar(beams=1, range_min=d, range_max=d + 1)).ranges[0, 0]
        assert at_max == pytest.approx(d, abs=1e-15)
        assert at_min == pytest.approx(d, abs=1e-15)
        assert at_max <= d <= at_min, "no reading outside the sensor's limits, not by one bit"
        assert cast_rays(world, ORIGIN, [0.0], d)[0, 0] == at_max


@pytest.mark.parametrize("wall", WALLS.values(), ids=WALLS)
def test_beyond_the_limits_is_not_in_range(wall):
    for d in DISTANCES:
        world = World([wall(d)])
        assert np.isinf(scan(world, ORIGIN, Lidar(beams=1, range_min=0, range_max=d - 1e-9)).ranges).all()
        assert np.isinf(scan(world, ORIGIN, Lidar(beams=1, range_min=d + 1e-9, range_max=9)).ranges).all()
        assert np.isinf(cast_rays(world, ORIGIN, [0.0], d - 1e-9)).all()


def test_what_is_nearer_than_range_min_blocks():
    near, far = Circle((0.05, 0), 0.03), Circle((0.2, 0), 0.03)
    assert scan(World([far]), ORIGIN).ranges[0, 0] == pytest.approx(0.17)
    assert np.isinf(scan(World([near, far]), ORIGIN).ranges[0, 0])
    assert np.isinf(scan(World([far, near]), ORIGIN).ranges[0, 0])
    assert scan(World([near, far]), ORIGIN, Lidar(range_min=0.01)).ranges[0, 0] == pytest.approx(0.02)


# --- Scans: the sensor's faults -----------------------------------------------------------------------------


@pytest.fixture(scope="module")
def ring():
    """A circle seen from 2,000 poses around it: 26,000 hits between 0.1 and 0.2 m, far from both limits."""
    rng = np.random.default_rng(30)
    bearings = rng.uniform(0, 2 * np.pi, 2000)
    around = 0.2 + rng.uniform(0.0, 0.02, 2000)
    poses = np.column_stack([around * np.cos(bearings), around * np.sin(bearings), rng.uniform(0, 7, 2000)])
    return World([Circle((0, 0), 0.1)]), poses, scan(World([Circle((0, 0), 0.1)]), poses)


@pytest.mark.parametrize("noise_std", [1e-6, 0.002, 0.01])
def test_noise_has_the_mean_and_spread_asked_for(noise_std, ring):
    world, poses, exact = ring
    noisy = scan(world, poses, Lidar(noise_std=noise_std), rng=1)
    np.testing.assert_array_equal(noisy.hits, exact.hits)
    errors = (noisy.ranges[exact.hits] - exact.ranges[exact.hits]) / noise_std
    assert len(errors) > 20_000
    assert abs(errors.mean()) < 4 / math.sqrt(len(errors))
    assert errors.std() == pytest.approx(1, abs=4 / math.sqrt(2 * len(errors)))
    assert stats.kstest(errors, "norm").pvalue > 0.01


def test_noise_is_independent_from_beam_to_beam_and_pose_to_pose(ring):
    world, poses, exact = ring
    noisy = scan(world, poses, Lidar(noise_std=0.002), rng=2)
    errors = np.full(exact.ranges.shape, NAN)
    errors[exact.hits] = noisy.ranges[exact.hits] - exact.ranges[exact.hits]
    for one, other in ((errors[:, :-1], errors[:, 1:]), (errors[:-1], errors[1:])):
        both = np.isfinite(one) & np.isfinite(other)
        assert both.sum() > 1000
        assert abs(np.corrcoef(one[both], other[both])[0, 1]) < 4 / math.sqrt(both.sum())


def test_noise_is_clipped_to_the_limits(ring):
    """Noise first, then the limits: a hit stays a hit, and reads 0.05 or 0.3 m at worst."""
    world, poses, exact = ring
    noisy = scan(world, poses, Lidar(noise_std=0.1), rng=3)
    np.testing.assert_array_equal(noisy.hits, exact.hits)
    ranges = noisy.ranges[noisy.hits]
    assert (ranges.min(), ranges.max()) == (0.05, 0.3)
    truth = exact.ranges[exact.hits]
    for limit, share in (
        (0.05, stats.norm.cdf((0.05 - truth) / 0.1).mean()),
        (0.3, stats.norm.sf((0.3 - truth) / 0.1).mean()),
    ):
        assert (ranges == limit).mean() == pytest.approx(share, abs=4 * math.sqrt(share / len(ranges)))


def test_noise_does_not_bring_in_what_is_out_of_range():
    world = World([Circle((0.5, 0), 0.1)])
    assert np.isinf(scan(world, np.zeros((200, 3)), Lidar(noise_std=0.2), rng=0).ranges).all()


@pytest.mark.parametrize("share", [0.0, 0.01, 0.3, 1.0])
def test_dropout_loses_its_share_of_the_hits(share, ring):
    world, poses, exact = ring
    seen = scan(world, poses, Lidar(dropout=share), rng=4)
    lost = exact.hits & ~seen.hits
    np.testing.assert_array_equal(seen.ranges[~lost], exact.ranges[~lost])
    n = exact.hits.sum()
    assert lost.sum() == pytest.approx(share * n, abs=4 * math.sqrt(n * share * (1 - share)))


@pytest.mark.parametrize("share", [0.0, 0.01, 0.3, 1.0])
def test_spurious_returns_take_their_share_of_all_beams(share, ring):
    """Hits and misses alike, evenly spread between the limits."""
    world, poses, exact = ring
    seen = scan(world, poses, Lidar(spurious=share), rng=5)
    ghosts = seen.ranges != exact.ranges
    for beams in (exact.hits, ~exact.hits):
        n = beams.sum()
        assert (ghosts & beams).sum() == pytest.approx(share * n, abs=4 * math.sqrt(n * share * (1 - share)))
    if share:
        assert (seen.ranges[ghosts] >= 0.05).all()
        assert (seen.ranges[ghosts] <= 0.3).all()
        assert stats.kstest(seen.ranges[ghosts], stats.uniform(0.05, 0.25).cdf).pvalue > 0.01


def test_each_fault_has_its_own_stream(ring):
    """Switching one fault on leaves the others as they were, to the last bit."""
    world, poses, exact = ring
    faults = {"noise_std": 0.002, "dropout": 0.2, "spurious": 0.1}
    alone = {name: scan(world, poses, Lidar(**{name: value}), rng=6).ranges for name, value in faults.items()}
    lost = exact.hits & np.isinf(alone["dropout"])
    ghost = alone["spurious"] != exact.ranges
    for names in (["noise_std", "dropout"], ["noise_std", "spurious"], ["dropout", "spurious"], list(faults)):
        together = scan(world, poses, Lidar(**{name: faults[name] for name in names}), rng=6).ranges
        expected = alone["noise_std"].copy() if "noise_std" in names else exact.ranges.copy()
        if "dropout" in names:
            expected[lost] = INF
        if "spurious" in names:
            expected[ghost] = alone["spurious"][ghost]
        np.testing.assert_array_equal(together, expected)


def test_more_of_a_fault_is_the_same_fault_and_more(ring):
    world, poses, exact = ring
    errors = [scan(world, poses, Lidar(noise_std=s), rng=7).ranges[exact.hits] for s in (0.001, 0.002)]
    truth = exact.ranges[exact.hits]
    np.testing.assert_allclose(2 * (errors[0] - truth), errors[1] - truth, atol=1e-15)
    few, many = (np.isinf(scan(world, poses, Lidar(dropout=s), rng=7).ranges) for s in (0.1, 0.3))
    assert (many | ~few).all()


def test_what_else_stands_on_the_board_does_not_change_a_beams_noise(ring):
    world, poses, _ = ring
    lidar = Lidar(noise_std=0.002)
    more = World([*world.shapes, Circle((0.35, 0.0), 0.05)])
    alone, crowded = scan(world, poses, lidar, rng=8).ranges, scan(more, poses, lidar, rng=8).ranges
    before, after = scan(world, poses).ranges, scan(more, poses).ranges
    unchanged = np.isfinite(before) & (before == after)
    assert (before != after).any()
    np.testing.assert_array_equal(alone[unchanged], crowded[unchanged])


def test_same_seed_same_bits(ring):
    world, poses, _ = ring
    lidar = Lidar(noise_std=0.002, dropout=0.1, spurious=0.05)
    one = scan(world, poses, lidar, rng=9)
    assert one.ranges.tobytes() == scan(world, poses, lidar, rng=9).ranges.tobytes()
    assert one.ranges.tobytes() == scan(world, poses, lidar, rng=np.random.default_rng(9)).ranges.tobytes()
    assert one.ranges.tobytes() != scan(world, poses, lidar, rng=10).ranges.tobytes()
    rng = np.random.default_rng(9)
    first, second = scan(world, poses, lidar, rng=rng), scan(world, poses, lidar, rng=rng)
    assert first.ranges.tobytes() == one.ranges.tobytes()
    assert second.ranges.tobytes() != one.ranges.tobytes(), "a generator goes on: no scan repeats another's noise"


# --- Scans: block by block ----------------------------------------------------------------------------------


FAULTS = {
    "none": {},
    "noise": {"noise_std": 0.002},
    "dropout": {"dropout": 0.2},
    "spurious": {"spurious": 0.1},
    "all": {"noise_std": 0.002, "dropout": 0.2, "spurious": 0.1},
}


@pytest.mark.parametrize("size", [1, 7, 1999, 2000, 10_000])
@pytest.mark.parametrize("faults", FAULTS.values(), ids=FAULTS)
def test_blocks_together_are_the_scans_to_the_last_bit(faults, size, ring):
    world, poses, _ = ring
    poses = poses[:20] if size == 1 else poses
    whole = scan(world, poses, Lidar(**faults), rng=11)
    blocks = list(scan_blocks(world, poses, Lidar(**faults), size=size, rng=11))
    assert [len(block) for block in blocks] == [min(size, len(poses) - i) for i in range(0, len(poses), size)]
    for name in ("poses", "ranges", "inside"):
        together = np.concatenate([getattr(block, name) for block in blocks])
        assert together.tobytes() == getattr(whole, name).tobytes()
    assert all(np.array_equal(block.angles, whole.angles) for block in blocks)


@pytest.mark.parametrize("size", [1999, 2000])
def test_many_scans_are_disturbed_a_few_at_a_time(size, ring, monkeypatch):
    """Of a million scans, a table of noise beside that of ranges would double the memory."""
    world, poses, _ = ring
    lidar = Lidar(**FAULTS["all"])
    whole = scan(world, poses, lidar, rng=11).ranges
    monkeypatch.setattr(lidar_module, "SCANS_AT_ONCE", 300)
    blocks = scan_blocks(world, poses, lidar, size=size, rng=11)
    assert np.concatenate([block.ranges for block in blocks]).tobytes() == whole.tobytes()
    assert scan(world, poses, lidar, rng=11).ranges.tobytes() == whole.tobytes()


@pytest.mark.parametrize("bits", [np.random.MT19937, np.random.Philox, np.random.SFC64])
def test_blocks_from_any_generator_which_goes_on_as_after_a_scan(bits, ring):
    world, poses, _ = ring
    lidar = Lidar(**FAULTS["all"])
    one, other = (np.random.Generator(bits(12)) for _ in range(2))
    for _ in range(2):
        together = np.concatenate([block.ranges for block in scan_blocks(world, poses, lidar, size=300, rng=other)])
        assert together.tobytes() == scan(world, poses, lidar, rng=one).ranges.tobytes()


def test_a_generator_goes_on_in_the_same_way_without_faults(ring):
    world, poses, _ = ring
    one, other = np.random.default_rng(13), np.random.default_rng(13)
    scan(world, poses, Lidar(), rng=one)
    scan(world, poses, Lidar(noise_std=0.1), rng=other)
    lidar = Lidar(noise_std=0.002)
    assert scan(world, poses, lidar, rng=one).ranges.tobytes() == scan(world, poses, lidar, rng=other).ranges.tobytes()


def test_blocks_fill_the_grid_as_the_scans_do(ring):
    world, poses, exact = ring
    whole, in_blocks = Grid(), Grid()
    whole.add(exact)
    for block in scan_blocks(world, poses, size=333):
        in_blocks.add(block)
    assert np.array_equal(whole.cells, in_blocks.cells)


def test_a_block_is_computed_when_it_is_asked_for(monkeypatch, ring):
    world, poses, _ = ring
    cast, computed = lidar_module.cast, []
    monkeypatch.setattr(
        lidar_module, "cast", lambda world, some, *more: computed.append(len(some)) or cast(world, some, *more)
    )
    blocks = scan_blocks(world, poses, size=1500)
    assert computed == []
    next(blocks)
    assert computed == [1500]
    assert len(next(blocks)) == 500
    assert next(blocks, None) is None


def test_no_poses_are_one_empty_block():
    (empty,) = scan_blocks(World(), [], Lidar(beams=7))
    assert empty.ranges.shape == (0, 7)


BLOCK_FAILURES = {
    "no size": ({"size": 0}, "size must be a whole number >= 1, got 0"),
    "half a scan": ({"size": 0.5}, "size must be a whole number >= 1, got 0.5"),
    "poses": ({"poses": [(0, 0)]}, "poses must have shape (P, 3): x, y, heading; got shape (1, 2)"),
    "world": ({"world": None}, "world must be a World, as in scan_blocks(world, poses), got NoneType"),
    "lidar": ({"lidar": 3}, "lidar must be a Lidar, such as Lidar(), got int"),
    "rng": ({"rng": -1}, "rng must be a whole number >= 0 or a numpy Generator, got -1"),
}


@pytest.mark.parametrize(("change", "sentence"), BLOCK_FAILURES.values(), ids=BLOCK_FAILURES)
def test_scan_blocks_failure(change, sentence):
    """At once: not when the first block is asked for."""
    with pytest.raises(ValueError, match=exactly(sentence)):
        scan_blocks(**{"world": World(), "poses": ORIGIN, **change})


# --- Scans: the type ----------------------------------------------------------------------------------------


@pytest.fixture
def three_scans():
    poses = np.array([(0, 0, 0), (1, 2, np.pi / 2), (-1, 0, np.pi)])
    ranges = np.array([(0.5, INF), (0.25, 0.75), (INF, INF)])
    return Scans(poses, np.array([0.0, np.pi / 2]), ranges, np.array([False, False, True]))


def test_points_by_hand(three_scans):
    assert three_scans.hits.tolist() == [[True, False], [True, True], [False, False]]
    np.testing.assert_allclose(three_scans.points(), [(0.5, 0), (1, 2.25), (0.25, 2)], atol=1e-15)


def test_points_of_a_scan_lie_on_the_outlines(scenes):
    n_points = 0
    for world, poses in scenes:
        points = scan(world, poses, Lidar(range_min=0, range_max=1)).points()
        if len(points):
            distance = np.min([np.abs(s.signed_distance(points)) for s in world.shapes], axis=0)
            assert distance.max() < 1e-9
        n_points += len(points)
    assert n_points > 10_000


def test_points_far_and_near_come_pose_by_pose(scenes):
    world, poses = scenes[3]
    scans = scan(world, poses)
    parts = [scans[i].points() for i in range(len(scans))]
    np.testing.assert_array_equal(np.vstack(parts), scans.points())


INDICES = {
    "an int": (1, [1]),
    "numpy's int": (np.int64(2), [2]),
    "from the end": (-1, [2]),
    "a slice": (slice(1, 3), [1, 2]),
    "a slice of one": (slice(1, 2), [1]),
    "all": (slice(None), [0, 1, 2]),
    "backwards": (slice(None, None, -1), [2, 1, 0]),
    "none": (slice(0, 0), []),
    "a list": ([2, 0], [2, 0]),
    "an array, one twice": (np.array([1, 1, 0]), [1, 1, 0]),
    "a mask": (np.array([True, False, True]), [0, 2]),
}


@pytest.mark.parametrize(("which", "rows"), INDICES.values(), ids=INDICES)
def test_indexing(which, rows, three_scans):
    some = three_scans[which]
    assert isinstance(some, Scans)
    assert len(some) == len(rows)
    np.testing.assert_array_equal(some.poses, three_scans.poses[rows].reshape(-1, 3))
    np.testing.assert_array_equal(some.ranges, three_scans.ranges[rows].reshape(-1, 2))
    np.testing.assert_array_equal(some.inside, three_scans.inside[rows])
    np.testing.assert_array_equal(some.angles, three_scans.angles)
    assert some.points().shape == (some.hits.sum(), 2)


@pytest.mark.parametrize("which", [3, -4, [0, 3]])
def test_indexing_failure(which, three_scans):
    with pytest.raises(IndexError):
        three_scans[which]


def test_scans_one_after_the_other(three_scans):
    assert [len(one) for one in three_scans] == [1, 1, 1]
    np.testing.assert_array_equal(np.vstack([one.ranges for one in three_scans]), three_scans.ranges)


def test_one_pose_alone_and_none():
    world = random_world(4, rng=0)
    poses = teleport_poses(world)
    np.testing.assert_array_equal(scan(world, poses[3]).ranges, scan(world, poses).ranges[3:4])
    none = scan(world, [], Lidar(noise_std=0.001, dropout=0.1, spurious=0.1), rng=0)
    assert (len(none), none.ranges.shape, none.points().shape) == (0, (0, 100), (0, 2))


@settings(max_examples=40, deadline=None)
@given(st.lists(anything, min_size=1, max_size=4), seeds)
def test_any_polygons_against_geos(polygons, seed):
    """Stars, darts, Ls, combs and convex ones, of any size: the plain and the fast form see what GEOS sees."""
    rng = np.random.default_rng(seed)
    world, poses = World(polygons), np.column_stack([rng.uniform(-3, 3, (6, 2)), rng.uniform(-7, 7, 6)])
    # Half the robots stand beside an outline, where a dent may hold them.
    poses[:3, :2] = polygons[0].outline(3) + rng.normal(0, 0.05, (3, 2))
    angles = np.sort(rng.uniform(0, 2 * np.pi, 30))
    ranges = cast_rays(world, poses, angles)
    check_against_geos(world, poses, angles, ranges, length=40.0)
    assert same(cast_plainly(world, poses, angles), ranges).mean() > 0.99
    np.testing.assert_array_equal(scan(world, poses).inside, geos(world, poses, [0.0])[1])


@settings(max_examples=40, deadline=None)
@given(
    anything, st.tuples(st.floats(-3, 3), st.floats(-3, 3)), st.floats(-7, 7), st.floats(0.1, 10), st.booleans(), seeds
)
def test_any_polygon_moved_scaled_or_mirrored(polygon, offset, angle, scale, mirrored, seed):
    """Robot and polygon together: the ranges grow with the scale, and a mirror turns their order round."""
    rng = np.random.default_rng(seed)
    poses = np.column_stack([rng.uniform(-3, 3, (10, 2)), rng.uniform(-7, 7, 10)])
    away = np.abs(polygon.signed_distance(poses[:, :2]))
    before = cast_rays(World([polygon]), poses, ANGLES)
    flip = np.array([1.0, -1.0 if mirrored else 1.0])
    world = moved_world(World([Polygon(polygon.vertices * flip * scale)]), offset, angle)
    after = cast_rays(world, moved_poses(poses * [scale, scale * flip[1], flip[1]], offset, angle), ANGLES) / scale
    after = np.roll(after[:, ::-1], 1, axis=1) if mirrored else after
    alike = same(after, before, 1e-8) | np.isclose(after, before, rtol=1e-6)
    assert (~alike[away > 1e-9]).sum() <= 2, "only a beam on a knife's edge may differ"


def test_a_polygon_of_many_corners():
    """Blocks are smaller then: as many sides as ever are worked on at a time."""
    bearings = np.arange(1000) * (2 * np.pi / 1000)
    gear = Polygon(
        (0.1 + 0.01 * (np.arange(1000) % 2))[:, None] * np.column_stack([np.cos(bearings), np.sin(bearings)])
    )
    poses = random_poses(20, np.random.default_rng(40))
    ranges = cast_rays(World([gear]), poses, ANGLES)
    check_against_geos(World([gear]), poses[:8], ANGLES[::5], ranges[:8, ::5])
    np.testing.assert_array_equal(cast_rays(World([gear]), poses[7], ANGLES)[0], ranges[7])


# --- Walls --------------------------------------------------------------------------------------------------


def test_walls_by_hand():
    """They are seen from inside, up to the range; beyond them and on them, all is solid."""
    world = World([Circle((0.3, 0.25), 0.05)], walls=True)
    right_angles = [0.0, math.pi / 2, math.pi, 3 * math.pi / 2]
    ranges = cast_rays(world, [(0.125, -0.125, 0), (0.3, 0.1, 0)], right_angles)
    assert same(ranges, [[0.375, 0.625, 0.625, 0.375], [0.2, 0.1, 0.8, 0.6]]).all()
    assert same(cast_rays(world, (0.25, -0.125, 0), right_angles, 0.3), [[0.25, INF, INF, INF]]).all()
    outside = [(0.5, 0, 0), (0, -0.5, 0), (0.6, 0, math.pi), (-3, 4, 0), (0.5, 0.5, 1)]
    for cast in (cast_rays, cast_plainly):
        assert np.isinf(cast(world, outside, ANGLES)).all()
    assert scan(world, outside).inside.all()
    assert not scan(world, (0.499, 0.499, 0)).inside.any()


def test_no_beam_slips_out_between_two_walls():
    rng = np.random.default_rng(41)
    for size in (0.3, 1.0, 7.0):
        world = World(size=size, walls=True)
        poses = np.column_stack([rng.uniform(-0.49, 0.49, (40, 2)) * size, rng.uniform(-7, 7, 40)])
        poses[::4, :2] = np.sign(poses[::4, :2]) * size * 0.4999999
        for pose in poses:
            angles = np.unique(np.concatenate([ANGLES, aimed_at(world.walls[:, 0], pose)]))
            assert np.isfinite(cast_rays(world, pose, angles)).all()


def test_walls_do_not_slow_the_search_for_shapes(large_world):
    """What is near does not count the walls, which are as long as the board."""
    walled = World(large_world.shapes, large_world.size, walls=True)
    poses = random_poses(60, np.random.default_rng(42)) * (5, 5, 1)
    beside = ~scan(walled, poses).inside
    expected = np.fmin(*(cast_rays(w, poses, ANGLES, 0.5) for w in (large_world, World(size=6.0, walls=True))))
    np.testing.assert_array_equal(cast_rays(walled, poses, ANGLES, 0.5)[beside], expected[beside])
    assert beside.any()
    assert not beside.all()


def test_the_board_has_no_walls():
    """The edge of the board is invisible to the LiDAR, unless told otherwise."""
    scans = scan(World(), teleport_poses(World()))
    assert scans.ranges.shape == (77, 100)
    assert np.isinf(scans.ranges).all()
    assert not scans.inside.any()


def test_integer_poses_are_promoted():
    world = World([Circle((2, 0), 1)])
    ranges = scan(world, np.array([(0, 0, 0)]), Lidar(beams=4, range_max=2)).ranges
    assert same(ranges, [[1, INF, INF, INF]]).all()
    assert ranges.dtype == np.float64
