"""One Jupyter and one browser for all tests in here; without them they are skipped, or fail where they must be."""

import os
import shutil

import pytest

from .lab import enter, jupyter

BROWSERS = ("chromium", "chromium-browser", "google-chrome")


@pytest.fixture(scope="package")
def browser():
    """Chromium without a window. PRIMKIT_BROWSER=required makes its absence a failure."""
    program = next(filter(None, map(shutil.which, BROWSERS)), None)
    if program is None:
        _absent(f"none of these is installed: {', '.join(BROWSERS)}")
    try:
        from playwright.sync_api import sync_playwright
    except ImportError:
        _absent("playwright, which drives it, is not installed")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=program, args=["--no-sandbox"])
        yield browser
        browser.close()


def _absent(why):
    """Skip the test, or let it fail where a browser must be."""
    end = pytest.fail if os.environ.get("PRIMKIT_BROWSER") == "required" else pytest.skip
    end(f"the lessons are tried in a browser: {why}")


@pytest.fixture(scope="package")
def folder(tmp_path_factory):
    """Where Jupyter keeps all it has, with a copy of the lessons in ``notebooks``."""
    return tmp_path_factory.mktemp("jupyter")


@pytest.fixture(scope="package")
def address(folder):
    """Where Jupyter answers."""
    with jupyter(folder) as address:
        yield address


@pytest.fixture(scope="package")
def context(browser, address):
    """The browser with Jupyter's address as its home."""
    context = browser.new_context(base_url=address, viewport={"width": 1280, "height": 1000})
    context.set_default_timeout(30_000)
    yield context
    context.close()


@pytest.fixture(scope="package")
def phone(browser, address):
    """A browser as small as a phone's, with a screen to touch."""
    context = browser.new_context(
        base_url=address, viewport={"width": 390, "height": 844}, has_touch=True, is_mobile=True
    )
    context.set_default_timeout(30_000)
    yield context
    context.close()


@pytest.fixture(scope="package")
def lab(context):
    """A page with Jupyter Lab in it."""
    page = context.new_page()
    enter(page)
    return page


@pytest.fixture(scope="package")
def screenshots(request):
    """The folder for pictures of the lessons, if it is asked for by --screenshots."""
    folder = request.config.getoption("screenshots", None)
    if folder:
        folder.mkdir(parents=True, exist_ok=True)
    return folder
