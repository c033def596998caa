"""Bags: what a robot with ROS recorded, read by rosbags: a ``.bag`` of ROS 1, a ``.db3`` or ``.mcap`` of ROS 2.

In:  a file, or the folder that ROS 2 writes; messages LaserScan, Odometry and TFMessage, by the definitions of ROS.
Out: sweeps. Each stands where the odometry nearest in time says, moved by what the transforms that never change tell
     of how the laser is mounted; without odometry at (0, 0, 0), as of a robot that stands still.

    pose of the laser = pose of the body by Odometry . transforms from the body to the laser
    bearing i         = angle_min + i angle_increment, turned round if the laser hangs upside down

Definitions of messages that a bag brings along are not used: rosbags would turn them into code. A bag may be packed,
and what it unpacks to is not bounded here: read those of strangers where it may cost memory.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from ..arguments import Floats, doubt, limit, short
from ..installed import install_line
from .files import naming, size_of
from .plans import moved, turned
from .recordings import RECORDING_LIMIT, Sweep, check_topics, the_one

SCAN, ODOMETRY = "sensor_msgs/msg/LaserScan", "nav_msgs/msg/Odometry"
TRANSFORMS = ("tf2_msgs/msg/TFMessage", "tf/msg/tfMessage")  # today's, and that of the first ROS
NEAR_IN_TIME = 0.5  # s: a robot drives half a metre in it; odometry comes ten times as often
SAME_MOUNTING = 1e-6  # m and sines: two transforms that differ more are of something that moves
LEVEL = 0.99  # cosine of the tilt, 8 degrees: a laser that is tilted more does not see a plan
Hop = tuple[str, Floats]  # to the parent's frame: its name, and the transform, (4, 4)


def read_bag(path: Path, topics: tuple[str, ...]) -> list[Sweep]:
    """Return the sweeps of a bag's one LaserScan topic, or of the one that is told, with poses by the one Odometry."""
    with naming(path.name):
        found: dict[str, dict[str, list[Any]]] = defaultdict(lambda: defaultdict(list))
        for topic, kind, message in _messages(path):
            found[kind][topic].append(message)
        check_topics(topics, [topic for kind in (SCAN, ODOMETRY) for topic in found[kind]])
        laser = the_one(found[SCAN], topics, "topic of laser scans")
        odometry = the_one(found[ODOMETRY], topics, "topic of odometry")
        if laser is None:
            return []
        hops = _hops([one for kind in TRANSFORMS for messages in found[kind].values() for one in messages])
        poses = found[ODOMETRY].get(odometry or "", [])
        frames = {
            (_frame(scan.header.frame_id), _frame(poses[0].child_frame_id)) for scan in found[SCAN][laser] if poses
        }
        mountings = {frame: _mounting(frame, body, hops) for frame, body in frames}
        if loose := [frame for frame, mounting in mountings.items() if mounting is None]:
            doubt(f"nothing tells how {short(loose[0])} is mounted: it is taken to lie where the odometry says", 2)
        times = np.array([_time(pose) for pose in poses])
        sweeps = [_sweep(scan, times, poses, mountings) for scan in found[SCAN][laser]]
        if lost := sweeps.count(None):
            doubt(f"{lost} of {len(sweeps)} scans have no odometry within {NEAR_IN_TIME:g} s: they are left out", 2)
        return [sweep for sweep in sweeps if sweep is not None]


def _messages(path: Path) -> Iterator[tuple[str, str, Any]]:
    """Yield topic, type and content of the messages that matter."""
    try:
        from rosbags.rosbag1 import Reader as Reader1
        from rosbags.rosbag2 import Reader as Reader2
        from rosbags.typesys import Stores, get_types_from_msg, get_typestore
    except ModuleNotFoundError:
        raise ValueError(f"a bag needs rosbags, which is not installed: {install_line('ros')}") from None
    files = [path] if not path.is_dir() else sorted([*path.glob("*.db3"), *path.glob("*.mcap")])
    if not files:
        raise ValueError("must be a bag, or a folder with a .db3 or .mcap file, got neither")
    limit(sum(map(size_of, files)), RECORDING_LIMIT, "must be at most {} bytes")
    for file in files:
        first = file.suffix.lower() == ".bag"
        types = get_typestore(Stores.ROS1_NOETIC if first else Stores.ROS2_HUMBLE)
        for kind in set(TRANSFORMS) - set(types.fielddefs):
            types.register(get_types_from_msg("geometry_msgs/TransformStamped[] transforms", kind))
        content = types.deserialize_ros1 if first else types.deserialize_cdr
        try:
            with (Reader1 if first else Reader2)(file) as reader:
                wanted = [one for one in reader.connections if one.msgtype in (SCAN, ODOMETRY, *TRANSFORMS)]
                for connection, _, data in reader.messages(wanted) if wanted else ():
                    yield connection.topic, connection.msgtype, content(data, connection.msgtype)
        except Exception:  # a damaged bag fails in dozens of ways, in rosbags and below
            raise ValueError("must be a bag that rosbags reads, got one that is damaged or of another kind") from None


def _time(message: Any) -> float:
    return float(message.header.stamp.sec + 1e-9 * message.header.stamp.nanosec)


def _hops(messages: list[Any]) -> dict[str, Hop]:
    """Return the way from each frame to its parent's, where that never changes."""
    hops: dict[str, Hop] = {}
    moving = set()
    for one in (transform for message in messages for transform in message.transforms):
        child, way = _frame(one.child_frame_id), one.transform
        hop = _frame(one.header.frame_id), _matrix(way.translation, way.rotation)
        parent, before = hops.setdefault(child, hop)
        if parent != hop[0] or not np.abs(before - hop[1]).max() <= SAME_MOUNTING:
            moving.add(child)
    return {child: hop for child, hop in hops.items() if child not in moving}


def _frame(name: str) -> str:
    return name.lstrip("/")


def _matrix(place: Any, turn: Any) -> Floats:
    """Return a transform from a place [m] and a quaternion, shape (4, 4)."""
    axis = turn.x, turn.y, turn.z
    norm = math.hypot(sine := math.hypot(*axis), turn.w)  # which tells of no overflow
    if not 0.5 < norm < 2:
        raise ValueError(f"a quaternion must have the norm 1, got {norm:g}")
    return moved((place.x, place.y, place.z), turned(axis, 2 * float(np.arctan2(sine, turn.w))))


def _sweep(message: Any, times: Floats, poses: list[Any], mountings: dict[str, Floats | None]) -> Sweep | None:
    """Return a message as a sweep; None where no odometry is near in time."""
    laser = np.eye(4)
    if poses:
        time = _time(message)
        nearest = int(np.abs(times - time).argmin())
        if abs(times[nearest] - time) > NEAR_IN_TIME:
            return None
        body, mounting = poses[nearest].pose.pose, mountings[_frame(message.header.frame_id)]
        laser = _matrix(body.position, body.orientation) @ (laser if mounting is None else mounting)
    if not abs(laser[2, 2]) > LEVEL:
        raise ValueError(
            f"a laser must lie level or upside down, got one that is tilted to a cosine of {laser[2, 2]:g}"
        )
    with np.errstate(invalid="ignore"):  # some drivers write what is no number at all
        ranges = np.asarray(message.ranges, dtype=float)
    if not len(ranges):
        raise ValueError("a LaserScan must have ranges, got none")
    angles = message.angle_min + message.angle_increment * np.arange(len(ranges))
    heading = float(np.arctan2(laser[1, 0], laser[0, 0]))
    pose = float(laser[0, 3]), float(laser[1, 3]), heading
    return Sweep(pose, np.sign(laser[2, 2]) * angles, ranges, message.range_min, message.range_max)


def _mounting(laser: str, body: str, hops: dict[str, Hop]) -> Floats | None:
    """Return the way from the laser's frame to the body's, (4, 4); None where they do not hang together."""
    way, frame, left = np.eye(4), laser, len(hops)
    while frame != body and frame in hops and left:
        frame, step = hops[frame]
        way, left = step @ way, left - 1
    return way if frame == body else None
