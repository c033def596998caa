"""Page: what the page needs to know to draw a board with a robot; ``board.js`` draws it.

In:  a ``Found``, a board's size, a sensor.
Out: messages: dictionaries of numbers and words, lengths in tenths of a millimetre, times the board's scale.

>>> tenths(np.array([[0.1, -0.02]]))
[[1000, -200]]
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from ..arguments import Floats, Ints
from ..driving.seen_map import OUTLINE_STEP
from ..found import Found
from ..lidar import Lidar
from ..measure import CELL, Detection
from ..palette import GREY, INK, KIND_COLORS, KIND_INKS, ORANGE, PALE, SKY, darker
from ..robot import BODY
from ..seen import is_seen
from ..shapes import Circle, Shape
from ..show import lengths_in_mm
from ..world import World

Message = dict[str, Any]

PAGE_COLORS = {"ink": INK, "grey": GREY, "pale": PALE, "beam": darker(SKY), "hit": darker(ORANGE)}
TENTH = 1e-4  # m: lengths go to the page in tenths of a millimetre; this and the next on the paper's scale
FARTHEST_DRAWN = 100.0  # m: whoever fits a circle that is larger than this sees no difference
MOST_ON_RING = 2000  # places on an outline: enough for one that is eight metres long
NO_NAME_YET = "not certain"  # the name of what has not earned one


def page(*names: str) -> str:
    """Return files that stand beside this one as one text: a widget's script comes as one module."""
    return "\n".join(Path(__file__).with_name(name).read_text(encoding="utf-8") for name in names)


def board_and_look(size: float, lidar: Lidar, scale: float) -> Message:
    """Return what stays the same while the robot drives: the board in metres, and the colours."""
    board = {"size": size, "body": BODY * scale, "reach": lidar.range_max, "cell": CELL * scale, "unit": TENTH * scale}
    return {"board": board, "look": {"colors": PAGE_COLORS, "kinds": KIND_COLORS, "inks": KIND_INKS}}


def tell_ranges(ranges: Floats, scale: float) -> Ints:
    """Return ranges in tenths of a millimetre, and -1 where nothing was hit, in the same shape."""
    return np.where(np.isfinite(ranges), np.rint(ranges / (TENTH * scale)), -1).astype(np.int64)


def truth_in(world: World | None) -> list[list[list[int]]]:
    """Return the outlines of a board's shapes, and its walls; nothing where there is no truth.

    >>> truth_in(World(walls=True))[0]
    [[-5000, -5000], [5000, -5000]]
    """
    if world is None:
        return []
    rings = [ring_of(shape, world.scale) for shape in world.shapes]
    return [tenths(line, world.scale) for line in [*rings, *world.walls]]


def describe(found: Found) -> Message:
    """Return how all is drawn that was found: shapes, walls and other things, strays."""
    scale = found.resolution / CELL
    return {
        "shapes": [describe_shape(one, scale) for one in found],
        "walls": [tenths(np.array([wall.start, wall.end]), scale) for wall in found.walls],
        "others": [tenths(np.vstack([other.outline, other.outline[:1]]), scale) for other in found.others],
        "strays": tenths(found.strays, scale),
        "rest": found.rest(),
    }


def count_found(found: Found) -> str:
    """Return how many shapes were found, and how many of them are not certain.

    >>> count_found(Found())
    '0 found'
    """
    open_ = sum(not one.certain for one in found)
    return f"{len(found)} found" + (f", {open_} not certain" if open_ else "")


def describe_shape(one: Detection, scale: float = 1.0) -> Message:
    """Return how a shape is drawn: its outline in stretches that were seen, or are only supposed, and its name.

    A scan sees a few places on one side: that is no name yet. All around, it is.

    >>> from primkit.pipeline import find_shapes
    >>> ring = Circle((0, 0), 0.1).outline(200)
    >>> for points in (ring[:40], ring):
    ...     told = describe_shape(find_shapes(points, rng=0)[0])
    ...     print(told["certain"], told["name"], [seen for seen, _ in told["stretches"]])
    False not certain [True, False, True]
    True circle, radius 100 mm [True]
    """
    ring = ring_of(one.shape, scale)
    seen = is_seen(ring, one.points, CELL * scale)
    stretches, start = [], 0
    for end in range(1, len(ring)):
        if end == len(ring) - 1 or seen[end] != seen[start]:
            stretches.append([bool(seen[start]), tenths(ring[start : end + 1], scale)])
            start = end
    (place,) = tenths(one.shape.centroid[None], scale)
    name = _name(one, scale) if one.certain else NO_NAME_YET
    return {"kind": one.kind, "certain": one.certain, "name": name, "place": place, "stretches": stretches}


def ring_of(shape: Shape, scale: float) -> Floats:
    """Return points along the outline, the corners among them, the first one again as the last, shape (N, 2)."""
    step = max(OUTLINE_STEP * scale, shape.perimeter / MOST_ON_RING)
    if isinstance(shape, Circle):
        ring = shape.outline(max(24, int(shape.perimeter / step)))
    else:
        ring = np.vstack(
            [
                corner + np.linspace(0, 1, max(2, int(side / step)), endpoint=False)[:, None] * edge
                for corner, edge, side in zip(shape.vertices, shape.edges, shape.sides, strict=True)
            ]
        )
    return np.vstack([ring, ring[:1]])


def _name(one: Detection, scale: float) -> str:
    """Return kind and dimensions in millimetres; a question mark for what was not measured."""
    told = lengths_in_mm(one.shape.dimensions, 10 * CELL * scale)
    measured = one.measured or (True,) * len(told)  # somebody's own fit tells of none
    lengths = [length if known else "?" for length, known in zip(told, measured, strict=True)]
    if isinstance(one.shape, Circle):
        return f"circle, radius {lengths[0]} mm"
    if one.kind == "rectangle":
        return f"rectangle, {' x '.join(lengths)} mm"
    if one.kind == "polygon":
        return f"polygon, {len(lengths)} sides"  # their lengths would fill the board
    return f"{one.kind}, sides {', '.join(lengths)} mm"


def tenths(points: Floats, scale: float = 1.0) -> list[list[int]]:
    """Return points in tenths of a millimetre: short to send, and finer than a screen."""
    near = np.clip(points / scale, -FARTHEST_DRAWN, FARTHEST_DRAWN)
    told: list[list[int]] = np.rint(near / TENTH).astype(int).tolist()
    return told
