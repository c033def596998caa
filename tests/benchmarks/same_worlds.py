"""The same seed on other linear algebra: the same worlds and points to the last bit, the same shapes to 1e-12.

    python -m tests.benchmarks.same_worlds [N]

OpenBLAS picks its kernels by the processor; three of them, with one thread and with two, stand for other machines.
It prints the kernels that were at work, and the largest differences.
"""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
CORES = ("Haswell", "Prescott", "SkylakeX")
CODE = """
import json, sys
import numpy as np
import primkit as pk
n, found = int(sys.argv[1]), sys.argv[2] == "True"
def numbers(world):
    return [v for s in world.shapes for v in np.ravel(s.center if s.kind == "circle" else s.vertices).tolist()]
worlds = [pk.random_world(k % 4 + 1, rng=k) for k in range(n)]
worlds += [pk.random_world(k % 5 + 1, style="free", rng=k) for k in range(n)]
worlds += [pk.personal_world(f"student-{k}", salt="0123456789abcdef") for k in range(n)]
points = [pk.scan(w, pk.teleport_poses(w), pk.Lidar(noise_std=0.002), rng=0).points() for w in worlds]
shapes = [d.shape for p in points for d in pk.find_shapes(p, rng=0)] if found else []
told = [[s.kind, *s.centroid.tolist(), *s.dimensions] for s in shapes]
np.ones((9, 9)) @ np.ones((9, 9))
import threadpoolctl
kernels = [each.get("architecture") for each in threadpoolctl.threadpool_info()]
print(json.dumps({"worlds": [numbers(w) for w in worlds], "points": [p.tolist() for p in points], "shapes": told,
                  "kernels": kernels}))
"""


def truths(core, threads, n, found):
    """Return n worlds of each sort, the points seen of them and the shapes found, with this kernel and its name."""
    variables = {"OPENBLAS_CORETYPE": core, "PYTHONPATH": str(ROOT)}
    variables |= dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"), str(threads))
    command = [sys.executable, "-c", CODE, str(n), str(found)]
    done = subprocess.run(command, env=os.environ | variables, capture_output=True, text=True, check=True)
    return json.loads(done.stdout)


def main(n):
    first = truths(CORES[0], 1, n, found=True)
    print(f"{3 * n} worlds, {sum(map(len, first['points']))} points, {len(first['shapes'])} shapes")
    for core in CORES:
        for threads in (1, 2):
            other = truths(core, threads, n, found=True)
            same = [other[what] == first[what] for what in ("worlds", "points")]
            kinds = [s[0] for s in other["shapes"]] == [s[0] for s in first["shapes"]]
            ours, theirs = (np.concatenate([s[1:] for s in each["shapes"]]) for each in (first, other))
            off = np.max(np.abs(ours - theirs)) if ours.shape == theirs.shape else np.inf
            print(
                f"{core} ({', '.join(map(str, other['kernels']))}), {threads} thread{'s' * (threads > 1)}: "
                f"worlds {same[0]}, points {same[1]}, kinds {kinds}; shapes differ by at most {off:.1e} m"
            )


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 20)
