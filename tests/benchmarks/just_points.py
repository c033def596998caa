"""Just points: what right and wrong answers get when the hidden cases are drawn anew, with seed after seed.

A right answer has all points with every seed; a wrong one loses the same parts with every seed, those that are listed
beside it in ``tests/answers``. The cases of a seed are drawn once; each answer is called here, in this process, and is
judged until its first wrong case. A seed of the last problem set is a student, whose board is drawn.

    python -m tests.benchmarks.just_points [seeds] [task ...]
"""

import copy
import sys
import time
import warnings
from collections import Counter
from contextlib import suppress

import numpy as np

import primkit as pk
from primkit.course.personal import board_of
from tests.test_assignments import ANSWERS, TASKS, visible_points

FIRST_SEED = 1000  # far from those that anything was tried with


def right_in(function, check, cases):
    """Tell whether a function is right in all cases, (arguments, expected) each: what a check asks for its points."""
    for args, expected in cases:
        with suppress(Exception):
            if check.judge(function(*copy.deepcopy(args)), expected, args) is None:
                continue
        return False
    return True


def answers_of(name):
    """Return (kind, name, function, parts that it must lose) for each answer to a task."""
    listed = ANSWERS[name]
    right = [("right", each, function, "") for each, function in listed["right"].items()]
    return right + [("wrong", each, function, loses) for each, (function, loses, _) in listed["wrong"].items()]


def lost_with(seed, name, functions):
    """Return the parts that each function loses, with the cases of a seed."""
    lost = [""] * len(functions)
    with board_of(pk.personal_world(f"student {seed}", salt="a salt for the benchmark")):
        for number, part in enumerate(TASKS[name].parts, 1):
            drawn = list(part.check.cases(np.random.default_rng(seed)))
            cases = [(args, part.check.reference(*copy.deepcopy(args))) for args in drawn]
            for k, function in enumerate(functions):
                lost[k] += "" if right_in(function, part.check, cases) else str(number)
    return lost


def surprises(name, seeds):
    """Return how often each answer to a task lost what, where it is not what is listed: {(kind, name): Counter}."""
    found = {}
    answers = answers_of(name)
    functions = [function for _, _, function, _ in answers]
    visible = ["" if visible_points(name, function) else "v" for function in functions]
    for seed in seeds:
        lost = lost_with(seed, name, functions)
        for (kind, each, _, loses), shown, hidden in zip(answers, visible, lost, strict=True):
            if shown + hidden != loses:
                found.setdefault((kind, each), Counter())[shown + hidden] += 1
    return found


def main(count="100", *names):
    """Print a line for each task, and one for each answer that was a surprise."""
    seeds, bad = range(FIRST_SEED, FIRST_SEED + int(count)), 0
    warnings.simplefilter("ignore")
    np.seterr(all="ignore")
    for name in names or TASKS:
        began = time.process_time()
        found = surprises(name, seeds)
        kinds = Counter(kind for kind, *_ in answers_of(name))
        print(
            f"{name}: {kinds['right']} right and {kinds['wrong']} wrong answers, {count} seeds, {len(found)} not as "
            f"listed ({(time.process_time() - began) / len(seeds):.2f} s of processor time a seed)",
            flush=True,
        )
        for (kind, each), lost in found.items():
            bad += 1
            print(f"    {kind}, {each}: lost {dict(lost)}", flush=True)
    return bad > 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
