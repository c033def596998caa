"""Lesson 08: where two wheels take the robot, and how much of an outline was seen."""

# ruff: noqa: ARG005 (a wrong answer may leave out what it is given)

import cmath
import math

import numpy as np
from scipy.integrate import solve_ivp
from scipy.spatial import cKDTree

R, A = 0.0205, 0.052  # m


def speeds(left, right):
    return R * (left + right) / 2, R * (right - left) / A


def by_turning_circle(pose, left, right, seconds):
    """Round the middle of the turning circle; straight on where it has none."""
    x, y, heading = pose
    v, w = speeds(left, right)
    if abs(w) < 1e-9:
        return x + v * seconds * math.cos(heading), y + v * seconds * math.sin(heading), heading
    later = heading + w * seconds
    return x + v / w * (math.sin(later) - math.sin(heading)), y - v / w * (math.cos(later) - math.cos(heading)), later


def by_chord(pose, left, right, seconds):
    """Chord and middle heading, as a complex number; the heading within one turn."""
    v, w = speeds(left, right)
    half = w * seconds / 2
    chord = v * seconds * (math.sin(half) / half if half else 1.0)
    place = complex(*pose[:2]) + cmath.rect(chord, pose[2] + half)
    return np.array([place.real, place.imag, (pose[2] + 2 * half) % (2 * math.pi)])


def by_integration(pose, left, right, seconds):
    """Ask a solver of differential equations."""
    v, w = speeds(left, right)
    done = solve_ivp(
        lambda t, p: (v * math.cos(p[2]), v * math.sin(p[2]), w), (0, seconds), pose, rtol=1e-12, atol=1e-13
    )
    return done.y[:, -1].tolist()


def straight_at(share):
    def step(pose, left, right, seconds):
        v, w = speeds(left, right)
        bearing = pose[2] + share * w * seconds
        return [
            pose[0] + v * seconds * math.cos(bearing),
            pose[1] + v * seconds * math.sin(bearing),
            pose[2] + w * seconds,
        ]

    return step


def with_speeds(change):
    """The right step with other speeds v and w."""

    def step(pose, left, right, seconds):
        v, w = change(left, right)
        x, y, heading = pose
        turn = w * seconds
        chord = v * seconds * np.sinc(turn / 2 / np.pi)
        return x + chord * math.cos(heading + turn / 2), y + chord * math.sin(heading + turn / 2), heading + turn

    return step


def no_radius(left, right):
    return (left + right) / 2, (right - left) / A


def no_axle(left, right):
    return R * (left + right) / 2, R * (right - left)


def no_half(left, right):
    return R * (left + right), R * (right - left) / A


def nan_when_straight(pose, left, right, seconds):
    v, w = speeds(left, right)
    x, y, heading = pose
    later = heading + w * seconds
    radius = np.divide(v, w)
    return x + radius * (np.sin(later) - np.sin(heading)), y - radius * (np.cos(later) - np.cos(heading)), later


def divides_by_zero(pose, left, right, seconds):
    v, w = speeds(left, right)
    return pose[0] + v / w * math.sin(w * seconds), pose[1] + v / w * (1 - math.cos(w * seconds)), pose[2] + w * seconds


def along_x(pose, left, right, seconds):
    step = by_chord((0.0, 0.0, 0.0), left, right, seconds)
    return np.asarray(pose) + step


def heading_kept(pose, left, right, seconds):
    return (*by_turning_circle(pose, left, right, seconds)[:2], pose[2])


def in_degrees(pose, left, right, seconds):
    x, y, heading = by_turning_circle(pose, left, right, seconds)
    return x, y, math.degrees(heading)


def in_pieces(n, share=0.0):
    """Straight pieces, each in a heading a share of its own turn on from its first one."""

    def step(pose, left, right, seconds):
        (x, y, heading), (v, w) = pose, speeds(left, right)
        bearings = heading + w * seconds / n * (np.arange(n) + share)
        way = v * seconds / n
        return x + way * np.cos(bearings).sum(), y + way * np.sin(bearings).sum(), heading + w * seconds

    return step


def distances(outline, points):
    return np.linalg.norm(outline[:, None] - points[None], axis=2)


def seen_by_tree(outline, points, reach):
    return float((cKDTree(points).query(outline)[0] <= reach).mean()) if len(points) else 0


def seen_by_loop(outline, points, reach):
    near = 0
    for place in outline:
        near += any(math.dist(place, point) <= reach for point in points)
    return near / len(outline)


def seen_by_matrix(outline, points, reach):
    return (distances(outline, points) <= reach).any(axis=1).mean()


def unless_empty(share):
    return lambda outline, points, reach: share(outline, points, reach) if len(points) else 0.0


ANSWERS = {
    "drive_step": {
        "right": {"turning circle": by_turning_circle, "chord": by_chord, "integration": by_integration},
        "wrong": {
            "old heading": (straight_at(0.0), "goes straight in its old heading"),
            "new heading": (straight_at(1.0), "turns first and goes straight"),
            "middle heading": (straight_at(0.5), "shorter than the arc"),
            "left for right": (
                lambda pose, left, right, seconds: by_chord(pose, right, left, seconds),
                "It turns the wrong way",
            ),
            "nan when straight": (nan_when_straight, "go straight on"),
            "no radius": (with_speeds(no_radius), "times the wheel's radius R"),
            "no axle": (with_speeds(no_axle), "divided by the axle A"),
            "no half": (with_speeds(no_half), "the mean of both speeds"),
            "along x": (along_x, "turn it by the old heading first"),
            "heading kept": (heading_kept, "add the turn"),
            "a second": (lambda pose, left, right, seconds: by_chord(pose, left, right, 1.0), "multiply by the time"),
            "a tenth": (lambda pose, left, right, seconds: by_chord(pose, left, right, 0.1), "multiply by the time"),
            "degrees": (in_degrees, "degrees and radians"),
            "two thousand pieces": (in_pieces(2000), "never gets exact"),
            "midpoint pieces": (in_pieces(20, 0.5), "never gets exact"),
            "a place": (lambda pose, left, right, seconds: pose[:2], "has a heading as well"),
        },
        "error": {"divides by zero": (divides_by_zero, "ZeroDivisionError")},
    },
    "share_seen": {
        "right": {
            "tree": seen_by_tree,
            "loop": seen_by_loop,
            "matrix": lambda outline, points, reach: seen_by_matrix(outline, points, reach) if len(points) else 0.0,
        },
        "wrong": {
            "nan for none": (
                lambda outline, points, reach: seen_by_matrix(outline, points, reach) if len(points) else math.nan,
                "nothing is seen, 0",
            ),
            "points": (
                unless_empty(lambda outline, points, reach: seen_by_matrix(points, outline, reach)),
                "ask for each place of the outline",
            ),
            "points per place": (
                unless_empty(
                    lambda outline, points, reach: (
                        (distances(points, outline) <= reach).any(axis=1).sum() / len(outline)
                    )
                ),
                "count places, not points",
            ),
            "pairs": (
                unless_empty(lambda outline, points, reach: (distances(outline, points) <= reach).mean()),
                "share of all pairs",
            ),
            "a square": (
                unless_empty(
                    lambda outline, points, reach: (
                        (np.abs(outline[:, None] - points[None]) <= reach).all(axis=2).any(axis=1).mean()
                    )
                ),
                "That reach is a square",
            ),
            "squared": (
                unless_empty(lambda outline, points, reach: (distances(outline, points) ** 2 <= reach).any(1).mean()),
                "is a root missing?",
            ),
            "a count": (
                unless_empty(lambda outline, points, reach: (distances(outline, points) <= reach).any(1).sum()),
                "divide by the number of places",
            ),
            "per cent": (lambda outline, points, reach: 100 * seen_by_tree(outline, points, reach), "per cent"),
            "missed": (lambda outline, points, reach: 1 - seen_by_tree(outline, points, reach), "1 minus"),
            "a guess": (lambda outline, points, reach: 0.5, "For example share_seen("),
        },
        "error": {
            "a minimum of nothing": (lambda o, p, reach: (distances(o, p).min(axis=1) <= reach).mean(), "no identity")
        },
    },
}
