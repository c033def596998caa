"""What robots recorded: every reader through one table of rules; bags, logs and tables come back as what was seen."""

import gzip
import re
import sys
from types import SimpleNamespace as Namespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import primkit as pk
from primkit.arguments import LikelyWrong
from primkit.formats.bags import _matrix
from primkit.installed import install_line
from tests.filing import refusal, written
from tests.recorded import BAGS, Bag, carmen_log, driven_bag, table, write_log

BOARD = pk.random_world(4, rng=7)
POSES = [(x, y, 0.5 * x) for x in (-0.45, 0.0, 0.45) for y in (-0.45, 0.0, 0.45)]
bags = pytest.mark.parametrize("kind", BAGS)


@pytest.fixture
def needs_rosbags():
    pytest.importorskip("rosbags", reason="rosbags, which reads bags, is not installed")


# --- one table of rules -------------------------------------------------------------------------------------


def hits_by_the_rules(ranges, range_min, range_max):
    """The rules once more, reading by reading."""
    kept = []
    for r in ranges:
        hit = r == r and r > 0 and not r < range_min and r < range_max
        kept.append(r if hit else float("inf"))
    return kept


MIN, MAX = 0.25, 4.0  # float32 holds both exactly
readings = st.lists(
    st.one_of(
        st.sampled_from([0.0, -1.0, float("nan"), float("inf"), -float("inf"), MIN, MAX, 2 * MAX, 0.125, 5e-324]),
        st.floats(0.0625, 9.0, width=32),
        st.sampled_from([np.nextafter(np.float32(v), np.float32(w)).item() for v in (MIN, MAX) for w in (0, 9)]),
    ),
    min_size=2,
    max_size=40,
)


def read_log(folder, lidar, ranges):
    """FLASER: the lidar tells angles and limits."""
    return pk.load_scans(write_log(folder / "a.log.gz", [(0, 0, 0)], [ranges], digits=60), lidar=lidar)


def read_robotlaser(folder, lidar, ranges):
    told = {"laser": "ROBOTLASER1", "start": lidar.angle_min, "step": lidar.angle_increment, "range_max": MAX}
    return pk.load_scans(write_log(folder / "a.log", [(0, 0, 0)], [ranges], digits=60, **told), lidar=lidar)


def read_table(folder, lidar, ranges):
    angles = -lidar.angles if lidar.clockwise else lidar.angles
    rows = [f"{angle!r};{r!r}" for angle, r in zip(angles.tolist(), ranges, strict=True)]
    (folder / "a.csv").write_text("\n".join(["theta (rad);range [m]", *rows, ""]))
    return pk.load_scans(folder / "a.csv", lidar=lidar)


def read_from_bag(kind):
    def read(folder, lidar, ranges):
        pytest.importorskip("rosbags", reason="rosbags, which reads bags, is not installed")
        bag = Bag(folder, kind)
        bag.scan(1.0, lidar, ranges)
        return pk.load_scans(bag.close())

    return read


READERS = {"flaser": read_log, "robotlaser": read_robotlaser, "csv": read_table} | {k: read_from_bag(k) for k in BAGS}


@pytest.mark.parametrize("reader", READERS)
@settings(max_examples=15, deadline=None)
@given(ranges=readings, clockwise=st.booleans(), both_ends=st.booleans(), half=st.booleans())
def test_every_reader_goes_by_the_table(tmp_path_factory, reader, ranges, clockwise, both_ends, half):
    fov, start = (np.pi, -np.pi / 2) if half else (2 * np.pi, 0.0)
    lidar = pk.Lidar(len(ranges), MIN, MAX, fov=fov, angle_min=start, clockwise=clockwise, both_ends=both_ends)
    seen = READERS[reader](tmp_path_factory.mktemp("one"), lidar, ranges)
    np.testing.assert_array_equal(seen.ranges, [hits_by_the_rules(ranges, MIN, MAX)])
    np.testing.assert_allclose(seen.angles, lidar.angles, rtol=0, atol=2e-6)  # a bag tells its step as a float32


# --- bags ---------------------------------------------------------------------------------------------------


@bags
@pytest.mark.usefixtures("needs_rosbags")
def test_a_drive_comes_back_from_a_bag(tmp_path, kind):
    """Every point within a micrometre, and the same shapes, whatever way the sensor turns and is mounted."""
    lidar = pk.Lidar(120, 0.05, 0.35, clockwise=True, angle_min=1.0)
    seen = pk.scan(BOARD, pk.teleport_poses(BOARD)[::3], lidar)
    back = pk.load_scans(driven_bag(tmp_path, kind, seen, lidar, mounted=(0.05, -0.02, 2.5)))
    np.testing.assert_array_equal(back.hits, seen.hits)
    assert np.abs(back.points() - seen.points()).max() < 1e-6
    kinds = [[one.kind for one in pk.find_shapes(scans.points(), rng=0)] for scans in (seen, back)]
    assert kinds[0] == kinds[1]
    assert len(kinds[0]) >= 2


@bags
@pytest.mark.usefixtures("needs_rosbags")
def test_a_laser_that_hangs_upside_down_is_turned_round(tmp_path, kind):
    lidar, ranges = pk.Lidar(4, 0.05, 9.0), [1.0, 2.0, 3.0, 4.0]
    bag = Bag(tmp_path, kind)
    bag.transform("base", "link", (0.2, 0.0), yaw=np.pi / 2)
    bag.transform("link", "/laser", (0.5, 0.0), roll=np.pi)  # two hops; older bags begin names with a stroke
    bag.odometry(1.0, (1.0, 1.0, np.pi / 2))
    bag.scan(1.0, lidar, ranges)
    points = pk.load_scans(bag.close()).points()
    np.testing.assert_allclose(points, [(-0.5, 1.2), (0.5, 3.2), (3.5, 1.2), (0.5, -2.8)], atol=1e-6)


@bags
@pytest.mark.usefixtures("needs_rosbags")
def test_what_a_bag_does_not_tell_is_said(tmp_path, kind):
    lidar = pk.Lidar(4, 0.05, 9.0)
    bag = Bag(tmp_path, kind)
    bag.transform("base", "laser", (0.5, 0.0), time=1.0, topic="/tf")
    bag.transform("base", "laser", (0.6, 0.0), time=2.0, topic="/tf")  # it moves: no mounting
    bag.odometry(1.0, (1.0, 0.0, 0.0))
    for time in (1.0, 1.5, 1.6):
        bag.scan(time, lidar, [1.0] * 4)
    path = bag.close()
    with pytest.warns(LikelyWrong) as told:
        assert pk.load_scans(path).poses.tolist() == [[1.0, 0.0, 0.0]] * 2
    assert [str(one.message) for one in told] == [
        "nothing tells how 'laser' is mounted: it is taken to lie where the odometry says",
        "1 of 3 scans have no odometry within 0.5 s: they are left out",
    ]
    assert {one.filename for one in told} == {__file__}


@bags
@pytest.mark.usefixtures("needs_rosbags")
def test_of_two_lasers_one_must_be_told(tmp_path, kind):
    lidar = pk.Lidar(4, 0.05, 9.0)
    bag = Bag(tmp_path, kind)
    for topic, reach in (("/front", 1.0), ("/rear", 2.0)):
        bag.scan(1.0, lidar, [reach] * 4, topic=topic)
    path = bag.close()
    rule = "must be read by one topic of laser scans at a time, got /front, /rear: tell which one as topic"
    assert refusal(pk.load_scans, path) == f"{path.name}: {rule}"
    sentence = f"{path.name}: must hold the topic '/scann', got /front, /rear"
    assert refusal(pk.load_scans, path, topic="/scann") == sentence
    assert pk.load_scans(path, topic="/rear").ranges.tolist() == [[2.0] * 4]  # no odometry: it stands still


@bags
@pytest.mark.usefixtures("needs_rosbags")
def test_a_sensor_that_turns_unevenly(tmp_path, kind):
    """Sweeps of other angles share a row; each is silent where the others' angles stand."""
    bag, lidars = Bag(tmp_path, kind), [pk.Lidar(n, 0.05, 9.0) for n in (4, 5, 4)]
    for time, lidar in enumerate(lidars, start=1):
        bag.scan(float(time), lidar, [1.0 * time] * lidar.beams)
    seen = pk.load_scans(bag.close())
    assert [np.round(row[hit], 3).tolist() for row, hit in zip(seen.ranges, seen.hits, strict=True)] == [
        *([1.0] * 4, [2.0] * 5, [3.0] * 4)
    ]
    np.testing.assert_allclose(seen.angles[seen.hits[1]], lidars[1].angles, atol=1e-6)


@pytest.mark.usefixtures("needs_rosbags")
@pytest.mark.parametrize("name", ["a.bag", "a.db3", "a.mcap"])
def test_what_is_no_bag_is_refused(tmp_path, name):
    for content in (b"", b"#ROSBAG V2.0\n", b"SQLite format 3\0" + bytes(200), b"\x89MCAP0\r\n", bytes(500)):
        assert re.match(f"{name}: must (be|hold)", refusal(pk.load_scans, written(tmp_path, content, name)))
    (tmp_path / "folder").mkdir()
    sentence = "folder: must be a bag, or a folder with a .db3 or .mcap file, got neither"
    assert refusal(pk.load_scans, tmp_path / "folder") == sentence
    assert "no such file" in refusal(pk.load_scans, tmp_path / f"none_{name}", error=FileNotFoundError)


@pytest.mark.parametrize(("component", "told"), [(0.1, "0.2"), (1e200, "2e+200"), (1.7e308, "inf"), (np.nan, "nan")])
def test_what_is_no_rotation_is_refused_without_a_warning(component, told):
    turn, place = Namespace(x=component, y=component, z=component, w=component), Namespace(x=0, y=0, z=0)
    assert refusal(_matrix, place, turn) == f"a quaternion must have the norm 1, got {told}"


def test_without_rosbags_one_sentence_says_so(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "rosbags", None)
    monkeypatch.setitem(sys.modules, "rosbags.rosbag1", None)
    sentence = f"a.bag: a bag needs rosbags, which is not installed: {install_line('ros')}"
    assert refusal(pk.load_scans, written(tmp_path, b"", "a.bag")) == sentence


# --- logs ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("beams", "first", "last"),
    [(360, -90.0, 89.5), (361, -90.0, 90.0), (180, -90.0, 89.0), (181, -90.0, 90.0), (1, -90.0, -90.0)],
)
def test_a_log_spreads_its_beams_over_half_a_turn(tmp_path, beams, first, last):
    seen = pk.load_scans(write_log(tmp_path / "a.log", [(1, 2, 0.5)], [[1.0] * beams]))
    np.testing.assert_allclose(np.degrees(seen.angles[[0, -1]]), [first, last], atol=1e-9)
    assert seen.poses.tolist() == [[1.0, 2.0, 0.5]]


def test_a_corridor_with_pillars_comes_back_from_a_log(tmp_path):
    """The twin of a classic recording: half a turn, ranges in whole centimetres, cells of 1 cm."""
    pillars = [pk.Circle((x, y), 0.2) for x, y in ((-1.5, 1.0), (0.0, 1.0), (1.5, 1.0))]
    world, lidar = (
        pk.World(pillars, size=8.0, walls=True),
        pk.Lidar(360, 0.05, 20.0, noise_std=0.005, fov=np.pi, angle_min=-np.pi / 2, range_step=0.01),
    )
    poses = [(x, y, heading) for x in (-2.5, 0.0, 2.5) for y, heading in ((-0.5, np.pi / 2), (2.5, -np.pi / 2))]
    seen = pk.scan(world, poses, lidar, rng=1)
    back = pk.load_scans(write_log(tmp_path / "a.log.gz", seen.poses, np.minimum(seen.ranges, 81.91), digits=2))
    np.testing.assert_array_equal(back.hits, seen.hits)
    assert np.abs(back.points() - seen.points()).max() < 1e-9
    grid = pk.Grid(0.01)
    grid.add(back)
    found = pk.find_shapes(grid, rng=0)
    certain = [one for one in found if one.certain]
    assert len(found.walls) >= 4
    for one in certain:  # what is certain is a pillar, and where it says
        truth = min(pillars, key=lambda pillar: np.hypot(*(pillar.center - one.shape.centroid)))
        assert one.kind == "circle"
        assert np.abs(one.shape.center - truth.center).max() < 0.01
        assert abs(one.shape.radius - 0.2) < 0.01
    assert len(certain) == 3


LOG_FAILURES = {
    "nothing": (b"", "must hold at least one scan, got none"),
    "no scans": (b"ODOM 0 0 0 0 0 0 1 h 1\n", "must hold at least one scan, got none"),
    "no count": (b"FLASER\n", "line 1: must tell how many numbers follow, got None"),
    "a wrong count": (b"FLASER x 1 2\n", "line 1: must tell how many numbers follow, got b'x'"),
    "too few": (b"FLASER 3 1 2\n", "line 1: must hold 3 numbers, got 2"),
    "no number": (b"\nFLASER 2 1 x 0 0 0\n", "line 2: must hold 2 numbers, got b'1 x'"),
    "no pose": (b"FLASER 2 1 2 0 0\n", "line 1: must hold 3 numbers, got 2"),
    "a wild pose": (b"FLASER 2 1 2 nan 0 0\n", "poses must be finite, got nan"),
    "no ranges": (b"FLASER 0 0 0 0\n", "line 1: must have at least one range, got none"),
}


@pytest.mark.parametrize(("content", "sentence"), LOG_FAILURES.values(), ids=LOG_FAILURES)
def test_what_is_no_log_is_refused(tmp_path, content, sentence):
    assert refusal(pk.load_scans, written(tmp_path, content, "a.log")) == f"a.log: {sentence}"


def test_a_log_of_two_lasers_or_of_another_one_is_refused(tmp_path):
    other = {"laser": "ROBOTLASER1", "start": 0.0, "step": 0.1}
    both = carmen_log([(0, 0, 0)], [[1.0, 2.0]]) + carmen_log([(0, 0, 0)], [[3.0, 4.0]], **other)
    path = written(tmp_path, both, "a.log")
    assert "got FLASER, ROBOTLASER1: tell which one as topic" in refusal(pk.load_scans, path)
    assert pk.load_scans(path, topic="ROBOTLASER1").ranges.tolist() == [[3.0, 4.0]]
    sentence = "a.log: line 3: must have the lidar's 360 ranges, got 2"
    assert refusal(pk.load_scans, path, topic="FLASER", lidar=pk.LDS_01) == sentence


def test_a_log_that_cannot_be_unpacked_is_refused(tmp_path, monkeypatch):
    damaged = gzip.compress(carmen_log([(0, 0, 0)], [[1.0]]))[:-9]
    sentence = "a.log.gz: must be a log packed by gzip, got one that cannot be unpacked"
    assert refusal(pk.load_scans, written(tmp_path, damaged, "a.log.gz")) == sentence
    for module in ("carmen", "recordings"):
        monkeypatch.setattr(f"primkit.formats.{module}.RECORDING_LIMIT", 10_000)
    bomb = written(tmp_path, gzip.compress(bytes(10_001)), "b.log.gz")
    assert refusal(pk.load_scans, bomb) == "b.log.gz: must unpack to at most 10,000 bytes, got 10,001"
    many = write_log(tmp_path / "c.log.gz", [(0, 0, 0)] * 12, [np.ones(n) for n in range(10, 22)], digits=1)
    assert refusal(pk.load_scans, many) == "c.log.gz: must unpack to at most 10,000 bytes, got 17,856"


# --- tables -------------------------------------------------------------------------------------------------

RAW = "90,1000,15\n180,0,0\n270,,0\n0,500,15\n"


@pytest.mark.parametrize(
    ("text", "told", "points"),
    [
        ("angle_deg,distance_mm,quality\n" + RAW, {}, [(0, 1), (0.5, 0)]),
        ("angle_deg,distance_mm,quality\n" + RAW, {"lidar": pk.RPLIDAR_A1}, [(0, -1), (0.5, 0)]),
        ("Angle [°]\tDistance [cm]\n90\t50\n", {}, [(0, 0.5)]),
        ("angle,distance\n90,1.5\n", {"units": ("deg", "m")}, [(0, 1.5)]),
        ('\ufeff"distance (m)";"theta (rad)"\n2;0\n', {}, [(2, 0)]),
        ("quality,angle_deg,distance_m,is_valid_hint\n68,0,3.5,1\n9,90,10.8,0\n", {}, [(3.5, 0)]),
        ("angle_deg,distance_m\n0,12\n0,0.1\n0,11\n", {"lidar": pk.RPLIDAR_A1}, [(11, 0)]),
    ],
    ids=["plain", "clockwise", "tabs", "units told", "other order", "not valid", "limits"],
)
def test_a_table_is_one_scan(tmp_path, text, told, points):
    path = written(tmp_path, text, "a.csv")
    np.testing.assert_allclose(pk.load_scans(path, **told).points(), points, atol=1e-12)


CSV_FAILURES = {
    "nothing": ("", "must have one column for the angle, with angle or theta or bearing in its name, got 0"),
    "no header": ("0,1\n1,2\n", "must have one column for the angle"),
    "two distances": (
        "angle,dist,range\n",
        "must have one column for the distance, with dist or range in its name, got 2",
    ),
    "no unit": ("angle,distance\n0,1\n", "must tell the unit of 'angle' in the header, or as units: one of deg, "),
    "no number": ("angle_deg,distance_m\n0,far\n", "line 2: must hold an angle and a distance, got '0' and 'far'"),
    "no angle": ("angle_deg,distance_m\n0,1\n,1\n", "line 3: must hold an angle and a distance, got '' and '1'"),
    "no rows": ("angle_deg,distance_m\n", "must hold at least one scan, got none"),
    "a wild angle": ("angle_deg,distance_m\ninf,1\n", "angles must be finite, got inf"),
    "no text": (b"\xff\xfe\n", "must be text in UTF-8, got something else"),
}


@pytest.mark.parametrize(("content", "sentence"), CSV_FAILURES.values(), ids=CSV_FAILURES)
def test_what_is_no_table_is_refused(tmp_path, content, sentence):
    assert refusal(pk.load_scans, written(tmp_path, content, "a.csv")).startswith(f"a.csv: {sentence}")


def test_a_table_of_a_scan_comes_back(tmp_path):
    seen = pk.scan(BOARD, POSES[:1], pk.Lidar(beams=90))
    path = written(tmp_path, table(seen.angles, np.where(seen.hits, seen.ranges, 0)[0]), "a.csv")
    moved = seen.points() - seen.poses[0, :2]
    turn = seen.poses[0, 2]
    expected = moved @ np.array([(np.cos(turn), -np.sin(turn)), (np.sin(turn), np.cos(turn))])
    np.testing.assert_allclose(pk.load_scans(path).points(), expected, atol=1e-9)
