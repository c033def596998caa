"""Teach: ``primkit teach``, a course from its folder to its grades.

In:  one of its own commands, and its options.
Out: what came out, line by line; files in the course folder. ``teaching`` does the work, and nbgrader most of that.
"""

from __future__ import annotations

import argparse
import os
from functools import partial
from pathlib import Path
from typing import Any

from ..table import Table, count
from .words import LOOK, Parser, path, say, tell_faults, whole

TEACH_TEXT = "run a course: release problem sets, grade them, see how the class did"
TEACH_EXAMPLES = """\
examples:
  primkit teach new-course robotics      a course folder, with all problem sets
  cd robotics
  primkit teach check                    is all there, and how is it mended?
  primkit teach release ps1              release/ps1: for your students
  primkit teach collect ps1 DOWNLOAD.zip from Moodle, Canvas, e-mail, ...
  primkit teach grade ps1                what lies in submitted/<student>/ps1
  primkit teach report ps1               how the class did, and nbgrader's export

The course folder is nbgrader's own: all its commands work in it as well, and
so does its page, formgrader, in Jupyter Lab.
"""

TEACH_GRADE_TEXT = """\
what grading runs, and what it can reach:
  Grading runs the code that students hand in. It runs in a process of its own;
  tests, truth, points and gradebook never are in that process: they stay with
  the judge, which calls the student's functions from outside and compares what
  comes back. So no code can make its own tests pass.
  Where bubblewrap is installed (Linux), that process stands behind walls: it
  sees Python, the library and a scratch copy of the submission, read only but
  for the copy; no other file, no network, no other process; and what it leaves
  behind ends with it. `primkit teach check` says whether the walls stand.
  Where they do not, every report says "unprotected": the code then runs as
  you, and can open and delete your files. For people whom you do not know,
  grade in a container without a network then, and say so by the variable:
    docker run --rm --network none --memory 6g -v "$PWD":/course -w /course \\
      -e PRIMKIT_CONFINED_BY="a container" IMAGE primkit teach grade ps1
  (IMAGE: one with the project installed; mount a copy of the course.) On Linux
  the process is refused more memory than its limit; on Windows and macOS it is
  ended about a second after it has taken more.
"""


def teach_options(parser: Parser) -> None:
    """Add the commands of ``primkit teach``."""
    parser.set_defaults(run=lambda _: parser.print_help())
    commands = parser.add_subparsers(title="commands", metavar="COMMAND")

    def command(name: str, run: Any, text: str, epilog: str = "", *, ps: bool = False, here: bool = True) -> Any:
        description = f"{text[0].upper()}{text[1:]}."
        made = commands.add_parser(name, help=text, description=description, epilog=epilog, **LOOK)
        made.set_defaults(run=run)
        if ps:
            made.add_argument("name", metavar="PS", help="the problem set, a folder in source/")
        if here:
            made.option("--course", "DIR", path, Path(), "the course folder", shown="the folder you are in")
        return made

    new = command("new-course", _new_course, "make a course folder for nbgrader", here=False)
    new.add_argument("folder", metavar="DIR", type=path, help="a new folder, or an empty one")
    new.option(
        "--assignments",
        "DIR",
        path,
        None,
        "where source/ and grader/ lie, or an archive of them",
        shown="those of the project",
    )
    command("check", _check, "look whether all is there, and say how each fault is mended")
    command("release", _release, "make the students' version, and their personal maps", ps=True)
    collect = command("collect", _collect, "place what was handed in, from the downloads of an LMS", ps=True)
    collect.add_argument("paths", metavar="FILE", nargs="+", type=path, help="zips, folders, notebooks, e-mails")
    grade = command("grade", _grade, "grade what was handed in, each submission on its own", TEACH_GRADE_TEXT, ps=True)
    grade.add_argument("--again", action="store_true", help="grade also what has not changed since")
    grade.add_argument("--student", metavar="ID", action="append", default=[], help="only this one; may be repeated")
    grade.option("--at-once", "N", partial(whole, least=1, most=64), 0, "how many at once", shown="cores, and memory")
    command("report", _report, "say how the class did; write tables, a figure and nbgrader's export", ps=True)
    command("hand-back", _hand_back, "make feedback with your comments, and files for Moodle and Canvas", ps=True)
    command("similar", _similar, "find pairs of submissions that are more alike than the task makes them", ps=True)
    command("print", _print, "print a handout and a booklet of solutions, as PDF", ps=True)
    leaks = command("leaks", _leaks, "look for solutions in what students get")
    leaks.add_argument(
        "paths", metavar="PATH", nargs="*", type=path, help="notebooks, wheels, folders (default: release)"
    )


def teach(_arguments: argparse.Namespace) -> None:
    """Stand for the commands below: each of them takes this one's place."""


def _course(arguments: argparse.Namespace) -> Any:
    from ..course.course import Course

    return Course(arguments.course or Path()).checked()


def _new_course(arguments: argparse.Namespace) -> None:
    from ..course.course import ASSIGNMENTS, new_course

    course = new_course(arguments.folder, arguments.assignments or ASSIGNMENTS)
    say(f"Made   {course.root}: problem sets {', '.join(course.sets())}")
    say("Keep   salt.txt: a secret that the personal maps are made from; source/ and grader/: they hold the solutions")
    say(f"Next   fill in {Path(arguments.folder, 'students.csv')}, go into the folder, and run primkit teach check")


def _check(arguments: argparse.Namespace) -> None:
    from ..course.checking import check
    from ..course.course import Course

    tell_faults(check(Course(arguments.course or Path())))


def _release(arguments: argparse.Namespace) -> None:
    from ..course.releasing import release

    course = _course(arguments)
    release(course, course.set(arguments.name), say=say)


def _collect(arguments: argparse.Namespace) -> None:
    from ..course.collect import collect, table_of

    course = _course(arguments)
    name = course.set(arguments.name)
    collected, unplaced = collect(course, name, arguments.paths)
    rows = table_of(course, name, collected)
    say(str(Table(("who", "what", "when", "to be known"), rows, f"{name}: {count(len(collected), 'student')}")))
    if unplaced:
        say(f"\n{count(len(unplaced), 'file')} without a place:")
        for file in unplaced:
            say(f"  {file.place}  {file.says}")
    say(f"Next   primkit teach grade {name}")


def _grade(arguments: argparse.Namespace) -> None:
    from ..course.grade import grade

    course = _course(arguments)
    name = course.set(arguments.name)
    faults = grade(course, name, again=arguments.again, only=arguments.student, at_once=arguments.at_once or 0, say=say)
    if faults:
        say(f"\n{count(len(faults), 'thing')} to look at:")
        for fault in faults:
            say(f"  {fault.student}  {fault.cell}  {fault.name}: {fault.says}")
    say(f"Next   primkit teach report {name}")


def _report(arguments: argparse.Namespace) -> None:
    from ..course.reporting import report

    course = _course(arguments)
    for line in report(course, course.set(arguments.name)):
        say(line)


def _hand_back(arguments: argparse.Namespace) -> None:
    from ..course.handing_back import hand_back

    course = _course(arguments)
    hand_back(course, course.set(arguments.name), say=say)


def _similar(arguments: argparse.Namespace) -> None:
    from ..course.similar import report_pairs

    course = _course(arguments)
    for line in report_pairs(course, course.set(arguments.name)):
        say(line)


def _print(arguments: argparse.Namespace) -> None:
    from ..course.printing import print_set

    course = _course(arguments)
    for written in print_set(course, course.set(arguments.name)):
        say(f"Wrote  {written}")


def _leaks(arguments: argparse.Namespace) -> None:
    from ..course.course import ASSIGNMENTS, Course
    from ..course.leaks import find_leaks, secrets_of

    folder = Course(arguments.course or Path()).root
    if not (folder / "source").is_dir() and arguments.paths:
        folder = ASSIGNMENTS  # of the project: to look through a wheel without a course
    secrets = secrets_of(folder)
    if not secrets.solutions:
        raise ValueError(f"there are no solutions in {folder} to look for: run it in the course folder")
    paths = arguments.paths or [folder / "release"]
    found = find_leaks(paths, secrets)
    for leak in found:
        say(f"LEAK  {leak}")
    if found:
        raise SystemExit(1)
    say(f"No solution in {', '.join(os.fspath(each) for each in paths)}: looked for {len(secrets.solutions)} of them")
