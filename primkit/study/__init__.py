"""Study: many maps, many methods, in parallel; the paper's tables, and what the sensor allows, with ours beside them.

Beside the story: one map tells what a method can do, many tell how often.

In:  worlds, settings by name, the sensor, a seed.
Out: a ``Row`` for each map and method; from them a ``Table``, which prints, shows as HTML and is written as CSV.

>>> from primkit.pipeline import ROBUST
>>> from primkit.world import random_world
>>> rows = run_study([random_world(2, rng=seed) for seed in (0, 1)], {"ROBUST": ROBUST}, jobs=1)
>>> [table.title for table in tables(rows)]
['Table 2. Several shapes, automatic movement']

``repeat`` repeats the paper's experiments, ``published`` puts what
was recorded beside them, ``seen_table`` counts what a drive saw, ``accuracy/`` changes one thing at a time. Not here:
the drives (``driving``), the pictures (``plots``).

Source: the paper's section 3.3, "Results".
"""

from ..driving.scripted import drives_on, scripted_route
from ..driving.wander import wander
from .accuracy.accuracy_table import AccuracyLine, accuracy_as_csv, run_accuracy
from .accuracy.partial import PartialLine, run_partial
from .accuracy.sweeps import REMEDIES, SWEEPS, UNTUNED
from .accuracy.whole import accuracy_study
from .cluster import on_cluster
from .estimate import Estimate, mean_of, share_of
from .experiment import Experiment, Run, perform, run
from .journal import JOURNAL, make_folder, n_rows
from .many import METHODS, maps_in, run_study
from .oracle import ORACLE, Oracle, oracle_fit, shares_seen, told_points
from .paper_table import Line
from .published import PUBLISHED, Recorded, agrees, row_table, rows_as_csv, tables, write_tables
from .repeat import repeat_study
from .row import Row, Score
from .seen_table import seen_table

__all__ = ["run_study", "on_cluster", "METHODS", "maps_in", "Experiment", "run", "Run", "perform", "Row", "Score"]
__all__ += ["repeat_study", "agrees", "row_table", "Recorded"]
__all__ += ["tables", "Line", "PUBLISHED", "rows_as_csv", "write_tables"]
__all__ += ["Estimate", "mean_of", "share_of", "JOURNAL", "make_folder", "n_rows"]
__all__ += ["ORACLE", "Oracle", "told_points", "oracle_fit", "shares_seen"]
__all__ += ["seen_table"]
__all__ += ["accuracy_study", "run_accuracy", "AccuracyLine", "accuracy_as_csv"]
__all__ += ["run_partial", "PartialLine", "SWEEPS", "REMEDIES", "UNTUNED"]
__all__ += ["wander", "scripted_route", "drives_on"]
