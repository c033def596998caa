"""Speed: ``primkit bench`` times primkit beside other tools.

In:  the options of the command.
Out: a table for each benchmark as it ends; with ``--out`` also CSV and a figure. ``bench`` does the work.
"""

from __future__ import annotations

import argparse

from .. import __version__
from ..bench.command import CSV, EXAMPLES, NAMES, PICTURE, TEXT, texts
from .words import Parser, nearest, path, say, whole

__all__ = ["TEXT", "EXAMPLES", "bench_options", "bench"]


def bench_options(parser: Parser) -> None:
    """Add the options of ``primkit bench``."""
    parser.add_argument("names", metavar="NAME", nargs="*", type=_name, help="which benchmarks (default: all)")
    parser.add_argument("--quick", action="store_true", help="do very little: it shows that all runs")
    parser.option("--seed", "S", whole, 0, "seed of all that is random")
    parser.option("--out", "DIR", path, None, f"folder for {CSV} and {PICTURE}", shown="none is written")


def _name(word: str) -> str:
    if word not in NAMES:
        raise argparse.ArgumentTypeError(f"must be one of {', '.join(NAMES)}, got {word!r}{nearest(word, NAMES)}")
    return word


def bench(arguments: argparse.Namespace) -> None:
    """Run the benchmarks, and print each table as it ends."""
    for text in texts(arguments.names, __version__, quick=arguments.quick, seed=arguments.seed, out=arguments.out):
        say(text)
