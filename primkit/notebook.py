"""Notebook: what a notebook does more once primkit is loaded in it: each of matplotlib's figures is shown with words.

In:  the running IPython.
Out: nothing; see ``plots.told``, which is loaded at the end of the first cell in which matplotlib is.

Not here: any setting of matplotlib; how a figure looks stays the user's.
"""

from __future__ import annotations

import sys
from typing import Any


def show_figures_with_words(shell: Any) -> None:
    """Have figures shown with words in this IPython shell, also those that a student draws without ``plots``."""

    def once_in_use() -> None:
        if "matplotlib.pyplot" in sys.modules:
            from . import plots  # noqa: F401  # loading it is enough

            shell.events.unregister("post_execute", once_in_use)

    shell.events.register("post_execute", once_in_use)
