"""Submissions to a problem set, made from its released notebook: right, untouched, wrong in a listed way, or worse."""

import ast
import copy
import json
import re
import shutil
from importlib import import_module
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
ANSWERS = ROOT / "tests" / "answers"
MARKERS = re.compile(r"^[ \t]*### (BEGIN|END) SOLUTION\n?", re.MULTILINE)


def read(path):
    return json.loads(Path(path).read_text(encoding="utf-8"))


def about(cell):
    return cell["metadata"].get("nbgrader", {})


def text(cell):
    return "".join(cell["source"])


def answers_of(number):
    """Return the listed answers to problem set ``number``: task -> kind -> name -> answer."""
    return import_module(f"tests.answers.assignment_{number}").ANSWERS


class ProblemSet:
    """A released problem set in a course folder; what it makes is handed in there."""

    def __init__(self, course, name):
        self.course, self.name = Path(course), name
        self.source = read(self.course / "source" / name / f"{name}.ipynb")
        self.released = read(self.course / "release" / name / f"{name}.ipynb")
        self.solutions = {
            about(cell)["grade_id"]: MARKERS.sub("", text(cell))
            for cell in self.source["cells"]
            if cell["cell_type"] == "code" and about(cell).get("solution")
        }
        points = {
            about(cell)["grade_id"]: about(cell)["points"] for cell in self.source["cells"] if about(cell).get("grade")
        }
        self.points = sum(points.values())
        self.of = {task: sum(p for cell, p in points.items() if cell.split("-")[0] == task) for task in self.solutions}

    def with_answers(self, answers):
        """Return the released notebook with code in the place of the stubs: all by default of ``answers``."""
        notebook = copy.deepcopy(self.released)
        for cell in notebook["cells"]:
            code = answers.get(about(cell).get("grade_id"))
            if code is not None:
                cell["source"] = code
        return notebook

    def reference(self):
        return self.with_answers(self.solutions)

    def listed(self, task, kind, name):
        """Return a listed answer as a student's cell; its module is handed in beside the notebook."""
        return f"import listed_answers\n\n{task} = listed_answers.ANSWERS[{task!r}][{kind!r}][{name!r}]" + (
            "[0]" if kind == "wrong" else ""
        )

    def hand_in(self, student, notebook, listed=None):
        """Write a notebook into submitted/, or whatever text is given in its place."""
        folder = self.course / "submitted" / student / self.name
        shutil.copytree(self.course / "release" / self.name, folder)
        content = notebook if isinstance(notebook, str) else json.dumps(notebook)
        (folder / f"{self.name}.ipynb").write_text(content, encoding="utf-8")
        if listed is not None:
            shutil.copyfile(ANSWERS / f"assignment_{listed}.py", folder / "listed_answers.py")
        return folder


def with_cell(notebook, source, before=None):
    """Return a notebook with one more cell: before the cell of that name, or in the end."""
    notebook = copy.deepcopy(notebook)
    names = [about(cell).get("grade_id") for cell in notebook["cells"]]
    place = names.index(before) if before else len(names)
    new = {"cell_type": "code", "execution_count": None, "metadata": {}, "outputs": [], "source": source}
    if notebook.get("nbformat_minor", 0) >= 5:
        new["id"] = f"new-{len(names)}"
    notebook["cells"].insert(place, new)
    return notebook


class _Renamed(ast.NodeTransformer):
    def __init__(self, names):
        self.names = names

    def visit_Name(self, node):
        node.id = self.names.get(node.id, node.id)
        return node


def renamed(source, rng):
    """Return a function's code with other names for its own variables, laid out anew: the same algorithm."""
    tree = ast.parse(source)
    stored = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)}
    words = ["alpha", "beta", "gamma", "delta", "here", "there", "left", "mine", "part", "some", "thing", "value"]
    order = rng.permutation(len(words))
    names = {name: f"{words[order[k % len(words)]]}_{k}" for k, name in enumerate(sorted(stored))}
    return ast.unparse(_Renamed(names).visit(tree))
