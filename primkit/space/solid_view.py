"""Solid view: a picture of solids and points in space, as SVG, seen from any side.

In:  solids, points, shape (N, 3), metres, and where it is seen from.
Out: HTML: one image with its words, which follows the page's theme.

>>> from primkit.space.solids import Sphere
>>> html = view([Sphere((0, 0, 0.5), 0.5)], [(0.5, 0, 0.5)])
>>> "1 solid and 1 point" in html, "data:image/svg+xml" in html
(True, True)

Parallel projection: what is as long is drawn as long, wherever it stands. A solid is a net of lines on its surface.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from ..arguments import Floats, as_points
from ..palette import BLUE, GREEN, INK, VERMILION
from ..table import count
from ..themed import themed
from .solids import Solid

VIEW_WIDTH, VIEW_RIM = 420, 12  # px
SOLID_COLORS = {"sphere": BLUE, "cylinder": VERMILION, "box": GREEN}
ROUND = np.linspace(0, 2 * np.pi, 49)
BOX_RIM, TO_TOP = np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0), (-1, -1, 0)]), np.array([0, 0, 1])
MOST_DOTS = 4000


def view(solids: Sequence[Solid] = (), points: ArrayLike = (), *, azimuth: float = 0.6, elevation: float = 0.5) -> str:
    """Return a picture of solids and points.

    Parameters
    ----------
    solids : sequence of Sphere, Cylinder or Box
    points : array_like, shape (N, 3), metres
    azimuth, elevation : float
        Where it is seen from: the bearing from the middle, and the height above the ground, radians.
    """
    dots = as_points(points, d=3)
    dots = dots[:: -(-len(dots) // MOST_DOTS) or 1]
    right = np.array([-np.sin(azimuth), np.cos(azimuth), 0.0])
    towards = np.array([np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)])
    flat = np.array([right, np.cross(towards, right)]).T
    nets = [(solid, [line @ flat for line in net(solid)]) for solid in solids]
    every = np.vstack([*(line for _, lines in nets for line in lines), dots @ flat, np.zeros((1, 2))])
    low, high = every.min(axis=0), every.max(axis=0)
    scale = (VIEW_WIDTH - 2 * VIEW_RIM) / max(float((high - low).max()), 1e-9)

    def pixels(line: Floats) -> str:
        x, y = (scale * (line - low)).T
        return " ".join(
            f"{VIEW_RIM + u:.1f},{VIEW_RIM + v:.1f}" for u, v in zip(x, scale * (high - low)[1] - y, strict=True)
        )

    parts = [
        f'<polyline points="{pixels(line)}" fill="none" stroke="{SOLID_COLORS[solid.kind]}" stroke-opacity="0.6"/>'
        for solid, lines in nets
        for line in lines
    ]
    spots = "".join(f"M{place}h0" for place in pixels(dots @ flat).split()) if len(dots) else ""
    parts += [f'<path d="{spots}" stroke="{INK}" stroke-width="1.5" stroke-linecap="round"/>'] * bool(spots)
    height = round(2 * VIEW_RIM + scale * float((high - low)[1]))
    svg = f'<svg xmlns="http://www.w3.org/2000/svg" width="{VIEW_WIDTH}" height="{height}" style="background:#fff">'
    return themed(svg + "".join(parts) + "</svg>", f"{count(len(solids), 'solid')} and {count(len(dots), 'point')}")


def net(solid: Solid) -> list[Floats]:
    """Return lines on the surface of a solid, each shape (M, 3), metres, world frame."""
    circle = np.column_stack([np.cos(ROUND), np.sin(ROUND), np.zeros_like(ROUND)])
    if solid.kind == "sphere":
        lines = [circle[:, order] for order in ([0, 1, 2], [0, 2, 1], [2, 0, 1])]
    else:
        rim, uprights = (circle, circle[:-1:6]) if solid.kind == "cylinder" else (BOX_RIM, BOX_RIM[:4])
        lines = [rim - TO_TOP, rim + TO_TOP, *(np.array([foot - TO_TOP, foot + TO_TOP]) for foot in uprights)]
    return [solid.center + (line * solid.half) @ solid.frame for line in lines]
