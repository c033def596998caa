"""Account: every point lies on a shape, on a wall, on some other thing, or it is a stray.

In:  the groups of points, each with how its explanation was chosen, and all points.
Out: ``Found``: the shapes, and beside them ``walls``, ``others`` and ``strays``; the sum of all is the input.

    wall     one straight piece; or each side of an outline that is larger than any shape, as of a room
    other    what has no corners and is no circle; or what is too small for its kind to show
    stray    what lies on none of them; and a group that chance would leave among so many strays

>>> import numpy as np
>>> from primkit.pipeline import find_shapes
>>> from primkit.shapes import Polygon
>>> room = Polygon([(0, 0), (3, 0), (3, 2), (0, 2)]).outline(2000)
>>> found = find_shapes(np.vstack([room, [(1.0, 1.0)]]), rng=0)
>>> found, found.strays.tolist()
(no shapes found; 4 walls, 1 stray, [[1.0, 1.0]])
>>> found.walls[0].length.__round__(3)
3.0
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from .arguments import Floats, Ints
from .found import Found
from .measure import CELL, Detection, Frame, Other, Thing, Wall, as_detection
from .robust.choice import Choice
from .robust.evidence import CERTAIN
from .robust.outlines import LEAST_SIDE, Outlines
from .robust.regroup import MOST_ACROSS
from .robust.scatter import SIGMAS
from .segmentation import LEAST_GROUP, link
from .shapes import Polygon, Shape

ROOM_ACROSS = 0.64  # m on cells of 1 mm, as all here: what is farther from corner to corner may be a room
ROOM_WIDTH = 0.1  # m: whoever sees a room stands in it, as far from its walls as a sensor's least range
LEAST_ON_WALL = 8  # points
MOST_ON_WALLS = 0.75  # share of a group's points on the walls of a room
BY_CHANCE = 5.0  # a shape has so many times the points of strays that its place would have by chance
CHANCE_AROUND = 0.022  # m: as far as points are linked


@dataclass(frozen=True, eq=False)
class Account:
    """All points, where they are worked on, and how many strays there are among them.

    Parameters
    ----------
    points : array, shape (N, 2)
        All points, metres.
    local : array, shape (N, 2)
        The same in the frame, in the order of x and then y.
    frame : Frame
        The frame.
    density : float
        Strays that were not linked to anything, for each square of the frame's unit.
    scans : array of int, shape (N,)
        The number of the scan that saw each point, 0 where it is not known.
    """

    points: Floats
    local: Floats
    frame: Frame
    density: float
    scans: Ints

    @classmethod
    def of(cls, points: Floats, local: Floats, frame: Frame, n_unlinked: int, scans: Ints) -> Account:
        """Return the account of points of which so many were linked to nothing: nobody chose to leave them out."""
        area = float(np.prod(np.ptp(local, axis=0) + CHANCE_AROUND))
        return cls(points, local, frame, n_unlinked / area, scans)

    def closed(self, things: Iterable[Thing], bounded: bool) -> Found:
        """Return everything in metres, from left to right, each point once, and the strays that are left."""
        every = _as_numbers(self.local)
        first_there = np.searchsorted(every, every)  # points at one and the same place share their fate
        left, settled = np.ones(len(every), dtype=bool), []
        for thing in things:
            taken = np.zeros(len(every), dtype=bool)
            taken[np.searchsorted(every, _as_numbers(thing.points))] = True
            mine = taken[first_there] & left
            left &= ~mine
            thing = replace(thing.in_metres(self.frame), points=self.points[mine])
            settled.append(replace(thing, scans=self.scans[mine]) if isinstance(thing, Detection) else thing)
        shapes = sorted((t for t in settled if isinstance(t, Detection)), key=lambda d: tuple(d.shape.centroid))
        walls = sorted((t for t in settled if isinstance(t, Wall)), key=lambda w: tuple(w.start))
        others = sorted((t for t in settled if isinstance(t, Other)), key=lambda o: tuple(o.points.mean(axis=0)))
        return Found(shapes, walls, others, self.points[left], CELL * self.frame.unit, bounded)

    def by_chance(self, points: Floats) -> bool:
        """Tell whether so many strays make as many points at one place by chance."""
        import shapely

        room, around = np.ptp(points, axis=0) + 2 * CHANCE_AROUND, BY_CHANCE * self.density
        if len(points) >= around * room.prod():
            return False
        return len(points) < around * shapely.linestrings(points).convex_hull.buffer(CHANCE_AROUND).area


def _as_numbers(points: Floats) -> NDArray[np.complex128]:
    """Return points as complex numbers, whose order is that of x and then y, shape (N,)."""
    numbers: NDArray[np.complex128] = points[:, 0] + 1j * points[:, 1]
    return numbers


def things_of(choice: Choice, count_margin: float, account: Account) -> list[Thing]:
    """Return what a group of points came out as: a shape, walls, some other thing; nothing for strays."""
    best = choice.ranked[0] if choice.ranked else None
    if best is None:
        return []
    if best.shape is None:
        wall = _wall_along(choice)
        return [] if wall is None or account.by_chance(wall.points) else [wall]
    found = as_detection(choice)
    if found is None or account.by_chance(found.points):
        return []
    if (room := _room_of(choice, found.shape)) is not None:
        return list(_walls_around(choice, room))
    if _is_other(choice, found):
        outline = found.shape.vertices if isinstance(found.shape, Polygon) else found.shape.outline(36)
        return [Other(choice.points, outline)]
    return [replace(found, count_margin=count_margin)]


def walls_among(choices: Sequence[Choice], n_shapes: int) -> list[Choice]:
    """Return those groups of points that are walls or strays; while shapes lack, what may be a side is none of them."""
    found = [as_detection(choice) for choice in choices]
    no_shapes = [c for c, one in zip(choices, found, strict=True) if one is None or _room_of(c, one.shape) is not None]
    if len(choices) - len(no_shapes) >= n_shapes:
        return no_shapes
    return [choice for choice in no_shapes if np.hypot(*np.ptp(choice.points, axis=0)) > MOST_ACROSS]


def beside_walls(choice: Choice) -> list[Floats]:
    """Return the points of a room that lie on none of its walls, as groups: what stands near one was linked to it.

    Some points of each lie where noise brings none from a wall.
    """
    if choice.shape is None or _room_of(choice, choice.shape) is None:
        return []
    beside, deep = choice.points[~choice.on_it], choice.inside[~choice.on_it]
    labels = link(beside)
    n_deep = np.bincount(labels[deep & (labels >= 0)])
    return [beside[labels == k] for k in np.flatnonzero(n_deep >= LEAST_GROUP)]


def _room_of(choice: Choice, shape: Shape) -> Outlines | None:
    """Return an outline that is larger than any shape, with room to stand in it, and fits most of the points."""
    if 2 * shape.reach <= ROOM_ACROSS:
        return None
    figure = choice.ranked[0].figure
    corners = shape.vertices if isinstance(shape, Polygon) else shape.outline(36)
    across = float(np.hypot(*(corners[:, None] - corners).T).max())
    wide = across > ROOM_ACROSS and shape.area > ROOM_WIDTH * across
    is_room = wide and choice.on_it.mean() >= MOST_ON_WALLS and choice.fit >= CERTAIN
    return figure if is_room and isinstance(figure, Outlines) else None


def _is_other(choice: Choice, found: Detection) -> bool:
    """Tell whether a group is a thing without corners that is no circle, or too small for a kind to show."""
    small = float(np.ptp(choice.points, axis=0).max()) < LEAST_SIDE
    return small or (found.kind == "polygon" and min(found.seen) > 0 and choice.fit < 0)


def _wall_along(choice: Choice) -> Wall | None:
    """Return the one straight piece that explains a group; None for too few points."""
    points = choice.points
    middle = points.mean(axis=0)
    for _ in range(2):  # once more without what lies beside it
        along = np.linalg.svd(points - middle, full_matrices=False)[2][0]
        across = (choice.points - middle) @ (-along[1], along[0])
        points = choice.points[np.abs(across) <= SIGMAS * choice.spread]
        if len(points) < LEAST_ON_WALL:
            return None
        middle = points.mean(axis=0)
    t = (points - middle) @ along
    ends = middle + np.array([[t.min()], [t.max()]]) * along
    start, end = ends[np.lexsort((ends[:, 1], ends[:, 0]))]
    return Wall(start, end, points, choice.spread / len(points) ** 0.5, (False, False))


def _walls_around(choice: Choice, outline: Outlines) -> Iterable[Wall]:
    """Yield the sides of an outline that is a room, those with points on them; they meet in corners."""
    place, distance, _ = outline.places(choice.points)
    begin, end = (ends[0] for ends in outline.ends())
    lengths = np.hypot(*(end - begin).T)
    side = np.minimum(np.searchsorted(np.cumsum(lengths), place, side="right"), len(lengths) - 1)
    for k in range(len(lengths)):
        own = choice.points[(side == k) & (np.abs(distance) <= SIGMAS * choice.spread)]
        if len(own) >= LEAST_ON_WALL:
            yield Wall(begin[k], end[k], own, choice.spread / len(own) ** 0.5, (True, True))
