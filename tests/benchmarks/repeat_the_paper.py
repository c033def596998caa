"""Repeat the paper: its worlds, sensor, method and scoring, over ten seeds; and what ROBUST makes of them.

    python -m tests.benchmarks.repeat_the_paper rows [N]       rows equal to the recorded ones, means, crashes
    python -m tests.benchmarks.repeat_the_paper why [SEED]     by how much the other rows miss the recorded ones
    python -m tests.benchmarks.repeat_the_paper steps [N]      what each step does
    python -m tests.benchmarks.repeat_the_paper sensor         how far the rendered sensor errs
    python -m tests.benchmarks.repeat_the_paper robust         ROBUST on exact rays and on the rendered sensor
    python -m tests.benchmarks.repeat_the_paper coverage [N]   95 % intervals of ROBUST, turned worlds, rendered sensor

Seeds are 0, 1, 2, ...; none was looked at beforehand, and none is left out.
"""

import sys
from collections import Counter

import numpy as np

import primkit as pk
from primkit.paper import published_values
from primkit.robot import published_poses
from primkit.study import PUBLISHED, agrees, oracle_fit, repeat_study, told_points

from .ablation import ablation

THEIRS = pk.Lidar(model="webots")
PUBLISHED_CODE = {
    1: 0.81,
    2: 0.85,
    3: 0.84,
    4: 0.85,
}  # what it gives on re-enacted points of its sensor, means of three runs


def rows(n=10):
    """Print how many of the 34 rows come back, the weighted means and the crashes, seed by seed."""
    same, crashes, means, apart = [], [], [], Counter()
    for seed in range(n):
        told = [row for row in repeat_study(settings={"PAPER": pk.PAPER}, seed=seed, jobs=1) if row.sensor == "webots"]
        same.append(sum(map(agrees, told)))
        crashes.append(sum(row.crashed for row in told))
        means.append(
            [np.mean([r.paper.weighted for r in told if r.n_shapes == k and not r.crashed]) for k in (1, 2, 3, 4)]
        )
        for row in told:
            if row.crashed:
                apart[f"{row.map}: crashed"] += 1
            elif not agrees(row):
                apart[f"{row.map}: {difference(row)}"] += 1
        print(
            f"seed {seed}: {same[-1]} rows the same, {crashes[-1]} crashed, means {np.round(means[-1], 3)}", flush=True
        )
    recorded = [[row.score.weighted for name, row in PUBLISHED["automatic"].items() if name[0] == k] for k in "1234"]
    ours = np.mean(means, axis=0)
    print(f"rows the same: median {np.median(same)}; crashes: median {np.median(crashes)}, most {max(crashes)}")
    print(f"means           {ours.round(3)}")
    print(f"from the code's {(ours - list(PUBLISHED_CODE.values())).round(3)}")
    print(f"from recorded   {(ours - [np.mean(group) for group in recorded]).round(3)}")
    for name, count in sorted(apart.items()):
        print(f"{count:3d} of {n}  {name}")


def difference(row):
    """Return which of the numbers differ, ours and theirs."""
    ours, theirs = row.paper, PUBLISHED[row.movement][row.map].score
    parts = [
        name for name in ("shape", "center", "dimension") if abs(getattr(ours, name) - getattr(theirs, name)) > 0.005
    ]
    return ", ".join(f"{name} {getattr(ours, name):.2f} for {getattr(theirs, name):.2f}" for name in parts)


def why(seed=0):
    """Print by how many millimetres each value that decides a differing row misses the border where it would agree."""
    for name, world in pk.published_suite().items():
        experiment = pk.study.Experiment(name, world, "PAPER", pk.PAPER, lidar=THEIRS, seed=seed)
        report = pk.evaluate(pk.study.run(experiment).found, world, protocol="paper")
        theirs = PUBLISHED["automatic"][name].score
        if report.crashed:
            kinds = ", ".join(f"{m.found.kind} for {m.true.kind}" for m in report.matches if not m.kind_right)
            print(f"{name}: crashed ({kinds}; in pairs by kind and x)")
            continue
        centers, sizes = [], []
        for match in report.matches:
            ours, true = published_values(match.found, truth=False), published_values(match.true, truth=True)
            for key in ours.keys() & true.keys():
                (centers if key in "xy" else sizes).append(1000 * (ours[key] - round(true[key], 2)) - 5)
        for part, gaps, told in (("center", centers, theirs.center), ("dimension", sizes, theirs.dimension)):
            right, wanted = sum(gap < 0 for gap in gaps), round(told * len(gaps))
            flips = sorted(abs(gap) for gap in gaps if (gap < 0) == (right > wanted))[: abs(right - wanted)]
            if flips:
                print(f"{name}: {part} {right} of {len(gaps)} right, recorded {wanted}: {np.round(flips, 1)} mm off")


def sensor():
    """Print how far raw hits lie from the nearest outline."""
    off = []
    for world in pk.published_suite().values():
        points = pk.scan(world, published_poses(), THEIRS).points()
        off.append(np.min([np.abs(shape.signed_distance(points)) for shape in world.shapes], axis=0))
    off = 1000 * np.concatenate(off)
    rms, most = np.sqrt(np.mean(off**2)), off.max()
    print(f"{len(off)} hits: RMS {rms:.2f} mm, 95 % below {np.percentile(off, 95):.2f}, most {most:.2f}")


def seen(world, lidar):
    """Return scans from the paper's way-points, as the sensor's robot stands on them."""
    return pk.scan(world, published_poses() if lidar.model == "webots" else pk.teleport_poses(world), lidar)


def robust():
    """Print ROBUST's fair accuracy beside the fit that is told each point's side, on both sensors."""
    for lidar in (pk.Lidar(), THEIRS):
        ours, told = [], []
        for world in pk.published_suite().values():
            scans, grid = seen(world, lidar), pk.Grid()
            grid.add(scans)
            ours.append(pk.evaluate(pk.find_shapes(grid.points(), rng=0), world))
            fits = oracle_fit(world, *told_points(world, scans, lidar))
            told.append(pk.evaluate([fit for fit in fits if fit is not None], world))
        for name, reports in (("ROBUST", ours), ("told", told)):
            parts = ("weighted_accuracy", "shape_accuracy", "center_accuracy", "dimension_accuracy")
            means = [np.mean([getattr(report, part) for report in reports]) for part in parts]
            errors = 1000 * np.abs(np.concatenate([m.center_error for r in reports for m in r.matches]))
            sizes = 1000 * np.abs([e for r in reports for m in r.matches for e in m.dimension_error or ()])
            print(f"{lidar.model:6s} {name:6s} total, shape, centre, dimensions {np.round(means, 3)}")
            for what, off in (("centre", errors), ("dimensions", sizes)):
                print(f"   {what} off by {np.percentile(off, 50):.2f} mm (median), {np.percentile(off, 95):.2f} (95 %)")


def coverage(n=200):
    """Print how often 95 % intervals of ROBUST hold the truth, on turned worlds with the rendered sensor."""
    inside, wrong = {}, 0
    for seed in range(n):
        world = pk.random_world(1 + seed % 4, style="free", rng=seed)
        grid = pk.Grid()
        grid.add(seen(world, THEIRS))
        for name, what in (("grid", grid), ("points alone", grid.points())):
            found = pk.find_shapes(what, rng=0)
            matches = {id(match.found): match for match in pk.evaluate(found, world).matches}
            for one in found:
                match = matches.get(id(one.shape))
                if match is None or not match.kind_right:
                    wrong += what is grid
                    continue
                center = np.abs(match.center_error) <= 1.96 * np.array(one.center_std)
                dimension = np.abs(match.dimension_error) <= 1.96 * np.array(one.dimension_std)
                inside.setdefault(f"{name}, centre", []).extend(center)
                inside.setdefault(f"{name}, dimension", []).extend(dimension[np.isfinite(one.dimension_std)])
    for name, held in inside.items():
        print(f"{name}: {np.mean(held):.3f} of {len(held)} intervals hold the truth")
    print(f"of a wrong kind, or where there is nothing: {wrong} on {n} worlds")


if __name__ == "__main__":
    word, *number = sys.argv[1:] or ["rows"]
    how = {"rows": rows, "why": why, "sensor": sensor, "robust": robust, "coverage": coverage}
    if word == "steps":
        print(ablation(range(int(number[0]) if number else 20)))
    else:
        how[word](*map(int, number))
