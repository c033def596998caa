"""Explanations: the solids that may stand behind the returns of a group, the likeliest first.

In:  ``Beams`` that bear on a group, and the ground.
Out: ``Explanation``s: a solid, its evidence, what each of its ends can be, and how much of the group it explains.

1. Start with a solid of each kind, and drop the kinds whose points lie far off the surface of the best.
2. Refine along the beam; then sum up each end over hits and misses, and refine again with the ends held by that: twice.
3. Rank by evidence: ln L - (numbers / 2) ln N (Schwarz, 1978, "Estimating the dimension of a model").
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arguments import Floats
from .along_beam import ON_IT, Beams, Pulls, information, likelihood, refine
from .ends import UNLIKELY, End, end_of, grown, growths
from .solids import Plane, Solid, hit
from .starts import ENOUGH, REACHES, misfit, starts

FAR_BEHIND = 100.0  # in log likelihood of the starts: what is farther behind the best is not looked at again
LOOKS_AT_ENDS = 2
PERFECT, MOST_MISSED = 0.9, 0.03  # shares of a group's returns: explained at least, and passed through at most
SUREST = 1e-5  # m: no end is known better
PRIOR_PULL = 1e-6  # 1 / m^2: keeps what nothing tells from being infinite


@dataclass(frozen=True, eq=False)
class Explanation:
    """A solid that may stand behind a group: its evidence, the covariance of its numbers, and its ends by number.

    ``explained`` is the share of the group's returns that lie on it, ``missed`` how many beams went through it, as a
    share of the group's returns.
    """

    solid: Solid
    evidence: float
    covariance: Floats
    ends: dict[int, End]
    explained: float
    missed: float

    @property
    def fits(self) -> bool:
        """Whether it explains the group, and nothing speaks against it."""
        return self.explained >= PERFECT and self.missed <= MOST_MISSED


def explanations(beams: Beams, ground: Plane | None, *, rng: np.random.Generator) -> list[Explanation]:
    """Return the explanations of a group, the likeliest first; empty when no solid can be fitted at all."""
    points = beams[beams.own].points()
    points = points[:: -(-len(points) // ENOUGH)]
    begun = starts(points, beams.noise_std, rng=rng)
    far = [len(points) * misfit(solid, points, REACHES[1]) / (2 * beams.noise_std**2) for solid in begun]
    order = np.argsort(far, kind="stable").tolist()
    found = list[Explanation]()
    for k in order:
        if far[k] <= far[order[0]] + FAR_BEHIND or not any(each.fits for each in found):
            found.append(explained(begun[k], beams, ground))
    return sorted(found, key=lambda each: -each.evidence)


def explained(solid: Solid, beams: Beams, ground: Plane | None) -> Explanation:
    """Return the explanation that a start leads to."""
    solid = refine(solid, beams)
    beams = beams[beams.own | (hit(grown(solid), beams.origins, beams.directions) < np.inf)]  # others tell nothing
    ends = dict[int, End]()
    told = np.zeros((solid.numbers, solid.numbers))
    for _ in range(LOOKS_AT_ENDS):
        for k, step in growths(solid).items():
            ends[k] = end_of(solid, k, beams, ground)
            solid = solid.moved(ends[k].growth * step)
        pulls = told_by_ends(ends, np.diag(information(solid, beams)))
        solid, told = refine(solid, beams, pulls), pulls.matrix() if pulls else told
    known = information(solid, beams) + told + PRIOR_PULL * np.eye(solid.numbers)
    covariance = np.asarray(np.linalg.inv(known), dtype=float)
    t = hit(solid, beams.origins, beams.directions)
    n, near = int(beams.own.sum()), ON_IT * beams.noise_std
    with np.errstate(invalid="ignore"):
        on_it = np.count_nonzero(np.abs(beams.ranges - t)[beams.own] <= near)
    missed = np.count_nonzero(~beams.own & (beams.ranges - near > t))
    evidence = likelihood(solid, beams) - solid.numbers / 2 * np.log(n)
    return Explanation(solid, evidence, covariance, ends, on_it / n, missed / n)


def told_by_ends(ends: dict[int, End], by_ranges: Floats) -> Pulls | None:
    """Return where hits and misses want each end, from where it is now; None without ends.

    The sum over an end, of mean m and variance v, knows the ranges and the hits and misses. The ranges, with
    information i, want the end where it was, m away from here; so hits and misses add p = 1 / v - i, and want
    m / (v p) - m. Where m is farther than the ranges could err, the end has left the returns that it was fitted to, and
    the ranges want nothing there.
    """
    rows = list[tuple[Floats, float, float]]()
    for k, end in ends.items():
        precision = 1 / max(end.std, SUREST) ** 2
        more = precision - by_ranges[k]
        if more > 0.05 * by_ranges[k]:
            believed = by_ranges[k] * end.growth**2 < UNLIKELY
            rows.append((end.slope, end.growth * (precision / more - 1) if believed else 0.0, more))
    if not rows:
        return None
    slopes, at, more_of_all = zip(*rows, strict=True)
    return Pulls(np.array(slopes), np.array(at), np.array(more_of_all))
