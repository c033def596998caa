"""Composites: what a world sees of them, how they are taken apart, and what is said to be open."""

import subprocess
import sys
from collections.abc import Callable

import numpy as np
import pytest
import shapely

import primkit as pk
from primkit.measure import Frame
from primkit.parts import Apart, Composite
from primkit.parts.apart import with_what_is_open
from primkit.parts.families import Part
from primkit.parts.fitting import Sample, deepened, fitted, outside_union
from primkit.parts.openness import kinds_as_shown, open_sizes
from primkit.parts.pieces import pieces_of, room_in
from primkit.parts.proposals import Stretch, laid, runs
from primkit.parts.search import Explanation, explained, improved

BOX = pk.Polygon([(-0.1, -0.05), (0.1, -0.05), (0.1, 0.05), (-0.1, 0.05)])
PENTAGON = pk.Polygon(0.07 * np.column_stack([np.cos(t := np.arange(5) * 0.4 * np.pi), np.sin(t)]))
COMPOSITES = {
    "stadium": (Composite([BOX, pk.Circle((0.1, 0.0), 0.05)]), "touch"),
    "L": (Composite([BOX, pk.Polygon([(-0.1, 0.05), (-0.04, 0.05), (-0.04, 0.2), (-0.1, 0.2)])]), "touch"),
    "house": (Composite([BOX, pk.Polygon([(-0.1, 0.05), (0.1, 0.05), (0, 0.13)])]), "touch"),  # of 90 degrees: a box?
    "box in a pentagon": (Composite([BOX.moved((0.1, 0), 0.2), PENTAGON]), "overlap"),
    "two circles": (Composite([pk.Circle((0, 0), 0.06), pk.Circle((0.08, 0), 0.05)]), "overlap"),
}


def seen(composite: Composite, noise_std: float = 0.0, seed: int = 0) -> np.ndarray:
    """Return the points of a board on which the composite stands alone."""
    world, grid = pk.World([composite.union]), pk.Grid()
    grid.add(pk.scan(world, pk.teleport_poses(world), pk.Lidar(noise_std=noise_std), rng=seed))
    return grid.points()


@pytest.fixture(scope="module")
def apart() -> dict[str, Apart | None]:
    return {name: pk.take_apart(seen(composite, 0.001)) for name, (composite, _) in COMPOSITES.items()}


@pytest.mark.parametrize("name", COMPOSITES)
def test_a_composite_is_taken_apart(name: str, apart: dict[str, Apart | None]) -> None:
    composite, found = COMPOSITES[name][0], apart[name]
    assert found is not None
    assert tuple(sorted(part.kind for part in found.parts)) == composite.kinds
    union, truth = shapely.union_all([part.to_shapely() for part in found.parts]), composite.union.to_shapely()
    assert union.intersection(truth).area / union.union(truth).area > 0.98


@pytest.mark.parametrize(("words", "loaded"), [("import primkit", False), ("import primkit; primkit.take_apart", True)])
def test_the_wing_is_loaded_when_it_is_asked_for(words: str, loaded: bool) -> None:
    code = f"import sys; {words}; print(any(name.startswith('primkit.parts') for name in sys.modules))"
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert told.strip() == str(loaded)


def test_how_parts_meet_is_told(apart: dict[str, Apart | None]) -> None:
    assert [found.joints[0][2] for name in ("house", "two circles") if (found := apart[name])] == ["touch", "overlap"]


def test_a_world_sees_the_union_and_nothing_inside() -> None:
    composite = Composite([BOX, pk.Circle((0.1, 0.0), 0.05)])
    points = seen(composite)
    assert np.abs(composite.union.signed_distance(points)).max() < 0.0015
    assert min(part.signed_distance(points).min() for part in composite.parts) > -0.0015


@pytest.mark.parametrize(
    ("parts", "message"),
    [
        ([BOX, "circle"], "a composite's parts must be Circle or Polygon, got str"),
        (3, "a composite's parts must be a list of shapes, got 3"),
        ([BOX, pk.Circle((0.4, 0), 0.05)], "hang together without a hole, got 2 pieces and 0 holes"),
    ],
    ids=["a text", "a number", "apart"],
)
def test_what_is_no_composite_is_refused(parts: object, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Composite(parts)  # type: ignore[arg-type]


def test_bad_arguments_are_refused() -> None:
    ring = BOX.outline(100)
    with pytest.raises(ValueError, match='style must be "paper" or "free", got \'any\''):
        pk.take_apart(ring, style="any")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="colors must be one for each of the 100 points, got shape"):
        pk.take_apart(ring, colors=[1, 2])


@pytest.mark.parametrize("points", [BOX.outline(20), BOX.outline(200)[:90]], ids=["few", "open"])
def test_what_does_not_close_is_not_taken_apart(points: np.ndarray) -> None:
    assert pk.take_apart(points) is None


def test_a_hidden_side_is_open_and_a_seen_one_is_not() -> None:
    tall = Part("rectangle", np.array([0.0, 0.0, 0.0, 0.1, 0.3]))
    inside = Part("rectangle", np.array([0.1, -0.1, 0.0, 0.2, 0.1]))
    flush = Part("rectangle", np.array([0.151, -0.1, 0.0, 0.202, 0.1]))
    assert open_sizes([tall, inside], 1).tolist() == [True, False]
    assert open_sizes([tall, flush], 1).tolist() == [True, False]
    assert open_sizes([tall, flush], 0).tolist() == [False, False]
    assert open_sizes([tall], 0).tolist() == [False, False]


def test_a_size_is_open_that_explains_the_points_as_well() -> None:
    box, longer = ([Part("rectangle", np.array([0.0, 0.0, 0.0, length, 0.1]))] for length in (0.2, 0.21))
    ring = BOX.outline(100)
    for more, is_open in ((3.0, True), (30.0, False)):
        ranked = [Explanation(box, 100.0), Explanation(longer, 100.0 + more)]
        assert with_what_is_open(ranked, Sample(ring, 0.0004), Frame.of(ring, 0.001)).open_sizes == ((is_open, False),)


def test_a_short_arc_leaves_its_radius_open() -> None:
    box = Part("rectangle", np.array([0.0, -0.05, 0.0, 0.3, 0.2]))
    arcs = [Part("circle", np.array([0.0, 0.05 + up, 0.06])) for up in (0.0, -0.048)]
    assert [open_sizes([box, arc], 1).tolist() for arc in arcs] == [[False], [True]]


def test_a_hidden_stretch_may_hide_a_corner() -> None:
    box, stub = np.array([0.0, 0.0, 0.0, 0.2, 0.2]), np.array([0.1, 0.0, 0.0, 0.1, 0.08])
    parts = [Part("rectangle", x, "free") for x in (box, stub)]
    assert ["pentagon" in kinds_as_shown(parts, i) for i in (0, 1)] == [True, True]
    assert not kinds_as_shown(parts[:1], 0)


def test_a_triangle_could_have_two_neighbouring_sides_and_no_more() -> None:
    tall, wide = np.array([0.0, 0.0, 0.0, 0.1, 0.3]), np.array([0.1, 0.1, 0.0, 0.2, 0.11])
    parts = [Part("rectangle", x) for x in (tall, wide)]  # the wide one shows its right end and two long sides
    corner = Part("rectangle", np.array([0.0, 0.12, np.pi / 4, 0.1, 0.1]))  # nothing but a corner
    assert not kinds_as_shown(parts, 1)
    assert kinds_as_shown([Part("circle", np.array([0.0, 0.0, 0.15])), corner], 1) == {"triangle"}


def test_a_triangle_with_two_sides_alike_has_nearly_the_same_numbers_on_another_base() -> None:
    even = Part("triangle", np.array([0.01, 0.02, 0.3, 0.2, 0.2 * np.sqrt(3) / 2]))
    assert len(even.on_other_bases) == 2
    for x in even.on_other_bases:
        off = np.hypot(*(even.with_numbers(x).corners[:, None] - even.corners).transpose(2, 0, 1)).min(axis=1)
        assert off.max() < 1e-9


@pytest.mark.parametrize("style", ["paper", "free"])
@pytest.mark.parametrize(
    ("kind", "x"),
    [
        ("circle", [0.01, 0.02, 0.05]),
        ("rectangle", [0.01, 0.02, 0.3, 0.2, 0.1]),
        ("triangle", [0.01, -0.05, 0.3, 0.2, 0.1]),
        ("pentagon", [0.01, 0.02, 0.3, 0.08]),
    ],
)
def test_derivatives_are_those_of_the_distance(kind: pk.shapes.Kind, x: list[float], style: str) -> None:
    part = Part(kind, np.array(x))
    if style == "free" and kind in ("triangle", "pentagon"):
        part = Part(kind, part.corners.ravel(), "free")
    points = 1.02 * part.shape.outline(37) + 0.001  # off the corners, where the derivative jumps
    slopes = part.distance_slopes(points)
    step = 1e-6
    for k in range(len(part.x)):
        ends = [Part(kind, part.x + s * np.eye(len(part.x))[k], part.style).outside(points) for s in (step, -step)]
        off = np.abs((ends[0] - ends[1]) / (2 * step) - slopes[:, k])
        assert np.quantile(off, 0.9) < 0.02


def test_parts_are_fitted_together() -> None:
    truth = [Part("rectangle", np.array([0.0, 0.0, 0.1, 0.2, 0.1])), Part("circle", np.array([0.0, 0.05, 0.06]))]
    ring = on_union(truth)
    rough = [Part(part.kind, part.x + 0.004) for part in truth]
    found = fitted(rough, Sample(ring, 0.0004))
    assert all(np.allclose(a.x, b.x, atol=1e-4) for a, b in zip(found, truth, strict=True))


def test_each_part_is_laid_around_a_stretch_of_the_outline() -> None:
    composite = COMPOSITES["box in a pentagon"][0]
    points = seen(composite)
    pieces = pieces_of(points, 0.0004)
    assert pieces is not None
    sample = Sample(points, 0.0004, room=room_in(pieces, 0.006))
    far = np.full(len(sample.points), 0.0025)
    pool = laid([Stretch(points, far) for points in runs(pieces) if len(points) > 7], sample, "paper")
    for part in composite.parts:
        own = sample.points[np.abs(part.signed_distance(sample.points)) < 0.001]
        off = [np.abs(one.outside(own)).max() for one in pool if one.kind == part.kind]
        assert min(off) < 0.003, part


def test_hidden_sides_are_laid_deep_and_seen_ones_stay() -> None:
    box = Part("rectangle", np.array([0.0, 0.0, 0.0, 0.2, 0.2]))
    short = Part("rectangle", np.array([0.13, 0.0, 0.0, 0.07, 0.1]))  # its left end lies 5 mm inside of the box
    ring = on_union([box, short])
    sample = Sample(ring, 0.0004, beside=box.outside(ring))
    x = deepened(short.with_numbers(short.x[None]), sample).x[0]
    right, left = x[0] + x[3] / 2, x[0] - x[3] / 2
    assert right == pytest.approx(0.165, abs=0.001)
    assert left < 0.06
    assert x[4] == pytest.approx(0.1, abs=0.001)


def on_union(parts: list[Part]) -> np.ndarray:
    """Return places of the outline of the union of two parts."""
    ring = np.concatenate([part.shape.outline(200) for part in parts])
    return ring[np.abs(outside_union(parts, ring)) < 1e-9]


def test_a_fit_leaves_a_local_optimum() -> None:
    """A box flush with a roof was fitted 17 mm too long: its corners stuck out beside the roof."""
    box, roof = np.array([0.0, 0.0, 0.0, 0.2, 0.1]), np.array([0.1, 0.0, -np.pi / 2, 0.12, 0.08])
    truth = [Part("rectangle", box), Part("triangle", roof)]
    sample = Sample(on_union(truth), 0.0006)
    stuck = explained([Part("rectangle", box + np.array([0.01, 0, 0, 0.02, 0])), truth[1]], sample)
    assert stuck.cost > explained(truth, sample).cost + 20
    found = improved(stuck, sample)
    assert found.cost == pytest.approx(explained(truth, sample).cost, abs=2)
    assert found.parts[0].x[3] == pytest.approx(0.2, abs=0.001)


# --- the camera ------------------------------------------------------------------------------------------------------


def test_a_pinhole_sees_edges_where_they_are() -> None:
    """The share of a pixel at an edge tells where in the pixel it lies, on the image plane."""
    box = pk.Polygon([(0.3, -0.02), (0.4, -0.02), (0.4, 0.03), (0.3, 0.03)])
    camera = pk.Camera()
    views = pk.look(pk.World([box]), [(0.0, 0.0, 0.0)], camera, colors=[(1, 0, 0)])
    red = (views.pixels[0, :, 0] - 0.6) / 0.4
    step = 2 * np.tan(camera.field_of_view / 2) / camera.width
    assert red.sum() * step == pytest.approx(0.05 / 0.3, abs=step / 8)


def test_a_camera_turned_to_the_left_sees_all_farther_right() -> None:
    world = pk.World([pk.Circle((0.3, 0.0), 0.03)])
    middle = [
        np.nonzero(pk.look(world, [(0, 0, 0)], pk.Camera(turned=t)).colors()[0][0] == 0)[0].mean()
        for t in (0.0, np.radians(5))
    ]
    assert middle[1] - middle[0] == pytest.approx(5 / 1.08, abs=0.7)


def test_light_does_not_change_hues() -> None:
    world = pk.World([pk.Circle((0.3, 0.06), 0.05), pk.Circle((0.3, -0.06), 0.05)])
    camera = pk.Camera(light=0.3, noise_std=0.03)
    numbers, hues = pk.look(world, [(0, 0, 0)] * 20, camera, colors=[(1, 0, 0), (1, 1, 0)], rng=0).colors()
    assert np.degrees(hues).round(-1).tolist() == [0, 60]
    assert (numbers[:, 18] == 0).all()
    assert (numbers[:, 34] == 1).all()


def test_hits_take_the_colour_of_their_bearing() -> None:
    world = pk.World([pk.Circle((0.2, 0.05), 0.05), pk.Circle((0.2, -0.05), 0.05)])
    poses = [(0, 0, 0), (0, 0.02, 0.1), (0.4, 0, np.pi)]
    scans = pk.scan(world, poses)
    numbers = pk.colors_of(scans, pk.look(world, poses, colors=[(1, 0, 0), (0, 0, 1)]))
    of_shapes = np.argmin([np.abs(shape.signed_distance(scans.points())) for shape in world.shapes], axis=0)
    known = numbers >= 0
    assert known.mean() > 0.7
    assert (numbers[known] == of_shapes[known]).mean() > 0.9  # a hit at an edge may fall into the pixel beside
    with pytest.raises(ValueError, match="scans and views must be from the same poses, got 3 and 1"):
        pk.colors_of(scans, pk.look(world, poses[:1]))


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: pk.Camera(width=0), "width must be"),
        (lambda: pk.Camera(field_of_view=4), "field_of_view must be below pi radians, got 4"),
        (lambda: pk.look(pk.World(), [(0, 0, 0)], colors=[(1, 0, 0)]), "colors must be 0 rows of red, green and blue"),
        (lambda: pk.look("world", [(0, 0, 0)]), "world must be a World"),  # type: ignore[arg-type]
    ],
    ids=["no pixel", "too wide", "colours", "world"],
)
def test_bad_cameras_are_refused(make: Callable[[], object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        make()


def test_a_camera_parts_what_a_lidar_calls_one() -> None:
    left, right = BOX.moved((-0.1, 0)), BOX.moved((0.1, 0))
    world = pk.World([left, right])
    places = [(x, y) for x in (-0.35, -0.1, 0.1, 0.35) for y in (-0.2, 0.0, 0.2) if y or abs(x) > 0.3]
    poses = np.array([(x, y, np.arctan2(-y, -x)) for x, y in places])
    scans = pk.scan(world, poses, pk.Lidar(range_max=0.5), rng=0)
    colors = pk.colors_of(scans, pk.look(world, poses, pk.Camera(light=0.3, noise_std=0.03), rng=0))
    alone, both = (pk.take_apart(scans.points(), colors=c) for c in (None, colors))
    assert alone is not None
    assert both is not None
    assert [part.kind for part in alone.parts] == ["rectangle"]
    assert [part.kind for part in both.parts] == ["rectangle"] * 2
    assert np.allclose([part.dimensions for part in both.parts], [(0.2, 0.1)] * 2, atol=0.015)
    assert both.open_sizes == ((True, False), (True, False))  # where one ends inside the other, no sensor sees
