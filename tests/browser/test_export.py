"""A lesson as a page for the shelf, by nbconvert, without Python and without a network; and the same on paper."""

import pytest

from .lab import LESSONS, ROOT
from .test_lessons import too_wide

A4 = 718  # px: the width of a sheet between its margins


@pytest.fixture(scope="module", params=["03_group_points", "04_find_edges"])  # the longest lines, the widest twin
def page(browser, tmp_path_factory, request):
    from nbconvert import HTMLExporter

    assert request.param in LESSONS
    html, _ = HTMLExporter().from_filename(str(ROOT / "notebooks" / f"{request.param}.ipynb"))
    path = tmp_path_factory.mktemp("export") / "lesson.html"
    path.write_text(html, encoding="utf-8")
    page = browser.new_page(viewport={"width": 1280, "height": 1000})
    page.route("http*://**", lambda route: route.abort())
    page.goto(path.as_uri(), wait_until="domcontentloaded")
    yield page
    page.close()


def test_the_twin_stands_in_for_the_slider(page):
    twin = page.locator(".primkit-twin img")
    assert twin.count() == 1
    assert twin.bounding_box()["height"] > 100
    assert len(twin.get_attribute("alt")) > 100


def test_it_fits_on_paper(page, screenshots):
    page.emulate_media(media="print")
    page.set_viewport_size({"width": A4, "height": 1000})
    assert page.locator(".primkit-twin img").bounding_box()["height"] > 100
    if screenshots:
        page.screenshot(path=screenshots / "on_paper.png", full_page=True)
    assert too_wide(page, "pre, img, .jp-RenderedMarkdown") == []
