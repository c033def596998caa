"""Lessons: ``primkit lessons DIR`` writes the lessons into a folder, also from an installed package.

In:  a folder.
Out: one notebook for each lesson in it, and the recordings that they read. What is there already is somebody's work
     and stays.
"""

from __future__ import annotations

import argparse
import shutil
from pathlib import Path

from ..installed import PROJECT, quoted
from ..table import count
from .words import Parser, path, say

LESSONS_TEXT = "write the lessons into a folder"
LESSONS_EXAMPLES = "A lesson that is there already stays as it is.\n"


def lessons_options(parser: Parser) -> None:
    """Add the options of ``primkit lessons``."""
    parser.add_argument("folder", metavar="DIR", type=path, help="a folder; it is made when it is not there")


def write_lessons(arguments: argparse.Namespace) -> None:
    """Copy each lesson that is not in the folder yet."""
    places = Path(__file__).parents[1] / "lessons", PROJECT / "notebooks"  # in a wheel; in the project's folder
    notebooks = [file for place in places for file in sorted(place.glob("[0-9]*.ipynb"))]
    if not notebooks:
        raise ValueError(f"there are no lessons in {' or '.join(map(str, places))}: install the package again")
    try:
        (arguments.folder / "recordings").mkdir(parents=True, exist_ok=True)
    except (FileExistsError, NotADirectoryError):
        raise ValueError(f"{arguments.folder} must be a folder, got a file or a folder below a file") from None
    new = [file for file in notebooks if not (arguments.folder / file.name).exists()]
    for file in new:
        shutil.copyfile(file, arguments.folder / file.name)
    for file in (notebooks[0].parent / "recordings").iterdir():
        if not (arguments.folder / "recordings" / file.name).exists():
            shutil.copyfile(file, arguments.folder / "recordings" / file.name)
    stay = len(notebooks) - len(new)
    say(
        f"Wrote  {count(len(new), 'lesson')} into {arguments.folder}"
        + (f"; {stay} there already, which stay" * bool(stay))
    )
    say(f"Next   jupyter lab {quoted(arguments.folder / notebooks[0].name)}")
