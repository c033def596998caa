"""Candidates: every shape that could have caused the points of a cluster, the best explanation first.

    1 start   the points in order, cut into their straightest pieces; a circle; chords over what was not seen
    2 bound   how well the pieces fit says about the least that each kind can cost
    3 fit     kind by kind, the most promising first: give each point to its side, refit all sides, repeat
    4 polish  share points between sides, for those that come near the best
    5 free    any straight pieces, where the best does not fit

Most outlines leave no doubt. Then it is a waste to fit every kind: when the best is ahead of the bounds of all others,
it has won. This is "branch and bound". The bounds are no theorem: a shape must be well ahead of them.

In:  points of one cluster, shape (N, 2), metres, and how far points spread from outlines.
Out: ``Candidate`` explanations, the best first.

>>> ranked = candidates(Circle((0, 0), 0.05).outline(60), spread=0.0005)
>>> ranked[0].kind, ranked[0].cost < ranked[1].cost
('circle', True)

Sources: 1 Bellman (1961); 2 Land and Doig (1960), "An automatic method of solving discrete programming problems"; 3
Isack and Boykov (2012); 4 Dempster, Laird and Rubin (1977).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ..arguments import Floats
from ..circles import fit_circle, nearer_circle
from ..lines import Line, fit_line
from ..seen import REACH
from ..segmentation import LEAST_GROUP
from ..shapes import KINDS, Circle
from .cuts import Cut, best_cuts, chords, frames, in_company, outlines_with
from .evidence import CERTAIN, NAMELESS_COST, NEARLY_ALL, Candidate, Figure, Way, judged, price
from .free import free_candidate
from .lack_of_fit import lack_of_fit
from .outlines import QUARTERS, Outlines, joined
from .refine import SOFT_ROUNDS, one_side_more, refine_hard, refine_soft
from .scatter import ENOUGH_POINTS, LEAST_SPREAD, SIGMAS, shares_smooth

MOST_RADIUS = 0.25  # m: a larger circle than a quarter of the board is a wall
LEAST_ARC = np.radians(60)  # a shorter arc fits a wide range of circles
SETTLED_MOVE = 1e-7  # m: what moves by less has settled; the next round moves it by a small part of that
MOST_POINTS = 10_000  # of more, an even part is explained, so that the work is bounded
STARTS_KEPT = 5  # of the guesses, those closest to the points are refined
WIDER = 0.005  # m: guesses are judged with a longer reach than fits, because they still lie beside the points
BLURRED = 0.002  # m: beyond this spread a short side drowns in its neighbours' points, each given to one side alone
CONTENDER = 40.0  # what costs so much more before the last polish is not going to win by it
LOOKS, NEARLY_ALL_POINTS = 3, 0.97  # strays lead cuts astray: once more without them, until so many points lie on it
CHANCE = 25.0  # by so much noise lets a cut into one piece more come closer; what misses its least by more began badly
RIVAL = 200.0  # and no rival comes near any more
CIRCLE_LOOKS, KEPT_NEAREST = 2, 0.8  # share of the points that a circle's start is fitted to


def candidates(
    points: Floats,
    spread: float,
    *,
    soft: bool = True,
    thorough: bool = True,
    kinds: Sequence[str] = KINDS,
) -> list[Candidate]:
    """Return explanations of a cluster's points, the best first; none for fewer than eight different points.

    They are a wall, a circle, and polygons of three to five sides, as far as each can be fitted, and where the best of
    them does not fit, the best outline of any straight pieces. Those that come near the best are fitted to the last
    digit. Of very many points, an even part is explained. Whoever is ``thorough`` has every kind fitted, and not only
    those that may win.
    """
    if np.count_nonzero(np.diff(np.sort(points[:, 0] + 1j * points[:, 1]))) < LEAST_GROUP - 1:
        return []
    points = points[:: -(-len(points) // MOST_POINTS)]
    middle = points.mean(axis=0)
    points = points - middle  # digits are not lost far from the origin
    fits = list(_fits(points, spread, thorough, ("wall", *kinds)))
    if len(fits) == 1:  # it has no rival, and is judged once, when it is polished
        waiting = [Candidate(*fits[0], cost=0.0, length=0.0, n_on=0.0)]
    else:
        waiting = [judged(points, figure, spread, square=square) for figure, square in fits]
    waiting.sort(key=lambda c: c.cost)
    done = list[Candidate]()
    while waiting and waiting[0].cost <= min((c.cost for c in done), default=np.inf) + CONTENDER:
        finest = polished(points, waiting.pop(0), spread, soft=soft)
        done += [] if finest is None else [finest]
    ranked = sorted(done + waiting, key=lambda c: c.cost)
    if "polygon" in kinds and not (ranked and _explains(points, ranked[0], spread)):
        ranked = sorted([*ranked, *free_candidate(points, spread)], key=lambda c: c.cost)
    return [c.moved(middle) for c in ranked if c.kind in ("wall", *kinds)]


def _fits(points: Floats, spread: float, thorough: bool, kinds: Sequence[str]) -> Iterator[tuple[Figure, bool]]:
    """Yield figures that a few rounds of giving points back lead to, and whether at right angles.

    The fits are made on some of the points, where there are many. Far rivals are fitted only if that is asked.
    """
    points = points[np.argsort(np.arctan2(points[:, 1], points[:, 0]), kind="stable")]  # in the order of their bearings
    points = points[:: -(-len(points) // ENOUGH_POINTS)]
    for _ in range(LOOKS):
        fits = Ways.through(points, spread).fits(kinds, thorough)
        if not fits:
            return
        best, nearest = min(fits.values(), key=lambda fit: fit[0])
        for (_, square), (cost, figure) in fits.items():
            if cost <= best + RIVAL or thorough:
                yield figure, square
        on_it = np.abs(nearest.signed_distance(points)) <= SIGMAS * spread
        if on_it.mean() >= NEARLY_ALL_POINTS:
            return
        near = in_company(points, spread)
        points = points[on_it if near.all() else near]
        if len(points) < LEAST_GROUP:
            return


KIND_OF = ("circle", "wall", "", "triangle", "polygon", "pentagon")  # by the number of sides, but at right angles


@dataclass(frozen=True, eq=False)
class Ways:
    """All ways to explain points in order, shape (N, 2), metres, and the least that each can cost.

    Costs are told up to what all explanations of these points have in common.
    """

    points: Floats
    spread: float
    cuts: dict[int, Cut]
    spans: list[tuple[float, float]]
    least: dict[Way, float]
    done: dict[Way, tuple[float, Figure | None]]
    again: set[Way]

    @classmethod
    def through(cls, points: Floats, spread: float) -> Ways:
        """Return the ways to explain these points."""
        unseen = REACH + SIGMAS * (spread - LEAST_SPREAD)
        cuts, spans = best_cuts(points, unseen), chords(points, unseen)
        ways = cls(points, spread, cuts, spans, {}, {}, set())
        if (circle := fit_circle(points, "taubin")) is not None:
            ways.least[0, False] = ways.cost(circle, (0, False))
            if np.abs(circle.signed_distance(points)).max() <= SIGMAS * spread:
                ways.done[0, False] = ways.least[0, False], circle if circle.radius <= MOST_RADIUS else None
        if (wall := fit_line(points)) is not None:
            ways.least[1, False] = ways.cost(wall, (1, False))
            ways.done[1, False] = ways.least[1, False], wall
        for k in (3, 4, 5):
            if k in cuts or spans:
                ways.least[k, False] = ways._cost(cuts[k].squares if k in cuts else 0.0, (k, False))
        if (4, False) in ways.least:
            at_right_angles = [cuts[k].right_angled for k in range(2 if spans else 4, 5) if k in cuts]
            ways.least[4, True] = ways._cost(min(at_right_angles, default=0.0), (4, True))
        return ways

    def fits(self, kinds: Sequence[str], thorough: bool) -> dict[Way, tuple[float, Figure]]:
        """Return the ways that may win, each with what it costs and its fit; all ways if that is asked.

        One that costs far more than it could began badly, and begins once more; but not where only what chance gives
        to so many sides more would make it win: four at right angles are no freer than three.
        """
        fits: dict[Way, tuple[float, Figure]] = {}
        best, winner = np.inf, 0
        for again in (False, True):
            for way in sorted(self.least, key=self.least.__getitem__):
                chance = 0.0 if way[1] else CHANCE * max(way[0] - winner, 0)
                may_win = self.least[way] <= (best - chance if again else best + CERTAIN)
                if ("rectangle" if way[1] else KIND_OF[way[0]]) not in kinds or not (may_win or thorough):
                    continue
                cost, figure = self.fitted(way, again=again)
                if figure is not None:
                    fits[way] = cost, figure
                    best, winner = min((best, winner), (cost, way[0]))
        return fits

    def cost(self, figure: Figure | None, way: Way) -> float:
        """Return what a fit costs; infinite without one."""
        return np.inf if figure is None else self._cost(float((figure.signed_distance(self.points) ** 2).sum()), way)

    def _cost(self, squares: float, way: Way) -> float:
        nameless = NAMELESS_COST if way == (4, False) else 0.0
        return squares / self.spread**2 + price(way, len(self.points), self.spread) + nameless

    def fitted(self, way: Way, *, again: bool) -> tuple[float, Figure | None]:
        """Return what the fit costs, and the fit; None where there is none.

        Again it begins from one side more than the best outline with one less; at right angles, from frames around all.
        """
        k, square = way
        starts = outlines_with(self.cuts, self.spans, k) if k > 1 else None
        if way not in self.done:
            begun = _circle_through(self.points) if k == 0 else self._from_cuts(starts, square)
            self.done[way] = self.cost(begun, way), begun
        cost, fit = self.done[way]
        if again and cost > self.least[way] + CHANCE and starts is not None and way not in self.again:
            self.again.add(way)
            begin = [fit] if isinstance(fit, Outlines) else []
            fewer = self.fitted((k - 1, False), again=True)[1] if k > 3 and not square else None
            if square:
                begin.append(frames(self.points, starts))
            elif isinstance(fewer, Outlines):
                begin.append(one_side_more(self.points, fewer))
            fit = _refined(self.points, joined(*begin), self.spread, square=square) if begin else None
            self.done[way] = self.cost(fit, way), fit
        return self.done[way]

    def _from_cuts(self, starts: Outlines | None, square: bool) -> Outlines | None:
        """Return the fit that pieces and chords lead to."""
        if starts is None or (len(starts) == 1 and not square and self.spread < BLURRED and starts.sound()[0]):
            return starts
        begin = Outlines(starts.angles[:, :1] + QUARTERS, starts.offsets) if square else starts
        return _refined(self.points, begin, self.spread, square=square)


def _circle_through(points: Floats) -> Circle | None:
    """Return Taubin's circle through the points that are nearest to it; None for one that is too large."""
    circle = fit_circle(points, "taubin")
    for _ in range(CIRCLE_LOOKS):
        if circle is None:
            return None
        distance = np.abs(circle.signed_distance(points))
        circle = fit_circle(points[distance <= np.quantile(distance, KEPT_NEAREST)], "taubin")
    return circle if circle is not None and circle.radius <= MOST_RADIUS else None


def _refined(points: Floats, starts: Outlines, spread: float, *, square: bool) -> Outlines | None:
    """Refine the starts that lie closest to the points, and return the best one; None without a sound one."""
    reach = SIGMAS * spread
    near = starts
    if len(starts) > 1:
        near = starts[np.argsort(starts.truncated_cost(points, reach + WIDER), kind="stable")[:STARTS_KEPT]]
    fits = refine_hard(points, near, reach, square=square)
    fits = fits[fits.sound()]
    if len(fits):
        best = int(np.argmin(fits.truncated_cost(points, reach))) if len(fits) > 1 else 0
        return fits[best : best + 1]
    sound = near[near.sound()]
    if spread < BLURRED or len(sound) == 0:
        return None
    return refine_soft(points, sound[:1], spread, square=square)


def explained_again(
    points: Floats, before: Sequence[Candidate], spread: float, *, soft: bool = True
) -> list[Candidate]:
    """Return the best explanation and its best rival, fitted anew from what they were ``before``, with fewer points."""
    shapes = [c for c in before if c.shape is not None]
    kept = shapes[:1] + [c for c in shapes if c.kind != shapes[0].kind][:1]
    middle = points.mean(axis=0)
    points, again = points - middle, list[Candidate]()
    for old in (c.moved(-middle) for c in kept):
        rough = judged(points, old.figure, spread, square=old.square) if again else old
        near = not again or rough.cost < again[0].cost + CONTENDER
        anew = polished(points, old, spread, soft=soft) if near else rough
        again += [] if anew is None else [anew]
    return [c.moved(middle) for c in sorted(again, key=lambda c: c.cost)]


def _explains(points: Floats, best: Candidate, spread: float) -> bool:
    """Tell whether nearly all points lie on the best explanation, all around, and without any order in their misses."""
    if best.n_on < NEARLY_ALL * len(points) or min(best.seen, default=1.0) < NEARLY_ALL:
        return False
    # What is as thin as a wall closes around nothing that a rectangle would not.
    return isinstance(best.figure, Line) or lack_of_fit(points, best.figure, spread, square=best.square) >= CERTAIN


def polished(points: Floats, rough: Candidate, spread: float, *, soft: bool = True) -> Candidate | None:
    """Return a candidate near its solution fitted to the last digit, and judged; None of too short an arc."""
    figure, square = rough.figure, rough.square
    if isinstance(figure, Circle):
        circle = _polished_circle(points, figure, spread)
        if circle is None:
            return None
        found = judged(points, circle, spread)
        ends = 2 * REACH if found.length < circle.perimeter * (1 - 1e-9) else 0.0  # an arc looks longer by this
        return found if (found.length - ends) / circle.radius >= LEAST_ARC else None
    if isinstance(figure, Outlines) and figure.sound()[0]:  # a free outline is as good as it gets
        if soft:
            fit = refine_soft(points, figure, spread, square=square)
        else:
            fit = refine_hard(points, figure, SIGMAS * spread, square=square)
        figure = fit if fit.sound()[0] else figure
    return judged(points, figure, spread, square=square)


def _polished_circle(points: Floats, circle: Circle, spread: float) -> Circle | None:
    """Return the geometric fit in which points from nowhere do not count; None when it grows beyond a board."""
    for _ in range(SOFT_ROUNDS):
        share, told, _ = shares_smooth(circle.signed_distance(points), spread)
        fitted = nearer_circle(circle, points, share * told)
        if fitted is None or fitted.radius > MOST_RADIUS:
            return None
        change = max(abs(fitted.radius - circle.radius), *np.abs(fitted.center - circle.center).tolist())
        circle = fitted
        if change <= SETTLED_MOVE:
            break
    return circle
