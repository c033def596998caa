"""Outlines: convex outlines by their sides, many at once.

A polygon under construction is its sides, not its corners: points lie on sides, and corners are where two
sides meet. Many guesses are worked on at once, as rows of one array.

In:  bearings and offsets of the sides, shape (C, K) each.
Out: distances of points, corners, and which outlines are sound.

>>> square = Outlines(np.array([[0, 0.5, 1, 1.5]]) * np.pi, np.full((1, 4), 0.1))
>>> square.corners()[0].round(3).tolist()
[[0.1, -0.1], [0.1, 0.1], [-0.1, 0.1], [-0.1, -0.1]]
>>> square.sound().tolist()
[True]

Legend: C outlines of K sides each. A side lies on the line ``n . p = d``; ``angles`` are the bearings of the
outward normals n, counter-clockwise from side to side, ``offsets`` are the d. ``r`` is a point's signed
distance from a side's line. The outline is where the largest ``r`` over its sides is zero: a point belongs
to the side from which it lies farthest out.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from ..arguments import Floats
from ..shapes import KINDS, NEARLY_RIGHT, Kind, Polygon, turns_of

# What a board can hold, and a sensor can tell: sides of at least 1.5 cm, corners that bend by 15 to 160 degrees.
LEAST_SIDE, LEAST_PLANK = 0.015, 0.004
LEAST_TURN, MOST_TURN = np.radians(15), np.radians(160)
# The same for pieces, of which a part may not have been seen, and for outlines without a name.
LEAST_STRETCH, LEAST_BEND, MOST_BEND = 0.01, np.radians(8), np.radians(172)
QUARTERS = np.arange(4) * (np.pi / 2)  # the bearings of a rectangle's normals, from its first
# Lines that bend by less than this (as a sine) meet far beyond any board; this keeps the corner finite.
PARALLEL = 1e-12


@dataclass(frozen=True, eq=False)
class Outlines:
    """C outlines of K sides each, in normal form."""

    angles: Floats  # (C, K), bearings of the outward normals, counter-clockwise from side to side
    offsets: Floats  # (C, K), signed distances of the sides' lines from the origin

    def __len__(self) -> int:
        return len(self.angles)

    @cached_property
    def _normals(self) -> Floats:
        """The outward normals, shape (C, 2, K)."""
        normals = np.empty((len(self.angles), 2, self.angles.shape[1]))
        np.cos(self.angles, out=normals[:, 0])
        np.sin(self.angles, out=normals[:, 1])
        return normals

    @cached_property
    def _spans(self) -> tuple[Floats, Floats]:
        """What ``spans`` returns: it is asked for often."""
        (first, last), cos, sin = self.ends(), self._normals[:, 0], self._normals[:, 1]
        return first[..., 1] * cos - first[..., 0] * sin, last[..., 1] * cos - last[..., 0] * sin

    def __getitem__(self, which: NDArray[np.integer] | NDArray[np.bool_] | slice) -> Outlines:
        return Outlines(self.angles[which], self.offsets[which])

    def distances(self, points: Floats) -> Floats:
        """Return r, the signed distance of each point from each side's line, shape (C, N, K), metres."""
        r = self._normals.transpose(0, 2, 1) @ points.T  # side by side in memory: what is asked of all sides is fast
        r -= self.offsets[:, :, None]
        return r.transpose(0, 2, 1)

    def along(self, points: Floats) -> Floats:
        """Return where each point's foot lies along each side's line, shape (C, N, K), metres."""
        cos, sin = self._normals[:, 0], self._normals[:, 1]
        return (np.stack([-sin, cos], axis=2) @ points.T).transpose(0, 2, 1)

    def corners(self) -> Floats:
        """Return the corners, shape (C, K, 2), metres; corner i lies between side i - 1 and side i."""
        cos, sin, d = self._normals[:, 0], self._normals[:, 1], self.offsets
        before_cos, before_sin, before_d = _before(cos), _before(sin), _before(d)
        bend = sin * before_cos - cos * before_sin
        bend = np.where(np.abs(bend) < PARALLEL, PARALLEL, bend)
        corners = np.empty((*d.shape, 2))
        corners[..., 0] = (before_d * sin - d * before_sin) / bend
        corners[..., 1] = (d * before_cos - before_d * cos) / bend
        return corners

    def ends(self) -> tuple[Floats, Floats]:
        """Return the corners in which each side begins and ends, shape (C, K, 2) each, metres."""
        corners = self.corners()
        return corners, _after(corners)

    def spans(self) -> tuple[Floats, Floats]:
        """Return where each side begins and ends along its line, shape (C, K) each, metres."""
        return self._spans

    def sound(self) -> NDArray[np.bool_]:
        """Tell which outlines are closed and convex, with sides and corners that a sensor can tell, shape (C,).

        A rectangle may be thinner, where its long sides tell how it lies.
        """
        turn = np.mod(_after(self.angles) - self.angles, 2 * np.pi)
        begin, end = self.spans()
        once_round = np.abs(turn.sum(axis=1) - 2 * np.pi) < 1e-6
        bends = ((turn >= LEAST_TURN) & (turn <= MOST_TURN)).all(axis=1)
        plank = turn.shape[1] == 4 and (np.abs(turn - np.pi / 2) <= NEARLY_RIGHT).all(axis=1, keepdims=True)
        return once_round & bends & (end - begin >= np.where(plank, LEAST_PLANK, LEAST_SIDE)).all(axis=1)

    def turns(self) -> Floats:
        """Return by how much each side turns to the left into the next, shape (C, K), radians."""
        return np.mod(_after(self.angles) - self.angles + np.pi, 2 * np.pi) - np.pi

    def closes(self) -> NDArray[np.bool_]:
        """Tell which outlines run round once and cross themselves nowhere, with bends and sides that can be told.

        They need not be convex.
        """
        import shapely

        turn, (begin, end) = self.turns(), self.spans()
        once_round = np.abs(turn.sum(axis=1) - 2 * np.pi) < 1e-6
        bends = ((np.abs(turn) >= LEAST_BEND) & (np.abs(turn) <= MOST_BEND)).all(axis=1)
        closed = once_round & bends & (end - begin >= LEAST_STRETCH).all(axis=1)
        if closed.any():
            closed &= shapely.is_simple(shapely.linearrings(self.corners()))
        return closed

    @cached_property
    def convex(self) -> bool:
        """Whether the first outline bends one way only."""
        return bool((np.mod(_after(self.angles[:1]) - self.angles[:1], 2 * np.pi) < np.pi).all())

    def halves(self) -> Iterator[tuple[int, int, tuple[Floats, Floats]]]:
        """Yield which two corners of the first outline cut it in two, one that bends inwards at least, and the halves.

        Corners of each, shape (M, 2), metres, the two that cut among them.
        """
        corners = self.corners()[0]
        inwards = turns_of(corners) < 0
        for i, j in combinations(range(len(corners)), 2):
            halves = corners[i : j + 1], np.concatenate([corners[j:], corners[: i + 1]])
            if (inwards[i] or inwards[j]) and min(map(len, halves)) > 2:
                yield i, j, halves

    @cached_property
    def of_two(self) -> bool:
        """Whether the first outline may as well be that of two shapes that stand side by side.

        Two of its corners bend inwards, and cut between them each half is a triangle, a rectangle or a pentagon; or
        they nearly meet. Where no beam went through the mouth between two, nothing that was seen tells the one from the
        other. Then a T is a T: that the end of a box should stand square before a side of another, a hair away,
        would be a chance.
        """
        corners, (angles,) = self.corners()[0], self.angles[:1]
        inwards = turns_of(corners) < 0
        for i, j, halves in self.halves():
            if inwards[i] and inwards[j]:
                names, along = [_named(half) for half in halves], ((i - 1, j), (i, j - 1))
                t = names == [4, 4] and max(np.cos(angles[a] - angles[b]) for a, b in along) > np.cos(LEAST_TURN)
                if np.hypot(*(corners[i] - corners[j])) < 2 * LEAST_SIDE or (all(names) and not t):
                    return True
        return False

    @property
    def kind(self) -> Kind:
        """The first outline's kind, as ``Polygon.kind`` tells it."""
        k, turn = self.angles.shape[1], _after(self.angles[:1]) - self.angles[:1]
        right = np.abs(np.mod(turn, 2 * np.pi) - np.pi / 2).max() <= NEARLY_RIGHT
        named = self.convex and (right if k == 4 else k in (3, 5))
        return KINDS[k - 2] if named else "polygon"

    def signed_distance(self, points: Floats) -> Floats:
        """Return how far each point is from the first outline, shape (N,), metres; from a convex one with its sign."""
        r = self.distances(points)[0]
        if self.convex:
            return r.max(axis=1)
        (begin, end), t = self.spans(), self.along(points)[0]
        return np.hypot(r, np.maximum(np.maximum(begin[0] - t, t - end[0]), 0.0)).min(axis=1)

    def truncated_cost(self, points: Floats, reach: float) -> Floats:
        """Return the sum of squared distances from each outline, held at ``reach^2``, shape (C,), square metres."""
        return (np.minimum(np.abs(self.distances(points).max(axis=2)), reach) ** 2).sum(axis=1)

    def places(self, points: Floats) -> tuple[Floats, Floats, Floats]:
        """Return each point's place along the first outline, how far outside it lies, and how far from a second side.

        Shape (N,) each, metres.
        """
        (begin, end), r, t = self.spans(), self.distances(points)[0], self.along(points)[0]
        beyond = np.maximum(np.maximum(begin[0] - t, t - end[0]), 0.0)
        away, row = np.hypot(r, beyond), np.arange(len(points))
        side, second = away.argmin(axis=1), np.partition(away, 1, axis=1)[:, 1]
        lengths = (end - begin)[0]
        place = (np.cumsum(lengths) - lengths)[side] + np.clip(t - begin[0], 0.0, lengths)[row, side]
        return place, np.copysign(away[row, side], r[row, side]), second

    def moved(self, offset: Floats) -> Outlines:
        """Return the outlines shifted by ``offset``, shape (2,), metres."""
        return Outlines(self.angles, self.offsets + np.cos(self.angles) * offset[0] + np.sin(self.angles) * offset[1])

    def polygon(self, index: int = 0) -> Polygon:
        """Return one of the outlines as a Polygon."""
        return Polygon(self.corners()[index])


def _named(corners: Floats) -> int:
    """Return how many corners, shape (M, 2), a triangle, a rectangle or a convex pentagon has; 0 of anything else."""
    turns = turns_of(corners)
    bent = turns[np.abs(turns) > LEAST_TURN]
    square = bool((np.abs(bent - np.pi / 2) <= LEAST_TURN).all())
    return len(bent) if (bent > 0).all() and (len(bent) in (3, 5) or (len(bent) == 4 and square)) else 0


def _before(sides: Floats) -> Floats:
    """Return for each side what belongs to the one before it; several times faster than np.roll."""
    return np.concatenate([sides[:, -1:], sides[:, :-1]], axis=1)


def _after(sides: Floats) -> Floats:
    """Return for each side what belongs to the one after it."""
    return np.concatenate([sides[:, 1:], sides[:, :1]], axis=1)


def joined(*outlines: Outlines) -> Outlines:
    """Return several stacks of outlines with equally many sides as one."""
    angles = np.concatenate([o.angles for o in outlines])
    return Outlines(angles, np.concatenate([o.offsets for o in outlines]))


def from_angle_order(angles: Floats, offsets: Floats) -> Outlines:
    """Return outlines from sides in any order: they are put in the order of their normals' bearings."""
    angles = np.mod(angles, 2 * np.pi)
    order = np.argsort(angles, axis=1, kind="stable")
    row = np.arange(len(angles))[:, None]
    return Outlines(angles[row, order], offsets[row, order])
