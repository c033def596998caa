"""Circles: fits to points that lie on one, or on a part of one.

In:  points, shape (N, 2), metres.
Out: a ``Circle``, or ``None`` when the points fix none.

>>> fit_circle([(1, 0), (0, 1), (-1, 0), (0, -1)])
Circle(center=(0, 0), radius=1)

Four ways are here, because the difference is a lesson. With ``z = x^2 + y^2`` a circle is
``A z + B x + C y + D = 0``, and the algebraic fits minimise the sum of its squares under one condition:

* Kasa (1976): ``A = 1``. Simplest, and far too small a radius on a short arc.
* Pratt (1987): ``B^2 + C^2 - 4 A D = 1``.
* Taubin (1991): the mean squared gradient is 1. Nearly as good as the best, in one step.
* geometric: the true distances to the circle, from Taubin's fit on (Gander, Golub and Strebel, 1994).

Source of all formulas: Chernov (2010), "Circular and linear regression", chapters 4 and 5.
"""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from .arguments import Floats, as_floats, as_points, short
from .ransac import Model, run_ransac
from .shapes import Circle

Method = Literal["kasa", "pratt", "taubin", "geometric"]

FLAT = 1e4  # points whose circle is more times wider than they are spread lie on a line, as far as one can tell
GRAZING, MOST_GRAZING = 6.0, 30.0  # how much grazing beams shrink an arc: see ``straightened``
FINEST = 1e-12  # keeps what is divided by above zero
GAUSS_NEWTON_STEPS = 50  # Gauss-Newton settles within five steps at 1 % noise, within some fifteen at 10 %


def fit_circle(points: ArrayLike, method: Method = "geometric", *, weights: ArrayLike | None = None) -> Circle | None:
    """Return the circle that fits the points best; None when fewer than three differ or they lie on one line.

    On a 60 degree arc with 5 % noise Kasa's radius comes out about half as large as it is, on 90 degrees a sixth too
    small; the others stay within a few percent.

    Raises ValueError if points are not finite (N, 2), the method is unknown, or a weight is not a finite number >= 0.

    Parameters
    ----------
    points : array_like, shape (N, 2), metres
    method : {"geometric", "taubin", "pratt", "kasa"}
        What "best" means; see the module's notes.
    weights : array_like, shape (N,), optional
        How much each point counts.

    Examples
    --------
    >>> fit_circle([(0, 0), (1, 1), (2, 2)]) is None
    True
    """
    points = as_points(points)
    if method not in ("kasa", "pratt", "taubin", "geometric"):
        raise ValueError(f"method must be geometric, taubin, pratt or kasa, got {short(method)}")
    w = _as_weights(weights, len(points))
    if np.count_nonzero(w) < 3:
        return None

    # Centre and scale first: the fit then does not depend on where the circle is or how large.
    w = w / w.sum()
    middle = w @ points
    scale = float(np.sqrt(w @ ((points - middle) ** 2).sum(axis=1)))
    if scale == 0:
        return None
    x, y = ((points - middle) / scale).T
    params = _algebraic(x, y, w, "taubin" if method == "geometric" else method)
    if params is not None and method == "geometric":
        params = _polished(x, y, w, params)
    if params is None or not np.isfinite(params).all() or params[2] > FLAT:
        return None
    return Circle(middle + scale * params[:2], scale * params[2])


def find_circle(
    points: ArrayLike,
    threshold: float,
    *,
    trials: int = 1000,
    refit: bool = True,
    rng: int | np.random.Generator | None = None,
) -> Circle | None:
    """Return the circle that most points agree with: RANSAC on circles through three points.

    Parameters
    ----------
    points, threshold, trials, refit, rng
        As for ``run_ransac``. Without ``refit`` the circle goes through three of the points, as in the PyRANSAC library
        that the paper uses.

    Examples
    --------
    >>> find_circle([(1, 0), (0, 1), (-1, 0), (0, -1), (5, 5)], threshold=0.01, rng=0)
    Circle(center=(0, 0), radius=1)
    """
    consensus = run_ransac(points, CIRCLE, threshold, trials=trials, refit=refit, rng=rng)
    return None if consensus is None else Circle(consensus.params[:2], float(consensus.params[2]))


def straightened(circle: Circle, points: Floats, noise_std: float, seen: float) -> Circle:
    """Return the circle as it would be without what grazing beams do to the ends of an arc.

    Where beams graze, at the ends of the arc that they see, too long a range carries the point on into the shadow and
    inwards: the least-squares circle comes out too small, and too near. From all around these errors even out.

        u = noise_std^2 / (2 radius)      radius too small by f u, f = 6 (1 / seen - 1)^2; by a tenth at most
                                          centre too near by (f + p) u

    noise_std [m] is that of the ranges, seen the share of the circle that was seen, above 0 and at most 1, p the length
    of the mean of the unit vectors from the centre to the points, shape (N, 2), metres. The form of f was found by
    simulation: 30 where three tenths are seen, and no more for less, 12 for five twelfths, 6 for one half, 1 for seven
    tenths; ``tests/test_circles.py`` repeats it.

    >>> from primkit.shapes import Circle
    >>> half = Circle((0, 0), 0.05).outline(100)[:50]
    >>> straightened(Circle((0, 0), 0.05), half, 0.005, 0.5).radius > 0.051
    True
    >>> straightened(Circle((0, 0), 0.05), half, 0.0, 0.5).radius
    0.05
    """
    outward = points - circle.center
    middle = (outward / np.maximum(np.hypot(*outward.T), FINEST)[:, None]).mean(axis=0)
    length = float(np.hypot(*middle))
    unit = noise_std**2 / (2 * circle.radius)
    factor = min(GRAZING * (1 / seen - 1) ** 2, MOST_GRAZING)
    too_small = min(factor * unit, circle.radius / 10)
    too_near = (too_small + length * unit) * middle / max(length, FINEST)
    return Circle(circle.center - too_near, circle.radius + too_small)


def nearer_circle(circle: Circle, points: Floats, weights: Floats) -> Circle | None:
    """Return a circle that is nearer to the points by one step of Gauss and Newton; None where that leads nowhere.

    ``points``, shape (N, 2), metres; ``weights``, shape (N,): how much each counts. Near the solution each step doubles
    the number of digits.
    """
    x, y = points.T
    params = _nearer(x, y, weights, np.array([*circle.center, circle.radius]))
    if params is None or not np.isfinite(params).all() or params[2] <= 0:
        return None
    return Circle(params[:2], float(params[2]))


def _as_weights(weights: ArrayLike | None, n: int) -> Floats:
    """Return n weights, all alike when none are given."""
    w = np.ones(n) if weights is None else as_floats(weights, "weights", f"({n},)")
    if w.shape != (n,):
        raise ValueError(f"weights must have shape ({n},), got shape {w.shape}")
    bad = w[~(np.isfinite(w) & (w >= 0))]
    if len(bad):
        raise ValueError(f"weights must be finite numbers >= 0, got {bad[0]:g}")
    return w


def _algebraic(x: Floats, y: Floats, w: Floats, method: str) -> Floats | None:
    """Return centre and radius of the algebraic fit to centred, scaled points, shape (3,)."""
    z = x**2 + y**2
    if method == "kasa":  # 2 a x + 2 b y + c = z
        design = np.column_stack([2 * x, 2 * y, np.ones_like(x)])
        root = np.sqrt(w)
        (a, b, c), _, rank, _ = np.linalg.lstsq(design * root[:, None], z * root, rcond=1e-12)
        return np.array([a, b, np.sqrt(max(c + a * a + b * b, 0.0))]) if rank == 3 else None

    # Minimise |M p|^2 over p = (A, B, C, D) under p' N p = 1: a generalised eigenvalue problem.
    design = np.column_stack([z, x, y, np.ones_like(x)])
    moments = design.T @ (design * w[:, None])
    if method == "pratt":
        norm = np.array([[0, 0, 0, -2], [0, 1, 0, 0], [0, 0, 1, 0], [-2, 0, 0, 0]], dtype=float)
    else:
        mz, mx, my = w @ z, w @ x, w @ y
        norm = np.array([[4 * mz, 2 * mx, 2 * my, 0], [2 * mx, 1, 0, 0], [2 * my, 0, 1, 0], [0, 0, 0, 0]])
    p = _least_generalised(moments, norm)
    return None if p is None else _from_conic(p)


def _least_generalised(moments: Floats, norm: Floats) -> Floats | None:
    """Return p that minimises p' M p under p' N p = 1, for M at least semi-definite, shape (4,); None for a choice."""
    values, axes = np.linalg.eigh(moments)
    if values[1] <= 1e-14 * values[-1]:  # fewer than three different points: many circles go through them
        return None
    if values[0] <= 1e-14 * values[-1]:  # the points lie exactly on a circle or a line
        return axes[:, 0]
    # M = L L', q = L' p: the largest eigenvalue of inv(L) N inv(L)' is the inverse of the least p' M p.
    half = axes / np.sqrt(values)
    merit, directions = np.linalg.eigh(half.T @ norm @ half)
    return half @ directions[:, np.argmax(merit)]


def _from_conic(p: Floats) -> Floats | None:
    """Return centre and radius of A z + B x + C y + D = 0, shape (3,); None for a line."""
    a, b, c, d = p
    if abs(a) <= np.hypot(b, c) / (2 * FLAT):  # a radius beyond FLAT
        return None
    center = np.array([-b, -c]) / (2 * a)
    squared = center @ center - d / a
    return np.array([*center, np.sqrt(squared)]) if squared > 0 else None


def _polished(x: Floats, y: Floats, w: Floats, params: Floats) -> Floats:
    """Minimise the squared distances to the circle, from a good start on, shape (3,)."""
    for _ in range(GAUSS_NEWTON_STEPS):
        nearer = _nearer(x, y, w, params)
        if nearer is None or not 0 < nearer[2] <= FLAT:
            break
        settled, params = np.abs(nearer - params).max() < 1e-12, nearer
        if settled:
            break
    return params


def _nearer(x: Floats, y: Floats, w: Floats, params: Floats) -> Floats | None:
    """Return (x, y, radius) after one step of Gauss and Newton, shape (3,); None where the points fix none.

    A point at the distance d_i from the centre (a, b) has the residual d_i - r, which falls by J s to first order when
    the numbers grow by s; the rows of J are ((x_i - a) / d_i, (y_i - b) / d_i, 1). So J' W J s = J' W (d - r).
    """
    dx, dy = x - params[0], y - params[1]
    distance = np.maximum(np.hypot(dx, dy), FINEST)
    slope = np.array([dx / distance, dy / distance, np.ones_like(dx)])
    weighted = slope * w
    try:
        step: Floats = np.linalg.solve(weighted @ slope.T, weighted @ (distance - params[2]))
    except np.linalg.LinAlgError:  # too few points have any weight
        return None
    return params + step


# --- the circle as RANSAC's model: parameters (x, y, radius) ----------------------------------------------------


def _from_samples(samples: Floats) -> Floats:
    """Return the circle through each three points, shape (T, 3, 2) -> (T, 3); NaN when they lie on a line."""
    b, c = samples[:, 1] - samples[:, 0], samples[:, 2] - samples[:, 0]
    double_area = b[:, 0] * c[:, 1] - b[:, 1] * c[:, 0]
    bb, cc = (b**2).sum(axis=1), (c**2).sum(axis=1)
    flat = np.abs(double_area) <= 1e-9 * np.maximum(bb, cc)  # three points on a line, up to rounding
    twice = 2 * np.where(flat, np.nan, double_area)
    x = (c[:, 1] * bb - b[:, 1] * cc) / twice
    y = (b[:, 0] * cc - c[:, 0] * bb) / twice
    return np.column_stack([samples[:, 0, 0] + x, samples[:, 0, 1] + y, np.hypot(x, y)])


def _residuals(params: Floats, points: Floats) -> Floats:
    """Return the distances of N points from T circles, shape (T, N)."""
    dx = points[:, 0] - params[:, :1]
    dy = points[:, 1] - params[:, 1:2]
    return np.abs(np.sqrt(dx * dx + dy * dy) - params[:, 2:])


def _fit(points: Floats) -> Floats:
    """Return Taubin's circle, shape (3,): one step, and as good as RANSAC needs; NaN when the points fix none."""
    circle = fit_circle(points, "taubin")
    return np.full(3, np.nan) if circle is None else np.array([*circle.center, circle.radius])


CIRCLE = Model(sample_size=3, from_samples=_from_samples, residuals=_residuals, fit=_fit)
