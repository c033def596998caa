"""Lesson 10: which readings are hits, how far these lie from their walls, and the step that mends a pose."""

# ruff: noqa: ARG005 (a wrong answer may leave out what it is given)

import math

import numpy as np
from scipy.optimize import approx_fprime

INF = math.inf


def cleaned_where(keep, none=INF):
    return lambda ranges, low, high: np.where(keep(ranges, low, high), ranges, none)


def is_hit(r, low, high):
    return (r > 0) & (r >= low) & (r < high)


def cleaned_in_place(ranges, range_min, range_max):
    ranges[np.isnan(ranges)] = INF
    ranges[(ranges <= 0) | (ranges < range_min) | (ranges >= range_max)] = INF
    return ranges


def cleaned_by_list(ranges, range_min, range_max):
    return [r if r > 0 and range_min <= r < range_max else INF for r in ranges.tolist()]


def cleaned_on_a_copy(ranges, range_min, range_max):
    return cleaned_in_place(ranges.copy(), range_min, range_max)


def turning(angle):
    return np.array([(math.cos(angle), -math.sin(angle)), (math.sin(angle), math.cos(angle))])


def by_matrix(pose, hits, normals, offsets):
    return ((hits @ turning(pose[2]).T + pose[:2]) * normals).sum(axis=1) - offsets


def by_complex(pose, hits, normals, offsets):
    places = complex(*pose[:2]) + (hits[:, 0] + 1j * hits[:, 1]) * np.exp(1j * pose[2])
    return [(p * complex(*n).conjugate()).real - d for p, n, d in zip(places, normals, offsets, strict=True)]


def at(place):
    """Residuals of hits at other places."""
    return lambda pose, hits, normals, offsets: (place(pose, hits) * normals).sum(axis=1) - offsets


def jacobian(pose, hits, normals):
    arm = hits @ turning(pose[2]).T
    return np.column_stack([normals, normals[:, 1] * arm[:, 0] - normals[:, 0] * arm[:, 1]])


def step_with(matrix):
    """The step with another third column, or other columns."""

    def step(pose, hits, normals, offsets):
        moved = np.linalg.pinv(matrix(pose, hits, normals)) @ by_matrix(pose, hits, normals, offsets)
        return pose - np.pad(moved, (0, 3 - len(moved)))

    return step


def by_pinv(pose, hits, normals, offsets):
    return step_with(jacobian)(pose, hits, normals, offsets)


def by_differences(pose, hits, normals, offsets):
    """A Jacobian by differences, hit by hit."""
    if len(hits) == 0:
        return tuple(pose)
    pairs = list(zip(hits, normals, offsets, strict=True))
    rows = [approx_fprime(pose, lambda q, u=u, n=n, d=d: n @ (q[:2] + turning(q[2]) @ u) - d) for u, n, d in pairs]
    return tuple(pose + np.linalg.lstsq(np.array(rows), -by_matrix(pose, hits, normals, offsets), rcond=None)[0])


def by_normal_equations(pose, hits, normals, offsets):
    J = jacobian(pose, hits, normals)
    return pose - np.linalg.pinv(J.T @ J, rcond=1e-10) @ (J.T @ by_matrix(pose, hits, normals, offsets))


def no_inverse(pose, hits, normals, offsets):
    J = jacobian(pose, hits, normals)
    return pose - np.linalg.solve(J.T @ J, J.T @ by_matrix(pose, hits, normals, offsets))


def stays_unless_sure(pose, hits, normals, offsets):
    J = jacobian(pose, hits, normals)
    if len(hits) < 3 or np.linalg.matrix_rank(J) < 3:
        return pose
    return by_pinv(pose, hits, normals, offsets)


def third(column):
    """The step with another third column, of pose, hits and normals."""
    return step_with(lambda pose, hits, normals: np.column_stack([normals, column(pose, hits, normals)]))


def until_it_rests(pose, hits, normals, offsets):
    for _ in range(8):
        pose = by_pinv(pose, hits, normals, offsets)
    return pose


ANSWERS = {
    "clean_ranges": {
        "right": {
            "where": cleaned_where(is_hit),
            "list": cleaned_by_list,
            "on a copy": cleaned_on_a_copy,
        },
        "wrong": {
            "0 kept without a minimum": (cleaned_where(lambda r, low, high: (r >= low) & (r < high)), "still writes 0"),
            "0 kept": (cleaned_where(lambda r, low, high: (r == 0) | is_hit(r, low, high)), "A 0 is kept"),
            "NaN kept": (cleaned_where(lambda r, low, high: np.isnan(r) | is_hit(r, low, high)), "NaN is kept"),
            "what is none": (cleaned_where(lambda r, low, high: ~((r < low) | (r >= high))), "NaN is kept"),
            "maximum kept": (
                cleaned_where(lambda r, low, high: (r > 0) & (r >= low) & (r <= high)),
                "The greatest range itself is kept",
            ),
            "beyond kept": (
                cleaned_where(lambda r, low, high: (r > 0) & (r >= low) & np.isfinite(r)),
                "beyond the greatest range are kept",
            ),
            "below kept": (cleaned_where(lambda r, low, high: (r > 0) & (r < high)), "below the least range are kept"),
            "minimum left out": (
                cleaned_where(lambda r, low, high: (r > low) & (r < high)),
                "The least range itself is a hit",
            ),
            "maximum for none": (
                lambda r, low, high: np.where(is_hit(r, low, high), r, high),
                "that invents a wall there",
            ),
            "clipped": (
                lambda r, low, high: np.clip(np.where(np.isfinite(r), r, high), low, high),
                "For example clean_ranges(",
            ),
            "0 for none": (cleaned_where(is_hit, 0.0), "for all others write inf"),
            "NaN for none": (cleaned_where(is_hit, math.nan), "for all others write inf"),
            "left out": (lambda r, low, high: r[is_hit(r, low, high)], "beam k must stay beam k"),
            "in place": (cleaned_in_place, "changes what it is given"),
        },
        "error": {
            "one number": (lambda r, low, high: r if low <= r < high else INF, "truth value of an array"),
        },
    },
    "wall_residuals": {
        "right": {"matrix": by_matrix, "complex": by_complex},
        "wrong": {
            "absolute": (lambda *args: np.abs(by_matrix(*args)), "on which side of the wall"),
            "other way round": (lambda *args: -by_matrix(*args), "The sign is the other way round"),
            "not turned": (at(lambda pose, hits: hits + pose[:2]), "turn them by its heading first"),
            "turned back": (at(lambda pose, hits: hits @ turning(pose[2]) + pose[:2]), "turned the wrong way"),
            "not moved": (at(lambda pose, hits: hits @ turning(pose[2]).T), "not moved to where the robot stands"),
            "moved first": (
                at(lambda pose, hits: (hits + pose[:2]) @ turning(pose[2]).T),
                "turns the robot about the middle of the arena",
            ),
            "no offset": (
                lambda pose, hits, normals, offsets: by_matrix(pose, hits, normals, 0 * offsets),
                "the wall is at d",
            ),
            "all pairs": (
                lambda pose, hits, normals, offsets: (hits @ turning(pose[2]).T + pose[:2]) @ normals.T - offsets,
                "hit k belongs to wall k alone",
            ),
            "squares": (lambda *args: by_matrix(*args) ** 2, "The squares are taken too early"),
            "sum of squares": (lambda *args: (by_matrix(*args) ** 2).sum(), "The squares are taken too early"),
        },
        "error": {
            "no transpose": (
                lambda pose, hits, normals, offsets: turning(pose[2]) @ hits @ normals.T - offsets,
                "matmul",
            ),
        },
    },
    "newton_step": {
        "right": {
            "pseudo-inverse": by_pinv,
            "differences": by_differences,
            "normal equations": by_normal_equations,
        },
        "wrong": {
            "stays unless sure": (stays_unless_sure, "Right wherever the walls tell the whole pose"),
            "uphill": (lambda pose, *seen: pose + (pose - by_pinv(pose, *seen)), "It goes uphill"),
            "the step": (lambda pose, *seen: by_pinv(pose, *seen) - pose, "That is the step alone"),
            "down the slope": (
                lambda pose, hits, n, d: pose - jacobian(pose, hits, n).T @ by_matrix(pose, hits, n, d),
                "how long it must be",
            ),
            "place alone": (step_with(lambda pose, hits, normals: normals), "the heading is not"),
            "arms as seen": (
                third(lambda pose, hits, n: n[:, 1] * hits[:, 0] - n[:, 0] * hits[:, 1]),
                "turn them by its heading first",
            ),
            "about the origin": (
                third(lambda pose, hits, n: (jacobian(pose, hits + pose[:2] @ turning(pose[2]), n))[:, 2]),
                "Take its place off",
            ),
            "along the arm": (
                third(lambda pose, hits, n: ((hits @ turning(pose[2]).T) * n).sum(axis=1)),
                "not along it",
            ),
            "the wrong way": (third(lambda pose, hits, n: -jacobian(pose, hits, n)[:, 2]), "moves towards (-y, x)"),
            "many": (until_it_rests, "That is where many steps lead"),
        },
        "error": {"no inverse": (no_inverse, "np.linalg.lstsq then takes the smallest")},
    },
}
