"""Simple: how much there is to read in ``robust``, and how far the points of ``measure_shape`` travel.

A stop is a function that has all the points in its hands, under any name, shifted or in another order; what only checks
them is none. Stops are taken in the order in which one rectangle's points first come to them; a return is a step to a
file that was left before. So counted, the first edition had 38 stops in 10 files, 16 returns and 40 names.
"""

from __future__ import annotations

import ast
import sys
from collections.abc import Iterator
from pathlib import Path
from types import FrameType
from typing import Any

import numpy as np

import primkit as pk

from .figures import Figure, number

Floats = np.ndarray
PACKAGE = Path(pk.__file__).parent
CHECKS = "arguments.py"
N_POINTS = 200  # no more: a part of many points may be fitted first, and that is not all of them
LINES, CONSTANTS = 2034, 70  # at most
FILES, RETURNS, NAMES = 9, 11, 38  # at most: one less than counted by hand in the first edition


def simple(_n: int, _seed: int) -> Iterator[Figure]:
    """Lines and named constants of ``robust``; and the way of the points through ``measure_shape``."""
    files = sorted((PACKAGE / "robust").rglob("*.py"))
    texts = [path.read_text(encoding="utf-8") for path in files]
    yield number("lines of robust", sum(len(text.splitlines()) for text in texts), len(files), at_most=LINES)
    yield number("named constants of robust", sum(map(n_constants, texts)), len(files), at_most=CONSTANTS)
    way, names = way_of(pk.Polygon([(0, 0), (0.2, 0), (0.2, 0.1), (0, 0.1)]).outline(N_POINTS))
    files_there = [file for file, _ in way]
    visits = [file for file, before in zip(files_there, [None, *files_there], strict=False) if file != before]
    yield number("functions that the points come to", len(way), 1)
    yield number("    in how many files", len(set(visits)), 1, at_most=FILES)
    yield number("    returns to a file already left", len(visits) - len(set(visits)), 1, at_most=RETURNS)
    yield number("    names that the points have in these functions", len(names), 1, at_most=NAMES)


def n_constants(text: str) -> int:
    """Return how many names in capitals a module binds.

    >>> n_constants("A, B = 1, 2\\nC: int = 3\\nd = 4")
    3
    """
    bound: list[ast.expr] = []
    for node in ast.parse(text).body:
        bound += (
            node.targets if isinstance(node, ast.Assign) else [node.target] if isinstance(node, ast.AnnAssign) else []
        )
    names = [name for target in bound for name in ast.walk(target) if isinstance(name, ast.Name)]
    return sum(name.id.isupper() for name in names)


def way_of(points: Floats) -> tuple[list[tuple[str, str]], set[tuple[str, str, str]]]:
    """Return each (file, function) that the points come to, in this order, and with each the names they have there."""
    way: dict[tuple[str, str], None] = {}
    names: set[tuple[str, str, str]] = set()
    shape = in_shape(points)

    def at(frame: FrameType, event: str, _: Any) -> Any:
        file = Path(frame.f_code.co_filename)
        if PACKAGE not in file.parents or file.name == CHECKS or frame.f_code.co_name.startswith("<"):
            return None
        here = (str(file.relative_to(PACKAGE)), frame.f_code.co_qualname)
        if event in ("call", "return"):
            for name, value in frame.f_locals.items():
                if isinstance(value, np.ndarray) and value.shape == points.shape and same(in_shape(value), shape):
                    way.setdefault(here)
                    names.add((*here, name))
        return at

    before = sys.gettrace()
    sys.settrace(at)
    try:
        pk.measure_shape(points, 0.0005, rng=0)
    finally:
        sys.settrace(before)
    return list(way), names


def in_shape(points: Floats) -> Floats:
    """Return points about their middle, in an order of their own."""
    local = points - points.mean(axis=0)
    return local[np.lexsort(local.round(9).T)]


def same(one: Floats, other: Floats) -> bool:
    return bool(np.allclose(one, other, rtol=0, atol=1e-9))
