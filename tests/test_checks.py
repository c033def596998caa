"""Checks: any correct algorithm passes, each usual fault is named, and whatever is handed in gets an answer.

The answers are in tests/answers, a module for each lesson; the tests take them all.
"""

import ast
import contextlib
import copy
import itertools
import re
import sys
from functools import cache
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

import primkit as pk
from primkit import own_code
from primkit.checks import judges
from primkit.checks.answer import VERDICT_COLORS, VERDICT_SIGNS, Answer, Check, Fault
from tests.answers.styles import STYLES, styled
from tests.answers.ways import WAYS
from tests.slips import right

FOLDER = Path(__file__).resolve().parent / "answers"
ANSWERS = {}
for path in sorted(FOLDER.glob("lesson_*.py")):
    ANSWERS |= import_module(f"tests.answers.{path.stem}").ANSWERS
TASKS = {task.name: task for task in pk.checks.TASKS}


@cache
def told(task, function):
    """Return what a check says of a listed answer; each is asked once."""
    return TASKS[task](function)


def table(kind):
    """Return (task, function, text) for each listed answer of a kind."""
    rows = []
    for task, answers in ANSWERS.items():
        for name, answer in answers.get(kind, {}).items():
            function, text = answer if isinstance(answer, tuple) else (answer, "")
            rows.append(pytest.param(task, function, text, id=f"{task}-{name}"))
    return rows


def test_every_task_has_answers_and_every_answer_a_task():
    assert set(ANSWERS) == set(TASKS)


@pytest.mark.parametrize("task", TASKS)
def test_every_task_has_another_right_way_and_three_wrong_ones(task):
    assert len(ANSWERS[task]["right"]) >= 1
    assert len(ANSWERS[task]["wrong"]) >= 3


@pytest.mark.parametrize("task", TASKS)
def test_a_task_is_a_public_name_of_checks(task):
    assert getattr(pk.checks, task) is TASKS[task]


@pytest.mark.parametrize("task", TASKS)
def test_the_stub_is_not_attempted(task):
    answer = TASKS[task](lambda *_arguments: ...)
    assert repr(answer) == f"○ not attempted: {task} still returns `...`."


@pytest.mark.parametrize("task", TASKS)
def test_the_reference_is_right(task):
    answer = TASKS[task](TASKS[task].reference)
    assert answer.right, answer
    assert re.fullmatch(rf"✓ right: {task} passes all \d+ cases\.", repr(answer))


@pytest.mark.parametrize(("task", "function", "_text"), table("right"))
def test_another_right_way_is_right(task, function, _text):
    assert told(task, function).right, told(task, function)


@pytest.mark.parametrize("task", TASKS)
def test_ten_right_ways_are_known_and_none_is_refused(task):
    """With the reference and the plain way that the slips are made from."""
    refused = {name: answer for name, way in WAYS[task].items() if not (answer := TASKS[task](way)).right}
    assert refused == {}
    assert len({*WAYS[task].values(), *ANSWERS[task]["right"].values()}) + 2 >= 10


@pytest.mark.parametrize(("task", "function", "text"), table("wrong"))
def test_a_wrong_answer_is_named_by_its_fault(task, function, text):
    answer = told(task, function)
    assert answer.verdict == "wrong", answer
    assert text in answer.says


@pytest.mark.parametrize(("task", "function", "text"), table("error"))
def test_an_error_shows_the_input_that_broke_it(task, function, text):
    answer = told(task, function)
    assert answer.verdict == "error", answer
    assert re.match(rf"(right in \d+ of \d+ cases; raises .* For example )?{task}\(", answer.says), answer
    assert text in answer.says
    assert " in line " in answer.says or "Keep the arguments that are given" in answer.says
    with pytest.raises(Exception) as again:  # noqa: PT011
        function(*answer.args)
    assert f"raised {type(again.value).__name__}: " in answer.says


@pytest.mark.parametrize("task", TASKS)
def test_every_fault_is_told_by_a_listed_wrong_answer(task):
    says = [told(task, function).says for function, _ in ANSWERS[task]["wrong"].values()]
    for fault in TASKS[task].faults:
        assert any(fault.says in each for each in says), fault.says


@pytest.mark.parametrize("task", TASKS)
@pytest.mark.parametrize(
    "nonsense",
    [None, "text", (), [], [[0], [0, 1]], {}, np.nan, np.inf, -1, True, np.zeros((0, 2)), np.full(3, np.nan), object()],
    ids=lambda value: "an object" if type(value) is object else repr(value),  # no address: it changes from run to run
)
def test_nonsense_gets_an_answer(task, nonsense):
    answer = TASKS[task](lambda *_arguments: nonsense)
    assert answer.verdict == "wrong"
    assert "0x" not in answer.says


@pytest.mark.parametrize("task", TASKS)
def test_no_function_at_all(task):
    assert repr(TASKS[task](0.5)) == f"! error: {task} must be a function, got 0.5."


@pytest.mark.parametrize("task", TASKS)
def test_the_answer_is_the_same_on_every_run(task):
    first, again = (TASKS[task](lambda *_arguments: 0.123456) for _ in range(2))
    assert first == again


@pytest.mark.parametrize("task", TASKS)
def test_a_lesson_goes_on_with_the_right_function(task):
    check = TASKS[task]
    mine, open_task = check.yours_or_ours(check.reference), check.yours_or_ours(lambda *_arguments: ...)
    assert repr(mine) == f"{task}: the lesson goes on with yours."
    assert repr(open_task) == f"{task}: the lesson goes on with the library's, because yours is: not attempted."
    args = next(iter(check.cases(np.random.default_rng(0))))
    assert check.judge(open_task(*args), check.reference(*args), args) is None


def test_what_a_function_prints_stays_quiet_and_what_numpy_warns_of_is_told(capsys):
    def talks(origin, direction, a, b):
        print("here", np.float64(1.0) / np.float64(0.0))
        return pk.checks.ray_segment.reference(origin, direction, a, b)

    answer = pk.checks.ray_segment(talks)
    assert answer.right
    assert re.search(r"cases\. But in 2\d\d of them NumPy warns: divide by zero .* in line \d+, `print\(", answer.says)
    assert capsys.readouterr().out == ""


def test_an_error_in_an_edge_case_hides_nothing():
    def drive_step(pose, left, right, seconds):
        x, y, heading = pose
        v, w = 0.0205 * (left + right) / 2, 0.0205 * (right - left) / 0.052
        after = heading + w * seconds
        radius = v / w
        return x + radius * (np.sin(after) - np.sin(heading)), y - radius * (np.cos(after) - np.cos(heading)), after

    answer = pk.checks.drive_step(drive_step)
    assert answer.says.startswith("right in 163 of 206 cases; raises ZeroDivisionError in 43. For example drive_step(")
    assert ", `radius = v / w`.\nEvery arc is right. When both wheels turn equally fast" in answer.says
    assert answer.args == ((0.0, 0.0, 0.0), 2.0, 2.0, 1.0)
    assert answer.fault == "w of zero"


def test_an_error_everywhere_says_what_it_may_come_from():
    unknown = pk.checks.circle_rms(lambda *_arguments: npp.sqrt(1))  # noqa: F821
    assert unknown.says.endswith("After a restart of the kernel, run the cells above again.")
    shapes = pk.checks.assign_points(lambda points, centers: (points - centers[:, :1].T).sum(axis=1))
    assert "which axis is which?" in shapes.says


def test_the_line_of_an_error_from_another_process_is_what_that_says():
    error = ZeroDivisionError("division by zero")
    assert own_code.line_of(error) is None
    error.where = "line 2: radius = arc(v)\nline 7: return v / w"
    assert str(own_code.line_of(error)) == "line 7, `return v / w`"
    error.where = "line 7: a\x1b[0m"
    assert own_code.line_of(error) is None


def test_a_loop_that_never_ends_is_told_and_the_others_are_not_waited_for():
    def ray_circle(origin, direction, center, radius):
        t = 0.0
        while np.hypot(*(origin + t * direction - center)) > radius:
            t += 0.001
        return t

    answer = pk.checks.ray_circle(ray_circle, 0.2)
    assert answer.fault == "out of time"
    assert " did not end: stopped after 0.2 s in line " in answer.says
    assert "Which comparison should end it?" in answer.says


def test_a_loop_that_catches_every_exception_is_stopped_too():
    def stubborn(*_arguments):
        while True:
            with contextlib.suppress(Exception):
                raise ValueError

    assert pk.checks.ray_circle(stubborn, 0.1).fault == "out of time"
    for _ in range(30):  # wherever in the loop it is stopped, its ValueError goes with it
        with pytest.raises(own_code.OutOfTime):
            own_code.call_within(0.002, stubborn)
        assert sys.exc_info() == (None, None, None)


def test_the_tracing_of_before_is_back():
    seen = sys.gettrace()
    pk.checks.ray_circle(lambda *_arguments: 0.0)
    assert sys.gettrace() is seen


def test_an_interrupt_shows_a_short_word():
    def pressed(*_arguments):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt, match=r"^Interrupted in line \d+, `raise KeyboardInterrupt`\.") as stop:
        pk.checks.ray_circle(pressed)
    assert stop.value._render_traceback_() == [str(stop.value)]


def test_a_function_of_another_name_is_told():
    """If the cell that asks defines it: a helper of the lesson may have the same arguments."""
    scope = {"check": pk.checks.ray_circle}

    def run_cell(number, name):
        code = f"def {name}(origin, direction, center, radius): return ...\nsays = check(ray_circle).says"
        exec(compile(code, f"cell {number}", "exec"), scope)
        return scope["says"]

    stub = run_cell(1, "ray_circle")
    assert stub == "ray_circle still returns `...`."
    told = "\nThis is about ray_circle. Is my_circle your answer? Then give it the name ray_circle."
    assert run_cell(2, "my_circle") == stub + told
    assert run_cell(3, "ray_circle") == stub


def test_what_is_given_may_not_change_whatever_it_is():
    def into_the_set(cells, *scan):
        cells |= pk.checks.occupy.reference(cells, *scan)
        return cells

    def into_the_list(found, true, pairs, tolerance):
        result = pk.checks.parts.reference(found, true, pairs, tolerance)
        found.clear()
        return result

    for check, mine in ((pk.checks.occupy, into_the_set), (pk.checks.parts, into_the_list)):
        assert check(mine).fault == "changes its arguments"
    given = [{1}, pk.Circle((0, 0), 1.0), pk.Polygon([(0, 0), (1, 0), (0, 1)]), np.random.default_rng(0)]
    assert judges.same(given, copy.deepcopy(given))
    assert not judges.same({1}, {2})
    assert not judges.same(pk.Circle((0, 0), 1.0), pk.Circle((0, 1), 1.0))


def test_the_arguments_that_went_wrong_can_be_tried_again():
    def circles(_found, true, _pairs, _tolerance):
        return 3 * (1.0 * all(shape.kind == "circle" for shape in true),)

    answer = pk.checks.parts(lambda *_arguments: (2.0, 2.0, 2.0))
    assert pk.checks.parts.reference(*answer.args) == (1.0, 1.0, 1.0)
    assert "a Polygon" not in pk.checks.parts(circles).says
    hidden = pk.checks.fit_line(lambda *_arguments: (0.0, 0.0))
    assert repr(hidden).endswith("\nTry it again: the arguments are _.args.")
    assert "<br>Try it again: the arguments are _.args." in hidden._repr_html_()
    assert "_.args" not in repr(pk.checks.meet(lambda *_arguments: 1.0))


def test_a_number_as_text_is_html_with_sign_and_word():
    for verdict in VERDICT_SIGNS:
        html = Answer(verdict, "a < b\nnext")._repr_html_()
        assert f"{VERDICT_SIGNS[verdict]} {verdict}" in html
        assert "a &lt; b<br>next" in html


def luminance(color):
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in color]
    return float(np.dot(linear, [0.2126, 0.7152, 0.0722]))


def rgb(color):
    return np.array([int(color[i : i + 2], 16) / 255 for i in (1, 3, 5)])


# Paper and letters of Jupyter's themes, light, dark and with high contrast, and of GitHub's pages.
THEMES = (("#ffffff", "#212121"), ("#111111", "#ffffff"), ("#212121", "#ffffff"), ("#0d1117", "#f0f6fc"))


@pytest.mark.parametrize(("paper", "letters"), THEMES)
@pytest.mark.parametrize("color", VERDICT_COLORS.values())
def test_the_verdict_can_be_read_in_a_light_theme_and_in_a_dark_one(color, paper, letters):
    ink, share = re.fullmatch(r"color-mix\(in srgb, (#\w{6}) (\d+)%, currentColor\)", color).groups()
    mixed = int(share) / 100 * rgb(ink) + (1 - int(share) / 100) * rgb(letters)
    low, high = sorted([luminance(mixed), luminance(rgb(paper))])
    assert (high + 0.05) / (low + 0.05) >= 4.5


def test_a_faulty_way_that_cannot_do_every_case_names_no_fault():
    check = Check("f", abs, lambda _rng: [(1.0,), (-1.0,)], judges.number(), (Fault("never", like=lambda _x: 1 / 0),))
    assert check(lambda x: x).says == "in 1 of 2 cases. For example f(x=-1): got -1, expected 1."


CIRCLE, LINE = pk.Circle((1, 2), 0.5), pk.fit_line([(0, 1), (1, 2)])
JUDGED = [
    ("number, right", judges.number("m"), 1, 1.0, None),
    ("number, an array of one", judges.number("m"), [1.0], 1.0, r"got \[1\], expected a number such as 1 m"),
    ("number, off", judges.number("m"), 2.0, 1.0, "got 2 m, expected 1 m"),
    ("number, infinite", judges.number("m"), np.inf, 1.0, "got inf m, expected 1 m"),
    ("number, both infinite", judges.number("m"), np.inf, np.inf, None),
    ("number, the other infinity", judges.number("m"), -np.inf, np.inf, "got -inf m, expected inf m"),
    ("number, nan", judges.number(), np.nan, 1.0, "got nan, expected 1"),
    ("array, right", judges.array(), [[1, 2]], [[1.0, 2.0]], None),
    ("array, shape", judges.array(), [1, 2], [[1.0, 2.0]], r"got an array of shape \(2,\), expected shape \(1, 2\)"),
    ("array, off", judges.array("m"), [1.0, 5.0], [1.0, 2.0], r"got 5 m at \[1\], expected 2 m"),
    ("array, nan", judges.array(), [1.0, np.nan, 7.0], [1.0, np.inf, 2.0], r"got nan at \[1\], expected inf"),
    ("groups, renamed", judges.groups(), [5, 5, 2], [0, 0, 1], None),
    ("groups, one for two", judges.groups(), [0, 0, 0], [0, 0, 1], "got 1 groups, expected 2"),
    ("groups, mixed", judges.groups(), [0, 1, 0, 1], [0, 0, 1, 1], "not every point is with its own"),
    ("groups, strays", judges.groups(), [0, 0, -1], [0, 0, 1], "got 1 strays, expected 0"),
    ("groups, too few", judges.groups(), [0, 0], [0, 0, 1], "expected one label for each of the 3 points"),
    ("points, other order", judges.points_in_any_order(), [(0, 1), (0, 0)], [(0, 0), (0, 1)], None),
    (
        "points, twice the same",
        judges.points_in_any_order(),
        [(0, 0), (0, 0)],
        [(0, 0), (0, 1)],
        r"got \(0, 0\) m, exp",
    ),
    ("points, too few", judges.points_in_any_order(), [(0, 0)], [(0, 0), (0, 1)], "got 1 points, expected 2"),
    ("points, nan", judges.points_in_any_order(), [(0, np.nan)], [(0, 0)], "expected finite numbers"),
    ("circle, right", judges.circle(), (1, 2, 0.5), CIRCLE, None),
    ("circle, in two parts", judges.circle(), ((1, 2), 0.5), CIRCLE, None),
    ("circle, small", judges.circle(), (1, 2, 0.4), CIRCLE, r"got a radius of 0.4 m, expected 0.5 m \(-20 %\)"),
    ("circle, aside", judges.circle(), (1, 2.001, 0.5), CIRCLE, "the centre is off by 1 mm"),
    ("circle, none", judges.circle(), None, None, None),
    ("circle, none but one", judges.circle(), None, CIRCLE, "got None, expected Circle"),
    ("line, right", judges.line(), LINE.turned_round(), LINE, None),
    ("line, turned", judges.line(), (LINE.angle + np.radians(10), LINE.offset), LINE, "turned by 10 degrees"),
    ("line, shifted", judges.line(), (LINE.angle, LINE.offset + 0.001), LINE, "off by 1 mm"),
    ("line, no line", judges.line(), 3, LINE, "got 3, expected a line"),
]


@pytest.mark.parametrize(("judge", "got", "expected", "text"), [row[1:] for row in JUDGED], ids=[r[0] for r in JUDGED])
def test_a_judge_says_what_is_off(judge, got, expected, text):
    off = judge(got, expected, ())
    assert off is None if text is None else re.search(text, off), off


def test_the_stub_in_a_lesson_has_the_argument_names_of_its_check():
    """What an error quotes are the names that a student has before them."""
    import json

    found = set()
    for notebook in sorted((FOLDER.parent.parent / "notebooks").glob("*.ipynb")):
        for cell in json.loads(notebook.read_text(encoding="utf-8"))["cells"]:
            if cell["cell_type"] != "code":
                continue
            for node in ast.walk(ast.parse("".join(cell["source"]))):
                if isinstance(node, ast.FunctionDef) and node.name in TASKS:
                    names = TASKS[node.name].reference.__code__.co_varnames
                    mine = [argument.arg for argument in node.args.args]
                    assert list(itertools.islice(names, len(mine))) == mine
                    found.add(node.name)
    assert found <= set(TASKS)


def test_an_argument_that_was_left_out_is_named_as_that():
    answer = TASKS["drive_step"](lambda pose: pose)
    assert answer.says.endswith("\nKeep the arguments that are given: drive_step(pose, left, right, seconds).")
    assert answer.fault == "asks for other arguments"
    inside = TASKS["drive_step"](lambda *_arguments: (lambda one: one)())
    assert inside.fault == "raises TypeError"


@pytest.mark.parametrize("style", STYLES)
@pytest.mark.parametrize("task", TASKS)
def test_a_right_answer_is_right_in_every_form(task, style):
    answer = TASKS[task](styled(getattr(right, task))[style])
    assert answer.right, answer
