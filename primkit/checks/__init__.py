"""Checks: tell a student whether their function is right, and what is off.

Beside the story. A check is called with the student's function and runs it on a few hundred cases, always the same. It
judges what comes out and not how: any correct algorithm passes. ``yours_or_ours`` gives a lesson a function to go on
with, so that it runs to its end with every task left open.

In:  the student's function.
Out: an ``Answer``: not attempted, wrong, error or right, each with a sentence.

>>> def ray_circle_mine(origin, direction, center, radius):
...     return ...
>>> ray_circle(ray_circle_mine)
○ not attempted: ray_circle still returns `...`.
>>> ray_circle.yours_or_ours(ray_circle_mine)
ray_circle: the lesson goes on with the library's, because yours is: not attempted.

The rooms, each of which imports only those before it:

=============  =====================================================
``judges.py``  numbers, labels, corners, circles, lines: right or off
``answer.py``  ``Check``: cases, reference, judge, faults by name
``rays.py``    lesson 01: a beam meets a wall, or a circle
=============  =====================================================
"""

from .answer import Answer, Check, Fault
from .rays import ray_circle, ray_segment

# Every task of the course, in its order: tests hold each of them against tests/answers.
TASKS = (ray_segment, ray_circle)

__all__ = ["ray_segment", "ray_circle", "Answer", "Check", "Fault", "TASKS"]
