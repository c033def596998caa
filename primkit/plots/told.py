"""Told: a matplotlib figure as a notebook's page shows it, with words made from what was drawn.

In:  any matplotlib ``Figure``, also one that a student drew.
Out: HTML: sharp on every screen, in the page's theme, told to who cannot see it.

>>> import matplotlib.figure
>>> figure = matplotlib.figure.Figure()
>>> ax = figure.subplots()
>>> _ = ax.set(title="Two hits", xlabel="x [m]", xlim=(0, 1))
>>> _ = ax.plot([0.2, 0.4], [0.1, 0.3], "o", label="hit")
>>> told(figure)
'Two hits. x [m] from 0 to 1; hit: 2 points.'
"""

from __future__ import annotations

import io
import re
import sys
from collections import Counter

import numpy as np
from matplotlib import get_backend
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.collections import PathCollection
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter

from ..table import count
from ..themed import themed

MOST_COLORS = 128  # of the stored image: flat colours and their soft edges; a quarter of the bytes
MOST_WORDS_INSIDE = 12  # texts inside the axes; more are a table


def show_figures_with_words() -> None:
    """Have a running notebook, if there is one, show each figure as HTML, too."""
    shell = sys.modules["IPython"].get_ipython() if "IPython" in sys.modules else None
    if shell is not None:
        if "inline" in get_backend():
            import matplotlib_inline.backend_inline  # noqa: F401  # when it is loaded, it forgets how figures are shown

        shell.display_formatter.formatters["text/html"].for_type(Figure, figure_html)


def figure_html(figure: Figure) -> str | None:
    """Return the figure as HTML; None when nothing is drawn in it."""
    from IPython.core.pylabtools import retina_figure
    from PIL import Image

    drawn = retina_figure(figure, base64=False)  # type: ignore[no-untyped-call]  # IPython has no types there
    if drawn is None:
        return None
    png, size = drawn
    small = io.BytesIO()
    Image.open(io.BytesIO(png)).convert("RGB").quantize(MOST_COLORS).save(small, "png", optimize=True)
    return themed(small.getvalue(), told(figure), width=size["width"])


def told(figure: Figure) -> str:
    """Return what a figure shows: titles, axes with their ranges, and what is marked, in sentences."""
    over_all = [figure.get_suptitle()] if figure.get_suptitle() else []
    return " ".join(_sentence(words) for words in [*over_all, *map(_axes_told, figure.axes)] if words)


def _axes_told(ax: Axes) -> str:
    """Return what one pair of axes shows."""
    if not ax.get_visible():
        return ""
    title = next((words for place in ("left", "center", "right") if (words := ax.get_title(loc=place))), "")
    ranges = [
        f"{axis.get_label_text()} from {' to '.join(_as_tick(axis, end) for end in ends)}"
        for axis, ends in ((ax.xaxis, ax.get_xlim()), (ax.yaxis, ax.get_ylim()))
        if axis.get_label_text() and ax.axison
    ]
    return _sentence(title) * bool(title) + " " * bool(title) + "; ".join([*ranges, *_marks(ax), *_words(ax)])


def _as_tick(axis: Axis, value: float) -> str:
    """Return a value as the ticks tell it: they may be in centimetres."""
    formatter = axis.get_major_formatter()
    return formatter(value) if isinstance(formatter, FuncFormatter) else f"{value:.3g}"


def _marks(ax: Axes) -> list[str]:
    """Return what is marked and named, with the number of its points, and how many points there are without a name."""
    named: Counter[str] = Counter()
    lines = [(line.get_label(), len(np.asarray(line.get_xdata())), line.get_linestyle()) for line in ax.lines]
    clouds = [cloud for cloud in ax.collections if isinstance(cloud, PathCollection)]
    dots = [(cloud.get_label(), len(np.asarray(cloud.get_offsets())), "None") for cloud in clouds]
    for label, n, style in [*lines, *dots]:
        name = "" if str(label).startswith("_") else str(label)
        if style in ("None", "", " "):
            named[name] += n
        elif name:
            named[name] += 0  # a line is named, its points are no marks
    for patch in ax.patches:
        if patch.get_label() and not str(patch.get_label()).startswith("_"):
            named[str(patch.get_label())] += 0
    more = [(f"{name}: " if name else "") + count(n, "point") if n else name for name, n in named.items()]
    return [words for words in more if words]


def _words(ax: Axes) -> list[str]:
    """Return the texts inside the axes and the names in the legend, as far as they are few."""
    inside = [text.get_text() for text in ax.texts if text.get_visible() and text.get_text().strip()]
    legend = ax.get_legend()
    names = [] if legend is None else [text.get_text() for text in legend.get_texts()]
    told = [re.sub(r"\s+", " ", words) for words in dict.fromkeys([*inside, *names])]
    already = {re.sub(r"\s+", " ", str(artist.get_label())) for artist in [*ax.lines, *ax.collections, *ax.patches]}
    told = [words for words in told if words not in already]
    return told if len(told) <= MOST_WORDS_INSIDE else [f"{len(told)} labels"]


def _sentence(words: str) -> str:
    """Return words on one line, with a full stop."""
    line = re.sub(r"\s+", " ", words).strip()
    return line if line.endswith((".", "!", "?")) else f"{line}."
