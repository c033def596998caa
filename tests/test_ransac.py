"""The consensus loop, against every pair and every triple of points there is."""

from fractions import Fraction
from itertools import combinations, permutations

import numpy as np
import pytest
from scipy.stats import chi2

from primkit import ransac
from primkit.circles import CIRCLE
from primkit.lines import LINE
from primkit.ransac import Model, draw_samples, run_ransac, trials_needed
from tests.helpers import exactly

NAN, INF = float("nan"), float("inf")


def ring(n, x=0.0, y=0.0, radius=1.0):
    theta = np.arange(n) * 2 * np.pi / n
    return np.column_stack([x + radius * np.cos(theta), y + radius * np.sin(theta)])


def cluttered(seed, n_on=14, n_off=10, noise=0.01, round_=False):
    """Points on a wall or a ring, with noise, among others anywhere."""
    rng = np.random.default_rng(seed)
    if round_:
        theta = rng.uniform(0, 2 * np.pi, n_on)
        on = np.column_stack([np.cos(theta), np.sin(theta)])
    else:
        on = np.outer(rng.uniform(-1, 1, n_on), (np.cos(seed), np.sin(seed))) + rng.uniform(-0.3, 0.3, 2)
    return rng.permutation(np.vstack([on + noise * rng.normal(size=on.shape), rng.uniform(-1, 1, (n_off, 2))]))


# --- the oracle: all samples there are, with formulas of its own --------------------------------------------


def distance_to_line(points, a, b):
    """Twice the area of the triangle over its base."""
    along, across = b - a, points - a
    return np.abs(along[0] * across[:, 1] - along[1] * across[:, 0]) / np.hypot(*along)


def distance_to_circle(points, a, b, c):
    """The centre is as far from a as from b and c: two linear equations."""
    center = np.linalg.solve(2 * np.array([b - a, c - a]), [b @ b - a @ a, c @ c - a @ a])
    return np.abs(np.hypot(*(points - center).T) - np.hypot(*(a - center)))


def every_sample(points, size):
    distance = distance_to_line if size == 2 else distance_to_circle
    return np.array([distance(points, *sample) for sample in combinations(points, size)])


def most_inliers(points, size, threshold):
    return int((every_sample(points, size) <= threshold).sum(axis=1).max())


@pytest.mark.parametrize("threshold", [0.005, 0.02, 0.1])
@pytest.mark.parametrize("seed", range(5))
def test_enough_trials_find_the_best_of_all_pairs(seed, threshold):
    points = cluttered(seed)  # 24 points, 276 pairs: each is missed once in e^18 runs
    found = run_ransac(points, LINE, threshold, trials=5000, refit=False, rng=seed)
    assert np.count_nonzero(found.inliers) == most_inliers(points, 2, threshold)


def test_enough_trials_find_the_best_of_all_pairs_of_100_points():
    points = cluttered(9, n_on=40, n_off=60)
    found = run_ransac(points, LINE, 0.01, trials=60_000, refit=False, rng=0)
    assert np.count_nonzero(found.inliers) == most_inliers(points, 2, 0.01)


@pytest.mark.parametrize("threshold", [0.005, 0.02, 0.1])
@pytest.mark.parametrize("seed", range(4))
def test_enough_trials_find_the_best_of_all_triples(seed, threshold):
    points = cluttered(seed, round_=True)  # 24 points, 2024 triples
    found = run_ransac(points, CIRCLE, threshold, trials=30_000, refit=False, rng=seed)
    assert np.count_nonzero(found.inliers) == most_inliers(points, 3, threshold)


@pytest.mark.parametrize(("model", "size"), [(LINE, 2), (CIRCLE, 3)], ids=["lines", "circles"])
@pytest.mark.parametrize("seed", range(5))
def test_few_trials_find_no_more_than_there_is(seed, model, size):
    points = cluttered(seed, round_=size == 3)
    best = most_inliers(points, size, 0.03)
    counts = [np.count_nonzero(run_ransac(points, model, 0.03, trials=t, refit=False, rng=0).inliers) for t in (1, 9)]
    assert size <= counts[0] <= counts[1] <= best


@pytest.mark.parametrize(("model", "size"), [(LINE, 2), (CIRCLE, 3)], ids=["lines", "circles"])
@pytest.mark.parametrize("seed", range(4))
def test_the_truncated_score_finds_the_least_truncated_sum_of_squares(seed, model, size):
    points, threshold = cluttered(seed, round_=size == 3), 0.03
    best = (np.minimum(every_sample(points, size), threshold) ** 2).sum(axis=1).min()
    found = run_ransac(points, model, threshold, trials=30_000, score="truncated", refit=False, rng=seed)
    residuals = model.residuals(found.params[None], points)[0]
    assert (np.minimum(residuals, threshold) ** 2).sum() == pytest.approx(best, rel=1e-9)


def test_the_truncated_score_asks_how_well_the_inliers_fit():
    """Two walls with six points each; on the upper one they lie 4 mm to either side."""
    rough = [(x, 1 + 0.004 * (-1) ** x) for x in range(6)]
    smooth = [(x, 0.0) for x in range(6)]
    found = run_ransac(rough + smooth, LINE, 0.01, trials=500, score="truncated", refit=False, rng=0)
    assert found.inliers.tolist() == [False] * 6 + [True] * 6


def test_of_samples_with_as_many_inliers_the_first_is_kept(monkeypatch):
    walls = [*((x, 0) for x in range(5)), *((x, 1) for x in range(5))]
    lower, upper, across = (0, 4), (9, 6), (0, 6)
    on_lower = [True] * 5 + [False] * 5
    for samples, kept in (([across, lower, upper], on_lower), ([across, upper, lower], on_lower[::-1])):
        monkeypatch.setattr(ransac, "draw_samples", lambda *_, samples=samples: np.array(samples))
        assert run_ransac(walls, LINE, 0.1, refit=False).inliers.tolist() == kept


# --- the boundary -------------------------------------------------------------------------------------------

DIRECTIONS = {"horizontal": 0.0, "vertical": np.pi / 2, "diagonal": np.pi / 4, "steep": 1.3, "backwards": np.pi}


@pytest.fixture
def inliers_of(monkeypatch):
    """Which points agree with the model through the given ones: RANSAC with that one sample."""

    def inliers_of(points, model, sample, threshold):
        monkeypatch.setattr(ransac, "draw_samples", lambda *_: np.array([sample]))
        return run_ransac(points, model, threshold, trials=1, refit=False).inliers.tolist()

    return inliers_of


@pytest.mark.parametrize("angle", DIRECTIONS.values(), ids=DIRECTIONS)
@pytest.mark.parametrize("threshold", [0.0, 0.005, 0.1, 0.25])
def test_a_point_at_the_threshold_agrees(inliers_of, threshold, angle):
    """Regression: cos(pi / 2) is 6e-17, and a point just at the threshold was in or out by the wall's direction."""
    along, across = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
    start = np.array([0.1, 0.3])
    wall = start + np.outer([0.0, 0.3, 0.7, 1.1, 2.9], along)
    beside = [start + 1.4 * along + side * across for side in (threshold, -threshold)]
    beyond = [start + 1.4 * along + side * across for side in (threshold + 1e-6, -threshold - 1e-6)]
    agreeing = inliers_of(np.vstack([wall, beside, beyond]), LINE, [0, 4], threshold)
    assert agreeing == [True] * 7 + [False] * 2


def test_five_cells_from_a_wall_agree_in_every_row_of_the_grid(inliers_of):
    """Centres of 1 mm cells, the published threshold: 5 cells is 5 mm in every row and column."""
    cells = np.arange(20)
    for start in range(-400, 400, 37):
        wall = np.column_stack([cells, np.full(20, start)])
        points = (np.vstack([wall, [(30, start + 5), (31, start - 5), (32, start + 6)]]) + 0.5) * 0.001
        for turned in (points, points[:, ::-1]):
            assert inliers_of(turned, LINE, [0, 19], 0.005) == [True] * 22 + [False]


@pytest.mark.parametrize("radius", [0.05, 0.1, 0.3])
def test_a_point_at_the_threshold_of_a_circle_agrees(inliers_of, radius):
    beside = [(0.2 + radius + side, -0.1) for side in (0.005, -0.005)]
    beyond = [(0.2 + radius + side, -0.1) for side in (0.005 + 1e-6, -0.005 - 1e-6)]
    points = np.vstack([ring(6, 0.2, -0.1, radius), beside, beyond])
    assert inliers_of(points, CIRCLE, [0, 2, 4], 0.005) == [True] * 8 + [False] * 2


def test_without_noise_a_threshold_of_nought_is_enough():
    points = [*((x / 10, 0.3) for x in range(10)), (0.2, 0.4)]
    assert run_ransac(points, LINE, 0.0, trials=100, rng=0).inliers.tolist() == [True] * 10 + [False]


# --- what is reported ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("refit", [False, True], ids=["sampled", "refitted"])
@pytest.mark.parametrize("score", ["count", "truncated"])
@pytest.mark.parametrize("round_", [False, True], ids=["lines", "circles"])
@pytest.mark.parametrize("seed", range(3))
def test_the_inliers_belong_to_the_reported_model(seed, round_, score, refit):
    points, model = cluttered(seed, noise=0.02, round_=round_), CIRCLE if round_ else LINE
    found = run_ransac(points, model, 0.03, trials=60, score=score, refit=refit, rng=seed)
    a, b, *c = found.params
    if round_:
        distance = np.abs(np.hypot(points[:, 0] - a, points[:, 1] - b) - c[0])
    else:
        distance = np.abs(points[:, 0] * np.cos(a) + points[:, 1] * np.sin(a) - b)
    assert found.inliers.dtype == bool
    assert np.array_equal(found.inliers, distance <= 0.03)


@pytest.mark.parametrize("seed", range(10))
def test_refitting_gives_up_no_inliers_and_settles_on_its_own_fit(seed):
    points = cluttered(seed, noise=0.02)
    sampled = run_ransac(points, LINE, 0.03, trials=20, refit=False, rng=seed)
    refitted = run_ransac(points, LINE, 0.03, trials=20, rng=seed)
    assert np.count_nonzero(refitted.inliers) >= np.count_nonzero(sampled.inliers)
    settled = LINE.fit(points[refitted.inliers])
    if not np.array_equal(settled, refitted.params):  # unless its own fit would give up inliers
        agreeing = LINE.residuals(settled[None], points)[0] <= 0.03
        assert np.count_nonzero(agreeing) < np.count_nonzero(refitted.inliers)


def test_refitting_comes_nearer_to_the_truth():
    """On average over many walls: one pair of noisy points against the fit to all that agree."""
    errors = {False: [], True: []}
    for seed in range(40):
        rng = np.random.default_rng(seed)
        points = np.column_stack([rng.uniform(-1, 1, 50), 0.01 * rng.normal(size=50)])
        for refit in errors:
            angle = run_ransac(points, LINE, 0.03, trials=50, refit=refit, rng=seed).params[0]
            errors[refit].append(abs(np.cos(angle)))
    assert np.mean(errors[True]) < 0.5 * np.mean(errors[False])


@pytest.mark.parametrize("score", ["count", "truncated"])
@pytest.mark.parametrize(("model", "round_"), [(LINE, False), (CIRCLE, True)], ids=["lines", "circles"])
def test_the_same_seed_gives_the_same_bits(model, round_, score):
    points = cluttered(3, round_=round_)
    runs = [run_ransac(points, model, 0.02, score=score, rng=rng) for rng in (5, 5, np.random.default_rng(5))]
    assert len({run.params.tobytes() for run in runs}) == 1
    assert len({run.inliers.tobytes() for run in runs}) == 1


def test_the_generator_is_handed_on():
    """Two runs from one generator draw different samples."""
    points, rng = np.random.default_rng(0).uniform(size=(60, 2)), np.random.default_rng(1)
    a, b = (run_ransac(points, LINE, 0.01, trials=3, refit=False, rng=rng) for _ in range(2))
    assert a.params.tobytes() != b.params.tobytes()


@pytest.mark.parametrize("block", [1, 25, 1000, 10**9])
@pytest.mark.parametrize("score", ["count", "truncated"])
@pytest.mark.parametrize(("model", "round_"), [(LINE, False), (CIRCLE, True)], ids=["lines", "circles"])
def test_blocks_leave_no_trace(monkeypatch, model, round_, score, block):
    """Regression: as a matrix product, residuals differed in the last bit with the number of lines in a block."""
    points = np.round(cluttered(3, round_=round_), 3)  # on a grid: many points lie just at the threshold
    whole = run_ransac(points, model, 0.02, trials=300, score=score, refit=False, rng=0)
    monkeypatch.setattr(ransac, "RESIDUALS_AT_ONCE", block)
    blocks = run_ransac(points, model, 0.02, trials=300, score=score, refit=False, rng=0)
    assert blocks.params.tobytes() == whole.params.tobytes()
    assert blocks.inliers.tobytes() == whole.inliers.tobytes()


@pytest.mark.parametrize("model", [LINE, CIRCLE], ids=["lines", "circles"])
def test_a_residual_is_the_same_alone_and_among_others(model):
    points = cluttered(0)
    params = model.from_samples(points[draw_samples(24, model.sample_size, 200, np.random.default_rng(0))])
    together = model.residuals(params, points)
    assert together.shape == (200, 24)
    assert all(
        model.residuals(one[None], points).tobytes() == row.tobytes() for one, row in zip(params, together, strict=True)
    )


# --- nothing there ------------------------------------------------------------------------------------------

NOTHING = {
    "no points": (LINE, []),
    "one point for a line": (LINE, [(1, 1)]),
    "two points for a circle": (CIRCLE, [(0, 0), (1, 1)]),
    "all points equal, line": (LINE, [(0.1, 0.1)] * 5),
    "all points equal, circle": (CIRCLE, [(0.1, 0.1)] * 5),
    "two different points for a circle": (CIRCLE, [(0.1, 0.3), (0.1, 0.3), (0.2, 0.7), (0.2, 0.7)]),
    "collinear points for a circle": (CIRCLE, [(0, 0), (1, 1), (2, 2), (5, 5)]),
    "collinear up to rounding": (CIRCLE, [(0.1 * k, 0.3 * k + 0.1) for k in range(9)]),
    "collinear, far from the origin": (CIRCLE, [(1e6 + k, 1e6 + 2 * k) for k in range(9)]),
}


@pytest.mark.parametrize(("model", "points"), NOTHING.values(), ids=NOTHING)
def test_nothing_there(model, points):
    """Degenerate samples are set aside before anything is divided: a warning would be an error here."""
    assert run_ransac(points, model, 0.01, trials=200, rng=0) is None


def test_degenerate_samples_among_good_ones_are_set_aside():
    line = run_ransac([(0, 0)] * 30 + [(1, 0), (2, 0)], LINE, 0.0, trials=200, rng=0)
    assert line.inliers.all()
    circle = run_ransac([(x, 0) for x in range(-5, 6)] + [(0, 5)], CIRCLE, 1e-9, trials=500, refit=False, rng=0)
    assert circle.inliers[-1]  # every circle goes through the one point off the line
    assert np.count_nonzero(circle.inliers) == 3


def test_as_many_points_as_a_sample():
    assert run_ransac([(0, 0), (1, 1)], LINE, 0.0, trials=1, rng=0).inliers.tolist() == [True, True]
    found = run_ransac([(1, 0), (0, 1), (-1, 0)], CIRCLE, 0.0, trials=1, rng=0)
    assert found.params == pytest.approx([0, 0, 1], abs=1e-12)


def test_whole_numbers_are_as_good_as_others():
    points = [(0, 0), (4, 0), (9, 0), (3, 7)]
    runs = [run_ransac(np.array(points, dtype=t), LINE, 0.1, trials=50, rng=0) for t in (int, np.uint8, float)]
    assert len({run.params.tobytes() for run in runs}) == 1


FAILURES = {
    "NaN": ({"points": [(0, 0), (NAN, 1)]}, "points must be finite, got (nan, 1.0) in row 1"),
    "infinite": ({"points": [(0, INF)]}, "points must be finite, got (0.0, inf) in row 0"),
    "three columns": ({"points": np.zeros((4, 3))}, "points must have shape (N, 2), got shape (4, 3)"),
    "threshold below zero": ({"threshold": -0.1}, "threshold must be a finite number >= 0, got -0.1"),
    "threshold NaN": ({"threshold": NAN}, "threshold must be a finite number >= 0, got nan"),
    "threshold endless": ({"threshold": INF}, "threshold must be a finite number >= 0, got inf"),
    "threshold a word": ({"threshold": "5 mm"}, "threshold must be a finite number >= 0, got '5 mm'"),
    "no trial": ({"trials": 0}, "trials must be a whole number >= 1, got 0"),
    "half a trial": ({"trials": 0.5}, "trials must be a whole number >= 1, got 0.5"),
    "no model": ({"model": "line"}, "model must be a Model, such as lines.LINE, got str"),
    "a seed below zero": ({"rng": -1}, "rng must be a whole number >= 0 or a numpy Generator, got -1"),
    "unknown score": ({"score": "msac"}, 'score must be "count" or "truncated", got \'msac\''),
    "too few points are no excuse": ({"points": [], "trials": -1}, "trials must be a whole number >= 1, got -1"),
}


@pytest.mark.parametrize(("change", "sentence"), FAILURES.values(), ids=FAILURES)
def test_run_ransac_failure(change, sentence):
    arguments = {"points": [(0, 0), (1, 0), (2, 0)], "model": LINE, "threshold": 0.1, "trials": 5, "rng": 0} | change
    with pytest.raises(ValueError, match=exactly(sentence)):
        run_ransac(**arguments)


# --- a model of one's own -----------------------------------------------------------------------------------


def a_place(fit=lambda points: points.mean(axis=0), off=0.0):
    """A single point as a model, the simplest there is: residuals are distances from it, and ``off`` more."""
    return Model(
        sample_size=1,
        from_samples=lambda samples: samples[:, 0],
        residuals=lambda params, points: np.linalg.norm(points - params[:, None], axis=2) + off,
        fit=fit,
    )


HEAP = [(0, 0), (0.1, 0), (0, 0.1), (5, 5)]


def test_a_model_of_ones_own():
    found = run_ransac(HEAP, a_place(), 0.2, trials=50, rng=0)
    assert found.inliers.tolist() == [True, True, True, False]
    assert found.params == pytest.approx([1 / 30, 1 / 30])


def test_no_inliers_at_all_is_an_empty_consensus():
    """Every residual is above the threshold: the first candidate stands, nobody agrees, nothing is fitted."""
    found = run_ransac(HEAP, a_place(off=1.0), 0.2, trials=50, rng=0)
    assert found.inliers.tolist() == [False] * 4
    assert found.params.tolist() in np.array(HEAP).tolist()


def test_a_fit_that_fails_leaves_the_sampled_model():
    failing = a_place(fit=lambda _: np.full(2, np.nan))
    found = run_ransac(HEAP, failing, 0.2, trials=50, rng=0)
    assert found.params.tolist() in np.array(HEAP[:3]).tolist()
    assert found.inliers.tolist() == [True, True, True, False]


def test_a_fit_that_loses_inliers_leaves_the_sampled_model():
    worse = a_place(fit=lambda _: np.array([9.0, 9.0]))
    assert run_ransac(HEAP, worse, 0.2, trials=50, rng=0).inliers.tolist() == [True, True, True, False]


def test_a_fit_that_never_settles_is_stopped():
    """From one place to the next for ever, with as many inliers each time: what is reported still fits together."""
    row = np.column_stack([np.arange(100.0), np.zeros(100)])
    wandering = a_place(fit=lambda points: points.mean(axis=0) + np.array([1.0, 0.0]))
    found = run_ransac(row, wandering, 1.0, trials=1, rng=4)
    assert np.array_equal(found.inliers, np.abs(row[:, 0] - found.params[0]) <= 1.0)
    assert np.count_nonzero(found.inliers) == 3


# --- samples ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("n", "size"), [(1, 1), (2, 2), (3, 3), (5, 3), (9, 4), (1000, 2)])
def test_a_sample_has_different_points(n, size):
    samples = draw_samples(n, size, 2000, np.random.default_rng(0))
    assert samples.shape == (2000, size)
    assert samples.min() >= 0
    assert samples.max() < n
    assert all(len(set(sample)) == size for sample in samples.tolist())


@pytest.mark.parametrize(("n", "size"), [(4, 1), (5, 2), (5, 3), (4, 4), (6, 3)])
def test_every_ordered_sample_is_equally_likely(n, size):
    """Pearson's test over all n! / (n - size)! outcomes, at one in a thousand, with a fixed seed."""
    outcomes = list(permutations(range(n), size))
    draws = 500 * len(outcomes)
    codes = draw_samples(n, size, draws, np.random.default_rng(2)) @ (n ** np.arange(size))
    counts = [np.count_nonzero(codes == np.array(o) @ (n ** np.arange(size))) for o in outcomes]
    assert sum(counts) == draws
    statistic = sum((count - 500) ** 2 / 500 for count in counts)
    assert statistic < chi2.ppf(0.999, len(outcomes) - 1)


def test_samples_follow_from_the_seed():
    a, b = (draw_samples(50, 3, 100, np.random.default_rng(7)) for _ in range(2))
    assert a.tobytes() == b.tobytes()


# --- how many trials? ---------------------------------------------------------------------------------------

# Hartley and Zisserman (2004), "Multiple view geometry", table 4.3: trials for a confidence of 0.99, by sample
# size (rows) and share of outliers (columns).
OUTLIERS = (5, 10, 20, 25, 30, 40, 50)
TEXTBOOK = {
    2: (2, 3, 5, 6, 7, 11, 17),
    3: (3, 4, 7, 9, 11, 19, 35),
    4: (3, 5, 9, 13, 17, 34, 72),
    5: (4, 6, 12, 17, 26, 57, 146),
    6: (4, 7, 16, 24, 37, 97, 293),
    7: (4, 8, 20, 33, 54, 163, 588),
    8: (5, 9, 26, 44, 78, 272, 1177),
}


@pytest.mark.parametrize("size", TEXTBOOK)
def test_trials_needed_is_the_textbook_table(size):
    assert tuple(trials_needed(1 - share / 100, size) for share in OUTLIERS) == TEXTBOOK[size]


# By hand: the smallest N with (1 - w^m)^N <= 1 - p.
BY_HAND = {
    "p 0.95, a third good, lines": (1 / 3, 2, 0.95, 26),  # log 0.05 / log(8/9) = 25.4
    "p 0.99, a fifth good, lines": (0.2, 2, 0.99, 113),  # log 0.01 / log 0.96 = 112.8
    "p 0.999, half good, lines": (0.5, 2, 0.999, 25),  # log 0.001 / log 0.75 = 24.01
    "p 0.999, half good, circles": (0.5, 3, 0.999, 52),  # log 0.001 / log 0.875 = 51.7
    "p 0.99, a tenth good, circles": (0.1, 3, 0.99, 4603),  # log 0.01 / log 0.999 = 4602.9
    "p 0.5, half good, one point": (0.5, 1, 0.5, 1),  # just 1
    "p 0.75, half good, one point": (0.5, 1, 0.75, 2),  # just 2
    "all good": (1.0, 8, 0.999999, 1),
    "hardly any confidence": (0.9, 2, 1e-9, 1),
    "hardly any good": (1e-6, 3, 0.5, 693147180559945296),  # log 2 / 1e-18, to the last digit of a float
}


@pytest.mark.parametrize(("share", "size", "confidence", "trials"), BY_HAND.values(), ids=BY_HAND)
def test_trials_needed(share, size, confidence, trials):
    got = trials_needed(share, size, confidence)
    assert isinstance(got, int)
    assert got == pytest.approx(trials, rel=1e-12) if trials > 1e15 else got == trials


@pytest.mark.parametrize("confidence", [Fraction(1, 2), Fraction(19, 20), Fraction(99, 100), Fraction(999, 1000)])
@pytest.mark.parametrize("size", [1, 2, 3])
def test_trials_needed_is_the_least_number_that_is_enough(size, confidence):
    """By its definition, in exact fractions."""
    for percent in (17, 30, 45, 62, 71, 88, 97):
        miss = 1 - Fraction(percent, 100) ** size  # one sample is not clean
        trials = trials_needed(percent / 100, size, float(confidence))
        assert miss**trials <= 1 - confidence < miss ** (trials - 1)


TRIALS_FAILURES = {
    "no inliers": ((0, 2), "inlier_share must be above 0 and at most 1, got 0"),
    "below none": ((-0.5, 2), "inlier_share must be above 0 and at most 1, got -0.5"),
    "too few to count": ((1e-200, 2), "inlier_share must be large enough to draw a clean sample at all, got 1e-200"),
    "percent": ((50, 2), "inlier_share must be above 0 and at most 1, got 50"),
    "NaN": ((NAN, 2), "inlier_share must be above 0 and at most 1, got nan"),
    "no points": ((0.5, 0), "sample_size must be a whole number >= 1, got 0"),
    "half a point": ((0.5, 1.5), "sample_size must be a whole number >= 1, got 1.5"),
    "certain": ((0.5, 2, 1), "confidence must be between 0 and 1, got 1"),
    "no confidence": ((0.5, 2, 0.0), "confidence must be between 0 and 1, got 0"),
    "confidence in percent": ((0.5, 2, 99), "confidence must be between 0 and 1, got 99"),
    "confidence NaN": ((0.5, 2, NAN), "confidence must be between 0 and 1, got nan"),
}


@pytest.mark.parametrize(("arguments", "sentence"), TRIALS_FAILURES.values(), ids=TRIALS_FAILURES)
def test_trials_needed_failure(arguments, sentence):
    with pytest.raises(ValueError, match=exactly(sentence)):
        trials_needed(*arguments)


def test_as_many_trials_as_needed_find_the_line_as_often_as_promised():
    """Half the points on a wall, no noise: 17 trials at 0.99; in 400 runs 4 misses are expected, 12 are too many."""
    rng = np.random.default_rng(0)
    points = np.vstack([np.column_stack([rng.uniform(size=50), np.zeros(50)]), rng.uniform(0.1, 1, (50, 2))])
    trials = trials_needed(0.5, 2)
    missed = sum(not run_ransac(points, LINE, 1e-9, trials=trials, rng=seed).inliers[:50].all() for seed in range(400))
    assert missed <= 12
