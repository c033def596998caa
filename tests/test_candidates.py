"""Candidates: branch and bound says what thorough fitting says; rivals wait until the margin is asked for."""

import pickle
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import primkit as pk
from primkit.pipeline import find_again
from primkit.robust import candidates as bounded
from primkit.robust import choice
from primkit.robust.candidates import candidates, explained_again
from primkit.robust.cuts import best_cuts, chords, in_company, outlines_with
from primkit.robust.scatter import LEAST_SPREAD, spread_across

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


@pytest.mark.parametrize("noise", [0.0, 0.001, 0.002, 0.005])
@settings(max_examples=20)
@given(seed=st.integers(0, 10_000), kind=st.sampled_from(KINDS), n=st.integers(60, 500))
def test_what_may_win_is_fitted(noise, seed, kind, n):
    """The best of those that were fitted is the best of all."""
    points = seen_on_cells(shape_of(seed, kind), n, noise, np.random.default_rng(seed))
    spread = spread_across(noise)
    best, thorough = (candidates(points, spread, thorough=thorough)[0] for thorough in (False, True))
    assert best.cost == pytest.approx(thorough.cost, abs=0.1) or thorough.cost > best.cost
    if best.kind == thorough.kind:
        assert_as_good(best, thorough)


@pytest.mark.parametrize("noise", [0.0, 0.005])
@pytest.mark.parametrize("kind", KINDS)
def test_outlines_seen_all_around_are_told(kind, noise):
    told = 0
    for seed in range(40):
        points = seen_on_cells(shape_of(seed, kind), 250, noise / 1.4, np.random.default_rng(seed))
        told += candidates(points, spread_across(noise), thorough=False)[0].kind == kind
    assert told >= 38, told


@pytest.mark.parametrize("noise_std", [0.0, 0.002])
@pytest.mark.parametrize("seed", range(6))
def test_find_shapes_finds_the_same_as_the_thorough_way(seed, noise_std):
    world = pk.random_world(1 + seed, style="free", gap=0.03, rng=700 + seed)
    points = points_of(world, noise_std=noise_std, spurious=0.01 * (seed % 2))
    found, thorough = pk.find_shapes(points, rng=0), pk.find_shapes(points, settings=THOROUGH, rng=0)
    assert len(found) == len(thorough)
    for ours, theirs in zip(found, thorough, strict=True):
        assert_as_good(ours, theirs)


def test_two_sides_at_right_angles_are_a_rectangle_s():
    """Not a triangle's, whose third side nobody has seen: it has one number more to explain as much."""
    for seed in range(5):
        width, height = np.random.default_rng(seed).uniform(0.1, 0.3, 2)
        corner = np.array([(width, 0.0), (0.0, 0.0), (0.0, height)])
        sides = [np.linspace(a, b, 150) for a, b in pairwise(corner)]
        [one] = pk.find_shapes(np.unique((np.vstack(sides) // 0.001 + 0.5) * 0.001, axis=0), rng=0)
        assert one.kind == "rectangle"
        assert one.margin > 0
        assert not one.certain


@pytest.mark.parametrize("kind", KINDS)
def test_a_few_strays_are_left_out_of_the_look_and_weighed_in_the_fit(kind):
    for seed in range(15):
        shape, rng = shape_of(seed, kind), np.random.default_rng(seed)
        strays = shape.outline(250)[rng.integers(250, size=12)] + rng.uniform(
            -0.02, 0.02, (12, 2)
        )  # linked, as such are
        clean = seen_on_cells(shape, 250, 0.0, rng)
        best = candidates(np.vstack([clean, strays]), LEAST_SPREAD, thorough=False)[0]
        assert best.kind == kind
        assert np.abs(best.shape.signed_distance(clean)).max() < 0.0015


@pytest.mark.parametrize("kind", KINDS)
def test_a_tail_of_strays_leads_no_fit_astray(kind):
    """One point in six lies beside the outline: what has no company is left out."""
    shape, rng = shape_of(3, kind), np.random.default_rng(3)
    clean = seen_on_cells(shape, 200, 0.0, rng)
    tail = shape.centroid + rng.uniform((0.02, -0.05), (0.4, 0.05), (40, 2))
    best = candidates(np.vstack([clean, tail]), LEAST_SPREAD, thorough=False)[0]
    assert best.kind == kind
    assert np.abs(best.shape.signed_distance(clean)).max() < 0.0015
    assert in_company(clean, LEAST_SPREAD).all()


def test_the_order_of_the_points_leaves_no_trace_on_the_kind():
    points = seen_on_cells(shape_of(3, "pentagon"), 250, 0.0, np.random.default_rng(3))
    one, other = (candidates(p, LEAST_SPREAD, thorough=False)[0] for p in (points, points[::-1]))
    assert_as_good(one, other)


def test_rivals_are_fitted_when_the_margin_is_asked_for_and_only_once(monkeypatch):
    all_kinds = []
    real = choice.candidates
    monkeypatch.setattr(
        choice, "candidates", lambda *a, **k: all_kinds.append(k.get("thorough", True)) or real(*a, **k)
    )
    points = points_of(pk.World([pk.Circle((0.1, 0.0), 0.06)]))
    (found,) = pk.find_shapes(points, rng=0)
    assert all_kinds == [False]
    margin = found.margin
    assert found.margin == margin
    assert all_kinds == [False, True]
    (thorough,) = pk.find_shapes(points, settings=THOROUGH, rng=0)
    assert margin == pytest.approx(thorough.margin, rel=1e-3)
    assert margin > 100


def test_the_margin_survives_being_sent_elsewhere():
    """Another process that opens a pickled detection comes to the same margin, to the last bit."""
    (found,) = pk.find_shapes(points_of(pk.World([pk.Circle((0.1, 0.0), 0.06)])), rng=0)
    sent = pickle.loads(pickle.dumps(found))
    assert sent.margin == found.margin
    assert pickle.loads(pickle.dumps(found)).margin == found.margin


@pytest.mark.parametrize("kind", KINDS)
def test_one_figure_is_judged_where_thorough_fitting_judges_all(monkeypatch, kind):
    judged = []
    real = bounded.judged
    monkeypatch.setattr(bounded, "judged", lambda *a, **k: judged.append(1) or real(*a, **k))
    points = seen_on_cells(shape_of(1, kind), 300, 0.0, np.random.default_rng(1))
    candidates(points, LEAST_SPREAD, thorough=False)
    assert len(judged) <= 3
    judged.clear()
    candidates(points, LEAST_SPREAD)
    assert len(judged) >= 5


@pytest.mark.parametrize("kind", KINDS[1:])
def test_the_best_cut_is_the_polygon(kind):
    for seed in range(10):
        shape = shape_of(seed, kind)
        points = shape.outline(300) - shape.centroid
        k = len(shape.vertices)
        cuts = best_cuts(points)
        assert cuts[k].squares < 1e-9
        found = outlines_with(cuts, [], k).polygon().vertices + shape.centroid
        gaps = np.hypot(*np.moveaxis(found[:, None] - shape.vertices, 2, 0))
        assert gaps.min(axis=1).max() < 1e-6


def test_more_pieces_come_closer():
    cuts = best_cuts(pk.Circle((0, 0), 0.05).outline(240))
    assert cuts[3].squares > 2 * cuts[4].squares > 4 * cuts[5].squares
    rms = np.sqrt(cuts[5].squares / 240)
    assert rms == pytest.approx(0.0588 * 0.05, rel=0.3)  # a chord over a fifth of a circle, away from its ends


def test_no_piece_spans_a_side_that_was_not_seen():
    """The farthest points stand at its ends: cut between the last two of them, the first piece would begin beyond."""
    left, bottom, right = (np.arange(n) * 0.004 for n in (10, 25, 21))
    sides = [(0.0, 0.04 - y) for y in left], [(x, 0.0) for x in bottom], [(0.1, y) for y in right]
    points = np.vstack(sides)
    assert best_cuts(points - points.mean(axis=0))[3].squares < 1e-12


def test_a_side_that_was_not_seen_is_a_chord():
    """Three sides of a rectangle and the chord over the fourth; or of a triangle two, and the third."""
    for corners, hidden in (([(0, 0), (0.2, 0), (0.2, 0.1), (0, 0.1)], 1), ([(0, 0), (0.2, 0), (0, 0.2)], 1)):
        shape = pk.Polygon(corners)
        points = shape.outline(400)
        points = points[np.abs((points - shape.vertices[hidden]) @ shape.normals[hidden]) > 1e-3]
        ordered = points - shape.centroid
        spans = chords(ordered)
        assert len(spans) == 1
        outline = outlines_with(best_cuts(ordered), spans, len(corners))
        found = outline.polygon(1).vertices + shape.centroid
        assert max(np.hypot(*(found - corner).T).min() for corner in shape.vertices) < 0.003


@pytest.mark.parametrize("kind", KINDS)
def test_what_grows_by_a_few_points_is_fitted_anew_from_what_it_was(kind):
    for seed in range(10):
        rng = np.random.default_rng(seed)
        points, spread = seen_on_cells(shape_of(seed, kind), 300, 0.001, rng), spread_across(0.001)
        first = np.sort(rng.permutation(len(points))[: int(0.95 * len(points))])
        before = candidates(points[first], spread, thorough=False)
        assert_as_good(explained_again(points, before, spread)[0], candidates(points, spread, thorough=False)[0])


def test_what_has_come_into_doubt_is_not_grown():
    """Points beside the outline, or a stretch that is no longer there, are looked at anew."""
    ring = pk.Circle((0, 0), 0.05).outline(200)
    old = choice.explained(ring, LEAST_SPREAD, thorough=False)
    beside = pk.Circle((0, 0), 0.044).outline(10)
    assert choice.grown(old, np.vstack([ring, beside[:2]]), LEAST_SPREAD) is not None
    assert choice.grown(old, np.vstack([ring, beside]), LEAST_SPREAD) is None
    assert choice.grown(old, ring[:150], LEAST_SPREAD) is None


def test_a_growing_group_is_not_looked_at_anew(monkeypatch):
    looks = []
    real = choice.candidates
    monkeypatch.setattr(choice, "candidates", lambda *a, **k: looks.append(1) or real(*a, **k))
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


@pytest.mark.parametrize(("degrees", "told"), [(48, False), (55, False), (70, True)])
def test_no_arc_below_sixty_degrees_is_a_circle(degrees, told):
    """What is seen of it looks longer, by as much at each end as a point is near to."""
    bearing = np.radians(np.linspace(0, degrees, 60))
    arc = 0.08 * np.column_stack([np.cos(bearing), np.sin(bearing)])
    assert ("circle" in [one.kind for one in candidates(arc, LEAST_SPREAD)]) == told
