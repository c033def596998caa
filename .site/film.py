"""Film: the front page's first picture, eight seconds in which the robot explores a board and finds what stands there.

    python .site/film.py                             writes data/pictures/film.svg

In:  nothing: the board, the tour and what is found are computed.
Out: one SVG that moves by itself: no script, and it stands still for readers who want no motion.
"""

from pathlib import Path

import numpy as np

import primkit as pk
from primkit.palette import KIND_COLORS, PALE, VERMILION
from primkit.shapes import PRIMITIVES
from primkit.widgets.drawing import board_frame
from primkit.widgets.svg import as_svg, path, words_at

FILM = Path(__file__).resolve().parent.parent / "data" / "pictures" / "film.svg"
SECONDS, DRIVEN = 8, 0.8  # of the film, and the share of it in which the robot drives; then what was found is shown
MARGIN = 12  # px, around the board: it has no axes
PLACES = 120  # of the robot: between them it goes straight
SHOWN = "@keyframes k{k}{{0%{{opacity:0}}{at:.4g}%{{opacity:1}}}}.k{k}{{animation:k{k} {s}s steps(1,end) infinite}}"


def film(world, tour):
    """Return the film of a tour."""
    frame, rules, parts = board_frame(world.size), [], []

    def appears(at, drawn):
        rules.append(SHOWN.format(k=len(parts), at=100 * at, s=SECONDS))
        parts.append(f'<g class="k{len(parts)}">{drawn}</g>')

    along = 0
    for pose, scan in zip(tour.poses, (tour.scans[k] for k in range(tour.n_scans)), strict=True):
        along += int(np.abs(tour.path[along:] - pose).sum(axis=1).argmin())
        appears(DRIVEN * along / len(tour.path), frame.points(scan.points(), VERMILION, size=4))
    for found in tour.found:
        at = found.shape.centroid
        name = frame.text(at, found.kind, KIND_COLORS[found.kind], "middle", (0, 5), 15)
        appears(DRIVEN + 0.03, frame.shape(found.shape, width=3, fill=0.25) + name)
    chosen = np.linspace(0, len(tour.path) - 1, PLACES).round().astype(int)
    turned = np.degrees(np.unwrap(tour.path[:, 2]))
    moves = [
        f"{100 * DRIVEN * k / (PLACES - 1):.4g}%"
        f"{{transform:translate({x:g}px,{y:g}px) rotate({-turned[place]:.4g}deg)}}"
        for k, (place, (x, y)) in enumerate(zip(chosen, frame.at(tour.path[chosen, :2]), strict=True))
    ]
    last = moves[-1].partition("%")[2]
    style = (
        f"@keyframes drive{{{''.join(moves)}100%{last}}}"
        f".robot{last}.robot{{animation:drive {SECONDS}s linear infinite}}"
        f"{''.join(rules)}@media (prefers-reduced-motion:reduce){{g{{animation:none!important}}}}"
    )
    ((left, top), (right, bottom)) = frame.at(np.array([[-0.5, 0.5], [0.5, -0.5]]) * world.size)
    board = path(f"M{left:g} {top:g}H{right:g}V{bottom:g}H{left:g}Z", stroke=PALE, stroke_width=1)
    robot = f'<g class="robot">{path("M13 0L-10 9V-9Z", fill="#222222", stroke="white", stroke_width=1)}</g>'
    says = (
        f"A robot drives over a board and scans at {tour.n_scans} places; the points become {len(tour.found)} shapes."
    )
    words = words_at(left, top - 8, "It sees points. What stands there?", color="#222222", size=15, bold=True)
    drawn = f'<g transform="translate({MARGIN - left:g})">{board}{words}{"".join(parts)}{robot}</g>'
    width, height = int(right - left) + 2 * MARGIN, int(bottom) + MARGIN
    return as_svg(width, height, "A robot finds four shapes", says, f"<style>{style}</style>{drawn}")


def front_page():
    """Return the film of the front page: one shape of each kind."""
    world = pk.random_world(4, kinds=PRIMITIVES, style="free", rng=5)
    return film(world, pk.explore(world, rng=0)) + "\n"


if __name__ == "__main__":
    FILM.write_text(front_page(), encoding="utf-8")
