"""Along the beam: how likely a solid makes what the beams returned, and the solid that makes it most likely.

In:  a solid, and ``Beams``: some returned from the group that it is to explain, all others passed, or were stopped.
Out: the logarithm of the likelihood; the solid of maximum likelihood, and the information of its numbers.

A beam would meet the solid at range t. What it tells, with a measured range r and noise s along the beam:

    its return is the group's    p = (1 - e) N(r - t; s) + e U     e: share of returns from nowhere, spread over 1 / U
    it went on, r > t            p = e U / N(0; s)                 a miss: nothing is there, and yet the solid would be
    it was stopped, r <= t       p = 1                             what is behind is hidden

Ranges change smoothly with the numbers; there, Gauss and Newton's method finds the maximum. Whether a beam hits or
misses changes in steps; that is what ``ends`` is for.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arguments import Bools, Floats, Ints
from .solids import Solid, hit

NOWHERE_SHARE = 0.05  # of a group's returns
OF_NOWHERE = NOWHERE_SHARE * 0.2  # per metre: they are spread over 5 m
ON_IT = 4.0  # standard deviations: a return that is so near to where the solid is met says nothing against it
STEEPEST = 50.0  # m of range per m across: what grazes more tells nothing that is linear
ROUNDS, DAMPINGS = 25, 6  # of Gauss and Newton's, and shorter steps in each
SETTLED_GAIN = 1e-3  # in log likelihood: less ends them
SOFT = 100.0  # 1 / m^2: what no beam tells is held by this much, so that no step is without end
LARGEST_SOLID = 10.0  # m: a larger solid is none of these

Told = tuple[Floats, Floats]  # of a step q: q . v - q . M q / 2 is added to the log likelihood; M, (n, n), and v, (n,)


@dataclass(frozen=True, eq=False)
class Beams:
    """Beams that bear on a group.

    Parameters
    ----------
    number : array of int, shape (N,), in the cloud's ranges, laid flat
    origins, directions : arrays, shape (N, 3): where they start, metres, and unit vectors
    ranges : array, shape (N,): metres, inf where nothing came back
    own : array of bool, shape (N,): whether the return is one of the group's
    noise_std : float, of the ranges, metres
    """

    number: Ints
    origins: Floats
    directions: Floats
    ranges: Floats
    own: Bools
    noise_std: float

    def __getitem__(self, which: Bools | Ints) -> Beams:
        o, d, r = self.origins[which], self.directions[which], self.ranges[which]
        return Beams(self.number[which], o, d, r, self.own[which], self.noise_std)

    def points(self) -> Floats:
        """Return where the beams came back from, shape (N, 3), metres."""
        return self.origins + self.ranges[:, None] * self.directions


def likelihood(solid: Solid, beams: Beams) -> float:
    """Return the logarithm of how likely a solid makes what all beams returned, up to a constant."""
    s, own, t = beams.noise_std, beams.own, hit(solid, beams.origins, beams.directions)
    through = np.count_nonzero(~own & (beams.ranges - ON_IT * s > t))
    return float(returned(beams.ranges[own] - t[own], s).sum() + missed(s) * through)


def returned(off: Floats, noise_std: float) -> Floats:
    """Return the logarithm of how likely a return of the group is off by so much, metres."""
    return np.asarray(np.log(_of_it(off, noise_std) + OF_NOWHERE))


def missed(noise_std: float) -> float:
    """Return the logarithm of how likely a beam passes through a solid that is there."""
    return float(np.log(OF_NOWHERE * np.sqrt(2 * np.pi) * noise_std))


def belongs(off: Floats, noise_std: float) -> Floats:
    """Return how likely what is off by so much, metres, is not from nowhere."""
    near = _of_it(off, noise_std)
    return near / (near + OF_NOWHERE)


def _of_it(off: Floats, noise_std: float) -> Floats:
    return (1 - NOWHERE_SHARE) / (np.sqrt(2 * np.pi) * noise_std) * np.exp(-0.5 * (off / noise_std) ** 2)


def linearised(solid: Solid, beams: Beams) -> tuple[Floats, Floats, Floats]:
    """Return for beams of the group their weights, the ranges' excess over t, (N,), and its slopes, (N, numbers)."""
    t = hit(solid, beams.origins, beams.directions)
    met = np.flatnonzero(t < np.inf)
    o, d, t = beams.origins[met], beams.directions[met], t[met]
    normals, speeds = solid.speeds(o + t[:, None] * d)
    slant = np.einsum("ij,ij->i", normals, d)
    gap = beams.ranges[met] - t
    weights = belongs(gap, beams.noise_std) * (np.abs(slant) > 1 / STEEPEST)
    return weights, gap, speeds / np.where(slant == 0, np.inf, slant)[:, None]


def refine(solid: Solid, beams: Beams, told: Told | None = None) -> Solid:
    """Return the solid of maximum likelihood near this one; with what else is told of its numbers, from here on."""
    own, gone = beams[beams.own], np.zeros(solid.numbers)  # steps add up: the frame hardly turns
    matrix, vector = told or (np.zeros((solid.numbers, solid.numbers)), gone)

    def merit(tried: Solid, gone: Floats) -> float:
        return likelihood(tried, own) + float((vector - 0.5 * matrix @ gone) @ gone)

    damping, now = 0.0, merit(solid, gone)
    for _ in range(ROUNDS):
        w, e, slopes = linearised(solid, own)
        by_ranges = slopes.T * w / beams.noise_std**2
        gradient = by_ranges @ e + vector - matrix @ gone
        curvature = by_ranges @ slopes + matrix
        for _ in range(DAMPINGS):
            held = curvature + np.diag(damping * np.diag(curvature) + SOFT)
            step = np.asarray(np.linalg.solve(held, gradient), dtype=float)
            tried = stepped(solid, step)
            after = merit(tried, gone + step) if tried is not None else -np.inf
            if tried is not None and after >= now:
                break
            damping = max(10 * damping, 1e-2)
        else:
            return solid
        solid, gone, damping, gain, now = tried, gone + step, damping / 10, after - now, after
        if gain < SETTLED_GAIN:
            break
    return solid


def information(solid: Solid, beams: Beams) -> Floats:
    """Return what the group's ranges tell of the solid's numbers, shape (numbers, numbers)."""
    w, _, slopes = linearised(solid, beams[beams.own])
    return (slopes.T * w) @ slopes / beams.noise_std**2


def stepped(solid: Solid, step: Floats) -> Solid | None:
    """Return the solid after a step; None when nothing of that size is left."""
    after = solid.moved(step)
    return after if after.half.min() > 0 and after.half.max() < LARGEST_SOLID else None
