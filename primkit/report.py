"""Report: how right the finding is, as scores and as a table.

In:  pairs of a found shape and the true one that it stands for, and what is left over; ``evaluate`` makes them.
Out: ``Report``: the scores, and a table with a row for each pair.

>>> from primkit.evaluation import evaluate
>>> from primkit.world import World
>>> from primkit.shapes import Circle
>>> evaluate([Circle((0.001, 0), 0.1)], World([Circle((0, 0), 0.1)]))
true shape  found as  centre off by x, y [mm]  dimensions off by [mm]  verdict
----------  --------  -----------------------  ----------------------  -------
circle      circle    +1.00, +0.00             +0.00                   right
<BLANKLINE>
weighted accuracy 1.000 = 0.4 x shape 1.000 + 0.3 x centre 1.000 + 0.3 x dimensions 1.000  (within 5 mm)
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Literal

from .arguments import Floats
from .measure import Detection
from .paper import published_values
from .rest import Rest
from .shapes import Shape
from .table import Table

Protocol = Literal["fair", "paper"]

SHAPE_WEIGHT, CENTER_WEIGHT, DIMENSION_WEIGHT = 0.4, 0.3, 0.3
PAPER_DIGITS = 2  # after the point: of metres in the published scoring, and of its accuracies


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
    found : tuple of Detection, Circle and Polygon
        What was compared.
    rest : Rest
        What was found beside shapes, compared with the truth.
    """

    matches: tuple[Match, ...]
    missed: tuple[Shape, ...]
    false_alarms: tuple[Shape, ...]
    tolerance: float
    protocol: Protocol = "fair"
    crashed: bool = False
    found: tuple[Detection | Shape, ...] = ()
    rest: Rest = field(default_factory=Rest)

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
        missed = sum(n_dimensions(s, self.protocol) for s in self.missed)
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
    def _asked(self) -> list[Detection]:
        """What was found by a method that asks how certain a kind is; ``PAPER``, and shapes of your own, do not."""
        return [one for one in self.found if isinstance(one, Detection) and one.choice is not None]

    @cached_property
    def uncertain(self) -> tuple[Shape, ...]:
        """Found shapes whose kind is not beyond doubt, as far as the method asks."""
        return tuple(one.shape for one in self._asked if not one.certain)

    @property
    def certain_and_wrong(self) -> tuple[Shape, ...]:
        """Found shapes said to be certain that are of a wrong kind or a false alarm: there should be none."""
        wrong = [*(m.found for m in self.matches if not m.kind_right), *self.false_alarms]
        certain = [one.shape for one in self._asked if one.certain]
        return tuple(shape for shape in wrong if _is_among(shape, certain))

    @property
    def count_right(self) -> bool:
        """Whether as many shapes were found as there are."""
        return len(self.missed) == len(self.false_alarms)

    def rows(self) -> list[tuple[str, str, str, str, str]]:
        """Return a table's rows: true kind, found kind, centre error, dimension errors, verdict."""
        rows: list[tuple[str, str, str, str, str]] = []
        for m in self.matches:
            dimensions = "-" if m.dimension_error is None else _in_mm(m.dimension_error)
            verdict = ("right" if m.all_right else "wrong " + " and ".join(_faults(m))) + self._doubt(m.found)
            rows.append((m.true.kind, m.found.kind, _in_mm(m.center_error), dimensions, verdict))
        rows += [(shape.kind, self._instead(shape), "-", "-", "missed") for shape in self.missed]
        rows += [("-", shape.kind, "-", "-", "false alarm" + self._doubt(shape)) for shape in self.false_alarms]
        return rows

    def _doubt(self, found: Shape) -> str:
        """Return a word on a found shape that is not certain."""
        return ", not certain" * _is_among(found, self.uncertain)

    def _instead(self, missed: Shape) -> str:
        """Return as what a missed shape was found."""
        return "of no kind" if _is_among(missed, [true for _, true in self.rest.things if true]) else "-"

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
        """Return the rows as a table, and below it the scores, and what there is beside the shapes."""
        return Table(REPORT_HEADER, self.rows(), notes=(self.scores(), *filter(None, [str(self.rest)])))

    def __repr__(self) -> str:
        table = self.table()
        return "\n".join([f"{replace(table, notes=())}\n", *table.notes])  # the scores stay on one line

    def _repr_html_(self) -> str:
        return self.table()._repr_html_()


REPORT_HEADER = ("true shape", "found as", "centre off by x, y [mm]", "dimensions off by [mm]", "verdict")


def _is_among(shape: Shape, shapes: Iterable[Shape]) -> bool:
    """Tell whether it is one of them, and not only equal to one."""
    return any(shape is other for other in shapes)


def n_dimensions(shape: Shape, protocol: Protocol = "fair") -> int:
    """Return how many dimensions of a true shape are scored."""
    return len(published_values(shape, truth=True)) - 2 if protocol == "paper" else len(shape.dimensions)


def _share(right: Sequence[bool], wrong: int, nothing: float) -> float:
    """Return the share of right values, ``wrong`` more of them being wrong; ``nothing`` when there are none at all."""
    total = len(right) + wrong
    return sum(right) / total if total else nothing


def _in_mm(errors: Iterable[float]) -> str:
    return ", ".join(f"{round(1000 * e, 2) + 0.0:+.2f}" for e in errors)  # + 0.0: no "-0.00"


def _faults(m: Match) -> list[str]:
    parts = {"kind": m.kind_right, "centre": all(m.center_right), "dimensions": all(m.dimension_right)}
    return [part for part, right in parts.items() if not right and (part != "dimensions" or m.kind_right)]
