"""Walk: every page of the built site in a browser that has no network, as on a telephone and as on a desk.

    python .site/walk.py                             through build/site

In:  a folder of pages, and Chromium or Chrome.
Out: a sentence for each fault: a request that leaves the folder, an error of a script, a page that is wider than its
     window, a table that is wider than its place, a slider that does not move, a control without a name, a picture
     without words, a formula or an example that stands there as typed, what the Tab key does not reach, show or leave,
     a search without results.
"""

import shutil
import sys
from pathlib import Path

from playwright.sync_api import sync_playwright

HERE = Path(__file__).resolve().parent
BROWSERS = ("chromium", "chromium-browser", "google-chrome")
WINDOWS = {"telephone": 390, "desk": 1440}  # px
SECONDS = 2  # of processor time, from opening a lesson to the first slider that has moved
NAMELESS = """() => [
  ...document.querySelectorAll("main :is(img:not(a img), button, input, summary, a[href], th)"),
].filter((one) => {
  const words = one.getAttribute("alt") ?? one.getAttribute("aria-label") ?? one.title;
  const label = one.labels?.[0]?.textContent ?? "";
  return !(words || label.trim() || one.textContent.trim() || one.querySelector?.("img[alt], svg")
    || one.closest("[aria-hidden=true]"));
}).map((one) => one.outerHTML.slice(0, 80))"""

TYPED = r"""() => [...document.querySelectorAll("main :is(p, li, dt, td)")].map((one) => one.innerText)
  .filter((text) => /\$\$|\\(?:frac|sum|sqrt|theta|sigma|le)\b|^>>> /.test(text))"""

CUT = """() => [...document.querySelectorAll("main .pst-scrollable-table-container")]
  .filter((one) => one.scrollWidth > one.clientWidth + 1).map((one) => one.innerText.slice(0, 40))"""

# What has the focus: what it is, and what is wrong with how it shows.
FOCUSED = """() => {
  document.getAnimations().filter((one) => one instanceof CSSTransition).forEach((one) => one.finish());
  const one = document.activeElement, { top, bottom, height } = one.getBoundingClientRect();
  if (one === document.body) return null;
  one.dataset.reached = "";
  const ringed = [one, one.form].filter(Boolean).map((each) => getComputedStyle(each))
    .some(({ outlineStyle, boxShadow }) => outlineStyle !== "none" || boxShadow !== "none");
  const hidden = !height || bottom <= 0 || top >= innerHeight;
  return [one.outerHTML.slice(0, 80), hidden ? "out of sight" : ringed ? "" : "looks as without the focus"];
}"""
UNREACHED = """() => [...document.querySelectorAll("main :is(a[href], button, input, summary, [tabindex='0'])")]
  .filter((one) => !("reached" in one.dataset) && one.type !== "radio")
  .filter((one) => one.checkVisibility({ visibilityProperty: true }))
  .map((one) => one.outerHTML.slice(0, 80))"""
MOST_STOPS = 1000  # of the Tab key on a page


def main():
    """Walk through all pages."""
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else HERE.parent / "build" / "site").resolve()
    program = next(filter(None, map(shutil.which, BROWSERS)), None)
    pages = sorted(path for path in folder.rglob("*.html") if "_static" not in path.parts)
    if program is None or not pages:
        sys.exit(f"there must be one of {', '.join(BROWSERS)}, and pages in {folder}")
    faults, slowest = [], 0.0
    with sync_playwright() as play:
        browser = play.chromium.launch(executable_path=program, args=["--no-sandbox"])
        for window, width in WINDOWS.items():
            context = browser.new_context(viewport={"width": width, "height": 900}, offline=True)
            for path in pages:
                name, page = f"{path.relative_to(folder)} ({window})", context.new_page()
                for told in (*look_at(page, path, width), *(by_keys(page) if window == "desk" else ())):
                    if isinstance(told, float):
                        slowest = max(slowest, told)
                    else:
                        faults.append(f"{name}: {told}")
                page.close()
        faults += [f"search: {told}" for told in search(context.new_page(), folder)]
        browser.close()
    print(*faults, sep="\n", end="\n" * bool(faults))
    print(f"{len(pages)} pages, the slowest slider moved after {slowest:.2f} s of processor time, {len(faults)} faults")
    sys.exit(bool(faults))


def look_at(page, path, width):
    """Yield what is wrong with a page, and after how many seconds its slider moved."""
    asked, errors = [], []
    page.on("request", lambda request: asked.append(request.url))
    page.on("pageerror", lambda error: errors.append(str(error)))
    page.on("console", lambda message: errors.append(message.text) if message.type == "error" else None)
    if seconds := moved_after(page, path):
        yield seconds
        if seconds > SECONDS:
            yield f"the slider moved after {seconds:.1f} s of processor time, at most {SECONDS} s"
    if (wide := page.evaluate("document.documentElement.scrollWidth")) > width:
        yield f"{wide} px wide in a window of {width} px"
    yield from (f"nameless: {one}" for one in page.evaluate(NAMELESS))
    yield from (f"wider than its place: a table that begins with {one!r}" for one in page.evaluate(CUT))
    yield from (f"as typed: {one}" for one in page.evaluate(TYPED))
    yield from (f"asks for {url}" for url in asked if not url.startswith(("file:", "data:", "blob:")))
    yield from (f"script: {error}" for error in errors)


def moved_after(page, path):
    """Open a page, and move its first slider by a key; return the processor time of both, or 0 without a slider."""
    clock = page.context.new_cdp_session(page)
    clock.send("Performance.enable")
    begun = processor_time(clock)
    page.goto(path.as_uri(), wait_until="domcontentloaded")
    slider = page.locator(".primkit-states input[type=range]").first
    if not slider.count():
        return 0.0
    picture = ".primkit-states .primkit-picture"
    before = page.locator(picture).first.inner_html()
    slider.press("ArrowRight")
    page.wait_for_function(f"before => document.querySelector('{picture}').innerHTML !== before", arg=before)
    ended = processor_time(clock)
    return ended - begun if ended > begun else ended  # the page may have got a process of its own


def by_keys(page):
    """Yield what is wrong on the way through a page by the Tab key alone, from its top to its end."""
    page.goto(page.url)
    for _ in range(MOST_STOPS):
        page.keyboard.press("Tab")
        if not (told := page.evaluate(FOCUSED)):
            yield from (f"no key reaches {one}" for one in page.evaluate(UNREACHED))
            return
        if told[1]:
            yield f"under Tab {told[0]} {told[1]}"
    yield f"{MOST_STOPS} times Tab do not lead out"


def processor_time(clock):
    """Return how long the page's process has computed: the same on a busy machine as on an idle one."""
    told = clock.send("Performance.getMetrics")["metrics"]
    return next(one["value"] for one in told if one["name"] == "ProcessTime")


def search(page, folder):
    """Yield a sentence if a word that stands in a lesson is not found."""
    page.goto(f"{(folder / 'search.html').as_uri()}?q=silhouette")
    try:
        page.wait_for_selector("#search-results li a", timeout=10_000)
    except Exception as error:
        yield f"finds nothing: {type(error).__name__}"


if __name__ == "__main__":
    main()
