"""Worlds of other simulators as truth: Webots and SDF, cut at the height of the LiDAR; boards written for Webots."""

import numpy as np
import pytest

import primkit as pk
from primkit.arguments import LikelyWrong
from tests.filing import bits, refusal, written

Z_UP, Y_UP = "#VRML_SIM R2023b utf8\n", "#VRML_SIM R2019b utf8\n"


def corners(shape):
    """A polygon's corners, rounded, from the least on."""
    ring = [tuple(round(v, 6) + 0.0 for v in corner) for corner in shape.vertices.tolist()]
    first = ring.index(min(ring))
    return ring[first:] + ring[:first]


def box(x0, y0, x1, y1):
    return [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]


SDF = "<?xml version='1.0'?><sdf version='1.8'>{}</sdf>"
LINK = "<model name='m'><pose>{}</pose><link name='l'><pose>{}</pose><collision name='c'>{}</collision></link></model>"
BOX = "<pose>{}</pose><geometry><box><size>2 1 0.5</size></box></geometry>"
STILL = "0 0 0 0 0 0"
WORLDS = {
    "a box with z up": (Z_UP + "Solid { translation 1 2 0 boundingObject Box { size 2 1 3 } }", box(0, 1.5, 2, 2.5)),
    "a box with y up": (Y_UP + "Solid { translation 1 0 -2 boundingObject Box { size 2 3 1 } }", box(0, 1.5, 2, 2.5)),
    "the axes told": (
        Y_UP + 'WorldInfo { coordinateSystem "ENU" } Solid { boundingObject Box { size 2 1 3 } }',
        box(-1, -0.5, 1, 0.5),
    ),
    "turned by a quarter": (
        Z_UP + "Solid { rotation 0 0 1 1.5707963267948966 children [ Solid { translation 2 0 0 "
        "boundingObject Shape { geometry Box { size 2 1 3 } } } ] }",
        box(-0.5, 1, 0.5, 3),
    ),
    "turned with y up": (
        Y_UP + "Solid { rotation 0 1 0 1.5707963267948966 translation 3 0 0 boundingObject Box { size 2 3 1 } }",
        box(2.5, -1, 3.5, 1),
    ),
    "lying on its side": (
        Z_UP + "Solid { rotation 1 0 0 1.5707963267948966 boundingObject Box { size 2 3 1 } }",
        box(-1, -0.5, 1, 0.5),
    ),
    "defined and used": (
        Z_UP + "# a comment { \nDEF A Solid { children [ Shape { geometry DEF B Box { size 2 1 3 } } ]"
        ' name "x # { \\" y" boundingObject USE B }',
        box(-1, -0.5, 1, 0.5),
    ),
    "a shape without a bounding object": (
        Z_UP + "Transform { translation 1 0 0 children Shape { geometry Box { size 2, 1, 3 } } }",
        box(0, -0.5, 2, 0.5),
    ),
    "a wooden box": (
        Z_UP + 'EXTERNPROTO "webots://x.proto"\nWoodenBox { translation 1 0 0.3 }',
        box(0.7, -0.3, 1.3, 0.3),
    ),
    "a wall": (Z_UP + "Wall { translation 1 0 0 size 0.2 1 2.4 }", box(0.9, -0.5, 1.1, 0.5)),
    "a wall with y up": (Y_UP + "Wall { translation 1 0 0 size 1 2.4 0.2 }", box(0.5, -0.1, 1.5, 0.1)),
    "sdf": (SDF.format(LINK.format("1 2 0 0 0 0", STILL, BOX.format(STILL))), box(0, 1.5, 2, 2.5)),
    "sdf, frames in frames": (
        SDF.format(f"<world>{LINK}</world>".format("0 0 0 0 0 1.5707963267948966", "2 0 0 0 0 0", BOX.format(STILL))),
        box(-0.5, 1, 0.5, 3),
    ),
    "sdf in degrees": (
        SDF.format(LINK.format(STILL, STILL, BOX.format(STILL).replace("<pose>", "<pose degrees='true'>")).replace(
            f"<pose degrees='true'>{STILL}", "<pose degrees='true'>0 0 0 0 0 90")),
        box(-0.5, -1, 0.5, 1),
    ),
    "sdf, visuals alone": (
        SDF.format(LINK.format(STILL, STILL, BOX.format(STILL)).replace("collision", "visual")),
        box(-1, -0.5, 1, 0.5),
    ),
    "sdf, a polyline": (
        SDF.format(LINK.format(STILL, STILL, "<geometry><polyline><point>0 0</point><point>1 0</point>"
                               "<point>0 1</point><height>1</height></polyline></geometry>")),
        [(0, 0), (1, 0), (0, 1)],
    ),
}  # fmt: skip


@pytest.mark.parametrize(("text", "expected"), WORLDS.values(), ids=WORLDS)
def test_a_polygon_stands_where_it_does_there(tmp_path, text, expected):
    world = pk.load_world(written(tmp_path, text, "a.sdf" if "<sdf" in text else "a.wbt"))
    assert [corners(shape) for shape in world.shapes] == [expected]


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("a.wbt", Z_UP + "Solid { translation 1 2 0 boundingObject Cylinder { radius 0.3 height 1 } }"),
        ("a.wbt", Y_UP + "Solid { translation 1 0 -2 boundingObject Cylinder { radius 0.3 height 1 } }"),
        (
            "a.world",
            SDF.format(LINK.format("1 0 0 0 0 0", "0 2 0 0 0 0", "<geometry><cylinder><radius>0.3</radius>"
                                   "<length>1</length></cylinder></geometry>")),
        ),
    ],
)  # fmt: skip
def test_a_cylinder_is_a_circle(tmp_path, name, text):
    (circle,) = pk.load_world(written(tmp_path, text, name)).shapes
    np.testing.assert_allclose([*circle.center, circle.radius], [1, 2, 0.3], atol=1e-12)


MESH = "<geometry><mesh><uri>x.dae</uri></mesh></geometry>"
PASSED = {
    "tilted": (Z_UP + "Solid { rotation 1 0 0 0.5 boundingObject Box { size 1 1 1 } }", "1 x box that is tilted"),
    "a lying cylinder": (
        Z_UP + "Solid { rotation 1 0 0 1.57 boundingObject Cylinder { radius 1 height 1 } }",
        "1 x cylinder that is tilted",
    ),
    "too high": (
        Z_UP + "Solid { translation 0 0 1 boundingObject Box { size 1 1 1 } }",
        "1 x box that is not at the height of 0.1 m",
    ),
    "other things": (
        Z_UP + "Robot { } Solid { boundingObject Sphere { radius 1 } } Robot { }",
        "2 x Robot, 1 x Sphere",
    ),
    "scaled": (
        Z_UP + "Transform { scale 1 2 1 children [ Shape { geometry Box { size 1 1 1 } } ] }",
        "1 x Transform that is scaled",
    ),
    "no size": (Z_UP + "Wall { } Solid { boundingObject Box { } }", "1 x Box without a size, 1 x Wall without a size"),
    "sdf": (
        SDF.format(
            "<world name='w'><include><uri>model://x</uri></include>" + LINK.format(STILL, STILL, MESH) + "</world>"
        ),
        "1 x include, 1 x mesh",
    ),
}


@pytest.mark.parametrize(("text", "told"), PASSED.values(), ids=PASSED)
def test_what_is_passed_over_is_said(tmp_path, text, told):
    path = written(tmp_path, text, "a.sdf" if "<sdf" in text else "a.wbt")
    with pytest.warns(LikelyWrong) as said:
        assert pk.load_world(path).shapes == ()
    assert [str(one.message) for one in said] == [f"passed over, and not in the world: {told}"]
    assert said[0].filename == __file__


def test_the_height_of_the_lidar_decides(tmp_path):
    text = Z_UP + "Solid { translation 0 0 1 boundingObject Box { size 1 1 1 } }"
    assert len(pk.load_world(written(tmp_path, text, "a.wbt"), height=0.6).shapes) == 1


@pytest.mark.parametrize(
    ("text", "size", "walls", "n"),
    [
        (Z_UP + "RectangleArena { floorSize 3 3 }", 3.0, True, 0),
        (Z_UP + "RectangleArena { rotation 0 0 1 1.5707963267948966 }", 1.0, True, 0),
        (Z_UP + "RectangleArena { translation 1 0 0 }", None, False, 4),
        (Z_UP + "RectangleArena { floorSize 3 2 wallHeight 0.3 }", None, False, 4),
        (Y_UP + "RectangleArena { floorSize 3 2 wallHeight 0.3 }", None, False, 4),
        (Z_UP + "Floor { size 4 4 }", 4.0, False, 0),
    ],
)
def test_an_arena_is_a_board_or_four_walls(tmp_path, text, size, walls, n):
    world = pk.load_world(written(tmp_path, text, "a.wbt"))
    assert (world.walled, len(world.shapes)) == (walls, n)
    assert size in (None, world.size)
    if "3 2" in text:
        ranges = pk.scan(world, [(0, 0, 0)], pk.Lidar(4, range_max=5)).ranges
        np.testing.assert_allclose(ranges, [[1.5, 1.0, 1.5, 1.0]])


@pytest.mark.parametrize("walls", [False, True])
def test_a_board_goes_to_webots_and_back(tmp_path, walls):
    for seed in range(5):
        world = pk.random_world(4, rng=seed, style="any", walls=walls)
        pk.save_world(world, tmp_path / "board.wbt")
        assert bits(pk.load_world(tmp_path / "board.wbt")) == bits(world)


REFUSED = {
    "no Webots": ("x", "must begin with #VRML_SIM and a release, got 'x'"),
    "an open node": (Z_UP + "Solid { children [ ", "must close each bracket with ], got the end of the file"),
    "an open list": (Z_UP + "Solid { translation 0 0 0", "must close each bracket with }, got the end of the file"),
    "an unknown name": (Z_UP + "USE A", "USE must name a node that was defined before, got 'A'"),
    "too deep": (Z_UP + "Group { children [ " * 100, "must be nested at most 60 deep, got 61"),
    "a size of two": (
        Z_UP + "Solid { boundingObject Box { size 1 1 } }",
        "size must be 3 numbers, got ['1', '1']",
    ),
    "a flat box": (
        Z_UP + "Solid { boundingObject Box { size 1 1 0 } }",
        "size must be 3 numbers > 0, got ['1', '1', '0']",
    ),
    "ever more": (
        Z_UP
        + "DEF A0 Box { size 1 1 1 } "
        + " ".join(f"DEF A{i} Group {{ children [ {f'USE A{i - 1} ' * 10}] }}" for i in range(1, 12)),
        "must have at most 50,000 nodes, got 50,001",
    ),
    "no XML": ("<sdf", "must be XML in UTF-8 without declarations, got something else"),
    "entities": (
        "<!DOCTYPE x [<!ENTITY a 'b'>]><sdf/>",
        "must be XML in UTF-8 without declarations, got something else",
    ),
    "other XML": ("<robot/>", "must be SDF, with <sdf> around all, got <robot>"),
    "a frame": (
        "<sdf><model><pose relative_to='x'>0 0 0 0 0 0</pose></model></sdf>",
        "a pose must be told in the frame around it, got one in 'x'",
    ),
    "a short pose": ("<sdf><model><pose>0 0</pose></model></sdf>", "pose must be 6 numbers, got ['0', '0']"),
    "deep XML": ("<sdf>" + "<model>" * 90 + "</model>" * 90 + "</sdf>", "must be nested at most 60 deep, got 61"),
}  # fmt: skip


@pytest.mark.parametrize(("text", "sentence"), REFUSED.values(), ids=REFUSED)
def test_what_is_no_world_is_refused(tmp_path, text, sentence):
    name = "a.sdf" if "sdf" in text or "<robot" in text else "a.wbt"
    assert refusal(pk.load_world, written(tmp_path, text, name)) == f"{name}: {sentence}"
