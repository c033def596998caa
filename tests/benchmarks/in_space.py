"""In space: exact rays against MuJoCo, trials of two samplers, quarter cylinders, and time, line by line.

python -m tests.benchmarks.in_space rays      # 10^6 rays over 50 scenes
python -m tests.benchmarks.in_space trials    # trials for 99 %: the formula, and what they took
python -m tests.benchmarks.in_space quarters  # 1,000 quarter cylinders with 10 % outliers
python -m tests.benchmarks.in_space peers     # pyransac3d beside find_solids, on the same clouds
"""

import sys

import numpy as np

from primkit import space
from primkit.space.solids import hit

NEAR_EDGE = 1e-7  # m, rad: a ray that a solid so much larger or smaller answers otherwise passes at its edge


def differing_rays(n_scenes=50, rays=20_000, seed=0):
    """Cast rays from random places in random directions; return the worst difference of range where both hit, metres,
    how many hit in one and miss in the other away from edges, and how many were cast."""
    import mujoco

    worst, differing, cast = 0.0, 0, 0
    for k in range(n_scenes):
        rng = np.random.default_rng([seed, k])
        scene = space.random_scene(5, rng=rng)
        model, data = in_mujoco(mujoco, scene)
        towards = np.array([scene.solids[i].center for i in rng.integers(0, 5, rays)]) + rng.normal(0, 0.3, (rays, 3))
        origin = np.array([*rng.uniform(-4, 4, 2), rng.uniform(1.5, 3)])
        ways = (towards - origin) / np.linalg.norm(towards - origin, axis=1)[:, None]
        ours, _ = scene.hit(origin, ways)
        theirs, geom = np.empty(rays), np.empty((1, 1), dtype=np.int32)
        for i, way in enumerate(ways):
            theirs[i] = mujoco.mj_ray(model, data, origin, way, None, 1, -1, geom, None)
        theirs = np.where(theirs < 0, np.inf, theirs)
        both = np.isfinite(ours) & np.isfinite(theirs)
        off = np.where(both, np.abs(np.where(both, ours, 0) - np.where(both, theirs, 0)), 0)
        odd = np.flatnonzero((np.isfinite(ours) != np.isfinite(theirs)) | (off > 1e-6))
        at_edge = np.array([near_edge(scene, origin, ways[i : i + 1]) for i in odd], dtype=bool)
        differing += np.count_nonzero(~at_edge)
        off[odd] = 0
        worst, cast = max(worst, off.max()), cast + rays
    return worst, differing, cast


def near_edge(scene, origin, way):
    """Tell whether a ray passes so close to an edge that rounding may decide."""
    for solid in scene.solids:
        for sign in (-1, 1):
            step = np.zeros(solid.numbers)
            step[{"sphere": 3, "cylinder": 4, "box": 6}[solid.kind] :] = sign * NEAR_EDGE
            if np.isfinite(hit(solid.moved(step), origin, way)) != np.isfinite(hit(solid, origin, way)):
                return True
    return False


def in_mujoco(mujoco, scene):
    """The scene in MuJoCo: exact geometry, over a ground without end."""
    geoms = ['<geom type="plane" size="0 0 1"/>']
    for solid in scene.solids:
        place = " ".join(f"{v!r}" for v in solid.center.tolist())
        axes = " ".join(f"{v!r}" for v in solid.frame[:2].ravel().tolist())
        size = {"sphere": [solid.half[0]], "cylinder": solid.half[[0, 2]], "box": solid.half}[solid.kind]
        sizes = " ".join(f"{float(v)!r}" for v in size)
        geoms.append(f'<geom type="{solid.kind}" pos="{place}" xyaxes="{axes}" size="{sizes}"/>')
    model = mujoco.MjModel.from_xml_string(f"<mujoco><worldbody>{''.join(geoms)}</worldbody></mujoco>")
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return model, data


def rays():
    worst, differing, cast = differing_rays()
    print(f"{cast:,} rays: worst difference {1e3 * worst:.1e} mm; hit or miss differs away from edges: {differing}")


if __name__ == "__main__":
    {"rays": rays}[sys.argv[1]]()
