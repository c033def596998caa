"""A class of twelve, each of them with another trouble: collected, graded, killed, graded, reported, handed back."""

import csv
import inspect
import io
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import zipfile
from html.parser import HTMLParser

import numpy as np
import pytest

from primkit.course.course import ASSIGNMENTS, Course, new_course
from primkit.course.grading import MIME
from primkit.course.handed_in import tree_hash
from primkit.course.handing_back import finish_feedback
from primkit.course.overview import overview
from primkit.course.similar import pairs_in
from tests.classes import PS, SETTINGS, TASK, expected, hand_in, roster
from tests.submissions import ProblemSet, about, answers_of, read, renamed
from tests.test_teaching import table, teach

COMMENT = "Look again at =cone/2, please: <b>half</b> of it."


@pytest.fixture(scope="module")
def handed_back(tmp_path_factory):
    """A course after all that a teacher does with a problem set; the class, and what each command said."""
    folder = tmp_path_factory.mktemp("class")
    teach(folder, "new-course", "course")
    course = folder / "course"
    config = course / "nbgrader_config.py"
    config.write_text(config.read_text("utf-8").replace("c.CarefulExecute.seconds = 5", "c.CarefulExecute.seconds = 1"))
    (course / "course.toml").write_text(SETTINGS)
    (course / "students.csv").write_bytes(roster(12).encode("utf-16"))
    said = {"release": teach(course, "release", PS)}
    class_ = hand_in(folder, ProblemSet(course, PS), np.random.default_rng(1), 12)
    said["collect"] = teach(course, "collect", PS, *(folder / name for name in ("moodle.zip", "canvas.zip", "inbound")))
    if os.name == "posix":  # T2
        with open(os.fsencode(course / "submitted" / "s_002" / PS) + b"/aufgabe_\xfc.txt", "wb") as file:
            file.write(b"x")
    said["killed"] = killed_after(2, course, "grade", PS, "--at-once", "1")
    said["grade"] = teach(course, "grade", PS)
    said["report"] = teach(course, "report", PS)
    comment_on(course / "reports" / PS / "kinds.csv", COMMENT)
    said["report again"] = teach(course, "report", PS)
    said["hand-back"] = teach(course, "hand-back", PS)
    said["similar"] = teach(course, "similar", PS)
    return course, class_, said


def killed_after(lines, course, *words):
    """Run a command until it has said so many lines about students, and kill it with all that it has started."""
    command = [sys.executable, "-m", "primkit", "teach", *words]
    with subprocess.Popen(command, cwd=course, stdout=subprocess.PIPE, text=True, start_new_session=True) as process:
        said = []
        while sum(bool(re.match(r" *\d+ of \d+  ", line)) for line in said) < lines:
            said.append(process.stdout.readline())
            assert said[-1], said
        if os.name == "posix":
            os.killpg(process.pid, signal.SIGKILL)
        process.kill()
    return "".join(said)


def comment_on(path, comment):
    """Write a comment on the kind that most have given, as Excel saves it where numbers have a comma."""
    rows = table(path)
    rows[0]["comment"] = comment
    text = io.StringIO()
    writer = csv.DictWriter(text, rows[0].keys(), delimiter=";", lineterminator="\r\n")
    writer.writeheader()
    writer.writerows(rows)
    path.write_bytes(text.getvalue().encode("cp1252"))


def page(course, student):
    return (course / "feedback" / student / PS / f"{PS}.html").read_text("utf-8")


def by_kind(class_):
    return {kind: student for student, (kind, _) in class_.items()}


def test_everybody_is_placed_and_each_oddness_is_told(handed_back):
    _, class_, said = handed_back
    assert "without a place" not in said["collect"]
    lines = {line.split()[0]: line for line in said["collect"].splitlines() if line.startswith("s_")}
    assert set(lines) == set(class_)
    for student, (_, trouble) in class_.items():
        if trouble.says in (" late", "nbformat 3 brought up to 4", "MB, kept without outputs"):
            assert trouble.says in lines[student]
    assert "1 d 1 h late; 1 earlier kept" in lines[by_kind(class_)["late and twice"]]


def test_honest_work_has_exactly_its_points_and_one_odd_notebook_stops_nobody(handed_back):
    course, class_, _ = handed_back
    rows = {row["id"]: row for row in table(course / "reports" / PS / "class.csv")}
    points = {student: trouble.points for student, (_, trouble) in class_.items() if trouble.points is not None}
    assert {student: float(rows[student]["ps1 (of 15.0)"]) for student in points} == pytest.approx(points)
    cannot = {student for student in class_ if student not in points}
    assert {student for student, row in rows.items() if row["ps1"] == "could not be graded"} == cannot
    assert set(rows) == set(class_)  # one row a student


def test_what_was_killed_goes_on_where_it_was(handed_back):
    _, class_, said = handed_back
    done = re.findall(r"\d+ of 12  (\w+): graded in", said["killed"])
    assert said["grade"].count(": graded before, and not changed since") >= len(done)
    assert said["grade"].count(" of 12  ") == len(class_) == 12
    assert "submitted/ is as it was" in said["grade"]


def test_every_fault_has_its_line(handed_back):
    course, class_, said = handed_back
    wrong = ["  ".join(row.values()) for row in table(course / "reports" / PS / "wrong.csv")]
    told = [*said["collect"].splitlines(), *said["report"].splitlines(), *wrong]
    for student, (kind, trouble) in class_.items():
        if trouble.says:
            assert any(student in line and trouble.says in line for line in told), kind
    endless, right = by_kind(class_)["endless"], by_kind(class_)["right"]
    wrong = [row for row in table(course / "reports" / PS / "wrong.csv") if row["student"] == endless]
    assert {row["name"] for row in wrong if row["part"]} == {"out of time"}
    took = {student: seconds_of(course, student) for student in (endless, right)}
    assert took[endless] > 4.0 > 2.0 > took[right] > 0.0  # each of four parts has a second
    rows = [row for row in table(course / "reports" / PS / "overview.csv") if not row["part"]]
    median = [row["seconds"] for row in rows]  # of the class, of which most are not endless
    assert all(told == "<0.01" or 0.01 <= float(told) < took[endless] for told in median)
    assert not any(row["seconds"] == "<0.01" for row in rows if not row["task"].endswith("-visible"))


def seconds_of(course, student):
    """The processor time of a task, as it stands in what was graded."""
    cells = read(course / "autograded" / student / PS / f"{PS}.ipynb")["cells"]
    (cell,) = [cell for cell in cells if about(cell).get("grade_id") == f"{TASK}-hidden"]
    return cell["metadata"]["primkit"]["seconds"]


class Harmful(HTMLParser):
    """What of a page could run: elements, and attributes."""

    def __init__(self):
        super().__init__()
        self.found = []

    def handle_starttag(self, tag, attrs):
        if tag in ("script", "iframe", "object", "embed", "svg", "form"):
            self.found.append(tag)
        runs = [name for name, value in attrs if name.startswith("on") or "javascript:" in (value or "").lower()]
        self.found += runs


def harm_in(html):
    reader = Harmful()
    reader.feed(html)
    return reader.found


def test_no_script_is_left_in_the_feedback(handed_back):
    course, class_, _ = handed_back
    text = page(course, by_kind(class_)["scripts"])
    assert '<meta http-equiv="Content-Security-Policy" content="default-src \'none\';' in text.partition("</head>")[0]
    body = text.partition("<body>")[2]
    assert "alert(" in body  # what was written is read, as words
    assert harm_in(body) == []
    assert harm_in("<script>x</script><a onclick=1 href='JavaScript:x'>") == ["script", "onclick", "href"]
    assert "ray_arc: 4 of 4 points" in body  # the marks' tables are as they were
    assert re.search(r'<table style="border-collapse:\s*collapse', body)
    figure = re.search(r"<img [^>]*data:image/png;base64,[^>]*>", body)
    assert "a beam meets the inside" in figure[0]  # a picture is one, with its words, and no letters of its HTML
    assert "primkit-picture" not in body


def test_a_link_that_runs_leads_nowhere(tmp_path):
    course = new_course(tmp_path / "course", ASSIGNMENTS)
    path = course.root / "feedback" / "ada" / PS / f"{PS}.html"
    path.parent.mkdir(parents=True)
    links = (
        "javascript:x",
        "JAVAscript:x",
        "data:text/html,x",
        "vbscript:x",
        "file:///etc",
        "#top",
        "https://a.example",
    )
    path.write_text("<html><head></head>" + "".join(f'<a href="{link}">x</a>' for link in links), "utf-8")
    finish_feedback(course, PS, "ada", ())
    html = path.read_text("utf-8")
    assert re.findall('href="(.*?)"', html) == [*["#"] * 5, "#top", "https://a.example"]


def test_wrong_answers_that_fail_alike_are_one_kind_whose_comment_reaches_all(handed_back):
    course, class_, said = handed_back
    alike = {student for student, (kind, _) in class_.items() if kind.startswith("wrong")}
    kinds = table(course / "reports" / PS / "kinds.csv")
    assert (kinds[0]["task"], kinds[0]["students"]) == (TASK, "2")
    assert set(kinds[0]["who"].split()) == alike
    assert not any(kind["what"].startswith(":") for kind in kinds)
    assert kinds[0]["comment"] == COMMENT  # a second report has kept it
    assert "comments for 2" in said["hand-back"]
    told = {student for student, (_, trouble) in class_.items() if "Look again at =cone/2" in page(course, student)}
    assert told == alike
    assert "&lt;b&gt;half&lt;/b&gt;" in page(course, min(alike))


def moodle_import(files, participants):
    """Read a worksheet and a zip of feedback as Moodle's importers do: participant -> grade, comment, files."""
    rows = list(csv.DictReader(io.StringIO((files / "moodle_grades.csv").read_text("utf-8"), newline="")))
    assert {"Identifier", "Grade", "Last modified (grade)"} <= set(rows[0])  # else it is refused
    found = {}
    for row in rows:
        number = int(row["Identifier"][len("Participant ") :])
        assert number in participants
        found[number] = [row["Grade"], row["Feedback comments"], []]
    with zipfile.ZipFile(files / "moodle_feedback.zip") as archive:
        for name in archive.namelist():
            folder, _, file = name.partition("/")
            info = folder.split("_", 4)  # full name, participant, type, plugin, and nothing or a rest
            assert len(info) >= 4
            assert info[2:4] == ["assignsubmission", "file"]
            assert not file.startswith((".", "~"))
            found[int(info[1])][2].append((file, archive.read(name)))
    return found


def canvas_import(files):
    """Read a table of grades and a zip of feedback as Canvas does: user -> grade, files."""
    rows = list(csv.reader(io.StringIO((files / "canvas_grades.csv").read_text("utf-8"), newline="")))
    assert rows[0][:3] == ["Student", "ID", "Section"]
    assert rows[1][0].strip() == "Points Possible"
    assert rows[1][3] == "15"
    found = {int(row[1]): [row[3], []] for row in rows[2:]}
    with zipfile.ZipFile(files / "canvas_feedback.zip") as archive:
        for name in archive.namelist():
            user, attachment = map(int, re.search(r"_(\d+)_(\d+)_", name).groups())  # as it infers both
            assert attachment // 10 == 900 + user - 700
            found[user][1].append((name.rpartition("_")[2], archive.read(name)))
    return found


def test_the_files_for_an_lms_are_read_back_by_its_importer(handed_back):
    course, class_, _ = handed_back
    files = course / "handed_back" / PS
    by_moodle = {500 + n: student for n, student in enumerate(class_) if n % 3 == 0}
    back = moodle_import(files, by_moodle)
    assert set(back) == set(by_moodle)
    for number, (grade, comment, pages) in back.items():
        points = class_[by_moodle[number]][1].points
        assert grade == ("" if points is None else f"{points:g}")
        assert [name for name, _ in pages] == [f"{PS}.html"]
        assert pages[0][1].decode() == page(course, by_moodle[number])
        assert bool(comment) == class_[by_moodle[number]][0].startswith("wrong")
    by_canvas = {700 + n: student for n, student in enumerate(class_) if n % 3 == 1}
    back = canvas_import(files)
    assert set(back) == set(by_canvas)
    for number, (grade, pages) in back.items():
        points = class_[by_canvas[number]][1].points
        assert grade == ("" if points is None else f"{points:g}")
        assert pages[0][1].decode() == page(course, by_canvas[number])


def test_a_forged_mark_is_worth_nothing_and_ends_nothing(handed_back):
    course, class_, said = handed_back
    assert "Traceback" not in "".join(said.values())
    entry = json.loads((course / "reports" / PS / "graded.json").read_text("utf-8"))[by_kind(class_)["forged mark"]]
    assert entry["graded"]


def test_the_list_of_twelve_is_whole(handed_back):
    _, class_, _ = handed_back
    assert len({kind for kind, _ in class_.values()}) == 12
    assert sum(points is None for points in expected(class_).values()) == 2


def copied(course, name):
    """A copy of the course, for what must not change the one that all tests read."""
    return Course(shutil.copytree(course, course.parent / name))


def test_marks_above_the_maximum_and_points_that_differ_are_faults_with_a_name(handed_back):
    from nbgrader.api import Gradebook

    course, class_, _ = handed_back
    again, right = copied(course, "marked"), by_kind(class_)["right"]
    with Gradebook(f"sqlite:///{(again.root / 'gradebook.db').as_posix()}") as book:
        book.find_grade(f"{TASK}-hidden", PS, PS, right).manual_score = 6.7
        book.db.commit()
    for path in again.root.glob(f"autograded/*/{PS}/{PS}.ipynb"):
        notebook = read(path)
        (cell,) = [cell for cell in notebook["cells"] if about(cell).get("grade_id") == "busy_cells-hidden"]
        (mark,) = [output["data"][MIME] for output in cell["outputs"] if MIME in output.get("data", {})]
        mark["of"] = 6.0
        path.write_text(json.dumps(notebook), "utf-8")
    faults = {(fault.student, fault.cell, fault.name): fault.says for fault in overview(again, PS).faults}
    assert faults[right, f"{TASK}-hidden", "above the maximum"] == "6.7 of 4 points"
    assert faults[right, "-", "above the maximum"] == "17.7 of 15 points"
    differs = "the cell has 4 points, its hidden tests 6.0: mend one, then release again"
    assert faults["-", "busy_cells-hidden", "differing points"] == differs


def test_a_release_that_fails_changes_nothing(handed_back):
    """A task is deleted after hand-ins, which nbgrader refuses; a solution is left in what is released."""
    course, _, _ = handed_back
    again = copied(course, "released")
    path, book = again.root / "source" / PS / f"{PS}.ipynb", again.root / "gradebook.db"
    source, before = path.read_text("utf-8"), (tree_hash(again.root / "release"), book.read_bytes())
    notebook = json.loads(source)
    notebook["cells"] = [cell for cell in notebook["cells"] if not about(cell).get("grade_id", "").startswith(TASK)]
    path.write_text(json.dumps(notebook), "utf-8")
    assert "Cannot add or remove cells" in teach(again.root, "release", PS, code=2)
    assert (tree_hash(again.root / "release"), book.read_bytes()) == before
    path.write_text(source.replace("### END SOLUTION", "### END OF IT"), "utf-8")
    assert "primkit: " in teach(again.root, "release", PS, code=2)
    assert (tree_hash(again.root / "release"), book.read_bytes()) == before
    assert [entry.name for entry in (again.root / ".primkit").iterdir()] == ["ps1.lock"]


def test_other_points_a_clearer_text_and_a_new_student_in_mid_term(handed_back):
    course, _, _ = handed_back
    again = copied(course, "changed")
    path = again.root / "source" / PS / f"{PS}.ipynb"
    notebook = json.loads(path.read_text("utf-8"))
    cells = {about(cell).get("grade_id"): cell for cell in notebook["cells"]}
    about(cells[f"{TASK}-visible"])["points"] = 2
    cells[f"{TASK}-text"]["source"] = "Listen."
    path.write_text(json.dumps(notebook), "utf-8")
    with open(again.root / "students.csv", "wb") as file:
        file.write("id\tfirst_name\ns_new\tNew\n".encode("utf-16"))
    said = teach(again.root, "release", PS)
    assert f"Points {TASK}-visible 1 -> 2: `primkit teach grade ps1 --again` gives them to all" in said
    assert f"Texts  {TASK}-text: hand it out again" in said
    from nbgrader.api import Gradebook

    with Gradebook(f"sqlite:///{(again.root / 'gradebook.db').as_posix()}") as book:
        assert book.find_assignment(PS).max_score == 16
        assert book.find_student("s_new").first_name == "New"


# --- alike --------------------------------------------------------------------------------------------------


def test_right_answers_of_different_people_are_not_alike_and_a_renamed_copy_is(handed_back):
    course, _, _ = handed_back
    ps = ProblemSet(course, PS)
    rng = np.random.default_rng(2)
    given = "\n".join("".join(cell["source"]) for cell in ps.released["cells"] if cell["cell_type"] == "code")
    codes = {}
    for task, kinds in answers_of(1).items():
        for name, function in kinds["right"].items():
            codes[f"{task} {name}"] = inspect.getsource(function)
    assert len(codes) > 5
    assert pairs_in(codes, given) == []
    name = next(iter(codes))
    codes["copy"] = renamed(codes[name], rng)
    assert [{pair.first, pair.second} for pair in pairs_in(codes, given)] == [{name, "copy"}]
