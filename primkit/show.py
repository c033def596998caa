"""Show: how the nouns print, and the small picture by which they show themselves at the end of a notebook's cell.

In:  shapes; or a line of text, outlines with their colours, points and a way, metres.
Out: text; or HTML: an SVG picture, without axes, and below it the text.

>>> html = thumbnail("Grid: 1 cell", dots=[(0.1, 0.2)])
>>> "<p>Grid: 1 cell</p>" in html, html.count("h0")
(True, 1)

Not here: pictures to read values from; ``plots`` draws those.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from html import escape

import numpy as np
from numpy.typing import ArrayLike

from .arguments import Floats
from .palette import GREY, INK
from .shapes import KINDS, Shape
from .table import count
from .themed import themed

SIDE, SIDE_RIM = 280, 6  # px
MOST_SIDES = 6  # of a polygon, told one by one


def census(shapes: Sequence[Shape]) -> str:
    """Return how many shapes there are, and of each kind.

    >>> from primkit.shapes import Circle
    >>> census([Circle((0, 0), 0.1), Circle((1, 0), 0.1)]), census([])
    ('2 shapes: 2 circles', 'no shapes')
    """
    kinds = [shape.kind for shape in shapes]
    told = ", ".join(count(kinds.count(kind), kind) for kind in KINDS if kind in kinds)
    return count(len(kinds), "shape") + (f": {told}" if told else "")


def digits_of_mm(resolution: float) -> int:
    """Return how many digits after the point of a millimetre tell a tenth of a cell of this side, metres.

    >>> digits_of_mm(0.001), digits_of_mm(0.01), digits_of_mm(0.0005)
    (1, 0, 2)
    """
    return max(0, math.ceil(1 - math.log10(1000 * resolution) - 1e-9))


def lengths_in_mm(lengths: Iterable[float], resolution: float = 0.001) -> list[str]:
    """Return lengths, metres, as texts, millimetres, to a tenth of a cell of this side, metres.

    >>> lengths_in_mm([0.1, -1e-9]), lengths_in_mm([0.1], 0.01)
    (['100.0', '0.0'], ['100'])
    """
    digits = digits_of_mm(resolution)
    return [f"{round(1000 * length, digits) + 0.0:.{digits}f}" for length in lengths]  # + 0.0: no "-0.0"


def in_mm(shape: Shape, measured: Sequence[bool] = (), resolution: float = 0.001) -> tuple[str, str]:
    """Return a shape's centre and dimensions as texts, millimetres; what was not measured stands in brackets.

    Texts are as long as makes sense on cells of side ``resolution``, metres.

    >>> from primkit.shapes import Circle, Polygon
    >>> in_mm(Circle((0.1, 0), 0.06)), in_mm(Polygon([(0, 0), (0.2, 0), (0.2, 0.1), (0, 0.1)]), (True, False))
    (('100.0, 0.0', 'radius 60.0'), ('100.0, 50.0', '200.0 x (100.0)'))
    """
    known = [*measured, *[True] * (len(shape.dimensions) - len(measured))]
    lengths = lengths_in_mm(shape.dimensions, resolution)
    numbers = [text if sure else f"({text})" for text, sure in zip(lengths, known, strict=True)]
    centre = ", ".join(lengths_in_mm(shape.centroid, resolution))
    if shape.kind in ("circle", "rectangle"):
        return centre, "radius " * (shape.kind == "circle") + " x ".join(numbers)
    more = f", ... ({len(numbers)} sides)" if len(numbers) > MOST_SIDES else ""
    return centre, "sides " + ", ".join(numbers[:MOST_SIDES]) + more


def thumbnail(
    text: str,
    *,
    outlines: Sequence[tuple[ArrayLike, str]] = (),
    dots: ArrayLike = (),
    places: ArrayLike = (),
    way: ArrayLike = (),
) -> str:
    """Return a picture with its text: closed outlines in their colours, black dots, grey places, a grey way."""
    areas, marks, stops, line = [_points(outline) for outline, _ in outlines], *map(_points, (dots, places, way))
    every = np.vstack([*areas, marks, stops, line])
    low, high = (every.min(axis=0), every.max(axis=0)) if len(every) else (np.zeros(2), np.ones(2))
    scale = (SIDE - 2 * SIDE_RIM) / (float((high - low).max()) or 1.0)

    def pixels(points: Floats) -> list[tuple[int, int]]:
        x, y = (scale * (points - (low + high) / 2)).T
        return [(round(SIDE / 2 + u), round(SIDE / 2 - v)) for u, v in zip(x.tolist(), y.tolist(), strict=True)]

    parts = [
        f'<polygon points="{_joined(pixels(area))}" fill="{color}" fill-opacity="0.2" stroke="{color}"/>'
        for area, (_, color) in zip(areas, outlines, strict=True)
    ]
    parts += [f'<polyline points="{_joined(pixels(line))}" fill="none" stroke="{GREY}"/>'] * (len(line) > 0)
    for points, color in ((stops, GREY), (marks, INK)):
        spots = "".join(f"M{x} {y}h0" for x, y in dict.fromkeys(pixels(points)))  # a pixel holds many points
        parts += [f'<path d="{spots}" stroke="{color}" stroke-width="2" stroke-linecap="round"/>'] * bool(spots)
    svg = f'<svg xmlns="http://www.w3.org/2000/svg" width="{SIDE}" height="{SIDE}" style="background:#fff">'
    return f"<div>{themed(svg + ''.join(parts) + '</svg>', text)}<p>{escape(text)}</p></div>"


def _points(points: ArrayLike) -> Floats:
    return np.asarray(points, dtype=float).reshape(-1, 2)


def _joined(pixels: Sequence[tuple[int, int]]) -> str:
    return " ".join(f"{x},{y}" for x, y in pixels)
