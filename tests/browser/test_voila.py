"""A lesson as a page without code, by Voila: it opens, on a laptop and on a phone, and its sliders work."""

import pytest

from .lab import TOKEN
from .panel import panels
from .test_lessons import NARROW, PANEL, WIDE, too_wide

LESSON = "01_see_with_rays"


@pytest.fixture(scope="module")
def page(context):
    page = context.new_page()
    page.goto(f"/voila/render/{LESSON}.ipynb?token={TOKEN}")
    yield page
    page.close()


@pytest.fixture(scope="module")
def panel(page):
    (panel,) = panels(page, 1, settle=lambda: None)
    return panel


@pytest.mark.usefixtures("panel")
def test_the_page_shows_the_lesson_and_no_code(page):
    assert page.locator("h1").first.inner_text().startswith("See with rays")
    assert page.get_by_text("import primkit").count() == 0
    assert page.get_by_text("Traceback").count() == 0
    assert page.locator(".primkit-twin img").bounding_box()["height"] == 0  # folded: here the slider itself moves


@pytest.mark.parametrize("move", ["keys", "mouse"])
def test_a_slider_moves_the_picture(panel, move):
    slider = panel.sliders[0]
    before = panel.picture()
    slider.step() if move == "keys" else slider.drag(0.7)
    panel.await_another(before)
    assert panel.seen("failures") == []
    assert len(set(panel.seen("heights"))) == 1


@pytest.mark.parametrize("width", [WIDE, NARROW])
def test_it_fits(page, panel, width, screenshots):
    page.set_viewport_size({"width": width, "height": 1000})
    if screenshots:
        panel.root.scroll_into_view_if_needed()
        page.screenshot(path=screenshots / f"voila_{width}.png")
    assert too_wide(page, f"{PANEL}, .jp-RenderedImage, img") == []
