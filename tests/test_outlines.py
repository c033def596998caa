"""Outlines by their sides: distances, corners, soundness."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import primkit as pk
from primkit.robust.outlines import Outlines, from_angle_order, joined


def outline_of(polygon):
    """Return a polygon as one row of sides in normal form, through its vertices: no code shared with corners()."""
    normals = polygon.normals
    offsets = (normals * polygon.vertices).sum(axis=1)
    return from_angle_order(np.arctan2(normals[:, 1], normals[:, 0])[None], offsets[None])


@given(st.integers(0, 10_000))
def test_corners_come_back_from_the_sides_of_any_polygon(seed):
    kind = ("triangle", "rectangle", "pentagon")[seed % 3]
    polygon = pk.random_world(1, style="free", kinds=[kind], rng=seed).shapes[0]
    outline = outline_of(polygon)
    corners = outline.corners()[0]
    nearest = np.linalg.norm(corners[:, None] - polygon.vertices, axis=2).min(axis=0)
    assert nearest.max() < 1e-12
    assert outline.sound().tolist() == [True]
    assert outline.polygon().area == pytest.approx(polygon.area, rel=1e-12)


@given(st.integers(0, 10_000))
def test_the_largest_distance_over_the_sides_is_the_signed_distance_inside(seed):
    polygon = pk.random_world(1, style="free", kinds=["pentagon"], rng=seed).shapes[0]
    rng = np.random.default_rng(seed)
    points = polygon.centroid + rng.uniform(-0.02, 0.02, (50, 2))
    inside = polygon.signed_distance(points) < 0
    ours = outline_of(polygon).distances(points)[0].max(axis=1)
    np.testing.assert_allclose(ours[inside], polygon.signed_distance(points)[inside], atol=1e-15)


def test_spans_are_the_sides_lengths():
    polygon = pk.Polygon([(0, 0), (0.2, 0), (0.2, 0.1), (0, 0.1)])
    begin, end = outline_of(polygon).spans()
    assert sorted((end - begin)[0].round(12)) == [0.1, 0.1, 0.2, 0.2]


SQUARE = np.arange(4) * np.pi / 2
UNSOUND = {
    "sides in clockwise order": (SQUARE[::-1], [0.1] * 4),
    "all normals on one side: the outline is open": ([0.0, 0.4, 0.8, 1.2], [0.1] * 4),
    "two parallel neighbours": ([0.0, 0.0, 2.0, 4.0], [0.1, 0.1, 0.1, 0.1]),
    "a side cut away by its neighbours": (SQUARE, [0.1, 0.1, -0.2, 0.1]),
    "a plank of 1 mm": (SQUARE, [0.0005, 0.1, 0.0005, 0.1]),
    "a corner cut off by 1 cm": (np.radians([0, 45, 90, 180, 270]), [0.1, 0.1364, 0.1, 0.1, 0.1]),
    "a corner that bends by 10 degrees": (np.radians([0, 10, 130, 250]), [0.1] * 4),
    "twice round": (np.radians([0, 144, 288, 72, 216]), [0.1] * 5),
}


@pytest.mark.parametrize(("angles", "offsets"), UNSOUND.values(), ids=UNSOUND)
def test_unsound(angles, offsets):
    outline = Outlines(np.array([angles], dtype=float), np.array([offsets], dtype=float))
    assert outline.sound().tolist() == [False]


def test_moving_moves_every_corner():
    square = Outlines(SQUARE[None], np.full((1, 4), 0.1))
    offset = np.array([0.3, -0.2])
    np.testing.assert_allclose(square.moved(offset).corners(), square.corners() + offset, atol=1e-15)


def test_joined_keeps_the_order_and_selecting_selects():
    one, two = (Outlines(SQUARE[None], np.full((1, 4), d)) for d in (0.1, 0.2))
    both = joined(one, two)
    assert len(both) == 2
    assert both[1:].offsets.tolist() == two.offsets.tolist()


def of_corners(*corners):
    """Return the outline with these corners, shape (K, 2), counter-clockwise."""
    first, (x, y) = np.array(corners), (np.roll(corners, -1, axis=0) - corners).T
    angles = np.arctan2(-x, y)
    return Outlines(angles[None], (np.cos(angles) * first[:, 0] + np.sin(angles) * first[:, 1])[None])


def test_a_star_closes_though_it_is_not_convex():
    star = of_corners((0, -0.03), (0.1, -0.1), (0.03, 0), (0.1, 0.1), (-0.1, 0))
    assert star.closes().tolist() == [True]
    assert star.sound().tolist() == [False]


def test_a_t_is_a_t_and_a_z_may_as_well_be_two_bars():
    t = [(-2, 8), (-2, 3), (-9, 3), (-9, 0), (9, 0), (9, 3), (2, 3), (2, 8)]
    assert not any(of_corners(*np.roll(t, shift, axis=0)).of_two for shift in range(8))
    z = [(-2, 8), (-2, 3), (-9, 3), (-9, 0), (5, 0), (5, 3), (9, 3), (9, 8)]
    assert all(of_corners(*np.roll(z, shift, axis=0)).of_two for shift in range(8))
    assert of_corners((-2, 8), (-2, 3), (-9, 3), (-9, 0), (9, 0), (9, 3), (2, 3)).of_two  # a triangle on a bar
    assert not of_corners((0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)).of_two  # one bends inwards


def test_two_whose_corners_nearly_meet_are_not_one_with_a_neck():
    neck = [(-0.1, -0.05), (0, -0.001), (0.1, -0.08), (0.1, 0.08), (0, 0.001), (-0.08, 0.1)]
    assert of_corners(*neck).of_two
    wide = np.array(neck) + [(0, 0.02 * np.sign(y)) for _, y in neck]
    assert not of_corners(*wide).of_two


def test_what_runs_round_once_and_crosses_itself_does_not_close():
    """Two loops that turn against each other leave one turn in all."""
    knot = of_corners((0.1, 0.2), (0.1, 0.1), (0, 0.2), (0, 0.1), (0.2, 0.2), (0.2, 0.3))
    turns = np.mod(np.diff(knot.angles[0], append=knot.angles[0, 0]) + np.pi, 2 * np.pi) - np.pi
    assert turns.sum() == pytest.approx(2 * np.pi)
    assert knot.closes().tolist() == [False]
