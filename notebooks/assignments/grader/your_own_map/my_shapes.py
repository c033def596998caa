"""A pipeline on the student's own scans: which shapes stand where, and how large they are.

In:  the student's ``my_shapes``; the truth of the student's board from ``personal_truth``.
Out: marks.

>>> MY_SHAPES.mark(true_shapes)
8.0
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

import primkit as pk
from primkit.checks import Check
from primkit.checks.answer import Case
from primkit.checks.judges import Judge
from primkit.course.grading import Mark, OutOfTime, Part, Task, personal_truth
from primkit.course.grading.mark import Row
from primkit.course.personal import personal_scans
from primkit.evaluation import Report
from primkit.shapes import PRIMITIVES

from ..parts import Fault, shown

Floats = NDArray[np.float64]

TOLERANCE = 0.005  # m


def boards() -> list[tuple[pk.Scans, pk.World]]:
    """Return scans and truth of the student's board, as it is and turned round: a stored answer fits only one."""
    world = personal_truth()
    scans = personal_scans(world)
    angle, offset = 0.7, np.array([0.2, -0.1])
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    moved = pk.World([placed(shape, turn, offset) for shape in world.shapes], size=2.0)
    poses = np.column_stack([scans.poses[:, :2] @ turn.T + offset, scans.poses[:, 2] + angle])
    return [(scans, world), (pk.Scans(poses, scans.angles, scans.ranges, scans.inside), moved)]


def placed(shape: Any, turn: Floats, offset: Floats) -> Any:
    """Return a shape turned about the origin, then shifted."""
    if shape.kind == "circle":
        return pk.Circle(turn @ shape.center + offset, shape.radius)
    return pk.Polygon(shape.vertices @ turn.T + offset)


def true_shapes(scans: pk.Scans) -> list[Any]:
    """Return the shapes of the board that the scans show."""
    return next(list(world.shapes) for known, world in boards() if np.array_equal(known.poses, scans.poses))


def own_board(_rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield the scans of both boards."""
    for scans, _ in boards():
        yield (scans,)


def judged_by(off: Callable[[Report], str | None]) -> Judge:
    """Return a judge that compares what was found with the truth, and lets ``off`` say what is off."""

    def judge(got: Any, expected: Any, _args: tuple[Any, ...]) -> str | None:
        if not isinstance(got, (list, tuple)) or not got:
            kind = f"{type(got).__name__} with " if isinstance(got, np.ndarray) else ""
            return f"got {kind}{shown(got)}, expected a list of pk.Circle and pk.Polygon"
        try:
            return off(pk.evaluate(got, pk.World(expected, size=2.0), TOLERANCE))
        except (ValueError, TypeError):
            return f"got {shown(got)}, expected a list of pk.Circle and pk.Polygon"

    return judge


def all_there(report: Report) -> str | None:
    """Say which shapes are missed, or too many."""
    if not report.missed and not report.false_alarms:
        return None
    return f"{len(report.missed)} of {len(report.matches) + len(report.missed)} shapes are missed, " + (
        f"and {len(report.false_alarms)} of those found stand for nothing"
    )


def named(at_least: int) -> Callable[[Report], str | None]:
    """Ask for so many right names, and not more found than there are."""

    def off(report: Report) -> str | None:
        right = sum(match.kind_right for match in report.matches)
        wrong = [f"a {m.true.kind} is called a {m.found.kind}" for m in report.matches if not m.kind_right]
        if right >= at_least and not report.false_alarms:
            return None
        names = "1 name is right" if right == 1 else f"{right} names are right"
        return ", ".join([names, *wrong, *["too many shapes"] * bool(report.false_alarms)])

    return off


def centered(within: float) -> Callable[[Report], str | None]:
    """Ask for all centres within so many metres."""

    def off(report: Report) -> str | None:
        errors = [float(np.abs(match.center_error).max()) for match in report.matches]
        if not report.missed and max(errors, default=1.0) <= within:
            return None
        pairs = zip(report.matches, errors, strict=True)
        far = [f"that of the {match.true.kind} by {1000 * error:.0f} mm" for match, error in pairs if error > within]
        return "centres are off: " + ", ".join([*far, *[f"a {shape.kind} is missed" for shape in report.missed]])

    return off


def measured(share: float) -> Callable[[Report], str | None]:
    """Ask for a share of all dimensions within the tolerance."""

    def off(report: Report) -> str | None:
        if report.dimension_accuracy >= share - 1e-9:
            return None
        return f"{100 * report.dimension_accuracy:.0f} % of the dimensions are within 5 mm"

    return off


REFUSED = "is yours to write: it refuses to work"  # what ready-made functions say where a submission runs


class Once:
    """A function that runs once for each board, whatever comes of it: all parts look at the same answer."""

    def __init__(self, function: Any) -> None:
        self.function = function
        self.known: dict[bytes, tuple[Any, BaseException | None]] = {}
        self.tries = 2

    @property
    def remarks(self) -> set[str]:
        """What was seen beside."""
        return set(self.function.remarks)

    def afresh(self) -> Once:
        """Begin, and once more where the time was over."""
        if self.tries and (not self.known or any(isinstance(error, OutOfTime) for _, error in self.known.values())):
            self.tries -= 1
            self.known.clear()
            self.function.afresh()
        return self

    def __call__(self, scans: pk.Scans) -> Any:
        """Return or raise what came of this board."""
        key = scans.poses.tobytes()
        if key not in self.known:
            try:
                self.known[key] = self.function(scans), None
            except KeyboardInterrupt:
                raise
            except BaseException as error:
                self.known[key] = None, error
        result, error = self.known[key]
        if error is not None:
            raise error
        return result


def told_of_ready_made(row: Row) -> Row:
    """Give a part its own short name where the function has called what it must not."""
    used = row.answer.fault == "raises RuntimeError" and REFUSED in row.answer.says
    return replace(row, answer=replace(row.answer, fault="uses find_shapes")) if used else row


class OwnMap(Task):
    """A task that runs the student's pipeline once for each board."""

    def called(self, function: Any) -> Once:
        """Let all parts look at one answer."""
        return Once(function)

    def marked(self, function: Any, scope: Mapping[str, Any] | None = None) -> Mark:
        """Return points and table together."""
        mark = super().marked(function, scope)
        return Mark(mark.task, tuple(map(told_of_ready_made, mark.rows)))


def kinds_of(case: Case) -> list[str]:
    """Return the kinds of what came back."""
    return [getattr(shape, "kind", "") for shape in case.got] if isinstance(case.got, (list, tuple)) else []


def box(shape: Any) -> bool:
    """Tell whether a shape is a rectangle that stands upright."""
    return getattr(shape, "kind", "") == "rectangle" and bool((np.abs(shape.edges).min(axis=1) < 1e-9).all())


OWN_FAULTS = (
    Fault(
        "There are more shapes than on the board: does a group fall apart?",
        when=lambda cases: all(len(kinds_of(case)) > 4 for case in cases),
        name="groups fall apart",
    ),
    Fault(
        "Everything is a circle: how near do the points come to it, and how near to a polygon?",
        when=lambda cases: all(set(kinds_of(case)) == {"circle"} for case in cases),
        name="everything is a circle",
    ),
    Fault(
        "These are boxes around the shapes, from the leftmost point to the rightmost: shapes are turned.",
        when=lambda cases: (
            all(kinds_of(c) and all(box(s) for s in c.got if s.kind != "circle") for c in cases)
            and any("rectangle" in kinds_of(case) for case in cases)
        ),
        name="boxes around the shapes",
    ),
    Fault(
        "There are fewer shapes than on the board: do groups run together, or get lost?",
        when=lambda cases: all(0 < len(kinds_of(case)) < 4 for case in cases),
        name="shapes lost",
    ),
    Fault(
        "The numbers of sides are wrong: does a corner count as a short side, or a side as two?",
        when=lambda cases: all(len(kinds_of(c)) == 4 and sorted(kinds_of(c)) != sorted(PRIMITIVES) for c in cases),
        name="sides miscounted",
    ),
    Fault(
        "It is right on your board, and wrong when the same board is turned and shifted: what is written down in it?",
        when=lambda cases: len(cases) == 2 and cases[0].off is None and cases[1].off is not None,
        name="right in one frame only",
    ),
)


def own_part(says: str, points: float, off: Callable[[Report], str | None]) -> Part:
    """Return a part of the task about the student's own board."""
    return Part(says, points, Check("my_shapes", true_shapes, own_board, judged_by(off), OWN_FAULTS))


MY_SHAPES = OwnMap(
    "my_shapes",
    (
        own_part("every shape found, and nothing else", 2, all_there),
        own_part("at least three names right", 1, named(3)),
        own_part("all four names right", 1, named(4)),
        own_part("all centres within 2 cm", 1, centered(0.02)),
        own_part("all centres within 5 mm", 1, centered(TOLERANCE)),
        own_part("half of the dimensions within 5 mm", 1, measured(0.5)),
        own_part("all dimensions within 5 mm", 1, measured(1.0)),
    ),
)
