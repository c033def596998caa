"""Things: what none of the four kinds is, curved and cornered, of random proportions, 12 to 24 cm across.

>>> thing("regular hexagon", 0).kind, len(thing("regular hexagon", 0).vertices)
('polygon', 6)
>>> len(thing("ellipse", 0).vertices) >= 200
True

A curved outline is cast as a polygon of some hundred sides, each far shorter than a cell's error can show. Corners and
sides can be told: at least 3 cm from corner to corner, and no quadrilateral has four angles near 90 degrees.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import shapely

import primkit as pk
from primkit.random_shapes import free_shape

Floats = np.ndarray
Rng = np.random.Generator
N_BENT = 320  # corners of a curved outline
SKEW = np.radians(10)
FINE = 64  # corners of a quarter of a circle that shapely draws


def thing(sort: str, rng: int | Rng) -> pk.Polygon:
    """Return a thing of this sort with random proportions, turned by any angle, its centroid in the origin."""
    rng = np.random.default_rng(rng)
    outline = pk.Polygon(SORTS[sort](rng))
    return outline.moved(-outline.centroid, rng.uniform(0, 2 * np.pi))


# --- curved ----------------------------------------------------------------------------------------------------


def polar(radius: Callable[[Floats], Floats], n: int = N_BENT) -> Floats:
    """Return the outline whose distance from the origin is a function of the bearing, shape (n, 2)."""
    t = np.arange(n) * 2 * np.pi / n
    return radius(t)[:, None] * np.column_stack([np.cos(t), np.sin(t)])


def oval(width: float, height: float, power: float = 2.0, n: int = N_BENT) -> Floats:
    """Return the superellipse |x / width|^power + |y / height|^power = 1: of power 2 an ellipse, above a round box."""
    t = np.arange(n) * 2 * np.pi / n
    c, s = np.cos(t), np.sin(t)
    return np.column_stack(
        [width * np.sign(c) * np.abs(c) ** (2 / power), height * np.sign(s) * np.abs(s) ** (2 / power)]
    )


def bow(radius: float, n: int = N_BENT) -> Floats:
    """Return half a disc."""
    t = np.linspace(-np.pi / 2, np.pi / 2, n)
    return np.column_stack([radius * np.cos(t), radius * np.sin(t)])


def egg(rng: Rng) -> Floats:
    x, y = oval(rng.uniform(0.08, 0.11), rng.uniform(0.06, 0.07)).T
    return np.column_stack([x, y * (1 + rng.uniform(2, 3) * x)])


def bean(rng: Rng) -> Floats:
    waist = rng.uniform(0.3, 0.45)
    return polar(lambda t: 0.075 * (1 + waist * np.cos(2 * t) - 0.25 * np.sin(t)))


def gear(rng: Rng) -> Floats:
    teeth, high = rng.integers(3, 8), rng.uniform(0.08, 0.15)
    return polar(lambda t: 0.085 * (1 + high * np.cos(teeth * t)))


def disc(x: float, y: float, radius: float) -> shapely.Polygon:
    return shapely.Point(x, y).buffer(radius, quad_segs=FINE)


def ring_of(region: shapely.Polygon) -> Floats:
    """Return a region's outline without corners that lie on one line."""
    return shapely.get_coordinates(region.simplify(1e-6).exterior)[:-1]


def along(way: Floats, radius: float) -> shapely.Polygon:
    """Return what a disc covers that goes along a way."""
    return shapely.LineString(way).buffer(radius, quad_segs=FINE)


def bent_way(radius: float, angle: float) -> Floats:
    t = np.linspace(0, angle, 2 * FINE)
    return radius * np.column_stack([np.cos(t), np.sin(t)])


def crescent(rng: Rng) -> Floats:
    radius = rng.uniform(0.08, 0.11)
    return ring_of(disc(0, 0, radius) - disc(rng.uniform(0.4, 0.6) * radius, 0, 0.9 * radius))


def comma(rng: Rng) -> Floats:
    radius = rng.uniform(0.045, 0.06)
    return ring_of(disc(radius, 0, radius) | along(bent_way(2 * radius, rng.uniform(1.2, 1.8)) - (radius, 0), 0.02))


def round_cross(rng: Rng) -> Floats:
    reach, thick = rng.uniform(0.07, 0.09), rng.uniform(0.02, 0.03)
    return ring_of(along([(-reach, 0), (reach, 0)], thick) | along([(0, -reach), (0, reach)], thick))


CURVED: dict[str, Callable[[Rng], Floats]] = {
    "ellipse, nearly round": lambda rng: oval(*(0.075 * np.array([rng.uniform(1.1, 1.3), 1]))),
    "ellipse": lambda rng: oval(*(0.06 * np.array([rng.uniform(1.3, 1.8), 1]))),
    "long ellipse": lambda rng: oval(*(0.045 * np.array([rng.uniform(1.8, 2.6), 1]))),
    "round box": lambda rng: oval(*rng.uniform(0.065, 0.1, 2), rng.uniform(3, 5)),
    "half disc": lambda rng: bow(rng.uniform(0.07, 0.11)),
    "quarter disc": lambda rng: np.vstack([(0, 0), bent_way(rng.uniform(0.12, 0.17), np.pi / 2)]),
    "crescent": crescent,
    "lens": lambda rng: ring_of(disc(0, 0, 0.12) & disc(rng.uniform(0.09, 0.13), 0, 0.12)),
    "stadium": lambda rng: ring_of(along([(0, 0), (rng.uniform(0.06, 0.15), 0)], rng.uniform(0.04, 0.06))),
    "egg": egg,
    "bean": bean,
    "banana": lambda rng: ring_of(along(bent_way(rng.uniform(0.07, 0.1), rng.uniform(1.5, 2.5)), 0.025)),
    "comma": comma,
    "cross with round arms": round_cross,
    "gear": gear,
    "round triangle": lambda _: ring_of(disc(0, 0, 0.15) & disc(0.15, 0, 0.15) & disc(0.075, 0.15 * 0.75**0.5, 0.15)),
}


# --- cornered --------------------------------------------------------------------------------------------------


def regular(k: int, radius: float, inner: float | None = None) -> Floats:
    """Return k corners at even bearings, every second at ``inner``, if that is told."""
    radii = np.where(np.arange(k) % 2, radius if inner is None else inner, radius)
    return polar(lambda _: radii, k)


def star(rng: Rng) -> Floats:
    """Return a star of four to six points; one of three may be nearly a triangle."""
    radius = rng.uniform(0.09, 0.12)
    return regular(2 * int(rng.integers(4, 7)), radius, rng.uniform(0.4, 0.55) * radius)


def trapezoid(rng: Rng) -> Floats:
    wide, high = rng.uniform(0.16, 0.22), rng.uniform(0.08, 0.14)
    left, right = rng.uniform(0.02, 0.05, 2)
    return np.array([(0, 0), (wide, 0), (wide - right, high), (left, high)])


def kite(rng: Rng) -> Floats:
    wide, low, high = rng.uniform(0.06, 0.08), rng.uniform(0.1, 0.13), rng.uniform(0.04, 0.06)
    return np.array([(0, -low), (wide, 0), (0, high), (-wide, 0)])


def rhombus(rng: Rng) -> Floats:
    wide = rng.uniform(0.09, 0.12)
    high = rng.uniform(0.5, 0.75) * wide
    return np.array([(wide, 0), (0, high), (-wide, 0), (0, -high)])


def parallelogram(rng: Rng) -> Floats:
    (wide, high), slant = rng.uniform(0.09, 0.16, 2), rng.uniform(0.03, 0.07)
    return np.array([(0, 0), (wide, 0), (wide + slant, high), (slant, high)])


def plus(rng: Rng) -> Floats:
    t, r = rng.uniform(0.02, 0.03), rng.uniform(0.07, 0.1)
    arm = np.array([(r, -t), (r, t), (t, t)])
    return np.vstack([arm @ np.array([(c, s), (-s, c)]) for c, s in ((1, 0), (0, 1), (-1, 0), (0, -1))])


def zed(rng: Rng) -> Floats:
    w, t, h = rng.uniform(0.08, 0.12), rng.uniform(0.04, 0.05), rng.uniform(0.05, 0.09)
    return np.array([(0, 0), (w, 0), (w, h), (2 * w - t, h), (2 * w - t, h + t), (w - t, h + t), (w - t, t), (0, t)])


def dented(rng: Rng) -> Floats:
    """Return a house upside down: five corners, one of them inwards."""
    w, h = rng.uniform(0.14, 0.2), rng.uniform(0.1, 0.16)
    return np.array([(0, 0), (w, 0), (w, h), (rng.uniform(0.4, 0.6) * w, rng.uniform(0.4, 0.65) * h), (0, h)])


def quadrilateral(rng: Rng) -> Floats:
    """Return a convex one with some angle that nobody takes for a right one."""
    while True:
        shape = free_shape("quadrilateral", np.zeros(2), rng)
        if np.abs(shape.turns - np.pi / 2).max() > SKEW:
            return shape.vertices


def own(sort: str) -> Callable[[Rng], Floats]:
    """Return a sort that the library draws on its boards of the style "any"."""
    return lambda rng: free_shape(sort, np.zeros(2), rng).vertices  # type: ignore[arg-type]  # a sort it knows


CORNERED: dict[str, Callable[[Rng], Floats]] = {
    "trapezoid": trapezoid,
    "kite": kite,
    "rhombus": rhombus,
    "parallelogram": parallelogram,
    "free quadrilateral": quadrilateral,
    "arrow": own("arrow"),
    "dented box": dented,
    "regular hexagon": lambda rng: regular(6, rng.uniform(0.07, 0.11)),
    "free hexagon": own("hexagon"),
    "heptagon": lambda rng: regular(7, rng.uniform(0.08, 0.11)),
    "octagon": lambda rng: regular(8, rng.uniform(0.09, 0.12)),
    "star": star,
    "L": own("L"),
    "T": own("T"),
    "U": own("U"),
    "Z": zed,
    "plus": plus,
}
SORTS = CURVED | CORNERED
