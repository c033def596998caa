"""Speed: what finding, driving and starting take; beside an earlier edition and the peers' chain, in turns.

Each round times every edition in a process of its own (``stopwatch``), one right after the other: what slows the
machine slows all of them. Of each map and step the median over the rounds counts.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np

import primkit as pk
from primkit.study.estimate import Estimate, mean_of, ratio_of

from ..bench.machine import version_of
from ..bench.others import chain
from .figures import Figure, goal_of
from .stopwatch import maps

ROOT = Path(__file__).resolve().parents[3]
MOST = {"4 shapes, 0 mm": 8.0, "4 shapes, 2 mm": 12.0, "4 shapes, 5 mm": 25.0, "a step while driving, 2 mm": 15.0}
SLOWEST = 95  # of a hundred steps
TRIALS = 1000  # samples of the peers for each line and circle
Times = dict[str, np.ndarray]


def speed(n: int, seed: int, before: str | None = None) -> Iterator[Figure]:
    """Processor time in milliseconds; n rounds in turns with the edition before, if that is told, and the peers."""
    editions = {"": ROOT} | ({"before": Path(before)} if before else {})
    rounds: dict[str, list[Times]] = {name: [] for name in editions}
    for number in range(n):
        for name in (list(editions), list(editions)[::-1])[number % 2]:
            rounds[name].append(timed(editions[name], seed))
    ours, *others = ({work: np.median([r[work] for r in each], axis=0) for work in each[0]} for each in rounds.values())
    for work, taken in ours.items():
        driving = work.startswith("a step")
        value = percentile_of(taken) if driving else mean_of(taken)
        name = f"{work}{f', {SLOWEST} of 100 below' if driving else ''} [ms]"
        yield Figure(name, value, len(taken), goal_of(None, MOST.get(work)))
        for other in others:
            yield Figure("    times that before", ratio_of(taken, other[work]), len(taken))
    if version_of("scikit-image") and version_of("pyransac3d"):
        peers = chain_times(seed)
        yield Figure("    the peers' chain, told the number, 4 shapes, 0 mm [ms]", mean_of(peers), len(peers))
        yield Figure("    times primkit's", ratio_of(peers, ours["4 shapes, 0 mm"]), len(peers))


def timed(edition: Path, seed: int) -> Times:
    """Return the times of the primkit in a folder."""
    script = Path(__file__).with_name("stopwatch.py")
    paths = {"PYTHONPATH": str(edition), "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    command = [sys.executable, str(script), str(seed)]
    done = subprocess.run(command, capture_output=True, text=True, check=True, env=os.environ | paths, cwd=edition)
    return {work: np.array(taken) for work, taken in json.loads(done.stdout).items()}


def percentile_of(taken: np.ndarray) -> Estimate:
    """Return below what so many of a hundred steps stay; the interval is the bootstrap over steps."""
    drawn = np.random.default_rng(0).choice(taken, (1000, len(taken)))
    low, high = np.percentile(np.percentile(drawn, SLOWEST, axis=1), (2.5, 97.5))
    return Estimate(float(np.percentile(taken, SLOWEST)), float(low), float(high))


def chain_times(seed: int) -> np.ndarray:
    """Return what the peers' chain takes, map by map; the first one is done twice, to load what it loads."""
    taken = []
    for world in [maps()[0], *maps()]:
        grid = pk.Grid()
        grid.add(pk.scan(world, pk.teleport_poses(world)))
        begun = time.process_time()
        chain(grid.points(), len(world.shapes), TRIALS, seed)
        taken.append(1000 * (time.process_time() - begun))
    return np.array(taken[1:])
