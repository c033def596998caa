"""Panel: a lesson's sliders in the page, moved by keys and by the mouse, and what becomes of the picture."""

from collections.abc import Callable, Iterable
from contextlib import suppress
from pathlib import Path

WATCH = (Path(__file__).parent / "watch.js").read_text(encoding="utf-8")
OUTERMOST = ":not(.jupyter-widgets) > .jupyter-widgets:not(.primkit-predict):has(.noUi-handle)"

Move = Callable[[], object]


class Control:
    """What can be moved: a slider, a choice or a button."""

    def __init__(self, place) -> None:
        self.place, self.page = place, place.page

    @property
    def name(self) -> str:
        """What stands beside it, or on it."""
        label = self.place.locator(".widget-label")
        return (label if label.count() else self.place).first.inner_text()

    def click(self) -> None:
        """Click on it."""
        self.place.click()

    def press(self, key: str) -> None:
        """Press a key with the focus on it."""
        self.place.press(key)


class Slider(Control):
    """A slider of ipywidgets."""

    key = "ArrowRight"

    def press(self, key: str) -> None:
        """Press a key with the focus on its handle."""
        self.place.locator(".noUi-handle").press(key)

    def told(self) -> tuple[str, str]:
        """Return the name and the value that a screen reader has of it."""
        words = ["aria-label", "aria-valuetext"]
        told: list[str] = self.place.locator(".noUi-handle").evaluate(
            "(h, words) => words.map((w) => h.getAttribute(w))", words
        )
        return told[0], told[1]

    def step(self) -> None:
        """Press the arrow key onwards; turn round at an end."""
        now, low, high = self.place.locator(".noUi-handle").evaluate(
            "(h) => ['now', 'min', 'max'].map((word) => Number(h.getAttribute(`aria-value${word}`)))"
        )
        self.key = {low: "ArrowRight", high: "ArrowLeft"}.get(now, self.key)
        self.press(self.key)

    def drag(self, share: float) -> None:
        """Take the handle with the mouse to a share of its track, over three places on the way."""
        handle = self.place.locator(".noUi-handle")
        handle.scroll_into_view_if_needed()
        box, track = handle.bounding_box(), self.place.locator(".noUi-base").bounding_box()
        middle = box["y"] + box["height"] / 2
        self.page.mouse.move(box["x"] + box["width"] / 2, middle)
        self.page.mouse.down()
        self.page.mouse.move(track["x"] + share * track["width"], middle, steps=4)
        self.page.mouse.up()


class Choice(Control):
    """A row of buttons of ipywidgets, of which one is chosen."""

    @property
    def options(self) -> list[Control]:
        return [Control(place) for place in self.place.locator("button").all()]


class Panel:
    """Sliders, buttons and the picture that they move; ``settle`` waits until a move has had its effect."""

    def __init__(self, root, settle: Move) -> None:
        self.root, self.settle = root, settle
        self.sliders = [Slider(place) for place in root.locator(".widget-hslider").all()]
        self.choices = [Choice(place) for place in root.locator(".widget-toggle-buttons").all()]
        self.settings = [Control(place) for place in root.locator("button:not(.widget-toggle-button)").all()]
        self._watch = root.evaluate_handle(WATCH)

    def picture(self) -> str:
        """Return the markup of all that is drawn."""
        return self._watch.evaluate("(watch) => watch.markup()")

    def watch_anew(self) -> None:
        """Forget the waits, heights and failures so far."""
        self._watch.evaluate("(watch) => watch.anew()")

    def start_over(self) -> None:
        """Go to the first named setting, and watch anew from there."""
        for setting in self.settings[:1]:
            self.changes(setting.click)
        self.watch_anew()

    def seen(self, what: str) -> list:
        """Return what was seen since then: "waits" in ms, "heights" in px, or "failures" in words."""
        return self._watch.evaluate(f"(watch) => watch.{what}")

    def changes(self, move: Move) -> bool:
        """Make a move; tell whether it changes the picture."""
        before = self.picture()
        move()
        self.settle()
        return self.picture() != before

    def await_another(self, picture: str) -> None:
        """Wait until there is another picture than this one: where nobody tells when all is settled."""
        self.root.page.wait_for_function("([watch, seen]) => watch.markup() !== seen", arg=[self._watch, picture])

    def some_change(self, moves: Iterable[Move]) -> bool:
        """Make all moves; tell whether one of them changes the picture, from here or else from a named setting.

        Noise, say, changes nothing while only the truth is shown.
        """
        moves = list(moves)
        for begin in (None, *self.settings):
            if begin:
                self.changes(begin.click)
            changes = [self.changes(move) for move in moves]
            if any(changes):
                return True
        return False


def panels(page, count: int, settle: Move) -> list[Panel]:
    """Return the page's panels, as soon as there are so many, or those that are there after a while."""
    from playwright.sync_api import TimeoutError as NotShown

    found = page.locator(OUTERMOST)
    with suppress(NotShown):  # the lesson's rules say how many are missing
        if count:
            found.nth(count - 1).wait_for(timeout=10_000)
    return [Panel(root, settle) for root in found.all()]
