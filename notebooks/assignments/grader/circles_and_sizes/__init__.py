"""Problem set 3, circles and measuring: a pipe of known radius, a hexagon from six lines, its name, a radius's error.

In:  the student's ``pipe_center``, ``hexagon_corners``, ``nut_or_coin`` and ``radius_std``.
Out: marks.

======================  =======================================
``pipe_center.py``      the centre of a pipe of known radius
``hexagon_corners.py``  the corners of a hexagon from six lines
``nut_or_coin.py``      a hexagon or a circle, by the spread
``radius_std.py``       how sure a fitted radius is
======================  =======================================
"""

from .hexagon_corners import HEXAGON_CORNERS
from .nut_or_coin import NUT_OR_COIN
from .pipe_center import PIPE_CENTER
from .radius_std import RADIUS_STD

__all__ = ["PIPE_CENTER", "HEXAGON_CORNERS", "NUT_OR_COIN", "RADIUS_STD"]
