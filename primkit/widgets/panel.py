"""Panel: what stands beside a slider's controls in the page: ``panel.js``; its head says what for.

In:  the widgets of a slider.
Out: a box with all of them.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import anywidget
import ipywidgets
import traitlets


class Attendant(anywidget.AnyWidget):
    """Looks after the panel that it stands in; says "I am here" to whatever the page asks."""

    _esm = Path(__file__).with_suffix(".js")
    sliders = traitlets.Int().tag(sync=True)

    def __init__(self, sliders: int) -> None:
        super().__init__(sliders=sliders)
        self.on_msg(lambda *_: self.send({}))


def attended(parts: Sequence[Any], sliders: int) -> Any:
    """Return the parts below each other, with so many sliders among them, and who looks after them."""
    return ipywidgets.VBox([*parts, Attendant(sliders)]).add_class("primkit-panel")


def shown(panel: Any, words: str) -> dict[str, Any]:
    """Return what a page is sent to show a panel, and the words that are stored of it.

    ipywidgets 7, which Colab has, knows no ``_repr_mimebundle_``.
    """
    view = {"version_major": 2, "version_minor": 0, "model_id": panel.model_id}
    return {"application/vnd.jupyter.widget-view+json": view, "text/plain": words}
