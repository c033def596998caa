"""Evidence: prices by hand, calibration against truth, and what must not change a verdict."""

from collections import Counter

import numpy as np
import pytest

import primkit as pk
from primkit.robust.candidates import candidates
from primkit.robust.evidence import (
    NAMELESS_COST,
    NAMELESS_PART_COST,
    UNSEEN_COST,
    _length_cost,
    joint_cost,
    judged,
    price,
)
from primkit.robust.scatter import LEAST_SPREAD, NOWHERE, spread_across
from tests.test_outlines import outline_of

SQUARE = pk.Polygon([(-0.05, -0.05), (0.05, -0.05), (0.05, 0.05), (-0.05, 0.05)])
CIRCLE = pk.Circle((0, 0), 0.05)


def seen_by_beams(shape, n, noise, rng):
    """Points on an outline that beams from all sides saw: the error leads along the beam."""
    points = shape.outline(4000)[rng.permutation(4000)[:n]]
    step = 1e-6
    right, up = (shape.signed_distance(points + s) - shape.signed_distance(points) for s in ((step, 0), (0, step)))
    outward = np.column_stack([right, up]) / np.hypot(right, up)[:, None]
    sine = rng.uniform(-1, 1, n)[:, None]
    beam = np.sqrt(1 - sine**2) * outward + sine * outward[:, ::-1] * (1, -1)
    return (np.floor((points + rng.normal(0, noise, (n, 1)) * beam) * 1000) + 0.5) / 1000


@pytest.mark.parametrize(
    ("way", "variances"),
    [
        ((0, False), [2, 2, 1]),
        ((1, False), [1, 3, 1, 1]),
        ((3, False), [3, 9, 3, 9, 3, 9]),
        ((4, True), [4, 4, 4, 4, 3]),
    ],
    ids=["circle", "wall", "triangle", "rectangle"],
)
def test_every_fitted_number_has_its_price(way, variances):
    """By hand: each number costs the logarithm of how far the points narrow it down."""
    by_hand = sum(np.log(1 + 200 * 10**2 / v) for v in variances)
    assert price(way, 200, 0.001) == pytest.approx(by_hand)


def test_what_was_not_seen_has_its_price():
    points = CIRCLE.outline(400)
    whole, half = judged(points, CIRCLE, LEAST_SPREAD), judged(points[:200], CIRCLE, LEAST_SPREAD)
    unseen = CIRCLE.perimeter - half.length
    assert whole.length == pytest.approx(CIRCLE.perimeter)
    assert 0.4 * CIRCLE.perimeter < unseen < 0.5 * CIRCLE.perimeter
    free = half.cost - UNSEEN_COST * unseen
    per_point = -2 * np.log(0.98 / (np.sqrt(2 * np.pi) * LEAST_SPREAD * 0.5) + NOWHERE)
    by_hand = 200 * per_point + price((0, False), 200, LEAST_SPREAD) + _length_cost(200, half.length)
    assert free == pytest.approx(by_hand, rel=1e-4)


def test_a_longer_outline_spreads_its_points_thinner():
    """A square with the same spread of distances as a circle is longer; that alone must not speak for it."""
    assert _length_cost(100, 0.5) == 0
    assert _length_cost(100, 0.4) == pytest.approx(200 * np.log(0.8))
    assert _length_cost(100, 0.0) == _length_cost(100, 0.001)  # finite


def test_two_halves_together_cost_what_the_whole_costs():
    """Cut in two, an outline's points are no more likely: only what was not seen and the numbers differ."""
    points, outline = SQUARE.outline(400), outline_of(SQUARE)
    whole = judged(points, outline, 0.0005)
    halves = [judged(points[points[:, 0] > 0], outline, 0.0005), judged(points[points[:, 0] <= 0], outline, 0.0005)]
    numbers = 2 * price((4, False), 200, 0.0005) - price((4, False), 400, 0.0005)
    unseen = UNSEEN_COST * sum(2 * SQUARE.perimeter - 2 * h.length for h in halves) / 2
    crooked = 2 * NAMELESS_PART_COST - NAMELESS_COST  # four sides without right angles, of which half was seen
    overlap = 2 * 400 * np.log(sum(h.length for h in halves) / SQUARE.perimeter)  # ends seen by both
    assert joint_cost(halves) - whole.cost == pytest.approx(numbers + unseen + crooked + overlap, abs=3)
    assert joint_cost([whole]) == whole.cost
    assert joint_cost([]) == 0


def test_a_wall_costs_its_unseen_back():
    points = np.column_stack([np.linspace(0, 0.3, 80), np.zeros(80)])
    stretched = points * (4 / 3, 1)
    line = pk.fit_line(points)
    assert judged(points, line, 0.001).shape is None
    longer = judged(stretched, line, 0.001).cost - judged(points, line, 0.001).cost
    assert longer == pytest.approx(UNSEEN_COST * 0.1 + 2 * 80 * np.log(4 / 3), rel=1e-3)


@pytest.mark.parametrize("kind", ["circle", "triangle", "rectangle", "pentagon"])
def test_under_much_noise_no_kind_is_preferred(kind):
    """140 points with 10 mm noise on small outlines: each kind is recognised most of the time."""
    named = Counter()
    for seed in range(30):
        rng = np.random.default_rng([28, seed])
        while True:
            shape = pk.random_world(1, style="free", kinds=[kind], rng=rng).shapes[0]
            if shape.perimeter < 0.45:
                break
        points = seen_by_beams(shape, 140, 0.01, rng)
        named[candidates(points, spread_across(0.01))[0].kind] += 1
    assert named[kind] >= 24, named
