"""What the README promises of accuracy, held on maps that nothing was tuned on.

Every figure is printed beside the oracle's (see primkit/study/oracle.py): ``pytest tests/test_accuracy.py -s``.
"""

from dataclasses import replace

import numpy as np
import pytest

import primkit as pk
from primkit.study.oracle import oracle_fit, told_points


def compare(worlds, seed=0, **sensor):
    """Return the reports of ROBUST and of the oracle for each world, at 5 mm."""
    ours, oracles = [], []
    for number, world in enumerate(worlds):
        lidar = pk.Lidar(**sensor)
        scans = pk.scan(world, pk.teleport_poses(world), lidar, rng=[seed, number])
        points, owners = told_points(world, scans, lidar)
        ours.append(pk.evaluate(pk.find_shapes(points, rng=0), world))
        oracles.append(pk.evaluate([s for s in oracle_fit(world, points, owners) if s is not None], world))
    return ours, oracles


def mean(reports):
    return float(np.mean([r.weighted_accuracy for r in reports]))


def rms(reports):
    errors = [[*m.center_error, *(m.dimension_error or ())] for r in reports for m in r.matches]
    return float(np.sqrt(np.mean(np.concatenate(errors) ** 2)))


def shown(name, ours, oracles):
    n = len(ours)
    print(f"\n{name}: n = {n}, weighted {mean(ours):.4f} (oracle {mean(oracles):.4f}), ", end="")
    print(f"rms error {1000 * rms(ours):.3f} mm (oracle {1000 * rms(oracles):.3f} mm)")
    return mean(ours)


def test_robust_on_the_suite():
    ours, oracles = compare(pk.paper_suite().values())
    assert shown("suite", ours, oracles) >= 0.99
    assert all(r.count_right for r in ours)
    assert rms(ours) <= 1.15 * rms(oracles)


def test_robust_on_the_suite_with_noise():
    ours, oracles = compare(pk.paper_suite().values(), noise_std=0.002)
    assert shown("suite, 2 mm noise", ours, oracles) >= 0.99
    assert rms(ours) <= 1.15 * rms(oracles)


@pytest.mark.parametrize(("gap", "spurious", "least"), [(0.05, 0.0, 0.97), (0.05, 0.02, 0.97), (0.03, 0.0, 0.97)])
def test_robust_on_free_maps(gap, spurious, least):
    worlds = [pk.random_world(1 + number % 6, style="free", gap=gap, rng=[2026, number]) for number in range(40)]
    ours, oracles = compare(worlds, spurious=spurious)
    assert shown(f"free maps, gaps {gap} m, spurious {spurious:.0%}", ours, oracles) >= least
    assert np.mean([r.count_right for r in ours]) >= 0.975


def test_the_published_method_is_not_better_than_published():
    """The fair score of PAPER stays well below ROBUST's: the remedies buy something."""
    few = replace(pk.PAPER, line_trials=2000)
    scores = []
    for number, world in enumerate(pk.paper_suite().values()):
        grid = pk.Grid()
        grid.add(pk.scan(world, pk.teleport_poses(world)))
        found = pk.find_shapes(grid.points(), len(world.shapes), settings=few, rng=number)
        scores.append(pk.evaluate(found, world).weighted_accuracy)
    assert 0.80 < np.mean(scores) < 0.97
