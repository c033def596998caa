"""Stopwatch: what the primkit on the path takes for the work of ``speed``; prints it as JSON, times in milliseconds.

It is run as a script, with the package that is to be timed on PYTHONPATH, and calls only what both editions have.
Processor time, one thread: other work on the machine then hardly counts.
"""

import json
import os
import subprocess
import sys
import tempfile
import time

import numpy as np
from threadpoolctl import threadpool_limits

import primkit as pk
from primkit.driving.wander import wander

NOISES_MM = (0, 2, 5)
N_STEPS, FIRST_STEP = 150, 50  # scans of a drive; from when on its steps are timed
N_ALONE = 300


def milliseconds(work):
    """Return the processor time of a call, the least of three: what comes between makes it only longer."""
    taken = []
    for _ in range(3):
        begun = time.process_time()
        work()
        taken.append(1000 * (time.process_time() - begun))
    return min(taken)


def maps():
    """Return the suite's ten maps with four shapes."""
    return [world for world in pk.paper_suite().values() if len(world.shapes) == 4]


def finding(noise, seed):
    """Return what finding all shapes takes, map by map."""
    taken = []
    for world in maps():
        grid = pk.Grid()
        grid.add(pk.scan(world, pk.teleport_poses(world), pk.Lidar(noise_std=noise), rng=seed))
        points = grid.points()
        taken.append(milliseconds(lambda points=points: pk.find_shapes(points, rng=0)))
    return taken


def driving(noise, seed):
    """Return what each step of drives takes: a scan, the grid, the shapes anew."""
    taken = []
    for world in maps()[:5]:
        rng, lidar = np.random.default_rng(seed), pk.Lidar(noise_std=noise)
        add, look = mapper()
        for step, pose in enumerate(wander(world, N_STEPS, rng=seed)):
            begun = time.process_time()
            add(pk.scan(world, pose, lidar, rng=rng))
            look()
            if step >= FIRST_STEP:
                taken.append(1000 * (time.process_time() - begun))
    return taken


def mapper():
    """Return how scans are added while driving, and how shapes are looked for with warm starts."""
    if hasattr(pk, "Mapper"):
        ours = pk.Mapper(rng=0)
        return ours.add, lambda: ours.found
    grid, memory = pk.Grid(), {}
    return grid.add, lambda: pk.find_shapes(grid.points(), memory=memory, rng=0)


def alone(seed):
    """Return what one scan takes, of many that are made one by one."""
    world, poses = maps()[0], pk.teleport_poses(maps()[0])
    chosen = poses[np.random.default_rng(seed).integers(len(poses), size=N_ALONE)]
    return [milliseconds(lambda: [pk.scan(world, pose) for pose in chosen]) / N_ALONE]


def command():
    """Return what ``primkit map`` takes from start to end."""
    with tempfile.TemporaryDirectory() as folder:
        before = os.times()
        subprocess.run([sys.executable, "-m", "primkit", "map", "--out", folder], check=True, capture_output=True)
        after = os.times()
    return [1000 * (after.children_user + after.children_system - before.children_user - before.children_system)]


def main(seed):
    """Print all times by name."""
    with threadpool_limits(1):
        taken = {f"4 shapes, {mm} mm": finding(mm / 1000, seed) for mm in NOISES_MM}
        taken |= {"a step while driving, 2 mm": driving(0.002, seed), "one scan alone": alone(seed)}
    print(json.dumps(taken | {"primkit map": command()}))


if __name__ == "__main__":
    main(int(sys.argv[1]))
