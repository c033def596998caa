"""Sliders: each lesson's picture at every corner of its box, the panel in a notebook, and the pictures' own text."""

import itertools
import re
import time
from html import escape
from xml.etree import ElementTree

import ipywidgets
import numpy as np
import pytest

import primkit as pk
from primkit.palette import KIND_COLORS, PALE, contrast
from primkit.themed import in_theme
from primkit.widgets.drawing import (
    ENTRY,
    MARKERS,
    Frame,
    board_frame,
    picture,
    round_ticks,
    side_by_side,
    square_frame,
)
from primkit.widgets.scoring import SCORED_MAPS, n_right, report_of, weighted
from primkit.widgets.slider import Choice, Explorer, Slider, explore
from primkit.widgets.svg import sentence, size_of, what_it_says
from tests.helpers import svg_in, words_in

SLIDERS = {factory.__name__: factory for factory in pk.widgets.SLIDERS}
CORNERS = [
    pytest.param(name, corner, id=f"{name}-{'-'.join(map(str, corner.values()))}")
    for name, factory in SLIDERS.items()
    for corner in factory().corners()
]
ENTRIES = re.compile(r'<g class="entry" transform="translate\([^ ]+ ([^)]+)\)">.*?<text[^>]*>([^<]*)</text></g>')
VIEW = "application/vnd.jupyter.widget-view+json"
KEY_TO_PICTURE = 0.05  # s of the processor's time: with the browser's share this stays fluent; mostly it is half of it


def elements(svg):
    """Return the SVG's elements by tag; text that is not well-formed raises."""
    return [element.tag.split("}")[-1] for element in ElementTree.fromstring(svg).iter()]


def is_sound(svg):
    """Hold what every picture of the course must have."""
    tags = elements(svg)
    assert tags[0] == "svg"
    assert tags[1:3] == ["title", "desc"]
    assert re.search(r"\[[^\]]+\]", svg), "an axis has no unit"
    assert not re.search(r"\bnan\b|\binf\b", re.sub(r"<desc>.*?</desc>|<text.*?</text>", "", svg))
    assert not re.search(r"\.\d\d", "".join(re.findall(r' d="([^"]*)"', svg))), "more than a tenth of a pixel"
    assert what_it_says(svg).endswith(".")
    assert not re.search(r'\bid="', svg), "ids clash when a page has two pictures"


@pytest.mark.parametrize(("name", "corner"), CORNERS)
def test_a_slider_draws_at_every_corner(name, corner):
    slider = SLIDERS[name]()
    drawn = slider.pictures(**corner)
    for svg, first in zip(drawn, slider.pictures(), strict=True):
        is_sound(svg)
        assert size_of(svg) == size_of(first)
    assert slider.pictures(**corner) == drawn


@pytest.mark.parametrize("name", SLIDERS)
def test_every_control_changes_the_picture(name):
    """From some corner at least: noise changes nothing where nothing is hit."""
    slider = SLIDERS[name]()
    for control in slider.controls:
        bases = [{}, *slider.settings.values(), *slider.corners()[:64]]
        pairs = ((slider.draw(**base | {control.name: end}) for end in control.ends) for base in bases)
        assert any(len(set(pair)) > 1 for pair in pairs), control.name


@pytest.mark.parametrize("name", SLIDERS)
def test_a_slider_is_quick_enough(name):
    slider = SLIDERS[name]()

    def seconds(corner):
        start = time.process_time()
        slider.pictures(**corner)
        return time.process_time() - start

    slowest = max(slider.corners(), key=seconds)
    assert min(seconds(slowest) for _ in range(5)) <= KEY_TO_PICTURE, slowest


@pytest.mark.parametrize("name", SLIDERS)
def test_letters_and_marks_can_be_read_on_white(name):
    """4.5 for letters, 3 for what is no area; frames and what is there as ground are pale on purpose."""
    slider = SLIDERS[name]()
    for svg in (slider.twin().svg, *([] if name == "boards" else [slider.diagram().svg])):
        for element in ElementTree.fromstring(svg).iter():
            letters = element.tag.endswith("text")
            for kind in ("fill",) if letters else ("fill", "stroke"):
                color = element.get(kind, "none")
                if color.startswith("#") and color != PALE and element.get(f"{kind}-opacity") is None:
                    assert contrast(color) >= (4.5 if letters else 3.0), (element.tag, color)


@pytest.mark.parametrize("name", SLIDERS)
def test_the_twin_holds_every_named_setting(name):
    slider = SLIDERS[name]()
    twin = slider.twin()
    assert len(slider.settings) >= 3
    assert all(escape(setting) in twin.svg for setting in slider.settings)
    assert len({slider.draw(**values) for values in slider.settings.values()}) == len(slider.settings)
    assert twin._repr_html_() == slider.twin()._repr_html_()
    assert repr(twin) == f"{slider!r}, its named settings"
    assert svg_in(twin._repr_html_()) == twin.svg
    assert words_in(twin._repr_html_()) == [what_it_says(twin.svg)]
    elements(twin.svg)


@pytest.mark.parametrize("name", SLIDERS)
def test_the_panel_has_a_named_control_for_each_value_and_a_button_for_each_setting(name):
    import ipywidgets

    slider = SLIDERS[name]()
    *controls, row = parts(slider)[: len(slider.controls) + 1]
    *images, readout = parts(slider)[len(slider.controls) + 1 :]
    assert [control.value for control in controls] == list(slider.start.values())
    assert all(control.description for control in controls)
    assert [button.description for button in row.children] == list(slider.settings)
    assert all(isinstance(button, ipywidgets.Button) for button in row.children)
    row.children[-1].click()
    last = list(slider.settings.values())[-1]
    assert [control.value for control in controls] == pytest.approx(list(last.values()))
    assert [image.value for image in images] == [in_theme(svg) for svg in slider.pictures(**last)]
    assert 'aria-live="polite"' in readout.value
    assert slider.failure is None


def parts(slider):
    """The controls of a panel, the row of its buttons, its pictures and what they say."""
    (controls, *images), readout = slider.panel.children[0].children, slider.panel.children[1]
    return [*controls.children, *images, readout]


def ring(radius, words="a"):
    if radius > 0.35:
        raise ValueError(f"radius must be at most 0.35 m, got {radius:g} < or so")
    frame = board_frame()
    return picture(frame, frame.circle((0, 0), radius), title=words, says=f"{radius:g}.")


CONTROLS = Slider("radius", 0.1, 0.4, 0.1, start=0.2, unit="m"), Choice("words", ("a", "b"), start="a")


def rings(**settings):
    return explore(ring, *CONTROLS, settings=settings)


def test_moving_a_control_redraws_in_place():
    slider = rings()
    radius, _words, _row, image, readout = parts(slider)
    assert radius.description == "radius [m]"
    radius.value = 0.3
    assert image.value == in_theme(ring(0.3))
    assert ">0.3.<" in readout.value


def test_a_named_setting_redraws_once():
    calls = []

    def counted(radius, words):
        calls.append((radius, words))
        return ring(radius, words)

    slider = explore(counted, *CONTROLS, settings={"both": {"radius": 0.1, "words": "b"}})
    row = parts(slider)[-3]
    calls.clear()
    row.children[0].click()
    assert calls == [(0.1, "b")]


def test_an_error_is_a_sentence_in_the_picture_s_place_and_is_kept():
    slider = rings()
    radius, _words, _row, image, readout = parts(slider)
    size = size_of(image.value)
    radius.value = 0.4
    message = "This could not be drawn. ValueError: radius must be at most 0.35 m, got 0.4 < or so"
    assert what_it_says(image.value) == message
    assert size_of(image.value) == size
    assert "at most 0.35 m" in readout.value
    assert isinstance(slider.failure, ValueError)
    radius.value = 0.3
    assert slider.failure is None
    assert image.value == in_theme(ring(0.3))


def test_a_second_picture_moves_along_and_its_words_are_told():
    slider = explore(ring, *CONTROLS, settings={"large": {"radius": 0.3}}, beside=lambda **v: ring(0.1, v["words"]))
    radius, words, _row, image, beside, readout = parts(slider)
    radius.value, words.value = 0.3, "b"
    assert [image.value, beside.value] == [in_theme(ring(0.3, "b")), in_theme(ring(0.1, "b"))]
    assert ">0.3. 0.1.<" in readout.value
    assert what_it_says(slider.twin().svg) == "large: 0.3. large: 0.1."
    radius.value = 0.4
    assert what_it_says(image.value) == what_it_says(beside.value)
    assert readout.value.count("at most 0.35 m") == 1


def test_the_map_counts_what_the_score_counts():
    """The share of right values, each with its part's weight, is the score at the same tolerance."""
    tolerances = np.array([0.0, 0.001, 0.005])
    for board, noise in itertools.product(SCORED_MAPS, (0, 10)):
        report = report_of("PAPER", board, noise)
        true = [*(match.true for match in report.matches), *report.missed]
        of = len(true) + len(report.false_alarms), 2 * len(true), sum(len(shape.dimensions) for shape in true)
        told = sum(n * weighted(report, tolerances, one) for n, one in zip(of, np.eye(3), strict=True))
        assert [sum(n_right(m, t) for m in report.matches) for t in tolerances] == pytest.approx(told)


def test_an_error_reaches_who_calls_draw():
    with pytest.raises(ValueError, match=r"radius must be at most 0\.35 m"):
        rings().draw(radius=0.4)
    with pytest.raises(ValueError, match=r"radius must be at most 0\.35 m"):
        rings(large={"radius": 0.4}).twin()


def test_an_error_at_the_start_is_not_hidden():
    with pytest.raises(ValueError, match="at most"):
        explore(
            ring, Slider("radius", 0.1, 0.4, 0.1, start=0.4), Choice("words", ("a",), start="a")
        )._repr_mimebundle_()


def test_what_a_notebook_stores_is_one_line_that_stays_the_same():
    bundle = rings()._repr_mimebundle_()
    assert bundle["text/plain"] == "Slider: radius, words"
    assert set(bundle) == {"text/plain", VIEW}


@pytest.mark.parametrize("make", [lambda: rings(), lambda: pk.widgets.predict("side")], ids=["slider", "prediction"])
def test_a_panel_is_shown_where_widgets_tell_no_mime_types(make, monkeypatch):
    """Those of ipywidgets 7, which Colab has, do not."""
    monkeypatch.delattr(ipywidgets.Widget, "_repr_mimebundle_", raising=False)
    view = make()._repr_mimebundle_()[VIEW]
    assert (view["version_major"], view["version_minor"]) == (2, 0)
    assert len(view["model_id"]) == 32


def test_the_corners_are_those_of_the_box_and_all_options():
    assert rings().corners() == [{"radius": r, "words": w} for r in (0.1, 0.4) for w in ("a", "b")]


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"far": {"radius": 7}}, "setting 'far' must have values that its controls hold, got radius = 7"),
        ({"between": {"radius": 0.25}}, "got radius = 0.25"),
        ({"new": {"angle": 1}}, "got angle = 1"),
        ({"word": {"words": "c"}}, "got words = 'c'"),
    ],
)
def test_a_setting_that_the_controls_do_not_hold_is_refused(settings, message):
    with pytest.raises(ValueError, match=re.escape(message)):
        rings(**settings)


def test_controls_must_hold_their_start():
    with pytest.raises(ValueError, match="slider 'x' must have low <= start <= high and a step > 0"):
        Slider("x", 0, 1, 1, start=2)
    with pytest.raises(ValueError, match="choice 'x' must start with one of its options, got 'c'"):
        Choice("x", ("a", "b"), start="c")


def test_a_twin_needs_settings():
    with pytest.raises(ValueError, match="a twin needs named settings, got none"):
        rings().twin()


@pytest.mark.parametrize("name", [name for name in SLIDERS if name != "boards"])
def test_a_slider_has_the_diagram_of_its_lesson(name):
    diagram = SLIDERS[name]().diagram()
    assert repr(diagram).startswith("Diagram: ")
    assert elements(diagram.svg)[:3] == ["svg", "title", "desc"]
    assert ("[m]" in diagram.svg) == (name == "cells")  # an idea needs no axes; that one is about coordinates


def test_an_arrow_ends_where_it_points():
    frame = Frame((0.0, 1.0), (0.0, 1.0), width=175, height=175)  # 100 px to each side
    shaft, head = re.findall(r'd="([^"]*)"', frame.arrow((0, 0), (1, 0), width=2))
    assert (shaft, head) == ("M60 130L148 130", "M160 130L148 134.8L148 125.2Z")


def test_a_diagram_must_have_been_given():
    with pytest.raises(ValueError, match="a diagram must be given to explore, got none for Slider: seed"):
        pk.widgets.boards().diagram()


# --- drawing ----------------------------------------------------------------------------------------------------


def test_a_frame_maps_its_corners_to_the_corners_of_the_axes():
    frame = Frame((0, 2), (-1, 1), width=175, height=175)
    assert frame.at([(0, -1), (2, 1), (1, 0)]) == [[60, 130], [160, 30], [110, 80]]


@pytest.mark.parametrize("make", [lambda: board_frame(1.0), lambda: square_frame((0.1, 0.2), 0.05)])
def test_boards_have_one_scale_both_ways(make):
    frame = make()
    assert frame.scale[0] == pytest.approx(frame.scale[1])


def test_a_tie_is_rounded_the_same_way_from_both_sides():
    frame = Frame((0, 100), (0, 100), width=175, height=175)  # a pixel for a unit
    places = [frame.at([(0.25 + tiny, 0)])[0][0] for tiny in (-1e-9, 0, 1e-9)]
    assert places == [60.3, 60.3, 60.3]


def test_a_shape_is_drawn_in_its_kind_s_colour():
    frame = board_frame()
    for shape in pk.random_world(5, style="any", kinds=list(KIND_COLORS), rng=2).shapes:
        assert KIND_COLORS[shape.kind] in frame.shape(shape)


@pytest.mark.parametrize("marker", ["dot", "ring", "cross", *MARKERS])
def test_no_points_draw_nothing_and_each_point_is_drawn_once(marker):
    frame = board_frame()
    assert frame.points(np.empty((0, 2)), marker=marker) == ""
    drawn = frame.points([(0, 0), (0.1, 0.1), (0.2, 0)], marker=marker)
    starts = {"cross": 3}.get(marker, 3)
    assert len(re.findall(r"M", drawn)) == starts


def test_words_cannot_break_the_picture():
    frame = board_frame()
    svg = picture(frame, frame.text((0, 0), "a < b & c"), title="<b>", says='"quoted" & <told>.')
    elements(svg)
    assert what_it_says(svg) == '"quoted" & <told>.'


def test_small_multiples_tell_all_their_sentences():
    pictures = [ring(0.1), ring(0.2)]
    svg = side_by_side(pictures, ["small", "large"])
    assert what_it_says(svg) == "small: 0.1. large: 0.2."
    assert size_of(svg) == (850, size_of(pictures[0])[1] + 26)
    elements(svg)


def test_a_wide_picture_is_shown_as_wide_as_a_page():
    svg = picture(Frame((0.0, 1.0), (0.0, 1.0), width=1275, height=425), title="wide", says="A wide one.")
    shown = re.search(r'width="([\d.]+)" height="([\d.]+)" viewBox="0 0 (\d+) (\d+)"', svg)
    width, height, wide, tall = map(float, shown.groups())
    assert width == 860 < wide
    assert width / height == pytest.approx(wide / tall, rel=1e-3)


def test_a_sentence_is_a_picture():
    svg = sentence(200, 100, "a long sentence that needs more than one line & more")
    assert elements(svg).count("text") >= 3
    assert size_of(svg) == (200, 100)


@pytest.mark.parametrize(("low", "high"), [(-0.5, 0.5), (0, 1), (0, 7), (0.001, 0.004), (-30, 1000), (0, 12345)])
def test_ticks_are_few_and_inside(low, high):
    ticks = round_ticks(low, high)
    assert 3 <= len(ticks) <= 6
    assert low <= ticks[0]
    assert ticks[-1] <= high


def test_something_else_is_no_picture():
    with pytest.raises(ValueError, match="a picture must be SVG text from picture"):
        size_of("<p>")


def test_two_settings_of_a_slider_can_be_compared():
    """Each call makes one of its own."""
    one, other = pk.widgets.rays(), pk.widgets.rays()
    one.set(beams=24)
    assert isinstance(one, Explorer)
    assert "of 24 beams" in parts(one)[-1].value
    assert "of 100 beams" in parts(other)[-1].value


def test_the_notebook_is_shown_the_panel_and_its_twin_and_the_panel_answers_the_page(monkeypatch):
    shown = []
    monkeypatch.setattr("IPython.display.display", lambda what, **_: shown.append(what))
    slider = pk.widgets.rays()
    slider._ipython_display_()
    assert shown[0]["text/plain"] == repr(slider)
    assert repr(shown[1]) == repr(slider.twin())
    attendant, sent = slider.panel.children[-1], []
    attendant.send = lambda *message: sent.append(message)
    assert attendant.sliders == 6
    attendant._handle_custom_msg({}, [])
    assert len(sent) == 1


def test_a_legend_stands_below_the_axes_and_once_in_a_twin():
    for name, make in SLIDERS.items():
        slider = make()
        entries = {words for _, words in ENTRIES.findall(slider.draw())}
        assert (name in ("boards", "naming")) == (not entries), name
        frame = float(re.search(r"<svg [^>]*y=\"30\" [^>]*height=\"([0-9.]+)\"", slider.draw())[1]) + 30
        assert all(float(y) > frame for y, _ in ENTRIES.findall(slider.draw())), name
        twin = re.findall(ENTRY, slider.twin().svg)
        assert len(twin) == len(set(twin)) >= len(entries)
