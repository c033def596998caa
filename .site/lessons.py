"""Lessons: notebooks as pages, with all that can work without Python working.

In:  a lesson with its stored outputs.
Out: the same notebook: in the place of widgets what moves in a page, ``interactive.js`` brings it to life.
"""

import json
import re
from dataclasses import asdict
from html import escape

from states import as_html

import primkit as pk
from primkit.widgets.predictions import questions, read_quiz

WIDGET = "application/vnd.jupyter.widget-view+json"
SLIDER = re.compile(r"^pk\.widgets\.(\w+)\(\)$", re.MULTILINE)
PREDICT = re.compile(r"^pk\.widgets\.predict\((.+)\)$", re.MULTILINE)
ANSWER = re.compile(r"pk\.widgets\.answer\((\w+)=")
DRIVE = (
    '<p class="primkit-live">Here the lesson lets you drive, or plays the drive: that needs Python. '
    "<em>Start</em> says how to run it.</p>"
)


def page_of(notebook):
    """Return a lesson as the site shows it."""
    for cell in notebook["cells"]:
        source = "".join(cell["source"])
        if cell["cell_type"] == "markdown":
            cell["source"] = with_quiz(source)
        else:
            cell["outputs"] = [shown for output in cell["outputs"] for shown in without_python(source, output)]
    return notebook


def without_python(source, output):
    """Yield what stands in the place of an output."""
    data = output.get("data", {})
    if WIDGET in data:
        yield html_output(moving(source))
        return
    data.pop("image/png", None) if "text/html" in data else None  # one picture is enough
    yield output
    if "text/html" in data and (names := ANSWER.findall(source)):
        yield html_output("".join(f'<p class="primkit-guess" data-name="{name}"></p>' for name in names))


def moving(source):
    """Return the HTML for the widget that a cell shows."""
    if match := SLIDER.search(source):
        return as_html(getattr(pk.widgets, match[1])())
    if match := PREDICT.search(source):
        asked = [asdict(questions()[name]) for name in json.loads(f"[{match[1]}]")]
        return f'<div class="primkit-predict" data-asked="{escape(json.dumps(asked))}"></div>'
    return DRIVE


def html_output(html):
    """Return HTML as an output of a cell."""
    return {"output_type": "display_data", "metadata": {}, "data": {"text/html": html}}


def with_quiz(text):
    """Return a cell's text with what a page must know of its quiz: which options are right."""
    rights = [[option.right for option in question.options] for question in read_quiz(text) if question.options]
    if not rights:
        return text
    mark = f'<script type="application/json" class="primkit-quiz">{json.dumps(rights)}</script>\n\n'
    return re.sub(r"^\*\*\d\. ", lambda match: mark + match[0], text, count=1, flags=re.MULTILINE)
