"""The camera against MuJoCo's renderer, an independent one: where the edges of colours are; skipped without it.

    python -m tests.test_camera_renderer [boards]

MuJoCo draws ten times as wide, and ten columns are averaged to a pixel: so one at an edge shows both sides there, too.
"""

import os
import sys

import numpy as np
import pytest

import primkit as pk

os.environ.setdefault("MUJOCO_GL", "egl")
mujoco = pytest.importorskip("mujoco", reason="mujoco, the independent renderer, is not installed")

TIMES = 10  # as wide
EYE = 0.03  # m above the board


def drawn(world, poses, camera, colors):
    """Return the strips that MuJoCo draws, shape (P, width, 3), lit evenly, with no shadows."""
    solids, assets = [], []
    for number, (shape, color) in enumerate(zip(world.shapes, colors, strict=True)):
        paint = f'rgba="{color[0]} {color[1]} {color[2]} 1"'
        if isinstance(shape, pk.Circle):
            x, y = shape.center.tolist()
            solids.append(f'<geom type="cylinder" pos="{x!r} {y!r} 0" size="{shape.radius!r} 1" {paint}/>')
        else:
            points = " ".join(f"{x!r} {y!r} {z}" for z in (-1, 1) for x, y in shape.vertices.tolist())
            assets.append(f'<mesh name="m{number}" vertex="{points}" inertia="convex"/>')
            solids.append(f'<geom type="mesh" mesh="m{number}" {paint}/>')
    high = np.degrees(2 * np.arctan(np.tan(camera.field_of_view / 2) * camera.height / camera.width))
    eyes = [
        f'<camera name="c{k}" pos="{x!r} {y!r} {EYE}" fovy="{high!r}" '
        f'xyaxes="{np.sin(a)!r} {-np.cos(a)!r} 0 0 0 1"/>'.replace("np.float64(", "").replace(")", "")
        for k, (x, y, a) in enumerate(np.asarray(poses, dtype=float).tolist())
    ]
    head = '<visual><headlight ambient="1 1 1" diffuse="0 0 0" specular="0 0 0"/><map znear="0.001"/>'
    size = f'<global offwidth="{TIMES * camera.width}" offheight="{TIMES * camera.height}"/></visual>'
    body = f"<asset>{''.join(assets)}</asset><worldbody>{''.join(solids)}{''.join(eyes)}</worldbody>"
    model = mujoco.MjModel.from_xml_string(f"<mujoco>{head}{size}{body}</mujoco>")
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    try:
        renderer = mujoco.Renderer(model, TIMES * camera.height, TIMES * camera.width)
    except Exception as problem:  # each platform has its own
        pytest.skip(f"MuJoCo cannot draw here: {problem}")
    strips = []
    for k in range(len(poses)):
        renderer.update_scene(data, camera=f"c{k}")
        row = renderer.render()[TIMES * camera.height // 2].astype(float) / 255
        strips.append(row.reshape(camera.width, TIMES, 3).mean(axis=1))
    renderer.close()
    return np.array(strips)


def edges_of(strip, color):
    """Return where a pure colour begins and ends in a strip, in pixels, to a share of one; None if it is not seen."""
    amount = np.clip(strip @ color - 0.5 * (strip @ (1 - color)), 0, None)
    full = amount.max()
    seen = np.flatnonzero(amount > 0.9 * full)
    if full < 0.5 or len(seen) < 3 or seen[0] == 0 or seen[-1] == len(strip) - 1:
        return None
    begin, end = seen[0], seen[-1] + 1
    if begin != 0:
        begin = begin - amount[begin - 1] / full
    if end != len(strip):
        end = end + amount[end] / full
    return np.array([begin, end])


def errors(boards, first=0):
    """Return by how many pixels edges of colours differ, over boards of three shapes and three poses each."""
    camera, colors = pk.Camera(), np.eye(3)
    off = []
    for seed in range(first, first + boards):
        world = pk.random_world(3, style="free", rng=seed)
        poses = [(x, y, np.arctan2(-y, -x)) for x, y in ((-0.45, 0.0), (0.3, 0.45), (0.2, -0.45))]
        poses = [p for p in poses if min(s.signed_distance([p[:2]])[0] for s in world.shapes) > 0.02]
        ours, theirs = pk.look(world, poses, camera, colors=colors).pixels, drawn(world, poses, camera, colors)
        for a, b in zip(ours, theirs, strict=True):
            for color in colors:
                both = edges_of(a, color), edges_of(b, color)
                if both[0] is not None and both[1] is not None:
                    off.append(np.abs(both[0] - both[1]))
    return np.concatenate(off)


def test_edges_of_colours_are_where_a_renderer_draws_them():
    off = errors(3)
    assert len(off) >= 10
    assert off.max() < 0.5


if __name__ == "__main__":
    found = errors(int(sys.argv[1]) if len(sys.argv) > 1 else 50)
    print(f"{len(found)} edges: within half a pixel {np.mean(found < 0.5):.3f}, largest {found.max():.3f} pixels")
