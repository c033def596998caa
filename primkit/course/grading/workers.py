"""Workers: the judge's side of the line to a student's process.

In:  a socket that twins connect to (``serving.py``), and a way to read the processor time that they have used.
Out: for each part of a task a worker of its own, and in the place of a student's function a ``Remote``, which is called
     like it: the arguments go over, the result comes back, both as plain values.

The time is read from outside. A part has some seconds of *processor* time, for a busy machine is no fault of the
student's; on the clock it may take ``PATIENCE`` times as long.
"""

from __future__ import annotations

import inspect
import socket
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from .plain_values import readable, stranger
from .wire import ENDED, FAMILY, PAUSE, HungUpError, hear, say

PATIENCE = 4  # seconds on the clock for each second of processor time
GREETING_SECONDS = 8.0  # until a worker is there: a fork takes milliseconds
MOST_WAITING = 128  # connections


class OutOfTime(BaseException):
    """The time of a part is over. It is no ``Exception``: no check takes it for one of the student's."""


class Ended(BaseException):
    """The student's function has ended its process."""


class Workers:
    """All twins of one notebook, and the one worker that is at work."""

    def __init__(self, folder: Path, spent: Callable[[], float], make: Callable[[int], None] | None = None) -> None:
        self.spent = spent  # seconds of processor time so far
        self.make = make  # makes a worker for a cell where there are no twins
        self.here = socket.socket(FAMILY)
        self.here.bind(("127.0.0.1", 0) if FAMILY == socket.AF_INET else str(folder / "judge"))
        self.here.listen(MOST_WAITING)
        self.address = self.here.getsockname()
        self.twins: dict[int, socket.socket] = {}
        self.line: socket.socket | None = None
        self.traces: list[str] = []  # of what no honest function does

    def close(self) -> None:
        """Hang up."""
        for line in filter(None, [self.here, self.line, *self.twins.values()]):
            line.close()

    def start(self, cell: int, seconds: float) -> None:
        """Let a new worker begin, with so many seconds; raises Ended if there is none."""
        self._let_go()
        self.seconds = seconds
        self.began, self.spent_before = time.monotonic(), self.spent()
        if self.make:
            self.make(cell)
        if self.make or self._told_to_work(cell):
            self.line = self._greeted(cell, "worker")
        if self.line is None:
            raise Ended("the notebook's process does not answer: has a cell ended or changed it?")
        self.began, self.spent_before = time.monotonic(), self.spent()

    def _told_to_work(self, cell: int) -> bool:
        """Tell the twin of a cell to make a worker; the latest, for a kernel that has ended has left twins, too."""
        while cell in self.twins or self._greeted(cell, "twin"):
            try:
                say(self.twins[cell], "work")
                return True
            except HungUpError:
                self.twins.pop(cell).close()
        return False

    def names(self, cell: int, names: Sequence[str]) -> dict[str, Any]:
        """Return what the notebook has under these names: a ``Remote`` for a function."""
        (told,) = self.ask("names", list(names))
        found: dict[str, Any] = {}
        for name, described in told.items() if isinstance(told, dict) else ():
            if name in names and isinstance(described, tuple) and len(described) == 2:
                kind, value = described
                found[name] = Remote(self, cell, name, _signature(value)) if kind == "function" else value
        return found

    def ask(self, *values: Any) -> list[Any]:
        """Say something to the worker and return what it answers."""
        if self.line is None:
            raise Ended("its process has ended")
        try:
            say(self.line, *values)
            return hear(self.line, watch=self._watch)
        except HungUpError as gone:
            self._let_go()
            self.traces += [f"the process {gone}"] * (str(gone) != ENDED)
            raise Ended(str(gone)) from None

    def _let_go(self) -> None:
        if self.line:
            self.line.close()
        self.line = None

    def _watch(self) -> None:
        """Raise OutOfTime when the worker's time is over."""
        waited = time.monotonic() - self.began
        if waited > self.seconds and (
            waited > PATIENCE * self.seconds or self.spent() - self.spent_before > self.seconds
        ):
            self._let_go()
            raise OutOfTime(f"stopped after {self.seconds:g} s")

    def _greeted(self, cell: int, role: str) -> socket.socket | None:
        """Return the line of a twin or worker of this cell; lines of other twins are kept, all others dropped."""
        until = time.monotonic() + GREETING_SECONDS

        def hurry() -> None:
            if time.monotonic() > until:
                raise HungUpError("says nothing")

        while time.monotonic() < until:
            self.here.settimeout(PAUSE)
            try:
                line = self.here.accept()[0]
            except TimeoutError:
                continue
            line.settimeout(None)
            greeting: list[Any] = []
            with suppress(HungUpError):
                greeting = hear(line, watch=hurry)
            if greeting == [cell, role] and role == "worker":
                return line
            if len(greeting) == 2 and greeting[1] == "twin" and isinstance(greeting[0], int):
                self.twins[greeting[0]] = line
                if greeting == [cell, role]:
                    return line
            else:
                self.traces.append("a stranger calls the judge")
                line.close()
        return None


class Remote:
    """A student's function, to be called like it."""

    def __init__(self, workers: Workers, cell: int, name: str, signature: inspect.Signature | None) -> None:
        self.workers, self.cell, self.__name__ = workers, cell, name
        self.__signature__ = signature
        self.remarks: set[str] = set()

    def afresh(self, seconds: float) -> Remote:
        """Let another worker do the next calls, with so many seconds for all of them."""
        self.workers.start(self.cell, seconds)
        self.remarks = set()
        return self

    def __call__(self, *args: Any, **options: Any) -> Any:
        """Return what the student's function returns, or raise something of the same name."""
        said, *more = self.workers.ask(self.__name__, args, options)
        if said == "returned" and len(more) == 2:
            result, remarks = more
            if isinstance(remarks, dict):
                self.remarks |= {word for word in REMARKS if remarks.get(word) is True}
            return result
        if said == "raised" and len(more) == 3:
            raise _raised(*more)
        self.workers.traces.append(f"the process of {self.__name__} says what no function returns")
        return stranger("forged answer")


REMARKS = ("changes what it is given", "prints", "writes to stderr")


def _raised(kinds: Any, message: Any, where: Any) -> BaseException:
    """Return an exception that has the name and the words of a student's."""
    names = [name for name in kinds if isinstance(name, str)] if isinstance(kinds, list) else []
    known = (NotImplementedError, TypeError, NameError, Exception)
    base = next((kind for kind in known if kind.__name__ in names), BaseException)
    name = readable(names[0]) if names and names[0].isidentifier() else "Exception"
    words = str(message)
    kind = type(name[:60], (base,), {"__str__": lambda _self: words, "where": str(where)})
    return kind(words)


def _signature(told: Any) -> inspect.Signature | None:
    """Return the signature of a function, as far as it was told."""
    try:
        return inspect.Signature(
            [
                inspect.Parameter(name, inspect._ParameterKind(kind), default=None if has else inspect.Parameter.empty)
                for name, kind, has in told
            ]
        )
    except (TypeError, ValueError):
        return None
