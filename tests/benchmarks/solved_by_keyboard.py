"""All problem sets, as students get them, solved in Lab by keyboard alone: every visible test must pass.

python -m tests.benchmarks.solved_by_keyboard
"""

import tempfile
from pathlib import Path

from tests.browser.by_keyboard import NAMES, PASSED, solve
from tests.browser.lab import chromium, enter, jupyter


def main():
    with tempfile.TemporaryDirectory() as folder, chromium() as browser, jupyter(Path(folder)) as address:
        page = browser.new_context(base_url=address, viewport={"width": 1280, "height": 720}).new_page()
        page.set_default_timeout(180_000)
        enter(page)
        for name in NAMES:
            said = solve(page, Path(folder), name)
            for task, outputs in said.items():
                print(f"{name} {task}: {'passes' if PASSED in str(outputs) else outputs}", flush=True)


if __name__ == "__main__":
    main()
