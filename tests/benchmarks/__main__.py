"""Speed: ``python -m tests.benchmarks`` times primkit beside other tools that do the same work.

In:  names of benchmarks and options; ``--help`` lists them.
Out: a table for each benchmark as it ends; with ``--out`` also CSV and a figure.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence

from primkit import __version__
from primkit.commands.words import LOOK, Parser, exit_code, nearest, path, say, whole

from .bench.command import CSV, EXAMPLES, NAMES, PICTURE, TEXT, texts


def main(argv: Sequence[str] | None = None) -> int:
    """Run the benchmarks that are named, print each table as it ends, and return the exit code."""

    def run() -> None:
        options = _parser().parse_args(argv)
        for text in texts(options.names, __version__, quick=options.quick, seed=options.seed, out=options.out):
            say(text)

    return exit_code(run)


def _parser() -> Parser:
    parser = Parser(prog="benchmarks", description=f"{TEXT[0].upper()}{TEXT[1:]}.", epilog=EXAMPLES, **LOOK)
    parser.add_argument("names", metavar="NAME", nargs="*", type=_name, help="which benchmarks (default: all)")
    parser.add_argument("--quick", action="store_true", help="do very little: it shows that all runs")
    parser.option("--seed", "S", whole, 0, "seed of all that is random")
    parser.option("--out", "DIR", path, None, f"folder for {CSV} and {PICTURE}", shown="none is written")
    return parser


def _name(word: str) -> str:
    if word not in NAMES:
        raise argparse.ArgumentTypeError(f"must be one of {', '.join(NAMES)}, got {word!r}{nearest(word, NAMES)}")
    return word


if __name__ == "__main__":
    sys.exit(main())
