"""Scene: drive the robot with the keys and watch its map grow; replay a recorded drive as a film.

Beside the story. The page (``.js``, ``.css``) draws; Python moves the robot, scans and finds.

In:  a ``World`` to drive in, or a ``Drive`` that was recorded.
Out: ``Scene``, ``Replay``: widgets for a notebook's cell.
"""

from .replay import Replay, replay
from .scene import Scene, drive_scene
from .state import DriveState

__all__ = ["drive_scene", "Scene", "replay", "Replay", "DriveState"]
