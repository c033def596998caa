"""What a lesson asks of a student: words, cells and minutes, beside the minutes that it promises.

    python -m tests.benchmarks.lesson_minutes

An estimate, not a measurement: 150 words of text in sight a minute, and a fixed time for what is done: a task, a
slider, half a minute at the wheel with getting there, a question, and a cell of code that is read.
"""

import re

from tests.test_notebooks import (
    LESSONS,
    READ_LINES,
    code_cells,
    deeper,
    in_sight,
    is_slider,
    lines_read,
    load,
    section,
    source,
    text_cells,
    without_folded,
)

WORDS_A_MINUTE = 150
MINUTES = {"task": 4.0, "slider": 3.0, "wheel": 2.0, "question": 0.5, "cell": 0.4}


def asked_of_a_student(lesson):
    """Return the words, cells, tasks, sliders, wheels, cells of more than READ_LINES, and the minutes."""
    cells = in_sight(lesson)
    words = sum(len(without_folded(text).split()) for text in text_cells({"cells": cells}))
    code = [cell for cell in code_cells(lesson) if not deeper(cell)]
    done = {
        "task": sum("return ..." in source(cell) for cell in code),
        "slider": sum(map(is_slider, code)),
        "wheel": sum("pk.drive_scene(" in source(cell) for cell in code),
        "question": len(re.findall(r"^\*\*\d\. ", section(lesson, "Quiz"), re.MULTILINE)),
        "cell": sum(lines_read(cell) > 0 for cell in code),
    }
    minutes = words / WORDS_A_MINUTE + sum(MINUTES[what] * n for what, n in done.items())
    longer = sum(lines_read(cell) > READ_LINES for cell in code)
    return words, len(cells), done["task"], done["slider"], done["wheel"], longer, minutes


def main():
    print(
        f"lesson  words  cells  tasks  sliders  wheels  cells of over {READ_LINES} lines  minutes, estimated  promised"
    )
    for name in LESSONS:
        lesson = load(name)
        *counts, minutes = asked_of_a_student(lesson)
        (promised,) = re.findall(r"\*\* · (\d+) minutes ·", "".join(text_cells(lesson)))
        print(f"{name[:2]:6}", *(f"{n:6d}" for n in counts), f"{minutes:6.0f} {promised:>6}")


if __name__ == "__main__":
    main()
