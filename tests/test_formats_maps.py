"""Maps and results to GeoJSON and back: equal to the last bit, refused in one sentence with the feature's number."""

import json
import sys

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from primkit.arguments import FARTHEST
from primkit.formats import load_world, save_world
from primkit.shapes import Circle, Polygon
from primkit.world import World, random_world
from tests.filing import TRIANGLE, answer, bits, refusal, written

RING = [[0, 0], [1, 0], [0, 1], [0, 0]]


def says_polygon(ring):
    """What Polygon itself says of these corners, in its own words, under the name of the file."""
    return "map.geojson, feature 1: " + refusal(Polygon, ring)


def feature(geometry, properties=None):
    return {"type": "Feature", "properties": properties, "geometry": geometry}


def collection(*features, **members):
    return {"type": "FeatureCollection", "features": list(features), **members}


def point(*position, **properties):
    return feature({"type": "Point", "coordinates": list(position)}, properties)


def polygon(*rings):
    return feature({"type": "Polygon", "coordinates": list(rings)})


# --- maps there and back ------------------------------------------------------------------------------------


@pytest.mark.parametrize("style", ["paper", "free", "any"])
@settings(max_examples=40, deadline=None)
@given(n=st.integers(0, 4), size=st.floats(1.0, 3.0), walls=st.booleans(), seed=st.integers(0, 2**32))
def test_random_worlds_come_back_to_the_last_bit(tmp_path_factory, style, n, size, walls, seed):
    path = tmp_path_factory.mktemp("maps") / "map.geojson"
    world = random_world(n, style=style, gap=0.01, size=size, walls=walls, rng=seed)
    save_world(world, path)
    assert bits(load_world(path)) == bits(world)


@pytest.mark.filterwarnings("ignore::primkit.arguments.LikelyWrong")
@given(
    x=st.floats(-FARTHEST, FARTHEST),
    y=st.floats(-FARTHEST, FARTHEST),
    radius=st.floats(0, FARTHEST, exclude_min=True),
    size=st.floats(0, FARTHEST, exclude_min=True),
)
@settings(max_examples=40, deadline=None)
def test_every_float_comes_back_to_the_last_bit(tmp_path_factory, x, y, radius, size):
    path = tmp_path_factory.mktemp("maps") / "map.geojson"
    world = World([Circle((x, y), radius)], size)
    save_world(world, path)
    assert bits(load_world(path)) == bits(world)


def test_the_first_corner_stays_first(tmp_path):
    for start in range(4):
        square = Polygon(np.roll([(0, 0), (0.1, 0), (0.1, 0.1), (0, 0.1)], start, axis=0))
        save_world(World([square]), tmp_path / "map.geojson")
        assert bits(load_world(tmp_path / "map.geojson")) == bits(World([square]))


def test_the_file_reads_like_this_byte_for_byte(tmp_path):
    world = World([Circle((0.1, -0.2), 0.05), TRIANGLE], size=2)
    expected = """{
  "type": "FeatureCollection",
  "size": 2.0,
  "features": [
    {"type": "Feature",
     "properties": {"kind": "circle", "radius": 0.05},
     "geometry": {"type": "Point", "coordinates": [0.1, -0.2]}},
    {"type": "Feature",
     "properties": {"kind": "triangle"},
     "geometry": {"type": "Polygon", "coordinates": [[
       [0.0, 0.0],
       [0.2, 0.0],
       [0.0, 0.1],
       [0.0, 0.0]
     ]]}}
  ]
}
"""
    for name in ("map.geojson", "map.json", "MAP.GeoJSON"):
        save_world(world, tmp_path / name)
        assert (tmp_path / name).read_bytes() == expected.encode()
        assert load_world(str(tmp_path / name)) == world


def test_a_board_without_shapes(tmp_path):
    save_world(World(size=0.5), tmp_path / "map.geojson")
    assert (tmp_path / "map.geojson").read_text() == (
        '{\n  "type": "FeatureCollection",\n  "size": 0.5,\n  "features": []\n}\n'
    )
    assert load_world(tmp_path / "map.geojson") == World(size=0.5)


def test_a_board_with_walls_says_so_beside_its_size(tmp_path):
    save_world(World(size=0.5, walls=True), tmp_path / "map.geojson")
    assert (tmp_path / "map.geojson").read_text() == (
        '{\n  "type": "FeatureCollection",\n  "size": 0.5,\n  "walls": true,\n  "features": []\n}\n'
    )
    assert load_world(tmp_path / "map.geojson") == World(size=0.5, walls=True)


@pytest.mark.parametrize(("walls", "shown"), [("yes", '"yes"'), (1, "1"), (None, "null"), ([], "a list of 0")])
def test_walls_are_true_or_false(tmp_path, walls, shown):
    path = written(tmp_path, collection(walls=walls))
    assert refusal(load_world, path) == f"map.geojson: walls must be true or false, got {shown}"


@pytest.mark.parametrize("seed", range(5))
def test_the_file_is_valid_by_rfc_7946(tmp_path, seed):
    """An independent reader finds the same shapes; the rules it does not check are checked here."""
    world = random_world(4, style="any", rng=seed)
    save_world(world, tmp_path / "map.geojson")
    text = (tmp_path / "map.geojson").read_text()
    document = json.loads(text)
    assert document["type"] == "FeatureCollection"
    for shape, found, read in zip(
        world.shapes, document["features"], shapely.get_parts(shapely.from_geojson(text)), strict=True
    ):
        assert set(found) == {"type", "properties", "geometry"}
        assert (found["type"], found["properties"]["kind"]) == ("Feature", shape.kind)
        assert set(found["geometry"]) == {"type", "coordinates"}
        if isinstance(shape, Circle):
            assert read.geom_type == "Point"
            assert (read.x, read.y) == tuple(shape.center)
        else:
            assert read.is_valid
            assert read.exterior.is_ccw
            ring = found["geometry"]["coordinates"][0]
            assert ring[0] == ring[-1]
            assert np.array_equal(shapely.get_coordinates(read)[:-1], shape.vertices)


# --- results: properties beside the shapes ------------------------------------------------------------------


@pytest.mark.filterwarnings("ignore::primkit.arguments.LikelyWrong")
def test_results_carry_properties_and_are_read_as_a_world(tmp_path):
    world = World([Circle((0, 0), 0.1), TRIANGLE, Circle((0.3, 0.3), 0.05)])
    properties = [
        {"rms": 0.00031, "n_points": 120, "sure": True, "note": None, "name": 'Kružnica "A"'},
        {"rms": np.float32(0.5), "n_points": np.int64(7), "corner": np.array([0.1, 0.2]), "more": {"a": [1]}},
        {},
    ]
    save_world(world, tmp_path / "found.geojson", properties=properties)
    assert load_world(tmp_path / "found.geojson") == world
    told = [f["properties"] for f in json.loads((tmp_path / "found.geojson").read_bytes())["features"]]
    assert told[0] == {"kind": "circle", "radius": 0.1, **properties[0]}
    assert told[1] == {"kind": "triangle", "rms": 0.5, "n_points": 7, "corner": [0.1, 0.2], "more": {"a": [1]}}
    assert told[2] == {"kind": "circle", "radius": 0.05}
    assert "Kružnica" in (tmp_path / "found.geojson").read_text(encoding="utf-8")


ENDLESS: list = []
ENDLESS.append(ENDLESS)
WRONG_PROPERTY = "map.geojson, feature 1: the property 'p' must hold finite numbers, texts, true, false or None, got "


@pytest.mark.parametrize(
    ("properties", "message"),
    [
        pytest.param([], "map.geojson: properties must be one dict for each of the 1 shapes, got 0", id="too few"),
        pytest.param(
            [{}, {}], "map.geojson: properties must be one dict for each of the 1 shapes, got 2", id="too many"
        ),
        pytest.param([3], "map.geojson, feature 1: properties must be a dict, got int", id="no dict"),
        pytest.param({"p": 1}, "map.geojson, feature 1: properties must be a dict, got str", id="one dict for all"),
        pytest.param(
            [{"kind": "square"}],
            "map.geojson, feature 1: a property's name must be a text other than kind and radius, got 'kind'",
            id="the kind is the shape's own",
        ),
        pytest.param(
            [{"radius": 3}],
            "map.geojson, feature 1: a property's name must be a text other than kind and radius, got 'radius'",
            id="the radius is the shape's own",
        ),
        pytest.param(
            [{7: 3}],
            "map.geojson, feature 1: a property's name must be a text other than kind and radius, got 7",
            id="a number for a name",
        ),
        pytest.param([{"p": float("nan")}], WRONG_PROPERTY + "nan", id="NaN"),
        pytest.param([{"p": np.float64("-inf")}], WRONG_PROPERTY + "-inf", id="minus infinity"),
        pytest.param([{"p": [1.0, float("inf")]}], WRONG_PROPERTY + "[1, inf]", id="in a list"),
        pytest.param([{"p": np.array([np.nan])}], WRONG_PROPERTY + "ndarray", id="in an array"),
        pytest.param([{"p": TRIANGLE}], WRONG_PROPERTY + "Polygon", id="an object"),
        pytest.param([{"p": ENDLESS}], WRONG_PROPERTY + "a list of 1", id="a list in itself"),
        pytest.param([{"p": "\ud800"}], WRONG_PROPERTY + r'"\ud800"', id="half a surrogate pair"),
    ],
)
def test_wrong_properties_are_refused_and_nothing_is_written(tmp_path, properties, message):
    assert refusal(save_world, World([TRIANGLE]), tmp_path / "map.geojson", properties=properties) == message
    assert list(tmp_path.iterdir()) == []


def test_only_a_world_is_a_map(tmp_path):
    assert refusal(save_world, [TRIANGLE], tmp_path / "map.geojson") == "map.geojson: a map must be a World, got list"


# --- maps by others -----------------------------------------------------------------------------------------

A_TRIANGLE = World([Polygon(RING)])


@pytest.mark.parametrize(
    ("content", "expected"),
    [
        pytest.param(collection(), World(), id="no features"),
        pytest.param(collection(polygon(RING)), A_TRIANGLE, id="no size means 1 m"),
        pytest.param(collection(polygon(RING), size=3), World([Polygon(RING)], 3), id="whole numbers"),
        pytest.param(polygon(RING), A_TRIANGLE, id="one Feature alone"),
        pytest.param({"type": "Polygon", "coordinates": [RING]}, A_TRIANGLE, id="one geometry alone"),
        pytest.param(polygon(RING[::-1]), World([Polygon([(0, 0), (1, 0), (0, 1)])]), id="clockwise"),
        pytest.param(polygon([[*p, 12.5] for p in RING]), A_TRIANGLE, id="heights are dropped"),
        pytest.param(polygon([[0, 0], [1, 0], [0, 1], [1e-12, 0]]), A_TRIANGLE, id="closed up to rounding"),
        pytest.param(point(0, 1, radius=2), World([Circle((0, 1), 2)]), id="a circle"),
        pytest.param(
            collection(point(0, 1, radius=2, kind="wall", colour={"a": [1]})),
            World([Circle((0, 1), 2)]),
            id="more properties",
        ),
        pytest.param({**collection(polygon(RING)), "crs": {}, "bbox": [0, 0, 1, 1]}, A_TRIANGLE, id="more members"),
        pytest.param({"type": "Feature", "geometry": polygon(RING)["geometry"]}, A_TRIANGLE, id="no properties"),
        pytest.param(b"\xef\xbb\xbf" + json.dumps(polygon(RING)).encode(), A_TRIANGLE, id="a byte order mark"),
        pytest.param(json.dumps(polygon(RING), indent=1).replace("\n", "\r\n"), A_TRIANGLE, id="line ends of Windows"),
        pytest.param(
            '{"type": "Point", ' + json.dumps(polygon(RING))[1:], A_TRIANGLE, id="of a double key the last counts"
        ),
        pytest.param(
            '{"n": ' + "1" * 5000 + ", " + json.dumps(polygon(RING))[1:], A_TRIANGLE, id="5,000 digits elsewhere"
        ),
        pytest.param('{"n": 1e999, ' + json.dumps(polygon(RING))[1:], A_TRIANGLE, id="1e999 elsewhere"),
    ],
)
def test_what_others_write_is_read(tmp_path, content, expected):
    assert bits(load_world(written(tmp_path, content))) == bits(expected)


POSITION = "map.geojson, feature 1: a position must be two or three finite numbers, got "
RADIUS = "map.geojson, feature 1: radius must be a finite number > 0, got "
NO_RADIUS = 'map.geojson, feature 1: a Point must have the property "radius" to be a circle, got none'
GEOMETRY = "map.geojson, feature 1: geometry must be a Polygon, or a Point with a radius, got "
ONE_RING = "map.geojson, feature 1: a Polygon must have one ring and no holes, got "


@pytest.mark.parametrize(
    ("content", "message"),
    [
        # the file
        pytest.param("", "map.geojson: must be GeoJSON, got an empty file", id="empty"),
        pytest.param(" \n\t", "map.geojson: must be GeoJSON, got an empty file", id="blank"),
        pytest.param(
            b"\x89PNG\r\n\x1a\n", "map.geojson: must be text in UTF-8, got something else at byte 0", id="binary"
        ),
        pytest.param(b"{\xff", "map.geojson: must be text in UTF-8, got something else at byte 1", id="one wrong byte"),
        pytest.param(
            "{}".encode("utf-16"), "map.geojson: must be text in UTF-8, got something else at byte 0", id="UTF-16"
        ),
        pytest.param(
            "\x00\x01", "map.geojson: must be valid JSON, got a mistake in line 1, column 1", id="control bytes"
        ),
        pytest.param(
            '{"type":\n', "map.geojson: must be valid JSON, got a mistake in line 2, column 1", id="truncated"
        ),
        pytest.param("{} {}", "map.geojson: must be valid JSON, got a mistake in line 1, column 4", id="two documents"),
        pytest.param(
            "{'a': 1}", "map.geojson: must be valid JSON, got a mistake in line 1, column 2", id="Python's quotes"
        ),
        pytest.param('{"size": NaN}', "map.geojson: numbers must be finite, got NaN", id="NaN"),
        pytest.param('{"size": Infinity}', "map.geojson: numbers must be finite, got Infinity", id="Infinity"),
        pytest.param('{"size": -Infinity}', "map.geojson: numbers must be finite, got -Infinity", id="-Infinity"),
        pytest.param(
            "[" * 10**7,
            "map.geojson: must be nested a few brackets deep, got more than can be read",
            id="ten million [",
        ),
        pytest.param(
            '{"a":' * (3 * 10**6),
            "map.geojson: must be nested a few brackets deep, got more than can be read",
            id="three million {",
        ),
        # the document
        pytest.param("[]", "map.geojson: must be a GeoJSON object, got a list of 0", id="a list"),
        pytest.param("3", "map.geojson: must be a GeoJSON object, got 3", id="a number"),
        pytest.param("null", "map.geojson: must be a GeoJSON object, got null", id="null"),
        pytest.param({}, 'map.geojson: must be GeoJSON with a text as its "type", got null', id="no type"),
        pytest.param(
            {"type": []}, 'map.geojson: must be GeoJSON with a text as its "type", got a list of 0', id="type no text"
        ),
        pytest.param({"type": "FeatureCollection"}, "map.geojson: features must be a list, got null", id="no features"),
        pytest.param(
            {"type": "FeatureCollection", "features": {}},
            "map.geojson: features must be a list, got an object",
            id="an object",
        ),
        pytest.param(collection(size="1"), 'map.geojson: size must be a finite number > 0, got "1"', id="size a text"),
        pytest.param(collection(size=True), "map.geojson: size must be a finite number > 0, got true", id="size true"),
        pytest.param(collection(size=None), "map.geojson: size must be a finite number > 0, got null", id="size null"),
        pytest.param(collection(size=0), "map.geojson: size must be a finite number > 0, got 0", id="size 0"),
        pytest.param(collection(size=-1), "map.geojson: size must be a finite number > 0, got -1", id="size below 0"),
        pytest.param(
            '{"type": "FeatureCollection", "features": [], "size": 1e999}',
            "map.geojson: size must be a finite number > 0, got inf",
            id="size 1e999",
        ),
        # the features
        pytest.param(
            collection(3), "map.geojson, feature 1: must be of type Feature, got 3", id="a number for a feature"
        ),
        pytest.param(
            collection(polygon(RING), {"type": "Point"}),
            'map.geojson, feature 2: must be of type Feature, got "Point"',
            id="a geometry for a feature",
        ),
        pytest.param(
            collection(collection()),
            'map.geojson, feature 1: must be of type Feature, got "FeatureCollection"',
            id="a collection in a collection",
        ),
        pytest.param(collection({}), "map.geojson, feature 1: must be of type Feature, got null", id="an empty object"),
        pytest.param(feature(None), GEOMETRY + "null", id="no geometry"),
        pytest.param(feature([1]), GEOMETRY + "[1]", id="a list for a geometry"),
        pytest.param(feature({"type": ["Point"]}), GEOMETRY + '["Point"]', id="a list for a geometry's type"),
        *[
            pytest.param({"type": kind, "coordinates": []}, GEOMETRY + f'"{kind}"', id=kind)
            for kind in (
                "MultiPolygon",
                "MultiPoint",
                "LineString",
                "MultiLineString",
                "GeometryCollection",
                "Topology",
            )
        ],
        pytest.param({"type": "x" * 10**6}, GEOMETRY + '"' + "x" * 40 + '..."', id="a million letters"),
        # polygons
        pytest.param(polygon(), ONE_RING + "0 rings", id="no ring"),
        pytest.param(polygon(RING, RING), ONE_RING + "2 rings", id="a hole"),
        pytest.param(feature({"type": "Polygon"}), ONE_RING + "null", id="no coordinates"),
        pytest.param(feature({"type": "Polygon", "coordinates": "x"}), ONE_RING + '"x"', id="a text for coordinates"),
        pytest.param(
            polygon([]), "map.geojson, feature 1: a ring must be a list of positions, got a list of 0", id="empty ring"
        ),
        pytest.param(
            polygon({}), "map.geojson, feature 1: a ring must be a list of positions, got an object", id="no list"
        ),
        pytest.param(
            polygon(RING[:3]),
            "map.geojson, feature 1: a ring must end where it begins, got the ends (0, 0) and (0, 1)",
            id="open ring",
        ),
        *[
            pytest.param(polygon(ring), says_polygon(ring), id=name)
            for name, ring in {
                "two corners": [[0, 0], [1, 0], [0, 0]],
                "three on a line": [[0, 0], [1, 0], [2, 0], [0, 0]],
                "crosses itself": [[0, 0], [1, 1], [1, 0], [0, 1], [0, 0]],
                "touches itself": [[0, 0], [2, 0], [2, 2], [1, 0], [0, 2], [0, 0]],
                "100,000 corners that cross": [*([k % 2, k] for k in range(100_000)), [0.5, 0], [0, 0]],
            }.items()
        ],
        # positions
        pytest.param(polygon([[0, "1"], *RING]), POSITION + '[0, "1"]', id="a text"),
        pytest.param(polygon([[0, True], *RING]), POSITION + "[0, true]", id="true"),
        pytest.param(polygon([[0, None], *RING]), POSITION + "[0, null]", id="null in a position"),
        pytest.param(polygon([[0, 0, "high"], *RING]), POSITION + '[0, 0, "high"]', id="a height that is no number"),
        pytest.param(polygon([[0, 0, 0, 0], *RING]), POSITION + "[0, 0, 0, 0]", id="four numbers"),
        pytest.param(polygon([[0], *RING]), POSITION + "[0]", id="one number"),
        pytest.param(polygon([0, 0, 1, 0]), POSITION + "0", id="flat"),
        pytest.param(polygon([[RING, RING]]), POSITION + "a list of 2", id="too deep"),
        pytest.param(polygon([[0] * 10**6]), POSITION + "a list of 1000000", id="a million numbers"),
        pytest.param('{"type": "Polygon", "coordinates": [[[1e999, 0]]]}', POSITION + "[inf, 0]", id="1e999"),
        pytest.param(
            '{"type": "Polygon", "coordinates": [[[' + "1" * 5000 + ", 0]]]}", POSITION + "[inf, 0]", id="5,000 digits"
        ),
        pytest.param(
            '{"type": "Polygon", "coordinates": [[[-' + "1" * (15 * 2**20) + ", 0]]]}",
            POSITION + "[-inf, 0]",
            id="15 million digits",
        ),
        # circles
        pytest.param({"type": "Point", "coordinates": [0, 0]}, NO_RADIUS, id="a Point alone"),
        pytest.param(point(0, 0), NO_RADIUS, id="no radius"),
        pytest.param(
            feature({"type": "Point", "coordinates": [0, 0]}, ["radius"]), NO_RADIUS, id="a list of properties"
        ),
        pytest.param(point(0, 0, radius="0.1"), RADIUS + '"0.1"', id="radius a text"),
        pytest.param(point(0, 0, radius=True), RADIUS + "true", id="radius true"),
        pytest.param(point(0, 0, radius=None), RADIUS + "null", id="radius null"),
        pytest.param(point(0, 0, radius=0), RADIUS + "0", id="radius 0"),
        pytest.param(point(0, 0, radius=-0.1), RADIUS + "-0.1", id="radius below 0"),
        pytest.param(point(radius=1), POSITION + "a list of 0", id="no position"),
        pytest.param(feature({"type": "Point"}, {"radius": 1}), POSITION + "null", id="no coordinates of a Point"),
    ],
)
def test_what_is_no_map_is_refused(tmp_path, content, message):
    assert refusal(load_world, written(tmp_path, content)) == message


@pytest.mark.parametrize("k", [50, 51, 150, 160, 200, 300, 308])
def test_shapes_of_any_size_are_read_or_refused_without_a_warning(tmp_path, k):
    ring = [[0, 0], [10.0**k, 0], [10.0**k, 10.0**k], [0, 10.0**k], [0, 0]]
    world, message = answer(load_world, written(tmp_path, polygon(ring)))
    if k == 50:
        assert world.shapes[0].dimensions == (1e50, 1e50)
    else:
        assert (
            message == f"map.geojson, feature 1: vertices must be finite and at most 1e+50, got (1e+{k}, 0.0) in row 1"
        )


@settings(max_examples=100, deadline=None)
@given(
    st.recursive(
        st.none()
        | st.booleans()
        | st.floats()
        | st.integers()
        | st.sampled_from(["Feature", "FeatureCollection", "Point", "Polygon", "x"]),
        lambda inner: (
            st.lists(inner, max_size=4)
            | st.dictionaries(
                st.sampled_from(["type", "features", "geometry", "coordinates", "properties", "radius", "size"]), inner
            )
        ),
    )
)
def test_any_json_is_a_world_or_is_refused_by_name(tmp_path_factory, value):
    world, message = answer(load_world, written(tmp_path_factory.mktemp("maps"), value))
    assert isinstance(world, World) or (message.startswith("map.geojson") and "\n" not in message)


@pytest.mark.filterwarnings("ignore::primkit.arguments.LikelyWrong")
def test_a_truncated_map_is_refused_wherever_it_ends(tmp_path):
    save_world(World([Circle((0, 0), 0.1), TRIANGLE]), tmp_path / "map.geojson")
    whole = (tmp_path / "map.geojson").read_bytes().rstrip()
    for length in range(1, len(whole)):
        message = refusal(load_world, written(tmp_path, whole[:length]))
        assert message.startswith("map.geojson: must be valid JSON, got a mistake in line ")


def test_recursion_is_refused_near_the_end_of_the_stack_too(tmp_path):
    """The parser has fewer levels left when the caller is deep itself; the interpreter must not crash."""
    path = written(tmp_path, "[" * 10**6)

    def deeper(levels):
        return refusal(load_world, path) if levels == 0 else deeper(levels - 1)

    assert deeper(sys.getrecursionlimit() // 2) == (
        "map.geojson: must be nested a few brackets deep, got more than can be read"
    )
