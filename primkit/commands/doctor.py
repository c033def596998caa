"""Doctor: ``primkit doctor`` looks at what is installed, tries it, and says what to do about what is missing.

Out: a line for each thing; exit code 1 if one is at fault. ``installed`` looks, and needs nothing but Python.
"""

from __future__ import annotations

import argparse
import struct
import sys
import time
from collections.abc import Iterator
from importlib import metadata
from pathlib import Path
from pydoc import ErrorDuringImport, locate

from ..installed import CLASSROOM, IN_BROWSER, PIP, PROJECT, Finding, kernel, needed_packages, older, python, version_of
from .words import Parser, say, tell_faults

DOCTOR_TEXT = "look at what is installed, try it, and say what to do about what is missing"
DOCTOR_EXAMPLES = "It changes nothing, and asks nobody on the network.\n"

IMPORTED_AS = {"scikit-learn": "sklearn", "lazy-loader": "lazy_loader"}
FRONT_ENDS = {"@jupyter-widgets/jupyterlab-manager": "jupyterlab_widgets", "anywidget": "anywidget"}
ONLY_FOR = {
    "rosbags": "bags of ROS",
    "dask": "studies on many machines",
    "nbgrader": "teachers: the problem sets",
}
LONGEST_PATH = 90  # letters, on Windows: files lie up to 170 letters deep in an environment, and a path ends at 260


def doctor_options(_parser: Parser) -> None:
    """Add nothing: the doctor looks at all there is."""


def doctor(_arguments: argparse.Namespace) -> None:
    """Print what was found."""
    bits = 8 * struct.calcsize("P")
    say(f"primkit {version_of_primkit()} in {Path(__file__).parents[1]}, on {sys.platform}, {bits} bits")
    findings = [python(), *_packages(), *_namesakes(), _place()]
    if not IN_BROWSER:
        findings += [*_jupyter(), kernel()]
    findings += [Finding(name, _of_use(name, what), fine=True) for name, what in ONLY_FOR.items()]
    sound = all(finding.fine for finding in findings if finding.what in dict(needed_packages()))
    tell_faults([*findings, *([_trial()] if sound else [])])


def version_of_primkit() -> str:
    """Return the version of the package that this very module belongs to."""
    return str(sys.modules[__name__.partition(".")[0]].__version__)


def _packages() -> Iterator[Finding]:
    """Load each package that primkit needs: one that is installed may still be broken."""
    one_by_one = f"{PIP} install --upgrade"
    for name, least in needed_packages():
        version = version_of(name) or "missing"
        mend = f"{PIP} install -r {CLASSROOM}" if CLASSROOM.is_file() else f"{one_by_one} {name}"
        if version != "missing" and not older(version, least):
            try:
                loads = locate(IMPORTED_AS.get(name, name)) is not None
            except ErrorDuringImport as error:
                version, loads = f"{version} cannot be loaded ({error.value})", False
                mend = f"{PIP} install --force-reinstall {name}"
            yield Finding(name, version, mend, loads)
        else:
            yield Finding(name, f"{version}, needs {least} or newer", mend)


def _namesakes() -> Iterator[Finding]:
    """Look for what Python would load in the place of what is meant."""
    here = Path.cwd()
    modules = {IMPORTED_AS.get(name, name) for name, _ in needed_packages()} | {"primkit"}
    for path in sorted(here.glob("*.py")):
        if path.stem in modules | sys.stdlib_module_names:
            yield Finding(path.name, f"hides Python's own {path.stem} from notebooks in {here}", "give it another name")
    try:
        author = metadata.metadata("primkit")["Author"]
    except metadata.PackageNotFoundError:
        return
    if author != "The primkit authors":
        mend = f"{PIP} uninstall primkit, then install this one again as README.md says"
        yield Finding("primkit", "somebody else's package of this name is installed beside this one", mend)


def _place() -> Finding:
    """Look at the folder that primkit was started from or installed in."""
    if not CLASSROOM.is_file():
        return Finding("lessons", "`primkit lessons DIR` writes them into a folder", fine=True)
    long = sys.platform == "win32" and len(str(PROJECT)) > LONGEST_PATH
    mend = f"move the project to a folder whose path has at most {LONGEST_PATH} letters: Windows ends a path at 260"
    return Finding("folder", f"{PROJECT}" + (", a path too long" if long else ""), mend, not long)


def _jupyter() -> Iterator[Finding]:
    """Look for a Jupyter, and for what it shows sliders with."""
    server = next((name for name in ("jupyterlab", "notebook") if version_of(name)), None)
    mend = f"{PIP} install jupyterlab (not needed in VS Code and Colab, which have their own)"
    yield Finding("Jupyter", f"{server} {version_of(server)}" if server else "missing", mend, server is not None)
    if server is None:
        return
    from jupyter_core.paths import jupyter_path

    folders = [Path(folder) for folder in jupyter_path("labextensions")]
    for extension, package in FRONT_ENDS.items():
        there = next((folder for folder in folders if (folder / extension / "package.json").is_file()), None)
        mend = f"{PIP} install --force-reinstall {package}, then restart Jupyter"
        yield Finding("sliders", f"{extension} {'is there' if there else 'is missing in Lab'}", mend, there is not None)


def _of_use(name: str, what: str) -> str:
    return f"{version_of(name) or 'not here'} (only for {what})"


def _trial() -> Finding:
    """Map the first lesson's board."""
    mend = "show this text to your teacher, or open an issue with it"
    start = time.perf_counter()
    try:
        from ..evaluation import evaluate
        from ..grid import Grid
        from ..lidar import Lidar, scan
        from ..pipeline import find_shapes
        from ..robot import teleport_poses
        from ..world import random_world

        world, grid = random_world(4, rng=7), Grid()
        grid.add(scan(world, teleport_poses(world), Lidar(), rng=0))
        accuracy = evaluate(find_shapes(grid, rng=0), world).weighted_accuracy
    except Exception as error:
        return Finding("a first board", f"{type(error).__name__}: {error}", mend)
    told = f"mapped in {time.perf_counter() - start:.1f} s, weighted accuracy {accuracy:.3f}"
    return Finding("a first board", told, mend, accuracy == 1.0)
