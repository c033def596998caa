"""Poses: which readings are hits, how far these lie from their walls, the step that mends a pose; lesson 10's checks.

In:  the student's ``clean_ranges(ranges, range_min, range_max)``, ``wall_residuals(pose, hits, normals, offsets)`` and
     ``newton_step(guess, hits, normals, offsets)``.
Out: answers. A heading is right up to whole turns, and a Jacobian by differences is as good as one by hand.

>>> newton_step(lambda guess, hits, normals, offsets: ...)
○ not attempted: newton_step still returns `...`.
>>> clean_ranges.reference(np.array([0.3, 0.0, np.nan, 65.535]), 0.05, 0.7).tolist()
[0.3, inf, inf, inf]
>>> ahead, wall = np.array([[0.4, 0.0]]), np.array([[1.0, 0.0]])
>>> wall_residuals.reference(np.zeros(3), ahead, wall, np.array([0.5])).round(3).tolist()
[-0.1]
>>> newton_step.reference(np.zeros(3), ahead, wall, np.array([0.5])).round(3).tolist()
[0.1, 0.0, 0.0]

Source: ``lidar.as_ranges`` and ``driving.one_pose``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from ..arguments import Bools, Floats
from ..driving.one_pose import off_walls, slopes, turned, wall_step
from ..lidar import as_ranges
from . import judges
from .answer import Check, Fault, off_only_where
from .cases import RANDOM_CASES, Args, random_cases

STEP_CLOSE = 1e-5  # m or rad: what a Jacobian by differences may cost
MANY_STEPS = 8
POSE_CASES = 100  # each needs a matrix
MOST_SKEWED = 50.0  # condition of a Jacobian, from which on walls hardly tell a pose


# --- which readings are hits --------------------------------------------------------------------------------------


def hits_only(ranges: Floats, range_min: float, range_max: float) -> Floats:
    """Return the ranges with inf in the place of all that is no hit, shape (B,)."""
    return as_ranges(ranges, range_max, range_min)


def _readings(rng: np.random.Generator) -> Iterator[Args]:
    """Yield each word of a driver alone, the limits, then whole scans; some sensors have no minimum."""
    yield np.array([0.3, 0.0, 0.4]), 0.05, 0.7
    yield np.array([0.3, np.nan, 0.4]), 0.05, 0.7
    yield np.array([0.3, 65.535, 0.4]), 0.05, 0.7
    yield np.array([0.3, 0.02, 0.4]), 0.05, 0.7
    yield np.array([0.25, 0.5]), 0.25, 0.75  # the least range that is measured
    yield np.array([0.25, 0.75]), 0.125, 0.75  # the greatest
    yield np.array([0.3, np.inf, -np.inf, -1.0]), 0.05, 0.7
    yield np.array([0.0, 0.3]), 0.0, 0.7
    for n in range(RANDOM_CASES):
        low, high = (0.0 if n % 5 == 0 else float(rng.uniform(0.02, 0.2))), float(rng.uniform(0.5, 4.0))
        ranges = rng.uniform(0.0, 1.2 * high, int(rng.integers(5, 40)))
        words = rng.choice([0.0, np.nan, low, high, 65.535, -1.0, np.inf], len(ranges))
        yield np.where(rng.uniform(size=len(ranges)) < 0.3, words, ranges), low, high


def _kept(rule: Callable[[Floats, float, float], Bools], none: float = np.inf) -> Callable[..., Floats]:
    """Return a faulty cleaning: readings for which a rule holds, and something for the others."""
    return lambda ranges, low, high: np.where(rule(ranges, low, high), ranges, none)


def _is_hit(ranges: Floats, low: float, high: float) -> Bools:
    return np.isfinite(as_ranges(ranges, high, low))


clean_ranges = Check(
    "clean_ranges",
    hits_only,
    _readings,
    judges.array("m"),
    (
        Fault(
            "Everything is right but this: a sensor that has no least range still writes 0 when nothing came back.",
            when=off_only_where(lambda case: case.args[1] == 0),
            name="0 where there is no minimum",
        ),
        Fault(
            "A 0 is kept: so drivers say that nothing came back. It would be a hit in the robot itself.",
            like=_kept(lambda r, low, high: (r == 0) | _is_hit(r, low, high)),
            name="0 is a hit",
        ),
        Fault(
            "NaN is kept: it is neither below nor above anything. Ask what is a hit, not what is none.",
            like=(
                _kept(lambda r, low, high: np.isnan(r) | _is_hit(r, low, high)),
                _kept(lambda r, low, high: ~((r < low) | (r >= high))),
            ),
            name="NaN is a hit",
        ),
        Fault(
            "The greatest range itself is kept: drivers write it when nothing came back.",
            like=_kept(lambda r, low, high: (r == high) | _is_hit(r, low, high)),
            name="the maximum is a hit",
        ),
        Fault(
            "Readings beyond the greatest range are kept.",
            like=_kept(lambda r, low, _high: (r > 0) & (r >= low) & (r < np.inf)),
            name="beyond the maximum",
        ),
        Fault(
            "Readings below the least range are kept: the sensor does not stand by them.",
            like=_kept(lambda r, _low, high: (r > 0) & (r < high)),
            name="below the minimum",
        ),
        Fault(
            "The least range itself is a hit: it is the least that the sensor does measure.",
            like=_kept(lambda r, low, high: (r > low) & (r < high)),
            name="the minimum is no hit",
        ),
        Fault(
            "A beam without a hit gets the greatest range: that invents a wall there. No hit is inf.",
            like=(
                lambda r, low, high: np.where(_is_hit(r, low, high), r, high),
                lambda r, low, high: np.clip(np.nan_to_num(r, nan=high, posinf=high), low, high),
            ),
            name="the maximum for no hit",
        ),
        Fault(
            "The right ones are hits; but for all others write inf, as everywhere in this course.",
            like=(_kept(_is_hit, 0.0), _kept(_is_hit, np.nan), _kept(_is_hit, -1.0)),
            name="another word for no hit",
        ),
        Fault(
            "Beams are left out: beam k must stay beam k, for its bearing is told by its place.",
            like=lambda r, low, high: r[_is_hit(r, low, high)],
            name="beams left out",
        ),
    ),
)


# --- how far hits lie from their walls ----------------------------------------------------------------------------


def _any_hits(rng: np.random.Generator) -> Iterator[Args]:
    """Yield a robot that looks at a wall, one that stands elsewhere, one that is turned, then any with any walls."""
    ahead, wall, at = np.array([[0.4, 0.0]]), np.array([[1.0, 0.0]]), np.array([0.5])
    yield np.array([0.0, 0.0, 0.0]), ahead, wall, at
    yield np.array([0.1, 0.2, 0.0]), ahead, wall, at  # on the wall
    yield np.array([0.2, 0.0, 0.0]), ahead, wall, at  # beyond it
    yield np.array([0.0, 0.0, np.pi / 2]), ahead, wall, at
    yield np.array([0.0, 0.0, np.pi / 2]), ahead, np.array([[0.0, 1.0]]), at
    yield np.array([0.1, 0.0, 0.0]), np.array([[0.4, 0.1], [0.4, -0.1]]), np.vstack([wall, wall]), np.array([0.5, 0.4])
    yield from random_cases(lambda _: _seen(rng))


def _seen(rng: np.random.Generator, walls: int = 3) -> Args:
    """Return a pose that is off, and hits on some walls as they are seen from where the robot is, with noise."""
    true = np.array([*rng.uniform(-0.3, 0.3, 2), rng.uniform(-np.pi, np.pi)])
    bearings = rng.uniform(-np.pi, np.pi) + np.arange(walls) * rng.uniform(0.8, 1.6)
    which = np.concatenate([np.arange(walls), rng.integers(0, walls, int(rng.integers(3, 20)))])
    normals = np.column_stack([np.cos(bearings), np.sin(bearings)])[which]
    offsets = rng.uniform(0.3, 0.6, walls)[which]
    along = rng.uniform(-0.4, 0.4, len(which))[:, None] * (normals[:, ::-1] * [-1, 1])
    hits = turned(offsets[:, None] * normals + along - true[:2], -true[2]) + rng.normal(0, 0.003, (len(which), 2))
    return true + rng.uniform(-1, 1, 3) * [0.05, 0.05, 0.2], hits, normals, offsets


def _placed_by(place: Callable[[Floats, Floats], Floats]) -> Callable[..., Floats]:
    """Return faulty residuals: the right ones of hits at other places."""
    return lambda pose, hits, *walls: off_walls(np.zeros(3), place(pose, hits), *walls)


wall_residuals = Check(
    "wall_residuals",
    off_walls,
    _any_hits,
    judges.array("m"),
    (
        Fault(
            "The absolute value is too much: on which side of the wall a hit lies tells which way to go.",
            like=lambda *args: np.abs(off_walls(*args)),
            name="no sign",
        ),
        Fault(
            "The sign is the other way round: n . p - d, so that what lies beyond the wall is positive.",
            like=lambda *args: -off_walls(*args),
            name="d - n . p",
        ),
        Fault(
            "The hits are taken as if the robot looked along x: turn them by its heading first.",
            like=_placed_by(lambda pose, hits: pose[:2] + hits),
            name="not turned by the heading",
        ),
        Fault(
            "The hits are turned the wrong way: counter-clockwise, by the heading.",
            like=_placed_by(lambda pose, hits: pose[:2] + turned(hits, -pose[2])),
            name="turned the wrong way",
        ),
        Fault(
            "The hits are turned, but not moved to where the robot stands.",
            like=_placed_by(lambda pose, hits: turned(hits, pose[2])),
            name="place left out",
        ),
        Fault(
            "First the place is added, then all is turned: that turns the robot about the middle of the arena.",
            like=_placed_by(lambda pose, hits: turned(hits + pose[:2], pose[2])),
            name="moved, then turned",
        ),
        Fault(
            "That is how far a hit lies along the normal from the origin: the wall is at d.",
            like=lambda pose, hits, normals, offsets: off_walls(pose, hits, normals, 0 * offsets),
            name="offset left out",
        ),
        Fault(
            "That is each hit against every wall: hit k belongs to wall k alone.",
            like=lambda pose, hits, n, d: (pose[:2] + turned(hits, pose[2])) @ n.T - d,
            name="all pairs",
        ),
        Fault(
            "The squares are taken too early: the step needs the residuals themselves.",
            like=(lambda *args: off_walls(*args) ** 2, lambda *args: float(np.sum(off_walls(*args) ** 2))),
            name="squares",
        ),
    ),
)


# --- the step -----------------------------------------------------------------------------------------------------


def _slipped(rng: np.random.Generator) -> Iterator[Args]:
    """Yield a wall ahead and a corner, two parallel walls, nothing, then three to five walls at any bearing."""
    corner, hits = np.array([[1.0, 0.0], [1.0, 0.0], [0.0, 1.0]]), np.array([[0.4, 0.0], [0.4, 0.1], [0.0, 0.5]])
    yield np.array([0.0, 0.0, 0.0]), hits, corner, np.array([0.5, 0.5, 0.5])
    yield np.array([0.02, -0.01, 0.1]), hits, corner, np.array([0.4, 0.4, 0.5])
    sides = np.array([[0.0, 1.0], [0.0, 1.0], [0.0, -1.0], [0.0, -1.0]])
    aside = np.array([[0.2, 0.3], [-0.2, 0.3], [0.2, -0.3], [-0.2, -0.3]])
    yield np.array([0.1, 0.05, 0.0]), aside, sides, np.full(4, 0.3)  # where along them, they do not tell
    yield np.array([0.1, 0.05, 0.2]), np.empty((0, 2)), np.empty((0, 2)), np.empty(0)

    def draw(n: int) -> Args | None:
        pose, seen, normals, offsets = _seen(rng, 3 + n % 3)
        skewed = np.linalg.cond(slopes(turned(seen, pose[2]), normals)) > MOST_SKEWED
        return None if skewed else (pose, seen, normals, offsets)

    yield from random_cases(draw, POSE_CASES)


def _tells_all(args: Args) -> bool:
    """Tell whether the walls tell the whole pose."""
    pose, hits, normals, _ = args
    return len(hits) > 2 and bool(np.linalg.matrix_rank(slopes(turned(hits, pose[2]), normals)) == 3)


def _with(jacobian: Callable[[Floats, Floats, Floats], Floats]) -> Callable[..., Floats]:
    """Return a faulty step: the right one with another Jacobian, of pose, hits and normals."""

    def step(pose: Floats, hits: Floats, normals: Floats, offsets: Floats) -> Floats:
        off = off_walls(pose, hits, normals, offsets)
        moved = np.linalg.lstsq(jacobian(pose, hits, normals), off, rcond=None)[0]
        return pose - np.append(moved, np.zeros(3 - len(moved))).astype(float)

    return step


def _many(*args: Floats) -> Floats:
    pose, *seen = args
    for _ in range(MANY_STEPS):
        pose = wall_step(pose, *seen)
    return pose


newton_step = Check(
    "newton_step",
    wall_step,
    _slipped,
    judges.pose(STEP_CLOSE),
    (
        Fault(
            "Right wherever the walls tell the whole pose. Parallel ones, or none, leave a direction open, and the "
            "matrix has no inverse: np.linalg.lstsq then takes the smallest of all best steps.",
            when=off_only_where(lambda case: not _tells_all(case.args)),
            name="no inverse",
        ),
        Fault(
            "It goes uphill: the residuals grow. Subtract the step.",
            like=lambda pose, *seen: 2 * pose - wall_step(pose, *seen),
            name="uphill",
        ),
        Fault(
            "That is the step alone: return the pose after it.",
            like=(
                lambda pose, *seen: wall_step(pose, *seen) - pose,
                lambda pose, *seen: pose - wall_step(pose, *seen),
            ),
            name="the step alone",
        ),
        Fault(
            "That is one step down the slope, J'r. Gauss and Newton ask how long it must be: solve J'J step = J'r.",
            like=lambda pose, hits, n, d: pose - slopes(turned(hits, pose[2]), n).T @ off_walls(pose, hits, n, d),
            name="down the slope",
        ),
        Fault(
            "The place is mended, and the heading is not: the third column tells how a turn moves each hit.",
            like=_with(lambda _pose, _hits, normals: normals),
            name="heading left out",
        ),
        Fault(
            "In the third column the hits are those that the robot sees: turn them by its heading first.",
            like=_with(lambda _pose, hits, normals: slopes(hits, normals)),
            name="arms not turned",
        ),
        Fault(
            "The third column turns the arena about its middle: the robot turns about itself. Take its place off.",
            like=_with(lambda pose, hits, normals: slopes(pose[:2] + turned(hits, pose[2]), normals)),
            name="turned about the origin",
        ),
        Fault(
            "The third column is n . arm: a turn moves a hit across its arm, not along it.",
            like=_with(
                lambda pose, hits, n: np.column_stack([n, np.einsum("nk,nk->n", n, turned(hits, pose[2]))]),
            ),
            name="along the arm",
        ),
        Fault(
            "The sign of the third column is wrong: counter-clockwise, the arm (x, y) moves towards (-y, x).",
            like=_with(lambda pose, hits, n: slopes(turned(hits, pose[2]), n) * [1, 1, -1]),
            name="turned the wrong way",
        ),
        Fault(
            "That is where many steps lead: one is asked for, because the walls are sorted anew after each.",
            like=_many,
            name="many steps",
        ),
    ),
)
