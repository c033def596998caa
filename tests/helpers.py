"""What several tests share."""

import re
from html import unescape
from urllib.parse import unquote

WAITS = "waits"  # by this name a test tells who was waited for, and how long from each key press to the picture [ms]


def exactly(sentence):
    """A pattern for ``pytest.raises`` that matches this sentence and nothing more."""
    return f"^{re.escape(sentence)}$"


def svg_in(html):
    """Return the SVG text in a noun's HTML."""
    (address,) = re.findall(r'src="data:image/svg\+xml,([^"]*)"', html)
    return unquote(address)


def words_in(html):
    """Return the words for who cannot see, of every image in HTML; no words where an image has none."""
    return [unescape("".join(re.findall(r'\balt="([^"]*)"', image))) for image in re.findall(r"<img\b[^>]*>", html)]
