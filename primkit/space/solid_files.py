"""Solid files: scenes, and what was found in them, as JSON and back.

In:  solids, or what ``find_solids`` found.
Out: a text: ``{"format": "primkit solids", "version": 1, "solids": [...]}``, all lengths in metres.

>>> scene = Scene([Sphere((1, 0, 0.5), 0.5), Cylinder((0, 2, 0.4), (0, 0, 1), 0.2, 0.8)])
>>> as_json(from_json(as_json(scene.solids)).solids) == as_json(scene.solids)
True
>>> from_json('{"format": "primkit solids", "version": 1, "solids": [{"kind": "cone"}]}')
Traceback (most recent call last):
    ...
ValueError: solid 0 must be a sphere, cylinder or box with its numbers, got {'kind': 'cone'}

A solid that was found also has ``others``, and of each size its standard deviation (``std``) and the interval that
holds it (``between``; null: no beam bounds it). Reading takes the solids alone.
"""

from __future__ import annotations

import json
from collections.abc import Iterable
from typing import Any

import numpy as np

from ..arguments import short
from .explanations import FoundSolid
from .scenes import Scene
from .solids import Box, Cylinder, Solid, Sphere

MAKERS: dict[str, type[Solid]] = {each.kind: each for each in (Sphere, Cylinder, Box)}


def as_json(solids: Iterable[Solid | FoundSolid]) -> str:
    """Return solids, or what was found, as a JSON text."""
    told = {"format": "primkit solids", "version": 1, "solids": [_told(each) for each in solids]}
    return json.dumps(told, indent=1, allow_nan=False) + "\n"


def from_json(text: str) -> Scene:
    """Return the scene that a JSON text tells of; ValueError in one sentence if it tells of none."""
    try:
        told = json.loads(text)
    except (ValueError, RecursionError):
        raise ValueError(f"solids must be valid JSON, got {short(text)}") from None
    if not isinstance(told, dict) or (told.get("format"), told.get("version")) != ("primkit solids", 1):
        raise ValueError(f'solids must have "format": "primkit solids", "version": 1, got {short(told)}')
    solids = told.get("solids")
    if not isinstance(solids, list):
        raise ValueError(f"solids must be a list, got {short(solids)}")
    return Scene(_solid(k, each) for k, each in enumerate(solids))


def _told(each: Solid | FoundSolid) -> dict[str, Any]:
    solid = each.solid if isinstance(each, FoundSolid) else each
    told = {"kind": solid.kind} | {name: np.asarray(getattr(solid, name)).tolist() for name in solid.given}
    if isinstance(each, FoundSolid):
        between = {name: [low, high if high < np.inf else None] for name, (low, high) in each.between.items()}
        told |= {"others": list(each.others), "std": each.std, "between": between}
    return told


def _solid(k: int, told: Any) -> Solid:
    kind = told.get("kind") if isinstance(told, dict) else None
    if not isinstance(kind, str) or kind not in MAKERS or not set(MAKERS[kind].given) <= set(told):
        raise ValueError(f"solid {k} must be a sphere, cylinder or box with its numbers, got {short(told)}")
    try:
        return MAKERS[kind](*(told[name] for name in MAKERS[kind].given))
    except ValueError as error:
        raise ValueError(f"solid {k}: {error}") from None
