"""Problem set 1, rays and grid: a curved wall, a sonar with a wide cone, a grid that counts.

In:  the student's ``ray_arc``, ``sonar_reading`` and ``busy_cells``.
Out: marks.

====================  ====================================
``ray_arc.py``        where a beam meets a curved wall
``sonar_reading.py``  the nearest echo in a wide cone
``busy_cells.py``     the cells of a grid with enough hits
====================  ====================================
"""

from .busy_cells import BUSY_CELLS
from .ray_arc import RAY_ARC
from .sonar_reading import SONAR_READING

__all__ = ["RAY_ARC", "SONAR_READING", "BUSY_CELLS"]
