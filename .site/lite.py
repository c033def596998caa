"""Lite: the lessons in JupyterLite, which runs Python in the browser: no account, nothing installed.

    python -m pip install -r .site/lite.txt              Chrome and Edge; or .site/lite-everywhere.txt for all browsers
    python .site/lite.py                                 into build/lite

In:  the lessons, and the wheel of this folder.
Out: a folder for any web server. The library comes with it; Python, NumPy and the others come from Pyodide's own server
     when a reader opens it, which needs a network. Never tried with them, for want of that network.
"""

import json
import shutil
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

ROOT = Path(__file__).resolve().parent.parent
# One cell for Lab, Colab, Binder and Lite: where primkit is there already it does nothing.
FIRST = """\
try:
    import primkit
except ModuleNotFoundError:  # in a browser, or on a borrowed computer: once for each session, a minute
    %pip install -q primkit-lab"""


def main():
    """Build it, and see that all is in it."""
    out = Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "build" / "lite").resolve()
    shutil.rmtree(out, ignore_errors=True)
    with TemporaryDirectory() as folder:
        stage = Path(folder)
        subprocess.run([sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", folder], check=True, cwd=ROOT)
        (wheel,) = stage.glob("*.whl")
        (stage / "lessons").mkdir()
        lessons = sorted((ROOT / "notebooks").glob("[0-9]*.ipynb"))
        for path in lessons:
            text = json.dumps(with_first_cell(json.loads(path.read_text(encoding="utf-8"))), ensure_ascii=False)
            (stage / "lessons" / path.name).write_text(text, encoding="utf-8")
        shutil.copytree(ROOT / "notebooks" / "recordings", stage / "lessons" / "recordings")
        command = [sys.executable, "-m", "jupyterlite_core", "build", "--lite-dir", folder, "--output-dir", str(out)]
        command += ["--contents", str(stage / "lessons"), "--piplite-wheels", str(wheel), "--no-sourcemaps"]
        subprocess.run(command, check=True, cwd=folder)
        needed = [f"files/{path.name}" for path in lessons] + [f"pypi/{wheel.name}", "lab/index.html"]
    absent = [name for name in needed if not (out / name).is_file()]
    index = json.loads((out / "pypi" / "all.json").read_text(encoding="utf-8"))
    absent += [] if "primkit-lab" in index else ["primkit-lab in pypi/all.json"]
    size = sum(path.stat().st_size for path in out.rglob("*") if path.is_file()) / 1e6
    print(f"{len(lessons)} lessons in {out}, {size:.0f} MB" + f"; missing: {', '.join(absent)}" * bool(absent))
    sys.exit(bool(absent))


def with_first_cell(lesson):
    """Return a lesson that installs the library where it is not there, below its title."""
    cell = {"cell_type": "code", "id": "get-primkit", "source": FIRST, "outputs": [], "execution_count": None}
    lesson["cells"].insert(1, cell | {"metadata": {}})
    return lesson


if __name__ == "__main__":
    main()
