"""Every lesson in a real browser: run, each slider swept from end to end, in both themes and at three sizes.

    python -m tests.benchmarks.swept_lessons --out FOLDER [LESSON...]

What is looked for: errors and warnings; a key that moves no slider; pictures that cannot be drawn; a page that jumps;
parts wider than their place; letters with a contrast below 4.5 and marks of a slider's picture with one below 3. Each
breach is a line. ``--out`` keeps a picture of each lesson at each size, to be looked at.
"""

import argparse
import tempfile
from pathlib import Path

from primkit.palette import PALE
from tests.browser.lab import LESSONS, chromium, enter, jupyter, opened
from tests.browser.test_lessons import ERRORS, PANEL, slider_cells, too_wide

SIZES = {390: 844, 1280: 720, 1440: 900}  # px: a phone, a laptop, a desk
THEMES = ("JupyterLab Light", "JupyterLab Dark")
SWEPT_AT = {("JupyterLab Light", 1280), ("JupyterLab Dark", 390)}
LETTERS, MARKS = 4.5, 3.0  # WCAG 2, contrasts; of pale things, which are frames and ground, none is asked
IN_THEME = "document.body.dataset.jpThemeLight === String(light)"

# Colours as they are seen: through the filter that turns a picture around in the dark theme, on the ground behind it.
CONTRASTS = r"""(GROUND) => {
    const pen = Object.assign(document.createElement("canvas"), { width: 1, height: 1 }).getContext("2d", {
        willReadFrequently: true,
    });
    const seen = (color, filter) => {
        pen.clearRect(0, 0, 1, 1);
        pen.filter = filter;
        pen.fillStyle = color;
        pen.fillRect(0, 0, 1, 1);
        return [...pen.getImageData(0, 0, 1, 1).data];
    };
    const light = ([r, g, b]) => [r, g, b].map((part) => part / 255)
        .map((share) => (share <= 0.03928 ? share / 12.92 : ((share + 0.055) / 1.055) ** 2.4))
        .reduce((sum, share, i) => sum + share * [0.2126, 0.7152, 0.0722][i], 0);
    const contrast = (one, other) => {
        const [low, high] = [light(one), light(other)].sort((a, b) => a - b);
        return (high + 0.05) / (low + 0.05);
    };
    const behind = (part) => {
        for (; part; part = part.parentElement) {
            const color = getComputedStyle(part).backgroundColor;
            if (seen(color, "none")[3] === 255) return color;
        }
        return "white";
    };
    const found = new Map(); // words -> the least contrast
    const note = (words, value) => found.set(words, Math.min(found.get(words) ?? 99, value));

    for (const svg of document.querySelectorAll(".primkit-picture svg")) {
        const filter = getComputedStyle(svg.closest(".primkit-picture")).filter;
        const ground = seen("white", filter);
        for (const part of svg.querySelectorAll("text, path, circle")) {
            const letters = part.tagName === "text";
            for (const kind of letters ? ["fill"] : ["fill", "stroke"]) {
                const color = part.getAttribute(kind);
                if ([null, "none", "white", GROUND].includes(color) || part.getAttribute(`${kind}-opacity`)) continue;
                note(`${letters ? "letters" : "marks"} ${color}`, contrast(seen(color, filter), ground));
            }
        }
    }
    const words = document.createTreeWalker(document.querySelector(".jp-Notebook"), NodeFilter.SHOW_TEXT);
    while (words.nextNode()) {
        const part = words.currentNode.parentElement, said = words.currentNode.data.trim().slice(0, 24);
        if (!said || !part.offsetParent || part.closest("svg, .MathJax, mjx-container")) continue;
        if (part.closest(".jp-InputArea, .jp-OutputPrompt, [aria-hidden=true]")) continue; // Lab's own
        const { color } = getComputedStyle(part);
        const value = contrast(seen(color, "none"), seen(behind(part), "none"));
        note(`letters ${color} in ${part.tagName.toLowerCase()} "${said}"`, value);
    }
    return [...found];
}"""


def told(slider):
    """Return the value that stands beside a slider."""
    return slider.place.locator(".widget-readout").inner_text()


def pressed(panel, slider, key):
    """Press a key on a slider; return the value that stands beside it then."""
    slider.press(key)
    panel.settle()
    return told(slider)


def swept(panel):
    """Move each slider from end to end; yield what goes wrong."""
    for slider in panel.sliders:
        least, most = (pressed(panel, slider, key) for key in ("Home", "End"))
        for _ in range(5):
            before = told(slider)
            if before != least and pressed(panel, slider, "ArrowLeft") == before:
                yield f"{slider.name}: ArrowLeft is lost at {before}"
        pressed(panel, slider, "Home")
        for _ in range(80):  # a page up is five steps
            before = told(slider)
            if pressed(panel, slider, "PageUp") == before:
                break
        if told(slider) != most:
            yield f"{slider.name}: PageUp is lost at {told(slider)}"
    for choice in panel.choices:
        for option in choice.options:
            panel.changes(option.click)
    for setting in panel.settings:
        panel.changes(setting.click)
    yield from dict.fromkeys(panel.seen("failures"))
    heights = set(panel.seen("heights"))
    if len(heights) > 1:
        yield f"the page below jumps: heights of {min(heights)} to {max(heights)} px"


def dressed(page, theme):
    """Show Lab in a theme."""
    page.evaluate("(theme) => window.jupyterapp.commands.execute('apputils:change-theme', { theme })", theme)
    page.wait_for_function(f"(light) => {IN_THEME}", arg="Light" in theme)
    page.wait_for_timeout(500)  # ms: until all is drawn anew


def breaches(lesson, out):
    """Yield each breach of a lesson that is open, as a sentence."""
    page = lesson.page
    if len(lesson.panels) != lesson.slider_cells:
        yield f"{len(lesson.panels)} of {lesson.slider_cells} sliders are shown"
    for output in page.locator(ERRORS).all():
        yield output.inner_text().strip().splitlines()[-1]
    for theme in THEMES:
        dressed(page, theme)
        for width, height in SIZES.items():
            where = f"{theme.split()[1]} {width}"
            lesson.widen(width, height)
            parts = f"{PANEL}, .jp-RenderedImage, .primkit-picture"
            yield from (f"{where}: {one}" for one in too_wide(page, parts))
            for what, value in page.evaluate(CONTRASTS, PALE):
                if value < (MARKS if what.startswith("marks") else LETTERS) - 0.05:
                    yield f"{where}: {what}: contrast {value:.1f}"
            if (theme, width) in SWEPT_AT:
                for number, panel in enumerate(lesson.panels, 1):
                    panel.watch_anew()
                    yield from (f"{where}: slider {number}: {one}" for one in swept(panel))
            if out and (theme == THEMES[0]) == (width != 1280):  # one picture a size: the laptop is dark
                lesson.widen(width, min(lesson.page_height() + 80, 16_000))
                page.screenshot(path=out / f"{lesson.name}_{width}.png")
    yield from dict.fromkeys(words.strip().splitlines()[-1] for words in lesson.said() if words.strip())


def main():
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks.swept_lessons")
    parser.add_argument("lessons", nargs="*", default=LESSONS)
    parser.add_argument("--out", type=Path)
    asked = parser.parse_args()
    if asked.out:
        asked.out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder, chromium() as browser, jupyter(Path(folder)) as address:
        context = browser.new_context(base_url=address, viewport={"width": 1280, "height": 720})
        context.set_default_timeout(180_000)
        page = context.new_page()
        enter(page)
        for name in asked.lessons:
            with opened(page, name, slider_cells(name)) as lesson:
                found = [f"{name}: {breach}" for breach in breaches(lesson, asked.out)]
                print(*found, f"{name}: {len(found)} breaches", sep="\n", flush=True)
            page.set_viewport_size({"width": 1280, "height": 720})


if __name__ == "__main__":
    main()
