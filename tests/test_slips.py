"""Slips: which of them a check names, in which line, and what it says when it cannot know."""

import json
import linecache
import os
import re
import textwrap
import time
from collections import Counter

import numpy as np
import pytest

import primkit as pk
from primkit.checks import Check, judges, slips
from primkit.checks import answer as answers
from primkit.course.grading.workers import SLIPS_SECONDS, Remote
from tests.slips import make, named, right
from tests.test_judge import afar, needs_fork, remote

CHECKS = named.checks()
MUTANTS = make.mutants()
LESSONS = {task.name for task in pk.checks.TASKS}
OPEN = [slip for slip in MUTANTS if slip["half"] == "open" and slip["task"] in LESSONS][::3]  # all: tests.slips.named
TO_NAME = 0.9


def written(source, **names):
    """Return the function that a student wrote in a cell."""
    source = textwrap.dedent(source)
    file, scope = f"<cell {len(linecache.cache)}>", {"np": np, "pk": pk, "__name__": "__main__", **names}
    linecache.cache[file] = (len(source), None, source.splitlines(keepends=True), file)
    exec(compile(source, file, "exec"), scope)
    return scope[re.findall(r"^def (\w+)", source, re.MULTILINE)[-1]]


def test_the_list_is_what_the_script_makes():
    rows = json.loads((make.FOLDER / "slips.json").read_text(encoding="utf-8"))
    assert rows == [{key: value for key, value in slip.items() if key != "code"} for slip in MUTANTS]
    assert Counter(row["task"] for row in rows) == dict.fromkeys(CHECKS, make.EACH)
    assert len(CHECKS) == 44


@pytest.mark.parametrize("task", sorted(LESSONS))
def test_what_the_slips_are_made_of_is_right(task):
    assert CHECKS[task][0](getattr(right, task)).right


@pytest.mark.parametrize("name", sorted(make.EQUIVALENT))
def test_what_is_taken_out_passes(name):
    slip = next(slip for slip in MUTANTS if slip["name"] == name)
    assert named.verdict(slip, CHECKS) == ("right", "")


def test_a_slip_in_a_lesson_s_task_is_named():
    told = {slip["name"]: named.verdict(slip, CHECKS)[0] for slip in OPEN if slip["name"] not in make.EQUIVALENT}
    assert "right" not in told.values(), told
    assert sum(word == "named" for word in told.values()) >= TO_NAME * len(told), told


def test_the_word_must_not_come_from_the_quoted_line():
    slip = {"name": "x", "task": "f", "class": "axis", "code": "def f(x):\n    return x.sum(axis=0)"}
    check = pk.checks.Check("f", lambda x: x + 1, lambda _rng: [(np.ones(2),)], pk.checks.judges.array())
    word, says = named.verdict(slip, {"f": [check]})
    assert word == "missed", says


SEGMENT = """
    def ray_segment(origin, direction, a, b):
        side, to_a = b - a, a - origin
        cross = direction[0] * side[1] - direction[1] * side[0]
        if cross == 0:
            return np.inf
        t = (to_a[0] * side[1] - to_a[1] * side[0]) / cross
        s = (to_a[0] * direction[1] - to_a[1] * direction[0]) / cross
        return t if t >= 0 and 0 <= s <= 1 else np.inf
"""
STUDENTS = [  # (task, what the student wrote, the line, words in what is told)
    ("ray_segment", SEGMENT.replace("t >= 0", "t <= 0"), 9, "a comparison"),
    ("ray_segment", SEGMENT.replace("0 <= s <= 1", "0 < s < 1"), 9, "a comparison"),
    ("ray_segment", SEGMENT.replace("a - origin", "origin - a"), 3, "an order"),
    (
        "line_through",
        """
        def line_through(p, q):
            if np.all(p == q):
                return None
            angle = np.degrees(np.arctan2(q[1] - p[1], q[0] - p[0])) + 90
            n = np.array([np.cos(np.radians(angle)), np.sin(np.radians(angle))])
            return angle, n @ p
        """,
        7,
        "degrees and radians",
    ),
    (
        "line_through",
        """
        def line_through(p, q):
            if np.all(p == q):
                return None
            angle = np.arctan2(q[0] - p[0], q[1] - p[1]) + np.pi / 2
            return angle, p @ np.array([np.cos(angle), np.sin(angle)])
        """,
        5,
        "an order",
    ),
    (
        "sides_and_centroid",
        """
        def sides_and_centroid(corners):
            after = np.roll(corners, -1)
            cross = corners[:, 0] * after[:, 1] - after[:, 0] * corners[:, 1]
            sides = np.hypot(*(after - corners).T)
            return sides, ((corners + after) * cross[:, None]).sum(axis=0) / (3 * cross.sum())
        """,
        3,
        "an axis",
    ),
    (
        "parts",
        """
        def parts(found, true, pairs, tolerance):
            n_center = n_shape = n_size = 0
            for f, t in pairs:
                n_center += sum(found[f].centroid - true[t].centroid <= tolerance)
                if found[f].kind == true[t].kind:
                    n_shape += 1
                    errors = [
                        np.abs(np.roll(found[f].dimensions, n) - true[t].dimensions)
                        for n in range(len(true[t].dimensions))
                    ]
                    n_size += sum(min(errors, key=sum) <= tolerance)
            sizes = sum(len(shape.dimensions) for shape in true)
            alarms = len(found) - len(pairs)
            return n_shape / (len(true) + alarms), n_center / (2 * len(true)), n_size / sizes
        """,
        5,
        "a sign",
    ),
]


@pytest.mark.parametrize(("task", "source", "line", "words"), STUDENTS)
def test_a_slip_is_told_with_its_line(task, source, line, words):
    answer = CHECKS[task][0](written(source))
    assert words in answer.says, answer
    assert f" at line {line}, `" in answer.says, answer


def test_two_slips_at_once_are_told_one_after_the_other(monkeypatch):
    monkeypatch.setattr(answers, "SEARCH_SECONDS", 60.0)  # two searches, which may take long where coverage is counted
    two = SEGMENT.replace("t >= 0", "t <= 0").replace("if cross == 0", "if cross <= 0")
    says = CHECKS["ray_segment"][0](written(two)).says
    first, then = re.search(r"Look at (.*)\. \d+ of the \d+ come from there\. Then look at (.*)\.", says).groups()
    assert {first[:6], then[:6]} == {"line 5", "line 9"}


def test_a_slip_in_a_helper_is_found():
    source = """
        def cross(u, v):
            return u[0] * v[1] + u[1] * v[0]

        def ray_segment(origin, direction, a, b):
            side, to_a = b - a, a - origin
            if cross(direction, side) == 0:
                return np.inf
            t, s = (cross(to_a, other) / cross(direction, side) for other in (side, direction))
            return t if t >= 0 and 0 <= s <= 1 else np.inf
    """
    assert (
        "\nLook at line 3, `return u[0] * v[1] + u[1] * v[0]`: a sign" in CHECKS["ray_segment"][0](written(source)).says
    )


@needs_fork
def test_a_slip_is_told_from_afar_as_in_a_lesson():
    """The source comes as text, and what is tried runs where the student's code runs, not here."""
    marks_its_process = "def ray_segment(origin, direction, a, b, _=__import__('os').environ.update(TRIED='here')):"
    source = SEGMENT.replace("def ray_segment(origin, direction, a, b):", marks_its_process)
    with afar(ray_segment=written(source.replace("t >= 0", "t <= 0"))) as workers:
        os.environ.pop("TRIED")  # from the line above
        mine = remote(workers, "ray_segment")
        answer = CHECKS["ray_segment"][0](mine)
        assert " at line 9, `return t if t <= 0" in answer.says
        assert "a comparison" in answer.says
        assert "TRIED" not in os.environ
        assert mine.afresh()(np.zeros(2), np.array([1.0, 0.0]), np.array([1.0, 1.0]), np.array([1.0, -1.0])) == np.inf


@needs_fork
def test_all_parts_of_a_task_together_have_one_time_for_slips(monkeypatch):
    with afar(ray_segment=written(SEGMENT.replace("t >= 0", "t <= 0"))) as workers:
        mine = remote(workers, "ray_segment")
        assert "Look at" in CHECKS["ray_segment"][0](mine).says
        monkeypatch.setattr(time, "process_time", lambda now=time.process_time: now() + SLIPS_SECONDS)
        answer = CHECKS["ray_segment"][0](mine.afresh())
        assert answer.verdict == "wrong"
        assert "Look at" not in answer.says


@needs_fork
@pytest.mark.parametrize(
    "source", [[(1, "(" * 19_000)], [(1, "x" * 30_000)], [(0, "def f(x): pass")], "text", [1], None]
)
def test_a_source_that_is_none_finds_no_slip(source):
    with afar(ray_segment=lambda *_: 1.0) as workers:
        mine = remote(workers, "ray_segment")
        mine = Remote(workers, mine.cell, "ray_segment", ([], source))
        assert CHECKS["ray_segment"][0](mine).verdict == "wrong"


@pytest.mark.parametrize(("task", "constant"), [("ray_segment", np.inf), ("match_shapes", []), ("silhouette", 0)])
def test_a_constant_is_like_no_slip(task, constant):
    assert "plain way" not in CHECKS[task][0](lambda *_: constant).says


def test_where_no_code_can_be_read_it_is_compared_with_the_plain_way():
    scope = {"np": np}
    exec(textwrap.dedent(SEGMENT).replace("t >= 0", "t <= 0"), scope)
    answer = CHECKS["ray_segment"][0](scope["ray_segment"])
    assert answer.says.endswith("That is what a plain way gives with one slip in it: a comparison, or a sign.") or (
        "one slip in it: a comparison" in answer.says
    )


def test_arguments_in_another_order_are_told_where_that_is_all():
    """A first line says the same of every case: what mends a part of them is another thing."""
    source = "def mix(a, b):\n    return 2 * a + b"
    for breaks, told in ((9, True), (5, False)):
        check = Check(
            "mix",
            lambda a, b, breaks=breaks: 2 * b + a if a < breaks else a * b + 7,
            lambda _rng: [(float(a), a + 3.0) for a in range(1, 9)],
            judges.number("m"),
        )
        assert ("Look at line 1" in check(written(source)).says) is told


def test_another_idea_is_no_slip():
    """A mean of the points is no circle's centre: nothing small mends it, and nothing of the kind is said."""
    answer = CHECKS["fit_circle"][0](
        written("""
        def fit_circle(points):
            center = points.mean(axis=0)
            return *center, np.hypot(*(points - center).T).mean()
        """)
    )
    assert "Look at line" not in answer.says
    assert "one slip" not in answer.says


def test_the_tree_is_as_before_after_all_edits():
    import ast

    tree = ast.parse(textwrap.dedent(SEGMENT))
    before = ast.dump(tree)
    for rank in (0, 1):
        kinds = {kind for kind, _line in slips.edits(tree, "ray_segment", rank)}
        assert kinds <= set(make.CLASSES)
        assert ast.dump(tree) == before
