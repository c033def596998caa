"""Arcs: the circles that five ways see in the same points, while you move arc and noise. The slider of lesson 05.

>>> arcs()
Slider: arc, noise, seed, show
>>> from primkit.widgets.svg import what_it_says
>>> what_it_says(arcs().draw(arc=60, noise=0.0))  # doctest: +ELLIPSIS
'60 degrees, noise 0 mm, true radius 100 mm: mean 26 mm, Kasa 100 mm, ...'
"""

from __future__ import annotations

from collections.abc import Container, Mapping

import numpy as np

from ..arguments import Floats
from ..circles import Method, fit_circle
from ..palette import BLACK, BLUE, GREY, INK, ORANGE, PALE, PURPLE, VERMILION
from ..shapes import Circle
from .drawing import idea_frame, picture, square_frame
from .slider import Choice, Explorer, Picture, Slider, explore

XYR = tuple[float, float, float]

TRUE_CIRCLE = Circle((0.0, 0.0), 0.1)  # metres
ARC_POINTS = 60
ARC_VIEW = 0.42  # m: what is seen around the true circle, with room for the legend above it
# Name, colour, marker of the centre, width and dash of the outline; fits that agree show through each other's gaps.
CIRCLE_FITS = (
    ("mean", ORANGE, "cross", 2.5, "2 4"),
    ("Kasa", VERMILION, "square", 2.5, ""),
    ("Pratt", PURPLE, "triangle", 5.0, ""),
    ("Taubin", BLUE, "diamond", 3.0, ""),
    ("geometric", BLACK, "ring", 1.5, "6 5"),
)
ALL_FITS = "all"


def arcs() -> Explorer:
    """Return the slider of lesson 05: how much of a circle is seen, through which noise, and what five fits say."""
    return explore(
        draw_arcs,
        Slider("arc", 30, 360, 5, start=90, unit="degrees"),
        Slider("noise", 0.0, 10.0, 0.5, start=5.0, unit="mm"),
        Slider("seed", 0, 20, 1, start=0),
        Choice("show", (ALL_FITS, *(name for name, *_ in CIRCLE_FITS)), start=ALL_FITS),
        settings={
            "all around": {"arc": 360},
            "a half": {"arc": 180},
            "a quarter": {"arc": 90},
            "a sixth": {"arc": 60},
            "a sixth, no noise": {"arc": 60, "noise": 0.0},
            "who can tell?": {"arc": 30, "noise": 5.0, "seed": 3},
        },
        diagram=draw_diagram,
    )


def draw_arcs(arc: int, noise: float, seed: int, show: str) -> str:
    """Draw points on an arc of the true circle, and fitted circles: arc in degrees, noise in mm."""
    points = points_on_arc(arc, noise / 1000, seed)
    fits = {name: fit_by_name(points, name) for name, *_ in CIRCLE_FITS}
    said = ", ".join(f"{name} {_millimetres(circle)}" for name, circle in fits.items())
    return _drawn(
        points,
        {name: circle for name, circle in fits.items() if show in (ALL_FITS, name)},
        TRUE_CIRCLE,
        title=f"True 100 mm: Kasa {_millimetres(fits['Kasa'])}, Taubin {_millimetres(fits['Taubin'])}",
        says=f"{arc} degrees, noise {noise:g} mm, true radius {_millimetres(TRUE_CIRCLE)}: {said}.",
        legend=fits,  # all of them, so that the picture keeps its size
    )


def show_circles(points: Floats, circles: Mapping[str, Circle | XYR | None], truth: Circle, title: str) -> Picture:
    """Return the picture of points, shape (N, 2), the true circle, and fitted ones by the names of ``CIRCLE_FITS``."""
    fits = {name: Circle(c[:2], c[2]) if isinstance(c, tuple) else c for name, c in circles.items()}
    said = ", ".join(f"{name} {_millimetres(circle)}" for name, circle in fits.items())
    says = f"{len(points)} points; true radius {_millimetres(truth)}: {said}."
    return Picture(
        _drawn(points, fits, truth, title=title, says=says, legend=fits), f"Circles among points: {', '.join(fits)}"
    )


def _drawn(
    points: Floats, fits: Mapping[str, Circle | None], truth: Circle, *, title: str, says: str, legend: Container[str]
) -> str:
    """Draw the true circle, the fits that are there, the points, and a legend of these names."""
    x, y = truth.center.tolist()
    frame = square_frame((x, y), ARC_VIEW)
    outlines, centers, signs = [], [], [("true", PALE, "line")]
    for name, color, marker, width, dash in CIRCLE_FITS:
        if name in legend:
            signs.append((name, color, marker))
        if circle := fits.get(name):
            outlines.append(frame.circle(circle.center, circle.radius, color, width, dash))
            centers.append(frame.points([circle.center], color, marker, 9))
    return picture(
        frame,
        frame.circle(truth.center, truth.radius, PALE, 9),
        *outlines,
        frame.points(points, INK, size=3),
        *centers,
        title=title,
        says=says,
        legend=signs,
    )


def points_on_arc(arc: float, noise: float, seed: int) -> Floats:
    """Return points on the right of the true circle, shape (60, 2): arc in degrees, radial noise in metres."""
    bearing = np.radians(arc) * ((np.arange(ARC_POINTS) + 0.5) / ARC_POINTS - 0.5)
    radius = TRUE_CIRCLE.radius + noise * np.random.default_rng(seed).standard_normal(ARC_POINTS)
    return TRUE_CIRCLE.center + radius[:, None] * np.column_stack([np.cos(bearing), np.sin(bearing)])


def fit_by_name(points: Floats, name: str) -> Circle | None:
    """Return the circle that a way of ``CIRCLE_FITS`` sees in the points; None when it sees a line."""
    if name == "mean":
        center = points.mean(axis=0)
        return Circle(center, float(np.hypot(*(points - center).T).mean()))
    methods: dict[str, Method] = {"Kasa": "kasa", "Pratt": "pratt", "Taubin": "taubin", "geometric": "geometric"}
    return fit_circle(points, methods[name])


def _millimetres(circle: Circle | None) -> str:
    """Return the radius as text; beyond ten metres the points lie on a line as far as one sees."""
    if circle is None or circle.radius > 10:
        return "a line"
    return f"{1000 * circle.radius:.0f} mm"


def draw_diagram() -> Picture:
    """Return the drawing behind Kasa's bias: the same gap makes a ring whose area grows with the circle."""
    gap, small, large = 0.02, 0.05, 0.1
    frame = idea_frame((0.0, 0.44), (0.0, 0.26), 603)
    parts, east = [], np.array([1.0, 0.0])
    areas = [np.pi * 1e4 * ((radius + gap) ** 2 - radius**2) for radius in (small, large)]
    for center, radius, area in zip([(0.08, 0.13), (0.3, 0.13)], (small, large), areas, strict=True):
        middle = np.array(center)
        edge, point = middle + radius * east, middle + (radius + gap) * east
        parts += [
            frame.circle(middle, radius + gap, ORANGE, 1, "4 3", fill=0.55),
            frame.circle(middle, radius, "white", 0, fill=1),
            frame.circle(middle, radius, BLUE, 2.5),
            frame.segments([middle], [edge], GREY, 1.5, "5 4"),
            frame.segments([edge], [point], VERMILION, 4),
            frame.points([middle], BLUE, "square", 7),
            frame.points([point], INK, size=8),
            frame.text(middle, "c", shift=(-14, 5), size=16),
            frame.text(middle, f"ring: {area:.0f} cm²", anchor="middle", shift=(0, 26), size=13),
            frame.text(middle + radius / 2 * east, "r", GREY, "middle", (0, -6), 16),
            frame.text(point, "p", shift=(4, -8), size=16),
            frame.text(edge + gap / 2 * east, "e", VERMILION, "middle", (0, 20), 16),
        ]
    svg = picture(
        frame,
        *parts,
        title="The same gap e, but the larger circle pays for a larger ring",
        says=f"A point p lies e = 20 mm outside a circle of 50 mm and outside one of 100 mm: the rings between point "
        f"and circle have {areas[0]:.0f} and {areas[1]:.0f} square centimetres.",
    )
    return Picture(svg, "Diagram: the ring that Kasa's fit counts")
