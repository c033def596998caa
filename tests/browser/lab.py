"""Jupyter with a copy of the lessons, and a lesson in its page.

Nothing outlives the tests, whatever ends them: the server stops when its standard input is closed, which the
operating system does even for a process that was killed; kernels and browsers follow those who started them.
"""

import json
import os
import shutil
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path
from urllib.request import urlopen

import pytest

from .panel import Panel, panels

ROOT = Path(__file__).resolve().parents[2]
BROWSERS = ("chromium", "chromium-browser", "google-chrome")
LESSONS = [path.stem for path in sorted((ROOT / "notebooks").glob("*.ipynb"))]
PATIENCE = 180  # s: for a server to come up, or a page to show something, on a machine that is busy
RUN_TIME = 300  # s: for all cells of a lesson
TALLEST = 16_000  # px: browsers draw no taller picture

SERVER = """
import os, signal, sys, threading

def wait_for_the_end():
    sys.stdin.read()
    os.kill(os.getpid(), signal.SIGTERM)

threading.Thread(target=wait_for_the_end, daemon=True).start()

from jupyterlab.labapp import main

main()
"""

TOKEN = "lessons"
OPTIONS = [
    *("--no-browser", "--allow-root", "--ServerApp.ip=127.0.0.1", "--ServerApp.port=0"),
    *(f"--IdentityProvider.token={TOKEN}", "--LabApp.expose_app_in_browser=True"),
]

# Lab's own settings: no pop-up with news from the network, and all cells in the page, also those out of sight.
SETTINGS = {
    "labconfig/page_config.json": {"disabledExtensions": {"@jupyterlab/apputils-extension:announcements": True}},
    "lab/user-settings/@jupyterlab/notebook-extension/tracker.jupyterlab-settings": {"windowingMode": "none"},
}


@contextmanager
def chromium():
    """Run a browser without a window; without one the tests are skipped, or fail if PRIMKIT_BROWSER=required."""
    program = next(filter(None, map(shutil.which, BROWSERS)), None)
    if program is None:
        _absent(f"none of these is installed: {', '.join(BROWSERS)}")
    try:
        from playwright.sync_api import sync_playwright  # here, as all of tests/ must load without it
    except ImportError:
        _absent("playwright, which drives it, is not installed")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=program, args=["--no-sandbox"])
        yield browser
        browser.close()


def _absent(why):
    end = pytest.fail if os.environ.get("PRIMKIT_BROWSER") == "required" else pytest.skip
    end(f"the lessons are tried in a browser: {why}")


@contextmanager
def jupyter(folder: Path):
    """Run Jupyter with a copy of the lessons in ``folder``, and all that it keeps beside them; gives its address."""
    notebooks = shutil.copytree(ROOT / "notebooks", folder / "notebooks", ignore=shutil.ignore_patterns(".*"))
    for name, content in SETTINGS.items():
        path = folder / "config" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(json.dumps(content))
    homes = {f"JUPYTER_{kind.upper()}_DIR": str(folder / kind) for kind in ("config", "data", "runtime")}
    command = [sys.executable, "-c", SERVER, *OPTIONS, f"--ServerApp.root_dir={notebooks}"]
    with (
        open(folder / "log.txt", "w") as log,
        subprocess.Popen(
            command,
            env=os.environ | homes | {"IPYTHONDIR": str(folder / "ipython")},
            stdin=subprocess.PIPE,
            stdout=log,
            stderr=log,
        ) as server,
    ):
        try:
            yield _address(server, folder)
        finally:
            _stop(server)


def _address(server, folder):
    """Return where the server answers; it writes that down itself, as the port is free for it to choose."""
    give_up = time.monotonic() + PATIENCE
    while server.poll() is None and time.monotonic() < give_up:
        time.sleep(0.05)
        for path in (folder / "runtime").glob("jpserver-*.json"):
            try:
                url = json.loads(path.read_text())["url"]
                urlopen(f"{url}api?token={TOKEN}").close()
                return url
            except (ValueError, OSError):
                pass  # not yet written to the end, or not yet listening
    raise RuntimeError(f"Jupyter did not come up; it says:\n{(folder / 'log.txt').read_text()}")


def _stop(server):
    """Let the server end its kernels and itself; insist if it does not."""
    server.stdin.close()
    try:
        server.wait(10)
    except subprocess.TimeoutExpired:
        server.kill()


def enter(page):
    """Show Lab with a single document at a time, which leaves the most room, and wait until it takes commands."""
    page.goto(f"/doc?reset&token={TOKEN}")
    page.wait_for_function("window.jupyterapp", timeout=1000 * PATIENCE)
    page.evaluate("window.jupyterapp.restored.then(() => true)")


OPEN = """async (path) => {
    const open = await window.jupyterapp.commands.execute("docmanager:open", { path, factory: "Notebook" });
    await open.context.ready;
    await open.sessionContext.ready;
    const asked = new Set(); // what widgets asked the kernel, and it has not yet done
    const said = [];
    open.sessionContext.session.kernel.anyMessage.connect((_, { direction, msg }) => {
        const { header, parent_header, content } = msg;
        if (direction === "send" && header.msg_type === "comm_msg") asked.add(header.msg_id);
        if (content.execution_state === "idle") asked.delete(parent_header.msg_id);
        if (header.msg_type === "error") said.push(`${content.ename}: ${content.evalue}`);
        if (content.name === "stderr") said.push(content.text);
    });
    return { open, asked, said };
}"""

# Work in the page has an end here: the page itself would wait for ever.
IN_TIME = """const inTime = (work, seconds) => Promise.race([work, new Promise((_, fail) =>
    setTimeout(() => fail(new Error(`the kernel was not done after ${seconds} s`)), 1000 * seconds))]);"""

RUN = f"""() => {{
    {IN_TIME}
    return inTime(window.jupyterapp.commands.execute("notebook:run-all-cells"), {RUN_TIME});
}}"""

# Runs the code cells that begin like this, and no others: what is not run shows what is stored.
RUN_SOME = f"""({{ open }}, beginning) => {{
    {IN_TIME}
    const cells = open.content, wanted = new RegExp(beginning);
    cells.deselectAll();
    cells.activeCellIndex = cells.widgets.findIndex((cell) => cell.model.type === "code");
    cells.widgets
        .filter((cell) => cell.model.type === "code" && wanted.test(cell.model.sharedModel.getSource()))
        .forEach((cell) => cells.select(cell));
    return inTime(window.jupyterapp.commands.execute("notebook:run-cell"), {RUN_TIME});
}}"""

# Cells and widgets have threads of their own in the kernel: a cell's end tells nothing of a slider's. When one move is
# done, the next may be sent, so nothing may be open for two frames.
SETTLE = f"""({{ asked }}) => {{
    {IN_TIME}
    const frame = () => new Promise((seen) => requestAnimationFrame(() => setTimeout(seen)));
    const settled = async () => {{
        for (let quiet = 0; quiet < 2; quiet = asked.size ? 0 : quiet + 1) await frame();
    }};
    return inTime(settled(), {PATIENCE});
}}"""

CLOSE = """async ({ open }) => {
    await open.sessionContext.shutdown();
    open.context.model.dirty = false;
    open.dispose();
}"""


class Lesson:
    """A lesson that is open in Lab, with all its cells run, or the first code cell and those that begin in some way."""

    def __init__(self, page, name: str, slider_cells: int, beginning: str = "") -> None:
        self.page, self.name, self.slider_cells = page, name, slider_cells
        self._handle = page.evaluate_handle(OPEN, f"{name}.ipynb")
        self._handle.evaluate(RUN_SOME, beginning) if beginning else page.evaluate(RUN)
        self.settle()
        self.said(anew=True)  # while it opens, the kernel speaks of widgets that are not yet there
        self.panels: list[Panel] = panels(page, slider_cells, self.settle)

    def settle(self) -> None:
        """Wait until the kernel has answered all that was asked, and the page shows it."""
        self._handle.evaluate(SETTLE)

    def said(self, anew: bool = False) -> list[str]:
        """Return the errors and warnings that the kernel sent after the cells were run; ``anew`` forgets them."""
        return self._handle.evaluate("({ said }, anew) => (anew ? said.splice(0) : said)", anew)

    def widen(self, width: int, height: int = 1000) -> None:
        """Show the lesson in a window of this size."""
        self.page.set_viewport_size({"width": width, "height": height})
        self.settle()

    def photograph(self, folder: Path, widths: list[int]) -> None:
        """Keep pictures of the sliders and of the whole lesson in a folder."""
        for width in widths:
            self.widen(width)
            for number, panel in enumerate(self.panels, 1):
                panel.root.screenshot(path=folder / f"{self.name}_{width}_slider_{number}.png")
            self.widen(width, min(self.page_height() + 80, TALLEST))
            self.page_height()
            self.page.screenshot(path=folder / f"{self.name}_{width}.png")

    def page_height(self) -> int:
        """Scroll up; return where the last cell ends then, in px."""
        return self.page.locator(".jp-Notebook .jp-WindowedPanel-outer").evaluate("""(all) => {
            all.scrollTop = 0;
            return Math.ceil([...all.querySelectorAll(".jp-Cell")].at(-1).getBoundingClientRect().bottom);
        }""")

    def close(self) -> None:
        """Close the lesson and end its kernel."""
        self._handle.evaluate(CLOSE)


def blank_notebook(sources) -> str:
    """Return a notebook of these code cells, not yet run, as text."""
    blank = {"cell_type": "code", "metadata": {}, "outputs": [], "execution_count": None}
    cells = [blank | {"id": f"cell-{number}", "source": source.strip()} for number, source in enumerate(sources)]
    python = {"kernelspec": {"name": "python3", "display_name": "Python 3"}}
    return json.dumps({"nbformat": 4, "nbformat_minor": 5, "metadata": python, "cells": cells})


@contextmanager
def opened(page, name: str, slider_cells: int, beginning: str = ""):
    """Open a lesson, run it, or what begins in some way, and close it in the end."""
    lesson = Lesson(page, name, slider_cells, beginning)
    try:
        yield lesson
    finally:
        lesson.close()
