"""The command line: ``primkit``, or ``python -m primkit``.

In:  a command and its options; ``primkit map --help`` explains them.
Out: text on the screen, files in a folder, and an exit code: 0 done, 2 a wrong value or a file that cannot be
     read or written (one sentence on stderr says which), 130 stopped by Ctrl-C.

>>> main(["--version"])  # doctest: +ELLIPSIS
primkit ...
0

Only argparse is loaded at first; each command loads what it needs, so that ``--help`` answers at once.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Callable, Sequence
from functools import partial
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, NoReturn

from . import __version__
from .bench import command as benches

if TYPE_CHECKING:
    from .evaluation import Report
    from .lidar import Lidar
    from .measure import Detection
    from .study import Run
    from .world import Style, World

SHAPES = 4

EXAMPLES = """\
examples:
  primkit map                            a random board with four shapes, into out/
  primkit study                          the paper's Tables 1 and 2 beside ours
  primkit make-map --shapes 6 --style free --out room.geojson
  primkit map --map room.geojson         a board of your own
"""
MAP_EXAMPLES = """\
examples:
  primkit map
  primkit map --shapes 3 --seed 11 --style free
  primkit map --settings paper           the published method
  primkit map --noise 2 --spurious 0.01  a worse sensor: 2 mm, and 1 % of random ranges
"""
STUDY_EXAMPLES = """\
examples:
  primkit study                          34 maps, both methods
  primkit study --jobs 1                 one process: the most comparable times
  primkit study --maps maps --out mine   every map in a folder of yours

Once stopped, a study continues when the same command is given again: finished maps
are in journal.jsonl. --fresh starts anew.
"""
ACCURACY_EXAMPLES = """\
examples:
  primkit accuracy --maps 20             a first look: five minutes on two cores
  primkit accuracy --sweeps gap spurious --settings robust --maps 500
"""
MAKE_EXAMPLES = """\
examples:
  primkit make-map --shapes 3 --seed 11
  primkit make-map --kinds circle circle pentagon --out room.geojson
  primkit make-map --shapes 6 --style free --gap 30 --out room.geojson
"""

_LOOK: dict[str, Any] = {"formatter_class": argparse.RawDescriptionHelpFormatter, "allow_abbrev": False}


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command and return its exit code.

    Parameters
    ----------
    argv : sequence of str, optional
        The words after ``primkit``; those of the command line when not given.
    """
    try:
        try:
            arguments = _parser().parse_args(argv)
            arguments.run(arguments)
        finally:
            sys.stdout.flush()  # that nobody reads on is noticed here, not while Python shuts down
    except SystemExit as end:  # argparse's, after --help or a wrong value
        return int(end.code or 0)
    except BrokenPipeError:  # as in `primkit study | head`: nobody reads on, and nothing is wrong
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except KeyboardInterrupt as stop:
        return _complain(str(stop) or "stopped by Ctrl-C", 130)
    except OSError as error:
        # Sentences from formats stand alone; the system's own come in parts.
        return _complain(f"{error.filename}: {error.strerror}" if error.filename else str(error))
    except ValueError as error:
        return _complain(f"{error}{''.join(f' ({note})' for note in getattr(error, '__notes__', ()))}")
    return 0


# --- primkit map --------------------------------------------------------------------------------------------


def map_board(arguments: argparse.Namespace) -> None:
    """Simulate one board, map it, print how right it is, and write the picture and the maps."""
    from .evaluation import evaluate
    from .lidar import Lidar
    from .study import METHODS, Experiment, make_folder, run

    world, origin = _board(arguments)
    lidar = Lidar(noise_std=arguments.noise / 1000, spurious=arguments.spurious)
    method = arguments.settings.upper()
    out = make_folder(arguments.out)
    _say(f"Board  {_census(world)}; {world.size:g} m x {world.size:g} m ({origin})")
    done = run(Experiment("board", world, method, METHODS[method], lidar, seed=arguments.seed))
    report = evaluate(done.found, world)
    _tell(world, lidar, done, method)
    _say(f"\n{report}\n")
    _write(out, world, done, report, arguments.seed)


def _board(arguments: argparse.Namespace) -> tuple[World, str]:
    """Return the user's board, or a random one, and where it comes from."""
    from .formats import load_world
    from .world import random_world

    if arguments.map is not None:
        given = [f"--{name}" for name in ("shapes", "style") if getattr(arguments, name) is not None]
        if given:
            raise ValueError(f"a board is either a file or random: leave out --map or {' and '.join(given)}")
        return load_world(arguments.map), str(arguments.map)
    n = SHAPES if arguments.shapes is None else arguments.shapes
    style: Style = arguments.style or "paper"
    return random_world(n, style=style, rng=arguments.seed), f"random: seed {arguments.seed}, {style} style"


def _tell(world: World, lidar: Lidar, done: Run, method: str) -> None:
    """Print what the robot did, saw and found, and how long it took."""
    from .robot import skipped_waypoints

    skipped = skipped_waypoints(world)
    n_poses = len(done.scans) + len(skipped)
    places = " ".join(f"({x:.2f}, {y:.2f})" for x, y, _ in skipped.round(2) + 0.0)  # + 0.0: not -0.00
    noise, number = 1000 * lidar.noise_std, "" if done.told is None else f", being told that there are {done.told}"
    _say(f"Robot  {n_poses} way-points, {len(skipped)} skipped inside a shape{f': {places} m' if places else ''}")
    _say(f"LiDAR  {done.scans.hits.sum()} hits on {len(done.points)} cells of 1 mm; range noise {noise:g} mm")
    _say(f"Found  {_count(len(done.found), 'shape')} with the settings {method}{number}")
    robot = f"{done.robot_time:.1f} s (all way-points x {lidar.period:g} s)"
    _say(f"Time   robot {robot}, computing {done.computing_time:.2f} s")


def _write(out: Path, world: World, done: Run, report: Report, seed: int) -> None:
    """Write the picture and the two maps, and say what to open."""
    from .formats import save_world
    from .plots import plot_story, save_figure
    from .segmentation import segment
    from .world import World

    method: Literal["link", "kmeans"] = "link" if done.told is None else "kmeans"
    labels = segment(done.points, done.told, method=method, rng=seed)
    save_figure(plot_story(world, done.scans, done.points, labels, done.found, report), out / "map.png")
    save_world(World([d.shape for d in done.found], world.size), out / "found.geojson", properties=_known(done.found))
    save_world(world, out / "truth.geojson")
    _say(f"Wrote  {out / 'map.png'}, {out / 'found.geojson'}, {out / 'truth.geojson'}")
    _say(f"Next   open {out / 'map.png'} to see it all; in Python, primkit.load_world reads the two maps.")


def _census(world: World) -> str:
    kinds = ", ".join(shape.kind for shape in world.shapes)
    return _count(len(world.shapes), "shape") + (f": {kinds}" if kinds else "")


def _known(found: Sequence[Detection]) -> list[dict[str, Any]]:
    """Return what is known of each found shape beside its outline; metres, and None for what is not finite."""
    known = []
    for d in found:
        rms, margin = (value if isfinite(value) else None for value in (d.rms, d.margin))
        known.append({"rms": rms, "margin": margin, "n_points": len(d.points), "seen": d.seen})
    return known


# --- primkit study ------------------------------------------------------------------------------------------


def study(arguments: argparse.Namespace) -> None:
    """Map many boards with one method or both, print the tables, and write all numbers."""
    from .formats import paper_suite
    from .study import JOURNAL, METHODS, make_folder, maps_in, n_rows, run_study, tables, write_tables

    wanted = {name: method for name, method in METHODS.items() if arguments.settings in ("both", name.lower())}
    maps = paper_suite() if arguments.maps is None else maps_in(arguments.maps)
    out = make_folder(arguments.out)
    journal = out / JOURNAL
    if arguments.fresh:
        journal.unlink(missing_ok=True)
    before = n_rows(journal)
    rows = run_study(maps, wanted, folder=out, jobs=arguments.jobs, seed=arguments.seed)
    kept = len(rows) - (n_rows(journal) - before)
    made = tables(rows)
    for table in made:
        _say(f"{table}\n")
    files = write_tables(out, made, rows)
    _say(f"Maps   {len(maps)} with {' and '.join(wanted)}; {kept} of {len(rows)} results were in the journal already")
    _say(f"Wrote  {', '.join(str(out / name) for name in (*files, JOURNAL))}")
    _say(f"Next   open {out / 'rows.csv'}: one line for each map and method, times included.")


def accuracy(arguments: argparse.Namespace) -> None:
    """Change one thing at a time; print how right each method is, and write all numbers and a figure."""
    from .plots import PANELS, plot_accuracy, save_figure
    from .study import METHODS, AccuracyTable, accuracy_study, make_folder

    wanted = {name: method for name, method in METHODS.items() if arguments.settings in ("both", name.lower())}
    out, made, more = make_folder(arguments.out), [], {"seed": arguments.seed, "jobs": arguments.jobs}
    for table in accuracy_study(arguments.sweeps, arguments.maps, out, settings=wanted, **more):
        _say(f"{table}\n")
        made.append(table)
    if drawn := [table for table in made if isinstance(table, AccuracyTable) and table.sweep in PANELS]:
        save_figure(plot_accuracy(drawn), out / "accuracy.png")
    files = [*dict.fromkeys(table.file for table in made), *["accuracy.png"] * bool(drawn)]
    _say(f"Wrote  {', '.join(str(out / name) for name in files)}")


# --- primkit make-map ---------------------------------------------------------------------------------------


def make_map(arguments: argparse.Namespace) -> None:
    """Write a random board to a file."""
    from .formats import save_world
    from .world import random_world

    kinds, n = arguments.kinds, arguments.shapes
    style: Style = arguments.style or "paper"
    if n is None:
        n = SHAPES if kinds is None else len(kinds)
    world = random_world(n, style=style, kinds=kinds, gap=arguments.gap / 1000, rng=arguments.seed)
    save_world(world, arguments.out)
    _say(f"Board  {_census(world)} (random: seed {arguments.seed}, {style} style, gap {arguments.gap:g} mm)")
    _say(f"Wrote  {arguments.out}")
    _say(f"Next   primkit map --map {arguments.out}")


def bench(words: argparse.Namespace) -> None:
    """Time primkit beside other tools, and print a table for each benchmark as it ends."""
    for text in benches.texts(words.names, __version__, quick=words.quick, seed=words.seed, out=words.out):
        _say(text)


# --- words in -----------------------------------------------------------------------------------------------


class _Parser(argparse.ArgumentParser):
    """A parser that refuses in one sentence, without the usage in front of it."""

    def error(self, message: str) -> NoReturn:
        self.exit(2, f"{self.prog}: {message} (see {self.prog} --help)\n")

    def option(self, name: str, metavar: str, kind: Callable[[str], Any], default: Any, text: str, **more: Any) -> None:
        """Add an option whose help ends with its default."""
        if "shown" in more:
            default, shown = None, more.pop("shown")
        else:
            shown = f"{default:g}" if isinstance(default, float) else default
        self.add_argument(name, metavar=metavar, type=kind, default=default, help=f"{text} (default: {shown})", **more)


def _parser() -> _Parser:
    text = "Map circles, triangles, rectangles and pentagons with a simulated robot and its LiDAR."
    parser = _Parser(prog="primkit", description=text, epilog=EXAMPLES, **_LOOK)
    parser.add_argument("--version", action="version", version=f"primkit {__version__}")
    parser.set_defaults(run=lambda _: parser.print_help())
    commands = parser.add_subparsers(title="commands", metavar="COMMAND")
    for name, run, text, examples, options in (
        ("map", map_board, "simulate a board, map it, and compare with the truth", MAP_EXAMPLES, _map_options),
        ("study", study, "map many boards: the paper's Tables 1 and 2 beside ours", STUDY_EXAMPLES, _study_options),
        ("accuracy", accuracy, "how right, against noise, shapes, scans, strays", ACCURACY_EXAMPLES, _accuracy_options),
        ("make-map", make_map, "write a random board to a GeoJSON file", MAKE_EXAMPLES, _make_map_options),
        ("bench", bench, benches.TEXT, benches.EXAMPLES, partial(benches.add_options, whole=_whole)),
    ):
        description = f"{text[0].upper()}{text[1:]}."
        command = commands.add_parser(name, help=text, description=description, epilog=examples, **_LOOK)
        command.set_defaults(run=run)
        options(command)
    return parser


def _map_options(parser: _Parser) -> None:
    _board_options(parser)
    parser.option("--map", "FILE", Path, None, "a board of your own, GeoJSON", shown="a random one")
    _choice(parser, "--settings", ("robust", "paper"), "the method: ours, or as published")
    parser.option("--noise", "MM", _millimetres, 0.0, "standard deviation of the ranges in mm")
    parser.option("--spurious", "SHARE", _share, 0.0, "share of beams with a random range, 0 to 1")
    parser.option("--out", "DIR", Path, Path("out"), "folder for map.png, found.geojson and truth.geojson")


def _study_options(parser: _Parser) -> None:
    parser.option(
        "--maps", "PATH", Path, None, "GeoJSON files, or folders of them", nargs="+", shown="the paper's 34 maps"
    )
    _many_options(parser, "the methods", "tables and rows as CSV")
    parser.add_argument("--fresh", action="store_true", help="forget the journal of earlier runs")


def _accuracy_options(parser: _Parser) -> None:
    text = "any of suite, noise, shapes, scans, spurious, gap, remedies, partial"
    parser.option("--sweeps", "NAME", str, None, text, nargs="+", shown="all")
    parser.option("--maps", "N", partial(_whole, least=1), 100, "number of maps for each line, and of drives")
    _many_options(parser, "maps and noise", "accuracy.csv, accuracy.png and partial.csv")


def _many_options(parser: _Parser, seeded: str, files: str) -> None:
    _choice(parser, "--settings", ("both", "robust", "paper"), "the method: ours, as published, or both")
    parser.option("--seed", "S", _whole, 0, f"seed of {seeded}, a whole number")
    parser.option("--jobs", "N", partial(_whole, least=1), -1, "number of processes", shown="one on each core")
    parser.option("--out", "DIR", Path, Path("out"), f"folder for the journal, and {files}")


def _make_map_options(parser: _Parser) -> None:
    _board_options(parser)
    parser.option("--gap", "MM", _millimetres, 50.0, "least distance between two shapes in mm")
    kinds = "circle, triangle, rectangle or pentagon, for each shape"
    parser.option("--kinds", "KIND", str, None, kinds, nargs="+", shown="drawn")
    parser.option("--out", "FILE", Path, Path("map.geojson"), "the file; one that is there is replaced")


def _board_options(parser: _Parser) -> None:
    parser.option("--shapes", "N", _whole, None, "number of shapes on a board of 1 m x 1 m", shown=SHAPES)
    parser.option("--seed", "S", _whole, 7, "seed of all that is random, a whole number")
    _choice(parser, "--style", ("paper", "free"), "paper: upright, at most 4 shapes; free: at any angle", shown="paper")


def _choice(parser: _Parser, name: str, words: Sequence[str], text: str, **more: Any) -> None:
    """Add an option that takes one of these words, the first by default."""

    def one_of(word: str) -> str:
        if word not in words:
            raise argparse.ArgumentTypeError(f"must be {' or '.join(words)}, got {word!r}")
        return word

    parser.option(name, "|".join(words), one_of, words[0], text, **more)


def _whole(word: str, least: int = 0) -> int:
    if not (word.isascii() and word.isdigit() and len(word) < 20 and int(word) >= least):
        raise argparse.ArgumentTypeError(f"must be a whole number >= {least}, got {word!r}")
    return int(word)


def _number(word: str, most: float, rule: str) -> float:
    try:
        number = float(word)
    except ValueError:
        number = -1.0
    if not 0 <= number <= most:
        raise argparse.ArgumentTypeError(f"must be {rule}, got {word!r}")
    return number


_millimetres = partial(_number, most=sys.float_info.max, rule="a number of millimetres >= 0")
_share = partial(_number, most=1.0, rule="a share from 0 to 1")


# --- words out ----------------------------------------------------------------------------------------------


def _count(n: int, noun: str) -> str:
    return f"{n} {noun}{'s' * (n != 1)}"


def _say(text: str) -> None:
    """Print; what the console has no sign for, in the name of a file, is spelled out."""
    encoding = sys.stdout.encoding or "utf-8"
    print(text.encode(encoding, "backslashreplace").decode(encoding))


def _complain(sentence: str, code: int = 2) -> int:
    print(f"primkit: {sentence}", file=sys.stderr)
    return code


if __name__ == "__main__":
    sys.exit(main())
