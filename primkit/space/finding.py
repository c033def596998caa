"""Finding: the solids in a cloud, each with how sure it is.

In:  a ``Cloud``.
Out: a list of ``FoundSolid``: solid, kind, standard deviations, what is open, and other kinds that it may be.

>>> from primkit.space.lidar3d import scan
>>> from primkit.space.scenes import Scene
>>> from primkit.space.solids import Box, Sphere
>>> scene = Scene([Sphere((1.5, 0, 0.4), 0.4), Box((0, 1.5, 0.3), np.eye(3), (0.5, 0.6, 0.6))])
>>> for found in find_solids(scan(scene, [(0, 0, 0.7), (2, 2, 0.8)], rng=0), rng=0):
...     found.kind, found.certain, sorted(round(size, 2) for size in found.sizes.values())
('box', True, [0.5, 0.6, 0.6])
('sphere', True, [0.4])

1. Take the ground away, and link what stands on it into groups.
2. Explain each group; one that no solid explains is taken apart where it is thin.
3. A group that the solid of a larger one explains belongs to that; two that one solid explains better are one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..arguments import Ints, as_rng, check_type
from .along_beam import ON_IT, Beams
from .ends import FARTHEST_END, grown
from .explanations import SETTLED_STD, FoundSolid, explanation
from .ground import find_ground, groups, taken_apart
from .lidar3d import Cloud
from .scenes import within
from .solids import Plane

THIN = (0.1, 0.07, 0.05)  # m: a group that no solid explains is linked anew, so far apart
MOSTLY, NEARLY_IN = 0.8, 0.05  # share of a group's returns that lie on, or in, another's solid; m


def find_solids(cloud: Cloud, *, rng: int | np.random.Generator | None = None) -> list[FoundSolid]:
    """Return the solids in a cloud, from left to right (by x).

    Raises ValueError if that is no ``Cloud``: the beams that came back from nowhere are needed, too.

    Parameters
    ----------
    cloud : Cloud
    rng : seed or numpy.random.Generator, optional

    Examples
    --------
    >>> find_solids(Cloud([(0, 0, 1)], [0.0], np.full((1, 1, 8), np.inf)))
    []
    """
    check_type(cloud, Cloud, "cloud must be a Cloud, of beams and not of points alone")
    rng = as_rng(rng)
    ground = find_ground(cloud, rng=rng)
    look = Look(cloud, ground.noise_std, ground.plane, rng)
    whole = [found for members in groups(cloud, ground) for found in look.at_parts(members)]
    return sorted(look.joined(whole), key=lambda each: each.solid.center[0])


@dataclass(frozen=True, eq=False)
class Look:
    """How groups of returns are looked at: in a cloud, with the noise of its ranges, metres, and the ground."""

    cloud: Cloud
    noise_std: float
    ground: Plane | None
    rng: np.random.Generator

    def beams(self, number: Ints, members: Ints) -> Beams:
        """Return some beams of the cloud, by number, of which the members are a group's own."""
        own = np.isin(number, members, assume_unique=True)
        return Beams(number, *self.cloud.beams(number), own, self.noise_std)

    def around(self, members: Ints) -> Beams:
        """Return the beams that bear on a group: they reach the ball around it that its solid can fill."""
        points, turn = self.cloud.points(members), self.cloud.turn
        low, high = points.min(axis=0), points.max(axis=0)
        center, reach = (low + high) / 2, float(np.linalg.norm(high - low)) / 2 + FARTHEST_END
        bearing = []
        for pose, origin in enumerate(self.cloud.origins):
            near = np.flatnonzero(within(center, reach, origin, turn))
            far_enough = self.cloud.ranges[pose].ravel()[near] > np.linalg.norm(center - origin) - reach
            bearing.append(pose * len(turn) + near[far_enough])
        return self.beams(np.concatenate(bearing), members)

    def at_parts(self, members: Ints, thin: Sequence[float] = THIN) -> list[FoundSolid]:
        """Return what stands behind a group; or behind its parts, where they explain it better."""
        whole = explanation(self.around(members), self.ground, rng=self.rng)
        if whole is None or not whole.fits:
            for k, apart in enumerate(thin, 1):
                if len(parts := taken_apart(self.cloud, members, apart)) > 1:
                    found = [each for part in parts for each in self.at_parts(part, thin[k:])]
                    if whole is None or sum(each.evidence for each in found) > whole.evidence:
                        return found
                    break
        return [whole] if whole else []

    def joined(self, found: list[FoundSolid]) -> list[FoundSolid]:
        """Return what was found, the largest first, in which parts of one solid are one."""
        kept = list[FoundSolid]()
        for part in sorted(found, key=lambda each: -len(each.members)):
            for k, larger in enumerate(kept):
                if (both := self.as_one(larger, part)) is not None:
                    kept[k] = both
                    break
            else:
                kept.append(part)
        return kept if len(kept) == len(found) else self.joined(kept)  # what has grown may explain more

    def as_one(self, larger: FoundSolid, part: FoundSolid) -> FoundSolid | None:
        """Return two that were found as the one that explains both; None where two explain them better."""
        of_larger = np.mean(np.abs(larger.solid.distance(part.points)) <= ON_IT * self.noise_std) >= MOSTLY
        if not of_larger and not any(_may_hold(one, other) for one, other in ((larger, part), (part, larger))):
            return None
        both = explanation(self.around(np.union1d(part.members, larger.members)), self.ground, rng=self.rng)
        apart = larger.evidence + part.evidence
        better = both is not None and both.fits and both.evidence > apart
        return both if of_larger or better else None


def _may_hold(found: FoundSolid, other: FoundSolid) -> bool:
    """Tell whether a solid may be so large, where its ends are open, that it holds most of another's returns."""
    as_large = grown(found.solid, found.ends, SETTLED_STD)
    return bool(np.mean(as_large.distance(other.points) <= NEARLY_IN) >= MOSTLY)
