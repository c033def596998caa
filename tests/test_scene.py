"""The live scene without a browser: what a drive by hand knows, what it sends to the page, and that it stays quick."""

import gc
import re
import sys
import threading
import time
from concurrent.futures import Executor, Future
from itertools import pairwise

import numpy as np
import pytest

import primkit as pk
from primkit.driving.moving_grid import MovingGrid
from primkit.found import Found
from primkit.measure import Detection, Other, Wall
from primkit.robot import AXLE, FASTEST, WHEEL, clearance
from primkit.robust.deviations import Certainty
from primkit.scene.finder import MOST_CELLS, AtOnce, Beside, Finder, thin_out
from primkit.scene.keys import KEY_MOTIONS, STANDING_WHEELS, wheels_for
from primkit.scene.moved_shape import LEAST_MOVED, find_left_within, move_one_shape
from primkit.scene.page import describe, describe_shape
from primkit.scene.replay import Film
from primkit.scene.scene import Scene
from primkit.scene.state import DriveState
from tests.benchmarks.long_drive import long_drive, wandering

MOST_MEMORY = 1.06  # times what the first half minute took
SLOWER = 2.0  # times: a larger map makes a step 1.3 times as long; 13 us of work for each scan so far, 2.6 times
TURN = 2 * WHEEL * 0.3 * FASTEST / AXLE  # rad/s


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


def wander(state, n_steps):
    """Drive for so many steps."""
    hand, stopped = wandering(n_steps), None
    for _ in range(n_steps):
        stopped = state.step(wheels_for(hand.send(stopped))).stopped


@pytest.fixture(scope="module")
def world():
    return pk.random_world(4, rng=7)


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
        (list(KEY_MOTIONS), 0, 0),
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
    state.step(STANDING_WHEELS)  # what is left over is looked at
    poses, grid = pk.drive(world, [*wheels, STANDING_WHEELS]), pk.Grid()
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
    state = DriveState(world, executor=Later())
    first, told = len(state.grid), []
    hand, stopped = wandering(50), None
    for _ in range(50):
        step = state.step(wheels_for(hand.send(stopped)))
        stopped = step.stopped
        told += map(tuple, step.new_cells.tolist())
    assert len(told) == len(set(told)) == len(state.grid) - first
    assert set(told) <= set(map(tuple, state.grid.cells.tolist()))


def test_the_robot_finds_the_shapes_and_sees_the_board(world):
    state, start = DriveState(world, executor=Later()), DriveState(world)
    wander(state, 420)
    state.finish()
    assert state.score >= 0.5 > start.score
    assert state.unseen().sum() < start.unseen().sum() / 2


def test_back_at_the_start_all_is_as_it_was(world):
    noisy = pk.Lidar(noise_std=0.0005)
    state, fresh = DriveState(world, noisy, rng=3), DriveState(world, noisy, rng=3)
    wander(state, 5)
    state.undo()
    for _ in range(2):
        np.testing.assert_array_equal(state.pose, fresh.pose)
        np.testing.assert_array_equal(state.scan.ranges, fresh.scan.ranges)
        np.testing.assert_array_equal(state.grid.cells, fresh.grid.cells)
        np.testing.assert_array_equal(state.unseen(), fresh.unseen())
        assert state.n_scans == fresh.n_scans
        assert [one.shape for one in state.found] == [one.shape for one in fresh.found]
        wander(state, 2), wander(fresh, 2)


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no resource module")
def test_neither_memory_nor_a_step_s_work_grows_with_the_drive():
    """Four times as long, twice as many cells, while shapes are looked for beside the drive."""
    (few, before, quick), (many, after, late) = long_drive(0.001, 100, 400)
    assert many > 1.3 * few
    assert after <= MOST_MEMORY * before
    assert late <= SLOWER * quick


def test_of_a_scan_nothing_stays_but_its_cells(world):
    """Shapes are not looked for: how many blocks a look leaves behind depends on when it came."""
    state, hand, held = DriveState(world, executor=Later()), wandering(400), [None]
    for number in range(1, 401):
        state.step(wheels_for(hand.send(held.pop())))
        held.append(state.stopped)
        if number == 100:
            gc.collect()
            before = sys.getallocatedblocks()
    gc.collect()
    assert sys.getallocatedblocks() - before < 300  # what is kept of each scan, however small, would be a block each


def test_the_automatic_movements_are_the_library_s(world):
    state = DriveState(world)
    state.step(wheels_for(["forward"]))
    hand, points, tour = state.compare().lines
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
    assert tour.score == pk.evaluate(explored.found, world).weighted_accuracy
    assert (hand.n_scans, hand.robot_time, hand.score) == (2, pytest.approx(0.1), state.score)


# Shapes are looked for beside the drive.


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


def test_one_look_at_a_time():
    finder, mapper = Finder(later := Later()), pk.Mapper(rng=0)
    for n_scans in (3, 4):
        mapper.add(pk.Circle((0.1, 0.0), 0.06).outline(150)[: 40 * n_scans])
        finder.look(mapper, n_scans)
        assert finder.busy
        assert finder.news() is None
    later.work_one()
    assert later.work == []
    assert finder.news().n_scans == 3
    assert not finder.busy


def test_of_very_many_cells_a_look_takes_a_part_and_the_last_look_all(world, monkeypatch):
    """So that neither its time nor its memory grows with the drive."""
    looked_at = []
    monkeypatch.setattr(pk.Mapper, "look", lambda _, grid: looked_at.append(len(grid)) or pk.find_shapes([]))
    state, rng = DriveState(world), np.random.default_rng(0)
    for _ in range(8):
        state.grid.add(rng.uniform(-0.4, 0.4, (2000, 2)))
        state.step()
    assert len(state.grid) > 2 * MOST_CELLS
    assert max(looked_at) <= MOST_CELLS
    assert looked_at[-1] > MOST_CELLS / 2
    state.finish()
    assert looked_at[-1] == len(state.grid)


def test_what_is_looked_at_grows_with_the_map():
    """A cell that is looked at is looked at again, until there are too many; then some drop out, and none comes in."""
    cells = np.stack(np.meshgrid(np.arange(60), np.arange(50)), axis=-1).reshape(-1, 2)
    all_of_them = thin_out(cells, 1000)
    assert 500 < all_of_them.sum() <= 1000
    for n in range(100, 3000, 100):
        fewer = thin_out(cells[:n], 1000)
        assert not (all_of_them[:n] & ~fewer).any()
    near = thin_out(cells[: len(cells) - 10], 1000)
    np.testing.assert_array_equal(near, all_of_them[:-10])


def test_thinned_out_cells_know_the_scans_that_hit_them_last(world):
    """Poses slip scan by scan: a look at a part of the cells that knew no scans would state other deviations."""
    mapper = pk.Mapper(rng=0)
    mapper.add(pk.scan(world, pk.teleport_poses(world)))
    looked_at = []
    mapper.look = lambda grid: looked_at.append(grid) or Found()
    Finder(AtOnce()).look(mapper, n_scans=72, most=100)
    (part,) = looked_at
    whole = {tuple(cell): seen for cell, seen in zip(mapper.grid.cells.tolist(), mapper.grid.last_seen, strict=True)}
    assert 50 < len(part) <= 100
    assert [whole[tuple(cell)] for cell in part.cells.tolist()] == part.last_seen.tolist()


def test_in_the_end_it_does_not_matter_how_long_looks_took(world):
    """The last look is afresh: the very shapes that find_shapes makes of the map."""
    slow, quick = DriveState(world, executor=(later := Later())), DriveState(world)
    for number, held in enumerate(["forward"] * 11 + ["left"] * 5):
        for state in (slow, quick):
            state.step(wheels_for([held]))
        if number % 5 == 0:
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
    own, threaded = DriveState(world), DriveState(world, executor=Beside())
    for state in (own, threaded):
        ahead(state, 30)
        state.finish()
    threaded.close()
    assert [one.kind for one in threaded.found] == [one.kind for one in own.found]


def finders():
    """The threads that look for shapes."""
    return [thread for thread in threading.enumerate() if thread.name == "primkit-finder"]


def test_a_thread_ends_with_its_look(world):
    for thread in finders():  # of other tests' scenes
        thread.join(10)
    scene = pk.drive_scene(world)
    scene.answer({"do": "step", "held": ["forward"]})
    assert len(finders()) <= 2, "one looks, and one may have told what it found and be leaving"
    scene.state.finish()
    for thread in finders():
        thread.join(10)
    assert finders() == []
    scene.close()
    ahead(scene.state, 3)
    scene.state.finish()
    assert scene.state.n_scans_found == scene.state.n_scans, "the state is still of use"


def test_who_drives_hears_of_a_look_that_failed_and_drives_on(scene, monkeypatch):
    def broken(*_args, **_kwargs):
        raise ArithmeticError("lost count")

    monkeypatch.setattr(pk.Mapper, "look", broken)
    for _ in range(3):
        scene.answer({"do": "step", "held": ["forward"]})
    assert scene.sent[-1][0]["trouble"] == "ArithmeticError: lost count; the drive goes on."
    assert scene.state.n_scans == 4
    with pytest.raises(ArithmeticError, match="lost count"):
        ahead(scene.state, 3)
    monkeypatch.undo()
    scene.state.finish()
    assert scene.state.n_scans_found == scene.state.n_scans


def test_the_page_asks_on_until_the_last_look_is_done(world):
    scene = Scene(DriveState(world, executor=(later := Later())))
    scene.sent = []
    scene.send = lambda content, _=None: scene.sent.append(content)
    for _ in range(9):
        scene.answer({"do": "step", "held": ["forward"]})
    assert "shapes 0.9 s old" in scene.sent[-2]["score"]
    while later.work:
        assert scene.sent[-1]["busy"]
        later.work_one()
        scene.answer({"do": "news"})
        scene.answer({"do": "step", "held": []})
    assert not scene.sent[-1]["busy"]
    assert "old" not in scene.sent[-2]["score"]
    scene.close()


# Things that are moved while the robot drives.


def look_round(state, shape, n):
    """Carry the robot around a shape, and let it scan from n places with room for it."""
    bearings = np.linspace(0, 2 * np.pi, 60, endpoint=False)
    ring = np.column_stack([np.cos(bearings), np.sin(bearings)])
    for reach in (0.12, 0.16, 0.2, 0.25, 0.3):
        places = shape.centroid + reach * ring
        good = clearance(state.world, places) > 0.001
        if good.sum() >= n:
            break
    for x, y in places[good][np.linspace(0, good.sum() - 1, n).round().astype(int)]:
        state.pose = np.array([x, y, 0.0])
        state.move()


def ghosts(state, old):
    """Return how many cells are left near where a shape was, and on none that is there."""
    points = state.grid.points()
    apart = np.min([np.abs(shape.signed_distance(points)) for shape in state.world.shapes], axis=0)
    return int(((apart > 0.012) & (np.abs(old.signed_distance(points)) < 0.012)).sum())


def the_moved(before, after):
    """Return the shape that stands elsewhere, as it stood, and as it stands."""
    (pair,) = [(old, new) for old, new in zip(before.shapes, after.shapes, strict=True) if old != new]
    return pair


@pytest.mark.parametrize("seed", [1, 5])
def test_a_moved_shape_leaves_no_ghost_and_is_found_again(seed):
    """Within twenty scans that look at it."""
    state = DriveState(pk.random_world(3, rng=seed), moving=True, rng=seed)
    for shape in state.world.shapes:
        look_round(state, shape, 30)
    state.finish()
    assert state.score == 1.0
    before = state.world
    assert state.move_something()
    old, new = the_moved(before, state.world)
    assert ghosts(state, old) > 50, "nothing is known of it yet"
    look_round(state, new, 20)
    state.finish()
    state.step()
    assert ghosts(state, old) == 0
    assert state.score == 1.0


def test_what_lies_within_a_shape_that_was_put_around_it_is_given_up():
    """No beam will ever come there: only the shape itself tells that nothing can be left."""
    small, large, grid = pk.Circle((0, 0), 0.04), pk.Circle((0.02, 0), 0.12), MovingGrid()
    grid.add(pk.scan(pk.World([small]), [(0.2, 0, 0)] * 2))
    bearings = np.arange(0, 6.28, 0.1)
    around = np.column_stack([0.02 + 0.3 * np.cos(bearings), 0.3 * np.sin(bearings), 0 * bearings])
    inner = grid.points()
    grid.add(pk.scan(pk.World([large]), around))
    points = grid.points()
    ring = points[np.abs(large.signed_distance(points)) < 0.005]
    within = find_left_within(grid, [Detection(large, ring, 0.0)])
    assert within.sum() == len(inner)
    assert (large.signed_distance(points[within]) < 0).all()
    half = ring[ring[:, 0] < 0.0]
    assert not find_left_within(grid, [Detection(large, half, 0.0)]).any(), "too little of it was seen to be sure"
    grid.give_up(within)
    assert len(grid) == len(points) - len(inner)


def test_what_the_robot_cannot_see_any_more_leaves_its_map():
    """A small circle, and then a large one around it: no beam reaches where the small one was."""
    small, large = pk.Circle((0.2, 0.1), 0.03), pk.Circle((0.2, 0.1), 0.12)
    state = DriveState(pk.World([small]), moving=True)
    look_round(state, small, 20)
    state.pose = np.zeros(3)
    state.rearrange(pk.World([large]))
    look_round(state, large, 20)
    assert ghosts(state, small) > 20
    state.finish()
    _, gone = state.move()
    assert ghosts(state, small) == 0
    assert len(gone) > 20, "and the page is told so"
    assert state.score == 1.0


def test_the_page_hears_which_cells_are_gone(world):
    scene = Scene(DriveState(world, moving=True, executor=(later := Later())))
    told, cells = [], set(map(tuple, scene.state.grid.cells.tolist()))
    scene.send = lambda content, _=None: told.append(content)
    for number, held in enumerate(wandering(60)):
        if number == 30:
            scene.answer({"do": "move"})
        scene.answer({"do": "step", "held": held})
        if number % 10 == 9 and later.work:
            later.work_one()
    for message in told:
        cells -= {tuple(cell) for cell in message.get("gone", [])}
        cells |= {tuple(cell) for cell in message.get("cells", [])}
    assert any(message.get("gone") for message in told)
    assert any((message.get("say") or "").startswith("Somebody has moved a shape") for message in told)
    assert cells == set(map(tuple, scene.state.grid.cells.tolist()))
    scene.close()


def test_back_at_the_start_things_stand_where_they_stood(world):
    state = DriveState(world, moving=True)
    assert state.move_something()
    assert state.world != world
    state.undo()
    assert state.world == world
    assert (state.n_scans, state.score) == (1, DriveState(world, moving=True).score)


def test_what_is_moved_keeps_clear_of_all(world):
    rng, pose = np.random.default_rng(0), np.array([0.0, 0.0, 0.0])
    for _ in range(20):
        after = move_one_shape(world, pose, rng)
        old, new = the_moved(world, after)
        assert np.hypot(*(new.centroid - old.centroid)) >= LEAST_MOVED - 1e-9
        assert after.least_gap() >= 0.05
        assert clearance(after, pose[None, :2])[0] > 0
        world = after
    assert move_one_shape(pk.World(), pose, rng) is None
    full = pk.World([pk.Circle((0.25, 0), 0.24), pk.Circle((-0.25, 0), 0.24)])
    assert move_one_shape(full, np.array([0, 0.4, 0]), rng) is None


@pytest.mark.parametrize(
    ("moving", "other", "message"),
    [
        (False, pk.World(), r"things must be allowed to move, as in drive_scene\(world, moving=True\)"),
        (True, pk.World(size=2.0), "the board must stay 1 m wide, got 2 m"),
        (True, pk.World([pk.Circle((0, 0), 0.1)]), "the robot must stand clear of shapes"),
        (True, 3, "world must be a World, got int"),
    ],
)
def test_things_are_not_moved_to_where_they_cannot_be(moving, other, message):
    state = DriveState(pk.World([pk.Circle((0.3, 0), 0.05)]), moving=moving)
    with pytest.raises(ValueError, match=message):
        state.rearrange(other)


# A drive that was recorded, as a film.


@pytest.fixture(scope="module")
def recorded(world):
    poses = pk.drive(world, [wheels_for(["forward"])] * 15 + [wheels_for(["left"])] * 10)
    return pk.Drive(pk.scan(world, poses), np.zeros((len(poses), 2)))


def test_a_film_knows_after_each_scan_what_the_map_knew(recorded):
    film, grid = Film(recorded), pk.Grid()
    for number, known in enumerate(film.known):
        grid.add(recorded.scans[number : number + 1])
        assert set(map(tuple, film.cells[:known])) == set(map(tuple, grid.cells))
    last = pk.find_shapes(grid.points(), rng=0)
    assert [one.kind for one in film.looks[-1].found] == [one.kind for one in last]
    assert [look.n_scans for look in film.looks] == sorted({look.n_scans for look in film.looks})
    assert film.looks[-1].n_scans - 1 == np.flatnonzero(np.diff(film.known, prepend=0))[-1]


def test_a_film_is_sent_at_once_to_a_page_that_says_hello(world, recorded):
    player, sent = pk.replay(recorded, world), []
    player.send = lambda content, buffers=None: sent.append((content, buffers))
    player.answer({"do": "hello"})
    ((told, (ranges, cells)),) = sent
    ranges = np.frombuffer(ranges, "<i2").reshape(len(recorded), -1)
    hits = recorded.scans.hits
    np.testing.assert_allclose(ranges[hits] / 10_000, recorded.scans.ranges[hits], atol=5.1e-5)
    assert (ranges[~hits] == -1).all()
    np.testing.assert_array_equal(np.frombuffer(cells, "<i4").reshape(-1, 2), player.film.cells)
    assert len(told["poses"]) == len(told["known"]) == len(recorded)
    assert len(told["truths"]) == len(world.shapes)
    assert told["looks"][-1]["score"].endswith(
        f"{pk.evaluate(player.film.looks[-1].found, world).weighted_accuracy:.2f}"
    )
    player.close()


def test_without_the_truth_a_film_tells_none_of_it(recorded):
    player = pk.replay(recorded)
    assert player.told()["truths"] == []
    assert "score" not in player.told()["looks"][-1]["score"]
    player.close()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (([],), "drive must be a Drive, such as load_drive"),
        ((None, 3), "world must be a World"),
        ((None, None, "a"), "rng must be a seed"),
        (("none",), "a drive must have scans to be played, got none"),
    ],
)
def test_what_is_no_drive_is_not_played(recorded, arguments, message):
    drive, *others = arguments
    drive = {None: recorded, "none": pk.Drive(recorded.scans[:0], [])}.get(drive, drive) if drive != [] else drive
    with pytest.raises(ValueError, match=message):
        pk.replay(drive, *others[:1], **({"rng": others[1]} if others[1:] else {}))


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
    np.testing.assert_array_equal(drive.wheels, [STANDING_WHEELS, *wheels])
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
    wander(scene.state, 25)
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


def test_a_look_that_a_script_waited_for_is_shown(scene):
    scene.state.move(wheels_for(["forward"]))
    scene.state.finish()
    scene.answer({"do": "news"})
    assert len(scene.sent[-1][0]["shapes"]) == len(scene.state.found)
    scene.answer({"do": "news"})
    assert "shapes" not in scene.sent[-1][0]


def test_a_shape_is_named_when_it_is_found(scene):
    said = []
    for held in wandering(35):
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


def outlined(x, y):
    """Points a millimetre apart along the lower side and the right one of a rectangle of 200 x 100 mm."""
    return np.vstack([np.column_stack([x, 0 * x]), np.column_stack([0 * y + 0.2, y])])


def test_an_outline_is_drawn_as_it_was_seen():
    """Of a rectangle only two sides were seen; together the stretches are the whole outline."""
    shape = pk.Polygon([(0, 0), (0.2, 0), (0.2, 0.1), (0, 0.1)])
    points = outlined(np.arange(0, 0.2, 0.001), np.arange(0, 0.1, 0.001))
    told = describe_shape(Detection(shape, points, 0.0, sure=Certainty((), (0.001, float("inf")))))
    for seen, stretch in told["stretches"]:
        inner = np.array(stretch[2:-2]).reshape(-1, 2) / 10_000
        on = (np.abs(inner[:, 1]) < 0.013) | (np.abs(inner[:, 0] - 0.2) < 0.013)
        assert on.all() if seen else not on.any()
    ends = [stretch for _, stretch in told["stretches"]]
    assert all(a[-1] == b[0] for a, b in zip(ends, [*ends[1:], ends[0]], strict=True))
    assert {seen for seen, _ in told["stretches"]} == {True, False}


@pytest.mark.parametrize(
    ("certain", "sure", "name"),
    [
        (True, (0.001, 0.001), "rectangle, 200 x 100 mm"),
        (True, (0.001, float("inf")), "rectangle, 200 x ? mm"),
        (True, (), "rectangle, 200 x 100 mm"),
        (False, (0.001, 0.001), "not certain"),
    ],
    ids=["seen", "one side unmeasured", "measured by one's own fit", "not certain"],
)
def test_only_what_is_certain_has_a_name(certain, sure, name, monkeypatch):
    monkeypatch.setattr(Detection, "certain", certain)
    shape = pk.Polygon([(0, 0), (0.2, 0), (0.2, 0.1), (0, 0.1)])
    told = describe_shape(Detection(shape, shape.outline(200), 0.0, sure=Certainty((), sure)))
    assert (told["certain"], told["name"]) == (certain, name)


def test_what_is_no_shape_is_drawn_as_what_it_is():
    """A wall, a thing of no kind, and strays go to the page beside the shapes, and are told in words."""
    wall = Wall(np.array([-0.5, 0.5]), np.array([0.5, 0.5]), np.zeros((9, 2)), 0.0)
    other = Other(np.zeros((30, 2)), np.array([(0.0, 0.0), (0.1, 0.0), (0.0, 0.1)]))
    told = describe(Found([], [wall], [other], np.array([(0.2, -0.1)])))
    assert told["walls"] == [[[-5000, 5000], [5000, 5000]]]
    assert told["others"] == [[[0, 0], [1000, 0], [0, 1000], [0, 0]]]
    assert told["strays"] == [[2000, -1000]]
    assert told["rest"] == "1 wall, 1 thing of no kind, 1 stray"


def test_an_outline_of_any_size_can_be_drawn():
    """Whoever fits a circle as large as the earth still drives."""
    told = describe_shape(Detection(pk.Circle((0, 0), 6.4e6), np.zeros((0, 2)), float("nan")))
    assert sum(len(stretch) for _, stretch in told["stretches"]) < 3000


# One's own steps while driving.


def own_scene(world, executor=None, **steps):
    scene = Scene(DriveState(world, steps=pk.Steps(**steps), executor=executor))
    scene.sent = []
    scene.send = lambda content, _=None: scene.sent.append(content)
    return scene


def drive_round(scene, n):
    """Drive so many steps; return what the page heard of trouble."""
    for held in wandering(n):
        scene.answer({"do": "step", "held": held})
    return [message["trouble"] for message in scene.sent if message.get("trouble")]


def too_large(points):
    (x, y), radius = points.mean(axis=0), 0.2
    return x, y, radius


def divides(points):
    return 1 / (len(points) - len(points))


def for_ever(points):
    while len(points):
        pass


def exits(_points):
    raise SystemExit


NONE_OF_ITS_POINTS = "fit_circle returns a circle that lies on none of its points; the drive goes on."
ROUND = pk.World([pk.Circle((0.25, 0.0), 0.08)])


def test_what_the_robot_sees_is_what_one_s_own_step_makes_of_it():
    scene = own_scene(ROUND, fit_circle=too_large)
    assert set(drive_round(scene, 40)) <= {NONE_OF_ITS_POINTS}
    assert {one.shape.radius for one in scene.state.found if one.kind == "circle"} == {0.2}


def midway(ring):
    """Places along the straight pieces of an outline."""
    corners, shares = np.array(ring, dtype=float), np.linspace(0, 1, 50, endpoint=False)[:, None]
    return np.vstack([a + shares * (b - a) for a, b in pairwise(corners)])


def invented(scene):
    """The share of all that is drawn as an outline that lies farther than 2 cm from every true one; nothing: None."""
    drawn = scene.state.last.drawn
    rings = [stretch for shape in drawn["shapes"] for _, stretch in shape["stretches"]]
    rings += map(midway, drawn["others"])
    if not rings:
        return None
    apart = [np.abs(shape.signed_distance(np.vstack(rings) / 10_000)) for shape in scene.state.world.shapes]
    return np.mean(np.min(apart, axis=0) > 0.02)


def turned(points):
    line = pk.fit_line(points)
    return line.angle + 0.3, line.offset


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ({"segment": lambda points, _: pk.link(points)}, {"segment": lambda points, _: (points[:, 0] > 0).astype(int)}),
        (
            {"segment": lambda points, _: pk.kmeans(points, 4, rng=0)},
            {"segment": lambda points, _: np.arange(len(points)) % 3},
        ),
        ({"fit_line": pk.fit_line}, {"fit_line": turned}),
        ({"fit_circle": pk.fit_circle}, {"fit_circle": lambda points: (*points.mean(axis=0), 0.2)}),
        (
            {"measure": lambda points: pk.measure_shape(points, 0.0004).shape},
            {"measure": lambda points: pk.Circle(points.mean(axis=0), 0.2)},
        ),
    ],
    ids=["linking", "K-Means", "line", "circle", "measure"],
)
def test_a_wrong_step_invents_what_is_not_there_or_explains_nothing(right, wrong):
    """The same scans with a right step and with a wrong one."""
    world = pk.random_world(4, kinds=["circle", "circle", "rectangle", "triangle"], rng=2)
    shares, strays = [], []
    for steps in (right, wrong):
        scene = own_scene(world, **steps)
        scene.state._mapper.add(pk.scan(world, pk.teleport_poses(world)))
        scene.state.finish()
        shares.append(invented(scene))
        strays.append(len(scene.state.found.strays) / len(scene.state.grid))
    assert shares[0] == 0.0
    assert strays[0] < 0.02
    assert strays[1] > 0.9 if shares[1] is None else shares[1] > 0.1


def test_a_score_of_one_s_own_stands_beside_the_library_s(world):
    """A judge that asks for too little is seen to flatter; one that is right says the same; what it raises is told."""
    judges = {
        "right": lambda found, world: pk.evaluate(found, world).weighted_accuracy,
        "generous": lambda found, world: min(1.0, len(found) / len(world.shapes)),
    }
    for name, judge in judges.items():
        scene = own_scene(world, executor=Later(), score=judge)
        drive_round(scene, 40)
        scene.state.finish()
        state = scene.state
        assert scene._score().endswith(f"score {state.score:.2f}, yours {state.last.own_score:.2f}")
        assert (state.last.own_score == state.score) == (name == "right")
    raising = own_scene(world, score=lambda _found, _world: 1 / 0)
    assert drive_round(raising, 5)[-1].startswith("score raises ZeroDivisionError")


def test_a_segmentation_of_one_s_own_is_not_mended(world):
    """Grouped left and right of the middle, four shapes are never found; a second opinion would find them."""
    halves = pk.Steps(segment=lambda points, _: (points[:, 0] > 0).astype(int))
    mended, scans = pk.Mapper(steps=halves, rng=0), pk.scan(world, pk.teleport_poses(world))[::2]
    mended.add(scans)
    scene = own_scene(world, segment=halves.segment)
    scene.state._mapper.add(scans)
    scene.state.finish()
    assert len(scene.state.found) + len(scene.state.found.others) <= 2 < len(mended.found)
    assert scene.state.score < pk.evaluate(mended.found, world).weighted_accuracy - 0.3
    film = pk.replay(pk.Drive(scans, np.zeros((36, 2))), world, steps=halves)
    assert pk.evaluate(film.film.looks[-1].found, world).weighted_accuracy == scene.state.score
    film.close()


@pytest.mark.parametrize(
    ("steps", "sentence"),
    [
        ({"fit_circle": divides}, "fit_circle raises ZeroDivisionError: division by zero, in line "),
        (
            {"fit_circle": lambda _: "round"},
            "fit_circle must return a Circle, (x, y, radius) or None, got 'round'; the ",
        ),
        (
            {"fit_circle": lambda _: (5.0, 5.0, 0.1)},
            "fit_circle returns a circle that lies on none of its points; the ",
        ),
        (
            {"measure": lambda p: (pk.Circle(p.mean(axis=0) + 5, 0.1), 99)},
            "measure returns a circle that lies on none of its points; the ",
        ),
        ({"segment": lambda _, __: None}, "segment must return a whole number for each of the "),
        ({"fit_circle": exits}, "fit_circle raises SystemExit"),
        ({"fit_circle": for_ever}, "fit_circle did not end, and was stopped after 0.2 s, in line "),
    ],
    ids=["raises", "another type", "elsewhere", "measured elsewhere", "nothing", "exit", "for ever"],
)
def test_what_is_wrong_with_one_s_own_step_is_told_and_one_drives_on(steps, sentence, monkeypatch):
    monkeypatch.setattr("primkit.scene.own_steps.LONGEST", 0.2)
    scene = own_scene(ROUND, **steps)
    told = drive_round(scene, 3)
    assert told
    assert all(words.startswith(sentence) and words.endswith("; the drive goes on.") for words in told)
    assert scene.state.n_scans == 4


def test_the_sentence_goes_once_the_step_does():
    scene, broken = own_scene(ROUND, fit_circle=lambda points: 1 / 0 if broken else pk.fit_circle(points)), True
    assert drive_round(scene, 3)
    broken = False
    drive_round(scene, 6)
    assert scene.sent[-1]["trouble"] == ""


def test_the_robot_does_not_wait_for_a_slow_step(monkeypatch):
    """While a step takes its time, the drive goes on; the shapes tell their age, and the step its time."""
    monkeypatch.setattr("primkit.scene.own_steps.SLOW", 0.05)
    go_on = threading.Event()
    scene = own_scene(ROUND, executor=Beside(), fit_circle=lambda points: go_on.wait(10) and too_large(points))
    scene.answer({"do": "news"})
    begun = time.monotonic()
    drive_round(scene, 12)
    assert time.monotonic() - begun < 5
    time.sleep(0.1)
    scene.answer({"do": "news"})
    assert "shapes 1.2 s old" in scene.sent[-3]["score"]
    assert re.fullmatch(r"fit_circle has been at work for \d s; the drive goes on\.", scene.sent[-1]["trouble"])
    assert scene.sent[-1]["busy"]
    go_on.set()
    scene.state.finish()
    assert scene.state.n_scans_found == scene.state.n_scans
    scene.close()


def test_without_threads_looks_leave_most_of_the_time_to_the_robot(world, monkeypatch):
    """In a browser a look makes the robot wait: while a key is held, there are fewer of them."""
    monkeypatch.setattr(threading.Thread, "start", no_thread)
    looks = []
    for share in (0.2, 1e9):
        monkeypatch.setattr("primkit.scene.scene.LOOKING_SHARE", share)
        scene = own_scene(world, executor=Beside(), segment=slow_halves)
        before = scene.state.n_scans_found
        drive_round(scene, 12)
        looks.append(len({message["score"] for message in scene.sent if "shapes" in message}))
        scene.answer({"do": "step", "held": []})
        assert scene.state.n_scans_found > before
        assert not scene.state.looks, "who stands still sees all"
        scene.close()
    assert 1 <= looks[0] < looks[1]


def no_thread(_self):
    raise RuntimeError("can't start new thread")


def slow_halves(points, _):
    time.sleep(0.02)
    return (points[:, 0] > 0).astype(int)


def test_steps_that_are_none_are_refused(world):
    with pytest.raises(ValueError, match=r"steps must be Steps, such as Steps\(fit_circle=mine\), got int"):
        pk.drive_scene(world, steps=3)


# A cell that runs again gives back what it made before.


def test_a_cell_that_runs_again_closes_what_it_showed(world, monkeypatch):
    runs = iter([("a", "1"), ("a", "1"), ("b", "2"), ("a", "3"), ("a", "4")])
    monkeypatch.setattr("primkit.scene.given_back._this_run", lambda: next(runs))
    scenes = [Scene(DriveState(world)) for _ in range(2)]
    assert [scene.comm is None for scene in scenes] == [False, False], "what one run made stays together"
    scenes += [Scene(DriveState(world)) for _ in range(2)]
    assert [scene.comm is None for scene in scenes] == [True, True, False, False]
    drive = pk.Drive(pk.scan(world, [(0, 0, 0)]), [(0, 0)])
    film = pk.replay(drive)
    assert [scene.comm is None for scene in scenes] == [True, True, False, True]
    for one in (scenes[2], film):
        one.close()
