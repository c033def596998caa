"""Ways: through what the robot has seen to be free, from where it stands to anywhere else, and the wheels for it.

In:  a ``SeenMap``, a place.
Out: ``Ways``: which squares the body fits on, how far each is, the corners of the shortest way; and the wheel speeds
     along them, shape (T, 2), rad/s.

>>> wheels = wheels_along(np.zeros(3), np.array([(0.0, 0.1)]))  # a quarter turn to the left, then ten centimetres
>>> wheels.round(2).tolist()[0], wheels.round(2).tolist()[-1], len(wheels)
([-4.98, 4.98], [6.1, 6.1], 12)

Source: Dijkstra (1959), "A note on two problems in connexion with graphs".
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..arguments import Bools, Floats
from ..robot import AXLE, BODY, CLEAR, FASTEST, PERIOD, WHEEL
from .seen_map import SQUARE, SeenMap

Window = tuple[slice, slice]

# m from the body's middle to the centre of every square that is not known to be free; what such a square holds is at
# most half a diagonal, 7 mm, nearer.
LEAST_ROOM = BODY + 0.009
RIM = 10  # squares around the board that nothing stands on
LEAVING_REACH = 0.06  # m: so far around, a robot in a narrower place may leave it where it gets no narrower
STRIDES = ((1, 0), (0, 1), (1, 1), (1, -1))  # to half of the eight neighbours; the others are the same backwards
DRIVE_SPEED = FASTEST * WHEEL  # m/s, straight on
TURN_SPEED = 2 * DRIVE_SPEED / AXLE  # rad/s, on the spot


@dataclass(frozen=True)
class Ways:
    """The shortest ways from one place to all squares of a map; arrays of shape (N, N)."""

    board: SeenMap
    room: Floats  # m from each square's centre to the nearest that is not known to be free
    fits: Bools  # where the robot can stand
    length: Floats  # m of the way there; infinite where none leads
    before: NDArray[np.int64]  # number of the square before each on its way; negative where there is none

    def to(self, square: tuple[int, int]) -> Floats:
        """Return the corners of the shortest way to a square, shape (K, 2), metres; the start is left out."""
        squares = trace(self.before.ravel(), int(np.ravel_multi_index(square, self.fits.shape)))
        return tighten(self.board.centers.reshape(-1, 2)[squares], self._is_free)

    def _is_free(self, a: Floats, b: Floats) -> bool:
        steps = np.linspace(0, 1, 2 + int(4 * np.hypot(*(b - a)) / SQUARE))[:, None]
        return bool(self.fits[self.board.index(a + steps * (b - a))].all())


def ways_from(board: SeenMap, place: Floats) -> Ways:
    """Return the shortest ways from a place, shape (2,), metres, over all squares that the body fits on."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import dijkstra

    here = tuple(int(i) for i in board.index(place))
    room = room_on(board)
    fits = standing_room(board, room, here)
    numbers = np.arange(fits.size).reshape(fits.shape)
    ends = []
    for i, j in STRIDES:
        first, second = _neighbours(fits.shape, i, j)
        both = fits[first] & fits[second]
        from_, to = numbers[first][both], numbers[second][both]
        ends.append((from_, to, np.full(len(from_), SQUARE * np.hypot(i, j))))
    rows, columns, lengths = (np.concatenate(parts) for parts in zip(*ends, strict=True))
    rows, columns = rows.astype(np.int32), columns.astype(np.int32)  # all that scipy 1.13's ways take
    graph = coo_array((lengths, (rows, columns)), shape=(fits.size, fits.size)).tocsr()
    start = int(numbers[here])
    length, before = dijkstra(graph, directed=False, indices=start, return_predecessors=True)
    return Ways(board, room, fits, length.reshape(fits.shape), before.reshape(fits.shape))


def trace(before: NDArray[np.int64], last: int) -> list[int]:
    """Return the nodes from the start to the last one, from each node's predecessor; negative where there is none."""
    nodes = [last]
    while before[nodes[-1]] >= 0:
        nodes.append(int(before[nodes[-1]]))
    return nodes[::-1]


def tighten(way: Floats, is_free: Callable[[Floats, Floats], bool]) -> Floats:
    """Return a way without the corners that it can do without: from each, on to the last one in sight, shape (K, 2).

    The start is left out.
    """
    kept, i = [], 0
    while i < len(way) - 1:
        i = next(j for j in range(len(way) - 1, i, -1) if j == i + 1 or is_free(way[i], way[j]))
        kept.append(way[i])
    return np.array(kept).reshape(-1, 2)


def room_on(board: SeenMap) -> Floats:
    """Return how far each square's centre is from that of the nearest one not known to be free, shape (N, N), metres.

    What lies beyond the board's edge is left out, up to the rim from which it counts.
    """
    from scipy.ndimage import distance_transform_edt

    around = np.pad(np.pad(board.free, RIM, constant_values=True), 1)
    room: Floats = SQUARE * distance_transform_edt(around)[RIM + 1 : -RIM - 1, RIM + 1 : -RIM - 1]
    return room


def standing_room(board: SeenMap, room: Floats, here: tuple[int, ...]) -> Bools:
    """Tell which squares the body fits on: free all around, and within the board.

    The square that the robot stands on is one in any case, and so are those nearby that are no narrower.
    """
    edge = board.size / 2 - np.abs(board.centers).max(axis=-1)
    near = np.hypot(*np.moveaxis(board.centers - board.centers[here], -1, 0)) <= LEAVING_REACH
    fits: Bools = (room >= LEAST_ROOM) | (near & (room >= room[here]) & board.free)
    fits &= edge >= BODY + CLEAR
    fits[here] = True
    return fits


def _neighbours(shape: tuple[int, ...], i: int, j: int) -> tuple[Window, Window]:
    """Return the windows of a map of this shape that hold each square, and the one i rows and j columns on."""
    rows, columns = shape
    first = slice(0, rows - i), slice(max(0, -j), columns - max(0, j))
    return first, (slice(i, rows), slice(max(0, j), columns + min(0, j)))


def wheels_along(pose: Floats, way: Floats) -> Floats:
    """Return the wheel speeds that lead from a pose along a way, a pair for each period, shape (T, 2), rad/s.

    ``way``: its corners and its end, shape (K, 2), metres. Before each stretch the robot turns on the spot; each turn
    and each stretch takes whole periods.
    """
    (x, y, heading), wheels = pose.tolist(), [np.empty((0, 2))]
    for to_x, to_y in way.tolist():
        bearing = np.arctan2(to_y - y, to_x - x)
        turn = np.mod(bearing - heading + np.pi, 2 * np.pi) - np.pi
        wheels += [turning(turn), forward(np.hypot(to_x - x, to_y - y))]
        x, y, heading = to_x, to_y, heading + turn
    return np.vstack(wheels)


def turning(turn: float) -> Floats:
    """Return the wheel speeds of a turn on the spot by so many radians, shape (T, 2), rad/s."""
    n = int(np.ceil(abs(turn) / (TURN_SPEED * PERIOD) - 1e-9))
    return np.tile((-1.0, 1.0), (n, 1)) * turn * AXLE / (2 * WHEEL * PERIOD * max(1, n))


def forward(way: float) -> Floats:
    """Return the wheel speeds that lead so many metres straight on, shape (T, 2), rad/s."""
    n = int(np.ceil(way / (DRIVE_SPEED * PERIOD) - 1e-9))
    return np.full((n, 2), min(FASTEST, way / (WHEEL * PERIOD * max(1, n))))
