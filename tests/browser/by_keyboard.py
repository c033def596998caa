"""A problem set as a student gets it, solved in Lab by keys alone: no mouse, and nothing that only a script can do.

Down through the notebook with Shift+Enter, which runs a cell and goes on; into a cell with Enter, and its text replaced
by what is written there; a written answer in a text cell in the same way.
"""

import json
import re
import shutil

from .lab import CLOSE, OPEN, PATIENCE, ROOT, SETTLE

SETS = ROOT / "notebooks" / "assignments" / "source"
NAMES = ("ps1", "ps2", "ps3", "ps4", "09_your_own_map")
SOLUTION = re.compile(r"^[ \t]*### BEGIN SOLUTION\n(.*?)^[ \t]*### END SOLUTION\n?", re.MULTILINE | re.DOTALL)
HIDDEN = re.compile(r"^### BEGIN HIDDEN TESTS\n.*?^### END HIDDEN TESTS\n?", re.MULTILINE | re.DOTALL)
PASSED = "The visible tests pass."

# The cell that has the focus of the notebook; whether one writes in it; and whether the kernel has run all.
ACTIVE = "({ open }) => [open.content.activeCellIndex, open.content.mode]"
SAYS = """({ open }) => open.content.widgets.map((cell) => cell.model.type === "code"
    ? cell.outputArea.model.toJSON().map((one) => [one.output_type, [one.text ?? one.evalue ?? ""].flat().join("")])
    : [])"""


def source(cell):
    return "".join(cell["source"])


def is_answer(cell):
    """Tell whether a student writes here."""
    return cell["metadata"].get("nbgrader", {}).get("solution", False)


def handed_out(notebook):
    """Return a problem set as students get it: without answers, hidden tests and outputs."""
    out = json.loads(json.dumps(notebook))
    for cell in out["cells"]:
        code = HIDDEN.sub("", source(cell))
        if is_answer(cell):
            code = (
                SOLUTION.sub("    raise NotImplementedError\n", code) if cell["cell_type"] == "code" else "Your answer."
            )
        cell["source"] = code
        if cell["cell_type"] == "code":
            cell.update(outputs=[], execution_count=None)
    return out


def solve(page, folder, name, answer=source):
    """Solve a problem set by keys; return for each cell with visible tests what it says in the end.

    ``answer`` gives what is written into a cell: what stands there in the teacher's notebook.
    """
    shutil.copytree(SETS / name, folder / "notebooks" / "sets" / name, ignore=shutil.ignore_patterns(".*"))
    notebook = json.loads((SETS / name / f"{name}.ipynb").read_text(encoding="utf-8"))
    path = f"sets/{name}/{name}.ipynb"
    (folder / "notebooks" / path).write_text(json.dumps(handed_out(notebook)), encoding="utf-8")
    lab = page.evaluate_handle(OPEN, path)
    keys = page.keyboard
    keys.press("Escape")
    for number, cell in enumerate(notebook["cells"]):
        assert lab.evaluate(ACTIVE) == [number, "command"], "the keys are somewhere else"
        if is_answer(cell):
            keys.press("Enter")
            keys.press("Control+A")
            keys.insert_text(answer(cell))
        keys.press("Shift+Enter")
        if number == 0:
            page.wait_for_timeout(200)
    lab.evaluate(SETTLE)
    page.wait_for_function(
        "({ open }) => open.sessionContext.session.kernel.status === 'idle'"
        " && !open.content.widgets.some((cell) => cell.model.executionState === 'running'"
        " || cell.inputArea?.promptNode?.innerText.includes('*'))",
        arg=lab,
        timeout=1000 * PATIENCE,
    )
    says = lab.evaluate(SAYS)
    lab.evaluate(CLOSE)
    return {
        cell["metadata"]["nbgrader"]["grade_id"].removesuffix("-visible"): said
        for cell, said in zip(notebook["cells"], says, strict=False)
        if cell["metadata"].get("nbgrader", {}).get("grade_id", "").endswith("-visible")
    }
