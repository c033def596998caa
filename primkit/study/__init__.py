"""Study: many maps, many methods, in parallel; the paper's Tables 1 to 4 with ours beside them.

Beside the story: one map tells what a method can do, many tell how often.

In:  worlds, settings by name, the sensor, a seed.
Out: a ``Row`` for each map and method; from them ``Table``, which prints, shows as HTML and is written as CSV.

>>> from primkit.pipeline import ROBUST
>>> from primkit.world import random_world
>>> rows = run_study([random_world(2, rng=seed) for seed in (0, 1)], {"ROBUST": ROBUST}, jobs=1)
>>> [table.title for table in tables(rows)]
['Table 2. Several shapes, automatic movement']

The rooms, each of which imports only those before it:

=================  ==========================================================
``experiment.py``  one map, one method, one row
``journal.py``     rows written down one by one, so that a killed study continues
``many.py``        all of them, in parallel
``table.py``       a table with intervals as text, HTML and CSV
``published.py``   the paper's figures, and the tables that put ours beside them
=================  ==========================================================

Source: the paper's section 3.3, "Results".
"""

from .experiment import Experiment, Row, Run, Score, perform, run
from .journal import JOURNAL, make_folder
from .many import METHODS, run_study
from .published import PUBLISHED, rows_as_csv, tables
from .table import Line, Table

__all__ = [
    "run_study",
    "tables",
    "rows_as_csv",
    "Row",
    "Score",
    "Table",
    "Line",
    "METHODS",
    "PUBLISHED",
    "Experiment",
    "Run",
    "run",
    "perform",
    "JOURNAL",
    "make_folder",
]
