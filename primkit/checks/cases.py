"""Cases: what the functions of all lessons are tried on; the same for everybody, the plain ones first.

In:  a way to draw the arguments of one call.
Out: the arguments of one call after the other.

>>> rng = np.random.default_rng(0)
>>> draw = lambda n: (n, rng.uniform()) if rng.uniform() > 0.5 else None  # None: drawn again
>>> [args[0] for args in random_cases(draw, 3)]
[0, 1, 2]
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from ..arguments import Floats

Args = tuple[Any, ...]

RANDOM_CASES = 200  # of each check, unless each of them takes long
UNDECIDED = 1e-6  # m or cells: so near to where the answer changes rounding alone decides, and the case is left out


def random_cases(draw: Callable[[int], Args | None], n: int = RANDOM_CASES) -> Iterator[Args]:
    """Yield what ``draw`` returns for case 0, 1, ..., n - 1; a case that is None is drawn again."""
    for k in range(n):
        while (args := draw(k)) is None:
            pass
        yield args


def around(center: Floats, reach: Floats | float, bearings: Floats) -> Floats:
    """Return the places so far from a centre, metres, at some bearings, shape (N, 2)."""
    places: Floats = center + np.reshape(reach, (-1, 1)) * np.column_stack([np.cos(bearings), np.sin(bearings)])
    return places
