"""Make the slips: six mutants of a right answer to each task, and list them.

In:  a right answer's source; see ``answers()``.
Out: ``slips.json``, and ``mutants()``: the same slips with their code.

A slip changes one place. There are six classes: comparison, sign, axis, order, off by one, degrees. Each task gets one
slip of each class that has a place in its answer; where a class has none, the others have more. Which place is taken
follows from a hash, and so does the half that a slip belongs to: ``open``, to look at while hints are written, or
``held out``. A slip that changes nothing that is asked for is taken out by hand in ``EQUIVALENT``, with the reason.
``fresh`` makes others by another seed, for a figure that nothing was tuned on.

    python -m tests.slips.make    # writes slips.json anew
"""

import ast
import copy
import json
from hashlib import sha256
from pathlib import Path

from . import right

FOLDER = Path(__file__).parent
SETS = FOLDER.parent.parent / "notebooks" / "assignments" / "source"
CLASSES = ("comparison", "sign", "axis", "order", "off by one", "degrees")
EACH = 6  # of a task

TRIG, ARC = {"cos", "sin", "tan", "exp"}, {"arctan2", "atan2", "arctan"}
TURNED = {ast.Lt: ast.Gt, ast.LtE: ast.GtE, ast.Gt: ast.Lt, ast.GtE: ast.LtE, ast.Eq: ast.NotEq, ast.NotEq: ast.Eq}
BOUNDARY = {ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt}
EXTREMES = {"min": "max", "max": "min", "argmin": "argmax", "argmax": "argmin", "minimum": "maximum"}
# Slips that change nothing that is asked for, and why.
EQUIVALENT = {
    "ray_segment, comparison 2": "no float cross product is exactly 1e-12",
    "ray_circle, comparison 2": "the robot stands on no outline to the last bit",
    "assign_points, order 1": "differences are squared",
    "inliers_of, order 1": "the absolute value is taken",
    "fit_line, order 1": "a scalar product has no order",
    "circle_rms, order 1": "differences are squared",
    "share_seen, order 1": "hypot has no sign",
    "ray_arc, comparison 1": "no hit lies on an arc's end to the last bit",
    "sonar_reading, comparison 2": "of a bearing on the cone's edge rounding decides",
    "wall_in_fog, sign 1": "samples come in both orders, and in one of them the side is right",
    "wall_in_fog, comparison 2": "no hit lies at exactly the threshold",
    "nut_or_coin, comparison 2": "no ratio is exactly 1.7",
    "compass_bias, off by one 1": "the range ends half a step further on, and holds the same angles or one more",
    "overlap_score, order 1": "intersection and union have no order",
    "meet, comparison 1": "no sine is exactly 1e-9",
    "match_shapes, comparison 1": "of two lists of one length either may be permuted",
    "sonar_reading, order 1": "the absolute value is taken",
    "sonar_reading, sign 2": "half a turn forwards is half a turn back",
    "k_medians, order 1": "the absolute value is taken",
    "wall_in_fog, comparison 1": "no hit lies at exactly the threshold",
    "pipe_center, off by one 1": "99 steps end where 100 end",
    "hexagon_corners, comparison 1": "the place inside lies on no side",
    "overlap_score, order 4": "intersection and union have no order",
    "parts, order 1": "errors are right on both sides alike, and turning the one list is turning the other back",
    "plane_through, order 1": "a plane has its three points in any order",
    "nearest_to, order 1": "differences are squared",
}


def answers():
    """Return task -> source of a right answer: a function, with the names it needs imported."""
    found = {}
    source = Path(right.__file__).read_text(encoding="utf-8")
    for node in ast.parse(source).body:
        if isinstance(node, ast.FunctionDef):
            found[node.name] = ast.unparse(node)
    for path in sorted(SETS.glob("ps*/ps*.ipynb")):
        for cell in json.loads(path.read_text(encoding="utf-8"))["cells"]:
            if cell["metadata"].get("nbgrader", {}).get("solution"):
                function = ast.parse("".join(cell["source"])).body[-1]
                function.body = function.body[1:]  # without the docstring
                found[function.name] = ast.unparse(function)
    return found


def named(node, names):
    """Tell whether a call is one of some functions, or methods."""
    called = getattr(node.func, "attr", getattr(node.func, "id", "")) if isinstance(node, ast.Call) else ""
    return called in names


def changed(node, **fields):
    """Return a node with other fields."""
    new = copy.deepcopy(node)
    for name, value in fields.items():
        setattr(new, name, value)
    return new


def call(name, node):
    return ast.Call(ast.Attribute(ast.Name("np", ast.Load()), name, ast.Load()), [copy.deepcopy(node)], [])


def renamed(node, name):
    func = changed(node.func, **{"attr" if isinstance(node.func, ast.Attribute) else "id": name})
    return changed(node, func=func)


def slips(node):
    """Yield (class, node in its place) for each slip at a node."""
    if isinstance(node, ast.Compare):
        for n, op in enumerate(node.ops):
            for table in (BOUNDARY, TURNED):
                if type(op) in table:
                    yield "comparison", changed(node, ops=[*node.ops[:n], table[type(op)](), *node.ops[n + 1 :]])
    if isinstance(node, ast.Call):
        name = getattr(node.func, "attr", getattr(node.func, "id", ""))
        if name in EXTREMES:
            yield "comparison", renamed(node, EXTREMES[name])
        if name in ("abs",):
            yield "sign", node.args[0]
        if name in ("cos", "sin"):
            yield "axis", renamed(node, {"cos": "sin", "sin": "cos"}[name])
            yield "degrees", changed(node, args=[call("degrees", node.args[0])])
            yield "degrees", changed(node, args=[call("radians", node.args[0])])
        if name in ARC:
            yield "degrees", call("degrees", node)
        if name in ("radians", "degrees"):
            yield "degrees", node.args[0]
        for n, keyword in enumerate(node.keywords):
            if keyword.arg == "axis" and isinstance(keyword.value, ast.Constant):
                others = [*node.keywords[:n], *node.keywords[n + 1 :]]
                turned = ast.keyword("axis", ast.Constant(0 if keyword.value.value else 1))
                yield "axis", changed(node, keywords=[*others, turned])
                yield "axis", changed(node, keywords=others)
        if len(node.args) >= 2 and not named(node, {"range", "zip", "hypot", "allclose", "max", "min"}):
            yield "order", changed(node, args=[node.args[1], node.args[0], *node.args[2:]])
        if name == "range":
            last = node.args[-1]
            yield "off by one", changed(node, args=[*node.args[:-1], ast.BinOp(last, ast.Sub(), ast.Constant(1))])
            yield "off by one", changed(node, args=[*node.args[:-1], ast.BinOp(last, ast.Add(), ast.Constant(1))])
    if isinstance(node, (ast.BinOp, ast.AugAssign)) and isinstance(node.op, (ast.Add, ast.Sub)):
        yield "sign", changed(node, op=ast.Sub() if isinstance(node.op, ast.Add) else ast.Add())
    if isinstance(node, ast.BinOp) and isinstance(node.op, (ast.Sub, ast.Div, ast.MatMult, ast.Mod)):
        yield "order", changed(node, left=node.right, right=node.left)
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        yield "sign", node.operand
    if isinstance(node, ast.Attribute) and node.attr == "T":
        yield "axis", node.value
    if isinstance(node, ast.Subscript):
        if isinstance(node.slice, ast.Constant) and node.slice.value in (0, 1):
            yield "axis", changed(node, slice=ast.Constant(1 - node.slice.value))
        if isinstance(node.slice, ast.Tuple) and isinstance(node.slice.elts[-1], ast.Constant):
            last = node.slice.elts[-1].value
            if last in (0, 1):
                turned = changed(node.slice, elts=[*node.slice.elts[:-1], ast.Constant(1 - last)])
                yield "axis", changed(node, slice=turned)
            yield "axis", changed(node, slice=changed(node.slice, elts=node.slice.elts[::-1]))
        if isinstance(node.slice, (ast.Name, ast.BinOp)):
            yield "off by one", changed(node, slice=ast.BinOp(node.slice, ast.Sub(), ast.Constant(1)))
    if isinstance(node, ast.Slice):
        for side in ("lower", "upper"):
            if getattr(node, side) is not None:
                yield "off by one", changed(node, **{side: ast.BinOp(getattr(node, side), ast.Add(), ast.Constant(1))})
    if isinstance(node, ast.Constant) and type(node.value) is int:
        yield "off by one", ast.Constant(node.value + 1)
        if node.value > 0:
            yield "off by one", ast.Constant(node.value - 1)
    if isinstance(node, ast.Call) and named(node, {"len"}):
        yield "off by one", ast.BinOp(copy.deepcopy(node), ast.Sub(), ast.Constant(1))
    if isinstance(node, ast.Tuple) and len(node.elts) >= 2 and not any(isinstance(e, ast.Slice) for e in node.elts):
        yield "order", changed(node, elts=[node.elts[1], node.elts[0], *node.elts[2:]])


def all_slips(source):
    """Yield (class, before, after, code of the whole function) for each slip in a function."""
    count = len(list(ast.walk(ast.parse(source))))
    for n in range(count):
        for which in range(9):
            tree = ast.parse(source)
            parents = {
                child: (parent, field, index)
                for parent in ast.walk(tree)
                for field, value in ast.iter_fields(parent)
                for index, child in enumerate(value if isinstance(value, list) else [value])
                if isinstance(child, ast.AST)
            }
            node = list(ast.walk(tree))[n]
            if node not in parents or isinstance(node, (ast.arguments, ast.arg)):
                break
            options = list(slips(node))
            if which >= len(options):
                break
            kind, new = options[which]
            parent, field, index = parents[node]
            if field == "returns" or field == "annotation":
                break
            before, after = ast.unparse(node), ast.unparse(ast.fix_missing_locations(new))
            if isinstance(getattr(parent, field), list):
                getattr(parent, field)[index] = new
            else:
                setattr(parent, field, new)
            yield kind, before, after, ast.unparse(ast.fix_missing_locations(tree))


def rank(*words):
    return sha256(" ".join(map(str, words)).encode()).hexdigest()


def fresh(seed, each):
    """Return so many slips of each task by another seed, none of which is in the list."""
    known = {slip["code"] for slip in mutants()}
    return [slip for slip in mutants(seed, each) if slip["code"] not in known]


def mutants(seed="", each=EACH):
    """Return the slips of all tasks: dictionaries with task, name, class, before, after, half and code."""
    found = []
    for task, source in answers().items():
        by_class = {kind: [] for kind in CLASSES}
        for kind, before, after, code in all_slips(source):
            if code != source and all(code != other[2] for other in by_class[kind]):
                by_class[kind].append((before, after, code))
        for kind in CLASSES:
            by_class[kind].sort(key=lambda slip, kind=kind: rank(*filter(None, (seed, task, kind, slip[2]))))
        taken = []
        for turn in range(each):
            for kind in CLASSES if not seed else sorted(CLASSES, key=lambda kind: rank(seed, task, kind)):
                if turn < len(by_class[kind]) and len(taken) < each:
                    before, after, code = by_class[kind][turn]
                    name = f"{task}, {kind} {turn + 1}"
                    half = "held out" if int(rank("half", name), 16) % 2 else "open"
                    taken.append(
                        {"name": name, "task": task, "class": kind, "half": half}
                        | {"before": before, "after": after, "code": code}
                    )
        found += taken
    return found


if __name__ == "__main__":
    rows = [{key: value for key, value in each.items() if key != "code"} for each in mutants()]
    text = ",\n".join(json.dumps(row, ensure_ascii=False) for row in rows)
    (FOLDER / "slips.json").write_text(f"[\n{text}\n]\n", encoding="utf-8")
