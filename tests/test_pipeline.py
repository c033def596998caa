"""find_shapes as a whole: invariances, edge cases, exact messages, both settings."""

from dataclasses import replace

import numpy as np
import pytest

import primkit as pk
from primkit.arguments import LikelyWrong
from primkit.pipeline import _explain_all
from primkit.robust.choice import explained
from primkit.robust.scatter import spread_of


def points_of(world, rng=0, **sensor):
    grid = pk.Grid()
    grid.add(pk.scan(world, pk.teleport_poses(world), pk.Lidar(**sensor), rng=rng))
    return grid.points()


def same(a, b):
    return [d.shape for d in a] == [d.shape for d in b]


def test_the_order_of_the_points_does_not_matter_to_the_last_bit():
    points = points_of(pk.random_world(4, rng=3))
    shuffled = np.random.default_rng(0).permutation(points)
    assert same(pk.find_shapes(points, rng=0), pk.find_shapes(shuffled, rng=0))
    few = replace(pk.PAPER, line_trials=200)
    assert same(
        pk.find_shapes(points, 4, settings=few, rng=0),
        pk.find_shapes(shuffled, 4, settings=few, rng=0),
    )


def test_a_shape_does_not_change_when_others_are_added():
    """Each group is measured with the same seed: what happens elsewhere on the board leaves no trace."""
    one = pk.World([pk.Circle((-0.2, -0.2), 0.07)])
    two = pk.World([*one.shapes, pk.Polygon([(0.1, 0.1), (0.3, 0.1), (0.3, 0.25)])])
    alone, both = (pk.find_shapes(points_of(w), rng=0) for w in (one, two))
    np.testing.assert_allclose(alone[0].shape.center, both[0].shape.center, atol=1e-9)


def test_found_shapes_come_from_left_to_right():
    found = pk.find_shapes(points_of(pk.random_world(4, rng=11)), rng=0)
    assert [d.shape.centroid[0] for d in found] == sorted(d.shape.centroid[0] for d in found)


@pytest.mark.parametrize("n", [1, 2, 3, 4])
def test_a_given_number_of_shapes_is_used(n):
    world = pk.random_world(4, kinds=["circle"] * 4, rng=2)
    assert len(pk.find_shapes(points_of(world), n, rng=0)) <= n
    assert len(pk.find_shapes(points_of(world), 4, rng=0)) == 4


@pytest.mark.parametrize("n", [1, 3])
def test_a_given_number_counts_no_walls(n):
    world = pk.random_world(n, walls=True, rng=n)
    found = pk.find_shapes(points_of(world), n, rng=0)
    assert (len(found), len(found.walls)) == (n, 4)
    assert pk.evaluate(found, world).weighted_accuracy == 1.0


def test_two_pieces_that_pass_for_walls_are_one_rectangle_when_one_shape_is_told():
    box = pk.Polygon([(0, 0), (0.2, 0), (0.2, 0.1), (0, 0.1)]).outline(400)
    pieces = box[(box[:, 1] < 0.001) | (box[:, 1] > 0.099)]
    (one,) = pk.find_shapes(pieces, 1, settings=pk.Settings(second_opinion=False), rng=0)
    assert one.kind == "rectangle"


def test_where_no_shape_is_asked_for_all_points_are_strays():
    points = points_of(pk.random_world(1, rng=0))
    assert len(pk.find_shapes(points, 0, rng=0).strays) == len(points)


def test_strays_are_left_out():
    world = pk.random_world(3, rng=5)
    clean, dirty = points_of(world), points_of(world, spurious=0.03)
    assert len(dirty) > len(clean) + 100
    report = pk.evaluate(pk.find_shapes(dirty, rng=0), world)
    assert report.weighted_accuracy == 1.0, str(report)
    spread = max(d.rms for d in pk.find_shapes(dirty, rng=0))
    assert spread < 0.001


def test_the_noise_may_be_told():
    world = pk.random_world(4, rng=6)
    points = points_of(world, noise_std=0.003)
    told = pk.find_shapes(points, settings=pk.Settings(noise_std=0.003), rng=0)
    found = pk.find_shapes(points, rng=0)
    for detections in (told, found):
        assert pk.evaluate(detections, world, 0.006).weighted_accuracy > 0.95


def test_e17_noise_that_the_points_contradict_is_not_believed():
    """Told 0.1 mm where it is 5 mm, 4 shapes became 10 to 16; now it is as if nothing had been told, and said so."""
    points = points_of(pk.random_world(4, rng=6), noise_std=0.005)
    with pytest.warns(LikelyWrong, match=r"^noise_std is contradicted by the points, which scatter [5-9]\.\d times"):
        told = pk.find_shapes(points, settings=pk.Settings(noise_std=0.0001), rng=0)
    found = pk.find_shapes(points, rng=0)
    assert [one.shape for one in told] == [one.shape for one in found]
    assert len(found) == 4
    for one, other in zip(told, found, strict=True):
        np.testing.assert_allclose(one.center_std, other.center_std, rtol=0.01)


@pytest.mark.parametrize("noise_std", [0.0, 0.001, 0.005, 0.01])
def test_noise_that_is_told_rightly_is_believed_in_silence(noise_std):
    """Warnings are errors here."""
    for seed in range(3):
        points = points_of(pk.random_world(3, style="free", rng=seed), noise_std=noise_std)
        assert pk.find_shapes(points, settings=pk.Settings(noise_std=noise_std), rng=0)


NOTHING = {
    "no points": [],
    "one point": [(0.1, 0.1)],
    "scattered points": np.random.default_rng(0).uniform(-0.5, 0.5, (40, 2)),
    "a single straight wall": np.column_stack([np.linspace(0, 0.3, 100), np.full(100, 0.1)]),
    "all points equal": [(0.1, 0.1)] * 30,
}


@pytest.mark.parametrize("points", NOTHING.values(), ids=NOTHING)
def test_nothing_there_is_an_empty_list(points):
    assert pk.find_shapes(points, rng=0) == []


def test_no_shape_asked_for_is_an_empty_list():
    assert pk.find_shapes([(0, 0)], 0) == []
    assert pk.find_shapes([], 0, settings=pk.PAPER) == []


def test_an_empty_grid_has_no_shapes():
    assert pk.find_shapes(pk.Grid().points()) == []


FAILURES = {
    "NaN": (lambda: pk.find_shapes([(0.0, float("nan"))]), "points must be finite, got (0.0, nan) in row 0"),
    "infinite": (lambda: pk.find_shapes([(0, 0), (np.inf, 0)]), "points must be finite, got (inf, 0.0) in row 1"),
    "three columns": (lambda: pk.find_shapes(np.zeros((5, 3))), "points must have shape (N, 2), got shape (5, 3)"),
    "text": (lambda: pk.find_shapes("abc"), "points must be numbers in an array of shape (N, 2), got 'abc'"),
    "more shapes than points": (
        lambda: pk.find_shapes([(0, 0), (1, 1)], 3),
        "n_shapes must be at most the number of different points, got 3 for 2",
    ),
    "shapes from an empty grid": (
        lambda: pk.find_shapes(pk.Grid().points(), 4),
        "n_shapes must be at most the number of different points, got 4 for 0",
    ),
    "half a shape": (lambda: pk.find_shapes([(0, 0)], 0.5), "n_shapes must be a whole number >= 0, got 0.5"),
    "a negative number": (lambda: pk.find_shapes([(0, 0)], -1), "n_shapes must be a whole number >= 0, got -1"),
    "an unknown method": (
        lambda: pk.Settings(method="magic"),
        'method must be "joint" or "published", got \'magic\'',
    ),
    "an unknown grouping": (
        lambda: pk.Settings(grouping="magic"),
        'grouping must be "link" or "kmeans", got \'magic\'',
    ),
    "negative noise": (lambda: pk.Settings(noise_std=-1), "noise_std must be a finite number >= 0, got -1"),
    "scans": (
        lambda: pk.find_shapes(pk.scan(pk.World([]), [(0, 0, 0)], pk.Lidar())),
        "points must be an (N, 2) array, got a Scans; did you mean its points()?",
    ),
    "settings by name": (
        lambda: pk.find_shapes([(0, 0)], settings="paper"),
        "settings must be ROBUST, PAPER or Settings of your own, got str",
    ),
    "a text as seed": (
        lambda: pk.find_shapes([(0, 0)], rng="7"),
        "rng must be a whole number >= 0 or a numpy Generator, got '7'",
    ),
    "evaluate turned round": (
        lambda: pk.evaluate(pk.World(), []),
        "world must be a World, as in evaluate(found, world), got list",
    ),
    "one detection alone": (
        lambda: pk.evaluate(pk.Circle((0, 0), 1), pk.World()),
        "found must be a list of detections or shapes, as in evaluate(found, world), got Circle",
    ),
    "scan turned round": (
        lambda: pk.scan([(0, 0, 0)], pk.World()),
        "world must be a World, as in scan(world, poses), got list",
    ),
    "the class of the sensor": (
        lambda: pk.scan(pk.World(), [(0, 0, 0)], pk.Lidar),
        "lidar must be a Lidar, such as Lidar(), got type",
    ),
    "way-points of a grid": (lambda: pk.teleport_poses(pk.Grid()), "world must be a World, got Grid"),
    "a model by name": (
        lambda: pk.run_ransac([(0, 0)], "line", 0.1),
        "model must be a Model, such as lines.LINE, got str",
    ),
    "kinds as a text": (
        lambda: pk.random_world(1, kinds="circle"),
        "kinds must be a list of kinds, such as ['circle'], got the text 'circle'",
    ),
    "a number with linking": (
        lambda: pk.segment([(0, 0)] * 9 + [(1, 1)], 2, method="link"),
        'n_shapes must be None with method "link", which finds the number itself, got 2',
    ),
    "an unknown name": (lambda: pk.find_shape, "No primkit attribute find_shape"),
}


@pytest.mark.parametrize(("call", "message"), FAILURES.values(), ids=FAILURES)
def test_failure(call, message):
    with pytest.raises((ValueError, AttributeError)) as error:
        call()
    assert str(error.value) == message


def test_the_paper_finds_the_number_by_silhouette_when_it_is_not_told():
    world = pk.World([pk.Circle((-0.25, -0.25), 0.06), pk.Circle((0.25, 0.25), 0.06)])
    few = replace(pk.PAPER, line_trials=300)
    assert len(pk.find_shapes(points_of(world), settings=few, rng=0)) == 2


def test_the_count_is_unsure_where_the_pieces_cannot_say():
    """Two far pieces of one circle: one shape, but two would do as well; two whole circles leave no doubt."""
    ring = pk.Circle((0, 0), 0.08).outline(160)
    pieces = np.vstack([ring[:60], ring[80:140]])
    (one,) = pk.find_shapes(pieces, rng=0)
    assert one.kind == "circle"
    assert 0 < one.count_margin < 100
    whole = pk.find_shapes(np.vstack([ring, ring + np.array([0.3, 0.0])]), rng=0)
    assert [d.count_margin for d in whole] == [float("inf")] * 2


def test_each_remedy_can_be_switched_on_alone():
    """Linking mends K-Means on a long thin rectangle beside a small circle."""
    thin = pk.Polygon([(-0.3, 0.0), (0.0, 0.0), (0.0, 0.06), (-0.3, 0.06)])
    world = pk.World([thin, pk.Circle((0.09, 0.03), 0.04)])
    points = points_of(world)
    plain = pk.Settings(grouping="kmeans", second_opinion=False)
    linked = pk.Settings(second_opinion=False)
    assert pk.evaluate(pk.find_shapes(points, 2, settings=plain, rng=0), world).weighted_accuracy < 0.9
    assert pk.evaluate(pk.find_shapes(points, 2, settings=linked, rng=0), world).weighted_accuracy == 1.0


def test_much_noise_is_found_from_the_fits():
    """Neighbours alone underestimate 10 mm by a third; the fits to the groups mend it."""
    world = pk.random_world(4, kinds=["circle", "rectangle", "rectangle", "triangle"], rng=3)
    points = points_of(world, noise_std=0.01)
    distance = np.min([np.abs(s.signed_distance(points)) for s in world.shapes], axis=0)
    true = 1.4826 * np.median(distance)
    together = [points[pk.link(points) == label] for label in range(4)]
    _, spread = _explain_all(together, pk.ROBUST, None, explained)
    assert spread_of(points) < 0.8 * true
    assert spread == pytest.approx(true, rel=0.15)


def test_many_equal_points_and_a_few_others():
    """Nearly every sample of RANSAC is one point twice; that is no reason to fail."""
    points = np.vstack([np.full((20_000, 2), 0.1), np.random.default_rng(0).uniform(0.09, 0.11, (11, 2))])
    assert pk.find_shapes(points, rng=0) == []


@pytest.mark.parametrize("n", [1, 2, 3])
def test_a_given_number_is_kept_to_without_a_second_opinion_too(n):
    world = pk.random_world(3, kinds=["circle"] * 3, rng=2)
    settings = replace(pk.ROBUST, second_opinion=False)
    assert len(pk.find_shapes(points_of(world), n, settings=settings, rng=0)) <= n


@pytest.mark.parametrize("grid", [pk.Grid(0.01), pk.MovingGrid(0.01)], ids=["Grid", "MovingGrid"])
def test_a_grid_tells_the_side_of_its_cells(grid):
    world = pk.World([pk.Circle((0.3, -0.2), 0.6)], size=10)
    grid.add(pk.scan(world, pk.teleport_poses(world), pk.Lidar(range_min=0.5, range_max=3), rng=0))
    (found,) = pk.find_shapes(grid, rng=0)
    assert found.shape.radius == pytest.approx(0.6, abs=0.005)
