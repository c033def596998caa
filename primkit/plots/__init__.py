"""Plots: every picture of the kit.

Beside the story: each step's output can be looked at, the truth and the finding in the same colours.

In:  what the steps hand on: a ``World``, ``Scans``, points, labels, what was found, a ``Report``.
Out: the matplotlib ``Axes`` that was drawn on; ``plot_story`` and ``plot_drive`` give a whole ``Figure``.

>>> from primkit.shapes import Circle
>>> from primkit.world import World
>>> ax = plot_world(World([Circle((0, 0), 0.1)]))
>>> ax.get_title(loc="left"), ax.get_xlabel()
('1 shape: 1 circle', 'x [m]')

Every plot takes ``ax``, the axes to draw on, and returns it. Without one it makes a figure of its own with pyplot:
a notebook shows that by itself, a script calls ``matplotlib.pyplot.show()``. No plot changes matplotlib's settings.
For several pictures in one figure, ``plt.subplots(1, 2, layout="constrained")`` keeps titles and labels apart.

Sources: the pictures are the paper's Figures 1 to 3; the colours are those of ``primkit/palette.py``.
"""

from ..palette import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    INDIGO,
    INK,
    KIND_COLORS,
    KIND_INKS,
    KIND_MARKERS,
    ORANGE,
    PALE,
    PURPLE,
    SKY,
    VERMILION,
)
from .accuracy import PANELS, plot_accuracy
from .findings import plot_found
from .look import draw_areas, draw_board
from .pictures import plot_clusters, plot_points, plot_scan, plot_world
from .story import plot_recording, plot_story, save_figure
from .told import show_figures_with_words
from .ways_driven import plot_change, plot_drive, plot_tour

__all__ = ["plot_world", "plot_scan", "plot_points", "plot_clusters", "plot_found", "plot_story", "plot_drive"]
__all__ += [
    "plot_tour",
    "plot_change",
    "plot_accuracy",
    "plot_recording",
    "draw_board",
    "draw_areas",
    "save_figure",
    "PANELS",
]
__all__ += ["BLUE", "VERMILION", "GREEN", "PURPLE", "ORANGE", "SKY", "INDIGO", "BLACK", "INK", "GREY", "PALE"]
__all__ += ["KIND_COLORS", "KIND_INKS", "KIND_MARKERS"]

show_figures_with_words()
