"""Task: a function of a problem set, the parts it is marked by, and their points.

In:  the student's function, or its name and where to look it up.
Out: the points, all or none for each part, and a table of what is off.

The last expression of a grade cell is ``task.mark("half", globals())``: nbgrader reads its number as the cell's points.
When a submission is graded, this cell runs in the judge's process, and what stands in ``globals()`` under a student's
name is a ``Remote``: see ``workers.py``. In a teacher's own notebook it is the function itself, and the same values
cross: arguments go to it, and results come back, through ``plain_values.py``.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from ...arguments import as_positive
from ...checks.answer import Answer, Check
from .mark import Mark, Row, show
from .plain_values import pack, unpack
from .workers import Ended, OutOfTime, Remote

ALL_WRONG = re.compile(r"in (\d+) of \1 cases\.")  # all of them are wrong
OTHER_FORM = re.compile(  # how judges begin what they expect, when a result has another form
    r"expected (a number such as|numbers in|points in an array|one label for|a circle:|a line:|a list|a set of)"
)


@dataclass(frozen=True)
class Part:
    """One part of a task.

    Parameters
    ----------
    says : str
        What it asks for, in a few words: "a ray that starts inside".
    points : float
        Points for a right answer; a wrong one has none of them.
    check : Check
        The cases of this part, how they are judged, and the usual faults.
    """

    says: str
    points: float
    check: Check

    def answer(self, function: Any) -> Answer:
        """Judge a function, whatever it does."""
        name = self.check.name
        try:
            # The process that answers is timed, and not this one, which waits for it.
            return _name_fault(self.check(function.afresh() if callable(function) else function, math.inf))
        except OutOfTime as stop:
            says = f"{name} {stop}: is there a loop that never ends, or is it too slow?"
            return Answer("error", says, "out of time")
        except KeyboardInterrupt:  # somebody waits no longer
            raise
        except Ended as ended:
            return Answer("error", f"{name} ends Python: a function returns ({ended}).", "ends Python")
        except Exception as error:  # the judge met something that it does not know
            says = f"{name} returns what cannot be judged ({type(error).__name__}: {error})."
            return Answer("error", says, "returns what cannot be judged")
        except BaseException as error:  # exit(), and whatever else wants to end Python
            kind = type(error).__name__
            return Answer("error", f"{name} ends Python with {kind}: a function returns.", f"raises {kind}")


@dataclass(frozen=True)
class Missing:
    """In the place of a function that a notebook does not define: why."""

    name: str
    answer: Answer

    def __call__(self, *_args: Any) -> Any:
        """Say what Python says."""
        raise NameError(f"name {self.name!r} is not defined")


@dataclass
class Local:
    """A function of this very process: what crosses is what would cross from another one."""

    function: Callable[..., Any]
    remarks: set[str] = field(default_factory=set)

    @property
    def __wrapped__(self) -> Callable[..., Any]:
        """What is called: where its source and its arguments' names are read."""
        return self.function

    def afresh(self) -> Local:
        """Return itself: here nothing ends a loop but the person who waits for it."""
        self.remarks = set()
        return self

    def __call__(self, *args: Any) -> Any:
        """Call the function with copies, and return a copy."""
        return unpack(pack(self.function(*unpack(pack(args)))))


@dataclass(frozen=True)
class Task:
    """A student's function, marked part by part.

    Raises ValueError if there is no part, a part's points are not above zero, or a part checks another function.

    Parameters
    ----------
    name : str
        The name of the function in the problem set.
    parts : iterable of Part
        What it is marked by.
    """

    name: str
    parts: tuple[Part, ...]

    def __init__(self, name: str, parts: Iterable[Part]) -> None:
        parts = tuple(parts)
        if not parts:
            raise ValueError(f"a task must have at least one part, {name} has none")
        for part in parts:
            as_positive(part.points, f"the points of the part {part.says!r}")
            if part.check.name != name:
                raise ValueError(f"each part of {name} must check {name}, got a check of {part.check.name}")
        object.__setattr__(self, "name", name)
        object.__setattr__(self, "parts", parts)

    @property
    def points(self) -> float:
        """The points of all parts together."""
        return float(sum(part.points for part in self.parts))

    def mark(self, function: Callable[..., Any] | str, scope: Mapping[str, Any] | None = None) -> float:
        """Return the points, and show the table where a notebook can.

        Parameters
        ----------
        function : callable or str
            The student's function; or its name, for a cell that must not fail where the function is missing.
        scope : mapping, optional
            Where the name is looked up: a notebook's ``globals()``.
        """
        mark = self.marked(function, scope)
        show(mark)
        return mark.points

    def marked(self, function: Callable[..., Any] | str, scope: Mapping[str, Any] | None = None) -> Mark:
        """Return points and table together; see ``mark``."""
        if isinstance(function, str):
            function = (scope or {}).get(function, missing(function))
        if isinstance(function, Missing):
            return Mark(self.name, tuple(Row(part.says, part.points, function.answer) for part in self.parts))
        if callable(function):
            function = self.called(function if isinstance(function, Remote) else Local(function))
        return Mark(self.name, tuple(self._rows(function)))

    def called(self, function: Remote | Local) -> Any:
        """Return how the parts call a function: here, each of them as it is."""
        return function

    def _rows(self, function: Any) -> Iterator[Row]:
        """Yield a row for each part; the first one whose time is over has one more try: the machine may be busy."""
        tries = 1
        for part in self.parts:
            answer = part.answer(function)
            if answer.fault == "out of time" and tries:
                tries, answer = 0, part.answer(function)
            yield Row(part.says, part.points, answer, tuple(sorted(getattr(function, "remarks", ()))))


def missing(name: str, failed: tuple[str, str] | None = None) -> Missing:
    """Return why there is no function: its cell has failed, or it has another name, or none was written."""
    if failed is None:
        says = f"there is no function {name}: run its cell, and keep its name."
        return Missing(name, Answer("not attempted", says, "no such function"))
    kind, told = failed
    says = f"there is no function {name}: its cell stops with {told}."
    return Missing(name, Answer("error", says, f"its cell stops with {kind}"))


def _name_fault(answer: Answer) -> Answer:
    """Name what is wrong in any task: nothing is returned, or something of another form than was asked for."""
    if answer.verdict != "wrong" or answer.fault is not None or not ALL_WRONG.match(answer.says):
        return answer
    if "is there a return?" in answer.says:
        return replace(answer, fault="returns nothing")
    return replace(answer, fault="returns what cannot be judged") if OTHER_FORM.search(answer.says) else answer
