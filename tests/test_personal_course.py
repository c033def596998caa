"""A course on personal maps: everybody is graded on their own, and nbgrader's page, formgrader, shows it."""

import os
import re
import subprocess
import sys

import nbformat
import pytest

from primkit.course.course import new_course
from primkit.course.grading import personal_truth
from primkit.course.personal import personal_scans, personal_world
from primkit.formats import save_scans
from tests.browser.lab import OPTIONS, PATIENCE, SERVER, TOKEN, _address, _stop, chromium
from tests.submissions import ProblemSet, with_cell
from tests.test_teaching import table, teach

HIDDEN = """\
# The hidden tests mark this function when you hand it in.
### BEGIN HIDDEN TESTS
from grader import maps

maps.RADIUS.mark("radius", globals())
### END HIDDEN TESTS"""
GRADER = """\
from primkit.checks import Check
from primkit.checks.judges import number
from primkit.course.grading import Part, Task, personal_truth

def _reference():
    return next(shape for shape in personal_truth().shapes if shape.kind == "circle").radius

CHECK = Check("radius", _reference, lambda rng: [()], number("m"))
RADIUS = Task("radius", [Part("the circle's radius", 3, CHECK)])
"""
LOOKS = """\
from pathlib import Path
import primkit as pk
from primkit.course.personal import DEMONSTRATION

print(pk.load_scans("my_scans.npz").ranges.shape)"""


def small_course(root):
    """A course of one problem set about a personal map."""
    assignments = root / "assignments"
    source = assignments / "source" / "map"
    source.mkdir(parents=True)
    (assignments / "grader").mkdir()
    (assignments / "grader" / "__init__.py").touch()
    (assignments / "grader" / "maps.py").write_text(GRADER)

    def cell(source, name, **more):
        flags = {
            "schema_version": 3,
            "grade_id": name,
            "locked": True,
            "grade": False,
            "solution": False,
            "task": False,
        }
        return nbformat.v4.new_code_cell(source, metadata={"nbgrader": flags | more})

    solution = "def radius():\n    ### BEGIN SOLUTION\n    return 0.07\n    ### END SOLUTION"
    answer = {"nbgrader": cell("", "why", grade=True, solution=True, locked=False, points=2).metadata["nbgrader"]}
    cells = [
        cell(LOOKS, "looks"),
        cell(solution, "radius", solution=True, locked=False),
        cell(HIDDEN, "radius-hidden", grade=True, points=3, cell_type="code"),
        nbformat.v4.new_markdown_cell("Why?", metadata=answer),
    ]
    about_it = {"kernelspec": {"name": "python3", "display_name": "Python 3", "language": "python"}}
    nbformat.write(nbformat.v4.new_notebook(cells=cells, metadata=about_it), source / "map.ipynb")
    save_scans(personal_scans(personal_truth()), source / "my_scans.npz")
    return new_course(root / "course", assignments)


SALT = "0123456789abcdef" * 2


@pytest.fixture(scope="module")
def course(tmp_path_factory):
    """A course with two graded submissions and a report; and what each command said.

    Bob hands in Ada's answer and Ada's scans.
    """
    made = small_course(tmp_path_factory.mktemp("personal"))
    (made.root / "salt.txt").write_text(SALT)  # with any other, three letters may stand in 18 KB by chance
    (made.root / "students.csv").write_text("id,first_name,last_name,email\nada,Ada,Lovelace,\nbob,Bob,Babbage,\n")
    said = {"release": teach(made.root, "release", "map")}
    problem_set = ProblemSet(made.root, "map")
    radius = personal_world("ada", salt=made.salt()).shapes[0].radius
    # What the student's code can see: neither the salt nor the teacher's environment.
    secrets = ("a password", made.salt())
    looks = f"import os\nassert not [word for word in {secrets!r} if word in str(dict(os.environ))]"
    for name in ("ada", "bob"):
        answers = {"radius": f"def radius():\n    return {radius}", "why": {"ada": "Far away."}.get(name)}
        folder = problem_set.hand_in(name, with_cell(problem_set.with_answers(answers), looks))
        (folder / "my_scans.npz").write_bytes((made.root / "personal" / "ada" / "my_scans.npz").read_bytes())
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("LEAKED", "a password")
        said["grade"] = teach(made.root, "grade", "map")
    said["report"] = teach(made.root, "report", "map")
    return made, said


def test_each_gets_scans_of_their_own_that_tell_no_secret(course):
    made, said = course
    assert "personal/<student>/my_scans.npz: 2 of them" in said["release"]
    scans = {name: (made.root / "personal" / name / "my_scans.npz").read_bytes() for name in ("ada", "bob")}
    assert scans["ada"] != scans["bob"]
    for name, data in scans.items():
        assert name.encode() not in data
        assert made.salt().encode() not in data


def test_everybody_is_graded_on_their_own_map(course):
    made, said = course
    assert "to look at" not in said["grade"]
    assert "not in students.csv" not in said["report"]
    rows = table(made.root / "reports" / "map" / "grades.csv")
    assert {row["student_id"]: float(row["score"]) for row in rows} == {"ada": 3.0, "bob": 0.0}


def test_a_written_answer_waits_for_its_teacher(course):
    made, said = course
    assert "1 written answer waits to be marked by hand: in formgrader" in said["grade"]
    assert "`primkit teach hand-back map`" in said["grade"]
    pages = {name: (made.root / "feedback" / name / "map" / "map.html").read_text("utf-8") for name in ("ada", "bob")}
    assert "Not yet marked: why. The score does not count that yet." in pages["ada"]
    assert '<a href="#why">Written response</a> (not yet marked, of 2.0)' in pages["ada"]
    assert "Score: 0.0 / 2.0" not in pages["ada"]
    assert "ot yet marked" not in pages["bob"]  # who wrote nothing has 0
    rows = table(made.root / "reports" / "map" / "class.csv")
    states = {row["id"]: row["map"] for row in rows}
    assert states == {"ada": "graded; 1 to be marked by hand", "bob": "graded"}


# --- formgrader ---------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def page(course, tmp_path_factory):
    """A page of a browser, with the address of a Jupyter that runs in the course folder as its home."""
    folder = tmp_path_factory.mktemp("jupyter-of-the-course")
    homes = {f"JUPYTER_{kind.upper()}_DIR": str(folder / kind) for kind in ("config", "data", "runtime")}
    with (
        chromium() as browser,
        open(folder / "log.txt", "w") as log,
        subprocess.Popen(
            [sys.executable, "-c", SERVER, *OPTIONS],
            cwd=course[0].root,
            env=os.environ | homes,
            stdin=subprocess.PIPE,
            stdout=log,
            stderr=log,
        ) as server,
    ):
        try:
            context = browser.new_context(base_url=_address(server, folder), viewport={"width": 1280, "height": 800})
            context.set_default_timeout(1000 * PATIENCE)
            yield context.new_page()
            context.close()
        finally:
            _stop(server)


def test_formgrader_shows_the_course(page, screenshots):
    page.goto(f"/formgrader?token={TOKEN}")
    row = page.locator("tr", has=page.get_by_role("link", name="map", exact=True))
    row.get_by_role("link", name="2", exact=True).wait_for()  # submissions
    if screenshots:
        page.screenshot(path=screenshots / "formgrader.png")


def test_formgrader_shows_the_score(page, screenshots):
    page.goto("/formgrader/manage_submissions/map")
    row = page.locator("tr", has=page.get_by_text("Babbage, Bob"))
    row.wait_for()
    assert "graded" in row.inner_text()
    assert "0 / 5" in row.inner_text()  # three for a function, two for a written answer
    if screenshots:
        page.screenshot(path=screenshots / "formgrader_submissions.png")


def test_formgrader_shows_the_table_of_marks(page, screenshots):
    page.goto("/formgrader/gradebook/map/map")
    page.get_by_role("link", name="Submission #1").click()  # one of the two
    page.get_by_text(re.compile("radius: [03] of 3 points")).first.wait_for()
    if screenshots:
        page.screenshot(path=screenshots / "formgrader_marks.png")
