"""Suite: 34 maps drawn like the paper's, with a scripted drive on each; and the paper's own 34.

Out: ``World`` by name: one shape of each kind alone, then ten maps each of two, three and four shapes; ``Route`` by
     the same names.

>>> suite = paper_suite()
>>> len(suite), list(suite)[3:5], suite["1-pentagon"].shapes[0].kind
(34, ['1-pentagon', '2-01'], 'pentagon')

Source: the paper tells how its maps were drawn, and the suite's are drawn alike; the numbers of its own are those of
the worlds that its authors Vaz, Costa and Campiao published (2024). Of its manual drives it tells the times alone: the
suite's were steered by a script, ``driving.scripted``, and by nobody.

Not here: how the files were made (``tests/shipped_data.py``).
"""

from __future__ import annotations

import csv
import json
from collections.abc import Iterable
from pathlib import Path

from ..shapes import PRIMITIVES
from ..world import World
from .maps import load_world
from .routes import Route, load_route

SUITE = (*(f"1-{kind}" for kind in PRIMITIVES), *(f"{n}-{k:02d}" for n in (2, 3, 4) for k in range(1, 11)))


def paper_suite() -> dict[str, World]:
    """Return the 34 bundled maps, from ``"1-circle"`` to ``"4-10"``, by name.

    Raises FileNotFoundError, as all of this module do, if the data are not where primkit is installed.

    >>> len(paper_suite()["4-10"].shapes)
    4
    """
    return _maps("maps", SUITE)


def published_suite() -> dict[str, World]:
    """Return the 34 worlds of the paper's own experiments, by the names in its authors' results.

    Their dimensions are whole centimetres. The property ``scored_as`` in the files is the rounded truth that the
    published code scores against; ``paper.published_values`` gives the same numbers.

    >>> suite = published_suite()
    >>> len(suite), list(suite)[:5]
    (34, ['1_circle', '1_pentagon', '1_quadrado', '1_triangulo', '2_circlecircle'])
    """
    return _maps("published/maps", dict.fromkeys(row["map"] for row in recorded_rows()))


def recorded_rows() -> list[dict[str, str]]:
    """Return the 68 rows that the paper's authors recorded, as they stand in the file: 34 maps, two movements.

    >>> recorded_rows()[0]["map"], recorded_rows()[0]["seconds"]
    ('1_circle', '10.03')
    """
    with (_data_folder() / "published" / "rows.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def bundled_keys() -> dict[str, str]:
    """Return the keys of a drive on each map of ``published_suite``, one letter for a tenth of a second.

    A rule pressed them, see ``driving.keyed``, and nobody.

    >>> bundled_keys()["1_circle"][:4]
    'AAAA'
    """
    keys: dict[str, str] = json.loads((_data_folder() / "published" / "keys.json").read_text(encoding="utf-8"))
    return keys


def scripted_drives() -> dict[str, Route]:
    """Return the 34 bundled drives: one on each map of ``paper_suite``, by its name, steered by a script.

    ``route.poses(world)`` is where the robot scans.

    >>> scripted_drives()["4-10"].poses(paper_suite()["4-10"]).shape[1]
    3
    """
    folder = _data_folder() / "drives"
    return {name: load_route(folder / f"{name}.json") for name in SUITE}


def _maps(folder: str, names: Iterable[str]) -> dict[str, World]:
    return {name: load_world(_data_folder() / folder / f"{name}.geojson") for name in names}


def _data_folder() -> Path:
    """Return the folder of the bundled data: inside the installed package, or beside it in a checkout."""
    package = Path(__file__).resolve().parents[1]
    for folder in (package / "data", package.parent / "data"):
        if (folder / "maps").is_dir():
            return folder
    raise FileNotFoundError(f"data/maps: must be in or beside {package}, got neither; install primkit again")
