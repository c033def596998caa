"""Files of any format: endings, limits, missing files; and writing whole or not at all."""

import io
import os
import stat
from pathlib import Path

import pytest

from primkit import formats
from primkit.formats import load_scans, load_world, save_scans, save_world, write_atomically
from primkit.world import World
from tests.filing import TRIANGLE, a_scan, refusal

posix = pytest.mark.skipif(os.name != "posix", reason="Windows has no such permissions, links or pipes")


# --- files that are missing, too large, or something else ---------------------------------------------------

SAVERS = [pytest.param(save_world, World(), id="save_world"), pytest.param(save_scans, a_scan(), id="save_scans")]
MAP_ENDING = "the name of a map must end in .geojson or .json, got "
SCAN_ENDING = "the name of a file of scans must end in .npz, got "


@pytest.mark.parametrize(
    ("name", "for_a_map", "for_scans"),
    [
        ("a.txt", f"a.txt: {MAP_ENDING}.txt", f"a.txt: {SCAN_ENDING}.txt"),
        ("a", f"a: {MAP_ENDING}no ending", f"a: {SCAN_ENDING}no ending"),
        (".geojson", f".geojson: {MAP_ENDING}no ending", f".geojson: {SCAN_ENDING}no ending"),
        ("a.geojson.gz", f"a.geojson.gz: {MAP_ENDING}.gz", f"a.geojson.gz: {SCAN_ENDING}.gz"),
        ("", f".: {MAP_ENDING}no ending", f".: {SCAN_ENDING}no ending"),
        ("a.npz", f"a.npz: {MAP_ENDING}.npz", None),
        ("a.geojson", None, f"a.geojson: {SCAN_ENDING}.geojson"),
    ],
)
def test_other_endings_are_refused_on_both_ways(tmp_path, monkeypatch, name, for_a_map, for_scans):
    monkeypatch.chdir(tmp_path)
    if for_a_map:
        endings = (".geojson or .json or .wbt", ".geojson or .json or .wbt or .sdf or .world")
        for_saving, for_loading = (for_a_map.replace(".geojson or .json", one) for one in endings)
        assert refusal(save_world, World(), name) == for_saving
        assert refusal(load_world, name) == for_loading
    if for_scans:
        assert refusal(save_scans, a_scan(), name) == for_scans
        endings = " or ".join(formats.scans.READ_ENDINGS)
        assert refusal(load_scans, name) == for_scans.replace("in .npz,", f"in {endings},")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(("load", "name"), [(load_world, "a.geojson"), (load_scans, "a.npz")])
def test_a_missing_file_is_named(tmp_path, load, name):
    expected = f"{name}: there is no such file in {tmp_path}"
    assert refusal(load, tmp_path / name, error=FileNotFoundError) == expected
    expected = f"{name}: there is no such file in {tmp_path / 'none'}"
    assert refusal(load, tmp_path / "none" / name, error=FileNotFoundError) == expected


def test_a_missing_file_of_the_working_folder_tells_which_that_is(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    expected = f"a.geojson: there is no such file in {Path.cwd()}"
    assert refusal(load_world, "a.geojson", error=FileNotFoundError) == expected


@pytest.mark.parametrize(("load", "name"), [(load_world, "a.geojson"), (load_scans, "a.npz")])
def test_a_folder_is_no_file(tmp_path, load, name):
    (tmp_path / name).mkdir()
    expected = f"{name}: cannot be read: it is a folder"
    assert refusal(load, tmp_path / name, error=IsADirectoryError) == expected


@posix
def test_a_pipe_does_not_keep_the_reader_waiting(tmp_path):
    os.mkfifo(tmp_path / "a.geojson")
    assert refusal(load_world, tmp_path / "a.geojson", error=OSError) == (
        "a.geojson: cannot be read: it is no ordinary file"
    )


@pytest.mark.parametrize(
    ("load", "name", "limit"),
    [(load_world, "a.geojson", formats.MAP_LIMIT), (load_scans, "a.npz", formats.SCANS_LIMIT)],
)
def test_a_gigabyte_is_refused_before_it_is_read(tmp_path, monkeypatch, load, name, limit):
    with (tmp_path / name).open("wb") as file:
        file.truncate(2**30)  # a hole: takes no room on the disc
    monkeypatch.setattr(Path, "open", lambda *_: pytest.fail("the file was opened"))
    expected = f"{name}: must be at most {limit:,} bytes, got 1,073,741,824"
    assert refusal(load, tmp_path / name) == expected


def test_the_limits_are_16_and_64_mebibytes():
    assert (formats.MAP_LIMIT, formats.SCANS_LIMIT) == (16_777_216, 67_108_864)


def test_a_file_of_exactly_the_limit_is_read_and_no_larger_one_is_written(tmp_path, monkeypatch):
    path = tmp_path / "map.geojson"
    save_world(World([TRIANGLE]), path)
    size = path.stat().st_size
    monkeypatch.setattr(formats.maps, "MAP_LIMIT", size)
    save_world(World([TRIANGLE]), path)
    assert load_world(path) == World([TRIANGLE])
    monkeypatch.setattr(formats.maps, "MAP_LIMIT", size - 1)
    message = f"map.geojson: must be at most {size - 1:,} bytes, got {size:,}"
    assert refusal(load_world, path) == message
    path.unlink()
    assert refusal(save_world, World([TRIANGLE]), path) == message
    assert not path.exists()


# --- writing whole or not at all ----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("data", "expected"),
    [
        pytest.param(b"\x89PNG\r\n\x00", b"\x89PNG\r\n\x00", id="bytes"),
        pytest.param("středy\n", b"st\xc5\x99edy\n", id="text"),
        pytest.param("a\r\nb\n", b"a\r\nb\n", id="line ends stay"),
        pytest.param("", b"", id="nothing"),
    ],
)
def test_a_file_is_written(tmp_path, data, expected):
    for _ in range(2):  # a new file, and over the old one
        write_atomically(tmp_path / "a.csv", data)
        assert (tmp_path / "a.csv").read_bytes() == expected
        assert [path.name for path in tmp_path.iterdir()] == ["a.csv"]


@posix
def test_the_longest_name_is_written(tmp_path):
    write_atomically(tmp_path / ("a" * 251 + ".csv"), "x")
    assert [len(path.name) for path in tmp_path.iterdir()] == [255]


def failing(error):
    def fail(*_args, **_kwargs):
        raise error

    return fail


@pytest.mark.parametrize("step", ["open", "write", "fsync", "replace"])
@pytest.mark.parametrize(
    ("error", "expected", "message"),
    [
        pytest.param(OSError(28, "No room"), OSError, "a.csv: cannot be written: No room", id="the disc is full"),
        pytest.param(PermissionError(13, "In use"), PermissionError, "a.csv: cannot be written: In use", id="in use"),
        pytest.param(OSError("odd"), OSError, "a.csv: cannot be written: odd", id="an error without a number"),
        pytest.param(KeyboardInterrupt(), KeyboardInterrupt, "", id="interrupted"),
        pytest.param(MemoryError(), MemoryError, "", id="no memory"),
    ],
)
@pytest.mark.parametrize("old", [None, b"old"], ids=["new file", "over an old file"])
def test_a_failure_leaves_the_old_file_and_nothing_else(tmp_path, monkeypatch, step, error, expected, message, old):
    path = tmp_path / "a.csv"
    if old is not None:
        path.write_bytes(old)
    with monkeypatch.context() as patch:
        if step == "open":
            patch.setattr(Path, "open", failing(error))
        elif step == "write":
            patch.setattr(Path, "open", lambda path, mode: HalfWritten(path, mode, error))
        else:
            patch.setattr(os, step, failing(error))
        assert refusal(write_atomically, path, b"new" * 1000, error=expected) == message
    assert [(p.name, p.read_bytes()) for p in tmp_path.iterdir()] == ([("a.csv", old)] if old else [])


class HalfWritten(io.FileIO):
    """A file on a disc that fails in the middle of writing."""

    def __init__(self, path, mode, error):
        super().__init__(path, mode)
        self.error = error

    def write(self, data):
        super().write(data[: len(data) // 2])
        raise self.error


def test_the_content_is_on_the_disc_before_it_takes_the_old_files_place(tmp_path, monkeypatch):
    """Without that order a power cut could leave an empty file."""
    steps = []
    fsync, replace = os.fsync, os.replace

    def watched_fsync(number):
        steps.append(("fsync", os.fstat(number).st_size))
        fsync(number)

    def watched_replace(source, target):
        steps.append(("replace", Path(source).parent == Path(target).parent, Path(source).read_bytes()))
        replace(source, target)

    monkeypatch.setattr(os, "fsync", watched_fsync)
    monkeypatch.setattr(os, "replace", watched_replace)
    write_atomically(tmp_path / "a.csv", b"new")
    assert steps == [("fsync", 3), ("replace", True, b"new")]


@pytest.mark.parametrize(("save", "what"), SAVERS)
def test_saving_is_atomic(tmp_path, monkeypatch, save, what):
    path = tmp_path / ("a.geojson" if save is save_world else "a.npz")
    path.write_bytes(b"old")
    monkeypatch.setattr(os, "replace", failing(PermissionError(13, "In use")))
    message = f"{path.name}: cannot be written: In use"
    assert refusal(save, what, path, error=PermissionError) == message
    assert [(p.name, p.read_bytes()) for p in tmp_path.iterdir()] == [(path.name, b"old")]


@pytest.mark.parametrize(("save", "what"), SAVERS)
def test_a_missing_folder_is_named(tmp_path, save, what):
    path = tmp_path / "none" / ("a.geojson" if save is save_world else "a.npz")
    assert refusal(save, what, path, error=FileNotFoundError) == f"{path.name}: there is no folder {tmp_path / 'none'}"


def test_text_that_is_no_text_leaves_the_old_file(tmp_path):
    (tmp_path / "a.csv").write_bytes(b"old")
    with pytest.raises(UnicodeEncodeError):
        write_atomically(tmp_path / "a.csv", "\ud800")
    assert [(p.name, p.read_bytes()) for p in tmp_path.iterdir()] == [("a.csv", b"old")]


def test_a_folder_is_not_written_over(tmp_path):
    (tmp_path / "a.geojson").mkdir()
    expected = "a.geojson: cannot be written: it is a folder"
    assert refusal(save_world, World(), tmp_path / "a.geojson", error=IsADirectoryError) == expected
    assert [path.name for path in tmp_path.iterdir()] == ["a.geojson"]


@posix
def test_what_is_no_ordinary_file_is_not_replaced(tmp_path):
    os.mkfifo(tmp_path / "a.geojson")  # stands for /dev/null
    expected = "a.geojson: cannot be written: it is no ordinary file"
    assert refusal(save_world, World(), tmp_path / "a.geojson", error=OSError) == expected
    assert stat.S_ISFIFO((tmp_path / "a.geojson").stat().st_mode)


def test_a_write_protected_file_is_not_replaced(tmp_path, monkeypatch):
    (tmp_path / "a.csv").write_bytes(b"old")
    monkeypatch.setattr(os, "access", lambda *_: False)  # the superuser may write anywhere, so chmod would not do
    expected = "a.csv: cannot be written: it is write-protected"
    assert refusal(write_atomically, tmp_path / "a.csv", "new", error=PermissionError) == expected
    assert [(p.name, p.read_bytes()) for p in tmp_path.iterdir()] == [("a.csv", b"old")]


@posix
@pytest.mark.parametrize("umask", [0o022, 0o077, 0o002])
def test_a_new_file_has_the_permissions_of_any_new_file(tmp_path, umask):
    before = os.umask(umask)
    try:
        write_atomically(tmp_path / "a.csv", "x")
    finally:
        os.umask(before)
    assert stat.S_IMODE((tmp_path / "a.csv").stat().st_mode) == 0o666 & ~umask


@posix
@pytest.mark.parametrize("mode", [0o600, 0o664, 0o755])
def test_an_old_file_keeps_its_permissions(tmp_path, mode):
    (tmp_path / "a.csv").write_bytes(b"old")
    (tmp_path / "a.csv").chmod(mode)
    write_atomically(tmp_path / "a.csv", "new")
    assert stat.S_IMODE((tmp_path / "a.csv").stat().st_mode) == mode


@posix
def test_a_link_stays_a_link(tmp_path):
    (tmp_path / "folder").mkdir()
    (tmp_path / "link.csv").symlink_to(tmp_path / "folder" / "a.csv")
    for content in ("first", "second"):
        write_atomically(tmp_path / "link.csv", content)
        assert (tmp_path / "link.csv").is_symlink()
        assert (tmp_path / "folder" / "a.csv").read_text() == content
