"""Refinement: greedy guesses become the least-squares fit, corners are not stolen, strays do not pull."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import primkit as pk
from primkit.robust.cuts import features_of
from primkit.robust.outlines import Outlines
from primkit.robust.refine import one_side_more, refine_hard, refine_soft, refit, shares
from tests.test_outlines import outline_of

TENTH_OF_A_CELL = 1e-4  # m: shares blur a corner a little even where the points are exact


def polygon_of(seed, kinds=("triangle", "rectangle", "pentagon")):
    return pk.random_world(1, style="free", kinds=[kinds[seed % len(kinds)]], rng=seed).shapes[0]


def shaken(outline, rng, angle=0.05, offset=0.004):
    return Outlines(
        outline.angles + rng.uniform(-angle, angle, outline.angles.shape),
        outline.offsets + rng.uniform(-offset, offset, outline.offsets.shape),
    )


@settings(max_examples=60)
@given(st.integers(0, 10_000))
def test_exact_points_lead_back_to_the_exact_sides(seed):
    polygon, rng = polygon_of(seed), np.random.default_rng(seed)
    middle = polygon.centroid
    points, truth = polygon.outline(300) - middle, outline_of(polygon.moved(-middle))
    refined = refine_soft(points, refine_hard(points, shaken(truth, rng), 0.015), 0.0003)
    np.testing.assert_allclose(refined.corners(), truth.corners(), atol=TENTH_OF_A_CELL)


def test_refitting_is_total_least_squares_on_the_points_of_each_side():
    polygon, rng = polygon_of(4, ("pentagon",)), np.random.default_rng(0)
    truth = outline_of(polygon)
    points = polygon.outline(200) + rng.normal(0, 0.001, (200, 2))
    owner = truth.distances(points)[0].argmax(axis=1)
    fitted = refit(features_of(points), np.eye(5)[owner][None], truth)
    for side in range(5):
        own = points[owner == side]
        _, axes = np.linalg.eigh(np.cov((own - own.mean(axis=0)).T))
        normal = np.array([np.cos(fitted.angles[0, side]), np.sin(fitted.angles[0, side])])
        assert abs(normal @ axes[:, 0]) == pytest.approx(1, abs=1e-12)
        assert fitted.offsets[0, side] == pytest.approx(normal @ own.mean(axis=0), abs=1e-12)


def test_a_side_without_points_stays_where_it_was():
    square = Outlines(np.arange(4)[None] * np.pi / 2, np.full((1, 4), 0.1))
    points = np.array([(0.09, y) for y in np.linspace(-0.1, 0.1, 20)])
    weights = np.zeros((1, 20, 4))
    weights[0, :, 0] = 1
    fitted = refit(features_of(points), weights, square)
    assert fitted.offsets[0].round(12).tolist() == [0.09, 0.1, 0.1, 0.1]
    assert fitted.angles[0, 1:].tolist() == square.angles[0, 1:].tolist()


@settings(max_examples=40)
@given(st.integers(0, 10_000))
def test_a_square_fit_has_right_angles_and_the_least_squares_bearing(seed):
    rng = np.random.default_rng(seed)
    rectangle = polygon_of(seed, ("rectangle",))
    middle = rectangle.centroid
    truth = outline_of(rectangle.moved(-middle))
    points = rectangle.outline(240) - middle + rng.normal(0, 0.001, (240, 2))
    start = Outlines(truth.angles[:, :1] + 0.02 + np.arange(4) * np.pi / 2, truth.offsets)
    owner = truth.distances(points)[0].argmax(axis=1)
    fitted = refit(features_of(points), np.eye(4)[owner][None], start, square=True)
    np.testing.assert_allclose(np.diff(fitted.angles[0]), np.pi / 2, atol=1e-12)

    def cost(turn):  # offsets are the means for any bearing: the bearing alone is searched
        angles = fitted.angles[0] + turn
        r = points @ np.array([np.cos(angles), np.sin(angles)])
        own = [r[owner == side, side] for side in range(4)]
        return sum(((v - v.mean()) ** 2).sum() for v in own)

    assert cost(0.0) <= min(cost(-1e-4), cost(1e-4))


def test_hard_pushes_noisy_corners_outwards_and_soft_does_not():
    """Giving each point to the side it lies farther out of is biased around corners; shares are not."""
    triangle = pk.Polygon([(-0.08, -0.05), (0.08, -0.05), (0.0, 0.09)])
    triangle = triangle.moved(-triangle.centroid)
    truth, rng = outline_of(triangle), np.random.default_rng(1)
    hard, soft = [], []
    for _ in range(60):
        points = triangle.outline(200) + rng.normal(0, 0.005, (200, 2))
        guess = refine_hard(points, truth, 0.02)
        hard.append(np.mean(guess.offsets - truth.offsets))
        soft.append(np.mean(refine_soft(points, guess, 0.005).offsets - truth.offsets))
    assert np.mean(hard) > 0.0002
    assert abs(np.mean(soft)) < 0.0001


@pytest.mark.parametrize("noise", [0.001, 0.004, 0.01])
def test_leaps_end_where_small_steps_end(noise):
    """Leaping saves rounds, and must change nothing else."""
    for seed in range(6):
        polygon, rng = polygon_of(seed), np.random.default_rng(seed)
        middle = polygon.centroid
        points = polygon.outline(250) - middle + rng.normal(0, noise, (250, 2))
        start = shaken(outline_of(polygon.moved(-middle)), rng, 0.02, 0.002)
        slow = start
        for _ in range(400):
            share, told, _ = shares(points, slow, noise)
            slow = refit(features_of(points), share * told, slow)
        np.testing.assert_allclose(refine_soft(points, start, noise).corners(), slow.corners(), atol=1e-5)


def test_strays_do_not_pull():
    polygon, rng = polygon_of(3), np.random.default_rng(3)
    middle = polygon.centroid
    points, truth = polygon.outline(200) - middle, outline_of(polygon.moved(-middle))
    strays = rng.uniform(-0.12, 0.12, (8, 2))
    strays = strays[np.abs(polygon.moved(-middle).signed_distance(strays)) > 0.01]
    refined = refine_soft(np.vstack([points, strays]), truth, 0.0005)
    np.testing.assert_allclose(refined.corners(), truth.corners(), atol=TENTH_OF_A_CELL)


def test_shares_are_shares_and_likelihood_falls_with_distance():
    square = Outlines(np.arange(4)[None] * np.pi / 2, np.full((1, 4), 0.1))
    points = np.array([(0.1, 0.0), (0.1, 0.1), (0.0, 0.0), (0.102, 0.0)])
    share, _, near = shares(points, square, 0.001)
    assert (share >= 0).all()
    assert (share.sum(axis=2) <= 1).all()
    assert share[0, 0].round(2).tolist() == [1, 0, 0, 0]  # on a side
    assert share[0, 1, 0] == pytest.approx(share[0, 1, 1])  # on a corner: half and half
    assert share[0, 2].sum() < 1e-6  # in the middle: from nowhere
    assert share[0, 3, 0] < 1.0
    farther_out = np.array([(0.102, 0.0)])
    assert shares(farther_out, square, 0.001)[2] < shares(points[:1], square, 0.001)[2]
    assert np.isfinite(near).all()


def test_the_density_of_one_point_integrates_to_the_outlines_length():
    """Over the plane, what does not come from nowhere adds up to 98 % of perimeter / typical length."""
    square = Outlines(np.arange(4)[None] * np.pi / 2, np.full((1, 4), 0.05))
    axis = np.linspace(-0.1, 0.1, 401)
    points = np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2)
    share, _, _ = shares(points, square, 0.004)
    nowhere = 0.02 / 0.05
    density = share.sum(axis=2) * nowhere / np.maximum(1 - share.sum(axis=2), 1e-300)
    assert density.sum() * (axis[1] - axis[0]) ** 2 == pytest.approx(0.98 * 0.4 / 0.5, abs=1e-3)


def test_truncated_cost_by_hand():
    square = Outlines(np.arange(4)[None] * np.pi / 2, np.full((1, 4), 0.1))
    points = np.array([(0.1, 0.0), (0.103, 0.0), (0.0, 0.0)])
    assert square.truncated_cost(points, 0.01)[0] == pytest.approx(0.003**2 + 0.01**2)


def test_points_out_of_reach_do_not_count():
    """A row of strays beside a side would pull it; beyond the reach they do not."""
    square = Outlines(np.arange(4)[None] * np.pi / 2, np.full((1, 4), 0.1))
    ring = pk.Polygon([(-0.1, -0.1), (0.1, -0.1), (0.1, 0.1), (-0.1, 0.1)]).outline(160)
    beside = np.column_stack([np.full(30, 0.13), np.linspace(-0.09, 0.09, 30)])
    points = np.vstack([ring, beside])
    assert refine_hard(points, square, 0.01).offsets[0].round(6).tolist() == [0.1] * 4
    assert refine_hard(points, square, 0.05).offsets[0, 0] > 0.105


def test_one_side_more_finds_the_short_side_that_was_missed():
    """A pentagon whose short side a fit with four sides left out: one of the guesses leads to it."""
    pentagon = pk.Polygon([(0, 0), (0.2, 0), (0.23, 0.03), (0.2, 0.12), (0.02, 0.15)])
    points = pentagon.outline(500) - pentagon.centroid
    truth = outline_of(pentagon.moved(-pentagon.centroid))
    for missed in range(5):
        kept = np.delete(np.arange(5), missed)
        four = Outlines(truth.angles[:, kept], truth.offsets[:, kept])
        if not four.sound()[0]:
            continue
        guesses = one_side_more(points, refine_hard(points, four, 0.02))
        assert len(guesses) == 8
        refined = refine_hard(points, guesses, 0.005)
        corners = [o.corners() for o in (refined[i : i + 1] for i in np.flatnonzero(refined.sound()))]
        gaps = [np.abs(np.sort(c[0], axis=0) - np.sort(truth.corners()[0], axis=0)).max() for c in corners]
        assert min(gaps) < 0.001, missed


@pytest.mark.parametrize("spread", [0.0005, 0.003])
def test_an_outline_that_would_stop_being_sound_stays_as_it_was(spread):
    """A fifth side that cuts a corner off a square, where no corner is cut off, turns away."""
    square = pk.Polygon([(-0.05, -0.05), (0.05, -0.05), (0.05, 0.05), (-0.05, 0.05)])
    angles = np.array([[-np.pi / 2, 0, np.pi / 4, np.pi / 2, np.pi]])
    guess = Outlines(angles, np.array([[0.05, 0.05, 0.058, 0.05, 0.05]]))
    assert guess.sound().all()
    assert refine_soft(square.outline(200), guess, spread).sound().all()
