"""Routes: how the wheels were turned on a drive, without what was seen; small, and enough to drive it again.

In:  a pose to start from, and the speeds of the wheels, one pair for each period.
Out: a ``Route``, to and from JSON; on a board, the poses of the drive.

>>> from primkit.world import World
>>> Route((0, 0, 0), [(6, 6), (6, 6)]).poses(World()).round(4).tolist()
[[0.0, 0.0, 0.0], [0.0123, 0.0, 0.0], [0.0246, 0.0, 0.0]]
"""

from __future__ import annotations

import json
from dataclasses import dataclass

import numpy as np

from ..arguments import Floats, as_points, as_poses, as_positive, check_type, limit, short
from ..robot import PERIOD, check_way, drive, not_too_fast
from ..world import World
from .files import StrPath, as_path, bounded_read, naming, write_atomically
from .values import check_format, numbers_in, parsed

ROUTE_ENDINGS = (".json",)
ROUTE_LIMIT = 2 * 2**20  # bytes: hours of driving
ROUTE_FORMAT, ROUTE_VERSION = "primkit route", 1
ON_A_LINE = 8  # pairs of speeds


@dataclass(frozen=True, eq=False)
class Route:
    """How the wheels were turned on a drive: ``start``, ``wheels`` and ``period`` as for ``robot.drive``.

    >>> Route((0, 0, 0), [(7, 0)])
    Traceback (most recent call last):
        ...
    ValueError: wheels must turn at 6.28 rad/s at most, got 7
    """

    start: Floats
    wheels: Floats
    period: float = PERIOD

    def __post_init__(self) -> None:
        start, wheels = as_poses(self.start), as_points(self.wheels, "wheels")
        period = as_positive(self.period, "period")
        if len(start) != 1:
            raise ValueError(f"start must be three finite numbers (x, y, heading), got {short(self.start)}")
        not_too_fast(wheels)
        check_way(wheels, period)
        for name, value in (("start", start[0]), ("wheels", wheels), ("period", period)):
            object.__setattr__(self, name, value)

    def poses(self, world: World) -> Floats:
        """Return where the route leads on a board, shape (T + 1, 3): the start, and one pose after each period."""
        return drive(world, self.wheels, self.start, period=self.period)

    def __len__(self) -> int:
        return len(self.wheels)


def save_route(route: Route, path: StrPath) -> None:
    """Write a route as JSON, to a file ending in ``.json``; refused as by ``save_drive``."""
    path = as_path(path, ROUTE_ENDINGS, "a route")
    with naming(path.name):
        check_type(route, Route, "must be a Route")
        pairs = [json.dumps(pair) for pair in route.wheels.tolist()]
        lines = [", ".join(pairs[i : i + ON_A_LINE]) for i in range(0, len(pairs), ON_A_LINE)]
        head = json.dumps(
            {"format": ROUTE_FORMAT, "version": ROUTE_VERSION, "period": route.period, "start": route.start.tolist()}
        )
        data = f'{head[:-1]},\n"wheels": [\n' + ",\n".join(lines) + "\n]}\n"
        limit(len(data), ROUTE_LIMIT, "must be at most {} bytes")
    write_atomically(path, data)


def load_route(path: StrPath) -> Route:
    """Read a route from a file ending in ``.json``.

    Raises ValueError if the file is no route, or one of another version; OSError if there is no such file
    (``FileNotFoundError``), or it cannot be read.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     save_route(Route((0, 0, 0), [(1.5, 2)]), f"{folder}/route.json")
    ...     load_route(f"{folder}/route.json").wheels.tolist()
    [[1.5, 2.0]]
    """
    path = as_path(path, ROUTE_ENDINGS, "a route")
    data = bounded_read(path, ROUTE_LIMIT)
    with naming(path.name):
        told = parsed(data)
        check_format(told, ROUTE_FORMAT, ROUTE_VERSION, "with", told)
        check_type(told.get("wheels"), list, "wheels must be a list of pairs")
        wheels = [numbers_in({"each of the wheels": pair}, "each of the wheels", 2) for pair in told["wheels"]]
        return Route(
            np.array(numbers_in(told, "start", 3)), np.array(wheels), as_positive(told.get("period"), "period")
        )
