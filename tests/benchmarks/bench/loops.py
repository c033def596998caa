"""Loops: brute force, every beam of every pose against every side and circle, to be compiled by numba.

In:  poses, shape (P, 3); the beams' cosines and sines, shape (B,); sides, shape (S, 4): a corner and the way to the
     next one; circles, shape (C, 3): centre and radius; the sensor's limits.
Out: ranges, shape (P, B), written into ``out``: exact, infinity where a beam meets nothing within the limits.

Two ways to write the same loop, because a compiler makes very different things of them: as one would, and with the
beams in the middle and no branch there, so that a processor takes several at a time.

They are plain Python and run without numba too, slowly:

>>> out = np.empty((1, 1))
>>> plain(np.zeros((1, 3)), np.ones(1), np.zeros(1), np.array([[0.2, -1, 0, 2.0]]), np.empty((0, 3)), 0.0, 1.0, out)
>>> out.tolist()
[[0.2]]

Legend: u is a beam's direction, a a corner, d the way to the next, c a circle's centre, all as seen from the robot;
t is the distance to a hit, s where on the side it lies, from 0 to 1.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def plain(
    poses: Floats, cos: Floats, sin: Floats, sides: Floats, circles: Floats, least: float, most: float, out: Floats
) -> None:
    """Pose by pose, beam by beam, side by side: as one would write it."""
    for p in range(len(poses)):
        x, y, heading = poses[p]
        turn_x, turn_y = math.cos(heading), math.sin(heading)
        for b in range(len(cos)):
            ux, uy = turn_x * cos[b] - turn_y * sin[b], turn_y * cos[b] + turn_x * sin[b]
            best = math.inf
            for k in range(len(sides)):
                ax, ay, dx, dy = sides[k, 0] - x, sides[k, 1] - y, sides[k, 2], sides[k, 3]
                across = ux * dy - uy * dx
                if across == 0.0:
                    continue
                t = (ax * dy - ay * dx) / across
                s = (ax * uy - ay * ux) / across
                if t >= 0.0 and 0.0 <= s <= 1.0 and t < best:
                    best = t
            for k in range(len(circles)):
                cx, cy, r = circles[k, 0] - x, circles[k, 1] - y, circles[k, 2]
                along, aside = ux * cx + uy * cy, ux * cy - uy * cx
                square = r * r - aside * aside
                if square >= 0.0:
                    t = along - math.sqrt(square)
                    if 0.0 <= t < best:
                        best = t
            out[p, b] = best if least <= best <= most else math.inf


def beams_inside(
    poses: Floats, cos: Floats, sin: Floats, sides: Floats, circles: Floats, least: float, most: float, out: Floats
) -> None:
    """Do the same, all beams of one side after the other, without a branch."""
    n = len(cos)
    ux, uy, best = np.empty(n), np.empty(n), np.empty(n)
    for p in range(len(poses)):
        x, y, heading = poses[p]
        turn_x, turn_y = math.cos(heading), math.sin(heading)
        for b in range(n):
            ux[b], uy[b] = turn_x * cos[b] - turn_y * sin[b], turn_y * cos[b] + turn_x * sin[b]
            best[b] = math.inf
        for k in range(len(sides)):
            ax, ay, dx, dy = sides[k, 0] - x, sides[k, 1] - y, sides[k, 2], sides[k, 3]
            area = ax * dy - ay * dx
            for b in range(n):
                inverse = 1.0 / (ux[b] * dy - uy[b] * dx)  # infinite along the side: then s or t is, or is no number
                s, t = (ax * uy[b] - ay * ux[b]) * inverse, area * inverse
                hit = (s >= 0.0) & (s <= 1.0) & (t >= 0.0) & (t < best[b])
                best[b] = t if hit else best[b]
        for k in range(len(circles)):
            cx, cy, r = circles[k, 0] - x, circles[k, 1] - y, circles[k, 2]
            for b in range(n):
                aside = ux[b] * cy - uy[b] * cx
                square = r * r - aside * aside
                t = ux[b] * cx + uy[b] * cy - math.sqrt(max(square, 0.0))
                hit = (square >= 0.0) & (t >= 0.0) & (t < best[b])
                best[b] = t if hit else best[b]
        for b in range(n):
            out[p, b] = best[b] if least <= best[b] <= most else math.inf


LOOPS = {
    "numba, plain loop": plain,
    "numba, beams innermost": beams_inside,
}
