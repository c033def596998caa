"""Which part of an outline has points near it: by hand, and against all distances."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as npst

import primkit as pk
from primkit.seen import REACH, is_seen, seen_shares

COORDINATES = st.floats(-0.05, 0.05)


def test_seen_shares_by_hand():
    square = pk.Polygon([(0, 0), (0.3, 0), (0.3, 0.3), (0, 0.3)])
    assert seen_shares(square, np.empty((0, 2))) == (0.0,) * 4
    below = np.column_stack([np.linspace(0, 0.15, 50), np.zeros(50)])
    assert seen_shares(square, below)[0] == pytest.approx(0.54, abs=0.03)
    half = pk.Circle((0, 0), 0.1).outline(100)[:50]
    assert seen_shares(pk.Circle((0, 0), 0.1), half)[0] == pytest.approx(0.53, abs=0.03)


def test_a_place_at_the_very_reach_is_seen():
    assert is_seen(np.array([(REACH, 0.0), (REACH * (1 + 1e-9), 0.0)]), np.zeros((1, 2))).tolist() == [True, False]


@given(
    places=npst.arrays(float, (6, 2), elements=COORDINATES),
    points=npst.arrays(float, st.tuples(st.integers(0, 5), st.just(2)), elements=COORDINATES),
)
def test_is_seen_against_all_distances(places, points):
    apart = np.linalg.norm(places[:, None] - points[None], axis=-1).min(axis=1, initial=np.inf)
    clear = np.abs(apart - REACH) > 1e-12
    assert np.array_equal(is_seen(places, points)[clear], (apart <= REACH)[clear])
    assert is_seen(places[None, None], points).shape == (1, 1, 6)
