"""Partial: what is measured of shapes that a driving robot sees in part.

In:  a number of drives, the sensor's noise, a seed.
Out: a ``Table``: how right the measured dimensions are, whether an unseen one is claimed to be measured, and
whether the stated standard deviations are true.

>>> table = run_partial(2, noises=(0.0,), jobs=1)
>>> table.lines[0].n_drives, table.lines[0].n_claimed
(2, 0)

What was seen, and what hangs on it, the truth decides: see ``views.py``. No journal is kept: a drive takes a fraction
of a second to map.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, fields

import numpy as np

from ...arguments import ROUNDING, Floats, as_count, as_positive
from ...table import Table
from ..estimate import Z95, Estimate, columns_of, in_columns, pooled_share
from ..many import checked_jobs, in_parallel
from .accuracy_table import COARSE
from .drive_views import DRIVING_GAP, N_SCANS, N_SHAPES, View, views_from
from .sweeps import UNTUNED

PARTIAL_NOISES = (0.0, 0.001, 0.002, 0.005)  # m

PARTIAL_HEADER = (
    *("", "n", "right kind", "n", "if all sides were seen"),
    *("n", "visible and measured", "n", "hidden, but claimed"),
    *("n", "right within 5 mm", "wrong kinds too", "within 1.96 std"),
)


@dataclass(frozen=True)
class PartialLine:
    """All drives with one range noise.

    Parameters
    ----------
    noise_std : float
        Of the ranges, metres.
    n_drives : int
        How many drives.
    n_shapes, n_whole : int
        How many shapes were seen in part, and how many of these on all their sides.
    n_visible, n_hidden, n_measured : int
        Dimensions of the shapes with the right kind: how many hang on seen sides only, how many on one that was never
        seen, and how many the method says that it measured.
    kind, whole : Estimate, optional
        Share of the shapes with the right kind: of all, and of those seen on all sides. Here and below None where
        there is nothing to take a share of.
    found, claimed : Estimate, optional
        Share of the visible dimensions, and of the hidden ones, that are said to be measured.
    right : Estimate, optional
        Share of the measured dimensions within 5 mm.
    strict : Estimate, optional
        The same, with all that was measured of shapes of a wrong kind counted as wrong.
    covered : Estimate, optional
        Share of the measured dimensions whose error is at most 1.96 stated standard deviations.
    n_claimed : int
        How many hidden dimensions are said to be measured.
    """

    noise_std: float
    n_drives: int
    n_shapes: int
    n_whole: int
    n_visible: int
    n_hidden: int
    n_measured: int
    n_claimed: int
    kind: Estimate | None
    whole: Estimate | None
    found: Estimate | None
    claimed: Estimate | None
    right: Estimate | None
    strict: Estimate | None
    covered: Estimate | None

    def cells(self) -> tuple[str, ...]:
        """Return the line as texts: kinds, what was measured, how right that is."""
        kinds = (str(self.n_shapes), _text(self.kind), str(self.n_whole), _text(self.whole))
        found = (str(self.n_visible), _text(self.found), str(self.n_hidden), _text(self.claimed))
        right = (str(self.n_measured), _text(self.right), _text(self.strict), _text(self.covered))
        return (f"{1000 * self.noise_std:g} mm", *kinds, *found, *right)


def run_partial(
    n_drives: int = 100,
    *,
    noises: Iterable[float] = PARTIAL_NOISES,
    seed: int = 0,
    jobs: int | None = -1,
    progress: bool = True,
) -> Table:
    """Drive among shapes, and say how right what was measured of those seen in part is: lines are ``PartialLine``.

    Parameters
    ----------
    n_drives : int
        Drives of 60 scans, each on a map of its own with four free shapes and gaps of 10 cm.
    noises : iterable of float
        Standard deviations of the ranges, metres; the drives are the same for all.
    seed : int
        Other seeds draw other drives; the same seed gives the same table.
    jobs : int, optional
        Number of processes; -1 for one on each core.
    progress : bool
        Show a progress bar on stderr, when that is a terminal.

    Raises
    ------
    ValueError
        If an argument is out of its range.
    """
    n_drives, seed = as_count(n_drives, "n_drives"), as_count(seed, "seed", least=0)
    levels = [as_positive(noise, "each of the noises", zero=True) for noise in noises]
    work = [(noise, number, seed) for noise in levels for number in range(n_drives)]
    done = in_parallel(views_from, work, jobs=checked_jobs(jobs), progress=progress, unit="drive")
    lines = [
        partial_line(noise, n_drives, [view for views in done[i * n_drives : (i + 1) * n_drives] for view in views])
        for i, noise in enumerate(levels)
    ]
    return partial_table(lines, _notes(n_drives, seed))


def partial_table(lines: Sequence[PartialLine], notes: Sequence[str] = ()) -> Table:
    """Return lines as a table: kinds, what was measured, how right that is.

    Its CSV has all numbers: shares from 0 to 1, noise in metres.
    """
    drives = " or ".join(dict.fromkeys(str(line.n_drives) for line in lines))
    rows = [(f"range noise, {drives} drives",), *(line.cells() for line in lines)]
    names = [field.name for field in fields(PartialLine)]  # the noise, seven counts, and estimates
    values = [list(vars(line).values()) for line in lines]
    numbers = [(*own[:8], *in_columns(own[8:])) for own in values]
    return Table(
        PARTIAL_HEADER,
        rows,
        "Partial views: random drives that see 40 to 90 % of each outline",
        tuple(notes),
        folds=(5, 9),
        lines=tuple(lines),
        numbers=[("noise_std_m", *names[1:8], *columns_of(names[8:])), *numbers],
        file="partial.csv",
    )


def partial_line(noise_std: float, n_drives: int, views: Sequence[View]) -> PartialLine:
    """Return the shares over all views at one noise; drives are the independent draws."""
    sums = np.zeros((n_drives, len(VIEW_COUNTS)))
    for view in views:
        sums[view.drive] += _counted(view)
    of = dict(zip(VIEW_COUNTS, sums.T, strict=True))
    return PartialLine(
        noise_std=noise_std,
        n_drives=n_drives,
        **{
            f"n_{name}": int(of[name].sum()) for name in ("shapes", "whole", "visible", "hidden", "measured", "claimed")
        },
        kind=pooled_share(of["kind"], of["shapes"]),
        whole=pooled_share(of["whole_kind"], of["whole"]),
        found=pooled_share(of["found"], of["visible"]),
        claimed=pooled_share(of["claimed"], of["hidden"]),
        right=pooled_share(of["right"], of["measured"]),
        strict=pooled_share(of["right"], of["measured"] + of["strays"]),
        covered=pooled_share(of["covered"], of["measured"]),
    )


# What is counted of each view; strays are dimensions said to be measured of a shape of a wrong kind.
VIEW_COUNTS = (
    *("shapes", "kind", "whole", "whole_kind", "strays"),
    *("visible", "found", "hidden", "claimed", "measured", "right", "covered"),
)


def _counted(view: View) -> Floats:
    """Return what one view adds to each of ``VIEW_COUNTS``."""
    kind, measured = view.kind_right, np.array(view.measured, dtype=bool)
    first = (True, kind, view.whole, view.whole and kind, 0 if kind else measured.sum())
    if not kind:
        return np.array([*first, *7 * [0]], dtype=float)
    error, std, hidden = np.abs(view.errors), np.array(view.stds), np.array(view.hidden)
    right, covered = measured & (error <= COARSE + ROUNDING), measured & (error <= Z95 * std)
    flags = (~hidden, ~hidden & measured, hidden, hidden & measured, measured, right, covered)
    return np.array([*first, *(f.sum() for f in flags)], dtype=float)


def _text(estimate: Estimate | None) -> str:
    return "-" if estimate is None else str(estimate)


def _notes(n_drives: int, seed: int) -> tuple[str, ...]:
    return (
        f"{n_drives} maps with {N_SHAPES} free shapes, gaps of {100 * DRIVING_GAP:g} cm; on each a smooth random drive "
        f"of {N_SCANS} scans that keeps 4 cm from outlines. ROBUST is told nothing.",
        "right kind: share of the shapes that were found as what they are. A side that was never seen may leave nobody "
        "able to tell: beside it stand the shapes of which all sides were seen.",
        "All below is about dimensions of shapes with the right kind. visible: each side that the dimension hangs on "
        "has an exact hit on its inner four fifths; else hidden. claimed: said to be measured.",
        "right within 5 mm: of all that is said to be measured. wrong kinds too: whatever was measured of a shape of a "
        "wrong kind counts as wrong.",
        "within 1.96 std: share of the measured dimensions whose error is at most 1.96 of the stated standard "
        "deviations; 0.95 where these are true.",
        "In brackets: 95 % interval over the drives (bootstrap; Wilson's where all or none are).",
        f"Drives and noise are drawn from {UNTUNED} and {seed}; nothing was tuned on them.",
    )
