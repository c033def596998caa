"""In space: exact rays against MuJoCo, trials of two samplers, quarter cylinders, and time, line by line.

python -m tests.benchmarks.in_space rays      # 10^6 rays over 50 scenes
python -m tests.benchmarks.in_space trials    # trials for 99 %: the formula, and what they took
python -m tests.benchmarks.in_space quarters  # 1,000 quarter cylinders with 10 % outliers
python -m tests.benchmarks.in_space found     # kinds, intervals and time of find_solids, on 100 scenes
"""

import sys
import time

import numpy as np

from primkit import space
from primkit.ransac import draw_samples
from primkit.space.points_alone import solid_through
from primkit.space.solids import altered, hit

NEAR_EDGE = 1e-7  # m, rad: a ray that a solid so much larger or smaller answers otherwise passes at its edge


def differing_rays(n_scenes=50, rays=20_000, seed=0):
    """Cast rays from random places in random directions; return the worst difference of range where both hit the same,
    metres, how many hit something else away from edges, and how many were cast."""
    import mujoco

    worst, differing, cast = 0.0, 0, 0
    for k in range(n_scenes):
        rng = np.random.default_rng([seed, k])
        scene = space.random_scene(5, rng=rng)
        model, data = in_mujoco(mujoco, scene)
        towards = np.array([scene.solids[i].center for i in rng.integers(0, 5, rays)]) + rng.normal(0, 0.3, (rays, 3))
        origin = np.array([*rng.uniform(-4, 4, 2), rng.uniform(1.5, 3)])
        ways = (towards - origin) / np.linalg.norm(towards - origin, axis=1)[:, None]
        ours, what = scene.hit(origin, ways)
        theirs, geoms, geom = np.empty(rays), np.empty(rays, dtype=int), np.empty((1, 1), dtype=np.int32)
        for i, way in enumerate(ways):
            theirs[i] = mujoco.mj_ray(model, data, origin, way, None, 1, -1, geom, None)
            geoms[i] = geom[0, 0] - 1  # the ground is their first, and stands before our solids
        same = what == geoms
        differing += sum(not near_edge(scene, origin, ways[i : i + 1]) for i in np.flatnonzero(~same))
        worst = max(worst, np.abs(ours - theirs)[same & np.isfinite(ours)].max())
        cast += rays
    return worst, differing, cast


def near_edge(scene, origin, way):
    """Tell whether a ray passes so close to an edge that rounding may decide."""
    for solid in scene.solids:
        for sign in (-1, 1):
            other = altered(solid, half=solid.half + sign * NEAR_EDGE)
            if np.isfinite(hit(other, origin, way)) != np.isfinite(hit(solid, origin, way)):
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
    print(f"{cast:,} rays: worst difference {1e3 * worst:.1e} mm; what is hit differs away from edges: {differing}")


ENOUGH_RIGHT, LEAST_RIGHT, MOST_SECONDS = 12_000, 400, 30  # trials that succeed; fewer tell nothing; s for a cell
OFF, STEEP, ON_IT, MOST_OF = 0.1, 0.1, 0.015, 0.8  # of the size; rad; m; share: what counts as found


def patch(kind, n, rng):
    """Points of a solid as a sensor sees it, with 5 mm noise: the half that faces the x axis; and its parameters."""
    if kind == "plane":
        points = np.column_stack([rng.uniform(-0.4, 0.4, (n, 2)), np.zeros(n)])
        true = np.array([0, 0, 1.0, 0])
    elif kind == "sphere":
        points = rng.normal(size=(n, 3))
        points[:, 0] = np.abs(points[:, 0])
        points *= 0.3 / np.linalg.norm(points, axis=1)[:, None]
        true = np.array([0, 0, 0, 0.3])
    else:
        a = rng.uniform(-np.pi / 2, np.pi / 2, n)
        points = np.column_stack([0.25 * np.cos(a), 0.25 * np.sin(a), rng.uniform(-0.5, 0.5, n)])
        true = np.array([0, 0, 0, 0, 0, 1.0, 0.25])
    return points + rng.normal(0, 0.005, (n, 3)), true


def right(kind, model, params, true, own):
    """Tell which rows of parameters are the solid, as far as a first guess must be."""
    with np.errstate(invalid="ignore"):
        if kind == "plane":
            near = np.abs(params[:, 2]) > np.cos(STEEP)
        else:
            near = np.abs(params[:, -1] - true[-1]) < OFF * true[-1]
        if kind == "cylinder":
            near &= np.abs(params[:, 5]) > np.cos(STEEP)
    fine = np.zeros(len(params), dtype=bool)
    fine[near] = (model.residuals(params[near], own) < ON_IT).mean(axis=1) > MOST_OF
    return fine


def trials():
    """For 99 %: half of the trials measure the chance, the other half how many it took, from success to success."""
    print("kind      share  sample   chance a trial  formula  took (99 %)  ratio  ms a 1,000 trials  formula of w^m")
    for kind, model in (("plane", space.PLANE), ("sphere", space.SPHERE), ("cylinder", space.CYLINDER)):
        for share in (0.7, 0.3):
            rng = np.random.default_rng(0)
            own, true = patch(kind, 600, rng)
            points = np.vstack([own, rng.uniform(-1, 1, (round(600 / share) - 600, 3))])
            for k in (None, 10, 30, 100):
                way = model if k is None else space.with_nearest(points, model, k)
                found, began, spent = [], time.process_time(), 0.0
                while sum(map(np.count_nonzero, found)) < ENOUGH_RIGHT and spent < MOST_SECONDS:
                    params = way.from_samples(points[draw_samples(len(points), way.sample_size, 4000, rng)])
                    found.append(right(kind, model, params, true, own))
                    spent = time.process_time() - began
                one, other = np.array_split(np.concatenate(found), 2)
                n, chance = len(one) + len(other), one.mean()
                clean = share ** (model.sample_size if k is None else 1)
                row = f"{kind:9s} {share:.1f}    {'plain' if k is None else f'1 + {k}':8s}"
                if one.sum() + other.sum() < LEAST_RIGHT:
                    right_ones = one.sum() + other.sum()
                    print(f"{row} capped: {right_ones} right of {n:,} trials, {1e6 * spent / n:.0f} ms a 1,000")
                    continue
                formula, took = for_99(chance), in_99(np.diff(np.flatnonzero(other), prepend=-1))
                print(
                    f"{row} {chance:13.5f} {formula:8.1f} {took:12.1f} {took / formula:6.2f} "
                    f"{1e6 * spent / n:18.0f} {for_99(clean):15,.1f}"
                )


def for_99(chance):
    """Trials until one succeeds in 99 of 100 runs, by the formula, with a chance a trial."""
    return np.log(0.01) / np.log1p(-chance)


def in_99(took):
    """Trials until the share of runs that are not done yet has fallen to 1 %, between whole numbers as the formula."""
    left = np.append(1.0, 1 - np.cumsum(np.bincount(took)[1:]) / len(took))
    k = int(np.argmax(left <= 0.01))
    if left[k] == 0:
        return float(k)
    a, b = np.log(left[k - 1 : k + 1])
    return k - 1 + (np.log(0.01) - a) / (b - a)


def quarters(n=1000, noise=0.01):
    """Quarter cylinders of 1 m radius and 3 m length in any direction: 1,000 points, 10 % outliers in the whole box."""
    off = []
    for seed in range(n):
        rng = np.random.default_rng([17, seed])
        frame = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        a, r = rng.uniform(0, np.pi / 2, 900), 1 + rng.normal(0, noise, 900)
        tube = np.column_stack([r * np.cos(a), r * np.sin(a), rng.uniform(0, 3, 900)])
        points = np.vstack([tube, rng.uniform((-1, -1, 0), (1, 1, 3), (100, 3))]) @ frame
        found = solid_through(points, space.CYLINDER, noise, rng=rng)
        off.append((1e3 * abs(found.radius - 1), np.degrees(np.arccos(min(1, abs(found.axis @ frame[2]))))))
    radius, axis = np.mean(off, axis=0)
    print(f"{n} quarter cylinders: mean error of the radius {radius:.2f} mm, of the axis {axis:.3f} degrees")


def found(n=100):
    """Scenes as in the tests, but more of them."""
    from tests.test_space import pairs, seen_scenes

    times, kinds, certain, solids, within, told = [], 0, 0, 0, 0, 0
    for scene, cloud in seen_scenes(n, 50_000):
        began = time.process_time()
        each = space.find_solids(cloud, rng=0)
        times.append(time.process_time() - began)
        solids += len(scene.solids)
        for f, true in pairs(each, scene):
            kinds, certain = kinds + (f.kind == true.kind), certain + f.certain
            if f.kind == true.kind != "box":
                for (low, high), size in zip(f.between.values(), (true.half[0], 2 * true.half[2]), strict=False):
                    told, within = told + 1, within + (low <= size <= high)
    print(f"{n} scenes, {solids} solids: kind right {kinds}, certain {certain}; interval holds {within} of {told}")
    print(f"processor time a scene: median {np.median(times):.3f} s, 95 % below {np.quantile(times, 0.95):.3f} s")


if __name__ == "__main__":
    {"rays": rays, "trials": trials, "quarters": quarters, "found": found}[sys.argv[1]]()
