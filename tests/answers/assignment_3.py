"""Problem set 3: a pipe of known radius, a hexagon from six lines, a nut or a coin, how sure a radius is."""

# ruff: noqa: ARG001 (a wrong answer may leave out what it is given)

import math
from itertools import combinations

import numpy as np
import shapely
from scipy.optimize import least_squares, minimize

import primkit as pk

INF = float("inf")
TURN = 2 * math.pi


# --- pipe_center -------------------------------------------------------------------------------------------


def pipe_by_scipy(points, radius):
    if len(np.unique(points, axis=0)) < 2:
        return None
    middle = points.mean(axis=0)
    start = middle + radius * middle / np.linalg.norm(middle)
    return least_squares(lambda c: np.linalg.norm(points - c, axis=1) - radius, start, xtol=1e-14, ftol=1e-14).x


def pipe_by_two_numbers(points, radius):
    """The squares of squared distances, from beyond the points on."""
    if len(np.unique(points, axis=0)) < 2:
        return None
    middle = points.mean(axis=0)
    start = middle + radius * middle / np.linalg.norm(middle)
    cost = lambda q: float(((((points - q) ** 2).sum(axis=1) / radius**2 - 1) ** 2).sum())  # noqa: E731
    return minimize(cost, start, method="Nelder-Mead", options={"xatol": 1e-8, "fatol": 1e-16, "maxiter": 2000}).x


def pipe_by_pairs(points, radius):
    """The centre over the chord of two points, from many pairs, then refined by Newton's own steps."""
    pairs = [(p, q) for p, q in combinations(points, 2) if 0 < math.dist(p, q) < 2 * radius]
    if not pairs:
        return None
    p, q = max(pairs, key=lambda pair: math.dist(*pair))
    half, chord = math.dist(p, q) / 2, (q - p) / math.dist(p, q)
    height = math.sqrt(max(radius**2 - half**2, 0.0))
    both = [(p + q) / 2 + sign * height * np.array([-chord[1], chord[0]]) for sign in (-1, 1)]
    center = max(both, key=np.linalg.norm)
    for _ in range(200):
        spokes = points - center
        units = spokes / np.linalg.norm(spokes, axis=1)[:, None]
        gaps = np.linalg.norm(spokes, axis=1) - radius
        center = center + np.linalg.solve(units.T @ units, units.T @ gaps)
    return center


def pipe_free(points, radius):
    circle = pk.fit_circle(points)
    return None if circle is None else circle.center


def pipe_kasa(points, radius):
    circle = pk.fit_circle(points, "kasa")
    return None if circle is None else tuple(circle.center)


def pipe_near_side(points, radius):
    if len(np.unique(points, axis=0)) < 2:
        return None
    middle = points.mean(axis=0)
    start = middle - radius * middle / np.linalg.norm(middle)
    return least_squares(lambda c: np.linalg.norm(points - c, axis=1) - radius, start, xtol=1e-14, ftol=1e-14).x


def pipe_beyond_mean(points, radius):
    if len(np.unique(points, axis=0)) < 2:
        return None
    middle = points.mean(axis=0)
    return middle + radius * middle / np.linalg.norm(middle)


def pipe_beyond_nearest(points, radius):
    if len(np.unique(points, axis=0)) < 2:
        return None
    nearest = min(points, key=np.linalg.norm)
    return nearest + radius * nearest / np.linalg.norm(nearest)


def pipe_whole(points, radius):
    center = pipe_by_scipy(points, radius)
    return None if center is None else (*center, radius)


def pipe_never_none(points, radius):
    if len(points) == 0:
        return np.zeros(2)
    if len(np.unique(points, axis=0)) < 2:
        return points[0] + radius * points[0] / np.linalg.norm(points[0])
    return pipe_by_scipy(points, radius)


# --- hexagon_corners ---------------------------------------------------------------------------------------


def crossing(one, other):
    (a, d), (b, e) = one, other
    return np.linalg.solve([[math.cos(a), math.sin(a)], [math.cos(b), math.sin(b)]], [d, e])


def hexagon_by_all_pairs(lines, inside):
    """Of all crossings keep those that no line cuts off from the place inside; sort them around it."""
    normals = np.column_stack([np.cos(lines[:, 0]), np.sin(lines[:, 0])])
    side = np.sign(normals @ inside - lines[:, 1])
    kept = []
    for i, j in combinations(range(6), 2):
        if abs(math.sin(lines[i, 0] - lines[j, 0])) > 1e-9:
            corner = crossing(lines[i], lines[j])
            if (side * (normals @ corner - lines[:, 1]) > -1e-9).all():
                kept.append(corner)
    return sorted(kept, key=lambda corner: math.atan2(*(corner - inside)[::-1]))


def hexagon_by_clipping(lines, inside):
    """A large square, cut by each line in turn."""
    piece = shapely.box(-9, -9, 9, 9)
    for angle, offset in lines:
        n, u = np.array([math.cos(angle), math.sin(angle)]), np.array([-math.sin(angle), math.cos(angle)])
        away = 1 if n @ inside > offset else -1
        foot = offset * n
        half = shapely.Polygon(
            [foot + 50 * u, foot - 50 * u, foot - 50 * u + 50 * away * n, foot + 50 * u + 50 * away * n]
        )
        piece = piece.intersection(half)
    return np.array(shapely.geometry.polygon.orient(piece).exterior.coords)[:-1]


def hexagon_by_duality(lines, inside):
    """Each line as the point normal / offset seen from the place inside: the order around is that of these points."""
    ahead = lines[:, 1] - (np.cos(lines[:, 0]) * inside[0] + np.sin(lines[:, 0]) * inside[1])
    dual = np.column_stack([np.cos(lines[:, 0]), np.sin(lines[:, 0])]) / ahead[:, None]
    order = np.argsort(np.arctan2(dual[:, 1], dual[:, 0]))
    return [inside + np.linalg.solve(dual[[i, j]], [1, 1]) for i, j in zip(order, np.roll(order, -1), strict=True)]


def meet_in_turn(lines):
    pairs = [(lines[i], lines[(i + 1) % 6]) for i in range(6)]
    return np.array([crossing(a, b) if abs(math.sin(a[0] - b[0])) > 1e-12 else (9.0, 9.0) for a, b in pairs])


def turned(lines, place):
    inside = [math.cos(a) * place[0] + math.sin(a) * place[1] < d for a, d in lines]
    return np.array([(a, d) if is_in else (a + math.pi, -d) for is_in, (a, d) in zip(inside, lines, strict=True)])


def hexagon_as_given(lines, inside):
    return meet_in_turn(lines)


def hexagon_as_given_outwards(lines, inside):
    return meet_in_turn(turned(lines, inside))


def hexagon_not_turned(lines, inside):
    return meet_in_turn(np.array(sorted(lines.tolist(), key=lambda line: line[0] % TURN)))


def hexagon_origin(lines, inside):
    return meet_in_turn(np.array(sorted(turned(lines, (0, 0)).tolist(), key=lambda line: line[0] % TURN)))


def hexagon_clockwise(lines, inside):
    return hexagon_by_all_pairs(lines, inside)[::-1]


def hexagon_left_to_right(lines, inside):
    return sorted(hexagon_by_all_pairs(lines, inside), key=lambda corner: corner[0])


def hexagon_all_crossings(lines, inside):
    return [crossing(one, other) for one, other in combinations(lines, 2) if abs(math.sin(one[0] - other[0])) > 1e-9]


# --- nut_or_coin -------------------------------------------------------------------------------------------


def misfit(points):
    return math.sqrt(np.mean(pk.fit_circle(points).signed_distance(points) ** 2))


def name_by_waves(points, spread):
    """Six waves around the centre: how high are they, beside what noise alone would make of them?"""
    circle = pk.fit_circle(points)
    x, y = (points - circle.center).T
    turn, gap = np.arctan2(y, x), np.hypot(x, y) - circle.radius
    design = np.column_stack([np.cos(6 * turn), np.sin(6 * turn), np.ones(len(turn))])
    a, b, _ = np.linalg.lstsq(design, gap, rcond=None)[0]
    return "nut" if math.hypot(a, b) > 5 * spread / math.sqrt(len(points)) else "coin"


def name_by_rivals(points, spread):
    """Circle against regular hexagon, each fitted; one number more costs the logarithm of the count of points."""
    circle = pk.fit_circle(points)

    def out(q):
        x, y = points[:, 0] - q[0], points[:, 1] - q[1]
        turn = (np.arctan2(y, x) - q[3] + math.pi / 6) % (math.pi / 3) - math.pi / 6
        return np.hypot(x, y) * np.cos(turn) - q[2]

    starts = [(*circle.center, 0.95 * circle.radius, turn) for turn in np.linspace(0, math.pi / 3, 4, endpoint=False)]
    hexagon = min(least_squares(out, start, x_scale=(0.01, 0.01, 0.01, 0.1)).cost for start in starts)
    gain = (circle.signed_distance(points) ** 2).sum() - 2 * hexagon
    return "nut" if gain / spread**2 > math.log(len(points)) else "coin"


def name_by_spread(points, spread):
    """How much of the circle's misfit the spread explains."""
    return ("coin", "nut")[misfit(points) > 1.35 * spread]


def name_by_better_fit(points, spread):
    """The least squares for a circle and for a regular hexagon: the smaller one wins, whatever the spread."""
    circle = pk.fit_circle(points)
    round_off = np.sqrt(np.mean(circle.signed_distance(points) ** 2))

    def off(q):
        turns = q[3] + np.pi / 3 * np.arange(6)
        return ((points - q[:2]) @ [np.cos(turns), np.sin(turns)]).max(axis=1) - q[2]

    starts = [[*circle.center, 0.95 * circle.radius, turn] for turn in np.pi / 18 * np.arange(6)]
    hexagon_off = min(np.sqrt(np.mean(least_squares(off, start).fun ** 2)) for start in starts)
    return "coin" if round_off < hexagon_off else "nut"


def name_coin(points, spread):
    return "coin"


def name_one_millimetre(points, spread):
    return "nut" if misfit(points) > 0.001 else "coin"


def name_by_share(points, spread):
    return "nut" if misfit(points) > 0.03 * pk.fit_circle(points).radius else "coin"


def name_around_mean(points, spread):
    away = np.linalg.norm(points - points.mean(axis=0), axis=1)
    return "nut" if away.std() > 1.35 * spread else "coin"


def name_with_capitals(points, spread):
    return name_by_spread(points, spread).title()


def name_as_bool(points, spread):
    return name_by_spread(points, spread) == "nut"


def name_turned_round(points, spread):
    return {"nut": "coin", "coin": "nut"}[name_by_spread(points, spread)]


# --- radius_std --------------------------------------------------------------------------------------------


def enough(bearings):
    places = np.unique(np.round(np.column_stack([np.cos(bearings), np.sin(bearings)]), 9), axis=0)
    return len(places) >= 3


def std_by_simulation(bearings, noise):
    """Thousands of noisy circles, fitted by Taubin's way; so large that the noise is small beside it."""
    if not enough(bearings):
        return INF
    rng, radius = np.random.default_rng(0), 1e4 * noise
    u = np.column_stack([np.cos(bearings), np.sin(bearings)])
    design = np.column_stack([2 * u, np.ones(len(u))])
    r = radius + noise * rng.standard_normal((4000, len(u)))
    a, b, k = np.linalg.lstsq(design, ((r**2 - radius**2) / radius).T, rcond=None)[0]
    # Kasa's equations in units of the radius: k = (r^2 - a^2 - b^2 - radius^2) / radius for a centre (a, b).
    found = np.sqrt(radius**2 + radius * k + a**2 + b**2)
    return float(found.std())


def std_by_projection(bearings, noise):
    """How long the column of ones is beside what cosine and sine can explain of it."""
    if not enough(bearings):
        return INF
    both = np.column_stack([np.cos(bearings), np.sin(bearings)])
    ones = np.ones(len(both))
    left = ones - both @ np.linalg.lstsq(both, ones, rcond=None)[0]
    return noise / math.sqrt(left @ left)


def std_by_qr(bearings, noise):
    if not enough(bearings):
        return math.inf
    R = np.linalg.qr(np.column_stack([np.cos(bearings), np.sin(bearings), np.ones(len(bearings))]))[1]
    return noise / abs(R[2, 2])


def std_known_centre(bearings, noise):
    return noise / math.sqrt(len(bearings)) if enough(bearings) else INF


def std_variance(bearings, noise):
    return std_by_qr(bearings, noise) ** 2


def std_one_point(bearings, noise):
    return noise if enough(bearings) else INF


def std_of_centre(bearings, noise):
    if not enough(bearings):
        return INF
    R = np.linalg.qr(np.column_stack([np.ones(len(bearings)), np.sin(bearings), np.cos(bearings)]))[1]
    return noise / abs(R[2, 2])


def std_pinv(bearings, noise):
    """A pseudo-inverse has an answer where there is none."""
    J = np.column_stack([np.cos(bearings), np.sin(bearings), np.ones(len(bearings))])
    return float(noise * np.sqrt(np.linalg.pinv(J.T @ J)[2, 2]))


def std_inverse(bearings, noise):
    J = np.column_stack([np.cos(bearings), np.sin(bearings), np.ones(len(bearings))])
    return float(noise * np.sqrt(np.linalg.inv(J.T @ J)[2, 2]))


# Each wrong answer with the points that it gets of the task's five, and the short name of its fault.
ANSWERS = {
    "pipe_center": {
        "right": {"least squares": pipe_by_scipy, "squared distances": pipe_by_two_numbers, "pairs": pipe_by_pairs},
        "wrong": {
            "free radius": (pipe_free, 1, "radius not used"),
            "kasa": (pipe_kasa, 1, "radius not used"),
            "near side": (pipe_near_side, 0, "centre on the robot's side"),
            "beyond the mean": (pipe_beyond_mean, 0, "a radius beyond the mean"),
            "beyond the nearest": (pipe_beyond_nearest, 0, "a radius beyond the nearest hit"),
            "whole circle": (pipe_whole, 0, "a whole circle"),
            "never none": (pipe_never_none, 4, "a centre from one point"),
        },
    },
    "hexagon_corners": {
        "right": {"all pairs": hexagon_by_all_pairs, "clipping": hexagon_by_clipping, "duality": hexagon_by_duality},
        "wrong": {
            "as given": (hexagon_as_given, 1, "lines in the order given"),
            "as given, outwards": (hexagon_as_given_outwards, 1, "lines in the order given"),
            "not turned": (hexagon_not_turned, 2, "normals not turned outwards"),
            "origin": (hexagon_origin, 4, "origin for the place inside"),
            "clockwise": (hexagon_clockwise, 1, "clockwise for counter-clockwise"),
            "left to right": (hexagon_left_to_right, 0, "corners not in order"),
            "all crossings": (hexagon_all_crossings, 0, None),
        },
    },
    "nut_or_coin": {
        "right": {
            "waves": name_by_waves,
            "rivals": name_by_rivals,
            "better fit": name_by_better_fit,
            "spread": name_by_spread,
        },
        "wrong": {
            "always coin": (name_coin, 0, "one name for all"),
            "one millimetre": (name_one_millimetre, 0, "a fixed limit"),
            "by share": (name_by_share, 3, "a limit by size alone"),
            "around the mean": (name_around_mean, 4, "mean taken for the centre"),
            "capitals": (name_with_capitals, 0, "neither nut nor coin"),
            "true or false": (name_as_bool, 0, "neither nut nor coin"),
            "turned round": (name_turned_round, 0, "names changed places"),
        },
    },
    "radius_std": {
        "right": {"simulation": std_by_simulation, "projection": std_by_projection, "qr": std_by_qr},
        "wrong": {
            "known centre": (std_known_centre, 2, "centre taken for known"),
            "variance": (std_variance, 0, "variance for standard deviation"),
            "one point": (std_one_point, 0, "spread of one point"),
            "of the centre": (std_of_centre, 0, "centre for radius"),
            "pseudo-inverse": (std_pinv, 4, "sure of what is not fixed"),
            "inverse": (std_inverse, 4, "sure of what is not fixed"),
        },
    },
}
