"""Findings: all that was found, over the truth.

In:  what ``find_shapes`` returned; the ``World`` and the ``Report``, if there are any.
Out: the axes, with outlines, centres and corners, walls, things of no kind and strays, the errors beside each shape,
and the outcome as the title.

>>> plot_found([]).get_title(loc="left")
'No shapes found'
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from itertools import pairwise

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.typing import ColorType

from ..arguments import Floats, check_type
from ..found import Found, resolution_of
from ..measure import CELL, Detection, Other, Wall
from ..palette import GREY, INK, KIND_COLORS, KIND_INKS
from ..report import Match, Report
from ..seen import is_seen
from ..shapes import Circle, Polygon, Shape
from ..show import digits_of_mm
from ..table import count
from ..world import World
from .labels import write_labels
from .look import as_axes, check_look, draw_areas, draw_board, draw_center, draw_legend, marks, outlines, set_title

DASHED, DOTTED = (0, (3, 2)), (0, (1, 1))
USUAL_CELLS = 1000  # along a board's side, where it is not known


def plot_found(
    found: Iterable[Detection | Shape],
    world: World | None = None,
    ax: Axes | None = None,
    report: Report | None = None,
    *,
    title: str | None = None,
    color: ColorType | None = None,
) -> Axes:
    """Draw what was found over the truth, with its errors (the paper's Figure 3).

    Raises ValueError if the report is about other shapes than those found, or an argument is of another type.

    Parameters
    ----------
    found : iterable of Detection, Circle and Polygon
        What was found. Stretches of a detection's outline that no point lies near are dashed; the rest is dotted if
        the shape is not certain, which a question mark in its middle says. ``Found`` also has walls, which are black
        lines, with a ring where an end was seen; things of no kind, dashed in grey; and strays, small grey dots.
    world : World, optional
        The truth, drawn as light areas and walls; that of the report when not given.
    report : Report, optional
        The comparison of these shapes with the truth: each label then states the largest error of the centre
        and of the dimensions, and what was missed or is a false alarm is named.
    ax, title : optional
        As for ``plot_world``.
    color : color, optional
        Of all outlines that were found; of each kind its own when not given.

    Examples
    --------
    >>> plot_found([Circle((0, 0), 0.1)]).get_title(loc="left")
    '1 shape found'
    """
    beside = found if isinstance(found, Found) else Found()
    found = list(found)
    shapes = [_shape_of(item) for item in found]
    if world is not None:
        check_type(world, World, "world must be of type World")
    if report is not None:
        check_type(report, Report, "report must be of type Report")
    check_look(title, color)
    doubtful = [s for s, item in zip(shapes, found, strict=True) if isinstance(item, Detection) and _is_doubtful(item)]
    cell = resolution_of(beside or found)
    notes, truth = _notes(shapes, report, doubtful, cell), _truth(world, report)
    ax, size = as_axes(ax), USUAL_CELLS * cell if world is None else world.size
    # A found shape may be absurdly large.
    held = [outlines(truth or shapes), *([] if world is not None else _places(beside))]
    room = draw_board(ax, size, np.vstack(held), legend=True, walls=world is not None and world.walled, faint=True)
    draw_areas(ax, truth)
    if report is not None:
        draw_areas(ax, report.missed, facecolor="none", hatch="////")
    things = _draw_rest(ax, beside)
    dashed = [_draw_outline(ax, s, item, color, s in doubtful) for s, item in zip(shapes, found, strict=True)]
    certain = len(doubtful) < len(shapes)
    draw_legend(ax, _found_legend(certain, any(dashed), bool(beside.walls), len(beside.strays) > 0, bool(truth)))
    set_title(ax, _verdict(len(found), report, beside, cell), title)
    labels = [(text, shape, KIND_INKS[shape.kind]) for text, shape in notes]
    told = [thing for thing, true in report.rest.things if true in report.missed] if report is not None else []
    labels += [("of no kind", box, INK) for box, thing in zip(things, beside.others, strict=True) if thing not in told]
    write_labels(ax, labels, [*shapes, *truth, *map(_strip, beside.walls)], room, halo=len(beside.strays) > 0)
    return ax


def _shape_of(item: Detection | Shape) -> Shape:
    shape = item.shape if isinstance(item, Detection) else item
    if not isinstance(shape, (Circle, Polygon)):
        raise ValueError(f"what was found must be detections or shapes, got {type(item).__name__}")
    return shape


def _is_doubtful(one: Detection) -> bool:
    """Tell whether its kind is not beyond doubt, as far as the method asks."""
    return one.choice is not None and not one.certain


def _truth(world: World | None, report: Report | None) -> tuple[Shape, ...]:
    if world is not None:
        return world.shapes
    return () if report is None else (*(m.true for m in report.matches), *report.missed)


def _places(beside: Found) -> list[Floats]:
    """Return where there is anything beside shapes, each of shape (N, 2), metres."""
    ends = [np.array([wall.start, wall.end]) for wall in beside.walls]
    return [*ends, *(other.points for other in beside.others), beside.strays]


# --- what is drawn ----------------------------------------------------------------------------------------------------


def _draw_outline(ax: Axes, shape: Shape, item: Detection | Shape, own: ColorType | None, doubtful: bool) -> bool:
    """Draw a found shape: its outline, its corners and its centre; tell whether any of it was not seen.

    The outline is dashed where none of the points lies near, and elsewhere dotted if the shape is not certain.
    """
    color = KIND_COLORS[shape.kind] if own is None else own
    corners = shape.outline(240) if isinstance(shape, Circle) else shape.vertices
    ring = np.vstack([corners, corners[:1]])
    if isinstance(shape, Polygon):  # fine steps along each side, its two ends included
        ring = np.vstack([np.linspace(a, b, 60) for a, b in pairwise(ring)])
        ax.plot(*corners.T, "o", color="white", markeredgecolor=color, markersize=marks(ax, 4.5), zorder=4)
    seen = np.ones(len(ring), dtype=bool)
    if isinstance(item, Detection):
        seen = is_seen(ring, item.points, resolution_of([item]))
        bare = np.where(seen[:, None] & doubtful, np.nan, ring)
        ax.plot(*bare.T, color=color, linewidth=1.2, linestyle=DASHED, zorder=3)
    line = {"linestyle": DOTTED} if doubtful else {"solid_capstyle": "butt"}
    ax.plot(*np.where(seen[:, None], ring, np.nan).T, color=color, linewidth=2, zorder=3, **line)
    if doubtful:
        ax.plot(*shape.centroid, marker="$?$", color=color, markersize=marks(ax, 9), markeredgewidth=0, zorder=4)
    else:
        draw_center(ax, shape, own)
    return not seen.all()


def _draw_rest(ax: Axes, beside: Found) -> list[Shape]:
    """Draw walls, things of no kind and strays; return these things as shapes, for their labels to go to."""
    for wall in beside.walls:
        ends = np.array([wall.start, wall.end])
        ax.plot(*ends.T, color=INK, linewidth=marks(ax, 2), solid_capstyle="butt", zorder=2.9)
        seen = ends[np.array(wall.ends_seen)]
        ax.plot(*seen.T, "o", color="white", markeredgecolor=INK, markersize=marks(ax, 4.5), zorder=3.1)
    for other in beside.others:
        ring = np.vstack([other.outline, other.outline[:1]])
        ax.plot(*ring.T, color=GREY, linewidth=1.8, linestyle=DASHED, zorder=2.9)
    ax.plot(*beside.strays.T, "o", color=GREY, ms=marks(ax, 2.2), markeredgewidth=0, zorder=2.8, label="stray")
    return [_box(other) for other in beside.others]


def _box(other: Other) -> Shape:
    """Return the smallest rectangle, turned as it likes, around a thing; a circle around points on one line."""
    import shapely

    area = shapely.minimum_rotated_rectangle(shapely.multipoints(np.vstack([other.outline, other.points])))
    if isinstance(area, shapely.Polygon):
        return Polygon(shapely.get_coordinates(area))
    middle = other.points.mean(axis=0)
    return Circle(middle, float(np.hypot(*(other.points - middle).T).max()) or CELL)


def _strip(wall: Wall) -> Polygon:
    """Return a wall as an area, a hundredth as wide as it is long, for labels to keep off."""
    along = wall.end - wall.start
    across = 0.005 * np.array([-along[1], along[0]])
    return Polygon([wall.start - across, wall.end - across, wall.end + across, wall.start + across])


def _found_legend(found: bool, dashed: bool, walls: bool, strays: bool, truth: bool) -> list[Artist]:
    """Return what the legend shows: only what there is; the rest bears its name beside it."""
    known: list[tuple[bool, Artist]] = [
        (found, Line2D([], [], color=INK, linewidth=2, label="found")),
        (dashed, Line2D([], [], color=INK, linewidth=1.2, linestyle=DASHED, label="found, no point near")),
        (walls, Line2D([], [], color=INK, linewidth=2, marker="o", markerfacecolor="white", ms=4, label="wall")),
        (strays, Line2D([], [], color=GREY, marker="o", ms=3, markeredgewidth=0, linestyle="none", label="stray")),
        (truth, Patch(facecolor=GREY, alpha=0.3, label="truth")),
    ]
    return [artist for there, artist in known if there]


# --- what is said -----------------------------------------------------------------------------------------------------


def _notes(
    shapes: Sequence[Shape], report: Report | None, doubtful: Sequence[Shape], cell: float
) -> list[tuple[str, Shape]]:
    """Return what is to be written beside each shape."""

    def name(shape: Shape) -> str:
        return shape.kind + "?" * any(shape is one for one in doubtful)

    if report is None:
        return [(name(shape), shape) for shape in shapes]
    notes = [(_errors(m, name(m.found), cell), m.found) for m in report.matches]
    notes += [(f"{name(shape)}:\nfalse alarm", shape) for shape in report.false_alarms]
    if sorted(map(hash, shapes)) != sorted(hash(shape) for _, shape in notes):
        raise ValueError("report must be about the shapes found, got one about others")
    there = [true for _, true in report.rest.things]
    return notes + [(f"{s.kind}:\n{'found of no kind' if s in there else 'missed'}", s) for s in report.missed]


def _errors(m: Match, name: str, cell: float) -> str:
    """Return a found shape's name and its largest errors, with a word on each that counts as wrong."""
    lines = [name if m.kind_right else f"{name}: wrong,\nit is a {m.true.kind}"]
    lines.append(_in_mm("centre", m.center_error, all(m.center_right), cell))
    if m.dimension_error is not None:
        what = "radius" if isinstance(m.true, Circle) else "sides"
        lines.append(_in_mm(what, m.dimension_error, all(m.dimension_right), cell))
    elif m.kind_right:
        lines.append(f"{len(m.found.dimensions)} sides, not {len(m.true.dimensions)}: wrong")
    return "\n".join(lines)


def _in_mm(what: str, errors: Iterable[float], right: bool, cell: float) -> str:
    """Return the largest of errors, metres, in millimetres, to a tenth of a cell."""
    worst, digits = 1000 * max(map(abs, errors)), digits_of_mm(cell)
    told = f"< {10**-digits:g}" if worst < 0.5 * 10**-digits else f"{worst:.{digits}f}"
    return f"{what} {told} mm" + ("" if right else ": wrong")


def _verdict(n_found: int, report: Report | None, beside: Found, cell: float) -> str:
    """Return the finding in a few words."""
    rest = f"; {beside.rest()}" if beside.rest() else ""
    if report is None or not (report.matches or report.missed or report.false_alarms):
        return f"{count(n_found, 'shape').capitalize()} found{rest}"
    right, n = sum(m.all_right for m in report.matches), len(report.matches) + len(report.missed)
    if right == n and not report.false_alarms:
        return f"{count(n, 'shape')} found, {'all ' if n > 1 else ''}{_closeness(report, cell)}{rest}"
    faults = [f"{len(report.missed)} missed"] if report.missed else []
    faults += [count(len(report.false_alarms), "false alarm")] if report.false_alarms else []
    return ", ".join([f"{right} of {count(n, 'shape')} right" if n else "There is no shape", *faults]) + rest


def _closeness(report: Report, cell: float) -> str:
    if report.protocol == "paper":
        return "right as published"
    worst = max(abs(e) for m in report.matches for e in (*m.center_error, *(m.dimension_error or ())))
    steps = 10 ** digits_of_mm(cell)
    return f"within {math.ceil(1000 * steps * worst - 1e-6) / steps:g} mm"
