"""Which points belong together: K-Means against all partitions, linking against the graph's components."""

import tracemalloc
from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.sparse.csgraph import connected_components
from scipy.spatial.distance import cdist

from primkit import segmentation
from primkit.arguments import ROUNDING
from primkit.segmentation import LEAST_GROUP, LINK, count_by_silhouette, kmeans, link, segment
from primkit.shapes import Circle, Polygon
from tests.helpers import exactly

NAN, INF = float("nan"), float("inf")


def rectangle(x, y, width, height):
    return Polygon([(x, y), (x + width, y), (x + width, y + height), (x, y + height)])


# Four outlines, clearly apart, none above another; together 240 points.
CLEAR = [
    Circle((-0.30, 0.20), 0.06).outline(60),
    rectangle(-0.15, -0.30, 0.12, 0.10).outline(60),
    Polygon([(0.10, 0.20), (0.24, 0.20), (0.17, 0.30)]).outline(60),
    Circle((0.33, -0.25), 0.05).outline(60),
]
# What K-Means is bad at: 36 cm by 2 cm, 8 cm away from a circle of 3 cm radius.
THIN = rectangle(-0.36, -0.01, 0.36, 0.02).outline(200)
SMALL = Circle((0.11, 0.0), 0.03).outline(50)


def numbered(groups):
    return np.repeat(np.arange(len(groups)), [len(g) for g in groups])


def row(n, step=0.005, x=0.0, y=0.0):
    """n points on a horizontal line, from x to the right."""
    return [(x + step * i, y) for i in range(n)]


# --- K-Means ------------------------------------------------------------------------------------------------

KMEANS = {
    "one point": ([(3, 4)], 1, [0]),
    "all points equal": ([(0.1, 0.1)] * 4, 1, [0, 0, 0, 0]),
    "one group": ([(0, 0), (5, 5), (1, 1)], 1, [0, 0, 0]),
    "as many groups as points": ([(3, 0), (1, 0), (2, 0)], 3, [2, 0, 1]),
    "a doubled point counts once": ([(0, 0), (9, 9), (0, 0)], 2, [0, 1, 0]),
    "numbered from left to right": ([(5, 0), (5, 1), (-5, 0), (0, 3), (0, 4)], 3, [2, 2, 0, 1, 1]),
    "one above the other: from below": ([(1, 8), (1, 0), (1, 8.1), (1, 0.1)], 2, [1, 0, 1, 0]),
    "on one line": ([(0, 0), (1, 1), (10, 10), (11, 11)], 2, [0, 0, 1, 1]),
    "far from the origin": ([(1e6, 1e6), (1e6 + 0.1, 1e6), (1e6 + 2, 1e6)], 2, [0, 0, 1]),
}


@pytest.mark.parametrize(("points", "k", "labels"), KMEANS.values(), ids=KMEANS)
def test_kmeans(points, k, labels):
    got = kmeans(points, k, rng=0)
    assert got.dtype == np.intp
    assert got.tolist() == labels


def test_kmeans_takes_whole_numbers_like_any_others():
    points = [(0, 0), (0, 1), (9, 9), (9, 8)]
    for dtype in (int, np.int16, np.float32, float):
        assert kmeans(np.array(points, dtype=dtype), 2, rng=0).tolist() == [0, 0, 1, 1]


KMEANS_FAILURES = {
    "no group": ([(0, 0)], 0, "k must be a whole number >= 1, got 0"),
    "less than none": ([(0, 0)], -2, "k must be a whole number >= 1, got -2"),
    "half a group": ([(0, 0)], 1.5, "k must be a whole number >= 1, got 1.5"),
    "a yes": ([(0, 0)], True, "k must be a whole number >= 1, got True"),
    "more than points": ([(0, 0), (1, 1)], 3, "k must be at most the number of different points, got 3 for 2"),
    "more than different": ([(0, 0), (0, 0)], 2, "k must be at most the number of different points, got 2 for 1"),
    "minus 0 is 0": (
        [(0.0, 0), (-0.0, 0)],
        2,
        "k must be at most the number of different points, got 2 for 1",
    ),
    "no points": ([], 1, "k must be at most the number of different points, got 1 for 0"),
    "NaN": ([(0, 0), (NAN, 1)], 1, "points must be finite, got (nan, 1.0) in row 1"),
    "infinite": ([(0, -INF)], 1, "points must be finite, got (0.0, -inf) in row 0"),
    "three columns": ([(0, 0, 0)], 1, "points must have shape (N, 2), got shape (1, 3)"),
    "one dimension": ([0, 0], 1, "points must have shape (N, 2), got shape (2,)"),
    "words": ([("a", "b")], 1, "points must be numbers in an array of shape (N, 2), got [('a', 'b')]"),
}


@pytest.mark.parametrize("seed", [-1, 0.5, "seven"])
@pytest.mark.parametrize("function", [kmeans, segment])
def test_a_seed_is_a_whole_number_or_a_generator(function, seed):
    sentence = f"rng must be a whole number >= 0 or a numpy Generator, got {seed!r}"
    with pytest.raises(ValueError, match=exactly(sentence)):
        function([(0, 0), (1, 1)], 1, rng=seed)


@pytest.mark.parametrize(("points", "k", "sentence"), KMEANS_FAILURES.values(), ids=KMEANS_FAILURES)
def test_kmeans_failure(points, k, sentence):
    with pytest.raises(ValueError, match=exactly(sentence)):
        kmeans(points, k, rng=0)


def scatter_within(points, labels):
    """Sum of squared distances to the group's mean: what K-Means makes least."""
    return sum(((points[labels == g] - points[labels == g].mean(axis=0)) ** 2).sum() for g in set(labels.tolist()))


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("k", [2, 3])
def test_kmeans_is_as_compact_as_the_best_of_all_partitions(k, seed):
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(7, 2)) + 4 * rng.normal(size=(k, 2))[np.arange(7) % k]
    best = min(scatter_within(points, np.array(labels)) for labels in product(range(k), repeat=7))
    assert scatter_within(points, kmeans(points, k, rng=seed)) == pytest.approx(best, rel=1e-12)


def test_clear_groups_are_numbered_alike_whatever_the_seed():
    points = np.vstack(CLEAR)
    for seed in range(20):
        assert np.array_equal(kmeans(points, 4, rng=seed), numbered(CLEAR))


@pytest.mark.parametrize("seed", range(5))
def test_permuted_points_bear_permuted_labels(seed):
    points = np.vstack(CLEAR)
    order = np.random.default_rng(seed).permutation(len(points))
    assert np.array_equal(kmeans(points[order], 4, rng=seed), numbered(CLEAR)[order])


def test_groups_one_above_the_other_keep_their_numbers_in_any_order():
    """Regression: their means in x differ by 1e-17, one way or the other, with the order of summing."""
    groups = [Circle((0.2, -0.3), 0.05).outline(40), Circle((0.2, 0.3), 0.05).outline(40)]
    points = np.vstack(groups)
    for seed in range(20):
        order = np.random.default_rng(seed).permutation(80)
        assert np.array_equal(kmeans(points[order], 2, rng=0), numbered(groups)[order])


@pytest.mark.parametrize("make", [int, np.random.default_rng], ids=["seed", "generator"])
def test_the_same_seed_gives_the_same_labels(make):
    points = np.random.default_rng(1).uniform(size=(80, 2))  # no clear groups: the starts matter
    assert np.array_equal(kmeans(points, 7, rng=make(5)), kmeans(points, 7, rng=make(5)))


def test_the_seed_matters_where_groups_are_not_clear():
    points = np.random.default_rng(1).uniform(size=(80, 2))
    assert len({kmeans(points, 7, rng=seed).tobytes() for seed in range(5)}) > 1


COINCIDENT = {
    "two, too close to square their distance": [(0, 0), (1e-200, 0)],
    "three, too close to square their distance": [(0, 0), (1e-200, 0), (0, 3e-200)],
    "pairs closer than rounding can tell": [(0, 0), (1e-9, 0), (1, 0), (1, 1e-9), (2e-9, 0)],
}


@pytest.mark.parametrize("points", COINCIDENT.values(), ids=COINCIDENT)
def test_points_that_all_but_coincide_cause_no_warning(points):
    """Regression: scikit-learn warned that it had found fewer groups than asked for."""
    for k in range(1, len(points) + 1):
        assert set(kmeans(points, k, rng=0).tolist()) <= set(range(k))
    assert count_by_silhouette([*points, points[0]], rng=0) in (1, 2)


# --- how many? ----------------------------------------------------------------------------------------------

COUNTS = {
    "no points": ([], 0),
    "one point": ([(1, 1)], 1),
    "all points equal": ([(0.1, 0.1)] * 5, 1),
    "two points": ([(0, 0), (9, 9)], 1),  # the silhouette needs a group of two
    "two pairs": ([(0, 0), (0, 1), (9, 9), (9, 8)], 2),
    "a pair and one apart": ([(0, 0), (0, 1), (9, 9)], 2),  # as many groups as can have a silhouette
    "two outlines": (np.vstack(CLEAR[:2]), 2),
    "three outlines": (np.vstack(CLEAR[1:]), 3),
    "four outlines": (np.vstack(CLEAR), 4),
    "one ring": (CLEAR[0], 1),
}


@pytest.mark.parametrize(("points", "count"), COUNTS.values(), ids=COUNTS)
def test_count_by_silhouette(points, count):
    assert count_by_silhouette(points, rng=0) == count


def test_count_by_silhouette_goes_no_farther_than_told():
    assert count_by_silhouette(np.vstack(CLEAR), most=3, rng=0) <= 3
    assert count_by_silhouette(np.vstack(CLEAR), most=1, rng=0) == 1


COUNT_FAILURES = {
    "at most none": ([(0, 0)], 0, "most must be a whole number >= 1, got 0"),
    "NaN": ([(NAN, 0)], 3, "points must be finite, got (nan, 0.0) in row 0"),
    "wrong shape": ([[[0, 0]]], 3, "points must have shape (N, 2), got shape (1, 1, 2)"),
}


@pytest.mark.parametrize(("points", "most", "sentence"), COUNT_FAILURES.values(), ids=COUNT_FAILURES)
def test_count_by_silhouette_failure(points, most, sentence):
    with pytest.raises(ValueError, match=exactly(sentence)):
        count_by_silhouette(points, most, rng=0)


def silhouette(points, labels):
    """Rousseeuw's definition, point by point."""
    distance = cdist(points, points)
    values = []
    for i, own in enumerate(labels):
        mates = np.flatnonzero(labels == own)
        if len(mates) == 1:
            values.append(0.0)
            continue
        a = distance[i, mates].sum() / (len(mates) - 1)
        b = min(distance[i, labels == other].mean() for other in set(labels.tolist()) - {own})
        values.append((b - a) / max(a, b))
    return np.mean(values)


@pytest.mark.parametrize("seed", range(4))
def test_the_count_has_the_best_silhouette_of_all(seed):
    rng = np.random.default_rng(seed)
    points = np.vstack([center + 0.1 * rng.normal(size=(12, 2)) for center in rng.uniform(-2, 2, (2 + seed, 2))])
    scores = {k: silhouette(points, kmeans(points, k, rng=0)) for k in range(2, 8)}
    assert max(scores.values()) > 0.5
    assert count_by_silhouette(points, most=7, rng=0) == max(scores, key=scores.get)


def test_kmeans_cuts_a_long_thin_rectangle_beside_a_small_circle():
    """The known weakness that the lesson shows, with the right number given; linking is the remedy."""
    points, truth = np.vstack([THIN, SMALL]), numbered([THIN, SMALL])
    labels = kmeans(points, 2, rng=0)
    assert set(labels[truth == 0].tolist()) == {0, 1}  # a piece of the rectangle goes with the circle
    assert np.mean(labels[truth == 0] == 1) > 0.2
    assert np.array_equal(link(points), truth)


def test_silhouette_miscounts_a_long_thin_rectangle_beside_a_small_circle():
    points = np.vstack([THIN, SMALL])
    assert count_by_silhouette(points, rng=0) == 3
    assert link(points).max() + 1 == 2


# --- linking ------------------------------------------------------------------------------------------------

LINKED = {
    "no points": ([], []),
    "one point": ([(0, 0)], [-1]),
    "two points far apart": ([(0, 0), (1, 1)], [-1, -1]),
    "a handful of strays": (row(LEAST_GROUP - 1), [-1] * (LEAST_GROUP - 1)),
    "the least group": (row(LEAST_GROUP), [0] * LEAST_GROUP),
    "all points equal": ([(0.1, 0.1)] * LEAST_GROUP, [0] * LEAST_GROUP),
    "a group and a stray": ([*row(10), (0.5, 0.5)], [0] * 10 + [-1]),
    "a group and a handful": (row(10) + row(5, x=0.5), [0] * 10 + [-1] * 5),
    "from left to right": (row(10, x=0.5) + row(10), [1] * 10 + [0] * 10),
    "from below": (row(10, y=0.5) + row(10), [1] * 10 + [0] * 10),
    "whole numbers": (np.zeros((9, 2), dtype=int), [0] * 9),
}


@pytest.mark.parametrize(("points", "labels"), LINKED.values(), ids=LINKED)
def test_link(points, labels):
    got = link(points)
    assert got.dtype == np.intp
    assert got.tolist() == labels


LINK_FAILURES = {
    "no reach": (([(0, 0)], 0.0), "reach must be a finite number > 0, got 0"),
    "reach below zero": (([(0, 0)], -1), "reach must be a finite number > 0, got -1"),
    "endless reach": (([(0, 0)], INF), "reach must be a finite number > 0, got inf"),
    "NaN reach": (([(0, 0)], NAN), "reach must be a finite number > 0, got nan"),
    "no neighbours": (([(0, 0)], 0.02, 0), "neighbours must be a whole number >= 1, got 0"),
    "two and a half": (([(0, 0)], 0.02, 2.5), "neighbours must be a whole number >= 1, got 2.5"),
    "NaN": (([(0, NAN)],), "points must be finite, got (0.0, nan) in row 0"),
    "wrong shape": (([(0, 1, 2)],), "points must have shape (N, 2), got shape (1, 3)"),
}


@pytest.mark.parametrize(("arguments", "sentence"), LINK_FAILURES.values(), ids=LINK_FAILURES)
def test_link_failure(arguments, sentence):
    with pytest.raises(ValueError, match=exactly(sentence)):
        link(*arguments)


@pytest.mark.parametrize(
    ("gap", "groups"),
    [(LINK - 1e-6, 1), (LINK, 1), (LINK + 1e-6, 2)],
    ids=["closer than the reach", "at the reach", "farther than the reach"],
)
def test_two_rows_are_joined_at_the_reach_and_split_beyond(gap, groups):
    """The boundary belongs to it wherever the rows lie: 0.366 - 0.344 is a little more than 0.022."""
    for shift in np.arange(-50, 50) / 100:
        right_end = 0.045 + shift
        points = row(10, x=shift) + row(10, x=right_end + gap)
        assert link(points).max() + 1 == groups


def test_crowds_are_not_compared_point_by_point():
    """Two of three crowds lie within reach of each other, the third beyond."""
    crowds = [
        np.random.default_rng(0).normal((x, 0.5 * LINK), 2e-4, (2000, 2)) for x in (0.5 * LINK, 1.3 * LINK, LINK * 3)
    ]
    tracemalloc.start()
    labels = link(np.vstack(crowds))
    _, most = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert labels.tolist() == np.repeat([0, 0, 1], 2000).tolist()
    assert most < 2000**2  # bytes: less than one for each pair


def test_a_chain_is_one_group_however_long():
    chain = row(80, step=0.01)  # each is a neighbour of the next two, the ends are 0.8 m apart
    assert link(chain).tolist() == [0] * 80


@pytest.mark.parametrize(("neighbours", "label"), [(3, 0), (4, -1)])
def test_a_point_hands_on_its_group_when_it_has_neighbours_enough(neighbours, label):
    """Each but the ends has two neighbours within reach, itself is the third."""
    assert link(row(8, step=0.02), reach=0.02, neighbours=neighbours).tolist() == [label] * 8


def test_a_lone_point_between_two_groups_goes_to_the_same_one_in_any_order():
    """Regression: it went to whichever group was met first."""
    points = np.array([*row(10), (0.045 + LINK, 0.0), *row(10, x=0.045 + 2 * LINK)])
    labels = link(points)
    assert labels.tolist() == [0] * 11 + [1] * 10
    for seed in range(10):
        order = np.random.default_rng(seed).permutation(len(points))
        assert np.array_equal(link(points[order]), labels[order])


@pytest.mark.parametrize("seed", range(10))
def test_link_does_not_depend_on_the_order(seed):
    rng = np.random.default_rng(seed)
    points = rng.uniform(size=(300, 2)) * 0.5
    order = rng.permutation(len(points))
    assert np.array_equal(link(points)[order], link(points[order]))


def components(points, reach):
    """Groups of the graph that joins each two points within reach; -1 for those below the least size."""
    _, labels = connected_components(cdist(points, points) <= reach)
    return np.where(np.bincount(labels)[labels] < LEAST_GROUP, -1, labels)


def same_groups(a, b):
    """Whether two labellings make the same groups, whatever their numbers, and the same strays."""
    pairs = set(zip(a.tolist(), b.tolist(), strict=True))
    return len(pairs) == len({x for x, _ in pairs}) == len({y for _, y in pairs}) and all(
        (x == -1) == (y == -1) for x, y in pairs
    )


@given(seed=st.integers(0, 2**32 - 1), n=st.integers(1, 120), reach=st.floats(0.01, 0.2))
def test_linking_single_neighbours_finds_the_components_of_the_graph(seed, n, reach):
    points = np.random.default_rng(seed).uniform(size=(n, 2))
    labels = link(points, reach, neighbours=1)
    assert same_groups(labels, components(points, reach))
    assert set(labels.tolist()) - {-1} == set(range(labels.max() + 1))
    lefts = [points[labels == g].mean(axis=0)[0] for g in range(labels.max() + 1)]
    assert lefts == sorted(lefts)


@given(
    seed=st.integers(0, 2**32 - 1),
    n=st.integers(1, 300),
    size=st.sampled_from([0.03, 0.1, 0.3, 1.0]),
    reach=st.floats(0.005, 0.1),
    neighbours=st.integers(1, 8),
    digits=st.integers(2, 9),
)
def test_linking_is_dbscan(seed, n, size, reach, neighbours, digits):
    """Cells are a short cut, and must lead to the same place: also for points at one place, and on the cells' edges."""
    from sklearn.cluster import DBSCAN

    points = (np.random.default_rng(seed).uniform(size=(n, 2)) * size).round(digits)
    points = points[np.lexsort(points.T[::-1])]
    expected = DBSCAN(eps=reach + ROUNDING, min_samples=neighbours).fit_predict(points)
    sizes = np.bincount(expected + 1)
    expected[sizes[expected + 1] < LEAST_GROUP] = -1
    assert same_groups(link(points, reach, neighbours), expected)


@given(
    gap=st.floats(0.7, 1.5).filter(lambda g: abs(g - 1) > 1e-6),
    angle=st.floats(-np.pi, np.pi),
    shift=st.tuples(st.floats(-1, 1), st.floats(-1, 1)),
    neighbours=st.integers(1, 3),
)
def test_a_gap_parts_two_rows_if_and_only_if_it_is_wider_than_the_reach(gap, angle, shift, neighbours):
    """Wherever the cells' edges lie: cells that are next to each other are within reach, others need not be."""
    along = np.concatenate([0.3 * np.arange(10), 2.7 + gap + 0.3 * np.arange(10)]) * LINK
    points = along[:, None] * (np.cos(angle), np.sin(angle)) + shift
    assert len(set(link(points, neighbours=neighbours).tolist())) == (1 if gap < 1 else 2)


def test_linking_far_away_points():
    """Nearly a million kilometres apart, and still two groups: no number of a cell overflows."""
    one = np.array(row(10))
    assert link(np.vstack([one, one + 1e9]), neighbours=1, reach=0.5).tolist() == [0] * 10 + [1] * 10


@given(angle=st.floats(-np.pi, np.pi), shift=st.floats(-1e3, 1e3))
@settings(max_examples=30)
def test_turning_and_shifting_leaves_the_groups(angle, shift):
    points = np.vstack([*CLEAR, THIN - (0.0, 0.1), [(0.45, 0.45), (0.45, 0.44)]])
    c, s = np.cos(angle), np.sin(angle)
    turned = points @ np.array([[c, s], [-s, c]])
    assert same_groups(link(points), link(turned + shift))


# --- one door for both --------------------------------------------------------------------------------------


@pytest.mark.parametrize(("method", "n_shapes"), [("kmeans", None), ("kmeans", 0), ("link", None)])
def test_no_points_have_no_labels(method, n_shapes):
    labels = segment([], n_shapes, method=method, rng=0)
    assert labels.shape == (0,)
    assert labels.dtype == np.intp


def test_segment_is_kmeans_when_told_the_number():
    points = np.vstack(CLEAR)
    assert np.array_equal(segment(points, 3, rng=4), kmeans(points, 3, rng=4))


def test_segment_finds_the_number_when_not_told():
    points = np.vstack(CLEAR)
    assert np.array_equal(segment(points, rng=0), numbered(CLEAR))


def test_segment_links_and_takes_no_number():
    points = np.vstack([THIN, SMALL])
    assert np.array_equal(segment(points, method="link"), link(points))
    sentence = 'n_shapes must be None with method "link", which finds the number itself, got 5'
    with pytest.raises(ValueError, match=exactly(sentence)):
        segment(points, 5, method="link")


def test_segment_with_the_same_seed_gives_the_same_labels():
    points = np.random.default_rng(3).uniform(size=(9, 2))
    assert np.array_equal(segment(points, rng=9), segment(points, rng=np.random.default_rng(9)))


SEGMENT_FAILURES = {
    "unknown method": ([(0, 0)], 1, "dbscan", 'method must be "kmeans" or "link", got \'dbscan\''),
    "no method": ([(0, 0)], 1, None, 'method must be "kmeans" or "link", got None'),
    "too many": ([(0, 0)], 2, "kmeans", "n_shapes must be at most the number of different points, got 2 for 1"),
    "too many to link": ([(0, 0)], 2, "link", "n_shapes must be at most the number of different points, got 2 for 1"),
    "some of no points": ([], 1, "kmeans", "n_shapes must be at most the number of different points, got 1 for 0"),
    "below zero": ([(0, 0)], -1, "kmeans", "n_shapes must be a whole number >= 0, got -1"),
    "a part": ([(0, 0)], 0.5, "kmeans", "n_shapes must be a whole number >= 0, got 0.5"),
    "none of one": ([(0, 0)], 0, "kmeans", "k must be a whole number >= 1, got 0"),
    "NaN": ([(NAN, 0)], 1, "link", "points must be finite, got (nan, 0.0) in row 0"),
    "wrong shape": ([1, 2, 3], 1, "link", "points must have shape (N, 2), got shape (3,)"),
}


@pytest.mark.parametrize(("points", "n_shapes", "method", "sentence"), SEGMENT_FAILURES.values(), ids=SEGMENT_FAILURES)
def test_segment_failure(points, n_shapes, method, sentence):
    with pytest.raises(ValueError, match=exactly(sentence)):
        segment(points, n_shapes, method=method, rng=0)


def test_the_least_group_is_what_the_tests_take_it_for():
    assert (segmentation.LINK, segmentation.LINK_NEIGHBOURS, segmentation.LEAST_GROUP) == (0.022, 4, 8)
