"""Measure: from the points of one cluster to a shape with its corners, its centre and its dimensions.

The best of the candidate explanations is taken; a bare wall is no shape.

In:  points of one cluster, shape (N, 2), metres.
Out: ``Detection``: the shape, its points, how closely they lie to it, and how clear the choice was; or ``None``.

>>> from primkit.shapes import Circle
>>> found = measure_shape(Circle((0.1, 0.2), 0.05).outline(60), spread=0.0005, rng=0)
>>> found.shape, found.margin > 100
(Circle(center=(0.1, 0.2), radius=0.05), True)
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from .arguments import Floats, Ints, as_points, as_positive
from .robust.candidates import candidates
from .robust.choice import Choice
from .robust.deviations import Certainty
from .robust.evidence import CERTAIN
from .robust.scatter import LEAST_SPREAD, noise_of
from .seen import seen_shares
from .shapes import Circle, Kind, Polygon, Shape
from .show import in_mm
from .table import count

CELL = 0.001  # m: side of a cell of the grid, when nothing else is said
ORIGIN_STEP = 1024  # cells: a board around the origin is worked on where it is
ON_CENTER = 1e-6  # cells: what is as near to a multiple of half a cell lies there, and the rest is rounding


@dataclass(frozen=True, eq=False)
class Frame:
    """Where and how large points are while they are worked on: all lengths of the method follow the cell.

    The unit is a thousand cells, so that on the usual grid it is a metre; the origin is near the points.

    Parameters
    ----------
    origin : array, shape (2,)
        Metres.
    unit : float
        Metres.

    Examples
    --------
    A board that is ten times as large, on cells ten times as large, is the same board:

    >>> points = np.array([(1.005, 2.015), (-0.165, 0.005)])
    >>> Frame.of(points, 0.01).local(points).round(9).tolist()
    [[0.1005, 0.2015], [-0.0165, 0.0005]]
    """

    origin: Floats
    unit: float

    @classmethod
    def of(cls, points: Floats, resolution: float) -> Frame:
        """Return the frame for points, shape (N, 2), metres, on cells of this side, metres."""
        step = ORIGIN_STEP * resolution
        middle = points.mean(axis=0) if len(points) else np.zeros(2)
        return cls(np.round(middle / step) * step, resolution / CELL)

    def local(self, points: Floats) -> Floats:
        """Return points, shape (N, 2), metres, in the frame; cells' centres are the same on every scale, to the bit."""
        if self.unit == 1 and not self.origin.any():
            return points
        cells = (points - self.origin) / (CELL * self.unit)
        halves = np.round(2 * cells) / 2
        return np.where(np.abs(cells - halves) <= ON_CENTER, halves, cells) * CELL

    def metres(self, local: Floats) -> Floats:
        """Return points of the frame, shape (N, 2), in metres."""
        return local * self.unit + self.origin


HERE = Frame(np.zeros(2), 1.0)  # the frame in which all was measured already


@dataclass(frozen=True, eq=False)
class Detection:
    """A shape that was found.

    Parameters
    ----------
    shape : Circle or Polygon
        The shape, metres, world frame.
    points : array, shape (N, 2)
        The points that lie on it, metres.
    rms : float
        Root mean square distance of those points from the outline, metres.
    count_margin : float
        How clear it is that this is one shape of its own: how much better that explains the points than the
        best grouping in which it is split, or merged with a neighbour, on the scale of ``margin``. Infinite when no
        other grouping came into question; NaN from ``PAPER``, which does not ask.
    seen : tuple of float
        The share of each side (or of the whole circle) that has points near it, 0 to 1.
    sure : Certainty or Choice, optional
        What tells how sure the shape's numbers are; None from ``PAPER``, which does not ask.
    choice : Choice, optional
        How the shape was chosen; None from ``PAPER``.
    frame : Frame
        The frame of ``choice``, and ``sure``.
    scans : array of int, shape (N,), optional
        The number of the scan that saw each of the points, 0 where it is not known; None where it is of none.
    noise_std : float
        By how much ranges err, as far as that was told, in the unit of the frame.
    told_margin : float
        The margin that somebody's own ``Steps.measure`` told; NaN from the library's.
    """

    shape: Shape
    points: Floats
    rms: float
    count_margin: float = float("nan")
    seen: tuple[float, ...] = ()
    sure: Certainty | Choice | None = field(default=None, repr=False)
    choice: Choice | None = field(default=None, repr=False)
    frame: Frame = field(default=HERE, repr=False)
    scans: Ints | None = field(default=None, repr=False)
    noise_std: float = field(default=0.0, repr=False)
    told_margin: float = field(default=float("nan"), repr=False)

    def in_metres(self, frame: Frame) -> Detection:
        """Return what was found in a frame, in metres."""
        shape, metres = self.shape, frame.metres
        if frame.unit == 1 and not frame.origin.any():
            return replace(self, frame=frame)
        if isinstance(shape, Circle):
            shape = Circle(metres(shape.center), shape.radius * frame.unit)
        else:
            shape = Polygon(metres(shape.vertices))
        return replace(self, shape=shape, points=metres(self.points), rms=self.rms * frame.unit, frame=frame)

    def __repr__(self) -> str:
        centre, dimensions = in_mm(self.shape, self.measured)
        at = f"{self.kind} at ({centre}) mm, {dimensions} mm"
        return f"Detection: {at}; {count(len(self.points), 'point')}, rms {1000 * self.rms:.2f} mm"

    @property
    def center_std(self) -> tuple[float, ...]:
        """Standard deviations of the centroid's x and y, metres; infinite when a side was never seen.

        1.96 of them on either side hold the truth in 95 of 100: they contain what points scatter, the cells' rounding
        and slips of the poses, see ``robust.covariance``.

        Like the next, it is worked out when it is asked for, and is empty from ``PAPER``, which does not ask.
        """
        return tuple(self.frame.unit * std for std in self._certainty.center_std)

    @property
    def dimension_std(self) -> tuple[float, ...]:
        """Standard deviation of each of ``shape.dimensions``, metres.

        Infinite for one that was not measured, because a side that it hangs on was never seen, or that is not even
        known to a centimetre.
        """
        return tuple(self.frame.unit * std for std in self._certainty.dimension_std)

    @cached_property
    def _certainty(self) -> Certainty:
        """How sure the numbers are; nothing where that is not asked."""
        if isinstance(self.sure, Choice):
            return self.sure.certainty(self.frame.local(self.points), self.scans, self.noise_std)
        return Certainty((), ()) if self.sure is None else self.sure

    @property
    def margin(self) -> float:
        """How much better this shape explains the points than the best rival: another kind, or an outline of none.

        Twice the logarithm of the Bayes factor; above 10 is very strong (Kass and Raftery, 1995). Infinite without a
        rival; NaN from ``PAPER``, which does not ask. Rivals that could not win are
        fitted now, when the margin is asked for: some 10 ms, once.
        """
        return self.told_margin if self.choice is None else self.choice.margin

    @property
    def certain(self) -> bool:
        """Whether the kind is beyond doubt and the points fit it: what is certain may be trusted. False from ``PAPER``.

        Rivals are all kinds, any outline of straight sides, and an outline that may bend anywhere. Of a ``measure`` of
        one's own the margin that it told is believed.
        """
        if self.choice is None:
            return self.told_margin >= CERTAIN
        return self.choice.certain and not self.count_margin < CERTAIN

    @property
    def kind(self) -> Kind:
        """The shape's kind."""
        return self.shape.kind

    @property
    def measured(self) -> tuple[bool, ...]:
        """Which of the shape's dimensions were measured, and not only supposed."""
        return tuple(std < float("inf") for std in self.dimension_std)


@dataclass(frozen=True, eq=False)
class Wall:
    """A straight piece that was seen from one side, and is no side of a shape as far as one can tell.

    Parameters
    ----------
    start, end : array, shape (2,)
        Where it begins and ends, as far as it was seen, metres.
    points : array, shape (N, 2)
        The points that lie on it, metres.
    std : float
        Standard deviation of its place across, in its middle, metres.
    ends_seen : tuple of bool
        Whether it ends at start, and at end, in a corner with another wall; else it is cut off there, and may go on.
    """

    start: Floats
    end: Floats
    points: Floats
    std: float
    ends_seen: tuple[bool, bool] = (False, False)

    @property
    def length(self) -> float:
        """From start to end, metres."""
        return float(np.hypot(*(self.end - self.start)))

    def in_metres(self, frame: Frame) -> Wall:
        """Return what was found in a frame, in metres."""
        start, end, points = (frame.metres(p) for p in (self.start, self.end, self.points))
        return replace(self, start=start, end=end, points=points, std=self.std * frame.unit)

    def __repr__(self) -> str:
        ends = [", ".join(f"{1000 * v + 0.0:.1f}" for v in end) for end in (self.start, self.end)]
        return f"Wall: ({ends[0]}) to ({ends[1]}) mm; {count(len(self.points), 'point')}"


@dataclass(frozen=True, eq=False)
class Other:
    """A thing that is none of the kinds: it is curved and no circle, or too small to tell.

    Parameters
    ----------
    points : array, shape (N, 2)
        Its points, metres.
    outline : array, shape (K, 2)
        Corners of straight pieces through them, metres.
    """

    points: Floats
    outline: Floats

    def in_metres(self, frame: Frame) -> Other:
        """Return what was found in a frame, in metres."""
        return Other(frame.metres(self.points), frame.metres(self.outline))

    def __repr__(self) -> str:
        x, y = 1000 * self.points.mean(axis=0)
        return f"Other: at ({x:.1f}, {y:.1f}) mm; {count(len(self.points), 'point')}"


Thing = Detection | Wall | Other


def measure_shape(
    points: ArrayLike,
    spread: float,
    *,
    resolution: float = CELL,
    rng: int | np.random.Generator | None = None,  # noqa: ARG001
) -> Detection | None:
    """Return the shape that explains the points of one cluster best.

    Parameters
    ----------
    points : array_like, shape (N, 2)
        Metres; a few may belong to nothing.
    spread : float
        Standard deviation of the points from the outline, metres; see ``spread_of``.
    resolution : float
        Side of the cells that the points lie on, metres.
    rng : int or numpy.random.Generator, optional
        Not used: nothing is drawn. It is there so that every step of the story can be called alike.

    Returns
    -------
    Detection or None
        None when there are fewer than eight different points, or a bare wall explains them as well.

    Raises
    ------
    ValueError
        If points are not finite (N, 2), the spread is negative, or the resolution not above zero.

    Examples
    --------
    A straight wall is no shape:

    >>> measure_shape([(x / 100, 0) for x in range(20)], spread=0.001, rng=0) is None
    True
    """
    points, spread = as_points(points), as_positive(spread, "spread", zero=True)
    frame = Frame.of(points, as_positive(resolution, "resolution"))
    local, spread = frame.local(points), max(LEAST_SPREAD, spread / frame.unit)
    found = as_detection(Choice(local, candidates(local, spread), spread))
    return None if found is None else replace(found.in_metres(frame), noise_std=noise_of(spread))


def as_detection(choice: Choice) -> Detection | None:
    """Return the best candidate with those of the points that lie on it; None when it is no shape."""
    if choice.shape is None or not choice.on_it.any():
        return None
    points, rms = choice.points[choice.on_it], _rms(choice.distance[choice.on_it])
    return Detection(choice.shape, points, rms, seen=choice.ranked[0].seen, sure=choice, choice=choice)


def detection(shape: Shape, points: Floats, reach: float) -> Detection:
    """Return the shape with those of the points that lie within ``reach`` metres of its outline."""
    distance = shape.signed_distance(points)
    on_it = np.abs(distance) <= reach
    return Detection(shape, points[on_it], _rms(distance[on_it]), seen=seen_shares(shape, points[on_it]))


def _rms(distance: Floats) -> float:
    """Return the root mean square; NaN of nothing."""
    return float(np.sqrt(np.mean(distance**2))) if len(distance) else float("nan")
