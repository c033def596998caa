"""Study: many maps, many methods, in parallel; the paper's tables, and what the sensor allows, with ours beside them.

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
``oracle.py``      the best that any method can do from the same points
``row.py``         what became of one map with one method
``seen.py``        how much of each shape a drive has seen
``experiment.py``  one map, one method, one row
``journal.py``     rows written down one by one, so that a killed study continues
``many.py``        all of them, in parallel
``cluster.py``     on a cluster's workers
``table.py``       a table with intervals as text, HTML and CSV
``published.py``   the paper's figures, and the tables that put ours beside them
``estimate.py``    a figure with its 95 % interval
``manual.py``      how right the shapes are that a drive has seen
``sweeps.py``      what the accuracy study changes, in which steps
``accuracy.py``    how right each method is at each step, the oracle beside it
``wander.py``      random drives among the shapes
``scripted.py``    drives around one shape after the other
``views.py``       the shapes that a drive saw in part
``partial.py``     how right, and how honest, what was measured of them is
``together.py``    all of it, one after the other, and its files
=================  ==========================================================

Source: the paper's section 3.3, "Results".
"""

from ..driving.scripted import drives_on, scripted_route
from ..driving.wander import wander
from .accuracy.partial import PartialLine, PartialTable, run_partial
from .accuracy.sweeps import REMEDIES, SWEEPS, UNTUNED
from .accuracy.table import AccuracyLine, AccuracyTable, accuracy_as_csv, run_accuracy
from .accuracy.whole import accuracy_study
from .cluster import on_cluster
from .estimate import Estimate
from .experiment import Experiment, Run, perform, run
from .journal import JOURNAL, make_folder, n_rows
from .many import METHODS, maps_in, run_study
from .oracle import ORACLE, Oracle, oracle_fit, told_points
from .published import PUBLISHED, rows_as_csv, tables, write_tables
from .row import Row, Score
from .seen_shares import share_seen, shares_seen
from .seen_table import SeenLine, SeenTable, seen_table
from .table import Line, Table

__all__ = [
    "run_study",
    "on_cluster",
    "tables",
    "rows_as_csv",
    "write_tables",
    "Row",
    "Score",
    "Table",
    "Line",
    "METHODS",
    "PUBLISHED",
    "run_accuracy",
    "run_partial",
    "accuracy_study",
    "accuracy_as_csv",
    "AccuracyTable",
    "AccuracyLine",
    "PartialTable",
    "PartialLine",
    "Estimate",
    "SWEEPS",
    "REMEDIES",
    "UNTUNED",
    "ORACLE",
    "Oracle",
    "told_points",
    "oracle_fit",
    "wander",
    "scripted_route",
    "drives_on",
    "seen_table",
    "SeenTable",
    "SeenLine",
    "share_seen",
    "shares_seen",
    "Experiment",
    "Run",
    "run",
    "perform",
    "JOURNAL",
    "make_folder",
    "n_rows",
    "maps_in",
]
