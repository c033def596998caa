"""Found maps: what was found, as GeoJSON, with all its points.

In:  ``Found``, lengths in metres, world frame.
Out: a ``.geojson`` or ``.json`` file, a map as ``maps`` writes it, in which more stands:

    a shape   beside kind and radius: "rms", "seen", "margin", "certain" and the standard deviations
    a wall    a LineString from start to end
    an other  a LineString around it, of kind "other": a thing that is none of the kinds
    strays    one MultiPoint

Each feature has its own points in the property "points"; ``null`` stands for a number that is not finite. Read as a
map, by ``load_world``, the file is the shapes that were found.

>>> import tempfile
>>> from primkit.shapes import Circle
>>> found = Found([Detection(Circle((0, 0.1), 0.05), np.array([(0.05, 0.1)]), 0.0003)], strays=np.array([(0.2, 0.4)]))
>>> with tempfile.TemporaryDirectory() as folder:
...     save_found(found, f"{folder}/found.geojson")
...     load_found(f"{folder}/found.geojson").title()
'1 shape found; 1 stray'

Of the estimator only the types are known here that it returns.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import isfinite
from typing import Any

import numpy as np

from ..arguments import Floats, Ints, as_positive, check_type
from ..found import Found
from ..measure import CELL, Detection, Frame, Other, Wall
from .files import StrPath, as_path, naming
from .maps import MAP_ENDINGS, as_json, feature_text, position_of, read_map, shape_of, shape_text, shown, write_map

INFINITE, UNKNOWN = float("inf"), float("nan")


@dataclass(frozen=True)
class Told:
    """How sure a shape's numbers and its kind are, as a file tells it: what ``Detection`` asks of a ``Choice``."""

    margin: float
    certain: bool
    center_std: tuple[float, ...]
    dimension_std: tuple[float, ...]


def save_found(found: Found, path: StrPath, *, size: float = 1.0) -> None:
    """Write what was found as GeoJSON: shapes, walls, other things and strays.

    Parameters
    ----------
    found : Found
        What ``find_shapes`` returned.
    path : str or path
        The file, ending in ``.geojson`` or ``.json``; one that is there already is replaced.
    size : float
        Side of the board, metres.

    Raises
    ------
    ValueError
        If it is no ``Found``, the ending is another one, or the file would be larger than ``load_found`` reads.
    OSError
        If the file cannot be written; the old one then stays as it was.
    """
    path = as_path(path, MAP_ENDINGS, "a map")
    with naming(path.name):
        check_type(found, Found, "what was found must be as find_shapes returns it, Found")
        size = as_positive(size, "size")
    features = [shape_text(one.shape, _known_of(one)) for one in found]
    features += [_line_text("wall", [wall.start, wall.end], _known_of_wall(wall)) for wall in found.walls]
    rings = [[*other.outline, *other.outline[:1]] for other in found.others]
    features += [_line_text("other", ring, {"points": o.points}) for ring, o in zip(rings, found.others, strict=True)]
    if len(found.strays):
        features.append(feature_text({"kind": "strays"}, f'"MultiPoint", "coordinates": {as_json(found.strays)}'))
    write_map(path, {"size": size, "resolution": found.resolution}, features)


def load_found(path: StrPath) -> Found:
    """Read what was found from a file that ``save_found`` wrote: equal to what it was, to the last bit.

    A file without walls, strays, points and the like has none of them: the shapes of any map can be read. Raises
    ValueError if the file is not a map: the sentence names the file and the feature, counted from 1; OSError if there
    is no such file, or it cannot be read.
    """
    path = as_path(path, MAP_ENDINGS, "a map")
    document, features = read_map(path)
    with naming(path.name):
        resolution = as_positive(_number(document, "resolution", CELL), "resolution")
    shapes: list[Detection] = []
    walls: list[Wall] = []
    others: list[Other] = []
    strays = np.empty((0, 2))
    for number, feature in enumerate(features, start=1):
        with naming(f"{path.name}, feature {number}"):
            known = feature.get("properties") if isinstance(feature, dict) else None
            known = known if isinstance(known, dict) else {}
            match known.get("kind"), feature:
                case "wall", {"geometry": {"type": "LineString", "coordinates": places}}:
                    walls.append(_wall_of(_places(places, "coordinates"), known))
                case "other", {"geometry": {"type": "LineString", "coordinates": places}}:
                    outline = _places(places, "coordinates")[:-1]
                    others.append(Other(_places(known.get("points"), "points"), outline))
                case "strays", {"geometry": {"type": "MultiPoint", "coordinates": places}}:
                    strays = np.vstack([strays, _places(places, "coordinates")])
                case _:
                    shapes.append(_detection_of(feature, known, resolution / CELL))
    return Found(shapes, walls, others, strays, resolution)


# From what was found to text.


def _known_of(one: Detection) -> dict[str, Any]:
    """Return what is known of a shape beside its outline."""
    known = {"rms": one.rms, "margin": one.margin, "count_margin": one.count_margin}
    told: dict[str, Any] = {name: value if isfinite(value) else None for name, value in known.items()}
    told |= {"certain": None if one.choice is None else one.certain, "seen": one.seen}
    for name, stds in (("center_std", one.center_std), ("dimension_std", one.dimension_std)):
        told[name] = [std if isfinite(std) else None for std in stds]
    return told | {"n_points": len(one.points), "points": one.points, "scans": one.scans}


def _known_of_wall(wall: Wall) -> dict[str, Any]:
    return {"std": wall.std, "ends_seen": wall.ends_seen, "points": wall.points}


def _line_text(kind: str, places: Sequence[Floats], known: Mapping[str, Any]) -> str:
    coordinates = as_json([place.tolist() for place in places])
    return feature_text({"kind": kind, **known}, f'"LineString", "coordinates": {coordinates}')


# From JSON to what was found.


def _detection_of(feature: Any, known: dict[str, Any], unit: float) -> Detection:
    """Return a shape with what the file tells of it; ``unit`` as for ``Frame``."""
    certain = known.get("certain")
    if not (certain is None or isinstance(certain, bool)):
        raise ValueError(f"certain must be true, false or null, got {shown(certain)}")
    told = None
    if certain is not None:
        stds = [tuple(std / unit for std in _numbers(known, f"{of}_std", INFINITE)) for of in ("center", "dimension")]
        told = Told(_number(known, "margin", INFINITE), certain, *stds)
    sure: Any = told  # it tells what a Choice and its Certainty would have to work out
    return Detection(
        shape_of(feature),
        _places(known.get("points", []), "points"),
        _number(known, "rms", UNKNOWN),
        _number(known, "count_margin", UNKNOWN if told is None else INFINITE),
        _numbers(known, "seen", UNKNOWN),
        sure,
        sure,
        Frame(np.zeros(2), unit),
        _scans_of(known),
    )


def _scans_of(known: dict[str, Any]) -> Ints | None:
    """Return the number of the scan that saw each point; None where none is told."""
    if known.get("scans") is None:
        return None
    scans = np.array(_numbers(known, "scans", UNKNOWN))
    if not ((scans >= 0) & (scans < 2**53) & (scans == np.round(scans))).all():
        raise ValueError("scans must be whole numbers >= 0, got others")
    return scans.astype(np.int64)


def _wall_of(ends: Floats, known: dict[str, Any]) -> Wall:
    """Return a wall with what the file tells of it."""
    if len(ends) != 2:
        raise ValueError(f"a wall must have a start and an end, got {len(ends)} positions")
    seen = known.get("ends_seen", [False, False])
    if not (isinstance(seen, list) and len(seen) == 2 and all(isinstance(end, bool) for end in seen)):
        raise ValueError(f"ends_seen must be two of true and false, got {shown(seen)}")
    points = _places(known.get("points", []), "points")
    return Wall(ends[0], ends[1], points, _number(known, "std", UNKNOWN), (seen[0], seen[1]))


def _places(places: Any, name: str) -> Floats:
    """Return positions, shape (N, 2), metres."""
    if not isinstance(places, list):
        raise ValueError(f"{name} must be a list of positions, got {shown(places)}")
    return np.array([position_of(place) for place in places], dtype=float).reshape(-1, 2)


def _number(known: dict[str, Any], name: str, nothing: float) -> float:
    """Return a number, or ``nothing`` for null."""
    value = known.get(name)
    if value is None:
        return nothing
    if not isinstance(value, float):
        raise ValueError(f"{name} must be a number or null, got {shown(value)}")
    return value


def _numbers(known: dict[str, Any], name: str, nothing: float) -> tuple[float, ...]:
    """Return numbers, each ``nothing`` for null."""
    values = known.get(name, [])
    if not isinstance(values, list):
        raise ValueError(f"{name} must be a list of numbers, got {shown(values)}")
    return tuple(_number({name: value}, name, nothing) for value in values)
