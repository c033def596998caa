"""Moved: names in a course folder that an earlier edition had elsewhere, and what is written in their place.

A course folder keeps its own settings and its own copies of ``source/`` and ``grader/``: an update touches none of
them, and what they import may have moved since.

In:  a course folder.
Out: an ``OldName`` for each file and name; none when the course is of this edition.

>>> OldName("grader/parts.py", "primkit.grading").mend
'write primkit.course.grading in its place, everywhere in this file'
>>> OLD_NAME.findall("primkit.personal.personal_scans, primkit.personal_world")  # only a whole word is the old name
['primkit.personal']
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

from .course import Course

# Old -> new. What others begin with comes after them, so that mending in this order mends each name once.
MOVED = {
    "from primkit import grading": "from primkit.course import grading",
    "from primkit import personal": "from primkit.course import personal",
    "primkit.grading.table": "primkit.course.grading.mark",
    "primkit.grading.truth": "primkit.course.personal",
    "primkit.grading": "primkit.course.grading",
    "primkit.personal": "primkit.course.personal",
    "primkit.teaching": "primkit.course",
}
OLD_NAME = re.compile(rf"\b({'|'.join(map(re.escape, MOVED))})\b")
NAMED_IN = ("nbgrader_config.py", "grader/**/*.py", "source/{0}/*.ipynb", "release/{0}/*.ipynb")  # of a problem set


@dataclass(frozen=True)
class OldName:
    """A name that has moved, and the file of the course that uses it."""

    file: str
    name: str

    @property
    def mend(self) -> str:
        """What to do: a release is made anew, everything else is the teacher's own."""
        folder, _, rest = self.file.partition("/")
        if folder == "release":
            return f"primkit teach release {rest.partition('/')[0]}"
        return f"write {MOVED[self.name]} in its place, everywhere in this file"

    def __str__(self) -> str:
        return f"{self.file} names {self.name}, which has moved: {self.mend}"


def old_names(course: Course, name: str = "*") -> Iterator[OldName]:
    """Yield the old names in a course, or in what one problem set needs, file by file."""
    for place in NAMED_IN:
        for path in sorted(course.root.glob(place.format(name))):
            found = set(OLD_NAME.findall(path.read_text(encoding="utf-8", errors="replace")))
            yield from (OldName(path.relative_to(course.root).as_posix(), old) for old in MOVED if old in found)


def refuse_old_names(course: Course, name: str, *, released: bool = True) -> None:
    """Raise a ValueError that says how to mend the first old name in what a problem set needs, if there is one."""
    for old in old_names(course, name):
        if released or not old.file.startswith("release/"):
            raise ValueError(f"{old} (`primkit teach check` names all such files)")
