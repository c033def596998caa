"""Command: which benchmarks there are, one after the other.

In:  names of benchmarks, a seed, a folder or none.
Out: texts to be printed as they come; ``bench.csv`` and ``bench.png`` in the folder.

Nothing heavy is loaded before a benchmark runs: the command line's help must answer at once.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .effort import Effort
    from .results import Result
    from .scanning import Curve

NAMES = {
    "scan": "many scans, and one at a time, beside numba, shapely and ir-sim",
    "sizes": "scans on boards with 4 to 10,000 shapes",
    "memory": "the peak of memory of a million scans",
    "shapes": "finding all shapes, beside the paper's chain of libraries",
    "kernels": "one line, one circle, beside scikit-image, pyransac3d and circle-fit",
    "live": "scan, grid and shapes while driving",
    "import": "the start",
    "study": "many maps on one process and on two",
}
TEXT = "time primkit beside other tools that do the same work"
EXAMPLES = (
    "examples:\n"
    "  python -m tests.benchmarks --quick                  rough figures, within a minute\n"
    "  python -m tests.benchmarks scan sizes --out bench   two in full; CSV and a figure\n"
    "\nbenchmarks:\n" + "".join(f"  {name:8} {text}\n" for name, text in NAMES.items())
)
CSV, PICTURE = "bench.csv", "bench.png"


def texts(names: Sequence[str], version: str, *, quick: bool, seed: int, out: Path | None) -> Iterator[str]:
    """Run the benchmarks and yield what is to be printed: the machine, a table for each, the files."""
    from threadpoolctl import threadpool_limits

    from .effort import FULL, QUICK
    from .machine import described

    if out is not None:
        from primkit.study import make_folder

        make_folder(out)
    yield described(version)
    results: list[Result] = []
    curves: dict[str, Curve] = {}
    with threadpool_limits(1):  # of the linear algebra: all tools get one core
        for name in dict.fromkeys(names) or NAMES:
            result, found = _run(name, QUICK if quick else FULL, seed)
            results.append(result)
            curves |= found
            yield f"\n{result}"
    if out is not None:
        yield f"\nWrote  {', '.join(map(str, _write(out, results, curves)))}"


def _run(name: str, effort: Effort, seed: int) -> tuple[Result, dict[str, Curve]]:
    """Run one benchmark; each loads only what it needs."""
    if name in ("scan", "sizes"):
        from .scanning import bench_scan, bench_sizes

        return (bench_scan(effort, seed), {}) if name == "scan" else bench_sizes(effort, seed)
    if name in ("shapes", "kernels"):
        from .finding import bench_kernels, bench_shapes

        return (bench_shapes if name == "shapes" else bench_kernels)(effort, seed), {}
    if name == "live":
        from .driving import bench_live

        return bench_live(effort, seed), {}
    from .processes import bench_import, bench_memory, bench_study

    return {"import": bench_import, "memory": bench_memory, "study": bench_study}[name](effort, seed), {}


def _write(out: Path, results: Sequence[Result], curves: dict[str, Curve]) -> list[Path]:
    """Write all rows, and the figure if there are curves; return the files."""
    from primkit.formats import write_atomically

    from .results import results_as_csv

    write_atomically(out / CSV, results_as_csv(results))
    if not curves:
        return [out / CSV]
    from primkit.plots import save_figure

    from .timing import bench_figure

    save_figure(bench_figure(curves), out / PICTURE)
    return [out / CSV, out / PICTURE]
