"""Collecting: downloads of a class, whatever is in them, placed with the right student; nothing else harmed."""

import json
import os
import re
import struct
from contextlib import suppress
from datetime import UTC, datetime, timedelta

import pytest

from primkit.course import archives
from primkit.course.collect import collect, table_of
from primkit.course.course import ASSIGNMENTS, new_course
from primkit.course.handed_in import file_faults, tree_hash
from primkit.course.late import Late
from primkit.course.lms import sender_of
from primkit.course.students import Student, called, decoded, meant_by, read_students
from primkit.course.versions import versions_of
from tests.downloads import canvas, clock, edition_3, exchange, mail, moodle, packed, with_outputs
from tests.submissions import read
from tests.test_teaching import teach

PS = "ps1"
CLASS = """\
id,first_name,last_name,email,lms_user_id
ada,Ada,Lovelace,ada@uni.example,
anna,Anna,Bauer,,
anna_mueller,Anna,Müller,,
0042,Li,Wu,li@uni.example,17
jörg,Jörg,Öz,,
s-b@x,Bo,Ek,,
twin1,Eve,Twin,,
twin2,Eve,Twin,,
"""


@pytest.fixture
def course(tmp_path):
    made = new_course(tmp_path / "course", ASSIGNMENTS)
    (made.root / "students.csv").write_text(CLASS, encoding="utf-8")
    return made


NOTEBOOK = read(ASSIGNMENTS / "source" / PS / f"{PS}.ipynb")


def notebook(answer="pass", name=PS):
    """A notebook of a set with something in its last cell that tells it from others."""
    made = json.loads(json.dumps(NOTEBOOK if name == PS else read(ASSIGNMENTS / "source" / name / f"{name}.ipynb")))
    made["cells"].append({"cell_type": "markdown", "metadata": {}, "source": answer, "id": "mine"})
    return json.dumps(made).encode()


def download(course, files, name="download.zip"):
    path = course.root.parent / name
    path.write_bytes(packed(files) if isinstance(files, dict) else files)
    return path


def placed(course, *paths):
    """Collect; return for each student which answer lies in submitted/, and the reasons of what has no place."""
    _, unplaced = collect(course, PS, paths)
    answers = {}
    for path in sorted(course.root.glob(f"submitted/*/{PS}/{PS}.ipynb")):
        answers[path.parts[-3]] = json.loads(path.read_text("utf-8"))["cells"][-1]["source"]
    return answers, {file.place: file.says for file in unplaced}


# --- who it is ----------------------------------------------------------------------------------------------

PEOPLE = [
    *(Student("ada", "Ada", "Lovelace", "ada@uni.example"), Student("anna", "Anna", "Bauer")),
    *(Student("anna_mueller", "Anna", "Müller"), Student("0042", "Li", "Wu", "li@uni.example", "17")),
    *(Student("jörg", "Jörg", "Öz"), Student("s-b@x", "Bo", "Ek"), Student("7")),
]
MEANT = {
    "an id": ("ada", ["ada"]),
    "capital letters": ("ADA", ["ada"]),
    "an id with _, and one that begins alike": ("ps1_anna_mueller.ipynb", ["anna_mueller"]),
    "the one that begins alike": ("ps1_anna.ipynb", ["anna"]),
    "ü in two signs, as a Mac writes it": ("Mu\u0308ller Anna", ["anna_mueller"]),
    "ue for ü": ("Mueller, Anna", ["anna_mueller"]),
    "u for ü": ("anna muller", ["anna_mueller"]),
    "an id with ö": ("ps1-JÖRG.ipynb", ["jörg"]),
    "leading zeros lost": ("42", ["0042"]),
    "leading zeros": ("0042_ps1 (3).ipynb", ["0042"]),
    "a browser's number is no id": ("ps1 (7).ipynb", []),
    "a short id alone": ("7", ["7"]),
    "an address": ("li@uni.example", ["0042"]),
    "an id with signs": ("s-b@x", ["s-b@x"]),
    "within a word": ("canada.ipynb", []),
    "nobody": ("ps1.ipynb", []),
    "two": ("ada and anna", ["ada", "anna"]),
}


@pytest.mark.parametrize(("words", "expected"), MEANT.values(), ids=MEANT)
def test_who_is_meant(words, expected):
    assert [student.id for student in meant_by(words, PEOPLE)] == expected


def test_a_mention_is_not_a_name():
    assert called("ps1_ada", PEOPLE) == []
    assert [student.id for student in called("Ada Lovelace", PEOPLE)] == ["ada"]


SENDERS = {
    "Moodle's folder": (moodle("Ada Lovelace", 4711, "x").partition("/")[0], "moodle", "Ada Lovelace", "4711", ""),
    "since 4.1": ("Ada Lovelace_4711_assignsubmission_file", "moodle", "Ada Lovelace", "4711", ""),
    "no folders": (moodle("Ada", 1, "a_b.ipynb", flat=True), "moodle", "Ada", "1", "a_b.ipynb"),
    "Canvas": (canvas("Ada", "Lovelace", 3, 99, "ps1.ipynb"), "canvas", "lovelaceada", "3", "ps1.ipynb"),
    "late": (canvas("Ada", "Love-Lace", 3, 99, "my_x.ipynb", late=True), "canvas", "lovelaceada", "3", "my_x.ipynb"),
    "again": (canvas("Ada", "Lovelace", 3, 99, "ps1-12.ipynb"), "canvas", "lovelaceada", "3", "ps1.ipynb"),
}


@pytest.mark.parametrize(("name", "lms", "called_", "number", "rest"), SENDERS.values(), ids=SENDERS)
def test_names_of_downloads(name, lms, called_, number, rest):
    sender = sender_of(name)
    assert (sender.lms, sender.name, sender.number, sender.rest) == (lms, called_, number, rest)


# --- where it comes from ------------------------------------------------------------------------------------


def test_moodle_s_download_in_odd_names(course):
    files = {
        moodle("Ada Lovelace", 1, "PS1_Ada.ipynb"): notebook("a"),
        moodle("Anna Müller", 2, "ps1 (1).ipynb", older=False): notebook("b"),
        moodle("Group 1-Jörg Öz", 3, "ps1-Copy1.ipynb", flat=True): notebook("c"),
        moodle("Li Wu", 4, "all.zip"): packed({"deep/inner.zip": packed({"x/mine.ipynb": notebook("d")})}),
        moodle("Grace Hopper", 5, "ps1.ipynb"): notebook("e"),
        moodle("Eve Twin", 6, "ps1.ipynb"): notebook("f"),
    }
    answers, unplaced = placed(course, download(course, files))
    assert answers == {"ada": "a", "anna_mueller": "b", "jörg": "c", "0042": "d"}
    assert sorted(says.partition(":")[0] for says in unplaced.values()) == [
        "Moodle's name 'Eve Twin' may mean twin1 or twin2",
        "Moodle's name 'Grace Hopper' is nobody's in the list of students",
    ]


def test_canvas_s_download_late_and_again(course):
    files = {
        canvas("Ada", "Lovelace", 3, 10, "ps1.ipynb"): notebook("first"),
        canvas("Ada", "Lovelace", 3, 11, "ps1-1.ipynb", late=True): notebook("second"),
        canvas("Somebody", "Else", 17, 12, "ps1.ipynb"): notebook("by Canvas's number"),
        canvas("Ada", "Lovelace", 3, 11, "helper-1.py"): b"x = 1",
    }
    answers, unplaced = placed(course, download(course, files))
    assert answers == {"0042": "by Canvas's number", "ada": "second"}
    assert unplaced == {}
    assert (course.root / "submitted" / "ada" / PS / "helper.py").read_bytes() == b"x = 1"


def test_nbgrader_s_exchange(course):
    inbound = course.root.parent / "inbound"
    for student, when, answer in (
        ("ada", "2026-03-01 10:00:00.5 UTC", "old"),
        ("ada", "2026-03-02 09:00:00 UTC", "new"),
    ):
        folder = inbound / exchange(student, PS, when)
        folder.mkdir(parents=True)
        (folder / f"{PS}.ipynb").write_bytes(notebook(answer))
    answers, unplaced = placed(course, inbound)
    assert (answers, unplaced) == ({"ada": "new"}, {})
    assert [version.when for version in versions_of(course, PS)["ada"]] == [
        "2026-03-01T10:00:00+00:00",
        "2026-03-02T09:00:00+00:00",
    ]


def test_e_mails(course):
    folder = course.root.parent / "mails"
    folder.mkdir()
    (folder / "1.eml").write_bytes(mail("ADA@uni.example", 1772000000, {"ps1.ipynb": notebook("mailed")}))
    (folder / "2.eml").write_bytes(mail("who@else.example", 1772000000, {"ada.ipynb": notebook("forged")}))
    answers, unplaced = placed(course, folder)
    assert answers == {"ada": "mailed"}
    assert unplaced["mails/2.eml/ada.ipynb"].startswith("the address who@else.example is nobody's in the list")
    assert versions_of(course, PS)["ada"][0].when == datetime.fromtimestamp(1772000000, UTC).isoformat()


def test_a_folder_for_each_and_files_of_their_names(course):
    folder = course.root.parent / "by hand"
    for name in ("Anna_Mueller/something.ipynb", "ps1_ada.ipynb"):
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(notebook(name))
    assert placed(course, folder)[0] == {"ada": "ps1_ada.ipynb", "anna_mueller": "Anna_Mueller/something.ipynb"}


def test_nobody_hands_in_for_another(course):
    files = {
        moodle("Ada Lovelace", 1, "jörg/ps1.ipynb"): notebook("ada's"),
        moodle("Anna Bauer", 2, "Jörg Öz_3_assignsubmission_file_/ps1.ipynb"): notebook("anna's"),
    }
    answers, _ = placed(
        course, download(course, files), download(course, {"jörg/ps1.ipynb": notebook()}, "ps1_ada.zip")
    )
    assert "jörg" not in answers
    assert answers["ada"] == "ada's"  # the zip that says ada and holds jörg is nobody's


# --- what it is ---------------------------------------------------------------------------------------------


def test_the_set_is_found_by_its_cells(course):
    files = {
        moodle("Ada Lovelace", 1, "ps1.ipynb"): notebook("a", name="ps2"),
        moodle("Li Wu", 4, "ps2.ipynb"): notebook("really 1"),
    }
    answers, unplaced = placed(course, download(course, files))
    assert answers == {"0042": "really 1"}
    assert list(unplaced.values()) == ["is ps2: `primkit teach collect ps2` places it"]


def test_of_two_notebooks_the_later_one_counts_and_it_is_said(course):
    files = {
        moodle("Ada Lovelace", 1, "ps1.ipynb"): (notebook("early"), (2026, 3, 1, 12, 0, 0)),
        moodle("Ada Lovelace", 1, "ps1-Copy1.ipynb"): (notebook("late"), (2026, 3, 1, 13, 0, 0)),
    }
    answers, _ = placed(course, download(course, files))
    assert answers == {"ada": "late"}
    (version,) = versions_of(course, PS)["ada"]
    assert version.notes == ["ps1-Copy1.ipynb of 2 notebooks, not ps1.ipynb"]


def test_older_editions_and_large_outputs(course):
    old = json.dumps(edition_3(NOTEBOOK)).encode()
    large = json.dumps(with_outputs(NOTEBOOK, 20)).encode()
    assert len(large) > 20 * 2**20
    files = {moodle("Ada Lovelace", 1, "ps1.ipynb"): old, moodle("Li Wu", 2, "ps1.ipynb"): large}
    placed(course, download(course, files))
    for student in ("ada", "0042"):
        path = course.root / "submitted" / student / PS / f"{PS}.ipynb"
        assert path.stat().st_size < 2**20
        assert file_faults(course, PS, student) == []
        cells = json.loads(path.read_text("utf-8"))["cells"]
        assert ["".join(cell["source"]) for cell in cells] == ["".join(cell["source"]) for cell in NOTEBOOK["cells"]]
    notes = {student: versions[0].notes for student, versions in versions_of(course, PS).items()}
    assert notes == {"ada": ["nbformat 3 brought up to 4"], "0042": ["21 MB, kept without outputs"]}


NO_NOTEBOOKS = {
    "cut": (b'{"cells": [', "cannot be read: "),
    "cells that are none": (b'{"cells": [{"metadata": 5}, 7, null]}', "holds no cell of any problem set"),
    "a mark that is none": (b'{"cells": [{"metadata": {"nbgrader": 5}}]}', "holds no cell of any problem set"),
    "nested": (b"[" * 100_000, "cannot be read: "),
    "not text": (b"\xff\xfe\x00\xd8", "cannot be read: "),
    "old and empty": (b'{"worksheets": 3, "nbformat": 3}', "cannot be read: "),
    "other lecture": (json.dumps({"cells": []}).encode(), "holds no cell of any problem set"),
}


@pytest.mark.parametrize(("content", "note"), NO_NOTEBOOKS.values(), ids=NO_NOTEBOOKS)
def test_what_is_no_notebook_is_handed_over_so_that_its_student_is_told(course, content, note):
    files = {moodle("Ada Lovelace", 1, "ps1.ipynb"): content, moodle("Li Wu", 2, "x.ipynb"): notebook("good")}
    collect(course, PS, [download(course, files)])
    assert (course.root / "submitted" / "ada" / PS / f"{PS}.ipynb").read_bytes() == content
    assert versions_of(course, PS)["ada"][0].notes[0].startswith(note)
    assert len(file_faults(course, PS, "ada")) == 1
    assert file_faults(course, PS, "0042") == []


# --- again and again ----------------------------------------------------------------------------------------


def test_it_can_be_run_at_any_time(course):
    first = download(course, {moodle("Ada Lovelace", 1, "ps1.ipynb"): notebook("one")})
    assert placed(course, first)[0] == {"ada": "one"}
    before = tree_hash(course.root / "submitted", course.root / "collected")
    done, _ = collect(course, PS, [first])
    assert tree_hash(course.root / "submitted", course.root / "collected") == before
    assert [each.new for each in done] == [False]
    later = packed({moodle("Ada Lovelace", 1, "ps1.ipynb"): notebook("two")}, when=(2026, 3, 2, 12, 0, 0))
    assert placed(course, download(course, later, "later.zip"))[0] == {"ada": "two"}
    assert placed(course, first)[0] == {"ada": "two"}  # the earlier download does not come back
    again = packed({moodle("Ada Lovelace", 1, "ps1.ipynb"): notebook("one")}, when=(2026, 3, 3, 12, 0, 0))
    assert placed(course, download(course, again, "again.zip"))[0] == {"ada": "one"}
    assert len(versions_of(course, PS)["ada"]) == 3
    row = table_of(course, PS, collect(course, PS, [first])[0])[1]
    assert row == ("ada", "ps1.ipynb", "packed 2026-03-03", "2 earlier kept")


def test_what_was_mended_by_hand_stays(course):
    first = download(course, {moodle("Ada Lovelace", 1, "ps1.ipynb"): notebook("one")})
    collect(course, PS, [first])
    path = course.root / "submitted" / "ada" / PS / f"{PS}.ipynb"
    path.write_bytes(notebook("mended"))
    assert placed(course, first)[0] == {"ada": "mended"}
    assert [version.source for version in versions_of(course, PS)["ada"]][-1] == "submitted/"


def test_an_earlier_version_that_a_teacher_has_put_back_counts_from_then_on(course):
    """As the pack says of an appeal; and it still came from the LMS, and is as late as it was."""
    first = download(course, {moodle("Ada Lovelace", 1, "ps1.ipynb"): notebook("one")})
    later = packed({moodle("Ada Lovelace", 1, "ps1.ipynb"): notebook("two")}, when=(2026, 3, 2, 12, 0, 0))
    assert placed(course, first, download(course, later, "later.zip"))[0] == {"ada": "two"}
    path = course.root / "submitted" / "ada" / PS / f"{PS}.ipynb"
    path.write_bytes(notebook("one"))
    for _ in range(2):
        assert placed(course, first, course.root.parent / "later.zip")[0] == {"ada": "one"}
    latest = versions_of(course, PS)["ada"][-1]
    assert (latest.source, latest.sender["number"], latest.when) == ("submitted/", "1", "")
    newest = packed({moodle("Ada Lovelace", 1, "ps1.ipynb"): notebook("three")}, when=(2090, 3, 3, 12, 0, 0))
    assert placed(course, download(course, newest, "newest.zip"))[0] == {"ada": "three"}


def test_late_by_the_course_s_settings(course):
    (course.root / "course.toml").write_text(
        "[due]\nps1 = 2026-03-01T10:00:00\n[later.ps1]\n0042 = 2026-03-09T10:00:00\n[late]\ngrace_minutes = 30\n"
    )
    files = {
        moodle("Ada Lovelace", 1, "ps1.ipynb"): (notebook("a"), (2026, 3, 2, 13, 0, 0)),
        moodle("Li Wu", 2, "ps1.ipynb"): (notebook("b"), (2026, 3, 2, 13, 0, 0)),
        moodle("Jörg Öz", 3, "ps1.ipynb"): (notebook("c"), (2026, 3, 1, 10, 20, 0)),
    }
    rows = table_of(course, PS, collect(course, PS, [download(course, files)])[0])
    told = {row[0]: row[3] for row in rows}
    assert (told["ada"], told["0042"], told["jörg"]) == ("new; 1 d 3 h late", "new", "new")
    assert told["anna"] == "nothing handed in"


DAY = timedelta(days=1)
PENALTIES = {
    "in time": (-DAY, 0),
    "within grace": (timedelta(minutes=10), 0),
    "an hour": (timedelta(hours=1), 2),
    "two days": (2 * DAY, 4),
    "two days and an hour": (2 * DAY + timedelta(hours=1), 6),
    "after the last day": (4 * DAY, 20),
}


@pytest.mark.parametrize(("over", "expected"), PENALTIES.values(), ids=PENALTIES)
def test_what_coming_late_costs(over, expected):
    due = datetime(2026, 3, 1, tzinfo=UTC)
    rule = Late({"due": {PS: due}, "late": {"grace_minutes": 15, "percent_a_day": 10, "days": 3}})
    assert rule.penalty(PS, "ada", 20.0, due + over) == expected


WRONG_SETTINGS = {
    "a day without a time": ("[due]\nps1 = 2026-03-01", "course.toml: ps1 must be due at a day and a time such as"),
    "a typing error": ("[dew]\n", "course.toml: has the tables due, later and late, got dew"),
    "below zero": ("[late]\ndays = -1", r"course.toml: \[late\] has grace_minutes, percent_a_day, days, numbers >= 0"),
    "no TOML": ("due: ps1", "course.toml: "),
}


@pytest.mark.parametrize(("text", "sentence"), WRONG_SETTINGS.values(), ids=WRONG_SETTINGS)
def test_settings_that_cannot_be(course, text, sentence):
    (course.root / "course.toml").write_text(text)
    with pytest.raises(ValueError, match=sentence):
        Late.of(course.root)


# --- what harms ---------------------------------------------------------------------------------------------


def bomb():
    """A zip of a few kilobytes that unpacks to 300 MB."""
    return packed({f"{k}.txt": b"0" * (60 * 2**20) for k in range(5)})


def test_archives_that_harm_cost_their_student_alone(course):
    deep = notebook()
    for _ in range(6):
        deep = packed({"x.zip": deep})
    locked = bytearray(packed({"ps1.ipynb": notebook()}))
    for sign in (b"PK\x03\x04", b"PK\x01\x02"):
        place = locked.index(sign) + (6 if sign.endswith(b"\x04") else 8)
        locked[place : place + 2] = struct.pack("<H", 1)  # encrypted
    files = {
        moodle("Ada Lovelace", 1, "bomb.zip"): bomb(),
        moodle("Anna Bauer", 2, "deep.zip"): deep,
        moodle("Anna Müller", 3, "broken.zip"): b"PK\x03\x04 and no more",
        moodle("Jörg Öz", 4, "locked.zip"): bytes(locked),
        moodle("Bo Ek", 5, "ps1.rar"): b"Rar!",
        moodle("Li Wu", 6, "ps1.ipynb"): notebook("good"),
        "../../../outside.ipynb": notebook(),
        "/absolute.ipynb": notebook(),
        "C:\\windows.ipynb": notebook(),
        moodle("Bo Ek", 5, "../../ada/ps1.ipynb"): notebook(),
    }
    before = {path for path in course.root.parent.rglob("*") if "course" not in path.parts}
    answers, unplaced = placed(course, download(course, files))
    assert answers == {"0042": "good"}
    after = {path for path in course.root.parent.rglob("*") if "course" not in path.parts}
    assert {path.name for path in after - before} == {"download.zip"}
    says = " | ".join(unplaced.values())
    for words in (
        "unpacks to more than 256 MB",
        "lies within 4 archives",
        "File is not a zip file",
        "is encrypted",
        "is a .rar archive: unpack it",
        "has a name that leads out of its archive",
    ):
        assert words in says
    assert says.count("leads out of its archive") == 4


def test_files_beside_a_notebook_that_cannot_all_be_there(course):
    """A file and a folder of one name, a folder with a notebook's name, names that Windows refuses."""
    beside = ("a", "a/b.txt", "ps1.ipynb/x.txt", "c:d", "good/helper.py", "n" * 120, "what?.py")
    files = {moodle("Ada Lovelace", 1, name): b"x" for name in beside}
    answers, _ = placed(course, download(course, files | {moodle("Ada Lovelace", 1, "ps1.ipynb"): notebook("a")}))
    assert answers == {"ada": "a"}
    folder = course.root / "submitted" / "ada" / PS
    assert sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()) == [
        *("a", "good/helper.py", "ps1.ipynb")
    ]
    assert versions_of(course, PS)["ada"][0].notes[0].startswith("5 files beside it left out")


def test_a_file_that_is_too_large_is_not_read(course, monkeypatch):
    monkeypatch.setattr(archives, "MOST_FILE", 2**20)
    files = {moodle("Ada Lovelace", 1, "ps1.ipynb"): b" " * 2**21, moodle("Li Wu", 2, "ps1.ipynb"): notebook("good")}
    answers, unplaced = placed(course, download(course, files))
    assert answers == {"0042": "good"}
    assert list(unplaced.values()) == ["has more than 1 MB: let its outputs be cleared"]


def old_zip(name, content):
    """A zip whose name is in bytes and not marked as UTF-8."""
    plain = "x" * len(name)
    return packed({f"{plain}/ps1.ipynb": content}).replace(plain.encode(), name)


OLD_NAMES = {
    "cp437, as old zips": "Jörg Öz".encode("cp437"),
    "cp1252, as Windows": "Jörg Öz".encode("cp1252"),
    "UTF-8 without its mark": "Jörg Öz".encode(),
}


@pytest.mark.parametrize("name", OLD_NAMES.values(), ids=OLD_NAMES)
def test_names_that_are_not_marked_as_utf_8(course, name):
    assert placed(course, download(course, old_zip(name, notebook("x"))))[0] == {"jörg": "x"}


@pytest.mark.skipif(os.name != "posix", reason="names are text on Windows")
def test_a_file_s_name_that_is_no_utf_8(course):
    folder = course.root.parent / "class" / "ada"
    folder.mkdir(parents=True)
    (folder / "ps1.ipynb").write_bytes(notebook("x"))
    with open(os.fsencode(folder) + b"/aufgabe_\xfc.txt", "wb") as file:
        file.write(b"beside")
    assert placed(course, folder.parent)[0] == {"ada": "x"}
    assert (course.root / "submitted" / "ada" / PS / "aufgabe_ü.txt").read_bytes() == b"beside"
    with open(os.fsencode(course.root / "submitted" / "ada" / PS) + b"/\xfc.txt", "wb") as file:
        file.write(b"placed by hand")
    assert len(tree_hash(course.root / "submitted")) == 64
    assert file_faults(course, PS, "ada") == []


# --- the list of students, from Excel -----------------------------------------------------------------------

ROWS = "id{0}first_name{0}last_name{0}email\nada{0}Ada{0}Müller{0}\n0042{0}Li{0}Wu{0}\n"
LISTS = {
    "commas": ROWS.format(",").encode(),
    "semicolons, cp1252, empty rows": (ROWS.format(";") + ";;;\n;;;\n").encode("cp1252"),
    "a mark, line ends of Windows": ROWS.format(",").replace("\n", "\r\n").encode("utf-8-sig"),
    "UTF-16 and tabs: `Unicode text`": ROWS.format("\t").encode("utf-16"),
    "UTF-16 without its mark": ROWS.format(",").encode("utf-16-le"),
    "big end first": b"\xfe\xff" + ROWS.format(";").encode("utf-16-be"),
    "Excel's first line": ("sep=;\n" + ROWS.format(";")).encode(),
    "capital letters, spaces, quotes": ROWS.format(",")
    .replace("id,first", ' ID ,"First')
    .replace("_name,l", '_name",l')
    .encode(),
}


@pytest.mark.parametrize("data", LISTS.values(), ids=LISTS)
def test_a_list_however_excel_saves_it(tmp_path, data):
    path = tmp_path / "students.csv"
    path.write_bytes(data)
    students, _ = read_students(path)
    assert [(each.id, each.first_name, each.last_name) for each in students] == [
        ("ada", "Ada", "Müller"),
        ("0042", "Li", "Wu"),
    ]


REFUSED = {
    "..": "id\n..\n",
    ".git": "id\n.git\n",
    "-x": "id\n-x\n",
    "con": "id\ncon\n",
    "NUL.x": "id\nNUL.x\n",
    "ends in a dot": "id\na.\n",
    "a/b": "id\na/b\n",
    "empty": "id,email\nada,\n,x@y\n",
    "Ada beside ada": "id\nada\nAda\n",
    "ü twice, in one and in two signs": "id\n\u00fc\nu\u0308\n",
    "no column id": "name\nada\n",
    "nothing": "",
}


@pytest.mark.parametrize("text", REFUSED.values(), ids=REFUSED)
def test_a_list_that_cannot_be_used_is_refused_in_one_sentence(tmp_path, text):
    path = tmp_path / "students.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(ValueError, match=r"students\.csv: (an id must|must begin with the line id,)") as error:
        read_students(path)
    assert len(str(error.value).splitlines()) == 1


UNREADABLE = {
    "Polish, in cp1250": "id;last_name\nada;Paweł\n".encode("cp1250"),
    "Japanese": "id,last_name\nada,山田\n".encode("shift-jis"),
    "an id that may be read wrongly": "id;last_name\nžofie;x\n".encode("cp1250"),
}


@pytest.mark.parametrize("data", UNREADABLE.values(), ids=UNREADABLE)
def test_what_may_be_read_wrongly_is_told_how_to_save(tmp_path, data):
    path = tmp_path / "students.csv"
    path.write_bytes(data)
    with pytest.raises(ValueError, match="in Excel, save it as `CSV UTF-8"):
        read_students(path)


def test_random_bytes_are_a_text_or_a_sentence():
    for size in range(200):
        with suppress(ValueError):
            assert isinstance(decoded(os.urandom(size))[0], str)


# --- as it is typed -----------------------------------------------------------------------------------------


def test_the_command_ends_with_a_table(course):
    files = {
        moodle("Ada Lovelace", 1, "PS1_Ada.ipynb"): notebook("a"),
        moodle("Grace Hopper", 5, "ps1.ipynb"): notebook("e"),
    }
    said = teach(course.root, "collect", PS, download(course, files))
    assert "ps1: 1 student\n" in said
    assert re.search(r"^ada +PS1_Ada\.ipynb  packed 2026-03-01  new$", said, re.MULTILINE)
    assert re.search(r"^anna_mueller  - +nothing handed in$", said, re.MULTILINE)
    assert "1 file without a place:\n" in said
    assert "Moodle's name 'Grace Hopper' is nobody's in the list of students: mend the list, or put it into" in said


@pytest.mark.parametrize("place", [".", "..", "autograded", "submitted/ada"])
def test_the_course_itself_is_no_download(course, place):
    """What was graded came back as later submissions."""
    with pytest.raises(ValueError, match="is the course's own, with what was graded in it: give the download"):
        collect(course, "ps1", [course.root / place])


def test_without_a_list_nobody_is_placed(tmp_path):
    made = new_course(tmp_path / "course", ASSIGNMENTS)
    assert f"students.csv in {made.root} is empty: fill it in" in teach(made.root, "collect", PS, made.root, code=2)
    (made.root / "students.csv").write_text(CLASS, encoding="utf-8")
    assert "there is no nowhere.zip to collect from" in teach(made.root, "collect", PS, "nowhere.zip", code=2)


def by_moodle(hours, course):
    """Collect three of Moodle's, of which one came so many hours before the others; return what is told of it."""
    (course.root / "course.toml").write_text("[due]\nps1 = 2026-03-01T10:00:00\n")
    files = {
        moodle(name, number, "ps1.ipynb"): (notebook(name), (2026, 3, 2, 20 - hours * (number == 1), 0, 0))
        for number, name in enumerate(("Ada Lovelace", "Li Wu", "Jörg Öz"), 1)
    }
    (ada,) = (row for row in table_of(course, PS, collect(course, PS, [download(course, files)])[0]) if row[0] == "ada")
    return ada[2:]


def test_the_time_at_which_an_lms_has_packed_an_archive_makes_nobody_late(course):
    """Canvas and older Moodles write into an archive when they have made it, alike for all."""
    assert by_moodle(0, course) == ("packed 2026-03-02", "new")


def test_times_that_differ_are_those_of_handing_in(course):
    assert by_moodle(3, course) == ("2026-03-02 17:00", "new; 1 d 7 h late")
    assert datetime.fromisoformat(versions_of(course, PS)["ada"][0].when).timestamp() == clock(2026, 3, 2, 17)


def test_moodle_s_worksheet_says_when_each_was_handed_in(course):
    by_moodle(0, course)
    sheet = course.root.parent / "Grades-C-PS1.csv"
    sheet.write_text(
        "\ufeffIdentifier,Full name,Status,Grade,Last modified (submission)\n"
        'Participant 1,Ada Lovelace,Submitted,,"Sunday, 1 March 2026, 9:30 AM"\n'
        'Participant 2,Li Wu,Submitted,,"Sunday, 1 March 2026, 1:30 PM"\n'
        "Participant 3,Jörg Öz,No submission,,-\n",
        encoding="utf-8",
    )
    done, unplaced = collect(course, PS, [sheet, course.root.parent / "download.zip"])
    told = {row[0]: row[2:] for row in table_of(course, PS, done)}
    assert (told["ada"], told["0042"]) == (("2026-03-01 09:30", ""), ("2026-03-01 13:30", "4 h late"))
    assert told["jörg"] == ("packed 2026-03-02", "")
    assert unplaced == []


def test_a_student_cannot_set_the_clock_back(course):
    (course.root / "course.toml").write_text("[due]\nps1 = 2026-03-01T10:00:00\n")
    early = packed(
        {"ps1.ipynb": notebook("x"), "timestamp.txt": b"2026-02-01 10:00:00 UTC"}, when=(2026, 2, 1, 1, 0, 0)
    )
    files = {
        moodle("Ada Lovelace", 1, "mine.zip"): (early, (2026, 3, 2, 13, 0, 0)),
        moodle("Li Wu", 2, "ps1.ipynb"): (notebook("b"), (2026, 3, 1, 9, 0, 0)),
    }
    told = {row[0]: row[2:] for row in table_of(course, PS, collect(course, PS, [download(course, files)])[0])}
    assert told["ada"] == ("2026-03-02 13:00", "new; 1 d 3 h late")
