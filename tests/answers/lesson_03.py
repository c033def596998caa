"""Lesson 03: the two steps of K-Means, and the silhouette."""

# ruff: noqa: ARG005 (a wrong answer may leave out what it is given)

import math

import numpy as np
from scipy.spatial import cKDTree
from sklearn.metrics import silhouette_samples, silhouette_score
from sklearn.metrics.pairwise import pairwise_distances_argmin


def assign_by_tree(points, centers):
    return cKDTree(centers).query(points)[1]


def assign_by_loop(points, centers):
    labels = []
    for p in points:
        away = [math.dist(p, c) for c in centers]
        labels.append(away.index(min(away)))
    return labels


def assign_by_border(points, centers):
    """|p|^2 is the same for all centres: the nearest has the largest p . c - |c|^2 / 2."""
    return np.argmax(points @ centers.T - (centers**2).sum(axis=1) / 2, axis=1)


def assign_in_place(points, centers):
    points -= centers[0]
    return np.argmin(np.linalg.norm(points[:, None] - (centers - centers[0]), axis=2), axis=1)


def distances(points, centers):
    return np.linalg.norm(points[:, None] - centers, axis=2)


def update_by_sums(points, labels, centers):
    sizes = np.bincount(labels, minlength=len(centers))
    sums = np.column_stack([np.bincount(labels, weights=w, minlength=len(centers)) for w in points.T])
    return np.where(sizes[:, None] > 0, sums / np.maximum(sizes, 1)[:, None], centers)


def update_by_matrix(points, labels, centers):
    belongs = labels == np.arange(len(centers))[:, None]
    new = centers.copy()
    full = belongs.any(axis=1)
    new[full] = (belongs[full] @ points) / belongs[full].sum(axis=1, keepdims=True)
    return new.tolist()


def update_with(middle, empty):
    def update(points, labels, centers):
        groups = [points[labels == j] for j in range(len(centers))]
        return np.array([middle(own) if len(own) else empty(c) for own, c in zip(groups, centers, strict=True)])

    return update


def mean(own):
    return np.mean(own, axis=0)


def update_in_place(points, labels, centers):
    for j in set(labels.tolist()):
        centers[j] = points[labels == j].mean(axis=0)
    return centers


def silhouette_by_loop(points, labels):
    groups = {label: [p for p, own in zip(points, labels, strict=True) if own == label] for label in set(labels)}
    values = []
    for p, label in zip(points, labels, strict=True):
        if len(groups[label]) == 1:
            values.append(0.0)
            continue
        a = sum(math.dist(p, q) for q in groups[label]) / (len(groups[label]) - 1)
        b = min(sum(math.dist(p, q) for q in g) / len(g) for name, g in groups.items() if name != label)
        values.append((b - a) / max(a, b))
    return sum(values) / len(values)


def silhouette_with(score, *, itself=1, lone=0.0, next_group=min):
    def silhouette(points, labels):
        values = []
        apart = np.linalg.norm(points[:, None] - points, axis=2)
        for i, label in enumerate(labels):
            own = labels == label
            if own.sum() == 1:
                values.append(lone)
                continue
            a = apart[i, own].sum() / (own.sum() - itself)
            others = [apart[i, labels == other] for other in np.unique(labels) if other != label]
            b = next_group(d.mean() for d in others) if next_group else np.concatenate(others).mean()
            values.append(score(a, b))
        return float(np.mean(values))

    return silhouette


def usual(a, b):
    return (b - a) / max(a, b)


def silhouette_to_centers(points, labels):
    names = np.unique(labels)
    apart = np.linalg.norm(points[:, None] - [points[labels == name].mean(axis=0) for name in names], axis=2)
    values = []
    for row, label in zip(apart, labels, strict=True):
        own = names == label
        values.append(usual(row[own][0], row[~own].min()) if (labels == label).sum() > 1 else 0.0)
    return float(np.mean(values))


def silhouette_to_nearest(points, labels):
    values = []
    for i, label in enumerate(labels):
        away = np.linalg.norm(points - points[i], axis=1)
        own = labels == label
        values.append(usual(away[own].sum() / (own.sum() - 1), away[~own].min()) if own.sum() > 1 else 0.0)
    return float(np.mean(values))


def silhouette_of_the_others(points, labels):
    values = silhouette_samples(points, labels)
    return float(values[np.bincount(labels)[labels] > 1].mean())


ANSWERS = {
    "assign_points": {
        "right": {
            "tree": assign_by_tree,
            "loop": assign_by_loop,
            "border": assign_by_border,
            "sklearn": pairwise_distances_argmin,
        },
        "wrong": {
            "farthest": (lambda points, centers: distances(points, centers).argmax(axis=1), "a comparison"),
            "from one": (lambda points, centers: assign_by_tree(points, centers) + 1, "off by one"),
            "streets": (lambda points, centers: cKDTree(centers).query(points, p=1)[1], "the way along streets"),
            "only x": (lambda points, centers: assign_by_tree(points * [1, 0], centers * [1, 0]), "Only x is compared"),
            "table": (distances, "the distances themselves"),
            "other axis": (lambda points, centers: distances(points, centers).argmin(axis=0), "along which axis"),
            "in place": (assign_in_place, "changes what it is given"),
            "the least distance": (
                lambda points, centers: distances(points, centers).min(axis=1),
                "the number of the centre is asked for",
            ),
            "only y": (lambda points, centers: assign_by_tree(points * [0, 1], centers * [0, 1]), "Only y is compared"),
            "one for all": (lambda points, centers: distances(points, centers).argmin(), "one number for all points"),
            "floats": (lambda points, centers: assign_by_tree(points, centers).astype(float), "floats such as 0.0"),
            "no return": (lambda points, centers: None, "is there a return?"),
        },
        "error": {"one shape": (lambda points, centers: (points - centers).argmin(axis=1), "ValueError")},
    },
    "update_centers": {
        "right": {"sums": update_by_sums, "matrix": update_by_matrix},
        "wrong": {
            "not a number": (update_with(mean, lambda c: c * np.nan), "its centre stays where it was"),
            "numpy's own": (
                lambda points, labels, centers: np.array(
                    [points[labels == j].mean(axis=0) for j in range(len(centers))]
                ),
                "has no mean (0 / 0)",
            ),
            "left out": (
                lambda points, labels, centers: np.array([mean(points[labels == j]) for j in np.unique(labels)]),
                "is left out",
            ),
            "a list with nan": (
                lambda points, labels, centers: [mean(points[labels == j]).tolist() for j in range(len(centers))],
                "has no mean (0 / 0)",
            ),
            "no axis": (update_with(np.mean, np.mean), "averaged together"),
            "sum": (update_with(lambda own: own.sum(axis=0), lambda c: c), "That is the sum"),
            "origin": (update_with(mean, np.zeros_like), "sent to (0, 0)"),
            "median": (update_with(lambda own: np.median(own, axis=0), lambda c: c), "That is the median"),
            "box": (
                update_with(lambda own: (own.min(axis=0) + own.max(axis=0)) / 2, lambda c: c),
                "between the outermost points",
            ),
            "in place": (update_in_place, "changes what it is given"),
        },
        "error": {"no such group": (lambda points, labels, centers: points[labels == 9][0], "IndexError")},
    },
    "silhouette": {
        "right": {"sklearn": silhouette_score, "loop": silhouette_by_loop},
        "wrong": {
            "nan": (silhouette_with(usual, lone=np.nan), "divides 0 by 0"),
            "lone is one": (silhouette_with(usual, lone=1.0), "counts as 1"),
            "itself": (silhouette_with(usual, itself=0), "counts the point itself"),
            "all others": (silhouette_with(usual, next_group=None), "not to all other points"),
            "not divided": (silhouette_with(lambda a, b: b - a), "not yet divided"),
            "turned round": (silhouette_with(lambda a, b: usual(b, a)), "an order"),
            "centres": (silhouette_to_centers, "not to its centre"),
            "each point": (silhouette_samples, "one silhouette for each point"),
            "the farthest group": (silhouette_with(usual, next_group=max), "For example silhouette("),
            "itself, alone too": (silhouette_with(usual, itself=0, lone=1.0), "counts the point itself"),
            "the nearest point": (silhouette_to_nearest, "not the distance to the nearest point"),
            "lone left out": (silhouette_of_the_others, "count too, as 0"),
        },
        "error": {"of nothing": (lambda points, labels: 1 / 0, "ZeroDivisionError")},
    },
}
