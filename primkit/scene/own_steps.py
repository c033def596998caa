"""Own steps: somebody's functions at work while they drive: timed, stopped when they do not end, and told on.

In:  ``Steps``, which may be slow, wrong, or never come back.
Out: ``OwnSteps``: ``.steps``, the same functions under watch; and in one sentence what is the matter with them.

>>> def mean_circle(points):
...     return (*points.mean(axis=0), 1 / 0)
>>> own = OwnSteps(Steps(fit_circle=mean_circle))
>>> own.steps.fit_circle(Circle((0, 0), 0.1).outline(9))
Traceback (most recent call last):
    ...
primkit.scene.own_steps.StepError: fit_circle raises ZeroDivisionError: division by zero, in line 2

What cannot be stopped, see ``own_code``, is told, and the drive goes on without it.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Any

from ..arguments import check_type
from ..measure import Detection
from ..own_code import OutOfTime, call_within, line_of
from ..shapes import Circle
from ..steps import Steps

SLOW = 1.0  # s: shapes that are later than this are told to be late
LONGEST = 5.0  # s: a step that has not come back by then is stopped


class StepError(Exception):
    """A step of one's own did not do: why, in one sentence."""


class OwnSteps:
    """Steps under watch.

    Parameters
    ----------
    steps : Steps
        The functions as they were written.
    """

    def __init__(self, steps: Steps) -> None:
        check_type(steps, Steps, "steps must be Steps, such as Steps(fit_circle=mine)")
        own = {name: step for name, step in vars(steps).items() if step is not None}
        self.steps = replace(steps, **{name: self._watched(name, step) for name, step in own.items()})
        self._took: dict[str, float] = {}  # seconds, all calls of this look together
        self._at_work: tuple[str, float] | None = None  # which, and since when

    def begin(self) -> None:
        """Begin to count anew: another look begins."""
        self._took = {}

    @property
    def slow(self) -> str:
        """Which step makes the shapes late, in one sentence; nothing when none does."""
        if (at_work := self._at_work) is not None and (since := time.monotonic() - at_work[1]) > SLOW:
            return f"{at_work[0]} has been at work for {since:.0f} s"
        name, took = max(self._took.items(), key=lambda one: one[1], default=("", 0.0))
        return f"{name} takes {took:.1f} s for one look" if took > SLOW else ""

    def nonsense(self, found: Iterable[Detection]) -> str:
        """Which step returned what its own points deny, in one sentence; nothing when none did."""
        for one in found:
            fit = "fit_circle" if isinstance(one.shape, Circle) else "fit_line"
            name = "measure" if self.steps.measure is not None else fit
            if len(one.points) == 0 and getattr(self.steps, name) is not None:
                return f"{name} returns a {one.kind} that lies on none of its points"
        return ""

    def _watched(self, name: str, step: Callable[..., Any]) -> Callable[..., Any]:
        """Return a step that is timed and stopped, and whose errors are told in one sentence."""

        def watched(*args: Any) -> Any:
            begun = time.monotonic()
            self._at_work = name, begun
            try:
                return call_within(LONGEST, step, *args)
            except OutOfTime as error:
                raise StepError(f"{name} did not end, and was stopped after {LONGEST:g} s{_line_of(error)}") from error
            except BaseException as error:  # even exit() must not end the drive
                raise StepError(f"{name} raises {type(error).__name__}: {error}{_line_of(error)}") from error
            finally:
                self._at_work = None
                self._took[name] = self._took.get(name, 0.0) + time.monotonic() - begun

        return watched


def _line_of(error: BaseException) -> str:
    """Return in words which line of somebody's own code an error came from; nothing if from none."""
    line = line_of(error)
    return f", in line {line.number}" if line else ""
