"""Clock: how long things take, in turns, so that what slows the machine slows all of them.

In:  tools by name, each a function without arguments that does the same work.
Out: seconds, one for each tool and round; ``Spread``: their median and their ends.

>>> taken = in_turns({"a": lambda: None, "b": lambda: None}, rounds=3)
>>> {tool: len(seconds) for tool, seconds in taken.items()}
{'a': 3, 'b': 3}

Times of a shared machine wander. Two that are measured one right after the other wander together: their ratio in
each round tells more than the ratio of their medians, and how far the rounds differ tells how much to trust it.
"""

from __future__ import annotations

import gc
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from time import perf_counter

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]
Tool = Callable[[], object]


@dataclass(frozen=True)
class Spread:
    """A median with its lowest and highest value.

    Examples
    --------
    >>> Spread.of([1.0, 2.0, 9.0])
    Spread(median=2.0, low=1.0, high=9.0)
    """

    median: float
    low: float
    high: float

    @classmethod
    def of(cls, values: ArrayLike) -> Spread:
        """Return the spread of some numbers, at least one."""
        numbers = np.asarray(values, dtype=float)
        return cls(float(np.median(numbers)), float(numbers.min()), float(numbers.max()))


def in_turns(tools: Mapping[str, Tool], rounds: int) -> dict[str, Floats]:
    """Return the seconds that each tool takes, shape (rounds,): all once for warming up, then round after round.

    Parameters
    ----------
    tools : mapping of str to callable
        What is timed; each call must do the same work.
    rounds : int
        How often.

    Notes
    -----
    The order changes from round to round: a tool finds the caches as the one before left them, and none should always
    come after the same.
    """
    for tool in tools.values():  # loads, compiles and fills caches
        tool()
    taken: dict[str, list[float]] = {name: [] for name in tools}
    orders = np.random.default_rng(0)
    with no_collection():
        for _ in range(rounds):
            for name in orders.permutation(list(tools)).tolist():
                taken[name].append(seconds(tools[name]))
    return {name: np.array(each) for name, each in taken.items()}


def seconds(tool: Tool) -> float:
    """Return the seconds that one call takes."""
    begun = perf_counter()
    tool()
    return perf_counter() - begun


@contextmanager
def no_collection() -> Iterator[None]:
    """Keep the garbage collector from running in the middle of a time, as ``timeit`` does."""
    was_on = gc.isenabled()
    gc.collect()
    gc.disable()
    try:
        yield
    finally:
        if was_on:
            gc.enable()
