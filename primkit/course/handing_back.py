"""Handing back: feedback as pages that run nothing, and as files that an LMS takes back under its own names.

In:  the gradebook, the journal of the grading, ``feedback/`` as nbgrader makes it, and ``collected/``.
Out: the head of each page names its tests, calls answers that nobody has marked yet so, and holds the teacher's
     comments on the kinds of answers; a submission that could not be graded gets a page that says why. In
     ``handed_back/<problem set>/`` a table of grades and a zip of pages, for Moodle and for Canvas, of those whose work
     came from there.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Callable, Iterable, Sequence
from html import escape

from ..formats.files import write_atomically
from ..table import count
from .course import FEEDBACK_STEPS, Course
from .graded import Journal
from .handed_in import Fault
from .lms import Back, canvas_files, moodle_files
from .overview import comments_of, overview
from .running import nbgrader
from .versions import versions_of

# Whatever sanitizing leaves: a browser runs and fetches nothing on such a page.
NO_SCRIPTS = (
    '<meta http-equiv="Content-Security-Policy" '
    "content=\"default-src 'none'; img-src data:; style-src 'unsafe-inline'; font-src data:\">"
)
OTHER_LINK = r'href="(?!https?:|mailto:|#)[^"]*"'  # javascript: among them, which markdown makes a link
HEADING = r"<h4>[^<]*\(Score: [^<]*</h4>"  # of a page that nbgrader has made
PAGE = """\
<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>{0}: not graded</title></head>
<body style="font-family:sans-serif;max-width:40em;margin:2em auto;line-height:1.5">
<h1>{0}: not graded</h1>
<p>What was handed in could not be graded. {1}</p>
<p>Nothing is lost: mend it, or ask your teacher, and hand it in again.</p>
</body></html>
"""


def hand_back(course: Course, name: str, *, say: Callable[[str], None]) -> None:
    """Make the feedback anew, with marks and comments as they are now, and the files for an LMS.

    Raises ValueError if nothing has been graded yet.
    """
    seen, comments = overview(course, name), comments_of(course, name)
    told: dict[str, list[tuple[str, str]]] = defaultdict(list)  # student -> tasks and comments
    for kind in seen.kinds():
        for student in kind.students if comments.get(kind.code) else ():
            told[student].append((kind.task, comments[kind.code]))
    made = nbgrader(course, "generate_feedback", name, "--force", f"--GenerateFeedback.preprocessors={FEEDBACK_STEPS}")
    if made.code != 0:
        raise ValueError(f"nbgrader could not make the feedback on {name}: {made.reason}")
    journal = Journal(course, name)
    for student, entry in journal.entries.items():
        faults = [] if entry["graded"] else [Fault(**fault) for fault in entry["faults"]]
        finish_feedback(course, name, student, faults, told[student])
    say(f"feedback/ is ready: {count(len(journal.entries), 'student')}, comments for {sum(map(bool, told.values()))}")
    names = {student.id: student.name for student in course.roster()}
    backs: dict[str, list[Back]] = defaultdict(list)
    for student, versions in sorted(versions_of(course, name).items()):
        pages = {page.name: page.read_bytes() for page in (course.root / "feedback" / student / name).glob("*.html")}
        comment = " ".join(f"{task}: {comment}" for task, comment in told[student])
        sender = versions[-1].sender
        if student in journal.entries and sender.get("lms"):
            back = Back(names.get(student, student), sender, seen.scores.get(student), comment, pages)
            backs[sender["lms"]].append(back)
    folder = course.root / "handed_back" / name
    folder.mkdir(parents=True, exist_ok=True)
    files = {
        **(moodle_files(backs["moodle"], seen.of) if backs["moodle"] else {}),
        **(canvas_files(backs["canvas"], seen.of, name) if backs["canvas"] else {}),
    }
    for file, content in files.items():
        write_atomically(folder / file, content)
    if files:
        say(f"{', '.join(sorted(files))} in {folder}")
    else:
        say("what was graded came from no LMS: hand the pages back as you got the work")


def unmarked_answers(course: Course, name: str, student: str = "") -> dict[str, list[str]]:
    """Return the answers that a person has still to mark, of one or of all: student -> names of cells."""
    from nbgrader.api import Gradebook, MissingEntry

    found: dict[str, list[str]] = defaultdict(list)
    if not (course.root / "gradebook.db").is_file():
        return found
    with Gradebook(course.gradebook) as book:
        try:
            submissions = [book.find_submission(name, student)] if student else book.assignment_submissions(name)
        except MissingEntry:
            return found
        for submission in submissions:
            for grade in (grade for notebook in submission.notebooks for grade in notebook.grades):
                if grade.needs_manual_grade:
                    found[submission.student.id].append(grade.cell.name)
    return found


def finish_feedback(
    course: Course, name: str, student: str, faults: Sequence[Fault], comments: Sequence[tuple[str, str]] = ()
) -> None:
    """Complete the feedback for a student; with faults, it is a page that says why there is nothing else."""
    open_cells = [] if faults else unmarked_answers(course, name, student)[student]
    for notebook in course.notebooks(name):
        page = course.root / "feedback" / student / name / f"{notebook}.html"
        if faults:
            page.parent.mkdir(parents=True, exist_ok=True)
            html = PAGE.format(escape(notebook), escape(" ".join(map(_as_sentence, faults))))
        elif page.is_file():
            html = page.read_text(encoding="utf-8").replace("<head>", f"<head>\n{NO_SCRIPTS}", 1)
            html = re.sub(r'(<a href="#([\w.-]+)">)Test cell</a>', r"\1\2</a>", html)  # in the page's head
            html = re.sub(OTHER_LINK, 'href="#"', html)
            if open_cells:
                html = _say_unmarked(html, open_cells)
            if said := "".join(f"<p><b>{escape(task)}</b>: {escape(comment)}</p>" for task, comment in comments):
                html = re.sub(HEADING, lambda heading: f"{heading[0]}{said}", html, count=1)
        else:
            continue
        write_atomically(page, html)


def _as_sentence(fault: Fault) -> str:
    """Return a fault as a sentence for the student: with the file's name, where it does not say it itself."""
    if fault.cell == "-" or fault.cell in fault.says:
        return f"{fault.says[:1].upper()}{fault.says[1:]}."
    return f"{fault.cell} {fault.says}."


def _say_unmarked(html: str, cells: Iterable[str]) -> str:
    """Say of answers that they are not yet marked, at the head of a page and beside their points.

    >>> _say_unmarked('<a href="#trust">Written response</a> (Score: 0.0 / 4.0)', ["trust"])
    '<a href="#trust">Written response</a> (not yet marked, of 4.0)'
    """
    for cell in cells:
        link = rf'(<a href="#{re.escape(cell)}">[^<]*</a>) \(Score: [\d.]+ / ([\d.]+)\)'
        html = re.sub(link, r"\1 (not yet marked, of \2)", html)
        place = rf'(<a name="{re.escape(cell)}"></a>.{{0,300}}?)Score: [\d.]+ / ([\d.]+)'
        html = re.sub(place, r"\1Not yet marked, of \2", html, flags=re.DOTALL)
    told = f"Not yet marked: {', '.join(cells)}. The score does not count that yet."
    return re.sub(HEADING, rf"\g<0><p><b>{escape(told)}</b></p>", html, count=1)
