"""Own kernel: where a submission's cells run, with limits, walls around it, and nothing of its teacher's.

It has a scratch folder of its own, no variables of the teacher's environment, limits of memory, processes and the size
of files; its walls are those of ``confining.py``. A notebook whose teacher's version says so in its metadata,
``{"primkit": {"without": ["pipeline"]}}``, gets a copy of the library in which these modules refuse to work.

In:  a scratch folder.
Out: nbgrader's way to execute, whose kernels are such.
"""

from __future__ import annotations

import ast
import os
import shutil
import site
import subprocess
import sys
from collections.abc import Sequence
from contextlib import suppress
from itertools import count
from pathlib import Path
from typing import Any

import psutil
from nbclient.exceptions import DeadKernelError
from nbclient.util import ensure_async
from nbgrader.preprocessors import Execute
from traitlets import Integer, Unicode

from ..plots.fonts import font_lists
from .confining import DATA, OWN_FOLDERS, PACKAGE, bubblewrap_works, limit_processes, walls
from .course import ASSIGNMENTS

# What a kernel needs of the teacher's environment; nothing else is handed on, for there may be passwords in it.
KEPT_VARIABLES = (
    *("PATH", "LANG", "LC_ALL", "LC_CTYPE", "TZ", "VIRTUAL_ENV", "LD_LIBRARY_PATH"),
    *("SYSTEMROOT", "SYSTEMDRIVE", "WINDIR", "COMSPEC", "PATHEXT", "NUMBER_OF_PROCESSORS", "PROCESSOR_ARCHITECTURE"),
)
# What grows is limited; and exit() is an error, as in a script, where IPython's would end the kernel some cells later.
PREPARE = """\
def _prepare():
    import builtins, sys
    for names in (vars(builtins), get_ipython().user_ns):
        names.update(exit=sys.exit, quit=sys.exit)
    try:
        import resource
    except ImportError:
        return
    for name, most in {limits}.items():
        try:
            resource.setrlimit(getattr(resource, name), (most, most))
        except (AttributeError, ValueError, OSError):
            pass
_prepare()
del _prepare
"""
MEGABYTE = 2**20
FILE_MEGABYTES = 256  # of one file
FOLDER_MEGABYTES = 1024  # of all that a submission writes
MOST_PROCESSES = 64  # at once; threads are counted by the system, which is told four times as many
REFUSES = "in this problem set, what {0} does is yours to write: it refuses to work"


class OwnKernel(Execute):  # type: ignore[misc]
    """Run cells in a kernel of one's own; see this module."""

    course = Unicode("", help="The course folder.").tag(config=True)
    megabytes = Integer(4096, help="Memory limit of the kernel, in megabytes.").tag(config=True)

    startup_timeout = Integer(300, help="Seconds until a kernel answers, on a machine however busy.").tag(config=True)

    twins = 0  # of the kernel's, which are no processes of the student's

    def prepare(self, scratch: Path, without: Sequence[str] = ()) -> None:
        """Make the kernel's folders, its list of fonts and its library."""
        self.scratch = scratch
        self.numbers = count()  # of kernels
        self.seen: set[psutil.Process] = set()  # of the kernels, and of what they have started
        self.groups: list[Path] = []  # of the kernels' processes
        self.confined = bubblewrap_works()
        for name in OWN_FOLDERS:
            (scratch / name).mkdir(exist_ok=True)
        (scratch / "home" / "matplotlib").mkdir()
        for fonts in font_lists():
            shutil.copy(fonts, scratch / "home" / "matplotlib")
        self.library = _library_without(scratch / "library", without) if without else PACKAGE

    def create_kernel_manager(self) -> Any:
        """Make the manager of a kernel behind walls, whatever kernel the notebook names."""
        self.kernel_name = "python3"
        manager = super().create_kernel_manager()
        run = self.scratch / "run" / str(next(self.numbers))  # no kernel meets what another one has left there
        run.mkdir()
        words = [sys.executable, "-m", "ipykernel_launcher", "-f", "{connection_file}"]
        manager.connection_file = str(run / "kernel.json")
        if self.confined:
            words = [*walls(self.scratch, self.library, (Path(self.course).resolve(), ASSIGNMENTS)), *words]
            manager.transport, manager.ip = "ipc", str(run / "kernel")
            manager.kernel_spec.interrupt_mode = "message"
        manager.kernel_spec.argv = words
        return manager

    def start_new_kernel(self, **options: Any) -> None:
        """Start a kernel that knows nothing of its teacher."""
        options["env"] = _environment(self.scratch / "home", self.library)
        options["stdout"] = options["stderr"] = subprocess.DEVNULL  # beside its cells it could write without end
        super().start_new_kernel(**options)

    def start_new_kernel_client(self) -> Any:
        """Prepare the kernel before the first cell runs."""
        client = super().start_new_kernel_client()
        most = 4 * MOST_PROCESSES + self.twins
        if hasattr(os, "geteuid") and os.geteuid() == 0:  # whom the system's own limit does not hold
            group = limit_processes((process.pid for process in self.processes()), most)
            self.groups += [group] if group is not None else []
        limits = {
            "RLIMIT_AS": self.megabytes * MEGABYTE,
            "RLIMIT_CORE": 0,
            "RLIMIT_FSIZE": FILE_MEGABYTES * MEGABYTE,
            "RLIMIT_NPROC": most + _threads_of(psutil.Process().username()),
        }
        self.run_silently(PREPARE.format(limits=limits), client)
        return client

    def run_silently(self, source: str, client: Any = None) -> None:
        """Run code of the judge's in the kernel."""
        client = client or self.kc
        self.wait_for_reply(client.execute(source, silent=True, store_history=False))

    async def _async_check_alive(self) -> None:
        """End a kernel that takes too much of what the system does not refuse it."""
        if excess := self._excess():
            self.killed = excess
            await ensure_async(self.km.shutdown_kernel(now=True))
            raise DeadKernelError(self.killed)
        await super()._async_check_alive()

    def _excess(self) -> str:
        """Return in a sentence what the kernel takes too much of; empty when nothing."""
        processes = self.processes()
        memory = [_memory(process) for process in processes]
        if sum(memory) > 2 * self.megabytes:  # twins share most of theirs: that takes longer to find out
            memory = [_memory(process, "pss") for process in processes]
        if max(memory, default=0.0) > self.megabytes or sum(memory) > 2 * self.megabytes:
            return f"this cell took more than {self.megabytes} MB of memory, and its kernel was ended"
        if len(processes) > MOST_PROCESSES + self.twins:
            return f"this cell started more than {MOST_PROCESSES} processes, and its kernel was ended"
        files = [path for name in OWN_FOLDERS for path in (self.scratch / name).rglob("*")]
        if sum(_size(path) for path in files) > FOLDER_MEGABYTES * MEGABYTE:
            return f"this cell wrote more than {FOLDER_MEGABYTES} MB into files, and its kernel was ended"
        return ""

    def processes(self) -> list[psutil.Process]:
        """Return the kernel's process and all that it has started."""
        pid = getattr(getattr(self.km, "provisioner", None), "pid", None)
        with suppress(psutil.Error):
            first = psutil.Process(pid) if pid else None
            found = [first, *first.children(recursive=True)] if first else []
            self.seen.update(found)
            return found
        return []

    def memory(self) -> float:
        """Return what the kernel takes, in megabytes."""
        return max(map(_memory, self.processes()), default=0.0)

    def spent(self) -> float:
        """Return the processor time of the kernel and of all that it has started, in seconds."""
        total = 0.0
        for process in self.processes():
            with suppress(psutil.Error):
                total += sum(process.cpu_times()[:4])
        return total

    def restart_kernel(self) -> None:
        """Start another kernel in the place of this one."""
        self.processes()  # what is there now is ended in the end
        self.shutdown_kernel = "immediate"
        self._cleanup_kernel()
        self.end_leftovers()
        self.km = self.create_kernel_manager()
        self.start_new_kernel()
        self.start_new_kernel_client()

    def end_leftovers(self) -> None:
        """End what cells have started, as far as it was seen; behind walls it has ended."""
        for process in self.seen:
            with suppress(psutil.Error):
                process.kill()  # only while it is the one that was seen
        for group in self.groups:
            with suppress(OSError):  # until its last process has gone; then the next time
                group.rmdir()


def _environment(home: Path, library: Path) -> dict[str, str]:
    """Return a kernel's environment."""
    return {
        **{name: os.environ[name] for name in KEPT_VARIABLES if name in os.environ},
        **dict.fromkeys(("HOME", "USERPROFILE", "APPDATA", "TEMP", "TMP", "TMPDIR"), str(home)),
        **dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"), "1"),
        "MPLCONFIGDIR": str(home / "matplotlib"),
        "PYTHONPATH": str(library.parent),
        "PYTHONUSERBASE": site.getuserbase(),
        "PYTHONWARNINGS": "ignore",
        "PYTHONDONTWRITEBYTECODE": "1",
        "NBGRADER_EXECUTION": "autograde",
    }


def _library_without(folder: Path, without: Sequence[str]) -> Path:
    """Return a copy of the library in which some modules refuse to work."""
    library = folder / PACKAGE.name
    shutil.copytree(PACKAGE, library, ignore=shutil.ignore_patterns(*(f"{name}.*.pyc" for name in without)))
    if DATA.is_dir():
        (folder / DATA.name).symlink_to(DATA)
    for name in without:
        modules = list((library / name).glob("*.py")) or [library / f"{name}.py"]
        shutil.rmtree(library / name / "__pycache__", ignore_errors=True)
        for module in modules:
            tree = ast.parse(module.read_text(encoding="utf-8"))
            for node in ast.walk(tree):  # constants and classes stay, for others need them
                if isinstance(node, ast.FunctionDef) and not node.name.startswith("__"):
                    node.body = ast.parse(f"raise RuntimeError({REFUSES.format(f'primkit.{name}')!r})").body
            module.write_text(ast.unparse(tree), encoding="utf-8")
    return library


def _threads_of(user: str) -> int:  # by now: the system's limit counts them all
    processes = [process.info for process in psutil.process_iter(["username", "num_threads"])]
    return sum(each["num_threads"] or 0 for each in processes if each["username"] == user)


def _memory(process: psutil.Process, kind: str = "rss") -> float:
    with suppress(psutil.Error):
        told = process.memory_info() if kind == "rss" else process.memory_full_info()
        return float(getattr(told, kind, told.rss) / MEGABYTE)
    return 0.0


def _size(path: Path) -> int:
    with suppress(OSError):
        return 0 if path.is_symlink() else path.stat().st_size
    return 0
