"""Explanations: the solids that may stand behind the returns of a group, the likeliest first.

In:  ``Beams`` that bear on a group, and the ground.
Out: ``FoundSolid``: the solid, its kind, standard deviations, what is open, and other kinds that it may be.

1. Start with a solid of each kind, and drop the kinds whose points lie far off the surface of the best.
2. Refine along the beam; then sum up each end over hits and misses, and refine again with the ends held by that: twice.
3. Rank by evidence: ln L - (numbers / 2) ln N (Schwarz, 1978, "Estimating the dimension of a model").
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ..arguments import Floats, Ints
from .along_beam import LARGEST_SOLID, ON_IT, Beams, Told, information, likelihood, refine
from .ends import UNLIKELY, End, end_of, grown, growths
from .solids import Plane, Solid, SolidKind, hit
from .starts import ENOUGH, REACHES, misfit, starts

CERTAIN = 10.0  # evidence ahead of the next kind: very strong (Kass and Raftery, 1995)
SETTLED_STD = 0.002  # m: a size that is known worse is open
SIGMAS_TOLD = 2.5  # standard deviations that a size's interval goes to each side, at least
LEAST_ON_FACE = 4  # returns without which a face was not seen
FAR_BEHIND = 100.0  # in log likelihood of the starts: what is farther behind the best is not looked at again
LOOKS_AT_ENDS = 2
PERFECT, MOST_MISSED = 0.9, 0.03  # shares of a group's returns: explained at least, and passed through at most
SUREST = 1e-5  # m: no end is known better


@dataclass(frozen=True, eq=False)
class FoundSolid:
    """A solid that explains a group of returns.

    Parameters
    ----------
    solid : Sphere, Cylinder or Box
    members : array of int, shape (N,): the numbers of the group's beams in the cloud's ranges, laid flat
    points : array, shape (N, 3): where they came back from, metres
    evidence : float: how likely it makes what the beams returned, as a logarithm, less what its numbers cost
    covariance : array, shape (numbers, numbers), of its numbers
    ends : dict of End: its ends, by number
    explained, missed : float
        Share of the returns that lie on it; how many beams went through it, as a share of the returns.
    rivals : tuple of FoundSolid: solids of other kinds, the likeliest first
    """

    solid: Solid
    members: Ints
    points: Floats
    evidence: float
    covariance: Floats
    ends: dict[int, End]
    explained: float
    missed: float
    rivals: tuple[FoundSolid, ...] = ()

    @property
    def kind(self) -> SolidKind:
        """``"sphere"``, ``"cylinder"`` or ``"box"``."""
        return self.solid.kind

    @property
    def fits(self) -> bool:
        """Whether it explains the group, and nothing speaks against it."""
        return self.explained >= PERFECT and self.missed <= MOST_MISSED

    @cached_property
    def others(self) -> tuple[str, ...]:
        """Other kinds that it may be; ``"something else"`` when it does not fit."""
        others: list[str] = [each.kind for each in self.rivals if each.evidence > self.evidence - CERTAIN]
        if self.kind == "box" and "cylinder" not in others:  # a single face may as well be a cylinder's end
            faces = np.abs(self.solid.speeds(self.points)[1][:, self.solid.first_end :]).sum(axis=0)
            others += ["cylinder"] * int(np.count_nonzero(faces >= LEAST_ON_FACE) < 2)
        return (*others, *["something else"] * (not self.fits))

    @property
    def certain(self) -> bool:
        """Whether its kind is beyond doubt, and it explains its returns."""
        return not self.others

    @property
    def sizes(self) -> dict[str, float]:
        """The radius; radius and height; or length, width and height along the rows of ``frame``; metres."""
        return self.solid.sizes

    @cached_property
    def std(self) -> dict[str, float]:
        """The standard deviation of each size, metres."""
        return {name: float(np.sqrt(d @ self.covariance @ d)) for name, d in self.solid.slopes.items()}

    @cached_property
    def turn_std(self) -> float:
        """The standard deviation of its axis, or of its turn, all ways together, radians; of a ball 0."""
        return float(np.sqrt(np.diag(self.covariance)[: self.solid.turns].sum()))

    @cached_property
    def between(self) -> dict[str, tuple[float, float]]:
        """The interval that holds each size, metres; up to inf where no beam bounds it."""
        told = {}
        for name, slope in self.solid.slopes.items():
            ends = [self.ends[k] for k in np.flatnonzero(slope).tolist() if k in self.ends]
            low = sum(end.growth - end.between[0] for end in ends)
            high = sum(np.inf if end.unbounded else end.between[1] - end.growth for end in ends)
            size, least = self.sizes[name], SIGMAS_TOLD * self.std[name]
            told[name] = max(0.0, size - max(low, least)), size + max(high, least)
        return told

    @property
    def open(self) -> tuple[str, ...]:
        """The sizes that the scan does not settle: they are known to lie ``between`` two values, no better."""
        rough = {name for name, std in self.std.items() if std > SETTLED_STD}
        wide = {name for name, (low, high) in self.between.items() if high - low > 2 * SIGMAS_TOLD * SETTLED_STD}
        return tuple(name for name in self.sizes if name in rough | wide)

    def __repr__(self) -> str:
        sizes = ", ".join(f"{name} {'about ' * (name in self.open)}{size:.3f}" for name, size in self.sizes.items())
        x, y, z = self.solid.center
        doubt = f"; or {' or '.join(self.others)}" if self.others else ""
        return f"{self.kind} at ({x:.3f}, {y:.3f}, {z:.3f}), {sizes} m{doubt}"


def explanation(beams: Beams, ground: Plane | None, *, rng: np.random.Generator) -> FoundSolid | None:
    """Return the likeliest explanation of a group, and its rivals; None when no solid can be fitted at all."""
    points = beams[beams.own].points()
    points = points[:: -(-len(points) // ENOUGH)]
    begun = starts(points, beams.noise_std, rng=rng)
    far = [len(points) * misfit(solid, points, REACHES[1]) / (2 * beams.noise_std**2) for solid in begun]
    found = list[FoundSolid]()
    for k in np.argsort(far, kind="stable").tolist():
        if far[k] <= min(far) + FAR_BEHIND or not any(each.fits for each in found):
            found.append(explained(begun[k], beams, ground))
    found.sort(key=lambda each: -each.evidence)
    return replace(found[0], rivals=tuple(found[1:])) if found else None


def explained(solid: Solid, beams: Beams, ground: Plane | None) -> FoundSolid:
    """Return the explanation that a start leads to."""
    solid = refine(solid, beams)
    beams = beams[beams.own | (hit(grown(solid), beams.origins, beams.directions) < np.inf)]  # others tell nothing
    ends = dict[int, End]()
    for _ in range(LOOKS_AT_ENDS):
        for k, step in growths(solid).items():
            ends[k] = end_of(solid, k, beams, ground)
            solid = solid.moved(ends[k].growth * step)
        told = told_by_ends(ends, np.diag(information(solid, beams)))
        solid = refine(solid, beams, told)
    at_most = np.eye(solid.numbers) / LARGEST_SOLID**2  # what nothing tells is known to be no larger
    known = information(solid, beams) + told[0] + at_most
    covariance = np.asarray(np.linalg.inv(known), dtype=float)
    own, near = beams[beams.own], ON_IT * beams.noise_std
    t, n = hit(solid, beams.origins, beams.directions), len(own.number)
    on_it = np.count_nonzero(np.abs(own.ranges - t[beams.own]) <= near)
    missed = np.count_nonzero(~beams.own & (beams.ranges - near > t))
    evidence = likelihood(solid, beams) - solid.numbers / 2 * np.log(n)
    return FoundSolid(solid, own.number, own.points(), evidence, covariance, ends, on_it / n, missed / n)


def told_by_ends(ends: dict[int, End], by_ranges: Floats) -> Told:
    """Return what hits and misses tell of the numbers beyond the ranges, whose information of each is ``by_ranges``.

    The sum over an end, of mean m and variance v, knows the ranges and the hits and misses. The ranges, with
    information i, want the end where it was, m away from here; so hits and misses add p = 1 / v - i, and want
    m / (v p) - m. Where m is farther than the ranges could err, the end has left the returns that it was fitted to, and
    the ranges want nothing there. Where ranges tell more than half, hits and misses count as nothing: of a face that is
    seen, they are those at its edges, where range and side of the edge go with the same noise.
    """
    matrix, vector = np.zeros((len(by_ranges), len(by_ranges))), np.zeros(len(by_ranges))
    for k, end in ends.items():
        precision = 1 / max(end.std, SUREST) ** 2
        more = precision - by_ranges[k]
        if more > by_ranges[k]:
            believed = by_ranges[k] * end.growth**2 < UNLIKELY
            at = end.growth * (precision / more - 1) if believed else 0.0
            matrix += more * np.outer(end.slope, end.slope)
            vector += more * (at - end.below) * end.slope
    return matrix, vector
