"""Predictions: a guess is asked for, kept before the answer is seen, drawn into it, and listed in the end."""

import json
import re
from pathlib import Path

import pytest

import primkit as pk
from primkit.widgets.predictions import KEPT_IN, questions
from primkit.widgets.svg import size_of
from tests.helpers import words_in
from tests.test_notebooks import LESSONS, load, section, source

NAMES = list(questions())


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def controls(name):
    """The control of a question, and what is said of it."""
    _ask, control, said, _attendant = pk.widgets.predict(name).panel().children
    return control, said


def a_guess(question):
    return question.options[0].says if question.options else question.high


def an_answer(question):
    option = question.options and question.options[-1]
    return option.value or option.says if option else question.low


@pytest.mark.parametrize("name", NAMES)
def test_a_guess_is_kept_drawn_into_the_answer_and_listed(name):
    question = questions()[name]
    control, said = controls(name)
    assert "kept" not in said.value
    control.value = a_guess(question)
    assert "kept until the answer" in said.value
    assert controls(name)[0].value == a_guess(question), "another page, or the kernel restarted"
    picture = pk.widgets.answer(**{name: an_answer(question)})
    assert f"Your guess: {question.words(a_guess(question))}." in words_in(picture._repr_html_())[0]
    assert picture.svg.count("#D55E00") >= 1, "the guess is drawn"
    ((lesson, _, guess, out, verdict),) = pk.widgets.guesses().rows
    assert (lesson, guess) == (question.lesson, question.words(a_guess(question)))
    assert out == question.words(an_answer(question))
    assert verdict == ("not so" if question.options else f"off by {question.words(question.high - question.low)}")


def test_after_the_answer_another_guess_is_not_kept():
    control, said = controls("closest")
    control.value = "the circle"
    pk.widgets.answer(closest="now this, now that")
    control.value = "now this, now that"
    assert "it stays" in said.value
    assert pk.widgets.guesses().rows[0][2::2] == ("the circle", "not so")
    assert pk.widgets.guesses().notes == ["0 of 1 choices were right."]


def test_two_answers_stand_below_each_other():
    both = pk.widgets.answer(apart=0.0188, along="farther apart")
    one = pk.widgets.answer(apart=0.0188)
    assert size_of(both.svg)[1] == 2 * size_of(one.svg)[1]
    assert words_in(both._repr_html_())[0].count("You made no guess.") == 2


def test_a_number_is_the_option_that_is_nearest_by_ratio():
    controls("apart")[0].value = "2 cm"
    assert "2 cm (your guess) \u2190 so it is" in pk.widgets.answer(apart=0.0188).svg
    assert pk.widgets.guesses().rows[0][-1] == "right"


def test_who_does_not_guess_leaves_no_file(folder):
    pk.widgets.predict("score", "closest").panel()
    assert "You made no guess" in repr(pk.widgets.answer(score=0.07))
    assert list(folder.iterdir()) == []
    assert pk.widgets.guesses().rows == []


@pytest.mark.parametrize("text", ["", "{", "[]", "{}", "[3]", '[{"name": "gone", "guess": 1}]', '[{"name": "score"}]'])
def test_a_file_that_is_none_of_guesses_is_as_good_as_none(text):
    Path(KEPT_IN).write_text(text)
    assert pk.widgets.guesses().rows == []
    control, _ = controls("score")
    control.value = 0.5
    assert [one["guess"] for one in json.loads(Path(KEPT_IN).read_text())] == [0.5]


def test_what_cannot_be_kept_is_told():
    Path(KEPT_IN).mkdir()
    control, said = controls("score")
    control.value = 0.5
    assert said.value.startswith("It cannot be kept: ")


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: pk.widgets.predict("luck"), f"name must be one of {', '.join(NAMES)}, got 'luck'"),
        (
            lambda: pk.widgets.answer(closest="me"),
            "the answer to 'closest' must be one of the circle, the pentagon, ",
        ),
        (lambda: pk.widgets.answer(closest=3.0), "the answer to 'closest' must be one of the circle, "),
        (lambda: pk.widgets.answer(score="high"), "the answer to 'score' must be a number, got 'high'"),
        (lambda: pk.widgets.answer(score=float("nan")), "the answer to 'score' must be a number, got nan"),
    ],
)
def test_what_is_no_question_and_no_answer_is_refused(call, message):
    with pytest.raises(ValueError, match=re.escape(message)):
        call()


@pytest.mark.parametrize("name", LESSONS)
def test_each_lesson_asks_its_questions_and_answers_them_later(name):
    cells = [source(cell) for cell in load(name)["cells"] if cell["cell_type"] == "code"]
    asked = [names for cell in cells for names in re.findall(r"pk\.widgets\.predict\((.*?)\)", cell)]
    of_lesson = [one.name for one in questions().values() if one.lesson == name[:2]]
    assert [word.strip('"') for names in asked for word in names.split(", ")] == of_lesson
    place = next(k for k, cell in enumerate(cells) if "widgets.predict(" in cell)
    for question in of_lesson:
        assert any(re.search(rf"pk\.widgets\.answer\(.*?\b{question}=", cell) for cell in cells[place + 1 :]), question


@pytest.mark.parametrize("name", [name for name in LESSONS if name[:2] != "00"])
def test_a_quiz_has_the_form_of_a_question_and_one_right_option_each(name):
    found = pk.widgets.read_quiz(section(load(name), "Quiz"))
    assert 3 <= len(found) <= 5
    for question in found:
        assert sum(option.right for option in question.options) == 1, question
        assert all(len(option.why.split()) >= 3 for option in question.options), question
