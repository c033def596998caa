"""A lesson in which much is broken: each cell breaks one promise, and the rules must say so."""

CELLS = [
    """
from itertools import count

import ipywidgets
import primkit as pk
from primkit.widgets import Slider, explore
from primkit.widgets.drawing import board_frame, picture

def ring(k):
    frame = board_frame()
    return picture(frame, frame.circle((0, 0), 0.1 * k), title="A circle", says=f"Its radius is {k} dm.")

def explorer(draw):
    return explore(draw, Slider("k", 1, 4, 1, start=1), settings={"a": {"k": 1}, "b": {"k": 4}})
""",
    """
def fails_between_its_settings(k):
    if k == 3:
        raise ValueError("no three")
    return ring(k)

explorer(fails_between_its_settings)
""",
    """
explorer(lambda k: ring(1))  # a picture that stays
""",
    """
calls = count(1)
explorer(lambda k: ring(k + 0.001 * next(calls)))  # never the same picture twice
""",
    """
square = '<svg height="{0}00" width="10"></svg>'.format  # of another height for each k, in a plain ipywidget
slider = ipywidgets.FloatSlider(0.1 + 0.2, min=0.1, max=0.4, step=0.1, description="a name too long for its place")
drawn = ipywidgets.HTML(square(1))

def redraw(change):
    drawn.value = square(round(10 * change.new))
    raise RuntimeError("seen by the kernel alone")

slider.observe(redraw, names="value")
ipywidgets.VBox([slider, ipywidgets.Dropdown(options=["a", "b"]), drawn])
""",
    """
ipywidgets.HTML('<div style="width: 2000px">too wide</div>')
""",
    """
raise RuntimeError("a cell")
""",
]

# For each rule the sentences, as patterns. Sliders are counted in the order of the cells.
FAILS = r"slider 1: could not be drawn\. ValueError: no three.*"
JUMPS = r"slider 4: the page below jumps: heights of \d+ to \d+ px"
BREACHES = {
    "cells run": [r"4 of 5 sliders are shown", r"RuntimeError: a cell"],
    "keys move the picture": [
        FAILS,
        r"slider 2: k: no arrow key changes the picture",
        r"slider 4: a drop-down list: Lab keeps the arrow keys to itself",
        JUMPS,
    ],
    "mouse moves the picture": [FAILS, r"slider 2: k: the mouse changes nothing in the picture", JUMPS],
    "sliders tell": [
        r"slider 4: a name too long for its place: its handle is called None",
        r"slider 4: a name too long for its place: its value is told as 0\.30000000000000004",
    ],
    "settings differ": [
        r"slider 2: two settings show the same picture",
        *(rf"slider 3: {name}: Enter shows another picture than the mouse" for name in "ab"),
    ],
    "callbacks run": [r"RuntimeError: seen by the kernel alone"],
    "fits a laptop": [r"cell 5: 1\d\d px wide, 80 px are there", r"cell 6: 20\d\d px wide, \d+ px are there"],
    "fits a phone": [r"cell 5: 3\d\d px wide, \d+ px are there", r"cell 6: 2000 px wide, \d+ px are there"],
    "cells stay": [r"a key on a control cut 1 of 7 cells"],
}
