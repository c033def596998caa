"""Steps: your own function in the place of one of the pipeline's.

In:  functions: ``segment(points, n_shapes)``, ``fit_line(points)``, ``fit_circle(points)``, ``measure(points)``,
     ``score(found, world)``.
Out: ``Steps``, for ``find_shapes(points, steps=...)``, and live for ``drive_scene(world, steps=...)``.

>>> from primkit.pipeline import find_shapes
>>> from primkit.shapes import Circle
>>> def through_the_mean(points):
...     center = points.mean(axis=0)
...     return Circle(center, np.hypot(*(points - center).T).mean())
>>> ring = Circle((0.1, 0.0), 0.06).outline(150)
>>> [d.shape for d in find_shapes(ring, steps=Steps(fit_circle=through_the_mean), rng=0)]
[Circle(center=(0.1, 0), radius=0.06)]
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .arguments import ROUNDING, Floats, Labels, short
from .lines import Line
from .measure import Detection, Frame, detection
from .shapes import Circle, Polygon, Shape
from .world import World


@dataclass(frozen=True)
class Steps:
    """Functions of your own for ``find_shapes``; a step that is not given is the library's.

    A shape that your fit returns None for is left out. Its standard deviations belong to the library's fit: a detection
    that yours measured has none. Raises ValueError if a step is not a function.

    Parameters
    ----------
    segment : callable, optional
        ``segment(points, n_shapes)``: points, shape (N, 2), metres, and the number of shapes as it was given to
        ``find_shapes`` (may be None). Returns one whole number for each point; points with the same number
        belong together, and those with a negative one to nothing.
    fit_line : callable, optional
        ``fit_line(points)``: points of one side, shape (N, 2), metres. Returns a ``Line`` or its two numbers
        (angle of the normal, offset), or None when they fix none. ``PAPER`` fits with it what RANSAC found;
        ``ROBUST`` measures with it each side of a polygon that was seen.
    fit_circle : callable, optional
        ``fit_circle(points)``: points of one circle, shape (N, 2), metres. Returns a ``Circle`` or three numbers
        (x, y, radius), or None when they fix none. It measures what was named a circle.
    measure : callable, optional
        ``measure(points)``: points of one group, shape (N, 2), metres. Returns what it is and how large, a ``Circle``
        or a ``Polygon``; the same and its margin, as in ``(shape, 12.5)``, see ``Detection.margin``; or None.
    score : callable, optional
        ``score(found, world)``: the shapes found, a list of ``Circle`` and ``Polygon``, and the ``World``. Returns a
        number from 0 to 1. ``drive_scene`` shows it beside its own; ``find_shapes``, which knows no truth, leaves it.

    Examples
    --------
    >>> Steps(segment=3)
    Traceback (most recent call last):
        ...
    ValueError: segment must be a function, got 3
    """

    segment: Callable[[Floats, int | None], Any] | None = None
    fit_line: Callable[[Floats], Any] | None = None
    fit_circle: Callable[[Floats], Any] | None = None
    measure: Callable[[Floats], Any] | None = None
    score: Callable[[list[Shape], World], Any] | None = None

    def __post_init__(self) -> None:
        for name, step in vars(self).items():
            if step is not None and not callable(step):
                raise ValueError(f"{name} must be a function, got {short(step)}")

    def within(self, frame: Frame) -> Steps:
        """Return the own fits as functions of the frame's points; they themselves are given metres."""

        def line(points: Floats) -> Line | None:
            fit = self.line(frame.metres(points))
            return fit and Line(fit.angle, float(fit.offset - fit.normal @ frame.origin) / frame.unit)

        def circle(points: Floats) -> Circle | None:
            fit = self.circle(frame.metres(points))
            return fit and Circle((fit.center - frame.origin) / frame.unit, fit.radius / frame.unit)

        def measured(points: Floats) -> tuple[Shape | None, float]:
            shape, margin = self.shape(frame.metres(points))
            return shape and in_frame(shape, frame), margin

        return replace(
            self,
            fit_line=self.fit_line and line,
            fit_circle=self.fit_circle and circle,
            measure=self.measure and measured,
        )

    def labels(self, points: Floats, n_shapes: int | None) -> Labels | None:
        """Return what the own ``segment`` says, numbered from 0 without gaps and -1 for strays; None without one."""
        if self.segment is None:
            return None
        labels = _as_array(self.segment(points.copy(), n_shapes))
        if labels is None or labels.shape != (len(points),) or labels.dtype.kind not in "iu":
            got = "nothing that is an array" if labels is None else f"{labels.dtype} of shape {labels.shape}"
            raise ValueError(f"segment must return a whole number for each of the {len(points)} points, got {got}")
        numbered = np.full(len(labels), -1, dtype=np.intp)
        numbered[labels >= 0] = np.unique(labels[labels >= 0], return_inverse=True)[1]
        return numbered

    def line(self, points: Floats) -> Line | None:
        """Return what the own ``fit_line`` says, as a ``Line``."""
        assert self.fit_line is not None  # asked for only where there is one
        line = self.fit_line(points.copy())
        if line is None or isinstance(line, Line):
            return line
        angle, offset = _numbers(line, 2, "fit_line must return a Line, (angle, offset) or None")
        return Line(angle, offset)

    def circle(self, points: Floats) -> Circle | None:
        """Return what the own ``fit_circle`` says, as a ``Circle``."""
        assert self.fit_circle is not None
        circle = self.fit_circle(points.copy())
        if circle is None or isinstance(circle, Circle):
            return circle
        rule = "fit_circle must return a Circle, (x, y, radius) or None"
        x, y, radius = _numbers(circle, 3, rule)
        if radius <= 0:
            raise ValueError(f"{rule}, with a radius > 0, got {short(circle)}")
        return Circle((x, y), radius)

    def shape(self, points: Floats) -> tuple[Shape | None, float]:
        """Return what the own ``measure`` says: the shape, or None, and its margin, NaN when it tells none."""
        assert self.measure is not None
        told = self.measure(points.copy())
        shape, margin = told if isinstance(told, tuple) and len(told) == 2 else (told, np.nan)
        number = _as_array(margin)
        plain = number is not None and number.shape == () and number.dtype.kind in "iuf"
        if not (plain and isinstance(shape, Circle | Polygon | None)):
            raise ValueError(f"measure must return a Circle, a Polygon or None, or (shape, margin), got {short(told)}")
        return shape, float(margin)

    def judged(self, found: Iterable[Detection], world: World) -> float:
        """Return what the own ``score`` says of what was found."""
        assert self.score is not None
        told = self.score([one.shape for one in found], world)
        number = _as_array(told)
        if number is None or number.shape or number.dtype.kind not in "iuf" or not 0 <= number <= 1 + ROUNDING:
            raise ValueError(f"score must return a number from 0 to 1, got {short(told)}")
        return float(number)

    def measured(self, points: Floats, reach: float) -> Detection | None:
        """Return the detection that the own ``measure`` makes of one group; None when that finds nothing."""
        shape, margin = self.shape(points)
        return None if shape is None else replace(detection(shape, points, reach), told_margin=margin)

    def remeasured(self, found: Detection, reach: float, *, sides: bool = True) -> Detection | None:
        """Return the detection measured with the own fits; None when they find nothing.

        Points within ``reach`` metres of the new outline are kept. ``sides``: whether a polygon's are fitted lines.
        """
        shape: Circle | Polygon | None
        if isinstance(found.shape, Circle) and self.fit_circle is not None:
            shape = self.circle(found.points)
        elif isinstance(found.shape, Polygon) and self.fit_line is not None and sides:
            shape = self._polygon(found.shape, found.points)
        else:
            return found
        if shape is None:
            return None
        anew = detection(shape, found.points, reach)
        return replace(found, shape=shape, points=anew.points, rms=anew.rms, seen=anew.seen, sure=None)

    def _polygon(self, polygon: Polygon, points: Floats) -> Polygon | None:
        """Fit a line to the points of each side; neighbouring lines meet in the corners."""
        lines = []
        nearest = nearest_side(polygon, points)
        for side, (corner, normal) in enumerate(zip(polygon.vertices, polygon.normals, strict=True)):
            own = points[nearest == side]
            # Two different points fix a line: a side that was hardly seen stays as it was.
            seen = len(np.unique(own, axis=0)) >= 2
            line = self.line(own) if seen else Line(float(np.arctan2(normal[1], normal[0])), float(normal @ corner))
            if line is None:
                return None
            lines.append(line)
        try:
            corners = [_meet(before, line) for before, line in zip([lines[-1], *lines[:-1]], lines, strict=True)]
            return kept_kind(Polygon(np.array(corners)), polygon)
        except ValueError:
            x, y = polygon.centroid
            raise ValueError(
                f"fit_line's lines along the {polygon.kind} near ({x:.3f}, {y:.3f}) must meet in its corners, "
                f"got angles {', '.join(f'{line.angle:.3g}' for line in lines)}"
            ) from None


def kept_kind(fitted: Polygon, before: Polygon) -> Polygon:
    """Return a polygon whose sides were fitted one by one as the kind that it was before.

    A rectangle's right angles are put right; centroid, mean direction and mean lengths of opposite sides stay.

    Raises
    ------
    ValueError
        If the two do not bend the same way at each corner in turn.

    Examples
    --------
    >>> crooked = Polygon([(0, 0), (80, 0), (80, 44), (0, 40)])
    >>> crooked.kind, kept_kind(crooked, Polygon([(0, 0), (80, 0), (80, 40), (0, 40)])).kind
    ('polygon', 'rectangle')
    """
    if not np.array_equal(np.sign(fitted.turns), np.sign(before.turns)):
        raise ValueError(f"the {before.kind}'s sides must bend as before at each corner")
    if before.kind != "rectangle":
        return fitted
    width, height = (fitted.edges[:2] - fitted.edges[2:]) / 2
    along = width / np.hypot(*width) + [height[1], -height[0]] / np.hypot(*height)
    axes = np.array([along, [-along[1], along[0]]]) / np.hypot(*along)
    half = (fitted.sides[:2] + fitted.sides[2:]) / 4
    return Polygon(fitted.centroid + np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * half @ axes)


def in_frame(shape: Shape, frame: Frame) -> Shape:
    """Return a shape in metres as one of the frame's; ``Detection.in_metres`` leads back."""
    if isinstance(shape, Circle):
        return Circle((shape.center - frame.origin) / frame.unit, shape.radius / frame.unit)
    return Polygon((shape.vertices - frame.origin) / frame.unit)


def nearest_side(polygon: Polygon, points: Floats) -> Labels:
    """Return the number of the side that each point is nearest to, shape (N,).

    >>> nearest_side(Polygon([(0, 0), (1, 0), (0, 1)]), np.array([(0.5, 0.1), (0.1, 0.5)])).tolist()
    [0, 2]
    """
    offset = points[:, None, :] - polygon.vertices
    along = np.clip((offset * polygon.edges).sum(-1) / polygon.sides**2, 0.0, 1.0)
    return np.hypot(*np.moveaxis(offset - along[..., None] * polygon.edges, -1, 0)).argmin(axis=1)


def _meet(a: Line, b: Line) -> Floats:
    """Return where two lines meet, shape (2,); parallel ones meet nowhere, which is a ValueError."""
    normals = np.array([a.normal, b.normal])
    if abs(np.linalg.det(normals)) < 1e-9:  # parallel up to rounding
        raise ValueError("parallel lines do not meet")
    return np.linalg.solve(normals, [a.offset, b.offset])


def _as_array(values: Any) -> NDArray[Any] | None:
    """Return anything as an array; None for what is none, such as rows of different lengths."""
    try:
        return np.asarray(values)
    except ValueError:
        return None


def _numbers(values: Any, n: int, rule: str) -> list[float]:
    """Return n finite numbers, or refuse what is not in one sentence."""
    array = _as_array(values)
    if array is None or array.shape != (n,) or array.dtype.kind not in "iuf" or not np.isfinite(array).all():
        raise ValueError(f"{rule}, got {short(values)}")
    return [float(value) for value in array]
