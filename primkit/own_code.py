"""Own code: functions that somebody wrote in a cell, or in a file beside it; which lines are theirs, and how they stop.

A loop that never ends is stopped by Python's own tracing, which looks at the clock at each line of theirs: it needs no
signal and no thread, so it also works in a browser and on Windows. What it cannot stop is one call into compiled code
that never comes back, such as ``sum(itertools.count())``, and a loop with a bare ``except`` around its body, which
catches this as well: there only the kernel's own interrupt helps.

In:  a function and how many seconds it may take; or an error that came out of it.
Out: what the function returns, or ``OutOfTime``; and the ``Line`` that an error came from.

>>> def halve(x):
...     while x > 1: pass
...     return x / 2
>>> call_within(1.0, halve, 0.5)
0.25
>>> try:
...     call_within(0.05, halve, 2)
... except OutOfTime as error:
...     print(error, "in line", line_of(error).number)
stopped after 0.05 s in line 2
"""

from __future__ import annotations

import linecache
import re
import sys
import sysconfig
import time
import traceback
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

# What lies here is nobody's own: its lines are not looked at.
LIBRARIES = (*{sysconfig.get_path(name) for name in ("stdlib", "purelib", "platlib")}, str(Path(__file__).parent))
LINE_LETTERS = 70  # of a line that is quoted


class OutOfTime(BaseException):
    """The time is over. It is no ``Exception``, so that ``except Exception`` in somebody's code lets it through."""


@dataclass(frozen=True)
class Line:
    """A line of somebody's code: its number in the cell, or in the file, and what it says."""

    number: int
    text: str = ""

    def __str__(self) -> str:
        return f"line {self.number}" + (f", `{self.text}`" if self.text else "")


def call_within(seconds: float, function: Callable[..., Any], *args: Any) -> Any:
    """Return what a function returns, and raise what it raises; after so many seconds, ``OutOfTime``.

    On a busy machine, where this process gets only a part of each second, it may take twice as long.
    """
    start, used, before = time.monotonic(), time.process_time(), sys.gettrace()

    def look(frame: Any, _event: str, _more: Any) -> Any:
        if not is_own(frame.f_code.co_filename):
            return None
        over = time.monotonic() - start - seconds
        if over > 0 and (over > seconds or time.process_time() - used > seconds):
            raise OutOfTime(f"stopped after {seconds:g} s")
        return look

    def called() -> Iterator[tuple[Any, BaseException | None]]:
        result, raised = None, None
        try:
            result = function(*args)
        except BaseException as error:
            raised = error
        yield result, raised

    sys.settrace(look)
    try:
        # Stopped between the lines of an except clause, a function leaves its own error behind as the one that Python
        # is at work on (sys.exc_info), for ever. A generator has a place of its own for that, and takes it along.
        result, error = next(called())
    finally:
        sys.settrace(before)
    if error is not None:
        raise error
    return result


def is_own(filename: str) -> bool:
    """Tell whether code stands in a cell, or in a file beside the notebook."""
    return not filename.startswith((*LIBRARIES, "<frozen")) and not filename.endswith(".pyx")


def line_of(error: BaseException) -> Line | None:
    """Return somebody's last line on the way to an error, also to one that comes from another process."""
    steps = [step for step in traceback.walk_tb(error.__traceback__) if is_own(step[0].f_code.co_filename)]
    if steps:
        return line_at(steps[-1][0].f_code.co_filename, steps[-1][1])
    told = re.fullmatch(r"line (\d{1,6}): (.*)", str(getattr(error, "where", "")).rpartition("\n")[2])
    return quoted(int(told[1]), told[2]) if told and told[2].isprintable() else None


def line_at(filename: str, number: int) -> Line:
    """Return a line with its text, where Python still knows it."""
    return quoted(number, linecache.getline(filename, number))


def quoted(number: int, text: str) -> Line:
    """Return a line with its text, cut where it is long."""
    text = text.strip()
    return Line(number, text if len(text) <= LINE_LETTERS else text[: LINE_LETTERS - 3] + "...")
