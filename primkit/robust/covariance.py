"""Covariance: how a fit's numbers err when its points err, each alone and many together.

To first order the P fitted numbers q and the residuals r of N points follow the errors e: how far each point lies off
its true place, across the outline. With the fit's effect A, shape (P, N), and the residuals' slopes B, shape (N, P),

    q - truth = A e        r = M e, M = 1 + B A        cov q = A V A', V = E[e e']

Who supposes V = s0 1, errors that are each point's own, is too sure: where a pose is wrong, all points of its scan are
wrong together, and cells round a side that runs along them alike from one end to the other. So, n being the normals,

    V = s0 1 + s1 U U' + W W'

s0     is what each point errs alone
s1     is the variance of t, by which a scan's pose is off in x and y: it moves each of its points across by n . t. U
       has two columns for each scan: the normals of its points, in x and in y
W      are the cells, of side h. Rounding x errs by a saw-tooth, and y alike. Averaged over where cells may lie, errors
       at x and x' have the covariance sum_m (h / pi m)^2 / 2 cos(2 pi m (x - x') / h): two waves for each m, as far as
       a point's phase is known. Noise shakes it across, and half a cell along. Each side has waves of its own, because
       no side's place is known to a small part of a cell beside another's.

s0 and s1 are those with which the residuals' squares are what they are in the mean:

    |r|^2    =  s0 |M|^2   + s1 |M U|^2    + |M W|^2
    |U'r|^2  =  s0 |M'U|^2 + s1 |U'M U|^2  + |U'M W|^2

Then s0 is made less where the fit holds far points back, and where it is of cells: the more of the cells that the
outline crosses were hit, the better their errors even out. s1 is made more where few scans tell it. Of points whose
scans are not known, all that may be shared is taken as shared: what they scatter beyond cells and the noise that is
told. So points alone have wider deviations than a grid, unless the sensor's noise is told.

In:  a ``Linearised`` fit, the points' scans, the noise that is told, in metres.
Out: the covariance of its numbers, shape (P, P).

>>> bearing, rng = np.arange(200) * np.pi / 100, np.random.default_rng(0)
>>> normals = np.column_stack([np.cos(bearing), np.sin(bearing)])
>>> slopes, r = -np.column_stack([normals, np.ones(200)]), rng.normal(0, 0.002, 200)  # of a circle: x, y, radius
>>> effect = -np.linalg.pinv(slopes)
>>> fit = Linearised(effect, slopes, effect * r, r, normals, 0.1 * normals, np.zeros(200, dtype=int), 0.6)
>>> every_point_another_scan = np.arange(1, 201)
>>> bool(covariance(fit, every_point_another_scan)[2, 2] ** 0.5 < 1.3 * 0.002 / 200**0.5)
True

Sources: Henderson (1953), "Estimation of variance and covariance components"; for the saw-tooth Widrow and Kollar
(2008), "Quantization noise"; for far points Huber (1964), "Robust estimation of a location parameter".
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arguments import Bools, Floats, Ints
from .scatter import CELL, CELL_STD, LEAST_SPREAD, MEAN_ACROSS

PHASE_STD = 0.5  # cells: as far as it is not known where in its cell a point lies along its side
EVEN_OUT = 0.85  # share of the cells' errors that evens out when all cells are hit: not that around corners
# About half of what Student's t would add in the variance: a pose far off raises the residuals as well as the error.
STUDENT = 1.2
BEAM_STEP = 0.008  # m: about as far apart one scan of the paper's sensor hits an outline; for scans that are not known


@dataclass(frozen=True, eq=False)
class Linearised:
    """A fit to first order."""

    effect: Floats  # (P, N), how the numbers follow each point's error
    slopes: Floats  # (N, P), how residuals follow the numbers
    pulls: Floats  # (P, N), ``effect * residuals``, where the fit does not hold back far points
    residuals: Floats  # (N,), how far each point lies outside
    normals: Floats  # (N, 2), outwards at each point
    points: Floats
    pieces: Ints  # (N,), on which piece of the outline, straight or nearly so, each lies
    length: float  # of the outline


def covariance(fit: Linearised, scans: Ints, noise_std: float = 0.0) -> Floats:
    """Return the covariance of the fitted numbers, shape (P, P), where ranges err by ``noise_std`` on their own."""
    from scipy.sparse import csr_array

    a, b, r = fit.effect, fit.slopes, fit.residuals
    n, aa, bb = len(r), a @ a.T, b.T @ b
    known = np.flatnonzero(scans > 0)
    numbers, of_scan = np.unique(scans[known], return_inverse=True)
    u = csr_array(
        (fit.normals[known].ravel(), (np.add.outer(2 * of_scan, [0, 1]).ravel(), np.repeat(known, 2))),
        shape=(2 * len(numbers), n),
    )  # U'
    uu, ua, ub = u @ u.T, u @ a.T, u @ b
    m2 = n + 2 * np.trace(a @ b) + (aa * bb).sum()  # |M|^2, and so on
    mu2 = uu.trace() + 2 * (ua * ub).sum() + (ua * (ua @ bb)).sum()
    um2 = uu.trace() + 2 * (ua * ub).sum() + (ub * (ub @ aa)).sum()
    umu2 = (uu**2).sum() + 2 * ((uu @ ub) * ua).sum() + ((ua.T @ ua) * (ub.T @ ub)).sum()

    squares = float(r @ r)
    noise = max(squares / m2 - LEAST_SPREAD**2, 0.0)
    w = _waves(fit, noise)
    aw = a @ w
    mw = w + b @ aw
    left = squares - (mw**2).sum(), ((u @ r) ** 2).sum() - ((u @ mw) ** 2).sum()
    alone, shared = _parts(((m2, mu2), (um2, umu2)), left)

    of_cells = max(CELL_STD**2 - (w**2).sum() / n, 0.0)  # what is not in the waves
    crossed = np.abs(fit.normals).sum(axis=1).mean() * fit.length / CELL  # cells
    still = np.exp(-((np.pi / CELL) ** 2) * noise)
    alone = max(alone, of_cells) - EVEN_OUT * min(n / crossed, 1.0) * still * of_cells
    if noise > 0:
        with np.errstate(invalid="ignore"):  # where no point tells of a number, none is known
            alone *= np.mean((fit.pulls**2).sum(axis=1) / np.diag(aa)) / (squares / n)
    if shared > 0:
        shared *= 1 + STUDENT * ((uu @ uu) ** 2).sum() / (uu**2).sum() ** 2  # one over the degrees of freedom
    unknown = squares / max(n - len(a), 1) - LEAST_SPREAD**2 - MEAN_ACROSS * noise_std**2
    maybe = a @ _alike(fit, scans <= 0) * max(unknown, 0.0) ** 0.5
    whole: Floats = alone * aa + shared * ua.T @ ua + aw @ aw.T + maybe @ maybe.T
    return whole


def _waves(fit: Linearised, noise: float) -> Floats:
    """Return W, shape (N, Q), for noise of this variance, square metres: the last of four waves stands for the rest."""
    m = np.arange(1, 5)
    std = 1 / (2**0.5 * np.pi * m)  # cells
    std[-1] = (1 / 12 - (std[:-1] ** 2).sum()) ** 0.5  # 1/12 is the saw-tooth's variance
    across = fit.normals[..., None]  # in x and in y; along it is the other's
    unknown = noise * across**2 + (PHASE_STD * CELL * across[:, ::-1]) ** 2
    turn = 2 * np.pi * m / CELL
    size = CELL * std * across * np.exp(-(turn**2) * unknown / 2)
    phase = turn * (fit.points - fit.residuals[:, None] * fit.normals)[..., None]
    waves = np.concatenate([size * np.cos(phase), size * np.sin(phase)], axis=2).reshape(len(phase), -1)
    on_piece = fit.pieces[:, None] == np.unique(fit.pieces)
    every: Floats = (waves[:, :, None] * on_piece[:, None]).reshape(len(phase), -1)
    return every


def _parts(means: tuple[tuple[float, float], tuple[float, float]], squares: tuple[float, float]) -> tuple[float, float]:
    """Return s0 and s1, neither below zero: two equations with two unknowns."""
    (a, b), (c, d) = means
    x, y = squares
    determinant = a * d - b * c
    if determinant <= 1e-9 * a * d:  # no scan is known, or none saw two points
        return max(x / a, 0.0), 0.0
    alone, shared = (d * x - b * y) / determinant, (a * y - c * x) / determinant
    if shared < 0:
        return max(x / a, 0.0), 0.0
    return (0.0, max(y / d, 0.0)) if alone < 0 else (alone, shared)


def _alike(fit: Linearised, unknown: Bools) -> Floats:
    """Return F, shape (N, 6): F F' is to what share points of unknown scans err alike, zero for the others.

    Another point is of the same scan by 1 in as many as scans there would be, BEAM_STEP apart along the outline. Then
    it errs by n . n' of what the first errs; and scans see both the less, the more these turn away from each other:
    (1 + n . n') / 2.
    """
    n = fit.normals * unknown[:, None]
    same_scan = min(fit.length / BEAM_STEP / len(n), 1.0)
    turned = (n[:, :, None] * n[:, None]).reshape(-1, 4)
    both: Floats = np.hstack([n, turned]) * (same_scan / 2) ** 0.5
    return both
