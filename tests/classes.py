"""A class that hands in through three ways at once, with every trouble that was met; what each of them should get.

``Trouble``: how one student hands in, the points it is worth (None: it cannot be graded), and what is said about it.
"""

import json
from dataclasses import dataclass
from datetime import UTC, datetime

from tests.answers.assignment_1 import ANSWERS as LISTED
from tests.downloads import canvas, edition_3, exchange, moodle, packed, with_outputs
from tests.submissions import ANSWERS, about, renamed, with_cell

PS, TASK = "ps1", "sonar_reading"
LOST = ("ps1-setup", "busy_cells-hidden")  # cells that JupyterLab lets a student delete
DUE = datetime(2026, 3, 1, 12, tzinfo=UTC)
SETTINGS = f"[due]\n{PS} = {DUE.isoformat()}\n[late]\ngrace_minutes = 15\npercent_a_day = 10\ndays = 7\n"
SCRIPTS = {
    "markdown": "<script>alert('m')</script><img src=x onerror=alert(1)>[click](javascript:alert(2))",
    "html": "from IPython.display import HTML\nHTML(\"<script>alert('h')</script><b onclick='x()'>x</b>\")",
    "javascript": "from IPython.display import Javascript, display\ndisplay(Javascript(\"alert('j')\"))",
    "svg": "from IPython.display import SVG, display\ndisplay(SVG('<svg onload=\"alert(3)\"></svg>'))",
}
FORGED = (
    "from IPython.display import display\n"
    "display({'application/vnd.primkit.mark+json': 5, 'text/plain': '999'}, raw=True)"
)

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


@dataclass(frozen=True)
class Trouble:
    """One student's way: the notebook's bytes, files beside it, points, and words that stand in a line about it."""

    content: bytes
    points: float | None
    says: str = ""
    name: str = f"{PS}.ipynb"
    late_hours: float = -24.0  # before the due date
    beside: dict = None
    earlier: bytes | None = None  # handed in a day before


def dumped(notebook):
    return json.dumps(notebook).encode()


def troubles(ps, rng):
    """Yield (name, Trouble), twelve of them: each call makes them anew, with other names for variables."""

    def right():
        return {task: renamed(code, rng) for task, code in ps.solutions.items()}

    def notebook(**answers):
        return ps.with_answers(right() | answers)

    wrong, loses = next((name, loses) for name, (_, loses, _) in LISTED[TASK]["wrong"].items() if 1 < len(loses) < 4)
    left = ps.of[TASK] - len(loses)  # each part of this task has one point, as the visible tests have
    listed = {"listed_answers.py": (ANSWERS / "assignment_1.py").read_bytes()}
    lost = ps.points - ps.of[TASK]
    scripts = notebook()
    for name, source in SCRIPTS.items():
        scripts = with_cell(scripts, source)
        if name == "markdown":
            scripts["cells"][-1] = {"cell_type": "markdown", "metadata": {}, "source": source, "id": "m"}
    lacks = notebook()
    lacks["cells"] = [cell for cell in lacks["cells"] if about(cell).get("grade_id") not in LOST]
    fails = dumped(notebook(**{TASK: ps.listed(TASK, "wrong", wrong)}))
    late = {"late_hours": 25, "earlier": dumped(ps.released)}

    yield "right", Trouble(dumped(notebook()), ps.points, name="PS1_mine.ipynb")
    yield "cells lost", Trouble(dumped(lacks), ps.points, "was missing in what was handed in")
    yield "wrong", Trouble(fails, lost + left, beside=listed)
    yield "wrong too", Trouble(fails, lost + left, beside=listed)
    yield "edition 3", Trouble(dumped(edition_3(notebook())), ps.points, "nbformat 3 brought up to 4")
    yield "late and twice", Trouble(dumped(notebook()), 0.8 * ps.points, " late", **late)
    yield "outputs", Trouble(dumped(with_outputs(notebook(), 20)), ps.points, "MB, kept without outputs")
    yield "scripts", Trouble(dumped(scripts), ps.points)
    yield "forged mark", Trouble(dumped(with_cell(notebook(), FORGED, before=TASK)), ps.points)
    yield "endless", Trouble(dumped(notebook(**{TASK: STUB + "while True:\n        pass"})), lost, "did not end within")
    yield "odd cells", Trouble(b'{"cells": [{"metadata": 5}]}', None, "has cells that are none")
    yield "cut", Trouble(dumped(notebook())[:5000], None, "is not JSON")


def more_troubles(ps, rng):
    """Yield (name, Trouble) of what harms the computer that grades; one task is lost, or nothing."""
    answers = [{task: renamed(code, rng) for task, code in ps.solutions.items()} for _ in (*IN_A_TASK, *BESIDE)]
    for (name, code), right in zip(IN_A_TASK.items(), answers, strict=False):
        yield name, Trouble(dumped(ps.with_answers(right | {TASK: code})), ps.points - ps.of[TASK])
    for (name, code), right in zip(BESIDE.items(), answers[len(IN_A_TASK) :], strict=True):
        yield name, Trouble(dumped(with_cell(ps.with_answers(right), code, before=TASK)), ps.points)


def person(n):
    return f"s_{n:03d}", f"Änn{n:03d}", f"O'Test-{'abcdefghij'[n % 10]}{n}"


def roster(number):
    """Return students.csv of a class of so many, as a spreadsheet saves it in much of Europe."""
    return "\n".join(["id;first_name;last_name;email", *(";".join((*person(n), "")) for n in range(number)), ";;;", ""])


def hand_in(folder, ps, rng, number):
    """Write three downloads of a class of so many; return for each id its Trouble.

    One third comes by Moodle, every second one in a zip; one by Canvas; one by nbgrader's exchange.
    """
    class_, boxes = {}, ({}, {})
    kinds = []
    while len(class_) < number:
        kinds = kinds or [*troubles(ps, rng), *(more_troubles(ps, rng) if number > 12 else ())]
        kind, trouble = kinds.pop(0)
        n = len(class_)
        student, first, last = person(n)
        class_[student] = (kind, trouble)
        versions = [(trouble.earlier, trouble.late_hours - 24)] if trouble.earlier and n % 3 == 2 else []
        for content, hours in [*versions, (trouble.content, trouble.late_hours)]:
            when = datetime.fromtimestamp(DUE.timestamp() + 3600 * hours, UTC)
            stamp = when.astimezone().timetuple()[:6]
            files = {trouble.name: content, **(trouble.beside or {})}
            if n % 3 == 0:
                packs = {"inner.zip": packed(files, when=stamp)} if n % 2 else files
                boxes[0].update({moodle(f"{first} {last}", 500 + n, file): (v, stamp) for file, v in packs.items()})
            elif n % 3 == 1:
                for k, (file, data) in enumerate(files.items()):
                    boxes[1][canvas(first, last, 700 + n, 9000 + 10 * n + k, file, late=hours > 0)] = data
            else:
                inbound = folder / "inbound" / exchange(student, PS, f"{when:%Y-%m-%d %H:%M:%S} UTC")
                inbound.mkdir(parents=True)
                for file, data in files.items():
                    (inbound / file).write_bytes(data)
    (folder / "moodle.zip").write_bytes(packed(boxes[0]))
    (folder / "canvas.zip").write_bytes(packed(boxes[1]))
    return class_


def expected(class_):
    """Return the points that each should have."""
    return {student: trouble.points for student, (_, trouble) in class_.items()}
