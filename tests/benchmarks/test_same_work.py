"""Both sides of each benchmark do the same work: the same ranges, the same lines, the same circles.

Nothing is timed here, because a busy machine would break it: ``python -m tests.benchmarks`` measures. A peer that is
not installed is skipped, and the reason says so.
"""

import matplotlib
import numpy as np
import pytest

import primkit as pk
from primkit.evaluation import evaluate
from tests.benchmarks.bench import casters, others
from tests.benchmarks.bench.finding import clusters, points_of
from tests.benchmarks.bench.loops import LOOPS
from tests.benchmarks.bench.machine import HOW_TO, version_of
from tests.benchmarks.bench.scanning import EQUAL, four_shape_maps, poses_outside, primkit_caster

LIDAR = pk.Lidar()
MAPS = four_shape_maps()
ANGULAR = [name for name, world in MAPS.items() if all(shape.kind != "circle" for shape in world.shapes)]
ROUND = [name for name in MAPS if name not in ANGULAR]


def need(peer):
    return pytest.mark.skipif(version_of(peer) is None, reason=f"{peer} is absent: {HOW_TO}")


@pytest.fixture(autouse=True)
def backend_as_it_was():
    """ir-sim chooses another backend for matplotlib, for all who come after it."""
    yield
    matplotlib.use("Agg")


def ranges_of(caster, name, n=40):
    world = MAPS[name]
    poses = poses_outside(world, n, np.random.default_rng(1))
    return primkit_caster(world, LIDAR)(poses), caster(world, LIDAR)(poses)


# --- scans --------------------------------------------------------------------------------------------------


@need("numba")
@pytest.mark.parametrize("loop", LOOPS)
def test_numba_sees_what_primkit_sees(loop):
    compiled = others.compiled(loop)
    for name in MAPS:
        ours, theirs = ranges_of(lambda world, lidar: casters.numba_caster(world, lidar, compiled), name, n=500)
        np.testing.assert_allclose(theirs, ours, rtol=0, atol=EQUAL)


@need("ir-sim")
@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("name", ANGULAR)
def test_irsim_sees_what_primkit_sees(name):
    ours, theirs = ranges_of(others.irsim_caster, name)
    np.testing.assert_allclose(theirs, ours, rtol=0, atol=EQUAL)


@need("ir-sim")
@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("name", ROUND)
def test_irsim_and_geos_have_the_same_polygons_for_circles(name):
    _, irsim = ranges_of(others.irsim_caster, name)
    _, geos = ranges_of(casters.geos_caster, name)
    np.testing.assert_allclose(irsim, geos, rtol=0, atol=EQUAL)


@need("ir-sim")
@pytest.mark.filterwarnings("ignore")
def test_irsim_keeps_several_scenes_apart():
    several = [others.irsim_caster(MAPS[name], LIDAR) for name in ANGULAR[:2]]
    for name, cast in zip(ANGULAR, several, strict=False):
        ours, theirs = ranges_of(lambda *_, cast=cast: cast, name)
        np.testing.assert_allclose(theirs, ours, rtol=0, atol=EQUAL)


# --- shapes, lines, circles ---------------------------------------------------------------------------------

POLYGON, DISC = (sets[0] for sets in clusters())


@need("scikit-image")
def test_scikit_image_finds_a_line_of_as_many_points():
    ours = pk.find_lines(POLYGON[1], others.THRESHOLD, most=1, trials=200, rng=0)[0].inliers
    theirs = others.ransac_line_skimage(POLYGON[1], 200, 0)
    assert np.sum(theirs) == pytest.approx(np.sum(ours), rel=0.05)


RANSACS = {"scikit-image": others.ransac_circle_skimage, "pyransac3d": others.ransac_circle_pyransac}


@pytest.mark.parametrize("peer", [pytest.param(peer, marks=need(peer)) for peer in RANSACS])
def test_ransac_finds_the_circle(peer):
    truth, points = DISC
    for circle in (RANSACS[peer](points, 100, 0), pk.find_circle(points, others.THRESHOLD, trials=100, rng=0)):
        assert circle.radius == pytest.approx(truth.radius, abs=0.002)


@need("pyransac3d")
def test_pyransac_draws_the_same_from_a_seed_and_leaves_no_trace():
    first, second, other = (others.ransac_circle_pyransac(DISC[1], 5, seed) for seed in (3, 3, 4))
    assert first == second
    assert first != other


FITS = {
    "circle-fit, Taubin": (others.fit_taubin, "taubin", 1e-9),
    "circle-fit, least squares": (others.fit_least_squares, "geometric", 1e-8),
    "circle-fit, Marquardt": (others.fit_marquardt, "geometric", 1e-5),  # stops early
    "scikit-image, Kasa": (others.fit_skimage, "kasa", 1e-9),
}


@pytest.mark.parametrize(
    ("theirs", "method", "tolerance"),
    [pytest.param(*case, marks=need(name.split(",")[0]), id=name) for name, case in FITS.items()],
)
def test_fits_agree(theirs, method, tolerance):
    ours = pk.fit_circle(DISC[1], method)
    circle = theirs(DISC[1])
    assert circle.radius == pytest.approx(ours.radius, abs=tolerance)
    assert circle.center == pytest.approx(ours.center, abs=tolerance)


@need("scikit-image")
@need("pyransac3d")
def test_the_chain_finds_the_shapes_of_a_map():
    world = MAPS["4-02"]
    found = others.chain(points_of(world), 4, 100, 0)
    assert found == others.chain(points_of(world), 4, 100, 0)
    assert len(found) == 4
    assert evaluate(found, world).weighted_accuracy > 0.6
