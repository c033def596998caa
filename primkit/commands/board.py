"""Board: ``primkit map`` maps one board, or what a robot recorded; ``primkit make-map`` draws a board.

In:  the options of the command.
Out: a report on the screen, a picture and maps in a folder; or one map in a file.
"""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from ..installed import quoted
from ..table import count
from .recording import LIDARS, lidar_named, map_recording, span
from .words import Parser, millimetres, path, say, share, whole

if TYPE_CHECKING:
    from ..lidar import Lidar
    from ..report import Report
    from ..study import Run
    from ..world import Style, World

SHAPES = 4

MAP_TEXT = "simulate a board, map it, and compare with the truth; or map what a robot recorded"
MAP_EXAMPLES = """\
examples:
  primkit map
  primkit map --shapes 3 --seed 11 --style free
  primkit map --settings paper           the published method
  primkit map --noise 2 --spurious 0.01  a worse sensor: 2 mm, and 1 % of random ranges
  primkit map --scans drive.bag --topic /scan /odom
  primkit map --scans sweep.csv --lidar rplidar-a1 --units deg mm
"""
MAKE_TEXT = "write a random board to a GeoJSON file"
MAKE_EXAMPLES = """\
examples:
  primkit make-map --shapes 3 --seed 11
  primkit make-map --kinds circle circle pentagon --out room.geojson
  primkit make-map --shapes 6 --style free --gap 30 --out room.geojson
"""


# --- options ------------------------------------------------------------------------------------------------


def map_options(parser: Parser) -> None:
    """Add the options of ``primkit map``."""
    _board_options(parser)
    parser.option("--map", "FILE", path, None, "a board of your own, GeoJSON", shown="a random one")
    parser.choice("--settings", ("robust", "paper"), "the method: ours, or as published")
    parser.option("--noise", "MM", millimetres, 0.0, "standard deviation of the ranges in mm")
    parser.option("--spurious", "SHARE", share, 0.0, "share of beams with a random range, 0 to 1")
    parser.option("--out", "DIR", path, Path("out"), "folder for map.png, found.geojson and truth.geojson")
    recorded = parser.add_argument_group("what a robot recorded")
    kinds = "scans to map in place of a board: .log(.gz) of CARMEN, .bag, .db3 or .mcap of ROS, .csv, .npz"
    recorded.add_argument("--scans", metavar="FILE", type=path, help=kinds)
    recorded.add_argument("--topic", metavar="NAME", nargs="+", default=(), help="which laser and which odometry")
    recorded.add_argument("--units", metavar="UNIT", nargs="+", default=(), help="of a table: deg or rad, mm, cm or m")
    recorded.add_argument(
        "--lidar", metavar="|".join(LIDARS), type=lidar_named, help="the sensor, if the file is silent"
    )
    recorded.add_argument("--only", metavar="A:B", type=span, help="scans A to B - 1, from 0 (default: all)")
    recorded.add_argument("--cell", metavar="MM", type=millimetres, help="side of the cells (default: by the ranges)")


def make_map_options(parser: Parser) -> None:
    """Add the options of ``primkit make-map``."""
    _board_options(parser)
    parser.option("--gap", "MM", millimetres, 50.0, "least distance between two shapes in mm")
    kinds = "circle, triangle, rectangle or pentagon, for each shape; in the style any also polygon, star, L ..."
    parser.add_argument("--walls", action="store_true", help="put walls around the board")
    parser.option("--kinds", "KIND", str, None, kinds, nargs="+", shown="drawn")
    parser.option("--out", "FILE", path, Path("map.geojson"), "the file; one that is there is replaced")


def _board_options(parser: Parser) -> None:
    parser.option("--shapes", "N", whole, None, "number of shapes on a board of 1 m x 1 m", shown=SHAPES)
    parser.option("--seed", "S", whole, 7, "seed of all that is random, a whole number")
    styles = "paper: upright, at most 4 shapes; free: at any angle; any: other polygons too"
    parser.choice("--style", ("paper", "free", "any"), styles, shown="paper")


# --- primkit map --------------------------------------------------------------------------------------------


def map_board(arguments: argparse.Namespace) -> None:
    """Simulate one board, map it, print how right it is, and write the picture and the maps; or map a recording."""
    if arguments.scans is not None:
        map_recording(arguments)
        return
    from ..evaluation import evaluate
    from ..lidar import Lidar
    from ..study import METHODS, Experiment, make_folder, run

    world, origin = _board(arguments)
    usual = Lidar().scaled(world.scale)
    lidar = replace(usual, noise_std=arguments.noise / 1000, spurious=arguments.spurious)
    method = arguments.settings.upper()
    out = make_folder(arguments.out)
    say(f"Board  {_census(world)}; {world.size:g} m x {world.size:g} m ({origin})")
    done = run(Experiment("board", world, method, METHODS[method], lidar, seed=arguments.seed))
    report = evaluate(done.found, world)
    _tell(world, lidar, done, method)
    say(f"\n{report}\n")
    _write(out, world, done, report, arguments.seed)


def _board(arguments: argparse.Namespace) -> tuple[World, str]:
    """Return the user's board, or a random one, and where it comes from."""
    from ..formats import load_world
    from ..world import random_world

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
    from ..robot import skipped_waypoints

    skipped = skipped_waypoints(world)
    n_poses = len(done.scans) + len(skipped)
    places = " ".join(f"({x:.2f}, {y:.2f})" for x, y, _ in skipped.round(2) + 0.0)  # + 0.0: not -0.00
    noise, number = 1000 * lidar.noise_std, "" if done.told is None else f", being told that there are {done.told}"
    where = "inside a shape or beside a wall" if world.walled else f"inside a shape{f': {places} m' if places else ''}"
    say(f"Robot  {n_poses} way-points, {len(skipped)} skipped {where}")
    cells = f"{len(done.points)} cells of {1000 * world.cell:g} mm"
    say(f"LiDAR  {done.scans.hits.sum()} hits on {cells}; range noise {noise:g} mm")
    found = ", ".join(filter(None, (count(len(done.found), "shape"), done.found.rest())))
    say(f"Found  {found} with the settings {method}{number}")
    robot = f"{done.robot_time:.1f} s (all way-points x {lidar.period:g} s)"
    say(f"Time   robot {robot}, computing {done.computing_time:.2f} s")


def _write(out: Path, world: World, done: Run, report: Report, seed: int) -> None:
    """Write the picture and the two maps, and say what to open."""
    from ..formats import save_found, save_world
    from ..plots import plot_story, save_figure
    from ..segmentation import segment

    method: Literal["link", "kmeans"] = "link" if done.told is None else "kmeans"
    labels = segment(done.points, done.told, method=method, rng=seed)
    save_figure(plot_story(world, done.scans, done.points, labels, done.found, report), out / "map.png")
    save_found(done.found, out / "found.geojson", size=world.size)
    save_world(world, out / "truth.geojson")
    say(f"Wrote  {out / 'map.png'}, {out / 'found.geojson'}, {out / 'truth.geojson'}")
    say(f"Next   open {out / 'map.png'} to see it all; in Python, primkit.load_found and load_world read the two maps.")


def _census(world: World) -> str:
    kinds = ", ".join(shape.kind for shape in world.shapes)
    return count(len(world.shapes), "shape") + (f": {kinds}" if kinds else "")


# --- primkit make-map ---------------------------------------------------------------------------------------


def make_map(arguments: argparse.Namespace) -> None:
    """Write a random board to a file."""
    from ..formats import save_world
    from ..world import random_world

    kinds, n = arguments.kinds, arguments.shapes
    style: Style = arguments.style or "paper"
    if n is None:
        n = SHAPES if kinds is None else len(kinds)
    world = random_world(
        n, style=style, kinds=kinds, gap=arguments.gap / 1000, walls=arguments.walls, rng=arguments.seed
    )
    save_world(world, arguments.out)
    say(f"Board  {_census(world)} (random: seed {arguments.seed}, {style} style, gap {arguments.gap:g} mm)")
    say(f"Wrote  {arguments.out}")
    say(f"Next   primkit map --map {quoted(arguments.out)}")
