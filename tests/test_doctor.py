"""`primkit doctor`: it names each fault and how it is mended, also where nearly nothing is installed."""

import os
import runpy
import shutil
import subprocess
import sys
from importlib import metadata
from pathlib import Path
from pydoc import ErrorDuringImport

import lazy_loader
import pytest

from primkit import installed
from primkit.__main__ import main
from primkit.commands import doctor
from primkit.installed import needed_packages, older

ROOT = Path(__file__).resolve().parent.parent


@pytest.fixture(autouse=True)
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_a_whole_classroom_is_found_whole(capsys):
    assert main(["doctor"]) == 0
    out = capsys.readouterr().out
    assert "FAULT" not in out
    assert "weighted accuracy 1.000" in out
    assert out.endswith("All is there.\n")
    assert [name for name, _ in needed_packages() if f"ok     {name}: " not in out] == []


def without(monkeypatch, package, version=None):
    """Let a package be absent, or of another version."""
    real = metadata.version

    def told(name):
        if name == package and version is None:
            raise metadata.PackageNotFoundError(name)
        return version if name == package else real(name)

    monkeypatch.setattr(metadata, "version", told)


def absent(monkeypatch, _here):
    without(monkeypatch, "scipy")


def too_old(monkeypatch, _here):
    without(monkeypatch, "shapely", "1.8.5")


def broken(monkeypatch, _here):
    def fail(name):
        if name == "sklearn":
            raise ErrorDuringImport("sklearn.py", (OSError, OSError("DLL load failed"), None))
        return name

    monkeypatch.setattr(doctor, "locate", fail)


def hidden(_monkeypatch, here):
    (here / "random.py").write_text("")


def namesake(monkeypatch, _here):
    real = metadata.metadata
    monkeypatch.setattr(metadata, "metadata", lambda name: {"Author": "X"} if name == "primkit" else real(name))


def no_front_end(monkeypatch, _here):
    monkeypatch.setitem(doctor.FRONT_ENDS, "no-such-extension", "nothing")


def no_lab(monkeypatch, _here):
    real = installed.version_of
    monkeypatch.setattr(doctor, "version_of", lambda name: None if name in ("jupyterlab", "notebook") else real(name))


def long_path(monkeypatch, _here):
    monkeypatch.setattr(sys, "platform", "win32")
    monkeypatch.setattr(doctor, "PROJECT", Path("C:/" + "a" * doctor.LONGEST_PATH))


FAULTS = {
    "absent": (absent, "scipy: missing, needs 1.13 or newer", f"-m pip install -r {installed.CLASSROOM}"),
    "too old": (too_old, "shapely: 1.8.5, needs 2.0.4 or newer", "-m pip install -r"),
    "broken": (broken, "cannot be loaded (DLL load failed)", "--force-reinstall scikit-learn"),
    "hidden": (hidden, "random.py: hides Python's own random from notebooks in ", "give it another name"),
    "namesake": (namesake, "primkit: somebody else's package", "-m pip uninstall primkit, then install this one"),
    "no front end": (no_front_end, "sliders: no-such-extension is missing in Lab", "--force-reinstall nothing"),
    "no Jupyter": (no_lab, "Jupyter: missing", "-m pip install jupyterlab"),
    "a long path": (long_path, "a path too long", "at most 90 letters"),
}


@pytest.mark.parametrize(("damage", "fault", "mend"), FAULTS.values(), ids=FAULTS)
def test_a_fault_is_named_with_its_remedy(damage, fault, mend, here, monkeypatch, capsys):
    monkeypatch.setattr(doctor, "_trial", lambda: doctor.Finding("a first board", "left out", fine=True))
    damage(monkeypatch, here)
    assert main(["doctor"]) == 1
    lines = capsys.readouterr().out.splitlines()
    place = next(n for n, line in enumerate(lines) if line.startswith("FAULT"))
    assert fault in lines[place]
    assert mend in lines[place + 1]
    assert lines[-1] == "1 fault found"


@pytest.mark.parametrize(
    ("platform", "program", "line"),
    [
        ("linux", "/opt/a/python", "/opt/a/python -m pip"),
        ("linux", "/my env/python", '"/my env/python" -m pip'),
        ("emscripten", "", "%pip"),
    ],
    ids=["in a terminal", "a space in the path", "in a browser's cell"],
)
def test_what_is_to_be_pasted_can_be(platform, program, line, monkeypatch):
    monkeypatch.setattr(sys, "platform", platform)
    monkeypatch.setattr(sys, "executable", program)
    assert runpy.run_path(installed.__file__)["PIP"] == line


def test_it_answers_where_nothing_is_installed(here):
    """Nothing but Python, and what `import primkit` needs: -S leaves site-packages out."""
    shutil.copytree(Path(lazy_loader.__file__).parent, here / "only" / "lazy_loader")
    path = os.pathsep.join([str(ROOT), str(here / "only")])
    command = [sys.executable, "-S", "-m", "primkit", "doctor"]
    done = subprocess.run(command, capture_output=True, text=True, env=os.environ | {"PYTHONPATH": path}, check=False)
    told = done.stdout.splitlines()
    missing = [f"FAULT  {name}: missing, needs {least} or newer" for name, least in needed_packages()]
    assert (done.returncode, [line for line in missing if line not in told]) == (1, [])
    assert not any("a first board" in line for line in told)


@pytest.mark.parametrize(
    ("version", "least", "expected"),
    [
        ("1.9", "1.13", True),
        ("1.13", "1.13", False),
        ("1.13.1", "1.13", False),
        ("1.13", "1.13.1", True),
        ("2", "2.0", False),
        ("2", "1.9.9", False),
        ("2.0.dev3", "2.0", False),
    ],
)
def test_versions_are_compared_by_their_numbers(version, least, expected):
    assert older(version, least) == expected
