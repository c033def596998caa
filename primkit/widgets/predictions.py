r"""Predictions: guess before you look. A guess is asked for by a control, kept, and drawn onto the answer.

In:  the lessons' questions (``predictions.json``), what a student chooses, and later what came out.
Out: a control; a picture with both; and a table of all guesses, over all lessons.

>>> answer(radius=52.0)
Answer: The median radius of 200 views: 52 mm. You made no guess.
>>> quiz = "**1. Is it a square?** <details><summary>Yes</summary>Right: four right angles.</details>"
>>> read_quiz(quiz)[0].options
(Option(says='Yes', why='Right: four right angles.', right=True, value=None),)

A prediction and a quiz's question have one form in JSON, ``Question``: an option of a quiz says whether it is right and
why, of a prediction that is left to the experiment. Guesses are kept in ``my_guesses.json`` beside the notebook. The
first guess counts: once the answer has been seen, another one is not kept.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cache, partial
from html import escape
from pathlib import Path
from typing import Any

import numpy as np

from ..arguments import short
from ..formats.files import write_atomically
from ..palette import BLUE, GREY, INK, PALE, VERMILION
from ..table import Table
from .drawing import stacked
from .slider import Picture
from .svg import as_svg, path, what_it_says, words_at

KEPT_IN = "my_guesses.json"
ANSWER_WIDTH, OPTION_ROW = 425, 26  # px: of the picture, and of an option in it
RIGHT = re.compile(r"(Right|Yes)\b")  # how the feedback to a quiz's right option begins


@dataclass(frozen=True)
class Option:
    """What can be chosen: ``value`` in the question's unit, if it has one; ``right`` and ``why`` in a quiz."""

    says: str
    why: str = ""
    right: bool | None = None
    value: float | None = None


@dataclass(frozen=True)
class Question:
    """What is asked: with options, or for a number from ``low`` to ``high``, in steps."""

    name: str
    ask: str
    options: tuple[Option, ...] = ()
    lesson: str = field(default="", repr=False)
    low: float = field(default=0.0, repr=False)
    high: float = field(default=1.0, repr=False)
    step: float = field(default=0.1, repr=False)
    unit: str = field(default="", repr=False)

    @classmethod
    def of(cls, told: dict[str, Any]) -> Question:
        """Return the question that JSON tells of."""
        return cls(**told | {"options": tuple(Option(**option) for option in told.get("options", ()))})

    def words(self, value: float | str) -> str:
        """Return a guess or an answer in words."""
        return value if isinstance(value, str) else f"{value:.3g} {self.unit}".rstrip()

    def option_of(self, value: float | str) -> str:
        """Return the option that a value is, or the nearest one by ratio; of no option, None."""
        if isinstance(value, str):
            return value
        with_value = [(abs(np.log(max(value, 1e-9) / o.value)), o.says) for o in self.options if o.value]
        return min(with_value)[1]

    def check(self, value: float | str) -> None:
        """Refuse what cannot be an answer."""
        says = [option.says for option in self.options]
        number = isinstance(value, int | float | np.number) and bool(np.isfinite(value))
        if not (value in says or (number and (not says or self.options[0].value is not None))):
            rule = f"one of {', '.join(says)}" if says else "a number"
            raise ValueError(f"the answer to {self.name!r} must be {rule}, got {short(value)}")


def read_quiz(text: str) -> list[Question]:
    """Return the questions of a lesson's quiz, as they stand in its Markdown."""
    parts = re.split(r"^\*\*(\d)\. ", text, flags=re.MULTILINE)[1:]
    found = []
    for number, question in zip(parts[::2], parts[1::2], strict=True):
        options = re.findall(r"<details><summary>(.+?)</summary>(.*?)</details>", question, re.DOTALL)
        told = tuple(Option(says, why.strip(), bool(RIGHT.match(why.strip()))) for says, why in options)
        found.append(Question(number, " ".join(question.split("**")[0].split()), told))
    return found


@cache
def questions() -> dict[str, Question]:
    """Return what the lessons ask beforehand, by name, in the order of the lessons."""
    told = json.loads(Path(__file__).with_suffix(".json").read_text(encoding="utf-8"))
    return {one["name"]: Question.of(one) for one in told}


def predict(*names: str) -> Predictions:
    """Show a control for each question, by name; what is chosen is kept.

    Raises ValueError if there is no such question.
    """
    return Predictions(tuple(_question(name) for name in names))


def answer(**came_out: float | str) -> Picture:
    """Return the picture of what came out, with the guesses in it.

    Raises ValueError if there is no such question, or a value cannot be an answer to it.

    Parameters
    ----------
    **came_out : float or str
        For each question, by name, a number in its unit or one of its options.
    """
    drawn = [_answered(_question(name), value) for name, value in came_out.items()]
    return Picture(stacked(drawn), " ".join(["Answer:", *map(what_it_says, drawn)]))


def _answered(question: Question, value: float | str) -> str:
    """Draw the answer to one question with the guess in it; from now on the guess stays."""
    question.check(value)
    guess = _kept().get(question.name, {}).get("guess")
    if guess is not None:
        with suppress(OSError):  # a folder that nothing can be written to: the picture shows it all the same
            _keep(question.name, answer=value if isinstance(value, str) else float(value))
    draw = _draw_options if question.options else _draw_line
    yours = "You made no guess." if guess is None else f"Your guess: {question.words(guess)}."
    return draw(question, guess, value, f"{question.ask} {question.words(value)}. {yours}")


def guesses() -> Table:
    """Return all guesses so far beside what came out, over all lessons."""
    rows, right, choices = [], 0, 0
    for name, kept in _kept().items():
        question, guess, out = questions()[name], kept["guess"], kept.get("answer")
        row = (question.lesson, question.ask, question.words(guess))
        if out is None:
            rows.append((*row, "not looked at yet", ""))
            continue
        if question.options:
            hit = guess == question.option_of(out)
            verdict, choices, right = ("right" if hit else "not so"), choices + 1, right + hit
        else:
            verdict = f"off by {question.words(abs(guess - out))}"
        rows.append((*row, question.words(out), verdict))
    notes = [f"{right} of {choices} choices were right."] if choices else ["Each lesson asks: predict first."]
    return Table(("lesson", "question", "your guess", "came out", ""), rows, title="Your guesses", notes=notes)


class Predictions:
    """Controls for some questions; ``predict`` makes them."""

    def __init__(self, asked: tuple[Question, ...]) -> None:
        self.asked = asked

    def panel(self) -> Any:
        """Return the widget: a row for each question."""
        from .panel import attended

        parts = [part for question in self.asked for part in self._row(question)]
        return attended(parts, sum(not question.options for question in self.asked)).add_class("primkit-predict")

    def _row(self, question: Question) -> tuple[Any, ...]:
        import ipywidgets

        kept = _kept().get(question.name, {})
        said = ipywidgets.HTML(_said(kept))
        ask = ipywidgets.HTML(f"<b>{escape(question.ask)}</b>")
        guessed: Callable[[Any], None] = partial(_guessed, question.name, said)
        if question.options:
            wide: dict[str, Any] = {"style": {"button_width": "auto"}, "layout": {"max_width": "calc(100% - 4px)"}}
            options = [option.says for option in question.options]
            buttons = ipywidgets.ToggleButtons(options=options, value=kept.get("guess"), **wide)
            buttons.observe(lambda change: guessed(change.new), names="value")
            return ask, buttons, said
        whole = float(question.step).is_integer()
        kind = ipywidgets.IntSlider if whole else ipywidgets.FloatSlider
        ends = {"min": question.low, "max": question.high, "step": question.step}
        fits = {"continuous_update": False, "layout": {"max_width": "calc(100% - 4px)"}}
        slider = kind(kept.get("guess", question.low), description=question.unit, **ends, **fits)
        slider.observe(lambda change: guessed(change.new), names="value")
        return ask, slider, said

    def _repr_mimebundle_(self, **_kinds: Any) -> dict[str, Any]:
        """Show the panel; stored as text it is one line that does not change from run to run."""
        from .panel import shown

        return shown(self.panel(), repr(self))

    def __repr__(self) -> str:
        return "Predict: " + " ".join(question.ask for question in self.asked)


def _guessed(name: str, said: Any, value: float | str) -> None:
    """Keep a guess, unless its answer has been seen; say what became of it."""
    kept = _kept().get(name, {})
    try:
        if "answer" not in kept:
            kept = _keep(name, guess=value)
        said.value = _said(kept)
    except OSError as error:
        said.value = escape(f"It cannot be kept: {error}")


def _said(kept: dict[str, Any]) -> str:
    words = (
        "kept; the answer has been seen, so it stays" if "answer" in kept else "kept until the answer" if kept else ""
    )
    return f'<span aria-live="polite">{words}</span>'


def _question(name: str) -> Question:
    if name not in questions():
        raise ValueError(f"name must be one of {', '.join(questions())}, got {short(name)}")
    return questions()[name]


def _kept() -> dict[str, dict[str, Any]]:
    """Return the guesses by the names of their questions, and the answers that were seen; what is none is left out."""
    try:
        told = json.loads(Path(KEPT_IN).read_text(encoding="utf-8"))
        kept = {one["name"]: one for one in told if "guess" in one}
    except (OSError, ValueError, TypeError, KeyError):
        return {}
    return {name: kept[name] for name in questions() if name in kept}


def _keep(name: str, **what: float | str) -> dict[str, Any]:
    """Write a guess, or what came out, to the file; return all that it then has of this question."""
    kept = _kept()
    kept[name] = {"name": name, **kept.get(name, {}), **what}
    write_atomically(KEPT_IN, json.dumps(list(kept.values()), indent=1, ensure_ascii=False) + "\n")
    return kept[name]


def _draw_options(question: Question, guess: str | None, value: float | str, says: str) -> str:
    """Draw the options below each other: what came out is a full square, the guess a ring around it or another."""
    out, parts = question.option_of(value), []
    for row, option in enumerate(question.options):
        y = 40 + OPTION_ROW * row
        is_out = option.says == out
        parts.append(path(f"M18 {y - 7}h14v14h-14Z", stroke=GREY, fill=BLUE if is_out else "white"))
        if option.says == guess:
            parts.append(path(f"M12 {y}a13 13 0 1 0 26 0a13 13 0 1 0 -26 0", stroke=VERMILION, stroke_width=2.5))
        mark = " \u2190 so it is" if is_out else ""
        yours = " (your guess)" if option.says == guess else ""
        parts.append(words_at(48, y + 5, option.says + yours + mark, color=INK, size=14, bold=is_out))
    tall = 40 + OPTION_ROW * len(question.options)
    return as_svg(ANSWER_WIDTH, tall, question.ask, says, _heading(question) + "".join(parts))


def _draw_line(question: Question, guess: float | None, value: float | str, says: str) -> str:
    """Draw a line of numbers: what came out below it, the guess above it."""
    number = float(value)
    low, high = min(question.low, number), max(question.high, number)

    def x_of(place: float) -> float:
        return round(30 + (ANSWER_WIDTH - 60) * (place - low) / (high - low), 1)

    x, parts = x_of(number), [path(f"M30 62H{ANSWER_WIDTH - 30}", stroke=PALE, stroke_width=3)]
    parts += [words_at(x_of(end), 106, f"{end:g}", anchor="middle") for end in (low, high)]
    parts.append(path(f"M{x} 66l7 12h-14Z", fill=BLUE))
    at = min(max(x, 90), ANSWER_WIDTH - 90)
    parts.append(words_at(at, 94, f"it is {question.words(number)}", color=BLUE, anchor="middle", size=14, bold=True))
    if guess is not None:
        g = x_of(guess)
        parts.append(path(f"M{g} 58l7 -12h-14Z", fill=VERMILION))
        at = min(max(g, 90), ANSWER_WIDTH - 90)
        parts.append(words_at(at, 41, f"you: {question.words(guess)}", color=VERMILION, anchor="middle", size=14))
    return as_svg(ANSWER_WIDTH, 112, question.ask, says, _heading(question) + "".join(parts))


def _heading(question: Question) -> str:
    size = min(14.0, round(ANSWER_WIDTH / (0.62 * len(question.ask)), 1))
    return words_at(10, 18, question.ask, color=INK, size=size, bold=True)
