"""World: a board with shapes on it, and random boards.

Second step of the story. The board is a square centred on the origin; its edge is invisible to the LiDAR.

In:  a number of shapes and a seed (or the shapes themselves).
Out: a ``World``: ``.shapes`` (a tuple of Circle and Polygon) and ``.size`` in metres.

>>> world = random_world(4, rng=7)
>>> len(world.shapes), world.size
(4, 1.0)

Source: the distribution of shapes is that of the paper, "Mapping of Primitives in Mobile Robotics Using
Computer Vision", section 3.1, with the numbers of its published code.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from typing import Literal

import numpy as np

from .arguments import as_count, as_positive, as_rng, short
from .shapes import KINDS, Circle, Kind, Polygon, Shape

# The paper's maps: one shape in each quadrant, near the quadrant's centre.
QUADRANTS = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)], dtype=float)
QUADRANT_CENTER = 0.225  # of the board's size
QUADRANT_JITTER = 0.1  # of the board's size, each way
PENTAGON = np.array([(0, -1), (0.9, -0.3), (0.5, 0.8), (-0.5, 0.8), (-0.91, -0.3)])

# Shapes stay this far from the board's edge [m], so that way-points lie on every side of them.
EDGE_MARGIN = 0.12
# Free shapes keep every corner visible: interior angles from 30 to 150 degrees, sides of at least 4 cm.
LEAST_CORNER = np.radians(30)
LEAST_SIDE = 0.04

TRIES_PER_SHAPE = 300  # a shape that found no room in this many tries will hardly find any
TRIES_PER_WORLD = 20

Style = Literal["paper", "free"]


@dataclass(frozen=True)
class World:
    """A square board with shapes on it.

    Parameters
    ----------
    shapes : iterable of Circle and Polygon
        What stands on the board. Shapes may touch or overlap; ``random_world`` never makes them so.
    size : float
        Side of the board in metres; it spans ``[-size/2, size/2]`` both ways.

    Raises
    ------
    ValueError
        If something other than a Circle or a Polygon is among the shapes, or the size is not above zero.

    Examples
    --------
    >>> World([Circle((0, 0), 0.1)]).shapes[0].kind
    'circle'
    """

    shapes: tuple[Shape, ...]
    size: float = 1.0

    def __init__(self, shapes: Iterable[Shape] = (), size: float = 1.0) -> None:
        try:
            shapes = tuple(shapes)
        except TypeError:
            raise ValueError(f"a world's shapes must be a list of Circle and Polygon, got {short(shapes)}") from None
        for shape in shapes:
            if not isinstance(shape, (Circle, Polygon)):
                raise ValueError(f"a world's shapes must be Circle or Polygon, got {type(shape).__name__}")
        object.__setattr__(self, "shapes", shapes)
        object.__setattr__(self, "size", as_positive(size, "size"))

    @cached_property
    def _hash(self) -> int:
        return hash((self.shapes, self.size))

    def __hash__(self) -> int:
        return self._hash  # kept: the ray caster looks worlds up, and a world may have ten thousand shapes

    def least_gap(self) -> float:
        """Return the least distance between two outlines in metres; zero or less when two meet.

        With fewer than two shapes it is infinite.
        """
        return min((gap_between(a, b) for a, b in combinations(self.shapes, 2)), default=float("inf"))


def gap_between(a: Shape, b: Shape) -> float:
    """Return the distance between the outlines of two shapes in metres; zero or less when they meet.

    Exact for circles as well: a circle is a point, and its radius is taken off afterwards.

    >>> gap_between(Circle((0, 0), 0.1), Circle((0.5, 0), 0.1))
    0.3
    """
    import shapely

    cores = [shapely.Point(s.center) if isinstance(s, Circle) else s.to_shapely() for s in (a, b)]
    radii = sum(s.radius for s in (a, b) if isinstance(s, Circle))
    return float(shapely.distance(*cores) - radii)


def random_world(
    n: int,
    *,
    style: Style = "paper",
    kinds: Sequence[Kind] | None = None,
    gap: float = 0.05,
    size: float = 1.0,
    rng: int | np.random.Generator | None = None,
) -> World:
    """Return a board with n random shapes that do not touch.

    Parameters
    ----------
    n : int
        Number of shapes; at most four in the paper's style.
    style : {"paper", "free"}
        ``"paper"``: at most one shape in each quadrant, sides parallel to the axes, the paper's sizes.
        ``"free"``: anywhere, turned by any angle; triangles, rectangles and pentagons are irregular, with
        every corner between 30 and 150 degrees and every side at least 4 cm long.
    kinds : sequence of str, optional
        The kind of each shape, n of them; drawn evenly from the four kinds when not given.
    gap : float
        Least distance between two outlines in metres.
    size : float
        Side of the board in metres. Outlines stay 0.12 m from its edge (inside +-0.38 m by default), so
        that way-points lie on every side of them.
    rng : int or numpy.random.Generator, optional
        Seed or generator. The same seed gives the same world.

    Raises
    ------
    ValueError
        If an argument is out of its range, or no room is found for n shapes with that gap.

    Examples
    --------
    >>> [shape.kind for shape in random_world(2, kinds=("circle", "pentagon"), rng=0).shapes]
    ['circle', 'pentagon']
    >>> random_world(3, style="free", rng=1) == random_world(3, style="free", rng=1)
    True
    >>> random_world(0, rng=0).shapes
    ()
    """
    rng = as_rng(rng)
    n = as_count(n, "n", least=0)
    gap, size = as_positive(gap, "gap", zero=True), as_positive(size, "size")
    if style not in ("paper", "free"):
        raise ValueError(f'style must be "paper" or "free", got {style!r}')
    if style == "paper" and n > len(QUADRANTS):
        raise ValueError(f'the paper\'s style has room for at most 4 shapes, got {n}; use style="free" for more')
    kinds = _checked_kinds(kinds, n, rng)

    for _ in range(TRIES_PER_WORLD):
        shapes = _try_to_place(kinds, style, gap, size, rng)
        if shapes is not None:
            return World(shapes, size)
    raise ValueError(
        f"no room found for {n} shapes with a gap of {gap:g} m on a board of {size:g} m: "
        "ask for fewer shapes, a smaller gap or a larger board"
    )


def _checked_kinds(kinds: Sequence[Kind] | None, n: int, rng: np.random.Generator) -> list[Kind]:
    """Return n kinds, drawn evenly when none are given."""
    if isinstance(kinds, str):
        raise ValueError(f"kinds must be a list of kinds, such as [{kinds!r}], got the text {kinds!r}")
    if kinds is None:
        return [KINDS[i] for i in rng.integers(len(KINDS), size=n)]
    if len(kinds) != n:
        raise ValueError(f"kinds must name one kind for each of the {n} shapes, got {len(kinds)}")
    for kind in kinds:
        if kind not in KINDS:
            raise ValueError(f"a kind must be one of {', '.join(KINDS)}, got {kind!r}")
    return list(kinds)


def _try_to_place(
    kinds: Sequence[Kind], style: Style, gap: float, size: float, rng: np.random.Generator
) -> list[Shape] | None:
    """Place the shapes one after the other, each where it keeps the gap; None when one found no room."""
    limit = size / 2 - EDGE_MARGIN
    quadrants = rng.permutation(len(QUADRANTS))
    placed: list[Shape] = []
    for index, kind in enumerate(kinds):
        for _ in range(TRIES_PER_SHAPE):
            if style == "paper":
                jitter = rng.uniform(-QUADRANT_JITTER, QUADRANT_JITTER, 2)
                center = size * (QUADRANT_CENTER * QUADRANTS[quadrants[index]] + jitter)
                shape = paper_shape(kind, center, rng)
            else:
                center = rng.uniform(-limit, limit, 2) if limit > 0 else np.zeros(2)
                shape = free_shape(kind, center, rng)
            if _fits(shape, placed, gap, limit):
                placed.append(shape)
                break
        else:
            return None
    return placed


def _fits(shape: Shape, placed: Sequence[Shape], gap: float, limit: float) -> bool:
    """Tell whether a shape stays inside the limit and keeps its distance from those already placed."""
    if isinstance(shape, Circle):
        extent = np.abs(shape.center) + shape.radius
    else:
        extent = np.abs(shape.vertices).max(axis=0)
    gaps = (gap_between(shape, other) for other in placed)
    return bool((extent <= limit).all()) and all(g >= gap and g > 0 for g in gaps)  # polygons that overlap are 0 apart


def paper_shape(kind: Kind, center: np.ndarray, rng: np.random.Generator) -> Shape:
    """Return a random shape with the sizes of the paper's maps, sides parallel to the axes.

    ``center``, shape (2,), metres, is where the published code puts the shape: for a triangle the middle
    of its base, for the others the middle of the shape.
    """
    if kind == "circle":
        return Circle(center, rng.uniform(0.05, 0.10))
    if kind == "rectangle":
        width, height = rng.uniform(0.10, 0.30, 2)
        return Polygon(center + np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * (width / 2, height / 2))
    if kind == "triangle":
        base = rng.uniform(0.10, 0.30)
        return Polygon(center + np.array([(-base / 2, 0), (base / 2, 0), (0, 0.10)]))
    return Polygon(center + rng.uniform(0.05, 0.10) * PENTAGON)


def free_shape(kind: Kind, center: np.ndarray, rng: np.random.Generator) -> Shape:
    """Return a random shape, turned by any angle; polygons are irregular, with corners that can be told.

    ``center``, shape (2,), metres: the centre of the circle that the corners are drawn on or near.
    """
    turn = rng.uniform(0, 2 * np.pi)
    if kind == "circle":
        return Circle(center, rng.uniform(0.04, 0.10))
    if kind == "rectangle":
        width, height = rng.uniform(0.06, 0.30, 2)
        corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * (width / 2, height / 2)
        return Polygon(corners + center).moved(angle=turn)
    n = 3 if kind == "triangle" else 5
    while True:  # every fourth triangle and every eighth pentagon has corners that can all be told apart
        bearings = turn + np.sort(rng.uniform(0, 2 * np.pi, n))
        radii = rng.uniform(0.06, 0.15) * rng.uniform(0.7, 1.0, n)
        corners = center + radii[:, None] * np.column_stack([np.cos(bearings), np.sin(bearings)])
        if _well_formed(corners):
            return Polygon(corners)


def _well_formed(corners: np.ndarray) -> bool:
    """Tell whether counter-clockwise corners are convex, with sides and angles that can be told apart."""
    edges = np.roll(corners, -1, axis=0) - corners
    before = np.roll(edges, 1, axis=0)
    turn = np.arctan2(before[:, 0] * edges[:, 1] - before[:, 1] * edges[:, 0], (before * edges).sum(axis=1))
    clear = (turn >= LEAST_CORNER) & (turn <= np.pi - LEAST_CORNER)
    return bool(clear.all()) and bool((np.hypot(*edges.T) >= LEAST_SIDE).all())
