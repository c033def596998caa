"""Parts: a task from its parts, and judges that only the problem sets need.

In:  a reference, a judge, usual faults, and for each part its words, its points and its cases.
Out: a ``primkit.course.grading.Task``, which marks a student's function.

All parts of a task share reference, judge and faults; they differ in their cases. So each part asks one question. A
wrong answer loses every part in which it shows: a slip in a step that all cases need shows in all of them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np

from primkit.checks import Check, Fault
from primkit.checks.judges import Judge, points_in_any_order, shown
from primkit.course.grading import Part, Task

Cases = Callable[[np.random.Generator], Iterable[tuple[Any, ...]]]

TURN = 2 * np.pi
EDGE = 1e-6  # cases in which rounding alone decides are left out: metres, radians or cells
INF = float("inf")


def task(
    name: str,
    reference: Callable[..., Any],
    judge: Judge,
    parts: Sequence[tuple[str, float, Cases]],
    faults: Sequence[Fault] = (),
) -> Task:
    """Return a task whose parts are given as (what it asks, points, cases)."""
    return Task(
        name, [Part(says, points, Check(name, reference, cases, judge, tuple(faults))) for says, points, cases in parts]
    )


def places(tolerance: float = 1e-6) -> Judge:
    """Judge points in any order; none at all may have any empty form."""
    some = points_in_any_order("m", tolerance)

    def judge(got: Any, expected: Any, args: tuple[Any, ...]) -> str | None:
        if len(expected) == 0 and isinstance(got, (list, tuple, np.ndarray)) and np.size(got) == 0:
            return None
        return some(got, expected, args)

    return judge


def turn_between(a: float, b: float, period: float = TURN) -> float:
    """Return how far it is from bearing b to bearing a, radians, at most half a period either way."""
    return float(np.remainder(a - b + period / 2, period) - period / 2)


def numbers(value: Any, count: int) -> list[float] | None:
    """Return a tuple, list or array of ``count`` numbers as floats; None for anything else."""
    try:
        found = np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        return None
    return found.tolist() if found.shape == (count,) and np.asarray(value).dtype.kind in "iuf" else None


__all__ = ["EDGE", "INF", "TURN", "Cases", "Fault", "numbers", "places", "shown", "task", "turn_between"]
