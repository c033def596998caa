"""Grading: points part by part, whatever a function does; in one process, as in a teacher's own notebook."""

import re
import sys

import numpy as np
import pytest

from primkit.checks import Check, Fault, judges
from primkit.course.grading import MIME, Part, Task, personal_truth
from primkit.course.personal import board_of, personal_world


def lengths(_rng):
    return [(np.array([3.0, 4.0]),), (np.array([1.0, 0.0]),)]


def signed(_rng):
    return [(np.array([-3.0, 4.0]),)]


def length(v):
    return float(np.hypot(*v))


SUM = Fault("Sides do not add up.", like=lambda v: abs(float(v.sum())), name="sum for root")
TASK = Task(
    "length",
    [
        Part("plain vectors", 2, Check("length", length, lengths, judges.number("m"), (SUM,))),
        Part("below zero", 1.5, Check("length", length, signed, judges.number("m"))),
    ],
)


def test_right_is_all_points_and_a_stub_none():
    assert TASK.points == 3.5
    mark = TASK.mark(length)
    assert mark == 3.5
    assert type(mark) is float  # np.float64(3.5) is no number to nbgrader

    def stub(_v):
        raise NotImplementedError

    for untouched in (stub, lambda _v: ...):
        marked = TASK.marked(untouched)
        assert marked.points == 0.0
        assert {row.answer.verdict for row in marked.rows} == {"not attempted"}


def test_each_part_is_all_or_none():
    assert TASK.mark(lambda v: 0.0 if v[0] < 0 else length(v)) == 2.0
    assert TASK.mark(lambda v: length(v) if v[0] < 0 else 0.0) == 1.5


def test_a_named_fault_is_in_the_data():
    data = TASK.marked(lambda v: abs(v.sum())).data()
    assert data["task"] == "length"
    assert (data["points"], data["of"]) == (0.0, 3.5)
    plain, below = data["parts"]
    assert (plain["says"], plain["points"], plain["of"]) == ("plain vectors", 0.0, 2.0)
    assert (plain["verdict"], plain["fault"]) == ("wrong", "sum for root")
    assert "got 7 m, expected 5 m" in plain["off"]
    assert (below["verdict"], below["fault"]) == ("wrong", None)


def ends(_v):
    sys.exit(3)


FAULTS = {
    "raises": (lambda _v: 1 / 0, "error", "raises ZeroDivisionError", "raised ZeroDivisionError: division by zero"),
    "ends": (ends, "error", "raises SystemExit", "ends Python with SystemExit"),
    "no function": (0.5, "error", "no function", "must be a function, got 0.5"),
    "memory": (lambda _v: np.zeros(2**60), "error", "raises", "Unable to allocate|too large|too big"),
}


@pytest.mark.parametrize(("function", "verdict", "fault", "off"), FAULTS.values(), ids=FAULTS)
def test_whatever_a_function_does_costs_its_points_and_gets_a_sentence(function, verdict, fault, off):
    for row in TASK.marked(function).rows:
        assert row.answer.verdict == verdict
        assert row.answer.fault.startswith(fault)
        assert re.search(off, row.off), row.off
        assert row.points == 0.0


def test_a_judge_that_breaks_costs_the_part_alone():
    def judge(got, _expected, _args):
        return None if got + 1 else "zero"

    broken = Part("numbers", 1, Check("length", length, lengths, judge))
    task = Task("length", [broken, Part("again", 1, Check("length", length, lengths, judges.number("m")))])
    mark = task.marked(lambda _v: "five")
    assert [row.answer.verdict for row in mark.rows] == ["error", "wrong"]
    assert mark.rows[0].answer.fault == "returns what cannot be judged"


def test_a_missing_function_is_not_attempted():
    mark = TASK.marked("length", {})
    assert {row.answer.fault for row in mark.rows} == {"no such function"}
    assert TASK.mark("length", {"length": length}) == 3.5


def test_an_interruption_by_hand_goes_through():
    def stopped(_v):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        TASK.mark(stopped)


def test_text_and_html_say_the_same():
    mark = TASK.marked(lambda v: abs(v.sum()))
    bundle = mark._repr_mimebundle_()
    text, html = bundle["text/plain"], bundle["text/html"]
    assert bundle[MIME] == mark.data()
    assert text.splitlines()[0] == "length: 0 of 3.5 points"
    assert "✗ 0 of 2  plain vectors: in 1 of 2 cases" in text
    assert "    Sides do not add up." in text
    for phrase in ("length: 0 of 3.5 points", "✗&nbsp;0&nbsp;of&nbsp;2", "Sides do not add up.", 'scope="col"'):
        assert phrase in html
    assert "<script" not in TASK.marked(lambda _v: "<script>")._repr_html_()


@pytest.mark.parametrize(
    ("build", "sentence"),
    [
        (lambda: Task("length", []), "a task must have at least one part, length has none"),
        (lambda: Task("width", TASK.parts), "each part of width must check width, got a check of length"),
        (lambda: Task("length", [Part("x", 0, TASK.parts[0].check)]), "the points of the part 'x' must be"),
    ],
)
def test_a_task_that_makes_no_sense_is_refused(build, sentence):
    with pytest.raises(ValueError, match="^" + sentence):
        build()


def test_a_notebook_shows_the_table_and_returns_the_number():
    """In a kernel's own shell, without a kernel: what a cell displays, and its value."""
    from IPython.core.interactiveshell import InteractiveShell
    from IPython.utils.capture import capture_output

    shell = InteractiveShell.instance()
    try:
        shell.push({"TASK": TASK, "length": length})
        with capture_output() as captured:
            result = shell.run_cell('TASK.mark("length", globals())').result
    finally:
        InteractiveShell.clear_instance()
    assert result == 3.5
    assert captured.outputs[0].data[MIME]["points"] == 3.5
    assert "3.5 of 3.5 points" in captured.outputs[0].data["text/html"]


def test_the_truth_is_the_student_s_while_graded_and_the_demonstration_otherwise():
    demonstration = personal_world("demonstration", salt="the salt of the demonstration")
    assert personal_truth() == demonstration
    hers = personal_world("ada", salt="0123456789abcdef")
    with board_of(hers):
        assert personal_truth() == hers
    assert personal_truth() == demonstration


# --- what a teacher reads ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("function", "fault"),
    [
        (lambda _v: None, "returns nothing"),
        (lambda v: [v, v], "returns what cannot be judged"),
        (lambda _v: -1.0, None),
    ],
    ids=["print for return", "another form", "another number"],
)
def test_what_is_wrong_in_any_task_has_a_name(function, fault):
    assert {row.answer.fault for row in TASK.marked(function).rows if row.answer.verdict == "wrong"} == {fault}


def test_what_is_off_in_every_part_is_said_once():
    mark = TASK.marked("length", {})
    says = "there is no function length: run its cell, and keep its name."
    assert mark.common == says
    for text in (repr(mark), mark._repr_html_()):
        assert text.count(says) == 1
        assert text.index(says) < text.index(TASK.parts[0].says)
    assert {part["off"] for part in mark.data()["parts"]} == {says}
    assert TASK.marked(lambda _v: -1.0).common == ""  # each part has its own example
