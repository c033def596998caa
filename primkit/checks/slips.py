"""Slips: the one place of a student's function where something else would make it right.

Beside the story. A slip is a small thing in one place: a comparison, a sign, an axis, an order, one more or less,
degrees. Each place of the student's own code is tried with what may have been meant, and the function runs again. What
is told is the kind and the line, not what should stand there; and it is always so, because it was tried. Any algorithm
will do, in any style; only the function's source must be at hand, as it is in a notebook.

In:  the student's function, the cases, and how to see whether a function is right in a case.
Out: up to three ``Slip`` that each mend all of it, or one or two that mend a part.

>>> places([Slip("sign", Line(4, "y = a - b"), 9), Slip("order", Line(4, "y = a - b"), 9)])
'line 4, `y = a - b`: a sign, or an order'
"""

from __future__ import annotations
import __future__

import ast
import copy
import inspect
import textwrap
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from types import FunctionType
from typing import Any

import numpy as np

from ..own_code import Line, quoted
from .edits import edits

PROBES = 6  # wrong cases that an edit is tried on first, and right ones that a part must spare
SLOW_CASE = 0.004  # s: of what takes longer, one case must do for a first look
PARTS = 6  # edits that mend some of these, which are tried on all cases when none mends all
LEAST_PART = 0.2  # of the wrong cases that a slip must mend to be told
MOST_TOLD = 3

WORDS = {
    "comparison": "a comparison",
    "sign": "a sign",
    "axis": "an axis (x or y, rows or columns)",
    "order": "an order",
    "off by one": "a number that is off by one",
    "degrees": "degrees and radians",
}


@dataclass(frozen=True)
class Slip:
    """A place whose change mends some of the cases that are off, and breaks none."""

    kind: str
    line: Line
    mends: int


def places(slips: Sequence[Slip]) -> str:
    """Write where to look: each line once, with all that may be wrong in it."""
    lines: dict[Line, list[str]] = {}
    for slip in slips:
        lines.setdefault(slip.line, []).append(WORDS[slip.kind])
    return "; or at ".join(f"{line}: {', or '.join(kinds)}" for line, kinds in lines.items())


Holds = Callable[[Any, Any, float], bool]


def find_slips(
    mine: Any, wrong: Sequence[Any], right: Sequence[Any], holds: Holds, seconds: float, near: Line | None = None
) -> list[Slip]:
    """Return slips that mend every wrong case, the likely ones first; else up to two after each other that mend some.

    ``holds(function, case, seconds)`` tells whether a function is right in a case, and takes at most so long. The whole
    search takes at most ``seconds`` of processor time. The lines about ``near`` are tried first.
    """
    code = _Code.of(mine, near)
    end, found = time.process_time() + seconds, list[Slip]()
    while code and wrong and len(found) < 2:

        def mended(edited: Any, cases: Sequence[Any]) -> list[Any]:
            return [c for c in cases if (left := end - time.process_time()) > 0 and holds(edited, c, left)]

        whole, part = _search(code, wrong, right, mended, end)
        if whole:
            return [*found, *whole[: 1 if found else MOST_TOLD]]
        if part is None:
            break
        slip, code, cases = part
        found.append(slip)
        done = set(map(id, cases))
        wrong, right = [case for case in wrong if id(case) not in done], [*right, *cases]
    return found


def _search(
    code: _Code,
    wrong: Sequence[Any],
    right: Sequence[Any],
    mended: Callable[[Any, Sequence[Any]], list[Any]],
    end: float,
) -> tuple[list[Slip], tuple[Slip, _Code, list[Any]] | None]:
    """Try each edit on a few cases, then those that did best on all; return what mends all, or else what mends most."""
    probes, spared = _quick(wrong), _quick(right)
    first = probes[: 1 if probes[0].seconds > SLOW_CASE else 3]
    whole: list[Slip] = []
    parts: list[tuple[int, Slip, _Code]] = []
    for rank in (0, 1):
        for kind, number in edits(code.tree, code.name, rank, code.near):
            edited = code.build() if time.process_time() < end else None
            if edited is None:
                continue
            count = len(mended(edited, first)) and len(mended(edited, probes))
            if not count or len(mended(edited, spared)) < len(spared):
                continue
            slip = Slip(kind, code.line(number), len(wrong))
            if count == len(probes) and all(mended(edited, [case]) for case in (*wrong, *right)):
                whole.append(slip)
            elif (kind, number) == ("order", code.first):
                continue  # of arguments: that is so in all cases, or in none
            elif len(parts) < PARTS or count > parts[-1][0]:
                parts = sorted([*parts, (count, slip, copy.deepcopy(code))], key=lambda part: -part[0])[:PARTS]
        if whole:  # one of each kind first
            kinds = [slip.kind for slip in whole]
            return sorted(dict.fromkeys(whole), key=lambda slip: whole.index(slip) != kinds.index(slip.kind)), None
    best: tuple[Slip, _Code, list[Any]] | None = None
    for _, slip, edited_code in parts:
        cases = mended(edited_code.build(), wrong)
        more = len(cases) > max(LEAST_PART * len(wrong), len(best[2]) if best else 0)
        if more and len(mended(edited_code.build(), right)) == len(right):
            best = replace(slip, mends=len(cases)), edited_code, cases
    return [], best


def _quick(cases: Sequence[Any]) -> list[Any]:
    """Return a few of the cases, the same in each run; where a call takes long, of the quicker half."""
    by_time = sorted(cases, key=lambda case: int(case.seconds / SLOW_CASE))
    half = len(by_time) // 2
    return [by_time[n * half // (PROBES - 1)] for n in range(PROBES)] if half > PROBES else by_time[:PROBES]


@dataclass
class _Code:
    """The source of a function, with those of its helpers from the same cell, as a tree that can be built again."""

    function: Any
    tree: ast.Module
    lines: dict[int, str]
    near: Line | None

    def __deepcopy__(self, memo: Any) -> _Code:
        return replace(self, tree=copy.deepcopy(self.tree, memo))

    @property
    def name(self) -> str:
        """The function's name."""
        return str(self.function.__name__)

    @property
    def first(self) -> int:
        """The function's first line."""
        return next(part.lineno for part in self.tree.body if getattr(part, "name", "") == self.name)

    @classmethod
    def of(cls, mine: Any, near: Line | None = None) -> _Code | None:
        """Read a function's source; None where there is none. Of a function far away, it is told: see ``Remote``."""
        far = hasattr(mine, "to_edit")
        function = mine.to_edit() if far else inspect.unwrap(mine)
        body: list[ast.stmt] = []
        lines: dict[int, str] = {}
        try:
            for first, text in mine.source if far else pieces_of(function):
                parsed = ast.parse(text).body[0]
                if not isinstance(parsed, ast.FunctionDef):
                    return None
                parsed.decorator_list = []
                body.append(ast.increment_lineno(parsed, first - 1))
                lines |= dict(enumerate(text.splitlines(), first))
            return cls(function, copy.deepcopy(ast.Module(body, [])), lines, near) if body else None
        except (SyntaxError, ValueError, IndexError, RecursionError, MemoryError):
            return None

    def line(self, number: int) -> Line:
        """Return a line with its text."""
        return quoted(number, self.lines.get(number, ""))

    def build(self) -> Any:
        """Return the function that the tree now says; None when it says nothing that Python knows."""
        try:
            if isinstance(self.function, FunctionType):
                return built(self.function, self.tree)
            return self.function.edited(ast.unparse(self.tree))
        except (SyntaxError, ValueError, TypeError, NameError):
            return None


def pieces_of(function: Any) -> list[tuple[int, str]]:
    """Return (first line, source) of a function and of its helpers from the same cell; none where they are unknown."""
    if not isinstance(function, FunctionType):
        return []
    names, functions, todo = _names(function), dict[str, FunctionType](), [function]
    while todo:
        one = todo.pop()
        functions[one.__name__] = one
        used = [names.get(name) for name in one.__code__.co_names + one.__code__.co_freevars]
        todo += [
            each
            for each in used
            if isinstance(each, FunctionType)
            and each.__code__.co_filename == function.__code__.co_filename
            and each.__name__ not in functions
        ]
    try:
        read = [inspect.getsourcelines(one) for one in functions.values()]
    except (OSError, SyntaxError, TypeError, IndexError):
        return []
    return [(first, textwrap.dedent("".join(lines))) for lines, first in read]


def built(function: FunctionType, code: Any) -> Any:
    """Return what a function becomes when its source is other code: text, or a tree."""
    names = {**_names(function), "_numpy": np}
    exec(compile(code, "<slip>", "exec", flags=__future__.annotations.compiler_flag), names)
    return names.get(function.__name__)


def _names(function: FunctionType) -> dict[str, Any]:
    """Return the names that a function sees."""
    names, cells = function.__code__.co_freevars, function.__closure__ or ()
    return function.__globals__ | {name: cell.cell_contents for name, cell in zip(names, cells, strict=True)}
