"""Grade: every submission of a problem set on its own, unattended, several at once.

nbgrader's ``autograde`` and ``generate_feedback`` run once for each student, in a process of its own with a time limit,
so that nothing that one submission does can cost another one; as many at once as the computer has cores, and memory for
their limits. What was graded already and has not changed since is passed over, so a run that was stopped goes on.

In:  ``submitted/<student>/<problem set>/``.
Out: the gradebook, ``autograded/`` and ``feedback/``, each as soon as it is done; ``reports/<problem set>/graded.json``
     with all that went wrong, and a log for each student.
"""

from __future__ import annotations

import os
import sqlite3
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import closing, contextmanager

import psutil

from ..table import count
from .course import FEEDBACK_STEPS, LATE_STEP, SANITIZE_STEPS, Course
from .graded import Graded, Journal
from .handed_in import Fault, file_faults, misplaced, strangers, tree_hash
from .handing_back import finish_feedback, unmarked_answers
from .late import NBGRADER_TIME, Late
from .notebooks import read_notebook
from .running import OUT_OF_TIME, nbgrader

SUBMISSION_SECONDS = 1800.0  # for one submission: far more than its cells' own limits come to
SUBMISSION_BYTES = 4 * 2**30  # of memory for one submission, as in a new course's settings


def grade(
    course: Course,
    name: str,
    *,
    again: bool = False,
    only: Sequence[str] = (),
    at_once: int = 0,
    say: Callable[[str], None],
) -> list[Fault]:
    """Grade all submissions of a problem set, and return what went wrong, one fault for each thing.

    Raises ValueError if nothing was handed in or released, or another command grades.

    Parameters
    ----------
    course, name : Course, str
        The course, and a problem set of it that was released: the gradebook knows it from there.
    again : bool
        Whether to grade submissions again that have not changed.
    only : sequence of str
        These students alone; everybody when empty.
    at_once : int
        How many at the same time; 0 for what this computer has cores and memory for.
    say : callable
        Is called with a line for each student, and with those of the summary.
    """
    students = _students_to_grade(course, name, only)
    most = at_once or max(1, min(os.cpu_count() or 1, psutil.virtual_memory().total // SUBMISSION_BYTES))
    with _alone(course, name):
        say(f"nbgrader runs {count(len(students), 'submission')}, {most} at once, each for some seconds")
        folders = [course.root / "submitted" / student / name for student in course.submitted(name)]
        before, start = tree_hash(*folders), time.monotonic()
        journal, counts = Journal(course, name), Counter[str]()
        if (due := Late.of(course.root).due.get(name)) is not None:  # from there nbgrader counts how late each is
            nbgrader(course, "db", "assignment", "add", name, f"--duedate={due.strftime(NBGRADER_TIME)}")
        with ThreadPoolExecutor(most) as pool:
            running = [pool.submit(_grade_one, course, name, student, journal, again) for student in students]
            try:
                for number, done in enumerate(as_completed(running), 1):
                    graded = done.result()
                    journal.write(graded)
                    counts[graded.verdict] += 1
                    say(f"{number:4d} of {len(students)}  {graded.student}: {graded.line}")
            except BaseException:
                pool.shutdown(wait=False, cancel_futures=True)
                raise
        told = ", ".join(f"{counts[words]} {words}" for words in ("graded", "unchanged", "not graded") if counts[words])
        say(f"{count(len(students), 'submission')} in {time.monotonic() - start:.0f} s: {told}")
        same = tree_hash(*folders) == before
        say(f"submitted/ is {'as it was' if same else 'CHANGED: the journal tells whose run it was'}")
    if number := sum(map(len, unmarked_answers(course, name).values())):
        answers = "answer waits" if number == 1 else "answers wait"
        say(
            f"{number} written {answers} to be marked by hand: in formgrader, a page of `jupyter lab`; then "
            f"`primkit teach hand-back {name}`"
        )
    return [*misplaced(course), *strangers(course, name), *journal.faults()]


@contextmanager
def _alone(course: Course, name: str) -> Iterator[None]:
    """Hold a lock that ends with its process; a ValueError says that another one has it."""
    folder = course.root / ".primkit"
    folder.mkdir(exist_ok=True)
    with closing(sqlite3.connect(folder / f"{name}.lock", timeout=0, isolation_level=None)) as lock:
        try:
            lock.execute("begin exclusive")
        except sqlite3.OperationalError:
            raise ValueError(f"{name} is being graded by another command: wait until that has ended") from None
        yield


def _students_to_grade(course: Course, name: str, only: Sequence[str]) -> list[str]:
    """Return who is graded, or say in one sentence why nobody can be."""
    everybody = course.submitted(name)
    if unknown := sorted(set(only) - set(everybody)):
        raise ValueError(f"nothing was handed in for {name} by {', '.join(unknown)}")
    if not everybody:
        told = "; ".join(f"{fault.cell} {fault.says}" for fault in misplaced(course)[:1])
        told = told or f"run `primkit teach collect {name} DOWNLOAD` first, in {course.root}"
        raise ValueError(f"nothing was handed in: {told}")
    if not (course.root / "release" / name).is_dir():
        raise ValueError(f"{name} was not released: run `primkit teach release {name}` first, for nbgrader needs it")
    return list(only) or everybody


def _grade_one(course: Course, name: str, student: str, journal: Journal, again: bool) -> Graded:
    """Grade one submission, and write its feedback."""
    hashed, start = "", time.monotonic()
    try:
        hashed = _hash(course, name, student)
        if not again and journal.knows(student, hashed):
            return Graded(student, "unchanged", "graded before, and not changed since")
        faults = file_faults(course, name, student) or list(_run(course, name, student))
        graded = not faults
        for notebook in course.notebooks(name) if graded else ():  # what happened while its cells ran
            ran = read_notebook(course.root / "autograded" / student / name / f"{notebook}.ipynb")
            faults += [Fault(student, **fault) for fault in ran["metadata"].get("primkit", {}).get("faults", ())]
        if _hash(course, name, student) != hashed:
            says = "while it ran, files in submitted/, source/ or grader/ changed"
            faults.append(Fault(student, "-", "changed files", says))
        finish_feedback(course, name, student, () if graded else faults)
    except Exception as error:  # whatever one submission meets, the others are graded
        says = f"{type(error).__name__}: {' '.join(str(error).split())[:200]}"
        graded, faults = False, [Fault(student, "-", "not graded", says)]
    told = "; ".join(f"{fault.cell}: {fault.says}" for fault in faults)
    if not graded:
        return Graded(student, "not graded", told, hashed, faults)
    line = "; ".join(filter(None, [f"graded in {time.monotonic() - start:.0f} s", told]))
    return Graded(student, "graded", line, hashed, faults)


def _hash(course: Course, name: str, student: str) -> str:
    """Return a hash of all that a mark depends on."""
    late = Late.of(course.root)
    due = late.due_for(name, student)
    files = tree_hash(course.root / "submitted" / student / name, course.root / "source" / name, course.root / "grader")
    return f"{files} {due} {late.grace:g} {late.percent:g} {late.days:g}" if due else files


def _run(course: Course, name: str, student: str) -> Iterator[Fault]:
    """Let nbgrader run a submission and make its feedback, once more if it fails; yield a fault if it fails again."""
    whose = (name, f"--student={student}", "--force", f"--CourseDirectory.db_url={course.gradebook}")
    # The steps of today, also in a course that was made without some of them.
    run = ("autograde", *whose, f"--Autograde.sanitize_preprocessors={SANITIZE_STEPS}", f"--{LATE_STEP}")
    tell = ("generate_feedback", *whose, f"--GenerateFeedback.preprocessors={FEEDBACK_STEPS}")
    log = course.reports(name) / "log" / f"{student}.txt"
    for _ in range(2):
        done = nbgrader(course, *run, "&&", *tell, log=log, seconds=SUBMISSION_SECONDS)
        if done.code == 0:
            return
        if done.code == OUT_OF_TIME:
            break
    yield Fault(student, "-", "not graded", f"nbgrader could not grade it: {done.reason}")
