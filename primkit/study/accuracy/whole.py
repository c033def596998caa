"""Whole: the accuracy study, one sweep after the other, and its files.

In:  names of sweeps, a number of maps, a folder.
Out: a table for each, as it is done; in the folder ``accuracy.csv``, ``partial.csv`` and the journal.

>>> list(accuracy_study([]))
[]
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path

from ...formats import StrPath, write_atomically
from ...pipeline import Settings
from ...table import Table
from ..many import METHODS
from .accuracy_table import accuracy_as_csv, run_accuracy
from .partial import run_partial
from .sweeps import SWEEPS

PARTIAL = "partial"
STUDIES = (*SWEEPS, PARTIAL)


def accuracy_study(
    sweeps: Iterable[str] | None = None,
    n_maps: int = 100,
    folder: StrPath | None = None,
    *,
    settings: Mapping[str, Settings] = METHODS,
    seed: int = 0,
    jobs: int | None = -1,
) -> Iterator[Table]:
    """Yield the table of each sweep as it is done; the files grow with it. What all tables share, the last one notes.

    Parameters
    ----------
    sweeps : iterable of str, optional
        Names in ``STUDIES``: those of ``SWEEPS``, and ``"partial"``; all when not given.
    n_maps : int
        Maps for each level; drives for the partial views.
    folder : str or path, optional
        Where journal and CSV are kept; it must be there. None is written when it is not given.
    settings, seed, jobs
        As for ``run_accuracy``.

    Raises
    ------
    ValueError
        If a name is another one, before anything is computed, or an argument is out of its range.
    """
    names = list(dict.fromkeys(STUDIES if sweeps is None else sweeps))
    for name in names:
        if name not in STUDIES:
            raise ValueError(f"each of the sweeps must be one of {', '.join(STUDIES)}, got {name!r}")
    last = next((name for name in reversed(names) if name != PARTIAL), None)
    made: list[Table] = []
    for name in names:
        if name == PARTIAL:
            views = run_partial(n_maps, seed=seed, jobs=jobs)
            _write(folder, views.file, views.csv())
            yield views
        else:
            table = run_accuracy(name, n_maps, settings=settings, seed=seed, folder=folder, jobs=jobs)
            made.append(table)
            _write(folder, table.file, accuracy_as_csv(made))
            yield table if name == last else replace(table, notes=table.notes[:1])


def _write(folder: StrPath | None, name: str, text: str) -> None:
    if folder is not None:
        write_atomically(Path(folder) / name, text)
