"""A class of 300 from three downloads, with every trouble of ``tests/classes.py``: from the zips to files for an LMS.

    python -m tests.benchmarks.class_of_300 [N] [DIR]

N students (300; 30 have every trouble once). The grading is killed when a quarter is done, and begun again. Every
score is compared with the expected one, and every fault must have its line. What it does to the machine is what
``primkit teach grade`` allows: mind its --help.
"""

import ctypes
import os
import resource
import subprocess
import sys
import tempfile
import time
from contextlib import suppress
from pathlib import Path

import numpy as np

from tests.classes import PS, SETTINGS, hand_in, roster
from tests.submissions import ProblemSet
from tests.test_class import killed_after
from tests.test_teaching import table


def main(number, folder):
    adopt_orphans()
    course = Path(folder) / "course"
    told(folder, "new-course", "course")
    config = course / "nbgrader_config.py"
    settings = config.read_text("utf-8").replace("timeout = 60", "timeout = 20")
    config.write_text(settings.replace("CarefulExecute.seconds = 5", "CarefulExecute.seconds = 2"), "utf-8")
    (course / "course.toml").write_text(SETTINGS)
    (course / "students.csv").write_bytes(roster(number).encode("utf-16"))
    told(course, "release", PS)
    class_ = hand_in(Path(folder), ProblemSet(course, PS), np.random.default_rng(300), number)
    start, seconds = time.monotonic(), used()
    said = told(course, "collect", PS, *(str(Path(folder, name)) for name in DOWNLOADS))
    print(f"placed in {time.monotonic() - start:.0f} s, {used() - seconds:.0f} s of processor time", flush=True)
    start, seconds = time.monotonic(), used()
    killed_after(number // 4, course, "grade", PS)
    said += told(course, "grade", PS)
    took, per = time.monotonic() - start, (used() - seconds) / number
    print(f"graded in {took:.0f} s, {per:.1f} s of processor time a submission, kernels and the killed run included")
    said += told(course, "report", PS) + told(course, "hand-back", PS)
    return compare(course, class_, said)


def compare(course, class_, said):
    """Compare scores with the expected ones, and look for a line about each fault."""
    marks = {row["id"]: row for row in table(course / "reports" / PS / "class.csv")}
    wrong = {row["student"] for row in table(course / "reports" / PS / "wrong.csv")}
    off, untold = {}, []
    for student, (kind, trouble) in class_.items():
        state, points = marks[student][PS], float(marks[student]["ps1 (of 15.0)"])
        if (state == "could not be graded") != (trouble.points is None) or points != (trouble.points or 0):
            off[student] = kind, state, points, trouble.points
        lines = [line for line in said.splitlines() if student in line and trouble.says in line]
        if trouble.says and not lines and student not in wrong:
            untold.append((student, kind))
    print(f"{len(class_)} submissions; not as expected: {off or 'none'}; faults without a line: {untold or 'none'}")
    return not off and not untold and "without a place" not in said


SET_CHILD_SUBREAPER = 36  # of Linux's prctl
DOWNLOADS = ("moodle.zip", "canvas.zip", "inbound")


def told(course, *words):
    """Run a command as a teacher does, however long it takes; return what it says."""
    command = [sys.executable, "-m", "primkit", "teach", *words]
    return subprocess.run(command, cwd=course, capture_output=True, text=True, encoding="utf-8", check=True).stdout


def adopt_orphans():
    """Become the parent of what outlives its own: a kernel behind walls does, and would not be counted."""
    with suppress(AttributeError, OSError):
        ctypes.CDLL(None).prctl(SET_CHILD_SUBREAPER, 1, 0, 0, 0)


def used():
    """Processor time of all that has run and ended, in s."""
    with suppress(ChildProcessError):
        while os.waitpid(-1, os.WNOHANG)[0]:
            pass
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


if __name__ == "__main__":
    number = int(sys.argv[1]) if len(sys.argv) > 1 else 300
    if len(sys.argv) > 2:
        sys.exit(not main(number, sys.argv[2]))
    with tempfile.TemporaryDirectory() as folder:
        sys.exit(not main(number, folder))
