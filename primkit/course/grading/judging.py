"""Judging: the graded cells of a submission, run as the teacher wrote them, in the judge's own process.

The cells come from the teacher's ``source/``, by their names; what a submission holds in their place is never run. A
name that the teacher's solutions define stands for what the student's notebook has under it: a function is called from
afar, see ``workers.py``. All other names are the teacher's own: of the cells that are locked and not graded, imports
and data, those run here that a graded cell needs.

In:  the teacher's notebook, and the workers of the student's.
Out: the outputs of a graded cell, from which nbgrader reads the points.
"""

from __future__ import annotations

import ast
import importlib
import io
import json
import symtable
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from pathlib import Path
from typing import Any

from nbformat.v4 import new_output

from .mark import shown_marks
from .task import Missing
from .workers import Ended, OutOfTime, Workers

FILE = "<graded cell>"
HIDDEN_TESTS = "grader"  # the course's package


class Judging:
    """The graded cells of one notebook of the teacher's; ``missing`` says why a student's has no such name."""

    def __init__(self, path: Path, missing: Callable[[str], Missing]) -> None:
        notebook = json.loads(path.read_text(encoding="utf-8"))
        self.cells = [{**cell, "source": "".join(cell["source"])} for cell in notebook["cells"]]
        settings = notebook["metadata"].get("primkit", {})
        self.without = list(settings.get("without", ()))  # modules that refuse to work
        self.seconds = settings.get("seconds")  # where a course's usual ones are too few
        self.missing = missing
        code = [(cell, _about(cell)) for cell in self.cells if cell["cell_type"] == "code"]
        by_test = [(about, cell) for cell, about in code if about.get("grade") and not about.get("solution")]
        self.graded = {about["grade_id"]: cell for about, cell in by_test}
        self.given = [cell for cell, about in code if about.get("locked") and not about.get("grade")]
        solved = [cell for cell, about in code if about.get("solution") and not about.get("grade")]
        self.students = sorted({name for cell in solved for name in _names(cell["source"])[0]})
        self.scope: dict[str, Any] = {"__name__": "__main__"}
        self.ran: list[int] = []

    def outputs(self, name: str, cell: int, workers: Workers) -> list[Any]:
        """Return what a graded cell shows; a busy machine's second try counts. One of 0 points was dropped: nothing."""
        if not _about(self.graded[name]).get("points"):
            return []
        for tries in (1, 0):
            outputs, late = self._tried(name, cell, workers)
            if not (late and tries):
                break
        return outputs

    def _tried(self, name: str, cell: int, workers: Workers) -> tuple[list[Any], bool]:
        source, said, value = self.graded[name]["source"], io.StringIO(), None
        error, late = None, False
        with shown_marks() as marks, redirect_stdout(said):
            try:
                self._prepare(name)
                workers.start(cell)
                there = workers.names(cell, self.students)
                self.scope.update({each: there.get(each, self.missing(each)) for each in self.students})
                value = _run(source, self.scope)
            except KeyboardInterrupt:
                raise
            except OutOfTime as stop:
                error, late = error_output("CellTimeoutError", f"{stop}, twice"), True
            except Ended as ended:
                error = error_output("KernelDied", str(ended))
            except BaseException as wrong:
                error = error_output(type(wrong).__name__, str(wrong), "\n".join(_places(wrong, source)))
        outputs = [_output("stream", name="stdout", text=said.getvalue())] if said.getvalue() else []
        outputs += [_output("display_data", data=mark._repr_mimebundle_()) for mark in marks]
        if value is not None:
            outputs.append(_output("execute_result", data={"text/plain": repr(value)}))
        return outputs + [error] * bool(error), late

    def _prepare(self, name: str) -> None:
        """Run those of the given cells before a graded one that it needs, each of them once."""
        wanted, place = _names(self.graded[name]["source"])[1], self.cells.index(self.graded[name])
        needed: list[int] = []
        for k in reversed(range(place)):
            if self.cells[k] in self.given:
                bound, used = _names(self.cells[k]["source"])
                if bound & wanted:
                    needed.append(k)
                    wanted |= used
        for k in sorted(set(needed) - set(self.ran)):
            with redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()):
                _run(self.cells[k]["source"], self.scope)
            self.ran.append(k)
        if "matplotlib.pyplot" in sys.modules:
            sys.modules["matplotlib.pyplot"].close("all")


@contextmanager
def hidden_tests_of(course: Path) -> Iterator[None]:
    """Let graded cells import a course's hidden tests as they are now: a page of Jupyter's grades many times."""
    others = _without_hidden_tests()
    sys.path.insert(0, str(course))
    importlib.invalidate_caches()
    try:
        yield
    finally:
        sys.path.remove(str(course))
        _without_hidden_tests()
        sys.modules.update(others)


def _without_hidden_tests() -> dict[str, Any]:
    """Forget the hidden tests that were imported, and return them."""
    return {name: sys.modules.pop(name) for name in [*sys.modules] if name.partition(".")[0] == HIDDEN_TESTS}


def _about(cell: dict[str, Any]) -> dict[str, Any]:
    return dict(cell["metadata"].get("nbgrader", {}))


def _run(source: str, scope: dict[str, Any]) -> Any:
    """Run a cell, and return the value of its last expression."""
    tree = ast.parse(source, FILE)
    last = tree.body.pop() if tree.body and isinstance(tree.body[-1], ast.Expr) else None
    exec(compile(tree, FILE, "exec"), scope)
    return eval(compile(ast.Expression(last.value), FILE, "eval"), scope) if isinstance(last, ast.Expr) else None


def _names(source: str) -> tuple[set[str], set[str]]:
    """Return the names that a cell binds, and those that it uses, in its functions, too."""
    top = symtable.symtable(source, FILE, "exec")
    bound = {symbol.get_name() for symbol in top.get_symbols() if symbol.is_assigned() or symbol.is_imported()}
    return bound, {symbol.get_name() for symbol in _all_symbols([top]) if symbol.is_global() or symbol.is_referenced()}


def _all_symbols(tables: Iterable[symtable.SymbolTable]) -> Iterator[symtable.Symbol]:
    for table in tables:
        yield from table.get_symbols()
        yield from _all_symbols(table.get_children())


def _places(wrong: BaseException, source: str) -> Iterator[str]:
    """Yield the line of the test that fails, and those of the student's that it comes from."""
    trace, lines = wrong.__traceback__, source.splitlines()
    while trace is not None:
        if trace.tb_frame.f_code.co_filename == FILE and 0 < trace.tb_lineno <= len(lines):
            yield lines[trace.tb_lineno - 1].strip()
        trace = trace.tb_next
    yield from getattr(wrong, "where", "").splitlines()


def error_output(name: str, sentence: str, where: str = "") -> Any:
    """Return an error as a cell shows it."""
    told = [where] * bool(where) + [f"\x1b[0;31m{name}\x1b[0m: {sentence}"]
    return _output("error", ename=name, evalue=sentence, traceback=told)


def _output(kind: str, **content: Any) -> Any:
    return new_output(kind, **content)  # type: ignore[no-untyped-call]  # nbformat gives it no types
