"""Circles: four fits against textbook formulas written anew, and RANSAC against the library that the paper used."""

import types

import numpy as np
import pyransac3d
import pytest
import scipy.linalg
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import least_squares

import primkit as pk
from primkit.circles import CIRCLE, find_circle, fit_circle, nearer_circle, straightened
from primkit.ransac import draw_samples
from primkit.seen import seen_shares
from primkit.shapes import Circle
from tests.helpers import exactly

NAN, INF = float("nan"), float("inf")
METHODS = ["kasa", "pratt", "taubin", "geometric"]
FAIR = ["pratt", "taubin", "geometric"]  # those without Kasa's bias
every_method = pytest.mark.parametrize("method", METHODS)
seeds = st.integers(0, 2**32 - 1)


def arc(degrees=360.0, n=100, noise=0.0, rng=0, *, x=0.0, y=0.0, radius=1.0, start=0.0):
    """n points along an arc; noise is radial, in radii."""
    rng = np.random.default_rng(rng)
    theta = start + np.radians(degrees) * (np.arange(n) + 0.5) / n
    r = radius * (1 + noise * rng.normal(size=n))
    return np.column_stack([x + r * np.cos(theta), y + r * np.sin(theta)])


def distances(points, x, y, radius):
    return np.hypot(points[:, 0] - x, points[:, 1] - y) - radius


def values(circle):
    return [*circle.center, circle.radius]


# --- exact points -------------------------------------------------------------------------------------------


@every_method
@given(
    x=st.floats(-10, 10),
    y=st.floats(-10, 10),
    radius=st.floats(1e-3, 1e3),
    degrees=st.floats(30, 360),
    start=st.floats(-np.pi, np.pi),
    n=st.integers(3, 60),
)
def test_exact_points_give_their_circle(method, x, y, radius, degrees, start, n):
    circle = fit_circle(arc(degrees, n, x=x, y=y, radius=radius, start=start), method)
    scale = max(radius, abs(x), abs(y))
    assert values(circle) == pytest.approx([x, y, radius], abs=1e-9 * scale)


EXACT = {
    "three points": ([(1, 0), (0, 1), (-1, 0)], [0, 0, 1]),
    "the corners of a square": ([(0, 0), (2, 0), (2, 2), (0, 2)], [1, 1, np.sqrt(2)]),
    "a right triangle: Thales": ([(0, 0), (6, 0), (0, 8)], [3, 4, 5]),
    "a doubled point": ([(1, 0), (1, 0), (0, 1), (-1, 0)], [0, 0, 1]),
    "two close together": ([(1, 0), (np.cos(1e-4), np.sin(1e-4)), (-1, 0)], [0, 0, 1]),
}


@every_method
@pytest.mark.parametrize(("points", "circle"), EXACT.values(), ids=EXACT)
def test_fit_circle(points, circle, method):
    assert values(fit_circle(points, method)) == pytest.approx(circle, abs=1e-7)


def test_geometric_is_the_default():
    points = arc(120, noise=0.05)
    assert fit_circle(points) == fit_circle(points, "geometric") != fit_circle(points, "taubin")


# --- nothing there ------------------------------------------------------------------------------------------

NO_CIRCLE = {
    "no points": [],
    "one point": [(1, 1)],
    "two points": [(0, 0), (1, 1)],
    "all points equal": [(2, 2)] * 5,
    "all points equal: their mean is off by rounding": [(0.1, 0.1)] * 5,
    "two different points": [(0, 0), (0, 0), (1, 0)],
    "two different points, askew": [(0.1, 0.3), (0.1, 0.3), (0.2, 0.7), (0.2, 0.7)],
    "three on a line": [(0, 0), (1, 1), (2, 2)],
    "on a horizontal": [(x, 0.5) for x in range(9)],
    "on a vertical": [(0.3, y) for y in range(9)],
    "on a line, up to rounding": [(0.1 * k, 0.3 * k + 0.1) for k in range(10)],
    "on a line, far from the origin": [(1e6 + k, 1e6 - 2 * k) for k in range(10)],
    "on a line, a doubled end": [(0, 0), (0, 0), (0.1, 0.1), (0.3, 0.3)],
}


@every_method
@pytest.mark.parametrize("points", NO_CIRCLE.values(), ids=NO_CIRCLE)
def test_fit_circle_nothing(points, method):
    """Regression: of the many circles through two points, one was returned."""
    assert fit_circle(points, method) is None


@every_method
@pytest.mark.parametrize(("radius", "is_circle"), [(100, True), (2.8e3, True), (3e3, False), (1e7, False)])
def test_a_radius_beyond_measure_is_a_line(method, radius, is_circle):
    """FLAT is the limit: 10,000 times the spread of the points, here 1 m / sqrt(12) on an arc of one metre."""
    circle = fit_circle(arc(np.degrees(1 / radius), 30, radius=radius, x=-radius), method)
    if is_circle:
        assert circle.radius == pytest.approx(radius, rel=1e-3)
    else:
        assert circle is None


@every_method
@given(seed=seeds, n=st.integers(3, 12), flatness=st.sampled_from([1.0, 1e-2, 1e-6]))
def test_whatever_the_points_it_is_a_circle_or_none(method, seed, n, flatness):
    """Blobs, heaps and strips: no exception, no warning, and no radius that a Circle would refuse."""
    points = np.random.default_rng(seed).normal(size=(n, 2)) * (1, flatness)
    circle = fit_circle(points, method)
    assert circle is None or (isinstance(circle, Circle) and circle.radius > 0)


@pytest.mark.parametrize("seed", [205, 226, 318])
def test_a_step_never_leads_to_a_radius_below_zero(seed):
    """An arc less high than its noise: Gauss and Newton pass through a line, and come out on its other side."""
    assert fit_circle(arc(30, noise=0.05, rng=seed)).radius > 0


FIT_FAILURES = {
    "unknown method": ({"method": "hyper"}, "method must be geometric, taubin, pratt or kasa, got 'hyper'"),
    "no method": ({"method": None}, "method must be geometric, taubin, pratt or kasa, got None"),
    "NaN": ({"points": [(0, 0), (1, 0), (0, NAN)]}, "points must be finite, got (0.0, nan) in row 2"),
    "infinite": ({"points": [(INF, 0)]}, "points must be finite, got (inf, 0.0) in row 0"),
    "three columns": ({"points": np.ones((4, 3))}, "points must have shape (N, 2), got shape (4, 3)"),
    "too few weights": ({"weights": [1, 1]}, "weights must have shape (3,), got shape (2,)"),
    "weights in columns": ({"weights": [[1], [1], [1]]}, "weights must have shape (3,), got shape (3, 1)"),
    "a weight below zero": ({"weights": [1, 1, -0.5]}, "weights must be finite numbers >= 0, got -0.5"),
    "a weight NaN": ({"weights": [1, NAN, 1]}, "weights must be finite numbers >= 0, got nan"),
    "an endless weight": ({"weights": [1, 1, INF]}, "weights must be finite numbers >= 0, got inf"),
}


@pytest.mark.parametrize(("change", "sentence"), FIT_FAILURES.values(), ids=FIT_FAILURES)
def test_fit_circle_failure(change, sentence):
    with pytest.raises(ValueError, match=exactly(sentence)):
        fit_circle(**({"points": [(1, 0), (0, 1), (-1, 0)]} | change))


# --- the bias of each ---------------------------------------------------------------------------------------

# Mean error of the radius in percent, over 200 arcs of 100 points with 5 % noise: from, to.
BIAS = {
    (60, "kasa"): (-57, -47),
    (90, "kasa"): (-21, -16),
    (120, "kasa"): (-8, -5),
    (360, "kasa"): (-1, 1),
    **{(degrees, method): (-3, 3) for degrees in (60, 90, 120, 360) for method in FAIR},
}


@pytest.mark.parametrize(("degrees", "method"), BIAS, ids=lambda v: str(v))
def test_bias_of_the_radius(degrees, method):
    radii = [fit_circle(arc(degrees, noise=0.05, rng=seed), method).radius for seed in range(200)]
    low, high = BIAS[degrees, method]
    assert low < 100 * (np.mean(radii) - 1) < high


def test_kasa_is_far_too_small_on_a_short_arc():
    """The exhibit: half the radius on 60 degrees, where the others differ by a hundredth from one another."""
    radii = {m: np.median([fit_circle(arc(60, noise=0.05, rng=s), m).radius for s in range(100)]) for m in METHODS}
    assert radii["kasa"] < 0.55
    assert all(radii[method] == pytest.approx(1, abs=0.03) for method in FAIR)


# --- independent formulas -----------------------------------------------------------------------------------


def kasa(points):
    """Normal equations of x^2 + y^2 = 2 a x + 2 b y + c, about the mean."""
    middle = points.mean(axis=0)
    x, y = (points - middle).T
    system = [[2 * x @ x, 2 * x @ y], [2 * x @ y, 2 * y @ y]]
    z = x**2 + y**2
    a, b = np.linalg.solve(system, [x @ z, y @ z])
    return [middle[0] + a, middle[1] + b, np.sqrt(a**2 + b**2 + z.mean())]


def conic(points, constraint):
    """The generalised eigenvector of M p = eta N p with the least eta >= 0 (Chernov 2010, section 5.6 and 5.9)."""
    middle = points.mean(axis=0)
    x, y = (points - middle).T
    z = x**2 + y**2
    design = np.column_stack([z, x, y, np.ones_like(x)])
    eta, p = scipy.linalg.eig(design.T @ design / len(x), constraint(x, y, z))
    eta = np.where(np.isfinite(eta) & (np.abs(eta.imag) < 1e-9) & (eta.real > -1e-12), eta.real, np.inf)
    a, b, c, d = p[:, np.argmin(eta)].real
    return [middle[0] - b / (2 * a), middle[1] - c / (2 * a), np.sqrt(b**2 + c**2 - 4 * a * d) / (2 * abs(a))]


def pratts(x, y, z):  # noqa: ARG001, both constraints are called alike
    return np.array([[0, 0, 0, -2], [0, 1, 0, 0], [0, 0, 1, 0], [-2, 0, 0, 0]], dtype=float)


def taubins(x, y, z):
    return np.array(
        [
            [4 * z.mean(), 2 * x.mean(), 2 * y.mean(), 0],
            [2 * x.mean(), 1, 0, 0],
            [2 * y.mean(), 0, 1, 0],
            [0, 0, 0, 0],
        ]
    )


def geometric(points):
    """A general optimiser, from Kasa's circle on: it knows nothing of circles."""
    return least_squares(lambda v: distances(points, *v), kasa(points), xtol=1e-15, ftol=1e-15, gtol=1e-15).x


ORACLES = {
    "kasa": kasa,
    "pratt": lambda points: conic(points, pratts),
    "taubin": lambda points: conic(points, taubins),
    "geometric": geometric,
}


@pytest.mark.parametrize(("method", "oracle"), ORACLES.items(), ids=ORACLES)
@pytest.mark.parametrize("degrees", [90, 150, 360])
@pytest.mark.parametrize("noise", [0.001, 0.02, 0.05])
def test_every_fit_agrees_with_an_independent_one(method, oracle, degrees, noise):
    for seed in range(10):
        points = arc(degrees, 20 + 5 * seed, noise, seed, x=0.3, y=-2.0, start=seed)
        assert values(fit_circle(points, method)) == pytest.approx(oracle(points), abs=1e-6)


@given(seed=seeds, degrees=st.floats(90, 360), noise=st.floats(0.001, 0.05), n=st.integers(8, 60))
def test_no_circle_nearby_fits_better_than_the_geometric(seed, degrees, noise, n):
    points = arc(degrees, n, noise, seed)
    best = np.array(values(fit_circle(points)))
    least = (distances(points, *best) ** 2).sum()
    for step in 1e-3 * np.vstack([np.eye(3), -np.eye(3)]):
        assert (distances(points, *(best + step)) ** 2).sum() > least


@given(seed=seeds, degrees=st.floats(90, 360))
def test_the_geometric_fit_is_no_worse_than_any_algebraic_one(seed, degrees):
    points = arc(degrees, 40, 0.05, seed)
    misfit = {method: (distances(points, *values(fit_circle(points, method))) ** 2).sum() for method in METHODS}
    assert misfit["geometric"] <= min(misfit.values()) * (1 + 1e-12)


# --- where, how large, in what numbers, how often -----------------------------------------------------------


@every_method
@given(
    seed=seeds,
    degrees=st.floats(90, 360),
    scale=st.floats(1e-6, 1e6),
    turn=st.floats(-np.pi, np.pi),
    x=st.floats(-10, 10),
    y=st.floats(-10, 10),
)
def test_turning_shifting_and_scaling_carry_the_circle_along(method, seed, degrees, scale, turn, x, y):
    points = arc(degrees, 30, 0.03, seed)
    c, s = np.cos(turn), np.sin(turn)
    rotation = np.array([[c, s], [-s, c]])
    a = fit_circle(points, method)
    b = fit_circle(scale * (points @ rotation + [x, y]), method)
    assert b.center / scale == pytest.approx(a.center @ rotation + [x, y], abs=1e-7)
    assert b.radius / scale == pytest.approx(a.radius, abs=1e-7)


@every_method
@pytest.mark.parametrize("degrees", [90, 360])
def test_a_million_metres_from_the_origin(method, degrees):
    near = arc(degrees, 50, 0.02, radius=0.1)
    a, b = fit_circle(near, method), fit_circle(near + 1e6, method)
    assert b.center - 1e6 == pytest.approx(a.center, abs=1e-7)
    assert b.radius == pytest.approx(a.radius, abs=1e-7)


@every_method
@pytest.mark.parametrize("dtype", [int, np.int16, np.uint8, np.float32], ids=lambda t: t.__name__)
def test_any_numbers(method, dtype):
    cells = np.round(arc(300, 40, x=120, y=120, radius=80)).astype(int)
    assert fit_circle(cells.astype(dtype), method) == fit_circle(cells.astype(float), method)


@every_method
@given(seed=seeds)
def test_the_order_of_the_points_does_not_matter(method, seed):
    points = arc(150, 30, 0.03, seed)
    order = np.random.default_rng(seed).permutation(30)
    assert values(fit_circle(points[order], method)) == pytest.approx(values(fit_circle(points, method)), abs=1e-9)


@every_method
@given(counts=st.lists(st.integers(0, 4), min_size=12, max_size=12).filter(lambda c: sum(k > 0 for k in c) >= 4))
def test_a_weight_is_as_good_as_a_repetition(method, counts):
    points = arc(200, 12, 0.05, 1)
    weighted = fit_circle(points, method, weights=counts)
    repeated = fit_circle(np.repeat(points, counts, axis=0), method)
    assert values(weighted) == pytest.approx(values(repeated), abs=1e-7)


@every_method
def test_only_the_share_of_the_weights_matters(method):
    points = arc(150, 30, 0.05)
    plain = values(fit_circle(points, method))
    for all_alike in (np.ones(30), np.full(30, 1e-9), np.full(30, 7), [2] * 30):
        assert values(fit_circle(points, method, weights=all_alike)) == pytest.approx(plain, abs=1e-9)


WEIGHTED_NOTHING = {
    "no weight": [0, 0, 0, 0],
    "two with a weight": [1, 0, 1, 0],
    "three with a weight, on a line": [1, 1, 1, 0],
}


@every_method
@pytest.mark.parametrize("weights", WEIGHTED_NOTHING.values(), ids=WEIGHTED_NOTHING)
def test_weights_that_leave_no_circle(method, weights):
    assert fit_circle([(0, 0), (1, 0), (2, 0), (1, 5)], method, weights=weights) is None


# --- circles through three points, and RANSAC ---------------------------------------------------------------


@given(seed=seeds)
def test_sampled_circles_are_as_far_from_each_of_their_points(seed):
    samples = np.random.default_rng(seed).uniform(-1, 1, (20, 3, 2))
    for (x, y, radius), (a, b, c) in zip(CIRCLE.from_samples(samples), samples, strict=True):
        expected = np.linalg.solve(2 * np.array([b - a, c - a]), [b @ b - a @ a, c @ c - a @ a])
        assert [x, y] == pytest.approx(expected, rel=1e-6, abs=1e-6)
        assert np.hypot(*(np.array([a, b, c]) - [x, y]).T) == pytest.approx([radius] * 3, rel=1e-6)


DEGENERATE = {
    "all equal": [(1, 1), (1, 1), (1, 1)],
    "first and second equal": [(0, 0), (0, 0), (1, 1)],
    "first and third equal": [(0, 0), (1, 1), (0, 0)],
    "second and third equal": [(0, 0), (1, 1), (1, 1)],
    "on a line": [(0, 0), (1, 2), (2, 4)],
    "on a line, up to rounding": [(0.1, 0.4), (0.2, 0.7), (0.3, 1.0)],
    "far away, on a line": [(1e6, 1e6), (1e6 + 1, 1e6 + 1), (1e6 + 2, 1e6 + 2)],
}


@pytest.mark.parametrize("sample", DEGENERATE.values(), ids=DEGENERATE)
def test_a_degenerate_sample_fixes_no_circle_and_divides_nothing(sample):
    assert np.isnan(CIRCLE.from_samples(np.array([sample], dtype=float))).all()


@pytest.mark.parametrize("refit", [False, True], ids=["sampled", "refitted"])
def test_find_circle_among_strays(refit):
    strays = np.random.default_rng(3).uniform(-0.5, 0.5, (40, 2))
    points = np.vstack([arc(200, 40, x=0.1, y=-0.2, radius=0.08), strays])
    circle = find_circle(points, 1e-6, trials=5000, refit=refit, rng=0)
    assert values(circle) == pytest.approx([0.1, -0.2, 0.08], abs=1e-9)


def test_without_refitting_the_circle_goes_through_three_of_the_points():
    points = arc(300, 40, 0.05)
    sampled, refitted = (find_circle(points, 0.3, refit=refit, rng=0) for refit in (False, True))
    assert np.count_nonzero(np.abs(sampled.signed_distance(points)) < 1e-12) == 3
    assert np.count_nonzero(np.abs(refitted.signed_distance(points)) < 1e-12) == 0


def test_the_same_seed_gives_the_same_circle():
    points = arc(300, 40, 0.05)
    assert len({find_circle(points, 0.02, trials=20, rng=rng) for rng in (3, 3, np.random.default_rng(3))}) == 1
    assert find_circle(points, 0.02, trials=20, rng=4) != find_circle(points, 0.02, trials=20, rng=3)


NOT_FOUND = {
    "no points": [],
    "two points": [(0, 0), (1, 1)],
    "all points equal": [(0.1, 0.1)] * 9,
    "on a line": [(0.1 * k, 0.3 * k + 0.1) for k in range(10)],
}


@pytest.mark.parametrize("points", NOT_FOUND.values(), ids=NOT_FOUND)
def test_find_circle_nothing(points):
    assert find_circle(points, 0.01, rng=0) is None


FIND_FAILURES = {
    "NaN": ({"points": [(NAN, 0)]}, "points must be finite, got (nan, 0.0) in row 0"),
    "wrong shape": ({"points": [1, 2]}, "points must have shape (N, 2), got shape (2,)"),
    "threshold below zero": ({"threshold": -1}, "threshold must be a finite number >= 0, got -1"),
    "threshold NaN": ({"threshold": NAN}, "threshold must be a finite number >= 0, got nan"),
    "no trial": ({"trials": 0}, "trials must be a whole number >= 1, got 0"),
}


@pytest.mark.parametrize(("change", "sentence"), FIND_FAILURES.values(), ids=FIND_FAILURES)
def test_find_circle_failure(change, sentence):
    with pytest.raises(ValueError, match=exactly(sentence)):
        find_circle(**({"points": [(1, 0), (0, 1), (-1, 0)], "threshold": 0.1} | change))


# --- PyRANSAC, the paper's library --------------------------------------------------------------------------
# Matched: circles through three points; a point agrees when its distance is at most the threshold; the first of the
# circles with the most inliers is kept, and it is not fitted to its inliers. Differs: it draws from Python's global
# generator, here replaced by primkit's samples; it works in 3-D, here on the plane z = 0; and it works with slopes,
# so that a sample with two points just above one another gives NaN, which agrees with nothing: see the last test.


def pyransac(monkeypatch, points, threshold, samples):
    """Its circle from just these samples, and which points agree."""
    queue = iter(samples.tolist())
    monkeypatch.setattr(pyransac3d.circle, "random", types.SimpleNamespace(sample=lambda *_: next(queue)))
    model = pyransac3d.Circle()
    with np.errstate(all="ignore"):
        model.fit(np.column_stack([points, np.zeros(len(points))]), thresh=threshold, maxIteration=len(samples))
    agreeing = np.zeros(len(points), dtype=bool)
    agreeing[model.inliers] = True
    return model, agreeing


CLUSTERS = {
    "a circle with noise": lambda rng: arc(360, 60, 0.02, rng, radius=0.08),
    "a short arc": lambda rng: arc(80, 40, 0.01, rng, radius=0.1, x=-0.2, y=0.3),
    "a circle among strays": lambda rng: np.vstack(
        [arc(300, 40, 0.01, rng, radius=0.07), rng.uniform(-0.2, 0.2, (40, 2))]
    ),
    "a heap": lambda rng: rng.normal(size=(50, 2)) * 0.05,
    "two circles": lambda rng: np.vstack(
        [arc(360, 30, 0.01, rng, radius=0.05), arc(360, 35, 0.01, rng, x=0.2, radius=0.06)]
    ),
}


@pytest.mark.parametrize("cluster", CLUSTERS.values(), ids=CLUSTERS)
@pytest.mark.parametrize("seed", range(3))
def test_find_circle_agrees_with_pyransac(monkeypatch, cluster, seed):
    points, threshold, trials = cluster(np.random.default_rng(seed)), 0.005, 150
    samples = draw_samples(len(points), 3, trials, np.random.default_rng(seed))
    theirs, agreeing = pyransac(monkeypatch, points, threshold, samples)
    ours = find_circle(points, threshold, trials=trials, refit=False, rng=seed)
    assert ours.center == pytest.approx(theirs.center[:2], abs=1e-9)
    assert ours.radius == pytest.approx(theirs.radius, abs=1e-9)
    assert np.array_equal(np.abs(ours.signed_distance(points)) <= threshold, agreeing)


def test_of_circles_with_as_many_inliers_both_keep_the_first(monkeypatch):
    """Two exact circles with twelve points each, and a threshold that nothing else meets."""
    points = np.vstack([arc(360, 12, radius=0.05, start=0.3), arc(360, 12, radius=0.08, x=0.4, start=0.3)])
    radii = []
    for seed in range(6):
        samples = draw_samples(24, 3, 200, np.random.default_rng(seed))
        theirs, agreeing = pyransac(monkeypatch, points, 1e-6, samples)
        ours = find_circle(points, 1e-6, trials=200, refit=False, rng=seed)
        assert np.count_nonzero(agreeing) == 12
        assert ours.radius == pytest.approx(theirs.radius, abs=1e-9)
        radii.append(round(ours.radius, 6))
    assert set(radii) == {0.05, 0.08}  # either of the two was first in some runs


def test_two_points_above_one_another_defeat_pyransac_but_not_primkit(monkeypatch):
    points = np.array([(1.0, 0.0), (0.6, 0.8), (0.6, -0.8), (-1.0, 0.0)])
    samples = np.array([[1, 2, 3]])
    theirs, agreeing = pyransac(monkeypatch, points, 1e-9, samples)
    assert len(theirs.center) == 0
    assert not agreeing.any()
    monkeypatch.setattr("primkit.ransac.draw_samples", lambda *_: samples)
    assert values(find_circle(points, 1e-9, trials=1, refit=False)) == pytest.approx([0, 0, 1], abs=1e-12)


def bias_of_arcs(noise, poses_within, corrected, n=60):
    """Mean error of the radius in units of noise^2 / (2 radius), and the share of the circle that was seen."""
    errors, shares = [], []
    for seed in range(n):
        rng = np.random.default_rng([61, seed])
        true = pk.Circle((0, 0), rng.uniform(0.05, 0.1))
        bearing = rng.uniform(-poses_within, poses_within, 30)
        away = true.radius + rng.uniform(0.06, 0.2, 30)
        poses = np.column_stack([away * np.cos(bearing), away * np.sin(bearing), rng.uniform(0, 6, 30)])
        grid = pk.Grid()
        grid.add(pk.scan(pk.World([true]), poses, pk.Lidar(noise_std=noise), rng=rng))
        points = grid.points()
        fit = pk.fit_circle(points)
        seen = seen_shares(fit, points[np.abs(fit.signed_distance(points)) < 0.0123])[0]  # within 3 deviations
        fit = straightened(fit, points, noise, seen) if corrected else fit
        errors.append((fit.radius - true.radius) / (noise**2 / (2 * true.radius)))
        shares.append(seen)
    return np.mean(errors), np.mean(shares)


@pytest.mark.parametrize("poses_within", [0.05, 0.5, 1.2])
def test_grazing_beams_shrink_an_arc_and_the_correction_undoes_it(poses_within):
    """Robots on one side see arcs of about 150, 185 and 250 degrees, 5 mm of noise."""
    plain, seen = bias_of_arcs(0.005, poses_within, corrected=False)
    factor = 6 * (1 / seen - 1) ** 2
    assert -1.6 * factor - 1 < plain < -0.6 * factor + 1  # the law holds within a third or so
    corrected, _ = bias_of_arcs(0.005, poses_within, corrected=True)
    assert abs(corrected) < max(1.0, abs(plain) / 2)


def test_what_is_seen_from_all_around_needs_no_correction():
    circle, ring = pk.Circle((0.1, 0.2), 0.05), pk.Circle((0.1, 0.2), 0.05).outline(100)
    same = straightened(circle, ring, 0.01, 1.0)
    assert same.radius == 0.05
    np.testing.assert_allclose(same.center, circle.center, atol=1e-9)


@pytest.mark.parametrize("angle", [0.3, 2.0, -1.5])
def test_the_correction_turns_with_the_arc_and_moves_the_centre_away_from_the_robot(angle):
    half = pk.Circle((0, 0), 0.05).outline(100)[:50] @ [[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]]
    here = straightened(pk.Circle((0, 0), 0.05), half, 0.005, 0.5)
    towards = half.mean(axis=0) / np.hypot(*half.mean(axis=0))
    assert here.radius == pytest.approx(0.05 + 6 * 0.005**2 / 0.1)
    assert here.center @ towards == pytest.approx(-np.hypot(*here.center))
    assert np.hypot(*here.center) > here.radius - 0.05
    wild = straightened(pk.Circle((0, 0), 0.05), half, 0.5, 0.01)
    assert wild.radius == pytest.approx(0.055)


@given(seed=st.integers(0, 10_000))
def test_step_after_step_a_circle_comes_to_the_least_squares(seed):
    rng = np.random.default_rng(seed)
    points = Circle((0.2, -0.1), 0.05).outline(80)[: rng.integers(35, 80)] + rng.normal(0, 0.001, 2)
    points, weights = points + rng.normal(0, 0.0005, points.shape), rng.uniform(0.1, 1, len(points))
    circle = Circle((0.205, -0.102), 0.053)
    for _ in range(8):
        circle = nearer_circle(circle, points, weights)
    best = fit_circle(points, weights=weights)
    np.testing.assert_allclose([*circle.center, circle.radius], [*best.center, best.radius], atol=1e-9)


def test_no_step_leads_to_a_circle_that_points_do_not_fix():
    circle = Circle((0, 0), 0.05)
    assert nearer_circle(circle, np.array([(0.05, 0.0), (0.0, 0.05)]), np.zeros(2)) is None
