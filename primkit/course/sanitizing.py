"""Sanitizing: a submission's cells put in order before it runs, whatever an editor has done to them.

JupyterLab copies nbgrader's marks with a pasted or split cell, and lets a student delete a cell that cannot be edited.
nbgrader takes the marks off all copies but the last, and then stumbles over those that have none. ``WholeNotebook``
comes between these two steps: a copy is the student's own cell from there on; a locked code cell or a graded cell that
is missing, the imports at the top above all, comes back from the release, with a note above it. An answer's own cell
does not: its stub would overwrite an answer that was typed elsewhere.

``SafeFeedback`` stands before the page of feedback: of what students wrote and their code showed, no script is left.

In:  a submission without double marks, and ``release/`` of the course.
Out: a notebook that nbgrader can grade; ``metadata.primkit.faults`` names what came back.
"""

from __future__ import annotations

import re
from html import unescape
from pathlib import Path
from typing import Any

import nbformat
from nbconvert.preprocessors import sanitize
from nbformat.v4 import new_markdown_cell
from nbgrader.preprocessors import NbGraderPreprocessor
from traitlets import Bool, Unicode

MISSING = "was missing in what was handed in: it was put back"
# What is kept of HTML in students' words and outputs: texts and tables, the marks' own among them.
TAGS = (
    *("a", "abbr", "b", "blockquote", "br", "caption", "code", "div", "em", "h1", "h2", "h3", "h4", "h5", "h6", "hr"),
    *("i", "li", "ol", "p", "pre", "s", "small", "span", "strong", "sub", "sup"),
    *("table", "tbody", "td", "th", "thead", "tr", "ul"),
)
SPANS = ["colspan", "rowspan", "scope"]
ATTRIBUTES = {"*": ["style", "title"], "a": ["href"], "td": SPANS, "th": SPANS}
ALT = re.compile(r'<img [^>]*alt="([^"]*)"')


class SafeFeedback(sanitize.SanitizeHTML):
    """Take what could run out of cells that are not the teacher's own."""

    enabled = Bool(True).tag(config=True)  # nbconvert's own steps are not, unless they are told so

    def preprocess(self, nb: Any, resources: Any) -> Any:
        """Sanitize a notebook, and leave out what only widgets and languages need."""
        self.tags, self.attributes, self.styles = list(TAGS), ATTRIBUTES, [*self.styles, "padding"]
        for name in ("widgets", "language_info", "title", "authors"):
            nb.metadata.pop(name, None)
        return super().preprocess(nb, resources)  # type: ignore[no-untyped-call]

    def preprocess_cell(self, cell: Any, resources: Any, cell_index: int) -> Any:
        """Sanitize a cell; of a locked one, whose text is the teacher's own, only what it shows."""
        if cell.cell_type != "code" and cell.metadata.get("nbgrader", {}).get("locked"):
            return cell, resources
        cell.pop("attachments", None)
        for output in cell.get("outputs", ()):  # of a picture, its pixels and its words: as HTML it would be cut apart
            if "image/png" in output.get("data", {}):
                words = ALT.search(str(output.data.pop("text/html", "")))
                output["metadata"] = {"image/png": {"alt": unescape(words[1])}} if words else {}
        return super().preprocess_cell(cell, resources, cell_index)  # type: ignore[no-untyped-call]


class WholeNotebook(NbGraderPreprocessor):  # type: ignore[misc]
    """Put the cells of a submission in order; see this module."""

    course = Unicode(".", help="The course folder.").tag(config=True)

    def preprocess(self, nb: Any, resources: Any) -> Any:
        """Take off marks that mean nothing, and put back what is missing."""
        about = resources["nbgrader"]
        path = Path(self.course, "release", about["assignment"], f"{about['notebook']}.ipynb")
        released = nbformat.read(path, as_version=4).cells if path.is_file() else None  # type: ignore[no-untyped-call]
        known = (
            None if released is None else {_mark(cell): cell.metadata["nbgrader"] for cell in released if _mark(cell)}
        )
        for cell in nb.cells:
            name = _mark(cell)
            if name is None or (known is not None and name not in known):
                cell.metadata.pop("nbgrader", None)
            elif known is not None:
                cell.metadata["nbgrader"] = known[name]  # whatever the file says of its points
        lost = _put_back(nb, released or [])
        nb.metadata["primkit"] = {"faults": [{"cell": name, "name": "cell missing", "says": MISSING} for name in lost]}
        return nb, resources


def _put_back(nb: Any, released: list[Any]) -> list[str]:
    """Put back what is missing, each after the last cell before it that is there; return their names."""
    lost: list[str] = []
    place = 0
    for cell in released:
        names = [_mark(each) for each in nb.cells]
        name = _mark(cell)
        if name is None:
            continue
        if name in names:
            place = names.index(name) + 1
        elif cell.metadata.nbgrader.get("grade") or (cell.metadata.nbgrader.get("locked") and cell.cell_type == "code"):
            back = type(cell)({key: value for key, value in cell.items() if key != "id"})
            note = new_markdown_cell(f"*The cell* `{name}` *{MISSING}.*")  # type: ignore[no-untyped-call]
            note.pop("id", None)
            if nb.nbformat_minor >= 5:
                note["id"], back["id"] = f"note-{len(lost)}", f"put-back-{len(lost)}"
            nb.cells[place:place] = [note, back]
            place += 2
            lost.append(name)
    return lost


def _mark(cell: Any) -> str | None:
    """Return the name that nbgrader knows a cell by."""
    name = (cell["metadata"].get("nbgrader") or {}).get("grade_id")
    return name if isinstance(name, str) else None
