"""Bearings as CSV: one sweep as a table of angles and distances, as tools of the RPLIDAR write it.

In:  a ``.csv`` file: a line for each beam, and a header that names the columns: one with "angle", "theta" or "bearing",
     one with "dist" or "range"; where one has "valid", 0 in it means no hit. Other columns are passed over.
Out: one sweep, from the pose (0, 0, 0).

Units stand in the header, as in ``angle_deg`` or ``Distance [mm]``, or are told. Angles grow counter-clockwise, unless
the lidar's do not: those that come straight from an RPLIDAR grow clockwise. An empty distance is no hit. A last line
without its end is passed over: it may be half of one.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from ..arguments import short
from ..lidar import Lidar
from .files import bounded_read, lines_of, naming
from .recordings import Sweep

COLUMNS = {"angle": "angle|theta|bearing", "distance": "dist|range", "valid": "valid"}
ANGLES = {"deg": np.pi / 180, "degree": np.pi / 180, "degrees": np.pi / 180, "rad": 1.0, "radians": 1.0}
LENGTHS = {"mm": 0.001, "cm": 0.01, "m": 1.0, "meters": 1.0, "metres": 1.0}


def read_bearings(path: Path, units: Sequence[str], lidar: Lidar | None) -> list[Sweep]:
    """Return the sweep in a table; units are told as ``("deg", "mm")`` where the header tells none."""
    data = bounded_read(path)
    with naming(path.name):
        try:
            lines = [line.decode("utf-8-sig").replace("\0", " ") for line in lines_of(data) if line.strip()]
        except UnicodeDecodeError:
            raise ValueError("must be text in UTF-8, got something else") from None
        heads, *rows = _cells(lines)
        places = {name: _place(heads, name) for name in COLUMNS}
        angle = _unit(heads[places["angle"]], units, ANGLES) * (-1 if lidar and lidar.clockwise else 1)
        distance = _unit(heads[places["distance"]], units, LENGTHS)
        told = np.array([_numbers(row, places, number) for number, row in enumerate(rows, start=2)]).reshape(-1, 2)
        return [Sweep((0.0, 0.0, 0.0), angle * told[:, 0], distance * told[:, 1])] if len(told) else []


def _cells(lines: list[str]) -> list[list[str]]:
    """Return the cells of each line, whatever parts them; at least of the first."""
    first = lines[0] if lines else ""
    mark = max(",;\t", key=first.count)
    try:
        return [[cell.strip() for cell in row] for row in csv.reader(lines, delimiter=mark)] or [[]]
    except csv.Error:
        raise ValueError("must be a table in CSV, got one that cannot be parted into cells") from None


def _place(heads: list[str], name: str) -> int:
    """Return which column is called so; -1 where none must be."""
    fitting = [place for place, head in enumerate(heads) if re.search(COLUMNS[name], head.lower())]
    if name == "valid" and not fitting:
        return -1
    if len(fitting) != 1:
        rule = f"must have one column for the {name}, with {COLUMNS[name].replace('|', ' or ')} in its name"
        raise ValueError(f"{rule}, got {len(fitting)} in the header {short(', '.join(heads))}")
    return fitting[0]


def _unit(head: str, told: Sequence[str], known: Mapping[str, float]) -> float:
    """Return how much the unit of a column is, in radians or metres."""
    names = [word for word in [*told, *re.findall("[a-z]+", head.lower().replace("°", "deg"))] if word in known]
    if not names:
        rule = f"must tell the unit of {short(head)} in the header, or as units"
        raise ValueError(f"{rule}: one of {', '.join(known)}")
    return known[names[0]]


def _numbers(row: list[str], places: Mapping[str, int], number: int) -> tuple[float, float]:
    """Return angle and distance in a row, NaN for none."""
    angle, distance, valid = (row[place] if 0 <= place < len(row) else "" for place in places.values())
    try:
        if not angle:
            raise ValueError
        no_hit = not distance or valid.lower() in ("0", "false")
        return float(angle), float("nan") if no_hit else float(distance)
    except ValueError:
        with naming(f"line {number}"):
            raise ValueError(f"must hold an angle and a distance, got {short(angle)} and {short(distance)}") from None
