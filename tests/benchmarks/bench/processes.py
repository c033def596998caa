"""Processes: what must be measured in fresh ones: the start, the peak of memory, a study on one core and on two.

In:  an ``Effort`` and a seed.
Out: a ``Result`` each.
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from functools import partial

import numpy as np

from primkit.pipeline import ROBUST
from primkit.study import run_study
from primkit.world import random_world

from .clock import Spread, in_turns
from .effort import Effort
from .results import Fact, Result, Row
from .scanning import SHAPES

STUDY_PROCESSES = 2
MEGA = 1e6

# --- the start ----------------------------------------------------------------------------------------------

FIRST_USE = (
    "import primkit as pk; pk.random_world, pk.teleport_poses, pk.scan, pk.Lidar, pk.Grid, pk.find_shapes, pk.evaluate"
)
BASE = "import numpy, shapely"
STARTS = {
    BASE: BASE,
    "import primkit": "import primkit",
    "import primkit, and name all that the README's ten lines use": FIRST_USE,
}
TIMED = "from time import perf_counter as now; begun = now(); {}; print(now() - begun)"


def bench_import(effort: Effort, seed: int) -> Result:  # noqa: ARG001 - nothing here is random
    """Time the imports in fresh processes."""
    taken: dict[str, list[float]] = {name: [] for name in STARTS}
    for number in range(effort.starts + 1):
        for name, statement in STARTS.items():
            time = 1000 * float(_fresh(TIMED.format(statement)))
            if number > 0:  # the first of all reads from the disk
                taken[name].append(time)
    base = np.array(taken[BASE])
    rows = tuple(
        Row("fresh processes", name, Spread.of(each), None if name == BASE else Spread.of(np.array(each) / base))
        for name, each in taken.items()
    )
    return Result(
        "import",
        "The start: importing in a fresh process",
        "ms",
        "times numpy and shapely",
        rows,
        (
            f"Medians of {effort.starts} processes each, in turns, with the least and the greatest. Python's own start "
            "is not counted. primkit loads its modules when they are first used.",
        ),
    )


def _fresh(code: str, *words: str) -> str:
    """Run code in a new process, and return what it prints."""
    command = [sys.executable, "-c", code, *words]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


# --- the peak of memory -------------------------------------------------------------------------------------

# The peak of the process since it began; on Linux from the system's own account, because what getrusage says includes
# the parent's memory at the moment of the fork.
PEAK = """
def peak():
    import sys
    try:
        with open("/proc/self/status") as lines:
            return 1024 * int(next(line for line in lines if line.startswith("VmHWM")).split()[1])
    except OSError:
        pass
    try:
        import resource
    except ImportError:  # Windows
        return 0
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * (1 if sys.platform == "darwin" else 1024)
"""
MANY = (
    PEAK
    + """
import sys
from time import perf_counter
import numpy as np
import primkit as pk

n, seed, streamed = int(sys.argv[1]), int(sys.argv[2]), sys.argv[3] == STREAMED
world, lidar = pk.paper_suite()["4-01"], pk.Lidar(noise_std=0.002)
rng = np.random.default_rng(seed)
poses = np.column_stack([rng.uniform(-0.5, 0.5, (n, 2)), rng.uniform(-np.pi, np.pi, n)])
grid = pk.Grid()
grid.add(pk.scan(world, poses[:1]))
before, begun = peak(), perf_counter()
if streamed:
    for scans in pk.scan_blocks(world, poses, lidar, rng=seed):
        grid.add(scans)
else:
    pk.scan(world, poses, lidar, rng=seed)
print(before, peak(), perf_counter() - begun)
"""
)
STREAMED = "scan_blocks, each added to a grid"
AT_ONCE = "scan, all in one call"


def bench_memory(effort: Effort, seed: int) -> Result:
    """Measure the peak of memory of very many scans, all at once and block by block."""
    rows = []
    for name in (STREAMED, AT_ONCE):
        printed = _fresh(f"STREAMED = {STREAMED!r}{MANY}", str(effort.many), str(seed), name)
        before, peak, time = map(float, printed.split())
        facts: dict[str, Fact] = {"before [MB]": before / MEGA, "us per scan": MEGA * time / effort.many}
        rows.append(Row(f"{effort.many:,} poses", name, Spread.of([peak / MEGA]) if peak else None, facts=facts))
    table = 8 * 100 * effort.many / MEGA
    return Result(
        "memory",
        "The peak of memory: very many noisy scans of a map with 4 shapes, each in a fresh process",
        "MB at the peak",
        "",
        tuple(rows),
        (
            f'"before": with the libraries loaded and the poses drawn. The ranges of {effort.many:,} scans take '
            f"{table:,.0f} MB by themselves: all in one call can never take less. Blocks are of 10,000 scans.",
        ),
    )


# --- a study ------------------------------------------------------------------------------------------------

# Maps are drawn as they are needed: the first tenth of a long study has nearly all that memory ever holds.
LONG = (
    PEAK
    + """
import sys
import numpy as np
from primkit.pipeline import ROBUST
from primkit.study import run_study
from primkit.world import random_world

n, shapes, seed = map(int, sys.argv[1:])
peaks = []

def maps():
    for number in range(n):
        if number == max(1, n // 10):
            peaks.append(peak())
        yield random_world(shapes, rng=np.random.default_rng([seed, number]))

run_study(maps(), {"ROBUST": ROBUST}, seed=seed, jobs=1, progress=False)
print(*peaks, peak())
"""
)


def bench_study(effort: Effort, seed: int) -> Result:
    """Time a study of many maps on one process and on two, and measure how its memory grows."""
    maps = {
        str(number): random_world(SHAPES, rng=np.random.default_rng([seed, number])) for number in range(effort.worlds)
    }
    found: dict[int, object] = {}

    def study(jobs: int) -> None:
        found[jobs] = run_study(maps, {"ROBUST": ROBUST}, seed=seed, jobs=jobs, progress=False)

    names = {1: "1 process", STUDY_PROCESSES: f"{STUDY_PROCESSES} processes"}
    tools: dict[str, Callable[[], object]] = {name: partial(study, jobs) for jobs, name in names.items()}
    taken = in_turns(tools, rounds=max(2, effort.rounds // 3))
    one, two = taken.values()
    case, same = f"{effort.worlds:,} maps with {SHAPES} shapes", "yes" if found[1] == found[STUDY_PROCESSES] else "no"
    rates: list[dict[str, Fact]] = [{"maps a second": effort.worlds / float(np.median(each))} for each in (one, two)]
    early, late = map(float, _fresh(LONG, str(effort.worlds), str(SHAPES), str(seed)).split())
    memory: dict[str, Fact] = {"MB after a tenth": early / MEGA, "MB at the end": late / MEGA} if late else {}
    rows = (
        Row(case, names[1], Spread.of(one), facts=rates[0] | memory),
        Row(case, names[STUDY_PROCESSES], Spread.of(two), Spread.of(one / two), facts=rates[1] | {"same rows": same}),
    )
    return Result(
        "study",
        "A study: many maps, with ROBUST",
        "s",
        "times as fast as 1 process",
        rows,
        (
            f"Medians of {len(one)} rounds in turns, after one for warming up, with the least and the greatest. Each "
            "process has one thread. Two processes can be twice as fast only where two cores are free.",
            '"MB": the peak of memory of one process, in one more run, from a fresh start.',
        ),
    )
