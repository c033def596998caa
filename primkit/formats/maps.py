"""Maps: worlds as GeoJSON, and results, which are worlds with properties beside their shapes.

In:  a ``World``, lengths in metres, world frame.
Out: a ``.geojson`` or ``.json`` file; the same world always gives the same bytes, numbers have all their digits.

>>> import tempfile
>>> with tempfile.TemporaryDirectory() as folder:
...     save_world(World([Circle((0, 0.1), 0.05)]), f"{folder}/map.geojson")
...     load_world(f"{folder}/map.geojson")
World: 1 m x 1 m, 1 shape: 1 circle

The file is valid GeoJSON, with two conventions of its own: positions are metres in the world frame, in place of
degrees of longitude and latitude, and a circle is a Point with the property ``radius``.

Source: Butler et al. (2016), "The GeoJSON Format", RFC 7946.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from math import isfinite
from pathlib import Path
from typing import Any

import numpy as np

from ..arguments import as_positive, check_type, limit, short
from ..shapes import SAME_CORNER, Circle, Polygon, Shape
from ..world import World
from .files import TEXT_LIMIT, StrPath, as_path, bounded_read, naming, write_atomically
from .sdf import read_sdf
from .webots import read_webots, write_webots

MAP_ENDINGS = (".geojson", ".json")
MAP_LIMIT = TEXT_LIMIT  # a shape takes about 300 bytes: room for 50,000 of them


def save_world(world: World, path: StrPath, *, properties: Sequence[Mapping[str, Any]] | None = None) -> None:
    """Write a world, or what was found, as GeoJSON; or a world for the simulator Webots.

    Parameters
    ----------
    world : World
        A map; or the found shapes as ``World(shapes, size)``.
    path : str or path
        The file, ending in ``.geojson`` or ``.json``, or in ``.wbt``; one that is there already is replaced.
    properties : sequence of dict, optional
        What else is known of each shape, in the order of ``world.shapes``: numbers (metres, radians), texts,
        true, false, None, and lists or dicts of these. NumPy numbers and arrays will do.

    Raises
    ------
    ValueError
        If the ending is another one, if there is not one dict for each shape, if a property cannot be
        written or is called ``kind`` or ``radius``, or if the file would be larger than ``load_world`` reads.
    OSError
        If the file cannot be written; the old one then stays as it was.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder, "found.geojson")
    ...     save_world(World([Circle((0, 0.1), 0.05)]), path, properties=[{"rms": 0.0004}])
    ...     print(path.read_text())
    {
      "type": "FeatureCollection",
      "size": 1.0,
      "features": [
        {"type": "Feature",
         "properties": {"kind": "circle", "radius": 0.05, "rms": 0.0004},
         "geometry": {"type": "Point", "coordinates": [0.0, 0.1]}}
      ]
    }
    <BLANKLINE>
    """
    path = as_path(path, (*MAP_ENDINGS, ".wbt"), "a map")
    with naming(path.name):
        check_type(world, World, "a map must be a World")
        n = len(world.shapes)
        extras: list[Mapping[str, Any]] = [{}] * n if properties is None else list(properties)
        if len(extras) != n:
            raise ValueError(f"properties must be one dict for each of the {n} shapes, got {len(extras)}")
    if path.suffix.lower() == ".wbt":
        write_webots(world, path)
        return
    features = []
    for number, (shape, extra) in enumerate(zip(world.shapes, extras, strict=True), start=1):
        with naming(f"{path.name}, feature {number}"):
            features.append(shape_text(shape, extra))
    write_map(path, {"size": world.size} | ({"walls": True} if world.walled else {}), features)


def load_world(path: StrPath, *, height: float = 0.1) -> World:
    """Read a world from a file ending in ``.geojson`` or ``.json``: a FeatureCollection, one Feature or one geometry.

    Or one of Webots (``.wbt``) or Gazebo (``.sdf``, ``.world``): what stands at the ``height`` of the LiDAR, metres; a
    ``LikelyWrong`` warning says what was passed over, such as meshes. See ``webots`` and ``sdf`` for what is read.

    A Polygon becomes a ``Polygon`` (first corner first, turned counter-clockwise), a Point with the property ``radius``
    a ``Circle``. The board's size is the member ``size`` beside the features, 1 m when there is none; it has walls when
    the member ``walls`` is true. All other properties are passed over, ``kind`` too. So is a position's third number,
    the height that GeoJSON allows, and what ``save_found`` writes beside shapes. Holes and Multi-geometries have no
    shape here.

    Raises ValueError if the file is not a map: the sentence names the file and the feature, counted from 1; OSError if
    there is no such file (``FileNotFoundError``), or it cannot be read.

    A clockwise triangle alone, as others may write it:

    >>> import pathlib, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder, "other.json")
    ...     _ = path.write_text('{"type": "Polygon", "coordinates": [[[0, 0], [0, 1], [1, 0], [0, 0]]]}')
    ...     load_world(path).shapes
    (Polygon([(0, 0), (1, 0), (0, 1)]),)
    """
    path = as_path(path, (*MAP_ENDINGS, ".wbt", ".sdf", ".world"), "a map")
    height = as_positive(height, "height", zero=True)
    if path.suffix.lower() not in MAP_ENDINGS:
        return (read_webots if path.suffix.lower() == ".wbt" else read_sdf)(path, height)
    document, features = read_map(path)
    with naming(path.name):
        size = document.get("size", 1.0)
        if not isinstance(size, float):
            raise ValueError(f"size must be a finite number > 0, got {shown(size)}")
        walls = document.get("walls", False)
        if not isinstance(walls, bool):
            raise ValueError(f"walls must be true or false, got {shown(walls)}")
    shapes = []
    for number, feature in enumerate(features, start=1):
        with naming(f"{path.name}, feature {number}"):
            if not _is_no_shape(feature):
                shapes.append(shape_of(feature))
    with naming(path.name):
        return World(shapes, size, walls=walls)


# From shapes to text.


def write_map(path: Path, members: Mapping[str, Any], features: Sequence[str]) -> None:
    """Write the features of a map, each as text, with members beside them."""
    listed = "[\n" + ",\n".join(features) + "\n  ]" if features else "[]"
    beside = "".join(f'  "{name}": {as_json(value)},\n' for name, value in members.items())
    data = f'{{\n  "type": "FeatureCollection",\n{beside}  "features": {listed}\n}}\n'.encode()
    with naming(path.name):
        limit(len(data), MAP_LIMIT, "must be at most {} bytes")
    write_atomically(path, data)


def feature_text(properties: Mapping[str, Any], geometry: str) -> str:
    """Return a GeoJSON Feature; ``geometry`` is the text that follows ``"type": ``."""
    told = as_json(properties)
    return f'    {{"type": "Feature",\n     "properties": {told},\n     "geometry": {{"type": {geometry}}}}}'


def shape_text(shape: Shape, extra: Mapping[str, Any]) -> str:
    """Return one shape as a GeoJSON Feature, one corner on a line."""
    if not isinstance(extra, Mapping):
        raise ValueError(f"properties must be a dict, got {type(extra).__name__}")
    for key, value in extra.items():
        _check_property(key, value)
    own: dict[str, Any] = {"kind": shape.kind}
    if isinstance(shape, Circle):
        own["radius"] = shape.radius
        geometry = f'"Point", "coordinates": {as_json(shape.center)}'
    else:
        ring = [*shape.vertices, shape.vertices[0]]  # GeoJSON repeats the first corner
        corners = ",\n".join(f"       {as_json(corner)}" for corner in ring)
        geometry = f'"Polygon", "coordinates": [[\n{corners}\n     ]]'
    return feature_text({**own, **extra}, geometry)


def _check_property(key: Any, value: Any) -> None:
    """Refuse a property that cannot be written beside a shape's own."""
    if not isinstance(key, str) or key in ("kind", "radius"):
        raise ValueError(f"a property's name must be a text other than kind and radius, got {short(key)}")
    try:
        as_json({key: value}).encode()  # half a surrogate pair is no text
    except (TypeError, ValueError, RecursionError):
        rule = "finite numbers, texts, true, false or None"
        raise ValueError(f"the property {key!r} must hold {rule}, got {shown(value)}") from None


def as_json(value: Any) -> str:
    """Return a value as JSON; NumPy's numbers and arrays will do."""
    return json.dumps(value, ensure_ascii=False, allow_nan=False, default=_without_numpy)


def _without_numpy(value: Any) -> Any:
    if isinstance(value, (np.generic, np.ndarray)):
        return value.tolist()
    raise TypeError(f"{type(value).__name__} is not JSON")


# From bytes to shapes.


def read_map(path: Path) -> tuple[dict[str, Any], list[Any]]:
    """Return a file's JSON object, every number in it as a float, and its features."""
    data = bounded_read(path, MAP_LIMIT)
    with naming(path.name):
        document = _parsed(data)
        return document, _features(document)


def _is_no_shape(feature: Any) -> bool:
    """Tell whether a Feature is what ``save_found`` writes beside shapes."""
    match feature:
        case {"type": "Feature", "properties": {"kind": kind}, "geometry": {"type": type_}}:
            return (kind, type_) in (("wall", "LineString"), ("other", "LineString"), ("strays", "MultiPoint"))
    return False


def _parsed(data: bytes) -> dict[str, Any]:
    """Return the JSON object in a file's bytes; every number in it as a float."""
    if not data.strip():
        raise ValueError("must be GeoJSON, got an empty file")
    try:
        # Whole numbers as floats too: Python refuses to read one of more than 4,300 digits as an int.
        document = json.loads(data.decode("utf-8-sig"), parse_int=float, parse_constant=_refuse_constant)
    except UnicodeDecodeError as error:
        raise ValueError(f"must be text in UTF-8, got something else at byte {error.start}") from None
    except json.JSONDecodeError as error:
        raise ValueError(f"must be valid JSON, got a mistake in line {error.lineno}, column {error.colno}") from None
    except (RecursionError, MemoryError):
        raise ValueError("must be nested a few brackets deep, got more than can be read") from None
    if not isinstance(document, dict):
        raise ValueError(f"must be a GeoJSON object, got {shown(document)}")
    return document


def _refuse_constant(name: str) -> float:
    raise ValueError(f"numbers must be finite, got {name}")


def _features(document: dict[str, Any]) -> list[Any]:
    """Return the features of a collection; one Feature or geometry alone counts as a collection of one."""
    kind = document.get("type")
    if not isinstance(kind, str):
        raise ValueError(f'must be GeoJSON with a text as its "type", got {shown(kind)}')
    if kind == "Feature":
        return [document]
    if kind != "FeatureCollection":
        return [{"type": "Feature", "geometry": document}]
    features = document.get("features")
    if not isinstance(features, list):
        raise ValueError(f"features must be a list, got {shown(features)}")
    return features


def shape_of(feature: Any) -> Shape:
    """Return the shape that a Feature stands for."""
    match feature:
        case {"type": "Feature", "geometry": {"type": "Polygon"} as geometry}:
            return _polygon_of(geometry.get("coordinates"))
        case {"type": "Feature", "geometry": {"type": "Point"} as geometry}:
            return _circle_of(geometry.get("coordinates"), feature.get("properties"))
        case {"type": "Feature"}:
            got = _shown_type(feature.get("geometry"))
            raise ValueError(f"geometry must be a Polygon, or a Point with a radius, got {got}")
        case _:
            raise ValueError(f"must be of type Feature, got {_shown_type(feature)}")


def _polygon_of(rings: Any) -> Polygon:
    """Return the polygon inside one closed ring."""
    if not isinstance(rings, list) or len(rings) != 1:
        got = f"{len(rings)} rings" if isinstance(rings, list) else shown(rings)
        raise ValueError(f"a Polygon must have one ring and no holes, got {got}")
    if not isinstance(rings[0], list) or not rings[0]:
        raise ValueError(f"a ring must be a list of positions, got {shown(rings[0])}")
    ring = np.array([position_of(position) for position in rings[0]])
    # Shapes of any size are judged by Polygon alone, so overflow on the way to its verdict is no matter here.
    with np.errstate(over="ignore", invalid="ignore"):
        if np.hypot(*(ring[0] - ring[-1])) > SAME_CORNER:
            ends = " and ".join(f"({x:g}, {y:g})" for x, y in ring[[0, -1]].tolist())
            raise ValueError(f"a ring must end where it begins, got the ends {ends}")
        return Polygon(ring)


def _circle_of(center: Any, properties: Any) -> Circle:
    """Return the circle around a Point."""
    if not isinstance(properties, dict) or "radius" not in properties:
        raise ValueError('a Point must have the property "radius" to be a circle, got none')
    radius = properties["radius"]
    if not isinstance(radius, float):  # Circle would take the text "0.1" and true for numbers
        raise ValueError(f"radius must be a finite number > 0, got {shown(radius)}")
    return Circle(position_of(center), radius)


def position_of(position: Any) -> tuple[float, float]:
    """Return x and y of a GeoJSON position; its height, if it has one, is dropped."""
    listed = isinstance(position, list) and len(position) in (2, 3)
    if not listed or not all(isinstance(number, float) and isfinite(number) for number in position):
        raise ValueError(f"a position must be two or three finite numbers, got {shown(position)}")
    x, y = position[:2]
    return x, y


def _shown_type(value: Any) -> str:
    """Return the type that an object claims, or else the value, as a few words."""
    return shown(value.get("type") if isinstance(value, dict) else value)


def shown(value: Any) -> str:
    """Return a JSON value as a few words for an error message, however large or deep it is."""
    if isinstance(value, list) and 0 < len(value) <= 4 and not any(isinstance(v, (list, dict)) for v in value):
        return f"[{', '.join(map(shown, value))}]"
    if isinstance(value, list):
        return f"a list of {len(value)}"
    if isinstance(value, str):
        return json.dumps(value[:40] + "..." if len(value) > 40 else value)
    if isinstance(value, float):
        return f"{value:g}"
    if value is None or isinstance(value, bool):
        return json.dumps(value)
    return "an object" if isinstance(value, dict) else type(value).__name__
