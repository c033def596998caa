"""The teacher's pack: what it names is there, what it tells to type is real, what it says of faults is what they say.

Each rule is a function from a page to a list of sentences, one for each breach. It is held on every page, and shown a
page with one thing broken, which it must report.
"""

import ast
import contextlib
import io
import json
import re
import shlex
from itertools import groupby, pairwise
from pathlib import Path

import matplotlib.image
import pytest

from primkit.__main__ import _parse
from primkit.checks import TASKS
from tests import test_assignments as sets
from tests import test_notebooks as form

ROOT = Path(__file__).resolve().parent.parent
PACK = ROOT / "notebooks" / "teacher"
PAGES = {path.relative_to(PACK).as_posix(): path.read_text(encoding="utf-8") for path in sorted(PACK.rglob("*.md"))}
LESSONS = {name: text for name, text in PAGES.items() if name.startswith("lessons/")}
SETS = {Path(name).stem: text for name, text in PAGES.items() if name.startswith("assignments/")}
NOTEBOOK = PACK / "slides.ipynb"
SLIDES = json.loads(NOTEBOOK.read_text(encoding="utf-8"))
LINES, FIGURE_BYTES = 150, 150_000
LIMITS = ("timeout", "seconds", "megabytes")  # of a course's submissions


def test_the_pack_is_whole():
    assert {"README.md", "assignments.md", "running.md", "untrusted_code.md", "accessibility.md"} <= set(PAGES)
    assert set(LESSONS) == {f"lessons/{number:02d}.md" for number in range(13)}


@pytest.mark.parametrize("name", PAGES)
def test_no_page_is_long(name):
    assert len(PAGES[name].splitlines()) <= LINES


# --- links ---------------------------------------------------------------------------------------------------


def anchors(text):
    """The names that GitHub and JupyterLab give to headings."""
    titles = re.findall(r"^#+ (.+)$", text, re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-") for title in titles}


def dead_links(folder, text):
    dead = []
    for link in re.findall(r"\]\(([^)]+)\)", re.sub(r"^```.*?^```", "", text, flags=re.MULTILINE | re.DOTALL)):
        if re.match(r"https?:", link):
            continue
        file, _, anchor = link.partition("#")
        target = (folder / file).resolve() if file else None
        there = target is None or target.exists()
        if not there or (anchor and anchor not in anchors(target.read_text(encoding="utf-8") if target else text)):
            dead.append(link)
    return dead


@pytest.mark.parametrize("name", PAGES)
def test_every_link_leads_somewhere(name):
    assert dead_links((PACK / name).parent, PAGES[name]) == []


def test_the_slides_links_lead_somewhere():
    assert dead_links(PACK, "\n".join(form.text_cells(SLIDES))) == []


def test_dead_links_are_found():
    text = "# A page\n[a](README.md) [b](no.md) [c](README.md#nowhere) [d](#a-page) [e](#not-here)"
    assert dead_links(PACK, text) == ["no.md", "README.md#nowhere", "#not-here"]


def test_every_page_is_reached_from_the_first_one():
    reached, new = set(), {"README.md"}
    while new:
        reached |= new
        links = {(name, link) for name in new for link in re.findall(r"\]\(([^)#:]+\.md)", PAGES[name])}
        paths = {((PACK / name).parent / link).resolve() for name, link in links}
        new = {path.relative_to(PACK).as_posix() for path in paths if path.is_relative_to(PACK)} - reached
    assert reached == set(PAGES)


# --- commands ------------------------------------------------------------------------------------------------


def typed(text):
    """Return the words of every command that a page tells to type: in blocks, and `primkit ...` within a sentence."""
    blocks = re.findall(r"^```(?:bash|powershell)\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
    lines = [line for block in blocks for line in block.replace("\\\n", " ").splitlines()]
    lines += re.findall(r"`((?:primkit|nbgrader) [^`]+)`", text)
    return [words for line in lines for words in commands_of(line)]


def commands_of(line):
    """Return the commands of a line, each as words; those that a shell is given with -c as well."""
    words = shlex.split(line.replace("\\", "/"), comments=True)
    found = [list(group) for joins, group in groupby(words, lambda word: word in ("&&", ";", "|")) if not joins]
    inner = [after for before, after in pairwise(words) if before == "-c"]
    return found + [command for each in inner for command in commands_of(each)]


def not_a_command(words):
    """Return what is wrong with a command of primkit or nbgrader; others are not looked at."""
    program = next((k for k, word in enumerate(words) if Path(word).name in ("primkit", "nbgrader")), None)
    if program is None or (program and Path(words[0]).name not in ("docker", "sudo")):
        return []
    name, *options = Path(words[program]).name, *words[program + 1 :]
    if name == "nbgrader":
        from nbgrader.apps.nbgraderapp import NbGraderApp

        return [] if options[0] in NbGraderApp.subcommands else [shlex.join(words)]
    try:
        with contextlib.redirect_stdout(io.StringIO()):  # --help prints
            _parse(options)
    except SystemExit as end:
        return [shlex.join(words)] if end.code else []
    return []


@pytest.mark.parametrize("name", PAGES)
def test_every_command_is_real(name):
    assert [wrong for words in typed(PAGES[name]) for wrong in not_a_command(words)] == []


def test_commands_that_are_not_real_are_found(capsys):
    page = "```bash\nprimkit mapp --shapes 4\nprimkit map --shape-count 4\n.venv/bin/primkit map --seed 7\n```\n"
    page += "and `nbgrader autograde ps1`, never `nbgrader autogrdae ps1`\n"
    page += '```bash\nsudo -u grader sh -c "cd /tmp && primkit teach grad ps1"\ndocker run x primkit teach grade\n```\n'
    wrong = [line for words in typed(page) for line in not_a_command(words)]
    assert wrong == [
        *("primkit mapp --shapes 4", "primkit map --shape-count 4"),
        *("primkit teach grad ps1", "docker run x primkit teach grade", "nbgrader autogrdae ps1"),
    ]
    assert "did you mean" in capsys.readouterr().err


def test_every_path_of_the_repository_that_is_typed_is_there():
    words = {word for page in PAGES.values() for command in typed(page) for word in command}
    named = {path for word in words for path in re.findall(r"notebooks/[\w./]+", word)}
    assert named
    assert [path for path in named if not (ROOT / path).exists()] == []


# --- timing --------------------------------------------------------------------------------------------------


def notebook_of(number):
    if number == "09":
        return ROOT / "notebooks/assignments/source/09_your_own_map/09_your_own_map.ipynb"
    return next((ROOT / "notebooks").glob(f"{number}_*.ipynb"))


def sections(notebook):
    text = form.text(json.loads(notebook.read_text(encoding="utf-8")))
    return text, re.findall(r"^##+ (.+)$", text, re.MULTILINE)


def wrong_times(page, text, titles):
    """Return what does not agree in a page's plan with its notebook."""
    stated = int(re.search(r"^(\d+) minutes · ", page, re.MULTILINE)[1])
    rows = re.findall(r"^\| (\d+) \| ([^|]+) \|", page, re.MULTILINE)
    total, says = sum(int(minutes) for minutes, _ in rows), re.search(r"(\d+) minutes", text)
    breaches = [] if total == stated else [f"the plan has {total} minutes, the page says {stated}"]
    breaches += [] if says and int(says[1]) == stated else [f"the notebook does not say {stated} minutes"]
    named = [title for _, cell in rows for title in cell.split(" · ")]
    return breaches + [f"no section {title}" for title in named if title.strip() not in titles]


@pytest.mark.parametrize("name", LESSONS)
def test_the_plan_sums_up_and_names_the_notebook_s_sections(name):
    assert wrong_times(LESSONS[name], *sections(notebook_of(Path(name).stem))) == []


def test_a_wrong_plan_is_found():
    page = LESSONS["lessons/01.md"]
    broken = page.replace("| 14 | Your turn |", "| 15 | Your turns |").replace("50 minutes", "51 minutes")
    text, titles = sections(notebook_of("01"))
    assert wrong_times(broken, text, titles) == ["the notebook does not say 51 minutes", "no section Your turns"]
    assert wrong_times(page.replace("| 14 |", "| 13 |"), text, titles) == ["the plan has 49 minutes, the page says 50"]


# --- usual wrong answers -------------------------------------------------------------------------------------


def rows_of(page):
    """Return for each task of a page what stands in the first column of its table."""
    found = {}
    for part in re.split(r"^### ", page, flags=re.MULTILINE)[1:]:
        task, _, rest = part.partition("\n")
        table = re.split(r"^#+ ", rest, maxsplit=1, flags=re.MULTILINE)[0]
        cells = re.findall(r"^\| ((?:\\\||[^|])+) \| ((?:\\\||[^|])+) \|$", table, re.MULTILINE)[1:]
        found[task.strip("`")] = {says.replace("\\|", "|"): ask for says, ask in cells}
    return found


@pytest.fixture(scope="module")
def answered():
    """Every task of the lesson pages, with its faults and the questions to ask back."""
    pages = [(task, rows) for page in LESSONS.values() for task, rows in rows_of(page).items()]
    assert len({task for task, _ in pages}) == len(pages)
    return dict(pages)


@pytest.mark.parametrize("check", TASKS, ids=lambda check: check.name)
def test_every_fault_of_a_check_is_on_its_page_and_no_other(check, answered):
    assert set(answered[check.name]) == {fault.says for fault in check.faults}


def test_the_pages_hold_no_other_task(answered):
    assert set(answered) == {check.name for check in TASKS}


def test_every_fault_has_a_question_to_ask_back(answered):
    assert [ask for rows in answered.values() for ask in rows.values() if not re.search(r"\?", ask)] == []


def test_each_lesson_s_page_has_its_own_tasks():
    for name, page in LESSONS.items():
        lesson = notebook_of(Path(name).stem)
        code = "\n".join(map(form.source, form.code_cells(json.loads(lesson.read_text(encoding="utf-8")))))
        assert list(rows_of(page)) == re.findall(r"^pk\.checks\.(\w+)\(\1\)$", code, re.MULTILINE), name


# --- problem sets --------------------------------------------------------------------------------------------


def test_every_problem_set_has_its_page():
    assert set(SETS) == set(sets.NOTEBOOKS)


def listed(task):
    """Return for each named fault of a task what its listed wrong answers keep: "2", or "0 to 3"."""
    kept = {}
    for _, loses, fault in sets.ANSWERS[task]["wrong"].values():
        kept.setdefault(fault, set()).add(sets.points_left(task, loses))
    return {name: " to ".join(f"{each:g}" for each in sorted({min(all_), max(all_)})) for name, all_ in kept.items()}


@pytest.mark.parametrize("task", sets.TASKS)
def test_a_task_s_table_has_every_fault_with_what_it_leaves_and_no_other(task):
    page = SETS[sets.BOOK[task]]
    part = page[page.index(f"## `{task}`") :].split("\n## ")[0]
    rows = re.findall(r"^\| (.+?) \| ([\d. to]+) \| (.+\?.*) \|$", part, re.MULTILINE)
    faults = {fault.name for part_ in sets.TASKS[task].parts for fault in part_.check.faults}
    assert {name: points for name, points, _ in rows} == {name: listed(task)[name] for name in faults}
    for part_ in sets.TASKS[task].parts:
        assert f"{part_.points:g} for *{part_.says}*" in part
    visible = sets.points_of(f"{task}-visible") if f"{task}-visible" in sets.CELLS else 0
    assert f"{sets.TASKS[task].points + visible:g} points: {visible:g} for the visible tests" in part


@pytest.mark.parametrize("name", SETS)
def test_a_set_s_page_has_its_own_tasks_and_points(name):
    written = re.findall(r"^## `(\w+)`", SETS[name], re.MULTILINE)
    assert written == [task for task in sets.TASKS if sets.BOOK[task] == name]
    total = sum(sets.graded(cell).get("points") or 0 for cell in sets.NOTEBOOKS[name]["cells"])
    assert SETS[name].splitlines()[2].startswith(f"{total:g} points · ")
    row = re.search(rf"^\| \[.+\]\(assignments/{name}\.md\) .*$", PAGES["assignments.md"], re.MULTILINE)[0]
    assert f"| {total:g} |" in row
    assert re.findall(r"`(\w+)`", row) == [*written, name]


def test_the_rubric_has_a_line_for_each_point_of_the_written_answer():
    """As many as the notebook's own rubric, which students see."""
    rubric = SETS["09_your_own_map"].split("## The written answer")[1]
    rows = re.findall(r"^\| (.+) \| .+ \| .+ \|$", rubric, re.MULTILINE)[1:]
    shown = re.findall(r"^\| .+ \| 1 \|$", sets.source(sets.CELLS["trust-text"]), re.MULTILINE)
    assert len(rows) == len(shown) == sets.points_of("trust")


def test_the_names_that_belong_to_no_task_are_the_program_s_own():
    table = PAGES["assignments.md"].split("belong to no single task:")[1].split("\n## ")[0]
    names = re.findall(r"^\| (.+?) \| .+ \| .+ \|$", table, re.MULTILINE)[1:]
    code = "".join(
        (ROOT / "primkit" / path).read_text(encoding="utf-8")
        for path in ("checks/answer.py", "course/grading/task.py", "course/overview.py")
    )
    assert len(names) > 4
    assert [name for name in names if f'"{name.removesuffix("...").strip()}' not in code] == []


def test_the_task_in_the_text_marks():
    (program,) = re.findall(r"^```python\n(.*?)^```", PAGES["assignments.md"], re.MULTILINE | re.DOTALL)
    scope = {}
    exec(program, scope)
    assert scope["HALF"].marked(lambda x: 0.5 * x).points == 2
    assert scope["HALF"].marked(lambda x: x + x).rows[0].answer.fault == "double for half"


@pytest.mark.parametrize("name", PAGES)
def test_all_python_in_the_pages_can_be_read(name):
    for program in re.findall(r"^```python\n(.*?)^```", PAGES[name], re.MULTILINE | re.DOTALL):
        ast.parse(program)


def test_the_limits_that_are_stated_are_those_of_the_program():
    from primkit.course.course import CONFIG
    from primkit.course.grading.workers import PATIENCE

    cell, part, megabytes = (re.search(rf"\.{name} = (\d+)", CONFIG)[1] for name in LIMITS)
    page = PAGES["untrusted_code.md"]
    assert f"for each part of a hidden test ({part} s of processor time; " in page
    assert f"on the clock {PATIENCE} times as long, and longer on a busy machine), and for each cell ({cell} s)" in page
    assert f"{int(megabytes) / 1024:g} GB for each submission" in page


def not_only_results(page):
    """Report what a page brings back from where submissions have run, other than results: T23."""
    results = {"gradebook.db", "autograded", "feedback", "reports"}
    copies = re.findall(r"cp -r (.*) course/(?=\n|;)", page)
    loops = [names.split() for names in re.findall(r"for what in (.*?);.*\$what course/", page)]
    back = [place.partition("/")[2] or place for copy in copies for place in copy.split() if "$what" not in place]
    return sorted({name for name in [*back, *(name for loop in loops for name in loop)] if name not in results})


def test_t23_only_results_come_back_from_where_submissions_ran():
    page = PAGES["untrusted_code.md"]
    assert len(re.findall(r"cp -r .* course/", page)) == 2
    assert not_only_results(page) == []
    assert not_only_results(page.replace("graded-copy/reports", "graded-copy/grader")) == ["grader"]
    assert not_only_results(page.replace("feedback reports;", "feedback source;")) == ["source"]
    assert not_only_results("cp -r graded-copy course/\n") == ["graded-copy"]


# --- the plan of the course ----------------------------------------------------------------------------------


def test_the_table_of_lessons_says_what_their_pages_say():
    rows = re.findall(r"^\| \[(.+?)\]\((.+?)\) \| (\d+) \| .* \| \[(\d\d)\]", PAGES["README.md"], re.MULTILINE)
    assert [number for *_, number in rows] == [Path(name).stem for name in LESSONS]
    for title, link, minutes, number in rows:
        page = LESSONS[f"lessons/{number}.md"]
        assert page.startswith(f"# {number} {title}\n\n{minutes} minutes · ")
        assert (PACK / link).resolve() == notebook_of(number).resolve()


def test_twelve_sessions_of_ninety_minutes_hold_every_lesson():
    rows = re.findall(r"^\| (\d+) \| ([\d +]+) \| (.+) \|$", PAGES["README.md"], re.MULTILINE)
    assert [int(number) for number, *_ in rows] == list(range(1, 13))
    taught = []
    for _, minutes, what in rows:
        parts = dict(zip(what.split("; "), map(int, minutes.split(" + ")), strict=True))
        assert sum(parts.values()) == 90
        for part, given in parts.items():
            if lesson := re.match(r"lesson (\d\d)", part):
                taught.append(lesson[1])
                assert LESSONS[f"lessons/{lesson[1]}.md"].split("\n")[2].startswith(f"{given} minutes")
    assert taught == [Path(name).stem for name in LESSONS]


# --- slides --------------------------------------------------------------------------------------------------

FIGURES = sorted(path.name for path in (PACK / "figures").iterdir())


def test_the_slides_draw_every_figure_and_show_it():
    code = "\n".join(map(form.source, form.code_cells(SLIDES)))
    assert [f"{name}.png" for name in re.findall(r'^save\(figure, "(\w+)"\)', code, re.MULTILINE)] == FIGURES
    shown = re.findall(r"!\[.+?\]\(figures/(.+?)\)", "\n".join(form.text_cells(SLIDES)))
    assert shown == FIGURES


def test_shown_as_slides_there_is_one_for_each_figure_and_no_code():
    from nbconvert import SlidesExporter

    html, _ = SlidesExporter().from_filename(str(NOTEBOOK))
    assert html.count("<section>") == 2 * (1 + len(FIGURES))  # a title; and each stands in a stack of its own
    assert html.count("<img") == len(FIGURES)
    assert "import numpy" not in html


def test_every_picture_has_words_in_its_place():
    texts = ["\n".join(form.text_cells(SLIDES)), *PAGES.values()]
    assert [alt for text in texts for alt in re.findall(r"!\[(.*?)\]", text) if len(alt.split()) < 10] == []


@pytest.mark.parametrize("name", FIGURES)
def test_a_figure_fits_a_slide(name):
    path = PACK / "figures" / name
    height, width = matplotlib.image.imread(path).shape[:2]
    assert (width, height) == (1280, 720)
    assert path.stat().st_size < FIGURE_BYTES


@pytest.mark.parametrize(
    "rule", [form.not_run_in_order, form.shell, form.long_cells, form.headings], ids=lambda f: f.__name__
)
def test_the_slides_keep_the_lessons_form(rule):
    assert rule(SLIDES) == []


def test_every_finding_is_printed():
    printed = [
        line for cell in form.code_cells(SLIDES) for output in cell["outputs"] for line in output.get("text", [])
    ]
    assert len(printed) >= len(FIGURES)
    assert not any(output["output_type"] == "error" for cell in form.code_cells(SLIDES) for output in cell["outputs"])
