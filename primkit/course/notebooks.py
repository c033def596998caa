"""Notebooks: which problem set a file belongs to, by the cells it holds; without what grading has no use for.

In:  a file that somebody handed in, of any name, edition and size; the notebooks of a course's ``source/``.
Out: a ``Read``: the set and the notebook whose cells it holds, and the content that is kept. An older edition is
     brought up to nbformat 4, and large outputs are left out: grading clears them anyway.

What cannot be read is kept as it is, so that grading tells its student why.
"""

from __future__ import annotations

import json
import re
import warnings
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import nbformat

from .course import Course

LARGE = 2**20  # bytes of a notebook: from there on its outputs are left out
MOST_TEXT = 32 * 2**20  # bytes without pictures: Python's reader of JSON takes up to 27 times as much
PICTURE = re.compile(rb'"[A-Za-z0-9+/=\\]{5000,}"')


@dataclass(frozen=True)
class Cells:
    """The marks of the cells in a course: set -> notebook -> marks, and the stubs of answers by their marks."""

    marks: dict[str, dict[str, set[str]]]
    stubs: dict[str, str]


@dataclass(frozen=True)
class Read:
    """A file: whose cells it holds, how many answers differ from the release, what is kept, what is to be known."""

    set: str
    notebook: str
    answered: int
    content: bytes
    notes: list[str] = field(default_factory=list)


def cells_of(course: Course) -> Cells:
    """Return the marks of all cells in a course."""
    marks: dict[str, dict[str, set[str]]] = {}
    stubs: dict[str, str] = {}
    for name in course.sets():
        for notebook in course.notebooks(name):
            source, released = (
                read_notebook(course.root / place / name / f"{notebook}.ipynb") for place in ("source", "release")
            )
            marks.setdefault(name, {})[notebook] = {mark for mark, _ in marked(source)}
            stubs |= {mark: text_of(cell) for mark, cell in marked(released)}
    return Cells(marks, stubs)


def read_notebook(path: Path) -> Any:
    """Return what a notebook's file holds; a notebook without cells where there is none, or it cannot be read."""
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        return {"cells": []}


def marked(notebook: Any) -> Iterator[tuple[str, Any]]:
    """Yield the cells that nbgrader has marked, with their marks, whatever else is in a notebook."""
    for cell in notebook["cells"] if isinstance(notebook, dict) and isinstance(notebook.get("cells"), list) else ():
        about = cell.get("metadata") if isinstance(cell, dict) else None
        about = about.get("nbgrader") if isinstance(about, dict) else None
        if isinstance(about, dict) and isinstance(about.get("grade_id"), str):
            yield about["grade_id"], cell


def text_of(cell: Any) -> str:
    """Return what stands in a cell; nothing where that is no text."""
    source = cell.get("source", "")
    return "".join(map(str, source)) if isinstance(source, list) else str(source)


def slim(path: Path, cells: Cells) -> Read:
    """Read a file that may be a notebook."""
    whole = path.read_bytes()
    data = PICTURE.sub(b'""', whole) if len(whole) > LARGE else whole
    try:
        if len(data) > MOST_TEXT:
            raise ValueError(f"has more than {MOST_TEXT >> 20} MB without its pictures")
        notebook = json.loads(data.decode("utf-8-sig"))
        old = isinstance(notebook, dict) and "worksheets" in notebook
        if old:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                # nbformat ships no types
                notebook = nbformat.convert(nbformat.from_dict(notebook), 4)  # type: ignore[no-untyped-call]
        found = list(marked(notebook))
    except Exception as error:  # whatever a file holds, and nbformat meets in it
        return Read("", "", 0, whole[:MOST_TEXT], [f"cannot be read: {' '.join(str(error).split())[:80]}"])
    has = {mark for mark, _ in found}
    _, name, held = max(
        ((len(has & marks), name, held) for name, books in cells.marks.items() for held, marks in books.items()),
        default=(0, "", ""),
    )
    if not has & cells.marks.get(name, {}).get(held, set()):
        return Read("", "", 0, whole[:MOST_TEXT], ["holds no cell of any problem set"])
    notes = ["nbformat 3 brought up to 4"] * old
    if len(whole) > LARGE:
        notes.append(f"{len(whole) / 2**20:.0f} MB, kept without outputs")
        for cell in notebook["cells"]:
            if isinstance(cell, dict) and "outputs" in cell:
                cell["outputs"] = []
    kept = json.dumps(notebook, indent=1, ensure_ascii=False).encode("utf-8", "replace") if notes else whole
    answered = sum(text_of(cell) != cells.stubs.get(mark) for mark, cell in found)
    return Read(name, held, answered, kept, notes)
