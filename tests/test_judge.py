"""The judge: graded cells run outside, the student's functions from afar; only what they return counts."""

import json
import os
import re
import sys
import tempfile
import threading
import time
from contextlib import closing, contextmanager, suppress
from importlib import import_module
from pathlib import Path
from types import ModuleType

import nbformat
import numpy as np
import psutil
import pytest
from nbgrader.utils import determine_grade

import primkit as pk
from primkit.checks import Check, judges
from primkit.course import confining, executing, own_kernel
from primkit.course.checking import _points
from primkit.course.course import new_course
from primkit.course.executing import CarefulExecute
from primkit.course.grading import MIME, Part, Task, serving
from primkit.course.grading.judging import Judging, hidden_tests_of
from primkit.course.grading.plain_values import pack, unpack
from primkit.course.grading.task import missing
from primkit.course.grading.workers import Ended, OutOfTime, Workers
from primkit.own_code import call_within
from tests.answers.assignment_9 import ANSWERS
from tests.halves import assignments
from tests.submissions import ROOT, about, read

needs_fork = pytest.mark.skipif(not hasattr(os, "fork"), reason="there is no fork on Windows")

# --- what crosses -------------------------------------------------------------------------------------------------

POLYGON = pk.Polygon([(0, 0), (1, 0), (0, 1)])
CROSSES = [
    *(None, True, ..., 3, -(2**70), 0.1, float("inf"), "nut", "ü\n", (), [1, (2, None)], {3}, {"a": [1.5]}),
    *(pk.Circle((0.1, 0.2), 0.3), POLYGON, pk.Line(0.1, 0.2)),
]


@pytest.mark.parametrize("value", CROSSES, ids=repr)
def test_plain_values_come_back_as_they_were(value):
    back = unpack(pack(value))
    assert back == value
    assert type(back) is type(value)


@pytest.mark.parametrize(
    "array",
    [
        np.zeros((0, 2)),
        np.array(3.5),
        np.arange(6).reshape(2, 3),
        np.array([True]),
        np.array(["a", "bc"]),
        np.eye(2) * 1j,
    ],
    ids=str,
)
def test_arrays_come_back_to_the_last_bit(array):
    back = unpack(pack(array))
    assert back.dtype == array.dtype
    assert back.shape == array.shape
    assert (back == array).all()


def test_numbers_of_numpy_become_plain_ones():
    for value, kind in ((np.float64(2), float), (np.float32(0.5), float), (np.int8(3), int), (np.bool_(True), bool)):
        assert type(unpack(pack(value))) is kind
    assert unpack(pack(np.str_("coin"))) == "coin"
    assert unpack(pack(range(3))).tolist() == [0, 1, 2]


def test_scans_and_generators_go_over():
    scans = pk.scan(pk.random_world(2, rng=1), [(0.0, 0.0, 0.1)], rng=0)
    assert (unpack(pack(scans)).ranges == scans.ranges).all()
    rng = np.random.default_rng(7)
    assert unpack(pack(rng)).random() == rng.random()


HOSTILE = {
    "cut": b"[",
    "nested": b"[" * 100_000,
    "nested lists": b'["list",[' * 30 + b"1" + b"]]" * 30,
    "digits": b"1" * 500,
    "objects": b'["array",["O",[1],"AAAAAAAAAAA="]]',
    "too short": b'["array",["<f8",[9],"AAAAAAAAAAA="]]',
    "an axis without end": b'["array",["<f8",[0,99999999999],""]]',
    "no letters": b'["array",["<U1",[1],"/////w=="]]',
    "a noun that is none": b'["Circle",[["list",[0.0,0.0]],-1.0]]',
    "an unknown noun": b'["Popen",["ls"]]',
    "no content": b'["list"]',
    "a dictionary": b'{"a":1}',
    "many keys": b'["set",[' + b",".join(b"%d" % k for k in range(10_001)) + b"]]",
    "a key that cannot be one": b'["set",[["list",[]]]]',
}


@pytest.mark.parametrize("data", HOSTILE.values(), ids=HOSTILE)
def test_what_is_no_plain_value_is_refused(data):
    with pytest.raises(ValueError, match=r"^must be a plain value, got what is none: "):
        unpack(data)


def test_what_cannot_be_printed_is_a_question_mark():
    assert unpack(b'"a\\ud800\\u202eb"') == "a??b"


# --- a student's process ------------------------------------------------------------------------------------------


@contextmanager
def afar(seconds=5.0, **scope):
    """Yield the workers of a twin that has these names, as after cell 3 of a notebook."""
    with tempfile.TemporaryDirectory() as folder:
        workers = Workers(Path(folder), lambda: spent(pid), seconds)
        pid = os.fork()
        if not pid:
            try:
                serving._wait(serving._greet(workers.address, 3, "twin"), workers.address, 3, scope)
            finally:
                os._exit(0)
        while 3 not in workers.twins:
            workers.meet()
        try:
            yield workers
        finally:
            workers.close()
            os.waitpid(pid, 0)


def spent(pid):
    first = psutil.Process(pid)
    return sum(sum(each.cpu_times()[:4]) for each in [first, *first.children(recursive=True)])


def remote(workers, name):
    workers.start(3)
    return workers.names(3, [name])[name]


def length(v):
    return float(np.hypot(*v))


CASES = [(np.array([3.0, 4.0]),), (np.array([1.0, 0.0]),)]
BELOW = [(np.array([-3.0, 4.0]),)]
TASK = Task(
    "length",
    [
        Part("plain vectors", 2, Check("length", length, lambda _rng: CASES, judges.number("m"))),
        Part("below zero", 1, Check("length", length, lambda _rng: BELOW, judges.number("m"))),
    ],
)


@needs_fork
def test_a_function_is_called_from_afar():
    with afar(length=length, five=5) as workers:
        mine = remote(workers, "length")
        assert mine(np.array([3.0, 4.0])) == 5.0
        assert TASK.marked("length", {"length": mine}).points == 3.0
        assert workers.names(3, ["five", "nothing"]) == {"five": 5}
        assert workers.traces == []


def talks(v):
    print("here")
    print("there", file=sys.stderr)
    v *= 2
    return length(v) / 2


@needs_fork
def test_t16_what_is_printed_logged_or_changed_is_a_remark(capsys):
    with afar(length=talks) as workers:
        mark = TASK.marked("length", {"length": remote(workers, "length")})
    assert mark.points == 3.0
    remarks = ("changes what it is given", "prints", "writes to stderr")
    assert [row.remarks for row in mark.rows] == [remarks, remarks]
    assert "(It changes what it is given and prints and writes to stderr: that costs nothing here.)" in repr(mark)
    assert mark.data()["parts"][0]["remarks"] == list(remarks)
    assert capsys.readouterr() == ("", "")


def forever(v):
    if v[0] < 0:
        while True:
            try:
                while True:
                    sum(range(100))
            except BaseException:
                pass
    return length(v)


@needs_fork
def test_an_endless_loop_costs_its_part_alone_and_is_tried_twice():
    with afar(0.3, length=forever) as workers:
        began = time.monotonic()
        mark = TASK.marked("length", {"length": remote(workers, "length")})
        assert time.monotonic() - began < 10
    assert [row.points for row in mark.rows] == [2.0, 0.0]
    assert mark.rows[1].answer.fault == "out of time"
    assert "within 0.3 s: is there a loop that never ends, or is it too slow?" in mark.rows[1].off


@needs_fork
def test_t17_waiting_for_a_busy_machine_is_no_fault(monkeypatch):
    """What counts is the processor's time: twice the limit on the clock, and next to none of it."""
    monkeypatch.setattr(Check.__call__, "__defaults__", (0.01,))  # a lesson's limit times the judge, not the student

    def waits(v):
        time.sleep(0.3)
        return length(v)

    with afar(0.2, length=waits) as workers:
        assert TASK.marked("length", {"length": remote(workers, "length")}).points == 3.0
        workers.seconds = 0.05  # on the clock, 0.2 s of a machine that is not busy
        monkeypatch.setattr("psutil.getloadavg", lambda: (4.0 * psutil.cpu_count(), 0.0, 0.0))
        assert remote(workers, "length").afresh()(np.array([3.0, 4.0])) == 5.0
        monkeypatch.setattr("psutil.getloadavg", lambda: (0.0, 0.0, 0.0))
        with pytest.raises(OutOfTime):
            remote(workers, "length").afresh()(np.array([3.0, 4.0]))


@needs_fork
def test_t17_a_loop_that_never_ends_takes_no_time_of_the_next_cell():
    """On a busy machine an honest task after it was out of time: its own calls, and the loop's, were counted."""

    def loops():
        while True:
            pass

    def used():
        return sum(spent(pid) for pid in pids if psutil.pid_exists(pid))

    pids = []
    try:
        with tempfile.TemporaryDirectory() as folder, closing(Workers(Path(folder), used, 0.3)) as workers:
            for cell in (3, 4):
                pids.append(os.fork())
                if not pids[-1]:
                    try:
                        line = serving._greet(workers.address, cell, "twin")
                        serving._wait(line, workers.address, cell, {"f": loops})
                    finally:
                        os._exit(0)
            while len(workers.twins) < 2:
                workers.meet()
            with pytest.raises(OutOfTime):
                remote(workers, "f")()
            workers.start(4)
            before = workers.spent()
            time.sleep(1.0)
            assert workers.spent() - before < 0.1
    finally:
        for pid in pids:
            os.waitpid(pid, 0)


@pytest.mark.parametrize(("load", "comes"), [(10.0, True), (0.0, False)])
def test_t17_a_worker_that_comes_late_on_a_busy_machine_is_met(tmp_path, monkeypatch, load, comes):
    monkeypatch.setattr("psutil.getloadavg", lambda: (load * psutil.cpu_count(), 0.0, 0.0))
    monkeypatch.setattr("primkit.course.grading.workers.GREETING_SECONDS", 0.3)
    lines = []
    clock = threading.Timer(1.0, lambda: lines.append(serving._greet(workers.address, 3, "worker")))
    workers = Workers(tmp_path, lambda: 0.0, 5.0, make=lambda _cell: clock.start())
    with suppress(Ended):
        workers.start(3)
    assert (workers.line is not None) is comes
    clock.join()
    lines[0].close()
    workers.close()


def test_a_graded_cell_of_no_points_is_a_dropped_task_and_runs_nothing(tmp_path):
    made = assignments(tmp_path / "assignments", dropped={"dropped": ["half"]})
    course = new_course(tmp_path / "course", made)
    path, tests = course.root / "source" / "dropped" / "dropped.ipynb", course.root / "grader" / "halves.py"
    tests.write_text(f"{tests.read_text()}\nHALF = task('half')\n")
    for points, fine in ((2, False), (3, True), (0, True)):
        notebook = read(path)
        (cell,) = [cell for cell in notebook["cells"] if about(cell).get("grade_id") == "half-hidden"]
        cell["metadata"]["nbgrader"]["points"] = points
        cell["source"] = "from grader.halves import HALF\n\nHALF.mark('half', globals())"
        path.write_text(json.dumps(notebook))
        assert all(finding.fine for finding in _points(course)) is fine
    assert Judging(path, missing).outputs("half-hidden", 0, None) == []


@needs_fork
def test_a_limit_for_lines_of_this_process_does_not_break_off_a_message():
    """psutil runs lines that stand in no file; on a busy machine a search for slips stopped there."""

    def waits(v):
        time.sleep(0.3)
        return length(v)

    with afar(0.2, length=waits) as workers:
        mine = remote(workers, "length")
        workers.spent = eval("lambda: 0.0")
        assert call_within(0.02, mine, np.array([3.0, 4.0])) == 5.0
        assert mine(np.array([6.0, 8.0])) == 10.0
        assert workers.traces == []


@needs_fork
def test_t17_the_first_part_that_is_late_has_one_more_try(tmp_path):
    def once(v):
        if v[0] < 0 and not (tmp_path / "seen").exists():
            (tmp_path / "seen").touch()
            while True:
                pass
        return length(v)

    with afar(0.3, length=once) as workers:
        mark = TASK.marked("length", {"length": remote(workers, "length")})
    assert mark.points == 3.0


def test_t18_digits_that_differ_are_shown():
    judge = judges.number("m", 1e-5)
    off = judge(0.27080, 0.27084, ())
    got, expected = off.removeprefix("got ").split(", expected ")
    assert got != expected


@needs_fork
def test_each_part_has_a_process_of_its_own():
    calls = []

    def counts(v):
        calls.append(v)
        return length(v) if len(calls) <= 2 else 0.0

    with afar(length=counts) as workers:
        assert TASK.marked("length", {"length": remote(workers, "length")}).points == 3.0


RAISES = {
    "an error": (lambda _v: 1 / 0, "raises ZeroDivisionError", "raised ZeroDivisionError: division by zero"),
    "another name": (lambda: 0, "asks for other arguments", "Keep the arguments that are given: length(v)"),
    "the end": (lambda _v: os._exit(0), "ends Python", "ends Python: a function returns"),
    "exit": (lambda _v: sys.exit(0), "raises SystemExit", "ends Python with SystemExit"),
    "an interruption": (lambda _v: signalled(), "raises KeyboardInterrupt", "ends Python with KeyboardInterrupt"),
    "too much": (lambda _v: np.zeros(10**6), "returns what cannot be judged", "got a result of more than 1 MB"),
}


def signalled():
    raise KeyboardInterrupt


@needs_fork
@pytest.mark.parametrize(("function", "fault", "says"), RAISES.values(), ids=RAISES)
def test_whatever_it_raises_has_its_own_name(function, fault, says):
    with afar(length=function) as workers:
        mark = TASK.marked("length", {"length": remote(workers, "length")})
        assert workers.traces == []
    for row in mark.rows:
        assert row.points == 0.0
        assert row.answer.fault == fault
        assert says in row.off


@needs_fork
@pytest.mark.parametrize("said", [("right", 3.0), ("returned", 5.0), ("raised", 1)], ids=str)
def test_a_forged_answer_is_no_answer_and_leaves_a_trace(monkeypatch, said):
    monkeypatch.setattr(serving, "_called", lambda *_a: said)
    with afar(length=length) as workers:
        mark = TASK.marked("length", {"length": remote(workers, "length")})
        assert mark.points == 0.0
        assert workers.traces


@needs_fork
def test_who_says_too_much_is_not_listened_to(monkeypatch):
    monkeypatch.setattr(serving, "MOST_BYTES", 10**9)
    with afar(length=lambda _v: np.zeros(10**6)) as workers:
        mine = remote(workers, "length")
        with pytest.raises(Ended, match=r"says \d+ bytes at once"):
            mine(np.zeros(2))
        (trace,) = workers.traces
        assert re.fullmatch(r"the process says \d{8} bytes at once", trace)


def test_a_missing_function_says_why():
    told = missing("length", ("SyntaxError", "SyntaxError in line 2: no"))
    mark = TASK.marked("length", {"length": told})
    assert {row.answer.fault for row in mark.rows} == {"its cell stops with SyntaxError"}
    with pytest.raises(NameError, match="name 'length' is not defined"):
        told(1.0)


# --- a notebook ---------------------------------------------------------------------------------------------------


def graded(course, name, cells=None, **answers):
    """Run a submission to a set of one notebook of its own name; return cell -> (points, of), and the notebook.

    The endless ones in the miniature course have a second of processor time, of which the others need some hundredths.
    """
    path = course / "source" / name / f"{name}.ipynb"
    notebook = nbformat.read(path, as_version=4)
    for cell in notebook.cells:
        if about(cell).get("grade_id") in answers:
            cell.source = answers[about(cell)["grade_id"]]
        if cell.cell_type == "code":
            cell.outputs = []
    notebook.cells += [nbformat.v4.new_code_cell(source) for source in cells or ()]
    execute = CarefulExecute(course=str(course), timeout=20, seconds=5.0 if name in SETS else 1.0)
    about_it = {"student": "demonstration", "assignment": name, "notebook": name}
    execute.preprocess(notebook, {"metadata": {"path": str(path.parent)}, "nbgrader": about_it})
    cells_of = {about(cell)["grade_id"]: cell for cell in notebook.cells if about(cell).get("grade")}
    return {each: determine_grade(cell) for each, cell in cells_of.items()}, notebook


@pytest.fixture(scope="module")
def course(tmp_path_factory):
    root = tmp_path_factory.mktemp("judge")
    books = {"halves": {"halves": [*ANSWERS_OF]}, "few": {"few": FEW}}
    return new_course(root / "course", assignments(root / "assignments", **books)).root


ANSWERS_OF = {
    "plain": "def helper(x): return x / 2\n\ndef plain(x): return helper(x)",
    "late": "state = []\n\ndef late(x):\n    state.append(x)\n    return x / 2 if len(state) <= 21 else 0",
    "own": "import sys\n\ndef own(x):\n    print('case', x, file=sys.stderr)\n    print('case', x)\n    return x / 2",
    "broken": "def broken(x):\n    return (x",
    "loop": "def loop(x):\n    while True: pass",
    "absent": "def absnt(x): return x / 2",
}
FEW = ("plain", "loop", "late")
LATER = ["def helper(x): raise ValueError('another task has its own')", "print('the end', len(state))"]


def mark_in(cell):
    (mark,) = [output.data[MIME] for output in cell.outputs if MIME in output.get("data", {})]
    return mark


def check_halves(course):
    points, notebook = graded(course, "halves", cells=LATER, **ANSWERS_OF)
    reached = {task: points[f"{task}-visible"][0] + points[f"{task}-hidden"][0] for task in ANSWERS_OF}
    assert reached == {"plain": 4, "late": 4, "own": 4, "broken": 0, "loop": 0, "absent": 0}
    cells = {about(cell).get("grade_id"): cell for cell in notebook.cells}
    marks = {
        name: [out.data[MIME] for out in cell.outputs if MIME in out.get("data", {})] for name, cell in cells.items()
    }
    (told,) = marks["broken-hidden"]
    assert told["parts"][0]["off"].startswith(
        "there is no function broken: its cell stops with SyntaxError in line 2: "
    )
    assert marks["absent-hidden"][0]["parts"][0]["fault"] == "no such function"
    assert marks["loop-hidden"][0]["parts"][0]["fault"] == "out of time"
    assert [out.ename for out in cells["loop-visible"].outputs] == ["CellTimeoutError"]
    assert [out.ename for out in cells["absent-visible"].outputs] == ["NameError"]
    assert "case" not in str([cell.outputs for cell in notebook.cells])
    return cells, notebook


def test_each_graded_cell_is_judged_as_the_notebook_was_there(course):
    cells, notebook = check_halves(course)
    assert notebook.cells[-1].outputs[0].text == "the end 0\n"  # no case came to a cell of the notebook
    assert notebook.metadata.primkit.confined == confining.confined_by()
    assert cells["plain-hidden"].source.endswith("### END HIDDEN TESTS")  # as the teacher wrote it


def test_without_fork_the_kernel_itself_answers(course, monkeypatch):
    monkeypatch.setattr(executing, "FORKS", False)
    points, _ = graded(course, "few", **{task: ANSWERS_OF[task] for task in FEW})
    reached = {task: points[f"{task}-visible"][0] + points[f"{task}-hidden"][0] for task in FEW}
    assert reached == {"plain": 4, "loop": 0, "late": 4}


def test_the_hidden_tests_are_those_of_the_course_whatever_was_imported_before(course, monkeypatch):
    other = ModuleType("grader")
    monkeypatch.setitem(sys.modules, "grader", other)
    monkeypatch.setitem(sys.modules, "grader.halves", ModuleType("grader.halves"))
    for _ in range(2):  # and they may have changed since the last time
        with hidden_tests_of(course):
            read = import_module("grader.halves")
            assert read.__file__ == str(course / "grader" / "halves.py")
            assert not hasattr(read, "seen")
            read.seen = True
    assert sys.modules["grader"] is other
    assert str(course) not in sys.path


def test_without_walls_every_report_says_so(course, monkeypatch):
    monkeypatch.setattr(own_kernel, "bubblewrap_works", lambda: False)
    monkeypatch.setattr(confining, "bubblewrap_works", lambda: False)
    monkeypatch.delenv(confining.BY_OTHERS, raising=False)
    points, notebook = graded(course, "halves", plain=ANSWERS_OF["plain"])
    assert points["plain-hidden"] == (3.0, 3.0)
    fault = notebook.metadata.primkit.faults[0]
    assert fault.name == "unprotected"
    assert fault.says == "unprotected: no wall stands between a student's code and your files"
    monkeypatch.setenv(confining.BY_OTHERS, "a container")
    assert confining.confined_by() == "a container"


# --- the problem sets ---------------------------------------------------------------------------------------------

SETS = sorted(path.stem for path in (ROOT / "notebooks" / "assignments" / "source").glob("*/*.ipynb"))


@pytest.fixture(scope="module")
def real(tmp_path_factory):
    return new_course(tmp_path_factory.mktemp("real") / "course").root


@pytest.mark.parametrize("name", SETS)
def test_the_teachers_own_notebook_takes_the_same_judge(real, name):
    points, notebook = graded(real, name)
    by_test = {cell: told for cell, told in points.items() if told[0] is not None}
    assert {cell for cell, (got, of) in by_test.items() if got != of} == set()
    assert len(by_test) == sum(bool(about(cell).get("grade")) and cell.cell_type == "code" for cell in notebook.cells)
    assert [fault for fault in notebook.metadata.primkit.faults if fault.name != "unprotected"] == []


def test_in_the_capstone_ready_made_functions_refuse_to_work(real):
    ((_, points, fault),) = ANSWERS["my_shapes"]["refused"].values()
    text = "from primkit import find_shapes as ready_made\n\ndef my_shapes(scans):\n    grid = pk.Grid()\n"
    text += "    grid.add(scans)\n    return [each.shape for each in ready_made(grid, rng=0)]"
    looks = "import inspect, primkit.robust.candidates as c\nprint(inspect.getsource(c))"
    got, notebook = graded(real, "09_your_own_map", cells=[looks], my_shapes=text)
    assert got["my_shapes-visible"][0] + got["my_shapes-hidden"][0] == points
    assert got["measure_pillars-hidden"] == (6.0, 6.0)
    mark = next(mark_in(cell) for cell in notebook.cells if about(cell).get("grade_id") == "my_shapes-hidden")
    assert {part["fault"] for part in mark["parts"]} == {fault}
    assert "it refuses to work" in notebook.cells[-1].outputs[0].text


def test_all_35_graded_cells_are_known():
    notebooks = [read(ROOT / "notebooks" / "assignments" / "source" / name / f"{name}.ipynb") for name in SETS]
    cells = [cell for notebook in notebooks for cell in notebook["cells"] if about(cell).get("grade")]
    assert len(cells) == 35
    assert sum(cell["cell_type"] == "code" for cell in cells) == 34  # and one written answer
