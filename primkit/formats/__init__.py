"""Formats: maps, results, scans and drives, to files and back.

Beside the story: every noun can be put on the shelf between two steps, and what is read back is equal to the last bit.

In:  a ``World``, what was found (``Found``), ``Scans`` or a ``Drive``; a file's name.
Out: GeoJSON (``.geojson``, ``.json``) for worlds and what was found, compressed NumPy arrays (``.npz``) for scans, JSON
     Lines (``.jsonl``) for drives, JSON (``.json``) for the ways they went. Recordings of robots are read, too.

>>> import tempfile
>>> from primkit.world import random_world
>>> world = random_world(4, rng=7)
>>> with tempfile.TemporaryDirectory() as folder:
...     save_world(world, f"{folder}/map.geojson")
...     load_world(f"{folder}/map.geojson") == world
True

A file is written whole or not at all, apart from a drive's journal, which grows scan by scan. A file that is not what
it says is refused in one sentence that begins with its name, and takes no more memory than a multiple of its size.
"""

from .drives import Drive, DriveJournal, load_drive, record_drive, save_drive
from .files import StrPath, write_atomically
from .found_maps import load_found, save_found
from .maps import MAP_ENDINGS, MAP_LIMIT, load_world, save_world
from .routes import Route, load_route, save_route
from .scans import SCANS_LIMIT, load_scans, save_scans
from .suite import bundled_keys, paper_suite, published_suite, recorded_rows, scripted_drives

__all__ = ["load_world", "save_world", "load_found", "save_found", "load_scans", "save_scans"]
__all__ += ["MAP_ENDINGS", "MAP_LIMIT", "SCANS_LIMIT"]
__all__ += ["paper_suite", "published_suite", "recorded_rows", "bundled_keys", "scripted_drives"]
__all__ += ["Drive", "DriveJournal", "record_drive", "save_drive", "load_drive"]
__all__ += ["Route", "save_route", "load_route", "write_atomically", "StrPath"]
