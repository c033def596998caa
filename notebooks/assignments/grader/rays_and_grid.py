"""Problem set 1, rays and grid: a curved wall, a sonar with a wide cone, a grid that counts.

In:  the student's ``ray_arc``, ``sonar_reading`` and ``busy_cells``.
Out: marks.

>>> RAY_ARC.mark(hit_arc)
4.0
"""

# ruff: noqa: ARG005 (a wrong way may leave out what it is given)

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from primkit.checks.judges import number

from .parts import EDGE, INF, TURN, Fault, places, task

Floats = NDArray[np.float64]

CASES = 60  # random ones, in each part


# --- a beam and a curved wall ------------------------------------------------------------------------------


def roots(origin: Floats, direction: Floats, center: Floats, radius: float) -> tuple[float, float] | None:
    """Return where the beam's line goes into the full circle and out again, metres along it; None beside it."""
    to_center = center - origin
    along = float(to_center @ direction)
    under_root = radius**2 - (to_center @ to_center - along**2)
    return None if under_root < 0 else (along - float(np.sqrt(under_root)), along + float(np.sqrt(under_root)))


def bearing_of(origin: Floats, direction: Floats, center: Floats, t: float) -> float:
    """Return the bearing of the place t metres along the beam, seen from the centre, radians in (-pi, pi]."""
    x, y = origin + t * direction - center
    return float(np.arctan2(y, x))


def hit_arc(origin: Floats, direction: Floats, center: Floats, radius: float, start: float, sweep: float) -> float:
    """Return the distance along the beam to the curved wall, metres; inf without a hit ahead."""
    for t in roots(origin, direction, center, radius) or ():
        if t >= 0 and (bearing_of(origin, direction, center, t) - start) % TURN <= sweep:
            return t
    return INF


def arc_like(which: Any = (0, 1), ahead: Any = lambda t: t >= 0, on_wall: Any = None) -> Any:
    """Return a wrong way: other roots, another rule for what is ahead, or for what is on the wall."""

    def hit(origin: Floats, direction: Floats, center: Floats, radius: float, start: float, sweep: float) -> float:
        both = roots(origin, direction, center, radius)
        for t in [both[k] for k in which] if both else []:
            bearing = bearing_of(origin, direction, center, t)
            met = (bearing - start) % TURN <= sweep if on_wall is None else on_wall(bearing, start, sweep)
            if ahead(t) and met:
                return t
        return INF

    return hit


def bearing_from_robot(
    origin: Floats, direction: Floats, center: Floats, radius: float, start: float, sweep: float
) -> float:
    """Compare the beam's own bearing with the arc's."""
    bearing = float(np.arctan2(direction[1], direction[0]))
    return next(
        (t for t in roots(origin, direction, center, radius) or () if t >= 0 and (bearing - start) % TURN <= sweep), INF
    )


def arcs(
    rng: np.random.Generator, wanted: Any, *, start: tuple[float, float], sweep: tuple[float, float], ahead: bool = True
) -> Any:
    """Yield random beams and walls as wanted: ``wanted(inside, t of both roots, whether each is on the wall)``."""
    n = 0
    while n < CASES:
        center, radius = rng.uniform(-0.3, 0.3, 2), float(rng.uniform(0.05, 0.25))
        first, turn = float(rng.uniform(*start)), float(rng.uniform(*sweep))
        origin = center + rng.uniform(0.2, 3.0) * radius * unit(rng.uniform(0, TURN))
        aim = center + rng.uniform(0.0, 1.3) * radius * unit(rng.uniform(0, TURN)) - origin
        direction = (1 if ahead else -1) * aim / np.hypot(*aim)
        inside = bool(np.hypot(*(origin - center)) < radius)
        both = roots(origin, direction, center, radius)
        turns = [(bearing_of(origin, direction, center, t) - first) % TURN for t in both or ()]
        near_end = any(min(abs(b - turn), b, TURN - b) < EDGE for b in turns)
        aside = abs(float(direction[0] * (center - origin)[1] - direction[1] * (center - origin)[0]))
        if near_end or abs(aside - radius) < EDGE or (both and min(map(abs, both)) < EDGE):
            continue
        if wanted(inside, both, [b <= turn for b in turns]):
            n += 1
            yield origin, direction, center, radius, first, turn


def unit(bearing: float) -> Floats:
    """Return the arrow of length 1 at a bearing."""
    return np.array([np.cos(bearing), np.sin(bearing)])


UPPER = {"start": (0.0, 1.0), "sweep": (0.5, 2.1)}  # walls whose bearings stay within 0 and pi
DOWN, UP, WALL = np.array([0.0, -1.0]), np.array([0.0, 1.0]), (np.array([0.3, 0.0]), 0.1, 0.0, np.pi)


def near_side(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield beams from outside that meet the wall's near side, or pass the whole circle by."""
    yield np.array([0.3, 0.5]), DOWN, *WALL
    yield np.array([0.5, 0.5]), DOWN, *WALL  # beside
    wanted = lambda inside, both, on: not inside and (not both or (both[0] > 0 and on[0]))  # noqa: E731
    yield from arcs(rng, wanted, **UPPER)


def opening(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield beams from outside that come in through the opening."""
    yield np.array([0.3, -0.5]), UP, *WALL
    yield np.array([0.5, -0.01]), np.array([-1.0, 0.0]), *WALL  # in through the opening, and out again
    wanted = lambda inside, both, on: both and not inside and both[0] > 0 and not on[0]  # noqa: E731
    yield from arcs(rng, wanted, **UPPER)


def over_the_end(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield walls that go on beyond the bearing at which bearings begin anew."""
    yield np.array([0.6, 0.0]), np.array([-1.0, 0.0]), np.array([0.3, 0.0]), 0.1, 1.5 * np.pi, np.pi
    yield np.zeros(2), np.array([1.0, 0.0]), np.array([0.3, 0.0]), 0.1, 0.75 * np.pi, 0.5 * np.pi
    wanted = lambda inside, both, on: both and not inside and both[0] > 0 and (on[0] or not on[1])  # noqa: E731
    for begin in (2.0, 5.0):
        yield from arcs(rng, wanted, start=(begin, begin + 1), sweep=(1.5, 4.0))


def inside_or_behind(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield beams from within the circle, and beams that look away from it."""
    yield np.array([0.3, 0.05]), UP, *WALL
    yield np.array([0.3, 0.5]), UP, *WALL  # behind
    yield from arcs(rng, lambda inside, both, on: inside and both and any(on), **UPPER)
    yield from arcs(rng, lambda inside, both, on: both and not inside and any(on), **UPPER, ahead=False)


GOING_ROUND = "Bearings begin anew after a full turn, a wall does not. How far is it from start to hit, going round?"

RAY_ARC = task(
    "ray_arc",
    hit_arc,
    number("m"),
    (
        ("meets the near side of the wall", 1, near_side),
        ("comes in through the opening", 1, opening),
        ("walls that go on beyond bearing 0 or pi", 1, over_the_end),
        ("from inside, and with the wall behind", 1, inside_or_behind),
    ),
    (
        Fault(
            "Every hit is right. A beam that meets nothing must return float('inf'), not None.",
            when=lambda cases: (
                all((case.got is None) == (case.expected == INF) for case in cases)
                and not any(case.off for case in cases if case.expected != INF)
            ),
            name="None for no hit",
        ),
        Fault(
            "The circle has two roots. When the first one falls into the opening, where does the beam go on to?",
            like=arc_like((0,)),
            name="near root alone",
        ),
        Fault(
            "That is the whole circle: is the hit on the part of it that is built?",
            like=arc_like(on_wall=lambda *_: True),
            name="whole circle for arc",
        ),
        Fault(
            "That is the far side where the near one is met first.", like=arc_like((1, 0)), name="far root before near"
        ),
        Fault(
            "Walls behind the robot are hit too: is t >= 0 asked for?",
            like=arc_like(ahead=lambda t: True),
            name="hits behind the robot",
        ),
        Fault(
            "The wall goes counter-clockwise from its start: here it goes the other way.",
            like=arc_like(on_wall=lambda b, start, sweep: (start - b) % TURN <= sweep),
            name="clockwise for counter-clockwise",
        ),
        Fault(
            GOING_ROUND,
            like=arc_like(on_wall=lambda b, start, sweep: start <= b <= start + sweep),
            name="bearing not wrapped",
        ),
        Fault(
            GOING_ROUND,
            like=arc_like(on_wall=lambda b, start, sweep: start <= b % TURN <= start + sweep),
            name="bearing not wrapped",
        ),
        Fault(
            "The second number is how far the wall goes on, not where it ends.",
            like=arc_like(on_wall=lambda b, start, sweep: (b - start) % TURN <= (sweep - start) % TURN),
            name="sweep taken for the end",
        ),
        Fault(
            "The bearing of a hit counts from the circle's centre, not from the robot.",
            like=bearing_from_robot,
            name="bearing from the robot",
        ),
    ),
)


# --- a sonar with a wide cone ------------------------------------------------------------------------------


def nearest_echo(ranges: Floats, angles: Floats, axis: float, cone: float, range_min: float, range_max: float) -> float:
    """Return the nearest range in the cone that lies within the sensor's limits, metres; inf without one."""
    heard = (aside(angles, axis) <= cone / 2) & (ranges >= range_min) & (ranges <= range_max)
    return float(ranges[heard].min(initial=INF))


def aside(angles: Floats, axis: float) -> Floats:
    """Return how far each bearing is from the axis, radians from 0 to pi."""
    return np.abs((angles - axis + np.pi) % TURN - np.pi)


def sonar_like(in_cone: Any = lambda angles, axis, cone: aside(angles, axis) <= cone / 2, read: Any = None) -> Any:
    """Return a wrong way: another cone, or another reading of the ranges in it."""

    def reading(ranges: Floats, angles: Floats, axis: float, cone: float, range_min: float, range_max: float) -> float:
        mine = ranges[in_cone(angles, axis, cone)]
        if read is not None:
            return float(read(mine, range_min, range_max))
        return float(mine[(mine >= range_min) & (mine <= range_max)].min(initial=INF))

    return reading


def nearest_or_none(mine: Floats, low: float, high: float) -> float:
    """Take the nearest first, and drop it when it is out of the limits."""
    nearest = np.nanmin(mine, initial=INF)
    return nearest if low <= nearest <= high else INF


def cut_to_limits(mine: Floats, low: float, high: float) -> float:
    """Take the nearest first, and cut it to the limits."""
    nearest = np.nanmin(mine, initial=INF)
    return float(np.clip(nearest, low, high)) if nearest < INF else INF


def mean_echo(mine: Floats, low: float, high: float) -> float:
    """Return the mean of what is within the limits."""
    kept = mine[(mine >= low) & (mine <= high)]
    return kept.mean() if len(kept) else INF


def fans(rng: np.random.Generator, axes: tuple[float, float], fill: Any) -> Iterator[tuple[Any, ...]]:
    """Yield fans of ranges and cones; ``fill(rng, in the cone)`` gives the ranges, the limits are 0.05 and 0.3 m."""
    n = 0
    while n < CASES:
        beams = int(rng.integers(24, 72))
        angles = TURN * np.arange(beams) / beams
        axis, cone = float(rng.uniform(*axes)) % TURN, float(rng.uniform(0.3, 1.2))
        if np.abs(aside(angles, axis) - cone / 2).min() > EDGE:
            n += 1
            yield fill(rng, aside(angles, axis) <= cone / 2), angles, axis, cone, 0.05, 0.3


def within_limits(rng: np.random.Generator, cone: Any) -> Floats:
    """Return ranges within the limits, as a rule nearer outside the cone."""
    return np.where(cone, rng.uniform(0.15, 0.3, len(cone)), rng.uniform(0.06, 0.3, len(cone)))


def with_near_and_far(rng: np.random.Generator, cone: Any) -> Floats:
    """Return ranges of which many in the cone are too near or too far."""
    ranges = np.where(rng.random(len(cone)) < 0.4, rng.uniform(0.01, 0.049, len(cone)), within_limits(rng, cone))
    return np.where(rng.random(len(cone)) < 0.4, rng.uniform(0.31, 0.9, len(cone)), ranges)


def with_losses(rng: np.random.Generator, cone: Any) -> Floats:
    """Return ranges of which many are lost (nan) or meet nothing (inf); now and then all in the cone."""
    lost = rng.random(len(cone)) < rng.choice([0.3, 1.0])
    return np.where(lost & cone, rng.choice([np.nan, INF], len(cone)), within_limits(rng, cone))


FOUR = np.array([0.0, 0.5, 1.0, 1.5]) * np.pi


def plain_cones(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield cones that do not hold bearing 0."""
    yield np.array([0.1, 0.2, 0.15, 0.12]), FOUR, np.pi / 2, 1.0, 0.05, 0.3
    yield from fans(rng, (1.3, 5.0), within_limits)


def cones_ahead(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield cones that look along bearing 0, from both sides of it."""
    yield np.array([0.25, 0.1, 0.1, 0.2]), FOUR, 0.1, 3.6, 0.05, 0.3
    yield from fans(rng, (-0.14, 0.14), within_limits)


def near_and_far(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield cones with things that are too near, and too far."""
    yield np.array([0.1, 0.02, 0.25, 0.6]), FOUR, np.pi, 4.0, 0.05, 0.3
    yield from fans(rng, (1.3, 5.0), with_near_and_far)


def lost_and_empty(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield cones with lost echoes, with nothing in range, or without a beam."""
    yield np.array([0.1, np.nan, 0.25, INF]), FOUR, np.pi, 4.0, 0.05, 0.3
    yield np.array([0.1, 0.1, 0.1, 0.1]), FOUR, np.pi / 4, 0.2, 0.05, 0.3  # between two beams
    yield from fans(rng, (1.3, 5.0), with_losses)


SONAR_READING = task(
    "sonar_reading",
    nearest_echo,
    number("m"),
    (
        ("the nearest echo in the cone", 1, plain_cones),
        ("cones that look across bearing 0", 1, cones_ahead),
        ("echoes that are too near or too far", 1, near_and_far),
        ("lost echoes and empty cones", 1, lost_and_empty),
    ),
    (
        Fault(
            "The cone's width counts from edge to edge: how far is it from the axis to one edge?",
            like=sonar_like(lambda angles, axis, cone: aside(angles, axis) <= cone),
            name="whole cone to each side",
        ),
        Fault(
            "A bearing just below a full turn is near bearing 0: the plain difference does not know that.",
            like=sonar_like(lambda angles, axis, cone: np.abs(angles - axis) <= cone / 2),
            name="bearing not wrapped",
        ),
        Fault(
            "Something too near is not heard at all, and so cannot hide what is heard behind it.",
            like=sonar_like(read=nearest_or_none),
            name="too near hides the rest",
        ),
        Fault(
            "An echo outside the limits is not heard; cutting it to a limit reports a thing that is not there.",
            like=sonar_like(read=cut_to_limits),
            name="cut to the limits",
        ),
        Fault(
            "Things nearer than range_min are reported: the sonar is still deaf then.",
            like=sonar_like(read=lambda mine, low, high: mine[mine <= high].min(initial=INF)),
            name="no range_min",
        ),
        Fault(
            "Things beyond range_max are reported.",
            like=sonar_like(read=lambda mine, low, high: mine[mine >= low].min(initial=INF)),
            name="no range_max",
        ),
        Fault("The sonar reports the first echo, not the mean of all.", like=sonar_like(read=mean_echo), name="mean"),
        Fault(
            "Some readings are nan: a lost echo is no echo. (nan is neither below nor above any number.)",
            when=lambda cases: any(isinstance(case.got, float) and np.isnan(case.got) for case in cases),
            name="nan spreads",
        ),
    ),
)


# --- a grid that counts ------------------------------------------------------------------------------------


def counted(points: Floats, corner: Floats, resolution: float, shape: tuple[int, int], least: int) -> Floats:
    """Return the centres of the cells that hold enough points, shape (K, 2), metres, world frame."""
    cells = np.floor((points - corner) / resolution)
    on_board = ((cells >= 0) & (cells < shape)).all(axis=1)
    busy, hits = np.unique(cells[on_board], axis=0, return_counts=True)
    return corner + (busy[hits >= least] + 0.5) * resolution


def count_like(
    to_cells: Any = lambda points, corner, h: np.floor((points - corner) / h),
    keep: Any = lambda cells, shape: cells[((cells >= 0) & (cells < shape)).all(axis=1)],
    enough: Any = lambda hits, least: hits >= least,
    to_world: Any = lambda busy, corner, h: corner + (busy + 0.5) * h,
) -> Any:
    """Return a wrong way with one of the four steps done in another way."""

    def count(points: Floats, corner: Floats, resolution: float, shape: tuple[int, int], least: int) -> Floats:
        cells = keep(to_cells(points, corner, resolution), np.asarray(shape))
        busy, hits = np.unique(cells.reshape(-1, 2), axis=0, return_counts=True)
        return np.asarray(to_world(busy[enough(hits, least)], corner, resolution))

    return count


def closed_board(cells: Floats, shape: NDArray[np.int64]) -> Floats:
    """Count the first cell beyond the far borders to the last one on the board; right only for points on a border."""
    cells = np.where(cells == shape, shape - 1, cells)
    return cells[((cells >= 0) & (cells < shape)).all(axis=1)]


def boards(rng: np.random.Generator, least: Any, off: float) -> Iterator[tuple[Any, ...]]:
    """Yield points on boards whose corner lies anywhere, up to ``off`` board lengths beside it; not on borders."""
    n = 0
    while n < CASES:
        resolution = float(rng.choice([0.005, 0.02, 0.05]))
        shape = (int(rng.integers(3, 7)), int(rng.integers(7, 10)))
        corner = rng.uniform(-1, 1, 2)
        size = resolution * np.array(shape)
        points = corner + rng.uniform(-off, 1 + off, (int(rng.integers(5, 60)), 2)) * size
        place = (points - corner) / resolution
        if np.abs(place - np.round(place)).min() > EDGE:
            n += 1
            yield points, corner, resolution, shape, int(rng.integers(*least))


CORNER = np.array([-0.5, -0.5])


def on_the_board(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield points on the board; one in a cell is enough."""
    yield np.array([[-0.493, -0.488]]), CORNER, 0.005, (200, 200), 1
    yield from boards(rng, (1, 2), 0.0)


def enough_hits(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield points on the board; two to four in a cell are needed."""
    yield np.array([[-0.493, -0.488], [-0.494, -0.487], [0.1, 0.2]]), CORNER, 0.005, (200, 200), 2
    yield from boards(rng, (2, 5), 0.0)


def beside_the_board(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield points on the board and beside it, on all sides."""
    yield np.array([[-0.493, -0.488], [-0.501, 0.0], [0.0, 0.502]]), CORNER, 0.005, (200, 200), 1
    yield np.array([[-0.6, 0.0]]), CORNER, 0.005, (200, 200), 1
    yield from boards(rng, (1, 2), 0.4)


def on_borders(rng: np.random.Generator) -> Iterator[tuple[Any, ...]]:
    """Yield points on the borders of cells that floats hold exactly."""
    yield np.array([[-0.5, 0.25], [0.0, 0.0], [0.5, 0.0]]), CORNER, 0.25, (4, 4), 1
    corner, shape = np.array([0.125, -0.25]), (6, 9)
    for _ in range(CASES):
        steps = rng.integers(0, [shape[0] + 1, shape[1] + 1], (20, 2))  # up to the far borders
        yield corner + steps / 8, corner, 0.125, shape, 1


BUSY_CELLS = task(
    "busy_cells",
    counted,
    places(1e-6),
    (
        ("centres of cells, counted from the corner", 1, on_the_board),
        ("only cells with enough hits", 1, enough_hits),
        ("points beside the board", 1, beside_the_board),
        ("points on borders", 1, on_borders),
    ),
    (
        Fault(
            "Everything is half a cell too low and too far left: which place does a cell stand for?",
            like=count_like(to_world=lambda busy, corner, h: corner + busy * h),
            name="corner for centre",
        ),
        Fault(
            "Cell (0, 0) begins at the board's corner, not at the world's origin.",
            like=count_like(lambda points, corner, h: np.floor(points / h)),
            name="world origin for corner",
        ),
        Fault(
            "Those are places seen from the corner: the world frame is asked for.",
            like=count_like(to_world=lambda busy, corner, h: (busy + 0.5) * h),
            name="places seen from the corner",
        ),
        Fault(
            "Those are the numbers of cells: their centres in metres are asked for.",
            like=count_like(to_world=lambda busy, corner, h: busy),
            name="cell numbers for metres",
        ),
        Fault(
            "A cell with exactly `least` hits has enough of them.",
            like=count_like(enough=lambda hits, least: hits > least),
            name="more than, for at least",
        ),
        Fault(
            "Every cell that was hit is there: how often was it hit?",
            like=count_like(enough=lambda hits, least: hits > 0),
            name="no threshold",
        ),
        Fault(
            "Points beside the board have cells too: those are not on it.",
            like=count_like(keep=lambda cells, shape: cells),
            name="cells beside the board",
        ),
        Fault(
            "Points left of the board or below it turn up at the other end: a negative index counts from there.",
            like=count_like(keep=lambda cells, shape: cells[(cells < shape).all(axis=1)] % shape),
            name="negative index",
        ),
        Fault(
            "A point on the board's upper or right border lies on no cell: each cell leaves that border to the next.",
            like=count_like(keep=closed_board),
            name="board's far border kept",
        ),
        Fault(
            "Points beside the board are pushed onto its border: they are not on it.",
            like=count_like(keep=lambda cells, shape: np.clip(cells, 0, shape - 1)),
            name="pushed onto the board",
        ),
        Fault(
            "Points just below the corner fall into cell 0: int() cuts towards zero, floor goes down.",
            like=count_like(lambda points, corner, h: np.trunc((points - corner) / h)),
            name="int for floor",
        ),
        Fault(
            "That is the nearest border, not the cell that the point lies in.",
            like=count_like(lambda points, corner, h: np.round((points - corner) / h)),
            name="round for floor",
        ),
        Fault(
            "A cell holds its lower border, and not its upper one.",
            like=count_like(lambda points, corner, h: np.ceil((points - corner) / h) - 1),
            name="upper border for lower",
        ),
        Fault(
            "shape says how many cells there are along x first, then along y.",
            like=count_like(keep=lambda cells, shape: cells[((cells >= 0) & (cells < shape[::-1])).all(axis=1)]),
            name="x and y changed places",
        ),
    ),
)
