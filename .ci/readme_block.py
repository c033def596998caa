"""Print the commands that README.md gives its readers, so that what CI runs is what the README says.

A marker, an HTML comment on a line of its own, stands before each such block:

    <!-- ci: tests -->
    ```
    the commands
    ```

Use: python .ci/readme_block.py tests
"""

import re
import sys
from pathlib import Path

README = Path(__file__).resolve().parent.parent / "README.md"


def block(text: str, name: str) -> str:
    """Return what stands in the fenced block right after the one marker ``<!-- ci: name -->``."""
    marker = rf"^<!-- ci: {re.escape(name)} -->[ \t]*$"
    if (count := len(re.findall(marker, text, re.MULTILINE))) != 1:
        raise SystemExit(f"README.md must hold the marker <!-- ci: {name} --> once, found {count}")
    match = re.search(marker + r"\s*^```[^\n]*\n(.*?)^```[ \t]*$", text, re.MULTILINE | re.DOTALL)
    if not (match and match[1].strip()):
        raise SystemExit(f"in README.md a fenced block with commands must follow the marker <!-- ci: {name} -->")
    return match[1]


if __name__ == "__main__":
    print(block(README.read_text(encoding="utf-8"), sys.argv[1]), end="")
