"""Recordings written as robots write them, for the tests of the readers: logs of CARMEN, bags of ROS, tables."""

import gzip

import numpy as np

BAGS = ("bag", "db3", "mcap")


def carmen_log(poses, ranges, *, laser="FLASER", step=None, start=None, range_max=81.83, digits=9):
    """A log's bytes with a scan a line; ROBOTLASER1 tells the first angle, the step and the range_max."""
    lines = ["# message formats defined: PARAM SYNC ODOM FLASER RLASER", "PARAM robot_front_laser_max 80.99 nohost 0"]
    for pose, row in zip(poses, ranges, strict=True):
        numbers = f"{len(row)} " + " ".join(f"{r:.{digits}f}" for r in row)
        place = " ".join(f"{v:.12f}" for v in pose)
        if laser == "FLASER":
            lines.append(f"FLASER {numbers} {place} {place} 1.5 host 1.5")
        else:
            head = f"0 {start:.15f} {step * len(row):.15f} {step:.15f} {range_max:.15f} 0.01 0"
            lines.append(f"ROBOTLASER1 {head} {numbers} 2 0.5 0.5 {place} {place} 0 0 0 0 0 1.5 host 1.5")
        lines.append(f"ODOM {place} 0 0 0 1.5 host 1.5")
    return ("\n".join(lines) + "\n").encode()


def write_log(path, *args, **more):
    data = carmen_log(*args, **more)
    path.write_bytes(gzip.compress(data) if path.suffix == ".gz" else data)
    return path


def table(angles, ranges, head="angle_deg,distance_mm", scale=(180 / np.pi, 1000.0)):
    """A table's text, a line a beam."""
    rows = [f"{scale[0] * angle:.12f},{scale[1] * r:.9f}" for angle, r in zip(angles, ranges, strict=True)]
    return "\n".join([head, *rows]) + "\n"


class Bag:
    """A bag of one of three kinds that is being written: ``scan``, ``odometry``, ``transform``, then ``close``."""

    def __init__(self, path, kind):
        from rosbags.rosbag1 import Writer as Writer1
        from rosbags.rosbag2 import StoragePlugin, Writer
        from rosbags.typesys import Stores, get_types_from_msg, get_typestore

        self.first = kind == "bag"
        self.types = get_typestore(Stores.ROS1_NOETIC if self.first else Stores.ROS2_HUMBLE)
        if self.first:
            tf = get_types_from_msg("geometry_msgs/TransformStamped[] transforms", "tf2_msgs/msg/TFMessage")
            self.types.register(tf)
            self.writer, self.path = Writer1(path / "a.bag"), path / "a.bag"
        else:
            plugin = StoragePlugin.MCAP if kind == "mcap" else StoragePlugin.SQLITE3
            self.writer, self.path = Writer(path / kind, version=8, storage_plugin=plugin), path / kind
        self.writer.open()
        self.topics = {}

    def close(self):
        self.writer.close()
        return self.path

    def scan(self, time, lidar, ranges, topic="/scan", frame="laser"):
        step = lidar.angle_increment
        told = {
            "angle_min": lidar.angle_min,
            "angle_max": lidar.angle_min + step * (lidar.beams - 1),
            "angle_increment": step,
            "time_increment": 0.0,
            "scan_time": 0.1,
            "range_min": lidar.range_min,
            "range_max": lidar.range_max,
            "ranges": np.asarray(ranges, dtype=np.float32),
            "intensities": np.empty(0, dtype=np.float32),
        }
        self._write(topic, "sensor_msgs/msg/LaserScan", time, header=self._header(time, frame), **told)

    def odometry(self, time, pose, topic="/odom", body="base"):
        types = self.types.types
        still = types["geometry_msgs/msg/Vector3"](0.0, 0.0, 0.0)
        twist = types["geometry_msgs/msg/TwistWithCovariance"](
            types["geometry_msgs/msg/Twist"](still, still), np.zeros(36)
        )
        place = types["geometry_msgs/msg/Point"](float(pose[0]), float(pose[1]), 0.0)
        placed = types["geometry_msgs/msg/Pose"](place, self._quaternion(yaw=pose[2]))
        with_covariance = types["geometry_msgs/msg/PoseWithCovariance"](placed, np.zeros(36))
        header = self._header(time, "odom")
        self._write(
            topic, "nav_msgs/msg/Odometry", time, header=header, child_frame_id=body, pose=with_covariance, twist=twist
        )

    def transform(self, parent, child, place=(0.0, 0.0), yaw=0.0, roll=0.0, time=0.0, topic="/tf_static"):
        types = self.types.types
        way = types["geometry_msgs/msg/Transform"](
            types["geometry_msgs/msg/Vector3"](*map(float, place), 0.2), self._quaternion(yaw, roll)
        )
        stamped = types["geometry_msgs/msg/TransformStamped"](self._header(time, parent), child, way)
        self._write(topic, "tf2_msgs/msg/TFMessage", time, transforms=[stamped])

    def _quaternion(self, yaw=0.0, roll=0.0):
        """Roll about x, then yaw about z."""
        (cy, sy), (cr, sr) = ((np.cos(v / 2), np.sin(v / 2)) for v in (yaw, roll))
        return self.types.types["geometry_msgs/msg/Quaternion"](*map(float, (cy * sr, sy * sr, sy * cr, cy * cr)))

    def _header(self, time, frame):
        seconds = int(time)
        stamp = self.types.types["builtin_interfaces/msg/Time"](seconds, round(1e9 * (time - seconds)))
        parts = {"stamp": stamp, "frame_id": frame} | ({"seq": 0} if self.first else {})
        return self.types.types["std_msgs/msg/Header"](**parts)

    def _write(self, topic, kind, time, **fields):
        if topic not in self.topics:
            self.topics[topic] = self.writer.add_connection(topic, kind, typestore=self.types)
        message = self.types.types[kind](**fields)
        pack = self.types.serialize_ros1 if self.first else self.types.serialize_cdr
        self.writer.write(self.topics[topic], int(1e9 * time) + 1, pack(message, kind))


def driven_bag(path, kind, scans, lidar, mounted=(0.0, 0.0, 0.0)):
    """A bag of a drive whose laser is ``mounted`` at x, y, yaw on the body; poses of scans are those of the laser."""
    bag = Bag(path, kind)
    x, y, yaw = mounted
    bag.transform("base", "laser", (x, y), yaw)
    for number, (pose, ranges) in enumerate(zip(scans.poses, scans.ranges, strict=True)):
        heading = pose[2] - yaw
        body = pose[0] - x * np.cos(heading) + y * np.sin(heading), pose[1] - x * np.sin(heading) - y * np.cos(heading)
        bag.odometry(1.0 + number, (*body, heading))
        bag.odometry(1.4 + number, (9.0, 9.0, 1.0))  # farther off in time
        bag.scan(1.1 + number, lidar, ranges)
    return bag.close()
