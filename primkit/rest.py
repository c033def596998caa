"""Rest: what a report tells of all that was found beside shapes: walls, things of no kind, strays.

None of them claims to be a shape: none is a false alarm, and the scores are those of the shapes alone. They are
compared with the truth all the same:

* a wall is right when both its ends lie within the tolerance of one and the same wall that is there, of which it may be
  a piece; or it is a side of a shape that was seen from one side only
* a thing of no kind is the shape on whose outline most of its points lie, if there is one
* strays should lie on nothing: those on an outline or a wall that is there are lost

In:  ``Found``, the ``World`` with the truth, and a tolerance in metres.
Out: ``Rest``, which tells itself in a sentence.

>>> from primkit.measure import Wall
>>> ends = np.array([(-0.5, -0.501), (0.2, -0.499)])
>>> rest = Rest.of(Found(walls=[Wall(*ends, ends, 0.0003)]), World(walls=True), 0.005)
>>> print(rest)
Beside the shapes: 1 wall, right, 3 of the board's 4 missed.
>>> round(1000 * rest.walls[0].off, 1)
1.0
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .arguments import ROUNDING, Floats
from .found import Found
from .measure import Other, Wall
from .shapes import Shape
from .table import count
from .world import World

MOST_OF_THING = 0.5  # share of a thing's points


@dataclass(frozen=True, eq=False)
class WallMatch:
    """A wall that was found, and what it lies along.

    Parameters
    ----------
    found : Wall
    true : int or None
        Which of ``World.walls`` is the nearest; None where there are none.
    off : float
        How far from that wall the farther of its two ends lies, metres; infinite where there are none.
    right : bool
        Whether that is at most the tolerance.
    side_of : Circle, Polygon or None
        If it is not right: the shape on whose outline it lies instead.
    """

    found: Wall
    true: int | None
    off: float
    right: bool
    side_of: Shape | None = None


@dataclass(frozen=True, eq=False)
class Rest:
    """What was found beside shapes, compared with the truth.

    Parameters
    ----------
    walls : tuple of WallMatch
    missed_walls : tuple of int
        Which of ``World.walls`` no right one lies along.
    things : tuple of (Other, Circle or Polygon or None)
        Each thing of no kind, and the shape that it is.
    n_strays, n_lost : int
        How many points lie on nothing that was found; how many of these lie on an outline or a wall that is there.
    """

    walls: tuple[WallMatch, ...] = ()
    missed_walls: tuple[int, ...] = ()
    things: tuple[tuple[Other, Shape | None], ...] = ()
    n_strays: int = 0
    n_lost: int = 0

    @classmethod
    def of(cls, found: Found, world: World, tolerance: float) -> Rest:
        """Compare what was found beside the shapes with the truth; ``tolerance`` in metres."""
        within = tolerance + ROUNDING
        walls = tuple(_match_wall(wall, world, within) for wall in found.walls)
        right = {wall.true for wall in walls if wall.right}
        off = [np.abs(shape.signed_distance(found.strays)) for shape in world.shapes]
        off += [distance_to_wall(found.strays, wall) for wall in world.walls]
        return cls(
            walls,
            tuple(k for k in range(len(world.walls)) if k not in right),
            tuple((thing, _shape_under(thing.points, world.shapes, within, MOST_OF_THING)) for thing in found.others),
            len(found.strays),
            int(np.count_nonzero(np.min(off, axis=0, initial=np.inf) <= within)) if off else 0,
        )

    def __repr__(self) -> str:
        """Return what there is in one sentence; nothing where all is shapes."""
        walls, things = self._walls(), self._things()
        strays = f"{count(self.n_strays, 'stray')}, {self._lost()}" * bool(self.n_strays)
        said = "; ".join(filter(None, (walls, things, strays)))
        return f"Beside the shapes: {said}." if said else ""

    def _lost(self) -> str:
        """Return how many of the strays lie on something."""
        if self.n_strays == 1:
            return "on an outline" if self.n_lost else "on no outline"
        share = {0: "none", self.n_strays: "all"}.get(self.n_lost, self.n_lost)
        return f"{share} of them on an outline"

    def _walls(self) -> str:
        """Return how right the walls are; nothing where there are none and none was found."""
        if not self.walls and not self.missed_walls:
            return ""
        right = sum(wall.right for wall in self.walls)
        sides = sum(wall.side_of is not None for wall in self.walls)
        wrong = len(self.walls) - right - sides
        parts = ["all right" if right > 1 else "right"] if self.walls and not sides + wrong else []
        parts += [f"{right} right"] * bool(sides + wrong)
        parts += [f"{sides} along a shape"] * bool(sides) + [f"{wrong} wrong"] * bool(wrong)
        parts += [f"{len(self.missed_walls)} of the board's 4 missed"] * bool(self.missed_walls)
        return ", ".join([count(len(self.walls), "wall"), *parts])

    def _things(self) -> str:
        """Return what the things of no kind are; nothing where there are none."""
        if not self.things:
            return ""
        kinds = ["nothing that is there" if shape is None else f"a {shape.kind}" for _, shape in self.things]
        return f"{count(len(self.things), 'thing')} of no kind, in truth {' and '.join(kinds)}"


def _match_wall(wall: Wall, world: World, within: float) -> WallMatch:
    """Return the wall that is there and lies nearest to both ends of one that was found."""
    ends = np.array([wall.start, wall.end])
    off = [float(distance_to_wall(ends, there).max()) for there in world.walls]
    nearest = int(np.argmin(off)) if off else None
    least = min(off, default=float("inf"))
    right = least <= within
    places = np.linspace(wall.start, wall.end, 5)  # a diagonal has its ends on the outline, too
    return WallMatch(wall, nearest, least, right, None if right else _shape_under(places, world.shapes, within, 1.0))


def _shape_under(points: Floats, shapes: Sequence[Shape], within: float, share: float) -> Shape | None:
    """Return the first shape on whose outline at least such a share of the points lies; None if there is none."""
    on_it = ((shape, np.count_nonzero(np.abs(shape.signed_distance(points)) <= within)) for shape in shapes)
    return next((shape for shape, n in on_it if n >= share * max(1, len(points))), None)


def distance_to_wall(points: Floats, wall: Floats) -> Floats:
    """Return how far points, shape (N, 2), lie from a wall, its two ends, shape (2, 2), metres."""
    along = wall[1] - wall[0]
    t = np.clip((points - wall[0]) @ along / (along @ along), 0, 1)
    return np.hypot(*(points - wall[0] - t[:, None] * along).T)
