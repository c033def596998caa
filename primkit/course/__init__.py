"""Course: from its folder to its grades; what ``primkit teach`` does.

nbgrader makes the students' version, runs what they hand in, keeps the gradebook and writes the feedback; here is what
it lacks: personal maps, a way to run submissions of which none can cost another one anything, a search for leaks, and
an overview of the class. What grading runs, and what that can reach, says ``primkit teach grade --help``.

In:  ``notebooks/assignments`` of the project: problem sets with their solutions, and the hidden tests.
Out: a course folder, and in it what students get, grades, feedback, reports.

>>> from primkit.course.handed_in import Fault
>>> Fault("ada", "cell 3", "KernelDied", "this cell ended Python").cell
'cell 3'

Imported by the command line and the hidden tests only.
"""

# The id and the salt of a board that is known to everybody: its scans lie beside the teacher's own notebook.
DEMONSTRATION = ("demonstration", "the salt of the demonstration")

__all__ = ["DEMONSTRATION"]
