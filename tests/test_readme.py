"""The README keeps its word: its program runs, its table is what the command line prints, its pictures are there."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
README = (ROOT / "README.md").read_text(encoding="utf-8")


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


def test_every_file_that_the_readme_names_is_there():
    named = re.findall(r"\]\(([^)#:]+)\)", README) + re.findall(r"notebooks/[\w/.]+\.ipynb", README)
    assert named
    assert [name for name in named if not (ROOT / name).exists()] == []


def test_every_picture_has_a_text_in_its_place():
    assert all(len(text) > 20 for text in re.findall(r"!\[(.*?)\]", README))


def test_the_tables_of_modules_name_every_room():
    rooms = {p.stem for p in (ROOT / "primkit").iterdir() if p.suffix == ".py" or (p / "__init__.py").exists()}
    story = README[README.index("| step | module |") : README.index("## The course")]
    rest = README[README.index("| room | what it is |") : README.index("To add a shape")]
    assert {room for room in rooms if f"`{room}`" not in story and f"`{room}" not in rest} <= {"__main__"}


def test_nothing_advises_the_package_that_has_this_name_on_pypi():
    """The name is somebody else's there: no page, message or notebook may send anybody to it."""
    spoken = [*ROOT.glob("*.md"), *(ROOT / "primkit").rglob("*.py"), *(ROOT / "notebooks").rglob("*.md")]
    spoken += (ROOT / "notebooks").rglob("*.ipynb")
    advice = re.compile(r"pip install\b(?:(?!-e |no-index)[^\n|`])*[\"' ]primkit(?:\[|[\"'`]|\s|$)")
    assert [str(path) for path in spoken if advice.search(path.read_text(encoding="utf-8"))] == []
    assert advice.search('python -m pip install "primkit[teach]"')
    assert advice.search("pip install primkit")
