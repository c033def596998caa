"""Executing: run a submission so that whatever it does costs its own cells alone, and mark it from outside.

nbgrader's own preprocessor runs a notebook, hidden tests and all, in one kernel. This one, which the course's
``nbgrader_config.py`` puts in its place, runs only what is the student's there, in a kernel of its own
(``own_kernel.py``). The graded cells are run by the judge, in this process, as the teacher wrote them, with the
student's functions called from afar (``grading/judging.py``). And it goes on:

* The kernel works in a scratch copy of the submission's folder. What is deleted or changed there is put back for the
  next cell.
* A cell that takes too long is interrupted. A kernel that ends, or cannot be interrupted, is started again: the guilty
  cell gets an error that says so, the cells before it run again without it, and then those after it.

In:  a notebook, and the folder it lies in.
Out: the notebook with its outputs; ``metadata.primkit.faults`` lists what happened, for the report.
"""

from __future__ import annotations

import filecmp
import os
import re
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import chdir, contextmanager, suppress
from pathlib import Path
from queue import Empty
from typing import Any

from nbclient.exceptions import CellTimeoutError, DeadKernelError
from nbclient.util import run_sync
from traitlets import Float, Integer

from ..formats import save_scans
from ..world import World
from .confining import UNCOUNTED, UNPROTECTED, confined_by, processes_are_limited
from .course import SCANS, Course
from .grading.judging import Judging, error_output, hidden_tests_of
from .grading.task import Missing, missing
from .grading.workers import Workers
from .own_kernel import OwnKernel
from .personal import board_of, personal_scans, personal_world

FORKS = hasattr(os, "fork")  # not on Windows: there the kernel itself answers the judge, in the end
LEAVE = "__import__('primkit.course.grading.serving', fromlist=['serving']).{0}({1!r}, {2}, globals())"
PUT_BACK = """\
def _put_back(work, files):
    import os, shutil
    for name, content in files.items():
        place = work
        for part in name.split(os.sep):
            os.makedirs(place, exist_ok=True)
            place = os.path.join(place, part)
            if os.path.islink(place) or (os.path.lexists(place) and not os.path.isdir(place)):
                os.unlink(place)  # a link, a pipe, the file as it is now
        shutil.rmtree(place, ignore_errors=True)
        with open(place, "xb") as file:
            file.write(content)
    try:
        os.getcwd()
    except OSError:
        os.chdir(work)
_put_back({!r}, {!r})
del _put_back
"""
SERVED_SECONDS = 2.0  # until a kernel that answered the judge is ready for a cell again
ALWAYS_NOTED = ("MemoryError", "SystemExit")  # also where a test meets them
ERROR_LETTERS = 200  # letters of an error that are told
CELL_LETTERS = 200_000  # of one cell's prints that are kept
CELL_BYTES = 2**22  # of one cell's outputs, pictures and all
LINE_NUMBER = re.compile(r"\bline (\d+)")


class CarefulExecute(OwnKernel):
    """Run the cells of a submission; see this module."""

    timeout = Integer(60, help="Time limit of a cell, in seconds.", allow_none=True).tag(config=True)
    seconds = Float(5.0, help="Processor time for the calls of each visible test, and of each part of a hidden one.")
    seconds = seconds.tag(config=True)

    # --- a notebook ---------------------------------------------------------------------------------------

    def preprocess(self, nb: Any, resources: Any = None, km: Any = None) -> Any:
        """Run a notebook in a scratch copy of its folder."""
        self.faults: list[dict[str, Any]] = list(nb.metadata.get("primkit", {}).get("faults", ()))  # of its cells
        self.guilty: set[int] = set()
        self.failed: dict[int, tuple[str, str]] = {}  # why a cell defines nothing: the error's name, and its words
        folder, about = Path(resources["metadata"]["path"]), resources["nbgrader"]
        source = Path(self.course, "source", about.get("assignment", ""), f"{about.get('notebook')}.ipynb")
        self.judging = Judging(source, self._missing) if source.is_file() else None
        self.twins = len(self.judging.graded) if self.judging else 0
        if not confined_by():
            self.faults.append({"cell": "-", "name": "unprotected", "says": UNPROTECTED})
        if not processes_are_limited():
            self.faults.append({"cell": "-", "name": "uncounted", "says": UNCOUNTED})
        with tempfile.TemporaryDirectory(prefix="primkit-", ignore_cleanup_errors=True) as scratch:
            self.prepare(Path(scratch), self.judging.without if self.judging else ())
            self.given, self.work = Path(scratch, "given"), Path(scratch, "work")
            # What is in a file, and not who may write it; no links, for what they lead to was not handed in.
            shutil.copytree(folder, self.given, copy_function=shutil.copyfile, ignore=_links)
            self.world = self._place_scans(about["student"])
            shutil.copytree(self.given, self.work, copy_function=shutil.copyfile, dirs_exist_ok=True)
            seconds = (self.judging and self.judging.seconds) or self.seconds
            self.workers = Workers(Path(scratch, "run"), self.spent, seconds, None if FORKS else self._serve)
            resources["metadata"]["path"] = str(self.work)
            try:
                nb, resources = super().preprocess(nb, resources, km)
            finally:
                resources["metadata"]["path"] = str(folder)
                self.workers.close()
                self.end_leftovers()
        nb.metadata["primkit"] = {"faults": self.faults, "confined": confined_by()}
        return nb, resources

    @contextmanager
    def setup_kernel(self, **options: Any) -> Iterator[None]:
        """Judge the graded cells once all others have run, while the kernel is there."""
        with super().setup_kernel(**options):
            yield
            self._judge()
            self.processes()  # what is still there is ended

    def _judge(self) -> None:
        with hidden_tests_of(Path(self.course).resolve()), board_of(self.world), chdir(self.given):
            for index, cell in enumerate(self.nb.cells):
                if self.judging and (name := self._graded(cell)):
                    cell.source = self.judging.graded[name]["source"]
                    before = self.spent()
                    cell.outputs = self.judging.outputs(name, index, self.workers)
                    cell.metadata["primkit"] = {"seconds": round(max(0.0, self.spent() - before), 3)}
                    self._note_judged(index)

    def _graded(self, cell: Any) -> str | None:
        """Return the name of a cell that the judge runs."""
        name = cell.metadata.get("nbgrader", {}).get("grade_id")
        return name if cell.cell_type == "code" and self.judging and name in self.judging.graded else None

    def _place_scans(self, student: str) -> World | None:
        """Give the student's own scans to a problem set that has scans; return the board that they show."""
        if not (self.given / SCANS).exists():
            return None
        world = personal_world(student, salt=Course(self.course).salt())
        (self.given / SCANS).unlink()
        save_scans(personal_scans(world), self.given / SCANS)
        return world

    # --- a cell -------------------------------------------------------------------------------------------

    def preprocess_cell(self, cell: Any, resources: Any, index: int) -> Any:
        """Run a cell; when it takes the kernel with it, start another one and catch up."""
        if cell.cell_type != "code" or not cell.source.strip():
            return cell, resources
        if self._graded(cell):
            cell.outputs, cell.execution_count = [], None
            self._leave_twin(index)
            return cell, resources
        problem = self._run(cell, resources, index)
        stopped, full = _failed_with("CellTimeoutError", cell), _failed_with("MemoryError", cell)
        if problem:
            self._blame(index, *problem)
        elif stopped:
            self._note(index, "CellTimeoutError", f"took longer than {self.timeout} s and was interrupted")
        else:
            self._note_error(index)
        if problem or stopped or full:
            self.guilty.add(index)
        # The memory that a cell has taken would be missing to the others.
        if problem or full or (stopped and self.memory() > self.megabytes / 2):
            self._catch_up(index, resources)
        self._restore_files(index)
        return cell, resources

    def _run(self, cell: Any, resources: Any, index: int) -> tuple[str, str] | None:
        """Run a cell; return the name of what went wrong, and a sentence, when its kernel is lost."""
        self.killed, self.letters, self.size = "", 0, 0
        lost = None
        try:
            super().preprocess_cell(cell, resources, index)
        except DeadKernelError:
            lost = "KernelDied", "this cell ended Python; the other cells run without it"
        except (CellTimeoutError, RuntimeError, TimeoutError):
            lost = "CellTimeoutError", f"took longer than {self.timeout} s, and could only be ended with its kernel"
        except Exception as error:  # of nbclient's, over messages that are none
            lost = "KernelDied", f"this cell has changed how its kernel speaks ({type(error).__name__}): it was ended"
        # A kernel is interrupted before it is ended: the cell may have had time to answer as if nothing were lost.
        return ("MemoryError", self.killed) if self.killed else lost

    def _leave_twin(self, index: int) -> None:
        """Let the kernel leave a twin of itself, as it is now, to be asked by the judge in the end."""
        if FORKS:
            with suppress(Exception):  # who has changed the kernel has no twin, and no points
                self.run_silently(LEAVE.format("leave_twin", self.workers.address, index))
            self.workers.meet()

    def _serve(self, index: int) -> None:
        """Let the kernel itself answer the judge; another one, if it still is at the part before."""
        if self.serving and not self._has_served():
            self._catch_up(len(self.nb.cells), self.resources)
        address = self.workers.address if isinstance(self.workers.address, str) else list(self.workers.address)
        source = LEAVE.format("serve", address, index)
        self.serving = self.kc.execute(source, silent=True, store_history=False)

    serving = ""  # the message that asked the kernel to

    def _has_served(self) -> bool:
        with suppress(Empty):
            while True:
                answer = run_sync(self.kc.get_shell_msg)(timeout=SERVED_SECONDS)
                if answer["parent_header"].get("msg_id") == self.serving:
                    return True
        return False

    def _catch_up(self, index: int, resources: Any) -> None:
        """Start another kernel, and run the cells up to here again, without those that are guilty."""
        self.restart_kernel()
        for earlier in range(index):
            cell = self.nb.cells[earlier]
            if cell.cell_type != "code" or not cell.source.strip() or earlier in self.guilty:
                continue
            if self._graded(cell):
                self._leave_twin(earlier)
                continue
            problem = self._run(type(cell)(cell, outputs=[]), resources, earlier)
            self.nb.cells[earlier] = cell  # its outputs are those of the first time
            self._restore_files(earlier, told=True)
            if problem:  # this time it is guilty: once more, without it
                self._blame(earlier, *problem)
                self.guilty.add(earlier)
                return self._catch_up(index, resources)
        return None

    # --- what happened ------------------------------------------------------------------------------------

    def _blame(self, index: int, name: str, sentence: str) -> None:
        """Let a cell fail, with a sentence that says why."""
        cell = self.nb.cells[index]
        kept = [output for output in cell.outputs if output.output_type != "execute_result"]
        cell.outputs = [*kept, error_output(name, sentence)]
        self.failed[index] = name, f"{name}: {sentence}"
        self._note(index, name, sentence)

    def _note_error(self, index: int) -> None:
        """Note a cell of the student's own that fails."""
        for error in (output for output in self.nb.cells[index].outputs if output.output_type == "error"):
            words = " ".join(error.evalue.split())[:ERROR_LETTERS]
            line = LINE_NUMBER.search(re.sub(r"\x1b\[[\d;]*m", "", "\n".join(error.traceback)))
            where = f" in line {line[1]}" if line else ""
            self.failed[index] = error.ename, f"{error.ename}{where}" + (f": {words}" if words else "")
            self._note(index, error.ename, words or "fails")

    def _note_judged(self, index: int) -> None:
        """Note of a graded cell what a teacher should look at; that a test fails says its score."""
        for output in self.nb.cells[index].outputs:
            if output.output_type == "error" and output.ename in (*ALWAYS_NOTED, "KernelDied"):
                self._note(index, output.ename, output.evalue[:ERROR_LETTERS] or "fails")
        for trace in dict.fromkeys(self.workers.traces):
            self._note(index, "OddAnswer", f"{trace}: read the code")
        self.workers.traces.clear()

    def _note(self, index: int, name: str, sentence: str) -> None:
        about = self.nb.cells[index].metadata.get("nbgrader", {})
        cell = about.get("grade_id", f"cell {index + 1}")
        self.faults.append({"cell": cell, "name": name, "says": sentence})

    def _missing(self, name: str) -> Missing:
        """Return why the notebook has no such name: the last failed cell that defines it says it."""
        defines = re.compile(rf"^[ \t]*(async +)?def +{re.escape(name)}\b", re.MULTILINE)
        told = [self.failed[index] for index in sorted(self.failed) if defines.search(self.nb.cells[index].source)]
        return missing(name, told[-1] if told else None)

    def _restore_files(self, index: int, *, told: bool = False) -> None:
        """Let the kernel put back what a cell has deleted or changed of its files, and note it unless it is told.

        It is done where the student's code runs, for a link that this has left behind may lead anywhere.
        """
        given = (path.relative_to(self.given) for path in sorted(self.given.rglob("*")) if path.is_file())
        lost = [path for path in given if not _same(self.given / path, self.work / path)]
        if not lost:
            return
        what = ", ".join(map(str, lost)) if self.work.is_dir() else "the whole folder"
        files = {str(path): (self.given / path).read_bytes() for path in lost}
        with suppress(DeadKernelError, RuntimeError, TimeoutError):
            self.run_silently(PUT_BACK.format(str(self.work), files))
        if not told:
            self._note(index, "FilesChanged", f"deleted or changed {what}: it was put back")

    def output(self, outs: Any, msg: Any, display_id: Any, cell_index: int) -> Any:
        """Keep what a cell says, up to a limit: an endless loop may print all the time."""
        self.letters += len(str(msg["content"].get("text", "")))
        self.size += len(str(msg["content"]))
        if self.size > CELL_BYTES or (self.letters > CELL_LETTERS and msg["msg_type"] == "stream"):
            return None
        return super().output(outs, msg, display_id, cell_index)


def _links(folder: str, names: list[str]) -> list[str]:
    return [name for name in names if Path(folder, name).is_symlink()]


def _same(given: Path, now: Path) -> bool:
    try:
        return not now.is_symlink() and filecmp.cmp(given, now, shallow=False)
    except OSError:
        return False


def _failed_with(name: str, cell: Any) -> bool:
    return any(output.get("ename") == name for output in cell.outputs)
