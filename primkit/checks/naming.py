"""Naming: corners, sides and centre of a polygon, and a fair choice between candidates; the checks of lesson 06.

In:  the student's ``meet(a, b)``, ``sides_and_centroid(corners)`` and ``fair_choice(squares, numbers, n_points,
     spread)``.
Out: answers.

>>> meet.reference((0.0, 0.2), (np.pi / 2, 0.1)).round(3).tolist()
[0.2, 0.1]
>>> fair_choice.reference(np.array([90e-6, 80e-6]), np.array([3, 10]), 100, 0.001)[0]
0
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arguments import Floats
from .answer import Case, Check, Fault, off_only_where
from .cases import Args, around, random_cases
from .judges import array, is_pair, no_return, number, shown

Pair = tuple[float, float]

LEAST_SINE = 1e-9  # between lines that are not parallel: far above rounding, far below any corner
LEAST_ANGLE = np.radians(5)  # of lines that do meet: their corner is then known to many digits
CORNER_TOLERANCE = 1e-7  # m: a corner of lines that bend by five degrees loses two digits
MARGIN_TOLERANCE = 1e-6


def meet_in(a: Pair, b: Pair) -> Floats | None:
    """Return where two lines ``n . p = d`` meet, shape (2,), metres; None when they are parallel.

    A line is the pair (angle of its normal in radians, offset in metres).
    """
    (angle_a, d_a), (angle_b, d_b) = a, b
    bend = np.sin(angle_b - angle_a)
    if abs(bend) < LEAST_SINE:
        return None
    x = d_a * np.sin(angle_b) - d_b * np.sin(angle_a)
    y = d_b * np.cos(angle_a) - d_a * np.cos(angle_b)
    return np.array([x, y]) / bend


def sides_and_center(corners: Floats) -> tuple[Floats, Floats]:
    """Return the lengths of the sides, from each corner to the next, shape (K,), and the centre of area, shape (2,)."""
    after = np.roll(corners, -1, axis=0)
    sides = np.hypot(*(after - corners).T)
    first = corners[0]  # near the origin no digits are lost
    (x, y), (u, v) = (corners - first).T, (after - first).T
    weight = x * v - u * y
    return sides, first + np.array([(x + u) @ weight, (y + v) @ weight]) / (3 * weight.sum())


def cheapest(squares: Floats, numbers: NDArray[np.int64], n_points: int, spread: float) -> tuple[int, float]:
    """Return which candidate costs least, and its margin: how much more the next one costs (inf without one)."""
    return _choose(_costs(squares, numbers, n_points, spread))


def _costs(squares: Floats, numbers: NDArray[np.int64], n_points: int, spread: float) -> Floats:
    return np.asarray(squares) / spread**2 + np.asarray(numbers) * np.log(n_points)


def _choose(costs: Floats) -> tuple[int, float]:
    order = np.argsort(costs, kind="stable")
    margin = costs[order[1]] - costs[order[0]] if len(costs) > 1 else np.inf
    return int(order[0]), float(margin)


# --- where two lines meet ----------------------------------------------------------------------------------------


def _line_cases(rng: np.random.Generator) -> Iterator[Args]:
    """Yield plain pairs and parallel ones, then random ones; every eighth of those is parallel."""
    yield (0.0, 0.2), (np.pi / 2, 0.1)
    yield (0.0, 0.2), (np.pi / 4, 0.0)
    yield (0.3, 0.2), (0.3, 0.1)  # parallel
    yield (0.0, 0.2), (np.pi, 0.2)  # parallel, with opposite normals

    def draw(n: int) -> Args | None:
        angle, other = rng.uniform(-np.pi, np.pi, 2).tolist()
        d, e = rng.uniform(-0.5, 0.5, 2).tolist()
        if n % 8 == 0:
            return (angle, d), (angle + np.pi * float(rng.integers(2)), e)
        return ((angle, d), (other, e)) if abs(np.sin(other - angle)) > np.sin(LEAST_ANGLE) else None

    yield from random_cases(draw)


def _judge_corner(got: Any, expected: Any, args: Args) -> str | None:
    """Judge a corner, or None for parallel lines."""
    if expected is None:
        return None if got is None else f"got {shown(got)}, expected None, because the lines are parallel"
    if got is None:
        return f"got None{no_return(got)}, expected the corner {shown(expected)}"
    return array("m", CORNER_TOLERANCE)(got, expected, args)


def _with(change: Callable[[Pair], Pair], sign: float = 1.0) -> Callable[[Pair, Pair], Floats | None]:
    """Return the corner of lines that were read in another way."""
    return lambda a, b: None if (found := meet_in(change(a), change(b))) is None else sign * found


meet = Check(
    "meet",
    meet_in,
    _line_cases,
    _judge_corner,
    (
        Fault(
            "Right but for parallel lines with opposite normals: sin(pi) is 1e-16 on a computer, and not 0.",
            when=off_only_where(lambda case: case.expected is None and case.args[0][0] != case.args[1][0]),
        ),
        Fault(
            "Every corner is right. Parallel lines have none: return None for them.",
            when=off_only_where(lambda case: case.expected is None),
        ),
        Fault(
            "The angle is that of the normal, which stands square on the line; it is not the line's own direction.",
            like=(
                _with(lambda line: (line[0] + np.pi / 2, line[1])),
                _with(lambda line: (line[0] - np.pi / 2, line[1])),
            ),
        ),
        Fault("Angles are in radians already.", like=_with(lambda line: (float(np.radians(line[0])), line[1]))),
    ),
)


# --- sides and centre of a polygon --------------------------------------------------------------------------------


def _corner_cases(rng: np.random.Generator) -> Iterator[Args]:
    """Yield a square, a triangle, one given clockwise, one far off; then random convex ones, every third clockwise."""
    square = np.array([(0.0, 0.0), (0.2, 0.0), (0.2, 0.1), (0.0, 0.1)])
    triangle = np.array([(0, 0), (0.3, 0), (0, 0.3)])
    house = np.array([(0.0, 0.0), (0.2, 0.0), (0.2, 0.1), (0.1, 0.15), (0.0, 0.1)])
    yield from ((square,), (house,), (triangle,), (house[::-1].copy(),), (house + np.array([3.0, -2.0]),))

    def draw(n: int) -> Args | None:
        k = int(rng.integers(3, 6))
        bearing = np.sort(rng.uniform(0, 2 * np.pi, k))
        if np.diff(bearing, append=bearing[0] + 2 * np.pi).max() > 0.95 * np.pi or np.diff(bearing).min() < 0.2:
            return None
        ring = around(rng.uniform(-0.4, 0.4, 2), rng.uniform(0.05, 0.1), bearing)
        return (ring[::-1].copy() if n % 3 == 2 else ring,)

    yield from random_cases(draw)


def _judge_sides_and_center(got: Any, expected: Any, args: Args) -> str | None:
    """Judge the lengths of the sides, then the centre."""
    if not is_pair(got):
        return f"got {shown(got)}, expected two things: the sides and the centre{no_return(got)}"
    for name, mine, wanted in zip(("sides", "centre"), got, expected, strict=True):
        off = array("m")(mine, wanted, args)
        if off is not None:
            return f"{name}: {off}"
    return None


def _with_center(centre: Callable[[Floats], Floats]) -> Callable[[Floats], tuple[Floats, Floats]]:
    """Return the right sides with another centre."""
    return lambda corners: (sides_and_center(corners)[0], centre(corners))


def _of_outline(corners: Floats) -> Floats:
    """Return the mean over the outline, instead of over the area."""
    sides, after = sides_and_center(corners)[0], np.roll(corners, -1, axis=0)
    return (corners + after).T @ sides / (2 * sides.sum())


def _unsigned(corners: Floats) -> Floats:
    """Return the centre with the area's sign forgotten: from the origin the wrong way when clockwise."""
    (x, y), (u, v) = corners.T, np.roll(corners, -1, axis=0).T
    return sides_and_center(corners)[1] * np.sign((x * v - u * y).sum())


def _one_side_short(cases: list[Case]) -> bool:
    """Tell whether in every case one side is missing."""
    return all(is_pair(case.got) and np.shape(case.got[0]) == (len(case.args[0]) - 1,) for case in cases)


sides_and_centroid = Check(
    "sides_and_centroid",
    sides_and_center,
    _corner_cases,
    _judge_sides_and_center,
    (
        Fault(
            "One side is missing: the outline is closed, so the last corner leads back to the first.",
            when=_one_side_short,
        ),
        Fault(
            "The sides are right, but each stands one place late: the first one leads from corner 0 to corner 1.",
            like=lambda corners: (np.roll(sides_and_center(corners)[0], 1), sides_and_center(corners)[1]),
        ),
        Fault(
            "The sides are right. That centre is the mean of the corners; where two corners stand close together, it "
            "is drawn to them, and the area's centre is not.",
            like=_with_center(lambda corners: corners.mean(axis=0)),
        ),
        Fault(
            "The sides are right. That centre is the mean along the outline, not over the area.",
            like=_with_center(_of_outline),
        ),
        Fault(
            "The sides are right. That centre is the middle of the extents, which changes when the shape turns.",
            like=_with_center(lambda corners: (corners.min(axis=0) + corners.max(axis=0)) / 2),
        ),
        Fault(
            "Right where the corners go counter-clockwise. Clockwise the area comes out negative, and so do the "
            "products above it: is the sign lost in one of the two?",
            like=_with_center(_unsigned),
        ),
        Fault(
            "The sides are right. The centre is halved: A is half of the sum of the cross products.",
            like=_with_center(lambda corners: sides_and_center(corners)[1] / 2),
        ),
    ),
)


# --- a fair choice ------------------------------------------------------------------------------------------------


def _choice_cases(rng: np.random.Generator) -> Iterator[Args]:
    """Yield a circle against a pentagon, one candidate alone, one that cannot be fitted; then random ones."""
    yield np.array([1.0e-4, 0.8e-4]), np.array([3, 10]), 100, 0.001
    yield np.array([4.0e-4, 0.8e-4]), np.array([3, 10]), 100, 0.001
    yield np.array([1.0e-4]), np.array([3]), 100, 0.001
    yield np.array([2.0e-4, np.inf, 1.0e-4, 0.9e-4]), np.array([3, 6, 5, 10]), 120, 0.001

    def draw(_n: int) -> Args | None:
        n_points, spread = int(rng.integers(20, 500)), float(rng.uniform(0.0004, 0.01))
        numbers = rng.permutation([3, 6, 5, 10])[: int(rng.integers(2, 5))]
        least = n_points * rng.uniform(0.9, 1.1)
        misfit = least + np.sort(rng.uniform(0, 60, len(numbers)))[np.argsort(-numbers).argsort()]
        costs = misfit + numbers * np.log(n_points)
        clear = np.diff(np.sort(costs)).min() > 0.01
        return (misfit * spread**2, numbers, n_points, spread) if clear else None

    yield from random_cases(draw)


def _judge_choice(got: Any, expected: Any, args: Args) -> str | None:
    """Judge which candidate was chosen, then the margin."""
    if not is_pair(got):
        return f"got {shown(got)}, expected two things: the number of the best candidate and its margin{no_return(got)}"
    off = number()(got[0], expected[0], args)
    if off is not None:
        return f"best: {off}"
    off = number("", MARGIN_TOLERANCE)(got[1], expected[1], args)
    return None if off is None else f"the best is right, its margin is not: {off}"


def _choose_by(cost: Callable[[Floats, Any, int, float], Floats]) -> Callable[..., tuple[int, float]]:
    """Return the choice by another cost."""
    return lambda squares, numbers, n_points, spread: _choose(cost(squares, numbers, n_points, spread))


fair_choice = Check(
    "fair_choice",
    cheapest,
    _choice_cases,
    _judge_choice,
    (
        Fault(
            "Right wherever there is a rival. Without one nothing comes near: the margin is float('inf').",
            when=off_only_where(lambda case: len(case.args[0]) == 1),
        ),
        Fault(
            "That is the choice by misfit alone: what does a candidate pay for its numbers?",
            like=_choose_by(lambda squares, _numbers, _n_points, spread: squares / spread**2),
        ),
        Fault(
            "The price of a number is ln N here. With 2 for each (Akaike's) extra numbers are too cheap.",
            like=_choose_by(lambda squares, numbers, _n_points, spread: squares / spread**2 + 2 * numbers),
        ),
        Fault(
            "Square metres over metres: divide the squares by the square of the spread.",
            like=_choose_by(lambda squares, numbers, n_points, spread: squares / spread + numbers * np.log(n_points)),
        ),
        Fault(
            "Square metres are added to plain numbers: the squares must be divided by the spread's square first.",
            like=_choose_by(lambda squares, numbers, n_points, _spread: squares + numbers * np.log(n_points)),
        ),
        Fault(
            "ln is the natural logarithm: np.log, not np.log10.",
            like=_choose_by(
                lambda squares, numbers, n_points, spread: squares / spread**2 + numbers * np.log10(n_points)
            ),
        ),
        Fault(
            "The choice is right. The margin is measured to the worst candidate, not to the next best.",
            like=lambda *args: (cheapest(*args)[0], float(np.ptp(_costs(*args))) if len(args[0]) > 1 else np.inf),
        ),
    ),
)
