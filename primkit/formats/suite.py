"""Suite: the paper's 34 maps, as files, the seeds they were drawn from, and a scripted drive on each.

Out: ``World`` by name: one shape of each kind alone, then ten maps each of two, three and four shapes; ``Route`` by
     the same names.

>>> suite = paper_suite()
>>> len(suite), list(suite)[3:5], suite["1-pentagon"].shapes[0].kind
(34, ['1-pentagon', '2-01'], 'pentagon')

Source: the paper names the number of its maps and how they were drawn, and not the maps: these are drawn alike. Of
its manual drives it tells the times alone: these were steered by a script, ``study.scripted_route``, and by nobody.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ..shapes import PRIMITIVES, Kind
from ..world import World, random_world
from .maps import load_world
from .routes import Route, load_route

SUITE_SEED = 34  # any number would do


def paper_suite() -> dict[str, World]:
    """Return the 34 bundled maps.

    Returns
    -------
    dict of str to World
        ``"1-circle"``, ``"1-triangle"``, ``"1-rectangle"``, ``"1-pentagon"``, ``"2-01"`` to ``"4-10"``, in
        this order.

    Raises
    ------
    FileNotFoundError
        If the maps are not where primkit is installed.

    Examples
    --------
    >>> len(paper_suite()["4-10"].shapes)
    4
    """
    folder = _data_folder() / "maps"
    return {name: load_world(folder / f"{name}.geojson") for name in _suite_plan()}


def scripted_drives() -> dict[str, Route]:
    """Return the 34 bundled drives: one on each map of ``paper_suite``, steered by a script.

    Returns
    -------
    dict of str to Route
        By the names of the maps, in their order; ``route.poses(world)`` is where the robot scans.

    Raises
    ------
    FileNotFoundError
        If the drives are not where primkit is installed.

    Examples
    --------
    >>> scripted_drives()["4-10"].poses(paper_suite()["4-10"]).shape[1]
    3
    """
    folder = _data_folder() / "drives"
    return {name: load_route(folder / f"{name}.json") for name in _suite_plan()}


def make_paper_suite() -> dict[str, World]:
    """Return the 34 maps freshly drawn from their fixed seeds, as they were when their files were written.

    Examples
    --------
    >>> make_paper_suite()["1-circle"].shapes[0].kind
    'circle'
    """
    # NumPy may draw other numbers from a seed in a later version, so the files are the truth and this tells
    # how they came about. Map number k has a seed of its own: changing one map leaves the others alone.
    return {
        name: random_world(n, kinds=kinds, rng=np.random.default_rng([SUITE_SEED, number]))
        for number, (name, (n, kinds)) in enumerate(_suite_plan().items(), start=1)
    }


def _suite_plan() -> dict[str, tuple[int, list[Kind] | None]]:
    """Return the name of each map with its number of shapes and their kinds (None: drawn)."""
    plan: dict[str, tuple[int, list[Kind] | None]] = {f"1-{kind}": (1, [kind]) for kind in PRIMITIVES}
    return plan | {f"{n}-{number:02d}": (n, None) for n in (2, 3, 4) for number in range(1, 11)}


def _data_folder() -> Path:
    """Return the folder of the bundled data: inside the installed package, or beside it in a checkout."""
    package = Path(__file__).resolve().parents[1]
    for folder in (package / "data", package.parent / "data"):
        if (folder / "maps").is_dir():
            return folder
    raise FileNotFoundError(f"data/maps: must be in or beside {package}, got neither; install primkit again")
