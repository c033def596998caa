"""Confining: the walls around the process that runs a student's code.

By bubblewrap, where it is there and allowed to: a namespace of its own for files, processes and the network. The
kernel sees Python and the library, read only, and three folders of its own; no network, no process but its own, none
of the course. What it leaves behind ends with it.

In:  a scratch folder of the judge's, with ``work``, ``home`` and ``run`` in it.
Out: the words before the kernel's own command, and in a sentence what confines it.
"""

from __future__ import annotations

import os
import shutil
import site
import subprocess
import sys
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from functools import cache
from pathlib import Path
from uuid import uuid4

PACKAGE = Path(__file__).resolve().parents[1]
DATA = PACKAGE.parent / "data"  # in a clone; a wheel holds it inside
OWN_FOLDERS = ("work", "home", "run")
SYSTEM = ("/usr", "/bin", "/sbin", "/lib", "/lib32", "/lib64", "/libx32")
SYSTEM_SETTINGS = ("ld.so.cache", "ld.so.conf", "ld.so.conf.d", "alternatives", "fonts", "localtime", "mime.types")
TEMPORARY_BYTES = 2**28  # that /tmp and /dev/shm may hold, each
# The places that hold all these are file systems in memory, without a limit: nothing more may be written there.
SEALED = ("--remount-ro", "/dev", "--remount-ro", "/")
BY_OTHERS = "PRIMKIT_CONFINED_BY"  # a variable that names what confines the whole grading: "a container"
UNPROTECTED = "unprotected: no wall stands between a student's code and your files"
UNCOUNTED = "uncounted: root may start any number of processes; grade as another user, or allow control groups"
CONTROL_GROUPS = ("/sys/fs/cgroup/pids", "/sys/fs/cgroup")  # control groups of processes, version 1 and version 2


@cache
def bubblewrap_works() -> bool:
    """Tell whether bubblewrap is there and may do what is asked of it: Ubuntu 24.04 must be told to allow it."""
    if not sys.platform.startswith("linux") or shutil.which("bwrap") is None:
        return False
    words = [*_walls(PACKAGE), *SEALED, sys.executable, "-c", "import numpy"]
    return subprocess.run(words, capture_output=True, check=False, timeout=60).returncode == 0


def confined_by() -> str:
    """Return what stands between a student's code and the teacher's files; empty when nothing does."""
    if bubblewrap_works():
        return "bubblewrap"
    return os.environ.get(BY_OTHERS, "")


def limit_processes(pids: Iterable[int], most: int) -> Path | None:
    """Let processes and all that they start be at most so many; return their control group, None without one.

    For everybody but root the system's own limit does the same.
    """
    for place in map(Path, CONTROL_GROUPS):
        group = place / f"primkit-{uuid4().hex}"
        with suppress(OSError):
            group.mkdir()
            try:
                (group / "pids.max").write_text(str(most))
                for pid in pids:
                    (group / "cgroup.procs").write_text(str(pid))
                return group
            except OSError:
                group.rmdir()
    return None


@cache
def processes_are_limited() -> bool:
    """Tell whether there can be no more processes of a student's than allowed."""
    if not hasattr(os, "geteuid") or os.geteuid() != 0:
        return True
    if (group := limit_processes((), 1)) is not None:
        group.rmdir()
    return group is not None


def walls(scratch: Path, library: Path, hidden: Sequence[Path] = ()) -> list[str]:
    """Return the words before a kernel's command: its own folders and no others, and the library from there."""
    own = [word for name in OWN_FOLDERS for word in ("--bind", str(scratch / name), str(scratch / name))]
    return [*_walls(library, hidden), *own, *SEALED, "--chdir", str(scratch / "work")]


def _walls(library: Path, hidden: Sequence[Path] = ()) -> list[str]:
    words = ["bwrap", "--unshare-all", "--die-with-parent", "--new-session", "--cap-drop", "ALL"]
    words += ["--uid", "1000", "--gid", "1000", "--unsetenv", "JPY_PARENT_PID", "--proc", "/proc", "--dev", "/dev"]
    for place in ("/tmp", "/dev/shm"):
        words += ["--size", str(TEMPORARY_BYTES), "--tmpfs", place]
    for path in _readable(library):
        words += ["--ro-bind", str(path), str(path)]
    if library != PACKAGE and DATA.is_dir():  # a copy looks for it beside itself
        words += ["--ro-bind", str(DATA), str(library.parent / DATA.name)]
    for path in hidden if library == PACKAGE else (*hidden, PACKAGE):
        if any(path.is_relative_to(seen) for seen in _readable(library)):
            words += ["--tmpfs", str(path)]
    return words


def _readable(library: Path) -> Iterator[Path]:
    """Yield what a kernel needs to run Python, and the library."""
    yield from (Path(path) for path in SYSTEM if Path(path).exists())
    yield from (Path("/etc", name) for name in SYSTEM_SETTINGS if Path("/etc", name).exists())
    folders = {Path(sys.prefix), Path(sys.base_prefix), Path(site.getuserbase(), "lib"), library, DATA}
    folders |= {library.parent / DATA.name}  # a link, beside a copy of the library
    yield from sorted(path for path in folders if path.exists() and not path.is_relative_to("/usr"))
