"""Refine: all sides of a shape, fitted together until nothing moves.

RANSAC finds sides one after the other, and the first one takes points of its neighbours around the corners.
Here every point is given back to the side it belongs to, all sides are fitted anew, and so on to a fixed point.

In:  points of one cluster, shape (N, 2), metres, and ``Outlines``: guesses of the sides.
Out: ``Outlines`` again, refined side by side, and how well each explains the points.

>>> from primkit.shapes import Polygon
>>> ring = Polygon([(0, 0), (0.1, 0), (0.1, 0.1), (0, 0.1)]).outline(80)
>>> guess = Outlines(np.array([[0.1, 1.6, 3.2, 4.6]]), np.array([[0.09, 0.09, 0.01, 0.01]]))
>>> (refine_hard(ring, guess, reach=0.02).offsets.round(6) + 0).tolist()
[[0.1, 0.1, 0.0, 0.0]]

Sources: giving points back, Isack and Boykov (2012), "Energy-based geometric multi-model fitting"; soft shares,
Dempster, Laird and Rubin (1977), "Maximum likelihood from incomplete data via the EM algorithm"; their settling in
leaps, Varadhan and Roland (2008), "Simple and globally convergent methods for accelerating the convergence of any EM
algorithm".
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from ..arguments import Floats
from .cuts import features_of, scatter_sums
from .outlines import QUARTERS, Outlines, from_angle_order
from .scatter import GHOSTS, LEAST_SPREAD, NOWHERE, OUTLINE_LENGTH, scatter

# A side that has fewer points than this (shares count in part) has nothing to be fitted to, and stays.
LEAST_OF_SIDE = 2.0

HARD_ROUNDS = 8  # nearly all settle in four or five
SOFT_ROUNDS = 30  # shares settle slowly around blurred corners; what is left then is far below a cell
SETTLED_TURN = 1e-5  # radians, and 1e-6 m, without noise: a hundredth of what any sensor tells
ROW_METRE = 10.0  # a metre counts as so many radians
CORNER_SHARE = 0.25  # of both sides' lengths, where a corner is cut off
LONGEST_LEAP = 4.0  # a leap goes at most so many steps ahead, so that it stays near


def refine_hard(points: Floats, guess: Outlines, reach: float, *, square: bool = False) -> Outlines:
    """Give each point to the side it belongs to, refit all sides, and repeat; some may no longer be ``sound`` then.

    Points farther than ``reach`` metres from one of the C outlines do not count for it.
    """
    before, features = None, features_of(points)
    for _ in range(HARD_ROUNDS):
        r = guess.distances(points)
        farthest_out = r.max(axis=2, keepdims=True)
        given = (r == farthest_out) & (np.abs(farthest_out) <= reach)
        if before is not None and (given == before).all():
            break
        before, guess = given, refit(features, given.astype(float), guess, square=square)
    return guess


def refine_soft(
    points: Floats,
    guess: Outlines,
    spread: float,
    *,
    square: bool = False,
    sound: Callable[[Outlines], NDArray[np.bool_]] = Outlines.sound,
) -> Outlines:
    """Give each point to all sides in the shares that its position makes likely, refit, repeat until settled.

    Around a corner nobody can say which side a noisy point came from. Giving it to the farther side, as
    ``refine_hard`` does, pushes both sides outwards; shares do not. The C guesses are sound, and near their solutions;
    they settle, or stay as they were before one of them would have stopped being ``sound``.
    """
    settled, features = SETTLED_TURN * (spread / LEAST_SPREAD) ** 0.5, features_of(points)
    for _ in range(SOFT_ROUNDS // 2):
        steps, move = [guess], np.inf
        while len(steps) < 3 and move > settled:
            share, told, _ = shares(points, steps[-1], spread)
            steps.append(refit(features, share * told, steps[-1], square=square))
            move = np.abs(_as_rows(steps[-1]) - _as_rows(steps[-2])).max(initial=0.0)
        if not sound(steps[-1]).all():
            return guess
        if move <= settled:
            return steps[-1]
        far = _leap(*steps)
        guess = far if sound(far).all() else steps[-1]
    return guess


def _leap(start: Outlines, one: Outlines, two: Outlines) -> Outlines:
    """Return where ever smaller steps in one direction lead to: two rounds show how fast they shrink.

    Shares settle slowly, each step being a part of the last one. This is Varadhan and Roland's scheme S3.
    """
    before, after = _as_rows(one) - _as_rows(start), _as_rows(two) - _as_rows(one)
    shrunk = np.linalg.norm(after - before, axis=1, keepdims=True)
    length = np.linalg.norm(before, axis=1, keepdims=True) / np.maximum(shrunk, np.finfo(float).tiny)
    length = np.clip(length, 1.0, LONGEST_LEAP)  # of 1: no leap, just the two steps
    row = _as_rows(start) + 2 * length * before + length**2 * (after - before)
    k = row.shape[1] // 2
    return Outlines(row[:, :k], row[:, k:] / ROW_METRE)


def _as_rows(outlines: Outlines) -> Floats:
    """Return angles and offsets as one row for each outline, in units that weigh about the same."""
    return np.concatenate([outlines.angles, ROW_METRE * outlines.offsets], axis=1)


def shares(points: Floats, outlines: Outlines, spread: float) -> tuple[Floats, Floats, Floats]:
    """Return to what share each point belongs to each side, how much it tells about that, and how likely all are.

    The model: a point comes from anywhere along the outline, and is moved by noise of ``spread``, as ``scatter``
    describes it; a few come from nowhere, by what the shares, shape (C, N, K), lack to one. The last is the natural
    logarithm of the density of all points together, shape (C,).
    """
    from scipy.special import ndtr  # not at the top: it takes longer to load than all of the kit

    begin, end = outlines.spans()
    length = (end - begin)[:, None, :]
    t = outlines.along(points) - begin[:, None, :]
    within = ndtr(t / spread) - ndtr((t - length) / spread)  # a side's ends, blurred by the noise
    across, told = scatter(outlines.distances(points), spread)
    density = (1 - GHOSTS) * np.maximum(within, 0.0) * across / OUTLINE_LENGTH
    total = density.sum(axis=2) + NOWHERE
    return density / total[..., None], told, np.log(total).sum(axis=1)


def refit(features: Floats, weights: Floats, outlines: Outlines, *, square: bool = False) -> Outlines:
    """Return the outlines whose sides fit their points best, by weighted total least squares.

    The points come as ``features_of`` has them, shape (6, N); the weights, shape (C, N, K), tell how much each counts
    for each side. Sides without points stay as they are; the fitted normals keep to the same side.
    """
    sums = (features @ weights).transpose(1, 0, 2)  # (6, C, K)
    enough = sums[0] >= LEAST_OF_SIDE
    xx, yy, xy = scatter_sums(sums)
    if square:  # every second side is turned back by a quarter
        mixed, along = ((each[:, ::2] - each[:, 1::2]).sum(axis=1) for each in (xy * enough, (xx - yy) * enough))
        angles = (0.5 * np.arctan2(2 * mixed, along) + np.pi / 2)[:, None] + QUARTERS
    else:
        angles = np.where(enough, 0.5 * np.arctan2(2 * xy, xx - yy) + np.pi / 2, outlines.angles)
    # An axis has two normals; keep the one on the side where the normal was.
    angles = outlines.angles + np.mod(angles - outlines.angles + np.pi / 2, np.pi) - np.pi / 2
    offsets = (np.cos(angles) * sums[1] + np.sin(angles) * sums[2]) / np.maximum(sums[0], LEAST_OF_SIDE)
    return Outlines(angles, np.where(enough, offsets, outlines.offsets))


def one_side_more(points: Floats, outline: Outlines) -> Outlines:
    """Return 2 K guesses with one side more than the first outline has: each side broken in two, each corner cut off.

    Two sides that hardly bend, or a short one, are taken for one until all the others are in their places.
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
    guess = refit(features_of(points), np.array(weights, dtype=float), start)
    return from_angle_order(guess.angles, guess.offsets)
