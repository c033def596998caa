"""How many slips a check names: the word of a slip's class stands in what it says, outside of the code that it quotes.

In:  a half of the slips, and whether the check may read the student's code; where it may not, as in a submission that
     is graded from afar, it compares with the plain way.
Out: for each slip "named", "missed" or "right".

    python -m tests.slips.named [open | "held out"] [unread]
"""

import importlib
import itertools
import linecache
import re
import sys
from collections import Counter
from pathlib import Path

import numpy as np

import primkit as pk

from .make import CLASSES, EQUIVALENT, mutants

GRADERS = Path(__file__).parents[2] / "notebooks" / "assignments"


def checks():
    """Return task -> its checks: one in a lesson, one for each part in a problem set."""
    found = {task.name: [task] for task in pk.checks.TASKS}
    sys.path.insert(0, str(GRADERS))
    try:
        for name in ("rays_and_grid", "clusters_and_lines", "circles_and_sizes", "maps_and_scores"):
            module = importlib.import_module(f"grader.{name}")
            tasks = [getattr(module, each) for each in module.__all__]
            found |= {task.name: [part.check for part in task.parts] for task in tasks}
    finally:
        sys.path.remove(str(GRADERS))
    return found


def built(slip, *, unread=False):
    """Return a slip's function, with its source where Python looks for it."""
    file, scope = f"<{slip['name']}>", {"np": np, "pk": pk, "itertools": itertools}
    if not unread:
        linecache.cache[file] = (len(slip["code"]), None, slip["code"].splitlines(keepends=True), file)
    exec(compile(slip["code"], file, "exec"), scope)
    return scope[slip["task"]]


def verdict(slip, checks, *, unread=False):
    """Return "right", "named" or "missed", and what was said."""
    function = built(slip, unread=unread)
    answers = [check(function) for check in checks[slip["task"]]]
    says = "\n".join(dict.fromkeys(answer.says for answer in answers if not answer.right))
    if not says:
        return "right", ""
    return ("named" if slip["class"] in re.sub(r"`[^`]*`", "", says) else "missed"), says


def main(half="open", *flags):
    """Print what was not named, and how many were."""
    of, counts = checks(), Counter()
    for slip in mutants():
        if slip["half"] == half and slip["name"] not in EQUIVALENT:
            word, says = verdict(slip, of, unread="unread" in flags)
            counts[slip["class"], word] += 1
            if word != "named":
                print(f"{word}: {slip['name']}: {slip['before']} -> {slip['after']}\n    {says}", flush=True)
    for kind in CLASSES:
        print(kind, {word: counts[kind, word] for word in ("named", "missed", "right")})
    named, every = sum(n for (_, word), n in counts.items() if word == "named"), sum(counts.values())
    print(f"{named} of {every} named ({named / every:.0%}), {len(EQUIVALENT)} equivalent ones taken out of both halves")


if __name__ == "__main__":
    main(*sys.argv[1:])
