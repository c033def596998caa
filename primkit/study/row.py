"""Row: what became of one map with one method.

In:  the scores, errors and times of an experiment.
Out: a ``Row``, which also knows its scores at other tolerances, and which error belongs to which shape.

>>> right = Score(weighted=1.0, shape=1.0, center=1.0, dimension=1.0)
>>> row = Row("mine", "ROBUST", ("circle",), "automatic", 0.005, False, 1, right, right, (0.0, 0.002), (0.0,), 7.7, 0.1)
>>> row.count_right, row.within(0.001).center
(True, 0.5)
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import islice
from typing import Literal

from ..arguments import ROUNDING
from ..report import CENTER_WEIGHT, DIMENSION_WEIGHT, SHAPE_WEIGHT
from ..shapes import Kind

Movement = Literal["automatic", "manual"]
Errors = tuple[float, ...]  # found - true, metres

N_DIMENSIONS: dict[Kind, int] = {"circle": 1, "triangle": 3, "rectangle": 2, "pentagon": 5}


@dataclass(frozen=True)
class Score:
    """The scores of one map, each from 0 to 1; ``weighted`` is the total."""

    weighted: float
    shape: float
    center: float
    dimension: float


@dataclass(frozen=True)
class Row:
    """What became of one map with one method. Rows are equal when all but the measured time is.

    Parameters
    ----------
    map, settings : str
        The names of the map and of the method.
    kinds : tuple of str
        The kinds of the map's shapes.
    movement : {"automatic", "manual"}
        Set down on way-points, or driven.
    tolerance : float
        Of the fair protocol, in metres.
    told : bool
        Whether the method was told how many shapes there are.
    n_found : int
        How many shapes were found.
    fair, paper : Score
        Two-sided within the tolerance, and scored as published; see ``evaluate``.
    center_errors, dimension_errors : tuple of float
        found - true for each coordinate and dimension that can be compared, metres; paired fairly. Infinite for
        the sides of a polygon found with another number of them.
    robot_time : float
        Number of scans times the LiDAR's period, seconds.
    computing_time : float
        Filling the grid and finding the shapes, seconds on this machine.
    found_as : tuple of str and None
        For each of ``kinds``, the kind of the shape that was found in its place; None where it was missed.
    seen : tuple of float
        For each of ``kinds``, the share of its outline that the drive saw; empty with automatic movement.
    dimension_counts : tuple of int
        For each of ``kinds``, how many dimensions the true shape has; may be empty without a ``"polygon"``.
    sensor : {"exact", "webots"}
        The LiDAR's model.
    crashed : bool
        Whether the published scoring ends at a wrong kind; ``paper`` is then 0 in all.
    """

    map: str
    settings: str
    kinds: tuple[Kind, ...]
    movement: Movement
    tolerance: float
    told: bool
    n_found: int
    fair: Score
    paper: Score
    center_errors: tuple[float, ...]
    dimension_errors: tuple[float, ...]
    robot_time: float
    computing_time: float = field(compare=False)
    found_as: tuple[Kind | None, ...] = ()
    seen: tuple[float, ...] = ()
    dimension_counts: tuple[int, ...] = ()

    @property
    def _counts(self) -> tuple[int, ...]:
        return self.dimension_counts or tuple(N_DIMENSIONS[kind] for kind in self.kinds)

    sensor: str = "exact"
    crashed: bool = False

    @property
    def n_shapes(self) -> int:
        """How many shapes there are."""
        return len(self.kinds)

    @property
    def n_dimensions(self) -> int:
        """How many dimensions these have together."""
        return sum(self._counts)

    @property
    def n_false(self) -> int:
        """How many shapes were found where there are none."""
        return self.n_found - sum(kind is not None for kind in self.found_as)

    @property
    def count_right(self) -> bool:
        """Whether as many shapes were found as there are."""
        return self.n_found == self.n_shapes

    def within(self, tolerance: float) -> Score:
        """Return the fair scores at another tolerance, metres: the errors tell them.

        Examples
        --------
        >>> right, half = Score(1.0, 1.0, 1.0, 1.0), Score(0.55, 1.0, 0.5, 0.0)
        >>> errors = {"center_errors": (0.0, 0.002), "dimension_errors": (-0.004,)}
        >>> row = Row("", "", ("circle",), "automatic", 0.005, False, 1, right, right, *errors.values(), 7.7, 0.1)
        >>> row.within(0.005) == right, row.within(0.001) == half
        (True, True)
        """
        if not self.kinds:
            return self.fair
        center = _n_right(self.center_errors, tolerance) / (2 * self.n_shapes)
        dimension = _n_right(self.dimension_errors, tolerance) / self.n_dimensions
        return _weighted(self.fair.shape, center, dimension)

    def scores_by_shape(self) -> list[Score]:
        """Return the fair scores of each true shape by itself: nothing is right of one that was missed.

        Examples
        --------
        >>> right, kinds = Score(1.0, 1.0, 1.0, 1.0), ("circle", "circle")
        >>> errors = {"center_errors": (0.0, 0.009), "dimension_errors": (0.001,)}
        >>> row = Row("", "", kinds, "manual", 0.005, False, 1, right, right, **errors, robot_time=1.0,
        ...           computing_time=0.1, found_as=("circle", None))
        >>> [(score.shape, score.center, score.dimension) for score in row.scores_by_shape()]
        [(1.0, 0.5, 1.0), (0.0, 0.0, 0.0)]
        """
        return [
            _weighted(
                float(kind == found),
                _n_right(center, self.tolerance) / 2,
                _n_right(dimension, self.tolerance) / n,
            )
            for n, (kind, found, center, dimension) in zip(self._counts, self._by_shape(), strict=True)
        ]

    def errors_by_shape(self) -> list[tuple[Errors, Errors] | None]:
        """Return for each true shape its centre's and its dimensions' errors, metres.

        None for a shape that was missed, or found as one of another kind.
        """
        return [(center, dimension) if kind == found else None for kind, found, center, dimension in self._by_shape()]

    def _by_shape(self) -> Iterator[tuple[Kind, Kind | None, Errors, Errors]]:
        """Yield for each true shape its kind, the kind found, and the errors of its centre and its dimensions."""
        centers, dimensions = iter(self.center_errors), iter(self.dimension_errors)
        for kind, found, n in zip(self.kinds, self.found_as, self._counts, strict=True):
            center = tuple(islice(centers, 2 * (found is not None)))
            yield kind, found, center, tuple(islice(dimensions, n * (kind == found)))


def _n_right(errors: Errors, tolerance: float) -> int:
    return sum(abs(error) <= tolerance + ROUNDING for error in errors)


def _weighted(shape: float, center: float, dimension: float) -> Score:
    weighted = SHAPE_WEIGHT * shape + CENTER_WEIGHT * center + DIMENSION_WEIGHT * dimension
    return Score(weighted, shape, center, dimension)
