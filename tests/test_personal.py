"""Personal maps: the same on every computer, no two alike, equally hard; and nothing of id or salt in a file."""

import io
import re
import zipfile

import numpy as np
import pytest
from scipy.spatial.distance import pdist

import primkit as pk
from primkit.course.personal import personal_scans
from tests.benchmarks.thousand_maps import accuracy, numbers

SALT = "0123456789abcdef"
IDS = [f"student-{k:04d}" for k in range(1000)]

# Written down once: a student's map must not change from one release, or one computer, to the next.
ADA = {
    "circle": ([-0.181976517, -0.192963829], [0.065575277]),
    "rectangle": ([0.231387928, 0.176438793], [0.137495906, 0.109188605]),
    "triangle": ([-0.196200116, 0.227690831], [0.12796632, 0.157931925, 0.170843964]),
    "pentagon": ([0.197302399, -0.232784861], [0.094574998, 0.112280469, 0.100462578, 0.115694354, 0.104358865]),
}


@pytest.fixture(scope="module")
def worlds():
    return [pk.personal_world(name, salt=SALT) for name in IDS]


def test_a_map_stays_the_same():
    world = pk.personal_world("ada", salt=SALT)
    assert [shape.kind for shape in world.shapes] == list(ADA)
    for shape, (center, dimensions) in zip(world.shapes, ADA.values(), strict=True):
        assert np.allclose(shape.centroid, center, rtol=0, atol=1e-9)
        assert np.allclose(shape.dimensions, dimensions, rtol=0, atol=1e-9)


def test_the_same_name_written_in_two_ways_is_the_same():
    assert pk.personal_world("Zoë", salt=SALT) == pk.personal_world("Zoe\N{COMBINING DIAERESIS}", salt=SALT)


def test_id_and_salt_both_count():
    ada = pk.personal_world("ada", salt=SALT)
    assert ada != pk.personal_world("Ada", salt=SALT)
    assert ada != pk.personal_world("ada", salt=SALT + "0")


def test_no_two_of_a_thousand_are_alike(worlds):
    assert pdist(np.array([numbers(world) for world in worlds]), "chebyshev").min() > 0.01


def test_all_are_equally_hard_by_the_way_they_are_made(worlds):
    for world in worlds:
        assert sorted(shape.kind for shape in world.shapes) == ["circle", "pentagon", "rectangle", "triangle"]
        assert world.least_gap() >= 0.15
        for shape in world.shapes:
            if isinstance(shape, pk.Circle):
                assert 0.06 <= shape.radius <= 0.09
                assert (np.abs(shape.center) + shape.radius <= 0.38).all()
                continue
            sides = np.hypot(*(np.roll(shape.vertices, -1, axis=0) - shape.vertices).T)
            assert sides.min() >= 0.06
            assert sides.max() <= 0.20
            assert np.abs(shape.vertices).max() <= 0.38


def corners(shape):
    """Interior angles in degrees."""
    ahead = np.roll(shape.vertices, -1, axis=0) - shape.vertices
    back = np.roll(shape.vertices, 1, axis=0) - shape.vertices
    cosine = (ahead * back).sum(axis=1) / (np.hypot(*ahead.T) * np.hypot(*back.T))
    return np.degrees(np.arccos(cosine))


def test_every_corner_can_be_told(worlds):
    band = {"triangle": (40, 80), "rectangle": (90, 90), "pentagon": (84, 132)}
    for world in worlds:
        for shape in world.shapes[1:]:
            least, most = band[shape.kind]
            assert least - 1e-6 <= corners(shape).min()
            assert corners(shape).max() <= most + 1e-6


def test_every_quadrant_gets_every_kind(worlds):
    places = {(shape.kind, *np.sign(shape.centroid).astype(int)) for world in worlds for shape in world.shapes}
    assert len(places) == 16


def test_the_reference_is_right_on_a_sample(worlds):
    """On all thousand: python -m tests.benchmarks.thousand_maps."""
    assert [accuracy(world) for world in worlds[::50]] == [1.0] * 20


def test_a_file_of_scans_holds_neither_id_nor_salt(tmp_path):
    name, salt = "a-student-with-a-long-id", "a-salt-that-is-easy-to-find"
    path = tmp_path / "my_scans.npz"
    pk.save_scans(personal_scans(pk.personal_world(name, salt=salt)), path)
    data = path.read_bytes()
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        data += b"".join(archive.read(member) for member in archive.namelist())
        assert sorted(archive.namelist()) == ["angles.npy", "inside.npy", "poses.npy", "ranges.npy"]
        assert {info.date_time for info in archive.infolist()} == {(1980, 1, 1, 0, 0, 0)}  # not even when
    for secret in (name, salt):
        for encoding in ("utf-8", "utf-16-le", "utf-32-le"):
            assert secret.encode(encoding) not in data
    assert pk.load_scans(path).ranges.shape == personal_scans(pk.personal_world(name, salt=salt)).ranges.shape


@pytest.mark.parametrize(
    ("student_id", "salt", "sentence"),
    [
        ("", SALT, "student_id must be a text that is not empty, got ''"),
        ("  ", SALT, "student_id must be a text that is not empty, got '  '"),
        (7, SALT, "student_id must be a text that is not empty, got 7"),
        ("ada", "fifteen letters", "salt must be a text of at least 16 characters, got 15"),
        ("ada", b"0123456789abcdef", "salt must be a text of at least 16 characters, got bytes"),
    ],
)
def test_what_makes_no_map_is_refused(student_id, salt, sentence):
    with pytest.raises(ValueError, match=f"^{re.escape(sentence)}$"):
        pk.personal_world(student_id, salt=salt)
