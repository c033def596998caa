"""Calls: run a student's function on one case, and see how it went.

In:  a function, the arguments of one call, and how many seconds it may take.
Out: what it returned, or a ``Raised``; and what NumPy warned of, and where.

>>> def halve(x):
...     while x > 1:
...         pass
...     return 1 / x
>>> run(halve, (0.5,), 1.0).got
2.0
>>> run(halve, (0,), 1.0).got.says
'ZeroDivisionError: division by zero'
>>> run(halve, (2,), 0.05).got.says
'OutOfTime: stopped after 0.05 s'
"""

from __future__ import annotations

import io
import time
import warnings
from collections.abc import Callable
from contextlib import redirect_stdout
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..own_code import Line, OutOfTime, call_within, is_own, line_at, line_of
from .cases import Args


class Interrupted(KeyboardInterrupt):
    """Somebody pressed the button that interrupts; a notebook shows the words alone."""

    def _render_traceback_(self) -> list[str]:
        return [str(self)]


@dataclass(frozen=True)
class Raised:
    """What came instead of a result: an error, and the student's line that it came from."""

    error: BaseException
    line: Line | None

    @property
    def kind(self) -> str:
        """The error's name."""
        return type(self.error).__name__

    @property
    def says(self) -> str:
        """The error as Python writes it, in one line."""
        return f"{self.kind}: {self.error}".strip().splitlines()[0]

    @property
    def told(self) -> str:
        """What happened and where, to stand behind the call."""
        where = f" in {self.line}" if self.line else ""
        if isinstance(self.error, OutOfTime):
            return f"did not end: {self.error}{where}"
        return f"raised {self.says}{where}"

    @property
    def fault(self) -> str:
        """Its name in the overview of a class."""
        return "out of time" if isinstance(self.error, OutOfTime) else f"raises {self.kind}"


def hint_at(raised: Raised) -> list[str]:
    """Return what an error that many meet may come from."""
    return [
        hint
        for kind, words, hint in ERROR_HINTS
        if raised.kind == kind and (not words or any(word in raised.says for word in words))
    ][:1]


ERROR_HINTS = (
    ("OutOfTime", (), "Is there a loop that never ends? Which comparison should end it?"),
    ("NameError", (), "Python does not know this name. After a restart of the kernel, run the cells above again."),
    ("IndexError", (), "Python counts from 0: is a number off by one?"),
    ("AxisError", (), "Which axis is meant? Axis 0 goes along the rows, axis 1 along the columns."),
    ("ValueError", ("broadcast", "mismatch", "shape", "dimension"), "Shapes do not fit: which axis is which?"),
    ("TypeError", ("NoneType",), "Something is None: does a function lack its return?"),
)


@dataclass(frozen=True)
class Run:
    """How one call went: what came back, how long it took, and each of NumPy's warnings with its line."""

    got: Any
    seconds: float = 0.0
    warned: tuple[tuple[str, Line], ...] = ()


def run(function: Callable[..., Any], args: Args, seconds: float) -> Run:
    """Call a function, whatever it does; what it prints is not shown, because it is called hundreds of times."""
    start = time.monotonic()
    with (
        redirect_stdout(io.StringIO()),
        warnings.catch_warnings(record=True) as told,
        np.errstate(all="warn", under="ignore"),
    ):
        warnings.simplefilter("always", RuntimeWarning)
        warnings.filterwarnings("ignore", category=DeprecationWarning)
        try:
            got = call_within(seconds, function, *args)
        except KeyboardInterrupt as error:
            where = f" in {line}" if (line := line_of(error)) else ""
            raise Interrupted(f"Interrupted{where}. Is there a loop that never ends?") from None
        except (Exception, OutOfTime) as error:  # whatever it is, it is the answer
            got = Raised(error, line_of(error))
    mine = [each for each in told if issubclass(each.category, RuntimeWarning) and is_own(each.filename)]
    return Run(
        got, time.monotonic() - start, tuple((str(each.message), line_at(each.filename, each.lineno)) for each in mine)
    )


def quietly(function: Callable[..., Any], args: Args) -> Any:
    """Call a faulty way of ours without its warnings."""
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        return function(*args)
