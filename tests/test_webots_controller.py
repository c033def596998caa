"""The controller of the teacher's pack, run against a stand-in for Webots: a robot that our own simulator moves."""

import runpy
import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace

import numpy as np
import pytest

import primkit as pk

CONTROLLER = Path(__file__).resolve().parent.parent / "notebooks" / "teacher" / "webots_controller.py"
BEAMS, FOV, REACH, STEP = 90, 4.0, 0.9, 32


class StandIn:
    """What the controller asks of a robot in Webots; it drives in a circle of 0.3 m."""

    def __init__(self, world):
        self.world, self.time, self.poses, self.speeds = world, 0.0, [], {}
        between = FOV / BEAMS
        self.sensor = pk.Lidar(BEAMS, 0.01, REACH, fov=FOV, angle_min=between * (BEAMS - 1) / 2, clockwise=True)

    def getBasicTimeStep(self):  # noqa: N802 - Webots' names
        return float(STEP)

    def getTime(self):  # noqa: N802
        return self.time

    def step(self, milliseconds):
        self.time += milliseconds / 1000
        return 0

    @property
    def pose(self):
        a = 0.2 * self.time
        return float(0.3 * np.cos(a)), float(0.3 * np.sin(a)), float(np.mod(a + np.pi / 2 + np.pi, 2 * np.pi) - np.pi)

    def seen(self):
        self.poses.append(self.pose)
        return np.minimum(pk.scan(self.world, self.pose, self.sensor).ranges[0], np.inf).tolist()

    def getDevice(self, name):  # noqa: N802
        on = {"enable": lambda _: None}
        return {
            "lidar": SimpleNamespace(
                getHorizontalResolution=lambda: BEAMS,
                getFov=lambda: FOV,
                getMaxRange=lambda: REACH,
                getRangeImage=self.seen,
                **on,
            ),
            "gps": SimpleNamespace(getValues=lambda: [*self.pose[:2], 0.1], **on),
            "inertial unit": SimpleNamespace(getRollPitchYaw=lambda: [0.0, 0.0, self.pose[2]], **on),
        }.get(name) or SimpleNamespace(
            setPosition=lambda _: None, setVelocity=lambda speed: self.speeds.update({name: speed})
        )


def test_its_log_holds_what_the_robot_saw(tmp_path, monkeypatch):
    world = pk.World([pk.Circle((0.0, 0.0), 0.1), pk.Polygon([(-0.45, 0.4), (-0.2, 0.4), (-0.3, 0.48)])], walls=True)
    robot, module = StandIn(world), ModuleType("controller")
    module.Robot = lambda: robot
    monkeypatch.setitem(sys.modules, "controller", module)
    monkeypatch.chdir(tmp_path)
    runpy.run_path(str(CONTROLLER))
    scans = pk.load_scans("drive.log")
    assert len(scans) == len(robot.poses) > 100
    assert set(robot.speeds) == {"left wheel motor", "right wheel motor"}
    np.testing.assert_allclose(scans.poses, robot.poses, atol=1e-12)
    truth = pk.scan(world, robot.poses, robot.sensor)
    assert np.abs(scans.points() - truth.points()).max() < 2e-6
    outlines = [shape.signed_distance(scans.points()) for shape in world.shapes]
    to_wall = 0.5 - np.abs(scans.points()).max(axis=1)
    assert np.min(np.abs([*outlines, to_wall]), axis=0).max() == pytest.approx(0, abs=3e-6)
