"""What the tests of the formats share: a scan, files with any content, bits, and the words of a refusal."""

import json
import struct

import pytest

from primkit.lidar import scan
from primkit.shapes import Circle, Polygon
from primkit.world import World

TRIANGLE = Polygon([(0, 0), (0.2, 0), (0, 0.1)])


def a_scan():
    return scan(World([Circle((0.2, 0), 0.05)]), [(0, 0, 0), (0.2, 0, 1)])


def bits(world):
    """Everything a world is made of, to the last bit (-0.0 is not 0.0 here)."""
    shapes = [
        (s.kind, s.center.tobytes(), struct.pack("d", s.radius))
        if isinstance(s, Circle)
        else (s.kind, s.vertices.tobytes())
        for s in world.shapes
    ]
    return shapes, struct.pack("d", world.size), world.walled


def refusal(function, *args, error=ValueError, **kwargs):
    """The exact sentence with which a call is refused."""
    with pytest.raises(error) as caught:
        function(*args, **kwargs)
    assert caught.type is error
    return str(caught.value)


def answer(load, path):
    """What is read, or else the sentence with which it is refused."""
    try:
        return load(path), None
    except ValueError as error:
        return None, str(error)


def written(folder, content, name="map.geojson"):
    """The path of a file with this content: text, bytes, or what becomes JSON."""
    path = folder / name
    text = content if isinstance(content, (str, bytes)) else json.dumps(content)
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    return path
