"""Shapes: the circles and polygons that a board is made of, and that primkit finds.

First step of the story. The truth and the finding are the same two types: like is compared with like.

In:  centres, corners and radii in metres, in the world frame (x to the right, y up).
Out: frozen shapes that know their kind, centroid, dimensions, outline and signed distance.

>>> square = Polygon([(0, 0), (0.2, 0), (0.2, 0.1), (0, 0.1)])
>>> square.kind, square.dimensions
('rectangle', (0.2, 0.1))
>>> Circle((0.1, 0.2), 0.05).signed_distance([(0.1, 0.2), (0.3, 0.2)]).round(3).tolist()
[-0.05, 0.15]
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import ArrayLike

from .arguments import Floats, as_count, as_point, as_points, as_positive

if TYPE_CHECKING:
    import shapely

Kind = Literal["circle", "triangle", "rectangle", "pentagon", "polygon"]
KINDS: tuple[Kind, ...] = ("circle", "triangle", "rectangle", "pentagon", "polygon")
PRIMITIVES = KINDS[:4]  # the paper's; "polygon" is any other outline of straight sides

SAME_CORNER = 1e-9  # m: nearer corners are one; far below the 1 mm grid, far above rounding (1e-16 m)
STRAIGHT = 1e-9  # rad: a corner that bends the outline by less is none
NEARLY_RIGHT = np.radians(2)  # of 90 degrees: points of a short side tell its direction no better
MOST_AT_ONCE = 2**17  # pairs of a corner and a point: 1 MB in each array
SHOWN_CORNERS = 6  # a polygon with more is printed with its first three


def _pair(point: Floats) -> str:
    """Write a point for reading: six digits, and rounding's 1e-17 as the 0 that it means."""
    x, y = (round(v, 9) + 0.0 for v in point.tolist())
    return f"({x:.6g}, {y:.6g})"


def _frozen(array: Floats) -> Floats:
    array = array.copy()
    array.setflags(write=False)
    return array


@dataclass(frozen=True, eq=False)
class Circle:
    """A circle: ``center``, shape (2,), metres, world frame; ``radius`` in metres, greater than zero.

    Raises ValueError if the centre is not two finite numbers or the radius is not above zero.

    >>> c = Circle((0, 0), 0.1)
    >>> c.kind, c.dimensions, c.centroid.tolist()
    ('circle', (0.1,), [0.0, 0.0])
    """

    center: Floats
    radius: float

    def __init__(self, center: ArrayLike, radius: float) -> None:
        object.__setattr__(self, "center", _frozen(as_point(center, "center")))
        object.__setattr__(self, "radius", as_positive(radius, "radius"))

    def __reduce__(self) -> tuple[type[Circle], tuple[Floats, float]]:
        """Copy and unpickle by making anew: an array that comes out of a pickle could be written to."""
        return Circle, (self.center, self.radius)

    @property
    def kind(self) -> Kind:
        """``"circle"``."""
        return "circle"

    @property
    def centroid(self) -> Floats:
        """Centre of area, shape (2,), metres: the circle's centre."""
        return self.center

    @property
    def dimensions(self) -> tuple[float, ...]:
        """``(radius,)`` in metres."""
        return (self.radius,)

    @property
    def area(self) -> float:
        """Area in square metres."""
        return float(np.pi * self.radius**2)

    @property
    def perimeter(self) -> float:
        """Length of the outline in metres."""
        return float(2 * np.pi * self.radius)

    @property
    def reach(self) -> float:
        """Greatest distance from the centroid to the outline, in metres."""
        return self.radius

    def outline(self, n: int = 200) -> Floats:
        """Return n points evenly spaced along the outline, counter-clockwise, shape (n, 2), metres."""
        theta = np.arange(as_count(n, "n")) * (2 * np.pi / n)
        return self.center + self.radius * np.column_stack([np.cos(theta), np.sin(theta)])

    def signed_distance(self, points: ArrayLike) -> Floats:
        """Return each point's distance to the outline, shape (N,), metres; negative inside."""
        return np.hypot(*(as_points(points) - self.center).T) - self.radius

    def moved(self, offset: ArrayLike = (0.0, 0.0), angle: float = 0.0) -> Circle:
        """Return the circle shifted by ``offset`` metres (turning a circle changes nothing)."""
        return Circle(self.center + as_point(offset, "offset"), self.radius)

    def scaled(self, k: float) -> Circle:
        """Return the circle k times as large, seen from the origin, and k times as far away."""
        return Circle(k * self.center, k * self.radius)

    def to_shapely(self, quad_segs: int = 64) -> shapely.Polygon:
        """Return a shapely polygon with 4 x ``quad_segs`` corners on the circle."""
        import shapely

        return shapely.Point(self.center).buffer(self.radius, quad_segs=quad_segs)

    def __eq__(self, other: object) -> bool:
        """Two circles are equal when centre and radius are, to the last bit."""
        if not isinstance(other, Circle):
            return NotImplemented
        return self.radius == other.radius and np.array_equal(self.center, other.center)

    def __hash__(self) -> int:
        return hash((*self.center.tolist(), self.radius))

    def __repr__(self) -> str:
        return f"Circle(center={_pair(self.center)}, radius={self.radius:.6g})"


@dataclass(frozen=True, eq=False)
class Polygon:
    """A simple polygon, convex or not: ``vertices``, shape (K, 2), metres, world frame, in order around the outline.

    Corners given clockwise are turned round (the first one stays first); a corner that repeats its neighbour, as a
    closed ring's last one does, is dropped. Raises ValueError if fewer than three corners are left, if three neighbours
    lie on one line, or if the outline crosses or touches itself.

    A clockwise ring that closes on itself is put right; an arrow head is a polygon too:

    >>> p = Polygon([(0, 0), (0, 1), (1, 0), (0, 0)])
    >>> p.vertices.tolist()
    [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]
    >>> p.kind, p.centroid.round(3).tolist()
    ('triangle', [0.333, 0.333])
    >>> Polygon([(0, 0), (2, 1), (0, 2), (1, 1)]).kind
    'polygon'
    """

    vertices: Floats

    def __init__(self, vertices: ArrayLike) -> None:
        corners = _without_repeats(as_points(vertices, "vertices"))
        if len(corners) < 3:
            raise ValueError(f"a polygon must have at least 3 different corners, got {len(corners)}")
        object.__setattr__(self, "vertices", _frozen(_counter_clockwise(corners)))

    def __reduce__(self) -> tuple[type[Polygon], tuple[Floats]]:
        """Copy and unpickle by making anew, as a circle does."""
        return Polygon, (self.vertices,)

    @property
    def kind(self) -> Kind:
        """``"triangle"``, ``"rectangle"``, ``"pentagon"`` (five corners, convex), or else ``"polygon"``.

        A rectangle has four right angles, each to within 2 degrees: the corners of a measured one are never exact.
        """
        n, turns = len(self.vertices), self.turns
        right = n == 4 and bool((np.abs(turns - np.pi / 2) <= NEARLY_RIGHT).all())
        named = n == 3 or right or (n == 5 and bool((turns > 0).all()))
        return KINDS[n - 2] if named else "polygon"

    @cached_property
    def turns(self) -> Floats:
        """How far the outline bends at each corner, shape (K,), radians; negative where it bends inwards."""
        return turns_of(self.vertices)

    @property
    def edges(self) -> Floats:
        """Vectors along the sides, from each corner to the next, shape (K, 2), metres."""
        return _next(self.vertices) - self.vertices

    @property
    def sides(self) -> Floats:
        """Lengths of the sides, starting at the first corner, shape (K,), metres."""
        return np.hypot(*self.edges.T)

    @property
    def normals(self) -> Floats:
        """Unit normals of the sides, pointing outwards, shape (K, 2)."""
        along = self.edges / self.sides[:, None]
        return np.column_stack([along[:, 1], -along[:, 0]])

    @property
    def area(self) -> float:
        """Area in square metres (shoelace formula)."""
        x, y = (self.vertices - self.vertices[0]).T  # near the origin: no digits lost far from it
        return float(0.5 * np.sum(x * _next(y) - _next(x) * y))

    @property
    def perimeter(self) -> float:
        """Length of the outline in metres."""
        return float(self.sides.sum())

    @property
    def centroid(self) -> Floats:
        """Centre of area, shape (2,), metres: the mean over the surface, not over the corners."""
        x, y = (self.vertices - self.vertices[0]).T
        weight = x * _next(y) - _next(x) * y
        moment = [np.sum((v + _next(v)) * weight) for v in (x, y)]
        return self.vertices[0] + np.array(moment) / (3 * weight.sum())

    @property
    def dimensions(self) -> tuple[float, ...]:
        """Rectangle: ``(width, height)``, width >= height; all others: their sides in order, in metres.

        Each of a rectangle's two is the mean of two opposite sides: those of a measured one are never exactly alike.
        """
        sides = self.sides
        if self.kind == "rectangle":
            sides = np.sort((sides[:2] + sides[2:]) / 2)[::-1]
        return tuple(sides.tolist())

    @property
    def reach(self) -> float:
        """Greatest distance from the centroid to the outline, in metres."""
        return float(np.hypot(*(self.vertices - self.centroid).T).max())

    def outline(self, n: int = 200) -> Floats:
        """Return n points evenly spaced along the outline, counter-clockwise, shape (n, 2), metres."""
        ring = np.vstack([self.vertices, self.vertices[:1]])
        travelled = np.concatenate([[0.0], np.cumsum(self.sides)])
        stops = np.arange(as_count(n, "n")) * (travelled[-1] / n)
        return np.column_stack([np.interp(stops, travelled, ring[:, axis]) for axis in (0, 1)])

    def signed_distance(self, points: ArrayLike) -> Floats:
        """Return each point's distance to the outline, shape (N,), metres; negative inside."""
        points = as_points(points)
        most = max(1, MOST_AT_ONCE // len(self.vertices))
        blocks = [points[i : i + most] for i in range(0, max(1, len(points)), most)]
        return np.concatenate([self._signed_distance(block) for block in blocks])

    def _signed_distance(self, points: Floats) -> Floats:
        """Return the same of so few points that a number for each of them and each corner fits into memory."""
        x, y = points.T[:, None] - self.vertices.T[..., None]  # from each corner, (K, N) each
        dx, dy = self.edges.T[..., None]
        along = np.clip((x * dx + y * dy) / (dx**2 + dy**2), 0.0, 1.0)
        distance = np.hypot(x - along * dx, y - along * dy).min(axis=0)
        # Inside, a ray to the right of the point crosses the outline an odd number of times (even-odd rule).
        crossed = ((y > 0) != (_next(y) > 0)) & ((x * dy > y * dx) == (dy < 0))
        inside = np.logical_xor.reduce(crossed, axis=0)
        return np.where(inside, -distance, distance)

    def moved(self, offset: ArrayLike = (0.0, 0.0), angle: float = 0.0) -> Polygon:
        """Return the polygon turned by ``angle`` radians about its centroid, then shifted by ``offset``."""
        c, s = np.cos(angle), np.sin(angle)
        middle = self.centroid
        x, y = (self.vertices - middle).T
        turned = np.column_stack([x * c - y * s, x * s + y * c])  # no matrix product: its last bits differ by machine
        return Polygon(turned + middle + as_point(offset, "offset"))

    def scaled(self, k: float) -> Polygon:
        """Return the polygon k times as large, seen from the origin, and k times as far away."""
        return Polygon(k * self.vertices)

    def to_shapely(self) -> shapely.Polygon:
        """Return the shapely polygon with the same corners."""
        import shapely

        return shapely.Polygon(self.vertices)

    def __eq__(self, other: object) -> bool:
        """Two polygons are equal when their corners are, in the same order, to the last bit."""
        if not isinstance(other, Polygon):
            return NotImplemented
        return np.array_equal(self.vertices, other.vertices)

    def __hash__(self) -> int:
        return hash(tuple(self.vertices.ravel().tolist()))  # not of the bytes: -0.0 equals 0.0

    def __repr__(self) -> str:
        few = len(self.vertices) <= SHOWN_CORNERS
        pairs = ", ".join(map(_pair, self.vertices if few else self.vertices[:3]))
        return f"Polygon([{pairs}{'' if few else f', ... {len(self.vertices)} corners'}])"


Shape = Circle | Polygon


def _next(corners: Floats) -> Floats:
    """Return for each corner what belongs to the next one; several times faster than np.roll."""
    return np.concatenate([corners[1:], corners[:1]])


def _without_repeats(corners: Floats) -> Floats:
    """Drop each corner that repeats the one before it, and the last one if it repeats the first (a closed ring)."""
    if len(corners) == 0:
        return corners
    step = np.hypot(*np.diff(corners, axis=0).T)
    corners = corners[np.append(True, step > SAME_CORNER)]
    closed = len(corners) > 1 and np.hypot(*(corners[-1] - corners[0])) <= SAME_CORNER
    return corners[:-1] if closed else corners


def turns_of(corners: Floats) -> Floats:
    """Return how far a ring of corners bends at each, to the left, shape (K,), radians in (-pi, pi].

    >>> np.degrees(turns_of(np.array([(0, 0), (2, 1), (0, 2), (1, 1)]))).round().tolist()
    [162.0, 127.0, 162.0, -90.0]
    """
    edges = _next(corners) - corners
    before = np.concatenate([edges[-1:], edges[:-1]])
    cross = before[:, 0] * edges[:, 1] - before[:, 1] * edges[:, 0]
    return np.arctan2(cross, (before * edges).sum(axis=1))


def _counter_clockwise(corners: Floats) -> Floats:
    """Return the corners of a simple polygon counter-clockwise, or refuse what is none."""
    turns = turns_of(corners)
    straight = np.abs(np.abs(turns) - np.pi / 2) > np.pi / 2 - STRAIGHT
    if straight.any():
        corner = _pair(corners[int(np.argmax(straight))])
        raise ValueError(f"a polygon's corners must not lie on one line, got {corner} between its neighbours")
    # An outline that does not cross itself turns round once, 2 pi in all; one that bends one way only is simple then.
    convex = abs(abs(turns.sum()) - 2 * np.pi) < 1e-6 and (np.all(turns > 0) or np.all(turns < 0))
    if not convex:
        import shapely

        told = shapely.is_valid_reason(shapely.Polygon(corners))  # such as "Self-intersection[0.5 0.5]"
        if "[" in told:
            x, y = map(float, told.partition("[")[2].rstrip("]").split())
            raise ValueError(f"a polygon must not cross or touch itself, got a meeting at ({x:.6g}, {y:.6g})")
    return corners if turns.sum() > 0 else np.roll(corners[::-1], 1, axis=0)
