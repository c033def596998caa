"""Findings: the shapes that were found, over the truth.

In:  what ``find_shapes`` returned; the ``World`` and the ``Report``, if there are any.
Out: the axes, with outlines, centres and corners, the errors beside each shape, and the outcome as the title.

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
from ..measure import Detection
from ..palette import GREY, INK, KIND_COLORS
from ..report import Match, Report
from ..seen import is_seen
from ..shapes import Circle, Polygon, Shape
from ..table import count
from ..world import World
from .labels import write_labels
from .look import as_axes, check_look, draw_areas, draw_board, draw_center, draw_legend, marks, outlines, set_title

DASHES = (0, (3, 2))


def plot_found(
    found: Iterable[Detection | Shape],
    world: World | None = None,
    ax: Axes | None = None,
    report: Report | None = None,
    *,
    title: str | None = None,
    color: ColorType | None = None,
) -> Axes:
    """Draw the shapes that were found over the truth, with their errors (the paper's Figure 3).

    Raises ValueError if the report is about other shapes than those found, or an argument is of another type.

    Parameters
    ----------
    found : iterable of Detection, Circle and Polygon
        What was found. Stretches of a detection's outline that no point lies near are dashed.
    world : World, optional
        The truth, drawn as light areas; that of the report when not given.
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
    found = list(found)
    shapes = [_shape_of(item) for item in found]
    if world is not None:
        check_type(world, World, "world must be of type World")
    if report is not None:
        check_type(report, Report, "report must be of type Report")
    check_look(title, color)
    notes, truth = _notes(shapes, report), _truth(world, report)
    ax, (size, walls) = as_axes(ax), (1.0, False) if world is None else (world.size, world.walled)
    # A found shape may be absurdly large.
    room = draw_board(ax, size, outlines(truth or shapes), legend=True, walls=walls)
    draw_areas(ax, truth)
    if report is not None:
        draw_areas(ax, report.missed, facecolor="none", hatch="////")
    for item, shape in zip(found, shapes, strict=True):
        _draw_outline(ax, shape, item.points if isinstance(item, Detection) else None, color)
    draw_legend(ax, _found_legend(bool(truth), bool(found)))
    set_title(ax, _verdict(len(found), report), title)
    write_labels(ax, notes, [*shapes, *truth], room)
    return ax


def _shape_of(item: Detection | Shape) -> Shape:
    shape = item.shape if isinstance(item, Detection) else item
    if not isinstance(shape, (Circle, Polygon)):
        raise ValueError(f"what was found must be detections or shapes, got {type(item).__name__}")
    return shape


def _truth(world: World | None, report: Report | None) -> tuple[Shape, ...]:
    if world is not None:
        return world.shapes
    return () if report is None else (*(m.true for m in report.matches), *report.missed)


def _draw_outline(ax: Axes, shape: Shape, points: Floats | None, own: ColorType | None = None) -> None:
    """Draw a found shape: its outline, dashed where none of the points lies near, its corners and its centre."""
    color = KIND_COLORS[shape.kind] if own is None else own
    corners = shape.outline(240) if isinstance(shape, Circle) else shape.vertices
    ring = np.vstack([corners, corners[:1]])
    if isinstance(shape, Polygon):  # fine steps along each side, its two ends included
        ring = np.vstack([np.linspace(a, b, 60) for a, b in pairwise(ring)])
        ax.plot(*corners.T, "o", color="white", markeredgecolor=color, markersize=marks(ax, 4.5), zorder=4)
    if points is not None:
        ax.plot(*ring.T, color=color, linewidth=1.2, linestyle=DASHES, zorder=3)
        ring = np.where(is_seen(ring, points)[:, None], ring, np.nan)
    ax.plot(*ring.T, color=color, linewidth=2, solid_capstyle="butt", zorder=3)
    draw_center(ax, shape, own)


def _found_legend(truth: bool, found: bool) -> list[Artist]:
    lines: list[Artist] = [
        Line2D([], [], color=INK, linewidth=2, label="found"),
        Line2D([], [], color=INK, linewidth=1.2, linestyle=DASHES, label="found, no point near"),
    ]
    return (lines if found else []) + ([Patch(facecolor=GREY, alpha=0.3, label="truth")] if truth else [])


def _notes(shapes: Sequence[Shape], report: Report | None) -> list[tuple[str, Shape]]:
    """Return what is to be written beside each shape."""
    if report is None:
        return [(shape.kind, shape) for shape in shapes]
    notes = [(_errors(m), m.found) for m in report.matches]
    notes += [(f"{shape.kind}:\nfalse alarm", shape) for shape in report.false_alarms]
    if sorted(map(hash, shapes)) != sorted(hash(shape) for _, shape in notes):
        raise ValueError("report must be about the shapes found, got one about others")
    return notes + [(f"{shape.kind}:\nmissed", shape) for shape in report.missed]


def _errors(m: Match) -> str:
    """Return a found shape's kind and its largest errors, with a word on each that counts as wrong."""
    lines = [m.found.kind if m.kind_right else f"{m.found.kind}: wrong,\nit is a {m.true.kind}"]
    lines.append(_in_mm("centre", m.center_error, all(m.center_right)))
    if m.dimension_error is not None:
        what = "radius" if isinstance(m.true, Circle) else "sides"
        lines.append(_in_mm(what, m.dimension_error, all(m.dimension_right)))
    elif m.kind_right:
        lines.append(f"{len(m.found.dimensions)} sides, not {len(m.true.dimensions)}: wrong")
    return "\n".join(lines)


def _in_mm(what: str, errors: Iterable[float], right: bool) -> str:
    worst = 1000 * max(map(abs, errors))
    return f"{what} {'< 0.1' if worst < 0.05 else f'{worst:.1f}'} mm" + ("" if right else ": wrong")


def _verdict(n_found: int, report: Report | None) -> str:
    """Return the finding in a few words."""
    if report is None or not (report.matches or report.missed or report.false_alarms):
        return f"{count(n_found, 'shape').capitalize()} found"
    right, n = sum(m.all_right for m in report.matches), len(report.matches) + len(report.missed)
    if right == n and not report.false_alarms:
        return f"{count(n, 'shape')} found, {'all ' if n > 1 else ''}{_closeness(report)}"
    faults = [f"{len(report.missed)} missed"] if report.missed else []
    faults += [count(len(report.false_alarms), "false alarm")] if report.false_alarms else []
    return ", ".join([f"{right} of {count(n, 'shape')} right" if n else "There is no shape", *faults])


def _closeness(report: Report) -> str:
    if report.protocol == "paper":
        return "right as published"
    worst = max(abs(e) for m in report.matches for e in (*m.center_error, *(m.dimension_error or ())))
    return f"within {math.ceil(1e4 * worst - 1e-6) / 10:g} mm"
