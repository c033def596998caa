"""Damaged files: some hundred mutants of each format, and every format cut off here and there.

The long runs stand under ``tests/benchmarks``: ``mutants`` and ``killed_writers``.
"""

import pytest

from tests.benchmarks.killed_writers import cut_off, whole, write_all
from tests.benchmarks.mutants import run, seeds, tried

pytestmark = pytest.mark.filterwarnings("ignore::primkit.arguments.LikelyWrong")


def test_mutants_are_read_or_refused_in_a_sentence(tmp_path):
    out = run(1200, tmp_path)
    assert {name: each.broken for name, each in out.items()} == {name: [] for name in out}
    assert min(each.refused for each in out.values()) > 20  # it damages something


def test_a_reader_that_breaks_the_rule_is_caught(tmp_path):
    (tmp_path / "a.json").write_text("")
    for read in (lambda _: {}["x"], lambda _: int("a"), lambda path: int(f"{path.name}:\n")):
        assert tried("a.json", read, tmp_path / "a.json")[2]


def test_what_is_cut_off_is_refused_or_is_the_old_without_its_end(tmp_path):
    readers = seeds(tmp_path)
    assert {name: cut_off(name, *readers[name], tmp_path, step=23) for name in readers} == {
        name: [] for name in readers
    }


def test_what_writers_leave_is_whole(tmp_path):
    write_all(tmp_path, 0)
    write_all(tmp_path, 1)
    assert whole(tmp_path) == []
    (tmp_path / "a.json").write_bytes(b"{")
    assert len(whole(tmp_path)) == 1
