"""The tests themselves: a run on a machine that lacks playwright ends with its tests' own results."""

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
WITHOUT = "import sys\nsys.modules['playwright'] = None\nimport pytest\nsys.exit(pytest.main(sys.argv[1:]))"


def test_without_playwright_the_browser_s_tests_are_skipped_with_a_word():
    """Regression: the run ended in an internal error after its last test."""
    names = ("tests/test_suite.py::test_one_that_passes", "tests/browser/test_voila.py")
    environment = {name: value for name, value in os.environ.items() if name != "PRIMKIT_BROWSER"}
    command = [sys.executable, "-c", WITHOUT, "-p", "no:cacheprovider", "-p", "no:xdist", *names]
    run = subprocess.run(command, capture_output=True, text=True, cwd=ROOT, env=environment)
    *_, why, last = run.stdout.strip().splitlines()
    assert run.returncode == 0, run.stdout + run.stderr
    assert "1 passed, 5 skipped" in last
    assert "the lessons are tried in a browser: " in why


def test_one_that_passes():
    assert ROOT.is_dir()
