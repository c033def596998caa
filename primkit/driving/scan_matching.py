"""Scan matching: each scan is laid onto the map of those before it, from where the odometry says.

In:  ``Scans`` in the order in which they were taken, their poses from odometry.
Out: poses, shape (P, 3), as good as places can tell that know no shapes: the start for ``align``.

The map is a normal distributions transform: the points in each square cell are told by their mean m and covariance S. A
scan whose points p fall into such cells lies best at the pose x that makes this least:

    (x - x0)' P^-1 (x - x0) + sum rho((p - m)' (S^-1 - I / l) (p - m))        rho(e) = c log(1 + e / c)

x0 is where the odometry says that the robot is now, P how sure that is, l the larger eigenvalue of S: where along an
outline a point lies says nothing, else a scan that sees more of it than the map would be drawn back. Four grids,
shifted by half a cell, share the weight, so that no border between cells is special.

Source: Biber and Strasser, The normal distributions transform, 2003; rho is Cauchy's.
"""

from __future__ import annotations

import numpy as np

from ..arguments import Floats, Ints
from ..lidar import Scans
from ..robot import increments

# Lengths are in thousands of cells of the grid of shapes: on the usual one, in metres.
CELL_SIDE = 0.03  # a corner is still a corner
LEAST_CELL_POINTS = 4  # points
SMOOTH = 0.003  # what a cell's points scatter at the least
MATCH_STEPS = 8
MOST_MATCHED, MATCH_WEIGHT = 100, 0.05  # points of a scan; weight of each on each of the four grids
CAUCHY = 4.0  # squared standard deviations
DRIFT_SLIP, DRIFT_TURN = 0.04, np.radians(4.0)  # of the odometry, over a way of 1: what is new at each step,
LASTING_STD = 0.05, np.radians(20.0)  # and what lasts
LEAST_SLIP = np.array([4e-7, 4e-7, 1e-6, 1e-12, 1e-12])  # variances; of every step
MATCHED = 2e-5  # a step that is as small is the last
MOST_MAP_CELLS = 1_000_000
SHIFTS = 0.5 * np.array([(0, 0), (1, 0), (0, 1), (1, 1)])[:, None]


class CellMap:
    """What is known of the points in each cell of four shifted grids that cover a box, (2, 2) metres."""

    def __init__(self, box: Floats) -> None:
        span = box[1] - box[0]
        self.side = max(CELL_SIDE, float(np.sqrt(4 * span.prod() / MOST_MAP_CELLS)))
        self.low, self.counts = box[0], np.ceil(span / self.side).astype(int) + 2
        n = 4 * int(self.counts.prod())
        self.sums = np.zeros((n, 6))  # 1, x, y, xx, xy, yy of the points
        self.mean, self.weight = np.zeros((n, 2)), np.zeros((n, 3))  # weight: xx, xy, yy of S^-1 - I / l; 0: unknown

    def cells_of(self, points: Floats) -> Ints:
        """Return the number of the cell that each point lies in, on each of the four grids, shape (4, N)."""
        place = np.floor((points - self.low) / self.side + SHIFTS).astype(int)
        place = np.clip(place, 0, self.counts - 1)
        return (np.arange(4)[:, None] * self.counts[0] + place[..., 0]) * self.counts[1] + place[..., 1]

    def add(self, points: Floats) -> None:
        """Add points, shape (N, 2), metres."""
        cells = self.cells_of(points)
        x, y = (points - self.low).T
        np.add.at(self.sums, cells, np.column_stack([np.ones(len(x)), x, y, x * x, x * y, y * y]))
        hit = np.unique(cells)
        n, sx, sy, xx, xy, yy = self.sums[hit].T
        mx, my = sx / n, sy / n
        a, b, c = xx / n - mx * mx + SMOOTH**2, xy / n - mx * my, yy / n - my * my + SMOOTH**2
        large = (a + c) / 2 + np.hypot((a - c) / 2, b)
        known, determinant = n >= LEAST_CELL_POINTS, a * c - b * b
        self.mean[hit] = self.low + np.column_stack([mx, my])
        weight = [c / determinant - 1 / large, -b / determinant, a / determinant - 1 / large]
        self.weight[hit] = known[:, None] * np.column_stack(weight)

    def equations(self, pose: Floats, seen: Floats) -> tuple[Floats, Floats]:
        """Return the normal equations, (3, 3) and (3,), of a step from a pose; seen: points as seen from it, (N, 2)."""
        points = placed(seen, pose)
        arm, cells = points - pose[:2], self.cells_of(points)
        xx, xy, yy = np.moveaxis(self.weight[cells], -1, 0)
        dx, dy = np.moveaxis(points - self.mean[cells], -1, 0)
        off = xx * dx * dx + 2 * xy * dx * dy + yy * dy * dy
        rho = MATCH_WEIGHT / (1 + off / CAUCHY)
        rows = np.stack([np.ones_like(dx), np.zeros_like(dx), np.broadcast_to(-arm[:, 1], dx.shape)])
        rows_y = np.stack([np.zeros_like(dx), np.ones_like(dx), np.broadcast_to(arm[:, 0], dx.shape)])
        wx, wy = rho * (xx * rows + xy * rows_y), rho * (xy * rows + yy * rows_y)
        normal = np.einsum("agn,bgn->ab", rows, wx) + np.einsum("agn,bgn->ab", rows_y, wy)
        return normal, np.einsum("agn,gn->a", wx, dx) + np.einsum("agn,gn->a", wy, dy)


def match_scans(scans: Scans) -> Floats:
    """Return the poses of scans as matching finds them, shape (P, 3); the first one stays."""
    points = scans.points()
    if len(points) == 0:
        return scans.poses.copy()
    low, high = points.min(axis=0), points.max(axis=0)
    spare = 0.25 * (high - low) + CELL_SIDE
    area = CellMap(np.array([low - spare, high + spare]))
    poses, steps = scans.poses.copy(), increments(scans.poses)
    here = np.array([*poses[0], 0.0, 0.0])  # and by what share steps are too short, and how far one turns on a metre
    covariance = np.diag([0.0, 0.0, 0.0, *LASTING_STD]) ** 2
    for k, (reach, hit) in enumerate(zip(scans.ranges, scans.hits, strict=True)):
        bearing, reach = scans.angles[hit], reach[hit]
        seen = reach[:, None] * np.column_stack([np.cos(bearing), np.sin(bearing)])
        if k:
            here, covariance = predict(here, steps[k - 1], covariance)
            here, covariance = match(area, here, covariance, seen[:: 1 + len(seen) // MOST_MATCHED])
            poses[k] = here[:3]
        if len(seen):
            area.add(placed(seen, poses[k]))
    return poses


def placed(seen: Floats, pose: Floats) -> Floats:
    """Return points that are seen from a pose, shape (N, 2), where they are."""
    c, s = np.cos(pose[2]), np.sin(pose[2])
    return pose[:2] + seen @ np.array([(c, s), (-s, c)])


def predict(here: Floats, step: Floats, covariance: Floats) -> tuple[Floats, Floats]:
    """Return pose and drift, shape (5,), after a step of the odometry, and their covariance, shape (5, 5)."""
    x, y, heading, s, g = here
    c, si = np.cos(heading), np.sin(heading)
    told = np.array([c * step[0] - si * step[1], si * step[0] + c * step[1]])
    length = float(np.hypot(*told))
    dx, dy = (1 + s) * told
    moved = np.eye(5)
    moved[:3, 2:] = [(-dy, told[0], 0), (dx, told[1], 0), (1, 0, length)]
    slip = np.array([DRIFT_SLIP, DRIFT_SLIP, DRIFT_TURN, 0, 0]) ** 2 * (length + 0.05 * abs(step[2]))
    covariance = moved @ covariance @ moved.T + np.diag(slip + LEAST_SLIP)
    return np.array([x + dx, y + dy, heading + step[2] + g * length, s, g]), covariance


def match(area: CellMap, start: Floats, covariance: Floats, seen: Floats) -> tuple[Floats, Floats]:
    """Return pose and drift at which seen points, shape (N, 2), lie best on the map, and their covariance."""
    prior, here, normal = np.linalg.inv(covariance), start, np.zeros((5, 5))
    for _ in range(MATCH_STEPS if len(seen) else 0):
        normal[:3, :3], slope = area.equations(here[:3], seen)
        step = np.linalg.solve(normal + prior, np.append(slope, (0, 0)) + prior @ (here - start))
        here = here - step
        if np.abs(step[:3]).max() < MATCHED:
            break
    return here, np.linalg.inv(normal + prior)
