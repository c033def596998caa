"""The ray caster against MuJoCo, an independent simulator: boards with walls, and any polygon; skipped without it.

    python -m tests.test_mujoco [N]

casts N rays (a million by default) and prints how many differ. A polygon stands in MuJoCo as a chain of thin plates
would, off by their thickness; so its triangles stand there, as meshes of prisms.
"""

import sys
from itertools import count

import numpy as np
import pytest
import shapely

import primkit as pk
from primkit.raycast import cast_rays

mujoco = pytest.importorskip("mujoco", reason="mujoco, the independent simulator, is not installed")

NEAR = 1e-5  # m: what both may differ by
AWAY = 1e-4  # rad: so far beside an outline's corner, or a circle's tangent, hit or miss must not differ
THICK = 0.5  # m, of a wall


def model(world):
    """The board in MuJoCo, every solid upright from -1 to 1."""
    assets, solids = [], []
    for number, shape in enumerate(world.shapes):
        if isinstance(shape, pk.Circle):
            x, y = shape.center.tolist()
            solids.append(f'<geom type="cylinder" pos="{x!r} {y!r} 0" size="{shape.radius!r} 1"/>')
            continue
        for part, corners in enumerate(triangles(shape)):
            points = " ".join(f"{x!r} {y!r} {z}" for z in (-1, 1) for x, y in corners.tolist())
            faces = "0 2 1 3 4 5 0 1 4 0 4 3 1 2 5 1 5 4 2 0 3 2 3 5"
            assets.append(f'<mesh name="m{number}_{part}" vertex="{points}" face="{faces}" inertia="exact"/>')
            solids.append(f'<geom type="mesh" mesh="m{number}_{part}"/>')
    for start, end in world.walls:
        middle, way = (start + end) / 2, end - start
        outward = np.array([way[1], -way[0]]) / np.hypot(*way)
        x, y = (middle + THICK / 2 * outward).tolist()
        wide, deep = (np.abs(way) / 2 + THICK / 2 * np.abs(outward) + THICK * (np.abs(way) > 0)).tolist()
        solids.append(f'<geom type="box" pos="{x!r} {y!r} 0" size="{wide!r} {deep!r} 1"/>')
    xml = f"<mujoco><asset>{''.join(assets)}</asset><worldbody>{''.join(solids)}</worldbody></mujoco>"
    built = mujoco.MjModel.from_xml_string(xml)
    data = mujoco.MjData(built)
    mujoco.mj_forward(built, data)
    return built, data


def triangles(polygon):
    """The polygon cut into triangles, by ears."""
    ring = polygon.vertices
    while len(ring) > 3:
        for i in count():
            ear = ring[[i - 1, i, (i + 1) % len(ring)]]
            whole = shapely.Polygon(ring).buffer(1e-12)
            if shapely.Polygon(ear).area > 1e-9 and whole.covers(shapely.Polygon(ear)):
                yield ear
                ring = np.delete(ring, i, axis=0)
                break
    yield ring


def cast_there(world, poses, angles):
    """What MuJoCo sees, shape (P, B)."""
    built, data = model(world)
    ranges = np.full((len(poses), len(angles)), np.inf)
    for row, (x, y, heading) in zip(ranges, poses, strict=True):
        bearings = heading + angles
        ways = np.column_stack([np.cos(bearings), np.sin(bearings), 0 * bearings])
        hit, distance = np.zeros(len(angles), dtype=np.int32), np.zeros(len(angles))
        start = np.array([x, y, 0.0])
        mujoco.mj_multiRay(built, data, start, ways.ravel(), None, True, -1, hit, distance, None, len(angles), 1e10)
        row[distance >= 0] = distance[distance >= 0]
    return ranges


def compared(seed, n_poses=20, n_beams=360):
    """Return how many rays were cast, how many differ in hit or miss away from edges, and the greatest difference."""
    rng = np.random.default_rng(seed)
    world = pk.random_world(4, style="any" if seed % 4 else "free", walls=seed % 2 == 0, rng=seed)
    poses = np.column_stack([rng.uniform(-0.49, 0.49, (n_poses, 2)), rng.uniform(-7, 7, n_poses)])
    poses = poses[~pk.scan(world, poses).inside]
    angles = pk.Lidar(n_beams).angles
    here, there = cast_rays(world, poses, angles), cast_there(world, poses, angles)
    beside = [cast_rays(world, poses, angles + turn) for turn in (-AWAY, AWAY)]
    edge = (np.isfinite(beside[0]) != np.isfinite(beside[1])) | ~np.isclose(*beside, rtol=0, atol=0.01)
    both = np.isfinite(here) & np.isfinite(there) & ~edge
    differ = int(((np.isfinite(here) != np.isfinite(there)) & ~edge).sum())
    return here.size, differ, float(np.abs(here[both] - there[both]).max(initial=0.0)), int(edge.sum())


@pytest.mark.parametrize("seed", range(8))
def test_mujoco_sees_the_same(seed):
    n, differ, most, edges = compared(seed)
    assert differ == 0
    assert most <= NEAR
    assert edges < n / 20


def test_the_recording_of_lesson_10_is_what_its_script_makes():
    """Its first two sides: another version of MuJoCo may skid a little otherwise."""
    from tests.benchmarks import simulated_arena as arena

    stored = pk.load_scans(arena.OUT / "arena.log.gz")
    _, told, seen = arena.drive(arena.ARENA, arena.WAY[:3])
    stored = stored[: len(told)]
    np.testing.assert_allclose(stored.poses, told, atol=0.002)
    clear = stored.hits & (stored.ranges > arena.LEAST)
    assert np.abs(stored.ranges - seen)[clear].max() < 6 * arena.NOISE
    assert clear.sum() > 2000


def main(n):
    total, edges, differ, most, seed = 0, 0, 0, 0.0, 1000
    while total < n:
        cast, other, far, on_edge = compared(seed, n_poses=60)
        total, edges, differ, most, seed = total + cast, edges + on_edge, differ + other, max(most, far), seed + 1
    print(f"{total} rays on {seed - 1000} boards: {differ} differ in hit or miss, at most {1000 * most:.5f} mm;")
    print(f"{edges} of them pass within {AWAY:g} rad of an edge, and are left out")
    return differ


if __name__ == "__main__":
    sys.exit(min(1, main(int(sys.argv[1]) if len(sys.argv) > 1 else 1_000_000)))
