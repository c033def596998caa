"""A wall in fog: the line with most inliers among those with no hit behind them.

In:  the student's ``wall_in_fog``.
Out: marks.

>>> WALL_IN_FOG.mark(last_wall)
4.0
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

import primkit as pk

from ..parts import TURN, Fault, numbers, shown, task, turn_between

Floats = NDArray[np.float64]


def last_wall(points: Floats, threshold: float, rng: Any = None) -> tuple[float, float] | None:
    """Return the line with most inliers among those with no hit behind them, as (angle, offset); tries all pairs."""
    first, second = np.triu_indices(len(points), 1)
    step = points[second] - points[first]
    length = np.hypot(*step.T)
    first, step, length = first[length > 0], step[length > 0], length[length > 0]
    if not len(first):
        return None
    normals = np.column_stack([-step[:, 1], step[:, 0]]) / length[:, None]
    offsets = (normals * points[first]).sum(axis=1)
    turned = np.where(offsets < 0, -1.0, 1.0)  # away from the robot
    out = points @ (normals * turned[:, None]).T - offsets * turned  # (N, lines), above zero: behind
    inliers = (np.abs(out) <= threshold).sum(axis=0)
    best = int(np.argmax(np.where((out <= threshold).all(axis=0), inliers, 0)))
    line = pk.fit_line(points[np.abs(out[:, best]) <= threshold])
    return None if line is None else (line.angle, line.offset)


def judge_wall(got: Any, expected: Any, args: tuple[Any, ...]) -> str | None:
    """Judge a line, within 0.03 rad and, at the wall's middle, 3 mm; either normal will do."""
    if expected is None or got is None:
        return None if got is expected else f"got {shown(got)}, expected {shown(expected)}"
    pair = numbers(got, 2)
    if pair is None or not np.isfinite(pair).all():
        return f"got {shown(got)}, expected (angle, offset)"
    turned = turn_between(pair[0], expected[0], np.pi)
    if abs(turned) > 0.03:
        return f"the line is turned by {np.degrees(turned):.1f} degrees"
    wall, hits = pk.Line(*expected), args[0].mean(axis=0)
    before_them = (
        hits - wall.signed_distance([hits])[0] * wall.normal
    )  # the place on the wall that is nearest to the hits
    off = abs(float(pk.Line(*pair).signed_distance([before_them])[0]))
    return None if off <= 0.003 else f"the line has the right direction, but is off by {1000 * off:.1f} mm"


def foggy(rng: np.random.Generator, row: int) -> tuple[Floats, float, np.random.Generator]:
    """Return hits in fog before a wall, with ``row`` hits on a straight row before it, shuffled; threshold 3 mm.

    The wall goes on farther to one side, so that its farthest hits are neighbours.
    """
    bearing, away = rng.uniform(0, TURN), rng.uniform(0.3, 0.5)
    shift = rng.choice([-1, 1]) * rng.uniform(0.1, 0.25)
    ahead, aside = np.array([np.cos(bearing), np.sin(bearing)]), np.array([-np.sin(bearing), np.cos(bearing)])

    def place(out: Any, side: Any) -> Floats:
        return np.multiply.outer(out, ahead) + np.multiply.outer(side + shift, aside)

    wall = place(away + rng.uniform(-0.001, 0.001, 30), np.linspace(-0.4, 0.4, 30) + rng.uniform(-0.01, 0.01, 30))
    fog = place(rng.uniform(0.05, away - 0.02, 45), rng.uniform(-0.4, 0.4, 45))
    tilt = rng.uniform(-0.4, 0.4)
    side = rng.uniform(-0.3, 0.3, row)
    drops = place(0.6 * away + np.tan(tilt) * 0.25 * side + rng.uniform(-0.001, 0.001, row), side)
    return rng.permutation(np.vstack([wall, fog, drops])), 0.003, np.random.default_rng(1)


def in_fog(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield walls behind evenly spread fog."""
    for _ in range(6):
        yield foggy(rng, 0)


def behind_a_row(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield walls behind fog and a straight row of drops, on which there are more hits than on the wall."""
    for _ in range(6):
        yield foggy(rng, 50)


def few_points(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield too few points for a line, and just enough."""
    seed = np.random.default_rng(1)
    yield np.array([[0.3, 0.1]]), 0.003, seed
    yield np.array([[0.3, 0.1]] * 4), 0.003, seed
    yield np.zeros((0, 2)), 0.003, seed
    yield np.array([[0.3, -0.1], [0.3, 0.1]]), 0.003, seed


def hits_behind(cases: Any) -> bool:
    """Tell whether every wrong line has hits far behind it, seen from the robot."""
    wrong = [(numbers(case.got, 2), case.args) for case in cases if case.off]
    return all(line is not None and behind(line, *args[:2]) for line, args in wrong)


def behind(line: Any, points: Floats, threshold: float) -> bool:
    """Tell whether some points lie behind a line, by more than three thresholds."""
    out = pk.Line(*line).signed_distance(points) * (1 if line[1] >= 0 else -1)
    return bool((out > 3 * threshold).any())


def through_all(points: Floats, _threshold: float, _rng: Any) -> Any:
    """Fit all points at once."""
    line = pk.fit_line(points)
    return None if line is None else (line.angle, line.offset)


def through_farthest(points: Floats, _threshold: float, _rng: Any) -> Any:
    """Take the line through the two hits that are farthest from the robot."""
    if len(np.unique(points, axis=0)) < 2:
        return None
    line = pk.fit_line(points[np.argsort(np.hypot(*points.T))[-2:]])
    return None if line is None else (line.angle, line.offset)


WALL_IN_FOG = task(
    "wall_in_fog",
    last_wall,
    judge_wall,
    (
        ("a wall behind fog", 1, in_fog),
        ("a straight row of drops in front, with more hits than the wall", 2, behind_a_row),
        ("too few points, and just enough", 1, few_points),
    ),
    (
        Fault(
            "Least squares over all hits finds the middle of the fog: not all hits belong to the wall.",
            like=through_all,
            name="least squares over all",
        ),
        Fault(
            "The two farthest hits may be neighbours: a line through them turns with their errors.",
            like=through_farthest,
            name="line through the farthest hits",
        ),
        Fault(
            "There are hits behind this line, and light does not come through a wall: most inliers are not enough.",
            when=hits_behind,
            name="hits behind the wall",
        ),
        Fault(
            "A line comes back where the hits fix none.",
            when=lambda cases: all(case.got is not None and case.expected is None for case in cases if case.off),
            name="a line from one point",
        ),
    ),
)
