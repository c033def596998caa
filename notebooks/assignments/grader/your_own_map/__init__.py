"""The capstone, your own map: a pipeline on the student's own scans, and a hunt for three bugs.

In:  the student's ``my_shapes`` and ``measure_pillars``.
Out: marks.

======================  =====================================
``my_shapes.py``        a pipeline on the student's own scans
``measure_pillars.py``  a function with three bugs, mended
======================  =====================================
"""

from .measure_pillars import MEASURE_PILLARS
from .my_shapes import MY_SHAPES

__all__ = ["MY_SHAPES", "MEASURE_PILLARS"]
