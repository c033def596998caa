"""Answer: whether a student's function is right, and if not, what is off.

A check runs the function on many cases, judges each result with a tolerance, and answers one of four things: *not
attempted*, *wrong* with what is off, *error* with the input that broke it, or *right*.

In:  the student's function, and a ``Check``: cases, a reference, how to judge, and known faults by their names.
Out: an ``Answer``, which a notebook shows; or the function to go on with, the student's own or the reference.

>>> def half(x: float) -> float:
...     return x / 2
>>> from primkit.checks.judges import number
>>> check = Check("half", half, lambda rng: [(x,) for x in rng.uniform(size=5)], number("m"))
>>> check(lambda x: 0.5 * x)
✓ right: half passes all 5 cases.
>>> check(lambda x: ...)
○ not attempted: half still returns `...`.
"""

from __future__ import annotations

import copy
import inspect
import io
import warnings
from collections.abc import Callable, Iterable, Sequence
from contextlib import redirect_stdout
from dataclasses import dataclass
from html import escape
from typing import Any, Literal

import numpy as np

from .cases import Args
from .judges import Judge, same, shown

Verdict = Literal["not attempted", "wrong", "error", "right"]

SEED = 20  # the same cases for everybody, on every run

VERDICT_SIGNS = {"not attempted": "○", "wrong": "✗", "error": "!", "right": "✓"}
# Okabe and Ito's colours, dark enough for letters; the sign and the word say the same without them.
VERDICT_COLORS = {"not attempted": "#5A5A5A", "wrong": "#A34700", "error": "#A34700", "right": "#00694D"}


@dataclass(frozen=True)
class Answer:
    """What a check says.

    Parameters
    ----------
    verdict : {"not attempted", "wrong", "error", "right"}
        In short.
    says : str
        In a sentence or two: what is off, or with which input it broke.
    fault : str, optional
        A short name for what is wrong, the same for all who do the same: what an overview of a class counts.
    """

    verdict: Verdict
    says: str
    fault: str | None = None

    @property
    def right(self) -> bool:
        """Whether the function is right."""
        return self.verdict == "right"

    def __repr__(self) -> str:
        return f"{VERDICT_SIGNS[self.verdict]} {self.verdict}: {self.says}"

    def __str__(self) -> str:
        return f"{self.verdict}: {self.says}"  # without the sign, which many a Windows console cannot print

    def _repr_html_(self) -> str:
        color, words = VERDICT_COLORS[self.verdict], escape(self.says).replace("\n", "<br>")
        return (
            f'<div style="border-left:4px solid {color};padding:4px 10px;line-height:1.5">'
            f'<b style="color:{color}">{VERDICT_SIGNS[self.verdict]} {self.verdict}</b>: {words}</div>'
        )


@dataclass(frozen=True)
class Case:
    """One case: what the function got, what it returned, what the reference returns, and what is off (or None)."""

    args: Args
    got: Any
    expected: Any
    off: str | None


@dataclass(frozen=True)
class Fault:
    """A usual fault with its name.

    Parameters
    ----------
    says : str
        What the student is told: a hint at the reason, not the solution.
    like : callable or tuple of callable, optional
        The faulty algorithm, or several: a student's function that returns the same in every case has this fault.
    when : callable, optional
        Looks at all cases instead (a list of ``Case``), and tells whether they show this fault.
    name : str, optional
        A few words for the overview of a class, such as ``"corner for centre"``; what it says when not given.
    judge : callable, optional
        Compares with ``like`` where that returns something of another form than was asked for.
    """

    says: str
    like: Callable[..., Any] | tuple[Callable[..., Any], ...] = ()
    when: Callable[[list[Case]], bool] | None = None
    name: str = ""
    judge: Judge | None = None

    @property
    def called(self) -> str:
        """Its name, or what it says."""
        return self.name or self.says


def off_only_where(holds: Callable[[Case], bool]) -> Callable[[list[Case]], bool]:
    """Return a fault's look at all cases: whether something holds for each that is off."""
    return lambda cases: all(holds(case) for case in cases if case.off is not None)


@dataclass(frozen=True)
class Check:
    """A task and how its answers are judged; call it with the student's function.

    Parameters
    ----------
    name : str
        The function's name in the lesson.
    reference : callable
        The library's way, or the plain one; its arguments have the names that the student sees.
    cases : callable
        ``cases(rng)`` yields the arguments of one call each, the plain cases first.
    judge : callable
        ``judge(got, expected, args)`` returns None when a result is right, else what is off in a few words. It
        judges what was asked for, so that any correct algorithm passes. See ``judges.py``.
    faults : tuple of Fault
        Usual faults, the special ones first: the first that fits is named.
    """

    name: str
    reference: Callable[..., Any]
    cases: Callable[[np.random.Generator], Iterable[Args]]
    judge: Judge
    faults: tuple[Fault, ...] = ()

    def __call__(self, mine: Any) -> Answer:
        """Judge a student's function."""
        if not callable(mine):
            return Answer("error", f"{self.name} must be a function, got {shown(mine)}.", "no function")
        cases: list[Case] = []
        for args in self.cases(np.random.default_rng(SEED)):
            given = copy.deepcopy(args)
            try:
                got = _quietly(mine, given)
            except Exception as error:  # whatever it is, it is the answer
                if not cases and isinstance(error, NotImplementedError):  # the stub of a problem set
                    return Answer("not attempted", f"{self.name} still raises NotImplementedError.")
                kind = type(error).__name__
                says = f"{self._write_call(args)} raised {kind}: {error}"
                if isinstance(error, TypeError) and not _accepts(mine, given):
                    names = ", ".join(inspect.signature(self.reference).parameters)
                    says += f"\nKeep the arguments that are given: {self.name}({names})."
                    return Answer("error", says, "asks for other arguments")
                return Answer("error", says, f"raises {kind}")
            if not cases and (got is ... or (isinstance(got, Sequence) and any(part is ... for part in got))):
                return Answer("not attempted", f"{self.name} still returns `...`.")
            if not same(given, args):
                says = f"{self._write_call(args)} changes what it is given: work on a copy."
                return Answer("wrong", says, "changes its arguments")
            expected = self.reference(*copy.deepcopy(args))
            cases.append(Case(args, got, expected, self.judge(got, expected, args)))
        return self._decide(cases)

    def yours_or_ours(self, mine: Callable[..., Any]) -> Step:
        """Return the student's function where it is right, and the reference where it is not; print it to see which."""
        answer = self(mine)
        return Step(self.name, mine if answer.right else self.reference, answer)

    def _decide(self, cases: list[Case]) -> Answer:
        """Return the answer for results that all came without an error."""
        wrong = [case for case in cases if case.off is not None]
        if not wrong:
            return Answer("right", f"{self.name} passes all {len(cases)} cases.")
        fault = next((fault for fault in self.faults if self._has(fault, cases)), None)
        first = wrong[0]
        says = f"in {len(wrong)} of {len(cases)} cases. For example {self._write_call(first.args)}: {first.off}."
        return Answer("wrong", says) if fault is None else Answer("wrong", f"{says}\n{fault.says}", fault.called)

    def _has(self, fault: Fault, cases: list[Case]) -> bool:
        """Tell whether the results show a fault."""
        if fault.when is not None:
            return fault.when(cases)
        ways = fault.like if isinstance(fault.like, tuple) else (fault.like,)
        return any(_goes_like(way, cases, fault.judge or self.judge) for way in ways)

    def _write_call(self, args: Args) -> str:
        """Write a call as a student would."""
        names = list(inspect.signature(self.reference).parameters)
        return f"{self.name}({', '.join(f'{name}={shown(arg)}' for name, arg in zip(names, args, strict=False))})"


class Step:
    """The function that a lesson goes on with; its text says whose it is."""

    def __init__(self, name: str, function: Callable[..., Any], answer: Answer) -> None:
        self.name, self.function, self.answer = name, function, answer

    def __call__(self, *args: Any, **options: Any) -> Any:
        """Call the function."""
        return self.function(*args, **options)

    def __repr__(self) -> str:
        if self.answer.right:
            return f"{self.name}: the lesson goes on with yours."
        return f"{self.name}: the lesson goes on with the library's, because yours is: {self.answer.verdict}."


def _quietly(function: Callable[..., Any], args: Args) -> Any:
    """Call a function without what it prints and warns: it is called hundreds of times."""
    with redirect_stdout(io.StringIO()), warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        return function(*args)


def _goes_like(way: Callable[..., Any], cases: list[Case], judge: Judge) -> bool:
    """Tell whether the results are those of a faulty algorithm."""
    try:
        return all(judge(c.got, _quietly(way, copy.deepcopy(c.args)), c.args) is None for c in cases)
    except Exception:  # it cannot do every case: then it is not what the student did
        return False


def _accepts(function: Callable[..., Any], args: Args) -> bool:
    """Tell whether a function can be called with these arguments, in this order."""
    try:
        inspect.signature(function).bind(*args)
    except TypeError:
        return False
    except ValueError:  # one of those that do not say what they take
        return True
    return True
