"""Routes: equal to the last bit, refused in one sentence when they are none, and one for each map of the suite."""

import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import primkit as pk
from primkit import formats
from primkit.formats import Route, load_route, save_route, scripted_drives
from tests.filing import refusal, written

SPEEDS = st.floats(-6.28, 6.28)


@settings(max_examples=30, deadline=None)
@given(
    start=st.tuples(*[st.floats(-1e6, 1e6)] * 3),
    wheels=st.lists(st.tuples(SPEEDS, SPEEDS), max_size=30),
    period=st.floats(1e-3, 10),
)
def test_a_route_comes_back_to_the_last_bit(tmp_path_factory, start, wheels, period):
    path = tmp_path_factory.mktemp("routes") / "a.json"
    route = Route(start, wheels, period)
    save_route(route, path)
    back = load_route(path)
    assert back.start.tobytes() == route.start.tobytes()
    assert (back.wheels.shape, back.wheels.tobytes()) == ((len(wheels), 2), route.wheels.tobytes())
    assert back.period == period


def test_a_route_leads_where_the_wheels_lead():
    world, wheels = pk.random_world(4, rng=7), [(6.28, 6.28), (3, 6)] * 30
    poses = Route((0, 0.02, 1), wheels, 0.2).poses(world)
    assert (poses == pk.drive(world, wheels, (0, 0.02, 1), period=0.2)).all()


ROUTE = {"format": "primkit route", "version": 1, "period": 0.1, "start": [0, 0, 0], "wheels": [[1, 2]]}
NONE = 'a.json: must be a route, with "format": "primkit route", got '
FAILURES = {
    "empty": (b"", "a.json: must be valid JSON, got b''"),
    "cut off": (json.dumps(ROUTE)[:-1], "a.json: must be valid JSON, got b'" + json.dumps(ROUTE)[:40] + "'"),
    "a list": ([], NONE + "[]"),
    "a map": ({"type": "Point"}, NONE + "{'type': 'Point'}"),
    "another version": (ROUTE | {"version": 2}, "a.json: must be a route of version 1, got version 2"),
    "a start in the plane": (ROUTE | {"start": [0, 0]}, "a.json: start must be 3 finite numbers, got 2 of them"),
    "a start nowhere": (ROUTE | {"start": [0, 0, None]}, "a.json: start must be 3 finite numbers, got None"),
    "no wheels": (ROUTE | {"wheels": None}, "a.json: wheels must be a list of pairs, got NoneType"),
    "one wheel": (ROUTE | {"wheels": [[1]]}, "a.json: each of the wheels must be 2 finite numbers, got 1 of them"),
    "NaN": (
        ROUTE | {"wheels": [[1, float("nan")]]},
        "a.json: each of the wheels must be 2 finite numbers, got nan",
    ),
    "too fast": (ROUTE | {"wheels": [[1, 7]]}, "a.json: wheels must turn at 6.28 rad/s at most, got 7"),
    "no time": (ROUTE | {"period": 0}, "a.json: period must be a finite number > 0, got 0"),
    "no period": (ROUTE | {"period": None}, "a.json: period must be a finite number > 0, got None"),
}


@pytest.mark.parametrize(("content", "sentence"), FAILURES.values(), ids=FAILURES)
def test_a_file_that_is_no_route_is_refused(tmp_path, content, sentence):
    assert refusal(load_route, written(tmp_path, content, "a.json")) == sentence


def test_what_is_too_large_is_neither_read_nor_written(tmp_path, monkeypatch):
    route, path = Route((0, 0, 0), [(1, 2)] * 100), tmp_path / "a.json"
    save_route(route, path)
    monkeypatch.setattr(formats.routes, "ROUTE_LIMIT", 1000)
    assert refusal(load_route, path).startswith("a.json: must be at most 1,000 bytes, got ")
    assert refusal(save_route, route, tmp_path / "b.json").startswith("b.json: must be at most 1,000 bytes, got ")
    assert refusal(save_route, [], path) == "a.json: must be a Route, got list"
    assert refusal(save_route, route, "a.csv") == "a.csv: the name of a route must end in .json, got .csv"


def test_two_starts_are_refused():
    sentence = "start must be three finite numbers (x, y, heading), got [(0, 0, 0), (0, 0, 0)]"
    assert refusal(Route, [(0, 0, 0)] * 2, []) == sentence


def test_there_is_a_small_drive_for_each_map():
    drives = scripted_drives()
    assert list(drives) == list(pk.paper_suite())
    folder = formats.suite._data_folder() / "drives"
    assert {path.stem for path in folder.iterdir()} == set(drives)
    assert sum(path.stat().st_size for path in folder.iterdir()) <= 500_000
    for route in drives.values():
        assert (route.wheels == np.round(route.wheels, 2)).all()
