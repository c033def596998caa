"""Course: a folder in which nbgrader runs the problem sets, and what lies where in it.

In:  an empty folder, and the project's ``notebooks/assignments``.
Out: a ``Course``: ``source/`` and ``grader/`` (with solutions: for the teacher alone), ``nbgrader_config.py``, the list
     of students, and the salt of the personal maps.

What nbgrader and ``primkit teach`` make in it: ``release/`` (for the students), ``personal/`` (one folder for each of
them), ``collected/`` and ``submitted/``, ``autograded/``, ``feedback/``, ``handed_back/``, ``paper/``, ``gradebook.db``
and ``reports/``.
"""

from __future__ import annotations

import secrets
import shutil
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from .personal import SALT_LETTERS
from .students import STUDENT_COLUMNS, Student, read_students

# Where the assignments lie in a clone of the project; a wheel holds none.
ASSIGNMENTS = Path(__file__).resolve().parents[2] / "notebooks" / "assignments"
ARCHIVE_COMMAND = "git archive --format=zip -o teachers.zip HEAD notebooks/assignments notebooks/teacher"
COPIED_FOLDERS = ("source", "grader")  # solutions and hidden tests: neither is ever released
SCANS = "my_scans.npz"  # a problem set that has this file is about a personal map
GRADEBOOK_SECONDS = 300  # that one waits for the gradebook
SALT = "salt.txt"
STUDENTS = "students.csv"

# How a submission is put in order: nbgrader's own steps, and ours between them.
SANITIZE_STEPS = [
    "nbgrader.preprocessors.ClearOutput",
    "nbgrader.preprocessors.DeduplicateIds",
    "primkit.course.sanitizing.WholeNotebook",
    "nbgrader.preprocessors.OverwriteKernelspec",
    "nbgrader.preprocessors.OverwriteCells",
    "nbgrader.preprocessors.CheckCellMetadata",
]
FEEDBACK_STEPS = [
    "nbgrader.preprocessors.GetGrades",
    "primkit.course.sanitizing.SafeFeedback",
    "nbconvert.preprocessors.CSSHTMLHeaderPreprocessor",
]
CAREFUL = "primkit.course.executing.CarefulExecute"  # in the place of nbgrader's own way to execute
LATE_STEP = "AssignLatePenalties.plugin_class=primkit.course.late.LateRule"
CONFIG = f'''\
"""nbgrader's settings for this course: read whenever nbgrader runs in this folder."""

from pathlib import Path
from tempfile import TemporaryDirectory

c = get_config()  # noqa: F821 - nbgrader's own
course = str(Path(__file__).resolve().parent)
c.CourseDirectory.root = course

# Copied cells are the student's own; graded cells and locked code that were deleted are put back.
c.OverwriteCells.add_missing_cells = True
c.Autograde.sanitize_preprocessors = {SANITIZE_STEPS}
c.WholeNotebook.course = course

# Submissions run with primkit's careful way to execute in the place of nbgrader's own.
c.Autograde.autograde_preprocessors = [
    "{CAREFUL}",
    "nbgrader.preprocessors.IgnorePattern",
    "nbgrader.preprocessors.LimitOutput",
    "nbgrader.preprocessors.SaveAutoGrades",
    "nbgrader.preprocessors.AssignLatePenalties",
    "nbgrader.preprocessors.CheckCellMetadata",
]
c.AssignLatePenalties.plugin_class = "primkit.course.late.LateRule"  # its settings stand in course.toml
c.GenerateFeedback.preprocessors = {FEEDBACK_STEPS}
c.CarefulExecute.course = course
c.CarefulExecute.timeout = 60  # seconds for each cell
c.CarefulExecute.seconds = 5  # of processor time for each part of a hidden test
c.CarefulExecute.megabytes = 4096  # of memory for each submission
'''
SETTINGS = "course.toml"
SETTINGS_TEXT = """\
# When each problem set is due; with the zone, as +01:00, or by the clock of the computer that grades.
[due]
# ps1 = 2026-03-01T23:59:00+01:00

# Later for one student: a table for each problem set.
# [later.ps1]
# s002 = 2026-03-08T23:59:00+01:00

# What a late day costs, of the points that were reached, and when nothing counts any more.
[late]
grace_minutes = 15
percent_a_day = 0
days = 7
"""
IGNORED = """\
# Neither secrets nor students' work belong into a repository.
salt.txt
students.csv
gradebook.db*
release/
personal/
collected/
submitted/
autograded/
feedback/
handed_back/
paper/
reports/
.primkit/
"""


@dataclass(frozen=True)
class Course:
    """A course, by its folder."""

    root: Path

    def __init__(self, root: str | Path) -> None:
        object.__setattr__(self, "root", Path(root).resolve())

    def checked(self) -> Course:
        """Return the course itself, or say in one sentence that this is none."""
        if not (self.root / "nbgrader_config.py").is_file() or not (self.root / "source").is_dir():
            raise ValueError(
                f"{self.root} is no course folder: make one with `primkit teach new-course DIR`, and run the others "
                "in it or with --course DIR"
            )
        return self

    def sets(self) -> list[str]:
        """Return the names of the problem sets."""
        folders = (self.root / "source").glob("*")
        return sorted(folder.name for folder in folders if any(folder.glob("*.ipynb")))

    def set(self, name: str) -> str:
        """Return the name of a problem set, or say in one sentence that there is none."""
        known = self.sets()
        if name in known:
            return name
        raise ValueError(f"there is no problem set {name!r}; there are {', '.join(known) or 'none'}")

    def salt(self) -> str:
        """Return the secret behind the personal maps."""
        path = self.root / SALT
        if not path.is_file():
            raise ValueError(
                f"{SALT} is missing in {self.root}: put the old one back, for a new salt makes new maps for everyone"
            )
        salt = path.read_text(encoding="utf-8").strip()
        if len(salt) < SALT_LETTERS:
            raise ValueError(f"{SALT} must hold at least {SALT_LETTERS} characters, got {len(salt)}")
        return salt

    def roster(self) -> list[Student]:
        """Return all students in the list."""
        path = self.root / STUDENTS
        if not path.is_file():
            raise ValueError(
                f"{STUDENTS} is missing in {self.root}: a table with the columns {', '.join(STUDENT_COLUMNS)}"
            )
        return read_students(path)[0]

    def students(self) -> list[str]:
        """Return the ids of all students in the list."""
        return [student.id for student in self.roster()]

    def notebooks(self, name: str) -> list[str]:
        """Return the notebooks' names in a problem set, without their ending."""
        return sorted(path.stem for path in (self.root / "source" / name).glob("*.ipynb"))

    def personal(self, name: str) -> bool:
        """Tell whether a problem set is about a personal map."""
        return (self.root / "source" / name / SCANS).is_file()

    def submitted(self, name: str) -> list[str]:
        """Return who handed in a problem set."""
        return sorted(path.parent.name for path in self.root.glob(f"submitted/*/{name}") if path.is_dir())

    @property
    def gradebook(self) -> str:
        """Where nbgrader's gradebook is, for a program that waits until others have written into it."""
        return f"sqlite:///{(self.root / 'gradebook.db').as_posix()}?timeout={GRADEBOOK_SECONDS}"

    def reports(self, name: str) -> Path:
        """Return the folder of what is said about a problem set; it is made."""
        folder = self.root / "reports" / name
        folder.mkdir(parents=True, exist_ok=True)
        return folder


def new_course(root: str | Path, assignments: str | Path = ASSIGNMENTS) -> Course:
    """Make a course folder.

    Raises ValueError if there is something in the folder, or no assignments are found.

    Parameters
    ----------
    root : str or path
        A folder that does not exist yet, or is empty.
    assignments : str or path
        Where ``source/`` and ``grader/`` lie, or the archive that holds them; in a clone of the project they are found
        by themselves.
    """
    course, assignments = Course(root), Path(assignments)
    if assignments.is_file():
        with TemporaryDirectory() as folder:
            try:
                shutil.unpack_archive(assignments, folder)
            except shutil.ReadError:
                raise ValueError(f"{assignments} must be a folder or an archive, such as a .zip, got neither") from None
            inside = next((path.parent for path in Path(folder).rglob("grader")), None)
            if inside is None:
                raise ValueError(f"{assignments} must hold source/ and grader/, got neither")
            return new_course(root, inside)
    if assignments != ASSIGNMENTS and not assignments.exists():
        raise ValueError(f"{assignments}: there is no such archive or folder")
    if not all((assignments / name).is_dir() for name in COPIED_FOLDERS):
        raise ValueError(
            f"there are no assignments in {assignments}: an installed package holds none, for they hold the solutions; "
            f"in the project's folder `{ARCHIVE_COMMAND}` makes an archive: say --assignments teachers.zip"
        )
    if course.root.exists() and (not course.root.is_dir() or any(course.root.iterdir())):
        raise ValueError(f"{course.root} must be a new folder or an empty one: nothing is ever written over a course")
    course.root.mkdir(parents=True, exist_ok=True)
    for name in COPIED_FOLDERS:
        ignore = shutil.ignore_patterns("__pycache__", ".ipynb_checkpoints", "*.pyc")
        shutil.copytree(assignments / name, course.root / name, ignore=ignore)
    (course.root / "nbgrader_config.py").write_text(CONFIG, encoding="utf-8")
    (course.root / STUDENTS).write_text(",".join(STUDENT_COLUMNS) + "\n", encoding="utf-8")
    (course.root / SETTINGS).write_text(SETTINGS_TEXT, encoding="utf-8")
    (course.root / ".gitignore").write_text(IGNORED, encoding="utf-8")
    salt = course.root / SALT
    salt.touch(mode=0o600)
    salt.write_text(secrets.token_hex(16) + "\n", encoding="utf-8")
    return course
