"""An honest choice: each map is scored by the setting that was best on the other folds.

In:  the student's ``honest_score``.
Out: marks.

>>> HONEST_SCORE.mark(held_out)
4.0
"""

# ruff: noqa: ARG005 (a wrong way may leave out what it is given)

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from primkit.checks.judges import number

from ..parts import Fault, task

Floats = NDArray[np.float64]

CASES = 40  # random ones, in each part


def held_out(scores: Floats, folds: NDArray[np.int64]) -> float:
    """Return the mean score over all maps, each scored by the setting that was best on the other folds."""
    scores = np.nan_to_num(scores)
    return float(np.mean([scores[chosen(scores, folds != fold), k] for k, fold in enumerate(folds)]))


def chosen(scores: Floats, maps: NDArray[np.bool_]) -> int:
    """Return the first of the settings that are best on some maps."""
    return int(np.argmax(scores[:, maps].mean(axis=1)))


def honest_like(choose: Any = None, clean: Any = np.nan_to_num, mean: Any = None) -> Any:
    """Return a wrong way: another choice for a fold, another treatment of crashes, another mean."""
    choose = choose or (lambda scores, train: int(np.argmax(scores[:, train].mean(axis=1))))

    def score(scores: Floats, folds: NDArray[np.int64]) -> float:
        table = clean(scores)
        own = np.array([table[choose(table, folds != fold), k] for k, fold in enumerate(folds)])
        return float(own.mean() if mean is None else mean(own, folds))

    return score


def without_crashes(scores: Floats, folds: NDArray[np.int64]) -> float:
    """Leave crashed maps out of all means."""
    own = [scores[int(np.argmax(np.nanmean(scores[:, folds != fold], axis=1))), k] for k, fold in enumerate(folds)]
    return float(np.nanmean(own))


def last_of_ties(scores: Floats, train: NDArray[np.bool_]) -> int:
    """Return the last of the best."""
    means = scores[:, train].mean(axis=1)
    return int(np.flatnonzero(means == means.max())[-1])


def mean_of_folds(own: Floats, folds: NDArray[np.int64]) -> float:
    """Return the mean of the folds' means."""
    return float(np.mean([own[folds == fold].mean() for fold in np.unique(folds)]))


def studies(rng: np.random.Generator, sizes: Sequence[int], *, crash: float = 0.0, steps: int = 0) -> Any:
    """Yield tables of scores whose settings are about equally good; in steps there are ties."""
    for _ in range(CASES):
        folds = rng.permutation(np.repeat(np.arange(len(sizes)) + 1, sizes))
        scores = rng.uniform(0.3, 1.0, (int(rng.integers(3, 6)), len(folds)))
        if steps:
            scores = rng.integers(2, steps + 1, scores.shape) / steps
        yield np.where(rng.random(scores.shape) < crash, np.nan, scores), folds


def equal_folds(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield folds of the same size."""
    yield np.array([[1.0, 0.5], [0.75, 0.75]]), np.array([0, 1])
    yield from studies(rng, (3, 3, 3))


def unequal_folds(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield folds of different sizes."""
    yield from studies(rng, (1, 2, 6))


def crashes(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield tables with crashed maps."""
    yield from studies(rng, (3, 3, 3), crash=0.15)


def ties(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield tables in which two settings are often equally good; all sums are exact."""
    yield from studies(rng, (2, 2, 2), steps=4)


HONEST_SCORE = task(
    "honest_score",
    held_out,
    number(""),
    (
        ("folds of the same size", 1, equal_folds),
        ("folds of different sizes", 1, unequal_folds),
        ("maps on which a setting crashed", 1, crashes),
        ("settings that are equally good", 1, ties),
    ),
    (
        Fault(
            "The setting was chosen on the very maps that it is scored on: that flatters.",
            like=honest_like(lambda scores, train: int(np.argmax(scores[:, ~train].mean(axis=1)))),
            name="chosen on the test maps",
        ),
        Fault(
            "The setting was chosen on all maps, those that it is scored on among them: that flatters.",
            like=honest_like(lambda scores, train: int(np.argmax(scores.mean(axis=1)))),
            name="chosen on all maps",
        ),
        Fault(
            "Each map has its own best setting here: nobody knows that before the map is scored.",
            like=lambda scores, folds: float(np.nan_to_num(scores).max(axis=0).mean()),
            name="best of each map",
        ),
        Fault(
            "Each map counts alike, in a large fold as in a small one.",
            like=honest_like(mean=mean_of_folds),
            name="mean of the folds' means",
        ),
        Fault(
            "A map on which a setting crashes counts as 0; left out, crashing would pay.",
            like=without_crashes,
            name="crashes left out",
        ),
        Fault(
            "Of settings that are equally good, the first counts.",
            like=honest_like(last_of_ties),
            name="last of ties",
        ),
        Fault(
            "nan comes back: a crash counts as 0.",
            when=lambda cases: any(isinstance(case.got, float) and np.isnan(case.got) for case in cases),
            name="nan spreads",
        ),
    ),
)
