"""Webots: worlds of another simulator, read as truth, and boards written for it.

In:  a ``.wbt`` file: boxes, cylinders and prisms of its bounding objects, or of its shapes where a solid has none;
     walls, wooden and cardboard boxes, and the rectangle arena. Or a ``World``.
Out: a ``World``, cut at the height of the LiDAR; or a ``.wbt`` file with an arena of the board's size.

    node = [DEF name] Type { field value ... } | USE name
    value = numbers and texts | node | [ values ]

Before R2022a, y points up, and a cylinder stands along y; since then z, unless WorldInfo tells otherwise.

Source: the reference manual of Webots, and its PROTO files for what WoodenBox, Wall and RectangleArena are made of.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from ..arguments import Floats, limit, short
from ..shapes import Circle, Polygon
from ..world import World
from .files import bounded_read, naming, write_atomically
from .plans import DEEPEST_NODE, MOST_SOLIDS, Solid, arena, lengths, moved, numbers, plan, turned

WORD = re.compile(r'#[^\n]*|[\s,]+|("(?:[^"\\]|\\.)*"|[{}\[\]]|[^\s,{}\[\]"#]+)')
PRIMITIVE = re.compile(r'"|[-+.]?\d|(TRUE|FALSE|NULL)$')
Z_UP_SINCE = (2022, "a")
Y_UP = np.array([(1.0, 0, 0, 0), (0, 0, -1, 0), (0, 1, 0, 0), (0, 0, 0, 1)])  # x, y, z -> x, -z, y
FRAMES = {"Solid", "Transform", "Pose", "Group"}
BOXES = {"WoodenBox": (0.6, 0.6, 0.6), "CardboardBox": (0.6, 0.6, 0.6), "SolidBox": None, "Wall": None, "Box": None}
NO_THINGS = re.compile("WorldInfo|Viewpoint|.*Background.*|.*Light|Fog|Floor|ContactProperties")
WRITTEN_HEIGHT = 0.2  # m, of all that is written
Node = dict[str, Any]  # its type stands under ""; each field is a list


def read_webots(path: Path, height: float) -> World:
    """Return the plan of a Webots world at a height [m]."""
    data = bounded_read(path)
    with naming(path.name):
        text = data.decode("utf-8", "replace")
        version = re.match(r"#VRML_SIM R(\d{4})(\w?)", text)
        if version is None:
            raise ValueError(f"must begin with #VRML_SIM and a release, got {short(text[:20])}")
        words = [match[1] for match in WORD.finditer(text) if match[1]]
        nodes = [node for node in _nodes(words[::-1], "", {}, 0) if isinstance(node, dict)]
        told = next((_text(node, "coordinateSystem") for node in nodes if node[""] == "WorldInfo"), "")
        y_up = told == "NUE" or ((int(version[1]), version[2]) < Z_UP_SINCE and told != "ENU")
        reader = _Reader(y_up)
        for node in nodes:
            reader.read(node, Y_UP if y_up else np.eye(4))
        return plan(reader.solids, reader.passed_over, height, reader.board)


def write_webots(world: World, path: Path) -> None:
    """Write a board as a Webots world: a cylinder for each circle, a prism without lids for each polygon."""
    floor, field = ("RectangleArena", "floorSize") if world.walled else ("Floor", "size")
    lines = [
        "#VRML_SIM R2023b utf8",
        f'EXTERNPROTO "webots://projects/objects/floors/protos/{floor}.proto"',
        "WorldInfo { }",
        f"Viewpoint {{ orientation 0 1 0 1.57 position 0 0 {2.5 * world.size!r} }}",
        "Background { skyColor [ 0.7 0.8 0.9 ] }",
        "DirectionalLight { direction -1 -1 -2 }",
        f"{floor} {{ {field} {world.size!r} {world.size!r} }}",
    ]
    for number, shape in enumerate(world.shapes, start=1):
        if isinstance(shape, Circle):
            place = "translation {!r} {!r} {!r} ".format(*shape.center.tolist(), WRITTEN_HEIGHT / 2)
            geometry = f"Cylinder {{ radius {shape.radius!r} height {WRITTEN_HEIGHT!r} subdivision 512 }}"
        else:
            place, geometry = "", _prism(shape)
        body = f"children [ Shape {{ appearance PBRAppearance {{ }} geometry DEF THING{number} {geometry} }} ]"
        lines.append(f'Solid {{ {place}{body} name "{shape.kind} {number}" boundingObject USE THING{number} }}')
    write_atomically(path, "\n".join(lines) + "\n")


def _prism(shape: Polygon) -> str:
    """Return the sides of a prism: a LiDAR sees no more of it."""
    ring, n = shape.vertices.tolist(), len(shape.vertices)
    points = ", ".join(f"{x!r} {y!r} {z!r}" for z in (0.0, WRITTEN_HEIGHT) for x, y in ring)
    sides = ", ".join(f"{i} {(i + 1) % n} {n + (i + 1) % n} {n + i} -1" for i in range(n))
    return f"IndexedFaceSet {{ coord Coordinate {{ point [ {points} ] }} coordIndex [ {sides} ] }}"


# --- from text to nodes -------------------------------------------------------------------------------------


def _nodes(words: list[str], end: str, known: dict[str, Node], depth: int) -> Iterator[Any]:
    """Yield nodes and values up to a bracket; ``words`` are in reverse, what was read is gone."""
    limit(depth, DEEPEST_NODE, "must be nested at most {} deep")
    while words:
        word = words.pop()
        if word == end:
            return
        if PRIMITIVE.match(word):
            yield word
        elif word not in ("EXTERNPROTO", "IMPORTABLE"):
            yield _node(word, words, known, depth)
    if end:
        raise ValueError(f"must close each bracket with {end}, got the end of the file")


def _node(word: str, words: list[str], known: dict[str, Node], depth: int) -> Node:
    """Return the node that begins with a word."""
    name = words.pop() if word in ("DEF", "USE") and words else ""
    if word == "USE":
        if name not in known:
            raise ValueError(f"USE must name a node that was defined before, got {short(name)}")
        return known[name]
    kind = words.pop() if word == "DEF" and words else word
    if not words or words.pop() != "{" or not kind[0].isalpha():
        raise ValueError(f"a node must be a type and braces, got {short(kind)}")
    node: Node = {"": kind}
    while words and words[-1] != "}":
        field, value = words.pop(), []
        if words and words[-1] == "[":
            words.pop()
            value = list(_nodes(words, "]", known, depth + 1))
        elif words and PRIMITIVE.match(words[-1]):
            while words and PRIMITIVE.match(words[-1]):
                value.append(words.pop())
        elif words and words[-1] not in "{}[]":
            value = [_node(words.pop(), words, known, depth + 1)]
        limit(depth, DEEPEST_NODE, "must be nested at most {} deep")
        node[field] = value
    if not words:
        raise ValueError("must close each bracket with }, got the end of the file")
    words.pop()
    if name:
        known[name] = node
    return node


def _text(node: Node, field: str) -> str:
    return str((node.get(field) or [""])[0]).strip('"')


# --- from nodes to solids -----------------------------------------------------------------------------------


class _Reader:
    """What was read of a world so far: solids, the board's size [m] and whether it has walls, what was passed over."""

    def __init__(self, y_up: bool) -> None:
        self.y_up, self.solids, self.passed_over = y_up, list[Solid](), Counter[str]()
        self.board: tuple[float, bool] | None = None
        self.visits = 0

    def read(self, node: Node, way: Floats) -> None:
        """Take in a node, and all below it."""
        self.visits += 1
        limit(self.visits, MOST_SOLIDS, "must have at most {} nodes")
        kind = node[""]
        if kind in ("Floor", "RectangleArena"):
            self._read_floor(node, way @ self._way(node))
        elif kind in BOXES:
            self._read_box(node, way if kind == "Box" else way @ self._way(node))
        elif kind in FRAMES:
            if "scale" in node and numbers(node["scale"], 3, "scale") != [1, 1, 1]:
                self.passed_over[f"{kind} that is scaled"] += 1
                return
            way = way @ self._way(node)
            bounds = [part for part in node.get("boundingObject", []) if isinstance(part, dict)]
            for part in bounds:
                self.read(part, way)
            for child in node.get("children", []):
                if isinstance(child, dict) and not (bounds and child[""] in ("Shape", "Transform", "Pose", "Group")):
                    self.read(child, way)
        elif kind == "Shape":
            for part in node.get("geometry", []):
                if isinstance(part, dict):
                    self.read(part, way)
        elif not self._read_geometry(node, way) and not NO_THINGS.fullmatch(kind):
            self.passed_over[short(kind).strip("'")] += 1

    def _way(self, node: Node) -> Floats:
        rotation = numbers(node.get("rotation", (0, 0, 1, 0)), 4, "rotation")
        return moved(numbers(node.get("translation", (0, 0, 0)), 3, "translation"), turned(rotation[:3], rotation[3]))

    def _read_floor(self, node: Node, way: Floats) -> None:
        walled = node[""] == "RectangleArena"
        default = (1, 1) if walled else (10, 10)
        width, depth = lengths(node.get("floorSize" if walled else "size", default), 2, "the floor's size")
        middle = not np.abs(way[:2, 3]).any() and bool((np.abs(way[:2, :2]).max(axis=0) > 1 - 1e-9).any())
        if width == depth and middle and (walled or self.board is None):
            self.board = width, walled
        elif walled:
            thick, high = (
                lengths(node.get(f, [v]), 1, f)[0] for f, v in (("wallThickness", 0.01), ("wallHeight", 0.1))
            )
            self.solids += arena(width, depth, way @ Y_UP.T if self.y_up else way, thick, high)

    def _read_box(self, node: Node, way: Floats) -> None:
        size = node.get("size", BOXES[node[""]])
        if size is None:
            self.passed_over[f"{node['']} without a size"] += 1
            return
        size = lengths(size, 3, "size")
        if node[""] == "Wall":  # it stands on its origin
            up = 1 if self.y_up else 2
            way = way @ moved([size[k] / 2 if k == up else 0.0 for k in range(3)], np.eye(3))
        self.solids.append(Solid("box", tuple(size), way))

    def _read_geometry(self, node: Node, way: Floats) -> bool:
        """Take in a cylinder or a prism; False if it is none, or tells no size."""
        kind = node[""]
        if kind == "Cylinder" and {"radius", "height"} <= set(node):
            (radius,), (length,) = (lengths(node[field], 1, field) for field in ("radius", "height"))
            self.solids.append(Solid("cylinder", (radius, radius, length), way @ Y_UP.T if self.y_up else way))
        elif kind == "IndexedFaceSet" and not self.y_up:
            points = (node.get("coord") or [{}])[0]
            words = points.get("point", []) if isinstance(points, dict) else []
            corners = np.array(numbers(words, len(words), "point")[: len(words) // 3 * 3]).reshape(-1, 3)
            n = len(corners) // 2
            low, high = corners[:n], corners[n:]
            flat = n >= 3 and len(corners) == 2 * n and not np.ptp(low[:, 2]) and not np.ptp(high[:, 2])
            if not flat or (low[:, :2] != high[:, :2]).any():
                return False
            self.solids.append(Solid("prism", (float(low[0, 2]), 0.0, float(high[0, 2])), way, low[:, :2]))
        else:
            return False
        return True
