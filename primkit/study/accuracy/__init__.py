"""Accuracy: how right each method is, against noise, shapes, scans, strays and partial views; the oracle beside it.

In:  settings by name, the sweeps' names, a number of maps, a seed.
Out: ``AccuracyTable`` and ``PartialTable``, which print, show as HTML and are written as CSV.
"""

from .accuracy_table import AccuracyLine, AccuracyTable, accuracy_as_csv, run_accuracy
from .partial import PartialLine, PartialTable, run_partial
from .sweeps import REMEDIES, SWEEPS, UNTUNED
from .whole import accuracy_study

__all__ = [
    "run_accuracy",
    "run_partial",
    "accuracy_study",
    "accuracy_as_csv",
    "AccuracyTable",
    "AccuracyLine",
    "PartialTable",
    "PartialLine",
    "SWEEPS",
    "REMEDIES",
    "UNTUNED",
]
