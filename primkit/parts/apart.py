"""Take apart: from the outline of a composite to its parts, and to what the outline leaves open.

1. The outline is cut into straight pieces and arcs (``pieces.py``).
2. All parts are proposed that lie in the outline and show on it (``proposals.py``).
3. Of the sets of parts that explain the outline, the fewest parts win, then the fewest corners, by evidence
   (``search.py``); all parts of a set are fitted together (``fitting.py``).
4. What is open is said: sizes that can change, kinds that could be others (``openness.py``); and how clear all is.

In:  points on the outline of one composite, shape (N, 2), metres; or what ``find_shapes`` found of it.
Out: ``Apart``: the parts, how they touch, what is open; or ``None`` where the points are no closed outline.

>>> from primkit.parts.composite import Composite
>>> stadium = Composite([Polygon([(0, 0), (0.2, 0), (0.2, 0.1), (0, 0.1)]), Circle((0.2, 0.05), 0.05)])
>>> take_apart(stadium.union.outline(300))
Apart: circle and rectangle, certain; a size of 1 part is open
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from numpy.typing import ArrayLike

from ..arguments import Bools, as_points, as_positive, short
from ..measure import CELL, Detection, Frame, Other
from ..robust.scatter import SIGMAS, spread_of
from ..shapes import Circle, Kind, Polygon, Shape
from ..table import count
from .families import Part, Style
from .fitting import Sample, outside_union
from .openness import INSIDE, all_deepened, drawn_in, kinds_as_shown, open_sizes, shown_places, sizes_differ
from .pieces import pieces_of, room_in
from .search import PART_PRICE, Explanation, explanations, unseen

LEAST_OUTLINE_POINTS = 30  # an outline of several shapes has a hundred
AROUND_CORNERS = 0.005  # m: pieces end short of sharp corners
CLEAR_MARGIN = 20.0  # of the margin: rivals are only those that were found, so that 10, very strong, is not enough
AS_GOOD = 4.0  # of the margin: chance gives one number that much in 1 of 20: a size may be that of such a rival
LEAST_ON_IT, MOST_UNSEEN = 0.97, 0.01  # of the points, and m of the outline: else the parts do not explain them
STYLES_OF_PARTS = ("paper", "free")


@dataclass(frozen=True, eq=False)
class Apart:
    """What an outline was taken apart into.

    Parameters
    ----------
    parts : tuple of Circle and Polygon
        Metres, world frame.
    joints : tuple of (int, int, str)
        Which parts meet, and how: ``"touch"`` where that is enough, ``"overlap"`` where they must.
    open_sizes : tuple of tuple of bool
        For each part, which of its ``dimensions`` can change by more than 6 mm and the outline would be the same.
    could_be : tuple of tuple of str
        For each part, of which other kinds it could be.
    margin : float
        How much better these parts explain the points than the best set of other kinds, on the scale of
        ``Detection.margin``; infinite without a rival.
    fits : bool
        Whether the parts explain the points at all.
    """

    parts: tuple[Shape, ...]
    joints: tuple[tuple[int, int, str], ...]
    open_sizes: tuple[tuple[bool, ...], ...]
    could_be: tuple[tuple[Kind, ...], ...]
    margin: float
    fits: bool

    @property
    def certain(self) -> bool:
        """Whether number and kinds are beyond doubt: the parts fit, no rival comes near, and no kind is open."""
        return self.fits and self.margin >= CLEAR_MARGIN and not any(self.could_be)

    def __repr__(self) -> str:
        kinds = sorted(part.kind for part in self.parts)
        named = " and ".join([", ".join(kinds[:-1]), kinds[-1]]) if len(kinds) > 1 else kinds[0]
        sizes = sum(map(any, self.open_sizes))
        told = f"; a size of {count(sizes, 'part')} is open" if sizes else ""
        return f"Apart: {named}, {'certain' if self.certain else 'not certain'}{told}"


def take_apart(
    found: Detection | Other | ArrayLike,
    *,
    style: Style = "paper",
    spread: float | None = None,
    resolution: float = CELL,
    colors: ArrayLike | None = None,
) -> Apart | None:
    """Return the fewest basic shapes of which an outline is the union, and what it leaves open.

    Raises ValueError if the points are not finite (N, 2), the style is unknown, the spread or resolution not above
    zero, or there is not one colour for each point.

    Parameters
    ----------
    found : Detection, Other, or array_like, shape (N, 2)
        What ``find_shapes`` found of the composite, or points on its outline, metres.
    style : {"paper", "free"}
        Whether triangles have two sides alike and pentagons are regular, or their corners are free.
    spread : float, optional
        Standard deviation of the points from the outline, metres; told from the points when not given.
    resolution : float
        Side of the cells that the points lie on, metres.
    colors : array_like of int, shape (N,), optional
        What a camera tells of each point: the number of its colour, -1 for unknown. A part has one colour.

    Examples
    --------
    Two boxes side by side are one to a LiDAR; a camera parts them:

    >>> box = Polygon([(0, 0), (0.2, 0), (0.2, 0.1), (0, 0.1)]).outline(300)
    >>> len(take_apart(box).parts), len(take_apart(box, colors=box[:, 0] > 0.1).parts)
    (1, 2)
    """
    points = as_points(found.points if isinstance(found, (Detection, Other)) else found)
    if style not in STYLES_OF_PARTS:
        raise ValueError(f'style must be "paper" or "free", got {short(style)}')
    labels = None if colors is None else np.asarray(colors).astype(np.intp)  # which any machine can count
    if labels is not None and labels.shape != (len(points),):
        raise ValueError(f"colors must be one for each of the {len(points)} points, got shape {labels.shape}")
    frame = Frame.of(points, as_positive(resolution, "resolution"))
    local = frame.local(points)
    if len(local) < LEAST_OUTLINE_POINTS:
        return None
    middle = local.mean(axis=0)
    local = local - middle
    spread = spread_of(local) if spread is None else as_positive(spread, "spread") / frame.unit
    pieces = pieces_of(local, spread, labels)
    if pieces is None:
        return None
    sample = Sample(local, spread, labels, room=room_in(pieces, SIGMAS * spread + AROUND_CORNERS))
    ranked = explanations(pieces, sample, style)
    return with_what_is_open(ranked, sample, replace(frame, origin=frame.metres(middle[None])[0])) if ranked else None


def with_what_is_open(ranked: Sequence[Explanation], sample: Sample, frame: Frame) -> Apart:
    """Return the best explanation in metres, with what is open about it."""
    best = ranked[0]
    deep = all_deepened(best.parts, sample)
    least = [drawn_in(deep, i, INSIDE) for i in range(len(deep))]
    middle = [part.with_numbers((part.x + far.x) / 2) for part, far in zip(least, deep, strict=True)]
    is_open = [
        sizes_differ(least[i], deep[i]) | open_sizes([*deep[:i], middle[i], *deep[i + 1 :]], i)
        for i in range(len(deep))
    ]
    parts = deep.copy()
    for i in range(len(parts)):
        parts[i] = drawn_in(parts, i)
    others = [kinds_as_shown(middle, i) for i in range(len(middle))]
    for i, part in enumerate(middle):
        for rival in ranked:
            if rival.cost < best.cost + CLEAR_MARGIN and len(rival.parts) == len(parts):
                far = [np.hypot(*(other.shape.centroid - part.shape.centroid)) for other in rival.parts]
                near = rival.parts[int(np.argmin(far))]
                others[i] |= {near.kind} - {part.kind}
                if rival.kinds == best.kinds and near.kind == part.kind and rival.cost < best.cost + AS_GOOD:
                    is_open[i] |= sizes_differ(best.parts[i], near)
    on_it = np.abs(outside_union(deep, sample.points)) <= SIGMAS * sample.spread + CELL
    # That fewest parts win is a wish, and no evidence: fewer parts of a rival do not speak for it.
    rivals = [e.cost + PART_PRICE * min(0, len(e.parts) - len(parts)) for e in ranked if e.kinds != best.kinds]
    return Apart(
        parts=tuple(_in_metres(part, frame) for part in parts),
        joints=_joints(middle),
        open_sizes=tuple(tuple(_by_dimension(*one)) for one in zip(parts, is_open, strict=True)),
        could_be=tuple(tuple(sorted(kinds)) for kinds in others),
        margin=float(min(rivals, default=np.inf) - best.cost),
        fits=bool(on_it.mean() >= LEAST_ON_IT and unseen(deep, sample) <= MOST_UNSEEN),
    )


def _in_metres(part: Part, frame: Frame) -> Shape:
    shape = part.shape
    if isinstance(shape, Circle):
        return Circle(frame.metres(shape.center), shape.radius * frame.unit)
    return Polygon(frame.metres(shape.vertices))


def _by_dimension(part: Part, sizes: Bools) -> list[bool]:
    """Return what is said of sizes in the order of ``shape.dimensions``: a rectangle's longer side is first."""
    turned = part.kind == "rectangle" and part.x[3] < part.x[4]
    return [bool(size) for size in (sizes[::-1] if turned else sizes)]


def _joints(parts: Sequence[Part]) -> tuple[tuple[int, int, str], ...]:
    """Return which parts meet, and whether they need more than touch: what a part shows is all that it must have."""
    import shapely

    others = [[*parts[:i], *parts[i + 1 :]] for i in range(len(parts))]
    shown = [
        part.shape.to_shapely() if part.kind == "circle" else shapely.MultiPoint(shown_places(part, rest)).convex_hull
        for part, rest in zip(parts, others, strict=True)
    ]
    return tuple(
        (i, j, "touch" if shapely.intersection(shown[i], shown[j]).buffer(-INSIDE).is_empty else "overlap")
        for i, j in combinations(range(len(parts)), 2)
        if parts[i].shape.to_shapely().distance(parts[j].shape.to_shapely()) <= INSIDE
    )
