"""Printing: a handout of a problem set, and a booklet of its solutions, as PDF.

nbconvert makes the pages; a browser that is here prints them, unseen. (nbconvert's own ``webpdf`` wants one that it
fetches itself.) Formulas are set by MathJax, which comes by the network; without one they stand there as typed. The
release has no outputs: what its given cells show, such as a figure that a text speaks of, is the teacher's.

In:  ``release/`` and ``source/`` of a problem set.
Out: ``paper/<notebook>.pdf``, which students may have, and ``paper/<notebook>_solutions.pdf``, for the teacher.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import tempfile
from collections.abc import Iterator
from pathlib import Path

import nbformat
from nbconvert import HTMLExporter

from .course import Course
from .notebooks import marked

BROWSERS = (
    *("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome"),
    *("msedge", "microsoft-edge"),
)
PLACES = (  # where no command leads to them
    "/Applications/Google Chrome.app/Contents/MacOS/Google Chrome",
    "C:/Program Files/Google/Chrome/Application/chrome.exe",
    "C:/Program Files (x86)/Microsoft/Edge/Application/msedge.exe",
)
PRINT = ("--headless", "--disable-gpu", "--no-pdf-header-footer", "--virtual-time-budget=10000")  # ms, for formulas
PRINT_SECONDS = 120
# Paper has no scroll bar.
WHOLE_LINES = "<style>.jp-CodeCell pre {white-space: pre-wrap; overflow-wrap: anywhere}</style></head>"


def print_set(course: Course, name: str) -> Iterator[Path]:
    """Print a problem set, and yield each file once it is there.

    Raises ValueError if the set was not released, or no browser is here or prints.
    """
    browser = next(filter(None, map(shutil.which, (*BROWSERS, *PLACES))), None)
    if browser is None:
        raise ValueError("a PDF is printed by Chromium, Chrome or Edge, and none is here: install one of them")
    for place, ending in (("release", ""), ("source", "_solutions")):
        for notebook in course.notebooks(name):
            source = course.root / place / name / f"{notebook}.ipynb"
            if not source.is_file():
                raise ValueError(f"{name} was not released: run `primkit teach release {name}` first")
            target = course.root / "paper" / f"{notebook}{ending}.pdf"
            target.parent.mkdir(exist_ok=True)
            _print(browser, page(source, course.root / "source" / name / source.name), target)
            yield target


def page(path: Path, teachers: Path) -> str:
    """Return a notebook as HTML for paper, with what its given cells show in the teacher's notebook."""
    notebook, solved = (nbformat.read(each, as_version=4) for each in (path, teachers))  # type: ignore[no-untyped-call]
    cells = dict(marked(solved))
    for mark, cell in marked(notebook):
        about = cell["metadata"]["nbgrader"]
        if cell["cell_type"] == "code" and about["locked"] and not about["grade"] and mark in cells:
            cell["outputs"] = cells[mark]["outputs"]
    html, _ = HTMLExporter(template_name="webpdf").from_notebook_node(notebook)  # type: ignore[no-untyped-call]
    return str(html).replace("</head>", WHOLE_LINES, 1)


def _print(browser: str, html: str, target: Path) -> None:
    with tempfile.TemporaryDirectory(prefix="primkit-", ignore_cleanup_errors=True) as scratch:
        file = Path(scratch, "page.html")
        file.write_text(html, encoding="utf-8")
        words = [browser, *PRINT, f"--user-data-dir={scratch}", f"--print-to-pdf={target}", file.as_uri()]
        if getattr(os, "geteuid", lambda: 1)() == 0:  # the pages are the teacher's own; root must have it so
            words.insert(1, "--no-sandbox")
        done = subprocess.run(words, capture_output=True, check=False, timeout=PRINT_SECONDS)
    if done.returncode != 0 or not target.is_file():
        raise ValueError(f"{browser} did not print {target.name}: it ended with {done.returncode}")
