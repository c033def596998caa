"""Guess: first guesses of a polygon's sides, good enough to be refined.

In:  points of one cluster, shape (N, 2), metres, around the origin.
Out: ``Outlines`` with k sides each.

>>> from primkit.shapes import Polygon
>>> ring = Polygon([(-0.1, -0.1), (0.1, -0.1), (0.1, 0.1), (-0.1, 0.1)]).outline(80)
>>> lines = ransac_lines(ring, 0.003, rng=0)
>>> guess_outlines(ring, line_guesses(ring, lines, 0.003), 4, 0.003).polygon().kind
'rectangle'

Two sources, because each fails where the other works: sets of the lines that RANSAC found, and even sectors
of the points around the middle. The refinement makes the best of either, and the likelihood decides.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np

from ..arguments import Floats
from ..lines import Line, find_lines
from .outlines import QUARTERS, Outlines, from_angle_order, joined
from .refine import refit

LINES_TRIED = 7  # five sides at most, and two for luck
GUESSED_LINE_TRIALS = 200  # a side with an eighth of the points is drawn with 95 % certainty
CLOSING_LINES = 3  # seldom are more than two sides hidden
CLOSING_LENGTH = 0.012  # m: a shorter stretch of the hull is the usual distance between points
SUBSETS_KEPT = 4  # the right set is among the first where RANSAC found all sides
# The frame is drawn in by a twentieth of the points, to lie in the sides and not around them; and once not at all, for
# sides that were not seen: they lie where the seen ones end.
FRAME_QUANTILES = np.array([0.05, 0.0])
CORNER_SHARE = 0.25  # of both sides' lengths, where a corner is cut off
SECTOR_TURNS = 4  # each turned by a quarter of a sector


def guess_outlines(points: Floats, sides: Outlines, k: int, reach: float) -> Outlines:
    """Return guesses of outlines with k sides: the best sets of lines first, then the sectors.

    Parameters
    ----------
    points : array, shape (N, 2)
        Metres, around the origin.
    sides : Outlines
        One row of lines that may be sides, as ``line_guesses`` returns it.
    k : int
        Number of sides.
    reach : float
        Points farther than this from an outline do not speak for it, in metres.
    """
    return joined(_best_subsets(points, sides, k, reach), _sectors(points, k))


def ransac_lines(points: Floats, reach: float, *, rng: int | np.random.Generator | None = None) -> list[Line]:
    """Return lines that RANSAC finds in the points, the one with most points first; empty for fewer than three."""
    found = find_lines(points, reach, left_over=0.0, most=LINES_TRIED, trials=GUESSED_LINE_TRIALS, rng=rng)
    return [one.line for one in found if np.count_nonzero(one.inliers) >= 3]


def line_guesses(points: Floats, lines: list[Line], reach: float) -> Outlines:
    """Return lines that may be sides, as one outline of M sides: those given, and the hull's over unseen stretches."""
    lines = lines + _closing_lines(points, reach)
    outward = [line.turned_round() if line.offset < 0 else line for line in lines]  # the origin is inside
    return from_angle_order(np.array([[line.angle for line in outward]]), np.array([[line.offset for line in outward]]))


def guess_rectangles(points: Floats, sides: Outlines, four_sided: Outlines) -> Outlines:
    """Return guesses of rectangles: guesses with four sides put upright, and frames around the points.

    Parameters
    ----------
    points : array, shape (N, 2)
        Metres, around the origin.
    sides : Outlines
        One row of lines that may be sides; a frame is laid along each.
    four_sided : Outlines
        Guesses with four sides; each keeps the bearing of its first.
    """
    upright = Outlines(four_sided.angles[:, :1] + QUARTERS, four_sided.offsets)
    angles = np.repeat(sides.angles[0, :, None] + QUARTERS, len(FRAME_QUANTILES), axis=0)
    heights = points @ np.stack([np.cos(angles), np.sin(angles)], axis=1)  # (2 M, N, 4)
    low_or_full = np.tile(FRAME_QUANTILES, sides.angles.shape[1])
    frames = [np.quantile(h, 1 - q, axis=0) for h, q in zip(heights, low_or_full, strict=True)]
    return joined(upright, Outlines(angles, np.array(frames).reshape(-1, 4)))


def one_side_more(points: Floats, outline: Outlines) -> Outlines:
    """Return guesses with one side more than a fitted outline has: each side broken in two, each corner cut off.

    Two sides that hardly bend, or a short one, are taken for one until all the others are in their places.

    Parameters
    ----------
    points : array, shape (N, 2)
        Metres.
    outline : Outlines
        One row of K sides.

    Returns
    -------
    Outlines
        2 K guesses of K + 1 sides.
    """
    k = outline.angles.shape[1]
    owner = outline.distances(points)[0].argmax(axis=1)
    begin, end = (ends[0] for ends in outline.spans())
    along = outline.along(points)[0][np.arange(len(points)), owner]
    place = (along - begin[owner]) / (end - begin)[owner]  # 0 where a point's side begins, 1 where it ends
    weights, angles = [], []
    for side in range(k):
        own, its_end = owner == side, 1 - CORNER_SHARE
        corner = (own & (place > its_end)) | ((owner == (side + 1) % k) & (place < CORNER_SHARE))
        turn = np.mod(outline.angles[0, (side + 1) % k] - outline.angles[0, side], 2 * np.pi)
        for taken in (own & (place > 0.5), corner):
            weights.append(np.column_stack([(owner[:, None] == np.arange(k)) & ~taken[:, None], taken]))
            angles.append([*outline.angles[0], outline.angles[0, side] + turn / 2])
    start = Outlines(np.array(angles), np.tile([*outline.offsets[0], 0.0], (2 * k, 1)))
    guess = refit(points, np.array(weights, dtype=float), start)
    return from_angle_order(guess.angles, guess.offsets)


def _closing_lines(points: Floats, reach: float) -> list[Line]:
    """Return lines along the hull's longest unseen stretches: where a side was not seen, the hull spans it."""
    import shapely

    hull = shapely.MultiPoint(points).convex_hull
    if hull.geom_type != "Polygon":
        return []
    ring = shapely.get_coordinates(hull.exterior)
    along = np.diff(ring, axis=0)
    angles = np.arctan2(-along[:, 0], along[:, 1])
    lines = [Line(float(a), float(start @ (np.cos(a), np.sin(a)))) for a, start in zip(angles, ring, strict=False)]
    unseen = np.array([_widest_gap(points, line, reach) for line in lines])
    widest = np.argsort(-unseen, kind="stable")[:CLOSING_LINES]
    return [lines[i] for i in widest if unseen[i] > CLOSING_LENGTH]


def _widest_gap(points: Floats, line: Line, reach: float) -> float:
    """Return the widest gap between neighbouring points along a line, metres."""
    near = points[np.abs(line.signed_distance(points)) <= reach]
    return float(np.diff(np.sort(near @ line.direction)).max(initial=0.0))


def _best_subsets(points: Floats, sides: Outlines, k: int, reach: float) -> Outlines:
    """Return the sets of k lines whose outline lies closest to the points."""
    subsets = np.array(list(combinations(range(sides.angles.shape[1]), k)), dtype=int).reshape(-1, k)
    outlines = Outlines(sides.angles[0, subsets], sides.offsets[0, subsets])
    sound = outlines.sound()
    outlines, subsets = outlines[sound], subsets[sound]
    r = sides.distances(points)[0]  # the sets share their lines: each line's distances are taken once
    farthest_out = np.full((len(points), len(subsets)), -np.inf)
    for column in subsets.T:
        np.maximum(farthest_out, r[:, column], out=farthest_out)
    cost = (np.minimum(np.abs(farthest_out), reach) ** 2).sum(axis=0)
    return outlines[np.argsort(cost, kind="stable")[:SUBSETS_KEPT]]


def _sectors(points: Floats, k: int) -> Outlines:
    """Return outlines from points cut, by bearing, into k equally full sectors, in several turns.

    When the noise is as large as a side, no two points tell a line any more; a sector's many points do.
    """
    order = np.argsort(np.arctan2(points[:, 1], points[:, 0]), kind="stable")
    n = len(points)
    weights = np.zeros((SECTOR_TURNS, n, k))
    for turn in range(SECTOR_TURNS):
        sector = ((np.arange(n) * k + turn * n // SECTOR_TURNS) // n) % k
        weights[turn, order, sector] = 1.0
    mean = np.swapaxes(weights, 1, 2) @ points / weights.sum(axis=1)[..., None]
    outward = np.arctan2(mean[..., 1], mean[..., 0])
    guess = refit(points, weights, Outlines(outward, np.zeros_like(outward)))
    guess = from_angle_order(guess.angles, guess.offsets)
    return guess[guess.sound()]
