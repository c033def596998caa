"""Leaks: a planted solution is found wherever it is put, also under other names; what students get holds none."""

import base64
import copy
import html
import json
import re
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import nbformat
import numpy as np
import pytest

from primkit.__main__ import main
from primkit.course.leaks import MARKS, find_leaks, pieces, secrets_of
from tests.submissions import MARKERS, about, read, renamed, text

ROOT = Path(__file__).resolve().parent.parent
ASSIGNMENTS = ROOT / "notebooks" / "assignments"
SETS = sorted((ASSIGNMENTS / "source").glob("*/*.ipynb"))
SECRETS = secrets_of(ASSIGNMENTS)

SOLUTION = """\
def nearest_gap(ranges, angles, width):
    shorter = np.minimum(ranges[:-1], ranges[1:])
    chords = 2 * shorter * np.sin(np.diff(angles) / 2)
    open_now = np.isinf(ranges[:-1]) & (chords >= width)
    starts = np.flatnonzero(open_now)
    if len(starts) == 0:
        return None
    return float(angles[starts].min() + np.diff(angles)[starts[0]] / 2)
"""
HELPER = """\
def mean_of_widest(ranges, angles):
    order = np.argsort(ranges)[::-1]
    chosen = angles[order[: max(1, len(order) // 3)]]
    sines, cosines = np.sin(chosen).sum(), np.cos(chosen).sum()
    return float(np.arctan2(sines, cosines) % (2 * np.pi))
"""
SALT = "d00df00dd00df00dd00df00dd00df00d"


@pytest.fixture(scope="module")
def secrets(tmp_path_factory):
    """Those of a small course: a solution, a helper of the grader's, and a salt."""
    folder = tmp_path_factory.mktemp("course")
    (folder / "source" / "gap").mkdir(parents=True)
    (folder / "grader" / "gaps").mkdir(parents=True)
    first, *rest = SOLUTION.splitlines()
    source = "\n".join([first, "    ### BEGIN SOLUTION", *rest, "    ### END SOLUTION"])
    cell = nbformat.v4.new_code_cell(source, metadata={"nbgrader": {"grade_id": "nearest_gap", "solution": True}})
    nbformat.write(nbformat.v4.new_notebook(cells=[cell]), folder / "source" / "gap" / "gap.ipynb")
    (folder / "grader" / "gaps" / "widest.py").write_text("import numpy as np\n\n\n" + HELPER)
    (folder / "salt.txt").write_text(SALT + "\n")
    return secrets_of(folder)


def released():
    """A notebook as students get it."""
    stub = SOLUTION.splitlines()[0] + "\n    # YOUR CODE HERE\n    raise NotImplementedError()"
    return nbformat.v4.new_notebook(
        cells=[nbformat.v4.new_markdown_cell("# Gaps\n\nFind the first gap."), nbformat.v4.new_code_cell(stub)]
    )


def in_cell(notebook, planted):
    notebook.cells[1].source = planted


def in_markdown(notebook, planted):
    notebook.cells[0].source = f"# Gaps\n\n```python\n{planted}\n```\n"


def in_stream(notebook, planted):
    notebook.cells[1].outputs = [nbformat.v4.new_output("stream", name="stdout", text=planted)]


def in_html(notebook, planted):
    data = {"text/html": f"<pre>{html.escape(planted)}</pre>"}
    notebook.cells[1].outputs = [nbformat.v4.new_output("display_data", data=data)]


def in_traceback(notebook, planted):
    lines = planted.splitlines()
    notebook.cells[1].outputs = [nbformat.v4.new_output("error", ename="E", evalue="", traceback=lines)]


def in_cell_metadata(notebook, planted):
    notebook.cells[1].metadata["solution"] = {"lines": [planted]}


def in_notebook_metadata(notebook, planted):
    notebook.metadata["notes"] = planted


def in_attachment(notebook, planted):
    notebook.cells[0]["attachments"] = {"x.txt": {"text/plain": base64.b64encode(planted.encode()).decode()}}


PLACES = [in_cell, in_markdown, in_stream, in_html, in_traceback, in_cell_metadata, in_notebook_metadata, in_attachment]
FORMS = {
    "as it stands": lambda code: code,
    "renamed and laid out anew": lambda code: renamed(code, np.random.default_rng(3)),
    "its body alone, with comments": lambda code: "\n".join(f"{line}  # so" for line in code.splitlines()[1:]),
}


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("planted", [SOLUTION, HELPER], ids=["solution", "grader"])
@pytest.mark.parametrize("place", PLACES, ids=lambda place: place.__name__)
def test_a_planted_solution_is_found(place, planted, form, secrets, tmp_path):
    notebook = released()
    place(notebook, FORMS[form](planted))
    path = tmp_path / "gap.ipynb"
    path.write_text(json.dumps(notebook), encoding="utf-8")
    (leak,) = find_leaks([tmp_path], secrets)
    assert leak.path == path.as_posix()
    whose = "nearest_gap in gap.ipynb" if planted is SOLUTION else "mean_of_widest in grader/gaps/widest.py"
    assert whose in leak.what
    assert leak.place.startswith(("cell ", "the notebook's metadata"))


def test_a_clean_notebook_is_clean(secrets, tmp_path):
    (tmp_path / "gap.ipynb").write_text(json.dumps(released()), encoding="utf-8")
    assert find_leaks([tmp_path], secrets) == []


@pytest.mark.parametrize("word", [*MARKS, SALT])
def test_markers_and_the_salt_are_found(word, secrets, tmp_path):
    (tmp_path / "notes.md").write_text(f"see ### {word} there")
    assert len(find_leaks([tmp_path], secrets)) == 1


def test_a_wheel_is_looked_through(secrets, tmp_path):
    wheel = tmp_path / "primkit-1-py3-none-any.whl"
    inner = tmp_path / "inner.zip"
    with zipfile.ZipFile(inner, "w") as archive:
        archive.writestr("deep.py", HELPER)
    with zipfile.ZipFile(wheel, "w") as archive:
        archive.writestr("primkit/honest.py", "def half(x):\n    return x / 2\n")
        archive.writestr("primkit/gaps.py", SOLUTION)
        archive.write(inner, "primkit/data/inner.zip")
    found = {
        (leak.path.removeprefix(wheel.as_posix()), leak.what.split(",")[0]) for leak in find_leaks([wheel], secrets)
    }
    assert found == {
        ("/primkit/gaps.py", "the solution of nearest_gap in gap.ipynb"),
        ("/primkit/data/inner.zip/deep.py", "mean_of_widest in grader/gaps/widest.py"),
    }


def test_the_same_code_under_other_names_is_the_same():
    assert set(pieces(SOLUTION)) & set(pieces(renamed(SOLUTION, np.random.default_rng(0)).replace("ranges", "r")))
    assert not set(pieces(SOLUTION)) & set(pieces(HELPER))


# --- what students really get -------------------------------------------------------------------------------


def as_released(path):
    """Return a notebook as nbgrader releases it."""
    from nbgrader.preprocessors import ClearHiddenTests, ClearOutput, ClearSolutions, LockCells

    notebook, resources = nbformat.read(path, as_version=4), {}
    for step in (LockCells, ClearSolutions, ClearOutput, ClearHiddenTests):
        notebook, resources = step().preprocess(notebook, resources)
    return notebook


@pytest.mark.parametrize("path", SETS, ids=lambda path: path.stem)
def test_a_released_problem_set_holds_no_solution(path, tmp_path):
    nbformat.write(as_released(path), tmp_path / path.name)
    assert find_leaks([tmp_path], SECRETS) == []


def test_every_solution_is_looked_for(tmp_path):
    """Each solution cell of the course, planted as it stands in one released notebook, is found."""
    for path in SETS:
        clean = as_released(path)
        for cell in read(path)["cells"]:
            if cell["cell_type"] != "code" or not about(cell).get("solution"):
                continue
            planted = copy.deepcopy(clean)
            planted.cells.append(nbformat.v4.new_code_cell(MARKERS.sub("", text(cell))))
            what = f"the solution of {about(cell)['grade_id']} in {path.name}"
            nbformat.write(planted, tmp_path / path.name)
            assert any(what in leak.what for leak in find_leaks([tmp_path / path.name], SECRETS)), what


def test_the_lessons_hold_no_solution():
    assert find_leaks(sorted((ROOT / "notebooks").glob("*.ipynb")), SECRETS) == []


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """A folder with what is uploaded: the wheel, and the source archive's own folder."""
    folder = tmp_path_factory.mktemp("dist")
    command = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-t", "sdist", "-d", str(folder)]
    subprocess.run(command, cwd=ROOT, check=True, capture_output=True, timeout=120)
    (archive,) = folder.glob("*.tar.gz")
    shutil.unpack_archive(archive, folder / "sdist", filter="data")
    return folder


def test_neither_wheel_nor_source_archive_holds_a_solution(built):
    (wheel,) = built.glob("*.whl")
    with zipfile.ZipFile(wheel) as archive:
        held = set(archive.namelist())
    lessons = {path.name for path in (ROOT / "notebooks").glob("*.ipynb")}
    assert {Path(name).name for name in held if name.endswith(".ipynb")} == lessons
    assert {"primkit/course/leaks.py", "primkit/py.typed", "primkit/data/maps/4-10.geojson"} <= held
    assert [name for name in held if re.search("/(grader|assignments|teacher|pictures|tests)/", name)] == []
    (source,) = (built / "sdist").iterdir()
    inside = {path.relative_to(source).as_posix() for path in source.rglob("*") if path.is_file()}
    assert {re.sub(r"^primkit/(data|lessons)/", "", name) for name in held if "dist-info" not in name} == {
        re.sub("^(data|notebooks)/", "", name) for name in inside if re.match("(primkit|data|notebooks)/", name)
    }
    assert find_leaks([source / "primkit", source / "data"], SECRETS) == []  # the lessons were looked through above


def test_the_package_s_page_leads_out_of_no_folder(built):
    (wheel,) = built.glob("*.whl")
    with zipfile.ZipFile(wheel) as archive:
        (name,) = [name for name in archive.namelist() if name.endswith("dist-info/METADATA")]
        told, _, page = archive.read(name).decode().partition("\n\n")
    assert {"Name: primkit-lab", "License-Expression: BSD-3-Clause AND CC-BY-4.0"} <= set(told.splitlines())
    links = re.findall(r"\]\(([^)]+)\)|src=\"([^\"]+)\"", page)
    assert len(links) > 3
    assert [link for pair in links for link in pair if link and not link.startswith(("https:", "#"))] == []
    assert "environment.txt" not in page
    assert "pip install" in page


# --- the command --------------------------------------------------------------------------------------------


def test_the_command_says_where_and_ends_with_1(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "out").mkdir()
    for name, clean in (("clean.py", True), ("leaky.py", False)):
        solution = next(MARKERS.sub("", text(cell)) for cell in read(SETS[0])["cells"] if about(cell).get("solution"))
        (tmp_path / "out" / name).write_text("x = 1\n" if clean else solution)
        assert main(["teach", "leaks", f"out/{name}"]) == (0 if clean else 1)
        out = capsys.readouterr().out
        assert out.startswith(
            "No solution in out/clean.py: looked for " if clean else "LEAK  out/leaky.py, text: the sol"
        )
