"""Executing: run a submission so that whatever it does costs its own cells alone.

nbgrader's own preprocessor runs a notebook until its kernel dies, and then the whole submission is lost. This one,
which the course's ``nbgrader_config.py`` puts in its place, goes on:

* It runs in a scratch copy of the submission's folder. What is deleted or changed there is put back for the next cell.
* A cell that takes too long is interrupted. A kernel that ends, or cannot be interrupted, is started again: the guilty
  cell gets an error that says so, the cells before it run again without it, and then those after it.
* The kernel has a memory limit, no variables of the teacher's environment, and a home folder of its own.
* A hidden test that returns no number has been tampered with, and counts as failed.

In:  a notebook, and the folder it lies in.
Out: the notebook with its outputs; ``metadata.primkit.faults`` lists what happened, for the report.
"""

from __future__ import annotations

import filecmp
import os
import re
import shutil
import signal
import site
import tempfile
from contextlib import suppress
from pathlib import Path
from typing import Any

import psutil
from nbclient.exceptions import CellTimeoutError, DeadKernelError
from nbclient.util import ensure_async
from nbformat.v4 import new_output
from nbgrader.preprocessors import Execute
from traitlets import Integer, Unicode

from ..formats import save_scans, save_world
from .course import SCANS, Course
from .grading.own_board import TRUTH_VARIABLE
from .personal import personal_scans, personal_world

# What a kernel needs of the teacher's environment; nothing else is handed on, for there may be passwords in it.
KEPT_VARIABLES = (
    *("PATH", "LANG", "LC_ALL", "LC_CTYPE", "TZ", "VIRTUAL_ENV", "LD_LIBRARY_PATH"),
    *("SYSTEMROOT", "SYSTEMDRIVE", "WINDIR", "COMSPEC", "PATHEXT", "NUMBER_OF_PROCESSORS", "PROCESSOR_ARCHITECTURE"),
)
# Memory is limited; and exit() is an error, as in a script, where IPython's would end the kernel some cells later.
PREPARE = """\
def _prepare():
    import builtins, sys
    for names in (vars(builtins), get_ipython().user_ns):
        names.update(exit=sys.exit, quit=sys.exit)
    try:
        import resource
        resource.setrlimit(resource.RLIMIT_AS, ({0}, {0}))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    except (ImportError, ValueError, OSError):
        pass
    from primkit.course.grading.failed_cells import watch
    watch()
_prepare()
del _prepare
"""
MEGABYTE = 2**20
ALWAYS_NOTED = ("MemoryError", "SystemExit")  # also where a test meets them
ERROR_LETTERS = 200  # letters of an error that are told
CELL_LETTERS = 200_000  # of one cell's output that are kept
MARK_CALL = re.compile(r"^[^#\n]*\.mark\(", re.MULTILINE)  # the last line of a hidden test


class CarefulExecute(Execute):  # type: ignore[misc]
    """Run the cells of a submission; see this module."""

    course = Unicode("", help="The course folder.").tag(config=True)
    megabytes = Integer(4096, help="Memory limit of the kernel, in megabytes.").tag(config=True)
    timeout = Integer(60, help="Time limit of a cell, in seconds.", allow_none=True).tag(config=True)
    tests_timeout = Integer(180, help="Time limit of hidden tests: their parts have limits too.").tag(config=True)

    # --- a notebook ---------------------------------------------------------------------------------------

    def preprocess(self, nb: Any, resources: Any = None, km: Any = None) -> Any:
        """Run a notebook in a scratch copy of its folder."""
        self.faults: list[dict[str, Any]] = list(nb.metadata.get("primkit", {}).get("faults", ()))  # of its cells
        self.guilty: set[int] = set()
        self.groups: list[int] = []  # of processes: each kernel's, with what it has started
        folder = Path(resources["metadata"]["path"])
        with tempfile.TemporaryDirectory(prefix="primkit-", ignore_cleanup_errors=True) as scratch:
            self.scratch = Path(scratch)
            self.given, self.work = self.scratch / "given", self.scratch / "work"
            shutil.copytree(folder, self.given, copy_function=shutil.copyfile)  # not who may write
            self._place_scans(resources["nbgrader"]["student"])
            shutil.copytree(self.given, self.work, copy_function=shutil.copyfile)
            resources["metadata"]["path"] = str(self.work)
            try:
                nb, resources = super().preprocess(nb, resources, km)
            finally:
                resources["metadata"]["path"] = str(folder)
                self._end_leftovers()
        self._fail_without_points(nb)
        nb.metadata["primkit"] = {"faults": self.faults}
        return nb, resources

    def _place_scans(self, student: str) -> None:
        """Give the student's own scans and truth to a problem set that has scans."""
        if (self.given / SCANS).exists():
            world = personal_world(student, salt=Course(self.course).salt())
            (self.given / SCANS).unlink()
            save_scans(personal_scans(world), self.given / SCANS)
            save_world(world, self.scratch / "truth.geojson")

    def _fail_without_points(self, nb: Any) -> None:
        """Fail hidden tests that show no number: nbgrader would give them all points."""
        for index, cell in enumerate(nb.cells):
            about = cell.metadata.get("nbgrader", {})
            if cell.cell_type != "code" or not about.get("grade") or not MARK_CALL.search(cell.source):
                continue
            results = [output for output in cell.outputs if output.output_type == "execute_result"]
            if any(output.output_type == "error" for output in cell.outputs):
                continue
            if len(results) != 1 or not _within(results[0].data.get("text/plain", ""), about["points"]):
                self._blame(nb, index, "NoPoints", "the hidden tests did not return their points: were they changed?")

    # --- a cell -------------------------------------------------------------------------------------------

    def preprocess_cell(self, cell: Any, resources: Any, index: int) -> Any:
        """Run a cell; when it takes the kernel with it, start another one and catch up."""
        if cell.cell_type != "code" or not cell.source.strip():
            return cell, resources
        problem = self._run(cell, resources, index)
        stopped, full = _failed_with("CellTimeoutError", cell), _failed_with("MemoryError", cell)
        if problem:
            self._blame(self.nb, index, *problem)
        elif stopped:
            says = f"took longer than {self._get_timeout(cell)} s and was interrupted"
            self._note(self.nb, index, "CellTimeoutError", says)
        else:
            self._note_error(index)
        if problem or stopped or full:
            self.guilty.add(index)
        # The memory that a cell has taken would be missing to the others.
        if problem or full or (stopped and self._memory() > self.megabytes / 2):
            self._catch_up(index, resources)
        self._restore_files(index)
        return cell, resources

    def _get_timeout(self, cell: Any) -> Any:
        """Return a cell's time limit; nbclient asks for it."""
        hidden = cell is not None and cell.metadata.get("nbgrader", {}).get("grade") and MARK_CALL.search(cell.source)
        return self.tests_timeout if hidden else super()._get_timeout(cell)

    def _run(self, cell: Any, resources: Any, index: int) -> tuple[str, str] | None:
        """Run a cell; return the name of what went wrong, and a sentence, when its kernel is lost."""
        self.killed, self.letters = "", 0
        try:
            super().preprocess_cell(cell, resources, index)
        except DeadKernelError:
            if self.killed:
                return "MemoryError", self.killed
            return "KernelDied", "this cell ended Python; the other cells run without it"
        except (CellTimeoutError, RuntimeError, TimeoutError):
            limit = self._get_timeout(cell)
            return "CellTimeoutError", f"took longer than {limit} s, and could only be ended with its kernel"
        return None

    def _catch_up(self, index: int, resources: Any) -> None:
        """Start another kernel, and run the cells up to here again, without those that are guilty."""
        self._restart_kernel()
        for earlier in range(index):
            cell = self.nb.cells[earlier]
            if cell.cell_type != "code" or not cell.source.strip() or earlier in self.guilty:
                continue
            problem = self._run(_copy_cell(cell), resources, earlier)
            self.nb.cells[earlier] = cell  # its outputs are those of the first time
            self._restore_files(earlier, told=True)
            if problem:  # this time it is guilty: once more, without it
                self._blame(self.nb, earlier, *problem)
                self.guilty.add(earlier)
                return self._catch_up(index, resources)
        return None

    def _blame(self, nb: Any, index: int, name: str, sentence: str) -> None:
        """Let a cell fail, with a sentence that says why."""
        cell = nb.cells[index]
        traceback = [f"\x1b[0;31m{name}\x1b[0m: {sentence}"]
        cell.outputs = [
            *(output for output in cell.outputs if output.output_type != "execute_result"),
            new_output("error", ename=name, evalue=sentence, traceback=traceback),  # type: ignore[no-untyped-call]
        ]
        self._note(nb, index, name, sentence)

    def _note_error(self, index: int) -> None:
        """Note a cell of the student's own that fails; that a test fails says its score."""
        cell = self.nb.cells[index]
        for error in (output for output in cell.outputs if output.output_type == "error"):
            if error.ename in ALWAYS_NOTED or not cell.metadata.get("nbgrader", {}).get("grade"):
                self._note(self.nb, index, error.ename, " ".join(error.evalue.split())[:ERROR_LETTERS] or "fails")

    def _note(self, nb: Any, index: int, name: str, sentence: str) -> None:
        about = nb.cells[index].metadata.get("nbgrader", {})
        cell = about.get("grade_id", f"cell {index + 1}")
        self.faults.append({"cell": cell, "name": name, "says": sentence})

    def _restore_files(self, index: int, *, told: bool = False) -> None:
        """Put back what a cell has deleted or changed of the files it was given, and note it unless it is told."""
        given = (path.relative_to(self.given) for path in sorted(self.given.rglob("*")) if path.is_file())
        lost = [path for path in given if not _same(self.given / path, self.work / path)]
        if not lost:
            return
        whole = not self.work.is_dir()
        for path in lost:
            with suppress(OSError):
                (self.work / path).parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(self.given / path, self.work / path)
        if whole:
            with suppress(DeadKernelError, RuntimeError):
                source = f"__import__('os').chdir({str(self.work)!r})"
                self.wait_for_reply(self.kc.execute(source, silent=True, store_history=False))
        if told:
            return
        what = "the whole folder" if whole else ", ".join(sorted(map(str, lost)))
        self._note(self.nb, index, "FilesChanged", f"deleted or changed {what}: it was put back")

    # --- a kernel -----------------------------------------------------------------------------------------

    def start_new_kernel(self, **options: Any) -> None:
        """Start a kernel that knows the course, and nothing of its teacher."""
        home = self.scratch / "home"
        home.mkdir(exist_ok=True)
        options["env"] = _environment(home, self.course)
        if (self.scratch / "truth.geojson").exists():
            options["env"][TRUTH_VARIABLE] = str(self.scratch / "truth.geojson")
        super().start_new_kernel(**options)
        self.groups += filter(None, [getattr(self.km.provisioner, "pgid", None)])

    def start_new_kernel_client(self) -> Any:
        """Prepare the kernel before the first cell runs."""
        client = super().start_new_kernel_client()
        self.wait_for_reply(client.execute(PREPARE.format(self.megabytes * MEGABYTE), silent=True, store_history=False))
        return client

    async def _async_check_alive(self) -> None:
        """End a kernel that takes too much memory, where the system does not refuse it: Windows and macOS."""
        if self._memory() > self.megabytes:
            self.killed = f"this cell took more than {self.megabytes} MB of memory, and its kernel was ended"
            await ensure_async(self.km.shutdown_kernel(now=True))
            raise DeadKernelError(self.killed)
        await super()._async_check_alive()

    def _memory(self) -> float:
        """Return what the kernel takes, in megabytes."""
        pid = getattr(getattr(self.km, "provisioner", None), "pid", None)
        with suppress(psutil.Error):
            return psutil.Process(pid).memory_info().rss / MEGABYTE if pid else 0.0
        return 0.0

    def _restart_kernel(self) -> None:
        self.shutdown_kernel = "immediate"
        self._cleanup_kernel()
        self.km = self.create_kernel_manager()
        self.start_new_kernel()
        self.start_new_kernel_client()

    def _end_leftovers(self) -> None:
        """End the programs that cells have started, where processes have groups: Linux and macOS."""
        for group in self.groups:
            with suppress(ProcessLookupError, PermissionError, AttributeError):
                if group != os.getpgid(0):
                    os.killpg(group, signal.SIGKILL)

    def output(self, outs: Any, msg: Any, display_id: Any, cell_index: int) -> Any:
        """Keep what a cell says, up to a limit: an endless loop may print all the time."""
        self.letters += len(str(msg["content"].get("text", "")))
        if self.letters > CELL_LETTERS and msg["msg_type"] == "stream":
            return None
        return super().output(outs, msg, display_id, cell_index)


def _environment(home: Path, course: str) -> dict[str, str]:
    """Return a kernel's environment."""
    fonts = Path(course) / ".primkit" / "matplotlib"  # the list of fonts takes seconds to make: one for all
    fonts.mkdir(parents=True, exist_ok=True)
    return {
        **{name: os.environ[name] for name in KEPT_VARIABLES if name in os.environ},
        **dict.fromkeys(("HOME", "USERPROFILE", "APPDATA", "TEMP", "TMP", "TMPDIR"), str(home)),
        **dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"), "1"),
        "MPLCONFIGDIR": str(fonts),
        "PYTHONPATH": course,
        "PYTHONUSERBASE": site.getuserbase(),
        "PYTHONWARNINGS": "ignore",  # nbgrader takes a test that writes to stderr as failed
        "PYTHONDONTWRITEBYTECODE": "1",
        "NBGRADER_EXECUTION": "autograde",
    }


def _same(given: Path, now: Path) -> bool:
    try:
        return filecmp.cmp(given, now, shallow=False)
    except OSError:
        return False


def _within(text: str, points: float) -> bool:
    try:
        return 0 <= float(text) <= float(points)
    except ValueError:
        return False


def _failed_with(name: str, cell: Any) -> bool:
    return any(output.get("ename") == name for output in cell.outputs)


def _copy_cell(cell: Any) -> Any:
    copy = type(cell)(cell)
    copy.outputs = []
    return copy
