"""Teaching: a course from its folder to its grades; what ``primkit teach`` does.

Beside the story. nbgrader makes the students' version, runs what they hand in, keeps the gradebook and writes the
feedback; here is only what it lacks: personal maps, a way to run submissions of which none can cost another one
anything, a search for leaks, and an overview of the class.

In:  ``notebooks/assignments`` of the project: problem sets with their solutions, and the hidden tests.
Out: a course folder, and in it what students get, grades, feedback, reports.

>>> from primkit.course.handed_in import Fault
>>> Fault("ada", "cell 3", "KernelDied", "this cell ended Python").data()["cell"]
'cell 3'

The rooms, each of which imports only those before it:

===================  ===========================================================
``untrusted.py``     what grading runs, and what that can reach: read it first
``course.py``        the course folder, and what lies where in it
``running.py``       nbgrader's commands, each in a process of its own
``leaks.py``         is a solution in what students get?
``checking.py``      is all there, and how is each fault mended?
``sanitizing.py``    a submission's cells in order
``executing.py``     how a submission is run; nbgrader calls this
``handed_in.py``     is there a notebook that can be run?
``handing_back.py``  what nbgrader's feedback lacks
``releasing.py``     the students' version, and their personal maps
``grading.py``       every submission on its own
``overview.py``      what the class did, task by task
``reporting.py``     the same as text, tables and a figure
===================  ===========================================================
"""
