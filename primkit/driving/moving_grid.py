"""Changes: a grid that follows things that move.

Beside the story: a plain ``Grid`` never forgets, and a shape that is moved while the robot works leaves a ghost behind.
Here each cell knows when it was seen last and from where, and is given up when later scans contradict it.

In:  ``Scans``, one after the other.
Out: ``grid.points()``: the centres of the cells that still hold, shape (N, 2), metres, world frame.

>>> from primkit.lidar import scan
>>> from primkit.shapes import Circle
>>> from primkit.world import World
>>> grid = MovingGrid()
>>> poses = [(-0.2, 0.0, 0.1), (-0.2, 0.01, 0.2), (-0.2, -0.01, 0.3)]
>>> for pose in poses:
...     grid.add(scan(World([Circle((0, 0), 0.05)]), pose))
>>> len(grid) > 20
True
>>> for pose in poses:
...     grid.add(scan(World(), pose))  # it was taken away
>>> len(grid)
0

What contradicts a cell, at the distance q from the robot, between two beams that are D apart and see as far as r:

1. A beam goes through it, and on for at least another centimetre (``BEFORE_A_HIT``: grazing beams and noise).
2. It lies between two beams that both go on beyond it. Something could still stand there: a corner that reaches in
   between them. Its tip is q away; from there it widens by 2 tan(a / 2), for the sharpest corner a = 30 degrees, and
   the gap by D. Its sides meet the beams where 2 tan(a / 2) d = D (q + d), so that d = k q with
   k = D / (2 tan(a / 2) - D): 13 % for a hundred beams. What is nearer than r / (1 + k) is therefore free.
3. A hit lies in the line of sight in which the cell was seen: something has come in between.

A beam without a hit says nothing where an outline may stand nearer than the sensor's least distance: next to hits that
are near, and where the map itself has one. One contradiction may be a stray beam; two are believed. And shapes are
rigid: when much of what hangs together is given up, the rest of it that has not been seen since goes as well, such as
the far side of a shape that was moved, or the near side that now lies within it.

Sources: Moravec and Elfes (1985), "High resolution maps from wide angle sonar", whose grids beams clear; Wolf and
Sukhatme (2005), "Mobile robot simultaneous localization and mapping in dynamic environments".
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arguments import Bools, Floats, Ints, check_type
from ..grid import HALF, Grid
from ..lidar import Lidar, Scans

BEFORE_A_HIT = 0.01  # m: what lies this near before a hit may be the same outline, seen with 2 mm of noise or grazing
SHARPEST = np.radians(30)  # no corner of a shape is sharper
ENOUGH = 2  # contradictions, since it was seen last, that a cell is given up for
LINKED = 0.015  # m: cells that hang together are nearer to their neighbours
BARE = 0.003  # m: where a cell is left this near, it was the noise that one too many was seen, and nothing has moved
FEW, MUCH = 5, 0.15  # so many cells that were given up, and this share of what hangs together, shake the rest
RECENT = 20  # scans: what was given up earlier shakes nothing any more
BEHIND = 0.06  # m: so far behind something new a cell is contradicted; what is farther off may well still be there


class MovingGrid(Grid):
    """A set of occupied square cells, each of which holds until it is contradicted.

    Parameters
    ----------
    resolution : float
        Side of a cell in metres.
    lidar : Lidar, optional
        The sensor, whose limits say what a beam without a hit means; the paper's by default.

    Raises
    ------
    ValueError
        If the resolution is not a finite number above zero, or the lidar is none.

    Examples
    --------
    >>> grid = MovingGrid()
    >>> len(grid), grid.n_scans
    (0, 0)
    """

    def __init__(self, resolution: float = 0.001, lidar: Lidar | None = None) -> None:
        super().__init__(resolution)
        self.lidar = Lidar() if lidar is None else lidar
        check_type(self.lidar, Lidar, "lidar must be a Lidar, such as Lidar()")
        self.n_scans = 0  # how many scans were added
        self._cells = _no_cells()
        self._gone = np.zeros(0, dtype=GONE)

    def add(self, seen: Scans | ArrayLike) -> None:
        """Give up the cells that scans contradict, and occupy those that their hits fall into; scan by scan.

        Raises
        ------
        ValueError
            If these are no Scans of the grid's lidar, or a hit is not finite or too far out; the grid then stays as
            it was.
        """
        if not isinstance(seen, Scans):
            raise ValueError(f"a MovingGrid must be given Scans, whose beams clear cells, got {type(seen).__name__}")
        if len(seen.angles) != self.lidar.beams:
            beams = f"{self.lidar.beams} beams, got {len(seen.angles)} beams"
            raise ValueError(f"scans must be those of the grid's lidar with {beams}")
        self.to_cells(seen.points())  # refuses what cannot be added, before anything is
        for i in range(len(seen)):
            self._follow(seen[i : i + 1])

    @property
    def last_seen(self) -> Ints:
        """Number of the scan, from 1, that each cell was hit by last, shape (N,), in the order of ``cells``."""
        return self._cells["seen"].copy()

    def _follow(self, one: Scans) -> None:
        self.n_scans += 1
        if one.inside[0]:
            return  # it sees nothing, and knows it
        cells = self._cells
        cells["against"] += self._contradicted(one)
        self._cells = _merged(cells, self._hit_by(one))
        self._keys = self._cells["key"]
        given_up = self._cells["against"] >= ENOUGH
        if given_up.any():
            self._gone = np.concatenate([self._gone[self._gone["until"] >= self.n_scans], self._leaving(given_up)])
            self._keep(~given_up)
            self._keep(~self._shaken())

    def give_up(self, which: ArrayLike) -> None:
        """Give up cells for a reason of one's own, such as a shape that stands around them now.

        Parameters
        ----------
        which : array_like of bool, shape (N,)
            Which of ``cells``.

        Raises
        ------
        ValueError
            If there is not one truth value for each cell; the grid then stays as it was.

        Examples
        --------
        >>> grid = MovingGrid()
        >>> grid.give_up([True])
        Traceback (most recent call last):
            ...
        ValueError: which must hold True or False for each of the 0 cells, got shape (1,)
        """
        given_up = np.asarray(which)
        if given_up.shape != (len(self),) or given_up.dtype != bool:
            rule = f"which must hold True or False for each of the {len(self)} cells"
            raise ValueError(f"{rule}, got shape {given_up.shape}")
        self._keep(~given_up)

    def _keep(self, which: Bools) -> None:
        self._cells = self._cells[which]
        self._keys = self._cells["key"]

    def _hit_by(self, one: Scans) -> NDArray[np.void]:
        """Return the cells that one scan hits, each once."""
        at = self.to_cells(one.points())
        keys = np.unique((at[:, 0] + HALF) * (2 * HALF) + (at[:, 1] + HALF))
        hit = _no_cells(len(keys))
        hit["key"], hit["seen"], hit["from_x"], hit["from_y"] = keys, self.n_scans, *one.poses[0, :2]
        return hit

    def _contradicted(self, one: Scans) -> Bools:
        """Tell which cells one scan contradicts, shape (N,)."""
        lidar, step = self.lidar, self.lidar.angle_increment
        away = self.points() - one.poses[0, :2]
        q, beam = np.hypot(*away.T), np.mod(np.arctan2(away[:, 1], away[:, 0]) - one.poses[0, 2], 2 * np.pi) / step
        low, nearest = (whole.astype(np.int64) % lidar.beams for whole in (np.floor(beam), np.rint(beam)))
        high = (low + 1) % lidar.beams
        silent = _next_to_near_hits(one, lidar)
        silent[low[q <= lidar.range_min]] = silent[high[q <= lidar.range_min]] = True
        free_to = np.where(one.hits[0], one.ranges[0] - BEFORE_A_HIT, np.where(silent, 0.0, lidar.range_max))
        across = q * np.abs(np.sin((beam - np.rint(beam)) * step))
        passed = (across <= self.resolution / 2) & (q < free_to[nearest])
        between = q * (1 + _hidden_share(step)) < np.minimum(free_to[low], free_to[high])
        near = np.flatnonzero(q <= lidar.range_max + BEHIND)
        contradicted: Bools = passed | between
        contradicted[near] |= self._behind_newcomers(near, one.points())
        return contradicted

    def _behind_newcomers(self, which: Ints, hits: Floats) -> Bools:
        """Tell which of some cells were seen through a place where a hit is now, shape (N,)."""
        cells = self._cells[which]
        origin = np.column_stack([cells["from_x"], cells["from_y"]])
        sight = self.points()[which] - origin
        length = np.hypot(*sight.T)[:, None]
        to_hit = hits - origin[:, None]  # (N, H, 2)
        along = (to_hit * sight[:, None]).sum(axis=2) / length
        across = np.abs(to_hit[..., 0] * sight[:, None, 1] - to_hit[..., 1] * sight[:, None, 0]) / length
        ahead = length - along
        between: Bools = ((across <= self.resolution) & (ahead > BEFORE_A_HIT) & (ahead < BEHIND)).any(axis=1)
        return between

    def _leaving(self, given_up: Bools) -> NDArray[np.void]:
        """Return what is remembered of cells that are given up: where they were, and when they were seen last."""
        gone = np.zeros(int(given_up.sum()), dtype=GONE)
        gone["key"], gone["seen"] = (self._cells[name][given_up] for name in ("key", "seen"))
        gone["until"] = self.n_scans + RECENT
        return gone

    def _shaken(self) -> Bools:
        """Tell which cells hang together with many that were given up, and were not seen since, shape (N,)."""
        from scipy.sparse import coo_array
        from scipy.sparse.csgraph import connected_components
        from scipy.spatial import cKDTree

        left = self.points()
        places = self.to_points(_at(self._gone["key"]))
        bare = np.ones(len(places), dtype=bool) if len(left) == 0 else cKDTree(left).query(places)[0] > BARE
        self._gone = gone = self._gone[bare]
        if len(gone) < FEW:
            return np.zeros(len(left), dtype=bool)
        together = np.vstack([places[bare], left])
        pairs = cKDTree(together).query_pairs(LINKED, output_type="ndarray")
        links = coo_array((np.ones(len(pairs)), pairs.T), shape=(len(together), len(together)))
        n, part = connected_components(links, directed=False)
        part_gone, part_left = part[: len(gone)], part[len(gone) :]
        last = np.zeros(n, dtype=np.int64)
        np.maximum.at(last, part_gone, gone["seen"])
        old = self._cells["seen"] <= last[part_left]
        n_gone, n_old = np.bincount(part_gone, minlength=n), np.bincount(part_left[old], minlength=n)
        falls = (n_gone >= FEW) & (n_gone >= MUCH * (n_gone + n_old))
        self._gone = gone[~falls[part_gone]]  # what has fallen shakes nothing more
        shaken: Bools = falls[part_left] & old
        return shaken


CELL = [("key", np.int64), ("seen", np.int64), ("against", np.int64), ("from_x", float), ("from_y", float)]
GONE = [("key", np.int64), ("seen", np.int64), ("until", np.int64)]


def _no_cells(n: int = 0) -> NDArray[np.void]:
    return np.zeros(n, dtype=CELL)


def _at(keys: Ints) -> Ints:
    """Return the indices of cells, shape (N, 2), from their keys."""
    return np.column_stack(np.divmod(keys, 2 * HALF)) - HALF


def _merged(cells: NDArray[np.void], hit: NDArray[np.void]) -> NDArray[np.void]:
    """Return all cells, sorted by their keys; those that were hit as they are known now."""
    together = np.concatenate([cells[~np.isin(cells["key"], hit["key"])], hit])
    return together[np.argsort(together["key"])]


def _hidden_share(step: float) -> float:
    """Return k: between free beams ``step`` radians apart, a corner's tip hides where its sides would not yet show.

    >>> round(_hidden_share(Lidar().angle_increment), 3), _hidden_share(1.0)
    (0.133, inf)
    """
    widens = 2 * np.tan(SHARPEST / 2)
    return float(step / (widens - step)) if widens > step else float("inf")


def _next_to_near_hits(one: Scans, lidar: Lidar) -> Bools:
    """Tell which beams without a hit say nothing, shape (B,): those that follow on a near hit, for a quarter turn.

    An outline nearer than the least distance comes out of it again, to one side or both, on a hit that is near.
    """
    hit = one.hits[0]
    quiet = hit & (one.ranges[0] < 2 * lidar.range_min)
    for _ in range(lidar.beams // 4):
        quiet = quiet | (~hit & (np.roll(quiet, 1) | np.roll(quiet, -1)))
    return quiet & ~hit
