"""Slider: the frame around a picture that changes while you move something.

In:  a plain function from values to a picture (SVG text), the controls, and settings worth looking at, by name.
Out: an ``Explorer``: in a notebook it shows sliders, a button for each setting, the picture, and what it says.

>>> from primkit.widgets.drawing import board_frame, picture
>>> def ring(radius):
...     frame = board_frame()
...     return picture(frame, frame.circle((0, 0), radius), title="A circle", says=f"A radius of {radius:g} m.")
>>> rings = explore(ring, Slider("radius", 0.05, 0.45, 0.05, start=0.1, unit="m"), settings={"large": {"radius": 0.4}})
>>> rings
Slider: radius
>>> rings.corners()
[{'radius': 0.05}, {'radius': 0.45}]

Why SVG text: it is redrawn in place and crisp in any size, a test can compare it, and the function behind it can be
called without a notebook. ``twin`` shows the named settings side by side, for paper and for pages without Python.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from html import escape
from itertools import product
from typing import Any

from ..arguments import short
from ..themed import in_theme, themed
from .drawing import side_by_side
from .svg import sentence, size_of, what_it_says

Draw = Callable[..., str]

READOUT_WIDTH = 640  # px: three lines of this width hold 250 letters
READOUT_HEIGHT = "max(66px, 66px + (640px - 100vw) / 4)"  # of three lines; on a phone they are more
CONTROLS_WIDTH = 425  # px: with a picture of this width beside them they fit into a notebook's column


@dataclass(frozen=True)
class Slider:
    """A number to move: from ``low`` to ``high`` in steps.

    Parameters
    ----------
    name : str
        The argument of the drawing function.
    low, high, step : float
        In the unit that is shown. Whole numbers make a slider of whole numbers.
    start : float
        The value at first.
    unit : str
        What stands behind the name, such as ``"mm"``.
    label : str
        What the slider is called; its name when not given.
    """

    name: str
    low: float
    high: float
    step: float
    start: float
    unit: str = ""
    label: str = ""

    def __post_init__(self) -> None:
        if not (self.low <= self.start <= self.high and self.low < self.high and self.step > 0):
            raise ValueError(f"slider {self.name!r} must have low <= start <= high and a step > 0, got {self}")

    @property
    def ends(self) -> tuple[float, float]:
        """The least and the greatest value."""
        return self.low, self.high

    def holds(self, value: Any) -> bool:
        """Tell whether a value lies on the slider."""
        steps = (value - self.low) / self.step
        return bool(self.low <= value <= self.high and abs(steps - round(steps)) < 1e-6)

    def widget(self) -> Any:
        """Return a slider of ipywidgets; arrow keys move it."""
        import ipywidgets

        whole = all(isinstance(v, int) for v in (self.low, self.high, self.step, self.start))
        kind = ipywidgets.IntSlider if whole else ipywidgets.FloatSlider
        decimals = {} if whole else {"readout_format": f".{_decimals(self.step)}f"}
        return kind(self.start, min=self.low, max=self.high, step=self.step, **_named(self), **decimals)


@dataclass(frozen=True)
class Choice:
    """One of a few words to choose: the drawing function's argument is the word."""

    name: str
    options: tuple[str, ...]
    start: str
    label: str = ""
    unit: str = ""

    def __post_init__(self) -> None:
        if self.start not in self.options:
            raise ValueError(f"choice {self.name!r} must start with one of its options, got {self.start!r}")

    @property
    def ends(self) -> tuple[str, ...]:
        """All options: none lies between others."""
        return self.options

    def holds(self, value: Any) -> bool:
        """Tell whether a value is an option."""
        return value in self.options

    def widget(self) -> Any:
        """Return buttons of ipywidgets, all options in sight: Lab takes the arrow keys away from a drop-down list."""
        import ipywidgets

        named = _named(self) | {"layout": _wide(CONTROLS_WIDTH), "style": {"button_width": "auto"}}
        buttons = ipywidgets.ToggleButtons(options=self.options, value=self.start, **named)
        return buttons.add_class("widget-inline-hbox")  # the name stands to the left, as beside a slider


Control = Slider | Choice


class Picture:
    """A picture that a notebook shows, and stores: with its words, and a short text for where there are no pictures."""

    def __init__(self, svg: str, name: str) -> None:
        self.svg, self.name = svg, name

    def _repr_html_(self) -> str:
        return themed(self.svg, what_it_says(self.svg))

    def __repr__(self) -> str:
        return self.name


class Twin(Picture):
    """A picture that a click unfolds, below the slider that shows more; where nothing can be moved, it is open."""

    def _repr_html_(self) -> str:
        unfolded = ".primkit-twin::details-content{content-visibility:visible;height:auto}"
        on_paper = "pre{white-space:pre-wrap!important;overflow-wrap:anywhere}"  # lines that are too long go on below
        in_export = f"body.jp-Notebook:not([data-voila]) {unfolded}"
        opened = f"<style>@media print{{{unfolded}{on_paper}}}{in_export}</style>"
        head = "<summary>The same picture with each named setting, side by side</summary>"
        return f'{opened}<details class="primkit-twin">{head}{super()._repr_html_()}</details>'


class Explorer:
    """A drawing function with its controls and its named settings; ``explore`` makes one.

    ``draw(**values)`` returns the picture as SVG text and raises what the function raises; in the notebook such an
    error is a sentence in the place of the picture, and is kept as ``failure``. A second function of the same values,
    ``beside``, draws a picture of its own: beside the first where there is room, below it on a phone.
    """

    def __init__(
        self,
        draw: Draw,
        controls: Sequence[Control],
        settings: Mapping[str, Mapping[str, Any]] | None = None,
        diagram: Callable[[], Picture] | None = None,
        beside: Draw | None = None,
    ) -> None:
        self.functions, self.controls, self._diagram = [draw, *filter(None, [beside])], tuple(controls), diagram
        self.start = {control.name: control.start for control in self.controls}
        self.settings = {name: self._complete(name, values) for name, values in (settings or {}).items()}
        self.failure: Exception | None = None

    def draw(self, **values: Any) -> str:
        """Return the picture for these values, and for the start's where none are given."""
        return self.pictures(**values)[0]

    def pictures(self, **values: Any) -> list[str]:
        """Return all that is drawn for these values: the picture, and the one beside it if there is one."""
        return [draw(**(self.start | values)) for draw in self.functions]

    def corners(self) -> list[dict[str, Any]]:
        """Return the values at every corner of the box that the controls span; of choices, all options."""
        return [dict(zip(self.start, values, strict=True)) for values in product(*(c.ends for c in self.controls))]

    def twin(self) -> Twin:
        """Return the named settings side by side as one picture, for where nothing can be moved."""
        pictures = {name: self.pictures(**values) for name, values in self.settings.items()}
        if not pictures:
            raise ValueError("a twin needs named settings, got none")
        captions, drawn = zip(*((name, svg) for name, some in pictures.items() for svg in some), strict=True)
        return Twin(side_by_side(drawn, captions), f"{self!r}, its named settings")

    def diagram(self) -> Picture:
        """Return the drawing behind the lesson's formula."""
        if self._diagram is None:
            raise ValueError(f"a diagram must be given to explore, got none for {self!r}")
        return self._diagram()

    @cached_property
    def panel(self) -> Any:
        """The widget: controls, buttons, picture, and what the picture says."""
        import ipywidgets

        from .panel import attended

        drawn = self.pictures()  # at the start an error is not caught: a lesson that cannot begin should say so
        # Of one size, whatever is drawn: the page below must not jump.
        self._images = [ipywidgets.HTML(in_theme(svg), layout=_wide(size_of(svg)[0])) for svg in drawn]
        self._images[0].layout.grid_area = f"span {len(drawn)} / auto"  # what is beside it goes below the controls
        self._readout = ipywidgets.HTML(_spoken(drawn), layout=_wide(READOUT_WIDTH) | {"min_height": READOUT_HEIGHT})
        self._knobs = {control.name: control.widget() for control in self.controls}
        self._line_up()
        self._quiet = False
        for knob in self._knobs.values():
            knob.observe(self._redraw, names="value")
        buttons = [self._button(name) for name in self.settings]
        row = ipywidgets.HBox(buttons, layout=_wide(CONTROLS_WIDTH) | {"flex_flow": "row wrap"})
        controls = ipywidgets.VBox([*self._knobs.values(), row])
        columns = f"repeat(auto-fit, min(100%, {CONTROLS_WIDTH + 4}px))"  # one below the other where room is short
        beside = ipywidgets.GridBox([controls, *self._images], layout={"grid_template_columns": columns})
        return attended([beside, self._readout], sum(isinstance(control, Slider) for control in self.controls))

    def _line_up(self) -> None:
        """Give all names the width of the longest, as one that does not fit would be cut off."""
        letters = max(len(knob.description) for knob in self._knobs.values())
        room = max(130, 7 * letters)
        for knob in self._knobs.values():
            knob.style.description_width = f"{room}px"

    def set(self, **values: Any) -> None:
        """Move the panel's controls, and redraw once."""
        panel = self.panel
        assert panel is not None
        self._quiet = True
        try:
            for name, value in values.items():
                self._knobs[name].value = value
        finally:
            self._quiet = False
        self._redraw()

    def _redraw(self, _change: Any = None) -> None:
        """Draw for the values that the controls have now; an error becomes a sentence in the picture's place."""
        if self._quiet:
            return
        try:
            drawn = self.pictures(**{name: knob.value for name, knob in self._knobs.items()})
            self.failure = None
        except Exception as error:  # whatever it is, a student must see it: a kernel would only log it
            words = f"This could not be drawn. {type(error).__name__}: {error}"
            drawn = [sentence(*size_of(image.value), words) for image in self._images]
            self.failure = error
        for image, svg in zip(self._images, drawn, strict=True):
            image.value = in_theme(svg)
        self._readout.value = _spoken(drawn)

    def _button(self, name: str) -> Any:
        import ipywidgets

        button = ipywidgets.Button(description=name, layout={"width": "auto"}, tooltip=f"Show the setting: {name}")
        button.on_click(partial(self._press, name))
        return button

    def _press(self, name: str, _button: Any = None) -> None:
        self.set(**self.settings[name])

    def _complete(self, name: str, values: Mapping[str, Any]) -> dict[str, Any]:
        """Return a named setting with a value for every control, or refuse one that the controls do not hold."""
        complete = self.start | dict(values)
        by_name = {control.name: control for control in self.controls}
        for key, value in complete.items():
            if key not in by_name or not by_name[key].holds(value):
                raise ValueError(
                    f"setting {name!r} must have values that its controls hold, got {key} = {short(value)}"
                )
        return complete

    def _ipython_display_(self) -> None:
        """Show the panel and the twin, which is for who reads the notebook without running it."""
        from IPython.display import display

        display(self._repr_mimebundle_(), raw=True)  # type: ignore[no-untyped-call]  # IPython has no types
        if self.settings:
            display(self.twin())  # type: ignore[no-untyped-call]

    def _repr_mimebundle_(self, **_kinds: Any) -> dict[str, Any]:
        """Show the panel; stored as text it is one line that does not change from run to run."""
        from .panel import shown

        return shown(self.panel, repr(self))

    def __repr__(self) -> str:
        return "Slider: " + ", ".join(control.label or control.name for control in self.controls)


def explore(
    draw: Draw,
    *controls: Control,
    settings: Mapping[str, Mapping[str, Any]] | None = None,
    diagram: Callable[[], Picture] | None = None,
    beside: Draw | None = None,
) -> Explorer:
    """Return a picture with controls.

    Raises ValueError if a setting names a control that is not there, or a value that it does not hold.

    Parameters
    ----------
    draw : callable
        Takes one value for each control, by name, and returns SVG text: ``drawing.picture``. The same values must
        give the same text, so seeds are fixed or are controls; 25 ms at most, or the slider stutters.
    *controls : Slider or Choice
        What can be moved.
    settings : mapping of str to mapping
        Values worth looking at, by name; a control that is not named keeps its start.
    diagram : callable, optional
        Returns the drawing behind the lesson's formula, in which nothing moves.
    beside : callable, optional
        As ``draw``, for a second picture that moves along.
    """
    return Explorer(draw, controls, settings, diagram, beside)


def _named(control: Control) -> dict[str, Any]:
    """Return what all widgets of controls share: the name with its unit, and room for it."""
    label = (control.label or control.name) + (f" [{control.unit}]" if control.unit else "")
    return {"description": label, "layout": _wide(CONTROLS_WIDTH)}


def _wide(width: int) -> dict[str, str]:
    """Return a layout of so many pixels, or of the page's width where that is less, as on a phone."""
    return {"width": f"{width}px", "max_width": "calc(100% - 4px)"}  # ipywidgets puts 2 px around everything


def _decimals(step: float) -> int:
    """Return how many decimals a step has.

    >>> _decimals(0.05), _decimals(2.0)
    (2, 0)
    """
    text = f"{step:.6f}".rstrip("0")
    return len(text.split(".")[1])


def _spoken(drawn: Sequence[str]) -> str:
    """Return the pictures' sentences as a line that screen readers read anew when it changes."""
    words = " ".join(dict.fromkeys(map(what_it_says, drawn)))
    return f'<div aria-live="polite" style="line-height:1.4">{escape(words)}</div>'
