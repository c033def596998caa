"""The paper's 34 maps: complete, found where they are installed, and what their seeds give."""

import numpy as np
import pytest

from primkit import formats
from primkit.formats import paper_suite, save_world
from primkit.shapes import PRIMITIVES, Circle
from tests.filing import refusal
from tests.shipped_data import make_map


def test_the_suite_has_one_map_of_each_kind_and_ten_each_of_two_three_and_four_shapes():
    suite = paper_suite()
    assert list(suite) == [f"1-{kind}" for kind in PRIMITIVES] + [
        f"{n}-{k:02d}" for n in (2, 3, 4) for k in range(1, 11)
    ]
    for name, world in suite.items():
        assert len(world.shapes) == int(name[0])
        assert world.size == 1.0
        assert world.least_gap() >= 0.05
    assert [suite[f"1-{kind}"].shapes[0].kind for kind in PRIMITIVES] == list(PRIMITIVES)
    assert {shape.kind for world in suite.values() for shape in world.shapes} == set(PRIMITIVES)
    assert len(set(suite.values())) == 34


def test_the_suites_files_are_what_their_seeds_give():
    for name, world in paper_suite().items():
        made = make_map(name)
        assert [s.kind for s in world.shapes] == [s.kind for s in made.shapes]
        for a, b in zip(world.shapes, made.shapes, strict=True):
            numbers = [np.append(s.center, s.radius) if isinstance(s, Circle) else s.vertices for s in (a, b)]
            np.testing.assert_allclose(*numbers, rtol=0, atol=1e-12)


def test_the_suites_files_are_as_save_world_writes_them(tmp_path):
    for name, world in paper_suite().items():
        save_world(world, tmp_path / "map.geojson")
        bundled = (formats.suite._data_folder() / "maps" / f"{name}.geojson").read_text()
        assert (tmp_path / "map.geojson").read_text() == bundled


@pytest.mark.parametrize("place", ["site/primkit/data", "site/data"], ids=["in the package", "beside the package"])
def test_the_suite_is_found(tmp_path, monkeypatch, place):
    (tmp_path / place / "maps").mkdir(parents=True)
    for name, world in paper_suite().items():
        save_world(world, tmp_path / place / "maps" / f"{name}.geojson")
    expected = paper_suite()
    monkeypatch.setattr(formats.suite, "__file__", str(tmp_path / "site" / "primkit" / "formats" / "suite.py"))
    assert paper_suite() == expected
    (tmp_path / place / "maps" / "2-01.geojson").unlink()
    assert refusal(paper_suite, error=FileNotFoundError) == (
        f"2-01.geojson: there is no such file in {tmp_path.resolve() / place / 'maps'}"
    )


def test_a_missing_suite_is_told_plainly(tmp_path, monkeypatch):
    monkeypatch.setattr(formats.suite, "__file__", str(tmp_path / "primkit" / "formats" / "suite.py"))
    assert refusal(paper_suite, error=FileNotFoundError) == (
        f"data/maps: must be in or beside {tmp_path.resolve() / 'primkit'}, got neither; install primkit again"
    )
