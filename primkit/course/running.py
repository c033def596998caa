"""Running: nbgrader's own commands, each in a process of its own.

nbgrader takes seconds to be read in. So a *nursery* has read it, and forks for each command; where there is no fork, it
runs one command and ends.

In:  a course, the words of a command such as ``generate_assignment ps1``, and where its log goes.
Out: whether it succeeded, and its log.
"""

from __future__ import annotations

import atexit
import json
import os
import re
import subprocess
import sys
import sysconfig
import tempfile
import threading
from contextlib import suppress
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path
from queue import Empty, SimpleQueue

from .course import Course

OUT_OF_TIME = 124  # a command's exit code, as timeout(1) has it
NURSERY = f"""\
import json, os, sys, threading
import primkit.course.executing, primkit.course.sanitizing, scipy.optimize
from nbgrader.apps.nbgraderapp import NbGraderApp
from traitlets.config import Application
primkit.course.executing.confined_by()  # takes a moment, and stays as it is
for line in sys.stdin:
    commands, folder, environment, log, seconds = json.loads(line)
    child = os.fork() if hasattr(os, "fork") else 0
    if child:
        print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), flush=True)
        continue
    said, nothing = os.open(log, os.O_WRONLY), os.open(os.devnull, os.O_RDONLY)
    for number, file in enumerate((nothing, said, said)):
        os.dup2(file, number)
    os.chdir(folder)
    os.environ.clear()
    os.environ.update(environment)
    clock = threading.Timer(seconds, os._exit, [{OUT_OF_TIME}])
    clock.daemon = True
    clock.start()
    for words in commands:
        if Application.initialized():
            Application.instance().clear_instance()
        NbGraderApp.launch_instance(words)
    sys.exit(0)
"""
IDLE: SimpleQueue[subprocess.Popen[str]] = SimpleQueue()  # nurseries that wait for a command


@dataclass(frozen=True)
class Done:
    """How a command ended."""

    code: int
    log: str

    @property
    def reason(self) -> str:
        """The line that names the error: the traceback's last, or nbgrader's first complaint."""
        lines = [line.strip() for line in self.log.splitlines() if line.strip()]
        named = [line for line in lines if re.match(r"[\w.]*(Error|Exception)\b", line)]
        complaints = [line for line in lines if "| ERROR]" in line]
        return (named[-1:] or complaints[:1] or lines[-1:] or [f"exit code {self.code}"])[0]


def nbgrader(course: Course, *words: str, log: Path | None = None, seconds: float = threading.TIMEOUT_MAX) -> Done:
    """Run a command of nbgrader's in the course folder; several, each if those before succeed, with && between."""
    commands = [list(group) for joins, group in groupby(words, lambda word: word == "&&") if not joins]
    with tempfile.TemporaryDirectory() as folder:
        # A file, not a pipe: a pipe stays open for as long as anything lives that a submission has started.
        said = Path(folder, "said")
        said.touch()
        # Where nbgrader finds alembic, which it calls by its name.
        places = filter(None, [sysconfig.get_path("scripts"), os.environ.get("PATH")])
        environment = {**os.environ, "PATH": os.pathsep.join(places), "PYTHONUTF8": "1"}
        code = _run(commands, str(course.root), environment, str(said), seconds)
        text = said.read_bytes().decode("utf-8", "replace").replace("\r\n", "\n")
    over = f"\nTimeoutError: nbgrader was stopped after {seconds:g} s" if code == OUT_OF_TIME else ""
    result = Done(code, text + over)
    if log is not None:
        log.parent.mkdir(parents=True, exist_ok=True)
        log.write_text(f"$ nbgrader {' '.join(words)}\n{result.log}", encoding="utf-8")
    return result


def _run(*command: object) -> int:
    """Let a nursery run a command, and return its exit code."""
    try:
        nursery = IDLE.get_nowait()
    except Empty:
        words = [sys.executable, "-c", NURSERY]
        nursery = subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, encoding="utf-8")
        atexit.register(nursery.communicate)  # so it ends by itself
    said = ""
    if nursery.stdin and nursery.stdout:
        with suppress(OSError):  # it has ended
            nursery.stdin.write(f"{json.dumps(command)}\n")
            nursery.stdin.flush()
        said = nursery.stdout.readline()
    if not said:
        return nursery.wait()
    IDLE.put(nursery)
    return int(said)
