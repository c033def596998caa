"""What holds for all tests: the same examples on every run, and pictures without a window."""

from pathlib import Path

import matplotlib
from hypothesis import settings

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
