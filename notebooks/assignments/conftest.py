"""The kernels that pytest runs the problem sets in find the teacher's package ``grader``, as graded kernels do."""

import os
from pathlib import Path

HERE = str(Path(__file__).resolve().parent)
os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, [HERE, os.environ.get("PYTHONPATH")]))
