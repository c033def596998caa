"""Grader: the hidden tests of the problem sets. On the teacher's side only, never in what students receive.

In:  a student's function, by its name, from the notebook that is marked.
Out: points and a table, from ``primkit.course.grading``.

The last cell of each task says ``from grader import rays_and_grid`` and ``rays_and_grid.RAY_ARC.mark("ray_arc",
globals())``. A problem set is a folder with one room for each of its functions. Each room has a reference, the cases
of each part, and usual faults by their names:

=======================  ==============================================================
``parts.py``             a task from its parts, and judges that only problem sets need
``rays_and_grid/``       problem set 1
``clusters_and_lines/``  problem set 2
``circles_and_sizes/``   problem set 3
``maps_and_scores/``     problem set 4
``your_own_map/``        the capstone
=======================  ==============================================================
"""
