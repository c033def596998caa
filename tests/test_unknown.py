"""Unknown things: what is none of the kinds is measured as it is, or is not certain; what is certain may be trusted."""

import numpy as np
import pytest

import primkit as pk
from primkit.robust.choice import explained
from primkit.robust.free import _pruned, free_outline, path_through
from primkit.robust.lack_of_fit import lack_of_fit, lacks_corner, residuals_along, sharpness
from primkit.robust.outlines import Outlines
from primkit.robust.scatter import LEAST_SPREAD, spread_across
from tests.benchmarks.open_world.boards import rng_of, seen_on, two_flush
from tests.benchmarks.open_world.things import bow, oval, regular, thing
from tests.helpers import exactly

CORNERED = {
    "hexagon": regular(6, 0.09),
    "heptagon": regular(7, 0.09),
    "octagon": regular(8, 0.1),
    "star": regular(10, 0.1, 0.05),
    "trapezoid": [(-0.1, -0.05), (0.1, -0.05), (0.05, 0.05), (-0.05, 0.05)],
    "kite": [(0, -0.11), (0.07, 0.03), (0, 0.08), (-0.07, 0.03)],
    "rhombus": [(-0.1, 0), (0, -0.06), (0.1, 0), (0, 0.06)],
    "L": [(-0.08, -0.08), (0.08, -0.08), (0.08, -0.02), (-0.02, -0.02), (-0.02, 0.08), (-0.08, 0.08)],
    "T": np.array([(-2, -8), (2, -8), (2, 3), (9, 3), (9, 8), (-9, 8), (-9, 3), (-2, 3)]) / 100,
    "arrow": [(-0.1, -0.07), (0.1, 0), (-0.1, 0.07), (-0.05, 0)],
    "a corner of 170 degrees": [(-0.1, -0.05), (0.1, -0.05), (0.1, 0.05), (0, 0.0588), (-0.1, 0.05)],
}
CURVED = {
    "ellipse 1.1": oval(0.077, 0.07),
    "ellipse 1.3": oval(0.085, 0.065),
    "ellipse 2": oval(0.1, 0.05),
    "rounded square": oval(0.07, 0.07, 4),
    "half disc": bow(0.08),
}


def seen(corners, seed, noise=0.0):
    """The cells that the way-points' scans of one thing occupy, turned and shifted."""
    rng = np.random.default_rng(seed)
    thing = pk.Polygon(corners).moved(rng.uniform(-0.2, 0.2, 2), rng.uniform(0, 2 * np.pi))
    return thing, seen_on(pk.World([thing]), rng, noise_std=noise)


def farthest_corner(found, thing):
    return max(np.hypot(*(found.vertices - corner).T).min() for corner in thing.vertices)


@pytest.mark.parametrize("noise", [0.0, 0.002], ids=["no noise", "2 mm"])
@pytest.mark.parametrize("name", CORNERED)
def test_any_polygon_is_measured_corner_by_corner(name, noise):
    for seed in range(2):
        thing, grid = seen(CORNERED[name], 100 + seed, noise)
        (one,) = pk.find_shapes(grid, rng=0)
        assert one.kind == thing.kind
        assert len(one.shape.vertices) == len(thing.vertices)
        assert farthest_corner(one.shape, thing) < (0.002 if noise == 0 else 0.012)
        assert one.certain or name == "T" or noise > 0  # two rectangles that nearly touch may look like a T
        assert len(one.dimension_std) == len(one.shape.dimensions)


@pytest.mark.parametrize("board", [140, 170, 180])
def test_two_shapes_that_nearly_touch_are_not_certain_to_be_one(board):
    world = two_flush(0.002, rng := rng_of(1717, board))
    (one,) = pk.find_shapes(seen_on(world, rng), rng=0)
    assert not one.certain


def test_a_piece_is_certain_only_with_all_that_it_was_cut_from():
    grid = seen_on(pk.World([thing("comma", rng := np.random.default_rng(3))]), rng)
    found = pk.find_shapes(grid, rng=0)
    assert len(found) > 1
    assert not any(one.certain for one in found)


@pytest.mark.parametrize("noise", [0.0, 0.002], ids=["no noise", "2 mm"])
@pytest.mark.parametrize("corners", CURVED.values(), ids=CURVED)
def test_what_is_curved_is_never_certain(corners, noise):
    for seed in range(2):
        _, grid = seen(corners, 200 + seed, noise)
        assert not any(one.certain for one in pk.find_shapes(grid, rng=0))


@pytest.mark.parametrize("noise", [0.0, 0.002], ids=["no noise", "2 mm"])
def test_the_four_kinds_are_certain(noise):
    """Certainty is not bought by silence."""
    certain = []
    for seed in range(300, 306):
        grid = seen_on(pk.random_world(4, style="free", rng=seed), seed, noise_std=noise)
        certain += [one.certain for one in pk.find_shapes(grid, rng=0)]
    assert np.mean(certain) >= 0.95


def test_cells_that_round_a_whole_side_alike_are_no_bends():
    """On this board a side runs nearly along the cells, whose rounding then repeats itself over many points."""
    grid = seen_on(pk.random_world(4, style="free", rng=6120))
    assert all(one.certain for one in pk.find_shapes(grid, rng=0))


def test_the_paper_is_never_certain():
    ring = pk.Circle((0, 0), 0.06).outline(150)
    (one,) = pk.find_shapes(ring, 1, settings=pk.PAPER, rng=0)
    assert not one.certain


SMALL = {
    "a square of 8 mm": pk.Polygon([(0, 0), (0.008, 0), (0.008, 0.008), (0, 0.008)]).outline(32),
    "a pentagon of radius 8 mm": pk.Polygon(regular(5, 0.008)).outline(40),
    "a circle of radius 12 mm": pk.Circle((0, 0), 0.012).outline(90),
    "strays within 3 mm": np.random.default_rng(0).uniform(-0.003, 0.003, (10, 2)),
}


@pytest.mark.parametrize("points", SMALL.values(), ids=SMALL)
def test_what_is_too_small_to_tell_is_not_certain(points):
    assert not any(one.certain for one in pk.find_shapes(points, rng=0))


def test_half_an_outline_is_not_certain():
    ring = pk.Circle((0, 0), 0.08).outline(300)
    assert not any(one.certain for one in pk.find_shapes(ring[ring[:, 1] > 0], rng=0))


# --- the parts ---------------------------------------------------------------------------------------------------


def test_the_path_goes_once_round_whatever_the_order_of_the_points():
    ell = pk.Polygon(CORNERED["L"]).outline(300)
    path = path_through(np.random.default_rng(0).permutation(ell), LEAST_SPREAD)
    steps = np.hypot(*np.diff(path, axis=0).T)
    assert steps.max() < 0.01
    assert steps.sum() == pytest.approx(pk.Polygon(CORNERED["L"]).perimeter, rel=0.05)


@pytest.mark.parametrize("corners", CORNERED.values(), ids=CORNERED)
def test_strays_lead_no_cut_astray(corners):
    thing, rng = pk.Polygon(corners), np.random.default_rng(1)
    middle = thing.outline(300).mean(axis=0)
    points = np.vstack([thing.outline(300), middle + rng.uniform(-0.12, 0.12, (9, 2))]) - middle
    outline = free_outline(points, LEAST_SPREAD)
    assert farthest_corner(outline.polygon().moved(middle), thing) < 0.002


@pytest.mark.parametrize("k", [0, 1, 2])
def test_what_is_open_or_nearly_nothing_has_no_outline(k):
    line = np.column_stack([np.linspace(-0.1, 0.1, 60), np.zeros(60)])
    assert free_outline([line, line[:3], line[:0]][k].reshape(-1, 2), LEAST_SPREAD) is None


def test_a_piece_that_is_not_worth_its_price_is_left_out():
    """One side of the hexagon, broken in two by hand, is one again."""
    hexagon = pk.Polygon(regular(6, 0.09))
    whole = outline_of(hexagon)
    turned = np.append(whole.angles, whole.angles[:, -1:] + 0.15, axis=1)
    broken = Outlines(turned, np.append(whole.offsets, whole.offsets[:, -1:] * 1.001, axis=1))
    assert _pruned(hexagon.outline(300), broken, LEAST_SPREAD).angles.shape == (1, 6)


def outline_of(polygon):
    normals = polygon.normals
    offsets = (normals * polygon.vertices).sum(axis=1)
    return Outlines(np.arctan2(normals[:, 1], normals[:, 0])[None], offsets[None])


def test_noise_alone_lets_hardly_any_outline_bend():
    """Fit to pure noise, the statistic stays above 10 in 99 of 100."""
    hexagon, rng = pk.Polygon(regular(6, 0.09)), np.random.default_rng(0)
    points, spread = hexagon.outline(240), spread_across(0.002)
    outward = outline_of(hexagon).places(points)
    assert np.abs(outward[1]).max() < 1e-12
    assert lack_of_fit(points, pk.Circle((0, 0), 0.2), spread) == 0, "no point is on it: nothing speaks for it"
    ring = pk.Circle((0, 0), 0.09).outline(240)
    fits = [
        lack_of_fit(ring * (1 + rng.normal(0, spread, 240) / 0.09)[:, None], pk.Circle((0, 0), 0.09), spread)
        for _ in range(300)
    ]
    assert np.mean(np.array(fits) >= 10) >= 0.98


def test_points_that_may_be_of_either_side_tell_of_no_bend():
    """Around a corner, noise has moved points across both sides: their residuals have an order without any bend."""
    hexagon, spread = pk.Polygon(regular(6, 0.09)), 0.002
    points = hexagon.outline(240)
    second = np.sort(np.abs(points @ hexagon.normals.T - (hexagon.normals * hexagon.vertices).sum(axis=1)))[:, 1]
    told = residuals_along(points, outline_of(hexagon), spread)
    assert 150 < len(told) < 240
    assert len(told) <= np.count_nonzero(second > 1.5 * spread)


def test_corners_are_sharp_and_bends_are_not():
    spread = LEAST_SPREAD
    octagon = pk.Polygon(regular(8, 0.1))
    assert sharpness(octagon.outline(300), outline_of(octagon), spread) > 100
    tangents = pk.Polygon(regular(12, 0.1))
    assert sharpness(pk.Circle((0, 0), 0.0983).outline(300), outline_of(tangents), spread) < 10


def test_shallow_corners_are_told_from_an_arc_in_noise():
    """Corners of 40 degrees, 5 cm apart, in 2 mm of noise; and an arc in their stead, which fits the sides as well."""
    spread, rng = spread_across(0.002), np.random.default_rng(0)
    hexagon = pk.Polygon([(-0.1, -0.05), (0.1, -0.05), (0.063, 0.06), (0.025, 0.092), (-0.025, 0.092), (-0.063, 0.06)])
    outline, even = outline_of(hexagon), hexagon.outline(400)
    arc = even[:, 1] > 0.06
    bent, middle = even.copy(), np.array([0, 0.025])
    bent[arc] = middle + 0.0731 * (even[arc] - middle) / np.hypot(*(even[arc] - middle).T)[:, None]
    noise = rng.normal(0, spread, (40, *even.shape))
    assert np.mean([sharpness(even + e, outline, spread) >= 10 for e in noise]) >= 0.9
    assert max(sharpness(bent + e, outline, spread) for e in noise) < 10


def test_two_neighbours_beside_an_outline_are_a_corner_that_it_does_not_have():
    points = pk.Polygon([(-0.1, -0.1), (0.1, -0.1), (0.1, 0.1), (-0.1, 0.1)]).outline(400)
    nib = np.array([(0.102, 0.0202), (0.104, 0.0203)])
    for more, sure in ((nib[1:], True), (nib, False), (nib * 1.1, True)):  # one stray; two neighbours; two far off
        choice = explained(np.vstack([points, more]), LEAST_SPREAD)
        assert (choice.shape.kind, choice.certain) == ("rectangle", sure)
    ring, nib = pk.Circle((0, 0), 0.1), np.array([(0.102, 0.0002), (0.104, 0.0003)])
    assert lacks_corner(np.vstack([ring.outline(400), nib]), ring, LEAST_SPREAD)
    assert not lacks_corner(np.vstack([ring.outline(400), nib[1:]]), ring, LEAST_SPREAD)


def test_a_polygon_that_is_not_convex_has_its_distances():
    ell = pk.Polygon(CORNERED["L"])
    points = np.random.default_rng(0).uniform(-0.12, 0.12, (300, 2))
    np.testing.assert_allclose(outline_of(ell).signed_distance(points), np.abs(ell.signed_distance(points)), atol=1e-12)
    assert outline_of(ell).kind == "polygon"
    assert outline_of(ell).closes()[0]
    assert not outline_of(ell).sound()[0]


# --- what can be there, known beforehand -------------------------------------------------------------------------


def test_poles_are_found_where_only_poles_can_be():
    """Radius 55 mm and noise of 18 mm, as a real scanner sees them: without that knowledge, nothing is certain."""
    rng = np.random.default_rng(3)
    poles = [pk.Circle((x, y), 0.055) for x in (-0.3, 0.3) for y in (-0.3, 0.0, 0.3)]
    points = []
    for pole in poles:
        ring = pole.outline(220)
        points.append(ring + (ring - pole.center) / pole.radius * rng.normal(0, 0.018, (220, 1)))
    points = np.vstack(points)
    assert not any(one.certain and one.kind != "circle" for one in pk.find_shapes(points, rng=0))
    found = pk.find_shapes(points, kinds=("circle",), rng=0)
    assert [one.kind for one in found] == ["circle"] * 6
    for pole in poles:
        nearest = min(found, key=lambda one, pole=pole: np.hypot(*(one.shape.center - pole.center)))
        assert np.hypot(*(nearest.shape.center - pole.center)) < 0.01


def test_kinds_that_cannot_be_are_no_explanation():
    square = pk.Polygon([(0, 0), (0.1, 0), (0.1, 0.1), (0, 0.1)]).outline(300)
    assert [one.kind for one in pk.find_shapes(square, kinds=("rectangle", "circle"), rng=0)] == ["rectangle"]
    for kinds in (("circle",), ("triangle",)):
        found = pk.find_shapes(square, kinds=kinds, rng=0)
        assert {one.kind for one in found} <= set(kinds)
        assert not any(one.certain for one in found)


@pytest.mark.parametrize(("kinds", "got"), [(("hexagon",), "'hexagon'"), ((), "()"), ("square", "'square'")])
def test_a_kind_is_one_of_the_kinds(kinds, got):
    message = f"kinds must be some of circle, triangle, rectangle, pentagon, polygon, got {got}"
    with pytest.raises(ValueError, match=exactly(message)):
        pk.find_shapes([(0, 0)], kinds=kinds)


@pytest.mark.parametrize("apart", [0.12, 0.17])
def test_sides_that_no_beam_met_are_not_certain_however_sparse_their_neighbours_are(apart):
    """Two walls face each other, a point every three cells: the ends of a rectangle would be theirs alone."""
    rng = np.random.default_rng(0)
    for _ in range(5):
        points = np.array([(x, y) for y in (0, apart) for x in np.arange(0, 0.48, 0.03)])
        found = pk.find_shapes(points + rng.normal(0, 0.005, points.shape), resolution=0.01, rng=0)
        assert not any(one.certain for one in found)


@pytest.mark.parametrize("width", [0.018, 0.03])
def test_a_plank_whose_end_no_beam_met_is_not_certain(width):
    """Its other three sides were seen; the points at the ends of the two long ones lie near the whole of this one."""
    rng, certain = np.random.default_rng(0), []
    for _ in range(5):
        long = np.array([(x, y) for y in (0, width) for x in np.arange(0, 0.2, 0.0005)])
        end = np.array([(0, y) for y in np.arange(0, width, 0.0005)])
        points = np.vstack([long, end])
        certain += [one.certain for one in pk.find_shapes(points + rng.normal(0, 0.002, points.shape), rng=0)]
    assert not any(certain)


FOUR_KINDS = ("circle", "triangle", "rectangle", "pentagon")


@pytest.mark.parametrize(("corners", "certain"), [(0, True), (3, False), (4, False), (5, False)])
def test_from_one_pose_a_circle_is_certain_only_where_none_but_the_four_kinds_can_be(corners, certain):
    turns = np.arange(corners) * 2 * np.pi / max(corners, 1) + 0.3
    there = pk.Circle((2.0, 0.3), 0.2)
    if corners:
        there = pk.Polygon(there.center + 0.2 * np.column_stack([np.cos(turns), np.sin(turns)]))
    lidar = pk.Lidar(beams=1440, range_max=8.0, noise_std=0.005)
    grid = pk.Grid(0.01)
    grid.add(pk.scan(pk.World([there], 6), [(0, 0, 0)], lidar, rng=0))
    found = pk.find_shapes(grid, kinds=FOUR_KINDS, rng=0)
    assert [one.kind for one in found if one.certain] == ["circle"] * certain
    assert not any(one.certain for one in pk.find_shapes(grid, rng=0))
