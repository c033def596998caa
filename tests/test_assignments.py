"""The problem sets: any correct answer gets all points, each listed wrong one exactly its own, and its fault is named.

The answers are in tests/answers/assignment_N.py. Hidden tests are called directly; the visible ones are read from the
source notebooks, whose stored outputs nbval compares.
"""

import ast
import contextlib
import io
import json
import re
import sys
import time
from dataclasses import replace
from functools import cache
from importlib import import_module
from itertools import combinations, pairwise
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pytest

import primkit as pk
from primkit.course.grading import personal_truth
from primkit.course.grading.task import Local
from primkit.course.personal import board_of, personal_scans

ROOT = Path(__file__).resolve().parent.parent
sys.path.append(str(ROOT / "notebooks" / "assignments"))  # the teacher's package `grader` is not part of primkit
SOURCE = ROOT / "notebooks" / "assignments" / "source"
ANSWERS = {}
for path in sorted((ROOT / "tests" / "answers").glob("assignment_*.py")):
    ANSWERS |= import_module(f"tests.answers.{path.stem}").ANSWERS
NOTEBOOKS = {path.stem: json.loads(path.read_text(encoding="utf-8")) for path in sorted(SOURCE.glob("*/*.ipynb"))}

BEGIN, END = r"^[ \t]*### BEGIN (SOLUTION|HIDDEN TESTS)\n", r"^[ \t]*### END (SOLUTION|HIDDEN TESTS)\n?"
MARKS = re.compile(rf"{BEGIN}|{END}", re.MULTILINE)
HIDDEN = re.compile(r'^(\w+)\.(\w+)\.mark\("(\w+)", globals\(\)', re.MULTILINE)


def source(cell):
    return "".join(cell["source"])


def graded(cell):
    return cell["metadata"].get("nbgrader", {})


def cells_of(notebook):
    """Return a notebook's cells by their names for nbgrader."""
    return {graded(cell)["grade_id"]: cell for cell in notebook["cells"] if graded(cell)}


CELLS = {ident: cell for notebook in NOTEBOOKS.values() for ident, cell in cells_of(notebook).items()}
BOOK = {ident: name for name, notebook in NOTEBOOKS.items() for ident in cells_of(notebook)}


def hidden_task(ident):
    """Return the task that a hidden cell marks: its room and its name are read from the cell.

    Its cases are drawn when they are first asked for, and kept; but for those that are a student's own board.
    """
    room, name, function = HIDDEN.search(source(CELLS[f"{ident}-hidden"])).groups()
    assert function == ident
    task = getattr(import_module(f"grader.{room}"), name)
    kept = [replace(part, check=replace(part.check, cases=drawn_once(part.check.cases))) for part in task.parts]
    return task if ident == "my_shapes" else type(task)(ident, kept)


def drawn_once(cases):
    kept = {}

    def drawn(rng):
        seed = rng.bit_generator.state["state"]["state"]
        if seed not in kept:
            kept[seed] = list(cases(rng))
        return kept[seed]

    return drawn


TASKS = {
    ident.removesuffix("-hidden"): hidden_task(ident.removesuffix("-hidden"))
    for ident in CELLS
    if ident.endswith("-hidden")
}


def points_of(ident):
    return graded(CELLS[ident])["points"]


def run(cell, scope):
    """Run a cell's code without what it prints."""
    with contextlib.redirect_stdout(io.StringIO()):
        exec(compile(source(cell), "<cell>", "exec"), scope)


@cache
def given_in(book):
    """Return what the cells that stand ready in a notebook define: imports, and data for the visible tests."""
    scope = {}
    with contextlib.chdir(SOURCE / book):  # where Jupyter runs it, beside the data
        for cell in NOTEBOOKS[book]["cells"]:
            if cell["cell_type"] == "code" and graded(cell)["locked"] and not graded(cell)["grade"]:
                run(cell, scope)
    plt.close("all")
    return scope


def setup_of(task):
    """Return what is given in the task's notebook, and the notebook's own solution."""
    scope = dict(given_in(BOOK[task]))
    run(CELLS[task], scope)
    return scope


def visible_points(task, function):
    """Return the points of a function in the visible tests: all or none, as nbgrader counts."""
    scope = setup_of(task) | {task: Local(function) if callable(function) else function}
    try:
        run(CELLS[f"{task}-visible"], scope)
    except Exception:
        return 0
    return points_of(f"{task}-visible")


def lost_parts(mark, visible):
    """Return what a function loses: "v" for the visible tests, and the numbers of parts, such as "v24"."""
    return "v" * (not visible) + "".join(str(n) for n, row in enumerate(mark.rows, 1) if not row.answer.right)


@cache
def marked(task, function):
    """Return a function's mark; a busy machine has time."""
    return TASKS[task].marked(function)


def points_left(task, loses):
    """Return the points of an answer that loses some parts."""
    lost = sum(
        points_of(f"{task}-visible") if part == "v" else TASKS[task].parts[int(part) - 1].points for part in loses
    )
    return points_of(f"{task}-visible") + TASKS[task].points - lost


@pytest.fixture(autouse=True, scope="module")
def _without_hints():
    """Points do not depend on hints, and a search for slips takes seconds."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("primkit.checks.answer.find_slips", lambda *_, **__: [])
        yield


def wrong_ones(task):
    return ANSWERS[task]["wrong"].values()


def table(kind):
    rows = []
    for task, answers in ANSWERS.items():
        for name, answer in answers[kind].items():
            rows.append(pytest.param(task, *(answer if isinstance(answer, tuple) else (answer,)), id=f"{task}-{name}"))
    return rows


# --- the hidden tests ----------------------------------------------------------------------------------------


def test_every_task_has_answers_and_every_answer_a_task():
    assert set(ANSWERS) == set(TASKS)


@pytest.mark.parametrize("task", TASKS)
def test_every_task_has_five_right_ways_and_ten_wrong_ones(task):
    assert len(set(ANSWERS[task]["right"].values())) >= 5
    assert len(set(wrong_ones(task))) >= 10
    assert all(loses for _, loses, _ in wrong_ones(task))


@pytest.mark.parametrize("task", TASKS)
def test_two_to_four_parts_whose_points_are_those_of_the_cell(task):
    assert 2 <= len(TASKS[task].parts) <= (7 if task == "my_shapes" else 4)  # a whole pipeline
    assert TASKS[task].points == points_of(f"{task}-hidden")


@pytest.mark.parametrize("task", TASKS)
def test_the_reference_gets_all_points(task):
    mark = marked(task, TASKS[task].parts[0].check.reference)
    assert mark.points == mark.of, mark


@pytest.mark.parametrize("task", TASKS)
def test_the_notebooks_own_solution_gets_all_points(task):
    solution = setup_of(task)[task]
    mark = marked(task, solution)
    assert mark.points == mark.of, mark
    assert visible_points(task, solution) == points_of(f"{task}-visible")


@pytest.mark.parametrize(("task", "function"), table("right"))
def test_any_correct_way_gets_all_points(task, function):
    mark = marked(task, function)
    assert mark.points == mark.of, mark
    assert visible_points(task, function) == points_of(f"{task}-visible")


@pytest.mark.parametrize("task", TASKS)
def test_an_untouched_stub_gets_nothing(task):
    def stub(*_arguments):
        raise NotImplementedError

    assert TASKS[task].marked(stub).points == 0
    assert visible_points(task, stub) == 0
    assert TASKS[task].marked(task, {}).points == 0


@pytest.mark.parametrize(("task", "function", "loses", "fault"), table("wrong"))
def test_a_wrong_answer_loses_exactly_its_parts_and_has_its_name(task, function, loses, fault):
    mark = marked(task, function)
    assert lost_parts(mark, visible_points(task, function)) == loses, mark
    assert fault in {row.answer.fault for row in mark.rows if not row.answer.right}, mark


@pytest.mark.parametrize("task", TASKS)
def test_every_part_fails_for_a_listed_wrong_answer(task):
    open_parts = {row.says for row in TASKS[task].marked(lambda *_arguments: ...).rows}
    for function, *_ in wrong_ones(task):
        open_parts -= {row.says for row in marked(task, function).rows if row.answer.verdict in ("wrong", "error")}
    assert not open_parts


@pytest.mark.parametrize("task", TASKS)
def test_parts_ask_different_questions(task):
    """For each two parts some wrong answer loses one of them and keeps the other."""
    lost = [{row.says for row in marked(task, wrong[0]).rows if not row.answer.right} for wrong in wrong_ones(task)]
    for one, other in combinations([part.says for part in TASKS[task].parts], 2):
        assert any((one in parts) != (other in parts) for parts in lost), (one, other)


@pytest.mark.parametrize("task", TASKS)
def test_every_fault_is_named_for_a_listed_wrong_answer(task):
    listed = {fault for _, _, fault in ANSWERS[task]["wrong"].values()}
    for part in TASKS[task].parts:
        for fault in part.check.faults:
            assert fault.name, fault.says
            assert fault.name in listed, fault.name


@pytest.mark.parametrize("task", TASKS)
@pytest.mark.parametrize("nonsense", [None, "text", [], {}, float("nan"), object()], ids=type)
def test_nonsense_gets_an_answer_and_no_point(task, nonsense):
    mark = TASKS[task].marked(lambda *_arguments: nonsense)
    assert not any("0x" in row.answer.says for row in mark.rows)
    assert not any("cannot be judged" in row.answer.says for row in mark.rows), mark
    assert mark.points == 0, mark


@pytest.mark.parametrize("task", TASKS)
def test_hints_do_not_hold_the_solution(task):
    """A hint asks or explains: no line of the solution stands in it."""
    lines = [line.strip() for line in re.split(BEGIN, source(CELLS[task]), flags=re.MULTILINE)[-1].splitlines()]
    for part in TASKS[task].parts:
        for fault in part.check.faults:
            assert not any(len(line) > 12 and line in fault.says for line in lines)


@pytest.mark.parametrize("student", ["ada", "bob", "eve-17", "9", "Zoë"])
def test_a_right_pipeline_is_right_on_everybodys_map(student):
    own = setup_of("my_shapes")["my_shapes"]
    with board_of(pk.personal_world(student, salt="a salt for the tests")):
        for pipeline in (own, *ANSWERS["my_shapes"]["right"].values()):
            mark = TASKS["my_shapes"].marked(pipeline)
            assert mark.points == mark.of, mark


def test_the_demonstration_file_holds_the_scans_of_the_demonstration():
    stored = pk.load_scans(SOURCE / "09_your_own_map" / "my_scans.npz")
    made = personal_scans(personal_truth())
    assert (stored.ranges == made.ranges).all()
    assert (stored.poses == made.poses).all()


def loaded_in(folder, capsys):
    """Run the cell that loads the scans in a folder, and return what it says."""
    with contextlib.chdir(folder):
        exec(source(CELLS["own-scans"]), setup_of("my_shapes"))
    plt.close("all")
    return capsys.readouterr().out


def test_the_notebook_says_whose_board_it_shows(tmp_path, capsys):
    assert "demonstration's board, not yours" in loaded_in(SOURCE / "09_your_own_map", capsys)
    own = personal_scans(pk.personal_world("ada", salt="a salt for the tests"))
    with pytest.raises(FileNotFoundError, match="from your teacher, beside this notebook"):
        loaded_in(tmp_path, capsys)
    pk.save_scans(own, tmp_path / "my_scans.npz")
    assert loaded_in(tmp_path, capsys) == "This is a board of your own.\n"


def test_the_visible_test_says_that_it_took_long(monkeypatch, capsys):
    scope = setup_of("my_shapes")
    clock = iter([0.0, 25.0])
    monkeypatch.setattr(time, "monotonic", lambda: next(clock))
    scope["tried"](lambda _scans: [], None)
    assert "It took 25 s" in capsys.readouterr().out


def test_what_is_off_with_a_map_is_said_as_it_is():
    shapes = list(personal_truth().shapes)
    array = TASKS["my_shapes"].marked(lambda _scans: np.array(shapes, dtype=object))
    assert "got a ndarray, expected a list of" in array.rows[0].off
    alone = TASKS["my_shapes"].marked(lambda _scans: shapes[:1])
    assert "1 name is right" in alone.rows[1].off


def test_the_colleagues_function_is_a_listed_wrong_answer():
    given = given_in("09_your_own_map")["pillars_with_bugs"]
    listed = ANSWERS["measure_pillars"]["wrong"]["untouched"][0]
    assert [row.off for row in marked("measure_pillars", given).rows] == [
        row.off for row in marked("measure_pillars", listed).rows
    ]
    assert visible_points("measure_pillars", given) == 0


# --- the notebooks -------------------------------------------------------------------------------------------


def text(notebook):
    return "\n\n".join(source(cell) for cell in notebook["cells"] if cell["cell_type"] == "markdown")


@pytest.mark.parametrize("name", NOTEBOOKS)
def test_one_title_and_levels_in_order(name):
    levels = [len(marks) for marks in re.findall(r"^(#+) ", text(NOTEBOOKS[name]), re.MULTILINE)]
    assert levels[0] == 1
    assert levels.count(1) == 1
    assert all(after <= before + 1 for before, after in pairwise(levels))


@pytest.mark.parametrize("name", NOTEBOOKS)
def test_the_table_states_the_points_of_each_task(name):
    rows = re.findall(r"^\| .*?`(\w+)` \| (\d+) \|$", text(NOTEBOOKS[name]), re.MULTILINE)
    cells = cells_of(NOTEBOOKS[name])
    for function, points in rows:
        kinds = [f"{function}-visible", f"{function}-hidden"]
        assert sum(graded(cells[kind])["points"] for kind in kinds) == int(points)
    assert {function for function, _ in rows} == {task for task in TASKS if BOOK[task] == name}
    total = int(re.search(r"^\| \*\*all\*\* .*\*\*(\d+)\*\* \|$", text(NOTEBOOKS[name]), re.MULTILINE)[1])
    assert total == sum(graded(cell).get("points", 0) for cell in NOTEBOOKS[name]["cells"])


@pytest.mark.parametrize("name", NOTEBOOKS)
def test_a_picture_is_followed_by_words(name):
    cells = NOTEBOOKS[name]["cells"]
    for cell, after in pairwise(cells):
        if any("image/png" in output.get("data", {}) for output in cell.get("outputs", [])):
            assert source(after).startswith("*Figure: ")


@pytest.mark.parametrize("name", NOTEBOOKS)
def test_every_cell_was_run_in_order_without_an_error(name):
    code = [cell for cell in NOTEBOOKS[name]["cells"] if cell["cell_type"] == "code"]
    assert [cell["execution_count"] for cell in code] == list(range(1, len(code) + 1))
    assert not any(output["output_type"] == "error" for cell in code for output in cell["outputs"])
    assert not any(output.get("name") == "stderr" for cell in code for output in cell["outputs"])
    assert max(source(cell).count("\n") for cell in code if not graded(cell).get("solution")) < 20


@pytest.mark.parametrize("ident", CELLS)
def test_nbgrader_reads_the_cells(ident):
    cell = CELLS[ident]
    settings = graded(cell)
    assert settings["schema_version"] == 3
    if settings["solution"]:
        assert not settings["locked"]
    else:
        assert settings["locked"], "whoever changes it by mistake gets it back when it is marked"
    if settings["grade"]:
        assert settings["points"] > 0


@pytest.mark.parametrize("task", TASKS)
def test_markers_stand_around_every_solution_and_every_hidden_test(task):
    for ident, word in ((task, "SOLUTION"), (f"{task}-hidden", "HIDDEN TESTS")):
        found = [mark.group().split()[1:] for mark in MARKS.finditer(source(CELLS[ident]) + "\n")]
        assert [" ".join(words) for words in found] == [f"BEGIN {word}", f"END {word}"]
    seen = MARKS.split(source(CELLS[f"{task}-visible"]))
    assert len(seen) == 1


@pytest.mark.parametrize("task", TASKS)
def test_the_stub_documents_shapes_units_and_an_example(task):
    function = next(
        node
        for node in ast.walk(ast.parse(source(CELLS[task])))
        if isinstance(node, ast.FunctionDef) and node.name == task
    )
    words = ast.get_docstring(function)
    assert "Example" in words
    assert re.search(r"metres|radians|shares", words)
    reference = TASKS[task].parts[0].check.reference
    names = [argument.arg for argument in function.args.args]
    assert list(reference.__code__.co_varnames[: len(names)]) == names
    assert all(argument.annotation for argument in function.args.args)
    assert function.returns


@pytest.mark.parametrize("task", TASKS)
def test_no_library_call_has_the_name_of_a_task(task):
    """And no lesson does: a solution cannot be looked up by its name."""
    files = [*(ROOT / "primkit").rglob("*.py"), *(ROOT / "notebooks").glob("*.ipynb")]
    assert not any(re.search(rf"\bdef {task}\b", path.read_text(encoding="utf-8")) for path in files)


def test_grader_doctests():
    import doctest

    for room in {TASKS[task].parts[0].check.reference.__module__ for task in TASKS}:
        assert doctest.testmod(import_module(room)).failed == 0
