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

* missed: no found shape stands for it, though it may have been found as a thing of no kind
* false alarm: a found shape, certain or not, that stands for no true one. Walls, things of no kind and strays claim to
  be no shape and are no false alarms: ``Report.rest`` tells how right they are.

``protocol="paper"`` repeats the published scoring, which is no measure of how right a method is: see ``evaluate``. A
shape of a wrong kind ends it before anything is written: only runs without one are in the published tables.

Sources: the weights are the paper's; the assignment is optimal, Kuhn (1955), "The Hungarian method".
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from .arguments import ROUNDING, as_positive, check_type, doubt, short
from .found import Found, resolution_of
from .measure import CELL, Detection
from .paper import published_values
from .report import PAPER_DIGITS, Match, Protocol, Report, n_dimensions
from .rest import Rest
from .shapes import Circle, Polygon, Shape
from .world import World

TOLERANCE = 0.005  # m on a board of 1 m, or cells of 1 mm
GATE = 0.10  # m on the same: a shape whose centre is farther off than a large circle's radius is another shape

PAPER_TOLERANCE = 0.001  # m: of the published scoring, which rounds both sides to 1 cm


def evaluate(
    found: Iterable[Detection | Shape],
    world: World,
    tolerance: float | None = None,
    *,
    protocol: Protocol = "fair",
    gate: float | None = None,
) -> Report:
    """Compare what was found with the truth.

    Raises ValueError if something else than shapes was found, or tolerance or gate is negative.

    Parameters
    ----------
    found : iterable of Detection, Circle and Polygon
        What ``find_shapes`` returned, or shapes of your own.
    world : World, the truth
    tolerance : float, optional
        A value is right when it is at most this far from the truth, in metres; 5 mm when not given.
    protocol : {"fair", "paper"}
        ``"fair"``: two-sided, unrounded, paired by the optimal assignment. ``"paper"``: as in the published
        code, where both are rounded to 1 cm, every value that is too small counts as right, pairs are made in the
        order of kind and x, a rectangle's found height is compared with its true width, and a wrong kind ends it all
        (``Report.crashed``); see ``paper.published_values``. Tolerance and gate then play no part.
    gate : float, optional
        A found shape whose centre is farther than this from a true one cannot stand for it, in metres; 10 cm when not
        given.

    Notes
    -----
    Lengths that are not given follow the scale: where both the board is larger than 1 m and the cells are larger than
    1 mm (or both are smaller), they grow (or shrink) as the lesser of these two changes says. So a board of 10 m on
    cells of 1 cm is right within 5 cm, and one of 1 m within 5 mm whatever its cells are. The report says which.

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
    given = {"tolerance": tolerance, "gate": gate}
    known = {name: as_positive(value, name, zero=True) for name, value in given.items() if value is not None}
    for name, value in known.items():
        if value > world.size:
            doubt(f"{name} is {value:g} m on a board of {world.size:g} m: is it in millimetres?", depth=1)
    beside = found if isinstance(found, Found) else Found()
    found = found if isinstance(found, Found) else tuple(found)
    scale = sorted((1.0, world.size, resolution_of(found) / CELL))[1]
    tolerance, gate = known.get("tolerance", scale * TOLERANCE), known.get("gate", scale * GATE)
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
        found=tuple(found),
        rest=Rest.of(beside, world, tolerance),
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
    gate = as_positive(gate, "gate", zero=True)
    ours, theirs = [_as_shape(item) for item in found], [_as_shape(item) for item in true]
    if not ours or not theirs:
        return []
    offset = np.array([f.centroid for f in ours])[:, None] - np.array([t.centroid for t in theirs])
    distance = np.hypot(offset[..., 0], offset[..., 1])
    allowed = distance <= gate + ROUNDING
    if allowed.sum(axis=0).max() <= 1 and allowed.sum(axis=1).max() <= 1:  # nobody has a choice
        return sorted(((int(f), int(t)) for f, t in np.argwhere(allowed)), key=lambda p: p[1])
    from scipy.optimize import linear_sum_assignment  # only now: it takes a while to load

    # A pair that is not allowed costs more than all allowed pairs together: none of them is given up for it.
    cost = np.where(allowed, distance, (gate + 1) * (min(allowed.shape) + 1))
    rows, columns = linear_sum_assignment(cost)
    return sorted(((int(f), int(t)) for f, t in zip(rows, columns, strict=True) if allowed[f, t]), key=lambda p: p[1])


def _compare_fairly(found: Shape, true: Shape, tolerance: float) -> Match:
    """Compare centroids and dimensions, both ways; sides in order under the best cyclic shift."""
    center, ours, theirs = found.centroid - true.centroid, np.array(found.dimensions), np.array(true.dimensions)
    if found.kind != true.kind or len(ours) != len(theirs):
        return Match(found, true, center, None, _within(center, tolerance), (False,) * n_dimensions(true))
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


def _within(errors: Iterable[float], tolerance: float) -> tuple[bool, ...]:
    return tuple(bool(abs(e) <= tolerance + ROUNDING) for e in errors)
