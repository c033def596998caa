"""The live scene in a real browser: keys and buttons drive the robot, the picture follows, and no cell is harmed."""

import re

import numpy as np
import pytest

from tests.helpers import WAITS

from .lab import RUN, TOKEN, blank_notebook, enter, opened

NAME = "scene"
CELLS = [
    "import primkit as pk\npk.drive_scene(pk.random_world(4, rng=7))",
    "'a cell that must stay'",
]
COUNT = """import threading
from primkit.scene.given_back import MADE_BY
print(len(MADE_BY), "made,", sum(thread.name == "primkit-finder" for thread in threading.enumerate()), "threads")"""
MOVING = ["import primkit as pk\npk.drive_scene(pk.random_world(4, rng=7), pk.Lidar(noise_std=0.002), moving=True)"]
FILM = [
    "import numpy as np, primkit as pk\nworld = pk.random_world(4, rng=7)",
    "poses = pk.drive(world, [(6, 4)] * 60)\ndrive = pk.Drive(pk.scan(world, poses), np.zeros((61, 2)))",
    "pk.replay(drive, world)",
]
POLL = 50  # ms: the page is looked at so often; by default at every frame, which costs as much as the scene
PRESSES = 12  # measured key presses
LONGEST = 60  # looks at a robot that shall come to rest
UNBEARABLE = 1000  # ms: far above what is measured, as the machine may be busy
WIDE, NARROW = 1280, 390  # px

# All that is said from here on: the news of a look may stand in its place before anybody asks.
LISTEN = """(says) => {
    window.said = [];
    const heard = () => window.said.push(says.textContent);
    new MutationObserver(heard).observe(says, { childList: true, characterData: true, subtree: true });
}"""
# Waits from the key to the picture, measured in the page, where no other clock is in the way.
WATCH = """(root) => {
    const watch = { waits: [], pressed: 0 };
    root.addEventListener("keydown", (event) => { watch.pressed = event.timeStamp; }, { capture: true });
    new MutationObserver(() => {
        if (watch.pressed) watch.waits.push(performance.now() - watch.pressed);
        watch.pressed = 0;
    }).observe(root, { attributes: true, attributeFilter: ["data-scans"] });
    return watch;
}"""


LAPTOP = {"width": 1280, "height": 720}
# Where the notebook begins and ends in the window.
IN_SIGHT = """(root) => {
    const { top, bottom } = root.closest(".jp-WindowedPanel-outer, .jp-Notebook").getBoundingClientRect();
    return [top, bottom];
}"""
# The contrast of a part's letters to what lies behind them, as WCAG 2 has it.
CONTRAST = r"""(part) => {
    const rgb = (color) => color.match(/[\d.]+/g).map(Number);
    let back = part;
    while (rgb(getComputedStyle(back).backgroundColor)[3] === 0) back = back.parentElement;
    const light = (color) => rgb(color).slice(0, 3).map((share) => share / 255)
        .map((share) => (share <= 0.03928 ? share / 12.92 : ((share + 0.055) / 1.055) ** 2.4))
        .reduce((sum, share, i) => sum + share * [0.2126, 0.7152, 0.0722][i], 0);
    const [low, high] = [light(getComputedStyle(part).color), light(getComputedStyle(back).backgroundColor)].sort();
    return (high + 0.05) / (low + 0.05);
}"""


def notebook(sources=CELLS):
    """Return a notebook as text: with a scene, and a cell after it."""
    return blank_notebook(sources)


class Seat:
    """Where one drives: the scene in a page."""

    def __init__(self, page, number=0) -> None:
        self.page, self.root = page, page.locator(".primkit-scene").nth(number)
        self.root.locator("canvas").wait_for()
        self.until("root.dataset.pose")

    def until(self, what, n=None):
        """Wait until something is so of the scene's root."""
        handle = self.root.element_handle()
        self.page.wait_for_function(f"([root, n]) => {what}", arg=[handle, n], polling=POLL)

    @property
    def scans(self):
        return int(self.root.get_attribute("data-scans"))

    @property
    def pose(self):
        return np.array(self.root.get_attribute("data-pose").split(), dtype=float)

    @property
    def score(self):
        return self.root.locator(".score").inner_text()

    def picture(self):
        return self.root.locator("canvas").evaluate("(canvas) => canvas.toDataURL()")

    def button(self, name):
        return self.root.get_by_role("button", name=name, exact=True)

    def after(self, scans):
        """Wait until the page shows that many scans or more."""
        self.until("+root.dataset.scans >= n", scans)

    def hold(self, keys, scans):
        """Hold keys until that many more scans are seen."""
        until = self.scans + scans
        for key in keys:
            self.page.keyboard.down(key)
        self.after(until)
        for key in keys:
            self.page.keyboard.up(key)
        self.stands()

    def stands(self):
        """Wait until nothing moves for three steps; return how many scans there are then."""
        quiet, before = 0, self.scans
        for _ in range(LONGEST):
            self.page.wait_for_timeout(120)
            quiet, before = (quiet + 1, before) if self.scans == before else (0, self.scans)
            if quiet == 3:
                return before
        return pytest.fail("the robot does not stop")

    def rests(self):
        """Wait until no more shapes are looked for."""
        self.until("root.dataset.busy === 'false'")


@pytest.fixture(scope="module")
def lesson(lab, folder):
    (folder / "notebooks" / f"{NAME}.ipynb").write_text(notebook())
    lab.set_viewport_size({"width": WIDE, "height": 1000})
    with opened(lab, NAME, 0) as lesson:
        yield lesson


@pytest.fixture(scope="module")
def seat_in_lab(lesson):
    return Seat(lesson.page)


@pytest.fixture
def seat(seat_in_lab, lesson):
    """The driver's seat, at the start, with the focus."""
    seat_in_lab.stands()
    seat_in_lab.button("Back to the start").click()
    lesson.settle()
    seat_in_lab.rests()
    seat_in_lab.root.locator("canvas").click()
    return seat_in_lab


def cells_in(page):
    return page.locator(".jp-Notebook .jp-CodeCell").count()


@pytest.mark.parametrize(
    ("keys", "way"), [("w", (1, 0)), (["ArrowUp"], (1, 0)), ("s", (-1, 0)), ("a", (0, 1)), (["ArrowRight"], (0, -1))]
)
def test_keys_drive_and_the_picture_follows(seat, keys, way):
    before, picture = seat.pose, seat.picture()
    seat.hold(keys, 3)
    x, _, heading = seat.pose - before
    np.testing.assert_array_equal(np.sign([round(x, 4), round(heading, 4)]), way)
    assert seat.picture() != picture


def test_two_keys_at_once_drive_an_arc(seat):
    before = seat.pose
    seat.hold(["w", "ArrowLeft"], 4)
    x, _, heading = seat.pose - before
    assert x > 0.02
    assert heading > 0.3


def test_a_tap_is_a_step(seat):
    for taps in range(1, 4):
        seat.page.keyboard.press("w")
        seat.stands()
        assert seat.pose[0] == pytest.approx(0.01287 * taps, abs=1e-4)


def test_the_map_grows_and_shapes_get_their_names(seat, screenshots):
    assert "1 scan ·" in seat.score
    assert "score 0.00" in seat.score
    seat.hold(["w", "d"], 45)
    seat.hold(["w"], 25)
    seat.hold(["w", "a"], 45)
    assert "score 0.00" not in seat.score
    label = seat.root.locator("canvas").get_attribute("aria-label")
    assert "Found: " in label
    assert ("not certain" in label) == ("not certain" in seat.score), "no name that is not earned"
    assert "Found so far: " in seat.root.locator("p.says[aria-live=polite]").inner_text()
    seat.button("What have I not seen yet?").click()
    seat.button("Compare: automatic").click()
    table = seat.root.locator("div.automatic table")
    table.wait_for()
    assert table.locator("tr").all_inner_texts()[0].split() == ["scans", "robot", "time", "found", "score"]
    assert table.locator("th:first-child").all_inner_texts()[1:] == ["by hand", "way-points", "explore"]
    if screenshots:
        for width in (WIDE, NARROW):
            seat.page.set_viewport_size({"width": width, "height": 1000})
            seat.page.wait_for_timeout(300)
            seat.root.screenshot(path=screenshots / f"scene_{width}.png")
    seat.page.set_viewport_size({"width": WIDE, "height": 1000})
    seat.button("What have I not seen yet?").click()


def test_leaving_stops_the_robot(seat):
    seat.page.keyboard.down("w")
    seat.after(4)
    seat.page.locator(".jp-Notebook .jp-CodeCell .cm-content").last.click()
    scans = seat.stands()
    assert "driving" not in seat.root.get_attribute("class")
    seat.page.keyboard.up("w")
    assert seat.stands() == scans
    seat.root.locator("canvas").click()
    assert "driving" in seat.root.get_attribute("class")
    assert seat.stands() == scans, "the key that was held then must not be held now"


def test_leaving_the_window_stops_the_robot(seat):
    """Another window in front: the key is let go there, and this page never hears of it."""
    seat.page.keyboard.down("w")
    seat.after(4)
    seat.page.evaluate("window.dispatchEvent(new Event('blur'))")
    scans = seat.stands()
    seat.page.keyboard.up("w")
    assert seat.stands() == scans


def test_tab_leaves_to_the_buttons_and_on(seat):
    for name in ("forward", "left", "back", "right", "Pause"):  # in this order, and nothing else between them
        seat.page.keyboard.press("Tab")
        assert seat.button(name).evaluate("(button) => button === document.activeElement")
    before = seat.pose
    seat.button("forward").press("Enter")
    seat.stands()
    assert seat.pose[0] > before[0]


def texts_in(page):
    return page.locator(".jp-Notebook .jp-CodeCell .cm-content").all_inner_texts()


def harm(page, keys):
    """Press keys where one drives; tell whether a cell is gone, new, or another."""
    texts = texts_in(page)
    for key in keys:
        page.keyboard.press(key)
    page.wait_for_timeout(1500)  # ms: so long Lab waits for the second of two keys
    return texts_in(page) != texts


def test_no_key_harms_a_cell(seat):
    assert not harm(seat.page, "ddaabbxxzzmm11ii00")
    seat.page.keyboard.press("Shift+Enter")
    seat.stands()
    assert cells_in(seat.page) == len(CELLS)
    assert seat.page.locator(".jp-Dialog").count() == 0


# Takes from the scene what keeps its keys from Lab: the sign for Lab, and that it lets no key go on as unused.
UNGUARD = """(root) => {
    root.removeAttribute("data-lm-suppress-shortcuts");
    root.addEventListener("keydown", (event) => {
        event.stopPropagation = event.preventDefault = () => {};
    }, { capture: true });
}"""


@pytest.fixture(scope="module")
def another_lab(browser, address):
    """A browser of its own: Lab reloads a second page in the same one. What is harmed here is seen by nobody else."""
    context = browser.new_context(base_url=address, viewport={"width": WIDE, "height": 1000})
    page = context.new_page()
    enter(page)
    yield page
    context.close()


def test_without_its_guards_the_same_keys_harm_a_cell(another_lab, folder):
    """The trap is there, and the test above sees it."""
    (folder / "notebooks" / "unguarded.ipynb").write_text(notebook(3 * CELLS))
    with opened(another_lab, "unguarded", 0):
        for number, keys in ((2, "xx"), (1, "aabb"), (0, "dd")):  # from the last on: the first is the last to go
            seat = Seat(another_lab, number)
            seat.root.locator("canvas").click()
            seat.root.evaluate(UNGUARD)
            assert harm(another_lab, keys), keys


def test_after_a_click_into_a_film_no_key_harms_a_cell(another_lab, folder):
    (folder / "notebooks" / "clicked.ipynb").write_text(notebook(FILM))
    with opened(another_lab, "clicked", 0):
        player = Player(another_lab)
        player.root.locator("canvas").click()
        assert not harm(another_lab, "ddxx")


def test_a_cell_that_is_run_gives_its_scene_the_focus(another_lab, folder):
    """Nobody has clicked into it, and d d deletes no cell; Escape gives the keys back to the notebook."""
    page = another_lab
    (folder / "notebooks" / "focus.ipynb").write_text(notebook())
    with opened(page, "focus", 0):
        page.locator(".jp-Notebook .jp-CodeCell .cm-content").first.click()
        page.evaluate("document.querySelector('.primkit-scene').remove()")
        page.keyboard.press("Shift+Enter")
        seat = Seat(page)
        page.wait_for_function("document.activeElement.className.startsWith('primkit-scene')")
        assert not harm(page, "dd")
        assert not seat.root.locator(".cover").is_visible()
        seat.hold(["w"], 3)
        page.keyboard.press("Escape")
        assert seat.root.locator(".cover").is_visible()
        scans = seat.stands()
        page.keyboard.press("ArrowDown")
        assert seat.stands() == scans


def test_who_writes_meanwhile_is_not_disturbed(another_lab, folder):
    """The scene that appears then leaves the focus where it is, and says that it waits for a click."""
    page, late = another_lab, f"import time\ntime.sleep(2)\n{CELLS[0]}"
    (folder / "notebooks" / "late.ipynb").write_text(notebook([late, CELLS[1]]))
    with opened(page, "late", 0):
        page.locator(".jp-Notebook .jp-CodeCell .cm-content").first.click()
        page.evaluate("document.querySelector('.primkit-scene').remove()")
        page.keyboard.press("Shift+Enter")
        page.locator(".jp-Notebook .jp-CodeCell .cm-content").last.click()
        seat = Seat(page)
        page.keyboard.type("dd")
        assert "dd" in texts_in(page)[-1]
        assert seat.root.locator(".cover").is_visible()


def test_a_kernel_that_does_not_answer_is_told(another_lab, folder):
    """After a restart the picture would stay, without a word."""
    page = another_lab
    (folder / "notebooks" / "restart.ipynb").write_text(notebook())
    with opened(page, "restart", 0):
        seat = Seat(page)
        seat.root.locator("canvas").click()
        seat.hold(["w"], 2)
        page.evaluate("window.jupyterapp.shell.currentWidget.sessionContext.session.kernel.restart()")
        page.wait_for_timeout(1000)
        seat.root.locator("canvas").click()
        page.keyboard.press("w")
        seat.root.locator("p.trouble", has_text="Python does not answer").wait_for()


def test_in_notebook_7_keys_drive_and_harm_no_cell(browser, address, folder):
    """Its shortcuts are those of Lab, and it has no other guard."""
    (folder / "notebooks" / "seven.ipynb").write_text(notebook())
    context = browser.new_context(base_url=address, viewport={"width": WIDE, "height": 1000})
    page = context.new_page()
    page.goto(f"/notebooks/seven.ipynb?token={TOKEN}")
    page.locator(".jp-Notebook .jp-CodeCell .cm-content").first.click()
    page.wait_for_timeout(3000)  # ms: until the kernel is there
    page.keyboard.press("Shift+Enter")
    seat = Seat(page)
    before = seat.pose
    seat.hold(["ArrowUp"], 3)
    assert (seat.pose - before)[0] > 0.02
    assert not harm(page, "dd")
    context.close()


def test_scenes_that_nobody_sees_any_more_are_given_back(another_lab, folder):
    """After six runs of its cell there is one scene, and no thread that waits."""
    (folder / "notebooks" / "again.ipynb").write_text(notebook([CELLS[0], COUNT]))
    with opened(another_lab, "again", 0) as lesson:
        for _ in range(5):
            another_lab.evaluate(RUN)
        lesson.settle()
        assert another_lab.locator(".jp-OutputArea-output").last.inner_text().startswith("1 made, ")
        assert int(another_lab.locator(".jp-OutputArea-output").last.inner_text().split()[2]) <= 1
        assert another_lab.locator(".primkit-scene").count() == 1


def test_all_is_in_view_on_a_laptop(seat, screenshots):
    """Board, score and every button, without scrolling, in a window of 1280 x 720, in both themes, readable."""
    page = seat.page
    page.set_viewport_size(LAPTOP)
    for theme in ("JupyterLab Dark", "JupyterLab Light"):
        before = seat.picture()
        page.evaluate("(theme) => window.jupyterapp.commands.execute('apputils:change-theme', { theme })", theme)
        page.wait_for_function(
            "(dark) => document.querySelector('.primkit-scene').classList.contains('dark') === dark",
            arg="Dark" in theme,
        )
        page.wait_for_timeout(300)
        assert seat.picture() != before
        seat.root.evaluate("(root) => root.scrollIntoView()")
        low, high = seat.root.evaluate(IN_SIGHT)
        for part in ("canvas", ".score", *(f"button >> nth={n}" for n in range(8))):
            box = seat.root.locator(part).bounding_box()
            assert low <= box["y"], part
            assert box["y"] + box["height"] <= high, part
            assert box["x"] + box["width"] <= LAPTOP["width"], part
        for part in (".score", ".focus", ".says", "button.pause", "summary"):
            assert seat.root.locator(part).first.evaluate(CONTRAST) >= 4.5, (theme, part)
        if screenshots:
            page.screenshot(path=screenshots / f"scene_laptop_{theme.split()[1].lower()}.png")
    page.set_viewport_size({"width": WIDE, "height": 1000})


def test_buttons_drive_with_the_mouse(seat):
    before = seat.pose
    button = seat.button("forward")
    button.hover()
    seat.page.mouse.down()
    seat.after(4)
    seat.page.mouse.up()
    scans = seat.stands()
    assert (seat.pose - before)[0] > 0.02
    seat.button("left").click()
    seat.after(scans + 1)
    seat.stands()  # on a busy machine the last scan of the drive before may have come after the click
    assert seat.pose[2] > 0


def test_a_pause_holds_the_robot(seat):
    seat.button("Pause").click()
    seat.root.locator("canvas").click()
    seat.page.keyboard.press("w")
    seat.root.get_by_text("Paused").first.wait_for()
    assert seat.stands() == 1
    seat.button("Pause").click()
    seat.hold("w", 2)


def test_the_truth_is_only_drawn_when_it_is_asked_for(seat):
    hidden = seat.picture()
    for shown in (True, False):
        seat.button("Show the truth").click()
        seat.root.locator(f"button[aria-pressed={str(shown).lower()}]", has_text="truth").wait_for()
        assert (seat.picture() != hidden) == shown


def test_a_key_press_is_soon_a_picture(seat, record_property):
    """Measured and shown in the end; what is asserted is far above, as the machine may be busy."""
    watch = seat.root.evaluate_handle(WATCH)
    for press in range(PRESSES):
        seat.page.keyboard.down("wa"[press % 2])
        seat.after(seat.scans + 1)
        seat.page.keyboard.up("wa"[press % 2])
        seat.stands()
    waits = watch.evaluate("(watch) => watch.waits")
    record_property(WAITS, ("the scene", waits))
    assert len(waits) == PRESSES
    assert np.median(waits) < UNBEARABLE


def test_it_fits_a_phone(seat):
    seat.page.set_viewport_size({"width": NARROW, "height": 1000})
    wide = seat.root.evaluate("(root) => [root.scrollWidth - root.clientWidth, root.parentElement.clientWidth]")
    seat.page.set_viewport_size({"width": WIDE, "height": 1000})
    assert wide[0] <= 1


def test_the_kernel_has_nothing_to_complain_of(lesson, seat):
    seat.hold("w", 3)
    assert lesson.said() == []


def in_voila(context, folder, name, sources):
    """Open a notebook as a page without code."""
    (folder / "notebooks" / f"{name}.ipynb").write_text(notebook(sources))
    page = context.new_page()
    page.goto(f"/voila/render/{name}.ipynb?token={TOKEN}")
    return page


@pytest.fixture(scope="module")
def touched(phone, folder):
    """The scene on a screen that is touched."""
    page = in_voila(phone, folder, "touched", CELLS)
    yield Seat(page)
    page.close()


@pytest.fixture
def finger(touched):
    """Puts a finger down on a button, or takes it away."""
    session = touched.page.context.new_cdp_session(touched.page)

    def touch(kind, name=None):
        points = []
        if name:
            touched.button(name).scroll_into_view_if_needed()
            box = touched.button(name).bounding_box()
            points = [{"x": box["x"] + box["width"] / 2, "y": box["y"] + box["height"] / 2}]
        session.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})

    return touch


def test_a_touch_is_a_step(touched, screenshots):
    for number, (name, place) in enumerate([("forward", 0), ("left", 2)], start=1):
        before = touched.pose
        touched.button(name).tap()
        assert touched.stands() <= 2 * number + 1
        assert touched.pose[place] > before[place]
    if screenshots:
        touched.page.screenshot(path=screenshots / "scene_touch.png", full_page=True)


@pytest.mark.parametrize("end", ["touchEnd", "touchCancel"])
def test_a_finger_drives_while_it_stays(touched, finger, end):
    before, scans = touched.pose, touched.scans
    finger("touchStart", "back")
    touched.after(scans + 5)
    finger(end)
    touched.stands()
    assert np.hypot(*(touched.pose - before)[:2]) > 0.04


def test_in_voila_keys_drive_too(touched, screenshots):
    before = touched.pose
    touched.root.locator("canvas").click()
    touched.hold(["w"], 4)
    assert (touched.pose - before)[0] > 0.02
    if screenshots:
        touched.page.screenshot(path=screenshots / "scene_voila.png", full_page=True)


def test_a_thing_is_moved_while_noise_keeps_the_kernel_busy(context, folder, screenshots):
    page = in_voila(context, folder, "moving", MOVING)
    seat = Seat(page)
    seat.root.locator("canvas").click()
    seat.hold(["w", "d"], 30)
    seat.button("Show the truth").click()
    before = seat.picture()
    seat.root.locator("p.says").evaluate(LISTEN)
    seat.button("Move something").click()
    page.wait_for_function("said.some((text) => text.startsWith('Somebody has moved a shape'))")
    page.wait_for_timeout(300)
    assert seat.picture() != before
    seat.hold(["w"], 10)
    seat.rests()
    assert "old" not in seat.score
    if screenshots:
        seat.root.screenshot(path=screenshots / "scene_moving.png")
    page.close()


# One's own code is the robot's eyes.

MEASURE = "    one = pk.measure_shape(points, 0.0004)\n    return one and (one.shape, one.margin)"
OWN = {
    "a right fit_circle": ("def mine(points):\n    return pk.fit_circle(points)", "fit_circle"),
    "a wrong fit_circle": ("def mine(points):\n    return (*points.mean(axis=0), 0.12)", "fit_circle"),
    "a right segment": ("def mine(points, n):\n    return pk.link(points)", "segment"),
    "a wrong segment": ("def mine(points, n):\n    return (points[:, 0] > 0.2).astype(int)", "segment"),
    "a right fit_line": ("def mine(points):\n    return pk.fit_line(points)", "fit_line"),
    "a wrong fit_line": (
        "def mine(points):\n    line = pk.fit_line(points)\n    return line.angle + 0.3, line.offset",
        "fit_line",
    ),
    "a right measure": (f"def mine(points):\n{MEASURE}", "measure"),
    "a wrong measure": ("def mine(points):\n    return pk.Circle(points.mean(axis=0), 0.4), 99", "measure"),
    "a right score": (
        "def mine(found, world):\n    return pk.evaluate(found, world).weighted_accuracy",
        "score",
    ),
    "a wrong score": ("def mine(found, world):\n    return min(1.0, len(found) / 2)", "score"),
    "a fit_circle that raises": ("def mine(points):\n    return points / None", "fit_circle"),
    "a slow fit_line": (  # the last one, as it goes on in its thread for a while
        "import time\ndef mine(points):\n    until = time.monotonic() + 1\n    while time.monotonic() < until:\n"
        "        sum(range(1000))\n    return pk.fit_line(points)",
        "fit_line",
    ),
}
OWN_WORLD = "pk.World([pk.Circle((0.2, 0.12), 0.06), pk.Polygon([(0.1, -0.2), (0.3, -0.2), (0.3, -0.1), (0.1, -0.1)])])"
TROUBLES = {
    "a wrong fit_circle": "fit_circle returns a circle that lies on none of its points; the drive goes on.",
    "a wrong measure": "measure returns a circle that lies on none of its points; the drive goes on.",
    "a slow fit_line": "fit_line takes ",
    "a fit_circle that raises": "fit_circle raises TypeError",
}
OWN_PRESSES = 5  # measured, of each


@pytest.fixture(scope="module")
def own_scenes(context, folder):
    """A page with a scene for each of them."""
    cells = [
        f"import primkit as pk\n{source}\npk.drive_scene({OWN_WORLD}, steps=pk.Steps({step}=mine))"
        for source, step in OWN.values()
    ]
    page = in_voila(context, folder, "own", cells)
    yield page
    page.close()


@pytest.mark.parametrize("name", OWN)
def test_one_s_own_step_works_while_one_drives(name, own_scenes, screenshots, record_property):
    """Right or wrong, slow or broken: the robot follows the keys, and what is the matter is told."""
    page, seat = own_scenes, Seat(own_scenes, list(OWN).index(name))
    seat.root.locator("canvas").click()
    watch = seat.root.evaluate_handle(WATCH)
    for press in range(OWN_PRESSES):
        page.keyboard.down("wd"[press % 3 // 2])
        seat.after(seat.scans + 3)
        page.keyboard.up("wd"[press % 3 // 2])
        page.wait_for_timeout(250)  # ms: the robot stands by then
    waits = watch.evaluate("(watch) => watch.waits")
    record_property(WAITS, (name, waits))
    assert np.median(waits) < UNBEARABLE
    trouble = seat.root.locator("p.trouble")
    if name in TROUBLES:
        trouble.filter(has_text=TROUBLES[name]).wait_for()
    elif "right" in name:
        assert trouble.inner_text() == ""
    if "score" in name:
        seat.rests()
        theirs, yours = re.search(r"score (\S+), yours (\S+)", seat.score).groups()
        assert (theirs == yours) == ("right" in name)
    if name == "a wrong measure":
        assert "circle, radius 400 mm" in seat.root.locator("canvas").get_attribute("aria-label")
    if screenshots:
        seat.root.screenshot(path=screenshots / f"{name.replace(' ', '_')}.png")


def test_nothing_is_moved_where_things_stand_still(seat):
    assert seat.button("Move something").count() == 0


class Player:
    """A film in a page."""

    def __init__(self, page) -> None:
        self.page, self.root = page, page.locator(".primkit-scene.replay")
        page.wait_for_function("document.querySelector('.primkit-scene.replay')?.dataset.scan === '0'")

    @property
    def scan(self):
        return int(self.root.get_attribute("data-scan"))

    def at(self, scan):
        self.page.wait_for_function(
            "(n) => +document.querySelector('.primkit-scene.replay').dataset.scan === n", arg=scan
        )

    def picture(self):
        return self.root.locator("canvas").evaluate("(canvas) => canvas.toDataURL()")


def test_a_film_plays_stops_and_goes_where_the_slider_says(context, folder, screenshots):
    page = in_voila(context, folder, "film", FILM)
    player = Player(page)
    page.wait_for_timeout(500)  # ms: until the page has its width
    first = player.picture()
    button = player.root.locator("button.play")
    button.click()
    page.wait_for_function("document.querySelector('.primkit-scene.replay').dataset.scan > 8")
    button.click()
    stopped = player.scan
    page.wait_for_timeout(500)
    assert player.scan == stopped < 60
    assert player.picture() != first
    player.root.locator("input").press("End")
    player.at(60)
    assert "61 scans" in player.root.locator(".score").inner_text()
    player.root.locator("input").press("Home")
    player.at(0)
    assert player.picture() == first
    player.root.locator("button.speed").click()
    button.click()
    player.at(60)
    if screenshots:
        player.root.locator("button.truth").click()
        for width in (WIDE, NARROW):
            page.set_viewport_size({"width": width, "height": 1000})
            page.wait_for_timeout(300)
            player.root.screenshot(path=screenshots / f"film_{width}.png")
    page.close()
