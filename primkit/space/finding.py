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
from functools import cached_property

import numpy as np

from ..arguments import Floats, Ints, as_rng, check_type
from .along_beam import ON_IT, Beams
from .ends import FARTHEST_END, grown
from .explanations import Explanation, explanations
from .ground import LEAST_RETURNS, find_ground, groups, linked
from .lidar3d import Cloud
from .scenes import within
from .solids import Plane, Solid, SolidKind, hit

CERTAIN = 10.0  # evidence ahead of the next kind: very strong (Kass and Raftery, 1995)
THIN = (0.1, 0.07, 0.05)  # m: a group that no solid explains is linked anew, so far apart
NEAR_GROUPS = 0.5  # m: groups whose returns come nearer may be one solid's
MOSTLY, NEARLY_IN = 0.8, 0.05  # share of a group's returns that lie on, or in, another's solid; m
LEAST_ON_FACE = 4  # returns without which a face was not seen
SETTLED_STD = 0.002  # m: a size that is known worse is open
SIGMAS_TOLD = 2.5  # standard deviations that a size's interval goes to each side, at least


@dataclass(frozen=True, eq=False)
class FoundSolid:
    """A solid that was found.

    Parameters
    ----------
    solid : Sphere, Cylinder or Box
    others : tuple of str
        Other kinds that it may be; ``"something else"`` when it does not fit.
    points : array, shape (N, 3): the returns that it was found from, metres
    explanation : Explanation
    """

    solid: Solid
    others: tuple[str, ...]
    points: Floats
    explanation: Explanation

    @property
    def kind(self) -> SolidKind:
        """``"sphere"``, ``"cylinder"`` or ``"box"``."""
        return self.solid.kind

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
        return {name: float(np.sqrt(d @ self.explanation.covariance @ d)) for name, d in self.solid.slopes.items()}

    @cached_property
    def turn_std(self) -> float:
        """The standard deviation of its axis, or of its turn, all ways together, radians; of a ball 0."""
        return float(np.sqrt(np.diag(self.explanation.covariance)[: self.solid.turns].sum()))

    @cached_property
    def between(self) -> dict[str, tuple[float, float]]:
        """The interval that holds each size, metres; up to inf where no beam bounds it."""
        told = {}
        for name, slope in self.solid.slopes.items():
            ends = [self.explanation.ends[k] for k in np.flatnonzero(slope).tolist() if k in self.explanation.ends]
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
    sight = Sight(cloud, cloud.directions().reshape(-1, 3), ground.noise_std, ground.plane)
    whole = [group for members in groups(cloud, ground) for group in _taken_apart(sight, members, rng)]
    found = [_told(sight, group) for group in _joined(sight, whole, rng)]
    return sorted(found, key=lambda each: each.solid.center[0])


@dataclass(frozen=True, eq=False)
class Sight:
    """A cloud with its beams' directions, (L A, 3), the noise of its ranges, metres, and the ground."""

    cloud: Cloud
    directions: Floats
    noise_std: float
    ground: Plane | None

    def beams(self, number: Ints, members: Ints) -> Beams:
        """Return some beams of the cloud, by number, of which the members are a group's own."""
        pose, beam = np.divmod(number, len(self.directions))
        ranges, own = self.cloud.ranges.ravel(), np.zeros(self.cloud.ranges.size, dtype=bool)
        own[members] = True
        return Beams(self.cloud.origins[pose], self.directions[beam], ranges[number], own[number], self.noise_std)

    def around(self, members: Ints) -> Beams:
        """Return the beams that bear on a group: they reach the ball around it that its solid can fill."""
        points = self.points(members)
        low, high = points.min(axis=0), points.max(axis=0)
        center, reach = (low + high) / 2, float(np.linalg.norm(high - low)) / 2 + FARTHEST_END
        bearing = []
        for pose, origin in enumerate(self.cloud.origins):
            near = np.flatnonzero(within(center, reach, origin, self.directions))
            far_enough = self.cloud.ranges[pose].ravel()[near] > np.linalg.norm(center - origin) - reach
            bearing.append(pose * len(self.directions) + near[far_enough])
        return self.beams(np.concatenate(bearing), members)

    def points(self, members: Ints) -> Floats:
        """Return where a group's beams came back from, shape (N, 3), metres."""
        return self.beams(members, members).points()


@dataclass(frozen=True, eq=False)
class Group:
    """The numbers of a group's beams, and its explanations, the likeliest first."""

    members: Ints
    ranked: list[Explanation]

    @property
    def best(self) -> Explanation:
        """The likeliest explanation."""
        return self.ranked[0]


def _taken_apart(sight: Sight, members: Ints, rng: np.random.Generator, thin: Sequence[float] = THIN) -> list[Group]:
    """Return a group with its explanations; or those of its parts, where they explain it better."""
    ranked = explanations(sight.around(members), sight.ground, rng=rng)
    whole = [Group(members, ranked)] if ranked else []
    if not thin or (ranked and ranked[0].fits):
        return whole
    label = linked(sight.points(members), thin[0])
    parts = [part for k in np.unique(label) if len(part := members[label == k]) >= LEAST_RETURNS]
    if len(parts) < 2:
        return _taken_apart(sight, members, rng, thin[1:]) if len(thin) > 1 else whole
    apart = [group for part in parts for group in _taken_apart(sight, part, rng, thin[1:])]
    better = not ranked or sum(group.best.evidence for group in apart) > ranked[0].evidence
    return apart if better else whole


def _joined(sight: Sight, found: list[Group], rng: np.random.Generator) -> list[Group]:
    """Return groups, the largest first, in which those that are parts of one solid are one."""
    kept = list[Group]()
    for group in sorted(found, key=lambda group: -len(group.members)):
        for k, larger in enumerate(kept):
            if not _close(sight.points(group.members), sight.points(larger.members)):
                continue
            on_it = _share_on(larger.best.solid, sight.beams(group.members, group.members))
            if on_it < MOSTLY and not (_may_hold(larger, sight, group) or _may_hold(group, sight, larger)):
                continue
            members = np.union1d(group.members, larger.members)
            ranked = explanations(sight.around(members), sight.ground, rng=rng)
            apart = larger.best.evidence + group.best.evidence
            if ranked and (on_it >= MOSTLY or (ranked[0].fits and ranked[0].evidence > apart)):
                kept[k] = Group(members, ranked)
                break
        else:
            kept.append(group)
    return kept


def _told(sight: Sight, group: Group) -> FoundSolid:
    """Return what is said of a group: its likeliest solid, and the kinds that it may be as well."""
    best = group.best
    others: list[str] = [each.solid.kind for each in group.ranked[1:] if each.evidence > best.evidence - CERTAIN]
    points = sight.points(group.members)
    if best.solid.kind == "box":
        faces = np.abs(best.solid.speeds(points)[1][:, 3:]).sum(axis=0)
        if np.count_nonzero(faces >= LEAST_ON_FACE) < 2:
            others.append("cylinder")  # a single face may as well be a cylinder's end
    if not best.fits:
        others.append("something else")
    return FoundSolid(best.solid, tuple(dict.fromkeys(others)), points, best)


def _close(a: Floats, b: Floats) -> bool:
    """Tell whether two groups of points come near each other."""
    from scipy.spatial import cKDTree

    return bool(np.isfinite(cKDTree(a).query(b, distance_upper_bound=NEAR_GROUPS)[0]).any())


def _share_on(solid: Solid, beams: Beams) -> float:
    t = hit(solid, beams.origins, beams.directions)
    return float((np.abs(beams.ranges - t) <= ON_IT * beams.noise_std).mean())


def _may_hold(group: Group, sight: Sight, other: Group) -> bool:
    """Tell whether a group's solid may be so large, where its ends are open, that it holds most of another group."""
    as_large = grown(group.best.solid, group.best.ends, SETTLED_STD)
    return bool(np.mean(as_large.distance(sight.points(other.members)) <= NEARLY_IN) >= MOSTLY)
