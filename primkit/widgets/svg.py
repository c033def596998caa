"""SVG: a picture's text, made of strokes, areas and words at pixels, and what is said to who cannot see it.

In:  pixels, counted from the upper left corner, and colours; what is too pale to be seen is darkened.
Out: SVG as text. The same values give the same text on every computer: numbers have a tenth of a pixel.

>>> path(through([(0, 0), (10, 5)]), stroke="black")
'<path d="M0 0L10 5" stroke="black" fill="none"/>'
>>> svg = as_svg(20, 10, "A stroke", "One stroke, downwards.", path("M0 0L10 5", stroke="black"))
>>> size_of(svg), what_it_says(svg)
((20, 10), 'One stroke, downwards.')
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from html import escape, unescape

from ..palette import legible

LETTER_SIZE = 12  # px: the size of all letters but the title's
SVG_FONT = "font-family='DejaVu Sans, Verdana, sans-serif'"
WIDEST_PICTURE = 860  # px: what fits beside a notebook's margin on most screens; a wider picture is shown smaller
PIXEL_TIE = 1e-6  # px: lifts 0.25 and its like over the edge, where rounding could go either way
# Least contrasts to white, as WCAG 2 has them; areas and what is pale on purpose have less.
LETTER_CONTRAST, MARK_CONTRAST = 4.5, 3.0


def as_svg(width: int, height: int, title: str, says: str, body: str) -> str:
    """Return an SVG with a white ground that shrinks to narrow columns, and what is said to who cannot see it."""
    shown = min(1.0, WIDEST_PICTURE / width)
    size = f'width="{tenth(shown * width)}" height="{tenth(shown * height)}" viewBox="0 0 {width} {height}"'
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" {size} '
        f'role="img" style="max-width:100%;height:auto" {SVG_FONT}>'
        f"<title>{escape(title)}</title><desc>{escape(says)}</desc>"
        f'<rect width="{width}" height="{height}" fill="white"/>{body}</svg>'
    )


def path(moves: str, *, fill: str = "none", stroke: str = "", **look: str | float) -> str:
    """Return a path with its look: ``stroke_width=2`` becomes ``stroke-width="2"``; what is empty is left out."""
    fill = fill if "fill_opacity" in look else legible(fill, MARK_CONTRAST)
    line: dict[str, str | float] = {"stroke": legible(stroke, MARK_CONTRAST)}
    given = {name.replace("_", "-"): value for name, value in (line | look).items() if value != ""}
    written = "".join(f' {k}="{v if isinstance(v, str) else f"{v:g}"}"' for k, v in given.items())
    return f'<path d="{moves}"{written} fill="{fill}"/>' if moves else ""


def words_at(
    x: float,
    y: float,
    words: str,
    *,
    color: str = "#444444",
    anchor: str = "start",
    size: float = LETTER_SIZE,
    bold: bool = False,
    rim: bool = False,
    turned: bool = False,
) -> str:
    """Return words at a pixel; ``rim`` puts white around the letters, ``turned`` writes them upwards."""
    look = f'font-size="{size:g}" fill="{legible(color, LETTER_CONTRAST)}"'
    look += f' text-anchor="{anchor}"' if anchor != "start" else ""
    look += ' font-weight="bold"' if bold else ""
    look += ' stroke="white" stroke-width="3" paint-order="stroke"' if rim else ""
    look += f' transform="rotate(-90 {tenth(x)} {tenth(y)})"' if turned else ""
    return f'<text x="{tenth(x)}" y="{tenth(y)}" {look}>{escape(words)}</text>'


def sentence(width: int, height: int, words: str) -> str:
    """Return a picture that is a sentence: for when there is nothing else to draw."""
    lines, line = [], ""
    for word in words.split():
        if line and len(line) + len(word) > width / (0.62 * 14):
            lines.append(line)
            line = word
        else:
            line = f"{line} {word}".strip()
    body = "".join(words_at(20, 40 + 20 * n, part, size=14) for n, part in enumerate([*lines, line]))
    return as_svg(width, height, words, words, body)


def what_it_says(svg: str) -> str:
    """Return the sentence that was given to ``picture`` as ``says``."""
    found = re.search(r"<desc>(.*?)</desc>", svg, re.DOTALL)
    return unescape(found[1]) if found else ""


def size_of(svg: str) -> tuple[int, int]:
    """Return width and height of a picture in pixels."""
    found = re.search(r'viewBox="0 0 (\d+) (\d+)"', svg)
    if found is None:
        raise ValueError("a picture must be SVG text from picture(), got something without a viewBox")
    return int(found[1]), int(found[2])


def through(pixels: Iterable[Iterable[float]]) -> str:
    """Return the moves through pixels."""
    return "M" + "L".join(f"{tenth(x)} {tenth(y)}" for x, y in pixels)


def tenth(value: float) -> str:
    """Return a pixel as text, with a tenth at most."""
    return f"{round(value + PIXEL_TIE, 1) + 0.0:g}"


def signed(value: float) -> str:
    """Return a number with a true minus sign."""
    return f"{value:g}".replace("-", "\u2212")
