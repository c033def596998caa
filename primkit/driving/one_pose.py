"""One pose: the step of Gauss and Newton that brings what a robot sees onto the walls that it lies on.

In:  a pose (x [m], y [m], heading [rad]); hits as the robot sees them, shape (N, 2), metres; of the wall of each hit
     the normal, shape (N, 2), and the offset, shape (N,), metres: n . p = d.
Out: the pose after the step.

    r = n . (t + R u) - d           how far a hit lies from its wall
    J = [n_x, n_y, n . (R u)^]      how r changes with x, y and heading; (x, y)^ = (-y, x)
    step = -J+ r                    the least squares of r + J step, of several the smallest

t, R  place and heading of the pose; u  a hit as the robot sees it; n, d  its wall

>>> ahead, wall = np.array([[0.4, 0.0]]), np.array([[1.0, 0.0]])
>>> wall_step(np.zeros(3), ahead, wall, np.array([0.5])).round(3).tolist()
[0.1, 0.0, 0.0]

Not here: which hit lies on which wall; all poses and unknown walls at once: ``pose_graph``.

Source: F. Lu and E. Milios, Robot Pose Estimation in Unknown Environments by Matching 2D Range Scans, 1997.
"""

from __future__ import annotations

import numpy as np

from ..arguments import Floats
from .scan_matching import placed


def off_walls(pose: Floats, hits: Floats, normals: Floats, offsets: Floats) -> Floats:
    """Return n . p - d for each hit and its wall, shape (N,), metres."""
    off: Floats = np.einsum("nk,nk->n", normals, placed(hits, pose)) - offsets
    return off


def turned(points: Floats, angle: float) -> Floats:
    """Return points, shape (N, 2), turned about the origin, counter-clockwise."""
    return placed(points, np.array([0.0, 0.0, angle]))


def slopes(arms: Floats, normals: Floats) -> Floats:
    """Return how each residual changes with x, y and heading, shape (N, 3); arms: from robot to hit, (N, 2)."""
    return np.column_stack([normals, normals[:, 1] * arms[:, 0] - normals[:, 0] * arms[:, 1]])


def wall_step(guess: Floats, hits: Floats, normals: Floats, offsets: Floats) -> Floats:
    """Return the pose after one step from a guess, shape (3,); what the walls do not tell stays as it is."""
    jacobian = slopes(turned(hits, guess[2]), normals)
    step = np.linalg.lstsq(jacobian, off_walls(guess, hits, normals, offsets), rcond=None)[0]
    return guess - step.astype(float)
