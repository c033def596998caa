"""Attacks, through nbgrader itself: none gains a point, none harms anybody, and what leaves a trace is told."""

import os
import re
import shutil
import socket
import subprocess
import sys
import threading
import time
from contextlib import suppress
from pathlib import Path

import nbformat
import psutil
import pytest

from primkit.course.confining import OWN_FOLDERS, PACKAGE, bubblewrap_works, processes_are_limited, walls
from primkit.course.course import new_course
from primkit.course.handed_in import tree_hash
from tests.attacks import ALONE, ATTACKS, FORGERIES, forgeries
from tests.halves import RIGHT, WRONG, assignments
from tests.submissions import read
from tests.test_teaching import table, teach

if not bubblewrap_works():
    if os.environ.get("PRIMKIT_WALLS") == "required":
        raise RuntimeError("bubblewrap is required, and does not work here")
    pytest.skip("bubblewrap does not work here", allow_module_level=True)

if not processes_are_limited():  # then it would take down the machine, and grading says that it is uncounted
    ALONE.pop("a fork bomb")

READY = """\
import signal
import numpy as np

patched = []

def patch(thing, name, value):
    missing = object()
    before = vars(thing).get(name, missing)
    setattr(thing, name, value)
    patched.append(lambda: delattr(thing, name) if before is missing else setattr(thing, name, before))

def patch_signal(number, value):
    before = signal.signal(number, value)
    patched.append(lambda: signal.signal(number, before))
"""
UNDO = "while patched:\n    patched.pop()()"
PATIENCE = 8  # s for a cell: so long each of those waits that breaks its kernel
PART_SECONDS = 0.5  # of processor time: a right answer needs some hundredths
IN_ONE = 18  # attacks in one notebook
SECRET = "this is PRIVATE"


WRITES = """\
import os
for folder, _, _ in os.walk("/"):
    try:
        with open(os.path.join(folder, "new"), "x"):
            print(folder)
    except OSError:
        pass
"""


def test_behind_the_walls_only_folders_with_a_limit_can_be_written(tmp_path):
    own = [tmp_path / name for name in OWN_FOLDERS]
    for folder in own:
        folder.mkdir()
    done = subprocess.run([*walls(tmp_path, PACKAGE), sys.executable, "-c", WRITES], capture_output=True, text=True)
    small = [Path(name) for name in ("/tmp", "/dev/shm")]  # in memory, with a limit of their own
    others = [folder for folder in map(Path, done.stdout.splitlines()) if folder not in own]
    assert set(own) <= {*map(Path, done.stdout.splitlines())}
    assert [folder for folder in others if not any(folder.is_relative_to(place) for place in small)] == []


def batches():
    """Return notebook -> task -> the name of its attack; ``None`` for an honest task, the last in each."""
    names = list(ATTACKS)
    groups = {f"batch{k // IN_ONE}": names[k : k + IN_ONE] for k in range(0, len(names), IN_ONE)}
    groups |= {f"alone{k}": [name] for k, name in enumerate(ALONE)}
    groups["forged"] = [f"forgery {k}" for k in range(FORGERIES)]
    return {
        book: {f"{book}_{k}": name for k, name in enumerate(group)} | {f"{book}_honest": None}
        for book, group in groups.items()
    }


BATCHES = batches()


def attacking(notebook, tasks, known):
    """Return a released notebook with the attacks in it."""
    own = {"cell_type": "code", "execution_count": None, "metadata": {}, "outputs": []}
    cells = [{**own, "source": READY, "id": "ready-too"}]
    for each in notebook["cells"]:
        name = each["metadata"].get("nbgrader", {}).get("grade_id", "")
        cells.append(each)
        if name in tasks:
            attack = tasks[name]
            text = RIGHT if attack is None else {**ATTACKS, **ALONE}.get(attack, "")
            text = text.replace("{f}", name)
            if f"def {name}" not in text and f"class {name}" not in text and f"{name} = " not in text:
                each["source"] = WRONG.replace("{f}", name)
                if text.startswith(("%", "!")) or attack in ALONE:  # a cell of its own
                    cells.insert(-1, {**own, "source": text, "id": f"attack-{len(cells)}"})
                else:
                    each["source"] += f"\n\n{text}"
            else:
                each["source"] = text
        if name.endswith("-hidden"):
            cells.append({**own, "source": UNDO, "id": f"undo-{len(cells)}"})
    notebook["cells"] = cells
    for each in cells:
        for word, value in known.items():
            each["source"] = "".join(each["source"]).replace(f"{{{word}}}", str(value))
    if "forgery 0" in tasks.values():
        forgeries(notebook, list(tasks)[:FORGERIES])
    return notebook


@pytest.fixture(scope="module")
def graded(tmp_path_factory):
    """A course in which Ada is honest and Mallory is not; and what was seen while Mallory was graded."""
    root = tmp_path_factory.mktemp("attacks")
    private = root / "private.txt"
    private.write_text(SECRET)
    made = assignments(root / "assignments", halves=BATCHES, honest={"honest": ["half"]})
    (made / "source" / "halves" / "given.txt").write_text("given")
    (made / "source" / "halves" / "sub").mkdir()
    (made / "source" / "halves" / "sub" / "halves.py").write_text("task = None  # owned")
    course = new_course(root / "course", made)
    config = course.root / "nbgrader_config.py"
    settings = re.sub(r"timeout = \d+", f"timeout = {PATIENCE}", config.read_text())
    config.write_text(settings.replace("c.CarefulExecute.seconds = 5", f"c.CarefulExecute.seconds = {PART_SECONDS}"))
    (course.root / "students.csv").write_text("id,first_name,last_name,email\nada,,,\nmallory,,,\n")
    for name in ("halves", "honest"):
        teach(course.root, "release", name)
    with socket.create_server(("127.0.0.1", 0)) as listener:
        calls = []

        def count_calls():
            with suppress(OSError):
                while True:
                    calls.append(listener.accept())

        threading.Thread(target=count_calls, daemon=True).start()
        known = {"course": course.root, "private": private, "port": listener.getsockname()[1]}
        for student, name in (("ada", "honest"), ("mallory", "halves")):
            shutil.copytree(course.root / "release" / name, course.root / "submitted" / student / name)
        honest = course.root / "submitted" / "ada" / "honest" / "honest.ipynb"
        nbformat.write(nbformat.from_dict(attacking(read(honest), {"half": None}, known)), honest)
        teach(course.root, "grade", "honest")
        for book, tasks in BATCHES.items():
            path = course.root / "submitted" / "mallory" / "halves" / f"{book}.ipynb"
            path.write_text(nbformat.writes(nbformat.from_dict(attacking(read(path), tasks, known))))
        kept = [course.root / name for name in ("grader", "source", "submitted", "release", "autograded/ada")]
        before, before_files = tree_hash(*kept), sorted(path.name for path in course.root.iterdir())
        with pytest.MonkeyPatch.context() as patch:
            patch.setenv("LEAKED", "secret of the shell")
            began = time.monotonic()
            said = teach(course.root, "grade", "halves")
            took = time.monotonic() - began
        time.sleep(5)  # what outlives the grading would have written by then
        same = tree_hash(*kept) == before
        files = sorted(path.name for path in course.root.iterdir())
    told = table_of(course)
    return {
        "course": course, "said": said, "took": took, "calls": calls, "same": same,
        "files": (before_files, files), "private": private.read_text(), "points": told,
    }  # fmt: skip


def table_of(course):
    """Return (student, cell) -> points."""
    from nbgrader.api import Gradebook

    with Gradebook(f"sqlite:///{course.root / 'gradebook.db'}") as book:
        return {
            (submission.student.id, grade.cell.name): (grade.score, grade.manual_score)
            for name in ("halves", "honest")
            for submission in book.assignment_submissions(name)
            for notebook in submission.notebooks
            for grade in notebook.grades
        }


def noted(graded):
    """Return cell -> names of the faults that were told."""
    path = graded["course"].root / "reports" / "halves" / "graded.json"
    told = {}
    for fault in read(path)["mallory"]["faults"]:
        told.setdefault(fault["cell"], []).append(fault["name"])
    return told


EVERY = [pytest.param(task, name, id=name) for tasks in BATCHES.values() for task, name in tasks.items() if name]
TASK_OF = {name: task for tasks in BATCHES.values() for task, name in tasks.items()}


@pytest.mark.parametrize(("task", "attack"), EVERY)
def test_an_attack_gains_nothing(graded, task, attack):
    for kind in ("visible", "hidden"):
        assert graded["points"]["mallory", f"{task}-{kind}"] == (0.0, None), attack


@pytest.mark.parametrize("book", BATCHES)
def test_the_honest_task_beside_them_has_its_points(graded, book):
    """So the attacks before it met a sound kernel."""
    assert graded["points"]["mallory", f"{book}_honest-visible"][0] == 1.0
    assert graded["points"]["mallory", f"{book}_honest-hidden"][0] == 3.0


def test_nobody_else_is_harmed(graded):
    assert graded["points"]["ada", "half-visible"] == (1.0, None)
    assert graded["points"]["ada", "half-hidden"] == (3.0, None)
    assert graded["same"]
    before, after = graded["files"]
    assert set(after) - set(before) <= {"gradebook.db", "feedback", "autograded", "reports"}
    assert set(before) <= set(after)
    assert graded["private"] == SECRET
    assert graded["calls"] == []
    assert "submitted/ is as it was" in graded["said"]
    assert "unprotected" not in graded["said"]


@pytest.mark.usefixtures("graded")
def test_nothing_that_was_started_lives_on():
    for process in psutil.process_iter(["cmdline", "cwd"]):
        words = " ".join(process.info["cmdline"] or ()) + str(process.info["cwd"] or "")
        assert "echo owned" not in words


def test_no_secret_stands_in_the_outputs(graded):
    course = graded["course"]
    pages = [
        *course.root.glob("autograded/mallory/halves/*.ipynb"),
        *course.root.glob("feedback/mallory/halves/*.html"),
    ]
    assert len(pages) == 2 * len(BATCHES)
    for page in pages:
        notebook = page.read_text("utf-8")
        outputs = read(page)["cells"] if page.suffix == ".ipynb" else []
        said = str([each.get("outputs") for each in outputs]) if outputs else ""
        for word in (course.salt(), "lambda x: x / 2", "secret of the shell", SECRET):
            assert word not in said
        assert course.salt() not in notebook
        assert "seen: PRIVATE" not in said
        printed = [text for each in outputs for out in each.get("outputs", ()) for text in out.get("text", ())]
        assert "owned" not in "".join(printed).split()
        assert not re.search(r"case [\d.]+", said)


TRACES = {
    "a frame that says right": "OddAnswer",
    "a frame that is no frame": "KernelDied",
    "a frame of 4 GB": "KernelDied",
    "strangers who call the judge": "OddAnswer",
    "the end of Python": "KernelDied",
    "a link to the grader": "FilesChanged",
    "a folder that leads to the grader": "FilesChanged",
    "a pipe for a file": "FilesChanged",
    "the end of the kernel": "KernelDied",
    "a fork bomb": "MemoryError|CellTimeoutError",
    "a full disc": "MemoryError",
}


@pytest.mark.parametrize("attack", [attack for attack in TRACES if attack in TASK_OF])
def test_what_leaves_a_trace_is_told(graded, attack):
    task = TASK_OF[attack]
    told, names = noted(graded), []
    path = graded["course"].root / "reports" / "halves" / "graded.json"
    says = str(read(path)["mallory"]["faults"])
    cells = {cell: kinds for cell, kinds in told.items() if cell.startswith(task)}
    names = [name for kinds in cells.values() for name in kinds]
    own_cell = [name for cell, kinds in told.items() if cell.startswith("cell ") for name in kinds]
    assert re.search(TRACES[attack], " ".join([*names, *own_cell])), says


def test_the_report_names_what_was_forged(graded):
    teach(graded["course"].root, "report", "halves")
    rows = table(graded["course"].root / "reports" / "halves" / "faults.csv")
    assert {"OddAnswer", "KernelDied", "FilesChanged"} <= {row["name"] for row in rows}
