"""What holds for all tests: the same examples on every run, pictures without a window, and threads that wait asleep."""

import os
from pathlib import Path

# Threads of scikit-learn's that wait for work keep a core busy by default, which the other tests need. It is read when
# scikit-learn is loaded, here and in kernels and programs that tests start.
os.environ.setdefault("OMP_WAIT_POLICY", "PASSIVE")

import matplotlib
import numpy as np
import pytest
from hypothesis import settings

from tests.helpers import WAITS

# The same examples on every run and every machine; no time limit, which a busy machine would break.
settings.register_profile("primkit", derandomize=True, deadline=None, database=None)
# To look for new counterexamples by hand: python -m pytest --hypothesis-profile search
settings.register_profile("search", max_examples=1000, deadline=None, print_blob=True)
settings.load_profile("primkit")

# For this process only. The environment variable MPLBACKEND would reach the notebooks' kernels as well, which then
# show no pictures.
matplotlib.use("Agg")


def pytest_addoption(parser):
    parser.addoption(
        "--screenshots", type=Path, metavar="DIR", help="keep the browser's pictures of the lessons in this folder"
    )


@pytest.fixture(scope="session")
def screenshots(request):
    """The folder for pictures of the lessons, if it is asked for by --screenshots."""
    folder = request.config.getoption("screenshots", None)
    if folder:
        folder.mkdir(parents=True, exist_ok=True)
    return folder


def pytest_terminal_summary(terminalreporter):
    """Show how long a key press takes to become a picture; tests tell it, in whatever process they run."""
    reports = [*terminalreporter.getreports("passed"), *terminalreporter.getreports("failed")]
    waits = [value for report in reports for name, value in report.user_properties if name == WAITS]
    if not waits:
        return
    terminalreporter.section("from a key press to the changed picture")
    terminalreporter.write_line(f"{'lesson':30} median [ms]  95 % below [ms]  presses")
    for lesson, times in waits:
        median, most = np.percentile(times, [50, 95])
        terminalreporter.write_line(f"{lesson:30} {median:11.0f}  {most:15.0f}  {len(times):7}")
