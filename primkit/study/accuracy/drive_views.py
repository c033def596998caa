"""Drive views: the shapes that one drive saw in part, and what was made of them.

In:  the sensor's noise, the number of the drive, a seed.
Out: a ``View`` of each shape that was seen on 40 to 90 % of its outline.

>>> [(view.kind, view.found_as, round(view.seen, 2)) for view in views_from(0.0, 1)]
[('circle', 'circle', 0.9)]

The truth decides what was seen, and by other rules than the method's own. A shape counts by the share of its outline
that lies near a hit that a sensor without faults would have had. A side was never seen when no such hit lies on the
inner four fifths of it. A dimension hangs on the sides that it ends at: a rectangle's width on the two across, a side
of a triangle or pentagon on itself and on both neighbours, whose lines cut it off.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...arguments import Bools, Floats
from ...driving.wander import wander
from ...evaluation import match
from ...lidar import Lidar
from ...measure import Detection
from ...pipeline import ROBUST
from ...seen import share_seen
from ...shapes import Circle, Kind, Shape
from ..experiment import Experiment, run
from ..oracle import exact_hits
from .sweeps import UNTUNED, roomy_world

N_SHAPES = 4
DRIVING_GAP = 0.10  # m: gap between shapes, wide enough to drive through
N_SCANS = 60
PART_SEEN = (0.4, 0.9)  # share of the outline
INNER_SHARE = 0.8  # share of a side, in its middle, that decides whether it was ever seen


@dataclass(frozen=True)
class View:
    """What became of one shape that was seen in part.

    Parameters
    ----------
    drive : int
        Which drive it was seen from.
    kind : str
        What it is.
    found_as : str or None
        The kind of the shape that was found in its place; None where it was missed.
    seen : float
        The share of its outline that was seen.
    errors, stds : tuple of float
        found - true, and the stated standard deviation, of each dimension, metres; infinite: not measured.
        Without errors when it was found as another kind.
    hidden : tuple of bool
        Whether each of these dimensions hangs on a side that was never seen.
    whole : bool
        Whether all its sides were seen.
    """

    drive: int
    kind: Kind
    found_as: Kind | None
    seen: float
    errors: tuple[float, ...]
    stds: tuple[float, ...]
    hidden: tuple[bool, ...]
    whole: bool

    @property
    def measured(self) -> tuple[bool, ...]:
        """Which dimensions the method says that it measured."""
        return tuple(std < float("inf") for std in self.stds)

    @property
    def kind_right(self) -> bool:
        """Whether it was found as what it is."""
        return self.found_as == self.kind


def views_from(noise_std: float, number: int, seed: int = 0) -> list[View]:
    """Return what ``ROBUST`` made of the shapes that one random drive saw in part.

    Examples
    --------
    >>> [(view.kind, view.kind_right) for view in views_from(0.0, 3)]
    [('rectangle', True)]
    """
    world_rng, way_rng = np.random.default_rng([UNTUNED, seed, number, N_SCANS]).spawn(2)
    world = roomy_world(N_SHAPES, DRIVING_GAP, world_rng)
    drive = wander(world, N_SCANS, rng=way_rng)
    lidar = Lidar(noise_std=noise_std)
    done = run(Experiment(f"drive-{number + 1}", world, "ROBUST", ROBUST, lidar, seed=UNTUNED + seed, drive=drive))
    hits, owners = exact_hits(world, done.scans, lidar)
    pairs = {t: done.found[f] for f, t in match([d.shape for d in done.found], world.shapes)}
    views = []
    for i, shape in enumerate(world.shapes):
        own = owners[:, 0] == i
        seen = share_seen(shape, hits[own])
        if PART_SEEN[0] <= seen <= PART_SEEN[1]:
            views.append(view_of(number, shape, seen, unseen_sides(shape, hits[own], owners[own, 1]), pairs.get(i)))
    return views


def unseen_sides(shape: Shape, hits: Floats, sides: NDArray[np.int64]) -> Bools:
    """Tell which sides have no hit on their inner four fifths, shape (K,); a circle is one side.

    Parameters
    ----------
    shape : Circle or Polygon
        The truth.
    hits : array, shape (N, 2)
        Exact hits on its outline, metres.
    sides : array of int, shape (N,)
        Which side each lies on.

    Examples
    --------
    >>> from primkit.shapes import Polygon
    >>> triangle = Polygon([(0, 0), (0.1, 0), (0, 0.1)])
    >>> unseen_sides(triangle, np.array([(0.05, 0.0), (0.002, 0.098)]), np.array([0, 1])).tolist()
    [False, True, True]
    """
    if isinstance(shape, Circle):
        return np.array([len(hits) == 0])
    along = ((hits - shape.vertices[sides]) * shape.edges[sides]).sum(axis=1) / shape.sides[sides] ** 2
    inner = np.abs(along - 0.5) <= INNER_SHARE / 2
    return ~np.isin(np.arange(len(shape.vertices)), sides[inner])


def view_of(drive: int, shape: Shape, seen: float, unseen: Bools, found: Detection | None) -> View:
    """Return the view of one shape: its dimensions' errors and deviations, and which of them are hidden."""
    whole = not unseen.any()
    if found is None:
        return View(drive, shape.kind, None, seen, (), (), (), whole)
    if found.kind != shape.kind:
        return View(drive, shape.kind, found.kind, seen, (), found.dimension_std, (), whole)
    true, hidden = _paired(found.shape, shape, unseen)
    errors, flags = (np.array(found.shape.dimensions) - true).tolist(), hidden.tolist()
    return View(drive, shape.kind, found.kind, seen, tuple(errors), found.dimension_std, tuple(flags), whole)


def _paired(found: Shape, true: Shape, unseen: Bools) -> tuple[Floats, Bools]:
    """Return the true length of each dimension of a found shape of the same kind, and whether it is hidden.

    A rectangle's width and height are paired by direction, not by size; sides by the nearest corners.
    """
    if isinstance(found, Circle) or isinstance(true, Circle):
        return np.array(true.dimensions), unseen
    if len(true.vertices) == 4:
        lengths, hangs = (true.sides[:2] + true.sides[2:]) / 2, np.array([unseen[1] | unseen[3], unseen[0] | unseen[2]])
        first = found.edges[np.argmax(found.sides[:2] + found.sides[2:])]  # along the found width
        across = int(np.abs(true.edges[1] @ first) / true.sides[1] > np.abs(true.edges[0] @ first) / true.sides[0])
        order = [across, 1 - across]
        return lengths[order], hangs[order]
    k = len(true.vertices)
    turned = [(np.arange(k) + shift) % k for shift in range(k)]
    order_ = min(turned, key=lambda t: float(np.hypot(*(true.vertices[t] - found.vertices).T).sum()))
    hangs = np.roll(unseen, 1) | unseen | np.roll(unseen, -1)
    return true.sides[order_], hangs[order_]
