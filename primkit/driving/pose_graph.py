"""Pose graph: all poses and all landmarks in one sparse least squares.

In:  ``State``, a start; ``Hits``, on which landmark each hit lies; the steps of the odometry, shape (P - 1, 3).
Out: ``State`` at its best; the variances that what is left over tells; the covariance of each pose.

    hits      (n.(t + R u r) - d) / std         how far a hit lies from its line; from its circle likewise
    odometry  (R'(t_next - t) - (1 + s) step) / std, (turn - g way) / std

t, R  place and heading of a pose; u, r  bearing and range of a hit; n(a).p = d  a line, |p - c| = radius  a circle
s  by what share of the way all steps are too short; g  by how much the heading drifts on a metre [rad/m]

All lengths are in thousands of cells of the grid of shapes: on the usual one, in metres.

Source: Lu and Milios, Globally consistent range scan alignment, 1997; Förstner, Ein Verfahren zur Schätzung von
Varianz- und Kovarianzkomponenten, 1979.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arguments import Bools, Floats, Ints
from ..robot import increments

if TYPE_CHECKING:
    from scipy.sparse import csr_array
    from scipy.sparse.linalg import SuperLU

NEWTON_STEPS, STILL = 5, 0.0001  # the last step moves no number farther
LEAST_HIT_STD = 0.00005  # of a hit from its landmark
GRAZING_NOISE = 0.3  # noise that a hit has across the beam, in noises along it: a beam that grazes ends anywhere
LASTING = 3.0  # s and g, before anything is known: so many times what is new on a way of 1
HALF_AXLE, LEAST_WAY = 0.05, 1e-5  # turns on the spot slip, too
COLUMNS_AT_ONCE, SIGN_VECTORS, RUN = 1000, 24, 8
LEAST_VARIANCE = 1e-10
AS_SUPPOSED = 10.0  # residuals that agree with what was supposed: where few are free, the variance stays


@dataclass(frozen=True, eq=False)
class Landmarks:
    """What hits may lie on: first lines, shape (L, 2): bearing a of the normal, distance d; then circles: x, y, r."""

    lines: Floats
    circles: Floats
    ends: Floats  # of each line, (L, 2, 2)
    one_sided: Bools  # whether a line is a side of a shape, seen from where its normal points only

    def __len__(self) -> int:
        return len(self.lines) + len(self.circles)

    def with_numbers(self, numbers: Floats) -> Landmarks:
        """Return landmarks with other numbers, all in a row."""
        n = self.lines.size
        return replace(self, lines=numbers[:n].reshape(-1, 2), circles=numbers[n:].reshape(-1, 3))

    @property
    def numbers(self) -> Floats:
        """All numbers in a row."""
        return np.concatenate([self.lines.ravel(), self.circles.ravel()])


@dataclass(frozen=True, eq=False)
class Hits:
    """Hits on landmarks: which pose saw them, at which bearing [rad] and range [m], and on which landmark; all (N,)."""

    pose: Ints
    bearing: Floats
    reach: Floats
    landmark: Ints

    def __getitem__(self, which: Any) -> Hits:
        return Hits(self.pose[which], self.bearing[which], self.reach[which], self.landmark[which])


@dataclass(frozen=True, eq=False)
class State:
    """All that is unknown, and the scatter that is not: poses, drift (s, g), landmarks; variances."""

    poses: Floats
    drift: Floats
    landmarks: Landmarks
    variance: Floats  # of a range [m^2]; on a metre, of the way ahead and sideways [m^2/m], of the heading [rad^2/m]

    @property
    def numbers(self) -> Floats:
        """All unknowns in a row: those of the poses but the first, the drift's, the landmarks'."""
        return np.concatenate([self.poses[1:].ravel(), self.drift, self.landmarks.numbers])

    def moved(self, step: Floats) -> State:
        """Return the state after a step of all unknowns."""
        n, numbers = self.poses[1:].size, self.numbers + step
        poses = np.concatenate([self.poses[:1], numbers[:n].reshape(-1, 3)])
        return State(poses, numbers[n : n + 2], self.landmarks.with_numbers(numbers[n + 2 :]), self.variance)


def hit_rows(state: State, hits: Hits) -> tuple[Floats, csr_array]:
    """Return how far hits lie from their landmarks, in standard deviations, (N,), and the Jacobian (N, unknowns)."""
    poses, marks = state.poses[hits.pose], state.landmarks
    bearing = poses[:, 2] + hits.bearing
    beam = np.column_stack([np.cos(bearing), np.sin(bearing)])
    place = poses[:, :2] + hits.reach[:, None] * beam
    n_lines = len(marks.lines)
    on_line = hits.landmark < n_lines
    off, normal, slope = np.empty(len(place)), np.empty((len(place), 2)), np.zeros((len(place), 3))
    a, d = marks.lines[hits.landmark[on_line]].T
    normal[on_line] = np.column_stack([np.cos(a), np.sin(a)])
    off[on_line] = np.einsum("ij,ij->i", normal[on_line], place[on_line]) - d
    slope[on_line, 0] = place[on_line, 1] * np.cos(a) - place[on_line, 0] * np.sin(a)
    slope[on_line, 1] = -1
    circle = marks.circles[hits.landmark[~on_line] - n_lines]
    away = place[~on_line] - circle[:, :2]
    distance = np.hypot(*away.T)
    normal[~on_line] = away / distance[:, None]
    off[~on_line] = distance - circle[:, 2]
    slope[~on_line] = np.column_stack([-normal[~on_line], -np.ones(len(circle))])
    turn = hits.reach * (normal[:, 1] * beam[:, 0] - normal[:, 0] * beam[:, 1])
    across = np.einsum("ij,ij->i", normal, beam) ** 2 + GRAZING_NOISE**2
    std = np.sqrt(state.variance[0] * across + LEAST_HIT_STD**2)
    values = np.column_stack([normal, turn, slope]) / std[:, None]
    first = np.where(on_line, 2 * hits.landmark, 2 * n_lines + 3 * (hits.landmark - n_lines))
    columns = first[:, None] + np.where(on_line[:, None], [0, 1, 1], [0, 1, 2]) + state.poses[1:].size + 2
    at = 3 * (hits.pose[:, None] - 1) + np.arange(3)
    return off / std, _rows(values, np.hstack([at, columns]), len(state.numbers))


def step_rows(state: State, steps: Floats) -> tuple[Floats, csr_array]:
    """Return by how much each step contradicts the odometry, in standard deviations, (3 (P - 1) + 2,); the Jacobian.

    First forward for all steps, then to the left, then all turns, then the two numbers of the drift.
    """
    n, way = len(steps), np.hypot(*steps[:, :2].T)
    here = increments(state.poses)
    (s, g), heading = state.drift, state.poses[:-1, 2]
    off = here - steps
    off[:, :2] -= s * steps[:, :2]
    off[:, 2] = (off[:, 2] + np.pi) % (2 * np.pi) - np.pi - g * way
    slipping = way + HALF_AXLE * np.abs(steps[:, 2]) + LEAST_WAY  # the wheels' way: turns on the spot slip, too
    std = np.sqrt(slipping[:, None] * state.variance[1:])
    c, si, zero, one = np.cos(heading), np.sin(heading), np.zeros(n), np.ones(n)
    rows = np.array(
        [  # x, y, heading; x, y, heading of the next; s, g
            [-c, -si, here[:, 1], c, si, zero, -steps[:, 0], zero],
            [si, -c, -here[:, 0], -si, c, zero, -steps[:, 1], zero],
            [zero, zero, -one, zero, zero, one, zero, -way],
        ]
    )
    values = np.moveaxis(rows, 1, 2) / std.T[:, :, None]
    drift, lasting = state.poses[1:].size + np.arange(2), LASTING * np.sqrt(state.variance[[1, 3]])
    at = np.hstack([3 * np.arange(n)[:, None] + np.arange(-3, 3), np.broadcast_to(drift, (n, 2))])
    last = np.tile(np.pad(drift, (6, 0), constant_values=-1), (2, 1))
    values = np.concatenate([*values, np.pad(np.diag(1 / lasting), ((0, 0), (6, 0)))])
    left = np.append((off / std).T, state.drift / lasting)
    return left, _rows(values, np.concatenate([at, at, at, last]), len(state.numbers))


def _rows(values: Floats, columns: Ints, width: int) -> csr_array:
    """Return rows of a sparse matrix; a column below zero is one of the first pose, which is held."""
    from scipy.sparse import csr_array

    values = np.where(columns < 0, 0.0, values)
    rows = np.arange(0, values.size + 1, values.shape[1])
    return csr_array((values.ravel(), np.maximum(columns, 0).ravel(), rows), shape=(len(values), width))


def solve(state: State, hits: Hits, steps: Floats) -> State:
    """Return the state of least squares, by Gauss-Newton."""
    for _ in range(NEWTON_STEPS):
        (off, rows), (slipped, odometry) = hit_rows(state, hits), step_rows(state, steps)
        step = _factors(rows, odometry).solve(-(rows.T @ off + odometry.T @ slipped))
        state = state.moved(step)
        if np.abs(step[: state.poses[1:].size]).max(initial=0.0) < STILL:
            break
    return state


def variances(state: State, hits: Hits, steps: Floats) -> tuple[Floats, float]:
    """Return the variances of ranges, way and heading that what is left over tells, and the noise of one range.

    A group of n residuals whose squares sum up to q has the variance q / (n - trace(C J'J)) of what was supposed, J the
    group's rows, C the covariance of all unknowns. The trace is the mean of z'C J'J z for vectors z of random signs
    (Hutchinson, 1989). Where nearly nothing is free, as of an odometry that no hit contradicts, what was supposed
    stays. Where a landmark is not quite what it is taken for, neighbouring hits err together, and the sum of eight
    scatters more than that of independent ones: then that counts.
    """
    (off, rows), (slipped, odometry) = hit_rows(state, hits), step_rows(state, steps)
    n = len(steps)
    groups = [(off, rows), *((slipped[k * n : (k + 1) * n], odometry[k * n : (k + 1) * n]) for k in range(3))]
    signs = np.random.default_rng(0).choice([-1.0, 1.0], (rows.shape[1], SIGN_VECTORS))
    solved = _factors(rows, odometry).solve(signs)
    free = [part.shape[0] - float((solved * (part.T @ (part @ signs))).sum()) / SIGN_VECTORS for _, part in groups]
    left = (AS_SUPPOSED + np.array([part @ part for part, _ in groups])) / (AS_SUPPOSED + np.maximum(free, 0.0))
    runs = off[: len(off) // RUN * RUN].reshape(-1, RUN).sum(axis=1)
    together = float(runs @ runs) / RUN / max(1.0, len(runs) - (len(off) - free[0]))
    noise = float(np.sqrt(state.variance[0] * left[0]))
    left[0] = max(left[0], together)
    return np.maximum(state.variance * left, LEAST_VARIANCE), noise


def pose_covariance(state: State, hits: Hits, steps: Floats) -> Floats:
    """Return the covariance of each pose, shape (P, 3, 3)."""
    factors = _factors(hit_rows(state, hits)[1], step_rows(state, steps)[1])
    n, covariance = 3 * len(steps), np.zeros((len(state.poses), 3, 3))
    for start in range(0, n, COLUMNS_AT_ONCE):
        columns = np.arange(start, min(n, start + COLUMNS_AT_ONCE))
        solved = factors.solve(np.eye(len(state.numbers), len(columns), -start))
        rows = columns[:, None] // 3 * 3 + np.arange(3)
        covariance[columns // 3 + 1, columns % 3] = solved[rows, np.arange(len(columns))[:, None]]
    return covariance


def _factors(rows: csr_array, odometry: csr_array) -> SuperLU:
    """Return the normal equations, factored; a landmark without hits stays where it is.

    Poses are a chain and landmarks come last: in this order next to nothing is filled in.
    """
    from scipy.sparse import eye_array
    from scipy.sparse.linalg import splu

    normal = (rows.T @ rows + odometry.T @ odometry + eye_array(rows.shape[1])).tocsc()
    return splu(normal, permc_spec="NATURAL", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
