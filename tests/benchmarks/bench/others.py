"""Others: what needs packages that the classroom does not have.

In:  a world and a sensor; or points, shape (N, 2), metres.
Out: ranges, shape (P, B); or shapes, a line's inliers, a circle: to be compared with primkit's from the same.

* numba compiles the loops of ``loops.py``.
* ir-sim scans: the shapes are its obstacles, the sensor is its lidar, stepped to each pose; nothing is drawn.
* The chain is the paper's method with the tools it names: K-Means from scikit-learn, told the number of shapes; lines
  one after the other by scikit-image's RANSAC until a tenth of a cluster's points is left; the number of lines for a
  name; circles by pyRANSAC-3D. Extents and means, no work at all, are read off as in ``paper.py``.
* scikit-image, pyRANSAC-3D and circle-fit fit single lines and circles, as their manuals show.

Each package is loaded when it is first asked for. ``tests/benchmarks`` holds them against primkit.
"""

from __future__ import annotations

import io
import json
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stdout
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from numpy.typing import NDArray

from primkit.lidar import Lidar
from primkit.paper import kind_by_lines, measure_as_published
from primkit.shapes import Circle, Shape
from primkit.world import World

from .casters import Cast, Loop
from .loops import LOOPS

Floats = NDArray[np.float64]

THRESHOLD = 0.005  # m: the paper's, five cells
LEFT_OVER = 0.1
MOST_LINES = 20

IRSIM = "ir-sim"


# --- scans --------------------------------------------------------------------------------------------------


def compiled(name: str) -> Loop:
    """Return one of the loops, compiled; "numpy" leaves a division by zero to be infinite."""
    import numba

    return numba.njit(error_model="numpy")(LOOPS[name])


def irsim_caster(world: World, lidar: Lidar) -> Cast:
    """Return ir-sim's lidar in a scene of its own."""
    scene = _irsim_scene(world, lidar)
    sensor = scene.robot.lidar
    # Its beams spread from one end of an angle to the other: a full turn would double one. On one step less, and with
    # the sensor turned so that its first beam looks ahead, they are ours.
    first = sensor.angle_min

    def cast(poses: Floats) -> Floats:
        ranges = np.empty((len(poses), lidar.beams))
        for row, (x, y, heading) in zip(ranges, poses, strict=True):
            sensor.step(np.array([[x], [y], [heading - first]]))
            seen = sensor.get_scan()
            row[:] = seen["ranges"]
            row[~seen["valid"]] = np.inf
        return ranges

    cast.scene = scene  # type: ignore[attr-defined]  # it must not be collected while it is in use
    return cast


def _irsim_scene(world: World, lidar: Lidar):  # type: ignore[no-untyped-def]  # a type of ir-sim's, which has none
    """Return a scene with the shapes and, as its robot, the sensor alone."""
    with redirect_stdout(io.StringIO()):  # it tells which windows it looked for
        import irsim

    sensor = {
        "name": "lidar2d",
        "range_min": lidar.range_min,
        "range_max": lidar.range_max,
        "angle_range": 2 * np.pi - lidar.angle_increment,
        "number": lidar.beams,
    }
    body = {"name": "circle", "radius": 0.001}
    described = {
        "world": {"width": world.size, "height": world.size, "offset": [-world.size / 2, -world.size / 2]},
        "robot": [{"kinematics": {"name": "diff"}, "shape": body, "state": [0, 0, 0], "sensors": [sensor]}],
        "obstacle": [_irsim_obstacle(shape) for shape in world.shapes],
    }
    with TemporaryDirectory() as folder:
        path = Path(folder) / "scene.yaml"
        path.write_text(json.dumps(described), encoding="utf-8")  # JSON is YAML too
        return irsim.make(str(path), headless=True, log_level="CRITICAL")


def _irsim_obstacle(shape: Shape) -> dict[str, object]:
    if isinstance(shape, Circle):
        return {"shape": {"name": "circle", "radius": shape.radius}, "state": [*shape.center.tolist(), 0]}
    return {"shape": {"name": "polygon", "vertices": shape.vertices.tolist()}, "state": [0, 0, 0]}


# --- shapes, lines, circles ---------------------------------------------------------------------------------


class Counting(np.random.Generator):
    """A generator that counts the samples that scikit-image's RANSAC draws from it: it may stop before the last."""

    n_calls = 0

    @classmethod
    def seeded(cls, *seed: int) -> Counting:
        """Return one that draws the numbers of ``default_rng(seed)``."""
        return cls(np.random.PCG64(seed))

    def choice(self, *args: Any, **more: Any) -> Any:
        """Draw as numpy does."""
        self.n_calls += 1
        return super().choice(*args, **more)


def chain(points: Floats, n_shapes: int, trials: int, seed: int) -> list[Shape]:
    """Find shapes with the chain of peers, at most ``trials`` samples for each line and circle."""
    from sklearn.cluster import KMeans

    labels = KMeans(n_shapes, random_state=seed).fit_predict(points)
    found = []
    for label in range(n_shapes):
        cluster = points[labels == label]
        n_lines = count_lines(cluster, trials, np.random.default_rng([seed, label]))
        if kind_by_lines(n_lines) == "circle":
            shape: Shape | None = ransac_circle_pyransac(cluster, trials, seed)
        else:
            shape = measure_as_published(cluster, n_lines)
        if shape is not None:
            found.append(shape)
    return found


def count_lines(cluster: Floats, trials: int, rng: np.random.Generator) -> int:
    """Return how many lines scikit-image's RANSAC takes to explain nine tenths of a cluster."""
    left, count = cluster, 0
    while count < MOST_LINES and len(left) > max(1, LEFT_OVER * len(cluster)):
        inliers = ransac_line_skimage(left, trials, rng)
        if not inliers.any():
            break
        left, count = left[~inliers], count + 1
    return count


def ransac_line_skimage(points: Floats, trials: int, rng: np.random.Generator | int) -> NDArray[np.bool_]:
    """Return which points lie on the best line; none of them when no line was found."""
    from skimage.measure import LineModelND, ransac

    model, inliers = ransac(points, LineModelND, 2, residual_threshold=THRESHOLD, max_trials=trials, rng=rng)
    return inliers if model else np.zeros(len(points), dtype=bool)


def ransac_circle_skimage(points: Floats, trials: int, rng: np.random.Generator | int) -> Circle | None:
    """Return the best circle, refitted to its inliers."""
    from skimage.measure import CircleModel, ransac

    model, _ = ransac(points, CircleModel, 3, residual_threshold=THRESHOLD, max_trials=trials, rng=rng)
    return Circle(model.center, float(model.radius)) if model else None


def ransac_circle_pyransac(points: Floats, trials: int, seed: int) -> Circle | None:
    """Return the best circle through three of the points; None when it is none that a board has room for."""
    import pyransac3d

    model = pyransac3d.Circle()
    with _seeded(seed), np.errstate(all="ignore"):  # it divides by zero for points above one another
        model.fit(np.column_stack([points, np.zeros(len(points))]), THRESHOLD, trials)
    radius = float(model.radius)
    return Circle(np.asarray(model.center)[:2], radius) if 0 < radius < np.inf else None


@contextmanager
def _seeded(seed: int) -> Iterator[None]:
    """Seed the generator that pyransac3d draws from, which is Python's own, and put it back afterwards."""
    import pyransac3d

    generator: Any = pyransac3d.circle.random
    before = generator.getstate()
    generator.seed(seed)
    try:
        yield
    finally:
        generator.setstate(before)


def fit_taubin(points: Floats) -> Circle:
    """Return circle-fit's Taubin fit."""
    from circle_fit import taubinSVD

    x, y, radius, _ = taubinSVD(points)
    return Circle((x, y), float(radius))


def fit_marquardt(points: Floats) -> Circle:
    """Return circle-fit's Levenberg-Marquardt fit, from its Taubin fit on."""
    from circle_fit import lm, taubinSVD

    x, y, radius, _ = lm(points, np.array(taubinSVD(points)[:3]))
    return Circle((x, y), float(radius))


def fit_least_squares(points: Floats) -> Circle:
    """Return circle-fit's fit of the true distances by scipy's least squares."""
    from circle_fit import standardLSQ

    x, y, radius, _ = standardLSQ(points)
    return Circle((x, y), float(radius))


def fit_skimage(points: Floats) -> Circle | None:
    """Return scikit-image's fit of a circle."""
    from skimage.measure import CircleModel

    model = CircleModel.from_estimate(points)
    return Circle(model.center, float(model.radius)) if model else None
