"""Every machine: 32 bits, no threads, no alarm, other kernels of linear algebra.

No browser and no 32-bit machine is asked. There, numpy refuses counts of 64 bits in ``repeat`` and ``bincount``; here a
stand-in for numpy refuses them, in primkit's modules alone, and says that an index has 32 bits.
"""

import ast
import signal
import sys
import threading
from pathlib import Path

import numpy as np
import pytest

import primkit as pk
from primkit.checks import TASKS
from primkit.driving.moving_grid import MovingGrid
from tests.benchmarks.same_worlds import truths

ROOT = Path(__file__).resolve().parent.parent
NEEDS_INTP = ("repeat", "bincount")


class Narrow:
    """numpy on a machine of 32 bits, as far as counts go."""

    intp = np.int32

    def __getattr__(self, name):
        if name in NEEDS_INTP:
            return lambda *args, **more: self._checked(getattr(np, name), *args, **more)
        return getattr(np, name)

    @staticmethod
    def _checked(function, *args, **more):
        counts = args[0] if function is np.bincount else args[1]
        if isinstance(counts, np.ndarray) and counts.dtype.itemsize > 4:  # there, a list becomes one of 32 bits
            raise TypeError(f"Cannot cast array data from dtype('{counts.dtype}') to dtype('int32')")
        return function(*args, **more)


@pytest.fixture
def narrow(monkeypatch):
    """primkit as on wasm32, 32-bit Windows and Raspberry Pi OS: 32-bit counts, no threads, no alarm."""
    __import__("primkit.scene")
    for name, module in list(sys.modules.items()):
        if name.split(".")[0] == "primkit" and getattr(module, "np", None) is np:
            monkeypatch.setattr(module, "np", Narrow())
    monkeypatch.delattr(signal, "setitimer", raising=False)

    def start(_thread):
        raise RuntimeError("can't start new thread")

    monkeypatch.setattr(threading.Thread, "start", start)


def many(n):
    """A board of so many circles: from two dozen on, the caster looks them up by cells."""
    return pk.World([pk.Circle(((k % 6) / 4 - 0.6, k // 6 / 4 - 0.6), 0.05) for k in range(n)], size=2)


def test_the_stand_in_refuses_what_such_machines_refuse():
    with pytest.raises(TypeError, match="Cannot cast"):
        Narrow().repeat(np.arange(2), np.array([1, 2], dtype=np.int64))
    with pytest.raises(TypeError, match="Cannot cast"):
        Narrow().bincount(np.arange(2, dtype=np.int64))


def test_no_count_is_hidden_from_the_stand_in():
    """An array's own ``repeat`` would be: it is not used."""
    for path in (ROOT / "primkit").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Attribute) and node.attr == "repeat":
                assert ast.unparse(node) in ("np.repeat", "itertools.repeat"), f"{path.name}: {ast.unparse(node)}"


@pytest.mark.parametrize("settings", [pk.ROBUST, pk.PAPER], ids=["ROBUST", "PAPER"])
def test_the_same_shapes_on_32_bits(request, settings):
    world, lidar = pk.random_world(3, rng=4), pk.Lidar(noise_std=0.002, spurious=0.01)

    def found():
        grid = pk.Grid()
        grid.add(pk.scan(world, pk.teleport_poses(world), lidar, rng=1))
        return [d.shape for d in pk.find_shapes(grid.points(), settings=settings, n_shapes=3, rng=0)]

    wide = found()
    request.getfixturevalue("narrow")
    assert found() == wide
    assert wide


def test_many_shapes_and_a_moving_grid_on_32_bits(request):
    world = many(30)
    poses = pk.teleport_poses(world)[:40]
    wide = pk.scan(world, poses)
    request.getfixturevalue("narrow")
    seen, grid = pk.scan(world, poses), MovingGrid(lidar=pk.Lidar())
    assert np.array_equal(seen.ranges, wide.ranges)
    for one in range(len(seen)):
        grid.add(seen[one])
    assert len(grid) > 0
    assert pk.segment(seen.points(), method="link").max() > 3
    assert pk.segment(seen.points()[:200], 3, rng=0).max() == 2


def test_the_wings_on_32_bits(request):
    sides = np.array([(0, -0.05), (0.12, -0.05), (0.12, 0.05), (0, 0.05)])
    world, turns = pk.World([pk.Polygon(sides), pk.Polygon(sides - (0.12, 0))]), np.arange(12) * np.pi / 6
    poses = np.column_stack([0.33 * np.cos(turns), 0.33 * np.sin(turns), turns + np.pi])
    places = [(-2.5, -2.5, 0.6), (2.5, 2.5, 0.6)]

    def found():
        scans = pk.scan(world, poses, pk.Lidar(beams=180, range_max=0.5, noise_std=0.0003), rng=0)
        colors = pk.colors_of(scans, pk.look(world, poses, colors=[(0.9, 0.35, 0.1), (0.1, 0.35, 0.9)]))
        cloud = pk.space.scan(pk.space.random_scene(2, rng=3), places, rng=0)
        return [*map(str, pk.space.find_solids(cloud, rng=0)), str(pk.take_apart(scans.points(), colors=colors))]

    wide = found()
    request.getfixturevalue("narrow")
    assert found() == wide
    assert len(wide) == 3


@pytest.mark.usefixtures("narrow")
@pytest.mark.parametrize("check", TASKS, ids=lambda check: check.name)
def test_every_check_on_32_bits(check):
    assert check(check.reference).right


@pytest.mark.usefixtures("narrow")
def test_a_scene_without_threads():
    scene = pk.drive_scene(pk.random_world(2, rng=3))
    for _ in range(3):
        scene.answer({"do": "step", "held": ["forward"]})
    scene.close()


@pytest.mark.usefixtures("narrow")
def test_an_exploration_without_threads():
    assert len(pk.explore(pk.random_world(1, rng=3), rng=0).poses) > 3


def test_r14_a_seed_means_the_same_world_with_every_linear_algebra():
    """The full measurement, with shapes found: ``python -m tests.benchmarks.same_worlds``."""
    first, other = truths("Haswell", 1, n=4, found=False), truths("Prescott", 2, n=4, found=False)
    if first["kernels"] == other["kernels"]:
        pytest.skip("this machine's linear algebra has one kernel")
    assert other["worlds"] == first["worlds"]  # to the last bit
    assert other["points"] == first["points"]


MAKES_TRUTH = ("world.py", "shapes.py", "robot.py", "lidar.py", "raycast/fast.py", "course/personal.py")


@pytest.mark.parametrize("name", [*MAKES_TRUTH, "driving/scripted.py"])
def test_r14_no_matrix_product_makes_a_truth(name):
    tree = ast.parse((ROOT / "primkit" / name).read_text(encoding="utf-8"))
    products = [node.lineno for node in ast.walk(tree) if isinstance(node, ast.MatMult)]
    names = [node.attr for node in ast.walk(tree) if isinstance(node, ast.Attribute)]
    assert not products
    assert not {"dot", "matmul", "einsum", "inner", "tensordot"} & set(names)
