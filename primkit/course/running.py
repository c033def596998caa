"""Running: nbgrader's own commands, each in a process of its own.

In:  a course, the words of a command such as ``generate_assignment ps1``, and where its log goes.
Out: whether it succeeded, and its log.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import sysconfig
import tempfile
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path

from .course import Course

# Several commands in one process: nbgrader takes seconds to be read in.
IN_A_ROW = """\
import json, sys
from nbgrader.apps.nbgraderapp import NbGraderApp
from traitlets.config import Application
for words in json.loads(sys.argv[1]):
    if Application.initialized():
        Application.instance().clear_instance()
    NbGraderApp.launch_instance(words)
"""


@dataclass(frozen=True)
class Done:
    """How a command ended."""

    code: int
    log: str
    stopped: bool = False  # because its time was over

    @property
    def reason(self) -> str:
        """The line that names the error: the traceback's last, or nbgrader's first complaint."""
        lines = [line.strip() for line in self.log.splitlines() if line.strip()]
        named = [line for line in lines if re.match(r"[\w.]*(Error|Exception)\b", line)]
        complaints = [line for line in lines if "| ERROR]" in line]
        return (named[-1:] or complaints[:1] or lines[-1:] or [f"exit code {self.code}"])[0]


def nbgrader(course: Course, *words: str, log: Path | None = None, seconds: float | None = None) -> Done:
    """Run a command of nbgrader's in the course folder; several, each if those before succeed, with && between."""
    commands = [list(group) for joins, group in groupby(words, lambda word: word == "&&") if not joins]
    command = [sys.executable, "-c", IN_A_ROW, json.dumps(commands)]
    # Into a file, not a pipe: a pipe stays open for as long as anything lives that a submission has started.
    with tempfile.TemporaryFile() as said:
        try:
            done = subprocess.run(
                command,
                cwd=course.root,
                env=_environment(),
                stdin=subprocess.DEVNULL,
                stdout=said,
                stderr=subprocess.STDOUT,
                timeout=seconds,
                check=False,
            )
            code, last = done.returncode, ""
        except subprocess.TimeoutExpired:
            code, last = 1, f"\nTimeoutError: nbgrader was stopped after {seconds or 0:g} s"
        said.seek(0)
        result = Done(code, said.read().decode("utf-8", "replace").replace("\r\n", "\n") + last, bool(last))
    if log is not None:
        log.parent.mkdir(parents=True, exist_ok=True)
        log.write_text(f"$ nbgrader {' '.join(words)}\n{result.log}", encoding="utf-8")
    return result


def _environment() -> dict[str, str]:
    """Return an environment that finds alembic, which nbgrader calls by its name."""
    paths = filter(None, [sysconfig.get_path("scripts"), os.environ.get("PATH")])
    return {**os.environ, "PATH": os.pathsep.join(paths), "PYTHONUTF8": "1"}
