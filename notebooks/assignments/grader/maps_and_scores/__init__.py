"""Problem set 4, maps and scores: a compass that is off, a score by overlap, the cost of a map, an honest choice.

In:  the student's ``compass_bias``, ``overlap_score``, ``map_cost`` and ``honest_score``.
Out: marks.

====================  ===================================
``compass_bias.py``   the angle by which a compass is off
``overlap_score.py``  intersection over union, in pairs
``map_cost.py``       distances, misses and false alarms
``honest_score.py``   settings chosen on the other folds
====================  ===================================
"""

from .compass_bias import COMPASS_BIAS
from .honest_score import HONEST_SCORE
from .map_cost import MAP_COST
from .overlap_score import OVERLAP_SCORE

__all__ = ["COMPASS_BIAS", "OVERLAP_SCORE", "MAP_COST", "HONEST_SCORE"]
