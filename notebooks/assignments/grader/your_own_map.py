"""The capstone, your own map: a pipeline on the student's own scans, and a hunt for three bugs.

In:  the student's ``my_shapes`` and ``measure_pillars``; the truth of the student's board from ``personal_truth``.
Out: marks.

>>> MEASURE_PILLARS.mark(pillars)
6.0
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from types import FunctionType
from typing import Any

import numpy as np
from numpy.typing import NDArray

import primkit as pk
from primkit.checks import Check
from primkit.checks.answer import Case
from primkit.checks.judges import Judge
from primkit.evaluation import Report
from primkit.grading import Mark, OutOfTime, Part, Task, personal_truth
from primkit.personal import personal_scans
from primkit.shapes import KINDS

from .parts import TURN, Fault, shown, task

Floats = NDArray[np.float64]

TOLERANCE = 0.005  # m


# --- a pipeline on the student's own scans -----------------------------------------------------------------


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
            return f"got {shown(got)}, expected a list of pk.Circle and pk.Polygon"
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
        return ", ".join([f"{right} names are right", *wrong, *["too many shapes"] * bool(report.false_alarms)])

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


@contextmanager
def without(*functions: Callable[..., Any]) -> Iterator[None]:
    """Let functions of the library refuse to work, by whatever name a student has imported them."""

    def refuse(*_arguments: Any, **_options: Any) -> Any:
        raise RuntimeError("in the capstone, find_shapes and measure_shape are yours to write")

    plain = [function for function in functions if isinstance(function, FunctionType)]
    before = [function.__code__ for function in plain]
    for function in plain:
        function.__code__ = refuse.__code__
    try:
        yield
    finally:
        for function, code in zip(plain, before, strict=True):
            function.__code__ = code


def remembered(function: Callable[..., Any]) -> Callable[[pk.Scans], Any]:
    """Return a function that runs once for each board, whatever comes of it: all parts look at the same answer."""
    known: dict[bytes, Any] = {}

    def once(scans: pk.Scans) -> Any:
        key = scans.poses.tobytes()
        if key not in known:
            # Noted beforehand: when its time is over there is none left for a note, and no part need wait again.
            known[key] = None, OutOfTime("my_shapes did not come to an end")
            try:
                known[key] = function(scans), None
            except Exception as error:
                known[key] = None, error
        result, error = known[key]
        if error is not None:
            raise error
        return result

    return once


class OwnMap(Task):
    """A task that runs the student's pipeline once for each board, without the library's own."""

    def marked(self, function: Any, scope: Mapping[str, Any] | None = None, *, seconds: float = 60.0) -> Mark:
        """Return points and table together."""
        if isinstance(function, str):
            if function not in (scope or {}):
                return super().marked(function, scope, seconds=seconds)
            function = (scope or {})[function]
        with without(pk.find_shapes, pk.measure_shape):
            return super().marked(remembered(function) if callable(function) else function, seconds=seconds)

    def mark(self, function: Any, scope: Mapping[str, Any] | None = None, *, seconds: float = 60.0) -> float:
        """Return the points, and show the table."""
        return super().mark(function, scope, seconds=seconds)


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
        when=lambda cases: all(len(kinds_of(c)) == 4 and sorted(kinds_of(c)) != sorted(KINDS) for c in cases),
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


# --- a hunt for three bugs ---------------------------------------------------------------------------------


def pillars(poses: Floats, angles: Floats, ranges: Floats, range_max: float) -> Floats:
    """Return (x, y, radius) of each pillar, shape (K, 3), metres; a reading of range_max is no hit."""
    return with_bugs()(poses, angles, ranges, range_max)


def with_bugs(*bugs: str) -> Callable[..., Floats]:
    """Return the function with some of its bugs: "limit", "heading", "mean"."""

    def measured_pillars(poses: Floats, angles: Floats, ranges: Floats, range_max: float) -> Floats:
        hit = ranges <= range_max if "limit" in bugs else ranges < range_max
        heading = -poses[:, 2:] if "heading" in bugs else poses[:, 2:]
        bearing = (heading + angles)[hit]
        places = np.repeat(poses[:, None, :2], len(angles), axis=1)[hit]
        points = places + ranges[hit][:, None] * np.column_stack([np.cos(bearing), np.sin(bearing)])
        labels = pk.link(points)
        return np.array([circle_of(points[labels == k], "mean" in bugs) for k in range(labels.max(initial=-1) + 1)])

    return measured_pillars


def circle_of(points: Floats, mean: bool) -> tuple[float, float, float]:
    """Return x, y and radius of a circle through points, or around their mean."""
    if mean:
        x, y = points.mean(axis=0)
        return float(x), float(y), float(np.hypot(*(points - (x, y)).T).mean())
    circle = pk.fit_circle(points)
    return (np.nan, np.nan, np.nan) if circle is None else (*circle.center.tolist(), circle.radius)


def judge_pillars(got: Any, expected: Any, _args: tuple[Any, ...]) -> str | None:
    """Judge circles in any order, within 2 mm."""
    try:
        rows = np.asarray(got, dtype=float)
    except (TypeError, ValueError):
        return f"got {shown(got)}, expected rows (x, y, radius)"
    if rows.ndim != 2 or rows.shape[1] != 3:
        return f"got {shown(got)}, expected rows (x, y, radius)"
    if len(rows) != len(expected):
        return f"got {len(rows)} pillar{'s' * (len(rows) != 1)}, expected {len(expected)}"
    for row in expected:
        mine = rows[np.argmin(np.hypot(*(rows[:, :2] - row[:2]).T))]
        off = 1000 * (mine - row)
        if not np.hypot(*off[:2]) <= 2:
            return f"the centre of a pillar is off by {np.hypot(*off[:2]):.0f} mm"
        if not abs(off[2]) <= 2:
            return f"the radius of a pillar is off by {off[2]:+.0f} mm"
    return None


def stands(rng: np.random.Generator) -> list[pk.Circle]:
    """Return one or two pillars, far apart."""
    places = np.array([(-0.25, 0.2), (0.25, -0.2)])[: int(rng.integers(1, 3))]
    return [pk.Circle(place + rng.uniform(-0.03, 0.03, 2), rng.uniform(0.05, 0.08)) for place in places]


def aimed(rng: np.random.Generator, views: int) -> tuple[list[pk.Circle], Floats]:
    """Return pillars, and poses evenly around each of them, 12 cm before its outline and looking at it."""
    some = stands(rng)
    turns = rng.uniform(0, TURN) + TURN * np.arange(views) / views
    rows = []
    for pillar in some:
        ring = pillar.center + (pillar.radius + 0.12) * np.column_stack([np.cos(turns), np.sin(turns)])
        rows.append(np.column_stack([ring, turns + np.pi]))
    return some, np.vstack(rows)


def readings(some: list[pk.Circle], poses: Floats, angles: Floats, range_max: float) -> tuple[Any, ...]:
    """Return the arguments of one call: what the sensor reads, its limit where nothing is hit."""
    ranges = pk.cast_rays(pk.World(some), poses, angles, range_max=range_max)
    return poses, angles, np.minimum(ranges, range_max), range_max


def turned_robots(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield robots that look at pillars from all sides; every beam hits."""
    for _ in range(8):
        some, poses = aimed(rng, 24)
        yield readings(some, poses, np.linspace(-0.2, 0.2, 11), 1.0)


def readings_at_the_limit(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield robots that all look along x, with beams all around; most beams hit nothing."""
    for _ in range(5):
        some, poses = aimed(rng, 36)
        yield readings(some, poses * [1.0, 1.0, 0.0], TURN * np.arange(120) / 120, 0.2)


def seen_from_one_side(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield robots that look along x at a pillar before them; every beam hits."""
    for _ in range(8):
        (pillar, *_) = stands(rng)
        side = np.linspace(-0.2, 0.2, 5) * pillar.radius
        x, y = pillar.center
        poses = np.column_stack([np.full(5, x - pillar.radius - 0.1), y + side, np.zeros(5)])
        yield readings([pillar], poses, np.linspace(-0.2, 0.2, 15), 1.0)


HINTS = {
    "heading": "A bug is left: draw the hits of one turned robot. Do bearings count from its heading?",
    "limit": "A bug is left: what does this sensor read where nothing is hit, and what becomes of it?",
    "mean": "A bug is left: where is the mean of points on one side of a circle?",
}
NAMES = {
    "heading": "heading subtracted",
    "limit": "limit taken for a hit",
    "mean": "mean taken for the centre",
}
# The bug that shows, and those that are left; where only one of them shows, it is found alone.
LEFT = (
    *(("heading", "heading"), ("limit", "limit"), ("mean", "mean")),
    *(("heading", "heading", "mean"), ("limit", "limit", "mean"), ("limit", "limit", "heading", "mean")),
)

MEASURE_PILLARS = task(
    "measure_pillars",
    pillars,
    judge_pillars,
    (
        ("robots that look in any direction", 2, turned_robots),
        ("beams that hit nothing", 2, readings_at_the_limit),
        ("pillars seen from one side", 2, seen_from_one_side),
    ),
    tuple(Fault(HINTS[bug], like=with_bugs(*bugs), name=NAMES[bug]) for bug, *bugs in LEFT),
)
