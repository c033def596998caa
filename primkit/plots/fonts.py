"""Fonts: the list of this computer's fonts, which Matplotlib takes seconds to make.

In:  nothing.
Out: the files of the list, to be put where another process keeps Matplotlib's settings.
"""

from __future__ import annotations

from pathlib import Path

import matplotlib.font_manager  # makes the list, unless it is there


def font_lists() -> list[Path]:
    """Return the files that hold the list.

    >>> {path.suffix for path in font_lists()} <= {".json"}
    True
    """
    return sorted(Path(matplotlib.get_cachedir()).glob("fontlist-*.json"))
