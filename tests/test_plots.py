"""Pictures: what is drawn, that it can be told apart and read, and that drawing leaves nothing behind."""

import pickle
import re
from dataclasses import replace
from functools import cache
from itertools import combinations
from pathlib import Path

import matplotlib
import matplotlib.pyplot as plt
import numpy as np
import pytest
import shapely
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection
from matplotlib.colors import to_hex, to_rgb
from matplotlib.figure import Figure
from matplotlib.image import imread
from matplotlib.patches import Rectangle

from primkit.driving import explore
from primkit.evaluation import evaluate
from primkit.found import Found
from primkit.grid import Grid
from primkit.lidar import Lidar, Scans, scan
from primkit.measure import Detection, Wall
from primkit.palette import CLUSTER_COLORS, CLUSTER_MARKERS, GREY, KIND_COLORS, KIND_INKS, KIND_MARKERS
from primkit.pipeline import find_shapes
from primkit.plots import (
    labels,
    look,
    plot_change,
    plot_clusters,
    plot_found,
    plot_points,
    plot_scan,
    plot_story,
    plot_tour,
    plot_world,
    save_figure,
)
from primkit.plots.told import told
from primkit.robot import teleport_poses
from primkit.segmentation import segment
from primkit.shapes import KINDS, PRIMITIVES, Circle, Polygon
from primkit.world import World, random_world
from tests.helpers import exactly
from tests.test_account import seen_on
from tests.test_scale import board
from tests.test_unknown import CURVED

PICTURES = Path(__file__).resolve().parent.parent / "data" / "pictures"


@cache
def steps(world):
    """What the story hands on, for plot_story: world, scans, points, labels, found, report."""
    scans = scan(world, teleport_poses(world))
    grid = Grid()
    grid.add(scans)
    points = grid.points()
    found = find_shapes(points, rng=0)
    return world, scans, points, segment(points, method="link"), found, evaluate(found, world)


def square(x, y, side):
    return Polygon([(x, y), (x + side, y), (x + side, y + side), (x, y + side)])


FOUR_KINDS = random_world(4, kinds=PRIMITIVES, rng=3)
CROWD = random_world(25, style="free", size=2, rng=1)
DISC = World([Circle((0.2, 0.0), 0.1)])
OVER_THE_EDGE = World([Circle((0.47, 0.47), 0.1), square(-0.55, -0.55, 0.1)])
STRAY = [*Circle((0, 0), 0.1).outline(40), (0.4, 0.4)]


def found_in(world, shapes):
    return lambda ax: plot_found(shapes, world, ax, evaluate(shapes, world))


PLOTS = {
    "world": lambda ax: plot_world(FOUR_KINDS, ax),
    "empty world": lambda ax: plot_world(World(), ax),
    "crowded world": lambda ax: plot_world(CROWD, ax),
    "world over the edge": lambda ax: plot_world(OVER_THE_EDGE, ax),
    "scan": lambda ax: plot_scan(DISC, scan(DISC, [(0, 0, 0.5)]), ax=ax),
    "scan in a corner": lambda ax: plot_scan(DISC, scan(DISC, [(-0.5, -0.5, 0)]), 0, ax),
    "scan from inside": lambda ax: plot_scan(DISC, scan(DISC, [(0.2, 0, 0)]), 0, ax),
    "points": lambda ax: plot_points(steps(FOUR_KINDS)[2], ax),
    "one point": lambda ax: plot_points([(0.1, 0.1)], ax),
    "no points": lambda ax: plot_points([], ax),
    "points off the board": lambda ax: plot_points([(0.9, 0.1)], ax),
    "clusters": lambda ax: plot_clusters(*steps(FOUR_KINDS)[2:4], ax),
    "one point clustered": lambda ax: plot_clusters([(0.1, 0.1)], [0], ax),
    "strays": lambda ax: plot_clusters(STRAY, [0] * 40 + [-1], ax),
    "no clusters": lambda ax: plot_clusters([], [], ax),
    "found": lambda ax: plot_found(steps(FOUR_KINDS)[4], FOUR_KINDS, ax, steps(FOUR_KINDS)[5]),
    "found, truth unknown": lambda ax: plot_found(steps(FOUR_KINDS)[4], ax=ax),
    "found, truth from the report": lambda ax: plot_found(steps(FOUR_KINDS)[4], ax=ax, report=steps(FOUR_KINDS)[5]),
    "nothing found": lambda ax: plot_found([], ax=ax),
    "all missed": found_in(FOUR_KINDS, []),
    "false alarm": found_in(World(), [Circle((0.1, 0.1), 0.05)]),
    "absurdly large": found_in(DISC, [Circle((-2, 2), 2.6), Circle((3, 3), 1)]),
    "crowd found": found_in(CROWD, list(CROWD.shapes)),
}


@pytest.fixture
def ax():
    figure = Figure(figsize=look.FIGURE_SIZE, layout="constrained")
    FigureCanvasAgg(figure)
    return figure.add_subplot()


@pytest.fixture(autouse=True)
def nothing_left_behind():
    before = dict(matplotlib.rcParams)
    yield
    plt.close("all")
    assert dict(matplotlib.rcParams) == before


def title(ax):
    return ax.get_title(loc="left").replace("\n", " ")


def shown_labels(ax):
    """The texts on the axes that are seen, once they are drawn."""
    ax.figure.canvas.draw()
    return [text for text in ax.texts if text.get_visible()]


def box_of(text):
    """The rectangle that a text covers, in metres."""
    extent = text.get_window_extent().transformed(text.axes.transData.inverted())
    return shapely.box(*extent.extents)


# --- all plots ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("plot", PLOTS.values(), ids=PLOTS)
def test_draws_on_the_given_axes_in_metres(plot, ax):
    assert plot(ax) is ax
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("x [m]", "y [m]")
    assert ax.get_aspect() == 1.0
    assert min(ax.get_xlim()[1], ax.get_ylim()[1], -ax.get_xlim()[0], -ax.get_ylim()[0]) > 0.5  # the whole board
    assert title(ax)
    assert plt.get_fignums() == []


@pytest.mark.parametrize("plot", PLOTS.values(), ids=PLOTS)
def test_nothing_is_clipped(plot, ax):
    plot(ax)
    ax.figure.canvas.draw()
    page = ax.figure.bbox
    assert page.x0 <= ax.get_tightbbox().x0
    assert page.y0 <= ax.get_tightbbox().y0
    for artist in [ax.title, ax._left_title, ax.xaxis.label, ax.yaxis.label, *filter(None, [ax.get_legend()])]:
        box = artist.get_window_extent()
        assert page.x0 - 1 <= box.x0
        assert box.x1 <= page.x1 + 1
        assert box.y1 <= page.y1 + 1


@pytest.mark.parametrize("plot", [lambda: plot_points([]), lambda: plot_found([]), lambda: plot_world(World())])
def test_without_axes_makes_one_figure(plot):
    ax = plot()
    assert plt.get_fignums() == [1]
    assert plt.gca() is ax


TITLES = {
    "world": "4 shapes: 1 circle, 1 triangle, 1 rectangle, 1 pentagon",
    "empty world": "No shapes",
    "scan": "Scan 0: 17 of 100 beams hit",
    "scan in a corner": "Scan 0: 0 of 100 beams hit",
    "scan from inside": "Scan 0: inside a shape, it sees nothing",
    "one point": "1 point on the grid",
    "no points": "No points on the grid",
    "clusters": "4 clusters",
    "strays": "1 cluster, 1 stray",
    "no clusters": "No clusters",
    "found, truth unknown": "4 shapes found",
    "nothing found": "No shapes found",
    "all missed": "0 of 4 shapes right, 4 missed",
    "false alarm": "There is no shape, 1 false alarm",
    "absurdly large": "0 of 1 shape right, 1 missed, 2 false alarms",
    "crowd found": "25 shapes found, all within 0 mm",
}


@pytest.mark.parametrize(("name", "finding"), TITLES.items(), ids=TITLES)
def test_title_states_the_finding(name, finding, ax):
    PLOTS[name](ax)
    assert title(ax) == finding


def test_title_keeps_a_number_and_its_unit_on_one_line(ax):
    ax.figure.set_size_inches(1.8, 2)
    look.set_title(ax, "8 shapes found, all within 0.5 mm")
    lines = ax.get_title(loc="left").split("\n")
    assert len(lines) > 1
    assert "0.5 mm" in lines[-1]


OWN_TITLE = {
    "world": lambda **own: plot_world(DISC, **own),
    "scan": lambda **own: plot_scan(DISC, scan(DISC, [(0, 0, 0)]), **own),
    "points": lambda **own: plot_points(STRAY, **own),
    "clusters": lambda **own: plot_clusters(STRAY, [0] * 40 + [-1], **own),
    "found": lambda **own: plot_found(DISC.shapes, **own),
    "tour": lambda **own: plot_tour(DISC, explore(DISC, rng=0, most_scans=2), **own),
    "change": lambda **own: plot_change(DISC, World(), STRAY, **own),
}
OWN_COLOR = {name: OWN_TITLE[name] for name in ("world", "scan", "points", "found")}


@pytest.mark.parametrize("plot", OWN_TITLE.values(), ids=OWN_TITLE)
def test_a_title_of_one_s_own(plot, ax):
    assert title(plot(ax=ax, title="What I see")) == "What I see"
    assert title(plot(ax=ax, title="")) == ""


@pytest.mark.parametrize("plot", OWN_COLOR.values(), ids=OWN_COLOR)
def test_a_colour_of_one_s_own(plot, ax):
    def colors(drawn):
        lines = [to_hex(c) for line in drawn.lines for c in (line.get_color(), line.get_markeredgecolor())]
        patches = [to_hex(patch.get_edgecolor()) for patch in drawn.patches]
        return [*lines, *patches, *(to_hex(c) for some in drawn.collections for c in some.get_colors())]

    usual = colors(plot(ax=ax))
    ax.clear()
    own = colors(plot(ax=ax, color="saddlebrown"))
    changed = {(before, after) for before, after in zip(usual, own, strict=True) if before != after}
    assert {after for _, after in changed} == {"#8b4513"}
    assert len(changed) == 1  # of one colour before


@pytest.mark.parametrize(
    ("own", "message"),
    [
        ({"title": 3}, "title must be a text, got int"),
        ({"color": "no colour"}, """color must be a colour, such as "tab:blue" or "#0072B2", got 'no colour'"""),
    ],
    ids=["title", "color"],
)
@pytest.mark.parametrize("plot", OWN_COLOR.values(), ids=OWN_COLOR)
def test_a_look_of_one_s_own_failure(plot, own, message):
    with pytest.raises(ValueError, match=exactly(message)):
        plot(**own)
    assert plt.get_fignums() == []


# --- colours and signs --------------------------------------------------------------------------------------

# How a dichromat sees linear RGB: Machado, Oliveira and Fernandes (2009), severity 1.
SIGHT = {
    "normal": np.eye(3),
    "deuteranopia": [(0.367322, 0.860646, -0.227968), (0.280085, 0.672501, 0.047413), (-0.01182, 0.04294, 0.968881)],
    "protanopia": [(0.152286, 1.052583, -0.204868), (0.114503, 0.786281, 0.099216), (-0.003882, -0.048116, 1.051998)],
}
RGB_TO_XYZ = np.array([(0.4124, 0.3576, 0.1805), (0.2126, 0.7152, 0.0722), (0.0193, 0.1192, 0.9505)])


def linear(color):
    rgb = np.array(to_rgb(color))
    return np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)


def lab(color, sight):
    """CIE L*a*b* of a colour as it is seen: distances are differences to the eye, 2.3 just noticeable."""
    x, y, z = np.cbrt(RGB_TO_XYZ @ np.clip(sight @ linear(color), 0, 1) / (0.9505, 1, 1.089))
    return np.array([116 * y - 16, 500 * (x - y), 200 * (y - z)])


@pytest.mark.parametrize("sight", SIGHT.values(), ids=SIGHT)
@pytest.mark.parametrize("colors", [KIND_COLORS.values(), CLUSTER_COLORS], ids=["kinds", "clusters"])
def test_colors_can_be_told_apart(colors, sight):
    for a, b in combinations(colors, 2):
        assert np.linalg.norm(lab(a, np.array(sight)) - lab(b, np.array(sight))) > 15, (a, b)


@pytest.mark.parametrize(
    ("colors", "least"),
    [(KIND_COLORS.values(), 3.0), (KIND_INKS.values(), 4.5)],
    ids=["areas and lines", "letters"],
)
def test_kinds_stand_out_from_white(colors, least):
    """The least contrasts of WCAG 2.1, 1.4.11 and 1.4.3."""
    for color in colors:
        assert 1.05 / (RGB_TO_XYZ[1] @ linear(color) + 0.05) >= least


def test_each_kind_has_its_own_color_and_sign():
    assert set(KIND_COLORS) == set(KIND_MARKERS) == set(KINDS)
    assert len(set(KIND_COLORS.values())) == len(set(KIND_MARKERS.values())) == len(KINDS)


def test_each_cluster_has_its_own_color_and_sign():
    pairs = zip(CLUSTER_COLORS * 6, CLUSTER_MARKERS * 7, strict=True)
    assert len(set(pairs)) == 42
    assert not set(CLUSTER_MARKERS) & set(KIND_MARKERS.values())


# --- what is drawn ------------------------------------------------------------------------------------------


def test_world_shows_each_shape_in_its_kinds_color_with_its_sign_and_name(ax):
    plot_world(FOUR_KINDS, ax)
    board, *areas = ax.patches
    assert board.get_width() == FOUR_KINDS.size
    assert [to_hex(area.get_edgecolor()) for area in areas] == [KIND_COLORS[kind].lower() for kind in PRIMITIVES]
    assert [line.get_marker() for line in ax.lines[: len(PRIMITIVES)]] == [KIND_MARKERS[kind] for kind in PRIMITIVES]
    assert [text.get_text() for text in shown_labels(ax)] == list(PRIMITIVES)


def beams_of(ax):
    missed, hit = (c.get_segments() for c in ax.collections if isinstance(c, LineCollection))
    return np.array(missed), np.array(hit)


def test_scan_draws_hits_to_the_hit_and_misses_to_the_limit(ax):
    lidar = Lidar(beams=40, range_max=0.25)
    scans = scan(DISC, [(0.0, 0.0, 0.3)], lidar)
    missed, hit = beams_of(plot_scan(DISC, scans, ax=ax, lidar=lidar))
    assert len(hit) == scans.hits.sum()
    assert len(missed) + len(hit) == 40
    np.testing.assert_allclose(hit[:, 1], scans.points())
    np.testing.assert_allclose(np.hypot(*(missed[:, 1] - missed[:, 0]).T), 0.25)


def test_scan_stops_beams_at_what_is_too_near_to_be_measured(ax):
    world = World([square(0.01, -0.5, 0.2)])
    scans = scan(world, [(0.0, -0.4, 0.0)])
    missed, _ = beams_of(plot_scan(world, scans, ax=ax))
    assert not scans.hits[0, 0]
    np.testing.assert_allclose(missed[0, 1], (0.01, -0.4))


def test_scan_shows_robot_and_range(ax):
    plot_scan(DISC, scan(DISC, [(0, 0, 0), (-0.2, 0.1, np.pi / 2)]), 1, ax)
    near, far, robot = ax.patches[-3:]
    assert [ring.radius for ring in (near, far, robot)] == [0.05, 0.3, 0.037]
    assert robot.center == (-0.2, 0.1)
    np.testing.assert_allclose(ax.lines[-1].get_xydata(), [(-0.2, 0.1), (-0.2, 0.137)])
    assert [text.get_text() for text in ax.get_legend().get_texts()] == [
        "hit",
        "no hit",
        "range 0.05 to 0.3 m",
        "robot",
    ]


def test_scan_of_any_sensor_can_be_drawn(ax):
    """A recorded scan may have its first and its last beam on the same bearing."""
    angles = np.linspace(-np.pi, np.pi, 5)
    scans = Scans(np.zeros((1, 3)), angles, np.full((1, 5), np.inf), np.zeros(1, dtype=bool))
    assert title(plot_scan(DISC, scans, ax=ax)) == "Scan 0: 0 of 5 beams hit"


def test_points_are_all_drawn(ax):
    points = steps(FOUR_KINDS)[2]
    np.testing.assert_array_equal(plot_points(points, ax).lines[0].get_xydata(), points)


def test_clusters_are_drawn_with_color_sign_and_number_and_strays_as_crosses(ax):
    plot_clusters(STRAY, [0] * 20 + [1] * 20 + [-1], ax)
    strays, *clusters = ax.lines
    assert (strays.get_marker(), strays.get_xydata().tolist()) == ("x", [[0.4, 0.4]])
    assert [line.get_marker() for line in clusters] == ["o", "D", "o", "v"]
    assert [line.get_color() for line in clusters[::2]] == list(CLUSTER_COLORS[:2])
    assert [text.get_text() for text in ax.texts] == ["0", "1"]


def test_number_of_a_small_cluster_stands_beside_it(ax):
    plot_clusters([(0.1, 0.1)], [0], ax)
    ax.figure.canvas.draw()
    assert not box_of(ax.texts[0]).contains(shapely.Point(0.1, 0.1))


def test_unseen_stretches_are_dashed(ax):
    """The solid share of each outline is the share that was seen."""
    side = square(-0.1, -0.1, 0.2)
    points = side.outline(400)
    points = points[points[:, 1] < -0.02]  # the lower half of the square
    half = replace(find_shapes(Circle((0.3, 0.3), 0.06).outline(200)[:120], rng=0)[0], choice=None)
    seen = Detection(side, points, 0.0, seen=(1.0, 0.46, 0.0, 0.46))
    plot_found([seen, half], ax=ax)
    dashed = [line for line in ax.lines if line.is_dashed()]
    solid = [line for line in ax.lines if line.get_linestyle() == "-" and len(line.get_xdata()) > 200]
    assert len(dashed) == len(solid) == 2
    for line, item in zip(solid, (seen, half), strict=True):
        assert np.isfinite(line.get_xdata()).mean() == pytest.approx(np.mean(item.seen), abs=0.02)


def legend_of(ax):
    return [text.get_text() for text in ax.get_legend().get_texts()]


ELLIPSE = Polygon(CURVED["ellipse 2"]).moved((0.25, 0.2), 0.4)
ROOM = World([Circle((-0.25, 0.2), 0.08), square(-0.3, -0.3, 0.15), ELLIPSE], walls=True)


@cache
def found_in_the_room():
    return find_shapes(seen_on(ROOM, spurious=0.01), rng=0)


def test_a_shape_that_is_not_certain_is_dotted_and_has_a_question_mark(ax):
    ring = find_shapes(Circle((0.3, 0.3), 0.06).outline(200)[:120], rng=0)
    assert [one.certain for one in ring] == [False]
    plot_found(ring, ax=ax)
    dashed, dotted = [line for line in ax.lines if line.is_dashed()]
    assert np.isfinite(dotted.get_xdata()).mean() == pytest.approx(ring[0].seen[0], abs=0.02)
    assert np.isfinite(dashed.get_xdata()).mean() == pytest.approx(1 - ring[0].seen[0], abs=0.02)
    assert [line.get_marker() for line in ax.lines if len(line.get_xdata()) == 1] == ["$?$"]
    assert [text.get_text() for text in shown_labels(ax)] == ["circle?"]
    report = evaluate(ring, World([Circle((0.3, 0.3), 0.06)]))
    ax.clear()
    plot_found(ring, None, ax, report)
    assert shown_labels(ax)[0].get_text().startswith("circle?\ncentre")


def test_walls_things_and_strays_are_drawn(ax):
    found = found_in_the_room()
    plot_found(found, ROOM, ax)
    drawn = [line.get_xydata() for line in ax.lines]
    for wall in found.walls:
        assert any(np.array_equal(line, np.array([wall.start, wall.end])) for line in drawn)
    (strays,) = [line for line in drawn if np.array_equal(line, found.strays)]
    assert len(strays) > 10
    (thing,) = [line for line in ax.lines if to_hex(line.get_color()) == GREY.lower() and line.is_dashed()]
    np.testing.assert_array_equal(thing.get_xydata()[:-1], found.others[0].outline)
    assert "of no kind" in [text.get_text() for text in shown_labels(ax)]
    assert f"stray: {len(strays)} points" in told(ax.figure)
    n = len(found.strays)
    assert title(ax) == f"2 shapes found; 4 walls, 1 thing of no kind, {n} strays"


def test_a_wall_has_a_ring_where_its_end_was_seen(ax):
    ends = np.array([(-0.2, 0.0), (0.3, 0.1)])
    for seen in ((True, False), (False, False), (False, True)):
        ax.clear()
        plot_found(Found(walls=[Wall(*ends, ends, 0.0, seen)]), ax=ax)
        rings = [line.get_xydata() for line in ax.lines if line.get_marker() == "o" and line.get_linestyle() == "None"]
        np.testing.assert_array_equal(np.vstack(rings), ends[np.array(seen)])


def test_what_was_seen_of_no_kind_is_no_mere_miss(ax):
    found = found_in_the_room()
    plot_found(found, ROOM, ax, evaluate(found, ROOM))
    texts = [text.get_text() for text in shown_labels(ax)]
    assert texts[-1] == "polygon:\nfound of no kind"
    assert "of no kind" not in texts
    assert title(ax).startswith("2 of 3 shapes right, 1 missed; 4 walls, 1 thing of no kind, ")


def test_the_legend_shows_only_what_there_is(ax):
    half = replace(find_shapes(Circle((0.3, 0.3), 0.06).outline(200)[:120], rng=0)[0], choice=None)
    found = found_in_the_room()
    cases = [
        (([],), []),
        ((FOUR_KINDS.shapes,), ["found"]),
        ((FOUR_KINDS.shapes, FOUR_KINDS), ["found", "truth"]),
        (([half],), ["found", "found, no point near"]),
        ((Found(walls=found.walls),), ["wall"]),
        ((Found(strays=found.strays), ROOM), ["stray", "truth"]),
        ((found, ROOM), ["found", "wall", "stray", "truth"]),
    ]
    for shown, words in cases:
        ax.clear()
        plot_found(*shown, ax=ax)
        assert legend_of(ax) == words


def test_a_full_legend_is_no_wider_than_the_board(ax):
    found = found_in_the_room()
    half = replace(find_shapes(Circle((0.3, 0.3), 0.06).outline(200)[:120], rng=0)[0], choice=None)
    plot_found(Found([*found, half], found.walls, found.others, found.strays), ROOM, ax)
    ax.figure.canvas.draw()
    assert len(legend_of(ax)) == 5
    assert ax.get_legend().get_window_extent().width <= ax.get_window_extent().width


def test_without_a_world_all_that_was_found_is_in_the_picture(ax):
    far = np.array([(-3.0, 0.0), (0.0, 2.5)])
    plot_found(Found(walls=[Wall(*far, far, 0.0)], strays=np.array([(1.7, -2.0)])), ax=ax)
    assert ax.get_xlim()[0] < -3 < 1.7 < ax.get_xlim()[1]
    assert ax.get_ylim()[0] < -2 < 2.5 < ax.get_ylim()[1]


@pytest.mark.parametrize(("k", "unit"), [(10, "m"), (0.1, "cm"), (0.01, "mm")])
def test_a_board_of_another_size_has_its_own_units(k, unit, ax):
    """Ticks are round in m, cm or mm; errors have a tenth of a cell; seen is what lies within 12 cells."""
    world, grid = board(3, 0.0, k)
    found = find_shapes(grid, rng=0)
    plot_found(found, world, ax, evaluate(found, world))
    ax.figure.canvas.draw()
    assert (ax.get_xlabel(), ax.get_ylabel()) == (f"x [{unit}]", f"y [{unit}]")
    assert f"x [{unit}] from -5.3 to 5.3; y" in told(ax.figure).replace("\u2212", "-")
    assert {-5, 0, 5} < {float(tick.get_text().replace("\u2212", "-")) for tick in ax.get_xticklabels()}
    assert ax.get_xlim()[1] == pytest.approx(world.size * 0.53)
    assert legend_of(ax) == ["found", "truth"]  # all of every outline was seen
    assert not any(line.is_dashed() and np.isnan(line.get_xdata()).any() for line in ax.lines)
    assert re.fullmatch(r"4 shapes found, all within [\d.]+ mm", title(ax))
    assert float(title(ax).split()[-2]) <= 2 * k
    plot_found(found, ax=plt.figure().add_subplot())
    assert plt.gca().get_xlim()[1] == pytest.approx(world.size * 0.53)


def test_ghosts_are_four_cells_off_every_outline_and_wall(ax):
    after = World([Circle((0, 0), 0.1)], walls=True)
    points = [(0.1039, 0.0), (0.1041, 0.0), (0.4961, 0.2), (0.4959, 0.2), (0.3, 0.3)]
    cases = [
        (DISC, points, {}, [1, 3, 4], ["where it was", "point", "ghost"]),
        (DISC, points, {"resolution": 0.002}, [4], ["where it was", "point", "ghost"]),
        (after, points[:1], {}, [], ["point"]),
        (after, points[-1:], {}, [0], ["ghost"]),
    ]
    for before, those, more, ghosts, words in cases:
        ax.clear()
        plot_change(before, after, those, ax, **more)
        (crosses,) = [line.get_xydata() for line in ax.lines if line.get_marker() == "x"]
        np.testing.assert_array_equal(crosses, np.reshape([those[k] for k in ghosts], (-1, 2)))
        assert legend_of(ax) == words
    ax.clear()
    assert title(plot_change(DISC, World(), STRAY[:2], ax)) == "2 of 2 points are ghosts"


def test_plain_shapes_have_no_dashes(ax):
    plot_found(FOUR_KINDS.shapes, ax=ax)
    assert not any(line.is_dashed() for line in ax.lines)


def test_missed_shapes_are_hatched(ax):
    found = [FOUR_KINDS.shapes[0]]
    plot_found(found, FOUR_KINDS, ax, evaluate(found, FOUR_KINDS))
    assert [bool(area.get_hatch()) for area in ax.patches[1:]] == [False] * 4 + [True] * 3


TRUTH = World([square(-0.1, -0.1, 0.2)])
LABELS = {
    "right": ([square(-0.1, -0.1, 0.2)], ["rectangle\ncentre < 0.1 mm\nsides < 0.1 mm"]),
    "shifted": ([square(-0.099, -0.1, 0.2)], ["rectangle\ncentre 1.0 mm\nsides < 0.1 mm"]),
    "too far off": ([square(-0.093, -0.1, 0.2)], ["rectangle\ncentre 7.0 mm: wrong\nsides < 0.1 mm"]),
    "too large": ([square(-0.104, -0.104, 0.208)], ["rectangle\ncentre < 0.1 mm\nsides 8.0 mm: wrong"]),
    "other kind": ([Circle((0, 0), 0.1)], ["circle: wrong,\nit is a rectangle\ncentre < 0.1 mm"]),
    "missed": ([], ["rectangle:\nmissed"]),
    "elsewhere": ([Circle((0.3, 0.3), 0.1)], ["circle:\nfalse alarm", "rectangle:\nmissed"]),
}


@pytest.mark.parametrize(("shapes", "texts"), LABELS.values(), ids=LABELS)
def test_labels_state_the_errors(shapes, texts, ax):
    plot_found(shapes, TRUTH, ax, evaluate(shapes, TRUTH))
    assert [text.get_text() for text in shown_labels(ax)] == texts


@pytest.mark.parametrize(
    ("shapes", "protocol", "finding"),
    [
        ([square(-0.0992, -0.1, 0.2)], "fair", "1 shape found, within 0.8 mm"),
        ([square(-0.0992, -0.1, 0.2)], "paper", "1 shape found, right as published"),
        ([square(-0.09, -0.1, 0.2)], "fair", "0 of 1 shape right"),
        ([*TRUTH.shapes, *TRUTH.shapes], "fair", "1 of 1 shape right, 1 false alarm"),
    ],
)
def test_verdict(shapes, protocol, finding, ax):
    assert title(plot_found(shapes, TRUTH, ax, evaluate(shapes, TRUTH, protocol=protocol))) == finding


def test_errors_are_rounded_up_in_the_title(ax):
    shapes = [square(-0.09981, -0.1, 0.2)]
    assert title(plot_found(shapes, TRUTH, ax, evaluate(shapes, TRUTH))) == "1 shape found, within 0.2 mm"


# --- labels -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(30))
def test_labels_lie_on_nothing_and_stay_on_the_board(seed, ax):
    world = random_world(1 + seed % 8, style="free", gap=0.03, rng=seed)
    plot_found(world.shapes, world, ax, evaluate(world.shapes, world))
    boxes = [box_of(text) for text in shown_labels(ax)]
    outlines = shapely.union_all([shape.to_shapely().exterior for shape in world.shapes])
    assert len(boxes) == len(world.shapes)
    assert not any(a.intersects(b) for a, b in combinations(boxes, 2))
    assert not any(box.intersects(outlines) for box in boxes)
    assert all(shapely.box(-0.5, -0.5, 0.5, 0.5).contains(box) for box in boxes)


@pytest.mark.parametrize("name", ["crowded world", "crowd found", "absurdly large", "world over the edge"])
def test_labels_without_room_are_left_out(name, ax):
    PLOTS[name](ax)
    boxes = [box_of(text) for text in shown_labels(ax)]
    assert boxes
    assert not any(a.intersects(b) for a, b in combinations(boxes, 2))
    assert all(ax.viewLim.x0 < box.bounds[0] and box.bounds[2] < ax.viewLim.x1 for box in boxes)


def test_labels_follow_the_size_of_the_axes(ax):
    """In a figure with several plots, the layout of the first changes when the others come."""
    PLOTS["found"](ax)
    large = [text.get_fontsize() for text in shown_labels(ax)]
    ax.figure.set_size_inches(3.2, 3.2)
    boxes = [box_of(text) for text in shown_labels(ax)]
    assert ax.texts[0].get_fontsize() < large[0]
    assert len(boxes) == 4
    assert not any(a.intersects(b) for a, b in combinations(boxes, 2))


@pytest.mark.filterwarnings("ignore::primkit.arguments.LikelyWrong")
def test_a_far_label_is_tied_to_its_shape(ax):
    ring = [Circle((0.1 * np.cos(t), 0.1 * np.sin(t)), 0.05) for t in np.arange(8) * np.pi / 4]
    plot_world(World([Circle((0, 0), 0.02), *ring]), ax)
    shown_labels(ax)
    assert any(line.get_visible() and len(line.get_xdata()) == 2 for line in ax.lines)


def test_narrow_axes_have_neither_labels_nor_legend(ax):
    ax.figure.set_size_inches(1.5, 1.5)
    PLOTS["found"](ax)
    assert shown_labels(ax) == []
    assert not ax.get_legend().get_visible()


def test_letters_shrink_when_labels_find_no_room(ax):
    shapes = [Circle((x, y), 0.05) for x in np.linspace(-0.4, 0.4, 4) for y in np.linspace(-0.4, 0.4, 4)]
    world = World(shapes)
    plot_found(shapes, world, ax, evaluate(shapes, world))
    assert {text.get_fontsize() for text in shown_labels(ax)} < set(labels.LABEL_SIZES[1:])


# --- the story and its file ---------------------------------------------------------------------------------


def test_story_has_all_steps_and_leaves_no_figure_open():
    figure = plot_story(*steps(FOUR_KINDS))
    titles = sorted(title(ax) for ax in figure.axes)
    assert titles[:3] == ["a) One scan", f"b) {len(steps(FOUR_KINDS)[2])} points", "c) 4 clusters"]
    assert titles[3].startswith("d) 4 shapes found, all within 0.")
    assert titles[4].startswith("e) Farthest off: 0.")
    assert figure.get_supxlabel().replace("\n", " ") == steps(FOUR_KINDS)[5].scores()
    assert plt.get_fignums() == []


def test_the_loupe_is_on_the_place_that_is_farthest_off():
    """Two discs, one of which was found 3 mm too far to the right: there the loupe looks, and the board says where."""
    true = World([Circle((-0.2, 0), 0.1), Circle((0.2, 0), 0.05)])
    found = [Circle((-0.2, 0.001), 0.1), Circle((0.203, 0), 0.05)]
    points = np.array([(0.25, 0.0), (0.153, 0.0), (-0.3, 0.0)])
    figure = plot_story(true, scan(true, []), points, [0, 0, 1], found, evaluate(found, true))
    loupe = next(ax for ax in figure.axes if title(ax) == "e) Farthest off: 3.0 mm")
    (left, right), (low, high) = loupe.get_xlim(), loupe.get_ylim()
    assert min(abs((left + right) / 2 - 0.2 - side) for side in (-0.05, 0.05)) < 1e-9
    assert right - left == pytest.approx(high - low) == pytest.approx(0.02)
    assert sum(isinstance(one, Rectangle) for one in loupe.patches) == 1  # the cell that is near
    board = next(ax for ax in figure.axes if title(ax).startswith("d)"))
    assert [one.get_xy() for one in board.patches if isinstance(one, Rectangle)][-1] == (left, low)


def test_story_of_nothing():
    empty = World()
    figure = plot_story(empty, scan(empty, []), [], [], [], evaluate([], empty))
    assert figure._repr_png_()


def test_same_input_same_bytes_whatever_the_settings():
    before = plot_story(*steps(FOUR_KINDS))._repr_png_()
    with matplotlib.rc_context(
        {"font.size": 20, "savefig.bbox": "tight", "axes.facecolor": "red", "lines.marker": "x"}
    ):
        after = plot_story(*steps(FOUR_KINDS))._repr_png_()
    assert before == after
    assert before.startswith(b"\x89PNG")
    assert b"Software" not in before


def test_save_figure_writes_what_the_figure_shows(tmp_path):
    figure = plot_story(*steps(FOUR_KINDS))
    save_figure(figure, tmp_path / "story.PNG")
    assert (tmp_path / "story.PNG").read_bytes() == figure._repr_png_()
    assert [path.name for path in tmp_path.iterdir()] == ["story.PNG"]


def test_a_figure_can_be_pickled(ax):
    PLOTS["found"](ax)
    copy = pickle.loads(pickle.dumps(ax.figure))
    FigureCanvasAgg(copy).draw()
    assert len(copy.axes[0].texts) == 4


def make_pictures(folder):
    """Make the README's pictures anew: python -c "from tests.test_plots import *; make_pictures(PICTURES)"."""
    save_figure(plot_story(*steps(random_world(4, rng=7))), folder / "story.png")
    world, *_, found, report = steps(random_world(6, style="free", rng=FREE_SEED))
    ax = Figure(figsize=look.FIGURE_SIZE, layout="constrained").add_subplot()
    save_figure(plot_found(found, world, ax, report).figure, folder / "free.png")


FREE_SEED = 9  # all four kinds, and sides that no way-point sees


@pytest.mark.skipif(not matplotlib.__version__.startswith("3.11."), reason="letters differ: labels find other places")
def test_pictures_in_the_readme_are_what_primkit_draws(tmp_path):
    make_pictures(tmp_path)
    for fresh in tmp_path.iterdir():
        kept = PICTURES / fresh.name
        assert kept.stat().st_size <= 250_000
        # A label may find another place where rounding differs; another world, or another look, differs by more.
        assert np.abs(imread(kept)[..., :3] - imread(fresh)[..., :3]).mean() < 0.03


# --- wrong arguments ----------------------------------------------------------------------------------------

ONE_SCAN = scan(DISC, [(0, 0, 0)])
WRONG = {
    "no such scan": (
        lambda: plot_scan(DISC, ONE_SCAN, 1),
        "index must be below the number of scans, got 1 for 1",
    ),
    "no scan at all": (
        lambda: plot_scan(DISC, scan(DISC, [])),
        "index must be below the number of scans, got 0 for 0",
    ),
    "negative index": (
        lambda: plot_scan(DISC, ONE_SCAN, -1),
        "index must be a whole number >= 0, got -1",
    ),
    "ranges for scans": (
        lambda: plot_scan(DISC, ONE_SCAN.ranges),
        "scans must be of type Scans, got ndarray",
    ),
    "lidar": (lambda: plot_scan(DISC, ONE_SCAN, lidar=0.3), "lidar must be of type Lidar, got float"),
    "shapes for a world": (
        lambda: plot_world(DISC.shapes),
        "world must be of type World, got tuple",
    ),
    "several axes": (
        lambda: plot_world(DISC, np.empty(2, dtype=object)),
        "ax must be of type Axes, got ndarray",
    ),
    "points": (
        lambda: plot_points([1, 2, 3]),
        "points must have shape (N, 2), got shape (3,)",
    ),
    "size": (lambda: plot_points([], size=0), "size must be a finite number > 0, got 0"),
    "labels too few": (
        lambda: plot_clusters([(0, 0), (1, 1)], [0]),
        "labels must be a whole number for each of the 2 points, got int64 of shape (1,)",
    ),
    "labels not whole": (
        lambda: plot_clusters([(0, 0)], [0.5]),
        "labels must be a whole number for each of the 1 points, got float64 of shape (1,)",
    ),
    "axes for a world": (
        lambda: plot_found([], Figure().add_subplot()),
        "world must be of type World, got Axes",
    ),
    "points for shapes": (
        lambda: plot_found([(0, 0)]),
        "what was found must be detections or shapes, got tuple",
    ),
    "a world for a report": (
        lambda: plot_found([], report=DISC),
        "report must be of type Report, got World",
    ),
    "another report": (
        lambda: plot_found([], DISC, report=evaluate(DISC.shapes, DISC)),
        "report must be about the shapes found, got one about others",
    ),
    "no report": (
        lambda: plot_story(DISC, ONE_SCAN, [], [], [], None),
        "report must be of type Report, got NoneType",
    ),
    "ending": (
        lambda: save_figure(Figure(), "story.pdf"),
        "story.pdf: the name of a picture must end in .png, got .pdf",
    ),
    "no ending": (
        lambda: save_figure(Figure(), "story"),
        "story: the name of a picture must end in .png, got no ending",
    ),
}


@pytest.mark.parametrize(("call", "sentence"), WRONG.values(), ids=WRONG)
def test_wrong_arguments_are_refused_in_one_sentence(call, sentence):
    with pytest.raises(ValueError, match=exactly(sentence)):
        call()
    assert plt.get_fignums() == []
