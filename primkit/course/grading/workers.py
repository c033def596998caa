"""Workers: the judge's side of the line to a student's process.

In:  a socket that twins connect to (``serving.py``), and a way to read the processor time that they have used.
Out: for each part of a task a worker of its own, and in the place of a student's function a ``Remote``, which is called
     like it: the arguments go over, the result comes back, both as plain values.

The time is read from outside. A part has some seconds of *processor* time, for a busy machine is no fault of the
student's; on the clock it may take ``PATIENCE`` times as long, and longer where more processes than cores want to run.
"""

from __future__ import annotations

import inspect
import math
import select
import socket
import sys
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import psutil

from .plain_values import readable, stranger
from .wire import ENDED, FAMILY, HungUpError, hear, say

PATIENCE = 4  # seconds on the clock for each second of processor time, on a machine that is not busy
MOST_BUSY = 10.0  # times as long on a busy one
GREETING_SECONDS = 8.0  # until a worker is there: a fork takes milliseconds
STRANGER_SECONDS = 1.0  # for a greeting that was sent before: whoever says nothing is no twin
EDITED_SECONDS = 0.05  # for one call of what is tried, while a slip is looked for
SLIPS_SECONDS = 1.5  # of the judge's time, for the slips in one function: all its parts together
SOURCE_LETTERS = 20_000  # of a function with its helpers
MOST_WAITING = 128  # connections


class OutOfTime(BaseException):
    """The time of a part is over. It is no ``Exception``: no check takes it for one of the student's."""


class Ended(BaseException):
    """The student's function has ended its process."""


class Workers:
    """All twins of one notebook, and the one worker that is at work.

    Parameters
    ----------
    folder : Path
        Where the socket lies.
    spent : callable
        Tells the seconds of processor time that the kernel and its twins have used so far; each worker has ``seconds``.
    make : callable, optional
        Makes a worker for a cell, where there are no twins.
    """

    def __init__(
        self, folder: Path, spent: Callable[[], float], seconds: float, make: Callable[[int], None] | None = None
    ) -> None:
        self.spent, self.seconds, self.make = spent, seconds, make
        self.here = socket.socket(FAMILY)
        self.here.bind(("127.0.0.1", 0) if FAMILY == socket.AF_INET else str(folder / "judge"))
        self.here.listen(MOST_WAITING)
        self.address = self.here.getsockname()
        self.twins: dict[int, socket.socket] = {}
        self.line: socket.socket | None = None
        self.cell = -1  # whose worker is at work
        self.traces: list[str] = []  # of what no honest function does

    def close(self) -> None:
        """Hang up."""
        for line in filter(None, [self.here, self.line, *self.twins.values()]):
            line.close()

    def start(self, cell: int) -> None:
        """Let a new worker begin; raises Ended if there is none."""
        self._let_go()
        if cell != self.cell:
            self._leave(self.cell)
        self.cell = cell
        self.meet()
        self.began, self.spent_before = time.monotonic(), self.spent()
        twin = self.twins.get(cell)
        if self.make:
            self.make(cell)
        elif twin:
            with suppress(HungUpError):
                say(twin, "work")
        until = time.monotonic() + (GREETING_SECONDS * busy() if self.make or twin else 0.0)
        while self.line is None and (left := until - time.monotonic()) > 0:
            if twin in select.select([self.here, *filter(None, [twin])], [], [], left)[0]:
                break  # it has ended: it says nothing
            self.meet(cell)
        if self.line is None:
            raise Ended("the notebook's process does not answer: has a cell ended or changed it?")
        self.began, self.spent_before = time.monotonic(), self.spent()

    def meet(self, cell: int | None = None) -> None:
        """Take in who has called: twins, and a worker of this cell. Whoever greets in another way is a stranger."""
        until = time.monotonic() + GREETING_SECONDS * busy()
        while time.monotonic() < until and select.select([self.here], [], [], 0.0)[0]:
            line, greeting = self.here.accept()[0], []
            with suppress(HungUpError):
                greeting = hear(line, watch=_hurry(STRANGER_SECONDS * busy()))
            if greeting == [cell, "worker"] and self.line is None:
                self.line = line
            elif len(greeting) == 2 and greeting[1] == "twin" and isinstance(greeting[0], int):
                self.twins[greeting[0]] = line  # the latest: a kernel that has ended has left twins, too
            else:
                self.traces.append("a stranger calls the judge")
                line.close()

    def names(self, cell: int, names: Sequence[str]) -> dict[str, Any]:
        """Return what the notebook has under these names: a ``Remote`` for a function."""
        (told,) = self.ask("names", list(names))
        found: dict[str, Any] = {}
        for name, described in told.items() if isinstance(told, dict) else ():
            if name in names and isinstance(described, tuple) and len(described) == 2:
                kind, value = described
                found[name] = Remote(self, cell, name, value) if kind == "function" else value
        return found

    def ask(self, *values: Any) -> list[Any]:
        """Say something to the worker and return what it answers.

        A check's own limit, which looks at each line of a function that runs here, must not break off a message.
        """
        if self.line is None:
            raise Ended("its process has ended")
        limit = sys.gettrace()
        sys.settrace(None)
        try:
            say(self.line, *values)
            return hear(self.line, watch=self._watch)
        except HungUpError as gone:
            self._let_go()
            self.traces += [f"the process {gone}"] * (str(gone) != ENDED)
            raise Ended(str(gone)) from None
        finally:
            sys.settrace(limit)

    def _let_go(self) -> None:
        if self.line:
            self.line.close()
        self.line = None

    def _leave(self, cell: int) -> None:
        """End a cell's twin and its worker: the time of a loop that never ends would count as the next cell's."""
        if twin := self.twins.pop(cell, None):
            with suppress(OSError, HungUpError):
                twin.shutdown(socket.SHUT_WR)
                hear(twin, watch=_hurry(GREETING_SECONDS * busy()))  # until both have gone
            twin.close()

    def _watch(self) -> None:
        """Raise OutOfTime when the worker's time is over."""
        waited = time.monotonic() - self.began
        if waited < self.seconds:
            return
        if waited > PATIENCE * busy() * self.seconds or self.spent() - self.spent_before > self.seconds:
            self._let_go()
            raise OutOfTime(f"did not end within {self.seconds:g} s")


def busy() -> float:
    """Return how many times as long as on an idle machine something may take: as many processes as want each core."""
    return min(max(1.0, psutil.getloadavg()[0] / (psutil.cpu_count() or 1)), MOST_BUSY)


def _hurry(seconds: float) -> Callable[[], None]:
    """Return what raises HungUpError, once called after so many seconds."""
    until = time.monotonic() + seconds

    def watch() -> None:
        if time.monotonic() > until:
            raise HungUpError("says nothing")

    return watch


class Remote:
    """A student's function, to be called like it."""

    def __init__(self, workers: Workers, cell: int, name: str, told: Any) -> None:
        self.workers, self.cell, self.__name__ = workers, cell, name
        arguments, source = told if isinstance(told, tuple) and len(told) == 2 else (None, None)
        self.__signature__ = _signature(arguments)
        # Pieces as they were told, (first line, text); none where they are too long or no such thing.
        told = source if isinstance(source, list) else []
        right = all(isinstance(p, tuple) and list(map(type, p)) == [int, str] and p[0] > 0 for p in told)
        self.source = told if right and sum(len(text) for _, text in told) <= SOURCE_LETTERS else []
        self.remarks: set[str] = set()
        self.searched_until = math.inf  # by this process's time

    def to_edit(self) -> Editor:
        """Return where the function can be built with a place of its source changed: another worker, for its time.

        A part that fails after others have taken the time for that is told without a slip.
        """
        self.searched_until = min(self.searched_until, time.process_time() + SLIPS_SECONDS)
        if time.process_time() > self.searched_until:
            self.source = []
        else:
            with suppress(Ended):  # then nothing is built there
                self.workers.start(self.cell)
        return Editor(self.workers, self.__name__, self.searched_until)

    def afresh(self) -> Remote:
        """Let another worker do the next calls."""
        self.workers.start(self.cell)
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


class Editor:
    """A student's function with another source: it is built and called in the student's process, never in this one."""

    def __init__(self, workers: Workers, name: str, until: float) -> None:
        self.workers, self.__name__, self.until = workers, name, until

    def edited(self, source: str) -> Callable[..., Any] | None:
        """Return the function that this text says; none once the time for the search is over."""
        in_time = time.process_time() < self.until
        return self._called if in_time and self._asked("edit", self.__name__, source) == [True] else None

    def _called(self, *args: Any) -> Any:
        said, *more = self._asked("edited", args, EDITED_SECONDS)
        if said != "returned" or not more:
            raise ValueError("it does not return")
        return more[0]

    def _asked(self, *values: Any) -> list[Any]:
        try:
            return self.workers.ask(*values)
        except (Ended, OutOfTime):
            return [None]


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
