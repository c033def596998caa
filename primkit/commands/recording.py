"""Recording: ``primkit map --scans`` maps what a robot recorded, where nobody knows the truth.

In:  the options of the command.
Out: what is certain and what is not, on the screen; a picture and a map in a folder.

>>> span("10:20"), lidar_named("lds-01").range_max
(slice(10, 20, None), 3.5)
"""

from __future__ import annotations

import argparse
import re
import time
from typing import TYPE_CHECKING

from ..table import count
from .words import say

if TYPE_CHECKING:
    from ..lidar import Scans
    from ..sensors import Lidar

LIDARS = ("rplidar-a1", "lds-01")
CELLS = (0.001, 0.002, 0.005, 0.01)  # m: what is seen from farther away is seen less finely


def lidar_named(word: str) -> Lidar:
    """Return the sensor that a word names."""
    from ..sensors import LDS_01, RPLIDAR_A1

    if word not in LIDARS:
        raise argparse.ArgumentTypeError(f"must be {' or '.join(LIDARS)}, got {word!r}")
    return RPLIDAR_A1 if word == LIDARS[0] else LDS_01


def span(word: str) -> slice:
    """Return which scans are meant by 10:20, :20 or 10:."""
    told = re.fullmatch(r"(\d{0,9}):(\d{0,9})", word)
    if told is None:
        raise argparse.ArgumentTypeError(f"must be two whole numbers, as in 0:60, got {word!r}")
    first, last = (int(number) if number else None for number in told.groups())
    return slice(first, last)


def map_recording(arguments: argparse.Namespace) -> None:
    """Map what a robot recorded, print what was found and how sure that is, and write the picture and the map."""
    import numpy as np

    from ..driving.steady import steady
    from ..formats import load_scans, save_found
    from ..grid import Grid
    from ..pipeline import find_shapes
    from ..plots import plot_recording, save_figure
    from ..study import METHODS, make_folder

    scans = load_scans(arguments.scans, topic=arguments.topic, units=arguments.units, lidar=arguments.lidar)
    said = f"{count(len(scans), 'scan')} in {arguments.scans}"
    if arguments.only is not None:
        scans = scans[arguments.only]
        said += f"; {count(len(scans), 'scan')} mapped"
    elif len(scans) > 1 and not np.ptp(scans.poses, axis=0).any():
        scans = scans[:1]
        said += ", without poses: the first alone is mapped; --only A:B takes those of a robot that stands still"
    say(f"Scans  {said}")
    grid = Grid(_cell(scans) if arguments.cell is None else arguments.cell / 1000)
    still = steady(scans, grid.resolution)
    grid.add(still)
    n_hits, n_moved = still.hits.sum(), scans.hits.sum() - still.hits.sum()
    moved = f"; {count(n_moved, 'hit')} on what moved left out" if n_moved else ""
    say(f"LiDAR  {n_hits} hits on {len(grid)} cells of {1000 * grid.resolution:g} mm{moved}")
    out, start = make_folder(arguments.out), time.process_time()
    found = find_shapes(grid, settings=METHODS[arguments.settings.upper()], rng=arguments.seed)
    seconds = time.process_time() - start
    certain = sum(one.certain for one in found)
    say(f"Found  {count(len(found), 'shape')}, {certain} of them certain; {found.rest() or 'nothing else'}")
    say(f"Time   computing {seconds:.2f} s\n\n{found}\n")
    points = grid.points()
    size = 2.2 * float(np.abs(points).max(initial=grid.resolution))
    save_figure(plot_recording(points, found, size), out / "map.png")
    save_found(found, out / "found.geojson", size=size)
    say(f"Wrote  {out / 'map.png'}, {out / 'found.geojson'}")
    say(f"Next   open {out / 'map.png'} to see it; in Python, primkit.load_found reads the map.")


def _cell(scans: Scans) -> float:
    """Return the side of cells for scans, metres: a thousandth of how far most hits are, rounded up."""
    import numpy as np

    far = float(np.quantile(scans.ranges[scans.hits], 0.95)) / 1000 if scans.hits.any() else 0.0
    return next((cell for cell in CELLS if cell >= far), CELLS[-1])
