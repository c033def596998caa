"""Robust: the estimator behind ``ROBUST``, from the points of a group to the shapes that could have caused them.

The engine: believe it, its tests hold it. It knows no grid, no LiDAR and no pipeline.

In:  the points of one group, shape (N, 2), metres, and how far they spread from outlines, metres.
Out: ``Candidate`` objects, the best explanation first; groups, split and merged.

Legend, for all rooms of this wing; lengths are metres, angles radians:

    points   shape (N, 2); where one cluster's figures are fitted, around the origin
    spread   standard deviation of the points from the outlines that they lie on
    figure   a ``Circle``; ``Outlines`` of one row; or the ``Line`` of a bare wall
    square   whether four sides are fitted with right angles
    soft     whether points are shared between sides in the last polish, as ``refine_soft`` does
    kinds    the kinds that can be there
    scans    shape (N,): the number of the scan that saw each point, from 1; 0 where it is not known
"""
