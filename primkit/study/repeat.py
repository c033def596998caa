"""Repeat: the paper's experiments on its own 34 worlds, and beside them what they would have shown.

In:  the movements, a seed.
Out: rows, three for each map and movement: ``PAPER`` on the rendered sensor, as it was published; ``PAPER`` and
     ``ROBUST`` on exact rays, where a fair scoring tells what the methods can do.

>>> rows = repeat_study(names=["1_circle"], jobs=1)
>>> [(row.settings, row.sensor, row.paper.weighted) for row in rows]
[('PAPER', 'webots', 1.0), ('PAPER', 'exact', 1.0), ('ROBUST', 'exact', 1.0)]
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import partial

from ..driving.keyed import published_drives
from ..formats import StrPath, published_suite
from ..lidar import Lidar
from ..pipeline import Settings
from .many import METHODS, run_study
from .row import Movement, Row

THEIRS = Lidar(model="webots")


def repeat_study(
    movements: Sequence[Movement] = ("automatic",),
    *,
    names: Iterable[str] | None = None,
    settings: Mapping[str, Settings] = METHODS,
    seed: int = 0,
    folder: StrPath | None = None,
    jobs: int | None = -1,
    progress: bool = True,
) -> list[Row]:
    """Repeat the published experiments, and map the same worlds on exact rays.

    Parameters
    ----------
    movements : sequence of {"automatic", "manual"}
        Set down on way-points, or along the bundled drives; see ``driving.keyed``.
    names : iterable of str, optional
        Of the maps; all 34 when not given.
    settings : dict of str to Settings
        The methods on exact rays; with ``"PAPER"`` among them, the published experiment comes first.
    seed, folder, jobs, progress
        As for ``run_study``.
    """
    suite, drives = published_suite(), published_drives()
    worlds = {name: suite[name] for name in (suite if names is None else names)}
    run = partial(run_study, worlds, seed=seed, folder=folder, jobs=jobs, progress=progress)
    rows: list[Row] = []
    for movement in movements:
        way = drives if movement == "manual" else None
        if "PAPER" in settings:
            rows += run({"PAPER": settings["PAPER"]}, lidar=THEIRS, drives=way)
        rows += run(settings, drives=way)
    return rows
