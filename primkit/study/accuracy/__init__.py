"""Accuracy: how right each method is, against noise, shapes, scans, strays and partial views; the oracle beside it.

In:  settings by name, the sweeps' names, a number of maps, a seed.
Out: a ``Table`` for each sweep, which prints, shows as HTML and is written as CSV.

Its names are those of ``study``, which a user imports.
"""
