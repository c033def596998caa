"""Similar: pairs of submissions whose code is more alike than the task makes it, with the lines that are.

Code is cut into pieces as ``leaks.py`` does, without spaces, comments and the names of variables, so that renaming and
laying out anew change nothing. What the release holds counts for nothing, nor does what many hand in: those are the
words of the task. The rarer a shared piece, the more it weighs. A pair is a question, never an answer: read both.

In:  ``submitted/`` of a problem set.
Out: a ``Pair`` for each two that share ``LEAST_ALIKE`` of the smaller one's weight, and the longest passage in both.

Source: Schleimer, Wilkerson, Aiken, "Winnowing: local algorithms for document fingerprinting", 2003; a class is small
enough to keep all fingerprints, not only some in each window.
"""

from __future__ import annotations

import math
from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

from ..formats.files import write_atomically
from ..table import as_csv, count
from .course import Course
from .leaks import COMMENT, PIECE_TOKENS, TOKEN, Piece, rename_variables
from .notebooks import marked, read_notebook, text_of

LEAST_ALIKE = 0.35  # of the weight of the smaller one's own pieces
LEAST_PIECES = 10  # shared ones: with the tokens of the last one, two or three lines
OFTEN = 0.2  # of a class: what more hand in is the task's own, but for what LEAST_OFTEN share
LEAST_OFTEN = 3
SHOWN_LINES = 6  # of a passage


@dataclass(frozen=True)
class Pair:
    """Two submissions: how much of the smaller one's own code is in the other one, and the longest passage in both."""

    first: str
    second: str
    alike: float
    pieces: int
    passage: tuple[str, str]


def report_pairs(course: Course, name: str) -> Iterator[str]:
    """Yield what is said about the pairs of a problem set, and write ``similar.csv``.

    Raises ValueError if fewer than two have handed in.
    """
    codes = {student: "\n".join(_code(course, "submitted", student, name)) for student in course.submitted(name)}
    if len(codes) < 2:
        raise ValueError(f"{name} was handed in by {count(len(codes), 'student')}: there must be two to compare")
    pairs = pairs_in(codes, "\n".join(_code(course, "release", ".", name)))
    rows = [(pair.first, pair.second, pair.alike, pair.pieces, *pair.passage) for pair in pairs]
    header = ("first", "second", "alike", "pieces", "passage_first", "passage_second")
    write_atomically(course.reports(name) / "similar.csv", as_csv(header, rows))
    for pair in pairs:
        yield f"{pair.first} and {pair.second}: {100 * pair.alike:.0f} % of the smaller one's own code is in both"
        for student, passage in zip((pair.first, pair.second), pair.passage, strict=True):
            lines = passage.splitlines()
            yield from (f"  {student}  {line}" for line in lines[:SHOWN_LINES])
    yield f"{count(len(pairs), 'pair')} more alike than {name} makes them, in {course.reports(name) / 'similar.csv'}"


def pairs_in(codes: Mapping[str, str], given: str) -> list[Pair]:
    r"""Return the pairs among programs that share more than what was given and what many have, the most alike first.

    >>> loop = "sum = 0\nfor value in values:\n    if value > most:\n        sum += value ** 2 - gap\nprint(sum / 2)"
    >>> other = "keep = values[values > most]\nprint(np.sum(keep * keep) - gap * len(keep) + np.median(values) * 0)"
    >>> [(pair.first, pair.second) for pair in pairs_in({"a": loop, "b": loop.replace("value", "x"), "c": other}, "")]
    [('a', 'b')]
    """
    held = {student: _located(code) for student, code in codes.items()}
    often = Counter(piece for pieces in held.values() for piece in pieces)
    most, ignored = max(LEAST_OFTEN, OFTEN * len(codes)), set(_located(given))
    weight = {p: math.log(1 + len(codes) / n) for p, n in often.items() if n <= most and p not in ignored}
    total = {student: sum(weight.get(piece, 0.0) for piece in pieces) for student, pieces in held.items()}
    shared: dict[tuple[str, str], list[Piece]] = defaultdict(list)
    owners: dict[Piece, list[str]] = defaultdict(list)
    for student in sorted(held):
        for piece in held[student].keys() & weight.keys():
            owners[piece].append(student)
    for piece, students in owners.items():
        for pair in combinations(students, 2):
            shared[pair].append(piece)
    found = []
    for (first, second), pieces in shared.items():
        alike = sum(weight[piece] for piece in pieces) / min(total[first], total[second])
        if alike >= LEAST_ALIKE and len(pieces) >= LEAST_PIECES:
            passages = tuple(_passage(codes[each], {held[each][piece] for piece in pieces}) for each in (first, second))
            found.append(Pair(first, second, alike, len(pieces), (passages[0], passages[1])))
    return sorted(found, key=lambda pair: (-pair.alike, pair.first, pair.second))


def _code(course: Course, place: str, student: str, name: str) -> Iterator[str]:
    """Yield the code cells of a submission that are not locked, or of the release all of them."""
    for notebook in course.notebooks(name):
        read = read_notebook(course.root / place / student / name / f"{notebook}.ipynb")
        locked = {id(cell) for _, cell in marked(read) if cell["metadata"]["nbgrader"].get("locked")}
        for cell in read.get("cells", ()) if isinstance(read, dict) else ():
            mine = place == "release" or id(cell) not in locked
            if mine and isinstance(cell, dict) and cell.get("cell_type") == "code":
                yield text_of(cell)


def _located(code: str) -> dict[Piece, int]:
    """Return the pieces of a program, each with the line of its middle, where it is found at first."""
    tokens = [(token, n) for n, line in enumerate(code.splitlines()) for token in TOKEN.findall(COMMENT.sub("", line))]
    words = [token for token, _ in tokens]
    found: dict[Piece, int] = {}
    for start in range(len(words) - PIECE_TOKENS + 1):
        found.setdefault(rename_variables(words[start : start + PIECE_TOKENS]), tokens[start + PIECE_TOKENS // 2][1])
    return found


def _passage(code: str, lines: set[int]) -> str:
    """Return the longest run of lines with shared pieces; a line with none may lie between."""
    runs: list[list[int]] = []
    for line in sorted(lines):
        if runs and line - runs[-1][-1] <= 2:
            runs[-1].append(line)
        else:
            runs.append([line])
    longest: Sequence[int] = max(runs, key=len)
    return "\n".join(code.splitlines()[longest[0] : longest[-1] + 1])
