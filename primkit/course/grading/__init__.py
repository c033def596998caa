"""Grading: points for a student's function, part by part; what the hidden tests of a problem set call.

A ``Task`` is made of parts, and each part of a ``Check`` and its points, all or none. Whatever a part meets, an endless
loop, an exception, the end of Python, costs that part alone. Only what a function returns earns points.

When a submission is graded, tests and student are two processes, and only plain values cross:

====================  ==================================================================
``task.py``           a task, its parts, and how a function is marked
``mark.py``           points as text, as HTML and as data
``judging.py``        a graded cell of the teacher's, run in the judge's process
``workers.py``        the judge's side of the line: a student's function, from afar
``serving.py``        the student's side of it
``wire.py``           what is said on the line
``plain_values.py``   what can be said
====================  ==================================================================

In:  the student's function, or its name and where it is looked up.
Out: the points, and a table that says for each part what is off.

>>> from primkit.checks import Check, judges
>>> half = Check("half", lambda x: x / 2, lambda rng: [(1.0,), (3.0,)], judges.number("m"))
>>> task = Task("half", [Part("halves lengths", 2, half)])
>>> task.mark(lambda x: 0.5 * x)
2.0
>>> print(task.marked("half", {}))
half: 0 of 2 points
- 0 of 2  halves lengths: there is no function half: run its cell, and keep its name.

Not here: solutions. Those of the problem sets stay with the teacher.
"""

from ..personal import personal_truth
from .mark import MIME, Mark, Row
from .task import Part, Task
from .workers import OutOfTime

__all__ = ["Part", "Task", "personal_truth", "Mark", "Row", "MIME", "OutOfTime"]
