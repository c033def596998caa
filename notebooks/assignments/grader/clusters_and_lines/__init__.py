"""Problem set 2, clusters and lines: one scan cut at its widest gaps, K-Medians, a wall in fog, two parallel walls.

In:  the student's ``cut_scan``, ``k_medians``, ``wall_in_fog`` and ``corridor``.
Out: marks.

==================  =======================================
``cut_scan.py``     one scan, cut at its widest gaps
``k_medians.py``    K-Means with city blocks and medians
``wall_in_fog.py``  the line with no hit behind it
``corridor.py``     bearing and width of two parallel walls
==================  =======================================
"""

from .corridor import CORRIDOR
from .cut_scan import CUT_SCAN
from .k_medians import K_MEDIANS
from .wall_in_fog import WALL_IN_FOG

__all__ = ["CUT_SCAN", "K_MEDIANS", "WALL_IN_FOG", "CORRIDOR"]
