"""Students: the list of a course, however a spreadsheet has written it; and which of them a name means.

In:  ``students.csv`` with the column ``id``, and perhaps ``first_name``, ``last_name``, ``email`` and ``lms_user_id``
     (Canvas's own number), as Excel saves it anywhere: commas, semicolons or tabs; UTF-8, UTF-16 or cp1252; empty rows.
Out: a ``Student`` for each row; ``meant_by`` finds them in the name of a file or folder.

>>> people = [Student("anna", "Anna", "Bauer"), Student("anna_mueller", "Anna", "Müller"), Student("0042", "Li", "Wu")]
>>> [[each.id for each in meant_by(name, people)] for name in ("PS1_Anna_Mueller.ipynb", "Müller, Anna", "42", "Anna")]
[['anna_mueller'], ['anna_mueller'], ['0042'], ['anna']]
"""

from __future__ import annotations

import codecs
import csv
import io
import re
import unicodedata
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from ..arguments import short
from ..formats.files import bounded_read, naming

STUDENT_COLUMNS = ("id", "first_name", "last_name", "email")  # what `nbgrader db student import` reads
# An id becomes a folder, a part of nbgrader's patterns for files, and a word of commands.
ID = re.compile(r"(?!(?i:con|prn|aux|nul|com\d|lpt\d)(\.|$))\w([\w@.-]*[\w@-])?")
ID_RULE = (
    "letters, digits and . _ - @, a letter or digit first, no dot last, and be no device of Windows such as con or nul"
)
SAVE_AS = "in Excel, save it as `CSV UTF-8 (comma delimited)`; in LibreOffice, as Text CSV with the character set UTF-8"
UTF_16 = ((codecs.BOM_UTF16_LE, "utf-16"), (codecs.BOM_UTF16_BE, "utf-16"))
ID_LETTERS = 3  # of an id that is looked for within a longer name: `ps1 (2)` is no file of student 2
BETWEEN = r"[\W_]+"  # the words of a name
ENDING = re.compile(r"(\.ipynb|\.zip|\.eml|[ _-]*\(\d+\)|[ _-]+copy ?\d*)+$", re.IGNORECASE)


@dataclass(frozen=True)
class Student:
    """A row of the list."""

    id: str
    first_name: str = ""
    last_name: str = ""
    email: str = ""
    lms_user_id: str = ""

    @property
    def name(self) -> str:
        """First and last name, or the id where there is none."""
        return f"{self.first_name} {self.last_name}".strip() or self.id


def read_students(path: Path) -> tuple[list[Student], str]:
    """Return the students in a list, and how its text was written.

    Raises ValueError with the rule and the line if it is no such list.
    """
    with naming(path.name):
        header, rows, encoding = read_table(path)
        if "id" not in header:
            raise ValueError(f"must begin with the line {','.join(STUDENT_COLUMNS)}, got {short(','.join(header))}")
        students: dict[str, Student] = {}
        for line, row in rows:
            found = {column: row.get(column, "") for column in (*STUDENT_COLUMNS, "lms_user_id")}
            name = unicodedata.normalize("NFC", found.pop("id"))
            if not ID.fullmatch(name):
                raise ValueError(f"an id must be made of {ID_RULE}, got {short(name)} in line {line}")
            if encoding == "cp1252" and not name.isascii():
                raise ValueError(f"the id {name} in line {line} may be read wrongly: {SAVE_AS}")
            if (other := students.get(_folded(name))) is not None:
                twice = "stand there once" if other.id == name else "differ in more than capital and small letters"
                raise ValueError(f"an id must {twice}, got {other.id} and {name} (line {line})")
            students[_folded(name)] = Student(name, **found)
    return list(students.values()), encoding


def read_table(path: Path) -> tuple[list[str], list[tuple[int, dict[str, str]]], str]:
    """Return a table's columns, its rows that are not empty with their lines, and how its text was written."""
    text, encoding = decoded(bounded_read(path))
    first, _, rest = text.partition("\n")
    if first.lower().startswith("sep="):  # Excel's own first line
        text, first = rest, rest.partition("\n")[0]
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=max(",;\t", key=first.count))
    try:
        rows = [(reader.line_num, [cell.strip() for cell in row]) for row in reader]
    except csv.Error as error:
        raise ValueError(f"must be a table, got a line that is none: {error}") from None
    rows = [(line, row) for line, row in rows if any(row)]
    header = [name.lower() for name in rows[0][1]] if rows else []
    return header, [(line, dict(zip(header, row, strict=False))) for line, row in rows[1:]], encoding


def decoded(data: bytes) -> tuple[str, str]:
    """Return the text of a spreadsheet's bytes, and how it was written.

    Raises ValueError if it is neither Unicode nor plainly cp1252, in which Excel writes CSV in Western Europe.

    >>> decoded("id;Müller".encode("utf-16")), decoded("Müller".encode("cp1252"))
    (('id;Müller', 'utf-16'), ('Müller', 'cp1252'))
    """
    encoding = next((name for mark, name in UTF_16 if data.startswith(mark)), "utf-8-sig")
    if encoding == "utf-8-sig" and data[1::2].count(0) > len(data) // 4:
        encoding = "utf-16-le"  # without its mark
    try:
        return data.decode(encoding), encoding
    except UnicodeDecodeError:
        pass
    try:
        text = data.decode("cp1252")
    except UnicodeDecodeError:
        text = "\0"
    if encoding != "utf-8-sig" or any(not (sign.isascii() or sign.isalpha()) for sign in text) or "\0" in text:
        raise ValueError(f"must be text in UTF-8, UTF-16 or cp1252: {SAVE_AS}")
    return text, "cp1252"


# --- who is meant -------------------------------------------------------------------------------------------


def meant_by(words: str, students: Sequence[Student]) -> list[Student]:
    """Return whom the name of a file or folder means: nobody, one, or several between whom it does not decide."""
    return called(words, students) or _mentioned(ENDING.sub("", words).strip(), students)


def called(words: str, students: Sequence[Student]) -> list[Student]:
    """Return who is called so: by an id, an e-mail address or a full name that is the whole of the words."""
    stem = ENDING.sub("", words).strip()
    folded, letters = _folded(stem), _letters(stem)
    by_id = [each for each in students if folded in {_folded(each.id), _folded(each.email)} - {""}]
    return by_id or [each for each in students if any(letters & _letters(name) for name in _full_names(each))]


def _mentioned(stem: str, students: Sequence[Student]) -> list[Student]:
    """Return whom longer words name: a full name, a number but for its leading zeros, an id, the longest one."""
    if found := [each for each in students if any(_within(name, stem) for name in _full_names(each))]:
        return found
    if stem.isdecimal():
        return [each for each in students if each.id.isdecimal() and int(each.id) == int(stem)]
    named = [each for each in students if len(each.id) >= ID_LETTERS and _within(each.id, stem)]
    return [each for each in named if not any(other is not each and _within(each.id, other.id) for other in named)]


def _full_names(student: Student) -> Iterator[str]:
    if student.first_name and student.last_name:
        yield f"{student.first_name} {student.last_name}"
        yield f"{student.last_name} {student.first_name}"


def _folded(text: str) -> str:
    return unicodedata.normalize("NFC", unicodedata.normalize("NFC", text).casefold())


@cache  # each file of a large class is compared with everybody
def _spellings(text: str) -> tuple[str, str, str]:
    """Return a name as it is, with ae for ä, and without what stands above and below its letters; always three."""
    whole = _folded(text)
    plain = "".join(sign for sign in unicodedata.normalize("NFKD", whole) if not unicodedata.combining(sign))
    return whole, whole.translate({0xE4: "ae", 0xF6: "oe", 0xFC: "ue"}), plain


@cache
def _letters(text: str) -> frozenset[str]:
    """Return the spellings without spaces and signs, as Canvas writes a name."""
    return frozenset({"".join(filter(str.isalnum, spelling)) for spelling in _spellings(text)} - {""})


def _within(name: str, words: str) -> bool:
    """Tell whether a name stands in words with no letter or digit beside it, however it is spelled.

    >>> _within("ada", "ps1_Ada"), _within("ada", "adam"), _within("Jo Müller", "ps1-jo_mueller")
    (True, False, True)
    """
    return any(found and found.search(among) for found, among in zip(_patterns(name), _spellings(words), strict=True))


@cache
def _patterns(name: str) -> list[re.Pattern[str] | None]:
    parts = [[re.escape(part) for part in re.split(BETWEEN, spelled) if part] for spelled in _spellings(name)]
    return [re.compile(rf"(?<![^\W_]){BETWEEN.join(each)}(?![^\W_])") if each else None for each in parts]
