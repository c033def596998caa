"""Problem set 3: a pipe of known radius, a hexagon from six lines, a nut or a coin, how sure a radius is."""

# ruff: noqa: ARG001 (a wrong answer may leave out what it is given)

import math
from itertools import combinations

import numpy as np
import shapely
from scipy.optimize import least_squares, minimize
from scipy.spatial import ConvexHull, HalfspaceIntersection
from scipy.stats import chi2

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
    return least_squares(lambda q: ((points - q) ** 2).sum(axis=1) / radius**2 - 1, start, ftol=1e-14, xtol=1e-14).x


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

    starts = [[*circle.center, 0.95 * circle.radius, turn] for turn in np.pi / 9 * np.arange(3)]
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


# --- other right ways, and other wrong ones --------------------------------------------------------------------


def pipe_by_bfgs(points, radius):
    """The sum of squared gaps, its slope by hand."""
    if len(np.unique(points, axis=0)) < 2:
        return None
    start = points.mean(axis=0) * (1 + radius / np.linalg.norm(points.mean(axis=0)))

    def cost(c):
        spokes = (points - c) / radius
        away = np.linalg.norm(spokes, axis=1)
        gap = away - 1
        return gap @ gap, -2 * (gap / away) @ spokes / radius

    return minimize(cost, start, jac=True, method="BFGS", options={"gtol": 1e-12}).x


def pipe_by_simplex(points, radius):
    """Nelder and Mead's search for the least gaps, in millimetres, from the middle of the outermost hits on."""
    if len({tuple(p) for p in points}) < 2:
        return None
    p, q = max(combinations(points, 2), key=lambda pair: math.dist(*pair))
    start = 1000 * ((p + q) / 2 + 0.7 * radius * (p + q) / np.linalg.norm(p + q))
    cost = lambda c: ((np.hypot(*(1000 * points - c).T) - 1000 * radius) ** 2).sum()  # noqa: E731
    return (minimize(cost, start, method="Nelder-Mead", options={"xatol": 1e-4, "fatol": 1e-9}).x / 1000).tolist()


def pipe_mean(points, radius):
    return points.mean(axis=0) if len(np.unique(points, axis=0)) > 1 else None


def pipe_from_the_ends(points, radius):
    """Through the first and the last hit, and no other."""
    if len(np.unique(points, axis=0)) < 2:
        return None
    return pipe_by_pairs(points[[0, -1]], radius)


def pipe_beyond_the_middle(points, radius):
    """A radius beyond the middle one of the hits."""
    if len(np.unique(points, axis=0)) < 2:
        return None
    middle = points[len(points) // 2]
    return middle * (1 + radius / np.linalg.norm(middle))


def hexagon_by_halfspaces(lines, inside):
    """SciPy's intersection of half-planes, its corners in the order of their hull."""
    normals = np.column_stack([np.cos(lines[:, 0]), np.sin(lines[:, 0])])
    out = np.where(normals @ inside < lines[:, 1], 1.0, -1.0)[:, None]
    corners = HalfspaceIntersection(np.hstack([normals, -lines[:, 1:]]) * out, inside).intersections
    return corners[ConvexHull(corners).vertices]


def hexagon_by_walking(lines, inside):
    """Plain Python: from a line on to the one whose outward bearing comes next."""
    out = [(a, d) if math.cos(a) * inside[0] + math.sin(a) * inside[1] < d else (a + math.pi, -d) for a, d in lines]
    todo, ring = out[1:], [out[0]]
    while todo:
        following = min(todo, key=lambda line: (line[0] - ring[-1][0]) % TURN)
        todo.remove(following)
        ring.append(following)
    return np.array([crossing(ring[k - 1], ring[k]) for k in range(6)])


def hexagon_second_neighbours(lines, inside):
    out = np.array(sorted(turned(lines, inside).tolist(), key=lambda line: line[0] % TURN))
    return np.array([crossing(out[k], out[(k + 2) % 6]) for k in range(6)])


def hexagon_unsigned(lines, inside):
    """Offsets without their sign: right only where the origin lies inside and normals point outwards."""
    return hexagon_by_all_pairs(np.column_stack([lines[:, 0], abs(lines[:, 1])]), np.zeros(2))


def hexagon_regular(lines, inside):
    """As if all six sides were equally long."""
    reach = np.mean(abs(lines[:, 1] - np.cos(lines[:, 0]) * inside[0] - np.sin(lines[:, 0]) * inside[1]))
    bearings = lines[0, 0] + np.pi / 6 + np.pi / 3 * np.arange(6)
    return inside + reach / math.cos(math.pi / 6) * np.column_stack([np.cos(bearings), np.sin(bearings)])


def name_by_chance(points, spread):
    """A chi-square test: could noise alone do that?"""
    return "coin" if chi2.sf(len(points) * (misfit(points) / spread) ** 2, len(points) - 3) > 1e-8 else "nut"


def name_nut(points, spread):
    return "nut"


def name_by_the_worst(points, spread):
    """One point of 150 lies three deviations off in every second coin."""
    return "nut" if np.abs(pk.fit_circle(points).signed_distance(points)).max() > 2.5 * spread else "coin"


def name_by_squares(points, spread):
    """Square millimetres beside millimetres."""
    return "nut" if misfit(points) ** 2 > 1.7 * spread else "coin"


def std_by_solving(bearings, noise):
    """The last column of the inverse alone."""
    if not enough(bearings):
        return INF
    J = np.column_stack([np.cos(bearings), np.sin(bearings), np.ones(len(bearings))])
    return noise * math.sqrt(np.linalg.solve(J.T @ J, [0, 0, 1])[2])


def std_by_moments(bearings, noise):
    """Plain sums: what is left of N once the centre has taken its share."""
    c, s = [math.cos(b) for b in bearings], [math.sin(b) for b in bearings]
    a, b, d = sum(x * x for x in c), sum(x * y for x, y in zip(c, s, strict=True)), sum(y * y for y in s)
    det = a * d - b * b
    if det < 1e-12 or not enough(bearings):
        return INF
    p, q = sum(c), sum(s)
    return noise / math.sqrt(len(c) - (d * p * p - 2 * b * p * q + a * q * q) / det)


def std_without_root(bearings, noise):
    """The root is missing, and the noise is not squared."""
    return std_by_qr(bearings, noise) ** 2 / noise if noise else 0.0


def std_of_all(bearings, noise):
    if not enough(bearings):
        return INF
    J = np.column_stack([np.cos(bearings), np.sin(bearings), np.ones(len(bearings))])
    return float(noise * np.sqrt(np.trace(np.linalg.inv(J.T @ J))))


def std_none(bearings, noise):
    return std_by_qr(bearings, noise) if enough(bearings) else None


def std_half_known(bearings, noise):
    """x of the centre is fitted, y is taken for known."""
    if not enough(bearings):
        return INF
    J = np.column_stack([np.cos(bearings), np.ones(len(bearings))])
    return float(noise * np.sqrt(np.linalg.inv(J.T @ J)[1, 1]))


# Each wrong answer with what it loses (v: the visible tests; 1, 2, ...: hidden parts), and the short name of its fault.
ANSWERS = {
    "pipe_center": {
        "right": {
            "BFGS": pipe_by_bfgs,
            "simplex": pipe_by_simplex,
            "least squares": pipe_by_scipy,
            "squared distances": pipe_by_two_numbers,
            "pairs": pipe_by_pairs,
        },
        "wrong": {
            "mean": (pipe_mean, "v123", None),
            "from the ends": (pipe_from_the_ends, "2", None),
            "beyond the middle": (pipe_beyond_the_middle, "v123", None),
            "free radius": (pipe_free, "v23", "radius not used"),
            "kasa": (pipe_kasa, "v23", "radius not used"),
            "near side": (pipe_near_side, "v123", "centre on the robot's side"),
            "beyond the mean": (pipe_beyond_mean, "v123", "a radius beyond the mean"),
            "beyond the nearest": (pipe_beyond_nearest, "v123", "a radius beyond the nearest hit"),
            "whole circle": (pipe_whole, "v123", "a whole circle"),
            "never none": (pipe_never_none, "3", "a centre from one point"),
        },
    },
    "hexagon_corners": {
        "right": {
            "half-planes": hexagon_by_halfspaces,
            "walking": hexagon_by_walking,
            "all pairs": hexagon_by_all_pairs,
            "clipping": hexagon_by_clipping,
            "duality": hexagon_by_duality,
        },
        "wrong": {
            "second neighbours": (hexagon_second_neighbours, "v1234", None),
            "unsigned": (hexagon_unsigned, "v34", None),
            "regular": (hexagon_regular, "1234", None),
            "as given": (hexagon_as_given, "v234", "lines in the order given"),
            "as given, outwards": (hexagon_as_given_outwards, "v234", "lines in the order given"),
            "not turned": (hexagon_not_turned, "v34", "normals not turned outwards"),
            "origin": (hexagon_origin, "4", "origin for the place inside"),
            "clockwise": (hexagon_clockwise, "1234", "clockwise for counter-clockwise"),
            "left to right": (hexagon_left_to_right, "v1234", "corners not in order"),
            "all crossings": (hexagon_all_crossings, "v1234", None),
        },
    },
    "nut_or_coin": {
        "right": {
            "chance": name_by_chance,
            "waves": name_by_waves,
            "rivals": name_by_rivals,
            "better fit": name_by_better_fit,
            "spread": name_by_spread,
        },
        "wrong": {
            "always nut": (name_nut, "v123", "one name for all"),
            "the worst point": (name_by_the_worst, "123", None),
            "squares": (name_by_squares, "v123", "one name for all"),
            "always coin": (name_coin, "v123", "one name for all"),
            "one millimetre": (name_one_millimetre, "v123", "a fixed limit"),
            "by share": (name_by_share, "2", "a limit by size alone"),
            "around the mean": (name_around_mean, "3", "mean taken for the centre"),
            "capitals": (name_with_capitals, "v123", "neither nut nor coin"),
            "true or false": (name_as_bool, "v123", "neither nut nor coin"),
            "turned round": (name_turned_round, "v123", "names changed places"),
        },
    },
    "radius_std": {
        "right": {
            "solving": std_by_solving,
            "moments": std_by_moments,
            "simulation": std_by_simulation,
            "projection": std_by_projection,
            "qr": std_by_qr,
        },
        "wrong": {
            "no root": (std_without_root, "v123", None),
            "of all": (std_of_all, "v123", None),
            "none": (std_none, "3", "sure of what is not fixed"),
            "half known": (std_half_known, "2", None),
            "known centre": (std_known_centre, "v2", "centre taken for known"),
            "variance": (std_variance, "v123", "variance for standard deviation"),
            "one point": (std_one_point, "v123", "spread of one point"),
            "of the centre": (std_of_centre, "v123", "centre for radius"),
            "pseudo-inverse": (std_pinv, "3", "sure of what is not fixed"),
            "inverse": (std_inverse, "3", "sure of what is not fixed"),
        },
    },
}
