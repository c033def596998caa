"""How many slips a check names: the word of a slip's class stands in what it says, outside of the code that it quotes.

In:  a half of the slips, and whether the check may read the student's code; where it may not, as in a submission that
     is graded from afar, it compares with the plain way.
Out: for each slip "named", "missed" or "right".

    python -m tests.slips.named [open | "held out"] [unread]
    python -m tests.slips.named fresh SEED [unread | afar]

Of fresh slips none is taken out by hand: one that passes is run beside the right answer on many inputs, and counts as
equivalent only where both return the same on all of them.
"""

import copy
import importlib
import itertools
import linecache
import re
import sys
from collections import Counter
from contextlib import nullcontext
from pathlib import Path

import numpy as np

import primkit as pk
from primkit.checks.calls import Raised, run

from ..test_judge import afar, remote
from .make import CLASSES, EQUIVALENT, answers, fresh, mutants

FRESH_EACH = 2  # of a task
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


def verdict(slip, checks, *, unread=False, far=False):
    """Return "right", "named" or "missed", and what was said; far: of a function in another process."""
    function, task = built(slip, unread=unread), slip["task"]
    with afar(**{task: function}) if far else nullcontext() as workers:
        answers = [check(remote(workers, task) if far else function) for check in checks[task]]
    says = "\n".join(dict.fromkeys(answer.says for answer in answers if not answer.right))
    if not says:
        return "right", ""
    return ("named" if slip["class"] in re.sub(r"`[^`]*`", "", says) else "missed"), says


def same_on(slip, checks, seeds=range(5)):
    """Return (on how many inputs a slip and the right answer return the same, of how many); errors are results, too."""
    source, counts = answers()[slip["task"]], Counter()
    right = built({**slip, "code": source, "name": f"{slip['name']}, right"})
    wrong = built(slip)
    for check, seed in itertools.product(checks[slip["task"]], seeds):
        for args in check.cases(np.random.default_rng(seed)):
            one, other = (run(each, copy.deepcopy(args), 5.0).got for each in (right, wrong))
            counts[alike(one, other)] += 1
    return counts[True], counts.total()


def alike(one, other):
    """Tell whether two results are the same, up to rounding."""
    if isinstance(one, (tuple, list)) and isinstance(other, (tuple, list)):
        return len(one) == len(other) and all(map(alike, one, other))
    if isinstance(one, Raised) or isinstance(other, Raised):
        return getattr(one, "kind", one) == getattr(other, "kind", other)
    try:
        return bool(np.allclose(one, other, rtol=1e-9, atol=1e-12, equal_nan=True))
    except (TypeError, ValueError):
        return one == other


def fresh_ones(seed, *flags):
    """Print how many fresh slips of each task are named, and what those are that pass."""
    of, counts = checks(), Counter()
    for slip in fresh(seed, FRESH_EACH):
        if "afar" in flags and len(of[slip["task"]]) == 1:
            continue  # a lesson's task
        word, says = verdict(slip, of, unread="unread" in flags, far="afar" in flags)
        if word == "right":
            same, inputs = same_on(slip, of)
            word = "equivalent" if same == inputs else "passes"
            says = f"the same as the right answer on {same} of {inputs} inputs"
        counts[word] += 1
        if word != "named":
            print(f"{word}: {slip['name']}: {slip['before']} -> {slip['after']}\n    {says}", flush=True)
    asked = counts.total() - counts["equivalent"]
    print(f"{counts.total()} fresh slips, seed {seed}: {dict(counts)}")
    print(f"{counts['named']} of {asked} named ({counts['named'] / asked:.0%}) without the equivalent ones")


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
    (fresh_ones if sys.argv[1:2] == ["fresh"] else main)(*sys.argv[1 + (sys.argv[1:2] == ["fresh"]) :])
