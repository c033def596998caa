"""A course in miniature: each task asks for half of a number, with a visible test and a hidden one."""

import nbformat

GRADER = """\
from primkit.checks import Check, judges
from primkit.course.grading import Part, Task

def task(name):
    check = Check(name, lambda x: x / 2, lambda rng: [(float(x),) for x in rng.uniform(1, 9, 20)], judges.number("m"))
    return Task(name, [Part("halves numbers", 3, check)])
"""
VISIBLE = "got = {f}(4.0)\nassert np.isclose(got, 2.0), f'half of 4 is 2, got {got}'"
HIDDEN = """\
### BEGIN HIDDEN TESTS
from grader import halves

halves.task('{f}').mark('{f}', globals())
### END HIDDEN TESTS"""
RIGHT, WRONG = "def {f}(x):\n    return x / 2", "def {f}(x):\n    return x"


def cell(source, name, **more):
    """Return a teacher's cell."""
    flags = {"schema_version": 3, "grade_id": name, "locked": True, "grade": False, "solution": False, "task": False}
    return nbformat.v4.new_code_cell(source, metadata={"nbgrader": flags | more}, id=name.replace("_", "-"))


def source_notebook(tasks):
    """Return the teacher's notebook about some tasks."""
    cells = [cell("import numpy as np", "ready")]
    for f in tasks:
        solution = "def {f}(x):\n    ### BEGIN SOLUTION\n    return x / 2\n    ### END SOLUTION"
        cells += [
            cell(solution.replace("{f}", f), f, solution=True, locked=False),
            cell(VISIBLE.replace("{f}", f), f"{f}-visible", grade=True, points=1, cell_type="code"),
            cell(HIDDEN.replace("{f}", f), f"{f}-hidden", grade=True, points=3, cell_type="code"),
        ]
    about = {"kernelspec": {"name": "python3", "display_name": "Python 3", "language": "python"}}
    return nbformat.v4.new_notebook(cells=cells, metadata=about)


def assignments(root, **notebooks):
    """Write a folder of assignments: set -> notebook -> its tasks."""
    (root / "grader").mkdir(parents=True)
    (root / "grader" / "__init__.py").touch()
    (root / "grader" / "halves.py").write_text(GRADER)
    for name, books in notebooks.items():
        (root / "source" / name).mkdir(parents=True)
        for book, tasks in books.items():
            nbformat.write(source_notebook(tasks), root / "source" / name / f"{book}.ipynb")
    return root
