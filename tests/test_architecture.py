"""The house plan, asserted from the syntax tree: what may import what, and what no module does.

Each rule is a function from source text to a list of sentences, one for each breach; so it can be shown a
broken example, and must report it.
"""

import ast
import re
import subprocess
import sys
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
PACKAGE = ROOT / "primkit"

# The story: a room (a module, or a folder of them) imports only rooms above it. The table of contents, __init__, loads
# rooms on first use; who imports it from inside could reach everything, so only the command line may.
# Beside the plan: ``palette`` holds the colours that the plots, the sliders and the scene's page have in common,
# without matplotlib; ``own_code`` is how a student's function is run and stopped; ``show`` is how nouns print and show
# themselves; ``themed`` is how a page is given a picture, and ``notebook`` has it done for figures; ``found`` the list
# that find_shapes returns; ``rest`` what a report tells of all in it that is no shape; ``installed`` what is here.
ORDER = (
    *("arguments", "own_code", "table", "themed", "installed"),
    *(
        "shapes",
        "random_shapes",
        "palette",
        "show",
        "world",
        "robot",
        "raycast",
        "faults",
        "rendered",
        "sensors",
        "lidar",
        "grid",
    ),
    *("segmentation", "ransac", "lines", "circles", "seen"),
    *("robust", "measure", "found", "account", "paper", "steps", "pipeline", "rest", "report", "evaluation"),
    *("space", "formats", "driving", "parts", "study", "plots", "widgets", "scene", "checks", "course"),
    *("notebook", "__init__", "commands", "__main__"),
)

# Rooms that know less than the order allows: the only ones that they import.
KNOWS_ONLY = {
    "raycast": ("arguments", "shapes", "world"),  # exact rays
    "robust": ("arguments", "shapes", "segmentation", "ransac", "lines", "circles", "seen"),  # no grid, LiDAR, pipeline
    "space": ("arguments", "table", "themed", "palette", "segmentation", "ransac"),  # not the board
    # no pipeline; ``installed`` for the line that adds an extra
    "formats": ("arguments", "installed", "shapes", "show", "world", "robot", "lidar", "measure", "found"),
}
# Rooms that others must not know, though these stand above them; and rooms that nobody knows but these.
KNOWS_NO = {"widgets": ("plots",), "scene": ("plots", "widgets"), "checks": ("plots", "widgets", "scene")}
KNOWN_TO = {
    "course": ("commands",),
    "space": ("widgets",),  # the slider of its lesson
    "parts": ("widgets",),  # likewise
    "widgets": (),
    "scene": (),
    "checks": ("course",),
    "study": ("plots", "widgets", "commands"),
}

# Heavy libraries, and the one room that may import each.
ONLY_USER = {
    "matplotlib": ("plots",),
    "mpl_toolkits": ("plots",),
    "ipywidgets": ("widgets", "scene"),
    "anywidget": ("widgets", "scene"),
    "sklearn": ("segmentation", "paper"),
    "lazy_loader": ("__init__",),
}

ENGINES = {"raycast", "robust"}  # folders that are no wing

# What numpy.random offers beside the functions of its global generator.
OWN_GENERATORS = {
    *("default_rng", "Generator", "BitGenerator", "SeedSequence", "RandomState"),
    *("PCG64", "PCG64DXSM", "Philox", "SFC64", "MT19937"),
}

# What scikit-learn feeds from numpy's global generator unless told otherwise.
SEEDED = {
    *("KMeans", "MiniBatchKMeans", "BisectingKMeans", "k_means", "kmeans_plusplus"),
    *("SpectralClustering", "GaussianMixture", "BayesianGaussianMixture"),
}

# A module of more than about 350 lines becomes a folder: a tenth is the "about".
MOST_LINES = 385

VISIBLE = {
    *("README.md", "environment.txt", "notebooks", "primkit", "data", "tests"),
    *("pyproject.toml", "LICENSE", "CITATION.cff"),
}
HIDDEN = {".binder", ".ci", ".github", ".site", ".gitattributes", ".gitignore"}


def module_name(path: Path) -> str:
    """Return the dotted name below primkit: "grid", "__init__", "widgets.scene", "widgets.__init__"."""
    return ".".join(path.relative_to(PACKAGE).with_suffix("").parts)


def imports(name: str, source: str) -> Iterator[tuple[int, str]]:
    """Yield (line, absolute dotted name) for each import, wherever it stands in the module called ``name``."""
    here = ["primkit", *name.split(".")[:-1]]  # the package that a relative import starts from
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            yield from ((node.lineno, alias.name) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = here[: len(here) - node.level + 1] if node.level else []
            start = ".".join([*base, *([node.module] if node.module else [])])
            yield from ((node.lineno, f"{start}.{alias.name}") for alias in node.names)


def room_of(target: str, rooms: Iterable[str]) -> str | None:
    """Return the room of primkit that a dotted name lies in; the package's own names lie in its __init__."""
    first, *rest = target.split(".")
    if first != "primkit":
        return None
    return rest[0] if rest and rest[0] in rooms else "__init__"


def wrong_way(name: str, source: str, order: tuple[str, ...] = ORDER) -> list[str]:
    """Report imports of a room that does not stand above this one, and rooms that the plan does not know."""
    room = name.split(".")[0]
    if room not in order:
        return [f"{name}: not a room of the house plan"]
    if room == "__init__":
        return []  # the table of contents names them all
    on_disk = {path.stem for path in PACKAGE.iterdir()}  # a room outside the plan is no name of __init__
    breaches = []
    for line, target in imports(name, source):
        other = room_of(target, {*order, *on_disk})
        if other in (None, room):
            continue
        if other not in order[: order.index(room)]:
            breaches.append(f"{name}:{line}: imports {other}, which does not stand above {room}")
    return breaches


def knows_too_much(name: str, source: str) -> list[str]:
    """Report imports of rooms that stand above this one, but that it must not know."""
    room = name.split(".")[0]
    if room in ("__init__", "__main__"):
        return []
    breaches = []
    for line, target in imports(name, source):
        other = room_of(target, ORDER)
        if other in (None, room):
            continue
        allowed = other in KNOWS_ONLY.get(room, (other,)) and other not in KNOWS_NO.get(room, ())
        if not allowed or room not in KNOWN_TO.get(other, (room,)):
            breaches.append(f"{name}:{line}: imports {other}, which {room} must not know")
    return breaches


def heavy(name: str, source: str) -> list[str]:
    """Report a heavy library that is imported outside the one room that may."""
    room = name.split(".")[0]
    return [
        f"{name}:{line}: imports {target.split('.')[0]}, which only {' and '.join(only)} may"
        for line, target in imports(name, source)
        if room not in (only := ONLY_USER.get(target.split(".")[0], (room,)))
    ]


def hidden_imports(name: str, source: str) -> list[str]:
    """Report imports that the other rules cannot see: by a call, or of everything with a star."""
    breaches = [f"{name}:{line}: imports *" for line, target in imports(name, source) if target.endswith(".*")]
    calls = {"importlib.import_module", "__import__", "builtins.__import__"}
    return breaches + [f"{name}:{line}: imports by a call" for line, used in uses(source) if used in calls]


def uses(source: str) -> Iterator[tuple[int, str]]:
    """Yield (line, full dotted name) for each name that is used, with ``np`` and the like spelled out."""
    tree = ast.parse(source)
    known = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            for alias in node.names:
                first = alias.name.split(".")[0]
                known[alias.asname or first] = alias.name if alias.asname else first
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            for alias in node.names:
                known[alias.asname or alias.name] = f"{node.module}.{alias.name}"
    for node in ast.walk(tree):
        parts, inner = [], node
        while isinstance(inner, ast.Attribute):
            parts.append(inner.attr)
            inner = inner.value
        if isinstance(inner, ast.Name):
            yield inner.lineno, ".".join([known.get(inner.id, inner.id), *reversed(parts)])


def global_random(name: str, source: str) -> list[str]:
    """Report the use of a random generator that is not the caller's."""
    breaches = {
        f"{name}:{line}: uses the global random generator: {target}"
        for line, target in [*imports(name, source), *uses(source)]
        if re.match(r"random(\.|$)", target)
        or ((match := re.match(r"numpy\.random\.(\w+)", target)) and match[1] not in OWN_GENERATORS)
    }
    for call in (node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.Call)):
        called = ast.unparse(call.func).split(".")[-1]
        if called == "default_rng" and not (call.args or call.keywords):
            breaches.add(f"{name}:{call.lineno}: default_rng() without the caller's rng")
        if called in SEEDED and "random_state" not in {keyword.arg for keyword in call.keywords}:
            breaches.add(f"{name}:{call.lineno}: {called} without random_state uses the global random generator")
    return sorted(breaches)


def talk(name: str, source: str) -> list[str]:
    """Report printing and warning; only the command line speaks to its user."""
    if name.split(".")[0] in ("commands", "__main__"):
        return []
    words = {"print", "builtins.print", *(() if name == "arguments" else ("warnings.warn",))}  # LikelyWrong, once
    return [f"{name}:{line}: calls {used}" for line, used in uses(source) if used in words]


def too_long(name: str, source: str) -> list[str]:
    """Report a module of more than about 350 lines."""
    lines = len(source.splitlines())
    return [f"{name}: {lines} lines, should become a folder of rooms"] if lines > MOST_LINES else []


def not_the_plan(tracked: Iterable[str]) -> list[str]:
    """Report what differs between the top level of the repository and the plan, from the paths that git tracks."""
    top = {path.split("/")[0] for path in tracked}
    return [f"not in the plan: {name}" for name in sorted(top - VISIBLE - HIDDEN)] + [
        f"missing: {name}" for name in sorted(VISIBLE - top)
    ]


def constants(source: str) -> Iterator[tuple[str, str]]:
    """Yield (name, value as it is written) for each constant of a module."""
    for node in ast.parse(source).body:
        if isinstance(node, ast.Assign | ast.AnnAssign) and node.value is not None:
            (target, value) = (node.targets[0] if isinstance(node, ast.Assign) else node.target), node.value
            together = isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple)
            pairs = zip(target.elts, value.elts, strict=True) if together else [(target, value)]
            yield from ((ast.unparse(t), ast.unparse(v)) for t, v in pairs if ast.unparse(t).isupper())


def two_values(sources: Iterable[str]) -> list[str]:
    """Report constants that have one name and different values."""
    values: dict[str, set[str]] = {}
    for source in sources:
        for name, value in constants(source):
            values.setdefault(name, set()).add(value)
    return [f"{name} has {len(some)} values" for name, some in sorted(values.items()) if len(some) > 1]


def two_files(names: Iterable[str]) -> list[str]:
    """Report a file name that two rooms share, unless they do the same for a lesson."""
    rooms: dict[str, set[str]] = {}
    for name in names:
        *room, file = name.split(".")
        rooms.setdefault(file, set()).add(".".join(room))
    lessons = {"checks", "widgets"}
    return [f"{file} in {sorted(some)}" for file, some in rooms.items() if len(some) > 1 and not some <= lessons]


def test_no_constant_has_two_values() -> None:
    assert two_values(path.read_text(encoding="utf-8") for path in MODULES) == []
    assert two_values(["REACH = 1  # m", "A, REACH = 2, 3"]) == ["REACH has 2 values"]


def test_no_file_name_stands_twice() -> None:
    names = [module_name(path) for path in MODULES if path.stem != "__init__"]
    assert two_files(names) == []
    assert two_files(["study.table", "table", "checks.rays", "widgets.rays"]) == ["table in ['', 'study']"]


RULES = (wrong_way, knows_too_much, heavy, hidden_imports, global_random, talk, too_long)
MODULES = sorted(PACKAGE.rglob("*.py"))


@pytest.mark.parametrize("rule", RULES, ids=lambda rule: rule.__name__)
@pytest.mark.parametrize("path", MODULES, ids=module_name)
def test_module_keeps_the_rule(path: Path, rule: Callable[[str, str], list[str]]) -> None:
    assert rule(module_name(path), path.read_text(encoding="utf-8")) == []


def test_every_room_is_found() -> None:
    assert PACKAGE / "shapes.py" in MODULES


BROKEN = {
    "upwards": (wrong_way, "grid", "from .pipeline import find_shapes"),
    "upwards, the whole module": (wrong_way, "grid", "from . import pipeline"),
    "upwards, by its full name": (wrong_way, "grid", "import primkit.pipeline"),
    "upwards, from the package": (wrong_way, "grid", "from primkit import pipeline as p"),
    "upwards, second of two": (wrong_way, "grid", "import math, primkit.plots"),
    "upwards, for types only": (wrong_way, "grid", "if TYPE_CHECKING:\n    from .plots import draw"),
    "upwards, in a function": (wrong_way, "grid", "def f():\n    from .plots import draw"),
    "upwards, out of a folder": (wrong_way, "lidar.cast", "from ..grid import Grid"),
    "upwards, into a folder": (wrong_way, "lidar", "from .widgets.scene import Scene"),
    "the package itself": (wrong_way, "checks", "import primkit as pk"),
    "a name of the package": (wrong_way, "grid", "from . import Circle"),
    "a stranger": (wrong_way, "helpers", ""),
    "a stranger in a folder": (wrong_way, "helpers.text", ""),
    "imports a stranger": (wrong_way, "plots", "from .helpers import text"),
    "rays that know the sensor": (knows_too_much, "raycast.fast", "from ..robot import BODY"),
    "an engine that knows the grid": (knows_too_much, "robust.scatter", "from ..grid import Grid"),
    "an engine that knows the sensor": (knows_too_much, "robust.scatter", "from ..lidar import Lidar"),
    "an engine that knows the pipeline": (knows_too_much, "robust.regroup", "from .. import pipeline"),
    "files that know the estimator": (knows_too_much, "formats.maps", "from ..pipeline import find_shapes"),
    "files that know the engine": (knows_too_much, "formats.scans", "from ..robust.evidence import Candidate"),
    "space that knows the board": (knows_too_much, "space.finding", "from ..pipeline import find_shapes"),
    "a story that knows space": (knows_too_much, "pipeline", "from .space import find_solids"),
    "a wing that knows space": (knows_too_much, "formats.maps", "from ..space.solids import Box"),
    "a scene that knows the sliders": (knows_too_much, "scene.page", "from ..widgets.slider import Slider"),
    "sliders that know the scene": (knows_too_much, "widgets.slider", "from ..scene import drive_scene"),
    "sliders that draw with matplotlib's room": (knows_too_much, "widgets.rays", "from ..plots.look import marks"),
    "a page that does": (knows_too_much, "scene.page", "from ..plots.look import marks"),
    "checks that know the course": (knows_too_much, "checks.answer", "from ..course.grading import Mark"),
    "checks that draw": (knows_too_much, "checks.answer", "def f():\n    from ..plots import plot_points"),
    "a story that knows the course": (knows_too_much, "pipeline", "from .course import personal"),
    "plots that know the course": (knows_too_much, "plots.look", "from ..course.reporting import report"),
    "a story that knows composites": (knows_too_much, "evaluation", "def f():\n    from .parts import take_apart"),
    "the driver that knows the study": (knows_too_much, "driving.explore", "from ..study import run_study"),
    "matplotlib": (heavy, "study", "import matplotlib.pyplot as plt"),
    "matplotlib in a function": (heavy, "__main__", "def f():\n    from matplotlib import pyplot"),
    "matplotlib in the contents": (heavy, "__init__", "import matplotlib"),
    "ipywidgets": (heavy, "plots", "from ipywidgets import HTML"),
    "anywidget": (heavy, "plots", "import anywidget"),
    "scikit-learn": (heavy, "evaluation", "from sklearn.cluster import KMeans"),
    "import by a call": (hidden_imports, "grid", "import importlib\nimportlib.import_module('primkit.plots')"),
    "import by a call, renamed": (hidden_imports, "grid", "from importlib import import_module as f\nf('x')"),
    "import by the builtin": (hidden_imports, "grid", "__import__('matplotlib')"),
    "import by a call, in the contents": (hidden_imports, "__init__", "import importlib as i\ni.import_module('x')"),
    "a second table of contents": (heavy, "plots.__init__", "import lazy_loader"),
    "a star": (hidden_imports, "grid", "from .shapes import *"),
    "seed": (global_random, "world", "import numpy as np\nnp.random.seed(0)"),
    "rand": (global_random, "world", "import numpy\nx = numpy.random.rand(3)"),
    "shuffle, under another name": (global_random, "world", "from numpy import random as r\nr.shuffle(x)"),
    "normal, imported": (global_random, "world", "from numpy.random import normal"),
    "passed on, not called": (global_random, "world", "import numpy as np\ndraw = np.random.uniform"),
    "the random module": (global_random, "world", "import random"),
    "a name of the random module": (global_random, "world", "from random import choice"),
    "a generator of its own": (global_random, "world", "import numpy as np\nrng = np.random.default_rng()"),
    "clusters without a seed": (global_random, "segmentation", "cluster.KMeans(n_clusters=4).fit(points)"),
    "print": (talk, "pipeline", "def f():\n    print('hello')"),
    "print in a folder": (talk, "widgets.scene", "print('hello')"),
    "print in the contents": (talk, "__init__", "print('hello')"),
    "warn": (talk, "pipeline", "import warnings\nwarnings.warn('hello')"),
    "warn, imported": (talk, "pipeline", "from warnings import warn\nwarn('hello')"),
    "long": (too_long, "pipeline", "x = 1\n" * (MOST_LINES + 1)),
}


@pytest.mark.parametrize(("rule", "name", "source"), BROKEN.values(), ids=BROKEN)
def test_a_breach_is_reported(rule: Callable[[str, str], list[str]], name: str, source: str) -> None:
    assert len(rule(name, source)) >= 1


SOUND = {
    "downwards": (wrong_way, "grid", "from .lidar import Scans\nfrom .shapes import as_points"),
    "within a folder": (wrong_way, "widgets.scene", "from .svg import draw\nfrom . import svg\nfrom ..plots import x"),
    "other libraries": (wrong_way, "grid", "import numpy as np\nfrom pipeline import x"),
    "the contents name all": (wrong_way, "__init__", "from . import plots, shapes"),
    "the command line uses all": (wrong_way, "__main__", "import primkit as pk\nfrom . import study"),
    "files that know what was found": (knows_too_much, "formats.found_maps", "from ..found import Found"),
    "files that know the sensor": (knows_too_much, "formats.scans", "from ..lidar import Scans"),
    "a room that knows itself": (knows_too_much, "course.reporting", "from .course import Course"),
    "commands that know the course": (knows_too_much, "commands.teach", "from ..course.course import Course"),
    "matplotlib in plots": (heavy, "plots", "import matplotlib.pyplot as plt"),
    "a folder's room is the user": (heavy, "widgets.scene", "import ipywidgets"),
    "scikit-image is not scikit-learn": (heavy, "circles", "import skimage, sklearnex"),
    "the contents load on first use": (heavy, "__init__", "import lazy_loader"),
    "bundled files": (hidden_imports, "formats", "from importlib.resources import files\nfiles('primkit')"),
    "the caller's generator": (
        global_random,
        "world",
        "import numpy as np\nnp.random.default_rng(rng).random()",
    ),
    "clusters with a seed": (global_random, "segmentation", "KMeans(4, random_state=seed)"),
    "types": (global_random, "world", "import numpy as np\ndef f(rng: np.random.Generator): ..."),
    "a variable called random": (global_random, "world", "randomly = 1"),
    "the command line prints": (talk, "__main__", "print('hello')"),
    "a method called print": (talk, "pipeline", "report.print()"),
    "just fits": (too_long, "pipeline", "x = 1\n" * MOST_LINES),
}


@pytest.mark.parametrize(("rule", "name", "source"), SOUND.values(), ids=SOUND)
def test_what_is_allowed_is_not_reported(rule: Callable[[str, str], list[str]], name: str, source: str) -> None:
    assert rule(name, source) == []


def test_importing_primkit_is_light() -> None:
    heavies = "matplotlib", "sklearn", "ipywidgets", "anywidget", "pandas", "primkit.space"
    code = f"import sys, primkit; print([name for name in {heavies} if name in sys.modules])"
    assert in_fresh_process(code) == "[]"


def test_only_plots_load_matplotlib() -> None:
    wings = sorted({path.parent.name for path in PACKAGE.glob("*/__init__.py")} - ENGINES - {"plots"})
    code = f"import sys, primkit; [getattr(primkit, name) for name in {wings}]; print('matplotlib' in sys.modules)"
    assert in_fresh_process(code) == "False"


def test_dir_shows_the_names_of_the_story_and_the_wings() -> None:
    """Nothing else, before anything is loaded and after all is; and each of them is there."""
    names, wings = contents((PACKAGE / "__init__.pyi").read_text(encoding="utf-8"))
    assert set(wings) == {path.parent.name for path in PACKAGE.glob("*/__init__.py")} - ENGINES
    code = (
        "import primkit as pk; before = dir(pk); "
        "absent = [name for name in before if not hasattr(pk, name)]; "
        "print(absent, dir(pk) == before == sorted(pk.__all__), *before)"
    )
    assert in_fresh_process(code) == " ".join(["[] True", *sorted([*names, *wings])])


def test_a_wing_is_there_in_a_fresh_kernel() -> None:
    assert in_fresh_process("import primkit as pk; print(pk.plots.KIND_COLORS['circle'])") == "#0072B2"


def contents(stub: str) -> tuple[list[str], list[str]]:
    """Return the public names and the wings of a table of contents; refuse what type checkers would not see."""
    names, wings = [], []
    for node in ast.parse(stub).body:
        if isinstance(node, ast.ImportFrom):
            assert all(alias.asname == alias.name for alias in node.names), ast.unparse(node)
            (names if node.module else wings).extend(alias.name for alias in node.names)
    assert len({*names, *wings}) == len(names) + len(wings), "a public name is listed twice"
    return names, wings


@pytest.mark.parametrize(
    "stub",
    ["from .grid import Grid", "from .grid import Grid as G", 2 * "from .grid import Grid as Grid\n"],
    ids=["not seen", "renamed", "twice"],
)
def test_a_poor_table_of_contents_is_reported(stub: str) -> None:
    with pytest.raises(AssertionError):
        contents(stub)


def in_fresh_process(code: str) -> str:
    """Run code in a new interpreter at the top of the repository and return what it prints."""
    command = [sys.executable, "-W", "error", "-c", code]
    done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT, check=False, timeout=120)
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


def test_top_level_is_the_plan() -> None:
    try:
        command = ["git", "ls-files", "-z"]
        listed = subprocess.run(command, capture_output=True, text=True, encoding="utf-8", cwd=ROOT, check=False)
    except FileNotFoundError:
        pytest.skip("git is not installed")
    if listed.returncode != 0 or not (ROOT / ".git").exists():
        pytest.skip("not a git checkout")
    assert not_the_plan(filter(None, listed.stdout.split("\0"))) == []


@pytest.mark.parametrize(
    ("change", "breach"),
    [
        ({"setup.py"}, "not in the plan: setup.py"),
        ({"docs/index.md"}, "not in the plan: docs"),
        ({".env"}, "not in the plan: .env"),
        ({"README.md"}, "missing: README.md"),
        ({"data/x.csv"}, "missing: data"),
        (set(), None),
    ],
    ids=lambda value: str(value),
)
def test_a_different_top_level_is_reported(change: set[str], breach: str | None) -> None:
    plan = {f"{name}/x.csv" if name == "data" else name for name in VISIBLE | {".gitignore"}}
    assert not_the_plan(plan ^ change) == ([breach] if breach else [])
