"""A drive of minutes with the live scene: what it keeps in memory, and what a step takes of the processor.

    python -m tests.benchmarks.long_drive

Shapes are looked for in a thread beside the drive, as in the scene. A step has a tenth of a second; 95 of 100 shall
leave half of it free.
"""

import subprocess
import sys
import time
from pathlib import Path

import numpy as np

import primkit as pk
from primkit.scene.finder import Beside
from primkit.scene.keys import wheels_for
from primkit.scene.state import DriveState

ROOT = Path(__file__).resolve().parents[2]
STEP = 0.05  # s of processor time
NOISES = (0.0, 0.002)  # m
COUNTS = (300, 2400)  # steps: half a minute, and four


def wandering(n_steps, rng=0):
    """Keys of somebody who drives onwards in arcs and turns away from what is in the way, as a generator of steps.

    Send it whether the robot was stopped.
    """
    ways = [["forward"], ["forward", "left"], ["forward", "right"]]
    rng = np.random.default_rng(rng)
    held, left = ["forward"], 0
    for _ in range(n_steps):
        stopped = yield held
        left -= 1
        if stopped:
            held, left = ["back", "left"], int(rng.integers(5, 12))
        elif left <= 0:
            held, left = ways[rng.integers(3)], int(rng.integers(20))


def long_drive(noise, *counts):
    """Drive in a process of its own, at full speed.

    For each of these numbers of steps: how many cells there are; the peak of memory; and the seconds of the processor
    that a step takes, as the median of those since the number before.
    """
    command = [sys.executable, "-m", "tests.benchmarks.long_drive", str(noise), *map(str, counts)]
    done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT, check=True)
    return [tuple(map(float, line.split()[:3])) for line in done.stdout.splitlines()]


def drive(noise, counts):
    """Drive; print a line for each number of steps, with the 95th percentile as one more number."""
    import resource  # Windows has none

    import sklearn.cluster  # noqa: F401  # a look loads it at the first group that only K-Means parts, early or late

    state = DriveState(pk.random_world(4, rng=7), pk.Lidar(noise_std=noise), executor=Beside())
    hand, stopped, taken, before = wandering(counts[-1]), None, np.full(counts[-1], np.nan), 0
    for number in range(1, counts[-1] + 1):
        wheels = wheels_for(hand.send(stopped))
        begun = time.thread_time()
        state.step(wheels)
        taken[number - 1] = time.thread_time() - begun
        stopped = state.stopped
        if number in counts:
            peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
            state.finish()
            steps, before = taken[before:number], number
            print(len(state.grid), peak, np.median(steps), np.percentile(steps, 95))
    state.close()


def main():
    """Print what long drives took; tell whether the steps leave half of the time free."""
    free = True
    for noise in NOISES:
        command = [sys.executable, "-m", "tests.benchmarks.long_drive", str(noise), *map(str, COUNTS)]
        done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT, check=True)
        for count, line in zip(COUNTS, done.stdout.splitlines(), strict=True):
            cells, peak, median, most = map(float, line.split())
            free &= most <= STEP
            print(
                f"noise {1000 * noise:g} mm, {count:4d} steps: {cells:5.0f} cells, peak {peak / 1024:.0f} MB, "
                f"a step {1000 * median:.1f} ms, 95 of 100 below {1000 * most:.1f} ms"
            )
    return free


if __name__ == "__main__":
    if len(sys.argv) > 1:
        drive(float(sys.argv[1]), [int(word) for word in sys.argv[2:]])
    else:
        sys.exit(not main())
