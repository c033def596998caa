"""The shapes, against hand computation and against shapely; and what is refused before there is a shape."""

import copy
import dataclasses
import math
import pickle
import tracemalloc
from itertools import combinations

import numpy as np
import pytest
import shapely
from hypothesis import assume, given
from hypothesis import strategies as st

from primkit.arguments import as_count, as_point, as_points, as_poses, as_positive, short
from primkit.shapes import Circle, Polygon, turns_of
from tests.helpers import exactly

NAN, INF = float("nan"), float("inf")
HUGE = 10**400  # a whole number that no float can hold

SQUARE = [(0, 0), (0.2, 0), (0.2, 0.2), (0, 0.2)]
RIGHT = [(0, 0), (3, 0), (0, 4)]  # sides 3, 5, 4
HOUSE = [(0, 0), (4, 0), (4, 3), (2, 5), (0, 3)]  # walls of 12 about y = 3/2, a roof of 4 about y = 11/3
# The five points of a star, every other one: it bends one way only, but turns round twice.
PENTAGRAM = [(math.cos(0.8 * math.pi * i), math.sin(0.8 * math.pi * i)) for i in range(5)]


# --- Shapes for hypothesis: convex with corners on an ellipse; stars by distances from a middle; combs ---------------

coordinates = st.floats(-2, 2)
offsets = st.tuples(coordinates, coordinates)
angles = st.floats(-7, 7)
circles = st.builds(Circle, offsets, st.floats(1e-3, 1))


@st.composite
def polygons(draw):
    n = draw(st.integers(3, 5))
    gaps = np.array(draw(st.lists(st.floats(0.2, 1), min_size=n, max_size=n)))
    bearings = draw(angles) + 2 * np.pi * np.cumsum(gaps) / gaps.sum()
    width, height = draw(st.floats(0.02, 1)), draw(st.floats(0.02, 1))
    corners = np.column_stack([width * np.cos(bearings), height * np.sin(bearings)])
    return Polygon(corners + draw(offsets))


@st.composite
def stars(draw, least=4):
    """Polygons that are seen whole from a middle, which may lie outside the hull's: stars, darts, dented things."""
    n = draw(st.integers(least, 14))
    gaps = np.array(draw(st.lists(st.floats(0.3, 1), min_size=n, max_size=n)))
    bearings = draw(angles) + 2 * np.pi * np.cumsum(gaps) / gaps.sum()
    radii = np.array(draw(st.lists(st.floats(0.02, 1), min_size=n, max_size=n)))
    ring = draw(offsets) + radii[:, None] * np.column_stack([np.cos(bearings), np.sin(bearings)])
    assume((np.abs(np.abs(turns_of(ring)) - np.pi / 2) < np.pi / 2 - 1e-6).all() and gaps.max() < gaps.sum() / 2)
    return Polygon(ring)


@st.composite
def combs(draw):
    """Ls, Us, Es and combs: teeth of any height on a bar, turned."""
    heights = draw(st.lists(st.floats(0.05, 1), min_size=1, max_size=6))
    ring = [(0.0, 0.0), (2.0 * len(heights) - 1, 0.0)]
    for i in reversed(range(len(heights))):
        ring += [(2.0 * i + 1, 1 + heights[i]), (2.0 * i, 1 + heights[i])]
        ring += [(2.0 * i, 1.0), (2.0 * i - 1, 1.0)] * (i > 0)
    return Polygon(draw(st.floats(0.01, 1)) * turned(ring, draw(angles)) + draw(offsets))


anything = st.one_of(polygons(), stars(), combs())
shapes = st.one_of(circles, anything)
clouds = st.lists(st.tuples(st.floats(-4, 4), st.floats(-4, 4)), min_size=1, max_size=20).map(np.array)


def turned(points, angle, about=(0.0, 0.0)):
    """Points turned counter-clockwise, one by one, by complex numbers."""
    middle = complex(*about)
    z = [middle + (complex(*p) - middle) * complex(math.cos(angle), math.sin(angle)) for p in points]
    return np.array([(v.real, v.imag) for v in z])


# --- Circle -------------------------------------------------------------------------------------------------


def test_circle_by_hand():
    circle = Circle((1, -2), 3)
    assert (circle.kind, circle.dimensions, circle.radius, circle.reach) == ("circle", (3.0,), 3.0, 3.0)
    assert circle.center.tolist() == circle.centroid.tolist() == [1.0, -2.0]
    assert circle.area == pytest.approx(28.274333882308138)
    assert circle.perimeter == pytest.approx(18.84955592153876)
    np.testing.assert_allclose(circle.outline(4), [(4, -2), (1, 1), (-2, -2), (1, -5)], atol=1e-15)


CIRCLE_DISTANCES = {
    "at the centre": ((1, 1), -0.5),
    "inside": ((1.25, 1), -0.25),
    "on the outline": ((1.5, 1), 0.0),
    "on the outline, 3-4-5": ((1.3, 1.4), 0.0),
    "outside": ((1, 3), 1.5),
    "outside, 3-4-5": ((4, 5), 4.5),
}


@pytest.mark.parametrize(("point", "distance"), CIRCLE_DISTANCES.values(), ids=CIRCLE_DISTANCES)
def test_circle_signed_distance(point, distance):
    assert Circle((1, 1), 0.5).signed_distance([point]).tolist() == pytest.approx([distance], abs=1e-15)


CIRCLE_FAILURES = {
    "radius zero": ((0, 0), 0, "radius must be a finite number > 0, got 0"),
    "radius negative": ((0, 0), -0.1, "radius must be a finite number > 0, got -0.1"),
    "radius NaN": ((0, 0), NAN, "radius must be a finite number > 0, got nan"),
    "radius infinite": ((0, 0), INF, "radius must be a finite number > 0, got inf"),
    "radius None": ((0, 0), None, "radius must be a finite number > 0, got None"),
    "radius is text": ((0, 0), "0.1", "radius must be a finite number > 0, got '0.1'"),
    "radius is bytes": ((0, 0), b"1", "radius must be a finite number > 0, got b'1'"),
    "radius is a truth value": ((0, 0), True, "radius must be a finite number > 0, got True"),
    "radius is numpy's truth value": ((0, 0), np.True_, "radius must be a finite number > 0, got np.True_"),
    "radius in a tuple": ((0, 0), (0.1,), "radius must be a finite number > 0, got (0.1,)"),
    "radius complex": ((0, 0), 1j, "radius must be a finite number > 0, got 1j"),
    "centre NaN": ((0, NAN), 1, "center must be two finite numbers (x, y), got (0, nan)"),
    "centre infinite": ((-INF, 0), 1, "center must be two finite numbers (x, y), got (-inf, 0)"),
    "centre with three numbers": ((0, 0, 0), 1, "center must be two finite numbers (x, y), got (0, 0, 0)"),
    "centre with one number": ((0,), 1, "center must be two finite numbers (x, y), got (0,)"),
    "centre a number": (5, 1, "center must be two finite numbers (x, y), got 5"),
    "centre a row of points": ([(0, 0)], 1, "center must be two finite numbers (x, y), got [(0, 0)]"),
    "centre empty": ((), 1, "center must be two finite numbers (x, y), got ()"),
    "centre None": (None, 1, "center must be two finite numbers (x, y), got None"),
    "centre is text": ("ab", 1, "center must be two finite numbers (x, y), got 'ab'"),
    "centre of texts": (("1", "2"), 1, "center must be two finite numbers (x, y), got ('1', '2')"),
}


@pytest.mark.parametrize(("center", "radius", "sentence"), CIRCLE_FAILURES.values(), ids=CIRCLE_FAILURES)
def test_circle_failure(center, radius, sentence):
    with pytest.raises(ValueError, match=exactly(sentence)):
        Circle(center, radius)


@given(circles)
def test_circle_against_shapely(circle):
    """The shapely polygon has its 4 x quad_segs corners on the circle, so its area and length are known exactly."""
    n = 4 * 16
    ring = circle.to_shapely(quad_segs=16)
    assert len(ring.exterior.coords) == n + 1
    assert ring.area == pytest.approx(circle.area * math.sin(2 * math.pi / n) / (2 * math.pi / n), rel=1e-9)
    assert ring.length == pytest.approx(circle.perimeter * math.sin(math.pi / n) / (math.pi / n), rel=1e-9)
    assert (ring.centroid.x, ring.centroid.y) == pytest.approx(tuple(circle.centroid), abs=1e-9)


def test_circle_to_shapely_has_256_corners_unless_told_otherwise():
    assert len(Circle((0, 0), 1).to_shapely().exterior.coords) == 256 + 1


# --- Polygon ------------------------------------------------------------------------------------------------

POLYGONS = {  # corners, kind, dimensions, area, perimeter, centroid
    "square": (SQUARE, "rectangle", (0.2, 0.2), 0.04, 0.8, (0.1, 0.1)),
    "flat rectangle": ([(0, 0), (3, 0), (3, 1), (0, 1)], "rectangle", (3, 1), 3, 8, (1.5, 0.5)),
    "tall rectangle: the width is the longer": (
        [(0, 0), (1, 0), (1, 3), (0, 3)],
        "rectangle",
        (3, 1),
        3,
        8,
        (0.5, 1.5),
    ),
    "measured rectangle: means of opposite sides": (
        [(0, 0), (80, 0), (80, 41), (0, 40)],  # two right angles, two 0.7 degrees off
        *("rectangle", ((80 + 6401**0.5) / 2, 40.5), 3240, 161 + 6401**0.5, (40 + 40 / 243, 4921 / 243)),
    ),
    "trapezium": (
        [(0, 0), (8, 0), (5, 4), (0, 4)],  # a rectangle of 20 about (2.5, 2) and a triangle of 6 about (6, 4/3)
        *("polygon", (8, 5, 5, 4), 26, 22, (43 / 13, 24 / 13)),
    ),
    "rhombus": ([(-3, 0), (0, -4), (3, 0), (0, 4)], "polygon", (5, 5, 5, 5), 24, 20, (0, 0)),
    "dart": ([(0, 0), (4, -3), (1, 0), (4, 3)], "polygon", (5, 18**0.5, 18**0.5, 5), 3, 10 + 72**0.5, (5 / 3, 0)),
    "hexagon": (
        [(2, 0), (1, 2), (-1, 2), (-2, 0), (-1, -2), (1, -2)],
        *("polygon", (5**0.5, 2, 5**0.5, 5**0.5, 2, 5**0.5), 12, 4 + 80**0.5, (0, 0)),
    ),
    "dented pentagon": (
        [(0, 0), (4, 0), (4, 4), (2, 1), (0, 4)],  # a square of 16 about (2, 2), less a triangle of 6 about (2, 3)
        *("polygon", (4, 4, 13**0.5, 13**0.5, 4), 10, 12 + 52**0.5, (2, 1.4)),
    ),
    "L": (  # bars of 4 about (2, 1/2) and 3 about (1/2, 5/2)
        [(0, 0), (4, 0), (4, 1), (1, 1), (1, 4), (0, 4)],
        *("polygon", (4, 1, 3, 3, 1, 4), 7, 16, (9.5 / 7, 9.5 / 7)),
    ),
    "triangle 3-4-5": (RIGHT, "triangle", (3, 5, 4), 6, 12, (1, 4 / 3)),
    "pentagon": (HOUSE, "pentagon", (4, 3, 8**0.5, 8**0.5, 3), 16, 10 + 32**0.5, (2, 49 / 24)),
}


@pytest.mark.parametrize(
    ("corners", "kind", "dimensions", "area", "perimeter", "centroid"), POLYGONS.values(), ids=POLYGONS
)
def test_polygon_by_hand(corners, kind, dimensions, area, perimeter, centroid):
    polygon = Polygon(corners)
    assert polygon.vertices.tolist() == [list(map(float, c)) for c in corners]
    assert polygon.kind == kind
    assert polygon.dimensions == pytest.approx(dimensions)
    assert polygon.area == pytest.approx(area)
    assert polygon.perimeter == pytest.approx(perimeter)
    assert polygon.centroid == pytest.approx(centroid)
    assert polygon.reach == pytest.approx(max(math.dist(centroid, c) for c in corners))


def test_sides_edges_and_normals_start_at_the_first_corner():
    triangle = Polygon(RIGHT)
    assert triangle.edges.tolist() == [[3, 0], [-3, 4], [0, -4]]
    assert triangle.sides.tolist() == [3, 5, 4]
    np.testing.assert_allclose(triangle.normals, [(0, -1), (0.8, 0.6), (-1, 0)], atol=1e-15)


ORDERS = {  # what is given, what is kept
    "counter-clockwise stays": (RIGHT, RIGHT),
    "clockwise is turned round, the first stays first": ([(0, 0), (0, 4), (3, 0)], RIGHT),
    "clockwise square": (SQUARE[::-1], [SQUARE[3], SQUARE[0], SQUARE[1], SQUARE[2]]),
    "clockwise pentagon": (HOUSE[::-1], [HOUSE[4], *HOUSE[:4]]),
    "closed ring": ([*RIGHT, RIGHT[0]], RIGHT),
    "closed ring of five": ([*HOUSE, HOUSE[0]], HOUSE),
    "closed clockwise ring": ([(0, 0), (0, 4), (3, 0), (0, 0)], RIGHT),
    "closed twice": ([*RIGHT, RIGHT[0], RIGHT[0]], RIGHT),
    "first corner doubled": ([RIGHT[0], *RIGHT], RIGHT),
    "first corner doubled and closed twice": ([RIGHT[0], *RIGHT, RIGHT[0], RIGHT[0]], RIGHT),
    "middle corner doubled": ([RIGHT[0], RIGHT[1], RIGHT[1], RIGHT[2]], RIGHT),
    "last corner doubled": ([*RIGHT, RIGHT[2]], RIGHT),
    "every corner three times": ([c for c in HOUSE for _ in range(3)], HOUSE),
    "a corner within a nanometre is the same": ([*RIGHT, (0, 4 + 9e-10)], RIGHT),
    "a ring that closes within a nanometre": ([*RIGHT, (9e-10, 0)], RIGHT),
}


@pytest.mark.parametrize(("given_corners", "kept"), ORDERS.values(), ids=ORDERS)
def test_corners_are_put_right(given_corners, kept):
    assert Polygon(given_corners).vertices.tolist() == [list(map(float, c)) for c in kept]


def test_a_corner_two_nanometres_away_is_another_corner():
    assert len(Polygon([(0, 0), (3, 0), (3, 2e-9), (0, 4)]).vertices) == 4


POLYGON_FAILURES = {
    "no corner": ([], "a polygon must have at least 3 different corners, got 0"),
    "one corner": ([(1, 1)], "a polygon must have at least 3 different corners, got 1"),
    "two corners": ([(0, 0), (1, 1)], "a polygon must have at least 3 different corners, got 2"),
    "two corners, closed": ([(0, 0), (1, 1), (0, 0)], "a polygon must have at least 3 different corners, got 2"),
    "one corner, many times": ([(1, 1)] * 4, "a polygon must have at least 3 different corners, got 1"),
    "on one line": (
        [(0, 0), (1, 1), (2, 2)],
        "a polygon's corners must not lie on one line, got (0, 0) between its neighbours",
    ),
    "on one vertical line": (
        [(1, 0), (1, 2), (1, 1)],
        "a polygon's corners must not lie on one line, got (1, 0) between its neighbours",
    ),
    "a corner in the middle of a side": (
        [(0, 0), (1, 0), (2, 0), (2, 2)],
        "a polygon's corners must not lie on one line, got (1, 0) between its neighbours",
    ),
    "a spike, there and back": (
        [(0, 0), (4, 0), (2, 0), (2, 2)],
        "a polygon's corners must not lie on one line, got (4, 0) between its neighbours",
    ),
    "nearly on one line": (
        [(0, 0), (1, -1e-10), (2, 0), (2, 2)],
        "a polygon's corners must not lie on one line, got (1, 0) between its neighbours",
    ),
    "bow-tie": (
        [(0, 0), (1, 1), (1, 0), (0, 1)],
        "a polygon must not cross or touch itself, got a meeting at (0.5, 0.5)",
    ),
    "a dent that reaches the other side": (
        [(0, 0), (4, 0), (4, 4), (2, 0), (0, 4)],
        "a polygon must not cross or touch itself, got a meeting at (2, 0)",
    ),
    "a corner that two tips share": (
        [(0, 0), (1, 1), (2, 0), (2, 2), (1, 1), (0, 2)],
        "a polygon must not cross or touch itself, got a meeting at (1, 1)",
    ),
    "a way out and back": (
        [(0, 0), (2, 0), (2, 1), (3, 1), (3, 2), (3, 1), (2, 1), (2, 2)],
        "a polygon's corners must not lie on one line, got (3, 2) between its neighbours",
    ),
    "a slit": (
        [(0, 0), (4, 0), (4, 4), (2, 4), (2, 1), (2, 3), (1, 4), (0, 4)],
        "a polygon's corners must not lie on one line, got (2, 1) between its neighbours",
    ),
    "NaN": ([(0, 0), (1, NAN), (0, 1)], "vertices must be finite, got (1.0, nan) in row 1"),
    "infinity": ([(0, 0), (1, 0), (-INF, 1)], "vertices must be finite, got (-inf, 1.0) in row 2"),
    "three numbers each": ([(0, 0, 0)] * 3, "vertices must have shape (N, 2), got shape (3, 3)"),
    "a flat list": ([0, 0, 1, 0, 0, 1], "vertices must have shape (N, 2), got shape (6,)"),
    "two rings": ([SQUARE, SQUARE], "vertices must have shape (N, 2), got shape (2, 4, 2)"),
    "text": ("square", "vertices must be numbers in an array of shape (N, 2), got 'square'"),
    "None": (None, "vertices must be numbers in an array of shape (N, 2), got None"),
    "a truth value": (True, "vertices must be numbers in an array of shape (N, 2), got True"),
}


@pytest.mark.parametrize(("corners", "sentence"), POLYGON_FAILURES.values(), ids=POLYGON_FAILURES)
def test_polygon_failure(corners, sentence):
    with pytest.raises(ValueError, match=exactly(sentence)):
        Polygon(corners)


def crossing(ring):
    """Whether sides that are no neighbours meet, in whole numbers: by the signs of areas, without rounding."""
    n = len(ring)

    def side(a, b, c):
        area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        return (area > 0) - (area < 0)

    def between(a, b, c):
        return side(a, b, c) == 0 and all(min(s, t) <= u <= max(s, t) for s, t, u in zip(a, b, c, strict=True))

    for i, j in combinations(range(n), 2):
        if j - i in (1, n - 1):
            continue
        a, b, c, d = ring[i], ring[(i + 1) % n], ring[j], ring[(j + 1) % n]
        if side(a, b, c) * side(a, b, d) < 0 and side(c, d, a) * side(c, d, b) < 0:
            return True
        if between(a, b, c) or between(a, b, d) or between(c, d, a) or between(c, d, b):
            return True
    return False


@given(st.lists(st.tuples(st.integers(0, 6), st.integers(0, 6)), min_size=3, max_size=9, unique=True))
def test_what_crosses_or_touches_itself_is_refused_and_nothing_else(ring):
    bends = turns_of(np.array(ring, dtype=float))
    assume((np.abs(np.abs(bends) - np.pi / 2) < np.pi / 2 - 1e-6).all())
    if not crossing(ring):
        assert sorted(Polygon(ring).vertices.tolist()) == sorted(list(map(float, p)) for p in ring)
        return
    with pytest.raises(ValueError, match="a polygon must not cross or touch itself, got a meeting at ") as caught:
        Polygon(ring)
    place = shapely.Point(*map(float, str(caught.value).split("at (")[1].rstrip(")").split(", ")))
    sides = [shapely.LineString(pair) for pair in zip(ring, ring[1:] + ring[:1], strict=True)]
    assert sum(one.distance(place) < 1e-5 for one in sides) >= 2


def test_a_pentagram_is_refused():
    """It bends one way only, but turns round twice."""
    with pytest.raises(ValueError, match="a polygon must not cross or touch itself, got a meeting at "):
        Polygon(PENTAGRAM)


# By how many degrees the corners of a parallelogram are off 90, and its kind.
ANGLES = {"square": (0, "rectangle"), "1.9 degrees": (1.9, "rectangle"), "2.1 degrees": (2.1, "polygon")}


@pytest.mark.parametrize(("off", "kind"), ANGLES.values(), ids=ANGLES)
def test_right_angles_are_right_to_two_degrees(off, kind):
    """A parallelogram: its four corners are off by as much, two either way."""
    shear = math.tan(math.radians(off))
    assert Polygon([(0, 0), (3, 0), (3 + shear, 1), (shear, 1)]).kind == kind
    assert Polygon([(0, 0), (3, 0), (3 - shear, 1), (-shear, 1)]).kind == kind


@given(anything)
def test_a_kind_says_how_many_corners_there_are_and_how_they_bend(polygon):
    n, bends = len(polygon.vertices), np.degrees(polygon.turns)
    assert bends.sum() == pytest.approx(360)
    convex = shapely.Polygon(polygon.vertices).convex_hull.area - polygon.area < 1e-12 * polygon.area + 1e-15
    expected = {3: "triangle", 4: "rectangle", 5: "pentagon" if convex else "polygon"}.get(n, "polygon")
    if n == 4 and np.abs(bends - 90).max() > 2:
        expected = "polygon"
    assert polygon.kind == expected
    n_dimensions = 2 if polygon.kind == "rectangle" else n
    assert len(polygon.dimensions) == n_dimensions
    if n_dimensions == n:
        assert polygon.dimensions == tuple(polygon.sides)


@given(anything, st.floats(0.01, 100), clouds)
def test_a_larger_polygon_is_the_same_but_larger(polygon, scale, points):
    larger = Polygon(polygon.vertices * scale)
    assert larger.kind == polygon.kind
    assert larger.dimensions == pytest.approx(np.multiply(scale, polygon.dimensions), rel=1e-9)
    assert larger.centroid == pytest.approx(scale * polygon.centroid, rel=1e-9, abs=1e-9 * scale)
    np.testing.assert_allclose(larger.turns, polygon.turns, atol=1e-9)
    away = polygon.signed_distance(points)
    np.testing.assert_allclose(larger.signed_distance(points * scale) / scale, away, atol=1e-9)


@given(anything, clouds)
def test_a_mirrored_polygon_is_mirrored_in_all(polygon, points):
    """Corners and sides come in the other order, the first corner first."""
    mirror = np.array([-1.0, 1.0])
    other = Polygon(polygon.vertices * mirror)
    assert other.kind == polygon.kind
    assert other.area == pytest.approx(polygon.area, rel=1e-9)
    assert other.centroid == pytest.approx(polygon.centroid * mirror, abs=1e-9)
    assert other.vertices.tolist() == (np.roll(polygon.vertices[::-1], 1, axis=0) * mirror).tolist()
    assert other.sides == pytest.approx(polygon.sides[::-1])
    np.testing.assert_allclose(other.turns, np.roll(polygon.turns[::-1], 1), atol=1e-9)
    np.testing.assert_allclose(other.signed_distance(points * mirror), polygon.signed_distance(points), atol=1e-12)


POLYGON_DISTANCES = {  # from the rectangle [0, 4] x [0, 2]
    "middle": ((2, 1), -1),
    "near a side": ((3.5, 1), -0.5),
    "on a side": ((4, 1), 0),
    "on a corner": ((4, 2), 0),
    "beside a side": ((5.5, 1), 1.5),
    "off a corner, 3-4-5": ((7, 6), 5),
    "off a corner, along a side's line": ((6, 2), 2),
    "below": ((1, -3), 3),
}


@pytest.mark.parametrize(("point", "distance"), POLYGON_DISTANCES.values(), ids=POLYGON_DISTANCES)
def test_polygon_signed_distance(point, distance):
    rectangle = Polygon([(0, 0), (4, 0), (4, 2), (0, 2)])
    assert rectangle.signed_distance([point]).tolist() == pytest.approx([distance], abs=1e-15)


@given(anything)
def test_polygon_against_shapely(polygon):
    other = polygon.to_shapely()
    assert other.is_valid
    assert other.exterior.is_ccw
    assert polygon.area == pytest.approx(other.area, rel=1e-9)
    assert polygon.perimeter == pytest.approx(other.length, rel=1e-12)
    assert polygon.centroid == pytest.approx((other.centroid.x, other.centroid.y), abs=1e-9)
    farthest = shapely.hausdorff_distance(shapely.Point(polygon.centroid), other.exterior)
    assert polygon.reach == pytest.approx(farthest, rel=1e-12)


@given(anything, clouds)
def test_polygon_signed_distance_against_shapely(polygon, points):
    other, places = polygon.to_shapely(), shapely.points(points)
    away = shapely.distance(other.exterior, places)
    expected = np.where(shapely.contains(other, places), -away, away)
    np.testing.assert_allclose(polygon.signed_distance(points), expected, rtol=1e-12, atol=1e-12)


@given(circles, clouds)
def test_circle_signed_distance_against_shapely(circle, points):
    expected = shapely.distance(shapely.Point(circle.center), shapely.points(points)) - circle.radius
    np.testing.assert_allclose(circle.signed_distance(points), expected, rtol=1e-12, atol=1e-12)


@given(anything)
def test_normals_are_unit_vectors_that_point_outwards(polygon):
    np.testing.assert_allclose(np.linalg.norm(polygon.normals, axis=1), 1, rtol=1e-12)
    middles = polygon.vertices + polygon.edges / 2
    np.testing.assert_allclose(polygon.signed_distance(middles + 1e-6 * polygon.normals), 1e-6, rtol=1e-6)
    np.testing.assert_allclose((polygon.normals * polygon.edges).sum(axis=1), 0, atol=1e-12)


# --- Outline ------------------------------------------------------------------------------------------------


@given(shapes, st.integers(1, 300))
def test_outline_points_are_on_the_outline(shape, n):
    points = shape.outline(n)
    assert points.shape == (n, 2)
    np.testing.assert_allclose(shape.signed_distance(points), 0, atol=1e-12)


@given(anything, st.integers(1, 300))
def test_polygon_outline_is_evenly_spaced(polygon, n):
    ring = polygon.to_shapely().exterior
    points = polygon.outline(n)
    assert points[0].tolist() == polygon.vertices[0].tolist()
    travelled = shapely.line_locate_point(ring, shapely.points(points[1:]))
    np.testing.assert_allclose(travelled, np.arange(1, n) * ring.length / n, rtol=1e-9)


@given(circles, st.integers(3, 300))
def test_circle_outline_is_evenly_spaced_and_counter_clockwise(circle, n):
    around = circle.outline(n) - circle.center
    assert around[0] == pytest.approx((circle.radius, 0))
    steps = np.angle([complex(*b) / complex(*a) for a, b in zip(around, np.roll(around, -1, axis=0), strict=True)])
    np.testing.assert_allclose(steps, 2 * np.pi / n, rtol=1e-9)


@pytest.mark.parametrize("shape", [Circle((0, 0), 1), Polygon(RIGHT)], ids=["circle", "polygon"])
def test_outline_has_200_points_unless_told_otherwise(shape):
    assert shape.outline().shape == (200, 2)


OUTLINE_FAILURES = {
    "none": (0, "n must be a whole number >= 1, got 0"),
    "negative": (-3, "n must be a whole number >= 1, got -3"),
    "a fraction": (2.5, "n must be a whole number >= 1, got 2.5"),
    "a whole float": (4.0, "n must be a whole number >= 1, got 4.0"),
    "a truth value": (True, "n must be a whole number >= 1, got True"),
    "text": ("9", "n must be a whole number >= 1, got '9'"),
    "None": (None, "n must be a whole number >= 1, got None"),
}


@pytest.mark.parametrize("shape", [Circle((0, 0), 1), Polygon(RIGHT)], ids=["circle", "polygon"])
@pytest.mark.parametrize(("n", "sentence"), OUTLINE_FAILURES.values(), ids=OUTLINE_FAILURES)
def test_outline_failure(shape, n, sentence):
    with pytest.raises(ValueError, match=exactly(sentence)):
        shape.outline(n)


# --- Moving -------------------------------------------------------------------------------------------------


def test_moved_turns_counter_clockwise_about_the_centroid():
    rectangle = Polygon([(0, 0), (4, 0), (4, 2), (0, 2)])  # centroid (2, 1)
    quarter = rectangle.moved(angle=np.pi / 2)
    np.testing.assert_allclose(quarter.vertices, [(3, -1), (3, 3), (1, 3), (1, -1)], atol=1e-15)
    shifted = rectangle.moved((10, -1))
    np.testing.assert_allclose(shifted.vertices, [(10, -1), (14, -1), (14, 1), (10, 1)], atol=1e-15)
    assert Circle((1, 2), 3).moved((10, -1), 0.7) == Circle((11, 1), 3)


@given(shapes)
def test_moved_by_nothing(shape):
    moved = shape.moved()
    assert moved.kind == shape.kind
    np.testing.assert_allclose(moved.outline(30), shape.outline(30), atol=1e-12)


@given(shapes, offsets, angles, clouds)
def test_moved_leaves_what_a_shape_is(shape, offset, angle, points):
    moved = shape.moved(offset, angle)
    assert moved.kind == shape.kind
    assert moved.dimensions == pytest.approx(shape.dimensions, rel=1e-9)
    assert moved.area == pytest.approx(shape.area, rel=1e-9)
    assert moved.perimeter == pytest.approx(shape.perimeter, rel=1e-9)
    assert moved.reach == pytest.approx(shape.reach, rel=1e-9)
    assert moved.centroid == pytest.approx(shape.centroid + offset, abs=1e-9)
    there = turned(points, angle, shape.centroid) + offset
    np.testing.assert_allclose(moved.signed_distance(there), shape.signed_distance(points), atol=1e-9)


@given(anything, offsets, angles)
def test_moved_there_and_back(polygon, offset, angle):
    back = polygon.moved(offset, angle).moved(np.negative(offset), -angle)
    np.testing.assert_allclose(back.vertices, polygon.vertices, atol=1e-12)


@given(anything, st.integers(0, 4), st.booleans(), st.booleans())
def test_order_and_first_corner_do_not_matter(polygon, first, clockwise, closed):
    corners = np.roll(polygon.vertices, first, axis=0)
    corners = corners[::-1] if clockwise else corners
    again = Polygon(np.vstack([corners, corners[:1]]) if closed else corners)
    assert again.vertices[0].tolist() == corners[0].tolist()
    assert {tuple(v) for v in again.vertices} == {tuple(v) for v in polygon.vertices}
    assert again.area == pytest.approx(polygon.area)
    assert again.centroid == pytest.approx(polygon.centroid, abs=1e-12)
    assert sorted(again.dimensions) == pytest.approx(sorted(polygon.dimensions))


def test_area_and_centroid_keep_their_digits_far_from_the_origin():
    there = np.array([2.0**30, -(2.0**30)])  # exact in floating point; the products of such numbers are not
    far = Polygon(np.array(HOUSE) / 8 + there)
    assert far.area == 16 / 64
    assert (far.centroid - there).tolist() == pytest.approx([2 / 8, 49 / 24 / 8], abs=2**-22)


MOVED_FAILURES = {
    "a number": (0.3, "offset must be two finite numbers (x, y), got 0.3"),
    "three numbers": ((1, 2, 3), "offset must be two finite numbers (x, y), got (1, 2, 3)"),
    "one for each corner": (RIGHT, "offset must be two finite numbers (x, y), got [(0, 0), (3, 0), (0, 4)]"),
    "NaN": ((NAN, 0), "offset must be two finite numbers (x, y), got (nan, 0)"),
    "infinity": ((0, INF), "offset must be two finite numbers (x, y), got (0, inf)"),
    "text": ("ab", "offset must be two finite numbers (x, y), got 'ab'"),
    "None": (None, "offset must be two finite numbers (x, y), got None"),
}


@pytest.mark.parametrize("shape", [Circle((0, 0), 1), Polygon(RIGHT)], ids=["circle", "polygon"])
@pytest.mark.parametrize(("offset", "sentence"), MOVED_FAILURES.values(), ids=MOVED_FAILURES)
def test_moved_failure(shape, offset, sentence):
    with pytest.raises(ValueError, match=exactly(sentence)):
        shape.moved(offset)


# --- Frozen, equal, hashed, shown ---------------------------------------------------------------------------


def test_a_shape_cannot_be_changed():
    corners, center = np.array(RIGHT, dtype=float), np.array([1.0, 2.0])
    polygon, circle = Polygon(corners), Circle(center, 1)
    corners[0], center[0] = 99, 99  # the caller's arrays are the caller's
    assert polygon == Polygon(RIGHT)
    assert circle == Circle((1, 2), 1)
    for array in (polygon.vertices, circle.center, circle.centroid):
        with pytest.raises(ValueError, match=exactly("assignment destination is read-only")):
            array[0] = 0
    for shape, field in ((polygon, "vertices"), (circle, "center"), (circle, "radius")):
        with pytest.raises(dataclasses.FrozenInstanceError):
            setattr(shape, field, 1)


def test_a_triangles_derived_arrays_are_the_callers_own():
    triangle = Polygon(RIGHT)
    triangle.centroid[:] = 0
    triangle.edges[:] = 0
    triangle.outline(5)[:] = 9
    assert triangle.centroid.tolist() == pytest.approx([1, 4 / 3])
    assert triangle.sides.tolist() == [3, 5, 4]


def test_int_input_is_promoted():
    whole = [Polygon(np.array(RIGHT, dtype=dtype)) for dtype in (np.int8, np.int64, np.uint16, np.float32)]
    assert set(whole) == {Polygon(RIGHT)}
    assert all(p.vertices.dtype == np.float64 for p in whole)
    circle = Circle(np.array([1, 2]), np.int32(3))
    assert (circle.center.dtype, type(circle.radius)) == (np.float64, float)
    assert circle.moved(np.array([1, 1])) == Circle((2, 3), 3)
    assert Polygon(np.array(RIGHT)).moved((1, 1)).vertices.dtype == np.float64


EQUALITIES = {
    "same circle": (Circle((1, 2), 3), Circle([1.0, 2.0], 3.0), True),
    "circle elsewhere": (Circle((1, 2), 3), Circle((1, 2.5), 3), False),
    "circle of another radius": (Circle((1, 2), 3), Circle((1, 2), 4), False),
    "circle one bit off": (Circle((1, 2), 3), Circle((1, 2), np.nextafter(3, 4)), False),
    "minus zero is zero, circle": (Circle((0.0, 1), 3), Circle((-0.0, 1), 3), True),
    "same polygon": (Polygon(RIGHT), Polygon(np.array(RIGHT)), True),
    "same ring, closed": (Polygon(RIGHT), Polygon([*RIGHT, RIGHT[0]]), True),
    "another first corner": (Polygon(RIGHT), Polygon(RIGHT[1:] + RIGHT[:1]), False),
    "another number of corners": (Polygon(RIGHT), Polygon(SQUARE), False),
    "polygon one bit off": (Polygon(RIGHT), Polygon([(0, 0), (3, 0), (0, np.nextafter(4, 5))]), False),
    "minus zero is zero, polygon": (Polygon(RIGHT), Polygon([(-0.0, 0), (3, -0.0), (-0.0, 4)]), True),
    "circle and polygon": (Circle((0, 0), 1), Polygon(RIGHT), False),
    "polygon and circle": (Polygon(RIGHT), Circle((0, 0), 1), False),
    "circle and its text": (Circle((0, 0), 1), "Circle((0, 0), 1)", False),
    "polygon and its corners": (Polygon(RIGHT), tuple(RIGHT), False),
}


@pytest.mark.parametrize(("one", "other", "equal"), EQUALITIES.values(), ids=EQUALITIES)
def test_equality_and_hash(one, other, equal):
    assert (one == other) is equal
    assert (one != other) is not equal
    if equal:
        assert hash(one) == hash(other)
    assert len({one, other}) == 1 + (not equal)


@given(shapes)
def test_equal_hash_after_copying(shape):
    for twin in (copy.copy(shape), copy.deepcopy(shape), pickle.loads(pickle.dumps(shape))):
        assert twin == shape
        assert hash(twin) == hash(shape)
        array = twin.center if isinstance(twin, Circle) else twin.vertices
        assert not array.flags.writeable


SHOWN = {
    "circle": (Circle((1, 2), 3), "Circle(center=(1, 2), radius=3)"),
    "circle of long numbers": (
        Circle((1 / 3, -0.002), 0.1234567),
        "Circle(center=(0.333333, -0.002), radius=0.123457)",
    ),
    "rounding's remainder is 0": (Circle((-1e-17, 1e-17), 1), "Circle(center=(0, 0), radius=1)"),
    "polygon": (Polygon(RIGHT), "Polygon([(0, 0), (3, 0), (0, 4)])"),
    "six corners": (
        Polygon([(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]),
        "Polygon([(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)])",
    ),
    "seven corners": (
        Polygon([(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2), (-1, 1)]),
        "Polygon([(0, 0), (2, 0), (2, 1), ... 7 corners])",
    ),
    "polygon of long numbers": (Polygon([(0, 0), (1 / 3, 0), (0, 1)]), "Polygon([(0, 0), (0.333333, 0), (0, 1)])"),
}


@pytest.mark.parametrize(("shape", "text"), SHOWN.values(), ids=SHOWN)
def test_shown(shape, text):
    assert repr(shape) == text


# --- Arguments ----------------------------------------------------------------------------------------------

POINTS = {
    "list of tuples": ([(1, 2), (3, 4)], [[1.0, 2.0], [3.0, 4.0]]),
    "whole numbers": (np.array([[1, 2]], dtype=np.uint8), [[1.0, 2.0]]),
    "empty list": ([], []),
    "empty tuple": ((), []),
    "empty array": (np.empty((0, 2)), []),
}


@pytest.mark.parametrize(("points", "expected"), POINTS.values(), ids=POINTS)
def test_as_points(points, expected):
    array = as_points(points)
    assert array.tolist() == expected
    assert (array.shape, array.dtype) == ((len(expected), 2), np.float64)


POINTS_FAILURES = {
    "NaN": ([(0, 0), (NAN, 1)], "points must be finite, got (nan, 1.0) in row 1"),
    "infinity, the first bad row is named": ([(0, INF), (NAN, 1)], "points must be finite, got (0.0, inf) in row 0"),
    "None among numbers": ([(None, 1)], "points must be numbers in an array of shape (N, 2), got [(None, 1)]"),
    "truth values": ([(True, False)], "points must be numbers in an array of shape (N, 2), got [(True, False)]"),
    "None": (None, "points must be numbers in an array of shape (N, 2), got None"),
    "one point without its row": ((1, 2), "points must have shape (N, 2), got shape (2,)"),
    "columns for rows": (np.zeros((2, 7)), "points must have shape (N, 2), got shape (2, 7)"),
    "three axes": (np.zeros((0, 2, 2)), "points must have shape (N, 2), got shape (0, 2, 2)"),
    "ragged": ([(1, 2), (3,)], "points must be numbers in an array of shape (N, 2), got [(1, 2), (3,)]"),
    "text": ("ab", "points must be numbers in an array of shape (N, 2), got 'ab'"),
    "numbers as text": ([("1", "2")], "points must be numbers in an array of shape (N, 2), got [('1', '2')]"),
    "bytes": ([(b"1", b"2")], "points must be numbers in an array of shape (N, 2), got [(b'1', b'2')]"),
    "a dictionary": ({1: 2}, "points must be numbers in an array of shape (N, 2), got {1: 2}"),
    "complex": ([(1j, 0)], "points must be numbers in an array of shape (N, 2), got [(1j, 0)]"),
    "too large for a float": (
        [(HUGE, 0)],
        f"points must be numbers in an array of shape (N, 2), got [(1{'0' * 54}...",
    ),
}


@pytest.mark.parametrize(("points", "sentence"), POINTS_FAILURES.values(), ids=POINTS_FAILURES)
def test_as_points_failure(points, sentence):
    for use in (as_points, Circle((0, 0), 1).signed_distance, Polygon(RIGHT).signed_distance):
        with pytest.raises(ValueError, match=exactly(sentence)):
            use(points)


def test_as_points_calls_them_what_the_user_does():
    with pytest.raises(ValueError, match=exactly("corners must have shape (N, 2), got shape ()")):
        as_points(3, "corners")


def test_as_point():
    assert as_point((1, 2), "center").tolist() == [1.0, 2.0]


def test_as_point_failure():
    with pytest.raises(ValueError, match=exactly("goal must be two finite numbers (x, y), got (1, inf)")):
        as_point((1, INF), "goal")


POSES = {
    "one pose alone": ((1, 2, 3), [[1.0, 2.0, 3.0]]),
    "two poses": ([(1, 2, 3), (4, 5, 6)], [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]),
    "none": ([], []),
    "none, with its shape": (np.empty((0, 3)), []),
}


@pytest.mark.parametrize(("poses", "expected"), POSES.values(), ids=POSES)
def test_as_poses(poses, expected):
    array = as_poses(poses)
    assert array.tolist() == expected
    assert (array.shape, array.dtype) == ((len(expected), 3), np.float64)


NO_POSES = "poses must be numbers in an array of shape (P, 3): x, y, heading"
POSES_FAILURES = {
    "without a heading": ([(1, 2)], "poses must have shape (P, 3): x, y, heading; got shape (1, 2)"),
    "flat": ((1, 2, 3, 4, 5, 6), "poses must have shape (P, 3): x, y, heading; got shape (6,)"),
    "None": (None, NO_POSES + ", got None"),
    "NaN": ([(0, 0, 0), (0, 0, NAN)], "poses must be finite, got (0.0, 0.0, nan) in row 1"),
    "infinity": ((INF, 0, 0), "poses must be finite, got (inf, 0.0, 0.0) in row 0"),
    "text": ("abc", NO_POSES + ", got 'abc'"),
    "numbers as text": (
        ("1", "2", "3"),
        NO_POSES + ", got ('1', '2', '3')",
    ),
    "ragged": (
        [(1, 2, 3), (1, 2)],
        NO_POSES + ", got [(1, 2, 3), (1, 2)]",
    ),
    "too large for a float": (
        (HUGE, 0, 0),
        NO_POSES + f", got {short((HUGE, 0, 0))}",
    ),
}


@pytest.mark.parametrize(("poses", "sentence"), POSES_FAILURES.values(), ids=POSES_FAILURES)
def test_as_poses_failure(poses, sentence):
    with pytest.raises(ValueError, match=exactly(sentence)):
        as_poses(poses)


def test_as_positive():
    assert [as_positive(v, "v") for v in (3, 0.5, np.float32(0.25), np.int8(2), 5e-324)] == [3, 0.5, 0.25, 2, 5e-324]
    assert as_positive(0, "v", zero=True) == 0


POSITIVE_FAILURES = {
    "zero": (0, False, "v must be a finite number > 0, got 0"),
    "below zero": (-1e-9, True, "v must be a finite number >= 0, got -1e-09"),
    "NaN": (NAN, True, "v must be a finite number >= 0, got nan"),
    "infinite": (INF, True, "v must be a finite number >= 0, got inf"),
    "text": ("1", True, "v must be a finite number >= 0, got '1'"),
    "false": (False, True, "v must be a finite number >= 0, got False"),
    "None": (None, True, "v must be a finite number >= 0, got None"),
    "too large for a float": (HUGE, False, f"v must be a finite number > 0, got 1{'0' * 56}..."),
}


@pytest.mark.parametrize(("value", "zero", "sentence"), POSITIVE_FAILURES.values(), ids=POSITIVE_FAILURES)
def test_as_positive_failure(value, zero, sentence):
    with pytest.raises(ValueError, match=exactly(sentence)):
        as_positive(value, "v", zero=zero)


def test_as_count():
    assert [as_count(v, "n") for v in (1, 7, np.int64(4), np.uint8(2))] == [1, 7, 4, 2]
    assert (as_count(0, "n", least=0), as_count(3, "n", least=3)) == (0, 3)


COUNT_FAILURES = {
    "below the least": (2, 3, "n must be a whole number >= 3, got 2"),
    "numpy's truth value": (np.True_, 1, "n must be a whole number >= 1, got np.True_"),
    "NaN": (NAN, 0, "n must be a whole number >= 0, got nan"),
    "a list": ([1], 0, "n must be a whole number >= 0, got [1]"),
}


@pytest.mark.parametrize(("value", "least", "sentence"), COUNT_FAILURES.values(), ids=COUNT_FAILURES)
def test_as_count_failure(value, least, sentence):
    with pytest.raises(ValueError, match=exactly(sentence)):
        as_count(value, "n", least=least)


def test_short_cuts_at_sixty_signs():
    assert short("x" * 58) == repr("x" * 58)
    assert short("x" * 59) == "'" + "x" * 56 + "..."


def test_the_memory_of_distances_does_not_grow_with_corners_times_points():
    """A thousand corners and 50,000 points are 400 MB in each array, all at once."""
    angles = np.arange(1000) * 2 * np.pi / 1000
    ring = Polygon(0.1 * np.column_stack([np.cos(angles), np.sin(angles)]))
    points = np.random.default_rng(0).uniform(-0.2, 0.2, (50_000, 2))
    tracemalloc.start()
    distance = ring.signed_distance(points)
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert most < 40e6
    np.testing.assert_allclose(distance, Circle((0, 0), 0.1).signed_distance(points), atol=1e-6)
    np.testing.assert_array_equal(distance[::1000], ring.signed_distance(points[::1000]))
