"""Calibration: how often the 95 % intervals that ``find_shapes`` states hold the truth.

    python -m tests.benchmarks.calibration [N] [WORD ...]    N boards a line; only lines whose names hold a word

One shape on each board, seen from the way-points, so that shapes are independent. Shares are of all shapes of the right
kind, certain or not; in brackets Wilson's 95 % interval for as many draws as there are shapes. Hidden: dimensions that
hang on a side which no beam met, and how many of them are said to be measured. Nothing was tuned on these boards.
"""

import sys
import warnings
from dataclasses import dataclass, field, replace

import numpy as np

import primkit as pk
from primkit.arguments import LikelyWrong
from primkit.robot import published_poses
from primkit.study.accuracy.drive_views import unseen_sides, view_of
from primkit.study.estimate import Z95, share_of
from primkit.study.oracle import exact_hits

SEED = 2026  # used nowhere else


@dataclass(frozen=True)
class Line:
    """One condition: the boards' style, side of the cells, noise of the ranges and slip of the poses [m], and so on."""

    style: str = "free"
    cell: float = 0.001
    noise: float = 0.0
    slip: float = 0.0
    bare: bool = False  # the grid's points are handed in, and not the grid, which knows their scans
    told: float | None = None  # the noise_std that is told
    part: bool = False  # seen from one side only
    rendered: bool = False


LINES = {
    **{f"turned, cells of {c:g} mm": Line(cell=c / 1000) for c in (0.5, 1, 2, 5)},
    **{f"turned, noise {n:g} mm": Line(noise=n / 1000) for n in (0.5, 1, 2, 5, 10)},
    **{f"cells of {c:g} mm, noise 2 mm": Line(cell=c / 1000, noise=0.002) for c in (0.5, 2, 5)},
    **{f"upright, cells of {c:g} mm": Line(style="paper", cell=c / 1000) for c in (0.5, 1, 2)},
    **{f"slip {s:g} mm": Line(slip=s / 1000) for s in (0.5, 1, 2)},
    "slip 1 mm, noise 2 mm": Line(slip=0.001, noise=0.002),
    **{f"points alone, slip {s:g} mm": Line(slip=s / 1000, bare=True) for s in (0.5, 1, 2)},
    **{f"points alone, noise {n:g} mm": Line(noise=n / 1000, bare=True) for n in (0, 2)},
    "points alone, 5 mm and told": Line(noise=0.005, bare=True, told=0.005),
    "noise 5 mm, told 0.1 mm": Line(noise=0.005, told=0.0001),
    "rendered sensor": Line(rendered=True),
    "rendered sensor, points alone": Line(rendered=True, bare=True),
    **{f"from one side, noise {n:g} mm": Line(noise=n / 1000, part=True) for n in (0, 2)},
    "from one side, slip 1 mm": Line(slip=0.001, part=True),
}


@dataclass
class Tally:
    """Of each shape of the right kind which coordinates and dimensions its intervals hold; and what else came out."""

    centers: list = field(default_factory=list)
    dimensions: list = field(default_factory=list)
    stds: list = field(default_factory=list)
    n_certain: int = 0
    n_wrong: int = 0
    n_hidden: int = 0
    n_claimed: int = 0

    def cells(self):
        """Return the tally as texts."""
        shares = (share_of(float(np.mean(np.concatenate(h))), len(h)).text() for h in (self.centers, self.dimensions))
        median = 1000 * np.median(np.concatenate(self.stds))
        counts = (len(self.dimensions), *shares, f"{median:.2f} mm", self.n_certain, self.n_wrong)
        return (*map(str, counts), f"{self.n_claimed} of {self.n_hidden}")


def look(line, number, tally):
    """Look at one board, and add what came out to the tally."""
    rng = np.random.default_rng([SEED, number])
    world = pk.random_world(1, style=line.style, rng=rng)
    shape, lidar = world.shapes[0], pk.Lidar(noise_std=line.noise, model="webots" if line.rendered else "exact")
    poses = published_poses() if line.rendered else pk.teleport_poses(world)
    if line.part:
        bearing = rng.uniform(0, 2 * np.pi)
        poses = poses[(poses[:, :2] - shape.centroid) @ (np.cos(bearing), np.sin(bearing)) > 0]
    scans, grid = pk.scan(world, poses, lidar, rng=rng), pk.Grid(line.cell)
    believed = scans.poses + np.column_stack([rng.normal(0, 1, (len(poses), 2)) * line.slip, np.zeros(len(poses))])
    grid.add(replace(scans, poses=believed))
    settings = pk.Settings(noise_std=line.told)
    seen, resolution = (grid.points(), line.cell) if line.bare else (grid, None)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", LikelyWrong)  # what is told wrong
        found = pk.find_shapes(seen, resolution=resolution, settings=settings, rng=0)
    matches = {id(match.found): match for match in pk.evaluate(found, world).matches}
    hits, owners = exact_hits(world, scans, lidar) if line.part else (np.empty((0, 2)), np.empty((0, 2), dtype=int))
    unseen = unseen_sides(shape, hits, owners[:, 1]) if line.part else np.zeros(len(getattr(shape, "sides", [0])), bool)
    for one in found:
        match = matches.get(id(one.shape))
        tally.n_certain += one.certain
        if match is None or not match.kind_right:
            tally.n_wrong += 1
            continue
        view = view_of(number, shape, 1.0, unseen, one)
        std, hidden, measured = np.array(view.stds), np.array(view.hidden), np.array(view.measured)
        tally.n_hidden += int(hidden.sum())
        tally.n_claimed += int((hidden & measured).sum())
        if np.isfinite(one.center_std).all():
            tally.centers.append(np.abs(match.center_error) <= Z95 * np.array(one.center_std))
        if measured.any():
            tally.dimensions.append((np.abs(view.errors) <= Z95 * std)[measured])
            tally.stds.append(std[measured])


def main(n, words):
    """Print a line of the table for each condition as it ends."""
    form = "{:31s} {:>6s}  {:20s}  {:20s}  {:>8s}  {:>7s} {:>5s}  {:s}"
    print(form.format("", "shapes", "centres", "dimensions", "median", "certain", "wrong", "hidden, but measured"))
    for name, line in LINES.items():
        if words and not any(word in name for word in words):
            continue
        tally = Tally()
        for number in range(n):
            look(line, number, tally)
        print(form.format(name, *tally.cells()), flush=True)


if __name__ == "__main__":
    how_many, *names = sys.argv[1:] or ["1000"]
    main(int(how_many), names)
