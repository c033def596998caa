"""The rules report what is broken, and nothing else."""

import re

import pytest

from . import broken
from .lab import blank_notebook, opened
from .test_lessons import RULES


@pytest.fixture(scope="module")
def lesson(lab, folder):
    (folder / "notebooks" / "broken.ipynb").write_text(blank_notebook(broken.CELLS))
    with opened(lab, "broken", slider_cells=4) as lesson:
        lesson.slider_cells += 1  # as if one were not shown, without the wait for it
        yield lesson


@pytest.mark.parametrize("rule", RULES)
def test_a_rule_reports_what_is_broken(lesson, rule):
    breaches = list(RULES[rule](lesson))
    expected = broken.BREACHES[rule]
    assert len(breaches) == len(expected), breaches
    for pattern, breach in zip(expected, breaches, strict=True):
        assert re.fullmatch(pattern, breach)
