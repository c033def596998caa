"""Bench: how fast primkit is, beside the tools that one would take instead.

Beside the story: the same work by several tools, in turns in one run, as ratios with their spread.

In:  ``python -m tests.benchmarks``, or the name of a benchmark, an ``Effort`` and a seed.
Out: a ``Result``: a table as text, and rows for CSV; for the sizes also a figure.

>>> from tests.benchmarks.bench.effort import QUICK
>>> QUICK.rounds
2

The other tools are no part of the classroom: ``pip install -e ".[peers]"`` gets them, and one that is not there is
named as absent. Figures depend on the machine; ratios, taken within each round, much less so.

The rooms, each of which imports only those before it:

================  ============================================================
``clock.py``      taking turns, medians and spreads
``results.py``    rows, as a table and as CSV
``machine.py``    what it all ran on, and which peers are there
``effort.py``     how much is measured, in full and quickly
``loops.py``      brute-force ray casting, for numba
``casters.py``    the loops and shapely as ray casters
``others.py``     what needs more: numba, ir-sim, the paper's chain of libraries
``scanning.py``   scans beside the others, and on larger boards
``finding.py``    shapes, lines and circles beside the others
``driving.py``    scan, grid and shapes while driving
``processes.py``  import, memory, and a study on two processes
``command.py``    ``python -m tests.benchmarks``
================  ============================================================
"""
