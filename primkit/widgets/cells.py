"""Cells: a circle seen through the grid, while you move the cells' size and drive round it. The slider of lesson 02.

>>> cells()
Slider: cell size, poses, pose error, read at
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import ArrayLike

from ..arguments import Floats
from ..circles import fit_circle
from ..grid import Grid
from ..lidar import Lidar, Scans, scan
from ..palette import BLUE, GREY, INK, ORANGE, PALE, SKY, VERMILION
from ..shapes import Circle
from ..table import count
from ..world import World
from .drawing import Frame, picture, square_frame
from .slider import Choice, Explorer, Picture, Slider, explore
from .svg import path, signed

DRIVEN_CIRCLE = Circle((0.0036, -0.0047), 0.06)  # not in the middle of a cell, nor on a border
DRIVING_RADIUS = 0.13  # m: the robot drives round the circle at this distance from its centre
MOST_STOPS = 40
CELLS_VIEW = 0.38  # m: the piece of the board that is seen
LEAST_LINED_CELL = 4  # mm: smaller cells are dots, without borders
LOST_RADIUS = 0.5  # m: a circle larger than this is none that a student could look for
CELL_BORDERS = (-0.06, -0.04, -0.02, 0.0, 0.02, 0.04, 0.06, 0.08)  # m: of the diagram's cells
SIGNS_OF_CELLS = (("true", BLUE, "line"), ("found", VERMILION, "dashed"))
READ_AT_CENTER, READ_AT_CORNER = "its centre", "its corner"


def cells() -> Explorer:
    """Return the slider of lesson 02: cell size, poses, their error, and where a cell is read."""
    return explore(
        draw_cells,
        Slider("cell", 1, 40, 1, start=10, unit="mm", label="cell size"),
        Slider("poses", 1, MOST_STOPS, 1, start=MOST_STOPS),
        Slider("error", 0.0, 10.0, 0.5, start=0.0, unit="mm", label="pose error"),
        Choice("read", (READ_AT_CENTER, READ_AT_CORNER), start=READ_AT_CENTER, label="read at"),
        settings={
            "fine cells": {"cell": 1},
            "coarse cells": {"cell": 20},
            "three poses": {"poses": 3},
            "half way round": {"poses": MOST_STOPS // 2},
            "read at the corner": {"cell": 20, "read": READ_AT_CORNER},
            "poses 5 mm off": {"cell": 1, "error": 5.0},
        },
        diagram=draw_diagram,
    )


@cache
def drive() -> tuple[Scans, Floats]:
    """Return the scans from all round the circle, and how far off each pose is believed to be, in units of 1."""
    turn = 2 * np.pi * np.arange(MOST_STOPS) / MOST_STOPS
    stops = DRIVEN_CIRCLE.center + DRIVING_RADIUS * np.column_stack([np.cos(turn), np.sin(turn)])
    poses = np.column_stack([stops, turn + np.pi / 2])  # heading where it drives
    off = np.random.default_rng(2).normal(size=(MOST_STOPS, 2))
    return scan(World([DRIVEN_CIRCLE]), poses, Lidar()), off


def draw_cells(cell: int, poses: int, error: float, read: str) -> str:
    """Draw the cells that a circle's hits fall into, and the circle through them; cell and pose error in mm."""
    scans, off = drive()
    believed = scans.poses + error / 1000 * np.column_stack([off, np.zeros(MOST_STOPS)])
    seen = Scans(believed, scans.angles, scans.ranges, scans.inside)[:poses]
    grid, side = Grid(cell / 1000), cell / 1000
    grid.add(seen)
    points = grid.points() if read == READ_AT_CENTER else grid.cells * side
    found = fit_circle(points)
    if found is not None and found.radius > LOST_RADIUS:
        found = None
    frame, fine = square_frame((0.0, 0.0), CELLS_VIEW), cell < LEAST_LINED_CELL
    return picture(
        frame,
        "" if fine else _squares(frame, grid.cells, side) + _borders(frame, side),
        frame.circle(DRIVEN_CIRCLE.center, DRIVEN_CIRCLE.radius, BLUE, 1.2 if fine else 2.5),
        "" if found is None else frame.circle(found.center, found.radius, VERMILION, 2, "6 4"),
        frame.points(points, INK, "square", 2.2 + cell / 3) if fine else frame.points(points, INK, size=4),
        *(frame.robot(pose, GREY, 5) for pose in seen.poses),
        title=_title(cell, found),
        legend=[*SIGNS_OF_CELLS, ("occupied", INK if fine else SKY, "square"), ("robot", GREY, "triangle")],
        says=_says(int(seen.hits.sum()), len(grid), cell, poses, error, found),
    )


def _title(cell: int, found: Circle | None) -> str:
    if found is None:
        return f"Cells of {cell} mm: too few for a circle"
    return f"Cells of {cell} mm: the circle is {_off(found):.2g} mm off"


def _says(hits: int, occupied: int, cell: int, poses: int, error: float, found: Circle | None) -> str:
    """Say in a sentence what came of the hits."""
    robot = f"{count(poses, 'pose')}{f' that are {error:g} mm off' if error else ''}"
    start = f"{hits} hits from {robot} fall into {count(occupied, 'cell')} of {cell} mm"
    if found is None:
        return f"{start}: too few for a circle."
    radius = 1000 * (found.radius - DRIVEN_CIRCLE.radius)
    return f"{start}; the circle through them is {_off(found):.2g} mm off, its radius {radius:+.2g} mm."


def _off(found: Circle) -> float:
    """Return how far the centre is from the true one, in mm."""
    return float(1000 * np.hypot(*(found.center - DRIVEN_CIRCLE.center)))


def _squares(frame: Frame, cells: ArrayLike, side: float) -> str:
    """Fill the cells, shape (N, 2), of a grid."""
    wide, tall = side * np.array(frame.scale)
    corners = frame.at(side * (np.asarray(cells) + np.array([0, 1])))  # the upper left ones: pixels count downwards
    moves = "".join(f"M{x:g} {y:g}h{wide:.1f}v{tall:.1f}h-{wide:.1f}z" for x, y in corners)
    return path(moves, fill=SKY, fill_opacity=0.6)


def _borders(frame: Frame, side: float) -> str:
    """Draw the lines between cells."""
    moves = ""
    for number in _numbers(frame.x, side):
        (x, y), (_, end) = frame.at([(number * side, frame.y[0]), (number * side, frame.y[1])])
        moves += f"M{x:g} {y:g}V{end:g}"
    for number in _numbers(frame.y, side):
        (x, y), (end, _) = frame.at([(frame.x[0], number * side), (frame.x[1], number * side)])
        moves += f"M{x:g} {y:g}H{end:g}"
    return path(moves, stroke=PALE, stroke_width=0.6)


def _numbers(ends: tuple[float, float], side: float) -> range:
    """Return the numbers of the borders from one end to the other."""
    return range(int(np.ceil(ends[0] / side)), int(np.floor(ends[1] / side)) + 1)


def draw_diagram() -> Picture:
    """Return the drawing behind the lesson's formulas: from a range to a hit, to its cell, to the cell's centre."""
    side, pose, beam, reach = 0.02, np.array([-0.03, -0.017, np.radians(14)]), np.radians(17), 0.078
    frame = Frame((-0.06, 0.08), (-0.04, 0.06), width=565, height=425, x_ticks=CELL_BORDERS, y_ticks=CELL_BORDERS[1:7])
    ahead, along = (np.array([np.cos(a), np.sin(a)]) for a in (pose[2], pose[2] + beam))
    hit = pose[:2] + reach * along
    cell = Grid(side).to_cells([hit])
    center = Grid(side).to_points(cell)[0]
    angles = ((0.045, np.linspace(0, pose[2], 15)), (0.055, np.linspace(pose[2], pose[2] + beam, 15)))
    arcs = [pose[:2] + r * np.column_stack([np.cos(a), np.sin(a)]) for r, a in angles]  # of heading and bearing
    names = [
        *(frame.text(((n + 0.5) * side, -0.04), f"i = {signed(n)}", GREY, "middle", (0, -8)) for n in range(-3, 4)),
        *(frame.text((-0.06, (n + 0.5) * side), f"j = {signed(n)}", GREY, shift=(6, 4)) for n in range(-1, 3)),
    ]
    svg = picture(
        frame,
        _squares(frame, cell, side),
        _borders(frame, side),
        frame.segments([(0, -0.04), (-0.06, 0)], [(0, 0.06), (0.08, 0)], GREY, 1.8),
        *names,
        frame.segments([pose[:2]], [pose[:2] + 0.07 * ahead], GREY, 1.5, "5 4"),
        frame.segments([pose[:2]], [(pose[0] + 0.06, pose[1])], PALE, 1.5),
        frame.segments([pose[:2]], [hit], ORANGE, 3),
        *(frame.polyline(arc, INK, 1.3) for arc in arcs),
        frame.segments([center], [hit], VERMILION, 2),
        frame.points([center], INK, "cross", 10),
        frame.points([hit], VERMILION, "dot", 9),
        frame.robot(pose),
        frame.text(pose[:2], "q", shift=(-16, 18), size=16),
        frame.text(arcs[0][len(arcs[0]) // 2], "θ", shift=(5, 6), size=16),
        frame.text(arcs[1][len(arcs[1]) // 2], "β", shift=(6, 2), size=16),
        frame.text(pose[:2] + 0.6 * reach * along, "r", shift=(-16, -8), size=16),
        frame.text(hit, "hit p", VERMILION, shift=(10, 6), size=15),
        frame.text(center, "centre", INK, shift=(-2, -10), anchor="middle", size=13),
        title="From a range to a hit, to a cell, to its centre",
        says=(
            "From the robot's place q the beam goes r along the heading θ plus the bearing β; "
            f"its hit p lies in cell {tuple(cell[0].tolist())} and is read at this cell's centre."
        ),
    )
    return Picture(svg, "Diagram: from a range to a cell")
