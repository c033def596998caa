"""Found maps: what was found, to a file and back, with walls, things of no kind, strays and all it is sure of."""

import json
import pickle

import numpy as np
import pytest

import primkit as pk
from primkit.found import Found
from primkit.measure import Detection
from tests.filing import refusal
from tests.test_account import seen_on
from tests.test_unknown import CURVED

ELLIPSE = pk.Polygon(CURVED["ellipse 2"]).moved((0.25, 0.2), 0.4)
ROOM = pk.World(
    [pk.Circle((-0.25, 0.2), 0.08), ELLIPSE, pk.Polygon(np.array([(0, 0), (4, 0), (4, 2)]) / 20)], walls=True
)
HALF = pk.Polygon([(0, 0), (0.2, 0), (0.2, 0.1), (0, 0.1)]).outline(300)[:200]  # two sides were never seen
FOUND = {
    "nothing": Found(),
    "a room": pk.find_shapes(seen_on(ROOM, spurious=0.01), rng=0),
    "half a rectangle": pk.find_shapes(HALF, rng=0),
    "as published": pk.find_shapes(seen_on(pk.random_world(2, rng=1)), 2, settings=pk.PAPER, rng=0),
    "shapes of one's own": Found([Detection(pk.Circle((0, 0), 0.1), np.empty((0, 2)), float("nan"))]),
    "coarse cells": pk.find_shapes(pk.Circle((1, 2), 0.6).outline(300), resolution=0.01, rng=0),
}


def numbers(found):
    """All that is known of what was found, as plain numbers."""
    shapes = []
    for one in found:
        sure = [one.margin, one.count_margin, one.certain, one.center_std, one.dimension_std]
        shapes.append([one.points, one.rms, *sure, one.seen, [] if one.scans is None else one.scans])
    walls = [[wall.start, wall.end, wall.points, wall.std, wall.ends_seen] for wall in found.walls]
    others = [[other.points, other.outline] for other in found.others]
    return [np.ravel(v) for part in (*shapes, *walls, *others, [found.strays, found.resolution]) for v in part]


@pytest.mark.parametrize("found", FOUND.values(), ids=FOUND)
def test_what_was_found_comes_back_to_the_last_bit(found, tmp_path):
    path = tmp_path / "found.geojson"
    pk.save_found(found, path)
    again = pk.load_found(path)
    assert [one.shape for one in again] == [one.shape for one in found]
    assert [one.measured for one in again] == [one.measured for one in found]
    assert repr(again) == repr(found)
    rtol = 0 if found.resolution == 0.001 else 1e-14  # deviations are kept in a thousand cells
    for new, old in zip(numbers(again), numbers(found), strict=True):
        np.testing.assert_allclose(new, old, rtol=rtol, atol=0)
    assert repr(pickle.loads(pickle.dumps(again))) == repr(found)


def test_a_room_is_told_whole():
    found = FOUND["a room"]
    assert (len(found.walls), len(found.others)) == (4, 1)
    assert len(found.strays) > 10


def test_the_features_are_plain_geojson(tmp_path):
    path = tmp_path / "found.geojson"
    pk.save_found(FOUND["a room"], path, size=2)
    document = json.loads(path.read_text())
    assert (document["size"], document["resolution"]) == (2.0, 0.001)
    types = [(f["properties"]["kind"], f["geometry"]["type"]) for f in document["features"]]
    assert types.count(("wall", "LineString")) == 4
    assert types.count(("other", "LineString")) == 1
    assert types[-1] == ("strays", "MultiPoint")
    (ring,) = [f["geometry"]["coordinates"] for f in document["features"] if f["properties"]["kind"] == "other"]
    assert ring[0] == ring[-1]


@pytest.mark.parametrize("found", FOUND.values(), ids=FOUND)
def test_as_a_map_it_is_the_shapes_that_were_found(found, tmp_path):
    pk.save_found(found, tmp_path / "found.json", size=8)
    assert pk.load_world(tmp_path / "found.json") == pk.World([one.shape for one in found], size=8)


def test_any_map_can_be_read_as_found(tmp_path):
    pk.save_world(ROOM, tmp_path / "truth.geojson")
    again = pk.load_found(tmp_path / "truth.geojson")
    assert tuple(one.shape for one in again) == ROOM.shapes
    assert not any(one.certain for one in again)
    assert (again.walls, again.others, len(again.strays)) == ((), (), 0)


LINE = {"type": "LineString", "coordinates": [[0, 0], [1, 0]]}
POINT = {"type": "Point", "coordinates": [0, 0]}
WRONG = {
    "a line of no kind": (LINE, {}, 'geometry must be a Polygon, or a Point with a radius, got "LineString"'),
    "a wall of one end": (
        LINE | {"coordinates": [[0, 0]]},
        {"kind": "wall"},
        "a wall must have a start and an end, got 1 positions",
    ),
    "a wall without places": (
        LINE | {"coordinates": 3},
        {"kind": "wall"},
        "coordinates must be a list of positions, got 3",
    ),
    "an end": (LINE, {"kind": "wall", "ends_seen": [True]}, "ends_seen must be two of true and false, got [true]"),
    "a spread": (LINE, {"kind": "wall", "std": "1"}, 'std must be a number or null, got "1"'),
    "an other without points": (LINE, {"kind": "other"}, "points must be a list of positions, got null"),
    "sure of what": (POINT, {"radius": 1, "certain": 1}, "certain must be true, false or null, got 1"),
    "an rms": (POINT, {"radius": 1, "rms": [1]}, "rms must be a number or null, got [1]"),
    "a share": (POINT, {"radius": 1, "seen": [True]}, "seen must be a number or null, got true"),
    "scans": (POINT, {"radius": 1, "scans": [0.5]}, "scans must be whole numbers >= 0, got others"),
    "shares": (POINT, {"radius": 1, "seen": 1}, "seen must be a list of numbers, got 1"),
    "points": (POINT, {"radius": 1, "points": [[0]]}, "a position must be two or three finite numbers, got [0]"),
}


@pytest.mark.parametrize(("geometry", "properties", "sentence"), WRONG.values(), ids=WRONG)
def test_a_file_that_is_not_what_it_says_is_refused(geometry, properties, sentence, tmp_path):
    path = tmp_path / "found.geojson"
    feature = {"type": "Feature", "properties": properties, "geometry": geometry}
    path.write_text(json.dumps({"type": "FeatureCollection", "features": [feature]}))
    assert refusal(pk.load_found, path) == f"found.geojson, feature 1: {sentence}"


def test_failure(tmp_path):
    assert refusal(pk.save_found, [], tmp_path / "a.geojson").endswith("as find_shapes returns it, Found, got list")
    assert refusal(pk.save_found, Found(), tmp_path / "a.txt").startswith("a.txt: ")
    (tmp_path / "a.json").write_text('{"type": "FeatureCollection", "resolution": 0, "features": []}')
    assert "resolution must be" in refusal(pk.load_found, tmp_path / "a.json")
