"""A glance: it says what thorough fitting says, or nothing; rivals wait until the margin is asked for."""

import pickle
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import minimize

import primkit as pk
from primkit.pipeline import find_again
from primkit.robust import candidates as explain
from primkit.robust import choice, regroup
from primkit.robust import first_fit as glance
from primkit.robust.candidates import candidates
from primkit.robust.first_fit import APART, BENT, at_a_glance, at_another_glance
from primkit.robust.scatter import LEAST_SPREAD, spread_across
from primkit.robust.starts import best_cuts

KINDS = ("circle", "triangle", "rectangle", "pentagon")
THOROUGH = replace(pk.ROBUST, thorough=True)
AS_GOOD = 0.00005  # m: a twentieth of a cell


def shape_of(seed, kind):
    return pk.random_world(1, style="free", kinds=[kind], rng=seed).shapes[0]


def seen_on_cells(shape, n, noise, rng):
    """Points of an outline, moved by noise, in the middle of their cells; no point twice."""
    points = shape.outline(n) + rng.normal(0, noise, (n, 2))
    return np.unique((np.floor(points * 1000) + 0.5) / 1000, axis=0)


def points_of(world, rng=0, **sensor):
    grid = pk.Grid()
    grid.add(pk.scan(world, pk.teleport_poses(world), pk.Lidar(**sensor), rng=rng))
    return grid.points()


def assert_as_good(ours, thorough):
    assert ours.kind == thorough.kind
    np.testing.assert_allclose(sorted(ours.shape.dimensions), sorted(thorough.shape.dimensions), atol=AS_GOOD)
    np.testing.assert_allclose(ours.shape.centroid, thorough.shape.centroid, atol=AS_GOOD)


@pytest.mark.parametrize("noise", [0.0, 0.001, 0.002])
@settings(max_examples=25)
@given(seed=st.integers(0, 10_000), kind=st.sampled_from(KINDS), n=st.integers(60, 500))
def test_a_glance_says_what_thorough_fitting_says_or_nothing(noise, seed, kind, n):
    points = seen_on_cells(shape_of(seed, kind), n, noise, np.random.default_rng(seed))
    spread = spread_across(noise)
    best = at_a_glance(points, spread)
    if best is not None:
        assert_as_good(best, candidates(points, spread, rng=0)[0])


@pytest.mark.parametrize("kind", KINDS)
def test_most_outlines_without_noise_are_told_at_a_glance(kind):
    told = 0
    for seed in range(40):
        shape = shape_of(seed, kind)
        best = at_a_glance(seen_on_cells(shape, 250, 0.0, np.random.default_rng(seed)), LEAST_SPREAD)
        told += best is not None
        assert best is None or best.kind == kind
    assert told >= 34, told


@pytest.mark.parametrize("noise_std", [0.0, 0.002])
@pytest.mark.parametrize("seed", range(6))
def test_find_shapes_finds_the_same_as_the_thorough_way(seed, noise_std):
    world = pk.random_world(1 + seed, style="free", gap=0.03, rng=700 + seed)
    points = points_of(world, noise_std=noise_std, spurious=0.01 * (seed % 2))
    found, thorough = pk.find_shapes(points, rng=0), pk.find_shapes(points, settings=THOROUGH, rng=0)
    assert len(found) == len(thorough)
    for ours, theirs in zip(found, thorough, strict=True):
        assert_as_good(ours, theirs)


DOUBTFUL = {
    "too few points": (pk.Circle((0, 0), 0.05).outline(40), LEAST_SPREAD),
    "blurred": (pk.Circle((0, 0), 0.05).outline(200), 0.004),
    "a stretch not seen": (pk.Circle((0, 0), 0.05).outline(200)[:150], LEAST_SPREAD),
    "a side not seen": (pk.Polygon([(0, 0), (0.2, 0), (0.2, 0.1), (0, 0.1)]).outline(300)[:240], LEAST_SPREAD),
    "many strays": (
        np.vstack([pk.Circle((0, 0), 0.05).outline(150), np.random.default_rng(0).uniform(-0.04, 0.04, (30, 2))]),
        LEAST_SPREAD,
    ),
    "a wall": (np.column_stack([np.linspace(0, 0.3, 200), np.zeros(200)]), LEAST_SPREAD),
    "two shapes": (
        np.vstack([pk.Circle((0, 0), 0.05).outline(150), pk.Circle((0.11, 0), 0.05).outline(150)]),
        LEAST_SPREAD,
    ),
    "no shape of the board": (
        np.column_stack([0.1 * np.cos(a := np.arange(200) * np.pi / 100), 0.05 * np.sin(a)]),
        LEAST_SPREAD,
    ),
    "one place": (np.full((100, 2), 0.1), LEAST_SPREAD),
}


@pytest.mark.parametrize(("points", "spread"), DOUBTFUL.values(), ids=DOUBTFUL)
def test_what_is_in_doubt_is_left_to_thorough_fitting(points, spread):
    assert at_a_glance(points, spread) is None


@pytest.mark.parametrize("kind", KINDS)
def test_a_few_strays_are_left_out_of_the_look_and_weighed_in_the_fit(kind):
    told = 0
    for seed in range(15):
        shape, rng = shape_of(seed, kind), np.random.default_rng(seed)
        strays = shape.outline(250)[rng.integers(250, size=4)] + rng.uniform(-0.02, 0.02, (4, 2))  # linked, as such are
        points = np.vstack([seen_on_cells(shape, 250, 0.0, rng), strays])
        best = at_a_glance(points, LEAST_SPREAD)
        told += best is not None
        if best is not None:
            assert_as_good(best, candidates(points, LEAST_SPREAD, rng=0)[0])
    assert told >= 9, told


def test_the_order_of_the_points_leaves_no_trace_on_the_kind():
    points = seen_on_cells(shape_of(3, "pentagon"), 250, 0.0, np.random.default_rng(3))
    one, other = at_a_glance(points, LEAST_SPREAD), at_a_glance(points[::-1], LEAST_SPREAD)
    assert_as_good(one, other)


def test_rivals_are_fitted_when_the_margin_is_asked_for_and_only_once(monkeypatch):
    fitted = []
    real = choice.candidates
    monkeypatch.setattr(choice, "candidates", lambda *a, **k: fitted.append(1) or real(*a, **k))
    points = points_of(pk.World([pk.Circle((0.1, 0.0), 0.06)]))
    (found,) = pk.find_shapes(points, rng=0)
    assert fitted == []
    margin = found.margin
    assert found.margin == margin
    assert fitted == [1]
    (thorough,) = pk.find_shapes(points, settings=THOROUGH, rng=0)
    assert margin == pytest.approx(thorough.margin, rel=1e-3)
    assert margin > 100


def test_the_margin_survives_being_sent_elsewhere():
    """Another process that opens a pickled detection comes to the same margin, to the last bit."""
    (found,) = pk.find_shapes(points_of(pk.World([pk.Circle((0.1, 0.0), 0.06)])), rng=0)
    sent = pickle.loads(pickle.dumps(found))
    assert sent.margin == found.margin
    assert pickle.loads(pickle.dumps(found)).margin == found.margin


def test_a_glance_fits_once_where_thorough_fitting_fits_all(monkeypatch):
    judged = []
    for module in (explain, glance):
        real = module.judged
        monkeypatch.setattr(module, "judged", lambda *a, real=real, **k: judged.append(1) or real(*a, **k))
    points = seen_on_cells(shape_of(1, "pentagon"), 300, 0.0, np.random.default_rng(1))
    assert at_a_glance(points, LEAST_SPREAD).kind == "pentagon"
    assert judged == [1]
    candidates(points, LEAST_SPREAD, rng=0)
    assert len(judged) >= 6


@pytest.mark.parametrize("seed", range(4))
def test_a_rectangle_misses_a_triangle_by_as_much_as_is_supposed(seed):
    """The rectangle that comes closest, found by search, is still farther than APART times the incircle's radius."""
    triangle = shape_of(seed, "triangle")
    points, middle = triangle.outline(200), triangle.centroid
    incircle = 2 * triangle.area / triangle.perimeter

    def missed(frame):
        x, y, turn, width, height = frame
        c, s = np.cos(turn), np.sin(turn)
        out = np.abs((points - (x, y)) @ np.array([[c, -s], [s, c]])) - np.abs((width, height))
        distance = np.hypot(*np.maximum(out, 0).T) + np.minimum(out.max(axis=1), 0)
        return np.sqrt((distance**2).mean())

    turns = np.arctan2(triangle.edges[:, 1], triangle.edges[:, 0])
    starts = [(*middle, turn, size, 0.6 * size) for turn in turns for size in (incircle, 2 * incircle)]
    best = min(minimize(missed, start, method="Nelder-Mead").fun for start in starts)
    assert best > 1.9 * APART * incircle


@pytest.mark.parametrize("kind", KINDS[1:])
def test_the_best_cut_is_the_polygon(kind):
    for seed in range(10):
        shape = shape_of(seed, kind)
        points = shape.outline(300) - shape.centroid
        k = len(shape.vertices)
        cut = best_cuts(points)[k]
        assert cut.squares < 1e-9
        found = cut.outline.polygon().vertices + shape.centroid
        gaps = np.hypot(*np.moveaxis(found[:, None] - shape.vertices, 2, 0))
        assert gaps.min(axis=1).max() < 1e-6


def test_more_pieces_come_closer():
    cuts = best_cuts(pk.Circle((0, 0), 0.05).outline(240))
    assert cuts[3].squares > 2 * cuts[4].squares > 4 * cuts[5].squares
    rms = np.sqrt(cuts[5].squares / 240)
    assert rms == pytest.approx(0.0588 * 0.05, rel=0.3)  # a chord over a fifth of a circle, away from its ends


@pytest.mark.parametrize("kind", KINDS)
def test_what_was_told_at_a_glance_grows_with_a_few_points(kind):
    """Another glance at more points says what a first glance at all of them says."""
    told = 0
    for seed in range(15):
        rng = np.random.default_rng(seed)
        points = seen_on_cells(shape_of(seed, kind), 300, 0.001, rng)
        first = rng.permutation(len(points))[: int(0.95 * len(points))]
        before, spread = at_a_glance(points[np.sort(first)], spread_across(0.001)), spread_across(0.001)
        best = None if before is None else at_another_glance(points, before, spread)
        told += best is not None
        if best is not None:
            assert_as_good(best, candidates(points, spread, rng=0)[0])
    assert told >= 9, told


def test_another_glance_leaves_what_has_come_into_doubt():
    """Points beside the outline, or none along a side that grew, are for a first glance to judge."""
    ring = pk.Circle((0, 0), 0.05).outline(200)
    before = at_a_glance(ring, LEAST_SPREAD)
    beside = pk.Circle((0, 0), 0.044).outline(10)
    assert at_another_glance(np.vstack([ring, beside[:2]]), before, LEAST_SPREAD) is not None
    assert at_another_glance(np.vstack([ring, beside]), before, LEAST_SPREAD) is None
    assert at_another_glance(ring[:150], before, LEAST_SPREAD) is None


def test_a_growing_group_is_not_looked_at_anew(monkeypatch):
    looks = []
    real = regroup.at_a_glance
    monkeypatch.setattr(regroup, "at_a_glance", lambda *a, **k: looks.append(1) or real(*a, **k))
    ring = pk.Circle((0.1, 0.0), 0.06).outline(200)
    warm = {}
    for n in (190, 195, 200):
        (found,) = find_again(ring[np.random.default_rng(0).permutation(200)[:n]], warm, rng=0)
        assert found.kind == "circle"
    assert looks == [1]
    assert found.margin > 100  # rivals are fitted to all points, when it is asked for


def test_how_sure_numbers_are_is_worked_out_when_it_is_asked_for_and_only_once(monkeypatch):
    asked = []
    real = choice.certainty
    monkeypatch.setattr(choice, "certainty", lambda *a, **k: asked.append(1) or real(*a, **k))
    (found,) = pk.find_shapes(points_of(pk.World([pk.Circle((0.1, 0.0), 0.06)])), rng=0)
    assert asked == []
    std = found.dimension_std
    assert found.measured == (True,)
    assert len(found.center_std) == 2
    assert asked == [1]
    assert pickle.loads(pickle.dumps(found)).dimension_std == std


@given(seed=st.integers(0, 10_000), n=st.integers(60, 400))
def test_five_straight_pieces_miss_a_circle_by_as_much_as_is_supposed(seed, n):
    """Also where points lie unevenly: at most so many times denser on one side than on the other."""
    bearing = np.arange(n) * 2 * np.pi / n
    bearing += 0.4 * np.sin(bearing + seed)
    points = 0.05 * np.column_stack([np.cos(bearing), np.sin(bearing)])
    points -= points.mean(axis=0)
    radius = np.sqrt((points**2).sum() / n)
    assert np.sqrt(best_cuts(points)[5].squares / n) > 1.3 * BENT * radius


@pytest.mark.parametrize("kind", KINDS[1:])
def test_no_circle_is_fitted_where_straight_pieces_come_too_close_for_one(monkeypatch, kind):
    fitted = []
    real = glance.fit_circle
    monkeypatch.setattr(glance, "fit_circle", lambda *a: fitted.append(1) or real(*a))
    for seed in range(20):
        at_a_glance(seen_on_cells(shape_of(seed, kind), 300, 0.0, np.random.default_rng(seed)), LEAST_SPREAD)
    assert len(fitted) <= 10
