"""The lessons' form: nbval compares their outputs, and passes what it has nothing to compare with; this does not."""

import json
import re
from itertools import pairwise
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
LESSONS = sorted((ROOT / "notebooks").glob("*.ipynb"))


@pytest.fixture(params=LESSONS, ids=[lesson.stem for lesson in LESSONS])
def lesson(request):
    return json.loads(request.param.read_text(encoding="utf-8")) | {"size": request.param.stat().st_size}


def code_cells(lesson):
    return [cell for cell in lesson["cells"] if cell["cell_type"] == "code"]


def text(lesson):
    return "\n\n".join("".join(cell["source"]) for cell in lesson["cells"] if cell["cell_type"] == "markdown")


def test_there_is_a_lesson():
    assert LESSONS


def test_every_code_cell_was_run_in_order(lesson):
    assert [cell["execution_count"] for cell in code_cells(lesson)] == list(range(1, len(code_cells(lesson)) + 1))


def test_no_cell_failed_and_none_is_silent_without_reason(lesson):
    for cell in code_cells(lesson):
        assert all(output["output_type"] != "error" for output in cell["outputs"])
        assert cell["outputs"], "a cell without output is compared with nothing: " + "".join(cell["source"])


def test_no_cell_calls_the_shell_or_is_too_long(lesson):
    for cell in code_cells(lesson):
        lines = "".join(cell["source"]).splitlines()
        assert not any(line.lstrip().startswith(("!", "%")) for line in lines)
        assert len(lines) <= 20


def test_one_title_and_headings_in_order(lesson):
    levels = [len(marks) for marks in re.findall(r"^(#+) ", text(lesson), re.MULTILINE)]
    assert levels[0] == 1
    assert levels.count(1) == 1
    assert all(after <= before + 1 for before, after in pairwise(levels))


def test_every_picture_is_followed_by_what_it_shows(lesson):
    cells = lesson["cells"]
    for cell, following in zip(cells, [*cells[1:], {"cell_type": "none", "source": ""}], strict=True):
        shows = any("image/png" in output.get("data", {}) for output in cell.get("outputs", []))
        if shows:
            assert "".join(following["source"]).startswith("*Figure: "), "".join(cell["source"])


def test_budget(lesson):
    assert len(lesson["cells"]) <= 40
    assert len(text(lesson).split()) <= 2000
    assert lesson["size"] <= 1_000_000
