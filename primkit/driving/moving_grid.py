"""Moving grid: a grid that gives up what is no longer there.

Each cell remembers when it was hit last and from where, and is evicted after two contradictions.

In:  ``Scans``, in the order in which they were taken.
Out: ``grid.points()``: the centres of the cells that still stand, shape (N, 2), metres, world frame.

>>> from primkit.lidar import scan
>>> from primkit.shapes import Circle
>>> from primkit.world import World
>>> grid, pose = MovingGrid(), (-0.2, 0.0, 0.1)
>>> grid.add(scan(World([Circle((0, 0), 0.05)]), pose))
>>> for _ in range(2):  # the circle is taken away; one contradiction may be a stray beam, two are believed
...     grid.add(scan(World(), pose))
...     print(len(grid))
8
0

A scan contradicts a cell at the distance q, between two beams that are D radians apart and see as far as r, when

1. a beam passes through it:               q < r - BEFORE_A_HIT
2. it lies between beams that both go on:  q (1 + k) < r,  k = D / (2 tan(a / 2) - D)
3. a hit stands in the line of sight in which it was hit last, between BEFORE_A_HIT and BEHIND in front of it

Rule 2 leaves room for a corner that reaches in between the beams. The sharpest, a = 30 degrees, is 2 tan(a / 2) d wide
at d behind its tip, and the beams D (q + d) apart: equal at d = k q, which is 0.13 q for a hundred beams.

A beam without a hit says nothing where an outline may stand nearer than the sensor's least distance: next to near
hits, and where the map has one. And shapes are rigid: when SHARE_EVICTED of a connected component is evicted, the rest
of it that was not hit since goes too.

Not here: probabilities, velocities, tracks.

Sources: Moravec and Elfes (1985), "High resolution maps from wide angle sonar"; Wolf and Sukhatme (2005), "Mobile robot
simultaneous localization and mapping in dynamic environments".
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arguments import Bools, Floats, Ints
from ..grid import Grid, as_cells, as_keys
from ..lidar import Lidar, Scans, as_lidar
from ..measure import CELL
from ..segmentation import components
from ..show import thumbnail
from ..table import count

# All lengths are those for cells of 1 mm, and follow the cell.
# m: what lies this near before a hit may be the same outline, seen with noise or grazing, or through its own cell.
BEFORE_A_HIT = 0.01
SHARPEST = np.radians(30)  # no corner of a shape is sharper
EVICTED_AFTER = 2  # contradictions, since it was seen last, that a cell is given up for
CONNECTED = 0.015  # m: cells that hang together are nearer to their neighbours
BARE = 0.003  # m: where a cell is left this near, it was the noise that one too many was seen, and nothing has moved
LEAST_EVICTED, SHARE_EVICTED = 5, 0.15  # cells, and share of a connected component, whose eviction takes the rest along
SCANS_KEPT = 20  # scans for which an evicted cell may take others along
BEHIND = 0.06  # m: so far behind something new a cell is contradicted; what is farther off may well still be there

CELL_FIELDS = [("key", np.int64), ("seen", np.int64), ("against", np.int64), ("from_x", float), ("from_y", float)]
GONE_FIELDS = [("key", np.int64), ("seen", np.int64), ("until", np.int64)]


class MovingGrid:
    """A set of occupied square cells with a side of ``resolution`` metres, each of which holds until contradicted.

    The limits of the ``lidar``, the paper's by default, say what a beam without a hit means. Raises ValueError if the
    resolution is not a finite number above zero, or the lidar is none that looks all round.

    >>> grid = MovingGrid()
    >>> len(grid), grid.n_scans
    (0, 0)
    """

    def __init__(self, resolution: float = 0.001, lidar: Lidar | None = None) -> None:
        self._frame = Grid(resolution)  # stays empty: where its cells lie, these lie
        self.lidar, self._unit = as_lidar(lidar, around=True), self._frame.resolution / CELL
        self.n_scans = 0  # how many scans were added
        self._cells = np.zeros(0, dtype=CELL_FIELDS)
        self._gone = np.zeros(0, dtype=GONE_FIELDS)

    def add(self, seen: Scans | ArrayLike) -> None:
        """Give up the cells that scans contradict, and occupy those that their hits fall into; scan by scan.

        Raises ValueError if these are no Scans of the grid's lidar, or a hit is not finite or too far out; the grid
        then stays as it was.
        """
        if not isinstance(seen, Scans):
            raise ValueError(f"a MovingGrid must be given Scans, whose beams clear cells, got {type(seen).__name__}")
        if len(seen.angles) != self.lidar.beams:
            beams = f"{self.lidar.beams} beams, got {len(seen.angles)} beams"
            raise ValueError(f"scans must be those of the grid's lidar with {beams}")
        self._frame.to_cells(seen.points())  # refuses what cannot be added, before anything is
        for i in range(len(seen)):
            self._follow(seen[i : i + 1])

    @property
    def resolution(self) -> float:
        """Side of a cell in metres."""
        return self._frame.resolution

    @property
    def cells(self) -> Ints:
        """Indices of the occupied cells, shape (N, 2), sorted."""
        return as_cells(self._cells["key"])

    def points(self) -> Floats:
        """Return the centres of the occupied cells, shape (N, 2), metres, in the order of ``cells``."""
        return self._frame.to_points(self.cells)

    def __len__(self) -> int:
        return len(self._cells)

    def __repr__(self) -> str:
        seen = f"{count(len(self), 'occupied cell')} of {1000 * self.resolution:g} mm"
        return f"MovingGrid: {seen} after {count(self.n_scans, 'scan')}"

    def _repr_html_(self) -> str:
        return thumbnail(repr(self), dots=self.points())

    @property
    def last_seen(self) -> Ints:
        """Number of the scan, from 1, that each cell was hit by last, shape (N,), in the order of ``cells``."""
        return self._cells["seen"].copy()

    def _follow(self, one: Scans) -> None:
        self.n_scans += 1
        if one.inside[0]:
            return  # in a shape nothing is seen
        cells, hit = self._cells, self._hit_by(one)
        cells["against"] += self._contradicted(one)
        merged = np.concatenate([cells[~np.isin(cells["key"], hit["key"])], hit])  # those hit as they are known now
        self._cells = merged[np.argsort(merged["key"])]
        given_up = self._cells["against"] >= EVICTED_AFTER
        if given_up.any():
            gone = np.zeros(int(given_up.sum()), dtype=GONE_FIELDS)
            gone["key"], gone["seen"] = self._cells["key"][given_up], self._cells["seen"][given_up]
            gone["until"] = self.n_scans + SCANS_KEPT
            self._gone = np.concatenate([self._gone[self._gone["until"] >= self.n_scans], gone])
            self._cells = self._cells[~given_up]
            self._cells = self._cells[~self._falling()]

    def give_up(self, which: ArrayLike) -> None:
        """Give up some of ``cells``, shape (N,), such as those that a shape stands around now.

        Raises ValueError if there is not one truth value for each cell; the grid then stays as it was.

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
        self._cells = self._cells[~given_up]

    def _hit_by(self, one: Scans) -> NDArray[np.void]:
        """Return the cells that one scan hits, each once."""
        keys = np.unique(as_keys(self._frame.to_cells(one.points())))
        hit = np.zeros(len(keys), dtype=CELL_FIELDS)
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
        free_to = np.where(
            one.hits[0], one.ranges[0] - BEFORE_A_HIT * self._unit, np.where(silent, 0.0, lidar.range_max)
        )
        across = q * np.abs(np.sin((beam - np.rint(beam)) * step))
        passed = (across <= self.resolution / 2) & (q < free_to[nearest])
        between = q * (1 + _hidden_share(step)) < np.minimum(free_to[low], free_to[high])
        near = np.flatnonzero(q <= lidar.range_max + BEHIND * self._unit)
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
        ahead = (length - along) / self._unit
        between: Bools = ((across <= self.resolution) & (ahead > BEFORE_A_HIT) & (ahead < BEHIND)).any(axis=1)
        return between

    def _falling(self) -> Bools:
        """Tell which cells hang together with many that were given up, and were not seen since, shape (N,)."""
        from scipy.spatial import cKDTree

        left = self.points()
        places = self._frame.to_points(as_cells(self._gone["key"]))
        bare = (
            np.ones(len(places), dtype=bool) if len(left) == 0 else cKDTree(left).query(places)[0] > BARE * self._unit
        )
        self._gone = gone = self._gone[bare]
        if len(gone) < LEAST_EVICTED:
            return np.zeros(len(left), dtype=bool)
        together = np.vstack([places[bare], left])
        n = len(together)
        part = components(n, cKDTree(together).query_pairs(CONNECTED * self._unit, output_type="ndarray").T)
        part_gone, part_left = part[: len(gone)], part[len(gone) :]
        last = np.zeros(n, dtype=np.int64)
        np.maximum.at(last, part_gone, gone["seen"])
        old = self._cells["seen"] <= last[part_left]
        n_gone, n_old = np.bincount(part_gone, minlength=n), np.bincount(part_left[old], minlength=n)
        falls = (n_gone >= LEAST_EVICTED) & (n_gone >= SHARE_EVICTED * (n_gone + n_old))
        self._gone = gone[~falls[part_gone]]  # what fell takes nothing more along
        falling: Bools = falls[part_left] & old
        return falling


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
