"""Keys: what the four keys that drive the robot mean for its wheels.

In:  which of them are held.
Out: the speeds of the left and the right wheel, radians per second.

>>> wheels_for(["forward"])
(6.28, 6.28)
"""

from __future__ import annotations

from collections.abc import Iterable

from ..robot import FASTEST

TURNING_SHARE = 0.6  # of the greatest speed: by how much one wheel is faster than the other when turning
STANDING_WHEELS = (0.0, 0.0)  # rad/s: wheels that stand still
KEY_MOTIONS = {"forward": (1, 0), "back": (-1, 0), "left": (0, 1), "right": (0, -1)}  # onwards, counter-clockwise


def wheels_for(held: Iterable[str]) -> tuple[float, float]:
    """Return the speeds of the left and the right wheel while some keys are held, radians per second.

    Raises ValueError if there is another word among them.

    Parameters
    ----------
    held : iterable of str
        Any of ``"forward"``, ``"back"``, ``"left"`` and ``"right"``; opposite ones cancel each other.

    Examples
    --------
    The robot turns equally fast on the spot and on the way:

    >>> [round(speed, 3) for speed in (*wheels_for(["left"]), *wheels_for(["forward", "left"]))]
    [-1.884, 1.884, 2.512, 6.28]
    """
    words = set(held)
    if not words <= KEY_MOTIONS.keys():
        raise ValueError(f"held must be among {', '.join(KEY_MOTIONS)}, got {sorted(words - KEY_MOTIONS.keys())[0]!r}")
    ahead, turn = (sum(KEY_MOTIONS[word][i] for word in words) for i in (0, 1))
    middle = ahead * (1 - abs(turn) * TURNING_SHARE / 2)  # so that the faster wheel is not too fast
    return FASTEST * (middle - turn * TURNING_SHARE / 2), FASTEST * (middle + turn * TURNING_SHARE / 2)
