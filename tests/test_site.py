"""The site's parts, without Sphinx: stored pictures are the live ones, quizzes know what is right, links are seen."""

import base64
import gzip
import html
import inspect
import json
import re
from operator import attrgetter
from pathlib import Path

import film
import links
import lite
import pytest
import reference
import states
from lessons import page_of, with_quiz

import primkit as pk
from primkit import installed
from primkit.shapes import PRIMITIVES
from primkit.themed import in_theme
from primkit.widgets import SLIDERS
from primkit.widgets.predictions import read_quiz
from tests import test_notebooks as form

ROOT = Path(__file__).resolve().parent.parent
LESSONS = sorted((ROOT / "notebooks").glob("[0-9]*.ipynb"))
SAMPLE = 4  # pictures of each slider; drawing all of them takes a minute


@pytest.mark.parametrize("make", SLIDERS, ids=lambda make: make.__name__)
def test_a_stored_picture_is_the_live_one_to_the_last_byte(make):
    explorer = make()
    values = list(states.places(explorer))
    assert explorer.start in values
    assert all(setting in values for setting in explorer.settings.values())
    for chosen in values[:: len(values) // (SAMPLE - 1)]:
        explorer.set(**chosen)
        assert [image.value for image in explorer._images] == [in_theme(svg) for svg in explorer.pictures(**chosen)]
        assert explorer.failure is None


def test_what_is_packed_is_what_was_drawn():
    explorer = pk.widgets.rays()
    page = states.as_html(explorer)
    about = json.loads(html.unescape(re.search(r'data-about="(.*?)"', page)[1]))
    packed = re.search(r'<script type="text/plain">(.*?)</script>', page)[1]
    pictures = json.loads(gzip.decompress(base64.b64decode(packed)))
    assert {tuple(key): svg for *key, svg in pictures} == states.star(explorer)
    assert about["start"] == list(explorer.start.values())
    assert all(
        value in control["values"]
        for *key, _ in pictures
        for value, control in zip(key, about["controls"], strict=True)
    )
    assert len(page) < 400_000


@pytest.mark.parametrize("path", LESSONS, ids=lambda path: path.stem[:2])
def test_no_lesson_s_page_needs_python(path, monkeypatch):
    """Each widget has something in its place, and each quiz says what is right."""
    monkeypatch.setattr("lessons.as_html", repr)
    lesson = json.loads(path.read_text(encoding="utf-8"))
    asked = [[q for q in read_quiz(text) if q.options] for text in form.text_cells(lesson)]
    for cell in form.text_cells(lesson):
        assert "$" not in "".join(line for line in cell.splitlines() if line.startswith("<details>"))
    page = page_of(lesson)
    kinds = [kind for cell in form.code_cells(page) for output in cell["outputs"] for kind in output.get("data", {})]
    assert "text/html" in kinds
    assert [kind for kind in kinds if "widget" in kind] == []
    assert not ("image/png" in kinds and "text/html" not in kinds)
    marked = re.findall(r'class="primkit-quiz">(.*?)</script>', "\n".join(form.text_cells(page)))
    assert [json.loads(one) for one in marked] == [
        [[option.right for option in question.options] for question in quiz] for quiz in asked if quiz
    ]
    assert all(sum(rights) == 1 for one in marked for rights in json.loads(one))


def test_a_quiz_is_marked_before_its_first_question():
    options = "<details><summary>Yes</summary>Right: so.</details>\n<details><summary>No</summary>No.</details>"
    mark = '<script type="application/json" class="primkit-quiz">[[true, false]]</script>'
    assert with_quiz(f"## Quiz\n\n**1. So?**\n\n{options}") == f"## Quiz\n\n{mark}\n\n**1. So?**\n\n{options}"
    assert with_quiz("No quiz.") == "No quiz."


def test_the_film_on_the_front_page_is_what_the_robot_does():
    """Apart from a tenth of a pixel, which another processor may round otherwise."""
    stored, drawn = (
        re.sub(r"[\d.]+", "0", text) for text in (film.FILM.read_text(encoding="utf-8"), film.front_page())
    )
    assert stored == drawn
    assert [kind for kind in PRIMITIVES if f">{kind}<" not in stored] == []
    assert "prefers-reduced-motion" in stored


def test_a_lesson_in_the_browser_fetches_the_library_first():
    """The same cell everywhere: it never names the package that is somebody else's, and comes before any import."""
    lesson = lite.with_first_cell(json.loads(LESSONS[0].read_text(encoding="utf-8")))
    first = next(cell for cell in lesson["cells"] if cell["cell_type"] == "code")
    assert re.findall(r"^    %pip install -q (.+)$", "".join(first["source"]), re.MULTILINE) == [installed.DISTRIBUTION]
    assert lesson["cells"][0]["cell_type"] == "markdown"


def test_every_public_name_has_its_place_in_the_reference():
    """The library's own, and what its wings add to them."""
    told = "\n".join(reference.pages().values())
    listed = re.findall(r"^\.\. (?:autoclass|autofunction|data):: primkit\.(\S+)$", told, re.MULTILINE)
    assert [name for name in pk.__all__ if name not in listed and f":doc:`{name}`" not in told] == []
    values = {id(attrgetter(name)(pk)) for name in listed}
    wings = [value for value in (getattr(pk, name) for name in pk.__all__) if inspect.ismodule(value)]
    public = [(wing.__name__, name, getattr(wing, name)) for wing in wings for name in getattr(wing, "__all__", ())]
    assert len(public) > len(pk.__all__)
    assert [f"{wing}.{name}" for wing, name, value in public if id(value) not in values] == []


def test_the_front_page_shows_before_it_tells():
    import build  # here: once a site was built, ruff takes this name for the folder's

    pages = dict(build.front((ROOT / "README.md").read_text(encoding="utf-8"), "* the doors"))
    in_turn = ("film.svg", "(start.md)", "story.png", "* the doors", "```verdict", "**1.00**", "free.png")
    places = [pages["index.md"].find(it) for it in in_turn]
    assert places == sorted(places)
    assert places[0] > 0
    assert "pip install -r environment.txt" in pages["start.md"]


def test_the_teacher_s_pages_lead_to_every_lesson():
    """A link to what is not on the site loses its address without a word: these must not."""
    import build

    pages = "\n".join(text for _, text in build.pack(ROOT / "notebooks" / "teacher"))
    named = {(where, name) for where, name in re.findall(r"\]\((\S*?)(\d\d_\w+)\.ipynb\)", pages)}
    lessons = {path.stem for path in LESSONS}
    assert {name for _, name in named} >= lessons
    assert {where for where, name in named if name in lessons} == {"../lessons/", "../../lessons/"}


def test_links_that_lead_nowhere_are_found(tmp_path):
    (tmp_path / "a.html").write_text(
        '<a href="b.html#there">x</a><a href="https://x.org">y</a><img src="data:image/png;,">'
    )
    (tmp_path / "b.html").write_text('<p id="there"><a href="a.html">x</a>')
    assert list(links.faults(tmp_path)) == []
    (tmp_path / "b.html").write_text(
        '<a href="c.html"></a><a href="#no"></a><script src="https://cdn.org/x.js"></script>'
    )
    (tmp_path / "a.css").write_text("@font-face{src:url(https://fonts.org/a.woff)}")
    assert sorted(links.faults(tmp_path)) == [
        "a.css: loads from elsewhere",
        "a.html: b.html#there names nothing there",
        "b.html: #no names nothing there",
        "b.html: c.html leads nowhere",
        "b.html: loads https://cdn.org/x.js",
    ]
