"""Serving: the student's side of the judge, in the student's own kernel.

At each graded cell the kernel forks: the *twin* keeps what the notebook had defined up to there, and waits until all
cells have run. Then, for each part of a task, the judge asks it for a *worker*, a child that is called case by case and
is thrown away after. So no case is known to a cell that still runs, what one part leaves behind is not met by the next,
and whatever a function does to its process ends with that process.

In:  the judge's address, and the names in the notebook.
Out: what the student's functions return, or raise, as plain values.

Nothing here is trusted: a student's code can change all of it, and gains nothing, for what the judge hears counts as
what the function returns.
"""

from __future__ import annotations

import inspect
import io
import os
import signal
import socket
import sys
import traceback
import warnings
from collections.abc import Callable
from contextlib import redirect_stderr, redirect_stdout, suppress
from pathlib import Path
from typing import Any

import numpy as np

from ...checks.slips import built, pieces_of
from ...own_code import call_within
from .plain_values import pack, stranger
from .wire import FAMILY, MOST_BYTES, HungUpError, hear, say

MESSAGE_LETTERS = 500  # of an error
MOST_LINES = 5  # of a student's, that an error comes from


def leave_twin(address: Any, cell: int, scope: dict[str, Any]) -> None:
    """Fork: the kernel goes on with the notebook, its twin stays as it is now; the judge knows of it already."""
    control = _greet(address, cell, "twin")
    if os.fork():
        control.close()
        return
    try:
        _wait(control, address, cell, scope)
    finally:
        os._exit(0)


def serve(address: Any, cell: int, scope: dict[str, Any]) -> None:
    """Do a worker's work in this very process: where there is no fork, and in the end of the notebook."""
    _answer_calls(_greet(address, cell, "worker"), scope)


def _greet(address: Any, cell: int, role: str) -> socket.socket:
    """Call the judge, and say as what."""
    line = socket.socket(FAMILY)
    line.connect(tuple(address) if isinstance(address, list) else address)
    say(line, cell, role)
    return line


def _wait(control: socket.socket, address: Any, cell: int, scope: dict[str, Any]) -> None:
    """Make a worker whenever the judge asks for one, and end the one before."""
    os.setsid()  # whoever interrupts the notebook does not mean this
    nowhere = os.open(os.devnull, os.O_RDWR)
    for number in (0, 1, 2):
        os.dup2(nowhere, number)
    worker = 0
    with suppress(HungUpError):
        while hear(control, None):
            _end(worker)
            line = _greet(address, cell, "worker")
            worker = os.fork()
            if not worker:
                os.setsid()
                _answer_calls(line, scope)
                return
            line.close()
    _end(worker)


def _end(worker: int) -> None:
    if worker:
        os.kill(worker, signal.SIGKILL)
        os.waitpid(worker, 0)


def _answer_calls(line: socket.socket, scope: dict[str, Any]) -> None:
    edited: Any = None
    with suppress(HungUpError):
        while True:
            wanted, *more = hear(line, None)
            if wanted == "names":
                say(line, {name: _described(scope[name]) for name in more[0] if name in scope})
            elif wanted == "edit":
                edited = None
                with suppress(Exception):
                    edited = built(scope[more[0]], more[1])
                say(line, edited is not None)
            else:
                if wanted == "edited":
                    args, seconds = more
                    more = [(seconds, edited, *args), {}]
                said = _called(call_within if wanted == "edited" else scope[wanted], *more)
                too_much = len(pack(said)) > MOST_BYTES
                say(line, "returned", stranger("result of more than 1 MB"), {}) if too_much else say(line, *said)


def _described(value: Any) -> Any:
    """Return the arguments' names of a function and its source, or the value of what is none."""
    if not callable(value):
        return "value", value
    try:
        names = inspect.signature(value).parameters.values()
        arguments = [(each.name, int(each.kind), each.default is not each.empty) for each in names]
        return "function", (arguments, pieces_of(value))
    except (TypeError, ValueError):  # one of those that do not say what they take
        return "function", None


def _called(function: Callable[..., Any], args: Any, options: Any) -> tuple[Any, ...]:
    """Return ("returned", result, remarks) or ("raised", kinds, message, where)."""
    kept = [arg for arg in (*args, *options.values()) if not isinstance(arg, np.random.Generator)]
    given, out, err = pack(kept), io.StringIO(), io.StringIO()
    try:
        with redirect_stdout(out), redirect_stderr(err), warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            result = function(*args, **options)
    except BaseException as error:
        kinds = [kind.__name__ for kind in type(error).__mro__]
        library = tuple({sys.prefix, sys.base_prefix, str(Path(__file__).resolve().parents[3])})
        own = [line for line in traceback.extract_tb(error.__traceback__) if not line.filename.startswith(library)]
        where = "\n".join(f"line {line.lineno}: {line.line}" for line in own[-MOST_LINES:])
        return "raised", kinds, str(error)[:MESSAGE_LETTERS], where
    said = {"prints": bool(out.tell()), "writes to stderr": bool(err.tell())}
    return "returned", result, {"changes what it is given": pack(kept) != given, **said}
