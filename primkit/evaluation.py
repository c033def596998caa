"""Evaluation: how right the finding is.

In:  what was found (detections or shapes) and the ``World`` with the truth.
Out: ``Report``: which found shape stands for which true one, how far off each value is, and the scores.

>>> world = World([Circle((0, 0), 0.1)])
>>> report = evaluate([Circle((0.001, 0), 0.1)], world)
>>> report.weighted_accuracy, report.matches[0].center_error.round(4).tolist()
(1.0, [0.001, 0.0])

    weighted accuracy = 0.4 shape + 0.3 centre + 0.3 dimensions

* shape accuracy: matched shapes of the right kind / (true shapes + false alarms)
* centre accuracy: coordinates (x and y apart) with ``|found - true| <= tolerance`` / (2 x true shapes)
* dimension accuracy: dimensions with ``|found - true| <= tolerance`` / (dimensions of all true shapes)

A missed true shape is wrong in every part; a false alarm is one more wrong shape.

``protocol="paper"`` repeats the published scoring, which is no measure of how right a method is: see ``evaluate``. A
shape of a wrong kind ends it before anything is written: only runs without one are in the published tables.

Sources: the weights are the paper's; the assignment is optimal, Kuhn (1955), "The Hungarian method".
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from .arguments import ROUNDING, Floats, as_positive, check_type, doubt, short
from .measure import Detection
from .paper import published_values
from .shapes import Circle, Polygon, Shape
from .table import Table
from .world import World

Protocol = Literal["fair", "paper"]

SHAPE_WEIGHT, CENTER_WEIGHT, DIMENSION_WEIGHT = 0.4, 0.3, 0.3
GATE = 0.10  # m: a shape whose centre is farther off than a large circle's radius is another shape

# The published scoring: both sides rounded to 1 cm, right when found - true < 1 mm; accuracies to two decimals.
PAPER_DIGITS, PAPER_TOLERANCE = 2, 0.001


@dataclass(frozen=True, eq=False)
class Match:
    """A true shape and the found one that stands for it.

    Parameters
    ----------
    found, true : Circle or Polygon
    center_error : array, shape (2,)
        found - true, x and y, metres.
    dimension_error : tuple of float, or None
        found - true for each, metres; None when kinds or numbers of corners differ: there is nothing to compare.
    center_right, dimension_right : tuple of bool
        Which of the values count as right.
    """

    found: Shape
    true: Shape
    center_error: Floats
    dimension_error: tuple[float, ...] | None
    center_right: tuple[bool, ...]
    dimension_right: tuple[bool, ...]

    @property
    def kind_right(self) -> bool:
        """Whether the found shape has the true kind."""
        return self.found.kind == self.true.kind

    @property
    def all_right(self) -> bool:
        """Whether kind, centre and dimensions are all right."""
        return self.kind_right and all(self.center_right) and all(self.dimension_right)


@dataclass(frozen=True, eq=False)
class Report:
    """The outcome of a comparison; prints as a table, shows as HTML in a notebook.

    Parameters
    ----------
    matches : tuple of Match, in the order of the true shapes
    missed, false_alarms : tuple of Circle and Polygon
        True shapes that nothing found stands for; found shapes that stand for nothing.
    tolerance : float, metres
    protocol : {"fair", "paper"}
        How it was scored.
    crashed : bool
        Whether the published scoring ends without a result, for a shape of a wrong kind: it looks for a dimension that
        the true shape does not have. (A pentagon in the place of a rectangle passes.) All accuracies are then 0. What
        it does when shapes are missing is not known; they count as wrong in every part.
    """

    matches: tuple[Match, ...]
    missed: tuple[Shape, ...]
    false_alarms: tuple[Shape, ...]
    tolerance: float
    protocol: Protocol = "fair"
    crashed: bool = False

    @property
    def shape_accuracy(self) -> float:
        """Matched shapes of the right kind / (true shapes + false alarms)."""
        wrong = len(self.missed) + len(self.false_alarms)
        return self._told(_share([m.kind_right for m in self.matches], wrong, nothing=1.0))

    @property
    def center_accuracy(self) -> float:
        """Coordinates within tolerance / (2 x true shapes)."""
        right = [r for m in self.matches for r in m.center_right]
        return self._told(_share(right, 2 * len(self.missed), nothing=float(not self.false_alarms)))

    @property
    def dimension_accuracy(self) -> float:
        """Dimensions within tolerance / dimensions of all true shapes."""
        right = [r for m in self.matches for r in m.dimension_right]
        missed = sum(_n_dimensions(s, self.protocol) for s in self.missed)
        return self._told(_share(right, missed, nothing=float(not self.false_alarms)))

    @property
    def weighted_accuracy(self) -> float:
        """0.4 shape + 0.3 centre + 0.3 dimension accuracy."""
        return self._told(
            SHAPE_WEIGHT * self.shape_accuracy
            + CENTER_WEIGHT * self.center_accuracy
            + DIMENSION_WEIGHT * self.dimension_accuracy
        )

    def _told(self, accuracy: float) -> float:
        """Return an accuracy as the protocol tells it: the published one rounds, and tells none of a crashed run."""
        if self.protocol == "fair":
            return accuracy
        return 0.0 if self.crashed else round(accuracy, PAPER_DIGITS)

    @property
    def count_right(self) -> bool:
        """Whether as many shapes were found as there are."""
        return len(self.missed) == len(self.false_alarms)

    def rows(self) -> list[tuple[str, str, str, str, str]]:
        """Return a table's rows: true kind, found kind, centre error, dimension errors, verdict."""
        rows: list[tuple[str, str, str, str, str]] = []
        for m in self.matches:
            dimensions = "-" if m.dimension_error is None else _in_mm(m.dimension_error)
            verdict = "right" if m.all_right else "wrong " + " and ".join(_faults(m))
            rows.append((m.true.kind, m.found.kind, _in_mm(m.center_error), dimensions, verdict))
        rows += [(shape.kind, "-", "-", "-", "missed") for shape in self.missed]
        rows += [("-", shape.kind, "-", "-", "false alarm") for shape in self.false_alarms]
        return rows

    def scores(self) -> str:
        """Return the scores as one sentence."""
        if self.crashed:
            return "crashed: the published scoring ends at a shape of a wrong kind, and no accuracy is told"
        rule = f"within {1000 * self.tolerance:g} mm" if self.protocol == "fair" else "scored as published"
        return (
            f"weighted accuracy {self.weighted_accuracy:.3f} = 0.4 x shape {self.shape_accuracy:.3f}"
            f" + 0.3 x centre {self.center_accuracy:.3f} + 0.3 x dimensions {self.dimension_accuracy:.3f}  ({rule})"
        )

    def table(self) -> Table:
        """Return the rows as a table, and the scores below it."""
        return Table(REPORT_HEADER, self.rows(), notes=(self.scores(),))

    def __repr__(self) -> str:
        return f"{replace(self.table(), notes=())}\n\n{self.scores()}"  # the scores stay on one line

    def _repr_html_(self) -> str:
        return self.table()._repr_html_()


REPORT_HEADER = ("true shape", "found as", "centre off by x, y [mm]", "dimensions off by [mm]", "verdict")


def evaluate(
    found: Iterable[Detection | Shape],
    world: World,
    tolerance: float = 0.005,
    *,
    protocol: Protocol = "fair",
    gate: float = GATE,
) -> Report:
    """Compare what was found with the truth.

    Raises ValueError if something else than shapes was found, or tolerance or gate is negative.

    Parameters
    ----------
    found : iterable of Detection, Circle and Polygon
        What ``find_shapes`` returned, or shapes of your own.
    world : World, the truth
    tolerance : float
        A value is right when it is at most this far from the truth, in metres.
    protocol : {"fair", "paper"}
        ``"fair"``: two-sided, unrounded, paired by the optimal assignment. ``"paper"``: as in the published
        code, where both are rounded to 1 cm, every value that is too small counts as right, pairs are made in the
        order of kind and x, a rectangle's found height is compared with its true width, and a wrong kind ends it all
        (``Report.crashed``); see ``paper.published_values``. Tolerance and gate then play no part.
    gate : float
        A found shape whose centre is farther than this from a true one cannot stand for it, in metres.

    Examples
    --------
    A missed shape counts as wrong in every part:

    >>> evaluate([], World([Circle((0, 0), 0.1)])).weighted_accuracy
    0.0
    >>> evaluate([], World()).weighted_accuracy
    1.0
    """
    check_type(world, World, "world must be a World, as in evaluate(found, world)")
    check_type(found, Iterable, "found must be a list of detections or shapes, as in evaluate(found, world)")
    tolerance, gate = as_positive(tolerance, "tolerance", zero=True), as_positive(gate, "gate", zero=True)
    for name, value in (("tolerance", tolerance), ("gate", gate)):
        if value > world.size:
            doubt(f"{name} is {value:g} m on a board of {world.size:g} m: is it in millimetres?", depth=1)
    shapes, crashed = [_as_shape(item) for item in found], False
    if protocol == "fair":
        pairs = match(shapes, world.shapes, gate)
        compare = _compare_fairly
    elif protocol == "paper":
        pairs = _match_as_published(shapes, world.shapes)
        compare, tolerance = _compare_as_published, PAPER_TOLERANCE
        crashed = any(not _values(shapes[f], False).keys() <= _values(world.shapes[t], True).keys() for f, t in pairs)
    else:
        raise ValueError(f'protocol must be "fair" or "paper", got {short(protocol)}')
    matched_found, matched_true = {f for f, _ in pairs}, {t for _, t in pairs}
    return Report(
        matches=tuple(compare(shapes[f], world.shapes[t], tolerance) for f, t in pairs),
        missed=tuple(s for i, s in enumerate(world.shapes) if i not in matched_true),
        false_alarms=tuple(s for i, s in enumerate(shapes) if i not in matched_found),
        tolerance=tolerance,
        protocol=protocol,
        crashed=crashed,
    )


def match(
    found: Iterable[Detection | Shape], true: Iterable[Detection | Shape], gate: float = GATE
) -> list[tuple[int, int]]:
    """Return pairs (index found, index true) with the least total centre distance, in the order of the true.

    As many pairs as possible are made, each with its centres at most ``gate`` metres apart. Raises ValueError if the
    gate is not a finite number >= 0.

    >>> a, b = Circle((0, 0), 0.1), Circle((0.05, 0), 0.1)
    >>> match([b, a], [a, b])
    [(1, 0), (0, 1)]
    >>> match([a], [])
    []
    """
    from scipy.optimize import linear_sum_assignment

    gate = as_positive(gate, "gate", zero=True)
    ours, theirs = [_as_shape(item) for item in found], [_as_shape(item) for item in true]
    if not ours or not theirs:
        return []
    offset = np.array([f.centroid for f in ours])[:, None] - np.array([t.centroid for t in theirs])
    distance = np.hypot(offset[..., 0], offset[..., 1])
    allowed = distance <= gate + ROUNDING
    # A pair that is not allowed costs more than all allowed pairs together: none of them is given up for it.
    cost = np.where(allowed, distance, (gate + 1) * (min(allowed.shape) + 1))
    rows, columns = linear_sum_assignment(cost)
    return sorted(((int(f), int(t)) for f, t in zip(rows, columns, strict=True) if allowed[f, t]), key=lambda p: p[1])


def _compare_fairly(found: Shape, true: Shape, tolerance: float) -> Match:
    """Compare centroids and dimensions, both ways; sides in order under the best cyclic shift."""
    center, ours, theirs = found.centroid - true.centroid, np.array(found.dimensions), np.array(true.dimensions)
    if found.kind != true.kind or len(ours) != len(theirs):
        return Match(found, true, center, None, _within(center, tolerance), (False,) * _n_dimensions(true))
    shifts = range(len(theirs)) if len(theirs) >= 3 else [0]
    errors = [np.roll(ours, shift) - theirs for shift in shifts]
    dimension = tuple(min(errors, key=lambda e: float(np.abs(e).sum())).tolist())
    return Match(found, true, center, dimension, _within(center, tolerance), _within(dimension, tolerance))


def _match_as_published(found: Sequence[Shape], true: Sequence[Shape]) -> list[tuple[int, int]]:
    """Pair the shapes in the order of kind and x, as the published code does."""

    def in_order(shapes: Sequence[Shape], truth: bool) -> list[int]:
        return sorted(range(len(shapes)), key=lambda i: (shapes[i].kind, _values(shapes[i], truth)["x"]))

    return sorted(zip(in_order(found, False), in_order(true, True), strict=False), key=lambda p: p[1])


def _compare_as_published(found: Shape, true: Shape, tolerance: float) -> Match:
    """Compare as in the published code: rounded to 1 cm, and without an absolute value."""
    ours, theirs = _values(found, False), _values(true, True)
    errors = {name: ours[name] - theirs[name] for name in ours if name in theirs}
    center, dimension = [errors.pop("x"), errors.pop("y")], tuple(errors.values())
    return Match(
        found,
        true,
        np.array(center),
        dimension if found.kind == true.kind else None,
        tuple(e < tolerance for e in center),
        tuple(e < tolerance for e in dimension),
    )


def _values(shape: Shape, truth: bool) -> dict[str, float]:
    """Return the numbers that the published scoring compares, rounded as it rounds them."""
    return {name: round(value, PAPER_DIGITS) for name, value in published_values(shape, truth=truth).items()}


def _as_shape(item: Detection | Shape) -> Shape:
    shape = item.shape if isinstance(item, Detection) else item
    if not isinstance(shape, (Circle, Polygon)):
        raise ValueError(f"what was found must be detections or shapes, got {type(item).__name__}")
    return shape


def _n_dimensions(shape: Shape, protocol: Protocol = "fair") -> int:
    return len(published_values(shape, truth=True)) - 2 if protocol == "paper" else len(shape.dimensions)


def _within(errors: Iterable[float], tolerance: float) -> tuple[bool, ...]:
    return tuple(bool(abs(e) <= tolerance + ROUNDING) for e in errors)


def _share(right: Sequence[bool], wrong: int, nothing: float) -> float:
    """Return the share of right values, ``wrong`` more of them being wrong; ``nothing`` when there are none at all."""
    total = len(right) + wrong
    return sum(right) / total if total else nothing


def _in_mm(errors: Iterable[float]) -> str:
    return ", ".join(f"{round(1000 * e, 2) + 0.0:+.2f}" for e in errors)  # + 0.0: no "-0.00"


def _faults(m: Match) -> list[str]:
    parts = {"kind": m.kind_right, "centre": all(m.center_right), "dimensions": all(m.dimension_right)}
    return [part for part, right in parts.items() if not right and (part != "dimensions" or m.kind_right)]
