"""The second opinion: pieces of one outline are merged, two shapes in one group are split, the rest is left."""

import numpy as np
import pytest

import primkit as pk
from primkit.robust import regroup
from primkit.robust.choice import explained
from primkit.robust.evidence import CERTAIN
from primkit.robust.regroup import cost_of
from primkit.robust.scatter import LEAST_SPREAD, NOWHERE

RECTANGLE = pk.Polygon([(-0.1, -0.04), (0.1, -0.04), (0.1, 0.04), (-0.1, 0.04)])
CIRCLE = pk.Circle((0.2, 0.0), 0.05)


def groups_of(*parts):
    return [explained(np.asarray(part), LEAST_SPREAD) for part in parts]


def regrouped(*arguments):
    return regroup.regrouped(*arguments)[0]


def kinds(groups):
    return sorted(g.shape.kind for g in groups if g.shape is not None)


def test_two_walls_of_a_rectangle_become_one_shape():
    points = RECTANGLE.outline(400)
    left, right = points[points[:, 0] < -0.02], points[points[:, 0] > 0.02]
    assert kinds(regrouped(groups_of(left, right), LEAST_SPREAD)) == ["rectangle"]


def test_three_arcs_become_one_circle():
    ring = CIRCLE.outline(120)
    assert kinds(regrouped(groups_of(ring[:30], ring[40:70], ring[80:110]), LEAST_SPREAD)) == ["circle"]


def test_neighbours_that_are_two_shapes_stay_two():
    both = regrouped(groups_of(RECTANGLE.outline(300), CIRCLE.outline(150)), LEAST_SPREAD)
    assert kinds(both) == ["circle", "rectangle"]


def test_half_seen_neighbours_stay_two():
    seen = RECTANGLE.outline(300)
    seen = seen[seen[:, 1] < 0.03]
    arc = CIRCLE.outline(150)
    assert len(regrouped(groups_of(seen, arc[arc[:, 1] < 0.02]), LEAST_SPREAD)) == 2


def test_two_shapes_in_one_group_are_split():
    together = np.vstack([RECTANGLE.outline(300), CIRCLE.outline(150)])
    assert kinds(regrouped(groups_of(together), LEAST_SPREAD)) == ["circle", "rectangle"]


@pytest.mark.parametrize("n", [1, 2, 3])
def test_a_known_number_is_kept_to(n):
    groups = groups_of(RECTANGLE.outline(300), CIRCLE.outline(150))
    assert len(regrouped(groups, LEAST_SPREAD, n)) == n


def test_points_too_few_for_a_shape_cost_what_strays_cost():
    """Were they free, each group would be better off without its corners."""
    few, more = groups_of(RECTANGLE.outline(300)[:4], RECTANGLE.outline(300)[:6])
    assert few.ranked == more.ranked == []
    assert cost_of([few]) == pytest.approx(-2 * 4 * np.log(NOWHERE))
    assert cost_of([few, more]) == pytest.approx(cost_of([few]) + cost_of([more]))


def test_nothing_stays_nothing():
    assert regrouped([], LEAST_SPREAD) == []
    assert regrouped([], LEAST_SPREAD, 3) == []


def test_no_point_is_lost():
    points = RECTANGLE.outline(400)
    parts = groups_of(points[:150], points[170:390], CIRCLE.outline(90))
    after = regrouped(parts, LEAST_SPREAD)
    assert sum(len(g.points) for g in after) == sum(len(g.points) for g in parts)


def test_the_margin_of_a_merger_is_what_it_gained():
    """Two walls of a rectangle could be two things: what became one by merging says by how much."""
    points = RECTANGLE.outline(400)
    pieces = groups_of(points[points[:, 0] < -0.02], points[points[:, 0] > 0.02])
    (one,), (margin,) = regroup.regrouped(pieces, LEAST_SPREAD)
    assert margin == pytest.approx(cost_of(pieces) - cost_of([one]))
    assert 0 < margin < float("inf")


def test_the_margin_of_a_split_is_what_it_gained():
    (whole,) = groups_of(np.vstack([RECTANGLE.outline(300), CIRCLE.outline(150)]))
    parts, margins = regroup.regrouped([whole], LEAST_SPREAD)
    gained = cost_of([whole]) - cost_of(parts)
    assert all(0 < margin <= gained for margin in margins)  # splitting a half once more may come closer


def test_the_margin_of_what_stayed_apart_is_what_merging_would_have_cost():
    box = pk.Polygon([(-0.2, -0.05), (-0.05, -0.05), (-0.05, 0.05), (-0.2, 0.05)]).outline(250)
    arc = pk.Circle((0.0, 0.0), 0.05).outline(160)
    pieces = groups_of(box[box[:, 0] < -0.052], arc[arc[:, 0] > 0.0])
    (union,) = groups_of(np.vstack([p.points for p in pieces]))
    _, margins = regroup.regrouped(pieces, LEAST_SPREAD)
    assert margins == pytest.approx([cost_of([union]) - cost_of(pieces)] * 2)


def test_the_margin_is_infinite_where_no_other_grouping_came_into_question():
    _, margins = regroup.regrouped(groups_of(RECTANGLE.outline(300), CIRCLE.outline(150)), LEAST_SPREAD)
    assert margins == [float("inf")] * 2


def test_pieces_on_one_hull_that_no_shape_explains_stay_two():
    """Three sides of a rectangle and half a circle make a convex outline together, but none of the shapes."""
    box = pk.Polygon([(-0.2, -0.05), (-0.05, -0.05), (-0.05, 0.05), (-0.2, 0.05)]).outline(250)
    arc = pk.Circle((0.0, 0.0), 0.05).outline(160)
    pieces = groups_of(box[box[:, 0] < -0.052], arc[arc[:, 0] > 0.0])
    assert kinds(regrouped(pieces, LEAST_SPREAD)) == ["circle", "rectangle"]


def test_a_last_piece_joins_an_outline_that_is_nearly_closed():
    ring = pk.Circle((0, 0), 0.08).outline(240)
    (group,) = regrouped(groups_of(ring[:218], ring[224:236]), LEAST_SPREAD)
    assert group.shape.kind == "circle"


@pytest.mark.parametrize("depth", [0.0, 0.06], ids=["lone points", "lone points and a group"])
def test_what_is_seen_of_a_notch_belongs_to_the_outline_around_it(depth):
    notched = [(0, 0), (0.2, 0), (0.2, 0.2), (0.15, 0.2), (0.15, 0.05), (0.05, 0.05), (0.05, 0.2), (0, 0.2)]
    ring = pk.Polygon(notched).outline(550)
    of_notch = (np.abs(ring[:, 0] - 0.1) < 0.0505) & (ring[:, 1] > 0.01) & (ring[:, 1] < 0.199)
    linked, lone = of_notch & (ring[:, 1] < depth), ring[of_notch & (ring[:, 1] >= depth)][::8]
    parts = [ring[~of_notch], ring[linked]][: 1 + linked.any()]
    (one,), (margin,) = regroup.regrouped(groups_of(*parts), LEAST_SPREAD, lone=lone)
    assert (one.shape.kind, len(one.shape.vertices), len(one.points)) == ("polygon", 8, sum(map(len, [*parts, lone])))
    assert margin > CERTAIN


def test_strays_inside_an_open_outline_stay_strays():
    points = RECTANGLE.outline(300)
    three_sides, strays = points[points[:, 1] < 0.039], np.random.default_rng(0).uniform(-0.03, 0.03, (4, 2))
    ((one,), _) = regroup.regrouped(groups_of(three_sides), LEAST_SPREAD, lone=strays)
    assert len(one.points) == len(three_sides)


def test_strays_in_a_group_do_not_split_it():
    ring, rng = pk.Circle((0, 0), 0.08).outline(160), np.random.default_rng(0)
    (group,) = regrouped(groups_of(np.vstack([ring, rng.uniform(-0.07, 0.07, (40, 2))])), LEAST_SPREAD)
    assert group.shape.kind == "circle"


def test_a_wall_is_not_taken_for_two_things(monkeypatch):
    """However long it is: nothing is cut that lies on one line."""
    wall = np.column_stack([np.arange(0, 0.3, 0.002), np.full(150, 0.1)])
    group = explained(wall, LEAST_SPREAD)
    assert group.shape is None
    cut = []
    real = regroup.kmeans
    monkeypatch.setattr(regroup, "kmeans", lambda *a, **k: cut.append(1) or real(*a, **k))
    assert regroup.regrouped([group], LEAST_SPREAD)[0] == [group]
    assert cut == []


def test_a_half_is_certain_only_beside_a_certain_half():
    """Where it is open what the other half is, so is where the group is cut."""
    arc = CIRCLE.outline(200)
    together = np.vstack([RECTANGLE.outline(300), arc[arc[:, 0] > CIRCLE.center[0]]])
    groups, margins = regroup.regrouped(groups_of(together), LEAST_SPREAD)
    of = {group.shape.kind: (group.certain, margin) for group, margin in zip(groups, margins, strict=True)}
    assert sorted(certain for certain, _ in of.values()) == [False, True]
    assert of["rectangle"][1] <= 0


def test_where_many_points_lie_beside_it_no_shape_is_certain():
    """They may be something else."""
    rng, outline = np.random.default_rng(0), RECTANGLE.outline(300)
    assert explained(outline, LEAST_SPREAD).certain
    beside = RECTANGLE.outline(60) * 1.15 + rng.uniform(-0.004, 0.004, (60, 2))
    choice = explained(np.vstack([outline, beside]), LEAST_SPREAD)
    assert choice.shape.kind == "rectangle"
    assert not choice.certain


@pytest.fixture
def beside_each_other():
    """Points of a pentagon and a triangle 10 mm apart, with sides that face each other; hardly any in the mouth."""
    pentagon = pk.Polygon([(0.207, 0.151), (0.18, 0.205), (0.089, 0.215), (0.056, 0.094), (0.125, 0.049)])
    world = pk.World([pentagon, pk.Polygon([(0.269, 0.05), (0.277, 0.154), (0.189, 0.209)])])
    grid = pk.Grid()
    grid.add(pk.scan(world, pk.teleport_poses(world)))
    return grid.points()


def test_two_shapes_that_make_one_outline_are_parted_where_it_bends_inwards(beside_each_other, monkeypatch):
    """K-Means parts by distance alone, and here that is amiss."""
    assert kinds(regrouped(groups_of(beside_each_other), LEAST_SPREAD)) == ["pentagon", "triangle"]
    monkeypatch.setattr(regroup, "_joints", lambda _: [])
    assert kinds(regrouped(groups_of(beside_each_other), LEAST_SPREAD)) != ["pentagon", "triangle"]


def test_what_is_seen_through_a_mouth_belongs_to_the_shape_that_explains_it():
    """Points around it lie on both, as these are fitted first: given to the nearer one, they hold a side amiss."""
    triangle = pk.Polygon([(0.1842, -0.0687), (0.2284, 0.0362), (0.1133, 0.0808)])
    rectangle = pk.Polygon([(0.3253, 0.0094), (0.3662, 0.115), (0.1686, 0.1916), (0.1277, 0.0859)])
    world = pk.World([triangle, rectangle])
    found = pk.find_shapes(pk.scan(world, pk.teleport_poses(world)).points(), rng=0)
    assert [pair.all_right for pair in pk.evaluate(found, world).matches] == [True, True]


def test_a_side_that_was_not_seen_does_not_run_along_another_shape():
    """The rectangle's, 15 mm from the pentagon: on it lie no points, and beyond it those of the pentagon's."""
    corners = [(0.1441, 0.2041), (0.1097, 0.2805), (-0.073, 0.2156), (-0.108, 0.1663), (-0.0684, 0.1058)]
    rectangle = pk.Polygon([(0.1483, 0.0571), (0.0979, 0.1662), (-0.0427, 0.1012), (0.0077, -0.0079)])
    world, grid = pk.World([pk.Polygon(corners), rectangle]), pk.Grid()
    grid.add(pk.scan(world, pk.teleport_poses(world)))
    assert all(pair.all_right for pair in pk.evaluate(pk.find_shapes(grid, rng=0), world).matches)


def test_a_convex_outline_is_not_parted(beside_each_other, monkeypatch):
    asked = []
    real = regroup._sides
    monkeypatch.setattr(regroup, "_sides", lambda *a: asked.append(1) or real(*a))
    bearings = np.arange(6) * np.pi / 3
    hexagon = pk.Polygon(0.1 * np.column_stack([np.cos(bearings), np.sin(bearings)]))
    assert kinds(regrouped(groups_of(hexagon.outline(400)), LEAST_SPREAD)) == ["polygon"]
    assert asked == []
    regrouped(groups_of(beside_each_other), LEAST_SPREAD)
    assert asked
