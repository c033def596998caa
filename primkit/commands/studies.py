"""Studies: ``primkit study`` maps many boards, ``primkit accuracy`` changes one thing at a time.

In:  the options of the command.
Out: tables on the screen, all numbers as CSV in a folder, and a journal from which a stopped run continues.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from ..table import count
from .words import Parser, meanwhile, path, say, whole

if TYPE_CHECKING:
    from ..pipeline import Settings
    from ..study import Row
    from ..world import World

MOVEMENTS: tuple[Literal["automatic", "manual"], ...] = ("automatic", "manual")
STUDY_TEXT = "repeat the paper's Tables 1 to 4, or map many boards of yours"
STUDY_EXAMPLES = """\
examples:
  primkit study                          the paper's 34 maps: Tables 1 and 2
  primkit study --movement manual        drives with its four keys: Tables 3 and 4
  primkit study --rows                   recorded and repeated, row by row, too
  primkit study --jobs 1                 one process: the most comparable times
  primkit study --maps maps --out mine   every map in a folder of yours
  primkit study --scheduler tcp://192.168.0.2:8786
                                         on the workers of a dask cluster

Once stopped, a study continues when the same command is given again: finished maps
are in journal.jsonl. --fresh starts anew.
"""
SCRIPTED = "Ours are scripted drives: a program steered them around the shapes and left parts out; nobody drove."
KEYED = "Ours are drives by a rule with the paper's four keys, fixed before it was scored; theirs were not recorded."
ACCURACY_TEXT = "how right, against noise, shapes, scans, strays"
ACCURACY_EXAMPLES = """\
examples:
  primkit accuracy --maps 20             a first look: five minutes on two cores
  primkit accuracy --sweeps gap spurious --settings robust --maps 500
"""


# --- options ------------------------------------------------------------------------------------------------


def study_options(parser: Parser) -> None:
    """Add the options of ``primkit study``."""
    parser.option(
        "--maps", "PATH", path, None, "GeoJSON files, or folders of them", nargs="+", shown="the paper's 34 maps"
    )
    parser.choice("--movement", ("automatic", "manual", "both"), "on way-points, along scripted drives, or both")
    parser.add_argument("--rows", action="store_true", help="print the paper's rows one by one beside ours")
    _many_options(parser, "the methods", "tables and rows as CSV")
    parser.add_argument("--fresh", action="store_true", help="forget the journal of earlier runs")


def accuracy_options(parser: Parser) -> None:
    """Add the options of ``primkit accuracy``."""
    text = "any of suite, noise, shapes, scans, spurious, gap, remedies, partial"
    parser.option("--sweeps", "NAME", str, None, text, nargs="+", shown="all")
    parser.option(
        "--maps", "N", partial(whole, least=1, most=100_000), 100, "number of maps for each line, and of drives"
    )
    _many_options(parser, "maps and noise", "accuracy.csv, accuracy.png and partial.csv")


def _many_options(parser: Parser, seeded: str, files: str) -> None:
    parser.choice("--settings", ("both", "robust", "paper"), "the method: ours, as published, or both")
    parser.option("--seed", "S", whole, 0, f"seed of {seeded}, a whole number")
    parser.option(
        "--jobs", "N", partial(whole, least=1, most=1000), None, "number of processes", shown="one on each core"
    )
    parser.option("--scheduler", "ADDRESS", str, None, "dask cluster that does the work", shown="this machine")
    parser.option("--out", "DIR", path, Path("out"), f"folder for the journal, and {files}")


@contextmanager
def _workers(arguments: argparse.Namespace) -> Iterator[int | None]:
    """Get the workers ready; yields the number of processes, None on a cluster."""
    from ..study import on_cluster

    if arguments.scheduler is None:
        yield -1 if arguments.jobs is None else arguments.jobs
        return
    if arguments.jobs is not None:
        raise ValueError("a cluster works with all of its workers: leave out --jobs or --scheduler")
    with on_cluster(arguments.scheduler):
        yield None


# --- primkit study, primkit accuracy ------------------------------------------------------------------------


def study(arguments: argparse.Namespace) -> None:
    """Map many boards with one method or both, print the tables, and write all numbers."""
    from ..study import JOURNAL, METHODS, make_folder, maps_in, n_rows, row_table, tables, write_tables

    wanted = {name: method for name, method in METHODS.items() if arguments.settings in ("both", name.lower())}
    maps = None if arguments.maps is None else maps_in(arguments.maps)
    out = make_folder(arguments.out)
    journal = out / JOURNAL
    if arguments.fresh:
        journal.unlink(missing_ok=True)
    told = "34 maps, three times" if maps is None else count(len(maps), "map")
    meanwhile(f"{told} with {' and '.join(wanted)}; finished ones are kept in {journal}")
    before = n_rows(journal)
    rows = _repeated(arguments, wanted, out) if maps is None else _mapped(arguments, maps, wanted, out)
    kept = len(rows) - (n_rows(journal) - before)
    made = [*tables(rows, driven=KEYED if maps is None else SCRIPTED), *[row_table(rows)] * arguments.rows]
    for table in made:
        say(f"{table}\n")
    files = write_tables(out, made, rows)
    if arguments.movement != "automatic":
        files.append(_say_seen(rows, out))
    n_maps = len({row.map for row in rows})
    say(f"Maps   {n_maps} with {' and '.join(wanted)}; {kept} of {len(rows)} results were in the journal already")
    say(f"Wrote  {', '.join(str(out / name) for name in (*files, JOURNAL))}")
    say(f"Next   open {out / 'rows.csv'}: one line for each map and method, times included.")


def _repeated(arguments: argparse.Namespace, wanted: Mapping[str, Settings], out: Path) -> list[Row]:
    """Return the rows of the paper's experiments, repeated."""
    from ..study import repeat_study

    movements = [movement for movement in MOVEMENTS if arguments.movement in (movement, "both")]
    with _workers(arguments) as jobs:
        return repeat_study(movements, settings=wanted, folder=out, jobs=jobs, seed=arguments.seed)


def _mapped(
    arguments: argparse.Namespace, maps: Mapping[str, World], wanted: Mapping[str, Settings], out: Path
) -> list[Row]:
    """Return the rows of maps of the user's own."""
    from ..study import drives_on, run_study

    rows = []
    with _workers(arguments) as jobs:
        for movement in MOVEMENTS:
            if arguments.movement in (movement, "both"):
                drives = drives_on(maps, seed=arguments.seed) if movement == "manual" else None
                rows += run_study(maps, wanted, folder=out, drives=drives, jobs=jobs, seed=arguments.seed)
    return rows


def _say_seen(rows: list[Row], out: Path) -> str:
    """Print how right the shapes are by how much of them was seen, write it, and return the file's name."""
    from ..formats import write_atomically
    from ..study import seen_table

    table = seen_table(rows)
    say(f"{table}\n")
    write_atomically(out / table.file, table.csv())
    return table.file


def accuracy(arguments: argparse.Namespace) -> None:
    """Change one thing at a time; print how right each method is, and write all numbers and a figure."""
    from ..plots import PANELS, plot_accuracy, save_figure
    from ..study import JOURNAL, METHODS, accuracy_study, make_folder

    wanted = {name: method for name, method in METHODS.items() if arguments.settings in ("both", name.lower())}
    out, made = make_folder(arguments.out), []
    meanwhile(f"{count(arguments.maps, 'map')} for each line; finished ones are kept in {out / JOURNAL}")
    with _workers(arguments) as jobs:
        for table in accuracy_study(
            arguments.sweeps, arguments.maps, out, settings=wanted, seed=arguments.seed, jobs=jobs
        ):
            say(f"{table}\n")
            made.append(table)
    if drawn := [table for table in made if table.name in PANELS]:
        save_figure(plot_accuracy(drawn), out / "accuracy.png")
    files = [*dict.fromkeys(table.file for table in made), *["accuracy.png"] * bool(drawn)]
    say(f"Wrote  {', '.join(str(out / name) for name in files)}")
