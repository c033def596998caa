"""Driving: where two wheels take the robot, and how much of an outline was seen; the checks of lesson 08.

In:  the student's ``drive_step(pose, left, right, seconds)`` and ``share_seen(outline, points, reach)``.
Out: answers. The first returns the pose after that time (x [m], y [m], heading [rad]); the second a share from 0 to 1.

A heading is right up to whole turns.

>>> drive_step(lambda pose, left, right, seconds: ...)
○ not attempted: drive_step still returns `...`.
>>> drive_step.reference((0.0, 0.0, 0.0), 2.0, 2.0, 1.0)
array([0.041, 0.   , 0.   ])
>>> share_seen.reference(np.array([(0.0, 0.0), (0.1, 0.0)]), np.array([(0.0, 0.005)]), 0.012)
0.5
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from ..arguments import Floats
from ..robot import AXLE, FASTEST, WHEEL, moved
from . import judges
from .answer import Case, Check, Fault, off_only_where
from .cases import RANDOM_CASES, Args, around

Pose = tuple[float, float, float]

REACH_UNDECIDED = 1e-4  # m: outlines' places whose nearest point is as far as the reach, to this, are left out


def pose_after(pose: Pose, left: float, right: float, seconds: float) -> Floats:
    """Return the pose after the wheels have turned for a while, shape (3,)."""
    return moved(pose, (left, right), seconds)


def _drives(rng: np.random.Generator) -> Iterator[Args]:
    """Yield a straight way, a turn on the spot, standing still, an arc, then any speeds from any pose."""
    yield (0.0, 0.0, 0.0), 2.0, 2.0, 1.0
    yield (0.0, 0.0, 0.0), -1.0, 1.0, 0.5
    yield (0.1, 0.2, 0.5), 0.0, 0.0, 1.0
    yield (0.0, 0.0, 0.0), 2.0, 4.0, 1.0
    yield (0.1, -0.2, np.pi / 2), 3.0, 3.0, 2.0
    yield (0.0, 0.0, 0.0), 2.0, 2.01, 3.0  # nearly straight is not straight
    for n in range(RANDOM_CASES):
        left, right = rng.uniform(-FASTEST, FASTEST, 2).tolist()
        pose = (*rng.uniform(-0.4, 0.4, 2).tolist(), float(rng.uniform(-np.pi, np.pi)))
        yield pose, left, left if n % 5 == 0 else right, float(rng.uniform(0.1, 3.0))


def _straight(share: float) -> Callable[..., Floats]:
    """Return a faulty step: the length of the arc straight on, in a heading ``share`` of the turn on from the old."""

    def step(pose: Pose, left: float, right: float, seconds: float) -> Floats:
        turn = WHEEL * (right - left) / AXLE * seconds
        way, bearing = WHEEL * (left + right) / 2 * seconds, pose[2] + share * turn
        return np.array([pose[0] + way * np.cos(bearing), pose[1] + way * np.sin(bearing), pose[2] + turn])

    return step


def _speeds(change: Callable[[float, float], tuple[float, float]]) -> Callable[..., Floats]:
    """Return a faulty step: the right one at another mean, and half difference, of the wheels' speeds."""

    def step(pose: Pose, left: float, right: float, seconds: float) -> Floats:
        mean, half = change((left + right) / 2, (right - left) / 2)
        return pose_after(pose, mean - half, mean + half, seconds)

    return step


def _pieces(cases: list[Case]) -> bool:
    """Tell whether straight ways and headings are right, and arcs end beside the right place, but not far from it."""
    for case in cases:
        values = np.asarray(case.got, dtype=float) if case.off is None or case.off[:2] in ("x:", "y:") else None
        if values is None:
            return False
        beside = np.hypot(*(values[:2] - case.expected[:2]))
        chord = np.hypot(*(case.expected[:2] - case.args[0][:2]))
        turned = abs(case.args[2] - case.args[1]) > judges.CLOSE
        if not beside <= (chord / 2 if turned else judges.CLOSE) + judges.CLOSE:
            return False
    return True


drive_step = Check(
    "drive_step",
    pose_after,
    _drives,
    judges.pose(),
    (
        Fault(
            "Every arc is right. When both wheels turn equally fast, w is 0 and there is no circle: go straight on.",
            when=off_only_where(lambda case: case.args[1] == case.args[2]),
            name="w of zero",
        ),
        Fault(
            "The robot goes straight in its old heading and turns afterwards: it turns while it goes.",
            like=_straight(0.0),
            name="straight, then turned",
        ),
        Fault(
            "The robot turns first and goes straight in its new heading: it turns while it goes.",
            like=_straight(1.0),
            name="turned, then straight",
        ),
        Fault(
            "The direction is right, midway between both headings; but the straight line is shorter than the arc.",
            like=_straight(0.5),
            name="the arc's length for the chord's",
        ),
        Fault(
            "It turns the wrong way: a faster right wheel turns the robot to the left, counter-clockwise.",
            like=_speeds(lambda mean, half: (mean, -half)),
            name="left for right",
        ),
        Fault(
            "Wheel speeds are in rad/s: times the wheel's radius R they are metres per second.",
            like=_speeds(lambda mean, half: (mean / WHEEL, half / WHEEL)),
            name="no wheel radius",
        ),
        Fault(
            "It turns too little: the difference of both wheels' ways is divided by the axle A.",
            like=_speeds(lambda mean, half: (mean, half * AXLE)),
        ),
        Fault(
            "It goes twice as far: the middle of the axle has the mean of both speeds.",
            like=_speeds(lambda mean, half: (2 * mean, half)),
        ),
        Fault(
            "The step is that of a robot that looks along x: turn it by the old heading first.",
            like=lambda pose, *others: np.asarray(pose) + pose_after((0.0, 0.0, 0.0), *others),
            name="not turned by the old heading",
        ),
        Fault(
            "The place is right, the heading is the old one: add the turn.",
            like=lambda pose, *others: [*pose_after(pose, *others)[:2], pose[2]],
        ),
        Fault(
            "That is the pose after a fixed time: multiply by the time that is given.",
            like=(
                lambda pose, left, right, _seconds: pose_after(pose, left, right, 1.0),
                lambda pose, left, right, _seconds: pose_after(pose, left, right, 0.1),
            ),
            name="time left out",
        ),
        Fault(
            "That is a place: a pose has a heading as well.",
            when=lambda cases: all("of shape (2,)" in (case.off or "") for case in cases),
            name="no heading",
        ),
        Fault(
            "It is nearly right, as a way cut into straight pieces is: that never gets exact. The arc is one step.",
            when=_pieces,
            name="straight pieces",
        ),
    ),
)


# --- what was seen ----------------------------------------------------------------------------------------------


def share_near(outline: Floats, points: Floats, reach: float) -> float:
    """Return the share of the outline's places that have a point within reach."""
    return float(np.mean(_nearest(outline, points) <= reach))


def _nearest(outline: Floats, points: Floats, order: float | None = None) -> Floats:
    """Return the distance of each place to its nearest point, shape (N,), metres; inf without points."""
    nearest: Floats = np.linalg.norm(outline[:, None] - points, order, axis=2).min(axis=1, initial=np.inf)
    return nearest


def _drawn_outlines(rng: np.random.Generator) -> Iterator[Args]:
    """Yield half of a wall, a wall without points, one point for two places, then arcs of circles with strays."""
    wall = np.column_stack([np.linspace(0, 0.3, 4), np.zeros(4)])
    yield wall, wall[:2] + np.array([0.0, 0.002]), 0.012
    yield wall, np.empty((0, 2)), 0.012
    yield wall, np.vstack([wall[:1]] * 5), 0.012
    yield np.array([(0.0, 0.0), (0.01, 0.0)]), np.array([(0.005, 0.001)]), 0.012
    yield np.array([(0.0, 0.0), (0.0, 0.25)]), np.array([(0.125, 0.0)]), 0.125  # exactly as far as the reach
    yield np.array([(0.0, 0.0)]), np.array([(0.011, 0.011)]), 0.012  # within reach along x and along y, but not away
    for n in range(RANDOM_CASES):
        center, radius, reach = rng.uniform(-0.3, 0.3, 2), rng.uniform(0.05, 0.15), float(rng.uniform(0.005, 0.02))
        bearings = np.linspace(0, 2 * np.pi, int(rng.integers(20, 80)), endpoint=False)
        ring = around(center, radius, bearings)
        on_arc = rng.uniform(0, rng.uniform(0.5, 6.3), int(rng.integers(0, 30)))
        points = around(center, radius + rng.normal(0, 0.004, len(on_arc)), on_arc)
        together = np.vstack([points, rng.uniform(-0.5, 0.5, (n % 7, 2))])  # with strays
        clear = np.abs(_nearest(ring, together) - reach) > REACH_UNDECIDED
        if clear.any():
            yield ring[clear], together, reach


def _per_point(outline: Floats, points: Floats, reach: float) -> float:
    """Return the share of the points that lie near the outline."""
    return share_near(points, outline, reach) if len(points) else 0.0


def _pairs(outline: Floats, points: Floats, reach: float) -> float:
    """Return the share of all pairs that are near to each other."""
    near = np.linalg.norm(outline[:, None] - points, axis=2) <= reach
    return float(near.mean()) if near.size else 0.0


share_seen = Check(
    "share_seen",
    share_near,
    _drawn_outlines,
    judges.number(),
    (
        Fault(
            "Everything is right but this: of an outline without any points nothing is seen, 0.",
            when=off_only_where(lambda case: len(case.args[1]) == 0),
        ),
        Fault(
            "That is the share of points near the outline: ask for each place of the outline instead.",
            like=_per_point,
            name="points for places",
        ),
        Fault(
            "Ten points at one place show one place: count places, not points.",
            like=lambda outline, points, reach: _per_point(outline, points, reach) * len(points) / len(outline),
            name="points for places",
        ),
        Fault("That is the share of all pairs: for a place, one near point is enough.", like=_pairs),
        Fault(
            "That reach is a square: take the distance, not |dx| and |dy| apart.",
            like=lambda o, p, reach: float(np.mean(_nearest(o, p, np.inf) <= reach)),
        ),
        Fault(
            "The squared distance is compared with the reach: is a root missing?",
            like=lambda o, p, reach: share_near(o, p, reach**0.5),
        ),
        Fault(
            "That is how many, not which share: divide by the number of places.",
            like=lambda *args: share_near(*args) * len(args[0]),
            name="a count for a share",
        ),
        Fault("That is per cent: a share goes from 0 to 1.", like=lambda *args: 100 * share_near(*args)),
        Fault(
            "That is the part that was missed: 1 minus what is asked for.",
            like=lambda *args: 1 - share_near(*args),
            name="missed for seen",
        ),
    ),
)
