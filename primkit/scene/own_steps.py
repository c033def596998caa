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

A function that does not end is stopped by Python's own tracing, which looks at the clock at each line: that needs no
signal and no second thread, so it works in a browser, too. What has no next line, one call into compiled code or a loop
on a single line, cannot be stopped so; it is told, and the drive goes on without it.
"""

from __future__ import annotations

import sys
import time
import traceback
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

from ..arguments import check_type
from ..measure import Detection
from ..shapes import Circle
from ..steps import Steps

SLOW = 1.0  # s: shapes that are later than this are told to be late
LONGEST = 5.0  # s: a step that has not come back by then is stopped
OURS = str(
    Path(__file__).resolve().parents[1]
)  # the library's own files: who reads of an error wants the line in theirs


class StepError(Exception):
    """A step of one's own did not do: why, in one sentence."""


class OutOfTime(BaseException):
    """The time is over; no ``Exception``, so that ``except Exception`` in a step lets it through."""


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
                with time_limit(LONGEST):
                    return step(*args)
            except OutOfTime as error:
                raise StepError(f"{name} did not end, and was stopped after {LONGEST:g} s{_line_of(error)}") from error
            except BaseException as error:  # even exit() must not end the drive
                raise StepError(f"{name} raises {type(error).__name__}: {error}{_line_of(error)}") from error
            finally:
                self._at_work = None
                self._took[name] = self._took.get(name, 0.0) + time.monotonic() - begun

        return watched


@contextmanager
def time_limit(seconds: float) -> Iterator[None]:
    """Stop what runs in this block after so many seconds, with ``OutOfTime``."""
    end, worked, before = time.monotonic() + seconds, time.process_time() + seconds, sys.gettrace()

    def at_line(*_: Any) -> Any:
        if time.monotonic() > end and time.process_time() > worked:  # of a busy machine we get only a part
            raise OutOfTime
        return at_line

    sys.settrace(lambda frame, *_: at_line if _is_own(frame.f_code.co_filename) else None)
    try:
        yield
    finally:
        sys.settrace(before)


def _line_of(error: BaseException) -> str:
    """Return in words which line of somebody's own code an error came from; nothing if from none."""
    lines = [line for frame, line in traceback.walk_tb(error.__traceback__) if _is_own(frame.f_code.co_filename)]
    return f", in line {lines[-1]}" if lines else ""


def _is_own(filename: str) -> bool:
    """Tell whether code stands in a cell, or in a file beside the notebook."""
    ours = filename.startswith((OURS, sys.base_prefix, "<frozen")) or filename.endswith(".pyx")
    return not ours and "site-packages" not in filename
