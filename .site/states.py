"""States: pictures of a slider drawn beforehand, so that it moves in a page without Python.

In:  an ``Explorer`` of ``primkit.widgets``.
Out: HTML: its controls, and a star of pictures: from the start and from each named setting, every control alone at up
     to ``STOPS`` values. All others are left to the lesson; the page goes to the nearest, and says so.

A picture is the very text that the lesson draws for these values, to the last byte; together they are compressed.
"""

import base64
import gzip
import json
from html import escape

from primkit.themed import in_theme
from primkit.widgets import Choice

STOPS = 9


def stops(control, start):
    """Return the values at which a control is drawn: its options, or up to nine of its steps, the start among them."""
    if isinstance(control, Choice):
        return control.options
    steps = round((control.high - control.low) / control.step)
    chosen = {round(k * steps / (STOPS - 1)) for k in range(STOPS)}
    values = [control.low + k * control.step for k in sorted(chosen)]
    if isinstance(control.step, float):
        values = [round(value, 9) for value in values]
    return sorted({*values, start})


def places(explorer):
    """Yield the values of all pictures, some of them twice."""
    for center in (explorer.start, *explorer.settings.values()):
        for control in explorer.controls:
            for value in stops(control, center[control.name]):
                yield center | {control.name: value}


def star(explorer):
    """Return the pictures of a slider by the values of its controls."""
    values = {tuple(each[control.name] for control in explorer.controls): each for each in places(explorer)}
    return {key: "".join(explorer.pictures(**each)) for key, each in values.items()}


def told(control, pictures, place):
    """Return what the page is told of a control: its name, and the values that occur."""
    values = list(dict.fromkeys(key[place] for key in pictures))
    choice = isinstance(control, Choice)
    return {
        "label": (control.label or control.name) + (f" [{control.unit}]" if control.unit else ""),
        "choice": choice,
        "values": [one for one in control.options if one in values] if choice else sorted(values),
    }


def packed(value):
    """Return a value as JSON, compressed, in letters."""
    text = json.dumps(value, ensure_ascii=False, separators=(",", ":"))
    return base64.b64encode(gzip.compress(text.encode(), 9, mtime=0)).decode()


def as_html(explorer):
    """Return the part of a page in which a slider moves."""
    pictures = star(explorer)
    controls = [told(control, pictures, place) for place, control in enumerate(explorer.controls)]
    names = [control.name for control in explorer.controls]
    about = {
        "controls": controls,
        "start": [explorer.start[name] for name in names],
        "settings": {setting: [values[name] for name in names] for setting, values in explorer.settings.items()},
    }
    return (
        f'<div class="primkit-states" data-about="{escape(json.dumps(about))}">'
        f'<div class="picture">{in_theme("".join(explorer.pictures()))}</div>'
        f'<script type="text/plain">{packed([[*key, svg] for key, svg in pictures.items()])}</script></div>'
    )
