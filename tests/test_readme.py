"""The README keeps its word: its program runs, its table is what the command line prints, its pictures are there."""

import linecache
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from primkit import checks

MOST_WORDS, WORDS_BEFORE_IT_RUNS = 700, 200

ROOT = Path(__file__).resolve().parent.parent
README = (ROOT / "README.md").read_text(encoding="utf-8")
CONTRIBUTING = (ROOT / ".github" / "CONTRIBUTING.md").read_text(encoding="utf-8")


def blocks(language):
    return re.findall(rf"^```{language}\n(.*?)^```", README, re.MULTILINE | re.DOTALL)


@pytest.fixture(scope="module")
def table():
    """The table in the README; line endings and trailing blanks aside."""
    (text,) = blocks("text")
    return text.rstrip()


def test_the_program_in_the_readme_prints_the_table_in_the_readme(table):
    (program,) = blocks("python")
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True, cwd=ROOT)
    assert run.stdout.rstrip() == table


@pytest.mark.parametrize("marker", ["map", "map on Windows"])
def test_the_main_command_prints_the_table_in_the_readme(marker, table, tmp_path):
    """The last command after the marker, without its environment and with another folder."""
    block = re.search(rf"<!-- ci: {marker} -->\n```\w+\n(.*?)```", README, re.DOTALL)[1]
    words = re.split(r"&&|\n", block.strip())[-1].split()
    assert re.fullmatch(r".*primkit", words[0])
    assert words[-2:] == ["--out", "out"]
    command = [sys.executable, "-m", "primkit", *words[1:-1], str(tmp_path)]
    run = subprocess.run(command, capture_output=True, text=True, check=True, cwd=ROOT)
    assert table in run.stdout
    assert {path.name for path in tmp_path.iterdir()} == {"map.png", "found.geojson", "truth.geojson"}


def test_the_check_says_of_the_answer_what_the_readme_says():
    """As in a notebook, where a check can read the lines of what was written."""
    (task,), (verdict,) = blocks("py"), blocks("verdict")
    linecache.cache["cell"] = (len(task), None, task.splitlines(keepends=True), "cell")
    scope = {"np": np}
    exec(compile(task, "cell", "exec"), scope)
    assert str(checks.ray_circle(scope["ray_circle"])) == verdict.rstrip()


@pytest.mark.parametrize("name", ["README.md", ".github/CONTRIBUTING.md", ".github/CHANGELOG.md", ".site/results.md"])
def test_every_file_that_a_page_names_is_there(name):
    text, folder = (ROOT / name).read_text(encoding="utf-8"), (ROOT / name).parent
    named = re.findall(r"\]\(([^)#:]+)\)", text)
    assert [name for name in named if not (folder / name).exists()] == []
    assert [name for name in re.findall(r"notebooks/[\w/.]+\.ipynb", text) if not (ROOT / name).exists()] == []


def test_the_front_page_is_short_and_runs_early():
    """In words, as a reader meets them: no comments, code or tables."""
    shown = re.sub(r"<!--.*?-->|^```.*?^```|^\|.*?$|!\[.*?\]\(.*?\)", " ", README, flags=re.MULTILINE | re.DOTALL)
    assert len(shown.split()) <= MOST_WORDS
    before = re.sub(r"<!--.*?-->|!\[.*?\]\(.*?\)", " ", README[: README.index("<!-- ci: map -->")], flags=re.DOTALL)
    assert len(before.split()) <= WORDS_BEFORE_IT_RUNS


def test_every_picture_has_a_text_in_its_place():
    assert all(len(text) > 20 for text in re.findall(r"!\[(.*?)\]", README))


def test_the_tables_of_modules_name_every_room():
    rooms = {p.stem for p in (ROOT / "primkit").iterdir() if p.suffix == ".py" or (p / "__init__.py").exists()}
    rooms_told = CONTRIBUTING.index("| room | what it is |")
    story = CONTRIBUTING[CONTRIBUTING.index("| step | module |") : rooms_told]
    rest = CONTRIBUTING[rooms_told : CONTRIBUTING.index("To add a shape")]
    assert {room for room in rooms if f"`{room}`" not in story and f"`{room}" not in rest} <= {"__main__"}


def test_nothing_advises_the_package_that_has_this_name_on_pypi():
    """The name is somebody else's there: no page, message or notebook may send anybody to it."""
    spoken = [
        *ROOT.glob("*.md"),
        *ROOT.glob(".*/*.md"),
        *(ROOT / "primkit").rglob("*.py"),
        *(ROOT / "notebooks").rglob("*.md"),
    ]
    spoken += (ROOT / "notebooks").rglob("*.ipynb")
    advice = re.compile(r"pip install\b(?:(?!-e |no-index)[^\n|`])*[\"' ]primkit(?:\[|[\"'`]|\s|$)")
    assert [str(path) for path in spoken if advice.search(path.read_text(encoding="utf-8"))] == []
    assert advice.search('python -m pip install "primkit[teach]"')
    assert advice.search("pip install primkit")
