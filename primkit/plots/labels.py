"""Labels: where each label finds room.

A label shall lie close to its shape, and closer to it than to any other, inside the board, and on no outline and no
other label. Each has some hundred places round its shape to choose from; the one with the fewest choices goes first,
then each chooses anew, knowing the others.

In:  texts, each with the shape it belongs to, and the shapes to keep off.
Out: matplotlib texts on the axes; a far one is tied to its shape by a thin line.

Source: choosing among fixed places, one label after the other, is the point-feature placement of Christensen, Marks
and Shieber (1995), "An Empirical Study of Algorithms for Point-Feature Label Placement".
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patheffects import withStroke
from matplotlib.text import Text
from numpy.typing import NDArray

from ..arguments import Floats
from ..palette import GREY
from ..shapes import Circle, Shape
from .look import at_each_size, letters, width_of

Label = tuple[str, Shape, str]  # its text, its shape, its colour
Chosen = dict[int, tuple[int, float]]  # label: its place, and what that costs

# Lengths are shares of the room's larger side, and so are costs: 0.01 is as bad as lying so much farther off.
LABEL_CLEARANCE = 0.011  # a label keeps this far from outlines, from other labels and from the edge
LABEL_GAPS = (0.012, 0.018, 0.03, 0.05, 0.08, 0.12, 0.17, 0.24)  # how far from its shape a label may lie
PLACES_PER_RING = 48  # places round the shape at each of these distances
LEADER_GAP = 0.04  # a label farther off than this is tied to its shape by a line
RIVAL_GAP = 0.05  # a label nearer than this to another label or to a foreign shape could be taken for that one's
RIVAL_COST = 0.04
ASIDE_COST = 0.1  # times the distance from level with the shape, or from right above or below it: for tidiness
MISPLACED = 1.0  # the label would lie in a shape, or its line would cross another shape or label
BLOCKED = 10.0  # the label would lie on an outline or on another label
OUTSIDE = 20.0  # the label would not lie in the room
GOOD_COST = 0.25  # when a label cannot be had for less, all are written smaller
LABEL_SIZES = (9.0, 8.0, 7.0, 6.0)  # of letters, points
MANY_LABELS = 20  # labels: more are written in the smallest letters at once
CHOICE_ROUNDS = 4
LABEL_WIDTH = 1.6  # inches: narrower axes have no room for labels


@dataclass(frozen=True, eq=False)
class Ground:
    """Where labels go: the room (lower left, upper right), its larger side, and what of each shape lies in it."""

    room: Floats
    unit: float
    areas: list[Any]
    solid: Any
    outlines: Any

    @classmethod
    def of(cls, labelled: Sequence[Shape], obstacles: Sequence[Shape], room: Floats) -> Ground:
        """Return the ground of shapes that get labels and shapes that do not."""
        import shapely

        unit, window = float(np.ptp(room, axis=0).max()), shapely.box(*room[0], *room[1])
        whole = [_area(shape) for shape in (*labelled, *obstacles)]
        lines = shapely.union_all([area.exterior for area in whole]).buffer(LABEL_CLEARANCE * unit, quad_segs=2)
        solid = shapely.union_all(whole)
        shapely.prepare(lines)
        shapely.prepare(solid)
        # A shape outside the room is labelled where the room is nearest to it.
        areas = [area & window or shapely.shortest_line(window, area).buffer(1e-6) for area in whole[: len(labelled)]]
        return cls(room, unit, areas, solid, lines)

    def places(self, index: int, box: Floats) -> Places:
        """Return the places for a label of size ``box``, metres, round the shape with this index."""
        import shapely

        area = self.areas[index]
        others = shapely.STRtree([other for other in self.areas if other is not area])
        middles = _around(area, box, self.unit)
        boxes = shapely.box(*(middles - box / 2).T, *(middles + box / 2).T)
        leaders = shapely.shortest_line(boxes, area)
        gap = shapely.length(leaders) / self.unit
        aside = np.abs(middles - middles[-1]).min(axis=1) / self.unit
        beyond = np.maximum(self.room[0] - middles, middles - self.room[1]) + box / 2 + LABEL_CLEARANCE * self.unit > 0
        cost = gap + ASIDE_COST * aside + OUTSIDE * beyond.any(axis=1)
        cost += BLOCKED * shapely.intersects(boxes, self.outlines) + MISPLACED * shapely.intersects(boxes, self.solid)
        cost += MISPLACED * ((gap > LEADER_GAP) & _touch(leaders, others))
        free = np.flatnonzero(cost < MISPLACED)
        (row, _), rival = others.query_nearest(boxes[free], return_distance=True, all_matches=False)
        cost[free[row]] += np.maximum(gap[free[row]] + RIVAL_GAP - rival / self.unit, 0)
        return Places(box, boxes, middles, leaders, gap, cost)


def _touch(lines: NDArray[np.object_], tree: Any) -> NDArray[np.bool_]:
    """Tell which lines touch anything in a tree of geometries."""
    touches = np.zeros(len(lines), dtype=bool)
    touches[tree.query(lines, predicate="intersects")[0]] = True
    return touches


@dataclass(frozen=True, eq=False)
class Places:
    """Where one label may lie: its size (2,), and for each of M places its box, middle, leader, gap and cost."""

    box: Floats
    boxes: NDArray[np.object_]
    middles: Floats
    leaders: NDArray[np.object_]
    gap: Floats
    cost: Floats

    def crowding(self, others: Sequence[tuple[Places, int]], unit: float) -> Floats:
        """Return what other labels at their places cost each place, shape (M,): overlap very much, nearness little."""
        import shapely

        if not others:
            return np.zeros(len(self.middles))
        middles = np.array([other.middles[k] for other, k in others])
        reach = np.array([other.box for other, _ in others]) / 2 + self.box / 2
        apart = (np.abs(self.middles[:, None] - middles) - reach).max(axis=2) / unit  # (M, others)
        cost = np.where(apart < LABEL_CLEARANCE, BLOCKED, RIVAL_COST * np.clip(1 - apart / RIVAL_GAP, 0, 1)).sum(axis=1)
        lines = [other.leaders[k] for other, k in others if other.gap[k] > LEADER_GAP]
        crossed = (self.gap > LEADER_GAP) & _touch(
            self.leaders, shapely.STRtree([other.boxes[k] for other, k in others])
        )
        return cost + MISPLACED * (crossed | _touch(self.boxes, shapely.STRtree(lines)))


def write_labels(
    ax: Axes, labels: Sequence[Label], obstacles: Sequence[Shape], room: Floats, *, halo: bool = False
) -> None:
    """Write each text near its shape, on free ground; one that finds none is left out.

    Parameters
    ----------
    ax : Axes
        With its limits set. Labels are placed when it is drawn, and anew when its size has changed.
    labels : sequence of (str, Circle or Polygon, str)
        Each text with its shape and its colour.
    obstacles : sequence of Circle and Polygon
        What no label may lie on, beside the labels' own shapes.
    room : array, shape (2, 2)
        The lower left and the upper right corner of what the labels may fill, metres.
    halo : bool
        Whether letters have a white rim: strays may lie beneath.
    """
    ground = Ground.of([shape for _, shape, _ in labels], obstacles, room)
    look: dict[str, Any] = {"ha": "center", "va": "center", "zorder": 6, "in_layout": False}
    look |= {"path_effects": [withStroke(linewidth=2, foreground="white")]} if halo else {}
    texts = [ax.text(0, 0, text, color=color, **look) for text, _, color in labels]
    lines = [ax.plot([], [], color=GREY, linewidth=0.8, zorder=5)[0] for _ in labels]
    at_each_size(ax, partial(_arrange, ax, ground, texts, lines))


def _arrange(ax: Axes, ground: Ground, texts: Sequence[Text], lines: Sequence[Line2D]) -> None:
    """Give each text its place and each line its ends, for the size that the axes have now."""
    places, chosen = _fit(ax, ground, texts)
    shown = _clear(places, chosen, ground.unit) if width_of(ax) >= LABEL_WIDTH else {}
    for index, (text, line) in enumerate(zip(texts, lines, strict=True)):
        text.set_visible(index in shown)
        line.set_visible(index in shown)
        if index in shown:
            best, spots = shown[index][0], places[index]
            text.set_position((spots.middles[best, 0], spots.middles[best, 1]))
            start, end = spots.leaders[best].coords
            line.set_data(*zip(start, end, strict=True))
            line.set_visible(bool(spots.gap[best] > LEADER_GAP))


def _fit(ax: Axes, ground: Ground, texts: Sequence[Text]) -> tuple[list[Places], Chosen]:
    """Return each text's places, and those chosen, in the largest letters with which all find a good one."""
    for size in LABEL_SIZES if len(texts) <= MANY_LABELS else LABEL_SIZES[-1:]:
        for text in texts:
            text.set_fontsize(letters(ax, size))
        places = [ground.places(index, _box(ax, text)) for index, text in enumerate(texts)]
        chosen = _choose(places, ground.unit)
        if max((cost for _, cost in chosen.values()), default=0.0) < GOOD_COST:
            break
    return places, chosen


def _box(ax: Axes, text: Text) -> Floats:
    """Return a text's width and height in metres."""
    text.set_visible(True)  # else it has no size
    extent, per_metre = text.get_window_extent(), ax.get_window_extent().width / float(np.ptp(ax.get_xlim()))
    return np.array([extent.width, extent.height]) / per_metre


def _area(shape: Shape) -> Any:
    import shapely

    return shapely.Polygon(shape.outline(64) if isinstance(shape, Circle) else shape.vertices)


def _around(area: Any, box: Floats, unit: float) -> Floats:
    """Return the middles of boxes that lie round an area at the distances of LABEL_GAPS; the last is its own."""
    import shapely

    # A box touches a convex area when its middle lies on the outline of the area widened by half the box.
    corners = shapely.get_coordinates(area)[:, None] + np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * box / 2
    touching = shapely.convex_hull(shapely.multipoints(corners.reshape(-1, 2)))
    rings = np.repeat(shapely.get_exterior_ring(shapely.buffer(touching, np.array(LABEL_GAPS) * unit)), PLACES_PER_RING)
    stops = np.tile(np.arange(PLACES_PER_RING) / PLACES_PER_RING, len(LABEL_GAPS))
    places = shapely.line_interpolate_point(rings, stops, normalized=True)
    return shapely.get_coordinates([*places, area.centroid])


def _choose(places: Sequence[Places], unit: float) -> Chosen:
    """Return each label's place and its cost: the label with the fewest choices goes first, then each chooses anew."""
    order = sorted(range(len(places)), key=lambda i: int((places[i].cost < MISPLACED).sum()))
    chosen: Chosen = {}
    for _ in range(CHOICE_ROUNDS):
        before = dict(chosen)
        for i in order:
            chosen[i] = _best(places, i, chosen, unit)
        if chosen == before:
            break
    return chosen


def _best(places: Sequence[Places], i: int, chosen: Chosen, unit: float) -> tuple[int, float]:
    """Return the best place for label i, and its cost, beside the labels that have chosen."""
    others = [(places[j], k) for j, (k, _) in chosen.items() if j != i]
    cost = places[i].cost + places[i].crowding(others, unit)
    best = int(np.argmin(cost))
    return best, float(cost[best])


def _clear(places: Sequence[Places], chosen: Chosen, unit: float) -> Chosen:
    """Return the labels that lie on nothing; the others come in where those leave room, or not at all."""
    shown = {i: choice for i, choice in chosen.items() if choice[1] < BLOCKED}
    for i in sorted(chosen.keys() - shown.keys()):
        choice = _best(places, i, shown, unit)
        if choice[1] < BLOCKED:
            shown[i] = choice
    return shown
