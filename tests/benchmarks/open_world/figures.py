"""Figures: a share or a mean, of how many, with its 95 % interval, and the goal beside it.

>>> print(share("heads", {"a": True, "b": True, "c": False}, at_least=0.7))
heads                    0.6667 (0.2077-0.9385) of 3            >= 0.7     MISSED; against: c

A goal counts as reached by the figure itself, not by the end of its interval: the reader has both. What is drawn
independently are boards: of several things on one board the bootstrap is over boards.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from primkit.study.estimate import Estimate, mean_of, pooled_share, share_of

MOST_TOLD = 12  # boards against a figure that are named


@dataclass(frozen=True)
class Goal:
    """At least, or at most, so much."""

    sign: str
    value: float

    def reached(self, value: float) -> bool:
        return value >= self.value if self.sign == ">=" else value <= self.value


@dataclass(frozen=True)
class Figure:
    """What was measured, its value, of how many; the goal if there is one, the cases against it, and a note."""

    what: str
    value: Estimate
    n: int
    goal: Goal | None = None
    against: tuple[str, ...] = ()
    note: str = ""

    @property
    def reached(self) -> bool:
        """Whether the goal is reached; so is none."""
        return self.goal is None or self.goal.reached(self.value.value)

    def __str__(self) -> str:
        digits = 4 if abs(self.value.value) < 100 else 0
        goal = "" if self.goal is None else f"{self.goal.sign} {self.goal.value:g}"
        verdict = "" if self.goal is None else "reached" if self.reached else "MISSED"
        told = f"{self.what:62} {self.value.text(digits)} of {self.n}".ljust(96) + f"{goal:10} {verdict}"
        more = len(self.against) - MOST_TOLD
        names = ", ".join(self.against[:MOST_TOLD]) + (f" and {more} more" if more > 0 else "")
        said = [f"against: {names}"] * bool(names) + [self.note] * bool(self.note)
        return "; ".join([told, *said]).rstrip()


def goal_of(at_least: float | None, at_most: float | None) -> Goal | None:
    """Return the goal that is told; None for none."""
    if at_least is not None:
        return Goal(">=", at_least)
    return None if at_most is None else Goal("<=", at_most)


def share(
    what: str, told: Mapping[str, bool], *, at_least: float | None = None, at_most: float | None = None
) -> Figure:
    """Return in what share of cases something is so, one a board: Wilson's interval."""
    goal = goal_of(at_least, at_most)
    against = tuple(case for case, so in told.items() if goal and so == (goal.sign == "<="))
    value = share_of(float(np.mean(list(told.values()))), len(told)) if told else Estimate(float("nan"))
    return Figure(what, value, len(told), goal, against)


def share_of_things(
    what: str, told: Mapping[str, tuple[int, int]], *, at_least: float | None = None, at_most: float | None = None
) -> Figure:
    """Return the share of (so many, of so many) over all boards: the bootstrap over boards, n counts things."""
    pairs, goal = np.array(list(told.values()), dtype=int).reshape(-1, 2), goal_of(at_least, at_most)
    faults = pairs[:, 0] if at_most is not None else pairs[:, 1] - pairs[:, 0]
    against = tuple(case for case, n in zip(told, faults, strict=True) if goal and n)
    value = pooled_share(pairs[:, 0], pairs[:, 1]) or Estimate(float("nan"))
    return Figure(what, value, int(pairs[:, 1].sum()), goal, against)


def mean(
    what: str, told: Mapping[str, float], *, at_least: float | None = None, at_most: float | None = None
) -> Figure:
    """Return the mean of one number a board: the bootstrap over boards, or Wilson's interval where all are 1 or 0."""
    values, goal = np.array(list(told.values()), dtype=float), goal_of(at_least, at_most)
    against = tuple(case for case, value in told.items() if goal and not goal.reached(value))
    alike = values.min() == values.max() and values[0] in (0.0, 1.0)
    value = share_of(float(values[0]), len(values)) if alike else mean_of(values)
    return Figure(what, value, len(values), goal, against)


def number(what: str, value: float, n: int, *, at_least: float | None = None, at_most: float | None = None) -> Figure:
    """Return a figure that has no interval: a count of lines, the longest of so many times."""
    return Figure(what, Estimate(float(value)), n, goal_of(at_least, at_most))
