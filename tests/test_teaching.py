"""Teaching: from an empty folder to grades and feedback by the command line alone, through nbgrader itself."""

import csv
import io
import json
import os
import re
import shutil
import subprocess
import sys
import time
import warnings
from contextlib import chdir, redirect_stderr, redirect_stdout
from importlib import metadata
from pathlib import Path

import nbformat
import psutil
import pytest

from primkit.__main__ import main
from primkit.course.checking import check
from primkit.course.course import ASSIGNMENTS, Course, new_course
from primkit.course.grade import _alone, _grade_one
from primkit.course.graded import Graded, Journal
from primkit.course.grading import MIME
from primkit.course.handed_in import Fault, file_faults, misplaced, tree_hash
from primkit.course.printing import BROWSERS, WHOLE_LINES, page, print_set
from primkit.course.running import OUT_OF_TIME, nbgrader
from tests.submissions import ProblemSet, about, answers_of, read
from tests.test_assignments import points_left

ROOT = Path(__file__).resolve().parent.parent
PS, NUMBER = "ps1", 1


def teach(folder, *words, code=0):
    """Run ``primkit teach`` in a folder; return what it prints."""
    said = io.StringIO()
    with chdir(folder), redirect_stdout(said), redirect_stderr(said), warnings.catch_warnings():
        warnings.simplefilter("ignore")  # nbgrader's own
        assert main(["teach", *map(str, words)]) == code, said.getvalue()
    return said.getvalue()


def in_a_new_process(folder, *words):
    """Do the same as a teacher does it, in a terminal."""
    command = [sys.executable, "-m", "primkit", "teach", *words]
    done = subprocess.run(
        command, cwd=folder, capture_output=True, text=True, encoding="utf-8", check=True, timeout=600
    )
    return done.stdout


def table(path):
    with open(path, encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def edited(notebook):
    """What happens in JupyterLab: cells are pasted, an answer is split, and cells that cannot be edited are deleted."""
    cells = {about(cell).get("grade_id"): cell for cell in notebook["cells"]}
    pasted = cells["ray_arc-text"], cells["ray_arc-visible"], cells["busy_cells"]
    lost = cells["ps1-setup"], cells["sonar_reading-visible"], cells["busy_cells-hidden"]
    kept = [{key: cell[key] for key in cell if key != "id"} for cell in notebook["cells"] if cell not in lost]
    place = kept.index({key: cells["busy_cells"][key] for key in cells["busy_cells"] if key != "id"})
    foreign = {**pasted[0], "metadata": {"nbgrader": {**about(pasted[0]), "grade_id": "ps9-text"}}}
    kept[place:place] = [{key: cell[key] for key in cell if key != "id"} for cell in (*pasted, foreign)]
    return {**notebook, "cells": kept, "nbformat_minor": 4}


# --- the round trip -----------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def graded(tmp_path_factory):
    """A course after grading and reporting; and what each command said.

    Three submissions (one right, and edited as in Lab), two files that are no notebooks, one that came too late, and a
    student of whom there is nothing.
    """
    folder = tmp_path_factory.mktemp("teacher")
    said = {"new-course": in_a_new_process(folder, "new-course", "course")}
    course = folder / "course"
    listed = ("edited,Ada,,", *(f"{name},,," for name in ("0123", "mixed", "torn", "lazy", "late")))
    (course / "students.csv").write_text("\n".join(["id,first_name,last_name,email", *listed]) + "\n")
    said["check"] = teach(course, "check")
    said["release"] = teach(course, "release", PS)
    problem_set = ProblemSet(course, PS)
    problem_set.hand_in("0123", problem_set.released)  # untouched, and a name that is a number
    mixture, points = {}, 0
    for task, kinds in answers_of(NUMBER).items():
        left = {name: points_left(task, loses) for name, (_, loses, _) in kinds["wrong"].items()}
        name = next(name for name, kept in left.items() if 0 < kept < problem_set.of[task])
        mixture[task] = problem_set.listed(task, "wrong", name)
        points += left[name]
    problem_set.hand_in("mixed", problem_set.with_answers(mixture), listed=NUMBER)
    for name in ("broken", "torn"):
        problem_set.hand_in(name, '{"cells": [')
    problem_set.hand_in("edited", edited(problem_set.reference()))
    before = tree_hash(course / "submitted")
    said["grade"] = teach(course, "grade", PS)
    assert tree_hash(course / "submitted") == before
    problem_set.hand_in("late", "{}")
    said["report"] = teach(course, "report", PS)
    return course, problem_set, said, {"edited": problem_set.points, "0123": 0, "mixed": points}


def test_full_marks_none_and_exactly_the_expected_ones(graded):
    course, _, _, expected = graded
    rows = table(course / "reports" / PS / "class.csv")
    assert {row["id"]: float(row["ps1 (of 15.0)"]) for row in rows if row[PS] == "graded"} == expected
    others = {row["id"]: row[PS] for row in rows if row["id"] not in expected}
    assert others == {"torn": "could not be graded", "lazy": "nothing handed in", "late": "not yet graded"}
    exported = table(course / "reports" / PS / "grades.csv")  # nbgrader's own export
    assert {row["student_id"]: float(row["score"]) for row in exported} == expected | dict.fromkeys(others, 0.0)


def test_who_is_not_in_the_list_and_what_could_not_be_graded_is_told_apart(graded):
    course, _, said, _ = graded
    told = "broken  -  not in the list: is not in students.csv: a typing error?"
    assert told in said["grade"]
    assert told in said["report"]
    assert "submitted/broken/ps1" in faults(Course(course))
    page = (course / "feedback" / "broken" / PS / f"{PS}.html").read_text("utf-8")
    assert "could not be graded. ps1.ipynb is not JSON: " in page
    assert "not in the list" not in "".join(said.values()).replace(told, "")


def test_what_the_commands_say(graded):
    course, _, said, _ = graded
    assert re.search(r"problem sets .*\bps1, ps2", said["new-course"])
    assert said["check"].splitlines()[-1] == "All is there."
    assert said["release"].endswith(f"release/{PS} is ready: no solution was found in it\n")
    assert "broken: ps1.ipynb: is not JSON" in said["grade"]
    assert "5 submissions in" in said["grade"]
    assert "3 graded, 2 not graded" in said["grade"]
    assert "submitted/ is as it was" in said["grade"]
    assert "6 handed in, 3 graded" in said["report"]
    assert str(course / "reports" / PS) in said["report"]


def test_what_was_graded_is_not_graded_again_until_it_changes(graded):
    course, _, _, _ = graded
    again = course.parent / "again"  # the other tests want this course as it is
    shutil.copytree(course, again)
    said = teach(again, "grade", PS, "--student", "mixed")
    assert "mixed: graded before, and not changed since" in said
    assert "1 submissions" not in said
    shutil.rmtree(again / "submitted" / "mixed")
    ProblemSet(again, PS).hand_in("mixed", "{}")
    said = teach(again, "grade", PS, "--student", "mixed")
    assert "mixed: ps1.ipynb: is JSON, but has no list of cells" in said


def test_the_overview_counts_each_wrong_answer(graded):
    course, _, _, _ = graded
    wrong = table(course / "reports" / PS / "wrong.csv")
    mixed = {row["name"] for row in wrong if row["student"] == "mixed"}
    assert mixed
    assert not mixed & {"not attempted", "wrong in another way"}  # each has its own name
    assert {row["name"] for row in wrong if row["student"] == "0123"} == {"not attempted"}
    assert not [row for row in wrong if row["student"] == "edited"]
    lines = table(course / "reports" / PS / "overview.csv")
    parts = [line for line in lines if line["part"]]
    assert len(parts) == 12
    assert {line["students"] for line in lines} == {"3"}
    for line in parts:
        mine = [row for row in wrong if row["part"] == line["part"] and row["task"] == line["task"]]
        assert float(line["share_right"]) == pytest.approx(1 - len(mine) / 3, abs=1e-3)
        counts = {line[f"wrong_{k}"]: int(line[f"count_{k}"]) for k in (1, 2, 3) if line[f"wrong_{k}"]}
        assert sum(counts.values()) == len(mine)
        assert counts["not attempted"] == 1
    assert (course / "reports" / PS / "overview.png").read_bytes().startswith(b"\x89PNG")


def test_a_fault_has_its_line(graded):
    course, _, _, _ = graded
    rows = table(course / "reports" / PS / "faults.csv")
    lost = ("ps1-setup", "sonar_reading-visible", "busy_cells-hidden")
    assert [(row["student"], row["cell"], row["name"]) for row in rows] == [
        ("broken", "-", "not in the list"),
        ("broken", "ps1.ipynb", "not a notebook"),
        *(("edited", cell, "cell missing") for cell in lost),
        ("torn", "ps1.ipynb", "not a notebook"),
    ]
    html = (course / "feedback" / "edited" / PS / f"{PS}.html").read_text("utf-8")
    for cell in lost:
        assert re.search(f"{cell}</code> <em>was missing in what was handed in: it was put back", html)


def test_the_feedback_holds_the_marks_and_what_is_off(graded):
    course, problem_set, _, _ = graded
    html = {name: (course / "feedback" / name / PS / f"{PS}.html").read_text("utf-8") for name in ("edited", "mixed")}
    for task in problem_set.solutions:
        assert f"{task}: 4 of 4 points" in html["edited"]
        assert f'<a href="#{task}-visible">{task}-visible</a> (Score: 1.0 / 1.0)' in html["edited"]
        assert re.search(rf"{task}: \d of 4 points", html["mixed"])
    assert "<i>wrong</i>: in " in html["mixed"]
    assert ">grader</span>" in html["mixed"]  # which tests ran is seen, not what is in them
    assert "def hit_arc" not in html["mixed"]


def test_a_course_that_was_made_before_takes_edited_cells_too(graded):
    course, _, _, _ = graded
    older = course.parent / "older"
    shutil.copytree(course, older)
    config = (older / "nbgrader_config.py").read_text("utf-8")
    ours = re.compile(r"^c\.(Autograde\.sanitize|WholeNotebook|GenerateFeedback|AssignLate).* = .*\n", re.MULTILINE)
    (older / "nbgrader_config.py").write_text(ours.sub("", config))
    done = _grade_one(Course(older), PS, "edited", Journal(Course(older), PS), again=True)
    assert done.verdict == "graded", done.line
    assert "ps1-setup: was missing" in done.line


def test_a_released_notebook_is_a_student_s(graded):
    course, problem_set, _, _ = graded
    text = json.dumps(problem_set.released)
    assert text.count("raise NotImplementedError") == len(problem_set.solutions)
    assert "from grader" not in text
    assert not (course / "release" / PS / "grader").exists()


def test_nbgrader_s_own_command_grades_with_our_limits(graded):
    """The course folder is nbgrader's: whoever grades from formgrader gets the careful way as well."""
    course, _, _, _ = graded
    notebook = read(course / "autograded" / "mixed" / PS / f"{PS}.ipynb")
    assert notebook["metadata"]["primkit"]["faults"] == []
    marks = [
        output["data"][MIME]
        for cell in notebook["cells"]
        for output in cell.get("outputs", ())
        if MIME in output.get("data", {})
    ]
    assert len(marks) == 3


# --- running what is handed in ------------------------------------------------------------------------------

TROUBLE = {
    "first": "import time\nimport numpy as np\nx = 1\nopen('made.txt', 'w').close()",
    "loop": "y = 2\nwhile True:\n    time.sleep(0.01)",
    "after": "x += 1\nprint(x, y)",
    "deletes": "import os, shutil\nshutil.rmtree(os.getcwd(), ignore_errors=True)",
    "reads": "print(open('given.txt').read())",
    "deaf": "while True:\n    try:\n        while True:\n            time.sleep(0.01)\n    except:\n        pass",
    "dies": "import os\nos._exit(3)",
    "hog": "hog = []\nwhile True:\n    hog.append(np.empty(10**8))",
    "leaves": "exit()",
    "broken": "def (",
    "warns": "import warnings\nwarnings.warn('careful')",
    "last": "x += 1\nprint(x, len(np.empty(2**30, np.uint8)))",
}
PATIENCE = 10  # s for a cell: so long those wait that never end, and no other needs a tenth of it


@pytest.mark.skipif(os.name != "posix", reason="the memory limit is told about a second late on Windows")
def test_whatever_a_cell_does_costs_itself_alone(tmp_path):
    from primkit.course.executing import CarefulExecute

    folder = tmp_path / "handed in"
    folder.mkdir()
    (folder / "given.txt").write_text("given")
    notebook = nbformat.v4.new_notebook(
        cells=[
            nbformat.v4.new_code_cell(source, metadata={"nbgrader": {"grade_id": name}})
            for name, source in TROUBLE.items()
        ]
    )
    execute = CarefulExecute(course=str(tmp_path), timeout=PATIENCE, megabytes=2000, iopub_timeout=1)
    resources = {"metadata": {"path": str(folder)}, "nbgrader": {"student": "ada"}}
    notebook, _ = execute.preprocess(notebook, resources)

    outputs = dict(zip(TROUBLE, (cell.outputs for cell in notebook.cells), strict=True))
    says = {name: "".join(out.get("text", "") for out in outs).strip() for name, outs in outputs.items()}
    errors = {name: [out.ename for out in outs if out.output_type == "error"] for name, outs in outputs.items()}
    assert says["after"] == "2 2"
    assert says["reads"] == "given"
    assert says["last"] == "3 1073741824"  # after four kernels, with all of the memory
    assert errors["loop"][-1] == "CellTimeoutError"
    assert errors["deaf"] == ["CellTimeoutError"]
    assert errors["dies"] == ["KernelDied"]
    assert errors["hog"] == ["MemoryError"]
    assert errors["leaves"] == ["SystemExit"]
    assert errors["broken"] == ["SyntaxError"]
    assert outputs["warns"] == []
    assert [name for name in ("first", "after", "deletes", "reads", "last") if errors[name]] == []
    noted = [(fault["cell"], fault["name"]) for fault in notebook.metadata.primkit.faults]
    assert noted == [
        ("loop", "CellTimeoutError"),
        ("deletes", "FilesChanged"),
        ("deaf", "CellTimeoutError"),
        ("dies", "KernelDied"),
        ("hog", "MemoryError"),
        ("leaves", "SystemExit"),
        ("broken", "SyntaxError"),
    ]
    assert sorted(path.name for path in folder.iterdir()) == ["given.txt"]  # the submission's own folder


def run(folder, sources, **settings):
    """Run cells as a submission; return their outputs, and what was noted."""
    from primkit.course.executing import CarefulExecute

    folder.mkdir()
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(source) for source in sources])
    execute = CarefulExecute(course=str(folder.parent), **settings)
    resources = {"metadata": {"path": str(folder)}, "nbgrader": {"student": "ada"}}
    notebook, _ = execute.preprocess(notebook, resources)
    noted = [(fault["cell"], fault["name"]) for fault in notebook.metadata.primkit.faults]
    return [cell.outputs for cell in notebook.cells], noted


def printed(outputs):
    """Return what a cell printed; a line and its end may come as two outputs."""
    return "".join(output.text for output in outputs)


def test_a_cell_that_ends_the_kernel_only_when_it_runs_again(tmp_path):
    once = (
        "import os\nfrom pathlib import Path\nseen = Path.home() / 'seen'\nseen.exists() and os._exit(1)\nseen.touch()"
    )
    outputs, noted = run(tmp_path / "x", ["x = 1", once, "import os\nos._exit(2)", "print(x)"])
    assert noted == [("cell 3", "KernelDied"), ("cell 2", "KernelDied")]
    assert printed(outputs[3]) == "1\n"


def test_memory_is_watched_where_the_system_does_not_refuse_it(tmp_path, monkeypatch):
    monkeypatch.setattr("primkit.course.own_kernel.PREPARE", "pass  # {limits}")
    hog = "import time\nhog = b'1' * (400 * 2**20)\ntime.sleep(20)"
    outputs, noted = run(tmp_path / "x", [hog, "print('on')"], megabytes=300)
    assert noted == [("cell 1", "MemoryError")]
    assert outputs[0][-1].evalue == "this cell took more than 300 MB of memory, and its kernel was ended"
    assert printed(outputs[1]) == "on\n"


def test_memory_that_a_stopped_cell_holds_is_given_back(tmp_path):
    hog = "import time\nhog = b'1' * (1200 * 2**20)\ntime.sleep(99)"
    cells = ["import mmap\nx = 1", hog, "print(x, len(mmap.mmap(-1, 1200 * 2**20)))"]
    outputs, noted = run(tmp_path / "x", cells, megabytes=2200, timeout=PATIENCE)
    assert noted == [("cell 2", "CellTimeoutError")]
    assert printed(outputs[2]) == "1 1258291200\n"


def gone(words):
    """Tell whether a process ends soon; its number in the submission's own world says nothing here."""
    for _ in range(10 * PATIENCE):
        lines = [process.info["cmdline"] or () for process in psutil.process_iter(["cmdline"])]
        if not any(words in word for line in lines for word in line):
            return True
        time.sleep(0.1)
    return False


@pytest.mark.skipif(os.name != "posix", reason="processes have no groups on Windows")
def test_what_a_cell_has_started_ends_with_it(tmp_path):
    start = "import subprocess, sys\nsubprocess.Popen([sys.executable, '-c', 'import time; time.sleep(98.75)'])"
    outputs, _ = run(tmp_path / "x", [start, "import os\nos._exit(1)", "print('on')"])
    assert gone("time.sleep(98.75)")
    assert printed(outputs[2]) == "on\n"


def test_what_a_cell_prints_is_cut(tmp_path):
    outputs, noted = run(tmp_path / "x", ["for _ in range(500):\n    print('a' * 10_000, flush=True)", "print('on')"])
    assert sum(len(output.text) for output in outputs[0]) < 500_000
    assert printed(outputs[1]) == "on\n"
    assert noted == []


# --- a course, and what it lacks ----------------------------------------------------------------------------


@pytest.fixture
def course(tmp_path):
    return new_course(tmp_path / "course", ASSIGNMENTS)


def faults(course, **more):
    return {finding.what: finding for finding in check(course, **more) if not finding.fine}


def test_a_new_course_has_its_own_secret(course, tmp_path):
    assert len(course.salt()) == 32
    assert course.salt() != new_course(tmp_path / "another", ASSIGNMENTS).salt()
    if os.name == "posix":
        assert (course.root / "salt.txt").stat().st_mode & 0o077 == 0
    assert "salt.txt" in (course.root / ".gitignore").read_text().splitlines()


def test_nothing_is_written_over_a_course(course):
    with pytest.raises(ValueError, match="must be a new folder or an empty one: nothing is ever written over a course"):
        new_course(course.root, ASSIGNMENTS)


def test_without_the_project_s_folder_one_sentence_says_where_to_get_it(tmp_path, capsys):
    (tmp_path / "installed").mkdir()
    words = ["teach", "new-course", str(tmp_path / "course"), "--assignments", str(tmp_path / "installed")]
    assert main(words) == 2
    told = capsys.readouterr().err
    assert "there are no assignments in" in told
    assert "say --assignments teachers.zip" in told
    assert not (tmp_path / "course").exists()


NO_ARCHIVES = {
    "forgotten.zip": "forgotten.zip: there is no such archive or folder",
    "map.png": "map.png must be a folder or an archive, such as a .zip, got neither",
    "broken.zip": "broken.zip must be a folder or an archive, such as a .zip, got neither",
}


@pytest.mark.parametrize(("name", "sentence"), NO_ARCHIVES.items(), ids=NO_ARCHIVES)
def test_what_is_no_archive_is_refused_in_one_sentence(name, sentence, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    for there in ("map.png", "broken.zip"):
        (tmp_path / there).write_bytes(b"no archive")
    assert main(["teach", "new-course", "course", "--assignments", name]) == 2
    assert capsys.readouterr().err == f"primkit: {sentence}\n"


def test_all_is_there_in_a_new_course(course):
    assert faults(course) == {}


def with_points(root, mark, points):
    """Give a cell of the source other points, as with JupyterLab's Create Assignment."""
    path = root / "source" / PS / f"{PS}.ipynb"
    notebook = read(path)
    next(about(cell) for cell in notebook["cells"] if about(cell).get("grade_id") == mark)["points"] = points
    path.write_text(json.dumps(notebook), "utf-8")


BREAK = {
    "salt.txt": (lambda root: (root / "salt.txt").unlink(), "salt.txt", "a new salt makes new maps"),
    "a short salt": (lambda root: (root / "salt.txt").write_text("short"), "salt.txt", "."),
    "open salt": (lambda root: (root / "salt.txt").chmod(0o644), "salt.txt", "chmod 600"),
    "grader": (lambda root: shutil.rmtree(root / "grader"), "grader/", "copy notebooks/assignments/grader"),
    "source": (lambda root: shutil.rmtree(root / "source"), "source/", "copy notebooks/assignments/source"),
    "config": (lambda root: (root / "nbgrader_config.py").unlink(), "course folder", "new-course"),
    "limits": (lambda root: (root / "nbgrader_config.py").write_text(""), "nbgrader_config.py", "CarefulExecute"),
    "students": (lambda root: (root / "students.csv").write_text("name\nada\n"), "students.csv", "the line id,"),
    "points": (
        lambda root: with_points(root, "sonar_reading-hidden", 6),
        "source/ps1, sonar_reading-hidden",
        "give 4.0",
    ),
    "settings": (
        lambda root: (root / "course.toml").write_text("[due]\nps1 = 3\n"),
        "course.toml",
        "at a day and a time",
    ),
    "no such set": (
        lambda root: (root / "course.toml").write_text("[due]\nps7 = 2026-03-01T10:00:00"),
        "course.toml",
        "ps7",
    ),
    "Polish": (lambda root: (root / "students.csv").write_bytes(b"id\n\xb3\n"), "students.csv", "CSV UTF-8"),
    "an id": (lambda root: (root / "students.csv").write_text("id\n\nb\na/b\n"), "students.csv", "in line 4"),
    "twice": (lambda root: (root / "students.csv").write_text("id\nada\nada\n"), "students.csv", "once"),
    "gradebook": (lambda root: (root / "gradebook.db").write_text("no base"), "gradebook.db", "put a copy"),
}


@pytest.mark.parametrize(("damage", "what", "mend"), BREAK.values(), ids=BREAK)
def test_check_names_a_fault_and_how_it_is_mended(course, damage, what, mend):
    if what == "salt.txt" and os.name != "posix" and mend == "chmod 600":
        pytest.skip("Windows has other rights")
    damage(course.root)
    found = faults(course)
    assert what in found
    assert re.search(re.escape(mend), found[what].mend + found[what].found), found


def test_check_compares_versions(course, tmp_path):
    pins = tmp_path / "environment.txt"
    pins.write_text("nbgrader==0.0.1  # old\nno-such-package==1.0\n-e .\n")
    found = faults(course, environment=pins)
    assert found["nbgrader"].found.endswith(", needs 0.0.1")
    assert found["no-such-package"].found == "missing, needs 1.0"
    assert f"-m pip install -r {pins}" in found["nbgrader"].mend


def test_t24_no_remedy_names_a_package_that_is_somebody_else_s(course, tmp_path, monkeypatch):
    def absent(name):
        raise metadata.PackageNotFoundError(name)

    monkeypatch.setattr(metadata, "version", absent)
    found = faults(course, environment=tmp_path / "none.txt")
    assert {"nbgrader", "jupyterlab", "psutil"} <= {*found}
    for finding in found.values():
        assert not re.search(r"install .*\bprimkit\b", finding.mend), finding
    assert found["nbgrader"].mend.endswith("-m pip install nbgrader jupyterlab ipykernel nbconvert psutil")


def test_check_ends_with_1_where_something_is_wrong(course, capsys):
    (course.root / "salt.txt").unlink()
    assert main(["teach", "check", "--course", str(course.root)]) == 1
    out = capsys.readouterr().out
    assert "FAULT  salt.txt: salt.txt is missing" in out
    assert out.endswith("1 fault found\n")


SENTENCES = {
    "no such set": (["release", "ps11"], "there is no problem set 'ps11'; there are 09_your_own_map, ps1, ps2,"),
    "nothing to compare": (["similar", "ps1"], "ps1 was handed in by no students: there must be two to compare"),
    "not handed in": (["grade", "ps1"], "nothing was handed in: run `primkit teach collect ps1 DOWNLOAD`"),
    "not graded": (["report", "ps1"], "nothing of ps1 has been graded yet: run `primkit teach grade ps1` first"),
    "nothing to look at": (["leaks", "nowhere.whl"], "there is no nowhere.whl to look for leaks in"),
}


@pytest.mark.parametrize(("words", "sentence"), SENTENCES.values(), ids=SENTENCES)
def test_what_cannot_be_done_is_said_in_one_sentence(course, words, sentence, capsys):
    assert main(["teach", *words, "--course", str(course.root)]) == 2
    err = capsys.readouterr().err
    assert sentence in err
    assert len(err.splitlines()) == 1


def test_a_course_is_made_from_the_teachers_archive(tmp_path):
    held = tmp_path / "teachers" / "notebooks" / "assignments"
    (held / "source" / "ps1").mkdir(parents=True)
    (held / "source" / "ps1" / "ps1.ipynb").write_text("{}")
    (held / "grader").mkdir()
    archive = shutil.make_archive(str(tmp_path / "teachers"), "zip", tmp_path / "teachers")
    course = new_course(tmp_path / "course", archive)
    assert course.sets() == ["ps1"]
    assert (course.root / "grader").is_dir()
    (held / "grader").rmdir()
    archive = shutil.make_archive(str(tmp_path / "without"), "zip", tmp_path / "teachers")
    with pytest.raises(ValueError, match=r"without\.zip must hold source/ and grader/, got neither"):
        new_course(tmp_path / "other", archive)
    with pytest.raises(ValueError, match=r"an installed package holds none.* `git archive .*` makes an archive"):
        new_course(tmp_path / "other", held)


def test_elsewhere_is_no_course(tmp_path, capsys):
    assert main(["teach", "release", "ps1", "--course", str(tmp_path)]) == 2
    assert "is no course folder: make one with `primkit teach new-course DIR`" in capsys.readouterr().err
    (one,) = faults(Course(tmp_path))  # and no word of copying solutions there
    assert one == "course folder"


def test_grading_comes_after_releasing(course, capsys):
    shutil.copytree(course.root / "source" / PS, course.root / "submitted" / "ada" / PS)
    assert main(["teach", "grade", PS, "--course", str(course.root)]) == 2
    assert f"{PS} was not released: run `primkit teach release {PS}` first" in capsys.readouterr().err


@pytest.mark.parametrize("place", ["ps1/ada/ps1.ipynb", "ada/ps1.ipynb", "ps1.ipynb"])
def test_a_notebook_that_nobody_would_grade_is_named(course, place, capsys):
    path = course.root / "submitted" / place
    path.parent.mkdir(parents=True)
    path.write_text("{}")
    assert main(["teach", "grade", PS, "--course", str(course.root)]) == 2
    sentence = "lies where nothing is graded: put it into submitted/<student>/<problem set>/"
    assert f"nothing was handed in: submitted/{place} {sentence}" in capsys.readouterr().err
    assert set(faults(course)) == {f"submitted/{place}"}
    (course.root / "submitted" / "ada" / PS).mkdir(parents=True, exist_ok=True)
    (course.root / "submitted" / "ada" / PS / "ps1.ipynb").write_text("{}")
    assert len(misplaced(course)) == 1


FILES = {
    "not JSON": ('{"cells": [', "is not JSON"),
    "no list of cells": ("{}", "has no list of cells"),
    "a list": ("[]", "has no list of cells"),
    "not text": (b"\xff\xfe\x00", "is not text"),
    "another notebook": ('{"cells": [{"metadata": {}}]}', "holds no cell of the problem set"),
    "absent": (None, "there is no ps1.ipynb, found other.ipynb"),
}


@pytest.mark.parametrize(("content", "sentence"), FILES.values(), ids=FILES)
def test_a_file_that_is_no_submission_gets_its_own_sentence(course, content, sentence):
    folder = course.root / "submitted" / "ada" / PS
    folder.mkdir(parents=True)
    name = "other.ipynb" if content is None else f"{PS}.ipynb"
    (folder / name).write_bytes(content if isinstance(content, bytes) else (content or "{}").encode())
    (fault,) = file_faults(course, PS, "ada")
    assert fault.student == "ada"
    assert sentence in fault.says


def test_a_command_of_nbgrader_s_that_fails_says_why(course):
    done = nbgrader(course, "generate_assignment", "no-such-set", log=course.root / "log.txt")
    assert done.code != 0
    assert "no-such-set" in done.reason
    assert (course.root / "log.txt").read_text().startswith("$ nbgrader generate_assignment no-such-set\n")
    stopped = nbgrader(course, "generate_assignment", PS, seconds=0.01)
    assert (stopped.code, stopped.reason) == (OUT_OF_TIME, "TimeoutError: nbgrader was stopped after 0.01 s")


def test_a_hash_sees_every_change(tmp_path):
    (tmp_path / "a").mkdir()
    seen = {tree_hash(tmp_path)}
    for change in (
        lambda: (tmp_path / "a" / "x").write_text("1"),
        lambda: (tmp_path / "a" / "x").write_text("2"),
        lambda: (tmp_path / "a" / "x").rename(tmp_path / "a" / "y"),
        lambda: (tmp_path / "a" / "y").unlink(),
        lambda: (tmp_path / "a").rmdir(),
    ):
        change()
        seen.add(tree_hash(tmp_path))
    assert len(seen) == 5  # without the file it is as before
    (tmp_path / "__pycache__").mkdir()
    assert tree_hash(tmp_path) in seen


JOURNALS = {
    "cut": '{"ada": {"hash": "x", "gra',
    "a number": "5",
    "an entry that is none": '{"ada": 5}',
    "faults that are none": '{"ada": {"hash": "", "graded": true, "faults": [5]}}',
}


@pytest.mark.parametrize("text", JOURNALS.values(), ids=JOURNALS)
def test_a_journal_that_is_none_is_refused_by_its_name(course, text):
    (course.reports(PS) / "graded.json").write_text(text)
    with pytest.raises(ValueError, match=r"^graded\.json: "):
        Journal(course, PS)


def test_a_handout_and_solutions_are_printed(course, monkeypatch):
    marks = {"nbgrader": {"grade_id": "figure", "locked": True, "grade": False, "solution": False, "schema_version": 3}}
    given = nbformat.v4.new_code_cell("draw()", metadata=marks)
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_markdown_cell("# A handout"), given])
    files = [course.root / place / "tiny" / "tiny.ipynb" for place in ("release", "source")]
    for file in files:
        file.parent.mkdir(parents=True)
        nbformat.write(notebook, file)
        given.outputs = [nbformat.v4.new_output("stream", text="what is drawn")]
    html = page(*files)
    assert "what is drawn" in html  # where the release has no outputs
    assert WHOLE_LINES in html  # in CSS of nbconvert's own, words of it stand, too
    if any(map(shutil.which, BROWSERS)):
        written = [path.read_bytes()[:5] for path in print_set(course, "tiny")]
        assert written == [b"%PDF-", b"%PDF-"]
        assert {path.name for path in (course.root / "paper").iterdir()} == {"tiny.pdf", "tiny_solutions.pdf"}
    (course.root / "release" / "tiny" / "tiny.ipynb").unlink()
    monkeypatch.setattr(shutil, "which", lambda name: {"msedge": sys.executable}.get(name))
    with pytest.raises(ValueError, match="tiny was not released: run `primkit teach release tiny` first"):
        list(print_set(course, "tiny"))
    monkeypatch.setattr(shutil, "which", lambda _name: None)
    with pytest.raises(ValueError, match="a PDF is printed by Chromium, Chrome or Edge, and none is here"):
        list(print_set(course, "tiny"))


def test_a_second_grader_waits_and_loses_nothing(course):
    done = Graded("ada", "graded", "", "x")
    with _alone(course, PS):
        with pytest.raises(ValueError, match="ps1 is being graded by another command: wait"), _alone(course, PS):
            pass
        Journal(course, PS).write(done)
    with _alone(course, PS):
        journal = Journal(course, PS)
        journal.write(Graded("bob", "not graded", "", "y", (Fault("bob", "-", "n", "s"),)))
    assert {*Journal(course, PS).entries} == {"ada", "bob"}
    assert journal.knows("ada", "x")
    assert not journal.knows("bob", "y")


def test_the_course_is_the_folder_that_is_given(tmp_path):
    assert Course(tmp_path / "x" / "..").root == tmp_path.resolve()
    assert about({"metadata": {}}) == {}
    assert ROOT / "notebooks" / "assignments" == ASSIGNMENTS
