"""Keyed: drives with four keys, as the paper's authors drove: straight on, back, or a turn on the spot, and no arcs.

W and S turn both wheels at full speed, A and D one against the other; a key is held for a tenth of a second, then there
is a scan. Their paths were not recorded: a driver beside the board plans these as in ``scripted``. Ten times a second
it looks at the place a little ahead on its way, and presses A or D where that lies farther off its heading than half of
what the key turns, and W elsewhere. It never looks at what was mapped. None of it was changed after a score.

The shapes have no body: the start lies in some of them, and the robot drives out through their sides.

In:  a ``World``, a seed.
Out: the keys, one letter for each period; from them the poses of the drive, shape (T + 1, 3).

>>> from primkit.shapes import Circle
>>> world = World([Circle((0.2, 0.1), 0.06)])
>>> keys = press_keys(world, rng=0)
>>> sorted(set(keys)), keyed_poses(keys).shape == (len(keys) + 1, 3)
(['A', 'D', 'W'], True)
"""

from __future__ import annotations

import numpy as np

from ..arguments import Floats, as_rng
from ..formats import bundled_keys
from ..robot import AXLE, FASTEST, PERIOD, PUBLISHED_HEADING, WHEEL, moved
from ..world import World
from .scripted import LOOK_AHEAD, MOST_PERIODS, WAY_STEP, progress, tour

KEYED_START = np.array([-0.0865, -0.2117, PUBLISHED_HEADING])  # the same in all of the paper's worlds
KEY_TURN_SPEED = 4.17  # rad/s
KEYS = {
    "W": (FASTEST, FASTEST),
    "S": (-FASTEST, -FASTEST),
    "A": (-KEY_TURN_SPEED, KEY_TURN_SPEED),
    "D": (KEY_TURN_SPEED, -KEY_TURN_SPEED),
}
TURN_OF_A_KEY = WHEEL * 2 * KEY_TURN_SPEED / AXLE * PERIOD  # rad


def published_drives() -> dict[str, Floats]:
    """Return the poses of the bundled drives, one on each map of ``published_suite``.

    >>> len(published_drives()["1_circle"])
    115
    """
    return {name: keyed_poses(keys) for name, keys in bundled_keys().items()}


def press_keys(world: World, *, rng: int | np.random.Generator | None = None) -> str:
    """Return the keys that bring the robot around all shapes, from the paper's start on.

    >>> press_keys(World(), rng=0)
    ''
    """
    pose, here, keys = KEYED_START, 0, ""
    way, ahead = tour(world, pose[:2], as_rng(rng)), round(LOOK_AHEAD / WAY_STEP)
    while here < len(way) - 1 and len(keys) < MOST_PERIODS:
        here = progress(way, here, pose, ahead)
        aim = way[min(here + ahead, len(way) - 1)] - pose[:2]
        off = (np.arctan2(aim[1], aim[0]) - pose[2] + np.pi) % (2 * np.pi) - np.pi
        keys += "W" if abs(off) <= TURN_OF_A_KEY / 2 else "A" if off > 0 else "D"
        pose = moved(pose, KEYS[keys[-1]], PERIOD)
    return keys


def keyed_poses(keys: str) -> Floats:
    """Return the poses of a drive by its keys, shape (T + 1, 3): the start, and one after each.

    >>> keyed_poses("WA").round(4).tolist()
    [[-0.0865, -0.2117, 0.0026], [-0.0736, -0.2117, 0.0026], [-0.0736, -0.2117, 0.3314]]
    """
    poses = [KEYED_START]
    for key in keys:
        poses.append(moved(poses[-1], KEYS[key], PERIOD))
    return np.array(poses)
