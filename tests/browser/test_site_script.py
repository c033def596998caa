"""The site's one script: a page from a folder, without network: sliders move, predictions come back, quizzes mark."""

import json
from dataclasses import asdict
from html import escape

import pytest
import states

import primkit as pk
from primkit.widgets.predictions import questions

from .lab import ROOT

QUIZ = """<script type="application/json" class="primkit-quiz">[[false, true]]</script><p>1. So?</p>
<details><summary>No</summary>No.</details><details><summary>Yes</summary>Right.</details>"""
SECONDS = 2  # from opening the page to the first picture that moved


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    """A page with the parts of a lesson."""
    asked = json.dumps([asdict(questions()[name]) for name in ("along", "wall")])
    parts = [
        f'<div class="primkit-predict" data-asked="{escape(asked)}"></div>',
        states.as_html(pk.widgets.rays()),
        '<p class="primkit-guess" data-name="along"></p><p class="primkit-guess" data-name="wall"></p>',
        QUIZ,
    ]
    script, style = ((ROOT / ".site" / "static" / f"interactive.{kind}").read_text("utf-8") for kind in ("js", "css"))
    body = f"<!doctype html><meta charset=utf-8><style>{style}</style>{''.join(parts)}<script>{script}</script>"
    path = tmp_path_factory.mktemp("site") / "lesson.html"
    path.write_text(body, encoding="utf-8")
    return path


@pytest.fixture
def page(browser, file):
    context = browser.new_context(viewport={"width": 390, "height": 844}, offline=True)
    page = context.new_page()
    page.asked = []
    page.on("request", lambda request: page.asked.append(request.url))
    page.goto(file.as_uri())
    yield page
    assert [address for address in page.asked if not address.startswith(("file:", "data:", "blob:"))] == []
    context.close()


def test_a_slider_moves_by_the_keyboard_soon_after_the_page_is_opened(page):
    """In processor time of the page's process, which is the same on a busy machine."""
    before = page.locator(".picture > div").inner_html()
    page.locator("input[type=range][id^=primkit]").first.press("ArrowRight")
    page.wait_for_function("before => document.querySelector('.picture > div').innerHTML !== before", arg=before)
    clock = page.context.new_cdp_session(page)
    clock.send("Performance.enable")
    told = {one["name"]: one["value"] for one in clock.send("Performance.getMetrics")["metrics"]}
    assert 0 < told["ProcessTime"] < SECONDS
    beams = page.locator(".controls output").first.inner_text()
    shown = pk.widgets.rays().draw(beams=int(beams))
    parsed = "svg => { const d = document.createElement('div'); d.innerHTML = svg; return d.innerHTML }"
    assert page.locator(".picture > div").inner_html() == page.evaluate(parsed, shown)
    assert page.locator(".says").inner_text() == pk.widgets.what_it_says(shown)


def test_another_combination_goes_to_the_nearest_and_says_so(page):
    page.get_by_role("button", name="noisy").click()
    page.wait_for_function("document.querySelectorAll('.controls output')[1].textContent === '10'")
    assert page.locator(".snapped").inner_text() == ""
    page.locator("input[type=range][id^=primkit]").first.press("Home")
    page.wait_for_function("document.querySelector('.controls output').textContent === '8'")
    assert page.locator(".snapped").inner_text() == ""  # a ray of the star
    page.locator("input[type=range][id^=primkit]").nth(3).press("Home")
    page.wait_for_function("document.querySelector('.snapped').textContent.includes('nearest')")
    assert "beams" in page.locator(".snapped").inner_text()
    assert page.locator(".controls output").nth(3).inner_text() == "-0.45"  # what was moved stays


def test_a_guess_is_kept_and_comes_back_beside_the_answer(page, file):
    assert "no guess" in page.locator(".primkit-guess").first.inner_text()
    page.get_by_label("farther apart").check()
    page.locator(".primkit-predict input[type=range]").press("ArrowRight")
    page.goto(file.as_uri())
    assert page.locator(".primkit-guess").all_inner_texts() == ["Your guess: farther apart.", "Your guess: 1 mm."]
    assert page.get_by_label("farther apart").is_checked()


def test_a_quiz_marks_what_is_opened_and_shuts_the_others(page):
    wrong, right = page.locator("details").all()
    wrong.locator("summary").press("Enter")
    assert "wrong" in wrong.get_attribute("class")
    right.locator("summary").press("Enter")
    page.wait_for_function("!document.querySelector('details.wrong').open")
    assert "right" in right.get_attribute("class")


def test_it_fits_a_phone(page):
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
