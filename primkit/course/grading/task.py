"""Task: a function of a problem set, the parts it is marked by, and their points.

In:  the student's function, or its name and where to look it up.
Out: the points, all or none for each part, and a table of what is off.

>>> from primkit.checks import Check, judges
>>> half = Check("half", lambda x: x / 2, lambda rng: [(1.0,), (3.0,)], judges.number("m"))
>>> Task("half", [Part("halves lengths", 2, half)]).marked(lambda x: 0.5)
half: 0 of 2 points
✗ 0 of 2  halves lengths: in 1 of 2 cases. For example half(x=3): got 0.5 m, expected 1.5 m.

The last expression of a grade cell is ``task.mark("half", globals())``: nbgrader reads its number as the cell's points.
"""

from __future__ import annotations

import io
import re
from collections.abc import Callable, Iterable, Mapping
from contextlib import redirect_stderr
from dataclasses import dataclass, replace
from typing import Any

from ...arguments import as_positive
from ...checks.answer import Answer, Check
from .failed_cells import failure
from .limit import OutOfTime, TimeLimit
from .mark import Mark, Row

PART_SECONDS = 5.0  # for each part; a check with its few hundred cases needs less than one


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

    def answer(self, function: Any, seconds: float) -> Answer:
        """Judge a function, whatever it does, within so many seconds."""
        name = self.check.name
        try:
            # What is printed to stderr would count as a failed cell.
            with redirect_stderr(io.StringIO()), TimeLimit(seconds):
                return _name_fault(self.check(function))
        except OutOfTime:
            says = f"{name} did not end within {seconds:g} s: is there a loop that never ends, or is it too slow?"
            return Answer("error", says, "out of time")
        except KeyboardInterrupt:  # the whole cell's time is over, or somebody waits no longer
            raise
        except Exception as error:  # the judge met something that it does not know
            says = f"{name} returns what cannot be judged ({type(error).__name__}: {error})."
            return Answer("error", says, "returns what cannot be judged")
        except BaseException as error:  # exit(), and whatever else wants to end Python
            kind = type(error).__name__
            return Answer("error", f"{name} ends Python with {kind}: a function returns.", f"raises {kind}")


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

    def mark(
        self,
        function: Callable[..., Any] | str,
        scope: Mapping[str, Any] | None = None,
        *,
        seconds: float = PART_SECONDS,
    ) -> float:
        """Return the points, and show the table where a notebook can.

        Parameters
        ----------
        function : callable or str
            The student's function; or its name, for a cell that must not fail where the function is missing.
        scope : mapping, optional
            Where the name is looked up: a notebook's ``globals()``.
        seconds : float
            Time limit for each part.
        """
        mark = self.marked(function, scope, seconds=seconds)
        _show(mark)
        return mark.points

    def marked(
        self,
        function: Callable[..., Any] | str,
        scope: Mapping[str, Any] | None = None,
        *,
        seconds: float = PART_SECONDS,
    ) -> Mark:
        """Return points and table together; see ``mark``."""
        seconds = as_positive(seconds, "seconds")
        if isinstance(function, str):
            if function not in (scope or {}):
                missing = _explain_missing(function)
                return Mark(self.name, tuple(Row(part.says, part.points, missing) for part in self.parts))
            function = (scope or {})[function]
        rows = (Row(part.says, part.points, part.answer(function, seconds)) for part in self.parts)
        return Mark(self.name, tuple(rows))


def _explain_missing(name: str) -> Answer:
    """Return why there is no function: its cell has failed, or it has another name, or none was written."""
    failed = failure(name)
    if failed is None:
        says = f"there is no function {name}: run its cell, and keep its name."
        return Answer("not attempted", says, "no such function")
    kind, told = failed
    return Answer("error", f"there is no function {name}: its cell stops with {told}.", f"its cell stops with {kind}")


def _name_fault(answer: Answer) -> Answer:
    """Name what is wrong in any task: nothing is returned, or something of another form than was asked for."""
    if answer.verdict != "wrong" or answer.fault is not None or not ALL_WRONG.match(answer.says):
        return answer
    if "is there a return?" in answer.says:
        return replace(answer, fault="returns nothing")
    return replace(answer, fault="returns what cannot be judged") if OTHER_FORM.search(answer.says) else answer


def _show(mark: Mark) -> None:
    """Show a table in the notebook that runs this, if one does."""
    from IPython import get_ipython
    from IPython.display import display

    if get_ipython() is not None:
        display(mark)  # type: ignore[no-untyped-call]  # IPython gives it no types
