"""The live scene without a browser: what a drive by hand knows, what it sends to the page, and that it stays quick."""

import threading
import time
import tracemalloc
from concurrent.futures import Executor, Future

import numpy as np
import pytest

import primkit as pk
from primkit.measure import Detection
from primkit.robot import AXLE, FASTEST, WHEEL
from primkit.widgets.driving import DriveState
from primkit.widgets.finder import beside
from primkit.widgets.keys import HELD, STANDING, wheels_for
from primkit.widgets.scene import Scene
from primkit.widgets.sketch import drawn

STEP = 0.05  # s of processor time, which 95 of 100 steps do not exceed: half of the tenth of a second that there is
TURN = 2 * WHEEL * 0.3 * FASTEST / AXLE  # rad/s


def wandering(n_steps, rng=0):
    """Keys of somebody who drives onwards in arcs and turns away from what is in the way, as a generator of steps.

    Send it whether the robot was stopped.
    """
    ways = [["forward"], ["forward", "left"], ["forward", "right"]]
    rng = np.random.default_rng(rng)
    held, left = ["forward"], 0
    for _ in range(n_steps):
        stopped = yield held
        left -= 1
        if stopped:
            held, left = ["back", "left"], int(rng.integers(5, 12))
        elif left <= 0:
            held, left = ways[rng.integers(3)], int(rng.integers(20))


def wander(state, n_steps):
    """Drive; return what each step took, in seconds of processor time."""
    hand, taken, stopped = wandering(n_steps), [], None
    for _ in range(n_steps):
        wheels = wheels_for(hand.send(stopped))
        start = time.process_time()
        stopped = state.step(wheels).stopped
        taken.append(time.process_time() - start)
    return np.array(taken)


@pytest.fixture(scope="module")
def world():
    return pk.random_world(4, rng=7)


@pytest.fixture(scope="module")
def driven(world):
    """A drive of a minute, and what its steps took."""
    state = DriveState(world)
    return state, wander(state, 600)


@pytest.fixture
def scene(world):
    """A scene, with all that it sends to the page."""
    scene = Scene(DriveState(world))
    scene.sent = []
    scene.send = lambda content, buffers=None: scene.sent.append((content, buffers))
    yield scene
    scene.close()


@pytest.mark.parametrize(
    ("held", "way", "turn"),
    [
        ([], 0, 0),
        (["forward"], 1, 0),
        (["back"], -1, 0),
        (["left"], 0, 1),
        (["right"], 0, -1),
        (["forward", "left"], 0.7, 1),
        (["back", "right"], -0.7, -1),
        (["forward", "back"], 0, 0),
        (["left", "right", "forward"], 1, 0),
        (list(HELD), 0, 0),
    ],
)
def test_keys_are_speeds_of_the_wheels(held, way, turn):
    left, right = wheels_for(held)
    assert max(abs(left), abs(right)) <= FASTEST
    assert (left + right) / 2 == pytest.approx(way * FASTEST)
    assert WHEEL * (right - left) / AXLE == pytest.approx(turn * TURN)


def test_another_word_is_refused():
    with pytest.raises(ValueError, match="held must be among forward, back, left, right, got 'up'"):
        wheels_for(["forward", "up"])


def test_a_drive_is_that_of_the_library(world):
    """Poses, cells and shapes are those of drive, scan, Grid and find_shapes on the same speeds."""
    state, wheels = DriveState(world), [wheels_for(held) for held in (["forward"], ["forward", "left"], ["left"]) * 15]
    for speeds in wheels:
        state.step(speeds)
    state.step(STANDING)  # what is left over is looked at
    poses, grid = pk.drive(world, [*wheels, STANDING]), pk.Grid()
    grid.add(pk.scan(world, poses))
    np.testing.assert_array_equal(state.pose, poses[-1])
    np.testing.assert_array_equal(state.grid.cells, grid.cells)
    alone = pk.find_shapes(grid.points(), rng=0)
    assert [one.kind for one in state.found] == [one.kind for one in alone]
    for ours, theirs in zip(state.found, alone, strict=True):
        np.testing.assert_allclose(ours.shape.centroid, theirs.shape.centroid, atol=1e-3)
    assert state.n_scans == len(poses)
    assert state.time == pytest.approx(4.6)


def test_each_cell_is_new_once(world):
    state = DriveState(world)
    first, told = len(state.grid), []
    hand, stopped = wandering(100), None
    for _ in range(100):
        step = state.step(wheels_for(hand.send(stopped)))
        stopped = step.stopped
        told += map(tuple, step.new_cells.tolist())
    assert len(told) == len(set(told)) == len(state.grid) - first
    assert set(told) <= set(map(tuple, state.grid.cells.tolist()))


def test_the_robot_finds_the_shapes_and_sees_the_board(driven):
    state, _ = driven
    start = DriveState(state.world)
    assert state.score >= 0.5 > start.score
    assert state.unseen().sum() < start.unseen().sum() / 2


def test_back_at_the_start_all_is_as_it_was(world):
    noisy = pk.Lidar(noise_std=0.002)
    state, fresh = DriveState(world, noisy, rng=3), DriveState(world, noisy, rng=3)
    wander(state, 12)
    state.undo()
    for _ in range(2):
        np.testing.assert_array_equal(state.pose, fresh.pose)
        np.testing.assert_array_equal(state.scan.ranges, fresh.scan.ranges)
        np.testing.assert_array_equal(state.grid.cells, fresh.grid.cells)
        np.testing.assert_array_equal(state.unseen(), fresh.unseen())
        assert state.n_scans == fresh.n_scans
        assert [one.shape for one in state.found] == [one.shape for one in fresh.found]
        wander(state, 2), wander(fresh, 2)


def test_a_step_leaves_half_of_the_time_free(driven):
    _, taken = driven
    assert np.percentile(taken, 95) <= STEP


def test_the_memory_stays_flat(world):
    """From the third to the fifth of five stretches; the first ones see the board for the first time."""
    state, held = DriveState(world), []
    wander(state, 300)
    tracemalloc.start()
    try:
        for _ in range(3):
            wander(state, 150)
            held.append(tracemalloc.get_traced_memory()[0])
    finally:
        tracemalloc.stop()
    assert held[-1] - held[0] < 300_000  # bytes; the scans alone would be 250,000, and 2,000,000 with all they bring


def test_the_automatic_movements_are_the_library_s(world):
    state = DriveState(world)
    state.step(wheels_for(["forward"]))
    hand, points, tour = state.compare().runs
    grid = pk.Grid()
    grid.add(pk.scan(world, pk.teleport_poses(world)))
    found, explored = pk.find_shapes(grid.points(), rng=0), pk.explore(world, rng=0)
    assert (points.n_scans, points.n_found) == (len(pk.teleport_poses(world)), len(found))
    assert points.score == pk.evaluate(found, world).weighted_accuracy
    assert points.robot_time == pytest.approx(7.7)
    assert (tour.n_scans, tour.robot_time, tour.n_found) == (
        explored.n_scans,
        explored.robot_time,
        len(explored.found),
    )
    assert tour.score == pk.evaluate(list(explored.found), world).weighted_accuracy
    assert (hand.n_scans, hand.robot_time, hand.score) == (2, pytest.approx(0.1), state.score)


# Shapes are looked for beside the drive.


class Later(Executor):
    """An executor whose work is done when the test says so, or when somebody waits for it."""

    def __init__(self):
        self.work = []

    def submit(self, fn, /, *args, **kwargs):
        work = Work(lambda: fn(*args, **kwargs))
        self.work.append(work)
        return work

    def work_one(self):
        self.work.pop(0).do()


class Work(Future):
    def __init__(self, fn):
        super().__init__()
        self.fn = fn

    def do(self):
        if not self.done():
            self.set_result(self.fn())

    def result(self, timeout=None):
        self.do()
        return super().result(timeout)


def ahead(state, n_steps):
    """Drive onwards; return how many looks were fetched."""
    return sum(state.step(wheels_for(["forward"])).mapped for _ in range(n_steps))


def test_the_robot_does_not_wait_for_the_shapes(world):
    state = DriveState(world, executor=(later := Later()))
    later.work.clear()
    before, known = state.found, state.n_scans
    assert ahead(state, 12) == 0
    assert len(later.work) == 1, "one look at a time"
    assert (state.n_scans, state.n_scans_found, state.found) == (known + 12, known, before)
    later.work_one()
    assert state.map()
    asked_at = state.n_scans_found
    assert known < asked_at < state.n_scans
    assert len(later.work) == 1, "the next look takes what has come meanwhile"
    later.work_one()
    state.map()
    assert state.n_scans_found == state.n_scans


def test_in_the_end_it_does_not_matter_how_long_looks_took(world):
    """The last look is afresh: the very shapes that find_shapes makes of the map."""
    slow, quick = DriveState(world, executor=(later := Later())), DriveState(world)
    for number, held in enumerate(["forward"] * 20 + ["left"] * 10):
        for state in (slow, quick):
            state.step(wheels_for([held]))
        if number % 7 == 0:
            later.work_one()
    alone = pk.find_shapes(quick.grid.points(), rng=0)
    for state in (slow, quick):
        state.finish()
        assert not state.looks
        assert state.n_scans_found == state.n_scans
        assert [one.shape for one in state.found] == [one.shape for one in alone]


def test_a_look_at_what_was_undone_comes_to_nothing(world):
    state = DriveState(world, executor=(later := Later()))
    later.work.clear()
    ahead(state, 12)
    state.undo()
    assert (state.n_scans, state.found) == (1, [])
    later.work_one()  # the old look
    assert not state.map(), "those shapes are from before"
    state.finish()
    assert state.n_scans_found == 1


def test_a_thread_finds_what_the_drive_itself_finds(world):
    own, threaded = DriveState(world), DriveState(world, executor=beside())
    for state in (own, threaded):
        ahead(state, 30)
        state.finish()
    threaded.close()
    assert [one.kind for one in threaded.found] == [one.kind for one in own.found]


def test_the_thread_ends_with_the_scene(world):
    scene = pk.drive_scene(world)
    names = [thread for thread in threading.enumerate() if thread.name.startswith("primkit-finder")]
    scene.close()
    for thread in names:
        thread.join(10)
    assert names
    assert not any(thread.is_alive() for thread in names)


def test_who_drives_hears_of_a_look_that_failed_and_drives_on(scene, monkeypatch):
    def broken(*_args, **_kwargs):
        raise ArithmeticError("lost count")

    monkeypatch.setattr("primkit.widgets.finder.find_shapes", broken)
    for _ in range(3):
        scene.answer({"do": "step", "held": ["forward"]})
    assert any("failed, the drive goes on: ArithmeticError: lost count" in (m.get("say") or "") for m, _ in scene.sent)
    assert scene.state.n_scans == 4
    with pytest.raises(ArithmeticError, match="lost count"):
        ahead(scene.state, 3)
    monkeypatch.undo()
    scene.state.finish()
    assert scene.state.n_scans_found == scene.state.n_scans


def test_the_page_asks_on_until_the_last_look_is_done(world):
    scene = Scene(DriveState(world, executor=(later := Later())))
    scene.sent = []
    scene.send = lambda content, buffers=None: scene.sent.append(content)
    for _ in range(9):
        scene.answer({"do": "step", "held": ["forward"]})
    assert "shapes 9 scans old" in scene.sent[-2]["score"]
    while later.work:
        assert scene.sent[-1]["busy"]
        later.work_one()
        scene.answer({"do": "news"})
        scene.answer({"do": "step", "held": []})
    assert not scene.sent[-1]["busy"]
    assert "old" not in scene.sent[-2]["score"]
    scene.close()


# The journal.


def test_every_scan_is_written_as_it_happens(world, tmp_path):
    state = DriveState(world, journal=tmp_path / "drive.jsonl")
    assert list(tmp_path.iterdir()) == []
    wheels = [wheels_for(held) for held in (["forward"], ["left"], [])]
    for number, speeds in enumerate(wheels, start=2):
        state.step(speeds)
        drive = pk.load_drive(state.record)  # while the journal is open
        assert len(drive) == number
        np.testing.assert_array_equal(drive.scans.ranges[-1:], state.scan.ranges)
    np.testing.assert_array_equal(drive.poses, pk.drive(world, wheels))
    np.testing.assert_array_equal(drive.wheels, [STANDING, *wheels])
    state.close()


def test_no_journal_is_ever_replaced(world, tmp_path):
    (tmp_path / "drive.jsonl").write_text("mine")
    state = DriveState(world, journal=str(tmp_path / "drive.jsonl"))
    for name in ("drive-2.jsonl", "drive-3.jsonl"):
        state.step()
        assert state.record.name == name
        state.undo()
    assert (tmp_path / "drive.jsonl").read_text() == "mine"
    assert len(pk.load_drive(tmp_path / "drive-2.jsonl")) == 2


def test_a_journal_that_cannot_be_written_does_not_end_the_drive(world, tmp_path):
    state = DriveState(world, journal=tmp_path / "nowhere" / "drive.jsonl")
    state.step(wheels_for(["forward"]))
    state.step(wheels_for(["forward"]))
    assert state.n_scans == 3
    assert "there is no folder" in state.trouble


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"world": 3}, "world must be a World"),
        ({"lidar": 3}, "lidar must be a Lidar"),
        ({"journal": "drive.txt"}, r"journal must be a file name that ends in .jsonl, got drive.txt"),
        ({"rng": "a"}, "rng must be a seed"),
    ],
)
def test_bad_input_is_refused(world, arguments, message):
    with pytest.raises(ValueError, match=message):
        pk.drive_scene(**{"world": world} | arguments)


# What goes to the page.


def test_a_page_gets_only_what_is_new(scene):
    scene.answer({"do": "step", "held": ["forward"]})
    (message, _), (mapped, _) = scene.sent
    assert {"pose", "ranges", "cells"} <= message.keys()
    assert mapped["done"]
    assert not {"truth", "board", "unseen"} & (message.keys() | mapped.keys())
    assert len(message["cells"]) < 100


def test_the_picture_does_not_wait_for_the_shapes(scene):
    sent_before = []
    look = scene.state.map
    scene.state.map = lambda: sent_before.append(len(scene.sent)) or look()
    scene.answer({"do": "step", "held": ["forward"]})
    assert sent_before == [1]


def test_a_new_page_gets_all_that_was_seen(scene):
    wander(scene.state, 60)
    scene.answer({"do": "hello"})
    message = scene.sent[0][0]
    assert message["cells"] == scene.state.grid.cells.tolist()
    assert len(message["shapes"]) == len(scene.state.found) > 0
    assert message["truth"] == []


def test_nothing_true_is_sent_unless_it_is_asked_for(scene):
    asked = [{"do": "truth"}, {"do": "truth"}]
    for one in asked:
        scene.answer(one)
    assert [len(message["truth"]) for message, _ in scene.sent] == [4, 0]


def test_a_shape_is_named_when_it_is_found(scene):
    said = []
    for held in wandering(60):
        scene.answer({"do": "step", "held": held})
        said.append(scene.sent[-1][0].get("say"))
    assert any(words and words.startswith("Found so far: ") for words in said)
    assert not all(said), "who listens is told what is new, and not ten times a second"


def test_a_pause_holds_the_robot(scene):
    before = scene.state.pose
    for do in ("pause", "step", "pause"):
        scene.answer({"do": do, "held": ["forward"]})
    np.testing.assert_array_equal(scene.state.pose, before)
    scene.answer({"do": "step", "held": ["forward"]})
    assert scene.state.pose[0] > before[0]


def test_what_is_unseen_is_sent_as_bits(scene):
    for _ in range(2):
        scene.answer({"do": "unseen"})
    (first, (bits,)), (second, none) = scene.sent
    n = first["unseen"]
    sent = np.unpackbits(np.frombuffer(bits, dtype=np.uint8))[: n * n].reshape(n, n)
    np.testing.assert_array_equal(sent, scene.state.unseen())
    assert (second["unseen"], none) == (0, None)


def test_the_scene_says_what_it_is(scene):
    scene.answer({"do": "step", "held": []})
    assert repr(scene) == "Scene: 0.1 s driven, 2 scans, 1 shape found"
    scene.answer({"do": "undo"})
    assert scene.state.n_scans == 1


def test_the_automatic_runs_are_shown_beside_the_drive(scene):
    scene.answer({"do": "step", "held": ["forward"]})
    scene.answer({"do": "automatic"})
    told = scene.sent[-1][0]["automatic"]
    head, *rows = told["table"]
    assert head[:5] == ("", "scans", "robot time", "found", "score")
    assert [row[0] for row in rows] == ["by hand", "way-points", "explore"]
    assert rows[0][1:3] == ("2", "0.1 s")
    assert {name: len(places) for name, places in told["places"].items()} == {
        row[0]: int(row[1]) for row in rows if row[0] != "by hand"
    }
    scene.answer({"do": "undo"})
    assert scene.sent[-2][0]["automatic"] is None


def test_an_outline_is_drawn_as_it_was_seen():
    """Of a rectangle only two sides were seen; together the stretches are the whole outline."""
    shape = pk.Polygon([(0, 0), (0.2, 0), (0.2, 0.1), (0, 0.1)])
    x, y = np.arange(0, 0.2, 0.001), np.arange(0, 0.1, 0.001)
    points = np.vstack([np.column_stack([x, 0 * x]), np.column_stack([0 * y + 0.2, y])])
    told = drawn(Detection(shape, points, 0.0, dimension_std=(0.001, float("inf"))))
    assert told["name"] == "rectangle, 200 x ? mm"
    for seen, stretch in told["stretches"]:
        inner = np.array(stretch[2:-2]).reshape(-1, 2) / 10_000
        on = (np.abs(inner[:, 1]) < 0.013) | (np.abs(inner[:, 0] - 0.2) < 0.013)
        assert on.all() if seen else not on.any()
    ends = [stretch for _, stretch in told["stretches"]]
    assert all(a[-1] == b[0] for a, b in zip(ends, [*ends[1:], ends[0]], strict=True))
    assert {seen for seen, _ in told["stretches"]} == {True, False}
