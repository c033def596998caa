"""The lessons' form: nbval compares their outputs, and passes what it has nothing to compare with; this does not.

Each rule is a function from a notebook to a list of sentences, one for each breach. It is held on every lesson, and
shown a lesson with one thing broken, which it must report.
"""

import ast
import copy
import json
import re
from itertools import pairwise
from pathlib import Path
from types import ModuleType

import pytest

import primkit as pk
from tests.helpers import words_in

ROOT = Path(__file__).resolve().parent.parent
LESSONS = {path.stem: path for path in sorted((ROOT / "notebooks").glob("*.ipynb"))}
MODEL = "01_see_with_rays"  # the lesson that the broken examples are made from

CELLS, WORDS = (25, 40), (1200, 2000)
CELL_WORDS, READ_LINES, SETUP_LINES = 250, 8, 5
TAKEAWAY_WORDS = 20
NO_TAKEAWAY = (
    "Quiz",
    "Recap",
    "On your own",
    "Further reading",
)  # they are questions, the takeaways, and what is beyond
FILE_SIZE = 1_000_000  # bytes
LEAST_TOLD = 20  # letters of the words for who cannot see a picture
DEEPER = "one-step-deeper"  # the tag of a cell that is folded, so that it does not count to the budget
FOLDED = r"^<details><summary>One step deeper: .+?</summary>\n\n.*?^</details>$"

# A lesson's parts in their order: what to look for, in the text or in the code.
PARTS = {
    "at a glance": r"^\*\*At a glance\*\* · \d+ minutes · \*You will be able to\* .+",
    "the end result first": r"^## Where we are going",
    "a prediction": r"^\*\*Predict",
    "a naive attempt": r"^## The first idea fails",
    "the idea": r"^## The idea",
    "the steps": r"^## Build it",
    "your turn": r"^## Your turn",
    "a slider": r"^## Twiddle",
    "failures": r"^## Break it",
    "the library's version": r"^## The library's version",
    "a quiz": r"^## Quiz",
    "back to the prediction": r"^\*\*Back to your prediction",
    "a recap": r"^## Recap",
    "on your own": r"^## On your own",
    "further reading": r"^## Further reading",
}
# The first lesson only walks through: each idea has its own lesson later, so it has neither maths nor a quiz, and is
# shorter. It counts its steps in its headings.
WALK = ("at a glance", "the end result first", "a prediction", "back to the prediction", "your turn", "a slider")
WALKS = {"00_start_here": ((*WALK, "failures", "a recap"), (500, 2000))}

QUESTION = r"^\*\*\d\. "
OPTION = r"<details><summary>(.+?)</summary>(.*?)</details>"


def source(cell):
    return "".join(cell["source"])


def code_cells(lesson):
    return [cell for cell in lesson["cells"] if cell["cell_type"] == "code"]


def text_cells(lesson):
    return [source(cell) for cell in lesson["cells"] if cell["cell_type"] == "markdown"]


def text(lesson):
    """Return the whole text, without blocks of code: a comment in them is no heading."""
    return re.sub(r"^```.*?^```", "", "\n\n".join(text_cells(lesson)), flags=re.MULTILINE | re.DOTALL)


def section(lesson, heading):
    """Return the text below a heading of level two."""
    found = re.search(rf"^## {heading}\b.*?\n(.*?)(?=^## |\Z)", text(lesson), re.MULTILINE | re.DOTALL)
    return found[1] if found else ""


def deeper(cell):
    return DEEPER in cell["metadata"].get("tags", [])


def in_sight(lesson):
    """Return the cells that count to the budget: those that are not folded."""
    return [cell for cell in lesson["cells"] if not deeper(cell)]


def without_folded(text):
    """Return a text without what is folded in it as one step deeper."""
    return re.sub(FOLDED, "", text, flags=re.MULTILINE | re.DOTALL)


def outputs(cell, kind):
    return [output["data"][kind] for output in cell["outputs"] if kind in output.get("data", {})]


def not_run_in_order(lesson):
    counts = [cell["execution_count"] for cell in code_cells(lesson)]
    return [] if counts == list(range(1, len(counts) + 1)) else [f"cells were run as {counts}"]


def failed_or_silent(lesson):
    breaches = []
    for cell in code_cells(lesson):
        if any(output["output_type"] == "error" for output in cell["outputs"]):
            breaches.append(f"failed: {source(cell)}")
        if any(output.get("name") == "stderr" for output in cell["outputs"]):
            breaches.append(f"warned: {source(cell)}")
        if not cell["outputs"]:
            breaches.append(f"without output it is compared with nothing: {source(cell)}")
    return breaches


def shell(lesson):
    lines = [line for cell in code_cells(lesson) for line in source(cell).splitlines()]
    return [f"calls the shell or the notebook: {line}" for line in lines if line.lstrip().startswith(("!", "%"))]


def lines_read(cell):
    """Return how many lines of a cell are read: not blank ones, docstrings, assertions, imports, or what is folded."""
    if cell["metadata"].get("jupyter", {}).get("source_hidden"):
        return 0
    code = re.sub(r'"""(?:.|\n)*?"""', "", source(cell))
    return sum(bool(line.strip()) and not re.match(r"\s*(assert|import|from)\b", line) for line in code.splitlines())


def long_cells(lesson):
    long = [f"over {READ_LINES} lines in sight: {source(c)}" for c in code_cells(lesson) if lines_read(c) > READ_LINES]
    return long + [f"over {CELL_WORDS} words: {t}" for t in text_cells(lesson) if len(t.split()) > CELL_WORDS]


def without_takeaway(lesson):
    """Under each heading stands one line to take away, a sentence of its own."""
    breaches = []
    for heading, below in re.findall(r"^## (.+)\n\n(.*(?:\n.+)*)", text(lesson), re.MULTILINE):
        line = re.fullmatch(r"> (\S.*[.?!])", below)
        if heading not in NO_TAKEAWAY and (line is None or len(line[1].split()) > TAKEAWAY_WORDS):
            breaches.append(f"under {heading} no line to take away: {below}")
    return breaches


def setup(lesson):
    first = code_cells(lesson)[0]
    printed = "".join(line for output in first["outputs"] for line in output.get("text", []))
    breaches = [] if source(first).count("\n") < SETUP_LINES else [f"setup of over {SETUP_LINES} lines"]
    return breaches + ([] if printed.count("\n") == 1 else ["setup does not print one line"])


def headings(lesson):
    levels = [len(marks) for marks in re.findall(r"^(#+) ", text(lesson), re.MULTILINE)]
    breaches = [] if levels[:1] == [1] and levels.count(1) == 1 else ["not one title at the top"]
    return breaches + ["a level is skipped" for before, after in pairwise(levels) if after > before + 1]


def shows_a_picture(cell):
    return bool(outputs(cell, "image/png") or any("<img" in "".join(html) for html in outputs(cell, "text/html")))


def unseen_by_the_blind(lesson):
    """Each picture has words for who cannot see it, made by the code that draws it."""
    breaches = []
    for cell in filter(shows_a_picture, code_cells(lesson)):
        told = [words for html in outputs(cell, "text/html") for words in words_in("".join(html))]
        if not told or any(len(words) < LEAST_TOLD for words in told):
            breaches.append(f"a picture with the words {told} after: {source(cell)}")
    return breaches


def pictures_without_words(lesson):
    following = [*lesson["cells"][1:], {"cell_type": "none", "source": ""}]
    return [
        f"no '*Figure: ...*' after: {source(cell)}"
        for cell, after in zip(lesson["cells"], following, strict=True)
        if cell["cell_type"] == "code" and shows_a_picture(cell) and not is_an_answer(cell)
        if not re.match(r"\*Figure: \S.{20,}?\*", source(after), re.DOTALL)
    ]


def is_an_answer(cell):
    """A prediction's answer: its picture is words, and they are read aloud."""
    return "pk.widgets.answer(" in source(cell) and not outputs(cell, "image/png")


def missing_parts(lesson):
    wanted, _ = WALKS.get(lesson["name"], (tuple(PARTS), None))
    found = {part: re.search(pattern, text(lesson), re.MULTILINE) for part, pattern in PARTS.items() if part in wanted}
    breaches = [f"missing: {part}" for part, match in found.items() if match is None]
    places = [match.start() for part, match in found.items() if match and part in PARTS]
    return breaches + (
        ["the parts are not in their order"] if lesson["name"] not in WALKS and places != sorted(places) else []
    )


def slider_without_twin(lesson):
    """The slider is for who runs the lesson; its twin, in the same cell, for who reads it."""
    cells = [cell for cell in code_cells(lesson) if re.fullmatch(r"pk\.widgets\.\w+\(\)", source(cell).strip())]
    sliders = list(filter(is_slider, cells))
    return ([] if sliders else ["no slider"]) + [f"no twin: {source(c)}" for c in sliders if not shows_a_picture(c)]


def is_slider(cell):
    return any("".join(words).startswith("Slider: ") for words in outputs(cell, "text/plain"))


def stubs(lesson):
    """Your turn: a function that returns `...`, what its check says of it, and what the lesson goes on with."""
    if lesson["name"] in WALKS:
        return []
    everything = "\n".join(map(source, code_cells(lesson)))
    tasks = [node for node in ast.walk(ast.parse(everything)) if isinstance(node, ast.FunctionDef) and is_stub(node)]
    breaches = [] if tasks else ["no task: a function that returns ..."]
    for task in tasks:
        name = task.name
        if not (ast.get_docstring(task) and task.returns and all(arg.annotation for arg in task.args.args)):
            breaches.append(f"task {name} has no types or no docstring")
        if f"pk.checks.{name}({name})" not in everything:
            breaches.append(f"task {name} is not checked")
        if f"pk.checks.{name}.yours_or_ours({name})" not in everything:
            breaches.append(f"task {name} has no reference to go on with")
    return breaches


def is_stub(function):
    last = function.body[-1]
    return isinstance(last, ast.Return) and "..." in ast.unparse(last)


def poor_quiz(lesson):
    if lesson["name"] in WALKS:
        return []
    questions = re.split(QUESTION, section(lesson, "Quiz"), flags=re.MULTILINE)[1:]
    breaches = [] if 3 <= len(questions) <= 5 else [f"a quiz of {len(questions)} questions"]
    for question in questions:
        options = re.findall(OPTION, question, re.DOTALL)
        if len(options) < 2 or any(len(feedback.split()) < 3 for _, feedback in options):
            breaches.append(f"not two options with feedback each: {question}")
    return breaches


def poor_end(lesson):
    breaches = []
    if not re.search(r"^\|.*\|\n\|[-| ]+\|\n\|", section(lesson, "Recap"), re.MULTILINE):
        breaches.append("no table of symbols in the recap")
    if lesson["name"] not in WALKS:
        own = section(lesson, "On your own")
        breaches += [f"on your own has no level {n}" for n in (1, 2) if f"**Level {n}" not in own]
        breaches += [] if section(lesson, "Further reading").count("\n* ") >= 2 else ["fewer than two to read further"]
    return breaches


def unfolded(lesson):
    """What is one step deeper is not in sight until it is asked for: only its picture, and what tells of it."""
    breaches = []
    for cell in filter(deeper, lesson["cells"]):
        if cell["cell_type"] == "code":
            hidden = cell["metadata"].get("jupyter", {}).get("source_hidden", False)
            breaches += [] if hidden else [f"one step deeper, with its code in sight: {source(cell)}"]
        else:
            rest = re.sub(
                r"\A\*Figure: .+?\*$", "", without_folded(source(cell)), flags=re.MULTILINE | re.DOTALL
            ).strip()
            breaches += [f"one step deeper, in sight: {rest}"] if rest else []
    return breaches


def over_budget(lesson):
    words = sum(len(without_folded(text).split()) for text in text_cells({"cells": in_sight(lesson)}))
    _, (least, most) = WALKS.get(lesson["name"], ((), WORDS))
    breaches = [] if least <= words <= most else [f"{words} words"]
    breaches += [] if CELLS[0] <= len(in_sight(lesson)) <= CELLS[1] else [f"{len(in_sight(lesson))} cells"]
    return breaches + ([] if lesson["size"] <= FILE_SIZE else [f"{lesson['size']} bytes"])


def leftovers(lesson):
    """What changes with every run is not stored: it would make each new run a change."""
    breaches = [f"stores when it was run: {source(c)}" for c in code_cells(lesson) if "execution" in c["metadata"]]
    return breaches + (["stores the widgets' state"] if "widgets" in lesson["metadata"] else [])


RULES = (
    *(not_run_in_order, failed_or_silent, shell, long_cells, without_takeaway, setup, headings),
    *(pictures_without_words, unseen_by_the_blind),
    *(missing_parts, slider_without_twin, stubs, poor_quiz, poor_end, unfolded, over_budget, leftovers),
)


def load(name):
    notebook = json.loads(LESSONS[name].read_text(encoding="utf-8"))
    return notebook | {"size": LESSONS[name].stat().st_size, "name": name}


@pytest.fixture(scope="module", params=LESSONS)
def lesson(request):
    return load(request.param)


def test_the_lessons_are_found():
    assert MODEL in LESSONS


@pytest.mark.parametrize("rule", RULES, ids=lambda rule: rule.__name__)
def test_a_lesson_keeps_the_rule(lesson, rule):
    assert rule(lesson) == []


def test_a_lesson_and_its_picture_count_the_same_ghosts():
    cell = next(cell for cell in code_cells(load("08_drive_it_yourself")) if "plot_change" in source(cell))
    printed = re.findall(r"\d+", "".join(line for output in cell["outputs"] for line in output.get("text", [])))
    (html,) = outputs(cell, "text/html")
    assert re.findall(r"(\d+) of \d+ points are ghosts", "".join(html)) == printed


# --- each rule is shown a lesson with one thing broken ----------------------------------------------------------


def first(lesson, found):
    """Return the first cell in whose source a pattern is found."""
    return next(cell for cell in lesson["cells"] if re.search(found, source(cell), re.MULTILINE))


def replaced(found, put):
    """Break a lesson by replacing the first thing that a pattern finds in its sources."""

    def breaks(lesson):
        cell = first(lesson, found)
        cell["source"] = re.sub(found, lambda _match: put, source(cell), count=1, flags=re.MULTILINE)

    return breaks


def added(to, words):
    """Break a lesson by adding words to the first cell with a pattern."""

    def breaks(lesson):
        cell = first(lesson, to)
        cell["source"] = source(cell) + words

    return breaks


def no_words(lesson):
    for cell in code_cells(lesson):
        for output in cell["outputs"]:
            output.get("data", {}).pop("text/html", None)


def empty_words(lesson):
    cell = next(cell for cell in code_cells(lesson) if shows_a_picture(cell))
    cell["outputs"][-1]["data"]["text/html"] = ['<img alt="" src="data:image/png;base64,">']


def not_run(lesson):
    code_cells(lesson)[-1]["execution_count"] = None


def silent(lesson):
    code_cells(lesson)[2]["outputs"] = []


def failed(lesson):
    code_cells(lesson)[2]["outputs"] = [{"output_type": "error", "ename": "NameError"}]


def warned(lesson):
    code_cells(lesson)[2]["outputs"].append({"output_type": "stream", "name": "stderr", "text": ["RuntimeWarning"]})


def no_figure(lesson):
    cell = next(c for c in lesson["cells"] if source(c).startswith("*Figure: "))
    cell["source"] = "Look at the picture."


def no_figure_of_the_twin(lesson):
    place = next(i for i, c in enumerate(lesson["cells"]) if c["cell_type"] == "code" and is_slider(c))
    lesson["cells"][place + 1]["source"] = "*Figure: twin*"


def two_lines(lesson):
    code_cells(lesson)[0]["outputs"][0]["text"] = ["one\n", "two\n"]


def other_order(lesson):
    parts = [i for i, c in enumerate(lesson["cells"]) if re.search(r"^## (Recap|Break it)", source(c), re.MULTILINE)]
    one, other = (lesson["cells"][i] for i in parts)
    one["source"], other["source"] = source(other), source(one)


def no_twin(lesson):
    for cell in filter(is_slider, code_cells(lesson)):
        cell["outputs"] = cell["outputs"][:1]


def no_slider(lesson):
    for cell in code_cells(lesson):
        if is_slider(cell):
            cell["outputs"] = []


def too_few_cells(lesson):
    del lesson["cells"][5 : 5 + len(lesson["cells"]) - CELLS[0] + 1]


def too_large(lesson):
    lesson["size"] = FILE_SIZE + 1


def tagged(found):
    """Break a lesson by calling a cell one step deeper that everybody sees."""

    def breaks(lesson):
        first(lesson, found)["metadata"]["tags"] = [DEEPER]

    return breaks


def in_sight_beside_it(lesson):
    folded = "<details><summary>One step deeper: more</summary>\n\nThis is folded.\n\n</details>"
    cell = first(lesson, "^## Recap")
    cell.update(metadata={"tags": [DEEPER]}, source=f"{folded}\n\nThis is not.")


def times(lesson):
    code_cells(lesson)[0]["metadata"]["execution"] = {"iopub.status.busy": "2020-01-01T00:00:00Z"}


def views(lesson):
    lesson["metadata"]["widgets"] = {}


BROKEN = {
    "a cell not run": (not_run_in_order, not_run),
    "a cell without output": (failed_or_silent, silent),
    "a cell that failed": (failed_or_silent, failed),
    "a cell that warned": (failed_or_silent, warned),
    "a shell cell": (shell, added("^import primkit", "\n!ls")),
    "a magic": (shell, added("^import primkit", "\n  %time 1")),
    "a long cell": (long_cells, added("^pk.checks.ray_circle", "\n1" * READ_LINES)),
    "a heading without its line": (without_takeaway, replaced(r"^> .*\n\n", "")),
    "a long line to take away": (without_takeaway, replaced(r"^> ", "> word" + " word" * TAKEAWAY_WORDS + " ")),
    "a long text": (long_cells, added("^## Recap", " word" * CELL_WORDS)),
    "a long setup": (setup, added("^import primkit", "\n1" * SETUP_LINES)),
    "a setup that prints two lines": (setup, two_lines),
    "a second title": (headings, replaced("^## Recap", "# Recap")),
    "no title": (headings, replaced("^# ", "")),
    "a skipped level": (headings, replaced("^## Recap", "### Recap\n\n##### Deep")),
    "a picture without words": (pictures_without_words, no_figure),
    "a picture without an alt text": (unseen_by_the_blind, no_words),
    "a picture with an empty alt text": (unseen_by_the_blind, empty_words),
    "a twin with too few words": (pictures_without_words, no_figure_of_the_twin),
    "parts in another order": (missing_parts, other_order),
    **{f"no {part}": (missing_parts, replaced(pattern, "nothing")) for part, pattern in PARTS.items()},
    "no slider shown": (slider_without_twin, no_slider),
    "no twin": (slider_without_twin, no_twin),
    "no task": (stubs, lambda lesson: [replaced(r"return \.\.\.", "return 0")(lesson) for _ in range(2)]),
    "a task without types": (stubs, replaced(r" -> float:", ":")),
    "a task without docstring": (stubs, replaced(r'"""Return the distance[\s\S]*?"""', "0")),
    "a task without check": (stubs, replaced(r"pk\.checks\.\w+\(\w+\)", "0")),
    "a task without reference": (stubs, replaced(r"\.yours_or_ours\(", ".other(")),
    "two questions": (poor_quiz, lambda lesson: [replaced(QUESTION, "")(lesson) for _ in range(3)]),
    "an option without feedback": (poor_quiz, replaced(r"</summary>.*</details>", "</summary></details>")),
    "one option": (
        poor_quiz,
        lambda lesson: [replaced(r"<details>(?=<summary>(?!One))", "<p>")(lesson) for _ in range(2)],
    ),
    "no table": (poor_end, replaced(r"^\|[-| ]+\|$", "")),
    "one level": (poor_end, replaced(r"\*\*Level 2", "Then")),
    "nothing to read": (poor_end, replaced(r"^## Further reading[\s\S]*", "## Further reading\n\n* One book.")),
    "code in sight that should be folded": (unfolded, tagged("^import primkit")),
    "a text in sight that should be folded": (unfolded, tagged("^## Recap")),
    "a text beside what is folded": (unfolded, in_sight_beside_it),
    "too few words": (over_budget, lambda lesson: [c.update(source="#") for c in lesson["cells"]]),
    "too many words": (over_budget, added("^## Recap", " word" * WORDS[1])),
    "too few cells": (over_budget, too_few_cells),
    "too many cells": (over_budget, lambda lesson: lesson["cells"].extend(lesson["cells"][-1:] * CELLS[1])),
    "too large a file": (over_budget, too_large),
    "times": (leftovers, times),
    "the widgets' state": (leftovers, views),
}


@pytest.mark.parametrize(("rule", "breaks"), BROKEN.values(), ids=BROKEN)
def test_a_breach_is_reported(rule, breaks):
    broken = copy.deepcopy(load(MODEL))
    assert rule(broken) == []
    breaks(broken)
    assert len(rule(broken)) >= 1


# --- what any notebook takes of the library -----------------------------------------------------------------------

NOTEBOOKS = sorted(path for path in (ROOT / "notebooks").rglob("*.ipynb") if ".ipynb_checkpoints" not in path.parts)
# A hidden test calls the teacher's own functions, which lie beside the problem sets and are no part of the library.
HIDDEN, TEACHERS_OWN = "### BEGIN HIDDEN TESTS", "grader"


def deep_names(notebook):
    """Report what is not ``pk.name`` or ``pk.wing.name``, and whatever could lead to more."""
    return [f"{breach} in: {source(cell)}" for cell in code_cells(notebook) for breach in deep_names_of(source(cell))]


def deep_names_of(code):
    tree = ast.parse(code)
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            renamed = {(alias.name, alias.asname) for alias in node.names} - {("primkit", "pk")}
            yield from (f"imports {name}" for name, _ in renamed if is_ours(name, code))
        elif isinstance(node, ast.ImportFrom) and is_ours(node.module or "", code):
            yield f"imports from {node.module}"
        elif isinstance(node, ast.Constant) and re.fullmatch(r"primkit(\.\w+)+", str(node.value)):
            yield f"names a module as text: {node.value}"
        elif isinstance(node, ast.Attribute) and re.match("_(?!_)", node.attr):
            yield f"takes a name with an underscore: {node.attr}"
    for root, *names in dotted_names(tree):
        if root in ("__import__", "pk") and not is_public(names):
            yield f"takes {'.'.join([root, *names])}"


def is_ours(module, code):
    first = module.split(".")[0]
    return first in ("primkit", "importlib") or (first == TEACHERS_OWN and HIDDEN not in code)


def dotted_names(tree):
    """Yield each name with all that is taken of it, as far as the dots go: ["pk", "plots", "BLUE"]."""
    within = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Attribute)}
    for node in ast.walk(tree):
        if isinstance(node, (ast.Name, ast.Attribute)) and id(node) not in within:
            names = []
            while isinstance(node, ast.Attribute):
                names.insert(0, node.attr)
                node = node.value
            if isinstance(node, ast.Name):
                yield [node.id, *names]


def is_public(names):
    """Tell whether pk with these names behind it is a name of the story, or a name at the face of a wing."""
    if not names or names[0] not in {*dir(pk), "__version__"}:
        return False  # pk on its own could be handed on, or set anew
    wing = getattr(pk, names[0])
    if not isinstance(wing, ModuleType):
        return True
    return len(names) > 1 and names[1] in wing.__all__ and not isinstance(getattr(wing, names[1]), ModuleType)


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_takes_no_deep_name(path):
    assert deep_names(json.loads(path.read_text(encoding="utf-8"))) == []


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_each_stored_picture_has_words(path):
    notebook = json.loads(path.read_text(encoding="utf-8"))
    assert unseen_by_the_blind(notebook) == []
    assert path.stem == "slides" or any(map(shows_a_picture, code_cells(notebook)))  # slides draw theirs into files


def test_all_notebooks_are_looked_at():
    assert {*LESSONS, "ps1", "ps2", "ps3", "ps4", "09_your_own_map", "slides"} == {path.stem for path in NOTEBOOKS}


def notebook_of(code):
    return {"cells": [{"cell_type": "code", "source": [code]}]}


@pytest.mark.parametrize(
    "code",
    [
        "from primkit.plots.look import BLUE",
        "from primkit import find_shapes",
        "import primkit.plots",
        "import primkit",
        "import primkit as p",
        "import primkit.plots as pk",
        "def f():\n    from primkit import plots",
        "import importlib\nimportlib.import_module('x')",
        "from importlib import import_module",
        "__import__('primkit')",
        "import sys\nsys.modules['primkit.plots.look']",
        "pk.plots.look.BLUE",
        "pk.plots.look",
        "pk.lines.LINE",
        "pk.nothing",
        "pk.widgets.nothing()",
        "plots = pk.plots",
        "getattr(pk, 'lines')",
        "pk.widgets.rays()._redraw()",
        "scene._state",
        "pk._lazy",
        "await pk.plots.look.draw()",
        "from grader import rays_and_grid",
    ],
)
def test_a_deep_name_is_reported(code):
    assert len(deep_names(notebook_of(code))) >= 1


@pytest.mark.parametrize(
    "code",
    [
        "import primkit as pk\nprint(pk.__version__)",
        "pk.find_shapes(grid, settings=pk.PAPER)",
        "pk.Grid().points().T",
        "pk.plots.KIND_COLORS['circle']",
        "pk.widgets.edges().diagram()",
        "pk.checks.meet.yours_or_ours(meet)",
        "for _ in range(3):\n    grid.primkit()",
        "### BEGIN HIDDEN TESTS\nfrom grader import rays_and_grid\n### END HIDDEN TESTS",
    ],
)
def test_a_public_name_is_not_reported(code):
    assert deep_names(notebook_of(code)) == []
