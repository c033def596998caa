"""Naming: what the points could be, what each candidate costs, and which one is chosen. The slider of lesson 06.

>>> naming()
Slider: shape, noise, view points, price
>>> ring = Circle((0, 0), 0.06).outline(100)
>>> [(one.kind, one.numbers) for one in fit_each_kind(ring)]
[('circle', 3), ('triangle', 6), ('rectangle', 5), ('pentagon', 10)]
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np

from ..arguments import Floats
from ..circles import fit_circle
from ..grid import Grid
from ..lidar import Lidar, scan
from ..palette import BLUE, GREY, INK, KIND_COLORS, ORANGE, PALE, VERMILION
from ..random_shapes import PENTAGON
from ..robust.outlines import Outlines, from_angle_order, joined
from ..robust.refine import refine_hard
from ..robust.scatter import spread_across
from ..seen import is_seen, seen_shares
from ..shapes import Circle, Kind, Polygon, Shape
from ..world import World
from .drawing import Frame, idea_frame, picture
from .slider import Choice, Explorer, Picture, Slider, explore

FAIR_PRICE, NO_PRICE = "ln N a number", "nothing"
VERY_STRONG = 10.0  # a margin above this is very strong (Kass and Raftery, 1995)

TRUE_SHAPES: dict[str, Shape] = {
    "circle": Circle((0, 0), 0.065),
    "small circle": Circle((0, 0), 0.03),
    "triangle": Polygon([(-0.07, -0.055), (0.08, -0.03), (-0.02, 0.075)]),
    "rectangle": Polygon([(-0.075, -0.04), (0.075, -0.04), (0.075, 0.04), (-0.075, 0.04)]).moved(angle=np.radians(20)),
    "pentagon": Polygon(0.07 * PENTAGON).moved(angle=0.3),
}
MOST_VIEWS, VIEW_AXES = 12, (0.175, 0.115)  # the robot's places on an ellipse around the shape; its half axes, m
FIRST_BEARING = -2.2  # rad: of the first place, at the lower left

REFIT_REACH = 0.1  # m: every point of the group counts for every candidate
WALL_RADIUS = 0.25  # m: a larger circle is a wall
TURNED_STARTS = 6  # first guesses of an outline, each turned a little further
SAME_OUTLINE = 1e-6  # guesses whose squared distances differ by less than this share end in the same outline
CORNER_CUTS = (0.002, 0.008)  # m: how much of a corner a first guess cuts off
# A closed outline bends at each corner by this at least and at most [rad], and has no shorter side than this [m].
CLOSED_LEAST_TURN, CLOSED_MOST_TURN, CLOSED_LEAST_SIDE = np.radians(2), np.radians(175), 0.003

ENDS_PER_SIDE = 21  # an outline is drawn in so many steps a side; every other one where it was not seen
HARDLY_SEEN = 0.4  # a side of which less than this share has points near it was hardly seen

VIEW = Frame((-0.2, 0.2), (-0.14, 0.14), width=425, height=320, y_ticks=(-0.1, 0.0, 0.1))
BARS = Frame(
    (-0.2, 0.2), (0.0, 5.0), width=425, height=75 + 105
)  # below: a row for the words, and one for each candidate
BAR_ENDS, BARS_ROOM = (-0.105, 0.115), 125  # in BARS, left and right; px
LONGEST_BAR = 2.5  # times the least cost: longer bars are cut off


@dataclass(frozen=True, eq=False)
class Fitted:
    """A candidate: a kind, how many numbers it has, and its best fit; ``shape`` is None when none closes."""

    kind: Kind
    numbers: int
    shape: Shape | None

    def misfit(self, points: Floats, spread: float) -> float:
        """Return the sum of squared distances over the spread's square; infinite without a shape."""
        if self.shape is None:
            return float("inf")
        return float(np.sum(self.shape.signed_distance(points) ** 2)) / spread**2


def naming() -> Explorer:
    """Return the slider of lesson 06: a shape, noise, view points, and what a fitted number costs."""
    return explore(
        draw_naming,
        Choice("shape", tuple(TRUE_SHAPES), start="rectangle"),
        Slider("noise", 0.0, 15.0, 0.5, start=2.0, unit="mm"),
        Slider("views", 2, MOST_VIEWS, 1, start=MOST_VIEWS, label="view points"),
        Choice("price", (FAIR_PRICE, NO_PRICE), start=FAIR_PRICE),
        settings={
            "seen all around": {},
            "one side hidden": {"views": 6},
            "a circle in 12 mm of noise": {"shape": "circle", "noise": 12.0, "views": 8},
            "the same, numbers for nothing": {"shape": "circle", "noise": 12.0, "views": 8, "price": NO_PRICE},
            "a small circle in noise": {"shape": "small circle", "noise": 6.0},
            "a pentagon half seen": {"shape": "pentagon", "noise": 6.0, "views": 5},
        },
        diagram=draw_diagram,
    )


def draw_naming(shape: str, noise: float, views: int, price: str) -> str:
    """Draw the points of one shape, the chosen outline, and each candidate's cost; noise in mm, seed 0."""
    truth, spread, poses = TRUE_SHAPES[shape], spread_across(noise / 1000), view_points(views)
    grid = Grid(resolution=0.001)
    grid.add(scan(World([truth]), poses, Lidar(noise_std=noise / 1000), rng=0))
    points = grid.points()
    found = fit_each_kind(points)
    misfits = np.array([one.misfit(points, spread) for one in found])
    prices = np.array([one.numbers for one in found]) * (np.log(len(points)) if price == FAIR_PRICE else 0.0)
    costs = misfits + prices
    best, second = np.argsort(costs, kind="stable")[:2].tolist()
    margin = float(costs[second] - costs[best])
    chosen = found[best].shape
    assert chosen is not None  # a circle fits always, or a rectangle
    says = _says(found[best].kind, margin, shape, noise, views, len(points))
    return picture(
        VIEW,
        VIEW.shape(truth, PALE, width=0, fill=0.5),
        VIEW.points(points, INK, size=2.5),
        *_outline(chosen, points),
        *(VIEW.robot(pose, size=6) for pose in poses),
        below="".join(_bars(found, misfits, prices, best)),
        room=BARS_ROOM,
        title=_title(found[best].kind, margin, truth.kind),
        says=says,
    )


def view_points(views: int) -> Floats:
    """Return the poses of the robot, one after the other around the shape, shape (views, 3)."""
    bearing = FIRST_BEARING + 2 * np.pi / MOST_VIEWS * np.arange(views)
    x, y = VIEW_AXES[0] * np.cos(bearing), VIEW_AXES[1] * np.sin(bearing)
    return np.column_stack([x, y, np.arctan2(-y, -x)])


def fit_each_kind(points: Floats) -> tuple[Fitted, ...]:
    """Return the circle, triangle, upright rectangle and pentagon closest to points, shape (N, 2), metres."""
    middle = points.mean(axis=0)
    local = points - middle
    circle = fit_circle(local)
    if circle is not None and circle.radius > WALL_RADIUS:
        circle = None
    three, square = _closest(local, _even(local, 3)), _closest(local, _even(local, 4), square=True)
    five = _closest(local, joined(_even(local, 5), *_cut(three, 2), *_cut(square, 1)))
    rows: tuple[tuple[Kind, int, Circle | Outlines | None], ...] = (
        ("circle", 3, circle),
        ("triangle", 6, three),
        ("rectangle", 5, square),
        ("pentagon", 10, five),
    )
    return tuple(
        Fitted(kind, numbers, (one.polygon() if isinstance(one, Outlines) else one).moved(middle) if one else None)
        for kind, numbers, one in rows
    )


def _even(points: Floats, k: int) -> Outlines:
    """Return first guesses of k sides at even angles, each as far out as the points reach, in several turns."""
    angles = 2 * np.pi / k * (np.arange(k) + np.arange(TURNED_STARTS)[:, None] / TURNED_STARTS)
    heights = points @ np.stack([np.cos(angles), np.sin(angles)], axis=1)  # (TURNED_STARTS, N, k)
    return from_angle_order(angles, heights.max(axis=1))


def _cut(outline: Outlines | None, corners: int) -> list[Outlines]:
    """Return first guesses with so many sides more: that many corners of an outline are cut off, in all ways."""
    if outline is None:
        return []
    angles, offsets, places = outline.angles[0], outline.offsets[0], outline.corners()[0]
    before = np.roll(angles, 1)
    new = before + np.mod(angles - before, 2 * np.pi) / 2
    reach = places[:, 0] * np.cos(new) + places[:, 1] * np.sin(new)
    ways = [list(way) for way in combinations(range(len(angles)), corners)]
    sides = [(np.append(angles, new[w]), np.append(offsets, reach[w] - cut)) for cut in CORNER_CUTS for w in ways]
    return [from_angle_order(np.array([a for a, _ in sides]), np.array([d for _, d in sides]))]


def _closest(points: Floats, guess: Outlines, *, square: bool = False) -> Outlines | None:
    """Give each point to a side and refit until nothing moves; return the closest outline that closes, or None.

    The guesses stand for election as well: a corner that is cut off by a hair may close where its refit does not.
    """
    found = joined(refine_hard(points, guess, REFIT_REACH, square=square), guess)
    turn = np.mod(np.roll(found.angles, -1, axis=1) - found.angles, 2 * np.pi)
    begin, end = found.spans()
    closed = ((turn >= CLOSED_LEAST_TURN) & (turn <= CLOSED_MOST_TURN) & (end - begin >= CLOSED_LEAST_SIDE)).all(axis=1)
    closed &= np.abs(turn.sum(axis=1) - 2 * np.pi) < 1e-6
    if not closed.any():
        return None
    found = found[closed]
    squares = (found.distances(points).max(axis=2) ** 2).sum(axis=1)
    best = int(np.argmax(squares <= (1 + SAME_OUTLINE) * squares.min()))  # the first: no processor's rounding decides
    return found[best : best + 1]


def _outline(shape: Shape, points: Floats) -> list[str]:
    """Draw the chosen outline, dashed where no point lies near; a side that was hardly seen has a question mark."""
    color, marks = KIND_COLORS[shape.kind], []
    if isinstance(shape, Circle):
        ring = shape.outline(4 * ENDS_PER_SIDE)
        stretches = np.stack([ring, np.roll(ring, -1, axis=0)], axis=1)
    else:
        steps = np.linspace(0, 1, ENDS_PER_SIDE)[:, None]
        sides = [start + steps * edge for start, edge in zip(shape.vertices, shape.edges, strict=True)]
        stretches = np.vstack([np.stack([side[:-1], side[1:]], axis=1) for side in sides])
        middles, shares = shape.vertices + shape.edges / 2, seen_shares(shape, points)
        hidden = [middle for middle, share in zip(middles, shares, strict=True) if share < HARDLY_SEEN]
        marks = [VIEW.text(middle, "?", VERMILION, "middle", (0, 6), 18) for middle in hidden]
    seen = is_seen(stretches.mean(axis=1), points)
    dashes = np.flatnonzero(~seen)[::2]
    starts, ends = stretches[:, 0], stretches[:, 1]
    parts = [VIEW.segments(starts[rows], ends[rows], color, 2.5) for rows in (np.flatnonzero(seen), dashes)]
    return [*parts, *marks]


def _bars(found: tuple[Fitted, ...], misfits: Floats, prices: Floats, best: int) -> list[str]:
    """Draw below the shape what each candidate costs: its misfit, and the price of its numbers."""
    (left, right), least = BAR_ENDS, float(np.min(misfits + prices))
    unit = (right - left) / (LONGEST_BAR * max(least, 1.0))
    parts = [BARS.text((-0.195, 4.4), "cost [-] =", INK), BARS.points([(-0.108, 4.6)], BLUE, "square", 10)]
    parts += [BARS.text((-0.098, 4.4), "misfit +", INK), BARS.points([(-0.033, 4.6)], ORANGE, "diamond", 9)]
    parts += [BARS.text((-0.023, 4.4), "price of its numbers", INK)]
    for row, (one, misfit, price) in enumerate(zip(found, misfits.tolist(), prices.tolist(), strict=True)):
        y = 3.5 - row
        name = ("\u25b6 " if row == best else "") + one.kind
        parts.append(BARS.text((left - 0.004, y - 0.2), name, INK if row == best else GREY, "end"))
        if one.shape is None:
            parts.append(BARS.text((left + 0.003, y - 0.2), "none that closes", GREY))
            continue
        middle = min(left + misfit * unit, right)
        end = min(left + (misfit + price) * unit, right)
        parts += [_bar(left, middle, y, BLUE), _bar(middle, end, y, ORANGE)]
        cut = " \u226b" if misfit + price > LONGEST_BAR * max(least, 1.0) else ""
        parts.append(BARS.text((end + 0.004, y - 0.2), f"{misfit + price:,.0f}{cut}", INK))
    return parts


def _bar(start: float, end: float, y: float, color: str) -> str:
    return BARS.area([(start, y - 0.3), (end, y - 0.3), (end, y + 0.3), (start, y + 0.3)], color, 0.85)


def _title(kind: Kind, margin: float, truth: Kind) -> str:
    """Say what was chosen, by how much, and whether it is right."""
    return f"{kind.capitalize()}, margin {margin:.0f}: {_verdict(margin)}, and {'right' if kind == truth else 'wrong'}"


def _verdict(margin: float) -> str:
    return "sure" if margin > VERY_STRONG else "not sure"


def _says(kind: Kind, margin: float, shape: str, noise: float, views: int, n_points: int) -> str:
    """Say in a sentence what the picture shows."""
    seen = f"{n_points} points on a {shape}, from {views} view points with noise of {noise:g} mm"
    return f"{seen}: the cheapest candidate is a {kind}, by a margin of {margin:.0f}, which is {_verdict(margin)}."


def draw_diagram() -> Picture:
    """Return the drawing behind the lesson's formula: two lines n . p = d, and the corner in which they meet."""
    angles, offsets = np.radians([20.0, 100.0]), np.array([0.4, 0.28])
    normals = np.column_stack([np.cos(angles), np.sin(angles)])
    corner = np.linalg.solve(normals, offsets)
    feet, along = offsets[:, None] * normals, np.column_stack([-normals[:, 1], normals[:, 0]])
    frame = idea_frame((-0.12, 0.63), (-0.1, 0.42), 525)
    svg = picture(
        frame,
        frame.segments(feet - 0.7 * along, feet + 0.7 * along, PALE, 2),
        frame.segments([corner], [corner - 0.32 * along[0]], BLUE, 4),
        frame.segments([corner], [corner + 0.36 * along[1]], ORANGE, 4),
        frame.segments(np.zeros((2, 2)), feet, GREY, 1.5, "5 4"),
        *(frame.arrow((0, 0), 0.12 * normal, VERMILION, 4) for normal in normals),
        frame.points([corner], VERMILION, "ring", 14),
        frame.points(feet, GREY, "square", 6),
        frame.points([(0, 0)], INK, size=8),
        frame.text((0, 0), "origin", shift=(-14, 20), anchor="middle"),
        frame.text(0.12 * normals[0], "n1", VERMILION, shift=(2, 18), size=16),
        frame.text(0.12 * normals[1], "n2", VERMILION, shift=(-26, 2), size=16),
        frame.text(0.72 * feet[0], "d1", INK, shift=(0, -10), size=16),
        frame.text(0.75 * feet[1], "d2", INK, shift=(10, 4), size=16),
        frame.text(corner - 0.25 * along[0], "side 1", BLUE, shift=(8, 6), size=14),
        frame.text(corner + 0.33 * along[1], "side 2", ORANGE, shift=(0, 24), size=14),
        frame.text(corner, "the corner p", INK, shift=(12, -8), size=14),
        title="A corner lies on both lines",
        says="Two lines, each at its distance d along its normal n from the origin; the corner is on both.",
    )
    return Picture(svg, "Diagram: two lines and their corner")
