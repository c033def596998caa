"""SDF: worlds and models of Gazebo, read as truth.

In:  a ``.sdf`` or ``.world`` file: boxes, cylinders and polylines of its collisions, or of its visuals where a link has
     no collision; what is included from elsewhere, meshes, planes and others are passed over, and said.
Out: a ``World``, cut at the height of the LiDAR.

    pose = x y z roll pitch yaw, metres and radians, of a model, a link or a collision in the frame around it

Source: the SDFormat specification, 1.4 to 1.11.
"""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..arguments import Floats, limit
from ..world import World
from .files import bounded_read, naming
from .plans import DEEPEST_NODE, MOST_SOLIDS, Solid, lengths, moved, numbers, plan, turned

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element


def read_sdf(path: Path, height: float) -> World:
    """Return the plan of a world of Gazebo at a height [m]."""
    data = bounded_read(path)
    with naming(path.name):
        solids, passed_over = list[Solid](), Counter[str]()
        _read(_parsed(data), np.eye(4), solids, passed_over)
        return plan(solids, passed_over, height)


def _parsed(data: bytes) -> Element:
    from xml.etree import ElementTree

    try:
        text = data.decode("utf-8-sig")
        if "<!" in text.replace("<!--", ""):  # entities could grow without limit
            raise ValueError
        root = ElementTree.fromstring(text)
    except (ElementTree.ParseError, ValueError, LookupError):  # no UTF-8 is a ValueError, too
        raise ValueError("must be XML in UTF-8 without declarations, got something else") from None
    if root.tag != "sdf":
        raise ValueError(f"must be SDF, with <sdf> around all, got <{root.tag[:40]}>")
    return root


def _read(element: Element, way: Floats, solids: list[Solid], passed_over: Counter[str], depth: int = 0) -> None:
    """Take in an element, and all below it."""
    limit(depth, DEEPEST_NODE, "must be nested at most {} deep")
    limit(len(solids), MOST_SOLIDS, "must have at most {} solids")
    way = way @ _way(element)
    kind = "visual" if element.tag == "link" and element.find("collision") is None else "collision"
    for child in element:
        if child.tag in ("world", "model", "link"):
            _read(child, way, solids, passed_over, depth + 1)
        elif child.tag == kind and element.tag == "link":
            _read_geometry(child, way @ _way(child), solids, passed_over)
        elif child.tag == "include":
            passed_over["include"] += 1


def _read_geometry(element: Element, way: Floats, solids: list[Solid], passed_over: Counter[str]) -> None:
    """Take in the geometry of a collision or a visual."""
    for shape in element.iterfind("geometry/*"):
        if shape.tag == "box":
            solids.append(Solid("box", tuple(lengths((shape.findtext("size") or "").split(), 3, "size")), way))
        elif shape.tag == "cylinder":
            (radius,), (length,) = (lengths([shape.findtext(name)], 1, name) for name in ("radius", "length"))
            solids.append(Solid("cylinder", (radius, radius, length), way))
        elif shape.tag == "polyline":
            base = np.array([numbers((point.text or "").split(), 2, "point") for point in shape.iterfind("point")])
            solids.append(
                Solid("prism", (0.0, 0.0, *lengths([shape.findtext("height")], 1, "height")), way, base.reshape(-1, 2))
            )
        else:
            passed_over[shape.tag[:40]] += 1


def _way(element: Element) -> Floats:
    """Return the pose of an element in the frame around it, shape (4, 4)."""
    pose = element.find("pose")
    if pose is None or not (pose.text or "").strip():
        return np.eye(4)
    if pose.get("relative_to"):
        raise ValueError(f"a pose must be told in the frame around it, got one in {pose.get('relative_to', '')[:40]!r}")
    values = numbers((pose.text or "").split(), 6, "pose")
    roll, pitch, yaw = np.radians(values[3:]) if pose.get("degrees") in ("true", "1") else values[3:]
    turn = turned((0, 0, 1), yaw) @ turned((0, 1, 0), pitch) @ turned((1, 0, 0), roll)
    return moved(values[:3], turn)
