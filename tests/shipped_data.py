"""Shipped data: how data/maps, data/drives and data/published/keys.json were made; the tests hold the files against it.

The files are the truth: NumPy does not promise the same numbers in later versions. Should they ever have to be written
anew: ``python -m tests.shipped_data``, in the project's folder.
"""

import json
from pathlib import Path

import numpy as np

from primkit.driving.keyed import press_keys
from primkit.driving.scripted import scripted_route
from primkit.formats import paper_suite, published_suite, save_route, save_world
from primkit.formats.suite import SUITE
from primkit.world import random_world

DATA = Path(__file__).resolve().parent.parent / "data"
SEED = 34  # any number would do; each map and each drive draws from its own


def make_map(name):
    """Draw a map of the suite anew: as many shapes as its name says, a single one of the kind that it names."""
    n, _, kind = name.partition("-")
    rng = np.random.default_rng([SEED, SUITE.index(name) + 1])
    return random_world(int(n), kinds=[kind] if n == "1" else None, rng=rng)


def make_drive(name):
    """Steer the drive on a map of the suite anew; one more number in the seed: no draw of it is one of the map."""
    return scripted_route(paper_suite()[name], rng=np.random.default_rng([SEED, SUITE.index(name) + 1, 1]))


def make_keys(name):
    """Press the keys on a map of the paper anew."""
    suite = published_suite()
    return press_keys(suite[name], rng=np.random.default_rng([SEED, list(suite).index(name) + 1, 2]))


if __name__ == "__main__":
    for each in SUITE:
        save_world(make_map(each), DATA / "maps" / f"{each}.geojson")
        save_route(make_drive(each), DATA / "drives" / f"{each}.json")
    keys = {each: make_keys(each) for each in published_suite()}
    (DATA / "published" / "keys.json").write_text(json.dumps(keys, indent=1) + "\n")
