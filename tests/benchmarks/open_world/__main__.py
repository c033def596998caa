"""Command: ``python -m tests.benchmarks.open_world LINE [N] [--seed S]`` prints the figures of a line, or of all."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable, Iterator
from functools import partial

from threadpoolctl import threadpool_limits

from .account import account
from .crowded import gaps, planks, strays, walls
from .figures import Figure
from .ordinary import certain, lost, scale
from .simple import simple
from .speed import speed
from .unknown import unknown

# Each line with how many boards, sets or maps it takes when nothing is said.
LINES: dict[str, tuple[Callable[[int, int], Iterator[Figure]], int]] = {
    "lost": (lost, 500),
    "certain": (certain, 300),
    "scale": (scale, 60),
    "unknown": (unknown, 2000),
    "gaps": (gaps, 400),
    "walls": (walls, 200),
    "strays": (strays, 100),
    "planks": (planks, 300),
    "account": (account, 10_000),
    "speed": (speed, 3),
    "simple": (simple, 1),
}


def main() -> bool:
    """Print the figures of the lines that are named; tell whether all goals were reached."""
    parser = argparse.ArgumentParser(prog="open_world", description="what must hold in an open world, measured")
    parser.add_argument(
        "line", nargs="?", choices=[*LINES, "all"], default="all", metavar="LINE", help=f"{', '.join(LINES)}, or all"
    )
    parser.add_argument("n", nargs="?", type=int, metavar="N", help="how many boards (default: each line's own number)")
    parser.add_argument("--seed", type=int, default=0, metavar="S", help="other seeds draw other boards")
    parser.add_argument("--before", metavar="DIR", help="for speed: a folder that holds an earlier edition of primkit")
    asked = parser.parse_args()
    reached = True
    for name in LINES if asked.line == "all" else [asked.line]:
        measure, usual = LINES[name]
        title = (measure.__doc__ or "").splitlines()[0]
        measure = partial(measure, before=asked.before) if measure is speed else measure
        begun = time.process_time()
        print(f"\n{name}, {asked.n or usual} boards, seed {asked.seed}: {title}", flush=True)
        with threadpool_limits(1):
            for figure in measure(asked.n or usual, asked.seed):
                print(figure, flush=True)
                reached &= figure.reached
        print(f"{time.process_time() - begun:.0f} s of processor time")
    return reached


if __name__ == "__main__":
    sys.exit(not main())
