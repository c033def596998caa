"""The recordings of lesson 10, made by MuJoCo, an independent simulator: a drive in an arena, and one scan of a desk.

    python -m tests.benchmarks.simulated_arena    # writes notebooks/recordings anew; needs mujoco

In MuJoCo a robot with two wheels drives: its motors turn them, and they roll and skid on the floor as its physics has
it. Of primkit there is nothing in it but the shapes that stand in the arena.

    wheels    radii 20.5 and 20.54 mm, an axle of 51.4 mm; the odometry counts on 20.5 mm, 20.5 mm and 52 mm
    steering  3 rad/s; towards a corner of the way, as seen from the true place
    sensor    120 beams, one turn, all at once, in the robot's middle, 8 cm above the floor; it tilts with the robot;
              from 0.085 to 0.7 m, noise 3 mm, whole millimetres
    driver    lost (3 in 100): 0; damaged (5 in 1,000): nan; from the maximum on: 65.535; nearer than the minimum:
              anything from 1 mm to the minimum

The desk: one sweep of 360 beams, clockwise, noise 2 mm, in a table as tools of the RPLIDAR write it; lost (2 in 100)
or nearer than 0.15 m: 0.

These are the models of no product. Not here: that a sweep takes time, that dark and slanting surfaces are lost more
often, that people walk by.
"""

import gzip
from pathlib import Path

import mujoco
import numpy as np

import primkit as pk

OUT = Path(__file__).resolve().parents[2] / "notebooks" / "recordings"
SEED = 10
WHEEL, AXLE = 0.0205, 0.052  # m: what the odometry counts on
TRUE_WHEELS, TRUE_AXLE = (0.0205, 0.02054), 0.0514  # m
SPEED, GAIN, CARROT = 3.0, 4.0, 0.08  # rad/s, rad/s2, and m from a corner: then comes the next
STEP, EVERY, SETTLE, COUNTED = 0.002, 500, 250, 10  # s; steps from scan to scan, before the first, between encoders
BEAMS, LEAST, MOST, NOISE, UNIT, HEIGHT = 120, 0.085, 0.7, 0.003, 0.001, 0.08  # m
LOST, DAMAGED, BEYOND = 0.03, 0.005, 65.535
CORNERS = [(-0.42, -0.42), (0.42, -0.42), (0.42, 0.42), (-0.42, 0.42)]
WAY = [*CORNERS, *CORNERS, CORNERS[0]]
PENTAGON = np.arange(5) * 2 * np.pi / 5 + 0.4
ARENA = pk.World(
    [
        pk.Circle((0.21, 0.22), 0.08),
        pk.Polygon([(-0.32, 0.12), (-0.12, 0.12), (-0.12, 0.28), (-0.32, 0.28)]).moved((0.0, 0.0), 0.3),
        pk.Polygon([(-0.3, -0.31), (-0.08, -0.28), (-0.21, -0.1)]),
        pk.Polygon(np.array((0.22, -0.2)) + 0.1 * np.column_stack([np.cos(PENTAGON), np.sin(PENTAGON)])),
    ],
    walls=True,
)
BOOK = pk.Polygon([(-0.09, -0.065), (0.09, -0.065), (0.09, 0.065), (-0.09, 0.065)])
DESK = pk.World([pk.Circle((0.3, 0.12), 0.045), BOOK.moved((-0.1, 0.33), 0.5)], walls=True)

ROBOT = """
<body name="robot" pos="{x} {y} {wheel}" euler="0 0 {heading}">
  <freejoint/>
  <geom type="cylinder" size="0.035 0.02" pos="0 0 0.005" mass="0.15" contype="0" conaffinity="0"/>
  <geom class="caster" pos="0.025 0 {caster}"/><geom class="caster" pos="-0.025 0 {caster}"/>
  <site name="lidar" pos="0 0 {height}"/>
  <body pos="0 {aside} {left_up}"><joint name="left"/><geom class="wheel" size="{left} 0.002"/></body>
  <body pos="0 -{aside} {right_up}"><joint name="right"/><geom class="wheel" size="{right} 0.002"/></body>
</body>"""
BOARD = """
<mujoco>
  <option timestep="{step}" integrator="implicitfast" cone="elliptic" impratio="20"/>
  <compiler angle="radian"/>
  <default>
    <joint axis="0 1 0" damping="1e-5"/>
    <default class="wheel"><geom type="cylinder" mass="0.01" quat="1 1 0 0"/></default>
    <default class="caster"><geom type="sphere" size="0.005" mass="0.005" condim="1" priority="1"/></default>
  </default>
  <asset>{assets}</asset>
  <worldbody><geom type="plane" size="1 1 0.1" friction="0.9 0.005 0.0001"/>{solids}{robot}</worldbody>
  <actuator><velocity joint="left" kv="0.02"/><velocity joint="right" kv="0.02"/></actuator>
</mujoco>"""


def board(world, pose):
    """Return a board in MuJoCo, all upright and 20 cm tall, with the robot on it at rest."""
    assets, solids = "", ""
    for number, shape in enumerate(world.shapes):
        if isinstance(shape, pk.Circle):
            x, y = shape.center.tolist()
            solids += f'<geom type="cylinder" pos="{x} {y} 0.1" size="{shape.radius} 0.1"/>'
            continue
        corners = " ".join(f"{x} {y} {z}" for z in (0, 0.2) for x, y in shape.vertices.tolist())
        assets += f'<mesh name="m{number}" vertex="{corners}" inertia="convex"/>'
        solids += f'<geom type="mesh" mesh="m{number}"/>'
    for start, end in world.walls:
        outward = np.array([end[1] - start[1], start[0] - end[0]])
        x, y = ((start + end) / 2 + 0.05 * outward).tolist()
        wide, deep = np.where(np.abs(outward) > 0.5, 0.05, 0.6).tolist()
        solids += f'<geom type="box" pos="{x} {y} 0.1" size="{wide} {deep} 0.1"/>'
    left, right = TRUE_WHEELS
    parts = {"left": left, "right": right, "left_up": left - WHEEL, "right_up": right - WHEEL, "aside": TRUE_AXLE / 2}
    parts |= {"wheel": WHEEL, "caster": 0.005 - WHEEL, "height": HEIGHT - WHEEL}
    robot = ROBOT.format(**parts, **dict(zip(("x", "y", "heading"), pose, strict=True)))
    model = mujoco.MjModel.from_xml_string(BOARD.format(step=STEP, assets=assets, solids=solids, robot=robot))
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, SETTLE)
    return model, data


def pose_of(data):
    """Return where the robot is: x, y [m] and heading [rad]."""
    w, x, y, z = data.qpos[3:7]
    return np.array([*data.qpos[:2], np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))])


def seen_there(model, data, angles):
    """Return what a sensor without faults reads, shape (B,), metres; inf where nothing is."""
    mujoco.mj_forward(model, data)  # the sensor is where the last step has brought it
    ways = np.column_stack([np.cos(angles), np.sin(angles), 0 * angles]) @ data.site("lidar").xmat.reshape(3, 3).T
    n, place, robot = len(angles), data.site("lidar").xpos, model.body("robot").id
    hit, far = np.zeros(n, dtype=np.int32), np.zeros(n)
    mujoco.mj_multiRay(model, data, place, ways.ravel(), None, True, robot, hit, far, None, n, 10.0)
    return np.where(far >= 0, far, np.inf)


def as_driver_writes(ranges, rng):
    """Return what the driver of the robot writes, with its words for what is no reading."""
    noisy = np.round((ranges + rng.normal(0, NOISE, ranges.shape)) / UNIT) * UNIT
    near = np.round(rng.uniform(UNIT, LEAST, ranges.shape) / UNIT) * UNIT
    told = np.where(ranges < LEAST, near, np.where(noisy >= MOST, BEYOND, noisy))
    chance = rng.uniform(size=ranges.shape)
    return np.where(chance < DAMAGED, np.nan, np.where(chance < DAMAGED + LOST, 0.0, told))


def drive(world, way):
    """Return the true poses, those that the odometry tells, both (P, 3), and what there is to be seen, (P, B)."""
    (x, y), (u, v) = way[:2]
    model, data = board(world, (x, y, np.arctan2(v - y, u - x)))
    angles = 2 * np.pi * np.arange(BEAMS) / BEAMS
    here, counted, leg, number = pose_of(data), data.qpos[7:9].copy(), 1, 0
    true, told, seen = [here], [here], [seen_there(model, data, angles)]
    while leg < len(way):
        place, number = pose_of(data), number + 1
        ahead = way[leg] - place[:2]
        leg += np.hypot(*ahead) < CARROT
        off = np.remainder(np.arctan2(ahead[1], ahead[0]) - place[2] + np.pi, 2 * np.pi) - np.pi
        turn = np.clip(2 * off, -1, 1)
        wanted = SPEED * (1 - abs(turn) / 2 + np.array([-0.5, 0.5]) * turn)
        data.ctrl[:] += np.clip(wanted - data.ctrl, -GAIN * STEP, GAIN * STEP)
        mujoco.mj_step(model, data)
        if number % COUNTED == 0:
            left, right = WHEEL * (data.qpos[7:9] - counted)
            counted, turned = data.qpos[7:9].copy(), (right - left) / AXLE
            bearing = here[2] + turned / 2
            here = here + np.array([(left + right) / 2 * np.cos(bearing), (left + right) / 2 * np.sin(bearing), turned])
        if number % EVERY == 0:
            true.append(pose_of(data))
            told.append(here)
            seen.append(seen_there(model, data, angles))
    return np.array(true), np.array(told), np.array(seen)


def log_of(told, ranges):
    """Return a drive as a log of CARMEN."""
    lines = ["# Made by MuJoCo, see tests/benchmarks/simulated_arena.py; the poses are those of the odometry"]
    head = f"ROBOTLASER1 0 0 {2 * np.pi:.6f} {2 * np.pi / BEAMS!r} {MOST} {UNIT} 0 {BEAMS}"
    for number, (pose, row) in enumerate(zip(told, ranges, strict=True)):
        place, time = " ".join(f"{value:.6f}" for value in pose), f"{number * EVERY * STEP:.3f}"
        lines.append(f"{head} {' '.join(f'{r:.3f}' for r in row)} 0 {place} {place} 0 0 0 0 0 {time} arena {time}")
    return "\n".join(lines) + "\n"


def table_of(world, rng):
    """Return one sweep from the middle of a board as a table of angles, clockwise, and distances."""
    degrees = np.arange(360)
    ranges = seen_there(*board(world, (0, 0, 0)), -np.radians(degrees))
    told = np.round(4 * (1000 * ranges + rng.normal(0, 2, 360))) / 4  # the sensor counts quarters of a millimetre
    told[(ranges < 0.15) | (rng.uniform(size=360) < 0.02)] = 0
    rows = [f"{a},{r:g},{15 if r else 0}" for a, r in zip(degrees, told, strict=True)]
    return "\n".join(["angle_deg,distance_mm,quality", *rows]) + "\n"


def main():
    rng = np.random.default_rng(SEED)
    true, told, seen = drive(ARENA, WAY)
    OUT.mkdir(exist_ok=True)
    packed = gzip.compress(log_of(told, as_driver_writes(seen, rng)).encode(), mtime=0)
    (OUT / "arena.log.gz").write_bytes(packed)
    (OUT / "desk.csv").write_text(table_of(DESK, rng))
    pk.save_world(ARENA, OUT / "arena.geojson")
    off = told[-1] - true[-1]
    print(f"{len(told)} scans on {np.hypot(*np.diff(true[:, :2], axis=0).T).sum():.2f} m, {len(packed)} bytes")
    turn = np.degrees(np.remainder(off[2] + np.pi, 2 * np.pi) - np.pi)
    print(f"the odometry ends {1000 * np.hypot(*off[:2]):.0f} mm and {turn:.1f} degrees off")


if __name__ == "__main__":
    main()
