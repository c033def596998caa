"""Align: poses that slipped, placed anew by what all scans saw.

In:  ``Scans`` in the order in which they were taken, their poses from odometry; the first pose is believed.
Out: ``Alignment``: ``.scans``, the same scans from their mended poses, ``.covariance`` of each, ``.open``.

>>> from primkit.lidar import Lidar, scan
>>> from primkit.robot import odometry
>>> from primkit.shapes import Circle
>>> from primkit.world import World
>>> world = World([Circle((0.0, 0.0), 0.1), Circle((0.4, 0.1), 0.05)], walls=True)
>>> turns = np.linspace(0, 4 * np.pi, 120)
>>> true = np.column_stack([0.25 * np.cos(turns), 0.25 * np.sin(turns), turns + np.pi / 2])
>>> seen = scan(world, true, Lidar(range_max=1.0, noise_std=0.002), rng=0)
>>> told = Scans(odometry(true, slip=0.03, turn=2.0, rng=1), seen.angles, seen.ranges, seen.inside)
>>> aligned = align(told)
>>> [round(1000 * float(np.hypot(*(scans.poses - true)[:, :2].T).max())) for scans in (told, aligned.scans)]
[30, 1]

1. Scan matching places each scan on the map of those before it: near enough for shapes to be found.
2. The shapes and walls in the map of all scans are the landmarks: lines ``n(a).p = d`` and circles ``|p - c| = r``.
3. Each hit belongs to the landmark that it lies on, if it is clear on which.
4. All poses, all landmarks, and two numbers of the odometry in one sparse least squares: ``pose_graph``.
5. How far ranges and steps scatter is told by what is left over.

2 to 5 are done anew until no pose moves, at most five times. A place that was left and is met again lies on the same
landmark: that closes the loop.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..arguments import Floats, as_positive, check_type
from ..circles import fit_circle
from ..grid import Grid
from ..lidar import Scans
from ..pipeline import find_shapes
from ..robot import chained, increments
from ..shapes import Circle
from ..table import count
from .pose_graph import Hits, Landmarks, State, pose_covariance, solve, variances
from .scan_matching import match_scans

# Lengths are in thousands of cells: on the usual grid, in metres.
MOST_ROUNDS = 5
SAME_NOISE, SAME_PLACE = 0.1, 0.0001  # standard deviations of a range, and length: no pose moved farther in a round
MOST_HITS = 150_000  # in the least squares
CLEAR_MAP = 0.5  # share of hits
MOST_SEARCHED = 4_000  # points in which landmarks are looked for
SIDE_SEEN = 0.3  # share of a side that must have been seen
REACH_CELLS = 250  # so many cells are as long as half of all ranges, when no resolution is given
SIDE_STDS, HIT_STDS = 6.0, 3.5  # a shorter side is none; a hit that is farther from its landmark lies on none
WIDEST_GATE, LEAST_NOISE = 0.025, 0.00005
ODD_NORMALS = np.radians(5.0)  # walls that are less askew are parallel
FIRST_STDS = 0.005, 0.03, 0.03, np.radians(1.0)  # of ranges; way ahead, way sideways and heading on a way of 1


@dataclass(frozen=True, eq=False)
class Alignment:
    """Scans that were placed anew.

    Parameters
    ----------
    scans : Scans
        From the mended poses, world frame.
    covariance : array, shape (P, 3, 3)
        Of x [m], y [m] and heading [rad] of each pose; zero for the first, which is believed.
    n_landmarks : int
        Sides of shapes, circles and walls that hits were found to lie on.
    noise_std : float
        Standard deviation of the ranges, metres.
    slip, turn : float
        Of the odometry: standard deviation of the way [m] and of the heading [degrees] over a metre.
    open : tuple of str
        What the scans cannot tell, so that the odometry alone says it; nothing where there are enough landmarks.
    """

    scans: Scans
    covariance: Floats
    n_landmarks: int
    noise_std: float
    slip: float
    turn: float
    open: tuple[str, ...]

    @property
    def std(self) -> Floats:
        """Standard deviations of each pose, shape (P, 3): x [m], y [m], heading [rad]."""
        return np.sqrt(np.einsum("pii->pi", self.covariance))

    def __repr__(self) -> str:
        place = 1000 * float(np.median(np.hypot(*self.std[:, :2].T))) if len(self.scans) else 0.0
        known = f"{count(len(self.scans), 'scan')} on {count(self.n_landmarks, 'landmark')}, known to {place:.1f} mm"
        return "; ".join([f"Alignment: {known}", *self.open])


def align(scans: Scans, *, resolution: float | None = None) -> Alignment:
    """Place scans anew whose poses are those of an odometry that slips; the first pose is believed.

    A direction that nothing in view tells is held by the odometry, and the covariance is as wide there.

    Parameters
    ----------
    scans : Scans
        In the order in which they were taken.
    resolution : float, optional
        Side of the cells in which shapes are looked for, metres; all lengths of the method follow it. When it is not
        given, it follows the ranges: 1 mm where half of them are shorter than 0.25 m.

    Raises
    ------
    ValueError
        If scans are none, or the resolution is not above zero.

    Examples
    --------
    Without anything to see, the odometry is all there is:

    >>> nothing = Scans([(0, 0, 0), (0.1, 0, 0)], [0.0], [[np.inf], [np.inf]], [False, False])
    >>> align(nothing)
    Alignment: 2 scans on no landmarks, known to 8.1 mm; no shape and no wall was found: all poses are the odometry's
    """
    check_type(scans, Scans, "scans must be Scans, as in align(scan(world, poses))")
    if resolution is None:
        reach = float(np.median(scans.ranges[scans.hits])) if scans.hits.any() else 0.25
        resolution = reach / REACH_CELLS
    unit = 1000 * as_positive(resolution, "resolution")
    start, n = np.append(scans.poses, np.zeros((1, 3)), axis=0)[:1], len(scans)
    from_start = replace(scans, poses=chained(np.zeros((1, 3)), increments(scans.poses))[:n])
    state, hits, covariance, noise = _placed(from_start.scaled(1 / unit))
    poses = chained(start, increments(state.poses * [unit, unit, 1]))[:n]
    c, s = np.cos(start[0, 2]), np.sin(start[0, 2])
    turned = np.array([(unit * c, -unit * s, 0), (unit * s, unit * c, 0), (0, 0, 1)])
    _, slip, _, turn = np.sqrt(state.variance)
    return Alignment(
        replace(scans, poses=poses),
        turned @ covariance @ turned.T,
        len(state.landmarks),
        noise * unit,
        float(slip * np.sqrt(unit)),
        float(np.degrees(turn) / np.sqrt(unit)),
        tuple(_open(state, hits)),
    )


def _placed(scans: Scans) -> tuple[State, Hits, Floats, float]:
    """Return the state after all rounds, the hits on landmarks, the covariance of the poses, the noise."""
    steps = increments(scans.poses)
    state = State(match_scans(scans), np.zeros(2), landmarks_in(scans[:0]), np.square(FIRST_STDS))
    hits = _hits(scans)
    for _ in range(MOST_ROUNDS):
        before = state.poses
        state = replace(state, landmarks=clear_landmarks(replace(scans, poses=before), state, hits))
        on_them, scatter = associate(state, hits)
        state = replace(state, variance=np.array([scatter**2, *state.variance[1:]]))
        state = solve(state, on_them, steps)
        variance, noise = variances(state, on_them, steps)
        state = replace(state, variance=variance)
        if np.abs(state.poses - before).max(initial=0.0) < max(SAME_PLACE, SAME_NOISE * scatter):
            break
    return state, on_them, pose_covariance(state, on_them, steps), noise


# --- landmarks, and what lies on them -----------------------------------------------------------------------------


def clear_landmarks(scans: Scans, state: State, hits: Hits) -> Landmarks:
    """Return the landmarks in the map of all scans; of the first half or quarter, where slips have smeared the whole.

    A map is clear if most of its hits lie on its landmarks.
    """
    best, most = state.landmarks, 0.0
    for n in (len(scans), len(scans) // 2, len(scans) // 4):
        marks, of_them = landmarks_in(scans[:n]), hits[hits.pose < n]
        share = len(associate(replace(state, landmarks=marks), of_them)[0].pose) / max(1, len(of_them.pose))
        if share > most:
            best, most = marks, share
        if most > CLEAR_MAP:
            break
    return best


def landmarks_in(scans: Scans) -> Landmarks:
    """Return the shapes' sides, circles and walls in the map of all scans."""
    points = scans.points()
    grid = Grid()
    grid.add(points[:: 1 + len(points) // MOST_SEARCHED])
    found = find_shapes(grid, rng=0)
    circles, sides = [], []
    for one in found:
        shape = one.shape
        round_one = fit_circle(one.points) if len(found) == 1 and not (found.walls or found.others) else None
        if round_one is not None and (round_one.signed_distance(one.points) ** 2).mean() < 2 * one.rms**2:
            shape = round_one  # it stands alone, and no corner stands out of the scatter: there is nothing to turn by
        if isinstance(shape, Circle):
            circles.append((*shape.center, shape.radius))
        else:
            each = zip(shape.vertices, np.roll(shape.vertices, -1, axis=0), one.seen, strict=True)
            sides += [(start, end) for start, end, share in each if share >= SIDE_SEEN]
    walls = [(wall.start, wall.end) for wall in found.walls]
    for thing in found.others:  # as of a room whose walls stand there twice
        walls += zip(thing.outline, np.roll(thing.outline, -1, axis=0), strict=True)
    ends = np.array([*sides, *walls]).reshape(-1, 2, 2)
    along = ends[:, 1] - ends[:, 0]
    bearing = np.arctan2(-along[:, 0], along[:, 1])
    lines = np.column_stack([bearing, np.cos(bearing) * ends[:, 0, 0] + np.sin(bearing) * ends[:, 0, 1]])
    return Landmarks(lines, np.array(circles).reshape(-1, 3), ends, np.arange(len(ends)) < len(sides))


def _hits(scans: Scans) -> Hits:
    """Return the hits of scans, on no landmark yet; every second or so, where there are very many."""
    pose, beam = np.nonzero(scans.hits)
    few = slice(None, None, 1 + len(pose) // MOST_HITS)
    pose, beam = pose[few], beam[few]
    return Hits(pose, scans.angles[beam], scans.ranges[pose, beam], np.full(len(pose), -1))


def associate(state: State, hits: Hits) -> tuple[Hits, float]:
    """Return the hits that lie on one landmark, and clearly on that one, and how far they scatter."""
    marks = state.landmarks
    if not len(marks) or not len(hits.pose):
        return hits[:0], float(np.sqrt(state.variance[0]))
    bearing = state.poses[hits.pose, 2] + hits.bearing
    beam = np.column_stack([np.cos(bearing), np.sin(bearing)])
    place = state.poses[hits.pose, :2] + hits.reach[:, None] * beam
    far = np.empty((len(marks), len(place)))
    for k, ((start, end), (a, _)) in enumerate(zip(marks.ends, marks.lines, strict=True)):
        along = (end - start) / np.hypot(*(end - start))
        t = (place - start) @ along
        beyond = np.maximum(np.maximum(-t, t - np.hypot(*(end - start))), 0)
        far[k] = np.hypot(np.abs((place - start) @ (np.cos(a), np.sin(a))), beyond)
        if marks.one_sided[k]:
            far[k, beam @ (np.cos(a), np.sin(a)) > 0] = np.inf
    for k, (x, y, radius) in enumerate(marks.circles, len(marks.ends)):
        far[k] = np.abs(np.hypot(place[:, 0] - x, place[:, 1] - y) - radius)
    nearest = far.argmin(axis=0)
    off = far[nearest, np.arange(len(place))]
    far[nearest, np.arange(len(place))] = np.inf
    second = far.min(axis=0)
    near = off < WIDEST_GATE
    noise = max(LEAST_NOISE, 1.4826 * float(np.median(off[near]))) if near.any() else float(np.sqrt(state.variance[0]))
    long = np.append(np.hypot(*(marks.ends[:, 1] - marks.ends[:, 0]).T) > SIDE_STDS * noise, marks.circles[:, 2] > 0)
    clear = (off < min(WIDEST_GATE, HIT_STDS * noise)) & (second > off + 2 * noise) & long[nearest]
    return replace(hits[clear], landmark=nearest[clear]), noise


def _open(state: State, hits: Hits) -> list[str]:
    """Return what cannot be told, each in a clause."""
    marks, n = state.landmarks, len(state.poses)
    blind = n - len(np.unique(hits.pose)) - (0 if (hits.pose == 0).any() else 1)
    if not len(marks):
        return ["no shape and no wall was found: all poses are the odometry's"]
    said = []
    spread = np.abs(np.sin(marks.lines[:, 0] - marks.lines[:1, 0])).max(initial=0.0)
    if not len(marks.circles) and spread < ODD_NORMALS:
        said.append("only parallel walls were found: how far along them a pose lies, the odometry says")
    if not len(marks.lines) and len(marks.circles) == 1:
        said.append("only one circle was found: where around it a pose lies, the odometry says")
    if blind > 0:
        said.append(f"{blind} of {count(n, 'scan')} saw no landmark: between those that did, the odometry says")
    return said
