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

A lesson's tasks lie in a module of their own: their reference, cases and usual faults, read downwards.
"""

from .answer import Answer, Check, Fault
from .arcs import circle_rms, fit_circle
from .cells import occupy, to_cells
from .composites import camera_columns, fewest_parts
from .driving import drive_step, share_seen
from .edges import fit_line, inliers_of, line_through, ransac_line
from .groups import assign_points, silhouette, update_centers
from .layers import nearest_to, plane_through, sphere_through
from .naming import fair_choice, meet, sides_and_centroid
from .poses import clean_ranges, newton_step, wall_residuals
from .rays import ray_circle, ray_segment
from .scoring import match_shapes, parts, right

__all__ = ["ray_segment", "ray_circle", "to_cells", "occupy", "assign_points", "update_centers", "silhouette"]
__all__ += ["line_through", "inliers_of", "fit_line", "ransac_line", "fit_circle", "circle_rms"]
__all__ += [
    "meet",
    "sides_and_centroid",
    "fair_choice",
    "match_shapes",
    "right",
    "parts",
    "drive_step",
    "share_seen",
    "clean_ranges",
    "wall_residuals",
    "newton_step",
]
__all__ += ["plane_through", "sphere_through", "nearest_to"]
__all__ += ["fewest_parts", "camera_columns"]
__all__ += ["Answer", "Check", "Fault", "TASKS"]

# Every task of the course, in its order: tests hold each of them against tests/answers.
TASKS = tuple(task for name in __all__ if isinstance(task := globals().get(name), Check))
