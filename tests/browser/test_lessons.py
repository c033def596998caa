"""Every lesson in a real browser: each slider moves its picture by keys and by mouse, nothing jumps, and all fits.

What stands in no control is shown as it is stored: nbval runs all cells, and so does the benchmark ``swept_lessons``.

Each rule is a function from an open lesson, or from one of its panels, to sentences, one for each breach. It is held on
every lesson, and shown a lesson in which much is broken, which it must report.
"""

import json
import re
from functools import partial

import numpy as np
import pytest

from tests.helpers import WAITS

from .lab import LESSONS, ROOT, TOKEN, blank_notebook, opened
from .panel import panels

WIDE, NARROW = 1280, 390  # px: a laptop, and a phone
PRESSES = 12  # measured key presses for each lesson
UNBEARABLE = 1000  # ms: far above what is measured, as the machine may be busy

ARROWS = ("ArrowRight", "ArrowRight", "ArrowLeft", "End", "Home")
PANEL = ".jupyter-widgets, .widget-label"  # a name that is too long is cut off
CONTROLS = r"^pk\.widgets\.(?!answer|guesses|show_)\w+\("  # sliders, predictions, diagrams
SLIDER_CELL = re.compile(r"pk\.widgets\.(?!guesses)\w+\(\)")
ERRORS = '[data-mime-type="application/vnd.jupyter.error"], [data-mime-type="application/vnd.jupyter.stderr"]'


def slider_cells(name):
    """Return how many cells of a lesson show a slider."""
    cells = json.loads((ROOT / "notebooks" / f"{name}.ipynb").read_text(encoding="utf-8"))["cells"]
    return sum(bool(SLIDER_CELL.fullmatch("".join(cell["source"]).strip())) for cell in cells)


def keys_move(panel):
    for slider in panel.sliders:
        if not panel.some_change(partial(slider.press, key) for key in ARROWS):
            yield f"{slider.name}: no arrow key changes the picture"
    for choice in panel.choices:
        if not panel.some_change(partial(option.press, "Enter") for option in choice.options):
            yield f"{choice.name}: Enter on its options changes nothing in the picture"
    if panel.root.locator("select").count():
        yield "a drop-down list: Lab keeps the arrow keys to itself"


def mouse_moves(panel):
    for slider in panel.sliders:
        if not panel.some_change(partial(slider.drag, share) for share in (0.3, 0.7)):
            yield f"{slider.name}: the mouse changes nothing in the picture"
    for choice in panel.choices:
        if not panel.some_change(option.click for option in choice.options):
            yield f"{choice.name}: a click on its options changes nothing in the picture"


def settings_differ(panel):
    """By mouse and by key the same picture, and another one for each setting."""
    pictures = {}
    for setting in panel.settings:
        panel.changes(setting.click)
        pictures[setting.name] = panel.picture()
    if len(set(pictures.values())) < len(panel.settings):
        yield "two settings show the same picture"
    for setting in panel.settings:
        panel.changes(partial(setting.press, "Enter"))
        if panel.picture() != pictures[setting.name]:
            yield f"{setting.name}: Enter shows another picture than the mouse"


def of_each_panel(rule):
    """Return the rule for a whole lesson; whatever is moved, no picture is an error, and the page below stays."""

    def checked(lesson):
        for number, panel in enumerate(lesson.panels, 1):
            panel.start_over()
            breaches = [*rule(panel), *dict.fromkeys(panel.seen("failures"))]
            heights = set(panel.seen("heights"))
            if len(heights) > 1:
                breaches.append(f"the page below jumps: heights of {min(heights)} to {max(heights)} px")
            yield from (f"slider {number}: {breach}" for breach in breaches)

    return checked


def cells_run(lesson):
    """No error and no warning in the page, and all panels are there."""
    if len(lesson.panels) != lesson.slider_cells:
        yield f"{len(lesson.panels)} of {lesson.slider_cells} sliders are shown"
    for output in lesson.page.locator(ERRORS).all():
        yield output.inner_text().strip().splitlines()[-1]


def callbacks_run(lesson):
    """No error and no warning from a callback, which the page does not show."""
    yield from dict.fromkeys(words.strip().splitlines()[-1] for words in lesson.said() if words.strip())


def fits_a_laptop(lesson):
    """Nothing is cut off or scrolls sideways at the width of a laptop."""
    lesson.widen(WIDE)
    yield from too_wide(lesson.page, f"{PANEL}, .jp-OutputArea-output, .jp-RenderedMarkdown")


def fits_a_phone(lesson):
    """No slider and no plot is cut off or scrolls sideways at the width of a phone; tables and twins may."""
    lesson.widen(NARROW)
    yield from too_wide(lesson.page, f"{PANEL}, .jp-RenderedImage")


def cells_stay(lesson):
    """No key on a control is the notebook's: an X would cut a cell."""
    cells = lesson.page.locator(".jp-Cell")
    before = cells.count()
    for control in lesson.page.locator(".jupyter-widgets :is(button, .noUi-handle)").all():
        control.press("x")
        if cells.count() < before:
            yield f"a key on a control cut {before - cells.count()} of {before} cells"
            return


TOO_WIDE = """(cells, selector) => cells.flatMap((cell, number) =>
    [...cell.querySelectorAll(selector)]
        .filter((part) => part.clientWidth && part.scrollWidth > part.clientWidth + 1)
        .map((part) => `cell ${number + 1}: ${part.scrollWidth} px wide, ${part.clientWidth} px are there`)
        .slice(0, 1))"""


def too_wide(page, selector):
    """Return a sentence for each cell in which a part needs more room than it has."""
    return page.locator(".jp-Cell").evaluate_all(TOO_WIDE, selector)


def told_to_who_cannot_see(panel):
    """Each slider has the name that stands beside it, and tells the value that stands there."""
    for slider in panel.sliders:
        name, value = slider.told()
        if name != slider.name:
            yield f"{slider.name}: its handle is called {name}"
        if value != slider.place.locator(".widget-readout").inner_text():
            yield f"{slider.name}: its value is told as {value}"


RULES = {
    "cells run": cells_run,
    "sliders tell": of_each_panel(told_to_who_cannot_see),
    "keys move the picture": of_each_panel(keys_move),
    "mouse moves the picture": of_each_panel(mouse_moves),
    "settings differ": of_each_panel(settings_differ),
    "callbacks run": callbacks_run,
    "fits a laptop": fits_a_laptop,
    "fits a phone": fits_a_phone,
    "cells stay": cells_stay,  # the last: a lesson that has lost a cell is no lesson any more
}


def measured_waits(lesson):
    """Press arrow keys on the sliders in turn until enough have changed the picture; return the waits in ms."""
    waits = []
    for _ in range(PRESSES):
        for panel in lesson.panels:
            panel.watch_anew()
            for slider in panel.sliders:
                slider.step()
                panel.settle()
            waits += panel.seen("waits")
        if len(waits) >= PRESSES:
            break
    return waits


@pytest.fixture(scope="module", params=LESSONS)
def lesson(request, lab, screenshots):
    lab.set_viewport_size({"width": WIDE, "height": 1000})
    with opened(lab, request.param, slider_cells(request.param), CONTROLS) as lesson:
        yield lesson
        if screenshots:
            lesson.photograph(screenshots, [WIDE, NARROW])


@pytest.mark.parametrize("rule", RULES)
def test_a_lesson_keeps_the_rule(lesson, rule):
    assert list(RULES[rule](lesson)) == []


# Restarts the kernel of one notebook, as its menu does.
RESTART = """async (token) => {
    const ask = async (path, method) => fetch(`/api/${path}`, { method, headers: { Authorization: `token ${token}` } });
    const sessions = await (await ask("sessions", "GET")).json();
    const { kernel } = sessions.find(({ path }) => path === "slider.ipynb");
    await ask(`kernels/${kernel.id}/restart`, "POST");
}"""


def test_arrow_keys_move_a_slider_in_notebook_7_and_silence_is_told(browser, address, folder):
    """Its own arrow keys would go to the next cell; and after a restart the picture would stay, without a word."""
    (folder / "notebooks" / "slider.ipynb").write_text(
        blank_notebook(["import primkit as pk\npk.widgets.edges()", "1"])
    )
    context = browser.new_context(base_url=address, viewport={"width": WIDE, "height": 1000})
    page = context.new_page()
    page.goto(f"/notebooks/slider.ipynb?token={TOKEN}")
    page.locator(".jp-Notebook .jp-CodeCell .cm-content").first.click()
    page.wait_for_timeout(3000)  # ms: until the kernel is there
    page.keyboard.press("Shift+Enter")
    (panel,) = panels(page, 1, settle=lambda: None)
    slider, before = panel.sliders[0], panel.picture()
    slider.place.locator(".noUi-handle").focus()
    page.keyboard.press("ArrowRight")
    panel.await_another(before)
    page.keyboard.press("ArrowRight")
    assert slider.place.locator(".noUi-handle").evaluate("(handle) => handle === document.activeElement")
    assert slider.told() == ("trial", "12")
    silent = page.get_by_text("Python does not answer")
    assert silent.count() == 0
    page.evaluate(RESTART, TOKEN)
    page.keyboard.press("ArrowRight")
    silent.wait_for()
    context.close()


def test_a_key_press_is_soon_a_picture(lesson, record_property):
    """Measured and shown in the end; what is asserted is far above, as the machine may be busy."""
    if not lesson.slider_cells:
        pytest.skip("this lesson has no slider")
    waits = measured_waits(lesson)
    record_property(WAITS, (lesson.name, waits))
    assert len(waits) >= PRESSES
    assert np.median(waits) < UNBEARABLE
