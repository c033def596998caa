"""Themed: the one way in which a notebook is given a picture.

In:  an image, SVG text or the bytes of a PNG, and words that tell what it shows.
Out: HTML: the image with its words for who cannot see it, which follows the page's theme and fits a phone.

>>> html = themed('<svg xmlns="http://www.w3.org/2000/svg" width="9" height="9"/>', 'A "small" picture')
>>> 'alt="A &quot;small&quot; picture"' in html, "data:image/svg+xml" in html
(True, True)

Why one ``<img>``: a notebook that was not run yet is not trusted, and Jupyter takes SVG, scripts and styles out of its
outputs; an image with its words stays. The theme comes by a filter that turns light and dark around and keeps the hue:
so every picture follows it, also one whose colours nobody knows beforehand, and contrasts stay what they were.
"""

from __future__ import annotations

import base64
from html import escape
from urllib.parse import quote

# Jupyter's dark page is #111; turned around by this share, white paper is just that.
TURNED = 0.93
_STYLE = (
    "<style>.primkit-picture{max-width:100%;height:auto;display:block}"
    f'[data-jp-theme-light="false"] .primkit-picture{{filter:invert({TURNED}) hue-rotate(180deg)}}</style>'
)
_ITSELF = " !$'()*+,/:;=?@[]>{}|^"  # letters that need no code in an address between double quotes


def themed(image: str | bytes, words: str, *, width: int | None = None) -> str:
    """Return the HTML of an image.

    Parameters
    ----------
    image : str or bytes
        SVG text, or a PNG.
    words : str
        What it shows, for who cannot see it.
    width : int, optional
        Pixels of the page; the image's own when not given.
    """
    if isinstance(image, str):
        source = "data:image/svg+xml," + quote(image, safe=_ITSELF)
    else:
        source = "data:image/png;base64," + base64.b64encode(image).decode()
    size = f' width="{width}"' if width is not None else ""
    return f'{_STYLE}<img class="primkit-picture" alt="{escape(words)}"{size} src="{source}"/>'


def in_theme(svg: str) -> str:
    """Return SVG text that stands in the page itself, as where it is redrawn in place, in the page's theme."""
    return f'{_STYLE}<div class="primkit-picture">{svg}</div>'
