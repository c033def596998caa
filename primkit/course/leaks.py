"""Leaks: whether a solution, a hidden test or the salt is in what students get.

In:  the teacher's ``source/`` and ``grader/``, and files: notebooks, wheels and other archives, folders, anything.
Out: a ``Leak`` for each place, with what was found there.

Code is compared piece by piece, ``PIECE_TOKENS`` tokens long, without spaces, comments and the names of variables:
whoever renames them is found all the same. A text holds a solution when it has ``LEAK_SHARE`` of its pieces, for single
pieces are in everybody's code. What stands openly in the notebooks, such as a function's first line and the visible
tests, is no secret. Not found: answers of fewer than ``LEAST_TOKENS`` tokens, which cannot be told from chance.
"""

from __future__ import annotations

import ast
import base64
import builtins
import html
import io
import json
import keyword
import re
import zipfile
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ..formats.files import naming, open_archive, unpacked
from .course import SALT
from .notebooks import read_notebook, text_of

MOST_UNPACKED = 2**28  # bytes of one file in an archive
PIECE_TOKENS = 16  # about a line
LEAST_TOKENS = 24  # of a solution that is looked for
# Of the pieces. The grader's functions are many and small, and some of their lines are those of any geometry.
LEAK_SHARE = {"source": 0.35, "grader": 0.6}
MARKS = tuple(f"{end} {what}" for what in ("SOLUTION", "HIDDEN TESTS", "MARK SCHEME") for end in ("BEGIN", "END"))
SKIPPED_FOLDERS = ("__pycache__", ".ipynb_checkpoints", ".git")
PICTURE_TYPES = ("image/png", "image/jpeg", "application/pdf")

TOKEN = re.compile(r"[^\W\d]\w*|\d[\d_.]*(?:e[-+]?\d+)?|\S", re.IGNORECASE)
COMMENT = re.compile(r"#[^\n]*")
KEPT_WORDS = {*keyword.kwlist, *dir(builtins), "np", "pk", "self"}

Piece = tuple[str, ...]


@dataclass(frozen=True)
class Leak:
    """What was found, and where."""

    path: str
    place: str
    what: str

    def __str__(self) -> str:
        return f"{self.path}, {self.place}: {self.what}"


@dataclass
class Secrets:
    """What must not be found."""

    solutions: dict[tuple[str, str], set[Piece]] = field(default_factory=dict)  # by folder, and place in it
    words: dict[str, str] = field(default_factory=dict)

    def add(self, folder: str, where: str, code: str) -> None:
        """Add a solution; one that is too short is left out."""
        if len(_tokens(code)) >= LEAST_TOKENS:
            self.solutions[folder, where] = self.solutions.get((folder, where), set()) | set(pieces(code))


# --- what is secret -----------------------------------------------------------------------------------------


def secrets_of(folder: Path) -> Secrets:
    """Return the secrets of a folder with ``source/`` and ``grader/``, and perhaps a salt."""
    secrets, public = Secrets(), set[Piece]()
    for path in sorted((folder / "source").rglob("*.ipynb")):
        for cell in read_notebook(path)["cells"]:
            shown, hidden = _split(text_of(cell))
            public.update(pieces(shown))
            for part in hidden:
                name = cell.get("metadata", {}).get("nbgrader", {}).get("grade_id", "a cell")
                secrets.add("source", f"the solution of {name} in {path.name}", part)
    for path in sorted((folder / "grader").rglob("*.py")):
        for name, body in _functions(path.read_text(encoding="utf-8")):
            secrets.add("grader", f"{name} in {path.relative_to(folder).as_posix()}", body)
    secrets.solutions = {where: held - public for where, held in secrets.solutions.items() if held - public}
    if (folder / SALT).is_file():
        secrets.words[(folder / SALT).read_text(encoding="utf-8").strip()] = "the salt"
    return secrets


def _split(source: str) -> tuple[str, list[str]]:
    """Return what of a cell students see, and what they do not."""
    shown: list[str] = []
    hidden: list[list[str]] = []
    inside = False
    for line in source.splitlines():
        if any(mark in line for mark in MARKS):
            inside = "BEGIN" in line
            hidden += [[]] * inside
        elif inside:
            hidden[-1] = [*hidden[-1], line]
        else:
            shown.append(line)
    return "\n".join(shown), ["\n".join(part) for part in hidden]


def _functions(source: str) -> Iterator[tuple[str, str]]:
    """Yield the functions of a module: their names, and their code without first line and docstring."""
    lines = source.splitlines()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.FunctionDef):
            body = node.body[1:] if ast.get_docstring(node) else node.body
            if body:
                yield node.name, "\n".join(lines[body[0].lineno - 1 : body[-1].end_lineno])


# --- pieces -------------------------------------------------------------------------------------------------


def pieces(text: str) -> Iterator[Piece]:
    """Yield the pieces of a text: its tokens, variables by the order in which they first appear.

    >>> list(pieces("a = b + 2  # half")) == list(pieces("x = y+2"))
    True
    """
    seen = set[Piece]()
    for version in _versions(text):
        tokens = _tokens(version)
        for start in range(len(tokens) - PIECE_TOKENS + 1):
            piece = rename_variables(tokens[start : start + PIECE_TOKENS])
            if piece not in seen:
                seen.add(piece)
                yield piece


def _versions(text: str) -> Iterator[str]:
    """Yield a text as it stands, and as Python would write it, if it is Python."""
    yield text
    lines = text.splitlines()
    margin = min((len(line) - len(line.lstrip()) for line in lines if line.strip()), default=0)
    inner = "\n".join(line[margin:] for line in lines)
    try:
        yield ast.unparse(ast.parse(inner))
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return


def _tokens(text: str) -> list[str]:
    return TOKEN.findall(COMMENT.sub("", text))


def rename_variables(tokens: Sequence[str]) -> Piece:
    """Return tokens with numbers in the place of variables; attributes and known names stay."""
    names: dict[str, str] = {}
    return tuple(
        token
        if not (token[0].isalpha() or token[0] == "_") or token in KEPT_WORDS or (n and tokens[n - 1] == ".")
        else names.setdefault(token, str(len(names)))
        for n, token in enumerate(tokens)
    )


# --- where it is looked for ---------------------------------------------------------------------------------


def find_leaks(paths: Iterable[Path], secrets: Secrets) -> list[Leak]:
    """Return what of the secrets stands in files, or in the files of folders and archives."""
    shapes = {_shape(piece) for held in secrets.solutions.values() for piece in held}
    leaks = []
    for path in paths:
        if not path.exists():
            raise ValueError(f"there is no {path} to look for leaks in")
        for name, place, text in _texts(path):
            leaks += [Leak(name, place, what) for what in _search(text, secrets, shapes)]
    return leaks


def _search(text: str, secrets: Secrets, shapes: set[Piece]) -> Iterator[str]:
    """Yield what stands in a text."""
    yield from [f"the marker {mark}" for mark in MARKS if mark in text][:1]
    yield from (f"{what} stands there" for word, what in secrets.words.items() if word in text)
    held = set[Piece]()
    for version in _versions(text):
        tokens = _tokens(version)
        shape = _shape(tokens)
        for start in range(len(tokens) - PIECE_TOKENS + 1):
            if shape[start : start + PIECE_TOKENS] in shapes:  # most are told by this alone
                held.add(rename_variables(tokens[start : start + PIECE_TOKENS]))
    for (folder, where), solution in secrets.solutions.items():
        share = len(solution & held) / len(solution)
        if share >= LEAK_SHARE[folder]:
            yield f"{where}, {100 * share:.0f} % of it"


def _shape(tokens: Sequence[str]) -> Piece:
    """Return tokens with one sign for all names and numbers: quick to compare."""
    return tuple("v" if token[0].isalnum() or token[0] == "_" else token for token in tokens)


def _texts(path: Path) -> Iterator[tuple[str, str, str]]:
    """Yield (file, place, text) of all texts in a file or folder."""
    if path.is_dir():
        for inner in sorted(path.rglob("*")):
            if inner.is_file() and not set(inner.parts) & set(SKIPPED_FOLDERS):
                yield from _of_file(inner.as_posix(), inner.read_bytes())
    else:
        yield from _of_file(path.as_posix(), path.read_bytes())


def _of_file(name: str, data: bytes) -> Iterator[tuple[str, str, str]]:
    if zipfile.is_zipfile(io.BytesIO(data)):
        with naming(name), open_archive(data) as archive:
            for member in archive.namelist():
                yield from _of_file(f"{name}/{member}", unpacked(archive, member, MOST_UNPACKED))
        return
    text = data.decode("utf-8", "replace")  # in a binary file, words can still be found
    if name.endswith(".ipynb"):
        with suppress(ValueError, RecursionError):  # what is no JSON is looked through as text
            told = json.loads(text)
            cells = told.pop("cells", None) if isinstance(told, dict) else None
            places = [(f"cell {n}", cell) for n, cell in enumerate(cells if isinstance(cells, list) else [cells], 1)]
            for place, held in [*places, ("the notebook's metadata", told)]:
                yield from ((name, place, words) for words in _strings(held))
            return
    yield name, "text", html.unescape(text) if name.endswith((".html", ".svg")) else text


def _strings(value: Any) -> Iterator[str]:
    """Yield every text in nested values, in HTML and base64, too; a list of texts is read as one."""
    if isinstance(value, list) and value and all(isinstance(line, str) for line in value):
        value = ("" if value[0].endswith("\n") else "\n").join(value)
    if isinstance(value, str):
        yield html.unescape(value)
        with suppress(ValueError):
            yield base64.b64decode(value, validate=True).decode("utf-8", "replace")
        return
    if isinstance(value, dict):
        value = [*value, *(inner for kind, inner in value.items() if kind not in PICTURE_TYPES)]
    for inner in value if isinstance(value, list) else ():
        yield from _strings(inner)
