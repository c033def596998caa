"""Your own function in the place of a step: what it gets, what it may return, and what it is told otherwise."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import primkit as pk
from primkit.steps import kept_kind, nearest_side
from tests.helpers import exactly
from tests.test_shapes import angles, anything, offsets

QUICK = pk.Settings(grouping="kmeans", method="published", line_trials=300)
WORLD = pk.random_world(4, kinds=["circle", "rectangle", "triangle", "circle"], rng=3)


def points_of(world, **sensor):
    grid = pk.Grid()
    grid.add(pk.scan(world, pk.teleport_poses(world), pk.Lidar(**sensor), rng=0))
    return grid.points()


POINTS = points_of(WORLD)
LABELS = pk.segment(POINTS, 4, rng=0)


def by_truth(points, _n_shapes):
    """Group points by the true outline they lie on."""
    return np.argmin([np.abs(shape.signed_distance(points)) for shape in WORLD.shapes], axis=0)


@pytest.mark.parametrize("settings", [pk.ROBUST, QUICK], ids=["robust", "paper"])
def test_the_truth_can_group(settings):
    found = pk.find_shapes(POINTS, 4, settings=settings, steps=pk.Steps(segment=by_truth), rng=0)
    usual = pk.find_shapes(POINTS, 4, settings=settings, rng=0)
    assert [d.shape for d in found] == [d.shape for d in usual]


@pytest.mark.parametrize("settings", [pk.ROBUST, QUICK], ids=["robust", "paper"])
def test_own_grouping_decides_what_belongs_together(settings):
    def left_only(points, n_shapes):
        assert n_shapes is None
        return np.where(by_truth(points, None) == 0, 17, -3)

    found = pk.find_shapes(POINTS, settings=settings, steps=pk.Steps(segment=left_only), rng=0)
    assert len(found) == 1
    assert found[0].shape.signed_distance([WORLD.shapes[0].centroid]) < 0


def test_all_points_can_be_strays():
    nothing = pk.Steps(segment=lambda points, _: np.full(len(points), -1))
    assert pk.find_shapes(POINTS, steps=nothing, rng=0) == []


@pytest.mark.parametrize("settings", [pk.ROBUST, QUICK], ids=["robust", "paper"])
@pytest.mark.parametrize("answer", [pk.Circle, lambda center, radius: (*center, radius)], ids=["Circle", "numbers"])
def test_own_circle_measures_the_circles_alone(settings, answer):
    steps = pk.Steps(fit_circle=lambda points: answer(points.mean(axis=0), 0.05))
    found = pk.find_shapes(POINTS, 4, settings=settings, steps=steps, rng=0)
    usual = pk.find_shapes(POINTS, 4, settings=settings, rng=0)
    for mine, theirs in zip(found, usual, strict=True):
        if theirs.kind == "circle":
            assert mine.shape.radius == 0.05
            assert mine.center_std == ()
        else:
            assert mine.shape == theirs.shape


def test_own_line_measures_the_sides():
    found = pk.find_shapes(POINTS, steps=pk.Steps(fit_line=pk.fit_line), rng=0)
    assert pk.evaluate(found, WORLD).weighted_accuracy == 1.0
    usual = pk.find_shapes(POINTS, rng=0)
    assert all((d.kind == "circle") == (d.shape == u.shape) for d, u in zip(found, usual, strict=True))


def test_own_line_may_return_two_numbers():
    def numbers(points):
        line = pk.fit_line(points)
        return line.angle, line.offset

    a, b = (pk.find_shapes(POINTS, steps=pk.Steps(fit_line=fit), rng=0) for fit in (pk.fit_line, numbers))
    assert [d.shape for d in a] == [d.shape for d in b]


def test_own_line_is_used_under_paper():
    seen = []

    def watched(points):
        seen.append(len(points))
        return pk.fit_line(points)

    pk.find_shapes(POINTS, 4, settings=QUICK, steps=pk.Steps(fit_line=watched), rng=0)
    assert len(seen) >= 10
    assert min(seen) >= 2


def test_a_side_that_was_hardly_seen_stays():
    square = pk.Polygon([(0, 0), (0.2, 0), (0.2, 0.2), (0, 0.2)])
    outline = square.outline(160)
    points = outline[outline[:, 0] > 1e-9]  # all but the side at x = 0
    found = pk.find_shapes(points, steps=pk.Steps(fit_line=pk.fit_line), rng=0)
    assert [d.kind for d in found] == ["rectangle"]


@pytest.mark.parametrize("step", ["fit_line", "fit_circle"])
def test_a_shape_that_the_own_fit_finds_nothing_for_is_left_out(step):
    found = pk.find_shapes(POINTS, steps=pk.Steps(**{step: lambda _points: None}), rng=0)
    kinds = {d.kind for d in found}
    assert kinds == ({"circle"} if step == "fit_line" else {"rectangle", "triangle"})


@pytest.mark.parametrize("times", [1, 10])
@pytest.mark.parametrize("settings", [pk.ROBUST, QUICK], ids=["robust", "paper"])
def test_an_own_measure_names_each_group_on_any_scale(settings, times):
    """The library's own, handed in: the same shapes; points that were not explained are strays, and none vanishes."""

    def measure(points):
        one = pk.measure_shape(points, 0.0004 * times, resolution=0.001 * times)
        return one.shape, one.margin

    steps = pk.Steps(measure=measure)
    points = times * POINTS
    found = pk.find_shapes(points, 4, resolution=0.001 * times, settings=settings, steps=steps, rng=0)
    true = pk.World(
        [
            pk.Polygon(times * s.vertices) if hasattr(s, "vertices") else pk.Circle(times * s.center, times * s.radius)
            for s in WORLD.shapes
        ],
        size=times,
    )
    assert pk.evaluate(found, true, 0.005 * times).weighted_accuracy == 1.0
    assert all(one.certain and one.margin > 10 for one in found)
    assert sum(len(one.points) for one in found) + len(found.strays) == len(points)


@pytest.mark.parametrize(("margin", "certain"), [(9.9, False), (10.0, True), (np.nan, False)])
def test_of_an_own_measure_the_margin_is_believed(margin, certain):
    steps = pk.Steps(measure=lambda p: (pk.Circle(p.mean(axis=0), 0.05), margin))
    assert {one.certain for one in pk.find_shapes(POINTS, steps=steps, rng=0)} == {certain}
    without = pk.Steps(measure=lambda p: pk.Circle(p.mean(axis=0), 0.05))
    assert not any(one.certain for one in pk.find_shapes(POINTS, steps=without, rng=0))
    assert pk.find_shapes(POINTS, steps=pk.Steps(measure=lambda _: None), rng=0) == []


@pytest.mark.parametrize(
    ("told", "message"),
    [("good", "got 'good'"), (1.2, "got 1.2"), (np.nan, "got nan"), ([1, 1], r"got \[1, 1\]")],
)
def test_a_score_that_is_none_is_refused(told, message):
    with pytest.raises(ValueError, match=f"score must return a number from 0 to 1, .*{message}"):
        pk.Steps(score=lambda _found, _world: told).judged([], WORLD)


def test_own_functions_cannot_change_the_points():
    def greedy(points, _n_shapes):
        points[:] = 0.0
        return np.zeros(len(points), dtype=int)

    with_it = pk.find_shapes(POINTS, 4, steps=pk.Steps(segment=greedy), rng=0)
    assert len(with_it) == 4


@pytest.mark.parametrize(
    ("steps", "message"),
    [
        ({"segment": 3}, "segment must be a function, got 3"),
        ({"segment": lambda p, _n: p}, "segment must return a whole number for each of the .* points, got float64 of"),
        ({"segment": lambda _p, _n: [0, 1]}, r"each of the \d+ points, got int64 of shape \(2,\)"),
        ({"segment": lambda _p, _n: None}, "each of the .* points, got object of shape"),
        ({"segment": lambda _p, _n: [[0], [0, 1]]}, "got nothing that is an array"),
        ({"fit_circle": lambda _p: (0, 0)}, r"fit_circle must return a Circle, \(x, y, radius\) or None, got \(0, 0\)"),
        ({"fit_circle": lambda _p: (0, 0, -1)}, r"with a radius > 0, got \(0, 0, -1\)"),
        ({"fit_circle": lambda _p: (0, 0, np.nan)}, r"fit_circle must return .* got \(0, 0, nan\)"),
        ({"fit_line": lambda _p: "y = 2x"}, r"fit_line must return a Line, \(angle, offset\) or None, got 'y = 2x'"),
        (
            {"measure": lambda _p: "round"},
            r"measure must return a Circle, a Polygon or None, or \(shape, margin\), got 'r",
        ),
        ({"measure": lambda _p: (pk.Circle((0, 0), 1), "sure")}, r"or \(shape, margin\), got \(Circle"),
        (
            {"fit_line": lambda p: (0.0, p[0, 0])},
            "fit_line's lines along the .* must meet in its corners, got angles 0, ",
        ),
    ],
)
def test_what_a_step_may_not_return_is_told_in_one_sentence(steps, message):
    with pytest.raises(ValueError, match=message):
        pk.find_shapes(POINTS, steps=pk.Steps(**steps), rng=0)


def test_steps_must_be_steps():
    with pytest.raises(ValueError, match=r"steps must be Steps, such as Steps\(fit_circle=mine\), got function"):
        pk.find_shapes(POINTS, steps=by_truth)


def test_points_go_to_the_nearest_side():
    triangle = pk.Polygon([(0, 0), (1, 0), (0, 1)])
    outline = triangle.outline(300) * 1.0
    nearest = nearest_side(triangle, outline)
    assert np.bincount(nearest).tolist() == pytest.approx(300 * triangle.sides / triangle.perimeter, abs=2)


# --- One fitted side by side keeps its kind ------------------------------------------------------------------


@given(anything)
def test_a_polygon_keeps_its_kind_and_its_corners(polygon):
    kept = kept_kind(polygon, polygon.moved((3, 1), 0.7))
    assert kept.kind == polygon.kind
    np.testing.assert_allclose(kept.vertices, polygon.vertices, atol=0.02 * polygon.reach)


@given(st.floats(0.05, 0.3), st.floats(0.05, 0.3), angles, offsets, st.integers(0, 10**6))
def test_a_measured_rectangle_gets_its_right_angles_and_keeps_the_rest(width, height, angle, offset, seed):
    true = pk.Polygon([(0, 0), (width, 0), (width, height), (0, height)]).moved(offset, angle)
    crooked = pk.Polygon(true.vertices + np.random.default_rng(seed).uniform(-0.008, 0.008, (4, 2)))
    square = kept_kind(crooked, true)
    assert square.kind == "rectangle"
    np.testing.assert_allclose(np.degrees(square.turns), 90, atol=1e-9)
    assert square.centroid == pytest.approx(crooked.centroid, abs=1e-12)
    means = sorted((crooked.sides[:2] + crooked.sides[2:]) / 2)[::-1]
    assert square.dimensions == pytest.approx(means, rel=1e-9)
    assert np.abs(square.signed_distance(crooked.vertices)).max() < 0.02
    np.testing.assert_allclose(kept_kind(true, true).vertices, true.vertices, atol=1e-12)


def test_sides_that_meet_in_another_outline_are_refused():
    dart, square = pk.Polygon([(0, 0), (4, -3), (1, 0), (4, 3)]), pk.Polygon([(0, 0), (1, 0), (1, 1), (0, 1)])
    with pytest.raises(ValueError, match=exactly("the rectangle's sides must bend as before at each corner")):
        kept_kind(dart, square)
