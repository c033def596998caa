"""A hundred submissions, graded unattended, among them some that loop, hog, delete, crash, or are no notebook.

    python -m tests.benchmarks.hundred_submissions [DIR]

The others are the reference with its variables renamed, and each listed wrong answer. Every score is compared with the
expected one. What it does to the machine is what ``primkit teach grade`` allows: mind its --help.
"""

import csv
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from tests.submissions import ProblemSet, about, answers_of, renamed, with_cell

N = 100
NAME, NUMBER, TASK = "ps1", 1, "sonar_reading"  # the faults are put into the second of three tasks

STUB = "def sonar_reading(ranges, angles, axis, cone, range_min, range_max):\n    "
DEAF = "while True:\n    try:\n        while True:\n            pass\n    except:\n        pass"
# As the answer to one task: it costs that task.
IN_A_TASK = {
    "loop-in-function": STUB + "while True:\n        pass",
    "deaf-loop-in-function": STUB + DEAF.replace("\n", "\n    "),
    "hog-in-function": STUB + "return [bytearray(10**9) for _ in range(10**6)]",
    "exit-in-function": STUB + "exit()",
    "kernel-dies-in-function": STUB + "import os\n    os._exit(3)",
    "recursion": STUB + "return sonar_reading(ranges, angles, axis, cone, range_min, range_max)",
    "syntax-error": "def sonar_reading(ranges:\n    return",
    "name-missing": "def sonar(ranges):\n    return 1",
    "loop-at-cell": "while True:\n    pass",
    "deaf-loop-at-cell": DEAF,
    "hog-at-cell": "import numpy as np\nhog = []\nwhile True:\n    hog.append(np.ones(10**7))",
    "kernel-dies-at-cell": "import os\nos._exit(1)",
    "segfault": "import ctypes\nctypes.string_at(0)",
    "flood": "while True:\n    print('again and again ' * 20)",
}
# As one more cell before the second task: it costs nothing but itself.
BESIDE = {
    "deletes-its-folder": "import os, shutil\nshutil.rmtree(os.getcwd())",
    "deletes-its-files": "import os\nfor name in os.listdir('.'):\n    os.remove(name)",
    "changes-directory": "import os\nos.chdir('/')",
    "stderr": "import sys\nprint('careful', file=sys.stderr)",
}
# Hidden tests that show no number have no points.
NO_NUMBERS = "get_ipython().ast_node_interactivity = 'none'"
FILES = {
    "not-json": '{"cells": [',
    "no-cells": "{}",
    "empty-file": "",
    "another-notebook": '{"cells": [], "nbformat": 4}',
}


def hand_in_all(problem_set, rng):
    """Hand in N notebooks; return the expected score of each, None for those that cannot be graded."""
    ps, expected, listed = problem_set, {}, answers_of(NUMBER)

    def reference():
        return {task: renamed(code, rng) for task, code in ps.solutions.items()}

    def one(student, notebook, points, **more):
        ps.hand_in(student, notebook, **more)
        expected[student] = points

    one("untouched", ps.released, 0)
    for name, code in IN_A_TASK.items():
        one(f"task-{name}", ps.with_answers(reference() | {TASK: code}), ps.points - ps.of[TASK])
    for name, code in BESIDE.items():
        one(f"beside-{name}", with_cell(ps.with_answers(reference()), code, before=TASK), ps.points)
    hidden = sum(
        about(cell)["points"] for cell in ps.source["cells"] if about(cell).get("grade_id", "").endswith("-hidden")
    )
    one("no-numbers", with_cell(ps.with_answers(reference()), NO_NUMBERS), ps.points)  # too late to do harm
    one(
        "no-numbers-at-first",
        with_cell(ps.with_answers(reference()), NO_NUMBERS, before=f"{NAME}-setup"),
        ps.points - hidden,
    )
    without = ps.with_answers(reference())
    without["cells"] = [cell for cell in without["cells"] if about(cell).get("grade_id") != f"{TASK}-hidden"]
    one("test-deleted", without, ps.points)  # it is put back
    for name, content in FILES.items():
        one(f"file-{name}", content, None)
    one("file-other-name", ps.released, None)
    folder = ps.course / "submitted" / "file-other-name" / NAME
    (folder / f"{NAME}.ipynb").rename(folder / "my solution.ipynb")
    wrong = [(task, name, points) for task, kinds in listed.items() for name, (_, points, _) in kinds["wrong"].items()]
    for task, name, points in wrong:
        answers = reference() | {task: ps.listed(task, "wrong", name)}
        one(
            f"wrong-{task}-{name.replace(' ', '-')}",
            ps.with_answers(answers),
            ps.points - ps.of[task] + points,
            listed=NUMBER,
        )
    for task, kinds in listed.items():
        for name in kinds["right"]:
            answers = reference() | {task: ps.listed(task, "right", name)}
            one(f"right-{task}-{name.replace(' ', '-')}", ps.with_answers(answers), ps.points, listed=NUMBER)
    while len(expected) < N:
        one(f"renamed-{len(expected):03d}", ps.with_answers(reference()), ps.points)
    return expected


def teach(course, *words):
    done = subprocess.run(
        [sys.executable, "-m", "primkit", "teach", *words], cwd=course, capture_output=True, text=True
    )
    print(done.stdout, done.stderr, flush=True)
    return done


def main(folder):
    course = Path(folder) / "course"
    teach(folder, "new-course", str(course))
    teach(course, "release", NAME)
    expected = hand_in_all(ProblemSet(course, NAME), np.random.default_rng(0))
    start = time.monotonic()
    teach(course, "grade", NAME)
    took = time.monotonic() - start
    teach(course, "report", NAME)
    with open(course / "reports" / NAME / "grades.csv", encoding="utf-8") as file:
        scores = {row["student_id"]: float(row["score"]) for row in csv.DictReader(file)}
    told = set()
    for table in ("faults.csv", "wrong.csv"):
        with open(course / "reports" / NAME / table, encoding="utf-8") as file:
            told |= {row["student"] for row in csv.DictReader(file)}
    off = {name: (scores.get(name), points) for name, points in expected.items() if scores.get(name) != points}
    kinds = ("task-", "file-", "wrong-", "no-numbers-at", "untouched", "beside-deletes")
    faulty = {name for name in expected if name.startswith(kinds)}
    print(f"{len(expected)} submissions in {took:.0f} s; {len(scores)} graded; scores not as expected: {off or 'none'}")
    print(f"{len(faulty)} of them have a fault; without a line in the report: {faulty - told or 'none'}")
    return not off and faulty <= told


if __name__ == "__main__":
    if len(sys.argv) > 1:
        sys.exit(not main(sys.argv[1]))
    with tempfile.TemporaryDirectory() as folder:
        sys.exit(not main(folder))
