"""Space: solids and beams against MuJoCo and against differences; RANSAC's two ways to sample; what is found."""

import re
from types import SimpleNamespace

import numpy as np
import pytest

from primkit import space
from primkit.ransac import run_ransac, trials_needed
from primkit.space.along_beam import linearised
from primkit.space.consensus import spheres_through
from primkit.space.ends import End, end_of
from primkit.space.explanations import told_by_ends
from primkit.space.finding import Look
from primkit.space.ground import find_ground, groups
from primkit.space.lidar3d import turn_of
from primkit.space.scenes import UP
from primkit.space.solids import UNIT, altered, hit

AROUND = [
    (2.9 * np.cos(a), 2.9 * np.sin(a), z) for a, z in zip(np.arange(6), (0.4, 0.6, 0.8, 1.0, 0.5, 0.9), strict=True)
]
TILTED = space.Cylinder((0.2, 0.1, 0.6), (0.5, 0.2, 1.0), 0.2, 0.7)
TURNED = space.Box((0, 0, 0.5), np.linalg.qr(np.array([[2.0, 1, 0], [0, 1, 1], [1, 0, 3]]))[0], (0.4, 0.6, 0.8))
SOLIDS = [space.Sphere((0.1, 0, 0.5), 0.4), TILTED, TURNED]


def seen_scenes(n, first, **how):
    """Scenes whose solids all have sixty returns or more, with their clouds."""
    seed = first
    while n:
        rng = np.random.default_rng(seed)
        seed += 1
        scene = space.random_scene(int(rng.integers(1, 5)), gap=how.get("gap", 0.15), rng=rng)
        places = AROUND[: how.get("poses", 6)]
        cloud = space.scan(scene, places, space.Lidar3d(spurious=how.get("spurious", 0.0)), rng=rng)
        met = np.concatenate([scene.hit(np.array(place), cloud.turn)[1] for place in places])
        inside = any(solid.distance(np.array([place]))[0] < 0.3 for solid in scene.solids for place in places)
        if not inside and all(np.count_nonzero(met == k) >= 60 for k in range(len(scene.solids))):
            n -= 1
            yield scene, cloud


def pairs(found, scene):
    """Each solid that was found, with the true one whose middle is nearest."""
    return [(f, min(scene.solids, key=lambda s: np.linalg.norm(s.center - f.solid.center))) for f in found]


@pytest.mark.parametrize("solid", SOLIDS, ids=lambda solid: solid.kind)
def test_ranges_change_as_the_speeds_say(solid):
    origin, turn = np.array([1.9, -1.2, 0.9]), turn_of(np.linspace(-0.4, 0.2, 40), 300)
    t = hit(solid, origin, turn)
    turn, t = turn[t < np.inf], t[t < np.inf]
    normals, speeds = solid.speeds(origin + t[:, None] * turn)
    slant = (normals * turn).sum(axis=1)
    assert len(t) > 200
    assert (slant < 0).all()
    for k in range(solid.numbers):
        step = 1e-6 * np.eye(solid.numbers)[k]
        change = (hit(solid.moved(step), origin, turn) - hit(solid.moved(-step), origin, turn)) / 2e-6
        same_part = np.isfinite(change) & (np.abs(slant) > 0.1)
        off = np.abs(change - speeds[:, k] / slant)[same_part]
        assert np.quantile(off, 0.98) < 1e-5  # the others lie at an edge


@pytest.mark.parametrize(
    ("solid", "origin", "direction", "expected"),
    [
        (space.Sphere((0, 0, 0), 1), (-3, 0, 0), (1, 0, 0), 2),
        (space.Sphere((0, 0, 0), 1), (0, 0, 0), (1, 0, 0), 1),
        (space.Sphere((0, 0, 0), 1), (3, 0, 0), (1, 0, 0), np.inf),
        (space.Cylinder((0, 0, 0), (0, 0, 1), 1, 2), (0, 0, 5), (0, 0, -1), 4),
        (space.Cylinder((0, 0, 0), (0, 0, 1), 1, 2), (2, 0, 5), (0, 0, -1), np.inf),
        (space.Cylinder((0, 0, 0), (0, 0, 1), 1, 2), (0, 0, 0), (0, 0, -1), 1),
        (space.Cylinder((0, 0, 0), (0, 0, 1), 1, 2), (-3, 0, 0), (1, 0, 0), 2),
        (space.Cylinder((0, 0, 0), (0, 0, 1), 1, 2), (-3, 0, 2), (1, 0, 0), np.inf),
        (space.Box((0, 0, 0), np.eye(3), (2, 2, 2)), (-3, 0, 0), (1, 0, 0), 2),
        (space.Box((0, 0, 0), np.eye(3), (2, 2, 2)), (-3, 1, 0), (1, 0, 0), 2),
        (space.Box((0, 0, 0), np.eye(3), (2, 2, 2)), (-3, 1.1, 0), (1, 0, 0), np.inf),
        (space.Box((0, 0, 0), np.eye(3), (2, 2, 2)), (0, 0, 0), (0, 1, 0), 1),
    ],
    ids=str,
)
def test_beams_that_are_special(solid, origin, direction, expected):
    assert hit(solid, origin, [direction]).item() == expected


def test_rays_meet_what_they_meet_in_mujoco():
    mujoco = pytest.importorskip("mujoco", reason="mujoco, the independent simulator, is not installed")
    from tests.benchmarks.in_space import differing_rays

    assert mujoco
    worst, differing, cast = differing_rays(n_scenes=3, rays=2000, seed=5)
    assert cast == 6000
    assert worst < 1e-9
    assert differing == 0


def test_one_random_point_and_its_nearest_need_fewer_trials():
    rng = np.random.default_rng(1)
    ball = rng.normal(size=(300, 3))
    ball = 0.4 * ball / np.linalg.norm(ball, axis=1)[:, None] + rng.normal(0, 0.002, (300, 3))
    points = np.vstack([ball, rng.uniform(-2, 2, (900, 3))])
    found = dict.fromkeys(("plain", "nearest"), 0)
    for seed in range(20):
        for name, model in (("plain", space.SPHERE), ("nearest", space.with_nearest(points, space.SPHERE, 60))):
            result = run_ransac(points, model, 0.01, trials=20, rng=seed)
            found[name] += result is not None and abs(result.params[3] - 0.4) < 0.01
    assert trials_needed(0.25, 4) == 1177
    assert found["plain"] <= 2
    assert found["nearest"] >= 15


def test_a_small_patch_does_not_pull_the_sphere_small():
    """Thirty points of a ball of 35 cm, on a patch that bulges by 1 to 2 cm, with 5 mm of noise: Coope says 16 cm."""
    rng = np.random.default_rng(4)
    ways = np.concatenate([rng.uniform(-0.25, 0.25, (400, 30, 2)), np.ones((400, 30, 1))], axis=2)
    ways /= np.linalg.norm(ways, axis=2, keepdims=True)
    patches = 0.35 * ways + rng.normal(0, 0.005, ways.shape)
    assert np.median(spheres_through(patches)[:, 3]) == pytest.approx(0.35, rel=0.1)


def test_cylinders_and_planes_on_the_one_loop():
    rng = np.random.default_rng(2)
    angle, along = rng.uniform(0, 2 * np.pi, 400), rng.uniform(-0.5, 0.5, 400)
    tube = np.column_stack([0.3 * np.cos(angle), 0.3 * np.sin(angle), along])
    points = np.vstack([tube, rng.uniform(-1, 1, (100, 3))])
    found = run_ransac(points, space.with_nearest(points, space.CYLINDER, 60), 0.01, trials=50, rng=0)
    assert abs(found.params[5]) > 0.999
    assert found.params[6] == pytest.approx(0.3, abs=0.01)
    floor = np.column_stack([rng.uniform(-1, 1, (200, 2)), np.full(200, 0.25)])
    found = run_ransac(np.vstack([floor, points]), space.PLANE, 0.001, trials=100, rng=0)
    assert abs(found.params[3]) == pytest.approx(0.25)


HOWS = {
    "six places": (8, {}),
    "spurious returns": (4, {"spurious": 0.05}),
    "gaps of 5 cm": (4, {"gap": 0.05}),
    "two places": (4, {"poses": 2}),
}


@pytest.mark.parametrize("how", HOWS, ids=str)
def test_kinds_are_right_and_intervals_hold(how):
    n, settings = HOWS[how]
    outside, told = 0, 0
    for scene, cloud in seen_scenes(n, 100, **settings):
        found = space.find_solids(cloud, rng=0)
        assert len(found) == len(scene.solids)
        for f, true in pairs(found, scene):
            assert f.kind == true.kind
            assert f.certain
            assert (f.turn_std == 0) == (f.kind == "sphere")
            assert f.turn_std < 0.05
            sizes = 2 * true.half if f.kind == "box" else [true.half[0], 2 * true.half[2]]
            if f.kind == "box":  # by the axes that lie along each other
                sizes = sizes[np.abs(f.solid.frame @ true.frame.T).argmax(axis=1)]
            for (low, high), size in zip(f.between.values(), sizes, strict=False):
                told, outside = told + 1, outside + (not low <= size <= high)
    assert outside <= 0.05 * told + 1


def test_a_top_that_no_beam_reaches_is_open_upwards_of_the_last_hit():
    """The sensor looks at the foot of a tall post: where it ends is not seen, and no number is made up for it."""
    post = space.Cylinder((1.5, 0, 3.0), (0, 0, 1), 0.2, 6.0)
    found = space.find_solids(space.scan(space.Scene([post]), [(0, 0, 0.8), (1.5, 2.0, 0.8)], rng=0), rng=0)[0]
    assert found.kind == "cylinder"
    assert "height" in found.open
    assert found.between["height"][1] == np.inf
    assert "radius" not in found.open


def test_misses_alone_bound_a_height():
    """Beams pass close above the post, and none hits its top: the height is known by who passed."""
    post = space.Cylinder((2.0, 0, 0.35), (0, 0, 1), 0.2, 0.7)
    cloud = space.scan(space.Scene([post]), [(0, 0, 0.6), (2, 2.2, 0.4)], space.Lidar3d(layers=64), rng=0)
    found = space.find_solids(cloud, rng=0)[0]
    low, high = found.between["height"]
    assert low <= 0.7 <= high
    assert high - low < 0.05
    look = Look(cloud, 0.005, None, np.random.default_rng(0))
    members = groups(cloud, find_ground(cloud, rng=0))[0]
    own = look.beams(members, members)  # the same returns, but nobody says what was missed
    assert end_of(post, 6, own, None).unbounded
    assert not end_of(post, 6, look.around(members), None).unbounded


def test_ranges_want_nothing_where_an_end_has_left_them():
    """They err by 0.05 mm: an end that moves by as much they pull back, one that moves by 3 mm they do not."""
    by_ranges = np.full(7, 1 / 5e-5**2)
    for growth, pulled in ((5e-5, True), (3e-3, False)):
        _, vector = told_by_ends({6: End(growth, 2e-5, (0, 0.01), np.eye(7)[6])}, by_ranges)
        assert (vector[6] > 0) == pulled


def test_where_ranges_tell_more_hits_and_misses_count_as_nothing():
    """The end of a face that is seen: what its edges add to ranges of 0.05 mm made boxes' sides look too well known."""
    by_ranges = np.full(7, 1 / 5e-5**2)
    for std, told in ((2e-5, True), (4e-5, False)):
        matrix, _ = told_by_ends({6: End(5e-5, std, (0, 0.01), np.eye(7)[6])}, by_ranges)
        assert (matrix[6, 6] > 0) == told


def test_a_leaning_post_stands_on_the_ground_and_not_in_it():
    """Its foot is a rim, and its axis nearly level: an end that moves along it mends nothing, all numbers must."""
    for turned in (1.0, 4.0, 5.0):
        axis = np.cos(turned), np.sin(turned), 0.2
        post = space.Cylinder((0, 0, 1), axis, 0.25, 0.7)
        post = altered(post, center=np.array([0, 0, post.reach(UP)]))
        (found,) = space.find_solids(space.scan(space.Scene([post]), AROUND[:2], rng=1), rng=0)
        assert found.solid.center[2] - found.solid.reach(UP) == pytest.approx(0, abs=1e-4)


def test_what_has_grown_is_asked_again(monkeypatch):
    """The two in the middle touch nothing until the one between has joined the largest."""

    def touching(_, one, other):
        near = min(abs(a - b) for a in one.members for b in other.members) == 1
        return SimpleNamespace(members=one.members + other.members) if near else None

    monkeypatch.setattr(Look, "as_one", touching)
    parts = [SimpleNamespace(members=members) for members in ([5, 6, 7], [2, 3], [4])]
    (one,) = Look(None, 0.005, None, None).joined(parts)
    assert sorted(one.members) == [2, 3, 4, 5, 6, 7]


def test_a_scene_without_a_ground_in_sight():
    ball = space.Sphere((2, 0, 3.0), 0.4)
    cloud = space.scan(space.Scene([ball]), [(0, 0, 3.0), (4, 0.5, 3.2)], space.Lidar3d(range_max=5.0), rng=0)
    (found,) = space.find_solids(cloud, rng=0)
    assert found.kind == "sphere"
    assert found.sizes["radius"] == pytest.approx(0.4, abs=0.01)


def test_the_same_seed_gives_the_same_solids_wherever_the_scene_is():
    (scene, cloud), *_ = seen_scenes(1, 100)
    first, again = space.find_solids(cloud, rng=3), space.find_solids(cloud, rng=3)
    assert repr(first) == repr(again)
    by = np.array([40.0, -30.0, 0.0])
    moved = space.find_solids(space.Cloud(cloud.origins + by, cloud.elevations, cloud.ranges), rng=3)
    for a, b in zip(first, moved, strict=True):
        assert np.allclose(a.solid.center + by, b.solid.center, atol=1e-4)
    assert np.allclose(altered(scene.solids[0], center=scene.solids[0].center + by).center, scene.solids[0].center + by)


def test_weights_forget_returns_from_nowhere():
    ball = space.Sphere((2, 0, 0), 0.5)
    cloud = space.scan(space.Scene([ball]), [(0, 0, 1.0)], space.Lidar3d(noise_std=0.0), rng=0)
    met = np.flatnonzero(hit(ball, (0, 0, 1.0), cloud.turn) < np.inf)
    own = Look(cloud, 0.005, None, np.random.default_rng(0)).beams(met, met)
    own.ranges[0] -= 0.3
    weights, gap, _ = linearised(ball, own)
    assert weights[0] < 1e-6
    assert gap[0] == pytest.approx(-0.3)
    assert np.median(weights) > 0.99


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: space.Sphere((0, 0), 1), "center must be three finite numbers (x, y, z), got (0, 0)"),
        (lambda: space.Sphere((0, 0, 0), 0), "radius must be a finite number > 0, got 0"),
        (lambda: space.Cylinder((0, 0, 0), (0, 0, 0), 1, 1), "axis must be longer than 0, got [0.0, 0.0, 0.0]"),
        (
            lambda: space.Box((0, 0, 0), 2 * np.eye(3), (1, 1, 1)),
            "frame must be three unit vectors at right angles, got [[2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0]]",
        ),
        (lambda: space.Lidar3d(fov=30), "fov must be less than pi, got 30; is it in degrees?"),
        (lambda: space.Scene([3]), "solids must be Sphere, Cylinder or Box, got int"),
        (lambda: space.scan(3, [(0, 0, 1)]), "scene must be a Scene, got int"),
        (
            lambda: space.Cloud([(0, 0, 1)], [0.0], np.zeros((1, 1, 4))),
            "ranges must be > 0, or inf for no return, got 0",
        ),
        (
            lambda: space.Cloud([(0, 0, 1)], [0.0, 0.1], np.ones((1, 1, 4))),
            "ranges must have shape (P, L, A), got (1, 1, 4) for 1 origins and elevations of shape (2,)",
        ),
        (lambda: space.find_solids([(0, 0, 0)]), "cloud must be a Cloud, of beams and not of points alone, got list"),
        (lambda: space.with_nearest(np.zeros((9, 3)), space.SPHERE, 2), "k must be a whole number >= 3, got 2"),
        (lambda: space.random_scene(60, half=1, rng=0), "a scene must have room: tried 2,000 places, got 2,001"),
    ],
)
def test_a_wrong_argument_is_refused_in_one_sentence(call, message):
    with pytest.raises(ValueError, match="^" + re.escape(message)):
        call()


def test_directions_are_unit_vectors():
    assert np.allclose(np.linalg.norm(turn_of(np.linspace(-1, 1, 5), 7), axis=1), 1, atol=UNIT)


def test_what_was_found_is_written_and_read_back():
    (_, cloud), *_ = seen_scenes(1, 100)
    found = space.find_solids(cloud, rng=0)
    back = space.from_json(space.as_json(found)).solids
    assert space.as_json(back) == space.as_json(f.solid for f in found)
    assert all(f.center.tolist() == b.center.tolist() for f, b in zip((f.solid for f in found), back, strict=True))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", "solids must be valid JSON, got '{'"),
        ("[]", 'solids must have "format": "primkit solids", "version": 1, got []'),
        (
            space.as_json([space.Sphere((0, 0, 0), 1)]).replace("1.0", "-1"),
            "solid 0: radius must be a finite number > 0, got -1",
        ),
    ],
)
def test_a_text_that_tells_of_no_solids_is_refused(text, message):
    with pytest.raises(ValueError, match="^" + re.escape(message)):
        space.from_json(text)


def test_a_picture_shows_each_solid_and_no_picture_is_empty():
    assert "3 solids and no points" in space.view(SOLIDS)
    assert "no solids and 2 points" in space.view((), [(0, 0, 0), (1, 1, 1)], azimuth=1.0, elevation=0.2)


def test_a_quarter_of_a_cylinder_is_found_among_outliers():
    rng = np.random.default_rng(3)
    off = []
    for seed in range(5):
        angle, radius = rng.uniform(0, np.pi / 2, 900), 1 + rng.normal(0, 0.01, 900)
        tube = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), rng.uniform(0, 3, 900)])
        points = np.vstack([tube, rng.uniform((-1, -1, 0), (1, 1, 3), (100, 3))])
        off.append(space.solid_through(points, space.CYLINDER, 0.01, rng=seed).radius - 1)
    assert np.abs(off).mean() < 0.006  # the limit is 0.0027; with the outliers on the far side it was 0.008 and more
