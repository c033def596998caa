"""Groups: K-Means step by step, while you choose the number of groups and the seed. The slider of lesson 03.

>>> groups()
Slider: board, centres start at, k, seed, step
"""

from __future__ import annotations

from functools import cache

import numpy as np

from ..arguments import Floats, Labels
from ..grid import Grid
from ..lidar import scan
from ..palette import BLACK, BLUE, CLUSTER_COLORS, GREY, INK, ORANGE, PALE
from ..robot import teleport_poses
from ..shapes import Circle, Polygon
from ..world import World, random_world
from .drawing import Frame, board_frame, idea_frame, picture, side_by_side
from .slider import Choice, Explorer, Picture, Slider, explore

FOUR_SHAPES, LONG_AND_SMALL, CLOSE_PAIR = "four shapes", "long and small", "3 cm apart"
RANDOM_START, SPREAD_START = "random points", "k-means++"


def _bar(left: float, right: float, half: float) -> Polygon:
    return Polygon([(left, -half), (right, -half), (right, half), (left, half)])


BOARDS = {
    FOUR_SHAPES: random_world(4, style="free", rng=7),
    LONG_AND_SMALL: World([_bar(-0.35, 0.15, 0.025), Circle((0.24, 0), 0.04)]),
    CLOSE_PAIR: World([_bar(-0.2, 0.1, 0.12), Circle((0.17, 0), 0.04)]),
}
KMEANS_ROUNDS = 20  # of an assignment and an update each: most starts settle in half as many
# Groups are neither black nor square, as the centres are. Six colours with five signs: no pair twice in 30 groups.
GROUP_COLORS = tuple(color for color in CLUSTER_COLORS if color != BLACK)
GROUP_SIGNS = ("dot", "cross", "diamond", "triangle", "triangle down")
SIGNS_PER_GROUP = 8  # signs on each group are larger, so that it can be told from the others without colour
GROUP_LEGEND = (
    *(("start", INK, "ring"), ("centre now", INK, "square")),
    *(("its way", INK, "line"), ("border", GREY, "dashed")),
)


def groups() -> Explorer:
    """Return the slider of lesson 03: K-Means on three boards, after each of its steps."""
    return explore(
        draw_groups,
        Choice("board", tuple(BOARDS), start=FOUR_SHAPES),
        Choice("start", (RANDOM_START, SPREAD_START), start=RANDOM_START, label="centres start at"),
        Slider("k", 1, 8, 1, start=4),
        Slider("seed", 0, 50, 1, start=1),
        Slider("step", 0, 2 * KMEANS_ROUNDS, 1, start=1),
        settings={
            "first assignment": {},
            "first update": {"step": 2},
            "settled": {"step": 2 * KMEANS_ROUNDS},
            "a bad seed": {"seed": 2, "step": 2 * KMEANS_ROUNDS},
            "same seed, k-means++": {"seed": 2, "start": SPREAD_START, "step": 2 * KMEANS_ROUNDS},
            "long and small": {"board": LONG_AND_SMALL, "k": 2, "step": 2 * KMEANS_ROUNDS},
        },
        diagram=draw_diagram,
    )


def draw_groups(board: str, start: str, k: int, seed: int, step: int) -> str:
    """Draw K-Means after so many steps: 0 is the start, odd steps assign, even ones move the centres."""
    points = points_of(board)
    first = random_points if start == RANDOM_START else spread_points
    way = run_kmeans(points, first(points, k, np.random.default_rng(seed)))
    used = way[max(0, step - 1) // 2]  # the centres that the labels were made with
    centers, labels = way[step // 2], assign(points, used)
    frame = board_frame()
    if step == 0:
        drawn = frame.points(points, GREY, size=3)
    else:
        drawn = _borders(frame, used) + "".join(_group(frame, points[labels == j], j) for j in range(k))
    title, says = _finding(points, way, step)
    return picture(
        frame,
        drawn,
        *(frame.polyline(way[: step // 2 + 1, j], INK, 1.5) for j in range(k) if step > 1),
        frame.points(way[0], "white", size=11) + frame.points(way[0], INK, "ring", 9),
        frame.points(centers, "white", "square", 14) + frame.points(centers, INK, "square", 10),
        title=title,
        says=says,
        legend=GROUP_LEGEND,
    )


def _finding(points: Floats, way: Floats, step: int) -> tuple[str, str]:
    """Return the title and the sentence: what this step did, and how compact the groups are now."""
    k, turn = way.shape[1], step // 2
    if step == 0:
        return f"The start: k = {k}, no groups yet", f"{k} of {len(points)} points are taken as the first centres."
    used = way[(step - 1) // 2]
    labels = assign(points, used)
    spread = f"J = {((points - way[turn][labels]) ** 2).sum():.2f} m²"
    if step % 2:
        settled = turn > 0 and np.array_equal(labels, assign(points, way[turn - 1]))
        changed = 0 if settled else len(points) if turn == 0 else int((labels != assign(points, way[turn - 1])).sum())
        did = f"{changed} of {len(points)} points change their group"
    else:
        moved = 1000 * float(np.hypot(*(way[turn] - used).T).max())
        settled = moved == 0
        did = f"the centre that moves farthest moves {moved:.0f} mm"
    if settled:
        last = int(np.argmax((way[1:] == way[:-1]).all(axis=(1, 2))))  # rounds before the first that moved nothing
        return f"Settled after {last} rounds, {spread}", f"Step {step}: {did}; {spread}, and it stays so."
    name = "assign" if step % 2 else "update"
    return f"Step {step}, {name}: {spread}", f"Step {step}, {name}: {did}; {spread}."


def _group(frame: Frame, points: Floats, j: int) -> str:
    """Draw a group's points as dots of its colour, and a few larger signs spread over them."""
    if len(points) == 0:
        return ""
    color, sign = GROUP_COLORS[j % len(GROUP_COLORS)], GROUP_SIGNS[j % len(GROUP_SIGNS)]
    around = points[np.argsort(np.arctan2(*(points - points.mean(axis=0)).T))]
    signs = around[:: -(-len(points) // SIGNS_PER_GROUP)]
    return frame.points(points, color, size=3.5) + frame.points(signs, color, sign, 9)


def _borders(frame: Frame, centers: Floats) -> str:
    """Draw where two centres are equally near, and no other is nearer."""
    ends = [border(a, b, centers) for i, a in enumerate(centers) for b in centers[:i]]
    kept = [pair for pair in ends if pair is not None]
    return frame.segments([a for a, _ in kept], [b for _, b in kept], GREY, 1.2, "5 3") if kept else ""


def border(a: Floats, b: Floats, centers: Floats) -> tuple[Floats, Floats] | None:
    """Return the ends of the border between the regions of a and b, cut off after 2 m; None without one.

    >>> a, b = np.array([0.0, 0.0]), np.array([0.2, 0.0])
    >>> [end.round(3).tolist() for end in border(a, b, np.array([a, b]))]
    [[0.1, -2.0], [0.1, 2.0]]
    """
    gap = float(np.hypot(*(b - a)))
    if gap == 0:
        return None
    middle, along = (a + b) / 2, np.array([a[1] - b[1], b[0] - a[0]]) / gap
    low, high = -2.0, 2.0
    for c in centers:  # |middle + t along - c| >= |middle + t along - a|: one side of a limit for t
        slope, rest = 2 * float(along @ (c - a)), float((middle - c) @ (middle - c) - (middle - a) @ (middle - a))
        if abs(slope) < 1e-12:  # so for a and b themselves, whose rest is 0
            if rest < -1e-12:
                return None
        elif slope > 0:
            high = min(high, rest / slope)
        else:
            low = max(low, rest / slope)
    return (middle + low * along, middle + high * along) if low < high else None


# --- K-Means, as in the lesson ------------------------------------------------------------------------------------


@cache
def points_of(board: str) -> Floats:
    """Return the grid's points of a board that the robot has driven over, shape (N, 2), metres."""
    grid = Grid(resolution=0.001)
    grid.add(scan(BOARDS[board], teleport_poses(BOARDS[board]), rng=0))
    return grid.points()


def assign(points: Floats, centers: Floats) -> Labels:
    """Return the number of each point's nearest centre, shape (N,): the assignment."""
    return np.argmin(square_distances(points, centers), axis=1)


def square_distances(points: Floats, centers: Floats) -> Floats:
    """Return the squared distance of each point to each centre, shape (N, k), square metres."""
    return (points[:, [0]] - centers[:, 0]) ** 2 + (points[:, [1]] - centers[:, 1]) ** 2


def update(points: Floats, labels: Labels, centers: Floats) -> Floats:
    """Return the mean of each group, shape (k, 2), metres; the old centre where it is empty: the update."""
    return np.array([points[labels == j].mean(axis=0) if (labels == j).any() else c for j, c in enumerate(centers)])


def run_kmeans(points: Floats, centers: Floats) -> Floats:
    """Return the centres at the start and after each round, shape (KMEANS_ROUNDS + 1, k, 2), metres."""
    way = [centers]
    while len(way) <= KMEANS_ROUNDS and not (len(way) > 1 and np.array_equal(way[-1], way[-2])):
        way.append(update(points, assign(points, way[-1]), way[-1]))
    return np.array(way + way[-1:] * (KMEANS_ROUNDS + 1 - len(way)))  # settled: no round moves them any more


def random_points(points: Floats, k: int, rng: np.random.Generator) -> Floats:
    """Return k of the points as first centres, shape (k, 2)."""
    return points[rng.choice(len(points), k, replace=False)]


def spread_points(points: Floats, k: int, rng: np.random.Generator) -> Floats:
    """Return first centres far from each other, shape (k, 2): k-means++, Arthur and Vassilvitskii (2007)."""
    centers = points[[rng.integers(len(points))]]
    while len(centers) < k:
        far = square_distances(points, centers).min(axis=1)  # to the nearest centre so far
        centers = np.vstack([centers, points[rng.choice(len(points), p=far / far.sum())]])
    return centers


# --- the diagram --------------------------------------------------------------------------------------------------


def draw_diagram() -> Picture:
    """Return the drawing behind the lesson's idea: each point to its nearest centre, each centre to its mean."""
    points = np.array([(1, 1), (2, 3), (3, 1), (4, 3), (7, 4), (8, 2), (9, 5), (8, 6)]) / 10
    old = np.array([(0.2, 0.5), (0.45, 0.35)])
    labels = assign(points, old)
    new = update(points, labels, old)
    first = _half(points, labels, old, old, "Each point takes its nearest centre")
    second = _half(points, labels, old, new, "Each centre moves to its group's mean")
    says = "Left: a stroke from each point to the nearer of two centres, the border half-way between them. "
    says += "Right: each centre moves to the mean of its points."
    return Picture(side_by_side([first, second], ["assign", "update"], says=says), "Diagram: assign, then update")


def _half(points: Floats, labels: Labels, old: Floats, new: Floats, title: str) -> str:
    """Draw one of the diagram's two halves; in the second one the centres have moved."""
    frame, moved = idea_frame((0.0, 1.0), (0.0, 0.8), 425), not np.array_equal(old, new)
    return picture(
        frame,
        "" if moved else frame.segments(points, old[labels], PALE, 2) + _borders(frame, old),
        frame.points(points[labels == 0], ORANGE, "diamond", 10) + frame.points(points[labels == 1], BLUE, "dot", 10),
        *(frame.arrow(o, n - 0.02 * (n - o) / np.hypot(*(n - o)), INK) for o, n in zip(old, new, strict=True) if moved),
        frame.points(old, INK, "ring", 12) if moved else "",
        frame.points(new, INK, "square", 12),
        frame.text(new[0], "c₀", shift=(9, -7), size=16),
        frame.text(new[1], "c₁", shift=(2, 24), size=16),
        title=title,
        says=f"Centres at {np.round(new, 2).tolist()} m.",
    )
