"""Scoring: what a result scores, and which of its values are right, while you move tolerance and weights: lesson 07.

>>> scoring()
Slider: tolerance, weight of shape, centre's part of the rest, map, noise
>>> weighted(report_of("ROBUST", "4-03", noise=0), np.array([0.0, 0.01]), (0.4, 0.3, 0.3))  # exactly; within 1 cm
array([0.4, 1. ])
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import numpy as np

from ..arguments import ROUNDING, Floats
from ..evaluation import GATE, evaluate
from ..formats import paper_suite
from ..lidar import Lidar
from ..palette import BLUE, GREY, INK, PALE, SKY, VERMILION
from ..pipeline import PAPER, ROBUST
from ..report import CENTER_WEIGHT, SHAPE_WEIGHT, Match, Report, n_dimensions
from ..study import Experiment, run
from ..world import World
from .drawing import Frame, board_frame, idea_frame, picture, side_by_side
from .slider import Choice, Explorer, Picture, Slider, explore

Weights = tuple[float, float, float]  # of shape, centre and dimensions; their sum is 1

# A fifth of the published trials: on these maps the kinds are the same ones, and the scores within 5 mm too.
QUICK_METHODS = {"PAPER": replace(PAPER, line_trials=2000), "ROBUST": ROBUST}
METHOD_SIGNS = {"PAPER": (VERMILION, "square"), "ROBUST": (BLUE, "dot")}
SCORED_MAPS = ("4-01", "4-03", "4-10")  # on the second and third, circles are named wrongly even without noise
MOST_TOLERANCE = 20.0  # mm: the largest tolerance
CURVE_TOLERANCES = np.linspace(0.0, MOST_TOLERANCE, 201)  # mm

SCORE_FRAME = Frame(
    (0.0, MOST_TOLERANCE),
    (0.0, 1.05),
    "tolerance [mm]",
    "weighted accuracy [-]",
    width=425,
    height=379,
    x_ticks=(0, 5, 10, 15, 20),
    y_ticks=(0.0, 0.2, 0.4, 0.6, 0.8, 1.0),
)
WEIGHTS_FRAME = Frame((0.0, MOST_TOLERANCE), (0.0, 1.0), width=425, height=75 + 24)  # the bar of weights, below
WEIGHTS_ROOM = 46  # px
SCORE_LEGEND = (
    *(("ROBUST", BLUE, "dot"), ("PAPER", VERMILION, "square")),
    ("dashed: too small is right", INK, "ring"),
)
FINDINGS_LEGEND = (("true", GREY, "square"), ("found by ROBUST", BLUE, "line"), ("found by PAPER", VERMILION, "line"))
SCORE_TIE = 1e-9
LETTER_WIDTH = 6.6  # px: the width of one letter in the bar


def scoring() -> Explorer:
    """Return the slider of lesson 07: tolerance and weights; PAPER and ROBUST on three maps, with and without noise."""
    start = CENTER_WEIGHT / (1 - SHAPE_WEIGHT)
    return explore(
        draw_scores,
        Slider("tolerance", 0.0, MOST_TOLERANCE, 0.5, start=5.0, unit="mm"),
        Slider("shape", 0.0, 1.0, 0.05, start=SHAPE_WEIGHT, label="weight of shape"),
        Slider("center", 0.0, 1.0, 0.05, start=round(start, 2), label="centre's part of the rest"),
        Choice("board", SCORED_MAPS, start="4-03", label="map"),
        Slider("noise", 0, 10, 5, start=0, unit="mm"),
        settings={
            "the paper's weights": {},
            "within 1 mm": {"tolerance": 1.0, "noise": 5},
            "only the shape counts": {"shape": 1.0, "noise": 5},
            "only dimensions count": {"shape": 0.0, "center": 0.0, "tolerance": 1.0, "noise": 10},
        },
        diagram=draw_diagram,
        beside=draw_map,
    )


def draw_scores(tolerance: float, shape: float, center: float, board: str, noise: int) -> str:
    """Draw both methods' scores against the tolerance [mm], two-sided and one-sided; noise in mm."""
    weights = (shape, (1 - shape) * center, (1 - shape) * (1 - center))
    results = {name: report_of(name, board, noise) for name in QUICK_METHODS}
    here = np.array([tolerance]) / 1000
    fair, lax = (
        {name: float(weighted(result, here, weights, one_sided=one)[0]) for name, result in results.items()}
        for one in (False, True)
    )
    parts = []
    for name, result in results.items():
        color, marker = METHOD_SIGNS[name]
        curves = [weighted(result, CURVE_TOLERANCES / 1000, weights, one_sided=one) for one in (True, False)]
        parts += [
            SCORE_FRAME.polyline(np.column_stack([CURVE_TOLERANCES, curves[0]]), color, 1.5, "5 3"),
            SCORE_FRAME.polyline(np.column_stack([CURVE_TOLERANCES, curves[1]]), color, 2.5),
            SCORE_FRAME.points([(tolerance, fair[name])], color, marker, 11),
            SCORE_FRAME.points([(tolerance, lax[name])], color, "ring", 16),
        ]
    return picture(
        SCORE_FRAME,
        SCORE_FRAME.segments([(0, 1)], [(MOST_TOLERANCE, 1)], PALE),
        SCORE_FRAME.segments([(tolerance, 0)], [(tolerance, 1.05)], GREY, 1.5, "2 3"),
        *parts,
        below=_bar_of(weights),
        room=WEIGHTS_ROOM,
        legend=SCORE_LEGEND,
        title=f"Within {tolerance:g} mm: ROBUST {_two(fair['ROBUST'])}, PAPER {_two(fair['PAPER'])}",
        says=f"Map {board}, noise {noise} mm, within {tolerance:g} mm: ROBUST scores {_two(fair['ROBUST'])}, PAPER "
        f"{_two(fair['PAPER'])}; one-sided {_two(lax['ROBUST'])} and {_two(lax['PAPER'])}. "
        f"Weights: shape {weights[0]:.2f}, centre {weights[1]:.2f}, dimensions {weights[2]:.2f}.",
    )


def draw_map(tolerance: float, board: str, noise: int, **_weights: float) -> str:
    """Draw the truth, what both methods found, and at each true shape how many of its values are right."""
    frame, parts, n = board_frame(), [], {}
    for (name, (color, _)), width, line in zip(METHOD_SIGNS.items(), (4.0, 1.5), (-3, 12), strict=True):
        report = report_of(name, board, noise)
        found = [match.found for match in report.matches] + list(report.false_alarms)
        counts = [(m.true, n_right(m, tolerance / 1000)) for m in report.matches] + [(s, 0) for s in report.missed]
        parts += [frame.shape(shape, color, width, fill=0) for shape in found]
        for true, right in counts:
            words = f"{right} of {3 + n_dimensions(true)}"
            parts.append(frame.text(true.centroid, words, color, "middle", (0, line)))
        n[name] = sum(right for _, right in counts)
    total = sum(3 + n_dimensions(shape) for shape in _suite()[board].shapes)
    return picture(
        frame,
        *(frame.shape(shape, PALE, width=0, fill=0.5) for shape in _suite()[board].shapes),
        *parts,
        legend=FINDINGS_LEGEND,
        title=f"Right values: ROBUST {n['ROBUST']}, PAPER {n['PAPER']} of {total}",
        says=f"Of {total} values (kinds, x, y, dimensions) ROBUST has {n['ROBUST']} right, PAPER {n['PAPER']}.",
    )


def n_right(match: Match, tolerance: float) -> int:
    """Return how many of a found shape's values are right: the kind, x and y, and the kind's dimensions; metres."""
    errors = [*match.center_error, *(match.dimension_error or () if match.kind_right else ())]
    return int(match.kind_right) + int((np.abs(errors) <= tolerance + ROUNDING).sum())


@cache
def report_of(method: str, board: str, noise: int) -> Report:
    """Return how right a method is on a map of the suite; noise in mm. Found once, then kept."""
    experiment = Experiment(board, _suite()[board], method, QUICK_METHODS[method], lidar=Lidar(noise_std=noise / 1000))
    return evaluate(run(experiment).found, experiment.world)


@cache
def _suite() -> dict[str, World]:
    return paper_suite()


def weighted(report: Report, tolerance: Floats, weights: Weights, *, one_sided: bool = False) -> Floats:
    """Return the weighted accuracy at each tolerance, shape (N,), metres.

    ``one_sided``: every value that is too small counts as right, as in the published scoring (which rounds as well).
    """

    def share(errors: Sequence[float], n: int) -> Floats:
        off = np.array(errors) if one_sided else np.abs(errors)
        return (off <= tolerance[:, None] + ROUNDING).sum(axis=1) / n

    true = [*(match.true for match in report.matches), *report.missed]
    center = share([e for m in report.matches for e in m.center_error], 2 * len(true))
    sizes = [e for m in report.matches if m.kind_right for e in m.dimension_error or ()]
    dimension = share(sizes, sum(map(n_dimensions, true)))
    return weights[0] * report.shape_accuracy + weights[1] * center + weights[2] * dimension


def _two(score: float) -> str:
    """Return a score with two digits; 0.825 is lifted over the edge, where rounding could go either way."""
    return f"{score + SCORE_TIE:.2f}"


def _bar_of(weights: Weights) -> str:
    """Draw the weights as parts of one bar, each with its name where there is room for it."""
    top, bottom = WEIGHTS_FRAME.y[::-1]
    ends = MOST_TOLERANCE * np.cumsum([0.0, *weights])
    parts = [WEIGHTS_FRAME.text((0, 1), "weights [-]", INK, shift=(0, -8))]
    looks = zip(("shape", "centre", "dimensions"), weights, (GREY, SKY, PALE), strict=True)
    for left, right, (name, weight, color) in zip(ends[:-1], ends[1:], looks, strict=True):
        room = (right - left) * WEIGHTS_FRAME.scale[0]
        words = next((w for w in (f"{name} {weight:.2f}", f"{weight:.2f}") if LETTER_WIDTH * len(w) < room), "")
        corners = [(left, top), (right, top), (right, bottom), (left, bottom)]
        parts.append(WEIGHTS_FRAME.area(corners, color, 0.45) if weight else "")
        parts.append(
            WEIGHTS_FRAME.text(((left + right) / 2, bottom), words, INK, "middle", (0, -7), 11) if words else ""
        )
    return "".join(parts)


def draw_diagram() -> Picture:
    """Return the drawing behind one-to-one matching: in list order the first found shape takes another's place."""
    (one, _), (left, two) = 1000 * np.hypot(*(FOUND[:, None] - TRUE).T).T  # mm from each found to each true centre
    beyond = f"found 2 to true A: {left:.0f} mm, beyond the gate of {1000 * GATE:.0f} mm"
    least = f"{one:.0f} mm + {two:.0f} mm = {one + two:.0f} mm, the least for two pairs"
    panels = [
        _pairing([(0, 1)], "First come: 1 match, 1 miss", beyond),
        _pairing([(0, 0), (1, 1)], "All together: both matched", least),
    ]
    captions = ["list order: 1 takes its nearest", "one-to-one, least in all"]
    return Picture(side_by_side(panels, captions), "Diagram: one-to-one matching, in list order and all together")


TRUE, FOUND = np.array([[(0.0, 0.04), (0.075, 0.04)], [(0.044, 0.009), (0.106, 0.015)]])  # m: the diagram's


def _pairing(pairs: list[tuple[int, int]], title: str, note: str) -> str:
    """Draw the centres of two true and two found shapes, and which found one stands for which true one."""
    frame = idea_frame((-0.03, 0.16), (-0.04, 0.067), 425)
    starts, ends = [FOUND[f] for f, _ in pairs], [TRUE[t] for _, t in pairs]
    parts = [frame.segments(starts, ends, BLUE, 3)]
    if len(pairs) == 1:
        parts.append(frame.segments([FOUND[1]], [TRUE[0]], VERMILION, 1.5, "4 4"))
    for start, end in zip(starts, ends, strict=True):
        apart = 1000 * float(np.hypot(*(start - end)))
        side = ("end", (-16, 12)) if start[0] < end[0] else ("start", (9, 0))  # beside the line, not on it
        parts.append(frame.text((start + end) / 2, f"{apart:.0f} mm", BLUE, *side))
    parts += [frame.points(TRUE, INK, "square", 12), frame.points(FOUND, VERMILION, "cross", 12)]
    parts += [frame.text(p, f"true {name}", INK, "middle", (0, -12)) for p, name in zip(TRUE, "AB", strict=True)]
    parts += [frame.text(p, f"found {n}", VERMILION, "middle", (0, 22)) for n, p in enumerate(FOUND, start=1)]
    parts.append(frame.text((0.065, -0.033), note, INK, "middle"))
    return picture(frame, *parts, title=title, says=f"{len(pairs)} of 2 true shapes matched; {note}.")
