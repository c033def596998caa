"""Scans to NumPy archives and back: equal to the last bit, nothing run, nothing unpacked beyond the limit."""

import dataclasses
import io
import struct
import zipfile

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from primkit import formats
from primkit.formats import load_scans, save_scans
from primkit.lidar import Lidar, Scans, scan
from primkit.world import random_world
from tests.filing import a_scan, answer, refusal, written


def npz(**arrays):
    """Arrays as an .npz archive's bytes; those of scans of two poses, unless others are given, or None."""
    seen = a_scan()
    arrays = {field: getattr(seen, field) for field in formats.scans.SCAN_SHAPES} | arrays
    buffer = io.BytesIO()
    np.savez_compressed(buffer, **{name: array for name, array in arrays.items() if array is not None})
    return buffer.getvalue()


def npy(header, data=b"", version=b"\x01\x00"):
    """An .npy file's bytes with any header."""
    header = header.encode().ljust(117) + b"\n"
    return b"\x93NUMPY" + version + struct.pack("<H", len(header)) + header + data


def archive(**members):
    """An archive's bytes with these members, whatever is in them."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as file:
        for name in formats.scans.SCAN_SHAPES:
            file.writestr(
                f"{name}.npy", members.get(name, npy("{'descr': '<f8', 'fortran_order': False, 'shape': ()}"))
            )
    return buffer.getvalue()


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 2**32), beams=st.integers(1, 200), n=st.integers(0, 20), noise=st.sampled_from([0.0, 0.003]))
def test_scans_come_back_to_the_last_bit(tmp_path_factory, seed, beams, n, noise):
    path = tmp_path_factory.mktemp("scans") / "drive.npz"
    poses = np.random.default_rng(seed).uniform(-0.5, 0.5, (n, 3))
    seen = scan(random_world(4, rng=seed), poses, Lidar(beams=beams, noise_std=noise, spurious=0.1), rng=seed)
    save_scans(seen, path)
    back = load_scans(path)
    for field in dataclasses.fields(Scans):
        was, now = getattr(seen, field.name), getattr(back, field.name)
        assert (now.dtype, now.shape, now.tobytes()) == (was.dtype, was.shape, was.tobytes())


def test_every_field_of_scans_is_in_the_file():
    assert [field.name for field in dataclasses.fields(Scans)] == list(formats.scans.SCAN_SHAPES)


def test_the_same_scans_give_the_same_bytes(tmp_path):
    for name in ("a.npz", "b.NPZ"):
        save_scans(a_scan(), tmp_path / name)
    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b.NPZ").read_bytes()


def test_plain_numpy_reads_scans(tmp_path):
    save_scans(a_scan(), tmp_path / "a.npz")
    with np.load(tmp_path / "a.npz", allow_pickle=False) as arrays:
        assert sorted(arrays) == sorted(formats.scans.SCAN_SHAPES)
        assert np.array_equal(arrays["ranges"], a_scan().ranges)


@pytest.mark.parametrize(
    "changed",
    [
        pytest.param({"ranges": np.ones((2, 100), dtype=np.float32)}, id="single precision"),
        pytest.param({"ranges": np.ones((2, 100), dtype=">i2")}, id="whole numbers of a foreign machine"),
        pytest.param({"ranges": np.asfortranarray(np.ones((2, 100)))}, id="Fortran's order"),
        pytest.param({"time": np.zeros(7)}, id="one more array"),
        pytest.param({"note": np.array([{"a": 1}], dtype=object)}, id="one more array that would run code"),
    ],
)
def test_scans_written_by_others_are_read(tmp_path, changed):
    seen = load_scans(written(tmp_path, npz(**changed), "a.npz"))
    assert {getattr(seen, field).dtype.str for field in ("poses", "angles", "ranges")} == {"<f8"}
    assert np.array_equal(seen.ranges, changed.get("ranges", a_scan().ranges))


def test_a_header_of_an_old_numpy_is_read_without_a_warning(tmp_path):
    old = npy("{'descr': '<f8', 'fortran_order': False, 'shape': (0L, 3L)}")
    header = "{'descr': '%s', 'fortran_order': False, 'shape': %s}"
    content = archive(
        poses=old,
        angles=npy(header % ("<f8", "(0,)")),
        ranges=npy(header % ("<f8", "(0, 0)")),
        inside=npy(header % ("|b1", "(0,)")),
    )
    assert len(load_scans(written(tmp_path, content, "a.npz"))) == 0


DAMAGED = "a.npz: must be an .npz archive of plain arrays, got one that cannot be read"
RULE = "a.npz: shapes must be poses (P, 3), angles (B,), ranges (P, B), inside (P,), got "
FIELDS = "a.npz: must hold the arrays poses, angles, ranges, inside, got none called "


@pytest.mark.parametrize(
    ("content", "message"),
    [
        pytest.param(b"", DAMAGED, id="empty"),
        pytest.param(b"rubbish" * 100, DAMAGED, id="rubbish"),
        pytest.param(npz()[:-30], DAMAGED, id="truncated"),
        pytest.param(
            npy("{'descr': '<f8', 'fortran_order': False, 'shape': ()}", bytes(8)), DAMAGED, id="an .npy file"
        ),
        pytest.param(b"PK\x05\x06" + bytes(18), FIELDS + "poses", id="an empty archive"),
        pytest.param(npz(poses=None), FIELDS + "poses", id="no poses"),
        pytest.param(npz(inside=None), FIELDS + "inside", id="no inside"),
        pytest.param(npz(ranges=np.array([{}], dtype=object)), DAMAGED, id="an array that would run code"),
        pytest.param(archive(poses=b"no array"), DAMAGED, id="a member that is no array"),
        pytest.param(
            archive(poses=npy("{'descr': '<f8', 'fortran_order': False, 'shape': (10000000000000, 3)}")),
            DAMAGED,
            id="promises 240 TB",
        ),
        pytest.param(
            archive(poses=npy("{'descr': '<f8', 'fortran_order': False, 'shape': (-1, 3)}")),
            DAMAGED,
            id="less than none",
        ),
        pytest.param(archive(poses=npy("__import__('os').abort()")), DAMAGED, id="a header that would run code"),
        pytest.param(archive(poses=npy("(" * 100)), DAMAGED, id="a header of brackets"),
        pytest.param(npz(poses=np.zeros((2, 2))), RULE + "(2, 2), (100,), (2, 100), (2,)", id="poses without heading"),
        pytest.param(npz(poses=np.zeros(3)), RULE + "(3,), (100,), (2, 100), (2,)", id="flat poses"),
        pytest.param(npz(poses=np.float64(3)), RULE + "(), (100,), (2, 100), (2,)", id="a number for poses"),
        pytest.param(
            npz(angles=np.zeros((100, 1))), RULE + "(2, 3), (100, 1), (2, 100), (2,)", id="a column of angles"
        ),
        pytest.param(npz(angles=np.float64(0)), RULE + "(2, 3), (), (2, 100), (2,)", id="a number for angles"),
        pytest.param(npz(angles=np.zeros(99)), RULE + "(2, 3), (99,), (2, 100), (2,)", id="an angle less"),
        pytest.param(npz(ranges=np.zeros((100, 2))), RULE + "(2, 3), (100,), (100, 2), (2,)", id="turned ranges"),
        pytest.param(npz(inside=np.zeros(3, bool)), RULE + "(2, 3), (100,), (2, 100), (3,)", id="one inside more"),
        pytest.param(npz(poses=np.full((2, 3), "1")), "a.npz: poses must hold numbers, got the type <U1", id="texts"),
        pytest.param(npz(angles=np.ones(100, bool)), "a.npz: angles must hold numbers, got the type bool", id="truths"),
        pytest.param(
            npz(ranges=np.zeros((2, 100), complex)),
            "a.npz: ranges must hold numbers, got the type complex128",
            id="complex",
        ),
        pytest.param(
            npz(inside=np.zeros(2)),
            "a.npz: inside must hold true and false, got the type float64",
            id="numbers for inside",
        ),
        pytest.param(npz(poses=np.full((2, 3), np.nan)), "a.npz: poses must be finite, got nan", id="NaN in poses"),
        pytest.param(npz(angles=np.full(100, np.inf)), "a.npz: angles must be finite, got inf", id="inf in angles"),
        pytest.param(
            npz(ranges=np.full((2, 100), np.nan)),
            "a.npz: ranges must be >= 0, or inf for no hit, got nan",
            id="NaN in ranges",
        ),
        pytest.param(
            npz(ranges=np.full((2, 100), -0.1)), "a.npz: ranges must be >= 0, or inf for no hit, got -0.1", id="below 0"
        ),
    ],
)
def test_what_are_no_scans_is_refused(tmp_path, content, message):
    assert refusal(load_scans, written(tmp_path, content, "a.npz")) == message


@pytest.mark.skipif(np.finfo(np.longdouble).max == np.finfo(float).max, reason="this machine has no longer floats")
def test_a_number_too_large_for_a_float_is_infinite(tmp_path):
    content = npz(poses=np.full((2, 3), np.longdouble("1e999")))
    assert refusal(load_scans, written(tmp_path, content, "a.npz")) == "a.npz: poses must be finite, got inf"


def test_a_small_archive_that_unpacks_to_much_is_refused_before_it_is_unpacked(tmp_path, monkeypatch):
    content = npz(ranges=np.zeros((1000, 9000)))  # 72 MB
    assert len(content) < 10**5
    monkeypatch.setattr(zipfile.ZipFile, "open", lambda *_: pytest.fail("the archive was unpacked"))
    message = refusal(load_scans, written(tmp_path, content, "a.npz"))
    assert message.startswith("a.npz: must unpack to at most 67,112,960 bytes, got 72,00")


def test_a_damaged_archive_never_gives_other_scans(tmp_path):
    """Every archive with a byte turned over is refused, or still holds the same scans."""
    content, seen = npz(), a_scan()
    for place in range(0, len(content), 7):
        changed = bytearray(content)
        changed[place] ^= 0xFF
        back, message = answer(load_scans, written(tmp_path, bytes(changed), "a.npz"))
        if message is None:
            assert np.array_equal(back.ranges, seen.ranges)
        else:
            assert message.startswith((DAMAGED, FIELDS, "a.npz: must be at most "))


NO_NUMBERS = "a.npz: poses must be numbers in an array of shape (P, 3), got [['x', 'x', 'x'], ['x', 'x', 'x']]"


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        pytest.param({"ranges": np.zeros((3, 100))}, RULE + "(2, 3), (100,), (3, 100), (2,)", id="shapes"),
        pytest.param({"angles": np.full(100, np.nan)}, "a.npz: angles must be finite, got nan", id="values"),
        pytest.param({"poses": [["x"] * 3] * 2}, NO_NUMBERS, id="types"),
    ],
)
def test_scans_that_do_not_fit_together_cannot_even_be_made(changed, message):
    assert f"a.npz: {refusal(dataclasses.replace, a_scan(), **changed)}" == message


def test_only_scans_are_scans(tmp_path):
    assert refusal(save_scans, np.zeros((2, 3)), tmp_path / "a.npz") == "a.npz: must be Scans, got ndarray"


def test_no_scans_are_written_that_are_too_large_to_be_read(tmp_path, monkeypatch):
    path, seen = tmp_path / "a.npz", a_scan()
    unpacked = 2 * 3 * 8 + 100 * 8 + 2 * 100 * 8 + 2 * 8  # what the four arrays take as floats
    monkeypatch.setattr(formats.scans, "SCANS_LIMIT", unpacked)
    save_scans(seen, path)
    assert np.array_equal(load_scans(path).ranges, seen.ranges)
    path.unlink()
    noise = np.random.default_rng(0).random((3, 100))  # this does not compress, and a zip has heads of its own
    message = refusal(save_scans, dataclasses.replace(seen, angles=noise[0], ranges=noise[1:]), path)
    assert message.startswith("a.npz: must be at most 2,464 bytes, got ")
    monkeypatch.setattr(formats.scans, "SCANS_LIMIT", unpacked - 1)
    assert refusal(save_scans, seen, path) == "a.npz: must unpack to at most 2,463 bytes, got 2,464"
    assert list(tmp_path.iterdir()) == []
