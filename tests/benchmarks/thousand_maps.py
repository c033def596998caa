"""A thousand personal maps: no two alike, and the reference right on each.

    python -m tests.benchmarks.thousand_maps [N]

It prints the least and the mean weighted accuracy at 5 mm, and how near the two most alike maps come.
"""

import sys
import time
from collections import Counter

import numpy as np
from scipy.spatial.distance import pdist

import primkit as pk
from primkit.course.personal import personal_scans

SALT = "the salt of this measurement"


def numbers(world):
    """Return a board as 19 numbers in metres: for each kind its centre, then its dimensions, sorted."""
    shapes = sorted(world.shapes, key=lambda shape: shape.kind)
    return np.concatenate([[*shape.centroid, *sorted(shape.dimensions)] for shape in shapes])


def accuracy(world):
    """Return the reference's weighted accuracy at 5 mm on the scans of a board."""
    grid = pk.Grid(resolution=0.001)
    grid.add(personal_scans(world))
    return pk.evaluate(pk.find_shapes(grid.points(), rng=0), world, tolerance=0.005).weighted_accuracy


def main(n):
    start = time.perf_counter()
    worlds = [pk.personal_world(f"student-{k:04d}", salt=SALT) for k in range(n)]
    apart = pdist(np.array([numbers(world) for world in worlds]), "chebyshev")
    print(f"{n} maps; the two most alike differ by {1000 * apart.min():.1f} mm in the number that differs most")
    right = np.array([accuracy(world) for world in worlds])
    print(f"weighted accuracy at 5 mm: least {right.min():.4f}, mean {right.mean():.5f}")
    print(f"how often: {dict(sorted(Counter(right.round(4).tolist()).items()))}")
    print(f"{time.perf_counter() - start:.0f} s")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 1000)
