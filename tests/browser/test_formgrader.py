"""nbgrader's own page, formgrader, in a course folder: the graded problem set and its scores are there."""

import os
import subprocess
import sys

import pytest

from tests.submissions import ProblemSet
from tests.test_teaching import small_course, teach

from .lab import OPTIONS, SERVER, TOKEN, _address, _stop

LOOKED_FOR = ("id,first_name,last_name,email", "ada,Ada,Lovelace,")


@pytest.fixture(scope="module")
def course(tmp_path_factory):
    """A course with one graded submission."""
    made = small_course(tmp_path_factory.mktemp("formgrader"))
    (made.root / "students.csv").write_text("\n".join(LOOKED_FOR) + "\n")
    teach(made.root, "release", "map")
    problem_set = ProblemSet(made.root, "map")
    problem_set.hand_in("ada", problem_set.released)
    teach(made.root, "grade", "map")
    return made


@pytest.fixture(scope="module")
def page(browser, course, tmp_path_factory):
    """A page of the browser, with the address of a Jupyter that runs in the course folder as its home."""
    folder = tmp_path_factory.mktemp("jupyter-of-the-course")
    homes = {f"JUPYTER_{kind.upper()}_DIR": str(folder / kind) for kind in ("config", "data", "runtime")}
    with (
        open(folder / "log.txt", "w") as log,
        subprocess.Popen(
            [sys.executable, "-c", SERVER, *OPTIONS],
            cwd=course.root,
            env=os.environ | homes,
            stdin=subprocess.PIPE,
            stdout=log,
            stderr=log,
        ) as server,
    ):
        try:
            context = browser.new_context(base_url=_address(server, folder), viewport={"width": 1280, "height": 800})
            context.set_default_timeout(30_000)
            yield context.new_page()
            context.close()
        finally:
            _stop(server)


def test_formgrader_shows_the_course(page, screenshots):
    page.goto(f"/formgrader?token={TOKEN}")
    row = page.locator("tr", has=page.get_by_role("link", name="map", exact=True))
    row.get_by_role("link", name="1", exact=True).wait_for()  # one submission
    if screenshots:
        page.screenshot(path=screenshots / "formgrader.png")


def test_formgrader_shows_the_score(page, screenshots):
    page.goto("/formgrader/manage_submissions/map")
    row = page.locator("tr", has=page.get_by_text("Lovelace, Ada"))
    row.wait_for()
    assert "graded" in row.inner_text()
    assert "0 / 5" in row.inner_text()  # three for a function, two for a written answer
    if screenshots:
        page.screenshot(path=screenshots / "formgrader_submissions.png")


def test_formgrader_shows_the_table_of_marks(page, screenshots):
    page.goto("/formgrader/gradebook/map/map")
    page.get_by_role("link", name="Lovelace, Ada").or_(page.get_by_role("link", name="Submission #1")).first.click()
    page.get_by_text("radius: 0 of 3 points").first.wait_for()
    if screenshots:
        page.screenshot(path=screenshots / "formgrader_marks.png")
