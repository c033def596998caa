"""Mutants: the estimator with one thing changed, against the tests that should notice.

    python -m tests.benchmarks.robust_mutants [NUMBER ...]

Each mutant replaces one piece of text in a copy of the package; the tests that fit it run on the copy, and must fail. A
piece that does not stand in its file exactly once is an error: the list follows the code. What survives is a test that
is missing, or it is equivalent, and then the list says why.
"""

import os
import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
LONGEST = 1800  # s for the tests of one mutant; what takes longer than that is noticed


@dataclass(frozen=True)
class Mutant:
    """A piece of text in a file below ``primkit``, what takes its place, and the tests that should notice.

    ``equivalent`` gives the reason why none can, where that is so.
    """

    what: str
    file: str
    old: str
    new: str
    tests: tuple[str, ...]
    equivalent: str = ""


DEVIATIONS, EVIDENCE, REGROUP = ("test_deviations.py",), ("test_evidence.py",), ("test_regroup.py", "test_account.py")
FIT, CHOICE = ("test_unknown.py",), ("test_regroup.py", "test_measure.py", "test_unknown.py", "test_account.py")
REFINE, CUTS = ("test_refine.py", "test_candidates.py"), ("test_candidates.py", "test_account.py")
MUTANTS = (
    # --- deviations ---
    Mutant(
        "the cells' part of each number's variance",
        "robust/covariance.py",
        " + aw @ aw.T + maybe",
        " + maybe",
        DEVIATIONS,
    ),
    Mutant(
        "cells' errors even out where all cells are hit",
        "robust/covariance.py",
        "max(alone, of_cells) - EVEN_OUT * min(n / crossed, 1.0) * still * of_cells",
        "max(alone, of_cells)",
        DEVIATIONS,
    ),
    Mutant(
        "what all points of a scan err alike",
        "robust/covariance.py",
        " + shared * ua.T @ ua",
        "",
        DEVIATIONS,
    ),
    Mutant(
        "how much of a circle must be seen",
        "robust/deviations.py",
        "LEAST_OF_CIRCLE = 0.45",
        "LEAST_OF_CIRCLE = 0.3",
        DEVIATIONS,
    ),
    Mutant(
        "a side whose middle may be another's has no points of its own",
        "robust/deviations.py",
        "own &= own_points(figure, np.mean(figure.ends(), axis=0)[0], spread).diagonal()",
        "",
        DEVIATIONS,
    ),
    # --- regroup ---
    Mutant(
        "what lies inside an open outline may be of its notch",
        "robust/regroup.py",
        "if gain < 0 and 2 *",
        "if False and 2 *",
        REGROUP,
    ),
    Mutant(
        "the strays' cost of a group",
        "robust/regroup.py",
        " - 2 * strays * float(np.log(NOWHERE))",
        "",
        REGROUP,
    ),
    Mutant(
        "a half is certain only beside a certain half",
        "robust/regroup.py",
        "others.append(0.0)",
        "pass",
        REGROUP,
    ),
    Mutant(
        "two closed outlines are no one",
        "robust/regroup.py",
        "(a.closed and b.closed) or ",
        "",
        REGROUP,
        "it spares work: the sides that two whole outlines turn to each other lie inside the hull of both, asked next",
    ),
    # --- evidence ---
    Mutant(
        "what was not seen of an outline",
        "robust/evidence.py",
        "UNSEEN_COST * float(lengths.sum() - length) + ",
        "",
        EVIDENCE,
    ),
    Mutant(
        "clusters are seen equally densely",
        "robust/evidence.py",
        "return sum(c.cost for c in candidates) + together",
        "return sum(c.cost for c in candidates)",
        EVIDENCE + REGROUP,
    ),
    Mutant(
        "the price of a shape without a name",
        "robust/evidence.py",
        "0.0 if named else NAMELESS_COST if",
        "0.0 if named else 0.0 if",
        EVIDENCE + CHOICE,
    ),
    Mutant(
        "the back of a wall was not seen",
        "robust/evidence.py",
        "cost + UNSEEN_COST * length, length, n_on",
        "cost, length, n_on",
        EVIDENCE + CHOICE,
    ),
    # --- scatter ---
    Mutant(
        "the mixture's deviation over its median",
        "robust/scatter.py",
        "STD_OF_MEDIAN = 1.651",
        "STD_OF_MEDIAN = 1.4826",
        ("test_scatter.py",),
    ),
    Mutant(
        "two numbers fix a line",
        "robust/scatter.py",
        "(NEIGHBOURS - 2)",
        "NEIGHBOURS",
        ("test_scatter.py", "test_measure.py"),
    ),
    Mutant("what lies on both halves is of either", "robust/regroup.py", "if on_both.any()", "if False", REGROUP),
    Mutant(
        "no half reaches into the other",
        "robust/regroup.py",
        "return cost_of(parts) + INSIDE_COST * min(amiss, MOST_INSIDE)",
        "return cost_of(parts)",
        REGROUP,
    ),
    # --- choice ---
    Mutant("no point deep inside", "robust/choice.py", "and not self.inside.any()", "", CHOICE),
    Mutant("nearly all points lie on it", "robust/choice.py", "and self.on_it.mean() >= NEARLY_ALL", "", CHOICE),
    Mutant("nearly all of it was seen", "robust/choice.py", "min(best.seen) >= MOST_SEEN", "True", CHOICE),
    Mutant("an arc, where all can be", "robust/choice.py", 'and "polygon" not in self.kinds', "", CHOICE),
    Mutant("a side has its own points", "robust/deviations.py", "=0) < LEAST_OF_SIDE", "=0) < 0", CHOICE),
    Mutant("so large that its kind can show", "robust/choice.py", "and large >= LEAST_SIDE", "", CHOICE),
    # --- lack of fit ---
    Mutant(
        "points near a corner may be of either side",
        "robust/lack_of_fit.py",
        "second > CORNER_BAND_SPREADS * spread",
        "second >= 0",
        FIT,
    ),
    Mutant(
        "two neighbours beside an outline are a corner of another",
        "robust/choice.py",
        "and not lacks_corner(self.points, figure, self.spread)",
        "",
        CHOICE,
    ),
    Mutant(
        "what bends everywhere has no corners",
        "robust/lack_of_fit.py",
        "min(stiff, sharpness(points, figure, spread))",
        "stiff",
        FIT,
    ),
    Mutant(
        "what cells do to a whole block alike",
        "robust/lack_of_fit.py",
        " + n**2 * shared_rounding(spread) * CELL_STD**2",
        "",
        FIT,
    ),
    # --- refine ---
    Mutant(
        "how much each point tells about a side",
        "robust/refine.py",
        "share * told, steps[-1]",
        "share, steps[-1]",
        REFINE,
    ),
    Mutant(
        "an outline that stops being sound is given up",
        "robust/refine.py",
        "if not sound(steps[-1]).all():",
        "if False:",
        REFINE,
    ),
    # --- candidates and cuts ---
    Mutant(
        "strays are left out of the first fit",
        "robust/candidates.py",
        "points = points[on_it if near.all() else near]",
        "return",
        CUTS,
    ),
    Mutant(
        "an arc looks longer by what is near its ends",
        "robust/candidates.py",
        "(found.length - ends) / circle.radius",
        "found.length / circle.radius",
        (*CUTS, "test_circles.py"),
    ),
    Mutant(
        "the first cut behind the widest gap",
        "robust/cuts.py",
        "if gap.max() > unseen:",
        "if False:",
        ("test_candidates.py",),
    ),
    # --- free ---
    Mutant(
        "sides that are not worth their price are left out",
        "robust/free.py",
        "while outline.angles.shape[1] > 3:",
        "while False:",
        ("test_unknown.py",),
    ),
    Mutant(
        "two shapes side by side may look like one",
        "robust/outlines.py",
        " or (all(names) and not t)",
        "",
        ("test_outlines.py",),
    ),
    Mutant(
        "an outline crosses itself nowhere",
        "robust/outlines.py",
        "closed &= shapely",
        "closed | shapely",
        ("test_outlines.py",),
    ),
)


def copy_to(folder):
    """Copy what the tests need."""
    for name in ("primkit", "tests", "data"):
        shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(ROOT / "pyproject.toml", folder)


def failing(folder, tests):
    """Return the first of the tests that fails on the package in this folder; nothing where all pass."""
    command = [sys.executable, "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider"]
    command += [f"tests/{name}" for name in tests]
    env = os.environ | {"PYTHONPATH": str(folder), "PYTHONDONTWRITEBYTECODE": "1"}
    try:
        done = subprocess.run(command, cwd=folder, env=env, capture_output=True, text=True, timeout=LONGEST)
    except subprocess.TimeoutExpired:
        return f"no answer in {LONGEST} s"
    if done.returncode not in (0, 1):
        raise RuntimeError(done.stdout + done.stderr)
    lines = [line for line in done.stdout.splitlines() if line.startswith(("FAILED", "ERROR"))]
    return lines[0] if done.returncode else ""


def outcome(mutant, folder):
    """Return what became of a mutant: caught, and by which test; survived; or equivalent, with the reason."""
    path = folder / "primkit" / mutant.file
    text = path.read_text(encoding="utf-8")
    if text.count(mutant.old) != 1:
        raise ValueError(f"{mutant.file} must hold this exactly once, got {text.count(mutant.old)}: {mutant.old!r}")
    path.write_text(text.replace(mutant.old, mutant.new), encoding="utf-8")
    try:
        if test := failing(folder, mutant.tests):
            return f"caught, {test.partition(' - ')[0]}"
        return f"equivalent: {mutant.equivalent}" if mutant.equivalent else "SURVIVED"
    finally:
        path.write_text(text, encoding="utf-8")


def main(numbers):
    """Print what becomes of each mutant; tell whether none survives."""
    survived = 0
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        copy_to(folder)
        chosen = [(number, MUTANTS[number]) for number in numbers or range(len(MUTANTS))]
        if test := failing(folder, sorted({test for _, mutant in chosen for test in mutant.tests})):
            raise ValueError(f"the tests must pass before anything is changed, got {test}")
        for number, mutant in chosen:
            said = outcome(mutant, folder)
            survived += said == "SURVIVED"
            print(f"{number:2} {mutant.file:26} {mutant.what}: {said}", flush=True)
    print(f"{survived} survived of {len(chosen)}")
    return not survived


if __name__ == "__main__":
    sys.exit(not main([int(word) for word in sys.argv[1:]]))
