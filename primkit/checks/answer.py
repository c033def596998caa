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
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from html import escape
from types import FunctionType
from typing import Any, Literal

import numpy as np

from ..own_code import Line, OutOfTime
from .calls import Raised, hint_at, quietly, run
from .cases import Args
from .judges import Judge, same, shown
from .slips import WORDS, find_slips, places

Verdict = Literal["not attempted", "wrong", "error", "right"]

SEED = 20

CALL_SECONDS = 3.0  # for one call: what takes longer is a loop that never ends, or far too slow
SEARCH_SECONDS, LIKENESS_SECONDS = 3.0, 0.5  # for the slip in the student's own code, and for one like it in ours
# For one call while slips are sought, because an edit can make a loop endless: this, and some times what it took.
TRIED_SECONDS, TRIED_TIMES = 0.03, 8.0
RAISED_SECONDS = 0.015  # what a call that raised is taken to need when it is right

VERDICT_SIGNS = {"not attempted": "○", "wrong": "✗", "error": "!", "right": "✓"}
# Okabe and Ito's colours, drawn towards the page's own letters: so they can be read in a light theme and in a dark one.
VERDICT_COLORS = {
    verdict: f"color-mix(in srgb, {color} 60%, currentColor)"
    for verdict, color in zip(VERDICT_SIGNS, ("#5A5A5A", "#A34700", "#A34700", "#00694D"), strict=True)
}


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
    args : tuple
        The arguments of the first call that went wrong, to try it again: ``mine(*answer.args)``.
    """

    verdict: Verdict
    says: str
    fault: str | None = None
    args: Args = field(default=(), compare=False)

    @property
    def right(self) -> bool:
        """Whether the function is right."""
        return self.verdict == "right"

    @property
    def _ends(self) -> str:
        """Where the arguments are, when what is said does not show all of them; ``_`` is a notebook's last answer."""
        short = self.args and any(sign in self.says for sign in ("=array of shape", "...", " at ("))
        return "\nTry it again: the arguments are _.args." if short else ""

    def __repr__(self) -> str:
        return f"{VERDICT_SIGNS[self.verdict]} {self.verdict}: {self.says}{self._ends}"

    def __str__(self) -> str:
        return f"{self.verdict}: {self.says}"  # without the sign, which many a Windows console cannot print

    def _repr_html_(self) -> str:
        color, words = VERDICT_COLORS[self.verdict], escape(self.says + self._ends).replace("\n", "<br>")
        return (
            f'<div style="border-left:4px solid {color};padding:4px 10px;line-height:1.5">'
            f'<b style="color:{color}">{VERDICT_SIGNS[self.verdict]} {self.verdict}</b>: {words}</div>'
        )


@dataclass(frozen=True)
class Case:
    """One case: what the function got and returned, what the reference returns, what is off (or None), and the time."""

    args: Args
    got: Any
    expected: Any
    off: str | None
    seconds: float = 0.0


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
    seed : int, optional
        What the cases are drawn with: everybody gets the same ones, on every run.
    """

    name: str
    reference: Callable[..., Any]
    cases: Callable[[np.random.Generator], Iterable[Args]]
    judge: Judge
    faults: tuple[Fault, ...] = ()
    seed: int = SEED

    def __call__(self, mine: Any, seconds: float = CALL_SECONDS) -> Answer:
        """Judge a student's function; each call of it may take so many seconds."""
        if not callable(mine):
            return Answer("error", f"{self.name} must be a function, got {shown(mine)}.", "no function")
        cases: list[Case] = []
        warned: list[str] = []
        for args in self.cases(np.random.default_rng(self.seed)):
            given = copy.deepcopy(args)
            done = run(mine, given, seconds)
            got, raised = done.got, done.got if isinstance(done.got, Raised) else None
            if not cases and _is_stub(got):
                what = "raises NotImplementedError" if raised else "returns `...`"
                return Answer("not attempted", f"{self.name} still {what}.{self._other_name(mine)}")
            if raised and isinstance(raised.error, TypeError) and not _accepts(mine, given):
                names = ", ".join(inspect.signature(self.reference).parameters)
                says = (
                    f"{self._write_call(args)} {raised.told}.\nKeep the arguments that are given: {self.name}({names})."
                )
                return Answer("error", says, "asks for other arguments", args)
            if got is not None and not raised and not same(given, args):
                says = f"{self._write_call(args)} changes what it is given: work on a copy."
                return Answer("wrong", says, "changes its arguments", args)
            warned += [f"{message} in {line}" for message, line in dict.fromkeys(done.warned)]
            expected = self.reference(*copy.deepcopy(args))
            off = f"raised {raised.says}" if raised else self.judge(got, expected, args)
            cases.append(Case(args, got, expected, off, RAISED_SECONDS if raised else done.seconds))
            if raised and isinstance(raised.error, OutOfTime):
                break  # nobody waits for the others
        return self._decide(mine, cases, warned)

    def yours_or_ours(self, mine: Callable[..., Any]) -> Step:
        """Return the student's function where it is right, and the reference where it is not; print it to see which."""
        answer = self(mine)
        return Step(self.name, mine if answer.right else self.reference, answer)

    def _decide(self, mine: Any, cases: list[Case], warned: list[str]) -> Answer:
        """Return the answer for what came out of all cases."""
        wrong = [case for case in cases if case.off is not None]
        if not wrong:
            says = f"{self.name} passes all {len(cases)} cases."
            if warned:
                message, times = Counter(warned).most_common(1)[0]
                says += f" But in {times} of them NumPy warns: {message}. Ask first, then calculate."
            return Answer("right", says)
        raised = next((case for case in wrong if isinstance(case.got, Raised)), None)
        fault = next((fault for fault in self.faults if self._has(fault, cases)), None)
        hints = [fault.says] if fault else []
        right = [case for case in cases if case.off is None]
        hints += self._tell_slips(mine, wrong, right, raised.got.line if raised else None)
        hints = hints or self._tell_likeness(wrong, right) or (hint_at(raised.got) if raised else [])
        says = "\n".join([self._tell(cases, wrong, raised or wrong[0]), *hints]) + self._other_name(mine)
        name = fault.called if fault else raised.got.fault if raised else None
        return Answer("error" if raised else "wrong", says, name, (raised or wrong[0]).args)

    def _tell(self, cases: list[Case], wrong: list[Case], first: Case) -> str:
        """Return in how many cases a function is off, and one of them."""
        call = self._write_call(first.args)
        if not isinstance(first.got, Raised):
            return f"in {len(wrong)} of {len(cases)} cases. For example {call}: {first.off}."
        told = f"{call} {first.got.told}."
        if len(wrong) == len(cases):
            return told
        raising = sum(isinstance(case.got, Raised) for case in wrong)
        also = "" if raising == len(wrong) else f", and is off in {len(wrong) - raising}"
        right = len(cases) - len(wrong)
        return f"right in {right} of {len(cases)} cases; raises {first.got.kind} in {raising}{also}. For example {told}"

    def _tell_slips(self, mine: Any, wrong: list[Case], right: list[Case], near: Line | None) -> list[str]:
        """Return where one change would mend it, in a sentence; nothing where none would."""

        def mends(edited: Any, case: Case, seconds: float) -> bool:
            given = copy.deepcopy(case.args)
            got = run(edited, given, min(seconds, TRIED_SECONDS + TRIED_TIMES * case.seconds)).got
            return not isinstance(got, Raised) and self._agree(got, case.expected, case.args) and same(given, case.args)

        slips = find_slips(mine, wrong, right, mends, SEARCH_SECONDS, near)
        if not slips:
            return []
        if slips[0].mends == len(wrong):
            return [f"Look at {places(slips)}. All the rest is right."]
        then = f" Then look at {places(slips[1:])}." if len(slips) > 1 else ""
        return [f"Look at {places(slips[:1])}. {slips[0].mends} of the {len(wrong)} come from there.{then}"]

    def _tell_likeness(self, wrong: list[Case], right: list[Case]) -> list[str]:
        """Return which slip in the plain way gives the same results, for a function whose code cannot be read."""
        if len({repr(case.got) for case in (*wrong, *right)}) == 1:  # says nothing of how it came
            return []

        def alike(edited: Any, case: Case, seconds: float) -> bool:
            other = run(edited, copy.deepcopy(case.args), min(seconds, TRIED_SECONDS)).got
            if isinstance(case.got, Raised) or isinstance(other, Raised):
                return getattr(case.got, "says", "") == getattr(other, "says", None)
            return self._agree(case.got, other, case.args)

        slips = find_slips(self.reference, wrong, right, alike, LIKENESS_SECONDS)
        if not slips or slips[0].mends < len(wrong):
            return []
        kinds = dict.fromkeys(WORDS[slip.kind] for slip in slips)
        return [f"That is what a plain way gives with one slip in it: {', or '.join(kinds)}."]

    def _agree(self, got: Any, other: Any, args: Args) -> bool:
        """Tell whether two results are the same; not where the judge meets something that it does not know."""
        try:
            return self.judge(got, other, args) is None
        except Exception:
            return False

    def _has(self, fault: Fault, cases: list[Case]) -> bool:
        """Tell whether the results show a fault; where it raised, nothing came that could be compared."""
        try:
            if fault.when is not None:
                return fault.when(cases)
            came, judge = [case for case in cases if not isinstance(case.got, Raised)], fault.judge or self.judge
            ways = fault.like if isinstance(fault.like, tuple) else (fault.like,)
            return any(case.off for case in came) and any(_goes_like(way, came, judge) for way in ways)
        except Exception:  # it does not know this kind of result
            return False

    def _write_call(self, args: Args) -> str:
        """Write a call as a student would."""
        names = list(inspect.signature(self.reference).parameters)
        return f"{self.name}({', '.join(f'{name}={shown(arg)}' for name, arg in zip(names, args, strict=False))})"

    def _other_name(self, mine: Any) -> str:
        """Return a word on a function of the cell that asks which has the same arguments and another name."""
        asks, names = inspect.currentframe(), list(inspect.signature(self.reference).parameters)
        while asks and asks.f_globals is not getattr(mine, "__globals__", None):
            asks = asks.f_back
        cell = asks.f_code.co_filename if asks else ""
        for name, other in asks.f_globals.items() if asks else ():
            own = isinstance(other, FunctionType) and other.__code__.co_filename == cell and other is not mine
            if own and list(inspect.signature(other).parameters) == names:
                return f"\nThis is about {mine.__name__}. Is {name} your answer? Then give it the name {self.name}."
        return ""


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


def _is_stub(got: Any) -> bool:
    """Tell whether nothing was written yet: in a lesson, or in a problem set."""
    if isinstance(got, Raised):
        return isinstance(got.error, NotImplementedError)
    return got is ... or (isinstance(got, Sequence) and any(part is ... for part in got))


def _goes_like(way: Callable[..., Any], cases: list[Case], judge: Judge) -> bool:
    """Tell whether the results are those of a faulty algorithm, which can do every case."""
    return all(judge(c.got, quietly(way, copy.deepcopy(c.args)), c.args) is None for c in cases)


def _accepts(function: Callable[..., Any], args: Args) -> bool:
    """Tell whether a function can be called with these arguments, in this order."""
    try:
        inspect.signature(function).bind(*args)
    except (TypeError, ValueError) as error:
        return isinstance(error, ValueError)  # one of those that do not say what they take
    return True
