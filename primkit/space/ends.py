"""Ends: where a cylinder's caps and a box's faces are, as the beams that hit and those that missed tell.

In:  a solid near its solution, ``Beams``, and the ground.
Out: for each end its mean and variance, and the interval that it lies in.

A beam that just hit says that the solid goes so far, one that just missed that it goes no farther: the likelihood of an
end is a stair, and flat between. So it is summed up, not climbed: mean, variance and quantiles over one end at a time,
the others held. An end that may as well lie on the ground lies on it: nothing hovers a hand's breadth above.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arguments import Bools, Floats, Ints
from .along_beam import Beams, log_likelihoods
from .solids import Plane, Solid, first_of

FAR_OUT, MOST_LESS = 100.0, 0.95  # m: so far out an end is what is nearest; share of a size that may be taken away
FIRST_END = {"sphere": 4, "cylinder": 5, "box": 3}  # of a solid's numbers; the low ends stand before the high ones
FARTHEST_END = 0.6  # m from where it is supposed
FACES_GROUND, NEARLY_LEVEL = 0.05, 0.9998  # cosines of an end's slope: it faces the ground at all, it is level
FINEST_END, LOOK_STEPS = 1e-4, 16  # m; steps to each side, each longer by the same factor
FINE_STEPS, ZOOMS = 33, 2
UNLIKELY = 9.0  # in log likelihood below the best: out of question
SHARE_OUTSIDE = 0.02  # of the probability, of the interval that is told


@dataclass(frozen=True, eq=False)
class End:
    """By how much a solid should grow at one end: mean, standard deviation, and the interval that holds it, metres.

    ``slope``, shape (numbers,), is by how much it grows there, where the beams that tell of it pass, as each number
    does: a turn moves an end far from the middle as well. ``unbounded``: no beam ends the interval.
    """

    growth: float
    std: float
    between: tuple[float, float]
    slope: Floats
    on_ground: bool = False
    unbounded: bool = False


def outward(solid: Solid, k: int) -> float:
    """Return 1 when a solid grows at the end with number k as the number does, and -1 when it shrinks."""
    first = FIRST_END[solid.kind]
    return 1.0 if k - first >= (solid.numbers - first) // 2 else -1.0


def grown(solid: Solid, ends: dict[int, End] | None = None, known: float = 0.0) -> Solid:
    """Return the solid ``FARTHEST_END`` longer at each end, or at those that are known worse than ``known``, metres."""
    step = np.zeros(solid.numbers)
    for k in range(FIRST_END[solid.kind], solid.numbers):
        step[k] = outward(solid, k) * FARTHEST_END * (ends is None or ends[k].std > known)
    return solid.moved(step)


def end_of(solid: Solid, k: int, beams: Beams, ground: Plane | None) -> End:
    """Return where the end with number k is, all others as they are."""
    j = (k - FIRST_END["box"]) % 3 if solid.kind == "box" else 2  # the axis that the end lies across
    normal, slope = outward(solid, k) * solid.frame[j], outward(solid, k) * np.eye(solid.numbers)[k]
    least, most, contact = -2 * solid.half[j] * MOST_LESS, FARTHEST_END, np.inf
    if ground is not None:
        contact = max(to_ground(solid, normal, ground), 0.0)
        most = min(most, contact)
    # A solid is what all else leaves of a beam, cut off by the plane of this end.
    enters, leaves = solid.moved(FARTHEST_END * slope).chord(beams.origins, beams.directions)
    away, start = beams.directions @ normal, (beams.origins - solid.center) @ normal

    def ranges(growth: Floats, which: Bools | Ints | slice) -> Floats:
        a, first, last = away[which], enters[which], leaves[which]
        with np.errstate(divide="ignore", invalid="ignore"):
            cut = (solid.half[j] + growth[:, None] - start[which]) / a
        return first_of(np.where(a < 0, np.maximum(first, cut), first), np.where(a > 0, np.minimum(last, cut), last))

    wide, narrow = ranges(np.array([most, least]), slice(None))
    changing = wide != narrow  # growth only brings ranges nearer: these alone tell of this end
    told = beams[changing]
    if not changing.any():
        std = float((most - least) / np.sqrt(12))
        return End((least + most) / 2, std, (least, most), slope, unbounded=most == FARTHEST_END)

    look = FINEST_END * (FARTHEST_END / FINEST_END) ** (np.arange(LOOK_STEPS) / (LOOK_STEPS - 1))
    steps = np.unique(np.clip(np.concatenate([-look, [0.0], look]), least, most))
    value = log_likelihoods(ranges(steps, changing), told).sum(axis=1)
    which = np.flatnonzero(changing)
    for _ in range(ZOOMS):
        likely = np.flatnonzero(value > value.max() - UNLIKELY)
        steps = np.linspace(steps[max(likely[0] - 1, 0)], steps[min(likely[-1] + 1, len(steps) - 1)], FINE_STEPS)
        nearest, farthest = ranges(steps[[-1, 0]], which)
        which = which[nearest != farthest]  # the others say the same of all these steps
        value = log_likelihoods(ranges(steps, which), beams[which]).sum(axis=1)
    p = np.exp(value - value.max())
    inside = steps[p > np.exp(-UNLIKELY)].tolist()
    if most == contact and inside[-1] == most and ground is not None:
        slope = slope if -normal @ ground.normal > NEARLY_LEVEL else lowest_point(solid, -ground.normal)
        return End(most, 0.0, (inside[0], most), slope, on_ground=True)
    p /= p.sum()
    mean = float(p @ steps)
    std = float(np.sqrt(p @ (steps - mean) ** 2 + (steps[1] - steps[0]) ** 2 / 12))
    low, high = np.interp([SHARE_OUTSIDE / 2, 1 - SHARE_OUTSIDE / 2], np.cumsum(p), steps).tolist()
    # A beam is lost where this end leaves nothing of its way through all else: those next to it tell where.
    last = np.where(away < 0, leaves, enters)[changing]
    lost = start[changing] + away[changing] * last - solid.half[j]
    beside = [np.where(side, np.abs(lost - mean), np.inf).argmin() for side in (lost < mean, lost >= mean)]
    there = (told.origins + last[:, None] * told.directions)[beside].mean(axis=0)
    slope = solid.speeds((there + FAR_OUT * normal)[None])[1][0]
    return End(mean, std, (low, high), slope, unbounded=most == FARTHEST_END == inside[-1])


def to_ground(solid: Solid, normal: Floats, ground: Plane) -> float:
    """Return by how much an end must grow until the solid touches the ground, metres; inf when it never does.

    An end that is level, or nearly, lies on the ground with its middle: its slope may be an error.
    """
    down = -float(normal @ ground.normal)
    if down <= FACES_GROUND:
        return np.inf
    reach = float(np.abs(solid.frame @ normal) @ solid.half) if down > NEARLY_LEVEL else solid.reach(ground.normal)
    return (float(ground.signed_distance(solid.center[None])[0]) - reach) / down


def lowest_point(solid: Solid, down: Floats) -> Floats:
    """Return by how much the point of a cylinder or box that lies farthest down goes down as each number grows."""
    c = solid.frame @ down
    ways = np.diag(c) if solid.kind == "box" else np.array([[c[0], c[1], 0.0], [0.0, 0.0, c[2]]])
    shares = np.linalg.norm(ways, axis=1)
    normals = ways / np.maximum(shares, np.finfo(float).tiny)[:, None]  # of the faces that meet there, outwards
    beyond = (normals * solid.half).sum(axis=0) + FAR_OUT * normals
    slope: Floats = shares @ solid.speeds(solid.center + beyond @ solid.frame)[1]
    return slope
