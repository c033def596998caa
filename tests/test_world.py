"""Random boards: what stands on them, and how far apart, judged by shapely."""

import dataclasses
import pickle
from itertools import combinations

import numpy as np
import pytest
import shapely

from primkit.random_shapes import SORTS
from primkit.shapes import PRIMITIVES, Circle, Polygon
from primkit.world import World, gap_between, random_world
from tests.helpers import exactly

NAN, INF = float("nan"), float("inf")

LIMIT = 0.38  # nothing reaches farther from the middle of a board of 1 m
# The paper's pentagon, in units of its "radius".
PENTAGON = np.array([(0, -1), (0.9, -0.3), (0.5, 0.8), (-0.5, 0.8), (-0.91, -0.3)])
SLACK = 1e-12  # what rounding may take from a limit


def outer(shape):
    """A shapely polygon that holds the shape: a circle's sides touch it from outside."""
    if isinstance(shape, Polygon):
        return shapely.Polygon(shape.vertices)
    return shapely.Point(shape.center).buffer(shape.radius / np.cos(np.pi / 1024), quad_segs=256)


# A circle of 10 cm, drawn with 1024 sides from outside, is at most this much too large [m].
OUTER_ERROR = 0.1 * (1 / np.cos(np.pi / 1024) ** 2 - 1)


# --- World --------------------------------------------------------------------------------------------------

DISC, FAR_DISC = Circle((0, 0), 0.1), Circle((0.3, 0.4), 0.1)
BOX = Polygon([(0.2, -0.1), (0.4, -0.1), (0.4, 0.1), (0.2, 0.1)])


def test_world_holds_what_it_is_given():
    world = World([DISC, BOX], 2)
    assert world.shapes == (DISC, BOX)
    assert (world.size, type(world.size)) == (2.0, float)
    assert (World().shapes, World().size) == ((), 1.0)
    assert World(shape for shape in (BOX, DISC)).shapes == (BOX, DISC)


def test_a_world_cannot_be_changed():
    world = World([DISC])
    with pytest.raises(dataclasses.FrozenInstanceError):
        world.shapes = ()
    with pytest.raises(dataclasses.FrozenInstanceError):
        world.size = 2.0


def test_worlds_are_equal_when_their_shapes_and_sizes_are():
    same = World([Circle((-0.0, 0), 0.1), Polygon(BOX.vertices)])
    assert same == World([DISC, BOX])
    assert hash(same) == hash(World([DISC, BOX]))
    others = [World([BOX, DISC]), World([DISC]), World([DISC, BOX], 2), World(), World([DISC, BOX], walls=True)]
    assert len({same, World([DISC, BOX]), *others}) == 6


def test_walls_stand_on_the_edge_of_the_board():
    """Four, counter-clockwise from the lower left; none unless asked for. The world says so when it is printed."""
    walls = World(size=3, walls=True).walls.tolist()
    assert walls == [
        [[-1.5, -1.5], [1.5, -1.5]],
        [[1.5, -1.5], [1.5, 1.5]],
        [[1.5, 1.5], [-1.5, 1.5]],
        [[-1.5, 1.5], [-1.5, -1.5]],
    ]
    assert World().walls.shape == (0, 2, 2)
    assert (World().walled, World(walls=True).walled, World(walls=np.True_).walled) == (False, True, True)
    assert repr(World(walls=True)) == "World: 1 m x 1 m with walls, no shapes"
    assert repr(World()) == "World: 1 m x 1 m, no shapes"
    assert pickle.loads(pickle.dumps(World([BOX], 2, walls=True))) == World([BOX], 2, walls=True)
    assert random_world(2, walls=True, rng=5) == World(random_world(2, rng=5).shapes, walls=True)


WORLD_FAILURES = {
    "one shape, not in a list": (
        (DISC,),
        "a world's shapes must be a list of Circle and Polygon, got Circle(center=(0, 0), radius=0.1)",
    ),
    "None": ((None,), "a world's shapes must be a list of Circle and Polygon, got None"),
    "a number": ((3,), "a world's shapes must be a list of Circle and Polygon, got 3"),
    "a kind for a shape": ((["circle"],), "a world's shapes must be Circle or Polygon, got str"),
    "None among shapes": (([DISC, None],), "a world's shapes must be Circle or Polygon, got NoneType"),
    "corners for a shape": (([BOX.vertices],), "a world's shapes must be Circle or Polygon, got ndarray"),
    "a shapely shape": (([shapely.Point(0, 0)],), "a world's shapes must be Circle or Polygon, got Point"),
    "the class for its shape": (([Circle],), "a world's shapes must be Circle or Polygon, got type"),
    "size zero": (([], 0), "size must be a finite number > 0, got 0"),
    "size negative": (([], -1.5), "size must be a finite number > 0, got -1.5"),
    "size NaN": (([], NAN), "size must be a finite number > 0, got nan"),
    "size infinite": (([], INF), "size must be a finite number > 0, got inf"),
    "size is text": (([], "1"), "size must be a finite number > 0, got '1'"),
    "size None": (([], None), "size must be a finite number > 0, got None"),
    "size is a truth value": (([], True), "size must be a finite number > 0, got True"),
}


@pytest.mark.parametrize("walls", [1, "yes", None, np.ones((4, 2, 2))])
def test_world_walls_failure(walls):
    for make in (World, lambda walls: random_world(0, walls=walls)):
        with pytest.raises(ValueError, match=exactly(f"walls must be True or False, got {type(walls).__name__}")):
            make(walls=walls)


@pytest.mark.parametrize(("arguments", "sentence"), WORLD_FAILURES.values(), ids=WORLD_FAILURES)
def test_world_failure(arguments, sentence):
    with pytest.raises(ValueError, match=exactly(sentence)):
        World(*arguments)


# --- Gaps ---------------------------------------------------------------------------------------------------

GAPS = {
    "two circles, 3-4-5": (DISC, FAR_DISC, 0.3),
    "two circles that touch": (DISC, Circle((0.25, 0), 0.15), 0.0),
    "two circles that overlap": (DISC, Circle((0.15, 0), 0.1), -0.05),
    "a circle in a circle": (DISC, Circle((0, 0), 0.05), -0.15),
    "circle and side": (DISC, BOX, 0.1),
    "circle and corner, 3-4-5": (Circle((0.7, 0.5), 0.1), BOX, 0.4),
    "circle in a box": (Circle((0.3, 0), 0.02), BOX, -0.02),
    "two boxes": (BOX, BOX.moved((0.5, 0)), 0.3),
    "two boxes, corner to corner": (BOX, BOX.moved((0.5, 0.6)), 0.5),
    "two boxes that touch": (BOX, BOX.moved((0.2, 0)), 0.0),
    "two boxes that overlap": (BOX, BOX.moved((0.1, 0)), 0.0),
}


@pytest.mark.parametrize(("one", "other", "gap"), GAPS.values(), ids=GAPS)
def test_gap_between(one, other, gap):
    assert gap_between(one, other) == pytest.approx(gap, abs=1e-15)
    assert gap_between(other, one) == gap_between(one, other)


LEAST_GAPS = {
    "empty": ([], INF),
    "one shape": ([DISC], INF),
    "two shapes": ([DISC, FAR_DISC], 0.3),
    "the least of three, in the middle": ([FAR_DISC, DISC, BOX], 0.1),
    "two that overlap, apart from one that does not": ([FAR_DISC, DISC, Circle((0, 0.15), 0.1)], -0.05),
}


@pytest.mark.filterwarnings("ignore::primkit.arguments.LikelyWrong")
@pytest.mark.parametrize(("shapes", "gap"), LEAST_GAPS.values(), ids=LEAST_GAPS)
def test_least_gap(shapes, gap):
    assert World(shapes).least_gap() == pytest.approx(gap)


# --- Random worlds: the paper's ------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def paper_worlds():
    """400 boards, 100 of each number of shapes."""
    return [random_world(n, rng=100 * n + seed) for n in (1, 2, 3, 4) for seed in range(100)]


@pytest.fixture(scope="module")
def free_worlds():
    """360 boards in free style, with one to six shapes."""
    return [random_world(n, style="free", rng=100 * n + seed) for n in range(1, 7) for seed in range(60)]


def shapes_of(worlds, kind):
    return [shape for world in worlds for shape in world.shapes if shape.kind == kind]


def base_middle(shape):
    """What the published code calls a shape's centre: for a triangle the middle of its base."""
    if shape.kind == "circle":
        return shape.center
    if shape.kind == "triangle":
        return shape.vertices[shape.vertices[:, 1] < shape.vertices[:, 1].max()].mean(axis=0)
    if shape.kind == "rectangle":
        return shape.vertices.mean(axis=0)
    low, high = shape.vertices[:, 1].min(), shape.vertices[:, 1].max()
    bottom = shape.vertices[np.argmin(shape.vertices[:, 1])]
    return np.array([bottom[0], low + (high - low) / 1.8])


def test_paper_worlds_have_the_number_asked_for(paper_worlds):
    assert [len(world.shapes) for world in paper_worlds] == np.repeat([1, 2, 3, 4], 100).tolist()
    assert {world.size for world in paper_worlds} == {1.0}


@pytest.mark.parametrize("style", ["paper", "free"])
def test_all_kinds_are_drawn_evenly(style, paper_worlds, free_worlds):
    shapes = [shape.kind for world in {"paper": paper_worlds, "free": free_worlds}[style] for shape in world.shapes]
    expected, spread = len(shapes) / 4, np.sqrt(len(shapes) * 0.25 * 0.75)
    for kind in PRIMITIVES:
        assert abs(shapes.count(kind) - expected) < 4 * spread


def test_paper_worlds_have_one_shape_in_each_quadrant(paper_worlds):
    """The published centre lies within 0.1 m of the middle of a quadrant, each way; no quadrant has two."""
    taken = []
    for world in paper_worlds:
        centers = np.array([base_middle(shape) for shape in world.shapes])
        assert (np.abs(np.abs(centers) - 0.225) <= 0.1 + SLACK).all()
        quadrants = [tuple(q) for q in np.sign(centers).astype(int)]
        assert len(set(quadrants)) == len(quadrants)
        taken += quadrants
    counts = np.unique(taken, axis=0, return_counts=True)[1]
    assert len(counts) == 4
    assert np.abs(counts - len(taken) / 4).max() < 4 * np.sqrt(len(taken) * 0.25 * 0.75)


def test_jitter_uses_its_whole_range(paper_worlds):
    """Circles are hardly ever refused for want of room, so they show what was drawn."""
    offsets = np.abs([c.center for c in shapes_of(paper_worlds, "circle")]) - 0.225
    assert offsets.min() < -0.09
    assert offsets.max() > 0.09
    assert abs(offsets.mean()) < 0.02


def test_paper_circles(paper_worlds):
    radii = np.array([c.radius for c in shapes_of(paper_worlds, "circle")])
    assert ((radii >= 0.05) & (radii <= 0.10)).all()
    assert radii.min() < 0.055
    assert radii.max() > 0.095


def test_paper_rectangles(paper_worlds):
    rectangles = shapes_of(paper_worlds, "rectangle")
    sides = np.array([r.dimensions for r in rectangles])
    assert ((sides >= 0.10 - SLACK) & (sides <= 0.30 + SLACK)).all()
    for r in rectangles:
        assert (np.abs(r.edges).min(axis=1) == 0).all(), "every side is parallel to an axis"
    assert sum(np.ptp(r.vertices[:, 0]) > np.ptp(r.vertices[:, 1]) for r in rectangles) > len(rectangles) / 4
    assert sum(np.ptp(r.vertices[:, 0]) < np.ptp(r.vertices[:, 1]) for r in rectangles) > len(rectangles) / 4


def test_paper_triangles(paper_worlds):
    """Base 0.10 to 0.30 m, parallel to the x axis; height 0.10 m; the top above the middle of the base."""
    for triangle in shapes_of(paper_worlds, "triangle"):
        (left, low), (right, low_too), (top, high) = triangle.vertices
        assert low == low_too
        assert 0.10 - SLACK <= right - left <= 0.30 + SLACK
        assert high - low == pytest.approx(0.10)
        assert top == pytest.approx((left + right) / 2)


def test_paper_pentagons(paper_worlds):
    for pentagon in shapes_of(paper_worlds, "pentagon"):
        radius = np.ptp(pentagon.vertices[:, 1]) / 1.8
        assert 0.05 - SLACK <= radius <= 0.10 + SLACK
        corners = pentagon.vertices - base_middle(pentagon)
        np.testing.assert_allclose(corners, radius * PENTAGON, atol=1e-12)


# --- Random worlds: any --------------------------------------------------------------------------------------

N_CORNERS = {"quadrilateral": 4, "hexagon": 6, "star": 10, "L": 6, "T": 8, "U": 8, "arrow": 4}
N_DENTS = {"quadrilateral": 0, "hexagon": 0, "star": 5, "L": 1, "T": 2, "U": 2, "arrow": 1}


@pytest.fixture(scope="module")
def any_worlds():
    """48 boards in the style any, with one to six shapes."""
    return [random_world(n, style="any", rng=1000 * n + seed) for n in range(1, 7) for seed in range(8)]


def test_boards_of_any_shapes_keep_gaps_and_limits(any_worlds):
    assert [len(world.shapes) for world in any_worlds] == np.repeat(range(1, 7), 8).tolist()
    for world in any_worlds:
        check_gaps_and_limits(world, 0.05, LIMIT)


def test_any_shapes_are_drawn_evenly_from_eleven_sorts(any_worlds):
    kinds = [shape.kind for world in any_worlds for shape in world.shapes]
    n = len(kinds)
    for kind, share in [*((kind, 1 / 11) for kind in PRIMITIVES), ("polygon", 7 / 11)]:
        assert abs(kinds.count(kind) - share * n) < 4 * np.sqrt(n * share * (1 - share))


@pytest.mark.parametrize("sort", SORTS)
def test_sorts_are_what_they_are_called(sort):
    """Corners that bend in and out as the name says, sides that a sensor can tell, thick enough to be seen through."""
    bearings = []
    for seed in range(60):
        (shape,) = random_world(1, style="any", kinds=[sort], rng=seed).shapes
        assert shape.kind == "polygon"
        assert (len(shape.vertices), int((shape.turns < 0).sum())) == (N_CORNERS[sort], N_DENTS[sort])
        assert shape.sides.min() > 0.035
        assert np.abs(np.degrees(shape.turns)).min() >= 25
        assert np.degrees(shape.turns).max() < 155
        assert not shape.to_shapely().buffer(-0.012).is_empty
        bearings.append(np.arctan2(*(shape.vertices[0] - shape.centroid)))
    assert np.ptp(bearings) > 5, "turned by any angle"


def test_a_polygon_is_a_sort_at_random():
    polygons = [random_world(1, style="any", kinds=["polygon"], rng=seed).shapes[0] for seed in range(60)]
    assert {shape.kind for shape in polygons} == {"polygon"}
    assert {len(shape.vertices) for shape in polygons} == {4, 6, 8, 10}


# --- Random worlds: free -------------------------------------------------------------------------------------


def corner_angles(polygon):
    """Interior angles, corner by corner, by the law of cosines."""
    a = np.linalg.norm(np.roll(polygon.vertices, 1, axis=0) - polygon.vertices, axis=1)
    b = np.linalg.norm(np.roll(polygon.vertices, -1, axis=0) - polygon.vertices, axis=1)
    c = np.linalg.norm(np.roll(polygon.vertices, 1, axis=0) - np.roll(polygon.vertices, -1, axis=0), axis=1)
    return np.degrees(np.arccos((a**2 + b**2 - c**2) / (2 * a * b)))


def test_free_worlds_have_the_number_asked_for(free_worlds):
    assert [len(world.shapes) for world in free_worlds] == np.repeat(range(1, 7), 60).tolist()


def test_free_circles(free_worlds):
    radii = np.array([c.radius for c in shapes_of(free_worlds, "circle")])
    assert ((radii >= 0.04) & (radii <= 0.10)).all()


def test_free_rectangles_have_right_angles_and_any_direction(free_worlds):
    rectangles = shapes_of(free_worlds, "rectangle")
    for r in rectangles:
        np.testing.assert_allclose(corner_angles(r), 90, atol=1e-6)
        assert r.sides[:2] == pytest.approx(r.sides[2:])
        assert 0.06 - SLACK <= r.dimensions[1] <= r.dimensions[0] <= 0.30 + SLACK
    directions = np.array([np.arctan2(*r.edges[0][::-1]) % (np.pi / 2) for r in rectangles])
    assert np.histogram(directions, bins=6, range=(0, np.pi / 2))[0].min() > len(rectangles) / 12


@pytest.mark.parametrize("kind", ["triangle", "pentagon"])
def test_free_triangles_and_pentagons_have_corners_that_can_be_told(kind, free_worlds):
    for shape in shapes_of(free_worlds, kind):
        angles = corner_angles(shape)
        assert angles.sum() == pytest.approx({"triangle": 180, "pentagon": 540}[kind])
        assert angles.min() >= 30 - 1e-6
        assert angles.max() <= 150 + 1e-6
        assert shape.sides.min() >= 0.04 - SLACK


def test_free_shapes_stand_anywhere(free_worlds):
    """Also astride the axes, where the paper's never are."""
    centers = np.array([shape.centroid for world in free_worlds for shape in world.shapes])
    assert np.histogram2d(*centers.T, bins=3, range=[(-LIMIT, LIMIT)] * 2)[0].min() > len(centers) / 20


# --- Random worlds: both -------------------------------------------------------------------------------------


def check_gaps_and_limits(world, gap, limit):
    bodies = [outer(shape) for shape in world.shapes]
    for one, other in combinations(bodies, 2):
        assert one.distance(other) >= gap - 2 * OUTER_ERROR
    if bodies:
        assert np.abs(shapely.total_bounds(bodies)).max() <= limit + OUTER_ERROR
    for one, other in combinations(world.shapes, 2):  # to the last digit, by sampling
        assert one.signed_distance(other.outline(60)).min() >= gap - SLACK
    for shape in world.shapes:
        assert np.abs(shape.outline(60)).max() <= limit + SLACK


def test_paper_shapes_keep_their_gap_and_the_margin(paper_worlds):
    for world in paper_worlds:
        check_gaps_and_limits(world, 0.05, LIMIT)
        assert world.least_gap() >= 0.05


def test_free_shapes_keep_their_gap_and_the_margin(free_worlds):
    for world in free_worlds:
        check_gaps_and_limits(world, 0.05, LIMIT)
        assert world.least_gap() >= 0.05


@pytest.mark.parametrize(
    ("n", "style", "gap", "size"),
    [
        (4, "paper", 0.0, 1.0),
        (4, "paper", 0.12, 1.0),
        (4, "paper", 0.3, 2.0),
        (1, "paper", 0.05, 0.8),
        (3, "free", 0.15, 1.0),
        (12, "free", 0.1, 2.0),
    ],
)
def test_gap_and_size_are_kept(n, style, gap, size):
    for seed in range(10):
        world = random_world(n, style=style, gap=gap, size=size, rng=seed)
        assert (len(world.shapes), world.size) == (n, size)
        check_gaps_and_limits(world, gap, size / 2 - 0.12)


def test_without_a_gap_shapes_come_closer_but_do_not_touch():
    """Two polygons that overlap are 0 apart for shapely, which once passed for a gap of 0."""
    worlds = [random_world(6, style="free", gap=0.0, rng=seed) for seed in range(40)]
    for world in worlds:
        check_gaps_and_limits(world, 0.0, LIMIT)
    assert 0 < min(world.least_gap() for world in worlds) < 0.01


def test_quadrants_grow_with_the_board_and_shapes_do_not():
    for seed in range(30):
        world = random_world(4, size=2.0, rng=seed)
        centers = np.array([base_middle(shape) for shape in world.shapes])
        assert (np.abs(np.abs(centers) - 0.45) <= 0.2 + SLACK).all()
        assert max(shape.reach for shape in world.shapes) < 0.22


@pytest.mark.parametrize("style", ["paper", "free", "any"])
def test_same_seed_same_world(style):
    for seed in range(20):
        world = random_world(3, style=style, rng=seed)
        assert world == random_world(3, style=style, rng=seed)
        assert world == random_world(3, style=style, rng=np.random.default_rng(seed))
        assert world != random_world(3, style=style, rng=seed + 1)


def test_a_generator_goes_on_and_no_seed_means_any_world():
    rng = np.random.default_rng(0)
    assert random_world(2, rng=rng) != random_world(2, rng=rng)
    assert random_world(2) != random_world(2)


@pytest.mark.parametrize("style", ["paper", "free", "any"])
def test_kinds_come_in_the_order_asked_for(style):
    for seed in range(20):
        kinds = list(np.random.default_rng(seed).choice(PRIMITIVES, 4).tolist())
        world = random_world(4, style=style, kinds=kinds, rng=seed)
        assert [shape.kind for shape in world.shapes] == kinds


@pytest.mark.parametrize("style", ["paper", "free", "any"])
def test_no_shapes_asked_for(style):
    assert random_world(0, style=style, rng=0) == World()
    assert random_world(0, style=style, kinds=(), rng=0) == World()


RANDOM_WORLD_FAILURES = {
    "five in the paper's style": (
        *(5, {}),
        'the paper\'s style has room for at most 4 shapes, got 5; use style="free" for more',
    ),
    "n negative": (-1, {}, "n must be a whole number >= 0, got -1"),
    "n a float": (2.0, {}, "n must be a whole number >= 0, got 2.0"),
    "n a truth value": (True, {}, "n must be a whole number >= 0, got True"),
    "n None": (None, {}, "n must be a whole number >= 0, got None"),
    "n is text": ("4", {}, "n must be a whole number >= 0, got '4'"),
    "unknown style": (1, {"style": "Paper"}, 'style must be "paper", "free" or "any", got \'Paper\''),
    "style None": (1, {"style": None}, 'style must be "paper", "free" or "any", got None'),
    "too few kinds": (2, {"kinds": ["circle"]}, "kinds must name one kind for each of the 2 shapes, got 1"),
    "too many kinds": (1, {"kinds": PRIMITIVES}, "kinds must name one kind for each of the 1 shapes, got 4"),
    "unknown kind": (
        *(2, {"kinds": ["circle", "square"]}),
        "a kind must be one of circle, triangle, rectangle, pentagon, got 'square'",
    ),
    "a sort in the style free": (
        *(1, {"kinds": ["star"], "style": "free"}),
        "a kind must be one of circle, triangle, rectangle, pentagon, got 'star'",
    ),
    "a polygon in the paper's style": (
        *(1, {"kinds": ["polygon"]}),
        "a kind must be one of circle, triangle, rectangle, pentagon, got 'polygon'",
    ),
    "unknown sort": (
        *(1, {"kinds": ["blob"], "style": "any"}),
        "a kind must be one of circle, triangle, rectangle, pentagon, quadrilateral, hexagon, star, L, T, U, arrow, "
        "got 'blob'",
    ),
    "kind None": (1, {"kinds": [None]}, "a kind must be one of circle, triangle, rectangle, pentagon, got None"),
    "gap negative": (1, {"gap": -0.01}, "gap must be a finite number >= 0, got -0.01"),
    "gap NaN": (1, {"gap": NAN}, "gap must be a finite number >= 0, got nan"),
    "gap infinite": (1, {"gap": INF}, "gap must be a finite number >= 0, got inf"),
    "gap is text": (1, {"gap": "0"}, "gap must be a finite number >= 0, got '0'"),
    "size zero": (1, {"size": 0}, "size must be a finite number > 0, got 0"),
    "size NaN": (1, {"size": NAN}, "size must be a finite number > 0, got nan"),
    "board too small for its margin": (
        *(1, {"kinds": ["circle"], "size": 0.2}),
        "no room found for 1 shapes with a gap of 0.05 m on a board of 0.2 m: "
        "ask for fewer shapes, a smaller gap or a larger board",
    ),
    "board too small, free": (
        *(1, {"kinds": ["circle"], "size": 0.3, "style": "free"}),
        "no room found for 1 shapes with a gap of 0.05 m on a board of 0.3 m: "
        "ask for fewer shapes, a smaller gap or a larger board",
    ),
    "gap wider than the board": (
        *(2, {"kinds": ["circle", "circle"], "gap": 1.5}),
        "no room found for 2 shapes with a gap of 1.5 m on a board of 1 m: "
        "ask for fewer shapes, a smaller gap or a larger board",
    ),
}


@pytest.mark.parametrize(("n", "others", "sentence"), RANDOM_WORLD_FAILURES.values(), ids=RANDOM_WORLD_FAILURES)
def test_random_world_failure(n, others, sentence):
    with pytest.raises(ValueError, match=exactly(sentence)):
        random_world(n, rng=0, **others)
