"""Drawing: small pictures as SVG text, quick enough to be redrawn while a slider moves.

In:  what is to be seen, in metres or any other unit, and the ``Frame`` that maps it to pixels.
Out: SVG as text. The same values give the same text on every computer: numbers have a tenth of a pixel.

>>> frame = board_frame(size=1.0)
>>> frame.points([(0.0, 0.0)], color="#0072B2")
'<path d="M235 205h0" stroke="#0072B2" stroke-width="5" stroke-linecap="round" fill="none"/>'
>>> svg = picture(frame, frame.points([(0, 0)]), title="One point", says="One point in the middle of the board.")
>>> what_it_says(svg)
'One point in the middle of the board.'

The title says the finding. ``says`` is a sentence with the numbers: it is read aloud to who cannot see the picture,
and stands below it beside a slider.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from html import unescape
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..palette import BLUE, GREY, INK, KIND_COLORS, PALE, legible
from ..shapes import Circle, Shape
from .svg import (
    LETTER_SIZE,
    MARK_CONTRAST,
    PIXEL_TIE,
    as_svg,
    path,
    signed,
    size_of,
    tenth,
    through,
    what_it_says,
    words_at,
)

PAD_LEFT, PAD_RIGHT, PAD_TOP, PAD_BOTTOM = 60, 15, 30, 45  # px around the axes: numbers, names, title
LEGEND_LEFT, LEGEND_ROW = 22, 22  # px
ENTRY = re.compile(r'<g class="entry" transform="[^"]*">(.*?)</g>')

Entry = tuple[str, str, str]  # of a legend: words, colour, sign

# Outlines of the markers around (0, 0), for a radius of 1; "dot" and "ring" are drawn as circles.
MARKERS: dict[str, tuple[tuple[float, float], ...]] = {
    "square": ((-0.9, -0.9), (0.9, -0.9), (0.9, 0.9), (-0.9, 0.9)),
    "diamond": ((0, -1.2), (1.2, 0), (0, 1.2), (-1.2, 0)),
    "triangle": ((0, -1.2), (1.1, 0.8), (-1.1, 0.8)),
    "triangle down": ((0, 1.2), (-1.1, -0.8), (1.1, -0.8)),
}


@dataclass(frozen=True)
class Frame:
    """The axes of a picture: which piece of the plane is seen, and on how many pixels.

    Parameters
    ----------
    x, y : tuple of float
        From and to, in the unit of the axis; y grows upwards.
    x_label, y_label : str
        Name and unit, such as ``"x [m]"``.
    width, height : int
        Of the whole picture in pixels, with title and labels.
    x_ticks, y_ticks : tuple of float, optional
        Where numbers stand; round numbers when not given.
    """

    x: tuple[float, float]
    y: tuple[float, float]
    x_label: str = "x [m]"
    y_label: str = "y [m]"
    width: int = 440
    height: int = 425
    x_ticks: tuple[float, ...] | None = None
    y_ticks: tuple[float, ...] | None = None

    @property
    def scale(self) -> tuple[float, float]:
        """Pixels for one unit of x and of y."""
        across, up = self.width - PAD_LEFT - PAD_RIGHT, self.height - PAD_TOP - PAD_BOTTOM
        return across / (self.x[1] - self.x[0]), up / (self.y[1] - self.y[0])

    def at(self, points: ArrayLike) -> list[list[float]]:
        """Return the pixels of points, N pairs, rounded to a tenth."""
        low, scale = np.array([self.x[0], self.y[1]]), np.array([1.0, -1.0]) * self.scale
        pixels = (np.asarray(points, dtype=float).reshape(-1, 2) - low) * scale + (PAD_LEFT, PAD_TOP)
        rounded: list[list[float]] = (np.round(pixels + PIXEL_TIE, 1) + 0.0).tolist()
        return rounded

    def points(self, points: ArrayLike, color: str = BLUE, marker: str = "dot", size: float = 5) -> str:
        """Draw points, shape (N, 2), as dots, or as "ring", "cross", or one of ``MARKERS``; ``size`` in pixels."""
        places = self.at(points)
        if marker == "dot":
            moves = "".join(f"M{x:g} {y:g}h0" for x, y in places)
            return path(moves, stroke=color, stroke_width=size, stroke_linecap="round")
        r = size / 2
        if marker == "ring":
            turn = f"a{r:g} {r:g} 0 1 0 {2 * r:g} 0a{r:g} {r:g} 0 1 0 {-2 * r:g} 0"
            moves = "".join(f"M{tenth(x - r)} {y:g}{turn}" for x, y in places)
            return path(moves, stroke=color, stroke_width=1.5)
        if marker == "cross":
            strokes = f"l{size:g} {size:g}m{-size:g} 0l{size:g} {-size:g}"
            moves = "".join(f"M{tenth(x - r)} {tenth(y - r)}{strokes}" for x, y in places)
            return path(moves, stroke=color, stroke_width=1.8)
        outlines = ([(x + r * dx, y + r * dy) for dx, dy in MARKERS[marker]] for x, y in places)
        return path("".join(f"{through(outline)}Z" for outline in outlines), fill=color)

    def segments(self, starts: ArrayLike, ends: ArrayLike, color: str = GREY, width: float = 1, dash: str = "") -> str:
        """Draw a straight stroke from each start to its end, shape (N, 2) each; ``dash`` as in "4 3"."""
        pairs = zip(self.at(starts), self.at(ends), strict=True)
        moves = "".join(f"M{x:g} {y:g}L{u:g} {v:g}" for (x, y), (u, v) in pairs)
        return path(moves, stroke=color, stroke_width=width, stroke_dasharray=dash)

    def arrow(self, start: ArrayLike, end: ArrayLike, color: str = INK, width: float = 2) -> str:
        """Draw an arrow from one point to another."""
        (first,), (last,) = np.array(self.at(start)), np.array(self.at(end))
        ahead = (last - first) / np.hypot(*(last - first))
        aside, long = np.array([-ahead[1], ahead[0]]), 6 + 3 * width  # px
        neck = last - long * ahead
        shaft = path(through([first, neck]), stroke=color, stroke_width=width)
        return shaft + path(through([last, neck + 0.4 * long * aside, neck - 0.4 * long * aside]) + "Z", fill=color)

    def polyline(self, points: ArrayLike, color: str = BLUE, width: float = 2, dash: str = "") -> str:
        """Draw a line through points, shape (N, 2)."""
        return path(through(self.at(points)), stroke=color, stroke_width=width, stroke_dasharray=dash)

    def area(self, points: ArrayLike, color: str = BLUE, opacity: float = 0.2) -> str:
        """Fill the polygon with corners, shape (N, 2)."""
        return path(through(self.at(points)) + "Z", fill=color, fill_opacity=opacity)

    def circle(
        self, center: ArrayLike, radius: float, color: str = BLUE, width: float = 2, dash: str = "", fill: float = 0
    ) -> str:
        """Draw a circle; ``fill`` is the opacity inside. Only for frames with the same scale both ways."""
        ((x, y),) = self.at(center)
        inside = f'fill="{color}" fill-opacity="{fill:g}"' if fill else 'fill="none"'
        line, color = f' stroke-dasharray="{dash}"' if dash else "", legible(color, MARK_CONTRAST)
        r = tenth(abs(radius) * self.scale[0])
        return f'<circle cx="{x:g}" cy="{y:g}" r="{r}" {inside} stroke="{color}" stroke-width="{width:g}"{line}/>'

    def shape(self, shape: Shape, color: str = "", width: float = 2, dash: str = "", fill: float = 0.2) -> str:
        """Draw a Circle or Polygon in its kind's colour; ``fill`` is the opacity inside."""
        color = color or KIND_COLORS[shape.kind]
        if isinstance(shape, Circle):
            return self.circle(shape.center, shape.radius, color, width, dash, fill)
        edge: dict[str, Any] = {"stroke": color, "stroke_width": width, "stroke_dasharray": dash} if width else {}
        return path(through(self.at(shape.vertices)) + "Z", fill=color, fill_opacity=fill, **edge)

    def robot(self, pose: ArrayLike, color: str = INK, size: float = 9) -> str:
        """Draw the robot at a pose (x, y, heading) as an arrow head; ``size`` in pixels."""
        x, y, heading = np.asarray(pose, dtype=float).tolist()
        ((px, py),) = self.at([(x, y)])
        ahead, aside = np.array([np.cos(heading), -np.sin(heading)]), np.array([np.sin(heading), np.cos(heading)])
        corners = [(px, py) + size * v for v in (1.2 * ahead, aside * 0.8 - 0.9 * ahead, -0.8 * aside - 0.9 * ahead)]
        return path(through(corners) + "Z", fill=color, stroke="white", stroke_width=1)

    def text(
        self,
        where: ArrayLike,
        words: str,
        color: str = INK,
        anchor: str = "start",
        shift: tuple[float, float] = (0, 0),
        size: float = LETTER_SIZE,
    ) -> str:
        """Write words at a place, moved by ``shift`` pixels (right, down), on a white rim to be read on lines."""
        ((x, y),) = self.at(where)
        return words_at(x + shift[0], y + shift[1], words, color=color, anchor=anchor, size=size, rim=True)

    def axes(self) -> str:
        """Draw the axes with ticks, numbers, names and units; an idea has none."""
        if not self.x_label:
            return ""
        (left, bottom), (right, top) = self.at([(self.x[0], self.y[0]), (self.x[1], self.y[1])])
        x_ticks = round_ticks(*self.x) if self.x_ticks is None else self.x_ticks
        y_ticks = round_ticks(*self.y) if self.y_ticks is None else self.y_ticks
        xs = [x for x, _ in self.at([(t, self.y[0]) for t in x_ticks])]
        ys = [y for _, y in self.at([(self.x[0], t) for t in y_ticks])]
        box = f"M{left:g} {top:g}H{right:g}V{bottom:g}H{left:g}Z"
        marks = "".join(f"M{x:g} {bottom:g}v5" for x in xs) + "".join(f"M{left:g} {y:g}h-5" for y in ys)
        return "".join(
            [
                path(box, stroke=PALE, stroke_width=1),
                path(marks, stroke=GREY, stroke_width=1),
                *(words_at(x, bottom + 18, signed(t), anchor="middle") for x, t in zip(xs, x_ticks, strict=True)),
                *(words_at(left - 8, y + 4, signed(t), anchor="end") for y, t in zip(ys, y_ticks, strict=True)),
                words_at((left + right) / 2, bottom + 36, self.x_label, anchor="middle"),
                words_at(16, (top + bottom) / 2, self.y_label, anchor="middle", turned=True),
            ]
        )


def board_frame(size: float = 1.0) -> Frame:
    """Return the frame of a board of ``size`` metres, centred on the origin, with the same scale both ways."""
    return square_frame((0.0, 0.0), size)


def idea_frame(x: tuple[float, float], y: tuple[float, float], width: int) -> Frame:
    """Return the frame of a diagram of an idea: the same scale both ways, and no axes."""
    scale = (width - PAD_LEFT - PAD_RIGHT) / (x[1] - x[0])
    return Frame(x, y, "", "", width, round(scale * (y[1] - y[0])) + PAD_TOP + PAD_BOTTOM)


def square_frame(center: tuple[float, float], size: float) -> Frame:
    """Return the frame of a square piece of the board around ``center``, ``size`` metres wide: a magnifying glass."""
    (x, y), half = center, size / 2
    return Frame((x - half, x + half), (y - half, y + half), width=425, height=425)


def picture(
    frame: Frame, *parts: str, title: str, says: str, legend: Sequence[Entry] = (), below: str = "", room: int = 0
) -> str:
    """Return the whole SVG: axes, parts from back to front, the finding as title, and the sentence for all readers.

    Parts that reach beyond the axes are cut off at them. ``legend`` explains signs below the axes: (words, colour,
    sign) each, with "dot", "ring", "cross", "line", "dashed" or a marker. Between them there is ``room``, in pixels,
    for what has axes of its own: ``below``, drawn from y = 0 on.

    >>> svg = picture(board_frame(), title="Hits", says="None.", legend=[("hits", BLUE, "dot")])
    >>> size_of(svg), "hits" in svg
    ((425, 447), True)
    """
    (left, bottom), (right, top) = frame.at([(frame.x[0], frame.y[0]), (frame.x[1], frame.y[1])])
    window = f'x="{left:g}" y="{top:g}" width="{tenth(right - left)}" height="{tenth(bottom - top)}"'
    view = f'viewBox="{left:g} {top:g} {tenth(right - left)} {tenth(bottom - top)}"'
    inside = f'<svg {window} {view} overflow="hidden">{"".join(parts)}</svg>'
    heading = words_at(left, 19, title, color=INK, size=_fitting(title, frame.width - left - 4), bold=True)
    own = f'<g transform="translate(0 {frame.height - PAD_TOP // 2})">{below}</g>' if below else ""
    entries = [_sign(0, 0, color, sign) + words_at(24, 4, words, color=INK) for words, color, sign in legend]
    signs, tall = _in_rows(entries, frame.width, frame.height + room)
    return as_svg(frame.width, frame.height + room + tall, title, says, frame.axes() + inside + heading + own + signs)


def _in_rows(entries: Sequence[str], width: int, top: int) -> tuple[str, int]:
    """Return a legend's entries in rows of this width, and how tall they are."""
    x, row, placed = float(LEGEND_LEFT), 1, []
    for entry in entries:
        letters = re.search(r">([^<]*)</text>", entry)
        wide = 24 + 0.6 * LETTER_SIZE * len(unescape(letters[1]) if letters else "")
        if x > LEGEND_LEFT and x + wide > width:
            x, row = LEGEND_LEFT, row + 1
        place = f"{tenth(x)} {top + LEGEND_ROW * row - 12}"
        placed.append(f'<g class="entry" transform="translate({place})">{entry}</g>')
        x += wide + 14
    return "".join(placed), LEGEND_ROW * row if placed else 0


def side_by_side(pictures: Sequence[str], captions: Sequence[str], *, says: str = "") -> str:
    """Return pictures of the same width as small multiples in one SVG, two in a row, with a caption above each.

    Captions have letters where there are several. What their legends explain stands once, below all.
    """
    width, _ = size_of(pictures[0])
    found = [re.findall(ENTRY, svg) for svg in pictures]
    bare = [size_of(svg)[1] - _in_rows(entries, width, 0)[1] for svg, entries in zip(pictures, found, strict=True)]
    columns, rows = min(2, len(pictures)), -(-len(pictures) // 2)
    step, cells = max(bare) + 26, []
    letters = [f"{letter}) " for letter in "abcdefghijkl"] if len(pictures) > 1 else [""]
    for number, (svg, caption) in enumerate(zip(pictures, captions, strict=True)):
        x, y = number % columns * width, number // columns * step
        cells.append(words_at(x + PAD_LEFT, y + 20, letters[number] + caption, size=15, bold=True))
        cells.append(re.sub(ENTRY, "", svg).replace("<svg ", f'<svg x="{x}" y="{y + 26}" ', 1))
    every = list(dict.fromkeys(entry for entries in found for entry in entries))
    legend, room = _in_rows(every, columns * width, rows * step)
    says = says or " ".join(f"{caption}: {what_it_says(svg)}" for svg, caption in zip(pictures, captions, strict=True))
    return as_svg(columns * width, rows * step + room, "; ".join(captions), says, "".join(cells) + legend)


def stacked(pictures: Sequence[str]) -> str:
    """Return pictures of the same width below each other in one SVG."""
    heights = [size_of(svg)[1] for svg in pictures]
    placed = (svg.replace("<svg ", f'<svg y="{sum(heights[:k])}" ', 1) for k, svg in enumerate(pictures))
    says = " ".join(map(what_it_says, pictures))
    return as_svg(size_of(pictures[0])[0], sum(heights), says, says, "".join(placed))


def round_ticks(low: float, high: float) -> tuple[float, ...]:
    """Return at most six round numbers from low to high.

    >>> round_ticks(-0.5, 0.5), round_ticks(0, 10)
    ((-0.4, -0.2, 0.0, 0.2, 0.4), (0.0, 2.0, 4.0, 6.0, 8.0, 10.0))
    """
    power = 10.0 ** np.floor(np.log10(high - low) - 1)
    for step in (power * m for m in (1, 2, 5, 10, 20, 50)):
        first, last = np.ceil(low / step - 1e-9), np.floor(high / step + 1e-9)
        if last - first < 6:
            break
    return tuple((np.round(np.arange(first, last + 1) * step, 10) + 0.0).tolist())


def _sign(x: float, y: float, color: str, sign: str) -> str:
    """Draw the sign of a legend's entry, 18 px wide, from (x, y) on."""
    if sign in ("line", "dashed"):
        dash = "5 3" if sign == "dashed" else ""
        return path(f"M{tenth(x)} {tenth(y)}h18", stroke=color, stroke_width=2, stroke_dasharray=dash)
    # A frame of its own in which one unit is one pixel, and (0, 0) the middle of the sign.
    here = Frame(
        (PAD_LEFT - x - 9, PAD_LEFT - x - 8),
        (y - PAD_TOP - 1, y - PAD_TOP),
        width=PAD_LEFT + PAD_RIGHT + 1,
        height=PAD_TOP + PAD_BOTTOM + 1,
    )
    return here.points([(0, 0)], color, sign, 8)


def _fitting(title: str, room: float) -> float:
    """Return the size of letters, 14 px or less, with which a bold title fits into the room."""
    return min(14.0, round(room / (0.66 * max(1, len(title))), 1))
