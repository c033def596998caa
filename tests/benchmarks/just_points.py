"""Just points: what right and wrong answers get when the hidden cases are drawn anew, with seed after seed.

A right answer has all points with every seed; a wrong one loses the same parts with every seed, those that are listed
beside it in ``tests/answers``. The cases of a seed are drawn once, and every answer is marked with them.

    python -m tests.benchmarks.just_points [seeds] [task ...]
"""

import copy
import functools
import sys
import time
from collections import Counter
from dataclasses import replace

import numpy as np

from tests.test_assignments import ANSWERS, TASKS, lost_parts, visible_points

FIRST_SEED = 1000  # far from those that anything was tried with


def drawn(check, seed):
    """Return a check with the cases of a seed, drawn and answered once; without its faults, which cost no points."""
    cases = list(check.cases(np.random.default_rng(seed)))
    expected = [check.reference(*copy.deepcopy(args)) for args in cases]
    turn = iter(expected)

    def again(_rng):
        nonlocal turn
        turn = iter(expected)
        return iter(cases)

    reference = functools.wraps(check.reference)(lambda *_args: next(turn))
    return replace(check, cases=again, reference=reference, faults=())


def with_seed(task, seed):
    """Return a task whose hidden cases are those of a seed."""
    return type(task)(task.name, [replace(part, check=drawn(part.check, seed)) for part in task.parts])


def answers_of(name):
    """Return (kind, name, function, parts that it must lose) for each answer to a task."""
    listed = ANSWERS[name]
    right = [("right", each, function, "") for each, function in listed["right"].items()]
    return right + [("wrong", each, function, loses) for each, (function, loses, _) in listed["wrong"].items()]


def surprises(name, seeds):
    """Return how often each answer to a task lost what, where it is not what is listed: {(kind, name): Counter}."""
    found = {}
    visible = {each: visible_points(name, function) > 0 for _, each, function, _ in answers_of(name)}
    for seed in seeds:
        task = with_seed(TASKS[name], seed)
        for kind, each, function, loses in answers_of(name):
            lost = lost_parts(task.marked(function), visible[each])
            if lost != loses:
                found.setdefault((kind, each), Counter())[lost] += 1
    return found


def main(count="100", *names):
    """Print a line for each task, and one for each answer that was a surprise."""
    seeds, bad = range(FIRST_SEED, FIRST_SEED + int(count)), 0
    for name in names or TASKS:
        began = time.process_time()
        found = surprises(name, seeds)
        kinds = Counter(kind for kind, *_ in answers_of(name))
        print(
            f"{name}: {kinds['right']} right and {kinds['wrong']} wrong answers, {count} seeds, "
            f"{len(found)} not as listed ({time.process_time() - began:.0f} s)",
            flush=True,
        )
        for (kind, each), lost in found.items():
            bad += 1
            print(f"    {kind}, {each}: lost {dict(lost)}", flush=True)
    return bad > 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
