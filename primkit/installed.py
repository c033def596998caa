"""Installed: which Python and which packages are here, and how each fault is mended.

In:  nothing but the standard library: it answers also where all else is missing.
Out: a ``Finding`` for each thing that was looked at: fine, or what is wrong and what to do.

>>> print(Finding("scipy", "missing", "python -m pip install scipy"))
FAULT  scipy: missing
       -> python -m pip install scipy
>>> older("1.9.3", "1.13"), older("2", "2.0")
(True, False)
"""

from __future__ import annotations

import re
import sys
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path

# Of the package; what is installed by the name `primkit` from PyPI is somebody else's.
DISTRIBUTION = "primkit-lab"
LEAST_PYTHON = (3, 11)
PROJECT = Path(__file__).resolve().parents[1]  # in a clone, the project's folder; beside a wheel, site-packages
CLASSROOM = PROJECT / "environment.txt"
PIN = re.compile(r"^([\w.-]+)(?:\[[\w,]+\])?==([\w.]+)")
FLOOR = re.compile(r"^([\w.-]+)>=([\w.]+)$")
IN_BROWSER = sys.platform == "emscripten"


def quoted(file: str | Path) -> str:
    """Return a path as one word of a command line.

    >>> quoted("my lessons/a.ipynb"), quoted("lessons/a.ipynb")
    ('"my lessons/a.ipynb"', 'lessons/a.ipynb')
    """
    return f'"{file}"' if " " in str(file) else str(file)


# What installs into this very Python: a line for a terminal, or, in a browser, for a cell.
PIP = "%pip" if IN_BROWSER else f"{quoted(sys.executable)} -m pip"


def install_line(extra: str) -> str:
    """Return what installs one of the package's extras, also where the package came from a folder."""
    return f'{PIP} install "{DISTRIBUTION}[{extra}]"'


@dataclass(frozen=True)
class Finding:
    """One thing that was looked at: what, how it is, and what to do unless it is fine."""

    what: str
    found: str
    mend: str = ""
    fine: bool = False

    def __str__(self) -> str:
        told = f"{self.what}: {self.found}"
        return f"ok     {told}" if self.fine else f"FAULT  {told}\n       -> {self.mend}"


def python() -> Finding:
    """Look whether this Python is new enough."""
    version, least = (".".join(map(str, each)) for each in (sys.version_info[:3], LEAST_PYTHON))
    mend = f"install Python {least} or newer, and make the environment again with it"
    return Finding("Python", f"{version}, {sys.executable}", mend, sys.version_info >= LEAST_PYTHON)


def kernel() -> Finding:
    """Look whether notebooks run in this very Python."""
    mend = f"{sys.executable} -m ipykernel install --sys-prefix"
    try:
        from jupyter_client.kernelspec import KernelSpecManager

        words = KernelSpecManager().get_kernel_spec("python3").argv
    except Exception as error:
        return Finding("kernel python3", f"not found ({type(error).__name__})", mend)
    program = Path(words[0])
    own = not program.is_absolute() or program.parent == Path(sys.executable).parent
    return Finding("kernel python3", words[0] if own else f"{program} is another Python than this one", mend, own)


def version_of(package: str) -> str | None:
    """Return the version of an installed package, or None."""
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return None


def pins_in(environment: Path) -> dict[str, str]:
    """Return the versions that a file asks for, and those that it names with -r."""
    pins: dict[str, str] = {}
    for line in environment.read_text(encoding="utf-8").splitlines():
        if line.startswith("-r "):
            pins |= pins_in(environment.parent / line[3:].strip())
        elif match := PIN.match(line):
            pins[match[1]] = match[2]
    return pins


def needed_packages() -> Iterator[tuple[str, str]]:
    """Yield what primkit needs, with the least version of each."""
    try:
        lines = metadata.requires(DISTRIBUTION) or []
    except metadata.PackageNotFoundError:  # a folder that was never installed
        project = PROJECT / "pyproject.toml"
        lines = tomllib.loads(project.read_text(encoding="utf-8"))["project"]["dependencies"]
    yield from ((match[1], match[2]) for match in map(FLOOR.match, lines) if match)


def older(version: str, least: str) -> bool:
    """Tell whether a version is older than the least that is asked for."""
    first, second = ([int(n) for n in text.split(".") if n.isdigit()] for text in (version, least))
    return first < second[: len(first)] or (first < second and any(second[len(first) :]))
