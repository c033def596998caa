"""Edits: what may have been meant in each place of a function, put there one after the other.

In:  a function's syntax tree.
Out: the kind of each edit and its line, while it stands in the tree.

>>> tree = ast.parse("def f(a, b): return a - b")
>>> [(kind, line, ast.unparse(tree.body[0].body)) for kind, line in edits(tree, "f")]
[('sign', 1, 'return a + b'), ('order', 1, 'return b - a')]
>>> ast.unparse(tree.body[0].body)
'return a - b'
"""

from __future__ import annotations

import ast
import copy
from collections.abc import Iterator, Sequence
from typing import Any

from ..own_code import Line

OPPOSITE = {"min": "max", "argmin": "argmax", "minimum": "maximum", "any": "all", "amin": "amax", "nanmin": "nanmax"}
OPPOSITE |= {other: name for name, other in OPPOSITE.items()}
COMPARISONS = ((ast.Lt, ast.LtE, ast.Gt, ast.GtE), (ast.Eq, ast.NotEq))
SIGNS = {ast.Add: ast.Sub, ast.Sub: ast.Add}
ORDERED = (ast.Sub, ast.Div, ast.FloorDiv, ast.Mod, ast.MatMult, ast.Pow)
TURNS, ARCS = {"cos": "sin", "sin": "cos"}, {"arctan2", "atan2", "arctan", "atan", "arccos", "acos", "arcsin", "asin"}
DEGREE_CALLS = {"radians", "degrees", "deg2rad", "rad2deg"}
ALONG = {"sum", "mean", "median", "min", "max", "argmin", "argmax", "any", "all", "norm", "roll", "cumsum", "diff"}
ALONG |= {"sort", "argsort", "unique", "std", "prod", "stack", "concatenate", "ptp", "average", "argpartition"}


def edits(tree: ast.Module, name: str, rank: int = 0, near: Line | None = None) -> Iterator[tuple[str, int]]:
    """Put one thing after the other into the tree, and yield (kind, line) while it stands there.

    With rank 0 something else in a place, with rank 1 something more.
    """
    used = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}
    slots = list(_slots(tree))
    if near:
        slots.sort(key=lambda slot: abs(_line(slot[3], slot[0]) - near.number))
    for parent, field, n, node in slots:
        options = list(_more(node, parent, field) if rank else _instead(node, used))
        if rank and isinstance(node, ast.arguments) and getattr(parent, "name", "") == name:
            options += [("order", new) for new in _exchanged(node)]
        for kind, new in options:
            placed = ast.fix_missing_locations(ast.copy_location(new, node)) if hasattr(node, "lineno") else new
            _put(parent, field, n, placed)
            yield kind, _line(node, parent)
        if options:
            _put(parent, field, n, node)


def _slots(tree: ast.AST) -> Iterator[tuple[ast.AST, str, int | None, ast.AST]]:
    """Yield each node with the place that it stands in: parent, field, and number in a list."""
    for parent in ast.walk(tree):
        for field, value in ast.iter_fields(parent):
            if field in ("annotation", "returns", "decorator_list", "type_comment"):
                continue
            for n, node in enumerate(value) if isinstance(value, list) else [(None, value)]:
                if isinstance(node, ast.AST):
                    yield parent, field, n, node


def _line(node: ast.AST, parent: ast.AST) -> int:
    return int(getattr(node, "lineno", getattr(parent, "lineno", 1)))


def _put(parent: ast.AST, field: str, n: int | None, node: ast.AST) -> None:
    if n is None:
        setattr(parent, field, node)
    else:
        getattr(parent, field)[n] = node


def _instead(node: ast.AST, used: set[str]) -> Iterator[tuple[str, ast.AST]]:
    """Yield (kind, what may have been meant) in the place of a node."""
    match node:
        case ast.Compare(ops=ops):
            for n, op in enumerate(ops):
                bound = node.comparators[n]
                counted = isinstance(bound, ast.Constant) and type(bound.value) is int
                for other in next((sum(COMPARISONS, ()) if counted else s for s in COMPARISONS if type(op) in s), ()):
                    if other is not type(op):
                        yield "comparison", _with(node, ops=[*ops[:n], other(), *ops[n + 1 :]])
        case ast.BoolOp(op=op):
            yield "comparison", _with(node, op=ast.Or() if isinstance(op, ast.And) else ast.And())
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            yield "sign", operand
        case ast.UnaryOp(op=ast.Not() | ast.Invert(), operand=operand):
            yield "comparison", operand
        case ast.Attribute(value=value, attr="T"):
            yield "axis", value
        case ast.Call():
            yield from _other_calls(node)
        case ast.Subscript(slice=place):
            yield from _other_places(node, place)
        case ast.Name(id=name) if len(name) < 12:
            for twin in (name.replace("x", "y"), name.replace("y", "x")):
                if twin != name and twin in used and isinstance(node.ctx, ast.Load):
                    yield "axis", _with(node, id=twin)
    if isinstance(node, (ast.BinOp, ast.AugAssign)) and type(node.op) in SIGNS:
        yield "sign", _with(node, op=SIGNS[type(node.op)]())
    if isinstance(node, ast.BinOp) and isinstance(node.op, ORDERED):
        yield "order", _with(node, left=node.right, right=node.left)
    if isinstance(node, (ast.Tuple, ast.List)) and not any(isinstance(each, ast.Slice) for each in node.elts):
        for n in range(len(node.elts) - 1):
            yield "order", _with(node, elts=_swapped(node.elts, n, n + 1))
    if isinstance(node, ast.Constant) and type(node.value) is int:
        yield from (("off by one", ast.Constant(node.value + step)) for step in (1, -1))
        if node.value in (90, 180, 360):
            yield "degrees", _call("radians", node)
    if isinstance(node, ast.BinOp) and isinstance(node.op, (ast.Add, ast.Sub)) and _is_one(node.right):
        yield "off by one", node.left


def _other_calls(node: ast.Call) -> Iterator[tuple[str, ast.AST]]:
    """Yield what may have been meant in the place of a call."""
    name = _called(node)
    if name in OPPOSITE:
        yield "comparison", _renamed(node, OPPOSITE[name])
    if name in ("abs", "fabs", "absolute") and node.args:
        yield "sign", node.args[0]
    if name in TURNS:
        yield "axis", _renamed(node, TURNS[name])
    if name in DEGREE_CALLS:
        yield "degrees", node.args[0]
        yield "degrees", _renamed(node, "degrees" if name in ("radians", "deg2rad") else "radians")
    others = [keyword for keyword in node.keywords if keyword.arg != "axis"]
    if len(others) < len(node.keywords) or name in ALONG:
        for axis in (0, 1, 2):
            yield "axis", _with(node, keywords=[*others, ast.keyword("axis", ast.Constant(axis))])
    if len(others) < len(node.keywords):
        yield "axis", _with(node, keywords=others)
    for n in range(len(node.args) - 1):
        yield "order", _with(node, args=_swapped(node.args, n, n + 1))


def _other_places(node: ast.Subscript, place: ast.expr) -> Iterator[tuple[str, ast.AST]]:
    """Yield what may have been meant in the place of an index or a slice."""
    parts = place.elts if isinstance(place, ast.Tuple) else [place]
    if isinstance(parts[-1], ast.Constant) and parts[-1].value in (0, 1):
        turned = ast.Constant(int(parts[-1].value == 0))
        yield "axis", _with(node, slice=_with(place, elts=[*parts[:-1], turned]) if len(parts) > 1 else turned)
    if isinstance(place, ast.Tuple):
        yield "axis", _with(node, slice=_with(place, elts=place.elts[::-1]))
    if isinstance(place, ast.Slice):
        for side, none in (("lower", ast.Constant(1)), ("upper", ast.Constant(-1))):
            there = getattr(place, side)
            news = [none] if there is None else [_plus(there, 1), _plus(there, -1), None]
            yield from (("off by one", _with(node, slice=_with(place, **{side: new}))) for new in news)


def _more(node: ast.AST, parent: ast.AST, field: str) -> Iterator[tuple[str, ast.AST]]:
    """Yield what may have been left out at a node."""
    if not isinstance(node, ast.expr) or isinstance(getattr(node, "ctx", None), ast.Store):
        return
    name, outer = _called(node), _called(parent)
    if name in ARCS:
        yield "degrees", _call("radians", node)
    if (outer in TURNS or outer == "exp") and field == "args":
        yield "degrees", _call("radians", node)
        yield "degrees", _call("degrees", node)
    if name == "len" or (outer == "range" and field == "args"):
        yield from (("off by one", _plus(node, step)) for step in (1, -1))
    if isinstance(parent, ast.Subscript) and field == "slice" and not isinstance(node, (ast.Slice, ast.Tuple)):
        yield from (("off by one", _plus(node, step)) for step in (1, -1))
    result = isinstance(parent, (ast.Return, ast.Assign)) or (isinstance(parent, ast.Tuple) and field == "elts")
    if isinstance(parent, ast.If) and field == "test":
        yield "comparison", ast.UnaryOp(ast.Not(), node)
    if isinstance(node, (ast.Constant, ast.Compare, ast.Slice, ast.Tuple, ast.Lambda)):
        return
    if result or (isinstance(parent, ast.BinOp) and field == "left") or field in ("args", "right", "value"):
        if isinstance(parent, ast.Attribute) and not isinstance(node, ast.BinOp):
            return
        yield "sign", ast.UnaryOp(ast.USub(), node)
        yield "sign", _call("abs", node)
    elif field in ("left", "comparators"):
        yield "sign", _call("abs", node)
    if result or field == "args" or isinstance(getattr(parent, "op", None), ast.MatMult):
        yield "axis", ast.Attribute(node, "T", ast.Load())
    if result and not isinstance(parent, ast.Assign):
        yield "degrees", _call("radians", node)
        yield from (("off by one", _plus(node, step)) for step in (1, -1))


def _exchanged(node: ast.arguments) -> Iterator[ast.arguments]:
    """Yield the function's own arguments with two of them exchanged."""
    for n in range(len(node.args)):
        for m in range(n):
            yield _with(node, args=_swapped(node.args, m, n))


def _called(node: ast.AST) -> str:
    """Return the name of what is called, without its module; empty for what is no call."""
    return getattr(node.func, "attr", getattr(node.func, "id", "")) if isinstance(node, ast.Call) else ""


def _renamed(node: ast.Call, name: str) -> ast.Call:
    return _with(node, func=_with(node.func, **{"attr" if isinstance(node.func, ast.Attribute) else "id": name}))


def _with(node: Any, **fields: Any) -> Any:
    """Return a node with other fields."""
    new = copy.copy(node)
    for name, value in fields.items():
        setattr(new, name, value)
    return new


def _swapped(some: Sequence[Any], n: int, m: int) -> list[Any]:
    new = list(some)
    new[n], new[m] = new[m], new[n]
    return new


def _call(name: str, node: ast.expr) -> ast.Call:
    return ast.Call(ast.Attribute(ast.Name("_numpy", ast.Load()), name, ast.Load()), [node], [])


def _plus(node: Any, step: int) -> ast.BinOp:
    return ast.BinOp(node, ast.Add() if step > 0 else ast.Sub(), ast.Constant(1))


def _is_one(node: ast.AST) -> bool:
    return isinstance(node, ast.Constant) and node.value == 1
