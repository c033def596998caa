"""Unknown: a thing that is none of the four kinds beside one that is; what is said of it with certainty must be so."""

from __future__ import annotations

from collections.abc import Iterator

import primkit as pk

from .boards import beside, rng_of, seen_on
from .figures import Figure, share
from .judging import FEW, agrees, n_right, own_of, same_name, sure_and_wrong
from .things import CORNERED, SORTS, thing

MOST_NOISE = 0.002  # m


def unknown(n: int, seed: int) -> Iterator[Figure]:
    """Things of no kind, sort after sort: never sure and wrong; polygons right; what stands beside them right."""
    wrong: dict[str, bool] = {}
    by_name: dict[str, bool] = {}
    cornered: dict[str, bool] = {}
    certain: dict[str, bool] = {}
    usual_right: dict[str, bool] = {}
    usual_wrong: dict[str, bool] = {}
    for k in range(n):
        rng = rng_of(seed, k)
        sort = list(SORTS)[rng.integers(len(SORTS))]
        world, it, usual = beside(thing(sort, rng), rng)
        noise, case = rng.uniform(0, MOST_NOISE), f"{k} ({sort})"
        found = pk.find_shapes(seen_on(world, rng, noise_std=noise), rng=0)
        ours, theirs = own_of(found, it, [usual]), own_of(found, usual, [it])
        lies = sure_and_wrong(ours, [it] if sort in CORNERED else [])
        wrong[case] = bool(lies)
        by_name[case] = any(not same_name(one.shape, it) for one in lies)
        if sort in CORNERED:
            cornered[case] = len(ours) == 1 and n_right(ours, pk.World([it])) == 1
            certain[case] = any(one.certain and agrees(one, it) for one in ours)
        usual_right[case] = len(theirs) == 1 and n_right(theirs, pk.World([usual])) == 1
        usual_wrong[case] = bool(sure_and_wrong(theirs, [usual]))
    yield share("things: certain and wrong", wrong, at_most=FEW)
    curved = {case: lie for case, lie in wrong.items() if case not in cornered}
    yield share("    of the curved ones", curved, at_most=FEW)
    yield share("    of the cornered ones", {case: wrong[case] for case in cornered}, at_most=FEW)
    yield share("    by name or number of corners, not by size", by_name, at_most=FEW)
    yield share("polygons: corners counted, within 5 mm", cornered, at_least=0.97)
    yield share("    certain of it", certain)
    yield share("the ordinary shape beside it: right", usual_right, at_least=0.99)
    yield share("    certain and wrong", usual_wrong, at_most=FEW)
    for sort in SORTS:
        own = {case: lie for case, lie in wrong.items() if case.endswith(f"({sort})")}
        if any(own.values()):
            yield share(f"    certain and wrong: {sort}", own, at_most=FEW)
