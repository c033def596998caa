"""Edges: the line through a sample, its inliers, the best fit, and the loop around them; the checks of lesson 04.

In:  the student's ``line_through(p, q)``, ``inliers_of(points, line, threshold)``, ``fit_line(points)`` and
     ``ransac_line(points, threshold, trials, rng)``.
Out: answers. A line is (angle, offset) of ``n . p = d``: the bearing of its unit normal n, and d in metres.

>>> line_through(lambda p, q: ...)
○ not attempted: line_through still returns `...`.
>>> inliers_of.reference(np.array([(0.2, 0.0), (0.3, 5.0)]), (0.0, 0.2), 0.1).tolist()
[True, True]
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..arguments import ROUNDING, Bools, Floats
from ..lines import LINE
from ..lines import fit_line as best_fit
from ..ransac import run_ransac
from .answer import Case, Check, Fault, off_only_where
from .cases import Args
from .judges import CLOSE, array, as_line, as_marks, is_pair, line, marks, no_return, number, shown
from .walls import bands, clouds, pairs, scenes

Pair = tuple[float, float]  # angle and offset of a line

LEAST_INLIERS = 0.9  # of those that the library's line has: another sample may miss a few at the wall's ends
MOST_OFF_FIT = 1.0  # of the threshold, from the best fit of a line's inliers; one refit comes to 0.6


def through(p: Floats, q: Floats) -> Pair | None:
    """Return the line through two points; None when they are the same."""
    along = q - p
    if not along.any():
        return None
    angle = float(np.arctan2(-along[0], along[1]))  # a quarter turn from the line's own direction
    return angle, float(p @ (np.cos(angle), np.sin(angle)))


def near(points: Floats, line: Any, threshold: float) -> Bools:
    """Return which points are at most ``threshold`` metres from a line, boundary included."""
    angle, offset = as_line(line) or line  # a Line, or its two numbers
    inside: Bools = np.abs(points @ (np.cos(angle), np.sin(angle)) - offset) <= threshold + ROUNDING
    return inside


def fit_best(points: Floats) -> Pair | None:
    """Return the line with the least squared distances; None for fewer than two different points."""
    return as_line(best_fit(points))


def best_of(points: Floats, threshold: float, trials: int, rng: Any) -> tuple[Pair, Bools] | None:
    """Return the best line among random samples, refitted, and its inliers; None when no sample fixes a line."""
    found = run_ransac(points, LINE, threshold, trials=trials, rng=rng)
    if found is None:
        return None
    angle, offset = found.params.tolist()
    return (angle, offset), found.inliers


NOT_ITS_OWN, NOT_REFITTED, FEW = "not those within the threshold of the line", "best fit of its own inliers", "got only"


def _judge_consensus(got: Any, expected: Any, args: Args) -> str | None:
    """Judge a line and its inliers against the points: they must agree, be many, and be fit_best."""
    points, threshold = args[0], args[1]
    wanted = "None" if expected is None else "a line (angle, offset) and True or False for each point"
    if expected is None or got is None:
        return None if got is expected else f"got {shown(got)}, expected {wanted}{no_return(got)}"
    pair = got if is_pair(got) else (None, None)
    own, mask = as_line(pair[0]), as_marks(pair[1], len(points))
    if own is None or mask is None or not np.isfinite(own).all():
        return f"got {shown(got)}, expected {wanted}"
    distance = np.abs(points @ (np.cos(own[0]), np.sin(own[0])) - own[1])
    wrong = (mask != (distance <= threshold)) & (np.abs(distance - threshold) > CLOSE)
    if wrong.any():
        return f"{int(wrong.sum())} of the inliers are {NOT_ITS_OWN} that is returned"
    most = int(expected[1].sum())
    if mask.sum() < LEAST_INLIERS * most:
        return f"{FEW} {int(mask.sum())} inliers, expected about {most}"
    best = fit_best(points[mask]) or own  # so many inliers always fix a line
    off = float(np.abs(_apart(points[mask], best, own)).max())
    # Only a sample goes exactly through two points; it may stay where a refit would lose inliers.
    sampled = off > CLOSE and (distance <= CLOSE).sum() >= 2 and near(points, best, threshold).sum() >= mask.sum()
    fits = off <= MOST_OFF_FIT * threshold and not sampled
    return None if fits else f"the line is {shown(1000 * off)} mm off the {NOT_REFITTED}"


def _apart(points: Floats, one: Pair, other: Pair) -> Floats:
    """Return how far apart two lines are at points, metres; the opposite normal is the same line."""
    (a, b), (c, d) = one, other
    sign = 1.0 if np.cos(a - c) > 0 else -1.0
    apart: Floats = (points @ (np.cos(a), np.sin(a)) - b) - sign * (points @ (np.cos(c), np.sin(c)) - d)
    return apart


def _through(change: Any) -> Any:
    """Return ``through`` with its angle a and offset d changed by one mistake."""
    return lambda p, q: (found := through(p, q)) and change(*found)


def _along(p: Floats, q: Floats) -> Pair:
    """Return the line with the bearing of its direction in the place of its normal's."""
    angle = float(np.arctan2(*(q - p)[::-1]))
    return angle, float(p @ (np.cos(angle), np.sin(angle)))


def _near_with(distance: Any) -> Any:
    """Return ``near`` with another idea of distance."""
    return lambda points, line, threshold: distance(points, *(as_line(line) or line)) <= threshold + ROUNDING


def _offset_first(cases: list[Case]) -> bool:
    """Tell whether the two numbers of each line came back in the other order."""
    turned = [(mine and mine[::-1], case) for case in cases for mine in [as_line(case.got)]]
    return all(line()(mine, case.expected, case.args) is None for mine, case in turned)


def _least_squares_in_y(cases: list[Case]) -> bool:
    """Tell whether walls that are not too steep came back as the fit of y = a x + b."""
    judge, flat = line(), [c for c in cases if np.ptp(c.args[0][:, 0]) > 0.1 and np.ptp(c.args[0][:, 1]) > 0.05]
    return all(judge(case.got, _y_on_x(case.args[0]), case.args) is None for case in flat)


def _y_on_x(points: Floats) -> Pair:
    """Return the line y = a x + b with the least squares along y."""
    x, y = (points - points.mean(axis=0)).T
    angle = float(np.arctan2(1.0, -(x @ y) / (x @ x)))
    return angle, float(points.mean(axis=0) @ (np.cos(angle), np.sin(angle)))


def _by_svd(row: int, *, centred: bool = True, columns: bool = False) -> Any:
    """Return a fit that takes the wrong direction, forgets to centre, or reads columns for rows."""

    def fit(points: Floats) -> Pair | None:
        if fit_best(points) is None:
            return None
        directions = np.linalg.svd(points - points.mean(axis=0) * centred)[2]
        normal = (directions.T if columns else directions)[row]
        return float(np.arctan2(normal[1], normal[0])), float(normal @ points.mean(axis=0))

    return fit


_NO_LINE = off_only_where(lambda case: case.expected is None)


def _judged_with(words: str) -> Any:
    """Return a predicate: some case was judged with these words."""
    return lambda cases: any(words in (case.off or "") for case in cases)


line_through = Check(
    "line_through",
    through,
    pairs,
    line(),
    (
        Fault("Twice the same point fixes no line: return None before anything is divided.", when=_NO_LINE),
        Fault(
            "Upright lines come out wrong: is something divided by a difference in x?",
            when=off_only_where(lambda case: case.args[0][0] == case.args[1][0]),
        ),
        Fault(
            "That is the bearing of the line itself: its normal is a quarter turn away.",
            like=lambda p, q: through(p, q) and _along(p, q),
        ),
        Fault(
            "The offset has a sign: it belongs to the normal that you return.", like=_through(lambda a, d: (a, abs(d)))
        ),
        Fault(
            "Are x and y in the right places? np.arctan2 takes y first, then x.",
            like=_through(lambda a, d: (np.pi / 2 - a, d)),
        ),
        Fault("A line is (angle, offset): the angle comes first.", when=_offset_first),
        Fault(
            "The normal must have length 1: else the offset is no distance in metres.",
            like=lambda p, q: (found := through(p, q)) and (found[0], found[1] * float(np.hypot(*(q - p)))),
        ),
    ),
)

inliers_of = Check(
    "inliers_of",
    near,
    bands,
    marks("points", "inliers"),
    (
        Fault(
            "That is how many they are: asked for is True or False for each point.",
            like=lambda *args: near(*args).sum(),
            judge=number(),
        ),
        Fault(
            "Those are the numbers of the inliers: asked for is True or False for each point.",
            like=(lambda *args: np.flatnonzero(near(*args)), lambda *args: np.nonzero(near(*args))),
            judge=array(),
        ),
        Fault(
            "A point exactly on the boundary is an inlier: < or <= ?",
            like=lambda points, line, threshold: near(points, line, threshold - 2 * ROUNDING),
        ),
        Fault(
            "Points far away on one side are inliers: a signed distance below zero is small, but not near.",
            like=_near_with(lambda p, a, d: p @ (np.cos(a), np.sin(a)) - d),
        ),
        Fault(
            "Is the offset subtracted? n . p alone is the distance from a line through the origin.",
            like=_near_with(lambda p, a, _d: np.abs(p @ (np.cos(a), np.sin(a)))),
        ),
    ),
)

fit_line = Check(
    "fit_line",
    fit_best,
    clouds,
    line(),
    (
        Fault("Fewer than two different points fix no line: return None.", when=_NO_LINE),
        Fault("That fits y = a x + b: it measures along y, and upright walls fail.", when=_least_squares_in_y),
        Fault("That is the direction of most scatter, along the wall: the normal is across.", like=_by_svd(0)),
        Fault("The directions are the rows of what svd returns, not its columns.", like=_by_svd(1, columns=True)),
        Fault("Is the mean subtracted before the directions are taken?", like=_by_svd(1, centred=False)),
    ),
)

ransac_line = Check(
    "ransac_line",
    best_of,
    scenes,
    _judge_consensus,
    (
        Fault("Where no two points differ there is no line: return None.", when=_NO_LINE),
        Fault(
            "Inliers belong to the line that is returned: take them anew after the refit.",
            when=_judged_with(NOT_ITS_OWN),
        ),
        Fault(
            "Far fewer inliers than possible: is the best trial kept, or the first, or the last?",
            when=_judged_with(FEW),
        ),
        Fault(
            "The line still goes through its two points: fit it to all its inliers.", when=_judged_with(NOT_REFITTED)
        ),
    ),
)
