"""One Jupyter and one browser for all tests in here; without them they are skipped, or fail where they must be."""

import pytest

from .lab import PATIENCE, chromium, enter, jupyter


@pytest.fixture(scope="package")
def browser():
    """Chromium without a window."""
    with chromium() as browser:
        yield browser


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
    context.set_default_timeout(1000 * PATIENCE)
    yield context
    context.close()


@pytest.fixture(scope="package")
def phone(browser, address):
    """A browser as small as a phone's, with a screen to touch."""
    context = browser.new_context(
        base_url=address, viewport={"width": 390, "height": 844}, has_touch=True, is_mobile=True
    )
    context.set_default_timeout(1000 * PATIENCE)
    yield context
    context.close()


@pytest.fixture(scope="package")
def lab(context):
    """A page with Jupyter Lab in it."""
    page = context.new_page()
    enter(page)
    return page
