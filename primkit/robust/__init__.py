"""Robust: the estimator behind ``ROBUST``, from the points of a group to the shapes that could have caused them.

The engine: believe it, its tests hold it. It knows no grid, no LiDAR and no pipeline.

In:  the points of one group, shape (N, 2), metres, and how far they spread from outlines, metres.
Out: ``Candidate`` objects, the best explanation first; groups, split and merged.
"""
