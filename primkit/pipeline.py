"""Pipeline: the whole story, from points to shapes, on one screen.

In:  a grid, or points, shape (N, 2), metres.
Out: ``Found``, a list of ``Detection``: each with its shape, its points, and how sure it is.

>>> from primkit.shapes import Circle
>>> found = find_shapes(Circle((0.1, 0.0), 0.06).outline(150), rng=0)
>>> [d.shape for d in found]
[Circle(center=(0.1, 0), radius=0.06)]

Two settings. ``PAPER`` is the method as it was published: K-Means with the known number, one line after the other by
RANSAC until a tenth of the points is left, the number of lines for a name, extents and means for measures. ``ROBUST``,
the default, finds the number of shapes, fits all sides together, and lets the likelihood decide what a shape is.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from copy import copy
from dataclasses import asdict, dataclass, replace
from functools import partial
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from .account import Account, beside_walls, things_of, walls_among
from .arguments import Floats, Ints, Labels, as_count, as_points, as_positive, as_rng, check_type, doubt, short
from .found import Found
from .grid import Grid
from .measure import CELL, Detection, Frame, Thing, detection
from .paper import CIRCLE_TRIALS, LINE_TRIALS, ON_LINE, one_start_kmeans, shape_as_published
from .robust.candidates import MOST_POINTS
from .robust.choice import Choice, explained, grown
from .robust.regroup import WORK_OF_A_TRY, Opinion, regrouped
from .robust.scatter import LEAST_SPREAD, SIGMAS, noise_of, spread_across, spread_from_median, spread_of
from .segmentation import Grouping, check_count, count_by_silhouette, segment
from .shapes import KINDS, Kind
from .steps import Steps
from .table import Table

# Groups as they were measured last, by their points: the warm starts of the next look at a map that grows.
WarmStarts = dict[tuple[bytes, float, bool, bool, tuple[str, ...]], Choice]

SAME_SPREAD = 1.25  # fits are done anew when the spread comes out farther than this from what was supposed
CONTRADICTED = 1.5  # neighbours scatter less than their noise lets them, if anything
MOST_LOW = 2.5  # neighbours scatter at least by this part of the spread
ENOUGH_GROUPS = 24  # tell it
SPREAD_ROUNDS = 2  # from the neighbours' estimate, a third low at most, two rounds get there


@dataclass(frozen=True)
class Settings:
    """How ``find_shapes`` works: each remedy over the published method can be switched on alone.

    Parameters
    ----------
    grouping : {"link", "kmeans"}
        How points are grouped: neighbours linked, or K-Means.
    method : {"joint", "published"}
        How groups are measured. ``"joint"``: all sides of a shape together, the evidence decides.
        ``"published"``: the paper's way.
    soft : bool
        Share points around a corner between its sides. Only for ``"joint"``, like the next three.
    second_opinion : bool
        Split and merge groups where that explains the points better.
    thorough : bool
        Fit every kind to every group. By default those alone are fitted that may win, see ``robust.candidates``: the
        same shape, several times faster.
    noise_std : float, optional
        Standard deviation of the sensor's ranges in metres; found from the points when not given, or when they scatter
        much farther (a ``LikelyWrong`` warning then says so).
    line_trials : int
        Samples for each line. Only for ``"published"``, like the next.
    circle_trials : int
        Samples for a circle.
    """

    grouping: Grouping = "link"
    method: Literal["joint", "published"] = "joint"
    soft: bool = True
    second_opinion: bool = True
    thorough: bool = False
    noise_std: float | None = None
    line_trials: int = LINE_TRIALS
    circle_trials: int = CIRCLE_TRIALS

    def __post_init__(self) -> None:
        if self.grouping not in ("link", "kmeans"):
            raise ValueError(f'grouping must be "link" or "kmeans", got {short(self.grouping)}')
        if self.method not in ("joint", "published"):
            raise ValueError(f'method must be "joint" or "published", got {short(self.method)}')
        if self.noise_std is not None:
            as_positive(self.noise_std, "noise_std", zero=True)
        as_count(self.line_trials, "line_trials")
        as_count(self.circle_trials, "circle_trials")

    def __repr__(self) -> str:
        for name, settings in (("ROBUST", ROBUST), ("PAPER", PAPER)):
            if self == settings:
                return name
        own = [(name, value) for name, value in asdict(self).items() if value != getattr(ROBUST, name)]
        return f"Settings({', '.join(f'{name}={value!r}' for name, value in own)})"

    def _repr_html_(self) -> str:
        rows = [(name, str(value), str(getattr(ROBUST, name))) for name, value in asdict(self).items()]
        lengths = "noise_std in metres; None: found from the points."
        return Table(("setting", "value", "ROBUST"), rows, repr(self), (lengths,))._repr_html_()


ROBUST = Settings()
PAPER = Settings(grouping="kmeans", method="published")


def find_shapes(
    points: Grid | ArrayLike,
    n_shapes: int | None = None,
    *,
    resolution: float | None = None,
    settings: Settings = ROBUST,
    steps: Steps | None = None,
    kinds: Sequence[Kind] | None = None,
    rng: int | np.random.Generator | None = None,
) -> Found:
    """Find the shapes whose outlines the points lie on; for a map that grows, see ``Mapper``.

    Parameters
    ----------
    points : Grid, or array_like, shape (N, 2)
        Metres, in any order. A grid knows which scan saw each: points of a scan whose pose is wrong err together, and
        the deviations tell by how much. Of points alone nobody knows, and what they scatter beyond the cells, or
        ``noise_std``, is taken as shared: their deviations are wider.
    n_shapes : int, optional
        How many shapes there are, beside walls; found when it is not given. K-Means, which knows no walls, makes so
        many groups; without a number ``PAPER`` takes its best silhouette. Linking finds the number by itself: with
        it, and the published measuring, this is not used.
    resolution : float, optional
        Side of the cells that points lie on, metres; 1 mm when it is not given. A grid knows its own. All lengths of
        the method follow it: a board ten times as large, on cells ten times as large, has the same shapes on it.
    settings : Settings
        ``ROBUST`` or ``PAPER``, or your own.
    steps : Steps, optional
        Functions of your own in the place of steps: ``Steps(segment=..., fit_line=..., fit_circle=..., measure=...)``.
    kinds : sequence of str
        What can be there, if that is known beforehand: some of ``"circle"``, ``"triangle"``, ``"rectangle"``,
        ``"pentagon"``, ``"polygon"``. Without the last, three eighths of a circle make certain. No use for ``PAPER``.
    rng : int or numpy.random.Generator, optional
        Seed or generator: the same seed gives the same shapes, to the last bit, for points in any order.

    Returns
    -------
    Found
        A list of ``Detection``, from left to right, that carries also ``walls``, ``others`` and ``strays``.

    Raises
    ------
    ValueError
        If points are not finite (N, 2), or more shapes are asked for than there are different points; if a resolution
        is given that is not above zero, or with a grid; if a kind is none of the kinds; or if a step of your own
        returns what it should not.

    Examples
    --------
    >>> find_shapes([])
    no shapes found
    """
    return find_again(points, {}, n_shapes, resolution=resolution, settings=settings, steps=steps, kinds=kinds, rng=rng)


def find_again(
    points: Grid | ArrayLike,
    warm: WarmStarts,
    n_shapes: int | None = None,
    *,
    resolution: float | None = None,
    settings: Settings = ROBUST,
    steps: Steps | None = None,
    kinds: Sequence[Kind] | None = None,
    rng: int | np.random.Generator | None = None,
) -> Found:
    """Find shapes as ``find_shapes`` does, from the warm starts of the last call, which become those of the next.

    Groups whose points have not changed since are not measured again, and those that have a few points more are fitted
    anew from what they were: to about a tenth of a millimetre the result is the same. ``rng`` must be the same seed.
    """
    check_type(settings, Settings, "settings must be ROBUST, PAPER or Settings of your own")
    steps = Steps() if steps is None else steps
    check_type(steps, Steps, "steps must be Steps, such as Steps(fit_circle=mine)")
    kinds = _known(kinds)
    points, resolution, scans = _points_on_cells(points, resolution)
    if n_shapes is not None:
        check_count(n_shapes, points)
    if len(points) == 0 or n_shapes == 0:
        return Found(strays=points, resolution=resolution)
    frame = Frame.of(points, resolution)
    local = frame.local(points)
    order = np.lexsort((local[:, 1], local[:, 0]))  # the order of seeing leaves no trace
    points, local, scans = points[order], local[order], scans[order]
    group_rng, measure_rng = as_rng(rng).spawn(2)
    grouped = (labels := steps.labels(points, n_shapes)) is not None
    if labels is None:
        labels = _groups(local, n_shapes, settings, group_rng)
    together = [local[labels == label] for label in range(labels.max() + 1)]
    lone = local[(labels < 0) & (not grouped)]  # nobody chose to leave them out
    account = Account.of(points, local, frame, len(lone), scans)
    steps = steps.within(frame)
    if settings.noise_std is not None:
        settings = replace(settings, noise_std=settings.noise_std / frame.unit)
    found, bounded = list[Thing](), False
    if steps.measure is not None:
        reach = SIGMAS * _in_steps(spread_of(local))
        asked = [points for points in together if len(points) and not account.by_chance(points)]
        found += filter(None, (steps.measured(points, reach) for points in asked))
    elif settings.method == "published":
        found += _as_published(together, settings, steps, measure_rng)
    else:
        together = [points for points in together if not account.by_chance(points)]  # strays, not to be explained
        groups, margins, bounded = _jointly(together, lone, n_shapes, settings, kinds, warm)
        for group, margin in zip(groups, margins, strict=True):
            for thing in things_of(group, margin, account):
                if isinstance(thing, Detection):
                    thing = replace(thing, noise_std=min(settings.noise_std or 0.0, noise_of(group.spread)))
                own = steps.remeasured(thing, SIGMAS * group.spread) if isinstance(thing, Detection) else thing
                found += [] if own is None else [own]
    return account.closed(found, bounded)


def _known(kinds: Sequence[Kind] | Kind | None) -> tuple[Kind, ...]:
    """Return the kinds that can be there, all where none are told; or refuse what is none."""
    if kinds is None:
        return KINDS
    names: tuple[Kind, ...] = (kinds,) if isinstance(kinds, str) else tuple(kinds)
    strange = [name for name in names if name not in KINDS]
    if strange or not names:
        raise ValueError(f"kinds must be some of {', '.join(KINDS)}, got {short(strange[0] if strange else kinds)}")
    return names


def _points_on_cells(points: Grid | ArrayLike, resolution: float | None) -> tuple[Floats, float, Ints]:
    """Return points, shape (N, 2), the side of their cells, both metres, and the scan of each, 0 if it is not known."""
    if isinstance(points, Grid) or (hasattr(points, "resolution") and hasattr(points, "points")):  # a MovingGrid
        if resolution is not None:
            raise ValueError(f"resolution must not be given with a grid, which knows its own, got {short(resolution)}")
        now: Any = copy(points)  # as it is now: another thread may add to it
        return now.points(), now.resolution, now.last_seen
    points = as_points(points)
    unknown = np.zeros(len(points), dtype=np.int64)
    return points, CELL if resolution is None else as_positive(resolution, "resolution"), unknown


def _groups(points: Floats, n_shapes: int | None, settings: Settings, rng: np.random.Generator) -> Labels:
    """Return which points belong together; published measuring goes with K-Means from one start."""
    if settings.grouping == "link" or settings.method == "joint":
        return segment(points, n_shapes if settings.grouping == "kmeans" else None, method=settings.grouping, rng=rng)
    return one_start_kmeans(points, count_by_silhouette(points, rng=rng) if n_shapes is None else n_shapes, rng)


def _jointly(
    together: list[Floats],
    lone: Floats,
    n_shapes: int | None,
    settings: Settings,
    kinds: tuple[Kind, ...],
    warm: WarmStarts,
) -> tuple[list[Choice], list[float], bool]:
    """Explain each group, and ask for a second opinion on the groups: the default way; tell if a bound was reached."""
    how = (settings.soft, settings.thorough, kinds)
    anew = partial(explained, soft=settings.soft, thorough=settings.thorough, kinds=kinds)
    used: WarmStarts = {}

    def explain(points: Floats, spread: float) -> Choice:
        key = (points.tobytes(), spread, *how)
        if key not in used:
            alike = (old for (_, *before), old in warm.items() if before == [spread, *how])
            again = (grown(old, points, spread, soft=settings.soft) for old in alike)
            used[key] = warm.get(key) or next(filter(None, again), None) or anew(points, spread)
        return used[key]

    last = next((group.spread for group in reversed(warm.values())), None)  # as the last fits left it
    groups, spread = _explain_all(together, settings, last, explain)
    margins, opinion = [float("nan")] * len(groups), Opinion(partial(explain, spread=spread))
    opinion.work = sum(len(points) + WORK_OF_A_TRY for points in together)
    if settings.second_opinion if n_shapes is None else len(groups) != n_shapes:
        groups, margins = regrouped(groups, spread, explain=opinion, lone=lone)
    if n_shapes is None:
        beside = [explain(points, spread) for group in groups for points in beside_walls(group)]
        groups, margins = groups + beside, margins + [0.0] * len(beside)
    else:
        walls = walls_among(groups, n_shapes)
        groups, margins = regrouped([g for g in groups if g not in walls], spread, n_shapes, explain=opinion)
        groups, margins = groups + walls, margins + [float("inf")] * len(walls)
    warm.clear()  # what was not used now will not come again: a map only grows
    warm.update(used)
    return groups, margins, opinion.bounded or any(len(points) > MOST_POINTS for points in together)


def _explain_all(
    together: list[Floats], settings: Settings, last: float | None, explain: Callable[[Floats, float], Choice]
) -> tuple[list[Choice], float]:
    """Explain each group; the spread is told, or found from the points or the last call, and then from the fits.

    What is told is not believed where neighbours scatter much farther.
    """
    told = None if settings.noise_std is None else spread_across(settings.noise_std)
    points = np.vstack([np.empty((0, 2)), *together])
    spread = last if last and told is None else _in_steps(spread_of(points))
    if told is not None and spread <= CONTRADICTED * told:
        return [explain(points, told) for points in together], told
    some = together[:: -(-len(together) // ENOUGH_GROUPS)] if together else []
    for _ in range(SPREAD_ROUNDS):
        fitted = _spread_of_fits([explain(points, spread) for points in some])
        if fitted is None or 1 / SAME_SPREAD <= fitted / spread <= SAME_SPREAD:
            break
        spread = _in_steps(min(fitted, MOST_LOW * spread_of(points)))  # fits are far off where shapes are not parted
    if told is not None:
        times = f"{spread / told:.1f} times as far as that"
        doubt(f"noise_std is contradicted by the points, which scatter {times}: they are believed instead", depth=4)
    return [explain(points, spread) for points in together], spread


def _in_steps(spread: float) -> float:
    """Return the spread rounded to steps of a tenth of itself: a few points more must not make all fits anew."""
    step = np.log(1.1)
    return float(LEAST_SPREAD * np.exp(step * round(np.log(spread / LEAST_SPREAD) / step)))


def _spread_of_fits(groups: list[Choice]) -> float | None:
    """Return how far the points lie from the shapes that explain them; None without shapes."""
    distances = [g.distance for g in groups if g.shape is not None]
    return spread_from_median(float(np.median(np.abs(np.concatenate(distances))))) if distances else None


def _as_published(
    together: list[Floats], settings: Settings, steps: Steps, rng: np.random.Generator
) -> list[Detection]:
    """Name and measure each cluster the paper's way."""
    reach = ON_LINE * CELL
    found = []
    for cluster in sorted(filter(len, together), key=lambda points: tuple(points.mean(axis=0))):
        shape = shape_as_published(
            cluster,
            line_trials=settings.line_trials,
            circle_trials=settings.circle_trials,
            fit_line=None if steps.fit_line is None else steps.line,
            resolution=CELL,
            rng=rng,
        )
        if shape is not None:
            found.append(steps.remeasured(detection(shape, cluster, reach), reach, sides=False))
    return [one for one in found if one is not None]
