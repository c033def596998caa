"""Given back: when a cell runs again, what it showed before is closed.

In:  a widget that a cell has just made.
Out: the widgets that the same cell made when it ran before, which nobody sees any more.

A front end closes no widget by itself: each run of a cell would leave one more behind, with all that it holds.
"""

from __future__ import annotations

from collections.abc import Iterable
from weakref import WeakKeyDictionary

from ipywidgets import Widget

Run = tuple[str, str]  # a cell, and the message that ran it
MADE_BY: WeakKeyDictionary[Widget, Run] = WeakKeyDictionary()


def made_before(widget: Widget) -> Iterable[Widget]:
    """Return what the cell that makes this widget made in its earlier runs; outside a notebook, nothing."""
    run = _this_run()
    if run is None:
        return []
    earlier = [one for one, (cell, message) in MADE_BY.items() if cell == run[0] and message != run[1]]
    for one in earlier:
        del MADE_BY[one]
    MADE_BY[widget] = run
    return earlier


def _this_run() -> Run | None:
    """Return which cell is run, and by which message, where the front end tells."""
    from IPython import get_ipython

    shell = get_ipython()
    parent = shell.get_parent() if hasattr(shell, "get_parent") else {}
    cell = parent.get("metadata", {}).get("cellId")
    return cell and (str(cell), str(parent["header"]["msg_id"]))
