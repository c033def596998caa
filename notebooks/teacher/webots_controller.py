"""A controller for Webots: drive in a circle, and write what the LiDAR sees as a log that `pk.load_scans` reads.

Untried in Webots itself: the tests run it against a stand-in. In Webots: open a board that `pk.save_world(world,
"board.wbt")` wrote, add a two-wheeled robot with a Lidar ("lidar"), a GPS ("gps") and an InertialUnit ("inertial unit")
at its middle, and give it this controller. Then, in Python, `pk.load_scans("drive.log")`.
"""

from controller import Robot

LOG, SECONDS, EVERY = "drive.log", 60.0, 10  # a scan every tenth step
LEFT, RIGHT = 2.0, 2.6  # rad/s
CLOCKWISE = True  # Webots tells ranges from the left to the right; False if the map comes out mirrored

robot = Robot()
step = int(robot.getBasicTimeStep())
lidar, gps, inertial = (robot.getDevice(name) for name in ("lidar", "gps", "inertial unit"))
for device in (lidar, gps, inertial):
    device.enable(step)
for side, speed in (("left", LEFT), ("right", RIGHT)):
    wheel = robot.getDevice(f"{side} wheel motor")
    wheel.setPosition(float("inf"))
    wheel.setVelocity(speed)

beams, fov = lidar.getHorizontalResolution(), lidar.getFov()
between = -fov / beams if CLOCKWISE else fov / beams
head = f"ROBOTLASER1 0 {-between * (beams - 1) / 2!r} {fov!r} {between!r} {lidar.getMaxRange()!r} 0 0 {beams}"
with open(LOG, "w") as log:
    number = 0
    while robot.step(step) != -1 and robot.getTime() < SECONDS:
        number += 1
        if number % EVERY == 0:
            ranges = " ".join(f"{min(r, lidar.getMaxRange()):.6f}" for r in lidar.getRangeImage()[:beams])
            (x, y, _), (_, _, heading) = gps.getValues(), inertial.getRollPitchYaw()
            place = f"{x!r} {y!r} {heading!r}"
            time = robot.getTime()
            log.write(f"{head} {ranges} 0 {place} {place} 0 0 0 0 0 {time!r} webots {time!r}\n")
