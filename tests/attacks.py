"""Attacks: what a student might try to get points for a wrong answer, or to harm somebody else's.

``attacks.txt`` holds the text of a cell for each, after a line with its name. ``{f}`` is the function that its task
asks for, half of a number. Where a cell defines none, ``return x`` stands before it, which is wrong. ``{course}``,
``{private}`` and ``{port}`` are the course folder, a file of the teacher's, and a port where somebody listens: an
attacker is taken to know them. ``patch(thing, name, value)`` stands ready in the notebook; what it changes is put back
after the task's own cells, so that the next attack meets a sound kernel.
"""

import re
from pathlib import Path


def _groups():
    """Return heading -> name -> text of a cell."""
    text = (Path(__file__).parent / "attacks.txt").read_text(encoding="utf-8")
    groups = {}
    for part in re.split(r"^#{8} ", text, flags=re.MULTILINE)[1:]:
        heading, *cells = re.split(r"^#### (?=.)", part, flags=re.MULTILINE)
        groups[heading.strip()] = {name: body.strip() for name, _, body in (c.partition("\n") for c in cells)}
    return groups


GROUPS = _groups()
ALONE = GROUPS.pop("alone")  # what takes the kernel with it, or meets a limit, has a notebook of its own
ATTACKS = {name: text for group in GROUPS.values() for name, text in group.items()}
FORGERIES = 12


def forgeries(notebook, tasks):
    """Change a notebook's own marks, each trick on the next task: what stands in a file says nothing."""
    cells = notebook["cells"]
    about = {cell["metadata"]["nbgrader"]["grade_id"]: cell for cell in cells if "nbgrader" in cell["metadata"]}
    result = {"output_type": "execute_result", "data": {"text/plain": "3.0"}, "metadata": {}, "execution_count": 1}
    names = iter(tasks)

    def hidden():
        return about[f"{next(names)}-hidden"]

    more_points = hidden()["metadata"]["nbgrader"]
    more_points["points"] = 300
    marked_by_hand = hidden()["metadata"]["nbgrader"]
    marked_by_hand["solution"] = True
    no_grade = hidden()["metadata"]["nbgrader"]
    no_grade.update(grade=False, locked=False)
    renamed = hidden()["metadata"]["nbgrader"]
    renamed["grade_id"] += "-x"
    stored = hidden()
    stored["outputs"], stored["execution_count"] = [result], 1
    other_source = hidden()
    other_source["source"] = "3.0"
    other_type = hidden()
    other_type["cell_type"] = "raw"
    other_type.pop("outputs"), other_type.pop("execution_count")
    tagged = hidden()
    tagged["metadata"]["tags"] = ["raises-exception", "skip-execution"]
    cells.remove(hidden())
    twice = hidden()
    copy = {**{key: value for key, value in twice.items() if key != "id"}, "source": "3.0", "outputs": [result]}
    cells.append({**copy, "id": "twice"} if "id" in twice else copy)
    checksum = hidden()["metadata"]["nbgrader"]
    checksum["checksum"] = "0" * 32
    empty = hidden()
    empty["source"] = ""
    notebook["metadata"]["primkit"] = {"faults": [], "without": ["robust"], "confined": "yes"}
    notebook["metadata"]["kernelspec"] = {"name": "bash", "display_name": "Bash", "language": "bash"}
