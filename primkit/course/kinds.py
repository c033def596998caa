"""Kinds: a table of the wrong answers that fail alike, with one place for a comment that reaches all who gave one.

In:  an ``Overview``; ``reports/<problem set>/kinds.csv`` as a teacher has filled it in, in any spreadsheet.
Out: the same table, with the comments that were in it; and each kind's comment.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from ..formats.files import naming
from .course import Course
from .overview import Overview
from .students import read_table

KINDS_FILE = "kinds.csv"
KINDS_HEADER = ("kind", "task", "students", "what", "who", "comment")
WHO = 5  # students that are named for each kind


def comments_of(course: Course, name: str) -> dict[str, str]:
    """Return what a teacher has written about the kinds of answers: a kind's code -> comment."""
    path = course.reports(name) / KINDS_FILE
    if not path.is_file():
        return {}
    with naming(KINDS_FILE):
        header, rows, _ = read_table(path)
        if missing := sorted({"kind", "comment"} - {*header}):
            raise ValueError(f"must have the columns kind and comment, lacks {', '.join(missing)}")
    return {row["kind"]: row["comment"] for _, row in rows if row.get("kind") and row.get("comment")}


def kinds_rows(course: Course, seen: Overview) -> Iterator[tuple[Any, ...]]:
    """Yield a row for each kind, with its comment; in the end those with a comment that nobody gives any more."""
    comments = comments_of(course, seen.name)
    for kind in seen.kinds():
        who = " ".join(kind.students[:WHO]) + " ..." * (len(kind.students) > WHO)
        yield kind.code, kind.task, len(kind.students), kind.says, who, comments.pop(kind.code, "")
    for code, comment in comments.items():
        yield code, "", 0, "nobody's answer any more", "", comment
