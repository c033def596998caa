"""World: a board with shapes on it, and random boards.

Second step of the story. The board is a square centred on the origin; its edge is invisible to the LiDAR, unless
there are walls.

In:  a number of shapes and a seed (or the shapes themselves).
Out: a ``World``: ``.shapes`` (a tuple of Circle and Polygon), ``.size`` in metres and ``.walls``.

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
from itertools import combinations, islice
from typing import Literal

import numpy as np

from .arguments import Floats, as_count, as_positive, as_rng, check_type, doubt, limit, short
from .palette import INK, KIND_COLORS, PALE
from .random_shapes import SORTS, Sort, free_shape, paper_shape
from .shapes import PRIMITIVES, Circle, Kind, Polygon, Shape
from .show import census, thumbnail

MOST_DRAWN = 1000  # shapes in the picture by which a world shows itself in a notebook
# The paper's maps: one shape in each quadrant, near the quadrant's centre.
QUADRANTS = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)], dtype=float)
QUADRANT_CENTER = 0.225  # of the board's size
QUADRANT_JITTER = 0.1  # of the board's size, each way

KILOMETRE = 1000.0  # m: who has so large a board, or the paper's in millimetres
EDGE_MARGIN = 0.12  # m from a shape to the board's edge, so that way-points lie on every side of it
LEAST_GAP = 0.05  # m between two outlines
TRIES_PER_SHAPE = 300  # a shape that found no room in this many tries will hardly find any
TRIES_PER_WORLD = 20
MOST_COMPARED = 1000  # pairs of shapes whose boxes meet, of which one may lie on the other
MOST_RANDOM = 1000  # shapes of a random world: each is measured to all before it

Style = Literal["paper", "free", "any"]
STYLES: tuple[Style, ...] = ("paper", "free", "any")


@dataclass(frozen=True)
class World:
    """A square board with shapes on it.

    Raises ValueError if something other than a Circle or a Polygon is among the shapes, the size is not above zero, or
    walls is neither True nor False. Warns (``LikelyWrong``) if a shape lies off the board, or on another one.

    Parameters
    ----------
    shapes : iterable of Circle and Polygon
        What stands on the board. Shapes may touch or overlap; ``random_world`` never makes them so.
    size : float
        Side of the board in metres; it spans ``[-size/2, size/2]`` both ways. All else follows its ``scale``: a
        board of 10 m has a robot, a LiDAR, way-points and cells ten times as large as the paper's.
    walls : bool
        Whether the board's edge is a wall, which the LiDAR sees from inside. Outside, all is solid.

    Examples
    --------
    >>> World([Circle((0, 0), 0.1)]).shapes[0].kind
    'circle'
    >>> World(walls=True).walls[0].tolist(), World(size=25).scale
    ([[-0.5, -0.5], [0.5, -0.5]], 10.0)
    """

    shapes: tuple[Shape, ...]
    size: float = 1.0
    walled: bool = False

    def __init__(self, shapes: Iterable[Shape] = (), size: float = 1.0, *, walls: bool = False) -> None:
        try:
            shapes = tuple(shapes)
        except TypeError:
            raise ValueError(f"a world's shapes must be a list of Circle and Polygon, got {short(shapes)}") from None
        for shape in shapes:
            if not isinstance(shape, (Circle, Polygon)):
                raise ValueError(f"a world's shapes must be Circle or Polygon, got {type(shape).__name__}")
        object.__setattr__(self, "shapes", shapes)
        object.__setattr__(self, "size", as_positive(size, "size"))
        check_type(walls, (bool, np.bool_), "walls must be True or False")
        object.__setattr__(self, "walled", bool(walls))
        if sentence := _misplaced(shapes, self.size):
            doubt(sentence, depth=1)

    @property
    def scale(self) -> float:
        """How many times larger than the paper's all is that belongs to the board: its robot, sensor and cells."""
        return scale_of(self.size)

    @property
    def cell(self) -> float:
        """Side of the cells that what was seen of the board is put on, metres: 1 mm, times the scale."""
        return 0.001 * self.scale

    def scaled(self, k: float) -> World:
        """Return the board with all that stands on it, k times as large."""
        return World([shape.scaled(k) for shape in self.shapes], k * self.size, walls=self.walled)

    @property
    def walls(self) -> Floats:
        """The walls' ends, shape (4, 2, 2), metres, counter-clockwise from the lower left; (0, 2, 2) without walls."""
        corners = self.size / 2 * QUADRANTS
        return np.stack([corners, np.roll(corners, -1, axis=0)], axis=1)[: 4 * self.walled]

    def __repr__(self) -> str:
        return f"World: {self.size:g} m x {self.size:g} m{' with walls' * self.walled}, {census(self.shapes)}"

    def _repr_html_(self) -> str:
        board = (self.size / 2 * QUADRANTS, INK if self.walled else PALE)
        drawn = self.shapes[:MOST_DRAWN]
        text = repr(self) + (f"; the first {MOST_DRAWN} are drawn" if len(self.shapes) > MOST_DRAWN else "")
        shapes = [(s.outline(40) if isinstance(s, Circle) else s.vertices, KIND_COLORS[s.kind]) for s in drawn]
        return thumbnail(text, outlines=[board, *shapes])

    @cached_property
    def _hash(self) -> int:
        return hash((self.shapes, self.size, self.walled))

    def __hash__(self) -> int:
        return self._hash  # kept: the ray caster looks worlds up, and a world may have ten thousand shapes

    def least_gap(self) -> float:
        """Return the least distance between two outlines in metres; <= 0 when two meet, infinite without two."""
        return min((gap_between(a, b) for a, b in combinations(self.shapes, 2)), default=float("inf"))


def scale_of(size: float) -> float:
    """Return the scale of a board of ``size`` metres: 1 between 10 cm and 10 m, else the next power of ten towards 1.

    >>> [scale_of(size) for size in (0.05, 0.1, 0.11, 1, 9.9, 10, 99, 100)]
    [0.1, 0.1, 1.0, 1.0, 1.0, 10.0, 10.0, 100.0]
    """
    power = np.log10(size)
    return float(10.0 ** np.trunc(power + np.copysign(1e-9, power)))  # 0.1 has no exact logarithm


def _misplaced(shapes: Sequence[Shape], size: float) -> str:
    """Return a sentence on the first shape that lies wholly off the board or on another one; empty if none does."""
    boxes = [
        (s.center - s.radius, s.center + s.radius)
        if isinstance(s, Circle)
        else (s.vertices.min(axis=0), s.vertices.max(axis=0))
        for s in shapes
    ]
    if size >= KILOMETRE:
        return f"a board is {size:g} m wide: is it in millimetres?"
    low, high = np.array(boxes).reshape(-1, 2, 2).transpose(1, 0, 2)
    off = ((low > size / 2) | (high < -size / 2)).any(axis=1)
    if off.any():
        return f"{shapes[int(np.argmax(off))]} lies off the board of {size:g} m: is it in millimetres?"
    order = np.argsort(low[:, 0], kind="stable")
    low, high = low[order], high[order]
    stops = np.searchsorted(low[:, 0], high[:, 0])
    near = (
        (shapes[order[i]], shapes[order[i + 1 + j]])
        for i, stop in enumerate(stops)
        for j in np.flatnonzero((low[i + 1 : stop, 1] < high[i, 1]) & (high[i + 1 : stop, 1] > low[i, 1]))
    )
    for a, b in islice(near, MOST_COMPARED):
        if _lies_on(a, b) or _lies_on(b, a):
            return f"{a} and {b} lie on each other"
    return ""


def _lies_on(a: Shape, b: Shape) -> bool:
    """Tell whether the middle of ``a`` or a piece of its outline lies inside ``b``, and not just at its edge."""
    points = np.vstack([a.outline(40), a.centroid])
    return bool(b.signed_distance(points).min() < -0.01 * min(a.reach, b.reach))


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
    kinds: Sequence[Kind | Sort] | None = None,
    gap: float | None = None,
    size: float = 1.0,
    walls: bool = False,
    rng: int | np.random.Generator | None = None,
) -> World:
    """Return a board with n random shapes that do not touch.

    Raises ValueError if an argument is out of its range, or no room is found for n shapes with that gap.

    Parameters
    ----------
    n : int, at most four in the paper's style
    style : {"paper", "free", "any"}
        ``"paper"``: at most one shape in each quadrant, sides parallel to the axes, the paper's sizes.
        ``"free"``: anywhere, turned by any angle; triangles, rectangles and pentagons are irregular, with
        every corner between 30 and 150 degrees and every side at least 4 cm long.
        ``"any"``: as free, with other polygons beside the four kinds: an irregular ``"quadrilateral"`` or
        ``"hexagon"``, a five-pointed ``"star"``, an ``"L"``, ``"T"`` or ``"U"``, and an ``"arrow"`` head.
    kinds : sequence of str, optional
        The kind of each shape, n of them; drawn evenly from the four kinds when not given. In the style ``"any"``
        also one of the sorts above, or ``"polygon"`` for one of them at random.
    gap : float, optional
        Least distance between two outlines in metres; 5 cm when not given.
    size, walls
        As for ``World``. Outlines stay 0.12 m from the edge, so that way-points lie on every side of them; these
        lengths, too, follow the board's scale.
    rng : seed or numpy.random.Generator, optional
        The same seed gives the same world.

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
    limit(n := as_count(n, "n", least=0), MOST_RANDOM, "n must be at most {}")
    size, scale = as_positive(size, "size"), scale_of(as_positive(size, "size"))
    gap = LEAST_GAP * scale if gap is None else as_positive(gap, "gap", zero=True)
    if style not in STYLES:
        raise ValueError(f'style must be "paper", "free" or "any", got {short(style)}')
    if style == "paper" and n > len(QUADRANTS):
        raise ValueError(f'the paper\'s style has room for at most 4 shapes, got {n}; use style="free" for more')
    kinds = _checked_kinds(kinds, n, style, rng)

    for _ in range(TRIES_PER_WORLD):
        shapes = _try_to_place(kinds, style, gap / scale, size / scale, rng)
        if shapes is not None:
            return World([shape.scaled(scale) for shape in shapes], size, walls=walls)
    raise ValueError(
        f"no room found for {n} shapes with a gap of {gap:g} m on a board of {size:g} m: "
        "ask for fewer shapes, a smaller gap or a larger board"
    )


def _checked_kinds(
    kinds: Sequence[Kind | Sort] | None, n: int, style: Style, rng: np.random.Generator
) -> list[Kind | Sort]:
    drawn = (*PRIMITIVES, *SORTS) if style == "any" else PRIMITIVES
    if isinstance(kinds, str):
        raise ValueError(f"kinds must be a list of kinds, such as [{kinds!r}], got the text {kinds!r}")
    if kinds is None:
        return [drawn[i] for i in rng.integers(len(drawn), size=n)]
    if len(kinds) != n:
        raise ValueError(f"kinds must name one kind for each of the {n} shapes, got {len(kinds)}")
    for kind in kinds:
        if kind not in drawn and not (kind == "polygon" and style == "any"):
            raise ValueError(f"a kind must be one of {', '.join(drawn)}, got {short(kind)}")
    return [SORTS[rng.integers(len(SORTS))] if kind == "polygon" else kind for kind in kinds]


def _try_to_place(
    kinds: Sequence[Kind | Sort], style: Style, gap: float, size: float, rng: np.random.Generator
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
