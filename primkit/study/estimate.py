"""Estimate: a figure with its 95 % interval.

In:  one number for each map, or two of which the ratio counts.
Out: an ``Estimate``: the value, and between which ends it may as well lie.

>>> print(share_of(1.0, 100), share_of(0.5, 100), sep=", ")
1.000 (0.963-1.000), 0.500 (0.404-0.596)

Maps are the independent draws, not the shapes on them: what lies on one map is drawn together by the bootstrap. A share
of all or of nothing leaves the bootstrap nothing to draw from; Wilson's interval knows that n maps tell only so much.

Sources: Efron (1979), "Bootstrap methods: another look at the jackknife"; Wilson (1927), "Probable inference, the law
of succession, and statistical inference".
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..arguments import Floats

Z95 = 1.959964  # standard deviations on each side that hold 95 % of a Gaussian
RESAMPLES = 5000  # the ends of an interval then differ by about a hundredth of its width from draw to draw
COUNTS_AT_ONCE = 1_000_000  # counts drawn at once: 8 MB, however many maps there are


@dataclass(frozen=True)
class Estimate:
    """A value with the ends of its 95 % interval; None where a single map tells none."""

    value: float
    low: float | None = None
    high: float | None = None

    def text(self, digits: int = 3) -> str:
        """Return the value and its interval in brackets."""
        value = f"{self.value:.{digits}f}"
        if self.low is None or self.high is None:
            return value
        return f"{value} ({self.low:.{digits}f}-{self.high:.{digits}f})"

    def __str__(self) -> str:
        return self.text()


def columns_of(names: Iterable[str]) -> list[str]:
    """Return the columns of a CSV for estimates with these names: value, low and high of each.

    >>> columns_of(["kind"])
    ['kind', 'kind_low', 'kind_high']
    """
    return [f"{name}{end}" for name in names for end in ("", "_low", "_high")]


def in_columns(estimates: Iterable[Estimate | None]) -> list[float | None]:
    """Return the numbers for these columns; None for an estimate that is none."""
    return [n for e in estimates for n in ((None,) * 3 if e is None else (e.value, e.low, e.high))]


def means_of(values: ArrayLike) -> tuple[Estimate, ...]:
    """Return the mean of each column, shape (N, Q): a row for each map; the interval is the bootstrap over rows.

    >>> print(*means_of([[0.0, 1.0], [1.0, 1.0]] * 8))
    0.500 (0.250-0.750) 1.000 (1.000-1.000)
    """
    rows = np.asarray(values, dtype=float)
    if len(rows) == 1:
        return tuple(map(Estimate, rows[0].tolist()))
    ends = np.percentile(resampled_means(rows), (2.5, 97.5), axis=0)
    return tuple(Estimate(*three) for three in np.column_stack([rows.mean(axis=0), *ends]).tolist())


def mean_of(values: ArrayLike) -> Estimate:
    """Return the mean of one number for each map, as ``means_of``.

    >>> print(mean_of([1.0, 0.0] * 8), mean_of([0.3]), sep=", ")
    0.500 (0.250-0.750), 0.300
    """
    return means_of(np.reshape(values, (-1, 1)))[0]


def share_of(share: float, n: int) -> Estimate:
    """Return a share of n independent draws, with Wilson's interval.

    >>> print(share_of(0.0, 10))
    0.000 (0.000-0.278)
    """
    middle = share + Z95**2 / (2 * n)
    unsure = Z95 * np.sqrt(share * (1 - share) / n + (Z95 / (2 * n)) ** 2)
    low, high = (float((middle + side * unsure) / (1 + Z95**2 / n)) for side in (-1, 1))
    return Estimate(share, max(0.0, low), min(1.0, high))


def ratio_of(over: ArrayLike, under: ArrayLike, *, root: bool = False) -> Estimate:
    """Return the ratio of two sums over maps, or its root; the interval is the percentile bootstrap over maps.

    Parameters
    ----------
    over, under : array_like, shape (N,)
        What each map adds to the sums; that below must not be zero on all of them.
    root : bool
        Return the root of the ratio: the ratio of two root mean squares, when these are sums of squares.

    Examples
    --------
    >>> print(ratio_of([4.0, 4.0], [1.0, 1.0], root=True))
    2.000 (2.000-2.000)
    """
    sums = np.column_stack([np.asarray(over, dtype=float), np.asarray(under, dtype=float)])
    power = 0.5 if root else 1.0
    value = float((sums[:, 0].sum() / sums[:, 1].sum()) ** power)
    if len(sums) == 1:
        return Estimate(value)
    drawn = resampled_means(sums)
    drawn = drawn[drawn[:, 1] > 0]
    low, high = np.percentile((drawn[:, 0] / drawn[:, 1]) ** power, (2.5, 97.5))
    return Estimate(value, float(low), float(high))


def pooled_share(right: ArrayLike, total: ArrayLike) -> Estimate | None:
    """Return the share of right ones among all on all maps; None when there are none.

    The bootstrap over maps gives the interval, or Wilson's for as many draws as there are maps, where all or none
    are right.

    Examples
    --------
    >>> print(pooled_share([3, 0], [3, 2]), pooled_share([3, 2], [3, 2]), sep=", ")
    0.600 (0.000-1.000), 1.000 (0.342-1.000)
    >>> pooled_share([0, 0], [0, 0]) is None
    True
    """
    rights, totals = np.asarray(right, dtype=float), np.asarray(total, dtype=float)
    if totals.sum() == 0:
        return None
    share = float(rights.sum() / totals.sum())
    if share in (0.0, 1.0):
        return share_of(share, int((totals > 0).sum()))
    return ratio_of(rights, totals)


def resampled_means(values: Floats) -> Floats:
    """Return each column's mean over rows drawn with replacement, as often as the bootstrap asks for.

    The same rows are drawn for all columns of one draw, so that what is computed from several means belongs together.

    Parameters
    ----------
    values : array, shape (N, Q)
        One row for each map.

    Returns
    -------
    array, shape (5000, Q)
    """
    n = len(values)
    rng = np.random.default_rng(0)  # fixed: the same rows give the same table
    step = max(1, COUNTS_AT_ONCE // n)
    means = [
        rng.multinomial(n, np.full(n, 1 / n), size=min(step, RESAMPLES - start)) @ values / n
        for start in range(0, RESAMPLES, step)
    ]
    return np.vstack(means)
