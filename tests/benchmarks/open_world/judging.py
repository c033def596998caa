"""Judging: what of a finding is right, what is sure and wrong, and whether all points are in it.

>>> square = pk.Polygon([(0, 0), (0.1, 0), (0.1, 0.1), (0, 0.1)])
>>> (one,) = pk.find_shapes(square.outline(300), rng=0)
>>> agrees(one, square), agrees(one, square.moved((0.01, 0)))
(True, False)
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

import primkit as pk
from primkit.found import Found
from primkit.shapes import Shape

Floats = np.ndarray
TOLERANCE = 0.005  # m
FEW = 0.005  # share of what may be sure and wrong
SIGMAS = 4.0


def agrees(one: pk.Detection, truth: Shape) -> bool:
    """Tell whether kind, number of corners, and all that is said to be measured are those of the truth.

    A number may be off by ``TOLERANCE``, or by ``SIGMAS`` of the deviations that are stated with it.
    """
    if not same_name(one.shape, truth):
        return False
    ours, std, theirs = (np.array(n) for n in (one.shape.dimensions, one.dimension_std, truth.dimensions))
    shifts = range(len(theirs)) if len(theirs) >= 3 else [0]  # sides from any corner on
    shift = min(shifts, key=lambda k: float(np.abs(np.roll(ours, k) - theirs).sum()))
    off = np.abs([*(np.roll(ours, shift) - theirs), *(one.shape.centroid - truth.centroid)])
    return bool((off <= np.maximum(TOLERANCE, SIGMAS * np.append(np.roll(std, shift), one.center_std))).all())


def same_name(found: Shape, true: Shape) -> bool:
    """Tell whether two shapes have the same kind and number of corners."""
    return found.kind == true.kind and len(found.dimensions) == len(true.dimensions)


def sure_and_wrong(found: Iterable[pk.Detection], truths: Iterable[Shape]) -> list[pk.Detection]:
    """Return what is certain and is none of the truths."""
    truths = list(truths)
    return [one for one in found if one.certain and not any(agrees(one, truth) for truth in truths)]


def own_of(found: Iterable[pk.Detection], shape: Shape, others: Iterable[Shape]) -> list[pk.Detection]:
    """Return those whose points lie nearer to this shape's outline than to any other's, most of them."""
    others = list(others)

    def nearer(points: Floats) -> bool:
        mine = np.abs(shape.signed_distance(points))
        theirs = np.min([np.abs(other.signed_distance(points)) for other in others], axis=0) if others else np.inf
        return bool(np.mean(mine <= theirs) > 0.5)

    return [one for one in found if nearer(one.points)]


def n_right(found: Iterable[pk.Detection], world: pk.World, tolerance: float = TOLERANCE, gate: float = 0.1) -> int:
    """Return how many true shapes were found with the right kind, centre and dimensions."""
    return sum(pair.all_right for pair in pk.evaluate(found, world, tolerance, gate=gate).matches)


def accounted(found: Found) -> Floats:
    """Return all points of a finding, shape (N, 2)."""
    parts = [one.points for one in (*found, *found.walls, *found.others)]
    return np.vstack([np.empty((0, 2)), *parts, found.strays])


def in_order(points: Floats) -> Floats:
    """Return points in the order of x and then y."""
    return points[np.lexsort((points[:, 1], points[:, 0]))]


def bits(found: Found) -> bytes:
    """Return every number of a finding, to the last bit."""
    numbers: list[object] = [found.strays, *(other.outline for other in found.others)]
    numbers += [(*wall.start, *wall.end) for wall in found.walls]
    for one in found:
        numbers += [one.shape.outline(7), one.shape.dimensions, one.rms, one.center_std, one.certain]
    return b"".join(np.asarray(each, dtype=float).tobytes() for each in numbers)
