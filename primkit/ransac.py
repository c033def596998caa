"""RANSAC: the one consensus loop, for any model.

RANSAC draws the few points that fix a line or circle, counts how many others agree with it, and keeps the model with
the largest consensus set. All samples are scored as one matrix, trials x points, in blocks that fit the cache.

In:  points, shape (N, 2), or (N, 3) in space, metres; a ``Model``; a threshold in metres.
Out: ``Consensus``: the model's parameters and which points agree with them; ``None`` when no sample fixed one.

>>> from primkit.lines import LINE
>>> points = [(0, 0), (1, 0), (2, 0), (3, 0), (1, 1)]
>>> run_ransac(points, LINE, threshold=0.01, trials=50, rng=0).inliers.tolist()
[True, True, True, True, False]

Sources: Fischler and Bolles (1981), "Random sample consensus"; the truncated score is that of Torr and
Zisserman (2000), "MLESAC"; the refit that of Chum, Matas and Kittler (2003), "Locally optimized RANSAC".
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .arguments import ROUNDING, Floats, as_count, as_points, as_positive, as_rng, as_share, check_type, limit, short

RESIDUALS_AT_ONCE = 250_000  # residuals in one block of the matrix: 2 MB, about the size of a core's cache
MOST_TRIALS = 1_000_000  # all are drawn at once: 50 MB of samples of three points
REFITS = 10  # refitting to the inliers settles within a few rounds; ten is a safe end


@dataclass(frozen=True)
class Model:
    """What RANSAC must know of a model.

    Parameters
    ----------
    sample_size : int
        Number of points that fix the model.
    from_samples : callable
        (T, sample_size, D) points -> (T, Q) parameters; a row of NaN where a sample fixes nothing.
    residuals : callable
        (T, Q) parameters, (N, D) points -> (T, N) distances in metres, zero or more.
    fit : callable
        (N, D) points -> (Q,) parameters of the best fit.
    coordinates : int
        How many a point has: D.
    """

    sample_size: int
    from_samples: Callable[[Floats], Floats]
    residuals: Callable[[Floats, Floats], Floats]
    fit: Callable[[Floats], Floats]
    coordinates: int = 2


@dataclass(frozen=True, eq=False)
class Consensus:
    """The model that most points agree with: its parameters, shape (Q,).

    ``inliers``, shape (N,), are the points within the threshold of exactly this model, boundary included.
    """

    params: Floats
    inliers: NDArray[np.bool_]


def run_ransac(
    points: ArrayLike,
    model: Model,
    threshold: float,
    *,
    trials: int = 1000,
    score: Literal["count", "truncated"] = "count",
    refit: bool = True,
    rng: int | np.random.Generator | None = None,
) -> Consensus | None:
    """Return the model with the largest consensus set among random samples; None when no sample fixes one.

    Raises ValueError if points are not finite (N, D), the threshold is negative, there is not at least one trial, or
    the score is unknown.

    Parameters
    ----------
    points : array_like, shape (N, D), metres: as many coordinates as the model's points have
    model : Model
        What is looked for: ``lines.LINE``, ``circles.CIRCLE`` or one of your own.
    threshold : float
        A point agrees when its residual is at most this, in metres.
    trials : int, number of samples: see ``trials_needed``
    score : {"count", "truncated"}
        What makes a model good: the number of its inliers, or the sum of min(residual, threshold)^2, which also asks
        how well the inliers fit.
    refit : bool
        Fit the model to its inliers, and take the inliers anew, until nothing changes.
    rng : seed or numpy.random.Generator, optional

    Examples
    --------
    >>> from primkit.lines import LINE
    >>> run_ransac([(0, 0)], LINE, threshold=0.01) is None
    True
    >>> run_ransac([(0, 0), (0, 0)], LINE, threshold=0.01, rng=0) is None
    True
    """
    check_type(model, Model, "model must be a Model, such as lines.LINE")
    points = as_points(points, d=model.coordinates)
    threshold, trials = as_positive(threshold, "threshold", zero=True), as_count(trials, "trials")
    limit(trials, MOST_TRIALS, "trials must be at most {}", "see trials_needed")
    if score not in ("count", "truncated"):
        raise ValueError(f'score must be "count" or "truncated", got {short(score)}')
    if len(points) < model.sample_size:
        return None
    samples = draw_samples(len(points), model.sample_size, trials, as_rng(rng))
    candidates = model.from_samples(points[samples])
    candidates = candidates[np.isfinite(candidates).all(axis=1)]
    if len(candidates) == 0:
        return None

    merit = _merits(points, model, candidates, threshold, score)
    best = candidates[np.argmax(merit)]
    inliers = _agree(model.residuals(best[None], points)[0], threshold)
    return _refitted(points, model, best, inliers, threshold) if refit else Consensus(best, inliers)


def draw_samples(n: int, size: int, trials: int, rng: np.random.Generator) -> NDArray[np.int64]:
    """Return random samples of ``size`` different indices below n, shape (trials, size).

    >>> draw_samples(3, 3, 2, np.random.default_rng(0)).sum(axis=1).tolist()
    [3, 3]
    """
    picks = rng.integers(0, n - np.arange(size), size=(trials, size))
    for k in range(1, size):  # the k-th pick counts only the indices that are still free
        for earlier in np.sort(picks[:, :k], axis=1).T:
            picks[:, k] += picks[:, k] >= earlier
    return picks


def trials_needed(inlier_share: float, sample_size: int, confidence: float = 0.99) -> int:
    """Return how many samples make it likely that one is all inliers.

    ``N = log(1 - p) / log(1 - w^m)`` with confidence p, share of inliers w and sample size m (Fischler and Bolles,
    1981). Raises ValueError if the share is not above 0 and at most 1, or the confidence not between 0 and 1.

    >>> trials_needed(0.5, 2), trials_needed(0.5, 3), trials_needed(1.0, 2)
    (17, 35, 1)
    """
    if as_share(inlier_share, "inlier_share", rule := "above 0 and at most 1") == 0:
        raise ValueError(f"inlier_share must be {rule}, got 0")
    if as_share(confidence, "confidence", "between 0 and 1") in (0, 1):
        raise ValueError(f"confidence must be between 0 and 1, got {confidence:g}")
    clean = inlier_share ** as_count(sample_size, "sample_size")
    if clean == 0:
        raise ValueError(f"inlier_share must be large enough to draw a clean sample at all, got {inlier_share:g}")
    if clean == 1:
        return 1
    return max(1, int(np.ceil(np.log1p(-confidence) / np.log1p(-clean))))


def _agree(residuals: Floats, threshold: float) -> NDArray[np.bool_]:
    """Return which residuals are within the threshold, boundary included, also where rounding blurs it."""
    return residuals <= threshold + ROUNDING


def _merits(points: Floats, model: Model, candidates: Floats, threshold: float, score: str) -> Floats:
    """Return how good each candidate is, shape (T,); larger is better."""
    step = max(1, RESIDUALS_AT_ONCE // len(points))
    merits = []
    for start in range(0, len(candidates), step):
        residuals = model.residuals(candidates[start : start + step], points)
        if score == "count":
            merits.append(np.count_nonzero(_agree(residuals, threshold), axis=1).astype(float))
        else:
            merits.append(-(np.minimum(residuals, threshold) ** 2).sum(axis=1))
    return np.concatenate(merits)


def _refitted(points: Floats, model: Model, best: Floats, inliers: NDArray[np.bool_], threshold: float) -> Consensus:
    """Fit the model to its inliers until they no longer change; never give up inliers for it."""
    for _ in range(REFITS):
        if np.count_nonzero(inliers) < model.sample_size:
            break
        params = model.fit(points[inliers])
        if not np.isfinite(params).all():
            break
        agreeing = _agree(model.residuals(params[None], points)[0], threshold)
        if np.count_nonzero(agreeing) < np.count_nonzero(inliers):
            break
        settled = np.array_equal(agreeing, inliers)
        best, inliers = params, agreeing
        if settled:
            break
    return Consensus(best, inliers)
