"""Failed cells: why a student's function is missing, when the cell that should define it has failed.

In:  what the notebook's cells did, once ``watch`` has been called in its kernel; ``primkit teach grade`` does so.
Out: for the name of a function the error of its cell, with the line; ``None`` where nothing is known.
"""

from __future__ import annotations

import re
from types import TracebackType
from typing import Any

FAILED_CELLS = "_primkit_failed"  # an attribute of the shell: source -> the error's name, and where and what it was


def watch() -> None:
    """Keep the errors of this kernel's cells, from now on."""
    shell = _shell()
    if shell is None or hasattr(shell, FAILED_CELLS):
        return
    failed: dict[str, tuple[str, str]] = {}
    setattr(shell, FAILED_CELLS, failed)

    def after(result: Any) -> None:
        error = result.error_before_exec or result.error_in_exec
        if error is not None:
            failed[result.info.raw_cell] = _describe(error, shell.user_ns)

    shell.events.register("post_run_cell", after)


def failure(name: str) -> tuple[str, str] | None:
    """Return the error's name and a sentence about the last failed cell that defines a function."""
    defines = re.compile(rf"^[ \t]*(async +)?def +{re.escape(name)}\b", re.MULTILINE)
    failed: dict[str, tuple[str, str]] = getattr(_shell(), FAILED_CELLS, {})
    found = [told for source, told in failed.items() if defines.search(source)]
    return found[-1] if found else None


def _shell() -> Any:
    from IPython import get_ipython

    return get_ipython()


def _describe(error: BaseException, scope: dict[str, Any]) -> tuple[str, str]:
    """Return an error's name; and its line and words."""
    kind = type(error).__name__
    line = error.lineno if isinstance(error, SyntaxError) else _line_of(error.__traceback__, scope)
    words = error.msg if isinstance(error, SyntaxError) else str(error)
    where = f" in line {line}" if line else ""
    what = f": {' '.join(words.split())[:120]}" if words else ""
    return kind, f"{kind}{where}{what}"


def _line_of(frame: TracebackType | None, scope: dict[str, Any]) -> int | None:
    """Return the line of the cell itself in a traceback."""
    while frame is not None and frame.tb_frame.f_globals is not scope:
        frame = frame.tb_next
    return None if frame is None else frame.tb_lineno
